/* fans: ear clipping (Meisters 1975; Eberly, "Triangulation by ear clipping"), in the plane of two axes. */
#include "io/common/fans.h"

#include <math.h>
#include <string.h>

#include "base/geometry.h"
#include "base/memory.h"

/* A triangle faces against its polygon if its area along the polygon's normal is below this share of the
 * polygon's: less is rounding. */
static const double AGAINST = -1e-7;
enum { STEPS = 16384 /* for each corner */, MOST_ACROSS = 256 };

/* A corner of the polygon, in the ring of those that are left. */
typedef struct corner {
    double u, v;
    uint32_t point, before, after;
    uint32_t blocker; /* the corner that blocked this one last: most often it still does */
    bool left;        /* it was not clipped */
    bool obtuse;      /* its inner angle is 180 degrees or more: it may lie in the ear of another corner */
} corner;

/* A polygon that is divided: the ring of its corners, and the cells of a square grid over them. */
typedef struct ring {
    corner *corners;
    size_t count, left;
    double lo[2], scale;      /* of the grid */
    int across;               /* cells along each axis */
    uint32_t *first, *listed; /* the obtuse corners of cell i: listed[first[i]] .. listed[first[i + 1] - 1] */
    uint64_t steps;           /* taken so far */
} ring;

/* ---- polygons and their fans */

static iso_vec3 point_at(const float (*points)[3], uint32_t number) {
    const float *p = points[number];
    return iso_vec3_make((double)p[0], (double)p[1], (double)p[2]);
}

/* Twice the area of a triangle, along its normal. */
static iso_vec3 triangle_normal(const float (*points)[3], const uint32_t t[3]) {
    const iso_vec3 a = point_at(points, t[0]);
    return iso_vec3_cross(iso_vec3_sub(point_at(points, t[1]), a), iso_vec3_sub(point_at(points, t[2]), a));
}

/* Returns whether a triangle of a fan faces against the polygon, whose normal is the sum of the triangles'.
 */
static bool fan_is_wrong(const iso_fan *fan, const float (*points)[3], uint32_t (*triangles)[3],
                         iso_vec3 *normal) {
    *normal = iso_vec3_make(0, 0, 0);
    for (size_t i = 0; i + 2 < fan->corners; i++)
        *normal = iso_vec3_add(*normal, triangle_normal(points, triangles[fan->first + i]));
    const double least = AGAINST * iso_vec3_dot(*normal, *normal);
    for (size_t i = 0; i + 2 < fan->corners; i++)
        if (iso_vec3_dot(triangle_normal(points, triangles[fan->first + i]), *normal) < least) return true;
    return false;
}

/* ---- the ring */

/* Twice the area of the triangle of three corners: above 0 counter-clockwise. */
static double area(const corner *a, const corner *b, const corner *c) {
    return (b->u - a->u) * (c->v - a->v) - (b->v - a->v) * (c->u - a->u);
}

static double area_at(const ring *r, const corner *c) {
    return area(&r->corners[c->before], c, &r->corners[c->after]);
}

/* Sets the corners in the plane of the two axes along which the polygon is widest, counter-clockwise. */
static void set_corners(ring *r, const iso_fan *fan, const float (*points)[3], uint32_t (*triangles)[3],
                        iso_vec3 normal) {
    const double n[3] = {normal.x, normal.y, normal.z};
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(n[i]) > fabs(n[axis])) axis = i;
    const int u = (axis + (n[axis] > 0 ? 1 : 2)) % 3, v = (axis + (n[axis] > 0 ? 2 : 1)) % 3;
    const uint32_t count = (uint32_t)fan->corners;
    r->count = r->left = count;
    r->steps = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *t = triangles[fan->first + (i < 2 ? 0 : i - 2)], point = t[i < 2 ? i : 2];
        const float *p = points[point];
        r->corners[i] = (corner){.u = (double)p[u],
                                 .v = (double)p[v],
                                 .point = point,
                                 .before = i ? i - 1 : count - 1,
                                 .after = i + 1 < count ? i + 1 : 0,
                                 .blocker = i,
                                 .left = true};
    }
    for (uint32_t i = 0; i < count; i++) r->corners[i].obtuse = !(area_at(r, &r->corners[i]) > 0);
}

static int cell_along(const ring *r, double at, int axis) {
    const double cell = (at - r->lo[axis]) * r->scale;
    return cell > 0 ? cell < r->across ? (int)cell : r->across - 1 : 0;
}

static size_t cell_of(const ring *r, const corner *c) {
    return (size_t)cell_along(r, c->v, 1) * (size_t)r->across + (size_t)cell_along(r, c->u, 0);
}

/* Lists the obtuse corners by cells: a counting sort. */
static void list_cells(ring *r) {
    double hi[2] = {-INFINITY, -INFINITY};
    r->lo[0] = r->lo[1] = INFINITY;
    for (size_t i = 0; i < r->count; i++) {
        const double at[2] = {r->corners[i].u, r->corners[i].v};
        for (int k = 0; k < 2; k++) {
            r->lo[k] = fmin(r->lo[k], at[k]);
            hi[k] = fmax(hi[k], at[k]);
        }
    }
    r->across = (int)fmin(sqrt((double)r->count), MOST_ACROSS);
    r->scale = r->across / fmax(hi[0] - r->lo[0], hi[1] - r->lo[1]);
    const size_t cells = (size_t)r->across * (size_t)r->across;
    memset(r->first, 0, (cells + 1) * sizeof *r->first);
    for (size_t i = 0; i < r->count; i++)
        if (r->corners[i].obtuse) r->first[cell_of(r, &r->corners[i])]++;
    uint32_t total = 0;
    for (size_t i = 0; i <= cells; i++) r->first[i] = total += r->first[i];
    for (size_t i = r->count; i-- > 0;)
        if (r->corners[i].obtuse) r->listed[--r->first[cell_of(r, &r->corners[i])]] = (uint32_t)i;
}

/* ---- ears */

/* Which corners are clipped. When none is left, the next kind is, until the polygon is divided. */
typedef enum kind {
    FREE,    /* ears that no other corner touches, so that every corner has a triangle with an area */
    TOUCHED, /* ears */
    CONVEX,  /* the outline crosses itself: triangles that have an area */
    ANY
} kind;

/* Whether the obtuse corner q prevents that the triangle of three corners is clipped: it lies inside, or on
 * its border, and, unless `touch` is enough, has a neighbour in a direction that leads inside. */
static bool blocks(const ring *r, const corner *const triangle[3], const corner *q, bool touch) {
    const corner *ends[2] = {&r->corners[q->before], &r->corners[q->after]};
    bool inside[2] = {true, true};
    int sides = 0;
    for (int k = 0; k < 3; k++) {
        const corner *a = triangle[k], *b = triangle[(k + 1) % 3];
        const double beside = area(a, b, q);
        if (beside < 0) return false;
        if (beside > 0) continue;
        sides++;
        for (int i = 0; i < 2; i++)
            inside[i] &= (b->u - a->u) * (ends[i]->v - q->v) - (b->v - a->v) * (ends[i]->u - q->u) > 0;
    }
    return inside[0] || inside[1] || (touch && sides == 1); /* on two sides: at a corner of the triangle */
}

static bool is_blocked(const ring *r, const corner *const triangle[3], uint32_t by, bool touch) {
    const corner *q = &r->corners[by];
    return q->left && q->obtuse && q != triangle[0] && q != triangle[2] && blocks(r, triangle, q, touch);
}

/* Whether the triangle of a corner and its neighbours can be clipped. */
static bool is_ear(ring *r, corner *c, bool touch) {
    const corner *a = &r->corners[c->before], *b = &r->corners[c->after];
    const corner *const triangle[3] = {a, c, b};
    if (!(area(a, c, b) > 0)) return false;
    if (is_blocked(r, triangle, c->blocker, touch)) return false;
    const int u0 = cell_along(r, fmin(fmin(a->u, b->u), c->u), 0),
              u1 = cell_along(r, fmax(fmax(a->u, b->u), c->u), 0),
              v0 = cell_along(r, fmin(fmin(a->v, b->v), c->v), 1),
              v1 = cell_along(r, fmax(fmax(a->v, b->v), c->v), 1);
    for (int v = v0; v <= v1; v++) {
        const uint32_t *first = r->first + (size_t)v * (size_t)r->across;
        r->steps += (uint64_t)(u1 - u0) / 8 + first[u1 + 1] - first[u0];
        for (uint32_t i = first[u0]; i < first[u1 + 1]; i++) {
            if (!is_blocked(r, triangle, r->listed[i], touch)) continue;
            c->blocker = r->listed[i];
            return false;
        }
    }
    return true;
}

/* Whether the outline turns back at a corner, which then encloses nothing. */
static bool is_spike(const ring *r, const corner *c) {
    const corner *a = &r->corners[c->before], *b = &r->corners[c->after];
    return area(a, c, b) == 0 && (a->u - c->u) * (b->u - c->u) + (a->v - c->v) * (b->v - c->v) >= 0;
}

/* Clips a corner: writes its triangle. */
static void clip(ring *r, corner *c, uint32_t triangle[3]) {
    corner *a = &r->corners[c->before], *b = &r->corners[c->after];
    triangle[0] = a->point;
    triangle[1] = c->point;
    triangle[2] = b->point;
    a->after = c->after;
    b->before = c->before;
    c->left = false;
    r->left--;
    a->obtuse = a->obtuse && !(area_at(r, a) > 0);
    b->obtuse = b->obtuse && !(area_at(r, b) > 0);
}

static bool can_clip(ring *r, corner *c, kind which) {
    r->steps++;
    if (which >= CONVEX) return which == ANY || area_at(r, c) > 0;
    return is_spike(r, c) || is_ear(r, c, which == FREE);
}

/* Returns the next corner to clip from `c` on. */
static corner *next_corner(ring *r, corner *c, kind *which) {
    for (;; (*which)++)
        for (size_t i = 0; i < r->left; i++, c = &r->corners[c->after])
            if (can_clip(r, c, *which)) return c;
}

/* Divides the polygon; false: it takes too many steps. */
static bool divide(ring *r, uint32_t (*triangles)[3]) {
    const uint64_t most = (uint64_t)STEPS * r->count;
    corner *c = r->corners;
    kind which = FREE;
    while (r->left > 2) {
        c = next_corner(r, c, &which);
        if (r->steps > most && r->count > STEPS) return false;
        clip(r, c, *triangles++);
        c = &r->corners[r->corners[c->after].after]; /* one is left out: triangles are less thin */
    }
    return true;
}

/* ---- all polygons */

static iso_status divide_wrong(const char *path, ring *r, const iso_fan *fans, size_t count,
                               const float (*points)[3], uint32_t (*triangles)[3], iso_error *error) {
    for (size_t i = 0; i < count; i++) {
        iso_vec3 normal;
        if (!fan_is_wrong(&fans[i], points, triangles, &normal)) continue;
        set_corners(r, &fans[i], points, triangles, normal);
        list_cells(r);
        if (!divide(r, triangles + fans[i].first))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a face of %zu corners is too intricate", path,
                            fans[i].corners);
    }
    return ISO_OK;
}

iso_status iso_fans_divide(const char *path, const iso_fan *fans, size_t count, const float (*points)[3],
                           uint32_t (*triangles)[3], iso_error *error) {
    size_t most = 0;
    for (size_t i = 0; i < count; i++) most = fans[i].corners > most ? fans[i].corners : most;
    if (most == 0) return ISO_OK;
    const size_t cells = most < MOST_ACROSS * MOST_ACROSS ? most : MOST_ACROSS * MOST_ACROSS;
    ring r = {.corners = iso_alloc(most * sizeof *r.corners),
              .first = iso_alloc((cells + 1) * sizeof *r.first),
              .listed = iso_alloc(most * sizeof *r.listed)};
    iso_status status = r.corners && r.first && r.listed
                            ? divide_wrong(path, &r, fans, count, points, triangles, error)
                            : iso_fail_memory(error, path);
    iso_free(r.corners);
    iso_free(r.first);
    iso_free(r.listed);
    return status;
}
