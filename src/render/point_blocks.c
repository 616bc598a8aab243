#include "render/point_blocks.h"

#include <float.h>
#include <string.h>

enum {
    BLOCK_POINTS = 4096,
    CHUNK_BLOCKS = 512, /* one task's */
    FAR_ROW = 1 << 28   /* rows beyond are as good as it */
};

/* Points this many projected radii beyond the picture's sides still matter. */
static const double GUARD_RADII = 1.1;

/* What one task found out about its blocks. */
typedef struct chunk {
    size_t seen;
    float radius[2];
    double lo[3], hi[3]; /* view space */
} chunk;

typedef struct survey {
    const iso_point_view *points;
    const iso_projector *projector;
    iso_point_block *blocks;
    chunk *chunks;
    size_t count;
} survey;

/* Ranges in view space: of a block's centres, and of their radii in mm. */
typedef struct extent {
    double lo[3], hi[3];
    double radius[2];
} extent;

static double positive(double radius) {
    return radius > 0 ? radius : 0;
}

static void radius_range(const iso_point_view *points, const iso_point_block *block, double range[2]) {
    range[0] = range[1] = ISO_DISC_RADII * positive(points->radius);
    if (!points->radii) return;
    range[0] = DBL_MAX;
    range[1] = 0;
    for (size_t i = block->first; i < block->first + block->count; i++) {
        double radius = ISO_DISC_RADII * positive(points->radii[i]);
        range[0] = fmin(range[0], radius);
        range[1] = fmax(range[1], radius);
    }
}

/* False when there is no point in the block. Packed points cannot leave [-2, 18); floats can, and are looked
 * at. */
static bool block_extent(const survey *s, const iso_point_block *block, extent *out) {
    iso_box box;
    if (s->points->surfels) {
        box = iso_surfel_bounds(s->points->surfels + block->first, block->count, block->brick);
        if (iso_box_is_empty(&box)) return false;
    } else {
        const int32_t *b = block->brick;
        box.lo = iso_vec3_make(b[0] * 16.0 - 2, b[1] * 16.0 - 2, b[2] * 16.0 - 2);
        box.hi = iso_vec3_make(b[0] * 16.0 + 18, b[1] * 16.0 + 18, b[2] * 16.0 + 18);
    }
    iso_vec3 center = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    iso_vec3 half = iso_vec3_sub(box.hi, center);
    for (int axis = 0; axis < 3; axis++) {
        const double *m = s->projector->matrix + 3 * axis;
        double at = m[0] * center.x + m[1] * center.y + m[2] * center.z + s->projector->origin[axis];
        double reach = fabs(m[0]) * half.x + fabs(m[1]) * half.y + fabs(m[2]) * half.z;
        out->lo[axis] = at - reach;
        out->hi[axis] = at + reach;
    }
    radius_range(s->points, block, out->radius);
    return true;
}

/* The sides of the whole picture, in pixels from the optical axis: left, right or top, bottom. */
static void picture_side(const iso_view *view, int axis, double side[2]) {
    side[0] = axis == 0 ? -view->cx : -view->above - view->cy;
    side[1] = axis == 0 ? view->width - view->cx : view->height + view->below - view->cy;
}

/* The least depth at which something of [lo, hi], widened by the radii, is between the sides; `near` at
 * least. */
static double least_depth(const iso_view *view, const extent *e, double near) {
    double least = near, widen = GUARD_RADII * e->radius[1];
    for (int axis = 0; axis < 2; axis++) {
        double side[2];
        picture_side(view, axis, side);
        if (side[1] > 0) least = fmax(least, (e->lo[axis] - widen) * view->focal / side[1]);
        if (side[0] < 0) least = fmax(least, (e->hi[axis] + widen) * view->focal / side[0]);
    }
    return least;
}

/* Whether [lo, hi] at depths near .. far comes between the picture's sides on this axis; its range of pixels
 * without the radii goes to `pixels`. */
static bool meets_sides(const iso_view *view, const extent *e, int axis, const double depth[2],
                        double pixels[2]) {
    double side[2], lo = e->lo[axis], hi = e->hi[axis], widen = GUARD_RADII * e->radius[1];
    picture_side(view, axis, side);
    if (view->orthographic) {
        pixels[0] = lo * view->focal;
        pixels[1] = hi * view->focal;
        return (lo - widen) * view->focal < side[1] && (hi + widen) * view->focal > side[0];
    }
    pixels[0] = lo * view->focal / (lo < 0 ? depth[0] : depth[1]);
    pixels[1] = hi * view->focal / (hi > 0 ? depth[0] : depth[1]);
    lo -= widen;
    hi += widen;
    return lo * view->focal / (lo < 0 ? depth[0] : depth[1]) < side[1] &&
           hi * view->focal / (hi > 0 ? depth[0] : depth[1]) > side[0];
}

static int32_t whole_row(double row) {
    row = floor(row);
    return (int32_t)(row < -FAR_ROW ? -FAR_ROW : row > FAR_ROW ? FAR_ROW : row);
}

static void look(const iso_view *view, const extent *e, iso_point_block *block) {
    block->seen = false;
    if (!(e->hi[2] >= view->near)) return;
    double depth[2] = {fmax(e->lo[2], view->near), e->hi[2]}, columns[2], rows[2];
    if (!view->orthographic) depth[0] = least_depth(view, e, depth[0]);
    if (!(depth[0] <= depth[1])) return;
    if (!meets_sides(view, e, 0, depth, columns) || !meets_sides(view, e, 1, depth, rows)) return;
    block->seen = true;
    for (int end = 0; end < 2; end++) {
        double scale = view->orthographic ? view->focal : view->focal / depth[1 - end];
        block->row[end] = whole_row(rows[end] + (end ? 1 : -1));
        block->radius[end] = (float)(e->radius[end] * scale);
    }
}

static void survey_chunk(void *context, size_t index, int worker) {
    (void)worker;
    const survey *s = context;
    chunk found = {
        .radius = {FLT_MAX, 0}, .lo = {DBL_MAX, DBL_MAX, DBL_MAX}, .hi = {-DBL_MAX, -DBL_MAX, -DBL_MAX}};
    size_t end = (index + 1) * CHUNK_BLOCKS;
    for (size_t i = index * CHUNK_BLOCKS; i < end && i < s->count; i++) {
        iso_point_block *block = &s->blocks[i];
        extent e;
        block->seen = false;
        if (!block_extent(s, block, &e)) continue;
        for (int axis = 0; axis < 3; axis++) {
            found.lo[axis] = fmin(found.lo[axis], e.lo[axis]);
            found.hi[axis] = fmax(found.hi[axis], e.hi[axis]);
        }
        look(s->projector->view, &e, block);
        if (!block->seen) continue;
        found.seen++;
        if (block->radius[0] < found.radius[0]) found.radius[0] = block->radius[0];
        if (block->radius[1] > found.radius[1]) found.radius[1] = block->radius[1];
    }
    s->chunks[index] = found;
}

static void sum_up(iso_point_blocks *blocks, const chunk *chunks, size_t count) {
    double lo[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, hi[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    blocks->seen = 0;
    blocks->radius[0] = FLT_MAX;
    blocks->radius[1] = 0;
    for (size_t i = 0; i < count; i++) {
        blocks->seen += chunks[i].seen;
        blocks->radius[0] = fminf(blocks->radius[0], chunks[i].radius[0]);
        blocks->radius[1] = fmaxf(blocks->radius[1], chunks[i].radius[1]);
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = fmin(lo[axis], chunks[i].lo[axis]);
            hi[axis] = fmax(hi[axis], chunks[i].hi[axis]);
        }
    }
    blocks->around_eye = true;
    for (int axis = 0; axis < 3; axis++) blocks->around_eye &= lo[axis] <= 0 && hi[axis] >= 0;
}

static size_t count_blocks(const iso_point_view *points) {
    size_t count = 0;
    for (size_t s = 0; s < points->span_count; s++)
        count += ((size_t)points->spans[s].count + BLOCK_POINTS - 1) / BLOCK_POINTS;
    return count;
}

static void cut(const iso_point_view *points, iso_point_block *block) {
    for (size_t s = 0; s < points->span_count; s++) {
        const iso_point_span *span = &points->spans[s];
        for (uint32_t done = 0; done < span->count; block++) {
            uint32_t left = span->count - done;
            block->count = left < BLOCK_POINTS ? left : BLOCK_POINTS;
            block->first = span->first + done;
            memcpy(block->brick, span->brick, sizeof block->brick);
            done += block->count;
        }
    }
}

iso_status iso_point_blocks_make(iso_point_blocks *blocks, const iso_point_view *points,
                                 const iso_projector *projector, iso_pool *pool, iso_error *error) {
    size_t count = count_blocks(points), chunks = (count + CHUNK_BLOCKS - 1) / CHUNK_BLOCKS;
    ISO_TRY(iso_buffer_reserve(&blocks->blocks, count * sizeof(iso_point_block), 0, error));
    ISO_TRY(iso_buffer_reserve(&blocks->chunks, chunks * sizeof(chunk), 0, error));
    blocks->count = count;
    cut(points, blocks->blocks.data);
    survey s = {points, projector, blocks->blocks.data, blocks->chunks.data, count};
    iso_parallel_for(pool, chunks, survey_chunk, &s);
    sum_up(blocks, s.chunks, chunks);
    return ISO_OK;
}

/* Bands first .. last that the block's rows are in; none when first > last. */
static iso_rows bands_of(const iso_point_block *block, double first_row, int base, int band_rows, int bands) {
    double size = (double)band_rows * (1 << base);
    double first = floor((block->row[0] - first_row) / size),
           last = floor((block->row[1] - first_row) / size);
    if (!block->seen || first >= bands || last < 0) return (iso_rows){0, -1};
    return (iso_rows){first < 0 ? 0 : (int)first, last >= bands ? bands - 1 : (int)last};
}

iso_status iso_point_blocks_deal(iso_point_blocks *blocks, const iso_view *view, const iso_pyramid *pyramid,
                                 int band_rows, iso_error *error) {
    const int base = pyramid->shape.base, rows = pyramid->level[base].height;
    const int bands = (rows + band_rows - 1) / band_rows;
    const double first_row = pyramid->shape.row - view->cy; /* from the optical axis */
    const iso_point_block *block = blocks->blocks.data;
    ISO_TRY(iso_buffer_reserve(&blocks->start, ((size_t)bands + 2) * sizeof(size_t), 0, error));
    size_t *start = blocks->start.data;
    memset(start, 0, ((size_t)bands + 2) * sizeof(size_t));
    for (size_t i = 0; i < blocks->count; i++) {
        iso_rows in = bands_of(&block[i], first_row, base, band_rows, bands);
        for (int b = in.first; b <= in.last; b++) start[b + 2]++;
    }
    for (int b = 0; b < bands; b++) start[b + 2] += start[b + 1];
    ISO_TRY(iso_buffer_reserve(&blocks->order, (start[bands + 1] + 1) * sizeof(uint32_t), 0, error));
    uint32_t *order = blocks->order.data;
    for (size_t i = 0; i < blocks->count; i++) {
        iso_rows in = bands_of(&block[i], first_row, base, band_rows, bands);
        for (int b = in.first; b <= in.last; b++) order[start[b + 1]++] = (uint32_t)i;
    }
    return ISO_OK;
}

void iso_point_blocks_free(iso_point_blocks *blocks) {
    iso_buffer_free(&blocks->blocks);
    iso_buffer_free(&blocks->chunks);
    iso_buffer_free(&blocks->order);
    iso_buffer_free(&blocks->start);
    *blocks = (iso_point_blocks){0};
}
