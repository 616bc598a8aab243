/* Names the steps of the undo history. */
#include "sculpt/session/step_name.h"

#include <stdio.h>

#include "sculpt/brush/dab.h"

void iso_step_name_stroke(const iso_brush *brush, char name[ISO_STEP_NAME]) {
    const bool plain = !iso_tool_is_set_operation(brush->tool) || brush->shape == ISO_SOLID_SPHERE ||
                       brush->shape == ISO_SOLID_CAPSULE;
    snprintf(name, ISO_STEP_NAME, "%s%s%s", iso_tool_name(brush->tool), plain ? "" : " ",
             plain ? "" : iso_solid_name(brush->shape));
}

void iso_step_name_edit(const iso_event *event, char name[ISO_STEP_NAME]) {
    static const char *const kinds[] = {"edit", "delete", "mute", "unmute",
                                        "move", "group",  "path", "reseat"};
    const char *kind = kinds[event->kind - ISO_EVENT_EDIT];
    if (!event->first)
        snprintf(name, ISO_STEP_NAME, "%s %.40s", kind, event->text);
    else if (event->first == event->last)
        snprintf(name, ISO_STEP_NAME, "%s %u", kind, event->first);
    else
        snprintf(name, ISO_STEP_NAME, "%s %u-%u", kind, event->first, event->last);
}
