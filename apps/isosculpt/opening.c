#include "apps/isosculpt/opening.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct isosculpt_opening {
    isosculpt_task *task;
    isosculpt_request request;
    char path[ISOSCULPT_PATH], folder[ISOSCULPT_PATH]; /* the request's */
    isosculpt_opened opened;
};

void isosculpt_opened_free(isosculpt_opened *opened) {
    iso_stamp_free(opened->stamp);
    isosculpt_view_free(&opened->view);
    isosculpt_volume_free(opened->volume);
    if (opened->desk.session) isosculpt_desk_drop(&opened->desk);
    iso_pool_destroy(opened->pool);
    *opened = (isosculpt_opened){0};
}

bool isosculpt_is_strokes(const char *path) {
    static const char suffix[] = ".strokes";
    const size_t length = strlen(path), tail = sizeof suffix - 1;
    return length > tail && strcmp(path + length - tail, suffix) == 0;
}

static iso_status open_desk(isosculpt_opening *opening, const isosculpt_volume *volume,
                            const iso_progress *progress, iso_error *error) {
    const isosculpt_request *request = &opening->request;
    isosculpt_opened *opened = &opening->opened;
    const isosculpt_source source = {.path = opening->path,
                                     .isovalue = request->isovalue,
                                     .voxel = request->voxel,
                                     .pool = opened->pool,
                                     .progress = progress,
                                     .volume = volume,
                                     .close_holes = request->close_holes,
                                     .report = &opened->report,
                                     .input = &request->input};
    opened->desk.pool = opened->pool;
    opened->desk.undo_memory = request->undo_memory;
    ISO_TRY(isosculpt_is_strokes(opening->path)
                ? isosculpt_desk_open(&opened->desk, opening->path, progress, error)
                : isosculpt_desk_new(&opened->desk, request->folder, &source, error));
    return isosculpt_view_init(&opened->view, iso_session_grid(opened->desk.session), opened->pool, error);
}

/* One that has isovalues to choose from is looked at, at first. */
static iso_status open_volume(isosculpt_opening *opening, const iso_progress *progress, iso_error *error) {
    isosculpt_opened *opened = &opening->opened;
    const iso_progress reading = iso_progress_part(progress, 0, 0.4),
                       rest = iso_progress_part(progress, 0.4, 1);
    const double asked = opening->request.isovalue;
    isosculpt_volume *volume;
    ISO_TRY(isosculpt_volume_read(opening->path, &opening->request.input, opened->pool, &reading, &volume,
                                  error));
    iso_status status;
    if (volume->has_isovalues)
        status = isosculpt_view_init_grid(&opened->view, &volume->volume.grid,
                                          isnan(asked) ? volume->suggested : asked, opened->pool, error);
    else
        status = open_desk(opening, volume, &rest, error);
    if (status == ISO_OK && volume->has_isovalues)
        opened->volume = volume;
    else
        isosculpt_volume_free(volume);
    return status;
}

static iso_status open_any(isosculpt_opening *opening, const iso_progress *progress, iso_error *error) {
    const isosculpt_request *request = &opening->request;
    const bool mesh = !request->input.has_raw && isosculpt_is_mesh(opening->path);
    if (request->sculpt || isosculpt_is_strokes(opening->path) || mesh)
        return open_desk(opening, request->sculpt, progress, error);
    return open_volume(opening, progress, error);
}

static iso_status open_stamp(isosculpt_opening *opening, const iso_progress *progress, iso_error *error) {
    isosculpt_opened *opened = &opening->opened;
    const isosculpt_source source = {.path = opening->path,
                                     .pool = opened->pool,
                                     .progress = progress,
                                     .close_holes = opening->request.close_holes,
                                     .report = &opened->report};
    return isosculpt_stamp_read(&source, &opened->stamp, error);
}

/* What was asked for, and what a window will draw of it first, so that it need not wait then. */
static iso_status open_all(isosculpt_opening *opening, const iso_progress *progress, iso_error *error) {
    isosculpt_opened *opened = &opening->opened;
    const iso_progress most = iso_progress_part(progress, 0, 0.9);
    ISO_TRY(iso_pool_create(opening->request.threads, &opened->pool, error));
    if (opening->request.stamp) {
        iso_status status = open_stamp(opening, progress, error);
        iso_pool_destroy(opened->pool);
        opened->pool = NULL;
        return status;
    }
    ISO_TRY(open_any(opening, &most, error));
    ISO_TRY(iso_progress_tell(progress, opening->path, 0.95, error));
    enum { SMALL = 64 }; /* it is the surface that is made ready */
    ISO_TRY(isosculpt_view_draw(&opened->view, SMALL, SMALL, false, error));
    return iso_progress_tell(progress, opening->path, 1, error);
}

static iso_status run(void *context, const iso_progress *progress, iso_error *error) {
    isosculpt_opening *opening = context;
    iso_status status = open_all(opening, progress, error);
    if (status != ISO_OK) isosculpt_opened_free(&opening->opened);
    return status;
}

iso_status isosculpt_opening_start(const isosculpt_request *request, isosculpt_opening **out,
                                   iso_error *error) {
    isosculpt_opening *opening = calloc(1, sizeof *opening);
    if (!opening) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for opening '%s'", request->path);
    opening->request = *request;
    const int path = snprintf(opening->path, sizeof opening->path, "%s", request->path),
              folder = snprintf(opening->folder, sizeof opening->folder, "%s",
                                request->folder ? request->folder : "");
    opening->request.folder = request->folder ? opening->folder : NULL;
    iso_status status = ISO_OK;
    if (path >= ISOSCULPT_PATH || folder >= ISOSCULPT_PATH)
        status = iso_fail(error, ISO_ERR_IO, "%.400s: the name is too long", request->path);
    if (status == ISO_OK) status = isosculpt_task_start(run, opening, request->wake, &opening->task, error);
    if (status == ISO_OK)
        *out = opening;
    else
        free(opening);
    return status;
}

bool isosculpt_opening_is_stamp(const isosculpt_opening *opening) {
    return opening->request.stamp;
}

isosculpt_task *isosculpt_opening_task(const isosculpt_opening *opening) {
    return opening->task;
}

const char *isosculpt_opening_path(const isosculpt_opening *opening) {
    return opening->path;
}

iso_status isosculpt_opening_finish(isosculpt_opening *opening, isosculpt_opened *opened, iso_error *error) {
    const bool cancelled = isosculpt_task_cancelled(opening->task);
    iso_status status = isosculpt_task_finish(opening->task, error);
    if (status == ISO_OK && cancelled) { /* it was asked too late to notice */
        isosculpt_opened_free(&opening->opened);
        status = iso_fail(error, ISO_ERR_IO, "%s: cancelled", opening->path);
    }
    if (status == ISO_OK) *opened = opening->opened;
    free(opening);
    return status;
}
