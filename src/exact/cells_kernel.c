/* cells_kernel: finds the crossed cells of a brick, and copies their corner values. */
#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "exact/cells.h"
#include "grids/threshold.h"

/* ---- pack_BYTES(to, from, mask): copies, without gaps, those of the 8 elements of 1, 2 or 4 bytes at `from`
 * whose bits in `mask` are set. `to` needs room for 8 elements; those after the copied ones are undefined
 * afterwards. */

#if ISO_LANES == 4
#define PACK_BITS(name, type)                                                                                \
    static inline void name(void *to, const void *from, uint32_t mask) {                                     \
        for (type *out = to; mask; mask &= mask - 1) *out++ = ((const type *)from)[__builtin_ctz(mask)];     \
    }
PACK_BITS(pack_1, uint8_t)
PACK_BITS(pack_2, uint16_t)
PACK_BITS(pack_4, float)
#else
static inline void pack_1(void *to, const void *from, uint32_t mask) {
    uint64_t row;
    memcpy(&row, from, sizeof row);
    row = _pext_u64(row, _pdep_u64(mask, 0x0101010101010101u) * 0xff);
    memcpy(to, &row, sizeof row);
}
#if ISO_LANES == 8
static inline void pack_2(void *to, const void *from, uint32_t mask) {
    uint64_t row[2];
    memcpy(row, from, sizeof row);
    for (int half = 0; half < 2; half++) {
        uint32_t bits = mask >> 4 * half & 15;
        row[half] = _pext_u64(row[half], _pdep_u64(bits, 0x0001000100010001u) * 0xffff);
    }
    memcpy(to, &row[0], sizeof row[0]);
    memcpy((uint16_t *)to + __builtin_popcount(mask & 15), &row[1], sizeof row[1]);
}
static inline void pack_4(void *to, const void *from, uint32_t mask) {
    __m256 row = _mm256_loadu_ps(from);
    _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(row, iso_packed_lanes(mask)));
}
#else
static inline void pack_2(void *to, const void *from, uint32_t mask) {
    _mm_storeu_si128(to, _mm_maskz_compress_epi16((__mmask8)mask, _mm_loadu_si128(from)));
}
static inline void pack_4(void *to, const void *from, uint32_t mask) {
    _mm256_storeu_ps(to, _mm256_maskz_compress_ps((__mmask8)mask, _mm256_loadu_ps(from)));
}
#endif
#endif

/* Returns the inside bits of a row of 17 voxels: bit x is set if voxel x is at or above the isovalue. Integer
 * voxels are compared with `threshold`, floats with `isovalue`. */
ISO_INLINE uint32_t row_inside(iso_type type, const void *row, float isovalue, int32_t threshold) {
    uint32_t bits = 0;
    for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
        vm inside;
        switch (type) {
        case ISO_UINT8:
            inside = v_lti(v_seti(threshold - 1), v_load_u8((const uint8_t *)row + x));
            break;
        case ISO_INT16:
            inside = v_lti(v_seti(threshold - 1), v_load_i16((const int16_t *)row + x));
            break;
        case ISO_UINT16:
            inside = v_lti(v_seti(threshold - 1), v_load_u16((const uint16_t *)row + x));
            break;
        default:
            inside = v_le(v_set(isovalue), v_load((const float *)row + x));
        }
        bits |= v_mask(inside) << x;
    }
    bool last = type == ISO_UINT8    ? ((const uint8_t *)row)[ISO_BRICK] >= threshold
                : type == ISO_INT16  ? ((const int16_t *)row)[ISO_BRICK] >= threshold
                : type == ISO_UINT16 ? ((const uint16_t *)row)[ISO_BRICK] >= threshold
                                     : ((const float *)row)[ISO_BRICK] >= isovalue;
    return bits | (uint32_t)last << ISO_BRICK;
}

/* Returns a bit for each of the 17 voxels of a row: bit x is set if voxel x is finite. */
ISO_INLINE uint32_t row_finite(const float *row) {
    uint32_t bits = 0;
    for (int x = 0; x < ISO_BRICK; x += ISO_LANES)
        bits |= v_mask(v_lt(v_abs(v_load(row + x)), v_set(INFINITY))) << x;
    return bits | (uint32_t)(fabsf(row[ISO_BRICK]) < INFINITY) << ISO_BRICK;
}

/* The results of row_inside and row_finite for each row of voxels, [z][y]; `finite` is set for float voxels
 * only. */
typedef struct ex_lattice {
    uint32_t inside[ISO_EXACT_LATTICE][ISO_EXACT_LATTICE], finite[ISO_EXACT_LATTICE][ISO_EXACT_LATTICE];
} ex_lattice;

ISO_INLINE void classify_voxels(iso_type type, const iso_exact_source *source, ex_lattice *bits) {
    const int32_t threshold = iso_integer_threshold(source->isovalue_ceil);
    for (int z = 0; z <= source->cells[2]; z++)
        for (int y = 0; y <= source->cells[1]; y++) {
            const void *row = (const char *)source->voxels +
                              (y * source->stride_y + z * source->stride_z) * (ptrdiff_t)iso_type_size(type);
            bits->inside[z][y] = row_inside(type, row, source->isovalue_ceil, threshold);
            if (type == ISO_FLOAT32) bits->finite[z][y] = row_finite(row);
        }
}

/* Sets the bits of the crossed cells: bit x of crossed[z][y] is set if the cell (x, y, z) has corners inside
 * and outside, all of them finite. */
ISO_INLINE void find_crossed(iso_type type, const iso_exact_source *source, const ex_lattice *bits,
                             uint16_t crossed[ISO_BRICK][ISO_BRICK]) {
    const uint32_t columns = (1u << source->cells[0]) - 1;
    memset(crossed, 0, sizeof(uint16_t[ISO_BRICK][ISO_BRICK]));
    for (int z = 0; z < source->cells[2]; z++) {
        const uint32_t *low = bits->inside[z], *high = bits->inside[z + 1];
        const uint32_t *finite_low = bits->finite[z], *finite_high = bits->finite[z + 1];
        for (int y = 0; y < source->cells[1]; y++) {
            uint32_t any = low[y] | low[y + 1] | high[y] | high[y + 1];
            uint32_t all = low[y] & low[y + 1] & high[y] & high[y + 1];
            uint32_t cells = (any | any >> 1) & ~(all & all >> 1) & columns;
            if (type == ISO_FLOAT32) {
                all = finite_low[y] & finite_low[y + 1] & finite_high[y] & finite_high[y + 1];
                cells &= all & all >> 1;
            }
            crossed[z][y] = (uint16_t)cells;
        }
    }
}

/* Calls the pack_BYTES function for the size of the voxel type. */
ISO_INLINE void pack(iso_type type, void *to, const void *from, uint32_t mask) {
    switch (iso_type_size(type)) {
    case 1:
        pack_1(to, from, mask);
        break;
    case 2:
        pack_2(to, from, mask);
        break;
    default:
        pack_4(to, from, mask);
    }
}

/* Writes the corner values of the octant's crossed cells to output->planes; returns the number of these
 * cells. */
ISO_INLINE uint32_t pack_corners(iso_type type, const iso_exact_source *source,
                                 const iso_exact_octant *octant, iso_exact_output *output) {
    const ptrdiff_t bytes = (ptrdiff_t)iso_type_size(type), step_y = source->stride_y * bytes,
                    step_z = source->stride_z * bytes;
    const char *first = (const char *)source->voxels + octant->origin[0] * bytes +
                        octant->origin[1] * step_y + octant->origin[2] * step_z;
    uint32_t count = 0;
    for (int z = 0; z < ISO_EXACT_SIDE; z++) {
        for (int y = 0; y < ISO_EXACT_SIDE; y++) {
            const uint32_t mask = (uint32_t)(octant->mask[z] >> 8 * y & 0xff);
            if (!mask) continue;
            const char *row = first + y * step_y + z * step_z;
            for (int corner = 0; corner < 8; corner++)
                pack(type, (char *)output->planes[corner] + count * bytes,
                     row + (corner & 1) * bytes + (corner >> 1 & 1) * step_y + (corner >> 2) * step_z, mask);
            count += (uint32_t)__builtin_popcount(mask);
        }
    }
    return count;
}

/* Sets `mask`, `low` and `high` of an octant, whose `origin` is set, from the brick's crossed cells; returns
 * false if the octant has none. */
ISO_INLINE bool octant_mask(uint16_t crossed[ISO_BRICK][ISO_BRICK], iso_exact_octant *octant) {
    uint64_t all = 0;
    uint32_t planes = 0;
    for (int z = 0; z < ISO_EXACT_SIDE; z++) {
        const uint16_t *rows = crossed[octant->origin[2] + z] + octant->origin[1];
        uint8_t bytes[ISO_EXACT_SIDE];
        for (int y = 0; y < ISO_EXACT_SIDE; y++) bytes[y] = (uint8_t)(rows[y] >> octant->origin[0]);
        uint64_t mask = 0;
        for (int y = 0; y < ISO_EXACT_SIDE; y++) mask |= (uint64_t)bytes[y] << 8 * y;
        octant->mask[z] = mask;
        all |= mask;
        planes |= (uint32_t)(mask != 0) << z;
    }
    if (!all) return false;
    uint64_t columns = all | all >> 32;
    columns |= columns >> 16;
    columns = (columns | columns >> 8) & 0xff;
    octant->low[0] = (uint8_t)__builtin_ctzll(columns);
    octant->high[0] = (uint8_t)(63 - __builtin_clzll(columns));
    octant->low[1] = (uint8_t)(__builtin_ctzll(all) / 8);
    octant->high[1] = (uint8_t)((63 - __builtin_clzll(all)) / 8);
    octant->low[2] = (uint8_t)__builtin_ctz(planes);
    octant->high[2] = (uint8_t)(31 - __builtin_clz(planes));
    return true;
}

/* Extracts the crossed cells of a brick: the iso_exact_extract for voxels of one type. */
ISO_INLINE void extract(iso_type type, const iso_exact_source *source, iso_exact_output *output) {
    ex_lattice bits;
    uint16_t crossed[ISO_BRICK][ISO_BRICK];
    const size_t bytes = iso_type_size(type);
    classify_voxels(type, source, &bits);
    find_crossed(type, source, &bits, crossed);
    output->octants = output->groups = output->cells = 0;
    for (int i = 0; i < ISO_EXACT_OCTANTS; i++) {
        iso_exact_octant *octant = &output->octant[output->octants];
        for (int axis = 0; axis < 3; axis++)
            octant->origin[axis] = (uint8_t)((i >> axis & 1) * ISO_EXACT_SIDE);
        if (!octant_mask(crossed, octant)) continue;
        const uint32_t count = pack_corners(type, source, octant, output);
        const uint32_t padded = iso_exact_groups(count) * ISO_EXACT_GROUP;
        char *to = (char *)output->corners + output->groups * iso_exact_group_bytes(type);
        for (int corner = 0; corner < 8; corner++, to += padded * bytes) {
            memcpy(to, output->planes[corner], count * bytes);
            memset(to + count * bytes, 0, (padded - count) * bytes);
        }
        octant->group = output->groups;
        octant->cells = (uint16_t)count;
        output->groups += padded / ISO_EXACT_GROUP;
        output->cells += count;
        output->octants++;
    }
}

static void extract_uint8(const iso_exact_source *source, iso_exact_output *output) {
    extract(ISO_UINT8, source, output);
}
static void extract_int16(const iso_exact_source *source, iso_exact_output *output) {
    extract(ISO_INT16, source, output);
}
static void extract_uint16(const iso_exact_source *source, iso_exact_output *output) {
    extract(ISO_UINT16, source, output);
}
static void extract_float(const iso_exact_source *source, iso_exact_output *output) {
    extract(ISO_FLOAT32, source, output);
}

iso_exact_extracts ISO_KERNEL_NAME(iso_exact_extracts) = {[ISO_UINT8] = extract_uint8,
                                                          [ISO_INT16] = extract_int16,
                                                          [ISO_UINT16] = extract_uint16,
                                                          [ISO_FLOAT32] = extract_float};
