/* brick_distances: prepares triangles for the kernels (brick_distances_kernel.c). */
#include "grids/closing/brick_distances.h"

#include <math.h>

#include "base/kernel_units.h"
#include "base/numbers.h"
#include "grids/closing/brick_distances_kernel.h"

typedef struct measuring {
    const iso_brick_place *brick;
    double band; /* voxels */
    double *squared;
    const iso_tree_triangle **nearest; /* by voxel; NULL: not wanted */
    find_near_fn *find_near;
    float bound[ISO_BRICK_VOXELS]; /* squared, in voxels */
    uint16_t near[ISO_BRICK_VOXELS];
} measuring;

/* Sets the range of voxels of the brick from `lo` to `hi`; false: there are none. */
static bool set_range(double lo, double hi, int *first, int *last) {
    const double begin = ceil(iso_max(lo - 1e-6, 0)), end = floor(iso_min(hi + 1e-6, ISO_BRICK - 1));
    if (!(begin <= end)) return false;
    *first = (int)begin;
    *last = (int)end;
    return true;
}

/* Sets a plane through p with a unit normal. */
static void set_plane(float plane[4], iso_vec3 normal, iso_vec3 p) {
    plane[0] = (float)normal.x;
    plane[1] = (float)normal.y;
    plane[2] = (float)normal.z;
    plane[3] = (float)-iso_vec3_dot(normal, p);
}

/* Sets the planes and the lengths of the sides. */
static void set_planes(near_triangle *t, const iso_vec3 p[3], iso_vec3 normal, double length[3]) {
    set_plane(t->plane, normal, p[0]);
    for (int k = 0; k < 3; k++) {
        const iso_vec3 inward = iso_vec3_cross(normal, iso_vec3_sub(p[(k + 1) % 3], p[k]));
        length[k] = iso_vec3_length(inward);
        set_plane(t->sides[k], iso_vec3_scale(inward, length[k] > 0 ? 1 / length[k] : 0), p[k]);
    }
}

/* Sets how far floats may be wrong: by less than 2e-6 of the largest coordinate. */
static void set_slack(const measuring *m, near_triangle *t, double outside, double largest) {
    const double wrong = 2e-6 * largest;
    t->outside = (float)(outside + wrong);
    t->slack = (float)(1e-5 + 2 * wrong * (2 * m->band + wrong));
    t->most = (float)(m->band * m->band) + t->slack;
}

/* Prepares a triangle; false: it reaches no voxel. When its sides are moved outwards, its corners move away
 * from the centre of the incircle. */
static bool set_triangle(const measuring *m, near_triangle *t, const iso_vec3 p[3], double reach) {
    const iso_vec3 cross = iso_vec3_cross(iso_vec3_sub(p[1], p[0]), iso_vec3_sub(p[2], p[0])),
                   normal = iso_vec3_unit(cross);
    double length[3], corner[3][3], n[3], largest = 2 * ISO_BRICK;
    set_planes(t, p, normal, length);
    const double perimeter = length[0] + length[1] + length[2];
    const double growth = reach < 1 ? reach * m->band * perimeter / iso_vec3_length(cross) : 0;
    iso_vec3_store(normal, n);
    for (int k = 0; k < 3; k++) iso_vec3_store(p[k], corner[k]);
    for (int axis = 0; axis < 3; axis++) {
        const double a = corner[0][axis], b = corner[1][axis], c = corner[2][axis];
        const double lo = iso_min(iso_min(a, b), c), hi = iso_max(iso_max(a, b), c);
        double below = m->band, above = m->band;
        if (reach < 1) {
            const double centre = (a * length[1] + b * length[2] + c * length[0]) / perimeter;
            below = iso_min(below, m->band * fabs(n[axis]) + growth * (centre - lo));
            above = iso_min(above, m->band * fabs(n[axis]) + growth * (hi - centre));
        }
        if (!set_range(lo - below, hi + above, &t->lo[axis], &t->hi[axis])) return false;
        largest = iso_max(largest, iso_max(fabs(lo), fabs(hi)));
    }
    set_slack(m, t, reach * m->band, largest);
    return true;
}

/* Whether the ball around the brick is within the band around the triangle. */
static bool reaches(const measuring *m, const float corners[3][3]) {
    const double middle = (ISO_BRICK - 1) / 2.0, most = (1.7321 * middle + m->band) * m->brick->voxel;
    const iso_vec3 first = iso_brick_voxel(m->brick, 0);
    const iso_vec3 p = iso_vec3_add(first, iso_vec3_scale(iso_vec3_make(1, 1, 1), middle * m->brick->voxel)),
                   away = iso_vec3_sub(p, iso_triangle_nearest(corners, p));
    return iso_vec3_dot(away, away) <= most * most;
}

/* Returns a position of the mesh in voxels from the brick's first one. */
static iso_vec3 in_brick(const iso_brick_place *b, const float p[3]) {
    const double part = 1 / b->voxel;
    return iso_vec3_make(((double)p[0] - b->origin[0]) * part - b->at[0],
                         ((double)p[1] - b->origin[1]) * part - b->at[1],
                         ((double)p[2] - b->origin[2]) * part - b->at[2]);
}

static void take_triangle(void *context, const iso_tree_triangle *triangle) {
    measuring *m = context;
    near_triangle t;
    iso_vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = in_brick(m->brick, triangle->corners[k]);
    if (!set_triangle(m, &t, p, (double)triangle->reach)) return;
    const bool large = t.hi[0] - t.lo[0] + t.hi[1] - t.lo[1] + t.hi[2] - t.lo[2] > 2 * ISO_BRICK;
    if (large && !reaches(m, triangle->corners)) return;
    const int count = m->find_near(&t, m->bound, m->near);
    for (int i = 0; i < count; i++) {
        const int voxel = m->near[i];
        const iso_vec3 at = iso_brick_voxel(m->brick, voxel),
                       away = iso_vec3_sub(at, iso_triangle_nearest(triangle->corners, at));
        const double squared = iso_vec3_dot(away, away), part = 1 / m->brick->voxel;
        if (squared >= m->squared[voxel]) continue;
        m->squared[voxel] = squared;
        if (m->nearest) m->nearest[voxel] = triangle;
        m->bound[voxel] = (float)(squared * part * part);
    }
}

void iso_brick_distances(const iso_triangle_tree *tree, const iso_brick_place *brick, double band,
                         double squared[ISO_BRICK_VOXELS],
                         const iso_tree_triangle *nearest[ISO_BRICK_VOXELS]) {
    measuring m = {.brick = brick,
                   .band = band,
                   .squared = squared,
                   .nearest = nearest,
                   .find_near = ISO_KERNEL_UNIT(iso_find_near_voxels, iso_cpu_best())};
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        squared[i] = band * band * brick->voxel * brick->voxel;
        m.bound[i] = (float)(band * band);
        if (nearest) nearest[i] = NULL;
    }
    const double reach = band * brick->voxel * (1 + 1e-9);
    const iso_vec3 more = iso_vec3_make(reach, reach, reach);
    const iso_box box = {iso_vec3_sub(iso_brick_voxel(brick, 0), more),
                         iso_vec3_add(iso_brick_voxel(brick, ISO_BRICK_VOXELS - 1), more)};
    iso_triangle_tree_visit(tree, &box, take_triangle, &m);
}
