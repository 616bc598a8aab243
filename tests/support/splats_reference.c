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
                (disc){at, iso_affine_normal(&affine, n), radius * (double)ISO_GROUPS_DISC, i};
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
    const double thickness = d->radius / (double)ISO_GROUPS_DISC * (double)ISO_GROUPS_THICKNESS;
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

/* ---- translucent layers */

/* A fragment of a pixel's list. */
typedef struct listed {
    fragment f;
    const disc *from;
} listed;

static int compare_fragments(const void *left, const void *right) {
    const listed *a = left, *b = right;
    if (a->f.depth != b->f.depth) return a->f.depth < b->f.depth ? -1 : 1;
    return (a->from > b->from) - (a->from < b->from);
}

/* A layer: the mean of its discs. */
typedef struct merged {
    double depth, weight, share; /* share: of the surface's opacity */
    iso_vec3 normal;
    double color[3];
} merged;

static int compare_layers(const void *left, const void *right) {
    const merged *a = left, *b = right;
    return (a->depth > b->depth) - (a->depth < b->depth);
}

/* Adds a disc to a layer: colours count by the opacities of their points. */
static void merge(merged *layer, const listed *from, const iso_point_view *points) {
    const size_t point = from->from->point;
    const double w = exp(-3 * from->f.e), share = points->opacities ? w * points->opacities[point] / 255 : w;
    layer->weight += w;
    layer->share += share;
    layer->depth += w * from->f.depth;
    layer->normal = iso_vec3_add(layer->normal, iso_vec3_scale(from->from->normal, w));
    for (int k = 0; k < 3 && points->colors; k++) layer->color[k] += share * points->colors[point][k];
}

/* Merges the sorted fragments of one side into layers; returns how many. */
static size_t merge_side(const listed *list, size_t count, bool away, const iso_point_view *points,
                         merged *layers) {
    size_t made = 0;
    double front = 0;
    for (size_t i = 0; i < count; i++) {
        const double thickness =
            list[i].from->radius / (double)ISO_GROUPS_DISC * (double)ISO_GROUPS_THICKNESS;
        if (list[i].f.away != away) continue;
        if (made == 0 || list[i].f.depth > front + thickness) {
            front = list[i].f.depth;
            layers[made++] = (merged){0};
        }
        merge(&layers[made - 1], &list[i], points);
    }
    for (size_t i = 0; i < made; i++) {
        for (int k = 0; k < 3; k++) layers[i].color[k] /= layers[i].share > 0 ? layers[i].share : 1;
        layers[i].depth /= layers[i].weight;
        layers[i].share /= layers[i].weight;
    }
    return made;
}

/* Composites layers, sorted, over a colour. */
static void composite(const iso_view *view, const iso_splat_layer *input, const merged *layers, size_t count,
                      int x, int y, double color[3]) {
    const double u = (x + 0.5 - view->cx) / view->focal, v = (y + 0.5 - view->cy) / view->focal;
    const float to_eye[3] = {view->orthographic ? 0 : (float)-u, view->orthographic ? 0 : (float)-v, -1};
    const double length = sqrt((double)(to_eye[0] * to_eye[0] + to_eye[1] * to_eye[1] + 1));
    for (size_t i = count; i-- > 0;) { /* back to front */
        const iso_vec3 n = iso_vec3_unit(iso_view_vector(view, layers[i].normal));
        const float normal[3] = {(float)n.x, (float)n.y, (float)n.z};
        const double cosine =
            fabs(n.x * (double)to_eye[0] + n.y * (double)to_eye[1] + n.z * (double)to_eye[2]) / length;
        const double opacity = layers[i].share * (double)input->translucency.opacity;
        const double *c = layers[i].color;
        const iso_rgb own = {(uint8_t)(c[0] + 0.5), (uint8_t)(c[1] + 0.5), (uint8_t)(c[2] + 0.5)};
        const double a =
            input->translucency.constant ? opacity : 1 - pow(1 - opacity, 1 / fmax(cosine, 1e-6));
        float rgb[3];
        iso_shade_sample(normal, to_eye, input->points.colors ? own : input->color, rgb);
        for (int k = 0; k < 3; k++) color[k] = a * (double)rgb[k] + (1 - a) * color[k];
    }
}

/* All fragments of one pixel, by looking at every disc. */
static size_t list_pixel(const iso_view *view, const disc *discs, size_t count, int x, int y, listed *list) {
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        if (intersect(view, &discs[i], x, y, &list[found].f)) list[found++].from = &discs[i];
    qsort(list, found, sizeof *list, compare_fragments);
    return found;
}

void test_draw_sorted_layers(const iso_view *view, const iso_splat_layer *input, iso_rgb background,
                             iso_image *image) {
    size_t count;
    disc *discs = make_discs(view, &input->points, &count);
    listed *list = malloc((count + 1) * sizeof *list);
    merged *layers = malloc((count + 1) * sizeof *layers);
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            double color[3] = {background.r / 255.0, background.g / 255.0, background.b / 255.0};
            const size_t found = list_pixel(view, discs, count, x, y, list);
            size_t made = merge_side(list, found, false, &input->points, layers);
            made += merge_side(list, found, true, &input->points, layers + made);
            qsort(layers, made, sizeof *layers, compare_layers);
            composite(view, input, layers, made, x, y, color);
            uint8_t *to = image->rgba + 4 * ((size_t)y * (size_t)view->width + (size_t)x);
            for (int k = 0; k < 3; k++) to[k] = (uint8_t)(fmin(color[k], 1) * 255 + 0.5);
            to[3] = 255;
        }
    free(discs);
    free(list);
    free(layers);
}
