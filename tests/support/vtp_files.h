/* vtp_files: writes lines as VTK's XML polygonal data, for tests of its reader, with which it shares nothing.
 */
#ifndef ISO_TESTS_VTP_FILES_H
#define ISO_TESTS_VTP_FILES_H

#include "lines_files.h"

typedef struct vtp_layout {
    enum { VTP_ASCII, VTP_BINARY, VTP_APPENDED } format;
    bool raw, compressed; /* raw: only of appended arrays */
    bool big, wide;       /* wide: counts before values have 64 bits */
    bool doubles;         /* coordinates */
    int pieces;           /* lines and their points are dealt to pieces */
} vtp_layout;

/* Every piece has its points in reverse order, and a vertex cell before its lines. Points have s0 (Int16),
 * radius (Float32, equal to s0), the active vectors v (Float64: s0, s1, s2) and c (UInt8: s0 modulo 256, 7,
 * 255); cells have p0 (Float32). */
void write_vtp(const char *path, const iso_lines *lines, const vtp_layout *layout);

#endif
