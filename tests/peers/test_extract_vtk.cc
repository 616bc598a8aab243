// Edge points and Marching Cubes against VTK, in this process: the case table against VTK's, points,
// triangles and normals against vtkFlyingEdges3D's.
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>

#include <vtkMarchingCubesTriangleCases.h>

#include "extract_support.h"
#include "flying_edges.hpp"

// Last: it defines a macro fail(), which the streams of C++ do not survive.
extern "C" {
#include <cmocka.h>
}

namespace {

// VTK counts corners around the faces: 0 1 3 2 4 5 7 6 in our order.
void case_table_has_as_many_triangles_as_vtks(void **) {
    const int corner[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    const int dims[3] = {2, 2, 2};
    for (int bits = 0; bits < 256; bits++) {
        int vtk_case = 0;
        iso_grid grid = test_rgrid(dims, ISO_UINT8);
        for (int i = 0; i < 8; i++) {
            int c = corner[i], inside = bits >> c & 1;
            vtk_case |= inside << i;
            test_set(&grid, c & 1, c >> 1 & 1, c >> 2, inside ? 200 : 0);
        }
        size_t wanted = 0;
        const int *edges = vtkMarchingCubesTriangleCases::GetCases()[vtk_case].edges;
        while (edges[3 * wanted] >= 0) wanted++;
        size_t got = check_against_flying_edges(&grid, 100);
        assert_int_equal(got, wanted);
        iso_grid_destroy(&grid);
    }
}

void random_volumes_match_flying_edges(void **) {
    const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
    test_random random = {1};
    size_t triangles = 0;
    for (int round = 0; round < 120; round++) {
        int dims[3];
        test_random_dims(&random, 2, round % 10 == 9 ? 50 : 24, dims);
        if (round % 5 == 0) dims[round / 5 % 3] = 2;
        iso_grid grid = test_rgrid(dims, types[round % 4]);
        test_fill(&grid, static_cast<test_pattern>(round / 4 % 3), &random);
        double isovalue = round % 3 ? 100 : test_random_real(&random, 60, 140);
        if (round % 7 == 0) {
            grid.rgrid->scale = 0.5;
            grid.rgrid->offset = -1000;
            isovalue = isovalue * 0.5 - 1000;
        }
        triangles += check_against_flying_edges(&grid, isovalue);
        iso_grid_destroy(&grid);
    }
    assert_true(triangles > 100000);
}

// Values far from zero with small differences: floats have little left of them.
void faint_contrast_matches_flying_edges(void **) {
    test_random random = {2};
    for (int round = 0; round < 20; round++) {
        const int dims[3] = {12, 13, 14};
        iso_grid grid = test_rgrid(dims, ISO_FLOAT32);
        float *v = static_cast<float *>(grid.rgrid->data);
        for (int i = 0; i < 12 * 13 * 14; i++)
            v[i] = static_cast<float>(test_random_real(&random, 300, 300.01));
        check_against_flying_edges(&grid, 300.0051 + 1e-7 * round);
        iso_grid_destroy(&grid);
    }
}

void level_sets_match_flying_edges(void **) {
    for (int dense = 0; dense < 2; dense++) {
        iso_grid grid = test_ball_grid(45, iso_vec3_make(20.3, 22.1, 24.7), 15.5, dense);
        check_against_flying_edges(&grid, 0);
        check_against_flying_edges(&grid, -0.4);
        iso_grid_destroy(&grid);
    }
}

} // namespace

int main() {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(case_table_has_as_many_triangles_as_vtks),
        cmocka_unit_test(random_volumes_match_flying_edges),
        cmocka_unit_test(faint_contrast_matches_flying_edges),
        cmocka_unit_test(level_sets_match_flying_edges),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
