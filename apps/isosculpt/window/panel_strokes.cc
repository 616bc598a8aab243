/* The section of the panel that lists the strokes, which stay editable. */
#include <cfloat>
#include <cstdio>
#include <cstring>

#include "apps/isosculpt/window/panel_parts.hpp"

static const float LIST_HEIGHT = 128; /* at scale 1 */

/* Draws an eye, open or closed, in a rectangle. */
static void draw_eye(ImVec2 lo, ImVec2 hi, bool open, ImU32 color, float scale) {
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImVec2 middle((lo.x + hi.x) / 2, (lo.y + hi.y) / 2);
    const float half = 7 * scale, lid = 5.5f * scale;
    list->PathLineTo(ImVec2(middle.x - half, middle.y));
    list->PathBezierQuadraticCurveTo(ImVec2(middle.x, middle.y + 2 * lid), ImVec2(middle.x + half, middle.y));
    if (open)
        list->PathBezierQuadraticCurveTo(ImVec2(middle.x, middle.y - 2 * lid),
                                         ImVec2(middle.x - half, middle.y));
    list->PathStroke(color, ImDrawFlags_None, 1.3f * scale);
    if (open) list->AddCircleFilled(middle, 2.4f * scale, color);
}

/* Requests an edit of all strokes that are selected if this one is, else of this one. */
static void request(isosculpt_controller *controller, const iso_stroke *stroke, iso_event_kind kind) {
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    const bool selected = stroke->number >= editor->first && stroke->number <= editor->last;
    iso_event event = {};
    event.kind = kind;
    event.first = selected ? editor->first : stroke->number;
    event.last = selected ? editor->last : stroke->number;
    isosculpt_stroke_editor_request(editor, &event, &controller->error);
}

/* Lets a row be dragged onto another one, whose place the stroke then takes. */
static void drag_row(isosculpt_controller *controller, const iso_stroke_list *list, size_t at) {
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    if (ImGui::BeginDragDropSource()) {
        ImGui::SetDragDropPayload("stroke", &at, sizeof at);
        ImGui::Text("stroke %u", iso_stroke_at(list, at)->number);
        ImGui::EndDragDropSource();
    }
    if (!ImGui::BeginDragDropTarget()) return;
    const ImGuiPayload *payload = ImGui::AcceptDragDropPayload("stroke");
    size_t from;
    if (payload) {
        std::memcpy(&from, payload->Data, sizeof from);
        const size_t before = from < at ? at + 1 : at; /* the stroke is drawn before that one */
        iso_event event = {};
        event.kind = ISO_EVENT_MOVE;
        event.first = event.last = iso_stroke_at(list, from)->number;
        event.before = before < list->count ? iso_stroke_at(list, before)->number : 0;
        if (from != at) isosculpt_stroke_editor_request(editor, &event, &controller->error);
    }
    ImGui::EndDragDropTarget();
}

static void draw_row(isosculpt_controller *controller, const iso_stroke_list *list, size_t at, float scale) {
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    const iso_stroke *stroke = iso_stroke_at(list, at);
    const float height = ImGui::GetTextLineHeight();
    const ImU32 color = ImGui::GetColorU32(stroke->muted ? ImGuiCol_TextDisabled : ImGuiCol_Text);
    char label[256];
    ImGui::PushID((int)stroke->number);
    if (ImGui::InvisibleButton("eye", ImVec2(20 * scale, height)))
        request(controller, stroke, stroke->muted ? ISO_EVENT_UNMUTE : ISO_EVENT_MUTE);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(stroke->muted ? "Draws the stroke again." : "Leaves the stroke out.");
    draw_eye(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), !stroke->muted, color, scale);
    ImGui::SameLine();
    if (stroke->brush.tool >= ISO_TOOL_CLEAR_MASK)
        snprintf(label, sizeof label, "%u  %s", stroke->number, iso_tool_name(stroke->brush.tool));
    else
        snprintf(label, sizeof label, "%u  %s  %.2f mm  %.160s", stroke->number,
                 iso_tool_name(stroke->brush.tool), stroke->brush.radius, stroke->group);
    const bool selected = stroke->number >= editor->first && stroke->number <= editor->last;
    if (stroke->number == editor->before) { /* new strokes are listed below, as they are drawn before it */
        const ImVec2 lo = ImGui::GetWindowPos(), row = ImGui::GetItemRectMax();
        ImGui::GetWindowDrawList()->AddLine(ImVec2(lo.x, row.y + 2 * scale),
                                            ImVec2(lo.x + ImGui::GetWindowWidth(), row.y + 2 * scale),
                                            ImGui::GetColorU32(GREEN), 2 * scale);
    }
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    if (ImGui::Selectable(label, selected)) {
        const bool further = ImGui::GetIO().KeyShift && editor->first;
        if (selected && editor->first == editor->last)
            isosculpt_stroke_editor_select(editor, 0, 0);
        else
            isosculpt_stroke_editor_select(editor, further ? editor->first : stroke->number, stroke->number);
    }
    ImGui::PopStyleColor();
    drag_row(controller, list, at);
    ImGui::PopID();
}

/* What can be done with the strokes that are selected. */
static void draw_actions(isosculpt_controller *controller) {
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    ImGui::BeginDisabled(!editor->first);
    {
        const button_row row("DeleteMuteUnmuteInsert", 4);
        if (ImGui::Button("Delete"))
            isosculpt_stroke_editor_request_all(editor, ISO_EVENT_DELETE, &controller->error);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("Key: Delete");
        row.next();
        if (ImGui::Button("Mute"))
            isosculpt_stroke_editor_request_all(editor, ISO_EVENT_MUTE, &controller->error);
        row.next();
        if (ImGui::Button("Unmute"))
            isosculpt_stroke_editor_request_all(editor, ISO_EVENT_UNMUTE, &controller->error);
        row.next();
        if (ImGui::Button("Insert")) editor->before = editor->before == editor->first ? 0 : editor->first;
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip(
                "New strokes go before this one, where the line is: first they are drawn at the\n"
                "end, then moved there. Pressed again: to the end.");
    }
    static char group[64];
    if (ImGui::InputText("group", group, sizeof group, ImGuiInputTextFlags_EnterReturnsTrue) &&
        editor->first) {
        iso_event event = {};
        event.kind = ISO_EVENT_GROUP;
        event.first = editor->first;
        event.last = editor->last;
        std::memcpy(event.text, group, sizeof group);
        isosculpt_stroke_editor_request(editor, &event, &controller->error);
        group[0] = 0;
    }
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("Enter puts the selected strokes into the group of this name.");
    ImGui::EndDisabled();
}

void panel_draw_strokes(isosculpt_controller *controller, float scale) {
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    const iso_stroke_list *list = isosculpt_stroke_editor_list(editor, controller->document->session);
    if (!list) {
        ImGui::PushTextWrapPos(0);
        ImGui::TextColored(GREY, "%s", editor->no_list.text);
        ImGui::PopTextWrapPos();
        return;
    }
    ImGui::BeginChild("strokes", ImVec2(0, LIST_HEIGHT * scale), true);
    if (!list->count) ImGui::TextColored(GREY, "no strokes yet");
    ImGuiListClipper clipper;
    clipper.Begin((int)list->count);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; i++)
            draw_row(controller, list, list->count - 1 - (size_t)i, scale);
    ImGui::EndChild();
    if (ImGui::IsItemHovered() && !list->count)
        ImGui::SetTooltip("Every stroke stays here, and can be changed later.");
    draw_actions(controller);
}

const iso_stroke *panel_draw_stroke_title(isosculpt_controller *controller) {
    isosculpt_document *document = controller->document;
    const iso_stroke *stroke = isosculpt_stroke_editor_stroke(&document->strokes, document->session);
    if (!stroke) return nullptr;
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(GREEN, "stroke %u: %s", stroke->number, iso_tool_name(stroke->brush.tool));
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize("done").x -
                    ImGui::GetStyle().FramePadding.x);
    if (ImGui::Button("done")) {
        isosculpt_stroke_editor_select(&document->strokes, 0, 0);
        return nullptr;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("The brush is for new strokes again. Key: Escape");
    return stroke;
}
