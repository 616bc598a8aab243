/* conventions: finds arrays and their geometry by what programs agree on.
 *
 * VTKHDF: the VTK file format page of VTK's documentation. Imaris: "Imaris 5.5 file format" of Bitplane.
 * BigDataViewer: its page on the image data in HDF5. NeXus: the manual's rules for NXdata. */
#include "grids/volume/hdf5/conventions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORD = 128 };

/* ---- VTKHDF ---- */

static const char vtk_root[] = "/VTKHDF";

static herr_t take_first(hid_t group, const char *name, const H5L_info_t *link, void *context) {
    (void)group;
    (void)link;
    snprintf(context, WORD, "%s", name);
    return 1;
}

/* The active scalars of the points or the cells, else the first array. */
static hid_t active_array(hid_t root, const char *kind) {
    char name[WORD] = "";
    const hid_t group = iso_hdf5_group(root, kind);
    if (group < 0) return -1;
    if (!iso_hdf5_text(group, "Scalars", 0, name, sizeof name))
        H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, take_first, name);
    return *name ? iso_hdf5_dataset(group, name) : -1;
}

hid_t iso_hdf5_vtk_array(const iso_hdf5_file *file, const char *name) {
    static const char *const kinds[] = {"PointData", "CellData"};
    char path[ISO_HDF5_PATH];
    hid_t dataset = -1;
    for (int i = 0; i < 2 && dataset < 0; i++) {
        snprintf(path, sizeof path, "%s/%s/%s", vtk_root, kinds[i], name);
        if (*name != '/') dataset = iso_hdf5_dataset(file->id, path);
    }
    return dataset;
}

static iso_status default_of_vtk(const iso_hdf5_file *file, hid_t *dataset, iso_error *error) {
    char type[WORD] = "";
    const hid_t root = iso_hdf5_group(file->id, vtk_root);
    if (root < 0) return ISO_OK;
    iso_hdf5_text(root, "Type", 0, type, sizeof type);
    if (strcmp(type, "ImageData") != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds a VTK %.80s, not an image", file->path,
                        *type ? type : "object without a type");
    *dataset = active_array(root, "PointData");
    if (*dataset < 0) *dataset = active_array(root, "CellData");
    return ISO_OK;
}

/* Moves the origin along the axes by so many voxels on each. */
static void move_origin(iso_transform *transform, const double spacing[3], const double voxels[3]) {
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++)
            transform->origin[i] += voxels[axis] * spacing[axis] * transform->direction[3 * i + axis];
}

static void interpret_vtk(const iso_hdf5_file *file, const iso_hdf5_array *array, iso_hdf5_meaning *meaning,
                          iso_volume_info *info) {
    double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1}, direction[9], extent[6] = {0};
    double first[3];
    const hid_t root = iso_hdf5_group(file->id, vtk_root);
    const bool cells = strncmp(array->path, "/VTKHDF/CellData/", 17) == 0;
    iso_hdf5_numbers(root, "Origin", origin, 3);
    iso_hdf5_numbers(root, "Spacing", spacing, 3);
    iso_hdf5_numbers(root, "WholeExtent", extent, 6);
    if (iso_hdf5_numbers(root, "Direction", direction, 9) == 9)
        memcpy(info->transform.direction, direction, sizeof direction);
    memcpy(info->transform.origin, origin, sizeof origin);
    for (int axis = 0; axis < 3; axis++) {
        meaning->spacing[axis] = fabs(spacing[axis]);
        for (int i = 0; i < 3 && spacing[axis] < 0; i++) info->transform.direction[3 * i + axis] *= -1;
        /* the file's origin is at index 0, which may be outside the extent */
        first[axis] = extent[2 * axis] + (cells && extent[2 * axis + 1] > extent[2 * axis] ? 0.5 : 0);
    }
    move_origin(&info->transform, meaning->spacing, first);
    if (cells) iso_volume_note(info, "values of cells: voxels are the cells' centres");
}

/* ---- Imaris ---- */

static const char imaris_format[] = "/DataSet/ResolutionLevel %u/TimePoint %u/Channel %u";

/* An array of an Imaris file, by its place in it. */
typedef struct imaris_place {
    unsigned level, time, channel;
} imaris_place;

static hid_t imaris_array(const iso_hdf5_file *file, const imaris_place *place) {
    char path[WORD];
    snprintf(path, sizeof path, imaris_format, place->level, place->time, place->channel);
    const hid_t channel = iso_hdf5_group(file->id, path);
    return channel >= 0 ? iso_hdf5_dataset(channel, "Data") : -1;
}

static bool is_imaris(const iso_hdf5_array *array, imaris_place *place) {
    return sscanf(array->path, imaris_format, &place->level, &place->time, &place->channel) == 3;
}

/* How many in a row of Imaris's arrays there are; `number` is the part of `place` that is counted. */
static int count_imaris(const iso_hdf5_file *file, imaris_place *place, unsigned *number) {
    enum { MOST = 10000 };
    const unsigned kept = *number;
    int count = 0;
    for (*number = 0; count < MOST; ++*number, count++) {
        const hid_t dataset = imaris_array(file, place);
        if (dataset < 0) break;
        H5Oclose(dataset);
    }
    *number = kept;
    return count;
}

static void interpret_imaris(const iso_hdf5_file *file, const iso_hdf5_array *array,
                             const imaris_place *place, iso_hdf5_meaning *meaning, iso_volume_info *info) {
    char path[WORD], name[WORD], unit[WORD] = "um";
    imaris_place at = *place;
    snprintf(path, sizeof path, imaris_format, at.level, at.time, at.channel);
    const hid_t channel = iso_hdf5_group(file->id, path),
                image = iso_hdf5_group(file->id, "/DataSetInfo/Image");
    if (image >= 0) iso_hdf5_text(image, "Unit", 0, unit, sizeof unit);
    const double mm = iso_format_unit(unit) > 0 ? iso_format_unit(unit) : 1e-3;
    for (int axis = 0; axis < 3; axis++) {
        double size = 0, low = 0, high = 0;
        snprintf(name, sizeof name, "ImageSize%c", "XYZ"[axis]);
        if (channel >= 0 && iso_hdf5_numbers(channel, name, &size, 1) && size >= 1 && size < 1e9)
            meaning->used[axis] = (uint64_t)size;
        else
            size = (double)array->sizes[array->xyz[axis]];
        snprintf(name, sizeof name, "ExtMin%d", axis);
        if (image < 0 || !iso_hdf5_numbers(image, name, &low, 1)) continue;
        snprintf(name, sizeof name, "ExtMax%d", axis);
        if (!iso_hdf5_numbers(image, name, &high, 1)) continue;
        meaning->spacing[axis] = fabs(high - low) / size * mm;
        info->transform.origin[axis] = fmin(low, high) * mm + meaning->spacing[axis] / 2;
    }
    meaning->channels = count_imaris(file, &at, &at.channel);
    meaning->level = (int)at.level;
    meaning->levels = count_imaris(file, &at, &at.level);
    const int times = count_imaris(file, &at, &at.time);
    iso_volume_note(info, "Imaris: resolution level %u of %d, time %u of %d", at.level, meaning->levels,
                    at.time, times);
}

/* "1.000 0.500 0.000". */
static bool read_imaris_color(hid_t channel, iso_rgb *color) {
    double parts[3];
    if (iso_hdf5_numbers(channel, "Color", parts, 3) != 3) return false;
    for (int i = 0; i < 3; i++)
        if (!(parts[i] >= 0 && parts[i] <= 1)) return false;
    *color = (iso_rgb){(uint8_t)(255 * parts[0] + 0.5), (uint8_t)(255 * parts[1] + 0.5),
                       (uint8_t)(255 * parts[2] + 0.5)};
    return true;
}

void iso_hdf5_name_channels(const iso_hdf5_file *file, const iso_hdf5_array *array, int count,
                            iso_channels *channels) {
    imaris_place place;
    bool stated = false;
    if (!is_imaris(array, &place)) return;
    for (int i = 0; i < count && i < ISO_CHANNELS; i++) {
        iso_channel *channel = &channels->items[i];
        char path[WORD];
        snprintf(path, sizeof path, "/DataSetInfo/Channel %d", i);
        const hid_t group = iso_hdf5_group(file->id, path);
        if (group < 0) continue;
        const bool named = iso_hdf5_text(group, "Name", 0, channel->name, sizeof channel->name);
        channel->colored = read_imaris_color(group, &channel->color);
        stated = stated || named || channel->colored;
    }
    if (stated) channels->count = count;
}

/* ---- BigDataViewer ---- */

static const char bdv_format[] = "/t%5u/s%2u/%u/cells";

static hid_t default_of_bdv(const iso_hdf5_file *file, int level) {
    char path[WORD];
    snprintf(path, sizeof path, "/t00000/s00/%d/cells", level);
    return iso_hdf5_dataset(file->id, path);
}

/* The reduction of a level along x, y and z. */
static bool read_reduction(const iso_hdf5_file *file, unsigned setup, unsigned level, double factors[3],
                           int *levels) {
    enum { MOST_LEVELS = 64 };
    char path[WORD];
    double values[MOST_LEVELS][3];
    hsize_t sizes[2] = {0, 0};
    snprintf(path, sizeof path, "/s%02u/resolutions", setup);
    const hid_t dataset = iso_hdf5_dataset(file->id, path);
    const hid_t space = dataset >= 0 ? H5Dget_space(dataset) : -1;
    if (space < 0 || H5Sget_simple_extent_ndims(space) != 2) return false;
    H5Sget_simple_extent_dims(space, sizes, NULL);
    if (sizes[0] > MOST_LEVELS || sizes[1] != 3 || level >= sizes[0]) return false;
    const hid_t creation = H5Dget_create_plist(dataset);
    if (H5Pget_external_count(creation) > 0 || H5Pget_layout(creation) == H5D_VIRTUAL) return false;
    if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) return false;
    memcpy(factors, values[level], sizeof values[level]);
    *levels = (int)sizes[0];
    return factors[0] > 0 && factors[1] > 0 && factors[2] > 0;
}

/* Sets the transform of the finest level from the .xml. */
static iso_status take_view(const iso_hdf5_file *file, const iso_bdv_view *view, iso_hdf5_meaning *meaning,
                            iso_volume_info *info, iso_error *error) {
    const double unit = iso_format_unit(view->unit), mm = unit > 0 ? unit : 1;
    double lengths[3], ratio = 1; /* how many units a unit of the affine map is */
    meaning->relative = !(view->has_size && unit > 0);
    for (int i = 0; i < 3; i++) {
        const double *map = view->affine;
        lengths[i] = view->has_affine
                         ? sqrt(map[i] * map[i] + map[4 + i] * map[4 + i] + map[8 + i] * map[8 + i])
                         : view->size[i];
        if (!(lengths[i] > 0 && isfinite(lengths[i])))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: its transforms make voxels flat", file->xml);
        if (view->has_size) ratio *= view->size[i] / lengths[i];
    }
    ratio = cbrt(ratio);
    /* Programs write transforms in the unit of the voxels' size, or in voxels. */
    if (fabs(log(ratio)) < 0.2) ratio = 1;
    if (ratio != 1)
        iso_volume_note(info, "BigDataViewer: the transforms are in voxels: scaled by %g, to the voxelSize",
                        ratio);
    for (int i = 0; i < 3; i++) {
        meaning->spacing[i] = lengths[i] * ratio * mm;
        for (int row = 0; row < 3 && view->has_affine; row++)
            info->transform.direction[3 * row + i] = view->affine[4 * row + i] / lengths[i];
        if (view->has_affine) info->transform.origin[i] = view->affine[4 * i + 3] * ratio * mm;
    }
    return ISO_OK;
}

/* *found: whether the array is one of BigDataViewer. */
static iso_status interpret_bdv(const iso_hdf5_file *file, iso_hdf5_array *array, iso_hdf5_meaning *meaning,
                                iso_volume_info *info, bool *found, iso_error *error) {
    unsigned time, setup, level;
    double factors[3], shift[3];
    iso_bdv_view view = {.has_size = false};
    *found = sscanf(array->path, bdv_format, &time, &setup, &level) == 3 &&
             read_reduction(file, setup, level, factors, &meaning->levels);
    if (!*found) return ISO_OK;
    meaning->level = (int)level;
    if (array->scalar == ISO_SCALAR_INT16) array->scalar = ISO_SCALAR_UINT16; /* Java has no such type */
    meaning->relative = true;
    for (int axis = 0; axis < 3; axis++) meaning->spacing[axis] = 1;
    if (file->xml) ISO_TRY(iso_bdv_read_view(file->xml, time, setup, &view, error));
    if (view.has_size || view.has_affine) ISO_TRY(take_view(file, &view, meaning, info, error));
    for (int axis = 0; axis < 3; axis++) {
        meaning->spacing[axis] *= factors[axis];
        shift[axis] = (factors[axis] - 1) / 2 / factors[axis]; /* a voxel is the mean of `factors` ones */
    }
    move_origin(&info->transform, meaning->spacing, shift);
    iso_volume_note(info, "BigDataViewer: time %u, setup %u, level %u of %d", time, setup, level,
                    meaning->levels);
    return ISO_OK;
}

/* ---- NeXus ---- */

static bool has_class(hid_t group, const char *wanted) {
    char name[WORD];
    return iso_hdf5_text(group, "NX_class", 0, name, sizeof name) && strcmp(name, wanted) == 0;
}

typedef struct search {
    const char *wanted;
    char name[WORD];
} search;

static herr_t find_class(hid_t group, const char *name, const H5L_info_t *link, void *context) {
    search *found = context;
    if (link->type == H5L_TYPE_EXTERNAL) return 0;
    const hid_t child = iso_hdf5_group(group, name);
    const bool fits = child >= 0 && has_class(child, found->wanted);
    if (child >= 0) H5Oclose(child);
    if (fits) snprintf(found->name, sizeof found->name, "%s", name);
    return fits;
}

/* The child that the attribute `default` names, else the first of this class. */
static hid_t default_child(hid_t group, const char *wanted) {
    search found = {.wanted = wanted};
    if (iso_hdf5_text(group, "default", 0, found.name, sizeof found.name)) {
        const hid_t child = iso_hdf5_group(group, found.name);
        if (child >= 0) return child;
    }
    H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, find_class, &found);
    return *found.name ? iso_hdf5_group(group, found.name) : -1;
}

/* Files before 2014 mark the array itself: its attribute signal is 1. */
static herr_t find_marked(hid_t group, const char *name, const H5L_info_t *link, void *context) {
    double signal = 0;
    char text[WORD] = "";
    if (link->type == H5L_TYPE_EXTERNAL) return 0;
    const hid_t child = iso_hdf5_dataset(group, name);
    if (child < 0) return 0;
    if (iso_hdf5_text(child, "signal", 0, text, sizeof text))
        signal = strtod(text, NULL);
    else
        iso_hdf5_numbers(child, "signal", &signal, 1);
    H5Oclose(child);
    if (signal == 1) snprintf(context, WORD, "%s", name);
    return signal == 1;
}

/* A file's root leads to an entry, this to data, and these to their signal. */
hid_t iso_hdf5_signal(hid_t group) {
    char name[WORD] = "";
    const hid_t entry = has_class(group, "NXdata") ? -1 : default_child(group, "NXentry");
    const hid_t parent = entry >= 0 ? entry : group;
    hid_t data = has_class(parent, "NXdata") ? parent : default_child(parent, "NXdata");
    if (data < 0) data = parent;
    if (!iso_hdf5_text(data, "signal", 0, name, sizeof name))
        H5Literate(data, H5_INDEX_NAME, H5_ITER_INC, NULL, find_marked, name);
    return *name ? iso_hdf5_dataset(data, name) : -1;
}

/* ---- ITK ---- */

static bool read_exactly(hid_t group, const char *name, double *numbers, uint64_t wanted) {
    uint64_t count = 0;
    const hid_t dataset = iso_hdf5_dataset(group, name);
    double *values = dataset >= 0 ? iso_hdf5_values(dataset, wanted, &count) : NULL;
    if (values && count == wanted) memcpy(numbers, values, (size_t)wanted * sizeof *numbers);
    free(values);
    return count == wanted;
}

/* Origin, Spacing and Directions lie beside the voxels; a row of Directions is that of an axis. */
static bool interpret_itk(const iso_hdf5_file *file, const iso_hdf5_array *array, iso_hdf5_meaning *meaning,
                          iso_volume_info *info) {
    double directions[9];
    const hid_t group = iso_hdf5_group(file->id, "/ITKImage/0");
    if (group < 0 || strcmp(array->path, "/ITKImage/0/VoxelData") != 0) return false;
    if (!read_exactly(group, "Spacing", meaning->spacing, 3)) return false;
    read_exactly(group, "Origin", info->transform.origin, 3);
    if (!read_exactly(group, "Directions", directions, 9)) return true;
    for (int i = 0; i < 9; i++) info->transform.direction[i] = directions[i % 3 * 3 + i / 3];
    return true;
}

/* ---- an attribute ---- */

/* element_size_um: along z, y and x, as Fiji, ilastik and others write it. */
static void interpret_element_size(const iso_hdf5_file *file, const iso_hdf5_array *array,
                                   iso_hdf5_meaning *meaning) {
    double sizes[3];
    const hid_t dataset = iso_hdf5_dataset(file->id, array->path);
    if (dataset < 0 || iso_hdf5_numbers(dataset, "element_size_um", sizes, 3) != 3) return;
    for (int i = 0; i < 3; i++)
        if (isfinite(sizes[2 - i]) && sizes[2 - i] > 0) meaning->spacing[i] = sizes[2 - i] * 1e-3;
}

bool iso_hdf5_unclear_distance(const iso_hdf5_file *file, const iso_hdf5_array *array, char *text,
                               size_t room) {
    static const char *const names[] = {"resolution", "voxel_size", "voxelsize",  "voxelSize",
                                        "spacing",    "pixel_size", "pixelSizes", "pixdim"};
    double sizes[3];
    const hid_t dataset = iso_hdf5_dataset(file->id, array->path);
    for (size_t i = 0; dataset >= 0 && i < sizeof names / sizeof *names; i++) {
        if (iso_hdf5_numbers(dataset, names[i], sizes, 3) != 3) continue;
        snprintf(text, room, "its attribute %s is %g %g %g", names[i], sizes[0], sizes[1], sizes[2]);
        return true;
    }
    return false;
}

/* ---- all of them ---- */

iso_status iso_hdf5_default(const iso_hdf5_file *file, const iso_volume_opts *opts, hid_t *dataset,
                            iso_error *error) {
    const int level = opts->level > 0 ? opts->level : 0;
    imaris_place place = {.level = (unsigned)level,
                          .channel = opts->component > 0 ? (unsigned)opts->component : 0};
    ISO_TRY(default_of_vtk(file, dataset, error));
    if (*dataset < 0) *dataset = imaris_array(file, &place);
    place.level = place.channel = 0; /* that there is no such level or component is found out later */
    if (*dataset < 0) *dataset = imaris_array(file, &place);
    if (*dataset < 0) *dataset = default_of_bdv(file, level);
    if (*dataset < 0) *dataset = default_of_bdv(file, 0);
    if (*dataset < 0) *dataset = iso_hdf5_minc_image(file);
    if (*dataset < 0) *dataset = iso_hdf5_signal(iso_hdf5_group(file->id, "/"));
    return ISO_OK;
}

iso_status iso_hdf5_interpret(const iso_hdf5_file *file, iso_hdf5_array *array, iso_hdf5_meaning *meaning,
                              iso_volume_info *info, iso_error *error) {
    imaris_place place;
    if (iso_hdf5_is_minc(array)) return iso_hdf5_minc_geometry(file, array, meaning, info, error);
    interpret_element_size(file, array, meaning);
    if (meaning->spacing[0] > 0) return ISO_OK;
    if (strncmp(array->path, "/VTKHDF/", 8) == 0)
        interpret_vtk(file, array, meaning, info);
    else if (is_imaris(array, &place))
        interpret_imaris(file, array, &place, meaning, info);
    else {
        bool is_bdv;
        ISO_TRY(interpret_bdv(file, array, meaning, info, &is_bdv, error));
        if (!is_bdv && !interpret_itk(file, array, meaning, info))
            iso_hdf5_take_coordinates(file, array, meaning, info);
    }
    return ISO_OK;
}
