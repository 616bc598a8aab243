/* vdb_lengths: checks the lengths that are stored before the strings and metadata of a .vdb file.
 *
 * OpenVDB allocates as much memory as a length says, up to 4 GB, before it reads. Each function walks over
 * what OpenVDB is about to read and then resets the stream. It throws std::ios_base::failure where the file
 * ends first (the stream must do so as well) and openvdb::IoError where lengths contradict one another or the
 * headers take more memory than any right file's do. */
#ifndef ISO_GRIDS_VOLUME_VDB_LENGTHS_HPP
#define ISO_GRIDS_VOLUME_VDB_LENGTHS_HPP

#include <cstdint>
#include <istream>
#include <string>

class vdb_lengths {
  public:
    /* The stream is borrowed; `size` is the file's. */
    vdb_lengths(std::istream &stream, std::streamoff size) : stream_(stream), size_(size) {}

    void check_metadata();   /* of the file or of a grid */
    void check_descriptor(); /* the names before a grid's offsets */
    void check_transform();

  private:
    std::istream &stream_;
    std::streamoff size_;
    uint64_t memory_ = 0; /* estimated memory of the headers */

    uint32_t take_number();
    void pass(uint64_t bytes);
    uint32_t pass_string();
    std::string take_string();
    void take_memory(uint64_t bytes);
    void pass_value(const std::string &type);
    void pass_leaf_sizes(uint64_t bytes);
    void pass_packed(uint64_t bytes, uint64_t unpacked);
};

#endif
