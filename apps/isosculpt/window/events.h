/* events: GLFW's callbacks. They pass mouse, keyboard and dropped files on to controller, panel and dialogs.
 */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_EVENTS_H
#define ISO_APPS_ISOSCULPT_WINDOW_EVENTS_H

#include "apps/isosculpt/window/state.h"

void isosculpt_window_install_callbacks(window *w);

#endif
