/* optics: reflection, refraction and absorption of a ray at and in a transparent solid.
 *
 * Directions are unit vectors. A normal is unit length and turned against the ray: dot(ray, normal) <= 0. */
#ifndef ISO_RENDER_GLASS_OPTICS_H
#define ISO_RENDER_GLASS_OPTICS_H

#include "base/geometry.h"
#include "image/environment.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A transparent solid and what is around it. */
typedef struct iso_glass {
    double ior; /* index of refraction, 1 or more; the surroundings have 1 */
    /* Of each mm of the way in the solid, by colour: 2^-absorption of the light is left (Beer and Lambert) */
    double absorption[3];
    const iso_environment *environment; /* borrowed */
} iso_glass;

/* The absorption of a solid that leaves `color` (display values) of white light after `distance` mm:
 * attenuationColor and attenuationDistance of KHR_materials_volume. */
void iso_glass_set_absorption(iso_glass *glass, iso_rgb color, double distance);

/* Multiplies `light` by what is left of it after mm of the solid. */
void iso_glass_absorb(const iso_glass *glass, double mm, double light[3]);

static inline iso_vec3 iso_glass_reflect(iso_vec3 ray, iso_vec3 normal) {
    return iso_vec3_sub(ray, iso_vec3_scale(normal, 2 * iso_vec3_dot(ray, normal)));
}

/* The direction of a ray behind a boundary (Snell's law); false: total reflection. ratio: index of
 * refraction before the boundary divided by that behind it. */
static inline bool iso_glass_refract(iso_vec3 ray, iso_vec3 normal, double ratio, iso_vec3 *refracted) {
    const double cosine = -iso_vec3_dot(ray, normal), square = 1 - ratio * ratio * (1 - cosine * cosine);
    if (square < 0) return false;
    *refracted = iso_vec3_unit(
        iso_vec3_add(iso_vec3_scale(ray, ratio), iso_vec3_scale(normal, ratio * cosine - sqrt(square))));
    return true;
}

/* The share of the light that a boundary reflects (Schlick 1994, "An inexpensive BRDF model for physically-
 * based rendering"); nothing with an index of 1. cosine: of the angle between normal and ray outside of the
 * solid, 0 .. 1. */
static inline double iso_glass_reflectance(double ior, double cosine) {
    const double base = (ior - 1) / (ior + 1), least = base * base, x = 1 - cosine;
    return ior > 1 ? least + (1 - least) * (x * x) * (x * x) * x : 0;
}

#ifdef __cplusplus
}
#endif
#endif
