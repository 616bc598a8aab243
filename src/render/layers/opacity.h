/* opacity: the share of the light that a translucent surface stops, depending on the angle at which it is
 * seen (Kay and Greenberg 1979, "Transparency for computer synthesized images"). */
#ifndef ISO_RENDER_LAYERS_OPACITY_H
#define ISO_RENDER_LAYERS_OPACITY_H

#include <math.h>

#include "base/exponential.h"
#include "render/layers/layers.h"

/* The least cosine of the angle between normal and ray for which an opacity by angle is computed. */
#define ISO_LAYER_LEAST_COSINE 1e-6f

/* A function from angles to opacities. */
typedef struct iso_layer_opacity {
    float face_on;     /* the opacity where the surface is seen face on */
    bool by_angle;     /* the opacity is 1 - 2^(log_through / cos); if false, it is the same at every angle */
    float log_through; /* log2(1 - face_on) */
} iso_layer_opacity;

/* Returns the function for a share of the translucency's opacity, 0 to 1. */
static inline iso_layer_opacity iso_layer_opacity_part(const iso_translucency *translucency, float share) {
    const float face_on = translucency->opacity * share;
    const bool by_angle = !translucency->constant && face_on < 1;
    return (iso_layer_opacity){face_on, by_angle, by_angle ? (float)iso_log2(1 - (double)face_on) : 0};
}

static inline iso_layer_opacity iso_layer_opacity_make(const iso_translucency *translucency) {
    return iso_layer_opacity_part(translucency, 1);
}

/* Returns the opacity of a fragment with a unit normal, seen from the direction to_eye (of any length). */
static inline float iso_layer_opacity_at(const iso_layer_opacity *opacity, const float normal[3],
                                         const float to_eye[3]) {
    if (!opacity->by_angle) return opacity->face_on;
    const float length = sqrtf(to_eye[0] * to_eye[0] + to_eye[1] * to_eye[1] + to_eye[2] * to_eye[2]);
    const float cosine =
        fabsf(normal[0] * to_eye[0] + normal[1] * to_eye[1] + normal[2] * to_eye[2]) / length;
    return 1 - iso_exp2(opacity->log_through / fmaxf(cosine, ISO_LAYER_LEAST_COSINE));
}

#endif
