/* step_name: the names of undo steps. Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_STEP_NAME_H
#define ISO_SCULPT_SESSION_STEP_NAME_H

#include "sculpt/session/journal.h"

enum { ISO_STEP_NAME = 64 };
/* Write the name of a stroke's step, the tool and, unless it is a sphere or capsule, the solid; and that of
 * an edit's, its kind and the strokes. */
void iso_step_name_stroke(const iso_brush *brush, char name[ISO_STEP_NAME]);
void iso_step_name_edit(const iso_event *event, char name[ISO_STEP_NAME]);

#endif
