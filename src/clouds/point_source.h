/* point_source: where the numbers of points are: in arrays, or in the records of a mapped file. To copy
 * twenty million points into new memory, which the system has to clear first, takes longer than to read them
 * a few times from where they are. */
#ifndef ISO_CLOUDS_POINT_SOURCE_H
#define ISO_CLOUDS_POINT_SOURCE_H

#include <string.h>

#include "base/glyphs.h"
#include "base/parallel.h"

/* One or several numbers of every point, `stride` bytes from one point to the next, not aligned. */
typedef struct iso_point_column {
    const unsigned char *data; /* NULL: there are none */
    size_t stride;
} iso_point_column;

/* Points. Everything is borrowed; several threads may read it. */
typedef struct iso_point_source {
    size_t count;
    iso_vec3 origin;            /* world position that positions are relative to */
    iso_point_column positions; /* float[3], mm */
    iso_point_column normals;   /* float[3], of any length; 0 or not finite: the point has none */
    iso_point_column radii;     /* float, mm */
    iso_point_column colors;    /* uint8_t[3] */
    iso_point_column opacities; /* uint8_t */
} iso_point_source;

/* The positions, directions as normals, colours and opacities of glyphs, without their radii. */
iso_point_source iso_point_source_of_glyphs(const iso_glyphs *glyphs);

/* The column of an array of items of `bytes` bytes, which may be NULL. */
static inline iso_point_column iso_point_column_of(const void *array, size_t bytes) {
    return (iso_point_column){(const unsigned char *)array, bytes};
}

/* Copies three floats of a point. */
static inline void iso_point_column_get(const iso_point_column *column, size_t point, float to[3]) {
    memcpy(to, column->data + point * column->stride, 3 * sizeof *to);
}

/* Asks for the numbers of the points that are read some time after `point`: memory that is mapped from files
 * comes in small pages, at whose ends the processor stops to read ahead. */
static inline void iso_point_column_prefetch(const iso_point_column *column, size_t point) {
    enum { AHEAD = 96 };
    __builtin_prefetch((const void *)((uintptr_t)column->data + (point + AHEAD) * column->stride), 0, 3);
}

/* What is known after all points have been looked at. */
typedef struct iso_point_survey {
    float lo[3], hi[3];     /* bounds of the positions */
    bool finite;            /* all coordinates are finite */
    size_t without_normals; /* points whose normal is 0 or not finite, or missing */
    size_t zeros;           /* points at exactly 0 0 0, relative to the origin */
} iso_point_survey;

/* Reads all points once. There must be at least one. ISO_ERR_NOMEM. */
iso_status iso_point_source_survey(const iso_point_source *source, iso_pool *pool, iso_point_survey *survey,
                                   iso_error *error);

/* Normalizes a normal. One whose length is already 1 to float precision is not changed, so that points that
 * were written are read back with the same bits. Returns false, with a normal of 0, if `from` is 0 or not
 * finite. */
bool iso_point_normal(const float from[3], float normal[3]);

/* Whether the length of a normal is 1 to float precision. */
static inline bool iso_point_normal_is_unit(const float normal[3]) {
    const double x = (double)normal[0], y = (double)normal[1], z = (double)normal[2];
    return fabs(x * x + y * y + z * z - 1) < 1e-6;
}

#endif
