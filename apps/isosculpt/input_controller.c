/* The input controller: drags become strokes or camera moves, keys become commands. */
#include "apps/isosculpt/input_controller.h"
#include "base/clock.h"
#include "sculpt/brush/dab.h"

#include <math.h>
#include <string.h>

/* Factors: zoom of a step of the wheel, radius of a key press and of a pixel of dragging with X; strength
 * that is added by a pixel of dragging with C. */
static const double WHEEL_ZOOM = 1.1, RADIUS_STEP = 1.15, RADIUS_A_PIXEL = 1.01, STRENGTH_A_PIXEL = 0.005;
static const double STRENGTH_MIN = 0.02;
/* Zoom of a key press; pan of a key press, in picture heights. */
static const double KEY_ZOOM = 1.25, KEY_PAN = 0.1;
/* Pixels that the pointer moves at scale 1 before a press with Alt is a stroke. */
static const double CLICK_PIXELS = 2;

static const struct {
    iso_tool tool;
    char key;
} tools[ISOSCULPT_TOOLS] = {{ISO_TOOL_ADD, '1'},        {ISO_TOOL_CARVE, '2'},      {ISO_TOOL_BLEND_ADD, '3'},
                            {ISO_TOOL_SMOOTH, '4'},     {ISO_TOOL_INFLATE, '5'},    {ISO_TOOL_FLATTEN, '6'},
                            {ISO_TOOL_PINCH, '7'},      {ISO_TOOL_MOVE, '8'},       {ISO_TOOL_MASK, '9'},
                            {ISO_TOOL_CLAY, '0'},       {ISO_TOOL_SCRAPE, 't'},     {ISO_TOOL_FILL, 'l'},
                            {ISO_TOOL_CREASE, 'w'},     {ISO_TOOL_SNAKE_HOOK, 'j'}, {ISO_TOOL_PAINT, 'p'},
                            {ISO_TOOL_TRIM_PLANE, 'b'}, {ISO_TOOL_TRIM_LASSO, 'a'}};

iso_tool isosculpt_controller_tool(int number) {
    return tools[number].tool;
}

char isosculpt_controller_tool_key(int number) {
    return tools[number].key;
}

iso_tool isosculpt_controller_modified_tool(iso_tool tool, unsigned modifiers) {
    static const iso_tool pairs[][2] = {
        {ISO_TOOL_ADD, ISO_TOOL_CARVE},       {ISO_TOOL_BLEND_ADD, ISO_TOOL_BLEND_CARVE},
        {ISO_TOOL_INFLATE, ISO_TOOL_DEFLATE}, {ISO_TOOL_FILL, ISO_TOOL_SCRAPE},
        {ISO_TOOL_CLAY, ISO_TOOL_SCRAPE}, /* (scraping is inverted above) */
        {ISO_TOOL_MASK, ISO_TOOL_UNMASK},     {ISO_TOOL_TRIM_LASSO, ISO_TOOL_CROP_LASSO}};
    if (modifiers & ISOSCULPT_MODIFIER_SHIFT && !iso_tool_is_trim(tool)) return ISO_TOOL_SMOOTH;
    if (!(modifiers & (ISOSCULPT_MODIFIER_CTRL | ISOSCULPT_MODIFIER_ALT))) return tool;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        for (int side = 0; side < 2; side++)
            if (tool == pairs[i][side]) return pairs[i][1 - side];
    return tool;
}

static bool is_masked(const void *session, int x, int y, int z) {
    return iso_session_masked(session, x, y, z);
}

/* Passes the session's paint on to the viewport, and its mask, whose voxels are drawn darker. */
static void update_items(isosculpt_controller *controller) {
    iso_session *session = controller->document->session;
    controller->viewport->painted = iso_painted_make(iso_session_paint(session), iso_session_grid(session),
                                                     controller->viewport->mode.material.color);
    controller->viewport->painted.log = iso_session_paint_log(session);
    bool any = iso_session_has_mask(session),
         masks = controller->tool == ISO_TOOL_MASK || controller->tool == ISO_TOOL_UNMASK;
    controller->viewport->mask_changed |= any != (controller->viewport->mask.at != NULL) || masks;
    controller->viewport->mask = any ? (isosculpt_mask){is_masked, session} : (isosculpt_mask){NULL, NULL};
}

void isosculpt_controller_init(isosculpt_controller *controller, isosculpt_document *document,
                               isosculpt_viewport *viewport) {
    *controller = (isosculpt_controller){
        .document = document, .viewport = viewport, .x = -1, .y = -1, .scale = 1, .pressure = 1};
    controller->brush = (iso_brush){.tool = ISO_TOOL_ADD,
                                    .radius = 16 * document->start.voxel_size,
                                    .strength = 0.5,
                                    .pressure_radius = true,
                                    .color = {216, 72, 40}};
    isosculpt_controller_center_mirror(controller);
    update_items(controller);
}

void isosculpt_controller_free(isosculpt_controller *controller) {
    isosculpt_strokes_free(&controller->queued_strokes);
    isosculpt_bending_free(&controller->bending);
}

void isosculpt_controller_center_mirror(isosculpt_controller *controller) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&controller->viewport->grid));
    controller->surface_box = isosculpt_viewport_bounds(controller->viewport);
    iso_vec3 middle =
        iso_vec3_scale(iso_vec3_add(controller->surface_box.lo, controller->surface_box.hi), 0.5);
    iso_vec3 at = iso_affine_point_to_index(&affine, middle);
    at = iso_vec3_make(0.5 * round(2 * at.x), 0.5 * round(2 * at.y), 0.5 * round(2 * at.z));
    isosculpt_controller_brush(controller)->mirror = iso_affine_point(&affine, at);
}

iso_brush *isosculpt_controller_brush(isosculpt_controller *controller) {
    isosculpt_document *document = controller->document;
    const iso_stroke *stroke = isosculpt_stroke_editor_stroke(&document->strokes, document->session);
    return stroke ? &document->strokes.brush : &controller->brush;
}

/* ---- strokes */

bool isosculpt_tool_has_shape(iso_tool tool) {
    return iso_tool_is_set_operation(tool);
}

bool isosculpt_tool_has_strength(iso_tool tool) {
    return tool < ISO_TOOL_MASK || tool == ISO_TOOL_PAINT;
}

/* Returns the centre of a touch. For tools that add or remove a solid it is moved off the surface, so that
 * the solid extends beyond the surface by `strength` times its radius: the centre is below the surface when
 * adding, and above it when carving. */
static iso_vec3 touch_center(const isosculpt_controller *controller, iso_vec3 position, iso_vec3 normal) {
    if (!isosculpt_tool_has_shape(controller->tool)) return position;
    const double radius = controller->brush.radius *
                          (controller->brush.pressure_radius ? controller->pressure : 1),
                 strength = controller->brush.strength *
                            (controller->brush.pressure_strength ? controller->pressure : 1);
    double away = (1 - strength) * radius;
    bool adds = controller->tool == ISO_TOOL_ADD || controller->tool == ISO_TOOL_BLEND_ADD;
    return iso_vec3_add(position, iso_vec3_scale(normal, adds ? -away : away));
}

/* Computes the sample at a pointer position. It lies on the surface as it was when the stroke began, so that
 * a stroke does not climb onto material that it has added itself; for a tool that drags it has the depth of
 * the first sample. */
static iso_sample sample_at(isosculpt_controller *controller, double x, double y) {
    isosculpt_pick pick;
    const isosculpt_pick_buffer *buffer = &controller->viewport->pick_buffer;
    const bool at_first_depth =
        iso_tool_is_drag(controller->tool) && controller->drag == ISOSCULPT_DRAG_BRUSH;
    if (!at_first_depth && isosculpt_pick_buffer_pick(buffer, x, y, &pick)) {
        controller->depth = pick.depth;
        controller->normal = pick.normal;
    }
    iso_vec3 position = isosculpt_pick_buffer_point(buffer, x, y, controller->depth);
    return (iso_sample){.position = touch_center(controller, position, controller->normal),
                        .normal = controller->normal,
                        .pressure = controller->pressure,
                        .seconds = iso_clock_seconds() - controller->document->start_seconds};
}

/* Updates mask, picture and error after a change of the session. */
static void finish_edit(isosculpt_controller *controller, iso_status status, const iso_edit_stats *stats) {
    controller->edited = true;
    controller->clipped |= stats->clipped;
    controller->commands |= ISOSCULPT_COMMAND_REDRAW;
    update_items(controller);
    if (status == ISO_OK)
        controller->error.text[0] = 0;
    else if (!controller->error.text[0])
        iso_fail(&controller->error, status, "%s", iso_status_text(status));
}

/* Cancels a stroke that could not be ended for lack of memory; until then no other edit is possible. Returns
 * whether no such stroke is left. */
static bool cancel_unfinished_stroke(isosculpt_controller *controller) {
    iso_error reason = {0};
    if (controller->stroke_unfinished)
        controller->stroke_unfinished =
            iso_session_cancel(controller->document->session, &reason) == ISO_ERR_NOMEM;
    if (controller->stroke_unfinished && !controller->error.text[0]) controller->error = reason;
    return !controller->stroke_unfinished;
}

bool isosculpt_tool_has_color(iso_tool tool) {
    return iso_tool_is_set_operation(tool) || tool == ISO_TOOL_PAINT || tool == ISO_TOOL_INFLATE ||
           tool == ISO_TOOL_FILL || tool == ISO_TOOL_CLAY || iso_tool_is_trim(tool);
}

void isosculpt_controller_pick_color(isosculpt_controller *controller) {
    isosculpt_pick pick;
    const isosculpt_viewport *viewport = controller->viewport;
    if (controller->viewing_volume || !isosculpt_controller_pick(controller, &pick)) return;
    iso_painted painted = viewport->painted;
    painted.own = viewport->mode.material.color;
    isosculpt_controller_brush(controller)->color = iso_painted_color(&painted, pick.position);
}

/* Returns the brush of the stroke: the chosen brush with the stroke's tool. Painting has the colour, unless
 * modifier keys turn it into taking paint away. */
static iso_brush stroke_brush(const isosculpt_controller *controller, unsigned modifiers) {
    iso_brush brush = controller->brush;
    brush.tool = controller->tool;
    if (brush.tool == ISO_TOOL_PAINT)
        brush.has_color = !(modifiers & (ISOSCULPT_MODIFIER_CTRL | ISOSCULPT_MODIFIER_ALT));
    else
        brush.has_color &= isosculpt_tool_has_color(brush.tool);
    const iso_stamp *stamp = iso_session_stamp(controller->document->session);
    if (!iso_tool_has_alpha(brush.tool) || !stamp || !stamp->heights.value) brush.alpha = ISO_ALPHA_NONE;
    return isosculpt_brush_drawn(&brush);
}

static iso_status begin_stroke(isosculpt_controller *controller, const iso_brush *brush,
                               const iso_sample *sample, iso_edit_stats *stats) {
    controller->queueing =
        controller->viewing_volume || isosculpt_stroke_editor_is_busy(&controller->document->strokes);
    if (controller->queueing)
        return isosculpt_strokes_begin(&controller->queued_strokes, brush, sample, &controller->error);
    double start = iso_clock_seconds();
    iso_status status =
        iso_session_begin(controller->document->session, brush, sample, stats, &controller->error);
    isosculpt_latency_add(&controller->edit, iso_clock_seconds() - start);
    controller->document->change_count += status == ISO_OK;
    return status;
}

static void begin_drawing(isosculpt_controller *controller, unsigned modifiers, double x, double y) {
    iso_edit_stats stats = {0};
    if (!cancel_unfinished_stroke(controller)) return;
    controller->tool = isosculpt_controller_modified_tool(controller->brush.tool, modifiers);
    const iso_brush brush = stroke_brush(controller, modifiers);
    if (isosculpt_viewport_keep_pick_buffer(controller->viewport, &controller->error) != ISO_OK) return;
    iso_sample sample = sample_at(controller, x, y);
    iso_status status = begin_stroke(controller, &brush, &sample, &stats);
    if (status == ISO_OK) {
        controller->drag = ISOSCULPT_DRAG_BRUSH;
        controller->last_sample = sample;
        isosculpt_stroke_editor_select(&controller->document->strokes, 0, 0);
    }
    finish_edit(controller, status, &stats);
}

/* Returns the distance (mm) between samples for tools that touch at every sample; 0 for tools whose touches
 * are spaced by the session. */
static double sample_spacing(const isosculpt_controller *controller) {
    if (controller->tool == ISO_TOOL_ADD || controller->tool == ISO_TOOL_CARVE)
        return 0.15 * controller->brush.radius;
    return controller->tool == ISO_TOOL_MOVE ? controller->document->start.voxel_size : 0;
}

static void continue_drawing(isosculpt_controller *controller, double x, double y, bool last) {
    iso_edit_stats stats = {0};
    iso_sample sample = sample_at(controller, x, y);
    double moved = iso_vec3_length(iso_vec3_sub(sample.position, controller->last_sample.position));
    if (moved <= (last ? 0 : sample_spacing(controller))) return;
    controller->last_sample = sample;
    double start = iso_clock_seconds();
    iso_status status =
        controller->queueing
            ? isosculpt_strokes_add(&controller->queued_strokes, &sample, &controller->error)
            : iso_session_sample(controller->document->session, &sample, &stats, &controller->error);
    isosculpt_latency_add(&controller->edit, iso_clock_seconds() - start);
    finish_edit(controller, status, &stats);
}

static void end_queued_stroke(isosculpt_controller *controller, bool cancel) {
    controller->drag = ISOSCULPT_DRAG_NONE;
    if (cancel) isosculpt_strokes_remove_last(&controller->queued_strokes);
}

/* Ends or cancels the stroke. A stroke that cannot be ended is cancelled. */
static void end_drawing(isosculpt_controller *controller, bool cancel) {
    iso_edit_stats stats = {0};
    if (controller->queueing) {
        end_queued_stroke(controller, cancel);
        return;
    }
    iso_session *session = controller->document->session;
    controller->drag = ISOSCULPT_DRAG_NONE;
    iso_status status = cancel ? iso_session_cancel(session, &controller->error)
                               : iso_session_end(session, &controller->error);
    controller->stroke_unfinished = status != ISO_OK;
    cancel_unfinished_stroke(controller);
    if (status == ISO_OK && !cancel)
        status = isosculpt_stroke_editor_place(&controller->document->strokes, session, &controller->error);
    if (controller->brush.symmetry || iso_brush_is_radial(&controller->brush))
        controller->surface_box = isosculpt_viewport_bounds(controller->viewport);
    finish_edit(controller, status, &stats);
}

/* ---- outlines */

/* Adds a place of the pointer: of a line its end, of a lasso one more when it has moved far enough. A lasso
 * with too many places keeps every second one. */
static void extend_outline(isosculpt_controller *controller, double x, double y) {
    const double step = 3 * controller->scale;
    isosculpt_outline *o = &controller->outline;
    if (controller->brush.tool == ISO_TOOL_TRIM_PLANE && o->count > 1) o->count = 1;
    if (o->count && hypot(x - o->at[o->count - 1][0], y - o->at[o->count - 1][1]) < step) return;
    if (o->count == ISOSCULPT_OUTLINE_POINTS) {
        o->count /= 2;
        for (int i = 0; i < o->count; i++) memcpy(o->at[i], o->at[2 * i], sizeof o->at[i]);
    }
    o->at[o->count][0] = x;
    o->at[o->count++][1] = y;
}

static void begin_outline(isosculpt_controller *controller, unsigned modifiers, double x, double y) {
    controller->drag = ISOSCULPT_DRAG_OUTLINE;
    controller->press_modifiers = modifiers;
    controller->outline.count = 0;
    extend_outline(controller, x, y);
}

/* The sample of a place: a point behind it, and the direction from there to the viewer. */
static iso_sample outline_sample(const isosculpt_controller *controller, const double at[2]) {
    const iso_view *view = &controller->viewport->drawn.view;
    const double samples = controller->viewport->drawn.samples;
    iso_vec3 origin, direction;
    iso_view_ray(view, samples * at[0], samples * at[1], &origin, &direction);
    const iso_vec3 middle =
        iso_vec3_scale(iso_vec3_add(controller->surface_box.lo, controller->surface_box.hi), 0.5);
    const double depth =
        iso_vec3_dot(iso_vec3_sub(middle, origin), direction) / iso_vec3_dot(direction, direction);
    return (iso_sample){.position = iso_vec3_add(origin, iso_vec3_scale(direction, depth)),
                        .normal = iso_vec3_scale(iso_vec3_unit(direction), -1),
                        .pressure = 1,
                        .seconds = iso_clock_seconds() - controller->document->start_seconds};
}

/* Draws the outline as a stroke. What outlines nothing is no stroke: a click, a lasso without an inside. */
static void end_outline(isosculpt_controller *controller) {
    const isosculpt_outline *o = &controller->outline;
    const bool line = controller->brush.tool == ISO_TOOL_TRIM_PLANE,
               reversed =
                   line && controller->press_modifiers & (ISOSCULPT_MODIFIER_CTRL | ISOSCULPT_MODIFIER_ALT);
    iso_edit_stats stats = {0};
    controller->drag = ISOSCULPT_DRAG_NONE;
    if (o->count < (line ? 2 : 3) || !(controller->viewport->drawn.samples > 0) ||
        !cancel_unfinished_stroke(controller))
        return;
    controller->tool =
        isosculpt_controller_modified_tool(controller->brush.tool, controller->press_modifiers);
    const iso_brush brush = stroke_brush(controller, controller->press_modifiers);
    controller->surface_box = isosculpt_viewport_bounds(controller->viewport);
    iso_sample sample = outline_sample(controller, o->at[reversed ? o->count - 1 : 0]);
    iso_status status = begin_stroke(controller, &brush, &sample, &stats);
    const bool begun = status == ISO_OK;
    for (int i = 1; i < o->count && status == ISO_OK; i++) {
        sample = outline_sample(controller, o->at[reversed ? o->count - 1 - i : i]);
        status = controller->queueing
                     ? isosculpt_strokes_add(&controller->queued_strokes, &sample, &controller->error)
                     : iso_session_sample(controller->document->session, &sample, &stats, &controller->error);
    }
    if (begun) isosculpt_stroke_editor_select(&controller->document->strokes, 0, 0);
    if (begun) end_drawing(controller, status != ISO_OK);
    const iso_grid *grid = &controller->viewport->grid;
    controller->emptied = begun && !controller->queueing && !iso_hgrid_brick_count(grid->hgrid);
    if (!begun) finish_edit(controller, status, &stats);
}

static iso_status apply_stroke(isosculpt_controller *controller, const isosculpt_stroke *stroke,
                               iso_edit_stats *stats) {
    iso_session *session = controller->document->session;
    iso_status status =
        iso_session_begin(session, &stroke->brush, &stroke->samples[0], stats, &controller->error);
    if (status != ISO_OK) return status;
    controller->document->change_count++;
    for (size_t i = 1; i < stroke->count && status == ISO_OK; i++)
        status = iso_session_sample(session, &stroke->samples[i], stats, &controller->error);
    const iso_status ended = iso_session_end(session, &controller->error);
    if (status == ISO_OK) status = ended;
    return status == ISO_OK
               ? isosculpt_stroke_editor_place(&controller->document->strokes, session, &controller->error)
               : status;
}

void isosculpt_controller_drop_strokes(isosculpt_controller *controller) {
    if (controller->viewing_volume && controller->drag == ISOSCULPT_DRAG_BRUSH)
        controller->drag = ISOSCULPT_DRAG_NONE;
    controller->field_pending = false;
    isosculpt_strokes_free(&controller->queued_strokes);
}

void isosculpt_controller_apply_strokes(isosculpt_controller *controller, isosculpt_strokes *strokes) {
    iso_edit_stats stats = {0};
    iso_status status = ISO_OK;
    for (size_t i = 0; i < strokes->count && status == ISO_OK; i++)
        status = apply_stroke(controller, &strokes->strokes[i], &stats);
    isosculpt_strokes_free(strokes);
    finish_edit(controller, status, &stats);
}

void isosculpt_controller_update_strokes(isosculpt_controller *controller, void (*wake)(void)) {
    isosculpt_document *document = controller->document;
    isosculpt_stroke_editor *editor = &document->strokes;
    iso_edit_stats stats = {0};
    bool changed;
    const bool drawing = controller->drag == ISOSCULPT_DRAG_BRUSH;
    iso_status status = isosculpt_stroke_editor_take(editor, document->session, &changed, &controller->error);
    document->change_count += changed;
    controller->viewport->mask_changed |= changed;
    if (changed || status != ISO_OK) finish_edit(controller, status, &stats);
    if (controller->viewing_volume || controller->field_pending) return;
    if (!editor->task && controller->queued_strokes.count && !drawing)
        isosculpt_controller_apply_strokes(controller, &controller->queued_strokes);
    status = ISO_OK;
    if (!controller->brush_held && !controller->adjusting)
        status = isosculpt_stroke_editor_request_brush(editor, &controller->error);
    if (status == ISO_OK && (!drawing || controller->queueing))
        status = isosculpt_stroke_editor_start(editor, document->session, wake, &controller->error);
    if (status != ISO_OK) finish_edit(controller, status, &stats);
}

void isosculpt_controller_change_mask(isosculpt_controller *controller, iso_tool tool) {
    iso_edit_stats stats = {0};
    iso_session *session = controller->document->session;
    if (controller->drag || controller->viewing_volume ||
        isosculpt_stroke_editor_is_busy(&controller->document->strokes) ||
        !cancel_unfinished_stroke(controller))
        return;
    if (tool != ISO_TOOL_INVERT_MASK && !iso_session_has_mask(session)) return;
    const iso_brush brush = {.tool = tool, .radius = controller->brush.radius};
    /* The tool changes all voxels; the sample only has to be somewhere in the grid. */
    const iso_sample sample = {.position = controller->document->start.origin,
                               .normal = {0, 0, 1},
                               .pressure = 1,
                               .seconds = iso_clock_seconds() - controller->document->start_seconds};
    iso_status status = iso_session_begin(session, &brush, &sample, &stats, &controller->error);
    if (status == ISO_OK) {
        controller->document->change_count++;
        status = iso_session_end(session, &controller->error);
        controller->stroke_unfinished = status != ISO_OK;
        cancel_unfinished_stroke(controller);
    }
    finish_edit(controller, status, &stats);
    controller->viewport->mask_changed = true;
}

void isosculpt_controller_set_stamp(isosculpt_controller *controller, iso_stamp *stamp) {
    iso_edit_stats stats = {0};
    const bool picture = stamp && stamp->heights.value;
    iso_status status = iso_session_set_stamp(controller->document->session, stamp, &controller->error);
    finish_edit(controller, status, &stats);
    if (status != ISO_OK) return;
    controller->document->has_stamp = true;
    if (picture) {
        controller->brush.alpha = ISO_ALPHA_FIXED;
        if (controller->brush.shape == ISO_SOLID_STAMP) controller->brush.shape = ISO_SOLID_SPHERE;
        if (!iso_tool_has_alpha(controller->brush.tool)) controller->brush.tool = ISO_TOOL_INFLATE;
        return;
    }
    controller->brush.shape = ISO_SOLID_STAMP;
    if (!isosculpt_tool_has_shape(controller->brush.tool)) controller->brush.tool = ISO_TOOL_ADD;
}

/* ---- the mouse */

static iso_view view_of(const isosculpt_viewport *viewport) {
    return iso_view_make(&viewport->camera, viewport->width, viewport->height);
}

isosculpt_cut_part isosculpt_controller_handle(const isosculpt_controller *controller) {
    const isosculpt_viewport *viewport = controller->viewport;
    isosculpt_cut_handle handle;
    if (controller->drag == ISOSCULPT_DRAG_PLANE) return ISOSCULPT_CUT_POINT;
    if (controller->drag == ISOSCULPT_DRAG_TILT) return ISOSCULPT_CUT_TIP;
    if (controller->drag || viewport->cut.plane < 0 || viewport->width < 1 || viewport->height < 1)
        return ISOSCULPT_CUT_NOTHING;
    const iso_view view = view_of(viewport);
    return isosculpt_cut_find_handle(&viewport->cut, &view, controller->scale, &handle)
               ? isosculpt_cut_hit(&handle, controller->scale, controller->x, controller->y)
               : ISOSCULPT_CUT_NOTHING;
}

static void drag_plane(isosculpt_controller *controller, double dx, double dy) {
    isosculpt_viewport *viewport = controller->viewport;
    const iso_view view = view_of(viewport);
    viewport->style++;
    (controller->drag == ISOSCULPT_DRAG_PLANE ? isosculpt_cut_drag : isosculpt_cut_tilt)(&viewport->cut,
                                                                                         &view, dx, dy);
}

/* Picks a place of the surface to measure; says why if there is none. */
static void measure_at(isosculpt_controller *controller, iso_vec3 point) {
    const isosculpt_document *document = controller->document;
    isosculpt_measuring *measuring = &controller->measuring;
    if (isosculpt_measuring_pick(measuring, &controller->viewport->grid, point, document->pool,
                                 &controller->error) == ISO_OK)
        measuring->place_changes = document->change_count;
}

void isosculpt_controller_measure_solid(isosculpt_controller *controller) {
    const isosculpt_document *document = controller->document;
    isosculpt_measuring *measuring = &controller->measuring;
    if (controller->drag || controller->viewing_volume) return;
    measuring->has_solid = iso_measure_solid(&controller->viewport->grid, document->pool, &measuring->solid,
                                             &controller->error) == ISO_OK;
    measuring->solid_changes = document->change_count;
}

void isosculpt_controller_press(isosculpt_controller *controller, isosculpt_button button, unsigned modifiers,
                                double x, double y) {
    isosculpt_pick pick;
    if (controller->drag) return;
    controller->x = x;
    controller->y = y;
    controller->button = button;
    const bool brush =
        button == ISOSCULPT_BUTTON_LEFT && (!controller->viewing_volume || controller->field_pending);
    const isosculpt_cut_part handle = isosculpt_controller_handle(controller);
    const int path_handle = brush && !handle && !(modifiers & ISOSCULPT_MODIFIER_ALT)
                                ? isosculpt_controller_path_handle(controller)
                                : -1;
    if (button == ISOSCULPT_BUTTON_RIGHT)
        controller->drag = ISOSCULPT_DRAG_PAN;
    else if (path_handle >= 0)
        isosculpt_bending_take(controller, path_handle);
    else if (brush && !handle && controller->measuring.on && !controller->viewing_volume &&
             isosculpt_pick_buffer_pick(&controller->viewport->drawn, x, y, &pick))
        measure_at(controller, pick.position);
    else if (brush && !handle && iso_tool_is_trim(controller->brush.tool))
        begin_outline(controller, modifiers, x, y);
    else if (button == ISOSCULPT_BUTTON_LEFT && handle)
        controller->drag = handle == ISOSCULPT_CUT_TIP || modifiers & ISOSCULPT_MODIFIER_SHIFT
                               ? ISOSCULPT_DRAG_TILT
                               : ISOSCULPT_DRAG_PLANE;
    else if (!brush || !isosculpt_pick_buffer_pick(&controller->viewport->drawn, x, y, &pick))
        controller->drag = ISOSCULPT_DRAG_ORBIT;
    else if (modifiers & ISOSCULPT_MODIFIER_ALT && !controller->viewing_volume) {
        controller->drag = ISOSCULPT_DRAG_SELECT;
        controller->press_x = x;
        controller->press_y = y;
        controller->press_modifiers = modifiers;
    } else
        begin_drawing(controller, modifiers, x, y);
}

void isosculpt_controller_set_radius(isosculpt_controller *controller, double radius) {
    double voxel = controller->document->start.voxel_size;
    isosculpt_controller_brush(controller)->radius =
        fmin(fmax(radius, ISOSCULPT_RADIUS_LEAST * voxel), ISOSCULPT_RADIUS_MOST * voxel);
}

/* Changes the brush when the pointer has moved by dx pixels: its radius while X is held, its strength while C
 * is held. */
static void adjust_brush(isosculpt_controller *controller, double dx) {
    iso_brush *brush = isosculpt_controller_brush(controller);
    if (controller->adjusting == 'x')
        isosculpt_controller_set_radius(controller, brush->radius * pow(RADIUS_A_PIXEL, dx));
    else
        brush->strength = fmin(fmax(brush->strength + STRENGTH_A_PIXEL * dx, STRENGTH_MIN), 1);
}

/* A press with Alt is a stroke, which begins where the button was pressed, once the pointer has moved. */
static void begin_when_moved(isosculpt_controller *controller) {
    const double x = controller->press_x, y = controller->press_y;
    if (hypot(controller->x - x, controller->y - y) <= CLICK_PIXELS * controller->scale) return;
    controller->drag = ISOSCULPT_DRAG_NONE;
    begin_drawing(controller, controller->press_modifiers, x, y);
}

static void select_stroke(isosculpt_controller *controller) {
    isosculpt_pick pick;
    if (isosculpt_pick_buffer_pick(&controller->viewport->drawn, controller->press_x, controller->press_y,
                                   &pick))
        isosculpt_stroke_editor_seek(&controller->document->strokes, pick.position);
}

void isosculpt_controller_move(isosculpt_controller *controller, double x, double y) {
    double dx = x - controller->x, dy = y - controller->y;
    controller->x = x;
    controller->y = y;
    if (controller->adjusting && !controller->drag) adjust_brush(controller, dx);
    if (controller->drag == ISOSCULPT_DRAG_SELECT) begin_when_moved(controller);
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) continue_drawing(controller, x, y, false);
    if (controller->drag == ISOSCULPT_DRAG_OUTLINE) extend_outline(controller, x, y);
    if (controller->drag == ISOSCULPT_DRAG_HANDLE)
        isosculpt_bending_move(&controller->bending, &controller->viewport->drawn, x, y);
    if (controller->drag == ISOSCULPT_DRAG_ORBIT) isosculpt_viewport_orbit(controller->viewport, dx, dy);
    if (controller->drag == ISOSCULPT_DRAG_PAN) isosculpt_viewport_pan(controller->viewport, dx, dy);
    if (controller->drag == ISOSCULPT_DRAG_PLANE || controller->drag == ISOSCULPT_DRAG_TILT)
        drag_plane(controller, dx, dy);
    if (controller->drag) controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}

void isosculpt_controller_release(isosculpt_controller *controller, isosculpt_button button) {
    if (!controller->drag || button != controller->button) return;
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) {
        continue_drawing(controller, controller->x, controller->y, true);
        end_drawing(controller, false);
    }
    if (controller->drag == ISOSCULPT_DRAG_OUTLINE) end_outline(controller);
    if (controller->drag == ISOSCULPT_DRAG_HANDLE) isosculpt_bending_release(controller, false);
    if (controller->drag == ISOSCULPT_DRAG_SELECT) select_stroke(controller);
    controller->drag = ISOSCULPT_DRAG_NONE;
}

static void zoom_camera(isosculpt_controller *controller, double factor) {
    /* picks of the stroke, and the path, need the present camera */
    if (controller->drag == ISOSCULPT_DRAG_BRUSH || controller->drag == ISOSCULPT_DRAG_HANDLE) return;
    isosculpt_viewport_zoom(controller->viewport, factor);
    controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}

void isosculpt_controller_scroll(isosculpt_controller *controller, double steps) {
    zoom_camera(controller, pow(WHEEL_ZOOM, steps));
}

bool isosculpt_controller_is_drawing(const isosculpt_controller *controller) {
    return controller->drag == ISOSCULPT_DRAG_BRUSH || controller->drag == ISOSCULPT_DRAG_OUTLINE ||
           controller->drag == ISOSCULPT_DRAG_HANDLE;
}

bool isosculpt_controller_pick(isosculpt_controller *controller, isosculpt_pick *pick) {
    const bool brush = !controller->drag || controller->drag == ISOSCULPT_DRAG_BRUSH ||
                       controller->drag == ISOSCULPT_DRAG_SELECT;
    if (!brush || isosculpt_controller_handle(controller) ||
        isosculpt_controller_path_handle(controller) >= 0)
        return false;
    return isosculpt_pick_buffer_pick(&controller->viewport->drawn, controller->x, controller->y, pick);
}

/* ---- keys */

static void undo_or_redo(isosculpt_controller *controller, bool redo) {
    iso_edit_stats stats = {0};
    iso_session *session = controller->document->session;
    isosculpt_stroke_editor *editor = &controller->document->strokes;
    if (!redo && !controller->drag && (controller->field_pending || controller->queued_strokes.count)) {
        isosculpt_strokes_remove_last(&controller->queued_strokes);
        return;
    }
    if (controller->drag == ISOSCULPT_DRAG_BRUSH || (!redo && isosculpt_stroke_editor_withdraw(editor)))
        return;
    isosculpt_stroke_editor_stop(editor, session);
    const iso_history *history = iso_session_history(session);
    size_t position = iso_history_position(history);
    if (position == (redo ? iso_history_count(history) : 0)) return;
    if (!cancel_unfinished_stroke(controller)) return;
    iso_status status =
        redo ? iso_session_redo(session, &controller->error) : iso_session_undo(session, &controller->error);
    controller->document->change_count += status == ISO_OK;
    finish_edit(controller, status, &stats);
    controller->viewport->mask_changed |=
        controller->viewport->mask.at != NULL; /* the step may have changed it */
}

void isosculpt_controller_go_to_step(isosculpt_controller *controller, size_t position) {
    const iso_history *history = iso_session_history(controller->document->session);
    for (size_t now = iso_history_position(history), last = now + 1; now != position && now != last;) {
        last = now;
        undo_or_redo(controller, now < position);
        now = iso_history_position(history);
    }
}

/* Handles keys pressed together with Ctrl. */
static bool handle_command_key(isosculpt_controller *controller, int key, bool shift) {
    if (key == 's')
        controller->commands |= shift ? ISOSCULPT_COMMAND_SAVE_AS : ISOSCULPT_COMMAND_SAVE;
    else if (key == 'o')
        controller->commands |= ISOSCULPT_COMMAND_OPEN;
    else if (key == 'n')
        controller->commands |= ISOSCULPT_COMMAND_NEW;
    else if (key == 'q')
        controller->commands |= ISOSCULPT_COMMAND_CLOSE;
    else if (key == 'z' || key == 'y')
        undo_or_redo(controller, key == 'y' || shift);
    else if (key == 'i')
        isosculpt_controller_change_mask(controller, ISO_TOOL_INVERT_MASK);
    else
        return false;
    return true;
}

void isosculpt_controller_set_direction(isosculpt_controller *controller, iso_direction direction) {
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) return;
    isosculpt_viewport_set_direction(controller->viewport, direction);
    controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}

/* Handles 1, 3 and 7, on the number pad or with Shift or Ctrl; with Ctrl the view is from the opposite
 * side. */
static bool handle_side_key(isosculpt_controller *controller, int key, unsigned modifiers) {
    static const iso_direction sides[][2] = {
        {ISO_FRONT, ISO_BACK}, {ISO_RIGHT, ISO_LEFT}, {ISO_TOP, ISO_BOTTOM}};
    const bool opposite = modifiers & ISOSCULPT_MODIFIER_CTRL,
               digit = modifiers & (ISOSCULPT_MODIFIER_SHIFT | ISOSCULPT_MODIFIER_CTRL);
    int side = -1;
    if (key == ISOSCULPT_KEY_FRONT || (key == '1' && digit)) side = 0;
    if (key == ISOSCULPT_KEY_RIGHT || (key == '3' && digit)) side = 1;
    if (key == ISOSCULPT_KEY_TOP || (key == '7' && digit)) side = 2;
    if (side >= 0) isosculpt_controller_set_direction(controller, sides[side][opposite]);
    return side >= 0;
}

static void focus_camera(isosculpt_controller *controller, bool on_cursor) {
    isosculpt_pick pick;
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) return;
    if (!on_cursor)
        isosculpt_viewport_focus(controller->viewport, NULL);
    else if (isosculpt_controller_pick(controller, &pick))
        isosculpt_viewport_focus(controller->viewport, &pick.position);
    controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}

static void pan_camera(isosculpt_controller *controller, int key) {
    const double step = KEY_PAN * controller->viewport->height;
    const int x = (key == ISOSCULPT_KEY_ARROW_RIGHT) - (key == ISOSCULPT_KEY_ARROW_LEFT),
              y = (key == ISOSCULPT_KEY_ARROW_DOWN) - (key == ISOSCULPT_KEY_ARROW_UP);
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) return;
    isosculpt_viewport_pan(controller->viewport, step * x, step * y);
    controller->commands |= ISOSCULPT_COMMAND_REDRAW;
}

static bool handle_camera_key(isosculpt_controller *controller, int key, unsigned modifiers) {
    if (key == 'f')
        focus_camera(controller, modifiers & ISOSCULPT_MODIFIER_SHIFT);
    else if (key == '+' || key == '=')
        zoom_camera(controller, KEY_ZOOM);
    else if (key == '-')
        zoom_camera(controller, 1 / KEY_ZOOM);
    else if (key >= ISOSCULPT_KEY_ARROW_LEFT && key <= ISOSCULPT_KEY_ARROW_DOWN)
        pan_camera(controller, key);
    else
        return handle_side_key(controller, key, modifiers);
    return true;
}

/* Chooses the brush of a key. While a volume is viewed, this also converts the volume into a field. Returns
 * whether the key is that of a brush. */
static bool choose_tool(isosculpt_controller *controller, int key) {
    int number = 0;
    while (number < ISOSCULPT_TOOLS && tools[number].key != key) number++;
    if (number == ISOSCULPT_TOOLS) return false;
    controller->brush.tool = tools[number].tool;
    controller->measuring.on = false;
    isosculpt_stroke_editor_select(&controller->document->strokes, 0, 0);
    if (!controller->viewing_volume) return true;
    controller->commands |= ISOSCULPT_COMMAND_SCULPT;
    if (controller->field_pending) return true;
    /* set at once: a slow program receives the next strokes before it processes commands */
    controller->field_pending = true;
    isosculpt_controller_center_mirror(controller);
    return true;
}

static bool handle_brush_key(isosculpt_controller *controller, int key, unsigned modifiers) {
    if (key == 'm' && modifiers & ISOSCULPT_MODIFIER_ALT)
        isosculpt_controller_change_mask(controller, ISO_TOOL_CLEAR_MASK);
    else if (key == '[' || key == ']' || key == ',' || key == '.')
        isosculpt_controller_set_radius(controller,
                                        key == ']' || key == '.'
                                            ? isosculpt_controller_brush(controller)->radius * RADIUS_STEP
                                            : isosculpt_controller_brush(controller)->radius / RADIUS_STEP);
    else if (key == 'x' || key == 'c')
        controller->adjusting = (char)key;
    else if (key == 'e')
        isosculpt_controller_pick_color(controller);
    else if (key == 'd' && !controller->viewing_volume)
        controller->measuring.on = !controller->measuring.on;
    else if (key == ISOSCULPT_KEY_DELETE)
        isosculpt_stroke_editor_request_all(&controller->document->strokes, ISO_EVENT_DELETE,
                                            &controller->error);
    else if (key == ISOSCULPT_KEY_ESCAPE && controller->drag == ISOSCULPT_DRAG_BRUSH)
        end_drawing(controller, true);
    else if (key == ISOSCULPT_KEY_ESCAPE && controller->drag == ISOSCULPT_DRAG_OUTLINE)
        controller->drag = ISOSCULPT_DRAG_NONE;
    else if (key == ISOSCULPT_KEY_ESCAPE && controller->drag == ISOSCULPT_DRAG_HANDLE)
        isosculpt_bending_release(controller, true);
    else
        return choose_tool(controller, key);
    return true;
}

bool isosculpt_controller_key(isosculpt_controller *controller, int key, unsigned modifiers, bool down) {
    if (!down) {
        if (key == controller->adjusting) controller->adjusting = 0;
        return false;
    }
    if (handle_camera_key(controller, key, modifiers)) return true;
    if (modifiers & ISOSCULPT_MODIFIER_CTRL)
        return handle_command_key(controller, key, modifiers & ISOSCULPT_MODIFIER_SHIFT);
    return handle_brush_key(controller, key, modifiers);
}
