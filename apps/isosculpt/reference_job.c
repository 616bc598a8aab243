/* Reference jobs: files, or the session's first field and its surface, in a background thread. */
#include "apps/isosculpt/reference_job.h"

#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt/other_labels.h"

struct isosculpt_reference_job {
    isosculpt_task *task;
    iso_journal_start start; /* a copy: the document goes on changing */
    char journal[ISOSCULPT_PATH];
    isosculpt_reference_files files;
    isosculpt_reference *reference;
};

static iso_status make_first_field(isosculpt_reference_job *job, const iso_progress *progress,
                                   iso_error *error) {
    const int threads = job->files.settings->common.threads;
    iso_pool *pool;
    iso_hgrid *grid;
    ISO_TRY(iso_pool_create(threads, &pool, error));
    iso_status status =
        isosculpt_document_first_field(&job->start, job->journal, pool, progress, &grid, error);
    iso_pool_destroy(pool);
    ISO_TRY(status);
    return isosculpt_reference_create(grid, threads, &job->reference, error);
}

/* isosculpt_task_fn */
static iso_status run_job(void *context, const iso_progress *progress, iso_error *error) {
    isosculpt_reference_job *job = context;
    const isosculpt_settings *settings = job->files.settings;
    if (!settings->references.count && job->files.labels)
        return isosculpt_other_labels_make(&job->start, job->journal, settings->common.input.max_memory,
                                           settings->common.threads, progress, &job->files.sculpted,
                                           &job->reference, error);
    if (!settings->references.count) return make_first_field(job, progress, error);
    job->files.progress = progress;
    return isosculpt_reference_read(&job->files, &job->reference, error);
}

iso_status isosculpt_reference_job_start(const isosculpt_document *document,
                                         const isosculpt_reference_files *files, void (*wake)(void),
                                         isosculpt_reference_job **out, iso_error *error) {
    isosculpt_reference_job *job = calloc(1, sizeof *job);
    if (!job) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the reference");
    job->start = document->start;
    memcpy(job->journal, document->journal, sizeof job->journal);
    job->files = *files;
    iso_status status = isosculpt_task_start(run_job, job, wake, &job->task, error);
    if (status == ISO_OK)
        *out = job;
    else
        free(job);
    return status;
}

bool isosculpt_reference_job_done(const isosculpt_reference_job *job) {
    return isosculpt_task_done(job->task);
}

iso_status isosculpt_reference_job_finish(isosculpt_reference_job *job, isosculpt_reference **reference,
                                          isosculpt_reference_files *files, iso_error *error) {
    iso_status status = isosculpt_task_finish(job->task, error);
    if (status == ISO_OK) *reference = job->reference;
    if (files) *files = job->files;
    free(job);
    return status;
}

void isosculpt_reference_job_cancel(isosculpt_reference_job *job) {
    isosculpt_reference *reference;
    if (!job) return;
    isosculpt_task_cancel(job->task);
    if (isosculpt_reference_job_finish(job, &reference, NULL, NULL) == ISO_OK)
        isosculpt_reference_destroy(reference);
}
