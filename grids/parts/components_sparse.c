/* Removes parts from a level set: their voxels become outside, and the distances around them are replaced.
 *
 * Outside values in the band of a dropped part are distances to a surface that no longer exists; if they
 * stayed, foot points would still be made of them. They are estimated anew from the kept voxels q nearby, as
 * the minimum of |p - q| + distance of q (negative inside). This is never smaller than the distance of p to
 * the kept parts, and close to it. */
#include "grids/parts/components_sparse.h"

#include <math.h>
#include <string.h>

#include "base/numbers.h"

/* An existing value is kept unless the estimate exceeds it by more than this (voxels). */
static const float TOLERANCE = 0.75f;
/* Kept voxels deeper than this are too far inside to give good estimates (voxels). */
static const float DEPTH = 1.8f;

typedef struct remover {
    iso_hgrid *grid;
    const iso_sparse_removal *removal;
    int reach;           /* the largest distance of a dropped voxel from a value that it determines, voxels */
    iso_buffer affected; /* uint32_t: numbers of cells */
    size_t count;
    float (*values)[ISO_BRICK_VOXELS]; /* new values of the affected cells */
    char *scratch;                     /* scratch_bytes for each worker */
    size_t scratch_bytes;
} remover;

/* A brick and the voxels around it, as far away as a dropped voxel can change a value of the brick. */
typedef struct surroundings {
    int side, low; /* voxels along each axis; index of the brick's first voxel along each axis */
    float *value;
    uint8_t *near;      /* 1: a dropped voxel can change this voxel's value */
    uint8_t *other;     /* working memory for `near` */
    int32_t (*kept)[3]; /* positions of the kept voxels near the surface */
    size_t kept_count;
} surroundings;

/* ---- marking */

/* Marks the cells of a run of a dropped part, and sets the run's voxels to INFINITY until they get their new
 * values. Empty cells have no voxels; such a cell belongs to one part entirely. */
static void mark_run(remover *r, iso_run run, int y, int z, uint8_t *dropped) {
    iso_hgrid *grid = r->grid;
    const size_t offset = ((size_t)(z % ISO_BRICK) * ISO_BRICK + (size_t)(y % ISO_BRICK)) * ISO_BRICK;
    for (int x = run.first; x <= run.last;) {
        const int cx = x / ISO_BRICK, end = (cx + 1) * ISO_BRICK;
        const size_t cell = iso_hgrid_cell_index(grid, cx, y / ISO_BRICK, z / ISO_BRICK);
        const int32_t brick = grid->cell[cell];
        dropped[cell] = 1;
        float *row = brick >= 0 ? iso_hgrid_brick(grid, brick) + offset : NULL;
        for (; x <= run.last && x < end; x++)
            if (row) row[x % ISO_BRICK] = INFINITY;
    }
}

static void mark_dropped(remover *r, uint8_t *dropped) {
    const iso_component_runs *runs = r->removal->runs;
    for (size_t s = 0; s < runs->slab_count; s++) {
        const iso_run_slab *slab = &runs->slabs[s];
        const iso_run *run = slab->runs.data;
        const uint32_t *rows = slab->rows, *component = runs->component + slab->base;
        for (int z = slab->z[0]; z < slab->z[1]; z++)
            for (int y = 0; y < runs->dims[1]; y++, rows++)
                for (uint32_t i = rows[0]; i < rows[1]; i++)
                    if (!r->removal->kept[component[i]]) mark_run(r, run[i], y, z, dropped);
    }
}

/* Whether a cell or one of its 26 neighbours contains dropped voxels. */
static bool is_affected(const iso_hgrid *grid, const int at[3], const uint8_t *dropped) {
    for (int z = at[2] - 1; z <= at[2] + 1; z++)
        for (int y = at[1] - 1; y <= at[1] + 1; y++)
            for (int x = at[0] - 1; x <= at[0] + 1; x++)
                if (x >= 0 && y >= 0 && z >= 0 && x < grid->cells[0] && y < grid->cells[1] &&
                    z < grid->cells[2] && dropped[iso_hgrid_cell_index(grid, x, y, z)])
                    return true;
    return false;
}

/* Makes empty cells of dropped parts outside, lists the bricks that may change, and records both in the log.
 */
static iso_status list_affected(remover *r, const uint8_t *dropped, iso_error *error) {
    iso_hgrid *grid = r->grid;
    const size_t cells = iso_hgrid_cell_count(grid);
    iso_change_log_begin(grid->log);
    for (size_t cell = 0; cell < cells; cell++) {
        int at[3], lo[3], hi[3];
        iso_hgrid_cell_position(grid, cell, at);
        const bool empty = grid->cell[cell] < 0;
        if (empty ? !dropped[cell] : !is_affected(grid, at, dropped)) continue;
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = at[axis] * ISO_BRICK;
            hi[axis] =
                lo[axis] + ISO_BRICK <= grid->dims[axis] ? lo[axis] + ISO_BRICK - 1 : grid->dims[axis] - 1;
        }
        ISO_TRY(iso_change_log_add(grid->log, lo, hi, error));
        if (empty) {
            iso_hgrid_coalesce(grid, at[0], at[1], at[2], ISO_CELL_OUTSIDE);
            continue;
        }
        ISO_TRY(iso_buffer_reserve(&r->affected, (r->count + 1) * sizeof(uint32_t),
                                   r->count * sizeof(uint32_t), error));
        ((uint32_t *)r->affected.data)[r->count++] = (uint32_t)cell;
    }
    return ISO_OK;
}

/* ---- distances to the kept parts */

static void read_surroundings(const remover *r, const int at[3], surroundings *s) {
    const iso_hgrid *grid = r->grid;
    const float inside = r->removal->at;
    s->kept_count = 0;
    size_t i = 0;
    for (int z = 0; z < s->side; z++)
        for (int y = 0; y < s->side; y++)
            for (int x = 0; x < s->side; x++, i++) {
                const int p[3] = {at[0] * ISO_BRICK + x - s->low, at[1] * ISO_BRICK + y - s->low,
                                  at[2] * ISO_BRICK + z - s->low};
                s->value[i] =
                    iso_hgrid_at(grid, iso_clamp_index(p[0], grid->dims[0]),
                                 iso_clamp_index(p[1], grid->dims[1]), iso_clamp_index(p[2], grid->dims[2]));
                s->near[i] = s->value[i] == INFINITY;
                if (!(s->value[i] < inside && s->value[i] > inside - DEPTH)) continue;
                int32_t *kept = s->kept[s->kept_count++];
                kept[0] = x, kept[1] = y, kept[2] = z;
            }
}

/* Marks in `to` the voxels within `reach` voxels, along one axis, of a voxel marked in `from`. `stride` leads
 * from one voxel to the next along this axis. */
static void widen(const surroundings *s, const uint8_t *from, uint8_t *to, int stride, int reach) {
    const int count = s->side * s->side * s->side;
    for (int i = 0; i < count; i++) {
        const int position = i / stride % s->side;
        const int low = position < reach ? position : reach,
                  high = s->side - 1 - position < reach ? s->side - 1 - position : reach;
        uint8_t any = 0;
        for (int k = -low; k <= high; k++) any |= from[i + k * stride];
        to[i] = any;
    }
}

/* Whether a face neighbour of voxel i is inside, and thus belongs to a kept part. */
static bool is_beside_kept(const surroundings *s, int i, float inside) {
    const int strides[3] = {1, s->side, s->side * s->side};
    for (int axis = 0; axis < 3; axis++)
        if (s->value[i - strides[axis]] < inside || s->value[i + strides[axis]] < inside) return true;
    return false;
}

/* Returns the estimate of the distance from p to the kept parts. */
static float estimate_distance(const surroundings *s, const int p[3]) {
    float least = INFINITY;
    for (size_t k = 0; k < s->kept_count; k++) {
        const int32_t *q = s->kept[k];
        const int x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
        const float d =
            sqrtf((float)(x * x + y * y + z * z)) + s->value[(q[2] * s->side + q[1]) * s->side + q[0]];
        if (d < least) least = d;
    }
    return least;
}

static float new_value(const remover *r, const surroundings *s, const int p[3]) {
    const int i = (p[2] * s->side + p[1]) * s->side + p[0];
    const float value = s->value[i], inside = r->removal->at, band = r->grid->band;
    if (value < inside || value == band || !s->near[i]) return value;
    if (value != INFINITY && is_beside_kept(s, i, inside)) return value;
    const float distance = estimate_distance(s, p);
    if (value != INFINITY && distance <= value + TOLERANCE) return value;
    /* The new value must not be inside (below the isovalue), even if the isovalue is larger than the band and
     * the clamp would make it so. */
    const float most = band > inside ? band : inside;
    return distance < inside ? inside : distance < most ? distance : most;
}

static void recompute_brick(void *context, size_t index, int worker) {
    remover *r = context;
    const uint32_t cell = ((const uint32_t *)r->affected.data)[index];
    const int side = ISO_BRICK + 2 * r->reach;
    const size_t count = (size_t)side * (size_t)side * (size_t)side;
    surroundings s = {.side = side,
                      .low = r->reach,
                      .value = (float *)(void *)(r->scratch + (size_t)worker * r->scratch_bytes)};
    s.kept = (int32_t(*)[3])(void *)(s.value + count);
    s.near = (uint8_t *)(s.kept + count);
    s.other = s.near + count;
    int at[3];
    iso_hgrid_cell_position(r->grid, cell, at);
    read_surroundings(r, at, &s);
    widen(&s, s.near, s.other, 1, r->reach);
    widen(&s, s.other, s.near, side, r->reach);
    widen(&s, s.near, s.other, side * side, r->reach);
    s.near = s.other;
    float *value = r->values[index];
    for (int z = 0; z < ISO_BRICK; z++)
        for (int y = 0; y < ISO_BRICK; y++)
            for (int x = 0; x < ISO_BRICK; x++)
                *value++ = new_value(r, &s, (const int[3]){x + s.low, y + s.low, z + s.low});
}

/* Computes all new bricks before it writes any, because the computation of neighbouring bricks must still see
 * which voxels are dropped. */
static iso_status remake_bricks(remover *r, iso_error *error) {
    const int side = ISO_BRICK + 2 * r->reach;
    const size_t count = (size_t)side * (size_t)side * (size_t)side;
    const size_t workers = (size_t)iso_pool_threads(r->removal->pool);
    r->scratch_bytes = count * (sizeof(float) + sizeof(int32_t[3]) + 2 * sizeof(uint8_t)) + ISO_ALIGNMENT;
    r->values = iso_alloc(r->count * sizeof *r->values);
    r->scratch = iso_alloc(workers * r->scratch_bytes);
    if (!r->values || !r->scratch)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu bricks around dropped parts", r->count);
    iso_parallel_for(r->removal->pool, r->count, recompute_brick, r);
    for (size_t i = 0; i < r->count; i++) {
        const uint32_t cell = ((const uint32_t *)r->affected.data)[i];
        memcpy(iso_hgrid_brick(r->grid, r->grid->cell[cell]), r->values[i], sizeof r->values[i]);
    }
    return ISO_OK;
}

iso_status iso_components_remove_sparse(iso_hgrid *grid, const iso_sparse_removal *removal,
                                        iso_error *error) {
    const float reach = ceilf(grid->band) + 2;
    remover r = {.grid = grid, .removal = removal, .reach = reach < ISO_BRICK ? (int)reach : ISO_BRICK};
    const size_t cells = iso_hgrid_cell_count(grid);
    uint8_t *dropped = iso_alloc_zero(cells, 1);
    if (!dropped) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the parts of the solid");
    mark_dropped(&r, dropped);
    iso_status status = list_affected(&r, dropped, error);
    if (status == ISO_OK) status = remake_bricks(&r, error);
    if (status == ISO_OK) iso_hgrid_prune(grid);
    iso_free(dropped);
    iso_free(r.values);
    iso_free(r.scratch);
    iso_buffer_free(&r.affected);
    return status;
}
