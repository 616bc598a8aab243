/* foot_iteration: foot points of any scalar field by iterating eq. 2 of Baerentzen and Christensen 2003,
 * section 4.
 *
 * The field and its gradient are interpolated as iso_grid_sample and iso_grid_gradient do, with the same
 * bits, but from a copy of the brick's surroundings: an iteration reads 32 voxels, and finding each in a
 * sparse grid takes longer than the arithmetic. */
#include "extract/points/foot_points.h"

/* Voxels that iteration may move; more than sqrt 3, because the field need not be a distance field. */
static const double REACH = ISO_FOOT_REACH;
static const int MOST_STEPS = 10;
static const double CONVERGED = 1e-4; /* voxels */

/* ---- the voxels that iteration begins at */

/* The rows of a window along x, y and z from -1 to 16: bit x + 1 of row (z + 1) * ROWS + y + 1. */
enum { ROWS = ISO_BRICK + 2 };
typedef struct seed_rows {
    uint32_t finite[ROWS * ROWS], inside[ROWS * ROWS];
    uint32_t crossed[ROWS * ROWS]; /* cells, by their lowest voxel; -1 to 15 on each axis */
} seed_rows;

/* Sets bits x + 1 of the voxels x = -1 .. 16 of a row that are finite, and that are inside. */
static void classify_row(const float *row, const iso_threshold *surface, uint32_t *finite, uint32_t *inside) {
    uint32_t is_finite = 0, is_inside = 0;
    for (int i = 0; i < ROWS; i++) {
        is_finite |= (uint32_t)(fabsf(row[i]) < INFINITY) << i;
        is_inside |= (uint32_t)iso_threshold_inside(surface, row[i]) << i;
    }
    *finite = is_finite;
    *inside = is_inside;
}

/* The bits of the cells of a row that lie in the grid. */
static uint32_t cells_in_grid(const iso_brick_window *window) {
    uint32_t bits = 0;
    for (int x = -1; x < ISO_BRICK; x++)
        bits |= (uint32_t)(x >= window->first[0] && x < window->last[0]) << (x + 1);
    return bits;
}

/* Finds the cells that the surface crosses and whose corners are finite. Returns whether there are any. */
static bool find_crossed(const iso_brick_window *window, const iso_threshold *surface, seed_rows *rows) {
    const uint32_t in_grid = cells_in_grid(window);
    uint32_t any = 0;
    for (int z = -1; z <= ISO_BRICK; z++)
        for (int y = -1; y <= ISO_BRICK; y++) {
            const int row = (z + 1) * ROWS + y + 1;
            classify_row(window->values + iso_window_index(-1, y, z), surface, &rows->finite[row],
                         &rows->inside[row]);
        }
    for (int z = -1; z < ISO_BRICK; z++)
        for (int y = -1; y < ISO_BRICK; y++) {
            const int row = (z + 1) * ROWS + y + 1;
            const uint32_t *f = rows->finite + row, *i = rows->inside + row;
            uint32_t finite = f[0] & f[1] & f[ROWS] & f[ROWS + 1], some = i[0] | i[1] | i[ROWS] | i[ROWS + 1],
                     all = i[0] & i[1] & i[ROWS] & i[ROWS + 1];
            finite &= finite >> 1;
            some |= some >> 1;
            all &= all >> 1;
            const bool is_in_grid =
                y >= window->first[1] && y < window->last[1] && z >= window->first[2] && z < window->last[2];
            rows->crossed[row] = is_in_grid ? finite & some & ~all & in_grid : 0;
            any |= rows->crossed[row];
        }
    return any;
}

/* Returns bits x + 1 of the voxels of a row of the brick that are seeds: on the outer side, and corners of a
 * crossed cell. */
static uint32_t seeds_of_row(const seed_rows *rows, float normal_sign, int y, int z) {
    const int row = (z + 1) * ROWS + y + 1;
    const uint32_t *c = rows->crossed + row, cells = c[0] | c[-1] | c[-ROWS] | c[-ROWS - 1],
                   outside = normal_sign > 0 ? rows->inside[row] : ~rows->inside[row];
    return (cells | cells << 1) & outside & rows->finite[row];
}

/* ---- the field around a brick */

static const int STEPS[3] = {1, ISO_FOOT_SIDE, ISO_FOOT_SIDE *ISO_FOOT_SIDE};

/* A block with what iteration needs to know of the grid. */
typedef struct foot_field {
    const float *values;
    int low[3];  /* the grid's coordinates of the first voxel of the block */
    int last[3]; /* the grid's last voxels */
} foot_field;

static bool is_within(const int low[3], const int high[3], int x, int y, int z) {
    return x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1] && z >= low[2] && z <= high[2];
}

/* Returns the value of a voxel, relative to the window's brick; NaN outside the grid. */
static float value_at(const iso_grid *grid, const iso_brick_window *window, int x, int y, int z) {
    static const int low[3] = {-1, -1, -1}, high[3] = {ISO_BRICK + 1, ISO_BRICK + 1, ISO_BRICK + 1};
    if (!is_within(window->first, window->last, x, y, z)) return NAN;
    if (is_within(low, high, x, y, z)) return window->values[iso_window_index(x, y, z)];
    return iso_grid_at(grid, x - window->first[0], y - window->first[1], z - window->first[2]);
}

static foot_field field_of(const iso_grid *grid, const iso_brick_window *window, iso_foot_block *block) {
    const int *dims = iso_grid_dims(grid);
    foot_field field = {.values = block->values};
    for (int axis = 0; axis < 3; axis++) {
        field.low[axis] = ISO_BRICK * window->brick[axis] - ISO_FOOT_LOW;
        field.last[axis] = dims[axis] - 1;
    }
    float *value = block->values;
    for (int z = -ISO_FOOT_LOW; z < ISO_FOOT_SIDE - ISO_FOOT_LOW; z++)
        for (int y = -ISO_FOOT_LOW; y < ISO_FOOT_SIDE - ISO_FOOT_LOW; y++)
            for (int x = -ISO_FOOT_LOW; x < ISO_FOOT_SIDE - ISO_FOOT_LOW; x++)
                *value++ = value_at(grid, window, x, y, z);
    return field;
}

/* A position between voxels: the place of the lowest one in the block, the steps to the upper ones (0 along
 * an axis of one voxel), and the position between them. */
typedef struct foot_place {
    const float *voxel;
    int step[3];
    double fraction[3];
} foot_place;

static foot_place place_of(const foot_field *field, iso_vec3 p) {
    const double position[3] = {p.x, p.y, p.z};
    foot_place place = {.voxel = field->values};
    for (int axis = 0; axis < 3; axis++) {
        const int last = field->last[axis];
        int low = (int)position[axis];
        if (low == last && last > 0) low--;
        place.step[axis] = low < last ? STEPS[axis] : 0;
        place.fraction[axis] = position[axis] - low;
        place.voxel += (low - field->low[axis]) * STEPS[axis];
    }
    return place;
}

/* Interpolates linearly; exact at both ends for all finite values. */
static inline double blend(double a, double b, double t) {
    return a * (1 - t) + b * t;
}

static inline double blend_corners(const double v[8], const double t[3]) {
    double low = blend(blend(v[0], v[1], t[0]), blend(v[2], v[3], t[0]), t[1]);
    double high = blend(blend(v[4], v[5], t[0]), blend(v[6], v[7], t[0]), t[1]);
    return blend(low, high, t[2]);
}

/* The derivative along an axis at a voxel. Neighbours that are not finite, or not in the grid (NaN), are
 * missing. */
static inline double difference(const float *voxel, int step) {
    const double low = (double)voxel[-step], high = (double)voxel[step], both = high - low;
    if (isfinite(both)) return both / 2; /* floats are too small for the difference to overflow */
    const double middle = (double)*voxel;
    if (!isfinite(middle)) return 0;
    return isfinite(high) ? high - middle : isfinite(low) ? middle - low : 0;
}

/* Sets the value of the field and its gradient; returns false if a corner is not finite. */
static bool sample(const foot_field *field, iso_vec3 p, double *value, iso_vec3 *gradient) {
    const foot_place place = place_of(field, p);
    double v[8], g[3][8];
    for (int corner = 0; corner < 8; corner++) {
        const float *voxel = place.voxel + (corner & 1 ? place.step[0] : 0) +
                             (corner & 2 ? place.step[1] : 0) + (corner & 4 ? place.step[2] : 0);
        v[corner] = (double)*voxel;
        if (!isfinite(v[corner])) return false;
        for (int axis = 0; axis < 3; axis++) g[axis][corner] = difference(voxel, STEPS[axis]);
    }
    *value = blend_corners(v, place.fraction);
    *gradient = iso_vec3_make(blend_corners(g[0], place.fraction), blend_corners(g[1], place.fraction),
                              blend_corners(g[2], place.fraction));
    return true;
}

/* ---- iteration */

static bool inside_volume(const int last[3], iso_vec3 p) {
    return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= last[0] && p.y <= last[1] && p.z <= last[2];
}

/* Moves p to the surface by repeating eq. 2; *gradient: the gradient there. Returns false if p gets farther
 * than REACH from its start, or does not arrive (points.h). */
static bool iterate(const foot_field *field, double isovalue, iso_vec3 *p, iso_vec3 *gradient) {
    const iso_vec3 seed = *p;
    for (int step = 0; step <= MOST_STEPS; step++) {
        double value;
        if (!sample(field, *p, &value, gradient)) return false;
        const double excess = value - isovalue, squared = iso_vec3_dot(*gradient, *gradient);
        if (!(squared > 0) || !isfinite(excess)) return false;
        if (fabs(excess) <= CONVERGED * sqrt(squared)) return true;
        *p = iso_vec3_sub(*p, iso_vec3_scale(*gradient, excess / squared));
        const iso_vec3 way = iso_vec3_sub(*p, seed);
        if (!(iso_vec3_dot(way, way) < REACH * REACH) || !inside_volume(field->last, *p)) return false;
    }
    return false;
}

static bool foot_of(const foot_field *field, const iso_brick_window *window, const iso_threshold *surface,
                    const int voxel[3], iso_surfel *point) {
    const iso_vec3 origin = {ISO_BRICK * window->brick[0], ISO_BRICK * window->brick[1],
                             ISO_BRICK * window->brick[2]};
    iso_vec3 p = iso_vec3_add(origin, iso_vec3_make(voxel[0], voxel[1], voxel[2])), gradient;
    if (!iterate(field, (double)surface->isovalue_ceil + surface->residual, &p, &gradient)) return false;
    const iso_vec3 local = iso_vec3_sub(p, origin), normal = iso_vec3_unit(gradient);
    *point = (iso_surfel){{(float)local.x, (float)local.y, (float)local.z},
                          {(float)(surface->normal_sign * normal.x), (float)(surface->normal_sign * normal.y),
                           (float)(surface->normal_sign * normal.z)}};
    return true;
}

void iso_foot_points_iterated(const iso_grid *grid, const iso_brick_window *window,
                              const iso_threshold *surface, iso_foot_block *block, iso_foot_points *out) {
    seed_rows rows;
    if (!find_crossed(window, surface, &rows)) return;
    const foot_field field = field_of(grid, window, block);
    for (int z = 0; z < ISO_BRICK; z++)
        for (int y = 0; y < ISO_BRICK; y++)
            for (uint32_t seeds = seeds_of_row(&rows, surface->normal_sign, y, z) >> 1 & 0xffff; seeds;
                 seeds &= seeds - 1) {
                const int voxel[3] = {__builtin_ctz(seeds), y, z};
                if (foot_of(&field, window, surface, voxel, &out->points[out->count]))
                    out->count++;
                else
                    out->rejected++;
            }
}
