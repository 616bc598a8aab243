/* scenes: named procedural volumes for tests, benches, programs and reports.
 *
 *   sphere     level set; radius 0.4 of the side
 *   cylinder   level set; the capped cylinder of 2003, figure 4, tilted: radius 0.2, half height 0.32 of the
 *              side, axis (0.35, 0.25, 0.9)
 *   cube       level set; the axis-aligned cube of 2003, table 4: half edge 0.4 of the side
 *   torus      level set; axis z, radii 0.3 and 0.1 of the side
 *   head       level set; a head of smoothly united balls with fine gyroid detail
 *   gyroid     rgrid float32; sin x cos y + sin y cos z + sin z cos x, three periods a side, isovalue 0
 *   ct         rgrid uint8; a skull-like CT with noise: isovalue 127.5 is bone
 *   organs     rgrid uint8; labels of a torso, 1 to 13: iso_scene_organ_name
 *
 * A level set is an hgrid of band 3 or, with `dense`, an rgrid. The first four level sets are exact
 * distances, centred between voxels at floor(side / 2) - 0.5. The head's distances are to the closest point
 * found: with 512 voxels a side they are within 0.06 voxel of a brute-force search, and | |gradient| - 1 | is
 * 0.007 on average (0.0016 with 1024). With less than 256 voxels the relief is finer than the band is wide,
 * so that medial axes lie in the band: 0.03 on average with 256, 0.09 with 128.
 *
 * The same bytes on every machine and for every number of threads. */
#ifndef ISO_GRIDS_SCENES_SCENES_H
#define ISO_GRIDS_SCENES_SCENES_H

#include "base/parallel.h"
#include "grids/grid.h"

typedef struct iso_scene_opts {
    int size; /* voxels a side, 16 .. 2048; 0: the scene's own (sphere 64, cylinder 64, cube 32, others 128)
               */
    double detail; /* ct: the gyroid frequency, 0 means 29; others: unused */
    double noise;  /* ct: standard deviation of the noise, 0 means 5; negative: none */
    int dense;     /* 1: an rgrid float32 level set (clamped likewise) instead of an hgrid */
    iso_pool *pool;
} iso_scene_opts;

/* Creates the scene `name` in *grid (the caller's: iso_grid_destroy) and sets *isovalue (may be NULL) to the
 * isovalue of its surface. ISO_ERR_USAGE, with a list of the scenes, when `name` is not one. */
iso_status iso_scene_create(const char *name, const iso_scene_opts *opts, iso_grid *grid, double *isovalue,
                            iso_error *error);

/* The name of a label of the scene organs; NULL: it has no such label. */
const char *iso_scene_organ_name(int label);

/* The known names, NULL-terminated. */
const char *const *iso_scene_names(void);

#endif
