/* The window of isosculpt: created with GLFW, run in a loop, and closed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/backdrop.h"
#include "apps/isosculpt/window/commands.h"
#include "apps/isosculpt/window/events.h"
#include "apps/isosculpt/window/opening.h"
#include "apps/isosculpt/window/picture.h"
#include "apps/isosculpt/window/reference.h"
#include "base/clock.h"

enum { WIDTH = 1280, HEIGHT = 800 };

/* ---- the loop */

static void wait_events(window *w) {
    double wait = fmin(isosculpt_window_seconds_until_refine(w), ISOSCULPT_IDLE_SECONDS);
    if (w->screen.progress_item_count) wait = fmin(wait, 0.05);
    if (w->frames_left > 0 || w->controller.commands || w->screen.results || w->screen.browse_request ||
        wait <= 0) {
        glfwPollEvents();
        return;
    }
    double start = iso_clock_seconds();
    glfwWaitEventsTimeout(wait);
    if (iso_clock_seconds() - start > 0.9 * ISOSCULPT_IDLE_SECONDS)
        w->frames_left = 1; /* the state of the journal may have changed */
}

static iso_status run_loop(window *w, iso_error *error) {
    while (!glfwWindowShouldClose(w->glfw)) {
        isosculpt_window_show_progress(w);
        isosculpt_window_update_title(w);
        isosculpt_window_remember_look(w);
        isosculpt_window_keep_backdrop(w);
        ISO_TRY(isosculpt_window_draw(w, error));
        wait_events(w);
        ISO_TRY(isosculpt_window_process_commands(w, error));
    }
    return ISO_OK;
}

/* ---- creating and closing */

static iso_status fail_window(iso_error *error, const char *what) {
    const char *reason = NULL;
    glfwGetError(&reason);
    return iso_fail(error, ISO_ERR_BACKEND, "%s: %s; without a window: --replay FILE --headless", what,
                    reason ? reason : "no reason is given");
}

/* Creates the window and its context. The gl engine needs OpenGL 4.5, the panel 3.2. */
static GLFWwindow *create_window(int width, int height) {
    static const int versions[][2] = {{4, 5}, {3, 2}};
    GLFWwindow *created = NULL;
    for (int i = 0; i < 2 && !created; i++) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, versions[i][0]);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, versions[i][1]);
        created = glfwCreateWindow(width, height, "isosculpt", NULL, NULL);
    }
    return created;
}

static void make_current(void *glfw) {
    if (glfwGetCurrentContext() != glfw) glfwMakeContextCurrent(glfw);
}

/* Opens the gl engine. Without OpenGL 4.5 the cpu engine draws; with --backend gl this is an error. */
static iso_status open_engine(window *w, iso_error *error) {
    const isosculpt_backend backend = (isosculpt_backend)w->settings->backend;
    const iso_gl_context_opts opts = {.kind = ISO_GL_WINDOW,
                                      .window = {w->glfw, make_current, glfwGetProcAddress}};
    iso_status status = iso_gl_context_create(&opts, &w->context, error);
    if (status == ISO_OK) status = isosculpt_gl_create(w->context, &w->gl, error);
    if (status != ISO_OK && backend == ISOSCULPT_BACKEND_GL) return status;
    const bool use_gl = backend == ISOSCULPT_BACKEND_GL || (backend == ISOSCULPT_BACKEND_AUTO && w->gl &&
                                                            iso_gl_context_info(w->context).hardware);
    w->engine = use_gl ? ISOSCULPT_ENGINE_GL : ISOSCULPT_ENGINE_CPU;
    return ISO_OK;
}

/* Closes the gl engine and prints the driver's messages; with ISO_GL_DEBUG the driver checks all calls. */
static void close_engine(window *w) {
    isosculpt_gl_destroy(w->gl);
    if (w->context && getenv("ISO_GL_DEBUG")) {
        iso_gl_messages messages = iso_gl_context_messages(w->context);
        fprintf(stderr, "isosculpt: OpenGL: %zu messages. %s\n", messages.count, messages.first);
    }
    iso_gl_context_destroy(w->context);
}

/* Makes the window no larger than the screen, because the content scale may have enlarged it. */
static void fit_to_screen(GLFWwindow *glfw) {
    int width, height, x, y, room_x = 0, room_y = 0;
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    if (monitor) glfwGetMonitorWorkarea(monitor, &x, &y, &room_x, &room_y);
    glfwGetWindowSize(glfw, &width, &height);
    const int fit_x = room_x > 0 && room_x < width ? room_x : width,
              fit_y = room_y > 0 && room_y < height ? room_y : height;
    if (fit_x < width || fit_y < height) glfwSetWindowSize(glfw, fit_x, fit_y);
}

static iso_status open_window(window *w, iso_error *error) {
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    if (getenv("ISO_GL_DEBUG")) glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    w->glfw = create_window(WIDTH, HEIGHT);
    if (!w->glfw) return fail_window(error, "no window with OpenGL 3.2 can be opened");
    fit_to_screen(w->glfw);
    glfwMakeContextCurrent(w->glfw);
    glfwSwapInterval(1);
    isosculpt_window_install_callbacks(w);
    isosculpt_window_update_framebuffer_size(w);
    w->pen = isosculpt_pen_open();
    w->screen.pen = isosculpt_pen_present(w->pen);
    ISO_TRY(open_engine(w, error));
    return isosculpt_panel_create(w->glfw, isosculpt_window_text_scale(w), w->settings->font, &w->panel,
                                  error);
}

static iso_status run_window(window *w, iso_error *error) {
    ISO_TRY(open_window(w, error));
    ISO_TRY(isosculpt_window_open_first(w, error));
    return run_loop(w, error);
}

iso_status isosculpt_window(const isosculpt_settings *settings, iso_pool *pool, iso_error *error) {
    window w = {.settings = settings,
                .pool = pool,
                .screen = {.controller = &w.controller,
                           .asked = {.solid = {ISO_SOLID_SPHERE, {80, 80, 80}, 0}},
                           .panel = true,
                           .pixels = 1,
                           .references = &settings->references}};
    w.screen.backdrop = &w.backdrop;
    w.document.pool = pool;
    w.document.undo_memory = (size_t)settings->undo_memory;
    if (!glfwInit()) return fail_window(error, "no window system");
    iso_status status = run_window(&w, error);
    if (w.load_job) isosculpt_window_cancel_load(&w);
    isosculpt_window_cancel_reference(&w);
    isosculpt_controller_free(&w.controller);
    isosculpt_browser_close(&w.screen.browser);
    isosculpt_viewport_free(&w.viewport);
    isosculpt_backdrop_free(&w.backdrop);
    isosculpt_document_close(&w.document);
    close_engine(&w);
    iso_source_volume_free(w.volume);
    isosculpt_opened_scene_free(&w.scene);
    iso_pool_destroy(w.own_pool);
    isosculpt_panel_destroy(w.panel);
    isosculpt_pen_close(w.pen);
    glfwTerminate();
    return status;
}
