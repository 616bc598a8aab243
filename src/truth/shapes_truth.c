/* shapes_truth: the pieces of a ray inside each shape, from textbook formulas in long double. */
#include "truth/shapes_truth.h"

#include <math.h>

#include "base/memory.h"

typedef long double real;

/* A ray in view space, origin + t * direction: t is the depth. */
typedef struct ray {
    real origin[3], direction[3];
} ray;

/* Where a ray enters and leaves a solid, with the outward normals there, of any length. */
typedef struct piece {
    real t[2], normal[2][3];
} piece;

static real dot(const real a[3], const real b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void point_at(const ray *r, real t, real point[3]) {
    for (int a = 0; a < 3; a++) point[a] = r->origin[a] + t * r->direction[a];
}

static ray ray_of(const iso_view *view, double px, double py) {
    const real u = ((real)px - (real)view->cx) / (real)view->focal,
               v = ((real)py - (real)view->cy) / (real)view->focal;
    if (view->orthographic) return (ray){{u, v, 0}, {0, 0, 1}};
    return (ray){{0, 0, 0}, {u, v, 1}};
}

/* A vector of the world in view space. */
static void turn(const iso_view *view, const real world[3], real out[3]) {
    for (int a = 0; a < 3; a++)
        out[a] = (real)view->rotation[3 * a] * world[0] + (real)view->rotation[3 * a + 1] * world[1] +
                 (real)view->rotation[3 * a + 2] * world[2];
}

static void to_view(const iso_view *view, iso_vec3 origin, const float offset[3], real out[3]) {
    const real world[3] = {(real)origin.x + (real)offset[0] - (real)view->eye.x,
                           (real)origin.y + (real)offset[1] - (real)view->eye.y,
                           (real)origin.z + (real)offset[2] - (real)view->eye.z};
    turn(view, world, out);
}

/* From the origin to the foot of the perpendicular, and half the chord to both sides of it. */
static bool sphere_piece(const ray *r, const real center[3], real radius, piece *out) {
    real to[3], foot[3];
    for (int a = 0; a < 3; a++) to[a] = center[a] - r->origin[a];
    const real dd = dot(r->direction, r->direction), middle = dot(to, r->direction) / dd;
    for (int a = 0; a < 3; a++) foot[a] = middle * r->direction[a] - to[a];
    const real rest = radius * radius - dot(foot, foot);
    if (!(rest >= 0)) return false;
    const real half = sqrtl(rest / dd);
    for (int end = 0; end < 2; end++) {
        out->t[end] = end ? middle + half : middle - half;
        point_at(r, out->t[end], out->normal[end]);
        for (int a = 0; a < 3; a++) out->normal[end][a] -= center[a];
    }
    return true;
}

/* Takes the piece's first end at or behind the near plane, if it is nearer than the hit so far. */
static bool take(const iso_view *view, const piece *p, iso_shapes_hit *hit) {
    const int end = p->t[0] >= (real)view->near ? 0 : 1;
    if (!(p->t[end] >= (real)view->near) || (hit->hit && !((double)p->t[end] < hit->depth))) return false;
    const real length = sqrtl(dot(p->normal[end], p->normal[end]));
    hit->hit = true;
    hit->depth = (double)p->t[end];
    for (int a = 0; a < 3; a++) hit->normal[a] = (double)(p->normal[end][a] / length);
    return true;
}

/* ---- sets */

typedef struct solid {
    real center[3]; /* view space */
    real radius;
    size_t shape;
} solid;

struct iso_shapes_truth {
    const iso_view *view;
    solid *solids;
    size_t count;
};

static void add_glyphs(iso_shapes_truth *truth, const iso_glyphs *glyphs, const iso_shapes_opts *opts) {
    const double scale = opts->scale > 0 ? opts->scale : 1;
    for (size_t i = 0; i < glyphs->count; i++) {
        solid *s = &truth->solids[truth->count];
        s->radius = (real)scale * (real)(glyphs->radii ? (double)glyphs->radii[i] : opts->radius);
        s->shape = i;
        to_view(truth->view, glyphs->origin, glyphs->positions[i], s->center);
        if (s->radius > 0) truth->count++;
    }
}

iso_status iso_shapes_truth_create(const iso_glyphs *glyphs, const iso_shapes_opts *opts,
                                   const iso_view *view, iso_shapes_truth **truth, iso_error *error) {
    iso_shapes_truth *made = iso_alloc(sizeof *made);
    solid *solids = iso_alloc(glyphs->count * sizeof *solids);
    if (!made || !solids) {
        iso_free(made);
        iso_free(solids);
        return iso_fail_memory(error, "truth of shapes");
    }
    *made = (iso_shapes_truth){.view = view, .solids = solids};
    add_glyphs(made, glyphs, opts);
    *truth = made;
    return ISO_OK;
}

void iso_shapes_truth_destroy(iso_shapes_truth *truth) {
    if (!truth) return;
    iso_free(truth->solids);
    iso_free(truth);
}

/* Whether the ray passes a sphere at a distance, in double precision: false in doubt. */
static bool passes(const ray *r, const real center[3], real radius) {
    double to[3], d[3];
    for (int a = 0; a < 3; a++) to[a] = (double)(center[a] - r->origin[a]), d[a] = (double)r->direction[a];
    const double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2],
                 middle = (to[0] * d[0] + to[1] * d[1] + to[2] * d[2]) / dd;
    double away = 0, reach = (double)radius * 1.001;
    for (int a = 0; a < 3; a++) {
        away += (middle * d[a] - to[a]) * (middle * d[a] - to[a]);
        reach += 1e-9 * fabs(to[a]);
    }
    return away > reach * reach;
}

iso_shapes_hit iso_shapes_truth_ray(const iso_shapes_truth *truth, double px, double py) {
    const ray r = ray_of(truth->view, px, py);
    iso_shapes_hit hit = {.hit = false};
    for (size_t i = 0; i < truth->count; i++) {
        const solid *s = &truth->solids[i];
        piece p;
        if (passes(&r, s->center, s->radius) || !sphere_piece(&r, s->center, s->radius, &p) ||
            !take(truth->view, &p, &hit))
            continue;
        hit.size = (double)s->radius;
        hit.shape = s->shape;
    }
    return hit;
}
