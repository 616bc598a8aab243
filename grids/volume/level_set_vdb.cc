/* level_set_vdb: converts an hgrid to an OpenVDB level set, and writes that to a stream. */
#include "grids/volume/level_set_vdb.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ostream>
#include <streambuf>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "base/bridge_guard.hpp"
#include "base/srgb.h"
#include "grids/volume/vdb_archive.hpp"

namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

/* The approximate size of a narrow-band leaf in the file, for progress reports. */
constexpr double LEAF_BYTES = 800;

openvdb::math::Transform::Ptr transform_of(const iso_transform &t) {
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();
    for (int row = 0; row < 3; row++) /* OpenVDB multiplies row vectors */
        for (int column = 0; column < 3; column++)
            matrix[column][row] = t.direction[3 * row + column] * t.spacing[column];
    matrix.setTranslation(openvdb::Vec3d(t.origin[0], t.origin[1], t.origin[2]));
    bool turned = false;
    for (int i = 0; i < 9; i++) turned |= t.direction[i] != (i % 4 == 0 ? 1 : 0);
    if (turned) return openvdb::math::Transform::createLinearTransform(matrix);
    /* a map of scale and translation where that is enough, as all programs support it */
    auto plain = openvdb::math::Transform::createLinearTransform(t.spacing[0]);
    plain->postTranslate(openvdb::Vec3d(t.origin[0], t.origin[1], t.origin[2]));
    return plain;
}

/* Copies the part of a brick (16^3 voxels, x fastest) from its voxel `part` on to a leaf (8^3, z fastest). */
void fill_leaf(FloatGrid::TreeType::LeafNodeType &leaf, const float *brick, const Coord &part, float band,
               float voxel) {
    for (openvdb::Index i = 0; i < 512; i++) {
        const Coord at = FloatGrid::TreeType::LeafNodeType::offsetToLocalCoord(i) + part;
        const float d = brick[(at.z() * ISO_BRICK + at.y()) * ISO_BRICK + at.x()];
        if (d < band && d > -band)
            leaf.setValueOn(i, d * voxel);
        else
            leaf.setValueOff(i, d * voxel);
    }
}

void fill_cell(FloatGrid &target, const iso_hgrid &grid, const Coord &cell) {
    const float voxel = static_cast<float>(grid.transform.spacing[0]), background = grid.band * voxel;
    const int32_t state = grid.cell[iso_hgrid_cell_index(&grid, cell.x(), cell.y(), cell.z())];
    const Coord first(cell.x() * ISO_BRICK, cell.y() * ISO_BRICK, cell.z() * ISO_BRICK);
    if (state == ISO_CELL_OUTSIDE) return;
    if (state == ISO_CELL_INSIDE) {
        target.tree().sparseFill(openvdb::CoordBBox(first, first.offsetBy(ISO_BRICK - 1)), -background,
                                 false);
        return;
    }
    for (int k = 0; k < 8; k++) {
        const Coord part(8 * (k & 1), 8 * (k >> 1 & 1), 8 * (k >> 2));
        fill_leaf(*target.tree().touchLeaf(first + part), iso_hgrid_brick(&grid, state), part, grid.band,
                  voxel);
    }
}

/* Thrown through OpenVDB when the caller cancels. */
struct cancelled {};

void tell(const iso_progress *progress, double fraction) {
    if (iso_progress_tell(progress, "", fraction, nullptr) != ISO_OK) throw cancelled{};
}

/* A stream buffer that passes what OpenVDB writes to a FILE. OpenVDB never seeks. */
class file_buffer : public std::streambuf {
  public:
    file_buffer(FILE *stream, double expected, const iso_progress *progress)
        : stream_(stream), expected_(expected), progress_(progress) {}

  protected:
    std::streamsize xsputn(const char *text, std::streamsize size) override {
        written_ += static_cast<double>(size);
        if (written_ >= told_ + STEP) {
            told_ = written_;
            tell(progress_, std::min(written_ / expected_, 1.0));
        }
        failed_ |= std::fwrite(text, 1, static_cast<size_t>(size), stream_) != static_cast<size_t>(size);
        return failed_ ? 0 : size;
    }
    int_type overflow(int_type c) override {
        const char byte = traits_type::to_char_type(c);
        return traits_type::eq_int_type(c, traits_type::eof()) || xsputn(&byte, 1) == 1
                   ? traits_type::not_eof(c)
                   : traits_type::eof();
    }

  private:
    static constexpr double STEP = 1 << 18;
    FILE *stream_;
    double expected_, written_ = 0, told_ = 0;
    const iso_progress *progress_;
    bool failed_ = false;
};

FloatGrid::Ptr level_set_of(const iso_hgrid &grid, const char *name, const iso_progress *progress) {
    const float background = grid.band * static_cast<float>(grid.transform.spacing[0]);
    FloatGrid::Ptr target = FloatGrid::create(background);
    target->setGridClass(openvdb::GRID_LEVEL_SET);
    target->setName(name);
    target->setTransform(transform_of(grid.transform));
    Coord cell;
    for (cell.z() = 0; cell.z() < grid.cells[2]; cell.z()++) {
        tell(progress, static_cast<double>(cell.z()) / grid.cells[2]);
        for (cell.y() = 0; cell.y() < grid.cells[1]; cell.y()++)
            for (cell.x() = 0; cell.x() < grid.cells[0]; cell.x()++) fill_cell(*target, grid, cell);
    }
    target->tree().prune();
    return target;
}

/* A colour (as of iso_level_set_colors) over the own one, linear. */
openvdb::Vec3f linear_color(uint32_t color, const uint8_t own[3]) {
    const unsigned amount = color >> 24;
    openvdb::Vec3f linear;
    for (int k = 0; k < 3; k++)
        linear[k] = static_cast<float>(
            iso_srgb_decode((own[k] * (255 - amount) + (color >> 8 * k & 255) * amount) / (255.0 * 255)));
    return linear;
}

/* Sets the colours of the voxels of a brick that have a distance. */
void fill_colors(Vec3SGrid::Accessor &target, const iso_hgrid &grid, const Coord &cell,
                 const uint32_t *colors, const uint8_t own[3]) {
    const int32_t state = grid.cell[iso_hgrid_cell_index(&grid, cell.x(), cell.y(), cell.z())];
    if (state < 0) return;
    const float *brick = iso_hgrid_brick(&grid, state);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++)
        if (brick[i] < grid.band && brick[i] > -grid.band)
            target.setValue(Coord(cell.x() * ISO_BRICK + i % ISO_BRICK,
                                  cell.y() * ISO_BRICK + i / ISO_BRICK % ISO_BRICK,
                                  cell.z() * ISO_BRICK + i / (ISO_BRICK * ISO_BRICK)),
                            linear_color(colors[i], own));
}

Vec3SGrid::Ptr colors_of(const iso_hgrid &grid, const iso_level_set_colors &colors) {
    Vec3SGrid::Ptr target = Vec3SGrid::create(linear_color(0, colors.own));
    target->setName("Cd");
    target->setTransform(transform_of(grid.transform));
    Vec3SGrid::Accessor accessor = target->getAccessor();
    Coord cell;
    for (cell.z() = 0; cell.z() < grid.cells[2]; cell.z()++)
        for (cell.y() = 0; cell.y() < grid.cells[1]; cell.y()++)
            for (cell.x() = 0; cell.x() < grid.cells[0]; cell.x()++) {
                const void *item = colors.cell[iso_hgrid_cell_index(&grid, cell.x(), cell.y(), cell.z())];
                if (item) fill_colors(accessor, grid, cell, static_cast<const uint32_t *>(item), colors.own);
            }
    return target;
}

} // namespace

iso_status iso_vdb_write_level_set(FILE *stream, const char *path, const iso_hgrid *grid, const char *name,
                                   const iso_level_set_colors *colors, const iso_progress *progress,
                                   iso_error *error) {
    const iso_progress filling = iso_progress_part(progress, 0, 0.5),
                       writing = iso_progress_part(progress, 0.5, 1);
    return iso::guard(path, error, [&] {
        try {
            iso::vdb::initialize();
            openvdb::GridCPtrVec grids{level_set_of(*grid, name, &filling)};
            if (colors) grids.push_back(colors_of(*grid, *colors));
            file_buffer buffer(
                stream, LEAF_BYTES * 8.0 * static_cast<double>(iso_hgrid_brick_count(grid)) + 1, &writing);
            std::ostream bytes(&buffer);
            bytes.exceptions(std::ios_base::badbit); /* lets exceptions of the buffer through */
            openvdb::io::Stream(bytes).write(grids);
            return ISO_OK;
        } catch (const cancelled &) {
            return iso_fail(error, ISO_ERR_IO, "%s: cancelled", path);
        } catch (const std::ios_base::failure &) {
            return iso_fail(error, ISO_ERR_WRITE, "%s: cannot write: %s", path, std::strerror(errno));
        }
    });
}
