/* cap_chunks: chunks that a slice passes, or that a clip cuts and that have something of the solid, whether
 * or not the surface crosses them. */
#include "scene/cap_chunks.h"

#include <math.h>

typedef struct caps_visit {
    const iso_cut_caps *caps;
    const iso_view *view;
    iso_key_image *keys;
    iso_pool *pool;
    iso_affine affine;
    double isovalue; /* stored */
    bool level_set;
} caps_visit;

/* The index coordinates of a chunk's cells. */
static void find_cells(const iso_grid_chunk *chunk, double low[3], double high[3]) {
    for (int axis = 0; axis < 3; axis++) {
        const int end = chunk->box.end[axis] * ISO_BRICK, last = chunk->dims[axis] - 1;
        low[axis] = chunk->box.first[axis] * ISO_BRICK;
        high[axis] = end < last ? end : last;
    }
}

/* Whether a slice passes a box, which is given by its centre and its half sides. */
static bool is_sliced(const iso_cut_caps *caps, iso_vec3 centre, const iso_vec3 half[3]) {
    for (int i = 0; i < caps->slice_count; i++) {
        const double *plane = caps->slices[i].plane;
        const iso_vec3 normal = {plane[0], plane[1], plane[2]};
        double reach = 0;
        for (int k = 0; k < 3; k++) reach += fabs(iso_vec3_dot(normal, half[k]));
        if (fabs(iso_vec3_dot(normal, centre) - plane[3]) <= reach) return true;
    }
    return false;
}

/* iso_chunk_chooser: whether a slice passes the chunk, or some of it is in the solid and something cuts it.
 */
static bool may_have_caps(void *context, const iso_grid_chunk *chunk, const iso_brick_range *range) {
    const caps_visit *all = context;
    const iso_clip *clip = all->caps->caps ? all->caps->solids[0].clip : NULL;
    double low[3], high[3];
    unsigned cutting;
    find_cells(chunk, low, high);
    iso_vec3 half[3];
    const iso_vec3 middle = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2},
                   centre = iso_affine_point(&all->affine, middle);
    for (int axis = 0; axis < 3; axis++) {
        const double reach = (high[axis] - low[axis]) / 2 + 0.01;
        half[axis] = iso_affine_vector(
            &all->affine, iso_vec3_make(reach * (axis == 0), reach * (axis == 1), reach * (axis == 2)));
    }
    if (is_sliced(all->caps, centre, half)) return true;
    if (range && !(all->level_set ? range->lo < all->isovalue : range->hi >= all->isovalue)) return false;
    return clip && clip->count && iso_clip_of_box(clip, centre, half, &cutting) == ISO_CLIP_SOME;
}

/* iso_chunk_visitor. */
static iso_status draw_chunk(void *context, const iso_chunk_visit *visit, iso_error *error) {
    const caps_visit *all = context;
    const iso_grid_chunk *chunk = visit->chunk;
    iso_cap_part part = {.grid = {.rgrid = visit->grid}};
    find_cells(chunk, part.low, part.high);
    for (int axis = 0; axis < 3; axis++) part.origin[axis] = chunk->origin[axis] * ISO_BRICK;
    return iso_caps_draw_keys(all->caps, &part, all->view, all->keys, all->pool, error);
}

iso_status iso_cap_chunks_draw(iso_chunk_walk *walk, iso_chunk_share share, const iso_cut_caps *caps,
                               const iso_view *view, iso_key_image *keys, iso_error *error) {
    const iso_capped *solid = &caps->solids[0];
    caps_visit all = {.caps = caps,
                      .view = view,
                      .keys = keys,
                      .pool = iso_chunk_walk_opts_of(walk)->pool,
                      .affine = iso_transform_affine(iso_grid_transform(solid->grid)),
                      .isovalue = iso_grid_stored(solid->grid, solid->isovalue),
                      .level_set = iso_grid_is_level_set(solid->grid) != 0};
    return iso_chunk_walk_visit_wanted(walk, share, may_have_caps, draw_chunk, &all, error);
}
