/* brick_distances: prepares triangles for the kernels (brick_distances_body.inc). */
#include "grids/closing/brick_distances.h"

#include <math.h>

#include "base/cpu.h"

/* A side of a triangle, in voxels from the brick's first one. */
typedef struct near_side {
    float from[3], way[3]; /* the corner where it begins; the way to the next one */
    float rise[3];         /* way / |way|^2: along the side from 0 to 1 */
    float inward[3];       /* the unit vector in the triangle's plane that leads inside, across the side */
} near_side;

/* A triangle as the kernels need it. Unit: voxels, from the brick's first one. */
typedef struct near_triangle {
    int lo[3], hi[3];           /* the voxels of the brick that it may be near to */
    float box_lo[3], box_hi[3]; /* its box */
    near_side sides[3];
    float normal[3], plane; /* the distance from the plane is normal * p + plane */
    float reach;            /* how far outside a point may count as above the triangle */
    float slack,
        most; /* what is added to squared bounds, and to that of the band, for the rounding of floats */
} near_triangle;

/* The distance of a place from an interval. */
static inline float gap(float lo, float hi, float at) {
    return at < lo ? lo - at : at > hi ? at - hi : 0;
}

static inline int larger(int a, int b) {
    return a > b ? a : b;
}

static inline int smaller(int a, int b) {
    return a < b ? a : b;
}

#define ISO_KERNEL_BODY "grids/closing/brick_distances_body.inc"
#include "base/kernel_levels.inc"

typedef int find_near_fn(const near_triangle *t, const float *bound, uint16_t *near);

typedef struct measuring {
    const iso_brick_place *brick;
    double band; /* voxels */
    double *squared;
    find_near_fn *find_near;
    float bound[ISO_BRICK_VOXELS]; /* squared, in voxels */
    uint16_t near[ISO_BRICK_VOXELS];
} measuring;

/* Sets the box of voxels; false: none is near. */
static bool set_range(const measuring *m, near_triangle *t, const double p[3][3]) {
    for (int axis = 0; axis < 3; axis++) {
        const double lo = fmin(fmin(p[0][axis], p[1][axis]), p[2][axis]),
                     hi = fmax(fmax(p[0][axis], p[1][axis]), p[2][axis]);
        if (!(hi + m->band >= 0 && lo - m->band <= ISO_BRICK - 1)) return false;
        t->box_lo[axis] = (float)lo;
        t->box_hi[axis] = (float)hi;
        t->lo[axis] = (int)fmax(ceil(lo - m->band - 1e-6), 0);
        t->hi[axis] = (int)fmin(floor(hi + m->band + 1e-6), ISO_BRICK - 1);
    }
    return true;
}

static void set_side(near_side *s, const double from[3], const double to[3], iso_vec3 normal) {
    const iso_vec3 way = iso_vec3_make(to[0] - from[0], to[1] - from[1], to[2] - from[2]),
                   inward = iso_vec3_unit(iso_vec3_cross(normal, way));
    const double square = iso_vec3_dot(way, way), part = square > 1e-60 ? 1 / square : 0;
    const double ways[3] = {way.x, way.y, way.z}, inwards[3] = {inward.x, inward.y, inward.z};
    for (int axis = 0; axis < 3; axis++) {
        s->from[axis] = (float)from[axis];
        s->way[axis] = (float)ways[axis];
        s->rise[axis] = (float)(ways[axis] * part);
        s->inward[axis] = (float)inwards[axis];
    }
}

/* Sets the sides and the plane. Floats are wrong by less than 2e-6 of the largest coordinate. */
static void set_shape(const measuring *m, near_triangle *t, const double p[3][3]) {
    const iso_vec3 a = iso_vec3_make(p[0][0], p[0][1], p[0][2]), b = iso_vec3_make(p[1][0], p[1][1], p[1][2]),
                   c = iso_vec3_make(p[2][0], p[2][1], p[2][2]);
    const iso_vec3 normal = iso_vec3_unit(iso_vec3_cross(iso_vec3_sub(b, a), iso_vec3_sub(c, a)));
    const bool flat = !(iso_vec3_dot(normal, normal) > 0.5); /* no area: its sides are all there is */
    double largest = 2 * ISO_BRICK;
    for (int k = 0; k < 3; k++) {
        set_side(&t->sides[k], p[k], p[(k + 1) % 3], normal);
        for (int axis = 0; axis < 3; axis++) largest = fmax(largest, fabs(p[k][axis]));
    }
    const double wrong = 2e-6 * largest;
    t->normal[0] = flat ? 0 : (float)normal.x;
    t->normal[1] = flat ? 0 : (float)normal.y;
    t->normal[2] = flat ? 0 : (float)normal.z;
    t->plane = flat ? 0 : (float)-iso_vec3_dot(normal, a);
    t->reach = flat ? -INFINITY : (float)wrong;
    t->slack = (float)(1e-5 + wrong * (2 * m->band + wrong));
    t->most = (float)(m->band * m->band) + t->slack;
}

/* Whether the ball around the brick is within the band around the triangle. */
static bool reaches(const measuring *m, const float corners[3][3]) {
    const double middle = (ISO_BRICK - 1) / 2.0, most = (1.7321 * middle + m->band) * m->brick->voxel;
    const iso_vec3 first = iso_brick_voxel(m->brick, 0);
    const iso_vec3 p = iso_vec3_add(first, iso_vec3_scale(iso_vec3_make(1, 1, 1), middle * m->brick->voxel)),
                   away = iso_vec3_sub(p, iso_triangle_nearest(corners, p));
    return iso_vec3_dot(away, away) <= most * most;
}

static void take_triangle(void *context, const float corners[3][3]) {
    measuring *m = context;
    const iso_brick_place *brick = m->brick;
    const double part = 1 / brick->voxel;
    near_triangle t;
    double p[3][3];
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            p[k][axis] = ((double)corners[k][axis] - brick->origin[axis]) * part - brick->at[axis];
    if (!set_range(m, &t, p)) return;
    const bool large = t.hi[0] - t.lo[0] + t.hi[1] - t.lo[1] + t.hi[2] - t.lo[2] > 2 * ISO_BRICK;
    if (large && !reaches(m, corners)) return;
    set_shape(m, &t, p);
    const int count = m->find_near(&t, m->bound, m->near);
    for (int i = 0; i < count; i++) {
        const int voxel = m->near[i];
        const iso_vec3 at = iso_brick_voxel(brick, voxel),
                       away = iso_vec3_sub(at, iso_triangle_nearest(corners, at));
        const double squared = iso_vec3_dot(away, away);
        if (squared >= m->squared[voxel]) continue;
        m->squared[voxel] = squared;
        m->bound[voxel] = (float)(squared * part * part);
    }
}

void iso_brick_distances(const iso_triangle_tree *tree, const iso_brick_place *brick, double band,
                         double squared[ISO_BRICK_VOXELS]) {
    measuring m = {
        .brick = brick, .band = band, .squared = squared, .find_near = ISO_KERNEL(find_near, iso_cpu_best())};
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        squared[i] = band * band * brick->voxel * brick->voxel;
        m.bound[i] = (float)(band * band);
    }
    const double reach = band * brick->voxel * (1 + 1e-9);
    const iso_vec3 more = iso_vec3_make(reach, reach, reach);
    const iso_box box = {iso_vec3_sub(iso_brick_voxel(brick, 0), more),
                         iso_vec3_add(iso_brick_voxel(brick, ISO_BRICK_VOXELS - 1), more)};
    iso_triangle_tree_visit(tree, &box, take_triangle, &m);
}
