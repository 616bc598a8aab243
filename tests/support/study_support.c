/* study_support: colours and changes of the pictures of a study. */
#include "study_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static float clamp_255(float value) {
    return value < 0 ? 0 : value > 255 ? 255 : value;
}

/* Returns the cosine of the angle between a pixel's normal and the direction to the eye. */
static float facing(const iso_study_frame *frame, const iso_view *view, int x, int y) {
    size_t i = (size_t)y * (size_t)view->width + (size_t)x;
    float *const *n = frame->aov.normal;
    iso_vec3 origin, ray;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &ray);
    float cosine = (float)fabs(iso_vec3_dot(iso_vec3_unit(ray), iso_vec3_make(n[0][i], n[1][i], n[2][i])));
    return cosine < 1 ? cosine : 1;
}

void iso_study_shade(const iso_study_frame *frame, const iso_view *view, const iso_study_look *look,
                     float *color) {
    const float base[3] = {look->color.r, look->color.g, look->color.b};
    const float background[3] = {look->background.r, look->background.g, look->background.b};
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++, color += 3) {
            if (frame->aov.coverage[(size_t)y * (size_t)view->width + (size_t)x] == 0) {
                memcpy(color, background, sizeof background);
                continue;
            }
            float cosine = facing(frame, view, x, y), power8 = cosine;
            for (int i = 0; i < 3; i++) power8 *= power8;
            float power32 = power8 * power8 * power8 * power8, shine = 0.3f * 255 * power8 * power32;
            for (int c = 0; c < 3; c++) color[c] = clamp_255(base[c] * (0.15f + 0.8f * cosine) + shine);
        }
}

double iso_study_change(const iso_study_frame *a, const iso_study_frame *b) {
    size_t count = (size_t)a->image.width * (size_t)a->image.height, pixels = 0;
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        if (a->aov.coverage[i] < 0.5f && b->aov.coverage[i] < 0.5f) continue;
        pixels++;
        for (size_t c = 0; c < 3; c++)
            sum += (uint64_t)abs(a->image.rgba[4 * i + c] - b->image.rgba[4 * i + c]);
    }
    return pixels ? (double)sum / (3.0 * (double)pixels) : NAN;
}
