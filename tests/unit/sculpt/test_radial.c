/* Radial symmetry: images turned around an axis, alone and with mirror planes; the same bytes for every
 * number of threads, replayed and edited; dabs that are left out of bricks that they do not reach change
 * nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/numbers.h"
#include "grids/grid.h"
#include "sculpt/brush/dab.h"
#include "session_support.h"

enum { SIDE = 64 };
/* (the tools that act by themselves; masks are tested with them) */
static const iso_tool TOOLS[] = {ISO_TOOL_ADD,     ISO_TOOL_CARVE,      ISO_TOOL_BLEND_ADD, ISO_TOOL_SMOOTH,
                                 ISO_TOOL_INFLATE, ISO_TOOL_FLATTEN,    ISO_TOOL_SCRAPE,    ISO_TOOL_CLAY,
                                 ISO_TOOL_PINCH,   ISO_TOOL_SNAKE_HOOK, ISO_TOOL_MOVE,      ISO_TOOL_MASK,
                                 ISO_TOOL_CREASE,  ISO_TOOL_PAINT};
enum { TOOL_COUNT = sizeof TOOLS / sizeof *TOOLS };

static iso_brush make_brush(iso_tool tool, unsigned radial, char axis) {
    return (iso_brush){.tool = tool,
                       .radius = 2.3,
                       .strength = 0.7,
                       .radial = radial,
                       .radial_axis = axis,
                       .has_color = tool == ISO_TOOL_PAINT || tool == ISO_TOOL_ADD,
                       .color = {200, 40, 20}};
}

/* A stroke of each tool over the ball of radius 10 mm. */
static void draw_all(iso_session *session, unsigned radial, char axis, unsigned symmetry) {
    for (int i = 0; i < TOOL_COUNT; i++) {
        iso_brush brush = make_brush(TOOLS[i], radial, axis);
        const double h = 9.5 - 1.4 * i, r = sqrt(fmax(100 - h * h, 0));
        const iso_vec3 path[] = {{0.8 * r, 0.6 * r, h}, {0.75 * r, 0.65 * r, h - 0.7}, {0.6 * r, 0.8 * r, h}};
        brush.symmetry = symmetry;
        if (i % 3 == 1) { /* some that meet, and some apart */
            brush.repeat[0] = 1 + (unsigned)i / 3;
            brush.repeat_by[0] = iso_vec3_make(0, 0.4 * i, -1.5);
        }
        session_stroke(session, &brush, path, 3);
    }
}

static iso_session *open_session(const char *journal, iso_pool *pool) {
    return session_open(&(iso_session_opts){.journal = journal, .pool = pool, .checkpoint_strokes = -1});
}

static double value_at(const iso_hgrid *grid, const double p[3]) {
    const iso_grid all = {.hgrid = (iso_hgrid *)grid};
    return iso_grid_sample(&all, iso_vec3_make(p[0], p[1], p[2]));
}

/* ---- the group of images */

static void images_are_a_group(void **state) {
    (void)state;
    iso_brush_image images[ISO_IMAGES_MOST];
    for (unsigned symmetry = 0; symmetry < 8; symmetry++)
        for (unsigned radial = 0; radial <= ISO_RADIAL_MOST; radial++) {
            const iso_brush brush = {.radius = 1,
                                     .symmetry = symmetry,
                                     .radial = radial,
                                     .radial_axis = "xyz"[radial % 3],
                                     .mirror = {1, -2, 0.5}};
            const int count = iso_brush_images(&brush, images);
            const iso_vec3 p = {3.1, 0.7, 2.9};
            iso_vec3 at[ISO_IMAGES_MOST];
            assert_true(iso_vec3_length(iso_vec3_sub(iso_brush_image_point(&images[0], p), p)) == 0);
            for (int i = 0; i < count; i++) at[i] = iso_brush_image_point(&images[i], p);
            for (int i = 0; i < count; i++)
                for (int k = 0; k < i; k++) assert_true(iso_vec3_length(iso_vec3_sub(at[i], at[k])) > 1e-3);
            for (int i = 0; i < count; i++) /* the image of an image is one of them */
                for (int k = 0; k < count; k++) {
                    const iso_vec3 twice = iso_brush_image_point(&images[i], at[k]);
                    double least = 1;
                    for (int m = 0; m < count; m++)
                        least = fmin(least, iso_vec3_length(iso_vec3_sub(twice, at[m])));
                    assert_true(least < 1e-12);
                }
        }
}

/* ---- symmetric fields */

/* Half a turn permutes voxels: the bits are equal. (Rescaling, after a blend, and planes through many places
 * sum in another order: there the last ones are not.) So does a quarter turn, but redistancing works by rows
 * along x: only near the surface its results are alike. */
static void half_and_quarter_turns_are_exact(void **state) {
    (void)state;
    static const struct {
        unsigned radial;
        char axis;
        unsigned symmetry;
    } cases[] = {{2, 'x', 0}, {2, 'y', 0}, {2, 'z', 4}, {4, 'z', 0}, {4, 'z', 5}};
    for (int c = 0; c < 5 * TOOL_COUNT; c++) {
        const unsigned radial = cases[c % 5].radial;
        iso_brush brush = make_brush(TOOLS[c / 5], radial, cases[c % 5].axis);
        iso_session *session = open_session(NULL, NULL);
        brush.symmetry = cases[c % 5].symmetry;
        session_stroke(session, &brush, (iso_vec3[]){{6, 4.5, 6.2}, {5.6, 4.8, 6}, {5, 5.2, 6.2}}, 3);
        session_stroke(session, &brush, (iso_vec3[]){{1, 2, 9.7}, {0.5, 0.3, 10}}, 2); /* images meet */
        const iso_hgrid *grid = iso_session_grid(session);
        const int a = cases[c % 5].axis - 'x', u = (a + 1) % 3, v = (a + 2) % 3;
        size_t wrong = 0;
        double most = 0, near = 0;
        for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
            const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            int to[3];
            to[a] = at[a];
            to[u] = radial == 2 ? SIDE - 1 - at[u] : SIDE - 1 - at[v];
            to[v] = radial == 2 ? SIDE - 1 - at[v] : at[u];
            const float here = iso_hgrid_at(grid, at[0], at[1], at[2]),
                        there = iso_hgrid_at(grid, to[0], to[1], to[2]);
            wrong += memcmp(&here, &there, sizeof here) != 0;
            most = fmax(most, fabs((double)here - (double)there));
            if (fabs((double)here) < 1) near = fmax(near, fabs((double)here - (double)there));
            assert_int_equal(iso_session_masked(session, at[0], at[1], at[2]),
                             iso_session_masked(session, to[0], to[1], to[2]));
        }
        if (wrong)
            print_message(
                "%s, %u images around %c, symmetry %u: %zu voxels differ by %.2g, near the surface %.2g\n",
                iso_tool_name(brush.tool), radial, cases[c % 5].axis, brush.symmetry, wrong, most, near);
        if (radial == 2)
            assert_true(brush.tool == ISO_TOOL_BLEND_ADD || brush.symmetry ? most < 1e-6 : wrong == 0);
        else
            assert_true(most < 0.7 && near < 0.1);
        iso_session_destroy(session);
    }
}

/* Other turns: the distances at turned places differ by what interpolating between voxels costs. */
static void other_turns_are_near(void **state) {
    (void)state;
    static const unsigned radials[] = {3, 4, 5, 6, 8, 32};
    for (int c = 0; c < 18; c++) {
        const unsigned radial = radials[c % 6];
        const char axis = "xyz"[c / 6];
        iso_session *session = open_session(NULL, NULL);
        iso_brush brush = make_brush(ISO_TOOL_BLEND_ADD, radial, axis);
        const double r = 9.5;
        double unit[3] = {0.61, 0.61, 0.61}, sine, cosine, sum = 0, most = 0;
        unit[axis - 'x'] = 0.5;
        brush.symmetry = c % 2 ? 1u << (axis - 'x') : 0;
        session_stroke(session, &brush, (iso_vec3[]){{r * unit[0], r * unit[1], r * unit[2]}}, 1);
        brush.tool = ISO_TOOL_INFLATE;
        session_stroke(session, &brush, (iso_vec3[]){{r * unit[1], r * unit[2], -r * unit[0]}}, 1);
        const iso_hgrid *grid = iso_session_grid(session);
        iso_sincos(2 * ISO_PI / radial, &sine, &cosine);
        const int a = axis - 'x', u = (a + 1) % 3, v = (a + 2) % 3;
        int count = 0, changed = 0;
        for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
            const double at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE}, middle = 0.5 * (SIDE - 1);
            const double here = value_at(grid, at), ball = sqrt((at[0] - middle) * (at[0] - middle) +
                                                                (at[1] - middle) * (at[1] - middle) +
                                                                (at[2] - middle) * (at[2] - middle)) -
                                                           20;
            if (fabs(here) > 1) continue;
            double to[3];
            to[a] = at[a];
            to[u] = middle + cosine * (at[u] - middle) - sine * (at[v] - middle);
            to[v] = middle + sine * (at[u] - middle) + cosine * (at[v] - middle);
            const double differs = fabs(value_at(grid, to) - here);
            most = fmax(most, differs);
            sum += differs;
            count++;
            changed += fabs(here - ball) > 0.5;
        }
        print_message("%u images around %c: differ by %.4f voxel, at most %.3f; %d voxels were changed\n",
                      radial, axis, sum / count, most, changed);
        assert_true(changed > 300);
        assert_true(sum / count < 0.02 && most < 0.3);
        iso_session_destroy(session);
    }
}

/* ---- many images in one place */

/* On the axis all images are the same: they do what one does. */
static void images_on_the_axis_act_once(void **state) {
    (void)state;
    static const iso_tool tools[] = {ISO_TOOL_ADD,  ISO_TOOL_INFLATE, ISO_TOOL_FLATTEN,
                                     ISO_TOOL_CLAY, ISO_TOOL_PINCH,   ISO_TOOL_SMOOTH};
    for (size_t t = 0; t < sizeof tools / sizeof *tools; t++) {
        iso_session *one = open_session(NULL, NULL), *many = open_session(NULL, NULL);
        const iso_brush plain = make_brush(tools[t], 0, 0), radial = make_brush(tools[t], 32, 'z');
        session_stroke(one, &plain, (iso_vec3[]){{0, 0, 10}}, 1);
        session_stroke(many, &radial, (iso_vec3[]){{0, 0, 10}}, 1);
        double most = 0, moved = 0;
        for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
            const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            const double a = (double)iso_hgrid_at(iso_session_grid(one), at[0], at[1], at[2]),
                         b = (double)iso_hgrid_at(iso_session_grid(many), at[0], at[1], at[2]);
            most = fmax(most, fabs(a - b));
            moved = fmax(moved, fabs(a));
        }
        print_message("%s: one and 32 images on the axis differ by %.2g voxel\n", iso_tool_name(tools[t]),
                      most);
        assert_true(moved > 1 && most < 0.01);
        iso_session_destroy(one);
        iso_session_destroy(many);
    }
}

/* ---- repeated images */

static void repeated_images_are_moved_ones(void **state) {
    (void)state;
    iso_brush_image images[ISO_IMAGES_MOST];
    const iso_brush brush = {.radius = 1, .repeat = {4, 3}, .repeat_by = {{2, 0.5, 0}, {0, 0, -3}}};
    assert_int_equal(iso_brush_images(&brush, images), 12);
    for (int i = 0; i < 12; i++) {
        const iso_vec3 at = iso_brush_image_point(&images[i], iso_vec3_make(1, 1, 1)),
                       up = iso_brush_image_direction(&images[i], iso_vec3_make(0, 0.6, 0.8));
        assert_true(at.x == 1 + 2 * (i % 4) && at.y == 1 + 0.5 * (i % 4) && at.z == 1 - 3 * (i / 4));
        assert_true(up.x == 0 && up.y == 0.6 && up.z == 0.8);
    }
    const struct {
        iso_brush brush;
        int count; /* 0: refused */
    } cases[] = {{{.repeat = {256, 0}, .repeat_by = {{1, 0, 0}}}, 256},
                 {{.repeat = {257, 0}, .repeat_by = {{1, 0, 0}}}, 0},
                 {{.repeat = {32, 8}, .repeat_by = {{1, 0, 0}, {0, 1, 0}}}, 256},
                 {{.repeat = {32, 9}, .repeat_by = {{1, 0, 0}, {0, 1, 0}}}, 0},
                 {{.repeat = {32, 2}, .repeat_by = {{1, 0, 0}, {0, 1, 0}}, .symmetry = 3}, 256},
                 {{.repeat = {32, 2}, .repeat_by = {{1, 0, 0}, {0, 1, 0}}, .symmetry = 7}, 0},
                 {{.repeat = {9, 0}, .repeat_by = {{1, 0, 0}}, .radial = 28}, 252},
                 {{.repeat = {9, 0}, .repeat_by = {{1, 0, 0}}, .radial = 29}, 0},
                 {{.repeat = {2, 0}}, 0},
                 {{.repeat = {1, 1}}, 1},
                 {{.repeat = {2, 0}, .repeat_by = {{NAN, 0, 0}}}, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_brush checked = cases[i].brush;
        checked.radius = 1;
        assert_int_equal(iso_brush_check(&checked, NULL) == ISO_OK, cases[i].count > 0);
        if (cases[i].count) assert_int_equal(iso_brush_images(&checked, images), cases[i].count);
    }
}

/* Rows of images that lie apart do what as many strokes do, before or after the ball is mirrored. */
static void repeated_images_act_as_strokes(void **state) {
    (void)state;
    const iso_vec3 by[2] = {{6, 0, 0}, {0.5, 7, 0.5}}, path[] = {{-6.5, -4, 5}, {-6, -3.5, 5.5}};
    for (int t = 0; t < TOOL_COUNT; t++) {
        iso_session *one = open_session(NULL, NULL), *many = open_session(NULL, NULL);
        iso_brush brush = make_brush(TOOLS[t], 0, 0);
        brush.radius = 1.2;
        const iso_sample samples[] = {{.position = path[0], .normal = {0, 0, 1}, .pressure = 1},
                                      {.position = path[1], .normal = {0, 0, 1}, .pressure = 1}};
        for (int i = 0; i < 6; i++) {
            iso_sample moved[2] = {samples[0], samples[1]};
            for (int k = 0; k < 2; k++)
                moved[k].position =
                    iso_vec3_add(moved[k].position,
                                 iso_vec3_add(iso_vec3_scale(by[0], i % 3), iso_vec3_scale(by[1], i / 3)));
            assert_int_equal(iso_session_begin(many, &brush, &moved[0], NULL, NULL), ISO_OK);
            assert_int_equal(iso_session_sample(many, &moved[1], NULL, NULL), ISO_OK);
            assert_int_equal(iso_session_end(many, NULL), ISO_OK);
        }
        brush.repeat[0] = 3;
        brush.repeat[1] = 2;
        memcpy(brush.repeat_by, by, sizeof by);
        assert_int_equal(iso_session_begin(one, &brush, &samples[0], NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_sample(one, &samples[1], NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_end(one, NULL), ISO_OK);
        double most = 0, near = 0;
        for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
            const int v[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            const double a = (double)iso_hgrid_at(iso_session_grid(one), v[0], v[1], v[2]),
                         b = (double)iso_hgrid_at(iso_session_grid(many), v[0], v[1], v[2]);
            most = fmax(most, fabs(a - b));
            if (fabs(a) < 0.9) near = fmax(near, fabs(a - b));
            assert_int_equal(iso_session_masked(one, v[0], v[1], v[2]),
                             iso_session_masked(many, v[0], v[1], v[2]));
        }
        print_message("%s: six images and six strokes differ by %.2g voxel, near the surface %.2g\n",
                      iso_tool_name(TOOLS[t]), most, near);
        assert_true(most < 0.5 && near < 0.1); /* (beside creases, which each stroke corrects) */
        iso_session_destroy(one);
        iso_session_destroy(many);
    }
}

/* ---- the same bytes */

static void threads_give_the_same(void **state) {
    (void)state;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(5, &pool, NULL), ISO_OK);
    iso_session *one = open_session(NULL, NULL), *many = open_session(NULL, pool);
    draw_all(one, 7, 'y', 2);
    draw_all(many, 7, 'y', 2);
    session_field field = session_field_of(one);
    assert_true(session_is(many, &field));
    session_field_free(&field);
    iso_session_destroy(one);
    iso_session_destroy(many);
    iso_pool_destroy(pool);
}

static void replay_and_edits_give_the_same(void **state) {
    (void)state;
    const char *journal = session_path("radial.strokes");
    session_remove_files(journal);
    iso_session *session = open_session(journal, NULL);
    draw_all(session, 6, 'x', 1);
    session_field drawn = session_field_of(session);
    iso_event edit = {.kind = ISO_EVENT_EDIT, .first = 3, .last = 3};
    edit.brush = make_brush(TOOLS[2], 9, 'z');
    edit.brush.repeat[0] = edit.brush.repeat[1] = 2;
    edit.brush.repeat_by[0] = iso_vec3_make(0.1, 1.0 / 3, 0);
    edit.brush.repeat_by[1] = iso_vec3_make(0, 0, -4);
    assert_int_equal(iso_session_edit(session, &edit, NULL), ISO_OK);
    assert_false(session_is(session, &drawn));
    session_field edited = session_field_of(session);
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_true(session_is(session, &drawn));
    assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
    iso_session_destroy(session);

    iso_session *resumed =
        session_open(&(iso_session_opts){.journal = journal, .resume = true, .checkpoint_strokes = -1});
    assert_true(session_is(resumed, &edited));
    iso_stroke_list list = {.count = 0};
    assert_int_equal(iso_session_strokes(resumed, &list, NULL), ISO_OK);
    assert_true(iso_brush_is_same(&iso_stroke_at(&list, 2)->brush, &edit.brush));
    assert_int_equal(iso_stroke_at(&list, 2)->brush.radial, 9);
    assert_int_equal(iso_stroke_at(&list, 2)->brush.radial_axis, 'z');
    assert_int_equal(iso_stroke_at(&list, 3)->brush.radial, 6);
    iso_stroke_list_free(&list);
    edit.brush.radial = 0; /* back to one image */
    assert_int_equal(iso_session_edit(resumed, &edit, NULL), ISO_OK);
    assert_false(session_is(resumed, &edited));
    session_field_free(&drawn);
    session_field_free(&edited);
    iso_session_destroy(resumed);
    session_remove_files(journal);
}

/* ---- dabs that do not reach a brick are left out */

static uint32_t next_seed(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* A touch of many dabs is the union of what each does alone, bit for bit. */
static void far_dabs_change_nothing(void **state) {
    (void)state;
    static float phi[ISO_BRICK_VOXELS], wanted[ISO_BRICK_VOXELS], got[ISO_BRICK_VOXELS];
    const iso_dab_kernel *kernel = iso_dab_kernel_get(iso_cpu_best());
    const iso_transform transform = iso_transform_identity();
    const iso_affine affine = iso_transform_affine(&transform);
    const iso_stencil stencil = {.self = phi, .face = {phi, phi, phi, phi, phi, phi}};
    uint32_t seed = 7;
    size_t left_out = 0, reached = 0;
    for (int round = 0; round < 600; round++) {
        const bool carve = round % 2;
        iso_brush brush =
            make_brush(carve ? ISO_TOOL_CARVE : ISO_TOOL_ADD, next_seed(&seed) % 33, "xyz"[round % 3]);
        static iso_dabs dabs, one;
        int numbers[ISO_DAB_MAX];
        brush.radius = 2 + next_seed(&seed) % 20;
        brush.shape = (iso_solid)(next_seed(&seed) % ISO_SOLID_STAMP);
        brush.symmetry = next_seed(&seed) % 8;
        iso_sample sample = {.normal = {0.6, 0, 0.8}, .pressure = 1};
        sample.position = iso_vec3_make(next_seed(&seed) % 40, next_seed(&seed) % 40, next_seed(&seed) % 40);
        const iso_touch touch = {.sample = sample, .previous = sample, .first = sample};
        iso_dabs_make(&(iso_dab_space){.affine = &affine, .spacing = 1, .band = 3}, &brush, &touch, &dabs);
        const int brick[3] = {(int)(next_seed(&seed) % 5) - 2, (int)(next_seed(&seed) % 5) - 2,
                              (int)(next_seed(&seed) % 5) - 2};
        for (int k = 0; k < ISO_BRICK_VOXELS; k++) phi[k] = (float)(next_seed(&seed) % 6000) / 1000 - 3;
        memcpy(wanted, phi, sizeof phi);
        one = dabs;
        one.count = 1;
        for (int i = 0; i < dabs.count; i++) {
            one.dab[0] = dabs.dab[i];
            kernel->edit(&one, brick, &stencil, got);
            for (int k = 0; k < ISO_BRICK_VOXELS; k++)
                wanted[k] = carve ? fmaxf(wanted[k], got[k]) : fminf(wanted[k], got[k]);
        }
        kernel->edit(&dabs, brick, &stencil, got);
        assert_memory_equal(got, wanted, sizeof got);
        const int near = iso_dabs_find_near(&dabs, brick, numbers);
        left_out += (size_t)(dabs.count - near);
        reached += (size_t)near;
    }
    print_message("%zu dabs reach a brick, %zu are left out\n", reached, left_out);
    assert_true(left_out > 1000 && reached > 1000);
}

/* Only images that are apart have the seams of single touches (far_value_of of edit.c). */
static void images_are_apart_or_not(void **state) {
    (void)state;
    static iso_dabs dabs;
    const iso_transform transform = iso_transform_identity();
    const iso_affine affine = iso_transform_affine(&transform);
    uint32_t seed = 17;
    int apart = 0;
    for (int round = 0; round < 2000; round++) {
        iso_brush brush = make_brush(ISO_TOOL_ADD, 2 + next_seed(&seed) % 31, "xyz"[round % 3]);
        iso_sample sample = {.normal = {0.6, 0, 0.8}, .pressure = 1};
        brush.radius = 2 + next_seed(&seed) % 20;
        brush.shape = (iso_solid)(next_seed(&seed) % ISO_SOLID_STAMP);
        brush.symmetry = next_seed(&seed) % 8;
        sample.position = iso_vec3_make(next_seed(&seed) % 90, next_seed(&seed) % 90, next_seed(&seed) % 90);
        const iso_touch touch = {.sample = sample, .previous = sample, .first = sample};
        iso_dabs_make(&(iso_dab_space){.affine = &affine, .spacing = 1, .band = 3}, &brush, &touch, &dabs);
        double least = INFINITY;
        for (int i = 0; i < dabs.count; i++)
            for (int k = 0; k < i; k++) {
                const double *a = dabs.dab[i].centre, *b = dabs.dab[k].centre;
                least = fmin(least, iso_vec3_length(iso_vec3_make(a[0] - b[0], a[1] - b[1], a[2] - b[2])));
            }
        const double reach = 2 * iso_dabs_influence(&dabs);
        if (least < reach) assert_false(dabs.apart);
        if (least > reach + 3) assert_true(dabs.apart);
        apart += dabs.apart;
    }
    assert_true(apart > 100 && apart < 1900);
}

/* Where a voxel of a drag with all its dabs is sampled, in double precision. */
static void follow_back(const iso_dabs *dabs, const double at[3], double shift[3]) {
    const int steps = iso_dabs_steps(dabs);
    for (int k = 0; k < 3; k++) shift[k] = 0;
    for (int step = 0; step < steps; step++) {
        double sum[3] = {0}, weights = 0, most = 0;
        for (int i = 0; i < dabs->count; i++) {
            const iso_dab *dab = &dabs->dab[i];
            double square = 0;
            for (int k = 0; k < 3; k++) {
                const double path = dab->from[k] - dab->centre[k],
                             d = at[k] + shift[k] - dab->centre[k] - (step + 0.5) / steps * path;
                square += d * d;
            }
            const double t = sqrt(square) / (double)dabs->radius_voxels,
                         w = t < 1 ? (1 - t * t) * (1 - t * t) * (double)dabs->strength : 0;
            for (int k = 0; k < 3; k++) sum[k] += w * (dab->from[k] - dab->centre[k]) / steps;
            weights += w;
            most = fmax(most, w);
        }
        const double factor = !dabs->averaged ? 1 : weights > 0 ? most / weights : 0;
        for (int k = 0; k < 3; k++) shift[k] += factor * sum[k];
    }
}

/* A drag may carry a voxel from the reach of one image into that of another, which then must not be left out.
 */
static void drags_reach_other_images(void **state) {
    (void)state;
    static iso_dabs dabs;
    static iso_warp warp;
    const iso_dab_kernel *kernel = iso_dab_kernel_get(iso_cpu_best());
    const iso_transform transform = iso_transform_identity();
    const iso_affine affine = iso_transform_affine(&transform);
    uint32_t seed = 3;
    double worst = 0;
    int carried = 0;
    for (int round = 0; round < 400; round++) {
        iso_brush brush = make_brush(ISO_TOOL_MOVE, round % 2 ? 2 + next_seed(&seed) % 8 : 0, 'z');
        iso_sample first = {.normal = {0, 0, 1}, .pressure = 1}, last = first;
        int numbers[ISO_DAB_MAX];
        brush.radius = 4 + next_seed(&seed) % 4;
        brush.strength = 1;
        brush.symmetry = brush.radial ? 0 : 3;
        /* away from the axis, so that following back leads to where other images begin */
        first.position = iso_vec3_make(next_seed(&seed) % 5 - 2.0, 1 + next_seed(&seed) % 4, 8);
        last.position = iso_vec3_make(next_seed(&seed) % 9 - 4.0, 8.0 + next_seed(&seed) % 16, 8);
        const iso_touch touch = {.sample = last, .previous = first, .first = first};
        iso_dabs_make(&(iso_dab_space){.affine = &affine, .spacing = 1, .band = 3}, &brush, &touch, &dabs);
        const int brick[3] = {(int)(next_seed(&seed) % 3) - 1, (int)(next_seed(&seed) % 4) - 1, 0};
        carried += iso_dabs_find_near(&dabs, brick, numbers) < dabs.count;
        kernel->warp(&dabs, brick, &warp);
        for (int i = 0; i < ISO_BRICK_VOXELS; i += 37) {
            const int v[3] = {i % ISO_BRICK, i / ISO_BRICK % ISO_BRICK, i / ISO_BRICK_ROWS};
            const double at[3] = {16.0 * brick[0] + v[0], 16.0 * brick[1] + v[1], 16.0 * brick[2] + v[2]};
            double shift[3];
            follow_back(&dabs, at, shift);
            for (int k = 0; k < 3; k++)
                worst = fmax(worst, fabs((double)warp.position[k][i] - v[k] - shift[k]));
        }
    }
    print_message("drags differ by at most %.2g voxel; of %d bricks dabs were left out\n", worst, carried);
    assert_true(worst < 0.05 && carried > 20);
}

static iso_editor *make_editor(iso_hgrid *grid) {
    const iso_editor_opts opts = {.pool = NULL};
    const iso_step_opts step = {.stamp = NULL};
    iso_editor *editor;
    assert_int_equal(iso_editor_create(grid, &opts, &editor, NULL), ISO_OK);
    iso_editor_begin_step(editor, &step);
    return editor;
}

/* Images that do not meet do what touches of their own do. */
static void images_apart_act_as_touches_of_their_own(void **state) {
    (void)state;
    for (int t = 0; t < TOOL_COUNT; t++) {
        if (iso_tool_is_drag(TOOLS[t])) continue; /* a single touch drags nothing */
        iso_hgrid *grid[2];
        iso_brush brush = make_brush(TOOLS[t], 5, 'z');
        iso_brush_image images[ISO_IMAGES_MOST];
        brush.symmetry = 4;
        brush.radius = 3.4;
        brush.mirror = iso_vec3_make(31.5, 31.5, 31.5);
        const iso_vec3 normal = {0.905, 0.1, 0.414}, at = {31.5 + 18.2, 31.5 + 2, 31.5 + 8.3};
        const int count = iso_brush_images(&brush, images);
        assert_int_equal(count, 10);
        for (int k = 0; k < 2; k++) {
            grid[k] = sculpt_ball(SIDE, brush.mirror, 20);
            iso_editor *editor = make_editor(grid[k]);
            iso_brush own = brush;
            if (k) own.radial = own.symmetry = 0;
            for (int i = 0; i < (k ? count : 1); i++)
                sculpt_touch(editor, &own, iso_brush_image_point(&images[i], at),
                             iso_brush_image_direction(&images[i], normal));
            iso_editor_destroy(editor);
        }
        double most = 0,
               near = 0; /* (each touch redistances rows of its bricks, beside creases more than once) */
        for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
            const int v[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            const double one = (double)iso_hgrid_at(grid[0], v[0], v[1], v[2]),
                         ten = (double)iso_hgrid_at(grid[1], v[0], v[1], v[2]);
            most = fmax(most, fabs(one - ten));
            if (fabs(one) < 0.9) near = fmax(near, fabs(one - ten));
        }
        print_message("%s: ten images and ten touches differ by %.2g voxel, near the surface %.2g\n",
                      iso_tool_name(TOOLS[t]), most, near);
        assert_true(most < 0.5 && near < 0.02);
        iso_hgrid_destroy(grid[0]);
        iso_hgrid_destroy(grid[1]);
    }
}

/* Images that overlap leave a distance field, as a single touch does. */
static void overlapping_images_leave_distances(void **state) {
    (void)state;
    static const iso_tool tools[] = {ISO_TOOL_ADD, ISO_TOOL_CARVE, ISO_TOOL_INFLATE, ISO_TOOL_BLEND_CARVE};
    for (size_t t = 0; t < sizeof tools / sizeof *tools; t++) {
        iso_session *session = open_session(NULL, NULL);
        iso_brush brush = make_brush(tools[t], 9, 'z');
        const uint64_t begun = iso_change_log_now(iso_session_grid(session)->log);
        session_stroke(session, &brush, (iso_vec3[]){{1.5, 1, 9.4}, {2.5, 1.5, 9}, {4, 2, 8.6}}, 3);
        const sculpt_quality q = sculpt_measure(iso_session_grid(session), begun);
        print_message("%s: | |g| - 1 | mean %.4f, foot points p99 %.3f, %zu of %zu clamped\n",
                      iso_tool_name(tools[t]), q.gradient_mean, q.foot_p99, q.clamped, q.voxels);
        assert_true(q.voxels > 500 && q.clamped == 0 && q.gradient_mean < 0.05 && q.foot_p99 < 0.3);
        iso_session_destroy(session);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(images_are_a_group),
                                       cmocka_unit_test(half_and_quarter_turns_are_exact),
                                       cmocka_unit_test(other_turns_are_near),
                                       cmocka_unit_test(images_on_the_axis_act_once),
                                       cmocka_unit_test(far_dabs_change_nothing),
                                       cmocka_unit_test(images_apart_act_as_touches_of_their_own),
                                       cmocka_unit_test(drags_reach_other_images),
                                       cmocka_unit_test(overlapping_images_leave_distances),
                                       cmocka_unit_test(images_are_apart_or_not),
                                       cmocka_unit_test(repeated_images_are_moved_ones),
                                       cmocka_unit_test(repeated_images_act_as_strokes),
                                       cmocka_unit_test(threads_give_the_same),
                                       cmocka_unit_test(replay_and_edits_give_the_same)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
