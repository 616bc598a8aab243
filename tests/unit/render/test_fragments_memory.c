/* Translucent glyphs, lines and triangles that run out of memory say so and leak nothing: calls for memory
 * are refused from a chosen one on (the linker's --wrap). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "exact/layers.h"
#include "image/image.h"
#include "refused_memory.h"
#include "render/raster/triangles.h"
#include "render/shapes/fragments.h"
#include "scene_support.h"

enum { COUNT = 60, SIZE = 70, WAYS = 3 };

/* What is drawn, and into what. */
typedef struct scene {
    iso_shapes *shapes[2];
    iso_triangle_spans spans;
    iso_view view;
    iso_image image;
} scene;

static float positions[COUNT][3];
static uint32_t triangles[COUNT / 3][3];
static size_t starts[2] = {0, COUNT};

static void make_scene(scene *s) {
    *s = (scene){.view = test_plain_view(SIZE, SIZE, true, 3)};
    for (int i = 0; i < COUNT; i++) {
        positions[i][0] = (float)(i * 7 % 20 - 10);
        positions[i][1] = (float)(i * 11 % 20 - 10);
        positions[i][2] = (float)(i * 13 % 20);
        triangles[i / 3][i % 3] = (uint32_t)i;
    }
    const iso_glyphs glyphs = {.positions = positions, .count = COUNT};
    const iso_lines lines = {.vertices = positions, .starts = starts, .vertex_count = COUNT, .line_count = 1};
    const iso_triangles mesh = {positions, triangles, COUNT, COUNT / 3, NULL};
    const iso_shapes_opts opts = {.glyph = ISO_GLYPH_SPHERE, .radius = 2};
    assert_int_equal(iso_shapes_from_glyphs(&glyphs, &opts, &s->shapes[0], NULL), ISO_OK);
    assert_int_equal(iso_shapes_from_lines(&lines, &opts, &s->shapes[1], NULL), ISO_OK);
    assert_int_equal(iso_triangle_spans_make(&mesh, &s->spans, NULL), ISO_OK);
    assert_int_equal(iso_image_create(SIZE, SIZE, &s->image, NULL), ISO_OK);
}

static void free_scene(scene *s) {
    for (int i = 0; i < 2; i++) iso_shapes_destroy(s->shapes[i]);
    iso_triangle_spans_free(&s->spans);
    iso_image_free(&s->image);
}

/* Draws in one of several ways: glyphs, lines or triangles. */
static iso_status draw(scene *s, int way) {
    const iso_translucent_set set = {.shapes = way < 2 ? s->shapes[way] : NULL,
                                     .mesh = iso_triangle_spans_view(&s->spans),
                                     .color = {200, 100, 50},
                                     .translucency = {.opacity = 0.3f}};
    const iso_rgb color = {0, 0, 0};
    const iso_shading shading = {.colors = &color, .color_count = 1};
    const iso_gbuffer size = {.width = SIZE, .height = SIZE};
    const iso_strip strip = {&s->view, &size, 1, 0};
    iso_shapes_lister *lister;
    ISO_TRY(iso_shapes_lister_create(&set, 1, 0, &strip, NULL, &lister, NULL));
    const iso_layer_source source = iso_shapes_lister_source(lister);
    const iso_exact_layers input = {.picture = {&strip, &shading, &s->image, NULL, NULL, NULL},
                                    .source = &source,
                                    .middle = iso_translucent_middle(&set, 1, &s->view)};
    iso_exact_layers_totals totals = {.retraced = 0};
    const iso_status status = iso_shade_exact_layers(&input, &totals, NULL);
    iso_shapes_lister_destroy(lister);
    return status;
}

/* Refused at each place in turn: the picture fails, or is what it always is, as a smaller part of a band may
 * find room where a larger one did not. */
static void refusals_are_reported(void **state) {
    (void)state;
    static uint8_t wanted[4 * SIZE * SIZE];
    for (int way = 0; way < WAYS; way++) {
        scene s;
        make_scene(&s);
        assert_int_equal(draw(&s, way), ISO_OK);
        memcpy(wanted, s.image.rgba, sizeof wanted);
        long place = 0, failures = 0;
        for (;; place++) {
            test_refuse_memory_after(place);
            const iso_status status = draw(&s, way);
            test_grant_memory();
            failures += status == ISO_ERR_NOMEM;
            if (status == ISO_ERR_NOMEM) continue;
            assert_int_equal(status, ISO_OK);
            assert_memory_equal(wanted, s.image.rgba, sizeof wanted);
            if (!test_refusals()) break;
        }
        assert_true(failures > 5);
        free_scene(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
