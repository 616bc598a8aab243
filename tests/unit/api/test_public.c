/* The public interface: what it gives is what the modules below give, and what it is asked wrongly is an
 * error. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/rgrid.h"
#include "isopoint.h"
#include "render/picture.h"
#include "scene/method.h"

enum { SIDE = 40, VOXELS = SIDE * SIDE * SIDE, PIXELS = 96 };
static const double ISOVALUE = 100;

/* ---- an array to lend: a ball that falls off */

static void fill(float *values, double radius) {
    for (int i = 0; i < VOXELS; i++) {
        double x = i % SIDE - 19.3, y = i / SIDE % SIDE - 20.1, z = i / (SIDE * SIDE) - 18.7;
        values[i] = (float)(ISOVALUE + 10 * (radius - sqrt(x * x + y * y + 1.3 * z * z)));
    }
}

static const iso_transform TRANSFORM = {{-5, 7, 11}, {1, 1, 1.5}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

static iso_volume *lend(float *values) {
    iso_volume *volume = NULL;
    iso_lend_opts opts = {.dims = {SIDE, SIDE, SIDE},
                          .type = ISO_FLOAT32,
                          .data = values,
                          .transform = &TRANSFORM,
                          .threads = 2};
    assert_int_equal(iso_volume_lend(&opts, &volume, NULL), ISO_OK);
    return volume;
}

static iso_surface *surface_of(iso_volume *volume, double isovalue) {
    iso_surface *surface = NULL;
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.isovalue = isovalue}, &surface, NULL),
                     ISO_OK);
    return surface;
}

typedef struct fixture {
    float values[VOXELS];
    iso_volume *volume;
    iso_surface *surface;
} fixture;

static void write_box(fixture *f, const int lo[3], const int hi[3], float value) {
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++) f->values[(z * SIDE + y) * SIDE + x] = value;
    assert_int_equal(iso_volume_changed(f->volume, lo, hi, NULL), ISO_OK);
}

/* A dent in the ball, and a cube in a brick that held no surface. */
static void edit(fixture *f) {
    write_box(f, (const int[3]){12, 0, 10}, (const int[3]){23, 13, 19}, 0);
    write_box(f, (const int[3]){35, 35, 35}, (const int[3]){37, 37, 37}, 300);
}

static int set_up(void **state) {
    fixture *f = calloc(1, sizeof *f);
    fill(f->values, 15);
    f->volume = lend(f->values);
    f->surface = surface_of(f->volume, ISOVALUE);
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    iso_surface_destroy(f->surface);
    iso_volume_destroy(f->volume);
    free(f);
    return 0;
}

static iso_grid private_grid(float *values) {
    iso_grid grid = {0};
    iso_rgrid_desc desc = {
        .dims = {SIDE, SIDE, SIDE}, .type = ISO_FLOAT32, .data = values, .transform = &TRANSFORM};
    assert_int_equal(iso_rgrid_create(&desc, &grid.rgrid, NULL), ISO_OK);
    return grid;
}

/* ---- version, volumes */

static void test_version(void **state) {
    (void)state;
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", ISO_VERSION_MAJOR, ISO_VERSION_MINOR, ISO_VERSION_PATCH);
    assert_string_equal(iso_version(), text);
    assert_string_equal(iso_status_text(ISO_OK), "ok");
    assert_int_equal(iso_status_exit(ISO_ERR_WRITE), 7);
    for (int i = 0; i < ISO_METHODS; i++) {
        iso_method found;
        assert_int_equal(iso_method_find(iso_method_name((iso_method)i), &found, NULL), ISO_OK);
        assert_int_equal(found, i);
    }
    assert_null(iso_method_name((iso_method)ISO_METHODS));
    iso_method old;
    assert_int_equal(iso_method_find("pullpush-gaussian", &old, NULL), ISO_OK);
    assert_int_equal(old, ISO_METHOD_PULLPUSH);
}

static void test_volume(void **state) {
    fixture *f = *state;
    const iso_volume_info *info = iso_volume_describe(f->volume);
    assert_string_equal(info->format, "lent");
    assert_int_equal(info->dims[2], SIDE);
    assert_int_equal(info->type, ISO_FLOAT32);
    assert_true(info->transform.origin[1] == 7 && info->bytes == sizeof f->values);
    assert_true(iso_volume_value(f->volume, 3, 4, 5) == (double)f->values[(5 * SIDE + 4) * SIDE + 3]);
    double isovalue;
    iso_histogram histogram;
    assert_int_equal(iso_volume_suggest(f->volume, &isovalue, NULL), ISO_OK);
    assert_int_equal(iso_volume_histogram(f->volume, &histogram, NULL), ISO_OK);
    assert_true(isovalue > histogram.low && isovalue < histogram.high);
}

static void test_crop(void **state) {
    fixture *f = *state;
    const int lo[3] = {4, 0, 2}, hi[3] = {30, 39, 20}, out[3] = {30, 40, 20};
    iso_volume *volume = lend(f->values);
    assert_int_equal(iso_volume_crop(f->volume, lo, hi, NULL), ISO_ERR_USAGE); /* it has a surface */
    assert_int_equal(iso_volume_crop(volume, lo, out, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_volume_crop(volume, lo, hi, NULL), ISO_OK);
    assert_int_equal(iso_volume_describe(volume)->dims[2], 19);
    assert_true(iso_volume_describe(volume)->transform.origin[2] == 11 + 2 * 1.5);
    assert_true(iso_volume_value(volume, 0, 0, 0) == iso_volume_value(f->volume, 4, 0, 2));
    iso_volume_destroy(volume);
}

static void count_release(void *owner) {
    ++*(int *)owner;
}

static void test_release(void **state) {
    fixture *f = *state;
    int released = 0;
    iso_volume *volume = NULL;
    iso_lend_opts opts = {.dims = {SIDE, SIDE, SIDE},
                          .type = ISO_FLOAT32,
                          .data = f->values,
                          .release = count_release,
                          .owner = &released};
    assert_int_equal(iso_volume_lend(&opts, &volume, NULL), ISO_OK);
    assert_int_equal(released, 0);
    iso_volume_destroy(volume);
    assert_int_equal(released, 1);
    iso_error error = {0};
    iso_lend_opts bad[3] = {opts, opts, opts};
    bad[0].dims[1] = 0;
    bad[1].threads = -1;
    bad[2].data = NULL;
    for (int i = 0; i < 3; i++) {
        assert_int_not_equal(iso_volume_lend(&bad[i], &volume, &error), ISO_OK);
        assert_int_equal(released, 2 + i);
        assert_true(error.text[0] != 0);
    }
}

/* ---- points and meshes */

static void test_points(void **state) {
    fixture *f = *state;
    iso_grid grid = private_grid(f->values);
    iso_points_opts opts = {.isovalue = ISOVALUE};
    iso_point_set *set;
    assert_int_equal(iso_point_set_create(&grid, &opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    size_t count = 0, expected = iso_point_set_stats(set).points;
    assert_int_equal(iso_surface_points(f->surface, NULL, 0, &count, NULL), ISO_OK);
    assert_int_equal(count, expected);
    iso_surface_point *points = calloc(count, sizeof *points);
    assert_int_equal(iso_surface_points(f->surface, points, count - 1, &count, NULL), ISO_ERR_LIMIT);
    assert_true(points[0].radius == 0);
    assert_int_equal(iso_surface_points(f->surface, points, count, &count, NULL), ISO_OK);
    iso_box box;
    assert_int_equal(iso_surface_bounds(f->surface, &box, NULL), ISO_OK);
    for (size_t i = 0; i < count; i++) {
        const float *p = points[i].position, *n = points[i].normal;
        const double x = (double)p[0] + 5 - 19.3, y = (double)p[1] - 7 - 20.1,
                     z = ((double)p[2] - 11) / 1.5 - 18.7;
        assert_true(fabs(sqrt(x * x + y * y + 1.3 * z * z) - 15) < 0.05);
        assert_true((double)n[0] * x + (double)n[1] * y + (double)n[2] * z > 0); /* outwards */
        assert_true((double)p[0] >= box.lo.x - 1e-4 && (double)p[2] <= box.hi.z + 1e-4);
    }
    free(points);
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);
}

static void test_mesh(void **state) {
    fixture *f = *state;
    iso_grid grid = private_grid(f->values);
    iso_mesh_opts opts = {.isovalue = ISOVALUE};
    iso_mesh_set *set;
    assert_int_equal(iso_mesh_set_create(&grid, &opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    iso_mesh_view view = iso_mesh_set_view(set);
    iso_mesh mesh = {0};
    assert_int_equal(iso_surface_mesh(f->surface, &mesh, NULL), ISO_OK);
    assert_int_equal(mesh.triangle_count, iso_mesh_view_triangle_count(&view));
    assert_int_equal(mesh.vertex_count, iso_mesh_view_vertex_count(&view));
    double volume = 0; /* six times what is enclosed */
    for (size_t i = 0; i < mesh.triangle_count; i++) {
        const uint32_t *t = mesh.triangles[i];
        assert_true(t[0] < mesh.vertex_count && t[1] < mesh.vertex_count && t[2] < mesh.vertex_count);
        const float *a = mesh.positions[t[0]], *b = mesh.positions[t[1]], *c = mesh.positions[t[2]];
        volume += (double)a[0] * ((double)b[1] * c[2] - (double)b[2] * c[1]) -
                  (double)a[1] * ((double)b[0] * c[2] - (double)b[2] * c[0]) +
                  (double)a[2] * ((double)b[0] * c[1] - (double)b[1] * c[0]);
    }
    iso_mesh_measures measures;
    assert_int_equal(iso_surface_measure(f->surface, &measures, NULL), ISO_OK);
    assert_int_equal(measures.euler, 2);
    assert_int_equal(measures.open_edges, 0);
    assert_true(fabs(volume / 6 - measures.volume) < 1e-3 * measures.volume);
    iso_mesh_free(&mesh);
    assert_null(mesh.positions);
    iso_mesh_free(&mesh);
    iso_mesh_set_destroy(set);
    iso_grid_destroy(&grid);
}

/* ---- pictures */

typedef struct private_drawing {
    const iso_scene_surface *scene;
    const iso_renderer *renderer;
} private_drawing;

static iso_status draw_privately(void *context, const iso_view *view, iso_gbuffer *gbuffer,
                                 iso_error *error) {
    const private_drawing *d = context;
    iso_target target = {view, gbuffer, NULL, 0, NULL};
    return iso_renderer_draw(d->renderer, d->scene, &target, error);
}

/* What the modules below draw of the array. */
static iso_image render_privately(float *values, iso_method method, int samples) {
    iso_grid grid = private_grid(values);
    iso_scene_surface scene = {.grid = grid, .isovalue = ISOVALUE, .bounded = true};
    const iso_renderer *renderer = iso_renderer_get(method);
    for (int part = 0; part < ISO_PART_COUNT; part++)
        if (renderer->needs & 1u << part)
            assert_int_equal(iso_scene_surface_prepare(&scene, (iso_part)part, NULL), ISO_OK);
    iso_camera camera = {
        .position = {14, -80, 30}, .focal_point = {14, 27, 39}, .view_up = {0, 0, 1}, 30, 0, 0};
    const iso_rgb color = {1, 200, 99};
    private_drawing drawing = {&scene, renderer};
    iso_picture_opts opts = {.camera = &camera,
                             .width = PIXELS,
                             .height = PIXELS / 2,
                             .samples = samples,
                             .shading = {&color, 1, {10, 20, 30}, 0, {0, 0, 0}},
                             .draw = draw_privately,
                             .draw_context = &drawing};
    iso_image image = {0};
    assert_int_equal(iso_image_create(PIXELS, PIXELS / 2, &image, NULL), ISO_OK);
    assert_int_equal(iso_picture_render(&opts, &image, NULL, NULL), ISO_OK);
    iso_scene_surface_free(&scene);
    iso_grid_destroy(&grid);
    return image;
}

static void assert_same(const iso_image *a, const iso_image *b) {
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_memory_equal(a->rgba, b->rgba, (size_t)a->width * (size_t)a->height * 4);
}

/* The picture that render_privately makes; once before and once after an edit. */
static void test_methods(void **state) {
    fixture *f = *state;
    const iso_rgb color = {1, 200, 99}, background = {10, 20, 30};
    const iso_camera camera = {{14, -80, 30}, {14, 27, 39}, {0, 0, 1}, 30, false, 0};
    iso_surface *surface = NULL;
    iso_surface_opts what = {.isovalue = ISOVALUE, .color = &color};
    assert_int_equal(iso_surface_create(f->volume, &what, &surface, NULL), ISO_OK);
    iso_image image = {0};
    for (int edited = 0; edited < 2; edited++) {
        for (int method = 0; method < ISO_METHODS; method++) {
            iso_render_opts opts = {.method = (iso_method)method,
                                    .width = PIXELS,
                                    .height = PIXELS / 2,
                                    .samples = method % 2 ? 4 : 0,
                                    .camera = &camera,
                                    .background = &background};
            iso_image expected = render_privately(f->values, opts.method,
                                                  opts.samples                 ? opts.samples
                                                  : method == ISO_METHOD_EXACT ? 4
                                                                               : 1);
            assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_OK);
            assert_same(&image, &expected);
            iso_image_free(&expected);
        }
        if (!edited) edit(f);
    }
    iso_image_free(&image);
    iso_surface_destroy(surface);
}

static iso_image picture_of(iso_volume *volume, iso_primitive primitive, iso_method method) {
    iso_surface *surface = NULL;
    iso_image image = {0};
    const iso_render_opts opts = {.method = method, .width = PIXELS, .height = PIXELS};
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.primitive = primitive}, &surface, NULL),
                     ISO_OK);
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_OK);
    iso_surface_destroy(surface);
    return image;
}

static size_t count_differing(const iso_image *a, const iso_image *b) {
    size_t differing = 0;
    for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++)
        differing += memcmp(a->rgba + 4 * i, b->rgba + 4 * i, 4) != 0;
    return differing;
}

/* Methods that draw points draw those of the primitive; edge points with AUTO. Others are not concerned. */
static void test_primitives(void **state) {
    fixture *f = *state;
    static const iso_method of_points[] = {ISO_METHOD_POINTS, ISO_METHOD_PULLPUSH, ISO_METHOD_PULLPUSH_BOX,
                                           ISO_METHOD_DISCS,  ISO_METHOD_SPLATS,   ISO_METHOD_SPLATS_FLAT};
    iso_sculpt *sculpt = NULL;
    assert_int_equal(iso_sculpt_from_volume(f->volume, ISOVALUE, NULL, &sculpt, NULL), ISO_OK);
    iso_volume *field = iso_sculpt_volume(sculpt);
    for (size_t m = 0; m < sizeof of_points / sizeof *of_points; m++) {
        iso_image images[4];
        for (int primitive = 0; primitive < 4; primitive++)
            images[primitive] = picture_of(field, (iso_primitive)primitive, of_points[m]);
        assert_same(&images[ISO_PRIMITIVE_AUTO], &images[ISO_PRIMITIVE_EDGE]);
        for (int i = ISO_PRIMITIVE_EDGE; i <= ISO_PRIMITIVE_FOOT_ITERATED; i++)
            for (int j = ISO_PRIMITIVE_EDGE; j < i; j++)
                assert_true(count_differing(&images[i], &images[j]) > 0);
        for (int primitive = 0; primitive < 4; primitive++) iso_image_free(&images[primitive]);
    }
    iso_image edge = picture_of(field, ISO_PRIMITIVE_EDGE, ISO_METHOD_MESH),
              foot = picture_of(field, ISO_PRIMITIVE_FOOT, ISO_METHOD_MESH);
    assert_same(&edge, &foot);
    iso_surface *surface = NULL;
    iso_surface_create(field, &(iso_surface_opts){.primitive = ISO_PRIMITIVE_FOOT}, &surface, NULL);
    const iso_render_opts hybrid = {.method = ISO_METHOD_HYBRID};
    assert_int_equal(iso_render(surface, &hybrid, &foot, NULL), ISO_ERR_USAGE);
    iso_surface_destroy(surface);
    iso_image_free(&edge);
    iso_image_free(&foot);
    iso_sculpt_destroy(sculpt);
}

static void test_following(void **state) {
    fixture *f = *state;
    size_t before, after, expected;
    assert_int_equal(iso_surface_points(f->surface, NULL, 0, &before, NULL), ISO_OK);
    edit(f);
    assert_int_equal(iso_surface_points(f->surface, NULL, 0, &after, NULL), ISO_OK);
    iso_surface *fresh = surface_of(f->volume, ISOVALUE);
    assert_int_equal(iso_surface_points(fresh, NULL, 0, &expected, NULL), ISO_OK);
    assert_int_not_equal(before, after);
    assert_int_equal(after, expected);
    assert_int_equal(iso_surface_set_isovalue(fresh, NAN, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_surface_set_isovalue(fresh, ISOVALUE + 40, NULL), ISO_OK);
    iso_mesh a, b;
    iso_surface *other = surface_of(f->volume, ISOVALUE + 40);
    assert_int_equal(iso_surface_mesh(fresh, &a, NULL), ISO_OK);
    assert_int_equal(iso_surface_mesh(other, &b, NULL), ISO_OK);
    assert_int_equal(a.vertex_count, b.vertex_count);
    assert_memory_equal(a.positions, b.positions, a.vertex_count * sizeof *a.positions);
    iso_mesh_free(&a);
    iso_mesh_free(&b);
    iso_surface_destroy(other);
    iso_surface_destroy(fresh);
}

static void test_picture(void **state) {
    fixture *f = *state;
    iso_aov aov = {0};
    iso_image image = {0}, two = {0};
    iso_surface *inner = surface_of(f->volume, ISOVALUE + 50);
    iso_surface *both[2] = {f->surface, inner};
    iso_render_opts opts = {
        .width = 64, .height = 48, .transparent = true, .aov = &aov, .fit = {.azimuth = 30}};
    assert_int_equal(iso_render(f->surface, &opts, &image, NULL), ISO_OK);
    assert_int_equal(image.rgba[3], 0); /* a corner */
    const size_t middle = 24 * 64 + 32;
    assert_int_equal(image.rgba[4 * middle + 3], 255);
    assert_true(isfinite(aov.depth[middle]) && isinf(aov.depth[0]));
    assert_true(aov.coverage[middle] == 1 && aov.voxel == 1);
    const double length = hypot(hypot((double)aov.normal[0][middle], (double)aov.normal[1][middle]),
                                (double)aov.normal[2][middle]);
    assert_true(fabs(length - 1) < 1e-3);
    /* The inner one is hidden: the same picture but for nothing. */
    opts.aov = NULL;
    assert_int_equal(iso_render_surfaces(both, 2, &opts, &two, NULL), ISO_OK);
    assert_same(&image, &two);
    iso_surface *colors[2] = {inner, f->surface}; /* the palette goes by the place in the picture */
    assert_int_equal(iso_render_surfaces(colors, 2, &opts, &two, NULL), ISO_OK);
    assert_memory_not_equal(image.rgba, two.rgba, 64 * 48 * 4);
    iso_image_free(&image);
    iso_image_free(&two);
    iso_aov_free(&aov);
    iso_surface_destroy(inner);
}

/* Lines and glyphs beside a surface and alone; the arrays may go when the set is made. */
static void test_shapes(void **state) {
    fixture *f = *state;
    iso_box box;
    iso_image with = {0}, without = {0}, alone = {0};
    assert_int_equal(iso_surface_bounds(f->surface, &box, NULL), ISO_OK);
    const float x = (float)box.hi.x + 5, z = (float)box.lo.z;
    float vertices[2][3] = {{x, (float)box.lo.y, z}, {x, (float)box.hi.y, z + 9}}, radii[2] = {1, 2};
    const size_t starts[2] = {0, 2};
    const iso_line_arrays lines = {
        .vertices = vertices[0], .starts = starts, .line_count = 1, .radii = radii};
    const iso_rgb red = {255, 0, 0};
    const iso_shape_set_opts look = {.color = &red, .glyph = ISO_GLYPH_BOX, .radius = 2};
    const iso_glyph_arrays points = {.positions = vertices[0], .count = 2};
    iso_shape_set *sets[2] = {NULL, NULL};
    assert_int_equal(iso_shape_set_of_lines(&lines, &look, &sets[0], NULL), ISO_OK);
    assert_int_equal(iso_shape_set_of_glyphs(&points, &look, &sets[1], NULL), ISO_OK);
    memset(vertices, 0, sizeof vertices);
    memset(radii, 0, sizeof radii);
    const iso_box around = iso_shape_set_bounds(sets[0]);
    assert_true(around.hi.x >= box.hi.x + 7 - 1e-4 && around.lo.z <= box.lo.z - 1 + 1e-4);
    iso_aov aov = {0};
    iso_render_opts opts = {.width = 96, .height = 64, .shapes = sets, .shapes_count = 2, .aov = &aov};
    assert_int_equal(iso_render(f->surface, &opts, &with, NULL), ISO_OK);
    int red_pixels = 0, seen[4] = {0};
    for (int i = 0; i < 96 * 64; i++) {
        const uint8_t *p = with.rgba + 4 * i;
        const bool is_line = aov.ids[0][i] == 2;
        red_pixels += p[0] > p[1] + 50 && p[1] == p[2];
        seen[aov.ids[0][i]]++;
        assert_true(aov.ids[1][i] <= (aov.ids[0][i] == 3 ? 2 : is_line) && aov.ids[2][i] == is_line);
    }
    assert_true(red_pixels > 30);
    for (int i = 0; i < 4; i++) assert_true(seen[i] > 10);
    opts.shapes_count = 0;
    assert_int_equal(iso_render(f->surface, &opts, &without, NULL), ISO_OK);
    assert_null(aov.ids[0]);
    iso_aov_free(&aov);
    opts.aov = NULL;
    opts.shapes_count = 2;
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &alone, NULL), ISO_OK);
    opts.shapes_count = 0;
    assert_memory_not_equal(with.rgba, without.rgba, 96 * 64 * 4);
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &alone, NULL), ISO_ERR_USAGE);
    vertices[1][2] = z + 9; /* a ribbon covers other pixels than the tube, and needs no normals */
    const iso_shape_set_opts flat = {.color = &red, .radius = 2, .ribbons = true};
    iso_shape_set *ribbon = NULL;
    assert_int_equal(iso_shape_set_of_lines(&lines, &flat, &ribbon, NULL), ISO_OK);
    opts.shapes = &ribbon;
    opts.shapes_count = 1;
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &without, NULL), ISO_OK);
    assert_memory_not_equal(alone.rgba, without.rgba, 96 * 64 * 4);
    iso_shape_set_destroy(ribbon);
    opts.shapes_count = 0;
    const iso_shape_set_opts arrow = {.glyph = ISO_GLYPH_ARROW}, thin = {.radius = -1};
    iso_shape_set *none = NULL;
    assert_int_equal(iso_shape_set_of_glyphs(&points, &arrow, &none, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_shape_set_of_glyphs(&points, &thin, &none, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_shape_set_of_glyphs(&(iso_glyph_arrays){.count = 0}, NULL, &none, NULL),
                     ISO_ERR_EMPTY);
    assert_int_equal(iso_shape_set_read_lines("no/such.trk", NULL, &none, NULL), ISO_ERR_IO);
    assert_null(none);
    for (int i = 0; i < 2; i++) iso_shape_set_destroy(sets[i]);
    iso_image_free(&with);
    iso_image_free(&without);
    iso_image_free(&alone);
}

/* A translucent surface over an opaque one, by exact and by the ray caster; depth is that of the first layer.
 */
static void test_layers(void **state) {
    fixture *f = *state;
    iso_image exact = {0}, truth = {0}, opaque = {0};
    iso_aov aov = {0};
    iso_surface *outer = NULL, *inner = surface_of(f->volume, ISOVALUE + 50);
    const iso_surface_opts what = {.isovalue = ISOVALUE, .opacity = 0.4};
    assert_int_equal(iso_surface_create(f->volume, &what, &outer, NULL), ISO_OK);
    iso_surface *both[2] = {outer, inner};
    iso_render_opts opts = {.width = 64, .height = 48, .aov = &aov, .absorption_length = 20};
    assert_int_equal(iso_render_surfaces(both, 2, &opts, &exact, NULL), ISO_OK);
    const size_t middle = 24 * 64 + 32;
    assert_true(aov.layers && aov.layers[middle] == 1 && aov.coverage[middle] == 1);
    const float depth = aov.depth[middle];
    opts.method = ISO_METHOD_RAYCAST;
    assert_int_equal(iso_render_surfaces(both, 2, &opts, &truth, NULL), ISO_OK);
    for (size_t i = 0; i < 4 * 64 * 48; i++) assert_in_range(exact.rgba[i] - truth.rgba[i] + 1, 0, 2);
    opts.method = ISO_METHOD_EXACT;
    assert_int_equal(iso_render(f->surface, &opts, &opaque, NULL), ISO_OK);
    assert_true(!aov.layers && aov.depth[middle] == depth);
    assert_memory_not_equal(exact.rgba, opaque.rgba, 64 * 48 * 4);
    opts.method = ISO_METHOD_MESH;
    assert_int_equal(iso_render(outer, &opts, &opaque, NULL), ISO_ERR_USAGE);
    opts.method = ISO_METHOD_SPLATS;
    assert_int_equal(iso_render(outer, &opts, &opaque, NULL), ISO_ERR_USAGE); /* splats absorb nothing */
    opts.method = ISO_METHOD_EXACT;
    opts.most_layers = 1;
    assert_int_equal(iso_render(outer, &opts, &opaque, NULL), ISO_ERR_USAGE);
    opts.most_layers = 0;
    opts.absorption_length = -1;
    assert_int_equal(iso_render(outer, &opts, &opaque, NULL), ISO_ERR_USAGE);
    iso_image_free(&exact);
    iso_image_free(&truth);
    iso_image_free(&opaque);
    iso_aov_free(&aov);
    iso_surface_destroy(outer);
    iso_surface_destroy(inner);
    const iso_surface_opts bad = {.isovalue = ISOVALUE, .opacity = 1.5};
    assert_int_equal(iso_surface_create(f->volume, &bad, &outer, NULL), ISO_ERR_USAGE);
}

/* Occlusion, a shadow and an outline darken a picture of a ball with a dent, each in its own way; the same
 * ones again. */
static void test_light(void **state) {
    fixture *f = *state;
    iso_image plain = {0}, lit = {0};
    const iso_render_opts bad[] = {{.occlusion = -2}, {.outline = 17}, {.outline = -1}},
                          opts[] = {{.occlusion = ISO_OCCLUSION_USUAL}, {.shadow = true}, {.outline = 1}};
    write_box(f, (int[3]){12, 0, 12}, (int[3]){27, 16, 24}, 0);
    assert_int_equal(iso_render(f->surface, NULL, &plain, NULL), ISO_OK);
    for (int i = 0; i < 6; i++) {
        long darker = 0;
        assert_int_equal(iso_render(f->surface, &opts[i % 3], &lit, NULL), ISO_OK);
        for (size_t at = 0; at < (size_t)4 * 1024 * 1024; at++) darker += lit.rgba[at] < plain.rgba[at];
        assert_true(darker > 1000);
        assert_int_equal(iso_render(f->surface, &bad[i % 3], &lit, NULL), ISO_ERR_USAGE);
    }
    iso_image_free(&plain);
    iso_image_free(&lit);
}

/* ---- comparing */

static void test_compare(void **state) {
    fixture *f = *state;
    iso_image a = {0}, b = {0}, c = {0};
    iso_render_opts opts = {.width = 64, .height = 64};
    assert_int_equal(iso_render(f->surface, &opts, &a, NULL), ISO_OK);
    opts.method = ISO_METHOD_POINTS;
    assert_int_equal(iso_render(f->surface, &opts, &b, NULL), ISO_OK);
    opts.width = 32;
    assert_int_equal(iso_render(f->surface, &opts, &c, NULL), ISO_OK);
    iso_difference same, other;
    assert_int_equal(iso_compare_images(&a, &a, NULL, &same, NULL), ISO_OK);
    assert_true(same.psnr > 138 && same.ssim == 1 && same.flip == 0 && same.iou == 1);
    assert_true(same.pixels_differing == 0 && isnan(same.normal_error_deg));
    assert_int_equal(iso_compare_images(&a, &b, NULL, &other, NULL), ISO_OK);
    assert_true(other.psnr < same.psnr && other.ssim < 1 && other.flip > 0 && other.pixels_differing > 0);
    iso_error error = {0};
    assert_int_equal(iso_compare_images(&a, &c, NULL, &other, &error), ISO_ERR_MISMATCH);
    assert_true(error.text[0] != 0);
    iso_image_free(&a);
    iso_image_free(&b);
    iso_image_free(&c);
}

/* ---- files */

static void test_files(void **state) {
    fixture *f = *state;
    char folder[] = ISO_TEST_TMP "/public.XXXXXX", png[256], ply[256], stl[256], bad[256];
    assert_non_null(mkdtemp(folder));
    snprintf(png, sizeof png, "%s/a.png", folder);
    snprintf(ply, sizeof ply, "%s/a.ply", folder);
    snprintf(stl, sizeof stl, "%s/a.stl", folder);
    snprintf(bad, sizeof bad, "%s/none/a.png", folder);
    iso_image image = {0}, again = {0};
    iso_error error = {0};
    assert_int_equal(iso_render(f->surface, &(iso_render_opts){.width = 40, .height = 30}, &image, NULL),
                     ISO_OK);
    assert_int_equal(iso_image_write(&image, png, NULL), ISO_OK);
    assert_int_equal(iso_image_read(png, &again, NULL), ISO_OK);
    assert_same(&image, &again);
    assert_int_equal(iso_image_write(&image, bad, &error), ISO_ERR_WRITE);
    assert_int_equal(iso_image_read(bad, &again, &error), ISO_ERR_IO);
    assert_int_equal(iso_surface_write_points(f->surface, ply, NULL), ISO_OK);
    assert_int_equal(iso_surface_write_mesh(f->surface, stl, NULL), ISO_OK);
    assert_int_equal(iso_surface_write_mesh(f->surface, png, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_volume_write_vdb(f->volume, bad, NULL, &error), ISO_ERR_USAGE);
    assert_int_equal(access(stl, R_OK), 0);
    iso_image_free(&image);
    iso_image_free(&again);
    unlink(png);
    unlink(ply);
    unlink(stl);
    assert_int_equal(rmdir(folder), 0);
}

/* ---- sculpting */

static void stroke(iso_sculpt *sculpt, iso_tool tool, double y) {
    iso_brush brush = {.tool = tool, .radius = 6};
    iso_sample sample = {.position = {-10, y, 15}, .normal = {0, 0, 1}, .pressure = 1};
    iso_edit_stats stats = {0};
    assert_int_equal(iso_sculpt_begin(sculpt, &brush, &sample, &stats, NULL), ISO_OK);
    for (int i = 0; i < 6; i++) {
        sample.position.x += 3;
        assert_int_equal(iso_sculpt_sample(sculpt, &sample, &stats, NULL), ISO_OK);
    }
    assert_int_equal(iso_sculpt_end(sculpt, NULL), ISO_OK);
    assert_true(stats.edited > 0);
}

static void assert_same_fields(iso_sculpt *a, iso_sculpt *b) {
    iso_volume *from = iso_sculpt_volume(a), *to = iso_sculpt_volume(b);
    const int *dims = iso_volume_describe(from)->dims;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                assert_true(iso_volume_value(from, x, y, z) == iso_volume_value(to, x, y, z));
}

static size_t count_points(iso_surface *surface) {
    size_t count;
    assert_int_equal(iso_surface_points(surface, NULL, 0, &count, NULL), ISO_OK);
    return count;
}

static void test_sculpt(void **state) {
    (void)state;
    char folder[] = ISO_TEST_TMP "/public.XXXXXX", path[256];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.strokes", folder);
    iso_sculpt *sculpt, *again;
    iso_sculpt_opts opts = {.dims = {64, 64, 64}, .journal = path};
    assert_int_equal(iso_sculpt_create(&opts, &sculpt, NULL), ISO_OK);
    assert_int_equal(iso_sculpt_create(&opts, &again, NULL), ISO_ERR_WRITE); /* the journal is there */
    iso_surface *surface = surface_of(iso_sculpt_volume(sculpt), 0);
    const size_t ball = count_points(surface);
    stroke(sculpt, ISO_TOOL_ADD, 0);
    const size_t one = count_points(surface);
    stroke(sculpt, ISO_TOOL_CARVE, 4);
    const size_t two = count_points(surface);
    assert_true(ball != one && one != two);
    assert_int_equal(iso_sculpt_undo_count(sculpt), 2);
    assert_int_equal(iso_sculpt_undo(sculpt, NULL), ISO_OK);
    assert_int_equal(count_points(surface), one);
    assert_int_equal(iso_sculpt_redo_count(sculpt), 1);
    assert_int_equal(iso_sculpt_redo(sculpt, NULL), ISO_OK);
    assert_int_equal(count_points(surface), two);
    assert_int_equal(iso_sculpt_redo(sculpt, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_sculpt_end(sculpt, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_sculpt_journal_status(sculpt, NULL), ISO_OK);
    /* Read only, then gone on with. */
    iso_surface_destroy(surface);
    iso_sculpt *kept = sculpt;
    opts.journal = NULL;
    assert_int_equal(iso_sculpt_create(&opts, &sculpt, NULL), ISO_OK);
    stroke(sculpt, ISO_TOOL_ADD, 0);
    stroke(sculpt, ISO_TOOL_CARVE, 4);
    iso_sculpt_destroy(kept);
    assert_int_equal(iso_sculpt_replay(path, NULL, &again, NULL), ISO_OK);
    assert_same_fields(sculpt, again);
    iso_sculpt_destroy(again);
    assert_int_equal(iso_sculpt_resume(path, NULL, &again, NULL), ISO_OK);
    stroke(again, ISO_TOOL_INFLATE, -4);
    stroke(sculpt, ISO_TOOL_INFLATE, -4);
    iso_sculpt_destroy(again);
    assert_int_equal(iso_sculpt_replay(path, NULL, &again, NULL), ISO_OK);
    assert_same_fields(sculpt, again);
    iso_volume_destroy(iso_sculpt_volume(again)); /* a sculpt's volume is not the caller's */
    iso_sculpt_destroy(again);
    iso_sculpt_destroy(sculpt);
    unlink(path);
    assert_int_equal(rmdir(folder), 0);
}

static void test_sculpt_from_volume(void **state) {
    fixture *f = *state;
    iso_sculpt *sculpt;
    assert_int_equal(iso_sculpt_from_volume(f->volume, ISOVALUE, NULL, &sculpt, NULL), ISO_OK);
    const iso_volume_info *info = iso_volume_describe(iso_sculpt_volume(sculpt));
    assert_true(info->level_set && info->sparse && info->transform.spacing[2] == 1);
    iso_surface *surface = surface_of(iso_sculpt_volume(sculpt), 0);
    iso_mesh_measures of_volume, of_field;
    assert_int_equal(iso_surface_measure(f->surface, &of_volume, NULL), ISO_OK);
    assert_int_equal(iso_surface_measure(surface, &of_field, NULL), ISO_OK);
    assert_true(fabs(of_field.volume / of_volume.volume - 1) < 0.01);
    iso_sample sample = {.position = {14, 27, 60}, .normal = {0, 0, 1}, .pressure = 1};
    iso_brush brush = {.radius = 6};
    assert_int_equal(iso_sculpt_begin(sculpt, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_sculpt_cancel(sculpt, NULL), ISO_OK);
    const int lo[3] = {0, 0, 0};
    assert_int_equal(iso_volume_changed(iso_sculpt_volume(sculpt), lo, lo, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_volume_crop(iso_sculpt_volume(sculpt), lo, lo, NULL), ISO_ERR_USAGE);
    iso_surface_destroy(surface);
    iso_sculpt_destroy(sculpt);
    iso_sculpt_opts opts = {.journal = "x"};
    assert_int_equal(iso_sculpt_from_volume(f->volume, ISOVALUE, &opts, &sculpt, NULL), ISO_ERR_UNSUPPORTED);
    assert_int_equal(iso_sculpt_from_volume(f->volume, 1e6, NULL, &sculpt, NULL), ISO_ERR_EMPTY);
}

/* ---- errors */

static void test_errors(void **state) {
    fixture *f = *state;
    iso_error error = {0};
    iso_volume *volume = NULL;
    iso_surface *surface = NULL;
    iso_sculpt *sculpt = NULL;
    iso_image image = {0};
    iso_volume_info info;
    assert_int_equal(iso_volume_open(NULL, NULL, &volume, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_volume_open("none.nrrd", NULL, &volume, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "none.nrrd"));
    assert_int_equal(iso_volume_open("none.nrrd", &(iso_open_opts){.threads = 5000}, &volume, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_volume_open("none.nrrd", &(iso_open_opts){.level = -1}, &volume, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_volume_inspect("none.nrrd", NULL, &info, NULL), ISO_ERR_IO);
    assert_int_equal(iso_volume_inspect("none.nrrd", &(iso_open_opts){.level = -1}, &info, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_volume_lend(NULL, &volume, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_surface_create(f->volume, &(iso_surface_opts){.isovalue = NAN}, &surface, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(
        iso_surface_create(f->volume, &(iso_surface_opts){.primitive = ISO_PRIMITIVE_FOOT}, &surface, NULL),
        ISO_ERR_USAGE);
    const iso_camera blind = {.view_angle = 30};
    const iso_render_opts bad[] = {{.method = (iso_method)99},   {.width = -1},
                                   {.width = ISO_IMAGE_MAX + 1}, {.samples = 3},
                                   {.fit = {.zoom = -1}},        {.fit = {.azimuth = NAN}},
                                   {.fit = {.view_angle = 180}}, {.camera = &blind}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(iso_render(f->surface, &bad[i], &image, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_render_surfaces(NULL, 0, NULL, &image, NULL), ISO_ERR_USAGE);
    iso_surface *nothing = surface_of(f->volume, 1e6);
    assert_int_equal(iso_render(nothing, NULL, &image, &error), ISO_ERR_EMPTY);
    iso_mesh mesh;
    assert_int_equal(iso_surface_mesh(nothing, &mesh, NULL), ISO_OK);
    assert_int_equal(mesh.triangle_count, 0);
    iso_mesh_free(&mesh);
    iso_box box;
    assert_int_equal(iso_surface_bounds(nothing, &box, NULL), ISO_ERR_EMPTY);
    assert_int_equal(iso_surface_write_mesh(nothing, "none.stl", NULL), ISO_ERR_EMPTY);
    iso_surface_destroy(nothing);
    assert_int_equal(iso_sculpt_replay(NULL, NULL, &sculpt, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_sculpt_replay("none.strokes", NULL, &sculpt, NULL), ISO_ERR_IO);
    assert_int_equal(iso_sculpt_create(&(iso_sculpt_opts){.voxel_size = -1}, &sculpt, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_sculpt_create(&(iso_sculpt_opts){.dims = {5000}}, &sculpt, NULL), ISO_ERR_LIMIT);
    assert_null(volume);
    assert_null(surface);
    assert_null(sculpt);
    iso_image_free(&image);
    iso_volume_destroy(NULL);
    iso_surface_destroy(NULL);
    iso_sculpt_destroy(NULL);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_version),
                                       TEST(test_volume),
                                       TEST(test_crop),
                                       TEST(test_release),
                                       TEST(test_points),
                                       TEST(test_mesh),
                                       TEST(test_methods),
                                       TEST(test_primitives),
                                       TEST(test_following),
                                       TEST(test_picture),
                                       TEST(test_shapes),
                                       TEST(test_layers),
                                       TEST(test_light),
                                       TEST(test_compare),
                                       TEST(test_files),
                                       cmocka_unit_test(test_sculpt),
                                       TEST(test_sculpt_from_volume),
                                       TEST(test_errors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
