/* mesh: the topology of Marching Cubes, its agreement with edge points and across bricks, and sets that
 * follow edits. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "extract_support.h"

static const iso_type all_types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

static iso_weld weld_of(const iso_grid *grid, double isovalue) {
    iso_mesh_set *set = test_mesh_set(grid, &(iso_mesh_opts){.isovalue = isovalue});
    iso_mesh_view view = iso_mesh_set_view(set);
    iso_weld weld = {0};
    iso_error error = {0};
    if (iso_mesh_weld(&view, NULL, &weld, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_int_equal(weld.vertex_count, iso_mesh_view_vertex_count(&view));
    assert_int_equal(weld.triangle_count, iso_mesh_view_triangle_count(&view));
    iso_mesh_set_destroy(set);
    return weld;
}

/* ---- topology */

typedef struct half_edge {
    uint32_t from, to;
} half_edge;

static int compare_half_edges(const void *a, const void *b) {
    return memcmp(a, b, sizeof(half_edge));
}

static half_edge *half_edges_of(const iso_weld *weld) {
    half_edge *edges = malloc((3 * weld->triangle_count + 1) * sizeof *edges);
    for (size_t i = 0; i < weld->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            edges[3 * i + (size_t)k] = (half_edge){weld->triangles[i][k], weld->triangles[i][(k + 1) % 3]};
    qsort(edges, 3 * weld->triangle_count, sizeof *edges, compare_half_edges);
    return edges;
}

static uint32_t root_of(uint32_t *parent, uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

/* Vertices whose triangles form more than one fan: the link must be a single cycle. */
static void check_fans(const iso_weld *weld) {
    /* corners of triangles around one vertex, united across shared edges, must leave one class a vertex */
    size_t corners = 3 * weld->triangle_count, classes = corners;
    uint32_t *parent = malloc((corners + 1) * sizeof *parent);
    for (size_t i = 0; i < corners; i++) parent[i] = (uint32_t)i;
    struct side {
        uint32_t low, high, corner_low, corner_high;
    } *sides = malloc((corners + 1) * sizeof *sides);
    for (size_t i = 0; i < corners; i++) {
        size_t t = i / 3, next = 3 * t + (i + 1) % 3;
        uint32_t a = weld->triangles[t][i % 3], b = weld->triangles[t][(i + 1) % 3];
        sides[i] = a < b ? (struct side){a, b, (uint32_t)i, (uint32_t)next}
                         : (struct side){b, a, (uint32_t)next, (uint32_t)i};
    }
    qsort(sides, corners, sizeof *sides, compare_half_edges);
    for (size_t i = 0; i + 1 < corners; i++) {
        if (compare_half_edges(&sides[i], &sides[i + 1]) != 0) continue;
        const uint32_t pairs[2][2] = {{sides[i].corner_low, sides[i + 1].corner_low},
                                      {sides[i].corner_high, sides[i + 1].corner_high}};
        for (int k = 0; k < 2; k++) {
            uint32_t a = root_of(parent, pairs[k][0]), b = root_of(parent, pairs[k][1]);
            if (a == b) continue;
            parent[a] = b;
            classes--;
        }
    }
    assert_int_equal(classes, weld->vertex_count);
    free(parent);
    free(sides);
}

/* Closed, oriented, manifold; every vertex used. Returns the Euler characteristic. */
static long check_closed(const iso_weld *weld) {
    size_t count = 3 * weld->triangle_count;
    half_edge *edges = half_edges_of(weld);
    for (size_t i = 0; i < count; i++) {
        assert_int_not_equal(edges[i].from, edges[i].to);
        if (i) assert_int_not_equal(compare_half_edges(&edges[i - 1], &edges[i]), 0);
        half_edge back = {edges[i].to, edges[i].from};
        if (!bsearch(&back, edges, count, sizeof back, compare_half_edges)) fail_msg("an open edge");
    }
    free(edges);
    check_fans(weld);
    return (long)weld->vertex_count - (long)(count / 2) + (long)weld->triangle_count;
}

static size_t component_count(const iso_weld *weld) {
    uint32_t *parent = malloc((weld->vertex_count + 1) * sizeof *parent);
    size_t components = weld->vertex_count;
    for (size_t i = 0; i < weld->vertex_count; i++) parent[i] = (uint32_t)i;
    for (size_t i = 0; i < weld->triangle_count; i++)
        for (int k = 0; k < 2; k++) {
            uint32_t a = root_of(parent, weld->triangles[i][k]);
            uint32_t b = root_of(parent, weld->triangles[i][k + 1]);
            if (a == b) continue;
            parent[a] = b;
            components--;
        }
    free(parent);
    return components;
}

static double signed_volume(const iso_weld *weld) {
    double volume = 0;
    for (size_t i = 0; i < weld->triangle_count; i++) {
        iso_vec3 corner[3];
        for (int k = 0; k < 3; k++) {
            const float *p = weld->vertices[weld->triangles[i][k]].position;
            corner[k] = iso_vec3_make(p[0], p[1], p[2]);
        }
        volume += iso_vec3_dot(corner[0], iso_vec3_cross(corner[1], corner[2])) / 6;
    }
    return volume;
}

/* Sets the border of the volume to 0, outside. */
static void clear_border(const iso_grid *grid) {
    const int *dims = iso_grid_dims(grid);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                if (x == 0 || y == 0 || z == 0 || x == dims[0] - 1 || y == dims[1] - 1 || z == dims[2] - 1)
                    test_set(grid, x, y, z, 0);
}

static void meshes_are_closed_oriented_manifolds(void **state) {
    (void)state;
    test_random random = {1};
    for (int round = 0; round < 90; round++) {
        int dims[3];
        test_random_dims(&random, 1, round % 6 == 5 ? 40 : 20, dims);
        iso_grid grid = test_rgrid(dims, all_types[round % 4]);
        test_fill(&grid, (test_pattern)(round / 4 % 3), &random);
        clear_border(&grid);
        grid.rgrid->level_set = round % 7 == 0;
        iso_weld weld = weld_of(&grid, 100);
        long euler = check_closed(&weld);
        assert_int_equal(euler % 2, 0);
        assert_true(euler <= 2 * (long)component_count(&weld));
        /* voxels at or above are in the body, which the surface winds around, except for level sets */
        if (weld.triangle_count) assert_true(signed_volume(&weld) * (grid.rgrid->level_set ? -1 : 1) > 0);
        iso_weld_free(&weld);
        iso_grid_destroy(&grid);
    }
}

/* All pairs of neighbouring cells: 12 corners, 4096 ways, on each axis; the border of the grid is outside. */
static void all_pairs_of_cells_fit(void **state) {
    (void)state;
    for (int axis = 0; axis < 3; axis++)
        for (int bits = 0; bits < 4096; bits++) {
            int dims[3] = {4, 4, 4};
            dims[axis] = 5;
            iso_grid grid = test_rgrid(dims, ISO_UINT8);
            for (int corner = 0; corner < 12; corner++) {
                int v[3] = {0}, rest = corner % 4;
                v[axis] = 1 + corner / 4;
                v[(axis + 1) % 3] = 1 + rest % 2;
                v[(axis + 2) % 3] = 1 + rest / 2;
                test_set(&grid, v[0], v[1], v[2], bits >> corner & 1 ? 200 : 0);
            }
            iso_weld weld = weld_of(&grid, 100);
            long euler = check_closed(&weld);
            long most = 2 * (long)component_count(&weld); /* there is room for one handle */
            assert_true(euler == most || euler == most - 2);
            iso_weld_free(&weld);
            iso_grid_destroy(&grid);
        }
}

static void random_bits_fit(void **state) {
    (void)state;
    test_random random = {3};
    for (int round = 0; round < 3000; round++) {
        iso_grid grid = test_rgrid((int[3]){5, 5, 5}, ISO_UINT8);
        uint32_t bits = test_random_next(&random);
        for (int i = 0; i < 27; i++)
            test_set(&grid, 1 + i % 3, 1 + i / 3 % 3, 1 + i / 9, bits >> i & 1 ? 200 : 0);
        iso_weld weld = weld_of(&grid, 100);
        check_closed(&weld);
        iso_weld_free(&weld);
        iso_grid_destroy(&grid);
    }
}

/* Voxels at or above the isovalue that meet only across a face's or a cell's diagonal are kept apart; voxels
 * below it are joined there. */
static void ambiguous_faces_keep_inside_corners_apart(void **state) {
    (void)state;
    const int second[][3] = {{2, 2, 1}, {1, 2, 2}, {2, 1, 2}, {2, 2, 2}};
    for (int i = 0; i < 4; i++)
        for (int inverse = 0; inverse < 2; inverse++) {
            iso_grid grid = test_rgrid((int[3]){4, 4, 4}, ISO_UINT8);
            memset(grid.rgrid->data, inverse ? 200 : 0, 64);
            test_set(&grid, 1, 1, 1, inverse ? 0 : 200);
            test_set(&grid, second[i][0], second[i][1], second[i][2], inverse ? 0 : 200);
            iso_weld weld = weld_of(&grid, 100);
            check_closed(&weld);
            assert_int_equal(component_count(&weld), inverse && i < 3 ? 1 : 2);
            iso_weld_free(&weld);
            iso_grid_destroy(&grid);
        }
}

/* ---- bricks */

/* The owner of a copy; its bits must be the copy's, 16 voxels apart where the bricks are. */
static void check_copy(const iso_mesh_view *view, const iso_mesh_span *span, uint32_t index) {
    iso_edge_key key = view->keys[span->first_vertex + index];
    const iso_surfel *copy = &view->vertices[span->first_vertex + index];
    int voxel[3], far = 0, along = iso_edge_key_split(key, voxel);
    int32_t brick[3];
    for (int axis = 0; axis < 3; axis++) {
        brick[axis] = span->brick[axis] + voxel[axis] / 16;
        far += voxel[axis] / 16;
        voxel[axis] %= 16;
    }
    assert_true(far >= 1 && far <= 2);
    iso_edge_key own_key = iso_edge_key_make(voxel[0], voxel[1], voxel[2], along);
    for (size_t s = 0; s < view->span_count; s++) {
        const iso_mesh_span *owner = &view->spans[s];
        if (memcmp(owner->brick, brick, sizeof brick) != 0) continue;
        for (uint32_t i = 0; i < owner->owned_count; i++) {
            if (view->keys[owner->first_vertex + i] != own_key) continue;
            const iso_surfel *own = &view->vertices[owner->first_vertex + i];
            assert_memory_equal(own->normal, copy->normal, sizeof own->normal);
            for (int axis = 0; axis < 3; axis++) {
                float shift = 16.0f * (float)(brick[axis] - span->brick[axis]);
                assert_true(own->position[axis] + shift == copy->position[axis]);
            }
            return;
        }
    }
    fail_msg("a copy without an owner");
}

static void check_span(const iso_mesh_view *view, const iso_mesh_span *span) {
    const iso_edge_key *keys = view->keys + span->first_vertex;
    for (uint32_t i = 0; i < span->vertex_count; i++) {
        int voxel[3];
        iso_edge_key_split(keys[i], voxel);
        const int x = voxel[0], y = voxel[1], z = voxel[2];
        bool own = x < 16 && y < 16 && z < 16;
        assert_int_equal(own, i < span->owned_count);
        if (i && i != span->owned_count) assert_true(keys[i] > keys[i - 1]);
        if (!own) check_copy(view, span, i);
        const float *p = view->vertices[span->first_vertex + i].position;
        assert_true(p[0] >= (float)x && p[1] >= (float)y && p[2] >= (float)z);
        assert_true(p[0] <= (float)x + 1 && p[1] <= (float)y + 1 && p[2] <= (float)z + 1);
    }
    for (uint32_t i = 0; i < span->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            assert_true(view->triangles[span->first_triangle + i][k] < span->vertex_count);
}

/* Own vertices are the edge points, bit for bit and in order. */
static void check_against_points(const iso_mesh_view *mesh, const iso_point_view *points) {
    size_t p = 0;
    for (size_t s = 0; s < mesh->span_count; s++) {
        const iso_mesh_span *span = &mesh->spans[s];
        check_span(mesh, span);
        if (!span->owned_count) continue;
        assert_true(p < points->span_count);
        const iso_point_span *theirs = &points->spans[p++];
        assert_memory_equal(span->brick, theirs->brick, sizeof theirs->brick);
        assert_int_equal(span->owned_count, theirs->count);
        assert_memory_equal(mesh->vertices + span->first_vertex, points->surfels + theirs->first,
                            theirs->count * sizeof(iso_surfel));
    }
    assert_int_equal(p, points->span_count);
}

static void check_mesh_and_points(const iso_grid *grid, double isovalue) {
    iso_mesh_set *mesh = test_mesh_set(grid, &(iso_mesh_opts){.isovalue = isovalue});
    iso_point_set *points = NULL;
    const iso_points_opts opts = {.isovalue = isovalue, .primitive = ISO_PRIMITIVE_EDGE, .floats = true};
    assert_int_equal(iso_point_set_create(grid, &opts, &points, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(points, NULL), ISO_OK);
    iso_mesh_view mesh_view = iso_mesh_set_view(mesh);
    iso_point_view point_view = iso_point_set_view(points);
    check_against_points(&mesh_view, &point_view);
    iso_point_set_destroy(points);
    iso_mesh_set_destroy(mesh);
}

static void vertices_are_the_edge_points(void **state) {
    (void)state;
    test_random random = {5};
    for (int round = 0; round < 100; round++) {
        int dims[3];
        test_random_dims(&random, 1, 40, dims);
        if (round % 3 == 0) dims[round / 3 % 3] = 17; /* one voxel beyond a brick */
        iso_grid grid = test_rgrid(dims, all_types[round % 4]);
        test_fill(&grid, round % 4 == 3 ? TEST_NOISE : TEST_SMOOTH, &random);
        if (round % 8 == 3)
            for (int i = 0; i < 20; i++)
                test_set(&grid, test_random_int(&random, 0, dims[0] - 1),
                         test_random_int(&random, 0, dims[1] - 1), test_random_int(&random, 0, dims[2] - 1),
                         i % 2 ? NAN : INFINITY);
        check_mesh_and_points(&grid, 100);
        iso_grid_destroy(&grid);
    }
    iso_grid sparse = test_ball_grid(50, iso_vec3_make(24, 26, 25), 18, 0);
    check_mesh_and_points(&sparse, 0);
    check_mesh_and_points(&sparse, 0.7);
    iso_grid_destroy(&sparse);
}

/* Without NaN, an open edge lies in a face of the volume: every cell is there once. */
static void open_edges_lie_in_the_border(void **state) {
    (void)state;
    test_random random = {7};
    for (int round = 0; round < 40; round++) {
        int dims[3];
        test_random_dims(&random, 2, 36, dims);
        iso_grid grid = test_rgrid(dims, all_types[round % 4]);
        test_fill(&grid, round % 2 ? TEST_NOISE : TEST_SMOOTH, &random);
        iso_weld weld = weld_of(&grid, 100);
        size_t count = 3 * weld.triangle_count;
        half_edge *edges = half_edges_of(&weld);
        for (size_t i = 0; i < count; i++) {
            if (i) assert_int_not_equal(compare_half_edges(&edges[i - 1], &edges[i]), 0);
            half_edge back = {edges[i].to, edges[i].from};
            if (bsearch(&back, edges, count, sizeof back, compare_half_edges)) continue;
            const float *a = weld.vertices[edges[i].from].position, *b = weld.vertices[edges[i].to].position;
            bool border = false;
            for (int axis = 0; axis < 3; axis++)
                border =
                    border || (a[axis] == b[axis] && (a[axis] == 0 || a[axis] == (float)(dims[axis] - 1)));
            assert_true(border);
        }
        free(edges);
        iso_weld_free(&weld);
        iso_grid_destroy(&grid);
    }
}

static int compare_floats3(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(float));
}

static void welding_leaves_no_duplicates(void **state) {
    (void)state;
    test_random random = {9};
    iso_grid grid = test_rgrid((int[3]){40, 37, 50}, ISO_FLOAT32);
    test_fill(&grid, TEST_SMOOTH, &random);
    iso_weld weld = weld_of(&grid, 100);
    float(*positions)[3] = malloc(weld.vertex_count * sizeof *positions);
    for (size_t i = 0; i < weld.vertex_count; i++)
        memcpy(positions[i], weld.vertices[i].position, sizeof *positions);
    qsort(positions, weld.vertex_count, sizeof *positions, compare_floats3);
    for (size_t i = 1; i < weld.vertex_count; i++)
        assert_int_not_equal(compare_floats3(positions[i - 1], positions[i]), 0);
    assert_true(weld.vertex_count > 1000);
    free(positions);
    iso_weld_free(&weld);
    iso_grid_destroy(&grid);
}

/* A voxel that is not finite takes exactly the triangles of its cells away. */
static void nonfinite_voxels_take_their_cells(void **state) {
    (void)state;
    test_random random = {13};
    const float odd[] = {NAN, INFINITY, -INFINITY};
    for (int round = 0; round < 60; round++) {
        int dims[3];
        test_random_dims(&random, 2, 20, dims);
        iso_grid grid = test_rgrid(dims, ISO_FLOAT32);
        test_fill(&grid, TEST_NOISE, &random);
        int v[3];
        for (int axis = 0; axis < 3; axis++) v[axis] = test_random_int(&random, 0, dims[axis] - 1);
        iso_weld before = weld_of(&grid, 100);
        test_set(&grid, v[0], v[1], v[2], odd[round % 3]);
        assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, v, v, NULL), ISO_OK);
        iso_weld after = weld_of(&grid, 100);
        size_t expected = 0;
        for (size_t i = 0; i < before.triangle_count; i++) {
            bool near_voxel = true;
            for (int axis = 0; axis < 3; axis++) { /* the cell of a triangle holds its centre */
                double centre = 0;
                for (int k = 0; k < 3; k++)
                    centre += before.vertices[before.triangles[i][k]].position[axis] / 3;
                near_voxel = near_voxel && fabs(centre - v[axis]) < 1;
            }
            expected += !near_voxel;
        }
        assert_int_equal(after.triangle_count, expected);
        for (size_t i = 0; i < after.vertex_count; i++)
            for (int k = 0; k < 3; k++) {
                assert_true(isfinite(after.vertices[i].position[k]));
                assert_true(isfinite(after.vertices[i].normal[k]));
            }
        iso_weld_free(&before);
        iso_weld_free(&after);
        iso_grid_destroy(&grid);
    }
}

static void spheres_have_the_right_area(void **state) {
    (void)state;
    for (int dense = 0; dense < 2; dense++) {
        double last = 0;
        for (int size = 24; size <= 96; size *= 2) {
            double radius = 0.35 * size, area = 0;
            iso_vec3 centre = {size / 2 - 0.37, size / 2 + 0.21, size / 2 - 0.11};
            iso_grid grid = test_ball_grid(size, centre, radius, dense);
            iso_weld weld = weld_of(&grid, 0);
            assert_int_equal(check_closed(&weld), 2);
            for (size_t i = 0; i < weld.triangle_count; i++) {
                iso_vec3 corner[3], normal = {0};
                for (int k = 0; k < 3; k++) {
                    const iso_surfel *p = &weld.vertices[weld.triangles[i][k]];
                    corner[k] = iso_vec3_make(p->position[0], p->position[1], p->position[2]);
                    normal = iso_vec3_add(normal, iso_vec3_make(p->normal[0], p->normal[1], p->normal[2]));
                }
                iso_vec3 cross =
                    iso_vec3_cross(iso_vec3_sub(corner[1], corner[0]), iso_vec3_sub(corner[2], corner[0]));
                area += iso_vec3_length(cross) / 2;
                if (iso_vec3_length(cross) > 1e-3) assert_true(iso_vec3_dot(cross, normal) > 0);
            }
            double error = fabs(area / (4 * ISO_PI * radius * radius) - 1);
            print_message("%s %d: relative error of the area %.2e\n", dense ? "rgrid" : "hgrid", size, error);
            if (last > 0) assert_true(log2(last / error) > 1.8);
            last = error;
            double volume = signed_volume(&weld), wanted = 4 * ISO_PI * pow(radius, 3) / 3;
            assert_true(fabs(volume / wanted - 1) < 3 * error);
            iso_weld_free(&weld);
            iso_grid_destroy(&grid);
        }
        assert_true(last < 5e-4);
    }
}

/* ---- sets */

static void same_bytes_for_any_thread_count(void **state) {
    (void)state;
    test_random random = {17};
    iso_grid grid = test_rgrid((int[3]){60, 50, 70}, ISO_INT16);
    test_fill(&grid, TEST_SMOOTH, &random);
    iso_mesh_opts opts = {.isovalue = 100};
    iso_mesh_set *one = test_mesh_set(&grid, &opts);
    iso_mesh_view a = iso_mesh_set_view(one);
    const int threads[] = {2, 7};
    for (int t = 0; t < 2; t++) {
        assert_int_equal(iso_pool_create(threads[t], &opts.pool, NULL), ISO_OK);
        iso_mesh_set *many = test_mesh_set(&grid, &opts);
        iso_mesh_view b = iso_mesh_set_view(many);
        assert_int_equal(a.span_count, b.span_count);
        assert_memory_equal(a.spans, b.spans, a.span_count * sizeof *a.spans);
        test_same_mesh(&a, &b);
        iso_mesh_set_destroy(many);
        iso_pool_destroy(opts.pool);
    }
    iso_mesh_set_destroy(one);
    iso_grid_destroy(&grid);
}

static void follow(const iso_grid *grid, iso_mesh_set *followed, double isovalue) {
    assert_int_equal(iso_mesh_set_update(followed, NULL), ISO_OK);
    iso_mesh_set *fresh = test_mesh_set(grid, &(iso_mesh_opts){.isovalue = isovalue});
    iso_mesh_view a = iso_mesh_set_view(followed), b = iso_mesh_set_view(fresh);
    test_same_mesh(&a, &b);
    iso_mesh_set_destroy(fresh);
}

static void following_edits_equals_extracting_everything(void **state) {
    (void)state;
    test_random random = {19};
    for (int type = 0; type < 4; type++) {
        iso_grid grid = test_rgrid((int[3]){36, 35, 34}, all_types[type]);
        test_fill(&grid, TEST_SMOOTH, &random);
        iso_mesh_set *followed = test_mesh_set(&grid, &(iso_mesh_opts){.isovalue = 100});
        for (int edit = 0; edit < 80; edit++) {
            int lo[3], hi[3], side = edit % 2 ? 0 : test_random_int(&random, 0, 7);
            for (int axis = 0; axis < 3; axis++) { /* around the corners of bricks, where halos matter */
                int v = 16 * test_random_int(&random, 0, 2) + test_random_int(&random, -4, 3);
                lo[axis] = v < 0 ? 0 : v > 33 ? 33 : v;
                hi[axis] = lo[axis] + side > 33 ? 33 : lo[axis] + side;
            }
            int flat = test_random_int(&random, 0, 2);
            for (int z = lo[2]; z <= hi[2]; z++)
                for (int y = lo[1]; y <= hi[1]; y++)
                    for (int x = lo[0]; x <= hi[0]; x++)
                        test_set(&grid, x, y, z, flat ? 50 * flat : test_random_real(&random, 50, 150));
            assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, lo, hi, NULL), ISO_OK);
            follow(&grid, followed, 100);
        }
        iso_mesh_set_isovalue(followed, 120);
        follow(&grid, followed, 120);
        iso_mesh_set_destroy(followed);
        iso_grid_destroy(&grid);
    }
}

static void following_strokes_equals_extracting_everything(void **state) {
    (void)state;
    test_random random = {23};
    for (int dense = 0; dense < 2; dense++) {
        iso_grid grid = test_ball_grid(60, iso_vec3_make(30, 30, 30), 20, dense);
        iso_mesh_set *followed = test_mesh_set(&grid, &(iso_mesh_opts){0});
        for (int edit = 0; edit < 120; edit++) {
            test_ball ball = {.radius = test_random_real(&random, 1, 8), .carve = edit % 2};
            ball.centre = iso_vec3_make(test_random_real(&random, 0, 60), test_random_real(&random, 0, 60),
                                        test_random_real(&random, 0, 60));
            if (edit % 40 == 39) ball = (test_ball){iso_vec3_make(30, 30, 30), 60, 1}; /* all away */
            test_stamp_ball(&grid, &ball);
            follow(&grid, followed, 0);
        }
        iso_mesh_set_destroy(followed);
        iso_grid_destroy(&grid);
    }
}

/* A weld of a mesh whose bricks do not fit together is refused, not made up. */
static void welding_names_a_missing_brick(void **state) {
    (void)state;
    iso_grid grid = test_ball_grid(40, iso_vec3_make(20, 20, 20), 12, 1);
    iso_mesh_set *set = test_mesh_set(&grid, &(iso_mesh_opts){0});
    iso_mesh_view view = iso_mesh_set_view(set);
    view.span_count--;
    iso_weld weld = {0};
    iso_error error = {0};
    assert_int_equal(iso_mesh_weld(&view, NULL, &weld, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "brick 1 1 1"));
    assert_null(weld.vertices);
    iso_mesh_set_destroy(set);
    assert_int_equal(iso_mesh_set_create(&grid, &(iso_mesh_opts){.isovalue = NAN}, &set, &error),
                     ISO_ERR_USAGE);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_closed_oriented_manifolds),
        cmocka_unit_test(all_pairs_of_cells_fit),
        cmocka_unit_test(random_bits_fit),
        cmocka_unit_test(ambiguous_faces_keep_inside_corners_apart),
        cmocka_unit_test(vertices_are_the_edge_points),
        cmocka_unit_test(open_edges_lie_in_the_border),
        cmocka_unit_test(welding_leaves_no_duplicates),
        cmocka_unit_test(nonfinite_voxels_take_their_cells),
        cmocka_unit_test(spheres_have_the_right_area),
        cmocka_unit_test(same_bytes_for_any_thread_count),
        cmocka_unit_test(following_edits_equals_extracting_everything),
        cmocka_unit_test(following_strokes_equals_extracting_everything),
        cmocka_unit_test(welding_names_a_missing_brick),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
