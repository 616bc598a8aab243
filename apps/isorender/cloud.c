/* cloud: a file of points as the input: checks options, makes points that can be drawn, reports them. */

#include "apps/isorender/picture_record.h"
#include "base/memory.h"
#include "base/temporary_file.h"
#include "scene/bounds.h"

iso_status isorender_cloud_check(const isorender_settings *settings, iso_error *error) {
    const iso_input *input = &settings->common.input;
    if (settings->method != ISORENDER_METHOD_UNCHOSEN) {
        const iso_renderer *renderer = iso_renderer_get((iso_method)settings->method);
        if (!(renderer->can & ISO_CAN_CLOUDS))
            return iso_fail(
                error, ISO_ERR_USAGE, "holds points, not a volume: --method %s needs a volume; %s draw them",
                renderer->name, iso_methods_that_can(ISO_CAN_CLOUDS, (char[ISO_METHODS_TEXT]){0}));
    }
    const char *option = settings->isovalue_count                             ? "--isovalue"
                         : settings->mesh                                     ? "--mesh"
                         : input->cropped                                     ? "--crop"
                         : settings->primitive                                ? "--primitive"
                         : input->largest                                     ? "--largest"
                         : input->min_size > 0                                ? "--min-size"
                         : settings->closed                                   ? "--closed"
                         : settings->refraction == (int)ISO_REFRACTION_TRACED ? "--refraction traced"
                         : input->grid                                        ? "--grid"
                         : input->series                                      ? "--series"
                         : isorender_wants_gradients(settings)                ? "--glyphs surface"
                                                               : isorender_object_opacity_option(settings);
    if (!option) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "holds points, not a volume: %s needs a volume", option);
}

/* ---- making points ---- */

/* Leaves out the points outside --crop-mm. */
static iso_status crop(isorender_job *job, iso_error *error) {
    const iso_input *input = &job->settings->common.input;
    iso_glyphs *points = &job->loader.points;
    if (!input->cropped_mm) return ISO_OK;
    const double *c = input->crop_mm;
    const iso_box box = {{c[0], c[2], c[4]}, {c[1], c[3], c[5]}};
    iso_glyphs_crop(points, &box);
    if (points->count) return ISO_OK;
    return iso_fail(error, ISO_ERR_EMPTY, "--crop-mm: no point lies in this box");
}

/* Colours the points by a column, if --color-by asks for it. */
static iso_status color(isorender_job *job, iso_error *error) {
    isorender_object *object = &job->cloud_colors;
    object->settings = &job->settings->cloud;
    object->color_by = job->settings->cloud.color_by;
    object->file.glyphs = job->loader.points;
    const iso_status status = isorender_object_style(object, error);
    job->loader.points = object->file.glyphs;
    object->file.glyphs = (iso_glyphs){.count = 0};
    return status;
}

/* Why the opacities of points are not drawn; NULL: they are. */
static const char *why_opaque(const isorender_job *job, iso_error *reason) {
    const isorender_settings *settings = job->settings;
    if (iso_renderer_require(job->renderer, ISO_CAN_CLOUDS | ISO_CAN_LAYERS, "--method", "them", reason) !=
        ISO_OK)
        return reason->text;
    if (settings->ior > 0) return "glass has one --opacity for all";
    if (isorender_light_option(settings))
        return "--shading edl, --occlusion, --shadow and --outline are of opaque surfaces";
    if (settings->cut_count) return "--clip cuts opaque points";
    return NULL;
}

/* Sets the points to draw: with the cloud's opacities, unless a method or an option leaves them out.
 * ISO_ERR_USAGE: an option is for translucent surfaces, and there are none. */
static iso_status choose_opacities(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const bool made_opaque = settings->opacity_count && settings->opacities[0] >= 1;
    const char *reason = NULL;
    iso_error denied = {ISO_OK, ""};
    job->read_points = iso_cloud_view(&job->cloud.discs);
    if (job->read_points.opacities && !made_opaque && isorender_plan_draws(job->plan))
        reason = why_opaque(job, &denied);
    if (reason) isorender_log(job, "note: its points have opacities, but %s", reason);
    if (settings->ior > 0 && job->read_points.colors && isorender_plan_draws(job->plan))
        isorender_log(job,
                      "note: its points have colours, but glass shows those of --attenuation-color only");
    if (reason || made_opaque) job->read_points.opacities = NULL;
    job->translucent |= job->read_points.opacities != NULL;
    return isorender_translucent_check(settings, job->translucent || isorender_is_translucent(settings),
                                       error);
}

/* Makes the cloud of points in memory. That of Gaussians only says where they are, unless it is written by
 * --points. */
static iso_status make_cloud(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const iso_cloud_opts opts = {.radius = settings->radius > 0 ? settings->radius : 0,
                                 .estimate_radii = settings->radius < 0,
                                 .estimate_normals = settings->normals == ISORENDER_NORMALS_AUTO,
                                 .pool = job->pool};
    return iso_scene_cloud_make(&job->cloud, &job->loader.points, job->gaussians && !settings->points, &opts,
                                error);
}

static iso_status read_cloud(isorender_job *job, iso_error *error) {
    if (job->settings->filter != ISO_FILTER_LINEAR)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--reconstruction-filter is of volumes: between points there is no field");
    ISO_TRY(iso_loader_read(&job->loader, error));
    isorender_log_report(job, "", &job->loader.report);
    if (!job->loader.points.count) return iso_fail(error, ISO_ERR_EMPTY, "holds no usable point");
    if (job->gaussians && !job->loader.points.gaussians)
        return iso_fail(error, ISO_ERR_FORMAT, "its Gaussians are not one number for each property");
    ISO_TRY(crop(job, error));
    ISO_TRY(color(job, error));
    ISO_TRY(make_cloud(job, error));
    if (!job->settings->info && !job->gaussians) iso_glyphs_free(&job->loader.points);
    return ISO_OK;
}

/* Whether the settings ask for nothing but the positions, normals and colours of a file, and one radius. */
static bool is_drawn_as_stored(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    return settings->radius > 0 && settings->normals != ISORENDER_NORMALS_AUTO && !settings->info &&
           !settings->cloud.color_by && !settings->common.input.cropped_mm && !job->gaussians;
}

iso_status isorender_cloud_read(isorender_job *job, iso_error *error) {
    const iso_cloud *cloud = &job->cloud.discs;
    bool made = false;
    if (is_drawn_as_stored(job))
        ISO_TRY(iso_scene_cloud_map(&job->cloud, &job->loader, job->settings->radius, &made, error));
    if (made)
        isorender_log_report(job, "", &job->loader.report);
    else
        ISO_TRY(read_cloud(job, error));
    if (iso_memory_in_files())
        isorender_log_verbose(job, "does not fit into memory: so far %.0f MB in temporary files in %s",
                              (double)iso_memory_in_files() / 1e6, iso_temporary_folder());
    const double percent = 100.0 / (double)cloud->count;
    if (cloud->estimated_normals)
        isorender_log_verbose(job, "normals of %.4g %% of the points are estimated from their neighbours",
                              percent * (double)cloud->estimated_normals);
    if (cloud->estimated_radii)
        isorender_log_verbose(job,
                              "radii of %.4g %% of the points are estimated; the median of all is %.4g%s",
                              percent * (double)cloud->estimated_radii, cloud->radius,
                              iso_world_unit_suffix(isorender_unit(job)));
    return choose_opacities(job, error);
}

/* ---- reports ---- */

/* Without a surface: the unit of all lines and glyphs. */
static iso_world_unit unit_of_objects(const isorender_job *job) {
    const iso_world_unit unit =
        job->object_count ? job->objects[0].file.report.unit : ISO_WORLD_UNIT_MILLIMETRE;
    for (int i = 1; i < job->object_count; i++)
        if (job->objects[i].file.report.unit != unit) return ISO_WORLD_UNIT_NONE;
    return unit;
}

iso_world_unit isorender_volume_unit(const iso_volume_info *info) {
    return info->angstrom   ? ISO_WORLD_UNIT_ANGSTROM
           : info->unitless ? ISO_WORLD_UNIT_NONE
                            : ISO_WORLD_UNIT_MILLIMETRE;
}

iso_world_unit isorender_unit(const isorender_job *job) {
    const iso_world_unit stated = job->loader.has_points ? job->loader.report.unit
                                  : job->has_volume      ? isorender_volume_unit(&job->loader.volume.info)
                                  : job->surface_count   ? ISO_WORLD_UNIT_MILLIMETRE
                                                         : unit_of_objects(job);
    /* --mm-per-pixel speaks of mm, unless --unit says what the file's lengths are in. */
    const bool millimetres = job->settings->mm_per_pixel > 0 && job->settings->unit == ISO_UNIT_AUTO;
    return stated == ISO_WORLD_UNIT_NONE && millimetres ? ISO_WORLD_UNIT_MILLIMETRE : stated;
}

static const char *origin_of(size_t estimated, size_t count) {
    return estimated == count ? "estimated" : estimated ? "of the file, some estimated" : "of the file";
}

void isorender_cloud_info(const isorender_job *job) {
    const iso_cloud *cloud = &job->cloud.discs;
    const iso_point_view view = iso_cloud_view(cloud);
    const iso_box box = iso_bounds_of_points(&view);
    const char *unit = iso_world_unit_suffix(isorender_unit(job));
    printf("  %-11s %s\n  %-11s %zu\n", "format", job->loader.report.format, "points", cloud->count);
    printf("  %-11s %.10g %.10g %.10g .. %.10g %.10g %.10g%s\n", "bounds", box.lo.x, box.lo.y, box.lo.z,
           box.hi.x, box.hi.y, box.hi.z, unit);
    double spacing;
    if (iso_cloud_spacing(&job->loader.points, job->pool, &spacing, NULL) == ISO_OK)
        printf("  %-11s %.4g%s between nearest neighbours (median)\n", "spacing", spacing, unit);
    if (job->gaussians) {
        isorender_gaussians_info(job);
    } else {
        printf("  %-11s %s\n", "normals", origin_of(cloud->estimated_normals, cloud->count));
        printf("  %-11s %s, median %.4g%s\n", "radii", origin_of(cloud->estimated_radii, cloud->count),
               cloud->radius, unit);
    }
    printf("  %-11s %s\n", "colours", cloud->colors ? "of the file" : "none");
    printf("  %-11s %s\n", "opacities", cloud->opacities ? "of the file" : "none: opaque");
    isorender_object columns = {.settings = &job->settings->cloud, .file.glyphs = job->loader.points};
    isorender_object_info_columns(&columns);
}

void isorender_cloud_report(iso_json *json, const isorender_job *job) {
    const iso_cloud *cloud = &job->cloud.discs;
    const iso_world_unit unit = isorender_unit(job);
    iso_json_string(json, "unit", unit == ISO_WORLD_UNIT_NONE ? NULL : iso_world_unit_suffix(unit) + 1);
    iso_json_integer(json, "estimated_normals", cloud->estimated_normals);
    iso_json_integer(json, "estimated_radii", cloud->estimated_radii);
    iso_json_real(json, "median_radius", cloud->radius);
    iso_json_integer(json, "dropped", job->loader.report.dropped);
    iso_json_integer(json, "temporary_file_bytes", iso_memory_in_files());
    if (job->cloud_colors.has_bar) {
        const double range[2] = {job->cloud_colors.bar.low, job->cloud_colors.bar.high};
        iso_json_reals(json, "range", range, 2);
    }
}
