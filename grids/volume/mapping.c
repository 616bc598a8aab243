/* mapping: maps files, finds their holes, and makes temporary files. */
#include "grids/volume/mapping.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/temporary_file.h"

enum { MOST_EXTENTS = 1 << 20 };

/* Bytes first .. end - 1 of the mapped voxels that are not in a hole of the file. */
typedef struct extent {
    uint64_t first, end;
} extent;

struct iso_mapping {
    char *pages; /* the mapping: begins at a page */
    size_t length;
    char *data;        /* the voxels in it */
    uint64_t bytes;    /* of the voxels */
    iso_buffer extent; /* of extents, ascending; only if has_holes */
    size_t extents;
    bool has_holes;
};

/* ---- holes */

static iso_status add_extent(iso_mapping *mapping, uint64_t first, uint64_t end, iso_error *error) {
    const size_t used = mapping->extents * sizeof(extent);
    ISO_TRY(iso_buffer_reserve(&mapping->extent, used + sizeof(extent), used, error));
    ((extent *)mapping->extent.data)[mapping->extents++] = (extent){first, end};
    return ISO_OK;
}

/* Lists the extents of a file with holes. A file system that does not tell, or too many extents: as if there
 * were no holes. */
static void find_holes(int file, uint64_t start, iso_mapping *mapping) {
    struct stat info;
    if (fstat(file, &info) != 0 || (uint64_t)info.st_blocks * 512 >= (uint64_t)info.st_size) return;
    const off_t position = lseek(file, 0, SEEK_CUR), end = (off_t)(start + mapping->bytes);
    iso_status status = ISO_OK;
    for (off_t at = (off_t)start; at < end && status == ISO_OK && mapping->extents < MOST_EXTENTS;) {
        off_t first = lseek(file, at, SEEK_DATA);
        if (first < 0 && errno != ENXIO) status = ISO_ERR_IO;
        if (first < 0 || first >= end) break; /* ENXIO: a hole up to the end */
        at = lseek(file, first, SEEK_HOLE);
        if (at < 0) status = ISO_ERR_IO;
        if (status == ISO_OK)
            status =
                add_extent(mapping, (uint64_t)first - start, (uint64_t)(at < end ? at : end) - start, NULL);
    }
    mapping->has_holes = status == ISO_OK && mapping->extents < MOST_EXTENTS;
    lseek(file, position, SEEK_SET); /* the stream reads on from here */
}

/* Whether bytes first .. end - 1 all lie in holes. */
static bool in_hole(const iso_mapping *mapping, uint64_t first, uint64_t end) {
    const extent *extents = mapping->extent.data;
    size_t low = 0, high = mapping->extents; /* the first extent that ends after `first` */
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (extents[middle].end <= first)
            low = middle + 1;
        else
            high = middle;
    }
    return low == mapping->extents || extents[low].first >= end;
}

/* ---- mapping */

static iso_status map(const char *path, int file, uint64_t start, uint64_t bytes, bool writable,
                      iso_mapping **out, iso_error *error) {
    const uint64_t page = (uint64_t)sysconf(_SC_PAGESIZE), before = start % page;
    iso_mapping *mapping = iso_alloc_zero(1, sizeof *mapping);
    if (!mapping) return iso_fail_memory(error, path);
    mapping->length = (size_t)(bytes + before);
    mapping->pages = mmap(NULL, mapping->length, writable ? PROT_READ | PROT_WRITE : PROT_READ,
                          writable ? MAP_SHARED : MAP_PRIVATE, file, (off_t)(start - before));
    if (mapping->pages == MAP_FAILED) {
        const int code = errno;
        iso_free(mapping);
        if (code == ENOMEM) return iso_fail_memory(error, path);
        return iso_fail(error, ISO_ERR_IO, "%s: cannot be mapped into memory: %s", path, strerror(code));
    }
    mapping->data = mapping->pages + before;
    mapping->bytes = bytes;
    *out = mapping;
    return ISO_OK;
}

iso_status iso_mapping_of_file(const char *path, FILE *file, uint64_t bytes, iso_mapping **mapping,
                               iso_error *error) {
    struct stat info;
    const off_t start = ftello(file);
    if (start < 0 || fstat(fileno(file), &info) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    if (bytes > (uint64_t)INT64_MAX - (uint64_t)start || (uint64_t)info.st_size < (uint64_t)start + bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: %llu of %llu bytes", path,
                        (unsigned long long)info.st_size, (unsigned long long)((uint64_t)start + bytes));
    ISO_TRY(map(path, fileno(file), (uint64_t)start, bytes, false, mapping, error));
    find_holes(fileno(file), (uint64_t)start, *mapping);
    return ISO_OK;
}

iso_status iso_mapping_of_new_file(const char *path, uint64_t bytes, iso_mapping **mapping,
                                   iso_error *error) {
    const int file = iso_temporary_file_create(bytes);
    if (file < 0)
        return iso_fail(error, ISO_ERR_WRITE, "%s: cannot unpack %s here: %s%s", iso_temporary_folder(), path,
                        strerror(-file), file == -ENOSPC ? " (TMPDIR chooses another folder)" : "");
    const iso_status status = map(path, file, 0, bytes, true, mapping, error);
    close(file);
    return status;
}

void *iso_mapping_data(const iso_mapping *mapping) {
    return mapping->data;
}

void iso_mapping_destroy(void *owner) {
    iso_mapping *mapping = owner;
    munmap(mapping->pages, mapping->length);
    iso_buffer_free(&mapping->extent);
    iso_free(mapping);
}

/* ---- chunks */

static const iso_mapping *mapping_of(const iso_rgrid *grid) {
    return grid->release == iso_mapping_destroy ? grid->owner : NULL;
}

/* The bytes of voxels x0 .. x1 - 1 of the rows y0 .. y1 - 1 of a slice, and those between them. */
static bool rows_in_hole(const iso_rgrid *grid, const int first[3], const int end[3], int z) {
    const iso_mapping *mapping = mapping_of(grid);
    const ptrdiff_t size = (ptrdiff_t)iso_type_size(grid->type),
                    low = first[0] + first[1] * grid->stride_y + z * grid->stride_z,
                    high = end[0] + (end[1] - 1) * grid->stride_y + z * grid->stride_z;
    const ptrdiff_t start = (const char *)grid->data - mapping->data;
    return in_hole(mapping, (uint64_t)(start + low * size), (uint64_t)(start + high * size));
}

static bool slice_in_hole(const iso_rgrid *grid, const int first[3], const int end[3], int z) {
    if (rows_in_hole(grid, first, end, z)) return true;
    for (int y = first[1]; y < end[1]; y++)
        if (!rows_in_hole(grid, (const int[3]){first[0], y, 0}, (const int[3]){end[0], y + 1, 0}, z))
            return false;
    return true;
}

static bool is_zero(void *context, const iso_grid_chunk *chunk, float *value) {
    const iso_rgrid *grid = context;
    int first[3], end[3];
    iso_grid_chunk_voxels(chunk, first, end);
    for (int z = first[2]; z < end[2]; z++)
        if (!slice_in_hole(grid, first, end, z)) return false;
    *value = 0;
    return true;
}

static void drop_pages(void *context) {
    const iso_mapping *mapping = mapping_of(context);
    madvise(mapping->pages, mapping->length, MADV_DONTNEED);
}

iso_chunk_source iso_mapping_source(const iso_rgrid *grid) {
    iso_chunk_source source = iso_chunk_source_of(grid);
    const iso_mapping *mapping = mapping_of(grid);
    if (!mapping) return source;
    source.rest = drop_pages;
    if (mapping->has_holes) source.is_constant = is_zero;
    return source;
}
