/* folder: reads the headers of the DICOM files in a folder, or in the subfolders of a CD.
 *
 * A folder of images often holds other things: viewers, reports, downloads that were interrupted. They do not
 * stop the images from being read, but are counted, so that the user learns what was left out. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/memory.h"
#include "grids/volume/dicom/dicom.h"

/* Limits of what is read of subfolders. A CD has four levels and some thousand files. */
enum { MAX_LEVELS = 16, MAX_ENTRIES = 1 << 15 };

void iso_dicom_folder_free(iso_dicom_folder *f) {
    for (size_t i = 0; i < f->count; i++) iso_dicom_file_free(&f->files[i]);
    for (size_t i = 0; i < f->damaged_count; i++) {
        iso_dicom_file_free(&f->damaged[i].file);
        free(f->damaged[i].reason);
    }
    free(f->files);
    free(f->damaged);
    free(f->first_left_out);
    *f = (iso_dicom_folder){0};
}

/* ---- one file ---- */

/* The array, perhaps moved, with room for one more element of `size` bytes; NULL, and the array as it was: no
 * memory. */
static void *with_room(void *array, size_t count, size_t *room, size_t size) {
    if (count < *room) return array;
    const size_t more = *room ? 2 * *room : 64;
    void *grown = realloc(array, more * size);
    if (grown) *room = more;
    return grown;
}

static iso_status add_image(iso_dicom_folder *f, iso_dicom_file *file, iso_error *error) {
    iso_dicom_file *files = with_room(f->files, f->count, &f->room, sizeof *files);
    if (!files) return iso_fail_memory(error, f->path);
    f->files = files;
    f->files[f->count++] = *file;
    *file = (iso_dicom_file){0};
    return ISO_OK;
}

static iso_status add_damaged(iso_dicom_folder *f, iso_dicom_file *file, const char *reason,
                              iso_error *error) {
    iso_dicom_damaged *damaged = with_room(f->damaged, f->damaged_count, &f->damaged_room, sizeof *damaged);
    if (!damaged) return iso_fail_memory(error, f->path);
    f->damaged = damaged;
    char *copy = strdup(reason);
    if (!copy) return iso_fail_memory(error, f->path);
    iso_free(file->frames);
    file->frames = NULL;
    f->damaged[f->damaged_count++] = (iso_dicom_damaged){*file, copy};
    *file = (iso_dicom_file){0};
    return ISO_OK;
}

static iso_status leave_out(iso_dicom_folder *f, const char *path, iso_dicom_kind kind, iso_error *error) {
    const char *reason = kind == ISO_DICOM_NOT ? "not a DICOM file" : "holds no image";
    ++*(kind == ISO_DICOM_NOT ? &f->strays : &f->imageless);
    if (!f->first_left_out && asprintf(&f->first_left_out, "%s: %s", path, reason) < 0) {
        f->first_left_out = NULL;
        return iso_fail_memory(error, f->path);
    }
    return ISO_OK;
}

iso_status iso_dicom_folder_add(iso_dicom_folder *f, const char *path, iso_error *error) {
    iso_dicom_file file;
    iso_dicom_kind kind = ISO_DICOM_NOT;
    iso_error detail = {0};
    iso_status status = iso_dicom_file_read(path, &file, &kind, &detail);
    if (status != ISO_OK || kind != ISO_DICOM_NOT) iso_file_set_read(f->read, path);
    if (status == ISO_ERR_NOMEM)
        iso_fail(error, status, "%s", detail.text);
    else if (status != ISO_OK)
        status = add_damaged(f, &file, detail.text, error);
    else if (kind == ISO_DICOM_IMAGE)
        status = add_image(f, &file, error);
    else if (kind == ISO_DICOM_DIRECTORY)
        f->has_directory = true;
    else
        status = leave_out(f, path, kind, error);
    iso_dicom_file_free(&file);
    return status;
}

/* ---- all files of a folder ---- */

typedef struct walk {
    iso_dicom_folder *folder;
    bool subfolders; /* which entries of a folder are looked at: only files, or only subfolders */
    int level;       /* 0: the folder itself */
    dev_t device;    /* subfolders on other file systems, as /proc is one, are not looked at */
    size_t *entries; /* number of subfolders and of files in them so far */
} walk;

static iso_status walk_folder(const walk *w, const char *path, iso_error *error);

static iso_status walk_subfolder(const walk *w, const char *path, iso_error *error) {
    walk inside = *w;
    inside.level++;
    if (inside.level > MAX_LEVELS) return ISO_OK;
    inside.subfolders = false;
    ISO_TRY(walk_folder(&inside, path, error));
    inside.subfolders = true;
    return walk_folder(&inside, path, error);
}

/* Links to folders are not followed, because they could form a circle. */
static iso_status walk_entry(const walk *w, const char *path, iso_error *error) {
    struct stat about;
    if ((w->subfolders ? lstat(path, &about) : stat(path, &about)) != 0) return ISO_OK;
    const bool wanted =
        w->subfolders ? S_ISDIR(about.st_mode) && about.st_dev == w->device : S_ISREG(about.st_mode);
    if (!wanted) return ISO_OK;
    if ((w->subfolders || w->level > 0) && ++*w->entries > MAX_ENTRIES)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: more than %d files in its subfolders: name the folder of one series",
                        w->folder->path, MAX_ENTRIES);
    return w->subfolders ? walk_subfolder(w, path, error) : iso_dicom_folder_add(w->folder, path, error);
}

static int not_hidden(const struct dirent *entry) {
    return entry->d_name[0] != '.';
}

static int by_name(const struct dirent **a, const struct dirent **b) {
    return strcmp((*a)->d_name, (*b)->d_name);
}

/* A subfolder that cannot be listed is left out like a file that is none of ours. */
static iso_status walk_folder(const walk *w, const char *path, iso_error *error) {
    struct dirent **entries = NULL;
    const int count = scandir(path, &entries, not_hidden, by_name);
    if (count < 0 && errno == ENOMEM) return iso_fail_memory(error, path);
    if (count < 0 && w->level > 0) return ISO_OK;
    if (count < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    iso_status status = ISO_OK;
    for (int i = 0; i < count; i++) {
        char *name = NULL;
        if (status == ISO_OK && asprintf(&name, "%s/%s", path, entries[i]->d_name) < 0) {
            name = NULL;
            status = iso_fail_memory(error, path);
        }
        if (status == ISO_OK) status = walk_entry(w, name, error);
        free(name);
        free(entries[i]);
    }
    free(entries);
    return status;
}

iso_status iso_dicom_folder_read(const char *path, bool subfolders, iso_dicom_folder *folder,
                                 iso_error *error) {
    struct stat about;
    size_t entries = 0;
    folder->path = path;
    if (stat(path, &about) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    walk w = {.folder = folder, .device = about.st_dev, .entries = &entries};
    iso_status status = walk_folder(&w, path, error);
    if (status == ISO_OK && subfolders && (folder->count == 0 || folder->has_directory)) {
        const size_t own = folder->count;
        w.subfolders = true;
        status = walk_folder(&w, path, error);
        folder->descended = folder->count > own;
    }
    if (status != ISO_OK) iso_dicom_folder_free(folder);
    return status;
}

/* ---- texts ---- */

const char *iso_dicom_folder_name(const char *folder, const char *path) {
    const size_t length = strlen(folder);
    return strncmp(path, folder, length) == 0 && path[length] == '/' ? path + length + 1 : path;
}

bool iso_dicom_folder_left_out(const iso_dicom_folder *f, char text[ISO_VOLUME_TEXT]) {
    const struct {
        size_t count;
        const char *what;
    } kinds[] = {
        {f->damaged_count, "unreadable"}, {f->strays, "not DICOM"}, {f->imageless, "without an image"}};
    const size_t count = f->damaged_count + f->strays + f->imageless;
    char list[128] = "";
    if (!count) return false;
    for (size_t i = 0, used = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (kinds[i].count)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%zu %s", used ? ", " : "",
                                     kinds[i].count, kinds[i].what);
    const char *first = f->damaged_count ? f->damaged[0].reason : f->first_left_out;
    first = iso_dicom_folder_name(f->path, first);
    if (count == 1)
        snprintf(text, ISO_VOLUME_TEXT, "1 file is left out: %s", first);
    else
        snprintf(text, ISO_VOLUME_TEXT, "%zu files are left out (%s), the first: %s", count, list, first);
    return true;
}
