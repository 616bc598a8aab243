/* set_fragments: projects the points of all sets, and adds triangles and ribbons. Points are told apart by
 * their numbers, which go on from one set to the next. */
#include "render/pullpush/set_fragments.h"

#include <math.h>

#include "base/memory.h"
#include "render/pullpush/setup.h"

/* ---- the sets of a view */

static void add_radii(iso_sets_frame *frame, const float radius[2]) {
    if (!(radius[0] <= radius[1])) return;
    frame->radius[0] = fminf(frame->radius[0], radius[0]);
    frame->radius[1] = fmaxf(frame->radius[1], radius[1]);
}

static iso_status make_points(iso_sets_frame *frame, iso_set_frame *made, const iso_target *target,
                              iso_error *error) {
    frame->projector = iso_projector_make(target->view, &made->points->transform);
    frame->colored |= made->points->colors != NULL;
    ISO_TRY(iso_point_blocks_make(&made->blocks, made->points, &frame->projector, target->pool, error));
    if (made->blocks.seen) add_radii(frame, made->blocks.radius);
    return ISO_OK;
}

static iso_status make_set(iso_sets_frame *frame, iso_set_frame *made, const iso_target *target,
                           iso_error *error) {
    const iso_pyramid_set *set = made->set;
    made->points = set->points;
    made->mesh = set->mesh;
    if (set->points && set->mesh) {
        ISO_TRY(iso_hybrid_parts_make(target->view, set->points, set->mesh, 0, &made->parts, error));
        made->points = &made->parts.points;
        made->mesh = &made->parts.mesh;
    }
    if (made->points) ISO_TRY(make_points(frame, made, target, error));
    if (!set->ribbons) return ISO_OK;
    ISO_TRY(iso_line_frame_make(set->ribbons, target, &made->lines, error));
    frame->colored |= set->ribbons->lines.colors != NULL;
    add_radii(frame, made->lines.radius);
    return ISO_OK;
}

/* Keys have normals in the index space of the points: from view space to there. */
static iso_status find_normals(iso_sets_frame *frame, iso_error *error) {
    double normal[9], inverse[9];
    for (int k = 0; k < 9; k++) normal[k] = (double)frame->projector.normal[k];
    if (!iso_matrix_invert(normal, inverse))
        return iso_fail(error, ISO_ERR_USAGE, "the axes of the points' volume lie in one plane");
    for (int k = 0; k < 9; k++) frame->polygons.normal[k] = (float)inverse[k];
    for (size_t i = 0; i < frame->count; i++)
        for (int k = 0; k < 9; k++) frame->sets[i].lines.normal[k] = inverse[k];
    return ISO_OK;
}

static void add_polygons(iso_sets_frame *frame, const iso_set_frame *made) {
    iso_polygon_set *polygons = &frame->polygon_sets[frame->polygons.count];
    if (!made->mesh || !made->mesh->span_count) return;
    *polygons = (iso_polygon_set){.mesh = made->mesh, .surface = made->set->surface};
    if (made->points && iso_matrix_invert(made->parts.choice.projector.matrix, polygons->to_index)) {
        polygons->choice = &made->parts.choice;
        polygons->radius = ISO_DISC_RADII * made->points->radius;
    }
    frame->polygons.count++;
}

/* How many numbers a set's points take: spans may have gaps between them. */
static size_t numbers_of(const iso_point_view *points) {
    size_t end = 0;
    for (size_t i = 0; i < points->span_count; i++) {
        const size_t last = points->spans[i].first + points->spans[i].count;
        if (last > end) end = last;
    }
    return end;
}

iso_status iso_sets_frame_make(const iso_pyramid_set *sets, size_t count, const iso_target *target,
                               iso_sets_frame *frame, iso_error *error) {
    const iso_transform world = iso_transform_identity();
    size_t first = 0;
    *frame = (iso_sets_frame){.sets = iso_alloc_zero(count + 1, sizeof *frame->sets),
                              .polygon_sets = iso_alloc_zero(count + 1, sizeof *frame->polygon_sets),
                              .projector = iso_projector_make(target->view, &world),
                              .radius = {INFINITY, 0}};
    if (!frame->sets || !frame->polygon_sets) return iso_fail_memory(error, "sets");
    frame->count = count;
    for (size_t i = 0; i < count; i++) {
        iso_set_frame *made = &frame->sets[i];
        made->set = &sets[i];
        made->first = (int32_t)first;
        ISO_TRY(make_set(frame, made, target, error));
        if (made->points) first += numbers_of(made->set->points);
        if (first > INT32_MAX) return iso_fail(error, ISO_ERR_LIMIT, "more than %d points", INT32_MAX);
        add_polygons(frame, made);
    }
    frame->polygons.sets = frame->polygon_sets;
    frame->polygons.projector = frame->projector;
    return find_normals(frame, error);
}

void iso_sets_frame_free(iso_sets_frame *frame) {
    for (size_t i = 0; i < frame->count; i++) {
        iso_hybrid_parts_free(&frame->sets[i].parts);
        iso_point_blocks_free(&frame->sets[i].blocks);
        iso_line_frame_free(&frame->sets[i].lines);
    }
    iso_gbuffer_free(&frame->polygons.picture);
    iso_free(frame->sets);
    iso_free(frame->polygon_sets);
    *frame = (iso_sets_frame){.sets = NULL};
}

/* ---- the fragments of a strip */

static int set_number(const iso_set_frame *made) {
    const bool ribbon = made->set->ribbons != NULL, colored = ribbon
                                                                  ? made->set->ribbons->lines.colors != NULL
                                                                  : made->points && made->points->colors;
    return made->set->surface + (ribbon ? ISO_SET_RIBBON : 0) + (colored ? ISO_SET_COLORED : 0);
}

iso_status iso_sets_frame_prepare(iso_sets_frame *frame, const iso_target *strip, const iso_pyramid *pyramid,
                                  int band_rows, iso_error *error) {
    for (size_t i = 0; i < frame->count; i++) {
        iso_set_frame *made = &frame->sets[i];
        made->lines.view = strip->view;
        made->lines.set = set_number(made);
        if (!made->points) continue;
        const bool cull = made->points->closed && !made->blocks.around_eye;
        iso_projector projector = frame->projector;
        projector.view = strip->view;
        made->projection = iso_pullpush_projection(&pyramid->layout, &projector, &made->points->transform,
                                                   made->points->packed, cull);
        made->projection.points = made->points;
        made->projection.pyramid = pyramid;
        made->projection.first = made->first;
        const iso_level_bands bands = iso_pyramid_bands(pyramid, band_rows);
        ISO_TRY(iso_point_blocks_assign_bands(&made->blocks, strip->view, &bands, cull, error));
    }
    return frame->polygons.count ? iso_polygons_rasterize(&frame->polygons, strip, &pyramid->layout, error)
                                 : ISO_OK;
}

/* The set that a point's number belongs to. */
static const iso_set_frame *set_of(const iso_sets_frame *frame, int32_t number) {
    const iso_set_frame *made = NULL;
    for (size_t i = 0; i < frame->count && frame->sets[i].first <= number; i++)
        if (frame->sets[i].points) made = &frame->sets[i];
    return made;
}

static void fetch_point(const iso_sets_frame *frame, const iso_pyramid_level *level, size_t at,
                        int32_t number) {
    const iso_set_frame *made = set_of(frame, number);
    const iso_point_view *points = made->points;
    const size_t point = (size_t)(number - made->first);
    const float radius =
        ISO_DISC_RADII * (points->radii ? fmaxf(points->radii[point], 0) : (float)points->radius);
    iso_set_planes_clear(level, at, set_number(made));
    level->plane[ISO_PLANE_RADIUS][at] = level->plane[ISO_PLANE_INTERVAL][at] = radius;
    for (int k = 0; points->colors && k < 3; k++)
        level->plane[ISO_PLANE_RED + k][at] = points->colors[point][k];
}

/* Sets the planes of all points in rows. */
static void fetch_points(const iso_sets_frame *frame, const iso_pyramid *pyramid, iso_rows rows) {
    const iso_pyramid_level *level = &pyramid->level[0];
    for (int y = rows.first; y <= rows.last; y++)
        for (int x = 0; x < level->width; x++) {
            const size_t place = (size_t)y * pyramid->key_stride + (size_t)x;
            if (pyramid->keys[place] != ISO_KEY_NONE)
                fetch_point(frame, level, (size_t)y * level->stride + (size_t)x, pyramid->index[place]);
        }
}

void iso_set_fragments_project(const iso_sets_frame *frame, const iso_pyramid *pyramid, size_t band,
                               iso_rows rows) {
    for (size_t i = 0; i < frame->count; i++) {
        const iso_set_frame *made = &frame->sets[i];
        if (!made->points) continue;
        const size_t *start = made->blocks.start.data;
        const uint32_t *order = made->blocks.order.data;
        const iso_block_list list = {made->blocks.blocks.data, order + start[band],
                                     start[band + 1] - start[band]};
        iso_pullpush_project_get()(&made->projection, &list, rows);
    }
    fetch_points(frame, pyramid, rows);
    if (frame->polygons.count) iso_polygon_fragments_project(&frame->polygons, pyramid, rows);
    for (size_t i = 0; i < frame->count; i++)
        if (frame->sets[i].set->ribbons) iso_line_fragments_project(&frame->sets[i].lines, pyramid, rows);
}
