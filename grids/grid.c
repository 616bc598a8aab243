/* Implements the handle for both kinds of grid, trilinear sampling and gradients (Baerentzen and Christensen
 * 2003, sections 3 and 4). */
#include "grids/grid.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <string.h>

#include "base/numbers.h"
#include "base/parallel.h"
#include "grids/brick_index.h"

const int *iso_grid_dims(const iso_grid *grid) {
    return grid->hgrid ? grid->hgrid->dims : grid->rgrid->dims;
}

const iso_transform *iso_grid_transform(const iso_grid *grid) {
    return grid->hgrid ? &grid->hgrid->transform : &grid->rgrid->transform;
}

iso_change_log *iso_grid_log(const iso_grid *grid) {
    return grid->hgrid ? grid->hgrid->log : grid->rgrid->log;
}

double iso_grid_scale(const iso_grid *grid) {
    return grid->hgrid ? grid->hgrid->transform.spacing[0] : grid->rgrid->scale;
}

double iso_grid_stored(const iso_grid *grid, double physical) {
    return grid->hgrid ? physical / iso_grid_scale(grid) : iso_rgrid_stored(grid->rgrid, physical);
}

double iso_grid_physical(const iso_grid *grid, double stored) {
    return stored * iso_grid_scale(grid) + (grid->rgrid ? grid->rgrid->offset : 0);
}

int iso_grid_is_level_set(const iso_grid *grid) {
    return grid->hgrid ? 1 : grid->rgrid->level_set;
}

void iso_grid_bricks(const iso_grid *grid, int bricks[3]) {
    const int *dims = iso_grid_dims(grid);
    for (int axis = 0; axis < 3; axis++) bricks[axis] = (dims[axis] - 1) / ISO_BRICK + 1;
}

void iso_grid_destroy(iso_grid *grid) {
    iso_rgrid_destroy(grid->rgrid);
    iso_hgrid_destroy(grid->hgrid);
    *grid = (iso_grid){0};
}

typedef struct slice_copy {
    const iso_rgrid *from;
    iso_rgrid *to;
} slice_copy;

static void copy_slice(void *context, size_t z, int worker) {
    (void)worker;
    const slice_copy *copy = context;
    const iso_rgrid *from = copy->from, *to = copy->to;
    const ptrdiff_t size = (ptrdiff_t)iso_type_size(from->type);
    for (int y = 0; y < from->dims[1]; y++)
        memcpy((char *)to->data + (y * to->stride_y + (ptrdiff_t)z * to->stride_z) * size,
               (const char *)from->data + (y * from->stride_y + (ptrdiff_t)z * from->stride_z) * size,
               (size_t)(from->dims[0] * size));
}

static iso_status copy_dense(const iso_rgrid *from, iso_pool *pool, iso_rgrid **copy, iso_error *error) {
    const iso_rgrid_desc desc = {.dims = {from->dims[0], from->dims[1], from->dims[2]},
                                 .type = from->type,
                                 .scale = from->scale,
                                 .offset = from->offset,
                                 .transform = &from->transform,
                                 .level_set = from->level_set};
    ISO_TRY(iso_rgrid_create(&desc, copy, error));
    slice_copy copy_task = {from, *copy};
    iso_parallel_for(pool, (size_t)from->dims[2], copy_slice, &copy_task);
    return ISO_OK;
}

iso_status iso_grid_copy(const iso_grid *from, iso_pool *pool, iso_grid *copy, iso_error *error) {
    *copy = (iso_grid){0};
    if (from->rgrid) return copy_dense(from->rgrid, pool, &copy->rgrid, error);
    const iso_hgrid *sparse = from->hgrid;
    ISO_TRY(iso_hgrid_create(sparse->dims, sparse->band, &sparse->transform, &copy->hgrid, error));
    iso_status status = iso_hgrid_copy_cells(sparse, copy->hgrid, error);
    if (status != ISO_OK) iso_grid_destroy(copy);
    return status;
}

static inline float value_at(const iso_grid *grid, int x, int y, int z) {
    return grid->hgrid ? iso_hgrid_at(grid->hgrid, x, y, z) : iso_rgrid_at(grid->rgrid, x, y, z);
}

float iso_grid_at(const iso_grid *grid, int x, int y, int z) {
    const int *dims = iso_grid_dims(grid);
    return value_at(grid, iso_clamp_index(x, dims[0]), iso_clamp_index(y, dims[1]),
                    iso_clamp_index(z, dims[2]));
}

/* The eight voxels around a position, and the position between them. Bit 0, 1 or 2 of a corner's number: hi
 * instead of lo along x, y or z. Along an axis with one voxel both are this voxel. */
typedef struct interpolation_cell {
    int lo[3], hi[3];
    double fraction[3];
} interpolation_cell;

static interpolation_cell cell_around(const iso_grid *grid, iso_vec3 p) {
    const int *dims = iso_grid_dims(grid);
    const double position[3] = {p.x, p.y, p.z};
    interpolation_cell c;
    for (int axis = 0; axis < 3; axis++) {
        int last = dims[axis] - 1;
        double x = position[axis] > 0 ? position[axis] : 0; /* NaN becomes 0 */
        if (x > last) x = last;
        c.lo[axis] = (int)x;
        if (c.lo[axis] == last && last > 0) c.lo[axis]--;
        c.hi[axis] = c.lo[axis] < last ? c.lo[axis] + 1 : last;
        c.fraction[axis] = x - c.lo[axis];
    }
    return c;
}

/* Interpolates linearly; exact at both ends for all finite values. */
static inline double blend(double a, double b, double t) {
    return a * (1 - t) + b * t;
}

static double blend_corners(const double v[8], const double t[3]) {
    double low = blend(blend(v[0], v[1], t[0]), blend(v[2], v[3], t[0]), t[1]);
    double high = blend(blend(v[4], v[5], t[0]), blend(v[6], v[7], t[0]), t[1]);
    return blend(low, high, t[2]);
}

/* Returns the brick that contains all eight corners, or NULL. */
static const float *shared_brick(const iso_hgrid *grid, const interpolation_cell *c) {
    for (int axis = 0; axis < 3; axis++)
        if (c->lo[axis] / ISO_BRICK != c->hi[axis] / ISO_BRICK) return NULL;
    int32_t brick = grid->cell[iso_hgrid_cell_index(grid, c->lo[0] / ISO_BRICK, c->lo[1] / ISO_BRICK,
                                                    c->lo[2] / ISO_BRICK)];
    return brick < 0 ? NULL : iso_hgrid_brick(grid, brick);
}

/* Reads the values of a cell's corners; false: one is not finite. */
static inline bool read_corners(const iso_grid *grid, const interpolation_cell *c, double v[8]) {
    const float *brick = grid->hgrid ? shared_brick(grid->hgrid, c) : NULL;
    for (int corner = 0; corner < 8; corner++) {
        int x = corner & 1 ? c->hi[0] : c->lo[0], y = corner & 2 ? c->hi[1] : c->lo[1];
        int z = corner & 4 ? c->hi[2] : c->lo[2];
        if (brick)
            v[corner] = brick[((z % ISO_BRICK) * ISO_BRICK + y % ISO_BRICK) * ISO_BRICK + x % ISO_BRICK];
        else
            v[corner] = value_at(grid, x, y, z);
        if (!isfinite(v[corner])) return false;
    }
    return true;
}

double iso_grid_sample(const iso_grid *grid, iso_vec3 p) {
    const interpolation_cell c = cell_around(grid, p);
    double v[8];
    return read_corners(grid, &c, v) ? blend_corners(v, c.fraction) : NAN;
}

double iso_grid_sample_slope(const iso_grid *grid, iso_vec3 p, iso_vec3 *slope) {
    const interpolation_cell c = cell_around(grid, p);
    const double *t = c.fraction;
    double v[8], along[3];
    if (!read_corners(grid, &c, v)) return NAN;
    for (int axis = 0; axis < 3; axis++) {
        const int step = 1 << axis, a = (axis + 1) % 3, b = (axis + 2) % 3;
        double difference[4];
        for (int k = 0; k < 4; k++) {
            const int corner = (k & 1) << a | (k >> 1) << b;
            difference[k] = v[corner | step] - v[corner];
        }
        along[axis] =
            blend(blend(difference[0], difference[1], t[a]), blend(difference[2], difference[3], t[a]), t[b]);
    }
    *slope = iso_vec3_make(along[0], along[1], along[2]);
    return blend_corners(v, t);
}

/* Returns the derivative along one axis from the values of a voxel and its neighbours; has_low and has_high:
 * whether the neighbours lie in the grid. */
static double difference(double low, double middle, double high, bool has_low, bool has_high) {
    has_low = has_low && isfinite(low);
    has_high = has_high && isfinite(high);
    if (has_low && has_high) return (high - low) / 2;
    if (!isfinite(middle)) return 0;
    return has_high ? high - middle : has_low ? middle - low : 0;
}

iso_vec3 iso_grid_voxel_gradient(const iso_grid *grid, int x, int y, int z) {
    const int *dims = iso_grid_dims(grid);
    double middle = value_at(grid, x, y, z);
    bool x0 = x > 0, x1 = x + 1 < dims[0], y0 = y > 0, y1 = y + 1 < dims[1], z0 = z > 0, z1 = z + 1 < dims[2];
    iso_vec3 g;
    g.x = difference(value_at(grid, x - x0, y, z), middle, value_at(grid, x + x1, y, z), x0, x1);
    g.y = difference(value_at(grid, x, y - y0, z), middle, value_at(grid, x, y + y1, z), y0, y1);
    g.z = difference(value_at(grid, x, y, z - z0), middle, value_at(grid, x, y, z + z1), z0, z1);
    return g;
}

iso_vec3 iso_grid_gradient(const iso_grid *grid, iso_vec3 p) {
    interpolation_cell c = cell_around(grid, p);
    double gx[8], gy[8], gz[8];
    for (int corner = 0; corner < 8; corner++) {
        iso_vec3 g = iso_grid_voxel_gradient(grid, corner & 1 ? c.hi[0] : c.lo[0],
                                             corner & 2 ? c.hi[1] : c.lo[1], corner & 4 ? c.hi[2] : c.lo[2]);
        gx[corner] = g.x;
        gy[corner] = g.y;
        gz[corner] = g.z;
    }
    return iso_vec3_make(blend_corners(gx, c.fraction), blend_corners(gy, c.fraction),
                         blend_corners(gz, c.fraction));
}

typedef struct nonfinite_count {
    const iso_rgrid *grid;
    const iso_brick_index *index; /* says which bricks have no such voxel; NULL: there is no current one */
    int bricks[3];
    atomic_size_t count; /* a sum of integers, which does not depend on the order of bricks */
} nonfinite_count;

/* Counts the voxels that are not finite among lo .. hi - 1. */
static size_t count_in_box(const iso_rgrid *grid, const int lo[3], const int hi[3]) {
    size_t count = 0;
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++) {
            const float *row = (const float *)grid->data + y * grid->stride_y + (ptrdiff_t)z * grid->stride_z;
            unsigned found = 0;
            for (int x = lo[0]; x < hi[0]; x++) found += !isfinite(row[x]);
            count += found;
        }
    return count;
}

/* Counts in the bricks of a row along x: in those that the index names, or without an index in all of them.
 */
static void count_row_of_bricks(void *context, size_t row, int worker) {
    (void)worker;
    nonfinite_count *total = context;
    const iso_brick_index *index = total->index;
    const int *dims = total->grid->dims, n = total->bricks[0];
    int brick[3] = {0, (int)(row % (size_t)total->bricks[1]), (int)(row / (size_t)total->bricks[1])};
    size_t count = 0;
    for (int next; brick[0] < n; brick[0] = next) {
        next = index ? brick[0] + 1 : n;
        if (index && iso_brick_index_finite(index, iso_brick_index_number(index, brick))) continue;
        const int end[3] = {next, brick[1] + 1, brick[2] + 1};
        int lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = brick[axis] * ISO_BRICK;
            hi[axis] = iso_min_int(end[axis] * ISO_BRICK, dims[axis]);
        }
        count += count_in_box(total->grid, lo, hi);
    }
    atomic_fetch_add_explicit(&total->count, count, memory_order_relaxed);
}

size_t iso_grid_count_nonfinite(const iso_grid *grid, iso_pool *pool) {
    const iso_rgrid *dense = grid->rgrid;
    if (grid->hgrid || dense->type != ISO_FLOAT32) return 0;
    const bool indexed = dense->index && iso_brick_index_current(dense->index);
    nonfinite_count total = {.grid = dense, .index = indexed ? dense->index : NULL};
    iso_grid_bricks(grid, total.bricks);
    iso_parallel_for(pool, (size_t)total.bricks[1] * (size_t)total.bricks[2], count_row_of_bricks, &total);
    return atomic_load(&total.count);
}
