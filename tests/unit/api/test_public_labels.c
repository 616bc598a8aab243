/* Surfaces of labels through the public interface: of one label, of several, their measures, and errors. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "isopoint.h"

enum { SIDE = 40 };

/* A ball of radius 12, half of it label 7, half 500. */
static iso_volume *lend_labels(uint16_t *voxels) {
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                const double dx = x - 19.3, dy = y - 20.1, dz = z - 18.8;
                const int label = dx * dx + dy * dy + dz * dz < 144 ? x < 20 ? 7 : 500 : 0;
                voxels[(z * SIDE + y) * SIDE + x] = (uint16_t)label;
            }
    const iso_lend_opts desc = {.dims = {SIDE, SIDE, SIDE}, .type = ISO_UINT16, .data = voxels};
    iso_volume *volume = NULL;
    assert_int_equal(iso_volume_lend(&desc, &volume, NULL), ISO_OK);
    return volume;
}

static double volume_of(iso_volume *volume, const int *labels, int count) {
    iso_surface *surface = NULL;
    iso_mesh_measures measures;
    const iso_surface_opts opts = {.labels = labels, .label_count = count};
    assert_int_equal(iso_surface_create(volume, &opts, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_measure(surface, &measures, NULL), ISO_OK);
    assert_int_equal(measures.open_edges, 0);
    assert_int_equal(iso_surface_set_isovalue(surface, 1, NULL), ISO_ERR_USAGE);
    iso_surface_destroy(surface);
    return measures.volume;
}

static void labels_are_solids(void **state) {
    (void)state;
    static uint16_t voxels[SIDE * SIDE * SIDE];
    iso_volume *volume = lend_labels(voxels);
    const int both[2] = {7, 500};
    const double ball = 4.0 / 3 * 3.14159265358979 * 12 * 12 * 12, all = volume_of(volume, both, 2),
                 parts = volume_of(volume, both, 1) + volume_of(volume, both + 1, 1);
    print_message("ball %.1f, both labels %.1f, sum of each %.1f mm3\n", ball, all, parts);
    assert_true(fabs(all / ball - 1) < 0.002);
    assert_true(fabs(parts / all - 1) < 0.015); /* (each has a sharp edge of its own) */
    iso_volume_destroy(volume);
}

static void labels_are_drawn(void **state) {
    (void)state;
    static uint16_t voxels[SIDE * SIDE * SIDE];
    iso_volume *volume = lend_labels(voxels);
    const int label[2] = {7, 500};
    const iso_rgb red = {255, 0, 0};
    iso_surface *surfaces[2] = {NULL};
    iso_image image = {0};
    for (int i = 0; i < 2; i++)
        assert_int_equal(
            iso_surface_create(
                volume, &(iso_surface_opts){.labels = &label[i], .label_count = 1, .color = i ? &red : NULL},
                &surfaces[i], NULL),
            ISO_OK);
    assert_int_equal(
        iso_render_surfaces(surfaces, 2, &(iso_render_opts){.width = 64, .height = 64}, &image, NULL),
        ISO_OK);
    const uint8_t *left = image.rgba + 4 * (32 * 64 + 20), *right = image.rgba + 4 * (32 * 64 + 44);
    assert_true(left[1] > 60 && right[1] < 60 && right[0] > 60);
    iso_image_free(&image);
    for (int i = 0; i < 2; i++) iso_surface_destroy(surfaces[i]);
    iso_volume_destroy(volume);
}

static void errors_are_told(void **state) {
    (void)state;
    static uint16_t voxels[SIDE * SIDE * SIDE];
    iso_volume *volume = lend_labels(voxels);
    iso_surface *surface = NULL;
    iso_error error = {0};
    const int label = 7, other = 8;
    const iso_surface_opts bad[] = {{.labels = &label},
                                    {.label_count = 1},
                                    {.labels = &label, .label_count = 1, .isovalue = 2},
                                    {.labels = &label, .label_count = -1}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(iso_surface_create(volume, &bad[i], &surface, &error), ISO_ERR_USAGE);
    assert_int_equal(
        iso_surface_create(volume, &(iso_surface_opts){.labels = &other, .label_count = 1}, &surface, &error),
        ISO_ERR_EMPTY);
    assert_non_null(strstr(error.text, "no voxel has the label 8"));
    iso_volume_destroy(volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(labels_are_solids),
                                       cmocka_unit_test(labels_are_drawn), cmocka_unit_test(errors_are_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
