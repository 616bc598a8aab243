/* picture: renders an image, given a camera and a function that draws into a gbuffer: cuts the picture into
 * strips, draws several samples a pixel, shades. */
#ifndef ISO_RENDER_PICTURE_H
#define ISO_RENDER_PICTURE_H

#include "base/parallel.h"
#include "image/aov.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/occlusion/occlusion.h"
#include "render/shading/shading.h"
#include "render/view/gbuffer.h"

/* Draws all surfaces into a cleared gbuffer of the view's size. Called once per strip. */
typedef iso_status iso_draw_fn(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error);

/* How a picture with translucent surfaces is drawn. */
typedef struct iso_picture_layers {
    iso_draw_fn *draw_opaque; /* the opaque surfaces; NULL: there are none */
    /* Draws the translucent surfaces and shades a strip into its rows of the image; sets alpha and number of
     * layers in `aov` (NULL: not wanted), and *covered to the number of samples that show a surface. The
     * strip's gbuffer has the opaque surfaces, or but its size when there are none. */
    iso_status (*shade)(void *context, const iso_strip *strip, iso_image *image, iso_aov *aov,
                        size_t *covered, iso_error *error);
    void *context; /* of both */
} iso_picture_layers;

/* How opaque surfaces are lit: by their normals (render/shading/shading.h), or by the depths around each
 * sample (render/shading/eye_dome.h). */
typedef enum iso_lighting { ISO_LIGHTING_PHONG, ISO_LIGHTING_EYE_DOME } iso_lighting;

/* Bytes of a gbuffer per sample (depth, normal, surface), and of the gbuffer of a strip at most; of one of an
 * exact surface, if its pixels take no more. */
enum {
    ISO_PICTURE_SAMPLE_BYTES = 4 * sizeof(float) + 1,
    ISO_PICTURE_STRIP_BYTES = 256 << 20,
    ISO_EXACT_STRIP_BYTES = 16 << 20
};

/* Widest line along outlines, pixels. */
#define ISO_OUTLINE_MOST 16.0

typedef struct iso_picture_opts {
    const iso_camera *camera;
    const iso_view *view; /* NULL, or a view of width x height pixels that is used instead of the camera */
    int width, height;
    int rows[2];        /* only the pixel rows rows[0] .. rows[1] - 1 are drawn; 0, 0: all */
    int samples;        /* per pixel: a square number 1, 4, 9 .. 64; 0 means 1 */
    size_t strip_bytes; /* of the gbuffer, at most; 0 means ISO_PICTURE_STRIP_BYTES */
    iso_shading shading;
    iso_lighting lighting;    /* not used with `layers` */
    iso_occlusion *occlusion; /* NULL: nothing is occluded. Not used with `layers` */
    double outline;           /* width of lines along outlines, pixels; 0: none. Not used with `layers` */
    iso_draw_fn *draw;
    void *draw_context;
    /* NULL, or called with draw_context before each strip, which is this part of the picture's rows, 0 ..
     * 1. */
    void (*begin_strip)(void *context, double from, double to);
    const iso_picture_layers
        *layers; /* NULL: all surfaces are opaque. Else `draw` is for depth and normals in
                                         `aov`: those of the first surface, whatever its opacity */
    /* NULL, or memory for all samples of the picture, which is then drawn as one strip: they stay there, but
     * not with `layers` that draw nothing opaque. */
    iso_gbuffer *gbuffer;
    iso_pool *pool;
    iso_aov *aov; /* NULL, or planes of the picture's size for depth, normals and coverage, and for ids */
} iso_picture_opts;

/* Samples along a pixel's side: the square root of a square number 1, 4, 9 .. 64; 0 samples mean 1. Returns 0
 * for other numbers. */
int iso_picture_factor(int samples);
/* ISO_ERR_USAGE: no such number. */
iso_status iso_picture_check_samples(int samples, iso_error *error);

/* Renders in strips of rows so that the gbuffer stays below strip_bytes, but a row of pixels at a time at
 * least. The picture does not depend on the height of the strips. `image` must be width x height pixels.
 * *covered (NULL is fine) is set to the number of samples that show a surface. Errors: ISO_ERR_USAGE
 * (samples), ISO_ERR_NOMEM, ISO_ERR_IO (the pool's watch has cancelled), and the errors of `draw`. */
iso_status iso_picture_render(const iso_picture_opts *opts, iso_image *image, size_t *covered,
                              iso_error *error);

#endif
