/* The selection of visible points by OpenGL: against drawing all points, and frames against frames
 * without others before them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "gl_support.h"
#include "grids/scenes/scenes.h"
#include "render/gl/surface.h"

/* A scene's points with colours that vary with the normal, and radii that vary if asked for. */
typedef struct scene {
    iso_grid grid;
    iso_point_set *set;
    iso_point_view points;
    iso_box box; /* world */
    uint8_t (*colors)[3];
    float *radii;
} scene;

static scene make_scene(const char *name, int size, bool floats) {
    scene s;
    double isovalue;
    const iso_scene_opts opts = {.size = size};
    assert_int_equal(iso_scene_create(name, &opts, &s.grid, &isovalue, NULL), ISO_OK);
    s.set = gl_discs_make(&s.grid, isovalue, floats);
    s.points = iso_point_set_view(s.set);
    s.points.curvatures = NULL;
    const iso_affine affine = iso_transform_affine(&s.points.transform);
    const iso_box box = iso_point_view_bounds(&s.points);
    s.box = iso_box_transform(&box, &affine);
    const size_t count = iso_point_view_count(&s.points);
    s.colors = calloc(count, sizeof *s.colors);
    s.radii = calloc(count, sizeof *s.radii);
    assert_true(s.colors && s.radii);
    uint32_t seed = 5;
    for (size_t i = 0; i < count; i++) {
        const iso_surfel surfel = iso_point_view_get(&s.points, i);
        s.radii[i] = (float)(s.points.radius * (0.9 + 0.4 * uniform(&seed)));
        for (int k = 0; k < 3; k++) s.colors[i][k] = (uint8_t)(128 + 127 * sin(3 * (double)surfel.normal[k]));
    }
    return s;
}

static void free_scene(scene *s) {
    free(s->colors);
    free(s->radii);
    iso_point_set_destroy(s->set);
    iso_grid_destroy(&s->grid);
}

static iso_gl_surface *upload(iso_gl_engine *engine, const iso_point_view *points) {
    iso_gl_surface *surface;
    iso_error error = {ISO_OK, ""};
    test_ok(iso_gl_upload_points(engine, points, &surface, &error), &error);
    return surface;
}

static iso_gbuffer draw_by(iso_gl_engine *engine, const iso_gl_surface *surface, const iso_view *view,
                           iso_reconstruction reconstruction, iso_point_selection selection) {
    iso_error error = {ISO_OK, ""};
    iso_gbuffer g = gl_gbuffer(view);
    const iso_gl_pullpush_opts opts = {view, &surface, 1, reconstruction, selection};
    test_ok(iso_gl_draw_pullpush(engine, &opts, &g, &error), &error);
    return g;
}

static iso_gbuffer draw(iso_gl_engine *engine, const iso_gl_surface *surface, const iso_view *view,
                        iso_point_selection selection) {
    return draw_by(engine, surface, view, ISO_RECONSTRUCTION_FLAT, selection);
}

static bool is_same(const iso_gbuffer *a, const iso_gbuffer *b) {
    const size_t samples = (size_t)a->width * (size_t)a->height;
    bool same = memcmp(a->depth, b->depth, samples * sizeof(float)) == 0 &&
                memcmp(a->surface, b->surface, samples) == 0;
    for (int k = 0; k < 3; k++) same &= memcmp(a->normal[k], b->normal[k], samples * sizeof(float)) == 0;
    if (a->color && b->color) same &= memcmp(a->color, b->color, samples * sizeof *a->color) == 0;
    return same && !a->color == !b->color;
}

/* The PSNR of the colours of pixels that both pictures cover, dB. */
static double color_psnr(const iso_gbuffer *a, const iso_gbuffer *b) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < (size_t)a->width * (size_t)a->height; i++)
        for (int k = 0; k < 24 && a->color[i] >> 24 && b->color[i] >> 24; k += 8, count++) {
            const double d = (double)(a->color[i] >> k & 255) - (double)(b->color[i] >> k & 255);
            sum += d * d;
        }
    return sum > 0 ? 10 * log10(255 * 255 * count / sum) : INFINITY;
}

/* Compares a picture of visible points with that of all points: the same pixels are covered. Returns the
 * lower PSNR, of shading and of colours; *drawn: the share of points that were drawn. */
static double compare(iso_gl_engine *engine, const iso_point_view *points, const iso_view *view,
                      double *drawn) {
    iso_gl_surface *surface = upload(engine, points);
    const iso_selection_counts before = iso_gl_engine_selection(engine);
    iso_gbuffer all = draw(engine, surface, view, ISO_SELECTION_ALL),
                visible = draw(engine, surface, view, ISO_SELECTION_VISIBLE);
    const iso_selection_counts after = iso_gl_engine_selection(engine);
    const gl_difference d = gl_compare(view, &all, &visible);
    assert_true(d.outline > 100);
    assert_int_equal(d.differ, 0);
    *drawn = (double)(after.drawn - before.drawn) / (double)(after.points - before.points);
    const double psnr = points->colors ? fmin(d.psnr, color_psnr(&all, &visible)) : d.psnr;
    iso_gbuffer_free(&all);
    iso_gbuffer_free(&visible);
    iso_gl_surface_destroy(surface);
    return psnr;
}

/* Points 0.7 to 1.5 pixels apart, from all sides: packed ones and floats, with and without colours and
 * radii, closed sets and others, whose back-facing discs are drawn. Returns the lowest PSNR; *drawn: the
 * largest share of points that was drawn where they are densest. */
static double compare_dense(iso_gl_engine *engine, const char *name, bool floats, double *drawn) {
    scene s = make_scene(name, 160, floats);
    double worst = INFINITY;
    *drawn = 0;
    for (int side = 0; side < GL_SIDES; side++) {
        const int width = 110 + 50 * (side % 3);
        const iso_view view = gl_side_view(&s.box, side, side % 2, width, width - 10);
        iso_point_view points = s.points;
        double share;
        points.closed = strcmp(name, "sphere") == 0 && side < 3;
        points.colors = side % 3 ? (const uint8_t(*)[3])s.colors : NULL;
        points.radii = side % 2 ? s.radii : NULL;
        worst = fmin(worst, compare(engine, &points, &view, &share));
        if (side % 3 == 0) *drawn = fmax(*drawn, share);
    }
    free_scene(&s);
    return worst;
}

/* The head has bumps of a few pixels: neighbouring points differ, so a mean of fewer of them differs too. */
static void dense_points_look_as_all_points(iso_gl_engine *engine) {
    static const struct {
        const char *name;
        double psnr;
    } scenes[] = {{"sphere", 52}, {"gyroid", 40}, {"head", 30}};
    for (int i = 0; i < 6; i++) {
        double drawn;
        const double worst = compare_dense(engine, scenes[i % 3].name, i >= 3, &drawn);
        printf("%s, %s: %.1f dB or more; up to %.0f %% drawn\n", engine->context->name, scenes[i % 3].name,
               worst, 100 * drawn);
        assert_true(worst >= scenes[i % 3].psnr);
        assert_true(drawn < 0.4);
    }
}

/* Larger discs, also curved ones, are left out only where they are hidden. */
static void large_discs_give_the_same_bytes(iso_gl_engine *engine) {
    scene s = make_scene("sphere", 128, false);
    for (int curved = 0; curved < 2; curved++) {
        const iso_reconstruction reconstruction =
            curved ? ISO_RECONSTRUCTION_CURVED : ISO_RECONSTRUCTION_FLAT;
        iso_point_view points = curved ? iso_point_set_view(s.set) : s.points;
        double share = 1;
        points.colors = curved ? NULL : (const uint8_t(*)[3])s.colors;
        points.radii = s.radii;
        points.closed = false;
        iso_gl_surface *surface = upload(engine, &points);
        for (int side = 0; side < GL_SIDES; side += 2) {
            const iso_view view = gl_side_view(&s.box, side, side % 4 == 2, 500, 480);
            const iso_selection_counts before = iso_gl_engine_selection(engine);
            iso_gbuffer all = draw_by(engine, surface, &view, reconstruction, ISO_SELECTION_ALL),
                        visible = draw_by(engine, surface, &view, reconstruction, ISO_SELECTION_VISIBLE);
            const iso_selection_counts after = iso_gl_engine_selection(engine);
            assert_true(is_same(&all, &visible));
            share =
                fmin(share, (double)(after.drawn - before.drawn) / (double)(after.points - before.points));
            iso_gbuffer_free(&all);
            iso_gbuffer_free(&visible);
        }
        printf("%s: down to %.0f %% drawn\n", engine->context->name, 100 * share);
        assert_true(share < 0.9);
        iso_gl_surface_destroy(surface);
    }
    free_scene(&s);
}

/* ---- sheets of discs behind each other, a few radii apart: what is hidden can still change the picture */

enum { TILES = 10, SHEETS = 6, DISCS = 4 /* along a side of a tile */, SHEET_RADIUS = 5 };

typedef struct sheets {
    iso_surfel surfels[TILES * TILES * SHEETS * DISCS * DISCS];
    uint8_t colors[TILES * TILES * SHEETS * DISCS * DISCS][3];
    iso_point_span spans[TILES * TILES * SHEETS];
    iso_point_view points;
    iso_box box;
} sheets;

/* One tile in each brick, at any depth in it, some facing backwards, each with a colour of its own. A third
 * of the tiles are left out, so that those behind are seen as well. `even`: the tiles of a sheet have the
 * same depth, near to that of another, and few are left out. */
static sheets *make_sheets(uint32_t seed, bool even) {
    sheets *s = calloc(1, sizeof *s);
    assert_non_null(s);
    const float gap = 6 * (float)uniform(&seed);
    size_t count = 0, spans = 0;
    for (int tile = 0; tile < TILES * TILES * SHEETS; tile++) {
        if (uniform(&seed) < (even ? 0.02 : 0.33)) continue;
        const int sheet = tile / TILES / TILES;
        const float any = (float)(ISO_BRICK * uniform(&seed)), near = sheet % 2 ? gap : ISO_BRICK,
                    depth = even ? near : any, side = uniform(&seed) < 0.3 ? -1 : 1;
        const uint8_t color[3] = {(uint8_t)(255 * uniform(&seed)), (uint8_t)(255 * uniform(&seed)), 0};
        s->spans[spans++] = (iso_point_span){
            .brick = {tile % TILES, tile / TILES % TILES, sheet}, .count = DISCS * DISCS, .first = count};
        for (int i = 0; i < DISCS * DISCS; i++, count++) {
            const float step = (float)ISO_BRICK / DISCS;
            s->surfels[count] =
                (iso_surfel){{step * ((float)(i % DISCS) + 0.5f), step * ((float)(i / DISCS) + 0.5f), depth},
                             {0, 0.6f * side, 0.8f * side}};
            memcpy(s->colors[count], color, sizeof color);
        }
    }
    s->points = (iso_point_view){.surfels = s->surfels,
                                 .colors = (const uint8_t(*)[3])s->colors,
                                 .spans = s->spans,
                                 .span_count = spans,
                                 .transform = iso_transform_identity(),
                                 .radius = SHEET_RADIUS};
    s->box = (iso_box){{0, 0, 0}, {TILES * ISO_BRICK, TILES * ISO_BRICK, SHEETS * ISO_BRICK}};
    return s;
}

/* Returns a view along z, from below or above, or nearly so. */
static iso_view sheet_view(const sheets *s, int number, int width) {
    iso_camera camera = {
        .view_angle = 30, .view_up = {0, 1, 0}, .orthographic = number % 3 == 0, .parallel_scale = 1};
    camera.position = iso_vec3_make(0.05 * number, 0.02 * number, number % 2 ? 1 : -1);
    iso_camera_fit(&camera, &s->box, 1, 1);
    return iso_view_make(&camera, width, width);
}

static void hidden_sheets_change_nothing(iso_gl_engine *engine) {
    double share = 1;
    for (int n = 0; n < 12; n++) {
        sheets *s = make_sheets((uint32_t)n, n % 4 == 3);
        iso_gl_surface *surface = upload(engine, &s->points);
        const iso_view view = sheet_view(s, n, 150 + 60 * n);
        const iso_selection_counts before = iso_gl_engine_selection(engine);
        iso_gbuffer all = draw(engine, surface, &view, ISO_SELECTION_ALL),
                    visible = draw(engine, surface, &view, ISO_SELECTION_VISIBLE);
        const iso_selection_counts after = iso_gl_engine_selection(engine);
        share = fmin(share, (double)(after.drawn - before.drawn) / (double)(after.points - before.points));
        assert_true(is_same(&all, &visible));
        iso_gbuffer_free(&all);
        iso_gbuffer_free(&visible);
        iso_gl_surface_destroy(surface);
        free(s);
    }
    printf("%s: down to %.0f %% drawn\n", engine->context->name, 100 * share);
    assert_true(share < 0.9);
}

/* Draws two surfaces into one picture; *drawn: the number of points drawn of both. */
static iso_gbuffer draw_both(iso_gl_engine *engine, iso_gl_surface *const surfaces[2], const iso_view *view,
                             iso_point_selection selection, uint64_t *drawn) {
    iso_error error = {ISO_OK, ""};
    iso_gbuffer g = gl_gbuffer(view);
    const uint64_t before = iso_gl_engine_selection(engine).drawn;
    const iso_gl_pullpush_opts opts = {view, (const iso_gl_surface *const *)surfaces, 2,
                                       ISO_RECONSTRUCTION_FLAT, selection};
    test_ok(iso_gl_draw_pullpush(engine, &opts, &g, &error), &error);
    *drawn = iso_gl_engine_selection(engine).drawn - before;
    return g;
}

/* Surfaces between each other's sheets, drawn with and without a frame before: what the first one hides of
 * the second changes nothing, and fewer points are drawn than of both alone. */
static void surfaces_hide_each_other(iso_gl_engine *engine) {
    uint64_t together = 0, alone = 0;
    for (int n = 0; n < 8; n++) {
        sheets *s[2] = {make_sheets((uint32_t)n, n % 4 == 3), make_sheets((uint32_t)n + 50, n % 2)};
        iso_gl_surface *surfaces[2];
        s[1]->points.transform.origin[2] += 30 * n - 105;
        for (int i = 0; i < 2; i++) surfaces[i] = upload(engine, &s[i]->points);
        for (int frame = 0; frame < 3; frame++) {
            const iso_view view = sheet_view(s[0], 2 * n + frame, 150 + 60 * n);
            uint64_t drawn;
            iso_gbuffer all = draw_both(engine, surfaces, &view, ISO_SELECTION_ALL, &drawn),
                        visible = draw_both(engine, surfaces, &view, ISO_SELECTION_VISIBLE, &drawn);
            together += drawn;
            assert_true(is_same(&all, &visible));
            if (frame == 2) { /* the nearer one is drawn first, whichever is given first */
                iso_gl_surface *const turned[2] = {surfaces[1], surfaces[0]};
                uint64_t of_turned;
                iso_gbuffer other = draw_both(engine, turned, &view, ISO_SELECTION_VISIBLE, &of_turned);
                assert_true((double)of_turned <= 1.05 * (double)drawn);
                iso_gbuffer_free(&other);
            }
            iso_gbuffer_free(&all);
            iso_gbuffer_free(&visible);
            const uint64_t before = iso_gl_engine_selection(engine).drawn;
            for (int i = 0; i < 2; i++) {
                visible = draw(engine, surfaces[i], &view, ISO_SELECTION_VISIBLE);
                iso_gbuffer_free(&visible);
            }
            alone += iso_gl_engine_selection(engine).drawn - before;
        }
        for (int i = 0; i < 2; i++) {
            iso_gl_surface_destroy(surfaces[i]);
            free(s[i]);
        }
    }
    printf("%s: of two surfaces %.0f %% of the points are drawn that are drawn of both alone\n",
           engine->context->name, 100 * (double)together / (double)alone);
    assert_true((double)together < 0.9 * (double)alone);
}

enum { SIDE = 300 };

/* The view of a frame of a camera path: small steps, and jumps by 180 degrees and to near views. */
static iso_view path_view(const scene *s, int frame) {
    static const double angles[] = {0, 3, 6, 186, 189, 100, 103, 283}, zooms[] = {1, 1, 1.1, 1.1, 3, 3, 1, 1};
    iso_camera camera = {.view_angle = 30, .view_up = {0, 0, 1}};
    const double angle = angles[frame] * ISO_PI / 180;
    camera.position = iso_vec3_make(cos(angle), sin(angle), 0.3);
    iso_camera_fit(&camera, &s->box, 1, 1);
    iso_view view = iso_view_make(&camera, SIDE, SIDE);
    view.focal *= zooms[frame];
    return view;
}

enum { FRAMES = 8 };

/* Draws a frame after others, and with the same points uploaded anew. */
static void expect_as_anew(iso_gl_engine *engine, const iso_gl_surface *surface, const iso_point_view *points,
                           const iso_view *view, size_t *fewer) {
    iso_gl_surface *anew = upload(engine, points);
    const iso_selection_counts first = iso_gl_engine_selection(engine);
    iso_gbuffer coherent = draw(engine, surface, view, ISO_SELECTION_VISIBLE);
    const iso_selection_counts second = iso_gl_engine_selection(engine);
    iso_gbuffer scratch = draw(engine, anew, view, ISO_SELECTION_VISIBLE);
    const iso_selection_counts third = iso_gl_engine_selection(engine);
    assert_true(is_same(&coherent, &scratch));
    *fewer += second.tested - first.tested < third.tested - second.tested;
    iso_gbuffer_free(&coherent);
    iso_gbuffer_free(&scratch);
    iso_gl_surface_destroy(anew);
}

static void frames_do_not_depend_on_frames_before(iso_gl_engine *engine) {
    for (int n = 0; n < 4; n++) {
        scene s = make_scene(n % 2 ? "gyroid" : "head", n < 2 ? 64 : 160, n == 1);
        iso_point_view points = s.points;
        size_t fewer = 0;
        if (n < 2) points.colors = (const uint8_t(*)[3])s.colors;
        if (n < 2) points.radii = s.radii;
        iso_gl_surface *surface = upload(engine, &points);
        for (int frame = 0; frame < FRAMES; frame++) {
            const iso_view view = path_view(&s, frame);
            expect_as_anew(engine, surface, &points, &view, &fewer);
        }
        if (n % 2) assert_true(fewer >= FRAMES / 2); /* blocks that were not seen are not looked at */
        iso_gl_surface_destroy(surface);
        free_scene(&s);
    }
}

static void expect_same_from_any_blocks(iso_gl_engine *engine, const iso_point_view *points,
                                        const iso_view *view, uint32_t *seed) {
    enum { TRIALS = 10 };
    iso_gl_surface *surface = upload(engine, points);
    iso_gbuffer scratch = draw(engine, surface, view, ISO_SELECTION_VISIBLE);
    for (int trial = 0; trial < TRIALS; trial++) {
        iso_gl_seen *seen = surface->seen;
        uint8_t *flags = seen->flags.data;
        assert_true(seen->count > 1);
        for (size_t i = 0; i < seen->count; i++) flags[i] = uniform(seed) * TRIALS < trial;
        if (trial % 2) { /* the points that made fronts in an earlier frame, or none */
            const unsigned last = seen->fronts[0];
            seen->fronts[0] = seen->fronts[1];
            seen->fronts[1] = last;
        }
        iso_gbuffer g = draw(engine, surface, view, ISO_SELECTION_VISIBLE);
        assert_true(is_same(&scratch, &g));
        iso_gbuffer_free(&g);
    }
    iso_gbuffer_free(&scratch);
    iso_gl_surface_destroy(surface);
}

/* Whatever blocks and points are looked at first, as after a frame of something else, the picture is the
 * same. */
static void any_blocks_may_be_first(iso_gl_engine *engine) {
    uint32_t seed = 3;
    for (int n = 0; n < 2; n++) {
        scene s = make_scene(n ? "gyroid" : "head", n ? 160 : 96, false);
        const iso_view view = path_view(&s, n);
        expect_same_from_any_blocks(engine, &s.points, &view, &seed);
        free_scene(&s);
    }
    for (int n = 0; n < 6; n++) { /* discs of 0.6 to 1.6 pixels */
        sheets *s = make_sheets((uint32_t)n, true);
        const iso_view view = sheet_view(s, n, 25 + 8 * n);
        expect_same_from_any_blocks(engine, &s->points, &view, &seed);
        free(s);
    }
}

/* Points that shrink, and points that grow, while the blocks stay the same; then spans that come and go.
 * What was seen before is no longer there, or hidden. */
static void edits_do_not_depend_on_frames_before(iso_gl_engine *engine) {
    scene s = make_scene("gyroid", 96, false);
    iso_point_view points = s.points;
    points.radii = s.radii;
    points.versions = NULL; /* every update uploads all points */
    const size_t count = iso_point_view_count(&points), spans = points.span_count;
    const iso_view view = path_view(&s, 0);
    iso_gl_surface *surface = upload(engine, &points);
    size_t fewer = 0;
    for (int round = 0; round < 6; round++) {
        expect_as_anew(engine, surface, &points, &view, &fewer);
        for (size_t i = 0; i < count; i++)
            if (i * 4 / count == (size_t)round) s.radii[i] *= round % 2 ? 1.8f : 0.01f;
        if (round >= 4) points.spans += spans / 4;
        if (round >= 4) points.span_count -= spans / 4;
        assert_int_equal(iso_gl_update_points(surface, &points, NULL), ISO_OK);
    }
    assert_true(fewer > 0);
    iso_gl_surface_destroy(surface);
    free_scene(&s);
}

/* Draws a frame by ISO_SELECTION_AUTO and one of all points. Returns the share of points that the first one
 * drew; 1: it did not select any. */
static double expect_all_points(iso_gl_engine *engine, const iso_gl_surface *surface, const iso_view *view,
                                iso_reconstruction reconstruction) {
    const iso_selection_counts before = iso_gl_engine_selection(engine);
    iso_gbuffer chosen = draw_by(engine, surface, view, reconstruction, ISO_SELECTION_AUTO);
    const iso_selection_counts after = iso_gl_engine_selection(engine);
    iso_gbuffer all = draw_by(engine, surface, view, reconstruction, ISO_SELECTION_ALL);
    assert_true(is_same(&chosen, &all));
    iso_gbuffer_free(&chosen);
    iso_gbuffer_free(&all);
    if (after.points == before.points) return 1;
    return (double)(after.drawn - before.drawn) / (double)(after.points - before.points);
}

/* What the engine selects by itself changes no byte: while the camera moves and jumps, after edits, of discs
 * of all sizes, curved and flat, also of sheets whose back-facing discs are seen. */
static void chosen_by_itself_nothing_changes(iso_gl_engine *engine) {
    double least[2] = {1, 1};
    for (int n = 0; n < 4; n++) {
        scene s = make_scene(n % 2 ? "gyroid" : "head", n < 2 ? 96 : 160, n == 1);
        iso_point_view points = n % 2 ? iso_point_set_view(s.set) : s.points;
        points.radii = s.radii;
        points.versions = NULL; /* every update uploads all points */
        iso_gl_surface *surface = upload(engine, &points);
        const size_t count = iso_point_view_count(&points);
        for (int frame = 0; frame < FRAMES; frame++) {
            const iso_view view = path_view(&s, frame);
            const iso_reconstruction by = n % 2 ? ISO_RECONSTRUCTION_CURVED : ISO_RECONSTRUCTION_FLAT;
            least[n % 2] = fmin(least[n % 2], expect_all_points(engine, surface, &view, by));
            for (size_t i = 0; i < count / 5; i++) s.radii[i] *= frame % 2 ? 2 : 0.5f;
            if (frame % 3 == 2) assert_int_equal(iso_gl_update_points(surface, &points, NULL), ISO_OK);
        }
        iso_gl_surface_destroy(surface);
        free_scene(&s);
    }
    for (int n = 0; n < 8; n++) {
        sheets *s = make_sheets((uint32_t)n, n % 2);
        iso_gl_surface *surface = upload(engine, &s->points);
        for (int frame = 0; frame < 3; frame++) {
            const iso_view view = sheet_view(s, n + frame / 2, 100 + 70 * n);
            expect_all_points(engine, surface, &view, ISO_RECONSTRUCTION_FLAT);
        }
        iso_gl_surface_destroy(surface);
        free(s);
    }
    printf("%s: by itself down to %.0f and %.0f %% drawn\n", engine->context->name, 100 * least[0],
           100 * least[1]);
    assert_true(least[0] < 0.9 && least[1] < 0.6);
}

/* Few points are all drawn: the tests cost more than they save. */
static void of_few_points_none_is_selected(iso_gl_engine *engine) {
    scene s = make_scene("sphere", 24, false);
    iso_gl_surface *surface = upload(engine, &s.points);
    for (int frame = 0; frame < 3; frame++) {
        const iso_view view = path_view(&s, frame);
        assert_true(expect_all_points(engine, surface, &view, ISO_RECONSTRUCTION_FLAT) >= 1);
    }
    iso_gl_surface_destroy(surface);
    free_scene(&s);
}

/* The paper's figure 3: without its third pass, points are missing where the fronts of those seen before have
 * holes. */
static void without_the_third_pass_there_are_holes(iso_gl_engine *engine) {
    scene s = make_scene("gyroid", 128, false);
    iso_gl_surface *surface = upload(engine, &s.points);
    iso_gbuffer pictures[3];
    for (int i = 0; i < 3; i++) {
        const iso_view before = path_view(&s, 0), view = path_view(&s, 3);
        iso_gbuffer g = draw(engine, surface, &before, ISO_SELECTION_VISIBLE);
        iso_gbuffer_free(&g);
        engine->keep_holes = i == 1;
        pictures[i] = draw(engine, surface, &view, i == 2 ? ISO_SELECTION_ALL : ISO_SELECTION_VISIBLE);
        engine->keep_holes = false;
    }
    const iso_view view = path_view(&s, 3);
    const gl_difference with = gl_compare(&view, &pictures[2], &pictures[0]),
                        without = gl_compare(&view, &pictures[2], &pictures[1]);
    printf("%s: with the third pass %.1f dB, without it %.1f dB and %d pixels differ\n",
           engine->context->name, with.psnr, without.psnr, without.differ);
    assert_int_equal(with.differ, 0);
    assert_true(without.psnr + 10 < with.psnr);
    for (int i = 0; i < 3; i++) iso_gbuffer_free(&pictures[i]);
    iso_gl_surface_destroy(surface);
    free_scene(&s);
}

/* Drivers without storage buffers in vertex shaders, or too small ones, draw all points. */
static void all_points_are_drawn_where_none_can_be_selected(iso_gl_engine *engine) {
    scene s = make_scene("gyroid", 96, true);
    iso_gl_surface *surface = upload(engine, &s.points);
    const iso_view view = gl_side_view(&s.box, 0, false, 100, 100);
    const size_t storage = engine->max_storage;
    iso_gbuffer all = draw(engine, surface, &view, ISO_SELECTION_ALL),
                visible = draw(engine, surface, &view, ISO_SELECTION_VISIBLE);
    assert_false(is_same(&all, &visible));
    iso_gbuffer_free(&visible);
    for (int i = 0; i < 2; i++) {
        engine->vertex_storage = i == 1;
        engine->max_storage = i ? 300000 : storage;
        visible = draw(engine, surface, &view, ISO_SELECTION_VISIBLE);
        assert_true(is_same(&all, &visible));
        iso_gbuffer_free(&visible);
    }
    iso_gbuffer_free(&all);
    iso_gl_surface_destroy(surface);
    free_scene(&s);
}

/* In tiles of the picture, the points are chosen as in the whole picture. */
static void tiles_do_not_show(iso_gl_engine *engine) {
    scene s = make_scene("head", 128, false);
    iso_gl_surface *surface = upload(engine, &s.points);
    const iso_view view = gl_side_view(&s.box, 1, false, 150, 140);
    iso_gbuffer whole = draw(engine, surface, &view, ISO_SELECTION_VISIBLE);
    engine->max_side = 64;
    iso_gbuffer tiles = draw(engine, surface, &view, ISO_SELECTION_VISIBLE);
    const gl_difference d = gl_compare(&view, &whole, &tiles);
    printf("%s: tiles %.1f dB\n", engine->context->name, d.psnr);
    assert_true(d.psnr >= 55 && d.differ * 200 <= d.outline);
    iso_gbuffer_free(&whole);
    iso_gbuffer_free(&tiles);
    iso_gl_surface_destroy(surface);
    free_scene(&s);
}

/* All contexts of this machine draw nearly the same. */
static void contexts_agree(void **state) {
    (void)state;
    gl_contexts contexts;
    iso_gbuffer first = {0};
    if (!gl_contexts_open(&contexts)) skip();
    scene s = make_scene("gyroid", 128, false);
    const iso_view view = gl_side_view(&s.box, 2, false, 180, 170);
    for (int i = 0; i < contexts.count; i++) {
        iso_gl_engine *engine;
        assert_int_equal(iso_gl_engine_create(contexts.context[i], &engine, NULL), ISO_OK);
        iso_gl_surface *surface = upload(engine, &s.points);
        iso_gbuffer g = draw(engine, surface, &view, ISO_SELECTION_VISIBLE);
        if (i) {
            const gl_difference d = gl_compare(&view, &first, &g);
            printf("contexts differ by %.1f dB\n", d.psnr);
            assert_true(d.psnr >= 50 && d.differ * 100 <= d.outline);
            iso_gbuffer_free(&g);
        } else {
            first = g;
        }
        iso_gl_surface_destroy(surface);
        iso_gl_engine_destroy(engine);
    }
    iso_gbuffer_free(&first);
    free_scene(&s);
    gl_contexts_close(&contexts);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_engine_test(dense_points_look_as_all_points),
        gl_engine_test(large_discs_give_the_same_bytes),
        gl_engine_test(hidden_sheets_change_nothing),
        gl_engine_test(surfaces_hide_each_other),
        gl_engine_test(frames_do_not_depend_on_frames_before),
        gl_engine_test(any_blocks_may_be_first),
        gl_engine_test(edits_do_not_depend_on_frames_before),
        gl_engine_test(chosen_by_itself_nothing_changes),
        gl_engine_test(of_few_points_none_is_selected),
        gl_engine_test(without_the_third_pass_there_are_holes),
        gl_engine_test(all_points_are_drawn_where_none_can_be_selected),
        gl_engine_test(tiles_do_not_show),
        cmocka_unit_test(contexts_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
