/* coordinates: positions of voxels that a file states as an array of numbers for each axis: axes of NeXus,
 * dimension scales of HDF5 (also those of NetCDF), and dim1, dim2, .. of EMD.
 *
 * NeXus: the manual's rules for NXdata. Dimension scales: "HDF5 Dimension Scale Specification". EMD: "EMD
 * file format", versions 0.2 and 1.0, emdatasets.com. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grids/volume/hdf5/conventions.h"

enum { WORD = 128 };

/* ---- where they are ---- */

/* The group that an array is in. */
static hid_t parent_of(const iso_hdf5_file *file, const iso_hdf5_array *array) {
    char path[ISO_HDF5_PATH];
    snprintf(path, sizeof path, "%s", array->path);
    char *slash = strrchr(path, '/');
    if (!slash) return -1;
    slash[slash == path] = 0;
    return iso_hdf5_group(file->id, path);
}

/* NeXus: the attribute axes of the group names an array for each axis; in files before 2014 that of the
 * array, as one text: "z:y:x" or "[z,y,x]". */
static hid_t axis_of_nexus(hid_t group, hid_t array, int axis) {
    char name[WORD], all[WORD * ISO_HDF5_AXES];
    if (iso_hdf5_text(group, "axes", (size_t)axis, name, sizeof name)) return iso_hdf5_dataset(group, name);
    if (!iso_hdf5_text(array, "axes", 0, all, sizeof all)) return -1;
    char *rest = all, *word = NULL;
    for (int i = 0; i <= axis; i++) word = strsep(&rest, ":,");
    if (!word) return -1;
    word += strspn(word, "[ ");
    word[strcspn(word, "] ")] = 0;
    return *word ? iso_hdf5_dataset(group, word) : -1;
}

/* The first scale that is attached to an axis. */
static hid_t attached_scale(hid_t array, int axis, int rank) {
    static const char name[] = "DIMENSION_LIST";
    hvl_t lists[ISO_HDF5_AXES] = {{0, NULL}};
    const hid_t list = H5Aexists(array, name) > 0 ? H5Aopen(array, name, H5P_DEFAULT) : -1;
    if (list < 0 || H5Sget_simple_extent_npoints(H5Aget_space(list)) != rank ||
        H5Aread(list, H5Tvlen_create(H5T_STD_REF_OBJ), lists) < 0 || lists[axis].len < 1)
        return -1;
    const hid_t scale = H5Rdereference2(array, H5P_DEFAULT, H5R_OBJECT, lists[axis].p);
    return scale >= 0 && H5Iget_type(scale) == H5I_DATASET ? scale : -1;
}

/* EMD: the arrays dim1, dim2, .. of the group, of the first axis, the second one, .. */
static hid_t axis_of_emd(hid_t group, int axis) {
    char name[16];
    if (H5Aexists(group, "emd_group_type") <= 0) return -1;
    snprintf(name, sizeof name, "dim%d", axis + 1);
    return iso_hdf5_dataset(group, name);
}

/* ---- what they are ---- */

/* Millimetres of a unit; 0: it is no length. EMD writes "[n_m]" for nanometres. */
static double length_of(const char *unit) {
    char plain[WORD];
    size_t length = 0;
    for (const char *at = unit; *at && length < sizeof plain - 1; at++)
        if (!strchr("[]_ ", *at)) plain[length++] = *at;
    plain[length] = 0;
    if (strcmp(plain, "A") == 0) return iso_format_unit("angstrom");
    if (iso_format_unit(plain) == 0 && length > 1 && plain[length - 1] == 's') plain[length - 1] = 0;
    return iso_format_unit(plain);
}

/* Makes the borders of voxels their centres. */
static void take_centres(double *values, uint64_t *count) {
    --*count;
    for (uint64_t i = 0; i < *count; i++) values[i] = (values[i] + values[i + 1]) / 2;
}

/* The mean distance between coordinates. False: they are not evenly spaced. */
static bool fit_line(const double *values, uint64_t count, double *step) {
    *step = (values[count - 1] - values[0]) / (double)(count - 1);
    for (uint64_t i = 0; i < count; i++)
        if (!(fabs(values[i] - values[0] - (double)i * *step) <= 0.01 * fabs(*step))) return false;
    return true;
}

/* Sets positions; false: the coordinates do not rise or fall, or are too many. */
static bool take_positions(const double *values, uint64_t count, double mm, int i,
                           iso_hdf5_positions *positions) {
    const double scale = values[count - 1] < values[0] ? -mm : mm;
    if (count > ISO_HDF5_POSITIONS) return false;
    for (uint64_t k = 0; k < count; k++) {
        positions->at[i][k] = (values[k] - values[0]) * scale;
        if (k > 0 && !(positions->at[i][k] > positions->at[i][k - 1])) return false;
    }
    positions->count[i] = (int)count;
    return true;
}

/* The world's axis (0: x) that an array of coordinates is named after; -1: another name. EMD names it by an
 * attribute. */
static int named_axis(hid_t scale) {
    char path[ISO_HDF5_PATH] = "", name[WORD];
    if (scale < 0) return -1;
    H5Iget_name(scale, path, sizeof path);
    const char *last = strrchr(path, '/');
    if (!iso_hdf5_text(scale, "name", 0, name, sizeof name))
        snprintf(name, sizeof name, "%.100s", last ? last + 1 : path);
    for (int axis = 0; axis < 3; axis++)
        if (tolower((unsigned char)name[0]) == "xyz"[axis] && !name[1]) return axis;
    return -1;
}

/* Finds the world's axes of the voxels' axes: an array may be stored in the order x, y, z, if it names all
 * three. */
static void find_world_axes(const hid_t scales[3], int world[3], iso_volume_info *info) {
    unsigned seen = 0;
    for (int i = 0; i < 3; i++) {
        world[i] = named_axis(scales[i]);
        if (world[i] >= 0) seen |= 1U << world[i];
    }
    for (int i = 0; i < 3; i++) {
        if (seen != 7) world[i] = i;
        for (int row = 0; row < 3; row++) info->transform.direction[3 * row + i] = row == world[i];
    }
}

/* Places the voxels along their axis i, which is the world's axis `world`, at `count` coordinates. */
static void place_axis_at(hid_t scale, const double *values, uint64_t count, int i, int world,
                          iso_hdf5_meaning *meaning, iso_volume_info *info) {
    const char axis = "xyz"[world];
    char unit[WORD] = "";
    double step;
    const bool is_even = fit_line(values, count, &step);
    if (step == 0 || !isfinite(step)) return; /* a dimension without coordinates (NetCDF) */
    const bool has_unit = iso_hdf5_text(scale, "units", 0, unit, sizeof unit) && *unit;
    const double mm = has_unit ? length_of(unit) : 1;
    if (!has_unit)
        iso_volume_note(info, "the unit of the coordinates along %c is not stated: taken as mm", axis);
    if (mm == 0) {
        iso_volume_note(info, "the coordinates along %c are in \"%.40s\", which is no length, and not used",
                        axis, unit);
        return;
    }
    if (!is_even && !take_positions(values, count, mm, i, meaning->positions))
        iso_volume_note(info,
                        "the coordinates along %c are not evenly spaced and do not rise or fall: drawn at "
                        "their mean distance",
                        axis);
    meaning->spacing[i] = fabs(step) * mm;
    info->transform.origin[world] = values[0] * mm;
    if (step < 0) info->transform.direction[3 * world + i] = -1;
}

static void place_axis(hid_t scale, const iso_hdf5_array *array, int i, int world, iso_hdf5_meaning *meaning,
                       iso_volume_info *info) {
    enum { MOST = 1 << 20 };
    const uint64_t size = array->sizes[array->xyz[i]];
    uint64_t count = 0;
    double *values =
        H5Sget_simple_extent_ndims(H5Dget_space(scale)) == 1 ? iso_hdf5_values(scale, MOST, &count) : NULL;
    if (values && count == size + 1 && size > 1) take_centres(values, &count);
    /* EMD may have the first two only */
    if (values && count >= 2 && (count == size || count == 2))
        place_axis_at(scale, values, count, i, world, meaning, info);
    free(values);
}

void iso_hdf5_take_coordinates(const iso_hdf5_file *file, const iso_hdf5_array *array,
                               iso_hdf5_meaning *meaning, iso_volume_info *info) {
    const hid_t dataset = iso_hdf5_dataset(file->id, array->path), group = parent_of(file, array);
    hid_t scales[3];
    int world[3];
    if (dataset < 0 || group < 0) return;
    for (int i = 0; i < 3; i++) {
        const int axis = array->xyz[i];
        scales[i] = axis_of_nexus(group, dataset, axis);
        if (scales[i] < 0) scales[i] = attached_scale(dataset, axis, array->rank);
        if (scales[i] < 0) scales[i] = axis_of_emd(group, axis);
    }
    find_world_axes(scales, world, info);
    for (int i = 0; i < 3; i++)
        if (scales[i] >= 0) place_axis(scales[i], array, i, world[i], meaning, info);
}
