/* rgrid: a regular grid, the dense array of scanners and simulations (2003, section 3).
 *
 * Voxel (x, y, z) lies at data + (x + y * stride_y + z * stride_z) elements, x fastest. Stored values are of
 * one of four types; the physical value (Hounsfield units, say) is stored * scale + offset with scale > 0.
 * NaN and infinite voxels are allowed in float grids. Coordinates outside the grid are clamped to it.
 *
 * The data may be lent: the grid keeps the pointer and calls `release` once when it is destroyed. A crop is a
 * view of the same data. Reading is thread-safe while nobody writes; writers call iso_rgrid_touch for what
 * they changed. */
#ifndef ISO_GRIDS_RGRID_H
#define ISO_GRIDS_RGRID_H

#include <stddef.h>
#include <stdint.h>

#include "base/geometry.h"
#include "base/parallel.h"
#include "base/status.h"
#include "grids/change_log.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

const char *iso_type_name(iso_type type); /* "uint8", "int16", "uint16", "float32" */

/* Bytes of one voxel. */
static inline size_t iso_type_size(iso_type type) {
    return type == ISO_UINT8 ? 1 : type == ISO_FLOAT32 ? 4 : 2;
}

struct iso_brick_index;

typedef struct iso_rgrid {
    int dims[3]; /* voxels, each >= 1 */
    iso_type type;
    void *data;
    ptrdiff_t stride_y, stride_z; /* elements */
    double scale, offset;         /* physical = stored * scale + offset; scale > 0 */
    iso_transform transform;
    int level_set; /* 1: a distance field, negative inside; 0: the inside is at or above the isovalue */
    iso_change_log *log;
    struct iso_brick_index *index; /* ranges of the bricks; NULL before iso_rgrid_index */
    void (*release)(void *owner);  /* called with `owner` by iso_rgrid_destroy; may be NULL */
    void *owner;
} iso_rgrid;

/* What to create: a description whose zero fields mean the default. */
typedef struct iso_rgrid_desc {
    int dims[3];
    iso_type type;
    void *data;                   /* NULL: allocate, uninitialised; else lent, contiguous */
    void (*release)(void *owner); /* with data: called on destroy, also when create fails; may be NULL */
    void *owner;
    double scale, offset;           /* scale 0 means 1 */
    const iso_transform *transform; /* NULL: identity */
    int level_set;
} iso_rgrid_desc;

/* ISO_ERR_FORMAT when a dimension is < 1 or the size overflows, scale is negative or the transform is
 * singular; ISO_ERR_LIMIT above 2^32 bricks of 16^3; ISO_ERR_NOMEM. */
iso_status iso_rgrid_create(const iso_rgrid_desc *desc, iso_rgrid **grid, iso_error *error);
void iso_rgrid_destroy(iso_rgrid *grid);

/* Narrows the grid in place to voxels lo..hi (inclusive); the origin moves with it, the data stays where it
 * is, the change log starts anew and the index is dropped. ISO_ERR_USAGE when the range is empty or outside.
 */
iso_status iso_rgrid_crop(iso_rgrid *grid, const int lo[3], const int hi[3], iso_error *error);

/* Starts an edit and records voxels lo..hi (clipped to the grid) as changed. */
iso_status iso_rgrid_touch(iso_rgrid *grid, const int lo[3], const int hi[3], iso_error *error);

/* The grid's index of bricks (brick_index.h), made at the first call and brought up to date by later ones;
 * *index (NULL is fine) belongs to the grid. `pool` may be NULL. Not while others read the grid, except that
 * one without edits since is only read. Until the
 * next edit everything that asks which bricks an isovalue crosses is faster. ISO_ERR_NOMEM. */
iso_status iso_rgrid_index(iso_rgrid *grid, iso_pool *pool, const struct iso_brick_index **index,
                           iso_error *error);

/* The stored value that corresponds to a physical one. */
static inline double iso_rgrid_stored(const iso_rgrid *grid, double physical) {
    return (physical - grid->offset) / grid->scale;
}

/* Stored value at a voxel, which must be inside. */
static inline float iso_rgrid_at(const iso_rgrid *grid, int x, int y, int z) {
    ptrdiff_t i = x + y * grid->stride_y + z * grid->stride_z;
    switch (grid->type) {
    case ISO_UINT8:
        return ((const uint8_t *)grid->data)[i];
    case ISO_INT16:
        return ((const int16_t *)grid->data)[i];
    case ISO_UINT16:
        return ((const uint16_t *)grid->data)[i];
    default:
        return ((const float *)grid->data)[i];
    }
}

#ifdef __cplusplus
}
#endif
#endif
