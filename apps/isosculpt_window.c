/* The window of isosculpt: GLFW, its events, and when to draw what. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt.h"
#include "apps/isosculpt_opening.h"
#include "apps/isosculpt_panel.h"
#include "apps/isosculpt_pen.h"

#ifndef GL_CLAMP_TO_EDGE
#define GL_CLAMP_TO_EDGE 0x812F /* OpenGL 1.2 */
#endif

/* Seconds without a change after which the picture becomes the exact surface, and a smoother one; between
 * looks at the journal. */
static const double REST[] = {[ISOSCULPT_REST] = 0.12, [ISOSCULPT_FINE] = 0.6}, IDLE = 0.25;
/* Frames after an event: Dear ImGui shows some answers only in the next. */
enum { FRAMES = 3, WIDTH = 1280, HEIGHT = 800 };

typedef struct window {
    GLFWwindow *glfw;
    const isosculpt_settings *settings;
    iso_pool *pool;     /* the program's, or own_pool */
    iso_pool *own_pool; /* of what was opened; NULL: none */
    isosculpt_opening *opening;
    isosculpt_volume *volume; /* that is looked at; NULL: the desk has a field */
    isosculpt_desk desk;
    isosculpt_view view;
    isosculpt_hand hand;
    double voxel; /* of what the hand works on, mm; 0: nothing yet */
    isosculpt_screen screen;
    isosculpt_panel *panel;
    isosculpt_pen *pen;
    iso_gl_context *context; /* the window's, for the gl engine; NULL: OpenGL is older than that needs */
    isosculpt_gl *gl;        /* or NULL */
    isosculpt_engine engine; /* as chosen */
    unsigned texture;        /* of the cpu engine's picture; 0: none yet */
    char folder[ISOSCULPT_PATH], offered[ISOSCULPT_PATH];
    bool has_folder;
    int texture_width, texture_height;
    int frames;       /* still to be drawn */
    double changed;   /* when the picture last had to be drawn */
    bool sculpting;   /* the volume is being made a field */
    bool stamp_asked; /* --stamp was seen to */
    bool save;        /* as soon as no stroke is drawn */
    bool close_after; /* a save, which must succeed */
    bool shoot, shoot_all;
    iso_error error; /* of drawing: it ends the program */
} window;

static window *of(GLFWwindow *glfw) {
    return glfwGetWindowUserPointer(glfw);
}

static void say(window *w, bool bad, const char *text) {
    snprintf(w->screen.message, sizeof w->screen.message, "%s", text);
    w->screen.message_is_bad = bad;
    w->frames = FRAMES;
}

/* ---- events */

static unsigned modifiers(int mods) {
    return (mods & GLFW_MOD_SHIFT ? ISOSCULPT_SHIFT : 0u) | (mods & GLFW_MOD_CONTROL ? ISOSCULPT_CTRL : 0u) |
           (mods & GLFW_MOD_ALT ? ISOSCULPT_ALT : 0u);
}

static void on_move(GLFWwindow *glfw, double x, double y) {
    window *w = of(glfw);
    w->frames = FRAMES;
    if (w->hand.drag == ISOSCULPT_DRAG_BRUSH && isosculpt_pen_present(w->pen))
        w->hand.pressure = isosculpt_pen_pressure(w->pen);
    isosculpt_hand_move(&w->hand, x * w->screen.pixels, y * w->screen.pixels);
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods) {
    static const isosculpt_button buttons[] = {ISOSCULPT_LEFT, ISOSCULPT_RIGHT, ISOSCULPT_MIDDLE};
    window *w = of(glfw);
    w->frames = FRAMES;
    if (button < 0 || button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    double x = w->hand.x, y = w->hand.y; /* of the last event: GLFW sends the position first */
    if (action == GLFW_RELEASE)
        isosculpt_hand_release(&w->hand, buttons[button]);
    else if (!w->screen.blank &&
             !isosculpt_panel_has_pointer(w->panel, x / w->screen.pixels, y / w->screen.pixels)) {
        w->hand.pressure = isosculpt_pen_pressure(w->pen);
        w->screen.pen = isosculpt_pen_present(w->pen);
        isosculpt_hand_press(&w->hand, buttons[button], modifiers(mods), x, y);
    }
}

static void on_scroll(GLFWwindow *glfw, double dx, double dy) {
    (void)dx;
    window *w = of(glfw);
    w->frames = FRAMES;
    double pixels = w->screen.pixels;
    if (!w->screen.blank && !isosculpt_panel_has_pointer(w->panel, w->hand.x / pixels, w->hand.y / pixels))
        isosculpt_hand_scroll(&w->hand, dy);
}

/* What a key stands for on this keyboard; the number pad's are views. */
static int key_of(int key, int scancode) {
    if (key == GLFW_KEY_KP_1) return ISOSCULPT_KEY_FRONT;
    if (key == GLFW_KEY_KP_3) return ISOSCULPT_KEY_SIDE;
    if (key == GLFW_KEY_KP_7) return ISOSCULPT_KEY_TOP;
    if (key == GLFW_KEY_ESCAPE) return ISOSCULPT_KEY_ESCAPE;
    if (key < 0 || key > 127) return 0;
    const char *name = glfwGetKeyName(key, scancode);
    if (name && isalpha((unsigned char)name[0]) && !name[1]) return tolower((unsigned char)name[0]);
    return tolower(key); /* digits and brackets by their place */
}

/* A window closed over unsaved changes asks first, and closes when it is closed again. */
static void want_close(window *w) {
    bool ask = w->desk.changes != w->desk.saved && !w->close_after && !w->screen.closing;
    glfwSetWindowShouldClose(w->glfw, !ask);
    w->screen.closing = ask;
    w->frames = FRAMES;
}

static void on_close(GLFWwindow *glfw) {
    want_close(of(glfw));
}

/* The gl engine, where there is one, and the cpu engine. */
static void change_engine(window *w) {
    isosculpt_look *look = &w->view.look;
    if (!w->gl) return;
    look->engine = look->engine == ISOSCULPT_GL ? ISOSCULPT_CPU : ISOSCULPT_GL;
    w->view.gl_error.text[0] = 0;
}

/* Keys that change how it looks. */
static bool change_look(window *w, int meant) {
    isosculpt_look *look = &w->view.look;
    if (meant == 'm')
        look->method = (isosculpt_method)((look->method + 1) % ISOSCULPT_METHOD_COUNT);
    else if (meant == 'g')
        change_engine(w);
    else
        return false;
    w->hand.wishes |= ISOSCULPT_WISH_PICTURE;
    return true;
}

/* What was dropped on the window, of several the first: a mesh is a stamp, all else is opened. */
static void on_drop(GLFWwindow *glfw, int count, const char **paths) {
    window *w = of(glfw);
    if (count < 1) return;
    snprintf(w->screen.path, sizeof w->screen.path, "%s", paths[0]);
    w->screen.answers |= isosculpt_is_mesh(paths[0]) ? ISOSCULPT_ANSWER_STAMP : ISOSCULPT_ANSWER_OPEN;
    w->frames = FRAMES;
}

/* While a question is asked keys answer it and do nothing else. */
static bool answer(window *w, int key) {
    bool yes = key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER;
    if (!w->screen.offered && !w->screen.closing) return false;
    if (w->screen.offered)
        w->screen.answers |= yes ? ISOSCULPT_ANSWER_RECOVER : 0u;
    else if (yes)
        w->screen.answers |= ISOSCULPT_ANSWER_SAVE | ISOSCULPT_ANSWER_CLOSE;
    else if (key == GLFW_KEY_ESCAPE)
        w->screen.closing = false;
    return true;
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int mods) {
    window *w = of(glfw);
    w->frames = FRAMES;
    int meant = key_of(key, scancode);
    if (action == GLFW_RELEASE) {
        isosculpt_hand_key(&w->hand, meant, modifiers(mods), false);
        return;
    }
    if (answer(w, key)) return;
    if (action == GLFW_PRESS && key == GLFW_KEY_F12)
        *(mods & GLFW_MOD_SHIFT ? &w->shoot_all : &w->shoot) = true;
    if (isosculpt_panel_has_keys()) return;
    if (key == GLFW_KEY_ESCAPE && w->hand.drag != ISOSCULPT_DRAG_BRUSH && w->screen.busy_count)
        w->screen.answers |= ISOSCULPT_ANSWER_CANCEL;
    if (action == GLFW_PRESS && key == GLFW_KEY_TAB) w->screen.panel = !w->screen.panel;
    if (action == GLFW_PRESS && meant == 'h') w->screen.help = !w->screen.help;
    if (action == GLFW_PRESS && !(mods & GLFW_MOD_CONTROL) && change_look(w, meant)) return;
    if (!w->screen.blank || meant == 'q') isosculpt_hand_key(&w->hand, meant, modifiers(mods), true);
    if (w->hand.wishes & ISOSCULPT_WISH_CLOSE) want_close(w);
    w->hand.wishes &= ~(unsigned)ISOSCULPT_WISH_CLOSE;
}

static void on_refresh(GLFWwindow *glfw) {
    of(glfw)->frames = FRAMES;
}

static void on_size(GLFWwindow *glfw, int width, int height) {
    window *w = of(glfw);
    (void)width;
    (void)height;
    w->frames = FRAMES;
    w->hand.wishes |= ISOSCULPT_WISH_PICTURE;
}

static void set_callbacks(window *w) {
    glfwSetWindowUserPointer(w->glfw, w);
    glfwSetCursorPosCallback(w->glfw, on_move);
    glfwSetMouseButtonCallback(w->glfw, on_button);
    glfwSetScrollCallback(w->glfw, on_scroll);
    glfwSetKeyCallback(w->glfw, on_key);
    glfwSetWindowCloseCallback(w->glfw, on_close);
    glfwSetWindowRefreshCallback(w->glfw, on_refresh);
    glfwSetFramebufferSizeCallback(w->glfw, on_size);
    glfwSetDropCallback(w->glfw, on_drop);
}

/* ---- the sculpture on the desk */

static void show_title(window *w) {
    char title[ISOSCULPT_PATH + 32];
    const char *path = w->volume ? w->volume->path : w->desk.journal, *slash = strrchr(path, '/'),
               *name = slash ? slash + 1 : path;
    snprintf(title, sizeof title, "isosculpt%s%s", name[0] ? ": " : "", name);
    glfwSetWindowTitle(w->glfw, title);
}

/* The hand and the engine for what is on the desk and in the view. The brush stays as it is, in voxels. */
static void take_up(window *w) {
    iso_brush brush = w->hand.brush;
    const double before = w->voxel, voxel = w->desk.start.voxel_size;
    w->view.gl = w->gl;
    w->view.look.engine = w->engine;
    isosculpt_hand_init(&w->hand, &w->desk, &w->view);
    if (before > 0) {
        w->hand.brush = brush;
        w->hand.brush.radius = brush.radius / before * voxel;
    }
    w->voxel = voxel;
    w->hand.looking = w->screen.volume != NULL;
    show_title(w);
    w->hand.wishes = ISOSCULPT_WISH_PICTURE;
    w->frames = FRAMES;
}

static iso_status show_desk(window *w, iso_error *error) {
    ISO_TRY(isosculpt_view_init(&w->view, iso_session_grid(w->desk.session), w->pool, error));
    take_up(w);
    return ISO_OK;
}

/* A new ball, with a journal if that can be. */
static iso_status show_ball(window *w, iso_error *error) {
    ISO_TRY(isosculpt_desk_new(&w->desk, w->has_folder ? w->folder : NULL, NULL, error));
    return show_desk(w, error);
}

static void wake(void) {
    glfwPostEmptyEvent();
}

/* The volume that is looked at as a field at the isovalue that was chosen. */
static iso_status start_sculpting(window *w, iso_error *error) {
    const isosculpt_request request = {.path = w->volume->path,
                                       .sculpt = w->volume,
                                       .folder = w->has_folder ? w->folder : NULL,
                                       .isovalue = w->view.isovalue,
                                       .voxel = w->settings->voxel_size,
                                       .threads = w->settings->threads,
                                       .undo_memory = (size_t)w->settings->undo_memory,
                                       .wake = wake};
    if (w->opening) return iso_fail(error, ISO_ERR_USAGE, "another file is being opened");
    return isosculpt_opening_start(&request, &w->opening, error);
}

/* Beside what is there, until it is whole. */
static iso_status start_opening(window *w, const char *path, bool stamp, iso_error *error) {
    const isosculpt_settings *settings = w->settings;
    const bool asked = path == settings->open;
    const isosculpt_request request = {.path = path,
                                       .stamp = stamp,
                                       .folder = w->has_folder ? w->folder : NULL,
                                       .isovalue = asked ? settings->isovalue : NAN,
                                       .voxel = asked ? settings->voxel_size : 0,
                                       .threads = settings->threads,
                                       .undo_memory = (size_t)settings->undo_memory,
                                       .wake = wake};
    if (w->opening) return iso_fail(error, ISO_ERR_USAGE, "another file is being opened");
    return isosculpt_opening_start(&request, &w->opening, error);
}

/* Until it is there the window shows nothing. */
static iso_status open_alone(window *w, const char *path, iso_error *error) {
    ISO_TRY(isosculpt_desk_blank(&w->desk, error));
    ISO_TRY(show_desk(w, error));
    w->screen.blank = true;
    return start_opening(w, path, false, error);
}

static iso_status open_first(window *w, iso_error *error) {
    const isosculpt_settings *settings = w->settings;
    iso_error reason = {0};
    w->has_folder = isosculpt_desk_folder(w->folder, &reason) == ISO_OK;
    if (settings->strokes) return open_alone(w, settings->strokes, error);
    bool unclosed = w->has_folder && isosculpt_desk_unclosed(w->folder, w->offered);
    if (settings->recover && unclosed) return open_alone(w, w->offered, error);
    if (unclosed) w->screen.offered = w->offered;
    if (settings->recover) say(w, false, "There is nothing to recover: no session was left unclosed.");
    if (settings->open) return open_alone(w, settings->open, error);
    ISO_TRY(show_ball(w, error));
    if (reason.text[0]) snprintf(w->desk.trouble, sizeof w->desk.trouble, "%s", reason.text);
    return ISO_OK;
}

/* In place of what is on the desk, whose journal has all of it. What a volume becomes is seen from where the
 * volume was. */
static iso_status replace_desk(window *w, isosculpt_opened *opened, iso_error *error) {
    const isosculpt_look look = w->view.look;
    const iso_camera camera = w->view.camera;
    const bool same_place = w->volume && !opened->volume && w->sculpting;
    isosculpt_view_free(&w->view);
    isosculpt_desk_close(&w->desk);
    isosculpt_volume_free(w->volume);
    iso_pool_destroy(w->own_pool);
    w->pool = w->own_pool = opened->pool;
    w->desk = opened->desk;
    w->view = opened->view;
    w->screen.volume = w->volume = opened->volume;
    w->screen.isovalue = w->view.isovalue;
    w->screen.blank = false;
    w->view.look = look;
    if (same_place) w->view.camera = camera;
    if (w->volume) {
        w->desk.pool = w->pool;
        ISO_TRY(isosculpt_desk_blank(&w->desk, error));
        w->desk.start.voxel_size = iso_grid_transform(&w->view.grid)->spacing[0];
    }
    take_up(w);
    return ISO_OK;
}

/* What could not be opened leaves what was there; at the start that was nothing. */
static iso_status without(window *w, bool cancelled, iso_status status, iso_error *error) {
    const bool first = w->screen.blank;
    if (first && !cancelled) return status;
    say(w, !cancelled, cancelled ? "Cancelled." : error->text);
    if (!first) return ISO_OK;
    w->screen.blank = false;
    isosculpt_view_free(&w->view);
    isosculpt_desk_close(&w->desk);
    return show_ball(w, error);
}

static iso_status finish_opening(window *w, iso_error *error) {
    isosculpt_opened opened;
    if (!w->opening || !isosculpt_task_done(isosculpt_opening_task(w->opening))) return ISO_OK;
    if (w->hand.drag || w->desk.saver) return ISO_OK; /* first things first */
    const bool cancelled = isosculpt_task_cancelled(isosculpt_opening_task(w->opening));
    iso_status status = isosculpt_opening_finish(w->opening, &opened, error);
    w->opening = NULL;
    if (status != ISO_OK) {
        w->sculpting = false;
        return without(w, cancelled, status, error);
    }
    if (opened.stamp)
        isosculpt_hand_stamp(&w->hand, opened.stamp);
    else
        status = replace_desk(w, &opened, error);
    w->sculpting = false;
    w->frames = FRAMES;
    return status;
}

/* What was typed in or dropped. */
static void open_path(window *w, const char *named, bool stamp) {
    char path[ISOSCULPT_PATH];
    iso_error reason = {0};
    snprintf(path, sizeof path, "%s", named);
    w->screen.path[0] = 0;
    if (stamp && w->volume)
        say(w, true, "A stamp needs something to work on: sculpt this first.");
    else if (!stamp && !w->desk.journal[0] && w->desk.changes != w->desk.saved && !w->screen.blank)
        say(w, true, "What you did is in no file: save it first.");
    else if (start_opening(w, path, stamp, &reason) != ISO_OK)
        say(w, true, reason.text);
}

/* What the panel says of the isovalue. */
static void slide(window *w) {
    if (!w->volume) return;
    const bool rested = w->view.sliding && !w->screen.sliding;
    w->view.sliding = w->screen.sliding;
    if (w->screen.isovalue != w->view.isovalue) {
        isosculpt_view_set_isovalue(&w->view, w->screen.isovalue);
        w->hand.wishes |= ISOSCULPT_WISH_PICTURE;
    } else if (rested)
        w->changed = isosculpt_now(); /* the exact picture is due */
}

static void sculpt(window *w) {
    iso_error reason = {0};
    if (!w->volume || w->sculpting) return;
    w->sculpting = start_sculpting(w, &reason) == ISO_OK;
    if (!w->sculpting) say(w, true, reason.text);
}

/* --stamp, once there is a session that can hold it. */
static void ask_for_stamp(window *w) {
    if (w->stamp_asked || w->screen.blank || w->volume || w->opening || !w->settings->stamp) return;
    w->stamp_asked = true;
    open_path(w, w->settings->stamp, true);
}

/* ---- files */

static void start_save(window *w) {
    iso_error reason = {0};
    if (w->hand.drag == ISOSCULPT_DRAG_BRUSH) return;
    w->save = false;
    if (w->volume) {
        say(w, true, "There is nothing to save before it is sculpted.");
        return;
    }
    if (isosculpt_desk_save(&w->desk, wake, &reason) != ISO_OK) say(w, true, reason.text);
}

static void finish_save(window *w) {
    iso_error reason = {0};
    iso_status status = ISO_OK;
    char path[ISOSCULPT_PATH], text[sizeof w->screen.message];
    isosculpt_task *task = isosculpt_desk_save_task(&w->desk);
    const bool cancelled = task && isosculpt_task_cancelled(task);
    if (isosculpt_desk_saving(&w->desk, false, &status, &reason) != ISOSCULPT_SAVE_DONE) return;
    isosculpt_desk_target(&w->desk, path);
    snprintf(text, sizeof text, "%s%.500s", status == ISO_OK ? "Saved " : "Not saved: ",
             status == ISO_OK ? path
             : cancelled      ? "cancelled"
                              : reason.text);
    say(w, status != ISO_OK && !cancelled, text);
    if (w->close_after && status == ISO_OK) glfwSetWindowShouldClose(w->glfw, GLFW_TRUE);
    if (status != ISO_OK) w->close_after = false;
}

/* The first name beside the strokes that is free. */
static bool name_shot(const isosculpt_desk *desk, char path[ISOSCULPT_PATH]) {
    char base[ISOSCULPT_PATH];
    isosculpt_desk_target(desk, base);
    for (int number = 1; number < 10000; number++) {
        int length = snprintf(path, ISOSCULPT_PATH, "%.*s-%d.png", (int)strlen(base) - 4, base, number);
        if (length < ISOSCULPT_PATH && access(path, F_OK)) return true;
    }
    return false;
}

static void write_shot(window *w, const iso_image *image) {
    char path[ISOSCULPT_PATH], text[sizeof w->screen.message];
    iso_error reason = {0};
    iso_png_opts opts = {.pool = w->pool};
    bool named = name_shot(&w->desk, path);
    bool written = named && iso_png_write_with(path, image, &opts, &reason) == ISO_OK;
    snprintf(text, sizeof text, "%s%.500s", written ? "Picture: " : "No picture: ",
             written ? path
             : named ? reason.text
                     : "there is no free name");
    say(w, !written, text);
}

/* What is in the framebuffer, panel and all; OpenGL's first row is the lowest. */
static void shoot_window(window *w) {
    iso_image image;
    int width = w->screen.width, height = w->screen.height;
    if (iso_image_create(width, height, &image, NULL) != ISO_OK) return;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int row = 0; row < height; row++)
        glReadPixels(0, height - 1 - row, width, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                     image.rgba + (size_t)row * (size_t)width * 4);
    for (size_t i = 3; i < (size_t)width * (size_t)height * 4; i += 4) image.rgba[i] = 255;
    write_shot(w, &image);
    iso_image_free(&image);
}

/* ---- drawing */

static void make_texture(window *w) {
    const iso_image *image = &w->view.image;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, image->width, image->height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image->rgba);
    w->texture_width = image->width;
    w->texture_height = image->height;
}

/* What was drawn last. */
static void upload(window *w) {
    const iso_image *image = &w->view.image;
    const isosculpt_damage *fresh = &w->view.fresh;
    if (w->view.drawn.canvas) {
        w->screen.texture = iso_gl_canvas_texture(w->view.drawn.canvas);
        return;
    }
    if (!w->texture) glGenTextures(1, &w->texture);
    w->screen.texture = w->texture;
    glBindTexture(GL_TEXTURE_2D, w->texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    if (w->texture_width != image->width || w->texture_height != image->height) {
        make_texture(w);
        return;
    }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, image->width);
    for (int i = 0; i < fresh->count; i++) {
        isosculpt_rectangle r = fresh->rectangle[i];
        glTexSubImage2D(GL_TEXTURE_2D, 0, r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0, GL_RGBA, GL_UNSIGNED_BYTE,
                        image->rgba + ((size_t)r.y0 * (size_t)image->width + (size_t)r.x0) * 4);
    }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

/* Seconds until a better picture is due; < 0: it is; none is due once it is the best. */
static double until_better(const window *w) {
    if (w->screen.blank || w->view.sliding) return IDLE;
    if (w->view.quality == ISOSCULPT_FINE) return IDLE;
    return w->shoot ? -1 : w->changed + REST[w->view.quality + 1] - isosculpt_now();
}

/* One step to a better picture. */
static iso_status improve(window *w, iso_error *error) {
    if (w->view.quality == ISOSCULPT_REST) return isosculpt_view_refine(&w->view, error);
    return isosculpt_view_draw(&w->view, w->screen.width, w->screen.height, false, error);
}

static iso_status draw_due(window *w, iso_error *error) {
    if (w->screen.blank) w->hand.wishes &= ~(unsigned)ISOSCULPT_WISH_PICTURE;
    if (w->screen.blank) return ISO_OK;
    if (w->hand.wishes & ISOSCULPT_WISH_PICTURE) {
        w->hand.wishes &= ~(unsigned)ISOSCULPT_WISH_PICTURE;
        w->changed = isosculpt_now();
        ISO_TRY(isosculpt_view_draw(&w->view, w->screen.width, w->screen.height, true, error));
    } else if (until_better(w) < 0)
        ISO_TRY(improve(w, error));
    else
        return ISO_OK;
    upload(w);
    w->frames = FRAMES;
    return ISO_OK;
}

/* The picture that is due now, if any. */
static iso_status update_picture(window *w, iso_error *error) {
    ISO_TRY(draw_due(w, error));
    if (!w->shoot || w->view.quality != ISOSCULPT_FINE || w->screen.blank) return ISO_OK;
    w->shoot = false;
    iso_error reason = {0};
    if (isosculpt_view_fetch(&w->view, &reason) == ISO_OK)
        write_shot(w, &w->view.image);
    else
        say(w, true, reason.text);
    return ISO_OK;
}

static void measure(window *w) {
    int width, height;
    glfwGetWindowSize(w->glfw, &width, &height);
    glfwGetFramebufferSize(w->glfw, &w->screen.width, &w->screen.height);
    w->screen.pixels = width > 0 ? (double)w->screen.width / width : 1;
}

static iso_status draw(window *w, iso_error *error) {
    measure(w);
    if (w->screen.width <= 0 || w->screen.height <= 0) return ISO_OK; /* iconified */
    ISO_TRY(update_picture(w, error));
    w->engine = w->view.look.engine;
    if (w->frames <= 0) return ISO_OK;
    w->frames--;
    glViewport(0, 0, w->screen.width, w->screen.height);
    glClearColor(0.18f, 0.196f, 0.22f, 1); /* seen until there is a picture */
    glClear(GL_COLOR_BUFFER_BIT);
    ISO_TRY(isosculpt_panel_draw(w->panel, &w->screen, error));
    if (w->shoot_all && !w->screen.blank) {
        w->shoot_all = false;
        shoot_window(w);
    }
    glfwSwapBuffers(w->glfw);
    return ISO_OK;
}

/* ---- heavy work */

static void add_busy(window *w, const char *verb, const char *path, const isosculpt_task *task) {
    isosculpt_busy *busy = &w->screen.busy[w->screen.busy_count++];
    const char *slash = strrchr(path, '/');
    snprintf(busy->text, sizeof busy->text, "%s %.120s", verb, slash ? slash + 1 : path);
    busy->fraction = isosculpt_task_fraction(task);
}

static int running(const window *w, isosculpt_task *tasks[ISOSCULPT_BUSY]) {
    int count = 0;
    if (w->opening) tasks[count++] = isosculpt_opening_task(w->opening);
    if (w->desk.saver) tasks[count++] = isosculpt_desk_save_task(&w->desk);
    return count;
}

static void show_busy(window *w) {
    char target[ISOSCULPT_PATH];
    isosculpt_task *tasks[ISOSCULPT_BUSY];
    const int before = w->screen.busy_count, count = running(w, tasks);
    w->screen.busy_count = 0;
    if (w->opening)
        add_busy(w,
                 w->sculpting                             ? "Making a field of"
                 : isosculpt_opening_is_stamp(w->opening) ? "Stamp:"
                                                          : "Opening",
                 isosculpt_opening_path(w->opening), tasks[0]);
    isosculpt_desk_target(&w->desk, target);
    if (w->desk.saver) add_busy(w, "Saving", target, tasks[count - 1]);
    if (count || before) w->frames = w->frames > 0 ? w->frames : 1;
}

static void cancel(window *w, unsigned answers) {
    isosculpt_task *tasks[ISOSCULPT_BUSY];
    const int count = running(w, tasks);
    for (int i = 0; i < count; i++)
        if (answers & (unsigned)ISOSCULPT_ANSWER_CANCEL << i) isosculpt_task_cancel(tasks[i]);
}

/* ---- the loop */

static iso_status obey(window *w, iso_error *error) {
    unsigned answers = w->screen.answers;
    w->screen.answers = 0;
    w->save |= (w->hand.wishes & ISOSCULPT_WISH_SAVE) || (answers & ISOSCULPT_ANSWER_SAVE);
    if (w->save) start_save(w);
    w->hand.wishes &= ~(unsigned)ISOSCULPT_WISH_SAVE;
    if (answers & (ISOSCULPT_ANSWER_CLOSE | ISOSCULPT_ANSWER_STAY)) w->screen.closing = false;
    if (answers & ISOSCULPT_ANSWER_CLOSE) {
        w->close_after = true;
        if (!(answers & ISOSCULPT_ANSWER_SAVE)) glfwSetWindowShouldClose(w->glfw, GLFW_TRUE);
    }
    if (answers & (ISOSCULPT_ANSWER_RECOVER | ISOSCULPT_ANSWER_DISMISS)) w->screen.offered = NULL;
    if (answers & ISOSCULPT_ANSWER_DISMISS) isosculpt_desk_dismiss(w->offered);
    cancel(w, answers);
    if (answers & ISOSCULPT_ANSWER_RECOVER) open_path(w, w->offered, false);
    if (answers & ISOSCULPT_ANSWER_OPEN) open_path(w, w->screen.path, false);
    if (answers & ISOSCULPT_ANSWER_STAMP) open_path(w, w->screen.path, true);
    if (w->hand.wishes & ISOSCULPT_WISH_SCULPT) sculpt(w);
    w->hand.wishes &= ~(unsigned)ISOSCULPT_WISH_SCULPT;
    slide(w);
    ask_for_stamp(w);
    return finish_opening(w, error);
}

static void wait_events(window *w) {
    double wait = fmin(until_better(w), IDLE);
    if (w->screen.busy_count) wait = fmin(wait, 0.05);
    if (w->frames > 0 || w->hand.wishes || w->screen.answers || wait <= 0) {
        glfwPollEvents();
        return;
    }
    double start = isosculpt_now();
    glfwWaitEventsTimeout(wait);
    if (isosculpt_now() - start > 0.9 * IDLE) w->frames = 1; /* the journal's state may have changed */
}

static iso_status loop(window *w, iso_error *error) {
    while (!glfwWindowShouldClose(w->glfw)) {
        show_busy(w);
        ISO_TRY(draw(w, error));
        wait_events(w);
        finish_save(w);
        ISO_TRY(obey(w, error));
    }
    return ISO_OK;
}

/* ---- life */

static iso_status no_window(iso_error *error, const char *what) {
    const char *reason = NULL;
    glfwGetError(&reason);
    return iso_fail(error, ISO_ERR_BACKEND, "%s: %s; without a window: --replay FILE --headless", what,
                    reason ? reason : "no reason is given");
}

/* The content scale in window coordinates: where those are no pixels, the system scales already. */
static double text_scale(window *w) {
    float x = 1, y = 1;
    glfwGetWindowContentScale(w->glfw, &x, &y);
    double scale = (double)x / w->screen.pixels;
    return scale > 0.5 && scale < 8 ? scale : 1;
}

/* The panel does with less than the gl engine. */
static GLFWwindow *create_window(int width, int height) {
    static const int versions[][2] = {{4, 5}, {3, 2}};
    GLFWwindow *made = NULL;
    for (int i = 0; i < 2 && !made; i++) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, versions[i][0]);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, versions[i][1]);
        made = glfwCreateWindow(width, height, "isosculpt", NULL, NULL);
    }
    return made;
}

static void make_current(void *glfw) {
    if (glfwGetCurrentContext() != glfw) glfwMakeContextCurrent(glfw);
}

/* Without OpenGL 4.5 the cpu engine draws; unless the other was asked for. */
static iso_status open_engine(window *w, iso_error *error) {
    const isosculpt_backend backend = (isosculpt_backend)w->settings->backend;
    const iso_gl_context_opts opts = {.kind = ISO_GL_WINDOW,
                                      .window = {w->glfw, make_current, glfwGetProcAddress}};
    iso_status status = iso_gl_context_create(&opts, &w->context, error);
    if (status == ISO_OK) status = isosculpt_gl_create(w->context, &w->gl, error);
    if (status != ISO_OK && backend == ISOSCULPT_BACKEND_GL) return status;
    bool wanted = backend == ISOSCULPT_BACKEND_GL ||
                  (backend == ISOSCULPT_BACKEND_AUTO && w->gl && iso_gl_context_info(w->context).hardware);
    w->engine = wanted ? ISOSCULPT_GL : ISOSCULPT_CPU;
    return ISO_OK;
}

/* ISO_GL_DEBUG asks the driver to watch, and here is what it said. */
static void close_engine(window *w) {
    isosculpt_gl_destroy(w->gl);
    if (w->context && getenv("ISO_GL_DEBUG")) {
        iso_gl_messages messages = iso_gl_context_messages(w->context);
        fprintf(stderr, "isosculpt: OpenGL: %zu messages. %s\n", messages.count, messages.first);
    }
    iso_gl_context_destroy(w->context);
}

/* No larger than the screen, which the content scale may have made it. */
static void fit_screen(GLFWwindow *glfw) {
    int width, height, x, y, room_x = 0, room_y = 0;
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    if (monitor) glfwGetMonitorWorkarea(monitor, &x, &y, &room_x, &room_y);
    glfwGetWindowSize(glfw, &width, &height);
    const int fit_x = room_x > 0 && room_x < width ? room_x : width,
              fit_y = room_y > 0 && room_y < height ? room_y : height;
    if (fit_x < width || fit_y < height) glfwSetWindowSize(glfw, fit_x, fit_y);
}

static iso_status make_window(window *w, iso_error *error) {
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    if (getenv("ISO_GL_DEBUG")) glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    w->glfw = create_window(WIDTH, HEIGHT);
    if (!w->glfw) return no_window(error, "no window with OpenGL 3.2 can be opened");
    fit_screen(w->glfw);
    glfwMakeContextCurrent(w->glfw);
    glfwSwapInterval(1);
    set_callbacks(w);
    measure(w);
    w->pen = isosculpt_pen_open();
    w->screen.pen = isosculpt_pen_present(w->pen);
    ISO_TRY(open_engine(w, error));
    return isosculpt_panel_create(w->glfw, text_scale(w), &w->panel, error);
}

/* The window closes over it. */
static void abandon(window *w) {
    isosculpt_opened opened = {0};
    isosculpt_task_cancel(isosculpt_opening_task(w->opening));
    if (isosculpt_opening_finish(w->opening, &opened, NULL) == ISO_OK) isosculpt_opened_free(&opened);
}

static iso_status run(window *w, iso_error *error) {
    ISO_TRY(make_window(w, error));
    ISO_TRY(open_first(w, error));
    return loop(w, error);
}

iso_status isosculpt_window(const isosculpt_settings *settings, iso_pool *pool, iso_error *error) {
    window w = {.settings = settings, .pool = pool, .screen = {.hand = &w.hand, .panel = true, .pixels = 1}};
    w.desk.pool = pool;
    w.desk.undo_memory = (size_t)settings->undo_memory;
    if (!glfwInit()) return no_window(error, "no window system");
    iso_status status = run(&w, error);
    if (w.opening) abandon(&w);
    isosculpt_view_free(&w.view);
    isosculpt_desk_close(&w.desk);
    close_engine(&w);
    isosculpt_volume_free(w.volume);
    iso_pool_destroy(w.own_pool);
    isosculpt_panel_destroy(w.panel);
    isosculpt_pen_close(w.pen);
    glfwTerminate();
    return status;
}
