/* mesh_edit: smooths and simplifies welded meshes, for files. Closed meshes stay closed. */
#ifndef ISO_EXTRACT_MESH_MESH_EDIT_H
#define ISO_EXTRACT_MESH_MESH_EDIT_H

#include "extract/mesh/mesh.h"

/* What is done to a mesh, in this order. All 0: nothing. */
typedef struct iso_mesh_edits {
    int smooth;       /* iterations */
    double keep;      /* share of the triangles that are kept, above 0 and below 1; 0: not given */
    double deviation; /* mm that the surface moves by, about, at most; 0: not given */
} iso_mesh_edits;

/* Moves vertices towards the mean of their neighbours and back, `iterations` times, which takes away steps
 * and noise but keeps the volume (Taubin 1995, "A signal processing approach to fair surface design"; lambda
 * 0.6307, mu -0.6732: the pass band ends at 0.1). Vertices at open edges stay. Normals become those of the
 * triangles. ISO_ERR_NOMEM. */
iso_status iso_weld_smooth(iso_weld *weld, int iterations, iso_error *error);

/* Joins triangles by collapsing edges in the order of their quadric errors (Garland and Heckbert 1997), with
 * meshoptimizer, until edits->keep of them or the deviation is reached; one of them is given. The vertices
 * that are left do not move. Normals become those of the triangles. ISO_ERR_BACKEND: built without
 * meshoptimizer; ISO_ERR_NOMEM. */
iso_status iso_weld_decimate(iso_weld *weld, const iso_transform *transform, const iso_mesh_edits *edits,
                             iso_error *error);
bool iso_weld_can_decimate(void);

/* Both, as far as they are asked for. */
iso_status iso_weld_edit(iso_weld *weld, const iso_transform *transform, const iso_mesh_edits *edits,
                         iso_error *error);

/* Sets the normals to those of the triangles, by their areas; where that is nothing they stay. */
void iso_weld_find_normals(iso_weld *weld);

#endif
