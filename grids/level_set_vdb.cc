/* level_set_vdb: an hgrid as OpenVDB's level set. */
#include "grids/level_set_vdb.hpp"

#include <sstream>
#include <string>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "grids/bridge_guard.hpp"

namespace {

using openvdb::Coord;
using openvdb::FloatGrid;

openvdb::math::Transform::Ptr transform_of(const iso_transform &t) {
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();
    for (int row = 0; row < 3; row++) /* OpenVDB multiplies row vectors */
        for (int column = 0; column < 3; column++)
            matrix[column][row] = t.direction[3 * row + column] * t.spacing[column];
    matrix.setTranslation(openvdb::Vec3d(t.origin[0], t.origin[1], t.origin[2]));
    bool turned = false;
    for (int i = 0; i < 9; i++) turned |= t.direction[i] != (i % 4 == 0 ? 1 : 0);
    if (turned) return openvdb::math::Transform::createLinearTransform(matrix);
    /* (a map of scale and translation is what other programs know best) */
    auto plain = openvdb::math::Transform::createLinearTransform(t.spacing[0]);
    plain->postTranslate(openvdb::Vec3d(t.origin[0], t.origin[1], t.origin[2]));
    return plain;
}

/* One leaf of 8^3, z fastest, from the corner `part` of a brick of 16^3, x fastest. */
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

FloatGrid::Ptr level_set_of(const iso_hgrid &grid, const char *name) {
    const float background = grid.band * static_cast<float>(grid.transform.spacing[0]);
    FloatGrid::Ptr target = FloatGrid::create(background);
    target->setGridClass(openvdb::GRID_LEVEL_SET);
    target->setName(name);
    target->setTransform(transform_of(grid.transform));
    Coord cell;
    for (cell.z() = 0; cell.z() < grid.cells[2]; cell.z()++)
        for (cell.y() = 0; cell.y() < grid.cells[1]; cell.y()++)
            for (cell.x() = 0; cell.x() < grid.cells[0]; cell.x()++) fill_cell(*target, grid, cell);
    target->tree().prune();
    return target;
}

} // namespace

iso_status iso_vdb_write_level_set(FILE *stream, const char *path, const iso_hgrid *grid, const char *name,
                                   iso_error *error) {
    return iso::guard(path, error, [&] {
        openvdb::initialize();
        const openvdb::GridCPtrVec grids{level_set_of(*grid, name)};
        std::ostringstream bytes(std::ios_base::binary);
        openvdb::io::Stream(bytes).write(grids);
        const std::string text = bytes.str();
        if (std::fwrite(text.data(), 1, text.size(), stream) != text.size())
            return iso_fail(error, ISO_ERR_WRITE, "%s: cannot write", path);
        return ISO_OK;
    });
}
