/* panel_parts: functions and colours that the files of the panel share. Needs Dear ImGui; for panel*.cc only.
 */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PANEL_PARTS_HPP
#define ISO_APPS_ISOSCULPT_WINDOW_PANEL_PARTS_HPP

#include <imgui.h>

#include "apps/isosculpt/window/panel.h"

static const ImVec4 RED{1.0f, 0.42f, 0.36f, 1.0f}, GREY{0.72f, 0.74f, 0.77f, 1.0f},
    GREEN{0.62f, 0.86f, 0.62f, 1.0f};

/* Sections of the panel: a viewed volume's isovalue (panel_isovalue.cc), files (panel_files.cc); and the part
 * of the picture's section that is about the reference (panel_reference.cc). `scale`: of text and widgets. */
void panel_draw_isovalue(isosculpt_screen *screen, float scale);
void panel_draw_files(isosculpt_screen *screen);
void panel_draw_reference(isosculpt_screen *screen);

/* A field that shows a colour and changes it; returns whether it was changed. */
bool panel_edit_color(const char *label, iso_rgb *color);

/* Behind the panel (panel_overlay.cc): the picture with the mirror planes and the queued strokes; the brush's
 * ring. */
void panel_draw_picture(const isosculpt_screen *screen, float scale);
void panel_draw_brush(const isosculpt_screen *screen, float scale);

#endif
