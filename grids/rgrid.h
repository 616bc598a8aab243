/* rgrid: a dense regular grid of voxels, as scanners and simulations produce it (Baerentzen and Christensen
 * 2003, section 3).
 *
 * Voxel (x, y, z) is the element x + y * stride_y + z * stride_z of `data`. Stored values have one of four
 * types; the physical value (in Hounsfield units, for example) is stored * scale + offset, with scale > 0.
 * Float grids may contain NaN and infinities.
 *
 * The data may be lent: the grid keeps the pointer and calls `release` once when it is destroyed. A cropped
 * grid keeps using the whole array. Any number of threads may read while nobody writes; a writer calls
 * iso_rgrid_mark_changed for the voxels that it changed. */
#ifndef ISO_GRIDS_RGRID_H
#define ISO_GRIDS_RGRID_H

#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/parallel.h"
#include "base/status.h"
#include "grids/change_log.h"
#include "isopoint.h"

ISO_C_BEGIN

const char *iso_type_name(iso_type type); /* "uint8", "int16", "uint16", "float32" */

/* Returns the size of a voxel in bytes. */
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
    int level_set; /* 1: a distance field, inside below the isovalue; 0: inside at or above it */
    iso_change_log *log;
    /* Owned. iso_brick_index_of (brick_index.h) creates it and sets the function that destroys it; NULL
     * before. */
    struct iso_brick_index *index;
    void (*destroy_index)(struct iso_brick_index *index);
    void (*release)(void *owner); /* called with `owner` by iso_rgrid_destroy; may be NULL */
    void *owner;
} iso_rgrid;

/* The grid to create; a field that is 0 means the default. */
typedef struct iso_rgrid_desc {
    int dims[3];
    iso_type type;
    void *data;                   /* lent, contiguous; NULL: the grid allocates it, uninitialised */
    void (*release)(void *owner); /* releases lent data: called by iso_rgrid_destroy, or when creating the
                                     grid fails; may be NULL */
    void *owner;
    double scale, offset;           /* scale 0 means 1 */
    const iso_transform *transform; /* NULL: identity */
    int level_set;
} iso_rgrid_desc;

/* Creates a grid. ISO_ERR_FORMAT: a dimension below 1, a size that overflows, a negative scale or a singular
 * transform; ISO_ERR_LIMIT: more than 2^32 bricks; ISO_ERR_NOMEM. */
iso_status iso_rgrid_create(const iso_rgrid_desc *desc, iso_rgrid **grid, iso_error *error);
void iso_rgrid_destroy(iso_rgrid *grid);

/* Restricts the grid in place to voxels lo..hi (inclusive) and moves its origin accordingly. The data is not
 * copied; the change log is replaced by an empty one and the index is destroyed. ISO_ERR_USAGE: the range is
 * empty or outside; ISO_ERR_NOMEM. */
iso_status iso_rgrid_crop(iso_rgrid *grid, const int lo[3], const int hi[3], iso_error *error);

/* Starts an edit and records voxels lo..hi (inclusive, clipped to the grid) as changed. ISO_ERR_NOMEM. */
iso_status iso_rgrid_mark_changed(iso_rgrid *grid, const int lo[3], const int hi[3], iso_error *error);

/* Returns the stored value of a physical one, not rounded. */
static inline double iso_rgrid_stored(const iso_rgrid *grid, double physical) {
    return (physical - grid->offset) / grid->scale;
}

/* Returns the stored value of a voxel inside the grid. */
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

ISO_C_END
#endif
