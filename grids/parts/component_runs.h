/* component_runs: finds the connected components of the solid in a grid, as runs of voxels along x. Internal
 * to the library.
 *
 * A run is a maximal range of inside voxels in a row. Runs are found and joined by union-find (He, Chao and
 * Suzuki 2008, "A run-based two-scan labeling algorithm", in three dimensions) in slabs of slices, one task
 * each; then the slabs are joined. A union keeps the lower run, so components are numbered by their first
 * voxel in x-fastest order, for every number of threads. */
#ifndef ISO_GRIDS_PARTS_COMPONENT_RUNS_H
#define ISO_GRIDS_PARTS_COMPONENT_RUNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "grids/grid.h"
#include "grids/threshold.h"

/* Voxels first .. last of a row. */
typedef struct iso_run {
    int32_t first, last;
} iso_run;

/* A slab of consecutive slices, and the runs in it, in order. */
typedef struct iso_run_slab {
    int z[2];         /* slices z[0] .. z[1] - 1 */
    iso_buffer runs;  /* iso_run */
    uint32_t *rows;   /* by row: the index in `runs` of its first run; one more entry for the end */
    uint32_t *parent; /* by run of the slab, until slabs are joined: see base/disjoint_sets.h */
    size_t base;      /* index in the volume of the slab's first run */
    iso_status status;
} iso_run_slab;

typedef struct iso_component_runs {
    int dims[3];
    iso_run_slab *slabs;
    size_t slab_count, run_count;
    uint32_t *component; /* by run: its component */
    uint64_t *voxels;    /* by component: its number of voxels */
    size_t component_count;
    uint64_t voxel_count; /* number of voxels of all components */
} iso_component_runs;

/* Finds the components of the voxels inside the surface. Where inside is at or above the isovalue, voxels are
 * connected along the edges of the grid; in level sets also along the diagonals of faces, because Marching
 * Cubes separates corners at or above the isovalue on ambiguous faces and so connects those below it. Voxels
 * that are not finite belong to no component. ISO_ERR_LIMIT: more than 2^32 - 2 runs; ISO_ERR_NOMEM. Free
 * with iso_component_runs_free, also after a failure. */
iso_status iso_component_runs_find(const iso_grid *grid, const iso_threshold *surface, iso_pool *pool,
                                   iso_component_runs *runs, iso_error *error);
void iso_component_runs_free(iso_component_runs *runs);

#endif
