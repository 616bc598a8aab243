/* Steps in time. */
#include "apps/isorender/series.h"

#include <glob.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "scene/bounds.h"

enum { MOST_STEPS = 100000 };

static int compare(const void *a, const void *b) {
    return strverscmp(*(char *const *)a, *(char *const *)b);
}

/* How many components of a file lie between two steps: those of its channels follow each other. */
static int stride_of(const iso_channels *channels, int components) {
    return channels->count > 0 && components % channels->count == 0 ? channels->count : 1;
}

/* The steps of a file: the component that is chosen, at every time. */
static iso_status take_components(isorender_settings *settings, char *path, iso_error *error) {
    iso_volume_opts opts = iso_input_volume_opts(&settings->common.input);
    iso_volume_info info = {0};
    iso_channels channels = {0};
    opts.channels = &channels;
    ISO_TRY(iso_volume_read_info(path, &opts, &info, error));
    const int stride = stride_of(&channels, info.components), first = settings->common.input.component,
              count = (info.components - first + stride - 1) / stride;
    if (count < 2)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "--series-of %s: %d component%s: one step is no series (a pattern in quotes names several "
            "files: 't_*.vti')",
            path, info.components, info.components == 1 ? "" : "s");
    char **steps = calloc((size_t)count + 1, sizeof *steps);
    if (!steps) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int i = 0; i < count; i++) steps[i] = path;
    settings->steps = steps;
    settings->step_stride = stride;
    settings->input_count = count;
    return ISO_OK;
}

static iso_status take_files(isorender_settings *settings, const glob_t *found, iso_error *error) {
    char **steps = calloc(found->gl_pathc + 1, sizeof *steps);
    bool whole = steps != NULL;
    for (size_t i = 0; whole && i < found->gl_pathc; i++)
        whole = (steps[i] = strdup(found->gl_pathv[i])) != NULL;
    settings->steps = steps;
    settings->input_count = (int)found->gl_pathc;
    if (!whole) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    qsort(steps, found->gl_pathc, sizeof *steps, compare);
    return ISO_OK;
}

static iso_status take_found(isorender_settings *settings, const glob_t *found, iso_error *error) {
    if (found->gl_pathc > MOST_STEPS)
        return iso_fail(error, ISO_ERR_LIMIT, "--series-of %s: more than %d files", settings->series_of,
                        MOST_STEPS);
    if (found->gl_pathc > 1) return take_files(settings, found, error);
    free(settings->series_file);
    settings->series_file = strdup(found->gl_pathv[0]);
    return settings->series_file ? take_components(settings, settings->series_file, error)
                                 : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

iso_status isorender_series_take(isorender_settings *settings, iso_error *error) {
    glob_t found;
    char *exact[1] = {(char *)settings->series_of};
    const glob_t one = {.gl_pathc = 1, .gl_pathv = exact};
    if (settings->common.input.channel)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--series-of takes the times of one channel: --component chooses it");
    settings->same_view = 1;
    iso_status status;
    if (access(settings->series_of, F_OK) == 0)
        status = take_found(settings, &one, error);
    else if (glob(settings->series_of, GLOB_NOSORT, NULL, &found) != 0)
        return iso_fail(error, ISO_ERR_IO, "--series-of %s: no file is called so", settings->series_of);
    else {
        status = take_found(settings, &found, error);
        globfree(&found);
    }
    settings->inputs = (const char *const *)settings->steps;
    return status;
}

void isorender_series_free(isorender_settings *settings) {
    for (int i = 0; settings->steps && !settings->step_stride && i < settings->input_count; i++)
        free(settings->steps[i]);
    free(settings->steps);
    free(settings->series_file);
    settings->steps = NULL;
    settings->series_file = NULL;
}

void isorender_series_choose(isorender_settings *settings, int step) {
    settings->common.input.component += step * settings->step_stride;
}

bool isorender_series_is_measured(const isorender_settings *settings) {
    bool unranged = false;
    for (int i = 0; i < settings->coloring_count; i++) unranged |= isnan(settings->colorings[i].range[0]);
    return isnan(settings->position[0]) || !settings->isovalue_count || unranged;
}

void isorender_series_measure(isorender_job *job) {
    isorender_film *film = job->settings->film;
    if (!film->has_bounds) film->bounds = iso_box_empty();
    film->has_bounds = true;
    const iso_box shown = isorender_bounds_shown(job);
    iso_bounds_add(&film->bounds, &shown);
}
