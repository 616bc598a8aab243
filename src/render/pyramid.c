#include "render/pyramid.h"

#include <math.h>
#include <string.h>

enum {
    LANES = 16, /* of the widest vectors */
    LEFT = LANES,
    RIGHT = 2 * LANES /* border columns; pairs of vectors of an odd row end up to RIGHT beyond */
};

static int round_up(int value, int multiple) {
    return (value + multiple - 1) / multiple * multiple;
}

/* Rows of level 0, from the whole frame's first, that rows lo .. hi depend on: at each step up a pixel takes
 * in one more on each side. */
static void widen_rows(int top, int *lo, int *hi) {
    for (int level = 0; level < top; level++) {
        *lo = (*lo - 1) >> 1;
        *hi = (*hi + 1) >> 1;
    }
    *lo = *lo < 0 ? 0 : *lo << top;
    *hi = ((*hi + 1) << top) - 1;
}

iso_pyramid_shape iso_pyramid_shape_of(const iso_view *view, int base, int top) {
    int guard = 1 << (top > 1 ? top - 1 : 1);
    if (guard > ISO_PYRAMID_GUARD) guard = ISO_PYRAMID_GUARD;
    int last = view->above + view->height + view->below + 2 * guard - 1;
    int lo = view->above + guard, hi = lo + view->height - 1;
    widen_rows(top, &lo, &hi);
    if (hi > last) hi = last;
    return (iso_pyramid_shape){.base = base,
                               .top = top,
                               .guard = guard,
                               .column = -guard,
                               .row = lo - view->above - guard,
                               .rows_before = lo,
                               .width = view->width + 2 * guard,
                               .height = hi - lo + 1};
}

static bool has_plane(const iso_pyramid_shape *shape, int level, int plane) {
    if (plane >= ISO_PLANE_OPTIONAL) return (level > 0 || shape->base == 0) && (shape->planes >> plane & 1);
    return level > 0;
}

static size_t plane_floats(const iso_pyramid_level *level) {
    return level->stride * (size_t)(level->height + 2);
}

/* Sets the levels' sizes and returns the bytes of all their planes. */
static size_t measure(iso_pyramid *pyramid) {
    const iso_pyramid_shape *shape = &pyramid->shape;
    size_t bytes = 0;
    int width = shape->width, height = shape->height;
    for (int l = 0; l <= shape->top; l++) {
        iso_pyramid_level *level = &pyramid->level[l];
        *level = (iso_pyramid_level){
            .width = width, .height = height, .stride = (size_t)(LEFT + round_up(width, LANES) + RIGHT)};
        for (int p = 0; p < ISO_PLANES; p++)
            if (has_plane(shape, l, p)) bytes += plane_floats(level) * sizeof(float);
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    return bytes;
}

static void fill(float *from, float *end, float value) {
    while (from < end) *from++ = value;
}

/* The border is what is no pixel: whole rows before and after, and the ends of the others. */
static void make_border(const iso_pyramid_level *level, int plane) {
    float value = plane == ISO_PLANE_LOW || plane == ISO_PLANE_HIGH ? ISO_NOWHERE
                  : plane == ISO_PLANE_WIDE                         ? INFINITY
                                                                    : 0;
    float *row = level->plane[plane] - LEFT - level->stride;
    fill(row, row + level->stride, value);
    for (int y = 0; y < level->height; y++) {
        row += level->stride;
        fill(row, row + LEFT, value);
        fill(row + LEFT + level->width, row + level->stride, value);
    }
    row += level->stride;
    fill(row, row + level->stride, value);
}

static void lay_planes(iso_pyramid *pyramid, char *memory) {
    float *next = (float *)memory;
    for (int l = 0; l <= pyramid->shape.top; l++) {
        iso_pyramid_level *level = &pyramid->level[l];
        for (int p = 0; p < ISO_PLANES; p++) {
            if (!has_plane(&pyramid->shape, l, p)) continue;
            level->plane[p] = next + level->stride + LEFT;
            make_border(level, p);
            next += plane_floats(level);
        }
    }
}

iso_status iso_pyramid_reshape(iso_pyramid *pyramid, const iso_pyramid_shape *shape, iso_error *error) {
    if (pyramid->memory.data && memcmp(shape, &pyramid->shape, sizeof *shape) == 0) return ISO_OK;
    pyramid->shape = *shape;
    size_t planes = measure(pyramid);
    const iso_pyramid_level *base = &pyramid->level[shape->base];
    pyramid->key_stride = (size_t)round_up(base->width, 2 * LANES);
    size_t pixels = pyramid->key_stride * (size_t)(base->height + 1);
    size_t index = shape->indexed ? pixels * sizeof(int32_t) : 0;
    iso_status status =
        iso_buffer_reserve(&pyramid->memory, pixels * sizeof(int64_t) + index + planes, 0, error);
    if (status != ISO_OK) {
        pyramid->shape = (iso_pyramid_shape){0};
        return status;
    }
    char *memory = pyramid->memory.data;
    memset(memory, 0, pixels * sizeof(int64_t) + index + planes);
    pyramid->keys = (int64_t *)memory;
    memory += pixels * sizeof(int64_t);
    pyramid->index = shape->indexed ? (int32_t *)memory : NULL;
    lay_planes(pyramid, memory + index);
    return ISO_OK;
}

void iso_pyramid_free(iso_pyramid *pyramid) {
    iso_buffer_free(&pyramid->memory);
    *pyramid = (iso_pyramid){0};
}
