/* cloud: points of files or arrays as a surface: made ready for drawing, with the box that pictures of them
 * frame. */
#ifndef ISO_SCENE_CLOUD_H
#define ISO_SCENE_CLOUD_H

#include "clouds/cloud.h"
#include "scene/loader.h"

/* Zero-initialise; iso_cloud_free(&discs) when done. */
typedef struct iso_scene_cloud {
    iso_cloud discs;
    iso_box frame;  /* of the points but those that lie far from the others, */
    size_t outside; /* and how many of these there are */
} iso_scene_cloud;

/* Makes discs of points. Of 3-D Gaussians that are drawn as such (`gaussians`) they only say where they are.
 * Errors of iso_cloud_make. */
iso_status iso_scene_cloud_make(iso_scene_cloud *cloud, const iso_glyphs *points, bool gaussians,
                                const iso_cloud_opts *opts, iso_error *error);

/* Makes discs of a file without reading its points into memory first, which saves most of the time of large
 * ones. radius: of all, mm. *made: false if that is not possible, and nothing is done. Errors of
 * iso_cloud_make_of_source. */
iso_status iso_scene_cloud_map(iso_scene_cloud *cloud, iso_loader *loader, double radius, bool *made,
                               iso_error *error);

#endif
