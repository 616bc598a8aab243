/* describe: finds the array of a file that is read, and how its values are stored. Runs in the child process.
 */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grids/volume/hdf5/conventions.h"
#include "grids/volume/hdf5/types.h"

/* ---- how values are stored ---- */

/* The sizes and type of an array of numbers with three axes or more; false: it is something else, or
 * array->special says why it is not read. */
static bool read_sizes(hid_t dataset, iso_hdf5_array *array) {
    hsize_t sizes[H5S_MAX_RANK];
    const int rank = H5Sget_simple_extent_ndims(H5Dget_space(dataset));
    if (rank < 3 || rank > ISO_HDF5_AXES || !iso_hdf5_read_type(dataset, array)) return false;
    if (H5Sget_simple_extent_dims(H5Dget_space(dataset), sizes, NULL) != rank) return false;
    array->rank = rank;
    for (int axis = 0; axis < rank; axis++) {
        array->sizes[axis] = array->chunk[axis] = sizes[axis];
        if (sizes[axis] == 0) return false;
    }
    return true;
}

static const char *filter_name(int filter) {
    static const struct {
        int number;
        const char *name;
    } names[] = {{ISO_HDF5_DEFLATE, "deflate"},
                 {ISO_HDF5_SHUFFLE, "shuffle"},
                 {ISO_HDF5_FLETCHER32, "fletcher32"},
                 {ISO_HDF5_LZF, "lzf"},
                 {H5Z_FILTER_SZIP, "szip"},
                 {H5Z_FILTER_NBIT, "nbit"},
                 {H5Z_FILTER_SCALEOFFSET, "scaleoffset"},
                 {ISO_HDF5_BZIP2, "bzip2"},
                 {ISO_HDF5_BLOSC, "blosc"},
                 {ISO_HDF5_LZ4, "lz4"},
                 {32008, "bitshuffle"},
                 {ISO_HDF5_ZSTD, "zstd"},
                 {32026, "blosc2"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (names[i].number == filter) return names[i].name;
    return NULL;
}

static bool read_filters(hid_t creation, iso_hdf5_array *array) {
    array->filter_count = H5Pget_nfilters(creation);
    if (array->filter_count < 0 || array->filter_count > ISO_HDF5_FILTERS) return false;
    for (int i = 0; i < array->filter_count; i++) {
        unsigned flags, count = 0;
        array->filters[i] =
            (int)H5Pget_filter2(creation, (unsigned)i, &flags, (size_t[]){0}, &count, 0, NULL, NULL);
        if (array->filters[i] < 0) return false;
    }
    return true;
}

static iso_status unsupported(const iso_hdf5_file *file, const iso_hdf5_array *array, const char *what,
                              iso_error *error) {
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: %.200s %s", file->path, array->path, what);
}

/* Whether libhdf5 can undo a filter: by itself, by libaec (szip), or by a plugin. */
static bool library_knows_filter(int filter) {
    unsigned flags = 0;
    return H5Zfilter_avail(filter) > 0 && H5Zget_filter_info(filter, &flags) >= 0 &&
           flags & H5Z_FILTER_CONFIG_DECODE_ENABLED;
}

/* Leaves the decoding to libhdf5. */
static void leave_to_library(iso_hdf5_array *array, const char *what) {
    const size_t length = strlen(array->special);
    array->by_library = true;
    snprintf(array->special + length, sizeof array->special - length, "%s%s", length ? ", " : "", what);
}

/* Finds out who decodes the values. Refuses values in other files, and filters that nobody can undo. */
static iso_status check_storage(const iso_hdf5_file *file, hid_t creation, iso_hdf5_array *array,
                                iso_error *error) {
    char filter[64], what[160];
    if (H5Pget_layout(creation) == H5D_VIRTUAL)
        return unsupported(file, array,
                           "has its values in other files (a virtual dataset): name one of these", error);
    if (H5Pget_external_count(creation) > 0)
        return unsupported(file, array, "has its values in another file, which can be read by --raw", error);
    if (H5Pget_layout(creation) == H5D_COMPACT) leave_to_library(array, "compact layout");
    for (int i = 0; i < array->filter_count; i++) {
        const int number = array->filters[i];
        const char *name = filter_name(number);
        if (iso_hdf5_knows_filter(number)) continue;
        snprintf(filter, sizeof filter, "filter %d%s%s%s", number, name ? " (" : "", name ? name : "",
                 name ? ")" : "");
        snprintf(what, sizeof what, "is compressed by %s, which neither isopoint nor libhdf5 can undo here",
                 filter);
        if (!library_knows_filter(number)) return unsupported(file, array, what, error);
        leave_to_library(array, filter);
    }
    return ISO_OK;
}

static iso_status read_storage(const iso_hdf5_file *file, hid_t dataset, iso_hdf5_array *array,
                               iso_error *error) {
    const hid_t creation = H5Dget_create_plist(dataset);
    hsize_t chunk[H5S_MAX_RANK];
    if (creation < 0 || !read_filters(creation, array) ||
        H5Pget_fill_value(creation, iso_hdf5_memory_type(dataset), array->fill) < 0)
        memset(array->fill, 0, sizeof array->fill);
    if (creation < 0 || array->filter_count < 0 || array->filter_count > ISO_HDF5_FILTERS)
        return iso_hdf5_fail(file, array->path, error);
    ISO_TRY(check_storage(file, creation, array, error));
    array->chunked = H5Pget_layout(creation) == H5D_CHUNKED;
    array->address = array->chunked ? 0 : H5Dget_offset(dataset);
    array->allocated = array->address != HADDR_UNDEF || H5Pget_layout(creation) == H5D_COMPACT;
    if (array->by_library) array->big_endian = false; /* as libhdf5 gives them */
    if (!array->chunked) return ISO_OK;
    if (H5Pget_chunk(creation, array->rank, chunk) != array->rank)
        return iso_hdf5_fail(file, array->path, error);
    for (int axis = 0; axis < array->rank; axis++) array->chunk[axis] = chunk[axis];
    hsize_t stored = 0;
    if (H5Dget_num_chunks(dataset, H5Dget_space(dataset), &stored) < 0)
        return iso_hdf5_fail(file, array->path, error);
    array->stored = stored;
    if (iso_hdf5_chunk_bytes(array) > INT_MAX)
        return unsupported(file, array, "has chunks of more than 2 GB", error);
    return ISO_OK;
}

/* ---- the arrays of a file ---- */

/* What a walk over the objects of a file finds. Files with more objects have conventions, or are named with
 * a path. */
enum { MOST_OBJECTS = 10000 };

typedef struct listing {
    iso_volume_info *info;    /* the items are added to it */
    const char *chosen;       /* NULL: no array is chosen yet */
    bool has_chosen, damaged; /* damaged: an object or the rest of the file cannot be read */
    int objects, count;
    char first[ISO_HDF5_PATH]; /* the first array */
    iso_hdf5_array refused;    /* the first one whose numbers are not read; no path: there is none */
} listing;

/* Appends "(3, 4, 5)". */
static int print_sizes(char *text, size_t room, const uint64_t *sizes, int rank) {
    int length = 0;
    for (int axis = 0; axis < rank && (size_t)length < room; axis++)
        length += snprintf(text + length, room - (size_t)length, "%s%llu%s", axis ? ", " : "(",
                           (unsigned long long)sizes[axis], axis == rank - 1 ? ")" : "");
    return length;
}

/* "/path: (200, 512, 512) uint16, chunks (64, 64, 64), shuffle, deflate": sizes as HDF5's tools show them. */
static void print_array(hid_t dataset, const iso_hdf5_array *array, char text[ISO_VOLUME_TEXT]) {
    const hid_t creation = H5Dget_create_plist(dataset);
    hsize_t chunk[H5S_MAX_RANK];
    uint64_t sizes[ISO_HDF5_AXES];
    iso_hdf5_array stored = *array;
    int length = snprintf(text, ISO_VOLUME_TEXT, "%.128s: ", array->path);
    length += print_sizes(text + length, ISO_VOLUME_TEXT - (size_t)length, array->sizes, array->rank);
    length += snprintf(text + length, ISO_VOLUME_TEXT - (size_t)length, " %s%s",
                       array->big_endian && array->element_bytes > 1 ? "big-endian " : "",
                       iso_scalar_name(array->scalar));
    if (H5Pget_layout(creation) != H5D_CHUNKED || H5Pget_chunk(creation, array->rank, chunk) != array->rank)
        return;
    for (int axis = 0; axis < array->rank; axis++) sizes[axis] = chunk[axis];
    length += snprintf(text + length, ISO_VOLUME_TEXT - (size_t)length, ", chunks ");
    if (length < ISO_VOLUME_TEXT)
        length += print_sizes(text + length, ISO_VOLUME_TEXT - (size_t)length, sizes, array->rank);
    if (!read_filters(creation, &stored)) return;
    for (int i = 0; i < stored.filter_count && length < ISO_VOLUME_TEXT - 24; i++) {
        const char *name = filter_name(stored.filters[i]);
        length += name ? snprintf(text + length, ISO_VOLUME_TEXT - (size_t)length, ", %s", name)
                       : snprintf(text + length, ISO_VOLUME_TEXT - (size_t)length, ", filter %d",
                                  stored.filters[i]);
    }
}

static herr_t list_object(hid_t root, const char *name, const H5O_info_t *object, void *context) {
    listing *found = context;
    iso_hdf5_array array = {0};
    if (found->objects++ == MOST_OBJECTS) return 1;
    if (object->type != H5O_TYPE_DATASET) return 0;
    const hid_t dataset = iso_hdf5_dataset(root, name);
    if (dataset < 0) found->damaged = true;
    snprintf(array.path, sizeof array.path, "/%s", name);
    if (dataset < 0 || !read_sizes(dataset, &array)) {
        if (dataset >= 0) H5Oclose(dataset);
        if (*array.special && !*found->refused.path) found->refused = array;
        return 0;
    }
    const bool chosen = found->chosen && strcmp(found->chosen, array.path) == 0;
    const bool fits = found->info->item_count < ISO_VOLUME_ITEMS - !(found->has_chosen || chosen);
    if (found->count++ == 0) memcpy(found->first, array.path, sizeof found->first);
    if (chosen) found->has_chosen = true;
    if (fits) print_array(dataset, &array, found->info->items[found->info->item_count++]);
    H5Oclose(dataset);
    return 0;
}

/* Lists the arrays with three axes or more in info->items. */
static void list_arrays(const iso_hdf5_file *file, const char *chosen, iso_volume_info *info,
                        listing *found) {
    *found = (listing){.info = info, .chosen = chosen};
    info->item_count = 0;
    if (H5Ovisit2(file->id, H5_INDEX_NAME, H5_ITER_INC, list_object, found, H5O_INFO_BASIC) < 0)
        found->damaged = true;
    if (found->objects > MOST_OBJECTS) iso_volume_note(info, "it has more than %d objects", MOST_OBJECTS);
}

/* ---- which array ---- */

/* Refuses a path through a link to another file, and says which. */
static iso_status check_links(const iso_hdf5_file *file, const char *path, iso_error *error) {
    char part[ISO_HDF5_PATH];
    for (size_t length = strcspn(path + 1, "/") + 1;; length += strcspn(path + length + 1, "/") + 1) {
        H5L_info_t link;
        char value[ISO_HDF5_PATH];
        const char *name = NULL, *object = NULL;
        snprintf(part, sizeof part, "%.*s", (int)length, path);
        if (H5Lget_info(file->id, part, &link, H5P_DEFAULT) < 0) return ISO_OK;
        if (link.type == H5L_TYPE_EXTERNAL && link.u.val_size <= sizeof value &&
            H5Lget_val(file->id, part, value, sizeof value, H5P_DEFAULT) >= 0 &&
            H5Lunpack_elink_val(value, link.u.val_size, NULL, &name, &object) >= 0)
            return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: %.80s is in another file: name %.120s:%.120s",
                            file->path, part, name, object);
        if (!path[length]) return ISO_OK;
    }
}

static herr_t find_external(hid_t root, const char *name, const H5L_info_t *link, void *context) {
    (void)root;
    if (link->type == H5L_TYPE_EXTERNAL) snprintf(context, ISO_HDF5_PATH, "/%s", name);
    return link->type == H5L_TYPE_EXTERNAL;
}

static iso_status refuse_type(const iso_hdf5_file *file, const iso_hdf5_array *array, iso_error *error) {
    char what[160];
    snprintf(what, sizeof what, "has %s, which isopoint does not read", array->special);
    return unsupported(file, array, what, error);
}

/* Writes the arrays that list_arrays has found, without their chunks, separated by semicolons. */
static void join_items(const iso_volume_info *info, char *names, size_t size) {
    size_t length = 0;
    *names = 0;
    for (int i = 0; i < info->item_count && length < size - 1; i++) {
        const char *item = info->items[i], *chunks = strstr(item, ", chunks");
        length += (size_t)snprintf(names + length, size - length, "%s%.*s", i ? "; " : "",
                                   (int)(chunks ? (size_t)(chunks - item) : strlen(item)), item);
    }
}

/* The file has no array, or several. */
static iso_status fail_choice(const iso_hdf5_file *file, const listing *found, iso_error *error) {
    char names[400] = "", linked[ISO_HDF5_PATH] = "";
    if (found->count == 0 && H5Lvisit(file->id, H5_INDEX_NAME, H5_ITER_INC, find_external, linked) > 0)
        ISO_TRY(check_links(file, linked, error));
    if (found->count == 0 && found->damaged) return iso_hdf5_fail(file, "the file", error);
    if (found->count == 0 && *found->refused.path) return refuse_type(file, &found->refused, error);
    if (found->count == 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: has no array of numbers with three axes", file->path);
    join_items(found->info, names, sizeof names);
    return iso_fail(error, ISO_ERR_FORMAT, "%s: has %d arrays, name one as FILE:/path or by --grid: %s",
                    file->path, found->count, names);
}

/* Opens the array that the user named: by its path, by a group that says which of its arrays is meant, or by
 * a name in a file of VTK. */
static iso_status open_named(const iso_hdf5_file *file, const char *name, iso_volume_info *info,
                             hid_t *dataset, iso_error *error) {
    char path[ISO_HDF5_PATH], names[400];
    listing found;
    snprintf(path, sizeof path, "%s%s", *name == '/' ? "" : "/", name);
    *dataset = iso_hdf5_vtk_array(file, name);
    if (*dataset >= 0) return ISO_OK;
    ISO_TRY(check_links(file, path, error));
    *dataset = iso_hdf5_dataset(file->id, path);
    if (*dataset >= 0) return ISO_OK;
    const hid_t group = iso_hdf5_group(file->id, path);
    if (group >= 0) *dataset = iso_hdf5_signal(group);
    if (*dataset >= 0) return ISO_OK;
    list_arrays(file, NULL, info, &found);
    join_items(info, names, sizeof names);
    return iso_fail(error, ISO_ERR_USAGE, "%s: has no array %.200s%s%s", file->path, path,
                    *names ? "; it has " : "", names);
}

static iso_status choose(const iso_hdf5_file *file, const iso_volume_opts *opts, iso_volume_info *info,
                         hid_t *dataset, iso_error *error) {
    listing found;
    if (opts->grid) return open_named(file, opts->grid, info, dataset, error);
    ISO_TRY(iso_hdf5_default(file, opts, dataset, error));
    if (*dataset >= 0) return ISO_OK;
    list_arrays(file, NULL, info, &found);
    if (found.count != 1) return fail_choice(file, &found, error);
    *dataset = iso_hdf5_dataset(file->id, found.first);
    return *dataset >= 0 ? ISO_OK : iso_hdf5_fail(file, found.first, error);
}

/* ---- axes ---- */

/* How many values an array has at each voxel, along an axis of its own: the last one or the first. Further
 * axes are read at their first index. */
typedef struct axes {
    int left[ISO_HDF5_AXES], count; /* axes that are not decided yet, in their order */
    int components;                 /* the axis of components; -1: none */
} axes;

static void take_out(axes *a, int at) {
    memmove(a->left + at, a->left + at + 1, (size_t)(--a->count - at) * sizeof *a->left);
}

/* Axes of size one go first, the first ones before the last ones, until three are left. */
static void drop_single(const iso_hdf5_array *array, axes *a) {
    for (int i = 0; i < a->count && a->count > 3;)
        if (array->sizes[a->left[i]] == 1)
            take_out(a, i);
        else
            i++;
}

static void find_axes(iso_hdf5_array *array, axes *a, iso_volume_info *info) {
    *a = (axes){.count = array->rank, .components = -1};
    for (int axis = 0; axis < array->rank; axis++) a->left[axis] = axis;
    drop_single(array, a);
    while (a->count > 4) { /* times, before channels */
        iso_volume_note(info, "the first of %llu on axis %d is read",
                        (unsigned long long)array->sizes[a->left[0]], a->left[0]);
        take_out(a, 0);
    }
    if (a->count == 4) {
        const int at = array->sizes[a->left[3]] <= array->sizes[a->left[0]] ? 3 : 0;
        a->components = a->left[at];
        take_out(a, at);
    }
    for (int i = 0; i < 3; i++) array->xyz[i] = a->left[2 - i];
}

/* Values in one piece are read in boxes: long enough for few runs of bytes, and small enough that a part of
 * the volume can be read alone. Interleaved components are read together. */
static void divide_into_boxes(iso_hdf5_array *array) {
    static const uint64_t voxels[3] = {256, 32, 16};
    for (int axis = 0; axis < array->rank; axis++)
        array->chunk[axis] = axis > array->xyz[0] ? array->sizes[axis] : 1;
    for (int i = 0; i < 3; i++) {
        const uint64_t size = array->sizes[array->xyz[i]];
        array->chunk[array->xyz[i]] = size < voxels[i] ? size : voxels[i];
    }
}

/* ---- all together ---- */

static iso_status take_dims(const iso_hdf5_file *file, const iso_hdf5_array *array,
                            const iso_hdf5_meaning *meaning, iso_volume_info *info, iso_error *error) {
    uint64_t dims[3];
    for (int i = 0; i < 3; i++) {
        dims[i] = array->sizes[array->xyz[i]];
        if (meaning->used[i] >= 1 && meaning->used[i] <= dims[i]) dims[i] = meaning->used[i];
    }
    return iso_format_dims(file->path, dims, info, error);
}

static iso_status check_level(const iso_hdf5_file *file, const iso_volume_opts *opts,
                              const iso_hdf5_meaning *meaning, iso_error *error) {
    if (opts->level <= 0 || opts->level == meaning->level) return ISO_OK;
    if (meaning->levels < 2)
        return iso_fail(error, ISO_ERR_USAGE, "%s: no level %d, there is one", file->path, opts->level);
    return iso_fail(error, ISO_ERR_USAGE, "%s: no level %d, there are %d (from 0)", file->path, opts->level,
                    meaning->levels);
}

static iso_status take_component(const iso_hdf5_file *file, const iso_volume_opts *opts,
                                 const iso_hdf5_meaning *meaning, int axis, iso_hdf5_array *array,
                                 iso_volume_info *info, iso_error *error) {
    const uint64_t count =
        axis >= 0 ? array->sizes[axis] : (uint64_t)(meaning->channels > 1 ? meaning->channels : 1);
    if (count > INT_MAX) return iso_fail(error, ISO_ERR_FORMAT, "%s: has too many components", file->path);
    ISO_TRY(iso_format_component(file->path, opts, (int)count, info, error));
    if (axis >= 0) array->at[axis] = (uint64_t)info->component;
    return ISO_OK;
}

static void take_spacing(const iso_hdf5_file *file, const iso_hdf5_array *array,
                         const iso_hdf5_meaning *meaning, const iso_volume_opts *opts,
                         iso_volume_info *info) {
    char unclear[128];
    bool given = true;
    for (int i = 0; i < 3; i++) {
        const bool is_stated = meaning->spacing[i] > 0;
        if (opts->spacing[i] > 0) meaning->positions->count[i] = 0;
        given = given && (opts->spacing[i] > 0 || (is_stated && !meaning->relative));
        info->transform.spacing[i] = is_stated ? meaning->spacing[i] : 1;
    }
    info->unitless = !given;
    if (!given && meaning->relative)
        iso_volume_note(info, "only the ratios of the distances of voxels are stated: 1 mm in the finest "
                              "level (--spacing)");
    else if (!given && iso_hdf5_unclear_distance(file, array, unclear, sizeof unclear))
        iso_volume_note(info,
                        "the distance of voxels is stated without a known unit and order: 1 mm; %s "
                        "(--spacing X,Y,Z)",
                        unclear);
    else if (!given)
        iso_volume_note(info, "the distance of voxels is not stated: 1 mm (--spacing)");
}

iso_status iso_hdf5_describe(const char *path, const char *xml, const iso_volume_opts *opts,
                             iso_volume_info *info, iso_hdf5_array *array, iso_hdf5_slices *slices,
                             iso_hdf5_positions *positions, iso_error *error) {
    iso_hdf5_file file;
    iso_hdf5_meaning meaning = {.positions = positions};
    hid_t dataset = -1;
    listing found;
    axes a;
    *array = (iso_hdf5_array){0};
    ISO_TRY(iso_hdf5_open(path, &file, error));
    file.xml = xml;
    ISO_TRY(choose(&file, opts, info, &dataset, error));
    iso_hdf5_path_of(dataset, array->path);
    if (!read_sizes(dataset, array))
        return *array->special ? refuse_type(&file, array, error)
                               : iso_fail(error, ISO_ERR_FORMAT,
                                          "%s: %.200s is not an array of numbers with three axes or more",
                                          path, array->path);
    ISO_TRY(read_storage(&file, dataset, array, error));
    if (array->by_library)
        iso_volume_note(info, "libhdf5 decodes it, one chunk at a time: %s", array->special);
    find_axes(array, &a, info);
    if (!array->chunked) divide_into_boxes(array);
    ISO_TRY(iso_hdf5_interpret(&file, array, &meaning, info, error));
    ISO_TRY(check_level(&file, opts, &meaning, error));
    ISO_TRY(take_component(&file, opts, &meaning, a.components, array, info, error));
    if (opts->channels && !opts->grid) iso_hdf5_name_channels(&file, array, info->components, opts->channels);
    ISO_TRY(take_dims(&file, array, &meaning, info, error));
    info->type = iso_scalar_stored_type(array->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(array->scalar));
    snprintf(info->name, sizeof info->name, "%.*s", ISO_VOLUME_TEXT - 1, array->path);
    if (iso_hdf5_is_minc(array)) ISO_TRY(iso_hdf5_minc_scales(&file, array, info, slices, error));
    take_spacing(&file, array, &meaning, opts, info);
    list_arrays(&file, array->path, info, &found);
    if (file.has_bad_heap) return iso_fail(error, ISO_ERR_IO, "%s: damaged: a heap with its texts", path);
    return ISO_OK;
}

iso_status iso_hdf5_read_numbers(const char *path, const char *array, uint64_t count, double *numbers,
                                 iso_error *error) {
    iso_hdf5_file file;
    uint64_t found = 0;
    ISO_TRY(iso_hdf5_open(path, &file, error));
    const hid_t dataset = iso_hdf5_dataset(file.id, array);
    double *values = dataset >= 0 ? iso_hdf5_values(dataset, count, &found) : NULL;
    if (!values || found != count)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %.200s is not an array of %llu numbers", path, array,
                        (unsigned long long)count);
    memcpy(numbers, values, (size_t)count * sizeof *numbers);
    free(values);
    return ISO_OK;
}
