/* simd: every operation against plain C, at every level that the machine has. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/kernel_units.h"
#include "check_support.h"
#include "test_simd_kernel.h"

static void fill(simd_inputs *in) {
    uint32_t seed = 7;
    static const float special[] = {0.0f, -0.0f, NAN, INFINITY, -INFINITY, 1.0f, -1.0f, 1e-40f};
    for (int i = 0; i < SIMD_ITEMS; i++) {
        in->a[i] = (float)(int32_t)random_word(&seed) * 1e-3f;
        in->b[i] = random_word(&seed) % 3 ? (float)(int32_t)random_word(&seed) * 1e-3f : in->a[i];
        if (random_word(&seed) % 4 == 0) in->a[i] = special[random_word(&seed) >> 16 & 7];
        if (random_word(&seed) % 4 == 0) in->b[i] = special[random_word(&seed) >> 16 & 7];
        in->small[i] = (float)((int32_t)random_word(&seed) >> 8) / 64;
        in->k[i] = (int32_t)random_word(&seed);
        in->l[i] = random_word(&seed) % 3 ? (int32_t)random_word(&seed) : in->k[i];
        in->u8[i] = (uint8_t)(random_word(&seed) >> 24);
        in->u16[i] = (uint16_t)(random_word(&seed) >> 16);
        in->i16[i] = (int16_t)(random_word(&seed) >> 16);
    }
}

static int32_t bits_of(float value) {
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void operate_plain(const simd_inputs *in, simd_results *out) {
    for (int i = 0; i < SIMD_ITEMS; i++) {
        float a = in->a[i], b = in->b[i];
        int32_t k = in->k[i], l = in->l[i];
        out->set[i] = in->a[0] + (float)in->k[0];
        out->u8[i] = in->u8[i];
        out->u16[i] = in->u16[i];
        out->i16[i] = in->i16[i];
        out->lanes[i] = i;
        out->bits[i] = bits_of(a);
        out->floats[i] = b;
        out->to_float[i] = (float)k;
        out->trunc[i] = (int32_t)in->small[i];
        out->floor[i] = (int32_t)floorf(in->small[i]);
        out->gather[i] = in->a[in->u8[i]];
        out->min[i] = a < b ? a : b;
        out->max[i] = a > b ? a : b;
        out->abs[i] = fabsf(a);
        out->sqrt[i] = sqrtf(fabsf(a));
        out->select[i] = a < b ? a : b;
        out->slides[i] = 4;
        out->selecti[i] = k < l ? k : l;
        const int truths[SIMD_TRUTHS] = {
            a < b, a <= b, a == b, k < l, k == l, a < b && k < l, a < b || k < l, a < b && !(k < l), a <= b};
        for (int t = 0; t < SIMD_TRUTHS; t++) out->truth[t][i] = (uint8_t)truths[t];
        for (int row = 0; row < 12; row++) out->gathered[row][i] = in->b[in->u8[i] + row];
        const float four[4] = {a, b, in->small[i], -a};
        memcpy(out->scattered[i], four, sizeof four);
        out->stored_u8[i] = (uint8_t)k;
        out->zipped[2 * i] = a;
        out->zipped[2 * i + 1] = b;
        out->even[i] = in->a[2 * i % SIMD_ITEMS];
        out->odd[i] = in->a[(2 * i + 1) % SIMD_ITEMS];
        if (!(a < b)) continue;
        out->packed[out->packed_count] = a;
        out->packedi[out->packed_count++] = k;
    }
}

/* The bits of sqrt's NaN may differ between machines' square roots; all else is compared as it is. */
static void check_level(iso_cpu_level level, operate_fn *operate) {
    if (iso_cpu_supported() < level) {
        print_message("no %s here: left out\n", iso_cpu_level_name(level));
        return;
    }
    simd_inputs *in = calloc(1, sizeof *in);
    simd_results *wanted = calloc(1, sizeof *wanted), *got = calloc(1, sizeof *got);
    assert_true(in && wanted && got);
    fill(in);
    operate_plain(in, wanted);
    operate(in, got);
    assert_int_equal(got->packed_count, wanted->packed_count);
    memset(got->packed + got->packed_count, 0,
           sizeof got->packed - sizeof(float) * (size_t)got->packed_count);
    memset(got->packedi + got->packed_count, 0,
           sizeof got->packedi - sizeof(int32_t) * (size_t)got->packed_count);
    for (int i = 0; i < SIMD_ITEMS; i++)
        if (isnan(wanted->sqrt[i]) && isnan(got->sqrt[i])) got->sqrt[i] = wanted->sqrt[i];
    assert_memory_equal(got, wanted, sizeof *got);
    free(in);
    free(wanted);
    free(got);
}

static void operations_equal_plain_c(void **state) {
    (void)state;
    for (int level = ISO_CPU_GENERIC; level < ISO_CPU_LEVELS; level++)
        check_level((iso_cpu_level)level, ISO_KERNEL_UNIT(operate, level));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(operations_equal_plain_c)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
