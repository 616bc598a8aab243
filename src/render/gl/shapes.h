/* shapes: lines and glyphs by OpenGL: render/shapes/shapes.h with a quad for each shape, its exact box in the
 * picture, and in each pixel the same equations. */
#ifndef ISO_RENDER_GL_SHAPES_H
#define ISO_RENDER_GL_SHAPES_H

#include "render/gl/engine.h"
#include "render/shapes/shapes.h"

/* A set of shapes in GPU memory. */
typedef struct iso_gl_shapes iso_gl_shapes;

/* Uploads a set. The set and the engine are borrowed and must outlive the result. Errors: ISO_ERR_NOMEM;
 * ISO_ERR_LIMIT (the set is larger than the driver's storage buffers, or than free main memory with a
 * software renderer); ISO_ERR_BACKEND. */
iso_status iso_gl_upload_shapes(iso_gl_engine *engine, const iso_shapes *shapes, iso_gl_shapes **uploaded,
                                iso_error *error);
void iso_gl_shapes_destroy(iso_gl_shapes *shapes); /* NULL is fine */

typedef struct iso_gl_shapes_opts {
    const iso_view *view;             /* borrowed */
    const iso_gl_shapes *const *sets; /* sets[i] gets surface number first_surface + i */
    int set_count, first_surface;
} iso_gl_shapes_opts;

/* Draws all sets into a gbuffer of the view's size, as iso_draw_shapes does, except for rounding: a sample is
 * replaced when a shape is nearer than what it shows. `drawn`: NULL, or set_count items, to which the samples
 * are added that show the set when all are drawn. Errors: ISO_ERR_NOMEM, ISO_ERR_BACKEND; the gbuffer is then
 * undefined. */
iso_status iso_gl_draw_shapes(iso_gl_engine *engine, const iso_gl_shapes_opts *opts, iso_gbuffer *gbuffer,
                              iso_shapes_drawn *drawn, iso_error *error);

/* Bytes of GPU memory (of main memory with a software renderer) that drawing takes for a picture of
 * width x height samples, without the sets. */
uint64_t iso_gl_shapes_bytes(const iso_gl_engine *engine, int width, int height);

#endif
