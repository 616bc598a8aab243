/* pyramid_sets: --one-pyramid: the input's surfaces, meshes of files and ribbons in one image pyramid. */
#ifndef ISO_APPS_ISORENDER_PYRAMID_SETS_H
#define ISO_APPS_ISORENDER_PYRAMID_SETS_H

#include "apps/isorender/isorender.h"

/* With --one-pyramid, marks what is drawn so: in_pyramid of surfaces and objects. */
void isorender_pyramid_choose(isorender_job *job);
/* Draws what is marked, on the cpu. ISO_ERR_NOMEM. */
iso_status isorender_pyramid_draw(isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                                  iso_error *error);

#endif
