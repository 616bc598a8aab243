/* hybrid: render/pullpush/hybrid.h by OpenGL: points by pull-push, and triangles, which the rasterizer draws
 * into a texture as large as the pyramid. */
#ifndef ISO_RENDER_GL_HYBRID_H
#define ISO_RENDER_GL_HYBRID_H

#include "render/gl/pullpush.h"
#include "render/pullpush/polygon_fragments.h"

/* Draws one surface from its edge points and its mesh over the picture that the target's gbuffer holds: what
 * iso_draw_hybrid draws, except for rounding; the same bytes every time. Uploads the bricks for this picture.
 * Errors: those of iso_gl_upload_points and iso_gl_draw_pullpush. */
iso_status iso_gl_draw_hybrid(iso_gl_engine *engine, const iso_target *target, const iso_point_view *points,
                              const iso_mesh_view *mesh, iso_error *error);

/* Inside render/gl: the triangles of a hybrid surface, between the steps of pull-push. */
struct iso_gl_triangles {
    const iso_gl_surface *mesh;
    const iso_brick_choice *choice;
    double radius;                    /* of the points' discs, mm */
    double to_index[9], to_normal[9]; /* from view space, without the origin; of normals */
};

/* Draws the triangles into the engine's framebuffer, and adds those at the seam to the keys of the base
 * level, which is 0; then, to the picture, all of them. The uniforms of pull-push are bound. */
iso_status iso_gl_triangles_add(iso_gl_engine *engine, const iso_gl_triangles *triangles,
                                const iso_view *view, const iso_pyramid_layout *layout, iso_error *error);
iso_status iso_gl_triangles_finish(iso_gl_engine *engine, const iso_view *view, iso_error *error);

#endif
