/* Pictures in parts through the public header alone: parts with just the voxels that they need, drawn in any
 * order into several keys that are merged, also by files, give the bytes of iso_render of the whole. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "isopoint.h"

enum { NX = 61, NY = 50, NZ = 83, WIDTH = 200, HEIGHT = 150, PARTS_MOST = 8 };
static const int dims[3] = {NX, NY, NZ};
static const iso_transform transform = {
    {3, -7, 11},
    {0.7, 1.9, 1.2},
    {2.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3, 2.0 / 3, -1.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3}};
static const double isovalue = 10.25;
static const iso_rgb color = {200, 90, 30}, background = {1, 2, 3};
static const iso_method methods[] = {ISO_METHOD_EXACT, ISO_METHOD_PULLPUSH_BOX, ISO_METHOD_PULLPUSH};
static const int part_counts[] = {1, 2, 3, 5, PARTS_MOST};

/* Waves, which end at the volume's border; or a ball, which is closed. */
static int16_t value(int x, int y, int z, bool closed) {
    const double dx = x - 30.2, dy = y - 24.7, dz = z - 40.1;
    return (int16_t)(closed ? 200 - 9 * sqrt(dx * dx + dy * dy + dz * dz / 3)
                            : 80 * sin(x * 0.31) * cos(y * 0.23) + 60 * sin(z * 0.4 + x * 0.1));
}

/* A volume of the voxels origin .. origin + size - 1 of the whole, which frees its array. */
static iso_volume *make_volume(const int origin[3], const int size[3], bool closed) {
    int16_t *data = malloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2] * sizeof *data), *next = data;
    iso_volume *volume = NULL;
    assert_non_null(data);
    for (int z = 0; z < size[2]; z++)
        for (int y = 0; y < size[1]; y++)
            for (int x = 0; x < size[0]; x++)
                *next++ = value(origin[0] + x, origin[1] + y, origin[2] + z, closed);
    const iso_lend_opts opts = {.dims = {size[0], size[1], size[2]},
                                .type = ISO_INT16,
                                .data = data,
                                .release = free,
                                .owner = data,
                                .scale = 0.5,
                                .offset = 3,
                                .transform = &transform,
                                .threads = 2};
    assert_int_equal(iso_volume_lend(&opts, &volume, NULL), ISO_OK);
    return volume;
}

static void render_whole(iso_method method, const iso_camera *camera, bool closed, iso_image *image) {
    const int zero[3] = {0, 0, 0};
    iso_volume *volume = make_volume(zero, dims, closed);
    iso_surface *surface = NULL;
    const iso_surface_opts opts = {.isovalue = isovalue, .color = &color};
    const iso_render_opts picture = {
        .method = method, .width = WIDTH, .height = HEIGHT, .camera = camera, .background = &background};
    assert_int_equal(iso_surface_create(volume, &opts, &surface, NULL), ISO_OK);
    assert_int_equal(iso_render(surface, &picture, image, NULL), ISO_OK);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
}

static iso_keys *make_keys(iso_method method, const iso_camera *camera) {
    const iso_keys_opts opts = {.dims = {NX, NY, NZ},
                                .transform = &transform,
                                .isovalue = isovalue,
                                .method = method,
                                .width = WIDTH,
                                .height = HEIGHT,
                                .camera = camera,
                                .color = &color,
                                .background = &background,
                                .threads = 2};
    iso_keys *keys = NULL;
    assert_int_equal(iso_keys_create(&opts, &keys, NULL), ISO_OK);
    return keys;
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

static int larger(int a, int b) {
    return a > b ? a : b;
}

typedef iso_status use_part(iso_keys *keys, const iso_keys_part *part, iso_error *error);

/* Calls `use` with the part first .. end. layout 0: the volume has only what the part needs; 1: it begins a
 * brick before; 2: it is the whole. */
static void with_part(const int first[3], const int end[3], int layout, bool closed, iso_keys *keys,
                      use_part *use) {
    iso_keys_part part = {.first = {first[0], first[1], first[2]}};
    int size[3];
    for (int axis = 0; axis < 3; axis++) {
        const int below = layout == 0 ? 1 : layout == 1 ? 16 : first[axis];
        part.end[axis] = end[axis] < dims[axis] ? end[axis] : 0;
        part.origin[axis] = larger(first[axis] - below, 0);
        size[axis] = (layout == 2 ? dims[axis] : smaller(end[axis] + 2, dims[axis])) - part.origin[axis];
    }
    part.volume = make_volume(part.origin, size, closed);
    assert_int_equal(use(keys, &part, NULL), ISO_OK);
    iso_volume_destroy(part.volume);
}

/* Calls `use` with all boxes of 16 x 32 x 16 voxels, each with one of the keys by chance. */
static void with_boxes(unsigned seed, bool closed, iso_keys *const *keys, int count, use_part *use) {
    for (int z = 0; z < NZ; z += 16)
        for (int y = 0; y < NY; y += 32)
            for (int x = 0; x < NX; x += 16) {
                const int first[3] = {x, y, z},
                          end[3] = {smaller(x + 16, NX), smaller(y + 32, NY), smaller(z + 16, NZ)};
                seed = seed * 1664525 + 1013904223;
                with_part(first, end, (int)(seed >> 28) % 3, closed,
                          keys[(seed >> 16 & 0xff) % (unsigned)count], use);
            }
}

/* All keys get the survey of all parts, as processes would reduce it. */
static void reduce_surveys(iso_keys *const *keys, int count) {
    double least[ISO_KEYS_SURVEY];
    memcpy(least, iso_keys_surveyed(keys[0]), sizeof least);
    for (int i = 1; i < count; i++)
        for (int k = 0; k < ISO_KEYS_SURVEY; k++) least[k] = fmin(least[k], iso_keys_surveyed(keys[i])[k]);
    for (int i = 0; i < count; i++) memcpy(iso_keys_surveyed(keys[i]), least, sizeof least);
}

/* Writes the keys to files, and shows what is read from them. */
static void show_files(iso_keys *const *keys, int count, iso_image *image) {
    char names[PARTS_MOST][48];
    const char *paths[PARTS_MOST];
    iso_keys *merged = NULL;
    for (int i = 0; i < count; i++) {
        snprintf(names[i], sizeof names[i], "parts_%ld_%d.isokeys", (long)getpid(), i);
        paths[i] = names[i];
        assert_int_equal(iso_keys_write(keys[i], i + 1, count, names[i], NULL), ISO_OK);
    }
    if (count > 1) assert_int_equal(iso_keys_read(paths, count - 1, 0, 1, &merged, NULL), ISO_ERR_FORMAT);
    assert_int_equal(iso_keys_read(paths, count, 0, 2, &merged, NULL), ISO_OK);
    assert_int_equal(iso_keys_show(merged, image, NULL), ISO_OK);
    iso_keys_destroy(merged);
    for (int i = 0; i < count; i++) unlink(names[i]);
}

/* Reduces the pixels into the first keys, as processes would, or merges. */
static void merge(iso_keys *const *keys, int count, bool by_pixels) {
    for (int i = 1; i < count; i++) {
        uint64_t *to, *from;
        size_t pixels, others;
        if (!by_pixels) {
            assert_int_equal(iso_keys_merge(keys[0], keys[i], NULL), ISO_OK);
            continue;
        }
        assert_int_equal(iso_keys_pixels(keys[0], &to, &pixels, NULL), ISO_OK);
        assert_int_equal(iso_keys_pixels(keys[i], &from, &others, NULL), ISO_OK);
        assert_int_equal(pixels, others);
        for (size_t k = 0; k < pixels; k++)
            if (from[k] < to[k]) to[k] = from[k];
    }
}

static iso_camera make_camera(int kind) {
    const iso_box box = {{0, -20, 0}, {100, 70, 100}};
    const iso_fit_opts fit = {.direction = ISO_ISOMETRIC, .orthographic = kind == 1, .zoom = 1.3};
    iso_camera camera;
    assert_int_equal(iso_camera_of_box(&box, WIDTH, HEIGHT, &fit, &camera, NULL), ISO_OK);
    if (kind == 2) camera.position = (iso_vec3){40, 30, 40}; /* inside the volume */
    if (kind == 2) camera.view_angle = 90;
    return camera;
}

static void parts_are_the_whole(void **state) {
    (void)state;
    for (int round = 0; round < 30; round++) {
        const iso_method method = methods[round % 3];
        const int count = part_counts[round % 5];
        const bool closed = round % 2;
        const iso_camera camera = make_camera(round / 3 % 3);
        iso_keys *keys[PARTS_MOST];
        iso_image whole = {0}, image = {0}, read = {0};
        for (int i = 0; i < count; i++) keys[i] = make_keys(method, &camera);
        render_whole(method, &camera, closed, &whole);
        with_boxes((unsigned)round, closed, keys, count, iso_keys_survey);
        reduce_surveys(keys, count);
        with_boxes((unsigned)round + 100, closed, keys, count, iso_keys_draw);
        show_files(keys, count, &read);
        merge(keys, count, round / 5 % 2 == 0);
        assert_int_equal(iso_keys_show(keys[0], &image, NULL), ISO_OK);
        assert_memory_equal(whole.rgba, image.rgba, WIDTH * HEIGHT * 4);
        assert_memory_equal(whole.rgba, read.rgba, WIDTH * HEIGHT * 4);
        for (int i = 0; i < count; i++) iso_keys_destroy(keys[i]);
        iso_image_free(&whole);
        iso_image_free(&image);
        iso_image_free(&read);
    }
}

static void wrong_parts_are_refused(void **state) {
    (void)state;
    static const struct {
        int first, end, origin, size;
    } wrong[] = {{8, 32, 0, NX},  {16, 40, 0, NX},  {16, 16, 0, NX},  {-16, 16, 0, NX},
                 {48, 64, 0, NX}, {16, 32, 16, 18}, {16, 32, 15, 18}, {16, 32, 0, 33}};
    const iso_camera camera = make_camera(0);
    iso_keys *keys = make_keys(ISO_METHOD_EXACT, &camera);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        iso_keys_part part = {0};
        iso_error error = {0};
        part.first[0] = wrong[i].first;
        part.end[0] = wrong[i].end;
        part.origin[0] = wrong[i].origin;
        part.volume = make_volume(part.origin, (const int[3]){wrong[i].size, NY, NZ}, false);
        assert_int_equal(iso_keys_draw(keys, &part, &error), ISO_ERR_USAGE);
        assert_true(error.text[0]);
        iso_volume_destroy(part.volume);
    }
    iso_keys_destroy(keys);
}

static void wrong_uses_are_refused(void **state) {
    (void)state;
    const iso_camera camera = make_camera(0), other_camera = make_camera(1);
    const iso_keys_opts no_camera = {.dims = {NX, NY, NZ}},
                        no_method = {.dims = {NX, NY, NZ}, .camera = &camera, .method = ISO_METHOD_MESH};
    iso_keys *keys = NULL, *points = make_keys(ISO_METHOD_PULLPUSH_BOX, &camera);
    iso_image image = {0};
    iso_keys_part part = {.volume = make_volume((const int[3]){0}, dims, false)};
    assert_int_equal(iso_keys_create(NULL, &keys, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_keys_create(&no_camera, &keys, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_keys_create(&no_method, &keys, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_keys_draw(points, &part, NULL), ISO_ERR_EMPTY); /* not surveyed */
    assert_int_equal(iso_keys_show(points, &image, NULL), ISO_ERR_EMPTY);
    assert_int_equal(iso_keys_write(points, 1, 1, "none.isokeys", NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_keys_survey(points, &part, NULL), ISO_OK);
    assert_int_equal(iso_keys_draw(points, &part, NULL), ISO_OK);
    assert_int_equal(iso_keys_survey(points, &part, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_keys_write(points, 2, 1, "none.isokeys", NULL), ISO_ERR_USAGE);
    keys = make_keys(ISO_METHOD_EXACT, &other_camera);
    assert_int_equal(iso_keys_draw(keys, &part, NULL), ISO_OK);
    assert_int_equal(iso_keys_merge(keys, points, NULL), ISO_ERR_MISMATCH);
    iso_volume_destroy(part.volume);
    static uint8_t bytes[NX * NY * NZ];
    const iso_lend_opts opts = {.dims = {NX, NY, NZ}, .type = ISO_UINT8, .data = bytes};
    assert_int_equal(iso_volume_lend(&opts, &part.volume, NULL), ISO_OK);
    assert_int_equal(iso_keys_draw(keys, &part, NULL), ISO_ERR_MISMATCH);
    iso_volume_destroy(part.volume);
    iso_keys_destroy(keys);
    iso_keys_destroy(points);
    iso_keys_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_the_whole),
        cmocka_unit_test(wrong_parts_are_refused),
        cmocka_unit_test(wrong_uses_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
