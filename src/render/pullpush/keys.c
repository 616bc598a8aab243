/* keys: surveys parts of a set of points, and projects them into a key image. */
#include "render/pullpush/keys.h"

#include <float.h>

#include "base/cpu.h"
#include "render/points/point_blocks.h"
#include "render/pullpush/setup.h"
#include "render/view/project.h"

enum {
    BAND_ROWS = 64, /* rows of the key image that a task draws; a power of two */
    FLIPS_PER_TASK = 1 << 16
};

/* ---- surveys */

iso_pullpush_survey iso_pullpush_survey_begin(void) {
    iso_pullpush_survey survey = {.closed = true, .radius = {FLT_MAX, 0}};
    for (int axis = 0; axis < 3; axis++) {
        survey.lo[axis] = DBL_MAX;
        survey.hi[axis] = -DBL_MAX;
    }
    return survey;
}

void iso_pullpush_survey_merge(iso_pullpush_survey *survey, const iso_pullpush_survey *other) {
    survey->closed = survey->closed && other->closed;
    if (other->radius[0] < survey->radius[0]) survey->radius[0] = other->radius[0];
    if (other->radius[1] > survey->radius[1]) survey->radius[1] = other->radius[1];
    for (int axis = 0; axis < 3; axis++) {
        survey->lo[axis] = iso_min(survey->lo[axis], other->lo[axis]);
        survey->hi[axis] = iso_max(survey->hi[axis], other->hi[axis]);
    }
}

void iso_pullpush_survey_put(const iso_pullpush_survey *survey, double numbers[ISO_SURVEY_NUMBERS]) {
    numbers[0] = survey->closed;
    numbers[1] = (double)survey->radius[0];
    numbers[2] = -(double)survey->radius[1];
    for (int axis = 0; axis < 3; axis++) {
        numbers[3 + axis] = survey->lo[axis];
        numbers[6 + axis] = -survey->hi[axis];
    }
}

iso_pullpush_survey iso_pullpush_survey_get(const double numbers[ISO_SURVEY_NUMBERS]) {
    iso_pullpush_survey survey = {.closed = numbers[0] > 0,
                                  .radius = {(float)numbers[1], (float)-numbers[2]}};
    for (int axis = 0; axis < 3; axis++) {
        survey.lo[axis] = numbers[3 + axis];
        survey.hi[axis] = -numbers[6 + axis];
    }
    return survey;
}

iso_status iso_pullpush_survey_add(iso_pullpush_survey *survey, const iso_view *view,
                                   const iso_point_view *points, iso_pool *pool, iso_error *error) {
    const iso_projector projector = iso_projector_make(view, &points->transform);
    iso_point_blocks blocks = {0};
    const iso_status status = iso_point_blocks_make(&blocks, points, &projector, pool, error);
    if (status == ISO_OK) {
        iso_pullpush_survey part = {.closed = points->closed, .radius = {blocks.radius[0], blocks.radius[1]}};
        for (int axis = 0; axis < 3; axis++) {
            part.lo[axis] = blocks.lo[axis];
            part.hi[axis] = blocks.hi[axis];
        }
        iso_pullpush_survey_merge(survey, &part);
    }
    iso_point_blocks_free(&blocks);
    return status;
}

iso_pullpush_base iso_pullpush_base_of(const iso_pullpush_survey *survey, const iso_view *view) {
    const iso_pyramid_layout layout = iso_pullpush_layout(view, survey->radius);
    const iso_pyramid_level level = iso_pyramid_level_of(&layout, layout.base);
    bool around_eye = true;
    for (int axis = 0; axis < 3; axis++) around_eye &= survey->lo[axis] <= 0 && survey->hi[axis] >= 0;
    return (iso_pullpush_base){.base = layout.base,
                               .top = layout.top,
                               .width = level.width,
                               .height = level.height,
                               .cull = survey->closed && !around_eye};
}

/* ---- drawing */

typedef struct key_bands {
    const iso_point_projection *projection;
    const iso_point_blocks *blocks;
    int height;
} key_bands;

static void project_band(void *context, size_t band, int worker) {
    (void)worker;
    const key_bands *bands = context;
    const size_t *start = bands->blocks->start.data;
    const uint32_t *order = bands->blocks->order.data;
    const iso_block_list list = {bands->blocks->blocks.data, order + start[band],
                                 start[band + 1] - start[band]};
    const int first = (int)band * BAND_ROWS, last = first + BAND_ROWS - 1;
    const iso_rows rows = {first, last < bands->height ? last : bands->height - 1};
    if (list.count) iso_pullpush_project_get()(bands->projection, &list, rows);
}

static iso_status draw_blocks(const iso_pullpush_keys *picture, const iso_point_view *points,
                              iso_point_blocks *blocks, iso_error *error) {
    const iso_pullpush_base *base = &picture->base;
    const iso_projector projector = iso_projector_make(picture->view, &points->transform);
    const iso_pyramid_layout layout = iso_pyramid_layout_of(picture->view, base->base, base->top);
    iso_pyramid pyramid = {
        .layout = layout, .keys = (int64_t *)picture->keys->keys, .key_stride = (size_t)picture->keys->width};
    pyramid.level[base->base] = iso_pyramid_level_of(&layout, base->base);
    iso_point_projection projection = iso_pullpush_projection(&layout, &projector, &points->transform,
                                                              points->packed != NULL, base->cull != 0);
    projection.points = points;
    projection.pyramid = &pyramid;
    ISO_TRY(iso_point_blocks_make(blocks, points, &projector, picture->pool, error));
    const iso_level_bands rows = iso_pyramid_bands(&pyramid, BAND_ROWS);
    ISO_TRY(iso_point_blocks_assign_bands(blocks, picture->view, &rows, base->cull != 0, error));
    key_bands bands = {&projection, blocks, base->height};
    iso_parallel_for(picture->pool, (size_t)((base->height - 1) / BAND_ROWS + 1), project_band, &bands);
    return ISO_OK;
}

iso_status iso_pullpush_draw_keys(const iso_pullpush_keys *picture, const iso_pullpush_survey *survey,
                                  const iso_point_view *points, iso_error *error) {
    iso_point_view part = *points;
    iso_point_blocks blocks = {0};
    part.closed = survey->closed;
    const iso_status status = draw_blocks(picture, &part, &blocks, error);
    iso_point_blocks_free(&blocks);
    return status;
}

/* ---- keys with and without a sign */

static void flip_signs(void *context, size_t task, int worker) {
    (void)worker;
    const iso_key_image *image = context;
    const size_t count = (size_t)image->width * (size_t)image->height, first = task * FLIPS_PER_TASK,
                 end = first + FLIPS_PER_TASK < count ? first + FLIPS_PER_TASK : count;
    for (size_t i = first; i < end; i++) image->keys[i] ^= (uint64_t)1 << 63;
}

void iso_pullpush_flip_keys(iso_key_image *image, iso_pool *pool) {
    const size_t count = (size_t)image->width * (size_t)image->height;
    iso_parallel_for(pool, (count + FLIPS_PER_TASK - 1) / FLIPS_PER_TASK, flip_signs, image);
}
