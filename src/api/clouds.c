/* The functions of isopoint_clouds.h: points of arrays or of files as surfaces without a volume. */
#include <math.h>
#include <string.h>

#include "api/internal.h"
#include "base/memory.h"
#include "io/glyphs/glyphs_read.h"

/* ---- copies of arrays */

static uint8_t opacity_byte(float opacity) {
    return (uint8_t)(opacity > 0 ? opacity < 1 ? 255 * opacity + 0.5f : 255 : 0);
}

/* Copies opacities: as bytes for discs, as floats for Gaussians. */
static iso_status copy_opacities(const iso_cloud_arrays *from, iso_api_cloud *to, iso_error *error) {
    if (from->axes) {
        ISO_TRY(iso_api_copy(from->opacities, from->count, sizeof *to->opacities, &to->opacities, error));
        if (!to->opacities) to->opacities = iso_alloc(from->count * sizeof *to->opacities);
        if (!to->opacities)
            return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu points", from->count);
        for (size_t i = 0; i < from->count && !from->opacities; i++) to->opacities[i] = 1;
        for (size_t i = 0; i < from->count; i++)
            if (!(to->opacities[i] >= 0 && to->opacities[i] <= 1))
                return iso_fail(error, ISO_ERR_USAGE, "the opacity %g of Gaussian %zu is not between 0 and 1",
                                (double)to->opacities[i], i);
        return ISO_OK;
    }
    if (!from->opacities) return ISO_OK;
    to->points.opacities = iso_alloc(from->count);
    if (!to->points.opacities)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu points", from->count);
    for (size_t i = 0; i < from->count; i++) to->points.opacities[i] = opacity_byte(from->opacities[i]);
    return ISO_OK;
}

static iso_status copy_cloud(const iso_cloud_arrays *from, iso_api_cloud *to, iso_error *error) {
    iso_glyphs *points = &to->points;
    if (!from->count || !from->positions) return iso_fail(error, ISO_ERR_EMPTY, "there are no points");
    for (size_t i = 0; i < 3 * from->count; i++)
        if (!isfinite(from->positions[i]))
            return iso_fail(error, ISO_ERR_USAGE, "a coordinate of point %zu is not finite", i / 3);
    points->count = from->count;
    points->origin = iso_vec3_make(from->origin[0], from->origin[1], from->origin[2]);
    if (!iso_vec3_is_finite(points->origin))
        return iso_fail(error, ISO_ERR_USAGE, "the origin is not finite");
    points->gaussians = from->axes != NULL;
    ISO_TRY(
        iso_api_copy(from->positions, points->count, sizeof *points->positions, &points->positions, error));
    ISO_TRY(iso_api_copy(from->radii, points->count, sizeof *points->radii, &points->radii, error));
    ISO_TRY(
        iso_api_copy(from->normals, points->count, sizeof *points->directions, &points->directions, error));
    ISO_TRY(iso_api_copy(from->axes, points->count, sizeof *points->axes, &points->axes, error));
    ISO_TRY(iso_api_copy(from->colors, points->count, sizeof *points->colors, &points->colors, error));
    return copy_opacities(from, to, error);
}

/* ---- files */

/* Takes the opacities of a file's Gaussians. */
static iso_status take_opacities(const char *path, iso_api_cloud *cloud, iso_error *error) {
    const iso_glyphs *points = &cloud->points;
    for (int i = 0; i < points->attribute_count; i++)
        if (strcmp(points->attributes[i].name, "opacity") == 0 && points->attributes[i].components == 1)
            return iso_api_copy(points->attributes[i].values, points->count, sizeof *cloud->opacities,
                                &cloud->opacities, error);
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its Gaussians are not one number for each property", path);
}

static iso_status read_cloud(const char *path, const iso_surface_cloud_opts *opts, iso_surface *surface,
                             iso_error *error) {
    const iso_read_opts reading = {.normals_from_faces = true, .pool = surface->pool};
    iso_api_cloud *cloud = surface->cloud;
    ISO_TRY(iso_api_check_path(path, error));
    ISO_TRY(iso_glyphs_read(path, &reading, &cloud->points, error));
    if (!cloud->points.count) return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no usable point", path);
    if (opts->gaussians_as_discs) cloud->points.gaussians = false;
    return cloud->points.gaussians ? take_opacities(path, cloud, error) : ISO_OK;
}

/* ---- surfaces */

static iso_status check_opts(const iso_surface_cloud_opts *opts, iso_error *error) {
    if (!(opts->radius >= 0) || !isfinite(opts->radius))
        return iso_fail(error, ISO_ERR_USAGE, "a radius of %g mm", opts->radius);
    if (!(opts->opacity >= 0 && opts->opacity <= 1))
        return iso_fail(error, ISO_ERR_USAGE, "opacity %g is not between 0 and 1", opts->opacity);
    return ISO_OK;
}

/* Makes discs of the points. Those of Gaussians only say where they are. */
static iso_status make_discs(const iso_surface_cloud_opts *opts, iso_surface *surface, iso_error *error) {
    iso_api_cloud *cloud = surface->cloud;
    const iso_glyphs *points = &cloud->points;
    const iso_cloud_opts how = {.radius = opts->radius,
                                .estimate_radii = opts->estimate_radii,
                                .estimate_normals = opts->estimate_normals,
                                .pool = surface->pool};
    ISO_TRY(iso_scene_cloud_make(&cloud->made, points, points->gaussians, &how, error));
    ISO_TRY(iso_point_workspace_create(&surface->scene.own_workspace, error));
    cloud->view = iso_cloud_view(&cloud->made.discs);
    iso_api_cloud_hide_colors(cloud, surface->has_color);
    if (!points->gaussians) iso_glyphs_free(&cloud->points);
    return ISO_OK;
}

static iso_status begin(const iso_surface_cloud_opts *opts, iso_surface **surface, iso_error *error) {
    ISO_TRY(check_opts(opts, error));
    iso_surface *made = iso_alloc_zero(1, sizeof *made);
    if (made) made->cloud = iso_alloc_zero(1, sizeof *made->cloud);
    if (!made || !made->cloud) {
        iso_free(made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a surface");
    }
    made->scene.given = &made->cloud->view;
    made->opacity = opts->opacity > 0 ? opts->opacity : 1;
    made->has_color = opts->color != NULL;
    if (opts->color) made->color = *opts->color;
    const iso_status status = iso_api_pool(opts->threads, &made->pool, error);
    made->scene.pool = made->pool;
    if (status != ISO_OK)
        iso_surface_destroy(made);
    else
        *surface = made;
    return status;
}

/* Finishes a surface whose points are there. If this fails, or if `status` is a failure already, frees it. */
static iso_status finish(iso_status status, iso_surface *made, const iso_surface_cloud_opts *opts,
                         iso_surface **surface, iso_error *error) {
    if (status == ISO_OK) status = make_discs(opts, made, error);
    if (status == ISO_OK)
        *surface = made;
    else
        iso_surface_destroy(made);
    return status;
}

static const iso_surface_cloud_opts defaults;

iso_status iso_surface_of_cloud(const iso_cloud_arrays *cloud, const iso_surface_cloud_opts *opts,
                                iso_surface **surface, iso_error *error) {
    iso_surface *made = NULL;
    if (!opts) opts = &defaults;
    ISO_TRY(begin(opts, &made, error));
    return finish(copy_cloud(cloud, made->cloud, error), made, opts, surface, error);
}

iso_status iso_surface_read_cloud(const char *path, const iso_surface_cloud_opts *opts, iso_surface **surface,
                                  iso_error *error) {
    iso_surface *made = NULL;
    if (!opts) opts = &defaults;
    ISO_TRY(begin(opts, &made, error));
    return finish(read_cloud(path, opts, made, error), made, opts, surface, error);
}

void iso_api_cloud_hide_colors(iso_api_cloud *cloud, bool hidden) {
    cloud->view.colors = hidden ? NULL : iso_cloud_view(&cloud->made.discs).colors;
}

void iso_api_cloud_destroy(iso_api_cloud *cloud) {
    if (!cloud) return;
    iso_glyphs_free(&cloud->points);
    iso_cloud_free(&cloud->made.discs);
    iso_free(cloud->opacities);
    iso_free(cloud);
}

iso_gaussians iso_api_cloud_gaussians(const iso_api_cloud *cloud, iso_rgb color) {
    const iso_glyphs *points = &cloud->points;
    return (iso_gaussians){.origin = points->origin,
                           .positions = (const float(*)[3])points->positions,
                           .axes = (const float(*)[9])points->axes,
                           .opacities = cloud->opacities,
                           .colors = cloud->view.colors ? (const uint8_t(*)[3])points->colors : NULL,
                           .color = color,
                           .count = points->count};
}
