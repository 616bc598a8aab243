/* raycast: ray casting of the trilinear field.
 *
 * Along a straight line the field of one cell is a cubic; its first sign change is found by splitting the
 * cubic at its critical points and refining the first bracket (Marmitt, Kleer, Wald, Friedrich and Slusallek
 * 2004, "Fast and accurate ray-voxel intersection techniques"). Cells are visited by a grid walk (Amanatides
 * and Woo 1987) that steps over whole bricks where the isovalue is not crossed.
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
#include "truth/raycast.h"

#include <float.h>
#include <math.h>

#include "base/memory.h"
#include "grids/threshold.h"

enum { ROWS_PER_TASK = 8 };

struct iso_raycaster {
    iso_grid grid;
    double isovalue; /* stored */
    iso_threshold surface;
    int bricks[3];
    uint8_t *crossed; /* by brick, x fastest: 1 if the surface may cross its cells */
};

/* ---- the index over bricks */

static void mark_row(void *context, size_t index, int worker) {
    (void)worker;
    iso_raycaster *caster = context;
    size_t row = (size_t)caster->bricks[0];
    int brick[3] = {0, (int)(index % (size_t)caster->bricks[1]), (int)(index / (size_t)caster->bricks[1])};
    for (; brick[0] < caster->bricks[0]; brick[0]++)
        caster->crossed[index * row + (size_t)brick[0]] =
            iso_grid_brick_may_cross(&caster->grid, brick, caster->surface.isovalue_ceil) != 0;
}

iso_status iso_raycaster_create(const iso_grid *grid, double isovalue, iso_pool *pool, iso_raycaster **out,
                                iso_error *error) {
    iso_raycaster *caster = iso_alloc_zero(1, sizeof *caster);
    if (!caster) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the ray caster");
    caster->grid = *grid;
    caster->surface = iso_threshold_of(grid, isovalue);
    caster->isovalue = (double)caster->surface.isovalue_ceil + (double)caster->surface.residual;
    iso_grid_bricks(grid, caster->bricks);
    size_t rows = (size_t)caster->bricks[1] * (size_t)caster->bricks[2];
    caster->crossed = iso_alloc_zero(rows, (size_t)caster->bricks[0]);
    if (!caster->crossed) {
        iso_raycaster_destroy(caster);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the ray caster's %zu brick rows", rows);
    }
    iso_parallel_for(pool, rows, mark_row, caster);
    *out = caster;
    return ISO_OK;
}

void iso_raycaster_destroy(iso_raycaster *caster) {
    if (!caster) return;
    iso_free(caster->crossed);
    iso_free(caster);
}

static bool is_crossed(const iso_raycaster *caster, const int cell[3]) {
    size_t row = (size_t)(cell[2] / ISO_BRICK) * (size_t)caster->bricks[1] + (size_t)(cell[1] / ISO_BRICK);
    return caster->crossed[row * (size_t)caster->bricks[0] + (size_t)(cell[0] / ISO_BRICK)];
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

/* The part of a ray that lies in a cell, from s = 0 at `from` to s = 1 at `to`, in the cell's coordinates [0,
 * 1]. */
typedef struct cell_segment {
    double corner[8]; /* values minus isovalue (rounding does not change the sign of a difference) */
    double from[3], to[3];
} cell_segment;

static double mix(double a, double b, double weight) {
    return a * (1 - weight) + b * weight;
}

/* The field minus the isovalue at s. */
static double segment_value(const cell_segment *segment, double s) {
    double u = mix(segment->from[0], segment->to[0], s), v = mix(segment->from[1], segment->to[1], s),
           w = mix(segment->from[2], segment->to[2], s);
    const double *c = segment->corner;
    return mix(mix(mix(c[0], c[1], u), mix(c[2], c[3], u), v), mix(mix(c[4], c[5], u), mix(c[6], c[7], u), v),
               w);
}

/* The coefficients of the field as a cubic in s, to a few ulps of the largest corner. They are used to choose
 * where to evaluate the field; signs are always those of segment_value. */
static void segment_cubic(const cell_segment *segment, double cubic[4]) {
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
static double refine_root(const cell_segment *segment, const double cubic[4], double low, double high) {
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

/* The s of the first change of state, or -1 if there is none. */
static double first_change(const cell_segment *segment) {
    double cubic[4], split[4];
    segment_cubic(segment, cubic);
    int count = split_points(cubic, split);
    bool state = segment_value(segment, 0) >= 0;
    for (int i = 1; i < count; i++)
        if ((segment_value(segment, split[i]) >= 0) != state)
            return refine_root(segment, cubic, split[i - 1], split[i]);
    return -1;
}

/* ---- walking along a ray */

/* A ray in index coordinates, and the position that the walk has reached. */
typedef struct grid_walk {
    double origin[3], direction[3], inverse[3];
    int cell[3];
    double t;        /* parameter where the ray enters the cell */
    double local[3]; /* position there in the cell's coordinates, [0, 1] */
} grid_walk;

typedef struct ray_hit {
    double t;
    int cell[3];
    double local[3];
} ray_hit;

static double clamp_unit(double x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Moves the walk to the first cell of the volume on the ray from parameter t0 on; false if the ray misses the
 * volume. A ray that enters through a face of the volume starts exactly on it, so that a surface in the
 * outermost plane of voxels is found. */
static bool enter_volume(grid_walk *walk, const int dims[3], double t0) {
    double t1 = DBL_MAX;
    int face = -1;
    for (int axis = 0; axis < 3; axis++) {
        double origin = walk->origin[axis], last = dims[axis] - 1;
        if (last < 1) return false; /* one voxel thick: no cells */
        if (walk->direction[axis] == 0) {
            if (origin < 0 || origin > last) return false;
            continue;
        }
        double first = (0 - origin) * walk->inverse[axis], second = (last - origin) * walk->inverse[axis];
        if (fmin(first, second) > t0) {
            t0 = fmin(first, second);
            face = axis;
        }
        t1 = fmin(t1, fmax(first, second));
    }
    if (!(t0 <= t1)) return false;
    walk->t = t0;
    for (int axis = 0; axis < 3; axis++) {
        double p = walk->origin[axis] + t0 * walk->direction[axis];
        if (axis == face) p = walk->direction[axis] > 0 ? 0 : dims[axis] - 1;
        double cell = fmin(fmax(floor(p), 0), dims[axis] - 2);
        walk->cell[axis] = (int)cell;
        walk->local[axis] = clamp_unit(p - cell);
    }
    return true;
}

/* The axis on which the ray leaves a box of cells, and the parameter *t there; -1 if it has no direction. low
 * and high: the grid planes that bound the box. The parameter of a plane does not depend on the box, so that
 * steps over bricks and over cells lead to the same bits. */
static int exit_axis(const grid_walk *walk, const int low[3], const int high[3], double *t) {
    int best = -1;
    for (int axis = 0; axis < 3; axis++) {
        if (walk->direction[axis] == 0) continue;
        int plane = walk->direction[axis] > 0 ? high[axis] : low[axis];
        double at = (plane - walk->origin[axis]) * walk->inverse[axis];
        if (best < 0 || at < *t) {
            best = axis;
            *t = at;
        }
    }
    if (*t < walk->t) *t = walk->t; /* after rounding, the ray may have left the first cell already */
    return best;
}

/* Moves the walk to the cell behind a box of cells that the ray leaves through `axis` at parameter t. On the
 * other axes the cell stays within the box. */
static void leave_box(grid_walk *walk, const int low[3], const int high[3], int axis, double t) {
    for (int i = 0; i < 3; i++) {
        double p = walk->origin[i] + t * walk->direction[i];
        if (high[i] - low[i] > 1) walk->cell[i] = (int)fmin(fmax(floor(p), low[i]), high[i] - 1);
        walk->local[i] = clamp_unit(p - walk->cell[i]);
    }
    bool up = walk->direction[axis] > 0;
    walk->cell[axis] = up ? high[axis] : low[axis] - 1;
    walk->local[axis] = up ? 0 : 1;
    walk->t = t;
}

/* Sets the segment's corners; false when the cell is not crossed or has a corner that is not finite. */
static bool load_cell(const iso_raycaster *caster, const int cell[3], cell_segment *segment) {
    float corner[8];
    read_corners(&caster->grid, cell, corner);
    int inside = 0;
    for (int i = 0; i < 8; i++) inside += corner[i] >= caster->surface.isovalue_ceil;
    if (inside == 0 || inside == 8) return false;
    for (int i = 0; i < 8; i++) {
        if (!isfinite(corner[i])) return false;
        segment->corner[i] = (double)corner[i] - caster->isovalue;
    }
    return true;
}

/* Walks along the ray to the first crossing; false when there is none. Steps over bricks that are not
 * crossed. */
static bool find_hit(const iso_raycaster *caster, grid_walk *walk, ray_hit *hit) {
    const int *dims = iso_grid_dims(&caster->grid);
    cell_segment segment;
    for (;;) {
        int low[3], high[3];
        bool skip = !is_crossed(caster, walk->cell);
        for (int i = 0; i < 3; i++) {
            low[i] = skip ? walk->cell[i] / ISO_BRICK * ISO_BRICK : walk->cell[i];
            high[i] = low[i] + (skip ? ISO_BRICK : 1);
            if (high[i] > dims[i] - 1) high[i] = dims[i] - 1;
        }
        double t_exit = 0, t_entry = walk->t;
        int axis = exit_axis(walk, low, high, &t_exit);
        if (axis < 0) return false;
        bool crossed = !skip && load_cell(caster, walk->cell, &segment);
        for (int i = 0; i < 3; i++) {
            hit->cell[i] = walk->cell[i];
            segment.from[i] = walk->local[i];
        }
        leave_box(walk, low, high, axis, t_exit);
        if (crossed) {
            for (int i = 0; i < 3; i++) segment.to[i] = walk->local[i];
            segment.to[axis] = 1 - walk->local[axis]; /* the exit face, in the coordinates of the old cell */
            double s = first_change(&segment);
            if (s >= 0) {
                hit->t = t_entry + s * (t_exit - t_entry);
                for (int i = 0; i < 3; i++) hit->local[i] = mix(segment.from[i], segment.to[i], s);
                return true;
            }
        }
        if (walk->cell[axis] < 0 || walk->cell[axis] > dims[axis] - 2) return false;
    }
}

/* ---- the picture */

typedef struct cast_context {
    const iso_target *target;
    const iso_raycaster *caster;
    iso_affine affine;
    double outward; /* sign from gradient to outward normal: 1 for a level set, else -1 */
} cast_context;

/* The gradient at a hit: the trilinear interpolation of the gradients at the cell's corners. */
static iso_vec3 hit_gradient(const iso_grid *grid, const ray_hit *hit) {
    iso_vec3 sum = {0, 0, 0};
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

static void cast_sample(const cast_context *cast, int x, int y) {
    const iso_view *view = cast->target->view;
    iso_gbuffer *gbuffer = cast->target->gbuffer;
    iso_vec3 origin, direction;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    iso_vec3 o = iso_affine_point_to_index(&cast->affine, origin);
    iso_vec3 d = iso_affine_vector_to_index(&cast->affine, direction);
    grid_walk walk = {.origin = {o.x, o.y, o.z}, .direction = {d.x, d.y, d.z}};
    for (int axis = 0; axis < 3; axis++) {
        walk.inverse[axis] = 1 / walk.direction[axis];
        /* a component so small that its inverse overflows counts as 0 */
        if (!isfinite(walk.inverse[axis])) walk.direction[axis] = 0;
    }
    const iso_grid *grid = &cast->caster->grid;
    ray_hit hit;
    if (!enter_volume(&walk, iso_grid_dims(grid), view->near) || !find_hit(cast->caster, &walk, &hit)) return;
    size_t sample = (size_t)y * (size_t)gbuffer->width + (size_t)x;
    if (!((float)hit.t < gbuffer->depth[sample])) return;
    iso_vec3 gradient = hit_gradient(grid, &hit);
    iso_vec3 normal = iso_affine_normal(&cast->affine, iso_vec3_scale(gradient, cast->outward));
    if (!(iso_vec3_dot(normal, normal) > 0)) normal = iso_vec3_unit(iso_vec3_scale(direction, -1));
    normal = iso_view_vector(view, normal);
    gbuffer->depth[sample] = (float)hit.t;
    gbuffer->normal[0][sample] = (float)normal.x;
    gbuffer->normal[1][sample] = (float)normal.y;
    gbuffer->normal[2][sample] = (float)normal.z;
    gbuffer->surface[sample] = cast->target->surface;
}

static void cast_rows(void *context, size_t index, int worker) {
    (void)worker;
    const cast_context *cast = context;
    int first = (int)index * ROWS_PER_TASK, end = first + ROWS_PER_TASK;
    if (end > cast->target->gbuffer->height) end = cast->target->gbuffer->height;
    for (int y = first; y < end; y++)
        for (int x = 0; x < cast->target->gbuffer->width; x++) cast_sample(cast, x, y);
}

iso_status iso_draw_raycast(const iso_target *target, const iso_raycaster *caster, iso_error *error) {
    (void)error;
    cast_context cast = {target, caster, iso_transform_affine(iso_grid_transform(&caster->grid)),
                         iso_grid_is_level_set(&caster->grid) ? 1 : -1};
    size_t bands = ((size_t)target->gbuffer->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    iso_parallel_for(target->pool, bands, cast_rows, &cast);
    return ISO_OK;
}
