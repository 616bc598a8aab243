/* phong_vectors: the key light, slopes of rays and the byte order of
 * pixels, for kernels that shade and for those who prepare what they read. */
#ifndef ISO_RENDER_SHADING_PHONG_VECTORS_H
#define ISO_RENDER_SHADING_PHONG_VECTORS_H

#include "image/camera.h"
#include "render/shading/phong.h"

static const float KEY_LIGHT[3] = {ISO_PHONG_LIGHT_X, ISO_PHONG_LIGHT_Y, ISO_PHONG_LIGHT_Z};

/* Shifts of red, green, blue and alpha in a 32-bit word whose bytes in memory are in this order. */
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
static const int SHIFT[4] = {24, 16, 8, 0};
#else
static const int SHIFT[4] = {0, 8, 16, 24};
#endif

/* The ray through the centre of a pixel has the direction (u, v, 1): u of a column, v of a row. */
static inline float iso_slope_of_column(const iso_view *view, int x) {
    return view->orthographic ? 0 : (float)((x + 0.5 - view->cx) / view->focal);
}
static inline float iso_slope_of_row(const iso_view *view, int y) {
    return view->orthographic ? 0 : (float)((y + 0.5 - view->cy) / view->focal);
}

#endif
