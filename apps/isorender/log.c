/* Messages and progress of isorender on standard error. */
#define _GNU_SOURCE
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

#include "apps/isorender/chunks.h"
#include "apps/isorender/isorender.h"
#include "base/text.h"

const char *isorender_input_name(const isorender_job *job) {
    return iso_spool_name(job->plan->input);
}

static void print_line(const isorender_job *job, const char *format, va_list arguments) {
    char text[4096];
    iso_text_format(text, sizeof text, format, arguments);
    iso_program_log(isorender_program(), "%s: %s", isorender_input_name(job), text);
}

void isorender_log(const isorender_job *job, const char *format, ...) {
    if (job->settings->common.quiet) return;
    va_list arguments;
    va_start(arguments, format);
    print_line(job, format, arguments);
    va_end(arguments);
}

void isorender_log_verbose(const isorender_job *job, const char *format, ...) {
    if (!job->settings->verbose || job->settings->common.quiet) return;
    va_list arguments;
    va_start(arguments, format);
    print_line(job, format, arguments);
    va_end(arguments);
}

void isorender_log_nonfinite(const isorender_job *job) {
    if (!job->loader.nonfinite) return;
    isorender_log(job, "note: %zu voxels are NaN or infinite, as floats: %s", job->loader.nonfinite,
                  job->settings->closed ? "outside the solid" : "no surface is made next to them");
}

static void draw_bar(const char *stage, int percent) {
    enum { BAR = 40 };
    char bar[BAR + 1];
    for (int i = 0; i < BAR; i++) bar[i] = i < percent * BAR / 100 ? '#' : ' ';
    bar[BAR] = 0;
    fprintf(stderr, "\r%-12s [%s] %3d %%%s", stage, bar, percent, percent == 100 ? "\n" : "");
    fflush(stderr);
}

void isorender_progress(isorender_job *job, const char *stage, double fraction) {
    if (!job->settings->progress || job->settings->common.quiet) return;
    /* In a log file, one line for every 20 % is enough. */
    bool terminal = isatty(STDERR_FILENO);
    int step = terminal ? 1 : 20;
    int percent = (int)floor(100 * fraction) / step * step;
    bool same = job->progress_stage && strcmp(job->progress_stage, stage) == 0;
    if (same && percent <= job->progress_percent) return;
    job->progress_stage = stage;
    job->progress_percent = percent;
    if (terminal)
        draw_bar(stage, percent);
    else
        iso_program_log(isorender_program(), "%s: %s %d %%", isorender_input_name(job), stage, percent);
}

void isorender_log_report(const isorender_job *job, const char *path, const iso_read_report *report) {
    const char *colon = *path ? ": " : "";
    for (int i = 0; i < report->note_count; i++)
        isorender_log(job, "note: %s%s%s", path, colon, report->notes[i]);
    if (report->dropped)
        isorender_log(job, "note: %s%s%" PRIu64 " positions are not finite and are left out", path, colon,
                      report->dropped);
    if (report->mended_radii)
        isorender_log(job, "note: %s%s%" PRIu64 " radii are negative or not finite and became 0", path, colon,
                      report->mended_radii);
}
