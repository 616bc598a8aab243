/* closed_mesh: closes a triangle mesh so that it encloses a solid, which can be converted to a level set.
 *
 * The solid is where the winding number of the mesh (grids/closing/triangle_tree.h) is not 0. A shell inside
 * another one is a cavity if it faces inwards, and part of the solid if it faces outwards; a mesh that is
 * inside out encloses the same solid. Self-intersections are allowed. Open meshes are closed:
 *
 *  - open loops in the faces of the mesh's bounding box, where a volume's border cut the surface, are capped;
 *  - holes up to a given size are filled by the triangulation with the least area, and so are single missing
 *    triangles and cracks of any length.
 *
 * All other open loops are an error: there is no solid. */
#ifndef ISO_GRIDS_CLOSING_CLOSED_MESH_H
#define ISO_GRIDS_CLOSING_CLOSED_MESH_H

#include "base/primitives.h"
#include "base/progress.h"
#include "grids/closing/brick_distances.h"

/* The default for the largest hole to fill, as a fraction of the mesh's longest side. */
#define ISO_MESH_HOLE 0.1

typedef struct iso_closing_opts {
    double hole; /* mm: the largest hole to fill, measured as the diagonal of its box; 0: ISO_MESH_HOLE
                    times the longest side of the mesh's box; negative: none */
    const iso_progress *progress; /* cancelled: ISO_ERR_IO */
} iso_closing_opts;

/* What was found in a mesh, and what was done to close it. */
typedef struct iso_mesh_report {
    size_t triangles;    /* without degenerate ones and duplicates */
    size_t open_edges;   /* edges with a triangle on one side only */
    size_t holes_closed; /* loops that were filled */
    size_t loops_capped; /* loops in the faces of the bounding box that were capped */
    size_t turned;       /* triangles that were turned to face as their neighbours do */
    double largest_hole; /* mm; the largest of the filled loops */
    double volume;       /* mm3, of the closed mesh; parts that are inside out count as negative */
    double area;         /* mm2, of its triangles without the caps */
} iso_mesh_report;

typedef struct iso_closed_mesh iso_closed_mesh;

/* Copies and closes a mesh. `path` is used in messages. ISO_ERR_FORMAT: the mesh cannot be closed, or
 * encloses hardly any volume; the message has the number of open edges and the size of the largest hole.
 * ISO_ERR_EMPTY: no triangle has an area; ISO_ERR_IO: cancelled; ISO_ERR_NOMEM, ISO_ERR_LIMIT. */
iso_status iso_closed_mesh_create(const char *path, const iso_triangles *mesh, const iso_closing_opts *opts,
                                  iso_closed_mesh **closed, iso_error *error);
void iso_closed_mesh_destroy(iso_closed_mesh *closed); /* NULL is allowed */

const iso_mesh_report *iso_closed_mesh_report(const iso_closed_mesh *closed);
iso_box iso_closed_mesh_box(const iso_closed_mesh *closed);

/* Finds by how much the winding number at q exceeds that at p, fast if they are near to each other; false:
 * this cannot be told (iso_triangle_tree_change). Thread-safe. */
bool iso_closed_mesh_change(const iso_closed_mesh *closed, iso_vec3 p, iso_vec3 q, int *change);

/* Return the winding number at a point, and find the nearest point of the triangles and caps. Thread-safe. */
double iso_closed_mesh_winding(const iso_closed_mesh *closed, iso_vec3 p);
void iso_closed_mesh_nearest(const iso_closed_mesh *closed, iso_vec3 p, iso_nearest *nearest);

/* Sets the squared distances (mm2) of the voxels of a brick from the triangles and caps, at most that of
 * `band` voxels: what iso_closed_mesh_nearest finds for each, but faster. Thread-safe. */
void iso_closed_mesh_measure(const iso_closed_mesh *closed, const iso_brick_place *brick, double band,
                             double squared[ISO_BRICK_VOXELS]);

/* As iso_brick_distances, for the triangles without the caps. Thread-safe. */
void iso_closed_mesh_nearest_triangles(const iso_closed_mesh *closed, const iso_brick_place *brick,
                                       double band, double squared[ISO_BRICK_VOXELS],
                                       const iso_tree_triangle *nearest[ISO_BRICK_VOXELS]);

/* Writes a line for users that says what was closed or turned. Returns false if nothing was. */
bool iso_mesh_report_note(const iso_mesh_report *report, char *text, size_t size);

#endif
