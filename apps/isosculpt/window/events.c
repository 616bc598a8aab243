/* Mouse, keys and drops of isosculpt's window. */
#include <ctype.h>
#include <stdio.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/window.h"

static window *of(GLFWwindow *glfw) {
    return glfwGetWindowUserPointer(glfw);
}

static unsigned modifiers(int mods) {
    return (mods & GLFW_MOD_SHIFT ? ISOSCULPT_SHIFT : 0u) | (mods & GLFW_MOD_CONTROL ? ISOSCULPT_CTRL : 0u) |
           (mods & GLFW_MOD_ALT ? ISOSCULPT_ALT : 0u);
}

static void on_move(GLFWwindow *glfw, double x, double y) {
    window *w = of(glfw);
    w->frames = ISOSCULPT_FRAMES;
    if (w->controller.drag == ISOSCULPT_DRAG_BRUSH && isosculpt_pen_present(w->pen))
        w->controller.pressure = isosculpt_pen_pressure(w->pen);
    isosculpt_controller_move(&w->controller, x * w->screen.pixels, y * w->screen.pixels);
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods) {
    static const isosculpt_button buttons[] = {ISOSCULPT_LEFT, ISOSCULPT_RIGHT, ISOSCULPT_MIDDLE};
    window *w = of(glfw);
    w->frames = ISOSCULPT_FRAMES;
    if (button < 0 || button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    const double x = w->controller.x,
                 y = w->controller.y; /* of the last event: GLFW sends the position first */
    if (action == GLFW_RELEASE)
        isosculpt_controller_release(&w->controller, buttons[button]);
    else if (!w->screen.blank &&
             !isosculpt_panel_has_pointer(w->panel, x / w->screen.pixels, y / w->screen.pixels)) {
        w->controller.pressure = isosculpt_pen_pressure(w->pen);
        w->screen.pen = isosculpt_pen_present(w->pen);
        isosculpt_controller_press(&w->controller, buttons[button], modifiers(mods), x, y);
    }
}

static void on_scroll(GLFWwindow *glfw, double dx, double dy) {
    (void)dx;
    window *w = of(glfw);
    w->frames = ISOSCULPT_FRAMES;
    double pixels = w->screen.pixels;
    if (!w->screen.blank &&
        !isosculpt_panel_has_pointer(w->panel, w->controller.x / pixels, w->controller.y / pixels))
        isosculpt_controller_scroll(&w->controller, dy);
}

/* What a key stands for on this keyboard; the number pad's digits are views. */
static int key_of(int key, int scancode) {
    static const struct {
        int key, meaning;
    } special[] = {{GLFW_KEY_KP_1, ISOSCULPT_KEY_FRONT},
                   {GLFW_KEY_KP_3, ISOSCULPT_KEY_RIGHT},
                   {GLFW_KEY_KP_7, ISOSCULPT_KEY_TOP},
                   {GLFW_KEY_ESCAPE, ISOSCULPT_KEY_ESCAPE},
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
    return tolower(key); /* digits and brackets by their place */
}

/* A window closed over unsaved changes asks first, and closes when it is closed again. */
static void want_close(window *w) {
    const bool ask =
        isosculpt_window_has_unsaved_changes(w) && !w->leaving && w->screen.dialog != ISOSCULPT_DIALOG_CLOSE;
    glfwSetWindowShouldClose(w->glfw, !ask);
    if (ask) w->screen.dialog = ISOSCULPT_DIALOG_CLOSE;
    w->frames = ISOSCULPT_FRAMES;
}

static void on_close(GLFWwindow *glfw) {
    want_close(of(glfw));
}

/* The gl engine, where there is one, and the cpu engine. */
static void change_engine(window *w) {
    isosculpt_display_mode *mode = &w->view.mode;
    if (!w->gl) return;
    mode->engine = mode->engine == ISOSCULPT_GL ? ISOSCULPT_CPU : ISOSCULPT_GL;
    w->view.gl_error.text[0] = 0;
}

/* Keys that change how it looks. */
static bool change_look(window *w, int meant) {
    isosculpt_display_mode *mode = &w->view.mode;
    if (meant == 'm')
        mode->method = (isosculpt_method)((mode->method + 1) % ISOSCULPT_METHOD_COUNT);
    else if (meant == 'g')
        change_engine(w);
    else
        return false;
    w->controller.commands |= ISOSCULPT_COMMAND_PICTURE;
    return true;
}

/* What was dropped on the window, of several the first. */
static void on_drop(GLFWwindow *glfw, int count, const char **paths) {
    window *w = of(glfw);
    if (count < 1) return;
    if (w->screen.dialog || w->screen.browser.purpose) {
        isosculpt_window_set_status(w, true,
                                    "Something is asked: answer that first, then drop the file again.");
        return;
    }
    if (count > 1) isosculpt_window_set_status(w, false, "One file at a time: the first of them is taken.");
    isosculpt_window_drop(w, paths[0]);
    w->frames = ISOSCULPT_FRAMES;
}

/* While a question is asked keys answer it and do nothing else. */
static bool answer(window *w, int key, int meant) {
    static const unsigned yes[] = {[ISOSCULPT_DIALOG_RECOVER] = ISOSCULPT_RESULT_RECOVER,
                                   [ISOSCULPT_DIALOG_CLOSE] = ISOSCULPT_RESULT_SAVE | ISOSCULPT_RESULT_LEAVE,
                                   [ISOSCULPT_DIALOG_OPEN] = ISOSCULPT_RESULT_SAVE | ISOSCULPT_RESULT_LEAVE,
                                   [ISOSCULPT_DIALOG_MESH] = ISOSCULPT_RESULT_OPEN,
                                   [ISOSCULPT_DIALOG_REPLACE] = ISOSCULPT_RESULT_REPLACE};
    const isosculpt_dialog dialog = w->screen.dialog;
    if (!dialog) return false;
    if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER)
        isosculpt_window_handle_dialog_result(w, yes[dialog]);
    else if (key == GLFW_KEY_ESCAPE && dialog != ISOSCULPT_DIALOG_RECOVER)
        isosculpt_window_handle_dialog_result(w, ISOSCULPT_RESULT_STAY);
    else if (meant == 's' && dialog == ISOSCULPT_DIALOG_MESH)
        isosculpt_window_handle_dialog_result(w, ISOSCULPT_RESULT_STAMP);
    return true;
}

/* What is not a stroke: the sheet of help, then heavy work, then what was said. */
static void escape(window *w) {
    if (w->screen.help)
        w->screen.help = false;
    else if (w->screen.progress_item_count)
        w->screen.results |= ISOSCULPT_RESULT_CANCEL;
    else
        w->screen.message[0] = 0;
}

/* For the boxes that names are typed into. */
static void note_typed(isosculpt_typed *typed, int key) {
    typed->enter |= key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER;
    typed->escape |= key == GLFW_KEY_ESCAPE;
    typed->back |= key == GLFW_KEY_BACKSPACE;
    typed->steps += (key == GLFW_KEY_DOWN) - (key == GLFW_KEY_UP);
    typed->steps += 10 * ((key == GLFW_KEY_PAGE_DOWN) - (key == GLFW_KEY_PAGE_UP));
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int mods) {
    window *w = of(glfw);
    w->frames = ISOSCULPT_FRAMES;
    int meant = key_of(key, scancode);
    if (action == GLFW_RELEASE) {
        isosculpt_controller_key(&w->controller, meant, modifiers(mods), false);
        return;
    }
    if (action == GLFW_PRESS && key == GLFW_KEY_F12)
        *(mods & GLFW_MOD_SHIFT ? &w->screenshot_all : &w->screenshot) = true;
    if (answer(w, key, meant)) return;
    if (w->screen.browser.purpose || isosculpt_panel_has_keys()) {
        note_typed(&w->screen.browser.typed, key);
        return;
    }
    if (key == GLFW_KEY_ESCAPE && w->controller.drag != ISOSCULPT_DRAG_BRUSH) escape(w);
    if (action == GLFW_PRESS && key == GLFW_KEY_TAB) w->screen.panel = !w->screen.panel;
    if (action == GLFW_PRESS && meant == 'h') w->screen.help = !w->screen.help;
    if (action == GLFW_PRESS && !(mods & GLFW_MOD_CONTROL) && change_look(w, meant)) return;
    if (!w->screen.blank || meant == 'q')
        isosculpt_controller_key(&w->controller, meant, modifiers(mods), true);
    if (w->controller.commands & ISOSCULPT_COMMAND_CLOSE) want_close(w);
    w->controller.commands &= ~(unsigned)ISOSCULPT_COMMAND_CLOSE;
}

static void on_refresh(GLFWwindow *glfw) {
    of(glfw)->frames = ISOSCULPT_FRAMES;
}

static void on_size(GLFWwindow *glfw, int width, int height) {
    window *w = of(glfw);
    (void)width;
    (void)height;
    w->frames = ISOSCULPT_FRAMES;
    w->controller.commands |= ISOSCULPT_COMMAND_PICTURE;
}

/* Another screen, or the same one with other settings: text and panel follow when they are drawn. */
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
