/* Translucent sets of shapes, and sets of vectors and tensors, through the public interface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isopoint.h"

/* ---- translucent shapes */

enum { SIDE = 24 };

/* A ball of radius 8 in the middle of a volume, whose isovalue is 0. */
static iso_volume *lend_ball(void) {
    static float values[SIDE * SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const double x = i % SIDE - 11.5, y = i / SIDE % SIDE - 11.5, z = i / (SIDE * SIDE) - 11.5;
        values[i] = (float)(8 - sqrt(x * x + y * y + z * z));
    }
    iso_volume *volume = NULL;
    const iso_lend_opts opts = {.dims = {SIDE, SIDE, SIDE}, .type = ISO_FLOAT32, .data = values};
    assert_int_equal(iso_volume_lend(&opts, &volume, NULL), ISO_OK);
    return volume;
}

/* A translucent sphere has two layers; in front of a surface its colour and the surface's are mixed. Depth
 * and ids are the surface's. */
static void test_translucent_shapes(void **state) {
    (void)state;
    iso_box box;
    iso_image alone = {0}, both = {0}, plain = {0};
    iso_aov aov = {0};
    iso_volume *volume = lend_ball();
    iso_surface *surface = NULL;
    const iso_rgb sand = {217, 179, 108};
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.color = &sand}, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_bounds(surface, &box, NULL), ISO_OK);
    const float position[1][3] = {{(float)(box.lo.x + box.hi.x) / 2, (float)box.lo.y - 20,
                                   (float)(box.lo.z + box.hi.z) / 2}}; /* in front */
    const iso_glyph_arrays points = {.positions = position[0], .count = 1};
    const iso_rgb red = {255, 0, 0};
    iso_shape_set *set = NULL;
    const iso_shape_set_opts look = {.color = &red, .radius = 8, .opacity = 0.5};
    assert_int_equal(iso_shape_set_of_glyphs(&points, &look, &set, NULL), ISO_OK);
    iso_render_opts opts = {.width = 64,
                            .height = 48,
                            .shapes = &set,
                            .shapes_count = 1,
                            .transparent = true,
                            .constant_opacity = true};
    const size_t middle = 24 * 64 + 32;
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &alone, NULL), ISO_OK);
    assert_in_range(alone.rgba[4 * middle + 3], 190, 192); /* two layers stop 3/4 of the light */
    opts.most_layers = 1;
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &alone, NULL), ISO_OK);
    assert_in_range(alone.rgba[4 * middle + 3], 127, 128);
    opts.most_layers = 0;
    opts.aov = &aov;
    assert_int_equal(iso_render(surface, &opts, &both, NULL), ISO_OK);
    assert_true(aov.layers && aov.layers[middle] == 2 && aov.ids[0][middle] == 1);
    opts.shapes_count = 0;
    assert_int_equal(iso_render(surface, &opts, &plain, NULL), ISO_OK);
    const uint8_t *mixed = both.rgba + 4 * middle, *own = plain.rgba + 4 * middle;
    assert_true(mixed[0] > mixed[1] + 60 && mixed[1] >= own[1] / 4 && mixed[1] < own[1]);
    opts.shapes_count = 1;
    opts.method = ISO_METHOD_MESH;
    assert_int_equal(iso_render(surface, &opts, &both, NULL), ISO_ERR_USAGE);
    iso_shape_set_destroy(set);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
    iso_aov_free(&aov);
    iso_image_free(&alone);
    iso_image_free(&both);
    iso_image_free(&plain);
    const iso_shape_set_opts bad = {.radius = 1, .opacity = 1.5};
    assert_int_equal(iso_shape_set_of_glyphs(&points, &bad, &set, NULL), ISO_ERR_USAGE);
}

/* Two touching balls in a translucent one: occlusion darkens them where they meet, and nothing else. */
static void test_occluded_shapes(void **state) {
    (void)state;
    iso_box box;
    iso_image plain = {0}, lit = {0};
    iso_volume *volume = lend_ball();
    iso_surface *surface = NULL;
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.opacity = 0.3}, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_bounds(surface, &box, NULL), ISO_OK);
    const float r = (float)(box.hi.x - box.lo.x) / 8, x = (float)(box.lo.x + box.hi.x) / 2,
                y = (float)(box.lo.y + box.hi.y) / 2, z = (float)(box.lo.z + box.hi.z) / 2;
    const float positions[2][3] = {{x - r, y, z}, {x + r, y, z}};
    const iso_glyph_arrays points = {.positions = positions[0], .count = 2};
    iso_shape_set *set = NULL;
    assert_int_equal(iso_shape_set_of_glyphs(&points, &(iso_shape_set_opts){.radius = (double)r}, &set, NULL),
                     ISO_OK);
    iso_render_opts opts = {.width = 128, .height = 128, .shapes = &set, .shapes_count = 1};
    assert_int_equal(iso_render(surface, &opts, &plain, NULL), ISO_OK);
    opts.occlusion = 4 * (double)r;
    assert_int_equal(iso_render(surface, &opts, &lit, NULL), ISO_OK);
    size_t darker = 0;
    for (size_t i = 0; i < (size_t)4 * 128 * 128; i++) {
        darker += lit.rgba[i] < plain.rgba[i];
        assert_true(lit.rgba[i] <= plain.rgba[i]);
    }
    assert_true(darker > 300);
    opts.outline = 1;
    assert_int_equal(iso_render(surface, &opts, &lit, NULL), ISO_ERR_USAGE);
    opts = (iso_render_opts){.method = ISO_METHOD_SPLATS, .occlusion = 4};
    assert_int_equal(iso_render(surface, &opts, &lit, NULL), ISO_ERR_USAGE);
    iso_shape_set_destroy(set);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
    iso_image_free(&plain);
    iso_image_free(&lit);
}

/* ---- meshes */

static size_t differing(const iso_image *a, const iso_image *b) {
    size_t count = 0;
    for (size_t i = 0; i < (size_t)a->width * (size_t)a->height; i++)
        count += memcmp(a->rgba + 4 * i, b->rgba + 4 * i, 4) != 0;
    return count;
}

/* The mesh of a surface, as a set of triangles: of arrays and of a file the same picture, with the outline of
 * the surface by the method MESH; translucent, it has two layers. */
static void test_mesh(void **state) {
    (void)state;
    iso_volume *volume = lend_ball();
    iso_surface *surface = NULL;
    iso_mesh mesh = {0};
    iso_shape_set *sets[2] = {NULL, NULL}, *glass = NULL, *none = NULL;
    iso_image images[3] = {{0}, {0}, {0}};
    iso_aov aov = {0};
    const char *path = ISO_TEST_TMP "/public_shapes.stl";
    const iso_rgb red = {255, 0, 0};
    iso_shape_set_opts look = {.color = &red};
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.color = &red}, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_mesh(surface, &mesh, NULL), ISO_OK);
    assert_int_equal(iso_surface_write_mesh(surface, path, NULL), ISO_OK);
    assert_int_equal(iso_shape_set_of_mesh(&mesh, &look, &sets[0], NULL), ISO_OK);
    assert_int_equal(iso_shape_set_read_mesh(path, &look, &sets[1], NULL), ISO_OK);
    iso_render_opts opts = {.width = 64, .height = 48, .method = ISO_METHOD_MESH, .transparent = true};
    const size_t middle = 24 * 64 + 32;
    assert_int_equal(iso_render(surface, &opts, &images[2], NULL), ISO_OK);
    for (int i = 0; i < 2; i++) {
        opts.shapes = &sets[i];
        opts.shapes_count = 1;
        opts.aov = i ? &aov : NULL;
        assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &images[i], NULL), ISO_OK);
    }
    assert_int_equal(differing(&images[0], &images[1]), 0);
    for (size_t i = 3; i < 4 * 64 * 48; i += 4) assert_int_equal(images[0].rgba[i], images[2].rgba[i]);
    assert_true(aov.ids[0][middle] == 1 && aov.ids[1][middle] >= 1 &&
                aov.ids[1][middle] <= mesh.triangle_count && aov.ids[0][0] == 0);
    look.opacity = 0.5;
    assert_int_equal(iso_shape_set_of_mesh(&mesh, &look, &glass, NULL), ISO_OK);
    opts = (iso_render_opts){.width = 64,
                             .height = 48,
                             .shapes = &glass,
                             .shapes_count = 1,
                             .transparent = true,
                             .constant_opacity = true};
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &images[0], NULL), ISO_OK);
    assert_in_range(images[0].rgba[4 * middle + 3], 190, 192);
    iso_mesh bad = mesh;
    bad.vertex_count = 5;
    assert_int_equal(iso_shape_set_of_mesh(&bad, NULL, &none, NULL), ISO_ERR_USAGE);
    bad = (iso_mesh){.positions = mesh.positions, .vertex_count = mesh.vertex_count};
    assert_int_equal(iso_shape_set_of_mesh(&bad, NULL, &none, NULL), ISO_ERR_EMPTY);
    mesh.positions[3][1] = NAN;
    assert_int_equal(iso_shape_set_of_mesh(&mesh, NULL, &none, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_shape_set_read_mesh(ISO_TEST_TMP "/absent.stl", NULL, &none, NULL), ISO_ERR_IO);
    assert_null(none);
    for (int i = 0; i < 3; i++) iso_image_free(&images[i]);
    iso_aov_free(&aov);
    iso_mesh_free(&mesh);
    iso_shape_set_destroy(sets[0]);
    iso_shape_set_destroy(sets[1]);
    iso_shape_set_destroy(glass);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
}

/* A ball cut in half by a plane: with a cap the same pixels are covered, and the cap is flat; what is cut
 * away shows what lies behind it. */
static void test_cuts(void **state) {
    (void)state;
    iso_volume *volume = lend_ball();
    iso_surface *surface = NULL;
    iso_shape_set *set = NULL;
    iso_mesh mesh = {0};
    iso_image whole = {0}, cut = {0};
    iso_aov aov = {0};
    const char *half[] = {"y<11.5"}, *named[] = {"y<11.5@2"}, *wrong[] = {"y=3"}, *absent[] = {"x<1@3"};
    const size_t middle = 24 * 64 + 32;
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){0}, &surface, NULL), ISO_OK);
    iso_render_opts opts = {.width = 64, .height = 48, .transparent = true, .samples = 1, .aov = &aov};
    assert_int_equal(iso_render(surface, &opts, &whole, NULL), ISO_OK);
    const float front = aov.depth[middle];
    opts.clips = half;
    opts.clip_count = 1;
    assert_int_equal(iso_render(surface, &opts, &cut, NULL), ISO_OK);
    assert_true(fabsf(aov.depth[middle] - front - 16) < 0.1f); /* the ball's far side, from inside */
    opts.cap = ISO_CUT_CAP_SLICE;
    opts.cap_values[1] = 8;
    assert_int_equal(iso_render(surface, &opts, &cut, NULL), ISO_OK);
    assert_true(fabsf(aov.depth[middle] - front - 8) < 0.1f);
    assert_in_range(cut.rgba[4 * middle], 225, 230); /* at the centre, between voxels of 8 - sqrt(3 / 4) */
    opts.method = ISO_METHOD_RAYCAST;
    iso_image truth = {0};
    assert_int_equal(iso_render(surface, &opts, &truth, NULL), ISO_OK);
    assert_true(differing(&cut, &truth) <= 2);
    iso_image_free(&truth);
    opts.method = ISO_METHOD_EXACT;
    assert_int_equal(iso_surface_mesh(surface, &mesh, NULL), ISO_OK);
    assert_int_equal(iso_shape_set_of_mesh(&mesh, NULL, &set, NULL), ISO_OK);
    opts.cap = ISO_CUT_CAP_NONE;
    opts.clips = named;
    opts.shapes = &set;
    opts.shapes_count = 1;
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &cut, NULL), ISO_ERR_USAGE); /* the set is @1 */
    named[0] = "y<11.5@1";
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &cut, NULL), ISO_OK);
    assert_true(fabsf(aov.depth[middle] - front - 16) < 0.2f);
    opts.shapes_count = 0;
    opts.clips = wrong;
    assert_int_equal(iso_render(surface, &opts, &cut, NULL), ISO_ERR_USAGE);
    opts.clips = absent;
    assert_int_equal(iso_render(surface, &opts, &cut, NULL), ISO_ERR_USAGE);
    opts.clips = half;
    opts.method = ISO_METHOD_POINTS;
    assert_int_equal(iso_render(surface, &opts, &cut, NULL), ISO_ERR_USAGE);
    opts = (iso_render_opts){.width = 64, .height = 48, .transparent = true, .samples = 1};
    assert_int_equal(iso_render(surface, &opts, &cut, NULL), ISO_OK); /* nothing is left of the cut */
    assert_int_equal(differing(&cut, &whole), 0);
    iso_image_free(&whole);
    iso_image_free(&cut);
    iso_aov_free(&aov);
    iso_mesh_free(&mesh);
    iso_shape_set_destroy(set);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
}

/* Only the corners that the marks stand in change; a perspective camera has no scale. */
static void test_annotations(void **state) {
    (void)state;
    iso_image image = {0}, plain = {0};
    const iso_box box = {{0, 0, 0}, {20, 20, 20}};
    iso_camera camera;
    assert_int_equal(iso_camera_of_box(&box, 200, 200, &(iso_fit_opts){.orthographic = true}, &camera, NULL),
                     ISO_OK);
    for (int i = 0; i < 2; i++) {
        iso_image *made = i ? &plain : &image;
        assert_int_equal(iso_image_create(200, 200, made, NULL), ISO_OK);
        memset(made->rgba, 255, 4 * 200 * 200);
    }
    iso_annotation_opts opts = {.camera = &camera, .scale_bar = true};
    assert_int_equal(iso_image_annotate(&image, &opts, NULL), ISO_OK);
    size_t right = 0, other = 0;
    for (int y = 0; y < 200; y++)
        for (int x = 0; x < 200; x++)
            if (memcmp(image.rgba + 4 * (200 * y + x), plain.rgba + 4 * (200 * y + x), 4) != 0)
                *(x > 100 && y > 150 ? &right : &other) += 1;
    assert_true(right > 60 && !other);
    camera.orthographic = false;
    assert_int_equal(iso_image_annotate(&plain, &opts, NULL), ISO_OK);
    for (size_t i = 0; i < 4 * 200 * 200; i++) assert_int_equal(plain.rgba[i], 255);
    opts = (iso_annotation_opts){.camera = &camera, .orientation_marker = true, .anatomical = true};
    assert_int_equal(iso_image_annotate(&plain, &opts, NULL), ISO_OK);
    assert_true(differing(&plain, &image) > 60);
    opts.camera = NULL;
    assert_int_equal(iso_image_annotate(&plain, &opts, NULL), ISO_ERR_USAGE);
    iso_image_free(&image);
    iso_image_free(&plain);
}

/* Notes and a legend change the picture where they are; a page has them as text, and the picture stays. */
static void test_figures(void **state) {
    (void)state;
    iso_image image = {0}, plain = {0};
    const iso_box box = {{0, 0, 0}, {20, 20, 20}};
    iso_camera camera;
    iso_error error;
    assert_int_equal(iso_camera_of_box(&box, 200, 200, &(iso_fit_opts){.orthographic = true}, &camera, NULL),
                     ISO_OK);
    for (int i = 0; i < 2; i++) {
        iso_image *made = i ? &plain : &image;
        assert_int_equal(iso_image_create(200, 200, made, NULL), ISO_OK);
        memset(made->rgba, 255, 4 * 200 * 200);
    }
    iso_note notes[] = {{.kind = ISO_NOTE_TEXT, .to = {.at = {0.5, 0.1}}, .text = "Probe 3 \u00b5m"},
                        {.kind = ISO_NOTE_ARROW, .to = {true, {10, 10, 10}}, .text = "middle"},
                        {.kind = ISO_NOTE_RULER, .from = {true, {0, 0, 0}}, .to = {true, {20, 0, 0}}}};
    const iso_legend_entry entry = {"red", {255, 0, 0}};
    iso_figure_opts opts = {.marks = {.camera = &camera},
                            .font_size = 8,
                            .dpi = 144,
                            .notes = notes,
                            .note_count = 3,
                            .legend = &entry,
                            .legend_count = 1};
    assert_int_equal(iso_figure_write(&image, &opts, ISO_TEST_TMP "/figure.svg", &error), ISO_OK);
    assert_int_equal(iso_figure_write(&image, &opts, ISO_TEST_TMP "/figure.pdf", &error), ISO_OK);
    assert_int_equal(differing(&image, &plain), 0);
    FILE *file = fopen(ISO_TEST_TMP "/figure.svg", "r");
    char line[4096];
    int found = 0;
    while (file && fgets(line, sizeof line, file))
        found += strstr(line, ">Probe 3 \u00b5m</text>") || strstr(line, ">middle</text>") ||
                 strstr(line, ">red</text>") || strstr(line, ">20 mm</text>") ||
                 strstr(line, "width=\"100pt\"");
    assert_int_equal(found, 5);
    fclose(file);
    assert_int_equal(iso_figure_paint(&image, &opts, &error), ISO_OK);
    assert_true(differing(&image, &plain) > 300);
    assert_int_equal(iso_figure_write(&image, &opts, ISO_TEST_TMP "/figure.gif", &error), ISO_ERR_USAGE);
    notes[0].text = "\u05e9\u05dc\u05d5\u05dd"; /* from right to left */
    assert_int_equal(iso_figure_paint(&image, &opts, &error), ISO_ERR_USAGE);
    notes[0].text = "plain";
    notes[2].to.in_world = false;
    assert_int_equal(iso_figure_paint(&image, &opts, &error), ISO_ERR_USAGE);
    iso_image_free(&image);
    iso_image_free(&plain);
}

/* ---- fields */

enum { FIELD_SIDE = 4, FIELD_VOXELS = FIELD_SIDE * FIELD_SIDE * FIELD_SIDE };

/* Writes the field as a .mha file of three channels. */
static void write_field(const iso_vector_array *field, const char *path) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file,
            "ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\nElementSpacing = 2 2 2\n"
            "ElementNumberOfChannels = 3\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n",
            field->dims[0], field->dims[1], field->dims[2]);
    assert_int_equal(fwrite(field->values, sizeof *field->values, 3 * FIELD_VOXELS, file), 3 * FIELD_VOXELS);
    assert_int_equal(fclose(file), 0);
}

static void check_box(const iso_shape_set *set, iso_vec3 lo, iso_vec3 hi) {
    const iso_box box = iso_shape_set_bounds(set);
    const double got[6] = {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z},
                 wanted[6] = {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z};
    for (int i = 0; i < 6; i++)
        if (!(fabs(got[i] - wanted[i]) < 0.02)) fail_msg("number %d: %g, not %g", i, got[i], wanted[i]);
}

/* Cylinders along the vectors of a constant field, lines along them, ellipsoids of equal tensors; the same
 * from a file. */
static void test_fields(void **state) {
    (void)state;
    static float vectors[FIELD_VOXELS][3], tensors[FIELD_VOXELS][6];
    for (int i = 0; i < FIELD_VOXELS; i++) {
        vectors[i][2] = 5;
        tensors[i][0] = tensors[i][3] = tensors[i][5] = 3;
    }
    const iso_transform spaced = {.spacing = {2, 2, 2}, .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    iso_vector_array field = {
        .values = vectors[0], .dims = {FIELD_SIDE, FIELD_SIDE, FIELD_SIDE}, .transform = &spaced};
    iso_shape_set *set = NULL, *read = NULL;
    const iso_vector_shape_opts all = {.every = 1}, lines = {.streamlines = 40};
    const iso_shape_set_opts discs = {.glyph = ISO_GLYPH_DISC, .radius = 0.5}, thin = {.radius = 0.1};
    assert_int_equal(iso_shape_set_of_vectors(&field, &all, &discs, &set, NULL), ISO_OK);
    check_box(set, (iso_vec3){-0.5, -0.5, -0.5}, (iso_vec3){6.5, 6.5, 6.5});
    iso_shape_set_destroy(set);
    assert_int_equal(iso_shape_set_of_vectors(&field, &lines, &thin, &set, NULL), ISO_OK);
    const iso_box box = iso_shape_set_bounds(set);
    assert_true(box.lo.z < 0.5 && box.hi.z > 5.5 && box.lo.x > -0.2 && box.hi.x < 6.2);
    write_field(&field, "api_field.mha");
    assert_int_equal(iso_shape_set_read_vectors("api_field.mha", &lines, &thin, &read, NULL), ISO_OK);
    iso_shape_set *both[2] = {set, read};
    iso_image pictures[2] = {{0}, {0}};
    for (int i = 0; i < 2; i++) {
        const iso_render_opts opts = {.width = 64, .height = 64, .shapes = &both[i], .shapes_count = 1};
        assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &pictures[i], NULL), ISO_OK);
    }
    assert_memory_equal(pictures[0].rgba, pictures[1].rgba, 4 * 64 * 64);
    for (int i = 0; i < 2; i++) {
        iso_image_free(&pictures[i]);
        iso_shape_set_destroy(both[i]);
    }
    assert_int_equal(iso_shape_set_read_vectors("api_field.mha", NULL, NULL, &read, NULL),
                     ISO_OK); /* arrows */
    iso_shape_set_destroy(read);
    remove("api_field.mha");
    field.values = tensors[0];
    field.components = 6;
    assert_int_equal(iso_shape_set_of_vectors(&field, &all, NULL, &set, NULL), ISO_OK);
    check_box(set, (iso_vec3){-1.73, -1.73, -1.73}, (iso_vec3){7.73, 7.73, 7.73}); /* boxes of reaches */
    iso_shape_set_destroy(set);
    assert_int_equal(iso_shape_set_of_vectors(&field, &lines, NULL, &set, NULL), ISO_ERR_USAGE);
}

static void test_field_errors(void **state) {
    (void)state;
    static const float zeros[3 * FIELD_VOXELS];
    const iso_transform flat = {.spacing = {1, 0, 1}, .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const iso_vector_array good = {.values = zeros, .dims = {FIELD_SIDE, FIELD_SIDE, FIELD_SIDE}};
    iso_vector_array bad[4] = {good, good, good, good};
    bad[0].components = 4;
    bad[1].values = NULL;
    bad[2].dims[1] = 0;
    bad[3].transform = &flat;
    iso_shape_set *none = NULL;
    iso_error error = {0};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(iso_shape_set_of_vectors(&bad[i], NULL, NULL, &none, &error), ISO_ERR_USAGE);
        assert_true(error.text[0] && !strchr(error.text, '\n'));
    }
    const iso_vector_shape_opts wrong[4] = {
        {.least = NAN}, {.scale = -1}, {.every = -1}, {.streamlines = -2}};
    for (int i = 0; i < 4; i++)
        assert_int_equal(iso_shape_set_of_vectors(&good, &wrong[i], NULL, &none, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_shape_set_of_vectors(&good, NULL, NULL, &none, NULL), ISO_ERR_EMPTY);
    assert_int_equal(
        iso_shape_set_of_vectors(&good, &(iso_vector_shape_opts){.streamlines = 1}, NULL, &none, NULL),
        ISO_ERR_EMPTY);
    assert_int_equal(iso_shape_set_read_vectors("no/such.nrrd", NULL, NULL, &none, NULL), ISO_ERR_IO);
    assert_int_equal(iso_shape_set_read_vectors(NULL, NULL, NULL, &none, NULL), ISO_ERR_USAGE);
    assert_null(none);
}

/* ---- lines of meshes */

enum {
    RINGS = 20,
    SIDES = 8,
    LEAF = 6,
    TUBE_VERTICES = RINGS * SIDES,
    BRANCH_VERTICES = TUBE_VERTICES + LEAF + 4
};
enum { TUBE_TRIANGLES = 2 * SIDES * (RINGS - 1), BRANCH_TRIANGLES = TUBE_TRIANGLES + 4 + 4 };

/* A tube along z, whose radius grows from .5 to 1; a leaf beside it; and a tetrahedron, which is neither. */
static iso_mesh make_branches(double x) {
    static float positions[BRANCH_VERTICES][3];
    static const double around[SIDES][2] = {{1, 0},  {.8, .6},   {0, 1},  {-.8, .6},
                                            {-1, 0}, {-.8, -.6}, {0, -1}, {.8, -.6}};
    static const float leaf[LEAF][3] = {{9, 0, 0}, {8, 0, 2}, {10, 0, 2}, {8, 0, 5}, {10, 0, 5}, {9, 0, 8}};
    static const float solid[4][3] = {{20, 0, 0}, {25, 0, 0}, {20, 5, 0}, {20, 0, 5}};
    static uint32_t triangles[BRANCH_TRIANGLES][3];
    static const uint32_t others[8][3] = {{0, 2, 1}, {1, 2, 4}, {1, 4, 3}, {3, 4, 5},
                                          {6, 8, 7}, {6, 7, 9}, {6, 9, 8}, {7, 8, 9}};
    for (int ring = 0, count = 0; ring < RINGS; ring++)
        for (int i = 0; i < SIDES; i++) {
            const double radius = 0.5 + 0.5 * ring / (RINGS - 1);
            const uint32_t a = (uint32_t)(ring * SIDES + i), b = (uint32_t)(ring * SIDES + (i + 1) % SIDES);
            float *at = positions[a];
            at[0] = (float)(x + radius * around[i][0]), at[1] = (float)(radius * around[i][1]),
            at[2] = (float)ring;
            if (!ring) continue;
            memcpy(triangles[count++], ((uint32_t[3]){a - SIDES, b - SIDES, b}), sizeof triangles[0]);
            memcpy(triangles[count++], ((uint32_t[3]){a - SIDES, b, a}), sizeof triangles[0]);
        }
    for (int i = 0; i < LEAF + 4; i++)
        for (int k = 0; k < 3; k++)
            positions[TUBE_VERTICES + i][k] = (i < LEAF ? leaf[i] : solid[i - LEAF])[k] + (k ? 0 : (float)x);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++) triangles[TUBE_TRIANGLES + i][k] = TUBE_VERTICES + others[i][k];
    return (iso_mesh){.positions = positions,
                      .triangles = triangles,
                      .vertex_count = BRANCH_VERTICES,
                      .triangle_count = BRANCH_TRIANGLES};
}

/* The tube's rings are the vertices of its line, also far from the origin; the leaf is a ribbon. */
static void check_branches(const iso_branches *branches, double x, double sign) {
    assert_true(branches->pieces == 3 && branches->tube_pieces == 1 && branches->ribbon_pieces == 1);
    assert_true(branches->tubes.line_count == 1 && branches->tubes.starts[1] == RINGS);
    for (int i = 0; i < RINGS; i++) {
        const float *at = branches->tubes.vertices + 3 * i;
        assert_true(fabs((double)at[0] - sign * x) < 1e-3 && fabs((double)at[1]) < 1e-3);
        assert_true(fabs((double)branches->tubes.radii[i] - 0.5 - 0.5 * (double)at[2] / (RINGS - 1)) < 1e-3);
    }
    assert_true(branches->ribbons.line_count == 1 && branches->ribbons.starts[1] == 4);
    for (int i = 1; i < 3; i++) {
        assert_true(fabs((double)branches->ribbons.vertices[3 * i] - sign * (x + 9)) < 1e-3);
        assert_true(fabs((double)branches->ribbons.radii[i] - 1) < 1e-3);
        assert_true(fabs((double)branches->ribbons.normals[3 * i + 1]) > 0.999);
    }
    assert_true(branches->rest.triangle_count == 4 && branches->left_out == 0);
}

static void write_off(const iso_mesh *mesh, const char *path) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "OFF\n%zu %zu 0\n", mesh->vertex_count, mesh->triangle_count);
    for (size_t i = 0; i < mesh->vertex_count; i++)
        fprintf(file, "%.9g %.9g %.9g\n", (double)mesh->positions[i][0], (double)mesh->positions[i][1],
                (double)mesh->positions[i][2]);
    for (size_t i = 0; i < mesh->triangle_count; i++)
        fprintf(file, "3 %u %u %u\n", mesh->triangles[i][0], mesh->triangles[i][1], mesh->triangles[i][2]);
    assert_int_equal(fclose(file), 0);
}

/* Its lines are drawn as wide as the mesh itself, of which the tube's polygon hides a part. */
static void test_branches(void **state) {
    (void)state;
    const char *path = ISO_TEST_TMP "/public_branches.off";
    iso_branches made[3] = {{.pieces = 0}, {.pieces = 0}, {.pieces = 0}}, none = {.pieces = 0};
    iso_mesh mesh = make_branches(20000);
    assert_int_equal(iso_branches_of_mesh(&mesh, &made[0], NULL), ISO_OK);
    check_branches(&made[0], 20000, 1);
    mesh = make_branches(0);
    write_off(&mesh, path);
    assert_int_equal(iso_branches_read(path, false, &made[1], NULL), ISO_OK);
    check_branches(&made[1], 0, 1);
    assert_int_equal(iso_branches_read(path, true, &made[2], NULL), ISO_OK);
    check_branches(&made[2], 0, -1);

    iso_shape_set *sets[3] = {NULL, NULL, NULL}, *whole = NULL;
    iso_image lines = {0}, triangles = {0};
    assert_int_equal(
        iso_shape_set_of_lines(&made[1].tubes, &(iso_shape_set_opts){.flat_caps = true}, &sets[0], NULL),
        ISO_OK);
    assert_int_equal(
        iso_shape_set_of_lines(&made[1].ribbons, &(iso_shape_set_opts){.ribbons = true}, &sets[1], NULL),
        ISO_OK);
    assert_int_equal(iso_shape_set_of_mesh(&made[1].rest, NULL, &sets[2], NULL), ISO_OK);
    assert_int_equal(iso_shape_set_of_mesh(&mesh, NULL, &whole, NULL), ISO_OK);
    const iso_box box = {{-1, -1, 0}, {25, 5, 19}};
    iso_camera camera;
    assert_int_equal(iso_camera_of_box(&box, 384, 288, NULL, &camera, NULL), ISO_OK);
    iso_render_opts opts = {.width = 384,
                            .height = 288,
                            .shapes = sets,
                            .shapes_count = 3,
                            .camera = &camera,
                            .transparent = true};
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &lines, NULL), ISO_OK);
    opts.shapes = &whole, opts.shapes_count = 1;
    assert_int_equal(iso_render_surfaces(NULL, 0, &opts, &triangles, NULL), ISO_OK);
    size_t both = 0, either = 0;
    for (size_t i = 3; i < 4 * 384 * 288; i += 4) {
        both += lines.rgba[i] > 127 && triangles.rgba[i] > 127;
        either += lines.rgba[i] > 127 || triangles.rgba[i] > 127;
    }
    assert_true(either > 9000 && (double)both > 0.95 * (double)either);

    iso_error error = {.text = ""};
    iso_mesh solid = made[1].rest, bad = mesh;
    assert_int_equal(iso_branches_of_mesh(&solid, &none, &error), ISO_ERR_EMPTY);
    assert_non_null(strstr(error.text, "not made of thin branches"));
    bad.vertex_count = 5;
    assert_int_equal(iso_branches_of_mesh(&bad, &none, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_branches_of_mesh(&(iso_mesh){.positions = NULL}, &none, NULL), ISO_ERR_EMPTY);
    assert_int_equal(iso_branches_read(NULL, false, &none, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_branches_read(ISO_TEST_TMP "/absent.off", false, &none, NULL), ISO_ERR_IO);
    for (int i = 0; i < 3; i++) iso_branches_free(&made[i]);
    for (int i = 0; i < 3; i++) iso_shape_set_destroy(sets[i]);
    iso_shape_set_destroy(whole);
    iso_image_free(&lines);
    iso_image_free(&triangles);
    iso_branches_free(&none);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_translucent_shapes),
        cmocka_unit_test(test_occluded_shapes),
        cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_branches),
        cmocka_unit_test(test_figures),
        cmocka_unit_test(test_annotations),
        cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_field_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
