/* What bindings to other languages need of the public interface: progress, children of fork, bytes in
 * memory, what is changed without a new surface, voxels where they are, memory given back, precision far
 * from the origin. */
#include <malloc.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "isopoint.h"

enum { SIDE = 160, BYTES = SIDE * SIDE * SIDE, PIXELS = 400 };

static uint8_t voxels[BYTES];

/* A bumpy ball around (78, 80, 79) of voxels. */
static void fill(void) {
    for (int i = 0; i < BYTES; i++) {
        const double x = i % SIDE - 78, y = i / SIDE % SIDE - 80, z = i / (SIDE * SIDE) - 79,
                     value = 128 + 12 * (60 - sqrt(x * x + y * y + z * z) + 4 * sin(x / 3) * sin(y / 4));
        voxels[i] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
    }
}

static iso_volume *lend(const iso_transform *transform, int threads) {
    iso_volume *volume = NULL;
    const iso_lend_opts opts = {
        .dims = {SIDE, SIDE, SIDE}, .data = voxels, .transform = transform, .threads = threads};
    if (!voxels[78 + SIDE * (80 + SIDE * 79)]) fill();
    assert_int_equal(iso_volume_lend(&opts, &volume, NULL), ISO_OK);
    return volume;
}

static iso_surface *surface_of(iso_volume *volume) {
    iso_surface *surface = NULL;
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.isovalue = 128}, &surface, NULL),
                     ISO_OK);
    return surface;
}

static void free_both(iso_surface *surface, iso_volume *volume) {
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
}

static void assert_same_image(const iso_image *a, const iso_image *b) {
    assert_int_equal(a->width, b->width);
    assert_memory_equal(a->rgba, b->rgba, 4 * (size_t)a->width * (size_t)a->height);
}

/* ---- progress */

/* Cancels at a call. */
typedef struct caller {
    int at; /* 0: never */
    int calls;
    double told; /* the last fraction */
    bool falls;  /* a fraction was less than one before */
} caller;

static int tell(void *context, double fraction) {
    caller *c = context;
    if (fraction >= 0) {
        c->falls |= fraction < c->told || fraction > 1;
        c->told = fraction;
    }
    return ++c->calls == c->at;
}

/* A picture is cancelled at its first calls, by the picture's function and by the volume's; then it is
 * drawn. */
static void check_picture(iso_method method, int samples, int threads) {
    iso_volume *volume = lend(NULL, threads);
    iso_surface *surface = surface_of(volume), *fresh = surface_of(volume);
    iso_image image = {0}, truth = {0};
    caller c = {.at = 1};
    iso_render_opts opts = {.method = method, .width = PIXELS, .height = PIXELS, .samples = samples};
    assert_int_equal(iso_render(fresh, &opts, &truth, NULL), ISO_OK);
    iso_error error = {0};
    for (int by_volume = 0; by_volume < 2; by_volume++)
        for (int at = 1; at < 4; at++) {
            c = (caller){.at = at};
            iso_volume_set_progress(volume, by_volume ? tell : NULL, &c);
            opts.progress = by_volume ? NULL : tell;
            opts.progress_context = &c;
            const iso_status status = iso_render(surface, &opts, &image, &error);
            if (c.calls < at) continue; /* it was fast */
            assert_int_equal(status, ISO_ERR_IO);
            assert_non_null(strstr(error.text, "cancelled"));
        }
    assert_true(c.calls > 0 || method != ISO_METHOD_RAYCAST); /* the slow one */
    c = (caller){.at = 0};
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_OK);
    assert_false(c.falls);
    assert_same_image(&image, &truth);
    iso_volume_set_progress(volume, NULL, NULL);
    iso_image_free(&image);
    iso_image_free(&truth);
    iso_surface_destroy(fresh);
    free_both(surface, volume);
}

static void test_cancelled_pictures(void **state) {
    (void)state;
    for (int threads = 1; threads < 4; threads += 2) {
        check_picture(ISO_METHOD_EXACT, 64, threads);
        check_picture(ISO_METHOD_RAYCAST, 4, threads);
        check_picture(ISO_METHOD_PULLPUSH, 16, threads);
    }
}

/* A function that cancels at once cancels everything that takes long enough for it to be asked. */
static int cancel(void *context, double fraction) {
    (void)fraction;
    ++*(int *)context;
    return 1;
}

static void test_cancelled_extraction(void **state) {
    (void)state;
    for (int threads = 1; threads < 4; threads += 2) {
        iso_volume *volume = lend(NULL, threads);
        iso_surface *surface = surface_of(volume);
        iso_mesh before = {0}, after = {0};
        iso_histogram histogram;
        int calls = 0;
        size_t count = 0, again = 0;
        assert_int_equal(iso_surface_mesh(surface, &before, NULL), ISO_OK);
        assert_int_equal(iso_surface_points(surface, NULL, 0, &count, NULL), ISO_OK);
        iso_surface_trim(surface);
        iso_volume_set_progress(volume, cancel, &calls);
        for (int i = 0; i < 20; i++) {
            const int cancels = calls;
            const iso_status status = i % 2 ? iso_surface_points(surface, NULL, 0, &again, NULL)
                                            : iso_surface_mesh(surface, &after, NULL);
            assert_int_equal(status, calls > cancels ? ISO_ERR_IO : ISO_OK);
            if (status == ISO_OK) iso_mesh_free(&after);
            const iso_status counted = iso_volume_histogram(volume, &histogram, NULL);
            assert_true(counted == ISO_OK || counted == ISO_ERR_IO);
            iso_surface_trim(surface);
        }
        iso_volume_set_progress(volume, NULL, NULL);
        assert_int_equal(iso_surface_mesh(surface, &after, NULL), ISO_OK);
        assert_int_equal(iso_surface_points(surface, NULL, 0, &again, NULL), ISO_OK);
        assert_int_equal(again, count);
        assert_int_equal(after.vertex_count, before.vertex_count);
        assert_int_equal(after.triangle_count, before.triangle_count);
        assert_memory_equal(after.positions, before.positions,
                            before.vertex_count * sizeof *before.positions);
        assert_memory_equal(after.triangles, before.triangles,
                            before.triangle_count * sizeof *before.triangles);
        iso_mesh_free(&before);
        iso_mesh_free(&after);
        free_both(surface, volume);
    }
}

/* ---- fork */

static void test_child(void **state) {
    (void)state;
    iso_volume *volume = lend(NULL, 3);
    iso_surface *surface = surface_of(volume);
    const iso_render_opts opts = {.width = 64, .height = 64};
    iso_image image = {0};
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_OK);
    const pid_t child = fork();
    if (child == 0) { /* renders the same, frees what it inherited, and has a volume of its own */
        iso_image other = {0};
        alarm(20);
        const bool drawn = iso_render(surface, &opts, &other, NULL) == ISO_OK;
        const bool same = drawn && memcmp(image.rgba, other.rgba, 4 * 64 * 64) == 0;
        free_both(surface, volume);
        volume = lend(NULL, 2);
        surface = surface_of(volume);
        const bool own = iso_render(surface, &opts, &other, NULL) == ISO_OK;
        free_both(surface, volume);
        _exit(same && own ? 0 : 1);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    iso_image_free(&image);
    free_both(surface, volume);
}

/* ---- bytes */

static void test_encoded(void **state) {
    (void)state;
    char path[] = "/tmp/isopoint-encoded-XXXXXX";
    const int file = mkstemp(path);
    iso_image image = {0};
    uint8_t *bytes = NULL, *written;
    size_t size = 0;
    assert_int_equal(iso_image_encode(&image, &bytes, &size, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_image_create(60, 40, &image, NULL), ISO_OK);
    for (int i = 0; i < 4 * 60 * 40; i++) image.rgba[i] = (uint8_t)(i * i);
    assert_int_equal(iso_image_encode(&image, &bytes, &size, NULL), ISO_OK);
    assert_int_equal(iso_image_write(&image, path, NULL), ISO_OK);
    FILE *stream = fopen(path, "rb");
    written = malloc(size + 1);
    assert_int_equal(fread(written, 1, size + 1, stream), size);
    assert_memory_equal(written, bytes, size);
    fclose(stream);
    close(file);
    unlink(path);
    free(written);
    iso_bytes_free(bytes);
    iso_image_free(&image);
}

/* ---- looks */

static void test_looks(void **state) {
    (void)state;
    iso_volume *volume = lend(NULL, 2);
    iso_surface *surface = surface_of(volume), *red = NULL, *empty = surface_of(volume);
    const iso_rgb color = {200, 30, 20};
    const iso_surface_opts opts = {.isovalue = 128, .color = &color, .opacity = 0.25};
    const iso_render_opts look = {.width = 100, .height = 100};
    iso_image a = {0}, b = {0};
    assert_int_equal(iso_surface_create(volume, &opts, &red, NULL), ISO_OK);
    assert_int_equal(iso_render(surface, &look, &a, NULL), ISO_OK);
    assert_int_equal(iso_surface_set_look(surface, &color, 0.25, NULL), ISO_OK);
    assert_int_equal(iso_render(surface, &look, &a, NULL), ISO_OK);
    assert_int_equal(iso_render(red, &look, &b, NULL), ISO_OK);
    assert_same_image(&a, &b);
    assert_int_equal(iso_surface_set_look(surface, NULL, 1.5, NULL), ISO_ERR_USAGE);
    /* opacity 0 is 0: the background alone */
    assert_int_equal(iso_surface_set_look(surface, NULL, 0, NULL), ISO_OK);
    assert_int_equal(iso_render(surface, &look, &a, NULL), ISO_OK);
    for (int i = 0; i < 4 * 100 * 100; i++) assert_int_equal(a.rgba[i], 255);
    /* and back: opaque, in the palette's colour */
    assert_int_equal(iso_surface_set_look(surface, NULL, 1, NULL), ISO_OK);
    assert_int_equal(iso_render(surface, &look, &a, NULL), ISO_OK);
    assert_int_equal(iso_render(empty, &look, &b, NULL), ISO_OK);
    assert_same_image(&a, &b);
    iso_image_free(&a);
    iso_image_free(&b);
    iso_surface_destroy(red);
    iso_surface_destroy(empty);
    free_both(surface, volume);
}

static void test_looks_of_shapes(void **state) {
    (void)state;
    const float at[3] = {1, 2, 3};
    const iso_rgb color = {200, 30, 20};
    const iso_glyph_arrays points = {.positions = at, .count = 1};
    iso_shape_set *plain = NULL, *red = NULL;
    iso_image a = {0}, b = {0};
    assert_int_equal(iso_shape_set_of_glyphs(&points, &(iso_shape_set_opts){.radius = 1}, &plain, NULL),
                     ISO_OK);
    assert_int_equal(
        iso_shape_set_of_glyphs(&points, &(iso_shape_set_opts){.radius = 1, .color = &color, .opacity = 0.5},
                                &red, NULL),
        ISO_OK);
    assert_int_equal(iso_shape_set_set_look(plain, &color, 0.5, NULL), ISO_OK);
    assert_int_equal(iso_shape_set_set_look(plain, &color, NAN, NULL), ISO_ERR_USAGE);
    iso_shape_set *sets[2] = {plain, red};
    for (int i = 0; i < 2; i++) { /* by any number of threads */
        const iso_render_opts look = {
            .width = 80, .height = 80, .shapes = &sets[i], .shapes_count = 1, .threads = 1 + 2 * i};
        assert_int_equal(iso_render_surfaces(NULL, 0, &look, i ? &b : &a, NULL), ISO_OK);
    }
    assert_same_image(&a, &b);
    const iso_render_opts many = {.shapes = sets, .shapes_count = 1, .threads = -1};
    assert_int_equal(iso_render_surfaces(NULL, 0, &many, &a, NULL), ISO_ERR_USAGE);
    iso_image_free(&a);
    iso_image_free(&b);
    iso_shape_set_destroy(plain);
    iso_shape_set_destroy(red);
}

/* ---- voxels */

/* Half of the columns and all but the last slices of the array, lent where they are and as a copy. */
static void test_strides(void **state) {
    (void)state;
    iso_volume *whole = lend(NULL, 1), *part = NULL, *copy = NULL;
    enum { WIDE = 90, HIGH = SIDE - 3, DEEP = SIDE - 5 };
    iso_voxels seen;
    assert_int_equal(iso_volume_voxels(whole, &seen, NULL), ISO_OK);
    assert_ptr_equal(seen.data, voxels);
    assert_true(seen.stride_y == SIDE && seen.stride_z == SIDE * SIDE && seen.dims[2] == SIDE);
    iso_lend_opts opts = {
        .dims = {WIDE, HIGH, DEEP}, .data = voxels + 7 + 2 * SIDE, .stride_y = SIDE, .stride_z = SIDE * SIDE};
    uint8_t *dense = malloc((size_t)WIDE * HIGH * DEEP), *to = dense;
    for (int z = 0; z < DEEP; z++)
        for (int y = 0; y < HIGH; y++, to += WIDE)
            memcpy(to, voxels + 7 + SIDE * (2 + y) + SIDE * SIDE * z, WIDE);
    assert_int_equal(iso_volume_lend(&opts, &part, NULL), ISO_OK);
    assert_int_equal(iso_volume_voxels(part, &seen, NULL), ISO_OK);
    assert_ptr_equal(seen.data, voxels + 7 + 2 * SIDE);
    opts.data = dense;
    opts.stride_y = opts.stride_z = 0;
    assert_int_equal(iso_volume_lend(&opts, &copy, NULL), ISO_OK);
    iso_surface *of_part = surface_of(part), *of_copy = surface_of(copy);
    iso_image a = {0}, b = {0};
    for (int i = 0; i < 3; i++) {
        const iso_method methods[3] = {ISO_METHOD_EXACT, ISO_METHOD_RAYCAST, ISO_METHOD_PULLPUSH};
        const iso_render_opts look = {.method = methods[i], .width = 90, .height = 90};
        assert_int_equal(iso_render(of_part, &look, &a, NULL), ISO_OK);
        assert_int_equal(iso_render(of_copy, &look, &b, NULL), ISO_OK);
        assert_same_image(&a, &b);
    }
    iso_volume *none = NULL;
    const ptrdiff_t wrong[][2] = {
        {WIDE - 1, SIDE * SIDE}, {SIDE, SIDE * HIGH - 1}, {-SIDE, 0}, {PTRDIFF_MAX, 0}};
    for (int i = 0; i < 4; i++) {
        opts.stride_y = wrong[i][0];
        opts.stride_z = wrong[i][1];
        assert_int_equal(iso_volume_lend(&opts, &none, NULL), ISO_ERR_USAGE);
    }
    iso_image_free(&a);
    iso_image_free(&b);
    free_both(of_part, part);
    free_both(of_copy, copy);
    iso_volume_destroy(whole);
    free(dense);
}

static void test_sparse_voxels(void **state) {
    (void)state;
    iso_sculpt *sculpt = NULL;
    iso_voxels seen;
    assert_int_equal(iso_sculpt_create(&(iso_sculpt_opts){.dims = {64, 64, 64}}, &sculpt, NULL), ISO_OK);
    assert_int_equal(iso_volume_voxels(iso_sculpt_volume(sculpt), &seen, NULL), ISO_ERR_UNSUPPORTED);
    iso_sculpt_destroy(sculpt);
}

/* ---- memory */

/* Bytes that the process has allocated; 0 with a sanitizer, whose allocator does not count them. (How many
 * are resident changes by megabytes, as the system likes.) */
static long long allocated(void) {
    const struct mallinfo2 info = mallinfo2();
    return (long long)(info.uordblks + info.hblkhd);
}

static void test_trim(void **state) {
    (void)state;
    iso_volume *volume = lend(NULL, 2);
    iso_surface *surface = surface_of(volume);
    iso_mesh mesh = {0}, again = {0};
    iso_image a = {0}, b = {0};
    size_t count;
    const iso_render_opts look = {.width = 200, .height = 200};
    assert_int_equal(iso_render(surface, &look, &a, NULL), ISO_OK); /* threads have what they keep */
    iso_image_free(&a);
    iso_surface_trim(surface);
    const long long before = allocated();
    assert_int_equal(iso_surface_mesh(surface, &mesh, NULL), ISO_OK);
    assert_int_equal(iso_surface_points(surface, NULL, 0, &count, NULL), ISO_OK);
    assert_int_equal(iso_render(surface, &look, &a, NULL), ISO_OK);
    const long long own = (long long)(mesh.vertex_count * 24 + mesh.triangle_count * 12 + 4 * 200 * 200),
                    kept = allocated() - before - own;
    iso_surface_trim(surface);
    const long long left = allocated() - before - own;
    print_message("kept %lld kB, after trimming %lld kB\n", kept >> 10, left >> 10);
    if (allocated() > 0) {
        assert_true(kept > (4 << 20));
        assert_true(left <= kept / 10);
    }
    assert_int_equal(iso_surface_mesh(surface, &again, NULL), ISO_OK);
    assert_int_equal(again.vertex_count, mesh.vertex_count);
    assert_int_equal(iso_render(surface, &look, &b, NULL), ISO_OK);
    assert_same_image(&a, &b);
    iso_mesh_free(&mesh);
    iso_mesh_free(&again);
    iso_image_free(&a);
    iso_image_free(&b);
    free_both(surface, volume);
}

/* ---- far away */

static int compare_floats(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The number of different y. */
static int distinct(const float *first, size_t stride, size_t count) {
    float *y = malloc(count * sizeof *y);
    int different = 1;
    for (size_t i = 0; i < count; i++) y[i] = first[i * stride];
    qsort(y, count, sizeof *y, compare_floats);
    for (size_t i = 1; i < count; i++) different += y[i] != y[i - 1];
    free(y);
    return different;
}

static void test_far(void **state) {
    (void)state;
    const iso_transform near = {{0, 0, 0}, {0.1, 0.1, 0.1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                        far = {{1e6, 5e6, -2e6}, {0.1, 0.1, 0.1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    iso_volume *volumes[2] = {lend(&near, 2), lend(&far, 2)};
    iso_surface *surfaces[2] = {surface_of(volumes[0]), surface_of(volumes[1])};
    iso_mesh mesh[2] = {{0}, {0}}, rounded = {0};
    iso_surface_point *points[2];
    size_t count[2];
    assert_int_equal(iso_surface_mesh(surfaces[1], &rounded, NULL), ISO_OK);
    assert_int_equal(iso_surface_set_origin(surfaces[1], (const double[3]){0, INFINITY, 0}, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_surface_set_origin(surfaces[1], far.origin, NULL), ISO_OK);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(iso_surface_mesh(surfaces[i], &mesh[i], NULL), ISO_OK);
        assert_int_equal(iso_surface_points(surfaces[i], NULL, 0, &count[i], NULL), ISO_OK);
        points[i] = malloc(count[i] * sizeof *points[i]);
        assert_int_equal(iso_surface_points(surfaces[i], points[i], count[i], &count[i], NULL), ISO_OK);
    }
    assert_memory_equal(mesh[0].positions, mesh[1].positions,
                        mesh[0].vertex_count * sizeof *mesh[0].positions);
    assert_memory_equal(points[0], points[1], count[0] * sizeof *points[0]);
    print_message("%d different y, of floats in the world %d\n",
                  distinct(&mesh[1].positions[0][1], 3, mesh[1].vertex_count),
                  distinct(&rounded.positions[0][1], 3, rounded.vertex_count));
    assert_true(distinct(&mesh[1].positions[0][1], 3, mesh[1].vertex_count) >
                100 * distinct(&rounded.positions[0][1], 3, rounded.vertex_count));
    for (int i = 0; i < 2; i++) {
        iso_mesh_free(&mesh[i]);
        free(points[i]);
        free_both(surfaces[i], volumes[i]);
    }
    iso_mesh_free(&rounded);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cancelled_pictures),
        cmocka_unit_test(test_cancelled_extraction),
        cmocka_unit_test(test_child),
        cmocka_unit_test(test_encoded),
        cmocka_unit_test(test_looks),
        cmocka_unit_test(test_looks_of_shapes),
        cmocka_unit_test(test_strides),
        cmocka_unit_test(test_sparse_voxels),
        cmocka_unit_test(test_trim),
        cmocka_unit_test(test_far),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
