/* format_npy: arrays of NumPy with three axes, z y x, or with four, of which the last one has the
 * components of a voxel. The axes are the same in Fortran order, in which the file has the first one
 * fastest. Arrays of two axes are points (src/io/glyphs/npy.c). */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/npy_header.h"

static iso_status fail_end(const char *path, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends in its header", path);
}

static iso_status read_header(const char *path, FILE *file, iso_npy_header *header, iso_error *error) {
    unsigned char head[ISO_NPY_HEAD];
    if (fread(head, 1, sizeof head, file) != sizeof head) return fail_end(path, error);
    ISO_TRY(iso_npy_begin(path, head, header, error));
    char *text = calloc(1, header->text_bytes + 1);
    if (!text) return iso_fail_memory(error, path);
    iso_status status = ISO_OK;
    if (fseek(file, (long)header->text_at, SEEK_SET) != 0 ||
        fread(text, 1, header->text_bytes, file) != header->text_bytes)
        status = fail_end(path, error);
    if (status == ISO_OK) status = iso_npy_parse(path, text, header, error);
    free(text);
    return status;
}

/* A file that is opened, with its header. */
static iso_status open_npy(const char *path, FILE **file, iso_npy_header *header, iso_error *error) {
    ISO_TRY(iso_file_open(path, file, NULL, error));
    const iso_status status = read_header(path, *file, header, error);
    if (status != ISO_OK) fclose(*file);
    return status;
}

static int components_of(const iso_npy_header *header) {
    return header->axes == 4 ? (int)header->shape[3] : 1;
}

static iso_status check_axes(const char *path, const iso_npy_header *header, iso_error *error) {
    enum { COMPONENTS = 16 };
    if (header->axes == 3) return ISO_OK;
    if (header->axes != 4)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: has %d axes: a volume has three, z y x, or four with components", path,
                        header->axes);
    if (header->shape[3] >= 1 && header->shape[3] <= COMPONENTS) return ISO_OK;
    return iso_fail(
        error, ISO_ERR_FORMAT,
        "%s: has four axes, and the last one, for the components of a voxel, has %llu: save one volume "
        "of them",
        path, (unsigned long long)header->shape[3]);
}

/* The bytes of all numbers; UINT64_MAX: too many. */
static uint64_t bytes_of(const iso_npy_header *header) {
    uint64_t bytes = iso_scalar_size(header->scalar);
    for (int axis = 0; axis < header->axes; axis++)
        if (__builtin_mul_overflow(bytes, header->shape[axis], &bytes)) return UINT64_MAX;
    return bytes;
}

static iso_status describe(const char *path, const iso_volume_opts *opts, const iso_npy_header *header,
                           iso_volume_info *info, iso_error *error) {
    const uint64_t position = header->text_at + header->text_bytes, wanted = bytes_of(header);
    uint64_t dims[3], bytes = 0;
    ISO_TRY(check_axes(path, header, error));
    for (int i = 0; i < 3; i++) dims[i] = header->shape[2 - i];
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(iso_format_component(path, opts, components_of(header), info, error));
    ISO_TRY(iso_format_file_bytes(path, &bytes, error));
    if (bytes < position || bytes - position < wanted)
        return iso_format_truncated(path, bytes,
                                    wanted > UINT64_MAX - position ? UINT64_MAX : wanted + position, error);
    info->type = iso_scalar_stored_type(header->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(header->scalar));
    iso_volume_note(info, "no voxel size is stated: 1 mm is assumed (--spacing)");
    if (header->fortran) return ISO_OK;
    *opts->place = (iso_format_place){.known = true,
                                      .swap = header->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__),
                                      .scalar = header->scalar,
                                      .position = position};
    iso_format_place_room(opts->place, info);
    return ISO_OK;
}

static iso_status npy_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    iso_npy_header header;
    FILE *file;
    ISO_TRY(open_npy(path, &file, &header, error));
    fclose(file);
    return describe(path, opts, &header, info, error);
}

/* ---- Fortran order: z is the fastest axis, then y, x and the component */

/* A plane of the file, of one x: numbers as they are stored, and as the grid has them. */
typedef struct plane {
    void *raw, *converted;
} plane;

/* Distributes a plane to the voxels of its x. */
static void place_plane(const iso_rgrid *grid, int x, const char *values) {
    const size_t size = iso_type_size(grid->type), rows = (size_t)grid->dims[2];
    for (int y = 0; y < grid->dims[1]; y++)
        for (int z = 0; z < grid->dims[2]; z++)
            memcpy((char *)grid->data +
                       ((size_t)x + (size_t)y * (size_t)grid->stride_y + (size_t)z * (size_t)grid->stride_z) *
                           size,
                   values + ((size_t)y * rows + (size_t)z) * size, size);
}

static iso_status read_planes(const char *path, FILE *file, const iso_volume_opts *opts,
                              const iso_npy_header *header, const iso_volume_info *info, const plane *p,
                              iso_rgrid *grid, iso_error *error) {
    const size_t count = (size_t)grid->dims[1] * (size_t)grid->dims[2],
                 size = iso_scalar_size(header->scalar);
    const uint64_t skipped = (uint64_t)info->component * count * size * (uint64_t)grid->dims[0];
    const iso_scalar_source source = {.data = p->raw,
                                      .scalar = header->scalar,
                                      .components = 1,
                                      .swap = header->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)};
    if (fseeko(file, (off_t)(header->text_at + header->text_bytes + skipped), SEEK_SET) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    for (int x = 0; x < grid->dims[0]; x++) {
        if (fread(p->raw, size, count, file) != count)
            return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
        iso_scalar_convert(&source, count, grid->type, p->converted);
        place_plane(grid, x, p->converted);
        ISO_TRY(iso_format_progress(path, opts, (double)(x + 1) / grid->dims[0], error));
    }
    return ISO_OK;
}

static iso_status read_fortran(const char *path, FILE *file, const iso_volume_opts *opts,
                               const iso_npy_header *header, const iso_volume_info *info, iso_grid *grid,
                               iso_error *error) {
    const size_t count = (size_t)info->dims[1] * (size_t)info->dims[2];
    for (int i = 0; i < 3; i++)
        if (header->shape[2 - i] != (uint64_t)info->dims[i])
            return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    ISO_TRY(iso_format_create(path, info, NULL, grid, error));
    const plane p = {iso_alloc(count * iso_scalar_size(header->scalar)),
                     iso_alloc(count * iso_type_size(info->type))};
    const iso_status status = p.raw && p.converted
                                  ? read_planes(path, file, opts, header, info, &p, grid->rgrid, error)
                                  : iso_fail_memory(error, path);
    iso_free(p.raw);
    iso_free(p.converted);
    return status;
}

static iso_status npy_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    iso_npy_header header;
    FILE *file;
    ISO_TRY(open_npy(path, &file, &header, error));
    const iso_status status = read_fortran(path, file, opts, &header, info, grid, error);
    fclose(file);
    return status;
}

const iso_format iso_format_npy = {"npy", "isopoint", NULL, npy_info, npy_read, NULL};
