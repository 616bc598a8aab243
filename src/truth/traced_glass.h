/* traced_glass: renders glass by following reflected and refracted rays through the trilinear field: the
 * reference for the other modes of render/glass.
 *
 * At each crossing of the surface a ray splits into a reflected and a refracted ray, and both are followed.
 * At total reflection only the reflected ray continues. A path ends when it leaves the volume, where it sees
 * the environment. It also ends after ISO_GLASS_BOUNDARIES crossings, or when it carries less than
 * ISO_GLASS_CUT of the light; it is then given the environment's light in its direction. At the border of the
 * volume, where the solid is cut off, rays are not bent. */
#ifndef ISO_TRUTH_TRACED_GLASS_H
#define ISO_TRUTH_TRACED_GLASS_H

#include "render/glass/glass.h"
#include "truth/raycast.h"

enum { ISO_GLASS_BOUNDARIES = 16 };
#define ISO_GLASS_CUT (1 / 64.0)

/* The context (first argument) of iso_traced_glass_light; all pointers are borrowed. */
typedef struct iso_traced_glass {
    const iso_raycaster *caster;
    const iso_glass *glass;
    const iso_view *view; /* of the samples */
} iso_traced_glass;

/* An iso_glass_fn (render/glass/glass.h). */
bool iso_traced_glass_light(const void *context, int x, int y, double rgb[3]);

/* Fills a map with the crossings of each sample's straight ray, in double precision: the reference for
 * iso_exact_map_glass. `pool` may be NULL. */
void iso_raycast_map_glass(const iso_raycaster *caster, const iso_glass_map *map, iso_pool *pool);

#endif
