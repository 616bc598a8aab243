/* Levels of detail of a volume, chosen by how long the last step took. */
#include "apps/isosculpt/viewport/lod.h"

#include <string.h>

#include "base/memory.h"
#include "grids/brick_index.h"
#include "grids/grid.h"
#include "grids/rgrid.h"

/* Seconds of a step: above the first limit the next step uses a coarser level; it uses a finer level when
 * that is expected to stay below the second limit. */
static const double TOO_SLOW = 0.030, FAST = 0.022;
/* Factors of time from one level to the next finer one. Extracting: between four (the points of a smooth
 * surface) and eight (noise). Drawing: half of the time fills pixels, whose number stays the same. */
static const double EXTRACT_GROWTH = 6, DRAW_GROWTH = 3;
/* The first level is the finest one with at most this many voxels, or else the coarsest. */
static const double FIRST_VOXELS = 5e6;

struct isosculpt_lod {
    iso_rgrid
        *grid[ISOSCULPT_LOD_LEVELS]; /* [0] is borrowed; NULL: the previous level is too small to be halved */
    iso_point_set *points[ISOSCULPT_LOD_LEVELS];
    iso_point_set *second_points[ISOSCULPT_LOD_LEVELS]; /* NULL until they are needed */
    iso_pool *pool;
    int level; /* current; 0 is the full resolution */
};

/* ---- halving */

/* What the threads that copy every second voxel read and write. */
typedef struct halving {
    const iso_rgrid *from;
    iso_rgrid *to;
} halving;

static void halve_slice(void *context, size_t z, int worker) {
    (void)worker;
    const halving *h = context;
    const size_t bytes = iso_type_size(h->to->type);
    for (int y = 0; y < h->to->dims[1]; y++) {
        const char *from =
            (const char *)h->from->data +
            (2 * y * h->from->stride_y + 2 * (ptrdiff_t)z * h->from->stride_z) * (ptrdiff_t)bytes;
        char *to =
            (char *)h->to->data + (y * h->to->stride_y + (ptrdiff_t)z * h->to->stride_z) * (ptrdiff_t)bytes;
        for (int x = 0; x < h->to->dims[0]; x++)
            memcpy(to + (size_t)x * bytes, from + 2 * (size_t)x * bytes, bytes);
    }
}

static iso_status halve_grid(const iso_rgrid *from, iso_pool *pool, iso_rgrid **to, iso_error *error) {
    iso_transform transform = from->transform;
    iso_rgrid_desc desc = {.type = from->type,
                           .scale = from->scale,
                           .offset = from->offset,
                           .transform = &transform,
                           .level_set = from->level_set};
    for (int axis = 0; axis < 3; axis++) {
        desc.dims[axis] = (from->dims[axis] + 1) / 2;
        transform.spacing[axis] *= 2;
    }
    ISO_TRY(iso_rgrid_create(&desc, to, error));
    halving h = {from, *to};
    iso_parallel_for(pool, (size_t)desc.dims[2], halve_slice, &h);
    return ISO_OK;
}

/* ---- creating and freeing */

static bool can_be_halved(const iso_rgrid *grid) {
    return grid->dims[0] >= 4 && grid->dims[1] >= 4 && grid->dims[2] >= 4;
}

static iso_status create_points(const isosculpt_lod *lod, int level, double isovalue, iso_point_set **points,
                                iso_error *error) {
    const iso_grid grid = {.rgrid = lod->grid[level]};
    const iso_points_opts opts = {.isovalue = isovalue, .pool = lod->pool};
    return iso_point_set_create(&grid, &opts, points, error);
}

static iso_status create_level(isosculpt_lod *lod, int level, double isovalue, iso_error *error) {
    ISO_TRY(iso_brick_index_of(lod->grid[level], lod->pool, NULL, error));
    return create_points(lod, level, isovalue, &lod->points[level], error);
}

static double voxel_count(const iso_rgrid *grid) {
    return (double)grid->dims[0] * grid->dims[1] * grid->dims[2];
}

static iso_status create_levels(isosculpt_lod *lod, double isovalue, iso_error *error) {
    ISO_TRY(create_level(lod, 0, isovalue, error));
    for (int level = 1; level < ISOSCULPT_LOD_LEVELS && can_be_halved(lod->grid[level - 1]); level++) {
        ISO_TRY(halve_grid(lod->grid[level - 1], lod->pool, &lod->grid[level], error));
        ISO_TRY(create_level(lod, level, isovalue, error));
        if (voxel_count(lod->grid[lod->level]) > FIRST_VOXELS) lod->level = level;
    }
    return isosculpt_lod_update(lod, isovalue, error);
}

iso_status isosculpt_lod_create(iso_rgrid *grid, double isovalue, iso_pool *pool, isosculpt_lod **out,
                                iso_error *error) {
    isosculpt_lod *lod = iso_alloc_zero(1, sizeof *lod);
    if (!lod) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for coarser volumes");
    lod->grid[0] = grid;
    lod->pool = pool;
    iso_status status = create_levels(lod, isovalue, error);
    if (status == ISO_OK)
        *out = lod;
    else
        isosculpt_lod_destroy(lod);
    return status;
}

void isosculpt_lod_destroy(isosculpt_lod *lod) {
    if (!lod) return;
    for (int level = 0; level < ISOSCULPT_LOD_LEVELS; level++) {
        iso_point_set_destroy(lod->points[level]);
        iso_point_set_destroy(lod->second_points[level]);
        if (level && lod->grid[level]) iso_rgrid_destroy(lod->grid[level]);
    }
    iso_free(lod);
}

/* ---- steps while the isovalue is dragged */

iso_status isosculpt_lod_update(isosculpt_lod *lod, double isovalue, iso_error *error) {
    iso_point_set_isovalue(lod->points[lod->level], isovalue);
    return iso_point_set_update(lod->points[lod->level], error);
}

iso_point_set *isosculpt_lod_points(const isosculpt_lod *lod) {
    return lod->points[lod->level];
}

iso_status isosculpt_lod_update_second(isosculpt_lod *lod, double isovalue, iso_error *error) {
    iso_point_set **points = &lod->second_points[lod->level];
    if (!*points) ISO_TRY(create_points(lod, lod->level, isovalue, points, error));
    iso_point_set_isovalue(*points, isovalue);
    return iso_point_set_update(*points, error);
}

iso_point_set *isosculpt_lod_second_points(const isosculpt_lod *lod) {
    return lod->second_points[lod->level];
}

int isosculpt_lod_level(const isosculpt_lod *lod) {
    return lod->level;
}

void isosculpt_lod_record_times(isosculpt_lod *lod, double extract, double draw) {
    const int coarser = lod->level + 1;
    if (extract + draw > TOO_SLOW && coarser < ISOSCULPT_LOD_LEVELS && lod->points[coarser])
        lod->level++;
    else if (EXTRACT_GROWTH * extract + DRAW_GROWTH * draw < FAST && lod->level > 0)
        lod->level--;
}
