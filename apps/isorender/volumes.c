/* volumes: opens, reads and reports the further volumes of a picture (--volume and --channel). */
#include <math.h>
#include <string.h>

#include "apps/isorender/channels.h"

iso_status isorender_volume_named(const isorender_job *job, int volume, iso_status status, iso_error *error) {
    const iso_loader *loader = volume < 0 ? &job->loader : &job->volumes[volume];
    char title[ISORENDER_CHANNEL_TITLE], text[sizeof error->text];
    const bool is_channel = loader->options && loader->options->channel;
    if (volume < 0 && !is_channel) return status;
    if (status == ISO_OK || strncmp(error->text, loader->input, strlen(loader->input)) == 0) return status;
    snprintf(text, sizeof text, "%s", error->text);
    if (!is_channel) return iso_fail(error, status, "%s: %s", loader->input, text);
    return iso_fail(error, status, "%s: %s", isorender_channel_title(loader, title), text);
}

static iso_status open_volume(isorender_job *job, int volume, iso_error *error) {
    iso_loader *loader = &job->volumes[volume];
    ISO_TRY(iso_loader_open(loader, error));
    ISO_TRY(isorender_channel_check(job, volume, error));
    if (!loader->has_points) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "holds points: --volume draws isosurfaces of volumes");
}

/* How a further volume is read: a channel of the input as the input. */
static iso_input reading_of(const isorender_job *job, const isorender_volume_settings *volume) {
    iso_input input = {.max_memory = job->settings->common.input.max_memory, .grid = volume->grid};
    if (volume->channel) input = job->input;
    input.channel = volume->channel;
    input.component = volume->component;
    return input;
}

iso_status isorender_volumes_open(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    if (!isorender_plan_draws(job->plan) && !settings->info) return ISO_OK; /* exports are of the input */
    for (int i = 0; i < settings->volume_count; i++) {
        const isorender_volume_settings *volume = &settings->volumes[i];
        iso_loader *loader = &job->volumes[job->volume_count++];
        job->volume_inputs[i] = reading_of(job, volume);
        *loader = (iso_loader){.input = volume->channel ? job->plan->input : volume->path,
                               .options = &job->volume_inputs[i],
                               .files = job->plan->files,
                               .pool = job->pool,
                               .is_further = true,
                               .wants_histogram = settings->info || isnan(volume->isovalue.value)};
        ISO_TRY(isorender_volume_named(job, i, open_volume(job, i, error), error));
    }
    return ISO_OK;
}

/* The notes on the file of a channel are those on the input. */
static void log_notes(const isorender_job *job, const iso_loader *loader) {
    const iso_volume_info *info = &loader->volume.info;
    const bool is_channel = loader->options->channel;
    char title[ISORENDER_CHANNEL_TITLE];
    const char *name = is_channel ? isorender_channel_title(loader, title) : loader->input;
    for (int i = 0; i < info->note_count && !is_channel; i++)
        isorender_log(job, "note: %s: %s", name, info->notes[i]);
    if (loader->nonfinite)
        isorender_log(job,
                      "note: %s: %zu voxels are NaN or infinite, as floats: no surface is made next to them",
                      name, loader->nonfinite);
}

iso_status isorender_volumes_read(isorender_job *job, iso_error *error) {
    for (int i = 0; i < job->volume_count; i++) {
        iso_loader *loader = &job->volumes[i];
        ISO_TRY(isorender_volume_named(job, i, iso_loader_read(loader, error), error));
        log_notes(job, loader);
    }
    return ISO_OK;
}

static void put_volume(iso_json *json, const isorender_job *job, const iso_loader *loader, int number) {
    const iso_volume_info *info = &loader->volume.info;
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "path", loader->input);
    iso_json_string(json, "format", info->format);
    iso_json_string(json, "name", info->name);
    iso_json_integer(json, "component", (uint64_t)info->component);
    isorender_report_channel(json, loader);
    iso_json_ints(json, "dims", info->dims, 3);
    iso_json_reals(json, "spacing", info->transform.spacing, 3);
    iso_json_reals(json, "origin", info->transform.origin, 3);
    iso_json_reals(json, "direction", info->transform.direction, 9);
    if (job->input_surface_count + number < job->surface_count) {
        const isorender_surface *surface = &job->surfaces[job->input_surface_count + number];
        const iso_box *box = &surface->bounds;
        const double bounds[6] = {box->lo.x, box->hi.x, box->lo.y, box->hi.y, box->lo.z, box->hi.z};
        char color[8];
        snprintf(color, sizeof color, "%02X%02X%02X", surface->color.r, surface->color.g, surface->color.b);
        iso_json_real(json, "isovalue", surface->scene.isovalue);
        iso_json_string(json, "color", color);
        iso_json_real(json, "opacity", (double)surface->translucency.opacity);
        iso_json_reals(json, "bounds_world", bounds, 6);
    }
    iso_json_end_object(json);
}

void isorender_report_volumes(iso_json *json, const isorender_job *job) {
    if (!job->volume_count) return;
    iso_json_begin_array(json, "volumes");
    for (int i = 0; i < job->volume_count; i++) put_volume(json, job, &job->volumes[i], i);
    iso_json_end_array(json);
}
