/* raster: draws points and meshes into a gbuffer, on the cpu.
 *
 * Each call draws one surface with a depth test: a sample is replaced when the new depth is smaller. Of
 * equal depths the earlier surface is kept, and within a surface the earlier primitive, so that pictures
 * do not depend on threads. The view must have the gbuffer's size. Errors: ISO_ERR_NOMEM; ISO_ERR_LIMIT
 * when a view has more than 2^32 - 1 surfels. */
#ifndef ISO_RENDER_RASTER_RASTER_H
#define ISO_RENDER_RASTER_RASTER_H

#include "base/parallel.h"
#include "base/primitives.h"
#include "image/camera.h"
#include "render/view/clip.h"
#include "render/view/gbuffer.h"

/* What a renderer draws into. All members are borrowed for the call. */
typedef struct iso_target {
    const iso_view *view;
    iso_gbuffer *gbuffer;
    iso_pool *pool;  /* NULL: the calling thread */
    uint8_t surface; /* number that marks the surface in the gbuffer */
    /* What is cut away of the surface; NULL: nothing. For the methods that can do it (ISO_CAN_CLIP). */
    const iso_clip *clip;
} iso_target;

/* Attenuated points (Baerentzen and Christensen 2003, section 4.1): each point is a disc parallel to the
 * image plane with the point's radius (mm), projected by its depth z (eq. 3-4, not by the distance to the
 * eye). It covers at least the pixel that contains its centre. Depth and normal are the point's. Points
 * nearer than view->near are left out. */
iso_status iso_draw_points(const iso_target *target, const iso_point_view *points, iso_error *error);

/* Triangles, drawn from both sides: vertices are snapped to 1/256 pixel, filled by the top-left rule and
 * clipped at the near plane; depth and normal are interpolated with perspective correction. If the gbuffer
 * has a plane of elements, it gets the numbers of the triangles in mesh->triangles. */
iso_status iso_draw_mesh(const iso_target *target, const iso_mesh_view *mesh, iso_error *error);

#endif
