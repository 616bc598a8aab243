/* format_vdb: OpenVDB's sparse grids. A level set with cubic voxels becomes an hgrid, every other grid of
 * numbers an rgrid over its active bounding box.
 *
 * The archive is read through a stream that throws, not through openvdb::io::File: that one ignores a short
 * read and hands out whatever was in memory, and its delayed loading maps files that may shrink. */
#include "grids/format.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include "grids/bridge_guard.hpp"
#include "grids/level_set_vdb.hpp"
#include "grids/module.h"
#include "grids/vdb_check.h"

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::GridBase;

/* ---- the archive ---- */

struct vdb_grid {
    openvdb::io::GridDescriptor descriptor;
    GridBase::Ptr grid; /* metadata and transform; the tree when `loaded` */
    bool loaded = false;

    std::string name() const { return openvdb::io::GridDescriptor::nameAsString(descriptor.uniqueName()); }
};

using real_grids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid>;
using scalar_grids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                       openvdb::Int64Grid, openvdb::BoolGrid, openvdb::MaskGrid>;
using vector_grids = openvdb::TypeList<openvdb::Vec3SGrid, openvdb::Vec3DGrid, openvdb::Vec3IGrid>;

bool is_points(const GridBase &grid) {
    return grid.isType<openvdb::points::PointDataGrid>();
}
bool is_scalar(const GridBase &grid) {
    return grid.apply<scalar_grids>([](const auto &) {});
}
bool is_vector(const GridBase &grid) {
    return grid.apply<vector_grids>([](const auto &) {});
}
bool is_level_set(const GridBase &grid) {
    return grid.getGridClass() == openvdb::GRID_LEVEL_SET && grid.apply<real_grids>([](const auto &) {});
}

class archive : public openvdb::io::Archive {
  public:
    explicit archive(const char *path);
    std::vector<vdb_grid> grids;
    /* Lists the grids. */
    iso_status scan(iso_error *error);
    /* Reads the tree of a grid of numbers: where its voxels are, and what they hold unless `topology` is
     * enough. */
    iso_status load(vdb_grid &entry, bool topology, iso_error *error);

  private:
    const char *path_; /* borrowed */
    /* The stream keeps a pointer to this pointer. */
    openvdb::io::StreamMetadata::Ptr metadata_{new openvdb::io::StreamMetadata};
    std::ifstream stream_;
    std::streamoff size_ = 0;
    iso_status check_magic(iso_error *error);
    iso_status next_grid(bool *more, iso_error *error);
    iso_status next_of_stream(vdb_grid &entry, bool *more, iso_error *error);
    void read_header_of(vdb_grid &entry);
    iso_status check_tree(const vdb_grid &entry, bool streamed, iso_error *error);
    vdb_grid &parent_of(const vdb_grid &entry);
};

archive::archive(const char *path) : path_(path) {
    stream_.open(path, std::ios_base::binary);
    if (!stream_) OPENVDB_THROW(openvdb::IoError, "cannot open the file");
    stream_.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
    stream_.seekg(0, std::ios_base::end);
    size_ = stream_.tellg();
    stream_.seekg(0);
}

iso_status archive::scan(iso_error *error) {
    ISO_TRY(check_magic(error));
    readHeader(stream_);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    openvdb::io::setStreamMetadataPtr(stream_, metadata_, /*transfer=*/false);
    openvdb::MetaMap().readMeta(stream_);
    bool more = true;
    for (int32_t count = readGridCount(stream_); more && count > 0; count--) ISO_TRY(next_grid(&more, error));
    return ISO_OK;
}

/* A file that begins rightly and is too short for a header is cut off; any other is not a .vdb. Files before
 * version 222 are laid out in other ways, those of later versions in ways not known yet. */
iso_status archive::check_magic(iso_error *error) {
    const uint32_t oldest = openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;
    const uint32_t newest = openvdb::OPENVDB_FILE_VERSION;
    static const char magic[8] = {' ', 'B', 'D', 'V', 0, 0, 0, 0};
    char head[sizeof magic] = {};
    uint32_t version = 0;
    const std::streamoff count = std::min<std::streamoff>(size_, sizeof head);
    stream_.read(head, count);
    if (std::memcmp(head, magic, static_cast<size_t>(count)) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a .vdb file", path_);
    stream_.read(reinterpret_cast<char *>(&version), sizeof version);
    stream_.seekg(0);
    if (version < oldest || version > newest)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its file version is %u, only %u to %u can be read", path_,
                        version, oldest, newest);
    return ISO_OK;
}

/* With grid offsets, the descriptors form a chain through the file: a chain that leads out of the file means
 * that its end is missing, one that leads back that it is corrupt. */
iso_status archive::next_grid(bool *more, iso_error *error) {
    vdb_grid entry;
    entry.grid = entry.descriptor.read(stream_);
    if (!inputHasGridOffsets()) return next_of_stream(entry, more, error);
    const std::streamoff here = stream_.tellg(), grid = entry.descriptor.getGridPos();
    const std::streamoff blocks = entry.descriptor.getBlockPos(), end = entry.descriptor.getEndPos();
    if (end > size_) throw std::ios_base::failure("ends early");
    const bool ordered = entry.descriptor.isInstance() || (grid <= blocks && blocks <= end);
    if (grid < here || end < grid || !ordered) OPENVDB_THROW(openvdb::IoError, "grid offsets are wrong");
    stream_.seekg(grid);
    read_header_of(entry);
    grids.push_back(entry);
    stream_.seekg(end);
    return ISO_OK;
}

/* In a file that was written as a stream the only way to the next grid is through this one. What cannot be
 * checked is not read, and nothing behind it is found. */
iso_status archive::next_of_stream(vdb_grid &entry, bool *more, iso_error *error) {
    const std::streamoff begin = stream_.tellg();
    read_header_of(entry);
    *more = entry.descriptor.isInstance() || is_scalar(*entry.grid) || is_vector(*entry.grid);
    if (*more && !entry.descriptor.isInstance()) {
        ISO_TRY(check_tree(entry, true, error));
        stream_.seekg(begin);
        Archive::readGrid(entry.grid, entry.descriptor, stream_);
        entry.loaded = true;
    }
    grids.push_back(entry);
    return ISO_OK;
}

void archive::read_header_of(vdb_grid &entry) {
    readGridCompression(stream_);
    entry.grid->readMeta(stream_);
    entry.grid->readTransform(stream_);
}

int value_bytes(const GridBase &grid) {
    int bytes = 0;
    const auto size = [&](const auto &typed) {
        using grid_type = std::decay_t<decltype(typed)>;
        bytes = static_cast<int>(sizeof(typename grid_type::ValueType));
    };
    if (!grid.apply<scalar_grids>(size)) grid.apply<vector_grids>(size);
    return bytes;
}

/* Checks the tree that begins where the stream is, behind the grid's header; its place stays. */
iso_status archive::check_tree(const vdb_grid &entry, bool streamed, iso_error *error) {
    const GridBase &grid = *entry.grid;
    const uint32_t compression = openvdb::io::getDataCompression(stream_);
    iso_vdb_layout layout = {};
    layout.value_bytes = layout.stored_bytes = value_bytes(grid);
    if (grid.saveFloatAsHalf() && grid.apply<real_grids>([](const auto &) {})) layout.stored_bytes = 2;
    if (grid.saveFloatAsHalf() && is_vector(grid) && !grid.isType<openvdb::Vec3IGrid>())
        layout.stored_bytes = 6;
    layout.leaf = grid.isType<openvdb::BoolGrid>()   ? ISO_VDB_BOOLS
                  : grid.isType<openvdb::MaskGrid>() ? ISO_VDB_MASK
                                                     : ISO_VDB_VALUES;
    layout.blosc = compression & openvdb::io::COMPRESS_BLOSC;
    layout.compressed = layout.blosc || (compression & openvdb::io::COMPRESS_ZIP);
    layout.active_only = compression & openvdb::io::COMPRESS_ACTIVE_MASK;
    layout.topology = static_cast<uint64_t>(stream_.tellg());
    layout.blocks = streamed ? 0 : static_cast<uint64_t>(entry.descriptor.getBlockPos());
    layout.end = streamed ? 0 : static_cast<uint64_t>(entry.descriptor.getEndPos());
    return iso_vdb_check(path_, &layout, error);
}

/* The grid whose tree an instance shares. */
vdb_grid &archive::parent_of(const vdb_grid &entry) {
    for (vdb_grid &other : grids)
        if (other.descriptor.uniqueName() == entry.descriptor.instanceParentName() &&
            !other.descriptor.isInstance() && other.grid->type() == entry.grid->type())
            return other;
    OPENVDB_THROW(openvdb::IoError, "a grid shares the voxels of one that is not there");
}

iso_status archive::load(vdb_grid &entry, bool topology, iso_error *error) {
    if (entry.descriptor.isInstance()) {
        vdb_grid &parent = parent_of(entry);
        ISO_TRY(load(parent, topology, error));
        entry.grid->setTree(parent.grid->baseTreePtr());
        return ISO_OK;
    }
    if (entry.loaded) return ISO_OK;
    stream_.seekg(entry.descriptor.getGridPos());
    read_header_of(entry);
    ISO_TRY(check_tree(entry, false, error));
    if (topology) {
        entry.grid->readTopology(stream_);
    } else {
        stream_.seekg(entry.descriptor.getGridPos());
        Archive::readGrid(entry.grid, entry.descriptor, stream_);
        entry.loaded = true;
    }
    return ISO_OK;
}

/* Turns what OpenVDB throws into a line about the file. Lengths that no memory could hold come from bytes
 * that are not lengths, as long as only headers are read. */
template <class Body> iso_status reading(const char *path, iso_error *error, Body &&body) {
    try {
        return body();
    } catch (const std::ios_base::failure &) {
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends before its grids do", path);
    } catch (const openvdb::TypeError &exception) {
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, iso::one_line(exception.what()).c_str());
    } catch (const openvdb::LookupError &exception) {
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, iso::one_line(exception.what()).c_str());
    } catch (const openvdb::Exception &exception) {
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: %s", path, iso::one_line(exception.what()).c_str());
    } catch (const std::length_error &) {
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: a length in the file is not possible", path);
    }
}

/* ---- which grid ---- */

std::string names_of(const archive &file) {
    std::string names;
    for (const vdb_grid &entry : file.grids) names += (names.empty() ? "" : ", ") + entry.name();
    return iso::one_line(names);
}

iso_status choose_named(const char *path, const char *name, archive &file, vdb_grid **chosen,
                        iso_error *error) {
    *chosen = nullptr;
    for (vdb_grid &entry : file.grids)
        if (!*chosen && (entry.name() == name || entry.descriptor.gridName() == name)) *chosen = &entry;
    if (!*chosen)
        return iso_fail(error, ISO_ERR_USAGE, "%s: no grid \"%s\", there is %s", path, name,
                        file.grids.empty() ? "none" : names_of(file).c_str());
    const GridBase &grid = *(*chosen)->grid;
    if (is_points(grid))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" holds points, no volume", path, name);
    if (!is_scalar(grid) && !is_vector(grid))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" holds %s, no numbers", path, name,
                        grid.valueType().c_str());
    return ISO_OK;
}

template <class Wanted> vdb_grid *first_of(archive &file, Wanted wanted) {
    auto found = std::find_if(file.grids.begin(), file.grids.end(),
                              [&](const vdb_grid &entry) { return wanted(*entry.grid); });
    return found == file.grids.end() ? nullptr : &*found;
}

iso_status choose(const char *path, const iso_volume_opts *opts, archive &file, vdb_grid **chosen,
                  iso_error *error) {
    if (opts->grid) return choose_named(path, opts->grid, file, chosen, error);
    *chosen = first_of(file, is_level_set);
    if (!*chosen) *chosen = first_of(file, is_scalar);
    if (!*chosen) *chosen = first_of(file, is_vector);
    if (*chosen) return ISO_OK;
    if (file.grids.empty()) return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no grids", path);
    const vdb_grid *points = first_of(file, is_points);
    if (points)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds only points (grid \"%s\"), no volume", path,
                        points->name().c_str());
    return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no grid of numbers, only %s", path,
                    names_of(file).c_str());
}

/* ---- what the header says ---- */

struct extent {
    CoordBBox box; /* of the active voxels */
    uint64_t voxels = 0, leaves = 0, tree_bytes = 0;
};

/* The values, the mask, the origin and a pointer. */
size_t leaf_bytes(const GridBase &grid) {
    return 512 * static_cast<size_t>(value_bytes(grid)) + 96;
}

/* From the statistics that OpenVDB writes beside every grid; false when they are missing or make no sense. */
bool stated_extent(const GridBase &grid, extent *result) {
    const auto lo = grid.getMetadata<openvdb::Vec3IMetadata>(GridBase::META_FILE_BBOX_MIN);
    const auto hi = grid.getMetadata<openvdb::Vec3IMetadata>(GridBase::META_FILE_BBOX_MAX);
    const auto voxels = grid.getMetadata<openvdb::Int64Metadata>(GridBase::META_FILE_VOXEL_COUNT);
    const auto bytes = grid.getMetadata<openvdb::Int64Metadata>(GridBase::META_FILE_MEM_BYTES);
    if (!lo || !hi || !voxels || voxels->value() < 0) return false;
    result->box = CoordBBox(Coord(lo->value()), Coord(hi->value()));
    result->voxels = static_cast<uint64_t>(voxels->value());
    result->tree_bytes = bytes && bytes->value() > 0 ? static_cast<uint64_t>(bytes->value()) : 0;
    result->leaves = result->tree_bytes / leaf_bytes(grid);
    return true;
}

/* From the tree, of which the topology is enough. */
extent counted_extent(const GridBase &grid) {
    extent result;
    result.box = grid.evalActiveVoxelBoundingBox();
    result.voxels = grid.activeVoxelCount();
    const auto &tree = grid.constBaseTree();
    result.leaves = tree.leafCount();
    /* The largest node has 32^3 children of 8 bytes each. */
    result.tree_bytes = result.leaves * leaf_bytes(grid) + tree.nonLeafCount() * UINT64_C(34000);
    return result;
}

bool box_dims(const CoordBBox &box, uint64_t dims[3]) {
    for (int i = 0; i < 3; i++) {
        const int64_t count = int64_t{box.max()[i]} - box.min()[i] + 1;
        if (count < 1) return false;
        dims[i] = static_cast<uint64_t>(count);
    }
    return true;
}

void list_grids(const archive &file, iso_volume_info *info) {
    for (const vdb_grid &entry : file.grids) {
        if (info->item_count == ISO_VOLUME_ITEMS) break;
        extent known;
        uint64_t dims[3];
        std::string size = "size not stated";
        if (stated_extent(*entry.grid, &known)) {
            size = std::to_string(known.voxels) + " voxels";
            if (box_dims(known.box, dims))
                size += "  " + std::to_string(dims[0]) + "x" + std::to_string(dims[1]) + "x" +
                        std::to_string(dims[2]);
        }
        const std::string line = iso::one_line(entry.name()) + "  " + entry.grid->valueType() + "  " +
                                 GridBase::gridClassToString(entry.grid->getGridClass()) + "  " + size;
        std::snprintf(info->items[info->item_count++], ISO_VOLUME_TEXT, "%s", line.c_str());
    }
}

/* OpenVDB multiplies row vectors: the rows of its matrix are where the index axes go. */
iso_status fill_transform(const char *path, const vdb_grid &entry, const Coord &lo, iso_transform *transform,
                          iso_error *error) {
    const openvdb::math::Transform &map = entry.grid->transform();
    if (!map.isLinear())
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: grid \"%s\" has a transform that is not linear (a %s): cannot be read", path,
                        entry.name().c_str(), map.mapType().c_str());
    const openvdb::Mat4d matrix = map.baseMap()->getAffineMap()->getMat4();
    const openvdb::Vec3d origin = map.indexToWorld(lo);
    for (int axis = 0; axis < 3; axis++) {
        const openvdb::Vec3d step(matrix(axis, 0), matrix(axis, 1), matrix(axis, 2));
        transform->origin[axis] = origin[axis];
        transform->spacing[axis] = step.length();
        for (int i = 0; i < 3; i++) transform->direction[3 * i + axis] = step[i] / step.length();
    }
    return ISO_OK;
}

/* Cubes of any size and orientation. The tolerance is that of a transform stored in single precision. */
bool has_cubic_voxels(const iso_transform &transform) {
    const double *s = transform.spacing, *d = transform.direction;
    const double tolerance = 1e-5;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        if (!(std::fabs(s[a] - s[b]) <= tolerance * s[a])) return false;
        if (!(std::fabs(d[a] * d[b] + d[3 + a] * d[3 + b] + d[6 + a] * d[6 + b]) <= tolerance)) return false;
    }
    return true;
}

uint64_t dense_bytes(const uint64_t dims[3]) {
    uint64_t bytes = sizeof(float);
    for (int i = 0; i < 3; i++)
        if (__builtin_mul_overflow(bytes, dims[i], &bytes)) return UINT64_MAX;
    return bytes;
}

/* A brick of 16^3 voxels spans eight leaves or more, a surface passes through about four of them. */
uint64_t hgrid_bytes(const iso_volume_info &info, const extent &known) {
    uint64_t cells = 1;
    for (int i = 0; i < 3; i++) cells *= static_cast<uint64_t>((info.dims[i] - 1) / ISO_BRICK + 1);
    const uint64_t bricks = std::min(cells, known.leaves / 2 + 1);
    return cells * 16 + bricks * ISO_BRICK_VOXELS * sizeof(float);
}

iso_status fill_size(const char *path, const vdb_grid &entry, const extent &known, iso_volume_info *info,
                     iso_error *error) {
    uint64_t dims[3];
    if (known.voxels == 0 || !box_dims(known.box, dims))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" has no active voxels", path,
                        entry.name().c_str());
    const int farthest = 1 << 30; /* so that coordinates a few cells away cannot overflow */
    for (int i = 0; i < 3; i++)
        if (known.box.min()[i] < -farthest || known.box.max()[i] > farthest)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" has voxels farther out than 2^30", path,
                            entry.name().c_str());
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(fill_transform(path, entry, known.box.min(), &info->transform, error));
    info->level_set = is_level_set(*entry.grid);
    info->sparse = info->level_set && has_cubic_voxels(info->transform);
    if (info->sparse && *std::max_element(info->dims, info->dims + 3) > ISO_HGRID_MAX)
        return iso_fail(error, ISO_ERR_LIMIT,
                        "%s: level set \"%s\" spans %d x %d x %d voxels, at most %d an axis can be read",
                        path, entry.name().c_str(), info->dims[0], info->dims[1], info->dims[2],
                        ISO_HGRID_MAX);
    info->bytes = info->sparse ? hgrid_bytes(*info, known) : dense_bytes(dims);
    if (__builtin_add_overflow(info->bytes, known.tree_bytes, &info->read_bytes))
        info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

iso_status fill_info(const char *path, const iso_volume_opts *opts, archive &file, iso_volume_info *info,
                     iso_error *error) {
    vdb_grid *chosen = nullptr;
    ISO_TRY(choose(path, opts, file, &chosen, error));
    const std::string name = chosen->name();
    std::snprintf(info->name, sizeof info->name, "%s", name.c_str());
    list_grids(file, info);
    if (!opts->grid && file.grids.size() > 1)
        iso_volume_note(info, "several grids: using \"%s\" of %zu (--grid)", name.c_str(), file.grids.size());
    const GridBase &grid = *chosen->grid;
    info->type = ISO_FLOAT32;
    std::snprintf(info->file_type, sizeof info->file_type, "%s",
                  grid.saveFloatAsHalf() ? "half" : grid.valueType().c_str());
    ISO_TRY(iso_format_component(path, opts, is_vector(grid) ? 3 : 1, info, error));
    extent known;
    if (!stated_extent(grid, &known)) {
        ISO_TRY(file.load(*chosen, true, error));
        known = counted_extent(grid);
    }
    return fill_size(path, *chosen, known, info, error);
}

iso_status vdb_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_error *error) {
    return iso::guard(path, error, [&] {
        openvdb::initialize();
        return reading(path, error, [&] {
            archive file(path);
            ISO_TRY(file.scan(error));
            return fill_info(path, opts, file, info, error);
        });
    });
}

/* ---- voxels ---- */

template <class T> float component_of(const T &value, int) {
    return static_cast<float>(value);
}
template <class T> float component_of(const openvdb::math::Vec3<T> &value, int component) {
    return static_cast<float>(value[component]);
}

/* Where a box of voxels goes: x fastest. */
struct box_target {
    Coord lo;
    int dims[3];
    float *data;
    ptrdiff_t stride_y, stride_z;
};

constexpr int LEAF = 8;
static_assert(openvdb::FloatTree::LeafNodeType::DIM == LEAF && ISO_BRICK % LEAF == 0, "leaves are 8^3");

/* Largest multiple of a leaf's side that is not above i. */
int leaf_floor(int i) {
    return i & ~(LEAF - 1);
}

/* Copies the part of one leaf (z fastest), or of the tile in its place, that lies in the target. Accessors of
 * this kind are not registered with their tree, so that many threads can have one. */
template <class Tree>
void copy_block(const openvdb::tree::ValueAccessor<const Tree, false> &accessor, const Coord &block,
                int component, const box_target &target) {
    const auto *leaf = accessor.probeConstLeaf(block);
    const float tile = leaf ? 0 : component_of(accessor.getValue(block), component);
    int lo[3], hi[3];
    for (int i = 0; i < 3; i++) {
        lo[i] = std::max(block[i], target.lo[i]) - block[i];
        hi[i] = static_cast<int>(std::min<int64_t>(LEAF, int64_t{target.lo[i]} + target.dims[i] - block[i]));
    }
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++) {
            float *row = target.data + (block.z() + z - target.lo.z()) * target.stride_z +
                         (block.y() + y - target.lo.y()) * target.stride_y + (block.x() - target.lo.x());
            for (int x = lo[0]; x < hi[0]; x++)
                row[x] = leaf ? component_of(leaf->getValue((x * LEAF + y) * LEAF + z), component) : tile;
        }
}

/* Copies the blocks of the target whose lowest z is `z`. */
template <class Tree>
void copy_layer(const openvdb::tree::ValueAccessor<const Tree, false> &accessor, int64_t z, int component,
                const box_target &target) {
    const int64_t end_x = int64_t{target.lo.x()} + target.dims[0];
    const int64_t end_y = int64_t{target.lo.y()} + target.dims[1];
    for (int64_t y = leaf_floor(target.lo.y()); y < end_y; y += LEAF)
        for (int64_t x = leaf_floor(target.lo.x()); x < end_x; x += LEAF)
            copy_block<Tree>(accessor, Coord(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)),
                             component, target);
}

/* Runs body(0 .. count-1) on the pool. body must not throw. */
template <class Body> void parallel(iso_pool *pool, size_t count, const Body &body) {
    iso_parallel_for(
        pool, count, [](void *context, size_t index, int) { (*static_cast<const Body *>(context))(index); },
        const_cast<Body *>(&body));
}

template <class Tree>
void copy_dense(const Tree &tree, int component, iso_pool *pool, const box_target &target) {
    const int64_t first = leaf_floor(target.lo.z()), end = int64_t{target.lo.z()} + target.dims[2];
    parallel(pool, static_cast<size_t>((end - first + LEAF - 1) / LEAF), [&](size_t layer) {
        const openvdb::tree::ValueAccessor<const Tree, false> accessor(tree);
        copy_layer<Tree>(accessor, first + static_cast<int64_t>(layer) * LEAF, component, target);
    });
}

/* ---- level sets ---- */

/* World distances of a tree into voxel distances of an hgrid. */
template <class Tree> struct level_set {
    const Tree &tree;
    double background; /* world units, > 0 */
    double voxel;      /* size of one, world units */
    Coord lo;          /* voxel 0 of the grid */
    iso_hgrid *grid;
    std::atomic<uint64_t> nan_count;

    /* What is at the background or beyond lies outside the narrow band. */
    float distance(float value) {
        if (std::isnan(value)) {
            nan_count.fetch_add(1, std::memory_order_relaxed);
            return grid->band;
        }
        if (value >= static_cast<float>(background)) return grid->band;
        if (value <= -static_cast<float>(background)) return -grid->band;
        return std::clamp(static_cast<float>(value / voxel), -grid->band, grid->band);
    }

    Coord cell_origin(const int cell[3]) const {
        return lo.offsetBy(cell[0] * ISO_BRICK, cell[1] * ISO_BRICK, cell[2] * ISO_BRICK);
    }
    int32_t state_of(const int cell[3]) const;
    void fill(const int cell[3], float *brick);
};

/* What a cell without leaves is, or 0 when it needs a brick: it meets a leaf, a tile inside the band, or
 * tiles of both sides. */
template <class Tree> int32_t level_set<Tree>::state_of(const int cell[3]) const {
    const openvdb::tree::ValueAccessor<const Tree, false> accessor(tree);
    const Coord first = cell_origin(cell), last = first.offsetBy(ISO_BRICK - 1);
    int32_t state = 0;
    for (int z = leaf_floor(first.z()); z <= last.z(); z += LEAF)
        for (int y = leaf_floor(first.y()); y <= last.y(); y += LEAF)
            for (int x = leaf_floor(first.x()); x <= last.x(); x += LEAF) {
                const Coord block(x, y, z);
                if (accessor.probeConstLeaf(block)) return 0;
                const float value = static_cast<float>(accessor.getValue(block));
                if (!(std::fabs(value) >= static_cast<float>(background))) return 0;
                const int32_t side = value > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
                if (state != 0 && state != side) return 0;
                state = side;
            }
    return state;
}

template <class Tree> void level_set<Tree>::fill(const int cell[3], float *brick) {
    const openvdb::tree::ValueAccessor<const Tree, false> accessor(tree);
    const box_target target = {cell_origin(cell),
                               {ISO_BRICK, ISO_BRICK, ISO_BRICK},
                               brick,
                               ISO_BRICK,
                               ptrdiff_t{ISO_BRICK} * ISO_BRICK};
    for (int z = leaf_floor(target.lo.z()); z < target.lo.z() + ISO_BRICK; z += LEAF)
        copy_layer<Tree>(accessor, z, 0, target);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) brick[i] = distance(brick[i]);
}

/* Bricks come from the grid's pool one after another (so that a brick's number does not depend on threads);
 * looking which are needed and filling them goes side by side. */
template <class Tree> iso_status fill_cells(level_set<Tree> &job, iso_pool *pool, iso_error *error) {
    iso_hgrid *grid = job.grid;
    const size_t count = static_cast<size_t>(grid->cells[0]) * static_cast<size_t>(grid->cells[1]) *
                         static_cast<size_t>(grid->cells[2]);
    const size_t row = static_cast<size_t>(grid->cells[0]);
    const auto cell_of = [&](size_t i, int cell[3]) {
        cell[0] = static_cast<int>(i % row);
        cell[1] = static_cast<int>(i / row % static_cast<size_t>(grid->cells[1]));
        cell[2] = static_cast<int>(i / row / static_cast<size_t>(grid->cells[1]));
    };
    std::vector<int8_t> states(count);
    parallel(pool, count / row, [&](size_t line) {
        int cell[3];
        for (size_t i = line * row; i < (line + 1) * row; i++) {
            cell_of(i, cell);
            states[i] = static_cast<int8_t>(job.state_of(cell));
        }
    });
    std::vector<size_t> full;
    for (size_t i = 0; i < count; i++) {
        int cell[3];
        float *brick;
        cell_of(i, cell);
        if (states[i] != 0) {
            iso_hgrid_coalesce(grid, cell[0], cell[1], cell[2], states[i]);
        } else {
            ISO_TRY(iso_hgrid_split(grid, cell[0], cell[1], cell[2], &brick, error));
            full.push_back(i);
        }
    }
    parallel(pool, full.size(), [&](size_t k) {
        int cell[3];
        cell_of(full[k], cell);
        job.fill(cell, iso_hgrid_brick(grid, grid->cell[full[k]]));
    });
    iso_hgrid_prune(grid);
    return ISO_OK;
}

/* ---- reading ---- */

iso_status load_chosen(const char *path, const iso_volume_info &info, GridBase::ConstPtr *grid,
                       iso_error *error) {
    return reading(path, error, [&] {
        archive file(path);
        ISO_TRY(file.scan(error));
        vdb_grid *chosen = nullptr;
        ISO_TRY(choose_named(path, info.name, file, &chosen, error));
        ISO_TRY(file.load(*chosen, false, error));
        *grid = chosen->grid;
        return ISO_OK;
    });
}

/* The lowest voxel of the box whose size the header announced; the box must hold every active voxel. */
iso_status announced_box(const char *path, const GridBase &grid, const iso_volume_info &info, Coord *lo,
                         iso_error *error) {
    extent known;
    if (!stated_extent(grid, &known)) known = counted_extent(grid);
    uint64_t dims[3];
    bool right = box_dims(known.box, dims);
    for (int i = 0; i < 3 && right; i++) right = dims[i] == static_cast<uint64_t>(info.dims[i]);
    if (!right) return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    const CoordBBox actual = grid.evalActiveVoxelBoundingBox();
    if (!actual.empty() && !known.box.isInside(actual))
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: grid \"%s\" has voxels outside the box it states",
                        path, info.name);
    *lo = known.box.min();
    return ISO_OK;
}

struct read_job {
    const char *path;
    iso_pool *pool;
    iso_volume_info *info;
    Coord lo;
    iso_error *error;
};

iso_status read_dense(const read_job &job, const GridBase &source, iso_grid *grid) {
    ISO_TRY(iso_format_create(job.path, job.info, nullptr, grid, job.error));
    const iso_rgrid *rgrid = grid->rgrid;
    const box_target target = {job.lo,
                               {rgrid->dims[0], rgrid->dims[1], rgrid->dims[2]},
                               static_cast<float *>(rgrid->data),
                               rgrid->stride_y,
                               rgrid->stride_z};
    const auto copy = [&](const auto &typed) {
        copy_dense(typed.constTree(), job.info->component, job.pool, target);
    };
    if (!source.apply<scalar_grids>(copy)) source.apply<vector_grids>(copy);
    return ISO_OK;
}

template <class Tree>
iso_status read_tree(const read_job &job, const Tree &tree, double voxel, iso_grid *grid) {
    iso_volume_info *info = job.info;
    const double background = static_cast<double>(tree.background()), half_width = background / voxel;
    if (!(half_width > 0 && std::isfinite(half_width)))
        return iso_fail(job.error, ISO_ERR_FORMAT, "%s: level set \"%s\" has a background of %g", job.path,
                        info->name, background);
    if (half_width < 3 * (1 - 1e-5))
        iso_volume_note(info, "the narrow band is only %.3g voxels wide on either side (3 are usual)",
                        half_width);
    const float band = static_cast<float>(std::max(3.0, half_width));
    iso_error detail = {};
    iso_status status = iso_hgrid_create(info->dims, band, &info->transform, &grid->hgrid, &detail);
    if (status == ISO_OK) {
        level_set<Tree> levels = {tree, background, voxel, job.lo, grid->hgrid, {0}};
        status = fill_cells(levels, job.pool, &detail);
        if (levels.nan_count > 0)
            iso_volume_note(info, "%llu distances are not numbers: taken to be outside",
                            static_cast<unsigned long long>(levels.nan_count));
    }
    if (status != ISO_OK) return iso_fail(job.error, status, "%s: %s", job.path, detail.text);
    info->bytes = iso_hgrid_bytes(grid->hgrid);
    return ISO_OK;
}

/* Distances are divided by the file's own voxel size, whatever spacing the caller asked for. */
iso_status read_sparse(const read_job &job, const GridBase &source, iso_grid *grid) {
    iso_status status = ISO_ERR_FORMAT;
    const double voxel = source.transform().voxelSize()[0];
    source.apply<real_grids>(
        [&](const auto &typed) { status = read_tree(job, typed.constTree(), voxel, grid); });
    return status;
}

/* The grid of the file is freed before the caller's is used: both are counted in read_bytes. */
iso_status vdb_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_grid *grid,
                    iso_error *error) {
    iso_grid result = {};
    const iso_status status = iso::guard(path, error, [&] {
        GridBase::ConstPtr source;
        ISO_TRY(load_chosen(path, *info, &source, error));
        ISO_TRY(iso_format_progress(path, opts, 0.6, error));
        read_job job = {path, opts->pool, info, Coord(), error};
        ISO_TRY(announced_box(path, *source, *info, &job.lo, error));
        return info->sparse ? read_sparse(job, *source, &result) : read_dense(job, *source, &result);
    });
    if (status == ISO_OK)
        *grid = result;
    else
        iso_grid_destroy(&result);
    return status;
}

const iso_format format = {"vdb", "OpenVDB", nullptr, vdb_info, vdb_read};

} // namespace

ISO_MODULE(&format, nullptr, iso_vdb_write_level_set);
