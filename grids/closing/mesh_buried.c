/* Corrects the distances of inside voxels near buried triangles, which lie inside the solid. The new distance
 * is the minimum, over the outside voxels nearby, of the distance to the outside voxel minus this voxel's own
 * distance. */
#include "grids/closing/mesh_buried.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"

/* If an inside voxel without outside neighbours is nearer than this to a triangle (voxels), the triangle is
 * taken to be inside the solid. */
static const float NEAR = 0.75f;
/* REACH: outside voxels up to this far away along each axis are used: 3 for the band, and 1 more. BATCH: the
 * number of cells whose new values are computed before they are written. */
enum { REACH = 4, BATCH = 256 };

typedef struct work {
    iso_hgrid *grid;
    const iso_closed_mesh *mesh;
    uint8_t *found;  /* by cell: whether a buried triangle was found in it */
    uint32_t *cells; /* the cells to correct */
    size_t first;    /* index in `cells` of the batch's first cell */
    float *values;   /* new values of the batch's bricks */
} work;

static float value_at(const iso_hgrid *grid, int x, int y, int z) {
    return iso_hgrid_at(grid, iso_clamp_index(x, grid->dims[0]), iso_clamp_index(y, grid->dims[1]),
                        iso_clamp_index(z, grid->dims[2]));
}

/* Whether any voxel of a box is outside. */
static bool has_outside(const iso_hgrid *grid, const int lo[3], const int hi[3]) {
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (value_at(grid, x, y, z) >= 0) return true;
    return false;
}

static void voxel_at(const int cell[3], int voxel, int at[3]) {
    at[0] = cell[0] * ISO_BRICK + voxel % ISO_BRICK;
    at[1] = cell[1] * ISO_BRICK + voxel / ISO_BRICK % ISO_BRICK;
    at[2] = cell[2] * ISO_BRICK + voxel / (ISO_BRICK * ISO_BRICK);
}

/* Looks in a cell for an inside voxel that is near a triangle although no voxel around it is outside. */
static void find_buried_in_cell(void *context, size_t cell, int worker) {
    const work *w = context;
    const int32_t number = w->grid->cell[cell];
    int at[3], p[3];
    (void)worker;
    if (number < 0) return;
    const float *brick = iso_hgrid_brick(w->grid, number);
    iso_hgrid_cell_position(w->grid, cell, at);
    for (int i = 0; i < ISO_BRICK_VOXELS && !w->found[cell]; i++) {
        if (brick[i] >= 0 || brick[i] < -NEAR) continue;
        voxel_at(at, i, p);
        const int lo[3] = {p[0] - 1, p[1] - 1, p[2] - 1}, hi[3] = {p[0] + 1, p[1] + 1, p[2] + 1};
        w->found[cell] = !has_outside(w->grid, lo, hi);
    }
}

/* Lists the cells with a brick that have a buried triangle in them or in a neighbouring cell. Returns their
 * number. */
static size_t list_cells(const work *w, size_t count) {
    size_t collected = 0;
    for (size_t cell = 0; cell < count; cell++) {
        int at[3];
        bool wanted = false;
        if (w->grid->cell[cell] < 0) continue;
        iso_hgrid_cell_position(w->grid, cell, at);
        for (int i = 0; i < 27 && !wanted; i++) {
            const int x = iso_clamp_index(at[0] + i % 3 - 1, w->grid->cells[0]),
                      y = iso_clamp_index(at[1] + i / 3 % 3 - 1, w->grid->cells[1]),
                      z = iso_clamp_index(at[2] + i / 9 - 1, w->grid->cells[2]);
            wanted = w->found[iso_hgrid_cell_index(w->grid, x, y, z)] != 0;
        }
        if (wanted) w->cells[collected++] = (uint32_t)cell;
    }
    return collected;
}

/* Whether the triangle nearest to voxel p is inside the solid: none of the eight voxels around the nearest
 * point is outside. */
static bool is_buried(const work *w, const int p[3], float distance) {
    const iso_transform *t = &w->grid->transform;
    const double voxel = t->spacing[0], most = (fabs((double)distance) + 0.1) * voxel;
    const iso_vec3 at = {t->origin[0] + voxel * p[0], t->origin[1] + voxel * p[1],
                         t->origin[2] + voxel * p[2]};
    iso_nearest nearest = {.squared = most * most, .point = at};
    iso_closed_mesh_nearest(w->mesh, at, &nearest);
    const double point[3] = {nearest.point.x, nearest.point.y, nearest.point.z};
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = (int)floor((point[axis] - t->origin[axis]) / voxel);
        hi[axis] = lo[axis] + 1;
    }
    return !has_outside(w->grid, lo, hi);
}

/* Returns the distance of the inside voxel p to the surface of the solid: the minimum over outside voxels q
 * of |p - q| - distance(q). Each term is at least the distance of p, because the line from p to q crosses the
 * surface. A term equals the distance of p if p and q have the same foot
 * point and the foot point lies on that line. */
static float distance_to_outside(const work *w, const int p[3]) {
    double least = (double)w->grid->band;
    for (int z = -REACH; z <= REACH; z++)
        for (int y = -REACH; y <= REACH; y++)
            for (int x = -REACH; x <= REACH; x++) {
                const float d = value_at(w->grid, p[0] + x, p[1] + y, p[2] + z);
                if (d < 0 || d >= w->grid->band) continue;
                const double way = sqrt((double)(x * x + y * y + z * z)) - (double)d;
                least = way < least ? way : least;
            }
    return (float)(least > 0 ? least : 0);
}

static void correct_cell(void *context, size_t index, int worker) {
    const work *w = context;
    const size_t cell = w->cells[w->first + index];
    float *to = w->values + index * ISO_BRICK_VOXELS;
    int at[3], p[3];
    (void)worker;
    const float *brick = iso_hgrid_brick(w->grid, w->grid->cell[cell]);
    memcpy(to, brick, ISO_BRICK_VOXELS * sizeof *to);
    iso_hgrid_cell_position(w->grid, cell, at);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        if (brick[i] >= 0 || brick[i] <= -w->grid->band) continue;
        voxel_at(at, i, p);
        if (!is_buried(w, p, brick[i])) continue;
        const float distance = distance_to_outside(w, p);
        if (distance > -brick[i]) to[i] = -distance;
    }
}

/* Corrects the first `count` of w->cells in batches. Batches do not depend on each other: they write values
 * of inside voxels without changing signs, and read only signs and the values of outside voxels. */
static void correct_cells(work *w, size_t count, iso_pool *pool) {
    for (w->first = 0; w->first < count; w->first += BATCH) {
        const size_t batch = count - w->first < BATCH ? count - w->first : BATCH;
        iso_parallel_for(pool, batch, correct_cell, w);
        for (size_t i = 0; i < batch; i++)
            memcpy(iso_hgrid_brick(w->grid, w->grid->cell[w->cells[w->first + i]]),
                   w->values + i * ISO_BRICK_VOXELS, ISO_BRICK_VOXELS * sizeof(float));
    }
}

iso_status iso_mesh_remove_buried(iso_hgrid *grid, const iso_closed_mesh *mesh, iso_pool *pool,
                                  iso_error *error) {
    const size_t count = (size_t)grid->cells[0] * (size_t)grid->cells[1] * (size_t)grid->cells[2];
    work w = {.grid = grid,
              .mesh = mesh,
              .found = iso_alloc_zero(count, sizeof *w.found),
              .cells = iso_alloc(count * sizeof *w.cells),
              .values = iso_alloc((size_t)BATCH * ISO_BRICK_VOXELS * sizeof *w.values)};
    const bool whole = w.found && w.cells && w.values;
    if (whole) {
        iso_parallel_for(pool, count, find_buried_in_cell, &w);
        correct_cells(&w, list_cells(&w, count), pool);
    }
    iso_free(w.found);
    iso_free(w.cells);
    iso_free(w.values);
    return whole ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}
