/* solid_bits: one bit for each voxel of a lattice: whether the voxel is inside a solid. What occlusion and
 * shadows follow rays through (render/occlusion/visibility.h). */
#ifndef ISO_RENDER_OCCLUSION_SOLID_BITS_H
#define ISO_RENDER_OCCLUSION_SOLID_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/geometry.h"
#include "base/status.h"

/* A word has 32 voxels along x, the first one in the lowest bit. The words of consecutive y lie side by side,
 * so that a vector holds 32 x ISO_LANES voxels. There is an empty column of words before and behind the
 * others, and ISO_SOLID_PAD empty words before and behind those of each column. */
enum { ISO_SOLID_WORD = 32, ISO_SOLID_PAD = 16 };

typedef struct iso_solid_bits {
    int dims[3];       /* voxels */
    int columns;       /* words along x that hold voxels */
    iso_affine affine; /* of index coordinates: those of the voxels' centres are whole numbers */
    uint32_t *words;
    size_t column, layer; /* words from a column to the next one, and from a z to the next one */
} iso_solid_bits;

/* Makes a lattice without solid voxels. Free with iso_solid_bits_free. ISO_ERR_NOMEM. */
iso_status iso_solid_bits_create(const int dims[3], const iso_affine *affine, iso_solid_bits *bits,
                                 iso_error *error);
void iso_solid_bits_free(iso_solid_bits *bits);
/* The memory of a lattice, bytes. */
uint64_t iso_solid_bits_bytes(const int dims[3]);

/* The word with voxel (32 * column, y, z); column: -1 .. columns, y: -ISO_SOLID_PAD .. dims[1] - 1 +
 * ISO_SOLID_PAD. */
static inline uint32_t *iso_solid_word(const iso_solid_bits *bits, int column, int y, int z) {
    return bits->words + (size_t)z * bits->layer + (size_t)(column + 1) * bits->column +
           (size_t)(y + ISO_SOLID_PAD);
}

/* Whether a voxel of the lattice is solid. */
static inline bool iso_solid_at(const iso_solid_bits *bits, int x, int y, int z) {
    return *iso_solid_word(bits, x / ISO_SOLID_WORD, y, z) >> x % ISO_SOLID_WORD & 1;
}

/* Sets `count` <= 32 voxels from (x, y, z) on along x to the lowest bits of `solid`; those that lie outside
 * the lattice are left out. Threads must not write to the same words at a time. */
void iso_solid_bits_write(iso_solid_bits *bits, int x, int y, int z, int count, uint32_t solid);

/* Makes a lattice of the same size whose solid voxels are the empty ones of `bits` among voxels lo .. hi
 * (inclusive), but for those of `removed`, and those of `things`, which are solid in both; of the same size
 * (NULL: none). Free with iso_solid_bits_free. ISO_ERR_NOMEM. */
iso_status iso_solid_bits_invert(const iso_solid_bits *bits, const iso_solid_bits *removed,
                                 const iso_solid_bits *things, const int lo[3], const int hi[3],
                                 iso_solid_bits *inverse, iso_error *error);

#endif
