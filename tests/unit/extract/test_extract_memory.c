/* Extraction that runs out of memory: what a set shows stays sound, and the next update makes up for it.
 * Calls for memory that come from extraction are refused from a chosen one on (the linker's --wrap). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "extract_support.h"
#include "refused_memory.h"

typedef struct extent {
    size_t first, count;
} extent;

static int compare_extents(const void *a, const void *b) {
    const extent *x = a, *y = b;
    return (x->first > y->first) - (x->first < y->first);
}

static void check_disjoint(extent *extents, size_t count) {
    qsort(extents, count, sizeof *extents, compare_extents);
    for (size_t i = 1; i < count; i++)
        assert_true(extents[i - 1].first + extents[i - 1].count <= extents[i].first);
    free(extents);
}

static void check_points_are_sound(const iso_point_view *view) {
    extent *extents = calloc(view->span_count + 1, sizeof *extents);
    for (size_t s = 0; s < view->span_count; s++) {
        extents[s] = (extent){view->spans[s].first, view->spans[s].count};
        assert_true(view->spans[s].count > 0);
        for (uint32_t i = 0; i < view->spans[s].count; i++) {
            iso_surfel p = iso_point_view_get(view, view->spans[s].first + i);
            assert_true(p.position[0] >= -2 && p.position[0] < 18);
        }
    }
    check_disjoint(extents, view->span_count);
}

static void check_mesh_is_sound(const iso_mesh_view *view) {
    extent *vertices = calloc(view->span_count + 1, sizeof *vertices);
    extent *triangles = calloc(view->span_count + 1, sizeof *triangles);
    size_t with_triangles = 0;
    for (size_t s = 0; s < view->span_count; s++) {
        const iso_mesh_span *span = &view->spans[s];
        vertices[s] = (extent){span->first_vertex, span->vertex_count};
        assert_true(span->vertex_count > 0 && span->owned_count <= span->vertex_count);
        for (uint32_t i = 0; i < span->vertex_count; i++) {
            int voxel[3];
            iso_edge_key_split(view->keys[span->first_vertex + i], voxel);
            const float *p = view->vertices[span->first_vertex + i].position;
            for (int axis = 0; axis < 3; axis++)
                assert_true(p[axis] >= (float)voxel[axis] && p[axis] <= (float)voxel[axis] + 1);
        }
        if (!span->triangle_count) continue;
        triangles[with_triangles++] = (extent){span->first_triangle, span->triangle_count};
        for (uint32_t i = 0; i < span->triangle_count; i++)
            for (int k = 0; k < 3; k++)
                assert_true(view->triangles[span->first_triangle + i][k] < span->vertex_count);
    }
    check_disjoint(vertices, view->span_count);
    check_disjoint(triangles, with_triangles);
}

static iso_point_set *new_points(const iso_grid *grid) {
    iso_point_set *set = NULL;
    assert_int_equal(iso_point_set_create(grid, &(iso_points_opts){0}, &set, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    return set;
}

static iso_mesh_set *new_mesh(const iso_grid *grid) {
    iso_mesh_set *set = NULL;
    assert_int_equal(iso_mesh_set_create(grid, &(iso_mesh_opts){0}, &set, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    return set;
}

static void check_points_recover(const iso_grid *grid, iso_point_set *set) {
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    iso_point_set *fresh = new_points(grid);
    iso_point_view got = iso_point_set_view(set), wanted = iso_point_set_view(fresh);
    test_same_points(&got, &wanted);
    iso_point_set_destroy(fresh);
}

static void check_mesh_recovers(const iso_grid *grid, iso_mesh_set *set) {
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    iso_mesh_set *fresh = new_mesh(grid);
    iso_mesh_view got = iso_mesh_set_view(set), wanted = iso_mesh_set_view(fresh);
    test_same_mesh(&got, &wanted);
    iso_mesh_set_destroy(fresh);
}

/* The first extraction, refused at its first call for memory, then at its second, and so on. */
static void first_extractions_fail_cleanly(void **state) {
    (void)state;
    iso_grid grid = test_ball_grid(40, iso_vec3_make(20, 20, 20), 12, 0);
    bool done = false;
    for (long allowed = 0; !done; allowed++) {
        iso_point_set *points = NULL;
        test_refuse_memory_after(allowed);
        iso_status status = iso_point_set_create(&grid, &(iso_points_opts){0}, &points, NULL);
        if (status == ISO_OK) status = iso_point_set_update(points, NULL);
        test_grant_memory();
        done = status == ISO_OK;
        assert_int_equal(status, test_refusals() ? ISO_ERR_NOMEM : ISO_OK);
        if (!points) continue;
        iso_point_view view = iso_point_set_view(points);
        if (!done) assert_int_equal(view.span_count, 0);
        check_points_recover(&grid, points);
        iso_point_set_destroy(points);
    }
    done = false;
    for (long allowed = 0; !done; allowed++) {
        iso_mesh_set *mesh = NULL;
        iso_weld weld = {0};
        test_refuse_memory_after(allowed);
        iso_status status = iso_mesh_set_create(&grid, &(iso_mesh_opts){0}, &mesh, NULL);
        if (status == ISO_OK) status = iso_mesh_set_update(mesh, NULL);
        if (status == ISO_OK) {
            iso_mesh_view view = iso_mesh_set_view(mesh);
            status = iso_mesh_weld(&view, NULL, &weld, NULL);
        }
        test_grant_memory();
        done = status == ISO_OK;
        assert_int_equal(status, test_refusals() ? ISO_ERR_NOMEM : ISO_OK);
        iso_weld_free(&weld);
        if (mesh) check_mesh_recovers(&grid, mesh);
        iso_mesh_set_destroy(mesh);
    }
    iso_grid_destroy(&grid);
}

static void updates_fail_cleanly(void **state) {
    (void)state;
    test_random random = {71};
    iso_grid grid = test_ball_grid(60, iso_vec3_make(30, 30, 30), 20, 0);
    iso_point_set *points = new_points(&grid);
    iso_mesh_set *mesh = new_mesh(&grid);
    int failed = 0;
    for (int edit = 0; edit < 300; edit++) {
        test_random_edit(&grid, &random);
        long allowed = test_random_int(&random, 0, 40); /* anywhere in the work of an update */
        test_refuse_memory_after(allowed);
        failed += iso_point_set_update(points, NULL) != ISO_OK;
        test_refuse_memory_after(2 * allowed);
        failed += iso_mesh_set_update(mesh, NULL) != ISO_OK;
        test_grant_memory();
        iso_point_view point_view = iso_point_set_view(points);
        iso_mesh_view mesh_view = iso_mesh_set_view(mesh);
        check_points_are_sound(&point_view);
        check_mesh_is_sound(&mesh_view);
        if (edit % 3) continue;
        check_points_recover(&grid, points);
        check_mesh_recovers(&grid, mesh);
    }
    print_message("%d updates of 600 were refused memory\n", failed);
    assert_true(failed > 100 && failed < 600);
    iso_point_set_destroy(points);
    iso_mesh_set_destroy(mesh);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_extractions_fail_cleanly),
        cmocka_unit_test(updates_fail_cleanly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
