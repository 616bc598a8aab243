/* progress: how far the work on an input is, on standard error: a bar on a terminal
 * (apps/common/progress_bar.h), lines with --progress elsewhere. */
#ifndef ISO_APPS_ISORENDER_PROGRESS_H
#define ISO_APPS_ISORENDER_PROGRESS_H

struct isorender_job;

/* A member of a job. Zero-initialise. */
typedef struct isorender_progress_state {
    const char *stage; /* last reported; NULL: nothing */
    int percent;
    double start, loop_start; /* of the work, and of the pool's present loop, s */
    const char *part_stage;   /* what the pool's loops belong to: */
    double from, to;          /* this part of it */
} isorender_progress_state;

/* Reports that a stage ("reading") is done to `fraction`, 0 .. 1: on a terminal, or with --progress. */
void isorender_progress(struct isorender_job *job, const char *stage, double fraction);
/* The same for the beginning of a part of a stage; until the next call the loops of the job's pool report
 * how much of this part is done. */
void isorender_progress_part(struct isorender_job *job, const char *stage, double from, double to);
const char *isorender_input_name(const struct isorender_job *job); /* for messages */

#endif
