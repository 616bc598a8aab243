/* shapes_truth: the pieces of a ray inside each shape, in long double: of spheres from the textbook's
 * formula; of rounded cones by searching among the spheres that sweep them. */
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

/* ---- rounded cones: the union of the spheres around center + t * path, of radius + t * taper, 0 <= t <= 1.
 * The points (s, t) of which the ray's s lies in the sphere of t form a convex set. */

typedef struct cone {
    real center[3], path[3], radius, taper;
    bool flat[2]; /* the end is cut off at its vertex */
} cone;

enum { STEPS = 56 }; /* of a search: each leaves 2/3 of an interval */

/* Foot of the perpendicular from the center of the sphere of t to the ray, and its distance less the radius.
 */
static real gap(const ray *r, const cone *c, real t, real *middle) {
    real to[3], off[3];
    for (int a = 0; a < 3; a++) to[a] = c->center[a] + t * c->path[a] - r->origin[a];
    *middle = dot(to, r->direction) / dot(r->direction, r->direction);
    for (int a = 0; a < 3; a++) off[a] = *middle * r->direction[a] - to[a];
    return sqrtl(dot(off, off)) - (c->radius + t * c->taper);
}

/* Where the ray enters (way 1) or leaves (way -1) the sphere of t, times way. */
static real edge(const ray *r, const cone *c, real t, int way) {
    real middle;
    const real radius = c->radius + t * c->taper, inside = -gap(r, c, t, &middle),
               rest = inside > 0 ? inside * (2 * radius - inside) : 0;
    return way * middle - sqrtl(rest / dot(r->direction, r->direction));
}

/* The t of the smallest gap (way 0) or edge between low and high. */
static real search(const ray *r, const cone *c, int way, real low, real high) {
    for (int step = 0; step < STEPS; step++) {
        real a = (2 * low + high) / 3, b = (low + 2 * high) / 3, unused;
        const real at_a = way ? edge(r, c, a, way) : gap(r, c, a, &unused),
                   at_b = way ? edge(r, c, b, way) : gap(r, c, b, &unused);
        *(at_a < at_b ? &high : &low) = at_a < at_b ? b : a;
    }
    return (low + high) / 2;
}

/* The t between one that meets the ray and `end` from which on spheres miss it. */
static real border(const ray *r, const cone *c, real meets, real end) {
    real unused;
    if (gap(r, c, end, &unused) <= 0) return end;
    for (int step = 0; step < STEPS; step++) {
        const real middle = (meets + end) / 2;
        *(gap(r, c, middle, &unused) <= 0 ? &meets : &end) = middle;
    }
    return meets;
}

/* Cuts off what lies beyond a flat end. */
static bool cut(const ray *r, const cone *c, int last, piece *p) {
    const real sign = last ? 1 : -1, slope = sign * dot(r->direction, c->path);
    real from[3];
    for (int a = 0; a < 3; a++) from[a] = c->center[a] + (last ? c->path[a] : 0) - r->origin[a];
    const real t = sign * dot(from, c->path) / slope;
    const int end = slope > 0;
    if (end ? t < p->t[1] : t > p->t[0]) {
        p->t[end] = t;
        for (int a = 0; a < 3; a++) p->normal[end][a] = sign * c->path[a];
    }
    return p->t[0] <= p->t[1];
}

static bool cone_piece(const ray *r, const cone *c, piece *p) {
    real unused;
    const real closest = search(r, c, 0, 0, 1);
    if (!(gap(r, c, closest, &unused) <= 0)) return false;
    const real low = border(r, c, closest, 0), high = border(r, c, closest, 1);
    for (int end = 0; end < 2; end++) {
        const int way = end ? -1 : 1;
        const real t = search(r, c, way, low, high);
        p->t[end] = way * edge(r, c, t, way);
        point_at(r, p->t[end], p->normal[end]);
        for (int a = 0; a < 3; a++) p->normal[end][a] -= c->center[a] + t * c->path[a];
    }
    const bool holds = dot(c->path, c->path) <= c->taper * c->taper;
    for (int end = 0; end < 2; end++)
        if (c->flat[end] && !holds && !cut(r, c, end, p)) return false;
    return true;
}

/* Takes the piece's first end at or behind the near plane, if it is nearer than the hit so far. */
static bool take(const iso_view *view, const piece *p, iso_shapes_hit *hit) {
    const int end = p->t[0] >= (real)view->near ? 0 : 1;
    if (!(p->t[end] >= (real)view->near)) return false;
    if (hit->hit && !((double)p->t[end] < hit->depth)) {
        if ((double)p->t[end] < hit->behind) hit->behind = (double)p->t[end];
        return false;
    }
    if (hit->hit) hit->behind = hit->depth;
    const real length = sqrtl(dot(p->normal[end], p->normal[end]));
    hit->hit = true;
    hit->depth = (double)p->t[end];
    for (int a = 0; a < 3; a++) hit->normal[a] = (double)(p->normal[end][a] / length);
    return true;
}

/* ---- sets */

typedef struct solid {
    cone shape;         /* without path and taper: a sphere */
    real size, largest; /* its smallest and largest radius */
    bool is_cone;
    size_t number;
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
        *s = (solid){.number = i};
        s->largest = s->size = (real)scale * (real)(glyphs->radii ? (double)glyphs->radii[i] : opts->radius);
        to_view(truth->view, glyphs->origin, glyphs->positions[i], s->shape.center);
        s->shape.radius = s->largest;
        if (s->largest > 0) truth->count++;
    }
}

/* The radius of a vertex at depth z, widened to the least width. */
static real radius_of(const iso_view *view, const iso_lines *lines, size_t vertex,
                      const iso_shapes_opts *opts, real z) {
    const real scale = opts->scale > 0 ? (real)opts->scale : 1,
               radius = scale * (real)(lines->radii ? (double)lines->radii[vertex] : opts->radius);
    const real depth = view->orthographic     ? 1
                       : z > (real)view->near ? z
                                              : (real)view->near,
               least = depth * (real)opts->min_pixels / (2 * (real)view->focal);
    return radius < least ? least : radius;
}

static void add_segment(iso_shapes_truth *truth, const iso_lines *lines, size_t first,
                        const iso_shapes_opts *opts) {
    solid *s = &truth->solids[truth->count];
    real last[3];
    *s = (solid){.number = first, .is_cone = true};
    to_view(truth->view, lines->origin, lines->vertices[first], s->shape.center);
    to_view(truth->view, lines->origin, lines->vertices[first + 1], last);
    for (int a = 0; a < 3; a++) s->shape.path[a] = last[a] - s->shape.center[a];
    s->shape.radius = radius_of(truth->view, lines, first, opts, s->shape.center[2]);
    const real other = radius_of(truth->view, lines, first + 1, opts, last[2]);
    s->shape.taper = other - s->shape.radius;
    s->size = other < s->shape.radius ? other : s->shape.radius;
    s->largest = other > s->shape.radius ? other : s->shape.radius;
    if (s->largest > 0) truth->count++;
}

static void add_lines(iso_shapes_truth *truth, const iso_lines *lines, const iso_shapes_opts *opts) {
    for (size_t i = 0; i < lines->line_count; i++)
        for (size_t v = lines->starts[i]; v + 1 < lines->starts[i + 1]; v++) {
            const size_t before = truth->count;
            add_segment(truth, lines, v, opts);
            if (truth->count == before || opts->caps != ISO_CAPS_FLAT) continue;
            truth->solids[before].shape.flat[0] = v == lines->starts[i];
            truth->solids[before].shape.flat[1] = v + 2 == lines->starts[i + 1];
        }
}

iso_status iso_shapes_truth_create(const iso_shapes_scene *scene, const iso_view *view,
                                   iso_shapes_truth **truth, iso_error *error) {
    iso_shapes_truth *made = iso_alloc(sizeof *made);
    const size_t most = scene->glyphs ? scene->glyphs->count : scene->lines->vertex_count;
    solid *solids = iso_alloc(most * sizeof *solids);
    if (!made || !solids) {
        iso_free(made);
        iso_free(solids);
        return iso_fail_memory(error, "truth of shapes");
    }
    *made = (iso_shapes_truth){.view = view, .solids = solids};
    if (scene->glyphs)
        add_glyphs(made, scene->glyphs, &scene->opts);
    else
        add_lines(made, scene->lines, &scene->opts);
    *truth = made;
    return ISO_OK;
}

void iso_shapes_truth_destroy(iso_shapes_truth *truth) {
    if (!truth) return;
    iso_free(truth->solids);
    iso_free(truth);
}

/* Whether the ray passes a solid at a distance, in double precision: false in doubt. */
static bool passes(const ray *r, const solid *s) {
    double to[3], d[3], path[3], dd = 0, td = 0, pd = 0, tp = 0, pp = 0;
    for (int a = 0; a < 3; a++) {
        to[a] = (double)(s->shape.center[a] - r->origin[a]);
        d[a] = (double)r->direction[a];
        path[a] = (double)s->shape.path[a];
        dd += d[a] * d[a], td += to[a] * d[a], pd += path[a] * d[a];
    }
    for (int a = 0; a < 3; a++) { /* across the ray */
        to[a] -= td / dd * d[a], path[a] -= pd / dd * d[a];
        tp += to[a] * path[a], pp += path[a] * path[a];
    }
    const double t = pp > 0 ? fmin(fmax(-tp / pp, 0), 1) : 0;
    double away = 0, reach = 1.001 * (double)s->largest + 1e-9 * fabs(td);
    for (int a = 0; a < 3; a++) away += (to[a] + t * path[a]) * (to[a] + t * path[a]);
    return away > reach * reach;
}

iso_shapes_hit iso_shapes_truth_ray(const iso_shapes_truth *truth, double px, double py) {
    const ray r = ray_of(truth->view, px, py);
    iso_shapes_hit hit = {.behind = INFINITY};
    for (size_t i = 0; i < truth->count; i++) {
        const solid *s = &truth->solids[i];
        piece p;
        if (passes(&r, s)) continue;
        const bool met = s->is_cone ? cone_piece(&r, &s->shape, &p)
                                    : sphere_piece(&r, s->shape.center, s->shape.radius, &p);
        if (!met || !take(truth->view, &p, &hit)) continue;
        hit.size = (double)s->size;
        hit.shape = s->number;
    }
    return hit;
}
