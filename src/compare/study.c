/* study: standard views, the choice of a pixel to magnify, and pictures of them by any method. */
#include "compare/study.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "render/picture.h"

/* Direction of the eye in radians, to the right of the front and upwards; full view angle in degrees. */
static const double SIDEWAYS = 0.6, UPWARDS = 0.35, VIEW_ANGLE = 30;

/* ---- views ---- */

static iso_vec3 vertex_of(const iso_mesh_view *mesh, const iso_mesh_span *span, uint32_t i,
                          const iso_affine *affine) {
    const float *p = mesh->vertices[span->first_vertex + i].position;
    return iso_affine_point(affine, iso_vec3_make(span->brick[0] * (double)ISO_BRICK + p[0],
                                                  span->brick[1] * (double)ISO_BRICK + p[1],
                                                  span->brick[2] * (double)ISO_BRICK + p[2]));
}

iso_status iso_study_bound(const iso_mesh_view *mesh, iso_study_ball *ball, iso_error *error) {
    iso_affine affine = iso_transform_affine(&mesh->transform);
    iso_box box = iso_box_empty();
    for (size_t s = 0; s < mesh->span_count; s++)
        for (uint32_t i = 0; i < mesh->spans[s].owned_count; i++)
            iso_box_add(&box, vertex_of(mesh, &mesh->spans[s], i, &affine));
    if (iso_box_is_empty(&box)) return iso_fail(error, ISO_ERR_EMPTY, "the surface is empty");
    ball->center = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    ball->radius = 0;
    for (size_t s = 0; s < mesh->span_count; s++)
        for (uint32_t i = 0; i < mesh->spans[s].owned_count; i++) {
            iso_vec3 vertex = vertex_of(mesh, &mesh->spans[s], i, &affine);
            double distance = iso_vec3_length(iso_vec3_sub(vertex, ball->center));
            if (distance > ball->radius) ball->radius = distance;
        }
    return ISO_OK;
}

iso_view iso_study_fit_from(const iso_study_ball *ball, int side, iso_vec3 outward) {
    double half = VIEW_ANGLE / 2 * (ISO_PI / 180), sine, cosine;
    iso_sincos(half, &sine, &cosine);
    double distance = (ball->radius > 0 ? ball->radius : 1) / sine;
    iso_view view = {.eye = iso_vec3_add(ball->center, iso_vec3_scale(outward, distance)),
                     .focal = side / 2.0 * (cosine / sine),
                     .cx = side / 2.0,
                     .cy = side / 2.0,
                     .width = side,
                     .height = side,
                     .near = 1e-4 * distance};
    iso_vec3 forward = iso_vec3_scale(outward, -1);
    iso_vec3 up = fabs(outward.z) < 0.999 ? iso_vec3_make(0, 0, 1) : iso_vec3_make(0, 1, 0);
    iso_vec3 right = iso_vec3_unit(iso_vec3_cross(forward, up));
    iso_vec3_store(right, view.rotation);
    iso_vec3_store(iso_vec3_cross(forward, right), view.rotation + 3);
    iso_vec3_store(forward, view.rotation + 6);
    return view;
}

iso_view iso_study_fit(const iso_study_ball *ball, int side, double azimuth) {
    double along, across, up, flat;
    iso_sincos(SIDEWAYS + azimuth * (ISO_PI / 180), &along, &across);
    iso_sincos(UPWARDS, &up, &flat);
    return iso_study_fit_from(ball, side, iso_vec3_make(along * flat, -across * flat, up));
}

iso_view iso_study_zoom(const iso_view *fit, const int aim[2], double zoom) {
    iso_view view = *fit;
    view.focal *= zoom;
    view.cx = fit->width / 2.0 - (aim[0] - (fit->width / 2.0 - 0.5)) * zoom;
    view.cy = fit->height / 2.0 - (aim[1] - (fit->height / 2.0 - 0.5)) * zoom;
    return view;
}

/* ---- the pixel to magnify ---- */

/* Returns the covered fraction of the square of 2 * half pixels around (x, y). sums: a summed-area table of
 * the mask with an additional first row and column of zeros. */
static double covered_part(const uint32_t *sums, int side, int x, int y, int half) {
    size_t row = (size_t)side + 1;
    size_t top = (size_t)(y - half) * row, bottom = (size_t)(y + half) * row;
    uint32_t count = sums[bottom + (size_t)(x + half)] - sums[top + (size_t)(x + half)] -
                     sums[bottom + (size_t)(x - half)] + sums[top + (size_t)(x - half)];
    return count / (4.0 * half * half);
}

static bool shows_silhouettes(const uint32_t *sums, int side, int x, int y) {
    double wide = covered_part(sums, side, x, y, side / 8),
           narrow = covered_part(sums, side, x, y, side / 32);
    return wide >= 0.5 && wide <= 0.95 && narrow >= 0.5 && narrow <= 0.95;
}

iso_status iso_study_aim(const uint8_t *mask, int side, int aim[2], iso_error *error) {
    size_t row = (size_t)side + 1;
    uint32_t *sums = iso_alloc_zero(row * row, sizeof *sums);
    if (!sums) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for aiming");
    for (size_t y = 0; y < (size_t)side; y++)
        for (size_t x = 0; x < (size_t)side; x++)
            sums[(y + 1) * row + x + 1] = mask[y * (size_t)side + x] + sums[y * row + x + 1] +
                                          sums[(y + 1) * row + x] - sums[y * row + x];
    int nearest = INT32_MAX;
    aim[0] = aim[1] = side / 2;
    for (int y = side / 8; y < side - side / 8; y++)
        for (int x = side / 8; x < side - side / 8; x++) {
            int dx = x - side / 2, dy = y - side / 2, distance = dx * dx + dy * dy;
            if (distance >= nearest || !mask[(size_t)y * (size_t)side + (size_t)x]) continue;
            if (!shows_silhouettes(sums, side, x, y)) continue;
            nearest = distance;
            aim[0] = x;
            aim[1] = y;
        }
    iso_free(sums);
    return ISO_OK;
}

/* ---- pictures ---- */

void iso_study_frame_free(iso_study_frame *frame) {
    iso_image_free(&frame->image);
    iso_aov_free(&frame->aov);
    *frame = (iso_study_frame){0};
}

iso_status iso_study_frame_create(int side, bool channels, iso_study_frame *frame, iso_error *error) {
    iso_study_frame made = {0};
    ISO_TRY(iso_image_create(side, side, &made.image, error));
    iso_status status = channels ? iso_aov_create(side, side, &made.aov, error) : ISO_OK;
    if (status == ISO_OK)
        *frame = made;
    else
        iso_study_frame_free(&made);
    return status;
}

typedef struct drawing {
    const iso_scene_surface *surface;
    const iso_renderer *method;
} drawing;

static iso_status draw_method(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const drawing *d = context;
    iso_target target = {view, gbuffer, d->surface->pool, 0, NULL};
    return iso_renderer_draw(d->method, d->surface, &target, error);
}

iso_status iso_study_draw(const iso_scene_surface *surface, const iso_renderer *method, const iso_view *view,
                          const iso_study_look *look, iso_study_frame *frame, iso_error *error) {
    assert(frame->image.width == view->width && frame->image.height == view->height);
    drawing d = {surface, method};
    iso_picture_opts opts = {.view = view,
                             .width = view->width,
                             .height = view->height,
                             .samples = look->samples,
                             .shading = {&look->color, 1, look->background, look->transparent, {0, 0, 0}},
                             .draw = draw_method,
                             .draw_context = &d,
                             .pool = surface->pool,
                             .aov = frame->aov.depth ? &frame->aov : NULL};
    return iso_picture_render(&opts, &frame->image, NULL, error);
}

iso_compare_picture iso_study_picture(const iso_study_frame *frame) {
    return (iso_compare_picture){.width = frame->image.width,
                                 .height = frame->image.height,
                                 .rgba = frame->image.rgba,
                                 .depth = frame->aov.depth,
                                 .normal = {frame->aov.normal[0], frame->aov.normal[1], frame->aov.normal[2]},
                                 .coverage = frame->aov.coverage};
}

/* ---- times ---- */

static int ascending(const void *left, const void *right) {
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

double iso_study_median(double *values, size_t count) {
    if (count == 0) return NAN;
    qsort(values, count, sizeof *values, ascending);
    return (values[(count - 1) / 2] + values[count / 2]) / 2;
}
