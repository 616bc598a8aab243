/* test_simd_kernel: every operation of base/simd.h, with the instructions of one level. */
#include "test_simd_kernel.h"

#include "base/simd.h"

static int same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

void ISO_KERNEL_NAME(operate)(const simd_inputs *in, simd_results *out) {
    for (int i = 0; i < SIMD_ITEMS; i += ISO_LANES) {
        vf a = v_load(in->a + i), b = v_load(in->b + i);
        vi k = v_loadi(in->k + i), l = v_loadi(in->l + i);
        v_store(out->set + i, v_set(in->a[0]) + v_to_float(v_seti(in->k[0])));
        v_storei(out->u8 + i, v_load_u8(in->u8 + i));
        v_storei(out->u16 + i, v_load_u16(in->u16 + i));
        v_storei(out->i16 + i, v_load_i16(in->i16 + i));
        v_storei(out->lanes + i, v_lanes() + v_seti(i));
        v_storei(out->bits + i, v_bits(a));
        v_store(out->floats + i, v_floats(v_bits(b)));
        v_store(out->to_float + i, v_to_float(k));
        v_storei(out->trunc + i, v_trunc(v_load(in->small + i)));
        v_storei(out->floor + i, v_floor(v_load(in->small + i)));
        v_store(out->gather + i, v_gather(in->a, v_load_u8(in->u8 + i)));
        v_store(out->min + i, v_min(a, b));
        v_store(out->max + i, v_max(a, b));
        v_store(out->abs + i, v_abs(a));
        v_store(out->sqrt + i, v_sqrt(v_abs(a)));
        v_store(out->select + i, v_select(v_lt(a, b), a, b));
        for (int lane = 0; lane < ISO_LANES; lane++) {
            float next1[ISO_LANES_MAX], next2[ISO_LANES_MAX], last1[ISO_LANES_MAX], last2[ISO_LANES_MAX];
            v_store(next1, v_next1(a, b));
            v_store(next2, v_next2(a, b));
            v_store(last1, v_last1(a, b));
            v_store(last2, v_last2(a, b));
            int at = i + lane; /* the plain results, from the same vectors */
            const float *row_b = in->b + i, *row_a = in->a + i;
#define ROW(k) ((k) < ISO_LANES ? row_a[k] : row_b[(k)-ISO_LANES])
            out->slides[at] = same_bits(next1[lane], ROW(lane + 1)) + same_bits(next2[lane], ROW(lane + 2)) +
                              same_bits(last1[lane], ROW(lane + ISO_LANES - 1)) +
                              same_bits(last2[lane], ROW(lane + ISO_LANES - 2));
#undef ROW
        }
        v_storei(out->selecti + i, v_selecti(v_lti(k, l), k, l));
        const vm truths[] = {v_lt(a, b),
                             v_le(a, b),
                             v_eq(a, b),
                             v_lti(k, l),
                             v_eqi(k, l),
                             v_and(v_lt(a, b), v_lti(k, l)),
                             v_or(v_lt(a, b), v_lti(k, l)),
                             v_andnot(v_lt(a, b), v_lti(k, l)),
                             v_from_mask(v_mask(v_le(a, b)))};
        for (int t = 0; t < SIMD_TRUTHS; t++)
            for (int lane = 0; lane < ISO_LANES; lane++)
                out->truth[t][i + lane] = (uint8_t)(v_mask(truths[t]) >> lane & 1);
        int32_t index[ISO_LANES];
        v_storei(index, v_load_u8(in->u8 + i));
        vf own[12];
        v_load4(in->b, index, 3, own);
        for (int row = 0; row < 12; row++) v_store(out->gathered[row] + i, own[row]);
        const vf mixed[4] = {a, b, v_load(in->small + i), -a};
        v_store4(out->scattered[i], 5, mixed);
        v_compress(out->packed + out->packed_count, truths[0], a);
        v_compressi(out->packedi + out->packed_count, truths[0], k);
        out->packed_count += __builtin_popcount(v_mask(truths[0]));
        v_store_u8(out->stored_u8 + i, k);
        v_store(out->zipped + 2 * i, v_zip_low(a, b));
        v_store(out->zipped + 2 * i + ISO_LANES, v_zip_high(a, b));
        const float *row = in->a + 2 * i % SIMD_ITEMS;
        v_store(out->even + i, v_even(v_load(row), v_load(row + ISO_LANES)));
        v_store(out->odd + i, v_odd(v_load(row), v_load(row + ISO_LANES)));
    }
}
