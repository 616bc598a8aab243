/* voxel_set: voxels that a stroke freezes: those of another volume, along the axes of the field's grid, in
 * voxels of their own size, so that strokes can be replayed in other voxels. */
#ifndef ISO_SCULPT_BRUSH_VOXEL_SET_H
#define ISO_SCULPT_BRUSH_VOXEL_SET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/status.h"

ISO_C_BEGIN

/* The largest number of voxels. */
enum { ISO_VOXEL_SET_MOST = 1 << 28 };

typedef struct iso_voxel_set {
    int dims[3];
    double spacing;  /* mm */
    iso_vec3 origin; /* world position of voxel (0, 0, 0) */
    uint64_t *word;  /* a bit for each voxel, x fastest, then y; NULL: there is no set */
} iso_voxel_set;

size_t iso_voxel_set_count(const iso_voxel_set *set); /* voxels in the grid */

static inline bool iso_voxel_set_has(const iso_voxel_set *set, int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= set->dims[0] || y >= set->dims[1] || z >= set->dims[2]) return false;
    const size_t i = ((size_t)z * (size_t)set->dims[1] + (size_t)y) * (size_t)set->dims[0] + (size_t)x;
    return set->word[i / 64] >> i % 64 & 1;
}

/* Allocates the bits of a grid, all 0. ISO_ERR_LIMIT: more than ISO_VOXEL_SET_MOST; ISO_ERR_NOMEM. */
iso_status iso_voxel_set_init(iso_voxel_set *set, iso_error *error);
void iso_voxel_set_free(iso_voxel_set *set);

/* Writes the lengths of runs, of voxels that are not in the set, then of some that are, and so on, in 7 bits
 * a byte, the lowest first, of which all but the last have bit 7; malloc'ed (free). NULL: out of memory. */
uint8_t *iso_voxel_set_pack(const iso_voxel_set *set, size_t *size);
/* Reads them into an initialised set. Returns false if they are not as many as the grid has voxels. */
bool iso_voxel_set_unpack(const uint8_t *bytes, size_t size, iso_voxel_set *set);

ISO_C_END
#endif
