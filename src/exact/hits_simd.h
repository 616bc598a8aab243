/* hits_simd: pixels whose ray crosses the surface are queued, from any cells. When the queue is full their
 * roots (Newton's method, safeguarded by bisection), depths and normals are computed in whole vectors and
 * written. */
#ifndef ISO_EXACT_HITS_SIMD_H
#define ISO_EXACT_HITS_SIMD_H

#include "base/simd_four.h"
#include "exact/cell_setup_simd.h"
#include "exact/kernel_simd.h"

/* The search for the roots of a vector of cubics. */
typedef struct ex_search {
    vf f[4];      /* the cubics */
    vf low, high; /* bracket of the root */
    vf x;         /* present approximation */
    vm moving;    /* lanes that have not converged */
} ex_search;

/* Starts the search for the roots in [0, 1] of the lanes `wanted`, from the zero of the straight line between
 * the cubic's values at 0 and 1. The caller has set search->f. */
ISO_INLINE void start_search(ex_search *search, vm wanted) {
    const vf zero = v_set(0), one = v_set(1), *f = search->f;
    const vf end = (f[0] + f[1]) + (f[2] + f[3]);
    search->low = zero;
    search->high = one;
    search->x = v_min(v_max(f[0] / (f[0] - end), zero), one);
    search->moving = wanted;
}

/* Starts the search for the roots of the queued pixels from number `first` on. */
ISO_INLINE void search_hits(const iso_exact_hits *hits, int first, ex_search *search) {
    for (int k = 0; k < 4; k++) search->f[k] = v_load(hits->cubic[k] + first);
    start_search(search, v_lti(v_lanes(), v_seti(hits->count - first)));
}

/* A step of Newton's method, or of bisection where Newton's would leave the bracket. A lane has converged
 * when its next step would be shorter than 5e-7 (estimated as the square of this step times bend / slope);
 * its x then no longer changes, so that it does not depend on the other lanes. */
ISO_INLINE void search_step(ex_search *search) {
    const vf *f = search->f, x = search->x, triple_f3 = 3 * f[3];
    const vf value = ((f[3] * x + f[2]) * x + f[1]) * x + f[0],
             slope = (triple_f3 * x + (f[2] + f[2])) * x + f[1], bend = triple_f3 * x + f[2];
    const vm before = v_lti(v_seti(-1), v_bits(value) ^ v_bits(f[0]));
    search->low = v_select(before, x, search->low);
    search->high = v_select(before, search->high, x);
    const vf newton = x - value / slope;
    const vm inside = v_and(v_le(search->low, newton), v_le(newton, search->high));
    const vf next = v_select(inside, newton, 0.5f * (search->low + search->high)), moved = next - x;
    search->x = v_select(search->moving, next, x);
    const vm near = v_le(v_abs(bend) * (moved * moved), 5e-7f * v_abs(slope));
    const vm done = v_or(v_and(inside, near), v_lt(v_abs(moved), v_set(4e-7f)));
    search->moving = v_andnot(search->moving, done);
}

/* Sets hits->root of all queued pixels, two vectors at a time, so that their chains of dependent instructions
 * overlap. */
ISO_STEP static void find_roots(iso_exact_hits *hits) {
    for (int i = 0; i < hits->count; i += 2 * ISO_LANES) {
        ex_search a, b;
        search_hits(hits, i, &a);
        search_hits(hits, i + ISO_LANES, &b);
        for (int step = 0; step < 24; step++) {
            search_step(&a);
            search_step(&b);
            if (!v_mask(v_or(a.moving, b.moving))) break;
        }
        v_store(hits->root + i, a.x);
        v_store(hits->root + i + ISO_LANES, b.x);
    }
}

/* Interpolates gradients for a vector of hits in one cell. corner: the gradients at its corners; x, yz: the
 * weights of the corners along x, and along y and z together. */
ISO_INLINE void interpolate_cell(const float corner[8][4], const vf x[2], const vf yz[4], vf gradient[3]) {
    for (int i = 0; i < 3; i++) {
        vf side[2];
        for (int k = 0; k < 2; k++) {
            side[k] = yz[0] * corner[k][i];
            for (int j = 1; j < 4; j++) side[k] += yz[j] * corner[2 * j + k][i];
        }
        gradient[i] = side[0] * x[0] + side[1] * x[1];
    }
}

/* Interpolates gradients for a vector of hits in different cells, hit by hit. */
ISO_INLINE void interpolate_hits(const iso_exact_hits *hits, int first, const vf x[2], const vf yz[4],
                                 vf gradient[3]) {
    float weight[6][ISO_LANES], sum[ISO_LANES][4];
    for (int k = 0; k < 2; k++) v_store(weight[k], x[k]);
    for (int k = 0; k < 4; k++) v_store(weight[2 + k], yz[k]);
    for (int lane = 0; lane < ISO_LANES; lane++) {
        const float(*corner)[4] = hits->gradient[hits->slot[first + lane]];
        v4 side[2];
        for (int k = 0; k < 2; k++) {
            side[k] = v4_set(weight[2][lane]) * v4_load(corner[k]);
            for (int j = 1; j < 4; j++) side[k] += v4_set(weight[2 + j][lane]) * v4_load(corner[2 * j + k]);
        }
        v4_store(sum[lane], side[0] * v4_set(weight[0][lane]) + side[1] * v4_set(weight[1][lane]));
    }
    int32_t index[ISO_LANES];
    v_storei(index, v_lanes() * 4);
    vf out[4];
    v_load4(sum[0], index, 1, out);
    for (int i = 0; i < 3; i++) gradient[i] = out[i];
}

/* Interpolates gradients at the hits from `first` on, whose roots are x: cell by cell if the vector has hits
 * of few cells, else hit by hit. */
ISO_INLINE void interpolate(const iso_exact_hits *hits, int first, vf x, vf gradient[3]) {
    const vf zero = v_set(0), one = v_set(1);
    vf high[3], low[3];
    for (int i = 0; i < 3; i++) {
        const vf at = v_load(hits->entry[i] + first) + x * v_load(hits->step[i] + first);
        high[i] = v_min(v_max(0.5f * at + 0.5f, zero), one);
        low[i] = one - high[i];
    }
    const vf weight[2] = {low[0], high[0]},
             yz[4] = {low[1] * low[2], high[1] * low[2], low[1] * high[2], high[1] * high[2]};
    const vi slots = v_loadi(hits->slot + first);
    const uint32_t starts =
        v_mask(v_eqi(slots, v_loadi(hits->slot + first + 1))) ^ ((1u << ISO_LANES) - 1); /* next is another */
    if (__builtin_popcount(starts) > ISO_LANES / 4) {
        interpolate_hits(hits, first, weight, yz, gradient);
        return;
    }
    interpolate_cell(hits->gradient[hits->slot[first]], weight, yz, gradient);
    for (uint32_t ends = starts; ends; ends &= ends - 1) {
        const int lane = __builtin_ctz(ends) + 1;
        if (lane >= ISO_LANES) break;
        vf more[3];
        interpolate_cell(hits->gradient[hits->slot[first + lane]], weight, yz, more);
        const vm from = v_lti(v_seti(lane - 1), v_lanes());
        for (int i = 0; i < 3; i++) gradient[i] = v_select(from, more[i], gradient[i]);
    }
}

/* Normalises normals in view space. A normal of length 0, from a gradient that vanishes, is replaced by one
 * that points to the eye. pixel: y << 16 | x. */
ISO_INLINE void unit_normals(const iso_exact_projection *projection, vi pixel, vf normal[3]) {
    vf largest = v_set(0);
    for (int k = 0; k < 3; k++) largest = v_max(v_abs(normal[k]), largest);
    const vm none = v_eq(largest, v_set(0));
    if (v_mask(none)) {
        const vf x = v_to_float((pixel & 0xffff) - projection->axis[0]) + (float)projection->offset[0],
                 y = v_to_float((pixel >> 16) - projection->axis[1]) + (float)projection->offset[1];
        normal[0] = v_select(none, -(x * projection->per_focal), normal[0]);
        normal[1] = v_select(none, -(y * projection->per_focal), normal[1]);
        normal[2] = v_select(none, v_set(-1), normal[2]);
        for (int k = 0; k < 3; k++) largest = v_max(v_abs(normal[k]), largest);
    }
    const vf scale = unit_scale(largest);
    for (int k = 0; k < 3; k++) normal[k] *= scale;
    const vf length = v_sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    const vf inverse = 1 / length;
    for (int k = 0; k < 3; k++) normal[k] *= inverse;
}

/* Computes unit normals in view space, pointing out of the solid, from gradients. */
ISO_INLINE void normals(const iso_exact_projection *projection, vi pixel, const vf gradient[3],
                        vf normal[3]) {
    for (int k = 0; k < 3; k++) {
        const float *m = projection->normal + 3 * k;
        normal[k] = m[0] * gradient[0] + m[1] * gradient[1] + m[2] * gradient[2];
    }
    unit_normals(projection, pixel, normal);
}

/* Returns the RGBA of pixels with the rays (u, v, 1) and these unit normals. */
ISO_INLINE vi shade_pixels(const iso_exact_paint *paint, vf u, vf v, const vf normal[3]) {
    const vf to_eye[3] = {-u, -v, v_set(-1)};
    const vf base[3] = {v_set(paint->base[0]), v_set(paint->base[1]), v_set(paint->base[2])};
    vf rgb[3];
    phong(normal, to_eye, base, rgb);
    return pack_pixels(rgb, v_seti(255));
}

/* Replaces `depth`, `entry` and `pixel` of all hits by the surface's depth, its normal and the sample's
 * index. (The hits are written in another loop: without its branches the processor overlaps several
 * iterations of this one.) */
ISO_STEP static void shade_hits(const iso_exact_projection *projection, iso_exact_hits *hits) {
    const iso_exact_paint *paint = projection->paint;
    const int width = projection->target->gbuffer->width;
    for (int i = 0; i < hits->count; i += ISO_LANES) {
        vf gradient[3], normal[3];
        const vi pixel = v_loadi(hits->pixel + i);
        const vf x = v_load(hits->root + i);
        interpolate(hits, i, x, gradient);
        normals(projection, pixel, gradient, normal);
        v_store(hits->depth + i,
                v_load(hits->depth + i) + x * v_load(hits->length + i) + (float)projection->middle);
        for (int k = 0; k < 3; k++) v_store(hits->entry[k] + i, normal[k]);
        if (paint)
            v_storei(hits->word + i, shade_pixels(paint, v_gather(paint->u, pixel & 0xffff),
                                                  v_gather(paint->v, pixel >> 16), normal));
        v_storei(hits->pixel + i, (pixel >> 16) * width + (pixel & 0xffff));
    }
}

/* Prefetches the memory that sample number `at` will be written to. */
ISO_INLINE void fetch_pixel(const iso_exact_projection *projection, ptrdiff_t at) {
    const iso_gbuffer *gbuffer = projection->target->gbuffer;
    if (ISO_EXACT_LAYERED) return; /* fetch_lists and fetch_fragments */
    if (projection->paint) {
        if (projection->paint->keys)
            __builtin_prefetch(projection->paint->keys + at, 1);
        else
            __builtin_prefetch(projection->paint->pixels + (at - projection->paint->skipped), 1);
        return;
    }
    __builtin_prefetch(gbuffer->depth + at, 1);
    for (int k = 0; k < 3; k++) __builtin_prefetch(gbuffer->normal[k] + at, 1);
    __builtin_prefetch(gbuffer->surface + at, 1);
}

/* Prefetches the samples `first` to `last`, at most 64 neighbours in a row. */
ISO_INLINE void fetch_pixels(const iso_exact_projection *projection, ptrdiff_t first, ptrdiff_t last) {
    fetch_pixel(projection, first);
    if ((first ^ last) >> 4) fetch_pixel(projection, last);
}

/* Writes into the gbuffer those hits that are nearer than its samples. */
ISO_STEP static void write_hits(const iso_exact_projection *projection, const iso_exact_hits *hits) {
    const iso_gbuffer *gbuffer = projection->target->gbuffer;
    float *const depth = gbuffer->depth, *const x = gbuffer->normal[0], *const y = gbuffer->normal[1],
                 *const z = gbuffer->normal[2];
    uint8_t *const surface = gbuffer->surface, number = projection->target->surface;
    for (int i = 0; i < hits->count; i++) {
        const int32_t at = hits->pixel[i];
        if (!(hits->depth[i] < depth[at])) continue;
        depth[at] = hits->depth[i];
        x[at] = hits->entry[0][i];
        y[at] = hits->entry[1][i];
        z[at] = hits->entry[2][i];
        surface[at] = number;
    }
}

/* Writes the hits into the picture. A hit of depth INFINITY is left out: another hit has taken its pixel
 * (claim_pixels). */
ISO_STEP static void paint_hits(const iso_exact_paint *paint, const iso_exact_hits *hits) {
    for (int i = 0; i < hits->count; i++)
        if (hits->depth[i] < INFINITY) paint->pixels[hits->pixel[i] - paint->skipped] = hits->word[i];
}

/* Writes the hits into the key image, likewise. */
ISO_STEP static void key_hits(const iso_exact_paint *paint, const iso_exact_hits *hits) {
    for (int i = 0; i < hits->count; i++)
        if (hits->depth[i] < INFINITY)
            keep_key(paint, hits->pixel[i], hits->place[hits->slot[i]], hits->word[i], hits->depth[i]);
}

/* ---- layers */

/* Prefetches the lists that the hits from `first` on will be added to. */
ISO_INLINE void fetch_lists(const iso_exact_scratch *scratch, int first) {
    const int32_t *pixel = scratch->hits.pixel;
    for (int i = first; i < scratch->hits.count; i++)
        iso_layer_prefetch(scratch->lists, pixel[i] & 0xffff, (pixel[i] >> 16) - scratch->rows.first);
}

/* Prefetches the fragments that the hits will be written to; their lists are in the cache by now. */
ISO_STEP static void fetch_fragments(const iso_exact_scratch *scratch) {
    const int32_t *pixel = scratch->hits.pixel;
    for (int i = 0; i < scratch->hits.count; i++)
        iso_layer_prefetch_next(scratch->lists, pixel[i] & 0xffff, (pixel[i] >> 16) - scratch->rows.first);
}

/* Returns the opacities of a surface with these unit normals, seen from the directions to_eye. */
ISO_INLINE vf opacities(const iso_exact_fragments *fragments, const vf normal[3], const vf to_eye[3]) {
    const iso_layer_opacity *opacity = &fragments->opacity;
    if (!opacity->by_angle) return v_set(opacity->face_on);
    const vf length = v_sqrt(v_dot3(to_eye, to_eye));
    const vf cosine = v_max(v_abs(v_dot3(normal, to_eye)) / length, v_set(ISO_LAYER_LEAST_COSINE));
    return 1 - v_exp2(opacity->log_through / cosine);
}

/* Returns the lanes whose crossings, at the positions `at` in their cells, are doubtful. In a cell with flags
 * the surface may lie in a face, where crossings are certain; there only crossings near an edge are
 * doubtful. */
ISO_INLINE vm are_doubtful(const vf at[3], vi flags) {
    const vf x = v_abs(at[0]), y = v_abs(at[1]), z = v_abs(at[2]);
    const vf largest = v_max(v_max(x, y), z), second = v_max(v_min(x, y), v_min(v_max(x, y), z));
    return v_lt(v_set(1 - ISO_EXACT_DOUBT), v_select(v_eqi(flags, v_seti(0)), largest, second));
}

/* Packs fragments (iso_packed_fragment) without their depths. falls: the field falls along the ray. */
ISO_INLINE void pack_fragments(const iso_exact_projection *projection, const vf normal[3], const vf to_eye[3],
                               vm falls, vf packed[3]) {
    const iso_exact_fragments *fragments = projection->fragments;
    const float *own = projection->paint->base;
    const vf base[3] = {v_set(own[0]), v_set(own[1]), v_set(own[2])};
    vf rgb[3];
    vi color[3];
    phong(normal, to_eye, base, rgb);
    for (int k = 0; k < 3 && fragments->normals; k++)
        rgb[k] = normal[k] * ISO_LAYER_NORMAL_SCALE + ISO_LAYER_NORMAL_SCALE;
    for (int k = 0; k < 3; k++) color[k] = v_trunc(rgb[k] * (float)ISO_LAYER_COLOR + 0.5f);
    const vi leaves = v_selecti(falls, v_seti(fragments->fall_leaves), v_seti(1 - fragments->fall_leaves));
    const vf stops = opacities(fragments, normal, to_eye) * (float)ISO_LAYER_OPACITY + 0.5f;
    const vi opacity = v_trunc(v_min(stops, v_set((float)(ISO_LAYER_OPACITY - 1))));
    packed[0] = v_floats(color[0] | color[1] << 22);
    packed[1] = v_floats(color[1] >> 10 | color[2] << 12);
    packed[2] = v_floats(color[2] >> 20 | leaves << 2 | fragments->surface << 3 | opacity << 9);
}

/* Replaces `entry` of all hits by the packed fragments, `depth` by the depths of the surface, and `word` by
 * whether the hits are doubtful. */
ISO_STEP static void shade_fragments(const iso_exact_projection *projection, iso_exact_hits *hits) {
    const iso_exact_paint *paint = projection->paint;
    for (int i = 0; i < hits->count; i += ISO_LANES) {
        vf gradient[3], normal[3], packed[3], at[3];
        const vi pixel = v_loadi(hits->pixel + i);
        const vf x = v_load(hits->root + i);
        interpolate(hits, i, x, gradient);
        normals(projection, pixel, gradient, normal);
        const vf to_eye[3] = {-v_gather(paint->u, pixel & 0xffff), -v_gather(paint->v, pixel >> 16),
                              v_set(-1)};
        const vm falls = v_lti(v_seti(-1), v_bits(v_load(hits->cubic[0] + i))); /* from above the isovalue */
        pack_fragments(projection, normal, to_eye, falls, packed);
        for (int k = 0; k < 3; k++) at[k] = v_load(hits->entry[k] + i) + x * v_load(hits->step[k] + i);
        const vm doubtful = are_doubtful(at, v_loadi(hits->word + i));
        v_storei(hits->word + i, v_selecti(doubtful, v_seti(1), v_seti(0)));
        v_store(hits->depth + i, v_load(hits->depth + i) + x * v_load(hits->length + i));
        for (int k = 0; k < 3; k++) v_store(hits->entry[k] + i, packed[k]);
    }
}

/* Adds a fragment to the lists, and marks its pixel (y << 16 | x) as no longer free when nothing behind the
 * fragment can be seen. packed: all of the fragment except the depth. */
ISO_INLINE void add_fragment(iso_exact_scratch *scratch, int32_t pixel, float depth, const float packed[3],
                             bool doubtful) {
    const int x = pixel & 0xffff, row = (pixel >> 16) - scratch->rows.first;
    iso_packed_fragment fragment = {.depth = depth};
    memcpy(fragment.words, packed, sizeof fragment.words);
    if (iso_layer_add_packed(scratch->lists, x, row, &fragment, doubtful))
        scratch->open[(ptrdiff_t)row * scratch->words + (x >> 6)] &= ~((uint64_t)1 << (x & 63));
}

ISO_STEP static void add_hits(iso_exact_scratch *scratch) {
    const iso_exact_hits *hits = &scratch->hits;
    for (int i = 0; i < hits->count; i++) {
        const float packed[3] = {hits->entry[0][i], hits->entry[1][i], hits->entry[2][i]};
        add_fragment(scratch, hits->pixel[i], hits->depth[i], packed, hits->word[i]);
    }
}

/* The function iso_exact_kernel.flush: computes and writes all queued pixels, and empties the queue. */
ISO_STEP static void flush_hits(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_hits *hits = &scratch->hits;
    if (!hits->count) return;
    if (ISO_EXACT_LAYERED) fetch_fragments(scratch);
    find_roots(hits);
    for (int slot = 0; slot < hits->slots; slot++)
        projection->gradients(&projection->exact->grid, hits->voxel[slot], hits->gradient[slot]);
    /* the lanes beyond the last hit, and one more that `interpolate` reads, repeat the last hit */
    for (int lane = 0; lane <= ISO_LANES; lane++) {
        hits->slot[hits->count + lane] = hits->slot[hits->count - 1];
        hits->pixel[hits->count + lane] = hits->pixel[hits->count - 1];
    }
    if (ISO_EXACT_LAYERED) {
        shade_fragments(projection, hits);
        add_hits(scratch);
    } else {
        shade_hits(projection, hits);
        if (projection->paint && projection->paint->keys)
            key_hits(projection->paint, hits);
        else if (projection->paint)
            paint_hits(projection->paint, hits);
        else
            write_hits(projection, hits);
    }
    hits->count = hits->slots = 0;
}

/* Computes and writes all queued pixels while an octant is being drawn. The octant's cells then have no slots
 * any more. */
ISO_INLINE void flush_octant(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    if (!scratch->hits.count) return;
    flush_hits(projection, scratch);
    memset(scratch->slot, 0xff, (size_t)scratch->octant->cells * sizeof *scratch->slot);
}

/* Gives the cell of the octant the next slot, prefetches the voxels for its gradients, and returns the
 * slot. */
ISO_STEP static int32_t reserve_slot(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                     int cell) {
    const int slot = scratch->hits.slots++;
    get_cell_voxel(projection, scratch, cell, scratch->hits.voxel[slot]);
    if (!ISO_EXACT_LAYERED) scratch->hits.place[slot] = scratch->place;
    iso_exact_gradients_fetch(&projection->voxels, scratch->hits.voxel[slot]);
    return scratch->slot[cell] = slot;
}

#endif
