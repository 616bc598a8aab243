#include "apps/isosculpt/controller.h"

#include <math.h>

#include "base/clock.h"
#include "sculpt/brush/dab.h"

/* A wheel's step, a size key's step, a pixel of dragging with X or C. */
static const double WHEEL = 1.1, SIZE = 1.15, SIZE_A_PIXEL = 1.01, STRENGTH_A_PIXEL = 0.005;
/* Radii in voxels; strengths. */
static const double RADIUS_MIN = 2, RADIUS_MAX = 256, STRENGTH_MIN = 0.02;
/* A key's zoom; its pan, in parts of the picture's height. */
static const double KEY_ZOOM = 1.25, KEY_PAN = 0.1;
/* Radii from one stamp of a stroke to the next. */
static const double STAMP_SPACING = 1;

iso_tool isosculpt_controller_tool(int number) {
    static const iso_tool tools[ISOSCULPT_TOOLS] = {ISO_TOOL_ADD,    ISO_TOOL_CARVE,   ISO_TOOL_BLEND_ADD,
                                                    ISO_TOOL_SMOOTH, ISO_TOOL_INFLATE, ISO_TOOL_FLATTEN,
                                                    ISO_TOOL_PINCH,  ISO_TOOL_MOVE,    ISO_TOOL_MASK};
    return tools[number - 1];
}

iso_tool isosculpt_controller_modified_tool(iso_tool tool, unsigned modifiers) {
    static const iso_tool pairs[][2] = {{ISO_TOOL_ADD, ISO_TOOL_CARVE},
                                        {ISO_TOOL_BLEND_ADD, ISO_TOOL_BLEND_CARVE},
                                        {ISO_TOOL_INFLATE, ISO_TOOL_DEFLATE},
                                        {ISO_TOOL_MASK, ISO_TOOL_UNMASK}};
    if (modifiers & ISOSCULPT_SHIFT) return ISO_TOOL_SMOOTH;
    if (!(modifiers & (ISOSCULPT_CTRL | ISOSCULPT_ALT))) return tool;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        for (int side = 0; side < 2; side++)
            if (tool == pairs[i][side]) return pairs[i][1 - side];
    return tool;
}

static bool mask_at(const void *session, int x, int y, int z) {
    return iso_session_masked(session, x, y, z);
}

/* The picture shows what is frozen. */
static void show_mask(isosculpt_controller *controller) {
    const iso_session *session = controller->document->session;
    bool any = iso_session_has_mask(session),
         masks = controller->tool == ISO_TOOL_MASK || controller->tool == ISO_TOOL_UNMASK;
    controller->view->repaint |= any != (controller->view->mask.at != NULL) || masks;
    controller->view->mask = any ? (isosculpt_mask){mask_at, session} : (isosculpt_mask){NULL, NULL};
}

void isosculpt_controller_init(isosculpt_controller *controller, isosculpt_document *document,
                               isosculpt_view *view) {
    *controller = (isosculpt_controller){.document = document, .view = view, .x = -1, .y = -1, .pressure = 1};
    controller->brush = (iso_brush){.tool = ISO_TOOL_ADD,
                                    .radius = 16 * document->start.voxel_size,
                                    .strength = 0.5,
                                    .pressure_radius = true};
    isosculpt_controller_center_mirror(controller);
    show_mask(controller);
}

void isosculpt_controller_free(isosculpt_controller *controller) {
    isosculpt_strokes_free(&controller->waiting);
}

void isosculpt_controller_center_mirror(isosculpt_controller *controller) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&controller->view->grid));
    controller->box = isosculpt_view_bounds(controller->view);
    iso_vec3 middle = iso_vec3_scale(iso_vec3_add(controller->box.lo, controller->box.hi), 0.5);
    iso_vec3 at = iso_affine_point_to_index(&affine, middle);
    at = iso_vec3_make(0.5 * round(2 * at.x), 0.5 * round(2 * at.y), 0.5 * round(2 * at.z));
    controller->brush.mirror = iso_affine_point(&affine, at);
}

/* ---- strokes */

bool isosculpt_tool_has_shape(iso_tool tool) {
    return iso_tool_is_set_operation(tool);
}

/* A solid goes in by as much of its radius as the strength says: its centre lies below the surface when it
 * adds, above it when it carves. */
static iso_vec3 centre(const isosculpt_controller *controller, iso_vec3 position, iso_vec3 normal) {
    if (!isosculpt_tool_has_shape(controller->tool)) return position;
    const double radius = controller->brush.radius *
                          (controller->brush.pressure_radius ? controller->pressure : 1),
                 strength = controller->brush.strength *
                            (controller->brush.pressure_strength ? controller->pressure : 1);
    double away = (1 - strength) * radius;
    bool adds = controller->tool == ISO_TOOL_ADD || controller->tool == ISO_TOOL_BLEND_ADD;
    return iso_vec3_add(position, iso_vec3_scale(normal, adds ? -away : away));
}

/* Strokes stay on the surface as it was when they began, and what is dragged at the depth where it was
 * seized: a stroke does not climb what it has just added. */
static iso_sample sample_at(isosculpt_controller *controller, double x, double y) {
    isosculpt_pick pick;
    const isosculpt_layer *layer = &controller->view->pick_layer;
    bool seized = controller->tool == ISO_TOOL_MOVE && controller->drag == ISOSCULPT_DRAG_BRUSH;
    if (!seized && isosculpt_layer_pick(layer, x, y, &pick)) {
        controller->depth = pick.depth;
        controller->normal = pick.normal;
    }
    iso_vec3 position = isosculpt_layer_point(layer, x, y, controller->depth);
    return (iso_sample){.position = centre(controller, position, controller->normal),
                        .normal = controller->normal,
                        .pressure = controller->pressure,
                        .seconds = iso_clock_seconds() - controller->document->began};
}

static void done(isosculpt_controller *controller, iso_status status, const iso_edit_stats *stats) {
    controller->clipped |= stats->clipped;
    controller->commands |= ISOSCULPT_COMMAND_PICTURE;
    show_mask(controller);
    if (status == ISO_OK)
        controller->error.text[0] = 0;
    else if (!controller->error.text[0])
        iso_fail(&controller->error, status, "%s", iso_status_text(status));
}

/* What could neither be ended nor taken back for want of memory is taken back before anything else. */
static bool is_over(isosculpt_controller *controller) {
    iso_error reason = {0};
    if (controller->stroke_unfinished)
        controller->stroke_unfinished =
            iso_session_cancel(controller->document->session, &reason) == ISO_ERR_NOMEM;
    if (controller->stroke_unfinished && !controller->error.text[0]) controller->error = reason;
    return !controller->stroke_unfinished;
}

/* The brush of a stroke with the hand's tool. */
static iso_brush stroke_brush(const isosculpt_controller *controller) {
    iso_brush brush = controller->brush;
    brush.tool = controller->tool;
    bool tube = controller->tool == ISO_TOOL_ADD || controller->tool == ISO_TOOL_CARVE;
    if (tube && brush.shape == ISO_SOLID_SPHERE)
        brush.shape = ISO_SOLID_CAPSULE; /* without ridges between touches */
    if (brush.shape == ISO_SOLID_STAMP) brush.spacing = STAMP_SPACING;
    return brush;
}

static iso_status begin_stroke(isosculpt_controller *controller, const iso_brush *brush,
                               const iso_sample *sample, iso_edit_stats *stats) {
    if (controller->viewing_volume)
        return isosculpt_strokes_begin(&controller->waiting, brush, sample, &controller->error);
    double start = iso_clock_seconds();
    iso_status status =
        iso_session_begin(controller->document->session, brush, sample, stats, &controller->error);
    isosculpt_latency_add(&controller->edit, iso_clock_seconds() - start);
    controller->document->changes += status == ISO_OK;
    return status;
}

static void begin(isosculpt_controller *controller, unsigned modifiers, double x, double y) {
    iso_edit_stats stats = {0};
    if (!is_over(controller)) return;
    controller->tool = isosculpt_controller_modified_tool(controller->brush.tool, modifiers);
    const iso_brush brush = stroke_brush(controller);
    if (isosculpt_view_keep_pick_layer(controller->view, &controller->error) != ISO_OK) return;
    iso_sample sample = sample_at(controller, x, y);
    iso_status status = begin_stroke(controller, &brush, &sample, &stats);
    if (status == ISO_OK) {
        controller->drag = ISOSCULPT_DRAG_BRUSH;
        controller->last = sample;
    }
    done(controller, status, &stats);
}

/* Tools that touch at every sample get one only when the hand has moved by so much; the session spaces the
 * touches of others. */
static double least_move(const isosculpt_controller *controller) {
    if (controller->tool == ISO_TOOL_ADD || controller->tool == ISO_TOOL_CARVE)
        return 0.15 * controller->brush.radius;
    return controller->tool == ISO_TOOL_MOVE ? controller->document->start.voxel_size : 0;
}

static void go_on(isosculpt_controller *controller, double x, double y, bool last) {
    iso_edit_stats stats = {0};
    iso_sample sample = sample_at(controller, x, y);
    double moved = iso_vec3_length(iso_vec3_sub(sample.position, controller->last.position));
    if (moved <= (last ? 0 : least_move(controller))) return;
    controller->last = sample;
    double start = iso_clock_seconds();
    iso_status status =
        controller->viewing_volume
            ? isosculpt_strokes_add(&controller->waiting, &sample, &controller->error)
            : iso_session_sample(controller->document->session, &sample, &stats, &controller->error);
    isosculpt_latency_add(&controller->edit, iso_clock_seconds() - start);
    done(controller, status, &stats);
}

static void end_waiting(isosculpt_controller *controller, bool cancel) {
    controller->drag = ISOSCULPT_DRAG_NONE;
    if (cancel) isosculpt_strokes_drop_last(&controller->waiting);
}

/* A stroke that cannot be ended is taken back: it would be in the way of all that follows. */
static void end(isosculpt_controller *controller, bool cancel) {
    iso_edit_stats stats = {0};
    if (controller->viewing_volume) {
        end_waiting(controller, cancel);
        return;
    }
    iso_session *session = controller->document->session;
    controller->drag = ISOSCULPT_DRAG_NONE;
    const iso_status status = cancel ? iso_session_cancel(session, &controller->error)
                                     : iso_session_end(session, &controller->error);
    controller->stroke_unfinished = status != ISO_OK;
    is_over(controller);
    if (controller->brush.symmetry) controller->box = isosculpt_view_bounds(controller->view);
    done(controller, status, &stats);
}

static iso_status play(isosculpt_controller *controller, const isosculpt_stroke *stroke,
                       iso_edit_stats *stats) {
    iso_session *session = controller->document->session;
    iso_status status =
        iso_session_begin(session, &stroke->brush, &stroke->samples[0], stats, &controller->error);
    if (status != ISO_OK) return status;
    controller->document->changes++;
    for (size_t i = 1; i < stroke->count && status == ISO_OK; i++)
        status = iso_session_sample(session, &stroke->samples[i], stats, &controller->error);
    const iso_status ended = iso_session_end(session, &controller->error);
    return status == ISO_OK ? ended : status;
}

void isosculpt_controller_play(isosculpt_controller *controller, isosculpt_strokes *strokes) {
    iso_edit_stats stats = {0};
    iso_status status = ISO_OK;
    for (size_t i = 0; i < strokes->count && status == ISO_OK; i++)
        status = play(controller, &strokes->strokes[i], &stats);
    isosculpt_strokes_free(strokes);
    done(controller, status, &stats);
}

void isosculpt_controller_set_stamp(isosculpt_controller *controller, iso_stamp *stamp) {
    iso_edit_stats stats = {0};
    iso_status status = iso_session_set_stamp(controller->document->session, stamp, &controller->error);
    done(controller, status, &stats);
    if (status != ISO_OK) return;
    controller->document->kept = true;
    controller->brush.shape = ISO_SOLID_STAMP;
    if (!isosculpt_tool_has_shape(controller->brush.tool)) controller->brush.tool = ISO_TOOL_ADD;
}

/* ---- the mouse */

void isosculpt_controller_press(isosculpt_controller *controller, isosculpt_button button, unsigned modifiers,
                                double x, double y) {
    isosculpt_pick pick;
    if (controller->drag) return;
    controller->x = x;
    controller->y = y;
    controller->button = button;
    const bool brush = button == ISOSCULPT_LEFT && (!controller->viewing_volume || controller->awaiting);
    if (button == ISOSCULPT_RIGHT)
        controller->drag = ISOSCULPT_DRAG_PAN;
    else if (brush && isosculpt_layer_pick(&controller->view->drawn, x, y, &pick))
        begin(controller, modifiers, x, y);
    else
        controller->drag = ISOSCULPT_DRAG_ORBIT;
}

static void set_radius(isosculpt_controller *controller, double radius) {
    double voxel = controller->document->start.voxel_size;
    controller->brush.radius = fmin(fmax(radius, RADIUS_MIN * voxel), RADIUS_MAX * voxel);
}

static void adjust(isosculpt_controller *controller, double dx) {
    if (controller->adjusting == 'x')
        set_radius(controller, controller->brush.radius * pow(SIZE_A_PIXEL, dx));
    else
        controller->brush.strength =
            fmin(fmax(controller->brush.strength + STRENGTH_A_PIXEL * dx, STRENGTH_MIN), 1);
}

void isosculpt_controller_move(isosculpt_controller *controller, double x, double y) {
    double dx = x - controller->x, dy = y - controller->y;
    controller->x = x;
    controller->y = y;
    if (controller->adjusting && !controller->drag) adjust(controller, dx);
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) go_on(controller, x, y, false);
    if (controller->drag == ISOSCULPT_DRAG_ORBIT) isosculpt_view_orbit(controller->view, dx, dy);
    if (controller->drag == ISOSCULPT_DRAG_PAN) isosculpt_view_pan(controller->view, dx, dy);
    if (controller->drag) controller->commands |= ISOSCULPT_COMMAND_PICTURE;
}

void isosculpt_controller_release(isosculpt_controller *controller, isosculpt_button button) {
    if (!controller->drag || button != controller->button) return;
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) {
        go_on(controller, controller->x, controller->y, true);
        end(controller, false);
    }
    controller->drag = ISOSCULPT_DRAG_NONE;
}

static void zoom(isosculpt_controller *controller, double factor) {
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) return; /* the stroke's picks are of this camera */
    isosculpt_view_zoom(controller->view, factor);
    controller->commands |= ISOSCULPT_COMMAND_PICTURE;
}

void isosculpt_controller_scroll(isosculpt_controller *controller, double steps) {
    zoom(controller, pow(WHEEL, steps));
}

bool isosculpt_controller_pick(const isosculpt_controller *controller, isosculpt_pick *pick) {
    if (controller->drag == ISOSCULPT_DRAG_ORBIT || controller->drag == ISOSCULPT_DRAG_PAN) return false;
    return isosculpt_layer_pick(&controller->view->drawn, controller->x, controller->y, pick);
}

/* ---- keys */

static void step(isosculpt_controller *controller, bool redo) {
    iso_edit_stats stats = {0};
    iso_session *session = controller->document->session;
    if (controller->awaiting && !redo && !controller->drag) {
        isosculpt_strokes_drop_last(&controller->waiting);
        return;
    }
    const iso_history *history = iso_session_history(session);
    size_t position = iso_history_position(history);
    if (controller->drag == ISOSCULPT_DRAG_BRUSH || position == (redo ? iso_history_count(history) : 0))
        return;
    if (!is_over(controller)) return;
    iso_status status =
        redo ? iso_session_redo(session, &controller->error) : iso_session_undo(session, &controller->error);
    controller->document->changes += status == ISO_OK;
    done(controller, status, &stats);
    controller->view->repaint |= controller->view->mask.at != NULL; /* the step may be one of masking */
}

void isosculpt_controller_go_to_step(isosculpt_controller *controller, size_t position) {
    const iso_history *history = iso_session_history(controller->document->session);
    for (size_t now = iso_history_position(history), last = now + 1; now != position && now != last;) {
        last = now;
        step(controller, now < position);
        now = iso_history_position(history);
    }
}

static bool command(isosculpt_controller *controller, int key, bool shift) {
    if (key == 's')
        controller->commands |= shift ? ISOSCULPT_COMMAND_SAVE_AS : ISOSCULPT_COMMAND_SAVE;
    else if (key == 'o')
        controller->commands |= ISOSCULPT_COMMAND_OPEN;
    else if (key == 'q')
        controller->commands |= ISOSCULPT_COMMAND_CLOSE;
    else if (key == 'z' || key == 'y')
        step(controller, key == 'y' || shift);
    else
        return false;
    return true;
}

void isosculpt_controller_look(isosculpt_controller *controller, iso_direction direction) {
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) return;
    isosculpt_view_set_direction(controller->view, direction);
    controller->commands |= ISOSCULPT_COMMAND_PICTURE;
}

/* 1, 3 and 7, of the number pad or with Shift or Ctrl; Ctrl: the opposite side. */
static bool mode(isosculpt_controller *controller, int key, unsigned modifiers) {
    static const iso_direction sides[][2] = {
        {ISO_FRONT, ISO_BACK}, {ISO_RIGHT, ISO_LEFT}, {ISO_TOP, ISO_BOTTOM}};
    const bool opposite = modifiers & ISOSCULPT_CTRL, digit = modifiers & (ISOSCULPT_SHIFT | ISOSCULPT_CTRL);
    int side = -1;
    if (key == ISOSCULPT_KEY_FRONT || (key == '1' && digit)) side = 0;
    if (key == ISOSCULPT_KEY_RIGHT || (key == '3' && digit)) side = 1;
    if (key == ISOSCULPT_KEY_TOP || (key == '7' && digit)) side = 2;
    if (side >= 0) isosculpt_controller_look(controller, sides[side][opposite]);
    return side >= 0;
}

static void focus(isosculpt_controller *controller, bool on_cursor) {
    isosculpt_pick pick;
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) return;
    if (!on_cursor)
        isosculpt_view_focus(controller->view, NULL);
    else if (isosculpt_controller_pick(controller, &pick))
        isosculpt_view_focus(controller->view, &pick.position);
    controller->commands |= ISOSCULPT_COMMAND_PICTURE;
}

static void pan(isosculpt_controller *controller, int key) {
    const double step = KEY_PAN * controller->view->height;
    const int x = (key == ISOSCULPT_KEY_ARROW_RIGHT) - (key == ISOSCULPT_KEY_ARROW_LEFT),
              y = (key == ISOSCULPT_KEY_ARROW_DOWN) - (key == ISOSCULPT_KEY_ARROW_UP);
    if (controller->drag == ISOSCULPT_DRAG_BRUSH) return;
    isosculpt_view_pan(controller->view, step * x, step * y);
    controller->commands |= ISOSCULPT_COMMAND_PICTURE;
}

static bool move_camera(isosculpt_controller *controller, int key, unsigned modifiers) {
    if (key == 'f')
        focus(controller, modifiers & ISOSCULPT_SHIFT);
    else if (key == '+' || key == '=')
        zoom(controller, KEY_ZOOM);
    else if (key == '-')
        zoom(controller, 1 / KEY_ZOOM);
    else if (key >= ISOSCULPT_KEY_ARROW_LEFT && key <= ISOSCULPT_KEY_ARROW_DOWN)
        pan(controller, key);
    else
        return mode(controller, key, modifiers);
    return true;
}

/* A brush that is picked for a volume is one to sculpt it with. */
static void pick_brush(isosculpt_controller *controller, int number) {
    controller->brush.tool = isosculpt_controller_tool(number);
    if (controller->viewing_volume) controller->commands |= ISOSCULPT_COMMAND_SCULPT;
}

static bool set_brush(isosculpt_controller *controller, int key) {
    if (key >= '1' && key <= '9')
        pick_brush(controller, key - '0');
    else if (key == '[' || key == ']' || key == ',' || key == '.')
        set_radius(controller, key == ']' || key == '.' ? controller->brush.radius * SIZE
                                                        : controller->brush.radius / SIZE);
    else if (key == 'x' || key == 'c')
        controller->adjusting = (char)key;
    else if (key == ISOSCULPT_KEY_ESCAPE && controller->drag == ISOSCULPT_DRAG_BRUSH)
        end(controller, true);
    else
        return false;
    return true;
}

bool isosculpt_controller_key(isosculpt_controller *controller, int key, unsigned modifiers, bool down) {
    if (!down) {
        if (key == controller->adjusting) controller->adjusting = 0;
        return false;
    }
    if (move_camera(controller, key, modifiers)) return true;
    if (modifiers & ISOSCULPT_CTRL) return command(controller, key, modifiers & ISOSCULPT_SHIFT);
    return set_brush(controller, key);
}
