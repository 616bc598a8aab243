/* near: the piece of a ray inside a shape, in double precision. Shapes are convex: the piece lies between the
 * first and the last intersection with any of the surfaces that bound the shape. A shape that the near plane
 * cuts is seen from inside. */
#include "render/shapes/near.h"

#include <math.h>

#include "render/shapes/kernel.h"

/* A ray: origin + t * direction, t the depth. */
typedef struct ray {
    double origin[3], direction[3];
} ray;

/* Where a ray enters and leaves a shape, with the normals there, and how far along a segment that is. */
typedef struct piece {
    double t[2], normal[2][3], along[2];
} piece;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static ray ray_of(const iso_shapes_frame *frame, int x, int y) {
    const double u = (x + 0.5 - frame->cx) / frame->focal, v = (y + 0.5 - frame->cy) / frame->focal;
    if (frame->parallel) return (ray){{u, v, 0}, {0, 0, 1}};
    return (ray){{0, 0, 0}, {u, v, 1}};
}

/* ---- intersections */

/* Extends the piece to an intersection at t, whose normal points away from `centre`. */
static void extend(piece *p, const ray *r, double t, const double centre[3], double radius, double along) {
    for (int end = 0; end < 2; end++) {
        if (end ? !(t > p->t[1]) : !(t < p->t[0])) continue;
        p->t[end] = t;
        p->along[end] = along;
        for (int a = 0; a < 3; a++)
            p->normal[end][a] = (r->origin[a] + t * r->direction[a] - centre[a]) / radius;
    }
}

static void meet_sphere(const ray *r, const double centre[3], double radius, double along, piece *p) {
    const double dd = dot(r->direction, r->direction);
    const double to[3] = {centre[0] - r->origin[0], centre[1] - r->origin[1], centre[2] - r->origin[2]};
    const double middle = dot(to, r->direction) / dd;
    double off[3]; /* from the centre to the ray: its square does not cancel */
    for (int a = 0; a < 3; a++) off[a] = middle * r->direction[a] - to[a];
    const double rest = radius * radius - dot(off, off);
    if (!(radius > 0 && rest >= 0)) return;
    const double half = sqrt(rest / dd);
    extend(p, r, middle - half, centre, radius, along);
    extend(p, r, middle + half, centre, radius, along);
}

/* The axis of a tube: unit vector, length, difference of the radii / length. False where one sphere holds the
 * other. */
static bool axis_of(const iso_near_shape *s, double axis[3], double *length, double *sine) {
    for (int a = 0; a < 3; a++) axis[a] = s->end[1][a] - s->end[0][a];
    const double taper = s->radius[1] - s->radius[0];
    *length = sqrt(dot(axis, axis));
    if (!(*length > fabs(taper))) return false;
    for (int a = 0; a < 3; a++) axis[a] /= *length;
    *sine = taper / *length;
    return true;
}

/* The part of the cone that touches both spheres, between the circles where it does. */
static void meet_cone(const ray *r, const iso_near_shape *s, const double axis[3], double length, double sine,
                      piece *p) {
    const double g = (1 - sine) * (1 + sine), dd = dot(r->direction, r->direction);
    const double to[3] = {s->end[0][0] - r->origin[0], s->end[0][1] - r->origin[1],
                          s->end[0][2] - r->origin[2]};
    const double shift = dot(to, r->direction) / dd; /* the ray is taken from the point nearest to the end */
    double o[3];
    for (int a = 0; a < 3; a++) o[a] = shift * r->direction[a] - to[a];
    const double da = dot(r->direction, axis), oa = dot(o, axis), radius = s->radius[0] + sine * oa,
                 widening = sine * da;
    const double a = g * (dd - da * da) - widening * widening,
                 b = g * (dot(o, r->direction) - oa * da) - radius * widening,
                 c = g * (dot(o, o) - oa * oa) - radius * radius, discriminant = b * b - a * c;
    if (!(discriminant >= 0)) return;
    const double q = -(b + copysign(sqrt(discriminant), b)), roots[2] = {q / a, c / q};
    for (int i = 0; i < 2; i++) {
        const double along = (oa + roots[i] * da + s->radius[0] * sine) / g;
        if (!(along >= 0 && along <= length)) continue;
        double centre[3];
        for (int k = 0; k < 3; k++) centre[k] = s->end[0][k] + along * axis[k];
        extend(p, r, shift + roots[i], centre, s->radius[0] + sine * along, along / length);
    }
}

/* Cuts the piece at the plane through the end `last`; false when nothing is left. */
static bool cut(const ray *r, const iso_near_shape *s, const double axis[3], int last, piece *p) {
    const double outward = (last ? 1 : -1) * dot(r->direction, axis);
    double from[3];
    for (int a = 0; a < 3; a++) from[a] = s->end[last][a] - r->origin[a];
    const double t = dot(from, axis) / dot(r->direction, axis);
    const int end = outward > 0; /* the ray leaves or enters through the plane */
    if (end ? !(t < p->t[1]) : !(t > p->t[0])) return true;
    p->t[end] = t;
    p->along[end] = last;
    for (int a = 0; a < 3; a++) p->normal[end][a] = last ? axis[a] : -axis[a];
    return p->t[0] <= p->t[1];
}

static bool meet_tube(const ray *r, const iso_near_shape *s, piece *p) {
    double axis[3], length, sine;
    for (int end = 0; end < 2; end++) meet_sphere(r, s->end[end], s->radius[end], end, p);
    if (!axis_of(s, axis, &length, &sine)) return p->t[0] <= p->t[1];
    meet_cone(r, s, axis, length, sine, p);
    if (s->flags & ISO_TUBE_CUT_FIRST && !cut(r, s, axis, 0, p)) return false;
    if (s->flags & ISO_TUBE_CUT_LAST && !cut(r, s, axis, 1, p)) return false;
    return p->t[0] <= p->t[1];
}

/* Where the ray meets the shape; *end: which of the piece's ends is the first at or behind the near plane. */
static bool meet(const iso_shapes_frame *frame, const iso_near_shape *shape, const ray *r, piece *p,
                 int *end) {
    p->t[0] = INFINITY;
    p->t[1] = -INFINITY;
    if (shape->tube) {
        if (!meet_tube(r, shape, p)) return false;
    } else {
        meet_sphere(r, shape->end[0], shape->radius[0], 0, p);
    }
    *end = !(p->t[0] >= frame->near);
    return p->t[0] <= p->t[1] && p->t[*end] >= frame->near;
}

/* ---- shapes */

bool iso_near_fits(const iso_shapes_frame *frame, double front, double reach) {
    if (!(front > frame->near * (frame->near > 0 ? 1.0001 : 0.9999))) return false;
    if (frame->parallel) return reach * frame->focal < ISO_SHAPES_LARGE;
    return front > reach * 1e-3 && reach * frame->focal < ISO_SHAPES_LARGE * front;
}

/* A depth that no visible point of a sphere is nearer than. If the eye is inside, the surface is at least a
 * gap away from it, in any direction. */
static double nearest_of(const iso_shapes_frame *frame, const double centre[3], double radius) {
    const iso_gbuffer *g = frame->target->gbuffer;
    double nearest = centre[2] - radius;
    if (!frame->parallel && dot(centre, centre) < radius * radius) {
        const double u = fabs(frame->cx) + g->width, v = fabs(frame->cy - frame->top) + g->height,
                     gap = radius - sqrt(dot(centre, centre));
        nearest = gap / sqrt((u * u + v * v) / (frame->focal * frame->focal) + 1);
    }
    return (nearest > frame->near ? nearest : frame->near) * (1 - 1e-6);
}

iso_near_shape iso_near_sphere(const iso_shapes_frame *frame, const double centre[3], double radius,
                               uint32_t id) {
    iso_near_shape shape = {
        .radius = {radius, radius}, .nearest = nearest_of(frame, centre, radius), .id = id};
    for (int a = 0; a < 3; a++) shape.end[0][a] = shape.end[1][a] = centre[a];
    return shape;
}

iso_near_shape iso_near_tube(const iso_shapes_frame *frame, uint32_t id, int flags) {
    iso_near_shape shape = {.id = id, .flags = flags, .tube = true};
    double front = INFINITY;
    for (int end = 0; end < 2; end++) {
        const float *v = frame->shapes->vertices[id + (uint32_t)end];
        const double position[3] = {(double)v[0], (double)v[1], (double)v[2]};
        iso_shapes_to_view(frame, position, shape.end[end]);
        const double z = shape.end[end][2] > frame->near ? shape.end[end][2] : frame->near,
                     least = z * frame->least_slope + frame->least_fixed, radius = (double)v[3];
        shape.radius[end] = radius < least ? least : radius;
        if (radius < least) shape.flags |= ISO_TUBE_WIDENED;
        const double near = shape.end[end][2] - shape.radius[end];
        front = near < front ? near : front;
    }
    shape.nearest = (front > frame->near ? front : frame->near) * (1 - 1e-6);
    return shape;
}

/* ---- drawing */

static void draw_tile(iso_shapes_bin *bin, const iso_near_shape *shape, int x0, int y0, float *farthest) {
    float most = -INFINITY;
    for (int y = y0; y < y0 + ISO_SHAPES_TILE; y++)
        for (int x = x0; x < x0 + ISO_SHAPES_TILE; x++) {
            const size_t at = iso_shapes_pixel(bin, x, y);
            const ray r = ray_of(bin->frame, x, y);
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

void iso_near_draw(iso_shapes_bin *bin, const iso_near_shape *shape) {
    for (int row = 0; row < ISO_SHAPES_TILES; row++)
        for (int column = 0; column < ISO_SHAPES_TILES; column++) {
            float *farthest = &bin->farthest[row * ISO_SHAPES_TILE_PITCH + column];
            if (shape->nearest < (double)*farthest)
                draw_tile(bin, shape, bin->rect.x0 + column * ISO_SHAPES_TILE,
                          bin->rect.y0 + row * ISO_SHAPES_TILE, farthest);
        }
    ((iso_near_shape *)bin->near.data)[bin->near_count++] = *shape;
}

static void write_sample(iso_shapes_bin *bin, const iso_near_shape *shape, int x, int y) {
    const iso_target *target = bin->frame->target;
    iso_gbuffer *g = target->gbuffer;
    const ray r = ray_of(bin->frame, x, y);
    const size_t sample = (size_t)(y - bin->frame->top) * (size_t)g->width + (size_t)x;
    piece p;
    int end;
    if (!meet(bin->frame, shape, &r, &p, &end)) return;
    for (int a = 0; a < 3; a++) g->normal[a][sample] = (float)p.normal[end][a];
    g->depth[sample] = (float)p.t[end];
    g->surface[sample] = target->surface;
    iso_shapes_write_color(bin->frame, sample, shape->id, (float)p.along[end]);
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
