/* Normals that are estimated for the vertices of scanned meshes, without their faces, against the normals of
 * the faces; files of ../shared/points. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "check_support.h"
#include "clouds/cloud.h"
#include "glyphs_support.h"
#include "index_support.h"

/* Gives every point a colour of its own, by which it is found again in the cloud. */
static void number_points(iso_glyphs *glyphs) {
    iso_free(glyphs->colors);
    glyphs->colors = iso_alloc(glyphs->count * sizeof *glyphs->colors);
    assert_non_null(glyphs->colors);
    for (size_t i = 0; i < glyphs->count; i++)
        for (int k = 0; k < 3; k++) glyphs->colors[i][k] = (uint8_t)(i >> 8 * k);
}

static double length_of(const float v[3]) {
    return sqrt((double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2]);
}

/* sign: 1 where the faces' normals point out of the solid, -1 where they point into it. */
static void check_mesh(const char *name, int sign, double most_median) {
    iso_glyphs glyphs = read_with(index_path("points", name), (iso_read_opts){.normals_from_faces = true});
    const iso_cloud_opts opts = {.estimate_normals = true};
    iso_cloud cloud;
    iso_error error = {0};
    size_t count = 0, right = 0;
    double *angles = malloc(glyphs.count * sizeof *angles);
    number_points(&glyphs);
    test_ok(iso_cloud_make(&glyphs, &opts, &cloud, &error), &error);
    assert_int_equal(cloud.estimated_normals, glyphs.count);
    for (size_t i = 0; i < cloud.count; i++) {
        const uint8_t *number = cloud.colors[i];
        const float *a = glyphs.directions[number[0] | number[1] << 8 | number[2] << 16],
                    *b = cloud.surfels[i].normal;
        const double length = length_of(a);
        if (!(length > 0)) continue; /* a point without a face */
        const double dot =
            sign * ((double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2]) /
            length;
        right += dot > 0;
        angles[count++] = acos(fmin(fabs(dot), 1)) * 180 / acos(-1);
    }
    qsort(angles, count, sizeof *angles, iso_compare_doubles);
    printf("%s: %zu points, median %.2f degrees, 95 %% below %.1f, %.2f %% turned right\n", name, count,
           angles[count / 2], angles[count * 95 / 100], 100.0 * (double)right / (double)count);
    if (angles[count / 2] > most_median) fail_msg("%s: median %g degrees", name, angles[count / 2]);
    if ((double)right < 0.99 * (double)count) fail_msg("%s: %zu of %zu turned right", name, right, count);
    iso_cloud_free(&cloud);
    iso_glyphs_free(&glyphs);
    free(angles);
}

static void test_meshes(void **state) {
    (void)state;
    free(load_index("points")); /* skips when there are none */
    check_mesh("scans/bunny.ply", -1, 1.2);
    check_mesh("scans/horse.ply", -1, 0.8);
    check_mesh("scans/igea.ply", 1, 0.7);
    /* (620 and 2,775 vertices: neighbours lie around bends) */
    check_mesh("scans/cactus.off", 1, 4);
    check_mesh("scans/elephant.off", 1, 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
