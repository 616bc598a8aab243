/* light: how a view's samples become colours: lamps (render/shading/shading.h), or a picture of a lit sphere
 * that is looked up by the normal ("matcap"), which shows form without highlights that wander. */
#ifndef ISO_APPS_ISOSCULPT_LIGHT_H
#define ISO_APPS_ISOSCULPT_LIGHT_H

#include "render/shading/shading.h"

#ifdef __cplusplus
extern "C" {
#endif

#define ISOSCULPT_LIGHTS(X)                                                                                  \
    X(LAMPS, "lamps")                                                                                        \
    X(CLAY, "matcap clay")                                                                                   \
    X(PEARL, "matcap pearl")                                                                                 \
    X(METAL, "matcap metal")
typedef enum isosculpt_light {
#define ISOSCULPT_LIGHT_ENUM(name, text) ISOSCULPT_LIGHT_##name,
    ISOSCULPT_LIGHTS(ISOSCULPT_LIGHT_ENUM)
#undef ISOSCULPT_LIGHT_ENUM
        ISOSCULPT_LIGHT_COUNT
} isosculpt_light;
const char *isosculpt_light_name(isosculpt_light light);

typedef struct isosculpt_paint {
    isosculpt_light light;
    iso_rgb color, background;
} isosculpt_paint;

/* A picture of the lit sphere: normals (x, y) from -1 to 1. Zero-initialise; made when first needed, and
 * again for another paint. */
enum { ISOSCULPT_SPHERE = 256 };
typedef struct isosculpt_sphere {
    isosculpt_light light;
    iso_rgb color;
    uint8_t rgb[ISOSCULPT_SPHERE][ISOSCULPT_SPHERE][3];
} isosculpt_sphere;

/* The picture of the sphere, brought up to date; NULL: the paint is lamps. */
const isosculpt_sphere *isosculpt_paint_sphere(const isosculpt_paint *paint, isosculpt_sphere *sphere);

/* Shades a strip, as iso_shade does. */
void isosculpt_paint_strip(const isosculpt_paint *paint, isosculpt_sphere *sphere, const iso_strip *strip,
                           iso_image *image, iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
