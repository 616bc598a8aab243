/* components_sparse: removes parts of the solid from a level set in an hgrid. Internal to the library. */
#ifndef ISO_GRIDS_PARTS_COMPONENTS_SPARSE_H
#define ISO_GRIDS_PARTS_COMPONENTS_SPARSE_H

#include "grids/parts/component_runs.h"

/* The parts to remove; all pointers are borrowed. */
typedef struct iso_sparse_removal {
    float at;                       /* stored isovalue: inside is below it */
    const iso_component_runs *runs; /* the components of the grid */
    const bool *kept;               /* by component: whether it stays in the grid */
    iso_pool *pool;
} iso_sparse_removal;

/* Removes the components that are not kept, as iso_components_filter describes it for level sets.
 * ISO_ERR_NOMEM: some may have been removed. */
iso_status iso_components_remove_sparse(iso_hgrid *grid, const iso_sparse_removal *removal, iso_error *error);

#endif
