/* extract_support: grids with test patterns, random edits, and comparisons of points and meshes. */
#include "extract_support.h"
#include "check_support.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

uint32_t test_random_next(test_random *random) {
    return random_long(&random->state);
}

int test_random_int(test_random *random, int low, int high) {
    return low + (int)(test_random_next(random) % (uint32_t)(high - low + 1));
}

double test_random_real(test_random *random, double low, double high) {
    return low + (high - low) * test_random_next(random) / 4294967296.0;
}

iso_vec3 test_random_direction(test_random *random) {
    const double x = test_random_real(random, -1, 1), y = test_random_real(random, -1, 1),
                 z = test_random_real(random, -1, 1);
    return iso_vec3_unit(iso_vec3_make(x, y, z));
}

void test_random_dims(test_random *random, int low, int high, int dims[3]) {
    for (int axis = 0; axis < 3; axis++) dims[axis] = test_random_int(random, low, high);
}

iso_grid test_rgrid(const int dims[3], iso_type type) {
    iso_rgrid_desc desc = {.dims = {dims[0], dims[1], dims[2]}, .type = type};
    iso_grid grid = {0};
    assert_int_equal(iso_rgrid_create(&desc, &grid.rgrid, NULL), ISO_OK);
    size_t voxels = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
    memset(grid.rgrid->data, 0, voxels * iso_type_size(type));
    return grid;
}

iso_grid test_hgrid(const int dims[3], float band) {
    iso_grid grid = {0};
    assert_int_equal(iso_hgrid_create(dims, band, NULL, &grid.hgrid, NULL), ISO_OK);
    return grid;
}

static void set_rgrid(iso_rgrid *grid, int x, int y, int z, double value) {
    ptrdiff_t i = x + y * grid->stride_y + z * grid->stride_z;
    switch (grid->type) {
    case ISO_UINT8:
        ((uint8_t *)grid->data)[i] = (uint8_t)lrint(value);
        break;
    case ISO_INT16:
        ((int16_t *)grid->data)[i] = (int16_t)lrint(value);
        break;
    case ISO_UINT16:
        ((uint16_t *)grid->data)[i] = (uint16_t)lrint(value);
        break;
    default:
        ((float *)grid->data)[i] = (float)value;
    }
}

void test_set(const iso_grid *grid, int x, int y, int z, double value) {
    if (grid->rgrid) {
        set_rgrid(grid->rgrid, x, y, z, value);
        return;
    }
    float *brick;
    assert_int_equal(iso_hgrid_split(grid->hgrid, x / 16, y / 16, z / 16, &brick, NULL), ISO_OK);
    brick[((z % 16) * 16 + y % 16) * 16 + x % 16] = (float)value;
}

static double pattern_value(test_pattern pattern, test_random *random, const double wave[12],
                            const int v[3]) {
    if (pattern == TEST_NOISE) return test_random_real(random, 0, 250);
    if (pattern == TEST_LEVELS) return 25 * test_random_int(random, 0, 8);
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += sin(wave[4 * i] * v[0] + wave[4 * i + 1] * v[1] + wave[4 * i + 2] * v[2] + wave[4 * i + 3]);
    return 110 + 36 * sum;
}

void test_fill(const iso_grid *grid, test_pattern pattern, test_random *random) {
    const int *dims = iso_grid_dims(grid);
    double wave[12];
    for (int i = 0; i < 12; i++) wave[i] = test_random_real(random, -0.5, 0.5);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                test_set(grid, x, y, z, pattern_value(pattern, random, wave, (int[3]){x, y, z}));
}

static int clamp_int(double value, int low, int high) {
    return value < low ? low : value > high ? high : (int)value;
}

void test_stamp_ball(const iso_grid *grid, const test_ball *ball) {
    const int *dims = iso_grid_dims(grid);
    double band = grid->hgrid ? grid->hgrid->band : 3, reach = ball->radius + band;
    const double centre[3] = {ball->centre.x, ball->centre.y, ball->centre.z};
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = clamp_int(ceil(centre[axis] - reach), 0, dims[axis] - 1);
        hi[axis] = clamp_int(floor(centre[axis] + reach), 0, dims[axis] - 1);
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++) {
                iso_vec3 way = iso_vec3_sub(iso_vec3_make(x, y, z), ball->centre);
                double d = fmax(-band, fmin(band, iso_vec3_length(way) - ball->radius));
                double old = iso_grid_at(grid, x, y, z);
                double value = ball->carve ? fmax(old, -d) : fmin(old, d);
                if (value != old) test_set(grid, x, y, z, value);
            }
    if (grid->hgrid) {
        iso_hgrid_prune(grid->hgrid);
        assert_int_equal(iso_hgrid_mark_changed(grid->hgrid, lo, hi, NULL), ISO_OK);
    } else {
        assert_int_equal(iso_rgrid_mark_changed(grid->rgrid, lo, hi, NULL), ISO_OK);
    }
}

iso_grid test_random_balls(int size, int count, test_random *random) {
    iso_grid grid = test_hgrid((const int[3]){size, size - 5, size + 3}, 3);
    for (int i = 0; i < count; i++) {
        const double x = test_random_real(random, 0, size), y = test_random_real(random, 0, size),
                     z = test_random_real(random, 0, size), radius = test_random_real(random, 2, 0.3 * size);
        const test_ball ball = {iso_vec3_make(x, y, z), radius, i > 0 && i % 3 == 0};
        test_stamp_ball(&grid, &ball);
    }
    return grid;
}

iso_grid test_ball_grid(int size, iso_vec3 centre, double radius, int dense) {
    const int dims[3] = {size, size, size};
    iso_grid grid = dense ? test_rgrid(dims, ISO_FLOAT32) : test_hgrid(dims, 3);
    if (dense) {
        grid.rgrid->level_set = 1;
        for (int i = 0; i < size * size * size; i++) ((float *)grid.rgrid->data)[i] = 3;
    }
    test_stamp_ball(&grid, &(test_ball){centre, radius, 0});
    return grid;
}

void test_scatter_nonfinite(const iso_grid *grid, test_random *random) {
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    const int *dims = grid->rgrid->dims, count = dims[0] * dims[1] * dims[2];
    float *values = grid->rgrid->data;
    for (int i = 0; i < count / 25; i++) values[test_random_int(random, 0, count - 1)] = bad[i % 3];
}

void test_random_edit(const iso_grid *grid, test_random *random) {
    const int *dims = iso_grid_dims(grid);
    if (iso_grid_is_level_set(grid)) {
        test_ball ball = {.radius = test_random_real(random, 1, 7), .carve = test_random_int(random, 0, 1)};
        ball.centre = iso_vec3_make(test_random_real(random, -3, dims[0] + 3),
                                    test_random_real(random, -3, dims[1] + 3),
                                    test_random_real(random, -3, dims[2] + 3));
        test_stamp_ball(grid, &ball);
        return;
    }
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = test_random_int(random, 0, dims[axis] - 1);
        hi[axis] = lo[axis] + test_random_int(random, 0, test_random_int(random, 0, 6));
        if (hi[axis] >= dims[axis]) hi[axis] = dims[axis] - 1;
    }
    int flat = test_random_int(random, 0, 2); /* one value: spans must also be able to become empty */
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                test_set(grid, x, y, z, flat ? 50 * flat : test_random_real(random, 50, 150));
    assert_int_equal(iso_rgrid_mark_changed(grid->rgrid, lo, hi, NULL), ISO_OK);
}

static int compare_bricks(const int32_t *a, const int32_t *b) {
    for (int axis = 2; axis >= 0; axis--)
        if (a[axis] != b[axis]) return a[axis] < b[axis] ? -1 : 1;
    return 0;
}

static int compare_point_spans(const void *a, const void *b) {
    return compare_bricks(((const iso_point_span *)a)->brick, ((const iso_point_span *)b)->brick);
}

static int compare_mesh_spans(const void *a, const void *b) {
    return compare_bricks(((const iso_mesh_span *)a)->brick, ((const iso_mesh_span *)b)->brick);
}

/* A sorted copy of the spans that are not empty. */
static iso_point_span *sorted_point_spans(const iso_point_view *view, size_t *count) {
    iso_point_span *spans = malloc((view->span_count + 1) * sizeof *spans);
    *count = 0;
    for (size_t i = 0; i < view->span_count; i++)
        if (view->spans[i].count) spans[(*count)++] = view->spans[i];
    qsort(spans, *count, sizeof *spans, compare_point_spans);
    return spans;
}

static void same_bytes(const void *a, const void *b, size_t bytes) {
    if (bytes) assert_memory_equal(a, b, bytes);
}

void test_same_points(const iso_point_view *a, const iso_point_view *b) {
    size_t count_a, count_b;
    iso_point_span *spans_a = sorted_point_spans(a, &count_a), *spans_b = sorted_point_spans(b, &count_b);
    assert_int_equal(count_a, count_b);
    for (size_t i = 0; i < count_a; i++) {
        const iso_point_span *p = &spans_a[i], *q = &spans_b[i];
        assert_int_equal(compare_point_spans(p, q), 0);
        assert_int_equal(p->count, q->count);
        if (a->packed)
            same_bytes(a->packed + p->first, b->packed + q->first, p->count * sizeof(iso_point));
        else
            same_bytes(a->surfels + p->first, b->surfels + q->first, p->count * sizeof(iso_surfel));
        if (a->curvatures)
            same_bytes(a->curvatures + p->first, b->curvatures + q->first, p->count * sizeof(iso_curvature));
    }
    free(spans_a);
    free(spans_b);
}

static iso_mesh_span *sorted_mesh_spans(const iso_mesh_view *view, size_t *count) {
    iso_mesh_span *spans = malloc((view->span_count + 1) * sizeof *spans);
    *count = 0;
    for (size_t i = 0; i < view->span_count; i++)
        if (view->spans[i].vertex_count) spans[(*count)++] = view->spans[i];
    qsort(spans, *count, sizeof *spans, compare_mesh_spans);
    return spans;
}

void test_same_mesh(const iso_mesh_view *a, const iso_mesh_view *b) {
    size_t count_a, count_b;
    iso_mesh_span *spans_a = sorted_mesh_spans(a, &count_a), *spans_b = sorted_mesh_spans(b, &count_b);
    assert_int_equal(count_a, count_b);
    for (size_t i = 0; i < count_a; i++) {
        const iso_mesh_span *p = &spans_a[i], *q = &spans_b[i];
        assert_int_equal(compare_mesh_spans(p, q), 0);
        assert_int_equal(p->vertex_count, q->vertex_count);
        assert_int_equal(p->owned_count, q->owned_count);
        assert_int_equal(p->triangle_count, q->triangle_count);
        same_bytes(a->vertices + p->first_vertex, b->vertices + q->first_vertex,
                   p->vertex_count * sizeof(iso_surfel));
        same_bytes(a->keys + p->first_vertex, b->keys + q->first_vertex,
                   p->vertex_count * sizeof(iso_edge_key));
        same_bytes(a->triangles + p->first_triangle, b->triangles + q->first_triangle,
                   p->triangle_count * sizeof(uint16_t[3]));
    }
    free(spans_a);
    free(spans_b);
}

iso_point_set *test_point_set(const iso_grid *grid, const iso_points_opts *opts) {
    iso_point_set *set = NULL;
    iso_error error = {0};
    test_ok(iso_point_set_create(grid, opts, &set, &error), &error);
    test_ok(iso_point_set_update(set, &error), &error);
    return set;
}

iso_mesh_set *test_mesh_set(const iso_grid *grid, const iso_mesh_opts *opts) {
    iso_mesh_set *set = NULL;
    iso_error error = {0};
    test_ok(iso_mesh_set_create(grid, opts, &set, &error), &error);
    test_ok(iso_mesh_set_update(set, &error), &error);
    return set;
}
