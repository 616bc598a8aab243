#include "render/pullpush/setup.h"

#include <string.h>

/* Pixels^2 of the screen-space filter. */
static const float LOW_PASS = 2;
/* The same on the side where the surface ends, seen face-on and edge-on. */
static const float FACING = 1, EDGE = 0.04f;
/* exp(-2 q) for q in 0 .. 1, within 0.0025. */
static const float GAUSSIAN[4] = {1, -1.9457733f, 1.6291067f, -0.5504321f};
static const float BOX[4] = {1, 0, 0, 0};

iso_pyramid_shape iso_pullpush_shape(const iso_view *view, const float radius[2]) {
    int base, top;
    iso_pyramid_levels(radius, LOW_PASS, &base, &top);
    return iso_pyramid_shape_of(view, base, top);
}

iso_point_projection iso_pullpush_projection(const iso_pyramid_shape *shape, const iso_projector *projector,
                                             const iso_transform *transform, bool packed, bool cull) {
    const iso_view *view = projector->view;
    const double pixel = 1.0 / (1 << shape->base), step = packed ? ISO_POINT_STEP : 1;
    iso_point_projection p = {.cull = cull,
                              .orthographic = view->orthographic,
                              .near = view->near < -ISO_NOWHERE ? -ISO_NOWHERE : (float)view->near,
                              .low = packed ? ISO_POINT_LOW : 0,
                              .per_voxel = 1 / step,
                              .rows_before = shape->rows_before >> shape->base};
    for (int row = 0; row < 3; row++) {
        double scale = row < 2 ? view->focal * pixel : 1;
        p.origin[row] = projector->origin[row] * scale;
        for (int k = 0; k < 3; k++) {
            p.matrix[3 * row + k] = projector->matrix[3 * row + k] * scale;
            p.step[3 * row + k] = (float)(p.matrix[3 * row + k] * step);
        }
    }
    iso_projector_eye(projector, transform, p.eye);
    /* counted from the whole frame, so that strips round alike */
    p.column = (float)((view->cx - shape->column) * pixel);
    p.row = (float)((view->cy - shape->row + shape->rows_before) * pixel);
    return p;
}

iso_reconstruction_job iso_pullpush_job(const iso_pyramid_shape *shape, const iso_projector *projector,
                                        double radius, iso_reconstruction reconstruction, bool two_sided) {
    const iso_view *view = projector->view;
    iso_reconstruction_job job = {
        .radius = radius > 0 ? ISO_DISC_RADII * (float)radius : 0,
        .scale = (float)view->focal,
        .orthographic = view->orthographic,
        .two_sided = two_sided,
        .ray = {(float)(view->cx - shape->column), (float)(view->cy - shape->row + shape->rows_before)},
        .slope = view->orthographic ? 0 : (float)(1 / view->focal),
        .low_pass = LOW_PASS,
        .facing = FACING,
        .edge = EDGE};
    memcpy(job.normal, projector->normal, sizeof job.normal);
    memcpy(job.weight, reconstruction == ISO_RECONSTRUCTION_BOX ? BOX : GAUSSIAN, sizeof job.weight);
    return job;
}
