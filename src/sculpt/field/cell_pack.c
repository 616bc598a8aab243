/* Packs a brick without loss: 4096 codes of two bits say whether each voxel is +band, -band or a distance;
 * then follow the distances. */
#include "sculpt/field/cell_pack.h"

#include <string.h>

enum { MASK_BYTES = ISO_BRICK_VOXELS / 4, OUTSIDE = 0, INSIDE = 1, DISTANCE = 2 };

/* Returns the code of a value. Bit patterns are compared, so that any value, even NaN, is restored exactly.
 */
static unsigned code_of(float value, float band) {
    const float inside = -band;
    if (memcmp(&value, &band, sizeof value) == 0) return OUTSIDE;
    return memcmp(&value, &inside, sizeof value) == 0 ? INSIDE : DISTANCE;
}

size_t iso_cell_pack_size(const float *brick, float band) {
    size_t distances = 0;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) distances += code_of(brick[i], band) == DISTANCE;
    return MASK_BYTES + distances * sizeof(float);
}

void iso_cell_pack(const float *brick, float band, uint8_t *bytes) {
    uint8_t *values = bytes + MASK_BYTES;
    for (int i = 0; i < ISO_BRICK_VOXELS; i += 4) {
        unsigned mask = 0;
        for (int k = 0; k < 4; k++) {
            unsigned kind = code_of(brick[i + k], band);
            mask |= kind << (2 * k);
            if (kind != DISTANCE) continue;
            memcpy(values, &brick[i + k], sizeof(float));
            values += sizeof(float);
        }
        bytes[i / 4] = (uint8_t)mask;
    }
}

bool iso_cell_unpack(const uint8_t *bytes, size_t size, float band, float *brick) {
    if (size < MASK_BYTES) return false;
    const uint8_t *values = bytes + MASK_BYTES, *end = bytes + size;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        unsigned kind = bytes[i / 4] >> (2 * (i % 4)) & 3;
        if (kind == DISTANCE) {
            if (end - values < (ptrdiff_t)sizeof(float)) return false;
            memcpy(&brick[i], values, sizeof(float));
            values += sizeof(float);
        } else if (kind <= INSIDE)
            brick[i] = kind == INSIDE ? -band : band;
        else
            return false;
    }
    return values == end;
}
