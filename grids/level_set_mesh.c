/* Converts the solid that a closed mesh encloses to a level set.
 *
 * Distances are exact: to the nearest triangle or cap. If the distances of two neighbouring voxels add up to
 * more than the distance between the voxels, no surface lies between them and both are on the same side.
 * Voxels are joined to regions in this way, and the side of a region is found by one winding number (Jacobson
 * et al. 2013), at its voxel that is farthest from the surface. Thousands of voxels so near to the surface
 * that they are joined to no other are regions of their own: their winding numbers are those of a neighbour,
 * changed by each triangle between the two. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "grids/closing/mesh_buried.h"
#include "grids/level_set.h"

static const double BAND = 3;
/* The tolerance for rounding of distances, in voxels. */
static const double ROUNDING = 1e-4;
/* The distance from the centre of a brick to its outermost voxels, in voxels. */
static const double BRICK_RADIUS = 12.991;

/* A region: connected voxels without the surface between them, at first of one brick, later joined with
 * others (union-find). */
typedef struct region {
    /* number of a region that this one was joined to, or this region's own number if it represents all that
     * were joined to it */
    uint32_t parent;
    float depth;     /* distance of its deepest voxel, the one farthest from the surface, in voxels */
    uint32_t cell;   /* the cell in which the deepest voxel lies */
    uint16_t voxel;  /* index of the deepest voxel in this cell */
    int16_t winding; /* winding number, rounded; set for representatives only */
} region;

/* The volume of the solid, in two ways. Unit: voxels while it is added up, then mm3. */
typedef struct volumes {
    double winding; /* each voxel counts as many times as the mesh winds around it */
    double solid;   /* each voxel inside counts once */
} volumes;

typedef struct conversion {
    const char *path;
    const iso_closed_mesh *mesh;
    iso_hgrid *grid;
    double voxel;
    iso_progress progress; /* progress of the current step */
    size_t cells, bricks;
    uint8_t *near;                       /* by cell: it may contain part of the band */
    uint32_t *brick_of_cell;             /* by cell: its brick, if it has one */
    uint32_t *brick_cell;                /* by brick: its cell; bricks are numbered in the order of cells */
    uint16_t (*label)[ISO_BRICK_VOXELS]; /* by brick: the region of each voxel, counted from the first one of
                                            the brick */
    uint32_t *first;                     /* by cell: number of its first region; one more entry for the end */
    region *regions;
    size_t region_count;
    volumes *sums; /* by brick */
} conversion;

/* ---- positions */

static iso_vec3 world_position(const conversion *c, double x, double y, double z) {
    const double *origin = c->grid->transform.origin;
    return iso_vec3_make(origin[0] + c->voxel * x, origin[1] + c->voxel * y, origin[2] + c->voxel * z);
}

static void voxel_at(const conversion *c, size_t cell, int voxel, int at[3]) {
    iso_hgrid_cell_position(c->grid, cell, at);
    at[0] = at[0] * ISO_BRICK + voxel % ISO_BRICK;
    at[1] = at[1] * ISO_BRICK + voxel / ISO_BRICK % ISO_BRICK;
    at[2] = at[2] * ISO_BRICK + voxel / (ISO_BRICK * ISO_BRICK);
}

/* ---- the grid */

static bool cancelled(const conversion *c) {
    return iso_progress_cancelled(&c->progress);
}

static void find_near_cell(void *context, size_t cell, int worker) {
    (void)worker;
    conversion *c = context;
    int at[3];
    if (cancelled(c)) return;
    iso_hgrid_cell_position(c->grid, cell, at);
    const double middle = (ISO_BRICK - 1) / 2.0, most = (BAND + BRICK_RADIUS) * c->voxel;
    const iso_vec3 p =
        world_position(c, ISO_BRICK * at[0] + middle, ISO_BRICK * at[1] + middle, ISO_BRICK * at[2] + middle);
    iso_nearest nearest = {.squared = most * most};
    iso_closed_mesh_nearest(c->mesh, p, &nearest);
    c->near[cell] = nearest.squared < most * most;
}

static iso_status make_bricks(conversion *c, iso_error *error) {
    for (size_t cell = 0; cell < c->cells; cell++) {
        int at[3];
        if (!c->near[cell]) continue;
        iso_hgrid_cell_position(c->grid, cell, at);
        ISO_TRY(iso_hgrid_split_unset(c->grid, at[0], at[1], at[2], error));
        c->brick_cell[c->bricks++] = (uint32_t)cell;
    }
    return ISO_OK;
}

/* ---- distances */

static float *brick_of(const conversion *c, size_t brick) {
    return iso_hgrid_brick(c->grid, c->grid->cell[c->brick_cell[brick]]);
}

/* Computes the distances of a brick, without signs. */
static void measure_brick(void *context, size_t index, int worker) {
    conversion *c = context;
    iso_brick_place place = {.origin = c->grid->transform.origin, .voxel = c->voxel};
    double squared[ISO_BRICK_VOXELS];
    float *brick = brick_of(c, index);
    (void)worker;
    if (iso_progress_tell(&c->progress, "", (double)index / (double)c->bricks, NULL) != ISO_OK) return;
    voxel_at(c, c->brick_cell[index], 0, place.at);
    iso_closed_mesh_measure(c->mesh, &place, BAND, squared);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) brick[i] = (float)(sqrt(squared[i]) / c->voxel);
}

/* ---- regions of a brick */

/* Whether no surface can lie between two voxels with distances a and b that are `apart` voxels apart. */
static bool same_side(float a, float b, double apart) {
    return (double)a + (double)b > apart + ROUNDING;
}

/* Returns the voxel that represents the region of a voxel, the first of the region. */
static inline uint16_t first_of(uint16_t *parent, uint16_t voxel) {
    while (parent[voxel] != voxel) voxel = parent[voxel] = parent[parent[voxel]];
    return voxel;
}

static inline void join_voxels(uint16_t *parent, int a, int b) {
    const uint16_t x = first_of(parent, (uint16_t)a), y = first_of(parent, (uint16_t)b);
    parent[x > y ? x : y] = x < y ? x : y;
}

/* Whether a voxel is on the same side as all its neighbours that share a face with it. */
static bool is_deep(float distance) {
    return (double)distance > 1 + 2 * ROUNDING;
}

/* Joins a voxel with those before it that share a face with it. A neighbour in the row before is skipped if
 * both are joined through the voxels before them. */
static void join_faces(const float *brick, uint16_t *parent, int voxel, const int at[3]) {
    static const int step[3] = {1, ISO_BRICK, ISO_BRICK * ISO_BRICK};
    const bool deep = at[0] > 0 && is_deep(brick[voxel]) && is_deep(brick[voxel - 1]);
    for (int axis = 0; axis < 3; axis++) {
        const int other = voxel - step[axis];
        if (at[axis] == 0 || !same_side(brick[voxel], brick[other], 1)) continue;
        if (axis > 0 && deep && is_deep(brick[other]) && is_deep(brick[other - 1])) continue;
        join_voxels(parent, voxel, other);
    }
}

/* Joins a voxel with those before it among its 26 neighbours; deep ones are joined through faces. */
static void join_neighbours(const float *brick, uint16_t *parent, int voxel) {
    static const double apart[4] = {0, 1, 1.4142135623730951, 1.7320508075688772};
    const int at[3] = {voxel % ISO_BRICK, voxel / ISO_BRICK % ISO_BRICK, voxel / (ISO_BRICK * ISO_BRICK)};
    join_faces(brick, parent, voxel, at);
    if (is_deep(brick[voxel])) return;
    for (int i = 0; i < 13; i++) {
        const int dx = i % 3 - 1, dy = i / 3 % 3 - 1, dz = i / 9 - 1, away = abs(dx) + abs(dy) + abs(dz);
        const int x = at[0] + dx, y = at[1] + dy, z = at[2] + dz;
        if (away < 2 || (x | y | z) < 0 || x >= ISO_BRICK || y >= ISO_BRICK) continue;
        const int other = (z * ISO_BRICK + y) * ISO_BRICK + x;
        if (same_side(brick[voxel], brick[other], apart[away])) join_voxels(parent, voxel, other);
    }
}

/* Whether all voxels of a row of a brick are deep, so that they are in one region. */
static bool is_deep_row(const float *row) {
    bool deep = true;
    for (int x = 0; x < ISO_BRICK; x++) deep &= is_deep(row[x]);
    return deep;
}

/* Joins a deep row with the one `step` voxels before it. */
static void join_rows(const float *brick, uint16_t *parent, int row, int step, bool both_deep) {
    if (both_deep) {
        join_voxels(parent, row, row - step);
        return;
    }
    for (int i = row; i < row + ISO_BRICK; i++)
        if (same_side(brick[i], brick[i - step], 1)) join_voxels(parent, i, i - step);
}

/* Numbers the regions of a brick, in the order of their first voxels. */
static void label_brick(void *context, size_t index, int worker) {
    enum { ROWS = ISO_BRICK * ISO_BRICK };
    conversion *c = context;
    uint16_t parent[ISO_BRICK_VOXELS], *label = c->label[index], count = 0;
    bool deep[ROWS];
    const float *brick = brick_of(c, index);
    (void)worker;
    for (int r = 0; r < ROWS; r++) {
        const int row = r * ISO_BRICK;
        deep[r] = is_deep_row(brick + row);
        for (int i = row; i < row + ISO_BRICK; i++) {
            parent[i] = (uint16_t)(deep[r] ? row : i);
            if (!deep[r]) join_neighbours(brick, parent, i);
        }
        if (!deep[r]) continue;
        if (r % ISO_BRICK) join_rows(brick, parent, row, ISO_BRICK, deep[r - 1]);
        if (r >= ISO_BRICK) join_rows(brick, parent, row, ROWS, deep[r - ISO_BRICK]);
    }
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const bool same = i % ISO_BRICK && deep[i / ISO_BRICK];
        const uint16_t first = same ? (uint16_t)(i - 1) : first_of(parent, (uint16_t)i);
        label[i] = first == i ? count++ : label[first];
    }
    c->first[c->brick_cell[index]] = count;
}

/* ---- regions of the grid */

static uint32_t find_root(region *regions, uint32_t r) {
    while (regions[r].parent != r) {
        regions[r].parent = regions[regions[r].parent].parent;
        r = regions[r].parent;
    }
    return r;
}

/* Joins two regions: the one with the lower number represents both and gets the deeper of their two deepest
 * voxels. */
static void unite(region *regions, uint32_t a, uint32_t b) {
    a = find_root(regions, a);
    b = find_root(regions, b);
    if (a == b) return;
    if (b < a) {
        const uint32_t held = a;
        a = b;
        b = held;
    }
    regions[b].parent = a;
    if (regions[b].depth <= regions[a].depth) return;
    regions[a].depth = regions[b].depth;
    regions[a].cell = regions[b].cell;
    regions[a].voxel = regions[b].voxel;
}

/* The distances and region labels of a cell. */
typedef struct cell_labels {
    const float *brick; /* NULL: the cell has none and is one region */
    const uint16_t *label;
    uint32_t first;
} cell_labels;

static cell_labels labels_of(const conversion *c, size_t cell) {
    if (!c->near[cell]) return (cell_labels){NULL, NULL, c->first[cell]};
    return (cell_labels){iso_hgrid_brick(c->grid, c->grid->cell[cell]), c->label[c->brick_of_cell[cell]],
                         c->first[cell]};
}

/* Returns the index of voxel (a, b) of a brick's first or last layer along an axis. */
static int layer_voxel(int axis, int a, int b, bool last) {
    static const int step[3] = {1, ISO_BRICK, ISO_BRICK * ISO_BRICK};
    return (last ? ISO_BRICK - 1 : 0) * step[axis] + a * step[(axis + 1) % 3] + b * step[(axis + 2) % 3];
}

/* Joins the regions of two cells that are neighbours along an axis, where no surface lies between them. */
static void join_cells(conversion *c, const cell_labels *low, const cell_labels *high, int axis) {
    if (!low->brick && !high->brick) {
        unite(c->regions, low->first, high->first);
        return;
    }
    for (int i = 0; i < ISO_BRICK * ISO_BRICK; i++) {
        const int a = layer_voxel(axis, i % ISO_BRICK, i / ISO_BRICK, true),
                  b = layer_voxel(axis, i % ISO_BRICK, i / ISO_BRICK, false);
        const float da = low->brick ? low->brick[a] : (float)BAND,
                    db = high->brick ? high->brick[b] : (float)BAND;
        if (!same_side(da, db, 1)) continue;
        unite(c->regions, low->first + (low->brick ? low->label[a] : 0u),
              high->first + (high->brick ? high->label[b] : 0u));
    }
}

static void join_all(conversion *c) {
    for (size_t cell = 0; cell < c->cells; cell++) {
        const size_t step[3] = {1, (size_t)c->grid->cells[0],
                                (size_t)c->grid->cells[0] * (size_t)c->grid->cells[1]};
        const cell_labels low = labels_of(c, cell);
        int at[3];
        iso_hgrid_cell_position(c->grid, cell, at);
        for (int axis = 0; axis < 3; axis++) {
            if (at[axis] + 1 >= c->grid->cells[axis]) continue;
            const cell_labels high = labels_of(c, cell + step[axis]);
            join_cells(c, &low, &high, axis);
        }
    }
}

/* Initialises the regions and finds the deepest voxel of each, where its side will be decided. A cell without
 * a brick is one region; its voxel (8, 8, 8) is taken. */
static void begin_regions(conversion *c) {
    size_t brick = 0;
    for (size_t cell = 0; cell < c->cells; cell++) {
        region *r = c->regions + c->first[cell];
        const uint32_t count = c->first[cell + 1] - c->first[cell];
        for (uint32_t i = 0; i < count; i++)
            r[i] = (region){.parent = c->first[cell] + i, .depth = -1, .cell = (uint32_t)cell};
        if (!c->near[cell]) {
            r->depth = INFINITY;
            r->voxel = (ISO_BRICK * ISO_BRICK + ISO_BRICK + 1) * (ISO_BRICK / 2);
            continue;
        }
        const float *d = brick_of(c, brick);
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
            region *own = &r[c->label[brick][i]];
            if (d[i] <= own->depth) continue;
            own->depth = d[i];
            own->voxel = (uint16_t)i;
        }
        brick++;
    }
}

static iso_status make_regions(conversion *c, iso_error *error) {
    size_t sum = 0;
    for (size_t cell = 0; cell <= c->cells; cell++) {
        const size_t count = cell == c->cells ? 0 : c->near[cell] ? c->first[cell] : 1;
        c->first[cell] = (uint32_t)sum;
        sum += count;
    }
    c->region_count = sum;
    c->regions = sum < UINT32_MAX ? iso_alloc(sum * sizeof *c->regions) : NULL;
    c->brick_of_cell = iso_alloc(c->cells * sizeof *c->brick_of_cell);
    const bool whole = c->regions && c->brick_of_cell;
    if (whole) {
        for (size_t i = 0; i < c->bricks; i++) c->brick_of_cell[c->brick_cell[i]] = (uint32_t)i;
        begin_regions(c);
        join_all(c);
    }
    return whole ? ISO_OK : iso_fail_memory(error, c->path);
}

/* A representative with a voxel at least this far from the surface is a large region. Most others are single
 * voxels beside the surface. */
static bool is_large(const region *r) {
    return r->depth >= 1;
}

static iso_vec3 voxel_position(const conversion *c, const int at[3]) {
    return world_position(c, at[0], at[1], at[2]);
}

static void compute_winding(const conversion *c, region *r) {
    int at[3];
    voxel_at(c, r->cell, r->voxel, at);
    const double winding = iso_closed_mesh_winding(c->mesh, voxel_position(c, at));
    r->winding = (int16_t)floor(fmin(fmax(winding, -1000), 1000) + 0.5);
}

/* Finds the sides of large regions. */
static void find_side(void *context, size_t index, int worker) {
    conversion *c = context;
    region *r = &c->regions[index];
    (void)worker;
    if (r->parent == index && is_large(r) && !cancelled(c)) compute_winding(c, r);
}

/* Returns the representative of the region of a voxel. */
static const region *region_at(const conversion *c, const int at[3]) {
    const size_t cell =
        iso_hgrid_cell_index(c->grid, at[0] / ISO_BRICK, at[1] / ISO_BRICK, at[2] / ISO_BRICK);
    uint32_t r = c->first[cell];
    if (c->near[cell]) {
        const int x = at[0] % ISO_BRICK, y = at[1] % ISO_BRICK, z = at[2] % ISO_BRICK;
        r += c->label[c->brick_of_cell[cell]][(z * ISO_BRICK + y) * ISO_BRICK + x];
    }
    while (c->regions[r].parent != r) r = c->regions[r].parent;
    return &c->regions[r];
}

/* Finds the side of a region from that of a large one at a neighbouring voxel. */
static bool side_from_neighbour(const conversion *c, region *r) {
    int at[3];
    voxel_at(c, r->cell, r->voxel, at);
    for (int i = 0; i < 6; i++) {
        int beside[3] = {at[0], at[1], at[2]}, change;
        beside[i / 2] += i % 2 ? 1 : -1;
        if (beside[i / 2] < 0 || beside[i / 2] >= c->grid->dims[i / 2]) continue;
        const region *other = region_at(c, beside);
        if (!is_large(other) ||
            !iso_closed_mesh_change(c->mesh, voxel_position(c, beside), voxel_position(c, at), &change))
            continue;
        r->winding = (int16_t)(other->winding + change);
        return true;
    }
    return false;
}

/* Finds the sides of the other regions, after those of the large ones. */
static void find_small_side(void *context, size_t index, int worker) {
    conversion *c = context;
    region *r = &c->regions[index];
    (void)worker;
    if (r->parent != index || is_large(r) || cancelled(c)) return;
    if (!side_from_neighbour(c, r)) compute_winding(c, r);
}

/* ---- signs */

static int winding_of(const conversion *c, size_t cell, uint32_t label) {
    const region *r = &c->regions[c->first[cell] + label];
    while (r->parent != (uint32_t)(r - c->regions)) r = &c->regions[r->parent];
    return r->winding;
}

static void sign_brick(void *context, size_t index, int worker) {
    conversion *c = context;
    float *brick = brick_of(c, index);
    volumes sum = {0};
    (void)worker;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int winding = winding_of(c, c->brick_cell[index], c->label[index][i]);
        if (winding != 0) brick[i] = -brick[i];
        sum.winding += winding;
        sum.solid += winding != 0;
    }
    c->sums[index] = sum;
}

static volumes sign_all(conversion *c, iso_pool *pool) {
    volumes sum = {0};
    iso_parallel_for(pool, c->bricks, sign_brick, c);
    for (size_t i = 0; i < c->bricks; i++) {
        sum.winding += c->sums[i].winding;
        sum.solid += c->sums[i].solid;
    }
    for (size_t cell = 0; cell < c->cells; cell++) {
        if (c->near[cell]) continue;
        const int winding = winding_of(c, cell, 0);
        c->grid->cell[cell] = winding ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE;
        sum.winding += (double)winding * ISO_BRICK_VOXELS;
        sum.solid += winding ? ISO_BRICK_VOXELS : 0;
    }
    const double cube = c->voxel * c->voxel * c->voxel;
    return (volumes){sum.winding * cube, sum.solid * cube};
}

/* ---- plausibility */

/* Compares the volume of the field with that of the mesh. The sum of the voxels' winding numbers is the
 * signed volume of any mesh; counting voxels is wrong by at most half a voxel at the surface. */
static iso_status check_volume(const conversion *c, const volumes *field, iso_error *error) {
    const iso_mesh_report *mesh = iso_closed_mesh_report(c->mesh);
    const double allowed = 0.05 * fabs(mesh->volume) + 0.5 * c->voxel * mesh->area;
    if (field->solid == 0 || fabs(field->winding) < 0.5 * fabs(mesh->volume))
        return iso_fail(error, ISO_ERR_EMPTY,
                        "%s: too fine for voxels of %.3g mm: %.4g mm3 of its %.4g mm3 would be left", c->path,
                        c->voxel, fabs(field->winding), fabs(mesh->volume));
    if (fabs(field->winding - mesh->volume) <= allowed) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: its %zu open edges cannot be closed: the field would hold %.4g mm3 of %.4g mm3",
                    c->path, mesh->open_edges, field->winding, mesh->volume);
}

/* ---- conversion */

static iso_status allocate(conversion *c, iso_error *error) {
    c->label = iso_alloc(c->bricks * sizeof *c->label);
    c->sums = iso_alloc(c->bricks * sizeof *c->sums);
    return c->label && c->sums ? ISO_OK : iso_fail_memory(error, c->path);
}

static iso_status compute_field(conversion *c, const iso_sampling *sampling, iso_error *error) {
    const iso_progress *whole = sampling->progress;
    c->progress = iso_progress_part(whole, 0, 0.1);
    iso_parallel_for(sampling->pool, c->cells, find_near_cell, c);
    ISO_TRY(iso_progress_tell(&c->progress, c->path, 1, error));
    ISO_TRY(make_bricks(c, error));
    ISO_TRY(allocate(c, error));
    c->progress = iso_progress_part(whole, 0.1, 0.8);
    iso_parallel_for(sampling->pool, c->bricks, measure_brick, c);
    ISO_TRY(iso_progress_tell(&c->progress, c->path, 1, error));
    c->progress = iso_progress_part(whole, 0.8, 1);
    iso_parallel_for(sampling->pool, c->bricks, label_brick, c);
    ISO_TRY(make_regions(c, error));
    ISO_TRY(iso_progress_tell(&c->progress, c->path, 0.5, error));
    iso_parallel_for(sampling->pool, c->region_count, find_side, c);
    iso_parallel_for(sampling->pool, c->region_count, find_small_side, c);
    ISO_TRY(iso_progress_tell(&c->progress, c->path, 0.8, error));
    const volumes field = sign_all(c, sampling->pool);
    ISO_TRY(check_volume(c, &field, error));
    ISO_TRY(iso_mesh_remove_buried(c->grid, c->mesh, sampling->pool, error));
    iso_hgrid_prune(c->grid);
    return iso_progress_tell(&c->progress, c->path, 1, error);
}

static iso_status convert_mesh(conversion *c, const iso_sampling *sampling, iso_error *error) {
    c->cells = (size_t)c->grid->cells[0] * (size_t)c->grid->cells[1] * (size_t)c->grid->cells[2];
    c->near = iso_alloc_zero(c->cells, sizeof *c->near);
    c->first = iso_alloc_zero(c->cells + 1, sizeof *c->first);
    c->brick_cell = iso_alloc(c->cells * sizeof *c->brick_cell);
    iso_status status = c->near && c->first && c->brick_cell ? compute_field(c, sampling, error)
                                                             : iso_fail_memory(error, c->path);
    iso_free(c->near);
    iso_free(c->first);
    iso_free(c->brick_cell);
    iso_free(c->brick_of_cell);
    iso_free(c->label);
    iso_free(c->sums);
    iso_free(c->regions);
    return status;
}

iso_status iso_level_set_from_mesh(const char *path, const iso_closed_mesh *mesh,
                                   const iso_sampling *sampling, iso_hgrid **grid, iso_error *error) {
    conversion c = {.path = path, .mesh = mesh, .voxel = sampling->voxel};
    const iso_box box = iso_closed_mesh_box(mesh);
    ISO_TRY(iso_level_set_around(path, &box, sampling, &c.grid, error));
    iso_status status = convert_mesh(&c, sampling, error);
    if (status == ISO_OK)
        *grid = c.grid;
    else
        iso_hgrid_destroy(c.grid);
    return status;
}
