/* project_kernel: projection of points to keys. Each point goes into the pixel that contains its centre, and
 * the smallest key of a pixel is kept, a depth test (Marroquim, Kraus and Cavalcanti 2008, section 3). */
#include "base/point_code_simd.h"
#include "base/simd.h"
#include "render/pullpush/kernel.h"

/* Keys store a point's position within its pixel in 1/32 (pyramid.h). */
enum { PP_PART_BITS = 5, PP_PARTS = 1 << PP_PART_BITS };

/* Keys that wait to be merged into the pyramid: for each its place in the pyramid's keys, the key, and (only
 * with an index) the point's number. The queue is written by vectors and read one key at a time. A long queue
 * separates the two, because reading a vector just stored in smaller pieces stalls. */
enum { PP_KEYS = 512 };
typedef struct pp_queue {
    int count;
    int32_t at[PP_KEYS], number[PP_KEYS];
    int64_t key[PP_KEYS];
} pp_queue;

/* What is the same for all blocks of one call. The matrix takes positions in steps to columns and rows in
 * parts of a pixel (PP_PARTS) at depth 1. */
typedef struct pp_band {
    const iso_point_projection *projection;
    vf matrix[9], column, row; /* column and row of the optical axis, in parts */
    iso_rows wanted;           /* rows of keys to project into */
    int first_place, places;   /* first key and number of keys of these rows */
    int row_offset, rows; /* rows of the whole picture above the first wanted row; number of wanted rows */
    bool indexed;         /* the pyramid has an index */
} pp_band;

/* What is the same for all points of a block. Positions of points are counted in steps from the block's first
 * one (points.h): here are the projection of that place, and the eye's position relative to it, in steps (in
 * parallel projection: the direction of view). */
typedef struct pp_block {
    vf origin[3], eye[3];
    bool cull; /* test whether points face the eye */
} pp_block;

/* Merges key i of the queue into the pyramid. The result does not depend on the order of merging: the smaller
 * key is kept, of equal keys that of the point with the smaller number. Without an index, points with equal
 * keys are drawn alike. */
ISO_INLINE void merge_key(const iso_pyramid *pyramid, const pp_queue *queue, int i, const bool indexed) {
    int64_t key = queue->key[i], *there = pyramid->keys + queue->at[i], old = *there;
    if (indexed) {
        int32_t number = queue->number[i], *held = pyramid->index + queue->at[i];
        bool wins = key < old || (key == old && number < *held);
        *held = wins ? number : *held;
    }
    *there = key < old ? key : old;
}

/* Merges and empties the queue. Keys are taken in turn from four quarters of the queue: consecutive ones
 * often belong to the same pixel and would have to wait for each other. Not inlined: the caller would run
 * out of registers. */
static __attribute__((noinline)) void merge_queue(const iso_pyramid *pyramid, pp_queue *queue,
                                                  const bool indexed) {
    const int quarter = queue->count / 4;
    for (int i = 0; i < quarter; i++)
#pragma GCC unroll 4
        for (int k = 0; k < 4; k++) merge_key(pyramid, queue, i + k * quarter, indexed);
    for (int i = 4 * quarter; i < queue->count; i++) merge_key(pyramid, queue, i, indexed);
    queue->count = 0;
}

/* Appends the keys of live lanes to the queue, which must have room for ISO_LANES. */
ISO_INLINE void queue_keys(vm live, vi at, vi depth, vi payload, vi number, pp_queue *out,
                           const bool indexed) {
    int32_t depths[ISO_LANES], payloads[ISO_LANES];
    const int count = out->count;
    if (v_mask(live) == (uint32_t)((1ull << ISO_LANES) - 1) && !indexed) { /* no lane is left out */
        v_storei(out->at + count, at);
        v_store((float *)(out->key + count), v_zip_low(v_floats(payload), v_floats(depth)));
        v_store((float *)(out->key + count) + ISO_LANES, v_zip_high(v_floats(payload), v_floats(depth)));
        out->count = count + ISO_LANES;
        return;
    }
    v_compressi(out->at + count, live, at);
    v_compressi(depths, live, depth);
    v_compressi(payloads, live, payload);
    if (indexed) v_compressi(out->number + count, live, number);
    vf low = v_floats(v_loadi(payloads)), high = v_floats(v_loadi(depths));
    v_store((float *)(out->key + count), v_zip_low(low, high));
    v_store((float *)(out->key + count) + ISO_LANES, v_zip_high(low, high));
    out->count = count + __builtin_popcount(v_mask(live));
}

/* A column or row in parts of a pixel, rounded down: `view` is the coordinate at depth 1, `shrink` 1 / depth,
 * `axis` the optical axis. Clamped to a range that integers can hold, unless `whole`. */
ISO_INLINE vi to_pixel_parts(vf view, vf shrink, vf axis, const bool whole) {
    const vf limit = v_set(PP_PARTS << 24), at = view * shrink + axis;
    return v_floor(whole ? at : v_max(v_min(at, limit), -limit));
}

/* Row `row` of the transform of positions. */
ISO_INLINE vf transform_row(const pp_band *band, const pp_block *b, int row, const vf at[3]) {
    const vf *m = band->matrix + 3 * row;
    return m[0] * at[0] + m[1] * at[1] + m[2] * at[2] + b->origin[row];
}

/* Whether 0 <= value < end, in one unsigned comparison. */
ISO_INLINE vm is_below(vi value, int end) {
    return v_lti(value ^ INT32_MIN, v_seti(end ^ INT32_MIN));
}

/* Whether points face the eye. Normals need not be unit. */
ISO_INLINE vm faces_eye(const iso_point_projection *p, const pp_block *b, const vf at[3],
                        const vf normal[3]) {
    const vf *eye = b->eye;
    vf x = p->orthographic ? eye[0] : at[0] - eye[0], y = p->orthographic ? eye[1] : at[1] - eye[1],
       z = p->orthographic ? eye[2] : at[2] - eye[2];
    return v_lt(normal[0] * x + normal[1] * y + normal[2] * z, v_set(0));
}

/* Projects a vector of points and queues their keys. `at`: positions in steps; `normal_bits`: their packed
 * normals; `first`: the first point's number. `whole`: all live points are known to lie in the wanted rows,
 * in the pyramid's columns and beyond the near plane (block_fits). Otherwise most vectors outside are
 * abandoned after the test of their rows. */
ISO_INLINE void project_positions(const pp_band *band, const pp_block *b, const vf at[3], vi normal_bits,
                                  vm live, size_t first, pp_queue *queue, const bool whole) {
    const iso_point_projection *p = band->projection;
    const iso_pyramid *pyramid = p->pyramid;
    vf z = transform_row(band, b, 2, at), shrink = p->orthographic ? v_set(1) : 1 / z;
    vi y = to_pixel_parts(transform_row(band, b, 1, at), shrink, band->row, whole), row = y >> PP_PART_BITS;
    if (!whole) {
        live = v_and(v_and(live, v_le(v_set(p->near), z)), is_below(row - band->row_offset, band->rows));
        if (!v_mask(live)) return;
    }
    vi x = to_pixel_parts(transform_row(band, b, 0, at), shrink, band->column, whole),
       column = x >> PP_PART_BITS;
    if (!whole) live = v_and(live, is_below(column, pyramid->level[pyramid->layout.base].width));
    vi depth = v_bits(z);
    depth ^= depth >> 31 & INT32_MAX;
    vi line = row - band->row_offset;
    if (!whole) line = v_selecti(live, line, v_seti(0)); /* keeps the product below from overflowing */
    vi place = line * (int32_t)pyramid->key_stride + column;
    if (whole) place = v_selecti(is_below(place, band->places), place, v_seti(0));
    place += band->first_place;
    vi payload = normal_bits | (x & (PP_PARTS - 1)) << 22 | y << 27;
    if (queue->count > PP_KEYS - ISO_LANES) merge_queue(pyramid, queue, band->indexed);
    queue_keys(live, place, depth, payload, v_lanes() + ((int32_t)first + p->first), queue, band->indexed);
}

ISO_INLINE pp_band make_band(const iso_point_projection *p, iso_rows rows, const bool indexed) {
    pp_band band = {.projection = p,
                    .column = v_set(PP_PARTS * p->column),
                    .row = v_set(PP_PARTS * p->row),
                    .wanted = rows,
                    .first_place = (int32_t)p->pyramid->key_stride * rows.first,
                    .places = (int32_t)p->pyramid->key_stride * (rows.last - rows.first + 1),
                    .row_offset = p->rows_before + rows.first,
                    .rows = rows.last - rows.first + 1,
                    .indexed = indexed};
    for (int k = 0; k < 9; k++) band.matrix[k] = v_set(k < 6 ? PP_PARTS * p->step[k] : p->step[k]);
    return band;
}

/* Whether all of a block's points lie in the wanted rows, in the pyramid's columns and beyond the near plane,
 * so that they need not be tested. The block's rows and columns include a pixel more on each side, which
 * covers rounding to floats. Were its bounds wrong, points would be drawn at wrong pixels of the same rows,
 * but nothing outside them would be written. */
ISO_INLINE bool block_fits(const iso_point_projection *p, const iso_point_block *block, iso_rows rows) {
    const iso_pyramid_layout *layout = &p->pyramid->layout;
    const float pixel = 1.0f / (float)(1 << layout->base), row = p->row - (float)p->rows_before;
    return !block->clipped && block->depth[0] >= p->near &&
           (float)block->row[0] * pixel + row >= (float)rows.first &&
           (float)(block->row[1] + 1) * pixel + row <= (float)rows.last &&
           (float)block->column[0] * pixel + p->column >= 0 &&
           (float)(block->column[1] + 1) * pixel + p->column <=
               (float)(p->pyramid->level[layout->base].width - 1);
}

ISO_INLINE pp_block make_block(const iso_point_projection *p, const iso_point_block *block) {
    pp_block b = {.cull = p->cull && !block->front_facing};
    double corner[3];
    for (int k = 0; k < 3; k++) corner[k] = block->brick[k] * (double)ISO_BRICK + p->low;
    for (int k = 0; k < 3; k++) {
        const double *m = p->matrix + 3 * k;
        const float origin = (float)(m[0] * corner[0] + m[1] * corner[1] + m[2] * corner[2] + p->origin[k]);
        b.origin[k] = v_set(k < 2 ? PP_PARTS * origin : origin);
        b.eye[k] = v_set((float)(p->orthographic ? p->eye[k] : (p->eye[k] - corner[k]) * p->per_voxel));
    }
    return b;
}

/* Projects a vector of packed points, of which those in live lanes belong to the block. */
ISO_INLINE void project_vector(const pp_band *band, const pp_block *b, const iso_point *points, vm live,
                               size_t first, pp_queue *queue, const bool whole) {
    vi low, high;
    vf at[3];
    load_points(points, &low, &high);
    vi bits = unpack_points(low, high, at);
    if (b->cull) {
        vf normal[3];
        unfold_normals(bits, normal);
        live = v_and(live, faces_eye(band->projection, b, at, normal));
        if (!v_mask(live)) return;
    }
    project_positions(band, b, at, bits, live, first, queue, whole);
}

/* Projects all points of a block of at least ISO_LANES points. The last vector begins early enough to be
 * full, so that points may be projected twice, which changes nothing. `next`: points to prefetch. */
ISO_INLINE void project_long_block(const pp_band *band, const iso_point_block *block, const iso_point *next,
                                   pp_queue *queue, const bool whole) {
    const pp_block b = make_block(band->projection, block);
    const iso_point *points = band->projection->points->packed + block->first;
    const uint32_t count = block->count;
    const vm all = v_eqi(v_lanes(), v_lanes());
    for (uint32_t done = 0; done < count; done += ISO_LANES) {
        const uint32_t i = done + ISO_LANES <= count ? done : count - ISO_LANES;
        for (int k = 0; k < ISO_LANES; k += 8) __builtin_prefetch(next + i + k);
        project_vector(band, &b, points + i, all, block->first + i, queue, whole);
    }
}

/* Projects a block of fewer than ISO_LANES points. */
ISO_INLINE void project_short_block(const pp_band *band, const iso_point_block *block, pp_queue *queue) {
    const pp_block b = make_block(band->projection, block);
    const vm live = v_lti(v_lanes(), v_seti((int32_t)block->count));
    iso_point few[ISO_LANES] = {0};
    for (uint32_t i = 0; i < block->count; i++) few[i] = band->projection->points->packed[block->first + i];
    project_vector(band, &b, few, live, block->first, queue, false);
}

ISO_INLINE void project_packed_block(const pp_band *band, const iso_point_block *block, const iso_point *next,
                                     pp_queue *queue) {
    if (block->count < ISO_LANES)
        project_short_block(band, block, queue);
    else if (block_fits(band->projection, block, band->wanted))
        project_long_block(band, block, next, queue, true);
    else
        project_long_block(band, block, next, queue, false);
}

ISO_INLINE void project_surfel_block(const pp_band *band, const iso_point_block *block, pp_queue *queue) {
    const pp_block b = make_block(band->projection, block);
    const iso_surfel *surfels = band->projection->points->surfels;
    for (uint32_t i = 0; i < block->count; i += ISO_LANES) {
        vf at[3], normal[3];
        vm live = load_surfels(surfels + block->first + i, block->count - i, at, normal);
        if (b.cull) live = v_and(live, faces_eye(band->projection, &b, at, normal));
        project_positions(band, &b, at, fold_normals(normal), live, block->first + i, queue, false);
    }
}

/* Block number i + later of the list; number i when the list ends before. */
ISO_INLINE const iso_point_block *block_after(const iso_block_list *list, size_t i, size_t later) {
    return &list->blocks[list->order[i + later < list->count ? i + later : i]];
}

/* Projects all blocks of the list; `packed` and `indexed` are constants for the compiler. */
ISO_INLINE void project_blocks(const iso_point_projection *p, const iso_block_list *list, iso_rows rows,
                               const bool packed, const bool indexed) {
    const pp_band band = make_band(p, rows, indexed);
    pp_queue queue;
    queue.count = 0;
    for (size_t i = 0; i < list->count; i++) {
        const iso_point_block *block = &list->blocks[list->order[i]];
        const iso_point_block *next = block_after(list, i, 1);
        __builtin_prefetch(block_after(list, i, 8));
        if (packed)
            project_packed_block(&band, block, p->points->packed + next->first, &queue);
        else
            project_surfel_block(&band, block, &queue);
    }
    merge_queue(p->pyramid, &queue, indexed);
}

void ISO_KERNEL_NAME(iso_pullpush_project)(const iso_point_projection *p, const iso_block_list *list,
                                           iso_rows rows) {
    bool indexed = p->pyramid->index != NULL;
    if (p->points->packed && indexed) project_blocks(p, list, rows, true, true);
    if (p->points->packed && !indexed) project_blocks(p, list, rows, true, false);
    if (!p->points->packed && indexed) project_blocks(p, list, rows, false, true);
    if (!p->points->packed && !indexed) project_blocks(p, list, rows, false, false);
}
