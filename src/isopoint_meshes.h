/* isopoint_meshes: the chapter of isopoint.h about meshes of surfaces for other programs and for printing:
 * smoother, with fewer triangles, closed, hollow. isopoint.h includes it; what that file says of units,
 * errors, ownership and threads holds here too. Pictures are not changed by any of it. */
#ifndef ISOPOINT_MESHES_H
#define ISOPOINT_MESHES_H

#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_SMOOTH_MOST = 10000 };

/* How the mesh of a surface is made, in this order: the solid is closed and made hollow, its Marching Cubes
 * mesh is smoothed, and its triangles are joined. All zero, or NULL: as iso_surface_mesh makes it. Closed
 * meshes stay closed. */
typedef struct iso_surface_mesh_opts {
    /* The solid ends at the volume's border, where it gets flat caps; voxels that are no numbers are
     * outside. */
    bool closed;
    double hollow; /* thickness, mm, of the wall that is left of the solid, measured from the trilinear
                      surface; the solid is closed before. 0: it is not hollow */
    double drain;  /* diameter, mm, of two holes through the wall, along `up`, at the lowest and the highest
                      place of the hollow; 0: none */
    iso_vec3 up;   /* of any length; 0: z */
    int smooth;    /* iterations of Taubin's filter (1995, "A signal processing approach to fair surface
                      design"), which keeps the volume; 0 .. ISO_SMOOTH_MOST */
    /* Triangles are joined in the order of their quadric errors (Garland and Heckbert 1997), with
     * meshoptimizer, until this share of them is left, below 1, or as long as the surface moves by about so
     * many mm at most; 0: not given. One of the two, or none. */
    double keep, deviation;
} iso_surface_mesh_opts;

/* As iso_surface_mesh and iso_surface_write_mesh, and the same as isorender's --closed, --hollow, --drain,
 * --smooth-mesh and --decimate. The surface, its volume and its pictures stay as they are; the closed or
 * hollow solid is made anew by each call. ISO_ERR_USAGE: an option is out of range, or the surface is a
 * cloud; ISO_ERR_EMPTY: the solid is nowhere thicker than two walls; ISO_ERR_BACKEND: triangles cannot be
 * joined, because the library was built without meshoptimizer; ISO_ERR_LIMIT: the closed or hollow solid has
 * too many voxels along an axis; ISO_ERR_NOMEM. */
ISO_API iso_status iso_surface_mesh_with(iso_surface *surface, const iso_surface_mesh_opts *opts,
                                         iso_mesh *mesh, iso_error *error);
ISO_API iso_status iso_surface_write_mesh_with(iso_surface *surface, const iso_surface_mesh_opts *opts,
                                               const char *path, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
