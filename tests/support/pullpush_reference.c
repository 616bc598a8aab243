/* pullpush_reference: projection of all points, then pull and push of whole levels, in double precision. */
#include "pullpush_reference.h"

#include <math.h>
#include <stdlib.h>

#include "render/project.h"

typedef struct cell {
    bool valid, hides; /* hides: another surface lies behind it */
    double n[3], depth, low, high;
    double x, y; /* the ellipse's centre, pixels of level 0 from the frame's corner */
    double radius, rgb[3];
} cell;

typedef struct level {
    int width, height;
    double size;
    cell *cells;
} level;

typedef struct work {
    const reference_opts *opts;
    const iso_view *view;
    level levels[16];
} work;

static level make_level(int width, int height, int number) {
    int step = 1 << number;
    level l = {(width + step - 1) / step, (height + step - 1) / step, step, NULL};
    l.cells = calloc((size_t)l.width * (size_t)l.height, sizeof *l.cells);
    if (!l.cells) abort();
    return l;
}

static cell *cell_at(const level *l, int x, int y) {
    if (x < 0 || y < 0 || x >= l->width || y >= l->height) return NULL;
    return &l->cells[(size_t)y * (size_t)l->width + (size_t)x];
}

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- projection */

/* Transforms a normal to view space. Its length is that of the index space normal with |x| + |y| + |z| = 1,
 * which affects weights only slightly. */
static void turn_normal(const iso_projector *projector, const float normal[3], double out[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += fabs((double)normal[k]);
    for (int row = 0; row < 3; row++) {
        out[row] = 0;
        for (int k = 0; k < 3; k++)
            out[row] += (double)projector->normal[3 * row + k] * (double)normal[k] / sum;
    }
}

static void project(work *w, const iso_point_view *points) {
    const iso_view *view = w->view;
    iso_affine affine = iso_transform_affine(&points->transform);
    iso_projector projector = iso_projector_make(view, &points->transform);
    level *base = &w->levels[w->opts->base];
    for (size_t s = 0; s < points->span_count; s++)
        for (uint32_t i = 0; i < points->spans[s].count; i++) {
            const iso_point_span *span = &points->spans[s];
            size_t number = span->first + i;
            iso_surfel surfel = iso_point_view_get(points, number);
            iso_vec3 index = iso_vec3_make(16.0 * span->brick[0] + surfel.position[0],
                                           16.0 * span->brick[1] + surfel.position[1],
                                           16.0 * span->brick[2] + surfel.position[2]);
            iso_vec3 at = iso_view_point(view, iso_affine_point(&affine, index));
            double n[3];
            turn_normal(&projector, surfel.normal, n);
            if (!(at.z >= view->near)) continue;
            iso_vec3 ray = view->orthographic ? iso_vec3_make(0, 0, 1) : at;
            if (w->opts->cull && n[0] * ray.x + n[1] * ray.y + n[2] * ray.z >= 0) continue;
            double scale = view->orthographic ? view->focal : view->focal / at.z;
            double x = at.x * scale + view->cx + w->opts->guard, y = at.y * scale + view->cy + w->opts->guard;
            cell *c = cell_at(base, (int)floor(x / base->size), (int)floor(y / base->size));
            if (!c || (c->valid && c->depth <= at.z)) continue;
            x = (floor(x / base->size * 32) + 0.5) / 32 * base->size;
            y = (floor(y / base->size * 32) + 0.5) / 32 * base->size;
            double radius = points->radii ? (double)points->radii[number] : points->radius;
            *c = (cell){.valid = true, .n = {n[0], n[1], n[2]}, .depth = at.z, .low = at.z, .x = x, .y = y};
            c->radius = w->opts->disc_radii * radius;
            c->high = at.z + c->radius;
            for (int k = 0; points->colors && k < 3; k++) c->rgb[k] = points->colors[number][k];
        }
}

/* ---- weights and pixels */

typedef struct share {
    const cell *from;
    double weight;
} share;

/* Whether `c` belongs to the same surface as the frontmost cell. */
static bool joins(const work *w, const cell *c, const cell *front) {
    return c->low <= front->high && (w->opts->cull || dot3(c->n, front->n) >= 0);
}

static cell mix(const work *w, const share *shares, int count) {
    const cell *front = NULL;
    for (int i = 0; i < count; i++)
        if (!front || shares[i].from->low < front->low) front = shares[i].from;
    cell sum = {.valid = true, .low = INFINITY, .high = -INFINITY};
    double total = 0;
    for (int i = 0; i < count; i++) {
        const cell *c = shares[i].from;
        double weight = shares[i].weight;
        if (!joins(w, c, front)) continue;
        sum.hides = sum.hides || c->hides;
        total += weight;
        for (int k = 0; k < 3; k++) sum.n[k] += weight * c->n[k];
        for (int k = 0; k < 3; k++) sum.rgb[k] += weight * c->rgb[k];
        sum.depth += weight * c->depth;
        sum.radius += weight * c->radius;
        sum.x += weight * c->x;
        sum.y += weight * c->y;
        sum.low = fmin(sum.low, c->low);
        sum.high = fmax(sum.high, c->high);
    }
    for (int k = 0; k < 3; k++) sum.n[k] /= total;
    for (int k = 0; k < 3; k++) sum.rgb[k] /= total;
    sum.depth /= total;
    sum.radius /= total;
    sum.x /= total;
    sum.y /= total;
    return sum;
}

static void pull(work *w, int number) {
    const level *fine = &w->levels[number - 1];
    level *coarse = &w->levels[number];
    for (int y = 0; y < coarse->height; y++)
        for (int x = 0; x < coarse->width; x++) {
            share shares[4];
            int count = 0;
            for (int k = 0; k < 4; k++) {
                const cell *c = cell_at(fine, 2 * x + (k & 1), 2 * y + (k >> 1));
                if (c && c->valid) shares[count++] = (share){c, 1};
            }
            if (!count) continue;
            cell made = mix(w, shares, count), front = made;
            for (int i = 0; i < count; i++)
                if (shares[i].from->low == made.low) front = *shares[i].from;
            for (int i = 0; i < count; i++)
                if (!joins(w, shares[i].from, &front)) made.hides = true;
            *cell_at(coarse, x, y) = made;
        }
}

/* The quadratic form q at (x, y) of the ellipse of a coarser pixel (cx, cy) of level `number`: the projection
 * of its disc along the ray to the pixel's centre; infinite where that is too far away for a disc seen
 * edge-on. */
static double ellipse(const work *w, const cell *c, int number, int cx, int cy, double x, double y) {
    const iso_view *view = w->view;
    double size = w->levels[number].size, n[3] = {c->n[0], c->n[1], c->n[2]}, ray[3] = {0, 0, 1};
    if (!view->orthographic) {
        ray[0] = ((cx + 0.5) * size - w->opts->guard - view->cx) / view->focal;
        ray[1] = ((cy + 0.5) * size - w->opts->guard - view->cy) / view->focal;
    }
    double length = sqrt(dot3(ray, ray)), normal = sqrt(dot3(n, n));
    for (int k = 0; k < 3; k++) {
        ray[k] /= length;
        n[k] /= normal;
    }
    /* rotates so that the ray becomes (0, 0, 1) */
    double along = dot3(n, ray), turn = (along + n[2]) / (1 + ray[2]);
    double m[2] = {n[0] - ray[0] * turn, n[1] - ray[1] * turn};
    double radius = c->radius * view->focal / (view->orthographic ? 1 : c->depth), square = radius * radius;
    double xx = square * (1 - m[0] * m[0]) + w->opts->low_pass, xy = -square * m[0] * m[1],
           yy = square * (1 - m[1] * m[1]) + w->opts->low_pass;
    double dx = x - c->x, dy = y - c->y, out = dx * m[0] + dy * m[1], flat = m[0] * m[0] + m[1] * m[1];
    double reach =
        (square + w->opts->facing) * along * along + (c->hides ? w->opts->facing : w->opts->edge) * flat;
    if (out * along < 0 && out * out > flat * reach) return INFINITY;
    return (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy);
}

/* Whether the disc of a point of level 0 does not cover its pixel's centre (x + 0.5, y + 0.5): by the same
 * rule, but along the ray to that centre. */
static bool is_beyond(const work *w, const cell *c, int x, int y) {
    const iso_view *view = w->view;
    double ray[3] = {0, 0, 1}, normal = sqrt(dot3(c->n, c->n)), scale = view->focal;
    if (!view->orthographic) {
        ray[0] = (x + 0.5 - w->opts->guard - view->cx) / view->focal;
        ray[1] = (y + 0.5 - w->opts->guard - view->cy) / view->focal;
        scale /= c->depth;
    }
    double along = dot3(c->n, ray) / normal / sqrt(dot3(ray, ray)), radius = c->radius * scale;
    double out = ((x + 0.5 - c->x) * c->n[0] + (y + 0.5 - c->y) * c->n[1]) / normal;
    return out * along < 0 && out * out > (radius * radius + w->opts->facing) * along * along + w->opts->edge;
}

static void push(work *w, int number) {
    level *fine = &w->levels[number], *coarse = &w->levels[number + 1];
    for (int y = 0; y < fine->height; y++)
        for (int x = 0; x < fine->width; x++) {
            share shares[4];
            const cell *front = NULL;
            int count = 0;
            for (int k = 0; k < 4; k++) {
                int cx = ((x - 1) >> 1) + (k & 1), cy = ((y - 1) >> 1) + (k >> 1);
                const cell *c = cell_at(coarse, cx, cy);
                if (!c || !c->valid) continue;
                double q = ellipse(w, c, number + 1, cx, cy, (x + 0.5) * fine->size, (y + 0.5) * fine->size);
                if (!(q < 1)) continue;
                if (!front || c->low < front->low) front = c;
                shares[count++] = (share){c, w->opts->box ? 1 : exp(-2 * q)};
            }
            cell *own = cell_at(fine, x, y);
            if (number == 0 && !count && own->valid && is_beyond(w, own, x, y)) own->valid = false;
            if (!count || (own->valid && own->low <= front->high)) continue;
            *own = mix(w, shares, count);
        }
}

static void resolve_picture(const work *w, const iso_point_view *points, iso_gbuffer *gbuffer) {
    for (int y = 0; y < gbuffer->height; y++)
        for (int x = 0; x < gbuffer->width; x++) {
            const cell *c = cell_at(&w->levels[0], x + w->opts->guard, y + w->opts->guard);
            size_t at = (size_t)y * (size_t)gbuffer->width + (size_t)x;
            if (!c->valid) continue;
            double length = sqrt(dot3(c->n, c->n));
            gbuffer->depth[at] = (float)c->depth;
            gbuffer->surface[at] = 0;
            for (int k = 0; k < 3; k++) gbuffer->normal[k][at] = (float)(c->n[k] / length);
            if (points->colors)
                gbuffer->color[at] = 1u << 24 | (uint32_t)lrint(c->rgb[2]) << 16 |
                                     (uint32_t)lrint(c->rgb[1]) << 8 | (uint32_t)lrint(c->rgb[0]);
        }
}

void reference_pullpush(const reference_opts *opts, const iso_view *view, const iso_point_view *points,
                        iso_gbuffer *gbuffer) {
    work w = {.opts = opts, .view = view};
    for (int l = 0; l <= opts->top; l++)
        w.levels[l] = make_level(view->width + 2 * opts->guard, view->height + 2 * opts->guard, l);
    project(&w, points);
    for (int l = opts->base + 1; l <= opts->top; l++) pull(&w, l);
    for (int l = opts->top - 1; l >= 0; l--) push(&w, l);
    resolve_picture(&w, points, gbuffer);
    for (int l = 0; l <= opts->top; l++) free(w.levels[l].cells);
}
