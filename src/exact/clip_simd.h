/* clip_simd: cuts the chords of vectors of pairs by the bodies of scratch->cut, and gives their pieces that
 * are left. */
#ifndef ISO_EXACT_CLIP_SIMD_H
#define ISO_EXACT_CLIP_SIMD_H

#include "exact/chords_simd.h"
#include "exact/kernel_simd.h"

/* The pieces of chords that are left: from x = low[n] to high[n], in order; empty where not low < high. */
typedef struct ex_rest {
    int pieces;
    vf low[ISO_CLIP_PIECES], high[ISO_CLIP_PIECES];
} ex_rest;

/* The part of rays q + x * step in a body, low < x < high. */
typedef struct ex_passage {
    vf low, high;
} ex_passage;

ISO_INLINE ex_passage through_faces(const iso_exact_cut *cut, const vf q[3], const vf step[3]) {
    const vf zero = v_set(0);
    ex_passage p = {v_set(-2), v_set(2)};
    for (int i = 0; i < cut->faces; i++) {
        const float *f = cut->face[i];
        const vf at = f[3] + (f[0] * q[0] + f[1] * q[1] + f[2] * q[2]);
        const vf rise = f[0] * step[0] + f[1] * step[1] + f[2] * step[2];
        const vf slope = v_select(v_eq(rise, zero), v_set(1e-30f), rise);
        const vf x = v_min(v_max(-at / slope, v_set(-2)), v_set(2));
        const vm enters = v_lt(slope, zero);
        p.low = v_select(enters, v_max(p.low, x), p.low);
        p.high = v_select(enters, p.high, v_min(p.high, x));
    }
    return p;
}

ISO_INLINE ex_passage through_ball(const iso_exact_cut *cut, const vf q[3], const vf step[3]) {
    const float *l = cut->linear, *s = cut->square;
    const vf zero = v_set(0), least = v_set(1e-30f);
    const vf along[3] = {s[0] * step[0] + (s[3] * step[1] + s[5] * step[2]),
                         s[1] * step[1] + (s[3] * step[0] + s[4] * step[2]),
                         s[2] * step[2] + (s[5] * step[0] + s[4] * step[1])};
    const vf there[3] = {s[0] * q[0] + (s[3] * q[1] + s[5] * q[2]), s[1] * q[1] + (s[3] * q[0] + s[4] * q[2]),
                         s[2] * q[2] + (s[5] * q[0] + s[4] * q[1])};
    const vf a = v_max(step[0] * along[0] + (step[1] * along[1] + step[2] * along[2]), least);
    const vf b = 0.5f * (l[0] * step[0] + l[1] * step[1] + l[2] * step[2]) +
                 (q[0] * along[0] + q[1] * along[1] + q[2] * along[2]);
    const vf c =
        cut->constant + ((l[0] + there[0]) * q[0] + (l[1] + there[1]) * q[1] + (l[2] + there[2]) * q[2]);
    const vf square = b * b - a * c; /* a x^2 + 2 b x + c < 0 in the ball */
    const vf root = v_sqrt(v_max(square, zero));
    const vf sum = -(b + v_floats(v_bits(root) | (v_bits(b) & INT32_MIN)));
    const vf other = v_select(v_eq(sum, zero), zero, c / v_select(v_eq(sum, zero), least, sum)),
             one = sum / a;
    const vm misses = v_le(square, zero);
    return (ex_passage){v_select(misses, v_set(2), v_min(v_max(v_min(one, other), v_set(-2)), v_set(2))),
                        v_select(misses, v_set(-2), v_min(v_max(v_max(one, other), v_set(-2)), v_set(2)))};
}

/* Moves x out of what the bodies cut away; to 2 where nothing is left. */
ISO_INLINE vf skip_cut(const iso_exact_scratch *scratch, const ex_passage *p, vf x) {
    for (int round = 0; round < scratch->cuts; round++)
        for (int i = 0; i < scratch->cuts; i++) {
            if (scratch->cut[i].keeps) {
                const vm inside = v_and(v_lt(p[i].low, p[i].high), v_lt(x, p[i].high));
                x = v_select(inside, v_max(x, p[i].low), v_set(2));
            } else {
                const vm inside = v_and(v_le(p[i].low, x), v_lt(x, p[i].high));
                x = v_select(inside, p[i].high, x);
            }
        }
    return x;
}

/* Where the pieces that begin at x end. */
ISO_INLINE vf end_of_pieces(const iso_exact_scratch *scratch, const ex_passage *p, vf x) {
    vf end = v_set(1);
    for (int i = 0; i < scratch->cuts; i++) {
        const vm ahead = v_and(v_lt(p[i].low, p[i].high), v_lt(x, p[i].low));
        end = v_min(end, scratch->cut[i].keeps ? p[i].high : v_select(ahead, p[i].low, end));
    }
    return end;
}

/* Sets `rest`: what the bodies leave of the chords of the pairs from number `first` on. */
ISO_INLINE void cut_rays(const iso_exact_scratch *scratch, int first, ex_test_kind test_kind,
                         const ex_chord *chord, ex_rest *rest) {
    int32_t at[3][ISO_LANES];
    for (int lane = 0; lane < ISO_LANES; lane++) {
        const int cell = scratch->owner[test_kind.large ? 0 : first + lane] / RECORD_FLOATS,
                  position = scratch->position[cell];
        at[0][lane] = position & 7;
        at[1][lane] = position >> 3 & 7;
        at[2][lane] = position >> 6;
    }
    const float *shift = scratch->record[scratch->owner[0] / RECORD_FLOATS].shift;
    vf q[3], step[3];
    for (int k = 0; k < 3; k++) {
        const vf entry = test_kind.large ? chord->entry[k] + shift[k] : chord->entry[k];
        q[k] = (v_to_float(v_loadi(at[k])) - 3.5f) + 0.5f * entry;
        step[k] = 0.5f * chord->step[k];
    }
    ex_passage passages[ISO_CLIP_BODIES];
    for (int i = 0; i < scratch->cuts; i++)
        passages[i] = scratch->cut[i].faces ? through_faces(&scratch->cut[i], q, step)
                                            : through_ball(&scratch->cut[i], q, step);
    vf x = v_set(0);
    for (rest->pieces = 0; rest->pieces <= scratch->cuts; rest->pieces++) {
        x = skip_cut(scratch, passages, x);
        if (!v_mask(v_lt(x, v_set(1)))) break;
        rest->low[rest->pieces] = x;
        x = v_max(x, end_of_pieces(scratch, passages, x));
        rest->high[rest->pieces] = x;
    }
}

/* Sets `piece`, with its cubic, to the part low .. high of a chord (in the lanes where low < high), and
 * `ends` to the ties that are left at its ends. */
ISO_INLINE void cut_chord(const ex_cells *cells, const ex_chord *chord, const ex_ties *ties, vf low, vf high,
                          ex_chord *piece, ex_ties *ends) {
    const vf width = high - low;
    for (int k = 0; k < 3; k++) {
        piece->entry[k] = chord->entry[k] + low * chord->step[k];
        piece->step[k] = width * chord->step[k];
    }
    piece->depth = chord->depth + low * chord->length;
    piece->length = width * chord->length;
    piece->meets = v_and(chord->meets, v_lt(low, high));
    ends->entry = v_and(ties->entry, v_le(low, v_set(0)));
    ends->exit = v_and(ties->exit, v_le(v_set(1), high));
    ends->touching = ties->touching;
    set_cubic(cells->field, piece);
    apply_ties(ends, piece);
}

/* Copies the chords of the lanes `which`. */
ISO_INLINE void take_chord(vm which, const ex_chord *from, ex_chord *to) {
    for (int k = 0; k < 4; k++) to->f[k] = v_select(which, from->f[k], to->f[k]);
    for (int k = 0; k < 3; k++) {
        to->entry[k] = v_select(which, from->entry[k], to->entry[k]);
        to->step[k] = v_select(which, from->step[k], to->step[k]);
    }
    to->depth = v_select(which, from->depth, to->depth);
    to->length = v_select(which, from->length, to->length);
}

#endif
