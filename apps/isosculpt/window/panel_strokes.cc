/* The section of the panel that lists the strokes, which stay editable. */
#include <cfloat>
#include <cstdio>
#include <cstring>
#include <set>
#include <string>
#include <vector>

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

/* The groups whose strokes the list does not show. */
static std::set<std::string> folded;

/* Requests an edit of all strokes that are selected if this one is, else of this one. */
static void request(isosculpt_controller *controller, const iso_stroke *stroke, iso_event_kind kind) {
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    iso_event event = {};
    event.kind = kind;
    event.first = event.last = stroke->number;
    if (isosculpt_stroke_editor_selects(editor, stroke))
        isosculpt_stroke_editor_request_all(editor, kind, &controller->error);
    else
        isosculpt_stroke_editor_request(editor, &event, &controller->error);
}

/* Requests an edit of a group. */
static void request_group(isosculpt_controller *controller, const char *group, iso_event_kind kind,
                          unsigned before) {
    iso_event event = {};
    event.kind = kind;
    event.before = before;
    snprintf(event.text, sizeof event.text, "%s", group);
    isosculpt_stroke_editor_request(&controller->document->strokes, &event, &controller->error);
}

/* A stroke or the strokes of a group take the place of the stroke `at`: `from` is the first of them. */
static void move_to(isosculpt_controller *controller, const iso_stroke_list *list, size_t from, bool group,
                    size_t at) {
    const iso_stroke *moved = iso_stroke_at(list, from);
    const auto moves = [&](size_t i) {
        return group ? std::strcmp(iso_stroke_at(list, i)->group, moved->group) == 0 : i == from;
    };
    if (moves(at)) return;
    size_t next = from < at ? at + 1 : at; /* they are drawn before that one */
    while (next < list->count && moves(next)) next++;
    const unsigned before = next < list->count ? iso_stroke_at(list, next)->number : 0;
    if (group) {
        request_group(controller, moved->group, ISO_EVENT_MOVE, before);
        return;
    }
    iso_event event = {};
    event.kind = ISO_EVENT_MOVE;
    event.first = event.last = moved->number;
    event.before = before;
    isosculpt_stroke_editor_request(&controller->document->strokes, &event, &controller->error);
}

/* Lets a row be dragged, that of a stroke or the header of a group. */
static void drag_from(const iso_stroke_list *list, size_t at, bool group) {
    if (!ImGui::BeginDragDropSource()) return;
    ImGui::SetDragDropPayload(group ? "group" : "stroke", &at, sizeof at);
    if (group)
        ImGui::TextUnformatted(iso_stroke_at(list, at)->group);
    else
        ImGui::Text("stroke %u", iso_stroke_at(list, at)->number);
    ImGui::EndDragDropSource();
}

/* Whether a stroke or the header of a group was dragged onto the last row. */
static bool dropped(const char *what, size_t *from) {
    const ImGuiPayload *payload = ImGui::AcceptDragDropPayload(what);
    if (payload) std::memcpy(from, payload->Data, sizeof *from);
    return payload != nullptr;
}

/* Lets a row be dragged onto another one, whose place the stroke, or the group, then takes. */
static void drag_row(isosculpt_controller *controller, const iso_stroke_list *list, size_t at) {
    size_t from;
    drag_from(list, at, false);
    if (!ImGui::BeginDragDropTarget()) return;
    if (dropped("stroke", &from)) move_to(controller, list, from, false, at);
    if (dropped("group", &from)) move_to(controller, list, from, true, at);
    ImGui::EndDragDropTarget();
}

/* Lets the header of a group be dragged, and strokes onto it, which are in the group then. */
static void drag_header(isosculpt_controller *controller, const iso_stroke_list *list, size_t first) {
    size_t from;
    drag_from(list, first, true);
    if (!ImGui::BeginDragDropTarget()) return;
    if (dropped("stroke", &from)) {
        iso_event event = {};
        event.kind = ISO_EVENT_GROUP;
        event.first = event.last = iso_stroke_at(list, from)->number;
        snprintf(event.text, sizeof event.text, "%s", iso_stroke_at(list, first)->group);
        isosculpt_stroke_editor_request(&controller->document->strokes, &event, &controller->error);
    }
    ImGui::EndDragDropTarget();
}

/* Draws the header of a group. */
static void draw_header(isosculpt_controller *controller, const iso_stroke_list *list, const char *group,
                        float scale) {
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    const float height = ImGui::GetTextLineHeight();
    size_t count = 0, muted = 0, first = list->count;
    for (size_t i = 0; i < list->count; i++) {
        const iso_stroke *stroke = iso_stroke_at(list, i);
        if (std::strcmp(stroke->group, group) != 0) continue;
        if (!count++) first = i;
        muted += stroke->muted;
    }
    const bool all_muted = muted == count, is_folded = folded.count(group) > 0;
    const ImU32 color = ImGui::GetColorU32(all_muted ? ImGuiCol_TextDisabled : ImGuiCol_Text);
    char label[256];
    if (ImGui::InvisibleButton("eye", ImVec2(20 * scale, height)))
        request_group(controller, group, all_muted ? ISO_EVENT_UNMUTE : ISO_EVENT_MUTE, 0);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(all_muted ? "Draws the strokes of the group again."
                                    : "Leaves the strokes of the group out.");
    draw_eye(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), !all_muted, color, scale);
    ImGui::SameLine();
    if (ImGui::InvisibleButton("fold", ImVec2(14 * scale, height))) {
        if (is_folded)
            folded.erase(group);
        else
            folded.insert(group);
    }
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(is_folded ? "Lists the strokes of the group." : "Hides the strokes of the group.");
    const ImVec2 lo = ImGui::GetItemRectMin(), middle(lo.x + 7 * scale, lo.y + height / 2);
    const float half = 4 * scale;
    ImDrawList *drawing = ImGui::GetWindowDrawList();
    if (is_folded)
        drawing->AddTriangleFilled(ImVec2(middle.x - half, middle.y - half),
                                   ImVec2(middle.x - half, middle.y + half),
                                   ImVec2(middle.x + half, middle.y), color);
    else
        drawing->AddTriangleFilled(ImVec2(middle.x - half, middle.y - half),
                                   ImVec2(middle.x + half, middle.y - half),
                                   ImVec2(middle.x, middle.y + half), color);
    ImGui::SameLine();
    snprintf(label, sizeof label, "%.160s  (%zu)", group, count);
    const bool selected = std::strcmp(editor->group, group) == 0;
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    if (ImGui::Selectable(label, selected))
        isosculpt_stroke_editor_select_group(editor, selected ? "" : group);
    ImGui::PopStyleColor();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "Selects the group. Dragged onto a stroke, the group takes its place; a stroke that\n"
            "is dragged onto this row is in the group.");
    drag_header(controller, list, first);
}

/* A row of the list: a stroke, or the header of its group above it. */
struct list_row {
    bool header;
    size_t at;
};

/* Lists the rows, the newest stroke first: strokes of a group that follow each other have one header. */
static std::vector<list_row> list_rows(const iso_stroke_list *list) {
    std::vector<list_row> rows;
    const char *group = "";
    for (size_t i = list->count; i-- > 0;) {
        const iso_stroke *stroke = iso_stroke_at(list, i);
        if (stroke->group[0] && std::strcmp(stroke->group, group) != 0) rows.push_back({true, i});
        group = stroke->group;
        if (!folded.count(group)) rows.push_back({false, i});
    }
    return rows;
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
        snprintf(label, sizeof label, "%s%u  %s  %.2f mm", stroke->group[0] ? "   " : "", stroke->number,
                 iso_tool_name(stroke->brush.tool), stroke->brush.radius);
    const bool selected = isosculpt_stroke_editor_selects(editor, stroke);
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
    ImGui::BeginDisabled(!editor->first && !editor->group[0]);
    {
        const button_row row("DeleteMuteUnmuteInsertReseat", 5);
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
        ImGui::BeginDisabled(!editor->first);
        if (ImGui::Button("Insert")) editor->before = editor->before == editor->first ? 0 : editor->first;
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip(
                "New strokes go before this one, where the line is: first they are drawn at the\n"
                "end, then moved there. Pressed again: to the end.");
        row.next();
        if (ImGui::Button("Reseat"))
            isosculpt_stroke_editor_request_all(editor, ISO_EVENT_RESEAT, &controller->error);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip(
                "Moves the selected strokes along with the surface that edits of earlier strokes\n"
                "have moved from under them.");
        ImGui::EndDisabled();
    }
    ImGui::BeginDisabled(!editor->first);
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
    ImGui::EndDisabled();
}

void panel_draw_strokes(isosculpt_controller *controller, float scale) {
    if (!ImGui::CollapsingHeader("Strokes")) return;
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
    const std::vector<list_row> rows = list_rows(list);
    clipper.Begin((int)rows.size());
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; i++) {
            const list_row &row = rows[(size_t)i];
            if (!row.header) {
                draw_row(controller, list, row.at, scale);
                continue;
            }
            ImGui::PushID((int)(row.at + list->count));
            ImGui::PushID("group");
            draw_header(controller, list, iso_stroke_at(list, row.at)->group, scale);
            ImGui::PopID();
            ImGui::PopID();
        }
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
