/* Load jobs: opening in a background thread, up to a viewport with its surface extracted. */
#include "apps/isosculpt/load_job.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file_types.h"
#include "source/label.h"

struct isosculpt_load_job {
    isosculpt_task *task;
    isosculpt_load_request request;
    char path[ISOSCULPT_PATH], folder[ISOSCULPT_PATH]; /* copies of the request's */
    isosculpt_loaded loaded;
};

void isosculpt_loaded_free(isosculpt_loaded *loaded) {
    iso_stamp_free(loaded->stamp);
    isosculpt_viewport_free(&loaded->viewport);
    iso_source_volume_free(loaded->volume);
    if (loaded->document.session) isosculpt_document_discard(&loaded->document);
    iso_pool_destroy(loaded->pool);
    *loaded = (isosculpt_loaded){0};
}

bool isosculpt_is_strokes(const char *path) {
    return iso_file_type_of_name(path, ISO_HOLDS_STROKES) != ISO_FILE_UNKNOWN;
}

/* Freezes what is asked for in the new session, of the volume (NULL: it is read again). */
static iso_status freeze(isosculpt_load_job *load_job, const iso_source_volume *volume, iso_error *error) {
    const isosculpt_load_request *request = &load_job->request;
    isosculpt_document *document = &load_job->loaded.document;
    iso_pool *pool = load_job->loaded.pool;
    const iso_status status =
        volume ? iso_source_freeze(document->session, &volume->volume.grid, request->freezing.isovalue, pool,
                                   error)
               : isosculpt_freeze(document->session, load_job->path, &request->input,
                                  iso_source_label(&document->start), &request->freezing, pool, error);
    document->change_count += status == ISO_OK;
    return status;
}

static iso_status open_document(isosculpt_load_job *load_job, const iso_source_volume *volume,
                                const iso_progress *progress, iso_error *error) {
    const isosculpt_load_request *request = &load_job->request;
    isosculpt_loaded *loaded = &load_job->loaded;
    const bool begins = request->solid.size.x > 0;
    const iso_source source = {.path = begins ? NULL : load_job->path,
                               .solid = &request->solid,
                               .isovalue = request->isovalue,
                               .voxel = request->voxel,
                               .pool = loaded->pool,
                               .progress = progress,
                               .volume = volume,
                               .close_holes = request->close_holes,
                               .report = &loaded->report,
                               .input = &request->input};
    loaded->document.pool = loaded->pool;
    loaded->document.undo_memory = request->undo_memory;
    loaded->resampled = request->resample;
    if (request->resample)
        ISO_TRY(isosculpt_document_resample(&loaded->document, load_job->path, request->folder,
                                            request->voxel, progress, error));
    else
        ISO_TRY(!begins && isosculpt_is_strokes(load_job->path)
                    ? isosculpt_document_open(&loaded->document, load_job->path, progress, error)
                    : isosculpt_document_new(&loaded->document, request->folder, &source, error));
    if (request->freezing.on) ISO_TRY(freeze(load_job, volume, error));
    return isosculpt_viewport_init(&loaded->viewport, iso_session_grid(loaded->document.session),
                                   loaded->pool, error);
}

/* Opens a volume: one that has isovalues to choose from is viewed first, a level set becomes a document at
 * once. */
static iso_status open_volume(isosculpt_load_job *load_job, const iso_progress *progress, iso_error *error) {
    isosculpt_loaded *loaded = &load_job->loaded;
    const iso_progress reading = iso_progress_part(progress, 0, 0.4),
                       rest = iso_progress_part(progress, 0.4, 1);
    const double given = load_job->request.isovalue;
    iso_source_volume *volume;
    ISO_TRY(iso_source_volume_read(load_job->path, &load_job->request.input, loaded->pool, &reading, &volume,
                                   error));
    iso_status status;
    if (volume->has_isovalues)
        status = isosculpt_viewport_init_grid(&loaded->viewport, &volume->volume.grid,
                                              isnan(given) ? volume->suggested : given, loaded->pool, error);
    else
        status = open_document(load_job, volume, &rest, error);
    if (status == ISO_OK && volume->has_isovalues)
        loaded->volume = volume;
    else
        iso_source_volume_free(volume);
    return status;
}

static iso_status open_path(isosculpt_load_job *load_job, const iso_progress *progress, iso_error *error) {
    const isosculpt_load_request *request = &load_job->request;
    const bool converts = request->solid.size.x > 0 || request->input.label ||
                          (!request->input.has_raw && iso_source_kind(load_job->path) != ISO_HOLDS_VOLUME);
    if (request->volume || isosculpt_is_strokes(load_job->path) || converts)
        return open_document(load_job, request->volume, progress, error);
    return open_volume(load_job, progress, error);
}

static iso_status open_stamp(isosculpt_load_job *load_job, const iso_progress *progress, iso_error *error) {
    isosculpt_loaded *loaded = &load_job->loaded;
    const iso_source source = {.path = load_job->path,
                               .pool = loaded->pool,
                               .progress = progress,
                               .close_holes = load_job->request.close_holes,
                               .report = &loaded->report};
    return iso_source_read_stamp(&source, &loaded->stamp, error);
}

/* Opens the request, and extracts the surface that the window will draw first. */
static iso_status load(isosculpt_load_job *load_job, const iso_progress *progress, iso_error *error) {
    isosculpt_loaded *loaded = &load_job->loaded;
    const iso_progress most = iso_progress_part(progress, 0, 0.9);
    ISO_TRY(iso_pool_create(load_job->request.threads, &loaded->pool, error));
    if (load_job->request.stamp) {
        iso_status status = open_stamp(load_job, progress, error);
        iso_pool_destroy(loaded->pool);
        loaded->pool = NULL;
        return status;
    }
    ISO_TRY(open_path(load_job, &most, error));
    ISO_TRY(iso_progress_tell(progress, load_job->path, 0.95, error));
    enum { SMALL = 64 }; /* pixels; only the surface is wanted */
    ISO_TRY(isosculpt_viewport_draw(&loaded->viewport, SMALL, SMALL, false, error));
    return iso_progress_tell(progress, load_job->path, 1, error);
}

/* isosculpt_task_fn */
static iso_status run_load(void *context, const iso_progress *progress, iso_error *error) {
    isosculpt_load_job *load_job = context;
    iso_status status = load(load_job, progress, error);
    if (status != ISO_OK) isosculpt_loaded_free(&load_job->loaded);
    return status;
}

iso_status isosculpt_load_job_start(const isosculpt_load_request *request, isosculpt_load_job **out,
                                    iso_error *error) {
    isosculpt_load_job *load_job = calloc(1, sizeof *load_job);
    if (!load_job) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for opening '%s'", request->path);
    load_job->request = *request;
    const int path = snprintf(load_job->path, sizeof load_job->path, "%s", request->path),
              folder = snprintf(load_job->folder, sizeof load_job->folder, "%s",
                                request->folder ? request->folder : "");
    load_job->request.folder = request->folder ? load_job->folder : NULL;
    iso_status status = ISO_OK;
    if (path >= ISOSCULPT_PATH || folder >= ISOSCULPT_PATH)
        status = iso_fail(error, ISO_ERR_IO, "%.400s: the name is too long", request->path);
    if (status == ISO_OK)
        status = isosculpt_task_start(run_load, load_job, request->wake, &load_job->task, error);
    if (status == ISO_OK)
        *out = load_job;
    else
        free(load_job);
    return status;
}

bool isosculpt_load_job_is_stamp(const isosculpt_load_job *load_job) {
    return load_job->request.stamp;
}

isosculpt_task *isosculpt_load_job_task(const isosculpt_load_job *load_job) {
    return load_job->task;
}

const char *isosculpt_load_job_path(const isosculpt_load_job *load_job) {
    return load_job->path;
}

iso_status isosculpt_load_job_finish(isosculpt_load_job *load_job, isosculpt_loaded *loaded,
                                     iso_error *error) {
    const bool cancelled = isosculpt_task_cancelled(load_job->task);
    iso_status status = isosculpt_task_finish(load_job->task, error);
    if (status == ISO_OK && cancelled) { /* too late for the task to notice */
        isosculpt_loaded_free(&load_job->loaded);
        status = iso_fail(error, ISO_ERR_IO, "%s: cancelled", load_job->path);
    }
    if (status == ISO_OK) *loaded = load_job->loaded;
    free(load_job);
    return status;
}
