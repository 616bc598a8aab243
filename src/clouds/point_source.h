/* point_source: points that can be read any number of times, in blocks and by several threads at once: from
 * arrays in memory, or from a mapped file. Twenty million points take longer to be copied into new memory,
 * which the system has to clear first, than to be read a few times from where they are. */
#ifndef ISO_CLOUDS_POINT_SOURCE_H
#define ISO_CLOUDS_POINT_SOURCE_H

#include "base/glyphs.h"
#include "base/parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The most points of a block: its buffers stay in the first levels of the cache. */
enum { ISO_POINT_BLOCK = 512 };

/* Arrays with one item per point. NULL: the source has none. */
typedef struct iso_point_arrays {
    const float (*positions)[3]; /* mm, relative to the source's origin */
    const float (*normals)[3];   /* of any length; 0 or not finite: the point has none */
    const float *radii;          /* mm */
    const uint8_t (*colors)[3];
    const uint8_t *opacities;
} iso_point_arrays;

/* What a source decodes a block of points into. */
typedef struct iso_point_block {
    float positions[ISO_POINT_BLOCK][3], normals[ISO_POINT_BLOCK][3];
    uint8_t colors[ISO_POINT_BLOCK][3];
} iso_point_block;

/* All pointers are borrowed. */
typedef struct iso_point_source {
    size_t count;
    iso_vec3 origin;         /* world position that positions are relative to */
    iso_point_arrays arrays; /* of all points; if `read` is set, only for whether they are NULL */
    /* Decodes points first .. first + count - 1, at most ISO_POINT_BLOCK. Thread-safe. NULL: they are in the
     * arrays. */
    void (*read)(const void *context, size_t first, size_t count, iso_point_block *block);
    const void *context;
} iso_point_source;

/* The positions, directions as normals, colours and opacities of glyphs, without their radii. */
iso_point_source iso_point_source_of_glyphs(const iso_glyphs *glyphs);

/* Returns arrays of points first .. first + count - 1, at most ISO_POINT_BLOCK: those of the source, or those
 * of `block`, which it fills. */
iso_point_arrays iso_point_source_read(const iso_point_source *source, size_t first, size_t count,
                                       iso_point_block *block);

/* What is known after all points have been looked at. */
typedef struct iso_point_survey {
    float lo[3], hi[3];     /* bounds of the positions */
    bool finite;            /* all coordinates are finite */
    size_t without_normals; /* points whose normal is 0 or not finite, or missing */
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

#ifdef __cplusplus
}
#endif
#endif
