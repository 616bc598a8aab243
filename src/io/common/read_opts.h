/* read_opts: the options of the readers of lines and of glyphs, and what they report beside the set that they
 * read. */
#ifndef ISO_IO_COMMON_READ_OPTS_H
#define ISO_IO_COMMON_READ_OPTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/file_set.h"
#include "base/parallel.h"
#include "base/unit.h"

/* The axes of a file's coordinates. RAS (x to the patient's right, y to the front) becomes LPS, the space of
 * all coordinates here, by changing the signs of x and y. */
typedef enum iso_space {
    ISO_SPACE_FILE, /* what the format or the file states; LPS if neither does */
    ISO_SPACE_LPS,
    ISO_SPACE_RAS
} iso_space;

enum { ISO_READ_NOTES = 8, ISO_READ_TEXT = 256 };

/* What a reader reports in addition to its result. A plain struct, set by every successful read. */
typedef struct iso_read_report {
    char format[16];     /* "tck", "trk", .. */
    iso_space space;     /* the axes that the coordinates were read in: LPS or RAS */
    bool space_stated;   /* by the format or the file; false: the axes were assumed, or set by the caller */
    iso_world_unit unit; /* of the coordinates, as the format or the file states it */
    uint64_t items;      /* lines or glyphs in the file, before `every` left some out */
    /* Vertices or glyphs left out: a coordinate is not finite, or beyond 1e12 mm. Lines are split there. */
    uint64_t dropped;
    uint64_t mended_radii;                     /* radii that were negative or not finite, and were set to 0 */
    char notes[ISO_READ_NOTES][ISO_READ_TEXT]; /* warnings, printable, a line each */
    int note_count;
} iso_read_report;

/* All zero means the default. Pointers are borrowed for the call. */
typedef struct iso_read_opts {
    uint64_t max_memory; /* limit in bytes for the set and for reading it; 0: 80 % of iso_memory_available */
    iso_space space;
    int every; /* keeps only lines or glyphs 0, every, 2 * every, ..; 0 and 1: all. Not applied to atoms of
                  molecules */
    /* Molecules: 0 reads the first assembly that the file describes, -1 only the atoms that it lists. */
    int assembly;
    /* Glyphs of .ply, .off and .obj files without normals but with faces: the normals of the points are the
     * means of their faces' normals, weighted with angles; zero at points without a face. False: faces are
     * not read. */
    bool normals_from_faces;
    /* Glyphs: many points at exactly 0 0 0 are kept like others: they are places where something is put.
     * False: they are left out, as what a depth camera has not measured. */
    bool keep_zeros;
    /* Files of rows of numbers (.xyz that are no molecules, .pts, .pwn, .asc, .txt, .csv, .npy): the names of
     * their columns, separated by commas, "-" for one that is not wanted. They take the place of names in the
     * file. NULL: the file's names, or the values, say what the columns are. */
    const char *columns;
    iso_pool *pool;          /* reads parts of compressed files at a time; may be NULL */
    iso_file_set *files;     /* every file that is read is added to it; may be NULL */
    iso_read_report *report; /* may be NULL */
} iso_read_opts;

#endif
