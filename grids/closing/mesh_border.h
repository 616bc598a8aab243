/* mesh_border: the caps of a mesh that a box cuts off, as isorender's meshes are by the volume's border.
 *
 * The open loops in the faces of the mesh's bounding box divide the box's surface into regions. How often a
 * region belongs to the solid changes by one across an open edge, the side being known by which way its
 * triangle faces; so all regions are known but for one constant. A face without open edges is not cut: its
 * number is 0. Where all six faces are cut the smallest number is 0: the triangles are taken to face out of
 * the solid. The caps are the regions with other numbers. */
#ifndef ISO_GRIDS_CLOSING_MESH_BORDER_H
#define ISO_GRIDS_CLOSING_MESH_BORDER_H

#include "base/primitives.h"
#include "base/status.h"
#include "grids/closing/triangle_tree.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_border_face iso_border_face;

/* Zero-initialise. */
typedef struct iso_border {
    double lo[3], hi[3], near; /* the box; what is this near a plane lies in it */
    iso_border_face *faces;    /* owned, six; NULL: no caps */
} iso_border;

/* The mesh's box. */
void iso_border_init(iso_border *border, const iso_triangles *mesh);
void iso_border_free(iso_border *border);

/* Whether an edge between these two lies in a face. */
bool iso_border_holds(const iso_border *border, const float a[3], const float b[3]);

/* Makes the caps. `edges` are vertices of `mesh`, directed as their triangles have them, each in a face.
 * ISO_ERR_FORMAT: the edges do not bound caps (as those of a sheet that goes all around the box).
 * ISO_ERR_NOMEM. */
iso_status iso_border_close(iso_border *border, const iso_triangles *mesh, const uint32_t (*edges)[2],
                            size_t count, iso_error *error);

/* The nearest point of the caps, if it is nearer. */
void iso_border_nearest(const iso_border *border, iso_vec3 p, iso_nearest *nearest);

/* Triangles with the caps' boundaries, which wind around points outside their planes as the caps do; in the
 * planes they overlap. To be freed with iso_free; no caps: none. ISO_ERR_NOMEM. */
iso_status iso_border_fans(const iso_border *border, iso_triangles *fans, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
