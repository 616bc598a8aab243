/* stored: lists which files of chunks and shards exist, by reading folders: an array may have any number of
 * chunks that do not exist, so that they cannot be asked for one by one. */
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/zarr/zarr.h"

/* ---- names ---- */

/* A list that is being made. */
typedef struct listing {
    const iso_zarr_array *array;
    const iso_zarr_files *wanted;
    iso_buffer *numbers; /* of files, uint64_t */
    size_t count;
    uint64_t index[ISO_ZARR_AXES]; /* what the names so far say */
    char path[PATH_MAX];
} listing;

/* The axis whose number is at place `i` of a name. */
static int axis_at(const iso_zarr_array *array, int i) {
    return array->n5 ? array->axes - 1 - i : i;
}

/* Reads the number of an axis from a name, without zeros in front of it, and moves behind it. */
static bool take_number(const char **name, uint64_t *number) {
    char *end;
    if (**name < '0' || **name > '9' || (**name == '0' && (*name)[1] >= '0' && (*name)[1] <= '9'))
        return false;
    errno = 0;
    *number = strtoull(*name, &end, 10);
    *name = end;
    return errno == 0;
}

/* Whether the file's number on an axis is one of those that are wanted. */
static bool is_wanted(const listing *l, int axis, uint64_t number) {
    for (int i = 0; i < 3; i++)
        if (l->wanted->space[i] == axis) return number < l->wanted->counts[i];
    return number == l->wanted->fixed[axis];
}

static iso_status add_file(listing *l, iso_error *error) {
    uint64_t number = 0;
    for (int i = 2; i >= 0; i--)
        number =
            number * l->wanted->counts[i] + (l->wanted->space[i] < 0 ? 0 : l->index[l->wanted->space[i]]);
    ISO_TRY(iso_buffer_reserve(l->numbers, (l->count + 1) * sizeof number, l->count * sizeof number, error));
    ((uint64_t *)l->numbers->data)[l->count++] = number;
    return ISO_OK;
}

/* ---- folders ---- */

static iso_status list_names(listing *l, int place, size_t length, iso_error *error);

/* Takes the numbers of a name: all that are left, or one, and then those of the names in the folder. */
static iso_status take_name(listing *l, int place, size_t length, const char *name, iso_error *error) {
    const iso_zarr_array *array = l->array;
    const char *rest = name;
    if (array->separator == '.' && array->has_prefix) {
        if (strncmp(name, "c.", 2) != 0) return ISO_OK;
        rest += 2;
    }
    for (;;) {
        const int axis = axis_at(array, place++);
        if (!take_number(&rest, &l->index[axis]) || !is_wanted(l, axis, l->index[axis])) return ISO_OK;
        if (array->separator == '/' || place == array->axes) break;
        if (*rest++ != '.') return ISO_OK;
    }
    if (*rest) return ISO_OK;
    if (place == array->axes) return add_file(l, error);
    const size_t more = strlen(name) + 1;
    if (length + more >= sizeof l->path) return ISO_OK;
    snprintf(l->path + length, sizeof l->path - length, "/%s", name);
    const iso_status status = list_names(l, place, length + more, error);
    l->path[length] = 0;
    return status;
}

/* Lists the names in the folder l->path, of `length` bytes, which begin with the number at this place. */
static iso_status list_names(listing *l, int place, size_t length, iso_error *error) {
    DIR *folder = opendir(l->path);
    iso_status status = ISO_OK;
    if (!folder && (errno == ENOENT || errno == ENOTDIR)) return ISO_OK;
    if (!folder) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", l->path, strerror(errno));
    for (const struct dirent *entry; status == ISO_OK && (entry = readdir(folder));)
        status = take_name(l, place, length, entry->d_name, error);
    closedir(folder);
    return status;
}

static int compare(const void *a, const void *b) {
    const uint64_t first = *(const uint64_t *)a, second = *(const uint64_t *)b;
    return (first > second) - (first < second);
}

iso_status iso_zarr_files_list(const char *folder, const iso_zarr_array *array, iso_zarr_files *files,
                               iso_error *error) {
    listing l = {.array = array, .wanted = files, .numbers = &files->numbers};
    const bool below = array->has_prefix && array->separator == '/';
    const int length = snprintf(l.path, sizeof l.path, "%s%s", folder, below ? "/c" : "");
    files->count = 0;
    files->may_all_exist = iso_is_url(folder);
    if (files->may_all_exist) return ISO_OK;
    if (length >= (int)sizeof l.path)
        return iso_fail(error, ISO_ERR_IO, "%s: names of its chunks are too long", folder);
    ISO_TRY(list_names(&l, 0, (size_t)length, error));
    if (l.count) qsort(l.numbers->data, l.count, sizeof(uint64_t), compare);
    files->count = l.count;
    return ISO_OK;
}

uint64_t iso_zarr_files_next(const iso_zarr_files *files, uint64_t from) {
    const uint64_t *numbers = files->numbers.data;
    if (files->may_all_exist)
        return from < files->counts[0] * files->counts[1] * files->counts[2] ? from : UINT64_MAX;
    size_t begin = 0, end = files->count;
    while (begin < end) {
        const size_t middle = begin + (end - begin) / 2;
        if (numbers[middle] < from)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin < files->count ? numbers[begin] : UINT64_MAX;
}

void iso_zarr_files_free(iso_zarr_files *files) {
    iso_buffer_free(&files->numbers);
    *files = (iso_zarr_files){.count = 0};
}
