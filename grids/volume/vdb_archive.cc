/* vdb_archive: lists and reads the grids of a .vdb file with OpenVDB's stream functions, and adds the checks
 * that OpenVDB lacks. */
#include "grids/volume/vdb_archive.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include <openvdb/points/PointDataGrid.h>
#include <tbb/global_control.h>

#include "grids/volume/vdb_check.h"

namespace iso::vdb {

using openvdb::GridBase;

void initialize() {
    static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    openvdb::initialize();
}

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

namespace {

/* Opens the stream at the file's beginning; returns the file's size. */
std::streamoff open_stream(const char *path, std::ifstream &stream) {
    stream.open(path, std::ios_base::binary);
    if (!stream) OPENVDB_THROW(openvdb::IoError, "cannot open the file");
    stream.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
    stream.seekg(0, std::ios_base::end);
    const std::streamoff size = stream.tellg();
    stream.seekg(0);
    return size;
}

} // namespace

archive::archive(const char *path, const iso_volume_opts *opts)
    : path_(path), opts_(opts), size_(open_stream(path, stream_)), lengths_(stream_, size_) {}

iso_status archive::scan(iso_error *error) {
    ISO_TRY(check_magic(error));
    readHeader(stream_);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    openvdb::io::setStreamMetadataPtr(stream_, metadata_, /*transfer=*/false);
    lengths_.check_metadata();
    openvdb::MetaMap().readMeta(stream_);
    bool more = true;
    for (int32_t count = readGridCount(stream_); more && count > 0; count--) ISO_TRY(next_grid(&more, error));
    return ISO_OK;
}

/* Checks the magic number and the version. A file that begins with a part of the magic number is truncated;
 * any other is not a .vdb. Files before version 222 have other layouts, and those of later versions unknown
 * ones. */
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
    lengths_.check_descriptor();
    entry.grid = entry.descriptor.read(stream_);
    if (!inputHasGridOffsets()) return next_of_stream(entry, more, error);
    const std::streamoff here = stream_.tellg(), grid = entry.descriptor.getGridPos();
    const std::streamoff blocks = entry.descriptor.getBlockPos(), end = entry.descriptor.getEndPos();
    if (end > size_) throw std::ios_base::failure("ends early");
    const bool ordered = entry.descriptor.isInstance() || (grid <= blocks && blocks <= end);
    if (grid < here || end < grid || !ordered) OPENVDB_THROW(openvdb::IoError, "grid offsets are wrong");
    stream_.seekg(grid);
    read_header_of(entry);
    if (stream_.tellg() > end) OPENVDB_THROW(openvdb::IoError, "a grid's header is longer than the grid");
    grids.push_back(entry);
    stream_.seekg(end);
    return ISO_OK;
}

/* Reads a grid of a file without grid offsets (written as a stream), to find the next one. A grid that cannot
 * be checked is not read, and the grids after it are not found. */
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
    lengths_.check_metadata();
    entry.grid->readMeta(stream_);
    lengths_.check_transform();
    entry.grid->readTransform(stream_);
    entry.tree = stream_.tellg();
    entry.compression = openvdb::io::getDataCompression(stream_);
}

static int value_bytes(const GridBase &grid) {
    int bytes = 0;
    const auto size = [&](const auto &typed) {
        using grid_type = std::decay_t<decltype(typed)>;
        bytes = static_cast<int>(sizeof(typename grid_type::ValueType));
    };
    if (!grid.apply<scalar_grids>(size)) grid.apply<vector_grids>(size);
    return bytes;
}

/* The layout of the tree of a grid whose header was read. */
static iso_vdb_layout layout_of(const vdb_grid &entry, bool streamed) {
    const GridBase &grid = *entry.grid;
    iso_vdb_layout layout = {};
    layout.value_bytes = layout.stored_bytes = value_bytes(grid);
    if (grid.saveFloatAsHalf() && grid.apply<real_grids>([](const auto &) {})) layout.stored_bytes = 2;
    if (grid.saveFloatAsHalf() && is_vector(grid) && !grid.isType<openvdb::Vec3IGrid>())
        layout.stored_bytes = 6;
    layout.leaf = grid.isType<openvdb::BoolGrid>()   ? ISO_VDB_BOOLS
                  : grid.isType<openvdb::MaskGrid>() ? ISO_VDB_MASK
                                                     : ISO_VDB_VALUES;
    layout.blosc = entry.compression & openvdb::io::COMPRESS_BLOSC;
    layout.compressed = layout.blosc || (entry.compression & openvdb::io::COMPRESS_ZIP);
    layout.active_only = entry.compression & openvdb::io::COMPRESS_ACTIVE_MASK;
    layout.topology = static_cast<uint64_t>(entry.tree);
    layout.blocks = streamed ? 0 : static_cast<uint64_t>(entry.descriptor.getBlockPos());
    layout.end = streamed ? 0 : static_cast<uint64_t>(entry.descriptor.getEndPos());
    return layout;
}

/* The size of a leaf in memory: values, mask, origin, pointers and the overhead of the heap. */
static size_t leaf_bytes(const GridBase &grid) {
    return 512 * static_cast<size_t>(value_bytes(grid)) + 160;
}

/* The size of a tree in memory. Inner nodes have a value or a pointer for each child, and two masks. */
static uint64_t bytes_of(const GridBase &grid, const iso_vdb_nodes &nodes) {
    const uint64_t slot = std::max<uint64_t>(8, static_cast<uint64_t>(value_bytes(grid)));
    return nodes.leaves * leaf_bytes(grid) + nodes.lower * (4096 * slot + 1200) +
           nodes.upper * (32768 * slot + 8400) + nodes.tiles * (slot + 80);
}

/* Checks that a tree is laid out correctly, and that it fits into the memory limit. */
iso_status archive::check_tree(const vdb_grid &entry, bool streamed, iso_error *error) {
    const iso_vdb_layout layout = layout_of(entry, streamed);
    iso_vdb_nodes nodes;
    ISO_TRY(iso_vdb_count(path_, &layout, &nodes, error));
    loaded_bytes_ += bytes_of(*entry.grid, nodes);
    ISO_TRY(iso_format_check_memory(path_, opts_, loaded_bytes_, "its grids", error));
    return iso_vdb_check(path_, &layout, error);
}

iso_status archive::measure(const vdb_grid &entry, uint64_t *bytes, uint64_t *leaves, iso_error *error) {
    if (entry.descriptor.isInstance()) return measure(parent_of(entry), bytes, leaves, error);
    if (entry.loaded) {
        *bytes = loaded_bytes_; /* includes the trees before it, which are also in memory */
        *leaves = entry.grid->constBaseTree().leafCount();
        return ISO_OK;
    }
    iso_vdb_nodes nodes;
    const iso_vdb_layout layout = layout_of(entry, false);
    ISO_TRY(iso_vdb_count(path_, &layout, &nodes, error));
    *bytes = bytes_of(*entry.grid, nodes);
    *leaves = nodes.leaves;
    return ISO_OK;
}

/* The grid whose tree an instance grid shares. */
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

} // namespace iso::vdb
