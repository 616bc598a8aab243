/* glyphs_read: reads points with sizes and directions: molecules, particles, splats, tensors, scans.
 *
 *   .ply    vertices: radius; or scale_0 .. 2 and rot_0 .. 3; nx ny nz or vx vy vz; red green blue
 *   .vtk    VTK's legacy polygonal data: points with their arrays
 *   .vtp    the same in XML
 *   .xyz    molecules (the first frame), or rows of points as below
 *   .pdb    molecules: the first model, the first of alternate locations, and the copies that the first
 *           assembly (REMARK 350) makes of the chains
 *   .csv    a row of names with x y z, then numbers, or words that are numbered
 *   .pcd    the Point Cloud Library's: as text, binary, or compressed; rgb and rgba are packed colours
 *   .las    scans from the air and the ground, LAS 1.0 to 1.4, point formats 0 to 10, extra bytes, the unit
 *   .laz    the same, compressed by any LASzip from 1 to 3; and COPC, all of its points
 *   .e57    scans of scanners (ASTM E2807), all of a file by their poses, in metres; not their images
 *   .pts .asc .txt  points as rows of 3 to 10 numbers between blanks, commas or semicolons; before them, if
 *           they are there, the number of points and a row of names; # and // begin comments
 *   .pwn    the same; or the number of points, their positions, and then as many normals (CGAL's)
 *   .npy    arrays of NumPy: N x 3 .. 10 integers, floats or doubles, of either byte order
 *   .off    Geomview's, as text, with normals and colours of vertices (NOFF, COFF)
 *   .obj    Wavefront's vertices, with colours behind the coordinates; vn, if there is one for each vertex
 *
 * The points of .ply, .off and .obj may be the vertices of a mesh: normals are then made from its faces if
 * opts->normals_from_faces is set.
 *
 * Where numbers have no names, they are decided to be normals, colours or intensities from their values; a
 * note tells (point_columns.h). opts->columns names them instead.
 *
 * Files of 3-D Gaussians (.ply with f_dc_0 .. 2, scale_0 .. 2, rot_0 .. 3 and opacity, as 3DGS trainers write
 * them; flat ones without scale_2; SuperSplat's packed ones) are recognised: iso_glyphs.gaussians. Their
 * colours are those without a direction.
 *
 * Atoms have van der Waals radii and colours by element; an ångström is a millimetre of the world. Columns
 * that fill no array of iso_glyphs become attributes; of directions, vx vy vz precede nx ny nz. Other names
 * of nx ny nz and red green blue are normal_x .. and r g b. Colours of 16 bits become 8, but those of .las
 * and .pcd stay as they are if none is above 255. None of the formats states a space: LPS, but for .vtk files
 * of 3D Slicer, whose title states it.
 *
 * The format is found from the content, and from the name if the content does not tell. Glyphs with a
 * position that is not finite or beyond 1e12 mm are left out, as are many at exactly 0 0 0 among others;
 * radii and half axes that are negative or not finite become 0: the report counts both. */
#ifndef ISO_IO_GLYPHS_GLYPHS_READ_H
#define ISO_IO_GLYPHS_GLYPHS_READ_H

#include "base/glyphs.h"
#include "io/common/read_opts.h"

/* Reads glyphs; iso_glyphs_free when done. `opts` may be NULL. A file without points is no error: count is
 * then 0. Errors as iso_lines_read; ISO_ERR_USAGE: no such assembly. Thread-safe for different reports and
 * file sets. */
iso_status iso_glyphs_read(const char *path, const iso_read_opts *opts, iso_glyphs *glyphs, iso_error *error);

/* Whether a file is a .ply of 3-D Gaussians, judged by the names of its vertices' properties (f_dc_0,
 * scale_0, rot_0, opacity). False if it cannot be read. */
bool iso_glyphs_are_gaussians(const char *path);

#endif
