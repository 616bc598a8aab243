/* The isorender command of a viewport, with file names quoted for a shell. */
#include "apps/isosculpt/render_command.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct writer {
    char *text;
    size_t length, room;
    bool full;
} writer;

static void put(writer *w, const char *format, ...) {
    va_list values;
    va_start(values, format);
    const int length = vsnprintf(w->text + w->length, w->room - w->length, format, values);
    va_end(values);
    w->full |= length < 0 || (size_t)length >= w->room - w->length;
    if (!w->full) w->length += (size_t)length;
}

/* Writes a number with the fewest digits that are read back as the same number. */
static void put_number(writer *w, double value) {
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    put(w, "%s", text);
}

static void put_vector(writer *w, const char *option, iso_vec3 v) {
    put(w, " %s=", option);
    put_number(w, v.x);
    put(w, ",");
    put_number(w, v.y);
    put(w, ",");
    put_number(w, v.z);
}

/* Writes text in single quotes if it contains characters that a shell interprets. */
static void put_quoted(writer *w, const char *text) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+,:@%=";
    if (text[0] && text[0] != '-' && text[strspn(text, plain)] == 0) {
        put(w, "%s", text);
        return;
    }
    put(w, "'");
    for (const char *c = text; *c; c++) put(w, *c == '\'' ? "'\\''" : "%c", *c);
    put(w, "'");
}

/* Writes lines "option=value" as options. */
static void put_reading(writer *w, const char *reading) {
    char value[1024];
    for (const char *line = reading; *line; line += line[0] == '\n') {
        const size_t length = strcspn(line, "\n"), name = strcspn(line, "=");
        if (name < length) {
            put(w, " --%.*s=", (int)name, line);
            snprintf(value, sizeof value, "%.*s", (int)(length - name - 1), line + name + 1);
            put_quoted(w, value);
        }
        line += length;
    }
}

/* Writes the name of the output, NAME-view.png in the current folder. */
static void put_output(writer *w, const char *path) {
    char name[256];
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strchr(base, '.');
    snprintf(name, sizeof name, "%.*s-view.png", dot && dot > base ? (int)(dot - base) : (int)strlen(base),
             base);
    put(w, " -o ");
    put_quoted(w, name);
}

static void put_color(writer *w, const char *option, iso_rgb color) {
    put(w, " %s %02X%02X%02X", option, color.r, color.g, color.b);
}

/* Writes the opacities of a see-through picture; two opaque surfaces need none. */
static void put_opacities(writer *w, const isosculpt_viewport *viewport) {
    const isosculpt_see_through *how = &viewport->see_through;
    const bool two = isosculpt_viewport_has_second(viewport);
    if (!isosculpt_viewport_is_see_through(viewport)) return;
    if (!(how->opacity < 1) && !(two && how->second_opacity < 1)) return;
    put(w, " --opacity=");
    put_number(w, how->opacity);
    if (!two) return;
    put(w, ",");
    put_number(w, how->second_opacity);
}

static void put_method(writer *w, iso_method method) {
    if (method == ISO_METHOD_PULLPUSH_BOX)
        put(w, " --method pullpush --reconstruction box");
    else
        put(w, " --method %s", iso_method_name(method));
}

bool isosculpt_render_command_text(const isosculpt_render_command *command, char *text, size_t room) {
    const isosculpt_viewport *viewport = command->viewport;
    const iso_camera *camera = &viewport->camera;
    const isosculpt_see_through *how = &viewport->see_through;
    const iso_rgb second = how->second_color;
    const bool two = isosculpt_viewport_has_second(viewport);
    writer w = {.text = text, .room = room};
    put(&w, "isorender ");
    put_quoted(&w, command->path);
    put_reading(&w, command->reading);
    put_output(&w, command->path);
    put(&w, " --isovalue=");
    put_number(&w, viewport->lod ? viewport->isovalue : 0);
    if (two) {
        put(&w, ",");
        put_number(&w, how->second_isovalue);
    }
    put_opacities(&w, viewport);
    put_method(&w, isosculpt_viewport_method(viewport));
    put(&w, " --backend cpu --samples 4 --resolution %dx%d", command->width, command->height);
    put_color(&w, "--color", viewport->mode.material.color);
    if (two) put(&w, ",%02X%02X%02X", second.r, second.g, second.b);
    put_color(&w, "--background", viewport->mode.material.background);
    put_vector(&w, "--camera-position", camera->position);
    put_vector(&w, "--camera-focal-point", camera->focal_point);
    put_vector(&w, "--camera-view-up", camera->view_up);
    put(&w, " --view-angle ");
    put_number(&w, camera->view_angle);
    return !w.full;
}
