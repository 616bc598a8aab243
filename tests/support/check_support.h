/* What tests of every module need: success, comparisons within a tolerance, and numbers that are random but
 * the same in every run. */
#ifndef ISO_TESTS_CHECK_SUPPORT_H
#define ISO_TESTS_CHECK_SUPPORT_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/status.h"

/* Fails with the error's text, unless all is well. */
static inline void test_ok(iso_status status, const iso_error *error) {
    if (status != ISO_OK) fail_msg("%s", error->text);
}

/* Fails unless `got` is within `tolerance` of `wanted`; a NaN is not. */
static inline void near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("got %.17g, wanted %.17g within %g", got, wanted, tolerance);
}

/* The next 32 bits of a generator whose state is the caller's; any start will do. The low ones repeat soon.
 */
static inline uint32_t random_word(uint32_t *state) {
    return *state = *state * 1664525u + 1013904223u;
}

/* The upper 24 of them. */
static inline uint32_t random_bits(uint32_t *state) {
    return random_word(state) >> 8;
}

/* From 0 up to 1, without 1. */
static inline double uniform(uint32_t *state) {
    return (double)random_bits(state) / (1 << 24);
}

/* The next 32 bits of a generator with a longer period. */
static inline uint32_t random_long(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 32);
}

/* 0 .. limit - 1, of the same generator. */
static inline uint32_t random_below(uint64_t *state, uint32_t limit) {
    return (random_long(state) >> 1) % limit;
}

#endif
