/* library: opens files with libhdf5 and reads attributes.
 *
 * libhdf5 reads through a driver of our own, for three reasons: a file can name other files, which must not
 * be opened without the user's knowledge; file locks are not taken; and the driver sees where in the file a
 * chunk lies, which libhdf5 1.10 tells only by walking over all chunks. */
#include "grids/volume/hdf5/library.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"

/* ---- the driver ---- */

typedef struct driver_file {
    H5FD_t base; /* libhdf5's part comes first */
    iso_hdf5_file *file;
    haddr_t end; /* of the addresses that libhdf5 uses */
} driver_file;

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t access, haddr_t most) {
    iso_hdf5_file *const *given = H5Pget_driver_info(access);
    (void)name;
    (void)most;
    if (!given) return NULL;
    if ((*given)->opened || flags & (H5F_ACC_RDWR | H5F_ACC_CREAT | H5F_ACC_TRUNC)) {
        (*given)->refused = true;
        return NULL;
    }
    driver_file *opened = calloc(1, sizeof *opened);
    if (!opened) return NULL;
    opened->file = *given;
    opened->file->opened = true;
    return &opened->base;
}

static herr_t driver_close(H5FD_t *base) {
    free(base);
    return 0;
}

static herr_t driver_query(const H5FD_t *base, unsigned long *features) {
    (void)base;
    *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA_READ;
    return 0;
}

static haddr_t driver_get_end(const H5FD_t *base, H5FD_mem_t type) {
    (void)type;
    return ((const driver_file *)base)->end;
}

static herr_t driver_set_end(H5FD_t *base, H5FD_mem_t type, haddr_t end) {
    (void)type;
    ((driver_file *)base)->end = end;
    return 0;
}

static haddr_t driver_get_size(const H5FD_t *base, H5FD_mem_t type) {
    (void)type;
    return ((const driver_file *)base)->file->bytes;
}

/* What lies behind the end of the file is read as zeros, as libhdf5's own driver does it; but not values. */
static bool read_bytes(const iso_hdf5_file *file, bool values, haddr_t address, size_t bytes, void *target) {
    for (size_t done = 0; done < bytes;) {
        const ssize_t got =
            pread(file->descriptor, (char *)target + done, bytes - done, (off_t)(address + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 || (got == 0 && values)) return false;
        if (got == 0) {
            memset((char *)target + done, 0, bytes - done);
            return true;
        }
        done += (size_t)got;
    }
    return true;
}

static uint64_t little64(const uint8_t *bytes) {
    uint64_t number = 0;
    for (int i = 0; i < 8; i++) number |= (uint64_t)bytes[i] << 8 * i;
    return number;
}

/* Whether the objects of a global heap, which holds strings of variable length, follow each other. libhdf5
 * 1.10 takes the size of each as it is, and never ends where that of the free space (object 0) is 0. Only as
 * far as it has been read; sizes have 8 bytes. */
static bool is_heap_sound(const uint8_t *heap, size_t bytes) {
    enum { HEADER = 16 };
    if (bytes < HEADER || memcmp(heap, "GCOL\1\0\0\0", 8) != 0) return true;
    const uint64_t size = little64(heap + 8), end = size < bytes ? size : bytes;
    for (uint64_t at = HEADER; at + HEADER <= end;) {
        const bool is_free = heap[at] == 0 && heap[at + 1] == 0;
        const uint64_t length = little64(heap + at + 8);
        if (length > size - at || (is_free && length < HEADER)) return false;
        at += is_free ? length : HEADER + (length + 7) / 8 * 8;
    }
    return true;
}

static herr_t driver_read(H5FD_t *base, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t bytes,
                          void *target) {
    iso_hdf5_file *file = ((driver_file *)base)->file;
    (void)transfer;
    if (file->locating && type == H5FD_MEM_DRAW) {
        file->place.address = address;
        file->place.bytes = (uint32_t)bytes;
        return bytes > UINT32_MAX ? -1 : 0;
    }
    if (!read_bytes(file, type == H5FD_MEM_DRAW, address, bytes, target)) return -1;
    /* libhdf5 reads heaps as values */
    if (type != H5FD_MEM_DRAW || !file->has_long_sizes || is_heap_sound(target, bytes)) return 0;
    file->has_bad_heap = true;
    return -1;
}

/* libhdf5 asks for such a function, also of files that are only read. */
static herr_t driver_write(H5FD_t *base, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t bytes,
                           const void *source) {
    (void)base, (void)type, (void)transfer, (void)address, (void)bytes, (void)source;
    return -1;
}

static const H5FD_class_t driver = {.name = "isopoint",
                                    .maxaddr = INT64_MAX,
                                    .fc_degree = H5F_CLOSE_WEAK,
                                    .fapl_size = sizeof(iso_hdf5_file *),
                                    .open = driver_open,
                                    .close = driver_close,
                                    .query = driver_query,
                                    .get_eoa = driver_get_end,
                                    .set_eoa = driver_set_end,
                                    .get_eof = driver_get_size,
                                    .read = driver_read,
                                    .write = driver_write,
                                    .fl_map = H5FD_FLMAP_DICHOTOMY};

/* ---- errors ---- */

/* The innermost message. */
typedef struct innermost {
    char text[200];
    bool no_memory;
} innermost;

static herr_t take_message(unsigned number, const H5E_error2_t *message, void *context) {
    innermost *found = context;
    if (number == 0) snprintf(found->text, sizeof found->text, "%s", message->desc ? message->desc : "");
    if (message->min_num == H5E_NOSPACE ||
        (message->maj_num == H5E_RESOURCE && message->min_num == H5E_CANTALLOC))
        found->no_memory = true;
    return 0;
}

iso_status iso_hdf5_fail(const iso_hdf5_file *file, const char *what, iso_error *error) {
    innermost found = {.text = ""};
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_message, &found);
    if (found.no_memory)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %s needs more memory than is allowed (--max-memory)",
                        file->path, what);
    if (file->refused)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: %s is in another file, which has to be named itself",
                        file->path, what);
    return iso_fail(error, ISO_ERR_IO, "%s: %s is damaged or truncated%s%s", file->path, what,
                    *found.text ? ": " : "", found.text);
}

/* ---- files and objects ---- */

iso_status iso_hdf5_open(const char *path, iso_hdf5_file *file, iso_error *error) {
    *file = (iso_hdf5_file){.path = path, .descriptor = -1};
    ISO_TRY(iso_file_descriptor(path, &file->descriptor, &file->bytes, error));
    H5open();
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS), id = H5FDregister(&driver);
    if (access < 0 || id < 0 || H5Pset_driver(access, id, &file) < 0)
        return iso_hdf5_fail(file, "libhdf5's driver", error);
    file->id = H5Fopen(path, H5F_ACC_RDONLY, access);
    if (file->id < 0) return iso_hdf5_fail(file, "the file", error);
    size_t address_bytes, size_bytes = 0;
    file->has_long_sizes =
        H5Pget_sizes(H5Fget_create_plist(file->id), &address_bytes, &size_bytes) >= 0 && size_bytes == 8;
    return ISO_OK;
}

hid_t iso_hdf5_object(hid_t parent, const char *path) {
    return H5Oopen(parent, path, H5P_DEFAULT);
}

hid_t iso_hdf5_group(hid_t parent, const char *path) {
    const hid_t object = iso_hdf5_object(parent, path);
    return object >= 0 && H5Iget_type(object) == H5I_GROUP ? object : -1;
}

hid_t iso_hdf5_dataset(hid_t parent, const char *path) {
    const hid_t object = iso_hdf5_object(parent, path);
    return object >= 0 && H5Iget_type(object) == H5I_DATASET ? object : -1;
}

void iso_hdf5_path_of(hid_t object, char path[ISO_HDF5_PATH]) {
    *path = 0;
    H5Iget_name(object, path, ISO_HDF5_PATH);
    path[ISO_HDF5_PATH - 1] = 0;
}

/* ---- attributes ---- */

/* No attribute that is looked at has more values or longer strings. */
enum { MOST_VALUES = 4096, MOST_TEXT = 1 << 16 };

/* Opens an attribute with 1 .. MOST_VALUES values; negative: there is none. */
static hid_t open_attribute(hid_t object, const char *name, size_t *count) {
    const hid_t attribute = H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : -1;
    if (attribute < 0) return -1;
    const hssize_t values = H5Sget_simple_extent_npoints(H5Aget_space(attribute));
    *count = (size_t)values;
    return values >= 1 && values <= MOST_VALUES ? attribute : -1;
}

/* Strings of variable length are allocated by libhdf5. */
static bool read_pointers(hid_t attribute, hid_t type, size_t count, size_t index, char *text, size_t room) {
    char **strings = calloc(count, sizeof *strings);
    const bool found = strings && H5Aread(attribute, type, strings) >= 0 && strings[index];
    if (found) snprintf(text, room, "%s", strings[index]);
    free(strings);
    return found;
}

static bool read_fixed(hid_t attribute, hid_t type, size_t count, size_t index, char *text, size_t room) {
    const size_t length = H5Tget_size(type);
    char values[MOST_TEXT];
    if (length < 1 || length > MOST_TEXT / count || H5Aread(attribute, type, values) < 0) return false;
    if (length == 1) /* single characters make up one string */
        snprintf(text, room, "%.*s", (int)count, values);
    else
        snprintf(text, room, "%.*s", (int)length, values + index * length);
    return true;
}

bool iso_hdf5_text(hid_t object, const char *name, size_t index, char *text, size_t room) {
    size_t count = 0;
    const hid_t attribute = open_attribute(object, name, &count);
    if (attribute < 0) return false;
    const hid_t type = H5Aget_type(attribute);
    if (H5Tget_class(type) != H5T_STRING) return false;
    const bool variable = H5Tis_variable_str(type) > 0;
    if (index >= count && (variable || H5Tget_size(type) > 1 || index > 0)) return false;
    return variable ? read_pointers(attribute, type, count, index, text, room)
                    : read_fixed(attribute, type, count, index, text, room);
}

/* The numbers of a text such as "1 2 3". */
static size_t parse_numbers(const char *text, double *numbers, size_t room) {
    size_t count = 0;
    char *end = NULL;
    for (; count < room; count++, text = end) {
        numbers[count] = strtod(text, &end);
        if (end == text) break;
    }
    return count;
}

size_t iso_hdf5_numbers(hid_t object, const char *name, double *numbers, size_t room) {
    size_t count = 0;
    char text[256];
    double values[MOST_VALUES];
    const hid_t attribute = open_attribute(object, name, &count);
    if (attribute < 0) return 0;
    const H5T_class_t kind = H5Tget_class(H5Aget_type(attribute));
    if (kind == H5T_STRING)
        return iso_hdf5_text(object, name, 0, text, sizeof text) ? parse_numbers(text, numbers, room) : 0;
    if (kind != H5T_INTEGER && kind != H5T_FLOAT) return 0;
    if (H5Aread(attribute, H5T_NATIVE_DOUBLE, values) < 0) return 0;
    if (count > room) count = room;
    memcpy(numbers, values, count * sizeof *numbers);
    return count;
}

double *iso_hdf5_values(hid_t dataset, uint64_t most, uint64_t *count) {
    const hssize_t points = H5Sget_simple_extent_npoints(H5Dget_space(dataset));
    const hid_t creation = H5Dget_create_plist(dataset);
    const H5T_class_t kind = H5Tget_class(H5Dget_type(dataset));
    if (points < 1 || (uint64_t)points > most || (kind != H5T_INTEGER && kind != H5T_FLOAT) ||
        H5Pget_external_count(creation) > 0 || H5Pget_layout(creation) == H5D_VIRTUAL)
        return NULL;
    double *values = malloc((size_t)points * sizeof *values);
    if (values && H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
        free(values);
        return NULL;
    }
    *count = (uint64_t)points;
    return values;
}
