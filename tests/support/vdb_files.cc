/* vdb_files: writes .vdb files with OpenVDB. */
#include "vdb_files.h"

#include <fstream>
#include <string>
#include <vector>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

namespace {

template <class T> void set_component(T &value, int, double component) {
    value = static_cast<T>(component);
}
template <class T> void set_component(openvdb::math::Vec3<T> &value, int i, double component) {
    value[i] = static_cast<T>(component);
}
template <class T> constexpr int components = 1;
template <class T> constexpr int components<openvdb::math::Vec3<T>> = 3;

template <class Grid> void fill(Grid &grid, const vdb_spec &spec) {
    using value_type = typename Grid::ValueType;
    auto accessor = grid.getAccessor();
    int v[3];
    for (v[2] = spec.lo[2]; v[2] <= spec.hi[2]; v[2]++)
        for (v[1] = spec.lo[1]; v[1] <= spec.hi[1]; v[1]++)
            for (v[0] = spec.lo[0]; v[0] <= spec.hi[0]; v[0]++) {
                int active = 1;
                value_type value = openvdb::zeroVal<value_type>();
                for (int c = 0; c < components<value_type>; c++)
                    set_component(value, c, spec.value(spec.context, v, c, &active));
                if (active) accessor.setValueOn(openvdb::Coord(v[0], v[1], v[2]), value);
            }
}

openvdb::math::Transform::Ptr transform_of(const vdb_spec &spec) {
    if (spec.frustum) {
        const openvdb::BBoxd box(openvdb::Vec3d(0), openvdb::Vec3d(32));
        return openvdb::math::Transform::Ptr(new openvdb::math::Transform(
            openvdb::math::MapBase::Ptr(new openvdb::math::NonlinearFrustumMap(box, 0.5, 10))));
    }
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++) matrix(axis, i) = spec.axis[3 * i + axis];
    for (int i = 0; i < 3; i++) matrix(3, i) = spec.origin[i];
    return openvdb::math::Transform::createLinearTransform(matrix);
}

template <class Grid> openvdb::GridBase::Ptr make(const vdb_spec &spec) {
    typename Grid::ValueType background = openvdb::zeroVal<typename Grid::ValueType>();
    for (int c = 0; c < components<typename Grid::ValueType>; c++)
        set_component(background, c, spec.background);
    auto grid = Grid::create(background);
    fill(*grid, spec);
    if constexpr (std::is_floating_point<typename Grid::ValueType>::value) {
        if (spec.grid_class == VDB_LEVEL_SET) {
            openvdb::tools::signedFloodFill(grid->tree());
            openvdb::tools::pruneLevelSet(grid->tree());
        }
    }
    return grid;
}

openvdb::GridBase::Ptr make_any(const vdb_spec &spec) {
    const std::string type = spec.type;
    openvdb::GridBase::Ptr grid;
    if (type == "float") grid = make<openvdb::FloatGrid>(spec);
    if (type == "double") grid = make<openvdb::DoubleGrid>(spec);
    if (type == "int32") grid = make<openvdb::Int32Grid>(spec);
    if (type == "int64") grid = make<openvdb::Int64Grid>(spec);
    if (type == "bool") grid = make<openvdb::BoolGrid>(spec);
    if (type == "mask") grid = make<openvdb::MaskGrid>(spec);
    if (type == "vec3s") grid = make<openvdb::Vec3SGrid>(spec);
    grid->setName(spec.name);
    grid->setTransform(transform_of(spec));
    grid->setSaveFloatAsHalf(spec.half != 0);
    if (spec.local) grid->setIsInWorldSpace(false);
    if (spec.grid_class == VDB_LEVEL_SET) grid->setGridClass(openvdb::GRID_LEVEL_SET);
    if (spec.grid_class == VDB_FOG) grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    return grid;
}

template <class Archive> void configure(Archive &archive, int flags) {
    uint32_t compression = openvdb::io::COMPRESS_NONE;
    if (flags & VDB_ZIP) compression |= openvdb::io::COMPRESS_ZIP;
    if (flags & VDB_BLOSC) compression |= openvdb::io::COMPRESS_BLOSC;
    if (flags & VDB_ACTIVE_MASK) compression |= openvdb::io::COMPRESS_ACTIVE_MASK;
    archive.setCompression(compression);
    archive.setGridStatsMetadataEnabled(!(flags & VDB_NO_STATS));
}

void write(const char *path, const openvdb::GridPtrVec &grids, int flags) {
    if (flags & VDB_STREAM) {
        std::ofstream stream(path, std::ios_base::binary);
        openvdb::io::Stream archive(stream);
        configure(archive, flags);
        archive.write(grids);
    } else {
        openvdb::io::File archive(path);
        configure(archive, flags);
        archive.write(grids);
    }
}

template <class Body> int guard(Body &&body) {
    try {
        openvdb::initialize();
        body();
        return 0;
    } catch (...) {
        return 1;
    }
}

} // namespace

/* Called by the leak sanitizer: OpenVDB 10 leaks the node that it is reading when it throws because of a
 * corrupt file. */
extern "C" const char *__lsan_default_suppressions();
extern "C" const char *__lsan_default_suppressions() {
    return "leak:readTopology\n";
}

int vdb_write(const char *path, const vdb_spec *specs, int count, int flags) {
    return guard([&] {
        openvdb::GridPtrVec grids;
        for (int i = 0; i < count; i++) grids.push_back(make_any(specs[i]));
        write(path, grids, flags);
    });
}

int vdb_write_points(const char *path, const char *name) {
    return guard([&] {
        const std::vector<openvdb::Vec3R> positions = {{0, 0, 0}, {1, 2, 3}, {4, 5, 6}};
        const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
        auto grid =
            openvdb::points::createPointDataGrid<openvdb::points::NullCodec, openvdb::points::PointDataGrid>(
                positions, *transform);
        grid->setName(name);
        write(path, {grid}, VDB_BLOSC);
    });
}

int vdb_write_instances(const char *path, const vdb_spec *spec, double shift) {
    return guard([&] {
        auto first = make_any(*spec);
        auto second = first->copyGrid();
        vdb_spec moved = *spec;
        moved.origin[0] += shift;
        first->setName("a");
        second->setName("b");
        second->setTransform(transform_of(moved));
        write(path, {first, second}, VDB_ZIP);
    });
}
