/* solid_bits: memory and writing. */
#include "render/occlusion/solid_bits.h"

#include "base/memory.h"

static size_t column_words(const int dims[3]) {
    return (size_t)dims[1] + 2 * ISO_SOLID_PAD;
}

static int columns_of(const int dims[3]) {
    return (dims[0] + ISO_SOLID_WORD - 1) / ISO_SOLID_WORD;
}

uint64_t iso_solid_bits_bytes(const int dims[3]) {
    return (uint64_t)column_words(dims) * (uint64_t)(columns_of(dims) + 2) * (uint64_t)dims[2] *
           sizeof(uint32_t);
}

iso_status iso_solid_bits_create(const int dims[3], const iso_affine *affine, iso_solid_bits *bits,
                                 iso_error *error) {
    iso_solid_bits made = {.columns = columns_of(dims), .affine = *affine, .column = column_words(dims)};
    for (int axis = 0; axis < 3; axis++) made.dims[axis] = dims[axis];
    made.layer = made.column * (size_t)(made.columns + 2);
    made.words = iso_alloc_zero((size_t)dims[2], made.layer * sizeof *made.words);
    if (!made.words) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the voxels of occlusion");
    *bits = made;
    return ISO_OK;
}

void iso_solid_bits_free(iso_solid_bits *bits) {
    iso_free(bits->words);
    bits->words = NULL;
}

void iso_solid_bits_write(iso_solid_bits *bits, int x, int y, int z, int count, uint32_t solid) {
    if (y < 0 || y >= bits->dims[1] || z < 0 || z >= bits->dims[2]) return;
    if (x + count > bits->dims[0]) count = bits->dims[0] - x;
    if (x < 0) {
        count += x;
        solid = -x < ISO_SOLID_WORD ? solid >> -x : 0;
        x = 0;
    }
    if (count <= 0) return;
    const int shift = x % ISO_SOLID_WORD;
    const uint64_t mask = (((uint64_t)1 << count) - 1) << shift, value = (uint64_t)solid << shift & mask;
    uint32_t *word = iso_solid_word(bits, x / ISO_SOLID_WORD, y, z);
    *word = (*word & ~(uint32_t)mask) | (uint32_t)value;
    if (mask >> 32) {
        word += bits->column;
        *word = (*word & ~(uint32_t)(mask >> 32)) | (uint32_t)(value >> 32);
    }
}

/* Those of the voxels lo .. hi that lie in a column. */
static uint32_t column_mask(int column, int lo, int hi) {
    const int first = lo - ISO_SOLID_WORD * column, last = hi - ISO_SOLID_WORD * column;
    if (last < 0 || first >= ISO_SOLID_WORD) return 0;
    return UINT32_MAX << (first < 0 ? 0 : first) &
           UINT32_MAX >> (ISO_SOLID_WORD - 1 - (last < ISO_SOLID_WORD ? last : ISO_SOLID_WORD - 1));
}

iso_status iso_solid_bits_invert(const iso_solid_bits *bits, const iso_solid_bits *removed,
                                 const iso_solid_bits *things, const int lo[3], const int hi[3],
                                 iso_solid_bits *inverse, iso_error *error) {
    ISO_TRY(iso_solid_bits_create(bits->dims, &bits->affine, inverse, error));
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int column = 0; column < bits->columns; column++) {
            const uint32_t mask = column_mask(column, lo[0], hi[0]),
                           *from = iso_solid_word(bits, column, 0, z),
                           *without = removed ? iso_solid_word(removed, column, 0, z) : NULL,
                           *with = things ? iso_solid_word(things, column, 0, z) : NULL;
            uint32_t *to = iso_solid_word(inverse, column, 0, z);
            for (int y = lo[1]; y <= hi[1]; y++)
                to[y] = (~(from[y] | (without ? without[y] : 0)) | (with ? with[y] : 0)) & mask;
        }
    return ISO_OK;
}
