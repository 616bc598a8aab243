/* The panel's section for the plane that cuts, caps, and the light of the picture at rest. */
#include <cmath>
#include <cstring>

#include "apps/common/looks.h"
#include "apps/isosculpt/style.h"
#include "apps/isosculpt/window/panel_parts.hpp"

/* Buttons that turn the plane. Returns whether one was pressed. */
static bool turn_plane(isosculpt_viewport *viewport) {
    static const char *const names[] = {"x", "y", "z", "view", "other side"};
    isosculpt_cut *cut = &viewport->cut;
    const iso_camera *camera = &viewport->camera;
    iso_vec3 outward = cut->outward;
    bool pressed = false;
    const button_row row("xyzviewother side", 5);
    for (int i = 0; i < 5; i++) {
        if (i) row.next();
        if (!ImGui::Button(names[i])) continue;
        pressed = true;
        outward = i < 3    ? iso_vec3_make(i == 0, i == 1, i == 2)
                  : i == 3 ? iso_vec3_sub(camera->position, camera->focal_point)
                           : iso_vec3_scale(cut->outward, -1);
    }
    if (pressed) isosculpt_cut_place(cut, cut->handle, outward);
    return pressed;
}

/* The widgets for caps. Returns whether something has changed. */
static bool choose_cap(isosculpt_viewport *viewport) {
    static const char *const names[] = {"open", "surface", "a colour", "the volume"};
    isosculpt_cut *cut = &viewport->cut;
    const double *values = viewport->values, range = values[1] - values[0];
    bool changed = false;
    if (ImGui::BeginCombo("cap", names[cut->cap.kind])) {
        for (iso_cap_kind kind : {ISO_CAP_NONE, ISO_CAP_SURFACE, ISO_CAP_COLOR, ISO_CAP_SLICE})
            if ((kind != ISO_CAP_SLICE || viewport->lod) &&
                ImGui::Selectable(names[kind], kind == cut->cap.kind)) {
                cut->cap.kind = kind;
                changed = true;
            }
        ImGui::EndCombo();
    }
    if (cut->cap.kind == ISO_CAP_COLOR) changed |= panel_edit_color("of caps", &cut->cap.color);
    if (cut->cap.kind != ISO_CAP_SLICE) return changed;
    double window[2] = {cut->window[0], cut->window[1]};
    if (std::isnan(window[0])) {
        window[0] = 0.5 * (values[0] + values[1]);
        window[1] = range;
    }
    const float speed = (float)(range / 400);
    const double least = 1e-6 * range;
    bool moved =
        ImGui::DragScalar("level", ImGuiDataType_Double, &window[0], speed, &values[0], &values[1], "%.5g");
    moved |= ImGui::DragScalar("width", ImGuiDataType_Double, &window[1], speed, &least, nullptr, "%.5g");
    if (moved && window[1] > 0) std::memcpy(cut->window, window, sizeof window);
    return changed || moved;
}

/* The widgets for the light at rest. Returns whether something has changed. */
static bool choose_light(isosculpt_screen *screen) {
    isosculpt_viewport *viewport = screen->controller->viewport;
    isosculpt_light *light = &viewport->light;
    bool changed = ImGui::Checkbox("occlusion", &light->occlusion.ambient);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("O: what is surrounded is darker, when nothing moves");
    ImGui::SameLine();
    changed |= ImGui::Checkbox("shadow", &light->occlusion.shadow);
    ImGui::SameLine();
    bool outline = light->outline > 0;
    if (ImGui::Checkbox("outline", &outline)) {
        light->outline = outline ? 1 : 0;
        changed = true;
    }
    if (ImGui::BeginCombo("look", "choose ..")) {
        for (int i = 0; iso_look_names[i]; i++)
            if (ImGui::Selectable(iso_look_names[i], false)) {
                isosculpt_style_set(viewport, "look", iso_look_names[i], nullptr);
                changed = true;
            }
        ImGui::EndCombo();
    }
    return changed;
}

/* Draws a note about settings of the panel that do not apply to this picture. */
static void draw_note(const isosculpt_viewport *viewport) {
    const isosculpt_display_mode *mode = &viewport->mode;
    const bool cut = isosculpt_viewport_is_cut(viewport), lit = isosculpt_viewport_has_light(viewport),
               other = mode->material.shading != ISOSCULPT_SHADING_LAMPS ||
                       (mode->engine == ISOSCULPT_ENGINE_GL && viewport->gl) ||
                       (cut && isosculpt_viewport_method(viewport) != mode->method);
    if ((cut || lit) && other)
        ImGui::TextColored(
            GREY, cut ? "drawn by %s on the cpu, with lamps" : "at rest by %s on the cpu, with lamps",
            iso_method_name(isosculpt_viewport_method(viewport)));
    const isosculpt_light drawn = isosculpt_viewport_light(viewport);
    if (viewport->light.occlusion.ambient && !drawn.occlusion.ambient)
        ImGui::TextColored(GREY, "translucent surfaces have no occlusion");
    if (viewport->light.outline > drawn.outline)
        ImGui::TextColored(GREY, "beside translucent surfaces: no outlines");
}

void panel_draw_cut(isosculpt_screen *screen) {
    isosculpt_viewport *viewport = screen->controller->viewport;
    bool plane = viewport->cut.plane >= 0, changed = false;
    if (ImGui::Checkbox("plane that cuts", &plane)) {
        isosculpt_viewport_toggle_plane(viewport);
        changed = true;
    }
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("K: drag its handle to move it, its arrow's tip to tilt it");
    if (viewport->cut.plane >= 0) changed |= turn_plane(viewport);
    if (viewport->cut.count) changed |= choose_cap(viewport);
    changed |= choose_light(screen);
    draw_note(viewport);
    if (!changed) return;
    viewport->style++;
    screen->controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}
