/* spline_hits: sorts the samples of tiles of the picture by cell, so that each cell's polynomial is computed
 * once a tile, and its samples are moved together. */
#include "exact/spline_hits.h"

#include <math.h>
#include <string.h>

#include "base/kernel_units.h"
#include "exact/spline_hits_kernel.h"

enum { TILE = 16, SAMPLES = TILE * TILE, SLOTS = 2 * SAMPLES, NONE = -1, PASSES = 4 };

typedef struct moving {
    const iso_target *target;
    const iso_exact_spline *of;
    double outward; /* from gradient to outward normal */
    iso_affine affine;
    int cells[3]; /* the last cell on each axis */
    bool smooths;
    double before; /* mm: how far before the shell rays are traced from */
    iso_spline_hits_fn *move;
} moving;

typedef struct tile_sample {
    size_t index;        /* in the gbuffer */
    float shell, toward; /* depth of the shell; iso_spline_hits.toward */
} tile_sample;

/* The samples of a tile. */
typedef struct tile {
    int count, cells, again_count;
    tile_sample sample[SAMPLES], again[SAMPLES]; /* again: to be moved on from another cell */
    float at[SAMPLES][3], step[SAMPLES][3];
    int16_t next[SAMPLES];                 /* of the same cell; NONE: it is the last */
    int cell[SAMPLES][3];                  /* the cells, in the order of their first samples */
    int16_t first[SAMPLES], last[SAMPLES]; /* samples of the cell */
    int16_t slot[SLOTS];                   /* hash table of cells; NONE: free */
} tile;

static void clear_tile(tile *t) {
    t->count = t->cells = t->again_count = 0;
    memset(t->slot, 0xff, sizeof t->slot);
}

static int16_t find_cell(tile *t, const int cell[3]) {
    const uint32_t key =
        (uint32_t)cell[0] * 73856093u ^ (uint32_t)cell[1] * 19349663u ^ (uint32_t)cell[2] * 83492791u;
    for (uint32_t s = key % SLOTS;; s = (s + 1) % SLOTS) {
        if (t->slot[s] == NONE) {
            memcpy(t->cell[t->cells], cell, sizeof t->cell[0]);
            t->first[t->cells] = NONE;
            return t->slot[s] = (int16_t)t->cells++;
        }
        if (memcmp(t->cell[t->slot[s]], cell, sizeof t->cell[0]) == 0) return t->slot[s];
    }
}

static void view_ray(const moving *m, size_t sample, iso_vec3 *origin, iso_vec3 *direction) {
    const size_t width = (size_t)m->target->gbuffer->width;
    iso_view_ray(m->target->view, (double)(sample % width) + 0.5, (double)(sample / width) + 0.5, origin,
                 direction);
}

static bool shows(const moving *m, iso_vec3 origin, iso_vec3 direction, double t) {
    const iso_clip *clip = m->target->clip;
    return !clip || iso_clip_shows(clip, iso_vec3_add(origin, iso_vec3_scale(direction, t)));
}

static void add_sample(const moving *m, tile *t, tile_sample added) {
    iso_vec3 origin, direction;
    view_ray(m, added.index, &origin, &direction);
    const double depth = (double)m->target->gbuffer->depth[added.index];
    const iso_vec3 p = iso_affine_point_to_index(&m->affine,
                                                 iso_vec3_add(origin, iso_vec3_scale(direction, depth))),
                   d = iso_affine_vector_to_index(&m->affine, direction);
    const double at[3] = {p.x, p.y, p.z}, step[3] = {d.x, d.y, d.z};
    const int number = t->count++;
    int cell[3];
    for (int i = 0; i < 3; i++) {
        const double low = fmin(fmax(floor(at[i]), 0), m->cells[i]);
        cell[i] = (int)low;
        t->at[number][i] = (float)(at[i] - low);
        t->step[number][i] = (float)step[i];
    }
    const int16_t found = find_cell(t, cell);
    t->sample[number] = added;
    t->next[number] = NONE;
    if (t->first[found] == NONE)
        t->first[found] = (int16_t)number;
    else
        t->next[t->last[found]] = (int16_t)number;
    t->last[found] = (int16_t)number;
}

/* Normal: in world space, or 0: the sample keeps the shell's. */
static void write_sample(const moving *m, size_t sample, double depth, iso_vec3 normal) {
    iso_gbuffer *gbuffer = m->target->gbuffer;
    gbuffer->depth[sample] = (float)depth;
    if (!(iso_vec3_dot(normal, normal) > 0)) return;
    const iso_vec3 n = iso_view_vector(m->target->view, normal);
    gbuffer->normal[0][sample] = (float)n.x;
    gbuffer->normal[1][sample] = (float)n.y;
    gbuffer->normal[2][sample] = (float)n.z;
}

/* Draws a sample by tracing its ray: from the shell if it has entered that there, else from its beginning. */
static void trace_sample(const moving *m, const tile_sample *from) {
    const size_t sample = from->index;
    const iso_ray_tracer *tracer = m->of->tracer;
    iso_vec3 origin, direction;
    iso_ray ray;
    iso_ray_hit hit;
    view_ray(m, sample, &origin, &direction);
    const double toward = iso_vec3_dot(iso_gbuffer_normal(m->target->gbuffer, sample),
                                       iso_view_vector(m->target->view, direction)),
                 first = toward < 0 ? (double)from->shell - m->before : m->target->view->near;
    bool found = iso_ray_start(tracer, origin, direction, first, &ray);
    do found = found && iso_ray_next(tracer, &ray, &hit);
    while (found && !shows(m, origin, direction, hit.t));
    if (found) {
        write_sample(m, sample, hit.t, iso_ray_hit_normal(tracer, &ray, &hit));
    } else {
        m->target->gbuffer->depth[sample] = INFINITY;
        m->target->gbuffer->surface[sample] = ISO_SURFACE_NONE;
    }
}

static void use_hit(const moving *m, tile *t, const iso_spline_hits *hits, int i, const tile_sample *from) {
    const size_t sample = from->index;
    const double depth = (double)m->target->gbuffer->depth[sample] + (double)hits->shift[i];
    if (hits->state[i] == ISO_SPLINE_AGAIN) {
        m->target->gbuffer->depth[sample] = (float)depth;
        t->again[t->again_count] = *from;
        t->again[t->again_count++].toward = hits->toward[i];
        return;
    }
    bool moved = hits->state[i] == ISO_SPLINE_MOVED;
    if (moved && m->target->clip) {
        iso_vec3 origin, direction;
        view_ray(m, sample, &origin, &direction);
        moved = shows(m, origin, direction, depth);
    }
    if (!moved) {
        trace_sample(m, from);
        return;
    }
    const iso_vec3 gradient = {(double)hits->gradient[0][i], (double)hits->gradient[1][i],
                               (double)hits->gradient[2][i]};
    write_sample(m, sample, depth, iso_affine_normal(&m->affine, iso_vec3_scale(gradient, m->outward)));
}

/* Moves the samples in one cell. */
static void move_cell(const moving *m, tile *t, int cell) {
    iso_spline_hits hits;
    int number_of[SAMPLES];
    hits.smooths = m->smooths;
    hits.isovalue = (float)m->of->isovalue;
    hits.prefilter =
        iso_spline_cell_values(m->of->spline, t->cell[cell], hits.values, m->smooths ? hits.smoothed : NULL);
    hits.count = 0;
    for (int number = t->first[cell]; number != NONE; number = t->next[number]) {
        for (int i = 0; i < 3; i++) {
            hits.at[i][hits.count] = t->at[number][i];
            hits.step[i][hits.count] = t->step[number][i];
        }
        hits.toward[hits.count] = t->sample[number].toward;
        number_of[hits.count++] = number;
    }
    m->move(&hits);
    for (int i = 0; i < hits.count; i++) use_hit(m, t, &hits, i, &t->sample[number_of[i]]);
}

static void move_tile(const moving *m, tile *t) {
    for (int pass = 1; t->count; pass++) {
        tile_sample again[SAMPLES];
        for (int cell = 0; cell < t->cells; cell++) move_cell(m, t, cell);
        const int count = t->again_count;
        memcpy(again, t->again, (size_t)count * sizeof *again);
        clear_tile(t);
        for (int i = 0; i < count; i++)
            if (pass < PASSES)
                add_sample(m, t, again[i]);
            else
                trace_sample(m, &again[i]);
    }
}

static void move_tiles(void *context, size_t index, int worker) {
    (void)worker;
    const moving *m = context;
    const iso_gbuffer *gbuffer = m->target->gbuffer;
    const int y0 = (int)index * TILE, y1 = y0 + TILE < gbuffer->height ? y0 + TILE : gbuffer->height;
    tile t;
    clear_tile(&t);
    for (int x0 = 0; x0 < gbuffer->width; x0 += TILE) {
        const int x1 = x0 + TILE < gbuffer->width ? x0 + TILE : gbuffer->width;
        for (int y = y0; y < y1; y++)
            for (int x = x0; x < x1; x++) {
                const size_t at = (size_t)y * (size_t)gbuffer->width + (size_t)x;
                if (gbuffer->surface[at] == m->target->surface)
                    add_sample(m, &t, (tile_sample){at, gbuffer->depth[at], 0});
            }
        move_tile(m, &t);
    }
}

/* Draws into a gbuffer in which nothing is drawn yet. */
static iso_status draw_alone(const iso_target *target, const iso_exact_spline *of, iso_error *error) {
    const iso_grid *grid = iso_spline_grid(of->spline);
    const int *dims = iso_grid_dims(grid);
    const double *spacing = iso_grid_transform(grid)->spacing;
    moving m = {.target = target,
                .of = of,
                .outward = iso_grid_is_level_set(grid) ? 1 : -1,
                .affine = iso_transform_affine(iso_grid_transform(grid)),
                .cells = {dims[0] - 2, dims[1] - 2, dims[2] - 2},
                .before = 0.01 * fmin(spacing[0], fmin(spacing[1], spacing[2])),
                .smooths = iso_spline_has_smoothed_normals(of->spline),
                .move = ISO_KERNEL_UNIT(iso_spline_hits_units, iso_cpu_best())};
    ISO_TRY(iso_draw_exact(target, of->shell, error));
    iso_parallel_until(target->pool, ((size_t)target->gbuffer->height + TILE - 1) / TILE, move_tiles, &m);
    return ISO_OK;
}

/* The shell hides more than the surface does, so that beside other surfaces it is drawn alone. */
iso_status iso_draw_exact_spline(const iso_target *target, const iso_exact_spline *of, iso_error *error) {
    iso_gbuffer *to = target->gbuffer, alone;
    const size_t samples = (size_t)to->width * (size_t)to->height;
    bool empty = true;
    for (size_t i = 0; i < samples && empty; i++) empty = to->surface[i] == ISO_SURFACE_NONE;
    if (empty) return draw_alone(target, of, error);
    ISO_TRY(iso_gbuffer_create(to->width, to->height, &alone, error));
    iso_gbuffer_clear_bands(&alone, target->pool);
    iso_target beside = *target;
    beside.gbuffer = &alone;
    const iso_status status = draw_alone(&beside, of, error);
    for (size_t i = 0; i < samples && status == ISO_OK; i++) {
        if (!(alone.depth[i] < to->depth[i])) continue;
        to->depth[i] = alone.depth[i];
        to->surface[i] = alone.surface[i];
        for (int axis = 0; axis < 3; axis++) to->normal[axis][i] = alone.normal[axis][i];
    }
    iso_gbuffer_free(&alone);
    return status;
}
