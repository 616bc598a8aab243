/* The file browser as a modal dialog of Dear ImGui. */
#include "apps/isosculpt/window/file_browser.h"

#include <cfloat>
#include <cmath>
#include <cstdio>

#include <imgui.h>

static const char *title(isosculpt_purpose purpose) {
    static const char *const titles[] = {"",
                                         "Open a file",
                                         "A mesh to add and carve with",
                                         "A volume to colour by",
                                         "A volume or a mesh to measure distances from",
                                         "Save as",
                                         "Export a copy",
                                         "Save a picture"};
    static_assert(sizeof titles / sizeof *titles == ISOSCULPT_PURPOSES, "a title for each purpose");
    return titles[purpose];
}

static const char *verb(isosculpt_purpose purpose) {
    static const char *const verbs[] = {"",
                                        "Open (Enter)",
                                        "Take it (Enter)",
                                        "Take it (Enter)",
                                        "Take it (Enter)",
                                        "Save (Enter)",
                                        "Export (Enter)",
                                        "Save (Enter)"};
    static_assert(sizeof verbs / sizeof *verbs == ISOSCULPT_PURPOSES, "a verb for each purpose");
    return verbs[purpose];
}

/* Returns whether an entry was double-clicked. `follow`: scrolls to the selected entry. */
static bool draw_entries(isosculpt_browser *browser, bool follow) {
    bool double_clicked = false;
    int selected = -1;
    ImGuiListClipper clipper;
    clipper.Begin((int)browser->count);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; i++) {
            const isosculpt_entry *entry = &browser->entries[i];
            ImGui::PushID(i);
            if (ImGui::Selectable("##entry", i == browser->selected, ImGuiSelectableFlags_AllowDoubleClick)) {
                selected = i;
                double_clicked = ImGui::IsMouseDoubleClicked(0);
            }
            ImGui::SameLine(0, 0);
            ImGui::Text("%s%s", entry->name, entry->is_folder ? "/" : "");
            ImGui::PopID();
        }
    if (follow) {
        const float row = ImGui::GetTextLineHeightWithSpacing();
        ImGui::SetScrollY(std::fmax(0, row * (float)browser->selected - ImGui::GetWindowHeight() / 2));
    }
    if (selected >= 0) isosculpt_browser_select(browser, selected);
    if (!browser->count) ImGui::TextDisabled("nothing here of this type");
    return double_clicked;
}

static void draw_folder(isosculpt_browser *browser) {
    if (ImGui::Button("Up")) isosculpt_browser_up(browser);
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(browser->folder);
    ImGui::PopTextWrapPos();
}

static void draw_type(isosculpt_browser *browser, float scale) {
    const isosculpt_file_type *types = isosculpt_browser_types(browser->purpose);
    ImGui::SetNextItemWidth(240 * scale);
    char label[ISOSCULPT_LABEL];
    isosculpt_browser_label(browser, browser->type, label);
    if (ImGui::BeginCombo("##type", label)) {
        for (int i = 0; types[i].label; i++) {
            isosculpt_browser_label(browser, i, label);
            if (ImGui::Selectable(label, i == browser->type)) isosculpt_browser_set_type(browser, i);
        }
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    if (ImGui::Checkbox("hidden files", &browser->show_hidden)) isosculpt_browser_reread(browser);
}

/* Draws the input box for the name, which has the keyboard focus unless another widget is active or a list is
 * open (which would close without the focus). Returns whether Enter was pressed. */
static bool draw_name(isosculpt_browser *browser) {
    const bool empty = !browser->name[0];
    ImGui::SetNextItemWidth(-FLT_MIN);
    ImGui::PushID(browser->generation); /* Dear ImGui ignores changes of the text of an active box; a new id
                                           makes a new box */
    const bool list = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId);
    if (ImGui::IsWindowAppearing() || (!list && !ImGui::IsAnyItemActive())) ImGui::SetKeyboardFocusHere();
    if (ImGui::InputTextWithHint("##name", "a name, or a path", browser->name, sizeof browser->name))
        isosculpt_browser_follow_name(browser);
    ImGui::PopID();
    if (empty && browser->typed.back) isosculpt_browser_up(browser);
    return browser->typed.enter;
}

static bool move_selection(isosculpt_browser *browser) {
    const int steps = browser->typed.steps;
    if (steps) isosculpt_browser_step(browser, steps);
    return steps != 0;
}

static void draw_result(const isosculpt_browser *browser) {
    char whole[ISOSCULPT_PATH];
    const bool named = isosculpt_browser_path(browser, whole);
    ImGui::PushTextWrapPos(0);
    if (browser->error_text[0])
        ImGui::TextColored(ImVec4(1.0f, 0.42f, 0.36f, 1), "%s", browser->error_text);
    else
        ImGui::TextDisabled("%s", named ? whole : " ");
    ImGui::PopTextWrapPos();
}

/* The user's action in a frame. */
enum command { NOTHING, CHOOSE, FOLDER, CLOSE };

static command draw_buttons(const isosculpt_browser *browser) {
    command chosen = ImGui::Button(verb(browser->purpose)) ? CHOOSE : NOTHING;
    ImGui::SameLine();
    if (ImGui::Button("Cancel (Escape)") || browser->typed.escape) chosen = CLOSE;
    if (browser->purpose != ISOSCULPT_BROWSE_OPEN) return chosen;
    ImGui::SameLine();
    if (ImGui::Button("Open this folder (DICOM)")) chosen = FOLDER;
    return chosen;
}

static command draw_inside(isosculpt_browser *browser, float scale) {
    const bool follow = move_selection(browser);
    draw_folder(browser);
    const float below = 4 * ImGui::GetFrameHeightWithSpacing() + 2 * ImGui::GetTextLineHeight();
    ImGui::BeginChild("entries", ImVec2(0, -below), true);
    bool confirmed = draw_entries(browser, follow);
    ImGui::EndChild();
    confirmed |= draw_name(browser);
    draw_type(browser, scale);
    draw_result(browser);
    const command button = draw_buttons(browser);
    return button ? button : confirmed ? CHOOSE : NOTHING;
}

static bool is_chosen(isosculpt_browser *browser, command wanted, char path[ISOSCULPT_PATH]) {
    if (wanted != FOLDER) return wanted == CHOOSE && isosculpt_browser_choose(browser, path);
    snprintf(path, ISOSCULPT_PATH, "%s", browser->folder);
    return true;
}

bool isosculpt_browser_draw(isosculpt_browser *browser, float scale, char path[ISOSCULPT_PATH]) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    char name[64];
    if (!browser->purpose) return false;
    snprintf(name, sizeof name, "%s###browser", title(browser->purpose));
    if (!ImGui::IsPopupOpen("###browser")) ImGui::OpenPopup("###browser");
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(std::fmin(620 * scale, display.x - 16 * scale),
                                    std::fmin(460 * scale, display.y - 16 * scale)),
                             ImGuiCond_Always);
    bool closed = false, chosen = false;
    if (ImGui::BeginPopupModal(name, nullptr, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoResize)) {
        const command wanted = draw_inside(browser, scale);
        closed = wanted == CLOSE;
        chosen = is_chosen(browser, wanted, path);
        if (closed || chosen) ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }
    browser->typed = isosculpt_typed{};
    if (closed || chosen) isosculpt_browser_close(browser);
    return chosen;
}
