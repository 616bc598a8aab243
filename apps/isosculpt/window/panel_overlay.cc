/* The picture, and over it the brush's ring, the mirror planes, queued and selected strokes. */
#include <cmath>
#include <cstdio>

#include "apps/isosculpt/viewport/mirror_line.h"
#include "apps/isosculpt/window/panel_parts.hpp"

/* Returns the window coordinates of a pixel of the picture. */
static ImVec2 to_window(const isosculpt_screen *screen, double x, double y) {
    return ImVec2((float)((x + screen->picture_x) / screen->pixels), (float)(y / screen->pixels));
}

/* Two unit vectors that span the plane normal to `normal`. */
static void find_tangents(iso_vec3 normal, iso_vec3 *u, iso_vec3 *v) {
    iso_vec3 other = std::fabs(normal.x) < 0.6 ? iso_vec3_make(1, 0, 0) : iso_vec3_make(0, 1, 0);
    *u = iso_vec3_unit(iso_vec3_cross(normal, other));
    *v = iso_vec3_cross(normal, *u);
}

static void draw_ring(const isosculpt_screen *screen, ImDrawList *list, iso_vec3 position, iso_vec3 normal,
                      double radius, ImU32 color, float scale) {
    constexpr int CORNERS = 64;
    const isosculpt_pick_buffer *buffer = &screen->controller->viewport->drawn;
    ImVec2 corners[CORNERS];
    iso_vec3 u, v;
    double x, y, sine, cosine;
    find_tangents(normal, &u, &v);
    for (int i = 0; i < CORNERS; i++) {
        iso_sincos(2 * ISO_PI * i / CORNERS, &sine, &cosine);
        iso_vec3 offset = iso_vec3_add(iso_vec3_scale(u, radius * cosine), iso_vec3_scale(v, radius * sine));
        if (!isosculpt_pick_buffer_pixel(buffer, iso_vec3_add(position, offset), &x, &y)) return;
        corners[i] = to_window(screen, x, y);
    }
    list->AddPolyline(corners, CORNERS, IM_COL32(0, 0, 0, 140), ImDrawFlags_Closed, 3.5f * scale);
    list->AddPolyline(corners, CORNERS, color, ImDrawFlags_Closed, 1.5f * scale);
}

void panel_draw_brush(const isosculpt_screen *screen, float scale) {
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    isosculpt_controller *controller = screen->controller;
    isosculpt_pick pick;
    double x, y;
    if (controller->measuring.on || iso_tool_is_trim(controller->brush.tool) ||
        !isosculpt_controller_pick(controller, &pick))
        return;
    static iso_brush_image images[ISO_IMAGES_MOST];
    const int count = iso_brush_images(&controller->brush, images);
    for (int i = 1; i < count; i++)
        draw_ring(screen, list, iso_brush_image_point(&images[i], pick.position),
                  iso_brush_image_direction(&images[i], pick.normal), controller->brush.radius,
                  IM_COL32(255, 255, 255, 110), scale);
    draw_ring(screen, list, pick.position, pick.normal, controller->brush.radius,
              IM_COL32(255, 255, 255, 230), scale);
    iso_vec3 tip = iso_vec3_add(pick.position, iso_vec3_scale(pick.normal, 0.4 * controller->brush.radius));
    if (isosculpt_pick_buffer_pixel(&controller->viewport->drawn, tip, &x, &y))
        list->AddLine(to_window(screen, controller->x, controller->y), to_window(screen, x, y),
                      IM_COL32(255, 255, 255, 160), 1.5f * scale);
}

static const ImU32 AXIS_COLORS[] = {IM_COL32(255, 120, 110, 235), IM_COL32(130, 225, 120, 235),
                                    IM_COL32(120, 170, 255, 235)};

/* Draws the lines where a mirror plane cuts the surface and the box around it. */
static void draw_plane(const isosculpt_screen *screen, ImDrawList *list, int axis, float scale) {
    enum { SEGMENTS = 4096 };
    static isosculpt_segment segments[SEGMENTS];
    const isosculpt_controller *controller = screen->controller;
    const isosculpt_pick_buffer *buffer = &controller->viewport->drawn;
    const iso_vec3 mirror = isosculpt_controller_brush(screen->controller)->mirror,
                   lo = controller->surface_box.lo, hi = controller->surface_box.hi;
    const double at[] = {mirror.x, mirror.y, mirror.z}, low[] = {lo.x, lo.y, lo.z},
                 high[] = {hi.x, hi.y, hi.z};
    const size_t count = isosculpt_mirror_lines(buffer, axis, at[axis], segments, SEGMENTS);
    for (size_t i = 0; i < count; i++)
        list->AddLine(to_window(screen, segments[i].x[0], segments[i].y[0]),
                      to_window(screen, segments[i].x[1], segments[i].y[1]), AXIS_COLORS[axis], 2 * scale);
    ImVec2 corners[4];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i < 4; i++) {
        double p[3], x, y;
        const double more_u = 0.06 * (high[u] - low[u]), more_v = 0.06 * (high[v] - low[v]);
        p[axis] = at[axis];
        p[u] = i == 1 || i == 2 ? high[u] + more_u : low[u] - more_u;
        p[v] = i >= 2 ? high[v] + more_v : low[v] - more_v;
        if (!isosculpt_pick_buffer_pixel(buffer, iso_vec3_make(p[0], p[1], p[2]), &x, &y)) return;
        corners[i] = to_window(screen, x, y);
    }
    list->AddPolyline(corners, 4, AXIS_COLORS[axis], ImDrawFlags_Closed, scale);
}

/* Draws the axis of a radial symmetry, a little longer than the box of the surface. */
static void draw_axis(const isosculpt_screen *screen, ImDrawList *list, const iso_brush *brush, float scale) {
    const iso_vec3 lo = screen->controller->surface_box.lo, hi = screen->controller->surface_box.hi;
    const double low[] = {lo.x, lo.y, lo.z}, high[] = {hi.x, hi.y, hi.z};
    const isosculpt_pick_buffer *buffer = &screen->controller->viewport->drawn;
    const int axis = iso_brush_radial_axis(brush);
    const double more = 0.12 * (high[axis] - low[axis]);
    double p[] = {brush->mirror.x, brush->mirror.y, brush->mirror.z}, x[2], y[2];
    for (int end = 0; end < 2; end++) {
        p[axis] = end ? high[axis] + more : low[axis] - more;
        if (!isosculpt_pick_buffer_pixel(buffer, iso_vec3_make(p[0], p[1], p[2]), &x[end], &y[end])) return;
    }
    list->AddLine(to_window(screen, x[0], y[0]), to_window(screen, x[1], y[1]), AXIS_COLORS[axis],
                  1.5f * scale);
}

/* Draws the path of a stroke. */
static void draw_path(const isosculpt_screen *screen, ImDrawList *list, const iso_sample *samples,
                      size_t count, ImU32 color, float scale) {
    const isosculpt_pick_buffer *buffer = &screen->controller->viewport->drawn;
    ImVec2 before(0, 0);
    double x, y;
    for (size_t i = 0; i < count; i++) {
        if (!isosculpt_pick_buffer_pixel(buffer, samples[i].position, &x, &y)) continue;
        const ImVec2 now = to_window(screen, x, y);
        list->AddCircleFilled(now, 3 * scale, color);
        if (i) list->AddLine(before, now, color, 2 * scale);
        before = now;
    }
}

/* Draws the handles of a path. */
static void draw_handles(const isosculpt_screen *screen, ImDrawList *list, const iso_sample *samples,
                         size_t count, ImU32 color, float scale) {
    size_t at[ISOSCULPT_HANDLES];
    const int handles = isosculpt_path_handles(samples, count, at),
              taken = isosculpt_controller_path_handle(screen->controller);
    const float half = 5 * scale;
    double x, y;
    for (int i = 0; i < handles; i++) {
        if (!isosculpt_pick_buffer_pixel(&screen->controller->viewport->drawn, samples[at[i]].position, &x,
                                         &y))
            continue;
        const ImVec2 middle = to_window(screen, x, y);
        list->AddCircleFilled(middle, half, i == taken ? IM_COL32_WHITE : color);
        list->AddCircle(middle, half, IM_COL32(0, 0, 0, 190), 0, 1.5f * scale);
    }
}

/* Draws the paths of the strokes that are selected; of a single one its handles, too, and how far its brush
 * reaches at its ends. */
static void draw_selected(const isosculpt_screen *screen, ImDrawList *list, float scale) {
    int left = 100; /* more would hide the picture */
    const ImU32 color = IM_COL32(255, 200, 60, 230);
    isosculpt_document *document = screen->controller->document;
    isosculpt_stroke_editor *editor = &document->strokes;
    const bool any = editor->first || editor->group[0];
    const iso_stroke_list *strokes = any ? isosculpt_stroke_editor_list(editor, document->session) : nullptr;
    for (size_t i = 0; strokes && i < strokes->count && left; i++) {
        const iso_stroke *stroke = iso_stroke_at(strokes, i);
        if (!isosculpt_stroke_editor_selects(editor, stroke) || !isosculpt_tool_has_path(stroke->brush.tool))
            continue;
        const iso_sample *samples = isosculpt_controller_path(screen->controller, stroke);
        draw_path(screen, list, samples, stroke->count, color, scale);
        left--;
        if (!editor->first || editor->first != editor->last) continue;
        draw_handles(screen, list, samples, stroke->count, color, scale);
        if (iso_tool_is_trim(stroke->brush.tool)) continue;
        for (const iso_sample *end : {&samples[0], &samples[stroke->count - 1]})
            draw_ring(screen, list, end->position, end->normal, editor->brush.radius, color, scale);
    }
}

/* Draws the plane that cuts as a frame as large as the surface, and its handle: a ring that moves it, and an
 * arrow, towards what is cut away, whose tip tilts it. */
static void draw_cut(const isosculpt_screen *screen, ImDrawList *list, float scale) {
    const isosculpt_controller *controller = screen->controller;
    const isosculpt_viewport *viewport = controller->viewport;
    const isosculpt_cut *cut = &viewport->cut;
    const iso_view view = iso_view_make(&viewport->camera, screen->picture_width, screen->height);
    isosculpt_cut_handle handle;
    if (!isosculpt_cut_find_handle(cut, &view, controller->scale, &handle)) return;
    const ImU32 color = IM_COL32(255, 190, 90, 255), dark = IM_COL32(0, 0, 0, 150);
    iso_vec3 u, v;
    double low[2] = {0, 0}, high[2] = {0, 0}, x, y;
    find_tangents(cut->outward, &u, &v);
    for (int corner = 0; corner < 8; corner++) {
        const iso_vec3 from = iso_vec3_sub(iso_box_corner(&controller->surface_box, corner), cut->handle);
        const double along[2] = {iso_vec3_dot(from, u), iso_vec3_dot(from, v)};
        for (int k = 0; k < 2; k++) {
            low[k] = std::fmin(low[k], along[k]);
            high[k] = std::fmax(high[k], along[k]);
        }
    }
    ImVec2 corners[4];
    bool whole = true;
    for (int i = 0; i < 4; i++) {
        const iso_vec3 across = iso_vec3_scale(u, i == 1 || i == 2 ? high[0] : low[0]),
                       up = iso_vec3_scale(v, i >= 2 ? high[1] : low[1]);
        whole &= isosculpt_pick_buffer_pixel(&viewport->drawn,
                                             iso_vec3_add(cut->handle, iso_vec3_add(across, up)), &x, &y);
        corners[i] = to_window(screen, x, y);
    }
    if (whole) list->AddPolyline(corners, 4, IM_COL32(255, 190, 90, 150), ImDrawFlags_Closed, scale);
    const isosculpt_cut_part part = isosculpt_controller_handle(controller);
    const ImVec2 at = to_window(screen, handle.x, handle.y),
                 tip = to_window(screen, handle.tip_x, handle.tip_y);
    const float grip = 0.7f * scale * (float)ISOSCULPT_CUT_GRIP;
    list->AddLine(at, tip, dark, 4 * scale);
    list->AddLine(at, tip, color, 2 * scale);
    list->AddCircleFilled(tip, 0.8f * grip, part == ISOSCULPT_CUT_TIP ? IM_COL32_WHITE : color);
    list->AddCircle(tip, 0.8f * grip, dark, 0, scale);
    list->AddCircleFilled(at, grip, part == ISOSCULPT_CUT_POINT ? IM_COL32_WHITE : color);
    list->AddCircle(at, grip, dark, 0, 1.5f * scale);
}

/* Draws what outlines a part that is to be removed: a lasso with the line that closes it, or a line with
 * ticks on the side that goes. */
static void draw_outline(const isosculpt_screen *screen, ImDrawList *list, float scale) {
    const isosculpt_controller *controller = screen->controller;
    const isosculpt_outline *o = &controller->outline;
    const ImU32 color = IM_COL32(255, 190, 90, 255), dark = IM_COL32(0, 0, 0, 140);
    static ImVec2 corners[ISOSCULPT_OUTLINE_POINTS];
    const bool line = controller->brush.tool == ISO_TOOL_TRIM_PLANE;
    for (int i = 0; i < o->count; i++) corners[i] = to_window(screen, o->at[i][0], o->at[i][1]);
    const ImDrawFlags closed = line ? ImDrawFlags_None : ImDrawFlags_Closed;
    list->AddPolyline(corners, o->count, dark, closed, 3.5f * scale);
    list->AddPolyline(corners, o->count, color, closed, 1.5f * scale);
    if (!line || o->count < 2) return;
    const float x = corners[1].x - corners[0].x, y = corners[1].y - corners[0].y,
                length = std::sqrt(x * x + y * y), tick = 8 * scale;
    const bool left = controller->press_modifiers & (ISOSCULPT_MODIFIER_CTRL | ISOSCULPT_MODIFIER_ALT);
    const ImVec2 aside(left ? y / length * tick : -y / length * tick,
                       left ? -x / length * tick : x / length * tick);
    for (float at = 0.5f * tick; at < length; at += tick) {
        const ImVec2 from(corners[0].x + x * at / length, corners[0].y + y * at / length);
        list->AddLine(from, ImVec2(from.x + aside.x, from.y + aside.y), color, scale);
    }
}

/* Draws a text on a dark ground, centred below a place of the window. */
static void draw_label(ImDrawList *list, ImVec2 at, const char *text, ImU32 color, float scale) {
    const ImVec2 size = ImGui::CalcTextSize(text), from(at.x - size.x / 2, at.y + 8 * scale);
    list->AddRectFilled(ImVec2(from.x - 4 * scale, from.y),
                        ImVec2(from.x + size.x + 4 * scale, from.y + size.y), IM_COL32(0, 0, 0, 160),
                        3 * scale);
    list->AddText(from, color, text);
}

/* Draws the places that are measured: how thick it is at a single one, how far apart two are. */
static void draw_measured(const isosculpt_screen *screen, ImDrawList *list, float scale) {
    const isosculpt_measuring *measuring = &screen->controller->measuring;
    const ImU32 color = IM_COL32(120, 230, 255, 255), dark = IM_COL32(0, 0, 0, 160);
    const bool pair = measuring->count == 2;
    ImVec2 at[2];
    char length[40], text[64];
    double x, y;
    for (int i = 0; i < measuring->count; i++) {
        if (!isosculpt_pick_buffer_pixel(&screen->controller->viewport->drawn, measuring->place[i].position,
                                         &x, &y))
            return;
        at[i] = to_window(screen, x, y);
    }
    if (pair) {
        list->AddLine(at[0], at[1], dark, 4 * scale);
        list->AddLine(at[0], at[1], color, 2 * scale);
    }
    for (int i = 0; i < measuring->count; i++) {
        list->AddCircleFilled(at[i], 5 * scale, color);
        list->AddCircle(at[i], 5 * scale, dark, 0, scale);
    }
    if (!measuring->count) return;
    isosculpt_length_text(pair ? isosculpt_measuring_distance(measuring) : measuring->place[0].thickness,
                          length, sizeof length);
    snprintf(text, sizeof text, "%s%s", pair ? "" : "thickness ", length);
    draw_label(list, pair ? ImVec2((at[0].x + at[1].x) / 2, (at[0].y + at[1].y) / 2) : at[0], text, color,
               scale);
}

void panel_draw_picture(const isosculpt_screen *screen, float scale) {
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const isosculpt_controller *controller = screen->controller;
    const iso_brush *brush = isosculpt_controller_brush(screen->controller);
    if (screen->texture)
        list->AddImage((ImTextureID)(intptr_t)screen->texture, to_window(screen, 0, 0),
                       to_window(screen, screen->picture_width, screen->height));
    if (!screen->blank) draw_cut(screen, list, scale);
    if (screen->blank || (screen->volume && !screen->sculpting)) return;
    for (int axis = 0; axis < 3; axis++)
        if (brush->symmetry >> axis & 1) draw_plane(screen, list, axis, scale);
    if (iso_brush_is_radial(brush)) draw_axis(screen, list, brush, scale);
    for (size_t i = 0; i < controller->queued_strokes.count; i++) {
        const isosculpt_stroke *stroke = &controller->queued_strokes.strokes[i];
        draw_path(screen, list, stroke->samples, stroke->count, IM_COL32(255, 255, 255, 190), scale);
    }
    draw_selected(screen, list, scale);
    if (controller->measuring.on) draw_measured(screen, list, scale);
    if (controller->drag == ISOSCULPT_DRAG_OUTLINE) draw_outline(screen, list, scale);
}
