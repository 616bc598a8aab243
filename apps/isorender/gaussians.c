/* gaussians: a file of 3-D Gaussians as the input: checks options, draws the Gaussians, reports them. */
#include "render/gaussians/gaussians.h"

#include <math.h>
#include <stdlib.h>

#include "apps/isorender/labels.h"
#include "base/numbers.h"
#include "io/glyphs/glyphs_read.h"

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
    job->gaussians = chosen && job->loader.has_points && iso_glyphs_are_gaussians(job->loader.path);
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

/* The callback iso_picture_layers.draw_opaque: everything but the Gaussians, which are surface 0. */
static iso_status draw_opaque(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const isorender_gaussians_picture *p = context;
    isorender_scene_arrays arrays;
    const iso_scene scene = isorender_scene(p->job, &arrays);
    return iso_scene_draw_from(&scene, 1, view, gbuffer, p->job->pool, error);
}

/* The callback iso_picture_layers.shade. */
static iso_status shade(void *context, const iso_strip *strip, iso_image *image, iso_aov *aov,
                        size_t *covered, iso_error *error) {
    (void)aov;
    const isorender_gaussians_picture *p = context;
    const isorender_job *job = p->job;
    const iso_glyphs *glyphs = &job->loader.points;
    const iso_gaussians gaussians = {.origin = glyphs->origin,
                                     .positions = (const float(*)[3])glyphs->positions,
                                     .axes = (const float(*)[9])glyphs->axes,
                                     .opacities = opacity_of(glyphs)->values,
                                     .colors = (const uint8_t(*)[3])glyphs->colors,
                                     .color = job->surfaces[0].color,
                                     .count = glyphs->count};
    const iso_layer_picture picture = {
        .strip = strip, .shading = p->shading, .image = image, .pool = job->pool};
    iso_layer_totals *totals = &p->frame->layers.layers;
    const size_t before = totals->covered;
    ISO_TRY(iso_shade_gaussians(&gaussians, &picture, totals, error));
    *covered = totals->covered - before;
    return ISO_OK;
}

iso_picture_layers isorender_gaussians_callbacks(isorender_gaussians_picture *picture) {
    const isorender_job *job = picture->job;
    const bool beside = job->surface_count > 1 || job->object_count;
    return (iso_picture_layers){beside ? draw_opaque : NULL, shade, picture};
}

/* ---- sizes and reports ---- */

double isorender_gaussians_size(const iso_glyphs *glyphs) {
    enum { SAMPLES = 4096 };
    const size_t step = glyphs->count / SAMPLES + 1;
    double sizes[SAMPLES];
    size_t count = 0;
    for (size_t i = 0; i < glyphs->count && count < SAMPLES; i += step) {
        double square = 0;
        for (int k = 0; k < 9; k++) square += (double)glyphs->axes[i][k] * (double)glyphs->axes[i][k];
        sizes[count++] = sqrt(square / 3);
    }
    qsort(sizes, count, sizeof *sizes, iso_compare_doubles);
    return count && sizes[count / 2] > 0 ? sizes[count / 2] : 1;
}

void isorender_gaussians_info(const isorender_job *job) {
    const iso_glyphs *glyphs = &job->loader.points;
    double range[2];
    printf("  %-11s as 3-D Gaussians (--method gaussians); discs, splats and points draw discs\n", "drawn");
    printf("  %-11s %.4g%s, the median of the standard deviations\n", "size",
           isorender_gaussians_size(glyphs), iso_world_unit_suffix(isorender_unit(job)));
    if (isorender_attribute_range(opacity_of(glyphs), glyphs->count, range))
        printf("  %-11s %.4g .. %.4g\n", "opacity", range[0], range[1]);
}
