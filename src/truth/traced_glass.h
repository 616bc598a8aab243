/* traced_glass: glass by following refracted and reflected rays through the trilinear field: the truth for
 * the other modes of render/glass.
 *
 * Rays are reflected and refracted at each crossing of the surface; both parts are followed. Total reflection
 * stays in the solid. What ends a path: it leaves the volume, and sees the environment; or it has met
 * ISO_GLASS_BOUNDARIES crossings or carries less than ISO_GLASS_CUT of the light, and what it would see is
 * taken from the environment in its direction. Where the volume's border cuts the solid, rays pass it
 * unbent. */
#ifndef ISO_TRUTH_TRACED_GLASS_H
#define ISO_TRUTH_TRACED_GLASS_H

#include "render/glass/glass.h"
#include "truth/raycast.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_GLASS_BOUNDARIES = 16 };
#define ISO_GLASS_CUT (1 / 64.0)

/* The context of iso_traced_glass_light; all pointers are borrowed. */
typedef struct iso_traced_glass {
    const iso_raycaster *caster;
    const iso_glass *glass;
    const iso_view *view; /* of the samples */
} iso_traced_glass;

/* An iso_glass_fn (render/glass/glass.h). */
bool iso_traced_glass_light(const void *context, int x, int y, double rgb[3]);

/* Fills a map with every crossing of each ray, in double precision: the truth for iso_exact_map_glass. `pool`
 * may be NULL. */
void iso_raycast_map_glass(const iso_raycaster *caster, const iso_glass_map *map, iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
