/* task: work in a background thread, with its progress, and a way to cancel it. */
#ifndef ISO_APPS_ISOSCULPT_TASK_H
#define ISO_APPS_ISOSCULPT_TASK_H

#include "base/c_linkage.h"
#include "base/progress.h"

ISO_C_BEGIN

typedef struct isosculpt_task isosculpt_task;

/* The work, called in the background thread. It reports to `progress` often; when that returns ISO_ERR_IO
 * because the task was cancelled, the work frees what it has made and returns the error. */
typedef iso_status isosculpt_task_fn(void *context, const iso_progress *progress, iso_error *error);

/* Starts a thread that calls `run`. `context` is borrowed until isosculpt_task_finish. `wake` (or NULL) is
 * called in that thread when the work is done. ISO_ERR_NOMEM. */
iso_status isosculpt_task_start(isosculpt_task_fn *run, void *context, void (*wake)(void),
                                isosculpt_task **task, iso_error *error);

/* The functions below are for the thread that started the task. */
double isosculpt_task_fraction(const isosculpt_task *task); /* progress, 0 .. 1 */
bool isosculpt_task_done(const isosculpt_task *task);
bool isosculpt_task_cancelled(
    const isosculpt_task *task);                        /* cancelling was asked for; may have come too late */
bool isosculpt_task_failed(const isosculpt_task *task); /* done, with an error */
void isosculpt_task_cancel(isosculpt_task *task);
/* Waits until the work is done, frees the task and returns the result of the work. */
iso_status isosculpt_task_finish(isosculpt_task *task, iso_error *error);

ISO_C_END
#endif
