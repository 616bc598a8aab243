/* The panel's section that measures: places that are picked, volume, area and size. */
#include "apps/isosculpt/window/panel_parts.hpp"

static const char STALE[] = "Measured before the last change.";

static void draw_places(const isosculpt_measuring *measuring) {
    char text[40];
    for (int i = 0; i < measuring->count; i++) {
        const iso_measured_place *place = &measuring->place[i];
        isosculpt_length_text(place->thickness, text, sizeof text);
        ImGui::Text("%d: thickness %s", i + 1, text);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("at %.5g, %.5g, %.5g, along the inward normal", place->position.x,
                              place->position.y, place->position.z);
    }
    if (measuring->count < 2) return;
    isosculpt_length_text(isosculpt_measuring_distance(measuring), text, sizeof text);
    ImGui::Text("distance %s", text);
}

static void draw_solid(const iso_solid_measures *solid) {
    const iso_vec3 size = iso_vec3_sub(solid->box.hi, solid->box.lo);
    ImGui::Text("volume %.6g mm\xc2\xb3", solid->volume);
    ImGui::Text("area %.6g mm\xc2\xb2", solid->area);
    ImGui::Text("size %.5g x %.5g x %.5g mm", size.x, size.y, size.z);
}

void panel_draw_measure(isosculpt_controller *controller) {
    isosculpt_measuring *measuring = &controller->measuring;
    if (measuring->on) ImGui::SetNextItemOpen(true);
    if (!ImGui::CollapsingHeader("Measure")) return;
    const isosculpt_document *document = controller->document;
    const button_row row("Pick placesVolume and area", 2);
    const bool on = measuring->on;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_CheckMark));
    if (ImGui::Button("Pick places")) measuring->on = !on;
    if (on) ImGui::PopStyleColor();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("A click on the surface says how thick it is there;\n"
                          "the next one how far away that place is.\nKey: D");
    row.next();
    if (ImGui::Button("Volume and area")) isosculpt_controller_measure_solid(controller);
    draw_places(measuring);
    if (measuring->count && measuring->place_changes != document->change_count)
        ImGui::TextColored(GREY, "%s", STALE);
    if (!measuring->has_solid) return;
    draw_solid(&measuring->solid);
    if (measuring->solid_changes != document->change_count) ImGui::TextColored(GREY, "%s", STALE);
}
