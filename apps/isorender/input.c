/* The input of one run: opened, checked against the options and the memory limit, and read. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "apps/isorender/chunks.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/resolution_level.h"
#include "apps/isorender/segmentation.h"
#include "base/memory.h"
#include "io/file_contents.h"

/* ---- checks that need the header ---- */

static uint64_t memory_limit(const isorender_settings *settings) {
    return iso_memory_limit(settings->common.input.max_memory);
}

static iso_status check_picture(const isorender_job *job, iso_error *error) {
    if (!isorender_plan_draws(job->plan)) return ISO_OK;
    const uint64_t needs = isorender_picture_bytes(job, job->samples), limit = memory_limit(job->settings);
    char samples[40] = "";
    if (needs <= limit) return ISO_OK;
    const bool fewer_help = job->samples > 1 && isorender_picture_bytes(job, 1) <= limit;
    if (fewer_help) snprintf(samples, sizeof samples, " with %d samples a pixel", job->samples);
    return iso_fail(error, ISO_ERR_LIMIT,
                    "a picture of %dx%d%s needs %.0f MB, limit is %.0f MB (--max-memory%s)",
                    job->settings->width, job->settings->height, samples, (double)needs / 1e6,
                    (double)limit / 1e6, fewer_help ? "; --samples 1 needs less" : "");
}

/* Checks that the limit of memory allows the grids of their own that surfaces will get (closed, or with
 * parts removed), estimated from the header before the volume is read. */
static iso_status check_copies(const isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const iso_volume_info *info = &job->loader.volume.info;
    int dims[3];
    for (int axis = 0; axis < 3; axis++)
        dims[axis] = job->loader.crop[2 * axis + 1] - job->loader.crop[2 * axis] + 1;
    const uint64_t more = isorender_solid_bytes(job, dims, info->bytes), limit = memory_limit(settings);
    if (more == 0 || settings->info || (info->bytes <= limit && more <= limit - info->bytes)) return ISO_OK;
    return iso_fail(
        error, ISO_ERR_LIMIT,
        "grids of %.0f MB for --closed or several surfaces' parts, beside the volume's %.0f MB, are "
        "over the limit of %.0f MB (--max-memory)",
        (double)more / 1e6, (double)info->bytes / 1e6, (double)limit / 1e6);
}

/* ---- opening and reading ---- */

static void report_reading(void *context, double fraction) {
    isorender_progress(context, "reading", fraction);
}

/* The renderer of a method with --reconstruction, or with the method's usual one. */
static const iso_renderer *find_renderer(const isorender_settings *settings, iso_method method) {
    const char *name = isorender_reconstruction_name(settings, method == ISO_METHOD_SPLATS);
    const iso_renderer *found = iso_renderer_find(method, name);
    return found ? found : iso_renderer_get(method);
}

static int usual_samples(const isorender_job *job) {
    const isorender_settings *settings = job->given; /* (one number for all pictures of a film) */
    const bool opaque = !isorender_is_translucent(settings) && !isorender_object_opacity_option(settings) &&
                        !(settings->ior > 0) && !job->gaussians;
    return opaque ? iso_method_samples(job->method) : 1;
}

static void choose_method(isorender_job *job) {
    const isorender_settings *settings = job->settings;
    const bool pyramid = settings->reconstruction == (int)ISO_RECONSTRUCTION_BOX ||
                         settings->reconstruction == (int)ISO_RECONSTRUCTION_GAUSSIAN;
    const iso_method of_points = pyramid && !isorender_is_translucent(settings) && !(settings->ior > 0)
                                     ? ISO_METHOD_PULLPUSH
                                     : ISO_METHOD_SPLATS;
    const iso_method of_volumes = settings->instances ? ISO_METHOD_DISCS : ISO_METHOD_EXACT;
    const iso_method usual = job->loader.has_points && !job->gaussians ? of_points : of_volumes;
    job->method = settings->method == ISORENDER_METHOD_UNCHOSEN ? usual : (iso_method)settings->method;
    job->renderer = find_renderer(settings, job->method);
    job->samples = settings->samples ? settings->samples : usual_samples(job);
}

/* Whether --method says how lines are drawn, or nothing. */
static bool is_method_of_lines(int method) {
    return method == ISORENDER_METHOD_UNCHOSEN || method == ISO_METHOD_EXACT || method == ISO_METHOD_PULLPUSH;
}

/* The option of the first line, glyph or mesh file that is called as one of surfaces is; NULL: none is. */
static const char *option_of_object(const isorender_settings *settings, const char *option) {
    static const char *const colors[ISO_OBJECT_KINDS] = {[ISO_OBJECT_LINES] = "--line-color",
                                                         [ISO_OBJECT_GLYPHS] = "--glyph-color",
                                                         [ISO_OBJECT_MESH] = "--surface-color"};
    static const char *const opacities[ISO_OBJECT_KINDS] = {[ISO_OBJECT_LINES] = "--line-opacity",
                                                            [ISO_OBJECT_GLYPHS] = "--glyph-opacity",
                                                            [ISO_OBJECT_MESH] = "--surface-opacity"};
    const iso_object_kind kind = settings->object_options.kinds[0];
    return strcmp(option, "--color") == 0     ? colors[kind]
           : strcmp(option, "--opacity") == 0 ? opacities[kind]
                                              : NULL;
}

/* Options that need an input, for pictures without one. */
static iso_status check_no_input(const isorender_settings *settings, iso_error *error) {
    const iso_input *input = &settings->common.input;
    const bool labels = settings->labels || settings->smooth,
               surfaces = settings->volume_options.count || labels;
    const char *option = !surfaces && !is_method_of_lines(settings->method) ? "--method"
                         : settings->isovalue_count                         ? "--isovalue"
                         : settings->opacity_count && !settings->smooth     ? "--opacity"
                         : settings->color_count && !settings->smooth       ? "--color"
                         : settings->points                                 ? "--points"
                         : settings->mesh && !labels                        ? "--mesh"
                         : settings->closed                                 ? "--closed"
                         : labels                                           ? NULL
                         : input->cropped                                   ? "--crop"
                         : input->cropped_mm                                ? "--crop-mm"
                         : input->largest                                   ? "--largest"
                         : input->min_size > 0                              ? "--min-size"
                                                                            : NULL;
    if (!option && isorender_wants_gradients(settings)) option = "--glyphs surface";
    if (!option) return ISO_OK;
    const char *of_object =
        surfaces || !settings->object_options.count ? NULL : option_of_object(settings, option);
    if (of_object)
        return iso_fail(error, ISO_ERR_USAGE, "%s is for surfaces of volumes: here it is %s", option,
                        of_object);
    if (labels && !settings->volume_options.count)
        return iso_fail(error, ISO_ERR_USAGE, "%s is for isosurfaces: what is drawn are labels%s", option,
                        settings->segments ? " (the file names segments: --isovalue draws isosurfaces)" : "");
    return iso_fail(error, ISO_ERR_USAGE,
                    surfaces ? "%s is for an input: there are only further files (--volume and others)"
                             : "%s is for surfaces of volumes: there are lines, glyphs or meshes only",
                    option);
}

static iso_status check_columns(const isorender_job *job, iso_error *error) {
    if (!job->settings->columns ||
        (job->loader.has_points && iso_file_contents(job->loader.path) & ISO_HOLDS_ROWS))
        return ISO_OK;
    char known[128];
    iso_file_type_extensions(ISO_HOLDS_ROWS, 0, "and", known, sizeof known);
    return iso_fail(error, ISO_ERR_USAGE, "--columns is for points in rows of numbers: %s", known);
}

iso_status isorender_open(isorender_job *job, iso_error *error) {
    iso_loader *loader = &job->loader;
    ISO_TRY(isorender_level_choose(job, error));
    *loader = (iso_loader){.input = job->plan->input,
                           .options = &job->input,
                           .files = job->plan->files,
                           .space = job->settings->cloud.space,
                           .every = job->settings->cloud.every,
                           .columns = job->settings->columns,
                           .pool = job->pool,
                           .wants_histogram = job->settings->info || !job->settings->isovalue_count,
                           .progress = report_reading,
                           .progress_context = job,
                           .shelf = job->settings->panel ? job->settings->panel->shelf : NULL};
    if (!job->settings->no_input) ISO_TRY(iso_loader_open(loader, error));
    ISO_TRY(isorender_volumes_open(job, error));
    ISO_TRY(isorender_segmentation_open(job, error));
    ISO_TRY(isorender_colorings_open(job, error));
    job->has_volume = !loader->has_points && !job->settings->no_input;
    ISO_TRY(isorender_gaussians_choose(job, error));
    choose_method(job);
    ISO_TRY(isorender_cuts_check_points(job, error));
    ISO_TRY(isorender_instances_check(job, error));
    ISO_TRY(check_columns(job, error));
    ISO_TRY(isorender_chunks_choose(job, error));
    if (job->settings->no_input) {
        ISO_TRY(check_no_input(job->settings, error));
        return check_picture(job, error);
    }
    /* When the volume alone is over the limit, iso_loader_read refuses it with a better message than
     * check_picture would. */
    const bool is_file = isnan(loader->scene_isovalue) && !loader->has_points;
    if (!is_file || job->chunks || loader->volume.info.read_bytes <= memory_limit(job->settings))
        ISO_TRY(check_picture(job, error));
    return loader->has_points ? isorender_cloud_check(job->settings, error) : check_copies(job, error);
}

static void log_notes(isorender_job *job) {
    const iso_volume_info *info = &job->loader.volume.info;
    if (job->notes_logged || job->settings->film->first) return; /* (of a series the first step says them) */
    job->notes_logged = true;
    for (int i = 0; i < info->note_count; i++) isorender_log(job, "note: %s", info->notes[i]);
    isorender_log_nonfinite(job);
    isorender_segmentation_note(job);
}

static void log_object(const isorender_job *job, const isorender_object *object) {
    const bool is_input = strcmp(object->settings->path, job->plan->input) == 0; /* it is named already */
    isorender_log_report(job, is_input ? "" : object->settings->path, &object->file.report);
}

static iso_status check_color_bar(const isorender_job *job, iso_error *error) {
    bool has_bar = !job->settings->color_bar || job->cloud_colors.has_bar || job->settings->coloring_count ||
                   isorender_shows_slices(job->settings);
    for (int i = 0; i < job->object_count; i++)
        has_bar |= job->objects[i].has_bar || isorender_gradients_have_bar(job->objects[i].settings);
    if (has_bar) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    "--color-bar shows which colours --color-by, --surface-color-by, --slice and --cap slice "
                    "use: none of them is given");
}

/* Reads the files of --lines and --glyphs. */
static iso_status read_objects(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    for (int i = 0; i < settings->object_options.count; i++) {
        isorender_object *object = &job->objects[job->object_count++];
        ISO_TRY(isorender_object_read(object, &settings->objects[i], memory_limit(settings), job->plan->files,
                                      job->pool, error));
        log_object(job, object);
        ISO_TRY(isorender_object_add_parts(job, object, error));
    }
    ISO_TRY(check_color_bar(job, error));
    return job->object_count ? iso_file_set_check(job->plan->files, error) : ISO_OK;
}

iso_status isorender_read(isorender_job *job, iso_error *error) {
    if (job->has_volume) ISO_TRY(iso_loader_read(&job->loader, error));
    if (job->has_volume) log_notes(job);
    if (job->loader.has_points) ISO_TRY(isorender_cloud_read(job, error));
    ISO_TRY(isorender_volumes_read(job, error));
    ISO_TRY(isorender_segmentation_read(job, error));
    ISO_TRY(isorender_colorings_read(job, error));
    ISO_TRY(isorender_instances_read(job, memory_limit(job->settings), error));
    return read_objects(job, error);
}
