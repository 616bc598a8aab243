/* mesh_border: caps a mesh that a box cuts off, as the volume's border cuts the meshes that isorender writes.
 *
 * The open loops in the faces of the mesh's bounding box divide the surface of the box into regions. The
 * winding number of a region changes by one across an open edge, in the direction in which the edge's
 * triangle faces; so the numbers of all regions are known but for a constant. A face without open edges is
 * not cut and has number 0. If all six faces are cut, the smallest number is set to 0: the triangles are
 * assumed to face out of the solid. The caps are the regions whose number is not 0. */
#ifndef ISO_GRIDS_CLOSING_MESH_BORDER_H
#define ISO_GRIDS_CLOSING_MESH_BORDER_H

#include "base/primitives.h"
#include "base/status.h"
#include "grids/closing/triangle_tree.h"

typedef struct iso_border_face iso_border_face;

/* The box of a mesh and its caps. Zero-initialise; iso_border_free when done. */
typedef struct iso_border {
    double lo[3], hi[3], near; /* the box; points within this distance of a face lie in it */
    iso_border_face *faces;    /* owned, six; NULL: no caps */
} iso_border;

/* Sets the box of a mesh. */
void iso_border_init(iso_border *border, const iso_triangles *mesh);
void iso_border_free(iso_border *border);

/* Whether the edge between two points lies in a face of the box. */
bool iso_border_holds(const iso_border *border, const float a[3], const float b[3]);

/* Makes the caps. `edges` are pairs of vertices of `mesh`, each in a face, in the direction in which their
 * triangles have them. ISO_ERR_FORMAT: the edges do not bound caps (for example a sheet that divides the
 * box); ISO_ERR_NOMEM. */
iso_status iso_border_close(iso_border *border, const iso_triangles *mesh, const uint32_t (*edges)[2],
                            size_t count, iso_error *error);

/* Sets *nearest to the nearest point of the caps, if this point is nearer than *nearest. */
void iso_border_nearest(const iso_border *border, iso_vec3 p, iso_nearest *nearest);

/* Makes triangles with the same boundaries as the caps, and so with the same winding number at all points
 * outside their planes; within the planes they overlap. Makes none if there are no caps. Free the arrays with
 * iso_free. ISO_ERR_NOMEM. */
iso_status iso_border_fans(const iso_border *border, iso_triangles *fans, iso_error *error);

#endif
