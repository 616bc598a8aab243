/* The look as text: written with all digits, and read setting by setting. */
#include "apps/isosculpt/look.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/options.h"

/* ---- writing */

void isosculpt_look_write(const isosculpt_controller *controller, char text[ISOSCULPT_LOOK]) {
    const isosculpt_display_mode *mode = &controller->viewport->mode;
    const iso_rgb color = mode->material.color, background = mode->material.background;
    const iso_brush *brush = &controller->brush;
    snprintf(text, ISOSCULPT_LOOK,
             "method=%s;light=%s;color=%02X%02X%02X;background=%02X%02X%02X;tool=%s;radius=%.17g;"
             "strength=%.17g;symmetry=%u;mirror=%.17g,%.17g,%.17g;radial=%u%c;paint=%02X%02X%02X;"
             "repeat=%u,%.17g,%.17g,%.17g;rows=%u,%.17g,%.17g,%.17g;",
             iso_method_name(mode->method), isosculpt_shading_name(mode->material.shading), color.r, color.g,
             color.b, background.r, background.g, background.b, iso_tool_name(brush->tool), brush->radius,
             brush->strength, brush->symmetry, brush->mirror.x, brush->mirror.y, brush->mirror.z,
             brush->radial, 'x' + iso_brush_radial_axis(brush), brush->color.r, brush->color.g,
             brush->color.b, brush->repeat[0], brush->repeat_by[0].x, brush->repeat_by[0].y,
             brush->repeat_by[0].z, brush->repeat[1], brush->repeat_by[1].x, brush->repeat_by[1].y,
             brush->repeat_by[1].z);
}

/* ---- reading */

static void apply_method(isosculpt_controller *controller, const char *value) {
    for (int i = 0; i < ISOSCULPT_METHODS; i++)
        if (strcmp(value, iso_method_name(isosculpt_methods[i])) == 0)
            controller->viewport->mode.method = isosculpt_methods[i];
}

static void apply_light(isosculpt_controller *controller, const char *value) {
    for (int i = 0; i < ISOSCULPT_SHADING_COUNT; i++)
        if (strcmp(value, isosculpt_shading_name((isosculpt_shading)i)) == 0)
            controller->viewport->mode.material.shading = (isosculpt_shading)i;
}

static void apply_rgb(iso_rgb *color, const char *value) {
    uint8_t rgb[3];
    if (iso_parse_color(value, rgb)) *color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
}

static void apply_color(isosculpt_controller *controller, const char *value) {
    apply_rgb(&controller->viewport->mode.material.color, value);
}

static void apply_background(isosculpt_controller *controller, const char *value) {
    apply_rgb(&controller->viewport->mode.material.background, value);
}

static void apply_paint(isosculpt_controller *controller, const char *value) {
    apply_rgb(&controller->brush.color, value);
}

static void apply_tool(isosculpt_controller *controller, const char *value) {
    for (int number = 0; number < ISOSCULPT_TOOLS; number++)
        if (strcmp(value, iso_tool_name(isosculpt_controller_tool(number))) == 0)
            controller->brush.tool = isosculpt_controller_tool(number);
}

static void apply_radius(isosculpt_controller *controller, const char *value) {
    const double radius = strtod(value, NULL);
    if (radius > 0) isosculpt_controller_set_radius(controller, radius);
}

static void apply_strength(isosculpt_controller *controller, const char *value) {
    const double strength = strtod(value, NULL);
    if (strength > 0 && strength <= 1) controller->brush.strength = strength;
}

static void apply_symmetry(isosculpt_controller *controller, const char *value) {
    controller->brush.symmetry = (unsigned)strtoul(value, NULL, 10) & 7;
}

static void apply_mirror(isosculpt_controller *controller, const char *value) {
    iso_vec3 at;
    if (sscanf(value, "%lf,%lf,%lf", &at.x, &at.y, &at.z) == 3 && isfinite(at.x + at.y + at.z))
        controller->brush.mirror = at;
}

static void apply_radial(isosculpt_controller *controller, const char *value) {
    char *end;
    const unsigned long radial = strtoul(value, &end, 10);
    if (radial <= ISO_RADIAL_MOST) controller->brush.radial = (unsigned)radial;
    if (*end >= 'x' && *end <= 'z') controller->brush.radial_axis = *end;
}

static void apply_line(isosculpt_controller *controller, int which, const char *value) {
    iso_brush brush = controller->brush;
    iso_vec3 *by = &brush.repeat_by[which];
    if (sscanf(value, "%u,%lf,%lf,%lf", &brush.repeat[which], &by->x, &by->y, &by->z) == 4 &&
        iso_brush_check(&brush, NULL) == ISO_OK)
        controller->brush = brush;
}

static void apply_repeat(isosculpt_controller *controller, const char *value) {
    apply_line(controller, 0, value);
}

static void apply_rows(isosculpt_controller *controller, const char *value) {
    apply_line(controller, 1, value);
}

/* Applies the setting NAME=VALUE. */
static void apply_setting(isosculpt_controller *controller, const char *name, const char *value) {
    static const struct {
        const char *name;
        void (*apply)(isosculpt_controller *controller, const char *value);
    } settings[] = {{"method", apply_method},     {"light", apply_light},
                    {"color", apply_color},       {"background", apply_background},
                    {"tool", apply_tool},         {"radius", apply_radius},
                    {"strength", apply_strength}, {"symmetry", apply_symmetry},
                    {"mirror", apply_mirror},     {"radial", apply_radial},
                    {"paint", apply_paint},       {"repeat", apply_repeat},
                    {"rows", apply_rows}};
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
        if (strcmp(name, settings[i].name) == 0) settings[i].apply(controller, value);
}

void isosculpt_look_apply(isosculpt_controller *controller, const char *text) {
    char copy[ISOSCULPT_LOOK];
    snprintf(copy, sizeof copy, "%s", text);
    for (char *at = copy, *end; (end = strchr(at, ';')); at = end + 1) {
        char *equals = strchr(at, '=');
        *end = 0;
        if (!equals || equals > end) continue;
        *equals = 0;
        apply_setting(controller, at, equals + 1);
    }
}
