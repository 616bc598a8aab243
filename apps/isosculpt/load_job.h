/* opening: what a window opens while it goes on with what it has: strokes, a level set, a mesh or a volume,
 * in a thread of its own. */
#ifndef ISO_APPS_ISOSCULPT_LOAD_JOB_H
#define ISO_APPS_ISOSCULPT_LOAD_JOB_H

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/view/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is asked for; copied. */
typedef struct isosculpt_request {
    const char *path; /* strokes (.strokes), or what isosculpt_source takes */
    bool stamp;       /* it is a mesh, wanted as a stamp and nothing else */
    const isosculpt_volume
        *sculpt;        /* what is looked at, borrowed: it becomes a field; NULL: the path is read */
    const char *folder; /* of new journals; NULL: none */
    double isovalue, voxel, close_holes; /* isosculpt_source */
    iso_input input; /* how the path is read, unless it is strokes; its strings are borrowed */
    int threads;     /* 0: one a processor */
    size_t undo_memory;
    void (*wake)(void); /* isosculpt_task_start */
} isosculpt_request;

typedef struct isosculpt_load_job isosculpt_load_job;

/* What was opened: a desk, its view, and the pool that both use. All owned by who takes it. */
typedef struct isosculpt_loaded {
    iso_pool *pool;
    isosculpt_document document;
    isosculpt_view view;
    isosculpt_volume *volume; /* to be looked at first: then there is no desk */
    iso_stamp *stamp;         /* then the others are not there */
    iso_mesh_report report;   /* of a mesh */
} isosculpt_loaded;
void isosculpt_loaded_free(isosculpt_loaded *loaded);

bool isosculpt_is_strokes(const char *path);

/* ISO_ERR_NOMEM, ISO_ERR_IO (the name is too long). */
iso_status isosculpt_load_job_start(const isosculpt_request *request, isosculpt_load_job **load_job,
                                    iso_error *error);
bool isosculpt_load_job_is_stamp(const isosculpt_load_job *load_job);
/* To ask how far it is, or to cancel. */
isosculpt_task *isosculpt_load_job_task(const isosculpt_load_job *load_job);
const char *isosculpt_load_job_path(const isosculpt_load_job *load_job);
/* Waits for its end and frees it. ISO_OK: *opened is the caller's. Else nothing is left, and errors are the
 * readers'. */
iso_status isosculpt_load_job_finish(isosculpt_load_job *load_job, isosculpt_loaded *loaded,
                                     iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
