/* point_blocks: cuts spans into blocks, bounds each block in view space and in the picture, and sorts blocks
 * into bands by counting. The bounds are conservative: a block that is not `seen` covers no pixel. */
#include "render/points/point_blocks.h"

#include <float.h>
#include <string.h>

#include "base/point_bounds.h"

enum {
    BLOCK_POINTS = 4096,
    CHUNK = 512,        /* spans or blocks of one task */
    FAR_PIXEL = 1 << 28 /* rows and columns are clamped to +-FAR_PIXEL */
};

/* Discs may be larger than ISO_DISC_RADII by this factor: those of the method discs have up to
 * 1.415 radii of their points (ISO_DISCS_BALL + ISO_DISCS_BALL_MORE), 1.415 < 1.15 * 1.25. */
static const double GUARD_RADII = 1.15;

/* The blocks of one task, first .. end - 1, and their totals. */
typedef struct chunk {
    size_t first, end;
    size_t seen;         /* number of blocks seen */
    float radius[2];     /* range of their projected radii, pixels */
    double lo[3], hi[3]; /* box of all blocks, view space */
} chunk;

/* The properties of a block that do not depend on the view. */
typedef struct block_measure {
    iso_point_bounds bounds;
    double radius[2]; /* mm, of its discs */
} block_measure;

/* The fields of a block that its band depends on: a copy, because a block is six times as large. */
typedef struct block_rows {
    int32_t row[2]; /* as in the block; row[0] > row[1] when the block is not seen */
    bool back_facing;
} block_rows;

/* The picture's two sides along an axis, in pixels from the optical axis, and how far the silhouette of a
 * sphere reaches beyond its centre there, in radii: more than 1, because the rays are oblique. */
typedef struct picture_sides {
    double at[2], reach;
} picture_sides;

/* The computation of the view-dependent fields of all blocks. Exactly one of `points` and `measures` is set:
 * with `points` the tasks cut spans into blocks and measure them, with `measures` both has been done. */
typedef struct placement {
    const iso_point_view *points;
    const block_measure *measures; /* one per block */
    double radius;                 /* of discs of points without radii of their own, mm */
    bool closed;
    const iso_projector *projector;
    picture_sides sides[2]; /* of columns and of rows */
    double eye[3];          /* result of iso_projector_eye */
    iso_point_block *blocks;
    block_rows *rows;
    chunk *chunks;
} placement;

/* Ranges of a block in view space: its points' centres and the radii of its discs, mm. */
typedef struct extent {
    double lo[3], hi[3];
    double radius[2];
} extent;

/* Range of the radii of a block's discs, mm. */
static void radius_range(const iso_point_view *points, const iso_point_block *block, double range[2]) {
    range[0] = range[1] = ISO_DISC_RADII * iso_max(points->radius, 0) * (double)block->scale;
    if (!points->radii) return;
    range[0] = DBL_MAX;
    range[1] = 0;
    const float scale = iso_point_view_radii_scale(points);
    for (size_t i = block->first; i < block->first + block->count; i++) {
        double radius = ISO_DISC_RADII * iso_max((double)(points->radii[i] * scale), 0);
        range[0] = iso_min(range[0], radius);
        range[1] = iso_max(range[1], radius);
    }
}

/* Box of the block's centres in view space. False: the block contains no point. */
static bool block_extent(const placement *s, const iso_point_block *block, const iso_point_bounds *bounds,
                         extent *out) {
    if (!(bounds->lo[0] <= bounds->hi[0])) return false;
    double center[3], half[3];
    for (int k = 0; k < 3; k++) {
        double lo = bounds->lo[k], hi = bounds->hi[k];
        center[k] = block->brick[k] * (double)ISO_BRICK + (lo + hi) / 2;
        half[k] = (hi - lo) / 2;
    }
    for (int axis = 0; axis < 3; axis++) {
        const double *m = s->projector->matrix + 3 * axis;
        double at = m[0] * center[0] + m[1] * center[1] + m[2] * center[2] + s->projector->origin[axis];
        double reach = fabs(m[0]) * half[0] + fabs(m[1]) * half[1] + fabs(m[2]) * half[2];
        out->lo[axis] = at - reach;
        out->hi[axis] = at + reach;
    }
    return true;
}

static picture_sides sides_of_view(const iso_view *view, int axis) {
    picture_sides side;
    side.at[0] = axis == 0 ? -view->cx : -view->above - view->cy;
    side.at[1] = axis == 0 ? view->width - view->cx : view->height + view->below - view->cy;
    const double slope = view->orthographic ? 0 : fmax(fabs(side.at[0]), fabs(side.at[1])) / view->focal;
    side.reach = sqrt(1 + slope * slope);
    return side;
}

/* How far outside the picture, in mm at its depth, the centre of a disc that covers a pixel can lie. */
static double reach_beyond(const picture_sides *side, const extent *e) {
    return GUARD_RADII * e->radius[1] * side->reach;
}

/* The least depth, from `near` on, at which a disc of the block can be between the picture's sides. */
static double nearest_depth(const placement *s, const extent *e, double near) {
    const double focal = s->projector->view->focal;
    double nearest = near;
    for (int axis = 0; axis < 2; axis++) {
        const double *side = s->sides[axis].at, widen = reach_beyond(&s->sides[axis], e);
        double lo = (e->lo[axis] - widen) * focal, hi = (e->hi[axis] + widen) * focal;
        if (side[1] > 0 && lo > nearest * side[1]) nearest = lo / side[1];
        if (side[0] < 0 && hi < nearest * side[0]) nearest = hi / side[0];
    }
    return nearest;
}

/* Whether discs of the block can lie between the picture's two sides along this axis. `scale`: pixels per mm
 * at the block's least and greatest depth. The range of the centres goes to `pixels`. */
static bool meets_sides(const picture_sides *sides, const extent *e, int axis, const double scale[2],
                        double pixels[2]) {
    const double *side = sides[axis].at, widen = reach_beyond(&sides[axis], e);
    double lo = e->lo[axis], hi = e->hi[axis];
    pixels[0] = lo * scale[lo < 0 ? 0 : 1];
    pixels[1] = hi * scale[hi > 0 ? 0 : 1];
    lo -= widen;
    hi += widen;
    return lo * scale[lo < 0 ? 0 : 1] < side[1] && hi * scale[hi > 0 ? 0 : 1] > side[0];
}

/* floor, clamped to +-FAR_PIXEL; floor itself would be a library call. */
static int32_t floor_to_pixel(double at) {
    at = at < -FAR_PIXEL ? -FAR_PIXEL : at > FAR_PIXEL ? FAR_PIXEL : at;
    const int32_t whole = (int32_t)at;
    return whole > at ? whole - 1 : whole;
}

/* Moves a depth up or down (by = 1 or -1) by more than the rounding error of depths in floats. */
static float widen_depth(double depth, double by) {
    return (float)(depth + by * 1e-5 * fabs(depth));
}

/* Sets a block's rows, columns, depths and radii, and whether it is seen. */
static void place_extent(const placement *s, const extent *e, iso_point_block *block) {
    const iso_view *view = s->projector->view;
    if (!(e->hi[2] >= view->near)) return;
    double scale[2] = {view->focal, view->focal}, columns[2], rows[2];
    block->clipped = false;
    if (!view->orthographic) {
        double near = nearest_depth(s, e, iso_max(e->lo[2], view->near));
        if (!(near <= e->hi[2])) return;
        block->clipped = near > e->lo[2];
        scale[0] /= near;
        scale[1] /= e->hi[2];
    }
    if (!meets_sides(s->sides, e, 0, scale, columns) || !meets_sides(s->sides, e, 1, scale, rows)) return;
    block->seen = true;
    block->row[0] = floor_to_pixel(rows[0] - 1);
    block->row[1] = floor_to_pixel(rows[1] + 1);
    block->column[0] = floor_to_pixel(columns[0] - 1);
    block->column[1] = floor_to_pixel(columns[1] + 1);
    block->depth[0] = widen_depth(e->lo[2], -1);
    block->depth[1] = widen_depth(e->hi[2], 1);
    block->radius[0] = (float)(e->radius[0] * scale[1]);
    block->radius[1] = (float)(e->radius[1] * scale[0]);
}

/* The bounds of the block's span. Where they are not known: packed points can be anywhere in [-2, 18) with
 * any normal; bounds of surfels are computed. */
static iso_point_bounds bounds_of(const iso_point_view *points, const iso_point_block *block) {
    if (points->bounds) return points->bounds[block->span];
    iso_point_bounds bounds = {{-2, -2, -2}, {18, 18, 18}, {-1, -1, -1}, {1, 1, 1}};
    if (points->surfels) iso_point_bounds_find(points, block->first, block->count, &bounds);
    return bounds;
}

static block_measure measure_block(const iso_point_view *points, const iso_point_block *block) {
    block_measure measure = {.bounds = bounds_of(points, block)};
    if (measure.bounds.lo[0] <= measure.bounds.hi[0]) radius_range(points, block, measure.radius);
    return measure;
}

/* Computes the view-dependent fields of a block and adds it to the totals of its chunk. */
static void place_block(const placement *s, iso_point_block *block, const iso_point_bounds *bounds,
                        const double radius[2], chunk *found) {
    extent e = {.radius = {radius[0], radius[1]}};
    block->seen = block->back_facing = block->front_facing = false;
    if (!block_extent(s, block, bounds, &e)) return;
    for (int axis = 0; axis < 3; axis++) {
        found->lo[axis] = iso_min(found->lo[axis], e.lo[axis]);
        found->hi[axis] = iso_max(found->hi[axis], e.hi[axis]);
    }
    place_extent(s, &e, block);
    if (!block->seen) return;
    if (s->closed) {
        iso_facing facing = iso_projector_facing(s->projector, s->eye, block->brick, bounds);
        block->back_facing = facing == ISO_FACING_AWAY;
        block->front_facing = facing == ISO_FACING_EYE;
    }
    found->seen++;
    if (block->radius[0] < found->radius[0]) found->radius[0] = block->radius[0];
    if (block->radius[1] > found->radius[1]) found->radius[1] = block->radius[1];
}

/* Number of blocks of spans from .. to - 1. */
static size_t count_blocks(const iso_point_view *points, size_t from, size_t to) {
    size_t count = 0;
    for (size_t s = from; s < to; s++)
        count += ((size_t)points->spans[s].count + BLOCK_POINTS - 1) / BLOCK_POINTS;
    return count;
}

/* Cuts spans from .. to - 1 into blocks, from *block on. */
static void cut_spans(const iso_point_view *points, size_t from, size_t to, iso_point_block *block) {
    for (size_t s = from; s < to; s++) {
        const iso_point_span *span = &points->spans[s];
        for (uint32_t done = 0; done < span->count; block++) {
            uint32_t left = span->count - done;
            block->count = left < BLOCK_POINTS ? left : BLOCK_POINTS;
            block->first = span->first + done;
            block->span = s;
            block->scale = points->span_scales ? points->span_scales[s] : 1;
            memcpy(block->brick, span->brick, sizeof block->brick);
            done += block->count;
        }
    }
}

/* One beyond the last item of chunk `index`, of `count` items. */
static size_t chunk_end(size_t index, size_t count) {
    const size_t end = (index + 1) * CHUNK;
    return end < count ? end : count;
}

/* Task: the blocks of a chunk; cuts their spans first when that has not been done. */
static void place_chunk(void *context, size_t index, int worker) {
    (void)worker;
    const placement *s = context;
    const size_t first = s->chunks[index].first, end = s->chunks[index].end;
    chunk found = {.first = first,
                   .end = end,
                   .radius = {FLT_MAX, 0},
                   .lo = {DBL_MAX, DBL_MAX, DBL_MAX},
                   .hi = {-DBL_MAX, -DBL_MAX, -DBL_MAX}};
    if (s->points && first < end)
        cut_spans(s->points, index * CHUNK, chunk_end(index, s->points->span_count), s->blocks + first);
    for (size_t i = first; i < end; i++) {
        iso_point_block *block = &s->blocks[i];
        if (s->measures) {
            place_block(s, block, &s->measures[i].bounds, s->measures[i].radius, &found);
        } else if (s->points->bounds && !s->points->radii) {
            const double radius = s->radius * (double)block->scale, range[2] = {radius, radius};
            place_block(s, block, &s->points->bounds[block->span], range, &found);
        } else {
            const block_measure measure = measure_block(s->points, block);
            place_block(s, block, &measure.bounds, measure.radius, &found);
        }
        s->rows[i] = (block_rows){{block->row[0], block->row[1]}, block->back_facing};
        if (!block->seen) s->rows[i] = (block_rows){.row = {0, -1}};
    }
    s->chunks[index] = found;
}

static void sum_chunks(iso_point_blocks *blocks, const chunk *chunks, size_t count) {
    double *lo = blocks->lo, *hi = blocks->hi;
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = DBL_MAX;
        hi[axis] = -DBL_MAX;
    }
    blocks->seen = 0;
    blocks->radius[0] = FLT_MAX;
    blocks->radius[1] = 0;
    for (size_t i = 0; i < count; i++) {
        blocks->seen += chunks[i].seen;
        blocks->radius[0] = fminf(blocks->radius[0], chunks[i].radius[0]);
        blocks->radius[1] = fmaxf(blocks->radius[1], chunks[i].radius[1]);
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = iso_min(lo[axis], chunks[i].lo[axis]);
            hi[axis] = iso_max(hi[axis], chunks[i].hi[axis]);
        }
    }
    blocks->around_eye = true;
    for (int axis = 0; axis < 3; axis++) blocks->around_eye &= lo[axis] <= 0 && hi[axis] >= 0;
}

static iso_status reserve_blocks(iso_point_blocks *blocks, size_t count, iso_error *error) {
    ISO_TRY(iso_buffer_reserve(&blocks->blocks, count * sizeof(iso_point_block), 0, error));
    blocks->count = count;
    return ISO_OK;
}

static iso_status reserve_chunks(iso_point_blocks *blocks, placement *s, size_t items, size_t *count,
                                 iso_error *error) {
    *count = (items + CHUNK - 1) / CHUNK;
    ISO_TRY(iso_buffer_reserve(&blocks->chunks, *count * sizeof(chunk), 0, error));
    s->chunks = blocks->chunks.data;
    return ISO_OK;
}

static iso_status place_blocks(iso_point_blocks *blocks, placement *s, size_t chunks, iso_pool *pool,
                               iso_error *error) {
    ISO_TRY(iso_buffer_reserve(&blocks->rows, blocks->count * sizeof(block_rows), 0, error));
    s->blocks = blocks->blocks.data;
    s->rows = blocks->rows.data;
    for (int axis = 0; axis < 2; axis++) s->sides[axis] = sides_of_view(s->projector->view, axis);
    iso_parallel_for(pool, chunks, place_chunk, s);
    sum_chunks(blocks, s->chunks, chunks);
    return ISO_OK;
}

iso_status iso_point_blocks_make(iso_point_blocks *blocks, const iso_point_view *points,
                                 const iso_projector *projector, iso_pool *pool, iso_error *error) {
    const double radius = ISO_DISC_RADII * iso_max(points->radius, 0);
    placement s = {.points = points, .radius = radius, .closed = points->closed, .projector = projector};
    size_t chunks, count = 0;
    ISO_TRY(reserve_chunks(blocks, &s, points->span_count, &chunks, error));
    for (size_t i = 0; i < chunks; i++) {
        s.chunks[i].first = count;
        count += count_blocks(points, i * CHUNK, chunk_end(i, points->span_count));
        s.chunks[i].end = count;
    }
    ISO_TRY(reserve_blocks(blocks, count, error));
    iso_projector_eye(projector, &points->transform, s.eye);
    return place_blocks(blocks, &s, chunks, pool, error);
}

static void swap_buffers(iso_buffer *a, iso_buffer *b) {
    const iso_buffer kept = *a;
    *a = *b;
    *b = kept;
}

iso_status iso_point_blocks_measure(iso_point_blocks *blocks, const iso_point_view *points,
                                    iso_same_span *same, const void *context, iso_error *error) {
    size_t last = points->radius == blocks->shared_radius && same ? blocks->count : 0, old = 0;
    swap_buffers(&blocks->blocks, &blocks->last_blocks);
    swap_buffers(&blocks->extents, &blocks->last_extents);
    blocks->count = blocks->measured = 0;
    ISO_TRY(reserve_blocks(blocks, count_blocks(points, 0, points->span_count), error));
    cut_spans(points, 0, points->span_count, blocks->blocks.data);
    ISO_TRY(iso_buffer_reserve(&blocks->extents, blocks->count * sizeof(block_measure), 0, error));
    const iso_point_block *block = blocks->blocks.data, *was = blocks->last_blocks.data;
    block_measure *measure = blocks->extents.data;
    const block_measure *measured = blocks->last_extents.data;
    for (size_t i = 0; i < blocks->count; i++) { /* old and new blocks are sorted by span */
        while (old < last && was[old].span < block[i].span) old++;
        if (old < last && was[old].span == block[i].span && same(context, block[i].span)) {
            measure[i] = measured[old++];
        } else {
            measure[i] = measure_block(points, &block[i]);
            blocks->measured++;
        }
    }
    blocks->shared_radius = points->radius;
    return ISO_OK;
}

iso_status iso_point_blocks_set_view(iso_point_blocks *blocks, bool closed, const iso_transform *transform,
                                     const iso_projector *projector, iso_error *error) {
    placement s = {.measures = blocks->extents.data, .closed = closed, .projector = projector};
    size_t chunks;
    ISO_TRY(reserve_chunks(blocks, &s, blocks->count, &chunks, error));
    for (size_t i = 0; i < chunks; i++) {
        s.chunks[i].first = i * CHUNK;
        s.chunks[i].end = chunk_end(i, blocks->count);
    }
    iso_projector_eye(projector, transform, s.eye);
    return place_blocks(blocks, &s, chunks, NULL, error);
}

/* The division of rows, which are counted from the optical axis, into bands. */
typedef struct bands {
    int64_t first_row; /* first row of the first band */
    int count, shift;  /* number of bands; 2^shift rows in each */
    bool cull;
} bands;

/* The bands that contain centres of the block's points; none when first > last. */
static iso_rows bands_of_block(const bands *b, const block_rows *block) {
    const int64_t first = block->row[0] - b->first_row, last = block->row[1] - b->first_row;
    if (first > last || (b->cull && block->back_facing) || last < 0 || first >> b->shift >= b->count)
        return (iso_rows){0, -1};
    const int64_t most = last >> b->shift;
    return (iso_rows){first < 0 ? 0 : (int)(first >> b->shift), most < b->count ? (int)most : b->count - 1};
}

iso_status iso_point_blocks_assign_bands(iso_point_blocks *blocks, const iso_view *view,
                                         const iso_level_bands *level, bool cull, iso_error *error) {
    const int count = (level->rows + level->band_rows - 1) / level->band_rows;
    /* Rounding does no harm: a block's rows include one more on each side. */
    const bands all = {.first_row = (int64_t)ceil(level->row - view->cy),
                       .count = count,
                       .shift = level->level + __builtin_ctz((unsigned)level->band_rows),
                       .cull = cull};
    const block_rows *block = blocks->rows.data;
    ISO_TRY(iso_buffer_reserve(&blocks->start, ((size_t)count + 2) * sizeof(size_t), 0, error));
    size_t *start = blocks->start.data;
    memset(start, 0, ((size_t)count + 2) * sizeof(size_t));
    for (size_t i = 0; i < blocks->count; i++) {
        iso_rows in = bands_of_block(&all, &block[i]);
        for (int b = in.first; b <= in.last; b++) start[b + 2]++;
    }
    for (int b = 0; b < count; b++) start[b + 2] += start[b + 1];
    ISO_TRY(iso_buffer_reserve(&blocks->order, (start[count + 1] + 1) * sizeof(uint32_t), 0, error));
    uint32_t *order = blocks->order.data;
    for (size_t i = 0; i < blocks->count; i++) {
        iso_rows in = bands_of_block(&all, &block[i]);
        for (int b = in.first; b <= in.last; b++) order[start[b + 1]++] = (uint32_t)i;
    }
    return ISO_OK;
}

void iso_point_blocks_free(iso_point_blocks *blocks) {
    iso_buffer_free(&blocks->blocks);
    iso_buffer_free(&blocks->rows);
    iso_buffer_free(&blocks->chunks);
    iso_buffer_free(&blocks->extents);
    iso_buffer_free(&blocks->last_blocks);
    iso_buffer_free(&blocks->last_extents);
    iso_buffer_free(&blocks->order);
    iso_buffer_free(&blocks->start);
    *blocks = (iso_point_blocks){0};
}
