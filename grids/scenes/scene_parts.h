/* scene_parts: what grids/scenes/scenes.c is made of. Private to the scenes. */
#ifndef ISO_GRIDS_SCENES_SCENE_PARTS_H
#define ISO_GRIDS_SCENES_SCENE_PARTS_H

#include "grids/scenes/scenes.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Half width of the narrow band of every scene, voxels. */
#define ISO_SCENE_BAND 3.0

/* A solid that can fill the bricks of a level set. Both functions are called from several threads. */
typedef struct iso_scene_solid {
    int size; /* voxels a side */
    const void *self;
    /* ISO_CELL_OUTSIDE or ISO_CELL_INSIDE when no voxel of the cell is nearer to the surface than the band;
     * 0 when that is not certain. */
    int32_t (*classify)(const void *self, const int cell[3]);
    /* All 4096 distances, clamped to the band. `scratch` holds scratch_bytes and belongs to the caller. */
    void (*fill)(const void *self, const int cell[3], void *scratch, float *brick);
    size_t scratch_bytes;
} iso_scene_solid;

/* An hgrid, or with opts->dense an rgrid, of the shape. */
iso_status iso_scene_build(const iso_scene_solid *solid, const iso_scene_opts *opts, iso_grid *grid,
                           iso_error *error);

/* Sine and cosine of rate * (i + first + 1/2) for i in 0 .. count - 1, shifted by `phase`: out[2 i] and
 * out[2 i + 1]. */
typedef struct iso_scene_axis {
    double rate, phase;
    int first, count;
} iso_scene_axis;
void iso_scene_sines(const iso_scene_axis *axis, double *out);

/* opts->size is set in all of these. */
iso_status iso_scene_head(const iso_scene_opts *opts, iso_grid *grid, iso_error *error);
iso_status iso_scene_ct(const iso_scene_opts *opts, iso_grid *grid, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
