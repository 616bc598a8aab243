/* near: the piece of a ray inside a shape, in double precision. Shapes are convex: the piece lies between the
 * first and the last intersection with any of the surfaces that bound the shape. A shape that the near plane
 * cuts is seen from inside. */
#include "render/shapes/near.h"

#include <math.h>

#include "render/shapes/solid.h"

typedef iso_near_ray ray;
typedef iso_near_piece piece;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

ray iso_near_ray_of(const iso_shapes_frame *frame, int x, int y) {
    const double u = (x + 0.5 - frame->cx) / frame->focal, v = (y + 0.5 - frame->cy) / frame->focal;
    if (frame->parallel) return (ray){{u, v, 0}, {0, 0, 1}};
    return (ray){{0, 0, 0}, {u, v, 1}};
}

/* ---- intersections */

/* Extends the piece to an intersection with a surface at t. along: of the side, mm. */
static void extend(piece *p, double t, iso_near_surface surface, double along) {
    for (int end = 0; end < 2; end++) {
        if (end ? !(t > p->t[1]) : !(t < p->t[0])) continue;
        p->t[end] = t;
        p->surface[end] = surface;
        p->along[end] = along;
    }
}

static void meet_sphere(const ray *r, const iso_near_shape *s, int last, piece *p) {
    const double dd = dot(r->direction, r->direction), *centre = s->end[last], radius = s->radius[last];
    const double to[3] = {centre[0] - r->origin[0], centre[1] - r->origin[1], centre[2] - r->origin[2]};
    const double middle = dot(to, r->direction) / dd;
    /* From the centre to the nearest point of the ray. Its square is computed from this short vector: as a
     * difference of two large squares it would lose its digits. */
    double off[3];
    for (int a = 0; a < 3; a++) off[a] = middle * r->direction[a] - to[a];
    const double rest = radius * radius - dot(off, off);
    if (!(radius > 0 && rest >= 0)) return;
    const double half = sqrt(rest / dd);
    extend(p, middle - half, last ? ISO_NEAR_LAST : ISO_NEAR_FIRST, last);
    extend(p, middle + half, last ? ISO_NEAR_LAST : ISO_NEAR_FIRST, last);
}

/* The part of the cone that touches both spheres, between the circles where it does. Returns how often it is
 * met, or -1 when the ray misses the whole cone, which holds both spheres. */
static int meet_side(const ray *r, const iso_near_shape *s, piece *p) {
    const double *axis = s->axis, sine = s->sine;
    const double g = (1 - sine) * (1 + sine), dd = dot(r->direction, r->direction);
    const double to[3] = {s->end[0][0] - r->origin[0], s->end[0][1] - r->origin[1],
                          s->end[0][2] - r->origin[2]};
    const double shift =
        dot(to, r->direction) /
        dd; /* The ray is taken to start at its point nearest to the tube's end, for precision. */
    double o[3];
    for (int a = 0; a < 3; a++) o[a] = shift * r->direction[a] - to[a];
    const double da = dot(r->direction, axis), oa = dot(o, axis), radius = s->radius[0] + sine * oa,
                 widening = sine * da;
    const double a = g * (dd - da * da) - widening * widening,
                 b = g * (dot(o, r->direction) - oa * da) - radius * widening,
                 c = g * (dot(o, o) - oa * oa) - radius * radius, discriminant = b * b - a * c;
    if (!(discriminant >= 0)) return -1;
    const double q = -(b + copysign(sqrt(discriminant), b)), roots[2] = {q / a, c / q};
    int met = 0;
    for (int i = 0; i < 2; i++) {
        const double along = (oa + roots[i] * da + s->radius[0] * sine) / g;
        if (!(along >= 0 && along <= s->length)) continue;
        extend(p, shift + roots[i], ISO_NEAR_SIDE, along);
        met++;
    }
    return met;
}

/* Cuts the piece at the plane through one end of the tube (`last`: the second). Returns false if nothing is
 * left. */
static bool cut(const ray *r, const iso_near_shape *s, int last, piece *p) {
    const double outward = (last ? 1 : -1) * dot(r->direction, s->axis);
    double from[3];
    for (int a = 0; a < 3; a++) from[a] = s->end[last][a] - r->origin[a];
    const double t = dot(from, s->axis) / dot(r->direction, s->axis);
    const int end = outward > 0; /* the ray leaves or enters through the plane */
    if (end ? !(t < p->t[1]) : !(t > p->t[0])) return true;
    p->t[end] = t;
    p->along[end] = last;
    p->surface[end] = last ? ISO_NEAR_LAST_CUT : ISO_NEAR_FIRST_CUT;
    return p->t[0] <= p->t[1];
}

static bool meet_tube(const ray *r, const iso_near_shape *s, piece *p) {
    const int met = s->holds ? 0 : meet_side(r, s, p);
    if (met < 0) return false;
    for (int end = 0; end < 2 && met < 2; end++) meet_sphere(r, s, end, p);
    if (s->holds) return p->t[0] <= p->t[1];
    if (s->flags & ISO_TUBE_CUT_FIRST && !cut(r, s, 0, p)) return false;
    if (s->flags & ISO_TUBE_CUT_LAST && !cut(r, s, 1, p)) return false;
    return p->t[0] <= p->t[1];
}

void iso_near_finish(const iso_near_shape *s, const ray *r, piece *p, int end) {
    const iso_near_surface surface = p->surface[end];
    const bool first = surface == ISO_NEAR_FIRST || surface == ISO_NEAR_FIRST_CUT;
    double centre[3], radius = s->radius[!first];
    for (int a = 0; a < 3; a++) centre[a] = s->end[!first][a];
    if (surface == ISO_NEAR_FINISHED) return;
    p->surface[end] = ISO_NEAR_FINISHED;
    if (surface == ISO_NEAR_FIRST_CUT || surface == ISO_NEAR_LAST_CUT) {
        for (int a = 0; a < 3; a++) p->normal[end][a] = first ? -s->axis[a] : s->axis[a];
        return;
    }
    if (surface == ISO_NEAR_SIDE) {
        for (int a = 0; a < 3; a++) centre[a] = s->end[0][a] + p->along[end] * s->axis[a];
        radius = s->radius[0] + s->sine * p->along[end];
        p->along[end] /= s->length;
    }
    for (int a = 0; a < 3; a++)
        p->normal[end][a] = (r->origin[a] + p->t[end] * r->direction[a] - centre[a]) / radius;
}

/* ---- ribbons: see ribbon_simd.h for the quadratic */

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Extends the piece to the intersection with the patch at the fraction s of its length, if there is one. */
static void extend_ribbon(piece *p, const ray *r, const iso_near_shape *shape, double s) {
    double m[3], h[3], path[3], turn[3], normal[3], flat_m[3], flat_h[3];
    if (!(s >= -1e-9 && s <= 1 + 1e-9)) return;
    for (int a = 0; a < 3; a++) {
        const double first = shape->radius[0] * shape->across[0][a];
        path[a] = shape->end[1][a] - shape->end[0][a];
        turn[a] = shape->radius[1] * shape->across[1][a] - first;
        m[a] = r->origin[a] - shape->end[0][a] - s * path[a]; /* from the line to the ray */
        h[a] = first + s * turn[a];
    }
    cross(m, r->direction, flat_m);
    cross(h, r->direction, flat_h);
    const double t = dot(flat_m, flat_h) / dot(flat_h, flat_h);
    if (!(fabs(t) <= 1)) return;
    for (int a = 0; a < 3; a++) {
        path[a] += t * turn[a];
        m[a] = t * h[a] - m[a];
    }
    const double depth = dot(m, r->direction) / dot(r->direction, r->direction);
    cross(path, h, normal);
    const double sign = dot(normal, r->direction) > 0 ? -1 : 1, size = sqrt(dot(normal, normal));
    for (int end = 0; end < 2; end++) {
        if (end ? !(depth > p->t[1]) : !(depth < p->t[0])) continue;
        p->t[end] = depth;
        p->along[end] = s;
        p->surface[end] = ISO_NEAR_FINISHED;
        for (int a = 0; a < 3; a++) p->normal[end][a] = sign * normal[a] / size;
    }
}

/* A ray intersects a patch at most twice: the intersections are the ends of the piece. */
static void meet_ribbon(const ray *r, const iso_near_shape *shape, piece *p) {
    double path[3], first[3], last[3], turn[3], from[3], rest[3], normal[3];
    for (int a = 0; a < 3; a++) {
        path[a] = shape->end[1][a] - shape->end[0][a];
        first[a] = shape->radius[0] * shape->across[0][a];
        last[a] = shape->radius[1] * shape->across[1][a];
        turn[a] = last[a] - first[a];
        from[a] = r->origin[a] - shape->end[0][a];
        rest[a] = from[a] - path[a];
    }
    cross(first, from, normal);
    const double c = dot(normal, r->direction);
    cross(last, rest, normal);
    const double end = dot(normal, r->direction);
    cross(path, turn, normal);
    const double a = dot(normal, r->direction), b = end - c - a, discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0)) return;
    const double sum = -0.5 * (b + copysign(sqrt(discriminant), b));
    extend_ribbon(p, r, shape, c / sum);
    extend_ribbon(p, r, shape, sum / a);
}

/* ---- solids, in the coordinates of the unit solid */

/* Cuts the piece to where low <= coordinate <= high. */
static void meet_slab(const ray *r, int axis, double low, double high, piece *p) {
    const double d = r->direction[axis], o = r->origin[axis];
    if (d == 0) {
        if (o < low || o > high) p->t[1] = -INFINITY;
        return;
    }
    for (int end = 0; end < 2; end++) {
        const double t = ((end ? d > 0 : d < 0) ? high - o : low - o) / d;
        if (end ? !(t < p->t[1]) : !(t > p->t[0])) continue;
        p->t[end] = t;
        for (int a = 0; a < 3; a++) p->normal[end][a] = 0;
        p->normal[end][axis] = (end ? d > 0 : d < 0) ? 1 : -1;
    }
}

/* Keeps the part of the piece where x^2 + y^2 + round z^2 <= (radius + slant z)^2 and the right side's root
 * is not negative. */
static void meet_quadric(const ray *r, double round, double radius, double slant, piece *p) {
    const double *o = r->origin, *d = r->direction, w = radius + slant * o[2], dw = slant * d[2];
    const double a = d[0] * d[0] + d[1] * d[1] + round * d[2] * d[2] - dw * dw,
                 b = o[0] * d[0] + o[1] * d[1] + round * o[2] * d[2] - w * dw,
                 c = o[0] * o[0] + o[1] * o[1] + round * o[2] * o[2] - w * w, discriminant = b * b - a * c;
    if (a == 0 && b == 0 && c <= 0) return; /* along a cylinder */
    if (!(discriminant >= 0)) {
        p->t[1] = -INFINITY;
        return;
    }
    const double q = -(b + copysign(sqrt(discriminant), b)), x = q / a, y = c / q;
    double roots[2] = {fmin(x, y), fmax(x, y)};
    if (a < 0) { /* the ray passes through the cone's wide end */
        const bool widens = dw > 0;
        roots[0] = widens ? roots[1] : -INFINITY;
        roots[1] = widens ? INFINITY : fmin(x, y);
    }
    for (int end = 0; end < 2; end++) {
        if (end ? !(roots[1] < p->t[1]) : !(roots[0] > p->t[0])) continue;
        const double t = p->t[end] = roots[end], z = o[2] + t * d[2];
        for (int k = 0; k < 2; k++) p->normal[end][k] = o[k] + t * d[k];
        p->normal[end][2] = round * z - slant * (radius + slant * z);
    }
}

static piece whole_ray(void) {
    return (piece){.t = {-INFINITY, INFINITY}, .surface = {ISO_NEAR_FINISHED, ISO_NEAR_FINISHED}};
}

static piece meet_cone_from(const ray *r, double base) {
    piece p = whole_ray();
    meet_quadric(r, 0, 1 / (1 - base), -1 / (1 - base), &p);
    meet_slab(r, 2, base, 1, &p);
    return p;
}

static piece meet_cylinder(const ray *r, double radius, double low, double high) {
    piece p = whole_ray();
    meet_quadric(r, 0, radius, 0, &p);
    meet_slab(r, 2, low, high, &p);
    return p;
}

/* Lists the pieces of a ray in an arrow, in order. Head and shaft touch: where one piece ends the next one
 * may begin. */
static int meet_arrow(const ray *r, piece out[ISO_NEAR_PIECES]) {
    piece a = meet_cylinder(r, ISO_ARROW_SHAFT, -1, ISO_ARROW_NECK), b = meet_cone_from(r, ISO_ARROW_NECK);
    const bool first = a.t[0] <= a.t[1], second = b.t[0] <= b.t[1];
    out[0] = first ? a : b;
    if (!first || !second) return first || second;
    if (b.t[0] < a.t[0]) {
        const piece swapped = b;
        b = a;
        a = swapped;
    }
    out[0] = a;
    out[1] = b;
    if (a.t[1] < b.t[0] - 1e-9 * fabs(b.t[0])) return 2;
    if (b.t[1] > a.t[1]) {
        out[0].t[1] = b.t[1];
        for (int k = 0; k < 3; k++) out[0].normal[1][k] = b.normal[1][k];
    }
    return 1;
}

static int meet_unit(iso_glyph glyph, const ray *r, piece out[ISO_NEAR_PIECES]) {
    if (glyph == ISO_GLYPH_ARROW) return meet_arrow(r, out);
    piece p = whole_ray();
    if (glyph == ISO_GLYPH_CONE) p = meet_cone_from(r, -1);
    if (glyph == ISO_GLYPH_CYLINDER) p = meet_cylinder(r, 1, -1, 1);
    if (glyph == ISO_GLYPH_ELLIPSOID) meet_quadric(r, 1, 1, 0, &p);
    if (glyph == ISO_GLYPH_DISC) p = meet_cylinder(r, 1, 0, 0);
    for (int axis = 0; axis < 3 && glyph == ISO_GLYPH_BOX; axis++) meet_slab(r, axis, -1, 1, &p);
    out[0] = p;
    return p.t[0] <= p.t[1];
}

/* Transforms a piece from the coordinates of the unit solid to view space. */
static void to_view(const iso_near_shape *s, double shift, piece *p) {
    for (int end = 0; end < 2; end++) {
        double n[3] = {0};
        p->t[end] += shift;
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 3; a++) n[a] += s->inverse[i][a] * p->normal[end][i];
        const double length = sqrt(dot(n, n));
        for (int a = 0; a < 3; a++) p->normal[end][a] = n[a] / length;
    }
}

/* For precision, the ray is taken to start at its point nearest to the solid's centre. */
static int meet_solid(iso_glyph glyph, const iso_near_shape *s, const ray *r, piece out[ISO_NEAR_PIECES]) {
    double to[3], from[3];
    for (int a = 0; a < 3; a++) to[a] = s->end[0][a] - r->origin[a];
    const double shift = dot(to, r->direction) / dot(r->direction, r->direction);
    for (int a = 0; a < 3; a++) from[a] = shift * r->direction[a] - to[a];
    ray unit;
    for (int i = 0; i < 3; i++) {
        unit.origin[i] = dot(s->inverse[i], from);
        unit.direction[i] = dot(s->inverse[i], r->direction);
    }
    const int count = meet_unit(glyph, &unit, out);
    for (int i = 0; i < count; i++) to_view(s, shift, &out[i]);
    return count;
}

int iso_near_pieces(const iso_shapes_frame *frame, const iso_near_shape *shape, const ray *r,
                    piece pieces[ISO_NEAR_PIECES]) {
    const iso_shape_kind kind = iso_shapes_kind(frame->shapes);
    piece *p = pieces;
    if (kind == ISO_SHAPE_SOLID) return meet_solid(frame->shapes->glyph, shape, r, pieces);
    p->t[0] = INFINITY;
    p->t[1] = -INFINITY;
    if (kind == ISO_SHAPE_SPHERE) meet_sphere(r, shape, 0, p);
    if (kind == ISO_SHAPE_RIBBON) meet_ribbon(r, shape, p);
    if (kind == ISO_SHAPE_TUBE && !meet_tube(r, shape, p)) return 0;
    return p->t[0] <= p->t[1];
}

/* Where the ray first meets the shape at or behind the near plane: the piece, and *end which of its ends. */
static bool meet(const iso_shapes_frame *frame, const iso_near_shape *shape, const ray *r, piece *p,
                 int *end) {
    piece pieces[ISO_NEAR_PIECES];
    const int count = iso_near_pieces(frame, shape, r, pieces);
    for (int i = 0; i < count; i++) {
        if (!(pieces[i].t[1] >= frame->near)) continue;
        *p = pieces[i];
        *end = !(p->t[0] >= frame->near);
        return true;
    }
    return false;
}

/* ---- shapes */

bool iso_near_fits(const iso_shapes_frame *frame, double front, double reach) {
    if (!(front > frame->near * (frame->near > 0 ? 1.0001 : 0.9999))) return false;
    if (frame->parallel) return reach * frame->focal < ISO_SHAPES_LARGE;
    return front > reach * 1e-3 && reach * frame->focal < ISO_SHAPES_LARGE * front;
}

double iso_near_nearest(const iso_shapes_frame *frame, double front) {
    const double depth = front > frame->near ? front : frame->near;
    return depth - 1e-6 * fabs(depth);
}

iso_near_shape iso_near_sphere(const iso_shapes_frame *frame, const double centre[3], double radius,
                               uint32_t id) {
    iso_near_shape shape = {
        .radius = {radius, radius}, .nearest = iso_near_nearest(frame, centre[2] - radius), .id = id};
    for (int a = 0; a < 3; a++) shape.end[0][a] = shape.end[1][a] = centre[a];
    return shape;
}

/* Sets the vector across a ribbon at a vertex, in view space. */
static void turn_across(const iso_shapes_frame *frame, uint32_t vertex, double out[3]) {
    float v[3];
    iso_shapes_across(frame->shapes, vertex, v);
    const double *m = frame->rotation;
    for (int a = 0; a < 3; a++)
        out[a] = m[3 * a] * (double)v[0] + m[3 * a + 1] * (double)v[1] + m[3 * a + 2] * (double)v[2];
}

iso_near_vertex iso_near_vertex_of(const iso_shapes_frame *frame, uint32_t vertex) {
    const float *v = frame->shapes->vertices[vertex];
    const double position[3] = {(double)v[0], (double)v[1], (double)v[2]};
    iso_near_vertex made;
    iso_shapes_to_view(frame, position, made.position);
    const double z = made.position[2] > frame->near ? made.position[2] : frame->near,
                 least = z * frame->least_slope + frame->least_fixed, radius = (double)v[3];
    made.widened = radius < least;
    made.radius = made.widened ? least : radius;
    return made;
}

/* Sets the axis of a rounded cone. */
static void set_axis(iso_near_shape *s) {
    for (int a = 0; a < 3; a++) s->axis[a] = s->end[1][a] - s->end[0][a];
    const double taper = s->radius[1] - s->radius[0];
    s->length = sqrt(dot(s->axis, s->axis));
    s->holds = !(s->length > fabs(taper));
    if (s->holds) return;
    for (int a = 0; a < 3; a++) s->axis[a] /= s->length;
    s->sine = taper / s->length;
}

iso_near_shape iso_near_between(const iso_shapes_frame *frame, const iso_near_vertex *a,
                                const iso_near_vertex *b, uint32_t id, int flags) {
    const double front = fmin(a->position[2] - a->radius, b->position[2] - b->radius);
    iso_near_shape shape = {.radius = {a->radius, b->radius},
                            .nearest = iso_near_nearest(frame, front),
                            .id = id,
                            .flags = flags | (a->widened || b->widened ? ISO_TUBE_WIDENED : 0),
                            .kind = iso_shapes_kind(frame->shapes)};
    for (int k = 0; k < 3; k++) {
        shape.end[0][k] = a->position[k];
        shape.end[1][k] = b->position[k];
    }
    if (shape.kind == ISO_SHAPE_TUBE) set_axis(&shape);
    for (int end = 0; end < 2 && shape.kind == ISO_SHAPE_RIBBON; end++)
        turn_across(frame, id + (uint32_t)end, shape.across[end]);
    return shape;
}

iso_near_shape iso_near_segment(const iso_shapes_frame *frame, uint32_t id, int flags) {
    const iso_near_vertex a = iso_near_vertex_of(frame, id), b = iso_near_vertex_of(frame, id + 1);
    return iso_near_between(frame, &a, &b, id, flags);
}

/* ---- drawing */

static void draw_tile(iso_shapes_bin *bin, const iso_near_shape *shape, int x0, int y0, float *farthest) {
    float most = -INFINITY;
    for (int y = y0; y < y0 + ISO_SHAPES_TILE; y++)
        for (int x = x0; x < x0 + ISO_SHAPES_TILE; x++) {
            const size_t at = iso_shapes_pixel(bin, x, y);
            const ray r = iso_near_ray_of(bin->frame, x, y);
            piece p;
            int end;
            if (bin->depth[at] > -INFINITY && meet(bin->frame, shape, &r, &p, &end) &&
                (float)p.t[end] < bin->depth[at]) {
                bin->depth[at] = (float)p.t[end];
                bin->record[at] = -2 - (int32_t)bin->near_count;
            }
            if (bin->depth[at] > most) most = bin->depth[at];
        }
    *farthest = most;
}

/* Returns a lower bound of the depths of a tile's samples. Where the eye is inside a sphere, the distance to
 * the sphere is least in the direction of the tile's cone of rays that points farthest away from the
 * sphere's centre. */
static double nearest_in_tile(const iso_shapes_frame *frame, const iso_near_shape *shape, int x, int y) {
    const double *c = shape->end[0], inside = shape->radius[0] * shape->radius[0] - dot(c, c);
    const double half =
        (ISO_SHAPES_TILE / 2) * 1.42 / frame->focal; /* sine of the cone's half angle, at most */
    if (shape->kind != ISO_SHAPE_SPHERE || frame->parallel || !(inside > 0) || !(half < 0.5))
        return shape->nearest;
    const ray r = iso_near_ray_of(frame, x + ISO_SHAPES_TILE / 2, y + ISO_SHAPES_TILE / 2);
    const double length = sqrt(dot(r.direction, r.direction)), along = dot(c, r.direction) / length,
                 across = sqrt(fmax(dot(c, c) - along * along, 0));
    const double wide = half + 1 / frame->focal; /* the tile's middle is half a pixel beside that ray */
    const double least = along * (along > 0 ? 1 - wide * wide : 1) - across * wide;
    const double distance = least + sqrt(least * least + inside);
    return fmax(shape->nearest, distance / (length + wide) * (1 - 1e-6));
}

void iso_near_draw(iso_shapes_bin *bin, const iso_near_shape *shape) {
    for (int y = bin->rect.y0; y <= bin->rect.y1; y += ISO_SHAPES_TILE)
        for (int x = bin->rect.x0; x <= bin->rect.x1; x += ISO_SHAPES_TILE) {
            const int row = (y - bin->rect.y0) / ISO_SHAPES_TILE,
                      column = (x - bin->rect.x0) / ISO_SHAPES_TILE;
            float *farthest = &bin->farthest[row * ISO_SHAPES_TILE_PITCH + column];
            if (nearest_in_tile(bin->frame, shape, x, y) < (double)*farthest)
                draw_tile(bin, shape, x, y, farthest);
        }
    ((iso_near_shape *)bin->near.data)[bin->near_count++] = *shape;
}

static void write_sample(iso_shapes_bin *bin, const iso_near_shape *shape, int x, int y) {
    const iso_target *target = bin->frame->target;
    iso_gbuffer *g = target->gbuffer;
    const ray r = iso_near_ray_of(bin->frame, x, y);
    const size_t sample = (size_t)(y - bin->frame->top) * (size_t)g->width + (size_t)x;
    piece p;
    int end;
    if (!meet(bin->frame, shape, &r, &p, &end)) return;
    iso_near_finish(shape, &r, &p, end);
    for (int a = 0; a < 3; a++) g->normal[a][sample] = (float)p.normal[end][a];
    g->depth[sample] = (float)p.t[end];
    g->surface[sample] = target->surface;
    iso_shapes_write_color(bin->frame, sample, shape->id, (float)p.along[end]);
    iso_shapes_write_element(bin->frame, sample, shape->id);
    bin->drawn.samples++;
    bin->drawn.widened += (shape->flags & ISO_TUBE_WIDENED) != 0;
}

void iso_near_resolve(iso_shapes_bin *bin) {
    if (!bin->near_count) return;
    for (int y = bin->rect.y0; y <= bin->rect.y1; y++)
        for (int x = bin->rect.x0; x <= bin->rect.x1; x++) {
            const int32_t record = bin->record[iso_shapes_pixel(bin, x, y)];
            if (record < ISO_SHAPES_NONE)
                write_sample(bin, (const iso_near_shape *)bin->near.data + (-2 - record), x, y);
        }
}
