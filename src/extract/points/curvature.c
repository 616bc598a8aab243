/* curvature: gathers points into batches, reads the values around their edges or voxels (linearly
 * extrapolated beyond the grid's border) and calls the kernel. The method is described in curvature.h. */
#include "extract/points/curvature.h"

#include <assert.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/numbers.h"
#include "base/point_code.h"
#include "extract/points/curvature_kernel.h"

iso_curvature_source iso_curvature_source_grid(const iso_rgrid *grid, const int brick[3],
                                               const iso_threshold *surface) {
    iso_curvature_source source = {.type = grid->type,
                                   .stride_y = grid->stride_y,
                                   .stride_z = grid->stride_z,
                                   .normal_sign = surface->normal_sign,
                                   .isovalue_ceil = surface->isovalue_ceil};
    ptrdiff_t offset = ISO_BRICK * (brick[0] + brick[1] * grid->stride_y + brick[2] * grid->stride_z);
    source.data = (const char *)grid->data + offset * (ptrdiff_t)iso_type_size(grid->type);
    for (int axis = 0; axis < 3; axis++) {
        source.first[axis] = -ISO_BRICK * brick[axis];
        source.last[axis] = source.first[axis] + grid->dims[axis] - 1;
    }
    return source;
}

iso_curvature_source iso_curvature_source_window(const iso_brick_window *window,
                                                 const iso_threshold *surface) {
    iso_curvature_source source = {.type = ISO_FLOAT32,
                                   .data = window->values + iso_window_index(0, 0, 0),
                                   .stride_y = ISO_STEP_Y,
                                   .stride_z = ISO_STEP_Z,
                                   .normal_sign = surface->normal_sign,
                                   .isovalue_ceil = surface->isovalue_ceil};
    memcpy(source.first, window->first, sizeof source.first);
    memcpy(source.last, window->last, sizeof source.last);
    return source;
}

/* ---- the voxels of points */

/* The voxels of a batch's points (for edge points, the lower ends of their edges), and the axis of the edges
 * (0 for foot points). */
typedef struct batch_voxels {
    int axis;
    int8_t voxel[ISO_CURVATURE_BATCH][3];
} batch_voxels;

enum { UNIT = ISO_POINT_COORDINATE_STEPS }; /* steps of a fixed-point position in a voxel */

/* Computes the position of point i in the brick in 1 / UNIT voxel. Packed positions have a step of
 * ISO_POINT_RANGE (20) of these units. */
static void fixed_position(const iso_curvature_points *points, uint32_t i, int32_t at[3]) {
    for (int axis = 0; axis < 3; axis++) {
        if (points->packed)
            at[axis] = (int32_t)iso_point_steps(points->packed[i], axis) * (int)ISO_POINT_RANGE +
                       (int)ISO_POINT_LOW * UNIT;
        else
            at[axis] = (int32_t)(points->surfels[i].position[axis] * UNIT + (2 * UNIT + 0.5f)) - 2 * UNIT;
    }
}

/* Packing rounds a position by up to half of its step, in 1 / UNIT voxel. */
enum { ROUNDED = 10 };

/* Returns whether a coordinate (in 1 / UNIT voxel) is a whole number of voxels, within the rounding of
 * packing. */
static bool is_whole(int32_t at) {
    return ((at + ROUNDED) & (UNIT - 1)) <= 2 * ROUNDED;
}

/* Returns whether a point can lie on an edge along `axis`. Sets the edge's lower voxel, and *along to the
 * position on the edge, 0 .. 1. */
static bool on_edge(const int32_t at[3], int axis, int8_t voxel[3], float *along) {
    for (int k = 0; k < 3; k++) {
        if (k != axis && !is_whole(at[k])) return false;
        voxel[k] = (int8_t)((at[k] + ROUNDED) >> 14);
    }
    if (voxel[axis] > ISO_BRICK - 1) voxel[axis] = ISO_BRICK - 1;
    const float t = (float)(at[axis] - voxel[axis] * UNIT) * (1.0f / UNIT);
    *along = t > 0 ? t < 1 ? t : 1 : 0;
    return true;
}

static void copy_normal(const iso_curvature_points *points, uint32_t i, iso_curvature_batch *batch,
                        uint32_t to) {
    if (points->packed)
        batch->octahedral[to] = (int32_t)iso_point_normal_bits(points->packed[i]);
    else
        for (int k = 0; k < 3; k++) batch->normal[k][to] = points->surfels[i].normal[k];
}

/* Fills the batch with points from `first` on, up to the first one that is not on an edge along at->axis. */
static void gather_edges(const iso_curvature_points *points, uint32_t first, iso_curvature_batch *batch,
                         batch_voxels *at) {
    batch->count = 0;
    for (uint32_t i = first; i < points->count && batch->count < ISO_CURVATURE_BATCH; i++) {
        int32_t position[3];
        fixed_position(points, i, position);
        if (!on_edge(position, at->axis, at->voxel[batch->count], &batch->along[batch->count])) return;
        copy_normal(points, i, batch, batch->count++);
    }
}

/* ---- reading values */

static float stored_value(const iso_curvature_source *source, const int at[3]) {
    ptrdiff_t i = at[0] + at[1] * source->stride_y + at[2] * source->stride_z;
    switch (source->type) {
    case ISO_UINT8:
        return ((const uint8_t *)source->data)[i];
    case ISO_INT16:
        return ((const int16_t *)source->data)[i];
    case ISO_UINT16:
        return ((const uint16_t *)source->data)[i];
    default:
        return ((const float *)source->data)[i];
    }
}

static float source_value(const void *context, const int at[3]) {
    return stored_value(context, at);
}

/* A function that reads a grid's voxels one at a time, and the grid's first and last voxel. */
typedef struct reader {
    const void *context;
    float (*value)(const void *context, const int at[3]); /* of a voxel in the grid */
    const int *first, *last;
} reader;

static reader source_reader(const iso_curvature_source *source) {
    return (reader){source, source_value, source->first, source->last};
}

/* Returns the value of a voxel. Beyond the border it is extrapolated linearly from the last two voxels, axis
 * by axis, beginning with `axis`. */
static float extrapolated_value(const reader *from, const int at[3], int axis) {
    while (axis < 3 && at[axis] >= from->first[axis] && at[axis] <= from->last[axis]) axis++;
    if (axis == 3) return from->value(from->context, at);
    const bool below = at[axis] < from->first[axis];
    int edge[3] = {at[0], at[1], at[2]}, inner[3];
    edge[axis] = below ? from->first[axis] : from->last[axis];
    memcpy(inner, edge, sizeof inner);
    if (from->last[axis] > from->first[axis]) inner[axis] += below ? 1 : -1;
    const int steps = below ? from->first[axis] - at[axis] : at[axis] - from->last[axis];
    const float here = extrapolated_value(from, edge, axis + 1);
    return here + (float)steps * (here - extrapolated_value(from, inner, axis + 1));
}

/* The offsets along a, b, c of a batch's values from the point's voxel (curvature_kernel.h): a is the edge's
 * axis. */
static const int8_t OFFSETS[ISO_CURVATURE_EDGE][3] = {
    [ISO_CURVATURE_HERE] = {0, 0, 0},     [ISO_CURVATURE_A0] = {-1, 0, 0},
    [ISO_CURVATURE_A1] = {1, 0, 0},       [ISO_CURVATURE_B0] = {0, -1, 0},
    [ISO_CURVATURE_B1] = {0, 1, 0},       [ISO_CURVATURE_C0] = {0, 0, -1},
    [ISO_CURVATURE_C1] = {0, 0, 1},       [ISO_CURVATURE_A0B0] = {-1, -1, 0},
    [ISO_CURVATURE_A1B0] = {1, -1, 0},    [ISO_CURVATURE_A0B1] = {-1, 1, 0},
    [ISO_CURVATURE_A1B1] = {1, 1, 0},     [ISO_CURVATURE_A0C0] = {-1, 0, -1},
    [ISO_CURVATURE_A1C0] = {1, 0, -1},    [ISO_CURVATURE_A0C1] = {-1, 0, 1},
    [ISO_CURVATURE_A1C1] = {1, 0, 1},     [ISO_CURVATURE_B0C0] = {0, -1, -1},
    [ISO_CURVATURE_B1C0] = {0, 1, -1},    [ISO_CURVATURE_B0C1] = {0, -1, 1},
    [ISO_CURVATURE_B1C1] = {0, 1, 1},     [ISO_CURVATURE_A2] = {2, 0, 0},
    [ISO_CURVATURE_A2B0] = {2, -1, 0},    [ISO_CURVATURE_A2B1] = {2, 1, 0},
    [ISO_CURVATURE_A2C0] = {2, 0, -1},    [ISO_CURVATURE_A2C1] = {2, 0, 1},
    [ISO_CURVATURE_A1B0C0] = {1, -1, -1}, [ISO_CURVATURE_A1B1C0] = {1, 1, -1},
    [ISO_CURVATURE_A1B0C1] = {1, -1, 1},  [ISO_CURVATURE_A1B1C1] = {1, 1, 1},
};

static int second_axis(int axis) {
    return axis == 0 ? 1 : 0;
}

static int third_axis(int axis) {
    return axis == 2 ? 1 : 2;
}

static int32_t bits_of(float value) {
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Reads the values of point i of a batch, whose stencil crosses the grid's border. */
static __attribute__((noinline)) void read_border_values(const iso_curvature_source *source,
                                                         const batch_voxels *places, int values,
                                                         iso_curvature_batch *batch, uint32_t i) {
    const int a = places->axis, b = second_axis(a), c = third_axis(a);
    const reader from = source_reader(source);
    for (int which = 0; which < values; which++) {
        int at[3] = {places->voxel[i][0], places->voxel[i][1], places->voxel[i][2]};
        at[a] += OFFSETS[which][0];
        at[b] += OFFSETS[which][1];
        at[c] += OFFSETS[which][2];
        const float value = extrapolated_value(&from, at, 0);
        batch->value[which][i] = source->type == ISO_FLOAT32 ? bits_of(value) : (int32_t)value;
    }
}

/* Whether all values that a point needs are in the grid: up to `reach` voxels up along `axis`, and one voxel
 * in the other directions. */
static bool is_inner(const iso_curvature_source *source, const int8_t voxel[3], int axis, int reach) {
    for (int k = 0; k < 3; k++)
        if (voxel[k] <= source->first[k] || voxel[k] + (k == axis ? reach : 1) > source->last[k])
            return false;
    return true;
}

/* Defines a function that reads the values of all points of a batch from voxels of one type. The offsets are
 * compile-time constants, so that each value is one load. */
#define READ_VALUES(name, type)                                                                              \
    static inline void name(const iso_curvature_source *source, const batch_voxels *places,                  \
                            const int values, iso_curvature_batch *batch) {                                  \
        const ptrdiff_t stride[3] = {1, source->stride_y, source->stride_z};                                 \
        const int axis = places->axis, reach = values == ISO_CURVATURE_EDGE ? 2 : 1;                         \
        const ptrdiff_t a = stride[axis], b = stride[second_axis(axis)], c = stride[third_axis(axis)];       \
        for (uint32_t i = 0; i < batch->count; i++) {                                                        \
            const int8_t *v = places->voxel[i];                                                              \
            if (!is_inner(source, v, axis, reach)) {                                                         \
                read_border_values(source, places, values, batch, i);                                        \
                continue;                                                                                    \
            }                                                                                                \
            const type *p = (const type *)source->data + v[0] + v[1] * stride[1] + v[2] * stride[2];         \
            _Pragma("GCC unroll 28") for (int which = 0; which < values; which++) batch->value[which][i] =   \
                p[OFFSETS[which][0] * a + OFFSETS[which][1] * b + OFFSETS[which][2] * c];                    \
        }                                                                                                    \
    }
READ_VALUES(read_uint8, uint8_t)
READ_VALUES(read_int16, int16_t)
READ_VALUES(read_uint16, uint16_t)
READ_VALUES(read_float_bits, int32_t)

static void read_edge_values(const iso_curvature_source *source, const batch_voxels *places,
                             iso_curvature_batch *batch) {
    switch (source->type) {
    case ISO_UINT8:
        read_uint8(source, places, ISO_CURVATURE_EDGE, batch);
        break;
    case ISO_INT16:
        read_int16(source, places, ISO_CURVATURE_EDGE, batch);
        break;
    case ISO_UINT16:
        read_uint16(source, places, ISO_CURVATURE_EDGE, batch);
        break;
    default:
        read_float_bits(source, places, ISO_CURVATURE_EDGE, batch);
        break;
    }
}

/* ---- curvatures */

static void store_curvatures(const iso_curvature_batch *batch, iso_curvature *curvatures) {
    for (uint32_t i = 0; i < batch->count; i++)
        curvatures[i] = (iso_curvature){(int16_t)batch->uu[i], (int16_t)batch->uv[i], (int16_t)batch->vv[i],
                                        (uint16_t)batch->extents[i]};
}

static iso_curvature_params params_for(const iso_curvature_source *source, const iso_curvature_points *points,
                                       int axis) {
    return (iso_curvature_params){.floats = source->type == ISO_FLOAT32,
                                  .packed = points->packed != NULL,
                                  .axis = axis,
                                  .normal_sign = source->normal_sign,
                                  .isovalue_ceil = source->isovalue_ceil};
}

void iso_curvatures_of_edges(const iso_curvature_source *source, const iso_curvature_points *points,
                             iso_curvature *curvatures) {
    const iso_curvature_kernel *kernel = ISO_KERNEL_UNIT(iso_curvature_kernel, iso_cpu_best());
    iso_curvature_batch batch;
    batch_voxels places = {.axis = 0};
    int misses = 0;
    for (uint32_t done = 0; done < points->count;) {
        gather_edges(points, done, &batch, &places);
        if (!batch.count) {
            assert(misses < 3); /* a point must be on an edge along one of the axes */
            places.axis = (places.axis + 1) % 3;
            misses++;
            continue;
        }
        const iso_curvature_params params = params_for(source, points, places.axis);
        read_edge_values(source, &places, &batch);
        kernel->edges(&params, &batch);
        store_curvatures(&batch, curvatures + done);
        done += batch.count;
        misses = 0;
    }
}

static uint32_t batch_of(uint32_t left) {
    return left < ISO_CURVATURE_BATCH ? left : ISO_CURVATURE_BATCH;
}

void iso_curvatures_of_feet(const iso_curvature_source *source, const iso_curvature_points *points,
                            const iso_curvature_feet *feet, iso_curvature *curvatures) {
    assert(source->type == ISO_FLOAT32);
    const iso_curvature_kernel *kernel = ISO_KERNEL_UNIT(iso_curvature_kernel, iso_cpu_best());
    iso_curvature_params params = params_for(source, points, 0);
    params.band = feet->band;
    iso_curvature_batch batch;
    batch_voxels places = {.axis = 0};
    for (uint32_t done = 0; done < points->count; done += batch.count) {
        batch.count = batch_of(points->count - done);
        for (uint32_t i = 0; i < batch.count; i++) {
            const int32_t voxel = feet->voxels[done + i];
            for (int axis = 0; axis < 3; axis++)
                places.voxel[i][axis] = (int8_t)(voxel >> (4 * axis) & (ISO_BRICK - 1));
            copy_normal(points, done + i, &batch, i);
        }
        read_float_bits(source, &places, ISO_CURVATURE_VOXEL, &batch);
        for (uint32_t i = 0; i < batch.count; i++) {
            float value;
            memcpy(&value, &batch.value[ISO_CURVATURE_HERE][i], sizeof value);
            batch.along[i] = (value - feet->isovalue_ceil) * source->normal_sign;
        }
        kernel->voxels(&params, &batch);
        store_curvatures(&batch, curvatures + done);
    }
}

static float grid_value(const void *context, const int at[3]) {
    return iso_grid_at(context, at[0], at[1], at[2]);
}

void iso_curvatures_of_nearest_voxels(const iso_grid *grid, const int brick[3], float normal_sign,
                                      const iso_curvature_points *points, iso_curvature *curvatures) {
    const int *dims = iso_grid_dims(grid), first[3] = {0, 0, 0};
    const int last[3] = {dims[0] - 1, dims[1] - 1, dims[2] - 1};
    const reader from = {grid, grid_value, first, last};
    const iso_curvature_kernel *kernel = ISO_KERNEL_UNIT(iso_curvature_kernel, iso_cpu_best());
    const iso_curvature_params params = {
        .floats = true, .packed = points->packed != NULL, .normal_sign = normal_sign, .band = INFINITY};
    iso_curvature_batch batch;
    for (uint32_t done = 0; done < points->count; done += batch.count) {
        batch.count = batch_of(points->count - done);
        for (uint32_t i = 0; i < batch.count; i++) {
            int32_t position[3], voxel[3];
            fixed_position(points, done + i, position);
            for (int k = 0; k < 3; k++)
                voxel[k] = iso_clamp_index(ISO_BRICK * brick[k] + ((position[k] + UNIT / 2) >> 14), dims[k]);
            for (int which = 0; which < ISO_CURVATURE_VOXEL; which++) {
                const int at[3] = {voxel[0] + OFFSETS[which][0], voxel[1] + OFFSETS[which][1],
                                   voxel[2] + OFFSETS[which][2]};
                batch.value[which][i] = bits_of(extrapolated_value(&from, at, 0));
            }
            batch.along[i] = 0;
            copy_normal(points, done + i, &batch, i);
        }
        kernel->voxels(&params, &batch);
        store_curvatures(&batch, curvatures + done);
    }
}
