/* format_dicom: reads a folder of DICOM files, or the series of one file, as a volume.
 *
 * The headers of all files in the folder are read (folder.c); pixels only of the chosen series, one file at a
 * time. */
#include "grids/volume/format.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/dicom/pixels.h"

/* ---- series ---- */

typedef struct series {
    const iso_dicom_file *first;
    const size_t *files; /* indices of its files */
    size_t file_count, images;
} series;

typedef struct series_list {
    series *list;
    size_t count;
    size_t *files; /* indices of all files, by series */
} series_list;

static void free_list(series_list *all) {
    free(all->list);
    free(all->files);
}

static bool is_grey(const iso_dicom_file *file) {
    return file->samples == 1 && (!*file->photometric || strncmp(file->photometric, "MONOCHROME", 10) == 0);
}

/* Sorts by series number, like a scanner's console. */
static int compare_series(const void *left, const void *right) {
    const iso_dicom_file *a = ((const series *)left)->first, *b = ((const series *)right)->first;
    if (a->series_number != b->series_number) return a->series_number < b->series_number ? -1 : 1;
    return strcmp(a->series, b->series);
}

static int compare_files(const void *left, const void *right, void *context) {
    const iso_dicom_file *files = context;
    const size_t a = *(const size_t *)left, b = *(const size_t *)right;
    const int order = strcmp(files[a].series, files[b].series);
    return order ? order : (a > b) - (a < b);
}

/* Release the list with free_list, also when it fails. */
static iso_status list_series(const iso_dicom_folder *f, series_list *all, iso_error *error) {
    const size_t room = f->count ? f->count : 1;
    *all = (series_list){.list = calloc(room, sizeof *all->list), .files = malloc(room * sizeof *all->files)};
    if (!all->list || !all->files) return iso_fail_memory(error, f->path);
    for (size_t i = 0; i < f->count; i++) all->files[i] = i;
    qsort_r(all->files, f->count, sizeof *all->files, compare_files, f->files);
    for (size_t i = 0; i < f->count; i++) {
        const iso_dicom_file *file = &f->files[all->files[i]];
        if (!all->count || strcmp(all->list[all->count - 1].first->series, file->series) != 0)
            all->list[all->count++] = (series){.first = file, .files = all->files + i};
        series *one = &all->list[all->count - 1];
        one->file_count++;
        one->images += (size_t)file->frame_count;
    }
    qsort(all->list, all->count, sizeof *all->list, compare_series);
    return ISO_OK;
}

static bool is_segmentation(const iso_dicom_file *file) {
    return *file->segmentation;
}

/* Volumes of values come before segmentations, and these before colours. */
static int rank_of(const iso_dicom_file *file) {
    return is_segmentation(file) ? 1 : is_grey(file) ? 2 : 0;
}

static const series *largest(const series_list *all) {
    const series *best = &all->list[0];
    for (size_t i = 1; i < all->count; i++) {
        const series *one = &all->list[i];
        const int rank = rank_of(one->first), best_rank = rank_of(best->first);
        if (rank != best_rank ? rank > best_rank : one->images > best->images) best = one;
    }
    return best;
}

/* Parses a number from 1 on; 0: it is none. */
static size_t parse_number(const char *text) {
    char *end;
    const long number = strtol(text, &end, 10);
    return end == text || *end || number < 1 ? 0 : (size_t)number;
}

static const series *find_series(const series_list *all, const char *text) {
    for (size_t i = 0; i < all->count; i++)
        if (strcmp(all->list[i].first->series, text) == 0) return &all->list[i];
    const size_t number = parse_number(text);
    return number >= 1 && number <= all->count ? &all->list[number - 1] : NULL;
}

/* Divides SERIES:ACQUISITION, of which the second part may be missing: 0. */
static iso_status divide_choice(const char *text, char name[80], size_t *acquisition, iso_error *error) {
    const char *colon = strchr(text, ':');
    const size_t length = colon ? (size_t)(colon - text) : strlen(text);
    *acquisition = colon ? parse_number(colon + 1) : 0;
    if (length >= 80 || (colon && !*acquisition))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a series, or SERIES:NUMBER (--series)", text);
    snprintf(name, 80, "%.*s", (int)length, text);
    return ISO_OK;
}

static iso_status choose_series(const iso_dicom_folder *f, const iso_volume_opts *opts, const char *own,
                                const series_list *all, const series **chosen, size_t *acquisition,
                                iso_error *error) {
    char wanted[80];
    const char *name = opts->series ? wanted : own;
    *acquisition = 0;
    if (all->count == 0) {
        const size_t others = f->strays + f->imageless + f->damaged_count;
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no DICOM images (%zu other file%s)%s%s", f->path,
                        others, others == 1 ? "" : "s", f->damaged_count ? ": " : "",
                        f->damaged_count ? iso_dicom_folder_name(f->path, f->damaged[0].reason)
                                         : ": a folder is read as slices in DICOM, TIFF or PNG, or as Zarr");
    }
    if (opts->series) ISO_TRY(divide_choice(opts->series, wanted, acquisition, error));
    *chosen = name ? find_series(all, name) : largest(all);
    if (!*chosen)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: no series \"%s\", there %s %zu (by number from 1, or UID; --info lists them)",
                        f->path, name, all->count == 1 ? "is" : "are", all->count);
    const iso_dicom_file *file = (*chosen)->first;
    if (is_segmentation(file) && (*chosen)->file_count > 1)
        return iso_fail(error, ISO_ERR_USAGE, "%s: the series has %zu segmentations: name one of the files",
                        f->path, (*chosen)->file_count);
    if (!rank_of(file))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds colour images (%s), not a volume of values",
                        file->path, file->photometric);
    return ISO_OK;
}

/* ---- one volume of a series ---- */

typedef struct planes {
    iso_dicom_frame *frames; /* sorted by their position along the normal */
    size_t count;
    iso_scalar scalar;
    bool physical;                /* each slice has a rescale of its own: values are rescaled to floats */
    iso_dicom_file *segmentation; /* is read instead of frames; NULL: there is none */
} planes;

static bool near(const double *a, const double *b, int count, double tolerance) {
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance)) return false;
    return true;
}

/* Whether two frames can be slices of one volume. Not all frames of a series can: a scout of another size or
 * direction often has the UID of its series. */
static bool fits_together(const iso_dicom_folder *f, const iso_dicom_frame *a, const iso_dicom_frame *b) {
    const iso_dicom_file *m = &f->files[a->file], *n = &f->files[b->file];
    return m->rows == n->rows && m->columns == n->columns && m->samples == n->samples &&
           m->bits_allocated == n->bits_allocated && m->is_signed == n->is_signed &&
           near(a->orientation, b->orientation, 6, 1e-3) && near(a->pixel, b->pixel, 2, 1e-4 * a->pixel[0]);
}

/* Keeps the largest set of frames that can be slices of one volume, or the set with a frame of file `named`
 * if it is one of them. */
static iso_status keep_largest_fit(const iso_dicom_folder *f, size_t named, planes *p, iso_volume_info *info,
                                   iso_error *error) {
    size_t *representative = malloc(p->count * sizeof *representative);
    size_t *sizes = calloc(p->count, sizeof *sizes), best = 0, kept = 0, groups = 0;
    if (!representative || !sizes) {
        free(representative);
        free(sizes);
        return iso_fail_memory(error, f->path);
    }
    for (size_t i = 0; i < p->count; i++) {
        size_t g = 0;
        while (g < groups && !fits_together(f, &p->frames[representative[g]], &p->frames[i])) g++;
        if (g == groups) representative[groups++] = i;
        if (++sizes[g] > sizes[best]) best = g;
    }
    size_t chosen = 0;
    while (chosen < p->count && p->frames[chosen].file != named) chosen++;
    const iso_dicom_frame model = p->frames[chosen < p->count ? chosen : representative[best]];
    for (size_t i = 0; i < p->count; i++)
        if (fits_together(f, &model, &p->frames[i])) p->frames[kept++] = p->frames[i];
    if (kept < p->count)
        iso_volume_note(info, "%zu image%s of another size, direction or type %s left out", p->count - kept,
                        p->count - kept == 1 ? "" : "s", p->count - kept == 1 ? "is" : "are");
    p->count = kept;
    free(representative);
    free(sizes);
    return ISO_OK;
}

/* Collects the frames of a series; free p->frames. Files with several frames are volumes by themselves, of
 * which the file `named`, unless it is SIZE_MAX, is no slice. */
static iso_status collect_frames(const iso_dicom_folder *f, const series *one, size_t named, planes *p,
                                 iso_error *error) {
    *p = (planes){.frames = malloc(one->images * sizeof *p->frames)};
    if (!p->frames) return iso_fail_memory(error, f->path);
    for (size_t i = 0; i < one->file_count; i++) {
        const iso_dicom_file *file = &f->files[one->files[i]];
        if (named != SIZE_MAX && file->frame_count > 1) continue;
        for (int k = 0; k < file->frame_count; k++) {
            p->frames[p->count] = file->frames[k];
            p->frames[p->count++].file = one->files[i];
        }
    }
    return ISO_OK;
}

static iso_scalar scalar_of(const iso_dicom_file *file) {
    switch (file->bits_allocated) {
    case 8:
        return file->is_signed ? ISO_SCALAR_INT8 : ISO_SCALAR_UINT8;
    case 16:
        return file->is_signed ? ISO_SCALAR_INT16 : ISO_SCALAR_UINT16;
    default:
        return file->is_signed ? ISO_SCALAR_INT32 : ISO_SCALAR_UINT32;
    }
}

static void choose_rescale(planes *p, iso_volume_info *info) {
    const iso_dicom_frame *first = &p->frames[0];
    bool equal = true;
    for (size_t i = 1; i < p->count; i++)
        equal &= p->frames[i].slope == first->slope && p->frames[i].intercept == first->intercept;
    p->physical = !equal || !(first->slope > 0);
    if (!equal)
        iso_volume_note(info, "slices have rescales of their own: values are stored rescaled, as floats");
    else if (first->slope < 0)
        iso_volume_note(info, "the rescale slope is negative: values are stored rescaled, as floats");
    else if (first->slope == 0)
        iso_volume_note(info, "the rescale slope is 0: all values are %g", first->intercept);
    info->type = p->physical ? ISO_FLOAT32 : iso_scalar_stored_type(p->scalar);
    info->scale = p->physical ? 1 : first->slope;
    info->offset = p->physical ? 0 : first->intercept;
}

static void fill_header(const iso_dicom_folder *f, planes *p, iso_volume_info *info) {
    const iso_dicom_file *file = &f->files[p->frames[0].file];
    info->dims[0] = file->columns;
    info->dims[1] = file->rows;
    p->scalar = scalar_of(file);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(p->scalar));
    snprintf(info->name, sizeof info->name, "%s", *file->description ? file->description : file->series);
    choose_rescale(p, info);
    if (strcmp(file->photometric, "MONOCHROME1") == 0)
        iso_volume_note(info,
                        "low values are bright in this file (MONOCHROME1): values are left as they are");
    if (file->has_lookup_table)
        iso_volume_note(info, "its modality lookup table is not applied: values are stored ones");
}

static void fill_sizes(const iso_dicom_folder *f, const planes *p, iso_volume_info *info) {
    uint64_t most = 0;
    for (size_t i = 0; i < p->count; i++) {
        const iso_dicom_file *file = &f->files[p->frames[i].file];
        uint64_t needs = iso_dicom_frame_bytes(file) + (file->encapsulated ? 2 * file->pixel_bytes : 0);
        if (needs > most) most = needs;
    }
    info->bytes = iso_format_size(info->dims, iso_type_size(info->type));
    if (__builtin_add_overflow(info->bytes, most, &info->read_bytes)) info->read_bytes = UINT64_MAX;
}

/* ---- from a path to sorted slices ---- */

typedef struct source {
    iso_dicom_folder folder;
    char *folder_path; /* owned when the path names a file */
    char *own_series;  /* of the named file; NULL: a folder is named */
    size_t named;      /* index of the named file; SIZE_MAX: all files that were read are meant */
    planes planes;
} source;

static void free_source(source *s) {
    iso_dicom_folder_free(&s->folder);
    free(s->folder_path);
    free(s->own_series);
    free(s->planes.frames);
    *s = (source){0};
}

static char *folder_of(const char *path) {
    const char *slash = strrchr(path, '/');
    if (!slash) return strdup(".");
    return slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
}

/* The path by which the listing of the folder names a file. */
static char *listed_name(const char *folder_path, const char *path) {
    const char *slash = strrchr(path, '/');
    char *name = NULL;
    return asprintf(&name, "%s/%s", folder_path, slash ? slash + 1 : path) < 0 ? NULL : name;
}

/* Finds the named file among those of its folder. Hidden files are not listed, and the file may be damaged
 * by now. */
static iso_status find_named(iso_dicom_folder *f, const char *listed, size_t *named, iso_error *error) {
    size_t i = 0;
    while (i < f->count && strcmp(f->files[i].path, listed) != 0) i++;
    if (i == f->count) ISO_TRY(iso_dicom_folder_add(f, listed, error));
    if (i == f->count) return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", listed);
    *named = i;
    return ISO_OK;
}

/* Reads the files beside the named one, which can be slices of the same volume. A file with several frames is
 * a volume by itself, as is one that states no series. */
static iso_status read_neighbours(const char *path, bool single, source *s, iso_error *error) {
    char *listed = listed_name(s->folder_path, path);
    if (!listed) return iso_fail_memory(error, path);
    iso_status status = ISO_OK;
    s->folder.path = s->folder_path;
    if (single)
        status = iso_dicom_folder_add(&s->folder, listed, error);
    else
        status = iso_dicom_folder_read(s->folder_path, false, &s->folder, error);
    if (status == ISO_OK && !single) status = find_named(&s->folder, listed, &s->named, error);
    free(listed);
    return status;
}

static iso_status read_named_file(const char *path, source *s, iso_error *error) {
    iso_dicom_file file;
    iso_dicom_kind kind;
    iso_status status = iso_dicom_file_read(path, &file, &kind, error);
    s->folder_path = folder_of(path);
    if (status == ISO_OK && kind == ISO_DICOM_NOT)
        status = iso_fail(error, ISO_ERR_FORMAT, "%s: not a DICOM file", path);
    if (status == ISO_OK && kind == ISO_DICOM_NO_IMAGE)
        status = iso_fail(error, ISO_ERR_FORMAT, "%s: a DICOM file that holds no image", path);
    if (status == ISO_OK && kind == ISO_DICOM_IMAGE) s->own_series = strdup(file.series);
    if (status == ISO_OK && (!s->folder_path || (kind == ISO_DICOM_IMAGE && !s->own_series)))
        status = iso_fail_memory(error, path);
    const bool single = file.frame_count > 1 || !*file.series || is_segmentation(&file);
    iso_dicom_file_free(&file);
    ISO_TRY(status);
    return kind == ISO_DICOM_IMAGE ? read_neighbours(path, single, s, error)
                                   : iso_dicom_folder_read(s->folder_path, true, &s->folder, error);
}

static iso_status read_files(source *s, const char *path, iso_error *error) {
    struct stat status;
    if (stat(path, &status) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    return S_ISDIR(status.st_mode) ? iso_dicom_folder_read(path, true, &s->folder, error)
                                   : read_named_file(path, s, error);
}

/* The folder of a file relative to `folder`; empty if that is it. */
static void folder_within(const char *folder, const char *path, char text[ISO_VOLUME_TEXT]) {
    const char *name = iso_dicom_folder_name(folder, path), *slash = strrchr(name, '/');
    snprintf(text, ISO_VOLUME_TEXT, "%.*s", slash ? (int)(slash - name) : 0, name);
}

/* Describes the acquisitions of a series, if there are several at the same places. *slices: how many planes
 * the largest has. */
static iso_status list_acquisitions(const iso_dicom_folder *f, const series *one, size_t number,
                                    char text[112], size_t *slices, iso_error *error) {
    const iso_dicom_wanted wanted = {f->path, f->path, f->files, SIZE_MAX, number, 0};
    iso_volume_info ignored = {0};
    planes p;
    size_t count = 1, largest_slices = 0;
    ISO_TRY(collect_frames(f, one, SIZE_MAX, &p, error));
    const iso_status status = keep_largest_fit(f, SIZE_MAX, &p, &ignored, error);
    if (status == ISO_OK) count = iso_dicom_count_acquisitions(&wanted, p.frames, p.count, &largest_slices);
    free(p.frames);
    *text = 0;
    *slices = count > 1 ? largest_slices : one->images;
    if (count > 1) snprintf(text, 112, ", %zu acquisitions: %zu:1 .. %zu:%zu", count, number, number, count);
    return status;
}

static iso_status list_items(const iso_dicom_folder *f, const series_list *all, iso_volume_info *info,
                             iso_error *error) {
    for (size_t i = 0; i < all->count && info->item_count < ISO_VOLUME_ITEMS; i++) {
        const series *one = &all->list[i];
        const iso_dicom_file *file = one->first;
        char acquisitions[112], within[ISO_VOLUME_TEXT], line[3 * ISO_VOLUME_TEXT];
        size_t slices;
        slices = one->images;
        *acquisitions = 0;
        if (!is_segmentation(file)) ISO_TRY(list_acquisitions(f, one, i + 1, acquisitions, &slices, error));
        folder_within(f->path, file->path, within);
        snprintf(line, sizeof line, "%zu  %s  %dx%dx%zu  %s  (%zu image%s%s)  %s%s%s", i + 1, file->modality,
                 file->columns, file->rows, slices, *file->description ? file->description : "-", one->images,
                 one->images == 1 ? "" : "s", acquisitions, file->series, *within ? "  " : "", within);
        snprintf(info->items[info->item_count++], ISO_VOLUME_TEXT, "%.*s", ISO_VOLUME_TEXT - 1, line);
    }
    if (all->count > ISO_VOLUME_ITEMS)
        snprintf(info->items[ISO_VOLUME_ITEMS - 1], ISO_VOLUME_TEXT, "and %zu more, up to --series %zu",
                 all->count - ISO_VOLUME_ITEMS + 1, all->count);
    return ISO_OK;
}

static void note_choice(const iso_dicom_folder *f, const series_list *all, const series *chosen,
                        bool by_default, iso_volume_info *info) {
    char text[ISO_VOLUME_TEXT];
    if (f->descended) {
        folder_within(f->path, chosen->first->path, text);
        iso_volume_note(info, "the images are in subfolders: %s", text);
    }
    const bool named = *chosen->first->description;
    bool most = true;
    for (size_t i = 0; i < all->count; i++) most &= all->list[i].images <= chosen->images;
    if (by_default && all->count > 1)
        iso_volume_note(info, "several series: using %td of %zu%s%s%s, which has most images%s (--series)",
                        chosen - all->list + 1, all->count, named ? ", \"" : "", chosen->first->description,
                        named ? "\"" : "", most ? "" : " of values");
    if (iso_dicom_folder_left_out(f, text)) iso_volume_note(info, "%s", text);
}

/* Finds a damaged file that can be a slice of the series, at a place where no other image is. Without it the
 * volume would lack a slice, which nobody could see at its ends. */
static const iso_dicom_damaged *find_lost_slice(const iso_dicom_folder *f, const series *one,
                                                const planes *p) {
    for (size_t i = 0; i < f->damaged_count; i++) {
        const iso_dicom_file *file = &f->damaged[i].file;
        bool is_there = strcmp(file->series, one->first->series) != 0 || !*file->series;
        for (size_t k = 0; k < p->count && file->has_position && !is_there; k++)
            is_there = p->frames[k].has_position && near(p->frames[k].position, file->position, 3, 1e-3);
        if (!is_there) return &f->damaged[i];
    }
    return NULL;
}

/* A message about missing slices also names a damaged file, which may be one of them, and the series if it
 * was not the user who chose it: `choices` is how many there are, 0 if the user did. */
static iso_status stack_planes(const iso_dicom_wanted *wanted, const iso_dicom_folder *f, size_t choices,
                               planes *p, iso_volume_info *info, iso_error *error) {
    iso_error detail = {0};
    const iso_status status = iso_dicom_stack(wanted, p->frames, &p->count, info, &detail);
    if (status == ISO_OK) return ISO_OK;
    if (status == ISO_ERR_FORMAT && f->damaged_count)
        iso_fail(&detail, status, "%s (left out: %s)", detail.text,
                 iso_dicom_folder_name(f->path, f->damaged[0].reason));
    if (status == ISO_ERR_FORMAT && choices > 1)
        return iso_fail(error, status, "%s (series %zu of %zu, --series chooses another)", detail.text,
                        wanted->series, choices);
    return iso_fail(error, status, "%s", detail.text);
}

static iso_status order_series(const char *path, const iso_volume_opts *opts, source *s,
                               const series_list *all, iso_volume_info *info, iso_error *error) {
    const iso_dicom_folder *f = &s->folder;
    planes *p = &s->planes;
    const series *chosen = NULL;
    size_t acquisition;
    ISO_TRY(choose_series(f, opts, s->own_series, all, &chosen, &acquisition, error));
    ISO_TRY(list_items(f, all, info, error));
    const bool by_default = !opts->series && !s->own_series;
    note_choice(f, all, chosen, by_default, info);
    const iso_dicom_wanted wanted = {
        path, f->path, f->files, s->named, (size_t)(chosen - all->list) + 1, acquisition};
    if (is_segmentation(chosen->first)) {
        p->segmentation = &s->folder.files[chosen->files[0]];
        return iso_dicom_segmentation_order(path, p->segmentation, info, error);
    }
    ISO_TRY(collect_frames(f, chosen, s->named, p, error));
    ISO_TRY(keep_largest_fit(f, s->named, p, info, error));
    const iso_dicom_damaged *lost = find_lost_slice(f, chosen, p);
    if (lost)
        return iso_fail(error, ISO_ERR_IO, "%s: a slice of the series cannot be read: %s", path,
                        iso_dicom_folder_name(f->path, lost->reason));
    return stack_planes(&wanted, f, by_default ? all->count : 0, p, info, error);
}

static iso_status order(const char *path, const iso_volume_opts *opts, source *s, iso_volume_info *info,
                        iso_error *error) {
    series_list all;
    iso_status status = list_series(&s->folder, &all, error);
    if (status == ISO_OK) status = order_series(path, opts, s, &all, info, error);
    free_list(&all);
    ISO_TRY(status);
    const bool segmentation = s->planes.segmentation;
    if (!segmentation) fill_header(&s->folder, &s->planes, info);
    ISO_TRY(iso_format_component(path, opts, 1, info, error));
    if (!segmentation) fill_sizes(&s->folder, &s->planes, info);
    return ISO_OK;
}

static iso_status open_source(const char *path, const iso_volume_opts *opts, source *s, iso_volume_info *info,
                              iso_error *error) {
    *s = (source){.folder.read = opts->files, .named = SIZE_MAX};
    iso_status status = read_files(s, path, error);
    if (status == ISO_OK) status = order(path, opts, s, info, error);
    if (status != ISO_OK) free_source(s);
    return status;
}

static iso_status dicom_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_error *error) {
    source s;
    ISO_TRY(open_source(path, opts, &s, info, error));
    free_source(&s);
    return ISO_OK;
}

/* ---- values ---- */

static void store(iso_type type, void *target, size_t i, double value) {
    switch (type) {
    case ISO_UINT8:
        ((uint8_t *)target)[i] = (uint8_t)value;
        break;
    case ISO_INT16:
        ((int16_t *)target)[i] = (int16_t)value;
        break;
    case ISO_UINT16:
        ((uint16_t *)target)[i] = (uint16_t)value;
        break;
    default:
        ((float *)target)[i] = (float)value;
    }
}

static void convert_plane(const planes *p, const iso_dicom_file *file, const iso_dicom_frame *frame,
                          const void *pixels, iso_type type, void *target) {
    size_t count = (size_t)file->rows * (size_t)file->columns;
    if (file->bits_stored == file->bits_allocated && !p->physical) {
        const iso_scalar_source raw = {pixels, p->scalar, 1, 0, iso_dicom_is_swapped(file)};
        iso_scalar_convert(&raw, count, type, target);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        double value = iso_dicom_value(file, pixels, i);
        store(type, target, i, p->physical ? value * frame->slope + frame->intercept : value);
    }
}

/* ---- reading ---- */

typedef struct reading {
    const char *path;
    const iso_volume_opts *opts;
    const source *source;
    iso_dicom_pixels open;
    void *pixels;  /* of one frame */
    size_t warned; /* slices that a codec complained of; the first of them, and what it said */
    const iso_dicom_file *first_warned;
    char warning[ISO_DICOM_WARNING];
} reading;

static iso_status read_frame(reading *r, const iso_dicom_frame *frame, iso_error *error) {
    char warning[ISO_DICOM_WARNING];
    ISO_TRY(iso_dicom_pixels_read(&r->open, frame->index, r->pixels, warning, error));
    if (*warning && r->warned++ == 0) {
        r->first_warned = r->open.file;
        memcpy(r->warning, warning, sizeof warning);
    }
    return ISO_OK;
}

static iso_status read_plane(reading *r, size_t z, iso_rgrid *grid, iso_error *error) {
    const planes *p = &r->source->planes;
    const iso_dicom_frame *frame = &p->frames[z];
    const iso_dicom_file *file = &r->source->folder.files[frame->file];
    if (r->open.file != file) ISO_TRY(iso_dicom_pixels_open(file, &r->open, error));
    ISO_TRY(read_frame(r, frame, error));
    char *target = (char *)grid->data + z * (size_t)grid->stride_z * iso_type_size(grid->type);
    convert_plane(p, file, frame, r->pixels, grid->type, target);
    return iso_format_progress(r->path, r->opts, (double)(z + 1) / (double)p->count, error);
}

static iso_status read_planes(const char *path, const iso_volume_opts *opts, const source *s,
                              iso_volume_info *info, iso_rgrid *grid, iso_error *error) {
    reading r = {.path = path, .opts = opts, .source = s};
    r.pixels = iso_alloc((size_t)iso_dicom_frame_bytes(&s->folder.files[s->planes.frames[0].file]));
    if (!r.pixels) return iso_fail_memory(error, path);
    iso_status status = ISO_OK;
    for (size_t z = 0; z < s->planes.count && status == ISO_OK; z++) status = read_plane(&r, z, grid, error);
    if (r.warned)
        iso_volume_note(info, "the pixels of %zu slice%s may be damaged, the first: %s: %s", r.warned,
                        r.warned == 1 ? "" : "s", iso_dicom_folder_name(s->folder.path, r.first_warned->path),
                        r.warning);
    iso_dicom_pixels_close(&r.open);
    iso_free(r.pixels);
    return status;
}

/* Reads the headers again, as `info` does not keep them; notes are those of the first time. */
static iso_status dicom_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_grid *grid, iso_error *error) {
    source s;
    iso_volume_info again = {.components = 1, .scale = 1};
    iso_grid result = {0};
    ISO_TRY(open_source(path, opts, &s, &again, error));
    iso_status status = ISO_OK;
    if (memcmp(again.dims, info->dims, sizeof again.dims) != 0 || again.type != info->type)
        status = iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    if (status == ISO_OK) status = iso_format_create(path, info, NULL, &result, error);
    const iso_dicom_file *segmentation = s.planes.segmentation;
    if (status == ISO_OK)
        status = segmentation
                     ? iso_dicom_segmentation_read(path, opts, segmentation, info, result.rgrid, error)
                     : read_planes(path, opts, &s, info, result.rgrid, error);
    free_source(&s);
    if (status == ISO_OK)
        *grid = result;
    else
        iso_grid_destroy(&result);
    return status;
}

const iso_format iso_format_dicom = {"dicom", "GDCM", NULL, dicom_info, dicom_read, NULL};
