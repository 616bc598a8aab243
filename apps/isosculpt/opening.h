/* opening: what a window opens while it goes on with what it has: strokes, a level set, a mesh or a volume,
 * in a thread of its own. */
#ifndef ISO_APPS_ISOSCULPT_OPENING_H
#define ISO_APPS_ISOSCULPT_OPENING_H

#include "apps/isosculpt/desk.h"
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

typedef struct isosculpt_opening isosculpt_opening;

/* What was opened: a desk, its view, and the pool that both use. All owned by who takes it. */
typedef struct isosculpt_opened {
    iso_pool *pool;
    isosculpt_desk desk;
    isosculpt_view view;
    isosculpt_volume *volume; /* to be looked at first: then there is no desk */
    iso_stamp *stamp;         /* then the others are not there */
    iso_mesh_report report;   /* of a mesh */
} isosculpt_opened;
void isosculpt_opened_free(isosculpt_opened *opened);

bool isosculpt_is_strokes(const char *path);

/* ISO_ERR_NOMEM, ISO_ERR_IO (the name is too long). */
iso_status isosculpt_opening_start(const isosculpt_request *request, isosculpt_opening **opening,
                                   iso_error *error);
bool isosculpt_opening_is_stamp(const isosculpt_opening *opening);
/* To ask how far it is, or to cancel. */
isosculpt_task *isosculpt_opening_task(const isosculpt_opening *opening);
const char *isosculpt_opening_path(const isosculpt_opening *opening);
/* Waits for its end and frees it. ISO_OK: *opened is the caller's. Else nothing is left, and errors are the
 * readers'. */
iso_status isosculpt_opening_finish(isosculpt_opening *opening, isosculpt_opened *opened, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
