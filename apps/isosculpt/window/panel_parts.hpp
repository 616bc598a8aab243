/* panel_parts: what the files of the panel share. Needs Dear ImGui; nothing else includes it. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PANEL_PARTS_HPP
#define ISO_APPS_ISOSCULPT_WINDOW_PANEL_PARTS_HPP

#include <imgui.h>

#include "apps/isosculpt/window/panel.h"

static const ImVec4 RED{1.0f, 0.42f, 0.36f, 1.0f}, GREY{0.72f, 0.74f, 0.77f, 1.0f},
    GREEN{0.62f, 0.86f, 0.62f, 1.0f};

/* Sections. */
void panel_isovalue(isosculpt_screen *screen, float scale);
void panel_files(isosculpt_screen *screen);

/* The picture with the mirror's planes and strokes that wait; and the brush's ring. */
void panel_picture(const isosculpt_screen *screen, float scale);
void panel_brush(const isosculpt_screen *screen, float scale);

#endif
