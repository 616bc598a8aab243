/* phong: the numbers of the shading model, for C and GLSL. */
#ifndef ISO_RENDER_SHADING_PHONG_H
#define ISO_RENDER_SHADING_PHONG_H

#define ISO_PHONG_AMBIENT 0.16f
#define ISO_PHONG_KEY 0.58f
#define ISO_PHONG_FILL 0.34f
#define ISO_PHONG_SPECULAR 0.16f
/* Direction to the key light, unit, view space (y down): from above left, 41 degrees off the axis. The fill
 * light is at the eye of an orthographic view. */
#define ISO_PHONG_LIGHT_X -0.40f
#define ISO_PHONG_LIGHT_Y -0.52f
#define ISO_PHONG_LIGHT_Z -0.7547185f

#endif
