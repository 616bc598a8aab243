/* kernel: constants and scalar helpers of the drawing kernel; includes its body once per instruction set. */
#include "exact/kernel.h"

#include <math.h>
#include <string.h>

#include "render/shading/phong_vectors.h"

/* Cells are taken to reach this far beyond [-1, 1] (1e-5 is 5e-6 voxel), so that rounding opens no gaps
 * between neighbours. Next to the eye the rounding errors of rays are larger. */
#define ISO_EXACT_WIDER 1e-5f
#define ISO_EXACT_WIDER_NEAR 4e-5f

/* A cell whose box has more pixels than this is tested alone. For smaller cells, testing the pixels of
 * several cells together wastes fewer vector lanes. */
#define ISO_EXACT_LARGE_CELL 32

/* Cells whose box has at least this many pixels get an outline (iso_exact_outline). */
#define ISO_EXACT_OUTLINED_CELL 250

/* How many pairs of a pixel and a cell are collected before they are tested. More pairs fill vectors better,
 * but within a batch a pixel is also tested against cells behind one that it already shows. */
#define ISO_EXACT_BATCH 64

enum { RECORD_FLOATS = sizeof(iso_exact_cell) / sizeof(float) };

void iso_exact_project_near_cells(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    const double half[3] = {0.5, 0.5, 0.5};
    for (int i = 0; i < scratch->octant->cells; i++) {
        const int local[3] = {scratch->position[i] & 7, scratch->position[i] >> 3 & 7,
                              scratch->position[i] >> 6};
        iso_exact_cell *record = &scratch->record[i];
        double centre[3];
        for (int axis = 0; axis < 3; axis++) {
            centre[axis] = (double)ISO_BRICK * scratch->span->brick[axis] + scratch->octant->origin[axis] +
                           local[axis] + 0.5;
            record->eye[axis] = (float)(2 * (projection->eye[axis] - centre[axis]));
            record->half[axis] = 1 + ISO_EXACT_WIDER_NEAR;
            record->shift[axis] = 0;
        }
        record->place[0] = record->place[1] = record->scale = 0;
        record->depth = (float)-projection->middle;
        record->behind = (float)-projection->target->view->near;
        int pixels[4] = {0, -1, 0, -1};
        iso_exact_pixel_box(projection, centre, half, scratch->clip, pixels);
        for (int k = 0; k < 4; k++) scratch->box[k][i] = pixels[k];
    }
}

/* Sets `voxel` to the index coordinates of a cell's first corner. cell: its number in scratch->octant. */
static void get_cell_voxel(const iso_exact_scratch *scratch, int cell, int voxel[3]) {
    const int position = scratch->position[cell];
    const int local[3] = {position & 7, position >> 3 & 7, position >> 6};
    for (int axis = 0; axis < 3; axis++)
        voxel[axis] = ISO_BRICK * scratch->span->brick[axis] + scratch->octant->origin[axis] + local[axis];
}

/* Whether an octant's cells get outlines: they are large, and far enough from the eye for the directions of
 * rays to differ little within a cell. */
static bool has_outlines(const iso_exact_projection *projection,
                         const iso_exact_octant_projection *octant_projection) {
    if (octant_projection->near || octant_projection->clip ||
        octant_projection->cell_pixels < ISO_EXACT_OUTLINED_CELL)
        return false;
    return !projection->perspective || octant_projection->depth > 48 * projection->half_depth;
}

/* deposit_LEVEL: moves the lowest bits of `bits` to the positions of the set bits of `mask`, as the
 * instruction pdep does. */
static inline uint64_t deposit_generic(uint64_t bits, uint64_t mask) {
    uint64_t to = 0;
    for (; mask; mask &= mask - 1, bits >>= 1)
        if (bits & 1) to |= mask & (0 - mask);
    return to;
}
#if ISO_HAVE_X86
ISO_TARGET_AVX2 static inline uint64_t deposit_avx2(uint64_t bits, uint64_t mask) {
    return _pdep_u64(bits, mask);
}
ISO_TARGET_AVX512 static inline uint64_t deposit_avx512(uint64_t bits, uint64_t mask) {
    return _pdep_u64(bits, mask);
}
#endif

#define ISO_KERNEL_BODY "exact/kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_exact_kernel *iso_exact_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
