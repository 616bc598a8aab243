/* Messages of isorender on standard error. */
#include <inttypes.h>
#include <stdarg.h>

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
