/* The panel, its sections, the help, dialogs and messages, drawn with Dear ImGui. */
#include "apps/isosculpt/window/panel.h"

#include <cctype>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/save.h"
#include "apps/isosculpt/window/keyboard.h"
#include "apps/isosculpt/window/panel_parts.hpp"
#include "base/bridge_guard.hpp"

struct rectangle { /* window coordinates */
    ImVec2 position, size;
    bool contains(double x, double y) const {
        return x >= position.x && y >= position.y && x < position.x + size.x && y < position.y + size.y;
    }
};

struct isosculpt_panel {
    float scale;
    panel_font font;
    bool modal;                               /* a dialog is shown */
    bool close_list;                          /* close lists and colour pickers in the next frame */
    rectangle place, progress_items, message; /* where panel, progress and message were last drawn */
    bool is_over(double x, double y) const {
        return place.contains(x, y) || progress_items.contains(x, y) || message.contains(x, y);
    }
};

static const float PANEL_WIDTH = 304; /* at scale 1 */

/* ---- sections of the panel */

/* The widget for how a picture of heights is turned, for tools that it weighs. */
static void choose_alpha(iso_brush *brush, const iso_stamp *stamp) {
    static const char *const labels[] = {"no picture", "upright", "along the stroke"};
    if (ImGui::BeginCombo("alpha", brush->alpha ? stamp->name : labels[ISO_ALPHA_NONE])) {
        for (iso_alpha alpha : {ISO_ALPHA_NONE, ISO_ALPHA_FIXED, ISO_ALPHA_FOLLOWS})
            if (ImGui::Selectable(labels[alpha], alpha == brush->alpha)) brush->alpha = alpha;
        ImGui::EndCombo();
    } else if (ImGui::IsItemHovered())
        ImGui::SetTooltip("The greys of the picture weigh what a touch does: %s.", labels[brush->alpha]);
}

/* The widgets for the shape of the brush. The stamp can be chosen when one is loaded. */
static void choose_shape(iso_brush *brush, const iso_stamp *stamp) {
    static const iso_solid shapes[] = {ISO_SOLID_SPHERE, ISO_SOLID_BOX, ISO_SOLID_CYLINDER, ISO_SOLID_TORUS,
                                       ISO_SOLID_STAMP};
    const auto name = [&](iso_solid shape) {
        return shape == ISO_SOLID_STAMP && stamp ? stamp->name : iso_solid_name(shape);
    };
    if (stamp && stamp->heights.value && iso_tool_has_alpha(brush->tool)) {
        choose_alpha(brush, stamp);
        return;
    }
    if (stamp && !stamp->count) stamp = nullptr; /* a picture is no shape */
    if (brush->shape == ISO_SOLID_STAMP && !stamp) brush->shape = ISO_SOLID_SPHERE;
    ImGui::BeginDisabled(!isosculpt_tool_has_shape(brush->tool));
    if (ImGui::BeginCombo("shape", name(brush->shape))) {
        for (iso_solid shape : shapes)
            if ((shape != ISO_SOLID_STAMP || stamp) && ImGui::Selectable(name(shape), shape == brush->shape))
                brush->shape = shape;
        ImGui::EndCombo();
    }
    if (brush->shape != ISO_SOLID_SPHERE && brush->shape != ISO_SOLID_STAMP) {
        const double low = 0.05, high = 2;
        if (!(brush->aspect > 0)) brush->aspect = 0.5;
        ImGui::SliderScalar("aspect", ImGuiDataType_Double, &brush->aspect, &low, &high, "%.2f",
                            ImGuiSliderFlags_AlwaysClamp);
    }
    ImGui::EndDisabled();
}

/* The widgets for the colour of the brush, at the end of a row. */
static void choose_color(iso_brush *brush) {
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x, side = ImGui::GetFrameHeight();
    const bool paints = brush->tool == ISO_TOOL_PAINT;
    ImGui::SameLine(ImGui::GetContentRegionMax().x - (paints ? side : 2 * side + gap));
    ImGui::BeginDisabled(!isosculpt_tool_has_color(brush->tool));
    if (!paints) {
        ImGui::Checkbox("##colored", &brush->has_color);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("The surface that the brush makes gets this colour; else it has no paint.");
        ImGui::SameLine(0, gap);
    }
    panel_edit_color("##color", &brush->color);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("The colour of the brush. E takes it from the surface under the pointer.");
    ImGui::EndDisabled();
}

/* The widget for the number of radial images, before that for the colour. */
static void choose_radial(iso_brush *brush) {
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x, side = ImGui::GetFrameHeight();
    static const int least = 1, most = ISO_RADIAL_MOST;
    int count = iso_brush_is_radial(brush) ? (int)brush->radial : 1;
    ImGui::SameLine(0, gap);
    ImGui::SetNextItemWidth(ImGui::GetContentRegionMax().x - 2 * (side + gap) - ImGui::GetCursorPosX());
    if (ImGui::DragScalar("##radial", ImGuiDataType_S32, &count, 0.1f, &least, &most, "\xc3\x97%d",
                          ImGuiSliderFlags_AlwaysClamp))
        brush->radial = (unsigned)count;
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Radial symmetry: each touch acts at so many places around an axis.\n"
                          "Drag sideways, or double-click and type.");
}

/* The button for the axis that radial images are turned around. */
static void choose_axis(iso_brush *brush) {
    const int axis = iso_brush_radial_axis(brush);
    const char name[] = {(char)('x' + axis), '#', '#', 'r', 0};
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (ImGui::Button(name)) brush->radial_axis = (char)('x' + (axis + 1) % 3);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("The axis of the radial symmetry.");
}

/* Whether a coordinate of the brush's mirror matters. */
static bool has_centre(const iso_brush *brush, int axis) {
    return brush->symmetry >> axis & 1 ||
           (iso_brush_is_radial(brush) && iso_brush_radial_axis(brush) != axis);
}

/* The widgets for the symmetries and where their planes and axis are, and the colour. */
static void choose_mirror(isosculpt_controller *controller, iso_brush *brush) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("mirror");
    for (unsigned axis = 0; axis < 3; axis++) {
        const char name[2] = {(char)('x' + axis), 0};
        ImGui::SameLine(0, axis ? ImGui::GetStyle().ItemInnerSpacing.x : -1);
        ImGui::CheckboxFlags(name, &brush->symmetry, 1u << axis);
    }
    choose_radial(brush);
    choose_color(brush);
    if (!brush->symmetry && !iso_brush_is_radial(brush)) return;
    double *const at[] = {&brush->mirror.x, &brush->mirror.y, &brush->mirror.z};
    const float speed = (float)(0.5 * controller->document->start.voxel_size);
    const float inner = ImGui::GetStyle().ItemInnerSpacing.x, padding = ImGui::GetStyle().FramePadding.x,
                buttons = ImGui::CalcTextSize(iso_brush_is_radial(brush) ? "centrez" : "centre").x +
                          (iso_brush_is_radial(brush) ? 4 * padding + 2 * inner : 2 * padding + inner),
                width = (ImGui::GetContentRegionAvail().x - buttons - 2 * inner) / 3;
    for (int axis = 0; axis < 3; axis++) {
        ImGui::PushID(axis);
        if (axis) ImGui::SameLine(0, inner);
        ImGui::SetNextItemWidth(width);
        ImGui::BeginDisabled(!has_centre(brush, axis));
        ImGui::DragScalar("##mirror", ImGuiDataType_Double, at[axis], speed, nullptr, nullptr, "%.5g");
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("where the planes and the axis are, mm");
        ImGui::EndDisabled();
        ImGui::PopID();
    }
    ImGui::SameLine(0, inner);
    if (ImGui::Button("centre")) isosculpt_controller_center_mirror(controller);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("the planes and the axis pass through the middle of the object");
    if (iso_brush_is_radial(brush)) choose_axis(brush);
}

/* A brush of the panel: the label of its button, and what it does. */
struct brush_button {
    const char *label, *tip;
};
static const brush_button BRUSHES[ISOSCULPT_TOOLS] = {
    {"add", "Adds material along the stroke: a tube, or the shape that is chosen.\nAlt: carves."},
    {"carve", "Takes material away along the stroke.\nAlt: adds."},
    {"blend", "Adds material with a smooth transition to what is there.\nAlt: carves with one."},
    {"smooth", "Evens out bumps and dents. Shift does this with every brush."},
    {"inflate", "Moves the surface outwards.\nAlt: inwards."},
    {"flatten", "Moves the surface to a plane through the place under the pointer."},
    {"pinch", "Gathers the surface towards the middle of the brush: sharper edges."},
    {"move", "Drags what lies under the brush along with the pointer."},
    {"mask", "Freezes the surface, which no brush moves then.\nAlt: frees it."},
    {"clay", "Adds a layer, and levels what is below it.\nAlt: scrapes."},
    {"scrape", "Takes off what rises above the surface around it.\nAlt: fills."},
    {"fill", "Fills what is lower than the surface around it.\nAlt: scrapes."},
    {"crease", "Digs a sharp groove along the stroke."},
    {"hook", "Draws a horn or a tentacle out of the surface, along the pointer's path."},
    {"paint", "Lays the colour over the surface.\nAlt: takes paint away."},
    {"line", "Removes what is on the right of a line that is drawn over the picture.\nAlt: on the left."},
    {"lasso", "Removes what lies within a line that is drawn around it.\nAlt: what lies outside."}};
/* The first so many are in a grid, the others beside the buttons for the mask. */
enum { BRUSHES_IN_GRID = 15 };

/* The button of a tool; width 0: as wide as its label. */
static void choose_tool(isosculpt_controller *controller, iso_brush *brush, int number, float width) {
    const bool chosen = brush->tool == isosculpt_controller_tool(number), own = brush == &controller->brush;
    const char key = isosculpt_controller_tool_key(number), shown = (char)toupper(key);
    char label[32];
    snprintf(label, sizeof label, width > 0 ? "%c  %s" : "%c %s", shown, BRUSHES[number].label);
    if (chosen) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_CheckMark));
    if (ImGui::Button(label, ImVec2(width, 0))) {
        if (own)
            isosculpt_controller_key(controller, key, 0, true);
        else
            brush->tool = isosculpt_controller_tool(number);
    }
    if (chosen) ImGui::PopStyleColor();
    if (ImGui::IsItemHovered() && own) ImGui::SetTooltip("%s\nKey: %c", BRUSHES[number].tip, shown);
}

static void choose_brush(isosculpt_controller *controller, iso_brush *brush) {
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x,
                width = (ImGui::GetContentRegionAvail().x - 2 * gap) / 3;
    for (int i = 0; i < BRUSHES_IN_GRID; i++) {
        if (i % 3) ImGui::SameLine(0, gap);
        choose_tool(controller, brush, i, width);
    }
}

/* The buttons for the whole mask, and for trimming. */
static void change_mask(isosculpt_controller *controller, iso_brush *brush) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("mask");
    ImGui::SameLine();
    const button_row row("InvertBlurClearB lineA lasso", 5);
    if (ImGui::Button("Invert")) isosculpt_controller_change_mask(controller, ISO_TOOL_INVERT_MASK);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("The mask: freezes what is free, and frees the rest.\nKey: Ctrl+I");
    row.next();
    ImGui::BeginDisabled(!iso_session_has_mask(controller->document->session));
    if (ImGui::Button("Blur")) isosculpt_controller_change_mask(controller, ISO_TOOL_BLUR_MASK);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Smooths the border of the mask, over the brush's radius (16 voxels at most).");
    row.next();
    if (ImGui::Button("Clear")) isosculpt_controller_change_mask(controller, ISO_TOOL_CLEAR_MASK);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("The mask: frees everything.\nKey: Alt+M");
    ImGui::EndDisabled();
    for (int i = BRUSHES_IN_GRID; i < ISOSCULPT_TOOLS; i++) {
        row.next();
        choose_tool(controller, brush, i, 0);
    }
}

/* `own`: it is the brush of strokes to come. The strength of a past stroke that adds or removes a solid is in
 * its path. */
static void choose_strength(iso_brush *brush, bool own) {
    const double none = 0.02, full = 1;
    const bool in_path = !own && isosculpt_tool_has_shape(brush->tool);
    ImGui::BeginDisabled(in_path || !isosculpt_tool_has_strength(brush->tool));
    ImGui::SliderScalar("strength", ImGuiDataType_Double, &brush->strength, &none, &full, "%.2f",
                        ImGuiSliderFlags_AlwaysClamp);
    ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("%s", !isosculpt_tool_has_strength(brush->tool) ? "It has no strength."
                                : in_path ? "How high it is built up, or how deep it is carved, is in\n"
                                            "the path of a stroke."
                                : isosculpt_tool_has_shape(brush->tool)
                                    ? "How high the stroke is built up, or how deep it is carved:\n"
                                      "1 is the radius. C and moving the mouse change it."
                                    : "How much a touch changes. C and moving the mouse change it.");
}

static void draw_brush_section(const isosculpt_screen *screen) {
    isosculpt_controller *controller = screen->controller;
    const iso_stroke *stroke = panel_draw_stroke_title(controller);
    iso_brush *brush = isosculpt_controller_brush(controller);
    const bool own = stroke == nullptr;
    const iso_stamp *stamp = own ? iso_session_stamp(controller->document->session) : stroke->stamp;
    if (!own && brush->tool >= ISO_TOOL_CLEAR_MASK) return; /* it has no brush */
    choose_brush(controller, brush);
    const double voxel = controller->document->start.voxel_size, low = ISOSCULPT_RADIUS_LEAST * voxel,
                 high = ISOSCULPT_RADIUS_MOST * voxel;
    ImGui::SliderScalar("radius", ImGuiDataType_Double, &brush->radius, &low, &high, "%.2f mm",
                        ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("[ and ], or X and moving the mouse, change it.");
    choose_strength(brush, own);
    choose_shape(brush, stamp);
    choose_mirror(controller, brush);
    change_mask(controller, brush);
    controller->brush_held = !own && ImGui::IsAnyItemActive();
    if (!screen->pen) return;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("pressure");
    ImGui::SameLine();
    ImGui::Checkbox("size", &brush->pressure_radius);
    ImGui::SameLine();
    ImGui::Checkbox("strength##pen", &brush->pressure_strength);
}

bool panel_edit_color(const char *label, iso_rgb *color) {
    float rgb[3] = {(float)color->r / 255, (float)color->g / 255, (float)color->b / 255};
    if (!ImGui::ColorEdit3(label, rgb, ImGuiColorEditFlags_NoInputs)) return false;
    *color = iso_rgb{(uint8_t)std::lround(255 * rgb[0]), (uint8_t)std::lround(255 * rgb[1]),
                     (uint8_t)std::lround(255 * rgb[2])};
    return true;
}

/* The widget for the engine; its tooltip says which engine drew the picture. Returns whether the choice has
 * changed. */
static bool choose_engine(isosculpt_viewport *viewport) {
    static const char *const names[] = {"engine: cpu", "engine: gl"};
    isosculpt_engine *engine = &viewport->mode.engine;
    bool changed = false;
    if (!viewport->gl) {
        ImGui::TextColored(GREY, "%s", names[ISOSCULPT_ENGINE_CPU]);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("there is no OpenGL 4.5");
        return false;
    }
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::BeginCombo("##engine", names[*engine], ImGuiComboFlags_NoArrowButton)) {
        for (isosculpt_engine i : {ISOSCULPT_ENGINE_CPU, ISOSCULPT_ENGINE_GL})
            if (ImGui::Selectable(names[i], i == *engine)) {
                *engine = i;
                viewport->gl_error.text[0] = 0;
                changed = true;
            }
        ImGui::EndCombo();
    } else if (ImGui::IsItemHovered() && viewport->drawn.canvas)
        ImGui::SetTooltip("drawn by %s", isosculpt_gl_renderer(viewport->gl));
    else if (ImGui::IsItemHovered())
        ImGui::SetTooltip("drawn by the cpu engine");
    if (!viewport->gl_error.text[0]) return changed;
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored(RED, "%s", viewport->gl_error.text);
    ImGui::PopTextWrapPos();
    return changed;
}

/* Buttons that show the surface from a side. */
static void choose_side(isosculpt_controller *controller) {
    static const struct {
        const char *name, *tip;
        iso_direction direction;
    } sides[] = {{"front", "Shift+1", ISO_FRONT}, {"back", "Ctrl+1", ISO_BACK},
                 {"right", "Shift+3", ISO_RIGHT}, {"left", "Ctrl+3", ISO_LEFT},
                 {"top", "Shift+7", ISO_TOP},     {"bottom", "Ctrl+7", ISO_BOTTOM}};
    const button_row row("frontbackrightlefttopbottom", 6);
    for (int i = 0; i < 6; i++) {
        if (i) row.next();
        if (ImGui::Button(sides[i].name)) isosculpt_controller_set_direction(controller, sides[i].direction);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", sides[i].tip);
    }
}

/* Buttons that copy the command that draws the picture, and save the picture. */
static void draw_picture_buttons(isosculpt_screen *screen) {
    const button_row row("Copy isorender commandPicture...", 2);
    if (ImGui::Button("Copy isorender command")) screen->results |= ISOSCULPT_RESULT_COMMAND;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("a command that draws this picture, to the clipboard");
    row.next();
    if (ImGui::Button("Picture...")) screen->browse_request = ISOSCULPT_BROWSE_PICTURE;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("save it under a name; F12: beside the file, at once");
}

static void draw_picture_section(isosculpt_screen *screen) {
    isosculpt_controller *controller = screen->controller;
    isosculpt_display_mode *mode = &controller->viewport->mode;
    bool changed = false;
    if (ImGui::BeginCombo("method", iso_method_name(mode->method))) {
        for (const iso_method method : isosculpt_methods)
            if (ImGui::Selectable(iso_method_name(method), method == mode->method)) {
                mode->method = method;
                changed = true;
            }
        ImGui::EndCombo();
    }
    if (ImGui::BeginCombo("light", isosculpt_shading_name(mode->material.shading))) {
        for (int i = 0; i < ISOSCULPT_SHADING_COUNT; i++)
            if (ImGui::Selectable(isosculpt_shading_name((isosculpt_shading)i),
                                  i == (int)mode->material.shading)) {
                mode->material.shading = (isosculpt_shading)i;
                changed = true;
            }
        ImGui::EndCombo();
    }
    changed |= panel_edit_color("surface", &mode->material.color);
    ImGui::SameLine();
    changed |= panel_edit_color("background", &mode->material.background);
    ImGui::SameLine();
    changed |= choose_engine(controller->viewport);
    if (changed) controller->commands |= ISOSCULPT_COMMAND_REDRAW;
    choose_side(controller);
    draw_picture_buttons(screen);
    if (!screen->volume) panel_draw_reference(screen);
}

static void draw_history_section(isosculpt_controller *controller, float scale) {
    const iso_history *history = iso_session_history(controller->document->session);
    const size_t position = iso_history_position(history), count = iso_history_count(history);
    size_t wanted = position;
    ImGui::BeginChild("steps", ImVec2(0, 96 * scale), true);
    if (ImGui::Selectable("the beginning", position == 0)) wanted = 0;
    ImGuiListClipper clipper;
    clipper.Begin((int)count);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; i++) {
            char label[96];
            snprintf(label, sizeof label, "%d  %s", i + 1, iso_history_name(history, (size_t)i));
            bool undone = (size_t)i >= position;
            if (undone) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
            if (ImGui::Selectable(label, (size_t)i + 1 == position)) wanted = (size_t)i + 1;
            if (undone) ImGui::PopStyleColor();
        }
    if (controller->drag == ISOSCULPT_DRAG_BRUSH || ImGui::GetScrollY() >= ImGui::GetScrollMaxY())
        ImGui::SetScrollHereY(1);
    ImGui::EndChild();
    if (wanted != position) isosculpt_controller_go_to_step(controller, wanted);
}

static void draw_latency_row(const char *name, const isosculpt_latency *latency) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    for (double quantile : {0.5, 0.99}) {
        ImGui::TableNextColumn();
        if (latency->count)
            ImGui::Text("%.2f", 1e3 * isosculpt_latency_quantile(latency, quantile));
        else
            ImGui::TextUnformatted("-");
    }
}

/* resampling: the screen, where the field can be resampled; else NULL. */
static void draw_numbers_section(isosculpt_controller *controller, isosculpt_screen *resampling) {
    const iso_grid *grid = &controller->viewport->grid;
    const int *dims = iso_grid_dims(grid);
    ImGui::Text("%d x %d x %d voxels of %.4g mm", dims[0], dims[1], dims[2],
                iso_grid_transform(grid)->spacing[0]);
    if (grid->hgrid)
        ImGui::Text("%.2f M of them stored, in %.0f MB",
                    1e-6 * ISO_BRICK_VOXELS * (double)iso_hgrid_brick_count(grid->hgrid),
                    1e-6 * (double)iso_hgrid_bytes(grid->hgrid));
    ImGui::Text("%.2f M points", 1e-6 * (double)isosculpt_viewport_point_count(controller->viewport));
    if (resampling) panel_draw_resampling(resampling);
    if (!ImGui::BeginTable("latency", 3, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("milliseconds", ImGuiTableColumnFlags_WidthStretch, 2);
    ImGui::TableSetupColumn("p50", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("p99", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableHeadersRow();
    draw_latency_row("edit", &controller->edit);
    draw_latency_row("extract", &controller->viewport->extract);
    draw_latency_row("draw", &controller->viewport->draw);
    ImGui::EndTable();
}

static void draw_panel(isosculpt_panel *panel, isosculpt_screen *screen) {
    ImGui::SetNextWindowPos(ImVec2(0, 0), ImGuiCond_Always);
    ImGui::SetNextWindowSize(ImVec2((float)isosculpt_panel_width(panel), ImGui::GetIO().DisplaySize.y),
                             ImGuiCond_Always);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    ImGui::Begin("isosculpt", nullptr,
                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar(2);
    ImGui::PushItemWidth(-76 * panel->scale);
    const bool viewing_volume = screen->volume != nullptr, brush = !viewing_volume || screen->sculpting;
    const ImGuiTreeNodeFlags open = ImGuiTreeNodeFlags_DefaultOpen;
    if (!brush && ImGui::CollapsingHeader("Isovalue", open)) panel_draw_isovalue(screen, panel->scale);
    if (brush && ImGui::CollapsingHeader("Brush", open)) draw_brush_section(screen);
    if (ImGui::CollapsingHeader("Picture", open)) draw_picture_section(screen);
    if (ImGui::CollapsingHeader("Files", open)) panel_draw_files(screen);
    if (!viewing_volume && ImGui::CollapsingHeader("History", open))
        draw_history_section(screen->controller, panel->scale);
    if (ImGui::CollapsingHeader("Cut and light")) panel_draw_cut(screen);
    if (screen->volume && ImGui::CollapsingHeader("Colour by data")) panel_draw_colors(screen);
    if (ImGui::CollapsingHeader("Numbers"))
        draw_numbers_section(screen->controller, viewing_volume ? nullptr : screen);
    if (!viewing_volume) panel_draw_strokes(screen->controller, panel->scale);
    if (!viewing_volume) panel_draw_measure(screen->controller);
    if (!viewing_volume) panel_draw_repeat(screen->controller);
    ImGui::PopItemWidth();
    panel->place = rectangle{ImGui::GetWindowPos(), ImGui::GetWindowSize()};
    ImGui::End();
}

/* ---- progress of background tasks */

/* The middle of the picture, in window coordinates. */
static float picture_middle(const isosculpt_screen *screen) {
    return (float)((screen->picture_x + 0.5 * screen->picture_width) / screen->pixels);
}

/* Draws the progress of tasks at the lower edge, also while the panel is hidden. */
static void draw_progress(isosculpt_panel *panel, isosculpt_screen *screen) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(picture_middle(screen), display.y - 16 * panel->scale), ImGuiCond_Always,
                            ImVec2(0.5f, 1));
    ImGui::SetNextWindowSize(ImVec2(420 * panel->scale, 0), ImGuiCond_Always);
    ImGui::Begin("##busy", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    for (int i = 0; i < screen->progress_item_count; i++) {
        const isosculpt_progress_item *item = &screen->progress_items[i];
        ImGui::PushID(i);
        ImGui::TextUnformatted(item->text);
        ImGui::ProgressBar((float)item->fraction, ImVec2(280 * panel->scale, 0));
        ImGui::SameLine();
        if (ImGui::Button(i ? "Cancel" : "Cancel (Escape)"))
            screen->results |= (unsigned)ISOSCULPT_RESULT_CANCEL << i;
        ImGui::PopID();
    }
    panel->progress_items = rectangle{ImGui::GetWindowPos(), ImGui::GetWindowSize()};
    ImGui::End();
}

/* ---- the message */

/* Draws the message above the progress, also while the panel is hidden. An error stays until it is
 * dismissed. */
static void draw_message(isosculpt_panel *panel, isosculpt_screen *screen) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float below = screen->progress_item_count ? display.y - panel->progress_items.position.y : 0,
                gap = 16 * panel->scale;
    ImGui::SetNextWindowPos(ImVec2(picture_middle(screen), display.y - gap - below), ImGuiCond_Always,
                            ImVec2(0.5f, 1));
    ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(display.x - 2 * gap, display.y));
    ImGui::Begin("##message", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::PushTextWrapPos(std::fmin(560 * panel->scale, display.x - 4 * gap));
    ImGui::TextColored(screen->message_is_error ? RED : GREY, "%s", screen->message);
    ImGui::PopTextWrapPos();
    if (screen->message_is_error && ImGui::SmallButton("put this away")) screen->message[0] = 0;
    panel->message = rectangle{ImGui::GetWindowPos(), ImGui::GetWindowSize()};
    ImGui::End();
}

/* ---- help and dialogs */

static void draw_help(isosculpt_screen *screen, float scale) {
#define KEY_ROW(key, meaning) {key, meaning},
    static const char *const rows[][2] = {ISOSCULPT_KEYS(KEY_ROW)};
#undef KEY_ROW
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(std::fmin(700 * scale, display.x - 16 * scale), 0), ImGuiCond_Always);
    ImGui::Begin("Help", &screen->help,
                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoInputs |
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse);
    if (ImGui::BeginTable("keys", 2)) {
        ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed);
        ImGui::TableSetupColumn("meaning", ImGuiTableColumnFlags_WidthStretch);
        for (const auto &row : rows) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(row[0]);
            ImGui::TableNextColumn();
            ImGui::TextWrapped("%s", row[1]);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

/* Begins a modal dialog in the middle of the window if `shown` is set. If it returns true, the caller calls
 * ImGui::EndPopup. Results come from the dialog's buttons or from keys (events.c). */
static bool begin_dialog(const char *title, bool shown) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (shown && !ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    bool open = ImGui::BeginPopupModal(title, nullptr,
                                       ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
    if (open && !shown) ImGui::CloseCurrentPopup();
    return open;
}

static void draw_result_button(isosculpt_screen *screen, const char *label, unsigned results) {
    if (ImGui::Button(label)) screen->results |= results;
}

static void draw_recover_dialog(isosculpt_screen *screen) {
    if (!begin_dialog("Recover?", screen->dialog == ISOSCULPT_DIALOG_RECOVER)) return;
    ImGui::Text("A session was not closed:\n%s\n\nIts strokes are all there.", screen->dialog_path);
    draw_result_button(screen, "Recover it (Enter)", ISOSCULPT_RESULT_RECOVER);
    ImGui::SameLine();
    draw_result_button(screen, "Start new (the file stays)", ISOSCULPT_RESULT_DISMISS);
    ImGui::EndPopup();
}

static void draw_unsaved_text(const isosculpt_screen *screen) {
    const char *journal = screen->controller->document->journal;
    if (journal[0])
        ImGui::Text("What you did is not saved. The stroke file has all of it:\n%s", journal);
    else
        ImGui::TextColored(RED, "What you did is in no file.");
    ImGui::Text("\nSaving writes\n%s\n\n", screen->controller->document->target);
}

static void draw_close_dialog(isosculpt_screen *screen) {
    if (!begin_dialog("Close?", screen->dialog == ISOSCULPT_DIALOG_CLOSE)) return;
    draw_unsaved_text(screen);
    draw_result_button(screen, "Save and close (Enter)", ISOSCULPT_RESULT_SAVE | ISOSCULPT_RESULT_PROCEED);
    ImGui::SameLine();
    draw_result_button(screen, "Close", ISOSCULPT_RESULT_PROCEED);
    ImGui::SameLine();
    draw_result_button(screen, "Stay (Escape)", ISOSCULPT_RESULT_KEEP);
    ImGui::EndPopup();
}

static void draw_open_dialog(isosculpt_screen *screen) {
    if (!begin_dialog("Open?", screen->dialog == ISOSCULPT_DIALOG_OPEN)) return;
    ImGui::Text("%s\nis to be opened in place of what is here.\n\n", screen->dialog_path);
    draw_unsaved_text(screen);
    draw_result_button(screen, "Save and open (Enter)", ISOSCULPT_RESULT_SAVE | ISOSCULPT_RESULT_PROCEED);
    ImGui::SameLine();
    draw_result_button(screen, "Open", ISOSCULPT_RESULT_PROCEED);
    ImGui::SameLine();
    draw_result_button(screen, "Stay (Escape)", ISOSCULPT_RESULT_KEEP);
    ImGui::EndPopup();
}

static void draw_mesh_dialog(isosculpt_screen *screen) {
    if (!begin_dialog("A mesh", screen->dialog == ISOSCULPT_DIALOG_MESH)) return;
    ImGui::Text("%s", screen->dialog_path);
    draw_result_button(screen, "Sculpt it (Enter)", ISOSCULPT_RESULT_OPEN);
    ImGui::SameLine();
    draw_result_button(screen, "Add and carve with it (S)", ISOSCULPT_RESULT_STAMP);
    ImGui::SameLine();
    draw_result_button(screen, "Neither (Escape)", ISOSCULPT_RESULT_KEEP);
    ImGui::EndPopup();
}

static void draw_replace_dialog(isosculpt_screen *screen) {
    if (!begin_dialog("Replace?", screen->dialog == ISOSCULPT_DIALOG_REPLACE)) return;
    const bool picture = screen->chosen_purpose == ISOSCULPT_BROWSE_PICTURE;
    ImGui::Text("%s\nis there already.%s\n\n", screen->dialog_path,
                picture ? "" : " It will be kept with .bak added to its name.");
    draw_result_button(screen, "Replace it (Enter)", ISOSCULPT_RESULT_REPLACE);
    ImGui::SameLine();
    draw_result_button(screen, "Keep it (Escape)", ISOSCULPT_RESULT_KEEP);
    ImGui::EndPopup();
}

static void draw_new_dialog(isosculpt_screen *screen, float scale) {
    if (!begin_dialog("New", screen->dialog == ISOSCULPT_DIALOG_NEW)) return;
    panel_draw_new_dialog(screen, scale);
    ImGui::EndPopup();
}

/* ---- the browser */

/* Opens the browser: at the folder in the input box, or at the target, with the file's name in the box. */
static void open_browser(isosculpt_screen *screen) {
    char path[ISOSCULPT_PATH];
    const isosculpt_purpose purpose = screen->browse_request;
    const char *target = screen->controller->document->target, *typed = screen->typed_path;
    screen->browse_request = ISOSCULPT_BROWSE_NOTHING;
    if (purpose == ISOSCULPT_BROWSE_EXPORT)
        isosculpt_path_unused(target, ".stl", path);
    else if (purpose == ISOSCULPT_BROWSE_PICTURE)
        isosculpt_path_unused(target, ".png", path);
    else
        snprintf(path, sizeof path, "%s", target);
    isosculpt_browser_open(&screen->browser, purpose, path);
    if (!typed[0] || purpose == ISOSCULPT_BROWSE_PICTURE) return;
    if (purpose == ISOSCULPT_BROWSE_OPEN && isosculpt_browser_is_folder(typed))
        isosculpt_browser_enter(&screen->browser, typed);
    else
        snprintf(screen->browser.name, sizeof screen->browser.name, "%s", typed);
    screen->typed_path[0] = 0;
}

static void draw_browser(isosculpt_panel *panel, isosculpt_screen *screen) {
    if (screen->browse_request && !screen->dialog && !screen->browser.purpose) open_browser(screen);
    const isosculpt_purpose purpose = screen->browser.purpose;
    const bool chosen = isosculpt_browser_draw(&screen->browser, panel->scale, screen->chosen_path);
    screen->browser.typed = isosculpt_typed{}; /* the panel's input box has already handled these keys */
    if (!chosen) return;
    screen->chosen_purpose = purpose;
    screen->results |= ISOSCULPT_RESULT_CHOSEN;
}

/* ---- a frame */

static void draw_all(isosculpt_panel *panel, isosculpt_screen *screen) {
    panel->modal = screen->dialog != ISOSCULPT_DIALOG_NOTHING || screen->browser.purpose;
    panel->place = panel->progress_items = panel->message = rectangle{ImVec2(0, 0), ImVec2(0, 0)};
    screen->isovalue_dragged = screen->controller->brush_held = false;
    if (screen->panel && !screen->blank) draw_panel(panel, screen);
    if (screen->progress_item_count) draw_progress(panel, screen);
    if (screen->help) draw_help(screen, panel->scale);
    if (screen->message[0]) draw_message(panel, screen);
    draw_recover_dialog(screen);
    draw_close_dialog(screen);
    draw_open_dialog(screen);
    draw_mesh_dialog(screen);
    draw_replace_dialog(screen);
    draw_new_dialog(screen, panel->scale);
    draw_browser(panel, screen);
    const isosculpt_controller *controller = screen->controller;
    const bool over =
        panel->is_over((controller->x + screen->picture_x) / screen->pixels, controller->y / screen->pixels);
    const bool brush = !screen->volume || screen->sculpting;
    panel_draw_picture(screen, panel->scale);
    panel_draw_color_bar(screen, panel->scale);
    if (brush && !screen->blank && !panel->modal && (!over || controller->drag == ISOSCULPT_DRAG_BRUSH))
        panel_draw_brush(screen, panel->scale);
}

double isosculpt_panel_width(const isosculpt_panel *panel) {
    return panel ? (double)std::floor(PANEL_WIDTH * panel->scale) : 0;
}

/* The number of modal dialogs that are open; lists and colour pickers are popups above them. */
static int count_dialogs() {
    const ImGuiContext &context = *ImGui::GetCurrentContext();
    int count = 0;
    while (count < context.OpenPopupStack.Size && context.OpenPopupStack[count].Window &&
           context.OpenPopupStack[count].Window->Flags & ImGuiWindowFlags_Modal)
        count++;
    return count;
}

static bool has_list() {
    return ImGui::GetCurrentContext()->OpenPopupStack.Size > count_dialogs();
}

static void close_lists() {
    if (has_list()) ImGui::ClosePopupToLevel(count_dialogs(), true);
}

bool isosculpt_panel_close_list(isosculpt_panel *panel) {
    if (panel->close_list || !has_list()) return false;
    panel->close_list = true;
    return true;
}

iso_status isosculpt_panel_draw(isosculpt_panel *panel, isosculpt_screen *screen, iso_error *error) {
    return iso::guard("Dear ImGui", error, [&] {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        if (panel->close_list) close_lists();
        panel->close_list = false;
        draw_all(panel, screen);
        ImGui::Render();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
        return ISO_OK;
    });
}

bool isosculpt_panel_has_pointer(const isosculpt_panel *panel, double x, double y) {
    return panel->modal || panel->is_over(x, y) || ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
}

bool isosculpt_panel_has_keys(void) {
    return ImGui::GetIO().WantTextInput;
}

/* ---- creating and destroying */

/* Starts Dear ImGui's two back ends. */
static bool start_back_ends(void *window) {
    if (!ImGui_ImplGlfw_InitForOpenGL((GLFWwindow *)window, true)) return false;
    if (ImGui_ImplOpenGL3_Init("#version 150")) return true;
    ImGui_ImplGlfw_Shutdown();
    return false;
}

iso_status isosculpt_panel_create(void *window, double scale, const char *font, isosculpt_panel **out,
                                  iso_error *error) {
    return iso::guard("Dear ImGui", error, [&] {
        std::unique_ptr<isosculpt_panel> panel(new isosculpt_panel{});
        panel->scale = (float)scale;
        ISO_TRY(panel_choose_font(font, &panel->font, error));
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        bool styled = panel_set_style(panel->font, panel->scale);
        if (!styled && !font) {
            panel->font = panel_font{};
            styled = panel_set_style(panel->font, panel->scale);
        }
        if (styled && start_back_ends(window)) {
            *out = panel.release();
            return ISO_OK;
        }
        ImGui::DestroyContext();
        return styled ? iso_fail(error, ISO_ERR_BACKEND, "OpenGL cannot be used by Dear ImGui")
                      : iso_fail(error, ISO_ERR_FORMAT, "%s: no TrueType or OpenType font", font);
    });
}

iso_status isosculpt_panel_rescale(isosculpt_panel *panel, double scale, iso_error *error) {
    if ((float)scale == panel->scale) return ISO_OK;
    return iso::guard("Dear ImGui", error, [&] {
        panel->scale = (float)scale;
        const bool styled = panel_set_style(panel->font, panel->scale);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        if (styled && ImGui_ImplOpenGL3_CreateFontsTexture()) return ISO_OK;
        return iso_fail(error, ISO_ERR_BACKEND, "OpenGL has no room for letters of another size");
    });
}

void isosculpt_panel_destroy(isosculpt_panel *panel) {
    if (!panel) return;
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    delete panel;
}
