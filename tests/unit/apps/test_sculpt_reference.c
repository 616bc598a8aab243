/* isosculpt's reference: the field's first surface, translucent over the sculpture or in front of it, or
 * lines and glyphs. However it came about, a picture with it is the picture drawn from scratch, to the byte;
 * its layers are those of exact, its lines and glyphs those of render/shapes; and picks do not know it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "apps/isosculpt/viewport/layer_store.h"
#include "apps/isosculpt/viewport/reference.h"
#include "base/memory.h"
#include "exact/layers.h"
#include "refused_memory.h"
#include "sculpt/session/session.h"
#include "sculpt_support.h"
#include "viewport_support.h"

enum { WIDTH = VIEWPORT_WIDTH, HEIGHT = VIEWPORT_HEIGHT, PIXELS = VIEWPORT_PIXELS };

/* A copy of an array, as the library allocates it. */
static void *copied(const void *from, size_t bytes) {
    void *copy = iso_alloc(bytes);
    memcpy(copy, from, bytes);
    return copy;
}

/* A line through the ball and out of it, and glyphs with colours before, in and behind it. */
static void make_shapes(isosculpt_reference_shapes sets[2]) {
    static const float vertices[4][3] = {{-25, -5, 3}, {0, -20, 8}, {0, 3, 0}, {22, 4, -9}},
                       positions[4][3] = {{-6, -17, -9}, {6, -14, -7}, {10, 19, 12}, {16, 0, 14}},
                       radii[4] = {3, 2, 4, 5};
    static const size_t starts[2] = {0, 4};
    static const uint8_t colors[4][3] = {{255, 30, 20}, {20, 200, 40}, {240, 220, 10}, {90, 90, 255}};
    const iso_shapes_opts tubes = {.radius = 1.5, .min_pixels = 1}, spheres = {.glyph = ISO_GLYPH_SPHERE};
    memset(sets, 0, 2 * sizeof *sets);
    sets[0].file.lines = (iso_lines){.vertices = copied(vertices, sizeof vertices),
                                     .starts = copied(starts, sizeof starts),
                                     .vertex_count = 4,
                                     .line_count = 1};
    sets[1].file.glyphs = (iso_glyphs){.positions = copied(positions, sizeof positions),
                                       .radii = copied(radii, sizeof radii),
                                       .colors = copied(colors, sizeof colors),
                                       .count = 4};
    assert_int_equal(iso_shapes_from_lines(&sets[0].file.lines, &tubes, &sets[0].shapes, NULL), ISO_OK);
    assert_int_equal(iso_shapes_from_glyphs(&sets[1].file.glyphs, &spheres, &sets[1].shapes, NULL), ISO_OK);
}

static bool with_shapes; /* the reference is lines and glyphs */

static void add_reference(isosculpt_viewport *view) {
    iso_hgrid *grid;
    isosculpt_reference *reference;
    isosculpt_reference_shapes sets[2];
    if (with_shapes) {
        make_shapes(sets);
        assert_int_equal(isosculpt_reference_create_shapes(sets, 2, &reference, NULL), ISO_OK);
        isosculpt_viewport_set_reference(view, reference);
        return;
    }
    assert_int_equal(iso_session_solid(&VIEWPORT_START, &grid, NULL), ISO_OK);
    assert_int_equal(isosculpt_reference_create(grid, 2, &reference, NULL), ISO_OK);
    isosculpt_viewport_set_reference(view, reference);
}

static void open_view(isosculpt_viewport *view, iso_session *session, iso_pool *pool) {
    assert_int_equal(isosculpt_viewport_init(view, iso_session_grid(session), pool, NULL), ISO_OK);
    view->width = WIDTH;
    view->height = HEIGHT;
    isosculpt_viewport_set_direction(view, ISO_FRONT);
}

static void show(isosculpt_viewport *view, bool over, double opacity) {
    view->reference_mode.shown = true;
    view->reference_mode.over = over;
    view->reference_mode.opacity = opacity;
}

/* A new viewport draws the same picture; one without the reference has the same samples to pick from. */
static void assert_as_new(isosculpt_viewport *view, iso_session *session, iso_pool *pool, bool fine) {
    isosculpt_viewport fresh, plain;
    open_view(&fresh, session, pool);
    open_view(&plain, session, pool);
    add_reference(&fresh);
    fresh.camera = plain.camera = view->camera;
    fresh.reference_mode = view->reference_mode;
    viewport_draw(&fresh, false);
    viewport_draw(&plain, false);
    if (fine) viewport_refine(&fresh);
    assert_int_equal(view->quality, fresh.quality);
    assert_memory_equal(view->image.rgba, fresh.image.rgba, 4 * PIXELS);
    if (view->reference_mode.over) assert_memory_not_equal(view->image.rgba, plain.image.rgba, 4 * PIXELS);
    viewport_same_samples(view, &plain);
    isosculpt_viewport_free(&fresh);
    isosculpt_viewport_free(&plain);
}

static size_t stroke(iso_session *session, isosculpt_viewport *view, uint32_t *seed) {
    const iso_brush brush = {.tool = uniform(seed) < 0.5 ? ISO_TOOL_CARVE : ISO_TOOL_ADD,
                             .radius = 1 + 3 * uniform(seed),
                             .strength = 0.5};
    return viewport_stroke(view, session, &brush, seed);
}

static void strokes_leave_the_picture_drawn_from_scratch(void **state) {
    (void)state;
    iso_pool *pool;
    isosculpt_viewport view;
    uint32_t seed = 7;
    size_t drawn = 0;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    iso_session *session = viewport_session(pool);
    open_view(&view, session, pool);
    add_reference(&view);
    show(&view, false, 0.4);
    for (int i = 0; i < 24; i++) {
        if (i % 6 == 0) { /* another camera; for its first stroke there are only few layers */
            isosculpt_viewport_orbit(&view, 20, 5);
            isosculpt_viewport_zoom(&view, 1.2);
            view.moving_factor = 2;
            viewport_draw(&view, true);
            assert_int_equal(view.quality, ISOSCULPT_QUALITY_MOVING);
            stroke(session, &view, &seed);
            assert_int_equal(view.quality, ISOSCULPT_QUALITY_MOVING);
            viewport_draw(&view, false);
        } else
            drawn += stroke(session, &view, &seed);
        assert_int_equal(view.quality, ISOSCULPT_QUALITY_REST);
        const bool fine = i % 3 == 1; /* all but the stroke was refined before */
        if (fine) viewport_refine(&view);
        assert_as_new(&view, session, pool, fine);
        show(&view, i % 2, 0.2 + 0.03 * i);
        viewport_draw(&view, true); /* its layers are there: this is the picture at rest */
        assert_as_new(&view, session, pool, false);
        if (i % 3) continue;
        viewport_refine(&view);
        assert_as_new(&view, session, pool, true);
        assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
        viewport_draw(&view, true);
        viewport_refine(&view);
        if (i) assert_as_new(&view, session, pool, true);
    }
    print_message("of the pictures %.1f %% was drawn again\n", 100.0 * (double)drawn / (60.0 * PIXELS));
    assert_true(drawn < 60 * PIXELS / 4);
    isosculpt_viewport_free(&view);
    iso_session_destroy(session);
    iso_pool_destroy(pool);
}

static void strokes_leave_the_picture_with_shapes(void **state) {
    with_shapes = true;
    strokes_leave_the_picture_drawn_from_scratch(state);
    with_shapes = false;
}

/* What a sample shows of the shapes, alone: its depth, INFINITY without, and its colour. */
typedef struct shapes_picture {
    iso_gbuffer gbuffer;
    iso_image image;
} shapes_picture;

static shapes_picture draw_shapes(const isosculpt_viewport *view) {
    isosculpt_reference_shapes sets[2];
    shapes_picture p;
    make_shapes(sets);
    assert_int_equal(iso_gbuffer_create(WIDTH, HEIGHT, &p.gbuffer, NULL), ISO_OK);
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &p.image, NULL), ISO_OK);
    iso_gbuffer_clear(&p.gbuffer);
    for (int i = 0; i < 2; i++) {
        const iso_target target = {&view->drawn.view, &p.gbuffer, NULL, (uint8_t)i, NULL};
        assert_int_equal(iso_draw_shapes(&target, sets[i].shapes, NULL, NULL), ISO_OK);
        isosculpt_reference_shapes_free(&sets[i]);
    }
    const iso_strip strip = {&view->drawn.view, &p.gbuffer, 1, 0};
    const iso_shading shading = {.colors = &view->reference_mode.color, .color_count = 1};
    iso_shade(&shading, &strip, &p.image, NULL);
    return p;
}

/* In front of the sculpture shapes are opaque; behind it they are hidden, or seen through it. */
static void shapes_are_drawn_by_depth(void **state) {
    (void)state;
    isosculpt_viewport view, plain;
    iso_session *session = viewport_session(NULL);
    int in_front = 0, behind = 0;
    with_shapes = true;
    open_view(&view, session, NULL);
    open_view(&plain, session, NULL);
    add_reference(&view);
    for (int i = 0; i < 4; i++) {
        const double opacity = i < 2 ? 0.35 : 0.8;
        show(&view, i % 2, opacity);
        isosculpt_viewport_orbit(&view, 40, 9);
        plain.camera = view.camera;
        viewport_draw(&view, false);
        viewport_draw(&plain, false);
        shapes_picture alone = draw_shapes(&view);
        for (size_t at = 0; at < PIXELS; at++) {
            const bool shown = alone.gbuffer.surface[at] != ISO_SURFACE_NONE,
                       hidden = !(alone.gbuffer.depth[at] < plain.drawn.gbuffer.depth[at]);
            const double share = !shown ? 0 : !hidden ? 1 : i % 2 ? opacity : 0;
            in_front += share == 1;
            behind += shown && hidden;
            for (size_t k = 0; k < 3; k++) {
                const double wanted =
                    share * alone.image.rgba[4 * at + k] + (1 - share) * plain.image.rgba[4 * at + k];
                assert_true(fabs(view.image.rgba[4 * at + k] - wanted) < 1.6);
            }
        }
        iso_gbuffer_free(&alone.gbuffer);
        iso_image_free(&alone.image);
    }
    assert_true(in_front > 4000 && behind > 1000);
    with_shapes = false;
    isosculpt_viewport_free(&view);
    isosculpt_viewport_free(&plain);
    iso_session_destroy(session);
}

/* Where nothing was changed, nothing lies in front of the sculpture. */
static void what_is_unchanged_looks_unchanged(void **state) {
    (void)state;
    isosculpt_viewport view, plain;
    iso_session *session = viewport_session(NULL);
    open_view(&view, session, NULL);
    open_view(&plain, session, NULL);
    add_reference(&view);
    show(&view, false, 0.5);
    for (int i = 0; i < 5; i++) {
        isosculpt_viewport_orbit(&view, 31, 7);
        isosculpt_viewport_zoom(&view, i % 2 ? 0.3 : 2);
        plain.camera = view.camera;
        viewport_draw(&view, false);
        viewport_draw(&plain, false);
        assert_memory_equal(view.image.rgba, plain.image.rgba, 4 * PIXELS);
    }
    view.reference_mode.over = true;
    viewport_draw(&view, false);
    assert_memory_not_equal(view.image.rgba, plain.image.rgba, 4 * PIXELS);
    view.reference_mode.shown = false;
    viewport_draw(&view, false);
    assert_memory_equal(view.image.rgba, plain.image.rgba, 4 * PIXELS);
    isosculpt_viewport_free(&view);
    isosculpt_viewport_free(&plain);
    iso_session_destroy(session);
}

/* What iso_shade_exact_layers draws of the reference over what is in `strip`'s gbuffer. */
static void draw_layers(const isosculpt_viewport *view, const iso_exact *exact, const iso_gbuffer *gbuffer,
                        iso_image *image) {
    const iso_rgb colors[] = {view->mode.material.color};
    const iso_strip strip = {.view = &view->drawn.view, .gbuffer = gbuffer, .factor = 1};
    const iso_shading shading = {
        .colors = colors, .color_count = 1, .background = view->mode.material.background};
    const iso_exact_layer layer = {
        exact, view->reference_mode.color, {.opacity = (float)view->reference_mode.opacity}, NULL, NULL};
    const iso_exact_layers layers = {
        .layers = &layer, .count = 1, .picture = {.strip = &strip, .shading = &shading, .image = image}};
    iso_exact_layers_totals totals = {.retraced = 0};
    assert_int_equal(iso_shade_exact_layers(&layers, &totals, NULL), ISO_OK);
}

static int largest_difference(const uint8_t *a, const uint8_t *b) {
    int most = 0;
    for (size_t i = 0; i < 4 * PIXELS; i++) most = abs(a[i] - b[i]) > most ? abs(a[i] - b[i]) : most;
    return most;
}

/* The sculpture is a smaller ball, so that all layers lie clearly in front of it or behind it. */
static void layers_are_those_of_exact(void **state) {
    (void)state;
    static const double opacities[] = {0.05, 0.35, 0.7, 0.95};
    isosculpt_viewport view;
    iso_journal_start small = VIEWPORT_START;
    iso_hgrid *ball, *start;
    iso_exact *exact;
    iso_image image;
    const iso_exact_opts opts = {.isovalue = 0};
    small.radius = 9;
    assert_int_equal(iso_session_solid(&small, &ball, NULL), ISO_OK);
    assert_int_equal(iso_session_solid(&VIEWPORT_START, &start, NULL), ISO_OK);
    const iso_grid grid = {.hgrid = start};
    assert_int_equal(iso_exact_create(&grid, &opts, &exact, NULL), ISO_OK);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_OK);
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_init(&view, ball, NULL, NULL), ISO_OK);
    add_reference(&view);
    for (int i = 0; i < 4; i++) {
        show(&view, false, opacities[i]);
        isosculpt_viewport_orbit(&view, 17, 3);
        viewport_draw(&view, false);
        draw_layers(&view, exact, &view.drawn.gbuffer, &image);
        assert_true(largest_difference(view.image.rgba, image.rgba) <= (opacities[i] < 0.1 ? 2 : 1));
    }
    show(&view, true, 1); /* as if the reference were drawn alone, opaque */
    viewport_draw(&view, false);
    const iso_target target = {.view = &view.drawn.view, .gbuffer = &view.tile};
    if (view.tile.samples < PIXELS) {
        iso_gbuffer_free(&view.tile);
        assert_int_equal(iso_gbuffer_create(WIDTH, HEIGHT, &view.tile, NULL), ISO_OK);
    }
    view.tile.width = WIDTH;
    view.tile.height = HEIGHT;
    iso_gbuffer_clear(&view.tile);
    assert_int_equal(iso_draw_exact(&target, exact, NULL), ISO_OK);
    const iso_strip strip = {.view = &view.drawn.view, .gbuffer = &view.tile, .factor = 1};
    const iso_shading shading = {
        .colors = &view.reference_mode.color, .color_count = 1, .background = view.mode.material.background};
    iso_shade(&shading, &strip, &image, NULL);
    assert_true(largest_difference(view.image.rgba, image.rgba) <= 1);
    iso_image_free(&image);
    isosculpt_viewport_free(&view);
    iso_exact_destroy(exact);
    iso_hgrid_destroy(start);
    iso_hgrid_destroy(ball);
}

/* The front layers of a surface are the first of all its layers. Returns the bits of places where the colour
 * is mostly red, and mostly blue. */
static unsigned compare_fronts(const isosculpt_layer_surface *surface, iso_camera camera) {
    isosculpt_layer_store all = {.most_bytes = SIZE_MAX}, front = {.most_bytes = SIZE_MAX};
    unsigned seen = 0;
    for (int i = 0; i < 2; i++) {
        camera.orthographic = i;
        camera.parallel_scale = 18;
        const iso_view view = iso_view_make(&camera, WIDTH, HEIGHT);
        assert_int_equal(isosculpt_layer_store_list(&all, surface, &view, NULL, NULL), ISO_OK);
        assert_int_equal(isosculpt_layer_store_list_front(&front, surface, &view, NULL, NULL), ISO_OK);
        size_t layers = 0, differ = 0;
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const uint32_t begin = x ? all.rows[y].ends[x - 1] : 0,
                               begin_front = x ? front.rows[y].ends[x - 1] : 0,
                               count = front.rows[y].ends[x] - begin_front;
                assert_int_equal(count, all.rows[y].ends[x] > begin);
                if (!count) continue;
                const isosculpt_stored_layer *a = &all.rows[y].layers[begin],
                                             *b = &front.rows[y].layers[begin_front];
                layers++;
                differ += fabsf(a->depth - b->depth) > 1e-3f || abs(a->slant - b->slant) > 1 ||
                          abs(a->color[1] - b->color[1]) > 64 || abs(a->color[2] - b->color[2]) > 64;
                seen |= b->color[0] > 2 * b->color[2] ? 1 : b->color[2] > 2 * b->color[0] ? 2 : 0;
            }
        assert_true(layers > PIXELS / 10);
        assert_int_equal(differ, 0);
    }
    isosculpt_layer_store_free(&all);
    isosculpt_layer_store_free(&front);
    return seen;
}

static void front_layers_are_the_first_ones(void **state) {
    (void)state;
    iso_hgrid *ball;
    iso_exact *exact;
    const iso_camera camera = {.position = {3, -60, 9}, .view_up = {0, 0, 1}, .view_angle = 40};
    const iso_exact_opts opts = {.isovalue = 0};
    assert_int_equal(iso_session_solid(&VIEWPORT_START, &ball, NULL), ISO_OK);
    const iso_grid grid = {.hgrid = ball};
    assert_int_equal(iso_exact_create(&grid, &opts, &exact, NULL), ISO_OK);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_OK);
    assert_int_equal(compare_fronts(&(isosculpt_layer_surface){exact, {10, 200, 120}, NULL}, camera), 2);
    iso_exact_destroy(exact);
    iso_hgrid_destroy(ball);
}

/* The same of a ball of two labels, red and blue, side by side. */
static void layers_have_the_colors_of_labels(void **state) {
    (void)state;
    enum { SIDE = 32 };
    static uint16_t numbers[SIDE * SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int x = i % SIDE - 15, y = i / SIDE % SIDE - 15, z = i / SIDE / SIDE - 15;
        numbers[i] = (uint16_t)(x * x + y * y + z * z < 144 ? x < 0 ? 1 : 2 : 0);
    }
    iso_label list[3] = {{.value = 0}, {.value = 4}, {.value = 9}};
    const iso_labels labels = {.dims = {SIDE, SIDE, SIDE},
                               .transform = iso_transform_identity(),
                               .number = numbers,
                               .label = list,
                               .count = 3};
    const iso_rgb rgb[3] = {{0, 255, 0}, {250, 20, 20}, {20, 20, 250}};
    iso_label_fields *fields;
    iso_exact *exact;
    assert_int_equal(iso_label_fields_make(&labels, (const uint8_t[]){0, 1, 1}, 1,
                                           ISO_LABELS_DRAWN + ISO_LABELS_APART, NULL, &fields, NULL),
                     ISO_OK);
    const iso_grid grid = {.hgrid = iso_label_fields_grid(fields, 1)};
    const iso_label_colors colors = {fields, list, 1, rgb};
    const iso_label_painter painter = iso_label_painter_make(&colors);
    const iso_camera camera = {
        .position = {18, -60, 22}, .focal_point = {15, 15, 15}, .view_up = {0, 0, 1}, .view_angle = 40};
    assert_int_equal(iso_exact_create(&grid, &(iso_exact_opts){.isovalue = 0}, &exact, NULL), ISO_OK);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_OK);
    assert_int_equal(compare_fronts(&(isosculpt_layer_surface){exact, {0, 255, 0}, &painter}, camera), 3);
    iso_exact_destroy(exact);
    iso_label_fields_destroy(fields);
}

/* With too little room nothing is stored, and the next view is listed as if nothing had happened. */
static void room_is_bounded(void **state) {
    (void)state;
    iso_hgrid *ball;
    iso_exact *exact;
    iso_error error = {0};
    const iso_camera camera = {.position = {3, -60, 9}, .view_up = {0, 0, 1}, .view_angle = 40};
    const iso_view view = iso_view_make(&camera, WIDTH, HEIGHT);
    const iso_exact_opts opts = {.isovalue = 0};
    const iso_rgb color = {10, 200, 120};
    isosculpt_layer_store store = {.most_bytes = 4 * PIXELS + 1000};
    assert_int_equal(iso_session_solid(&VIEWPORT_START, &ball, NULL), ISO_OK);
    const iso_grid grid = {.hgrid = ball};
    assert_int_equal(iso_exact_create(&grid, &opts, &exact, NULL), ISO_OK);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_OK);
    const isosculpt_layer_surface surface = {.exact = exact, .color = color};
    assert_int_equal(isosculpt_layer_store_list(&store, &surface, &view, NULL, &error), ISO_ERR_NOMEM);
    assert_non_null(strstr(error.text, "out of memory for layers"));
    assert_int_equal(store.width, 0);
    store.most_bytes = SIZE_MAX;
    assert_int_equal(isosculpt_layer_store_list(&store, &surface, &view, NULL, NULL), ISO_OK);
    assert_true(store.width == WIDTH && store.bytes > 4 * PIXELS + 1000);
    isosculpt_layer_store_free(&store);
    iso_exact_destroy(exact);
    iso_hgrid_destroy(ball);
}

/* Out of memory for layers: the picture is drawn without the reference, and it is said. */
static void without_memory_the_reference_is_hidden(void **state) {
    (void)state;
    isosculpt_viewport view, plain;
    iso_session *session = viewport_session(NULL);
    int hidden = 0;
    open_view(&view, session, NULL);
    open_view(&plain, session, NULL);
    add_reference(&view);
    viewport_draw(&view, false);
    viewport_draw(&plain, false);
    viewport_refine(&plain);
    for (long calls = 0;; calls += 1 + calls / 16) {
        show(&view, true, 0.5);
        view.reference_error.text[0] = 0;
        test_refuse_memory_after(calls);
        iso_status status = isosculpt_viewport_draw(&view, WIDTH, HEIGHT, false, NULL);
        while (status == ISO_OK && view.quality == ISOSCULPT_QUALITY_REST)
            status = isosculpt_viewport_refine(&view, NULL);
        const long refusals = test_refusals();
        test_grant_memory();
        if (!refusals) break;
        if (status == ISO_OK && !view.reference_mode.shown) {
            assert_non_null(strstr(view.reference_error.text, "out of memory"));
            viewport_draw(&view, false);
            viewport_refine(&view);
            assert_memory_equal(view.image.rgba, plain.image.rgba, 4 * PIXELS);
            hidden++;
        }
        view.reference_mode.shown = false;
        viewport_draw(&view, false);
    }
    assert_true(hidden > 10);
    viewport_refine(&view);
    assert_as_new(&view, session, NULL, true);
    isosculpt_viewport_free(&view);
    isosculpt_viewport_free(&plain);
    iso_session_destroy(session);
}

static void without_memory_shapes_are_hidden(void **state) {
    with_shapes = true;
    without_memory_the_reference_is_hidden(state);
    with_shapes = false;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strokes_leave_the_picture_drawn_from_scratch),
        cmocka_unit_test(strokes_leave_the_picture_with_shapes),
        cmocka_unit_test(shapes_are_drawn_by_depth),
        cmocka_unit_test(what_is_unchanged_looks_unchanged),
        cmocka_unit_test(layers_are_those_of_exact),
        cmocka_unit_test(front_layers_are_the_first_ones),
        cmocka_unit_test(layers_have_the_colors_of_labels),
        cmocka_unit_test(room_is_bounded),
        cmocka_unit_test(without_memory_the_reference_is_hidden),
        cmocka_unit_test(without_memory_shapes_are_hidden),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
