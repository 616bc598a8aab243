/* transparency: renders a translucent surface by every way of compositing, and compares the pictures with the
 * truth.
 *
 * Average colour (Bavoil and Myers 2008) and weighted blending (McGuire and Bavoil 2013, eq. 10) use sums
 * over the crossings of a pixel. With a constant opacity these sums do not depend on the opacity, so they are
 * computed once for all opacities. */
#include "compare/transparency.h"

#include <math.h>

#include "base/clock.h"
#include "base/memory.h"
#include "render/groups/coverage.h"
#include "scene/layered_picture.h"
#include "truth/raycast_layers.h"

const double ISO_TRANSPARENCY_OPACITY[ISO_TRANSPARENCY_OPACITIES] = {0.3, 0.5, 0.7};

/* One way of compositing. Average and weighted need no method, because they use the crossings found for the
 * truth. */
typedef struct compositing_row {
    const char *name, *title;
    iso_method method;
    iso_transparency transparency;
} compositing_row;

static const compositing_row ROWS[ISO_COMPOSITINGS] = {
    {"exact", "layers of the trilinear surface, in order", ISO_METHOD_EXACT, 0},
    {"average", "average colour of the truth's crossings (2008)", ISO_METHOD_RAYCAST, 0},
    {"weighted", "weighted blending of the truth's crossings (2013)", ISO_METHOD_RAYCAST, 0},
    {"splats", "points: splats, sorted", ISO_METHOD_SPLATS, ISO_TRANSPARENCY_SORTED},
    {"splats-groups", "points: splats in groups, algorithm 2 (2006)", ISO_METHOD_SPLATS,
     ISO_TRANSPARENCY_GROUPS},
    {"splats-nearest", "points: splats, nearest layer first, algorithm 3 (2006)", ISO_METHOD_SPLATS,
     ISO_TRANSPARENCY_NEAREST},
};

const char *iso_compositing_name(iso_compositing compositing) {
    return ROWS[compositing].name;
}

const char *iso_compositing_title(iso_compositing compositing) {
    return ROWS[compositing].title;
}

/* Sums over the crossings of a pixel's ray. */
typedef struct pixel_sums {
    double color[3];                  /* sum of colours, 0 .. 1 each */
    double weighted_color[3], weight; /* the same sums, weighted by depth */
    int count;
} pixel_sums;

typedef struct work {
    const iso_scene_surface *surface;
    iso_scene_surface
        grouped; /* the surface with the groups of algorithms 2 and 3; borrows its other parts */
    const iso_view *view;
    const iso_study_look *look;
    double near, far; /* depths of the ball's front and back, mm */
    size_t count;     /* pixels */
    pixel_sums *sums;
    iso_image truth, candidate;
    float *truth_layers, *candidate_layers;
    double seconds[ISO_COMPOSITINGS][ISO_TRANSPARENCY_OPACITIES];
} work;

/* ---- the truth's crossings, composited without order ---- */

/* Returns the weight of eq. 10 without its factor, the opacity, which cancels when it is constant. */
static double depth_weight(const work *w, double depth) {
    /* 1 - d of a depth buffer with these near and far planes */
    const double left = w->near * (w->far - depth) / (depth * (w->far - w->near));
    const double shown = fmin(fmax(left, 0), 1);
    return fmax(1e-2, 3e3 * shown * shown * shown);
}

/* The callback iso_raycast_reader.read. */
static void add_crossing(void *context, int x, int y, const iso_raycast_crossing *crossing) {
    const work *w = context;
    pixel_sums *sums = &w->sums[(size_t)y * (size_t)w->view->width + (size_t)x];
    const double weight = depth_weight(w, crossing->depth);
    for (int k = 0; k < 3; k++) {
        sums->color[k] += (double)crossing->rgb[k];
        sums->weighted_color[k] += weight * (double)crossing->rgb[k];
    }
    sums->weight += weight;
    sums->count++;
}

static void gather_sums(work *w) {
    const iso_gbuffer size = {.width = w->view->width, .height = w->view->height};
    const iso_strip strip = {w->view, &size, 1, 0};
    const iso_raycast_layer layer = {w->surface->caster, w->look->color, {.constant = true}, NULL, NULL};
    const iso_raycast_layers picture = {
        .layers = &layer, .count = 1, .picture = {.strip = &strip, .pool = w->surface->pool}};
    const iso_raycast_reader reader = {add_crossing, w};
    iso_read_raycast_layers(&picture, &reader);
}

/* Composites a pixel by the mean colour of its crossings. */
static void blend_pixel(const work *w, const pixel_sums *sums, bool weighted, double opacity, uint8_t *rgba) {
    const iso_rgb b = w->look->background;
    const double background[3] = {b.r / 255.0, b.g / 255.0, b.b / 255.0};
    const double *color = weighted ? sums->weighted_color : sums->color;
    const double weight = weighted ? sums->weight : sums->count;
    double through = 1;
    for (int i = 0; i < sums->count; i++) through *= 1 - opacity;
    for (int k = 0; k < 3; k++) {
        const double mean = sums->count ? color[k] / weight : 0;
        rgba[k] = (uint8_t)(fmin(mean * (1 - through) + background[k] * through, 1) * 255 + 0.5);
    }
    rgba[3] = 255;
}

static void blend_picture(work *w, bool weighted, float opacity) {
    for (size_t i = 0; i < w->count; i++)
        blend_pixel(w, &w->sums[i], weighted, (double)opacity, w->candidate.rgba + 4 * i);
}

/* ---- pictures ---- */

/* Draws the layers with the method of a row. layers: receives the number of layers of each pixel. */
static iso_status draw_layers(const work *w, const compositing_row *row, float opacity, iso_image *image,
                              float *layers, iso_error *error) {
    const bool grouped = row->transparency != ISO_TRANSPARENCY_SORTED;
    const iso_layered_surface surface = {grouped ? &w->grouped : w->surface,
                                         {.opacity = opacity, .constant = true}};
    const iso_shading shading = {
        .colors = &w->look->color, .color_count = 1, .background = w->look->background};
    iso_layered_picture picture = {.method = row->method,
                                   .surfaces = &surface,
                                   .count = 1,
                                   .transparency = row->transparency,
                                   .shading = &shading,
                                   .pool = w->surface->pool};
    iso_picture_layers callbacks;
    ISO_TRY(iso_layered_picture_callbacks(&picture, &callbacks, error));
    const iso_gbuffer size = {.width = w->view->width, .height = w->view->height};
    const iso_strip strip = {w->view, &size, 1, 0};
    iso_aov aov = {.width = w->view->width, .height = w->view->height, .layers = layers};
    size_t covered;
    return callbacks.shade(callbacks.context, &strip, image, &aov, &covered, error);
}

/* seconds: receives the time of a picture of layers; NaN if the truth's crossings are blended. */
static iso_status draw_candidate(work *w, iso_compositing compositing, float opacity, double *seconds,
                                 iso_error *error) {
    const bool weighted = compositing == ISO_COMPOSITING_WEIGHTED;
    *seconds = NAN;
    if (weighted || compositing == ISO_COMPOSITING_AVERAGE) {
        blend_picture(w, weighted, opacity);
        return ISO_OK;
    }
    const double start = iso_clock_seconds();
    ISO_TRY(draw_layers(w, &ROWS[compositing], opacity, &w->candidate, w->candidate_layers, error));
    *seconds = iso_clock_seconds() - start;
    return ISO_OK;
}

static double compare_images(const work *w) {
    double squares = 0;
    for (size_t i = 0; i < 4 * w->count; i++) { /* alpha is 255 in both pictures */
        const double difference = w->truth.rgba[i] - w->candidate.rgba[i];
        squares += difference * difference;
    }
    return iso_psnr(squares, w->count);
}

static size_t count_wrong_layers(const work *w) {
    size_t wrong = 0;
    for (size_t i = 0; i < w->count; i++) wrong += w->truth_layers[i] != w->candidate_layers[i];
    return wrong;
}

/* ---- the study ---- */

static iso_status create_work(work *w, iso_error *error) {
    const int width = w->view->width, height = w->view->height;
    w->sums = iso_alloc_zero(w->count, sizeof *w->sums);
    w->truth_layers = iso_alloc_zero(w->count, sizeof *w->truth_layers);
    w->candidate_layers = iso_alloc_zero(w->count, sizeof *w->candidate_layers);
    if (!w->sums || !w->truth_layers || !w->candidate_layers)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a study of transparency");
    ISO_TRY(iso_image_create(width, height, &w->truth, error));
    ISO_TRY(iso_image_create(width, height, &w->candidate, error));
    const iso_point_view points = iso_scene_surface_points(w->surface);
    const iso_groups_opts grouping = iso_splat_layers_grouping(w->surface->pool);
    w->grouped = *w->surface;
    w->grouped.groups = (iso_groups){0};
    ISO_TRY(iso_groups_make(&points, &grouping, &w->grouped.groups, error));
    return iso_groups_cover(&points, grouping.disc, w->surface->pool, &w->grouped.groups, error);
}

static void free_work(work *w) {
    iso_free(w->sums);
    iso_free(w->truth_layers);
    iso_free(w->candidate_layers);
    iso_image_free(&w->truth);
    iso_image_free(&w->candidate);
    iso_groups_free(&w->grouped.groups);
}

static void count_crossings(const work *w, iso_transparency_study *study) {
    size_t crossings = 0;
    for (size_t i = 0; i < w->count; i++) {
        const int count = w->sums[i].count;
        crossings += (size_t)count;
        study->covered += count > 0;
        if (count > study->most_layers) study->most_layers = count;
    }
    study->mean_layers = study->covered ? (double)crossings / (double)study->covered : NAN;
}

static iso_status study_opacity(work *w, int opacity, iso_transparency_study *study, iso_error *error) {
    static const compositing_row truth = {.method = ISO_METHOD_RAYCAST};
    const float value = (float)ISO_TRANSPARENCY_OPACITY[opacity];
    ISO_TRY(draw_layers(w, &truth, value, &w->truth, w->truth_layers, error));
    for (int c = 0; c < ISO_COMPOSITINGS; c++) {
        ISO_TRY(draw_candidate(w, (iso_compositing)c, value, &w->seconds[c][opacity], error));
        study->psnr[c][opacity] = compare_images(w);
        if (c == ISO_COMPOSITING_EXACT) study->wrong_layers[opacity] = count_wrong_layers(w);
    }
    return ISO_OK;
}

static iso_status run_study(work *w, iso_transparency_study *study, iso_error *error) {
    ISO_TRY(create_work(w, error));
    gather_sums(w);
    count_crossings(w, study);
    for (int i = 0; i < ISO_TRANSPARENCY_OPACITIES; i++) ISO_TRY(study_opacity(w, i, study, error));
    for (int c = 0; c < ISO_COMPOSITINGS; c++)
        study->seconds[c] = iso_study_median(w->seconds[c], ISO_TRANSPARENCY_OPACITIES);
    return ISO_OK;
}

iso_status iso_study_transparency(const iso_scene_surface *surface, const iso_study_ball *ball,
                                  const iso_view *view, const iso_study_look *look,
                                  iso_transparency_study *study, iso_error *error) {
    const double depth = iso_view_point(view, ball->center).z;
    work w = {.surface = surface,
              .view = view,
              .look = look,
              .near = depth - ball->radius,
              .far = depth + ball->radius,
              .count = (size_t)view->width * (size_t)view->height};
    *study = (iso_transparency_study){0};
    const iso_status status = run_study(&w, study, error);
    free_work(&w);
    return status;
}
