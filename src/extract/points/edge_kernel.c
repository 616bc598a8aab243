/* edge_kernel: the edge kernel of one voxel type (edge_kernel.h). */
#include "extract/points/edge_kernel.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/point_code.h"
#include "base/simd.h"
#include "extract/points/edge_batch.h"
#include "extract/points/edge_rows_simd.h"
#include "grids/voxel_kernel.h"

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

/* Classifies the rows of a slice of a block whose bits in `rows_read` are set: bit x of words[y] is set if
 * voxel x is at or above the threshold. Voxels beyond the grid repeat the last one. block: the block's first
 * voxel in row 0; rows: offsets of the rows; voxels: how many voxels along x the grid has from the block's
 * first one on. */
static inline void classify_rows(const ISO_T *block, const ptrdiff_t *rows, uint32_t rows_read, int voxels,
                                 ISO_THRESHOLD threshold, uint64_t *words) {
    if (voxels >= ISO_EDGE_BLOCK_X) {
        for (; rows_read; rows_read &= rows_read - 1) {
            const int y = __builtin_ctz(rows_read);
            words[y] = bits(block + rows[y], threshold);
        }
        return;
    }
    for (; rows_read; rows_read &= rows_read - 1) {
        const int y = __builtin_ctz(rows_read);
        ISO_T padded[ISO_EDGE_BLOCK_X];
        for (int x = 0; x < ISO_EDGE_BLOCK_X; x++) padded[x] = block[rows[y] + (x < voxels ? x : voxels - 1)];
        words[y] = bits(padded, threshold);
    }
}

/* As classify_rows, but only the first voxel of each row. For rows that the block before needs and this block
 * does not classify. */
static inline void classify_after(const ISO_T *block, const ptrdiff_t *rows, uint32_t rows_read, int voxels,
                                  ISO_THRESHOLD threshold, uint64_t *words) {
    for (; rows_read; rows_read &= rows_read - 1) {
        const int y = __builtin_ctz(rows_read);
        words[y] = block[rows[y] + (voxels > 0 ? 0 : voxels - 1)] >= threshold;
    }
}

static void classify_voxels(const iso_edge_source *source, const int origin[3], iso_edge_words *words) {
    const ISO_THRESHOLD threshold = ISO_THRESHOLD_OF(source->isovalue_ceil);
    const ISO_T *data = (const ISO_T *)source->data + origin[0];
    ptrdiff_t rows[ISO_EDGE_SIDE];
    for (int y = 0; y < ISO_EDGE_SIDE; y++)
        rows[y] = iso_edge_clamp(origin[1] + y, source->first[1], source->dims[1]) * source->stride_y;
    for (int z = 0; z < ISO_EDGE_SIDE; z++) {
        const ISO_T *slice =
            data + iso_edge_clamp(origin[2] + z, source->first[2], source->dims[2]) * source->stride_z;
        uint32_t before = 0; /* rows in which the block before needs this block's first voxel */
        for (int b = 0; b <= words->blocks; b++) {
            const int x = b * ISO_EDGE_BLOCK_X, voxels = source->dims[0] - origin[0] - x;
            uint64_t *bits = words->bits[b] + z * ISO_EDGE_SIDE;
            const uint32_t here = b < words->blocks ? iso_edge_rows_read(words->active[b], z) : 0;
            classify_rows(slice + x, rows, here, voxels, threshold, bits);
            classify_after(slice + x, rows, before & ~here, voxels, threshold, bits);
            before = b < words->blocks && words->active[b].bricks >> (ISO_EDGE_BRICKS - 1) ? here : 0;
        }
    }
}

/* Sets block->points and the lists of the three axes, from the words of block `number` and of the next one.
 */
static void list_block(const iso_edge_source *source, const iso_edge_words *words, int number,
                       iso_edge_block *restrict block) {
    const uint64_t *restrict bits = words->bits[number], *restrict next = words->bits[number + 1];
    const iso_edge_active active = words->active[number];
    const int y_end = iso_edge_extent(source->dims[1] - block->origin[1]),
              z_end = iso_edge_extent(source->dims[2] - block->origin[2]);
    const uint64_t columns = iso_edge_columns(active, source->dims[0] - block->origin[0]);
    uint64_t lanes = 0; /* number of points of each of the block's four bricks, 16 bits each */
    for (int axis = 0; axis < 3; axis++) block->axes[axis].count = 0;
    for (int z = 0; z < z_end; z++) {
        const uint32_t rows = iso_edge_rows_own(active, z) & ((1u << y_end) - 1);
        const int first = z * ISO_EDGE_SIDE;
        if (rows) lanes += list_rows(bits + first, next + first, columns, rows, z, block->axes);
    }
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++)
        block->points[brick] = (uint32_t)(lanes >> (16 * brick) & 0xffff);
}

static void list_edges(const iso_edge_source *source, iso_edge_words *words, iso_edge_block *blocks) {
    const int *origin = blocks[0].origin;
    classify_voxels(source, origin, words);
    for (int i = 0; i < words->blocks; i++) {
        blocks[i].origin[0] = origin[0] + i * ISO_EDGE_BLOCK_X;
        blocks[i].origin[1] = origin[1];
        blocks[i].origin[2] = origin[2];
        blocks[i].bricks = words->active[i].bricks;
        list_block(source, words, i, &blocks[i]);
    }
}

/* Adds the edges of a list, from word `entry` on, to the batch until it is full; returns the first word that
 * was not added. */
static inline int add_edges(const iso_edge_entries *list, int entry, iso_edge_batch *batch) {
    int n = batch->count;
    for (; entry < list->count; entry++) {
        const int end = n + __builtin_popcountll(list->mask[entry]);
        if (end > ISO_EDGE_BATCH) break;
        expand(list->mask[entry], list->row[entry], end - n, batch->x + n, batch->row + n);
        n = end;
    }
    batch->count = n;
    return entry;
}

/* The voxels around the edges of a batch, copied in groups that are consecutive in memory.
 * Edges along x: line[0] = x-1 .. x+2 in the edge's row; pair[0 .. 3] = x, x+1 in the rows y-1, y+1, z-1,
 * z+1. Edges along y or z: line[0] and line[1] = x-1 .. x+1 at the lower and the upper end; single[0] and
 * single[1] = the voxels before and after the edge on its axis; single[2 .. 5] = the neighbours on the axis
 * that is neither x nor the edge's: below and above the lower end, below and above the upper end. */
typedef struct edge_around {
    ISO_T line[2][ISO_EDGE_BATCH_MAX][4];
    union {
        ISO_T pair[4][ISO_EDGE_BATCH_MAX][2];
        ISO_T single[6][ISO_EDGE_BATCH_MAX];
    };
} edge_around;

/* Copies the voxels around the batch's edges from number `from` on, for edges along x. */
ISO_STEP static void fetch_x(const ISO_T *base, const iso_edge_source *source, const iso_edge_batch *batch,
                             int from, edge_around *out) {
    const ptrdiff_t step[4] = {-source->stride_y, source->stride_y, -source->stride_z, source->stride_z};
    for (int i = from; i < batch->count; i++) {
        const ISO_T *p = base + source->row_offset[batch->row[i]] + batch->x[i];
        memcpy(out->line[0][i], p - 1, sizeof out->line[0][i]);
        for (int k = 0; k < 4; k++) memcpy(out->pair[k][i], p + step[k], sizeof out->pair[k][i]);
    }
}

/* Copies the voxels around the batch's edges from number `from` on, for edges along y or z (`axis`). */
ISO_STEP static void fetch_yz(const ISO_T *base, const iso_edge_source *source, int axis,
                              const iso_edge_batch *batch, int from, edge_around *out) {
    const ptrdiff_t a = axis == 1 ? source->stride_y : source->stride_z,
                    b = axis == 1 ? source->stride_z : source->stride_y;
    for (int i = from; i < batch->count; i++) {
        const ISO_T *p = base + source->row_offset[batch->row[i]] + batch->x[i];
        memcpy(out->line[0][i], p - 1, sizeof out->line[0][i]);
        memcpy(out->line[1][i], p + a - 1, sizeof out->line[1][i]);
        out->single[0][i] = p[-a];
        out->single[1][i] = p[2 * a];
        out->single[2][i] = p[-b];
        out->single[3][i] = p[b];
        out->single[4][i] = p[a - b];
        out->single[5][i] = p[a + b];
    }
}

/* Copies the voxels around the batch's edges from number `from` on, for blocks next to the grid's border: a
 * missing neighbour is replaced by the voxel itself, and batch->weight is set. */
ISO_STEP static void fetch_border(const iso_edge_source *source, const int origin[3], int axis,
                                  iso_edge_batch *batch, int from, edge_around *out) {
    const ISO_T *data = source->data;
    const int across = 3 - axis; /* for y and z edges: the axis that is neither the edge's nor x */
    for (int i = from; i < batch->count; i++) {
        iso_edge_stencil stencil;
        const int row = batch->row[i];
        const int lower[3] = {origin[0] + batch->x[i] + !!(row & ISO_EDGE_FACE), origin[1] + (row & 31),
                              origin[2] + (row >> 5 & 31)};
        iso_edge_border_stencil(source, lower, axis, &stencil);
        for (int k = 0; k < 4; k++) batch->weight[k][i] = stencil.weight[k];
        const ptrdiff_t(*at)[3][2] = stencil.neighbour;
        if (axis == 0) {
            out->line[0][i][0] = data[at[0][0][0]];
            out->line[0][i][1] = data[stencil.end[0]];
            out->line[0][i][2] = data[stencil.end[1]];
            out->line[0][i][3] = data[at[1][0][1]];
            for (int k = 0; k < 4; k++)
                for (int end = 0; end < 2; end++) out->pair[k][i][end] = data[at[end][1 + k / 2][k % 2]];
        } else {
            for (int end = 0; end < 2; end++) {
                out->line[end][i][0] = data[at[end][0][0]];
                out->line[end][i][1] = data[stencil.end[end]];
                out->line[end][i][2] = data[at[end][0][1]];
                out->single[end][i] = data[at[end][axis][end]];
                for (int side = 0; side < 2; side++)
                    out->single[2 + 2 * end + side][i] = data[at[end][across][side]];
            }
        }
    }
}

/* Sets batch->t, the positions on the edges, and batch->normal, the outward gradients scaled to |x| + |y| +
 * |z| = 1. In names, a is the edge's axis, b and c the others; the first digit is the end of the edge, the
 * second the side of that end. */
ISO_INLINE void interpolate(const iso_edge_source *source, iso_edge_batch *restrict batch,
                            const edge_around *restrict in, int axis, bool along_row, bool border) {
    const float isovalue_ceil = source->isovalue_ceil, residual = source->residual;
    const float normal_sign = source->level_set ? 1.0f : -1.0f;
    const int n = (batch->count + 15) & ~15;
    float *restrict along_edge = batch->normal[axis], *restrict along_x = batch->normal[axis == 0 ? 1 : 0],
                    *restrict across = batch->normal[axis == 0 ? 2 : 3 - axis];
    for (int i = 0; i < n; i++) {
        const float w0 = border ? batch->weight[0][i] : 0.5f, w1 = border ? batch->weight[1][i] : 0.5f;
        const float wb = border ? batch->weight[2][i] : 0.5f, wc = border ? batch->weight[3][i] : 0.5f;
        float before, v0, v1, after;                  /* along the edge, whose ends are v0 and v1 */
        float b00, b01, b10, b11, c00, c01, c10, c11; /* beside it; the names are explained above */
        if (along_row) {
            before = (float)in->line[0][i][0], v0 = (float)in->line[0][i][1];
            v1 = (float)in->line[0][i][2], after = (float)in->line[0][i][3];
            b00 = (float)in->pair[0][i][0], b10 = (float)in->pair[0][i][1];
            b01 = (float)in->pair[1][i][0], b11 = (float)in->pair[1][i][1];
            c00 = (float)in->pair[2][i][0], c10 = (float)in->pair[2][i][1];
            c01 = (float)in->pair[3][i][0], c11 = (float)in->pair[3][i][1];
        } else {
            b00 = (float)in->line[0][i][0], v0 = (float)in->line[0][i][1], b01 = (float)in->line[0][i][2];
            b10 = (float)in->line[1][i][0], v1 = (float)in->line[1][i][1], b11 = (float)in->line[1][i][2];
            before = (float)in->single[0][i], after = (float)in->single[1][i];
            c00 = (float)in->single[2][i], c01 = (float)in->single[3][i];
            c10 = (float)in->single[4][i], c11 = (float)in->single[5][i];
        }
        const float rise = v1 - v0;
        float t = (isovalue_ceil - v0 + residual) / rise; /* (a small difference is exact) */
        t = t > 0 ? t : 0;                                /* 0 also for NaN, when the difference overflows */
        t = t < 1 ? t : 1;
        const float a0 = (v1 - before) * w0, a1 = (after - v0) * w1;
        const float b0 = (b01 - b00) * wb, b1 = (b11 - b10) * wb, c0 = (c01 - c00) * wc,
                    c1 = (c11 - c10) * wc;
        const float a = (a0 + t * (a1 - a0)) * normal_sign, b = (b0 + t * (b1 - b0)) * normal_sign,
                    c = (c0 + t * (c1 - c0)) * normal_sign;
        const float sum = fabsf(a) + fabsf(b) + fabsf(c);
        /* where the gradient vanishes or overflows, the normal is the edge's outward direction */
        const bool usable = sum > 0 && sum <= FLT_MAX;
        const float lift = ISO_EDGE_LIFT(ISO_T, sum);
        const float scale = 1 / (usable ? sum * lift : 1), edge = rise > 0 ? normal_sign : -normal_sign;
        batch->t[i] = t;
        along_edge[i] = usable ? a * lift * scale : edge;
        along_x[i] = usable ? b * lift * scale : 0;
        across[i] = usable ? c * lift * scale : 0;
    }
}

/* Edges along y and z have one loop: only the places of what it writes differ. */
#define ISO_INTERPOLATE(name, along_row, border)                                                             \
    ISO_STEP static void name(const iso_edge_source *source, iso_edge_batch *batch, const edge_around *in,   \
                              int axis) {                                                                    \
        interpolate(source, batch, in, along_row ? 0 : axis, along_row, border);                             \
    }
ISO_INTERPOLATE(interpolate_x, true, false)
ISO_INTERPOLATE(interpolate_yz, false, false)
ISO_INTERPOLATE(interpolate_border_x, true, true)
ISO_INTERPOLATE(interpolate_border_yz, false, true)
#undef ISO_INTERPOLATE

/* Copies the voxels around the edges from `from` on. */
static void fetch(const iso_edge_source *source, const int origin[3], int axis, iso_edge_batch *batch,
                  int from, edge_around *out) {
    const ISO_T *base = (const ISO_T *)source->data + iso_edge_index(source, origin);
    if (iso_edge_at_border(source, origin)) {
        fetch_border(source, origin, axis, batch, from, out);
    } else if (axis == 0) {
        fetch_x(base, source, batch, from, out);
    } else {
        fetch_yz(base, source, axis, batch, from, out);
    }
}

/* Computes the points of a batch, copies them to their bricks, and empties the batch. */
static void compute_batch(const iso_edge_source *source, iso_edge_batch *batch, const edge_around *around,
                          int axis, iso_edge_ranges *ranges) {
    static void (*const interpolate[2][2])(const iso_edge_source *, iso_edge_batch *, const edge_around *,
                                           int) = {
        {interpolate_x, interpolate_yz},
        {interpolate_border_x, interpolate_border_yz},
    };
    const iso_edge_finish *finish = &ISO_KERNEL_NAME(iso_edge_finish);
    if (!ranges->count) return;
    interpolate[ranges->border][axis != 0](source, batch, around, axis);
    if (ranges->range[0].task->output.packed[0]) {
        finish->pack[axis](batch);
    } else {
        finish->set_surfels(batch, axis);
    }
    for (int i = 0; i < ranges->count; i++) iso_edge_scatter(batch, &ranges->range[i]);
    batch->count = ranges->count = 0;
}

/* Computes the points of the tasks on edges along one axis, batch by batch. */
static void compute_axis(const iso_edge_source *source, iso_edge_task *tasks, int count, int axis) {
    iso_edge_batch batch;
    edge_around around;
    iso_edge_ranges ranges = {.border = false};
    batch.count = ranges.count = 0;
    for (int j = 0; j < count; j++) {
        const iso_edge_entries *list = &tasks[j].axes[axis];
        const bool border = iso_edge_at_border(source, tasks[j].origin);
        for (int entry = 0; entry < list->count;) {
            if (ranges.count == ISO_EDGE_RANGES || border != ranges.border)
                compute_batch(source, &batch, &around, axis, &ranges);
            const int from = batch.count;
            entry = add_edges(list, entry, &batch);
            fetch(source, tasks[j].origin, axis, &batch, from, &around);
            ranges.range[ranges.count++] = (iso_edge_range){&tasks[j], from, batch.count};
            ranges.border = border;
            if (entry < list->count)
                compute_batch(source, &batch, &around, axis, &ranges); /* the batch is full */
        }
    }
    compute_batch(source, &batch, &around, axis, &ranges);
}

static void compute_points(const iso_edge_source *source, iso_edge_task *tasks, int count) {
    for (int axis = 0; axis < 3; axis++) compute_axis(source, tasks, count, axis);
}

const iso_edge_kernel ISO_KERNEL_NAME(ISO_PASTE(iso_edge_kernel, ISO_VARIANT)) = {list_edges, compute_points,
                                                                                  classify_voxels};
