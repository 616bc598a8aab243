/* load_job: opens a file (strokes, level set, mesh or volume) in a background thread, while the window keeps
 * working on its current document. */
#ifndef ISO_APPS_ISOSCULPT_LOAD_JOB_H
#define ISO_APPS_ISOSCULPT_LOAD_JOB_H

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/freezing.h"
#include "apps/isosculpt/viewport/viewport.h"

/* What to open. The job copies everything except the borrowed pointers. */
typedef struct isosculpt_load_request {
    const char *path;                /* of strokes (.strokes), or of anything that iso_source_open reads */
    iso_start_solid solid;           /* size.x > 0: a new session begins with it; the path is its name */
    bool resample;                   /* the path is a stroke file, to be played in voxels of size `voxel` */
    bool stamp;                      /* the path is a mesh to be used as a stamp */
    const iso_source_volume *volume; /* borrowed: the viewed volume, to be converted into a field; NULL: the
                                       path is read */
    const char *folder;              /* of new journals; NULL: none is written */
    double isovalue, voxel, close_holes; /* as in iso_source */
    isosculpt_freezing freezing;         /* of the volume, once it is a field */
    iso_input input;    /* how the path is read, unless it is strokes; its strings are borrowed */
    int threads;        /* 0: one for each processor */
    size_t undo_memory; /* bytes */
    void (*wake)(void); /* as in isosculpt_task_start */
} isosculpt_load_request;

typedef struct isosculpt_load_job isosculpt_load_job;

/* The result of a load job: a stamp; a volume and its viewport; or a document and its viewport. The caller of
 * isosculpt_load_job_finish owns everything. */
typedef struct isosculpt_loaded {
    iso_pool *pool; /* used by document and viewport */
    isosculpt_document document;
    isosculpt_viewport viewport;
    iso_source_volume *volume; /* a volume to be viewed until the user sculpts it, in which case there is no
                                 document; or NULL */
    iso_stamp *stamp;          /* the stamp, in which case there is nothing else; or NULL */
    iso_mesh_report report;    /* of a mesh */
    bool resampled;            /* the document is the one before in other voxels */
} isosculpt_loaded;
void isosculpt_loaded_free(isosculpt_loaded *loaded);

/* Whether the path has the extension of a stroke file. */
bool isosculpt_is_strokes(const char *path);

/* ISO_ERR_NOMEM, ISO_ERR_IO (the name is too long). */
iso_status isosculpt_load_job_start(const isosculpt_load_request *request, isosculpt_load_job **load_job,
                                    iso_error *error);
bool isosculpt_load_job_is_stamp(const isosculpt_load_job *load_job);
/* The task, for its progress or to cancel it. Borrowed. */
isosculpt_task *isosculpt_load_job_task(const isosculpt_load_job *load_job);
const char *isosculpt_load_job_path(const isosculpt_load_job *load_job);
/* Waits until the task is done and frees the job. ISO_OK: *loaded is the caller's. Else the readers' error,
 * or ISO_ERR_IO when cancelled; nothing is left. */
iso_status isosculpt_load_job_finish(isosculpt_load_job *load_job, isosculpt_loaded *loaded,
                                     iso_error *error);

#endif
