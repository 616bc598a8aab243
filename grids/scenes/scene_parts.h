/* scene_parts: functions shared by the files of grids/scenes. Private to them. */
#ifndef ISO_GRIDS_SCENES_SCENE_PARTS_H
#define ISO_GRIDS_SCENES_SCENE_PARTS_H

#include "grids/scenes/scenes.h"

/* Half width of the narrow band of every scene, voxels. */
#define ISO_SCENE_BAND 3.0

/* A solid as functions that fill the bricks of a level set; both are called from several threads. */
typedef struct iso_scene_solid {
    int size; /* voxels a side */
    const void *self;
    /* ISO_CELL_OUTSIDE or ISO_CELL_INSIDE if certainly no voxel of the cell is within the band, else 0. */
    int32_t (*classify)(const void *self, const int cell[3]);
    /* Writes all 4096 distances, clamped to the band. `scratch` has scratch_bytes and belongs to the caller.
     */
    void (*fill)(const void *self, const int cell[3], void *scratch, float *brick);
    size_t scratch_bytes;
} iso_scene_solid;

/* Creates an hgrid or, with opts->dense, an rgrid of the solid. */
iso_status iso_scene_build(const iso_scene_solid *solid, const iso_scene_opts *opts, iso_grid *grid,
                           iso_error *error);

/* Sine and cosine of rate * (i + first + 1/2) for i in 0 .. count - 1, shifted by `phase`: out[2 i] and
 * out[2 i + 1]. */
typedef struct iso_scene_axis {
    double rate, phase;
    int first, count;
} iso_scene_axis;
void iso_scene_sines(const iso_scene_axis *axis, double *out);

/* The scenes head and ct. opts->size must be set. */
iso_status iso_scene_head(const iso_scene_opts *opts, iso_grid *grid, iso_error *error);
iso_status iso_scene_ct(const iso_scene_opts *opts, iso_grid *grid, iso_error *error);
iso_status iso_scene_organs(const iso_scene_opts *opts, iso_grid *grid, iso_error *error);

#endif
