/* The window of isosculpt: GLFW, its loop and its life. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/window.h"

#include "base/clock.h"

enum { WIDTH = 1280, HEIGHT = 800 };

/* To those who watch the terminal, too, but once: a stroke can go wrong at every sample. */
void isosculpt_window_set_status(window *w, bool bad, const char *text) {
    if (bad && strcmp(w->screen.message, text)) iso_program_log(isosculpt_program(), "%s", text);
    snprintf(w->screen.message, sizeof w->screen.message, "%s", text);
    w->screen.message_is_bad = bad;
    w->screen.said = iso_clock_seconds();
    w->frames = ISOSCULPT_FRAMES;
}

void isosculpt_window_update_framebuffer_size(window *w) {
    int width, height;
    glfwGetWindowSize(w->glfw, &width, &height);
    glfwGetFramebufferSize(w->glfw, &w->screen.width, &w->screen.height);
    w->screen.pixels = width > 0 ? (double)w->screen.width / width : 1;
}

/* The content scale in window coordinates: where those are no pixels, the system scales already. */
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

/* ---- the loop */

static void wait_events(window *w) {
    double wait = fmin(isosculpt_window_seconds_until_refine(w), ISOSCULPT_IDLE);
    if (w->screen.progress_item_count) wait = fmin(wait, 0.05);
    if (w->frames > 0 || w->controller.commands || w->screen.results || w->screen.browse || wait <= 0) {
        glfwPollEvents();
        return;
    }
    double start = iso_clock_seconds();
    glfwWaitEventsTimeout(wait);
    if (iso_clock_seconds() - start > 0.9 * ISOSCULPT_IDLE)
        w->frames = 1; /* the journal's state may have changed */
}

static iso_status loop(window *w, iso_error *error) {
    while (!glfwWindowShouldClose(w->glfw)) {
        isosculpt_window_show_progress(w);
        ISO_TRY(isosculpt_window_draw(w, error));
        wait_events(w);
        isosculpt_window_poll_save(w);
        ISO_TRY(isosculpt_window_process_commands(w, error));
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

/* The panel does with less than the gl engine. */
static GLFWwindow *create_window(int width, int height) {
    static const int versions[][2] = {{4, 5}, {3, 2}};
    GLFWwindow *surface_isovalue = NULL;
    for (int i = 0; i < 2 && !surface_isovalue; i++) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, versions[i][0]);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, versions[i][1]);
        surface_isovalue = glfwCreateWindow(width, height, "isosculpt", NULL, NULL);
    }
    return surface_isovalue;
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
    isosculpt_window_install_callbacks(w);
    isosculpt_window_update_framebuffer_size(w);
    w->pen = isosculpt_pen_open();
    w->screen.pen = isosculpt_pen_present(w->pen);
    ISO_TRY(open_engine(w, error));
    return isosculpt_panel_create(w->glfw, isosculpt_window_text_scale(w), &w->panel, error);
}

static iso_status run(window *w, iso_error *error) {
    ISO_TRY(make_window(w, error));
    ISO_TRY(isosculpt_window_open(w, error));
    return loop(w, error);
}

iso_status isosculpt_window(const isosculpt_settings *settings, iso_pool *pool, iso_error *error) {
    window w = {.settings = settings,
                .pool = pool,
                .screen = {.controller = &w.controller, .panel = true, .pixels = 1}};
    w.document.pool = pool;
    w.document.undo_memory = (size_t)settings->undo_memory;
    if (!glfwInit()) return no_window(error, "no window system");
    iso_status status = run(&w, error);
    if (w.load_job) isosculpt_window_cancel_load(&w);
    isosculpt_controller_free(&w.controller);
    isosculpt_browser_close(&w.screen.browser);
    isosculpt_view_free(&w.view);
    isosculpt_document_close(&w.document);
    close_engine(&w);
    isosculpt_volume_free(w.volume);
    iso_pool_destroy(w.own_pool);
    isosculpt_panel_destroy(w.panel);
    isosculpt_pen_close(w.pen);
    glfwTerminate();
    return status;
}
