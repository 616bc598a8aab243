#include "apps/isosculpt/hand.h"

#include <math.h>

/* A wheel's step, a size key's step, a pixel of dragging with X or C. */
static const double WHEEL = 1.1, SIZE = 1.15, SIZE_A_PIXEL = 1.01, STRENGTH_A_PIXEL = 0.005;
/* Radii in voxels; strengths. */
static const double RADIUS_MIN = 2, RADIUS_MAX = 256, STRENGTH_MIN = 0.02;
/* A key's zoom; its pan, in parts of the picture's height. */
static const double KEY_ZOOM = 1.25, KEY_PAN = 0.1;
/* Radii from one stamp of a stroke to the next. */
static const double STAMP_SPACING = 1;

iso_tool isosculpt_hand_tool(int number) {
    static const iso_tool tools[ISOSCULPT_TOOLS] = {ISO_TOOL_ADD,    ISO_TOOL_CARVE,   ISO_TOOL_BLEND_ADD,
                                                    ISO_TOOL_SMOOTH, ISO_TOOL_INFLATE, ISO_TOOL_FLATTEN,
                                                    ISO_TOOL_PINCH,  ISO_TOOL_MOVE,    ISO_TOOL_MASK};
    return tools[number - 1];
}

iso_tool isosculpt_hand_modified(iso_tool tool, unsigned modifiers) {
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
static void show_mask(isosculpt_hand *hand) {
    const iso_session *session = hand->desk->session;
    bool any = iso_session_has_mask(session),
         masks = hand->tool == ISO_TOOL_MASK || hand->tool == ISO_TOOL_UNMASK;
    hand->view->repaint |= any != (hand->view->mask.at != NULL) || masks;
    hand->view->mask = any ? (isosculpt_mask){mask_at, session} : (isosculpt_mask){NULL, NULL};
}

void isosculpt_hand_init(isosculpt_hand *hand, isosculpt_desk *desk, isosculpt_view *view) {
    *hand = (isosculpt_hand){.desk = desk, .view = view, .x = -1, .y = -1, .pressure = 1};
    hand->brush = (iso_brush){.tool = ISO_TOOL_ADD,
                              .radius = 16 * desk->start.voxel_size,
                              .strength = 0.5,
                              .pressure_radius = true};
    isosculpt_hand_center_mirror(hand);
    show_mask(hand);
}

void isosculpt_hand_free(isosculpt_hand *hand) {
    isosculpt_strokes_free(&hand->waiting);
}

void isosculpt_hand_center_mirror(isosculpt_hand *hand) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&hand->view->grid));
    hand->box = isosculpt_view_bounds(hand->view);
    iso_vec3 middle = iso_vec3_scale(iso_vec3_add(hand->box.lo, hand->box.hi), 0.5);
    iso_vec3 at = iso_affine_point_to_index(&affine, middle);
    at = iso_vec3_make(0.5 * round(2 * at.x), 0.5 * round(2 * at.y), 0.5 * round(2 * at.z));
    hand->brush.mirror = iso_affine_point(&affine, at);
}

/* ---- strokes */

bool isosculpt_hand_has_shape(iso_tool tool) {
    return tool <= ISO_TOOL_BLEND_CARVE;
}

/* A solid goes in by as much of its radius as the strength says: its centre lies below the surface when it
 * adds, above it when it carves. */
static iso_vec3 centre(const isosculpt_hand *hand, iso_vec3 position, iso_vec3 normal) {
    if (!isosculpt_hand_has_shape(hand->tool)) return position;
    const double radius = hand->brush.radius * (hand->brush.pressure_radius ? hand->pressure : 1),
                 strength = hand->brush.strength * (hand->brush.pressure_strength ? hand->pressure : 1);
    double away = (1 - strength) * radius;
    bool adds = hand->tool == ISO_TOOL_ADD || hand->tool == ISO_TOOL_BLEND_ADD;
    return iso_vec3_add(position, iso_vec3_scale(normal, adds ? -away : away));
}

/* Strokes stay on the surface as it was when they began, and what is dragged at the depth where it was
 * seized: a stroke does not climb what it has just added. */
static iso_sample sample_at(isosculpt_hand *hand, double x, double y) {
    isosculpt_pick pick;
    const isosculpt_layer *layer = &hand->view->held;
    bool seized = hand->tool == ISO_TOOL_MOVE && hand->drag == ISOSCULPT_DRAG_BRUSH;
    if (!seized && isosculpt_layer_pick(layer, x, y, &pick)) {
        hand->depth = pick.depth;
        hand->normal = pick.normal;
    }
    iso_vec3 position = isosculpt_layer_point(layer, x, y, hand->depth);
    return (iso_sample){.position = centre(hand, position, hand->normal),
                        .normal = hand->normal,
                        .pressure = hand->pressure,
                        .seconds = isosculpt_now() - hand->desk->began};
}

static void done(isosculpt_hand *hand, iso_status status, const iso_edit_stats *stats) {
    hand->clipped |= stats->clipped;
    hand->wishes |= ISOSCULPT_WISH_PICTURE;
    show_mask(hand);
    if (status == ISO_OK)
        hand->error.text[0] = 0;
    else if (!hand->error.text[0])
        iso_fail(&hand->error, status, "%s", iso_status_text(status));
}

/* What could neither be ended nor taken back for want of memory is taken back before anything else. */
static bool is_over(isosculpt_hand *hand) {
    iso_error reason = {0};
    if (hand->unended) hand->unended = iso_session_cancel(hand->desk->session, &reason) == ISO_ERR_NOMEM;
    if (hand->unended && !hand->error.text[0]) hand->error = reason;
    return !hand->unended;
}

/* The brush of a stroke with the hand's tool. */
static iso_brush stroke_brush(const isosculpt_hand *hand) {
    iso_brush brush = hand->brush;
    brush.tool = hand->tool;
    bool tube = hand->tool == ISO_TOOL_ADD || hand->tool == ISO_TOOL_CARVE;
    if (tube && brush.shape == ISO_SOLID_SPHERE)
        brush.shape = ISO_SOLID_CAPSULE; /* without ridges between touches */
    if (brush.shape == ISO_SOLID_STAMP) brush.spacing = STAMP_SPACING;
    return brush;
}

static iso_status begin_stroke(isosculpt_hand *hand, const iso_brush *brush, const iso_sample *sample,
                               iso_edit_stats *stats) {
    if (hand->looking) return isosculpt_strokes_begin(&hand->waiting, brush, sample, &hand->error);
    double start = isosculpt_now();
    iso_status status = iso_session_begin(hand->desk->session, brush, sample, stats, &hand->error);
    isosculpt_latency_add(&hand->edit, isosculpt_now() - start);
    hand->desk->changes += status == ISO_OK;
    return status;
}

static void begin(isosculpt_hand *hand, unsigned modifiers, double x, double y) {
    iso_edit_stats stats = {0};
    if (!is_over(hand)) return;
    hand->tool = isosculpt_hand_modified(hand->brush.tool, modifiers);
    const iso_brush brush = stroke_brush(hand);
    if (isosculpt_view_hold(hand->view, &hand->error) != ISO_OK) return;
    iso_sample sample = sample_at(hand, x, y);
    iso_status status = begin_stroke(hand, &brush, &sample, &stats);
    if (status == ISO_OK) {
        hand->drag = ISOSCULPT_DRAG_BRUSH;
        hand->last = sample;
    }
    done(hand, status, &stats);
}

/* Tools that touch at every sample get one only when the hand has moved by so much; the session spaces the
 * touches of others. */
static double least_move(const isosculpt_hand *hand) {
    if (hand->tool == ISO_TOOL_ADD || hand->tool == ISO_TOOL_CARVE) return 0.15 * hand->brush.radius;
    return hand->tool == ISO_TOOL_MOVE ? hand->desk->start.voxel_size : 0;
}

static void go_on(isosculpt_hand *hand, double x, double y, bool last) {
    iso_edit_stats stats = {0};
    iso_sample sample = sample_at(hand, x, y);
    double moved = iso_vec3_length(iso_vec3_sub(sample.position, hand->last.position));
    if (moved <= (last ? 0 : least_move(hand))) return;
    hand->last = sample;
    double start = isosculpt_now();
    iso_status status = hand->looking
                            ? isosculpt_strokes_add(&hand->waiting, &sample, &hand->error)
                            : iso_session_sample(hand->desk->session, &sample, &stats, &hand->error);
    isosculpt_latency_add(&hand->edit, isosculpt_now() - start);
    done(hand, status, &stats);
}

static void end_waiting(isosculpt_hand *hand, bool cancel) {
    hand->drag = ISOSCULPT_DRAG_NONE;
    if (cancel) isosculpt_strokes_drop_last(&hand->waiting);
}

/* A stroke that cannot be ended is taken back: it would be in the way of all that follows. */
static void end(isosculpt_hand *hand, bool cancel) {
    iso_edit_stats stats = {0};
    if (hand->looking) {
        end_waiting(hand, cancel);
        return;
    }
    iso_session *session = hand->desk->session;
    hand->drag = ISOSCULPT_DRAG_NONE;
    const iso_status status =
        cancel ? iso_session_cancel(session, &hand->error) : iso_session_end(session, &hand->error);
    hand->unended = status != ISO_OK;
    is_over(hand);
    if (hand->brush.symmetry) hand->box = isosculpt_view_bounds(hand->view);
    done(hand, status, &stats);
}

static iso_status play(isosculpt_hand *hand, const isosculpt_stroke *stroke, iso_edit_stats *stats) {
    iso_session *session = hand->desk->session;
    iso_status status = iso_session_begin(session, &stroke->brush, &stroke->samples[0], stats, &hand->error);
    if (status != ISO_OK) return status;
    hand->desk->changes++;
    for (size_t i = 1; i < stroke->count && status == ISO_OK; i++)
        status = iso_session_sample(session, &stroke->samples[i], stats, &hand->error);
    const iso_status ended = iso_session_end(session, &hand->error);
    return status == ISO_OK ? ended : status;
}

void isosculpt_hand_play(isosculpt_hand *hand, isosculpt_strokes *strokes) {
    iso_edit_stats stats = {0};
    iso_status status = ISO_OK;
    for (size_t i = 0; i < strokes->count && status == ISO_OK; i++)
        status = play(hand, &strokes->strokes[i], &stats);
    isosculpt_strokes_free(strokes);
    done(hand, status, &stats);
}

void isosculpt_hand_stamp(isosculpt_hand *hand, iso_stamp *stamp) {
    iso_edit_stats stats = {0};
    iso_status status = iso_session_set_stamp(hand->desk->session, stamp, &hand->error);
    done(hand, status, &stats);
    if (status != ISO_OK) return;
    hand->desk->kept = true;
    hand->brush.shape = ISO_SOLID_STAMP;
    if (!isosculpt_hand_has_shape(hand->brush.tool)) hand->brush.tool = ISO_TOOL_ADD;
}

/* ---- the mouse */

void isosculpt_hand_press(isosculpt_hand *hand, isosculpt_button button, unsigned modifiers, double x,
                          double y) {
    isosculpt_pick pick;
    if (hand->drag) return;
    hand->x = x;
    hand->y = y;
    hand->button = button;
    const bool brush = button == ISOSCULPT_LEFT && (!hand->looking || hand->awaiting);
    if (button == ISOSCULPT_RIGHT)
        hand->drag = ISOSCULPT_DRAG_PAN;
    else if (brush && isosculpt_layer_pick(&hand->view->drawn, x, y, &pick))
        begin(hand, modifiers, x, y);
    else
        hand->drag = ISOSCULPT_DRAG_ORBIT;
}

static void set_radius(isosculpt_hand *hand, double radius) {
    double voxel = hand->desk->start.voxel_size;
    hand->brush.radius = fmin(fmax(radius, RADIUS_MIN * voxel), RADIUS_MAX * voxel);
}

static void adjust(isosculpt_hand *hand, double dx) {
    if (hand->adjusting == 'x')
        set_radius(hand, hand->brush.radius * pow(SIZE_A_PIXEL, dx));
    else
        hand->brush.strength = fmin(fmax(hand->brush.strength + STRENGTH_A_PIXEL * dx, STRENGTH_MIN), 1);
}

void isosculpt_hand_move(isosculpt_hand *hand, double x, double y) {
    double dx = x - hand->x, dy = y - hand->y;
    hand->x = x;
    hand->y = y;
    if (hand->adjusting && !hand->drag) adjust(hand, dx);
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) go_on(hand, x, y, false);
    if (hand->drag == ISOSCULPT_DRAG_ORBIT) isosculpt_view_orbit(hand->view, dx, dy);
    if (hand->drag == ISOSCULPT_DRAG_PAN) isosculpt_view_pan(hand->view, dx, dy);
    if (hand->drag) hand->wishes |= ISOSCULPT_WISH_PICTURE;
}

void isosculpt_hand_release(isosculpt_hand *hand, isosculpt_button button) {
    if (!hand->drag || button != hand->button) return;
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) {
        go_on(hand, hand->x, hand->y, true);
        end(hand, false);
    }
    hand->drag = ISOSCULPT_DRAG_NONE;
}

static void zoom(isosculpt_hand *hand, double factor) {
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) return; /* the stroke's picks are of this camera */
    isosculpt_view_zoom(hand->view, factor);
    hand->wishes |= ISOSCULPT_WISH_PICTURE;
}

void isosculpt_hand_scroll(isosculpt_hand *hand, double steps) {
    zoom(hand, pow(WHEEL, steps));
}

bool isosculpt_hand_under(const isosculpt_hand *hand, isosculpt_pick *pick) {
    if (hand->drag == ISOSCULPT_DRAG_ORBIT || hand->drag == ISOSCULPT_DRAG_PAN) return false;
    return isosculpt_layer_pick(&hand->view->drawn, hand->x, hand->y, pick);
}

/* ---- keys */

static void step(isosculpt_hand *hand, bool redo) {
    iso_edit_stats stats = {0};
    iso_session *session = hand->desk->session;
    if (hand->awaiting && !redo && !hand->drag) {
        isosculpt_strokes_drop_last(&hand->waiting);
        return;
    }
    const iso_history *history = iso_session_history(session);
    size_t position = iso_history_position(history);
    if (hand->drag == ISOSCULPT_DRAG_BRUSH || position == (redo ? iso_history_count(history) : 0)) return;
    if (!is_over(hand)) return;
    iso_status status =
        redo ? iso_session_redo(session, &hand->error) : iso_session_undo(session, &hand->error);
    hand->desk->changes += status == ISO_OK;
    done(hand, status, &stats);
    hand->view->repaint |= hand->view->mask.at != NULL; /* the step may be one of masking */
}

void isosculpt_hand_history(isosculpt_hand *hand, size_t position) {
    const iso_history *history = iso_session_history(hand->desk->session);
    for (size_t now = iso_history_position(history), last = now + 1; now != position && now != last;) {
        last = now;
        step(hand, now < position);
        now = iso_history_position(history);
    }
}

static bool command(isosculpt_hand *hand, int key, bool shift) {
    if (key == 's')
        hand->wishes |= shift ? ISOSCULPT_WISH_SAVE_AS : ISOSCULPT_WISH_SAVE;
    else if (key == 'o')
        hand->wishes |= ISOSCULPT_WISH_OPEN;
    else if (key == 'q')
        hand->wishes |= ISOSCULPT_WISH_CLOSE;
    else if (key == 'z' || key == 'y')
        step(hand, key == 'y' || shift);
    else
        return false;
    return true;
}

void isosculpt_hand_look(isosculpt_hand *hand, iso_direction direction) {
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) return;
    isosculpt_view_look(hand->view, direction);
    hand->wishes |= ISOSCULPT_WISH_PICTURE;
}

/* 1, 3 and 7, of the number pad or with Shift or Ctrl; Ctrl: the opposite side. */
static bool look(isosculpt_hand *hand, int key, unsigned modifiers) {
    static const iso_direction sides[][2] = {
        {ISO_FRONT, ISO_BACK}, {ISO_RIGHT, ISO_LEFT}, {ISO_TOP, ISO_BOTTOM}};
    const bool opposite = modifiers & ISOSCULPT_CTRL, digit = modifiers & (ISOSCULPT_SHIFT | ISOSCULPT_CTRL);
    int side = -1;
    if (key == ISOSCULPT_KEY_FRONT || (key == '1' && digit)) side = 0;
    if (key == ISOSCULPT_KEY_RIGHT || (key == '3' && digit)) side = 1;
    if (key == ISOSCULPT_KEY_TOP || (key == '7' && digit)) side = 2;
    if (side >= 0) isosculpt_hand_look(hand, sides[side][opposite]);
    return side >= 0;
}

static void focus(isosculpt_hand *hand, bool on_cursor) {
    isosculpt_pick pick;
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) return;
    if (!on_cursor)
        isosculpt_view_focus(hand->view, NULL);
    else if (isosculpt_hand_under(hand, &pick))
        isosculpt_view_focus(hand->view, &pick.position);
    hand->wishes |= ISOSCULPT_WISH_PICTURE;
}

static void pan(isosculpt_hand *hand, int key) {
    const double step = KEY_PAN * hand->view->height;
    const int x = (key == ISOSCULPT_KEY_ARROW_RIGHT) - (key == ISOSCULPT_KEY_ARROW_LEFT),
              y = (key == ISOSCULPT_KEY_ARROW_DOWN) - (key == ISOSCULPT_KEY_ARROW_UP);
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) return;
    isosculpt_view_pan(hand->view, step * x, step * y);
    hand->wishes |= ISOSCULPT_WISH_PICTURE;
}

static bool move_camera(isosculpt_hand *hand, int key, unsigned modifiers) {
    if (key == 'f')
        focus(hand, modifiers & ISOSCULPT_SHIFT);
    else if (key == '+' || key == '=')
        zoom(hand, KEY_ZOOM);
    else if (key == '-')
        zoom(hand, 1 / KEY_ZOOM);
    else if (key >= ISOSCULPT_KEY_ARROW_LEFT && key <= ISOSCULPT_KEY_ARROW_DOWN)
        pan(hand, key);
    else
        return look(hand, key, modifiers);
    return true;
}

/* A brush that is picked for a volume is one to sculpt it with. */
static void pick_brush(isosculpt_hand *hand, int number) {
    hand->brush.tool = isosculpt_hand_tool(number);
    if (hand->looking) hand->wishes |= ISOSCULPT_WISH_SCULPT;
}

static bool set_brush(isosculpt_hand *hand, int key) {
    if (key >= '1' && key <= '9')
        pick_brush(hand, key - '0');
    else if (key == '[' || key == ']' || key == ',' || key == '.')
        set_radius(hand, key == ']' || key == '.' ? hand->brush.radius * SIZE : hand->brush.radius / SIZE);
    else if (key == 'x' || key == 'c')
        hand->adjusting = (char)key;
    else if (key == ISOSCULPT_KEY_ESCAPE && hand->drag == ISOSCULPT_DRAG_BRUSH)
        end(hand, true);
    else
        return false;
    return true;
}

bool isosculpt_hand_key(isosculpt_hand *hand, int key, unsigned modifiers, bool down) {
    if (!down) {
        if (key == hand->adjusting) hand->adjusting = 0;
        return false;
    }
    if (move_camera(hand, key, modifiers)) return true;
    if (modifiers & ISOSCULPT_CTRL) return command(hand, key, modifiers & ISOSCULPT_SHIFT);
    return set_brush(hand, key);
}
