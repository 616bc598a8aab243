/* occlusion: how much light reaches the samples of a gbuffer: from all around (ambient occlusion) and from
 * the key light (a soft shadow). Read from the nodes around each sample (render/occlusion/visibility.h),
 * weighted by distance and, for the light from all around, by the cosine between direction and normal.
 *
 * Surfaces are seen from inside where the border of a volume cuts a solid open. There the solid's inside is
 * what light passes, and the rest of the volume is what blocks it.
 *
 * Sources: Landis 2002, "Production-ready global illumination", for occlusion by cosine-weighted rays of
 * limited length; Stewart 2003, "Vicinity shading for enhanced perception of volumetric data", for keeping it
 * with the volume. */
#ifndef ISO_RENDER_OCCLUSION_OCCLUSION_H
#define ISO_RENDER_OCCLUSION_OCCLUSION_H

#include "image/camera.h"
#include "render/occlusion/visibility.h"
#include "render/view/gbuffer.h"

/* What is found out on one side of the surfaces. */
typedef struct iso_occlusion_side {
    const iso_solid_bits *bits; /* what blocks light there; NULL: the side has not been seen yet */
    iso_solid_bits inverse;     /* owned: the bits of the inner side */
    iso_visibility *around, *key;
} iso_occlusion_side;

enum { ISO_SIDE_OUTER, ISO_SIDE_INNER, ISO_SIDES };

/* Set the first members, and zero the rest; call iso_occlusion_reset after changing them. Kept between
 * pictures; iso_occlusion_free when done. One picture at a time. */
typedef struct iso_occlusion {
    const iso_solid_bits *bits; /* borrowed */
    const iso_solid_bits
        *removed; /* what was cut away of solids, on both sides empty; borrowed; NULL: nothing */
    const iso_solid_bits *things; /* those of `bits` that block light on both sides, as lines do; or NULL */
    int lo[3], hi[3];             /* the voxels outside which nothing is known, inclusive */
    double range;                 /* of ambient occlusion, mm; 0: there is none */
    bool has_shadow;
    iso_vec3 light; /* of shadows: unit, in the world, towards the light; iso_occlusion_turn changes it */
    iso_occlusion_side sides[ISO_SIDES];
} iso_occlusion;

/* Forgets what was found out. */
void iso_occlusion_reset(iso_occlusion *occlusion);
/* Forgets what depends on voxels lo .. hi (inclusive), whose bits have changed. */
void iso_occlusion_forget(iso_occlusion *occlusion, const int lo[3], const int hi[3]);
/* Moves the key light. */
void iso_occlusion_turn(iso_occlusion *occlusion, iso_vec3 light);
#define iso_occlusion_free iso_occlusion_reset

/* Sets gbuffer->ambient (with a range) and gbuffer->key (with a shadow) of rows first .. last. A pixel is
 * factor x factor samples: those that show the same place share what is found there. Computes the nodes that
 * it needs. The bytes are the same for every instruction set and number of threads, and whatever was computed
 * before. ISO_ERR_NOMEM. */
iso_status iso_occlusion_light(iso_occlusion *occlusion, const iso_view *view, int factor, int first,
                               int last, const iso_gbuffer *gbuffer, iso_pool *pool, iso_error *error);

/* The share of the surroundings that a surface sees at a place on its outer side: a position in index
 * coordinates and a unit normal in the world. For tests; computes the nodes around it. ISO_ERR_NOMEM. */
iso_status iso_occlusion_at(iso_occlusion *occlusion, const float position[3], const float normal[3],
                            float *share, iso_error *error);

#endif
