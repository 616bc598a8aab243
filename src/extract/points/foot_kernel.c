/* foot_kernel: foot points of a brick, and irregular voxels one by one. */
#include "extract/points/foot_kernel.h"

#include <math.h>
#include <string.h>

#include "base/point_code.h"
#include "base/simd.h"
#include "extract/points/foot_lanes_simd.h"

/* Reads the values of the voxel at offset o of the brick and of its neighbours. */
static void read_stencil(const iso_foot_brick *brick, size_t o, iso_foot_stencil *stencil) {
    stencil->centre = brick->values[o];
    for (int axis = 0; axis < 3; axis++) {
        const iso_foot_face *low = &brick->face[2 * axis], *high = low + 1;
        size_t step = (size_t)1 << 4 * axis, at = o >> 4 * axis & 15, x = axis ? o & 15 : 0;
        stencil->voxel[axis] = (int)at;
        stencil->low[axis] = at > 0 ? brick->values[o - step] : low->base[(o & low->mask) + x];
        stencil->high[axis] = at < 15 ? brick->values[o + step] : high->base[(o & high->mask) + x];
    }
}

/* The x neighbours of a half row's ends, before[half] and after[half] for the two halves of a row: they lie
 * in the brick or beyond its face. The table replaces branches, which could not be predicted. A face is read
 * only for a voxel in the band (else the entry inside the brick is taken), because each row of a face is
 * another cache line. */
typedef struct foot_ends {
    iso_foot_face before[2], after[2];
} foot_ends;

static inline foot_ends half_row_ends(const iso_foot_brick *brick) {
    const iso_foot_face low = {brick->values + 7, 0xff0}, high = {brick->values + 8, 0xff0};
    return (foot_ends){{brick->face[0], low}, {high, brick->face[1]}};
}

static inline foot_half_row half_row_of(const iso_foot_scratch *scratch, const foot_ends *ends,
                                        size_t number) {
    const size_t row = number >> 1, half = number & 1, o = number * 8;
    const uint32_t hits = scratch->hits[number];
    const float *const *at = scratch->rows + row + (row & 0xf0) + ISO_FOOT_PITCH + ISO_FOOT_FIRST;
    const iso_foot_face *before = &ends->before[half | (~hits & 1)], *after = &ends->after[half & hits >> 7];
    return (foot_half_row){.hits = hits,
                           .voxel = (int32_t)o,
                           .here = at[0] + 8 * half,
                           .low_y = at[-1] + 8 * half,
                           .high_y = at[1] + 8 * half,
                           .low_z = at[-ISO_FOOT_PITCH] + 8 * half,
                           .high_z = at[ISO_FOOT_PITCH] + 8 * half,
                           .before = before->base + (o & before->mask),
                           .after = after->base + (o & after->mask)};
}

/* Prefetches a cache line into the second-level cache. */
#define PREFETCH(place) __builtin_prefetch(place, 0, 1)

/* Writes the positions of the set bits, plus `first`, to `list`; returns how many there are. Writes four at a
 * time, to need fewer branches: `list` needs room for four more items. */
static inline uint32_t list_bits(uint64_t bits, uint32_t first, uint16_t *list) {
    const uint32_t count = (uint32_t)__builtin_popcountll(bits);
    for (uint32_t n = 0; n < count; n += 4)
        for (uint32_t k = 0; k < 4; k++) {
            list[n + k] = (uint16_t)(first + (uint32_t)__builtin_ctzll(bits | (uint64_t)1 << 63));
            bits &= bits - 1;
        }
    return count;
}

/* The bit that marks irregular voxels of the queue: iso_foot_is_regular is false for them, because the
 * gradient is not that of a distance field or a neighbour is missing. */
enum { IRREGULAR = ISO_BRICK_VOXELS };

/* Marks the irregular voxels of the queue, and replaces their differences by 1, so that the vectors with them
 * can be computed. */
static void mark_irregular(iso_foot_scratch *scratch, uint32_t queued) {
    for (uint32_t i = 0; i < queued; i++) {
        const float x = scratch->queue[1][i], y = scratch->queue[2][i], z = scratch->queue[3][i];
        if (iso_foot_is_regular(0.25f * (x * x + y * y + z * z))) continue;
        scratch->voxel[i] |= IRREGULAR;
        scratch->scale[i] = 1;
        for (int axis = 1; axis <= 3; axis++) scratch->queue[axis][i] = 1;
    }
}

/* Replaces the points of the marked voxels by those of iso_foot_point, or removes them where it rejects the
 * voxel; closes the gaps in the output and in scratch->voxel, and sets output->count. */
static void replace_irregular(const iso_foot_surface *surface, const iso_foot_brick *brick,
                              iso_foot_scratch *scratch, uint32_t queued, iso_foot_output *output) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < queued; i++) {
        if (!(scratch->voxel[i] & IRREGULAR)) {
            if (output->packed) output->packed[kept] = output->packed[i];
            if (output->surfels) output->surfels[kept] = output->surfels[i];
            scratch->voxel[kept++] = scratch->voxel[i];
            continue;
        }
        iso_foot_stencil stencil;
        iso_surfel surfel;
        const int32_t voxel = scratch->voxel[i] & ~IRREGULAR;
        read_stencil(brick, (size_t)voxel, &stencil);
        if (!iso_foot_point(surface, &stencil, &surfel)) continue;
        if (output->packed) output->packed[kept] = iso_point_pack(&surfel);
        if (output->surfels) output->surfels[kept] = surfel;
        scratch->voxel[kept++] = voxel;
    }
    output->count = kept;
}

/* The number of the brick's voxels in the band. */
static uint32_t count_hits(const iso_foot_scratch *scratch) {
    uint32_t count = 0;
    for (int i = 0; i < ISO_FOOT_HALF_ROWS; i += 8) {
        uint64_t hits;
        memcpy(&hits, scratch->hits + i, sizeof hits);
        count += (uint32_t)__builtin_popcountll(hits);
    }
    return count;
}

/* Sets scratch->hits, the voxels in the band, and lists the half rows that have any; returns the number of
 * half rows. Prefetches the first half of the next brick: one line per pair of rows, because more at once
 * would have to wait for memory. */
static inline uint32_t list_half_rows(const iso_foot_surface *surface, const iso_foot_brick *brick,
                                      iso_foot_scratch *scratch) {
    const iso_foot_face *y = &brick->face[3], *z = &brick->face[5];
    for (size_t i = 0; i < ISO_BRICK; i++) { /* the faces of the upper neighbours, which were not read yet */
        PREFETCH(y->base + (i * 256 & y->mask));
        PREFETCH(z->base + (i * 16 & z->mask));
    }
    const float at = surface->isovalue_ceil, top = surface->top, *row = brick->values, *ahead = brick->next;
    uint8_t *marks = scratch->hits;
    for (int pair = 0; pair < ISO_BRICK * ISO_BRICK / 2; pair++) {
        PREFETCH(ahead);
        const uint32_t hits = band_hits(row, at, top) | band_hits(row + ISO_BRICK, at, top) << 16;
        for (int half_row = 0; half_row < 4; half_row++) marks[half_row] = (uint8_t)(hits >> 8 * half_row);
        row += 2 * ISO_BRICK;
        ahead += ISO_BRICK;
        marks += 4;
    }
    uint32_t count = 0;
    for (uint32_t first = 0; first < ISO_FOOT_HALF_ROWS; first += 64)
        count += list_bits(any(scratch->hits + first), first, scratch->half_rows + count);
    return count;
}

/* Fills the table of rows (iso_foot_scratch.rows). */
static inline void list_rows(const iso_foot_brick *brick, const float **rows) {
    const iso_foot_face *face = brick->face;
    const float **row = rows + ISO_FOOT_FIRST, **last = row + (ISO_BRICK + 1) * ISO_FOOT_PITCH;
    for (size_t i = 0; i < ISO_BRICK; i++) {
        row[i] = face[4].base + (i * 16 & face[4].mask);
        last[i] = face[5].base + (i * 16 & face[5].mask);
    }
    for (size_t o = 0; o < ISO_BRICK_VOXELS; o += ISO_BRICK * ISO_BRICK) {
        row += ISO_FOOT_PITCH;
        row[-1] = face[2].base + (o & face[2].mask);
        row_addresses(brick->values + o, row);
        row[ISO_BRICK] = face[3].base + (o & face[3].mask);
    }
}

/* Queues the voxels in the band of the listed half rows; returns how many there are. Prefetches the second
 * half of the next brick. */
static inline uint32_t fill_queue(float band, const iso_foot_brick *brick, uint32_t half_rows,
                                  iso_foot_scratch *scratch) {
    const foot_ends ends = half_row_ends(brick);
    const float *ahead = brick->next + ISO_BRICK_VOXELS / 2, *end = brick->next + ISO_BRICK_VOXELS;
    float *queue = scratch->queue[0];
    int32_t *voxel = scratch->voxel;
    for (uint32_t i = 0; i < half_rows; i++) {
        if (ahead < end) { /* two lines a half row: more at once would have to wait for memory */
            PREFETCH(ahead);
            PREFETCH(ahead + ISO_BRICK);
            ahead += 2 * ISO_BRICK;
        }
        const foot_half_row half_row = half_row_of(scratch, &ends, scratch->half_rows[i]);
        const uint32_t kept = queue_half_row(band, &half_row, queue, voxel);
        queue += kept;
        voxel += kept;
    }
    for (; ahead < end; ahead += ISO_BRICK) PREFETCH(ahead);
    return (uint32_t)(voxel - scratch->voxel);
}

/* The arithmetic of iso_foot_point and iso_point_pack is split into three loops. Divisions and square roots
 * take long; the processor overlaps those of more vectors when the dependent arithmetic is in another loop.
 */

/* Sets scratch->scale, the factor from differences to unit normal; returns the number of irregular voxels.
 * The differences are twice the gradient: a power of two, so that the normals have the same bits. */
static inline uint32_t scale_normals(const iso_foot_surface *surface, iso_foot_scratch *scratch,
                                     uint32_t count) {
    const float normal_sign = surface->normal_sign;
    const float *restrict dx = scratch->queue[1], *restrict dy = scratch->queue[2],
                          *restrict dz = scratch->queue[3];
    float *restrict scale = scratch->scale;
    uint32_t irregular = 0;
    for (uint32_t i = 0; i < count; i++) {
        const float squared = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i];
        irregular += !iso_foot_is_regular(0.25f * squared);
        scale[i] = normal_sign / sqrtf(squared);
    }
    return irregular;
}

/* Sets scratch->flat, the factor from unit normal to |x| + |y| + |z| = 1. */
static inline void scale_octahedron(iso_foot_scratch *scratch, uint32_t count) {
    const float *restrict dx = scratch->queue[1], *restrict dy = scratch->queue[2],
                          *restrict dz = scratch->queue[3], *restrict scale = scratch->scale;
    float *restrict flat = scratch->flat;
    for (uint32_t i = 0; i < count; i++)
        flat[i] = 1 / (fabsf(dx[i] * scale[i]) + fabsf(dy[i] * scale[i]) + fabsf(dz[i] * scale[i]));
}

/* Computes the queue's points in packed form. */
static inline void pack_points(const iso_foot_surface *surface, const iso_foot_scratch *scratch,
                               uint32_t count, iso_point *restrict out) {
    const float at = surface->isovalue_ceil, residual = surface->residual;
    const float *restrict value = scratch->queue[0], *restrict dx = scratch->queue[1],
                          *restrict dy = scratch->queue[2], *restrict dz = scratch->queue[3],
                          *restrict scale = scratch->scale, *restrict flat = scratch->flat;
    const int32_t *restrict voxel = scratch->voxel;
    for (uint32_t i = 0; i < count; i++) {
        const float nx = dx[i] * scale[i], ny = dy[i] * scale[i], nz = dz[i] * scale[i];
        const float distance = value[i] - at - residual;
        const float px = (float)(voxel[i] & 15) - distance * nx,
                    py = (float)(voxel[i] >> 4 & 15) - distance * ny,
                    pz = (float)(voxel[i] >> 8) - distance * nz;
        float part[2];
        iso_point_fold_normal(nx * flat[i], ny * flat[i], nz, part);
        out[i] = iso_point_encode(px, py, pz, part[0], part[1]);
    }
}

/* Computes the queue's points in floats. */
static inline void set_surfels(const iso_foot_surface *surface, const iso_foot_scratch *scratch,
                               uint32_t count, iso_surfel *restrict out) {
    for (uint32_t i = 0; i < count; i++) {
        const float distance = scratch->queue[0][i] - surface->isovalue_ceil - surface->residual;
        const int32_t voxel = scratch->voxel[i];
        const int32_t corner[3] = {voxel & 15, voxel >> 4 & 15, voxel >> 8};
        for (int axis = 0; axis < 3; axis++) {
            const float n = scratch->queue[axis + 1][i] * scratch->scale[i];
            out[i].normal[axis] = n;
            out[i].position[axis] = (float)corner[axis] - distance * n;
        }
    }
}

/* Fills the queue up to a whole vector with voxels that are regular; returns the new length. */
static inline uint32_t pad_queue(const iso_foot_surface *surface, iso_foot_scratch *scratch, uint32_t count) {
    for (int i = 0; i < 16; i++) scratch->queue[0][count + i] = surface->isovalue_ceil;
    for (int axis = 1; axis <= 3; axis++)
        for (int i = 0; i < 16; i++) scratch->queue[axis][count + i] = 2;
    for (int i = 0; i < 16; i++) scratch->voxel[count + i] = 0;
    return (count + 15) & ~15u;
}

static void extract(const iso_foot_surface *surface, const iso_foot_brick *brick, iso_foot_scratch *scratch,
                    iso_foot_output *output) {
    output->count = output->rejected = 0;
    const uint32_t half_rows = list_half_rows(surface, brick, scratch);
    if (half_rows) list_rows(brick, scratch->rows);
    const uint32_t queued = fill_queue(surface->band, brick, half_rows, scratch);
    const uint32_t padded = pad_queue(surface, scratch, queued);
    const uint32_t irregular = scale_normals(surface, scratch, padded);
    if (irregular) mark_irregular(scratch, queued);
    if (output->packed) {
        scale_octahedron(scratch, padded);
        pack_points(surface, scratch, padded, output->packed);
    } else {
        set_surfels(surface, scratch, padded, output->surfels);
    }
    output->count = queued;
    if (irregular) replace_irregular(surface, brick, scratch, queued, output);
    output->rejected = half_rows ? count_hits(scratch) - output->count : 0;
}

const iso_foot_kernel ISO_KERNEL_NAME(iso_foot_kernel) = {extract};
