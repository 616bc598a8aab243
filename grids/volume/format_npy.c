/* format_npy: arrays of NumPy with three axes, z y x, or with four, of which the last one has the
 * components of a voxel. The axes are the same in Fortran order, in which the file has the first one
 * fastest. Arrays of two axes are points (src/io/glyphs/npy.c). In .npz, a ZIP archive, are several of them,
 * stored or deflated. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "base/zip.h"
#include "grids/volume/mapping.h"
#include "grids/volume/npy_header.h"

/* An array that is open behind its header. close_npy when done. */
typedef struct npy {
    const char *path;
    FILE *file;
    uint64_t at, bytes;     /* of the array with its header: where it begins, and its size when unpacked */
    iso_inflater *inflater; /* NULL: the file has it as it is */
    uint64_t left;          /* bytes that have not been unpacked yet */
    uint32_t wanted, crc;   /* CRC-32 of all bytes as the archive states it; of those unpacked so far */
    iso_npy_header header;
} npy;

static iso_status fail_end(const char *path, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends in its header", path);
}

static iso_status unpack(npy *n, void *target, size_t bytes, iso_error *error) {
    ISO_TRY(iso_inflater_fill(n->inflater, target, bytes, error));
    n->crc = (uint32_t)crc32_z(n->crc, target, bytes);
    n->left -= bytes;
    if (n->left > 0 || n->crc == n->wanted) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: the checksum of an array is wrong", n->path);
}

static iso_status fill(void *context, void *target, size_t bytes, iso_error *error) {
    npy *n = context;
    if (n->inflater) return unpack(n, target, bytes, error);
    if (fread(target, 1, bytes, n->file) == bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", n->path,
                    ferror(n->file) ? strerror(errno) : "changed while it was read");
}

static iso_status read_header(npy *n, iso_error *error) {
    unsigned char head[ISO_NPY_HEAD];
    iso_npy_header *header = &n->header;
    if (n->bytes < sizeof head) return fail_end(n->path, error);
    ISO_TRY(fill(n, head, sizeof head, error));
    ISO_TRY(iso_npy_begin(n->path, head, header, error));
    const size_t had = sizeof head - header->text_at; /* of the text */
    if (header->text_bytes < had || header->text_at + header->text_bytes > n->bytes)
        return fail_end(n->path, error);
    char *text = calloc(1, header->text_bytes + 1);
    if (!text) return iso_fail_memory(error, n->path);
    memcpy(text, head + header->text_at, had);
    iso_status status = fill(n, text + had, header->text_bytes - had, error);
    if (status == ISO_OK) status = iso_npy_parse(n->path, text, header, error);
    free(text);
    return status;
}

static void close_npy(npy *n) {
    iso_inflater_destroy(n->inflater);
    fclose(n->file);
}

/* Opens a file, or what is packed in one; `entry` NULL: all of it. */
static iso_status open_npy(const char *path, const iso_zip_entry *entry, uint64_t at, npy *n,
                           iso_error *error) {
    *n = (npy){.path = path};
    ISO_TRY(iso_file_open(path, &n->file, &n->bytes, error));
    iso_status status = ISO_OK;
    if (entry) {
        n->at = at;
        n->bytes = n->left = entry->size;
        n->wanted = entry->checksum;
        if (fseeko(n->file, (off_t)at, SEEK_SET) != 0)
            status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
        else if (entry->deflated)
            status = iso_inflater_create_bare(path, n->file, n->bytes, &n->inflater, error);
    }
    if (status == ISO_OK) status = read_header(n, error);
    if (status != ISO_OK) close_npy(n);
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

static iso_format_stream stream_of(npy *n, const iso_volume_info *info) {
    return (iso_format_stream){.fill = fill,
                               .context = n,
                               .scalar = n->header.scalar,
                               .components = info->components,
                               .component = info->component,
                               .swap = n->header.big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)};
}

static iso_status describe(npy *n, const iso_volume_opts *opts, iso_volume_info *info, iso_error *error) {
    const iso_npy_header *header = &n->header;
    const uint64_t position = header->text_at + header->text_bytes, wanted = bytes_of(header);
    uint64_t dims[3];
    ISO_TRY(check_axes(n->path, header, error));
    for (int i = 0; i < 3; i++) dims[i] = header->shape[2 - i];
    ISO_TRY(iso_format_dims(n->path, dims, info, error));
    ISO_TRY(iso_format_component(n->path, opts, components_of(header), info, error));
    if (n->bytes < position || n->bytes - position < wanted)
        return iso_format_truncated(n->path, n->bytes,
                                    wanted > UINT64_MAX - position ? UINT64_MAX : wanted + position, error);
    info->type = iso_scalar_stored_type(header->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(header->scalar));
    iso_volume_note(info, "no voxel size is stated: 1 mm is assumed (--spacing)");
    if (header->fortran) return ISO_OK;
    const iso_format_stream stream = stream_of(n, info);
    if (n->inflater)
        iso_format_stream_room(&stream, info);
    else
        iso_format_set_place(
            &(iso_format_place){
                .known = true, .swap = stream.swap, .scalar = header->scalar, .position = n->at + position},
            opts, info);
    return ISO_OK;
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

static iso_status read_planes(npy *n, const iso_volume_opts *opts, const iso_volume_info *info,
                              const plane *p, iso_rgrid *grid, iso_error *error) {
    const size_t count = (size_t)grid->dims[1] * (size_t)grid->dims[2];
    iso_scalar_source source = {.data = p->raw,
                                .scalar = n->header.scalar,
                                .components = 1,
                                .swap = n->header.big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)};
    const int64_t skipped = (int64_t)info->component * grid->dims[0];
    for (int64_t i = 0; i < skipped + grid->dims[0]; i++) {
        const int x = (int)(i - skipped);
        ISO_TRY(fill(n, p->raw, count * iso_scalar_size(source.scalar), error));
        if (x < 0) continue; /* of a component before */
        iso_scalar_convert(&source, count, grid->type, p->converted);
        place_plane(grid, x, p->converted);
        ISO_TRY(iso_format_progress(n->path, opts, (double)(x + 1) / grid->dims[0], error));
    }
    return ISO_OK;
}

static iso_status read_fortran(npy *n, const iso_volume_opts *opts, const iso_volume_info *info,
                               iso_grid *grid, iso_error *error) {
    const size_t count = (size_t)info->dims[1] * (size_t)info->dims[2];
    if (opts->mapped) ISO_TRY(iso_volume_check_memory(n->path, opts, info, error));
    ISO_TRY(iso_format_create(n->path, info, NULL, grid, error));
    const plane p = {iso_alloc(count * iso_scalar_size(n->header.scalar)),
                     iso_alloc(count * iso_type_size(info->type))};
    const iso_status status = p.raw && p.converted ? read_planes(n, opts, info, &p, grid->rgrid, error)
                                                   : iso_fail_memory(error, n->path);
    iso_free(p.raw);
    iso_free(p.converted);
    return status;
}

/* Reads what is not in one place of the file. */
static iso_status read_array(npy *n, const iso_volume_opts *opts, const iso_volume_info *info, iso_grid *grid,
                             iso_error *error) {
    bool same = n->header.axes >= 3 && components_of(&n->header) == info->components &&
                iso_scalar_stored_type(n->header.scalar) == info->type;
    for (int i = 0; same && i < 3; i++) same = n->header.shape[2 - i] == (uint64_t)info->dims[i];
    if (!same) return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", n->path);
    if (n->header.fortran) return read_fortran(n, opts, info, grid, error);
    const iso_format_stream stream = stream_of(n, info);
    return iso_format_read_stream(n->path, opts, info, &stream, grid, error);
}

static iso_status npy_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    npy n;
    ISO_TRY(open_npy(path, NULL, 0, &n, error));
    const iso_status status = describe(&n, opts, info, error);
    close_npy(&n);
    return status;
}

static iso_status npy_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    npy n;
    ISO_TRY(open_npy(path, NULL, 0, &n, error));
    const iso_status status = read_array(&n, opts, info, grid, error);
    close_npy(&n);
    return status;
}

/* ---- archives */

/* The array that is read: its name, and the lists of all for messages. */
typedef struct choice {
    int axes, arrays;
    char name[ISO_VOLUME_TEXT], others[400];
} choice;

/* Whether `wanted`, with a slash before it or without, is the name of an array. */
static bool is_wanted(const char *wanted, const char *name) {
    return strcmp(wanted + (*wanted == '/'), name) == 0;
}

/* Looks at an array: takes the one that is wanted, else the first one of three axes, else of four. */
static iso_status consider(const char *path, const iso_zip_entry *entry, uint64_t at,
                           const iso_volume_opts *opts, iso_volume_info *info, choice *c, npy *chosen,
                           iso_error *error) {
    char name[ISO_VOLUME_TEXT];
    npy n;
    iso_error detail = {0};
    if (entry->name_length >= sizeof name) return ISO_OK;
    snprintf(name, sizeof name, "%.*s", (int)entry->name_length, entry->name);
    if (iso_file_type_of_name(name, ISO_HOLDS_VOLUME) != ISO_FILE_npy) return ISO_OK;
    *strrchr(name, '.') = 0;
    const size_t used = strlen(c->others);
    if (used < sizeof c->others - 80)
        snprintf(c->others + used, sizeof c->others - used, "%s'%.64s'", c->arrays ? ", " : "", name);
    c->arrays++;
    const bool wanted = opts->grid && is_wanted(opts->grid, name);
    if (c->arrays > ISO_VOLUME_ITEMS && !wanted) return ISO_OK;
    const iso_status status = open_npy(path, entry, at, &n, &detail);
    if (status != ISO_OK) return wanted ? iso_fail(error, status, "%s", detail.text) : ISO_OK;
    const int axes = n.header.axes == 3 ? 2 : n.header.axes == 4;
    if (info && info->item_count < ISO_VOLUME_ITEMS)
        snprintf(info->items[info->item_count++], ISO_VOLUME_TEXT, "%.128s: %s, %d axes", name,
                 iso_scalar_name(n.header.scalar), n.header.axes);
    if (opts->grid ? !wanted : axes <= c->axes) {
        close_npy(&n);
        return ISO_OK;
    }
    if (chosen->file) close_npy(chosen);
    *chosen = n;
    c->axes = axes;
    memcpy(c->name, name, sizeof c->name);
    return ISO_OK;
}

static iso_status choose(const char *path, const void *bytes, uint64_t count, const iso_volume_opts *opts,
                         iso_volume_info *info, choice *c, npy *chosen, iso_error *error) {
    iso_zip zip;
    iso_zip_entry entry;
    bool more;
    ISO_TRY(iso_zip_open(path, bytes, (size_t)count, &zip, error));
    for (;;) {
        ISO_TRY(iso_zip_next(path, &zip, &entry, &more, error));
        if (!more) break;
        const uint64_t at = (uint64_t)(entry.data - (const unsigned char *)bytes);
        ISO_TRY(consider(path, &entry, at, opts, info, c, chosen, error));
    }
    if (chosen->file) return ISO_OK;
    if (opts->grid)
        return iso_fail(error, ISO_ERR_USAGE, "%s: no array '%.80s', there %s %s", path,
                        opts->grid + (*opts->grid == '/'), c->arrays == 1 ? "is" : "are", c->others);
    return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no array of three axes%s%s", path,
                    c->arrays ? ", but " : "", c->others);
}

/* Opens the array of an archive that is read. `info`, which may be NULL, gets the list of all. */
static iso_status open_npz(const char *path, const iso_volume_opts *opts, iso_volume_info *info, choice *c,
                           npy *n, iso_error *error) {
    FILE *file;
    uint64_t bytes;
    iso_mapping *mapping = NULL;
    *n = (npy){.path = path};
    *c = (choice){.axes = 0};
    ISO_TRY(iso_file_open(path, &file, &bytes, error));
    iso_status status = iso_mapping_of_file(path, file, bytes, &mapping, error);
    fclose(file);
    ISO_TRY(status);
    status = choose(path, iso_mapping_data(mapping), bytes, opts, info, c, n, error);
    iso_mapping_destroy(mapping);
    if (status != ISO_OK && n->file) close_npy(n);
    return status;
}

static iso_status npz_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    npy n;
    choice c;
    ISO_TRY(open_npz(path, opts, info, &c, &n, error));
    snprintf(info->name, sizeof info->name, "%s", c.name);
    if (c.arrays > 1 && !opts->grid)
        iso_volume_note(info, "several arrays: using '%.80s' of %d (--grid)", c.name, c.arrays);
    const iso_status status = describe(&n, opts, info, error);
    close_npy(&n);
    return status;
}

static iso_status npz_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    npy n;
    choice c;
    ISO_TRY(open_npz(path, opts, NULL, &c, &n, error));
    const iso_status status = read_array(&n, opts, info, grid, error);
    close_npy(&n);
    return status;
}

const iso_format iso_format_npy = {"npy", "isopoint", NULL, npy_info, npy_read, NULL};
const iso_format iso_format_npz = {"npz", "isopoint", NULL, npz_info, npz_read, NULL};
