/* task: heavy work in a thread of its own, how far it is, and a way to cancel it. */
#ifndef ISO_APPS_ISOSCULPT_TASK_H
#define ISO_APPS_ISOSCULPT_TASK_H

#include "base/progress.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct isosculpt_task isosculpt_task;

/* The work. It asks `progress` often; cancelled, it leaves nothing behind and returns an error. */
typedef iso_status isosculpt_task_fn(void *context, const iso_progress *progress, iso_error *error);

/* `context` is borrowed until the task is finished. `wake` is called by the thread when it is done (NULL:
 * nobody is). ISO_ERR_NOMEM. */
iso_status isosculpt_task_start(isosculpt_task_fn *run, void *context, void (*wake)(void),
                                isosculpt_task **task, iso_error *error);

/* For the thread that started it. */
double isosculpt_task_fraction(const isosculpt_task *task); /* 0 .. 1 */
bool isosculpt_task_done(const isosculpt_task *task);
bool isosculpt_task_cancelled(const isosculpt_task *task); /* it was asked to end, and may have been done */
bool isosculpt_task_failed(const isosculpt_task *task);    /* it is done, and not well */
void isosculpt_task_cancel(isosculpt_task *task);
/* Waits for its end; frees it; what the work returned. */
iso_status isosculpt_task_finish(isosculpt_task *task, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
