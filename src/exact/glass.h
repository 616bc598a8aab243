/* glass: makes the map of crossings, with which pictures of glass are shaded, from the exact surface. */
#ifndef ISO_EXACT_GLASS_H
#define ISO_EXACT_GLASS_H

#include "exact/exact.h"
#include "render/glass/glass.h"

/* Fills the map with the crossings of the surface, which must be up to date. The bytes are the same for every
 * number of threads and instruction set. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_exact_map_glass(const iso_exact *exact, const iso_glass_map *map, iso_pool *pool,
                               iso_error *error);

#endif
