/* vdb_archive: the grids of a .vdb file, read through a stream that throws on errors. Not through
 * openvdb::io::File, which ignores short reads, so that values are undefined, and whose delayed loading maps
 * files that may be truncated later.
 *
 * What OpenVDB would believe is checked before: lengths of strings and metadata (vdb_lengths.hpp), the layout
 * of trees and the memory that they take (vdb_check.h). Functions throw what OpenVDB and the stream throw. */
#ifndef ISO_GRIDS_VOLUME_VDB_ARCHIVE_HPP
#define ISO_GRIDS_VOLUME_VDB_ARCHIVE_HPP

#include <fstream>
#include <string>
#include <vector>

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include "grids/volume/format.h"
#include "grids/volume/vdb_lengths.hpp"

namespace iso::vdb {

/* One grid of a file. */
struct vdb_grid {
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid; /* metadata and transform; the tree when `loaded` */
    bool loaded = false;
    std::streamoff tree = 0; /* position of the tree in the file */
    uint32_t compression = 0;

    std::string name() const { return openvdb::io::GridDescriptor::nameAsString(descriptor.uniqueName()); }
};

using real_grids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid>;
using scalar_grids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                       openvdb::Int64Grid, openvdb::BoolGrid, openvdb::MaskGrid>;
using vector_grids = openvdb::TypeList<openvdb::Vec3SGrid, openvdb::Vec3DGrid, openvdb::Vec3IGrid>;

/* Initialises OpenVDB, and keeps it to the thread that calls it: it counts and prunes by TBB, which ends the
 * program where no thread can be made. Threads that are asked for are the pool's. */
void initialize();

bool is_points(const openvdb::GridBase &grid);
bool is_scalar(const openvdb::GridBase &grid);
bool is_vector(const openvdb::GridBase &grid);
bool is_level_set(const openvdb::GridBase &grid);

/* Lists grids and reads their trees, within the memory that the options allow. */
class archive : public openvdb::io::Archive {
  public:
    archive(const char *path, const iso_volume_opts *opts);
    std::vector<vdb_grid> grids;
    /* Lists the grids. */
    iso_status scan(iso_error *error);
    /* Reads the tree of a grid of numbers; with `topology` only the positions of its voxels, not their
     * values. */
    iso_status load(vdb_grid &entry, bool topology, iso_error *error);
    /* The size in memory and the number of leaves of the tree of a grid of numbers, without reading it. */
    iso_status measure(const vdb_grid &entry, uint64_t *bytes, uint64_t *leaves, iso_error *error);

  private:
    const char *path_; /* borrowed */
    /* OpenVDB's stream state points to this member, which therefore must not move. */
    openvdb::io::StreamMetadata::Ptr metadata_{new openvdb::io::StreamMetadata};
    std::ifstream stream_;
    const iso_volume_opts *opts_; /* borrowed */
    std::streamoff size_ = 0;
    vdb_lengths lengths_;
    uint64_t loaded_bytes_ = 0; /* of the trees that were read */
    iso_status check_magic(iso_error *error);
    iso_status next_grid(bool *more, iso_error *error);
    iso_status next_of_stream(vdb_grid &entry, bool *more, iso_error *error);
    void read_header_of(vdb_grid &entry);
    iso_status check_tree(const vdb_grid &entry, bool streamed, iso_error *error);
    vdb_grid &parent_of(const vdb_grid &entry);
};

} // namespace iso::vdb

#endif
