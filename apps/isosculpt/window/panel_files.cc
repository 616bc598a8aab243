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
    if ((enter || entered) && screen->path[0]) screen->results |= ISOSCULPT_RESULT_OPEN;
    ImGui::SameLine();
    if (ImGui::Button("Open...")) {
        if (screen->path[0])
            screen->results |= ISOSCULPT_RESULT_OPEN;
        else
            screen->browse = ISOSCULPT_BROWSE_OPEN;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("what is in the box, or a file to choose (Ctrl+O)");
    ImGui::SameLine();
    if (ImGui::Button("Help")) screen->help = !screen->help;
}

static void file_buttons(isosculpt_screen *screen) {
    isosculpt_controller *controller = screen->controller;
    const bool saved = controller->document->changes == controller->document->saved;
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    ImGui::BeginDisabled(screen->volume != nullptr);
    if (ImGui::Button(saved ? "Save###save" : "Save*###save")) controller->commands |= ISOSCULPT_COMMAND_SAVE;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Ctrl+S: %s", controller->document->target);
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

static void show_journal(const isosculpt_document *document) {
    iso_error error = {ISO_OK, ""};
    if (!document->journal[0])
        ImGui::TextColored(RED, "No journal is written: %s. What you make is in memory only: save it.",
                           document->trouble);
    else if (iso_session_journal_status(document->session, &error) != ISO_OK)
        ImGui::TextColored(RED,
                           "The journal lags behind: %s. Nothing is lost in memory, and it is tried again.",
                           error.text);
    else
        show_path(GREEN, "Strokes: ", document->journal);
}

void panel_files(isosculpt_screen *screen) {
    const isosculpt_document *document = screen->controller->document;
    name_box(screen);
    file_buttons(screen);
    ImGui::PushTextWrapPos(0);
    if (screen->volume)
        ImGui::TextColored(GREY, "%s", screen->volume->path);
    else
        ImGui::TextColored(GREY, "%s %s",
                           document->changes == document->saved && document->target_is_own ? "Saved"
                                                                                           : "Saves to",
                           document->target);
    if (!screen->volume) show_journal(document);
    ImGui::PopTextWrapPos();
}
