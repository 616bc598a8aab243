/* format_arrays: chooses an array in files that can have several, over the points or the cells of an image:
 * .vti and legacy .vtk. */
#include <stdio.h>
#include <string.h>

#include "grids/volume/format.h"

/* The number of tuples that an array must have: that of the points or of the cells. */
static uint64_t wanted_tuples(const iso_format_image *image, bool cells) {
    uint64_t count = 1;
    for (int i = 0; i < 3; i++) {
        uint64_t size = image->points[i];
        if (cells && size > 1) size--;
        if (__builtin_mul_overflow(count, size, &count)) return UINT64_MAX;
    }
    return count;
}

static int find_named(const iso_format_image *image, const char *name) {
    for (int i = 0; i < image->count; i++)
        if (strcmp(image->arrays[i].name, name) == 0) return i;
    return -1;
}

static int rank_of(const iso_format_array *array, bool vectors) {
    if (!vectors) return 1 + 2 * !array->cells + array->active;
    return 1 + 4 * iso_format_are_vectors(array->components) + 2 * (array->scalar != ISO_SCALAR_UINT8) +
           !array->cells;
}

static int find_best(const iso_format_image *image, bool vectors) {
    int best = -1, best_rank = 0;
    for (int i = 0; i < image->count; i++) {
        const int rank = rank_of(&image->arrays[i], vectors);
        if (rank > best_rank) best = i, best_rank = rank;
    }
    return best;
}

/* Moves the origin from the first point to the centre of the first cell, by half a step on every axis with
 * cells. */
static void shift_to_cells(const iso_format_image *image, iso_transform *transform) {
    for (int axis = 0; axis < 3; axis++) {
        if (image->points[axis] < 2) continue;
        for (int i = 0; i < 3; i++)
            transform->origin[i] += 0.5 * transform->spacing[axis] * transform->direction[3 * i + axis];
    }
}

static void list_arrays(const iso_volume_opts *opts, const iso_format_image *image, int chosen,
                        iso_volume_info *info) {
    for (int i = 0; i < image->count && i < ISO_VOLUME_ITEMS; i++) {
        const iso_format_array *array = &image->arrays[i];
        snprintf(info->items[info->item_count++], ISO_VOLUME_TEXT, "%.128s: %s, %llu component%s, of %s",
                 array->name, iso_scalar_name(array->scalar), (unsigned long long)array->components,
                 array->components == 1 ? "" : "s", array->cells ? "cells" : "points");
    }
    if (image->count > 1 && !(opts->component_axes && opts->grid))
        iso_volume_note(info, "several arrays: using '%.80s' of %d (%s)", image->arrays[chosen].name,
                        image->count, opts->component_axes ? "--vectors" : "--grid");
    if (image->arrays[chosen].cells) iso_volume_note(info, "values of cells: voxels are the cells' centres");
}

/* There is no array of this name: says which there are. */
static iso_status fail_name(const char *path, const char *name, const iso_format_image *image,
                            iso_error *error) {
    char names[600] = "";
    for (int i = 0; i < image->count; i++) {
        const size_t used = strlen(names);
        if (used > sizeof names - 100) {
            snprintf(names + used, sizeof names - used, " and %d more", image->count - i);
            break;
        }
        snprintf(names + used, sizeof names - used, "%s'%.64s'", i ? ", " : "", image->arrays[i].name);
    }
    return iso_fail(error, ISO_ERR_USAGE, "%s: no array '%.80s', there %s %s", path, name,
                    image->count == 1 ? "is" : "are", names);
}

iso_status iso_format_take_array(const char *path, const iso_volume_opts *opts, const iso_format_image *image,
                                 iso_volume_info *info, int *chosen, iso_error *error) {
    if (image->count == 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: the image holds no array of numbers", path);
    *chosen = opts->grid ? find_named(image, opts->grid) : find_best(image, opts->component_axes);
    if (*chosen < 0) return fail_name(path, opts->grid, image, error);
    const iso_format_array *array = &image->arrays[*chosen];
    uint64_t dims[3], wanted = wanted_tuples(image, array->cells);
    for (int i = 0; i < 3; i++) dims[i] = image->points[i] - (array->cells && image->points[i] > 1);
    ISO_TRY(iso_format_dims(path, dims, info, error));
    if (array->tuples != wanted)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: array '%.80s' has %llu values for %llu voxels", path,
                        array->name, (unsigned long long)array->tuples, (unsigned long long)wanted);
    int components = array->components > INT32_MAX ? 0 : (int)array->components;
    ISO_TRY(iso_format_component(path, opts, components, info, error));
    info->type = iso_scalar_stored_type(array->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(array->scalar));
    snprintf(info->name, sizeof info->name, "%s", array->name);
    if (array->cells) shift_to_cells(image, &info->transform);
    list_arrays(opts, image, *chosen, info);
    return ISO_OK;
}
