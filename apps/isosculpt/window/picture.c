/* The picture in isosculpt's window: when to draw which, and pictures of it in files. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/window.h"
#include "base/clock.h"

#ifndef GL_CLAMP_TO_EDGE
#define GL_CLAMP_TO_EDGE 0x812F /* OpenGL 1.2 */
#endif

/* Seconds without a change after which the picture becomes the exact surface, and a smoother one. */
static const double REST[] = {[ISOSCULPT_REST] = 0.12, [ISOSCULPT_FINE] = 0.6};

/* Seconds that a message stays. */
static const double SAID = 6;

/* ---- pictures in files */

/* The name that was chosen, or the first one beside the file that saving writes that is free. */
static bool name_shot(window *w, char path[ISOSCULPT_PATH]) {
    char ending[32];
    memcpy(path, w->shot_path, ISOSCULPT_PATH);
    w->shot_path[0] = 0;
    if (path[0]) return true;
    for (int number = 1; number < 10000; number++) {
        snprintf(ending, sizeof ending, "-%d.png", number);
        if (isosculpt_target_with(w->document.target, ending, path) && access(path, F_OK)) return true;
    }
    return false;
}

static void write_shot(window *w, const iso_image *image) {
    char path[ISOSCULPT_PATH], text[sizeof w->screen.message];
    iso_error reason = {0};
    iso_png_opts opts = {.pool = w->pool};
    bool named = name_shot(w, path);
    bool written = named && iso_png_write_with(path, image, &opts, &reason) == ISO_OK;
    snprintf(text, sizeof text, "%s%.500s", written ? "Picture: " : "No picture: ",
             written ? path
             : named ? reason.text
                     : "there is no free name");
    isosculpt_window_set_status(w, !written, text);
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

double isosculpt_window_seconds_until_refine(const window *w) {
    if (w->screen.blank || w->view.quality == ISOSCULPT_FINE) return ISOSCULPT_IDLE;
    if (isosculpt_view_is_preparing(&w->view)) return ISOSCULPT_IDLE; /* which wakes us */
    return w->screenshot ? -1 : w->changed + REST[w->view.quality + 1] - iso_clock_seconds();
}

/* One step to a better picture. */
static iso_status improve(window *w, iso_error *error) {
    if (w->view.quality == ISOSCULPT_REST) return isosculpt_view_refine(&w->view, error);
    return isosculpt_view_draw(&w->view, w->screen.width, w->screen.height, false, error);
}

static iso_status draw_due(window *w, iso_error *error) {
    if (w->screen.blank) w->controller.commands &= ~(unsigned)ISOSCULPT_COMMAND_PICTURE;
    if (w->screen.blank) return ISO_OK;
    if (w->controller.commands & ISOSCULPT_COMMAND_PICTURE) {
        w->controller.commands &= ~(unsigned)ISOSCULPT_COMMAND_PICTURE;
        w->changed = iso_clock_seconds();
        ISO_TRY(isosculpt_view_draw(&w->view, w->screen.width, w->screen.height, true, error));
    } else if (isosculpt_window_seconds_until_refine(w) >= 0)
        return ISO_OK;
    else if (isosculpt_view_is_ready(&w->view))
        ISO_TRY(improve(w, error));
    else
        return isosculpt_view_prepare(&w->view, glfwPostEmptyEvent, error);
    upload(w);
    w->frames = ISOSCULPT_FRAMES;
    return ISO_OK;
}

/* The picture that is due now, if any. */
static iso_status update_picture(window *w, iso_error *error) {
    ISO_TRY(draw_due(w, error));
    if (!w->screenshot || w->view.quality != ISOSCULPT_FINE || w->screen.blank) return ISO_OK;
    w->screenshot = false;
    iso_error reason = {0};
    if (isosculpt_view_fetch(&w->view, &reason) == ISO_OK)
        write_shot(w, &w->view.image);
    else
        isosculpt_window_set_status(w, true, reason.text);
    return ISO_OK;
}

iso_status isosculpt_window_draw(window *w, iso_error *error) {
    isosculpt_window_update_framebuffer_size(w);
    if (w->screen.width <= 0 || w->screen.height <= 0) return ISO_OK; /* iconified */
    ISO_TRY(isosculpt_panel_rescale(w->panel, isosculpt_window_text_scale(w), error));
    ISO_TRY(update_picture(w, error));
    w->engine = w->view.mode.engine;
    if (!w->screen.message_is_bad && iso_clock_seconds() - w->screen.said > SAID) w->screen.message[0] = 0;
    if (w->frames <= 0) return ISO_OK;
    w->frames--;
    glViewport(0, 0, w->screen.width, w->screen.height);
    glClearColor(0.18f, 0.196f, 0.22f, 1); /* seen until there is a picture */
    glClear(GL_COLOR_BUFFER_BIT);
    ISO_TRY(isosculpt_panel_draw(w->panel, &w->screen, error));
    if (w->screenshot_all && !w->screen.blank) {
        w->screenshot_all = false;
        shoot_window(w);
    }
    glfwSwapBuffers(w->glfw);
    return ISO_OK;
}
