/* Isovalues of level sets are millimetres: a ball in voxels of several sizes gives spheres of the same radii
 * in points, mesh, exact cells and rays; the histogram has millimetres too; the narrow band limits what can
 * be asked for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "check_support.h"
#include "exact/exact.h"
#include "extract/isovalue/isovalue.h"
#include "extract_support.h"
#include "image/image.h"
#include "render/picture.h"
#include "truth/raycast.h"

enum { SIDE = 64 };
static const double RADIUS = 12; /* voxels */
static const double VOXELS[] = {0.5, 1, 3};

/* A ball around the world's origin. */
static iso_grid ball(double voxel) {
    const double middle = (SIDE - 1) / 2.0;
    iso_grid grid = test_ball_grid(SIDE, iso_vec3_make(middle, middle, middle), RADIUS, 0);
    iso_transform *transform = &grid.hgrid->transform;
    for (int axis = 0; axis < 3; axis++) {
        transform->spacing[axis] = voxel;
        transform->origin[axis] = -middle * voxel;
    }
    return grid;
}

static double world_radius(const iso_grid *grid, const int32_t brick[3], const float position[3]) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    const iso_vec3 index = iso_vec3_make((double)ISO_BRICK * brick[0] + (double)position[0],
                                         (double)ISO_BRICK * brick[1] + (double)position[1],
                                         (double)ISO_BRICK * brick[2] + (double)position[2]);
    return iso_vec3_length(iso_affine_point(&affine, index));
}

static void check_points(const iso_grid *grid, iso_primitive primitive, double isovalue, double radius) {
    const iso_points_opts opts = {.isovalue = isovalue, .primitive = primitive, .floats = true};
    const double voxel = iso_grid_transform(grid)->spacing[0];
    iso_point_set *set;
    assert_int_equal(iso_point_set_create(grid, &opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    const iso_point_view view = iso_point_set_view(set);
    const double area = 4 * ISO_PI * radius * radius / (voxel * voxel);
    assert_true((double)iso_point_view_count(&view) > area); /* no holes: 1.5 edge points a voxel of area */
    for (size_t s = 0; s < view.span_count; s++)
        for (uint32_t i = 0; i < view.spans[s].count; i++) {
            const iso_surfel point = iso_point_view_get(&view, view.spans[s].first + i);
            near(world_radius(grid, view.spans[s].brick, point.position), radius, 0.03 * voxel);
        }
    iso_point_set_destroy(set);
}

static void check_mesh(const iso_grid *grid, double isovalue, double radius) {
    const iso_mesh_opts opts = {.isovalue = isovalue};
    iso_mesh_set *set;
    assert_int_equal(iso_mesh_set_create(grid, &opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    const iso_mesh_view view = iso_mesh_set_view(set);
    assert_true(iso_mesh_view_triangle_count(&view) > 1000);
    for (size_t s = 0; s < view.span_count; s++)
        for (uint32_t i = 0; i < view.spans[s].owned_count; i++) {
            const iso_surfel *vertex = &view.vertices[view.spans[s].first_vertex + i];
            near(world_radius(grid, view.spans[s].brick, vertex->position), radius,
                 0.03 * iso_grid_transform(grid)->spacing[0]);
        }
    iso_mesh_set_destroy(set);
}

static void check_exact(const iso_grid *grid, double isovalue, double radius) {
    const iso_exact_opts opts = {.isovalue = isovalue};
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    iso_exact *exact;
    assert_int_equal(iso_exact_create(grid, &opts, &exact, NULL), ISO_OK);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_OK);
    const iso_box box = iso_exact_bounds(exact, &affine);
    near(box.hi.x, radius, 0.03 * affine.m[0]);
    near(box.lo.z, -radius, 0.03 * affine.m[0]);
    iso_exact_destroy(exact);
}

static iso_status draw_rays(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const iso_target target = {view, gbuffer, NULL, 0, NULL};
    return iso_draw_raycast(&target, context, error);
}

/* The disc in an orthographic picture of 256 pixels a side: its area is that of the circle. */
static void check_rays(const iso_grid *grid, double isovalue, double radius) {
    enum { PIXELS = 256 };
    const iso_rgb color = {200, 100, 50};
    const iso_camera camera = {.position = {0, -10 * radius, 0},
                               .view_up = {0, 0, 1},
                               .view_angle = 30,
                               .orthographic = true,
                               .parallel_scale = 1.2 * radius};
    iso_raycaster *caster;
    assert_int_equal(iso_raycaster_create(grid, isovalue, NULL, &caster, NULL), ISO_OK);
    const iso_picture_opts opts = {.camera = &camera,
                                   .width = PIXELS,
                                   .height = PIXELS,
                                   .samples = 1,
                                   .shading = {&color, 1, {255, 255, 255}, false, {0, 0, 0}},
                                   .draw = draw_rays,
                                   .draw_context = caster};
    iso_image image;
    size_t covered;
    assert_int_equal(iso_image_create(PIXELS, PIXELS, &image, NULL), ISO_OK);
    assert_int_equal(iso_picture_render(&opts, &image, &covered, NULL), ISO_OK);
    const double millimetres = 2 * camera.parallel_scale / PIXELS;
    near(sqrt((double)covered / ISO_PI) * millimetres, radius, 0.01 * radius);
    iso_image_free(&image);
    iso_raycaster_destroy(caster);
}

static void check(double voxel, double isovalue) {
    iso_grid grid = ball(voxel);
    const double radius = RADIUS * voxel + isovalue;
    assert_int_equal(iso_isovalue_check(&grid, isovalue, NULL), ISO_OK);
    check_points(&grid, ISO_PRIMITIVE_AUTO, isovalue, radius);
    check_points(&grid, ISO_PRIMITIVE_EDGE, isovalue, radius);
    check_mesh(&grid, isovalue, radius);
    check_exact(&grid, isovalue, radius);
    check_rays(&grid, isovalue, radius);
    iso_grid_destroy(&grid);
}

static void isovalues_are_millimetres(void **state) {
    (void)state;
    const double isovalues[] = {0, 0.9, -0.6}; /* mm: within the band of the smallest voxels */
    for (size_t v = 0; v < sizeof VOXELS / sizeof *VOXELS; v++)
        for (size_t i = 0; i < sizeof isovalues / sizeof *isovalues; i++) check(VOXELS[v], isovalues[i]);
}

static void stored_and_physical_values_correspond(void **state) {
    (void)state;
    iso_grid grid = ball(0.5);
    assert_true(iso_grid_stored(&grid, 1) == 2 && iso_grid_physical(&grid, 2) == 1 &&
                iso_grid_scale(&grid) == 0.5);
    iso_histogram histogram;
    assert_int_equal(iso_histogram_compute(&grid, NULL, &histogram, NULL), ISO_OK);
    assert_true(histogram.minimum == -1.5 && histogram.maximum == 1.5);
    iso_grid_destroy(&grid);
}

static void the_band_limits_isovalues(void **state) {
    (void)state;
    iso_grid grid = ball(0.5), dense = test_rgrid((const int[]){4, 4, 4}, ISO_UINT8);
    iso_error error = {0};
    assert_int_equal(iso_isovalue_check(&grid, 1.499, &error), ISO_OK);
    assert_int_equal(iso_isovalue_check(&grid, -1.5, &error), ISO_ERR_EMPTY);
    assert_int_equal(iso_isovalue_check(&grid, 1.5, &error), ISO_ERR_EMPTY);
    assert_string_equal(
        error.text, "no surface at isovalue 1.5: the level set's narrow band is 1.5 mm wide on either side");
    assert_int_equal(iso_isovalue_check(&dense, 1e9, &error), ISO_OK);
    iso_grid_destroy(&grid);
    iso_grid_destroy(&dense);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(isovalues_are_millimetres),
        cmocka_unit_test(stored_and_physical_values_correspond),
        cmocka_unit_test(the_band_limits_isovalues),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
