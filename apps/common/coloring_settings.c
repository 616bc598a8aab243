/* coloring_settings: the words of --surface-color-by, --colormap and --range. */
#include "apps/common/coloring_settings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "apps/common/value_path.h"
#include "base/parse.h"

iso_status iso_colormap_choice_parse(const char *value, iso_colormap_choice *map, iso_error *error) {
    *map = (iso_colormap_choice){.given = value != NULL, .map = ISO_COLORMAP_VIRIDIS};
    if (!value) return ISO_OK;
    if (iso_colormap_find(value, &map->map, NULL) == ISO_OK) return ISO_OK;
    if (strpbrk(value, "./") || access(value, F_OK) == 0)
        map->file = value;
    else
        return iso_colormap_find(value, &map->map, error);
    return ISO_OK;
}

iso_status iso_range_parse(const char *value, double range[2], iso_error *error) {
    range[0] = range[1] = (double)NAN;
    if (!value) return ISO_OK;
    if (!iso_parse_reals(value, 2, range) || !(range[0] < range[1]))
        return iso_fail(error, ISO_ERR_USAGE, "--range: '%s' is not two numbers, the smaller one first",
                        value);
    return ISO_OK;
}

iso_status iso_range_parse_shares(const char *value, double range[2], double shares[2], iso_error *error) {
    char low[32], high[32];
    shares[0] = shares[1] = (double)NAN;
    if (!value || sscanf(value, " %31[^,%%]%%,%31[^,%%]%%", low, high) != 2 ||
        value[strlen(value) - 1] != '%')
        return iso_range_parse(value, range, error);
    range[0] = range[1] = (double)NAN;
    if (!iso_parse_reals(low, 1, &shares[0]) || !iso_parse_reals(high, 1, &shares[1]) || !(shares[0] >= 0) ||
        !(shares[0] < shares[1]) || !(shares[1] <= 100))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--range: '%s' is not two shares from 0%% to 100%%, the smaller one first", value);
    for (int k = 0; k < 2; k++) shares[k] /= 100;
    return ISO_OK;
}

/* Whether the value is a word alone, with or without @N behind it. */
static bool is_word(const char *value, const iso_value_path *whole, const char *word) {
    return whole->begin == 0 && whole->length == strlen(word) && strncmp(value, word, whole->length) == 0;
}

/* The length of scene:NAME or scene:NAME:SIZE. */
static size_t scene_length(const char *text, size_t length) {
    size_t at = 0;
    for (int colons = 0; at < length; at++)
        if (text[at] == ':' && ++colons == 3) break;
    return at;
}

/* Takes the path and what stands behind it. */
static iso_status take_file(const char *value, const iso_value_path *whole, iso_coloring_settings *coloring,
                            iso_error *error) {
    const char *text = value + whole->begin;
    iso_value_path path;
    if (iso_loader_is_scene(text))
        path = (iso_value_path){whole->begin, scene_length(text, whole->length)};
    else if (!iso_value_path_find(value, NULL, &path, NULL))
        path = *whole; /* to be missed when it is opened */
    if (!path.length)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "'%s' names no file: VOLUME[:ARRAY], curvature, distance:FILE[:ISOVALUE], depth or normal",
            value);
    const size_t rest = path.length < whole->length ? whole->length - path.length - 1 : 0;
    if (path.length >= sizeof coloring->path || rest >= sizeof coloring->rest)
        return iso_fail(error, ISO_ERR_USAGE, "'%.40s..': the name is too long", value);
    snprintf(coloring->path, sizeof coloring->path, "%.*s", (int)path.length, text);
    snprintf(coloring->rest, sizeof coloring->rest, "%.*s", (int)rest, text + path.length + (rest > 0));
    return ISO_OK;
}

/* "density.nrrd" of "/data/density.nrrd" */
static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void iso_coloring_settings_title(const iso_coloring_settings *settings, iso_world_unit world,
                                 iso_color_bar *bar) {
    const char *suffix = iso_world_unit_suffix(world), *unit = suffix + (*suffix == ' ');
    bar->title[0] = 0;
    switch (settings->source) {
    case ISO_COLOR_BY_VOLUME:
        snprintf(bar->title, sizeof bar->title, "%.*s", (int)sizeof bar->title - 1,
                 settings->rest[0] ? settings->rest : base_name(settings->path));
        if (!settings->rest[0]) bar->title[strcspn(bar->title, ".")] = 0;
        break;
    case ISO_COLOR_BY_CURVATURE:
        snprintf(bar->title, sizeof bar->title, *unit ? "curvature (1/%s)" : "curvature", unit);
        break;
    case ISO_COLOR_BY_DISTANCE:
    case ISO_COLOR_BY_DEPTH:
        snprintf(bar->title, sizeof bar->title, *unit ? "%s (%s)" : "%s",
                 settings->source == ISO_COLOR_BY_DEPTH ? "depth" : "distance", unit);
        break;
    case ISO_COLOR_BY_NORMAL:
        break;
    }
}

iso_status iso_coloring_settings_parse(const char *value, iso_coloring_settings *coloring, iso_error *error) {
    const iso_value_path whole = iso_value_path_whole(value);
    const char *behind = value + whole.begin + whole.length;
    *coloring =
        (iso_coloring_settings){.text = value, .isovalue = (double)NAN, .range = {(double)NAN, (double)NAN}};
    if (*behind) ISO_TRY(iso_things_parse(behind + 1, &coloring->things, error));
    static const struct {
        const char *word;
        iso_color_source source;
    } words[] = {{"curvature", ISO_COLOR_BY_CURVATURE},
                 {"depth", ISO_COLOR_BY_DEPTH},
                 {"normal", ISO_COLOR_BY_NORMAL}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (is_word(value, &whole, words[i].word)) {
            coloring->source = words[i].source;
            return ISO_OK;
        }
    coloring->source = whole.begin ? ISO_COLOR_BY_DISTANCE : ISO_COLOR_BY_VOLUME;
    ISO_TRY(take_file(value, &whole, coloring, error));
    if (whole.begin && coloring->rest[0] && !iso_parse_real(coloring->rest, &coloring->isovalue))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not distance:FILE or distance:FILE:ISOVALUE", value);
    return ISO_OK;
}

iso_color_file iso_coloring_settings_file(const iso_coloring_settings *settings) {
    const bool distance = settings->source == ISO_COLOR_BY_DISTANCE;
    return (iso_color_file){.path = settings->path,
                            .source = settings->source,
                            .array = distance || !settings->rest[0] ? NULL : settings->rest,
                            .isovalue = settings->isovalue};
}
