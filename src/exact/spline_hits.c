/* spline_hits: sorts the samples of tiles of the picture by cell, so that each cell's polynomial is computed
 * once a tile, and its samples are moved together. */
#include "exact/spline_hits.h"

#include <math.h>
#include <string.h>

#include "base/kernel_units.h"
#include "exact/spline_hits_kernel.h"

enum { TILE = 16, SAMPLES = TILE * TILE, SLOTS = 2 * SAMPLES, NONE = -1 };

typedef struct moving {
    const iso_target *target;
    const iso_spline *spline;
    float isovalue;
    double outward; /* from gradient to outward normal */
    iso_affine affine;
    int cells[3]; /* the last cell on each axis */
    iso_spline_hits_fn *move;
} moving;

/* The samples of a tile. */
typedef struct tile {
    int count, cells;
    size_t sample[SAMPLES];
    float at[SAMPLES][3], step[SAMPLES][3];
    int16_t next[SAMPLES];                 /* of the same cell; NONE: it is the last */
    int cell[SAMPLES][3];                  /* the cells, in the order of their first samples */
    int16_t first[SAMPLES], last[SAMPLES]; /* samples of the cell */
    int16_t slot[SLOTS];                   /* hash table of cells; NONE: free */
} tile;

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

static void add_sample(const moving *m, tile *t, int x, int y, size_t sample) {
    iso_vec3 origin, direction;
    iso_view_ray(m->target->view, x + 0.5, y + 0.5, &origin, &direction);
    const double depth = (double)m->target->gbuffer->depth[sample];
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
    t->sample[number] = sample;
    t->next[number] = NONE;
    if (t->first[found] == NONE)
        t->first[found] = (int16_t)number;
    else
        t->next[t->last[found]] = (int16_t)number;
    t->last[found] = (int16_t)number;
}

static void write_sample(const moving *m, const iso_spline_hits *hits, int i, size_t sample) {
    iso_gbuffer *gbuffer = m->target->gbuffer;
    const iso_vec3 gradient = iso_vec3_make((double)hits->gradient[0][i], (double)hits->gradient[1][i],
                                            (double)hits->gradient[2][i]);
    const iso_vec3 normal = iso_affine_normal(&m->affine, iso_vec3_scale(gradient, m->outward));
    gbuffer->depth[sample] = (float)((double)gbuffer->depth[sample] + (double)hits->shift[i]);
    if (!(iso_vec3_dot(normal, normal) > 0)) return;
    const iso_vec3 n = iso_view_vector(m->target->view, normal);
    gbuffer->normal[0][sample] = (float)n.x;
    gbuffer->normal[1][sample] = (float)n.y;
    gbuffer->normal[2][sample] = (float)n.z;
}

/* Moves the samples in one cell. */
static void move_cell(const moving *m, const tile *t, int cell) {
    iso_spline_hits hits = {.smooths = iso_spline_has_smoothed_normals(m->spline), .isovalue = m->isovalue};
    float values[ISO_SPLINE_VOXELS];
    hits.prefilter = iso_spline_cell_values(m->spline, t->cell[cell], values, hits.smoothed);
    for (int number = t->first[cell]; number != NONE;) {
        size_t sample[ISO_SPLINE_HITS];
        memcpy(hits.values, values, sizeof values);
        memset(hits.at, 0, sizeof hits.at);
        memset(hits.step, 0, sizeof hits.step);
        for (hits.count = 0; hits.count < ISO_SPLINE_HITS && number != NONE; number = t->next[number]) {
            for (int i = 0; i < 3; i++) {
                hits.at[i][hits.count] = t->at[number][i];
                hits.step[i][hits.count] = t->step[number][i];
            }
            sample[hits.count++] = t->sample[number];
        }
        m->move(&hits);
        for (int i = 0; i < hits.count; i++) write_sample(m, &hits, i, sample[i]);
    }
}

static void move_tiles(void *context, size_t index, int worker) {
    (void)worker;
    const moving *m = context;
    const iso_gbuffer *gbuffer = m->target->gbuffer;
    const int y0 = (int)index * TILE, y1 = y0 + TILE < gbuffer->height ? y0 + TILE : gbuffer->height;
    for (int x0 = 0; x0 < gbuffer->width; x0 += TILE) {
        const int x1 = x0 + TILE < gbuffer->width ? x0 + TILE : gbuffer->width;
        tile t;
        t.count = t.cells = 0;
        memset(t.slot, 0xff, sizeof t.slot);
        for (int y = y0; y < y1; y++)
            for (int x = x0; x < x1; x++) {
                const size_t sample = (size_t)y * (size_t)gbuffer->width + (size_t)x;
                if (gbuffer->surface[sample] == m->target->surface) add_sample(m, &t, x, y, sample);
            }
        for (int cell = 0; cell < t.cells; cell++) move_cell(m, &t, cell);
    }
}

void iso_exact_move_to_spline(const iso_target *target, const iso_spline *spline, double isovalue) {
    const iso_grid *grid = iso_spline_grid(spline);
    const int *dims = iso_grid_dims(grid);
    moving m = {.target = target,
                .spline = spline,
                .isovalue = (float)isovalue,
                .outward = iso_grid_is_level_set(grid) ? 1 : -1,
                .affine = iso_transform_affine(iso_grid_transform(grid)),
                .cells = {dims[0] - 2, dims[1] - 2, dims[2] - 2},
                .move = ISO_KERNEL_UNIT(iso_spline_hits_units, iso_cpu_best())};
    iso_parallel_until(target->pool, ((size_t)target->gbuffer->height + TILE - 1) / TILE, move_tiles, &m);
}
