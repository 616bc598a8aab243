/* cloud: finds what pictures of points frame, and makes discs of them. */
#include "scene/cloud.h"

#include "clouds/frame.h"
#include "render/gaussians/gaussians.h"

iso_status iso_scene_cloud_make(iso_scene_cloud *cloud, const iso_glyphs *points, bool gaussians,
                                const iso_cloud_opts *opts, iso_error *error) {
    const iso_point_source source = iso_point_source_of_glyphs(points);
    iso_cloud_opts how = *opts;
    iso_point_survey survey;
    if (gaussians) {
        how.radius = iso_gaussians_size((const float(*)[9])points->axes, points->count);
        how.without_normals = true;
    }
    ISO_TRY(iso_point_source_survey(&source, opts->pool, &survey, error));
    ISO_TRY(iso_cloud_frame(&source, &survey, &cloud->frame, &cloud->outside, error));
    return iso_cloud_make(points, &how, &cloud->discs, error);
}

iso_status iso_scene_cloud_map(iso_scene_cloud *cloud, iso_loader *loader, double radius, bool *made,
                               iso_error *error) {
    iso_mapped_points points;
    *made = iso_loader_map_points(loader, &points);
    if (!*made) return ISO_OK;
    iso_status status =
        iso_cloud_frame(&points.source, &points.survey, &cloud->frame, &cloud->outside, error);
    if (status == ISO_OK)
        status = iso_cloud_make_of_source(&points.source, &points.survey, radius, loader->pool, &cloud->discs,
                                          error);
    iso_mapped_points_close(&points);
    return status;
}
