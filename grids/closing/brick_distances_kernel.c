/* brick_distances_kernel: finds the voxels of a brick that a triangle may be nearest to. */
#include "grids/closing/brick_distances_kernel.h"

#include "base/simd.h"

/* Writes the numbers of the voxels whose distance from the triangle may be below their bound, among those
 * that it reaches, and returns how many they are. Other voxels may be among them. */
int ISO_KERNEL_NAME(iso_find_near_voxels)(const near_triangle *t, const float *bound, uint16_t *near) {
    const vf lanes = v_to_float(v_lanes()), zero = v_set(0), slack = v_set(t->slack),
             outside = v_set(-t->outside), normal = v_set(t->plane[0]), side0 = v_set(t->sides[0][0]),
             side1 = v_set(t->sides[1][0]), side2 = v_set(t->sides[2][0]);
    int count = 0;
    for (int z = t->lo[2]; z <= t->hi[2]; z++)
        for (int y = t->lo[1]; y <= t->hi[1]; y++) {
            const float fy = (float)y, fz = (float)z;
            const float plane = row_value(t->plane, fy, fz);
            const float first = plane + t->plane[0] * (float)t->lo[0],
                        last = plane + t->plane[0] * (float)t->hi[0];
            if (first * last > 0 && first * first > t->most && last * last > t->most) continue;
            const vf row0 = v_set(row_value(t->sides[0], fy, fz)),
                     row1 = v_set(row_value(t->sides[1], fy, fz)),
                     row2 = v_set(row_value(t->sides[2], fy, fz));
            for (int x = t->lo[0] / ISO_LANES * ISO_LANES; x <= t->hi[0]; x += ISO_LANES) {
                const int voxel = (z * ISO_BRICK + y) * ISO_BRICK + x;
                const vf px = lanes + v_set((float)x), above = px * normal + v_set(plane);
                const vf within = v_min(v_min(px * side0 + row0, px * side1 + row1), px * side2 + row2),
                         out = v_min(within, zero);
                const vf least = above * above + out * out; /* at most the squared distance */
                uint32_t mask =
                    v_mask(v_and(v_le(least, v_load(bound + voxel) + slack), v_le(outside, within)));
                for (; mask; mask &= mask - 1) near[count++] = (uint16_t)(voxel + __builtin_ctz(mask));
            }
        }
    return count;
}
