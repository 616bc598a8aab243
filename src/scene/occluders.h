/* occluders: the voxels of the opaque surfaces, lines, glyphs and meshes of a scene as one lattice of bits
 * (render/occlusion/solid_bits.h), and what is found out with it: kept between pictures, and brought up to
 * date after edits. */
#ifndef ISO_SCENE_OCCLUDERS_H
#define ISO_SCENE_OCCLUDERS_H

#include "image/camera.h"
#include "render/occlusion/occlusion.h"
#include "scene/object.h"
#include "scene/surface.h"

/* How much of a picture's light is blocked. Zero-initialise: none is. */
typedef struct iso_occlusion_opts {
    bool ambient;        /* ambient occlusion */
    double range;        /* how far things darken each other, mm; 0: a tenth of the lattice's longest side */
    bool shadow;         /* a soft shadow of the key light */
    uint64_t most_bytes; /* of the lattice: a larger one gets larger voxels; 0: 1 GiB */
} iso_occlusion_opts;

enum { ISO_OCCLUDERS_MAX = 64 }; /* surfaces */

/* A surface whose voxels are in the lattice. */
typedef struct iso_occluder {
    iso_grid grid;
    double isovalue;
    uint64_t edit; /* the last edit that the lattice has */
    iso_clip clip; /* what is cut away of the solid */
} iso_occluder;

/* Zero-initialise; iso_occluders_free when done. One picture at a time. */
typedef struct iso_occluders {
    iso_solid_bits bits, removed; /* removed: what clips cut away of the solids; without words: nothing */
    int origin[3]; /* of the lattice's first voxel in the grid of the first surface, if `coarse` is 1 */
    int coarse;    /* voxels of the first surface's grid along a voxel of the lattice; 0: there is none yet */
    iso_solid_bits things; /* what objects fill of the lattice; without words: there are none */
    iso_box box;           /* of the objects, in the world */
    iso_occluder occluders[ISO_OCCLUDERS_MAX];
    int count;
    iso_occlusion occlusion;
} iso_occluders;

/* What is opaque in a scene: surfaces with grids, and objects. Borrowed. */
typedef struct iso_occluding {
    const iso_scene_surface *surfaces[ISO_OCCLUDERS_MAX];
    const iso_scene_object *objects[ISO_SURFACE_MAX];
    int count, object_count;
} iso_occluding;

/* Brings the lattice up to date with what is opaque, and makes ready what a picture with this view needs:
 * *occlusion, valid until the next call (NULL: nothing is occluded). The lattice has the voxels of the first
 * surface; without one, so many that there are 256 along the longest side. ISO_ERR_NOMEM. */
iso_status iso_occluders_update(iso_occluders *occluders, const iso_occluding *occluding,
                                const iso_occlusion_opts *opts, const iso_camera *camera, iso_pool *pool,
                                iso_occlusion **occlusion, iso_error *error);
void iso_occluders_free(iso_occluders *occluders);

#endif
