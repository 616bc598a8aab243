#include "apps/isosculpt/view/lod.h"

#include <string.h>

#include "base/memory.h"
#include "grids/brick_index.h"
#include "grids/grid.h"
#include "grids/rgrid.h"

/* Seconds of a step that call for a coarser level, and for a finer one when that would take no more. */
static const double TOO_SLOW = 0.030, FAST = 0.022;
/* What a finer level costs, of extracting (four times the points of a smooth surface, eight times those of
 * noise) and of drawing, half of which is filling pixels. */
static const double MORE_TO_EXTRACT = 6, MORE_TO_DRAW = 3;
/* Voxels of the level to begin with, at most. */
static const double FIRST_VOXELS = 5e6;

struct isosculpt_lod {
    iso_rgrid *grid[ISOSCULPT_LEVELS]; /* 0 is borrowed; NULL: too small to be halved once more */
    iso_point_set *points[ISOSCULPT_LEVELS];
    iso_pool *pool;
    int now;
};

/* ---- halving */

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

static iso_status halve(const iso_rgrid *from, iso_pool *pool, iso_rgrid **to, iso_error *error) {
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

/* ---- life */

static bool can_be_halved(const iso_rgrid *grid) {
    return grid->dims[0] >= 4 && grid->dims[1] >= 4 && grid->dims[2] >= 4;
}

static iso_status make_level(isosculpt_lod *levels, int level, double isovalue, iso_error *error) {
    const iso_grid grid = {.rgrid = levels->grid[level]};
    const iso_points_opts opts = {.isovalue = isovalue, .pool = levels->pool};
    ISO_TRY(iso_brick_index_of(levels->grid[level], levels->pool, NULL, error));
    return iso_point_set_create(&grid, &opts, &levels->points[level], error);
}

static double voxels(const iso_rgrid *grid) {
    return (double)grid->dims[0] * grid->dims[1] * grid->dims[2];
}

static iso_status make_levels(isosculpt_lod *levels, double isovalue, iso_error *error) {
    ISO_TRY(make_level(levels, 0, isovalue, error));
    for (int level = 1; level < ISOSCULPT_LEVELS && can_be_halved(levels->grid[level - 1]); level++) {
        ISO_TRY(halve(levels->grid[level - 1], levels->pool, &levels->grid[level], error));
        ISO_TRY(make_level(levels, level, isovalue, error));
        if (voxels(levels->grid[levels->now]) > FIRST_VOXELS) levels->now = level;
    }
    return isosculpt_lod_update(levels, isovalue, error);
}

iso_status isosculpt_lod_create(iso_rgrid *grid, double isovalue, iso_pool *pool, isosculpt_lod **out,
                                iso_error *error) {
    isosculpt_lod *levels = iso_alloc_zero(1, sizeof *levels);
    if (!levels) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for coarser volumes");
    levels->grid[0] = grid;
    levels->pool = pool;
    iso_status status = make_levels(levels, isovalue, error);
    if (status == ISO_OK)
        *out = levels;
    else
        isosculpt_lod_destroy(levels);
    return status;
}

void isosculpt_lod_destroy(isosculpt_lod *levels) {
    if (!levels) return;
    for (int level = 0; level < ISOSCULPT_LEVELS; level++) {
        iso_point_set_destroy(levels->points[level]);
        if (level && levels->grid[level]) iso_rgrid_destroy(levels->grid[level]);
    }
    iso_free(levels);
}

/* ---- sliding */

iso_status isosculpt_lod_update(isosculpt_lod *levels, double isovalue, iso_error *error) {
    iso_point_set_isovalue(levels->points[levels->now], isovalue);
    return iso_point_set_update(levels->points[levels->now], error);
}

iso_point_set *isosculpt_lod_points(const isosculpt_lod *levels) {
    return levels->points[levels->now];
}

int isosculpt_lod_level(const isosculpt_lod *levels) {
    return levels->now;
}

void isosculpt_lod_record_times(isosculpt_lod *levels, double extract, double draw) {
    const int coarser = levels->now + 1;
    if (extract + draw > TOO_SLOW && coarser < ISOSCULPT_LEVELS && levels->points[coarser])
        levels->now++;
    else if (MORE_TO_EXTRACT * extract + MORE_TO_DRAW * draw < FAST && levels->now > 0)
        levels->now--;
}
