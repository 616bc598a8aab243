/* e57_file: what lies in an E57 file (ASTM E2807): pages with a checksum behind each, an XML text that
 * describes the scans, and their points as packets of streams of bits. */
#ifndef ISO_IO_GLYPHS_E57_FILE_H
#define ISO_IO_GLYPHS_E57_FILE_H

#include "base/memory.h"
#include "grids/volume/mapping.h"

enum { ISO_E57_FIELDS = 64, ISO_E57_NAME = 40 };

/* A number of each point: (number + least) * scale + offset of `bits` bits, or a float of 32 or 64. */
typedef struct iso_e57_field {
    char name[ISO_E57_NAME];
    bool is_float;
    int bits; /* 0: all points have `least` */
    int64_t least;
    double scale, offset;
} iso_e57_field;

typedef struct iso_e57_scan {
    uint64_t count, begin; /* points, and where their section begins in the file, byte */
    double rotation[9], translation[3];
    iso_e57_field fields[ISO_E57_FIELDS];
    int field_count;
} iso_e57_scan;

typedef struct iso_e57_file {
    const char *path;
    iso_mapping *mapping;
    uint64_t bytes, page; /* page: bytes of one with its checksum */
    uint64_t checked;     /* number of the page whose checksum was looked at last, plus 1 */
    iso_buffer scans;     /* of iso_e57_scan */
    size_t scan_count;
} iso_e57_file;

/* Opens a file and reads its description. iso_e57_close when done, also after an error. ISO_ERR_IO: damaged,
 * truncated or unreadable; ISO_ERR_FORMAT: no E57; ISO_ERR_UNSUPPORTED: fields of text, or too many;
 * ISO_ERR_NOMEM. */
iso_status iso_e57_open(const char *path, iso_e57_file *file, iso_error *error);
void iso_e57_close(iso_e57_file *file);

/* Copies `bytes` bytes that begin at *at, a place without checksums, and moves *at behind them. ISO_ERR_IO:
 * the file ends before, or a checksum is wrong. */
iso_status iso_e57_take(iso_e57_file *file, uint64_t *at, void *to, size_t bytes, iso_error *error);
/* A number of `count` bytes, the lowest first. */
uint64_t iso_e57_number(const unsigned char *bytes, int count);
/* The place without checksums of a byte of the file. */
uint64_t iso_e57_place(const iso_e57_file *file, uint64_t byte);

#endif
