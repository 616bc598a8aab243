/* minc: geometry and values of MINC 2 files, by "MINC 2.0 File Format Reference".
 *
 * A position is the sum over the axes of space of (start + step * index) * direction_cosines, in RAS. Values
 * of integer arrays are scaled so that the ends of valid_range become image-min and image-max, which may be
 * those of a slice. */
#include "grids/volume/hdf5/conventions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORD = 128 };

static const char image_path[] = "/minc-2.0/image/0/image";

hid_t iso_hdf5_minc_image(const iso_hdf5_file *file) {
    return iso_hdf5_dataset(file->id, image_path);
}

bool iso_hdf5_is_minc(const iso_hdf5_array *array) {
    return strncmp(array->path, "/minc-2.0/image/", 16) == 0;
}

/* The name of an axis of the array: dimorder is a list of all, such as "zspace,yspace,xspace". */
static bool name_axis(hid_t image, int axis, char name[WORD]) {
    char order[WORD * ISO_HDF5_AXES];
    const char *at = order;
    if (!iso_hdf5_text(image, "dimorder", 0, order, sizeof order)) return false;
    for (; axis > 0; axis--) {
        at = strchr(at, ',');
        if (!at++) return false;
    }
    snprintf(name, WORD, "%.*s", (int)strcspn(at, ","), at);
    return *name != 0;
}

/* Sets the direction of axis i of the volume, and adds what its start adds to the origin. */
static iso_status place_axis(const iso_hdf5_file *file, const iso_hdf5_array *array, const char *name, int i,
                             iso_hdf5_meaning *meaning, iso_volume_info *info, iso_error *error) {
    char path[WORD + 32], text[WORD] = "";
    double start = 0, step = 1, cosines[3] = {name[0] == 'x', name[0] == 'y', name[0] == 'z'};
    snprintf(path, sizeof path, "/minc-2.0/dimensions/%s", name);
    const hid_t axis =
        strchr("xyz", name[0]) && strcmp(name + 1, "space") == 0 ? iso_hdf5_object(file->id, path) : -1;
    if (axis < 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: the axis \"%.40s\" of %.80s is not one of space",
                        file->path, name, array->path);
    if (iso_hdf5_text(axis, "spacing", 0, text, sizeof text) && strncmp(text, "irregular", 9) == 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: the slices along %s are not evenly spaced",
                        file->path, name);
    const double mm = iso_hdf5_text(axis, "units", 0, text, sizeof text) && iso_format_unit(text) > 0
                          ? iso_format_unit(text)
                          : 1;
    iso_hdf5_numbers(axis, "start", &start, 1);
    iso_hdf5_numbers(axis, "step", &step, 1);
    iso_hdf5_numbers(axis, "direction_cosines", cosines, 3);
    for (int row = 0; row < 3; row++) {
        const double lps = row < 2 ? -cosines[row] : cosines[row];
        info->transform.direction[3 * row + i] = step < 0 ? -lps : lps;
        info->transform.origin[row] += lps * start * mm;
    }
    meaning->spacing[i] = fabs(step) * mm;
    return ISO_OK;
}

iso_status iso_hdf5_minc_geometry(const iso_hdf5_file *file, const iso_hdf5_array *array,
                                  iso_hdf5_meaning *meaning, iso_volume_info *info, iso_error *error) {
    const hid_t image = iso_hdf5_dataset(file->id, array->path);
    char name[WORD];
    for (int i = 0; i < 3; i++) {
        if (!name_axis(image, array->xyz[i], name))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: the dimorder of %.80s does not name its axes",
                            file->path, array->path);
        ISO_TRY(place_axis(file, array, name, i, meaning, info, error));
    }
    return ISO_OK;
}

/* ---- values ---- */

/* Reads the array `name` beside the image. */
static double *read_beside(const iso_hdf5_file *file, const iso_hdf5_array *array, const char *name,
                           uint64_t *count) {
    enum { MOST = 1 << 20 };
    char path[ISO_HDF5_PATH + 16];
    snprintf(path, sizeof path, "%.*s/%s", (int)(strrchr(array->path, '/') - array->path), array->path, name);
    const hid_t dataset = iso_hdf5_dataset(file->id, path);
    return dataset < 0 ? NULL : iso_hdf5_values(dataset, MOST, count);
}

/* The least and the greatest value of integers of these bits. */
static void range_of(iso_scalar scalar, double range[2]) {
    const int bits = 8 * (int)iso_scalar_size(scalar);
    const bool is_signed = scalar == ISO_SCALAR_INT8 || scalar == ISO_SCALAR_INT16 ||
                           scalar == ISO_SCALAR_INT32 || scalar == ISO_SCALAR_INT64;
    range[0] = is_signed ? -ldexp(1, bits - 1) : 0;
    range[1] = ldexp(1, is_signed ? bits - 1 : bits) - 1;
}

/* Which of the values of image-max is that of slice z: they are one for each place on the slowest axes. */
static uint64_t place_of_slice(const iso_hdf5_array *array, uint64_t count, uint64_t z, bool *found) {
    uint64_t place = 0, places = 1;
    for (int axis = 0; axis < array->rank && places < count; axis++) {
        if (axis == array->xyz[0] || axis == array->xyz[1]) break;
        place = place * array->sizes[axis] + (axis == array->xyz[2] ? z : array->at[axis]);
        places *= array->sizes[axis];
    }
    *found = places == count;
    return place;
}

iso_status iso_hdf5_minc_scales(const iso_hdf5_file *file, const iso_hdf5_array *array, iso_volume_info *info,
                                iso_hdf5_slices *slices, iso_error *error) {
    uint64_t counts[2] = {0, 0};
    double range[2];
    bool found = true, alike = true;
    if (array->scalar >= ISO_SCALAR_FLOAT) return ISO_OK;
    range_of(array->scalar, range);
    iso_hdf5_numbers(iso_hdf5_dataset(file->id, array->path), "valid_range", range, 2);
    double *low = read_beside(file, array, "image-min", &counts[0]),
           *high = read_beside(file, array, "image-max", &counts[1]);
    found = low && high && counts[0] == counts[1] && info->dims[2] <= ISO_HDF5_SLICES && range[0] < range[1];
    for (int z = 0; found && z < info->dims[2]; z++) {
        const uint64_t place = place_of_slice(array, counts[0], (uint64_t)z, &found);
        if (!found) break;
        const double scale = (high[place] - low[place]) / (range[1] - range[0]);
        slices->scale[z] = scale;
        slices->offset[z] = low[place] - range[0] * scale;
        alike = alike && scale > 0 && scale == slices->scale[0] && slices->offset[z] == slices->offset[0];
    }
    free(low);
    free(high);
    if (!found && counts[0] + counts[1] > 0)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: image-min, image-max and valid_range do not tell the values of %.80s",
                        file->path, array->path);
    if (!found) return ISO_OK;
    slices->count = alike ? 0 : info->dims[2];
    if (alike) {
        info->scale = slices->scale[0];
        info->offset = slices->offset[0];
    } else {
        info->type = ISO_FLOAT32;
        iso_volume_note(info, "MINC: each slice has a scale of its own");
    }
    return ISO_OK;
}
