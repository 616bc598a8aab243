/* draw: points and meshes into a gbuffer, in plain C on the cpu.
 *
 * Each call draws one surface over what is there: a sample is replaced when the new depth is smaller (equal
 * depths: the earlier surface, then the earlier primitive, stays), so pictures do not depend on threads. The
 * view's size must be the gbuffer's. Errors: ISO_ERR_NOMEM. */
#ifndef ISO_RENDER_RASTER_RASTER_H
#define ISO_RENDER_RASTER_RASTER_H

#include "base/parallel.h"
#include "base/primitives.h"
#include "image/camera.h"
#include "render/gbuffer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where a draw goes. All borrowed for the call. */
typedef struct iso_target {
    const iso_view *view;
    iso_gbuffer *gbuffer;
    iso_pool *pool;  /* NULL: the calling thread */
    uint8_t surface; /* number written into the gbuffer */
} iso_target;

/* Attenuated points (2003, section 4.1): each point is a disc that faces the picture, of diameter 2 * radius
 * in world size, scaled by the exact perspective of eq. 3-4 (depth z, not distance), at least the
 * pixel that its centre lies in; depth and normal are the point's. Points nearer than view->near are left
 * out. */
iso_status iso_draw_points(const iso_target *target, const iso_point_view *points, iso_error *error);

/* Triangles: vertices snapped to 1/256 pixel, top-left fill rule, clipped at the near plane; depth and normal
 * interpolated with perspective correction. Both sides are drawn. */
iso_status iso_draw_mesh(const iso_target *target, const iso_mesh_view *mesh, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
