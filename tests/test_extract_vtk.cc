// Edge points and Marching Cubes against VTK, in this process: the case table against VTK's, points,
// triangles and normals against vtkFlyingEdges3D's.
#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkMarchingCubesTriangleCases.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "extract/mesh.h"
#include "extract_support.h"

// Last: it defines a macro fail(), which the streams of C++ do not survive.
extern "C" {
#include <cmocka.h>
}

namespace {

int vtk_type(iso_type type) {
    switch (type) {
    case ISO_UINT8:
        return VTK_UNSIGNED_CHAR;
    case ISO_INT16:
        return VTK_SHORT;
    case ISO_UINT16:
        return VTK_UNSIGNED_SHORT;
    default:
        return VTK_FLOAT;
    }
}

// What Flying Edges makes of stored values on a grid of unit spacing.
void flying_edges(const iso_grid *grid, double stored_isovalue, vtkFlyingEdges3D *filter) {
    const int *dims = iso_grid_dims(grid);
    vtkNew<vtkImageData> image;
    image->SetDimensions(dims[0], dims[1], dims[2]);
    image->AllocateScalars(vtk_type(grid->rgrid ? grid->rgrid->type : ISO_FLOAT32), 1);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                image->SetScalarComponentFromDouble(x, y, z, 0, iso_grid_at(grid, x, y, z));
    filter->SetInputData(image);
    filter->SetValue(0, stored_isovalue);
    filter->ComputeNormalsOn();
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
    filter->Update();
}

struct vertex {
    std::array<double, 3> position, normal;
};

std::vector<vertex> our_vertices(const iso_weld &weld) {
    std::vector<vertex> vertices;
    for (size_t i = 0; i < weld.vertex_count; i++) {
        const float *p = weld.vertices[i].position, *n = weld.vertices[i].normal;
        vertices.push_back({{p[0], p[1], p[2]}, {n[0], n[1], n[2]}});
    }
    return vertices;
}

std::vector<vertex> their_vertices(vtkPolyData *surface) {
    std::vector<vertex> vertices;
    vtkDataArray *normals = surface->GetPointData()->GetNormals();
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); i++) {
        vertex v;
        surface->GetPoint(i, v.position.data());
        normals->GetTuple(i, v.normal.data());
        vertices.push_back(v);
    }
    return vertices;
}

double distance(const std::array<double, 3> &a, const std::array<double, 3> &b) {
    return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

double squared_length(const std::array<double, 3> &a) {
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

// The same normal. Where the gradient vanishes VTK has none, or noise.
bool same_normal(const vertex &ours_or_theirs, const vertex &other) {
    if (squared_length(ours_or_theirs.normal) < 0.5 || squared_length(other.normal) < 0.5) return true;
    return distance(ours_or_theirs.normal, other.normal) < 2e-3;
}

// Every one of `some` has one of `all` within 1e-4 voxel, with the same normal when asked.
void check_subset(const std::vector<vertex> &some, const std::vector<vertex> &all, bool check_normals) {
    const double tolerance = 1e-4;
    auto by_z = [](const vertex &a, const vertex &b) { return a.position[2] < b.position[2]; };
    std::vector<vertex> sorted = all; // candidates are those with z within the tolerance
    std::sort(sorted.begin(), sorted.end(), by_z);
    for (const vertex &v : some) {
        vertex low = v;
        low.position[2] -= tolerance;
        bool found = false, aligned = false;
        auto candidate = std::lower_bound(sorted.begin(), sorted.end(), low, by_z);
        for (; candidate != sorted.end() && candidate->position[2] <= v.position[2] + tolerance;
             ++candidate) {
            if (distance(candidate->position, v.position) > tolerance) continue;
            found = true;
            aligned = aligned || same_normal(*candidate, v);
            if (aligned || !check_normals) break;
        }
        if (!found) fail_msg("no point at %.6f %.6f %.6f", v.position[0], v.position[1], v.position[2]);
        if (check_normals && !aligned)
            fail_msg("another normal at %.6f %.6f %.6f", v.position[0], v.position[1], v.position[2]);
    }
}

// The test that any grid can be put to. Returns the number of triangles.
size_t check_against_flying_edges(const iso_grid *grid, double isovalue) {
    iso_mesh_opts opts = {};
    opts.isovalue = isovalue;
    iso_mesh_set *set = nullptr;
    assert_int_equal(iso_mesh_set_create(grid, &opts, &set, nullptr), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, nullptr), ISO_OK);
    iso_mesh_view view = iso_mesh_set_view(set);
    iso_weld weld = {};
    assert_int_equal(iso_mesh_weld(&view, &weld, nullptr), ISO_OK);
    iso_mesh_set_destroy(set);

    vtkNew<vtkFlyingEdges3D> filter;
    flying_edges(grid, iso_grid_stored(grid, isovalue), filter);
    vtkPolyData *theirs = filter->GetOutput();
    size_t triangles = weld.triangle_count;
    assert_int_equal(triangles, theirs->GetNumberOfPolys());
    assert_int_equal(weld.vertex_count, theirs->GetNumberOfPoints());
    if (triangles) {
        std::vector<vertex> a = our_vertices(weld), b = their_vertices(theirs);
        bool normals = !iso_grid_is_level_set(grid);
        check_subset(a, b, normals);
        check_subset(b, a, normals);
    }
    iso_weld_free(&weld);
    return triangles;
}

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
