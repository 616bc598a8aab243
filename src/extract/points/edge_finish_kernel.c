/* edge_finish_kernel: from positions on edges and normals to points, packed or as floats. */
#include <math.h>

#include "base/kernel.h"
#include "base/point_code.h"
#include "extract/points/edge_batch.h"

/* Packs the points of a batch, with the arithmetic of iso_point_pack_scaled, in whole vectors. */
ISO_INLINE void pack(iso_edge_batch *restrict batch, int axis) {
    const int n = (batch->count + 15) & ~15;
    const float *restrict nx = batch->normal[0], *restrict ny = batch->normal[1],
                          *restrict nz = batch->normal[2];
    for (int i = 0; i < n; i++) {
        const int32_t x_in_brick = batch->x[i] & 15, row = batch->row[i];
        const float t = batch->t[i];
        const float px = (float)x_in_brick + (axis == 0 ? t : 0),
                    py = (float)(row & 31) + (axis == 1 ? t : 0),
                    pz = (float)(row >> 5) + (axis == 2 ? t : 0);
        float part[2];
        /* + 0.0f turns -0 into 0, so that its sign does not choose the octahedron's other side */
        iso_point_fold_normal(nx[i] + 0.0f, ny[i] + 0.0f, nz[i], part);
        batch->packed[i] = iso_point_encode(px, py, pz, part[0], part[1]);
    }
}

#define ISO_PACK(name, axis)                                                                                 \
    static void name(iso_edge_batch *batch) {                                                                \
        pack(batch, axis);                                                                                   \
    }
ISO_PACK(pack_x, 0)
ISO_PACK(pack_y, 1)
ISO_PACK(pack_z, 2)
#undef ISO_PACK

/* Sets the points of a batch as floats: positions, unit normals and keys. */
static void set_surfels(iso_edge_batch *restrict batch, int axis) {
    const int n = (batch->count + 15) & ~15;
    for (int i = 0; i < n; i++) {
        const float x = batch->normal[0][i], y = batch->normal[1][i], z = batch->normal[2][i];
        const float length = sqrtf(x * x + y * y + z * z);
        batch->normal[0][i] = x / length;
        batch->normal[1][i] = y / length;
        batch->normal[2][i] = z / length;
    }
    const int first_key = iso_edge_key_make(0, 0, 0, axis);
    for (int i = 0; i < n; i++) {
        const int row = batch->row[i], x = (batch->x[i] & 15) + (row >> 10), y = row & 31, z = row >> 5 & 31;
        batch->key[i] = (iso_edge_key)(first_key + (z * ISO_LATTICE + y) * ISO_LATTICE + x);
        batch->position[0][i] = (float)x;
        batch->position[1][i] = (float)y;
        batch->position[2][i] = (float)z;
    }
    for (int i = 0; i < n; i++) batch->position[axis][i] += batch->t[i];
}

const iso_edge_finish ISO_KERNEL_NAME(iso_edge_finish) = {{pack_x, pack_y, pack_z}, set_surfels};
