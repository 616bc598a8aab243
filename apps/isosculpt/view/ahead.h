/* ahead: a view's surfaces, made at once or in a thread of their own. The view's, and nobody else's. */
#ifndef ISO_APPS_ISOSCULPT_AHEAD_H
#define ISO_APPS_ISOSCULPT_AHEAD_H

#include "apps/isosculpt/view/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a method's surface is of the view's isovalue; of a field it never is before it was looked at. */
bool isosculpt_ahead_has(const isosculpt_view *view, isosculpt_method method);

/* Brings a method's surface up to date, when a thread that makes one is done. ISO_ERR_NOMEM. */
iso_status isosculpt_ahead_update(isosculpt_view *view, isosculpt_method method, iso_error *error);

/* Waits for the thread, if there is one. */
void isosculpt_ahead_wait(isosculpt_view *view);

#ifdef __cplusplus
}
#endif
#endif
