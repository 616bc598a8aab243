/* Ambient occlusion: of places whose share of the surroundings is known; against random rays; the same bytes
 * for every number of threads and instruction set, and whatever was found out before; after edits; by lines,
 * glyphs and meshes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/cpu.h"
#include "check_support.h"
#include "grids/scenes/scenes.h"
#include "occlusion_truth.h"
#include "scene/occluders.h"

enum { SIDE = 64 };

/* A solid as a dense field of values: at or above 0 inside. */
typedef double solid_fn(double x, double y, double z);

static iso_grid make_grid(solid_fn *solid) {
    const iso_rgrid_desc desc = {.dims = {SIDE, SIDE, SIDE}, .type = ISO_FLOAT32};
    iso_grid grid = {0};
    assert_int_equal(iso_rgrid_create(&desc, &grid.rgrid, NULL), ISO_OK);
    float *data = grid.rgrid->data;
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) *data++ = (float)solid(x, y, z);
    return grid;
}

/* The share at a place in the world, among what is opaque. */
static float share_of(const iso_occluding *all, const iso_occlusion_opts *opts, iso_vec3 position,
                      iso_vec3 normal) {
    const iso_camera camera = {.position = {0, -100, 0}, .view_up = {0, 0, 1}, .view_angle = 30};
    iso_occluders occluders = {.coarse = 0};
    iso_occlusion *occlusion;
    assert_int_equal(iso_occluders_update(&occluders, all, opts, &camera, NULL, &occlusion, NULL), ISO_OK);
    const iso_vec3 p = iso_affine_point_to_index(&occlusion->bits->affine, position);
    const float at[3] = {(float)p.x, (float)p.y, (float)p.z},
                n[3] = {(float)normal.x, (float)normal.y, (float)normal.z};
    float share;
    assert_int_equal(iso_occlusion_at(occlusion, at, n, &share, NULL), ISO_OK);
    iso_occluders_free(&occluders);
    return share;
}

/* The same among surfaces at isovalue 0. */
static float share_among(const iso_scene_surface *const *surfaces, int count, const iso_occlusion_opts *opts,
                         iso_vec3 position, iso_vec3 normal) {
    iso_occluding all = {.count = count};
    for (int i = 0; i < count; i++) all.surfaces[i] = surfaces[i];
    return share_of(&all, opts, position, normal);
}

static float share_at(const iso_grid *grid, double range, iso_vec3 position, iso_vec3 normal) {
    const iso_scene_surface surface = {.grid = *grid};
    const iso_scene_surface *surfaces[] = {&surface};
    const iso_occlusion_opts opts = {.ambient = true, .range = range};
    return share_among(surfaces, 1, &opts, position, normal);
}

static double plane(double x, double y, double z) {
    (void)x, (void)y;
    return 31.3 - z;
}

static double slope(double x, double y, double z) {
    return (31.3 - z) + 0.37 * (x - 32) - 0.21 * (y - 32);
}

/* Cavities: of two walls and of three. */
static double edge(double x, double y, double z) {
    (void)x;
    return fmax(20.5 - y, 20.5 - z);
}

static double corner(double x, double y, double z) {
    return fmax(20.5 - x, fmax(20.5 - y, 20.5 - z));
}

static double bowl_and_ball(double x, double y, double z) {
    const double r = sqrt((x - 32) * (x - 32) + (y - 32) * (y - 32) + (z - 40) * (z - 40)),
                 ball = 8 - sqrt((x - 32) * (x - 32) + (y - 32) * (y - 32) + (z - 24) * (z - 24));
    return fmax(fmin(fmin(28 - r, r - 24), 40 - z), ball);
}

static void check(solid_fn *solid, iso_vec3 position, iso_vec3 normal, double wanted) {
    iso_grid grid = make_grid(solid);
    const float share = share_at(&grid, 40, position, iso_vec3_unit(normal));
    print_message("    %.3f for %.3f\n", (double)share, wanted);
    assert_true(fabs((double)share - wanted) <= 0.02);
    iso_grid_destroy(&grid);
}

static void known_places(void **state) {
    (void)state;
    check(plane, iso_vec3_make(32, 32, 31.3), iso_vec3_make(0, 0, 1), 1);
    check(slope, iso_vec3_make(32, 32, 31.3), iso_vec3_make(-0.37, 0.21, 1), 1);
    check(edge, iso_vec3_make(40, 20.5, 20.5), iso_vec3_make(0, 0, 1), 0.5);
    check(edge, iso_vec3_make(40, 20.5, 20.5), iso_vec3_make(0, 1, 0), 0.5);
    check(corner, iso_vec3_make(20.5, 20.5, 20.5), iso_vec3_make(0, 0, 1), 0.25);
    check(corner, iso_vec3_make(20.5, 20.5, 20.5), iso_vec3_make(1, 0, 0), 0.25);
}

static void ball_in_a_bowl(void **state) {
    (void)state;
    iso_grid grid = make_grid(bowl_and_ball);
    for (int i = 0; i < 12; i++) {
        const double angle = 0.25 * i;
        const iso_vec3 normal = {sin(angle), 0, cos(angle)},
                       place = iso_vec3_add(iso_vec3_make(32, 32, 24), iso_vec3_scale(normal, 8));
        if (place.z < 19) continue; /* where it lies in the bowl */
        const double truth = iso_occlusion_truth(&grid, 0, place, normal, 16, 2000, (uint64_t)i);
        const float share = share_at(&grid, 16, place, normal);
        print_message("    %.3f for %.3f\n", (double)share, truth);
        assert_true(fabs((double)share - truth) < 0.08);
    }
    iso_grid_destroy(&grid);
}

/* A voxel beyond the range says nothing; nor does a range below a voxel; an enormous one is the whole
 * lattice. */
static void ranges(void **state) {
    (void)state;
    iso_grid grid = make_grid(edge);
    const iso_vec3 place = {40, 40, 20.5}, normal = {0, 0, 1};
    assert_true(share_at(&grid, 10, place, normal) > 0.98f);
    assert_true(share_at(&grid, 30, place, normal) < 0.98f);
    for (int i = 0; i < 8; i++) {
        const iso_vec3 oblique = iso_vec3_unit(iso_vec3_make(i & 1 ? 0.3 : -0.7, i & 2 ? 0.4 : -0.2, 1));
        assert_true(share_at(&grid, 0.1, place, oblique) == 1);
    }
    assert_true(fabsf(share_at(&grid, 1e12, place, normal) - share_at(&grid, 1e3, place, normal)) < 1e-6f);
    iso_grid_destroy(&grid);
}

static double wall(double x, double y, double z) {
    (void)x, (void)z;
    return 30.2 - y;
}

/* A floor and a wall of two volumes, with other voxels and in other places: one lattice has both. */
static void several_volumes(void **state) {
    (void)state;
    iso_grid floor_grid = make_grid(plane), wall_grid = make_grid(wall);
    const double spacing = 1.3, origin[3] = {-10.4, -7.7, 3.1};
    for (int axis = 0; axis < 3; axis++) {
        wall_grid.rgrid->transform.spacing[axis] = spacing;
        wall_grid.rgrid->transform.origin[axis] = origin[axis];
    }
    const iso_scene_surface surfaces[] = {{.grid = floor_grid}, {.grid = wall_grid}};
    const iso_scene_surface *list[] = {&surfaces[0], &surfaces[1]};
    const iso_occlusion_opts opts = {.ambient = true, .range = 16};
    const iso_vec3 place = {32, origin[1] + spacing * 30.2, 31.3}, normal = {0, 0, 1};
    assert_true(fabsf(share_among(list, 1, &opts, place, normal) - 1) <= 0.02f);
    assert_true(fabsf(share_among(list, 2, &opts, place, normal) - 0.5f) <= 0.05f);
    iso_grid_destroy(&floor_grid);
    iso_grid_destroy(&wall_grid);
}

/* With little memory the lattice has larger voxels. */
static void coarse_lattice(void **state) {
    (void)state;
    iso_grid grid = make_grid(edge);
    const iso_scene_surface surface = {.grid = grid};
    const iso_scene_surface *surfaces[] = {&surface};
    const iso_occlusion_opts opts = {.ambient = true, .range = 20, .most_bytes = 30000};
    const float there =
                    share_among(surfaces, 1, &opts, iso_vec3_make(40, 20.5, 20.5), iso_vec3_make(0, 0, 1)),
                far = share_among(surfaces, 1, &opts, iso_vec3_make(40, 55, 20.5), iso_vec3_make(0, 0, 1));
    assert_true(fabsf(there - 0.5f) < 0.06f && fabsf(far - 1) < 0.03f);
    iso_grid_destroy(&grid);
}

/* ---- objects */

/* A thing above the floor of `plane`: what its surface is, and a field of both. */
enum { BALL, BRICK, TUBE, BALL_OF_TRIANGLES, THINGS };

static double distance(int thing, double x, double y, double z) {
    const double a = fmax(fabs(x - 32) - 7, 0), b = thing == TUBE ? a : x - 32;
    if (thing == BRICK) return 8 - fmax(fabs(x - 32), fmax(fabs(y - 32), fabs(z - 41)));
    return 8 - sqrt(b * b + (y - 32) * (y - 32) + (z - 41) * (z - 41));
}

/* A ball of 2 * ROUND * ROUND triangles. */
enum { ROUND = 60 };
static void make_mesh(iso_scene_object *object) {
    static float vertices[(ROUND + 1) * (ROUND + 1)][3];
    static uint32_t triangles[2 * ROUND * ROUND][3];
    for (int i = 0; i <= ROUND; i++)
        for (int k = 0; k <= ROUND; k++) {
            const double up = 3.14159265358979 * i / ROUND, turn = 2 * 3.14159265358979 * k / ROUND;
            float *v = vertices[i * (ROUND + 1) + k];
            v[0] = (float)(32 + 8 * sin(up) * cos(turn));
            v[1] = (float)(32 + 8 * sin(up) * sin(turn));
            v[2] = (float)(41 + 8 * cos(up));
        }
    for (int i = 0; i < ROUND * ROUND; i++) {
        const uint32_t first = (uint32_t)(i / ROUND * (ROUND + 1) + i % ROUND), below = first + ROUND + 1;
        const uint32_t corners[2][3] = {{first, below, first + 1}, {first + 1, below, below + 1}};
        memcpy(triangles[2 * i], corners, sizeof corners);
    }
    const iso_triangles mesh = {vertices, triangles, (ROUND + 1) * (ROUND + 1), 2 * ROUND * ROUND, NULL};
    assert_int_equal(iso_triangle_spans_make(&mesh, &object->spans, NULL), ISO_OK);
}

static void make_thing(int thing, iso_scene_object *object) {
    static float places[2][3] = {{32, 32, 41}, {32, 32, 41}}, axes[1][9] = {{8, 0, 0, 0, 8, 0, 0, 0, 8}};
    static size_t starts[] = {0, 2};
    *object = (iso_scene_object){.translucency = {.opacity = 1}};
    places[0][0] = thing == TUBE ? 25 : 32;
    places[1][0] = 39;
    const iso_glyphs glyphs = {.positions = places, .count = 1, .axes = thing == BRICK ? axes : NULL};
    const iso_lines lines = {.vertices = places, .starts = starts, .vertex_count = 2, .line_count = 1};
    const iso_shapes_opts opts = {.radius = 8, .glyph = thing == BRICK ? ISO_GLYPH_BOX : ISO_GLYPH_SPHERE};
    if (thing == BALL_OF_TRIANGLES)
        make_mesh(object);
    else if (thing == TUBE)
        assert_int_equal(iso_shapes_from_lines(&lines, &opts, &object->shapes, NULL), ISO_OK);
    else
        assert_int_equal(iso_shapes_from_glyphs(&glyphs, &opts, &object->shapes, NULL), ISO_OK);
}

/* Lines, glyphs and meshes darken the floor below them and are darkened by it, as if they were of its volume,
 * and as a floor that is a glyph itself; what a clip cuts away does not. */
static void objects_occlude(void **state) {
    (void)state;
    const iso_occlusion_opts opts = {.ambient = true, .range = 16};
    iso_grid ground = make_grid(plane);
    iso_scene_surface surface = {.grid = ground};
    for (int thing = 0; thing < THINGS; thing++) {
        iso_grid both = make_grid(plane);
        for (size_t i = 0; i < (size_t)SIDE * SIDE * SIDE; i++) {
            const double d =
                distance(thing, (double)(i % SIDE), (double)(i / SIDE % SIDE), (double)(i / SIDE / SIDE));
            float *value = (float *)both.rgrid->data + i;
            *value = fmaxf(*value, (float)d);
        }
        iso_scene_object object;
        make_thing(thing, &object);
        iso_occluding all = {.surfaces = {&surface}, .objects = {&object}, .count = 1, .object_count = 1};
        for (int i = 0; i < 6; i++) {
            const bool below = i < 3;
            const iso_vec3 normal = below ? iso_vec3_make(0, 0, 1) : iso_vec3_make(0, i == 4, -(i != 4)),
                           place = below    ? iso_vec3_make(32, 30 + 6 * i, 31.3)
                                   : i == 4 ? iso_vec3_make(32, 40, 41)
                                            : iso_vec3_make(30 + i % 2, 32, 33);
            const double truth = iso_occlusion_truth(&both, 0, place, normal, 16, 2000, (uint64_t)i);
            const double share = (double)share_of(&all, &opts, place, normal);
            print_message("    %d %d: %.3f for %.3f\n", thing, i, share, truth);
            assert_true(fabs(share - truth) < 0.09);
        }
        iso_clip clip = {.count = 1,
                         .body = {iso_clip_half_space(iso_vec3_make(0, 0, 31.5), iso_vec3_make(0, 0, 1))}};
        object.clip = &clip;
        const iso_vec3 place = {32, 36, 31.3}, up = {0, 0, 1};
        assert_true(fabs((double)share_of(&all, &opts, place, up) - 1) < 0.02);
        iso_scene_object_free(&object);
        iso_grid_destroy(&both);
    }
    iso_grid_destroy(&ground);
}

/* Without a volume: balls on a floor that is a box. The lattice follows what moves. */
static void objects_alone(void **state) {
    (void)state;
    static float floor_at[1][3] = {{32, 32, 21.3f}}, floor_axes[1][9] = {{32, 0, 0, 0, 32, 0, 0, 0, 10}};
    static float ball_at[1][3] = {{32, 32, 41}};
    const iso_glyphs floors = {.positions = floor_at, .count = 1, .axes = floor_axes},
                     balls = {.positions = ball_at, .count = 1};
    const iso_shapes_opts box = {.radius = 8, .glyph = ISO_GLYPH_BOX}, round = {.radius = 8};
    iso_scene_object objects[2] = {{.translucency = {.opacity = 1}}, {.translucency = {.opacity = 1}}};
    assert_int_equal(iso_shapes_from_glyphs(&floors, &box, &objects[0].shapes, NULL), ISO_OK);
    assert_int_equal(iso_shapes_from_glyphs(&balls, &round, &objects[1].shapes, NULL), ISO_OK);
    iso_occluding all = {.objects = {&objects[0], &objects[1]}, .object_count = 2};
    const iso_occlusion_opts opts = {.ambient = true, .range = 16};
    const iso_vec3 place = {32, 36, 31.3}, up = {0, 0, 1};
    const iso_camera camera = {.position = {0, -100, 0}, .view_up = {0, 0, 1}, .view_angle = 30};
    iso_occluders kept = {.coarse = 0};
    for (int turn = 0; turn < 3; turn++) {
        iso_clip clip = {.count = turn == 1,
                         .body = {iso_clip_half_space(iso_vec3_make(0, 0, 31.5), iso_vec3_make(0, 0, 1))}};
        objects[1].clip = &clip;
        iso_occlusion *occlusion;
        float share;
        assert_int_equal(iso_occluders_update(&kept, &all, &opts, &camera, NULL, &occlusion, NULL), ISO_OK);
        const iso_vec3 p = iso_affine_point_to_index(&occlusion->bits->affine, place);
        assert_int_equal(iso_occlusion_at(occlusion, (const float[]){(float)p.x, (float)p.y, (float)p.z},
                                          (const float[]){0, 0, 1}, &share, NULL),
                         ISO_OK);
        print_message("    %.3f\n", (double)share);
        assert_true(turn == 1 ? share > 0.98f : share < 0.5f);
        assert_true(share == share_of(&all, &opts, place, up));
    }
    iso_occluders_free(&kept);
    for (int i = 0; i < 2; i++) iso_scene_object_free(&objects[i]);
}

/* ---- pictures */

enum { PIXELS = 200 };

typedef struct drawing {
    iso_scene_surface surface;
    iso_occluders occluders;
    iso_gbuffer gbuffer;
    iso_view view;
    iso_camera camera;
} drawing;

static void start(drawing *d, const iso_grid *grid, iso_vec3 from) {
    *d = (drawing){.surface = {.grid = *grid}};
    d->camera =
        (iso_camera){.position = from, .focal_point = {32, 32, 32}, .view_up = {0, 0, 1}, .view_angle = 30};
    d->view = iso_view_make(&d->camera, PIXELS, PIXELS);
    assert_int_equal(iso_scene_surface_update(&d->surface, ISO_PART_CELLS, NULL), ISO_OK);
    assert_int_equal(iso_gbuffer_create(PIXELS, PIXELS, &d->gbuffer, NULL), ISO_OK);
    assert_int_equal(iso_gbuffer_add_plane(&d->gbuffer, &d->gbuffer.ambient, NULL), ISO_OK);
    assert_int_equal(iso_gbuffer_add_plane(&d->gbuffer, &d->gbuffer.key, NULL), ISO_OK);
}

static void light(drawing *d, int factor, iso_pool *pool) {
    const iso_occluding all = {.surfaces = {&d->surface}, .count = 1};
    const iso_occlusion_opts opts = {.ambient = true, .range = 12, .shadow = true};
    const size_t bytes = (size_t)PIXELS * PIXELS * sizeof(float);
    iso_occlusion *occlusion;
    const iso_target target = {&d->view, &d->gbuffer, pool, 0, NULL};
    assert_int_equal(iso_scene_surface_update(&d->surface, ISO_PART_CELLS, NULL), ISO_OK);
    assert_int_equal(iso_occluders_update(&d->occluders, &all, &opts, &d->camera, pool, &occlusion, NULL),
                     ISO_OK);
    iso_gbuffer_clear(&d->gbuffer);
    memset(d->gbuffer.ambient, 0, bytes);
    memset(d->gbuffer.key, 0, bytes);
    assert_int_equal(iso_draw_exact(&target, d->surface.exact, NULL), ISO_OK);
    assert_int_equal(iso_occlusion_light(occlusion, &d->view, factor, 0, PIXELS - 1, &d->gbuffer, pool, NULL),
                     ISO_OK);
}

static void finish(drawing *d) {
    iso_occluders_free(&d->occluders);
    iso_scene_surface_free(&d->surface);
    iso_gbuffer_free(&d->gbuffer);
}

static void assert_equal_light(const drawing *a, const drawing *b) {
    const size_t bytes = (size_t)PIXELS * PIXELS * sizeof(float);
    assert_memory_equal(a->gbuffer.ambient, b->gbuffer.ambient, bytes);
    assert_memory_equal(a->gbuffer.key, b->gbuffer.key, bytes);
}

static void same_on_every_machine(void **state) {
    (void)state;
    iso_grid grid = make_grid(bowl_and_ball);
    iso_pool *pool;
    drawing first, other;
    const iso_vec3 from = {120, -60, 110};
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int factor = 1; factor <= 2; factor++) {
        start(&first, &grid, from);
        light(&first, factor, NULL);
        for (int level = 0; level < ISO_CPU_LEVELS; level++) {
            iso_cpu_limit((iso_cpu_level)level);
            start(&other, &grid, from);
            light(&other, factor, level ? pool : NULL);
            assert_equal_light(&first, &other);
            light(&other, factor, pool); /* nothing is computed again */
            assert_equal_light(&first, &other);
            finish(&other);
        }
        finish(&first);
    }
    iso_pool_destroy(pool);
    iso_grid_destroy(&grid);
}

/* What is known from another camera and from before an edit does not show. */
static void follows_edits(void **state) {
    (void)state;
    iso_grid grid = make_grid(bowl_and_ball);
    drawing kept, fresh;
    start(&kept, &grid, iso_vec3_make(120, -60, 110));
    light(&kept, 1, NULL);
    const int lo[3] = {20, 20, 34}, hi[3] = {40, 40, 36};
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                ((float *)grid.rgrid->data)[x + y * grid.rgrid->stride_y + z * grid.rgrid->stride_z] = 1;
    assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, lo, hi, NULL), ISO_OK);
    kept.camera.position = iso_vec3_make(-40, -90, 100);
    kept.view = iso_view_make(&kept.camera, PIXELS, PIXELS);
    light(&kept, 1, NULL);
    start(&fresh, &grid, kept.camera.position);
    light(&fresh, 1, NULL);
    assert_equal_light(&kept, &fresh);
    finish(&kept);
    finish(&fresh);
    iso_grid_destroy(&grid);
}

/* Sparse and dense grids of the same distances have the same bits. */
static void sparse_equals_dense(void **state) {
    (void)state;
    iso_grid grids[2];
    drawing drawings[2];
    for (int i = 0; i < 2; i++) {
        const iso_scene_opts opts = {.size = SIDE, .dense = i};
        assert_int_equal(iso_scene_create("torus", &opts, &grids[i], NULL, NULL), ISO_OK);
        start(&drawings[i], &grids[i], iso_vec3_make(120, -60, 110));
        light(&drawings[i], 1, NULL);
    }
    assert_equal_light(&drawings[0], &drawings[1]);
    for (int i = 0; i < 2; i++) {
        finish(&drawings[i]);
        iso_grid_destroy(&grids[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_places),    cmocka_unit_test(ball_in_a_bowl),
        cmocka_unit_test(ranges),          cmocka_unit_test(same_on_every_machine),
        cmocka_unit_test(follows_edits),   cmocka_unit_test(sparse_equals_dense),
        cmocka_unit_test(several_volumes), cmocka_unit_test(coarse_lattice),
        cmocka_unit_test(objects_occlude), cmocka_unit_test(objects_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
