/* Corrects distances beside creases. The edge points of the zero set are
 * collected, sorted into bins of 4^3 voxels and split into those at a crease and the others. A voxel lies in
 * the fan of a crease when the edge point nearest to it is at a crease; its distance is then bounded by
 * the distance to that edge point. */
#include "sculpt/field/crease.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Edge points (where the zero set crosses an edge between two voxels) are sorted into bins of 4^3 voxels. The
 * brick has 4^3 bins, and one more layer of bins lies around it. All edge points within 4 voxels of a voxel
 * of the brick are thus in its own bin or the 26 bins around. Voxel coordinates in this file are counted from
 * the window's voxel (1, 1, 1). */
enum { SIDE = ISO_CREASE_SIDE, BIN = 4, BINS = (SIDE - 2) / BIN, BIN_COUNT = BINS * BINS * BINS };
enum { STEP_Y = SIDE, STEP_Z = SIDE * SIDE };
/* EDGES: voxels along an axis at which an edge can begin. EDGE_POINTS: the largest number of edge points in a
 * window. */
enum { EDGES = SIDE - 2, EDGE_POINTS = 3 * EDGES * EDGES * EDGES };
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

/* The edge points of one kind (at a crease or not), sorted by bins: those of bin b are first[b] .. first[b +
 * 1] - 1. Coordinates in 1/UNIT voxel. */
typedef struct edge_point_bins {
    int32_t *at[3];
    uint32_t first[BIN_COUNT + 1];
} edge_point_bins;

typedef struct edge_point {
    int32_t at[3];
    uint16_t bin, crease;
} edge_point;

typedef struct edge_points {
    const float *window;
    edge_point *found;
    uint32_t count;
    edge_point_bins kind[2]; /* [0]: not at a crease, [1]: at a crease */
} edge_points;

static const float *value_at(const edge_points *c, const int voxel[3]) {
    return c->window + (voxel[2] + 1) * STEP_Z + (voxel[1] + 1) * STEP_Y + voxel[0] + 1;
}

/* Whether the field is curved at a voxel as it is at a crease. */
static bool is_curved(const float *v) {
    const float sum = (v[1] + v[-1]) + (v[STEP_Y] + v[-STEP_Y]) + (v[STEP_Z] + v[-STEP_Z]) - 6 * v[0];
    return fabsf(sum) > CREASE;
}

static void add_edge_point(edge_points *c, const int voxel[3], int axis) {
    static const int steps[3] = {1, STEP_Y, STEP_Z};
    const float *low = value_at(c, voxel), *high = low + steps[axis];
    edge_point *made = &c->found[c->count++];
    *made = (edge_point){.at = {UNIT * voxel[0], UNIT * voxel[1], UNIT * voxel[2]},
                         .bin = (uint16_t)((voxel[2] / BIN * BINS + voxel[1] / BIN) * BINS + voxel[0] / BIN),
                         .crease = is_curved(low) || is_curved(high)};
    made->at[axis] += (int32_t)lrint(UNIT * (double)*low / ((double)*low - (double)*high));
}

/* Marks the inside voxels of the window: bit x of row z * SIDE + y, all three counted from the window's first
 * voxel. */
static void find_inside(const float *window, uint32_t inside[SIDE * SIDE]) {
    for (int row = 0; row < SIDE * SIDE; row++) {
        uint32_t bits = 0;
        for (int x = 0; x < SIDE; x++) bits |= (uint32_t)(window[row * SIDE + x] < 0) << x;
        inside[row] = bits;
    }
}

/* Returns which voxels of row (y, z) begin an edge along `axis` that crosses the surface: bit x for voxel x.
 * Edges whose upper end has no neighbours in the window on all sides are left out. */
static uint32_t crossed_edges(const uint32_t *inside, int y, int z, int axis) {
    static const int steps[3] = {0, 1, SIDE};
    const uint32_t *row = inside + (z + 1) * SIDE + y + 1, all = (1u << EDGES) - 1;
    if ((axis == 1 && y == EDGES - 1) || (axis == 2 && z == EDGES - 1)) return 0;
    return axis == 0 ? (*row ^ *row >> 1) >> 1 & all >> 1 : (*row ^ row[steps[axis]]) >> 1 & all;
}

static void find_edge_points(edge_points *c) {
    uint32_t inside[SIDE * SIDE];
    find_inside(c->window, inside);
    for (int row = 0; row < EDGES * EDGES; row++)
        for (int axis = 0; axis < 3; axis++) {
            uint32_t bits = crossed_edges(inside, row % EDGES, row / EDGES, axis);
            for (; bits; bits &= bits - 1)
                add_edge_point(c, (int[3]){__builtin_ctz(bits), row % EDGES, row / EDGES}, axis);
        }
}

/* Sorts the edge points by kind and bin. Bins that are neighbours along x have neighbouring ranges, so the
 * edge points of three such bins are one range. */
static void sort_into_bins(edge_points *c) {
    uint32_t next[2][BIN_COUNT];
    for (int kind = 0; kind < 2; kind++) {
        edge_point_bins *p = &c->kind[kind];
        memset(p->first, 0, sizeof p->first);
        for (uint32_t i = 0; i < c->count; i++) p->first[c->found[i].bin + 1] += c->found[i].crease == kind;
        for (int bin = 0; bin < BIN_COUNT; bin++) p->first[bin + 1] += p->first[bin];
        memcpy(next[kind], p->first, sizeof next[kind]);
    }
    for (int axis = 0; axis < 3; axis++)
        c->kind[1].at[axis] = c->kind[0].at[axis] + c->kind[0].first[BIN_COUNT];
    for (uint32_t i = 0; i < c->count; i++) {
        const edge_point *from = &c->found[i];
        const uint32_t to = next[from->crease][from->bin]++;
        for (int axis = 0; axis < 3; axis++) c->kind[from->crease].at[axis][to] = from->at[axis];
    }
}

/* Returns the smallest squared distance from `at` to the edge points first .. end - 1, or `least` if this is
 * smaller. Unit: (1/UNIT voxel)^2. */
static int32_t nearest_in_range(const edge_point_bins *p, uint32_t first, uint32_t end, const int32_t at[3],
                                int32_t least) {
    const int32_t *restrict px = p->at[0], *restrict py = p->at[1], *restrict pz = p->at[2];
    for (uint32_t i = first; i < end; i++) {
        const int32_t x = px[i] - at[0], y = py[i] - at[1], z = pz[i] - at[2];
        const int32_t square = x * x + y * y + z * z;
        least = square < least ? square : least;
    }
    return least;
}

/* Returns the squared distance from `at` to the nearest edge point in a bin and the 26 around it, at
 * most `most`. The search ends early at an edge point nearer than `enough`. Unit: (1/UNIT voxel)^2. */
static int32_t nearest_squared(const edge_point_bins *p, const int bin[3], const int32_t at[3], int32_t most,
                               int32_t enough) {
    int32_t least = most;
    for (int k = 0; k < 9 && least >= enough; k++) {
        const int low = ((bin[2] + k / 3 - 1) * BINS + bin[1] + k % 3 - 1) * BINS + bin[0] - 1;
        least = nearest_in_range(p, p->first[low], p->first[low + 3], at, least);
    }
    return least;
}

static bool is_interface(const float *v) {
    const bool inside = *v < 0;
    return inside != (v[1] < 0) || inside != (v[-1] < 0) || inside != (v[STEP_Y] < 0) ||
           inside != (v[-STEP_Y] < 0) || inside != (v[STEP_Z] < 0) || inside != (v[-STEP_Z] < 0);
}

/* Returns the distance of a voxel. If the edge point nearest to the voxel is at a crease, the voxel lies in
 * the fan of this crease, and its distance is bounded: at most the distance to this edge point, and not much
 * smaller. */
static float bounded_distance(const edge_points *c, const int bin[3], const int voxel[3], float distance,
                              float band) {
    const int32_t at[3] = {UNIT * voxel[0], UNIT * voxel[1], UNIT * voxel[2]};
    const int32_t reach = (int32_t)((distance + SHORTFALL) * (distance + SHORTFALL) * (UNIT * UNIT));
    const int32_t least = nearest_squared(&c->kind[1], bin, at, reach, 0);
    if (least == reach || nearest_squared(&c->kind[0], bin, at, least, least) < least) return distance;
    const float square = (float)least / (UNIT * UNIT);
    const float far = sqrtf(square), near = sqrtf(fmaxf(square - HALF_GAP * HALF_GAP, 0));
    return fminf(fminf(fmaxf(distance, near), far), fmaxf(distance, 0.999f * band));
}

/* Whether a face neighbour of the voxel has a value at the band's end. */
static bool is_beside_band_end(const float *v, float band) {
    return fabsf(v[1]) >= band || fabsf(v[-1]) >= band || fabsf(v[STEP_Y]) >= band ||
           fabsf(v[-STEP_Y]) >= band || fabsf(v[STEP_Z]) >= band || fabsf(v[-STEP_Z]) >= band;
}

static float corrected_value(const edge_points *c, const int bin[3], const int voxel[3], float band) {
    const float *v = value_at(c, voxel), distance = fabsf(*v);
    if (distance < NEAR || distance >= fminf(band, FAR) || is_interface(v)) return *v;
    float made = bounded_distance(c, bin, voxel, distance, band);
    if (made < FOOT && is_beside_band_end(v, band))
        made = FOOT; /* extraction makes no foot point then, which is better than a wrong one */
    return *v < 0 ? -made : made;
}

/* Whether an edge point at a crease lies in a bin or the 26 around it. */
static bool any_crease(const edge_points *c, const int bin[3]) {
    uint32_t count = 0;
    for (int k = 0; k < 9; k++) {
        const int low = ((bin[2] + k / 3 - 1) * BINS + bin[1] + k % 3 - 1) * BINS + bin[0] - 1;
        count += c->kind[1].first[low + 3] - c->kind[1].first[low];
    }
    return count > 0;
}

static void correct_bin(const edge_points *c, const int bin[3], float band, float *out) {
    for (int i = 0; i < BIN * BIN * BIN; i++) {
        const int voxel[3] = {BIN * bin[0] + i % BIN, BIN * bin[1] + i / BIN % BIN,
                              BIN * bin[2] + i / (BIN * BIN)};
        out[((voxel[2] - BIN) * ISO_BRICK + voxel[1] - BIN) * ISO_BRICK + voxel[0] - BIN] =
            corrected_value(c, bin, voxel, band);
    }
}

iso_status iso_crease_correct(const float *window, float band, iso_buffer *room, float *out) {
    enum { M = ISO_CREASE_MARGIN, INNER = ISO_BRICK / BIN };
    edge_points c = {.window = window};
    for (int row = 0; row < ISO_BRICK * ISO_BRICK; row++)
        memcpy(out + row * ISO_BRICK,
               window + (row / ISO_BRICK + M) * STEP_Z + (row % ISO_BRICK + M) * STEP_Y + M,
               ISO_BRICK * sizeof *out);
    ISO_TRY(iso_buffer_reserve(room, EDGE_POINTS * (sizeof(edge_point) + 3 * sizeof(int32_t)), 0, NULL));
    c.found = room->data;
    for (int axis = 0; axis < 3; axis++)
        c.kind[0].at[axis] = (int32_t *)(c.found + EDGE_POINTS) + axis * EDGE_POINTS;
    find_edge_points(&c);
    sort_into_bins(&c);
    for (int i = 0; i < INNER * INNER * INNER; i++) {
        const int bin[3] = {1 + i % INNER, 1 + i / INNER % INNER, 1 + i / (INNER * INNER)};
        if (any_crease(&c, bin)) correct_bin(&c, bin, band, out);
    }
    return ISO_OK;
}
