/* ahead: a view's surfaces, made at once or in a thread of their own. The view's, and nobody else's. */
#ifndef ISO_APPS_ISOSCULPT_VIEW_ASYNC_SURFACE_H
#define ISO_APPS_ISOSCULPT_VIEW_ASYNC_SURFACE_H

#include "apps/isosculpt/view/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a method's surface is of the view's isovalue; of a field it never is before it was looked at. */
bool isosculpt_async_surface_has(const isosculpt_view *view, isosculpt_method method);

/* Brings a method's surface up to date, when a thread that makes one is done. ISO_ERR_NOMEM. */
iso_status isosculpt_async_surface_update(isosculpt_view *view, isosculpt_method method, iso_error *error);

/* Waits for the thread, if there is one. */
void isosculpt_async_surface_wait(isosculpt_view *view);

#ifdef __cplusplus
}
#endif
#endif
