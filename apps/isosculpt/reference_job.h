/* reference_job: makes the reference of a document, the field that its session began with, in a background
 * thread. The field is made anew from what the journal's header says, as for a replay. */
#ifndef ISO_APPS_ISOSCULPT_REFERENCE_JOB_H
#define ISO_APPS_ISOSCULPT_REFERENCE_JOB_H

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/viewport/reference.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct isosculpt_reference_job isosculpt_reference_job;

/* `threads`: 0: one for each processor. `wake`: as in isosculpt_task_start. ISO_ERR_NOMEM. */
iso_status isosculpt_reference_job_start(const isosculpt_document *document, int threads, void (*wake)(void),
                                         isosculpt_reference_job **job, iso_error *error);
bool isosculpt_reference_job_done(const isosculpt_reference_job *job);
/* Waits until the job is done and frees it. ISO_OK: *reference is the caller's. Errors: those of
 * isosculpt_source_reopen, and ISO_ERR_NOMEM. */
iso_status isosculpt_reference_job_finish(isosculpt_reference_job *job, isosculpt_reference **reference,
                                          iso_error *error);
/* Cancels the job, waits for its end and frees it. NULL is fine. */
void isosculpt_reference_job_cancel(isosculpt_reference_job *job);

#ifdef __cplusplus
}
#endif
#endif
