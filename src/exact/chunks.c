/* chunks: extracts, measures and draws one chunk after the other. */
#include "exact/chunks.h"

iso_status iso_exact_chunk_create(iso_rgrid *voxels, const iso_grid_chunk *chunk, double isovalue,
                                  iso_pool *pool, iso_exact **exact, iso_error *error) {
    const iso_grid grid = {.rgrid = voxels};
    const iso_exact_opts opts = {.isovalue = isovalue, .pool = pool, .chunk = chunk};
    return iso_exact_create(&grid, &opts, exact, error);
}

static iso_status create(const iso_chunk_walk *walk, const iso_chunk_visit *visit, iso_exact **exact,
                         iso_error *error) {
    const iso_chunk_walk_opts *walked = iso_chunk_walk_opts_of(walk);
    return iso_exact_chunk_create(visit->grid, visit->chunk, walked->isovalue, walked->pool, exact, error);
}

typedef struct bounds_visit {
    const iso_chunk_walk *walk;
    iso_chunk_bounds *bounds;
} bounds_visit;

static void add_box(iso_box *all, const iso_box *box) {
    if (iso_box_is_empty(box)) return;
    iso_box_add(all, box->lo);
    iso_box_add(all, box->hi);
}

static iso_status add_bounds(void *context, const iso_chunk_visit *visit, iso_error *error) {
    const bounds_visit *all = context;
    iso_exact *exact = NULL;
    iso_status status = create(all->walk, visit, &exact, error);
    if (status == ISO_OK) status = iso_exact_update(exact, error);
    for (int i = 0; i < all->bounds->count && status == ISO_OK; i++) {
        const iso_box box = iso_exact_bounds(exact, all->bounds->affines[i]);
        add_box(&all->bounds->boxes[i], &box);
    }
    if (status == ISO_OK) all->bounds->primitives += iso_exact_stats(exact).cells;
    iso_exact_destroy(exact);
    return status;
}

iso_status iso_exact_chunks_bounds(iso_chunk_walk *walk, iso_chunk_bounds *bounds, iso_error *error) {
    bounds_visit all = {walk, bounds};
    for (int i = 0; i < bounds->count; i++) bounds->boxes[i] = iso_box_empty();
    bounds->primitives = 0;
    return iso_chunk_walk_visit(walk, bounds->share, add_bounds, &all, error);
}

typedef struct keys_visit {
    const iso_chunk_walk *walk;
    const iso_exact_key_picture *picture;
} keys_visit;

static iso_status draw_keys(void *context, const iso_chunk_visit *visit, iso_error *error) {
    const keys_visit *keys = context;
    iso_exact *exact = NULL;
    iso_status status = create(keys->walk, visit, &exact, error);
    if (status == ISO_OK) status = iso_draw_exact_keys(keys->picture, exact, error);
    iso_exact_destroy(exact);
    return status;
}

iso_status iso_exact_chunks_draw(iso_chunk_walk *walk, iso_chunk_share share,
                                 const iso_exact_key_picture *picture, iso_error *error) {
    keys_visit keys = {walk, picture};
    return iso_chunk_walk_visit(walk, share, draw_keys, &keys, error);
}
