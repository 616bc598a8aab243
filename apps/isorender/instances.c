/* Instances (--instances): checks options, reads where the model is drawn, and reports what was drawn. */
#include "apps/isorender/isorender.h"
#include "base/placement.h"
#include "base/text.h"
#include "io/glyphs/placements_read.h"

/* What cannot be drawn as instances; NULL: everything that is asked for can be. */
static const char *find_obstacle(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    const char *opacity = isorender_object_opacity_option(settings);
    return settings->no_input                   ? "a picture without an input"
           : job->gaussians                     ? "a file of 3-D Gaussians"
           : settings->ior > 0                  ? "--ior"
           : isorender_is_translucent(settings) ? "an opacity below 1"
           : opacity                            ? opacity
                                                : NULL;
}

iso_status isorender_instances_check(const isorender_job *job, iso_error *error) {
    if (!job->settings->instances) return ISO_OK;
    const char *obstacle = find_obstacle(job);
    if (obstacle)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--instances draws opaque surfaces of the input: it cannot be combined with %s",
                        obstacle);
    return iso_renderer_require(job->renderer, ISO_CAN_INSTANCES, "--method", "--instances", error);
}

iso_status isorender_instances_read(isorender_job *job, uint64_t max_memory, iso_error *error) {
    const char *path = job->settings->instances;
    if (!path) return ISO_OK;
    const iso_read_opts opts = {
        .max_memory = max_memory, .files = job->plan->files, .report = &job->instances.report};
    ISO_TRY(iso_placements_read_file(path, &opts, &job->instances.placements, error));
    isorender_log_report(job, path, &job->instances.report);
    return iso_file_set_check(job->plan->files, error);
}

bool isorender_has_instances(const isorender_job *job, int surface) {
    return job->instances.placements.count && surface < job->input_surface_count;
}

iso_status isorender_instances_begin(isorender_job *job, iso_error *error) {
    isorender_instances *instances = &job->instances;
    if (!instances->placements.count) return ISO_OK;
    return iso_placed_begin(&instances->placed, &instances->placements, error);
}

void isorender_instances_free(isorender_job *job) {
    iso_placements_free(&job->instances.placements);
    iso_placed_free(&job->instances.placed);
}

/* ---- reports */

static bool is_turned(const iso_placements *placements) {
    for (size_t i = 0; i < placements->count; i++)
        if (iso_placement_is_turned(&placements->items[i])) return true;
    return false;
}

/* The least and greatest scale. */
static void find_scales(const iso_placements *placements, double range[2]) {
    range[0] = range[1] = placements->items[0].scale;
    for (size_t i = 1; i < placements->count; i++) {
        range[0] = iso_min(range[0], placements->items[i].scale);
        range[1] = iso_max(range[1], placements->items[i].scale);
    }
}

/* The box of the positions. */
static iso_box find_positions(const iso_placements *placements) {
    iso_box box = iso_box_empty();
    for (size_t i = 0; i < placements->count; i++) iso_box_add(&box, placements->items[i].position);
    return box;
}

void isorender_instances_info(const isorender_job *job) {
    const iso_placements *placements = &job->instances.placements;
    if (!placements->count) return;
    const iso_box box = find_positions(placements);
    double scales[2];
    find_scales(placements, scales);
    iso_text_put(stdout, job->settings->instances);
    printf("\n  %-11s %s\n  %-11s %zu, %s, %s\n", "format", job->instances.report.format, "instances",
           placements->count, is_turned(placements) ? "with rotations" : "not rotated",
           placements->colors ? "with colours" : "without colours");
    printf("  %-11s %.6g .. %.6g\n", "scale", scales[0], scales[1]);
    printf("  %-11s %.10g %.10g %.10g .. %.10g %.10g %.10g\n", "positions", box.lo.x, box.lo.y, box.lo.z,
           box.hi.x, box.hi.y, box.hi.z);
}

void isorender_instances_report(iso_json *json, const isorender_job *job) {
    const iso_placements *placements = &job->instances.placements;
    if (!placements->count) return;
    double scales[2];
    find_scales(placements, scales);
    iso_json_begin_object(json, "instances");
    iso_json_string(json, "path", job->settings->instances);
    iso_json_string(json, "format", job->instances.report.format);
    iso_json_integer(json, "count", placements->count);
    iso_json_bool(json, "rotated", is_turned(placements));
    iso_json_bool(json, "colored", placements->colors != NULL);
    iso_json_reals(json, "scale", scales, 2);
    iso_json_integer(json, "dropped", job->instances.report.dropped);
    iso_json_end_object(json);
}

void isorender_instances_put(iso_json *json, const iso_instance_counts *counts) {
    if (!(counts->drawn + counts->outside + counts->hidden)) return;
    iso_json_begin_object(json, "instances");
    iso_json_integer(json, "drawn", counts->drawn);
    iso_json_integer(json, "outside", counts->outside);
    iso_json_integer(json, "hidden", counts->hidden);
    iso_json_integer(json, "points", counts->points);
    iso_json_end_object(json);
}
