/* refused_memory: wrappers of the allocation functions that fail after a number of calls. */
#include "refused_memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/memory.h"

static long calls_left = -1; /* -1: never refuse */
static long refusals;

void test_refuse_memory_after(long calls) {
    calls_left = calls;
    refusals = 0;
}

void test_grant_memory(void) {
    calls_left = -1;
}

long test_refusals(void) {
    return refusals;
}

long test_refuse_each(iso_status (*work)(const void *context, iso_error *error), const void *context,
                      iso_status *last) {
    for (long calls = 0;; calls++) {
        iso_error error = {0};
        test_refuse_memory_after(calls);
        const iso_status status = work(context, &error);
        const long refused = test_refusals();
        test_grant_memory();
        const bool good = refused ? status == ISO_ERR_NOMEM : last || status == ISO_OK;
        if (!good) fail_msg("call %ld: status %d: %s", calls, status, error.text);
        if (refused) continue;
        if (last) *last = status;
        return calls;
    }
}

static bool refuse(void) {
    if (calls_left < 0 || calls_left-- > 0) return false;
    calls_left = 0;
    refusals++;
    return true;
}

iso_status __real_iso_buffer_reserve(iso_buffer *buffer, size_t bytes, size_t keep, iso_error *error);
iso_status __wrap_iso_buffer_reserve(iso_buffer *buffer, size_t bytes, size_t keep, iso_error *error);
iso_status __wrap_iso_buffer_reserve(iso_buffer *buffer, size_t bytes, size_t keep, iso_error *error) {
    if (bytes && refuse()) return iso_fail(error, ISO_ERR_NOMEM, "refused");
    return __real_iso_buffer_reserve(buffer, bytes, keep, error);
}

void *__real_iso_alloc(size_t bytes);
void *__wrap_iso_alloc(size_t bytes);
void *__wrap_iso_alloc(size_t bytes) {
    return refuse() ? NULL : __real_iso_alloc(bytes);
}

void *__real_iso_alloc_zero(size_t count, size_t size);
void *__wrap_iso_alloc_zero(size_t count, size_t size);
void *__wrap_iso_alloc_zero(size_t count, size_t size) {
    return refuse() ? NULL : __real_iso_alloc_zero(count, size);
}
