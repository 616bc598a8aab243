/* Pull-push that runs out of memory says so and draws nothing wrong: calls for memory are refused from a
 * chosen one on (the linker's --wrap). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "refused_memory.h"
#include "render/point_surface.h"
#include "scene_support.h"

enum { SIDE = 20, COUNT = SIDE * SIDE, SIZE = 70 };

static iso_status draw(iso_point_workspace *workspace, iso_reconstruction reconstruction, bool colored,
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
    const iso_view view = test_plain_view(SIZE, SIZE, true, 3);
    const iso_point_surface_opts opts = {.reconstruction = reconstruction, .workspace = workspace};
    const iso_target target = {&view, g, NULL, 0, NULL};
    return iso_draw_point_surface(&target, &points, &opts, NULL);
}

typedef struct drawing {
    iso_point_workspace *workspace;
    iso_reconstruction reconstruction;
    bool colored;
    iso_gbuffer *gbuffer;
} drawing;

static iso_status draw_it(const void *context, iso_error *error) {
    (void)error;
    const drawing *d = context;
    return draw(d->workspace, d->reconstruction, d->colored, d->gbuffer);
}

/* Refused once at each place in turn, with and without a workspace; then it draws what it always draws. */
static void refusals_are_reported(void **state) {
    (void)state;
    for (int k = 0; k < 12; k++) {
        bool colored = k % 2, kept = k / 2 % 2;
        iso_reconstruction reconstruction = (iso_reconstruction)(1 + k / 4);
        iso_point_workspace *workspace = NULL;
        if (kept) assert_int_equal(iso_point_workspace_create(&workspace, NULL), ISO_OK);
        iso_gbuffer wanted, got;
        assert_int_equal(iso_gbuffer_create(SIZE, SIZE, &wanted, NULL), ISO_OK);
        assert_int_equal(iso_gbuffer_create(SIZE, SIZE, &got, NULL), ISO_OK);
        iso_gbuffer_clear(&wanted);
        iso_gbuffer_clear(&got);
        assert_int_equal(draw(NULL, reconstruction, colored, &wanted), ISO_OK);
        const drawing d = {workspace, reconstruction, colored, &got};
        assert_true(test_refuse_each(draw_it, &d, NULL) > 2);
        assert_memory_equal(got.depth, wanted.depth, SIZE * SIZE * sizeof(float));
        assert_memory_equal(got.surface, wanted.surface, SIZE * SIZE);
        iso_gbuffer_free(&wanted);
        iso_gbuffer_free(&got);
        iso_point_workspace_destroy(workspace);
    }
    test_refuse_memory_after(0);
    iso_point_workspace *workspace;
    assert_int_equal(iso_point_workspace_create(&workspace, NULL), ISO_ERR_NOMEM);
    test_grant_memory();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
