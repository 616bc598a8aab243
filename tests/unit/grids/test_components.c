/* The parts of solids compared with a plain breadth-first search, and the surface that remains when small
 * parts are dropped. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "extract/mesh/mesh_measure.h"
#include "extract_support.h"
#include "grids/brick_index.h"
#include "grids/parts/closed.h"
#include "grids/parts/components.h"
#include "grids/scenes/scenes.h"
#include "grids/threshold.h"

/* ---- the reference: labels by breadth-first search in x-fastest order */

typedef struct reference {
    int dims[3];
    size_t count;
    uint8_t *inside;
    int32_t *label; /* -1: not inside */
    size_t *size;   /* by label */
    size_t labels;
    bool *kept;
} reference;

static bool joined(const int step[3], bool diagonal) {
    const int length = abs(step[0]) + abs(step[1]) + abs(step[2]);
    return length == 1 || (diagonal && length == 2);
}

static void search(reference *r, size_t first, int32_t label, bool diagonal, size_t *queue) {
    size_t head = 0, tail = 0;
    queue[tail++] = first;
    r->label[first] = label;
    const int nx = r->dims[0], ny = r->dims[1];
    for (; head < tail; head++) {
        const int at[3] = {(int)(queue[head] % (size_t)nx), (int)(queue[head] / (size_t)nx % (size_t)ny),
                           (int)(queue[head] / (size_t)nx / (size_t)ny)};
        for (int k = 0; k < 27; k++) {
            const int step[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
            int to[3];
            bool in = joined(step, diagonal);
            for (int axis = 0; axis < 3; axis++) {
                to[axis] = at[axis] + step[axis];
                in = in && to[axis] >= 0 && to[axis] < r->dims[axis];
            }
            const size_t i =
                in ? ((size_t)to[2] * (size_t)ny + (size_t)to[1]) * (size_t)nx + (size_t)to[0] : 0;
            if (!in || !r->inside[i] || r->label[i] >= 0) continue;
            r->label[i] = label;
            queue[tail++] = i;
        }
    }
    r->size[label] = tail;
}

static void label_all(reference *r, bool diagonal) {
    size_t *queue = malloc(r->count * sizeof *queue);
    r->label = malloc(r->count * sizeof *r->label);
    r->size = calloc(r->count + 1, sizeof *r->size);
    r->kept = calloc(r->count + 1, sizeof *r->kept);
    for (size_t i = 0; i < r->count; i++) r->label[i] = -1;
    r->labels = 0;
    for (size_t i = 0; i < r->count; i++)
        if (r->inside[i] && r->label[i] < 0) search(r, i, (int32_t)r->labels++, diagonal, queue);
    free(queue);
}

static reference reference_of(const iso_grid *grid, double isovalue) {
    const iso_threshold surface = iso_threshold_of(grid, isovalue);
    const bool below = iso_grid_is_level_set(grid);
    reference r = {0};
    memcpy(r.dims, iso_grid_dims(grid), sizeof r.dims);
    r.count = (size_t)r.dims[0] * (size_t)r.dims[1] * (size_t)r.dims[2];
    r.inside = malloc(r.count);
    size_t i = 0;
    for (int z = 0; z < r.dims[2]; z++)
        for (int y = 0; y < r.dims[1]; y++)
            for (int x = 0; x < r.dims[0]; x++, i++) {
                const float value = iso_grid_at(grid, x, y, z);
                r.inside[i] = isfinite(value) && iso_threshold_inside(&surface, value) != below;
            }
    label_all(&r, below);
    return r;
}

static void reference_free(reference *r) {
    free(r->inside);
    free(r->label);
    free(r->size);
    free(r->kept);
}

/* Marks what is kept by choosing the largest part again and again. */
static void choose(reference *r, const iso_components_opts *opts) {
    const size_t wanted = opts->largest ? opts->largest : r->labels;
    for (size_t n = 0; n < wanted && n < r->labels; n++) {
        size_t best = r->labels;
        for (size_t i = 0; i < r->labels; i++)
            if (!r->kept[i] && (best == r->labels || r->size[i] > r->size[best])) best = i;
        r->kept[best] = true;
    }
    for (size_t i = 0; i < r->labels; i++) r->kept[i] = r->kept[i] && (double)r->size[i] >= opts->min_volume;
}

/* ---- what the filter makes against the reference */

static float *values_of(const iso_grid *grid) {
    const int *dims = iso_grid_dims(grid);
    float *values = malloc((size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2] * sizeof *values);
    size_t i = 0;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) values[i++] = iso_grid_at(grid, x, y, z);
    return values;
}

static bool same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

static void check_totals(const reference *r, const iso_components_totals *totals) {
    size_t kept = 0, voxels = 0, all = 0;
    for (size_t i = 0; i < r->labels; i++) {
        kept += r->kept[i];
        voxels += r->kept[i] ? r->size[i] : 0;
        all += r->size[i];
    }
    assert_int_equal(totals->kept, kept);
    assert_int_equal(totals->dropped, r->labels - kept);
    assert_int_equal(totals->kept_voxels, voxels);
    assert_int_equal(totals->dropped_voxels, all - voxels);
    if (all) assert_true(fabs(totals->dropped_share - (double)(all - voxels) / (double)all) < 1e-12);
}

static void check_values(const reference *r, const iso_grid *grid, float at, const float *before,
                         const float *after) {
    const bool below = iso_grid_is_level_set(grid);
    for (size_t i = 0; i < r->count; i++) {
        const bool dropped = r->label[i] >= 0 && !r->kept[r->label[i]];
        if (dropped) {
            assert_true(isfinite(after[i]));
            assert_true((after[i] >= at) == below);
        } else if (grid->rgrid || r->label[i] >= 0) {
            assert_true(same_bits(before[i], after[i]));
        } else { /* distances around dropped parts may rise */
            assert_true(after[i] >= before[i]);
            assert_true(after[i] <= fmaxf(grid->hgrid->band, at));
        }
    }
}

static iso_grid copy_of(const iso_grid *grid) {
    iso_grid copy;
    iso_error error = {0};
    test_ok(iso_grid_copy(grid, NULL, &copy, &error), &error);
    return copy;
}

static bool nothing_left(const reference *r) {
    for (size_t i = 0; i < r->labels; i++)
        if (r->kept[i]) return false;
    return r->labels > 0;
}

/* One grid filtered by one thread, two and seven, and at every level. */
static void check_filter(const iso_grid *grid, iso_components_opts opts) {
    reference r = reference_of(grid, opts.isovalue);
    choose(&r, &opts);
    float *before = values_of(grid), *first = NULL;
    static const int threads[] = {1, 2, 7};
    for (int run = 0; run < 5; run++) {
        iso_cpu_limit(run == 3 ? ISO_CPU_GENERIC : run == 4 ? ISO_CPU_AVX2 : ISO_CPU_AVX512);
        iso_pool *pool = NULL;
        iso_error error = {0};
        test_ok(iso_pool_create(threads[run % 3], &pool, &error), &error);
        opts.pool = pool;
        iso_grid copy = copy_of(grid);
        iso_components_totals totals;
        iso_status status = iso_components_filter(&copy, &opts, &totals, &error);
        if (nothing_left(&r)) {
            assert_int_equal(status, ISO_ERR_EMPTY);
        } else {
            test_ok(status, &error);
            check_totals(&r, &totals);
        }
        float *after = values_of(&copy);
        if (status == ISO_OK)
            check_values(&r, grid, iso_threshold_of(grid, opts.isovalue).isovalue_ceil, before, after);
        else
            assert_memory_equal(before, after, r.count * sizeof *after);
        if (first) assert_memory_equal(first, after, r.count * sizeof *after);
        if (!first)
            first = after;
        else
            free(after);
        iso_grid_destroy(&copy);
        iso_pool_destroy(pool);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    free(before);
    free(first);
    reference_free(&r);
}

static iso_components_opts random_opts(test_random *random, double isovalue) {
    iso_components_opts opts = {.isovalue = isovalue};
    if (test_random_int(random, 0, 1)) opts.largest = (size_t)test_random_int(random, 1, 9);
    if (!opts.largest || test_random_int(random, 0, 2) == 0) opts.min_volume = test_random_int(random, 2, 9);
    return opts;
}

static void spoil(const iso_grid *grid, test_random *random) {
    static const float odd[] = {NAN, INFINITY, -INFINITY};
    const int *d = grid->rgrid->dims;
    for (int k = 0; k < 20 && grid->rgrid->type == ISO_FLOAT32; k++)
        test_set(grid, test_random_int(random, 0, d[0] - 1), test_random_int(random, 0, d[1] - 1),
                 test_random_int(random, 0, d[2] - 1), (double)odd[k % 3]);
}

static void dense_grids(void **state) {
    (void)state;
    test_random random = {7};
    for (int k = 0; k < 96; k++) {
        int dims[3];
        test_random_dims(&random, 1, k % 3 ? 20 : 6, dims);
        if (k % 4 == 0) dims[k / 4 % 3] = 1;
        if (k % 5 == 0) dims[0] = test_random_int(&random, 60, 135);
        iso_grid grid = test_rgrid(dims, (iso_type)(k % 4));
        test_fill(&grid, (test_pattern)(k / 4 % 3), &random);
        if (k % 2) spoil(&grid, &random);
        grid.rgrid->level_set = k / 12 % 2;
        check_filter(&grid, random_opts(&random, k % 7 ? 100 : 99.5));
        iso_grid_destroy(&grid);
    }
}

/* Isovalues at the ends of a type's values and beyond. */
static void extreme_isovalues(void **state) {
    (void)state;
    static const double isovalues[] = {-40000, -1, 0, 0.5, 1, 250, 255, 255.5, 40000, 70000};
    test_random random = {11};
    for (int k = 0; k < 80; k++) {
        iso_grid grid = test_rgrid((const int[3]){17, 5, 4}, (iso_type)(k % 4));
        test_fill(&grid, TEST_NOISE, &random);
        grid.rgrid->level_set = k / 40;
        check_filter(&grid, (iso_components_opts){.isovalue = isovalues[k / 4 % 10], .largest = 1});
        iso_grid_destroy(&grid);
    }
}

static iso_grid ball_pit(test_random *random, int balls) {
    iso_grid grid = test_hgrid((const int[3]){70, 50, 41}, 3);
    for (int k = 0; k < balls; k++)
        test_stamp_ball(
            &grid, &(test_ball){.centre = {test_random_real(random, 0, 69), test_random_real(random, 0, 49),
                                           test_random_real(random, 0, 40)},
                                .radius = test_random_real(random, 1.2, 9)});
    return grid;
}

static void sparse_grids(void **state) {
    (void)state;
    test_random random = {3};
    for (int k = 0; k < 6; k++) {
        iso_grid grid = ball_pit(&random, 5 + 4 * k);
        check_filter(&grid, random_opts(&random, k % 3 ? 0 : 0.7));
        iso_grid_destroy(&grid);
    }
}

/* ---- surfaces */

static iso_weld weld_of(const iso_grid *grid, double isovalue) {
    iso_error error = {0};
    iso_mesh_set *set = NULL;
    iso_weld weld = {0};
    test_ok(iso_mesh_set_create(grid, &(iso_mesh_opts){.isovalue = isovalue}, &set, &error), &error);
    test_ok(iso_mesh_set_update(set, &error), &error);
    const iso_mesh_view view = iso_mesh_set_view(set);
    test_ok(iso_mesh_weld(&view, NULL, &weld, &error), &error);
    iso_mesh_set_destroy(set);
    return weld;
}

static int compare_positions(const void *a, const void *b) {
    return memcmp(((const iso_surfel *)a)->position, ((const iso_surfel *)b)->position,
                  sizeof((const iso_surfel *)a)->position);
}

/* Which of its edge's ends is inside, of the reference's labels; -1: it lies on a voxel. */
static int32_t label_at(const reference *r, const iso_surfel *vertex) {
    for (int up = 0; up < 2; up++) {
        size_t i = 0;
        for (int axis = 2; axis >= 0; axis--) {
            const float p = vertex->position[axis];
            i = i * (size_t)r->dims[axis] + (size_t)(up ? ceilf(p) : floorf(p));
        }
        if (r->label[i] >= 0) return r->label[i];
    }
    return -1;
}

/* The vertices of the kept parts are those of the unfiltered surface, to the bit, and no others are there. */
static void check_subset(const iso_grid *grid, const iso_components_opts *opts) {
    iso_error error = {0};
    reference r = reference_of(grid, opts->isovalue);
    choose(&r, opts);
    iso_weld all = weld_of(grid, opts->isovalue);
    iso_components_totals totals;
    iso_grid copy = copy_of(grid);
    test_ok(iso_components_filter(&copy, opts, &totals, &error), &error);
    iso_weld kept = weld_of(&copy, opts->isovalue);
    size_t expected = 0;
    for (size_t i = 0; i < all.vertex_count; i++) expected += r.kept[label_at(&r, &all.vertices[i])];
    assert_int_equal(kept.vertex_count, expected);
    assert_true(totals.dropped > 0 && kept.vertex_count < all.vertex_count);
    qsort(all.vertices, all.vertex_count, sizeof *all.vertices, compare_positions);
    for (size_t i = 0; i < kept.vertex_count; i++)
        assert_non_null(bsearch(&kept.vertices[i], all.vertices, all.vertex_count, sizeof *all.vertices,
                                compare_positions));
    iso_weld_free(&all);
    iso_weld_free(&kept);
    iso_grid_destroy(&copy);
    reference_free(&r);
}

static void vertices_stay(void **state) {
    (void)state;
    test_random random = {5};
    for (int k = 0; k < 8; k++) {
        iso_grid grid = test_rgrid((const int[3]){33, 20, 18}, (iso_type)(k % 4));
        test_fill(&grid, k < 4 ? TEST_NOISE : TEST_LEVELS, &random);
        check_subset(&grid, &(iso_components_opts){.isovalue = 99.5, .largest = 3});
        iso_grid_destroy(&grid);
    }
    iso_grid balls = ball_pit(&random, 30);
    check_subset(&balls, &(iso_components_opts){.isovalue = 0, .largest = 2});
    /* Not steep enough for distances: voxels beside a kept part keep their values all the same. */
    for (int i = 0; i < balls.hgrid->pool.next; i++)
        for (int k = 0; k < ISO_BRICK_VOXELS; k++) iso_hgrid_brick(balls.hgrid, i)[k] *= 0.1f;
    check_subset(&balls, &(iso_components_opts){.isovalue = 0, .largest = 2});
    iso_grid_destroy(&balls);
}

/* The index that a dense grid has is the one that its values give. */
static void index_follows(void **state) {
    (void)state;
    test_random random = {9};
    iso_error error = {0};
    iso_grid grid = test_rgrid((const int[3]){90, 40, 35}, ISO_INT16);
    for (int i = 0; i < 60; i++) { /* a row of five, and single voxels */
        const int x = i < 5 ? i : test_random_int(&random, 0, 89);
        test_set(&grid, x, i < 5 ? 0 : test_random_int(&random, 2, 39),
                 test_random_int(&random, 0, i < 5 ? 0 : 34), 150 + i);
    }
    iso_components_totals totals;
    test_ok(iso_brick_index_of(grid.rgrid, NULL, NULL, &error), &error);
    test_ok(iso_components_filter(&grid, &(iso_components_opts){.isovalue = 100, .min_volume = 5}, &totals,
                                  &error),
            &error);
    iso_grid copy = copy_of(&grid);
    const struct iso_brick_index *a, *b;
    test_ok(iso_brick_index_of(grid.rgrid, NULL, &a, &error), &error);
    test_ok(iso_brick_index_of(copy.rgrid, NULL, &b, &error), &error);
    for (uint32_t i = 0; i < iso_brick_index_bricks(a); i++) {
        const iso_brick_range p = iso_brick_index_range(a, i), q = iso_brick_index_range(b, i);
        assert_true(p.lo == q.lo && p.hi == q.hi && p.finite == q.finite);
    }
    iso_grid_destroy(&grid);
    iso_grid_destroy(&copy);
}

/* Foot points of a level set from which parts were dropped lie on the kept ones. */
static void foot_points_are_of_kept_parts(void **state) {
    (void)state;
    iso_error error = {0};
    iso_grid grid = test_hgrid((const int[3]){64, 64, 64}, 3);
    const iso_vec3 large = {22, 30, 30};
    test_stamp_ball(&grid, &(test_ball){.centre = large, .radius = 14});
    test_stamp_ball(&grid, &(test_ball){.centre = {41, 30, 30}, .radius = 3});
    test_stamp_ball(&grid, &(test_ball){.centre = {52, 50, 50}, .radius = 6});
    iso_components_totals totals;
    test_ok(iso_components_filter(&grid, &(iso_components_opts){.largest = 1}, &totals, &error), &error);
    assert_int_equal(totals.kept, 1);
    assert_int_equal(totals.dropped, 2);
    iso_point_set *set = NULL;
    test_ok(iso_point_set_create(&grid, &(iso_points_opts){.floats = true}, &set, &error), &error);
    test_ok(iso_point_set_update(set, &error), &error);
    const iso_point_view view = iso_point_set_view(set);
    assert_true(iso_point_view_count(&view) > 1000);
    for (size_t s = 0; s < view.span_count; s++)
        for (uint32_t i = 0; i < view.spans[s].count; i++) {
            const iso_surfel point = iso_point_view_get(&view, view.spans[s].first + i);
            double p[3];
            for (int axis = 0; axis < 3; axis++)
                p[axis] = ISO_BRICK * (double)view.spans[s].brick[axis] + (double)point.position[axis];
            const double d = sqrt((p[0] - large.x) * (p[0] - large.x) + (p[1] - large.y) * (p[1] - large.y) +
                                  (p[2] - large.z) * (p[2] - large.z));
            assert_true(fabs(d - 14) < 0.5);
        }
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);
}

/* ---- closed surfaces */

static iso_mesh_measures measure(const iso_grid *grid, double isovalue) {
    iso_error error = {0};
    iso_mesh_measures one, many;
    iso_pool *pool = NULL;
    iso_weld weld = weld_of(grid, isovalue);
    test_ok(iso_pool_create(7, &pool, &error), &error);
    test_ok(iso_weld_measure(&weld, iso_grid_transform(grid), NULL, &one, &error), &error);
    test_ok(iso_weld_measure(&weld, iso_grid_transform(grid), pool, &many, &error), &error);
    assert_memory_equal(&one.area, &many.area, sizeof one.area);
    assert_memory_equal(&one.volume, &many.volume, sizeof one.volume);
    assert_int_equal(one.edges, many.edges);
    assert_int_equal(one.open_edges, many.open_edges);
    iso_pool_destroy(pool);
    iso_weld_free(&weld);
    return one;
}

static iso_grid closed_of(const iso_grid *grid, double isovalue) {
    iso_error error = {0};
    iso_grid closed;
    test_ok(iso_grid_close(grid, isovalue, NULL, &closed, &error), &error);
    return closed;
}

/* Every shell of a closed surface lies between a part of the solid and a part of the outside, and together
 * they make a tree. Where the solid is joined by edges, the outside is joined by faces' diagonals, and the
 * other way round. */
static void shells_are_counted(void **state) {
    (void)state;
    test_random random = {13};
    for (int k = 0; k < 24; k++) {
        int dims[3];
        test_random_dims(&random, 1, 14, dims);
        iso_grid grid = test_rgrid(dims, (iso_type)(k % 4));
        test_fill(&grid, (test_pattern)(k / 4 % 3), &random);
        if (k % 2) spoil(&grid, &random);
        grid.rgrid->level_set = k / 12;
        iso_grid closed = closed_of(&grid, 100);
        reference solid = reference_of(&closed, 100), outside = reference_of(&closed, 100);
        for (size_t i = 0; i < outside.count; i++) outside.inside[i] = !outside.inside[i];
        free(outside.label);
        free(outside.size);
        free(outside.kept);
        label_all(&outside, !grid.rgrid->level_set);
        const iso_mesh_measures m = measure(&closed, 100);
        assert_int_equal(m.open_edges, 0);
        assert_int_equal(m.crowded_edges, 0);
        assert_int_equal(m.pieces, solid.labels + outside.labels - 1);
        if (solid.labels) assert_true(m.volume >= 0 && m.area > 0);
        reference_free(&solid);
        reference_free(&outside);
        iso_grid_destroy(&closed);
        iso_grid_destroy(&grid);
    }
}

static void check_bounds(const iso_grid *grid, const iso_grid *closed, double isovalue) {
    const iso_weld weld = weld_of(closed, isovalue);
    const int *dims = iso_grid_dims(grid);
    const iso_affine affine = iso_transform_affine(iso_grid_transform(closed)),
                     original = iso_transform_affine(iso_grid_transform(grid));
    for (size_t i = 0; i < weld.vertex_count; i++) {
        const float *p = weld.vertices[i].position;
        const iso_vec3 at =
            iso_affine_point_to_index(&original, iso_affine_point(&affine, iso_vec3_make(p[0], p[1], p[2])));
        const double q[3] = {at.x, at.y, at.z};
        for (int axis = 0; axis < 3; axis++)
            assert_true(q[axis] >= -ISO_CLOSED_TOLERANCE && q[axis] <= dims[axis] - 1 + ISO_CLOSED_TOLERANCE);
    }
    iso_weld free_me = weld;
    iso_weld_free(&free_me);
}

/* Half a ball, in millimetres that are no voxels: dense and sparse. */
static void half_balls(void **state) {
    (void)state;
    const double pi = 3.14159265358979, radius = 20;
    for (int dense = 0; dense < 2; dense++) {
        iso_error error = {0};
        iso_grid ball = test_ball_grid(64, iso_vec3_make(31.5, 31.5, 31.5), radius, dense);
        iso_transform *transform = dense ? &ball.rgrid->transform : &ball.hgrid->transform;
        for (int axis = 0; axis < 3; axis++) transform->spacing[axis] = 0.5 + 0.25 * axis * dense;
        transform->origin[1] = -7;
        const double voxel = transform->spacing[0] * transform->spacing[1] * transform->spacing[2];
        const int lo[3] = {2, 3, 32}, hi[3] = {61, 60, 63};
        assert_true(measure(&ball, 0).open_edges == 0);
        if (dense) {
            test_ok(iso_rgrid_crop(ball.rgrid, lo, hi, &error), &error);
        } else {
            iso_hgrid *cropped = NULL;
            test_ok(iso_hgrid_crop(ball.hgrid, lo, hi, &cropped, &error), &error);
            iso_hgrid_destroy(ball.hgrid);
            ball.hgrid = cropped;
        }
        const iso_mesh_measures open = measure(&ball, 0);
        assert_true(open.open_edges > 0 && isnan(open.volume));
        iso_grid closed = closed_of(&ball, 0);
        const iso_mesh_measures m = measure(&closed, 0);
        /* the cut is half a voxel above the centre */
        const double expected =
            (2.0 / 3 * pi * radius * radius * radius - 0.5 * pi * radius * radius) * voxel;
        assert_int_equal(m.open_edges, 0);
        assert_int_equal(m.pieces, 1);
        assert_int_equal(m.euler, 2);
        assert_true(fabs(m.volume - expected) < 0.005 * expected);
        check_bounds(&ball, &closed, 0);
        iso_grid_destroy(&closed);
        iso_grid_destroy(&ball);
    }
}

/* The volume that a mesh of a cut gyroid encloses is about that of its voxels: those of the border count by
 * half. */
static void closed_gyroid(void **state) {
    (void)state;
    iso_error error = {0};
    iso_grid gyroid;
    double isovalue;
    test_ok(iso_scene_create("gyroid", &(iso_scene_opts){.size = 48}, &gyroid, &isovalue, &error), &error);
    const int lo[3] = {3, 0, 5}, hi[3] = {40, 37, 47};
    test_ok(iso_rgrid_crop(gyroid.rgrid, lo, hi, &error), &error);
    iso_grid closed = closed_of(&gyroid, isovalue);
    reference r = reference_of(&gyroid, isovalue);
    double voxels = 0;
    for (size_t i = 0; i < r.count; i++) {
        double weight = r.inside[i];
        size_t rest = i;
        for (int axis = 0; axis < 3; axis++) {
            const int at = (int)(rest % (size_t)r.dims[axis]);
            rest /= (size_t)r.dims[axis];
            if (at == 0 || at == r.dims[axis] - 1) weight /= 2;
        }
        voxels += weight;
    }
    const iso_mesh_measures m = measure(&closed, isovalue);
    assert_int_equal(m.open_edges, 0);
    assert_int_equal(m.crowded_edges, 0);
    assert_int_equal(m.pieces, 1);
    assert_true(m.euler % 2 == 0 && m.euler < -10);
    assert_true(fabs(m.volume - voxels) < 0.01 * voxels);
    check_bounds(&gyroid, &closed, isovalue);
    reference_free(&r);
    iso_grid_destroy(&closed);
    iso_grid_destroy(&gyroid);
}

/* Vertices of different edges are in different places after they were moved apart. */
static void separated_vertices(void **state) {
    (void)state;
    test_random random = {17};
    iso_error error = {0};
    iso_grid grid = test_rgrid((const int[3]){20, 18, 17}, ISO_UINT8);
    test_fill(&grid, TEST_LEVELS, &random);
    iso_mesh_set *set = NULL;
    iso_weld weld = {0};
    test_ok(iso_mesh_set_create(&grid, &(iso_mesh_opts){.isovalue = 100}, &set, &error), &error);
    test_ok(iso_mesh_set_update(set, &error), &error);
    const iso_mesh_view view = iso_mesh_set_view(set);
    for (int separate = 0; separate < 2; separate++) {
        test_ok(iso_mesh_weld(&view, NULL, &weld, &error), &error);
        if (separate) iso_weld_separate(&view, ISO_CLOSED_TOLERANCE, &weld);
        qsort(weld.vertices, weld.vertex_count, sizeof *weld.vertices, compare_positions);
        size_t twins = 0;
        for (size_t i = 1; i < weld.vertex_count; i++)
            twins += compare_positions(&weld.vertices[i - 1], &weld.vertices[i]) == 0;
        assert_true(separate ? twins == 0 : twins > 0);
        iso_weld_free(&weld);
    }
    iso_mesh_set_destroy(set);
    iso_grid_destroy(&grid);
}

static void refusals(void **state) {
    (void)state;
    iso_error error = {0};
    iso_grid grid = test_ball_grid(32, iso_vec3_make(15.5, 15.5, 15.5), 8, 1), closed;
    iso_components_totals totals;
    assert_int_equal(iso_components_filter(&grid, &(iso_components_opts){.isovalue = NAN}, &totals, &error),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_grid_close(&grid, INFINITY, NULL, &closed, &error), ISO_ERR_USAGE);
    test_ok(
        iso_components_filter(&grid, &(iso_components_opts){.isovalue = -100, .largest = 1}, &totals, &error),
        &error);
    assert_int_equal(totals.kept + totals.dropped, 0);
    iso_grid_destroy(&grid);
    iso_grid wide = test_hgrid((const int[3]){ISO_HGRID_MAX, 3, 3}, 3);
    assert_int_equal(iso_grid_close(&wide, 0, NULL, &closed, &error), ISO_ERR_LIMIT);
    iso_grid_destroy(&wide);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dense_grids),        cmocka_unit_test(extreme_isovalues),
        cmocka_unit_test(sparse_grids),       cmocka_unit_test(vertices_stay),
        cmocka_unit_test(index_follows),      cmocka_unit_test(foot_points_are_of_kept_parts),
        cmocka_unit_test(shells_are_counted), cmocka_unit_test(half_balls),
        cmocka_unit_test(closed_gyroid),      cmocka_unit_test(separated_vertices),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
