/* pyramid: choice of levels, and the arrangement of keys and planes in one piece of memory. */
#include "render/pullpush/pyramid.h"

#include <math.h>
#include <string.h>

enum {
    LANES = 16,       /* of the widest vectors */
    LEFT = LANES,     /* columns of the border at the left */
    RIGHT = 2 * LANES /* at least so many at the right: rows are read and written in pairs of vectors */
};

/* Least projected radius of discs in the base level, pixels of that level, when the base is above level 0. */
static const float BASE_RADIUS = 8;

static int round_up(int value, int multiple) {
    return (value + multiple - 1) / multiple * multiple;
}

void iso_pyramid_levels(const float radius[2], float low_pass, int *base, int *top) {
    float square = radius[1] * radius[1] + low_pass;
    *top = 1;
    while (*top < ISO_PYRAMID_TOP && square > 0.25f * (float)(1 << 2 * *top)) ++*top;
    *base = 0;
    while (*base < *top - 1 && radius[0] >= BASE_RADIUS * (float)(2 << *base)) ++*base;
}

/* Widens rows lo .. hi of level 0, counted from the first row of the whole picture's guard band, to all rows
 * that they depend on: a pixel depends on one more row on each side at every level. */
static void widen_rows(int top, int *lo, int *hi) {
    for (int level = 0; level < top; level++) {
        *lo = (*lo - 1) >> 1;
        *hi = (*hi + 1) >> 1;
    }
    *lo = *lo < 0 ? 0 : *lo << top;
    *hi = ((*hi + 1) << top) - 1;
}

iso_pyramid_layout iso_pyramid_layout_of(const iso_view *view, int base, int top) {
    int guard = 1 << (top > 1 ? top - 1 : 1);
    if (guard > ISO_PYRAMID_GUARD) guard = ISO_PYRAMID_GUARD;
    int last = view->above + view->height + view->below + 2 * guard - 1;
    int lo = view->above + guard, hi = lo + view->height - 1;
    widen_rows(top, &lo, &hi);
    if (hi > last) hi = last;
    return (iso_pyramid_layout){.base = base,
                                .top = top,
                                .guard = guard,
                                .column = -guard,
                                .row = lo - view->above - guard,
                                .rows_before = lo,
                                .width = view->width + 2 * guard,
                                .height = hi - lo + 1};
}

static bool has_plane(const iso_pyramid_layout *layout, int level, int plane) {
    const uint32_t optional = plane >= ISO_PLANE_OPTIONAL ? layout->planes >> plane & 1 : 0;
    if (layout->planes >> ISO_PLANE_PLACE & 1)
        return optional && (plane >= ISO_PLANE_PLACE ? level > 0 : level == layout->base);
    if (plane >= ISO_PLANE_OPTIONAL) return (level > 0 || layout->base == 0) && optional;
    return level > 0;
}

static size_t plane_floats(const iso_pyramid_level *level) {
    return level->stride * (size_t)(level->height + 2);
}

iso_pyramid_level iso_pyramid_level_of(const iso_pyramid_layout *layout, int number) {
    int less = (1 << number) - 1;
    int width = (layout->width + less) >> number, height = (layout->height + less) >> number;
    return (iso_pyramid_level){
        .width = width, .height = height, .stride = (size_t)(LEFT + round_up(width, LANES) + RIGHT)};
}

static size_t key_stride_of(const iso_pyramid_level *base) {
    return (size_t)round_up(base->width, 2 * LANES);
}

/* One row more than the level has: pull reads rows in pairs. */
static size_t key_count(const iso_pyramid_level *base) {
    return key_stride_of(base) * (size_t)(base->height + 1);
}

static size_t piece_count(const iso_pyramid_level *base) {
    return key_stride_of(base) / ISO_KEY_PIECE * (size_t)(base->height / 2 + 1);
}

static bool has_lines(const iso_pyramid_layout *layout) {
    return layout->planes >> ISO_PLANE_PLACE & 1;
}

/* Bytes of the starts of rows. */
static size_t start_bytes(const iso_pyramid_layout *layout, const iso_pyramid_level *base) {
    return has_lines(layout) ? (size_t)(base->height + 1) * sizeof(int32_t) : 0;
}

size_t iso_pyramid_bytes(const iso_pyramid_layout *layout) {
    const iso_pyramid_level base = iso_pyramid_level_of(layout, layout->base);
    if (key_count(&base) > INT32_MAX) return SIZE_MAX; /* places of keys are 32-bit numbers */
    size_t bytes = key_count(&base) * (sizeof(int64_t) + (layout->indexed ? sizeof(int32_t) : 0)) +
                   piece_count(&base) + start_bytes(layout, &base);
    for (int l = 0; l <= layout->top; l++) {
        iso_pyramid_level level = iso_pyramid_level_of(layout, l);
        for (int p = 0; p < ISO_PLANES; p++)
            if (has_plane(layout, l, p)) bytes += plane_floats(&level) * sizeof(float);
    }
    return bytes;
}

static void fill_floats(float *from, float *end, float value) {
    while (from < end) *from++ = value;
}

/* Sets the border of a plane: a row above and a row below, and the columns beside the pixels. */
static void set_border(const iso_pyramid_level *level, int plane) {
    float value = plane == ISO_PLANE_LOW || plane == ISO_PLANE_HIGH ? ISO_NOWHERE
                  : plane == ISO_PLANE_WIDE                         ? INFINITY
                                                                    : 0;
    float *row = level->plane[plane] - LEFT - level->stride;
    fill_floats(row, row + level->stride, value);
    for (int y = 0; y < level->height; y++) {
        row += level->stride;
        fill_floats(row, row + LEFT, value);
        fill_floats(row + LEFT + level->width, row + level->stride, value);
    }
    row += level->stride;
    fill_floats(row, row + level->stride, value);
}

/* Arranges all planes from `memory` on; returns their end. */
static char *arrange_planes(iso_pyramid *pyramid, char *memory) {
    float *next = (float *)memory;
    for (int l = 0; l <= pyramid->layout.top; l++) {
        iso_pyramid_level *level = &pyramid->level[l];
        for (int p = 0; p < ISO_PLANES; p++) {
            if (!has_plane(&pyramid->layout, l, p)) continue;
            level->plane[p] = next + level->stride + LEFT;
            set_border(level, p);
            next += plane_floats(level);
        }
    }
    return (char *)next;
}

iso_status iso_pyramid_resize(iso_pyramid *pyramid, const iso_pyramid_layout *layout, iso_error *error) {
    if (pyramid->memory.data && memcmp(layout, &pyramid->layout, sizeof *layout) == 0) return ISO_OK;
    size_t bytes = iso_pyramid_bytes(layout);
    if (bytes == SIZE_MAX) return iso_fail(error, ISO_ERR_NOMEM, "a picture of that size is impossible");
    pyramid->layout = (iso_pyramid_layout){0}; /* until the memory is there */
    ISO_TRY(iso_buffer_reserve(&pyramid->memory, bytes, 0, error));
    if (!has_lines(layout)) memset(pyramid->memory.data, 0, bytes);
    pyramid->layout = *layout;
    for (int l = 0; l <= layout->top; l++) pyramid->level[l] = iso_pyramid_level_of(layout, l);
    const iso_pyramid_level *base = &pyramid->level[layout->base];
    pyramid->key_stride = key_stride_of(base);
    size_t index = layout->indexed ? key_count(base) * sizeof(int32_t) : 0;
    char *memory = pyramid->memory.data;
    pyramid->keys = (int64_t *)memory;
    memory += key_count(base) * sizeof(int64_t);
    pyramid->index = layout->indexed ? (int32_t *)memory : NULL;
    memory = arrange_planes(pyramid, memory + index);
    pyramid->line_starts = has_lines(layout) ? (int32_t *)memory : NULL;
    pyramid->used = (uint8_t *)memory + start_bytes(layout, base);
    memset(pyramid->used, 1, piece_count(base));
    return ISO_OK;
}

void iso_pyramid_free(iso_pyramid *pyramid) {
    iso_buffer_free(&pyramid->memory);
    iso_buffer_free(&pyramid->line_fragments);
    *pyramid = (iso_pyramid){0};
}
