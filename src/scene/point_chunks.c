/* point_chunks: extracts the points of one chunk after the other; surveys and draws them. */
#include "scene/point_chunks.h"

#include "extract/points/points.h"
#include "scene/bounds.h"

iso_status iso_point_chunk_extract(iso_rgrid *voxels, const iso_grid_chunk *chunk, double isovalue,
                                   iso_pool *pool, iso_point_set **points, iso_error *error) {
    const iso_grid grid = {.rgrid = voxels};
    const iso_points_opts opts = {
        .isovalue = isovalue, .primitive = ISO_PRIMITIVE_EDGE, .pool = pool, .chunk = chunk};
    iso_point_set *made = NULL;
    ISO_TRY(iso_point_set_create(&grid, &opts, &made, error));
    iso_status status = iso_point_set_update(made, error);
    if (status == ISO_OK) status = iso_point_set_bound(made, error);
    if (status == ISO_OK)
        *points = made;
    else
        iso_point_set_destroy(made);
    return status;
}

/* What is done with the points of each chunk. */
typedef struct point_visit {
    const iso_chunk_walk *walk;
    iso_status (*use)(const struct point_visit *visit, const iso_point_view *points, iso_error *error);
    iso_chunk_bounds *bounds;
    const iso_view *view;
    iso_pullpush_survey *survey;
    const iso_pullpush_keys *picture;
} point_visit;

static iso_status use_chunk(void *context, const iso_chunk_visit *visit, iso_error *error) {
    const point_visit *all = context;
    iso_point_set *points = NULL;
    const iso_chunk_walk_opts *walked = iso_chunk_walk_opts_of(all->walk);
    iso_status status =
        iso_point_chunk_extract(visit->grid, visit->chunk, walked->isovalue, walked->pool, &points, error);
    if (status == ISO_OK) {
        const iso_point_view view = iso_point_set_view(points);
        status = all->use(all, &view, error);
    }
    iso_point_set_destroy(points);
    return status;
}

static iso_status add_bounds(const point_visit *visit, const iso_point_view *points, iso_error *error) {
    (void)error;
    iso_chunk_bounds *bounds = visit->bounds;
    for (int i = 0; i < bounds->count; i++) {
        const iso_affine *affine = bounds->affines[i];
        const iso_box box = affine ? iso_bounds_of_each_point(points, affine) : iso_point_view_bounds(points);
        iso_bounds_add(&bounds->boxes[i], &box);
    }
    bounds->primitives += iso_point_view_count(points);
    return ISO_OK;
}

iso_status iso_point_chunks_bounds(iso_chunk_walk *walk, iso_chunk_bounds *bounds, iso_error *error) {
    point_visit visit = {.walk = walk, .use = add_bounds, .bounds = bounds};
    for (int i = 0; i < bounds->count; i++) bounds->boxes[i] = iso_box_empty();
    bounds->primitives = 0;
    return iso_chunk_walk_visit(walk, bounds->share, use_chunk, &visit, error);
}

static iso_status add_survey(const point_visit *visit, const iso_point_view *points, iso_error *error) {
    if (!points->span_count) return ISO_OK;
    return iso_pullpush_survey_add(visit->survey, visit->view, points,
                                   iso_chunk_walk_opts_of(visit->walk)->pool, error);
}

iso_status iso_point_chunks_survey(iso_chunk_walk *walk, iso_chunk_share share, const iso_view *view,
                                   iso_pullpush_survey *survey, iso_error *error) {
    point_visit visit = {.walk = walk, .use = add_survey, .view = view, .survey = survey};
    *survey = iso_pullpush_survey_begin();
    return iso_chunk_walk_visit(walk, share, use_chunk, &visit, error);
}

static iso_status draw(const point_visit *visit, const iso_point_view *points, iso_error *error) {
    if (!points->span_count) return ISO_OK;
    return iso_pullpush_draw_keys(visit->picture, visit->survey, points, error);
}

iso_status iso_point_chunks_draw(iso_chunk_walk *walk, iso_chunk_share share,
                                 const iso_pullpush_keys *picture, const iso_pullpush_survey *survey,
                                 iso_error *error) {
    iso_pullpush_survey whole = *survey;
    point_visit visit = {.walk = walk, .use = draw, .survey = &whole, .picture = picture};
    iso_pullpush_flip_keys(picture->keys, picture->pool);
    const iso_status status = iso_chunk_walk_visit(walk, share, use_chunk, &visit, error);
    iso_pullpush_flip_keys(picture->keys, picture->pool);
    return status;
}
