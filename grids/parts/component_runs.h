/* component_runs: connected components of the solid of a grid, as runs of voxels along x. Internal to the
 * library.
 *
 * Runs are found and joined in slabs of slices, each by one task, and the slabs are joined afterwards. A
 * union always keeps the lower run, so that components are numbered by their first voxel in x-fastest order,
 * for every number of threads. (Run-based union-find: He, Chao and Suzuki 2008, "A run-based two-scan
 * labeling algorithm", in three dimensions.) */
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

/* Some slices and their runs, in order. */
typedef struct iso_run_slab {
    int z[2];        /* slices z[0] .. z[1] - 1 */
    iso_buffer runs; /* iso_run */
    uint32_t *rows;  /* number in `runs` of each row's first run, and one past the last row's last */
    uint32_t *parent;
    size_t base; /* number in the volume of the slab's first run */
    iso_status status;
} iso_run_slab;

typedef struct iso_component_runs {
    int dims[3];
    iso_run_slab *slabs;
    size_t slab_count, run_count;
    uint32_t *component; /* of each run */
    uint64_t *voxels;    /* of each component */
    size_t component_count;
    uint64_t voxel_count;
} iso_component_runs;

/* Components of the voxels inside the surface. Those of a dense grid whose inside is at or above the isovalue
 * are joined by edges of the grid; those of a level set by diagonals of faces as well: Marching Cubes keeps
 * corners at or above the isovalue apart on ambiguous faces and so joins the ones below it. Voxels that are
 * not finite belong to none. ISO_ERR_LIMIT above 2^32 - 2 runs, ISO_ERR_NOMEM. Free with
 * iso_component_runs_free, also after a failure. */
iso_status iso_component_runs_find(const iso_grid *grid, const iso_threshold *surface, iso_pool *pool,
                                   iso_component_runs *runs, iso_error *error);
void iso_component_runs_free(iso_component_runs *runs);

#endif
