/* mesh_lines: turns a mesh of thin branches (a tree, vessels, neurites) into lines: tubes with a radius at
 * every vertex, and ribbons for its leaves (Marroquim, Kraus and Cavalcanti 2008, section 4.3, figure 12).
 *
 * As in the paper, the vertices of a branch are divided into rings, and each ring becomes a vertex of a line:
 * its middle, with the mean distance of its vertices as radius (in the paper the greatest); rings that edges
 * of the mesh join are joined. The paper guesses the rings of one model; here they are the vertices that are
 * equally many edges away from the end of their piece, and joined. Of a mesh that was made of rings around
 * lines these are the same rings, and the lines have the same vertices.
 *
 * In other meshes, such as those of Marching Cubes, such rings would cross each other. There they are the
 * vertices that are equally far from the end along the surface; lines are smoothed, and have only the
 * vertices without which the line or its radius would change by a fiftieth of the radius.
 *
 * Where branches join, the two that best continue each other are one line; the others begin on it. A side
 * branch that is shorter than 1.5 times the radius there is left out. A closed end that is round ends the
 * line at the middle of its roundness.
 *
 * A leaf is a flat piece with one outline, longer than wide: its ribbon has the middles and half the widths
 * of the pairs of vertices across it. Pieces that are neither (thick, or far from every tube) stay triangles.
 */
#ifndef ISO_EXTRACT_LINES_MESH_LINES_H
#define ISO_EXTRACT_LINES_MESH_LINES_H

#include "base/lines.h"
#include "base/primitives.h"

/* All owned; zero-initialise, iso_mesh_lines_free. */
typedef struct iso_mesh_lines {
    iso_lines tubes;    /* with radii */
    iso_lines ribbons;  /* with radii, half the width, and normals */
    iso_triangles rest; /* the triangles of the other pieces; all vertices of the joined mesh */
    size_t pieces, tube_pieces, ribbon_pieces; /* of the mesh, which are its connected components */
    size_t vertices;                           /* of the mesh, equal positions counted once */
    size_t left_out;                           /* triangles that are degenerate, or there twice */
} iso_mesh_lines;

/* Makes lines of a mesh, world mm. The same lines for every order of calls; one thread. `path` is used
 * in messages. Errors: those of iso_mesh_topology_make; ISO_ERR_EMPTY: no piece is made of thin branches
 * or is a leaf, and the text says why the largest is not. */
iso_status iso_mesh_lines_make(const char *path, const iso_triangles *mesh, iso_mesh_lines *made,
                               iso_error *error);
void iso_mesh_lines_free(iso_mesh_lines *lines);

#endif
