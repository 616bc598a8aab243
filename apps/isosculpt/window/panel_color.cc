/* The panel's section for surfaces that are coloured by data, and the bar of their numbers. */
#include <cmath>
#include <cstdio>
#include <cstring>

#include "apps/isosculpt/style.h"
#include "apps/isosculpt/viewport/color_by.h"
#include "apps/isosculpt/window/panel_parts.hpp"

/* The file's name in a path. */
static const char *base_name(const char *path) {
    const char *slash = std::strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Chooses what the surfaces are coloured by. Returns whether that has changed. */
static bool choose_source(isosculpt_screen *screen) {
    static const char *const words[] = {"", "curvature", "depth", "normal"};
    isosculpt_viewport *viewport = screen->controller->viewport;
    const char *now = isosculpt_viewport_color_by(viewport)->what;
    bool changed = false;
    if (!ImGui::BeginCombo("by", now[0] ? base_name(now) : "nothing")) return false;
    for (const char *word : words)
        if (ImGui::Selectable(word[0] ? word : "nothing", std::strcmp(word, now) == 0)) {
            isosculpt_style_set(viewport, "surface-color-by", word, nullptr);
            changed = true;
        }
    if (ImGui::Selectable("a volume ..", false)) screen->browse_request = ISOSCULPT_BROWSE_COLORS;
    if (ImGui::Selectable("distance from ..", false)) screen->browse_request = ISOSCULPT_BROWSE_DISTANCES;
    ImGui::EndCombo();
    return changed;
}

static bool choose_map(isosculpt_viewport *viewport) {
    const isosculpt_color_by *by = isosculpt_viewport_color_by(viewport);
    const iso_color_bar *bar = &by->coloring.bar;
    bool changed = false;
    if (!ImGui::BeginCombo("colours", bar->table ? base_name(by->map) : iso_colormap_name(bar->map)))
        return false;
    for (int i = 0; i < ISO_COLORMAP_COUNT; i++) {
        const iso_colormap map = (iso_colormap)i;
        if (!ImGui::Selectable(iso_colormap_name(map), !bar->table && map == bar->map)) continue;
        isosculpt_style_set(viewport, "colormap", iso_colormap_name(map), nullptr);
        changed = true;
    }
    ImGui::EndCombo();
    return changed;
}

/* Both ends of the range; dragged ones stay when another isovalue is chosen. Returns whether they have
 * changed. */
static bool choose_range(isosculpt_viewport *viewport) {
    const isosculpt_color_by *by = isosculpt_viewport_color_by(viewport);
    const double low = by->coloring.bar.low, high = by->coloring.bar.high, none[2] = {NAN, NAN};
    double range[2] = {low, high};
    const float speed = (float)(std::fmax(high - low, 1e-12) / 200);
    bool changed =
        ImGui::DragScalarN("range", ImGuiDataType_Double, range, 2, speed, nullptr, nullptr, "%.5g");
    changed =
        changed && range[0] < range[1] && isosculpt_color_by_set_range(viewport, range, nullptr) == ISO_OK;
    if (std::isnan(by->range[0])) return changed;
    if (!ImGui::Button("Range of this surface")) return changed;
    return isosculpt_color_by_set_range(viewport, none, nullptr) == ISO_OK;
}

void panel_draw_colors(isosculpt_screen *screen) {
    isosculpt_viewport *viewport = screen->controller->viewport;
    bool changed = choose_source(screen);
    if (isosculpt_viewport_is_colored(viewport)) {
        if (isosculpt_viewport_color_by(viewport)->coloring.source != ISO_COLOR_BY_NORMAL) {
            changed |= choose_map(viewport);
            changed |= choose_range(viewport);
        }
        ImGui::TextColored(GREY, "drawn by %s on the cpu, with lamps",
                           iso_method_name(isosculpt_viewport_method(viewport)));
    }
    if (!changed) return;
    viewport->style++;
    screen->controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}

void panel_draw_color_bar(const isosculpt_screen *screen, float scale) {
    constexpr int STEPS = 64;
    const isosculpt_viewport *viewport = screen->controller->viewport;
    const isosculpt_color_by *by = isosculpt_viewport_color_by(viewport);
    const iso_color_bar *bar = &by->coloring.bar;
    if (!isosculpt_viewport_is_colored(viewport) || by->coloring.source == ISO_COLOR_BY_NORMAL) return;
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const float line = ImGui::GetTextLineHeight(), width = 14 * scale, height = 180 * scale, gap = 8 * scale,
                right = (float)((screen->picture_x + screen->picture_width) / screen->pixels) - 16 * scale,
                top = 16 * scale + 1.5f * line;
    const iso_rgb ground = viewport->mode.material.background;
    const bool dark = 299 * ground.r + 587 * ground.g + 114 * ground.b < 128000;
    const ImU32 ink = dark ? IM_COL32(235, 235, 235, 255) : IM_COL32(20, 20, 20, 255);
    list->AddText(ImVec2(right - ImGui::CalcTextSize(bar->title).x, 16 * scale), ink, bar->title);
    for (int i = 0; i < STEPS; i++) {
        const double number = bar->high - (i + 0.5) / STEPS * (bar->high - bar->low);
        const iso_rgb color = iso_color_bar_at(bar, number);
        list->AddRectFilled(ImVec2(right - width, top + height * (float)i / STEPS),
                            ImVec2(right, top + height * (float)(i + 1) / STEPS),
                            IM_COL32(color.r, color.g, color.b, 255));
    }
    for (int i = 0; i <= 4; i++) {
        char text[32];
        std::snprintf(text, sizeof text, "%.4g", bar->high - i / 4.0 * (bar->high - bar->low));
        list->AddText(ImVec2(right - width - gap - ImGui::CalcTextSize(text).x,
                             top + height * (float)i / 4 - 0.5f * line),
                      ink, text);
    }
}
