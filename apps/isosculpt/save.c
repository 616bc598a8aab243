/* Saving: names of files, and a background task that writes a snapshot of the field. */
#define _XOPEN_SOURCE 700 /* realpath */
#include "apps/isosculpt/save.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/isosculpt/mesh_file.h"
#include "base/file.h"
#include "grids/level_set.h"

/* ---- names */

/* Returns the extension of a file name with its dot; "" when there is none. */
static const char *extension_of(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return dot && dot > name ? dot : name + strlen(name);
}

static bool is_level_set(const char *path) {
    return strcasecmp(extension_of(path), ".vdb") == 0;
}

bool isosculpt_can_save_as(const char *path) {
    return is_level_set(path) || iso_source_is_mesh(path);
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

iso_status isosculpt_document_check_target(const isosculpt_document *document, const char *path,
                                           bool *replaces, iso_error *error) {
    struct stat about;
    *replaces = false;
    if (!isosculpt_can_save_as(path))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%.700s: the name must end in .vdb (level set), .stl, .ply or .obj (meshes)", path);
    if (stat(path, &about)) return ISO_OK;
    ISO_TRY(check_existing(document, path, &about, error));
    *replaces = !document->target_is_own || strcmp(path, document->target) != 0;
    return ISO_OK;
}

/* ---- writing */

struct isosculpt_saver {
    isosculpt_task *task;
    iso_snapshot *snapshot;    /* of the field */
    char path[ISOSCULPT_PATH]; /* of the file, symbolic links resolved */
    size_t change_count;       /* document->change_count when the save began */
    bool is_export;
    bool closed;                /* cap the mesh at the border of the grid */
    iso_mesh_measures measures; /* of the mesh; zero for a level set */
};

/* An unused path beside `path`, with the same extension, for the file that is being written. */
static iso_status name_temporary(const char *path, char temporary[ISOSCULPT_PATH], iso_error *error) {
    char ending[64];
    for (int number = 1; number < 100; number++) {
        snprintf(ending, sizeof ending, ".new-%d%.16s", number, extension_of(path));
        if (!isosculpt_path_with_ending(path, ending, temporary))
            return iso_fail(error, ISO_ERR_WRITE, "%.700s: the name is too long", path);
        if (access(temporary, F_OK)) return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_WRITE, "%.700s: too many unfinished files beside it", path);
}

/* Renames the complete new file to `path`; the old file becomes PATH.bak. */
static iso_status replace_file(const char *temporary, const char *path, iso_error *error) {
    char backup[ISOSCULPT_PATH];
    if (snprintf(backup, sizeof backup, "%s.bak", path) >= (int)sizeof backup)
        return iso_fail(error, ISO_ERR_WRITE, "%.700s: the name is too long", path);
    unlink(backup);
    if (link(path, backup) && errno != ENOENT && rename(path, backup)) /* this file system has no links */
        return iso_fail(error, ISO_ERR_WRITE, "%.700s: %s", backup, strerror(errno));
    if (rename(temporary, path)) return iso_fail(error, ISO_ERR_WRITE, "%.700s: %s", path, strerror(errno));
    return ISO_OK;
}

static iso_status write_snapshot(isosculpt_saver *saver, const char *temporary, const iso_progress *progress,
                                 iso_error *error) {
    const iso_progress taking = iso_progress_part(progress, 0, 0.2),
                       writing = iso_progress_part(progress, 0.2, 1);
    iso_hgrid *grid;
    ISO_TRY(iso_snapshot_copy(saver->snapshot, &taking, &grid, error));
    const isosculpt_mesh_opts mesh = {.closed = saver->closed, .progress = &writing};
    iso_status status = is_level_set(temporary)
                            ? iso_level_set_write_vdb(temporary, grid, "surface", &writing, error)
                            : isosculpt_mesh_write(temporary, grid, &mesh, &saver->measures, error);
    iso_hgrid_destroy(grid);
    return status;
}

/* isosculpt_task_fn */
static iso_status run_save(void *context, const iso_progress *progress, iso_error *error) {
    isosculpt_saver *saver = context;
    char temporary[ISOSCULPT_PATH];
    ISO_TRY(name_temporary(saver->path, temporary, error));
    iso_status status = write_snapshot(saver, temporary, progress, error);
    if (status == ISO_OK) status = replace_file(temporary, saver->path, error);
    if (status != ISO_OK) unlink(temporary);
    return status;
}

/* ---- the task */

static iso_status start_task(isosculpt_document *document, isosculpt_saver *saver, void (*wake)(void),
                             iso_error *error) {
    char *whole = realpath(document->saved_as, NULL);
    snprintf(saver->path, sizeof saver->path, "%s", whole ? whole : document->saved_as);
    free(whole);
    saver->change_count = document->change_count;
    ISO_TRY(iso_session_snapshot(document->session, &saver->snapshot, error));
    iso_status status = isosculpt_task_start(run_save, saver, wake, &saver->task, error);
    if (status != ISO_OK) iso_session_release_snapshot(document->session, saver->snapshot);
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
    iso_status status = start_task(document, saver, opts->wake, error);
    if (status != ISO_OK) {
        free(saver);
        return status;
    }
    document->saver = saver;
    if (opts->is_export) return ISO_OK;
    document->target_is_own &= strcmp(document->saved_as, document->target) == 0;
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
        document->target_is_own = true;
        isosculpt_document_remember_target(document);
    }
    if (status) *status = saved;
    document->saved_open_edges = saver->measures.open_edges;
    iso_session_release_snapshot(document->session, saver->snapshot);
    free(saver);
    document->saver = NULL;
    return ISOSCULPT_SAVE_DONE;
}
