/* style: options of isorender, applied to a viewport. */
#include "apps/isosculpt/style.h"

#include <stdio.h>
#include <string.h>

#include "apps/common/coloring_settings.h"
#include "apps/common/looks.h"
#include "apps/common/options.h"
#include "apps/isosculpt/viewport/color_by.h"
#include "base/parse.h"

static iso_status fail_value(const char *option, const char *value, iso_error *error) {
    return iso_fail(error, ISO_ERR_USAGE, "--%s: '%s' is not understood", option, value ? value : "");
}

/* Item `number` of a list with commas; false: it has none. */
static bool find_item(const char *list, int number, char item[64]) {
    for (; number && *list; number--) list += strcspn(list, ",") + (list[strcspn(list, ",")] == ',');
    snprintf(item, 64, "%.*s", (int)strcspn(list, ","), list);
    return item[0];
}

/* The numbers of a list of one or two; NAN where there is none. */
static bool parse_pair(const char *list, double numbers[2]) {
    char item[64];
    numbers[0] = numbers[1] = NAN;
    for (int i = 0; i < 2; i++)
        if (find_item(list, i, item) && !iso_parse_reals(item, 1, &numbers[i])) return false;
    return !isnan(numbers[0]);
}

static iso_status set_isovalue(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    double numbers[2];
    if (!parse_pair(value, numbers)) return fail_value("isovalue", value, error);
    if (isnan(numbers[1])) return ISO_OK;
    viewport->see_through.has_second = true;
    viewport->see_through.second_isovalue = numbers[1];
    return ISO_OK;
}

static iso_status set_opacity(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    double numbers[2];
    if (!parse_pair(value, numbers)) return fail_value("opacity", value, error);
    viewport->see_through.opacity = numbers[0];
    viewport->see_through.second_opacity = isnan(numbers[1]) ? numbers[0] : numbers[1];
    return ISO_OK;
}

static bool parse_color(const char *text, iso_rgb *color) {
    uint8_t rgb[3];
    if (!iso_parse_color(text, rgb)) return false;
    *color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    return true;
}

static iso_status set_color(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    iso_rgb *colors[] = {&viewport->mode.material.color, &viewport->see_through.second_color};
    char item[64];
    for (int i = 0; i < 2; i++)
        if (find_item(value, i, item) && !parse_color(item, colors[i]))
            return fail_value("color", value, error);
    return ISO_OK;
}

static iso_status set_background(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    return parse_color(value, &viewport->mode.material.background) ? ISO_OK
                                                                   : fail_value("background", value, error);
}

static iso_status set_cap(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    return iso_cap_style_parse(value, &viewport->cut.cap, error);
}

static iso_status set_window(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    double numbers[2];
    if (!parse_pair(value, numbers) || !(numbers[1] > 0)) return fail_value("window", value, error);
    memcpy(viewport->cut.window, numbers, sizeof numbers);
    return ISO_OK;
}

/* A length that may be left out; `usual`: what that means. */
static iso_status parse_length(const char *option, const char *value, double usual, double *length,
                               iso_error *error) {
    *length = usual;
    if (!value || !value[0] || strcmp(value, "true") == 0) return ISO_OK;
    if (!iso_parse_reals(value, 1, length) || *length < 0) return fail_value(option, value, error);
    return ISO_OK;
}

static iso_status set_occlusion(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    viewport->light.occlusion.ambient = true;
    return parse_length("occlusion", value, 0, &viewport->light.occlusion.range, error);
}

static iso_status set_shadow(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    (void)value, (void)error;
    viewport->light.occlusion.shadow = true;
    return ISO_OK;
}

static iso_status set_outline(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    ISO_TRY(parse_length("outline", value, 1, &viewport->light.outline, error));
    return ISO_OK;
}

static iso_status set_range(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    double range[2];
    ISO_TRY(iso_range_parse(value, range, error));
    return isosculpt_color_by_set_range(viewport, range, error);
}

static iso_status set_look(isosculpt_viewport *viewport, const char *value, iso_error *error) {
    size_t count;
    const iso_look_value *values = iso_look_values(&count);
    viewport->light = (isosculpt_light){.outline = 0};
    viewport->see_through.opacity = viewport->see_through.second_opacity = 1;
    for (size_t i = 0; i < count; i++)
        if (strcmp(values[i].look, value) == 0 && isosculpt_style_has(values[i].option))
            ISO_TRY(isosculpt_style_set(viewport, values[i].option, values[i].value, error));
    return ISO_OK;
}

static const struct {
    const char *name;
    iso_status (*set)(isosculpt_viewport *viewport, const char *value, iso_error *error);
    bool alone; /* it may have no value */
} styles[] = {{"isovalue", set_isovalue, false},
              {"color", set_color, false},
              {"opacity", set_opacity, false},
              {"background", set_background, false},
              {"clip", isosculpt_viewport_add_cut, false},
              {"cap", set_cap, false},
              {"window", set_window, false},
              {"occlusion", set_occlusion, true},
              {"shadow", set_shadow, true},
              {"outline", set_outline, true},
              {"surface-color-by", isosculpt_color_by_set, false},
              {"colormap", isosculpt_color_by_set_map, false},
              {"range", set_range, false},
              {"look", set_look, false}};

/* Its number in `styles`; -1: it is not there. */
static int find(const char *option) {
    int i = (int)(sizeof styles / sizeof *styles) - 1;
    while (i >= 0 && strcmp(styles[i].name, option) != 0) i--;
    return i;
}

bool isosculpt_style_has(const char *option) {
    return find(option) >= 0;
}

iso_status isosculpt_style_set(isosculpt_viewport *viewport, const char *option, const char *value,
                               iso_error *error) {
    const int style = find(option);
    if (style < 0 || (!value && !styles[style].alone)) return fail_value(option, value, error);
    viewport->style++;
    return styles[style].set(viewport, value, error);
}
