/* edge_batch: a batch of edges, and what is the same for every voxel type: its points from positions on edges
 * and normals. Internal to the edge kernel. */
#ifndef ISO_EXTRACT_POINTS_EDGE_BATCH_H
#define ISO_EXTRACT_POINTS_EDGE_BATCH_H

#include <stdint.h>

#include "base/cpu.h"
#include "base/primitives.h"
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

/* Sets the points of a batch of edges along an axis from batch->t and batch->normal: packed, by axis, or as
 * floats. */
typedef struct iso_edge_finish {
    void (*pack[3])(iso_edge_batch *batch);
    void (*set_surfels)(iso_edge_batch *batch, int axis);
} iso_edge_finish;
ISO_KERNEL_UNITS(const iso_edge_finish, iso_edge_finish);

#endif
