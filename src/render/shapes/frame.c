/* frame: culls blocks, sorts those in sight by their nearest depth and lists them by bin. */
#include "render/shapes/frame.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "render/view/project.h"

/* Pixels on a side of a block beyond which its shapes are placed one by one. */
static const double WIDE = 384;
/* A row or column that is far outside every picture, and fits into an int. */
static const double FAR_PIXELS = 1 << 24;

/* ---- the view */

static iso_shapes_frame frame_of(const iso_target *target, const iso_shapes *shapes) {
    const iso_view *view = target->view;
    iso_shapes_frame frame = {.shapes = shapes,
                              .target = target,
                              .eye = iso_vec3_sub(view->eye, shapes->origin),
                              .focal = view->focal,
                              .cx = view->cx,
                              .cy = view->cy + view->above,
                              .near = view->near,
                              .parallel = view->orthographic,
                              .length = (float)view->focal,
                              .slope = view->orthographic ? 0 : (float)(1 / view->focal),
                              .spread =
                                  view->orthographic || shapes->billboards ? 0 : (float)(1 / view->focal),
                              .fixed = view->orthographic ? (float)(1 / view->focal) : 0,
                              .top = view->above,
                              .columns = (view->width + ISO_SHAPES_BIN - 1) / ISO_SHAPES_BIN,
                              .rows = (view->height + ISO_SHAPES_BIN - 1) / ISO_SHAPES_BIN};
    memcpy(frame.rotation, view->rotation, sizeof frame.rotation);
    for (int i = 0; i < 9; i++) frame.turn[i] = (float)view->rotation[i];
    frame.center_x = (float)frame.cx;
    frame.center_y = (float)frame.cy;
    *(frame.parallel ? &frame.least_fixed : &frame.least_slope) = shapes->min_pixels / (2 * frame.focal);
    return frame;
}

iso_shapes_rect iso_shapes_bin_rect(const iso_shapes_frame *frame, size_t bin) {
    const iso_gbuffer *g = frame->target->gbuffer;
    const int x = (int)(bin % (size_t)frame->columns) * ISO_SHAPES_BIN,
              y = (int)(bin / (size_t)frame->columns) * ISO_SHAPES_BIN,
              x1 = x + ISO_SHAPES_BIN < g->width ? x + ISO_SHAPES_BIN : g->width,
              y1 = y + ISO_SHAPES_BIN < g->height ? y + ISO_SHAPES_BIN : g->height;
    return (iso_shapes_rect){x, y + frame->top, x1 - 1, y1 - 1 + frame->top};
}

/* ---- blocks in sight */

/* An interval of pixels relative to the optical axis, with a pixel more on both sides. */
typedef struct range {
    double low, high;
} range;

static range pixels_of(const iso_shapes_frame *frame, double middle, double half, const range *depth) {
    const double low = middle - half, high = middle + half;
    if (frame->parallel) return (range){low * frame->focal - 1, high * frame->focal + 1};
    if (!(depth->low > frame->near)) return (range){-FAR_PIXELS, FAR_PIXELS};
    const double most = frame->focal / depth->low, least = frame->focal / depth->high;
    return (range){low * (low < 0 ? most : least) - 1, high * (high > 0 ? most : least) + 1};
}

/* Clips a range to the pixels first .. last; false when none is left. */
static bool clip(range pixels, double axis, int first, int last, int *from, int *to) {
    const double low = pixels.low + axis, high = pixels.high + axis;
    if (!(high >= first && low <= last)) return false;
    *from = low > first ? (int)low : first;
    *to = high < last ? (int)high : last;
    return true;
}

/* Half the size of a block's box in view space, shapes included; returns how far these reach. */
static double turn_box(const iso_shapes_frame *frame, const iso_shapes_block *block, double depth,
                       double half[3]) {
    const double *m = frame->rotation;
    for (int a = 0; a < 3; a++)
        half[a] = fabs(m[3 * a]) * (double)block->half[0] + fabs(m[3 * a + 1]) * (double)block->half[1] +
                  fabs(m[3 * a + 2]) * (double)block->half[2];
    const double far = depth + half[2] > frame->near ? depth + half[2] : frame->near,
                 least = far * frame->least_slope + frame->least_fixed;
    const double reach = (double)block->reach > least ? (double)block->reach : least;
    for (int a = 0; a < 3; a++) half[a] += reach;
    return reach;
}

/* What the target's clip leaves of a block, whose shapes reach `reach` mm. */
static iso_clip_rest rest_of(const iso_shapes_frame *frame, const iso_shapes_block *block, double reach) {
    const iso_clip *clip = frame->target->clip;
    unsigned cutting;
    if (!clip || !clip->count) return ISO_CLIP_ALL;
    const float *o = block->origin, *h = block->half;
    const iso_vec3 centre =
        iso_vec3_add(frame->shapes->origin, iso_vec3_make((double)o[0], (double)o[1], (double)o[2]));
    const iso_vec3 half[3] = {
        {(double)h[0] + reach, 0, 0}, {0, (double)h[1] + reach, 0}, {0, 0, (double)h[2] + reach}};
    return iso_clip_of_box(clip, centre, half, &cutting);
}

static bool see(const iso_shapes_frame *frame, const iso_shapes_block *block, iso_shapes_seen *seen) {
    const iso_view *view = frame->target->view;
    const double origin[3] = {(double)block->origin[0], (double)block->origin[1], (double)block->origin[2]};
    double half[3];
    iso_shapes_to_view(frame, origin, seen->centre);
    const double reach = turn_box(frame, block, seen->centre[2], half);
    const iso_clip_rest rest = rest_of(frame, block, reach);
    seen->is_cut = rest == ISO_CLIP_SOME;
    if (rest == ISO_CLIP_NOTHING) return false;
    const double margin = 1e-6 * (fabs(seen->centre[2]) + half[2]);
    const range depth = {seen->centre[2] - half[2] - margin, seen->centre[2] + half[2] + margin};
    if (depth.high < frame->near) return false;
    const range x = pixels_of(frame, seen->centre[0], half[0], &depth),
                y = pixels_of(frame, seen->centre[1], half[1], &depth);
    const bool crosses = !(depth.low > frame->near);
    seen->apart = crosses || x.high - x.low > WIDE || y.high - y.low > WIDE;
    seen->nearest = (float)(crosses ? frame->near : depth.low);
    if (crosses && frame->near < -FLT_MAX) seen->nearest = -FLT_MAX;
    return clip(x, frame->cx, 0, view->width - 1, &seen->rect.x0, &seen->rect.x1) &&
           clip(y, frame->cy, frame->top, frame->top + view->height - 1, &seen->rect.y0, &seen->rect.y1);
}

/* ---- front to back */

/* Bits that compare like the floats that they stand for. */
static uint32_t sort_key(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

enum { DIGIT_BITS = 11, DIGITS = 3 };

/* A stable radix sort by the nearest depth: of equal depths, the block with the lower number stays first, in
 * every strip of a picture. */
typedef struct place {
    uint32_t key, index;
} place;

static void sort_digit(const place *from, place *to, size_t count, int shift) {
    size_t ends[(1 << DIGIT_BITS) + 1] = {0};
    const uint32_t mask = (1 << DIGIT_BITS) - 1;
    for (size_t i = 0; i < count; i++) ends[1 + (from[i].key >> shift & mask)]++;
    for (uint32_t d = 0; d < mask; d++) ends[d + 1] += ends[d];
    for (size_t i = 0; i < count; i++) to[ends[from[i].key >> shift & mask]++] = from[i];
}

static iso_status sort_seen(iso_shapes_frame *frame, iso_error *error) {
    const size_t count = frame->seen_count;
    iso_shapes_seen *sorted = iso_alloc(count * sizeof *sorted);
    place *places = iso_alloc(2 * count * sizeof *places), *from = places;
    const bool ready = sorted && places;
    place *to = ready ? places + count : NULL;
    for (size_t i = 0; i < count && ready; i++)
        from[i] = (place){sort_key(frame->seen[i].nearest), (uint32_t)i};
    for (int digit = 0; digit < DIGITS && ready; digit++) {
        sort_digit(from, to, count, digit * DIGIT_BITS);
        place *other = from;
        from = to;
        to = other;
    }
    for (size_t i = 0; i < count && ready; i++) sorted[i] = frame->seen[from[i].index];
    iso_free(places);
    iso_free(ready ? frame->seen : sorted);
    if (ready) frame->seen = sorted;
    return ready ? ISO_OK : iso_fail_memory(error, "shapes");
}

/* ---- bins */

/* Calls for each bin that a block can cover: counts (list NULL), or appends the block's index. */
static void deal(const iso_shapes_frame *frame, size_t *ends, uint32_t *list) {
    for (size_t i = 0; i < frame->seen_count; i++) {
        const iso_shapes_rect *r = &frame->seen[i].rect;
        for (int y = (r->y0 - frame->top) / ISO_SHAPES_BIN; y <= (r->y1 - frame->top) / ISO_SHAPES_BIN; y++)
            for (int x = r->x0 / ISO_SHAPES_BIN; x <= r->x1 / ISO_SHAPES_BIN; x++) {
                size_t *end = &ends[(size_t)y * (size_t)frame->columns + (size_t)x];
                if (list) list[*end] = (uint32_t)i;
                ++*end;
            }
    }
}

static iso_status list_bins(iso_shapes_frame *frame, iso_error *error) {
    const size_t bins = (size_t)frame->columns * (size_t)frame->rows;
    frame->bin_end = iso_alloc_zero(bins + 1, sizeof *frame->bin_end);
    if (!frame->bin_end) return iso_fail_memory(error, "shapes");
    deal(frame, frame->bin_end + 1, NULL);
    for (size_t i = 0; i < bins; i++) frame->bin_end[i + 1] += frame->bin_end[i];
    frame->bin_blocks = iso_alloc(frame->bin_end[bins] * sizeof *frame->bin_blocks);
    if (!frame->bin_blocks) return iso_fail_memory(error, "shapes");
    deal(frame, frame->bin_end, frame->bin_blocks);
    return ISO_OK;
}

iso_status iso_shapes_frame_see(const iso_target *target, const iso_shapes *shapes, iso_shapes_frame *frame,
                                iso_error *error) {
    *frame = frame_of(target, shapes);
    frame->seen = iso_alloc(shapes->block_count * sizeof *frame->seen);
    if (!frame->seen) return iso_fail_memory(error, "shapes");
    for (size_t i = 0; i < shapes->block_count; i++) {
        frame->seen[frame->seen_count].block = (uint32_t)i;
        frame->seen_count += see(frame, &shapes->blocks[i], &frame->seen[frame->seen_count]);
    }
    return sort_seen(frame, error);
}

iso_status iso_shapes_frame_make(const iso_target *target, const iso_shapes *shapes, iso_shapes_frame *frame,
                                 iso_error *error) {
    ISO_TRY(iso_shapes_frame_see(target, shapes, frame, error));
    return list_bins(frame, error);
}

void iso_shapes_frame_free(iso_shapes_frame *frame) {
    iso_free(frame->seen);
    iso_free(frame->bin_end);
    iso_free(frame->bin_blocks);
}
