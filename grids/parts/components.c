/* Removes small parts: chooses the parts, and replaces their voxels in dense grids. components_sparse.c
 * replaces those in level sets. */
#include "grids/parts/components.h"

#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "grids/brick_index.h"
#include "grids/parts/component_runs.h"
#include "grids/parts/components_sparse.h"

typedef struct filter {
    iso_grid *grid;
    iso_threshold surface;
    iso_component_runs runs;
    bool *kept;            /* by component: whether it stays in the grid */
    atomic_uchar *changed; /* by brick of a dense grid: whether a voxel was replaced */
    int bricks[3];
    float replacement; /* the value that voxels of dropped parts get in a dense grid */
} filter;

/* ---- which parts are kept */

/* Returns the number of parts with at least this many voxels. */
static size_t count_parts_from(const iso_component_runs *runs, uint64_t voxels) {
    size_t count = 0;
    for (size_t i = 0; i < runs->component_count; i++) count += runs->voxels[i] >= voxels;
    return count;
}

/* Returns the largest number of voxels that at least `wanted` parts have; 0 if there are fewer parts. */
static uint64_t size_of_rank(const iso_component_runs *runs, size_t wanted) {
    uint64_t low = 0, high = runs->voxel_count;
    while (low < high) {
        const uint64_t middle = low + (high - low + 1) / 2;
        if (count_parts_from(runs, middle) >= wanted)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* Keeps the largest components; of equally large ones those with lower numbers, whose first voxels are first.
 */
static void keep_largest(filter *f, size_t wanted) {
    const iso_component_runs *runs = &f->runs;
    const uint64_t least = size_of_rank(runs, wanted);
    size_t equal = wanted - count_parts_from(runs, least + 1);
    for (size_t i = 0; i < runs->component_count; i++) {
        f->kept[i] = runs->voxels[i] > least || (runs->voxels[i] == least && equal > 0);
        equal -= runs->voxels[i] == least && equal > 0;
    }
}

static iso_status choose_kept(filter *f, const iso_components_opts *opts, double voxel, iso_error *error) {
    const iso_component_runs *runs = &f->runs;
    uint64_t most = 0;
    for (size_t i = 0; i < runs->component_count; i++) {
        f->kept[i] = true;
        if (runs->voxels[i] > most) most = runs->voxels[i];
    }
    if (opts->largest && opts->largest < runs->component_count) keep_largest(f, opts->largest);
    for (size_t i = 0; i < runs->component_count; i++)
        f->kept[i] = f->kept[i] && (double)runs->voxels[i] * voxel >= opts->min_volume;
    if (runs->component_count && (double)most * voxel < opts->min_volume)
        return iso_fail(error, ISO_ERR_EMPTY, "no part of the solid has %g mm3: the largest of %zu has %g",
                        opts->min_volume, runs->component_count, (double)most * voxel);
    return ISO_OK;
}

static void sum_totals(const filter *f, double voxel, iso_components_totals *totals) {
    *totals = (iso_components_totals){0};
    for (size_t i = 0; i < f->runs.component_count; i++)
        if (f->kept[i]) {
            totals->kept++;
            totals->kept_voxels += f->runs.voxels[i];
        }
    totals->dropped = f->runs.component_count - totals->kept;
    totals->dropped_voxels = f->runs.voxel_count - totals->kept_voxels;
    totals->kept_volume = (double)totals->kept_voxels * voxel;
    totals->dropped_volume = (double)totals->dropped_voxels * voxel;
    if (f->runs.voxel_count)
        totals->dropped_share = (double)totals->dropped_voxels / (double)f->runs.voxel_count;
}

/* ---- dense grids */

/* Returns the value for voxels of dropped parts, which must be on the other side of the isovalue. There is
 * always one: two parts are separated by a voxel on the other side, or by one that is not finite, which only
 * float grids have. */
static float choose_replacement(const filter *f, const iso_brick_index *index) {
    const iso_rgrid *grid = f->grid->rgrid;
    const float at = f->surface.isovalue_ceil;
    if (grid->type != ISO_FLOAT32) return ceilf(at) - (grid->level_set ? 0 : 1);
    double low, high;
    iso_brick_index_extremes(index, &low, &high);
    if (grid->level_set) return (float)(at + fmax(0, fmin((high - low) / 256, (high - at) / 2)));
    const float value = (float)(at - fmin((high - low) / 256, (at - low) / 2));
    return value < at ? value : nextafterf(at, -INFINITY);
}

#define FILL_RUN(type)                                                                                       \
    for (int32_t x = run.first; x <= run.last; x++) ((type *)row)[x] = (type)value

static void fill_run(void *row, iso_type type, iso_run run, float value) {
    switch (type) {
    case ISO_UINT8:
        FILL_RUN(uint8_t);
        break;
    case ISO_INT16:
        FILL_RUN(int16_t);
        break;
    case ISO_UINT16:
        FILL_RUN(uint16_t);
        break;
    case ISO_FLOAT32:
        FILL_RUN(float);
        break;
    }
}

static void mark_bricks(const filter *f, iso_run run, int y, int z) {
    const size_t row =
        ((size_t)(z / ISO_BRICK) * (size_t)f->bricks[1] + (size_t)(y / ISO_BRICK)) * (size_t)f->bricks[0];
    for (int b = run.first / ISO_BRICK; b <= run.last / ISO_BRICK; b++)
        atomic_store_explicit(&f->changed[row + (size_t)b], 1, memory_order_relaxed);
}

static void replace_slab(void *context, size_t index, int worker) {
    (void)worker;
    const filter *f = context;
    const iso_rgrid *grid = f->grid->rgrid;
    const iso_run_slab *slab = &f->runs.slabs[index];
    const iso_run *runs = slab->runs.data;
    const uint32_t *component = f->runs.component + slab->base;
    const uint32_t *rows = slab->rows;
    for (int z = slab->z[0]; z < slab->z[1]; z++)
        for (int y = 0; y < grid->dims[1]; y++, rows++) {
            char *row = (char *)grid->data +
                        (y * grid->stride_y + z * grid->stride_z) * (ptrdiff_t)iso_type_size(grid->type);
            for (uint32_t i = rows[0]; i < rows[1]; i++) {
                if (f->kept[component[i]]) continue;
                fill_run(row, grid->type, runs[i], f->replacement);
                mark_bricks(f, runs[i], y, z);
            }
        }
}

static iso_status log_changes(const filter *f, iso_error *error) {
    iso_change_log *log = f->grid->rgrid->log;
    iso_change_log_begin(log);
    size_t brick = 0;
    for (int z = 0; z < f->bricks[2]; z++)
        for (int y = 0; y < f->bricks[1]; y++)
            for (int x = 0; x < f->bricks[0]; x++, brick++) {
                if (!atomic_load_explicit(&f->changed[brick], memory_order_relaxed)) continue;
                const int at[3] = {x, y, z};
                int lo[3], hi[3];
                for (int axis = 0; axis < 3; axis++) {
                    const int last = f->grid->rgrid->dims[axis] - 1;
                    lo[axis] = at[axis] * ISO_BRICK;
                    hi[axis] = lo[axis] + ISO_BRICK - 1 < last ? lo[axis] + ISO_BRICK - 1 : last;
                }
                ISO_TRY(iso_change_log_add(log, lo, hi, error));
            }
    return ISO_OK;
}

static iso_status filter_dense(filter *f, iso_pool *pool, iso_error *error) {
    iso_rgrid *grid = f->grid->rgrid;
    const iso_brick_index *index;
    ISO_TRY(iso_brick_index_of(grid, pool, &index, error));
    f->replacement = choose_replacement(f, index);
    iso_grid_bricks(f->grid, f->bricks);
    const size_t bricks = (size_t)f->bricks[0] * (size_t)f->bricks[1] * (size_t)f->bricks[2];
    f->changed = iso_alloc_zero(bricks, sizeof *f->changed);
    if (!f->changed) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the parts of the solid");
    iso_parallel_for(pool, f->runs.slab_count, replace_slab, f);
    ISO_TRY(log_changes(f, error));
    return iso_brick_index_of(grid, pool, NULL, error);
}

/* ---- both kinds of grid */

static iso_status filter_parts(filter *f, const iso_components_opts *opts, iso_components_totals *totals,
                               iso_error *error) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(f->grid));
    const double voxel = fabs(affine.determinant);
    ISO_TRY(iso_component_runs_find(f->grid, &f->surface, opts->pool, &f->runs, error));
    f->kept = iso_alloc(f->runs.component_count * sizeof *f->kept);
    if (!f->kept) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the parts of the solid");
    ISO_TRY(choose_kept(f, opts, voxel, error));
    sum_totals(f, voxel, totals);
    if (!totals->dropped) return ISO_OK;
    const iso_sparse_removal removal = {f->surface.isovalue_ceil, &f->runs, f->kept, opts->pool};
    return f->grid->rgrid ? filter_dense(f, opts->pool, error)
                          : iso_components_remove_sparse(f->grid->hgrid, &removal, error);
}

iso_status iso_components_filter(iso_grid *grid, const iso_components_opts *opts,
                                 iso_components_totals *totals, iso_error *error) {
    if (!isfinite(opts->isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not a number");
    filter f = {.grid = grid, .surface = iso_threshold_of(grid, opts->isovalue)};
    iso_status status = filter_parts(&f, opts, totals, error);
    iso_component_runs_free(&f.runs);
    iso_free(f.kept);
    iso_free(f.changed);
    return status;
}
