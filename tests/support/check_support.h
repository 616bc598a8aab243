/* check_support: shared by the tests of all modules: checks of a status, comparisons within a tolerance, and
 * pseudo-random numbers that are the same in every run. */
#ifndef ISO_TESTS_CHECK_SUPPORT_H
#define ISO_TESTS_CHECK_SUPPORT_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/status.h"

#ifdef __SANITIZE_ADDRESS__ /* gcc; clang has a feature */
#define ADDRESS_SANITIZER
#elif defined __has_feature
#if __has_feature(address_sanitizer)
#define ADDRESS_SANITIZER
#endif
#endif

/* Fails the test with the error's text unless status is ISO_OK. */
static inline void test_ok(iso_status status, const iso_error *error) {
    if (status != ISO_OK) fail_msg("%s", error->text);
}

/* Fails the test unless `got` is within `tolerance` of `wanted`; NaN never is. */
static inline void near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("got %.17g, wanted %.17g within %g", got, wanted, tolerance);
}

/* The next 32 bits of a generator whose state is the caller's; it may start with any value. The low bits have
 * a short period. */
static inline uint32_t random_word(uint32_t *state) {
    return *state = *state * 1664525u + 1013904223u;
}

/* The upper 24 bits of random_word. */
static inline uint32_t random_bits(uint32_t *state) {
    return random_word(state) >> 8;
}

/* A random number in [0, 1). */
static inline double uniform(uint32_t *state) {
    return (double)random_bits(state) / (1 << 24);
}

/* The next 32 bits of a generator with a longer period. */
static inline uint32_t random_long(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 32);
}

/* A random number 0 .. limit - 1 from the generator of random_long. */
static inline uint32_t random_below(uint64_t *state, uint32_t limit) {
    return (random_long(state) >> 1) % limit;
}

#endif
