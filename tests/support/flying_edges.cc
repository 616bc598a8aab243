// flying_edges: compares a grid's mesh with that of vtkFlyingEdges3D.
#include "flying_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <vtkDataArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "extract/mesh/mesh.h"

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

} // namespace

size_t check_against_flying_edges(const iso_grid *grid, double isovalue) {
    iso_mesh_opts opts = {};
    opts.isovalue = isovalue;
    iso_mesh_set *set = nullptr;
    assert_int_equal(iso_mesh_set_create(grid, &opts, &set, nullptr), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, nullptr), ISO_OK);
    iso_mesh_view view = iso_mesh_set_view(set);
    iso_weld weld = {};
    assert_int_equal(iso_mesh_weld(&view, nullptr, &weld, nullptr), ISO_OK);
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
