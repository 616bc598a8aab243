/* setup: the low-pass filters and weights of pull-push, and its transforms as floats. */
#include "render/pullpush/setup.h"

#include <math.h>
#include <string.h>

/* The low-pass filter: added to the squared axes of ellipses, pixels^2. The ellipses of a surface need less,
 * because gaps between them are filled. */
static const float LOW_PASS = 2, SURFACE_LOW_PASS = 0.5f;
/* The same towards the silhouette, for discs seen face-on and edge-on. */
static const float FACING = 1, EDGE = 0.04f, SURFACE_FACING = 0.25f, SURFACE_EDGE = 0;
/* exp(-2 q) for q in 0 .. 1, within 0.0025; the same less its value at the ellipse's edge, q = 1, where it
 * falls to nothing ("finite support", section 3.3), scaled to 1 at the centre. */
static const float GAUSSIAN[4] = {1, -1.9457733f, 1.6291067f, -0.5504321f},
                   FINITE_GAUSSIAN[4] = {1, -2.2440141f, 1.8788016f, -0.6347875f};
static const float BOX[4] = {1, 0, 0, 0};

iso_pyramid_layout iso_pullpush_layout(const iso_view *view, const float radius[2]) {
    int base, top;
    iso_pyramid_levels(radius, LOW_PASS, &base, &top);
    return iso_pyramid_layout_of(view, base, top);
}

iso_point_projection iso_pullpush_projection(const iso_pyramid_layout *layout, const iso_projector *projector,
                                             const iso_transform *transform, bool packed, bool cull) {
    const iso_view *view = projector->view;
    const double pixel = 1.0 / (1 << layout->base), step = packed ? ISO_POINT_STEP : 1;
    iso_point_projection p = {.cull = cull,
                              .orthographic = view->orthographic,
                              .near = view->near < -ISO_NOWHERE ? -ISO_NOWHERE : (float)view->near,
                              .low = packed ? ISO_POINT_LOW : 0,
                              .per_voxel = 1 / step,
                              .rows_before = layout->rows_before >> layout->base};
    for (int row = 0; row < 3; row++) {
        double scale = row < 2 ? view->focal * pixel : 1;
        p.origin[row] = projector->origin[row] * scale;
        for (int k = 0; k < 3; k++) {
            p.matrix[3 * row + k] = projector->matrix[3 * row + k] * scale;
            p.step[3 * row + k] = (float)(p.matrix[3 * row + k] * step);
        }
    }
    iso_projector_eye(projector, transform, p.eye);
    /* rows are counted from the guard band of the whole picture, so that strips round like the whole */
    p.column = (float)((view->cx - layout->column) * pixel);
    p.row = (float)((view->cy - layout->row + layout->rows_before) * pixel);
    return p;
}

iso_pullpush_params iso_pullpush_params_make(const iso_pyramid_layout *layout, const iso_projector *projector,
                                             double radius, const int32_t dims[3],
                                             iso_reconstruction reconstruction, bool two_sided) {
    const iso_view *view = projector->view;
    iso_pullpush_params params = {
        .radius = radius > 0 ? ISO_DISC_RADII * (float)radius : 0,
        .scale = (float)view->focal,
        .orthographic = view->orthographic,
        .kind = two_sided ? ISO_PULLPUSH_TWO_SIDED : ISO_PULLPUSH_ONE_SIDED,
        .ray = {(float)(view->cx - layout->column), (float)(view->cy - layout->row + layout->rows_before)},
        .slope = view->orthographic ? 0 : (float)(1 / view->focal),
        .low_pass = SURFACE_LOW_PASS,
        .facing = SURFACE_FACING,
        .edge = SURFACE_EDGE,
        .has_border = dims[0] > 0 && dims[1] > 0 && dims[2] > 0};
    for (int k = 0; k < 3; k++) {
        double sum = 0, square = 0;
        for (int row = 0; row < 3; row++) {
            const double n = (double)projector->normal[3 * row + k];
            sum += n * projector->origin[row];
            square += n * n;
        }
        params.voxels_per_pixel[k] = (float)(sqrt(square) / view->focal);
        params.border[k] = (float)(dims[k] - 1);
        params.eye[k] = (float)-sum;
    }
    memcpy(params.normal, projector->normal, sizeof params.normal);
    memcpy(params.weight, reconstruction == ISO_RECONSTRUCTION_BOX ? BOX : FINITE_GAUSSIAN,
           sizeof params.weight);
    return params;
}

iso_pullpush_params iso_pullpush_params_of_intervals(const iso_pyramid_layout *layout,
                                                     const iso_projector *projector,
                                                     iso_reconstruction reconstruction,
                                                     iso_pullpush_kind kind) {
    static const int32_t none[3] = {0, 0, 0};
    iso_pullpush_params params = iso_pullpush_params_make(layout, projector, 0, none, reconstruction, true);
    params.kind = kind;
    if (reconstruction != ISO_RECONSTRUCTION_BOX) memcpy(params.weight, GAUSSIAN, sizeof params.weight);
    params.low_pass = LOW_PASS;
    params.facing = FACING;
    params.edge = EDGE;
    return params;
}
