/* Intersects the rays of samples that hit nothing with the plane of a picture. */
#include "apps/isosculpt/viewport/backdrop.h"

#include <math.h>
#include <stdio.h>

#include "base/crc32c.h"

iso_status isosculpt_backdrop_read(isosculpt_backdrop *backdrop, const char *path, iso_error *error) {
    isosculpt_backdrop_free(backdrop);
    ISO_TRY(iso_image_read(path, &backdrop->image, error));
    const iso_image *image = &backdrop->image;
    backdrop->crc = iso_crc32c(0, image->rgba, 4 * (size_t)image->width * (size_t)image->height);
    snprintf(backdrop->path, sizeof backdrop->path, "%s", path);
    return ISO_OK;
}

void isosculpt_backdrop_free(isosculpt_backdrop *backdrop) {
    iso_image_free(&backdrop->image);
    backdrop->image.rgba = NULL;
    backdrop->path[0] = 0;
}

bool isosculpt_backdrop_is_shown(const isosculpt_backdrop *backdrop) {
    return backdrop && backdrop->image.rgba && backdrop->shown && backdrop->opacity > 0;
}

typedef struct blending {
    const isosculpt_backdrop *backdrop;
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    int factor;
    double background[3];
    iso_image *image;
    iso_vec3 forward, right, up; /* of the picture's plane; `right` and `up` in heights of the picture */
} blending;

/* The colour at a place of the picture, in pixels, between the centres of four of them. False: outside. */
static bool sample_picture(const iso_image *image, double x, double y, double rgba[4]) {
    if (!(x >= 0 && y >= 0 && x < image->width && y < image->height)) return false;
    const double px = fmin(fmax(x - 0.5, 0), image->width - 1),
                 py = fmin(fmax(y - 0.5, 0), image->height - 1);
    const int x0 = (int)px, y0 = (int)py, x1 = x0 + 1 < image->width ? x0 + 1 : x0,
              y1 = y0 + 1 < image->height ? y0 + 1 : y0;
    const double u = px - x0, v = py - y0;
    const int at[4][2] = {{x0, y0}, {x1, y0}, {x0, y1}, {x1, y1}};
    const double weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    for (int c = 0; c < 4; c++) rgba[c] = 0;
    for (int k = 0; k < 4; k++) {
        const uint8_t *pixel = image->rgba + 4 * ((size_t)at[k][1] * (size_t)image->width + (size_t)at[k][0]);
        const double alpha = weight[k] * pixel[3] / 255;
        for (int c = 0; c < 3; c++) rgba[c] += alpha * pixel[c];
        rgba[3] += alpha;
    }
    return rgba[3] > 0;
}

/* What a sample adds to the pixel's background, times 1 / samples. */
static void add_sample(const blending *b, int column, int row, double added[3]) {
    const iso_image *picture = &b->backdrop->image;
    iso_vec3 origin, direction;
    double rgba[4];
    iso_view_ray(b->view, column + 0.5, row + 0.5, &origin, &direction);
    const double slope = iso_vec3_dot(direction, b->forward),
                 t = iso_vec3_dot(iso_vec3_sub(b->backdrop->centre, origin), b->forward) / slope;
    if (!(fabs(slope) > 1e-6) || !(b->view->orthographic || t > 0)) return;
    const iso_vec3 from =
        iso_vec3_sub(iso_vec3_add(origin, iso_vec3_scale(direction, t)), b->backdrop->centre);
    const double x = picture->width * 0.5 + picture->height * iso_vec3_dot(from, b->right),
                 y = picture->height * (0.5 - iso_vec3_dot(from, b->up));
    if (!sample_picture(picture, x, y, rgba)) return;
    const double share = b->backdrop->opacity / (b->factor * b->factor);
    for (int c = 0; c < 3; c++) added[c] += share * (rgba[c] - rgba[3] * b->background[c]);
}

static void blend_row(void *context, size_t row, int worker) {
    const blending *b = context;
    (void)worker;
    for (int x = 0; x < b->image->width; x++) {
        double added[3] = {0, 0, 0};
        for (int k = 0; k < b->factor * b->factor; k++) {
            const int column = x * b->factor + k % b->factor, line = (int)row * b->factor + k / b->factor;
            const size_t at = (size_t)line * (size_t)b->view->width + (size_t)column;
            if (b->gbuffer->surface[at] == ISO_SURFACE_NONE) add_sample(b, column, line, added);
        }
        uint8_t *pixel = b->image->rgba + 4 * (row * (size_t)b->image->width + (size_t)x);
        for (int c = 0; c < 3; c++) pixel[c] = (uint8_t)fmin(fmax(pixel[c] + added[c] + 0.5, 0), 255);
    }
}

void isosculpt_backdrop_blend(const isosculpt_backdrop *backdrop, const iso_view *view,
                              const iso_gbuffer *gbuffer, int factor, iso_rgb background, iso_image *image,
                              iso_pool *pool) {
    if (!isosculpt_backdrop_is_shown(backdrop)) return;
    const iso_direction side = backdrop->axis == 'x'   ? ISO_RIGHT
                               : backdrop->axis == 'y' ? ISO_FRONT
                                                       : ISO_TOP;
    blending b = {.backdrop = backdrop,
                  .view = view,
                  .gbuffer = gbuffer,
                  .factor = factor,
                  .background = {background.r, background.g, background.b},
                  .image = image};
    iso_direction_vectors(side, iso_vec3_make(0, 0, 1), &b.forward, &b.up);
    b.right = iso_vec3_scale(iso_vec3_cross(b.forward, b.up), 1 / backdrop->height);
    b.up = iso_vec3_scale(b.up, 1 / backdrop->height);
    iso_parallel_for(pool, (size_t)image->height, blend_row, &b);
}
