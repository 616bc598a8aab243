/* groups: render/groups/groups.h by OpenGL: compute shaders draw discs into slots and resolve them. The
 * discs are projected by the cpu for every picture and uploaded. */
#ifndef ISO_RENDER_GL_GROUPS_H
#define ISO_RENDER_GL_GROUPS_H

#include "render/gl/engine.h"
#include "render/groups/disc_layers.h"

/* Points and their groups (with discs of ISO_GROUPS_DISC); borrowed for the call. */
typedef struct iso_gl_grouped_points {
    iso_point_view points;
    const iso_groups *groups;
} iso_gl_grouped_points;

typedef struct iso_gl_draw_groups_opts {
    const iso_view *view;                  /* borrowed */
    const iso_gl_grouped_points *surfaces; /* surfaces[i] gets surface number i in the gbuffer */
    int surface_count;
    iso_pool *pool; /* or NULL */
    int bins;       /* as in iso_draw_groups_opts */
} iso_gl_draw_groups_opts;

/* Draws all surfaces and fills the whole gbuffer, which must have the view's size: what iso_draw_groups
 * draws, except for rounding, which can move a depth to another bin; the same bytes every time. Errors:
 * ISO_ERR_NOMEM, ISO_ERR_LIMIT (the driver's storage buffers cannot hold a strip of the picture, or the
 * discs), ISO_ERR_BACKEND; the gbuffer is then undefined. */
iso_status iso_gl_draw_groups(iso_gl_engine *engine, const iso_gl_draw_groups_opts *opts,
                              iso_gbuffer *gbuffer, iso_error *error);

/* iso_shade_splat_layers (render/groups/disc_layers.h): the layers are found by OpenGL, and composited by the
 * cpu, with opaque objects and the background. Differs from the cpu's by rounding only; the same bytes every
 * time. Errors as there, ISO_ERR_LIMIT also if the discs, or the hits of a row of samples, do not fit into a
 * storage buffer, and ISO_ERR_BACKEND. */
iso_status iso_gl_shade_splat_layers(iso_gl_engine *engine, const iso_splat_layers *input,
                                     iso_layer_totals *totals, iso_error *error);

/* About how many bytes of GPU memory (of main memory with a software renderer) drawing takes for a picture
 * of this size, without the discs. */
uint64_t iso_gl_groups_bytes(const iso_gl_engine *engine, int slots, int width, int height);

#endif
