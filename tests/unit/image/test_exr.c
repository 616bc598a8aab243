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

#include "check_support.h"
#include "exr_files.h"
#include "file_support.h"
#include "image/exr.h"
#include "image/image.h"

static const char *const PATH = ISO_TEST_TMP "/exr_test.exr";
static const char *const NAMES[ISO_AOV_PLANES] = {"A", "N.X", "N.Y", "N.Z", "Z"};
enum { RLE = 1, ZIPS = 2, ZIP = 3, PIZ = 4 };

static float *plane(const iso_aov *aov, int channel) {
    float *const planes[] = {aov->coverage, aov->normal[0], aov->normal[1], aov->normal[2], aov->depth};
    return planes[channel];
}

static size_t pixels(const iso_aov *aov) {
    return (size_t)aov->width * (size_t)aov->height;
}

/* Random numbers in a third of the pixels, nothing in the others. */
static iso_aov random_aov(int width, int height) {
    iso_aov aov;
    uint32_t seed = (uint32_t)(width * 31 + height);
    assert_int_equal(iso_aov_create(width, height, &aov, NULL), ISO_OK);
    for (size_t i = 0; i < pixels(&aov); i++) {
        int covered = random_bits(&seed) % 3 == 0;
        aov.coverage[i] = covered ? (float)(1 + random_bits(&seed) % 16) / 16 : 0;
        aov.depth[i] = covered ? (float)random_bits(&seed) / 77 - 100 : INFINITY;
        for (int axis = 0; axis < 3; axis++)
            aov.normal[axis][i] = covered ? (float)random_bits(&seed) / (1 << 23) - 1 : 0;
    }
    aov.voxel = 0.35f;
    return aov;
}

static void assert_same(const iso_aov *a, const iso_aov *b) {
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    for (int c = 0; c < ISO_AOV_PLANES; c++)
        assert_memory_equal(plane(a, c), plane(b, c), pixels(a) * sizeof(float));
}

static void add_random_ids(iso_aov *aov) {
    uint32_t seed = 5;
    assert_int_equal(iso_aov_add_ids(aov, NULL), ISO_OK);
    for (size_t i = 0; i < pixels(aov); i++)
        for (int k = 0; k < ISO_ID_PLANES; k++)
            aov->ids[k][i] = aov->coverage[i] > 0 ? UINT32_MAX - random_bits(&seed) % 7 * (uint32_t)k : 0;
}

/* PATH is refused with `status`, in one line that names it and holds `reason`. */
static void assert_refused(iso_status status, const char *reason) {
    iso_aov aov = {0};
    iso_error error = {0};
    assert_int_equal(iso_exr_read(PATH, NULL, &aov, &error), status);
    if (!strstr(error.text, PATH) || strchr(error.text, '\n') || !strstr(error.text, reason))
        fail_msg("'%s' where '%s' belongs", error.text, reason);
    assert_null(aov.depth);
}

/* ---- what iso_exr_write writes */

static void what_is_written_is_read(void **state) {
    (void)state;
    const int sizes[][2] = {{1, 1}, {37, 23}, {64, 160}, {16384, 1}, {1, 16384}};
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        iso_aov aov = random_aov(sizes[k][0], sizes[k][1]), back;
        assert_int_equal(iso_exr_write(PATH, &aov, NULL, pool, NULL), ISO_OK);
        assert_int_equal(iso_exr_read(PATH, k % 2 ? pool : NULL, &back, NULL), ISO_OK);
        assert_same(&back, &aov);
        assert_true(back.voxel == aov.voxel);
        iso_aov_free(&back);
        iso_aov_free(&aov);
    }
    iso_pool_destroy(pool);
}

static void others_read_it(void **state) {
    (void)state;
    iso_aov aov = random_aov(61, 47);
    assert_int_equal(iso_exr_write(PATH, &aov,
                                   &(iso_exr_info){.software = "isopoint", .comments = "B\xc3\xa4r"}, NULL,
                                   NULL),
                     ISO_OK);
    float *values = calloc(pixels(&aov), sizeof *values), voxel;
    for (int c = 0; c < ISO_AOV_PLANES; c++) {
        assert_int_equal(exr_read(PATH, NAMES[c], aov.width, aov.height, values), 0);
        assert_memory_equal(values, plane(&aov, c), pixels(&aov) * sizeof *values);
    }
    assert_int_equal(exr_read_float(PATH, "isopointVoxel", &voxel), 0);
    assert_true(voxel == 0.35f);
    assert_int_equal(exr_has_text(PATH, "software", "isopoint"), 0);
    assert_int_equal(exr_has_text(PATH, "comments", "B\xc3\xa4r"), 0);
    float matrix[16];
    assert_int_equal(exr_read_matrix(PATH, "worldToCamera", matrix), 1);
    free(values);
    iso_aov_free(&aov);
}

/* Integers of 32 bits: also by a reader that is not ours. */
static void ids_are_kept(void **state) {
    (void)state;
    static const char *const names[ISO_ID_PLANES] = {"id.surface", "id.element", "id.segment"};
    iso_aov aov = random_aov(61, 47), back;
    add_random_ids(&aov);
    assert_int_equal(iso_exr_write(PATH, &aov, NULL, NULL, NULL), ISO_OK);
    assert_int_equal(iso_exr_read(PATH, NULL, &back, NULL), ISO_OK);
    assert_same(&back, &aov);
    uint32_t *values = calloc(pixels(&aov), sizeof *values);
    for (int k = 0; k < ISO_ID_PLANES; k++) {
        assert_memory_equal(back.ids[k], aov.ids[k], pixels(&aov) * sizeof **aov.ids);
        assert_int_equal(exr_read_integers(PATH, names[k], aov.width, aov.height, values), 0);
        assert_memory_equal(values, aov.ids[k], pixels(&aov) * sizeof *values);
    }
    free(values);
    iso_aov_free(&back);
    iso_aov_free(&aov);
}

static void threads_do_not_matter(void **state) {
    (void)state;
    iso_aov aov = random_aov(301, 517);
    uint8_t *bytes[2];
    size_t sizes[2];
    for (int k = 0; k < 2; k++) {
        iso_pool *pool;
        assert_int_equal(iso_pool_create(k ? 5 : 1, &pool, NULL), ISO_OK);
        assert_int_equal(iso_exr_write(PATH, &aov, NULL, pool, NULL), ISO_OK);
        bytes[k] = slurp(PATH, &sizes[k]);
        iso_pool_destroy(pool);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    free(bytes[0]);
    free(bytes[1]);
    iso_aov_free(&aov);
}

static iso_vec3 transform(const float m[16], iso_vec3 p, double *w) {
    const double in[4] = {p.x, p.y, p.z, 1};
    double out[4] = {0};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) out[i] += in[j] * (double)m[4 * j + i];
    *w = out[3];
    return iso_vec3_make(out[0], out[1], out[2]);
}

static void matrices_are_the_view(void **state) {
    (void)state;
    iso_aov aov = random_aov(40, 20);
    for (int orthographic = 0; orthographic < 2; orthographic++) {
        const iso_camera camera = {.position = {30, -80, 25},
                                   .focal_point = {1, 2, 3},
                                   .view_up = {0.1, 0, 1},
                                   .view_angle = 35,
                                   .orthographic = orthographic,
                                   .parallel_scale = 20};
        const iso_view view = iso_view_make(&camera, 40, 20);
        assert_int_equal(iso_exr_write(PATH, &aov, &(iso_exr_info){.view = &view}, NULL, NULL), ISO_OK);
        float to_camera[16], to_ndc[16];
        assert_int_equal(exr_read_matrix(PATH, "worldToCamera", to_camera), 0);
        assert_int_equal(exr_read_matrix(PATH, "worldToNDC", to_ndc), 0);
        const iso_vec3 points[] = {{1, 2, 3}, {-7, 4, 12}, {15, 0, -4}};
        for (size_t k = 0; k < 3; k++) {
            double w;
            iso_vec3 v = iso_view_point(&view, points[k]), c = transform(to_camera, points[k], &w);
            assert_true(fabs(c.x - v.x) + fabs(c.y + v.y) + fabs(c.z - v.z) < 1e-3 && w == 1);
            iso_vec3 ndc = transform(to_ndc, points[k], &w);
            double scale = view.focal / (orthographic ? 1 : v.z);
            assert_true(fabs(ndc.x / w - (view.cx + scale * v.x) / 40) < 1e-4);
            assert_true(fabs(ndc.y / w - (view.cy + scale * v.y) / 20) < 1e-4);
        }
    }
    iso_aov_free(&aov);
}

static void bad_targets_are_write_errors(void **state) {
    (void)state;
    iso_aov aov = random_aov(300, 300);
    const char *const targets[] = {ISO_TEST_TMP "/no/such/folder.exr", ISO_TEST_TMP, "/dev/full"};
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (size_t k = 0; k < sizeof targets / sizeof *targets; k++) {
        iso_error error = {0};
        assert_int_equal(iso_exr_write(targets[k], &aov, NULL, pool, &error), ISO_ERR_WRITE);
        assert_non_null(strstr(error.text, targets[k]));
    }
    assert_int_equal(iso_exr_write("-", &aov, NULL, pool, NULL), ISO_ERR_USAGE);
    iso_pool_destroy(pool);
    iso_aov_free(&aov);
}

static void sides_are_checked(void **state) {
    (void)state;
    iso_aov aov = {0};
    assert_int_equal(iso_aov_create(0, 5, &aov, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_aov_create(5, ISO_IMAGE_MAX + 1, &aov, NULL), ISO_ERR_USAGE);
    assert_null(aov.depth);
}

/* ---- what others write */

/* Exact in half precision. The first column is empty, with values that the reader replaces. */
static float value(int channel, int x, int y) {
    if (channel == 0) return x ? 0.5f : 0;
    return x ? (float)(channel * 16 + x - y) / 64 : 9;
}

static float bad_value(int channel, int x, int y) {
    return channel == 0 && x == 3 && y == 21 ? 1.5f : value(channel, x, y);
}

static float nan_value(int channel, int x, int y) {
    return channel == 2 && x == 5 && y == 0 ? NAN : value(channel, x, y);
}

static exr_picture good_picture(void) {
    exr_picture picture = {.width = 50,
                           .height = 34,
                           .names = {"A", "N.X", "N.Y", "N.Z", "Z"},
                           .value = value,
                           .compression = ZIP};
    return picture;
}

static void assert_values(const exr_picture *picture) {
    assert_int_equal(exr_write(PATH, picture), 0);
    iso_aov aov;
    iso_error error = {0};
    if (iso_exr_read(PATH, NULL, &aov, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_int_equal(aov.width, picture->width);
    assert_int_equal(aov.height, picture->height);
    assert_true(aov.voxel == 0 && !aov.ids[0]);
    for (int y = 0; y < aov.height; y++)
        for (int x = 0; x < aov.width; x++)
            for (int c = 0; c < ISO_AOV_PLANES; c++) {
                float empty = c == 4 ? INFINITY : 0;
                assert_true(plane(&aov, c)[y * aov.width + x] == (x ? value(c, x, y) : empty));
            }
    iso_aov_free(&aov);
}

static void pictures_of_others_are_read(void **state) {
    (void)state;
    const int compressions[] = {0, RLE, ZIPS, ZIP};
    for (size_t k = 0; k < 8; k++) {
        exr_picture picture = good_picture();
        picture.half = k >= 4;
        picture.compression = compressions[k % 4];
        picture.min_x = k % 3 ? 0 : -7;
        picture.min_y = k % 2 ? 11 : 0;
        assert_values(&picture);
    }
    exr_picture more = good_picture();
    more.names[5] = "R";
    assert_values(&more);
    more.names[5] = "id.surface"; /* no integers: another program's */
    assert_values(&more);
}

static void unfit_pictures_are_refused(void **state) {
    (void)state;
    for (int c = 0; c < ISO_AOV_PLANES; c++) {
        exr_picture missing = good_picture();
        missing.names[c] = "other";
        assert_int_equal(exr_write(PATH, &missing), 0);
        char reason[64];
        snprintf(reason, sizeof reason, "channel %s is missing", NAMES[c]);
        assert_refused(ISO_ERR_FORMAT, reason);
    }
    exr_picture kinds[7];
    for (int k = 0; k < 7; k++) kinds[k] = good_picture();
    kinds[0].tiled = 1;
    kinds[1].compression = PIZ;
    kinds[2].integers = 1;
    kinds[3].subsampled = 2;
    kinds[4].width = ISO_IMAGE_MAX + 1;
    kinds[4].height = 1;
    kinds[5].value = bad_value;
    kinds[6].value = nan_value;
    const char *const reasons[] = {"tiled",   "compression",    "integers", "subsampled",
                                   "16385x1", "3,21: coverage", "5,0: "};
    for (int k = 0; k < 7; k++) {
        assert_int_equal(exr_write(PATH, &kinds[k]), 0);
        assert_refused(ISO_ERR_FORMAT, reasons[k]);
    }
}

static void what_is_no_picture_is_refused(void **state) {
    (void)state;
    unlink(PATH);
    assert_refused(ISO_ERR_IO, "No such file");
    spill(PATH, "\x89PNG\r\n\x1a\nand more of that kind", 30);
    assert_refused(ISO_ERR_FORMAT, "not a readable OpenEXR picture");
    spill(PATH, "", 0);
    assert_refused(ISO_ERR_FORMAT, "not a readable OpenEXR picture");
    iso_aov aov;
    iso_error error = {0};
    assert_int_equal(iso_exr_read(ISO_TEST_TMP, NULL, &aov, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "folder"));
}

static void truncated_files_are_refused(void **state) {
    (void)state;
    iso_aov aov = random_aov(90, 70);
    assert_int_equal(iso_exr_write(PATH, &aov, NULL, NULL, NULL), ISO_OK);
    size_t size;
    uint8_t *bytes = slurp(PATH, &size);
    for (size_t length = 1; length < size; length += length < 900 ? 1 : 997) {
        spill(PATH, bytes, length);
        assert_refused(ISO_ERR_FORMAT, "not a readable OpenEXR picture");
    }
    spill(PATH, bytes, size - 1);
    assert_refused(ISO_ERR_FORMAT, "not a readable OpenEXR picture");
    free(bytes);
    iso_aov_free(&aov);
}

/* Damage is refused or gives a picture whose values keep what the header promises; it never crashes. */
static void damaged_files_do_no_harm(void **state) {
    (void)state;
    iso_aov aov = random_aov(40, 37);
    assert_int_equal(iso_exr_write(PATH, &aov, NULL, NULL, NULL), ISO_OK);
    size_t size;
    uint8_t *bytes = slurp(PATH, &size), *copy = malloc(size);
    uint32_t seed = 5;
    int refused = 0;
    for (int round = 0; round < 1000; round++) {
        memcpy(copy, bytes, size);
        size_t reach = round % 2 ? size : 700; /* the header and the table of chunks, or anything */
        for (int k = 0; k < 1 + round % 3; k++)
            copy[random_bits(&seed) % reach] = (uint8_t)random_bits(&seed);
        spill(PATH, copy, size);
        iso_aov back;
        iso_error error = {0};
        if (iso_exr_read(PATH, NULL, &back, &error) != ISO_OK) {
            assert_true(strstr(error.text, PATH) && !strchr(error.text, '\n'));
            refused++;
            continue;
        }
        for (size_t i = 0; i < pixels(&back); i++)
            assert_true(back.coverage[i] >= 0 && back.coverage[i] <= 1 &&
                        (isfinite(back.depth[i]) != 0) == (back.coverage[i] > 0));
        iso_aov_free(&back);
    }
    assert_true(refused > 300);
    free(copy);
    free(bytes);
    iso_aov_free(&aov);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read),       cmocka_unit_test(others_read_it),
        cmocka_unit_test(threads_do_not_matter),         cmocka_unit_test(matrices_are_the_view),
        cmocka_unit_test(bad_targets_are_write_errors),  cmocka_unit_test(sides_are_checked),
        cmocka_unit_test(pictures_of_others_are_read),   cmocka_unit_test(unfit_pictures_are_refused),
        cmocka_unit_test(what_is_no_picture_is_refused), cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(damaged_files_do_no_harm),      cmocka_unit_test(ids_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
