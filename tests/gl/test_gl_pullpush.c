/* Pull-push of the gl engine against the cpu engine's: what decides how it is done, and limits. */
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

/* A scene's points, as they come and with what culls them. */
typedef struct scene {
    iso_grid grid;
    gl_surface surface;
    iso_point_set *discs[2]; /* for curved: packed, floats */
} scene;

static scene make_scene(const char *name, int size) {
    scene s;
    double isovalue;
    const iso_scene_opts opts = {.size = size, .dense = true};
    assert_int_equal(iso_scene_create(name, &opts, &s.grid, &isovalue, NULL), ISO_OK);
    s.surface = gl_surface_make(&s.grid, isovalue);
    assert_int_equal(iso_point_set_bound(s.surface.packed, NULL), ISO_OK);
    for (int floats = 0; floats < 2; floats++) {
        s.discs[floats] = gl_discs_make(&s.grid, isovalue, floats);
        assert_int_equal(iso_point_set_bound(s.discs[floats], NULL), ISO_OK);
    }
    return s;
}

static void free_scene(scene *s) {
    for (int floats = 0; floats < 2; floats++) iso_point_set_destroy(s->discs[floats]);
    gl_surface_free(&s->surface);
    iso_grid_destroy(&s->grid);
}

static double check_both(iso_gl_engine *engine, const iso_point_view *points, const iso_view *views,
                         int count, const char *name) {
    double box = gl_check_pullpush(engine, points, ISO_RECONSTRUCTION_BOX, views, count, name);
    return fmin(box, gl_check_pullpush(engine, points, ISO_RECONSTRUCTION_GAUSSIAN, views, count, name));
}

static double check_discs(iso_gl_engine *engine, const iso_point_view *points, const iso_view *views,
                          int count, const char *name) {
    return gl_check_pullpush(engine, points, ISO_RECONSTRUCTION_CURVED, views, count, name);
}

/* Packed points and floats, culled and two-sided. */
static void scenes_look_as_from_the_cpu(iso_gl_engine *engine) {
    static const struct {
        const char *name;
        int size, closed;
    } cases[] = {{"sphere", 48, 1}, {"cube", 40, 1}, {"gyroid", 48, 0}, {"ct", 64, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene s = make_scene(cases[i].name, cases[i].size);
        iso_point_view packed = iso_point_set_view(s.surface.packed),
                       floats = iso_point_set_view(s.surface.floats);
        packed.closed = cases[i].closed;
        iso_view views[GL_SIDES];
        for (int side = 0; side < GL_SIDES; side++)
            views[side] = gl_side_view(&s.surface.box, side, side % 2, 200 + 40 * side, 230);
        double worst = check_both(engine, &packed, views, GL_SIDES, cases[i].name);
        worst = fmin(worst, check_both(engine, &floats, views, GL_SIDES, cases[i].name));
        double curved = INFINITY;
        for (int k = 0; k < 2; k++) {
            iso_point_view discs = iso_point_set_view(s.discs[k]);
            discs.closed = cases[i].closed;
            curved = fmin(curved, check_discs(engine, &discs, views, GL_SIDES, cases[i].name));
        }
        printf("%s, %s: %.1f dB, curved %.1f dB\n", engine->context->name, cases[i].name, worst, curved);
        free_scene(&s);
    }
}

/* Inside the scene, with the near plane through it; so near that the base level is a coarse one. */
static int near_views(const iso_box *box, iso_view views[4]) {
    iso_vec3 middle = iso_vec3_scale(iso_vec3_add(box->lo, box->hi), 0.5);
    iso_camera camera = {.view_angle = 70, .view_up = {0, 0, 1}};
    for (int i = 0; i < 3; i++) {
        camera.position = iso_vec3_add(middle, iso_vec3_make(1.3 * i, 0.7, 0.2 - i));
        camera.focal_point = iso_vec3_add(camera.position, iso_vec3_make(3.0 - i, 10, 2));
        views[i] = iso_view_make(&camera, 320, 250);
    }
    camera = (iso_camera){.orthographic = true, .parallel_scale = 2, .view_up = {0, 0, 1}};
    camera.focal_point = middle;
    camera.position = iso_vec3_add(middle, iso_vec3_make(3, 100, 1));
    views[3] = iso_view_make(&camera, 400, 300);
    return 4;
}

/* In tiles of the picture, as quads, in strips. */
static double check_limits_of_discs(iso_gl_engine *engine, const iso_point_view *discs, const iso_view *views,
                                    int count) {
    double worst = check_discs(engine, discs, views, count, "curved, near");
    engine->max_side = 101;
    worst = fmin(worst, check_discs(engine, discs, views, 1, "curved, in tiles"));
    engine->max_point = 3;
    return fmin(worst, check_discs(engine, discs, views + count - 2, 2, "curved, by quads"));
}

static void near_points_and_limits_do_not_show(iso_gl_engine *engine) {
    scene s = make_scene("gyroid", 40);
    iso_point_view points = iso_point_set_view(s.surface.packed);
    iso_view views[4];
    const iso_view tall = gl_side_view(&s.surface.box, 2, false, 300, 700);
    int count = near_views(&s.surface.box, views);
    double worst = check_both(engine, &points, views, count, "near");
    engine->max_storage = (size_t)1 << 20; /* strips, and windows of points */
    worst = fmin(worst, check_both(engine, &points, &tall, 1, "in strips"));
    points = iso_point_set_view(s.discs[0]);
    double curved = check_discs(engine, &points, &tall, 1, "curved, in strips");
    curved = fmin(curved, check_limits_of_discs(engine, &points, views, count));
    printf("%s: %.1f dB, curved %.1f dB\n", engine->context->name, worst, curved);
    free_scene(&s);
}

enum { SPANS = 6, EACH = 9000, POINTS = SPANS * EACH };

/* Points of a thin shell of radius 7 around (8, 8, 8) in each of the spans, which are out of order: every
 * other one is of its inside. */
typedef struct many_points {
    iso_surfel *surfels;
    float *radii;
    iso_curvature *curvatures; /* the view names these and colours where they are wanted */
    uint8_t (*colors)[3];
    iso_point_span spans[SPANS];
    iso_point_view view;
} many_points;

static void make_many(many_points *m) {
    uint32_t seed = 5;
    m->surfels = calloc(POINTS, sizeof *m->surfels);
    m->radii = calloc(POINTS, sizeof *m->radii);
    m->curvatures = calloc(POINTS, sizeof *m->curvatures);
    m->colors = calloc(POINTS, sizeof *m->colors);
    for (int i = 0; i < POINTS; i++) {
        double z = 2 * uniform(&seed) - 1, turn = 2 * ISO_PI * uniform(&seed), r = sqrt(1 - z * z);
        const double n[3] = {r * cos(turn), r * sin(turn), z};
        for (int axis = 0; axis < 3; axis++) {
            m->surfels[i].position[axis] = (float)(8 + (i % 2 ? 6.95 : 7) * n[axis]);
            m->surfels[i].normal[axis] = (float)((i % 2 ? -3 : 3) * n[axis]);
        }
        m->radii[i] = (float)(0.15 + 0.3 * uniform(&seed));
        m->curvatures[i] = iso_curvature_pack(i % 2 ? -0.14f : 0.14f, 0, i % 2 ? -0.14f : 0.14f);
        for (int k = 0; k < 3; k++) m->colors[i][k] = (uint8_t)(i % 2 ? 40 * k : 128 + 120 * n[k]);
    }
    m->surfels[17].position[1] = NAN;
    m->surfels[18].position[2] = INFINITY;
    m->surfels[19].normal[0] = NAN;
    memset(m->surfels[20].normal, 0, sizeof m->surfels[20].normal);
    for (int s = 0; s < SPANS; s++)
        m->spans[s] = (iso_point_span){{s % 2, s / 2 - 1, s % 3}, EACH, (size_t)EACH * ((5 * s + 2) % SPANS)};
    m->view = (iso_point_view){.surfels = m->surfels,
                               .radii = m->radii,
                               .spans = m->spans,
                               .span_count = SPANS,
                               .transform = iso_transform_identity()};
    m->view.transform.spacing[1] = 0.8;
    m->view.transform.direction[1] = 0.2;
}

static void free_many(many_points *m) {
    free(m->surfels);
    free(m->radii);
    free(m->curvatures);
    free(m->colors);
}

static void points_have_radii_of_their_own(iso_gl_engine *engine) {
    many_points m;
    make_many(&m);
    const iso_box box = {{0, -16, 0}, {32, 32, 48}};
    const iso_view views[3] = {gl_side_view(&box, 0, false, 300, 200), gl_side_view(&box, 2, true, 390, 320),
                               gl_side_view(&box, 5, false, 1200, 1000)};
    gl_check_pullpush(engine, &m.view, ISO_RECONSTRUCTION_GAUSSIAN, views, 3, "radii");
    double curved = check_discs(engine, &m.view, views, 3, "curved, radii");
    printf("%s: curved %.1f dB\n", engine->context->name, curved);
    engine->max_storage = (size_t)1 << 20; /* less than the surfels take */
    gl_check_pullpush(engine, &m.view, ISO_RECONSTRUCTION_GAUSSIAN, views, 1, "radii, in windows");
    free_many(&m);
}

/* With radii and without; in windows of points and strips of the picture, which begin at any byte of a
 * word. */
static void points_have_colours_of_their_own(iso_gl_engine *engine) {
    many_points m;
    make_many(&m);
    m.view.colors = (const uint8_t(*)[3])m.colors;
    for (int s = 0; s < SPANS; s++) m.spans[s].count -= (uint32_t)s;
    const iso_box box = {{0, -16, 0}, {32, 32, 48}};
    const iso_view views[3] = {gl_side_view(&box, 0, false, 300, 200), gl_side_view(&box, 2, true, 390, 320),
                               gl_side_view(&box, 5, false, 1200, 1000)};
    double worst = check_both(engine, &m.view, views, 3, "colours");
    m.view.radii = NULL;
    m.view.radius = 0.3;
    worst = fmin(worst, check_both(engine, &m.view, views, 3, "colours alone"));
    engine->max_storage = (size_t)1 << 20;
    worst = fmin(worst, check_both(engine, &m.view, views, 1, "colours, in windows"));
    m.view.radii = m.radii;
    printf("%s: %.1f dB\n", engine->context->name, worst);
    free_many(&m);
}

/* Flat discs with colours and radii, small ones, which are filtered, and large ones; of points with
 * curvatures, which are not used. */
static void coloured_discs_look_as_from_the_cpu(iso_gl_engine *engine) {
    static const char *const names[] = {"sphere", "gyroid"};
    static const int sizes[] = {48, 160};
    for (int n = 0; n < 4; n++) {
        scene s = make_scene(names[n % 2], sizes[n / 2]);
        iso_point_view points = iso_point_set_view(s.discs[n % 2]);
        const size_t count = iso_point_view_count(&points);
        float *radii = calloc(count, sizeof *radii);
        uint8_t(*colors)[3] = calloc(count, sizeof *colors);
        uint32_t seed = 3;
        for (size_t i = 0; i < count; i++) {
            radii[i] = (float)(points.radius * (1 + 0.3 * uniform(&seed)));
            const iso_surfel surfel = iso_point_view_get(&points, i);
            for (int k = 0; k < 3; k++)
                colors[i][k] = (uint8_t)(128 + 127 * sin(3 * (double)surfel.normal[k]));
        }
        points.closed = n % 2 == 0;
        points.colors = (const uint8_t(*)[3])colors;
        iso_view views[4];
        for (int v = 0; v < 4; v++) views[v] = gl_side_view(&s.surface.box, v + n, v % 2, 150 + 50 * v, 160);
        double worst =
            gl_check_pullpush(engine, &points, ISO_RECONSTRUCTION_FLAT, views, 4, "discs with colours");
        worst = fmin(worst, check_discs(engine, &points, views, 4, "discs with colours, without the filter"));
        points.radii = radii; /* both engines draw such discs in two passes */
        double same = gl_check_pullpush(engine, &points, ISO_RECONSTRUCTION_FLAT, views, 4,
                                        "discs with colours and radii");
        points.colors = NULL;
        same =
            fmin(same, gl_check_pullpush(engine, &points, ISO_RECONSTRUCTION_FLAT, views, 4, "flat discs"));
        printf("%s, %s %d: %.1f dB, with radii %.1f dB\n", engine->context->name, names[n % 2], sizes[n / 2],
               worst, same);
        assert_true(same >= 60);
        free(radii);
        free(colors);
        free_scene(&s);
    }
}

static iso_gl_surface *upload(iso_gl_engine *engine, const iso_point_view *points) {
    iso_gl_surface *surface;
    iso_error error = {ISO_OK, ""};
    if (iso_gl_upload_points(engine, points, &surface, &error) != ISO_OK) fail_msg("%s", error.text);
    return surface;
}

static void expect_same(const iso_gbuffer *a, const iso_gbuffer *b) {
    size_t samples = (size_t)a->width * (size_t)a->height;
    assert_memory_equal(a->depth, b->depth, samples * sizeof(float));
    for (int k = 0; k < 3; k++) assert_memory_equal(a->normal[k], b->normal[k], samples * sizeof(float));
    assert_memory_equal(a->surface, b->surface, samples);
    assert_int_equal(a->color != NULL, b->color != NULL);
    if (a->color) assert_memory_equal(a->color, b->color, samples * sizeof *a->color);
}

/* A picture of what is uploaded against one of the same points uploaded anew. */
static void expect_as_anew(iso_gl_engine *engine, const iso_gl_surface *surface, const iso_point_view *points,
                           const iso_view *view) {
    iso_gl_surface *anew = upload(engine, points);
    iso_gbuffer pictures[2];
    for (int i = 0; i < 2; i++) {
        const iso_gl_surface *drawn = i ? anew : surface;
        const iso_gl_pullpush_opts opts = {view, &drawn, 1, ISO_RECONSTRUCTION_CURVED, ISO_SELECTION_ALL};
        pictures[i] = gl_gbuffer(view);
        assert_int_equal(iso_gl_draw_pullpush(engine, &opts, &pictures[i], NULL), ISO_OK);
    }
    expect_same(&pictures[0], &pictures[1]);
    for (int i = 0; i < 2; i++) iso_gbuffer_free(&pictures[i]);
    iso_gl_surface_destroy(anew);
}

/* Spans that change, that move, that come and go; radii may grow. */
static void check_updates(iso_gl_engine *engine, bool colored) {
    many_points m;
    make_many(&m);
    uint64_t stamps[SPANS] = {1, 2, 3, 4, 5, 6};
    m.view.versions = stamps;
    m.view.colors = colored ? (const uint8_t(*)[3])m.colors : NULL;
    m.view.curvatures = colored ? NULL : m.curvatures;
    const iso_box box = {{0, -16, 0}, {32, 32, 48}};
    const iso_view view = gl_side_view(&box, 1, false, 250, 210);
    m.view.span_count = SPANS - 1;
    iso_gl_surface *surface = upload(engine, &m.view);
    for (int round = 0; round < 4; round++) {
        iso_point_span *span = &m.spans[round];
        for (size_t i = span->first; i < span->first + span->count; i++) {
            m.surfels[i].position[round % 3] -= 2;
            m.radii[i] *= 1.5f;
            m.colors[i][round % 3] ^= 0x55;
            m.curvatures[i].uu = (int16_t)(m.curvatures[i].uu + 900);
        }
        stamps[round] += 100;
        if (round == 2) span->count = EACH / 3;
        if (round == 3) memcpy(span->brick, (const int32_t[3]){0, 1, 2}, sizeof span->brick);
        m.view.span_count = round % 2 ? SPANS - 2 : SPANS;
        assert_int_equal(iso_gl_update_points(surface, &m.view, NULL), ISO_OK);
        expect_as_anew(engine, surface, &m.view, &view);
    }
    iso_gl_surface_destroy(surface);
    free_many(&m);
}

static void updates_are_drawn(iso_gl_engine *engine) {
    check_updates(engine, false);
    check_updates(engine, true);
}

/* With points that are alike in depth and place, and some in their normals too: their order would show. */
static void check_repeated(iso_gl_engine *engine, iso_reconstruction reconstruction) {
    many_points m;
    make_many(&m);
    for (int i = 100; i < POINTS; i++)
        if (i % 3 == 0) {
            memcpy(m.surfels[i].position, m.surfels[i - 1].position, sizeof m.surfels[i].position);
            if (i % 2) memcpy(m.surfels[i].normal, m.surfels[i - 1].normal, sizeof m.surfels[i].normal);
            m.radii[i] = m.radii[i - 1];
        }
    const iso_box box = {{0, -16, 0}, {32, 32, 48}};
    const iso_view view = gl_side_view(&box, 1, false, 250, 210);
    m.view.curvatures = m.curvatures;
    if (reconstruction != ISO_RECONSTRUCTION_CURVED) m.view.colors = (const uint8_t(*)[3])m.colors;
    iso_gl_surface *surface = upload(engine, &m.view);
    m.view.colors = NULL; /* the engines choose from those that are alike as they like */
    iso_gbuffer first = gl_gbuffer(&view);
    const iso_gl_pullpush_opts opts = {&view, (const iso_gl_surface *const *)&surface, 1, reconstruction,
                                       ISO_SELECTION_ALL};
    /* (curved by the cpu engine depends on the order of points that are one another's backs) */
    if (reconstruction != ISO_RECONSTRUCTION_CURVED)
        gl_check_pullpush(engine, &m.view, reconstruction, &view, 1, "points that are alike");
    assert_int_equal(iso_gl_draw_pullpush(engine, &opts, &first, NULL), ISO_OK);
    for (int round = 0; round < 10; round++) {
        iso_gbuffer again = gl_gbuffer(&view);
        assert_int_equal(iso_gl_draw_pullpush(engine, &opts, &again, NULL), ISO_OK);
        expect_same(&first, &again);
        iso_gbuffer_free(&again);
    }
    iso_gbuffer_free(&first);
    iso_gl_surface_destroy(surface);
    free_many(&m);
}

static void every_time_is_the_same(iso_gl_engine *engine) {
    check_repeated(engine, ISO_RECONSTRUCTION_GAUSSIAN);
    check_repeated(engine, ISO_RECONSTRUCTION_CURVED);
}

static uint8_t (*some_colors(const iso_point_view *points))[3] {
    size_t end = 0;
    for (size_t s = 0; s < points->span_count; s++)
        if (points->spans[s].first + points->spans[s].count > end)
            end = points->spans[s].first + points->spans[s].count;
    uint8_t(*colors)[3] = calloc(end, sizeof *colors);
    for (size_t i = 0; i < end; i++)
        for (int k = 0; k < 3; k++) colors[i][k] = (uint8_t)(i / 8 * (size_t)(k + 2));
    return colors;
}

/* Several surfaces, one within the other's box; none at all; and one out of sight. One or none of them has
 * colours of its own. */
static void check_surfaces(iso_gl_engine *engine, iso_reconstruction reconstruction) {
    scene s[2] = {make_scene("torus", 40), make_scene("sphere", 40)};
    const iso_view views[2] = {gl_side_view(&s[0].surface.box, 0, false, 200, 190),
                               gl_side_view(&s[0].surface.box, 3, true, 170, 200)};
    for (int colored = 0; colored < 3; colored++) {
        iso_point_view points[2];
        iso_gl_surface *surfaces[2];
        uint8_t(*colors)[3] = NULL;
        for (int i = 0; i < 2; i++) {
            points[i] = iso_point_set_view(s[i].discs[0]);
            if (i == colored) points[i].colors = (const uint8_t(*)[3])(colors = some_colors(&points[i]));
            surfaces[i] = upload(engine, &points[i]);
        }
        for (int v = 0; v < 2; v++)
            for (int count = 0; count <= 2; count++) {
                iso_gbuffer gl = gl_gbuffer(&views[v]), cpu = gl_gbuffer(&views[v]);
                const iso_gl_pullpush_opts opts = {&views[v], (const iso_gl_surface *const *)surfaces, count,
                                                   reconstruction, ISO_SELECTION_ALL};
                assert_int_equal(iso_gl_draw_pullpush(engine, &opts, &gl, NULL), ISO_OK);
                for (int i = 0; i < count; i++) {
                    const iso_point_surface_opts same = {.reconstruction = reconstruction};
                    iso_draw_point_surface(&(iso_target){&views[v], &cpu, NULL, (uint8_t)i, NULL}, &points[i],
                                           &same, NULL);
                }
                gl_difference d = gl_compare(&views[v], &cpu, &gl);
                if (!(d.psnr >= 40 && d.differ <= 0.01 * d.outline))
                    fail_msg(
                        "reconstruction %d, surface %d with colours, view %d, %d surfaces: %.1f dB, %d of %d",
                        (int)reconstruction, colored, v, count, d.psnr, d.differ, d.outline);
                assert_true(count == 0 || d.outline > 0);
                iso_gbuffer_free(&gl);
                iso_gbuffer_free(&cpu);
            }
        for (int i = 0; i < 2; i++) iso_gl_surface_destroy(surfaces[i]);
        free(colors);
    }
    for (int i = 0; i < 2; i++) free_scene(&s[i]);
}

static void surfaces_hide_one_another(iso_gl_engine *engine) {
    check_surfaces(engine, ISO_RECONSTRUCTION_GAUSSIAN);
    check_surfaces(engine, ISO_RECONSTRUCTION_CURVED);
}

/* What pictures are said to take is about what they take, and no more the larger they are. */
static void check_memory(iso_gl_engine *engine, iso_reconstruction reconstruction) {
    const bool curved = reconstruction == ISO_RECONSTRUCTION_CURVED;
    many_points m;
    make_many(&m);
    if (!curved) m.view.colors = (const uint8_t(*)[3])m.colors;
    const iso_box box = {{0, -16, 0}, {32, 32, 48}};
    for (int side = 500; side <= 1000; side += 500) {
        iso_gl_surface *surface = upload(engine, &m.view);
        const iso_view view = gl_side_view(&box, 1, false, side, side);
        const iso_gl_pullpush_opts opts = {&view, (const iso_gl_surface *const *)&surface, 1, reconstruction,
                                           ISO_SELECTION_ALL};
        iso_gbuffer g = gl_gbuffer(&view);
        assert_int_equal(iso_gl_draw_pullpush(engine, &opts, &g, NULL), ISO_OK);
        double taken = 20.0 * sizeof(float) * engine->discs.width * engine->discs.height,
               told = (double)iso_gl_pullpush_bytes(engine, reconstruction, side, side);
        for (int i = 0; i < ISO_GL_STORES; i++)
            if (i != ISO_GL_STORE_BLOCKS) taken += (double)engine->storage_bytes[i];
        if (!(taken < 1.25 * told && taken > 0.8 * told)) fail_msg("%g taken, %g told", taken, told);
        assert_true(iso_gl_pullpush_bytes(engine, reconstruction, 1 << 16, 1 << 16) ==
                    iso_gl_pullpush_bytes(engine, reconstruction, 1 << 17, 1 << 17));
        iso_gbuffer_free(&g);
        iso_gl_surface_destroy(surface);
    }
    free_many(&m);
}

static void memory_of_pyramids_is_told(iso_gl_engine *engine) {
    check_memory(engine, ISO_RECONSTRUCTION_GAUSSIAN);
}

static void memory_of_sums_is_told(iso_gl_engine *engine) {
    check_memory(engine, ISO_RECONSTRUCTION_CURVED);
}

static void what_cannot_be_drawn_is_said(iso_gl_engine *engine) {
    scene s = make_scene("sphere", 24);
    iso_point_view points = iso_point_set_view(s.surface.packed);
    const iso_view view = gl_side_view(&s.surface.box, 0, false, 100, 100);
    iso_gl_surface *surface = upload(engine, &points);
    iso_gbuffer g = gl_gbuffer(&view);
    iso_error error = {ISO_OK, ""};
    engine->max_storage = 1000;
    for (int i = 0; i <= ISO_RECONSTRUCTION_GAUSSIAN; i++) {
        const iso_gl_pullpush_opts opts = {&view, (const iso_gl_surface *const *)&surface, 1,
                                           (iso_reconstruction)i, ISO_SELECTION_ALL};
        assert_int_equal(iso_gl_draw_pullpush(engine, &opts, &g, &error), ISO_ERR_LIMIT);
        assert_non_null(strstr(error.text, "100 pixels wide"));
    }
    iso_gbuffer_free(&g);
    iso_gl_surface_destroy(surface);
    free_scene(&s);
}

/* Points, Gaussian or curved. */
static iso_status draw_by(iso_gl_engine *engine, int method, const iso_view *view, iso_gl_surface *surface,
                          iso_gbuffer *g) {
    const iso_gl_surface *const surfaces[] = {surface};
    const iso_gl_draw_opts points = {.view = view, .surfaces = surfaces, .surface_count = 1};
    const iso_gl_pullpush_opts filled = {
        view, surfaces, 1, method == 1 ? ISO_RECONSTRUCTION_GAUSSIAN : ISO_RECONSTRUCTION_CURVED,
        ISO_SELECTION_VISIBLE};
    return method ? iso_gl_draw_pullpush(engine, &filled, g, NULL) : iso_gl_draw(engine, &points, g, NULL);
}

/* Every pass of a method takes time, and no other's. */
static void passes_are_timed(iso_gl_engine *engine) {
    enum { TIMES = 3 };
    scene s = make_scene("gyroid", 48);
    iso_point_view points = iso_point_set_view(s.discs[0]);
    const iso_view view = gl_side_view(&s.surface.box, 0, false, 400, 400);
    iso_gl_surface *surface = upload(engine, &points);
    iso_gbuffer g = gl_gbuffer(&view);
    double seconds[ISO_GL_PASSES];
    for (int method = 0; method < 3; method++) {
        iso_gl_engine_reset_seconds(engine);
        for (int i = 0; i < TIMES; i++) assert_int_equal(draw_by(engine, method, &view, surface, &g), ISO_OK);
        iso_gl_engine_seconds(engine, seconds);
        printf("%s:", engine->context->name);
        for (int p = 0; p < ISO_GL_PASSES; p++) {
            printf(" %s %.3f ms", iso_gl_pass_name((iso_gl_pass)p), seconds[p] * 1e3 / TIMES);
            bool own = method == (p > ISO_GL_PASS_DRAW) + (p > ISO_GL_PASS_FINISH);
            if (!own) assert_true(seconds[p] == 0);
            if (own && !(seconds[p] > 0 && seconds[p] < 60))
                fail_msg("%s takes %g s", iso_gl_pass_name((iso_gl_pass)p), seconds[p]);
        }
        printf("\n");
    }
    engine->timer.by_clock = false; /* queries are made, whatever this driver's are worth */
    for (int method = 1; method < 3; method++) {
        assert_int_equal(draw_by(engine, method, &view, surface, &g), ISO_OK);
        assert_int_equal(engine->timer.pending, 0);
        assert_true(engine->timer.queries[method == 1 ? 3 : 2] != 0);
    }
    iso_gbuffer_free(&g);
    iso_gl_surface_destroy(surface);
    free_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_each_engine_test(scenes_look_as_from_the_cpu),
        gl_engine_test(near_points_and_limits_do_not_show),
        gl_engine_test(points_have_radii_of_their_own),
        gl_engine_test(points_have_colours_of_their_own),
        gl_engine_test(coloured_discs_look_as_from_the_cpu),
        gl_engine_test(every_time_is_the_same),
        gl_engine_test(updates_are_drawn),
        gl_engine_test(surfaces_hide_one_another),
        gl_engine_test(memory_of_pyramids_is_told),
        gl_engine_test(memory_of_sums_is_told),
        gl_engine_test(what_cannot_be_drawn_is_said),
        gl_engine_test(passes_are_timed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
