/* The options with which isorender draws a viewport's picture, as a command for a shell and as a scene. */
#include "apps/isosculpt/render_command.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt/viewport/color_by.h"

/* Text in a fixed room. */
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

/* ---- the options */

/* Writes a number with the fewest digits that are read back as the same number. */
static void put_number(writer *w, double value) {
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    put(w, "%s", text);
}

static void put_numbers(writer *w, const double *values, int count) {
    for (int i = 0; i < count; i++) {
        if (i) put(w, ",");
        put_number(w, values[i]);
    }
}

static void put_color(writer *w, iso_rgb color) {
    put(w, "%02X%02X%02X", color.r, color.g, color.b);
}

/* Begins an option, whose value is what is written next, until `end`. */
static void begin(isosculpt_render_options *to, writer *w, const char *name) {
    if (to->count == ISOSCULPT_RENDER_OPTIONS)
        w->full = true;
    else
        to->items[to->count++] = (iso_scene_option){name, w->text + w->length, false, false};
}

static void end(writer *w) {
    w->full |= w->length + 1 >= w->room;
    if (!w->full) w->text[w->length++] = 0;
}

static void add_numbers(isosculpt_render_options *to, writer *w, const char *name, const double *values,
                        int count) {
    begin(to, w, name);
    put_numbers(w, values, count);
    end(w);
}

static void add_vector(isosculpt_render_options *to, writer *w, const char *name, iso_vec3 v) {
    add_numbers(to, w, name, (double[]){v.x, v.y, v.z}, 3);
}

static void add_text(isosculpt_render_options *to, writer *w, const char *name, const char *text) {
    begin(to, w, name);
    put(w, "%s", text);
    end(w);
}

static void add_flag(isosculpt_render_options *to, writer *w, const char *name) {
    begin(to, w, name);
    end(w);
    if (to->count) to->items[to->count - 1].value = NULL;
}

/* Adds lines "option=value". */
static void add_reading(isosculpt_render_options *to, writer *w, const char *reading) {
    for (const char *line = reading; *line; line += line[0] == '\n') {
        const size_t length = strcspn(line, "\n"), name = strcspn(line, "=");
        if (name < length) {
            const char *option = w->text + w->length;
            put(w, "%.*s", (int)name, line);
            end(w);
            begin(to, w, option);
            put(w, "%.*s", (int)(length - name - 1), line + name + 1);
            end(w);
        }
        line += length;
    }
}

/* The opacities of a see-through picture; two opaque surfaces need none. */
static void add_opacities(isosculpt_render_options *to, writer *w, const isosculpt_viewport *viewport) {
    const isosculpt_see_through *how = &viewport->see_through;
    const bool two = isosculpt_viewport_has_second(viewport);
    if (!isosculpt_viewport_is_see_through(viewport)) return;
    if (!(how->opacity < 1) && !(two && how->second_opacity < 1)) return;
    add_numbers(to, w, "opacity", (double[]){how->opacity, how->second_opacity}, two ? 2 : 1);
}

/* What the surfaces are coloured by. */
static void add_colors(isosculpt_render_options *to, writer *w, const isosculpt_viewport *viewport) {
    const isosculpt_color_by *by = isosculpt_viewport_color_by(viewport);
    if (!isosculpt_viewport_is_colored(viewport)) return;
    add_text(to, w, "surface-color-by", by->what);
    if (to->count) to->items[to->count - 1].has_file = true;
    if (by->map[0]) add_text(to, w, "colormap", by->map);
    if (!isnan(by->range[0])) add_numbers(to, w, "range", by->range, 2);
}

/* What is cut away, how cuts are capped, the colours of data, and the light at rest. */
static void add_style(isosculpt_render_options *to, writer *w, const isosculpt_viewport *viewport) {
    static const char *const caps[] = {"none", "surface", "color", "slice"};
    const isosculpt_cut *cut = &viewport->cut;
    const iso_cap_style *cap = &cut->cap;
    const isosculpt_light light = isosculpt_viewport_light(viewport);
    for (int i = 0; i < cut->count; i++) add_text(to, w, "clip", cut->texts[i]);
    if (cut->count && cap->kind != ISO_CAP_NONE) {
        begin(to, w, "cap");
        if (cap->kind == ISO_CAP_COLOR)
            put_color(w, cap->color);
        else if (cap->kind == ISO_CAP_SLICE && cap->map != ISO_COLORMAP_GRAY)
            put(w, "slice:%s", iso_colormap_name(cap->map));
        else
            put(w, "%s", caps[cap->kind]);
        end(w);
        if (cap->kind == ISO_CAP_SLICE && !isnan(cut->window[0]))
            add_numbers(to, w, "window", cut->window, 2);
    }
    add_colors(to, w, viewport);
    if (light.occlusion.ambient && light.occlusion.range > 0)
        add_numbers(to, w, "occlusion", &light.occlusion.range, 1);
    else if (light.occlusion.ambient)
        add_flag(to, w, "occlusion");
    if (light.occlusion.shadow) add_flag(to, w, "shadow");
    if (light.outline > 0) add_numbers(to, w, "outline", &light.outline, 1);
}

static void add_surface_colors(isosculpt_render_options *to, writer *w, const isosculpt_viewport *viewport) {
    begin(to, w, "color");
    put_color(w, viewport->mode.material.color);
    if (isosculpt_viewport_has_second(viewport)) {
        put(w, ",");
        put_color(w, viewport->see_through.second_color);
    }
    end(w);
}

bool isosculpt_render_options_make(const isosculpt_render_command *command, isosculpt_render_options *to) {
    const isosculpt_viewport *viewport = command->viewport;
    const iso_camera *camera = &viewport->camera;
    const isosculpt_see_through *how = &viewport->see_through;
    const bool two = isosculpt_viewport_has_second(viewport);
    const iso_method method = isosculpt_viewport_method(viewport);
    writer w = {.text = to->text, .room = sizeof to->text};
    to->count = 0;
    to->isovalues[0] = viewport->lod ? viewport->isovalue : 0;
    to->isovalues[1] = how->second_isovalue;
    to->isovalue_count = two ? 2 : 1;
    add_reading(to, &w, command->reading);
    add_numbers(to, &w, "isovalue", to->isovalues, to->isovalue_count);
    add_opacities(to, &w, viewport);
    add_style(to, &w, viewport);
    add_text(to, &w, "method", method == ISO_METHOD_PULLPUSH_BOX ? "pullpush" : iso_method_name(method));
    if (method == ISO_METHOD_PULLPUSH_BOX) add_text(to, &w, "reconstruction", "box");
    add_text(to, &w, "samples", "4");
    begin(to, &w, "resolution");
    put(&w, "%dx%d", command->width, command->height);
    end(&w);
    /* the file of a painted field has its colours */
    if (!isosculpt_viewport_is_painted(viewport)) add_surface_colors(to, &w, viewport);
    begin(to, &w, "background");
    put_color(&w, viewport->mode.material.background);
    end(&w);
    add_vector(to, &w, "camera-position", camera->position);
    add_vector(to, &w, "camera-focal-point", camera->focal_point);
    add_vector(to, &w, "camera-view-up", camera->view_up);
    add_numbers(to, &w, "view-angle", &camera->view_angle, 1);
    return !w.full;
}

/* ---- the command */

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

/* Writes the name of the output, NAME-view.png in the current folder. */
static void put_output(writer *w, const char *path) {
    char name[256];
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strchr(base, '.');
    snprintf(name, sizeof name, "%.*s-view.png", dot && dot > base ? (int)(dot - base) : (int)strlen(base),
             base);
    put(w, " -o ");
    put_quoted(w, name);
}

bool isosculpt_render_command_text(const isosculpt_render_command *command, char *text, size_t room) {
    isosculpt_render_options options;
    writer w = {.text = text, .room = room};
    if (!isosculpt_render_options_make(command, &options)) return false;
    put(&w, "isorender ");
    put_quoted(&w, command->path);
    put_output(&w, command->path);
    for (int i = 0; i < options.count; i++) {
        put(&w, " --%s", options.items[i].name);
        if (!options.items[i].value) continue;
        put(&w, "=");
        put_quoted(&w, options.items[i].value);
    }
    put(&w, " --backend=cpu"); /* how to draw, which belongs to no scene */
    return !w.full;
}

/* ---- the scene */

iso_scene_record isosculpt_render_record(const isosculpt_render_command *command,
                                         const isosculpt_render_options *options) {
    return (iso_scene_record){.version = iso_version(),
                              .input = command->path,
                              .options = options->items,
                              .option_count = options->count,
                              .camera = &command->viewport->camera,
                              .isovalues = options->isovalues,
                              .isovalue_count = options->isovalue_count};
}
