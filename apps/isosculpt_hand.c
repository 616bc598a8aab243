#include "apps/isosculpt_hand.h"

#include <math.h>

/* A wheel's step, a size key's step, a pixel of dragging with X or C. */
static const double WHEEL = 1.1, SIZE = 1.15, SIZE_A_PIXEL = 1.01, STRENGTH_A_PIXEL = 0.005;
/* Radii in voxels; strengths. */
static const double RADIUS_MIN = 2, RADIUS_MAX = 256, STRENGTH_MIN = 0.02;
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
    show_mask(hand);
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

static void begin(isosculpt_hand *hand, unsigned modifiers, double x, double y) {
    iso_edit_stats stats = {0};
    if (!is_over(hand)) return;
    hand->tool = isosculpt_hand_modified(hand->brush.tool, modifiers);
    iso_brush brush = hand->brush;
    brush.tool = hand->tool;
    bool tube = hand->tool == ISO_TOOL_ADD || hand->tool == ISO_TOOL_CARVE;
    if (tube && brush.shape == ISO_SOLID_SPHERE)
        brush.shape = ISO_SOLID_CAPSULE; /* without ridges between touches */
    if (brush.shape == ISO_SOLID_STAMP) brush.spacing = STAMP_SPACING;
    iso_status status = isosculpt_view_hold(hand->view, &hand->error);
    if (status != ISO_OK) return;
    iso_sample sample = sample_at(hand, x, y);
    double start = isosculpt_now();
    status = iso_session_begin(hand->desk->session, &brush, &sample, &stats, &hand->error);
    isosculpt_latency_add(&hand->edit, isosculpt_now() - start);
    if (status == ISO_OK) {
        hand->drag = ISOSCULPT_DRAG_BRUSH;
        hand->desk->changes++;
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
    iso_status status = iso_session_sample(hand->desk->session, &sample, &stats, &hand->error);
    isosculpt_latency_add(&hand->edit, isosculpt_now() - start);
    done(hand, status, &stats);
}

/* A stroke that cannot be ended is taken back: it would be in the way of all that follows. */
static void end(isosculpt_hand *hand, bool cancel) {
    iso_edit_stats stats = {0};
    iso_session *session = hand->desk->session;
    hand->drag = ISOSCULPT_DRAG_NONE;
    const iso_status status =
        cancel ? iso_session_cancel(session, &hand->error) : iso_session_end(session, &hand->error);
    hand->unended = status != ISO_OK;
    is_over(hand);
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
    if (button == ISOSCULPT_RIGHT)
        hand->drag = ISOSCULPT_DRAG_PAN;
    else if (button == ISOSCULPT_LEFT && isosculpt_layer_pick(&hand->view->drawn, x, y, &pick)) {
        if (hand->looking)
            hand->wishes |= ISOSCULPT_WISH_SCULPT;
        else
            begin(hand, modifiers, x, y);
    } else
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

void isosculpt_hand_scroll(isosculpt_hand *hand, double steps) {
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) return; /* the stroke's picks are of this camera */
    isosculpt_view_zoom(hand->view, pow(WHEEL, steps));
    hand->wishes |= ISOSCULPT_WISH_PICTURE;
}

bool isosculpt_hand_under(const isosculpt_hand *hand, isosculpt_pick *pick) {
    if (hand->drag == ISOSCULPT_DRAG_ORBIT || hand->drag == ISOSCULPT_DRAG_PAN) return false;
    return isosculpt_layer_pick(&hand->view->drawn, hand->x, hand->y, pick);
}

/* ---- keys */

static void step(isosculpt_hand *hand, bool redo) {
    iso_edit_stats stats = {0};
    iso_session *session = hand->desk->session;
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
        hand->wishes |= ISOSCULPT_WISH_SAVE;
    else if (key == 'q')
        hand->wishes |= ISOSCULPT_WISH_CLOSE;
    else if (key == 'z' || key == 'y')
        step(hand, key == 'y' || shift);
    else
        return false;
    return true;
}

static bool look(isosculpt_hand *hand, int key) {
    if (hand->drag == ISOSCULPT_DRAG_BRUSH) return true;
    isosculpt_pick pick;
    if (key == ISOSCULPT_KEY_FRONT)
        isosculpt_view_look(hand->view, ISO_FRONT);
    else if (key == ISOSCULPT_KEY_SIDE)
        isosculpt_view_look(hand->view, ISO_RIGHT);
    else if (key == ISOSCULPT_KEY_TOP)
        isosculpt_view_look(hand->view, ISO_TOP);
    else if (key == 'f')
        isosculpt_view_focus(hand->view, isosculpt_hand_under(hand, &pick) ? &pick.position : NULL);
    else
        return false;
    hand->wishes |= ISOSCULPT_WISH_PICTURE;
    return true;
}

static bool set_brush(isosculpt_hand *hand, int key) {
    if (key >= '1' && key <= '9')
        hand->brush.tool = isosculpt_hand_tool(key - '0');
    else if (key == '[' || key == ']')
        set_radius(hand, key == ']' ? hand->brush.radius * SIZE : hand->brush.radius / SIZE);
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
    if (modifiers & ISOSCULPT_CTRL) return command(hand, key, modifiers & ISOSCULPT_SHIFT);
    return look(hand, key) || set_brush(hand, key);
}
