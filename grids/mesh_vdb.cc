/* mesh_vdb: what a mesh encloses as an hgrid, by OpenVDB. */
#include "grids/level_set_vdb.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/util/NullInterrupter.h>

#include "grids/bridge_guard.hpp"

namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using tree_type = FloatGrid::TreeType;

/* Where the grid lies: its transform, and OpenVDB's voxel (0, 0, 0) is its voxel (0, 0, 0) as well. */
struct frame_box {
    int dims[3];
    iso_transform transform;
};

iso_status frame_of(const char *path, const iso_triangles &mesh, const iso_mesh_frame &frame, frame_box *box,
                    iso_error *error) {
    box->transform = iso_transform_identity();
    if (mesh.triangle_count == 0) return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no triangles", path);
    for (int axis = 0; axis < 3; axis++) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (size_t i = 0; i < mesh.triangle_count; i++)
            for (int k = 0; k < 3; k++) {
                const double p = static_cast<double>(mesh.vertices[mesh.triangles[i][k]][axis]);
                low = std::min(low, p);
                high = std::max(high, p);
            }
        const double voxels = std::ceil((high - low) / frame.voxel) + 1 + 2.0 * frame.margin;
        const double whole = std::ceil(voxels / ISO_BRICK) * ISO_BRICK;
        if (!(whole <= ISO_HGRID_MAX))
            return iso_fail(error, ISO_ERR_LIMIT, "%s: %g voxels of %g mm along %c, at most %d", path, whole,
                            frame.voxel, "xyz"[axis], ISO_HGRID_MAX);
        box->dims[axis] = static_cast<int>(whole);
        box->transform.spacing[axis] = frame.voxel;
        box->transform.origin[axis] = (low + high - (whole - 1) * frame.voxel) / 2;
    }
    return ISO_OK;
}

/* OpenVDB asks from all its threads. */
class interrupter : public openvdb::util::NullInterrupter {
  public:
    explicit interrupter(const iso_progress &progress) : progress_(progress) {}
    bool wasInterrupted(int percent = -1) override {
        if (percent < 0) return iso_progress_cancelled(&progress_);
        return iso_progress_tell(&progress_, "", percent / 100.0, nullptr) != ISO_OK;
    }

  private:
    iso_progress progress_;
};

/* When it is interrupted, whatever was made until then. */
FloatGrid::Ptr level_set_of(const iso_triangles &mesh, const frame_box &box, const iso_progress &progress) {
    std::vector<openvdb::Vec3s> points(mesh.vertex_count);
    std::vector<openvdb::Vec3I> triangles(mesh.triangle_count);
    for (size_t i = 0; i < points.size(); i++)
        points[i] = openvdb::Vec3s(mesh.vertices[i][0], mesh.vertices[i][1], mesh.vertices[i][2]);
    for (size_t i = 0; i < triangles.size(); i++)
        triangles[i] = openvdb::Vec3I(mesh.triangles[i][0], mesh.triangles[i][1], mesh.triangles[i][2]);
    const auto transform = openvdb::math::Transform::createLinearTransform(box.transform.spacing[0]);
    transform->postTranslate(
        openvdb::Vec3d(box.transform.origin[0], box.transform.origin[1], box.transform.origin[2]));
    interrupter asked(progress);
    return openvdb::tools::meshToLevelSet<FloatGrid>(asked, *transform, points, triangles, 3.0f);
}

bool has_leaf(const openvdb::tree::ValueAccessor<const tree_type> &values, const Coord &first) {
    for (int k = 0; k < 8; k++)
        if (values.probeConstLeaf(first.offsetBy(8 * (k & 1), 8 * (k >> 1 & 1), 8 * (k >> 2)))) return true;
    return false;
}

iso_status fill_cell(const openvdb::tree::ValueAccessor<const tree_type> &values, const int at[3],
                     iso_hgrid *grid, iso_error *error) {
    const Coord first(at[0] * ISO_BRICK, at[1] * ISO_BRICK, at[2] * ISO_BRICK);
    if (!has_leaf(values, first)) {
        const int32_t state = values.getValue(first) < 0 ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE;
        iso_hgrid_coalesce(grid, at[0], at[1], at[2], state);
        return ISO_OK;
    }
    float *brick;
    ISO_TRY(iso_hgrid_split(grid, at[0], at[1], at[2], &brick, error));
    const float voxel = static_cast<float>(grid->transform.spacing[0]);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const Coord p = first.offsetBy(i % ISO_BRICK, i / ISO_BRICK % ISO_BRICK, i / (ISO_BRICK * ISO_BRICK));
        const float d = values.getValue(p) / voxel;
        brick[i] = std::min(std::max(d, -grid->band), grid->band);
    }
    return ISO_OK;
}

iso_status fill(const char *path, const FloatGrid &source, const iso_progress &progress, iso_hgrid *grid,
                iso_error *error) {
    const openvdb::tree::ValueAccessor<const tree_type> values(source.constTree());
    bool inside = false;
    int at[3];
    for (at[2] = 0; at[2] < grid->cells[2]; at[2]++) {
        ISO_TRY(iso_progress_tell(&progress, path, static_cast<double>(at[2]) / grid->cells[2], error));
        for (at[1] = 0; at[1] < grid->cells[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->cells[0]; at[0]++) {
                ISO_TRY(fill_cell(values, at, grid, error));
                const int32_t state = grid->cell[iso_hgrid_cell_index(grid, at[0], at[1], at[2])];
                inside |= state == ISO_CELL_INSIDE;
                for (int i = 0; state >= 0 && !inside && i < ISO_BRICK_VOXELS; i++)
                    inside |= iso_hgrid_brick(grid, state)[i] < 0;
            }
    }
    iso_hgrid_prune(grid);
    return inside ? ISO_OK
                  : iso_fail(error, ISO_ERR_EMPTY, "%s: the mesh is open: it encloses nothing", path);
}

} // namespace

iso_status iso_vdb_convert_mesh(const char *path, const iso_triangles *mesh, const iso_mesh_frame *frame,
                                iso_hgrid **out, iso_error *error) {
    iso_hgrid *grid = nullptr;
    const iso_status status = iso::guard(path, error, [&] {
        openvdb::initialize();
        frame_box box;
        ISO_TRY(frame_of(path, *mesh, *frame, &box, error));
        const iso_progress converting = iso_progress_part(frame->progress, 0, 0.8),
                           filling = iso_progress_part(frame->progress, 0.8, 1);
        const FloatGrid::Ptr source = level_set_of(*mesh, box, converting);
        ISO_TRY(iso_progress_tell(&converting, path, 1, error));
        ISO_TRY(iso_hgrid_create(box.dims, 0, &box.transform, &grid, error));
        return fill(path, *source, filling, grid, error);
    });
    if (status == ISO_OK)
        *out = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}
