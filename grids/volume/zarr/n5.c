/* n5: blocks of N5, as its chunks are called. A block has a header of big-endian numbers: its kind (uint16;
 * 0: an array), the number of axes (uint16), and its size on each (uint32), x first. Blocks at the end of the
 * volume may be smaller than others. */
#include <string.h>

#include "grids/volume/zarr/zarr.h"

static uint32_t big_endian(const unsigned char *bytes, int count) {
    uint32_t number = 0;
    for (int i = 0; i < count; i++) number = number << 8 | bytes[i];
    return number;
}

/* Reads the header; returns its size, or 0: it is damaged, or not of an array of these axes. */
static size_t read_header(const iso_zarr_array *array, const unsigned char *block, size_t size,
                          uint64_t sizes[ISO_ZARR_AXES]) {
    const size_t bytes = 4 + 4 * (size_t)array->axes;
    if (size < bytes || big_endian(block, 2) != 0 || big_endian(block + 2, 2) != (uint32_t)array->axes)
        return 0;
    for (int axis = 0; axis < array->axes; axis++) {
        sizes[axis] = big_endian(block + 4 + 4 * (array->axes - 1 - axis), 4);
        if (sizes[axis] < 1 || sizes[axis] > array->chunk[axis]) return 0;
    }
    return bytes;
}

/* Moves the rows of a block to where they are in a whole chunk, the last one first. */
static void spread(const iso_zarr_array *array, const uint64_t sizes[ISO_ZARR_AXES], char *target) {
    const int last = array->axes - 1;
    const size_t element = iso_scalar_size(array->scalar), row = (size_t)array->chunk[last] * element,
                 block_row = (size_t)sizes[last] * element;
    size_t rows = 1;
    for (int axis = 0; axis < last; axis++) rows *= (size_t)array->chunk[axis];
    for (size_t number = rows; number-- > 0;) {
        size_t rest = number, from = 0, step = 1;
        bool inside = true;
        for (int axis = last - 1; axis >= 0; axis--) {
            const size_t at = rest % (size_t)array->chunk[axis];
            rest /= (size_t)array->chunk[axis];
            inside &= at < sizes[axis];
            from += at * step;
            step *= (size_t)sizes[axis];
        }
        const size_t used = inside ? block_row : 0;
        memmove(target + number * row, target + (inside ? from : 0) * block_row, used);
        memset(target + number * row + used, 0, row - used);
    }
}

iso_status iso_zarr_decode_block(const iso_zarr_array *array, const char *name, const void *encoded,
                                 size_t size, void *target, void *room, iso_error *error) {
    uint64_t sizes[ISO_ZARR_AXES];
    size_t bytes = iso_scalar_size(array->scalar);
    const size_t header = read_header(array, encoded, size, sizes);
    if (!header) return iso_fail(error, ISO_ERR_IO, "%s: damaged, or not a block of an array", name);
    for (int axis = 0; axis < array->axes; axis++) bytes *= (size_t)sizes[axis];
    ISO_TRY(iso_zarr_decode(&array->codecs, name, (const char *)encoded + header, size - header, target,
                            bytes, room, error));
    spread(array, sizes, target);
    return ISO_OK;
}
