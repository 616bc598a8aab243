/* panel_parts: functions and colours that the files of the panel share. Needs Dear ImGui; for panel*.cc only.
 */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PANEL_PARTS_HPP
#define ISO_APPS_ISOSCULPT_WINDOW_PANEL_PARTS_HPP

#include <cmath>
#include <vector>

#include <imgui.h>

#include "apps/isosculpt/window/panel.h"

static const ImVec4 RED{1.0f, 0.42f, 0.36f, 1.0f}, GREY{0.72f, 0.74f, 0.77f, 1.0f},
    GREEN{0.62f, 0.86f, 0.62f, 1.0f};

/* Makes the buttons that follow fill a row of the panel. `texts`: all their labels in one text. */
class button_row {
  public:
    button_row(const char *texts, int count) {
        const ImGuiStyle &style = ImGui::GetStyle();
        gap = style.ItemInnerSpacing.x;
        const float room = ImGui::GetContentRegionAvail().x - (float)(count - 1) * gap,
                    padding = (room - ImGui::CalcTextSize(texts).x) / (float)(2 * count);
        ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(std::fmax(padding, 1), style.FramePadding.y));
    }
    ~button_row() { ImGui::PopStyleVar(); }
    button_row(const button_row &) = delete;
    button_row &operator=(const button_row &) = delete;
    void next() const { ImGui::SameLine(0, gap); }

  private:
    float gap;
};

/* A font for the panel. */
struct panel_font {
    std::vector<unsigned char> bytes; /* of the file; empty: Dear ImGui's own font */
    float size;                       /* height of a line at scale 1 */
};
/* Chooses the file `path` ("builtin": Dear ImGui's own font), or (nullptr) the first of some good fonts that
 * is installed, else Dear ImGui's own font. ISO_ERR_IO: the file cannot be read; ISO_ERR_FORMAT: it is no
 * font. */
iso_status panel_choose_font(const char *path, panel_font *font, iso_error *error);
/* Sets letters, colours and sizes. A row of widgets has the same height with every font. Returns false if the
 * file is not a font. */
bool panel_set_style(const panel_font &font, float scale);

/* Sections of the panel: a viewed volume's isovalue (panel_isovalue.cc) and colours (panel_color.cc),
 * files (panel_files.cc), cut and light (panel_cut.cc), strokes (panel_strokes.cc), and the part of the
 * picture's section that is about the reference (panel_reference.cc). `scale`: of text and widgets. */
void panel_draw_isovalue(isosculpt_screen *screen, float scale);
void panel_draw_colors(isosculpt_screen *screen);
void panel_draw_files(isosculpt_screen *screen);
void panel_draw_cut(isosculpt_screen *screen);
void panel_draw_reference(isosculpt_screen *screen);
void panel_draw_measure(isosculpt_controller *controller); /* panel_measure.cc */
void panel_draw_strokes(isosculpt_controller *controller, float scale);
void panel_draw_repeat(isosculpt_controller *controller); /* panel_repeat.cc */
/* Above the widgets of the brush: which stroke they change. Returns it, NULL: the strokes to come. */
const iso_stroke *panel_draw_stroke_title(isosculpt_controller *controller);

/* The contents of the dialog for a new session, and the box for another voxel size (panel_new.cc). */
void panel_draw_resampling(isosculpt_screen *screen);
void panel_draw_new_dialog(isosculpt_screen *screen, float scale);

/* A field that shows a colour and changes it; returns whether it was changed. */
bool panel_edit_color(const char *label, iso_rgb *color);

/* The bar of a coloured surface's numbers, over the picture (panel_color.cc). */
void panel_draw_color_bar(const isosculpt_screen *screen, float scale);

/* Behind the panel (panel_overlay.cc): the picture with the mirror planes, queued and selected strokes and
 * the handle of the plane that cuts; the brush's ring. */
void panel_draw_picture(const isosculpt_screen *screen, float scale);
void panel_draw_brush(const isosculpt_screen *screen, float scale);

#endif
