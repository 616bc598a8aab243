/* line_levels: pull and push of lines alone (Marroquim, Kraus and Cavalcanti 2008, section 4).
 *
 * A mean of several fragments of a line that turns in the picture lies beside the line, and its ellipse has
 * to be longer than theirs, so that a pixel of a coarse level stands for its whole piece of the line: a bend
 * would get horns. Here a pixel of every level shows one fragment instead. Pull keeps, of the frontmost
 * fragments, the one nearest to the pixel's centre. Push takes the fragments of the coarser pixels around,
 * and goes from there along the line, from a fragment of the base level to the next one beside it, to the
 * fragment nearest to the finer pixel's centre; only if that one's ellipse reaches the pixel, the pixel shows
 * it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/primitives.h"
#include "render/pullpush/kernel.h"
#include "render/shading/phong.h"

/* A level's pixel in which a disc's centre is not may still be covered by the disc in part: by how much, in
 * pixels of the level. */
static const double MARGIN = 0.75;
/* A fragment is beside a pixel's centre if the nearest place of the line is within so many pixels of the base
 * level of it, along the line. */
static const double BESIDE = 1.5;
/* How much a line can bend between the fragments of the last push, pixels. */
static const double LAST_BEND = 0.5;
/* A fragment is near enough if the nearest place of the line is within so many pixels: of a tube in the last
 * push, and everywhere if the ellipse is less than THIN pixels of level 0 wide. A bend of a wide line has
 * places that are the nearest of none. */
static const double NEAREST = 0.75, THIN = 4;
/* Half a pixel, and what rounding a fragment's place in its pixel can change. */
static const double HALF = 0.5 + 1.0 / 32;
/* The least slope of a ribbon's plane against the ray (its sine), and of a tube's axis (squared). */
static const double RIBBON_SLOPE = 0.25, TUBE_SLOPE = 1.0 / 16;

/* A fragment as a pixel's centre sees it. */
typedef struct fragment {
    int x, y;       /* its pixel of the base level */
    double away[2]; /* from its place to the pixel's centre, pixels of level 0 */
    double depth;   /* mm */
    double q;       /* less than 1 in its ellipse */
    double along;   /* square of the distance from the pixel's centre along the line, pixels^2 */
    int64_t key;
} fragment;

typedef struct line_levels {
    const iso_pullpush_params *params;
    const iso_pyramid *pyramid;
    const iso_pyramid_level *base;
    double pixel; /* of the base level, pixels of level 0 */
} line_levels;

static line_levels levels_of(const iso_pullpush_params *params) {
    const iso_pyramid *p = params->pyramid;
    return (line_levels){params, p, &p->level[p->layout.base], (double)(1 << p->layout.base)};
}

/* The places among the keys of the fragments that the pixels of a level show, plus 1; 0: none. `which`:
 * ISO_PLANE_PLACE or ISO_PLANE_BEHIND. */
static int32_t *places_of(const iso_pyramid *pyramid, int level, int which) {
    return (int32_t *)(void *)pyramid->level[level].plane[which];
}

static double depth_of(int64_t key) {
    int32_t bits = (int32_t)(key >> 32);
    float depth;
    bits ^= bits >> 31 & INT32_MAX;
    memcpy(&depth, &bits, sizeof depth);
    return (double)depth;
}

static double plane_at(const line_levels *l, int plane, const fragment *f) {
    return (double)l->base->plane[plane][(size_t)f->y * l->base->stride + (size_t)f->x];
}

/* The fragment in a pixel of the base level, seen from `at`, in pixels of level 0. False: there is none. */
static bool see(const line_levels *l, int x, int y, const double at[2], fragment *f) {
    if (x < 0 || y < 0 || x >= l->base->width || y >= l->base->height) return false;
    f->key = l->pyramid->keys[(size_t)y * l->pyramid->key_stride + (size_t)x];
    if (f->key == ISO_KEY_NONE) return false;
    f->x = x;
    f->y = y;
    f->depth = depth_of(f->key);
    f->away[0] = at[0] - l->pixel * (x + ((f->key >> 22 & 31) + 0.5) / 32);
    f->away[1] = at[1] - l->pixel * (y + ((f->key >> 27 & 31) + 0.5) / 32);
    return true;
}

/* The inverse of a fragment's ellipse, as a matrix. */
typedef struct form {
    double xx, xy, yy;
} form;

static form form_of(const line_levels *l, const fragment *f) {
    const double xx = plane_at(l, ISO_PLANE_SHAPE_XX, f), xy = plane_at(l, ISO_PLANE_SHAPE_XY, f),
                 yy = plane_at(l, ISO_PLANE_SHAPE_YY, f), inverse = 1 / fmax(xx * yy - xy * xy, 1e-12);
    return (form){inverse * yy, -inverse * xy, inverse * xx};
}

static void set_q(const line_levels *l, fragment *f) {
    const form m = form_of(l, f);
    const double x = f->away[0], y = f->away[1];
    f->q = m.xx * x * x + 2 * m.xy * x * y + m.yy * y * y;
}

/* The square of the distance from the nearest place of the line to a pixel's centre, along the line,
 * pixels^2. */
static double along_square(const line_levels *l, const fragment *f) {
    const form m = form_of(l, f);
    const double c = plane_at(l, ISO_PLANE_TWICE_X, f), s = plane_at(l, ISO_PLANE_TWICE_Y, f);
    const double u = m.xx * f->away[0] + m.xy * f->away[1], v = m.xy * f->away[0] + m.yy * f->away[1];
    const double slope = 0.5 * ((1 + c) * u * u + 2 * s * u * v + (1 - c) * v * v),
                 bend = 0.5 * ((1 + c) * m.xx + 2 * s * m.xy + (1 - c) * m.yy);
    return slope / fmax(bend * bend, 1e-24);
}

/* Whether the ellipse of a fragment reaches within `margin` pixels of level 0 of the pixel's centre. */
static bool reaches(const line_levels *l, const fragment *f, double margin) {
    if (f->q <= 1) return true;
    const double dx = f->away[0], dy = f->away[1], distance = sqrt(dx * dx + dy * dy);
    if (distance * (1 - 1 / sqrt(f->q)) <= margin) return true;
    const double xx = plane_at(l, ISO_PLANE_SHAPE_XX, f) + margin * margin,
                 xy = plane_at(l, ISO_PLANE_SHAPE_XY, f),
                 yy = plane_at(l, ISO_PLANE_SHAPE_YY, f) + margin * margin;
    return yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy <= xx * yy - xy * xy;
}

/* Replaces *best by the nearest of the fragments `ring` pixels around one that continue it in depth. */
static void look_around(const line_levels *l, const double at[2], const fragment *f, int ring,
                        fragment *best) {
    const double interval = plane_at(l, ISO_PLANE_INTERVAL, f);
    for (int dy = -ring; dy <= ring; dy++)
        for (int dx = -ring; dx <= ring; dx += dy == -ring || dy == ring ? 1 : 2 * ring) {
            fragment other;
            if (!see(l, f->x + dx, f->y + dy, at, &other)) continue;
            const double step = fabs(other.depth - f->depth);
            if (step > interval && step > plane_at(l, ISO_PLANE_INTERVAL, &other)) continue;
            set_q(l, &other);
            if (other.q < best->q) *best = other;
        }
}

/* Goes along the line to the fragment that is nearest to the pixel's centre, in at most so many steps, or to
 * one that is `enough` pixels of the base level from there along the line. Sets its q and along. */
static void go_along(const line_levels *l, const double at[2], int steps, double enough, fragment *f) {
    const double square = l->pixel * l->pixel;
    set_q(l, f);
    for (f->along = along_square(l, f); steps-- > 0 && f->along > enough * enough * square;
         f->along = along_square(l, f)) {
        fragment best = *f;
        look_around(l, at, f, 1, &best);
        if (best.q >= f->q && !(enough > 0) && f->along > BESIDE * BESIDE * square)
            look_around(l, at, f, 2, &best);
        if (best.q >= f->q) return;
        *f = best;
    }
}

/* ---- pull */

static void unpack_keys(const iso_pullpush_params *params, iso_rows rows) {
    const line_levels l = levels_of(params);
    const iso_pyramid *p = l.pyramid;
    for (int y = rows.first; y <= rows.last; y++) {
        const int64_t *keys = p->keys + (size_t)y * p->key_stride;
        const size_t at = (size_t)y * l.base->stride;
        int32_t *places = places_of(p, p->layout.base, ISO_PLANE_PLACE) + at;
        for (int x = 0; x < l.base->width; x++)
            places[x] = keys[x] == ISO_KEY_NONE ? 0 : (int32_t)(keys - p->keys) + x + 1;
        memset(places_of(p, p->layout.base, ISO_PLANE_BEHIND) + at, 0,
               (size_t)l.base->width * sizeof *places);
    }
}

static fragment fragment_of(const line_levels *l, int32_t place, const double at[2]) {
    const uint32_t number = (uint32_t)(place - 1), stride = (uint32_t)l->pyramid->key_stride;
    fragment f = {.x = -1};
    see(l, (int)(number % stride), (int)(number / stride), at, &f);
    return f;
}

/* Of some fragments those that lie behind `front`, and of those the ones within the interval behind the
 * frontmost: the one nearest to `at`. 0: there is none. Sets *limit to where the interval ends. */
static int32_t choose(const line_levels *l, const int32_t *places, int count, const double at[2],
                      double front, double *limit) {
    fragment f[8];
    int32_t chosen = 0;
    double low = INFINITY, least = INFINITY;
    *limit = INFINITY;
    for (int k = 0; k < count; k++) {
        if (!places[k]) continue;
        f[k] = fragment_of(l, places[k], at);
        if (f[k].depth >= low || f[k].depth <= front) continue;
        low = f[k].depth;
        *limit = low + plane_at(l, ISO_PLANE_INTERVAL, &f[k]);
    }
    for (int k = 0; k < count; k++) {
        if (!places[k] || f[k].depth > *limit || f[k].depth <= front) continue;
        const double square = f[k].away[0] * f[k].away[0] + f[k].away[1] * f[k].away[1];
        if (square >= least) continue;
        least = square;
        chosen = places[k];
    }
    return chosen;
}

/* The fragments of two neighbouring pixels of a row of the keys. */
static void read_keys(const iso_pyramid *p, int x, int y, int32_t out[2]) {
    const size_t at = (size_t)y * p->key_stride + (size_t)x;
    for (int k = 0; k < 2; k++) out[k] = p->keys[at + (size_t)k] == ISO_KEY_NONE ? 0 : (int32_t)at + k + 1;
}

/* The fragments of the four children of a pixel: the front ones, then those behind. False: there is none. */
static bool read_children(const iso_pyramid *p, int level, int x, int y, int32_t child[8]) {
    if (level == 1 && p->layout.base == 0) {
        for (int row = 0; row < 2; row++) read_keys(p, 2 * x, 2 * y + row, child + 2 * row);
        memset(child + 4, 0, 4 * sizeof *child);
        return child[0] | child[1] | child[2] | child[3];
    }
    const size_t stride = p->level[level - 1].stride, at = (size_t)(2 * y) * stride + 2 * (size_t)x;
    for (int layer = 0; layer < 2; layer++) {
        const int32_t *places = places_of(p, level - 1, ISO_PLANE_PLACE + layer) + at;
        for (int row = 0; row < 2; row++)
            memcpy(child + 4 * layer + 2 * row, places + (size_t)row * stride, 2 * sizeof *child);
        if (!(child[0] | child[1] | child[2] | child[3])) return false;
    }
    return true;
}

static void pull_row(const line_levels *l, int level, int y) {
    const iso_pyramid *p = l->pyramid;
    const iso_pyramid_level *to = &p->level[level];
    const double size = (double)(1 << level);
    const bool keys = level == 1 && p->layout.base == 0;
    const uint8_t *used =
        p->used + (size_t)y * (p->key_stride / ISO_KEY_PIECE); /* if the level below has keys */
    int32_t *out = places_of(p, level, ISO_PLANE_PLACE) + (size_t)y * to->stride,
            *behind = places_of(p, level, ISO_PLANE_BEHIND) + (size_t)y * to->stride;
    for (int x = 0; x < to->width; x++) {
        int32_t child[8];
        double limit, unused;
        out[x] = behind[x] = 0;
        if (keys && !used[2 * x / ISO_KEY_PIECE]) continue;
        if (!read_children(p, level, x, y, child)) continue;
        const double at[2] = {size * (x + 0.5), size * (y + 0.5)};
        out[x] = choose(l, child, 8, at, -INFINITY, &limit);
        behind[x] = choose(l, child, 8, at, limit, &unused);
    }
}

/* Notes which pieces of a pair of key rows are used. */
static void mark_used(const iso_pyramid *p, int y) {
    const size_t pieces = p->key_stride / ISO_KEY_PIECE;
    const int64_t *keys = p->keys + (size_t)y * p->key_stride;
    for (size_t i = 0; i < pieces; i++) {
        int64_t least = ISO_KEY_NONE;
        for (size_t row = 0; row < 2; row++)
            for (size_t x = 0; x < ISO_KEY_PIECE; x++) {
                const int64_t key = keys[row * p->key_stride + i * ISO_KEY_PIECE + x];
                least = key < least ? key : least;
            }
        p->used[(size_t)(y / 2) * pieces + i] = least != ISO_KEY_NONE;
    }
}

static void pull_rows(const iso_pullpush_params *params, int level, iso_rows rows) {
    const line_levels l = levels_of(params);
    for (int y = rows.first; y <= rows.last; y++) {
        if (level - 1 == l.pyramid->layout.base) mark_used(l.pyramid, 2 * y);
        pull_row(&l, level, y);
    }
}

/* Pixels have no ellipses of their own. */
static void make_ellipses(const iso_pullpush_params *params, int level, iso_rows rows) {
    (void)params, (void)level, (void)rows;
}

/* ---- push */

enum { CORNERS = 8, CANDIDATES = 10 }; /* fragments of a cell's corners; these and a pixel's own two */

/* Whether going along the line from a corner's fragment can end at one that reaches within `margin` of the
 * pixel: it does if the line is straight, or bends by less than `bend` pixels of level 0. Sets q, along. */
static bool may_reach(const line_levels *l, fragment *f, double margin, double bend) {
    set_q(l, f);
    f->along = along_square(l, f);
    const double square = f->away[0] * f->away[0] + f->away[1] * f->away[1],
                 xx = plane_at(l, ISO_PLANE_SHAPE_XX, f), yy = plane_at(l, ISO_PLANE_SHAPE_YY, f),
                 reach = sqrt(xx + yy) + margin + bend;
    return square - f->along <= reach * reach;
}

/* The fragments of the corners of the cell of a level that contains pixel (x, y) of the level below, the
 * front ones first. Returns their number. */
static int read_corners(const line_levels *l, int level, int x, int y, int32_t place[CORNERS]) {
    const ptrdiff_t stride = (ptrdiff_t)l->pyramid->level[level].stride;
    const ptrdiff_t corner = (ptrdiff_t)((y + 1) / 2) * stride + (x + 1) / 2;
    int count = 0;
    for (int k = 0; k < CORNERS; k++) {
        const int32_t *places = places_of(l->pyramid, level, ISO_PLANE_PLACE + (k >> 2)) + corner;
        const int32_t made = places[-(k & 1) - (k >> 1 & 1) * stride];
        bool known = !made;
        for (int i = 0; i < count && !known; i++) known = place[i] == made;
        if (!known) place[count++] = made;
    }
    return count;
}

/* Pixels of the base level that a pixel of the level below `level` is wide. */
static int pixels_of(const line_levels *l, int level) {
    const int finer = level - 1 - l->pyramid->layout.base;
    return finer > 0 ? 1 << finer : 1;
}

/* Goes from a corner's fragment to the one of its line that is nearest to `at`. False: it is one of those
 * that were found before, or does not reach within `margin`. */
static bool find_nearest(const line_levels *l, int level, const double at[2], double margin,
                         const fragment *found, int count, fragment *f) {
    const int pixels = pixels_of(l, level), near = 4 * pixels;
    const bool thin = plane_at(l, ISO_PLANE_SHAPE_XX, f) + plane_at(l, ISO_PLANE_SHAPE_YY, f) < THIN * THIN;
    const double enough = thin || (level == 1 && l->params->kind == ISO_PULLPUSH_TUBES) ? NEAREST : 0;
    const double interval = plane_at(l, ISO_PLANE_INTERVAL, f);
    for (int i = 0; i < count; i++) /* going along the line would end at the same place */
        if (abs(f->x - found[i].x) <= near && abs(f->y - found[i].y) <= near &&
            fabs(f->depth - found[i].depth) <= interval)
            return false;
    if (!may_reach(l, f, margin, (level == 1 ? LAST_BEND : 2 * pixels) * l->pixel)) return false;
    go_along(l, at, 8 * pixels + 2, enough, f);
    return true;
}

/* Of the fragments that reach a pixel and lie behind `front` the frontmost, or one within its interval that
 * is nearer to the pixel's centre; NULL: there is none. */
static const fragment *choose_found(const line_levels *l, const fragment *found, int count, double front,
                                    double *limit) {
    const fragment *chosen = NULL;
    *limit = INFINITY;
    for (int k = 0; k < count; k++)
        if (found[k].depth > front && (!chosen || found[k].depth < chosen->depth)) chosen = &found[k];
    if (!chosen) return NULL;
    *limit = chosen->depth + plane_at(l, ISO_PLANE_INTERVAL, chosen);
    for (int k = 0; k < count; k++)
        if (found[k].depth > front && found[k].depth <= *limit && found[k].q < chosen->q) chosen = &found[k];
    return chosen;
}

static int32_t place_of(const line_levels *l, const fragment *f) {
    return f ? (int32_t)((size_t)f->y * l->pyramid->key_stride) + f->x + 1 : 0;
}

/* Makes what a pixel of level - 1 shows, from its own fragments in out[0] and out[1] and those around. */
static void push_pixel(const line_levels *l, int level, int x, int y, int32_t *const out[2]) {
    const double size = (double)(1 << (level - 1)), at[2] = {size * (x + 0.5), size * (y + 0.5)},
                 margin = MARGIN * size;
    fragment found[CANDIDATES];
    int count = 0;
    for (int k = 0; k < 2; k++) {
        if (!*out[k]) continue;
        found[count] = fragment_of(l, *out[k], at);
        set_q(l, &found[count++]);
    }
    int32_t place[CORNERS];
    const int corners = read_corners(l, level, x, y, place);
    const double last = count == 2 ? found[1].depth : INFINITY; /* what lies behind it is not seen */
    for (int k = 0; k < corners; k++) {
        fragment f = fragment_of(l, place[k], at);
        if (f.depth <= last && find_nearest(l, level, at, margin, found, count, &f) && reaches(l, &f, margin))
            found[count++] = f;
    }
    double limit, unused;
    const fragment *front = choose_found(l, found, count, -INFINITY, &limit),
                   *behind = front ? choose_found(l, found, count, limit, &unused) : NULL;
    *out[0] = place_of(l, front);
    *out[1] = place_of(l, behind);
}

static void push_rows(const iso_pullpush_params *params, int level, iso_rows rows) {
    const line_levels l = levels_of(params);
    const iso_pyramid_level *c = &l.pyramid->level[level], *to = c - 1;
    const bool over = level - 1 >= l.pyramid->layout.base;
    for (int cell = rows.first; cell <= rows.last; cell++) {
        const int32_t *lower = places_of(l.pyramid, level, ISO_PLANE_PLACE) +
                               (ptrdiff_t)cell * (ptrdiff_t)c->stride,
                      *upper = lower - c->stride;
        for (int y = cell > 0 ? 2 * cell - 1 : 0; y <= 2 * cell && y < to->height; y++) {
            const size_t row = (size_t)y * to->stride;
            for (int x = 0; x < to->width; x++) {
                int32_t *const out[2] = {places_of(l.pyramid, level - 1, ISO_PLANE_PLACE) + row + x,
                                         places_of(l.pyramid, level - 1, ISO_PLANE_BEHIND) + row + x};
                const int column = (x + 1) / 2;
                if (!over) *out[0] = *out[1] = 0;
                if (lower[column] | lower[column - 1] | upper[column] | upper[column - 1])
                    push_pixel(&l, level, x, y, out);
            }
        }
    }
}

/* ---- the last push, into the gbuffer */

typedef struct sample {
    double depth, normal[3];
    fragment from;
} sample;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The ray through a pixel's centre as a fragment sees it. */
typedef struct meeting {
    double n[3];      /* tangent of a tube, normal of a ribbon: unit, view space */
    double beside[3]; /* from the fragment's place to the ray at the same depth, mm */
    double ray[3];    /* of depth 1 */
    double radius;    /* mm */
    double pixel;     /* a pixel's size at the fragment, mm */
} meeting;

static meeting meet(const line_levels *l, const fragment *f, int x, int y) {
    const iso_pullpush_params *params = l->params;
    const iso_surfel packed = iso_point_unpack((iso_point){.bits = (uint64_t)(f->key & 0x3fffff) << 42});
    const double pixel = (params->orthographic ? 1 : f->depth) / (double)params->scale;
    meeting m = {
        .beside = {f->away[0] * pixel, f->away[1] * pixel, 0},
        .ray = {(x + 0.5 - (double)params->ray[0]) * (double)params->slope,
                (y + l->pyramid->layout.rows_before + 0.5 - (double)params->ray[1]) * (double)params->slope,
                1},
        .radius = plane_at(l, ISO_PLANE_RADIUS, f)};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) m.n[k] += (double)params->normal[3 * k + i] * (double)packed.normal[i];
    const double length = sqrt(dot(m.n, m.n));
    for (int k = 0; k < 3; k++) m.n[k] /= length;
    return m;
}

/* Where the ray meets the cylinder around the tangent, or where it is nearest to it; returns whether it meets
 * it. The intersection is computed in the plane perpendicular to the tangent. A tube that points at the eye
 * is drawn as if it pointed 14 degrees beside it. */
static bool meet_cylinder(const meeting *m, sample *out) {
    const double along = dot(m->ray, m->n), before = dot(m->beside, m->n), length = dot(m->ray, m->ray);
    double turn[3], from[3];
    for (int k = 0; k < 3; k++) turn[k] = m->ray[k] - along * m->n[k];
    const double square = fmax(length - along * along, length * TUBE_SLOPE),
                 nearest = -dot(m->beside, turn) / square;
    for (int k = 0; k < 3; k++) from[k] = m->beside[k] - before * m->n[k] + nearest * turn[k];
    const double rest = m->radius * m->radius - dot(from, from), back = sqrt(fmax(rest, 0) / square);
    for (int k = 0; k < 3; k++) out->normal[k] = from[k] - back * turn[k];
    out->depth += nearest - back;
    return rest >= 0;
}

/* Where the ray meets the sphere around the end of the line, or where it is nearest to it; returns whether it
 * meets it. `rest`: how far the end is from the fragment along the tangent. */
static bool meet_end(const meeting *m, double rest, sample *out) {
    const double length = dot(m->ray, m->ray);
    double beside[3], from[3];
    for (int k = 0; k < 3; k++) beside[k] = m->beside[k] - rest * m->n[k];
    const double nearest = -dot(beside, m->ray) / length;
    for (int k = 0; k < 3; k++) from[k] = beside[k] + nearest * m->ray[k];
    const double room = m->radius * m->radius - dot(from, from), back = sqrt(fmax(room, 0) / length);
    for (int k = 0; k < 3; k++) out->normal[k] = from[k] - back * m->ray[k];
    out->depth += nearest - back;
    return room >= 0;
}

/* Where the ray meets the plane of a ribbon. */
static void meet_plane(const meeting *m, sample *out) {
    const double across = dot(m->ray, m->n), least = RIBBON_SLOPE * sqrt(dot(m->ray, m->ray)),
                 steep = fmax(fabs(across), least), side = across > 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) out->normal[k] = side * m->n[k];
    out->depth += side * dot(m->beside, m->n) / steep;
}

/* The normal of an illuminated line: the direction to the key light, projected onto the plane perpendicular
 * to the tangent (section 4.2, figure 11); towards the eye where the line points at the light. */
static void illuminate(const meeting *m, double normal[3]) {
    const double light[3] = {(double)ISO_PHONG_LIGHT_X, (double)ISO_PHONG_LIGHT_Y, (double)ISO_PHONG_LIGHT_Z},
                 along = dot(light, m->n);
    for (int k = 0; k < 3; k++) normal[k] = light[k] - along * m->n[k];
    if (dot(normal, normal) > 1e-6) return;
    for (int k = 0; k < 3; k++) normal[k] = -m->ray[k];
}

/* Whether a place at `depth` on a ray lies beyond the end of the line that is nearer to the fragment. */
static bool is_beyond_end(const meeting *m, const fragment *f, double depth, double rest) {
    double along = 0;
    for (int k = 0; k < 3; k++) along += (m->beside[k] + (depth - f->depth) * m->ray[k]) * m->n[k];
    return rest < 0 ? along < rest : along > rest;
}

/* The same as complete for tubes. */
static bool complete_tube(const line_levels *l, const fragment *f, const meeting *m, sample *out) {
    const double rest = plane_at(l, ISO_PLANE_ROOM, f), beside = BESIDE * l->pixel;
    bool meets = meet_cylinder(m, out) && f->along <= beside * beside;
    meets = meets || f->q <= 1;
    if (is_beyond_end(m, f, out->depth, rest)) {
        out->depth = f->depth;
        meets = meet_end(m, rest, out) && f->q <= 1;
    }
    if (l->params->illuminated) illuminate(m, out->normal);
    return meets;
}

/* Whether a pixel's own fragment is less than half a pixel beside the line, or near its end: then the pixel
 * shows it in any case, so that lines are at least a pixel wide. */
static bool is_on_line(const line_levels *l, const fragment *f, const meeting *m) {
    const double c = plane_at(l, ISO_PLANE_TWICE_X, f), s = plane_at(l, ISO_PLANE_TWICE_Y, f), x = f->away[0],
                 y = f->away[1];
    const double across = 0.5 * (x * x + y * y - c * (x * x - y * y) - 2 * s * x * y);
    if (across <= HALF * HALF) return true;
    const double pixel = l->params->kind == ISO_PULLPUSH_TUBES ? m->pixel : 1;
    return fabs(plane_at(l, ISO_PLANE_ROOM, f)) <= pixel;
}

/* What a pixel of level 0 shows of a fragment, which can be its own; false: nothing. */
static bool complete(const line_levels *l, const fragment *f, int x, int y, bool own, sample *out) {
    const meeting m = meet(l, f, x, y);
    bool meets = f->q <= 1;
    *out = (sample){.depth = f->depth, .from = *f};
    if (l->params->kind == ISO_PULLPUSH_TUBES)
        meets = complete_tube(l, f, &m, out);
    else
        meet_plane(&m, out);
    const double size = sqrt(dot(out->normal, out->normal));
    for (int k = 0; k < 3; k++) out->normal[k] = size > 1e-15 ? out->normal[k] / size : k == 2 ? -1 : 0;
    return meets || (own && is_on_line(l, f, &m));
}

static void keep_nearer(const sample *made, sample *nearest) {
    if (made->depth < nearest->depth) *nearest = *made;
}

/* The nearest sample of a pixel of level 0; its depth is INFINITY if it has none. */
static sample find_sample(const line_levels *l, int x, int y) {
    const double at[2] = {x + 0.5, y + 0.5};
    fragment found[CANDIDATES];
    sample made, nearest = {.depth = INFINITY};
    const bool own = l->pyramid->layout.base == 0 && see(l, x, y, at, &found[0]);
    if (own) go_along(l, at, 0, 0, &found[0]);
    int32_t place[CORNERS];
    const int corners = read_corners(l, 1, x, y, place);
    int count = own;
    if (own && complete(l, &found[0], x, y, true, &made)) keep_nearer(&made, &nearest);
    for (int k = 0; k < corners; k++) {
        fragment f = fragment_of(l, place[k], at);
        if (f.depth - plane_at(l, ISO_PLANE_INTERVAL, &f) > nearest.depth) continue; /* hidden */
        if (!find_nearest(l, 1, at, 0, found, count, &f)) continue;
        found[count++] = f;
        if (complete(l, &f, x, y, false, &made)) keep_nearer(&made, &nearest);
    }
    return nearest;
}

static void write_sample(const line_levels *l, const sample *s, size_t at) {
    const iso_target *target = l->params->target;
    const iso_gbuffer *g = target->gbuffer;
    if (!((float)s->depth < g->depth[at])) return;
    g->depth[at] = (float)s->depth;
    for (int k = 0; k < 3; k++) g->normal[k][at] = (float)s->normal[k];
    g->surface[at] = (uint8_t)target->surface;
    if (!g->color) return;
    uint32_t color = 0;
    if (l->base->plane[ISO_PLANE_RED]) {
        color = (uint32_t)(target->surface + 1) << 24;
        for (int k = 0; k < 3; k++)
            color |= (uint32_t)(plane_at(l, ISO_PLANE_RED + k, &s->from) + 0.5) << 8 * k;
    }
    g->color[at] = color;
}

static void finish_samples(const iso_pullpush_params *params, iso_rows rows) {
    const line_levels l = levels_of(params);
    const iso_pyramid *p = l.pyramid;
    const iso_pyramid_level *c = &p->level[1];
    const int guard = p->layout.guard, width = params->target->gbuffer->width,
              height = params->target->gbuffer->height;
    for (int cell = rows.first; cell <= rows.last; cell++) {
        const int32_t *lower = places_of(p, 1, ISO_PLANE_PLACE) + (ptrdiff_t)cell * (ptrdiff_t)c->stride,
                      *upper = lower - c->stride;
        for (int y = 2 * cell - 1; y <= 2 * cell; y++) {
            const int row = y + p->layout.row;
            for (int x = guard; row >= 0 && row < height && x < guard + width; x++) {
                const int column = (x + 1) / 2;
                if (!(lower[column] | lower[column - 1] | upper[column] | upper[column - 1])) continue;
                const sample s = find_sample(&l, x, y);
                if (s.depth < (double)ISO_NOWHERE)
                    write_sample(&l, &s, (size_t)row * (size_t)width + (size_t)(x + p->layout.column));
            }
        }
    }
}

const iso_pullpush_steps iso_line_steps = {.unpack_keys = unpack_keys,
                                           .pull_rows = pull_rows,
                                           .make_ellipses = make_ellipses,
                                           .push_rows = push_rows,
                                           .finish_samples = finish_samples};
