/* ray_tracer: where straight lines meet an isosurface of a trilinear field.
 *
 * Along a straight line the field of one cell is a cubic; its sign changes are found by splitting the cubic
 * at its critical points and refining each bracket (Marmitt, Kleer, Wald, Friedrich and Slusallek 2004, "Fast
 * and accurate ray-voxel intersection techniques"). Cells are visited by a grid walk (Amanatides and Woo
 * 1987) that steps over whole bricks where the isovalue is not crossed.
 *
 * No crossing is lost between two cells, and no tolerance is needed for that:
 * - a ray is represented by its points on the cells' faces. Each point is computed once and used by both
 * cells at the face, with its coordinate on the crossed axis set to exactly 0 or 1. With weights of exactly 0
 * and 1 both cells compute the same bits from the face's four corners, so that the last state in one cell is
 * the first state in the next;
 * - values are sums of products of corner values and weights in [0, 1]. If all corners are on one side of the
 *   isovalue, rounding cannot put a value on the other side, so that such cells and bricks can be skipped.
 *
 * A crossing is a change of state between "at or above the isovalue" and "below", as in extraction. A region
 * in which the field equals the isovalue is at or above it, and its border is the surface. */
#include "grids/ray/ray_tracer.h"

#include <float.h>
#include <math.h>

#include "base/memory.h"
#include "grids/ray/spline_ray.h"
#include "grids/threshold.h"

struct iso_ray_tracer {
    iso_grid grid;
    double isovalue; /* stored */
    iso_threshold surface;
    int bricks[3];
    uint8_t *crossed;  /* by brick, x fastest: 1 if the surface may cross its cells */
    uint64_t *blocks;  /* NULL, or by brick the crossed ones of its 64 blocks of 4^3 cells, x fastest */
    iso_affine affine; /* index to world */
    double outward;    /* sign from gradient to outward normal: 1 for a level set, else -1 */
    const iso_ray_field *field; /* of `spline`; NULL: the field is trilinear */
    const iso_spline *spline;
    const iso_hgrid *shell; /* of the spline, or NULL */
};

/* ---- the index over bricks */

static void mark_row(void *context, size_t index, int worker) {
    (void)worker;
    iso_ray_tracer *tracer = context;
    size_t row = (size_t)tracer->bricks[0];
    int brick[3] = {0, (int)(index % (size_t)tracer->bricks[1]), (int)(index / (size_t)tracer->bricks[1])};
    for (; brick[0] < tracer->bricks[0]; brick[0]++)
        tracer->crossed[index * row + (size_t)brick[0]] =
            tracer->field
                ? tracer->field->may_cross_brick(tracer->spline, brick, tracer->isovalue)
                : iso_grid_brick_may_cross(&tracer->grid, brick, tracer->surface.isovalue_ceil) != 0;
}

iso_status iso_ray_tracer_create_with(const iso_grid *grid, double isovalue, uint8_t *crossed,
                                      iso_ray_tracer **out, iso_error *error) {
    iso_ray_tracer *tracer = iso_alloc_zero(1, sizeof *tracer);
    if (!tracer) {
        iso_free(crossed);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for tracing rays");
    }
    tracer->grid = *grid;
    tracer->surface = iso_threshold_of(grid, isovalue);
    tracer->isovalue = (double)tracer->surface.isovalue_ceil + (double)tracer->surface.residual;
    tracer->affine = iso_transform_affine(iso_grid_transform(grid));
    tracer->outward = iso_grid_is_level_set(grid) ? 1 : -1;
    iso_grid_bricks(grid, tracer->bricks);
    tracer->crossed = crossed;
    *out = tracer;
    return ISO_OK;
}

iso_status iso_ray_tracer_create_field(const iso_grid *grid, const iso_ray_field *field,
                                       const iso_spline *spline, double isovalue, const iso_hgrid *shell,
                                       iso_pool *pool, iso_ray_tracer **tracer, iso_error *error) {
    int bricks[3];
    iso_grid_bricks(grid, bricks);
    const size_t rows = (size_t)bricks[1] * (size_t)bricks[2];
    uint8_t *crossed = iso_alloc_zero(rows, (size_t)bricks[0]);
    if (!crossed)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the index of %zu brick rows", rows);
    iso_ray_tracer *made = NULL;
    ISO_TRY(iso_ray_tracer_create_with(grid, isovalue, crossed, &made, error));
    made->field = field;
    made->spline = spline;
    made->shell = shell;
    iso_parallel_until(pool, rows, mark_row, made);
    const iso_status status = iso_pool_check(pool, "the rays' index", error);
    if (status == ISO_OK)
        *tracer = made;
    else
        iso_ray_tracer_destroy(made);
    return status;
}

iso_status iso_ray_tracer_create(const iso_grid *grid, double isovalue, iso_pool *pool,
                                 iso_ray_tracer **tracer, iso_error *error) {
    return iso_ray_tracer_create_field(grid, NULL, NULL, isovalue, NULL, pool, tracer, error);
}

void iso_ray_tracer_destroy(iso_ray_tracer *tracer) {
    if (!tracer) return;
    iso_free(tracer->crossed);
    iso_free(tracer->blocks);
    iso_free(tracer);
}

/* The number of the brick of a cell. */
static size_t brick_of(const iso_ray_tracer *tracer, const int cell[3]) {
    size_t row = (size_t)(cell[2] / ISO_BRICK) * (size_t)tracer->bricks[1] + (size_t)(cell[1] / ISO_BRICK);
    return row * (size_t)tracer->bricks[0] + (size_t)(cell[0] / ISO_BRICK);
}

enum { BLOCK = 4, BLOCKS = ISO_BRICK / BLOCK }; /* cells of a block, blocks of a brick, on a side */

/* Whether voxels of a block lie on both sides of the isovalue. first: the block's first voxel in a window. */
static bool is_block_crossed(const float *first, float isovalue_ceil) {
    const bool inside = *first >= isovalue_ceil;
    for (int z = 0; z <= BLOCK; z++)
        for (int y = 0; y <= BLOCK; y++)
            for (int x = 0; x <= BLOCK; x++)
                if ((first[(z * ISO_WINDOW + y) * ISO_WINDOW + x] >= isovalue_ceil) != inside) return true;
    return false;
}

/* The blocks whose cells a spline may cross. */
static uint64_t crossed_by_spline(const iso_ray_tracer *tracer, const int brick[3]) {
    uint64_t blocks = 0;
    for (int i = 0; i < BLOCKS * BLOCKS * BLOCKS; i++) {
        const int at[3] = {i % BLOCKS, i / BLOCKS % BLOCKS, i / (BLOCKS * BLOCKS)};
        const int cell[3] = {brick[0] * ISO_BRICK + at[0] * BLOCK, brick[1] * ISO_BRICK + at[1] * BLOCK,
                             brick[2] * ISO_BRICK + at[2] * BLOCK};
        blocks |= (uint64_t)tracer->field->may_cross_cells(tracer->spline, cell, BLOCK, tracer->isovalue)
                  << i;
    }
    return blocks;
}

static uint64_t crossed_blocks(const iso_ray_tracer *tracer, const int brick[3]) {
    if (tracer->field) return crossed_by_spline(tracer, brick);
    float window[ISO_WINDOW_VOXELS];
    uint64_t blocks = 0;
    iso_grid_window(&tracer->grid, brick, window);
    for (int i = 0; i < BLOCKS * BLOCKS * BLOCKS; i++) {
        const int x = i % BLOCKS, y = i / BLOCKS % BLOCKS, z = i / (BLOCKS * BLOCKS);
        const float *first =
            window + ((z * BLOCK + ISO_WINDOW_LOW) * ISO_WINDOW + y * BLOCK + ISO_WINDOW_LOW) * ISO_WINDOW +
            x * BLOCK + ISO_WINDOW_LOW;
        blocks |= (uint64_t)is_block_crossed(first, tracer->surface.isovalue_ceil) << i;
    }
    return blocks;
}

static void refine_row(void *context, size_t index, int worker) {
    (void)worker;
    iso_ray_tracer *tracer = context;
    const size_t row = (size_t)tracer->bricks[0];
    int brick[3] = {0, (int)(index % (size_t)tracer->bricks[1]), (int)(index / (size_t)tracer->bricks[1])};
    for (; brick[0] < tracer->bricks[0]; brick[0]++) {
        const size_t at = index * row + (size_t)brick[0];
        if (tracer->crossed[at]) tracer->blocks[at] = crossed_blocks(tracer, brick);
    }
}

iso_status iso_ray_tracer_refine(iso_ray_tracer *tracer, iso_pool *pool, iso_error *error) {
    const size_t rows = (size_t)tracer->bricks[1] * (size_t)tracer->bricks[2];
    if (tracer->blocks) return ISO_OK;
    tracer->blocks = iso_alloc_zero(rows * (size_t)tracer->bricks[0], sizeof *tracer->blocks);
    if (!tracer->blocks)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the index of %zu brick rows", rows);
    iso_parallel_until(pool, rows, refine_row, tracer);
    const iso_status status = iso_pool_check(pool, "the rays' index", error);
    if (status != ISO_OK) {
        iso_free(tracer->blocks);
        tracer->blocks = NULL;
    }
    return status;
}

/* The side in cells of the largest block with this cell that a ray can step over at once; 1: the cell may be
 * crossed. */
static int skipped_side(const iso_ray_tracer *tracer, const int cell[3]) {
    const size_t brick = brick_of(tracer, cell);
    if (!tracer->crossed[brick]) return ISO_BRICK;
    if (!tracer->blocks) return 1;
    const int x = cell[0] % ISO_BRICK / BLOCK, y = cell[1] % ISO_BRICK / BLOCK,
              z = cell[2] % ISO_BRICK / BLOCK;
    return tracer->blocks[brick] >> ((z * BLOCKS + y) * BLOCKS + x) & 1 ? 1 : BLOCK;
}

/* ---- the corners of a cell: bit 0 of a corner's number is +x, bit 1 +y, bit 2 +z */

#define COPY_CORNERS(type)                                                                                   \
    do {                                                                                                     \
        const type *from = (const type *)data + first;                                                       \
        for (int i = 0; i < 8; i++)                                                                          \
            corner[i] = (float)from[(i & 1) + (i >> 1 & 1) * stride_y + (i >> 2) * stride_z];                \
    } while (0)

static void copy_corners(const void *data, iso_type type, const ptrdiff_t strides[2], ptrdiff_t first,
                         float corner[8]) {
    ptrdiff_t stride_y = strides[0], stride_z = strides[1];
    switch (type) {
    case ISO_UINT8:
        COPY_CORNERS(uint8_t);
        break;
    case ISO_INT16:
        COPY_CORNERS(int16_t);
        break;
    case ISO_UINT16:
        COPY_CORNERS(uint16_t);
        break;
    default:
        COPY_CORNERS(float);
    }
}

static void read_corners(const iso_grid *grid, const int cell[3], float corner[8]) {
    if (grid->rgrid) {
        const iso_rgrid *rgrid = grid->rgrid;
        const ptrdiff_t strides[2] = {rgrid->stride_y, rgrid->stride_z};
        copy_corners(rgrid->data, rgrid->type, strides, cell[0] + cell[1] * strides[0] + cell[2] * strides[1],
                     corner);
        return;
    }
    const iso_hgrid *hgrid = grid->hgrid;
    const int in[3] = {cell[0] % ISO_BRICK, cell[1] % ISO_BRICK, cell[2] % ISO_BRICK};
    int32_t brick = hgrid->cell[iso_hgrid_cell_index(hgrid, cell[0] / ISO_BRICK, cell[1] / ISO_BRICK,
                                                     cell[2] / ISO_BRICK)];
    const int last = ISO_BRICK - 1;
    if (brick >= 0 && in[0] < last && in[1] < last && in[2] < last) {
        const ptrdiff_t strides[2] = {ISO_BRICK, ISO_BRICK * ISO_BRICK};
        copy_corners(iso_hgrid_brick(hgrid, brick), ISO_FLOAT32, strides,
                     in[0] + in[1] * strides[0] + in[2] * strides[1], corner);
        return;
    }
    for (int i = 0; i < 8; i++)
        corner[i] = iso_hgrid_at(hgrid, cell[0] + (i & 1), cell[1] + (i >> 1 & 1), cell[2] + (i >> 2));
}

/* ---- one cell */

static double mix(double a, double b, double weight) {
    return a * (1 - weight) + b * weight;
}

/* The field minus the isovalue at s. */
static double segment_value(const iso_ray_segment *segment, double s) {
    double u = mix(segment->from[0], segment->to[0], s), v = mix(segment->from[1], segment->to[1], s),
           w = mix(segment->from[2], segment->to[2], s);
    const double *c = segment->corner;
    return mix(mix(mix(c[0], c[1], u), mix(c[2], c[3], u), v), mix(mix(c[4], c[5], u), mix(c[6], c[7], u), v),
               w);
}

/* The coefficients of the field as a cubic in s, to a few ulps of the largest corner. They are used to choose
 * where to evaluate the field; signs are always those of segment_value. */
static void segment_cubic(const iso_ray_segment *segment, double cubic[4]) {
    const double *c = segment->corner, *from = segment->from;
    double du = segment->to[0] - from[0], dv = segment->to[1] - from[1], dw = segment->to[2] - from[2];
    double square[2][3];
    for (int z = 0; z < 2; z++) {
        const double *face = c + 4 * z;
        double low = mix(face[0], face[1], from[0]), low_slope = (face[1] - face[0]) * du;
        double high = mix(face[2], face[3], from[0]), high_slope = (face[3] - face[2]) * du;
        square[z][0] = mix(low, high, from[1]);
        square[z][1] = mix(low_slope, high_slope, from[1]) + (high - low) * dv;
        square[z][2] = (high_slope - low_slope) * dv;
    }
    cubic[0] = mix(square[0][0], square[1][0], from[2]);
    for (int power = 1; power < 3; power++)
        cubic[power] = mix(square[0][power], square[1][power], from[2]) +
                       (square[1][power - 1] - square[0][power - 1]) * dw;
    cubic[3] = (square[1][2] - square[0][2]) * dw;
}

/* Sets `split` to 0, the cubic's critical points in (0, 1) in ascending order, and 1; returns how many
 * numbers these are (2 to 4). Where a divisor is 0 the quotients are infinite or NaN, and the comparisons are
 * false. */
static int split_points(const double cubic[4], double split[4]) {
    double a = 3 * cubic[3], half = cubic[2], c = cubic[1];
    int count = 0;
    split[count++] = 0;
    double discriminant = half * half - a * c;
    if (discriminant >= 0) {
        double q = -(half + (half < 0 ? -1 : 1) * sqrt(discriminant));
        double first = q / a, second = c / q;
        if (first > second) {
            double swap = first;
            first = second;
            second = swap;
        }
        if (first > 0 && first < 1) split[count++] = first;
        if (second > 0 && second < 1) split[count++] = second;
    }
    split[count++] = 1;
    return count;
}

/* The s of the only change of state in [low, high], whose ends have different states: by Newton's method, or
 * by bisection where that would leave the bracket. The tolerance is far below the 1e-4 voxel that the header
 * promises (a segment is at most sqrt(3) voxels long) and above the rounding of s. */
static double refine_root(const iso_ray_segment *segment, const double cubic[4], double low, double high) {
    const double tolerance = 1e-12;
    bool low_state = segment_value(segment, low) >= 0;
    double s = 0.5 * (low + high);
    for (int step = 0; step < 100 && high - low > tolerance; step++) {
        double value = segment_value(segment, s);
        if ((value >= 0) == low_state)
            low = s;
        else
            high = s;
        double next = s - value / (cubic[1] + s * (2 * cubic[2] + s * 3 * cubic[3]));
        if (fabs(next - s) < tolerance && next >= low && next <= high) return next;
        s = next >= low && next <= high && step % 4 != 3 ? next : 0.5 * (low + high);
    }
    return 0.5 * (low + high);
}

/* ---- walking along a ray */

static double clamp_unit(double x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Moves the ray to the first cell of the volume on the ray from parameter t0 on; false if the ray misses the
 * volume. A ray that enters through a face of the volume starts exactly on it, so that a surface in the
 * outermost plane of voxels is found. */
static bool enter_volume(iso_ray *ray, const int dims[3], double t0) {
    double t1 = DBL_MAX;
    int face = -1;
    for (int axis = 0; axis < 3; axis++) {
        double origin = ray->origin[axis], last = dims[axis] - 1;
        if (last < 1) return false; /* one voxel thick: no cells */
        if (ray->direction[axis] == 0) {
            if (origin < 0 || origin > last) return false;
            continue;
        }
        double first = (0 - origin) * ray->inverse[axis], second = (last - origin) * ray->inverse[axis];
        if (fmin(first, second) > t0) {
            t0 = fmin(first, second);
            face = axis;
        }
        t1 = fmin(t1, fmax(first, second));
    }
    if (!(t0 <= t1)) return false;
    ray->t = t0;
    for (int axis = 0; axis < 3; axis++) {
        double p = ray->origin[axis] + t0 * ray->direction[axis];
        if (axis == face) p = ray->direction[axis] > 0 ? 0 : dims[axis] - 1;
        double cell = fmin(fmax(floor(p), 0), dims[axis] - 2);
        ray->cell[axis] = (int)cell;
        ray->local[axis] = clamp_unit(p - cell);
    }
    return true;
}

/* The axis on which the ray leaves a box of cells, and the parameter *t there; -1 if it has no direction. low
 * and high: the grid planes that bound the box. The parameter of a plane does not depend on the box, so that
 * steps over bricks and over cells lead to the same bits. */
static int exit_axis(const iso_ray *ray, const int low[3], const int high[3], double *t) {
    int best = -1;
    for (int axis = 0; axis < 3; axis++) {
        if (ray->direction[axis] == 0) continue;
        int plane = ray->direction[axis] > 0 ? high[axis] : low[axis];
        double at = (plane - ray->origin[axis]) * ray->inverse[axis];
        if (best < 0 || at < *t) {
            best = axis;
            *t = at;
        }
    }
    if (*t < ray->t) *t = ray->t; /* after rounding, the ray may have left the first cell already */
    return best;
}

/* Moves the ray to the cell behind a box of cells that the ray leaves through `axis` at parameter t. On the
 * other axes the cell stays within the box. */
static void leave_box(iso_ray *ray, const int low[3], const int high[3], int axis, double t) {
    for (int i = 0; i < 3; i++) {
        double p = ray->origin[i] + t * ray->direction[i];
        if (high[i] - low[i] > 1) {
            const int cell = (int)p; /* rounded down: where p is below 0, it is below `low` as well */
            ray->cell[i] = cell < low[i] ? low[i] : cell >= high[i] ? high[i] - 1 : cell;
        }
        ray->local[i] = clamp_unit(p - ray->cell[i]);
    }
    bool up = ray->direction[axis] > 0;
    ray->cell[axis] = up ? high[axis] : low[axis] - 1;
    ray->local[axis] = up ? 0 : 1;
    ray->t = t;
}

/* Finds the crossings of a spline in the cell that the ray has just left. */
static void cross_spline(const iso_ray_tracer *tracer, iso_ray *ray) {
    iso_spline_crossings found;
    if (!tracer->field->cross(tracer->spline, tracer->shell, tracer->isovalue, ray->current,
                              ray->segment.from, ray->segment.to, &found)) {
        ray->chained = false;
        return;
    }
    if (!ray->chained) ray->state = found.first;
    /* where rounding has moved a crossing over the face between two cells, it is on the face */
    bool state = ray->state;
    ray->pieces = ray->piece = 0;
    if (state != found.first) ray->split[ray->pieces++] = 0;
    for (int i = 0; i < found.count; i++) ray->split[ray->pieces++] = found.root[i];
    state ^= ray->pieces & 1;
    if (state != found.last && ray->pieces < ISO_SPLINE_ROOTS + 1) ray->split[ray->pieces++] = 1;
    ray->chained = true;
}

/* Sets the segment's corners; false when the cell is not crossed or has a corner that is not finite. */
static bool load_cell(const iso_ray_tracer *tracer, const int cell[3], iso_ray_segment *segment) {
    float corner[8];
    read_corners(&tracer->grid, cell, corner);
    int inside = 0;
    for (int i = 0; i < 8; i++) inside += corner[i] >= tracer->surface.isovalue_ceil;
    if (inside == 0 || inside == 8) return false;
    for (int i = 0; i < 8; i++) {
        if (!isfinite(corner[i])) return false;
        segment->corner[i] = (double)corner[i] - tracer->isovalue;
    }
    return true;
}

/* Moves the ray to its next cell, or over a block that is not crossed; true when the cell that it leaves is
 * crossed: its crossings can then be returned. */
static bool enter_cell(const iso_ray_tracer *tracer, iso_ray *ray) {
    const int *dims = iso_grid_dims(&tracer->grid);
    int low[3], high[3];
    const int side = skipped_side(tracer, ray->cell);
    for (int i = 0; i < 3; i++) {
        low[i] = ray->cell[i] & -side;
        high[i] = low[i] + side;
        if (high[i] > dims[i] - 1) high[i] = dims[i] - 1;
    }
    ray->enter = ray->t;
    const int axis = exit_axis(ray, low, high, &ray->leave);
    if (axis < 0) {
        ray->done = true;
        return false;
    }
    const bool crossed = side == 1 && (tracer->field || load_cell(tracer, ray->cell, &ray->segment));
    for (int i = 0; i < 3; i++) {
        ray->current[i] = ray->cell[i];
        ray->segment.from[i] = ray->local[i];
    }
    leave_box(ray, low, high, axis, ray->leave);
    for (int i = 0; i < 3; i++) ray->segment.to[i] = ray->local[i];
    ray->segment.to[axis] = 1 - ray->local[axis]; /* the exit face, in the coordinates of the old cell */
    ray->done = ray->cell[axis] < 0 || ray->cell[axis] > dims[axis] - 2;
    if (!crossed) ray->chained = false;
    return crossed;
}

/* Splits the field along the ray in the current cell into monotone pieces. */
static void start_pieces(const iso_ray_tracer *tracer, iso_ray *ray) {
    if (tracer->field) {
        cross_spline(tracer, ray);
        return;
    }
    segment_cubic(&ray->segment, ray->cubic);
    ray->pieces = split_points(ray->cubic, ray->split) - 1;
    ray->piece = 0;
    ray->state = segment_value(&ray->segment, 0) >= 0;
}

/* Finds the next crossing in the current cell. */
static bool next_in_cell(const iso_ray_tracer *tracer, iso_ray *ray, iso_ray_hit *hit) {
    while (ray->piece < ray->pieces) {
        const double low = ray->split[ray->piece], high = ray->split[++ray->piece];
        const bool before = ray->state;
        ray->state = tracer->field ? !before : segment_value(&ray->segment, high) >= 0;
        if (ray->state == before) continue;
        const double s = tracer->field ? low : refine_root(&ray->segment, ray->cubic, low, high);
        hit->t = ray->enter + s * (ray->leave - ray->enter);
        hit->falls = before;
        for (int i = 0; i < 3; i++) {
            hit->cell[i] = ray->current[i];
            hit->local[i] = mix(ray->segment.from[i], ray->segment.to[i], s);
        }
        return true;
    }
    return false;
}

bool iso_ray_next(const iso_ray_tracer *tracer, iso_ray *ray, iso_ray_hit *hit) {
    while (!next_in_cell(tracer, ray, hit)) {
        if (ray->done) return false;
        ray->pieces = ray->piece = 0;
        if (enter_cell(tracer, ray)) start_pieces(tracer, ray);
    }
    return true;
}

bool iso_ray_start(const iso_ray_tracer *tracer, iso_vec3 origin, iso_vec3 direction, double t0,
                   iso_ray *ray) {
    const iso_vec3 o = iso_affine_point_to_index(&tracer->affine, origin),
                   d = iso_affine_vector_to_index(&tracer->affine, direction);
    *ray = (iso_ray){.origin = {o.x, o.y, o.z}, .direction = {d.x, d.y, d.z}, .along = direction};
    for (int axis = 0; axis < 3; axis++) {
        ray->inverse[axis] = 1 / ray->direction[axis];
        /* a component so small that its inverse overflows counts as 0 */
        if (!isfinite(ray->inverse[axis])) ray->direction[axis] = 0;
    }
    return enter_volume(ray, iso_grid_dims(&tracer->grid), t0);
}

bool iso_ray_starts_above(const iso_ray_tracer *tracer, const iso_ray *ray) {
    float corner[8];
    iso_ray_segment segment;
    if (tracer->field)
        return tracer->field->is_above(tracer->spline, tracer->isovalue, ray->cell, ray->local);
    read_corners(&tracer->grid, ray->cell, corner);
    for (int i = 0; i < 8; i++) {
        if (!isfinite(corner[i])) return false;
        segment.corner[i] = (double)corner[i] - tracer->isovalue;
    }
    for (int i = 0; i < 3; i++) segment.from[i] = segment.to[i] = ray->local[i];
    return segment_value(&segment, 0) >= 0;
}

double iso_ray_end(const iso_ray_tracer *tracer, const iso_ray *ray) {
    const int *dims = iso_grid_dims(&tracer->grid);
    const int low[3] = {0, 0, 0}, high[3] = {dims[0] - 1, dims[1] - 1, dims[2] - 1};
    double t = ray->t;
    exit_axis(ray, low, high, &t);
    return t;
}

/* The trilinear interpolation of the gradients at the corners of the hit's cell, or the spline's gradient. */
static iso_vec3 hit_gradient(const iso_ray_tracer *tracer, const iso_ray_hit *hit) {
    iso_vec3 sum = {0, 0, 0};
    const iso_grid *grid = &tracer->grid;
    if (tracer->field) return tracer->field->gradient(tracer->spline, hit->cell, hit->local);
    for (int i = 0; i < 8; i++) {
        int x = i & 1, y = i >> 1 & 1, z = i >> 2;
        double weight = (x ? hit->local[0] : 1 - hit->local[0]) * (y ? hit->local[1] : 1 - hit->local[1]) *
                        (z ? hit->local[2] : 1 - hit->local[2]);
        iso_vec3 gradient =
            iso_grid_voxel_gradient(grid, hit->cell[0] + x, hit->cell[1] + y, hit->cell[2] + z);
        sum = iso_vec3_add(sum, iso_vec3_scale(gradient, weight));
    }
    return sum;
}

iso_vec3 iso_ray_hit_normal(const iso_ray_tracer *tracer, const iso_ray *ray, const iso_ray_hit *hit) {
    const iso_vec3 gradient = hit_gradient(tracer, hit),
                   normal = iso_affine_normal(&tracer->affine, iso_vec3_scale(gradient, tracer->outward));
    if (iso_vec3_dot(normal, normal) > 0) return normal;
    return iso_vec3_unit(iso_vec3_scale(ray->along, -1));
}
