/* Walls of solids: |distance + wall / 2| - wall / 2 is the distance from both of their faces. */
#include "scene/hollow.h"

#include <math.h>

#include "base/memory.h"
#include "scene/distances.h"

enum { BAND = 3, ROOM = 4, BLOCK = 4 }; /* voxels */

/* A voxel in the hollow. */
typedef struct spot {
    iso_vec3 place;
    double height, depth; /* along `up`; distance from the surface, below 0 inside */
} spot;

/* What a cell holds of the hollow: its lowest and highest voxels, of those at one height the deepest. */
typedef struct extremes {
    bool any;
    spot low, high;
} extremes;

typedef struct hollowing {
    const iso_hollow_opts *opts;
    const iso_distance *distance;
    iso_hgrid *grid;
    double voxel;
    iso_vec3 origin;
    int8_t *state; /* of each cell: 0, it gets a brick, or ISO_CELL_OUTSIDE or _INSIDE */
    extremes *found;
} hollowing;

static iso_vec3 place_of(const hollowing *h, double x, double y, double z) {
    return iso_vec3_add(h->origin, iso_vec3_scale(iso_vec3_make(x, y, z), h->voxel));
}

/* Distance from the wall, mm, below 0 in it; *depth: from the surface. */
static double wall_at(const hollowing *h, iso_vec3 p, iso_nearby *nearby, double *depth) {
    const double half = h->opts->wall / 2;
    *depth = iso_distance_at(h->distance, p, nearby);
    return fabs(*depth + half) - half;
}

/* Whether all voxels that are at most `reach` voxels from a place with this distance lie beyond the band. */
static bool is_far(const hollowing *h, double wall, double reach) {
    return fabs(wall) > (reach + BAND) * h->voxel;
}

static void classify(void *context, size_t cell, int thread) {
    static const double REACH = 13; /* half the diagonal of a brick */
    hollowing *h = context;
    int at[3];
    iso_nearby nearby = {0};
    double depth;
    (void)thread;
    iso_hgrid_cell_position(h->grid, cell, at);
    const double middle = (ISO_BRICK - 1) / 2.0;
    const iso_vec3 p =
        place_of(h, ISO_BRICK * at[0] + middle, ISO_BRICK * at[1] + middle, ISO_BRICK * at[2] + middle);
    const double wall = wall_at(h, p, &nearby, &depth);
    iso_nearby_free(&nearby);
    h->state[cell] = (int8_t)(!is_far(h, wall, REACH) ? 0 : wall < 0 ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE);
}

static void note_hollow(extremes *e, const spot *found) {
    const double below = e->any ? found->height - e->low.height : -1,
                 above = e->any ? found->height - e->high.height : 1;
    if (below < 0 || (below == 0 && found->depth < e->low.depth)) e->low = *found;
    if (above > 0 || (above == 0 && found->depth < e->high.depth)) e->high = *found;
    e->any = true;
}

/* A block of voxels of a brick, all at once if it is far from the wall's faces. */
static void fill_block(hollowing *h, const int first[3], const int at[3], float *brick, extremes *e,
                       iso_nearby *nearby) {
    static const double REACH = 2.6;
    const double middle = (BLOCK - 1) / 2.0;
    double depth;
    const iso_vec3 p =
        place_of(h, first[0] + at[0] + middle, first[1] + at[1] + middle, first[2] + at[2] + middle);
    const double wall = wall_at(h, p, nearby, &depth);
    const bool far = is_far(h, wall, REACH);
    for (int i = 0; i < BLOCK * BLOCK * BLOCK; i++) {
        const int x = at[0] + i % BLOCK, y = at[1] + i / BLOCK % BLOCK, z = at[2] + i / (BLOCK * BLOCK);
        const iso_vec3 voxel = place_of(h, first[0] + x, first[1] + y, first[2] + z);
        const double value = (far ? wall : wall_at(h, voxel, nearby, &depth)) / h->voxel;
        brick[(z * ISO_BRICK + y) * ISO_BRICK + x] = (float)fmax(-BAND, fmin(BAND, value));
        if (!far && depth < -h->opts->wall)
            note_hollow(e, &(spot){voxel, iso_vec3_dot(voxel, h->opts->up), depth});
    }
}

static void fill(void *context, size_t cell, int thread) {
    hollowing *h = context;
    int at[3];
    iso_nearby nearby = {0};
    (void)thread;
    if (h->grid->cell[cell] < 0) return;
    iso_hgrid_cell_position(h->grid, cell, at);
    const int first[3] = {ISO_BRICK * at[0], ISO_BRICK * at[1], ISO_BRICK * at[2]};
    float *brick = iso_hgrid_brick(h->grid, h->grid->cell[cell]);
    for (int z = 0; z < ISO_BRICK; z += BLOCK)
        for (int y = 0; y < ISO_BRICK; y += BLOCK)
            for (int x = 0; x < ISO_BRICK; x += BLOCK)
                fill_block(h, first, (const int[3]){x, y, z}, brick, &h->found[cell], &nearby);
    iso_nearby_free(&nearby);
}

/* ---- holes: half-lines that are cut away */

static double distance_from_line(iso_vec3 from, iso_vec3 direction, iso_vec3 p) {
    const iso_vec3 way = iso_vec3_sub(p, from);
    const double along = fmax(0, iso_vec3_dot(way, direction));
    return iso_vec3_length(iso_vec3_sub(way, iso_vec3_scale(direction, along)));
}

static iso_status drill(hollowing *h, iso_vec3 from, iso_vec3 direction, iso_error *error) {
    const double radius = h->opts->drain / 2, middle = (ISO_BRICK - 1) / 2.0;
    for (size_t cell = 0; cell < iso_hgrid_cell_count(h->grid); cell++) {
        int at[3];
        float *brick;
        iso_hgrid_cell_position(h->grid, cell, at);
        const iso_vec3 centre =
            place_of(h, ISO_BRICK * at[0] + middle, ISO_BRICK * at[1] + middle, ISO_BRICK * at[2] + middle);
        if (h->grid->cell[cell] == ISO_CELL_OUTSIDE ||
            distance_from_line(from, direction, centre) > radius + (13 + BAND) * h->voxel)
            continue;
        ISO_TRY(iso_hgrid_split(h->grid, at[0], at[1], at[2], &brick, error));
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
            const int x = i % ISO_BRICK, y = i / ISO_BRICK % ISO_BRICK, z = i / (ISO_BRICK * ISO_BRICK);
            const iso_vec3 p =
                place_of(h, ISO_BRICK * at[0] + x, ISO_BRICK * at[1] + y, ISO_BRICK * at[2] + z);
            const double hole = (radius - distance_from_line(from, direction, p)) / h->voxel;
            brick[i] = (float)fmax((double)brick[i], fmax(-BAND, fmin(BAND, hole)));
        }
    }
    return ISO_OK;
}

static iso_status make(hollowing *h, iso_error *error) {
    const size_t cells = iso_hgrid_cell_count(h->grid);
    extremes all = {.any = false};
    h->state = iso_alloc_zero(cells, sizeof *h->state);
    h->found = iso_alloc_zero(cells, sizeof *h->found);
    if (!h->state || !h->found) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a hollow solid");
    iso_parallel_for(h->opts->pool, cells, classify, h);
    for (size_t cell = 0; cell < cells; cell++) {
        int at[3];
        iso_hgrid_cell_position(h->grid, cell, at);
        if (h->state[cell])
            h->grid->cell[cell] = h->state[cell];
        else
            ISO_TRY(iso_hgrid_split_unset(h->grid, at[0], at[1], at[2], error));
    }
    iso_parallel_for(h->opts->pool, cells, fill, h);
    for (size_t cell = 0; cell < cells; cell++) {
        if (!h->found[cell].any) continue;
        const extremes *e = &h->found[cell];
        note_hollow(&all, &e->low);
        note_hollow(&all, &e->high);
    }
    if (!all.any)
        return iso_fail(error, ISO_ERR_EMPTY,
                        "the solid is nowhere thicker than two walls of %g mm: nothing is hollow",
                        h->opts->wall);
    if (h->opts->drain > 0) {
        ISO_TRY(drill(h, all.low.place, iso_vec3_scale(h->opts->up, -1), error));
        ISO_TRY(drill(h, all.high.place, h->opts->up, error));
    }
    iso_hgrid_prune(h->grid);
    return ISO_OK;
}

/* An empty level set around a box. */
static iso_status make_grid(hollowing *h, const iso_box *box, iso_error *error) {
    const iso_vec3 size = iso_vec3_sub(box->hi, box->lo);
    const double sides[3] = {size.x, size.y, size.z}, room = ROOM * h->voxel;
    iso_transform transform = {.spacing = {h->voxel, h->voxel, h->voxel},
                               .origin = {box->lo.x - room, box->lo.y - room, box->lo.z - room},
                               .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    int dims[3];
    for (int axis = 0; axis < 3; axis++) {
        const double voxels = ceil(sides[axis] / h->voxel) + 2 * ROOM + 1;
        if (voxels > ISO_HGRID_MAX)
            return iso_fail(error, ISO_ERR_LIMIT,
                            "a wall of %g mm needs voxels of %.3g mm, of which the solid has %.0f along an "
                            "axis: at most %d",
                            h->opts->wall, h->voxel, voxels, ISO_HGRID_MAX);
        dims[axis] = (int)voxels;
    }
    h->origin = iso_vec3_make(transform.origin[0], transform.origin[1], transform.origin[2]);
    return iso_hgrid_create(dims, BAND, &transform, &h->grid, error);
}

static iso_status find_box(const iso_grid *grid, double isovalue, iso_pool *pool, iso_box *box,
                           iso_error *error) {
    iso_weld weld;
    ISO_TRY(iso_isosurface_mesh(grid, isovalue, pool, &weld, error));
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    *box = iso_box_empty();
    for (size_t i = 0; i < weld.vertex_count; i++) {
        const float *p = weld.vertices[i].position;
        const iso_vec3 at = iso_affine_point(&affine, iso_vec3_make(p[0], p[1], p[2]));
        box->lo = iso_vec3_make(fmin(box->lo.x, at.x), fmin(box->lo.y, at.y), fmin(box->lo.z, at.z));
        box->hi = iso_vec3_make(fmax(box->hi.x, at.x), fmax(box->hi.y, at.y), fmax(box->hi.z, at.z));
    }
    iso_weld_free(&weld);
    return ISO_OK;
}

iso_status iso_grid_hollow(const iso_grid *grid, double isovalue, const iso_hollow_opts *opts,
                           iso_hgrid **hollow, iso_error *error) {
    hollowing h = {.opts = opts};
    iso_distance *distance;
    iso_box box;
    const double *spacing = iso_grid_transform(grid)->spacing;
    h.voxel =
        opts->voxel > 0 ? opts->voxel : fmin(opts->wall / 3, fmin(spacing[0], fmin(spacing[1], spacing[2])));
    ISO_TRY(iso_distance_of_isosurface(grid, isovalue, opts->pool, &distance, error));
    h.distance = distance;
    iso_status status = find_box(grid, isovalue, opts->pool, &box, error);
    if (status == ISO_OK) status = make_grid(&h, &box, error);
    if (status == ISO_OK) status = make(&h, error);
    iso_distance_destroy(distance);
    iso_free(h.state);
    iso_free(h.found);
    if (status == ISO_OK)
        *hollow = h.grid;
    else
        iso_hgrid_destroy(h.grid);
    return status;
}
