/* sparse_rows: surfaces in few rows of a brick, of which extraction looks at no others. Points and meshes
 * against the plain per-brick code and against a count of crossed edges that knows no bricks, while edits
 * narrow and widen what the rows' ranges say. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "extract/mesh/marching_cubes.h"
#include "extract/points/edge_points.h"
#include "extract_support.h"

static const iso_type all_types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

/* The sets that are followed: by the log alone, and extracted anew each time, which asks the index. */
typedef struct follower {
    iso_grid grid;
    iso_point_set *followed, *anew;
    iso_mesh_set *mesh_followed, *mesh_anew;
    double isovalue;
    iso_brick_window window;
    iso_surfel surfels[ISO_EDGES_OWN];
    iso_brick_mesh mesh;
} follower;

static follower *follow(const iso_grid *grid, double isovalue) {
    follower *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->grid = *grid;
    f->isovalue = isovalue;
    const iso_points_opts points = {.isovalue = isovalue, .floats = true};
    const iso_mesh_opts mesh = {.isovalue = isovalue};
    assert_int_equal(iso_point_set_create(grid, &points, &f->followed, NULL), ISO_OK);
    assert_int_equal(iso_point_set_create(grid, &points, &f->anew, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_create(grid, &mesh, &f->mesh_followed, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_create(grid, &mesh, &f->mesh_anew, NULL), ISO_OK);
    return f;
}

static void unfollow(follower *f) {
    iso_point_set_destroy(f->followed);
    iso_point_set_destroy(f->anew);
    iso_mesh_set_destroy(f->mesh_followed);
    iso_mesh_set_destroy(f->mesh_anew);
    free(f);
}

static bool is_crossed(double a, double b, double isovalue) {
    return isfinite(a) && isfinite(b) && (a >= isovalue) != (b >= isovalue);
}

static size_t count_edges(const iso_grid *grid, double isovalue) {
    const int *n = iso_grid_dims(grid);
    size_t count = 0;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                const double v = iso_grid_at(grid, x, y, z);
                if (x + 1 < n[0]) count += is_crossed(v, iso_grid_at(grid, x + 1, y, z), isovalue);
                if (y + 1 < n[1]) count += is_crossed(v, iso_grid_at(grid, x, y + 1, z), isovalue);
                if (z + 1 < n[2]) count += is_crossed(v, iso_grid_at(grid, x, y, z + 1), isovalue);
            }
    return count;
}

/* Every span holds what the plain code makes of the brick; that no span is missing, the count shows. */
static void check_points(follower *f, iso_point_set *set) {
    const iso_threshold surface = iso_threshold_of(&f->grid, f->isovalue);
    const iso_point_view view = iso_point_set_view(set);
    size_t total = 0;
    for (size_t s = 0; s < view.span_count; s++) {
        const iso_point_span *span = &view.spans[s];
        iso_edge_points plain = {.points = f->surfels};
        iso_brick_window_fill(&f->grid, span->brick, &f->window);
        iso_edge_points_own(&f->window, &surface, &plain);
        assert_int_equal(span->count, plain.count);
        assert_memory_equal(view.surfels + span->first, plain.points, plain.count * sizeof *plain.points);
        total += span->count;
    }
    assert_int_equal(total, count_edges(&f->grid, f->isovalue));
}

static void check_mesh(follower *f, iso_mesh_set *set) {
    const iso_threshold surface = iso_threshold_of(&f->grid, f->isovalue);
    const iso_mesh_view view = iso_mesh_set_view(set);
    size_t total = 0;
    for (size_t s = 0; s < view.span_count; s++) {
        const iso_mesh_span *span = &view.spans[s];
        iso_brick_window_fill(&f->grid, span->brick, &f->window);
        iso_marching_cubes(&f->window, &surface, &f->mesh);
        assert_int_equal(span->owned_count, f->mesh.owned_count);
        assert_int_equal(span->vertex_count, f->mesh.vertex_count);
        assert_int_equal(span->triangle_count, f->mesh.triangle_count);
        assert_memory_equal(view.vertices + span->first_vertex, f->mesh.vertices,
                            span->vertex_count * sizeof *f->mesh.vertices);
        assert_memory_equal(view.keys + span->first_vertex, f->mesh.keys,
                            span->vertex_count * sizeof *f->mesh.keys);
        assert_memory_equal(view.triangles + span->first_triangle, f->mesh.triangles,
                            span->triangle_count * sizeof *f->mesh.triangles);
        total += span->owned_count;
    }
    assert_int_equal(total, count_edges(&f->grid, f->isovalue));
}

/* `other`: an isovalue to come from, so that all is extracted anew. */
static void check(follower *f, double other, bool with_meshes) {
    assert_int_equal(iso_point_set_update(f->followed, NULL), ISO_OK);
    iso_point_set_isovalue(f->anew, other);
    iso_point_set_isovalue(f->anew, f->isovalue);
    assert_int_equal(iso_point_set_update(f->anew, NULL), ISO_OK);
    check_points(f, f->followed);
    check_points(f, f->anew);
    if (!with_meshes) return;
    assert_int_equal(iso_mesh_set_update(f->mesh_followed, NULL), ISO_OK);
    iso_mesh_set_isovalue(f->mesh_anew, other);
    iso_mesh_set_isovalue(f->mesh_anew, f->isovalue);
    assert_int_equal(iso_mesh_set_update(f->mesh_anew, NULL), ISO_OK);
    check_mesh(f, f->mesh_followed);
    check_mesh(f, f->mesh_anew);
}

static void set_voxel(const iso_grid *grid, const int v[3], double value) {
    test_set(grid, v[0], v[1], v[2], value);
    assert_int_equal(iso_rgrid_mark_changed(grid->rgrid, v, v, NULL), ISO_OK);
}

static void fill_with(const iso_grid *grid, double value) {
    const int *n = iso_grid_dims(grid);
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) test_set(grid, x, y, z, value);
    assert_int_equal(iso_rgrid_mark_changed(grid->rgrid, (int[3]){0, 0, 0}, n, NULL), ISO_OK);
}

/* One voxel alone in every row and slice, inside or outside, moved from place to place. */
static void a_voxel_in_every_row(void **state) {
    (void)state;
    const int dims[3] = {70, 35, 34};
    for (int type = 0; type < 4; type++) {
        iso_grid grid = test_rgrid(dims, all_types[type]);
        test_random random = {(uint64_t)type + 1};
        const double background = type % 2 ? 200 : 50, voxel = 250 - background;
        fill_with(&grid, background);
        follower *f = follow(&grid, 125);
        int last[3] = {0, 0, 0};
        for (int row = type; row < dims[1] * dims[2]; row += 4) {
            const int v[3] = {test_random_int(&random, 0, dims[0] - 1), row % dims[1], row / dims[1]};
            set_voxel(&grid, last, background);
            set_voxel(&grid, v, voxel);
            check(f, 1000, row % 3 == 0);
            memcpy(last, v, sizeof last);
        }
        unfollow(f);
        iso_grid_destroy(&grid);
    }
}

/* Values of a voxel around an isovalue, in a type's range; `wide`: far ones as well, which make the steps of
 * rows' ranges coarse. */
static double random_value(iso_type type, bool wide, double isovalue, test_random *random) {
    static const double most[] = {255, 32767, 65535, 1e6};
    if (wide && test_random_int(random, 0, 9) == 0) return type ? most[type] : 255;
    const double low = fmax(0, isovalue - 3);
    return type == ISO_FLOAT32 ? test_random_real(random, low, isovalue + 3)
                               : low + test_random_int(random, 0, 6);
}

/* A few voxels on, a few off, boxes filled; with some that are not finite, in floats. */
static void random_edit(const iso_grid *grid, double background, double isovalue, test_random *random) {
    const int *n = iso_grid_dims(grid);
    const iso_type type = grid->rgrid->type;
    int lo[3], hi[3], v[3];
    const int kind = test_random_int(random, 0, 5);
    for (int axis = 0; axis < 3; axis++) {
        const int size = kind == 0 ? 20 : kind == 1 ? 4 : 1;
        lo[axis] = test_random_int(random, 0, n[axis] - 1);
        hi[axis] = lo[axis] + size <= n[axis] ? lo[axis] + size - 1 : n[axis] - 1;
    }
    const double value = kind < 2 ? background : random_value(type, kind == 2, isovalue, random);
    for (v[2] = lo[2]; v[2] <= hi[2]; v[2]++)
        for (v[1] = lo[1]; v[1] <= hi[1]; v[1]++)
            for (v[0] = lo[0]; v[0] <= hi[0]; v[0]++) test_set(grid, v[0], v[1], v[2], value);
    if (type == ISO_FLOAT32 && kind == 3)
        test_set(grid, lo[0] % 20, lo[1], lo[2], test_random_int(random, 0, 1) ? NAN : INFINITY);
    lo[0] = type == ISO_FLOAT32 && kind == 3 ? 0 : lo[0];
    assert_int_equal(iso_rgrid_mark_changed(grid->rgrid, lo, hi, NULL), ISO_OK);
}

static void few_voxels_and_edits(void **state) {
    (void)state;
    test_random random = {5};
    const int shapes[][3] = {{150, 18, 20}, {66, 33, 36}, {17, 50, 49}};
    for (int type = 0; type < 4; type++)
        for (int shape = 0; shape < 3; shape++) {
            iso_grid grid = test_rgrid(shapes[shape], all_types[type]);
            const double isovalue = shape == 0 ? 40.5 : 40, background = shape == 1 ? 39 : 10;
            fill_with(&grid, background);
            follower *f = follow(&grid, isovalue);
            for (int step = 0; step < 60; step++) {
                for (int edits = test_random_int(&random, 1, 4); edits; edits--)
                    random_edit(&grid, background, isovalue, &random);
                check(f, 500, step % 2);
            }
            unfollow(f);
            iso_grid_destroy(&grid);
        }
}

/* Isovalues on, just below and just above the voxels' values, all on one grid. */
static void every_isovalue_of_a_grid(void **state) {
    (void)state;
    test_random random = {7};
    const int dims[3] = {68, 34, 33};
    for (int type = 0; type < 4; type++) {
        iso_grid grid = test_rgrid(dims, all_types[type]);
        for (int z = 0; z < dims[2]; z++)
            for (int y = 0; y < dims[1]; y++)
                for (int x = 0; x < dims[0]; x++)
                    test_set(&grid, x, y, z, x / 4 + y / 2 + z + test_random_int(&random, 0, 1));
        for (int k = 0; k < 90; k++) {
            const double at = k / 3 * 3, isovalue = k % 3 == 0 ? at : at + (k % 3 == 1 ? 1e-3 : -1e-3);
            follower *f = follow(&grid, isovalue);
            check(f, 500, k % 2);
            unfollow(f);
        }
        iso_grid_destroy(&grid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_voxel_in_every_row),
        cmocka_unit_test(few_voxels_and_edits),
        cmocka_unit_test(every_isovalue_of_a_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
