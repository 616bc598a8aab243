/* picture: from a camera and something that draws to an image: strips, supersampling, shading. */
#ifndef ISO_RENDER_PICTURE_H
#define ISO_RENDER_PICTURE_H

#include "base/parallel.h"
#include "image/aov.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/gbuffer.h"
#include "render/shading/shading.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws everything that is to be seen into a cleared gbuffer of the view's size. */
typedef iso_status iso_draw_fn(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error);

typedef struct iso_picture_opts {
    const iso_camera *camera;
    const iso_view *view; /* of width x height pixels, instead of the camera; or NULL */
    int width, height;
    int samples; /* per pixel: a square number 1, 4, 9 .. 64; 0 means 1 */
    iso_shading shading;
    iso_draw_fn *draw;
    void *draw_context;
    iso_pool *pool;
    iso_aov *aov; /* NULL, or of the picture's size: its planes are filled as well */
} iso_picture_opts;

/* Renders in strips of rows so that the gbuffer stays below 256 MiB. `image` must have the size asked for.
 * *covered (NULL is fine) counts samples that show a surface. Errors: ISO_ERR_USAGE (samples), ISO_ERR_NOMEM,
 * and whatever draw returns. */
iso_status iso_picture_render(const iso_picture_opts *opts, iso_image *image, size_t *covered,
                              iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
