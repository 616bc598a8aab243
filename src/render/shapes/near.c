/* near: the interval of a ray inside a shape, in double precision. A shape that the near plane cuts is seen
 * from inside. */
#include "render/shapes/near.h"

#include <math.h>

#include "render/shapes/kernel.h"

/* A ray: origin + s * direction, s the depth. */
typedef struct ray {
    double origin[3], direction[3];
} ray;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static ray ray_of(const iso_shapes_frame *frame, int x, int y) {
    const double u = (x + 0.5 - frame->cx) / frame->focal, v = (y + 0.5 - frame->cy) / frame->focal;
    if (frame->parallel) return (ray){{u, v, 0}, {0, 0, 1}};
    return (ray){{0, 0, 0}, {u, v, 1}};
}

/* The depths at which the ray enters and leaves a sphere. */
static bool sphere_interval(const ray *r, const double centre[3], double radius, double span[2]) {
    const double dd = dot(r->direction, r->direction);
    const double to[3] = {centre[0] - r->origin[0], centre[1] - r->origin[1], centre[2] - r->origin[2]};
    const double along = dot(to, r->direction) / dd;
    double off[3]; /* from the centre to the ray: its square does not cancel */
    for (int a = 0; a < 3; a++) off[a] = along * r->direction[a] - to[a];
    const double rest = radius * radius - dot(off, off);
    if (!(rest >= 0)) return false;
    const double half = sqrt(rest / dd);
    span[0] = along - half;
    span[1] = along + half;
    return true;
}

/* The first depth at or behind the near plane where the ray meets the shape's surface. */
static bool meet(const iso_shapes_frame *frame, const iso_near_shape *shape, const ray *r, double *depth) {
    double span[2];
    if (!sphere_interval(r, shape->centre, shape->radius, span) || !(span[1] >= frame->near)) return false;
    *depth = span[0] >= frame->near ? span[0] : span[1];
    return true;
}

iso_near_shape iso_near_sphere(const iso_shapes_frame *frame, const double centre[3], double radius,
                               uint32_t id) {
    iso_near_shape shape = {{centre[0], centre[1], centre[2]}, radius, id, centre[2] - radius};
    const iso_gbuffer *g = frame->target->gbuffer;
    if (!frame->parallel && dot(centre, centre) < radius * radius) {
        /* The eye is inside: the surface is at least `gap` away from it, in any direction. */
        const double u = fabs(frame->cx) + g->width, v = fabs(frame->cy - frame->top) + g->height,
                     gap = radius - sqrt(dot(centre, centre));
        shape.nearest = gap / sqrt((u * u + v * v) / (frame->focal * frame->focal) + 1);
    }
    if (!(shape.nearest > frame->near)) shape.nearest = frame->near;
    return shape;
}

static void draw_tile(iso_shapes_bin *bin, size_t index, int x0, int y0, float *farthest) {
    const iso_near_shape *shape = (const iso_near_shape *)bin->near.data + index;
    float most = -INFINITY;
    for (int y = y0; y < y0 + ISO_SHAPES_TILE; y++)
        for (int x = x0; x < x0 + ISO_SHAPES_TILE; x++) {
            const size_t at = iso_shapes_pixel(bin, x, y);
            const ray r = ray_of(bin->frame, x, y);
            double depth;
            if (bin->depth[at] > -INFINITY && meet(bin->frame, shape, &r, &depth) &&
                (float)depth < bin->depth[at]) {
                bin->depth[at] = (float)depth;
                bin->record[at] = -2 - (int32_t)index;
            }
            if (bin->depth[at] > most) most = bin->depth[at];
        }
    *farthest = most;
}

void iso_near_draw(iso_shapes_bin *bin, size_t index) {
    const iso_near_shape *shape = (const iso_near_shape *)bin->near.data + index;
    for (int row = 0; row < ISO_SHAPES_TILES; row++)
        for (int column = 0; column < ISO_SHAPES_TILES; column++) {
            float *farthest = &bin->farthest[row * ISO_SHAPES_TILE_PITCH + column];
            if (shape->nearest * (1 - 1e-6) < (double)*farthest)
                draw_tile(bin, index, bin->rect.x0 + column * ISO_SHAPES_TILE,
                          bin->rect.y0 + row * ISO_SHAPES_TILE, farthest);
        }
}

static void write_sample(const iso_shapes_bin *bin, const iso_near_shape *shape, int x, int y) {
    const iso_target *target = bin->frame->target;
    iso_gbuffer *g = target->gbuffer;
    const ray r = ray_of(bin->frame, x, y);
    const size_t sample = (size_t)(y - bin->frame->top) * (size_t)g->width + (size_t)x;
    double depth;
    if (!meet(bin->frame, shape, &r, &depth)) return;
    for (int a = 0; a < 3; a++)
        g->normal[a][sample] =
            (float)((r.origin[a] + depth * r.direction[a] - shape->centre[a]) / shape->radius);
    g->depth[sample] = (float)depth;
    g->surface[sample] = target->surface;
    iso_shapes_write_color(bin->frame, sample, shape->id);
}

void iso_near_resolve(const iso_shapes_bin *bin) {
    if (!bin->near_count) return;
    for (int y = bin->rect.y0; y <= bin->rect.y1; y++)
        for (int x = bin->rect.x0; x <= bin->rect.x1; x++) {
            const int32_t record = bin->record[iso_shapes_pixel(bin, x, y)];
            if (record < ISO_SHAPES_NONE)
                write_sample(bin, (const iso_near_shape *)bin->near.data + (-2 - record), x, y);
        }
}
