/* volumes: opens, reads and reports the further volumes of a picture (--volume). */
#include <math.h>
#include <string.h>

#include "apps/isorender/isorender.h"

iso_status isorender_volume_named(const isorender_job *job, int volume, iso_status status, iso_error *error) {
    if (volume < 0) return status;
    const char *path = job->volumes[volume].input;
    if (status == ISO_OK || strncmp(error->text, path, strlen(path)) == 0) return status;
    char text[sizeof error->text];
    snprintf(text, sizeof text, "%s", error->text);
    return iso_fail(error, status, "%s: %s", path, text);
}

static iso_status open_volume(iso_loader *loader, iso_error *error) {
    ISO_TRY(iso_loader_open(loader, error));
    if (!loader->has_points) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "holds points: --volume draws isosurfaces of volumes");
}

iso_status isorender_volumes_open(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    if (!isorender_plan_draws(job->plan) && !settings->info) return ISO_OK; /* exports are of the input */
    for (int i = 0; i < settings->volume_options.count; i++) {
        iso_loader *loader = &job->volumes[job->volume_count++];
        job->volume_inputs[i].max_memory = settings->common.input.max_memory;
        job->volume_inputs[i].grid = settings->volumes[i].grid;
        job->volume_inputs[i].component = settings->volumes[i].component;
        *loader = (iso_loader){.input = settings->volumes[i].path,
                               .options = &job->volume_inputs[i],
                               .files = job->plan->files,
                               .pool = job->pool,
                               .is_further = true,
                               .wants_histogram = settings->info || isnan(settings->volumes[i].isovalue)};
        ISO_TRY(isorender_volume_named(job, i, open_volume(loader, error), error));
    }
    return ISO_OK;
}

static void log_notes(const isorender_job *job, const iso_loader *loader) {
    const iso_volume_info *info = &loader->volume.info;
    for (int i = 0; i < info->note_count; i++)
        isorender_log(job, "note: %s: %s", loader->input, info->notes[i]);
    if (loader->nonfinite)
        isorender_log(job,
                      "note: %s: %zu voxels are NaN or infinite, as floats: no surface is made next to them",
                      loader->input, loader->nonfinite);
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
        iso_json_real(json, "isovalue", surface->isovalue);
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
