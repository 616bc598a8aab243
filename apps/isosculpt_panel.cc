#include "apps/isosculpt_panel.h"

#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt_keys.h"
#include "grids/bridge_guard.hpp"

struct rectangle {
    ImVec2 position, size;
    bool holds(double x, double y) const {
        return x >= position.x && y >= position.y && x < position.x + size.x && y < position.y + size.y;
    }
};

struct isosculpt_panel {
    float scale;
    bool place_anew; /* the scale is another one */
    bool modal;
    rectangle place, busy,
        message; /* of the panel, of what tells progress and what was said, as last drawn */
    bool over(double x, double y) const {
        return place.holds(x, y) || busy.holds(x, y) || message.holds(x, y);
    }
};

static const ImVec4 RED{1.0f, 0.42f, 0.36f, 1.0f}, GREY{0.72f, 0.74f, 0.77f, 1.0f},
    GREEN{0.62f, 0.86f, 0.62f, 1.0f};

/* ---- the picture and the ring */

static ImVec2 at_window(const isosculpt_screen *screen, double x, double y) {
    return ImVec2((float)(x / screen->pixels), (float)(y / screen->pixels));
}

/* Two unit vectors across the normal. */
static void across(iso_vec3 normal, iso_vec3 *u, iso_vec3 *v) {
    iso_vec3 other = std::fabs(normal.x) < 0.6 ? iso_vec3_make(1, 0, 0) : iso_vec3_make(0, 1, 0);
    *u = iso_vec3_unit(iso_vec3_cross(normal, other));
    *v = iso_vec3_cross(normal, *u);
}

static void draw_ring(const isosculpt_screen *screen, ImDrawList *list, const isosculpt_pick &pick,
                      float scale) {
    constexpr int CORNERS = 64;
    const isosculpt_layer *layer = &screen->hand->view->drawn;
    const double radius = screen->hand->brush.radius;
    ImVec2 corners[CORNERS];
    iso_vec3 u, v;
    double x, y, sine, cosine;
    across(pick.normal, &u, &v);
    for (int i = 0; i < CORNERS; i++) {
        iso_sincos(2 * ISO_PI * i / CORNERS, &sine, &cosine);
        iso_vec3 offset = iso_vec3_add(iso_vec3_scale(u, radius * cosine), iso_vec3_scale(v, radius * sine));
        if (!isosculpt_layer_pixel(layer, iso_vec3_add(pick.position, offset), &x, &y)) return;
        corners[i] = at_window(screen, x, y);
    }
    list->AddPolyline(corners, CORNERS, IM_COL32(0, 0, 0, 140), ImDrawFlags_Closed, 3.5f * scale);
    list->AddPolyline(corners, CORNERS, IM_COL32(255, 255, 255, 230), ImDrawFlags_Closed, 1.5f * scale);
}

static void draw_brush(const isosculpt_screen *screen, ImDrawList *list, float scale) {
    const isosculpt_hand *hand = screen->hand;
    isosculpt_pick pick;
    double x, y;
    if (!isosculpt_hand_under(hand, &pick)) return;
    draw_ring(screen, list, pick, scale);
    iso_vec3 tip = iso_vec3_add(pick.position, iso_vec3_scale(pick.normal, 0.4 * hand->brush.radius));
    if (isosculpt_layer_pixel(&hand->view->drawn, tip, &x, &y))
        list->AddLine(at_window(screen, hand->x, hand->y), at_window(screen, x, y),
                      IM_COL32(255, 255, 255, 160), 1.5f * scale);
}

static void draw_picture(const isosculpt_screen *screen, bool ring, float scale) {
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    if (screen->texture)
        list->AddImage((ImTextureID)(intptr_t)screen->texture, ImVec2(0, 0),
                       at_window(screen, screen->width, screen->height));
    if (ring) draw_brush(screen, list, scale);
}

/* ---- parts of the panel */

/* The solid that is added or carved; a stamp is there when one was loaded. */
static void choose_shape(isosculpt_hand *hand) {
    static const iso_solid shapes[] = {ISO_SOLID_SPHERE, ISO_SOLID_BOX, ISO_SOLID_CYLINDER, ISO_SOLID_TORUS,
                                       ISO_SOLID_STAMP};
    iso_brush *brush = &hand->brush;
    const iso_stamp *stamp = iso_session_stamp(hand->desk->session);
    const auto name = [&](iso_solid shape) {
        return shape == ISO_SOLID_STAMP && stamp ? stamp->name : iso_solid_name(shape);
    };
    if (brush->shape == ISO_SOLID_STAMP && !stamp) brush->shape = ISO_SOLID_SPHERE;
    ImGui::BeginDisabled(!isosculpt_hand_has_shape(brush->tool));
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

static void section_brush(const isosculpt_screen *screen) {
    isosculpt_hand *hand = screen->hand;
    static const char *const names[] = {"1 add",     "2 carve", "3 blend", "4 smooth", "5 inflate",
                                        "6 flatten", "7 pinch", "8 move",  "9 mask"};
    const float width = ImGui::GetContentRegionAvail().x / 3 - ImGui::GetStyle().ItemSpacing.x * 0.67f;
    for (int i = 0; i < ISOSCULPT_TOOLS; i++) {
        bool chosen = hand->brush.tool == isosculpt_hand_tool(i + 1);
        if (i % 3) ImGui::SameLine();
        if (chosen) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        if (ImGui::Button(names[i], ImVec2(width, 0))) hand->brush.tool = isosculpt_hand_tool(i + 1);
        if (chosen) ImGui::PopStyleColor();
    }
    const double voxel = hand->desk->start.voxel_size, low = 2 * voxel, high = 128 * voxel, none = 0.02,
                 full = 1;
    ImGui::SliderScalar("radius", ImGuiDataType_Double, &hand->brush.radius, &low, &high, "%.2f mm",
                        ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    ImGui::SliderScalar("strength", ImGuiDataType_Double, &hand->brush.strength, &none, &full, "%.2f",
                        ImGuiSliderFlags_AlwaysClamp);
    choose_shape(hand);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("symmetry");
    for (unsigned axis = 0; axis < 3; axis++) {
        const char name[2] = {(char)('x' + axis), 0};
        ImGui::SameLine();
        ImGui::CheckboxFlags(name, &hand->brush.symmetry, 1u << axis);
    }
    if (!screen->pen) return;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("pressure");
    ImGui::SameLine();
    ImGui::Checkbox("size", &hand->brush.pressure_radius);
    ImGui::SameLine();
    ImGui::Checkbox("strength##pen", &hand->brush.pressure_strength);
}

static bool color_edit(const char *label, iso_rgb *color) {
    float rgb[3] = {(float)color->r / 255, (float)color->g / 255, (float)color->b / 255};
    if (!ImGui::ColorEdit3(label, rgb, ImGuiColorEditFlags_NoInputs)) return false;
    *color = iso_rgb{(uint8_t)std::lround(255 * rgb[0]), (uint8_t)std::lround(255 * rgb[1]),
                     (uint8_t)std::lround(255 * rgb[2])};
    return true;
}

/* The rest of a line: which engine is chosen; and under the pointer, what drew the picture. */
static bool engine_combo(isosculpt_view *view) {
    static const char *const names[] = {"engine: cpu", "engine: gl"};
    isosculpt_engine *engine = &view->look.engine;
    bool changed = false;
    if (!view->gl) {
        ImGui::TextColored(GREY, "%s", names[ISOSCULPT_CPU]);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("there is no OpenGL 4.5");
        return false;
    }
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::BeginCombo("##engine", names[*engine], ImGuiComboFlags_NoArrowButton)) {
        for (isosculpt_engine i : {ISOSCULPT_CPU, ISOSCULPT_GL})
            if (ImGui::Selectable(names[i], i == *engine)) {
                *engine = i;
                view->gl_error.text[0] = 0;
                changed = true;
            }
        ImGui::EndCombo();
    } else if (ImGui::IsItemHovered() && view->drawn.canvas)
        ImGui::SetTooltip("drawn by %s", isosculpt_gl_renderer(view->gl));
    else if (ImGui::IsItemHovered())
        ImGui::SetTooltip("drawn by the cpu engine");
    if (!view->gl_error.text[0]) return changed;
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored(RED, "%s", view->gl_error.text);
    ImGui::PopTextWrapPos();
    return changed;
}

static void section_picture(isosculpt_hand *hand) {
    isosculpt_look *look = &hand->view->look;
    bool changed = false;
    if (ImGui::BeginCombo("method", isosculpt_method_name(look->method))) {
        for (int i = 0; i < ISOSCULPT_METHOD_COUNT; i++)
            if (ImGui::Selectable(isosculpt_method_name((isosculpt_method)i), i == (int)look->method)) {
                look->method = (isosculpt_method)i;
                changed = true;
            }
        ImGui::EndCombo();
    }
    if (ImGui::BeginCombo("light", isosculpt_light_name(look->paint.light))) {
        for (int i = 0; i < ISOSCULPT_LIGHT_COUNT; i++)
            if (ImGui::Selectable(isosculpt_light_name((isosculpt_light)i), i == (int)look->paint.light)) {
                look->paint.light = (isosculpt_light)i;
                changed = true;
            }
        ImGui::EndCombo();
    }
    changed |= color_edit("surface", &look->paint.color);
    ImGui::SameLine();
    changed |= color_edit("background", &look->paint.background);
    ImGui::SameLine();
    changed |= engine_combo(hand->view);
    if (changed) hand->wishes |= ISOSCULPT_WISH_PICTURE;
}

static void section_history(isosculpt_hand *hand, float scale) {
    const iso_history *history = iso_session_history(hand->desk->session);
    const size_t position = iso_history_position(history), count = iso_history_count(history);
    size_t wanted = position;
    ImGui::BeginChild("steps", ImVec2(0, 110 * scale), true);
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
    if (hand->drag == ISOSCULPT_DRAG_BRUSH || ImGui::GetScrollY() >= ImGui::GetScrollMaxY())
        ImGui::SetScrollHereY(1);
    ImGui::EndChild();
    if (wanted != position) isosculpt_hand_history(hand, wanted);
}

static void latency_row(const char *name, const isosculpt_latency *latency) {
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

static void section_numbers(isosculpt_hand *hand) {
    const iso_grid *grid = &hand->view->grid;
    const int *dims = iso_grid_dims(grid);
    ImGui::Text("%d x %d x %d voxels of %.4g mm", dims[0], dims[1], dims[2],
                iso_grid_transform(grid)->spacing[0]);
    if (grid->hgrid)
        ImGui::Text("%.2f M of them stored, in %.0f MB",
                    1e-6 * ISO_BRICK_VOXELS * (double)iso_hgrid_brick_count(grid->hgrid),
                    1e-6 * (double)iso_hgrid_bytes(grid->hgrid));
    ImGui::Text("%.2f M points", 1e-6 * (double)isosculpt_view_points(hand->view));
    if (!ImGui::BeginTable("latency", 3, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("milliseconds", ImGuiTableColumnFlags_WidthStretch, 2);
    ImGui::TableSetupColumn("p50", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("p99", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableHeadersRow();
    latency_row("edit", &hand->edit);
    latency_row("extract", &hand->view->extract);
    latency_row("draw", &hand->view->draw);
    ImGui::EndTable();
}

static void file_buttons(isosculpt_screen *screen) {
    isosculpt_hand *hand = screen->hand;
    const isosculpt_desk *desk = hand->desk;
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##path", "a file, typed or dropped", screen->path, sizeof screen->path);
    if (ImGui::Button("Open") && screen->path[0]) screen->answers |= ISOSCULPT_ANSWER_OPEN;
    ImGui::SameLine();
    if (ImGui::Button("Stamp") && screen->path[0]) screen->answers |= ISOSCULPT_ANSWER_STAMP;
    ImGui::SameLine();
    const bool saved = desk->changes == desk->saved;
    if (ImGui::Button(saved ? "Save .vdb###save" : "Save .vdb *###save")) hand->wishes |= ISOSCULPT_WISH_SAVE;
    ImGui::SameLine();
    if (ImGui::Button("Help")) screen->help = !screen->help;
}

/* By the logarithms of counts. Where values are few, a column reaches to the next value. */
static void draw_columns(const iso_histogram &histogram, ImDrawList *list, ImVec2 at, ImVec2 size) {
    uint64_t most = 1, filled = 0;
    for (uint64_t count : histogram.bins) {
        most = count > most ? count : most;
        filled += count > 0;
    }
    const bool few = 2 * filled < ISO_HISTOGRAM_BINS;
    const float column = size.x / ISO_HISTOGRAM_BINS;
    uint64_t count = 0;
    for (int i = 0; i < ISO_HISTOGRAM_BINS; i++) {
        if (histogram.bins[i] || !few) count = histogram.bins[i];
        const double part = std::log1p((double)count) / std::log1p((double)most);
        list->AddRectFilled(ImVec2(at.x + column * (float)i, at.y + size.y * (float)(1 - part)),
                            ImVec2(at.x + column * (float)(i + 1), at.y + size.y),
                            IM_COL32(120, 150, 190, 255));
    }
}

/* The histogram, and the isovalue as a line, which follows the pointer. */
static void draw_histogram(isosculpt_screen *screen, float scale) {
    const iso_histogram *histogram = &screen->volume->histogram;
    const ImVec2 at = ImGui::GetCursorScreenPos(), size(ImGui::GetContentRegionAvail().x, 110 * scale);
    const double range = histogram->high - histogram->low;
    ImDrawList *list = ImGui::GetWindowDrawList();
    ImGui::InvisibleButton("histogram", size);
    list->AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), IM_COL32(20, 24, 30, 255));
    draw_columns(*histogram, list, at, size);
    screen->sliding = ImGui::IsItemActive();
    if (screen->sliding && range > 0) {
        const double part = (double)(ImGui::GetIO().MousePos.x - at.x) / (double)size.x;
        screen->isovalue = histogram->low + std::fmin(std::fmax(part, 0), 1) * range;
    }
    const float x = at.x + size.x * (float)(range > 0 ? (screen->isovalue - histogram->low) / range : 0);
    list->AddLine(ImVec2(x, at.y), ImVec2(x, at.y + size.y), IM_COL32(255, 190, 90, 255), 2 * scale);
}

static void section_isovalue(isosculpt_screen *screen, float scale) {
    const iso_histogram *histogram = &screen->volume->histogram;
    draw_histogram(screen, scale);
    ImGui::SliderScalar("isovalue", ImGuiDataType_Double, &screen->isovalue, &histogram->low,
                        &histogram->high, "%.6g", ImGuiSliderFlags_AlwaysClamp);
    screen->sliding |= ImGui::IsItemActive();
    if (ImGui::Button("Sculpt this")) screen->hand->wishes |= ISOSCULPT_WISH_SCULPT;
    ImGui::SameLine();
    ImGui::TextColored(GREY, "or touch it with a brush");
}

/* A path by its last part; all of it under the pointer. */
static void show_path(ImVec4 color, const char *what, const char *path) {
    const char *slash = strrchr(path, '/');
    ImGui::TextColored(color, "%s%s", what, slash ? slash + 1 : path);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", path);
}

static void section_files(isosculpt_screen *screen) {
    const isosculpt_desk *desk = screen->hand->desk;
    iso_error error = {ISO_OK, ""};
    file_buttons(screen);
    ImGui::PushTextWrapPos(0);
    if (screen->volume)
        show_path(GREY, "", screen->volume->path);
    else if (!desk->journal[0])
        ImGui::TextColored(RED, "No journal is written: %s. What you make is in memory only: save it.",
                           desk->trouble);
    else if (iso_session_journal_status(desk->session, &error) != ISO_OK)
        ImGui::TextColored(RED,
                           "The journal lags behind: %s. Nothing is lost in memory, and it is tried again.",
                           error.text);
    else
        show_path(GREEN, "Strokes: ", desk->journal);
    ImGui::PopTextWrapPos();
}

static void draw_panel(isosculpt_panel *panel, isosculpt_screen *screen) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float width = 296 * panel->scale, gap = 8 * panel->scale;
    ImGui::SetNextWindowPos(ImVec2(gap, gap), panel->place_anew ? ImGuiCond_Always : ImGuiCond_FirstUseEver);
    panel->place_anew = false;
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, display.y - 2 * gap));
    ImGui::Begin("isosculpt", nullptr, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushItemWidth(-76 * panel->scale);
    const bool looking = screen->volume != nullptr;
    if (looking && ImGui::CollapsingHeader("Isovalue", ImGuiTreeNodeFlags_DefaultOpen))
        section_isovalue(screen, panel->scale);
    if (!looking && ImGui::CollapsingHeader("Brush", ImGuiTreeNodeFlags_DefaultOpen)) section_brush(screen);
    if (ImGui::CollapsingHeader("Picture", ImGuiTreeNodeFlags_DefaultOpen)) section_picture(screen->hand);
    if (!looking && ImGui::CollapsingHeader("History", ImGuiTreeNodeFlags_DefaultOpen))
        section_history(screen->hand, panel->scale);
    if (ImGui::CollapsingHeader("Numbers", ImGuiTreeNodeFlags_DefaultOpen)) section_numbers(screen->hand);
    if (ImGui::CollapsingHeader("Files", ImGuiTreeNodeFlags_DefaultOpen)) section_files(screen);
    ImGui::PopItemWidth();
    panel->place = rectangle{ImGui::GetWindowPos(), ImGui::GetWindowSize()};
    ImGui::End();
}

/* ---- heavy work */

/* At the lower edge, where it hides nothing; there even when the panel is not. */
static void draw_busy(isosculpt_panel *panel, isosculpt_screen *screen) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y - 16 * panel->scale), ImGuiCond_Always,
                            ImVec2(0.5f, 1));
    ImGui::SetNextWindowSize(ImVec2(420 * panel->scale, 0), ImGuiCond_Always);
    ImGui::Begin("##busy", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    for (int i = 0; i < screen->busy_count; i++) {
        const isosculpt_busy *busy = &screen->busy[i];
        ImGui::PushID(i);
        ImGui::TextUnformatted(busy->text);
        ImGui::ProgressBar((float)busy->fraction, ImVec2(280 * panel->scale, 0));
        ImGui::SameLine();
        if (ImGui::Button(i ? "Cancel" : "Cancel (Escape)"))
            screen->answers |= (unsigned)ISOSCULPT_ANSWER_CANCEL << i;
        ImGui::PopID();
    }
    panel->busy = rectangle{ImGui::GetWindowPos(), ImGui::GetWindowSize()};
    ImGui::End();
}

/* ---- what was said last */

/* Seen without the panel too, above what tells progress. What went wrong stays until it is put away. */
static void draw_message(isosculpt_panel *panel, isosculpt_screen *screen) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float below = screen->busy_count ? display.y - panel->busy.position.y : 0, gap = 16 * panel->scale;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y - gap - below), ImGuiCond_Always,
                            ImVec2(0.5f, 1));
    ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(display.x - 2 * gap, display.y));
    ImGui::Begin("##message", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::PushTextWrapPos(std::fmin(560 * panel->scale, display.x - 4 * gap));
    ImGui::TextColored(screen->message_is_bad ? RED : GREY, "%s", screen->message);
    ImGui::PopTextWrapPos();
    if (screen->message_is_bad && ImGui::SmallButton("put this away")) screen->message[0] = 0;
    panel->message = rectangle{ImGui::GetWindowPos(), ImGui::GetWindowSize()};
    ImGui::End();
}

/* ---- help and questions */

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

/* A question in the middle; while it is there the sculpture is out of reach. Answers come from here or from
 * keys. */
static bool begin_question(const char *title, bool asked) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (asked && !ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    bool open = ImGui::BeginPopupModal(title, nullptr,
                                       ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
    if (open && !asked) ImGui::CloseCurrentPopup();
    return open;
}

static void answer_button(isosculpt_screen *screen, const char *label, unsigned answers) {
    if (ImGui::Button(label)) screen->answers |= answers;
}

static void ask_recover(isosculpt_screen *screen) {
    if (!begin_question("Recover?", screen->question == ISOSCULPT_ASK_RECOVER)) return;
    ImGui::Text("A session was not closed:\n%s\n\nIts strokes are all there.", screen->asked);
    answer_button(screen, "Recover it (Enter)", ISOSCULPT_ANSWER_RECOVER);
    ImGui::SameLine();
    answer_button(screen, "Start new (the file stays)", ISOSCULPT_ANSWER_DISMISS);
    ImGui::EndPopup();
}

static void say_unsaved(const isosculpt_screen *screen) {
    const char *journal = screen->hand->desk->journal;
    if (journal[0])
        ImGui::Text("What you did is not in a .vdb file. The stroke file has all of it:\n%s", journal);
    else
        ImGui::TextColored(RED, "What you did is in no file.");
}

static void ask_close(isosculpt_screen *screen) {
    if (!begin_question("Close?", screen->question == ISOSCULPT_ASK_CLOSE)) return;
    say_unsaved(screen);
    answer_button(screen, "Save .vdb and close (Enter)", ISOSCULPT_ANSWER_SAVE | ISOSCULPT_ANSWER_LEAVE);
    ImGui::SameLine();
    answer_button(screen, "Close", ISOSCULPT_ANSWER_LEAVE);
    ImGui::SameLine();
    answer_button(screen, "Stay (Escape)", ISOSCULPT_ANSWER_STAY);
    ImGui::EndPopup();
}

static void ask_open(isosculpt_screen *screen) {
    if (!begin_question("Open?", screen->question == ISOSCULPT_ASK_OPEN)) return;
    ImGui::Text("%s\nis to be opened in place of what is here.\n\n", screen->asked);
    say_unsaved(screen);
    answer_button(screen, "Save .vdb and open (Enter)", ISOSCULPT_ANSWER_SAVE | ISOSCULPT_ANSWER_LEAVE);
    ImGui::SameLine();
    answer_button(screen, "Open", ISOSCULPT_ANSWER_LEAVE);
    ImGui::SameLine();
    answer_button(screen, "Stay (Escape)", ISOSCULPT_ANSWER_STAY);
    ImGui::EndPopup();
}

static void ask_mesh(isosculpt_screen *screen) {
    if (!begin_question("A mesh", screen->question == ISOSCULPT_ASK_MESH)) return;
    ImGui::Text("%s", screen->asked);
    answer_button(screen, "Sculpt it (Enter)", ISOSCULPT_ANSWER_OPEN);
    ImGui::SameLine();
    answer_button(screen, "Add and carve with it (S)", ISOSCULPT_ANSWER_STAMP);
    ImGui::SameLine();
    answer_button(screen, "Neither (Escape)", ISOSCULPT_ANSWER_STAY);
    ImGui::EndPopup();
}

/* ---- a frame */

static void draw_all(isosculpt_panel *panel, isosculpt_screen *screen) {
    panel->modal = screen->question != ISOSCULPT_ASK_NOTHING;
    panel->place = panel->busy = panel->message = rectangle{ImVec2(0, 0), ImVec2(0, 0)};
    screen->sliding = false;
    if (screen->panel && !screen->blank) draw_panel(panel, screen);
    if (screen->busy_count) draw_busy(panel, screen);
    if (screen->help) draw_help(screen, panel->scale);
    if (screen->message[0]) draw_message(panel, screen);
    ask_recover(screen);
    ask_close(screen);
    ask_open(screen);
    ask_mesh(screen);
    const isosculpt_hand *hand = screen->hand;
    bool over = panel->over(hand->x / screen->pixels, hand->y / screen->pixels);
    draw_picture(screen,
                 !panel->modal && !screen->blank && !screen->volume &&
                     (!over || hand->drag == ISOSCULPT_DRAG_BRUSH),
                 panel->scale);
}

iso_status isosculpt_panel_draw(isosculpt_panel *panel, isosculpt_screen *screen, iso_error *error) {
    return iso::guard("Dear ImGui", error, [&] {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        draw_all(panel, screen);
        ImGui::Render();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
        return ISO_OK;
    });
}

bool isosculpt_panel_has_pointer(const isosculpt_panel *panel, double x, double y) {
    return panel->modal || panel->over(x, y) || ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
}

bool isosculpt_panel_has_keys(void) {
    return ImGui::GetIO().WantTextInput;
}

/* ---- life */

static void set_style(float scale) {
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.Fonts->Clear();
    ImGui::GetStyle() = ImGuiStyle();
    ImFontConfig font;
    font.SizePixels = std::floor(13 * scale);
    io.Fonts->AddFontDefault(&font);
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 5;
    ImGui::GetStyle().FrameRounding = 3;
    ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.88f;
    ImGui::GetStyle().Colors[ImGuiCol_ModalWindowDimBg] = ImVec4(0, 0, 0, 0.45f);
    ImGui::GetStyle().ScaleAllSizes(scale);
}

iso_status isosculpt_panel_create(void *window, double scale, isosculpt_panel **out, iso_error *error) {
    return iso::guard("Dear ImGui", error, [&] {
        isosculpt_panel *panel = new isosculpt_panel{};
        panel->scale = (float)scale;
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        set_style(panel->scale);
        bool ready = ImGui_ImplGlfw_InitForOpenGL((GLFWwindow *)window, true);
        if (ready && ImGui_ImplOpenGL3_Init("#version 150")) {
            *out = panel;
            return ISO_OK;
        }
        if (ready) ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
        delete panel;
        return iso_fail(error, ISO_ERR_BACKEND, "OpenGL cannot be used by Dear ImGui");
    });
}

iso_status isosculpt_panel_rescale(isosculpt_panel *panel, double scale, iso_error *error) {
    if ((float)scale == panel->scale) return ISO_OK;
    return iso::guard("Dear ImGui", error, [&] {
        panel->scale = (float)scale;
        panel->place_anew = true;
        set_style(panel->scale);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        if (ImGui_ImplOpenGL3_CreateFontsTexture()) return ISO_OK;
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
