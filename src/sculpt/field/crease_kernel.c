/* crease_kernel: corrects distances beside creases. The edge points of the zero set are collected, sorted
 * into bins of 4^3 voxels and split into those at a crease and the others. A voxel lies in the fan of a
 * crease when the edge point nearest to it is at a crease; its distance is then bounded by the distance
 * to that edge point. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/simd.h"
#include "sculpt/field/crease.h"
#include "sculpt/field/mask.h"

/* Edge points (where the zero set crosses an edge between two voxels) are sorted into bins of 4^3 voxels. The
 * brick has 4^3 bins, and one more layer of bins lies around it. All edge points within 4 voxels of a voxel
 * of the brick are thus in its own bin or the 26 bins around. Voxel coordinates in this file are counted from
 * the window's voxel (1, 1, 1). */
enum { SIDE = ISO_CREASE_SIDE, BIN = 4, INNER = ISO_BRICK / BIN, BINS = INNER + 2 };
enum { BIN_COUNT = BINS * BINS * BINS };
enum { STEP_Y = SIDE, STEP_Z = SIDE * SIDE };
/* EDGES: voxels along an axis at which an edge can begin. */
enum { EDGES = ISO_CREASE_EDGES, ROWS = EDGES * EDGES };
/* Edge points have integer coordinates in 1/UNIT voxel, so that mirrored fields have mirrored edge points. */
enum { UNIT = 1024 };
/* An edge point is at a crease if the field at one of the edge's two voxels is curved more than that of a
 * sphere with a radius of 4 voxels. For the distance field of a sphere, the sum of the second differences is
 * 2 / radius. */
static const float CREASE = 0.5f;
/* SHORTFALL: by how much redistancing may have made a distance too small. HALF_GAP: half the largest gap
 * between neighbouring edge points. Both in voxels. */
static const float SHORTFALL = 0.4f, HALF_GAP = 0.5f;
/* Only distances of NEAR to FAR voxels are corrected. Smaller ones are right already, because redistancing
 * computes them from the interface directly. For larger ones, which occur in wide bands, the nearest
 * edge point may lie outside the 27 bins. */
static const float NEAR = 1, FAR = BIN - 0.4f;
/* Extraction makes a foot point of a voxel that is nearer to the surface than this (the square root of 3),
 * from the values of the voxel's neighbours. */
static const float FOOT = 1.7320508f;

/* A bit for each voxel of a row at which an edge begins: [z * EDGES + y], bit x. For each axis, whether the
 * edge crosses the surface, and whether its edge point is at a crease. */
typedef struct edge_bits {
    uint32_t crossed[3][ROWS], at_crease[3][ROWS];
} edge_bits;

/* The edge points of one kind (at a crease or not), sorted by bins: those of bin b are first[b] .. first[b +
 * 1] - 1. Bins that are neighbours along x have neighbouring ranges, so the edge points of three such bins
 * are one range. */
typedef struct edge_point_bins {
    const iso_crease_point *points;
    uint32_t first[BIN_COUNT + 1];
} edge_point_bins;

/* Loads the voxels of a window's row from `at` on: SIDE or EDGES of them fill two or more vectors, of which
 * the last one overlaps the one before. */
ISO_INLINE int next_lanes(int x, int count) {
    return x + ISO_LANES < count && x + 2 * ISO_LANES > count ? count - ISO_LANES : x + ISO_LANES;
}

/* Marks the inside voxels of the window: bit x of row z * SIDE + y, all three counted from the window's first
 * voxel. Returns whether there are voxels of both sides. */
static bool find_inside(const float *window, uint32_t inside[SIDE * SIDE]) {
    uint32_t any = 0, all = ~0u;
    for (int row = 0; row < SIDE * SIDE; row++) {
        uint32_t bits = 0;
        for (int x = 0; x < SIDE; x = next_lanes(x, SIDE))
            bits |= v_mask(v_lt(v_load(window + row * SIDE + x), v_set(0))) << x;
        inside[row] = bits;
        any |= bits;
        all &= bits;
    }
    return any && all != (1u << SIDE) - 1;
}

/* Marks the edges that cross the surface. Edges whose upper end has no neighbours in the window on all sides
 * are left out. Returns whether there are any. */
static bool find_crossed(const uint32_t *inside, edge_bits *edges) {
    const uint32_t all = (1u << EDGES) - 1;
    uint32_t any = 0;
    for (int i = 0; i < ROWS; i++) {
        const int y = i % EDGES, z = i / EDGES;
        const uint32_t *row = inside + (z + 1) * SIDE + y + 1;
        edges->crossed[0][i] = (*row ^ *row >> 1) >> 1 & all >> 1;
        edges->crossed[1][i] = y == EDGES - 1 ? 0 : (*row ^ row[1]) >> 1 & all;
        edges->crossed[2][i] = z == EDGES - 1 ? 0 : (*row ^ row[SIDE]) >> 1 & all;
        any |= edges->crossed[0][i] | edges->crossed[1][i] | edges->crossed[2][i];
    }
    return any != 0;
}

/* Marks the voxels of a row at which the field is curved as it is at a crease. */
static uint32_t curved_bits(const float *row) {
    uint32_t bits = 0;
    for (int x = 0; x < EDGES; x = next_lanes(x, EDGES)) {
        const float *v = row + x;
        const vf sum = (v_load(v + 1) + v_load(v - 1)) + (v_load(v + STEP_Y) + v_load(v - STEP_Y)) +
                       (v_load(v + STEP_Z) + v_load(v - STEP_Z)) - v_set(6) * v_load(v);
        bits |= v_mask(v_lt(v_set(CREASE), v_abs(sum))) << x;
    }
    return bits;
}

/* Marks the edges whose edge point is at a crease; returns whether there are any. */
static bool find_creases(const float *window, edge_bits *edges) {
    uint32_t curved[ROWS], any = 0;
    for (int i = 0; i < ROWS; i++) {
        const uint32_t ends = edges->crossed[0][i] | edges->crossed[1][i] | edges->crossed[2][i] |
                              (i % EDGES ? edges->crossed[1][i - 1] : 0) |
                              (i >= EDGES ? edges->crossed[2][i - EDGES] : 0);
        curved[i] = ends ? curved_bits(window + (i / EDGES + 1) * STEP_Z + (i % EDGES + 1) * STEP_Y + 1) : 0;
    }
    for (int i = 0; i < ROWS; i++) {
        edges->at_crease[0][i] = edges->crossed[0][i] & (curved[i] | curved[i] >> 1);
        edges->at_crease[1][i] =
            edges->crossed[1][i] ? edges->crossed[1][i] & (curved[i] | curved[i + 1]) : 0;
        edges->at_crease[2][i] =
            edges->crossed[2][i] ? edges->crossed[2][i] & (curved[i] | curved[i + EDGES]) : 0;
        any |= edges->at_crease[0][i] | edges->at_crease[1][i] | edges->at_crease[2][i];
    }
    return any != 0;
}

static int bin_of(int x, int y, int z) {
    return (z / BIN * BINS + y / BIN) * BINS + x / BIN;
}

/* Sorts the edge points that `edges` marks into bins. `points` has room for all of them. */
static void sort_into_bins(const float *window, const uint32_t (*edges)[ROWS], edge_point_bins *bins,
                           iso_crease_point *points) {
    static const int steps[3] = {1, STEP_Y, STEP_Z};
    uint32_t next[BIN_COUNT];
    memset(bins->first, 0, sizeof bins->first);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < ROWS; i++)
            for (uint32_t bits = edges[axis][i]; bits; bits &= bits - 1)
                bins->first[bin_of(__builtin_ctz(bits), i % EDGES, i / EDGES) + 1]++;
    for (int bin = 0; bin < BIN_COUNT; bin++) bins->first[bin + 1] += bins->first[bin];
    memcpy(next, bins->first, sizeof next);
    bins->points = points;
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < ROWS; i++)
            for (uint32_t bits = edges[axis][i]; bits; bits &= bits - 1) {
                const int voxel[3] = {__builtin_ctz(bits), i % EDGES, i / EDGES};
                const float *low = window + (voxel[2] + 1) * STEP_Z + (voxel[1] + 1) * STEP_Y + voxel[0] + 1,
                            *high = low + steps[axis];
                iso_crease_point *p = points + next[bin_of(voxel[0], voxel[1], voxel[2])]++;
                for (int k = 0; k < 3; k++) p->at[k] = UNIT * voxel[k];
                p->at[axis] += (int32_t)lrint(UNIT * (double)*low / ((double)*low - (double)*high));
            }
}

/* The 4^3 voxels of a bin as vectors: lane by lane x fastest, then y; PLANE vectors for each z. */
enum { PLANE = BIN * BIN / ISO_LANES };
typedef struct bin_values {
    vi value[BIN][PLANE];
} bin_values;

ISO_INLINE vi smaller(vi a, vi b) {
    return v_selecti(v_lti(a, b), a, b);
}

/* Lowers each voxel's value to its squared distance from the nearest edge point in the bin and the 26 around
 * it. Unit: (1/UNIT voxel)^2. */
ISO_INLINE void lower_to_nearest(const edge_point_bins *p, const int bin[3], bin_values *least) {
    vi x[PLANE], y[PLANE];
    for (int i = 0; i < PLANE; i++) {
        const vi lane = v_lanes() + v_seti(i * ISO_LANES);
        x[i] = v_seti(UNIT * BIN * bin[0]) + (lane & v_seti(BIN - 1)) * UNIT;
        y[i] = v_seti(UNIT * BIN * bin[1]) + (lane >> 2) * UNIT;
    }
    for (int k = 0; k < 9; k++) {
        const int low = ((bin[2] + k / 3 - 1) * BINS + bin[1] + k % 3 - 1) * BINS + bin[0] - 1;
        for (uint32_t i = p->first[low]; i < p->first[low + 3]; i++) {
            const int32_t *at = p->points[i].at;
            vi square[PLANE];
            for (int j = 0; j < PLANE; j++) {
                const vi dx = x[j] - v_seti(at[0]), dy = y[j] - v_seti(at[1]);
                square[j] = dx * dx + dy * dy;
            }
            for (int z = 0; z < BIN; z++) {
                const int32_t dz = UNIT * (BIN * bin[2] + z) - at[2];
                for (int j = 0; j < PLANE; j++)
                    least->value[z][j] = smaller(square[j] + v_seti(dz * dz), least->value[z][j]);
            }
        }
    }
}

/* What decides whether voxels of the brick are corrected: bit x of row z * ISO_BRICK + y. */
typedef struct voxel_bits {
    uint32_t due[ISO_BRICK_ROWS];    /* its distance is from NEAR to FAR, and in the band */
    uint32_t beside[ISO_BRICK_ROWS]; /* a face neighbour has a value at the band's end */
} voxel_bits;

ISO_INLINE vm differ(vm a, vm b) {
    return v_or(v_andnot(a, b), v_andnot(b, a));
}

static void find_due(const float *window, float band, voxel_bits *bits) {
    static const int steps[6] = {1, -1, STEP_Y, -STEP_Y, STEP_Z, -STEP_Z};
    const vf zero = v_set(0), end = v_set(band), most = v_set(fminf(band, FAR));
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const float *from = iso_crease_row(window, row);
        bits->due[row] = bits->beside[row] = 0;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const vf v = v_load(from + x), distance = v_abs(v);
            const vm due = v_andnot(v_lt(distance, most), v_lt(distance, v_set(NEAR)));
            if (!v_mask(due)) continue;
            const vm inside = v_lt(v, zero);
            vm interface = v_from_mask(0), beside = v_from_mask(0);
            for (int k = 0; k < 6; k++) {
                const vf other = v_load(from + x + steps[k]);
                interface = v_or(interface, differ(inside, v_lt(other, zero)));
                beside = v_or(beside, v_le(end, v_abs(other)));
            }
            bits->due[row] |= v_mask(v_andnot(due, interface)) << x;
            bits->beside[row] |= v_mask(beside) << x;
        }
    }
}

/* The number of edge points in a bin and the 26 around it. */
static uint32_t points_around(const edge_point_bins *p, const int bin[3]) {
    uint32_t count = 0;
    for (int k = 0; k < 9; k++) {
        const int low = ((bin[2] + k / 3 - 1) * BINS + bin[1] + k % 3 - 1) * BINS + bin[0] - 1;
        count += p->first[low + 3] - p->first[low];
    }
    return count;
}

/* Returns the bits of one row of a bin, of the rows of a plane that a vector holds: lane 0 lowest. */
ISO_INLINE vm lanes_of(const uint32_t *rows, int row, int x) {
    uint32_t bits = 0;
    for (int y = 0; y < ISO_LANES / BIN; y++) bits |= (rows[row + y] >> x & ((1u << BIN) - 1)) << (y * BIN);
    return v_from_mask(bits);
}

/* Bounds the distances of a bin's voxels. If the edge point nearest to a voxel is at a crease, the voxel lies
 * in the fan of this crease, and its distance is bounded: at most the distance to this edge point, and not
 * much smaller. */
static void correct_bin(const edge_point_bins kind[2], const int bin[3], const voxel_bits *bits, float band,
                        float *out) {
    const int brick[3] = {BIN * (bin[0] - 1), BIN * (bin[1] - 1), BIN * (bin[2] - 1)};
    const vf foot = v_set(FOOT), gap = v_set(HALF_GAP * HALF_GAP), zero = v_set(0);
    bin_values reach, least, nearest;
    vf distance[BIN][PLANE], value[BIN][PLANE];
    uint32_t any = 0;
    for (int z = 0; z < BIN; z++)
        for (int j = 0; j < PLANE; j++) {
            float lanes[ISO_LANES];
            const int row = (brick[2] + z) * ISO_BRICK + brick[1] + j * (ISO_LANES / BIN);
            for (int y = 0; y < ISO_LANES / BIN; y++)
                memcpy(lanes + y * BIN, out + (row + y) * ISO_BRICK + brick[0], BIN * sizeof *out);
            value[z][j] = v_load(lanes);
            distance[z][j] = v_abs(value[z][j]);
            const vf far = v_min(distance[z][j], v_set(FAR)) + v_set(SHORTFALL);
            reach.value[z][j] = v_trunc(far * far * v_set(UNIT * UNIT));
        }
    least = reach;
    lower_to_nearest(&kind[1], bin, &least);
    for (int z = 0; z < BIN; z++)
        for (int j = 0; j < PLANE; j++) any |= v_mask(v_lti(least.value[z][j], reach.value[z][j]));
    nearest = least;
    if (any) lower_to_nearest(&kind[0], bin, &nearest);
    for (int z = 0; z < BIN; z++)
        for (int j = 0; j < PLANE; j++) {
            const int row = (brick[2] + z) * ISO_BRICK + brick[1] + j * (ISO_LANES / BIN);
            const vm due = lanes_of(bits->due, row, brick[0]), beside = lanes_of(bits->beside, row, brick[0]);
            const vf d = distance[z][j], square = v_to_float(least.value[z][j]) * v_set(1.0f / (UNIT * UNIT));
            const vf far = v_sqrt(square), near = v_sqrt(v_max(square - gap, zero));
            const vf bounded = v_min(v_min(v_max(d, near), far), v_max(d, v_set(0.999f * band)));
            const vm fan = v_andnot(v_lti(least.value[z][j], reach.value[z][j]),
                                    v_lti(nearest.value[z][j], least.value[z][j]));
            vf made = v_select(fan, bounded, d);
            /* extraction makes no foot point then, which is better than a wrong one */
            made = v_select(v_and(beside, v_lt(made, foot)), foot, made);
            made = v_select(v_lt(value[z][j], zero), zero - made, made);
            float lanes[ISO_LANES];
            v_store(lanes, v_select(due, made, value[z][j]));
            for (int y = 0; y < ISO_LANES / BIN; y++)
                memcpy(out + (row + y) * ISO_BRICK + brick[0], lanes + y * BIN, BIN * sizeof *out);
        }
}

/* Whether a voxel of a bin is due. */
static bool any_due(const voxel_bits *bits, const int bin[3]) {
    uint32_t any = 0;
    for (int i = 0; i < BIN * BIN; i++)
        any |= bits->due[(BIN * (bin[2] - 1) + i / BIN) * ISO_BRICK + BIN * (bin[1] - 1) + i % BIN];
    return any >> (BIN * (bin[0] - 1)) & ((1u << BIN) - 1);
}

bool ISO_KERNEL_NAME(iso_bound_creases)(const float *window, float band, iso_crease_point *room, float *out) {
    uint32_t inside[SIDE * SIDE];
    edge_bits edges;
    edge_point_bins kind[2];
    voxel_bits bits;
    if (!find_inside(window, inside) || !find_crossed(inside, &edges) || !find_creases(window, &edges))
        return false;
    sort_into_bins(window, edges.at_crease, &kind[1], room);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < ROWS; i++) edges.crossed[axis][i] &= ~edges.at_crease[axis][i];
    sort_into_bins(window, edges.crossed, &kind[0], room + kind[1].first[BIN_COUNT]);
    find_due(window, band, &bits);
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        memcpy(out + row * ISO_BRICK, iso_crease_row(window, row), ISO_BRICK * sizeof *out);
    for (int i = 0; i < INNER * INNER * INNER; i++) {
        const int bin[3] = {1 + i % INNER, 1 + i / INNER % INNER, 1 + i / (INNER * INNER)};
        if (points_around(&kind[1], bin) > 0 && any_due(&bits, bin)) correct_bin(kind, bin, &bits, band, out);
    }
    return true;
}
