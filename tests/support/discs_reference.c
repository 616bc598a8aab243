/* discs_reference: for every pixel, intersects its ray with the discs of all points in double precision.
 */
#include "discs_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/view/project.h"

typedef struct disc {
    double at[3], n[3], s[3][3], radius; /* n with its tilt */
    double lit[3];                       /* the point's normal, without the tilt */
    double low[3], high[3];              /* the box it is clipped to: index axes, voxels from its centre */
    bool turned;
    const uint8_t *rgb; /* NULL: points have no colours */
    /* Of filtered discs, whose share is above 0: the convolved disc covers offsets of (x, y) pixels where
     * soft[0] x^2 + soft[1] x y + soft[2] y^2 < 1; factor of its weights. */
    double soft[3], share;
} disc;

/* Where a ray meets a disc. */
typedef struct hit {
    const disc *from;
    double depth, weight, q[3];
    bool covers; /* false: the pixel is covered by the convolved disc only */
} hit;

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void bend(const double s[3][3], const double d[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = dot3(s[k], d);
}

static void turn(const iso_projector *projector, const float from[3], double to[3]) {
    for (int k = 0; k < 3; k++) {
        to[k] = 0;
        for (int i = 0; i < 3; i++) to[k] += projector->normal[3 * k + i] * (double)from[i];
    }
}

/* Sets S in view space; where the surface is convex, also with the largest curvature along the normal. */
static void set_curvature(const iso_projector *projector, const iso_point_view *points, size_t i,
                          double length, disc *d) {
    const iso_surfel surfel = iso_point_view_get(points, i);
    float entry[3], tilt[2], u[3], v[3];
    double a[3], b[3], trace = 0, square = 0;
    iso_curvature_unpack(points->curvatures[i], entry, tilt);
    iso_curvature_frame(surfel.normal, u, v);
    turn(projector, u, a);
    turn(projector, v, b);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            d->s[r][c] = ((double)entry[0] * a[r] * a[c] + (double)entry[1] * (a[r] * b[c] + b[r] * a[c]) +
                          (double)entry[2] * b[r] * b[c]) /
                         length;
            square += d->s[r][c] * d->s[r][c];
            trace += r == c ? d->s[r][c] : 0;
        }
    const double most = (trace + sqrt(fmax(2 * square - trace * trace, 0))) / 2;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) d->s[r][c] += fmax(most, 0) * d->lit[r] * d->lit[c];
    for (int k = 0; k < 3; k++) d->n[k] += ((double)tilt[0] * a[k] + (double)tilt[1] * b[k]) / length;
}

/* The number of voxels in a mm, on the axis with the smallest spacing. */
static double per_mm(const iso_projector *projector) {
    double most = 0;
    for (int k = 0; k < 3; k++) {
        const double m[3] = {projector->normal[k], projector->normal[3 + k], projector->normal[6 + k]};
        most = fmax(most, sqrt(dot3(m, m)));
    }
    return most;
}

/* Sets the box of a disc, by an edge point's extents and the grid's border. */
static void enclose(const iso_projector *projector, const iso_point_view *points, size_t i,
                    const double index[3], disc *d) {
    const int ends = points->curvatures ? points->curvatures[i].extents : 0, axis = (ends >> 12 & 3) - 1;
    double norm = 0;
    for (int k = 0; k < 9; k++) norm += d->s[k / 3][k % 3] * d->s[k / 3][k % 3];
    int slot = 0;
    for (int k = 0; k < 3; k++) {
        d->low[k] = -1e9;
        d->high[k] = 1e9;
        const double below = index[k] - floor(index[k]);
        if (axis >= 0 && sqrt(norm) > 0.15 * per_mm(projector)) {
            d->low[k] = (axis == k ? (below < 0.002 ? -1 : -below) : -(ends >> 3 * slot & 7) / 7.0) - 0.08;
            d->high[k] =
                (axis == k ? (below > 0.998 ? 1 : 1 - below) : (ends >> (3 * slot + 3) & 7) / 7.0) + 0.08;
        }
        if (axis != k) slot += 2;
        if (!points->dims[k]) continue;
        d->low[k] = fmax(d->low[k], -index[k]);
        d->high[k] = fmin(d->high[k], points->dims[k] - 1 - index[k]);
    }
}

static bool is_in_box(const iso_projector *projector, const disc *d, const double q[3]) {
    for (int k = 0; k < 3; k++) {
        const double m[3] = {projector->normal[k], projector->normal[3 + k], projector->normal[6 + k]};
        if (dot3(m, q) < d->low[k] || dot3(m, q) > d->high[k]) return false;
    }
    return true;
}

/* The squared length in voxels of a step in view space, as if voxels were cubes with the largest spacing.
 */
static double square_in_voxels(const iso_projector *projector, const double q[3]) {
    double sum = 0, least = INFINITY;
    for (int k = 0; k < 3; k++) {
        const double m[3] = {projector->normal[k], projector->normal[3 + k], projector->normal[6 + k]};
        sum += dot3(m, q) * dot3(m, q);
        least = fmin(least, dot3(m, m));
    }
    return sum / least;
}

/* The squared distance, in radii, of the flat disc's centre from the hit of a ray (x, y) pixels beside it,
 * parallel to that of its centre. */
static double distance_beside(const iso_projector *projector, const disc *d, double x, double y) {
    const iso_view *view = projector->view;
    const double mm = (view->orthographic ? 1 : d->at[2]) / view->focal;
    double ray[3] = {0, 0, 1}, q[3];
    for (int k = 0; k < 2 && !view->orthographic; k++) ray[k] = d->at[k] / d->at[2];
    const double t = -(d->n[0] * x + d->n[1] * y) * mm / dot3(d->n, ray);
    const double e[3] = {x * mm, y * mm, 0};
    for (int k = 0; k < 3; k++) q[k] = e[k] + t * ray[k];
    return square_in_voxels(projector, q) / (d->radius * d->radius);
}

/* Convolves a flat disc with a Gaussian that is exp(-2) at 0.6 pixels: adds the matrices of both ellipses.
 */
static void convolve(const iso_projector *projector, disc *d) {
    const double f = 0.6 * 0.6, xx = distance_beside(projector, d, 1, 0),
                 yy = distance_beside(projector, d, 0, 1),
                 xy = (distance_beside(projector, d, 1, 1) - xx - yy) / 2, det = xx * yy - xy * xy;
    /* the inverse of the ellipse's matrix, and of the sum */
    const double a = yy / det + f, b = -xy / det, c = xx / det + f, sum = a * c - b * b;
    d->soft[0] = c / sum;
    d->soft[1] = -2 * b / sum;
    d->soft[2] = a / sum;
    d->share = sqrt(1 / det / sum);
}

static bool make_disc(const iso_view *view, const iso_projector *projector, const iso_point_view *points,
                      const iso_point_span *span, size_t i, bool cull, disc *d) {
    const iso_surfel surfel = iso_point_view_get(points, i);
    const double radius = points->radii ? (double)points->radii[i] : points->radius;
    double index[3], ray[3] = {0, 0, 1}, sd[3];
    for (int k = 0; k < 3; k++) index[k] = span->brick[k] * (double)ISO_BRICK + (double)surfel.position[k];
    for (int k = 0; k < 3; k++) d->at[k] = dot3(projector->matrix + 3 * k, index) + projector->origin[k];
    if (d->at[2] < view->near) return false;
    turn(projector, surfel.normal, d->n);
    const double length = sqrt(dot3(d->n, d->n));
    for (int k = 0; k < 3; k++) d->lit[k] = d->n[k] /= length;
    memset(d->s, 0, sizeof d->s);
    d->share = 0;
    d->rgb = points->colors ? points->colors[i] : NULL;
    const double pixels = radius * view->focal / (view->orthographic ? 1 : d->at[2]);
    if (points->curvatures) set_curvature(projector, points, i, length, d);
    enclose(projector, points, i, index, d);
    const double more = points->curvatures ? 0.215 : 0.16, over = points->curvatures ? 6 : 60;
    d->radius = radius * (1.2 + more * fmin(fmax((pixels - 4.5) / over, 0), 1));
    if (points->curvatures) d->radius *= 1 - (points->curvatures[i].extents >> 14) / 4.0;
    for (int k = 0; k < 2 && !view->orthographic; k++) ray[k] = d->at[k] / d->at[2];
    const double along = dot3(d->n, ray), lit = dot3(d->lit, ray);
    if (cull && lit > 0 && lit * lit > 0.04 * dot3(ray, ray)) return false;
    bend(d->s, ray, sd);
    d->turned = along > 0 && (along * along > 0.04 * dot3(ray, ray) || !(dot3(ray, sd) > 0));
    if (!d->turned) return true;
    for (int r = 0; r < 3; r++) {
        d->n[r] = -d->n[r];
        d->lit[r] = -d->lit[r];
        for (int c = 0; c < 3; c++) d->s[r][c] = -d->s[r][c];
    }
    return !cull;
}

/* The nearer intersection of a ray with n.q + q.Sq / 2 = 0 within the disc's ball. */
static bool meet_disc(const iso_projector *projector, const disc *d, double u, double v, hit *h) {
    const iso_view *view = projector->view;
    const double z = view->orthographic ? 1 : d->at[2], e[3] = {u * z - d->at[0], v * z - d->at[1], 0},
                 ray[3] = {view->orthographic ? 0 : u, view->orthographic ? 0 : v, 1};
    double sd[3], se[3];
    bend(d->s, ray, sd);
    bend(d->s, e, se);
    const double a = dot3(ray, sd), b = dot3(d->n, ray) + dot3(e, sd), c = 2 * dot3(d->n, e) + dot3(e, se);
    if (b * b < a * c) return false;
    const double t = c / (sqrt(b * b - a * c) - b);
    if (!(fabs(t) <= d->radius)) return false;
    for (int k = 0; k < 3; k++) h->q[k] = e[k] + t * ray[k];
    if (dot3(h->q, h->q) >= d->radius * d->radius) return false;
    const double far = square_in_voxels(projector, h->q) / (d->radius * d->radius);
    h->from = d;
    h->depth = d->at[2] + t;
    h->weight = exp(-2 * far);
    return far < 1 && is_in_box(projector, d, h->q);
}

/* The hit of the disc or, if that is filtered, of the convolved one: within the plane of the disc. */
static bool meet(const iso_projector *projector, const disc *d, double u, double v, hit *h) {
    const iso_view *view = projector->view;
    const double z = view->orthographic ? 1 : d->at[2], x = (u - d->at[0] / z) * view->focal,
                 y = (v - d->at[1] / z) * view->focal;
    const bool hits = meet_disc(projector, d, u, v, h);
    h->covers = hits;
    if (!(d->share > 0)) return hits;
    const double far = d->soft[0] * x * x + d->soft[1] * x * y + d->soft[2] * y * y;
    if (!(far < 1)) return false;
    h->weight = exp(-2 * far) * d->share;
    if (hits) return true;
    double ray[3] = {0, 0, 1};
    for (int k = 0; k < 2 && !view->orthographic; k++) ray[k] = d->at[k] / d->at[2];
    const double most = d->radius + 4 * z / view->focal,
                 t = -(d->n[0] * x + d->n[1] * y) * z / view->focal / dot3(d->n, ray);
    *h = (hit){.from = d, .weight = h->weight};
    h->depth = d->at[2] + fmax(-most, fmin(most, t));
    return true;
}

static int nearest_first(const void *a, const void *b) {
    const hit *x = a, *y = b;
    return (x->depth > y->depth) - (x->depth < y->depth);
}

/* Sets a sample to the weighted means of the hits in front that face the same side: the eye, if any does.
 */
static void resolve_sample(const hit *hits, size_t count, const iso_projector *projector, bool cull,
                           size_t at, iso_gbuffer *g) {
    size_t first = 0;
    while (first < count && !hits[first].covers) first++;
    if (first == count) return;
    double front = hits[first].depth, weight = 0, depth = 0, n[3] = {0}, q[3] = {0}, s[3][3] = {{0}},
           square = 0, rgb[3] = {0};
    for (size_t i = first + 1; i < count && hits[first].from->turned; i++)
        if (hits[i].covers && !hits[i].from->turned && hits[i].depth <= front + 1.5 * hits[i].from->radius)
            first = i;
    front = hits[first].depth;
    for (size_t i = 0; i < count; i++) {
        const hit *h = &hits[i];
        const disc *d = h->from;
        if (d->turned != hits[first].from->turned || h->depth > front + 1.5 * d->radius) continue;
        if (h->depth < front && (h->covers || h->depth < front - 1.5 * d->radius)) continue;
        weight += h->weight;
        depth += h->weight * h->depth;
        for (int k = 0; k < 3; k++) {
            n[k] += h->weight * d->lit[k];
            q[k] += h->weight * h->q[k];
            if (d->rgb) rgb[k] += h->weight * d->rgb[k];
            for (int c = 0; c < 3; c++) {
                s[k][c] += h->weight * d->s[k][c];
                square += h->weight * d->s[k][c] * d->s[k][c];
            }
        }
    }
    double norm = 0, sq[3];
    for (int k = 0; k < 9; k++) norm += s[k / 3][k % 3] * s[k / 3][k % 3];
    const double noisy = 1.8 * per_mm(projector), small = 1 / (1 + norm / (weight * weight * noisy * noisy));
    const double alike = square > 0 ? norm / weight / square * small : 0;
    bend(s, q, sq);
    for (int k = 0; k < 3; k++) n[k] += alike * sq[k] / weight;
    const double length = sqrt(dot3(n, n)) * (!cull && hits[first].from->turned ? -1 : 1);
    for (int k = 0; k < 3; k++) g->normal[k][at] = (float)(n[k] / length);
    g->depth[at] = (float)(depth / weight);
    g->surface[at] = 0;
    for (int k = 0; g->color && k < 3; k++)
        g->color[at] = (k ? g->color[at] : 1u << 24) | (uint32_t)(rgb[k] / weight + 0.5) << 8 * k;
}

void discs_reference(const iso_view *view, const iso_point_view *points, bool filtered,
                     iso_gbuffer *gbuffer) {
    const iso_projector projector = iso_projector_make(view, &points->transform);
    const size_t most = iso_point_view_count(points);
    disc *discs = calloc(most, sizeof *discs);
    hit *hits = calloc(most, sizeof *hits);
    if (!discs || !hits) abort();
    size_t count = 0;
    for (size_t k = 0; k < points->span_count; k++) {
        const size_t begin = count;
        double least = INFINITY; /* pixels */
        for (size_t i = 0; i < points->spans[k].count; i++)
            count += make_disc(view, &projector, points, &points->spans[k], points->spans[k].first + i,
                               points->closed, &discs[count]);
        if (!filtered) continue;
        for (size_t i = begin; i < count; i++)
            least = fmin(least, discs[i].radius * view->focal / (view->orthographic ? 1 : discs[i].at[2]));
        for (size_t i = begin; i < count && least < 5; i++) convolve(&projector, &discs[i]);
    }
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            const double u = (x + 0.5 - view->cx) / view->focal, v = (y + 0.5 - view->cy) / view->focal;
            size_t met = 0;
            for (size_t i = 0; i < count; i++) met += meet(&projector, &discs[i], u, v, &hits[met]);
            if (!met) continue;
            qsort(hits, met, sizeof *hits, nearest_first);
            resolve_sample(hits, met, &projector, points->closed, (size_t)y * (size_t)view->width + (size_t)x,
                           gbuffer);
        }
    free(discs);
    free(hits);
}
