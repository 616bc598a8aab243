/* The picture in isosculpt's window: when it is drawn, in which quality, and screenshots. */
#include "apps/isosculpt/window/picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/saving.h"
#include "base/clock.h"
#include "base/file_types.h"

#ifndef GL_CLAMP_TO_EDGE
#define GL_CLAMP_TO_EDGE 0x812F /* OpenGL 1.2 */
#endif

/* Seconds without a change after which the picture is drawn in each quality. */
static const double PAUSE[] = {[ISOSCULPT_QUALITY_REST] = 0.12, [ISOSCULPT_QUALITY_FINE] = 0.25};

/* Seconds for which a message is shown. */
static const double MESSAGE_SECONDS = 6;

/* ---- screenshots */

/* The chosen name, or the first unused one (target-1.png, ...) beside the target. */
static bool name_screenshot(window *w, char path[ISOSCULPT_PATH]) {
    char ending[32];
    memcpy(path, w->screenshot_path, ISOSCULPT_PATH);
    w->screenshot_path[0] = 0;
    if (path[0]) return true;
    for (int number = 1; number < 10000; number++) {
        snprintf(ending, sizeof ending, "-%d.png", number);
        if (isosculpt_path_with_ending(w->document.target, ending, path) && access(path, F_OK)) return true;
    }
    return false;
}

/* Writes the picture, with its scene where isorender can draw it, or the scene alone. */
static iso_status write_shown(const window *w, const char *path, const iso_image *image, iso_error *error) {
    isosculpt_render_command command;
    isosculpt_render_options options;
    char *scene = NULL;
    const bool drawable = image == &w->viewport.image && isosculpt_window_render_command(w, &command) &&
                          isosculpt_render_options_make(&command, &options);
    const bool alone = iso_file_type_of_name(path, ISO_HOLDS_SCENE) == ISO_FILE_json;
    if (alone && !drawable)
        return iso_fail(error, ISO_ERR_USAGE,
                        "a scene names a file: save the sculpture as .vdb first, then the scene");
    iso_scene_record record = {0};
    if (drawable) record = isosculpt_render_record(&command, &options);
    if (alone) return iso_scene_json_save(&record, path, error);
    if (drawable) ISO_TRY(iso_scene_json_text(&record, &scene, error));
    const iso_png_text texts[] = {{"Software", "isosculpt"}, {"Scene", scene}};
    const iso_png_opts opts = {.texts = texts, .text_count = scene ? 2 : 1, .pool = w->pool};
    const iso_status status = iso_png_write_with(path, image, &opts, error);
    free(scene);
    return status;
}

static void write_screenshot(window *w, const iso_image *image) {
    char path[ISOSCULPT_PATH], text[sizeof w->screen.message];
    iso_error reason = {0};
    const bool named = name_screenshot(w, path),
               written = named && write_shown(w, path, image, &reason) == ISO_OK;
    snprintf(text, sizeof text, "%s%.500s", written ? "Picture: " : "No picture: ",
             written ? path
             : named ? reason.text
                     : "there is no free name");
    isosculpt_window_set_status(w, !written, text);
}

/* Saves the framebuffer, with the panel; OpenGL's first row is the lowest. */
static void save_framebuffer(window *w) {
    iso_image image;
    int width = w->screen.width, height = w->screen.height;
    if (iso_image_create(width, height, &image, NULL) != ISO_OK) return;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int row = 0; row < height; row++)
        glReadPixels(0, height - 1 - row, width, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                     image.rgba + (size_t)row * (size_t)width * 4);
    for (size_t i = 3; i < (size_t)width * (size_t)height * 4; i += 4) image.rgba[i] = 255;
    write_screenshot(w, &image);
    iso_image_free(&image);
}

/* ---- drawing */

static void make_texture(window *w) {
    const iso_image *image = &w->viewport.image;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, image->width, image->height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image->rgba);
    w->texture_width = image->width;
    w->texture_height = image->height;
}

/* Brings the texture up to date with the picture: the canvas of OpenGL, or the pixels that were redrawn. */
static void update_texture(window *w) {
    const iso_image *image = &w->viewport.image;
    const isosculpt_damage *redrawn = &w->viewport.redrawn;
    if (w->viewport.drawn.canvas) {
        w->screen.texture = iso_gl_canvas_texture(w->viewport.drawn.canvas);
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
    for (int i = 0; i < redrawn->count; i++) {
        isosculpt_rectangle r = redrawn->rectangle[i];
        glTexSubImage2D(GL_TEXTURE_2D, 0, r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0, GL_RGBA, GL_UNSIGNED_BYTE,
                        image->rgba + ((size_t)r.y0 * (size_t)image->width + (size_t)r.x0) * 4);
    }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

double isosculpt_window_seconds_until_refine(const window *w) {
    if (w->screen.blank || w->viewport.quality == ISOSCULPT_QUALITY_FINE) return ISOSCULPT_IDLE_SECONDS;
    if (isosculpt_viewport_is_preparing(&w->viewport))
        return ISOSCULPT_IDLE_SECONDS; /* the background thread wakes the loop */
    return w->screenshot ? -1 : w->last_change + PAUSE[w->viewport.quality + 1] - iso_clock_seconds();
}

/* Draws the picture in the next better quality. */
static iso_status improve_picture(window *w, iso_error *error) {
    if (w->viewport.quality == ISOSCULPT_QUALITY_REST) return isosculpt_viewport_refine(&w->viewport, error);
    return isosculpt_viewport_draw(&w->viewport, w->screen.picture_width, w->screen.height, false, error);
}

/* Draws the picture again if it has changed, or improves it after a pause. */
static iso_status draw_picture(window *w, iso_error *error) {
    if (w->screen.blank) w->controller.commands &= ~(unsigned)ISOSCULPT_COMMAND_REDRAW;
    if (w->screen.blank) return ISO_OK;
    if (w->controller.commands & ISOSCULPT_COMMAND_REDRAW) {
        w->controller.commands &= ~(unsigned)ISOSCULPT_COMMAND_REDRAW;
        w->last_change = iso_clock_seconds();
        ISO_TRY(
            isosculpt_viewport_draw(&w->viewport, w->screen.picture_width, w->screen.height, true, error));
    } else if (isosculpt_window_seconds_until_refine(w) >= 0)
        return ISO_OK;
    else if (isosculpt_viewport_is_ready(&w->viewport))
        ISO_TRY(improve_picture(w, error));
    else
        return isosculpt_viewport_prepare(&w->viewport, isosculpt_window_wake, error);
    update_texture(w);
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    return ISO_OK;
}

static iso_status update_picture(window *w, iso_error *error) {
    ISO_TRY(draw_picture(w, error));
    if (!w->screenshot || w->viewport.quality != ISOSCULPT_QUALITY_FINE || w->screen.blank) return ISO_OK;
    w->screenshot = false;
    iso_error reason = {0};
    if (isosculpt_viewport_read_back(&w->viewport, &reason) == ISO_OK)
        write_screenshot(w, &w->viewport.image);
    else
        isosculpt_window_set_status(w, true, reason.text);
    return ISO_OK;
}

iso_status isosculpt_window_draw(window *w, iso_error *error) {
    isosculpt_window_update_framebuffer_size(w);
    if (w->screen.width <= 0 || w->screen.height <= 0) return ISO_OK; /* the window is iconified */
    ISO_TRY(isosculpt_panel_rescale(w->panel, isosculpt_window_text_scale(w), error));
    w->controller.scale = isosculpt_window_text_scale(w) * w->screen.pixels;
    ISO_TRY(update_picture(w, error));
    w->engine = w->viewport.mode.engine;
    if (!w->screen.message_is_error && iso_clock_seconds() - w->screen.message_seconds > MESSAGE_SECONDS)
        w->screen.message[0] = 0;
    if (w->frames_left <= 0) return ISO_OK;
    w->frames_left--;
    glViewport(0, 0, w->screen.width, w->screen.height);
    glClearColor(0.18f, 0.196f, 0.22f, 1); /* the colour of the window until there is a picture */
    glClear(GL_COLOR_BUFFER_BIT);
    ISO_TRY(isosculpt_panel_draw(w->panel, &w->screen, error));
    if (w->screenshot_window && !w->screen.blank) {
        w->screenshot_window = false;
        save_framebuffer(w);
    }
    glfwSwapBuffers(w->glfw);
    return ISO_OK;
}
