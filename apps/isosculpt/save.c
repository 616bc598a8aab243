/* Saving: names of files, and a background task that writes a snapshot of the field. */
#include "apps/isosculpt/save.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/file_types.h"
#include "scene/painted.h"
#include "scene/solid.h"
#include "source/label.h"

/* ---- names */

/* Returns the extension of a file name with its dot; "" when there is none. */
static const char *extension_of(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return dot && dot > name ? dot : name + strlen(name);
}

static bool is_level_set(const char *path) {
    return iso_file_type_of_name(path, ISO_WRITES_VOLUME) != ISO_FILE_UNKNOWN;
}

bool isosculpt_can_save_as(const char *path) {
    return iso_file_type_of_name(path, ISO_WRITES_VOLUME | ISO_WRITES_MESH) != ISO_FILE_UNKNOWN;
}

/* Whether a path is one for the segmentation that a document began with. */
static bool is_segmentation(const isosculpt_document *document, const char *path) {
    return iso_source_label(&document->start) && !isosculpt_can_save_as(path) &&
           iso_file_type_of_name(path, ISO_HOLDS_VOLUME) != ISO_FILE_UNKNOWN;
}

bool isosculpt_path_with_ending(const char *path, const char *ending, char changed[ISOSCULPT_PATH]) {
    const int stem = (int)(extension_of(path) - path);
    return snprintf(changed, ISOSCULPT_PATH, "%.*s%s", stem, path, ending) < ISOSCULPT_PATH;
}

/* Chooses the first folder that can be written to: that of the source, the working directory, $HOME. */
static void choose_folder(const char *source, char folder[ISOSCULPT_PATH]) {
    const char *slash = source ? strrchr(source, '/') : NULL, *home = getenv("HOME");
    const int length = slash ? (int)(slash - source) : 0;
    if (slash && length < ISOSCULPT_PATH) {
        snprintf(folder, ISOSCULPT_PATH, "%.*s", length ? length : 1, source);
        if (access(folder, W_OK) == 0) return;
    }
    if (getcwd(folder, ISOSCULPT_PATH) && access(folder, W_OK) == 0) return;
    snprintf(folder, ISOSCULPT_PATH, "%s", home && home[0] == '/' ? home : "/tmp");
}

/* Returns the file name of the source without its extension (two extensions if it is compressed), or
 * "sculpture" without a source. */
static void choose_stem(const char *source, char stem[ISOSCULPT_PATH]) {
    const char *slash = source ? strrchr(source, '/') : NULL;
    snprintf(stem, ISOSCULPT_PATH, "%s", slash ? slash + 1 : source ? source : "sculpture");
    char *dot = source ? stem + (extension_of(stem) - stem) : stem + strlen(stem);
    const bool packed = strcasecmp(dot, ".gz") == 0;
    *dot = 0;
    if (packed) stem[extension_of(stem) - stem] = 0;
}

void isosculpt_path_unused(const char *path, const char *extension, char unused[ISOSCULPT_PATH]) {
    char ending[32];
    snprintf(ending, sizeof ending, "%.16s", extension);
    for (int number = 2; number < 10000; number++) {
        if (isosculpt_path_with_ending(path, ending, unused) && access(unused, F_OK)) return;
        snprintf(ending, sizeof ending, "-%d%.16s", number, extension);
    }
}

void isosculpt_target_default(const char *source, char target[ISOSCULPT_PATH]) {
    char folder[ISOSCULPT_PATH], stem[ISOSCULPT_PATH], first[ISOSCULPT_PATH];
    char *whole = source ? realpath(source, NULL) : NULL;
    choose_folder(whole ? whole : source, folder);
    choose_stem(whole ? whole : source, stem);
    snprintf(first, sizeof first, "%.500s%s%.400s.vdb", folder, strcmp(folder, "/") == 0 ? "" : "/", stem);
    isosculpt_path_unused(first, ".vdb", target);
    free(whole);
}

void isosculpt_target_beside(const char *path, char target[ISOSCULPT_PATH]) {
    char *whole = realpath(path, NULL);
    if (!isosculpt_path_with_ending(whole ? whole : path, ".vdb", target))
        isosculpt_target_default(NULL, target);
    free(whole);
}

/* ---- checking the target */

static iso_status check_existing(const isosculpt_document *document, const char *path,
                                 const struct stat *about, iso_error *error) {
    if (S_ISDIR(about->st_mode)) return iso_fail(error, ISO_ERR_WRITE, "%.700s: is a folder", path);
    if (!S_ISREG(about->st_mode)) return iso_fail(error, ISO_ERR_WRITE, "%.700s: is no regular file", path);
    if (access(path, W_OK)) return iso_fail(error, ISO_ERR_WRITE, "%.700s: cannot be written", path);
    if (document->target_is_own && strcmp(path, document->target) == 0) return ISO_OK;
    if (iso_file_same(path, document->start.source))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%.700s: this session began with that file and needs it: choose another name", path);
    return ISO_OK;
}

static iso_status fail_name(const char *path, iso_error *error) {
    char level_sets[32], meshes[64];
    iso_file_type_extensions(ISO_WRITES_VOLUME, 0, "or", level_sets, sizeof level_sets);
    iso_file_type_extensions(ISO_WRITES_MESH, 0, "or", meshes, sizeof meshes);
    return iso_fail(error, ISO_ERR_USAGE, "%.700s: the name must end in %s (level set), %s (meshes)", path,
                    level_sets, meshes);
}

iso_status isosculpt_document_check_target(const isosculpt_document *document, const char *path,
                                           bool *replaces, iso_error *error) {
    struct stat about;
    *replaces = false;
    if (is_segmentation(document, path))
        ISO_TRY(iso_source_label_check(document->journal, &document->start, path, error));
    else if (!isosculpt_can_save_as(path))
        return fail_name(path, error);
    if (stat(path, &about)) return ISO_OK;
    ISO_TRY(check_existing(document, path, &about, error));
    *replaces = !document->target_is_own || strcmp(path, document->target) != 0;
    return ISO_OK;
}

/* ---- one save */

struct isosculpt_saver {
    isosculpt_task *task;
    iso_snapshot *snapshot;    /* of the field */
    iso_field_items items;     /* of the field; a copy */
    iso_rgb color;             /* of the options */
    char path[ISOSCULPT_PATH]; /* of the file, symbolic links resolved */
    size_t change_count;       /* document->change_count when the save began */
    isosculpt_backup backup;   /* document->backup */
    bool is_export;
    bool closed;                /* cap the mesh at the border of the grid */
    bool nothing_left;          /* the field has no solid; level sets only, for meshes are refused then */
    iso_mesh_measures measures; /* of the mesh; zero for a level set */
    bool segmentation;          /* the session's label goes back into a copy of its file */
    iso_journal_start start;    /* the document's: the session goes on */
    char journal[ISOSCULPT_PATH];
};

/* ---- the file that is replaced, which is kept as PATH.bak */

static bool is_backup(const isosculpt_backup *backup, const char *path) {
    struct stat info;
    return strcmp(backup->path, path) == 0 && lstat(path, &info) == 0 && info.st_dev == backup->device &&
           info.st_ino == backup->inode;
}

/* Gives the file `path` a second name; where the file system has no links, the second name only. Returns 0 or
 * an errno: EEXIST if a file has that name, ENOENT if there is no file `path`. */
static int link_or_rename(const char *path, const char *name) {
    struct stat info;
    if (link(path, name) == 0) return 0;
    if (errno == EEXIST || errno == ENOENT) return errno;
    if (lstat(name, &info) == 0) return EEXIST;
    return rename(path, name) == 0 ? 0 : errno;
}

/* Keeps the file that will be replaced, under a name that no file has but the session's own last backup.
 * Sets *kept; *kept->path is 0 if there was nothing to keep, or if it is kept already. */
static iso_status keep_file(const char *path, const isosculpt_backup *last, isosculpt_backup *kept,
                            iso_error *error) {
    enum { NUMBERS = 1000 };
    char name[ISOSCULPT_PATH];
    struct stat info;
    int code = EEXIST;
    kept->path[0] = 0;
    for (int number = 1; code == EEXIST && number < NUMBERS; number++) {
        const int length = number == 1 ? snprintf(name, sizeof name, "%s.bak", path)
                                       : snprintf(name, sizeof name, "%s.bak-%d", path, number);
        if (length >= (int)sizeof name)
            return iso_fail(error, ISO_ERR_WRITE, "%.700s: the name is too long", path);
        if (iso_file_same(path, name)) return ISO_OK;
        if (is_backup(last, name)) unlink(name);
        code = link_or_rename(path, name);
    }
    if (code == ENOENT) return ISO_OK;
    if (code || lstat(name, &info)) /* (what has just been made is there) */
        return iso_fail(error, ISO_ERR_WRITE, "%.700s: %s", name, strerror(code ? code : errno));
    *kept = (isosculpt_backup){.device = info.st_dev, .inode = info.st_ino};
    memcpy(kept->path, name, sizeof name);
    return ISO_OK;
}

/* After a failure: the old file is there under its own name only. */
static void take_back(const isosculpt_backup *kept, const char *path) {
    if (!kept->path[0]) return;
    if (access(path, F_OK))
        rename(kept->path, path);
    else
        unlink(kept->path);
}

/* ---- writing */

/* Whether a voxel lies inside of the solid. */
static bool has_solid(const iso_hgrid *grid) {
    const size_t cells = iso_hgrid_cell_count(grid);
    for (size_t cell = 0; cell < cells; cell++) {
        const int32_t state = grid->cell[cell];
        if (state == ISO_CELL_INSIDE) return true;
        if (state < 0) continue;
        const float *values = iso_hgrid_brick(grid, state);
        for (int i = 0; i < ISO_BRICK_VOXELS; i++)
            if (values[i] < 0) return true;
    }
    return false;
}

/* Writes the label of a field into a copy of the segmentation. */
static iso_status write_label(const isosculpt_saver *saver, const iso_hgrid *now, FILE *stream,
                              const iso_progress *progress, iso_error *error) {
    const iso_progress making = iso_progress_part(progress, 0, 0.6),
                       writing = iso_progress_part(progress, 0.6, 1);
    iso_hgrid *first;
    iso_label_changes *changes = calloc(1, sizeof *changes);
    iso_pool *pool = NULL;
    iso_status status = changes ? iso_pool_create(0, &pool, error)
                                : iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    if (status == ISO_OK)
        status = isosculpt_document_first_field(&saver->start, saver->journal, pool, &making, &first, error);
    iso_pool_destroy(pool);
    if (status == ISO_OK) {
        status = iso_source_label_write(saver->journal, &saver->start, first, now, stream, &writing, changes,
                                        error);
        iso_hgrid_destroy(first);
    }
    free(changes);
    return status;
}

static iso_status write_snapshot(isosculpt_saver *saver, FILE *stream, const iso_progress *progress,
                                 iso_error *error) {
    const iso_progress taking = iso_progress_part(progress, 0, 0.2),
                       writing = iso_progress_part(progress, 0.2, 1);
    iso_hgrid *grid;
    ISO_TRY(iso_snapshot_copy(saver->snapshot, &taking, &grid, error));
    const iso_painted painted = iso_painted_make(&saver->items.of[ISO_ITEM_PAINT], grid, saver->color);
    const iso_coloring coloring = iso_painted_coloring(&painted);
    const iso_solid_mesh_opts mesh = {.closed = saver->closed,
                                      .coloring = iso_painted_any(&painted) ? &coloring : NULL,
                                      .measures = &saver->measures};
    saver->nothing_left = !has_solid(grid);
    iso_status status = saver->segmentation ? write_label(saver, grid, stream, &writing, error)
                        : is_level_set(saver->path)
                            ? iso_painted_put_vdb(stream, saver->path, grid, &painted, &writing, error)
                            : iso_solid_write(saver->path, grid, &mesh, "isosculpt", stream, &writing, error);
    iso_hgrid_destroy(grid);
    return status;
}

/* isosculpt_task_fn */
static iso_status run_save(void *context, const iso_progress *progress, iso_error *error) {
    isosculpt_saver *saver = context;
    isosculpt_backup kept = {.path = ""};
    iso_sink sink;
    ISO_TRY(iso_sink_open(saver->path, &sink, error));
    iso_status status = write_snapshot(saver, sink.stream, progress, error);
    /* (An error of the stream is reported by the commit.) */
    if (status == ISO_OK && fflush(sink.stream) == 0)
        status = keep_file(saver->path, &saver->backup, &kept, error);
    if (status != ISO_OK) {
        iso_sink_abort(&sink);
        return status;
    }
    status = iso_sink_commit(&sink, error);
    if (status != ISO_OK)
        take_back(&kept, saver->path);
    else if (kept.path[0])
        saver->backup = kept;
    return status;
}

/* ---- the task */

static iso_status start_task(isosculpt_document *document, isosculpt_saver *saver, void (*wake)(void),
                             iso_error *error) {
    char *whole = realpath(document->saved_as, NULL);
    snprintf(saver->path, sizeof saver->path, "%s", whole ? whole : document->saved_as);
    free(whole);
    saver->change_count = document->change_count;
    saver->backup = document->backup;
    saver->segmentation = is_segmentation(document, document->saved_as);
    saver->start = document->start;
    memcpy(saver->journal, document->journal, sizeof saver->journal);
    ISO_TRY(iso_field_items_copy(iso_session_items(document->session), &saver->items, error));
    iso_status status = iso_session_snapshot(document->session, &saver->snapshot, error);
    if (status == ISO_OK) {
        status = isosculpt_task_start(run_save, saver, wake, &saver->task, error);
        if (status != ISO_OK) iso_session_release_snapshot(document->session, saver->snapshot);
    }
    if (status != ISO_OK) iso_field_items_free(&saver->items);
    return status;
}

iso_status isosculpt_document_save(isosculpt_document *document, const isosculpt_save_opts *opts,
                                   iso_error *error) {
    bool replaces;
    const char *path = opts->path ? opts->path : document->target;
    if (document->saver) return iso_fail(error, ISO_ERR_USAGE, "the last save is still running");
    ISO_TRY(isosculpt_document_check_target(document, path, &replaces, error));
    isosculpt_saver *saver = calloc(1, sizeof *saver);
    if (!saver) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for saving");
    if (path != document->saved_as) snprintf(document->saved_as, sizeof document->saved_as, "%s", path);
    saver->is_export = opts->is_export;
    saver->closed = opts->closed;
    saver->color = opts->color;
    iso_status status = start_task(document, saver, opts->wake, error);
    if (status != ISO_OK) {
        free(saver);
        return status;
    }
    document->saver = saver;
    if (opts->is_export) return ISO_OK;
    document->target_is_own &= strcmp(document->saved_as, document->target) == 0;
    document->target_was_saved &= strcmp(document->saved_as, document->target) == 0;
    memcpy(document->target, document->saved_as, sizeof document->target);
    return ISO_OK;
}

isosculpt_task *isosculpt_document_save_task(const isosculpt_document *document) {
    return document->saver ? document->saver->task : NULL;
}

isosculpt_save_state isosculpt_document_poll_save(isosculpt_document *document, bool wait, iso_status *status,
                                                  iso_error *error) {
    isosculpt_saver *saver = document->saver;
    if (!saver) return ISOSCULPT_SAVE_IDLE;
    if (!wait && !isosculpt_task_done(saver->task)) return ISOSCULPT_SAVE_RUNNING;
    const iso_status saved = isosculpt_task_finish(saver->task, error);
    if (saved == ISO_OK && !saver->is_export) {
        document->saved_change_count = saver->change_count;
        document->target_is_own = document->target_was_saved = true;
        isosculpt_document_remember(document);
    }
    if (status) *status = saved;
    document->backup = saver->backup;
    document->saved_open_edges = saver->measures.open_edges;
    document->saved_nothing = saver->nothing_left;
    iso_session_release_snapshot(document->session, saver->snapshot);
    iso_field_items_free(&saver->items);
    free(saver);
    document->saver = NULL;
    return ISOSCULPT_SAVE_DONE;
}

void isosculpt_mesh_open_note(size_t open_edges, char *text, size_t size) {
    snprintf(text, size, "%zu open edges where the border of the grid cuts the solid: --closed caps it there",
             open_edges);
}
