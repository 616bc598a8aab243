/* The section of the panel for repeaters: copies of each touch along a line, or in rows. */
#include "apps/isosculpt/window/panel_parts.hpp"

/* The most images that a count may have beside the brush's others. */
static int most_images(iso_brush brush, int which) {
    int most = ISO_IMAGES_MOST;
    brush.repeat[which] = 1;
    const int others = iso_brush_image_count(&brush);
    most /= others > 1 ? others : 1;
    return most > 1 ? most : 1;
}

/* How many, and in a second row by how much each is moved. */
static void choose_line(iso_brush *brush, int which, const char *label, double voxel) {
    static const int least = 1;
    const int most = most_images(*brush, which);
    int count = brush->repeat[which] > 1 ? (int)brush->repeat[which] : 1;
    ImGui::PushID(which);
    if (ImGui::DragScalar(label, ImGuiDataType_S32, &count, 0.1f, &least, &most, "\xc3\x97%d",
                          ImGuiSliderFlags_AlwaysClamp)) {
        brush->repeat[which] = (unsigned)count;
        iso_vec3 *by = &brush->repeat_by[which];
        if (iso_vec3_length(*by) == 0) (which ? by->z : by->x) = 2 * brush->radius;
    }
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Each touch acts at so many places, each moved by a further distance: a line, and\n"
                          "with rows a grid. Drag sideways, or double-click and type.");
    double *const at[] = {&brush->repeat_by[which].x, &brush->repeat_by[which].y, &brush->repeat_by[which].z};
    const iso_vec3 before = brush->repeat_by[which];
    const float inner = ImGui::GetStyle().ItemInnerSpacing.x,
                width = (ImGui::GetContentRegionAvail().x - 2 * inner) / 3;
    ImGui::BeginDisabled(count < 2);
    for (int axis = 0; axis < 3; axis++) {
        ImGui::PushID(axis);
        if (axis) ImGui::SameLine(0, inner);
        ImGui::SetNextItemWidth(width);
        ImGui::DragScalar("##by", ImGuiDataType_Double, at[axis], (float)(0.5 * voxel), nullptr, nullptr,
                          "%.5g mm");
        ImGui::PopID();
    }
    ImGui::EndDisabled();
    if (count > 1 && iso_vec3_length(brush->repeat_by[which]) == 0) brush->repeat_by[which] = before;
    ImGui::PopID();
}

void panel_draw_repeat(isosculpt_controller *controller) {
    if (!ImGui::CollapsingHeader("Repeat")) return;
    iso_brush *brush = isosculpt_controller_brush(controller);
    const double voxel = controller->document->start.voxel_size;
    choose_line(brush, 0, "copies", voxel);
    choose_line(brush, 1, "rows", voxel);
}
