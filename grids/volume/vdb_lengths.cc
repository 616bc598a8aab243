/* vdb_lengths: walks over strings, MetaMap, GridDescriptor, Transform and DelayedLoadMetadata in the order in
 * which OpenVDB's read functions read them. */
#include "grids/volume/vdb_lengths.hpp"

#include <algorithm>

#include <openvdb/Exceptions.h>
#include <openvdb/Metadata.h>

namespace {

/* Memory of a metadata entry and of a grid in addition to their bytes; largest memory for all headers of a
 * file, enough for about ten thousand grids. */
constexpr uint64_t entry_bytes = 200, grid_bytes = 3000, most_bytes = uint64_t{32} << 20;

/* The longest name of a type or a map; OpenVDB has no longer ones. */
constexpr uint32_t longest_type = 256;

[[noreturn]] void fail(const char *what) {
    throw openvdb::IoError(what);
}

} // namespace

uint32_t vdb_lengths::take_number() {
    uint32_t number = 0;
    stream_.read(reinterpret_cast<char *>(&number),
                 sizeof number); /* in the machine's byte order, as OpenVDB writes it */
    return number;
}

void vdb_lengths::pass(uint64_t bytes) {
    const std::streamoff here = stream_.tellg();
    if (here > size_ || bytes > static_cast<uint64_t>(size_ - here))
        throw std::ios_base::failure("ends early");
    stream_.seekg(here + static_cast<std::streamoff>(bytes));
}

void vdb_lengths::take_memory(uint64_t bytes) {
    memory_ += bytes;
    if (memory_ > most_bytes) fail("its headers take more than 32 MB");
}

uint32_t vdb_lengths::pass_string() {
    const uint32_t length = take_number();
    pass(length);
    take_memory(2 * uint64_t{length}); /* OpenVDB makes a copy of each string */
    return length;
}

std::string vdb_lengths::take_string() {
    const std::streamoff here = stream_.tellg();
    const uint32_t length = pass_string();
    std::string text(length, 0);
    stream_.seekg(here + static_cast<std::streamoff>(sizeof length));
    if (length > 0) stream_.read(&text[0], length);
    return text;
}

void vdb_lengths::check_metadata() {
    const std::streamoff begin = stream_.tellg();
    const uint32_t count = take_number();
    for (uint32_t i = 0; i < count; i++) {
        pass_string();
        pass_value(take_string());
        take_memory(entry_bytes);
    }
    stream_.seekg(begin);
}

/* Checks and skips a metadata value. OpenVDB reads a value of a known type by the type's size, whatever size
 * is stated. */
void vdb_lengths::pass_value(const std::string &type) {
    const uint32_t bytes = take_number();
    const std::streamoff begin = stream_.tellg();
    pass(bytes);
    take_memory(bytes);
    if (type == "string" || !openvdb::Metadata::isRegisteredType(type)) return;
    if (type == "__delayedload") {
        stream_.seekg(begin);
        if (bytes > 0) pass_leaf_sizes(bytes);
        if (stream_.tellg() > begin + static_cast<std::streamoff>(bytes)) fail("metadata of a wrong size");
        stream_.seekg(begin + static_cast<std::streamoff>(bytes));
    } else if (openvdb::Metadata::createMetadata(type)->size() != bytes) {
        fail("metadata of a wrong size");
    }
}

/* Checks and skips DelayedLoadMetadata: a byte and a number for every leaf, uncompressed or as Blosc chunks.
 * Their number is limited, as each leaf takes at least 64 bytes of the file. */
void vdb_lengths::pass_leaf_sizes(uint64_t bytes) {
    if (bytes < 12) fail("metadata of a wrong size");
    const uint64_t leaves = take_number();
    if (leaves > static_cast<uint64_t>(size_) / 64)
        fail("metadata of more leaves than the file has room for");
    take_memory(9 * leaves);
    pass_packed(take_number(), leaves);
    const uint32_t sizes = take_number();
    if (sizes != UINT32_MAX) pass_packed(sizes, 8 * leaves);
}

/* Checks and skips a Blosc chunk. It states its compressed and uncompressed sizes, which Blosc does not
 * check. OpenVDB pads short values to 128 bytes. */
void vdb_lengths::pass_packed(uint64_t bytes, uint64_t unpacked) {
    if (bytes == 0) return pass(unpacked);
    const std::streamoff begin = stream_.tellg();
    pass(bytes);
    if (bytes < 16) fail("metadata of a wrong size");
    stream_.seekg(begin + std::streamoff{4});
    const uint32_t stated = take_number();
    take_number(); /* size of a Blosc block: not checked */
    if (stated != std::max<uint64_t>(unpacked, 128) || take_number() != bytes)
        fail("metadata of a wrong size");
    stream_.seekg(begin + static_cast<std::streamoff>(bytes));
}

void vdb_lengths::check_descriptor() {
    const std::streamoff begin = stream_.tellg();
    pass_string();
    if (pass_string() > longest_type) fail("a grid's type has an impossible name");
    pass_string(); /* name of the grid whose tree an instance shares */
    take_memory(grid_bytes);
    stream_.seekg(begin);
}

void vdb_lengths::check_transform() {
    const std::streamoff begin = stream_.tellg();
    const uint32_t length = take_number();
    if (length > longest_type) fail("a transform has an impossible name");
    stream_.seekg(begin);
    if (take_string() == "NonlinearFrustumMap") {
        pass(8 * sizeof(double)); /* its box, taper and depth; then another transform */
        if (take_number() > longest_type) fail("a transform has an impossible name");
    }
    stream_.seekg(begin);
}
