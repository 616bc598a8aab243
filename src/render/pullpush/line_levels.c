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

#include "base/numbers.h"
#include "render/pullpush/line_graph.h"
#include "render/shading/phong.h"

/* A level's pixel in which a disc's centre is not may still be covered by the disc in part: by how much, in
 * pixels of the level. */
static const double MARGIN = 0.75;
/* A fragment is beside a pixel's centre if the nearest place of the line is within so many pixels of the base
 * level of it, along the line. */
static const double BESIDE = 1.5;
/* How much a line can bend between a corner's fragment and a pixel's, in pixels of the pixel's level, but not
 * of levels below the base. */
static const double BEND = 0.5;
/* A fragment is near enough if the nearest place of the line is within so many of these pixels: of a tube in
 * the last push, and everywhere if the ellipse is thin. A bend of a wide line has places that are the nearest
 * of none. */
static const double NEAREST = 0.75;
/* Half a pixel, and what rounding a fragment's place in its pixel can change. */
static const double HALF = 0.5 + 1.0 / 32;
/* A place of a tube's side is beside a fragment if it is within so many radii of it along the tangent. */
static const double ASIDE = 0.5;
/* How much sooner a ray has to enter the next ball along a tube, in its radii. */
static const double FRONT = 1e-3;
/* The least slope of a ribbon's plane against the ray (its sine), and of a tube's axis (squared). */
static const double RIBBON_SLOPE = 0.25, TUBE_SLOPE = 1.0 / 16;

/* A fragment as a pixel's centre sees it. */
typedef struct sight {
    const iso_line_fragment *from;
    double away[2]; /* from its place to the pixel's centre, pixels of level 0 */
    double q;       /* less than 1 in its ellipse */
    double along;   /* square of the distance from the pixel's centre along the line, pixels^2 */
} sight;

typedef struct line_levels {
    const iso_pullpush_params *params;
    const iso_pyramid *pyramid;
    const iso_line_fragment *fragments;
    double mm;             /* of a pixel of level 0 at depth 1 (orthographic: at any depth) */
    double near, beside;   /* squares of NEAREST and BESIDE, pixels of level 0 */
    double bend;           /* pixels of level 0 */
    int steps;             /* along a line, at most */
    int window;            /* pixels of the base level in which fragments of one depth are of one line */
    bool last;             /* the level below is 0 */
    ptrdiff_t neighbor[8]; /* steps in the index to the pixels around, in the order of links */
} line_levels;

/* `level`: what is pulled into, or pushed from. */
static line_levels levels_of(const iso_pullpush_params *params, int level) {
    const iso_pyramid *p = params->pyramid;
    const int finer = level - 1 - p->layout.base, pixels = finer > 0 ? 1 << finer : 1;
    const ptrdiff_t row = (ptrdiff_t)p->key_stride;
    const double pixel = (double)(1 << p->layout.base);
    return (line_levels){.params = params,
                         .pyramid = p,
                         .fragments = p->line_fragments.data,
                         .mm = 1 / (double)params->scale,
                         .near = NEAREST * NEAREST * pixel * pixel * pixels * pixels,
                         .beside = BESIDE * BESIDE * pixel * pixel,
                         .bend = BEND * pixels * pixel,
                         .steps = 8 * pixels + 2,
                         .window = 4 * pixels,
                         .last = level == 1,
                         .neighbor = {-row - 1, -row, -row + 1, -1, 1, row - 1, row, row + 1}};
}

/* The numbers of the fragments that the pixels of a level show, plus 1; 0: none. `which`: ISO_PLANE_PLACE or
 * ISO_PLANE_BEHIND. */
static int32_t *places_of(const iso_pyramid *pyramid, int level, int which) {
    return (int32_t *)(void *)pyramid->level[level].plane[which];
}

static sight see(const iso_line_fragment *f, const double at[2]) {
    const double x = at[0] - (double)f->x, y = at[1] - (double)f->y;
    return (sight){f, {x, y}, iso_line_form_at(&f->ellipse, x, y), iso_line_form_at(&f->along, x, y)};
}

/* Whether the ellipse of a fragment reaches within `margin` pixels of level 0 of the pixel's centre. */
static bool reaches(const sight *s, double margin) {
    if (s->q <= 1) return true;
    const float *shape = s->from->shape;
    const double dx = s->away[0], dy = s->away[1], distance = sqrt(dx * dx + dy * dy);
    if (distance * (1 - 1 / sqrt(s->q)) <= margin) return true;
    const double xx = (double)shape[0] + margin * margin, xy = (double)shape[1],
                 yy = (double)shape[2] + margin * margin;
    return yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy <= xx * yy - xy * xy;
}

/* Of a fragment, whose form is *q at `at`, and those beside it that `links` links it to, the nearest. */
static const iso_line_fragment *step_along(const line_levels *l, const double at[2],
                                           const iso_line_fragment *from, unsigned links, double *q,
                                           int *step) {
    const iso_line_fragment *best = from;
    for (const int32_t *index = l->pyramid->index + from->key; links; links &= links - 1) {
        const int k = __builtin_ctz(links);
        const iso_line_fragment *f = &l->fragments[index[l->neighbor[k]]];
        const double other = iso_line_form_at(&f->ellipse, at[0] - (double)f->x, at[1] - (double)f->y);
        if (other >= *q) continue;
        *q = other;
        *step = k;
        best = f;
    }
    return best;
}

/* The same, with those that are two pixels away. */
static const iso_line_fragment *jump_along(const line_levels *l, const double at[2],
                                           const iso_line_fragment *from, double *q) {
    const iso_pyramid *p = l->pyramid;
    const iso_pyramid_level *base = &p->level[p->layout.base];
    const iso_line_fragment *best = from;
    for (int dy = -2; dy <= 2; dy++)
        for (int dx = -2; dx <= 2; dx += dy == -2 || dy == 2 ? 1 : 4) {
            const int x = from->column + dx, y = from->row + dy;
            if (x < 0 || y < 0 || x >= base->width || y >= base->height) continue;
            const size_t there = (size_t)y * p->key_stride + (size_t)x;
            if (p->keys[there] == ISO_KEY_NONE) continue;
            const iso_line_fragment *f = &l->fragments[p->index[there]];
            const double other = iso_line_form_at(&f->ellipse, at[0] - (double)f->x, at[1] - (double)f->y);
            if (other >= *q || !iso_line_fragments_follow(from, f)) continue;
            *q = other;
            best = f;
        }
    return best;
}

/* Goes along the line to the fragment that is nearest to the pixel's centre, or to one that is near enough:
 * the square of its distance from there along the line is `enough` at most. */
static void go_along(const line_levels *l, const double at[2], double enough, sight *s) {
    const iso_line_fragment *f = s->from;
    double q = s->q, along = s->along;
    unsigned back = 0; /* the link to where it came from */
    for (int steps = l->steps; steps-- > 0 && along > enough;) {
        int step = 0;
        const iso_line_fragment *best = step_along(l, at, f, f->links & ~back, &q, &step);
        back = 0x80u >> step;
        if (best == f && !(enough > 0) && along > l->beside) {
            best = jump_along(l, at, f, &q);
            back = 0;
        }
        if (best == f) break;
        f = best;
        along = iso_line_form_at(&f->along, at[0] - (double)f->x, at[1] - (double)f->y);
    }
    *s = (sight){f, {at[0] - (double)f->x, at[1] - (double)f->y}, q, along};
}

/* ---- pull */

static void unpack_keys(const iso_pullpush_params *params, iso_rows rows) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_level *base = &p->level[p->layout.base];
    for (int y = rows.first; y <= rows.last; y++) {
        const size_t from = (size_t)y * p->key_stride, at = (size_t)y * base->stride;
        int32_t *places = places_of(p, p->layout.base, ISO_PLANE_PLACE) + at;
        for (int x = 0; x < base->width; x++)
            places[x] = p->keys[from + (size_t)x] == ISO_KEY_NONE ? 0 : p->index[from + (size_t)x] + 1;
        memset(places_of(p, p->layout.base, ISO_PLANE_BEHIND) + at, 0, (size_t)base->width * sizeof *places);
    }
}

/* Whether a fragment is of the line of `front` and within its interval. */
static bool is_of_front(const iso_line_fragment *f, const iso_line_fragment *front) {
    return front && f->line == front->line && f->depth <= front->depth + front->interval;
}

/* Of some fragments, but for those of `front` (NULL: all), the line of the frontmost: of its fragments within
 * the interval behind it, the one nearest to `at`. 0: there is none. Lines are told apart by their numbers,
 * not by their depths: of two within one interval, as wide ribbons over each other are, one would be lost. */
static int32_t choose(const line_levels *l, const int32_t *places, int count, const double at[2],
                      const iso_line_fragment *front) {
    int32_t chosen = 0;
    double least = INFINITY;
    const iso_line_fragment *first = NULL;
    for (int k = 0; k < count; k++) {
        if (!places[k]) continue;
        const iso_line_fragment *f = &l->fragments[places[k] - 1];
        if (!is_of_front(f, front) && (!first || f->depth < first->depth)) first = f;
    }
    for (int k = 0; k < count && first; k++) {
        if (!places[k]) continue;
        const iso_line_fragment *f = &l->fragments[places[k] - 1];
        if (is_of_front(f, front) || !is_of_front(f, first)) continue;
        const double x = at[0] - (double)f->x, y = at[1] - (double)f->y, square = x * x + y * y;
        if (square >= least) continue;
        least = square;
        chosen = places[k];
    }
    return chosen;
}

/* The fragments of two neighbouring pixels of a row of the keys. */
static void read_keys(const iso_pyramid *p, int x, int y, int32_t out[2]) {
    const size_t at = (size_t)y * p->key_stride + (size_t)x;
    for (size_t k = 0; k < 2; k++) out[k] = p->keys[at + k] == ISO_KEY_NONE ? 0 : p->index[at + k] + 1;
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
        out[x] = behind[x] = 0;
        if (keys && !used[2 * x / ISO_KEY_PIECE]) continue;
        if (!read_children(p, level, x, y, child)) continue;
        const double at[2] = {size * (x + 0.5), size * (y + 0.5)};
        out[x] = choose(l, child, 8, at, NULL);
        if (out[x]) behind[x] = choose(l, child, 8, at, &l->fragments[out[x] - 1]);
    }
}

static void pull_rows(const iso_pullpush_params *params, int level, iso_rows rows) {
    const line_levels l = levels_of(params, level);
    for (int y = rows.first; y <= rows.last; y++) pull_row(&l, level, y);
}

/* Pixels have no ellipses of their own. */
static void make_ellipses(const iso_pullpush_params *params, int level, iso_rows rows) {
    (void)params, (void)level, (void)rows;
}

/* ---- push */

enum { CORNERS = 8, CANDIDATES = 10 }; /* fragments of a cell's corners; these and a pixel's own two */

/* Whether going along the line from a corner's fragment can end at one that reaches within `margin` of the
 * pixel: it does if the line is straight, or bends by less than `bend` pixels of level 0. */
static bool may_reach(const sight *s, double margin, double bend) {
    const double square = s->away[0] * s->away[0] + s->away[1] * s->away[1],
                 reach = (double)s->from->reach + margin + bend;
    return square - s->along <= reach * reach;
}

/* Whether going along the line from both fragments would end at the same place: they are within `window`
 * pixels of the base level of each other, and in one depth interval. */
static bool is_same_line(const iso_line_fragment *f, const iso_line_fragment *other, int window) {
    return abs(f->column - other->column) <= window && abs(f->row - other->row) <= window &&
           f->line == other->line && fabsf(f->depth - other->depth) <= f->interval;
}

/* The fragments of the corners of a cell of a level, one of each line, the front ones first. Returns their
 * number: where there is no front one, there is none. */
static int read_corners(const line_levels *l, int level, int column, int row,
                        const iso_line_fragment *found[CORNERS]) {
    const ptrdiff_t stride = (ptrdiff_t)l->pyramid->level[level].stride,
                    corner = (ptrdiff_t)row * stride + column;
    const int32_t *front = places_of(l->pyramid, level, ISO_PLANE_PLACE) + corner;
    if (!(front[0] | front[-1] | front[-stride] | front[-stride - 1])) return 0;
    const int32_t *behind = places_of(l->pyramid, level, ISO_PLANE_BEHIND) + corner;
    const int32_t place[CORNERS] = {front[0],  front[-1],  front[-stride],  front[-stride - 1],
                                    behind[0], behind[-1], behind[-stride], behind[-stride - 1]};
    int count = 0;
    for (int k = 0; k < CORNERS; k++) {
        if (!place[k]) continue;
        const iso_line_fragment *f = &l->fragments[place[k] - 1];
        bool known = false;
        for (int i = 0; i < count && !known; i++) known = is_same_line(f, found[i], l->window / 2);
        if (!known) found[count++] = f;
    }
    return count;
}

/* Goes from a corner's fragment to the one of its line that is nearest to `at`. False: it is one of those
 * that were found before, or does not reach within `margin`. */
static bool find_nearest(const line_levels *l, const double at[2], double margin, const sight *found,
                         int count, const iso_line_fragment *f, sight *s) {
    for (int i = 0; i < count; i++)
        if (is_same_line(f, found[i].from, l->window)) return false;
    *s = see(f, at);
    if (!may_reach(s, margin, l->bend)) return false;
    const bool tube = l->params->kind == ISO_PULLPUSH_TUBES;
    const double enough = f->thin || (l->last && tube) ? l->near : 0;
    if (s->along > enough) go_along(l, at, enough, s);
    return true;
}

/* Of the fragments that reach a pixel and lie behind `front` the frontmost, or one within its interval that
 * is nearer to the pixel's centre; NULL: there is none. */
static const sight *choose_found(const sight *found, int count, double front, double *limit) {
    const sight *chosen = NULL;
    *limit = INFINITY;
    for (int k = 0; k < count; k++)
        if ((double)found[k].from->depth > front && (!chosen || found[k].from->depth < chosen->from->depth))
            chosen = &found[k];
    if (!chosen) return NULL;
    *limit = (double)chosen->from->depth + (double)chosen->from->interval;
    for (int k = 0; k < count; k++)
        if ((double)found[k].from->depth > front && (double)found[k].from->depth <= *limit &&
            found[k].q < chosen->q)
            chosen = &found[k];
    return chosen;
}

static int32_t place_of(const line_levels *l, const sight *s) {
    return s ? (int32_t)(s->from - l->fragments) + 1 : 0;
}

/* Makes what a pixel of level - 1 shows, from its own fragments in out[0] and out[1] and those of the corners
 * of its cell. */
static void push_pixel(const line_levels *l, int level, int x, int y,
                       const iso_line_fragment *const corner[CORNERS], int corners, int32_t *const out[2]) {
    const double size = (double)(1 << (level - 1)), at[2] = {size * (x + 0.5), size * (y + 0.5)},
                 margin = MARGIN * size;
    sight found[CANDIDATES];
    int count = 0;
    for (int k = 0; k < 2; k++)
        if (*out[k]) found[count++] = see(&l->fragments[*out[k] - 1], at);
    const double last = count == 2 ? (double)found[1].from->depth : INFINITY; /* nothing is seen behind it */
    for (int k = 0; k < corners; k++) {
        sight *s = &found[count];
        if ((double)corner[k]->depth <= last && find_nearest(l, at, margin, found, count, corner[k], s) &&
            reaches(s, margin))
            count++;
    }
    double limit, unused;
    const sight *front = choose_found(found, count, -INFINITY, &limit),
                *behind = front ? choose_found(found, count, limit, &unused) : NULL;
    *out[0] = place_of(l, front);
    *out[1] = place_of(l, behind);
}

/* Makes the pixels of the level below that a cell contains. */
static void push_cell(const line_levels *l, int level, int column, int row) {
    const iso_pyramid_level *to = &l->pyramid->level[level - 1];
    const bool over = level - 1 >= l->pyramid->layout.base;
    const iso_line_fragment *corner[CORNERS];
    const int corners = read_corners(l, level, column, row, corner);
    for (int k = 0; k < 4 && (corners || !over); k++) {
        const int x = 2 * column - 1 + (k & 1), y = 2 * row - 1 + (k >> 1);
        if (x < 0 || y < 0 || x >= to->width || y >= to->height) continue;
        const size_t at = (size_t)y * to->stride + (size_t)x;
        int32_t *const out[2] = {places_of(l->pyramid, level - 1, ISO_PLANE_PLACE) + at,
                                 places_of(l->pyramid, level - 1, ISO_PLANE_BEHIND) + at};
        if (!over) *out[0] = *out[1] = 0;
        if (corners) push_pixel(l, level, x, y, corner, corners, out);
    }
}

static void push_rows(const iso_pullpush_params *params, int level, iso_rows rows) {
    const line_levels l = levels_of(params, level);
    for (int row = rows.first; row <= rows.last; row++)
        for (int column = 0; column <= l.pyramid->level[level - 1].width / 2; column++)
            push_cell(&l, level, column, row);
}

/* ---- the last push, into the gbuffer */

typedef struct sample {
    double depth, normal[3];
    uint32_t color;
} sample;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The ray through the centre of a pixel of level 0, of depth 1. */
typedef struct pixel_ray {
    double to[3], square; /* of its length */
} pixel_ray;

static pixel_ray ray_of(const line_levels *l, int x, int y) {
    const iso_pullpush_params *params = l->params;
    const double slope = (double)params->slope;
    pixel_ray ray = {.to = {(x + 0.5 - (double)params->ray[0]) * slope,
                            (y + l->pyramid->layout.rows_before + 0.5 - (double)params->ray[1]) * slope, 1}};
    ray.square = dot(ray.to, ray.to);
    return ray;
}

/* A pixel's ray as a fragment sees it. */
typedef struct meeting {
    const pixel_ray *ray;
    double n[3];      /* tangent of a tube, normal of a ribbon: unit, view space */
    double beside[3]; /* from the fragment's place to the ray at the same depth, mm */
    double radius;    /* mm */
} meeting;

static meeting meet(const line_levels *l, const sight *s, const pixel_ray *ray) {
    const iso_line_fragment *f = s->from;
    const double pixel = (l->params->orthographic ? 1 : (double)f->depth) * l->mm;
    return (meeting){.ray = ray,
                     .n = {(double)f->n[0], (double)f->n[1], (double)f->n[2]},
                     .beside = {s->away[0] * pixel, s->away[1] * pixel, 0},
                     .radius = (double)f->radius};
}

/* Where the ray meets the cylinder around the tangent, or where it is nearest to it; returns whether it meets
 * it. The intersection is computed in the plane perpendicular to the tangent. A tube that points at the eye
 * is drawn as if it pointed 14 degrees beside it. */
static bool meet_cylinder(const meeting *m, sample *out) {
    const double *ray = m->ray->to, along = dot(ray, m->n),
                 before = m->beside[0] * m->n[0] + m->beside[1] * m->n[1];
    const double turn[3] = {ray[0] - along * m->n[0], ray[1] - along * m->n[1], 1 - along * m->n[2]};
    const double less = 1 / iso_max(m->ray->square - along * along, m->ray->square * TUBE_SLOPE),
                 nearest = -(m->beside[0] * turn[0] + m->beside[1] * turn[1]) * less;
    double from[3];
    for (int k = 0; k < 3; k++) from[k] = m->beside[k] - before * m->n[k] + nearest * turn[k];
    const double rest = m->radius * m->radius - dot(from, from), back = sqrt(iso_max(rest, 0) * less);
    for (int k = 0; k < 3; k++) out->normal[k] = from[k] - back * turn[k];
    out->depth += nearest - back;
    return rest >= 0;
}

/* Where the ray meets the sphere around the end of the line, or where it is nearest to it; returns whether it
 * meets it. `rest`: how far the end is from the fragment along the tangent. */
static bool meet_end(const meeting *m, double rest, sample *out) {
    const double *ray = m->ray->to, length = m->ray->square;
    double beside[3], from[3];
    for (int k = 0; k < 3; k++) beside[k] = m->beside[k] - rest * m->n[k];
    const double nearest = -dot(beside, ray) / length;
    for (int k = 0; k < 3; k++) from[k] = beside[k] + nearest * ray[k];
    const double room = m->radius * m->radius - dot(from, from), back = sqrt(iso_max(room, 0) / length);
    for (int k = 0; k < 3; k++) out->normal[k] = from[k] - back * ray[k];
    out->depth += nearest - back;
    return room >= 0;
}

/* Where the ray meets the plane of a ribbon. */
static void meet_plane(const meeting *m, sample *out) {
    const double across = dot(m->ray->to, m->n), least = RIBBON_SLOPE * sqrt(m->ray->square),
                 steep = iso_max(fabs(across), least), side = across > 0 ? -1 : 1;
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
    for (int k = 0; k < 3; k++) normal[k] = -m->ray->to[k];
}

/* How far a place at `depth` on a ray is from the fragment along the tangent, mm. */
static double along_tangent(const meeting *m, const iso_line_fragment *f, double depth) {
    return m->beside[0] * m->n[0] + m->beside[1] * m->n[1] +
           (depth - (double)f->depth) * dot(m->ray->to, m->n);
}

/* Whether a place at `depth` on a ray lies beyond the end of the line that is nearer to the fragment. */
static bool is_beyond_end(const meeting *m, const iso_line_fragment *f, double depth) {
    const double along = along_tangent(m, f, depth);
    return f->end < 0 ? along < (double)f->end : along > (double)f->end;
}

/* The same as complete for tubes. */
static bool complete_tube(const line_levels *l, const sight *s, const meeting *m, sample *out) {
    bool meets = meet_cylinder(m, out) && s->along <= l->beside;
    meets = meets || s->q <= 1;
    if (is_beyond_end(m, s->from, out->depth)) {
        out->depth = (double)s->from->depth;
        meets = meet_end(m, (double)s->from->end, out) && s->q <= 1;
    }
    if (l->params->illuminated) illuminate(m, out->normal);
    return meets;
}

/* Whether a pixel's own fragment is less than half a pixel beside the line, or within `room` of its end: then
 * the pixel shows it in any case, so that lines are at least a pixel wide. */
static bool is_on_line(const sight *s, float room) {
    const double cosine = (double)s->from->cosine, sine = (double)s->from->sine, x = s->away[0],
                 y = s->away[1];
    const double across = 0.5 * (x * x + y * y - cosine * (x * x - y * y) - 2 * sine * x * y);
    return across <= HALF * HALF || fabsf(s->from->end) <= room;
}

/* What a pixel of level 0 shows of a fragment, which can be its own; false: nothing. */
static bool complete(const line_levels *l, const sight *s, const pixel_ray *ray, bool own, sample *out) {
    const bool tube = l->params->kind == ISO_PULLPUSH_TUBES;
    bool meets = s->q <= 1;
    if (!meets && !own && !(tube && s->along <= l->beside)) return false;
    const meeting m = meet(l, s, ray);
    *out = (sample){.depth = (double)s->from->depth, .color = s->from->color};
    if (tube)
        meets = complete_tube(l, s, &m, out);
    else
        meet_plane(&m, out);
    const double size = sqrt(dot(out->normal, out->normal));
    const double scale = 1 / (size > 1e-15 ? size : 1);
    for (int k = 0; k < 3; k++) out->normal[k] = size > 1e-15 ? out->normal[k] * scale : k == 2 ? -1 : 0;
    return meets || (own && is_on_line(s, tube ? 0 : 1));
}

/* Where the ray of a pixel enters the ball around a fragment; INFINITY: nowhere. */
static double ball_depth(const line_levels *l, const double at[2], const pixel_ray *ray,
                         const iso_line_fragment *f) {
    const sight s = {.from = f, .away = {at[0] - (double)f->x, at[1] - (double)f->y}};
    const meeting m = meet(l, &s, ray);
    sample made = {.depth = (double)f->depth};
    return meet_end(&m, 0, &made) ? made.depth : INFINITY;
}

/* A tube that turns towards the eye shows a place that lies before the one nearest to the pixel in the
 * picture: goes on along the line while the ray enters the ball around the next fragment sooner. */
static void go_to_front(const line_levels *l, const double at[2], const pixel_ray *ray, sight *s) {
    const iso_line_fragment *from = s->from, *best = from;
    const double least = FRONT * (double)from->radius;
    double depth = ball_depth(l, at, ray, from);
    for (int steps = (int)from->reach + l->steps; steps-- > 0; from = best) {
        const int32_t *index = l->pyramid->index + from->key;
        for (unsigned links = from->links; links; links &= links - 1) {
            const iso_line_fragment *f = &l->fragments[index[l->neighbor[__builtin_ctz(links)]]];
            if (f->depth >= from->depth) continue;
            const double other = ball_depth(l, at, ray, f);
            if (!(other < depth - least)) continue;
            depth = other;
            best = f;
        }
        if (best == from) break;
    }
    if (best != s->from) *s = see(best, at);
}

/* Whether the place that a pixel shows of a fragment is beside it, or too little of the line is seen to
 * tell. */
static bool is_there(const line_levels *l, const sight *s, const pixel_ray *ray, double depth) {
    const meeting m = meet(l, s, ray);
    return s->from->thin || fabs(along_tangent(&m, s->from, depth)) <= ASIDE * m.radius;
}

/* Adds what a pixel of level 0 shows of a fragment, if it is nearer. */
static void add_sample(const line_levels *l, const double at[2], const pixel_ray *ray, const sight *found,
                       bool own, sample *nearest) {
    sample made, moved;
    sight s = *found;
    const bool shown = complete(l, found, ray, own, &made);
    if (l->params->kind == ISO_PULLPUSH_TUBES && !(shown && is_there(l, found, ray, made.depth)))
        go_to_front(l, at, ray, &s);
    if (s.from != found->from && complete(l, &s, ray, false, &moved))
        made = moved;
    else if (!shown)
        return;
    if (made.depth < nearest->depth) *nearest = made;
}

/* The nearest sample of a pixel of level 0, from its own fragment and those of the corners of its cell; its
 * depth is INFINITY if it has none. */
static sample find_sample(const line_levels *l, int x, int y, const iso_line_fragment *const corner[CORNERS],
                          int corners) {
    const iso_pyramid *p = l->pyramid;
    const double at[2] = {x + 0.5, y + 0.5};
    const size_t key = (size_t)y * p->key_stride + (size_t)x;
    const pixel_ray ray = ray_of(l, x, y);
    sight found[CANDIDATES];
    sample nearest = {.depth = INFINITY};
    int count = 0;
    if (p->layout.base == 0 && p->keys[key] != ISO_KEY_NONE) {
        found[0] = see(&l->fragments[p->index[key]], at);
        add_sample(l, at, &ray, &found[count++], true, &nearest);
    }
    for (int k = 0; k < corners; k++) {
        if ((double)corner[k]->depth - (double)corner[k]->interval > nearest.depth) continue; /* hidden */
        if (!find_nearest(l, at, 0, found, count, corner[k], &found[count])) continue;
        add_sample(l, at, &ray, &found[count++], false, &nearest);
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
    const bool colored = l->pyramid->layout.planes >> ISO_PLANE_RED & 1;
    g->color[at] = colored ? (uint32_t)(target->surface + 1) << 24 | s->color : 0;
}

static void finish_samples(const iso_pullpush_params *params, iso_rows rows) {
    const line_levels l = levels_of(params, 1);
    const iso_pyramid_layout *layout = &l.pyramid->layout;
    const int guard = layout->guard, width = params->target->gbuffer->width,
              height = params->target->gbuffer->height;
    for (int row = rows.first; row <= rows.last; row++)
        for (int column = guard / 2; column <= (guard + width) / 2; column++) {
            const iso_line_fragment *corner[CORNERS];
            const int corners = read_corners(&l, 1, column, row, corner);
            for (int k = 0; k < 4 && corners; k++) {
                const int x = 2 * column - 1 + (k & 1), y = 2 * row - 1 + (k >> 1), to = y + layout->row;
                if (x < guard || x >= guard + width || to < 0 || to >= height) continue;
                const sample s = find_sample(&l, x, y, corner, corners);
                if (s.depth < (double)ISO_NOWHERE)
                    write_sample(&l, &s, (size_t)to * (size_t)width + (size_t)(x + layout->column));
            }
        }
}

const iso_pullpush_steps iso_line_steps = {.unpack_keys = unpack_keys,
                                           .pull_rows = pull_rows,
                                           .make_ellipses = make_ellipses,
                                           .push_rows = push_rows,
                                           .finish_samples = finish_samples};
