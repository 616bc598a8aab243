/* canvas: a picture that stays on the GPU. Its colours are a texture for a window that shares the context;
 * its samples (normal and depth of each pixel) answer what lies under a cursor. */
#ifndef ISO_RENDER_GL_CANVAS_H
#define ISO_RENDER_GL_CANVAS_H

#include "image/image.h"
#include "render/gl/pullpush.h"
#include "render/shading/shading.h"

typedef struct iso_gl_canvas iso_gl_canvas;

/* An empty canvas. The engine is borrowed and must outlive the canvas. ISO_ERR_NOMEM. */
iso_status iso_gl_canvas_create(iso_gl_engine *engine, iso_gl_canvas **canvas, iso_error *error);
void iso_gl_canvas_destroy(iso_gl_canvas *canvas); /* NULL is fine */

/* How a canvas is shaded. */
typedef struct iso_gl_paint {
    int factor; /* a pixel is factor x factor samples, 1 .. ISO_FACTOR_MAX */
    iso_rgb color, background;
    /* NULL: the Phong model of render/shading/shading.h. Otherwise a matcap: a picture of a lit sphere,
     * sphere_side x sphere_side pixels of red, green, blue, indexed by a normal's x and y from -1 to 1. */
    const uint8_t *sphere;
    int sphere_side;
} iso_gl_paint;

/* Draw like iso_gl_draw and iso_gl_draw_pullpush, shade the picture and leave it in the canvas, which is
 * resized to view size / factor; the view's size must be a multiple of the factor. With factor 1 the
 * picture's samples are stored too; with a larger one the samples of the last picture of the same size
 * stay. Both wait for the GPU. Errors: those of the two functions; the canvas is then empty. */
iso_status iso_gl_canvas_draw(iso_gl_canvas *canvas, const iso_gl_draw_opts *opts, const iso_gl_paint *paint,
                              iso_error *error);
iso_status iso_gl_canvas_draw_pullpush(iso_gl_canvas *canvas, const iso_gl_pullpush_opts *opts,
                                       const iso_gl_paint *paint, iso_error *error);

/* OpenGL name of the colour texture (GL_RGBA8, upper row first), valid until the next draw. 0: the canvas is
 * empty. */
unsigned iso_gl_canvas_texture(const iso_gl_canvas *canvas);

/* View space normal and depth (mm) of the sample stored for a pixel. False: the pixel shows no surface, or
 * lies outside the canvas. */
bool iso_gl_canvas_pick(const iso_gl_canvas *canvas, int x, int y, float normal_depth[4]);

/* Resizes `to` like `from` and copies the samples. The colours of `to` are undefined afterwards.
 * ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_canvas_copy(iso_gl_canvas *to, const iso_gl_canvas *from, iso_error *error);

/* Reads the colours back into an image of the canvas's size. */
iso_status iso_gl_canvas_read(const iso_gl_canvas *canvas, iso_image *image, iso_error *error);

#endif
