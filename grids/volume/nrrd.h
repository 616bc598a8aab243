/* nrrd: parses the header of an NRRD file and decodes its array. For grids/volume/format_nrrd.c and its
 * tests.
 *
 * The format: https://teem.sourceforge.net/nrrd/format.html. A header is a magic line and then lines "field:
 * value", "key:=value" and "# comment", up to an empty line, after which the array follows unless `data file`
 * names where it is. Everything in it is checked here before it is used. */
#ifndef ISO_GRIDS_VOLUME_NRRD_H
#define ISO_GRIDS_VOLUME_NRRD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "grids/volume/format.h"

/* ---- header ---- */

enum {
    ISO_NRRD_AXES = 16,                /* as many as the format allows */
    ISO_NRRD_SPACE = 8,                /* dimensions of the space around the array */
    ISO_NRRD_HEADER_BYTES = 256 << 10, /* longest header, without the file names after LIST */
    ISO_NRRD_NAME = 4096               /* longest file name and its end */
};

typedef enum iso_nrrd_encoding {
    ISO_NRRD_RAW,
    ISO_NRRD_TEXT,
    ISO_NRRD_HEX,
    ISO_NRRD_GZIP,
    ISO_NRRD_BZIP2,
    ISO_NRRD_ZRL /* run lengths of zeros */
} iso_nrrd_encoding;

/* An axis of the array. Numbers that the header does not state are NaN. */
typedef struct iso_nrrd_axis {
    uint64_t size;
    double spacing, thickness, min, max;
    double direction[ISO_NRRD_SPACE]; /* from one sample to the next */
    double unit_mm;                   /* of spacing, thickness, min and max */
    bool has_unit;
    bool node_centered; /* the first and last samples are at min and max, not half a step within that range */
    bool other;         /* its kind is not an axis of space: a list, a vector, colours, time */
    unsigned kind_size; /* the size that its kind requires; 0: any */
} iso_nrrd_axis;

/* The place of the array's data. */
typedef enum iso_nrrd_place {
    ISO_NRRD_ATTACHED,  /* after the header */
    ISO_NRRD_FILE,      /* in the file `name` */
    ISO_NRRD_LIST,      /* in several files, whose names follow the header, one on each line */
    ISO_NRRD_SKIP_LIST, /* the same, but a number of bytes to skip and a space precede each name */
    ISO_NRRD_PATTERN    /* in files whose names are `name` with a number in place of its %d */
} iso_nrrd_place;

typedef struct iso_nrrd_header {
    unsigned dim;
    iso_nrrd_axis axis[ISO_NRRD_AXES]; /* the first one varies fastest */
    iso_scalar scalar;
    iso_nrrd_encoding encoding;
    bool swap; /* the array has the other byte order than this machine */

    unsigned space_dim;
    double space_sign[3]; /* 1 or -1: factors that convert the first three axes of the space to LPS */
    bool anatomical;      /* the space's axes are anatomical, such as left-posterior-superior */
    double space_origin[ISO_NRRD_SPACE], space_unit_mm[ISO_NRRD_SPACE];
    bool has_space_unit;
    /* The axes in which vectors and matrices were measured, in the space; not finite: not stated. */
    double frame[ISO_NRRD_SPACE][ISO_NRRD_SPACE];

    iso_nrrd_place place;
    char name[ISO_NRRD_NAME];
    int64_t first, last,
        step;           /* numbers in the names of a pattern; step is not 0 and leads from first to last */
    unsigned file_dim;  /* if there are several files: number of axes in each of them; dim: each has a part of
                           the last axis */
    int64_t byte_skip;  /* -1 - n: the array ends n bytes before the file's end */
    uint64_t line_skip; /* lines to skip before byte_skip applies */
    uint64_t after; /* position in the file after the header, where the array or the list of names begins */
} iso_nrrd_header;

/* Parses a header from the first `count` bytes of a file; `whole`: these are all its bytes. Modifies `text`,
 * which needs room for one byte more. `path` is for messages. ISO_ERR_FORMAT says which line is wrong. */
iso_status iso_nrrd_header_parse(const char *path, char *text, size_t count, bool whole,
                                 iso_nrrd_header *header, iso_error *error);

/* Reads and parses the header of a file. ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_NOMEM. */
iso_status iso_nrrd_header_read(const char *path, iso_nrrd_header *header, iso_error *error);

/* The size of the whole array in bytes; UINT64_MAX: it does not fit into 63 bits. */
uint64_t iso_nrrd_bytes(const iso_nrrd_header *header);

/* ---- data ---- */

/* Reads the decoded bytes of the array in order, from all its files, in the header's byte order (in the
 * machine's for ISO_NRRD_TEXT). One thread at a time. */
typedef struct iso_nrrd_data iso_nrrd_data;

/* Opens the first data file; a file of raw data that is too short is ISO_ERR_IO. `path` and `header` are
 * borrowed until iso_nrrd_data_close. */
iso_status iso_nrrd_data_open(const char *path, const iso_nrrd_header *header, iso_nrrd_data **data,
                              iso_error *error);
/* Adds the data files that the header names to the set, up to the first one that is missing. */
void iso_nrrd_data_list(const char *path, const iso_nrrd_header *header, iso_file_set *files);

/* Reads or skips `bytes` bytes, a whole number of values. ISO_ERR_IO names the file that failed. The
 * checksums of a compressed file are checked when its last byte is read. */
iso_status iso_nrrd_data_fill(void *data, void *target, size_t bytes, iso_error *error);
iso_status iso_nrrd_data_skip(iso_nrrd_data *data, uint64_t bytes, iso_error *error);
/* Returns the file whose next `bytes` bytes are the next of the array, which then count as read; NULL: they
 * are encoded, or in several files. */
FILE *iso_nrrd_data_plain(void *data, uint64_t bytes);
/* After the whole array has been read: the name of the first data file beside the header that goes on behind
 * its part of the array; NULL: none does. White space behind numbers in text is nothing. */
const char *iso_nrrd_data_longer(const iso_nrrd_data *data);
void iso_nrrd_data_close(iso_nrrd_data *data);

#endif
