/* chords_simd: the parts of rays that lie in cells, for vectors of pairs of a pixel and a cell, and the field
 * along them. */
#ifndef ISO_EXACT_CHORDS_SIMD_H
#define ISO_EXACT_CHORDS_SIMD_H

#include "exact/hits_simd.h"
#include "exact/kernel_simd.h"

/* The records (iso_exact_cell) of a vector of pairs. */
typedef struct ex_cells {
    vf field[8], place[2], scale, depth, half[3], eye[3], behind;
    vi flags;
} ex_cells;

/* Reads 4 * quads floats of the record of each pair: numbers[k] gets float k after `first`. offset: of the
 * pairs' records, in floats. same: all pairs are of one cell. */
ISO_INLINE void load_quads(const float *first, const int32_t *offset, bool same, int quads, vf *numbers) {
    if (same)
        for (int k = 0; k < 4 * quads; k++) numbers[k] = v_set(first[*offset + k]);
    else
        v_load4(first, offset, quads, numbers);
}

/* How a vector of pairs is tested. */
typedef struct ex_test_kind {
    bool same;    /* all pairs are of one cell */
    bool large;   /* the cell is large: rays are clipped to the box in which its surface lies */
    bool general; /* general test: ties, the near plane, or the eye next to the cell are possible */
} ex_test_kind;

/* Loads what the test needs of the records of the pairs from number `first` on. */
ISO_INLINE void load_cells(const iso_exact_scratch *scratch, int first, ex_test_kind test_kind,
                           ex_cells *cells) {
    const int32_t *owner = scratch->owner + (test_kind.large ? 0 : first);
    const iso_exact_cell *record = scratch->record;
    vf number[16];
    load_quads(record->field, owner, test_kind.same, test_kind.large ? 4 : 3, number);
    for (int k = 0; k < 8; k++) cells->field[k] = number[k];
    cells->place[0] = number[8];
    cells->place[1] = number[9];
    cells->scale = number[10];
    cells->depth = number[11];
    for (int k = 0; k < 3; k++)
        cells->half[k] = test_kind.large ? number[12 + k] : v_set(1 + ISO_EXACT_WIDER);
    if (!test_kind.general) return;
    load_quads(record->eye, owner, test_kind.same, 1, number);
    for (int k = 0; k < 3; k++) cells->eye[k] = number[k];
    cells->behind = number[3];
    int32_t flags[ISO_LANES];
    for (int lane = 0; lane < ISO_LANES; lane++)
        flags[lane] = scratch->flags[owner[test_kind.same ? 0 : lane] / RECORD_FLOATS];
    cells->flags = v_loadi(flags);
}

/* The parts of a vector of rays that lie in cells. With x from 0 to 1, the position is entry + x * step (u,
 * v, w), the depth is depth + x * length, and the field is f[0] + f[1] x + f[2] x^2 + f[3] x^3. */
typedef struct ex_chord {
    vf f[4], entry[3], step[3], depth, length;
    vm meets; /* the ray passes through the cell */
} ex_chord;

/* Ties of a vector of pairs. entry, exit: the ray enters or leaves the cell through a face all of whose
 * corners equal the isovalue, so that the field there counts as at or above it, whatever rounding makes of
 * its value. touching: the cell has the flag ISO_EXACT_TOUCHING. */
typedef struct ex_ties {
    vm entry, exit, touching;
} ex_ties;

/* The lanes whose ray enters (or leaves) the cell through a tie. at: the depth there; flags: of the cells;
 * faces[i]: the depth at which the ray passes the face on axis i, with the same sign as `at`; up[i]: this
 * face is the lower one on the axis. */
ISO_INLINE vm tied(vi flags, const vm up[3], const vf faces[3], vf at) {
    vm tied = v_lti(v_seti(1), v_seti(0));
    for (int i = 0; i < 3; i++) {
        const vm low = v_eqi(flags >> 2 * i & 1, v_seti(1)),
                 high = v_eqi(flags >> (2 * i + 1) & 1, v_seti(1));
        tied = v_or(tied, v_and(v_eq(faces[i], at), v_or(v_and(up[i], low), v_andnot(high, up[i]))));
    }
    return tied;
}

/* On each axis the ray meets the box's two faces at the depths -before and +after, in mm relative to the
 * reference point. */
typedef struct ex_faces {
    vf before[3], after[3];
} ex_faces;

/* Sets the depths at which rays meet the faces of boxes with the half extents `half` around the origin.
 * at: a ray's position at the reference point's depth; along: its direction per mm of depth. */
ISO_INLINE void meet_faces(const vf at[3], const vf along[3], const vf half[3], ex_faces *faces) {
    /* one division for the three inverses */
    const vf xy = along[0] * along[1], all = 1 / (xy * along[2]), z = all * along[2];
    const vf inverse[3] = {z * along[1], z * along[0], all * xy};
    for (int i = 0; i < 3; i++) {
        const vf middle = at[i] * inverse[i], reach = v_abs(inverse[i]) * half[i];
        faces->before[i] = middle + reach;
        faces->after[i] = reach - middle;
    }
}

/* Sets the chord to the part of a ray between the depths -enter and +leave, in mm relative to the reference
 * point, whose depth is `depth`. at: the ray's position there; along: its direction per mm of depth. */
ISO_INLINE void set_chord(const vf at[3], const vf along[3], vf enter, vf leave, vf depth, ex_chord *chord) {
    const vf length = enter + leave;
    chord->meets = v_lt(v_set(0), length);
    chord->depth = depth - enter;
    chord->length = length;
    for (int i = 0; i < 3; i++) {
        chord->entry[i] = at[i] - enter * along[i];
        chord->step[i] = along[i] * length;
    }
}

ISO_INLINE vf min_of_3(const vf number[3]) {
    return v_min(v_min(number[0], number[1]), number[2]);
}

/* Computes the chords of a vector of pairs, without their cubics. ties: NULL for the plain test. */
ISO_INLINE void make_chords(const iso_exact_projection *projection,
                            const iso_exact_octant_projection *octant_projection, vi pixel,
                            const ex_cells *cells, ex_chord *chord, ex_ties *ties) {
    const vi px = pixel & 0xffff, py = pixel >> 16;
    const vf x = v_to_float(px - octant_projection->origin[0]),
             y = v_to_float(py - octant_projection->origin[1]);
    const vf ex = (x - cells->place[0]) * cells->scale, ey = (y - cells->place[1]) * cells->scale;
    const vf sx = (x + octant_projection->off_axis[0]) * projection->per_focal,
             sy = (y + octant_projection->off_axis[1]) * projection->per_focal;
    vf at[3], along[3];
    for (int i = 0; i < 3; i++) {
        at[i] = ex * projection->ray[0][i] + ey * projection->ray[1][i];
        if (ties) at[i] += cells->eye[i];
        along[i] = projection->ray[2][i] + (sx * projection->ray[0][i] + sy * projection->ray[1][i]);
    }
    ex_faces faces;
    meet_faces(at, along, cells->half, &faces);
    vf enter = min_of_3(faces.before);
    const vf leave = min_of_3(faces.after);
    if (ties) enter = v_min(enter, cells->behind);
    set_chord(at, along, enter, leave, cells->depth, chord);
    if (!ties) return;
    const vm up[3] = {v_lt(v_set(0), along[0]), v_lt(v_set(0), along[1]), v_lt(v_set(0), along[2])};
    const vm down[3] = {v_le(along[0], v_set(0)), v_le(along[1], v_set(0)), v_le(along[2], v_set(0))};
    ties->touching = v_lti(v_seti(0), cells->flags & ISO_EXACT_TOUCHING);
    ties->entry = tied(cells->flags, up, faces.before, enter);
    ties->exit = tied(cells->flags, down, faces.after, leave);
}

/* Sets chord->f: the cubic polynomial that the trilinear field with the coefficients k is along the chord. */
ISO_INLINE void set_cubic(const vf k[8], ex_chord *chord) {
    const vf u = chord->entry[0], v = chord->entry[1], w = chord->entry[2];
    const vf du = chord->step[0], dv = chord->step[1], dw = chord->step[2];
    const vf uv0 = u * v, uv1 = u * dv + v * du, uv2 = du * dv;
    const vf low0 = ((k[1] * u + k[2] * v) + k[4] * uv0) + k[0], low1 = (k[1] * du + k[2] * dv) + k[4] * uv1,
             low2 = k[4] * uv2;
    const vf high0 = ((k[6] * u + k[5] * v) + k[7] * uv0) + k[3],
             high1 = (k[6] * du + k[5] * dv) + k[7] * uv1, high2 = k[7] * uv2;
    chord->f[0] = low0 + w * high0;
    chord->f[1] = low1 + (w * high1 + dw * high0);
    chord->f[2] = low2 + (w * high2 + dw * high1);
    chord->f[3] = dw * high2;
}

/* Makes the cubic exactly 0 at the ends of the chord that are in ties, where rounding can leave other values.
 * In a cell with no corner above the isovalue the field reaches the isovalue in ties only: the cubic of such
 * a cell is replaced by a straight line that is 0 there and negative elsewhere. */
ISO_INLINE void apply_ties(const ex_ties *ties, ex_chord *chord) {
    const vf zero = v_set(0), one = v_set(1);
    vf *f = chord->f;
    f[0] = v_select(ties->entry, zero, f[0]);
    const vf end = (f[0] + f[1]) + (f[2] + f[3]);
    f[3] = v_select(ties->exit, f[3] - end, f[3]);
    f[0] = v_select(ties->touching, v_select(ties->entry, zero, -one), f[0]);
    f[1] = v_select(ties->touching, v_select(ties->entry, -one, v_select(ties->exit, one, zero)), f[1]);
    for (int k = 2; k < 4; k++) f[k] = v_select(ties->touching, zero, f[k]);
    /* a ray that enters and leaves the cell through ties: its field falls just behind the entry and rises
     * just before the exit, and both are layers */
    if (ISO_EXACT_LAYERED) f[2] = v_select(v_and(ties->touching, v_and(ties->entry, ties->exit)), one, f[2]);
}

#endif
