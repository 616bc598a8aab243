/* bench_peers_vtk: vtkFlyingEdges3D (Schroeder, Maynard and Geveci 2015) as a row of the bench. */
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include <vtkAOSDataArrayTemplate.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkXMLImageDataReader.h>

#include "base/bridge_guard.hpp"
#include "bench_peers.h"

struct bench_flying_edges {
    vtkNew<vtkImageData> image;
    vtkNew<vtkFlyingEdges3D> filter;
    const char *backend = "Sequential";
    int threads = 1;
};

namespace {

template <class T> vtkSmartPointer<vtkDataArray> borrowed(const iso_rgrid *grid) {
    auto array = vtkSmartPointer<vtkAOSDataArrayTemplate<T>>::New();
    const vtkIdType count = vtkIdType(grid->dims[0]) * grid->dims[1] * grid->dims[2];
    array->SetArray(static_cast<T *>(grid->data), count, 1 /* the data stays ours */);
    return array;
}

vtkSmartPointer<vtkDataArray> scalars_of(const iso_rgrid *grid) {
    switch (grid->type) {
    case ISO_UINT8:
        return borrowed<unsigned char>(grid);
    case ISO_INT16:
        return borrowed<short>(grid);
    case ISO_UINT16:
        return borrowed<unsigned short>(grid);
    default:
        return borrowed<float>(grid);
    }
}

void choose_backend(const bench_flying_edges &peer) {
    vtkSMPTools::SetBackend(peer.backend);
    vtkSMPTools::Initialize(peer.threads);
}

/* How many threads of the current backend are at work at the same time: each waits for the others to come. */
int threads_at_work(int wanted) {
    std::atomic<int> here{0}, most{0};
    auto wait = [&](vtkIdType, vtkIdType) {
        int now = ++here;
        for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
        }
        const auto patience = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
        while (most < wanted && std::chrono::steady_clock::now() < patience) std::this_thread::yield();
        --here;
    };
    vtkSMPTools::For(0, 4 * wanted, 1, wait);
    return most;
}

iso_status find_backend(bench_flying_edges &peer, iso_error *error) {
    if (peer.threads == 1) return ISO_OK;
    int found = 0;
    for (const char *backend : {"TBB", "STDThread", "OpenMP"}) {
        if (!vtkSMPTools::SetBackend(backend)) continue;
        peer.backend = backend;
        choose_backend(peer);
        found = threads_at_work(peer.threads);
        if (found == peer.threads) return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_BRIDGE, "VTK runs %d threads where %d were asked for", found,
                    peer.threads);
}

iso_status create(const iso_rgrid *grid, double isovalue, int threads, bench_flying_edges **out,
                  iso_error *error) {
    auto peer = std::make_unique<bench_flying_edges>();
    peer->threads = threads;
    ISO_TRY(find_backend(*peer, error));
    peer->image->SetDimensions(grid->dims[0], grid->dims[1], grid->dims[2]);
    peer->image->GetPointData()->SetScalars(scalars_of(grid));
    peer->filter->SetInputData(peer->image);
    peer->filter->SetValue(0, isovalue);
    peer->filter->ComputeNormalsOn();
    peer->filter->ComputeGradientsOff();
    peer->filter->ComputeScalarsOff();
    *out = peer.release();
    return ISO_OK;
}

} // namespace

iso_status bench_flying_edges_create(const iso_rgrid *grid, double isovalue, int threads,
                                     bench_flying_edges **peer, iso_error *error) {
    return iso::guard("VTK", error, [&] { return create(grid, isovalue, threads, peer, error); });
}

iso_status bench_flying_edges_run(bench_flying_edges *peer, iso_error *error) {
    return iso::guard("VTK", error, [&] {
        peer->filter->Modified();
        peer->filter->Update();
        return ISO_OK;
    });
}

iso_status bench_flying_edges_ready(bench_flying_edges *peer, iso_error *error) {
    return iso::guard("VTK", error, [&] {
        choose_backend(*peer);
        return ISO_OK;
    });
}

size_t bench_flying_edges_points(const bench_flying_edges *peer) {
    return static_cast<size_t>(
        const_cast<bench_flying_edges *>(peer)->filter->GetOutput()->GetNumberOfPoints());
}

void bench_flying_edges_destroy(bench_flying_edges *peer) {
    delete peer;
}

iso_status bench_vti_read(const char *path, size_t *voxels, iso_error *error) {
    return iso::guard("VTK", error, [&] {
        vtkNew<vtkXMLImageDataReader> reader;
        reader->SetFileName(path);
        reader->Update();
        *voxels = static_cast<size_t>(reader->GetOutput()->GetNumberOfPoints());
        return ISO_OK;
    });
}
