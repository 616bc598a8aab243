/* pullpush_reference: projection of all points, then pull and push of whole levels, in double precision. */
#include "pullpush_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/view/project.h"

typedef struct cell {
    bool valid, weak; /* weak: made by push though no ellipse contains its centre, beside an outline */
    double n[3], depth;
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
    iso_projector projector;
    const int32_t *dims;      /* of the points' grid */
    level levels[16], points; /* points: the base level before push */
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
            *c = (cell){.valid = true, .n = {n[0], n[1], n[2]}, .depth = at.z, .x = x, .y = y};
            c->radius = w->opts->disc_radii * radius;
            for (int k = 0; points->colors && k < 3; k++) c->rgb[k] = points->colors[number][k];
        }
}

/* ---- weights and pixels */

typedef struct share {
    const cell *from;
    double weight, depth; /* depth: of the cell's disc where it is mixed, mm */
} share;

/* Whether a share belongs to the same surface as the one at the front, which lies farthest with `back`. */
static bool joins(const work *w, const share *s, const share *front, bool back) {
    const double behind = back ? front->depth - s->depth : s->depth - front->depth;
    return behind <= front->from->radius && (w->opts->cull || dot3(s->from->n, front->from->n) >= 0);
}

static const share *front_of(const share *shares, int count, bool back) {
    const share *front = NULL;
    for (int i = 0; i < count; i++)
        if (!front || (back ? shares[i].depth > front->depth : shares[i].depth < front->depth))
            front = &shares[i];
    return front;
}

static cell mix(const work *w, const share *shares, int count, bool back) {
    const share *front = front_of(shares, count, back);
    cell sum = {.valid = true};
    double total = 0;
    for (int i = 0; i < count; i++) {
        const cell *c = shares[i].from;
        double weight = shares[i].weight;
        if (!joins(w, &shares[i], front, back)) continue;
        total += weight;
        for (int k = 0; k < 3; k++) sum.n[k] += weight * c->n[k];
        for (int k = 0; k < 3; k++) sum.rgb[k] += weight * c->rgb[k];
        sum.depth += weight * c->depth;
        sum.radius += weight * c->radius;
        sum.x += weight * c->x;
        sum.y += weight * c->y;
    }
    for (int k = 0; k < 3; k++) sum.n[k] /= total;
    for (int k = 0; k < 3; k++) sum.rgb[k] /= total;
    sum.depth /= total;
    sum.radius /= total;
    sum.x /= total;
    sum.y /= total;
    return sum;
}

/* ---- ellipses */

/* The ellipse of a disc in the picture: the matrix of d'M^-1 d, pixels of level 0, its unit normal m seen
 * along a ray, and the depth that its plane gains per pixel along m. */
typedef struct ellipse {
    double xx, xy, yy, m[2], along, square, rise;
} ellipse;

static ellipse ellipse_of(const work *w, const cell *c, const double ray[3], double low_pass) {
    const iso_view *view = w->view;
    double n[3] = {c->n[0], c->n[1], c->n[2]}, length = sqrt(dot3(ray, ray)), normal = sqrt(dot3(n, n));
    for (int k = 0; k < 3; k++) n[k] /= normal;
    /* rotates so that the ray becomes (0, 0, 1) */
    double along = dot3(n, ray) / length, turn = (along + n[2]) / (1 + ray[2] / length) / length;
    ellipse e = {.m = {n[0] - ray[0] * turn, n[1] - ray[1] * turn}, .along = along};
    double radius = c->radius * view->focal / (view->orthographic ? 1 : c->depth);
    e.square = radius * radius;
    e.xx = e.square * (1 - e.m[0] * e.m[0]) + low_pass;
    e.xy = -e.square * e.m[0] * e.m[1];
    e.yy = e.square * (1 - e.m[1] * e.m[1]) + low_pass;
    /* at the edge of the ellipse without a filter the depth differs from the centre's by radius * |m| */
    double a = e.square + low_pass, flat = e.m[0] * e.m[0] + e.m[1] * e.m[1];
    double thin = sqrt(e.square / (a * (a - e.square * flat)));
    e.rise = c->radius * thin * (along < 0 ? 1 : -1);
    return e;
}

/* The ray through a pixel of a level. */
static void ray_of(const work *w, double size, double x, double y, double ray[3]) {
    const iso_view *view = w->view;
    ray[0] = view->orthographic ? 0 : ((x + 0.5) * size - w->opts->guard - view->cx) / view->focal;
    ray[1] = view->orthographic ? 0 : ((y + 0.5) * size - w->opts->guard - view->cy) / view->focal;
    ray[2] = 1;
}

static double form(const ellipse *e, double dx, double dy) {
    return (e->yy * dx * dx - 2 * e->xy * dx * dy + e->xx * dy * dy) / (e->xx * e->yy - e->xy * e->xy);
}

/* Whether the surface ends before the point of a pixel's ray at this depth: beyond the grid's border by more
 * than 0.005 voxels and 0.02 pixels. */
static bool is_beyond_grid(const work *w, double x, double y, double depth) {
    const iso_view *view = w->view;
    if (w->dims[0] <= 0 || w->dims[1] <= 0 || w->dims[2] <= 0) return false;
    double scale = view->orthographic ? 1 / view->focal : depth / view->focal;
    double at[3] = {(x - w->opts->guard - view->cx) * scale, (y - w->opts->guard - view->cy) * scale, depth};
    for (int k = 0; k < 3; k++) {
        double index = 0, square = 0;
        for (int row = 0; row < 3; row++) {
            const double n = (double)w->projector.normal[3 * row + k];
            index += n * (at[row] - w->projector.origin[row]);
            square += n * n;
        }
        const double rounded = 0.005 + 0.02 * scale * sqrt(square);
        if (index < -rounded || index > w->dims[k] - 1 + rounded) return true;
    }
    return false;
}

/* ---- pull */

/* The ellipse test of pull: level 0 is averaged without it. Ellipses are seen along the view's axis, and
 * widened by half a coarser pixel. */
static void pull(work *w, int number) {
    const level *fine = &w->levels[number - 1];
    level *coarse = &w->levels[number];
    const double axis[3] = {0, 0, 1};
    for (int y = 0; y < coarse->height; y++)
        for (int x = 0; x < coarse->width; x++) {
            share shares[4];
            bool contains[4], any = false;
            int count = 0, left = 0;
            for (int k = 0; k < 4; k++) {
                const cell *c = cell_at(fine, 2 * x + (k & 1), 2 * y + (k >> 1));
                if (!c || !c->valid) continue;
                contains[count] = false;
                shares[count] = (share){c, 1, c->depth};
                if (number > 1) {
                    ellipse e =
                        ellipse_of(w, c, axis, w->opts->low_pass + 0.25 * coarse->size * coarse->size);
                    double dx = (x + 0.5) * coarse->size - c->x, dy = (y + 0.5) * coarse->size - c->y;
                    contains[count] = form(&e, dx, dy) < 1;
                    shares[count].depth +=
                        (c->n[2] < 0 ? fabs(e.rise) : -fabs(e.rise)) * (dx * e.m[0] + dy * e.m[1]);
                }
                count++;
            }
            if (!count) continue;
            const share front = *front_of(shares, count, false);
            for (int i = 0; i < count; i++) any |= joins(w, &shares[i], &front, false) && contains[i];
            for (int i = 0; i < count; i++)
                if (joins(w, &shares[i], &front, false) && (!any || contains[i])) {
                    shares[left] = shares[i];
                    shares[left++].depth = front.depth; /* all join */
                }
            *cell_at(coarse, x, y) = mix(w, shares, left, false);
        }
}

/* ---- push */

/* Whether the disc of a point of level 0 does not cover its pixel's centre (x + 0.5, y + 0.5): by the same
 * rule, but along the ray to that centre. */
static bool is_beyond(const work *w, const cell *c, int x, int y) {
    const iso_view *view = w->view;
    double ray[3], normal = sqrt(dot3(c->n, c->n)), scale = view->focal;
    ray_of(w, 1, x, y, ray);
    if (!view->orthographic) scale /= c->depth;
    double along = dot3(c->n, ray) / normal / sqrt(dot3(ray, ray)), radius = c->radius * scale;
    double out = ((x + 0.5 - c->x) * c->n[0] + (y + 0.5 - c->y) * c->n[1]) / normal;
    double gain = -out / scale / (along * sqrt(dot3(ray, ray)));
    return (out * along < 0 &&
            out * out > (radius * radius + w->opts->facing) * along * along + w->opts->edge) ||
           is_beyond_grid(w, x + 0.5, y + 0.5, c->depth + fmax(-c->radius, fmin(c->radius, gain)));
}

/* Gaussian weights fall to nothing at the edge: the library's cubic for exp(-2q) - exp(-2), 1 at q = 0. */
static double weight_of(const work *w, double q) {
    return w->opts->box ? 1 : fmax(1 + q * (-2.2440141 + q * (1.8788016 - q * 0.6347875)), 1e-5);
}

/* Whether an offset from an ellipse's centre lies beyond its disc, on the side of the silhouette. */
static bool is_outside(const work *w, const ellipse *e, double dx, double dy) {
    const double out = dx * e->m[0] + dy * e->m[1], flat = e->m[0] * e->m[0] + e->m[1] * e->m[1];
    const double reach = (e->square + w->opts->facing) * e->along * e->along + w->opts->edge * flat;
    return out * e->along < 0 && out * out > flat * reach;
}

/* The corners around a finer pixel whose ellipses contain its centre. Otherwise, with `widened`, those whose
 * ellipses do when they are half a coarser pixel wider; all of them grow, and become rounder, when all
 * corners are there. */
static int find_corners(const work *w, int number, int x, int y, bool widened, bool around, share shares[4]) {
    const level *fine = &w->levels[number], *coarse = &w->levels[number + 1];
    const double at_x = (x + 0.5) * fine->size, at_y = (y + 0.5) * fine->size;
    int count = 0;
    for (int k = 0; k < 4; k++) {
        int cx = ((x - 1) >> 1) + (k & 1), cy = ((y - 1) >> 1) + (k >> 1);
        const cell *c = cell_at(coarse, cx, cy);
        double ray[3];
        if (!c || !c->valid) continue;
        ray_of(w, coarse->size, cx, cy, ray);
        ellipse e = ellipse_of(w, c, ray, w->opts->low_pass), wide = e;
        double dx = at_x - c->x, dy = at_y - c->y, out = dx * e.m[0] + dy * e.m[1];
        wide.xx += 0.25 * coarse->size * coarse->size;
        wide.yy += 0.25 * coarse->size * coarse->size;
        const double flat = e.m[0] * e.m[0] + e.m[1] * e.m[1];
        const double round = around && flat > 0 ? 0.05 * (e.square + w->opts->low_pass) / flat : 0;
        wide.xx += round * e.m[0] * e.m[0];
        wide.xy += round * e.m[0] * e.m[1];
        wide.yy += round * e.m[1] * e.m[1];
        double q = form(widened ? &wide : &e, dx, dy) / (widened && around ? 1.4 * 1.4 : 1);
        double depth = c->depth + e.rise * out;
        if (!(q < 1) || (!widened && is_outside(w, &e, dx, dy))) continue;
        if ((!widened || number == 0) && is_beyond_grid(w, at_x, at_y, depth)) continue;
        shares[count++] = (share){c, weight_of(w, q), depth};
    }
    return count;
}

static bool is_around(const work *w, int number, int x, int y) {
    for (int k = 0; k < 4; k++) {
        const cell *c = cell_at(&w->levels[number + 1], ((x - 1) >> 1) + (k & 1), ((y - 1) >> 1) + (k >> 1));
        if (!c || !c->valid || c->weak) return false;
    }
    return true;
}

/* Whether the ellipse of a point, of 1.1 times its disc, contains the centre of pixel (x, y) of level 0, or
 * discs there, of a radius (mm) at a depth, are so small that this is not asked. */
static bool is_supported(const work *w, int x, int y, double radius, double depth) {
    const iso_view *view = w->view;
    const level *points = &w->points;
    const double at_x = x + 0.5, at_y = y + 0.5;
    const double widest = 1.1 * radius * view->focal / (view->orthographic ? 1 : depth);
    double ray[3];
    if (widest < 1) return true;
    const double reach = fmin(sqrt(widest * widest + w->opts->low_pass), 16 * points->size);
    ray_of(w, 1, x, y, ray);
    for (int row = (int)floor((at_y - reach) / points->size); row <= floor((at_y + reach) / points->size);
         row++)
        for (int i = (int)floor((at_x - reach) / points->size); i <= floor((at_x + reach) / points->size);
             i++) {
            const cell *c = cell_at(points, i, row);
            if (!c || !c->valid) continue;
            cell grown = *c;
            grown.radius *= 1.1;
            const ellipse e = ellipse_of(w, &grown, ray, w->opts->low_pass);
            const double dx = at_x - c->x, dy = at_y - c->y;
            if (form(&e, dx, dy) < 1 && !is_outside(w, &e, dx, dy) &&
                !is_beyond_grid(w, at_x, at_y, c->depth + e.rise * (dx * e.m[0] + dy * e.m[1])))
                return true;
        }
    return false;
}

/* The same of a gap with corners all around. */
static bool is_gap_supported(const work *w, int x, int y) {
    double nearest = INFINITY, widest = 0;
    for (int k = 0; k < 4; k++) {
        const cell *c = cell_at(&w->levels[1], ((x - 1) >> 1) + (k & 1), ((y - 1) >> 1) + (k >> 1));
        nearest = fmin(nearest, c->depth);
        widest = fmax(widest, c->radius);
    }
    return is_supported(w, x, y, widest, nearest);
}

/* Gives a pixel of level 0 without a value the nearest of the points whose discs, of 0.7 times their radii,
 * its ray meets. Points are looked for where discs of the coarser pixels around it have a radius of a
 * pixel. */
static void fill_rim(const work *w, int x, int y, cell *own) {
    const iso_view *view = w->view;
    const level *points = &w->points;
    const double at_x = x + 0.5, at_y = y + 0.5;
    double nearest = INFINITY, widest = 0, ray[3], depth = INFINITY;
    for (int k = 0; k < 4; k++) {
        const cell *c = cell_at(&w->levels[1], ((x - 1) >> 1) + (k & 1), ((y - 1) >> 1) + (k >> 1));
        if (!c || !c->valid) continue;
        nearest = fmin(nearest, c->depth);
        widest = fmax(widest, c->radius);
    }
    const double radius = widest * view->focal / (view->orthographic ? 1 : nearest),
                 reach = fmin(0.7 * radius, 6 * points->size);
    if (!(radius >= 1)) return;
    ray_of(w, 1, x, y, ray);
    for (int row = (int)floor((at_y - reach) / points->size); row <= floor((at_y + reach) / points->size);
         row++)
        for (int i = (int)floor((at_x - reach) / points->size); i <= floor((at_x + reach) / points->size);
             i++) {
            const cell *c = cell_at(points, i, row);
            if (!c || !c->valid) continue;
            cell part = *c;
            part.radius *= 0.7;
            const ellipse e = ellipse_of(w, &part, ray, 0);
            const double dx = at_x - c->x, dy = at_y - c->y,
                         z = c->depth + e.rise * (dx * e.m[0] + dy * e.m[1]);
            if (!(form(&e, dx, dy) < 1 && z < depth) || is_beyond_grid(w, at_x, at_y, z)) continue;
            *own = *c;
            own->depth = depth = z;
        }
}

static void push(work *w, int number) {
    level *fine = &w->levels[number];
    for (int y = 0; y < fine->height; y++)
        for (int x = 0; x < fine->width; x++) {
            share shares[4];
            cell *own = cell_at(fine, x, y);
            const bool around = is_around(w, number, x, y);
            int count = find_corners(w, number, x, y, false, around, shares);
            if (count) {
                const share *front = front_of(shares, count, false);
                if (!own->valid || own->depth > front->depth + front->from->radius)
                    *own = mix(w, shares, count, false);
                continue;
            }
            if (own->valid) {
                if (number == 0 && is_beyond(w, own, x, y) &&
                    !(around && is_supported(w, x, y, own->radius, own->depth)))
                    own->valid = false;
                continue;
            }
            if (number == 0 && !around) continue;
            count = find_corners(w, number, x, y, true, around, shares);
            if (!count || (number == 0 && !is_gap_supported(w, x, y))) continue;
            *own = mix(w, shares, count, around);
            own->weak = !around;
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
    work w = {.opts = opts, .view = view, .dims = points->dims};
    w.projector = iso_projector_make(view, &points->transform);
    for (int l = 0; l <= opts->top; l++)
        w.levels[l] = make_level(view->width + 2 * opts->guard, view->height + 2 * opts->guard, l);
    project(&w, points);
    for (int l = opts->base + 1; l <= opts->top; l++) pull(&w, l);
    const level *base = &w.levels[opts->base];
    w.points = make_level(view->width + 2 * opts->guard, view->height + 2 * opts->guard, opts->base);
    memcpy(w.points.cells, base->cells, (size_t)base->width * (size_t)base->height * sizeof *base->cells);
    for (int l = opts->top - 1; l >= 0; l--) push(&w, l);
    for (int y = 0; y < w.levels[0].height; y++)
        for (int x = 0; x < w.levels[0].width; x++)
            if (!cell_at(&w.levels[0], x, y)->valid) fill_rim(&w, x, y, cell_at(&w.levels[0], x, y));
    resolve_picture(&w, points, gbuffer);
    for (int l = 0; l <= opts->top; l++) free(w.levels[l].cells);
    free(w.points.cells);
}
