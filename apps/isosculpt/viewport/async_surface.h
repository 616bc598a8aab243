/* async_surface: brings the surfaces that a viewport draws from up to date, at once or in a background
 * thread. For the files of viewport/ only. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_ASYNC_SURFACE_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_ASYNC_SURFACE_H

#include "apps/isosculpt/viewport/viewport.h"

/* The part of a surface (points, mesh or cells) that a method draws from. */
iso_part isosculpt_method_part(iso_method method);

/* Whether a part (iso_part, or ISOSCULPT_PART_SECOND) of a volume is up to date with its isovalue. Always
 * false for a field, whose parts isosculpt_async_surface_update brings up to date with every edit. */
bool isosculpt_async_surface_has(const isosculpt_viewport *viewport, int part);

/* Brings a part up to date now; waits first for the background thread, if it runs. ISO_ERR_NOMEM. */
iso_status isosculpt_async_surface_update(isosculpt_viewport *viewport, int part, iso_error *error);

/* Waits until the background thread is done, if it runs, and takes over its results. */
void isosculpt_async_surface_wait(isosculpt_viewport *viewport);

#endif
