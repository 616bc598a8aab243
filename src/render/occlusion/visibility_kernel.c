/* visibility_kernel: follows the rays of 32 x ISO_LANES voxels at a time. */
#include "render/occlusion/visibility_kernel.h"

#include "base/simd.h"

/* The voxels that a ray from voxels (32 column .., y .., z) meets, as bits. */
ISO_INLINE vi blocked(const iso_solid_bits *bits, const iso_visibility_ray *r, int column, int y, int z) {
    vi blocked = v_seti(0);
    for (int i = 0; i < r->count; i++) {
        const iso_ray_step s = r->steps[i];
        const int at[3] = {column + s.column, y + s.y, z + s.z};
        if ((unsigned)at[2] >= (unsigned)bits->dims[2]) break; /* it has left the lattice */
        if (at[0] < -1 || at[0] >= bits->columns) break;
        if (at[1] <= -ISO_LANES || at[1] >= bits->dims[1]) break;
        const int32_t *word = (const int32_t *)iso_solid_word(bits, at[0], at[1], at[2]);
        const vi low = v_loadi(word) >> s.shift & (int32_t)(UINT32_MAX >> s.shift),
                 high = v_loadi(word + bits->column) << 1 << (31 - s.shift);
        blocked |= low | high;
    }
    return blocked;
}

/* The voxels that are solid or have a solid neighbour, also across an edge or a corner. */
ISO_INLINE vi near(const iso_solid_bits *bits, int column, int y, int z) {
    vi left = v_seti(0), own = v_seti(0), right = v_seti(0);
    for (int dz = -1; dz <= 1; dz++) {
        if ((unsigned)(z + dz) >= (unsigned)bits->dims[2]) continue;
        for (int dy = -1; dy <= 1; dy++) {
            const int32_t *word = (const int32_t *)iso_solid_word(bits, column, y + dy, z + dz);
            left |= v_loadi(word - bits->column);
            own |= v_loadi(word);
            right |= v_loadi(word + bits->column);
        }
    }
    return own | own << 1 | (left >> 31 & 1) | (own >> 1 & INT32_MAX) | right << 31;
}

/* Finds the nodes of a group, and the directions in which each is blocked. */
void ISO_KERNEL_NAME(iso_visibility_follow)(const iso_visibility *v, const int at[3], scratch *out) {
    const int x = at[0], z0 = at[2] * ISO_VISIBILITY_Z, y0 = at[1] * ISO_VISIBILITY_Y;
    for (int z = 0; z < ISO_VISIBILITY_Z; z++)
        for (int y = 0; y < ISO_VISIBILITY_Y; y += ISO_LANES) {
            const int row = z * ISO_VISIBILITY_Y + y;
            int32_t *node = (int32_t *)out->node + row;
            if (z0 + z >= v->bits->dims[2] || y0 + y >= v->bits->dims[1]) {
                v_storei(node, v_seti(0));
                continue;
            }
            const vi own = v_loadi((const int32_t *)iso_solid_word(v->bits, x, y0 + y, z0 + z));
            const vi nodes = near(v->bits, x, y0 + y, z0 + z) & ~own;
            v_storei(node, nodes);
            if (v_mask(v_eqi(nodes, v_seti(0))) == (uint32_t)((1u << ISO_LANES) - 1)) continue;
            for (int i = 0; i < v->directions.count; i++)
                v_storei((int32_t *)out->blocked[i] + row, blocked(v->bits, &v->rays[i], x, y0 + y, z0 + z));
        }
}
