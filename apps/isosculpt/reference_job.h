/* reference_job: makes the reference of a document in a background thread: from files, from the other labels
 * of the segmentation, or from the field that its session began with, which is made anew from what the
 * journal's header says, as for a replay. */
#ifndef ISO_APPS_ISOSCULPT_REFERENCE_JOB_H
#define ISO_APPS_ISOSCULPT_REFERENCE_JOB_H

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/reference_file.h"

typedef struct isosculpt_reference_job isosculpt_reference_job;

/* The files are copied, and their settings borrowed. `wake`: as in isosculpt_task_start. ISO_ERR_NOMEM. */
iso_status isosculpt_reference_job_start(const isosculpt_document *document,
                                         const isosculpt_reference_files *files, void (*wake)(void),
                                         isosculpt_reference_job **job, iso_error *error);
bool isosculpt_reference_job_done(const isosculpt_reference_job *job);
/* Waits until the job is done and frees it. ISO_OK: *reference is the caller's, and *files (NULL is fine) has
 * the notes. Errors: those of isosculpt_reference_read, iso_source_reopen, and ISO_ERR_NOMEM. */
iso_status isosculpt_reference_job_finish(isosculpt_reference_job *job, isosculpt_reference **reference,
                                          isosculpt_reference_files *files, iso_error *error);
/* Cancels the job, waits for its end and frees it. NULL is fine. */
void isosculpt_reference_job_cancel(isosculpt_reference_job *job);

#endif
