/* blend: the weighted average of the discs that make a layer of the surface at a pixel. Internal to
 * groups. */
#ifndef ISO_RENDER_GROUPS_BLEND_H
#define ISO_RENDER_GROUPS_BLEND_H

#include "render/groups/banded_discs.h"
#include "render/groups/groups.h"

/* Weighted sums over the discs of a layer. Colours are also weighted by the opacities of the points, so that
 * the colour of a point that is not seen does not show at its neighbours. */
typedef struct iso_splat_sums {
    float weight, depth, normal[3], color[3];
    float opacity; /* of points with an opacity of 255 the weight itself */
} iso_splat_sums;

/* Returns how far behind the front of a layer (mm) a disc may lie and still belong to the layer. */
static inline float iso_splat_thickness(const iso_disc *disc) {
    return disc->radius * (ISO_GROUPS_THICKNESS / ISO_GROUPS_DISC);
}

/* Adds a disc to the sums, at the point where a ray hits it. */
static inline void iso_splat_add(const iso_point_view *points, const iso_disc *disc, float depth, float e,
                                 iso_splat_sums *sums) {
    const float w = iso_disc_weight(e);
    sums->weight += w;
    sums->depth += w * depth;
    for (int k = 0; k < 3; k++) sums->normal[k] += w * disc->normal[k];
    const float share = points->opacities ? w * (float)points->opacities[disc->point] / 255 : w;
    sums->opacity += share;
    for (int k = 0; k < 3 && points->colors; k++)
        sums->color[k] += share * (float)points->colors[disc->point][k];
}

/* Computes the mean normal, a unit vector; (0, 0, -1) when the normals cancel. */
static inline void iso_splat_normal(const iso_splat_sums *sums, float normal[3]) {
    const float *n = sums->normal, length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) normal[k] = length > 0 ? n[k] / length : k == 2 ? -1.0f : 0.0f;
}

/* Computes the mean colour, rounded, of points that have colours; black if all have an opacity of 0. */
static inline void iso_splat_color(const iso_splat_sums *sums, uint8_t rgb[3]) {
    for (int k = 0; k < 3; k++)
        rgb[k] = sums->opacity > 0 ? (uint8_t)(sums->color[k] / sums->opacity + 0.5f) : 0;
}

#endif
