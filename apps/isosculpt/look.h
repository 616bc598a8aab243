/* look: what a user chose in the window for a sculpture, as a line of text: method, light and colours of the
 * picture, and tool, size, strength and symmetry of the brush. The document keeps the line in its lock file
 * (document.h), so that a recovered session looks as it did. */
#ifndef ISO_APPS_ISOSCULPT_LOOK_H
#define ISO_APPS_ISOSCULPT_LOOK_H

#include "apps/isosculpt/input_controller.h"

/* Writes the look of the controller's brush and of its viewport: "name=value;" for each setting. */
void isosculpt_look_write(const isosculpt_controller *controller, char text[ISOSCULPT_LOOK]);

/* Applies a look to the controller's brush and to its viewport. Settings that are missing, unknown or out of
 * range, as in a damaged file, are ignored. */
void isosculpt_look_apply(isosculpt_controller *controller, const char *text);

#endif
