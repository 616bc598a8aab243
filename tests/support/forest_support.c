#include "forest_support.h"

#include <stdlib.h>
#include <string.h>

void test_forest_make_lods(test_forest *f) {
    iso_error error = {0};
    for (int s = 0; s < TEST_FOREST_SETS; s++) {
        const iso_point_view *points = &f->scenes[s].points;
        test_ok(iso_lod_update(&f->lods[s], points, NULL, &error), &error);
        f->sets[s] = (iso_instanced){&f->lods[s], iso_point_view_bounds(points), points->radius};
    }
}

/* Places an instance at (x, y), turned by an angle of which the cosine and sine are given. */
static iso_transform place(const iso_transform *own, double x, double y, double size, const double turn[2]) {
    iso_transform t = *own;
    const double direction[9] = {turn[0], -turn[1], 0, turn[1], turn[0], 0, 0, 0, 1};
    memcpy(t.direction, direction, sizeof direction);
    for (int axis = 0; axis < 3; axis++) t.spacing[axis] *= size;
    t.origin[0] = x;
    t.origin[1] = y;
    t.origin[2] = 0;
    return t;
}

test_forest *test_forest_make(size_t count) {
    static const char *const names[TEST_FOREST_SETS] = {"head", "sphere"};
    test_forest *f = calloc(1, sizeof *f);
    uint32_t seed = 17;
    assert_non_null(f);
    for (int s = 0; s < TEST_FOREST_SETS; s++) {
        f->scenes[s] = test_scene_make(names[s], 24, NULL, true);
        f->scenes[s].points.curvatures = NULL;
    }
    test_forest_make_lods(f);
    for (size_t i = 0; i < count; i++) {
        const double angle = 6.28 * uniform(&seed), turn[2] = {cos(angle), sin(angle)};
        const uint32_t set = i % 3 == 0;
        const iso_transform *own = &f->scenes[set].points.transform;
        const double side = own->spacing[0] * 24;
        f->instances[i] = (iso_instance){set, place(own, side * 9 * (uniform(&seed) - 0.5),
                                                    side * 20 * uniform(&seed), 0.6 + uniform(&seed), turn)};
        const double scale = 24 * own->spacing[0] / (24 * f->scenes[0].points.transform.spacing[0]);
        for (int axis = 0; axis < 3; axis++) f->instances[i].transform.spacing[axis] /= scale;
    }
    f->all = (iso_instances){
        .sets = f->sets, .instances = f->instances, .set_count = TEST_FOREST_SETS, .count = count};
    return f;
}

void test_forest_free(test_forest *f) {
    for (int s = 0; s < TEST_FOREST_SETS; s++) {
        iso_lod_free(&f->lods[s]);
        test_scene_free(&f->scenes[s]);
    }
    free(f);
}

double test_forest_side(const test_forest *f) {
    return f->scenes[0].points.transform.spacing[0] * 24;
}

iso_view test_forest_view(const test_forest *f, int number, int width, int height) {
    const double side = test_forest_side(f), way = number % 40 < 20 ? 1 : -1;
    const double from = number * 0.05 * side - 3 * side;
    iso_camera camera = {.view_up = {0, 0, 1}, .view_angle = 50, .orthographic = number % 7 == 6};
    camera.position = iso_vec3_make(side * 0.3 * (number % 5), from, 0.7 * side);
    camera.focal_point = iso_vec3_make(0, from + way * side, 0.65 * side);
    camera.parallel_scale = 3 * side;
    return iso_view_make(&camera, width, height);
}

void test_wall_make(test_wall *wall, double behind) {
    enum { SIDE = 32 };
    const double gap[2] = {0.5, 0.1}, cosine = 0.35, sine = sqrt(1 - cosine * cosine);
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < SIDE * SIDE; i++) {
            const double x = gap[k] * (i % SIDE - SIDE / 2), y = gap[k] * (i / SIDE - SIDE / 2);
            wall->surfels[k][i] =
                (iso_surfel){{(float)x, (float)(k ? cosine * y : y), (float)(k ? sine * y : 0)},
                             {0, (float)(k ? sine : 0), (float)(k ? -cosine : -1)}};
        }
        wall->spans[k] = (iso_point_span){.count = SIDE * SIDE};
        wall->lods[k] = (iso_lod){.points = {.surfels = wall->surfels[k],
                                             .spans = &wall->spans[k],
                                             .span_count = 1,
                                             .transform = iso_transform_identity(),
                                             .radius = 0.75 * gap[k]},
                                  .count = 1};
        const iso_point_view *points = &wall->lods[k].points;
        wall->sets[k] = (iso_instanced){&wall->lods[k], iso_point_view_bounds(points), points->radius};
        wall->instances[k] = (iso_instance){(uint32_t)k, points->transform};
        wall->instances[k].transform.origin[2] =
            40 + (k ? behind + sine * gap[1] * SIDE / 2 + 1.45 * points->radius : 0);
    }
    wall->all = (iso_instances){.sets = wall->sets, .instances = wall->instances, .set_count = 2, .count = 2};
}

iso_view test_wall_view(int width, int height, bool orthographic) {
    return test_plain_view(width, height, orthographic, orthographic ? 2 : 80);
}
