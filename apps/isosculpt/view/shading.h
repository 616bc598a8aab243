/* light: how a view's samples become colours: lamps (render/shading/shading.h), or a picture of a lit sphere
 * that is looked up by the normal ("matcap"), which shows form without highlights that wander. */
#ifndef ISO_APPS_ISOSCULPT_VIEW_SHADING_H
#define ISO_APPS_ISOSCULPT_VIEW_SHADING_H

#include "render/shading/shading.h"

#ifdef __cplusplus
extern "C" {
#endif

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
const char *isosculpt_shading_name(isosculpt_shading light);

typedef struct isosculpt_material {
    isosculpt_shading light;
    iso_rgb color, background;
} isosculpt_material;

/* A picture of the lit sphere: normals (x, y) from -1 to 1. Zero-initialise; made when first needed, and
 * again for another paint. */
enum { ISOSCULPT_SPHERE = 256 };
typedef struct isosculpt_matcap {
    isosculpt_shading light;
    iso_rgb color;
    uint8_t rgb[ISOSCULPT_SPHERE][ISOSCULPT_SPHERE][3];
} isosculpt_matcap;

/* The picture of the sphere, brought up to date; NULL: the paint is lamps. */
const isosculpt_matcap *isosculpt_material_matcap(const isosculpt_material *paint, isosculpt_matcap *sphere);

/* Shades a strip, as iso_shade does. */
void isosculpt_material_strip(const isosculpt_material *paint, isosculpt_matcap *sphere,
                              const iso_strip *strip, iso_image *image, iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
