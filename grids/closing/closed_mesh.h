/* closed_mesh: a triangle mesh made closed, so that it encloses a solid: what level sets are made of.
 *
 * The solid is where the mesh's winding number (grids/closing/triangle_tree.h) is not 0: a shell inside
 * another one is a cavity when it faces inwards, and part of the solid when it faces outwards; a mesh that is
 * inside out encloses the same as one that is not. Self-intersections do no harm. What is open is closed:
 *
 *  - open loops in the faces of the mesh's bounding box are capped there: a volume's border cut them;
 *  - holes up to a given size are filled by the triangles with the least area, and a single missing triangle
 *    and cracks whatever their length.
 *
 * Anything else is an error: there is no solid. */
#ifndef ISO_GRIDS_CLOSING_CLOSED_MESH_H
#define ISO_GRIDS_CLOSING_CLOSED_MESH_H

#include "base/primitives.h"
#include "base/progress.h"
#include "grids/closing/triangle_tree.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Holes of this part of the mesh's longest side are filled by default. */
#define ISO_MESH_HOLE 0.1

typedef struct iso_closing_opts {
    double hole; /* mm: the largest hole to fill, measured as the diagonal of its box; 0: ISO_MESH_HOLE of the
                    mesh's longest side; negative: none */
    const iso_progress *progress; /* cancelled: ISO_ERR_IO */
} iso_closing_opts;

/* What was found, and what was done. */
typedef struct iso_mesh_report {
    size_t triangles;    /* that are neither degenerate nor copies of others */
    size_t open_edges;   /* edges without a partner */
    size_t holes_closed; /* filled */
    size_t loops_capped; /* in the faces of the bounding box */
    size_t turned;       /* triangles that faced another way than their neighbours */
    double largest_hole; /* mm, of those that were filled */
    double volume;       /* mm3, of the closed mesh: parts inside out count as negative */
    double area;         /* mm2, of its triangles without the caps */
} iso_mesh_report;

typedef struct iso_closed_mesh iso_closed_mesh;

/* The mesh is copied. `path` is for messages. ISO_ERR_FORMAT: it is open beyond what can be closed, or no
 * more than a sheet; the text has the number of open edges and the size of the largest hole. ISO_ERR_EMPTY:
 * no triangle has an area. ISO_ERR_NOMEM, ISO_ERR_LIMIT. */
iso_status iso_closed_mesh_create(const char *path, const iso_triangles *mesh, const iso_closing_opts *opts,
                                  iso_closed_mesh **closed, iso_error *error);
void iso_closed_mesh_destroy(iso_closed_mesh *closed); /* NULL is fine */

const iso_mesh_report *iso_closed_mesh_report(const iso_closed_mesh *closed);
iso_box iso_closed_mesh_box(const iso_closed_mesh *closed);

/* Thread-safe. */
double iso_closed_mesh_winding(const iso_closed_mesh *closed, iso_vec3 p);
void iso_closed_mesh_nearest(const iso_closed_mesh *closed, iso_vec3 p, iso_nearest *nearest);

/* One line for people about what was closed or turned; false: nothing was. */
bool iso_mesh_report_note(const iso_mesh_report *report, char *text, size_t size);

#ifdef __cplusplus
}
#endif
#endif
