/* shading: turns samples into colours, with lamps (render/shading/shading.h) or with a matcap: a picture of a
 * lit sphere in which the colour is looked up by the normal. A matcap shows form without highlights that move
 * with the camera. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_SHADING_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_SHADING_H

#include "base/c_linkage.h"
#include "render/shading/shading.h"

ISO_C_BEGIN

#define ISOSCULPT_SHADINGS(X)                                                                                \
    X(LAMPS, "lamps")                                                                                        \
    X(CLAY, "matcap clay")                                                                                   \
    X(PEARL, "matcap pearl")                                                                                 \
    X(METAL, "matcap metal")
typedef enum isosculpt_shading {
#define ISOSCULPT_SHADING_ENUM(name, text) ISOSCULPT_SHADING_##name,
    ISOSCULPT_SHADINGS(ISOSCULPT_SHADING_ENUM)
#undef ISOSCULPT_SHADING_ENUM
        ISOSCULPT_SHADING_COUNT
} isosculpt_shading;
const char *isosculpt_shading_name(isosculpt_shading shading); /* as the panel shows it */

/* The colour of a surface unless another one is chosen. */
static const iso_rgb ISOSCULPT_SURFACE_COLOR = {206, 142, 112};

typedef struct isosculpt_material {
    isosculpt_shading shading;
    iso_rgb color, background;
} isosculpt_material;

/* A picture of the lit sphere, for normals with x and y from -1 to 1. Zero-initialise; it is made when first
 * needed, and again for another material. */
enum { ISOSCULPT_MATCAP_SIDE = 256 };
typedef struct isosculpt_matcap {
    isosculpt_shading shading;
    iso_rgb color;
    uint8_t rgb[ISOSCULPT_MATCAP_SIDE][ISOSCULPT_MATCAP_SIDE][3];
} isosculpt_matcap;

/* Brings `matcap` up to date with the material and returns it; NULL: the material is lit by lamps. */
const isosculpt_matcap *isosculpt_material_matcap(const isosculpt_material *material,
                                                  isosculpt_matcap *matcap);

/* Shades a strip of samples into `image`, as iso_shade does. `matcap` is kept between calls. */
void isosculpt_material_strip(const isosculpt_material *material, isosculpt_matcap *matcap,
                              const iso_strip *strip, iso_image *image, iso_pool *pool);

ISO_C_END
#endif
