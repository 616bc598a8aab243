/* reference: makes the reference of the document when it is to be shown. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_REFERENCE_H
#define ISO_APPS_ISOSCULPT_WINDOW_REFERENCE_H

#include "apps/isosculpt/window/state.h"

/* Shows or hides the reference. Does nothing while a volume is viewed. */
void isosculpt_window_toggle_reference(window *w);

/* Starts to make the reference if it is to be shown and there is none, and passes it to the viewport when it
 * is ready. If it cannot be made or drawn, the status line says why, and the reference is hidden. */
void isosculpt_window_update_reference(window *w);

/* Cancels making the reference; called before the document is closed. */
void isosculpt_window_cancel_reference(window *w);

#endif
