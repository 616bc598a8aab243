/* edge_finish_simd: a batch of edges, and its points from positions on edges and normals, packed or as
 * floats. */
#ifndef ISO_EXTRACT_POINTS_EDGE_FINISH_SIMD_H
#define ISO_EXTRACT_POINTS_EDGE_FINISH_SIMD_H

#include <math.h>

#include "base/point_code.h"
#include "base/simd.h"
#include "extract/points/edge_kernel.h"

enum { ISO_EDGE_BATCH = 512, ISO_EDGE_BATCH_MAX = ISO_EDGE_BATCH + 64, ISO_EDGE_RANGES = 32 };

/* Crossed edges along one axis, from one or several blocks, and their points. The arrays are longer than
 * ISO_EDGE_BATCH so that whole vectors can be computed. */
typedef struct iso_edge_batch {
    int count;
    uint8_t x[ISO_EDGE_BATCH_MAX];    /* the edge's lower voxel in its block: x .. */
    uint16_t row[ISO_EDGE_BATCH_MAX]; /* .. and the number of its row */
    /* Next to the border: factors of the differences along the edge at its two ends, then along the two other
     * axes in ascending order (as in iso_edge_stencil). */
    float weight[4][ISO_EDGE_BATCH_MAX];
    float t[ISO_EDGE_BATCH_MAX]; /* position on the edge, 0 .. 1 */
    float normal[3][ISO_EDGE_BATCH_MAX];
    union {
        iso_point packed[ISO_EDGE_BATCH_MAX];
        struct {
            float position[3][ISO_EDGE_BATCH_MAX];
            iso_edge_key key[ISO_EDGE_BATCH_MAX];
        };
    };
} iso_edge_batch;

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
    ISO_STEP static void name(iso_edge_batch *batch) {                                                       \
        pack(batch, axis);                                                                                   \
    }
ISO_PACK(pack_x, 0)
ISO_PACK(pack_y, 1)
ISO_PACK(pack_z, 2)
#undef ISO_PACK

/* Sets the points of a batch as floats: positions, unit normals and keys. */
ISO_STEP static void set_surfels(iso_edge_batch *restrict batch, int axis) {
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

#endif
