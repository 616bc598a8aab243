/* The panel's section of files: opening, saving, and the state of the journal. */
#include <cfloat>
#include <cstring>

#include "apps/isosculpt/window/panel_parts.hpp"

static void draw_browse_button(isosculpt_screen *screen, const char *label, isosculpt_purpose purpose,
                               const char *tip) {
    if (ImGui::Button(label)) screen->browse_request = purpose;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
}

/* The input box for a file to open, with its buttons; Enter opens the file. */
static void draw_path_box(isosculpt_screen *screen) {
    const ImGuiStyle &style = ImGui::GetStyle();
    const float buttons = ImGui::CalcTextSize("New...Open...Help").x + 6 * style.FramePadding.x;
    ImGui::SetNextItemWidth(-buttons - 3 * style.ItemInnerSpacing.x);
    const bool enter =
                   ImGui::InputTextWithHint("##path", "a file to open", screen->typed_path,
                                            sizeof screen->typed_path, ImGuiInputTextFlags_EnterReturnsTrue),
               entered = ImGui::IsItemActive() && screen->browser.typed.enter;
    if ((enter || entered) && screen->typed_path[0]) screen->results |= ISOSCULPT_RESULT_OPEN;
    ImGui::SameLine(0, style.ItemInnerSpacing.x);
    if (ImGui::Button("New...")) screen->controller->commands |= ISOSCULPT_COMMAND_NEW;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("a sphere, box, capsule, cylinder or torus (Ctrl+N)");
    ImGui::SameLine(0, style.ItemInnerSpacing.x);
    if (ImGui::Button("Open...")) {
        if (screen->typed_path[0])
            screen->results |= ISOSCULPT_RESULT_OPEN;
        else
            screen->browse_request = ISOSCULPT_BROWSE_OPEN;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("what is in the box, or a file to choose (Ctrl+O)");
    ImGui::SameLine(0, style.ItemInnerSpacing.x);
    if (ImGui::Button("Help")) screen->help = !screen->help;
}

static void draw_file_buttons(isosculpt_screen *screen) {
    isosculpt_controller *controller = screen->controller;
    const isosculpt_document *document = controller->document;
    const bool saved = !screen->volume && document->change_count == document->saved_change_count;
    const button_row row("Save*Save as...Export...Stamp...", 4);
    if (ImGui::Button(saved ? "Save###save" : "Save*###save")) controller->commands |= ISOSCULPT_COMMAND_SAVE;
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Ctrl+S: %s%s", document->target,
                          screen->volume ? "\nThe surface at the isovalue becomes a field to sculpt." : "");
    row.next();
    draw_browse_button(screen, "Save as...", ISOSCULPT_BROWSE_SAVE,
                       "Ctrl+Shift+S: .vdb (level set), .stl, .ply or .obj (meshes)");
    row.next();
    draw_browse_button(screen, "Export...", ISOSCULPT_BROWSE_EXPORT, "a copy as .stl, .ply, .obj or .vdb");
    row.next();
    ImGui::BeginDisabled(screen->volume != nullptr);
    draw_browse_button(screen, "Stamp...", ISOSCULPT_BROWSE_STAMP, "a mesh to add and carve with");
    ImGui::EndDisabled();
}

/* The file name of a path; the tooltip is the whole path. */
static void draw_path(ImVec4 color, const char *label, const char *path) {
    const char *slash = strrchr(path, '/');
    ImGui::TextColored(color, "%s%s", label, slash ? slash + 1 : path);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", path);
}

static void draw_journal_state(const isosculpt_document *document) {
    iso_error error = {ISO_OK, ""};
    if (!document->journal[0])
        ImGui::TextColored(RED, "No journal is written: %s. What you make is in memory only: save it.",
                           document->journal_error);
    else if (iso_session_journal_status(document->session, &error) != ISO_OK)
        ImGui::TextColored(RED,
                           "The journal lags behind: %s. Nothing is lost in memory, and it is tried again.",
                           error.text);
    else
        draw_path(GREEN, "Strokes: ", document->journal);
}

void panel_draw_files(isosculpt_screen *screen) {
    const isosculpt_document *document = screen->controller->document;
    draw_path_box(screen);
    draw_file_buttons(screen);
    ImGui::PushTextWrapPos(0);
    if (screen->volume)
        ImGui::TextColored(GREY, "%s", screen->volume->path);
    else
        ImGui::TextColored(GREY, "%s %s",
                           document->change_count == document->saved_change_count && document->target_is_own
                               ? "Saved"
                               : "Saves to",
                           document->target);
    if (!screen->volume) draw_journal_state(document);
    ImGui::PopTextWrapPos();
}
