/* isopoint_lines: the chapter of isopoint.h about meshes of thin branches (trees, vessels, neurites), which
 * become lines: tubes with a radius at every vertex, and ribbons for leaves (Marroquim, Kraus and Cavalcanti
 * 2008, section 4.3). isopoint.h includes it; what that file says of units, errors, ownership and threads
 * holds here too.
 *
 * As in the paper, each ring of vertices around a branch becomes a vertex of a line, in the middle of the
 * ring, with the mean distance of the ring's vertices (in the paper the greatest) as radius. Where branches
 * join, the two that best continue each other are one line. */
#ifndef ISOPOINT_LINES_H
#define ISOPOINT_LINES_H

#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a mesh has become, world coordinates, mm. For iso_shape_set_of_lines: `tubes` and, with opts.ribbons,
 * `ribbons`; for iso_shape_set_of_mesh: `rest`. The arrays are owned: iso_branches_free. */
typedef struct iso_branches {
    iso_line_arrays tubes;   /* with radii; line_count 0: there are none */
    iso_line_arrays ribbons; /* with radii, half their widths, and normals; the same */
    iso_mesh rest; /* the pieces that are neither, without normals; triangle_count 0: there are none */
    size_t pieces, tube_pieces, ribbon_pieces; /* of the mesh, which are its connected components */
    size_t left_out;                           /* triangles that are degenerate, or there twice */
} iso_branches;

/* Makes lines of a mesh, whose normals are not used, or of the mesh in a file, whose coordinates are RAS if
 * `ras` says so. One thread. ISO_ERR_EMPTY: no triangles, or no piece is made of thin branches or is a leaf:
 * the text says why the largest is not. ISO_ERR_USAGE, ISO_ERR_LIMIT: as of iso_shape_set_of_mesh. Of files
 * also ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_UNSUPPORTED. */
ISO_API iso_status iso_branches_of_mesh(const iso_mesh *mesh, iso_branches *branches, iso_error *error);
ISO_API iso_status iso_branches_read(const char *path, bool ras, iso_branches *branches, iso_error *error);
/* Frees the arrays and zeroes the struct. A zeroed struct is allowed. */
ISO_API void iso_branches_free(iso_branches *branches);

#ifdef __cplusplus
}
#endif
#endif
