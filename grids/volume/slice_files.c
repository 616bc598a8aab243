/* slice_files: see the header. */
#include "grids/volume/slice_files.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file_types.h"

static bool is_slice_name(const char *name, iso_slice_kind kind) {
    static const iso_file_type types[] = {ISO_FILE_tiff, ISO_FILE_png, ISO_FILE_jpeg};
    return name[0] != '.' && iso_file_type_of_name(name, ISO_WRITES_IMAGE) == types[kind];
}

bool iso_slice_files_exist(const char *folder, iso_slice_kind kind) {
    DIR *open = opendir(folder);
    bool found = false;
    if (!open) return false;
    for (const struct dirent *entry; !found && (entry = readdir(open));)
        found = is_slice_name(entry->d_name, kind);
    closedir(open);
    return found;
}

static int tiffs_only(const struct dirent *entry) {
    return is_slice_name(entry->d_name, ISO_SLICES_TIFF);
}

static int pngs_only(const struct dirent *entry) {
    return is_slice_name(entry->d_name, ISO_SLICES_PNG);
}

static int jpegs_only(const struct dirent *entry) {
    return is_slice_name(entry->d_name, ISO_SLICES_JPEG);
}

/* Numbers within names are compared by their values: slice_2 before slice_10. */
static int natural_order(const struct dirent **a, const struct dirent **b) {
    return strverscmp((*a)->d_name, (*b)->d_name);
}

static iso_status list_folder(const char *path, iso_slice_kind kind, iso_slice_files *files,
                              iso_error *error) {
    static int (*const filters[])(const struct dirent *) = {tiffs_only, pngs_only, jpegs_only};
    struct dirent **entries = NULL;
    const int count = scandir(path, &entries, filters[kind], natural_order);
    if (count < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    iso_status status = ISO_OK;
    char **paths = files->paths = calloc((size_t)count + 1, sizeof *paths);
    if (!paths) status = iso_fail_memory(error, path);
    for (int i = 0; i < count; i++) {
        if (status == ISO_OK && asprintf(&paths[i], "%s/%s", path, entries[i]->d_name) < 0) {
            paths[i] = NULL;
            status = iso_fail_memory(error, path);
        }
        free(entries[i]);
    }
    free(entries);
    files->count = (uint32_t)count;
    return status;
}

iso_status iso_slice_files_list(const char *path, iso_slice_kind kind, iso_slice_files *files,
                                iso_error *error) {
    struct stat status;
    *files = (iso_slice_files){0};
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) return list_folder(path, kind, files, error);
    files->paths = calloc(1, sizeof *files->paths);
    if (files->paths) files->paths[0] = strdup(path);
    if (!files->paths || !files->paths[0]) return iso_fail_memory(error, path);
    files->count = 1;
    return ISO_OK;
}

void iso_slice_files_free(iso_slice_files *files) {
    for (uint32_t i = 0; files->paths && i < files->count; i++) free(files->paths[i]);
    free(files->paths);
    *files = (iso_slice_files){0};
}

void iso_slice_files_set_spacing(const double stated[3], const iso_volume_opts *opts, iso_volume_info *info) {
    double *spacing = info->transform.spacing;
    for (int i = 0; i < 3; i++) spacing[i] = stated[i];
    if (!(spacing[0] > 0 && spacing[1] > 0)) {
        spacing[0] = spacing[1] = 1;
        info->unitless = true;
        if (!(opts->spacing[0] > 0 && opts->spacing[1] > 0))
            iso_volume_note(info, "the distance of pixels is not stated: 1 mm (--spacing)");
    }
    if (!(spacing[2] > 0)) {
        spacing[2] = spacing[0];
        if (!(opts->spacing[2] > 0))
            iso_volume_note(info, "the distance of slices is not stated: that of pixels, %g mm (--spacing)",
                            spacing[0]);
    }
}
