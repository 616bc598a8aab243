/* gaussians: a file of 3-D Gaussians as the input: checks options, reports them. */
#include "apps/isorender/picture_record.h"

/* ---- whether they are drawn ---- */

/* An option that Gaussians do not have; NULL: none is given. */
static const char *unfit_option(const isorender_settings *settings) {
    return settings->aov                                  ? "--aov"
           : isorender_light_option(settings)             ? isorender_light_option(settings)
           : settings->radius > 0 || settings->radius < 0 ? "--radius"
           : settings->normals != ISORENDER_NORMALS_FILE  ? "--normals"
                                                          : NULL;
}

iso_status isorender_gaussians_choose(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const bool chosen = settings->gaussians || (settings->method == ISORENDER_METHOD_UNCHOSEN &&
                                                !isorender_is_translucent(settings));
    job->gaussians = chosen && job->loader.has_gaussians;
    if (settings->gaussians && !job->gaussians)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "--method gaussians draws files of 3-D Gaussians only: .ply with f_dc_0 .. 2, scale_0 .. "
            "2, rot_0 .. 3 and opacity");
    const char *option = job->gaussians ? unfit_option(settings) : NULL;
    if (!option) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    "holds 3-D Gaussians: %s is for opaque discs, which --method discs draws", option);
}

/* ---- pictures ---- */

static const iso_attribute *opacity_of(const iso_glyphs *glyphs) {
    return isorender_attribute_find(glyphs->attributes, glyphs->attribute_count, "opacity");
}

iso_gaussians isorender_gaussians_of(const isorender_job *job) {
    const iso_glyphs *glyphs = &job->loader.points;
    return (iso_gaussians){.origin = glyphs->origin,
                           .positions = (const float(*)[3])glyphs->positions,
                           .axes = (const float(*)[9])glyphs->axes,
                           .opacities = opacity_of(glyphs)->values,
                           .colors = (const uint8_t(*)[3])glyphs->colors,
                           .color = job->surfaces[0].color,
                           .count = glyphs->count,
                           .clip = job->surfaces[0].scene.clip};
}

/* ---- reports ---- */

void isorender_gaussians_info(const isorender_job *job) {
    const iso_glyphs *glyphs = &job->loader.points;
    double range[2];
    printf("  %-11s as 3-D Gaussians (--method gaussians); discs, splats and points draw discs\n", "drawn");
    printf("  %-11s %.4g%s, the median of the standard deviations\n", "size",
           iso_gaussians_size((const float(*)[9])glyphs->axes, glyphs->count),
           iso_world_unit_suffix(isorender_unit(job)));
    if (isorender_attribute_range(opacity_of(glyphs), glyphs->count, range))
        printf("  %-11s %.4g .. %.4g\n", "opacity", range[0], range[1]);
}
