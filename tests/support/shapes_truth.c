/* shapes_truth: finds where a ray is inside each shape, in long double. Spheres are intersected by the usual
 * formula; rounded cones by a search among the spheres that sweep them; ribbons by subdivision of their
 * patches. */
#include "shapes_truth.h"

#include <math.h>

#include "base/memory.h"

typedef long double real;

/* A ray in view space, origin + t * direction: t is the depth. */
typedef struct ray {
    real origin[3], direction[3];
    real square; /* of the direction's length */
} ray;

/* The part of a ray inside a solid: the depths at which the ray enters and leaves it, and the outward normals
 * there, which have any length. */
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
    if (view->orthographic) return (ray){{u, v, 0}, {0, 0, 1}, 1};
    return (ray){{0, 0, 0}, {u, v, 1}, u * u + v * v + 1};
}

/* Transforms a vector from world to view space. */
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

/* Intersects a ray with a sphere; returns whether they meet. The two intersections are half a chord before
 * and behind the foot of the perpendicular from the centre to the ray. */
static bool sphere_piece(const ray *r, const real center[3], real radius, piece *out) {
    real to[3], foot[3];
    for (int a = 0; a < 3; a++) to[a] = center[a] - r->origin[a];
    const real middle = dot(to, r->direction) / r->square;
    for (int a = 0; a < 3; a++) foot[a] = middle * r->direction[a] - to[a];
    const real rest = radius * radius - dot(foot, foot);
    if (!(rest >= 0)) return false;
    const real half = sqrtl(rest / r->square);
    for (int end = 0; end < 2; end++) {
        out->t[end] = end ? middle + half : middle - half;
        point_at(r, out->t[end], out->normal[end]);
        for (int a = 0; a < 3; a++) out->normal[end][a] -= center[a];
    }
    return true;
}

/* ---- rounded cones: the union of the spheres with centre center + t * path and radius radius + t * taper, 0
 * <= t <= 1. The set of all (s, t) for which the ray's point s lies in the sphere t is convex. */

typedef struct cone {
    real center[3], path[3], radius, taper;
    bool flat[2]; /* the end (0: t = 0, 1: t = 1) is cut off by a plane through its vertex */
} cone;

enum { STEPS = 64 }; /* halvings until an interval is as short as numbers tell apart */

/* Returns the distance of the ray from the centre of sphere t, minus the sphere's radius: below 0 if the ray
 * meets the sphere. Sets *middle to the depth of the nearest point of the ray. */
static real gap(const ray *r, const cone *c, real t, real *middle) {
    real to[3], off[3];
    for (int a = 0; a < 3; a++) to[a] = c->center[a] + t * c->path[a] - r->origin[a];
    *middle = dot(to, r->direction) / r->square;
    for (int a = 0; a < 3; a++) off[a] = *middle * r->direction[a] - to[a];
    return sqrtl(dot(off, off)) - (c->radius + t * c->taper);
}

static real gap_at(const ray *r, const void *of, real t) {
    real unused;
    return gap(r, of, t, &unused);
}

/* Returns the depth at which the ray enters sphere t (way 1), or minus the depth at which it leaves it (way
 * -1). */
static real edge(const ray *r, const cone *c, real t, int way) {
    real middle;
    const real radius = c->radius + t * c->taper, inside = -gap(r, c, t, &middle),
               rest = inside > 0 ? inside * (2 * radius - inside) : 0;
    return way * middle - sqrtl(rest / r->square);
}

static real entry_at(const ray *r, const void *of, real t) {
    return edge(r, of, t, 1);
}

static real exit_at(const ray *r, const void *of, real t) {
    return edge(r, of, t, -1);
}

/* Returns where between `low` and `high` a convex function of a ray and a shape is least, by golden sections.
 * Ends early, with a place of larger value, where a value of at most `enough` is found, or where none can be,
 * because no slope is steeper than `steepest`. */
static real least(real (*at)(const ray *r, const void *shape, real t), const ray *r, const void *shape,
                  real low, real high, real enough, real steepest) {
    const real golden = 0.618033988749894848204587L;
    real a = high - golden * (high - low), b = low + golden * (high - low);
    real at_a = at(r, shape, a), at_b = at(r, shape, b);
    for (int step = 0; step < 48;
         step++) { /* 1e-10 of the interval is left: the least value is as exact as any */
        if (at_a <= enough) return a;
        if (at_b <= enough) return b;
        if (fminl(at_a, at_b) - steepest * (high - low) > enough) break;
        if (at_a < at_b) {
            high = b, b = a, at_b = at_a;
            a = high - golden * (high - low);
            at_a = at(r, shape, a);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + golden * (high - low);
            at_b = at(r, shape, b);
        }
    }
    return (low + high) / 2;
}

/* Returns where, between `meets` (a t whose sphere the ray meets) and `end`, the spheres begin to miss the
 * ray; `end` if it meets them all. */
static real border(const ray *r, const cone *c, real meets, real end) {
    if (gap_at(r, c, end) <= 0) return end;
    for (int step = 0; step < STEPS; step++) {
        const real middle = (meets + end) / 2;
        *(gap_at(r, c, middle) <= 0 ? &meets : &end) = middle;
    }
    return meets;
}

/* Cuts the piece off at the plane of a flat end. Returns whether something of the piece is left. */
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
    const real closest = least(gap_at, r, c, 0, 1, 0, sqrtl(dot(c->path, c->path)) + fabsl(c->taper));
    if (!(gap_at(r, c, closest) <= 0)) return false;
    const real low = border(r, c, closest, 0), high = border(r, c, closest, 1);
    for (int end = 0; end < 2; end++) {
        const int way = end ? -1 : 1;
        const real t = least(end ? exit_at : entry_at, r, c, low, high, -INFINITY, INFINITY);
        p->t[end] = way * edge(r, c, t, way);
        point_at(r, p->t[end], p->normal[end]);
        for (int a = 0; a < 3; a++) p->normal[end][a] -= c->center[a] + t * c->path[a];
    }
    const bool holds = dot(c->path, c->path) <= c->taper * c->taper;
    for (int end = 0; end < 2; end++)
        if (c->flat[end] && !holds && !cut(r, c, end, p)) return false;
    return true;
}

/* ---- ribbons: each is a patch of points line + s path + t (edge0 + s (edge1 - edge0)), 0 <= s <= 1, -1 <= t
 * <= 1. Projected along the ray, a patch lies within the quadrilateral of its corners, and so does each of
 * its parts. Parts whose corners are all on one side of the ray are dropped; the others are subdivided. */

typedef struct patch {
    real center[3], path[3], edge[2][3];
} patch;

/* A part of a patch: the ranges of s and t. */
typedef struct part {
    real s[2], t[2];
} part;

static void patch_point(const patch *q, real s, real t, real out[3]) {
    for (int a = 0; a < 3; a++)
        out[a] = q->center[a] + s * q->path[a] + t * ((1 - s) * q->edge[0][a] + s * q->edge[1][a]);
}

/* Returns whether some line through the ray, perpendicular to an edge or a diagonal of the part, has all
 * corners of the part on one side. */
static bool is_beside(const ray *r, const patch *q, const part *p) {
    real corner[4][2];
    for (int i = 0; i < 4; i++) {
        real at[3];
        patch_point(q, p->s[i / 2], p->t[i % 2], at);
        const real depth = at[2] - r->origin[2];
        for (int a = 0; a < 2; a++) corner[i][a] = at[a] - r->origin[a] - depth * r->direction[a];
    }
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < i; k++) {
            const real x = corner[i][1] - corner[k][1], y = corner[k][0] - corner[i][0];
            int before = 0, behind = 0;
            for (int j = 0; j < 4; j++) {
                const real side = x * corner[j][0] + y * corner[j][1];
                before += side<0, behind += side> 0;
            }
            if (before == 4 || behind == 4) return true;
        }
    return false;
}

/* Adds an intersection to the piece, with the normal that points against the ray. */
static void add_patch_point(const ray *r, const patch *q, real s, real t, piece *out) {
    real at[3], ds[3], dt[3], normal[3];
    patch_point(q, s, t, at);
    for (int a = 0; a < 3; a++) {
        ds[a] = q->path[a] + t * (q->edge[1][a] - q->edge[0][a]);
        dt[a] = (1 - s) * q->edge[0][a] + s * q->edge[1][a];
    }
    for (int a = 0; a < 3; a++)
        normal[a] = ds[(a + 1) % 3] * dt[(a + 2) % 3] - ds[(a + 2) % 3] * dt[(a + 1) % 3];
    const real sign = dot(normal, r->direction) > 0 ? -1 : 1, depth = at[2] - r->origin[2];
    for (int end = 0; end < 2; end++) {
        if (end ? !(depth > out->t[1]) : !(depth < out->t[0])) continue;
        out->t[end] = depth;
        for (int a = 0; a < 3; a++) out->normal[end][a] = sign * normal[a];
    }
}

enum { DIVISIONS = 48, MOST_PARTS = 200 };

static bool patch_piece(const ray *r, const patch *q, piece *out) {
    part parts[MOST_PARTS], next[MOST_PARTS];
    int count = 1;
    parts[0] = (part){{0, 1}, {-1, 1}};
    *out = (piece){.t = {INFINITY, -INFINITY}};
    for (int division = 0; division < DIVISIONS; division++) {
        int kept = 0;
        for (int i = 0; i < count; i++)
            for (int quarter = 0; quarter < 4; quarter++) {
                part p = parts[i];
                p.s[quarter % 2] = (p.s[0] + p.s[1]) / 2;
                p.t[quarter / 2] = (p.t[0] + p.t[1]) / 2;
                if (!is_beside(r, q, &p) && kept < MOST_PARTS) next[kept++] = p;
            }
        for (int i = 0; i < kept; i++) parts[i] = next[i];
        count = kept;
    }
    for (int i = 0; i < count; i++)
        add_patch_point(r, q, (parts[i].s[0] + parts[i].s[1]) / 2, (parts[i].t[0] + parts[i].t[1]) / 2, out);
    return count > 0;
}

/* ---- other glyphs: affine images of unit solids, each a union of convex solids. A convex solid is where a
 * convex function is negative: its minimum along the ray is searched first, then the change of sign on both
 * sides of the minimum. */

typedef struct unit {
    iso_glyph glyph; /* ellipsoid, box, cylinder or cone */
    real radius, low, high;
} unit;

/* Returns the convex function of a unit solid at p, and its gradient if `gradient` is not NULL. */
static real outside(const unit *u, const real p[3], real gradient[3]) {
    const real taper = 1 / (u->high - u->low);
    const bool box = u->glyph == ISO_GLYPH_BOX, ball = u->glyph == ISO_GLYPH_ELLIPSOID;
    const real off = box ? 0 : sqrtl(p[0] * p[0] + p[1] * p[1] + (ball ? p[2] * p[2] : 0));
    const real radius = u->glyph == ISO_GLYPH_CONE ? u->radius * (u->high - p[2]) * taper : u->radius;
    real most = box ? -INFINITY : off - radius;
    int active = -1; /* 2 a + 1, 2 a: the plane across axis a, towards larger and smaller coordinates */
    for (int a = box ? 0 : 2; a < 3 && !ball; a++) {
        const real below = (box ? -1 : u->low) - p[a], above = p[a] - (box ? 1 : u->high);
        if (below > most) most = below, active = 2 * a;
        if (above > most) most = above, active = 2 * a + 1;
    }
    if (!gradient) return most;
    for (int a = 0; a < 3; a++) gradient[a] = active < 0 ? p[a] : 0;
    if (active >= 0)
        gradient[active / 2] = active % 2 ? 1 : -1;
    else if (!ball)
        gradient[2] = u->glyph == ISO_GLYPH_CONE ? off * u->radius * taper : 0;
    return most;
}

static real outside_at(const ray *r, const void *of, real t) {
    real p[3];
    point_at(r, t, p);
    return outside(of, p, NULL);
}

static bool convex_piece(const unit *u, const ray *r, piece *out) {
    const real length = sqrtl(r->square), middle = -dot(r->origin, r->direction) / r->square,
               reach = 2 / length;
    const real inside = least(outside_at, r, u, middle - reach, middle + reach, 0, 2 * length);
    if (!(outside_at(r, u, inside) <= 0)) return false;
    for (int end = 0; end < 2; end++) {
        real in = inside, beyond = end ? middle + reach : middle - reach, p[3];
        for (int step = 0; step < STEPS; step++) {
            const real half = (in + beyond) / 2;
            *(outside_at(r, u, half) <= 0 ? &in : &beyond) = half;
        }
        out->t[end] = in;
        point_at(r, in, p);
        outside(u, p, out->normal[end]);
    }
    return true;
}

static bool disc_piece(const ray *r, piece *out) {
    const real t = -r->origin[2] / r->direction[2];
    real p[3];
    point_at(r, t, p);
    if (!(p[0] * p[0] + p[1] * p[1] <= 1)) return false;
    for (int end = 0; end < 2; end++) {
        out->t[end] = t;
        out->normal[end][0] = out->normal[end][1] = 0;
        out->normal[end][2] = r->direction[2] > 0 ? -1 : 1;
    }
    return true;
}

/* Finds the pieces of a ray in a unit solid, merged where they touch. Returns their number. */
static int unit_pieces(iso_glyph glyph, const ray *r, piece out[2]) {
    const unit whole = {glyph, 1, -1, 1}, shaft = {ISO_GLYPH_CYLINDER, 0.3L, -1, 0.3L},
               head = {ISO_GLYPH_CONE, 1, 0.3L, 1};
    if (glyph == ISO_GLYPH_DISC) return disc_piece(r, out);
    if (glyph != ISO_GLYPH_ARROW) return convex_piece(&whole, r, out);
    int count = convex_piece(&shaft, r, out);
    count += convex_piece(&head, r, out + count);
    if (count < 2 || out[0].t[0] > out[1].t[1] + 1e-12L || out[1].t[0] > out[0].t[1] + 1e-12L) return count;
    const piece a = out[0], b = out[1];
    const piece *ends[2] = {a.t[0] < b.t[0] ? &a : &b, a.t[1] > b.t[1] ? &a : &b};
    for (int end = 0; end < 2; end++) {
        out[0].t[end] = ends[end]->t[end];
        for (int k = 0; k < 3; k++) out[0].normal[end][k] = ends[end]->normal[end][k];
    }
    return 1;
}

/* Computes the rows of the inverse of the matrix with these columns. */
static void invert(const real columns[3][3], real rows[3][3]) {
    for (int i = 0; i < 3; i++) {
        const real *b = columns[(i + 1) % 3], *c = columns[(i + 2) % 3];
        const real cross[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2],
                               b[0] * c[1] - b[1] * c[0]};
        const real determinant = dot(cross, columns[i]);
        for (int a = 0; a < 3; a++) rows[i][a] = cross[a] / determinant;
    }
}

/* Updates `hit` if the piece's first end that is not in front of the near plane is nearer. Returns whether it
 * was. */
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
    cone shape;         /* a sphere when path and taper are 0 */
    real inverse[3][3]; /* of other glyphs: from view space to the unit solid */
    iso_glyph glyph;
    real size, largest; /* the smallest and the largest radius */
    bool is_cone, is_patch;
    patch patch;
    size_t number; /* number of the glyph, or of the segment's first vertex */
    size_t whole;  /* number of the glyph or of the line; overlapping pieces of one line are merged */
} solid;

/* A piece of the ray and the solid that it lies in. */
typedef struct listed {
    piece piece;
    const solid *solid;
} listed;

struct iso_shapes_truth {
    const iso_view *view;
    solid *solids;
    size_t count;
    listed *listed; /* working memory of iso_shapes_truth_layers; NULL before its first call */
};

/* Computes the vectors (world space) that a glyph's unit solid has as axes, and the vector from the glyph's
 * position to the solid's centre. */
static void axes_of(const iso_glyphs *glyphs, size_t i, const iso_shapes_opts *opts, real axis[3][3],
                    real center[3]) {
    const real scale = opts->scale > 0 ? (real)opts->scale : 1;
    real radius = scale * (real)(glyphs->radii ? (double)glyphs->radii[i] : opts->radius), along[3] = {0},
         length;
    for (int a = 0; a < 3; a++) center[a] = 0;
    if (opts->glyph == ISO_GLYPH_ELLIPSOID || opts->glyph == ISO_GLYPH_BOX) {
        for (int k = 0; k < 9; k++)
            axis[k / 3][k % 3] = glyphs->axes ? scale * (real)glyphs->axes[i][k] : k % 4 ? 0 : radius;
        return;
    }
    for (int a = 0; a < 3; a++) along[a] = scale * (real)glyphs->directions[i][a];
    length = sqrtl(dot(along, along));
    if (!(radius > 0)) radius = length * (opts->glyph == ISO_GLYPH_CONE ? 1 / 3.0L : 0.1L);
    const bool disc = opts->glyph == ISO_GLYPH_DISC;
    for (int a = 0; a < 3; a++) {
        axis[2][a] = disc ? along[a] / length * radius : along[a] / 2;
        center[a] = disc ? 0 : along[a] / 2;
    }
    /* any two vectors perpendicular to the direction will do, because the solid is round */
    const int k = fabsl(along[0]) < length / 2 ? 0 : 1;
    for (int a = 0; a < 3; a++) axis[0][a] = (a == k) - along[k] * along[a] / (length * length);
    const real size = sqrtl(dot(axis[0], axis[0]));
    for (int a = 0; a < 3; a++) axis[0][a] *= radius / size;
    for (int a = 0; a < 3; a++)
        axis[1][a] =
            (along[(a + 1) % 3] * axis[0][(a + 2) % 3] - along[(a + 2) % 3] * axis[0][(a + 1) % 3]) / length;
}

static void add_solid(iso_shapes_truth *truth, const iso_glyphs *glyphs, size_t i,
                      const iso_shapes_opts *opts) {
    solid *s = &truth->solids[truth->count++];
    real axis[3][3], offset[3], columns[3][3], shift[3];
    *s = (solid){.number = i, .whole = i, .glyph = opts->glyph, .size = INFINITY};
    axes_of(glyphs, i, opts, axis, offset);
    to_view(truth->view, glyphs->origin, glyphs->positions[i], s->shape.center);
    turn(truth->view, offset, shift);
    for (int k = 0; k < 3; k++) {
        turn(truth->view, axis[k], columns[k]);
        const real length = sqrtl(dot(axis[k], axis[k]));
        s->size = length < s->size ? length : s->size;
        s->largest += length;
        s->shape.center[k] += shift[k];
    }
    invert((const real(*)[3])columns, s->inverse);
}

static void add_glyphs(iso_shapes_truth *truth, const iso_glyphs *glyphs, const iso_shapes_opts *opts) {
    const double scale = opts->scale > 0 ? opts->scale : 1;
    for (size_t i = 0; i < glyphs->count; i++) {
        if (opts->glyph != ISO_GLYPH_SPHERE) {
            add_solid(truth, glyphs, i, opts);
            continue;
        }
        solid *s = &truth->solids[truth->count];
        *s = (solid){.number = i, .whole = i};
        s->largest = s->size = (real)scale * (real)(glyphs->radii ? (double)glyphs->radii[i] : opts->radius);
        to_view(truth->view, glyphs->origin, glyphs->positions[i], s->shape.center);
        s->shape.radius = s->largest;
        if (s->largest > 0) truth->count++;
    }
}

/* Returns the radius of a vertex at depth z, widened to the least width on the screen. */
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

static void store_difference(const float a[3], const float b[3], real out[3]) {
    for (int k = 0; k < 3; k++) out[k] = (real)b[k] - (real)a[k];
}

/* Computes the tangent of a line at a vertex, between the directions of the adjacent segments. */
static void tangent_at(const iso_lines *lines, size_t line, size_t vertex, real out[3]) {
    real way[2][3] = {{0}};
    for (size_t i = lines->starts[line]; i + 1 < lines->starts[line + 1]; i++) {
        real path[3];
        store_difference(lines->vertices[i], lines->vertices[i + 1], path);
        const real length = sqrtl(dot(path, path));
        if (!(length > 0)) continue;
        if (i >= vertex && dot(way[1], way[1]) > 0) break;
        for (int k = 0; k < 3; k++) way[i >= vertex][k] = path[k] / length;
    }
    for (int k = 0; k < 3; k++) out[k] = way[0][k] + way[1][k];
    for (int k = 0; k < 3 && dot(out, out) < 1e-12L; k++) out[k] = way[0][k];
}

/* Computes the vector from the middle of a ribbon to its edge at a vertex. */
static void edge_at(const iso_shapes_truth *truth, const iso_lines *lines, size_t line, size_t vertex,
                    real radius, real out[3]) {
    real tangent[3], across[3];
    const float *n = lines->normals[vertex];
    tangent_at(lines, line, vertex, tangent);
    for (int a = 0; a < 3; a++)
        across[a] = tangent[(a + 1) % 3] * (real)n[(a + 2) % 3] - tangent[(a + 2) % 3] * (real)n[(a + 1) % 3];
    const real length = sqrtl(dot(across, across));
    for (int a = 0; a < 3; a++) across[a] *= radius / length;
    turn(truth->view, across, out);
}

/* Turns a solid that add_segment has made into the patch of a ribbon. */
static void make_patch(const iso_shapes_truth *truth, const iso_lines *lines, size_t line, solid *s) {
    for (int a = 0; a < 3; a++) {
        s->patch.center[a] = s->shape.center[a];
        s->patch.path[a] = s->shape.path[a];
    }
    s->is_patch = true;
    edge_at(truth, lines, line, s->number, s->shape.radius, s->patch.edge[0]);
    edge_at(truth, lines, line, s->number + 1, s->shape.radius + s->shape.taper, s->patch.edge[1]);
}

static void add_lines(iso_shapes_truth *truth, const iso_lines *lines, const iso_shapes_opts *opts) {
    for (size_t i = 0; i < lines->line_count; i++)
        for (size_t v = lines->starts[i]; v + 1 < lines->starts[i + 1]; v++) {
            const size_t before = truth->count;
            add_segment(truth, lines, v, opts);
            if (truth->count == before) continue;
            truth->solids[before].whole = i;
            if (opts->style == ISO_LINE_RIBBON) make_patch(truth, lines, i, &truth->solids[before]);
            if (opts->caps != ISO_CAPS_FLAT) continue;
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
    iso_free(truth->listed);
    iso_free(truth);
}

/* Returns true if the ray certainly misses a solid, tested in double precision with a margin. */
static bool passes(const ray *r, const solid *s) {
    double to[3], d[3], path[3], dd = 0, td = 0, pd = 0, tp = 0, pp = 0;
    for (int a = 0; a < 3; a++) {
        to[a] = (double)(s->shape.center[a] - r->origin[a]);
        d[a] = (double)r->direction[a];
        path[a] = (double)s->shape.path[a];
        dd += d[a] * d[a], td += to[a] * d[a], pd += path[a] * d[a];
    }
    for (int a = 0; a < 3; a++) { /* components perpendicular to the ray */
        to[a] -= td / dd * d[a], path[a] -= pd / dd * d[a];
        tp += to[a] * path[a], pp += path[a] * path[a];
    }
    const double t = pp > 0 ? fmin(fmax(-tp / pp, 0), 1) : 0;
    double away = 0, reach = 1.001 * (double)s->largest + 1e-9 * fabs(td);
    for (int a = 0; a < 3; a++) away += (to[a] + t * path[a]) * (to[a] + t * path[a]);
    return away > reach * reach;
}

/* Finds the pieces of a ray in a glyph that is neither a sphere nor a segment. Returns their number. */
static int solid_pieces(const solid *s, const ray *r, piece out[2]) {
    ray local;
    real to[3];
    for (int a = 0; a < 3; a++) to[a] = s->shape.center[a] - r->origin[a];
    /* measured from the point nearest to the centre, for precision */
    const real shift = dot(to, r->direction) / r->square;
    for (int a = 0; a < 3; a++) to[a] = shift * r->direction[a] - to[a];
    for (int i = 0; i < 3; i++) {
        local.origin[i] = dot(s->inverse[i], to);
        local.direction[i] = dot(s->inverse[i], r->direction);
    }
    local.square = dot(local.direction, local.direction);
    const int count = unit_pieces(s->glyph, &local, out);
    for (int i = 0; i < count; i++)
        for (int end = 0; end < 2; end++) {
            const real n[3] = {out[i].normal[end][0], out[i].normal[end][1], out[i].normal[end][2]};
            out[i].t[end] += shift;
            for (int a = 0; a < 3; a++)
                out[i].normal[end][a] =
                    n[0] * s->inverse[0][a] + n[1] * s->inverse[1][a] + n[2] * s->inverse[2][a];
        }
    return count;
}

static int pieces_of(const solid *s, const ray *r, piece out[2]) {
    if (s->is_patch) return patch_piece(r, &s->patch, out);
    if (s->is_cone) return cone_piece(r, &s->shape, out);
    if (s->glyph == ISO_GLYPH_SPHERE) return sphere_piece(r, s->shape.center, s->shape.radius, out);
    return solid_pieces(s, r, out);
}

iso_shapes_hit iso_shapes_truth_ray(const iso_shapes_truth *truth, double px, double py) {
    const ray r = ray_of(truth->view, px, py);
    iso_shapes_hit hit = {.behind = INFINITY};
    for (size_t i = 0; i < truth->count; i++) {
        const solid *s = &truth->solids[i];
        piece p[2];
        if (passes(&r, s)) continue;
        const int count = pieces_of(s, &r, p);
        for (int k = 0; k < count; k++)
            if (take(truth->view, &p[k], &hit)) {
                hit.size = (double)s->size;
                hit.shape = s->number;
            }
    }
    return hit;
}

/* ---- all layers of a ray */

/* Depths that differ by less than this share of a shape's radius count as equal. */
static const real SAME = 1e-7L;

/* Returns whether both ends of a piece count as one layer, as in ribbons and discs. */
static bool is_flat(const listed *l) {
    return !(l->piece.t[1] - l->piece.t[0] > SAME * l->solid->largest) &&
           (l->solid->is_patch || l->solid->glyph == ISO_GLYPH_DISC);
}

/* Returns whether the end of a piece is no layer, because it lies inside another piece of the same line or
 * coincides with the end of an earlier one. */
static bool is_merged(const listed *all, size_t count, size_t index, int end) {
    const listed *own = &all[index];
    const real t = own->piece.t[end], same = SAME * own->solid->largest;
    for (size_t i = 0; i < count; i++) {
        const listed *other = &all[i];
        const real *ends = other->piece.t;
        if (i == index || other->solid->whole != own->solid->whole) continue;
        if (!own->solid->is_patch) {
            if (t > ends[0] + same && t < ends[1] - same) return true;
            if (i < index && fabsl(t - ends[end]) <= same) return true;
        } else if (i < index && (fabsl(t - ends[0]) <= same || fabsl(t - ends[1]) <= same)) {
            return true;
        }
    }
    return false;
}

static void insert(const listed *from, int end, iso_shapes_layer *layers, size_t count) {
    const real length = sqrtl(dot(from->piece.normal[end], from->piece.normal[end]));
    iso_shapes_layer layer = {
        .depth = (double)from->piece.t[end], .leaves = end == 1, .shape = from->solid->number};
    for (int a = 0; a < 3; a++) layer.normal[a] = (double)(from->piece.normal[end][a] / length);
    for (; count > 0 && layers[count - 1].depth > layer.depth; count--) layers[count] = layers[count - 1];
    layers[count] = layer;
}

size_t iso_shapes_truth_layers(iso_shapes_truth *truth, double px, double py, iso_shapes_layer *layers,
                               size_t most) {
    const ray r = ray_of(truth->view, px, py);
    size_t pieces = 0, count = 0;
    if (!truth->listed) truth->listed = iso_alloc((2 * truth->count + 1) * sizeof *truth->listed);
    for (size_t i = 0; i < truth->count && truth->listed; i++) {
        const solid *s = &truth->solids[i];
        piece p[2];
        if (passes(&r, s)) continue;
        const int found = pieces_of(s, &r, p);
        for (int k = 0; k < found; k++) truth->listed[pieces++] = (listed){p[k], s};
    }
    for (size_t i = 0; i < pieces; i++)
        for (int end = 0; end < 2 - is_flat(&truth->listed[i]); end++) {
            const real t = truth->listed[i].piece.t[end];
            if (!(t >= (real)truth->view->near) || is_merged(truth->listed, pieces, i, end)) continue;
            if (count < most) insert(&truth->listed[i], end, layers, count++);
        }
    return count;
}
