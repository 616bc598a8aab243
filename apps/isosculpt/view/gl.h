/* gl: a view's pictures by OpenGL. Buffers on the GPU follow the points and the mesh; pictures stay there,
 * for a window that shares the context. Knows no window. */
#ifndef ISO_APPS_ISOSCULPT_VIEW_GL_H
#define ISO_APPS_ISOSCULPT_VIEW_GL_H

#include "render/gl/canvas.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct isosculpt_gl isosculpt_gl;

/* Keeps the context. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_gl_create(iso_gl_context *context, isosculpt_gl **gl, iso_error *error);
void isosculpt_gl_destroy(isosculpt_gl *gl); /* NULL is fine */

/* Another field's points and mesh come next. NULL is fine. */
void isosculpt_gl_release_buffers(isosculpt_gl *gl);

/* The GPU's name, or the software's. */
const char *isosculpt_gl_renderer(const isosculpt_gl *gl);

/* Brings the buffers up to date with what the stamps say, and draws. *canvas is ours: the picture that was
 * drawn last. Errors: those of iso_gl_canvas_draw and of updates. */
iso_status isosculpt_gl_draw_mesh(isosculpt_gl *gl, const iso_mesh_view *mesh, const iso_view *view,
                                  const iso_gl_paint *paint, iso_gl_canvas **canvas, iso_error *error);
/* `pullpush`: filled in image space; else discs. */
iso_status isosculpt_gl_draw_points(isosculpt_gl *gl, const iso_point_view *points, bool pullpush,
                                    const iso_view *view, const iso_gl_paint *paint, iso_gl_canvas **canvas,
                                    iso_error *error);

/* Keeps what can be picked from the last picture; *held is ours. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_gl_keep_pick_layer(isosculpt_gl *gl, iso_gl_canvas **pick_layer, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
