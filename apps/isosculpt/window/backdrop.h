/* backdrop: the reference picture of the window's document, kept beside its strokes. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_BACKDROP_H
#define ISO_APPS_ISOSCULPT_WINDOW_BACKDROP_H

#include "apps/isosculpt/window/state.h"

/* Shows the picture of --reference, once, or that of the document's stroke file. Called when the document is
 * another one. */
void isosculpt_window_adopt_backdrop(window *w);
/* Writes where the picture is to NAME.strokes.picture, with its checksum, when that has changed. */
void isosculpt_window_keep_backdrop(window *w);

#endif
