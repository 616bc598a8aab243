/* Corrects the distances of inside voxels near buried triangles, which lie inside the solid. The new distance
 * is the minimum, over the outside voxels nearby, of the distance to the outside voxel minus this voxel's own
 * distance. */
#include "grids/closing/mesh_buried.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"

/* If an inside voxel without outside neighbours is nearer than this to a triangle (voxels), the triangle is
 * taken to be inside the solid. */
static const float NEAR = 0.75f;
/* REACH: outside voxels up to this far away along each axis are used: 3 for the band, and 1 more. SIDE: the
 * side of a brick with these voxels around it. */
enum { REACH = 4, SIDE = ISO_BRICK + 2 * REACH, BALL = 2 * REACH + 1 };

/* The values of a brick and of the voxels around it, and which of them are outside: bit x of row (y, z).
 * Voxels beyond the grid are those at its border. */
typedef struct block {
    float value[SIDE][SIDE][SIDE];
    uint32_t outside[SIDE][SIDE];
} block;

/* Some voxels of a brick: bit x of row y + 16 z. */
typedef struct voxel_set {
    uint16_t rows[ISO_BRICK * ISO_BRICK];
} voxel_set;

/* The voxels of a brick with new values; values NULL although there are some: out of memory. */
typedef struct correction {
    voxel_set voxels;
    float *values; /* owned; in the order of the voxels */
    size_t count;
} correction;

typedef struct work {
    iso_hgrid *grid;
    const iso_closed_mesh *mesh;
    uint8_t *found;  /* by cell: whether a buried triangle was found in it */
    uint32_t *cells; /* the cells with bricks that have a buried triangle in them or beside them */
    size_t cell_count;
    correction *corrections;         /* by entry of `cells` */
    double length[BALL][BALL][BALL]; /* of the way from a voxel to those within REACH */
} work;

/* ---- a brick and the voxels around it */

static void read_block(const iso_hgrid *grid, size_t cell, block *b) {
    int at[3], x[SIDE];
    iso_hgrid_cell_position(grid, cell, at);
    for (int i = 0; i < SIDE; i++) x[i] = iso_clamp_index(at[0] * ISO_BRICK + i - REACH, grid->dims[0]);
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++) {
            const int from_y = iso_clamp_index(at[1] * ISO_BRICK + y - REACH, grid->dims[1]),
                      from_z = iso_clamp_index(at[2] * ISO_BRICK + z - REACH, grid->dims[2]);
            uint32_t outside = 0;
            for (int i = 0; i < SIDE; i++) {
                const float value = iso_hgrid_at(grid, x[i], from_y, from_z);
                b->value[z][y][i] = value;
                outside |= (uint32_t)(value >= 0) << i;
            }
            b->outside[z][y] = outside;
        }
}

/* Which of the voxels of rows y .. y + more of slices z .. z + more are outside, or have an outside voxel
 * among the `more` after them. */
static uint32_t outside_after(const block *b, int y, int z, int more) {
    uint32_t any = 0;
    for (int k = 0; k <= more; k++)
        for (int j = 0; j <= more; j++) any |= b->outside[z + k][y + j];
    uint32_t after = any;
    for (int i = 1; i <= more; i++) after |= any >> i;
    return after;
}

/* ---- cells with buried triangles */

/* Looks in a cell for an inside voxel that is near a triangle although no voxel around it is outside. */
static void find_buried_in_cell(void *context, size_t cell, int worker) {
    const work *w = context;
    block b;
    (void)worker;
    if (w->grid->cell[cell] < 0) return;
    read_block(w->grid, cell, &b);
    for (int z = REACH; z < REACH + ISO_BRICK; z++)
        for (int y = REACH; y < REACH + ISO_BRICK; y++) {
            const uint32_t outside = outside_after(&b, y - 1, z - 1, 2) << 1;
            for (int x = REACH; x < REACH + ISO_BRICK; x++)
                if (!(outside >> x & 1) && b.value[z][y][x] >= -NEAR) {
                    w->found[cell] = 1;
                    return;
                }
        }
}

/* Lists the cells with a brick that have a buried triangle in them or in a neighbouring cell. */
static void list_cells(work *w, size_t count) {
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
        if (wanted) w->cells[w->cell_count++] = (uint32_t)cell;
    }
}

/* ---- voxels whose nearest triangle is buried */

/* Whether the nearest point of a triangle to a voxel of the brick is inside the solid: none of the eight
 * voxels around it is outside. */
static bool is_buried(const iso_brick_place *place, const block *b, int voxel,
                      const iso_tree_triangle *triangle) {
    const iso_vec3 nearest = iso_triangle_nearest(triangle->corners, iso_brick_voxel(place, voxel));
    const double point[3] = {nearest.x, nearest.y, nearest.z};
    int lo[3];
    for (int axis = 0; axis < 3; axis++)
        lo[axis] = (int)floor((point[axis] - place->origin[axis]) / place->voxel) - place->at[axis] + REACH;
    return !(outside_after(b, lo[1], lo[2], 1) >> lo[0] & 1);
}

/* Returns the distance of the inside voxel at (x, y, z) of a block to the surface of the solid: the minimum
 * over outside voxels q of |p - q| - distance(q). Each term is at least the distance of p, because the line
 * from p to q crosses the surface. A term equals the distance of p if p and q have the same foot point and
 * the foot point lies on that line. */
static double distance_to_outside(const work *w, const block *b, int x, int y, int z) {
    double least = (double)w->grid->band;
    for (int k = 0; k < BALL; k++)
        for (int j = 0; j < BALL; j++) {
            const float *row = &b->value[z + k - REACH][y + j - REACH][x - REACH];
            if (!(b->outside[z + k - REACH][y + j - REACH] >> (x - REACH) & ((1u << BALL) - 1))) continue;
            for (int i = 0; i < BALL; i++) {
                if (row[i] < 0 || row[i] >= w->grid->band) continue;
                const double way = w->length[k][j][i] - (double)row[i];
                least = way < least ? way : least;
            }
        }
    return least > 0 ? least : 0;
}

/* Finds the inside voxels of a brick whose nearest triangle, not a cap, is buried, and that lie farther
 * inside than it. Adds their new values to `values`. */
static void correct_voxels(const work *w, const block *b, const iso_brick_place *place, correction *c,
                           float values[ISO_BRICK_VOXELS]) {
    const iso_tree_triangle *nearest[ISO_BRICK_VOXELS];
    double squared[ISO_BRICK_VOXELS];
    iso_closed_mesh_nearest_triangles(w->mesh, place, (double)w->grid->band, squared, nearest);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int x = i % ISO_BRICK, y = i / ISO_BRICK % ISO_BRICK, z = i / (ISO_BRICK * ISO_BRICK);
        const float value = b->value[z + REACH][y + REACH][x + REACH];
        if (value >= 0 || !nearest[i] || (float)(sqrt(squared[i]) / place->voxel) > -value) continue;
        if (!is_buried(place, b, i, nearest[i])) continue;
        const float distance = (float)distance_to_outside(w, b, x + REACH, y + REACH, z + REACH);
        if (distance <= -value) continue;
        c->voxels.rows[i / ISO_BRICK] |= (uint16_t)(1u << x);
        values[c->count++] = -distance;
    }
}

static void find_corrections(void *context, size_t index, int worker) {
    const work *w = context;
    correction *c = &w->corrections[index];
    iso_brick_place place = {.origin = w->grid->transform.origin, .voxel = w->grid->transform.spacing[0]};
    float values[ISO_BRICK_VOXELS];
    block b;
    (void)worker;
    iso_hgrid_cell_position(w->grid, w->cells[index], place.at);
    for (int axis = 0; axis < 3; axis++) place.at[axis] *= ISO_BRICK;
    read_block(w->grid, w->cells[index], &b);
    correct_voxels(w, &b, &place, c, values);
    c->values = c->count ? iso_alloc(c->count * sizeof *c->values) : NULL;
    if (c->values) memcpy(c->values, values, c->count * sizeof *values);
}

/* Writes the new values of a cell's brick, after all have been found. */
static void write_corrections(void *context, size_t index, int worker) {
    const work *w = context;
    const correction *c = &w->corrections[index];
    float *brick = iso_hgrid_brick(w->grid, w->grid->cell[w->cells[index]]);
    size_t next = 0;
    (void)worker;
    if (!c->values) return;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++)
        if (c->voxels.rows[i / ISO_BRICK] >> i % ISO_BRICK & 1) brick[i] = c->values[next++];
}

/* Returns false if there is no memory. */
static bool correct_cells(work *w, iso_pool *pool) {
    bool whole = true;
    w->corrections = iso_alloc_zero(w->cell_count, sizeof *w->corrections);
    if (!w->corrections) return false;
    iso_parallel_for(pool, w->cell_count, find_corrections, w);
    iso_parallel_for(pool, w->cell_count, write_corrections, w);
    for (size_t i = 0; i < w->cell_count; i++) {
        whole &= !w->corrections[i].count || w->corrections[i].values;
        iso_free(w->corrections[i].values);
    }
    iso_free(w->corrections);
    return whole;
}

static void set_lengths(work *w) {
    for (int i = 0; i < BALL * BALL * BALL; i++) {
        const int x = i % BALL - REACH, y = i / BALL % BALL - REACH, z = i / (BALL * BALL) - REACH;
        w->length[z + REACH][y + REACH][x + REACH] = sqrt((double)(x * x + y * y + z * z));
    }
}

iso_status iso_mesh_remove_buried(iso_hgrid *grid, const iso_closed_mesh *mesh, iso_pool *pool,
                                  iso_error *error) {
    const size_t count = iso_hgrid_cell_count(grid);
    work w = {.grid = grid,
              .mesh = mesh,
              .found = iso_alloc_zero(count, sizeof *w.found),
              .cells = iso_alloc(count * sizeof *w.cells)};
    bool whole = w.found && w.cells;
    if (whole) {
        set_lengths(&w);
        iso_parallel_for(pool, count, find_buried_in_cell, &w);
        list_cells(&w, count);
        if (w.cell_count) whole = correct_cells(&w, pool);
    }
    iso_free(w.found);
    iso_free(w.cells);
    return whole ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}
