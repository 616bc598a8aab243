/* level_set: converts meshes, lines and grids to level sets, resizes level sets, and writes them to .vdb
 * files. */
#ifndef ISO_GRIDS_LEVEL_SET_H
#define ISO_GRIDS_LEVEL_SET_H

#include <stdio.h>

#include "base/lines.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "grids/closing/closed_mesh.h"
#include "grids/grid.h"

/* Writes a .vdb file with a grid of class "level set", as OpenVDB's tools, Blender and Houdini read it:
 * floats, distances in mm, background band * voxel size, and the grid's transform. `name` is the name of the
 * grid in the file. The file appears whole or not at all. ISO_ERR_USAGE: the voxels are not cubes;
 * ISO_ERR_WRITE; ISO_ERR_UNSUPPORTED: OpenVDB's module is missing; ISO_ERR_IO: cancelled through `progress`.
 */
iso_status iso_level_set_write_vdb(const char *path, const iso_hgrid *grid, const char *name,
                                   const iso_progress *progress, iso_error *error);

/* Colours of a level set's voxels. */
typedef struct iso_level_set_colors {
    const void *const
        *cell; /* by cell: ISO_BRICK_VOXELS words as of a brick, sRGB with red in the lowest byte,
                                and in the highest how much it covers `own`; NULL: nothing covers it */
    uint8_t own[3];
} iso_level_set_colors;

/* The same to a stream of the caller, and with colours (NULL: none) as a second grid "Cd" of vectors: linear
 * red, green and blue, as Houdini and Blender read them. `path` is used in messages. Errors of the stream are
 * the caller's to find (iso_sink_commit). */
iso_status iso_level_set_put_vdb(FILE *stream, const char *path, const iso_hgrid *grid, const char *name,
                                 const iso_level_set_colors *colors, const iso_progress *progress,
                                 iso_error *error);

/* Receives the colours of a .vdb file. The colours of a cell are words as of iso_level_set_colors, each of
 * which covers all or nothing. */
typedef struct iso_color_receiver {
    void *context;
    /* Once, before the cells: where the voxels lie, how many cells there are along each axis, and the colour
     * of voxels that have none. */
    iso_status (*begin)(void *context, const iso_transform *transform, const int cells[3],
                        const uint8_t own[3], iso_error *error);
    /* A cell that has colours, of ISO_BRICK_VOXELS voxels. */
    iso_status (*cell)(void *context, size_t cell, const uint32_t *colors, iso_error *error);
} iso_color_receiver;

struct iso_volume_opts;
/* Reads the grid "Cd" of a .vdb file (iso_level_set_put_vdb), of vectors of floats. Where the file has none,
 * nothing is received. opts: max_memory counts; or NULL. Errors: those of iso_volume_read and of the
 * receiver. */
iso_status iso_level_set_read_colors(const char *path, const struct iso_volume_opts *opts,
                                     const iso_color_receiver *to, iso_error *error);

/* The grid that a mesh or lines are sampled in: whole bricks of cubic voxels along the world's axes, with
 * their box in the middle and at least `margin` voxels around it. */
typedef struct iso_sampling {
    double voxel;                 /* voxel size, mm */
    int margin;                   /* voxels */
    iso_pool *pool;               /* borrowed; NULL: the calling thread */
    const iso_progress *progress; /* called from any thread; cancelled: ISO_ERR_IO */
} iso_sampling;

/* Creates the empty grid for a box (world). `path` is used in messages. ISO_ERR_USAGE: the voxel size is not
 * above 0; ISO_ERR_LIMIT: the grid would be too large; ISO_ERR_NOMEM. */
iso_status iso_level_set_around(const char *path, const iso_box *box, const iso_sampling *sampling,
                                iso_hgrid **grid, iso_error *error);

/* Converts the solid that a mesh encloses (grids/closing/closed_mesh.h) to a level set with a band of 3
 * voxels. The result does not depend on the number of threads. Each voxel of the band takes a search in the
 * mesh's tree, O(log n) for n triangles. `path` is used in messages.
 *
 * The volume of the result is compared with the mesh's. ISO_ERR_EMPTY: less than half of it would be left,
 * because the voxels are too large for thin parts; ISO_ERR_FORMAT: the two differ by more than the voxel size
 * explains; ISO_ERR_LIMIT: the grid would be too large; ISO_ERR_NOMEM. */
iso_status iso_level_set_from_mesh(const char *path, const iso_closed_mesh *mesh,
                                   const iso_sampling *sampling, iso_hgrid **grid, iso_error *error);

/* Converts lines to the level set of the tubes around them. A tube is a chain of rounded cones with the radii
 * of the vertices, or `radius` mm if the lines have none. Radii below ISO_TUBE_VOXELS voxels are enlarged to
 * it, so that no tube is lost between voxels; *widened (may be NULL) receives the number of such vertices.
 * Where tubes overlap, distances inside them are too small; iso_field_redistance corrects them.
 * ISO_ERR_EMPTY: no vertex is usable; errors of iso_level_set_around; ISO_ERR_IO: cancelled. */
#define ISO_TUBE_VOXELS 1.0
iso_status iso_level_set_from_lines(const char *path, const iso_lines *lines, double radius,
                                    const iso_sampling *sampling, iso_hgrid **grid, size_t *widened,
                                    iso_error *error);

/* How a grid is converted to a level set. */
typedef struct iso_resampling {
    double isovalue;              /* stored value; of an hgrid a distance in voxels */
    double voxel;                 /* voxel size, mm; 0: the grid's smallest spacing */
    int margin;                   /* voxels to add on each side of the grid */
    iso_pool *pool;               /* borrowed; NULL: the calling thread */
    const iso_progress *progress; /* called from any thread; cancelled: ISO_ERR_IO */
} iso_resampling;

/* Samples any grid at any voxel size as the start of a level set: cubic voxels along the grid's own axes,
 * whole bricks, a band of 3. Inside is at or above the isovalue (below it for a level set); positions beyond
 * the grid and values that are not finite are outside. Voxels hold the value minus the isovalue, multiplied
 * by one common factor and clamped below the band: the result must be redistanced to become a distance field
 * (sculpt/field). `path` is used in messages. ISO_ERR_EMPTY: nothing is inside, or nothing outside;
 * ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_level_set_from_grid(const char *path, const iso_grid *from, const iso_resampling *how,
                                   iso_hgrid **grid, iso_error *error);

/* Creates a grid of `dims` voxels whose voxel i is voxel i - offset of `from`, at the same world position.
 * Beyond `from` its outermost voxels are repeated; if none of them is inside, so that the surface ends within
 * `from`, the distance from them is added. Errors: those of iso_hgrid_create. */
iso_status iso_level_set_resize(const iso_hgrid *from, const int offset[3], const int dims[3],
                                iso_hgrid **out, iso_error *error);

#endif
