/* Groups and splats that run out of memory say so and leak nothing: calls for memory are refused from a
 * chosen one on (the linker's --wrap). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "image/image.h"
#include "refused_memory.h"
#include "render/groups/disc_layers.h"
#include "scene_support.h"

enum { SIDE = 20, COUNT = SIDE * SIDE, SIZE = 70, WAYS = 5 };

/* The points that are drawn, and into what. */
typedef struct scene {
    iso_surfel surfels[COUNT];
    uint8_t colors[COUNT][3];
    iso_point_span span;
    iso_point_view points;
    iso_groups groups;
    iso_view view;
    iso_gbuffer gbuffer;
    iso_image image;
} scene;

static void make_scene(scene *s) {
    *s = (scene){.span = {.count = COUNT}, .view = test_plain_view(SIZE, SIZE, true, 3)};
    for (int i = 0; i < COUNT; i++) {
        const float x = (float)(i % SIDE) - SIDE / 2, y = (float)(i / SIDE) - SIDE / 2;
        s->surfels[i] = (iso_surfel){{x, y, 10}, {0, 0, -1}};
        memset(s->colors[i], i, 3);
    }
    s->points = (iso_point_view){.surfels = s->surfels,
                                 .spans = &s->span,
                                 .span_count = 1,
                                 .colors = (const uint8_t(*)[3])s->colors,
                                 .transform = iso_transform_identity(),
                                 .radius = 0.8};
    assert_int_equal(iso_groups_make(&s->points, &(iso_groups_opts){.limit = 4}, &s->groups, NULL), ISO_OK);
    assert_int_equal(iso_gbuffer_create(SIZE, SIZE, &s->gbuffer, NULL), ISO_OK);
    assert_int_equal(iso_image_create(SIZE, SIZE, &s->image, NULL), ISO_OK);
}

static iso_status draw_layers(scene *s, iso_transparency transparency) {
    const iso_splat_layer layer = {
        .points = s->points, .groups = &s->groups, .translucency = {.opacity = 0.5f}};
    const iso_rgb color = {0, 0, 0};
    const iso_shading shading = {.colors = &color, .color_count = 1};
    const iso_gbuffer size = {.width = SIZE, .height = SIZE};
    const iso_strip strip = {&s->view, &size, 1, 0};
    const iso_splat_layers picture = {.transparency = transparency,
                                      .layers = &layer,
                                      .count = 1,
                                      .picture = {&strip, &shading, &s->image, NULL, NULL, NULL}};
    iso_layer_totals totals = {0};
    return iso_shade_splat_layers(&picture, &totals, NULL);
}

/* What is drawn, in one of several ways: groups alone, opaque splats, and translucent ones. */
typedef struct drawing {
    scene *scene;
    int way;
} drawing;

static iso_status draw(const void *context, iso_error *error) {
    (void)error;
    const drawing *d = context;
    scene *s = d->scene;
    const int way = d->way;
    if (way >= 2) return draw_layers(s, (iso_transparency)(way - 2));
    if (way == 0) {
        iso_groups groups = {0};
        const iso_status status = iso_groups_make(&s->points, &(iso_groups_opts){0}, &groups, NULL);
        if (status == ISO_OK) iso_groups_free(&groups);
        return status;
    }
    iso_gbuffer_clear(&s->gbuffer);
    const iso_target target = {&s->view, &s->gbuffer, NULL, 0, NULL};
    return iso_draw_groups(&target, &s->points, NULL, NULL);
}

/* Refused at each place in turn; then it draws what it always draws. */
static void refusals_are_reported(void **state) {
    (void)state;
    static uint8_t wanted[4 * SIZE * SIZE];
    for (int way = 0; way < WAYS; way++) {
        scene s;
        make_scene(&s);
        const drawing d = {&s, way};
        assert_int_equal(draw(&d, NULL), ISO_OK);
        memcpy(wanted, s.image.rgba, sizeof wanted);
        assert_true(test_refuse_each(draw, &d, NULL) > 5);
        assert_memory_equal(wanted, s.image.rgba, sizeof wanted);
        iso_groups_free(&s.groups);
        iso_gbuffer_free(&s.gbuffer);
        iso_image_free(&s.image);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
