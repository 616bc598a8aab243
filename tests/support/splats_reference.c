/* splats_reference: intersects rays with discs in world coordinates, all discs that can be near the pixel. */
#include "splats_reference.h"

#include <math.h>
#include <stdlib.h>

#include "base/geometry.h"

typedef struct disc {
    iso_vec3 at, normal; /* world; the normal is unit */
    double radius;
    size_t point;
} disc;

typedef struct fragment {
    double depth, e;
    bool away;
} fragment;

/* What a pixel has collected. */
typedef struct pixel {
    double front, weight, depth, color[3];
    iso_vec3 normal;
    bool away;
} pixel;

static disc *make_discs(const iso_view *view, const iso_point_view *points, size_t *count) {
    const iso_affine affine = iso_transform_affine(&points->transform);
    disc *discs = malloc((iso_point_view_count(points) + 1) * sizeof *discs);
    *count = 0;
    for (size_t s = 0; s < points->span_count; s++)
        for (size_t i = points->spans[s].first; i < points->spans[s].first + points->spans[s].count; i++) {
            const iso_surfel surfel = iso_point_view_get(points, i);
            const double radius = points->radii ? (double)points->radii[i] : points->radius;
            const iso_vec3 index = iso_brick_position(points->spans[s].brick, surfel.position),
                           at = iso_affine_point(&affine, index);
            if (!iso_vec3_is_finite(at) || !(radius > 0) || iso_view_point(view, at).z < view->near) continue;
            const iso_vec3 n = iso_vec3_make(surfel.normal[0], surfel.normal[1], surfel.normal[2]);
            discs[(*count)++] =
                (disc){at, iso_affine_normal(&affine, n), radius * (double)ISO_SPLATS_DISC, i};
        }
    return discs;
}

static bool intersect(const iso_view *view, const disc *d, int x, int y, fragment *f) {
    iso_vec3 origin, direction;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    const iso_vec3 center = iso_view_point(view, d->at);
    const double scale = view->orthographic ? view->focal : view->focal / center.z,
                 dx = x + 0.5 - view->cx - center.x * scale, dy = y + 0.5 - view->cy - center.y * scale,
                 low = (dx * dx + dy * dy) / 0.5, facing = iso_vec3_dot(d->normal, direction),
                 t = iso_vec3_dot(d->normal, iso_vec3_sub(d->at, origin)) / facing;
    const iso_vec3 hit = iso_vec3_add(origin, iso_vec3_scale(direction, t)), q = iso_vec3_sub(hit, d->at);
    const double exact = iso_vec3_dot(q, q) / (d->radius * d->radius);
    const bool on_disc = exact < low && t >= view->near;
    f->away = facing > 0;
    f->e = on_disc ? exact : low;
    f->depth = on_disc ? t : fmax(fmin(t, center.z + d->radius), center.z - d->radius);
    f->depth = fmax(f->depth, view->near);
    return f->e < 1;
}

/* Pixels around the disc's centre that it can cover, along one axis; all of them when it is near the eye. */
static void range(const iso_view *view, const disc *d, int axis, int *first, int *last) {
    const iso_vec3 c = iso_view_point(view, d->at);
    const double at = axis ? c.y : c.x, middle = axis ? view->cy : view->cx, r = d->radius;
    const int size = axis ? view->height : view->width;
    *first = 0;
    *last = size - 1;
    if (!view->orthographic && c.z < 1.5 * r) return;
    const double lo = view->orthographic ? at - r : fmin((at - r) / (c.z - r), (at - r) / (c.z + r)),
                 hi = view->orthographic ? at + r : fmax((at + r) / (c.z - r), (at + r) / (c.z + r));
    *first = (int)fmax(0, fmin(size, floor(lo * view->focal + middle) - 2));
    *last = (int)fmin(size - 1, fmax(-1, ceil(hi * view->focal + middle) + 2));
}

typedef void visit(pixel *p, const disc *d, const fragment *f, const iso_point_view *points);

static void each_fragment(const iso_view *view, const iso_point_view *points, const disc *discs, size_t count,
                          pixel *pixels, visit *visitor) {
    for (size_t i = 0; i < count; i++) {
        int first[2], last[2];
        fragment f;
        for (int axis = 0; axis < 2; axis++) range(view, &discs[i], axis, &first[axis], &last[axis]);
        for (int y = first[1]; y <= last[1]; y++)
            for (int x = first[0]; x <= last[0]; x++)
                if (intersect(view, &discs[i], x, y, &f))
                    visitor(&pixels[(size_t)y * (size_t)view->width + (size_t)x], &discs[i], &f, points);
    }
}

static void find_front(pixel *p, const disc *d, const fragment *f, const iso_point_view *points) {
    (void)d, (void)points;
    if (!(f->depth < p->front)) return;
    p->front = f->depth;
    p->away = f->away;
}

static void add(pixel *p, const disc *d, const fragment *f, const iso_point_view *points) {
    const double thickness = d->radius / (double)ISO_SPLATS_DISC * (double)ISO_SPLATS_THICKNESS;
    if (f->away != p->away || f->depth > p->front + thickness) return;
    const double w = exp(-3 * f->e);
    p->weight += w;
    p->depth += w * f->depth;
    p->normal = iso_vec3_add(p->normal, iso_vec3_scale(d->normal, w));
    for (int k = 0; k < 3 && points->colors; k++) p->color[k] += w * points->colors[d->point][k];
}

static void write(const iso_view *view, const iso_point_view *points, const pixel *p, iso_gbuffer *g,
                  size_t at) {
    if (!(p->weight > 0)) return;
    const iso_vec3 n = iso_vec3_unit(iso_view_vector(view, p->normal));
    g->depth[at] = (float)(p->depth / p->weight);
    g->surface[at] = 0;
    g->normal[0][at] = (float)n.x;
    g->normal[1][at] = (float)n.y;
    g->normal[2][at] = (float)n.z;
    if (!points->colors) return;
    g->color[at] = 1u << 24;
    for (int k = 0; k < 3; k++) g->color[at] |= (uint32_t)(p->color[k] / p->weight + 0.5) << 8 * k;
}

void test_draw_two_passes(const iso_view *view, const iso_point_view *points, iso_gbuffer *gbuffer) {
    const size_t samples = (size_t)view->width * (size_t)view->height;
    size_t count;
    disc *discs = make_discs(view, points, &count);
    pixel *pixels = calloc(samples, sizeof *pixels);
    for (size_t i = 0; i < samples; i++) pixels[i].front = INFINITY;
    each_fragment(view, points, discs, count, pixels, find_front);
    each_fragment(view, points, discs, count, pixels, add);
    for (size_t i = 0; i < samples; i++) write(view, points, &pixels[i], gbuffer, i);
    free(discs);
    free(pixels);
}
