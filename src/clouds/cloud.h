/* clouds: makes points that renderers draw of points that were read from a file: every point gets a normal
 * and a radius, those that the file lacks are estimated from its neighbours, and the points are sorted into
 * spans by their places. */
#ifndef ISO_CLOUDS_CLOUD_H
#define ISO_CLOUDS_CLOUD_H

#include "base/primitives.h"
#include "clouds/point_source.h"

/* All zero means the default. */
typedef struct iso_cloud_opts {
    double radius;         /* of all points, mm; 0: those of the file, or estimated ones */
    bool estimate_radii;   /* also if the file has radii */
    bool estimate_normals; /* also if the file has normals */
    bool without_normals;  /* only places are needed: normals that the file lacks stay 0 */
    iso_pool *pool;        /* or NULL */
} iso_cloud_opts;

/* Points of a file. Zero-initialise; free with iso_cloud_free. */
typedef struct iso_cloud {
    iso_surfel *surfels;   /* owned, as all arrays; positions in voxels, as iso_point_view describes them */
    float *radii;          /* mm; NULL: all points have `radius`, which was given */
    uint8_t (*colors)[3];  /* NULL: the file has none */
    uint8_t *opacities;    /* NULL: all points are opaque */
    iso_point_span *spans; /* in ascending order of z, then y, then x of their bricks */
    iso_point_bounds *bounds; /* of each span */
    size_t span_count, count;
    iso_transform transform; /* cubic voxels, about as large as the distances between points */
    double radius;           /* the median of the radii, mm */
    bool closed;             /* as in iso_point_view: the file says so, and has the normals */
    size_t estimated_normals, estimated_radii; /* how many of the points have them */
} iso_cloud;

/* Makes a cloud of glyphs, whose directions are taken as normals. A normal that is 0 or not finite is
 * estimated (clouds/normals.h), and so is a radius that is not above 0 and at most 100 times the median
 * (clouds/radii.h), at most a 20th of the bounds' diagonal; points that are all at the same place get 1 mm.
 * Of more than a dozen points at one place without radii of their own all but a few get a radius of nearly 0.
 *
 * `glyphs` is borrowed for the call. Takes about 90 bytes for each point if something is estimated, in
 * addition to the cloud's 31. ISO_ERR_EMPTY: there are no points; ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^31
 * points or more. The same bytes for every number of threads. */
iso_status iso_cloud_make(const iso_glyphs *glyphs, const iso_cloud_opts *opts, iso_cloud *cloud,
                          iso_error *error);
/* Makes a cloud of points that have all they need: normals, and one radius (mm, above 0) for all. `survey`:
 * of these points, finite ones without missing normals. Takes little memory in addition to the cloud's.
 * ISO_ERR_NOMEM; ISO_ERR_IO: the source has changed since it was surveyed. The same bytes as iso_cloud_make
 * gives, for every number of threads. */
iso_status iso_cloud_make_of_source(const iso_point_source *source, const iso_point_survey *survey,
                                    double radius, iso_pool *pool, iso_cloud *cloud, iso_error *error);
void iso_cloud_free(iso_cloud *cloud);

/* Sets *spacing to the median distance of points to their nearest neighbours, in mm, of some thousands of
 * them; 0 if there is one point only, or if most have another at their place. ISO_ERR_NOMEM;
 * ISO_ERR_LIMIT as iso_cloud_make. */
iso_status iso_cloud_spacing(const iso_glyphs *glyphs, iso_pool *pool, double *spacing, iso_error *error);

/* A view of the cloud, which it borrows until iso_cloud_free. */
iso_point_view iso_cloud_view(const iso_cloud *cloud);

#endif
