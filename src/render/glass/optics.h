/* optics: reflection, refraction and absorption of a ray at and in a transparent solid.
 *
 * Directions are unit vectors. A normal is unit length and turned against the ray: dot(ray, normal) <= 0. */
#ifndef ISO_RENDER_GLASS_OPTICS_H
#define ISO_RENDER_GLASS_OPTICS_H

#include "base/geometry.h"
#include "image/environment.h"

/* A transparent solid and its surroundings. */
typedef struct iso_glass {
    double ior; /* index of refraction, 1 or more; the surroundings have 1 */
    /* Attenuation for red, green and blue: after 1 mm in the solid, 2^-absorption of the light is left (Beer
     * and Lambert). */
    double absorption[3];
    /* Share of the light that each surface on the way takes away, 0 .. 1 (Zhang and Pajarola 2006, equation
     * 11); for the refraction modes none, single and layers. */
    double surface_opacity;
    const iso_environment *environment; /* borrowed */
} iso_glass;

/* Sets the absorption so that `color` (display values) is left of white light after `distance` mm:
 * attenuationColor and attenuationDistance of KHR_materials_volume. */
void iso_glass_set_absorption(iso_glass *glass, iso_rgb color, double distance);

/* Sets indices of refraction for red, green and blue, 1 or more, as KHR_materials_dispersion suggests for
 * three colours. ior: that of green; abbe: the Abbe number, above 0: (ior - 1) / (index of blue - index of
 * red). */
void iso_glass_disperse(double ior, double abbe, double iors[3]);

/* Attenuates `light` by a path of `mm` mm in the solid. */
void iso_glass_absorb(const iso_glass *glass, double mm, double light[3]);

static inline iso_vec3 iso_glass_reflect(iso_vec3 ray, iso_vec3 normal) {
    return iso_vec3_sub(ray, iso_vec3_scale(normal, 2 * iso_vec3_dot(ray, normal)));
}

/* Computes the direction of a ray behind a boundary (Snell's law). Returns false at total reflection. ratio:
 * index of refraction before the boundary divided by the one behind it. */
static inline bool iso_glass_refract(iso_vec3 ray, iso_vec3 normal, double ratio, iso_vec3 *refracted) {
    const double cosine = -iso_vec3_dot(ray, normal), square = 1 - ratio * ratio * (1 - cosine * cosine);
    if (square < 0) return false;
    *refracted = iso_vec3_unit(
        iso_vec3_add(iso_vec3_scale(ray, ratio), iso_vec3_scale(normal, ratio * cosine - sqrt(square))));
    return true;
}

/* Returns the share of the light that a boundary reflects (Schlick 1994, "An inexpensive BRDF model for
 * physically-based rendering"); 0 if the index of refraction is 1. cosine: of the angle between the normal
 * and the ray on the outer side, 0 .. 1. */
static inline double iso_glass_reflectance(double ior, double cosine) {
    const double base = (ior - 1) / (ior + 1), least = base * base, x = 1 - cosine;
    return ior > 1 ? least + (1 - least) * (x * x) * (x * x) * x : 0;
}

#endif
