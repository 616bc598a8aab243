/* kernel_simd: constants and scalar helpers of the drawing kernels (first_kernel.c, layers_kernel.c). */
#ifndef ISO_EXACT_KERNEL_SIMD_H
#define ISO_EXACT_KERNEL_SIMD_H

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/exponential.h"
#include "base/simd.h"
#include "exact/kernel.h"
#include "render/shading/phong_vectors.h"

/* 0: the kernel shows the first crossing of each ray; 1: it lists all of them as fragments. A kernel file
 * defines it first. */
#ifndef ISO_EXACT_LAYERED
#define ISO_EXACT_LAYERED 0
#endif

/* Cells are taken to reach this far beyond [-1, 1] (1e-5 is 5e-6 voxel), so that rounding opens no gaps
 * between neighbours. */
#define ISO_EXACT_WIDER 1e-5f

/* A crossing this near to a face of its cell, in half cells, is doubtful when layers are listed: it may be
 * found in the neighbour as well, or not be one. */
#define ISO_EXACT_DOUBT 2e-5f

/* A bound of the rounding error of the field along a ray, as a part of the sum of its coefficients. */
#define ISO_EXACT_ROUNDING 1e-6f

/* A cell whose box has more pixels than this is tested alone. For smaller cells, testing the pixels of
 * several cells together wastes fewer vector lanes. */
#define ISO_EXACT_LARGE_CELL 32

/* Cells whose box has at least this many pixels get an outline (iso_exact_outline). For smaller ones it takes
 * longer than it saves. */
#define ISO_EXACT_BOUNDED_CELL 64

/* Cells whose box has at least this many pixels are drawn as patches (iso_exact_patch). */
#define ISO_EXACT_OUTLINED_CELL 250

/* How many pairs of a pixel and a cell are collected before they are tested. More pairs fill vectors better,
 * but within a batch a pixel is also tested against cells behind one that it already shows. */
#define ISO_EXACT_BATCH 64

enum { RECORD_FLOATS = sizeof(iso_exact_cell) / sizeof(float) };

/* Sets `voxel` to the first corner of a cell, as a voxel of the grid, which may be a chunk's. cell: its
 * number in scratch->octant. */
static void get_cell_voxel(const iso_exact_projection *projection, const iso_exact_scratch *scratch, int cell,
                           int voxel[3]) {
    const int position = scratch->position[cell];
    const int local[3] = {position & 7, position >> 3 & 7, position >> 6};
    for (int axis = 0; axis < 3; axis++)
        voxel[axis] = ISO_BRICK * (scratch->span->brick[axis] - projection->exact->origin[axis]) +
                      scratch->octant->origin[axis] + local[axis];
}

static inline void keep_least(uint64_t *key, uint32_t place, uint32_t word) {
    const uint64_t made = (uint64_t)place << 32 | word;
    if (made < *key) *key = made;
}

/* Replaces the keys of pixel `at` if those of a crossing in the brick with this place are smaller. */
static inline void keep_key(const iso_exact_paint *paint, ptrdiff_t at, uint32_t place, int32_t rgba,
                            float depth) {
    uint32_t bits;
    keep_least(paint->keys + at, place, (uint32_t)rgba);
    if (!paint->depths) return;
    memcpy(&bits, &depth, sizeof bits);
    keep_least(paint->depths + at, place, bits);
}

/* Whether an octant's cells get outlines: they are large, and far enough from the eye for the directions of
 * rays to differ little within a cell. */
static bool has_outlines(const iso_exact_projection *projection,
                         const iso_exact_octant_projection *octant_projection) {
    if (octant_projection->near || octant_projection->clip ||
        octant_projection->cell_pixels < ISO_EXACT_BOUNDED_CELL)
        return false;
    return !projection->perspective || octant_projection->depth > 48 * projection->half_depth;
}

/* Moves the lowest bits of `bits` to the positions of the set bits of `mask`, as the instruction pdep does.
 */
static inline uint64_t deposit(uint64_t bits, uint64_t mask) {
#if ISO_LANES > 4
    return _pdep_u64(bits, mask);
#else
    uint64_t to = 0;
    for (; mask; mask &= mask - 1, bits >>= 1)
        if (bits & 1) to |= mask & (0 - mask);
    return to;
#endif
}

/* The free pixels among x .. x + 63 of a row of the band, as bits. */
ISO_INLINE uint64_t open_pixels(const uint64_t *row, int x) {
    const int word = x >> 6, shift = x & 63;
    return row[word] >> shift | row[word + 1] << 1 << (63 - shift);
}

#endif
