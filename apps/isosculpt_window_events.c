/* Mouse, keys and drops of isosculpt's window. */
#include <ctype.h>
#include <stdio.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt_window.h"

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
    if (w->hand.drag == ISOSCULPT_DRAG_BRUSH && isosculpt_pen_present(w->pen))
        w->hand.pressure = isosculpt_pen_pressure(w->pen);
    isosculpt_hand_move(&w->hand, x * w->screen.pixels, y * w->screen.pixels);
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods) {
    static const isosculpt_button buttons[] = {ISOSCULPT_LEFT, ISOSCULPT_RIGHT, ISOSCULPT_MIDDLE};
    window *w = of(glfw);
    w->frames = ISOSCULPT_FRAMES;
    if (button < 0 || button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    isosculpt_window_point(w); /* one that was there before the window has sent no position */
    const double x = w->hand.x, y = w->hand.y;
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
    w->frames = ISOSCULPT_FRAMES;
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
    w->frames = ISOSCULPT_FRAMES;
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
    w->frames = ISOSCULPT_FRAMES;
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
    w->frames = ISOSCULPT_FRAMES;
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
    of(glfw)->frames = ISOSCULPT_FRAMES;
}

static void on_size(GLFWwindow *glfw, int width, int height) {
    window *w = of(glfw);
    (void)width;
    (void)height;
    w->frames = ISOSCULPT_FRAMES;
    w->hand.wishes |= ISOSCULPT_WISH_PICTURE;
}

void isosculpt_window_listen(window *w) {
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
