/* copies: adds points to groups until each group covers the surface (Zhang and Pajarola 2006, section 4.2.2,
 * method 1).
 *
 * The paper does not say how the part of a disc is computed that a group's discs overlap, nor when it is too
 * large for a copy. Here each disc has 32 samples, spread evenly by the golden angle, and a sample is
 * overlapped by discs that do not face the opposite way and whose centre is nearer than their radius. Which
 * samples are overlapped is kept up to date for all points, so that priorities need no second look. */
#include "render/groups/copies.h"

#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "base/point_cells.h"
#include "render/groups/disc_samples.h"

enum {
    SAMPLES = ISO_DISC_SAMPLES,
    MOST_OVERLAPPED = 28, /* samples of a disc that gets a copy. With 18 / 23 / 27 / 30 algorithm 2 is 27.0 /
                             28.8 / 30.8 / 32.0 dB from sorted layers (a bear, 4 groups, 7 to 150 % of
                             the points copied; enlarged radii: 28.4) */
    /* Where thousands of discs overlap: how many points around a point are looked at, and kept. */
    LOOKED_AT = 4096,
    NEIGHBOURS = 1024
};

static const uint32_t NONE = UINT32_MAX;

typedef struct copying {
    const iso_point_view *view;
    iso_point_cells cells;
    float (*normals)[3]; /* of the cells' points, world space */
    iso_groups *groups;
    uint32_t *neighbours; /* those of point i are start[i] .. start[i + 1] - 1 */
    size_t *start;
    uint16_t *found; /* of each point: number of neighbours so far */
    float samples[SAMPLES][2];
    atomic_bool failed;
} copying;

/* ---- neighbours */

static const iso_cell_point *points_of(const copying *c) {
    return c->cells.points.data;
}

static iso_status list_normals(copying *c, iso_error *error) {
    const iso_affine affine = iso_transform_affine(&c->view->transform);
    c->normals = iso_alloc(c->cells.point_count * sizeof *c->normals);
    if (!c->normals) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for copies of points");
    for (size_t i = 0; i < c->cells.point_count; i++) {
        const iso_surfel s = iso_point_view_get(c->view, points_of(c)[i].index);
        const iso_vec3 n = iso_affine_normal(&affine, iso_vec3_make(s.normal[0], s.normal[1], s.normal[2]));
        c->normals[i][0] = (float)n.x;
        c->normals[i][1] = (float)n.y;
        c->normals[i][2] = (float)n.z;
    }
    return ISO_OK;
}

/* Whether the discs of two points can overlap. */
static bool are_neighbours(const copying *c, uint32_t a, uint32_t b) {
    const iso_cell_point *at = &points_of(c)[a], *to = &points_of(c)[b];
    const float reach = at->reach + to->reach;
    float square = 0, cosine = 0;
    for (int k = 0; k < 3; k++) {
        const float offset = to->position[k] - at->position[k];
        square += offset * offset;
        cosine += c->normals[a][k] * c->normals[b][k];
    }
    return a != b && square < reach * reach && cosine >= 0;
}

/* Adds b to the neighbours of a; without `neighbours` only to their number, start[a + 2]. */
static void add_neighbour(copying *c, uint32_t a, uint32_t b) {
    if (c->found[a] == NEIGHBOURS) return;
    c->found[a]++;
    if (c->neighbours)
        c->neighbours[c->start[a + 1]++] = b;
    else
        c->start[a + 2]++;
}

/* Adds pairs of a point and those of some ranges. Points find those of their own and of coarser levels; the
 * latter, in the first `coarser` ranges, are told. */
static void add_pairs(copying *c, uint32_t a, const iso_cell_range *around, int count, int coarser) {
    uint32_t looked = 0;
    for (int r = 0; r < count; r++)
        for (uint32_t b = around[r].first; b < around[r].end && looked < LOOKED_AT; b++, looked++) {
            if (!are_neighbours(c, a, b)) continue;
            add_neighbour(c, a, b);
            if (r < coarser) add_neighbour(c, b, a);
        }
}

static void find_neighbours(copying *c) {
    const iso_point_cell *cells = c->cells.cells.data;
    iso_cell_range around[ISO_CELL_RANGES];
    memset(c->found, 0, c->cells.point_count * sizeof *c->found);
    for (uint32_t cell = 0; cell < c->cells.cell_count; cell++) {
        int coarser;
        const int count = iso_point_cells_all_around(&c->cells, cell, around, &coarser);
        for (uint32_t a = cells[cell].first; a < cells[cell + 1].first; a++)
            add_pairs(c, a, around, count, coarser);
    }
}

static iso_status list_neighbours(copying *c, iso_error *error) {
    const size_t count = c->cells.point_count;
    c->start = iso_alloc_zero(count + 2, sizeof *c->start);
    c->found = iso_alloc(count * sizeof *c->found);
    if (!c->start || !c->found) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for copies of points");
    find_neighbours(c);
    for (size_t i = 2; i < count + 2; i++) c->start[i] += c->start[i - 1];
    c->neighbours = iso_alloc(c->start[count + 1] * sizeof *c->neighbours);
    if (!c->neighbours) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for copies of points");
    find_neighbours(c);
    return ISO_OK;
}

/* ---- one group */

/* A point that is not in the group. */
typedef struct waiting {
    float u[3], v[3];    /* tangents times the radius */
    uint32_t overlapped; /* bit by sample */
    uint32_t next, last; /* in the queue of its number of overlapped samples */
    bool queued;
} waiting;

typedef struct filling {
    const copying *c;
    waiting *points;
    uint32_t first[SAMPLES + 1]; /* of the queues; NONE: empty */
} filling;

static void unlink_point(filling *f, uint32_t at) {
    waiting *w = &f->points[at];
    if (w->last == NONE)
        f->first[__builtin_popcount(w->overlapped)] = w->next;
    else
        f->points[w->last].next = w->next;
    if (w->next != NONE) f->points[w->next].last = w->last;
    w->queued = false;
}

static void link_point(filling *f, uint32_t at) {
    waiting *w = &f->points[at];
    uint32_t *first = &f->first[__builtin_popcount(w->overlapped)];
    w->last = NONE;
    w->next = *first;
    if (*first != NONE) f->points[*first].last = at;
    *first = at;
    w->queued = true;
}

/* Returns which samples of a waiting point a disc overlaps. */
static uint32_t overlap(const filling *f, uint32_t of, uint32_t by) {
    const iso_cell_point *points = points_of(f->c), *at = &points[of], *disc = &points[by];
    const waiting *w = &f->points[of];
    uint32_t found = 0;
    for (int s = 0; s < SAMPLES; s++) {
        const float x = f->c->samples[s][0], y = f->c->samples[s][1];
        float square = 0;
        for (int k = 0; k < 3; k++) {
            const float d = at->position[k] + x * w->u[k] + y * w->v[k] - disc->position[k];
            square += d * d;
        }
        found |= (uint32_t)(square < disc->reach * disc->reach) << s;
    }
    return found;
}

/* Tells the neighbours of a point that it is in the group now. queues: they are in queues. */
static void overlap_neighbours(filling *f, uint32_t point, bool queues) {
    const copying *c = f->c;
    for (size_t i = c->start[point]; i < c->start[point + 1]; i++) {
        const uint32_t at = c->neighbours[i];
        waiting *w = &f->points[at];
        if (queues && !w->queued) continue;
        const uint32_t overlapped = w->overlapped | overlap(f, at, point);
        if (queues && overlapped != w->overlapped) {
            unlink_point(f, at);
            w->overlapped = overlapped;
            if (__builtin_popcount(overlapped) <= MOST_OVERLAPPED) link_point(f, at);
        }
        w->overlapped = overlapped;
    }
}

/* Returns the queued point of which the largest part is overlapped; NONE: no point is queued. */
static uint32_t most_overlapped(const filling *f) {
    for (int i = MOST_OVERLAPPED; i >= 0; i--)
        if (f->first[i] != NONE) return f->first[i];
    return NONE;
}

static void fill_with_copies(filling *f, int group) {
    const copying *c = f->c;
    const iso_cell_point *points = points_of(c);
    const uint32_t count = (uint32_t)c->cells.point_count;
    for (uint32_t i = 0; i < count; i++) {
        iso_curvature_frame(c->normals[i], f->points[i].u, f->points[i].v);
        for (int k = 0; k < 3; k++) {
            f->points[i].u[k] *= points[i].reach;
            f->points[i].v[k] *= points[i].reach;
        }
    }
    for (uint32_t i = 0; i < count; i++)
        if (c->groups->group[points[i].index] == group) overlap_neighbours(f, i, false);
    for (int i = 0; i <= SAMPLES; i++) f->first[i] = NONE;
    for (uint32_t i = count; i-- > 0;)
        if (c->groups->group[points[i].index] != group &&
            __builtin_popcount(f->points[i].overlapped) <= MOST_OVERLAPPED)
            link_point(f, i);
    for (uint32_t at = most_overlapped(f); at != NONE; at = most_overlapped(f)) {
        unlink_point(f, at);
        __atomic_fetch_or(&c->groups->copies[points[at].index], (uint64_t)1 << group, __ATOMIC_RELAXED);
        overlap_neighbours(f, at, true);
    }
}

/* The callback of iso_parallel_for. */
static void fill_group(void *context, size_t group, int worker) {
    (void)worker;
    copying *c = context;
    filling f = {.c = c, .points = iso_alloc_zero(c->cells.point_count, sizeof *f.points)};
    if (f.points)
        fill_with_copies(&f, (int)group);
    else
        atomic_store(&c->failed, true);
    iso_free(f.points);
}

static iso_status add_copies(copying *c, iso_pool *pool, iso_error *error) {
    ISO_TRY(list_normals(c, error));
    ISO_TRY(list_neighbours(c, error));
    c->groups->copies = iso_alloc_zero(iso_groups_length(c->view), sizeof *c->groups->copies);
    if (!c->groups->copies) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for copies of points");
    iso_spread_disc_samples(c->samples);
    iso_parallel_for(pool, (size_t)c->groups->count, fill_group, c);
    if (atomic_load(&c->failed)) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for copies of points");
    for (size_t i = 0; i < iso_groups_length(c->view); i++)
        c->groups->copy_count += (size_t)__builtin_popcountll(c->groups->copies[i]);
    return ISO_OK;
}

iso_status iso_groups_copy(const iso_point_view *view, double disc, iso_pool *pool, iso_groups *groups,
                           iso_error *error) {
    copying c = {.view = view, .groups = groups};
    iso_status status = iso_point_cells_make(&c.cells, view, disc, error);
    if (status == ISO_OK) status = add_copies(&c, pool, error);
    iso_free(c.neighbours);
    iso_free(c.start);
    iso_free(c.found);
    iso_free(c.normals);
    iso_point_cells_free(&c.cells);
    return status;
}
