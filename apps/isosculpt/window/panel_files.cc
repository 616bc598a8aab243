/* The panel's section of files. */
#include <cfloat>
#include <cstring>

#include "apps/isosculpt/window/panel_parts.hpp"

static void browse_button(isosculpt_screen *screen, const char *label, isosculpt_purpose purpose,
                          const char *tip) {
    if (ImGui::Button(label)) screen->browse = purpose;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
}

/* A file to open by its name; Enter opens it. */
static void name_box(isosculpt_screen *screen) {
    const ImGuiStyle &style = ImGui::GetStyle();
    const float buttons = ImGui::CalcTextSize("Open...Help").x + 4 * style.FramePadding.x;
    ImGui::SetNextItemWidth(-buttons - 2 * style.ItemSpacing.x);
    const bool enter = ImGui::InputTextWithHint("##path", "a file to open", screen->path, sizeof screen->path,
                                                ImGuiInputTextFlags_EnterReturnsTrue),
               entered = ImGui::IsItemActive() && screen->browser.typed.enter;
    if ((enter || entered) && screen->path[0]) screen->answers |= ISOSCULPT_ANSWER_OPEN;
    ImGui::SameLine();
    if (ImGui::Button("Open...")) {
        if (screen->path[0])
            screen->answers |= ISOSCULPT_ANSWER_OPEN;
        else
            screen->browse = ISOSCULPT_BROWSE_OPEN;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("what is in the box, or a file to choose (Ctrl+O)");
    ImGui::SameLine();
    if (ImGui::Button("Help")) screen->help = !screen->help;
}

static void file_buttons(isosculpt_screen *screen) {
    isosculpt_hand *hand = screen->hand;
    const bool saved = hand->desk->changes == hand->desk->saved;
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    ImGui::BeginDisabled(screen->volume != nullptr);
    if (ImGui::Button(saved ? "Save###save" : "Save*###save")) hand->wishes |= ISOSCULPT_WISH_SAVE;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Ctrl+S: %s", hand->desk->target);
    ImGui::SameLine(0, gap);
    browse_button(screen, "Save as...", ISOSCULPT_BROWSE_SAVE,
                  "Ctrl+Shift+S: .vdb (level set), .stl, .ply or .obj (meshes)");
    ImGui::SameLine(0, gap);
    browse_button(screen, "Export...", ISOSCULPT_BROWSE_EXPORT, "a copy as .stl, .ply, .obj or .vdb");
    ImGui::SameLine(0, gap);
    browse_button(screen, "Stamp...", ISOSCULPT_BROWSE_STAMP, "a mesh to add and carve with");
    ImGui::EndDisabled();
}

/* A path by its last part; all of it under the pointer. */
static void show_path(ImVec4 color, const char *what, const char *path) {
    const char *slash = strrchr(path, '/');
    ImGui::TextColored(color, "%s%s", what, slash ? slash + 1 : path);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", path);
}

static void show_journal(const isosculpt_desk *desk) {
    iso_error error = {ISO_OK, ""};
    if (!desk->journal[0])
        ImGui::TextColored(RED, "No journal is written: %s. What you make is in memory only: save it.",
                           desk->trouble);
    else if (iso_session_journal_status(desk->session, &error) != ISO_OK)
        ImGui::TextColored(RED,
                           "The journal lags behind: %s. Nothing is lost in memory, and it is tried again.",
                           error.text);
    else
        show_path(GREEN, "Strokes: ", desk->journal);
}

void panel_files(isosculpt_screen *screen) {
    const isosculpt_desk *desk = screen->hand->desk;
    name_box(screen);
    file_buttons(screen);
    ImGui::PushTextWrapPos(0);
    if (screen->volume)
        ImGui::TextColored(GREY, "%s", screen->volume->path);
    else
        ImGui::TextColored(GREY, "%s %s",
                           desk->changes == desk->saved && desk->target_is_own ? "Saved" : "Saves to",
                           desk->target);
    if (!screen->volume) show_journal(desk);
    ImGui::PopTextWrapPos();
}
