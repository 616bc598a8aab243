/* The dialog for a new session: the solid that it begins with, its size, and that of the voxels. */
#include <cmath>

#include "apps/isosculpt/window/panel_parts.hpp"
#include "sculpt/brush/brush.h"

/* A box for a length in mm. */
static void edit_length(const char *label, double *value) {
    ImGui::InputDouble(label, value, 0, 0, "%.6g mm");
}

static void choose_kind(iso_start_solid *solid) {
    if (!ImGui::BeginCombo("solid", iso_solid_name(solid->kind))) return;
    for (int kind = ISO_SOLID_SPHERE; kind <= ISO_SOLID_TORUS; kind++) {
        if (!ImGui::Selectable(iso_solid_name((iso_solid)kind), kind == solid->kind)) continue;
        static const double across[] = {80, 80, 40, 40, 80}, along[] = {80, 60, 80, 80, 20};
        solid->kind = (iso_solid)kind;
        solid->size = iso_vec3{across[kind], across[kind], along[kind]};
        solid->round = 0;
    }
    ImGui::EndCombo();
}

static void edit_sizes(iso_start_solid *solid) {
    iso_vec3 *size = &solid->size;
    const bool box = solid->kind == ISO_SOLID_BOX;
    edit_length(box ? "along x" : "diameter", &size->x);
    if (box) edit_length("along y", &size->y);
    if (solid->kind != ISO_SOLID_SPHERE)
        edit_length(box ? "along z" : solid->kind == ISO_SOLID_TORUS ? "of its tube" : "along z", &size->z);
    if (box || solid->kind == ISO_SOLID_CYLINDER) edit_length("round edges", &solid->round);
}

void panel_draw_new_dialog(isosculpt_screen *screen, float scale) {
    isosculpt_new *asked = &screen->asked;
    iso_journal_start start;
    iso_error why = {ISO_OK, ""};
    ImGui::PushItemWidth(160 * scale);
    choose_kind(&asked->solid);
    edit_sizes(&asked->solid);
    edit_length("voxels", &asked->voxel);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("the size of the voxels; 0: 1/160 of the longest side");
    ImGui::PopItemWidth();
    const bool can = iso_start_with_solid(&asked->solid, asked->voxel, &start, &why) == ISO_OK;
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + 300 * scale);
    if (can)
        ImGui::TextColored(GREY, "%d x %d x %d voxels of %.4g mm", start.dims[0], start.dims[1],
                           start.dims[2], start.voxel_size);
    else
        ImGui::TextColored(RED, "%s", why.text);
    ImGui::PopTextWrapPos();
    ImGui::BeginDisabled(!can);
    if (ImGui::Button("Begin (Enter)")) screen->results |= ISOSCULPT_RESULT_NEW;
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (ImGui::Button("Stay (Escape)")) screen->results |= ISOSCULPT_RESULT_KEEP;
}

void panel_draw_resampling(isosculpt_screen *screen) {
    const isosculpt_document *document = screen->controller->document;
    const iso_journal_start *start = &document->start;
    double *voxel = &screen->asked_voxel;
    if (*voxel == 0) *voxel = start->voxel_size;
    ImGui::SetNextItemWidth(0.4f * ImGui::GetContentRegionAvail().x);
    ImGui::InputDouble("##voxel", voxel, 0, 0, "%.6g mm");
    double most = 0;
    for (int axis = 0; axis < 3; axis++)
        most = std::fmax(most, start->dims[axis] * start->voxel_size / *voxel);
    const bool fits = *voxel > 0 && most <= ISO_HGRID_MAX && most >= ISO_BRICK,
               other = *voxel != start->voxel_size;
    ImGui::SameLine();
    ImGui::BeginDisabled(!fits || !other || !document->journal[0]);
    if (ImGui::Button("Resample")) screen->results |= ISOSCULPT_RESULT_RESAMPLE;
    ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("%s", !fits ? "So many voxels are too many, or too few."
                                      : "Draws all strokes once more in voxels of this size.\n"
                                        "The strokes until now stay in their file.");
}
