/* isopoint_clouds: the chapter of isopoint.h about points that no volume gives: scans, particles, 3-D
 * Gaussians. isopoint.h includes it; what that file says of units, errors, ownership and threads holds here
 * too.
 *
 * A cloud is a surface without a volume. It is drawn as discs by the methods SPLATS, DISCS, PULLPUSH and the
 * others that draw points, with surfaces of volumes and shapes beside it; 3-D Gaussians are drawn as such,
 * whatever the method, and are the first surface of their picture. iso_surface_points, iso_surface_bounds and
 * iso_surface_write_points are for clouds, too; what needs a volume refuses them with ISO_ERR_USAGE. */
#ifndef ISOPOINT_CLOUDS_H
#define ISOPOINT_CLOUDS_H

#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Points in the caller's arrays; world coordinates in mm. */
typedef struct iso_cloud_arrays {
    size_t count;
    const float *positions; /* count x 3 */
    double origin[3];       /* added to every position: positions far from 0 keep their precision */
    const float *normals; /* count x 3, of any length. NULL, or one of length 0: estimated from neighbours */
    const float *radii;   /* of discs. NULL, or one that is not above 0: estimated from neighbours */
    const float *axes; /* count x 9: makes them 3-D Gaussians. The three axes of an ellipsoid, one after the
                               other, with its standard deviations as lengths; NULL: discs */
    const uint8_t *colors; /* count x 3: red green blue, display values; NULL: the colour of the options */
    const float
        *opacities; /* 0 .. 1, of Gaussians at their centres; NULL: opaque. Those of discs are drawn by
                               the method SPLATS; others draw them opaque */
} iso_cloud_arrays;

typedef struct iso_surface_cloud_opts {
    double radius;           /* mm, of all discs; 0: those of the cloud, or estimated ones */
    bool estimate_normals;   /* also where the cloud has normals */
    bool estimate_radii;     /* also where the cloud has radii */
    bool gaussians_as_discs; /* of a file of 3-D Gaussians: its discs are drawn */
    const iso_rgb *color;    /* copied; NULL: the cloud's colours, else one of a small palette */
    double opacity;          /* as of iso_surface_opts, of discs without opacities of their own */
    int threads;             /* as of iso_open_opts, for the surface */
} iso_surface_cloud_opts;

/* Makes a surface of points: copies the arrays, and estimates what they lack (Hoppe et al. 1992 for normals).
 * Free it with iso_surface_destroy. ISO_ERR_USAGE: an option is out of range, or Gaussians lack opacities
 * between 0 and 1; ISO_ERR_EMPTY: no points, or none with finite coordinates; ISO_ERR_LIMIT: 2^31 or more. */
ISO_API iso_status iso_surface_of_cloud(const iso_cloud_arrays *cloud, const iso_surface_cloud_opts *opts,
                                        iso_surface **surface, iso_error *error);
/* The same of a file of points: .ply (also 3-D Gaussians), .las, .laz, .pcd, .xyz, .csv and others
 * (docs/formats.md). ISO_ERR_IO, ISO_ERR_FORMAT, and those above. */
ISO_API iso_status iso_surface_read_cloud(const char *path, const iso_surface_cloud_opts *opts,
                                          iso_surface **surface, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
