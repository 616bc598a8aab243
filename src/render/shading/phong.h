/* phong: the constants of the shading model (render/shading/shading.h), for C and GLSL. */
#ifndef ISO_RENDER_SHADING_PHONG_H
#define ISO_RENDER_SHADING_PHONG_H

#define ISO_PHONG_AMBIENT 0.16f
#define ISO_PHONG_KEY 0.58f
#define ISO_PHONG_FILL 0.34f
#define ISO_PHONG_SPECULAR 0.16f
/* Unit direction to the key light in view space (y down): from above left, 41 degrees off the optical
 * axis. The fill light shines along the optical axis. */
#define ISO_PHONG_LIGHT_X -0.40f
#define ISO_PHONG_LIGHT_Y -0.52f
#define ISO_PHONG_LIGHT_Z -0.7547185f

#endif
