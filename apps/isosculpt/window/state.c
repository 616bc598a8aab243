/* The state of isosculpt's window: status messages, sizes and the pointer. */
#include "apps/isosculpt/window/state.h"
#include "apps/isosculpt/look.h"
#include "base/clock.h"

#include <math.h>
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

/* Places the picture in what the panel leaves free. In a narrow window the panel covers a part of the
 * picture. While the pointer is dragged the picture stays where it is. */
static void place_picture(window *w) {
    isosculpt_screen *screen = &w->screen;
    const int before = screen->picture_x, width = screen->picture_width,
              panel = (int)ceil(isosculpt_panel_width(w->panel) * screen->pixels);
    if (w->controller.drag && screen->picture_width > 0) return;
    screen->picture_x = screen->panel && !screen->blank && 2 * panel <= screen->width ? panel : 0;
    screen->picture_width = screen->width - screen->picture_x;
    w->controller.x += before - screen->picture_x;
    if (screen->picture_width != width) w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
}

void isosculpt_window_update_framebuffer_size(window *w) {
    int width, height;
    glfwGetWindowSize(w->glfw, &width, &height);
    glfwGetFramebufferSize(w->glfw, &w->screen.width, &w->screen.height);
    w->screen.pixels = width > 0 ? (double)w->screen.width / width : 1;
    place_picture(w);
}

/* Returns --scale, or the content scale divided by the scale that the window system applies itself. */
double isosculpt_window_text_scale(const window *w) {
    float x = 1, y = 1;
    if (w->settings->scale > 0) return w->settings->scale;
    glfwGetWindowContentScale(w->glfw, &x, &y);
    const double scale = (double)x / w->screen.pixels;
    return scale > 0.5 && scale < 8 ? scale : 1;
}

void isosculpt_window_sync_pointer(window *w) {
    double x, y;
    glfwGetCursorPos(w->glfw, &x, &y);
    w->controller.x = x * w->screen.pixels - w->screen.picture_x;
    w->controller.y = y * w->screen.pixels;
}

/* The file that holds what the window shows: the viewed volume, the file that it was saved to, the stroke
 * file that was opened, or the file that the session began with; "": there is none. */
static const char *shown_path(const window *w) {
    const isosculpt_document *document = &w->document;
    const size_t folder = strlen(w->folder);
    const bool own_journal = w->has_folder && strncmp(document->journal, w->folder, folder) == 0 &&
                             document->journal[folder] == '/';
    if (w->volume) return w->volume->path;
    if (document->target_was_saved) return document->target;
    if (document->journal[0] && !own_journal) return document->journal;
    return strchr(document->start.source, '/') ? document->start.source : "";
}

void isosculpt_window_update_title(window *w) {
    char title[sizeof w->title];
    const char *path = shown_path(w), *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    if (w->screen.blank)
        snprintf(title, sizeof title, "isosculpt");
    else
        snprintf(title, sizeof title, "isosculpt: %s%s", name[0] ? name : "new ball",
                 isosculpt_window_has_unsaved_changes(w) ? "*" : "");
    if (strcmp(title, w->title) == 0) return;
    memcpy(w->title, title, sizeof title);
    glfwSetWindowTitle(w->glfw, title);
}

void isosculpt_window_remember_look(window *w) {
    char look[ISOSCULPT_LOOK];
    if (w->screen.blank || w->volume) return;
    isosculpt_look_write(&w->controller, look);
    if (strcmp(look, w->document.look) == 0) return;
    memcpy(w->document.look, look, sizeof look);
    isosculpt_document_remember(&w->document);
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
