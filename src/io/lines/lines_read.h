/* lines_read: reads lines: tracts, vessels, neurons, streamlines.
 *
 *   .tck    MRtrix3 tracks, 32 and 64 bit, both byte orders; RAS
 *   .trk    TrackVis tracks, versions 1 and 2, both byte orders, with scalars and properties; RAS
 *   .vtk    VTK's legacy polygonal data, versions 1 to 5, text and binary; arrays over points and lines
 *   .vtp    the same in XML: text, base64 and raw, with or without zlib
 *   .swc    neurons: radii; lines run from branch to branch; the column of types is an attribute
 *   .obj    elements l; colours behind the coordinates
 *   .ply    elements vertex and edge; lines run through all points with two edges
 *
 * .vtk, .vtp, .swc, .obj and .ply state no space and are taken as LPS, but for .vtk files of 3D Slicer, whose
 * title states it. Columns named radius, normals and colours fill the arrays of iso_lines; the others become
 * attributes. Vectors and tensors turn with the space.
 *
 * The format is found from the content, and from the name if the content does not tell. Vertices that are not
 * finite or beyond 1e12 mm are left out, and their line is split there; radii that are negative or not finite
 * become 0: the report counts both. */
#ifndef ISO_IO_LINES_LINES_READ_H
#define ISO_IO_LINES_LINES_READ_H

#include "base/lines.h"
#include "io/common/read_opts.h"

/* Reads lines; iso_lines_free when done. `opts` may be NULL. A file without lines is no error: line_count is
 * then 0. Errors: ISO_ERR_IO (missing, unreadable, shorter than it says), ISO_ERR_FORMAT (damaged, or not a
 * file of lines), ISO_ERR_UNSUPPORTED, ISO_ERR_LIMIT (over max_memory, checked before memory is allocated),
 * ISO_ERR_NOMEM. Each text names the file. Thread-safe for different reports and file sets. */
iso_status iso_lines_read(const char *path, const iso_read_opts *opts, iso_lines *lines, iso_error *error);

/* Whether a .vtk file holds polygonal data, judged by the first KiB of a regular file; others hold volumes or
 * grids of other kinds. */
bool iso_lines_fill_vtk(const char *path);

#endif
