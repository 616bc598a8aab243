/* draw: deals the bins of a picture to threads. */
#include <math.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "render/shapes/fragments.h"
#include "render/shapes/kernel.h"

iso_rgb iso_shapes_color_at(const iso_shapes *shapes, uint32_t id, float along) {
    uint8_t rgb[3];
    for (int k = 0; k < 3; k++) {
        float value = (float)shapes->colors[id][k];
        if (iso_shapes_are_lines(shapes)) value += along * ((float)shapes->colors[id + 1][k] - value);
        rgb[k] = (uint8_t)(value + 0.5f);
    }
    return (iso_rgb){rgb[0], rgb[1], rgb[2]};
}

void iso_shapes_write_color(const iso_shapes_frame *frame, size_t sample, uint32_t id, float along) {
    const iso_target *target = frame->target;
    if (!frame->shapes->colors) return;
    const iso_rgb c = iso_shapes_color_at(frame->shapes, id, along);
    target->gbuffer->color[sample] =
        (uint32_t)(target->surface + 1) << 24 | (uint32_t)c.b << 16 | (uint32_t)c.g << 8 | c.r;
}

void iso_shapes_write_element(const iso_shapes_frame *frame, size_t sample, uint32_t id) {
    if (frame->target->gbuffer->element) frame->target->gbuffer->element[sample] = id + 1;
}

typedef struct shapes_draw {
    iso_shapes_frame frame;
    const iso_shapes_kernel *kernel;
    iso_shapes_bin *bins; /* by worker */
} shapes_draw;

/* Depths of the target, so that what is hidden there costs nothing; none of the shapes. */
static void open_bin(iso_shapes_bin *bin) {
    const iso_gbuffer *g = bin->frame->target->gbuffer;
    const iso_shapes_rect *r = &bin->rect;
    for (int i = 0; i < ISO_SHAPES_PIXELS; i++) bin->depth[i] = -INFINITY;
    for (int i = 0; i < ISO_SHAPES_PIXELS; i++) bin->record[i] = ISO_SHAPES_NONE;
    for (int y = r->y0; y <= r->y1; y++) {
        const float *from = g->depth + (size_t)(y - bin->frame->top) * (size_t)g->width + r->x0;
        memcpy(bin->depth + iso_shapes_pixel(bin, r->x0, y), from,
               (size_t)(r->x1 - r->x0 + 1) * sizeof *from);
    }
    bin->record_count = bin->near_count = 0;
}

/* Makes room for all shapes of a block. */
static iso_status reserve(iso_shapes_bin *bin) {
    const size_t shapes = ISO_SHAPES_BLOCK;
    const size_t record = (size_t)iso_shapes_record_floats(bin->frame->shapes->kind) * sizeof(float),
                 kept = bin->record_count * record, near = bin->near_count * sizeof(iso_near_shape);
    ISO_TRY(iso_buffer_reserve(&bin->records, kept + shapes * record, kept, NULL));
    return iso_buffer_reserve(&bin->near, near + shapes * sizeof(iso_near_shape), near, NULL);
}

static iso_shapes_rect meet(const iso_shapes_rect *a, const iso_shapes_rect *b) {
    return (iso_shapes_rect){a->x0 > b->x0 ? a->x0 : b->x0, a->y0 > b->y0 ? a->y0 : b->y0,
                             a->x1 < b->x1 ? a->x1 : b->x1, a->y1 < b->y1 ? a->y1 : b->y1};
}

/* ---- memory: the blocks in sight are read in an order that no processor foresees */

enum { CACHE_LINE = 64, AHEAD = 16 /* blocks of a list */ };

static void fetch(const void *from, size_t bytes) {
    for (size_t i = 0; i < bytes; i += CACHE_LINE) __builtin_prefetch((const char *)from + i);
}

/* Fetches what a block consists of. */
static void fetch_block(const iso_shapes *set, const iso_shapes_block *block) {
    const size_t first = block->first, count = block->count;
    if (iso_shapes_are_lines(set)) {
        fetch(set->runs.first + first, count * sizeof *set->runs.first);
        fetch(set->runs.length + first, count);
        return;
    }
    const float *const positions[3] = {set->x, set->y, set->z};
    for (int a = 0; a < 3; a++) fetch(positions[a] + first, count * sizeof **positions);
    fetch(set->id_low + first, count * sizeof *set->id_low);
    if (set->id_high) fetch(set->id_high + first, count);
    if (set->size) fetch(set->size + first, count);
}

/* Fetches what a fetched block refers to. */
static void fetch_shapes(const iso_shapes *set, const iso_shapes_block *block) {
    const size_t end = (size_t)block->first + block->count;
    for (size_t i = block->first; i < end && iso_shapes_are_lines(set); i++)
        fetch(set->vertices[set->runs.first[i]], (set->runs.length[i] + 1u) * sizeof *set->vertices);
    const bool apart = iso_shapes_kind(set) == ISO_SHAPE_SPHERE && set->radii && !set->size;
    for (size_t i = block->first; i < end && apart; i++)
        __builtin_prefetch(&set->radii[iso_shapes_id(set, i)]);
}

/* ---- bins */

static bool is_hidden(const iso_shapes_bin *bin, const iso_shapes_seen *seen) {
    const iso_shapes_rect rect = meet(&seen->rect, &bin->rect);
    return bin->kernel->hidden(bin, &rect, seen->nearest);
}

static void draw_block(iso_shapes_bin *bin, const iso_shapes_seen *seen) {
    if (is_hidden(bin, seen)) return; /* by the blocks between */
    bin->status = reserve(bin);
    if (bin->status == ISO_OK) bin->kernel->draw(bin, seen);
}

/* Draws listed blocks, each when two later ones have been found that are not hidden. */
static void draw_blocks(iso_shapes_bin *bin, const uint32_t *list, size_t count) {
    const iso_shapes_frame *frame = bin->frame;
    const iso_shapes *set = frame->shapes;
    const iso_shapes_seen *waiting[2] = {NULL, NULL};
    for (size_t i = 0; i < count && bin->status == ISO_OK; i++) {
        const iso_shapes_seen *seen = &frame->seen[list[i]];
        if (seen->is_cut) continue; /* iso_shapes_draw_cut draws it */
        if (i + AHEAD < count) __builtin_prefetch(&frame->seen[list[i + AHEAD]].rect);
        if (is_hidden(bin, seen)) continue;
        fetch_block(set, &set->blocks[seen->block]);
        if (waiting[1]) fetch_shapes(set, &set->blocks[waiting[1]->block]);
        if (waiting[0]) draw_block(bin, waiting[0]);
        waiting[0] = waiting[1];
        waiting[1] = seen;
    }
    for (int i = 0; i < 2; i++)
        if (waiting[i] && bin->status == ISO_OK) draw_block(bin, waiting[i]);
}

static void draw_bin(void *context, size_t index, int worker) {
    const shapes_draw *draw = context;
    const iso_shapes_frame *frame = &draw->frame;
    iso_shapes_bin *bin = &draw->bins[worker];
    const size_t begin = index ? frame->bin_end[index - 1] : 0, end = frame->bin_end[index];
    if (begin == end || bin->status != ISO_OK) return;
    bin->rect = iso_shapes_bin_rect(frame, index);
    open_bin(bin);
    draw->kernel->measure(bin);
    draw_blocks(bin, frame->bin_blocks + begin, end - begin);
    draw->kernel->resolve(bin);
    iso_near_resolve(bin);
}

static iso_status draw_bins(shapes_draw *draw, iso_shapes_drawn *drawn, iso_error *error) {
    const iso_shapes_frame *frame = &draw->frame;
    const int workers = iso_pool_threads(frame->target->pool);
    draw->bins = iso_alloc((size_t)workers * sizeof *draw->bins);
    if (!draw->bins) return iso_fail_memory(error, "shapes");
    for (int i = 0; i < workers; i++) {
        iso_shapes_bin *bin = &draw->bins[i];
        bin->frame = frame;
        bin->kernel = draw->kernel;
        bin->records = bin->near = (iso_buffer){0};
        bin->drawn = (iso_shapes_drawn){0};
        bin->status = ISO_OK;
    }
    iso_parallel_until(frame->target->pool, (size_t)frame->columns * (size_t)frame->rows, draw_bin, draw);
    iso_status status = ISO_OK;
    for (int i = 0; i < workers; i++) {
        if (draw->bins[i].status != ISO_OK) status = draw->bins[i].status;
        if (drawn) {
            drawn->samples += draw->bins[i].drawn.samples;
            drawn->widened += draw->bins[i].drawn.widened;
        }
        iso_buffer_free(&draw->bins[i].records);
        iso_buffer_free(&draw->bins[i].near);
    }
    iso_free(draw->bins);
    return status == ISO_OK ? ISO_OK : iso_fail_memory(error, "shapes");
}

iso_status iso_draw_shapes(const iso_target *target, const iso_shapes *shapes, iso_shapes_drawn *drawn,
                           iso_error *error) {
    if (shapes->colors) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    shapes_draw draw = {.kernel = ISO_KERNEL_UNIT(iso_shapes_kernel, iso_cpu_best())};
    iso_status status = iso_shapes_frame_make(target, shapes, &draw.frame, error);
    bool any = false;
    for (size_t i = 0; i < draw.frame.seen_count && status == ISO_OK; i++) any |= draw.frame.seen[i].is_cut;
    /* The segments of a line are one solid, into which a cut may look: they are all drawn in one way. */
    if (status == ISO_OK && !(any && iso_shapes_are_lines(shapes))) status = draw_bins(&draw, drawn, error);
    if (status == ISO_OK && any) status = iso_shapes_draw_cut(&draw.frame, drawn, error);
    iso_shapes_frame_free(&draw.frame);
    return status;
}
