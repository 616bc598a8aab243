/* ring_smoothing: moves the rings of chains to the middles of their branches. Internal to extract/lines. */
#ifndef ISO_EXTRACT_LINES_RING_SMOOTHING_H
#define ISO_EXTRACT_LINES_RING_SMOOTHING_H

#include "extract/lines/ring_chains.h"

/* Sets `at` and `radius` of the rings of all chains of pieces that are no sheets, and which places are
 * kept. degree: the number of links of each ring. ISO_ERR_NOMEM. */
iso_status iso_chains_smooth(iso_mesh_rings *rings, iso_chains *chains, const uint32_t *degree,
                             iso_error *error);

#endif
