/* gl: a viewport's pictures by OpenGL. Keeps points and mesh in buffers on the GPU, which follow edits, and
 * leaves pictures there, for a window that shares the context. Knows nothing of windows. All functions are
 * called from the thread that the context is current in. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_GL_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_GL_H

#include "base/c_linkage.h"
#include "render/gl/canvas.h"

ISO_C_BEGIN

typedef struct isosculpt_gl isosculpt_gl;

/* The context is borrowed until destroy. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_gl_create(iso_gl_context *context, isosculpt_gl **gl, iso_error *error);
void isosculpt_gl_destroy(isosculpt_gl *gl); /* NULL is fine */

/* Frees the buffers of points and mesh. Call it before drawing another point set or mesh set than before.
 * NULL is fine. */
void isosculpt_gl_release_buffers(isosculpt_gl *gl);

/* The driver's name for the GPU or the software renderer. */
const char *isosculpt_gl_renderer(const isosculpt_gl *gl);

/* Uploads the spans that have changed, and draws. *canvas receives the canvas with the picture; it is
 * borrowed, and the next drawing reuses it. Errors: those of iso_gl_canvas_draw and of the uploads. */
iso_status isosculpt_gl_draw_mesh(isosculpt_gl *gl, const iso_mesh_view *mesh, const iso_view *view,
                                  const iso_gl_paint *paint, iso_gl_canvas **canvas, iso_error *error);
/* Like isosculpt_gl_draw_mesh, for points. `reconstruction` NULL: each point is drawn as a disc parallel to
 * the picture (the method points). */
iso_status isosculpt_gl_draw_points(isosculpt_gl *gl, const iso_point_view *points,
                                    const iso_reconstruction *reconstruction, const iso_view *view,
                                    const iso_gl_paint *paint, iso_gl_canvas **canvas, iso_error *error);

/* Copies depth and normals of the last picture, so that picks keep working on it while newer pictures are
 * drawn. *pick_buffer is borrowed; the next call overwrites it. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_gl_keep_pick_buffer(isosculpt_gl *gl, iso_gl_canvas **pick_buffer, iso_error *error);

ISO_C_END
#endif
