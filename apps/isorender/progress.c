#include "apps/isorender/progress.h"
#include <math.h>
#include <string.h>

#include "apps/common/progress_bar.h"
#include "apps/isorender/isorender.h"
#include "base/clock.h"

/* What takes less than this is not reported by itself, s. */
static const double SHORT = 0.5;

static void report(isorender_job *job, const char *stage, double fraction) {
    isorender_progress_state *state = &job->progress;
    const bool bar = iso_progress_bar_possible(), same = state->stage && strcmp(state->stage, stage) == 0;
    /* In a log file, one line for every 20 % is enough. */
    const int step = bar ? 1 : 20, percent = (int)floor(100 * fraction) / step * step;
    if (same && percent <= state->percent) return;
    state->stage = stage;
    state->percent = percent;
    if (!bar)
        iso_program_log(isorender_program(), "%s: %s %d %%", isorender_input_name(job), stage, percent);
    else if (percent == 100)
        iso_progress_bar_clear();
    else if (job->settings->progress || iso_clock_seconds() - state->start >= SHORT)
        iso_progress_bar_show(stage, percent);
}

static bool is_wanted(isorender_job *job) {
    if (job->settings->common.quiet) return false;
    if (job->progress.start <= 0) job->progress.start = iso_clock_seconds();
    return job->settings->progress || iso_progress_bar_possible();
}

void isorender_progress(isorender_job *job, const char *stage, double fraction) {
    if (!is_wanted(job)) return;
    iso_pool_watch(job->pool, NULL, NULL);
    report(job, stage, fraction);
}

/* A loop of the pool is done to `fraction`. Of several loops in a part, only long ones move the bar. */
static bool watch_loop(void *context, double fraction) {
    isorender_job *job = context;
    isorender_progress_state *state = &job->progress;
    const double now = iso_clock_seconds();
    if (fraction <= 0) state->loop_start = now;
    if (now - state->loop_start >= SHORT / 2)
        report(job, state->part_stage, state->from + (state->to - state->from) * fraction);
    return false;
}

void isorender_progress_part(isorender_job *job, const char *stage, double from, double to) {
    if (!is_wanted(job)) return;
    job->progress.part_stage = stage;
    job->progress.from = from;
    job->progress.to = to;
    report(job, stage, from);
    iso_pool_watch(job->pool, watch_loop, job);
}
