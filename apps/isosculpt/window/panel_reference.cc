/* The section of the panel for the reference: whether it is shown, where, and how opaque. */
#include <cstdio>
#include <cstring>
#include <initializer_list>

#include "apps/isosculpt/window/panel_parts.hpp"

/* The widgets that choose where the reference is shown. Returns whether the choice has changed. */
static bool choose_place(isosculpt_reference_mode *mode, float width) {
    static const char *const names[] = {"in front", "through"};
    bool changed = false;
    ImGui::SetNextItemWidth(width);
    if (ImGui::BeginCombo("##place", names[mode->over])) {
        for (bool over : {false, true})
            if (ImGui::Selectable(names[over], over == mode->over)) {
                mode->over = over;
                changed = true;
            }
        ImGui::EndCombo();
    } else if (ImGui::IsItemHovered())
        ImGui::SetTooltip("in front: what lies in front of the sculpture; through: all of it");
    return changed;
}

/* The widgets for place, opacity and colour in a row. Returns whether something has changed. */
static bool choose_look(isosculpt_reference_mode *mode) {
    const double least = 0.05, most = 1;
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x, place = 0.36f * ImGui::GetContentRegionAvail().x;
    bool changed = choose_place(mode, place);
    ImGui::SameLine(0, gap);
    const float square = mode->labels ? 0 : ImGui::GetFrameHeight() + gap; /* labels have colours */
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - square);
    changed |= ImGui::SliderScalar("##opacity", ImGuiDataType_Double, &mode->opacity, &least, &most,
                                   "opacity %.2f", ImGuiSliderFlags_AlwaysClamp);
    if (mode->labels) return changed;
    ImGui::SameLine(0, gap);
    return panel_edit_color("##colour", &mode->color) || changed;
}

/* Draws a note beside the checkbox: that the reference is still being prepared, or which engine draws it. */
static void draw_note(const isosculpt_screen *screen) {
    const isosculpt_viewport *viewport = screen->controller->viewport;
    const bool gl = viewport->gl && viewport->mode.engine == ISOSCULPT_ENGINE_GL;
    const char *note = screen->reference_pending ? "being made .." : gl ? "(by the cpu)" : nullptr;
    if (!note) return;
    ImGui::SameLine();
    ImGui::TextColored(GREY, "%s", note);
    if (ImGui::IsItemHovered() && !screen->reference_pending)
        ImGui::SetTooltip("with the x-ray, the cpu engine draws the picture");
}

/* A checkbox of one of two references, of which one at most is shown. Returns whether it was clicked. */
static bool choose_one(const char *name, const char *tip, bool labels, isosculpt_reference_mode *mode) {
    bool shown = mode->shown && mode->labels == labels;
    const bool changed = ImGui::Checkbox(name, &shown);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
    if (!changed) return false;
    mode->shown = shown;
    mode->labels = labels;
    return true;
}

/* The checkboxes of references that are made of the session's own file. */
static bool choose_made(const isosculpt_screen *screen, isosculpt_reference_mode *mode) {
    bool changed = choose_one("x-ray of the beginning",
                              "R: the surface as it was when the session began, translucent", false, mode);
    if (screen->has_labels)
        changed |=
            choose_one("other labels", "the segmentation's other labels, each in its colour", true, mode);
    return changed;
}

/* The checkbox that shows the reference. Returns whether it was clicked. */
static bool choose_shown(const isosculpt_screen *screen, isosculpt_reference_mode *mode) {
    const iso_texts *files = screen->references;
    if (!files->count) return choose_made(screen, mode);
    const char *slash = std::strrchr(files->values[0], '/');
    char label[80];
    if (files->count == 1)
        std::snprintf(label, sizeof label, "%.24s###shown", slash ? slash + 1 : files->values[0]);
    else
        std::snprintf(label, sizeof label, "%d reference files###shown", files->count);
    const bool changed = ImGui::Checkbox(label, &mode->shown);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("R: the reference");
    return changed;
}

/* The widgets for the reference picture. Returns whether something has changed. */
static bool choose_backdrop(isosculpt_backdrop *b, double voxel) {
    const double least = 0.05, most = 1;
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x,
                third = (ImGui::GetContentRegionAvail().x - 2 * gap) / 3;
    const char *slash = std::strrchr(b->path, '/'), axis[] = {b->axis, 0};
    char label[80];
    std::snprintf(label, sizeof label, "%.24s###picture", slash ? slash + 1 : b->path);
    bool changed = ImGui::Checkbox(label, &b->shown);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("a picture behind the sculpture");
    ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::GetFrameHeight());
    if (ImGui::Button(axis)) {
        b->axis = b->axis == 'z' ? 'x' : (char)(b->axis + 1);
        changed = true;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("the axis across which it stands");
    ImGui::SetNextItemWidth(1.5f * third);
    changed |= ImGui::SliderScalar("##opacity", ImGuiDataType_Double, &b->opacity, &least, &most,
                                   "opacity %.2f", ImGuiSliderFlags_AlwaysClamp);
    ImGui::SameLine(0, gap);
    double height = b->height;
    ImGui::SetNextItemWidth(1.5f * third);
    if (ImGui::DragScalar("##height", ImGuiDataType_Double, &height, (float)voxel, nullptr, nullptr,
                          "%.5g mm high") &&
        height > 0) {
        b->height = height;
        changed = true;
    }
    double *const at[] = {&b->centre.x, &b->centre.y, &b->centre.z};
    for (int i = 0; i < 3; i++) {
        ImGui::PushID(i);
        if (i) ImGui::SameLine(0, gap);
        ImGui::SetNextItemWidth(third);
        changed |= ImGui::DragScalar("##centre", ImGuiDataType_Double, at[i], (float)(0.5 * voxel), nullptr,
                                     nullptr, "%.5g");
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("where its middle is, mm");
        ImGui::PopID();
    }
    return changed;
}

void panel_draw_reference(isosculpt_screen *screen) {
    if (screen->backdrop->image.rgba) {
        ImGui::PushID("backdrop");
        if (choose_backdrop(screen->backdrop, screen->controller->document->start.voxel_size)) {
            screen->controller->viewport->style++;
            screen->controller->commands |= ISOSCULPT_COMMAND_REDRAW;
        }
        ImGui::PopID();
    }
    isosculpt_reference_mode *mode = &screen->controller->viewport->reference_mode;
    bool changed = choose_shown(screen, mode);
    if (mode->shown) {
        draw_note(screen);
        ImGui::PushID("reference");
        changed |= choose_look(mode);
        ImGui::PopID();
    }
    if (changed) screen->controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}
