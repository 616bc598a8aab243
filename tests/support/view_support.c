/* view_support: transforms and views of grids, and comparisons of gbuffers. */
#include "view_support.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

iso_transform test_transform(int kind) {
    iso_transform transform = iso_transform_identity();
    if (kind == 0) return transform;
    /* columns: a rotation (from an integer quaternion), mirrored for kind 2 */
    const double rotation[9] = {2.0 / 3,  -1.0 / 3, 2.0 / 3, 2.0 / 3, 2.0 / 3,
                                -1.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3};
    const double spacing[3] = {0.7, 1.9, 1.2};
    for (int i = 0; i < 9; i++) transform.direction[i] = rotation[i] * (kind == 2 && i % 3 == 1 ? -1 : 1);
    for (int i = 0; i < 3; i++) {
        transform.spacing[i] = spacing[i];
        transform.origin[i] = 31.25 - 17 * i;
    }
    return transform;
}

void test_set_transform(const iso_grid *grid, int kind) {
    if (grid->rgrid)
        grid->rgrid->transform = test_transform(kind);
    else
        grid->hgrid->transform = test_transform(kind);
}

iso_view test_view_make(const iso_grid *grid, test_view kind, int size, iso_vec3 away) {
    const int *dims = iso_grid_dims(grid);
    iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    iso_vec3 middle = iso_affine_point(
        &affine, iso_vec3_make(0.5 * (dims[0] - 1), 0.5 * (dims[1] - 1), 0.5 * (dims[2] - 1)));
    double reach = iso_vec3_length(iso_vec3_sub(middle, iso_affine_point(&affine, (iso_vec3){0, 0, 0})));
    iso_camera camera = {.focal_point = middle,
                         .position = iso_vec3_add(middle, iso_vec3_scale(away, 2.2 * reach)),
                         .view_up = {0.1, 0.3, 1},
                         .view_angle = 45,
                         .orthographic = kind == TEST_ORTHOGRAPHIC,
                         .parallel_scale = 0.7 * reach};
    if (kind == TEST_INSIDE) {
        camera.position = iso_vec3_add(middle, iso_vec3_scale(away, 0.1 * reach));
        camera.view_angle = 100;
    }
    iso_view view = iso_view_make(&camera, size, size);
    if (kind == TEST_CUT) view.near = 2.2 * reach;
    return view;
}

iso_view test_axis_view(int axis, bool up, double step, double first, int size) {
    iso_view view = {
        .focal = 1 / step, .width = size, .height = size, .orthographic = true, .near = -DBL_MAX};
    int right = (axis + 1) % 3, down = (axis + 2) % 3;
    view.rotation[right] = 1;
    view.rotation[3 + down] = up ? 1 : -1;
    view.rotation[6 + axis] = up ? 1 : -1;
    view.cx = 0.5 - first / step;
    view.cy = up ? view.cx : 0.5 + first / step + (size - 1);
    return view;
}

size_t test_covered(const iso_gbuffer *gbuffer) {
    size_t count = 0;
    for (int i = 0; i < gbuffer->width * gbuffer->height; i++) count += isfinite(gbuffer->depth[i]) != 0;
    return count;
}

void test_same_pictures(const iso_gbuffer *a, const iso_gbuffer *b) {
    size_t samples = (size_t)(a->width * a->height);
    assert_memory_equal(a->depth, b->depth, samples * sizeof *a->depth);
    assert_memory_equal(a->surface, b->surface, samples);
    for (size_t i = 0; i < samples; i++)
        for (int axis = 0; axis < 3 && isfinite(a->depth[i]); axis++)
            assert_memory_equal(&a->normal[axis][i], &b->normal[axis][i], sizeof(float));
}
