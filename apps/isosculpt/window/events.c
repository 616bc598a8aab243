/* GLFW's callbacks for isosculpt's window: mouse, keys, dropped files, size. */
#include "apps/isosculpt/window/events.h"

#include <ctype.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/commands.h"
#include "apps/isosculpt/window/opening.h"
#include "apps/isosculpt/window/reference.h"

static window *window_of(GLFWwindow *glfw) {
    return glfwGetWindowUserPointer(glfw);
}

static unsigned modifiers_of(int mods) {
    return (mods & GLFW_MOD_SHIFT ? ISOSCULPT_MODIFIER_SHIFT : 0u) |
           (mods & GLFW_MOD_CONTROL ? ISOSCULPT_MODIFIER_CTRL : 0u) |
           (mods & GLFW_MOD_ALT ? ISOSCULPT_MODIFIER_ALT : 0u);
}

static void on_move(GLFWwindow *glfw, double x, double y) {
    window *w = window_of(glfw);
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    if (w->controller.drag == ISOSCULPT_DRAG_BRUSH && isosculpt_pen_present(w->pen))
        w->controller.pressure = isosculpt_pen_pressure(w->pen);
    isosculpt_controller_move(&w->controller, x * w->screen.pixels - w->screen.picture_x,
                              y * w->screen.pixels);
}

/* Whether the panel or a dialog uses the pointer where the last event placed it. */
static bool panel_has_pointer(const window *w) {
    return isosculpt_panel_has_pointer(w->panel, (w->controller.x + w->screen.picture_x) / w->screen.pixels,
                                       w->controller.y / w->screen.pixels);
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods) {
    static const isosculpt_button buttons[] = {ISOSCULPT_BUTTON_LEFT, ISOSCULPT_BUTTON_RIGHT,
                                               ISOSCULPT_BUTTON_MIDDLE};
    window *w = window_of(glfw);
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    if (button < 0 || button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    const double x = w->controller.x,
                 y = w->controller.y; /* position of the last event: GLFW sends it before the button */
    if (action == GLFW_RELEASE)
        isosculpt_controller_release(&w->controller, buttons[button]);
    else if (!w->screen.blank && !panel_has_pointer(w)) {
        w->controller.pressure = isosculpt_pen_pressure(w->pen);
        w->screen.pen = isosculpt_pen_present(w->pen);
        isosculpt_controller_press(&w->controller, buttons[button], modifiers_of(mods), x, y);
    }
}

static void on_scroll(GLFWwindow *glfw, double dx, double dy) {
    (void)dx;
    window *w = window_of(glfw);
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    if (!w->screen.blank && !panel_has_pointer(w)) isosculpt_controller_scroll(&w->controller, dy);
}

/* Returns the isosculpt_key of a key in the current keyboard layout. Digits of the number pad choose a
 * side. */
static int translate_key(int key, int scancode) {
    static const struct {
        int key, meaning;
    } special[] = {{GLFW_KEY_KP_1, ISOSCULPT_KEY_FRONT},
                   {GLFW_KEY_KP_3, ISOSCULPT_KEY_RIGHT},
                   {GLFW_KEY_KP_7, ISOSCULPT_KEY_TOP},
                   {GLFW_KEY_ESCAPE, ISOSCULPT_KEY_ESCAPE},
                   {GLFW_KEY_DELETE, ISOSCULPT_KEY_DELETE},
                   {GLFW_KEY_KP_ADD, '+'},
                   {GLFW_KEY_KP_SUBTRACT, '-'},
                   {GLFW_KEY_LEFT, ISOSCULPT_KEY_ARROW_LEFT},
                   {GLFW_KEY_RIGHT, ISOSCULPT_KEY_ARROW_RIGHT},
                   {GLFW_KEY_UP, ISOSCULPT_KEY_ARROW_UP},
                   {GLFW_KEY_DOWN, ISOSCULPT_KEY_ARROW_DOWN}};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++)
        if (key == special[i].key) return special[i].meaning;
    if (key < 0 || key > 127) return 0;
    const char *name = glfwGetKeyName(key, scancode);
    const char c = name && name[0] && !name[1] ? name[0] : 0;
    if (isalpha((unsigned char)c) || c == '+' || c == '-') return tolower((unsigned char)c);
    return tolower(key); /* digits and brackets are recognised by their position on the keyboard */
}

/* Handles the request to close the window: asks first if there are unsaved changes; a second request closes
 * the window. */
static void request_close(window *w) {
    const bool ask = isosculpt_window_has_unsaved_changes(w) && !w->after_save &&
                     w->screen.dialog != ISOSCULPT_DIALOG_CLOSE;
    glfwSetWindowShouldClose(w->glfw, !ask);
    if (ask) w->screen.dialog = ISOSCULPT_DIALOG_CLOSE;
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
}

static void on_close(GLFWwindow *glfw) {
    request_close(window_of(glfw));
}

/* Changes between the cpu engine and the gl engine, if there is one. */
static void toggle_engine(window *w) {
    isosculpt_display_mode *mode = &w->viewport.mode;
    if (!w->gl) return;
    mode->engine = mode->engine == ISOSCULPT_ENGINE_GL ? ISOSCULPT_ENGINE_CPU : ISOSCULPT_ENGINE_GL;
    w->viewport.gl_error.text[0] = 0;
}

static void choose_next_method(isosculpt_display_mode *mode) {
    int i = 0;
    while (isosculpt_methods[i] != mode->method) i++;
    mode->method = isosculpt_methods[(i + 1) % ISOSCULPT_METHODS];
}

static void toggle_occlusion(isosculpt_viewport *viewport) {
    viewport->light.occlusion.ambient = !viewport->light.occlusion.ambient;
    viewport->style++;
}

/* Handles keys that change the display mode; returns whether the key is one of them. */
static bool change_display_mode(window *w, int key) {
    if (key == 'm')
        choose_next_method(&w->viewport.mode);
    else if (key == 'g')
        toggle_engine(w);
    else if (key == 'r')
        isosculpt_window_toggle_reference(w);
    else if (key == 'k' && !w->controller.drag)
        isosculpt_viewport_toggle_plane(&w->viewport);
    else if (key == 'o')
        toggle_occlusion(&w->viewport);
    else
        return false;
    w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
    return true;
}

/* Opens the first of the dropped files. */
static void on_drop(GLFWwindow *glfw, int count, const char **paths) {
    window *w = window_of(glfw);
    if (count < 1) return;
    if (w->screen.dialog || w->screen.browser.purpose) {
        isosculpt_window_set_status(w, true,
                                    "Something is asked: answer that first, then drop the file again.");
        return;
    }
    if (count > 1) isosculpt_window_set_status(w, false, "One file at a time: the first of them is taken.");
    isosculpt_window_drop(w, paths[0]);
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
}

/* Lets keys answer the dialog that is shown; returns whether there is one. Other keys are then ignored. */
static bool answer_dialog(window *w, int key, int meaning) {
    static const unsigned yes[] = {[ISOSCULPT_DIALOG_RECOVER] = ISOSCULPT_RESULT_RECOVER,
                                   [ISOSCULPT_DIALOG_CLOSE] =
                                       ISOSCULPT_RESULT_SAVE | ISOSCULPT_RESULT_PROCEED,
                                   [ISOSCULPT_DIALOG_OPEN] = ISOSCULPT_RESULT_SAVE | ISOSCULPT_RESULT_PROCEED,
                                   [ISOSCULPT_DIALOG_MESH] = ISOSCULPT_RESULT_OPEN,
                                   [ISOSCULPT_DIALOG_REPLACE] = ISOSCULPT_RESULT_REPLACE,
                                   [ISOSCULPT_DIALOG_NEW] = ISOSCULPT_RESULT_NEW};
    const isosculpt_dialog dialog = w->screen.dialog;
    if (!dialog) return false;
    if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER)
        isosculpt_window_handle_dialog_result(w, yes[dialog]);
    else if (key == GLFW_KEY_ESCAPE && dialog != ISOSCULPT_DIALOG_RECOVER)
        isosculpt_window_handle_dialog_result(w, ISOSCULPT_RESULT_KEEP);
    else if (meaning == 's' && dialog == ISOSCULPT_DIALOG_MESH)
        isosculpt_window_handle_dialog_result(w, ISOSCULPT_RESULT_STAMP);
    return true;
}

/* Handles Escape outside a stroke and without an open list: closes the help, else cancels a background task,
 * else dismisses the message, else selects no stroke. */
static void handle_escape(window *w) {
    if (w->screen.help)
        w->screen.help = false;
    else if (w->screen.progress_item_count)
        w->screen.results |= ISOSCULPT_RESULT_CANCEL;
    else if (w->screen.message[0])
        w->screen.message[0] = 0;
    else
        isosculpt_stroke_editor_select(&w->document.strokes, 0, 0);
}

/* Records keys for input boxes (isosculpt_typed). */
static void record_typed(isosculpt_typed *typed, int key) {
    typed->enter |= key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER;
    typed->escape |= key == GLFW_KEY_ESCAPE;
    typed->back |= key == GLFW_KEY_BACKSPACE;
    typed->steps += (key == GLFW_KEY_DOWN) - (key == GLFW_KEY_UP);
    typed->steps += 10 * ((key == GLFW_KEY_PAGE_DOWN) - (key == GLFW_KEY_PAGE_UP));
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int mods) {
    window *w = window_of(glfw);
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    const int meaning = translate_key(key, scancode);
    if (action == GLFW_RELEASE) {
        isosculpt_controller_key(&w->controller, meaning, modifiers_of(mods), false);
        return;
    }
    if (action == GLFW_PRESS && key == GLFW_KEY_F12)
        *(mods & GLFW_MOD_SHIFT ? &w->screenshot_window : &w->screenshot) = true;
    if (key == GLFW_KEY_ESCAPE && isosculpt_panel_close_list(w->panel)) return;
    if (answer_dialog(w, key, meaning)) return;
    if (w->screen.browser.purpose || isosculpt_panel_has_keys()) {
        record_typed(&w->screen.browser.typed, key);
        return;
    }
    if (key == GLFW_KEY_ESCAPE && !isosculpt_controller_is_drawing(&w->controller)) handle_escape(w);
    if (action == GLFW_PRESS && key == GLFW_KEY_TAB) w->screen.panel = !w->screen.panel;
    if (action == GLFW_PRESS && meaning == 'h') w->screen.help = !w->screen.help;
    if (action == GLFW_PRESS && !(mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT)) &&
        change_display_mode(w, meaning))
        return;
    if (!w->screen.blank || meaning == 'q')
        isosculpt_controller_key(&w->controller, meaning, modifiers_of(mods), true);
    if (w->controller.commands & ISOSCULPT_COMMAND_CLOSE) request_close(w);
    w->controller.commands &= ~(unsigned)ISOSCULPT_COMMAND_CLOSE;
}

static void on_refresh(GLFWwindow *glfw) {
    window_of(glfw)->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
}

static void on_size(GLFWwindow *glfw, int width, int height) {
    window *w = window_of(glfw);
    (void)width;
    (void)height;
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
}

/* Handles a change of the content scale: text and panel are adapted when the next frame is drawn. */
static void on_scale(GLFWwindow *glfw, float x, float y) {
    (void)x, (void)y;
    on_refresh(glfw);
}

void isosculpt_window_install_callbacks(window *w) {
    glfwSetWindowUserPointer(w->glfw, w);
    glfwSetCursorPosCallback(w->glfw, on_move);
    glfwSetMouseButtonCallback(w->glfw, on_button);
    glfwSetScrollCallback(w->glfw, on_scroll);
    glfwSetKeyCallback(w->glfw, on_key);
    glfwSetWindowCloseCallback(w->glfw, on_close);
    glfwSetWindowRefreshCallback(w->glfw, on_refresh);
    glfwSetFramebufferSizeCallback(w->glfw, on_size);
    glfwSetDropCallback(w->glfw, on_drop);
    glfwSetWindowContentScaleCallback(w->glfw, on_scale);
}
