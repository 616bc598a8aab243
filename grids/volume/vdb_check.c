/* vdb_check: walks over the nodes of a tree in the order in which OpenVDB's readTopology and readBuffers read
 * them, without decompressing anything. */
#include "grids/volume/vdb_check.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

/* Numbers of values in a node (leaf 8^3, lower 16^3, upper 32^3); a mask has a bit for each. */
enum { LEAF_VALUES = 1 << 9, LOWER_VALUES = 1 << 12, UPPER_VALUES = 1 << 15, MASK_ROOM = UPPER_VALUES / 8 };

/* Most steps of a walk are short: they stay within a buffer. */
enum { BUFFER = 1 << 18 };

typedef struct walk {
    const iso_vdb_layout *layout;
    FILE *stream;
    uint8_t *buffer;
    size_t at, filled;
    uint64_t begin, size; /* position of the buffer in the file; size of the file */
    iso_vdb_nodes nodes;
    bool cut, corrupt;
} walk;

static bool cut_off(walk *w) {
    w->cut = true;
    return false;
}

static bool is_corrupt(walk *w) {
    w->corrupt = true;
    return false;
}

static uint64_t position(const walk *w) {
    return w->begin + w->at;
}

static bool seek(walk *w, uint64_t to) {
    if (to > w->size) return cut_off(w);
    if (to >= w->begin && to <= w->begin + w->filled) {
        w->at = (size_t)(to - w->begin);
        return true;
    }
    w->begin = to;
    w->at = w->filled = 0;
    return fseeko(w->stream, (off_t)to, SEEK_SET) == 0 || cut_off(w);
}

static bool skip(walk *w, uint64_t count) {
    return count <= w->size - position(w) ? seek(w, position(w) + count) : cut_off(w);
}

static bool take_bytes(walk *w, void *bytes, size_t count) {
    for (size_t done = 0; done < count;) {
        if (w->at == w->filled) {
            w->begin += w->filled;
            w->at = 0;
            w->filled = fread(w->buffer, 1, BUFFER, w->stream);
            if (w->filled == 0) return cut_off(w);
        }
        size_t part = w->filled - w->at < count - done ? w->filled - w->at : count - done;
        memcpy((char *)bytes + done, w->buffer + w->at, part);
        w->at += part;
        done += part;
    }
    return true;
}

/* Reads a number in the machine's byte order, as OpenVDB writes it; OpenVDB supports only little-endian
 * machines. */
static bool take_count(walk *w, uint32_t *count) {
    return take_bytes(w, count, sizeof *count);
}

/* ---- values ---- */

/* The kinds of blocks, by what they store for inactive voxels (OpenVDB's io/Compression.h). */
enum block_kind { BACKGROUND, NEGATIVE, ONE_VALUE, MASK, MASK_ONE_VALUE, MASK_TWO_VALUES, ALL_VALUES };

/* Checks the header of a Blosc chunk, which states its compressed and uncompressed sizes; Blosc itself does
 * not check them. */
static bool check_blosc(walk *w, uint64_t length, uint64_t bytes) {
    uint32_t head[4];
    uint64_t start = position(w);
    if (length < sizeof head) return is_corrupt(w);
    if (!take_bytes(w, head, sizeof head)) return false;
    if (head[1] != bytes || head[3] != length) return is_corrupt(w);
    return seek(w, start) && skip(w, length);
}

/* Checks and skips a block of `count` values: uncompressed, or, in compressed files, after a length, which is
 * not positive if the values are uncompressed nevertheless. */
static bool check_values(walk *w, uint64_t count) {
    uint64_t bytes = count * (uint64_t)w->layout->stored_bytes;
    if (!w->layout->compressed) return skip(w, bytes);
    if (count == 0 && w->layout->stored_bytes < w->layout->value_bytes) return true;
    int64_t length;
    if (!take_bytes(w, &length, sizeof length)) return false;
    if (length <= 0) return (uint64_t)0 - (uint64_t)length == bytes ? skip(w, bytes) : is_corrupt(w);
    return w->layout->blosc ? check_blosc(w, (uint64_t)length, bytes) : skip(w, (uint64_t)length);
}

static uint64_t count_bits(const uint8_t *mask, size_t bytes) {
    uint64_t count = 0, word;
    for (size_t i = 0; i < bytes; i += sizeof word) {
        memcpy(&word, mask + i, sizeof word);
        count += (uint64_t)__builtin_popcountll(word);
    }
    return count;
}

/* Checks and skips the values of a node with `room` values, of which those in `mask` are active. */
static bool check_block(walk *w, const uint8_t *mask, uint64_t room) {
    uint8_t kind;
    if (!take_bytes(w, &kind, 1)) return false;
    if (kind > ALL_VALUES) return is_corrupt(w);
    uint64_t values = kind == MASK_TWO_VALUES ? 2 : kind == ONE_VALUE || kind == MASK_ONE_VALUE;
    bool has_mask = kind == MASK || kind == MASK_ONE_VALUE || kind == MASK_TWO_VALUES;
    if (!skip(w, values * (uint64_t)w->layout->value_bytes + (has_mask ? room / 8 : 0))) return false;
    bool all = kind == ALL_VALUES || !w->layout->active_only;
    return check_values(w, all ? room : count_bits(mask, room / 8));
}

/* ---- nodes ---- */

/* Checks and skips an inner node: its masks of children and of active values, then its values. *children: the
 * number of its children. */
static bool check_inner(walk *w, uint64_t room, uint64_t *children) {
    uint8_t child_mask[MASK_ROOM], value_mask[MASK_ROOM];
    if (!take_bytes(w, child_mask, room / 8) || !take_bytes(w, value_mask, room / 8)) return false;
    *children = count_bits(child_mask, room / 8);
    return check_block(w, value_mask, room);
}

static bool check_upper(walk *w) {
    uint64_t lower, leaves;
    if (!check_inner(w, UPPER_VALUES, &lower)) return false;
    w->nodes.upper++;
    w->nodes.lower += lower;
    for (uint64_t i = 0; i < lower; i++) {
        if (!check_inner(w, LOWER_VALUES, &leaves) || !skip(w, leaves * LEAF_VALUES / 8)) return false;
        w->nodes.leaves += leaves;
    }
    return true;
}

/* Checks the origin of a root's child: a multiple of its side, 4096 voxels. */
static bool check_origin(walk *w) {
    int32_t origin[3];
    if (!take_bytes(w, origin, sizeof origin)) return false;
    return (origin[0] | origin[1] | origin[2]) & 4095 ? is_corrupt(w) : true;
}

static bool check_topology(walk *w) {
    uint32_t buffers, tiles, children;
    const uint64_t value = (uint64_t)w->layout->value_bytes;
    if (!seek(w, w->layout->topology) || !take_count(w, &buffers)) return false;
    if (buffers != 1) return is_corrupt(w);
    if (!skip(w, value) || !take_count(w, &tiles) || !take_count(w, &children)) return false;
    w->nodes.tiles = tiles;
    for (uint32_t i = 0; i < tiles; i++) {
        uint8_t active;
        if (!check_origin(w) || !skip(w, value) || !take_bytes(w, &active, 1)) return false;
        if (active > 1) return is_corrupt(w);
    }
    for (uint32_t i = 0; i < children; i++)
        if (!check_origin(w) || !check_upper(w)) return false;
    return !w->layout->blocks || position(w) == w->layout->blocks || is_corrupt(w);
}

static bool check_leaf(walk *w) {
    uint8_t mask[LEAF_VALUES / 8];
    if (!take_bytes(w, mask, sizeof mask)) return false;
    switch (w->layout->leaf) {
    case ISO_VDB_BOOLS:
        return skip(w, 12 + sizeof mask); /* the origin, and one bit per voxel */
    case ISO_VDB_MASK:
        return skip(w, 12);
    default:
        return check_block(w, mask, LEAF_VALUES);
    }
}

static bool check_tree(walk *w) {
    const iso_vdb_layout *layout = w->layout;
    if (!check_topology(w)) return false;
    for (uint64_t i = 0; i < w->nodes.leaves; i++)
        if (!check_leaf(w)) return false;
    return !layout->end || position(w) == layout->end || is_corrupt(w);
}

static iso_status run_check(const char *path, const iso_vdb_layout *layout, bool (*check)(walk *w),
                            iso_vdb_nodes *nodes, iso_error *error) {
    walk w = {.layout = layout, .buffer = iso_alloc(BUFFER)};
    iso_status status =
        w.buffer ? iso_file_open(path, &w.stream, &w.size, error) : iso_fail_memory(error, path);
    if (status == ISO_OK) {
        w.begin = w.size;
        setvbuf(w.stream, NULL, _IONBF, 0);
        if (!check(&w))
            status = iso_fail(error, ISO_ERR_IO, "%s: %s", path,
                              w.cut ? "truncated: the file ends before its grids do"
                                    : "corrupt: a grid is not laid out as its header says");
    }
    if (w.stream) fclose(w.stream);
    iso_free(w.buffer);
    *nodes = w.nodes;
    return status;
}

iso_status iso_vdb_check(const char *path, const iso_vdb_layout *layout, iso_error *error) {
    iso_vdb_nodes nodes;
    return run_check(path, layout, check_tree, &nodes, error);
}

iso_status iso_vdb_count(const char *path, const iso_vdb_layout *layout, iso_vdb_nodes *nodes,
                         iso_error *error) {
    iso_vdb_nodes found;
    ISO_TRY(run_check(path, layout, check_topology, &found, error));
    *nodes = found;
    return ISO_OK;
}
