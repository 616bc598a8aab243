/* canvas: a picture that stays on the GPU: its colours, for a window that shares the context, and its
 * samples, for a cursor. */
#ifndef ISO_RENDER_GL_CANVAS_H
#define ISO_RENDER_GL_CANVAS_H

#include "image/image.h"
#include "render/gl/pullpush.h"
#include "render/shading/shading.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_gl_canvas iso_gl_canvas;

/* Keeps the engine. ISO_ERR_NOMEM. */
iso_status iso_gl_canvas_create(iso_gl_engine *engine, iso_gl_canvas **canvas, iso_error *error);
void iso_gl_canvas_destroy(iso_gl_canvas *canvas); /* NULL is fine */

typedef struct iso_gl_paint {
    int factor; /* a pixel is factor x factor samples, 1 .. ISO_FACTOR_MAX */
    iso_rgb color, background;
    /* NULL: shaded as by render/shading/shading.h. Else by a picture of a lit sphere, sphere_side x
     * sphere_side: red, green, blue of the normals with x and y from -1 to 1. */
    const uint8_t *sphere;
    int sphere_side;
} iso_gl_paint;

/* As iso_gl_draw and iso_gl_draw_pullpush, but that the picture is shaded and stays in the canvas, which
 * takes its size: the view's, in samples, is a multiple of the factor. Of one sample a pixel the samples are
 * kept; of more, those that were kept of a picture of this size stay. Waits for the GPU. Errors: theirs; the
 * canvas is then empty. */
iso_status iso_gl_canvas_draw(iso_gl_canvas *canvas, const iso_gl_draw_opts *opts, const iso_gl_paint *paint,
                              iso_error *error);
iso_status iso_gl_canvas_draw_pullpush(iso_gl_canvas *canvas, const iso_gl_pullpush_opts *opts,
                                       const iso_gl_paint *paint, iso_error *error);

/* The number of its texture of colours, GL_RGBA8, the picture's upper row first; until the next draw. 0:
 * empty.
 */
unsigned iso_gl_canvas_texture(const iso_gl_canvas *canvas);

/* View space normal and depth at a pixel, as they are kept; false: nothing is there. */
bool iso_gl_canvas_pick(const iso_gl_canvas *canvas, int x, int y, float normal_depth[4]);

/* `to` gets the kept samples of `from`, and nothing else to rely on. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_canvas_copy(iso_gl_canvas *to, const iso_gl_canvas *from, iso_error *error);

/* Its colours, read back into an image of its size. */
iso_status iso_gl_canvas_read(const iso_gl_canvas *canvas, iso_image *image, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
