// streamlines_vtk: our streamlines against those of VTK's vtkStreamTracer through the same voxels: both
// follow the trilinear field, so that the curves must agree to the error of the steps.
#include <algorithm>
#include <cmath>
#include <vector>

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStreamTracer.h>

extern "C" {
#include "base/memory.h"
#include "check_support.h"
#include "extract/vectors/streamlines.h"
}

namespace {

constexpr int N[3] = {40, 32, 24};
constexpr double SPACING[3] = {1, 1.25, 0.8}, ORIGIN[3] = {-17, 3, 40};

// A field of smooth random waves without resting points.
void field(const double p[3], float v[3]) {
    v[0] = static_cast<float>(1.5 + std::sin(0.21 * p[1] + 0.1 * p[2]));
    v[1] = static_cast<float>(1.2 * std::sin(0.17 * p[0] + 0.3 * p[2]));
    v[2] = static_cast<float>(0.8 * std::cos(0.23 * p[0] - 0.19 * p[1]));
}

template <class Put> void for_voxels(Put put) {
    for (int z = 0; z < N[2]; z++)
        for (int y = 0; y < N[1]; y++)
            for (int x = 0; x < N[0]; x++) {
                const double p[3] = {ORIGIN[0] + SPACING[0] * x, ORIGIN[1] + SPACING[1] * y,
                                     ORIGIN[2] + SPACING[2] * z};
                float v[3];
                field(p, v);
                put(v);
            }
}

iso_vectors make_ours() {
    iso_vectors v = {};
    v.transform = iso_transform_identity();
    v.components = ISO_VECTOR_COMPONENTS;
    for (int axis = 0; axis < 3; axis++) {
        v.dims[axis] = N[axis];
        v.transform.spacing[axis] = SPACING[axis];
        v.transform.origin[axis] = ORIGIN[axis];
    }
    v.values = static_cast<float *>(iso_alloc(3 * iso_vectors_count(&v) * sizeof(float)));
    float *to = v.values;
    for_voxels([&](const float *from) { to = std::copy_n(from, 3, to); });
    return v;
}

void make_theirs(vtkImageData *image) {
    vtkNew<vtkFloatArray> array;
    array->SetName("v");
    array->SetNumberOfComponents(3);
    for_voxels([&](const float *v) { array->InsertNextTuple(v); });
    image->SetDimensions(N);
    image->SetSpacing(SPACING);
    image->SetOrigin(ORIGIN);
    image->GetPointData()->SetVectors(array);
}

double distance_to_segment(const double p[3], const double a[3], const double b[3]) {
    double ab = 0, ap = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        ab += (b[k] - a[k]) * (b[k] - a[k]);
        ap += (b[k] - a[k]) * (p[k] - a[k]);
    }
    const double t = ab > 0 ? std::min(1.0, std::max(0.0, ap / ab)) : 0;
    for (int k = 0; k < 3; k++) {
        const double d = p[k] - a[k] - t * (b[k] - a[k]);
        square += d * d;
    }
    return std::sqrt(square);
}

// The greatest distance of vertices first .. end - 1 of our line from VTK's line from the first of them.
double compare_line(vtkImageData *image, const iso_lines &lines, size_t first, size_t end) {
    vtkNew<vtkPoints> seeds;
    vtkNew<vtkPolyData> source;
    seeds->SetDataTypeToDouble();
    const float *start = lines.vertices[first];
    seeds->InsertNextPoint(static_cast<double>(start[0]), static_cast<double>(start[1]),
                           static_cast<double>(start[2]));
    source->SetPoints(seeds);
    vtkNew<vtkStreamTracer> tracer;
    tracer->SetInputData(image);
    tracer->SetSourceData(source);
    tracer->SetIntegratorTypeToRungeKutta4();
    tracer->SetIntegrationStepUnit(vtkStreamTracer::LENGTH_UNIT);
    tracer->SetInitialIntegrationStep(0.05);
    tracer->SetMaximumPropagation(1000);
    tracer->SetMaximumNumberOfSteps(100000);
    tracer->SetIntegrationDirectionToForward();
    tracer->Update();
    vtkPolyData *theirs = tracer->GetOutput();
    const vtkIdType count = theirs->GetNumberOfPoints();
    assert_true(count > 10);
    double worst = 0;
    for (size_t i = first; i < end; i++) {
        const double p[3] = {static_cast<double>(lines.vertices[i][0]),
                             static_cast<double>(lines.vertices[i][1]),
                             static_cast<double>(lines.vertices[i][2])};
        double nearest = INFINITY;
        for (vtkIdType k = 0; k + 1 < count; k++) {
            double a[3], b[3];
            theirs->GetPoint(k, a);
            theirs->GetPoint(k + 1, b);
            nearest = std::min(nearest, distance_to_segment(p, a, b));
        }
        worst = std::max(worst, nearest);
    }
    return worst;
}

void test_against_vtk(void **) {
    iso_vectors v = make_ours();
    vtkNew<vtkImageData> image;
    make_theirs(image);
    iso_streamlines_opts opts = {};
    opts.count = 60;
    iso_lines lines = {};
    iso_streamlines_totals totals;
    iso_error error = {};
    test_ok(iso_streamlines(&v, &opts, &lines, &totals, &error), &error);
    assert_int_equal(lines.line_count, 60);
    double worst = 0;
    for (size_t line = 0; line < lines.line_count; line++) {
        assert_true(lines.starts[line + 1] - lines.starts[line] > 10);
        // VTK stops up to a step of its own before the border
        worst = std::max(worst, compare_line(image, lines, lines.starts[line], lines.starts[line + 1] - 1));
    }
    print_message("greatest distance %.2g mm\n", worst);
    assert_true(worst < 1e-3);
    iso_lines_free(&lines);
    iso_vectors_free(&v);
}

} // namespace

int main() {
    const CMUnitTest tests[] = {cmocka_unit_test(test_against_vtk)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
