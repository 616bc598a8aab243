/* ring_chains: chains of rings become lines. Internal to extract/lines. */
#ifndef ISO_EXTRACT_LINES_RING_CHAINS_H
#define ISO_EXTRACT_LINES_RING_CHAINS_H

#include "extract/lines/mesh_rings.h"

/* A place of a chain: a ring, and what the line has there. */
typedef struct iso_chain_place {
    uint32_t ring;
    bool keep;     /* it becomes a vertex of the line */
    double radius; /* mm */
} iso_chain_place;

/* Rings one after the other, which become a line. */
typedef struct iso_chain {
    size_t first, count; /* places */
    uint32_t piece;
    bool attached[2]; /* its first, or last, ring belongs to another line, on which it begins or ends */
} iso_chain;

/* Zero-initialise; iso_chains_free. */
typedef struct iso_chains {
    iso_chain *chains;
    iso_chain_place *places;
    size_t count, place_count;
    uint32_t *stand_in; /* of each ring that was left out: the one that stands for it; of the others itself */
} iso_chains;

/* Leaves out short side branches, cuts the graph of rings into chains, moves the rings of pieces that
 * are no sheets to the middles of their branches, and sets their radii. ISO_ERR_NOMEM. */
iso_status iso_chains_make(iso_mesh_rings *rings, iso_chains *chains, iso_error *error);
void iso_chains_free(iso_chains *chains);

#endif
