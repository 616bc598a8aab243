/* exact: every real volume, from all sides and near by, against the ray caster. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "exact_support.h"
#include "grids/scenes/scenes.h"
#include "grids/volume/volume.h"

enum { SIZE = 112 };

/* The whole surface seen from a direction. */
static iso_view whole_view(const iso_grid *grid, double isovalue, iso_direction direction,
                           bool orthographic) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    iso_exact *exact = make_exact(grid, isovalue, NULL);
    const iso_box box = iso_exact_bounds(exact, &affine);
    iso_exact_destroy(exact);
    iso_camera camera = {.view_angle = 30, .orthographic = orthographic, .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors(direction, iso_vec3_make(0, 0, 1), &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -1);
    if (direction == ISO_ISOMETRIC) iso_camera_orbit(&camera, 17, -9);
    iso_camera_fit(&camera, &box, 1, 1);
    return iso_view_make(&camera, SIZE, SIZE);
}

/* The silhouette's pixel that is nearest to the middle. */
static void find_silhouette(const iso_gbuffer *gbuffer, int pixel[2]) {
    double nearest = INFINITY;
    pixel[0] = pixel[1] = SIZE / 2;
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x + 1 < SIZE; x++) {
            const size_t at = (size_t)y * SIZE + (size_t)x;
            const double distance = hypot(x - SIZE / 2, y - SIZE / 2);
            if (!isfinite(gbuffer->depth[at]) == !isfinite(gbuffer->depth[at + 1]) || distance >= nearest)
                continue;
            nearest = distance;
            pixel[0] = x;
            pixel[1] = y;
        }
}

static void zoom_to(iso_view *view, const int pixel[2], double factor) {
    view->focal *= factor;
    view->cx = SIZE / 2.0 + factor * (view->cx - (pixel[0] + 0.5));
    view->cy = SIZE / 2.0 + factor * (view->cy - (pixel[1] + 0.5));
}

/* A pixel a voxel, about, in the middle of the surface. */
static double pixel_a_voxel(const iso_grid *grid, const iso_view *view, const iso_gbuffer *gbuffer) {
    double nearest = INFINITY;
    for (int i = 0; i < SIZE * SIZE; i++) nearest = fmin(nearest, (double)gbuffer->depth[i]);
    const double *spacing = iso_grid_transform(grid)->spacing;
    const double voxel = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    return view->orthographic ? 1 / (voxel * view->focal) : nearest / (voxel * view->focal);
}

static void judge_volume(const char *name, const iso_grid *grid, double isovalue) {
    test_verdict verdict = {0};
    for (int direction = ISO_FRONT; direction <= ISO_ISOMETRIC; direction++) {
        const iso_view view = whole_view(grid, isovalue, (iso_direction)direction, direction % 2);
        judge(grid, isovalue, &view, &verdict);
        if (direction != ISO_FRONT && direction != ISO_ISOMETRIC) continue;
        iso_gbuffer gbuffer = picture_of(grid, isovalue, &view, NULL);
        int pixel[2];
        find_silhouette(&gbuffer, pixel);
        const double factors[] = {pixel_a_voxel(grid, &view, &gbuffer), 2, 4, 16, 64};
        for (int i = 0; i < 5; i++) {
            iso_view closer = view;
            zoom_to(&closer, pixel, factors[i]);
            if (factors[i] > 1) judge(grid, isovalue, &closer, &verdict);
        }
        iso_gbuffer_free(&gbuffer);
    }
    print_message("    %-36s %7zu hits of %zu samples, %zu missing, %zu extra, %zu deep, %zu tinted\n", name,
                  verdict.hits, verdict.samples, verdict.missing, verdict.extra, verdict.deep,
                  verdict.tinted);
    assert_true(verdict.hits > verdict.samples / 20);
    /* what is allowed a picture of a million samples, for all of these together */
    assert_int_equal(verdict.missing, 0);
    assert_true(verdict.extra <= 2);
    assert_true(verdict.deep <= 5);
    assert_int_equal(verdict.tinted, 0);
}

/* ---- the index of volumes */

enum { NAME, PATH, FORMAT, DIMS, TYPE, SPACING, LOW, HIGH, ISOVALUE, COLUMNS };

/* Cuts a line in fields; false for what is not a volume. */
static bool parse_row(char *line, const char *field[COLUMNS]) {
    for (int i = 0; i < COLUMNS; i++) {
        field[i] = line;
        line = strchr(line, '\t');
        if (!line) return false;
        *line++ = 0;
    }
    return strcmp(field[NAME], "name") != 0;
}

static void judge_row(const char *const field[COLUMNS]) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", ISO_TEST_VOLUMES, field[PATH]);
    iso_raw_layout raw = {.dims = {128, 128, 128}, .type = ISO_UINT8};
    if (strstr(field[FORMAT], "62-byte header")) {
        raw.dims[2] = 84;
        raw.offset = 62;
    }
    const bool is_raw = strstr(field[FORMAT], "raw + .dat") || raw.offset;
    const iso_volume_opts opts = {.raw = is_raw ? &raw : NULL};
    iso_volume volume = {0};
    iso_error error = {0};
    const iso_status status = iso_volume_read(path, &opts, &volume, &error);
    if (status == ISO_ERR_UNSUPPORTED) {
        print_message("    %s: left out: %s\n", field[PATH], error.text);
        return;
    }
    if (status != ISO_OK) fail_msg("%s", error.text);
    /* the index gives stored isovalues; a slope or a rescale moves them */
    double isovalue = atof(field[ISOVALUE]);
    if (volume.grid.rgrid) isovalue = isovalue * volume.grid.rgrid->scale + volume.grid.rgrid->offset;
    judge_volume(field[PATH], &volume.grid, isovalue);
    iso_volume_free(&volume);
}

static void real_volumes_equal_raycast(void **state) {
    (void)state;
    FILE *file = fopen(ISO_TEST_VOLUMES "/INDEX.tsv", "r");
    if (!file) {
        print_message("no real volumes in %s: left out\n", ISO_TEST_VOLUMES);
        skip();
    }
    char line[4096];
    const char *field[COLUMNS];
    int rows = 0;
    while (fgets(line, sizeof line, file)) {
        if (!parse_row(line, field)) continue;
        judge_row(field);
        rows++;
    }
    fclose(file);
    assert_true(rows > 10);
}

static void scenes_equal_raycast(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "cylinder", "cube", "torus", "head", "gyroid", "ct"};
    for (int i = 0; i < 7; i++) {
        iso_grid grid = {0};
        double isovalue;
        const iso_scene_opts opts = {.size = i == 4 ? 96 : 64};
        assert_int_equal(iso_scene_create(names[i], &opts, &grid, &isovalue, NULL), ISO_OK);
        judge_volume(names[i], &grid, isovalue);
        iso_grid_destroy(&grid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_equal_raycast),
        cmocka_unit_test(real_volumes_equal_raycast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
