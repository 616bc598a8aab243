/* shown: what a viewport shows, as a scene (scene/picture.h): one or two surfaces, what is cut away of them
 * and how that is capped, and their light. For the files of viewport/ only. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_SHOWN_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_SHOWN_H

#include "apps/isosculpt/viewport/viewport.h"
#include "scene/picture.h"

enum { ISOSCULPT_SURFACES = 2 };

/* Borrows the viewport, and points into itself. */
typedef struct isosculpt_shown {
    iso_scene_surface surfaces[ISOSCULPT_SURFACES];
    iso_point_view points; /* that the first surface is drawn as, if not those that it has */
    iso_layered_surface layered[ISOSCULPT_SURFACES];
    iso_clip clips[ISOSCULPT_SURFACES];
    iso_capped solids[ISOSCULPT_SURFACES];
    iso_rgb colors[ISOSCULPT_SURFACES];
    iso_painted painted;
    iso_coloring paint;
    iso_cut_caps caps;
    iso_shading shading;
    iso_scene scene;
} isosculpt_shown;

/* Lists what is shown by a method. `factor`: samples along a pixel. `lit`: with occlusion and shadow, if the
 * viewport has them; ISO_ERR_NOMEM. */
iso_status isosculpt_shown_list(isosculpt_viewport *viewport, iso_method method, int factor, bool lit,
                                isosculpt_shown *shown, iso_error *error);

/* Takes out of a gbuffer the samples that are cut away of a surface, which leaves holes where others would be
 * behind them: for methods that do not cut, whose pictures are soon replaced. */
void isosculpt_shown_cut_samples(const isosculpt_viewport *viewport, int surface, const iso_view *view,
                                 iso_gbuffer *gbuffer);

/* Draws and shades a picture of these pixels by the method, with factor x factor samples each, which
 * `gbuffer` has room for; they stay there, unless something is translucent. `lit`: with occlusion, shadow and
 * outlines, whose width is multiplied by `widen`. What draws is up to date. ISO_ERR_NOMEM. */
iso_status isosculpt_shown_render(isosculpt_viewport *viewport, iso_method method, const iso_view *pixels,
                                  int factor, bool lit, int widen, iso_gbuffer *gbuffer, iso_image *image,
                                  iso_error *error);

#endif
