/* outlined_cells_simd: draws cells that have an outline (cell_outlines_simd.h). The free pixels of a cell
 * form a patch, a list of runs of pixels in rows, which is intersected, shaded and written as a whole. */
#ifndef ISO_EXACT_OUTLINED_CELLS_SIMD_H
#define ISO_EXACT_OUTLINED_CELLS_SIMD_H

#include "base/simd_four.h"
#include "exact/kernel_simd.h"
#include "exact/outlined_roots_simd.h"

/* Computes the gradient in a cell as a trilinear function: gradient[k] is the coefficient k of 1, u, v, w,
 * uv, vw, uw and uvw, in view space, pointing out of the solid, scaled so that the largest component at a
 * corner is about 1. voxel: the cell's first corner. */
ISO_STEP static void set_gradient(const iso_exact_projection *projection, const int voxel[3],
                                  float gradient[8][4]) {
    float corner[8][4];
    projection->gradients(&projection->exact->grid, voxel, corner);
    const float *m = projection->normal;
    const v4 column[3] = {{m[0], m[3], m[6]}, {m[1], m[4], m[7]}, {m[2], m[5], m[8]}};
    v4 c[8], most = v4_set(0);
    for (int i = 0; i < 8; i++) {
        c[i] = column[0] * corner[i][0] + column[1] * corner[i][1] + column[2] * corner[i][2];
        most = v4_max(v4_abs(c[i]), most);
    }
    float largest[4];
    v4_store(largest, most);
    for (int i = 1; i < 3; i++) largest[0] = largest[i] > largest[0] ? largest[i] : largest[0];
    const float scale = unit_scale(v_set(largest[0]))[0];
    for (int i = 0; i < 8; i++) c[i] *= scale;
    for (int axis = 1; axis < 8; axis *= 2) /* sums and differences along each axis */
        for (int i = 0; i < 8; i++) {
            if (i & axis) continue;
            const v4 low = c[i], high = c[i | axis];
            c[i] = low + high;
            c[i | axis] = high - low;
        }
    static const int order[8] = {0, 1, 2, 4, 3, 6, 5, 7};
    for (int i = 0; i < 8; i++) v4_store(gradient[i], c[order[i]]);
}

/* Writes a vector of the patch's pixels, from number `first` on, to the samples from index `at` on: those
 * whose bits are set and that are nearer than the samples. */
ISO_INLINE void write_vector(const iso_exact_projection *projection, const iso_exact_patch *list, int first,
                             ptrdiff_t at, uint32_t bits) {
    const iso_gbuffer *gbuffer = projection->target->gbuffer;
    const vf new = v_load(list->depth + ISO_LANES_MAX + first), old = v_load(gbuffer->depth + at);
    const vm mask = v_and(v_from_mask(bits), v_lt(new, old));
    v_store(gbuffer->depth + at, v_select(mask, new, old));
    for (int k = 0; k < 3; k++) {
        float *normal = gbuffer->normal[k] + at;
        v_store(normal, v_select(mask, v_load(list->normal[k] + ISO_LANES_MAX + first), v_load(normal)));
    }
    uint8_t *surface = gbuffer->surface + at;
    v_store_u8(surface, v_selecti(mask, v_seti(projection->target->surface), v_load_u8(surface)));
}

/* Does what write_vector does, pixel by pixel, where a vector would reach beyond the end of a row. */
ISO_STEP static void write_last(const iso_exact_projection *projection, const iso_exact_patch *list,
                                int first, ptrdiff_t at, uint32_t bits) {
    const iso_gbuffer *gbuffer = projection->target->gbuffer;
    for (; bits; bits &= bits - 1) {
        const int n = __builtin_ctz(bits);
        if (!(list->depth[ISO_LANES_MAX + first + n] < gbuffer->depth[at + n])) continue;
        gbuffer->depth[at + n] = list->depth[ISO_LANES_MAX + first + n];
        for (int k = 0; k < 3; k++) gbuffer->normal[k][at + n] = list->normal[k][ISO_LANES_MAX + first + n];
        gbuffer->surface[at + n] = projection->target->surface;
    }
}

/* Writes the pixels of a run whose bits in `pixels` are set; `first` is the number of the run's first pixel
 * in the patch. Goes by columns that are multiples of ISO_LANES, so that vectors are aligned if rows are. */
ISO_INLINE void write_run(const iso_exact_projection *projection, const iso_exact_patch *patch,
                          iso_exact_pixel_run run, int first, uint64_t pixels) {
    const int width = projection->target->gbuffer->width, x = run.pixel & 0xffff, y = run.pixel >> 16;
    const ptrdiff_t at = (ptrdiff_t)y * width + x;
    for (int n = -(x % ISO_LANES); n < run.count; n += ISO_LANES) {
        const uint64_t some = n < 0 ? pixels << -n : pixels >> n;
        const uint32_t bits = (uint32_t)some & ((1u << ISO_LANES) - 1);
        if (!bits) continue;
        if (x + n + ISO_LANES <= width)
            write_vector(projection, patch, first + n, at + n, bits);
        else
            write_last(projection, patch, first + n, at + n, bits);
    }
}

/* Writes the colours of a run's pixels into the picture; parameters as in write_run. */
ISO_INLINE void paint_run(const iso_exact_projection *projection, const iso_exact_patch *patch,
                          iso_exact_pixel_run run, int first, uint64_t pixels) {
    const int width = projection->target->gbuffer->width, x = run.pixel & 0xffff, y = run.pixel >> 16;
    const int32_t *word = patch->word + ISO_LANES_MAX + first;
    int32_t *to = projection->paint->pixels + ((ptrdiff_t)y * width + x - projection->paint->skipped);
    int n = 0;
    for (; n < run.count && x + n + ISO_LANES <= width; n += ISO_LANES) {
        const vm mask = v_from_mask((uint32_t)(pixels >> n) & ((1u << ISO_LANES) - 1));
        v_storei(to + n, v_selecti(mask, v_loadi(word + n), v_loadi(to + n)));
    }
    for (; n < run.count; n++)
        if (pixels >> n & 1) to[n] = word[n];
}

/* Writes the keys of a run's pixels into the key image; parameters as in write_run. */
ISO_INLINE void key_run(const iso_exact_projection *projection, const iso_exact_scratch *scratch,
                        iso_exact_pixel_run run, int first, uint64_t pixels) {
    const int width = projection->target->gbuffer->width, x = run.pixel & 0xffff, y = run.pixel >> 16;
    const int32_t *word = scratch->patch.word + ISO_LANES_MAX + first;
    const float *depth = scratch->patch.depth + ISO_LANES_MAX + first;
    const ptrdiff_t at = (ptrdiff_t)y * width + x;
    for (; pixels; pixels &= pixels - 1) {
        const int n = __builtin_ctzll(pixels);
        keep_key(projection->paint, at + n, scratch->place, word[n], depth[n]);
    }
}

/* Adds fragments to the lists one by one. bits: of the pixels from number `first` of the patch on; pixel: the
 * first one, y << 16 | x. */
ISO_STEP static void add_singly(iso_exact_scratch *scratch, int32_t pixel, int first, uint32_t bits) {
    const iso_exact_patch *patch = &scratch->patch;
    for (; bits; bits &= bits - 1) {
        const int n = __builtin_ctz(bits), at = ISO_LANES_MAX + first + n;
        const float packed[3] = {patch->normal[0][at], patch->normal[1][at], patch->normal[2][at]};
        add_fragment(scratch, pixel + n, patch->depth[at], packed, false);
    }
}

/* Does what add_singly does for a vector of pixels of one group, if their lists are equally long and have no
 * fragments of other surfaces; else returns false. The arithmetic is that of iso_layer_add_packed. */
ISO_INLINE bool add_vector(iso_exact_scratch *scratch, int32_t pixel, int first, uint32_t bits) {
    const iso_exact_patch *patch = &scratch->patch;
    iso_layer_lists *lists = scratch->lists;
    const int x = pixel & 0xffff, row = (pixel >> 16) - scratch->rows.first, at = ISO_LANES_MAX + first;
    iso_layer_group *group = iso_layer_group_at(lists, x, row);
    iso_layer_list *list = &group->list[x % ISO_LAYER_GROUP];
    const vf zero = v_set(0), cut = v_set(ISO_LAYER_CUT);
    const vf packed[4] = {v_load(patch->depth + at), v_load(patch->normal[0] + at),
                          v_load(patch->normal[1] + at), v_load(patch->normal[2] + at)};
    vf state[4]; /* through, last, own, count */
    int32_t index[ISO_LANES];
    v_storei(index, v_lanes() * 4);
    v_load4(&list->through, index, 1, state);
    const vi leaves = v_bits(packed[3]) >> 2 & 1, own = v_bits(state[2]), count = v_bits(state[3]);
    const vm twice =
        v_and(v_eqi(v_bits(state[1]) & 1, leaves), v_lt(packed[0] - state[1], v_set(lists->pass.tolerance)));
    const vm open = v_andnot(v_from_mask(bits), v_lt(state[0], cut));
    vm add = v_andnot(open, twice), beyond = v_lt(zero, zero);
    if (lists->limit) {
        const float *limit = lists->limit + (ptrdiff_t)row * lists->width + x;
        float limits[ISO_LANES];
        const int readable = lists->width - x < ISO_LANES ? lists->width - x : ISO_LANES;
        memset(limits, 0, sizeof limits);
        memcpy(limits, limit, (size_t)readable * sizeof *limit);
        const vf depth = packed[0] + lists->middle, ends = v_load(limits);
        const vm before = v_lt(depth, ends);
        beyond = v_andnot(add, before);
        add = v_and(add, v_and(before, v_or(v_eqi(leaves, v_seti(0)), v_lt(depth, ends - lists->pass.gap))));
    }
    const uint32_t added = v_mask(add);
    if (added) {
        const int k = list[__builtin_ctz(added)].count;
        const vm alike = v_and(v_eqi(count, v_seti(k)), v_eqi(own, v_seti(k)));
        if (v_mask(v_andnot(add, alike))) return false;
        iso_packed_fragment *layer = iso_layer_reserve(lists, group, k);
        if (!layer) return false;
        float *to = &layer[x % ISO_LAYER_GROUP].depth;
        vf old[4], new[4];
        v_load4(to, index, 1, old);
        for (int i = 0; i < 4; i++) new[i] = v_select(add, packed[i], old[i]);
        v_store4(to, 4, new);
    }
    const vi bits_of_last = (v_bits(packed[0]) & ~1) | leaves;
    const vf opacity =
        v_to_float(v_bits(packed[3]) >> 9 & (ISO_LAYER_OPACITY - 1)) * (1.0f / ISO_LAYER_OPACITY);
    const vi one = v_selecti(add, v_seti(1), v_seti(0));
    const vm full = v_and(add, v_eqi(own + 1, v_seti(lists->pass.most_layers)));
    state[0] = v_select(v_or(beyond, full), zero, v_select(add, state[0] * (1 - opacity), state[0]));
    state[1] = v_floats(v_selecti(add, bits_of_last, v_bits(state[1])));
    state[2] = v_floats(own + one);
    state[3] = v_floats(count + one);
    v_store4(&list->through, 4, state);
    const uint64_t done = v_mask(v_and(v_from_mask(bits), v_lt(state[0], cut)));
    uint64_t *free = scratch->open + (ptrdiff_t)row * scratch->words + (x >> 6);
    free[0] &= ~(done << (x & 63));
    return true;
}

/* Adds the fragments of a run's pixels to the lists; parameters as in write_run. Goes by columns that are
 * multiples of ISO_LANES, so that a vector's pixels are in one group. */
ISO_INLINE void add_run(iso_exact_scratch *scratch, iso_exact_pixel_run run, int first, uint64_t pixels) {
    const int x = run.pixel & 0xffff;
    for (int n = -(x % ISO_LANES); n < run.count; n += ISO_LANES) {
        const uint64_t some = n < 0 ? pixels << -n : pixels >> n;
        const uint32_t bits = (uint32_t)some & ((1u << ISO_LANES) - 1);
        if (bits && !add_vector(scratch, run.pixel + n, first + n, bits))
            add_singly(scratch, run.pixel + n, first + n, bits);
    }
}

/* Writes the patch's pixels that hit, and marks them as no longer free. */
ISO_STEP static void write_patch(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    const iso_exact_patch *patch = &scratch->patch;
    const bool paint = projection->paint;
    int first = 0;
    for (int i = 0; i < patch->runs; first += patch->run[i++].count) {
        const iso_exact_pixel_run run = patch->run[i];
        const int x = run.pixel & 0xffff, y = run.pixel >> 16, from = first & 63;
        const uint64_t *hit = patch->hit + (first >> 6);
        const uint64_t pixels =
            (hit[0] >> from | hit[1] << 1 << (63 - from)) & (~(uint64_t)0 >> (64 - run.count));
        if (!pixels) continue;
        if (ISO_EXACT_LAYERED) {
            add_run(scratch, run, first, pixels);
            continue;
        }
        uint64_t *open = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words + (x >> 6);
        open[0] &= ~(pixels << (x & 63));
        open[1] &= ~(pixels >> 1 >> (63 - (x & 63)));
        if (paint && projection->paint->keys)
            key_run(projection, scratch, run, first, pixels);
        else if (paint)
            paint_run(projection, patch, run, first, pixels);
        else
            write_run(projection, patch, run, first, pixels);
    }
}

/* Tests the pixels that find_flat_roots could not decide (patch->unsure), with test_large_cell. */
ISO_STEP static void test_unsure(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    const iso_exact_patch *patch = &scratch->patch;
    int first = 0;
    scratch->owner[0] = patch->cell * RECORD_FLOATS;
    for (int i = 0; i < patch->runs; first += patch->run[i++].count)
        for (int n = 0; n < patch->run[i].count; n++) {
            if (!(patch->unsure[(first + n) >> 6] >> ((first + n) & 63) & 1)) continue;
            const int32_t pixel = patch->run[i].pixel + n;
            scratch->window[scratch->windows++] = (iso_exact_row_window){1, pixel};
            scratch->pixel[scratch->pairs++] = pixel;
            if (scratch->pairs == ISO_EXACT_LARGE_LIST) test_large_cell(projection, scratch);
        }
    if (scratch->pairs) test_large_cell(projection, scratch);
}

/* Intersects, shades and writes the pixels of the patch, and empties the patch. */
ISO_STEP static void draw_patch(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_patch *patch = &scratch->patch;
    int voxel[3];
    get_cell_voxel(projection, scratch, patch->cell, voxel);
    set_gradient(projection, voxel,
                 patch->gradient); /* first, as it does not wait for the patch's arrays to be stored */
    memset(patch->hit, 0, sizeof patch->hit);
    memset(patch->unsure, 0, sizeof patch->unsure);
    if (scratch->rays[patch->cell].flat)
        find_flat_roots(projection, scratch);
    else
        find_curved_roots(projection, scratch);
    uint64_t hit = 0, unsure = 0;
    for (int word = 0; word <= patch->count >> 6; word++) {
        hit |= patch->hit[word];
        unsure |= patch->unsure[word];
    }
    if (unsure) test_unsure(projection, scratch);
    if (ISO_EXACT_LAYERED && unsure) flush_octant(projection, scratch);
    if (hit) {
        shade_patch(projection, scratch);
        if (ISO_EXACT_LAYERED)
            pack_patch(projection, scratch);
        else if (projection->paint)
            paint_patch(projection->paint, patch);
        write_patch(projection, scratch);
    }
    patch->count = patch->runs = 0;
}

/* Up to 64 columns of a cell's box. */
typedef struct ex_columns {
    int x;              /* the first column */
    int word, shift;    /* word and bit of the first column in a row of free-pixel bits */
    uint64_t mask;      /* bits of the columns that are in the box */
    int from;           /* the first column, counted from iso_exact_octant_projection.origin[0] */
    float place;        /* iso_exact_cell.place[0] of the cell */
    int width;          /* of the picture */
    const float *u, *v; /* rays (u, v, 1): u from the first column on, v from row 0 on; NULL: not needed */
} ex_columns;

ISO_INLINE ex_columns columns_from(const iso_exact_projection *projection, const iso_exact_scratch *scratch,
                                   int x, int last) {
    const int count = last - x < 63 ? last - x + 1 : 64;
    return (ex_columns){.x = x,
                        .word = x >> 6,
                        .shift = x & 63,
                        .mask = ~(uint64_t)0 >> (64 - count),
                        .from = x - scratch->octant_projection.origin[0],
                        .place = scratch->record[scratch->patch.cell].place[0],
                        .width = projection->target->gbuffer->width,
                        .u = projection->paint ? projection->paint->u + x : NULL,
                        .v = projection->paint ? projection->paint->v : NULL};
}

/* The free pixels of a row in these columns, as bits. */
ISO_INLINE uint64_t open_columns(const uint64_t *row, const ex_columns *columns) {
    const uint64_t *word = row + columns->word;
    return (word[0] >> columns->shift | word[1] << 1 << (63 - columns->shift)) & columns->mask;
}

/* Adds the pixels of row y whose bits in `open` are set to the patch, as runs. down: y relative to the cell's
 * projected reference point. (`count` and `runs` are local so that the compiler need not reload them after
 * each store.) */
ISO_INLINE void list_runs(const iso_exact_projection *projection, iso_exact_patch *patch,
                          const ex_columns *columns, uint64_t open, int y, float down) {
    const ptrdiff_t at = (ptrdiff_t)y * columns->width + columns->x;
    const vf low = v_set(down), slope = v_set(columns->v ? columns->v[y] : 0);
    int count = patch->count, runs = patch->runs;
    while (open) {
        const int start = __builtin_ctzll(open);
        const uint64_t rest = open >> start, gap = ~rest, more = rest & (rest + 1);
        const int length = gap ? __builtin_ctzll(gap) : 64;
        patch->run[runs++] = (iso_exact_pixel_run){y << 16 | (columns->x + start), length};
        int n = 0;
        do {
            const vi right = v_lanes() + (columns->from + start + n);
            v_store(patch->x + count + n, v_to_float(right) - columns->place);
            v_store(patch->y + count + n, low);
            if (columns->u) {
                v_store(patch->u + count + n, v_load(columns->u + start + n));
                v_store(patch->v + count + n, slope);
            }
            n += ISO_LANES;
        } while (n < length);
        fetch_pixels(projection, at + start, at + start + length - 1);
        count += length;
        open = more << start;
    }
    patch->count = count;
    patch->runs = runs;
}

ISO_INLINE void fetch_gradient(const iso_exact_projection *projection, const iso_exact_scratch *scratch,
                               int cell) {
    int voxel[3];
    get_cell_voxel(projection, scratch, cell, voxel);
    iso_exact_gradients_fetch(&projection->voxels, voxel);
}

/* Adds the free pixels of rows y0 .. y1 within the cell's outline to the patch, and draws the patch when it
 * is full. */
ISO_INLINE void list_columns(const iso_exact_projection *projection, iso_exact_scratch *scratch, int cell,
                             const ex_columns *columns, int y0, int y1) {
    const float place = scratch->record[cell].place[1];
    const uint64_t *row = scratch->open + (ptrdiff_t)(y0 - scratch->rows.first) * scratch->words;
    for (int y = y0; y <= y1; y += ISO_LANES) {
        const int count = y1 - y < ISO_LANES ? y1 - y + 1 : ISO_LANES;
        int32_t first[ISO_LANES], last[ISO_LANES];
        float down[ISO_LANES];
        row_ends(scratch, cell, columns->x, y, first, last);
        v_store(down, v_to_float(v_lanes() + (y - scratch->octant_projection.origin[1])) - place);
        for (int n = 0; n < count; n++, row += scratch->words) {
            const uint64_t open = open_columns(row, columns) & pixels_between(first[n], last[n]);
            if (!open) continue;
            list_runs(projection, &scratch->patch, columns, open, y + n, down[n]);
            if (scratch->patch.count >= ISO_EXACT_PATCH_LIST) draw_patch(projection, scratch);
        }
    }
}

/* Draws the free pixels of a cell with an outline; box: x0 x1 y0 y1. */
ISO_STEP static void draw_outlined_cell(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                        const int box[4], int cell) {
    scratch->patch.cell = cell;
    for (int x = box[0]; x <= box[1]; x += 64) {
        const ex_columns columns = columns_from(projection, scratch, x, box[1]);
        const uint64_t *row = scratch->open + (ptrdiff_t)(box[2] - scratch->rows.first) * scratch->words;
        uint64_t any = 0;
        for (int y = box[2]; y <= box[3] && !any; y++, row += scratch->words)
            any = open_columns(row, &columns);
        if (!any) continue;
        fetch_gradient(projection, scratch, cell);
        list_columns(projection, scratch, cell, &columns, box[2], box[3]);
    }
    if (scratch->patch.count) draw_patch(projection, scratch);
}

#endif
