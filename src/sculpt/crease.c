#include "sculpt/crease.h"

#include <math.h>
#include <string.h>

/* Crossings are kept by bins of 4^3 voxels; the brick's are the inner 4^3 of them, and what is near a voxel
 * is in its bin and those around it. */
enum { SIDE = ISO_CREASE_SIDE, BIN = 4, BINS = (SIDE - 2) / BIN, BIN_COUNT = BINS * BINS * BINS };
enum { STEP_Y = SIDE, STEP_Z = SIDE * SIDE };
/* An interface bent more than one of radius 3 (the sum of second differences is 2 / radius) is a crease. */
static const float CREASE = 0.7f;
/* What redistancing may have missed, and half the gap between crossings on a crease; voxels. */
static const float SHORT = 0.5f, HALF_GAP = 0.3f;

typedef struct crossing {
    float at[3]; /* in the window, from voxel (1, 1, 1) */
    bool crease;
} crossing;

typedef struct crossings {
    const float *window;
    crossing *list;                /* NULL: they are being counted */
    uint32_t first[BIN_COUNT + 1]; /* of each bin in the list */
    uint32_t count[BIN_COUNT];     /* so far */
    bool creases[BIN_COUNT];       /* whether any of the bin is at a crease */
} crossings;

static bool is_bent(const float *v) {
    const float sum = (v[1] + v[-1]) + (v[STEP_Y] + v[-STEP_Y]) + (v[STEP_Z] + v[-STEP_Z]) - 6 * v[0];
    return fabsf(sum) > CREASE;
}

/* Of the edges from a voxel (numbered from the window's (1, 1, 1)) upwards. To 1/4096 voxel, so that mirrored
 * fields have mirrored crossings. */
static void list_voxel(crossings *c, const int voxel[3]) {
    static const int steps[3] = {1, STEP_Y, STEP_Z};
    const float *low = c->window + (voxel[2] + 1) * STEP_Z + (voxel[1] + 1) * STEP_Y + voxel[0] + 1;
    const int bin = (voxel[2] / BIN * BINS + voxel[1] / BIN) * BINS + voxel[0] / BIN;
    for (int axis = 0; axis < 3; axis++) {
        const float *high = low + steps[axis];
        if ((*low < 0) == (*high < 0) || voxel[axis] == SIDE - 3) continue;
        const uint32_t at = c->count[bin]++;
        if (!c->list) continue;
        crossing made = {.at = {(float)voxel[0], (float)voxel[1], (float)voxel[2]},
                         .crease = is_bent(low) || is_bent(high)};
        made.at[axis] += (float)(rint(4096 * (double)*low / ((double)*low - (double)*high)) / 4096);
        c->list[c->first[bin] + at] = made;
        c->creases[bin] |= made.crease;
    }
}

static void for_voxels(crossings *c) {
    int voxel[3];
    memset(c->count, 0, sizeof c->count);
    for (voxel[2] = 0; voxel[2] < SIDE - 2; voxel[2]++)
        for (voxel[1] = 0; voxel[1] < SIDE - 2; voxel[1]++)
            for (voxel[0] = 0; voxel[0] < SIDE - 2; voxel[0]++) list_voxel(c, voxel);
}

static iso_status find_crossings(crossings *c, iso_buffer *room) {
    c->list = NULL;
    memset(c->creases, 0, sizeof c->creases);
    for_voxels(c);
    c->first[0] = 0;
    for (int bin = 0; bin < BIN_COUNT; bin++) c->first[bin + 1] = c->first[bin] + c->count[bin];
    if (!c->first[BIN_COUNT]) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(room, c->first[BIN_COUNT] * sizeof(crossing), 0, NULL));
    c->list = room->data;
    for_voxels(c);
    return ISO_OK;
}

/* The square of the distance to the nearest crossing around a bin that is, or is not, at a crease; `most`
 * where none is nearer than that. Looking ends below `enough`. */
static float nearest(const crossings *c, const int bin[3], const float at[3], bool crease, float most,
                     float enough) {
    float least = most;
    for (int k = 0; k < 27 && least >= enough; k++) {
        const int number = ((bin[2] + k / 9 - 1) * BINS + bin[1] + k / 3 % 3 - 1) * BINS + bin[0] + k % 3 - 1;
        if (crease && !c->creases[number]) continue;
        for (uint32_t i = c->first[number]; i < c->first[number + 1]; i++) {
            const float *p = c->list[i].at, x = p[0] - at[0], y = p[1] - at[1], z = p[2] - at[2];
            const float square = x * x + y * y + z * z;
            if (c->list[i].crease == crease && square < least) least = square;
        }
    }
    return least;
}

static bool is_interface(const float *v) {
    const bool inside = *v < 0;
    return inside != (v[1] < 0) || inside != (v[-1] < 0) || inside != (v[STEP_Y] < 0) ||
           inside != (v[-STEP_Y] < 0) || inside != (v[STEP_Z] < 0) || inside != (v[-STEP_Z] < 0);
}

/* A voxel is in a fan when no crossing is nearer than one at a crease. */
static float mended(const crossings *c, const int bin[3], const int voxel[3], float band) {
    const float *v = c->window + (voxel[2] + 1) * STEP_Z + (voxel[1] + 1) * STEP_Y + voxel[0] + 1;
    const float distance = fabsf(*v), at[3] = {(float)voxel[0], (float)voxel[1], (float)voxel[2]};
    if (distance >= band || is_interface(v)) return *v;
    const float reach = (distance + SHORT) * (distance + SHORT);
    const float square = nearest(c, bin, at, true, reach, 0);
    if (square >= reach || nearest(c, bin, at, false, square, square) < square) return *v;
    const float far = sqrtf(square), near = sqrtf(fmaxf(square - HALF_GAP * HALF_GAP, 0));
    const float made = fminf(fminf(fmaxf(distance, near), far), fmaxf(distance, 0.999f * band));
    return *v < 0 ? -made : made;
}

static bool any_crease(const crossings *c, const int bin[3]) {
    bool any = false;
    for (int k = 0; k < 27; k++)
        any |= c->creases[((bin[2] + k / 9 - 1) * BINS + bin[1] + k / 3 % 3 - 1) * BINS + bin[0] + k % 3 - 1];
    return any;
}

static void mend_bin(const crossings *c, const int bin[3], float band, float *out) {
    for (int i = 0; i < BIN * BIN * BIN; i++) {
        const int voxel[3] = {BIN * bin[0] + i % BIN, BIN * bin[1] + i / BIN % BIN,
                              BIN * bin[2] + i / (BIN * BIN)};
        out[((voxel[2] - BIN) * ISO_BRICK + voxel[1] - BIN) * ISO_BRICK + voxel[0] - BIN] =
            mended(c, bin, voxel, band);
    }
}

iso_status iso_crease_mend(const float *window, float band, iso_buffer *room, float *out) {
    crossings c = {.window = window};
    enum { ROW = ISO_BRICK * sizeof(float), M = ISO_CREASE_MARGIN };
    for (int row = 0; row < ISO_BRICK * ISO_BRICK; row++)
        memcpy(out + row * ISO_BRICK,
               window + (row / ISO_BRICK + M) * STEP_Z + (row % ISO_BRICK + M) * STEP_Y + M, ROW);
    ISO_TRY(find_crossings(&c, room));
    for (int i = 0; i < 64 && c.list; i++) {
        const int bin[3] = {1 + i % 4, 1 + i / 4 % 4, 1 + i / 16};
        if (any_crease(&c, bin)) mend_bin(&c, bin, band, out);
    }
    return ISO_OK;
}
