/* The panel's section of a viewed volume: its histogram, one or two isovalues, and how opaque their surfaces
 * are. */
#include <cmath>
#include <cstdio>

#include "apps/isosculpt/window/axis.h"
#include "apps/isosculpt/window/panel_parts.hpp"

/* Colours of the lines at the isovalues and of the labels of their sliders. */
static const ImVec4 FIRST{1.0f, 0.745f, 0.353f, 1.0f}, SECOND{0.94f, 0.56f, 0.86f, 1.0f};
/* SKIN_OPACITY: opacity of the first surface when a second one inside it is added; LEAST_OPACITY: the lower
 * end of the sliders. */
static const double SKIN_OPACITY = 0.35, LEAST_OPACITY = 0.05;

static isosculpt_see_through *see_through_of(const isosculpt_screen *screen) {
    return &screen->controller->viewport->see_through;
}

/* Draws the columns of the histogram, with logarithmic heights. If less than half of the bins are used, each
 * column extends to the next used bin. */
static void draw_columns(const iso_histogram &histogram, ImDrawList *list, ImVec2 at, ImVec2 size) {
    uint64_t most = 1, filled = 0;
    for (uint64_t count : histogram.bins) {
        most = count > most ? count : most;
        filled += count > 0;
    }
    const bool widen = 2 * filled < ISO_HISTOGRAM_BINS;
    const float column = size.x / ISO_HISTOGRAM_BINS;
    uint64_t count = 0;
    for (int i = 0; i < ISO_HISTOGRAM_BINS; i++) {
        if (histogram.bins[i] || !widen) count = histogram.bins[i];
        const double part = std::log1p((double)count) / std::log1p((double)most);
        list->AddRectFilled(ImVec2(at.x + column * (float)i, at.y + size.y * (float)(1 - part)),
                            ImVec2(at.x + column * (float)(i + 1), at.y + size.y),
                            IM_COL32(120, 150, 190, 255));
    }
}

/* The histogram's rectangle, and the values that it spans. */
struct plot {
    ImVec2 at, size;
    double low, range;
    float x(double value) const { return at.x + size.x * (float)(range > 0 ? (value - low) / range : 0); }
    double value(float x) const {
        return low + std::fmin(std::fmax((double)(x - at.x) / (double)size.x, 0), 1) * range;
    }
};

static float text_width(const char *text) {
    return ImGui::CalcTextSize(text).x;
}

/* Writes a number below the axis if it fits between *free and `right`; *free is then moved behind it. */
static bool draw_label(const plot &p, ImDrawList *list, double value, float *free, float right) {
    char text[32];
    snprintf(text, sizeof text, "%.5g", value);
    const float width = text_width(text),
                x = std::fmin(std::fmax(p.x(value) - width / 2, p.at.x), p.at.x + p.size.x - width);
    if (x < *free || x + width > right) return false;
    list->AddText(ImVec2(x, p.at.y + p.size.y + 4), ImGui::GetColorU32(GREY), text);
    *free = x + width + text_width("  ");
    return true;
}

/* Draws the values at both ends of the axis, and round values between them where there is room. */
static void draw_axis(const plot &p, ImDrawList *list, float scale) {
    double ticks[ISOSCULPT_AXIS_TICKS];
    const double high = p.low + p.range;
    const int count = isosculpt_axis_ticks(p.low, high, 6, ticks);
    const float bottom = p.at.y + p.size.y;
    char last[32];
    snprintf(last, sizeof last, "%.5g", high);
    float free = p.at.x;
    draw_label(p, list, p.low, &free, p.at.x + p.size.x);
    for (int i = 0; i < count; i++) {
        const float x = p.x(ticks[i]);
        list->AddLine(ImVec2(x, bottom), ImVec2(x, bottom + 4 * scale), ImGui::GetColorU32(GREY));
        draw_label(p, list, ticks[i], &free, p.at.x + p.size.x - text_width(last) - text_width("  "));
    }
    if (p.range > 0) draw_label(p, list, high, &free, p.at.x + p.size.x);
}

/* A triangle and a line at each suggested isovalue; Otsu's is brighter. */
static void draw_marks(const plot &p, const iso_source_volume *volume, ImDrawList *list, float scale) {
    for (size_t i = 0; i < volume->candidate_count; i++) {
        const float x = p.x(volume->candidates[i]), side = 5 * scale;
        const ImU32 color = i ? IM_COL32(110, 190, 120, 200) : IM_COL32(140, 235, 140, 255);
        list->AddTriangleFilled(ImVec2(x - side, p.at.y), ImVec2(x + side, p.at.y),
                                ImVec2(x, p.at.y + 1.6f * side), color);
        list->AddLine(ImVec2(x, p.at.y), ImVec2(x, p.at.y + p.size.y), IM_COL32(140, 235, 140, 90), scale);
    }
}

static void draw_line(const plot &p, ImDrawList *list, double value, const ImVec4 &color, float scale) {
    const float x = p.x(value);
    list->AddLine(ImVec2(x, p.at.y), ImVec2(x, p.at.y + p.size.y), ImGui::GetColorU32(color), 2 * scale);
}

/* Moves the line that the mouse drags: the one that was nearer when the button was pressed. */
static void drag_line(isosculpt_screen *screen, const plot &p) {
    isosculpt_see_through *how = see_through_of(screen);
    const float x = ImGui::GetIO().MousePos.x;
    if (ImGui::IsItemActivated())
        screen->second_line_dragged = how->has_second && std::fabs(x - p.x(how->second_isovalue)) <
                                                             std::fabs(x - p.x(screen->isovalue));
    screen->isovalue_dragged = ImGui::IsItemActive();
    if (screen->isovalue_dragged && p.range > 0)
        (screen->second_line_dragged ? how->second_isovalue : screen->isovalue) = p.value(x);
}

/* Draws the histogram, with the isovalues as lines that can be dragged. */
static void draw_histogram(isosculpt_screen *screen, float scale) {
    const iso_source_volume *volume = screen->volume;
    const iso_histogram *histogram = &volume->histogram;
    const plot p = {ImGui::GetCursorScreenPos(), ImVec2(ImGui::GetContentRegionAvail().x, 110 * scale),
                    histogram->low, histogram->high - histogram->low};
    ImDrawList *list = ImGui::GetWindowDrawList();
    ImGui::InvisibleButton("histogram", p.size);
    drag_line(screen, p);
    if (ImGui::IsItemHovered() && !screen->isovalue_dragged)
        ImGui::SetTooltip("isovalue %.6g; marked: Otsu's threshold and those of three classes",
                          p.value(ImGui::GetIO().MousePos.x));
    list->AddRectFilled(p.at, ImVec2(p.at.x + p.size.x, p.at.y + p.size.y), IM_COL32(20, 24, 30, 255));
    draw_columns(*histogram, list, p.at, p.size);
    draw_marks(p, volume, list, scale);
    if (see_through_of(screen)->has_second)
        draw_line(p, list, see_through_of(screen)->second_isovalue, SECOND, scale);
    draw_line(p, list, screen->isovalue, FIRST, scale);
    draw_axis(p, list, scale);
    ImGui::Dummy(ImVec2(0, ImGui::GetTextLineHeight()));
}

/* Buttons for the suggested isovalues, which isorender --info prints, too. */
static void draw_suggestions(isosculpt_screen *screen) {
    const iso_source_volume *volume = screen->volume;
    if (volume->candidate_count) ImGui::TextColored(GREY, "suggested");
    for (size_t i = 0; i < volume->candidate_count; i++) {
        char label[48];
        snprintf(label, sizeof label, i ? "%.6g##%zu" : "Otsu %.6g##%zu", volume->candidates[i], i);
        ImGui::SameLine();
        if (ImGui::SmallButton(label)) screen->isovalue = volume->candidates[i];
    }
}

/* ---- a second isovalue, and opacities */

/* Returns the highest suggested isovalue if it is above the first one, because its surface lies deepest
 * inside; else a value between the first one and the highest value. */
static double suggest_second(const isosculpt_screen *screen) {
    const iso_source_volume *volume = screen->volume;
    double most = screen->isovalue;
    for (size_t i = 0; i < volume->candidate_count; i++) most = std::fmax(most, volume->candidates[i]);
    return most > screen->isovalue ? most : most + (volume->histogram.high - most) / 3;
}

/* Adds a second surface. The first one becomes translucent, because the second lies inside it. */
static void add_second(isosculpt_screen *screen) {
    isosculpt_see_through *how = see_through_of(screen);
    how->second_isovalue = suggest_second(screen);
    if (how->opacity >= 1) how->opacity = SKIN_OPACITY;
}

static bool slide(const char *label, double *value, double low, double high, const char *format) {
    return ImGui::SliderScalar(label, ImGuiDataType_Double, value, &low, &high, format,
                               ImGuiSliderFlags_AlwaysClamp);
}

/* A slider whose label has the colour of a line in the histogram; returns whether it is being dragged. */
static bool slide_in_color(const char *label, const ImVec4 &color, double *value, double low, double high,
                           const char *format) {
    char name[40];
    snprintf(name, sizeof name, "##%s", label);
    slide(name, value, low, high, format);
    const bool active = ImGui::IsItemActive();
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextColored(color, "%s", label);
    return active;
}

/* The widgets of the second surface. Returns whether something has changed. */
static bool choose_second(isosculpt_screen *screen) {
    isosculpt_see_through *how = see_through_of(screen);
    const iso_histogram *histogram = &screen->volume->histogram;
    bool changed = ImGui::Checkbox("second isovalue", &how->has_second);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("another surface in the same picture: bone in the skin");
    if (changed && how->has_second) add_second(screen);
    if (!how->has_second) return changed;
    ImGui::SameLine();
    changed |= panel_edit_color("colour", &how->second_color);
    ImGui::SameLine();
    ImGui::Checkbox("freeze", &screen->freeze_second);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("What it encloses is frozen in the sculpture: brushes leave the bone as it is.");
    screen->isovalue_dragged |=
        slide_in_color("second", SECOND, &how->second_isovalue, histogram->low, histogram->high, "%.6g");
    changed |= slide("opacity##second", &how->second_opacity, LEAST_OPACITY, 1, "%.2f");
    return changed;
}

/* Draws a note about settings of the panel that do not apply to this picture. */
static void draw_note(const isosculpt_viewport *viewport) {
    const isosculpt_display_mode *mode = &viewport->mode;
    const bool lamps = mode->material.shading == ISOSCULPT_SHADING_LAMPS,
               exact = mode->method == ISO_METHOD_EXACT,
               cpu = mode->engine == ISOSCULPT_ENGINE_CPU || !viewport->gl;
    if (isosculpt_viewport_is_see_through(viewport) && !(lamps && exact && cpu))
        ImGui::TextColored(GREY, "drawn by exact on the cpu, with lamps");
}

void panel_draw_isovalue(isosculpt_screen *screen, float scale) {
    const iso_histogram *histogram = &screen->volume->histogram;
    isosculpt_see_through *how = see_through_of(screen);
    const double second = how->second_isovalue;
    draw_histogram(screen, scale);
    screen->isovalue_dragged |=
        slide_in_color("isovalue", how->has_second ? FIRST : ImGui::GetStyleColorVec4(ImGuiCol_Text),
                       &screen->isovalue, histogram->low, histogram->high, "%.6g");
    draw_suggestions(screen);
    bool changed = slide("opacity", &how->opacity, LEAST_OPACITY, 1, "%.2f");
    changed |= choose_second(screen);
    if (changed || how->second_isovalue != second) screen->controller->commands |= ISOSCULPT_COMMAND_REDRAW;
    draw_note(screen->controller->viewport);
    if (ImGui::Button("Sculpt this")) screen->controller->commands |= ISOSCULPT_COMMAND_SCULPT;
    ImGui::SameLine();
    ImGui::TextColored(GREY, "or pick a brush");
}
