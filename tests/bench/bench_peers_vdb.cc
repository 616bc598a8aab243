/* bench_peers_vdb: openvdb::tools::volumeToMesh as a row of the bench. */
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Clip.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

#include "base/bridge_guard.hpp"
#include "bench_peers.h"

struct bench_volume_to_mesh {
    openvdb::FloatGrid::Ptr grid;
    int threads = 1;
    size_t points = 0;
};

namespace {

using leaf_type = openvdb::FloatTree::LeafNodeType;
constexpr int LEAF = 8;

/* One of the eight leaves of a brick; leaves have z fastest. */
void fill_leaf(const float *brick, const int low[3], float band, leaf_type &leaf) {
    for (int x = 0; x < LEAF; x++)
        for (int y = 0; y < LEAF; y++)
            for (int z = 0; z < LEAF; z++) {
                float value = brick[((low[2] + z) * ISO_BRICK + low[1] + y) * ISO_BRICK + low[0] + x];
                openvdb::Index offset = leaf_type::coordToOffset(openvdb::Coord(x, y, z));
                leaf.setValueOnly(offset, value);
                leaf.setActiveState(offset, std::fabs(value) < band);
            }
}

void add_brick(const float *brick, const int cell[3], float band, openvdb::FloatTree &tree) {
    for (int i = 0; i < 8; i++) {
        const int low[3] = {i & 1 ? LEAF : 0, i & 2 ? LEAF : 0, i & 4 ? LEAF : 0};
        const openvdb::Coord origin(cell[0] * ISO_BRICK + low[0], cell[1] * ISO_BRICK + low[1],
                                    cell[2] * ISO_BRICK + low[2]);
        auto leaf = std::make_unique<leaf_type>(origin, band, false);
        fill_leaf(brick, low, band, *leaf);
        if (leaf->onVoxelCount() > 0) tree.addLeaf(leaf.release());
    }
}

openvdb::FloatGrid::Ptr level_set_of(const iso_hgrid *grid) {
    auto result = openvdb::FloatGrid::create(grid->band);
    result->setGridClass(openvdb::GRID_LEVEL_SET);
    for (int z = 0; z < grid->cells[2]; z++)
        for (int y = 0; y < grid->cells[1]; y++)
            for (int x = 0; x < grid->cells[0]; x++) {
                int32_t brick = grid->cell[iso_hgrid_cell_index(grid, x, y, z)];
                const int cell[3] = {x, y, z};
                if (brick >= 0) add_brick(iso_hgrid_brick(grid, brick), cell, grid->band, result->tree());
            }
    openvdb::tools::signedFloodFill(result->tree());
    return result;
}

iso_status run(bench_volume_to_mesh &peer) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(peer.threads));
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*peer.grid, points, quads, 0.0);
    peer.points = points.size();
    return ISO_OK;
}

} // namespace

iso_status bench_volume_to_mesh_create(const iso_hgrid *grid, int threads, bench_volume_to_mesh **out,
                                       iso_error *error) {
    return iso::guard("OpenVDB", error, [&] {
        openvdb::initialize();
        auto peer = std::make_unique<bench_volume_to_mesh>();
        peer->grid = level_set_of(grid);
        peer->threads = threads;
        *out = peer.release();
        return ISO_OK;
    });
}

iso_status bench_volume_to_mesh_run(bench_volume_to_mesh *peer, iso_error *error) {
    return iso::guard("OpenVDB", error, [&] { return run(*peer); });
}

size_t bench_volume_to_mesh_points(const bench_volume_to_mesh *peer) {
    return peer->points;
}

void bench_volume_to_mesh_destroy(bench_volume_to_mesh *peer) {
    delete peer;
}

/* csgUnion empties its second operand and changes its first: the sphere is made, and the grid copied, before
 * the clock starts. */
iso_status bench_vdb_sculpt_run(bench_volume_to_mesh *peer, const double centre[3], double radius,
                                bool clipped, double *seconds, iso_error *error) {
    return iso::guard("OpenVDB", error, [&] {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(peer->threads));
        const openvdb::Vec3f at(static_cast<float>(centre[0]), static_cast<float>(centre[1]),
                                static_cast<float>(centre[2]));
        auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(static_cast<float>(radius), at,
                                                                               1.0f, 3.0f);
        auto copy = peer->grid->deepCopy();
        std::vector<openvdb::Vec3s> points;
        std::vector<openvdb::Vec4I> quads;
        const auto start = std::chrono::steady_clock::now();
        openvdb::tools::csgUnion(*copy, *sphere);
        if (clipped) {
            const openvdb::Vec3d reach(radius + 4);
            const openvdb::BBoxd box(openvdb::Vec3d(at) - reach, openvdb::Vec3d(at) + reach);
            openvdb::tools::volumeToMesh(*openvdb::tools::clip(*copy, box), points, quads, 0.0);
        } else
            openvdb::tools::volumeToMesh(*copy, points, quads, 0.0);
        *seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        peer->points = points.size();
        return ISO_OK;
    });
}
