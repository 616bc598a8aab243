/* edge_kernel: batches, stencils next to the grid's border and other scalar helpers of the edge kernel;
 * includes its body (edge_kernel_body.inc) once per voxel type. A unit for each instruction set
 * (base/kernel_units.h). */
#include "extract/points/edge_kernel.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/point_code.h"
#include "grids/threshold.h"
#include "grids/voxel_kernels.h"

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

static inline int iso_edge_clamp(int i, int first, int dim) {
    return i < first ? first : i < dim ? i : dim - 1;
}

static inline int iso_edge_extent(int left) {
    return left < ISO_BRICK ? left : ISO_BRICK;
}

static inline ptrdiff_t iso_edge_index(const iso_edge_source *source, const int at[3]) {
    return at[0] + at[1] * source->stride_y + at[2] * source->stride_z;
}

/* Whether a voxel in the stencils of the block's edges may lie outside the grid. */
static bool iso_edge_at_border(const iso_edge_source *source, const int origin[3]) {
    const int size[3] = {ISO_EDGE_BLOCK_X, ISO_BRICK, ISO_BRICK};
    for (int axis = 0; axis < 3; axis++)
        if (origin[axis] == source->first[axis] || origin[axis] + size[axis] + 2 > source->dims[axis])
            return true;
    return false;
}

/* The factor that lifts a gradient with |x| + |y| + |z| = `sum` so that the inverse of its norm is finite.
 * (Integer gradients are never so short.) */
#define ISO_EDGE_LIFT(type, sum) (sizeof(type) == sizeof(float) && (sum) < 0x1p-64f ? 0x1p64f : 1.0f)

/* The stencil of an edge next to the grid's border. */
typedef struct iso_edge_stencil {
    ptrdiff_t end[2];             /* the two ends, as indices of elements */
    ptrdiff_t neighbour[2][3][2]; /* [end][axis][lower or upper side], clamped to the grid */
    float weight[4]; /* 1/2, or 1 for a one-sided difference: along the edge at its two ends, then along the
                        two other axes */
} iso_edge_stencil;

static void iso_edge_border_stencil(const iso_edge_source *source, const int lower[3], int axis,
                                    iso_edge_stencil *stencil) {
    int across = 2;
    for (int end = 0; end < 2; end++) {
        int at[3] = {lower[0], lower[1], lower[2]};
        at[axis] += end;
        stencil->end[end] = iso_edge_index(source, at);
        for (int k = 0; k < 3; k++) {
            int low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]};
            low[k] = iso_edge_clamp(at[k] - 1, source->first[k], source->dims[k]);
            high[k] = iso_edge_clamp(at[k] + 1, source->first[k], source->dims[k]);
            stencil->neighbour[end][k][0] = iso_edge_index(source, low);
            stencil->neighbour[end][k][1] = iso_edge_index(source, high);
            float weight = high[k] - low[k] == 2 ? 0.5f : 1.0f;
            if (k == axis) {
                stencil->weight[end] = weight;
            } else if (end == 0) {
                stencil->weight[across++] = weight;
            }
        }
    }
}

/* The range of a batch that holds the edges of one task. */
typedef struct iso_edge_range {
    iso_edge_task *task;
    int from, end;
} iso_edge_range;

/* The ranges of a batch. Either all of their blocks are next to the grid's border, or none is. */
typedef struct iso_edge_ranges {
    int count;
    bool border;
    iso_edge_range range[ISO_EDGE_RANGES];
} iso_edge_ranges;

/* Appends the points of one task in the batch to the arrays of their bricks, and adds their numbers to
 * task->lanes. */
__attribute__((always_inline)) static inline void iso_edge_scatter(const iso_edge_batch *batch,
                                                                   const iso_edge_range *range) {
    const iso_edge_output *output = &range->task->output;
    uint64_t lanes = range->task->lanes;
    if (output->packed[0]) {
        for (int i = range->from; i < range->end; i++) {
            int brick = batch->x[i] >> 4;
            output->packed[brick][lanes >> (16 * brick) & 0xffff] = batch->packed[i];
            lanes += (uint64_t)1 << (16 * brick);
        }
        range->task->lanes = lanes;
        return;
    }
    for (int i = range->from; i < range->end; i++) {
        const int brick = batch->x[i] >> 4;
        const uint64_t place = lanes >> (16 * brick) & 0xffff;
        iso_surfel *surfel = output->surfels[brick] + place;
        for (int k = 0; k < 3; k++) surfel->position[k] = batch->position[k][i];
        for (int k = 0; k < 3; k++) surfel->normal[k] = batch->normal[k][i];
        if (output->keys[0]) output->keys[brick][place] = batch->key[i];
        lanes += (uint64_t)1 << (16 * brick);
    }
    range->task->lanes = lanes;
}

/* Returns a mask of the block's columns that are in active bricks and in the grid, which has `voxels` voxels
 * along x from the block on. */
static uint64_t iso_edge_columns(iso_edge_active active, int voxels) {
    uint64_t lanes = 0;
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++)
        lanes |= (uint64_t)(active.bricks >> brick & 1) * 0xffff << (16 * brick);
    return voxels < ISO_EDGE_BLOCK_X ? lanes & (((uint64_t)1 << voxels) - 1) : lanes;
}

#include "extract/points/edge_kernel_rows.inc"

#define ISO_KERNEL_BODY "extract/points/edge_kernel_finish.inc"
#include "base/kernel_levels.inc"

#define ISO_KERNEL_BODY "grids/voxel_kernels.inc"
#define ISO_VOXEL_BODY "extract/points/edge_kernel_body.inc"
#include "base/kernel_levels.inc"
#undef ISO_VOXEL_BODY

#define FUNCTION(name, type) ISO_PASTE(ISO_PASTE(name, type), ISO_KERNEL_LEVEL)
#define KERNEL(type)                                                                                         \
    { FUNCTION(list_edges, type), FUNCTION(compute_points, type), FUNCTION(classify_voxels, type) }
const iso_edge_kernels ISO_PASTE(iso_edge_kernels, ISO_KERNEL_LEVEL) = {[ISO_UINT8] = KERNEL(uint8),
                                                                        [ISO_INT16] = KERNEL(int16),
                                                                        [ISO_UINT16] = KERNEL(uint16),
                                                                        [ISO_FLOAT32] = KERNEL(float)};
