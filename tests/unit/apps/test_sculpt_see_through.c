/* isosculpt's pictures of volumes with translucent surfaces and with two isovalues: at rest they are those
 * that isorender draws, to the byte, whatever was drawn before. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "apps/isosculpt/render_command.h"
#include "apps/isosculpt/viewport/viewport.h"
#include "grids/rgrid.h"
#include "scene/layered_picture.h"
#include "sculpt_support.h"

enum { WIDTH = 187, HEIGHT = 140, SIDE = 60 };
static const double FIRST = 100, SECOND = 150;

/* A noisy ball, brightest in its middle. */
static iso_rgrid *make_volume(void) {
    iso_rgrid *grid;
    const iso_rgrid_desc desc = {.dims = {SIDE, SIDE - 7, SIDE + 9}, .type = ISO_UINT8};
    uint32_t seed = 5;
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    for (int z = 0; z < desc.dims[2]; z++)
        for (int y = 0; y < desc.dims[1]; y++)
            for (int x = 0; x < desc.dims[0]; x++) {
                const double u = x - 0.5 * desc.dims[0], v = y - 0.5 * desc.dims[1],
                             w = z - 0.5 * desc.dims[2];
                ((uint8_t *)grid->data)[x + y * grid->stride_y + z * grid->stride_z] =
                    (uint8_t)fmax(240 - 6 * sqrt(u * u + v * v + w * w) + 9 * uniform(&seed), 0);
            }
    return grid;
}

static void open_view(isosculpt_viewport *view, iso_rgrid *volume, iso_pool *pool) {
    const iso_grid grid = {.rgrid = volume};
    assert_int_equal(isosculpt_viewport_init_grid(view, &grid, FIRST, pool, NULL), ISO_OK);
}

static void draw(isosculpt_viewport *view, bool moving) {
    iso_error error = {0};
    if (isosculpt_viewport_draw(view, WIDTH, HEIGHT, moving, &error) != ISO_OK) fail_msg("%s", error.text);
}

static void refine(isosculpt_viewport *view) {
    while (view->quality != ISOSCULPT_QUALITY_FINE)
        assert_int_equal(isosculpt_viewport_refine(view, NULL), ISO_OK);
}

/* ---- what isorender draws */

typedef struct scene {
    iso_grid grid;
    iso_scene_surface parts[2];
    iso_layered_surface surfaces[2];
    iso_rgb colors[2];
    int count;
} scene;

static iso_status draw_scene(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const scene *s = context;
    for (int i = 0; i < s->count; i++) {
        const iso_target target = {view, gbuffer, NULL, (uint8_t)i, NULL};
        ISO_TRY(iso_draw_exact(&target, s->parts[i].exact, error));
    }
    return ISO_OK;
}

static void render(const isosculpt_viewport *view, scene *s, int samples, iso_image *image) {
    const iso_shading shading = {
        .colors = s->colors, .color_count = s->count, .background = view->mode.material.background};
    iso_layered_picture layered = {
        .method = ISO_METHOD_EXACT, .surfaces = s->surfaces, .count = s->count, .shading = &shading};
    iso_picture_layers callbacks;
    bool translucent = false;
    for (int i = 0; i < s->count; i++) translucent |= s->surfaces[i].translucency.opacity < 1;
    assert_int_equal(iso_layered_picture_callbacks(&layered, &callbacks, NULL), ISO_OK);
    const iso_picture_opts opts = {.camera = &view->camera,
                                   .width = WIDTH,
                                   .height = HEIGHT,
                                   .samples = samples,
                                   .shading = shading,
                                   .draw = draw_scene,
                                   .draw_context = s,
                                   .layers = translucent ? &callbacks : NULL};
    assert_int_equal(iso_picture_render(&opts, image, NULL, NULL), ISO_OK);
}

/* The picture at rest, and then the fine one, are isorender's. */
static void check_rest(isosculpt_viewport *view, iso_rgrid *volume) {
    const isosculpt_see_through *how = &view->see_through;
    const bool two = how->has_second && how->second_isovalue != view->isovalue && !view->opaque;
    scene s = {.grid = {.rgrid = volume},
               .colors = {view->mode.material.color, how->second_color},
               .count = two ? 2 : 1};
    iso_image image;
    for (int i = 0; i < s.count; i++) {
        s.parts[i] =
            (iso_scene_surface){.grid = s.grid, .isovalue = i ? how->second_isovalue : view->isovalue};
        s.surfaces[i].surface = &s.parts[i];
        s.surfaces[i].translucency.opacity =
            view->opaque ? 1 : (float)(i ? how->second_opacity : how->opacity);
        assert_int_equal(iso_scene_surface_prepare(&s.parts[i], ISO_PART_CELLS, NULL), ISO_OK);
    }
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
    draw(view, false);
    assert_int_equal(view->quality, ISOSCULPT_QUALITY_REST);
    render(view, &s, 1, &image);
    assert_memory_equal(view->image.rgba, image.rgba, 4 * WIDTH * HEIGHT);
    refine(view);
    render(view, &s, 4, &image);
    assert_memory_equal(view->image.rgba, image.rgba, 4 * WIDTH * HEIGHT);
    iso_image_free(&image);
    for (int i = 0; i < s.count; i++) iso_scene_surface_free(&s.parts[i]);
}

/* ---- tests */

static void pictures_are_those_of_isorender(void **state) {
    (void)state;
    static const double opacities[][2] = {{0.35, 1}, {1, 1}, {0.35, 0.5}, {1, 0.4}};
    iso_pool *pool;
    isosculpt_viewport view;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    iso_rgrid *volume = make_volume();
    open_view(&view, volume, pool);
    check_rest(&view, volume);
    for (int i = 0; i < 8; i++) {
        view.see_through = (isosculpt_see_through){.opacity = opacities[i / 2][0],
                                                   .has_second = i % 2,
                                                   .second_isovalue = SECOND - i,
                                                   .second_opacity = opacities[i / 2][1],
                                                   .second_color = {10, 200, 90}};
        isosculpt_viewport_orbit(&view, 10, 3);
        draw(&view, true);
        check_rest(&view, volume);
    }
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
    iso_pool_destroy(pool);
}

/* Opacity 1 is the opaque picture; so is that of a surface that is becoming a field, and of a second isovalue
 * that equals the first. Whatever is chosen for fields and other methods, only see-through pictures change.
 */
static void opaque_pictures_stay(void **state) {
    (void)state;
    isosculpt_viewport view;
    iso_rgrid *volume = make_volume();
    iso_image before;
    open_view(&view, volume, NULL);
    draw(&view, false);
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &before, NULL), ISO_OK);
    memcpy(before.rgba, view.image.rgba, 4 * WIDTH * HEIGHT);
    view.see_through.opacity = 0.5;
    assert_true(isosculpt_viewport_is_see_through(&view));
    draw(&view, false);
    assert_memory_not_equal(view.image.rgba, before.rgba, 4 * WIDTH * HEIGHT);
    view.opaque = true;
    draw(&view, false);
    assert_memory_equal(view.image.rgba, before.rgba, 4 * WIDTH * HEIGHT);
    view.opaque = false;
    view.see_through.opacity = 1;
    view.see_through.has_second = true;
    view.see_through.second_isovalue = FIRST;
    assert_false(isosculpt_viewport_is_see_through(&view));
    draw(&view, false);
    assert_memory_equal(view.image.rgba, before.rgba, 4 * WIDTH * HEIGHT);
    iso_image_free(&before);
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
}

/* What is picked is the surface in front, as if it were opaque. */
static void translucent_surfaces_can_be_picked(void **state) {
    (void)state;
    isosculpt_viewport view;
    isosculpt_pick opaque, translucent;
    iso_rgrid *volume = make_volume();
    open_view(&view, volume, NULL);
    draw(&view, false);
    assert_true(isosculpt_pick_buffer_pick(&view.drawn, WIDTH / 2.0, HEIGHT / 2.0, &opaque));
    view.see_through.opacity = 0.3;
    view.see_through.has_second = true;
    view.see_through.second_isovalue = SECOND;
    draw(&view, false);
    assert_true(isosculpt_pick_buffer_pick(&view.drawn, WIDTH / 2.0, HEIGHT / 2.0, &translucent));
    assert_memory_equal(&opaque, &translucent, sizeof opaque);
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
}

/* While an isovalue is dragged the front layers are drawn; both surfaces are then made in the background. */
static void both_isovalues_are_dragged(void **state) {
    (void)state;
    isosculpt_viewport view;
    iso_image dragged;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    iso_rgrid *volume = make_volume();
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &dragged, NULL), ISO_OK);
    open_view(&view, volume, pool);
    view.see_through.opacity = 0.4;
    view.see_through.has_second = true;
    for (int step = 0; step < 6; step++) {
        view.sliding = true;
        view.see_through.second_isovalue = SECOND + step;
        if (step > 2) isosculpt_viewport_set_isovalue(&view, FIRST + step);
        view.moving_factor = 1;
        draw(&view, true);
        assert_int_equal(view.quality, ISOSCULPT_QUALITY_MOVING);
        memcpy(dragged.rgba, view.image.rgba, 4 * WIDTH * HEIGHT);
        view.sliding = false;
        assert_false(isosculpt_viewport_is_ready(&view));
        assert_int_equal(isosculpt_viewport_prepare(&view, NULL, NULL), ISO_OK);
        while (isosculpt_viewport_is_preparing(&view)) usleep(1000);
        assert_true(isosculpt_viewport_is_ready(&view));
        check_rest(&view, volume);
        double difference = 0; /* the dragged picture is much like the one at rest, but has fewer layers */
        for (size_t i = 0; i < 4 * WIDTH * HEIGHT; i++)
            difference += fabs((double)dragged.rgba[i] - view.image.rgba[i]) / (4 * WIDTH * HEIGHT);
        assert_true(difference < 2);
    }
    iso_image_free(&dragged);
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
    iso_pool_destroy(pool);
}

static void command_has_isovalues_opacities_and_colors(void **state) {
    (void)state;
    char text[1000];
    isosculpt_viewport view;
    iso_rgrid *volume = make_volume();
    open_view(&view, volume, NULL);
    const isosculpt_render_command command = {
        .path = "a.nrrd", .reading = "", .viewport = &view, .width = 8, .height = 6};
    view.mode.method = ISO_METHOD_MESH;
    view.see_through.opacity = 0.25;
    assert_true(isosculpt_render_command_text(&command, text, sizeof text));
    assert_non_null(strstr(text, " --isovalue=100 --opacity=0.25 --method=exact "));
    view.see_through.has_second = true;
    view.see_through.second_isovalue = 150.5;
    view.see_through.second_color = (iso_rgb){1, 2, 3};
    assert_true(isosculpt_render_command_text(&command, text, sizeof text));
    assert_non_null(strstr(text, " --isovalue=100,150.5 --opacity=0.25,1 --method=exact "));
    assert_non_null(strstr(text, " --color=CE8E70,010203 "));
    view.see_through.opacity = 1;
    assert_true(isosculpt_render_command_text(&command, text, sizeof text));
    assert_non_null(strstr(text, " --isovalue=100,150.5 --method=exact "));
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_those_of_isorender),
        cmocka_unit_test(opaque_pictures_stay),
        cmocka_unit_test(translucent_surfaces_can_be_picked),
        cmocka_unit_test(both_isovalues_are_dragged),
        cmocka_unit_test(command_has_isovalues_opacities_and_colors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
