/* ome: reads the metadata of a multiscale image of OME-Zarr 0.4 (.zattrs) and 0.5 (zarr.json). */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "grids/volume/zarr/zarr.h"

/* The metadata that is being read. */
typedef struct metadata {
    const char *folder, *path; /* of the image; of the JSON file, for messages */
    const json_t *json;        /* attributes: of 0.5, the member "ome" of them */
    iso_zarr_image *image;
} metadata;

static iso_status refuse(const metadata *m, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", m->path, what);
}

/* ---- axes */

/* Millimetres of a unit of length as UDUNITS-2 calls it, which OME-Zarr asks for, or by its symbol; 0: not
 * known. */
double iso_zarr_unit_in_mm(const char *unit) {
    static const struct {
        const char *name, *symbol;
        double mm;
    } units[] = {{"angstrom", "A", 1e-7},    {"picometer", "pm", 1e-9},     {"nanometer", "nm", 1e-6},
                 {"micrometer", "um", 1e-3}, {"micron", "\xc2\xb5m", 1e-3}, {"millimeter", "mm", 1},
                 {"centimeter", "cm", 10},   {"decimeter", "dm", 100},      {"meter", "m", 1000},
                 {"kilometer", "km", 1e6},   {"inch", "in", 25.4},          {"foot", "ft", 304.8},
                 {"yard", "yd", 914.4}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcasecmp(unit, units[i].name) == 0 || strcmp(unit, units[i].symbol) == 0) return units[i].mm;
    return 0;
}

static void copy_name(const json_t *json, char name[ISO_ZARR_NAME]) {
    const char *text = json_string_value(json);
    if (text) snprintf(name, ISO_ZARR_NAME, "%s", text);
}

/* Axes are objects in 0.4 and 0.5, and were names in 0.3. */
static iso_status read_axes(const metadata *m, const json_t *scales, iso_error *error) {
    iso_zarr_image *image = m->image;
    const json_t *axes = json_object_get(scales, "axes");
    const size_t count = json_array_size(axes);
    if (count < 2 || count > ISO_ZARR_AXES) return refuse(m, "has no list of 2 to 8 axes", error);
    image->axes = (int)count;
    for (size_t i = 0; i < count; i++) {
        const json_t *axis = json_array_get(axes, i);
        copy_name(json_is_string(axis) ? axis : json_object_get(axis, "name"), image->axis_names[i]);
        copy_name(json_object_get(axis, "type"), image->axis_types[i]);
        const char *unit = json_string_value(json_object_get(axis, "unit"));
        if (unit) image->units[i] = iso_zarr_unit_in_mm(unit);
    }
    return ISO_OK;
}

/* ---- levels */

/* A path to a folder below the image's: names separated by /, none of them "", "." or "..". */
static bool is_below(const char *path) {
    for (const char *at = path;; at++) {
        const size_t length = strcspn(at, "/");
        if (length == 0 || (length == 1 && *at == '.') || (length == 2 && at[0] == '.' && at[1] == '.'))
            return false;
        for (size_t i = 0; i < length; i++)
            if ((unsigned char)at[i] < 32) return false;
        at += length;
        if (!*at) return true;
    }
}

/* Multiplies a list of scales into `scale`, adds a list of translations to `translation`. */
static iso_status apply_transforms(const metadata *m, const json_t *list, int level, iso_error *error) {
    iso_zarr_image *image = m->image;
    double *scale = image->scale[level], *translation = image->translation[level];
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *transform = json_array_get(list, i);
        const char *type = json_string_value(json_object_get(transform, "type"));
        const bool is_scale = type && strcmp(type, "scale") == 0;
        if (type && strcmp(type, "identity") == 0) continue;
        if (!is_scale && !(type && strcmp(type, "translation") == 0))
            return iso_fail(error, ISO_ERR_FORMAT,
                            "%s: the coordinate transformation \"%.40s\" is not supported", m->path,
                            type ? type : "");
        const json_t *numbers = json_object_get(transform, type);
        if (json_array_size(numbers) != (size_t)image->axes)
            return refuse(m, "a coordinate transformation has not a number for each axis", error);
        for (int axis = 0; axis < image->axes; axis++) {
            double number;
            if (!iso_zarr_number(json_array_get(numbers, (size_t)axis), is_scale ? 1e-100 : -1e100, 1e100,
                                 &number))
                return refuse(m, "a coordinate transformation is not of possible numbers", error);
            if (is_scale) scale[axis] *= number;
            translation[axis] = is_scale ? translation[axis] * number : translation[axis] + number;
        }
        image->has_scale |= is_scale;
    }
    return ISO_OK;
}

static iso_status read_levels(const metadata *m, const json_t *scales, iso_error *error) {
    iso_zarr_image *image = m->image;
    const json_t *datasets = json_object_get(scales, "datasets");
    const size_t count = json_array_size(datasets);
    if (count == 0 || count > ISO_ZARR_LEVELS) return refuse(m, "has no list of 1 to 32 datasets", error);
    for (size_t i = 0; i < count; i++) {
        const json_t *dataset = json_array_get(datasets, i);
        const char *path = json_string_value(json_object_get(dataset, "path"));
        if (!path || !is_below(path)) return refuse(m, "the path of a dataset is no folder below it", error);
        if (asprintf(&image->paths[i], "%s/%s", m->folder, path) < 0) {
            image->paths[i] = NULL;
            return iso_fail_memory(error, m->path);
        }
        image->levels++;
        for (int axis = 0; axis < image->axes; axis++) image->scale[i][axis] = 1;
        ISO_TRY(apply_transforms(m, json_object_get(dataset, "coordinateTransformations"), (int)i, error));
        ISO_TRY(apply_transforms(m, json_object_get(scales, "coordinateTransformations"), (int)i, error));
    }
    return ISO_OK;
}

/* ---- channels */

/* "RRGGBB". */
static bool parse_color(const char *text, iso_rgb *color) {
    if (!text || strspn(text, "0123456789abcdefABCDEF") != 6 || text[6]) return false;
    const unsigned long rgb = strtoul(text, NULL, 16);
    *color = (iso_rgb){(uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8), (uint8_t)rgb};
    return true;
}

static void read_channels(const metadata *m) {
    const json_t *list = json_object_get(json_object_get(m->json, "omero"), "channels");
    iso_channels *channels = &m->image->channels;
    for (size_t i = 0; i < json_array_size(list) && channels->count < ISO_CHANNELS; i++) {
        const json_t *stated = json_array_get(list, i);
        iso_channel *channel = &channels->items[channels->count++];
        const char *label = json_string_value(json_object_get(stated, "label"));
        if (label) snprintf(channel->name, sizeof channel->name, "%s", label);
        channel->colored = parse_color(json_string_value(json_object_get(stated, "color")), &channel->color);
    }
}

static iso_status read_scales(const metadata *m, iso_error *error) {
    const json_t *list = json_object_get(m->json, "multiscales"), *scales = json_array_get(list, 0);
    iso_zarr_image *image = m->image;
    if (!json_is_object(scales)) return refuse(m, "its multiscales are not a list of objects", error);
    const char *name = json_string_value(json_object_get(scales, "name"));
    if (name) snprintf(image->name, sizeof image->name, "%s", name);
    copy_name(json_object_get(scales, "version"), image->version);
    copy_name(json_object_get(m->json, "version"), image->version);
    read_channels(m);
    ISO_TRY(read_axes(m, scales, error));
    return read_levels(m, scales, error);
}

/* ---- folders of images */

/* Whether bioformats2raw has written one image, "0", into the folder. */
static bool is_converted(const json_t *attributes) {
    return json_object_get(attributes, "bioformats2raw.layout") != NULL;
}

static iso_status refuse_folder(const char *folder, const json_t *attributes, iso_error *error) {
    if (json_object_get(attributes, "plate") || json_object_get(attributes, "well"))
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: is a plate or well of images: give the folder of one of them, such as %s/A/1/0",
                        folder, folder);
    if (!attributes && iso_is_url(folder))
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: holds no Zarr or N5: no zarr.json, .zattrs, .zarray or attributes.json", folder);
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: is a group without an image: give the folder of an image or array in it", folder);
}

/* ---- both versions */

/* Reads the attributes: of zarr.json, else of .zattrs. *attributes: NULL: there are none. */
static iso_status read_attributes(const char *folder, const iso_volume_opts *opts, char **path,
                                  json_t **owner, const json_t **attributes, iso_error *error) {
    static const char *const files[] = {"zarr.json", ".zattrs"};
    *path = NULL;
    *owner = NULL;
    for (int i = 0; i < 2 && !*owner; i++) {
        free(*path);
        *path = NULL;
        ISO_TRY(iso_zarr_read_json(folder, files[i], opts, owner, error));
        if (*owner && asprintf(path, "%s/%s", folder, files[i]) < 0) {
            *path = NULL;
            return iso_fail_memory(error, folder);
        }
        if (*owner) iso_file_set_read(opts->files, *path);
        *attributes = i ? *owner : json_object_get(*owner, "attributes");
    }
    return ISO_OK;
}

static iso_status read_in(const char *folder, const iso_volume_opts *opts, int depth, iso_zarr_image *image,
                          bool *found, iso_error *error);

static iso_status read_first_image(const char *folder, const iso_volume_opts *opts, int depth,
                                   iso_zarr_image *image, bool *found, iso_error *error) {
    char *path;
    if (asprintf(&path, "%s/0", folder) < 0) return iso_fail_memory(error, folder);
    const iso_status status = read_in(path, opts, depth + 1, image, found, error);
    free(path);
    return status;
}

/* Whether a folder may have an array of Zarr 2 or N5. */
static bool is_array(const char *folder, const iso_volume_opts *opts) {
    json_t *v2, *n5 = NULL;
    bool found = iso_zarr_read_json(folder, ".zarray", opts, &v2, NULL) != ISO_OK || v2;
    if (!found) found = iso_zarr_read_json(folder, "attributes.json", opts, &n5, NULL) != ISO_OK || n5;
    json_decref(v2);
    json_decref(n5);
    return found;
}

static iso_status read_in(const char *folder, const iso_volume_opts *opts, int depth, iso_zarr_image *image,
                          bool *found, iso_error *error) {
    char *path;
    json_t *owner;
    const json_t *attributes = NULL;
    iso_status status = read_attributes(folder, opts, &path, &owner, &attributes, error);
    const json_t *ome = json_object_get(attributes, "ome");
    const char *node = json_string_value(json_object_get(owner, "node_type"));
    const metadata m = {folder, path, ome ? ome : attributes, image};
    *found = false;
    if (status == ISO_OK && json_object_get(m.json, "multiscales")) {
        *found = true;
        status = read_scales(&m, error);
    } else if (status == ISO_OK && is_converted(m.json) && depth == 0) {
        status = read_first_image(folder, opts, depth, image, found, error);
    } else if (status == ISO_OK && !(node && strcmp(node, "array") == 0) && !is_array(folder, opts)) {
        status = refuse_folder(folder, m.json, error);
    }
    json_decref(owner);
    free(path);
    return status;
}

iso_status iso_zarr_read_image(const char *folder, const iso_volume_opts *opts, iso_zarr_image *image,
                               bool *found, iso_error *error) {
    *image = (iso_zarr_image){0};
    return read_in(folder, opts, 0, image, found, error);
}

void iso_zarr_image_free(iso_zarr_image *image) {
    for (int i = 0; i < image->levels; i++) free(image->paths[i]);
    *image = (iso_zarr_image){0};
}
