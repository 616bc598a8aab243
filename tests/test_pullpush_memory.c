/* Pull-push that runs out of memory says so and draws nothing wrong: calls for memory are refused from a
 * chosen one on (the linker's --wrap). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "render/pullpush.h"

static long calls_left = -1; /* -1: never refuse */
static long refused;

static bool refuse(void) {
    if (calls_left < 0 || calls_left-- > 0) return false;
    calls_left = 0;
    refused++;
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

enum { SIDE = 20, COUNT = SIDE * SIDE, SIZE = 70 };

static iso_status draw(iso_pullpush *workspace, iso_reconstruction reconstruction, bool colored,
                       iso_gbuffer *g) {
    iso_surfel surfels[COUNT];
    uint8_t colors[COUNT][3];
    for (int i = 0; i < COUNT; i++) {
        surfels[i] =
            (iso_surfel){{(float)(i % SIDE) - SIDE / 2, (float)(i / SIDE) - SIDE / 2, 10}, {0, 0, -1}};
        memset(colors[i], i, 3);
    }
    const iso_point_span span = {.count = COUNT};
    const iso_point_view points = {.surfels = surfels,
                                   .spans = &span,
                                   .span_count = 1,
                                   .colors = colored ? (const uint8_t(*)[3])colors : NULL,
                                   .transform = iso_transform_identity(),
                                   .radius = 0.8};
    const iso_view view = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                           .focal = 3,
                           .cx = SIZE / 2,
                           .cy = SIZE / 2,
                           .width = SIZE,
                           .height = SIZE,
                           .orthographic = true,
                           .near = -1e300};
    const iso_pullpush_opts opts = {reconstruction, workspace};
    const iso_target target = {&view, g, NULL, 0};
    return iso_draw_pullpush(&target, &points, &opts, NULL);
}

/* Refused once at each place in turn, with and without a workspace; then it draws what it always draws. */
static void refusals_are_reported(void **state) {
    (void)state;
    for (int k = 0; k < 12; k++) {
        bool colored = k % 2, kept = k / 2 % 2;
        iso_reconstruction reconstruction = (iso_reconstruction)(1 + k / 4);
        iso_pullpush *workspace = NULL;
        if (kept) assert_int_equal(iso_pullpush_create(&workspace, NULL), ISO_OK);
        iso_gbuffer wanted, got;
        assert_int_equal(iso_gbuffer_create(SIZE, SIZE, &wanted, NULL), ISO_OK);
        assert_int_equal(iso_gbuffer_create(SIZE, SIZE, &got, NULL), ISO_OK);
        iso_gbuffer_clear(&wanted);
        iso_gbuffer_clear(&got);
        assert_int_equal(draw(NULL, reconstruction, colored, &wanted), ISO_OK);
        long place = 0;
        for (;; place++) {
            refused = 0;
            calls_left = place;
            iso_status status = draw(workspace, reconstruction, colored, &got);
            calls_left = -1;
            if (!refused) {
                assert_int_equal(status, ISO_OK);
                break;
            }
            assert_int_equal(status, ISO_ERR_NOMEM);
        }
        assert_true(place > 2);
        assert_memory_equal(got.depth, wanted.depth, SIZE * SIZE * sizeof(float));
        assert_memory_equal(got.surface, wanted.surface, SIZE * SIZE);
        iso_gbuffer_free(&wanted);
        iso_gbuffer_free(&got);
        iso_pullpush_destroy(workspace);
    }
    calls_left = 0;
    iso_pullpush *workspace;
    assert_int_equal(iso_pullpush_create(&workspace, NULL), ISO_ERR_NOMEM);
    calls_left = -1;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
