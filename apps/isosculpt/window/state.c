/* The state of isosculpt's window: status messages, sizes and the pointer. */
#include "apps/isosculpt/window/state.h"
#include "base/clock.h"

#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

/* Shows a message. An error is printed only once, because a stroke can fail at every sample. */
void isosculpt_window_set_status(window *w, bool is_error, const char *text) {
    if (is_error && strcmp(w->screen.message, text)) iso_program_log(isosculpt_program(), "%s", text);
    snprintf(w->screen.message, sizeof w->screen.message, "%s", text);
    w->screen.message_is_error = is_error;
    w->screen.message_seconds = iso_clock_seconds();
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
}

void isosculpt_window_update_framebuffer_size(window *w) {
    int width, height;
    glfwGetWindowSize(w->glfw, &width, &height);
    glfwGetFramebufferSize(w->glfw, &w->screen.width, &w->screen.height);
    w->screen.pixels = width > 0 ? (double)w->screen.width / width : 1;
}

/* Returns the pixels of a window coordinate: the content scale divided by the scale that the window system
 * applies itself. */
double isosculpt_window_text_scale(const window *w) {
    float x = 1, y = 1;
    glfwGetWindowContentScale(w->glfw, &x, &y);
    const double scale = (double)x / w->screen.pixels;
    return scale > 0.5 && scale < 8 ? scale : 1;
}

void isosculpt_window_sync_pointer(window *w) {
    double x, y;
    glfwGetCursorPos(w->glfw, &x, &y);
    w->controller.x = x * w->screen.pixels;
    w->controller.y = y * w->screen.pixels;
}

bool isosculpt_window_has_unsaved_changes(const window *w) {
    return w->document.change_count != w->document.saved_change_count;
}

void isosculpt_window_show_dialog(window *w, isosculpt_dialog dialog, const char *path) {
    snprintf(w->screen.dialog_path, sizeof w->screen.dialog_path, "%s", path);
    w->screen.dialog = dialog;
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
}

void isosculpt_window_wake(void) {
    glfwPostEmptyEvent();
}
