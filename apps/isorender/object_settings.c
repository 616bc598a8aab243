/* object_settings: deals the values of repeated options to the objects they belong to, and parses them. */
#include "apps/isorender/object_settings.h"

#include <math.h>
#include <string.h>
#include <strings.h>

const char *isorender_value_for(const iso_texts *texts, int number) {
    if (!texts->count) return NULL;
    return texts->values[number < texts->count ? number : texts->count - 1];
}

/* The index of a value in a list of names that ends with NULL. */
static iso_status choose(const char *option, const char *value, const char *const *names, int *index,
                         iso_error *error) {
    char known[256] = "";
    for (int i = 0; names[i]; i++) {
        const size_t used = strlen(known);
        if (strcasecmp(names[i], value) == 0) {
            *index = i;
            return ISO_OK;
        }
        snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", names[i]);
    }
    return iso_fail(error, ISO_ERR_USAGE, "--%s: '%s' is not one of %s", option, value, known);
}

/* A number of mm above 0, or the name of an attribute. */
static iso_status set_radius(const char *option, const char *value, isorender_object_settings *object,
                             iso_error *error) {
    if (!value) return ISO_OK;
    if (!iso_parse_real(value, &object->radius))
        object->radius_column = value;
    else if (!(object->radius > 0))
        return iso_fail(error, ISO_ERR_USAGE, "--%s: a radius of %s mm", option, value);
    return ISO_OK;
}

/* Puts an option's name before the message of a failure, and behind it what else a value with commas may
 * mean; returns `status`. */
static iso_status named(const char *option, const char *value, iso_status status, iso_error *error) {
    char text[sizeof error->text];
    snprintf(text, sizeof text, "%s", error->text);
    return iso_fail(error, status, "--%s: %s%s", option, text,
                    strchr(value, ',') ? "; the option is given again for each file" : "");
}

iso_status isorender_parse_color(const char *option, const char *value, const char *others, bool *given,
                                 iso_rgb *color, iso_error *error) {
    uint8_t rgb[3];
    if (!value) return ISO_OK;
    if (!iso_parse_color(value, rgb))
        return named(option, value, iso_fail_color(value, others, error), error);
    *given = true;
    *color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    return ISO_OK;
}

static iso_status set_color(const char *option, const char *value, isorender_object_settings *object,
                            iso_error *error) {
    const bool directed = object->kind != ISO_OBJECT_MESH;
    if (directed && value && strcmp(value, "direction") == 0) {
        object->by_direction = true;
        return ISO_OK;
    }
    return isorender_parse_color(option, value, directed ? " nor 'direction'" : "", &object->colored,
                                 &object->color, error);
}

iso_status isorender_opacity(const char *value, double *opacity, iso_error *error) {
    const bool is_number = iso_parse_fraction(value, opacity);
    if (is_number && *opacity >= 0 && *opacity <= 1) return ISO_OK;
    if (is_number && *opacity >= 2 && *opacity <= 100 && !strchr(value, '%'))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not an opacity from 0 to 1: %s%% is %g", value, value,
                        *opacity / 100);
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not an opacity from 0 to 1", value);
}

iso_status isorender_parse_opacity(const char *option, const char *value, double *opacity, iso_error *error) {
    double given;
    if (!value) return ISO_OK;
    if (isorender_opacity(value, &given, error) != ISO_OK) return named(option, value, ISO_ERR_USAGE, error);
    *opacity = (double)(float)given; /* as it is drawn */
    return ISO_OK;
}

/* The names are in the order of iso_space and of iso_vector_axes, which has two more. */
static iso_status set_space(const char *value, isorender_object_settings *object, iso_error *error) {
    static const char *const spaces[] = {"file", "lps", "ras", "voxels", "fsl", NULL};
    int space = ISO_SPACE_FILE;
    if (value) ISO_TRY(choose("space", value, spaces, &space, error));
    object->field.axes = (iso_vector_axes)space;
    object->space = space <= ISO_SPACE_RAS ? (iso_space)space : ISO_SPACE_FILE;
    return ISO_OK;
}

static iso_status set_every(const char *every, isorender_object_settings *object, iso_error *error) {
    if (every && (!iso_parse_int(every, &object->every) || object->every < 1))
        return iso_fail(error, ISO_ERR_USAGE, "--every: '%s' is not a whole number above 0", every);
    return ISO_OK;
}

/* Names such as xx,xy,xz,yy,yz,zz: which component of a tensor each of six is. */
static iso_status set_tensor_order(const char *value, int order[6], iso_error *error) {
    static const char *const names[6] = {"xx", "xy", "xz", "yy", "yz", "zz"};
    bool good = value && strlen(value) == 17;
    for (int i = 0; good && i < 6; i++) {
        int entry = 0;
        while (entry < 6 && strncmp(value + 3 * i, names[entry], 2) != 0) entry++;
        good = entry < 6 && !order[entry] && (i == 5 || value[3 * i + 2] == ',');
        if (good) order[entry] = i + 1;
    }
    if (good || !value) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "--tensor-order: '%s' is not an order of xx,xy,xz,yy,yz,zz", value);
}

static iso_status set_above_0(const char *option, const char *value, double *number, iso_error *error) {
    if (value && (!iso_parse_real(value, number) || !(*number > 0)))
        return iso_fail(error, ISO_ERR_USAGE, "--%s: '%s' is not a number above 0", option, value);
    return ISO_OK;
}

static iso_status set_count(const char *option, const char *value, int least, int *number, iso_error *error) {
    if (value && (!iso_parse_int(value, number) || *number < least))
        return iso_fail(error, ISO_ERR_USAGE, "--%s: '%s' is not a whole number from %d", option, value,
                        least);
    return ISO_OK;
}

/* number: of the lines. */
static iso_status set_streamlines(const isorender_object_options *options, int number,
                                  iso_vector_field_opts *field, iso_error *error) {
    field->streamlines = 500;
    ISO_TRY(set_count("streamlines", isorender_value_for(&options->streamlines, number), 1,
                      &field->streamlines, error));
    ISO_TRY(set_count("streamline-seed", isorender_value_for(&options->streamline_seeds, number), 0,
                      &field->seed, error));
    return set_above_0("streamline-length", isorender_value_for(&options->streamline_lengths, number),
                       &field->length, error);
}

/* What lines and glyphs have; number: of the object. */
static iso_status set_common(const isorender_object_options *options, int number,
                             isorender_object_settings *object, iso_error *error) {
    object->color_by = isorender_value_for(&options->color_by, number);
    object->field.array = isorender_value_for(&options->arrays, number);
    ISO_TRY(set_above_0("least", isorender_value_for(&options->leasts, number), &object->field.least, error));
    object->field.axial = options->axial != 0;
    ISO_TRY(
        set_tensor_order(isorender_value_for(&options->tensor_orders, number), object->field.order, error));
    ISO_TRY(iso_colormap_choice_parse(isorender_value_for(&options->maps, number), &object->map, error));
    ISO_TRY(iso_range_parse_shares(isorender_value_for(&options->ranges, number), object->range,
                                   object->range_shares, error));
    return set_every(isorender_value_for(&options->every, number), object, error);
}

/* number: of the lines. */
static iso_status set_lines(const isorender_object_options *options, int number,
                            isorender_object_settings *object, iso_error *error) {
    static const char *const names[] = {"round", "flat", NULL};
    static const char *const styles[] = {"tube", "ribbon", "line", NULL};
    static const char *const shadings[] = {"round", "illuminated", NULL};
    const char *value = isorender_value_for(&options->caps, number),
               *style = isorender_value_for(&options->line_styles, number),
               *shading = isorender_value_for(&options->line_shadings, number);
    int caps = 0, chosen = ISORENDER_STYLE_TUBE, shaded = ISO_LINE_ROUND;
    if (value) ISO_TRY(choose("caps", value, names, &caps, error));
    if (style) ISO_TRY(choose("line-style", style, styles, &chosen, error));
    if (shading) ISO_TRY(choose("line-shading", shading, shadings, &shaded, error));
    object->caps = (iso_caps)caps;
    object->shading = (iso_line_shading)shaded;
    object->style = (isorender_line_style)chosen;
    object->style_given = style != NULL;
    ISO_TRY(set_streamlines(options, number, &object->field, error));
    ISO_TRY(isorender_parse_opacity("line-opacity", isorender_value_for(&options->line_opacities, number),
                                    &object->opacity, error));
    ISO_TRY(set_radius("tube-radius", isorender_value_for(&options->tube_radii, number), object, error));
    return set_color("line-color", isorender_value_for(&options->line_colors, number), object, error);
}

static iso_status set_projection(const char *value, isorender_object_settings *object, iso_error *error) {
    static const char *const names[] = {"exact", "billboard", NULL};
    int projection = ISO_GLYPH_PROJECTION_EXACT;
    if (value) ISO_TRY(choose("glyph-projection", value, names, &projection, error));
    object->projection = (iso_glyph_projection)projection;
    return ISO_OK;
}

/* number: of the glyphs. */
static iso_status set_glyphs(const isorender_object_options *options, int number,
                             isorender_object_settings *object, iso_error *error) {
#define GLYPH_TEXT(name, text) text,
    static const char *const names[] = {ISO_GLYPHS(GLYPH_TEXT) NULL};
#undef GLYPH_TEXT
    const char *value = isorender_value_for(&options->glyphs, number);
    int glyph = ISO_GLYPH_SPHERE;
    if (value) ISO_TRY(choose("glyph", value, names, &glyph, error));
    object->glyph = (iso_glyph)glyph;
    object->glyph_given = value != NULL;
    ISO_TRY(set_above_0("glyph-scale", isorender_value_for(&options->glyph_scales, number),
                        &object->field.scale, error));
    ISO_TRY(set_projection(isorender_value_for(&options->projections, number), object, error));
    ISO_TRY(isorender_parse_opacity("glyph-opacity", isorender_value_for(&options->glyph_opacities, number),
                                    &object->opacity, error));
    ISO_TRY(set_radius("glyph-radius", isorender_value_for(&options->glyph_radii, number), object, error));
    return set_color("glyph-color", isorender_value_for(&options->glyph_colors, number), object, error);
}

iso_status isorender_check_count(const char *option, const iso_texts *texts, const char *objects, int count,
                                 iso_error *error) {
    if (texts->count <= count) return ISO_OK;
    if (count == 0)
        return iso_fail(error, ISO_ERR_USAGE, "--%s is for %s, which is not given%s", option, objects,
                        strcmp(option, "color-by") ? "" : ": --surface-color-by colours surfaces");
    return iso_fail(error, ISO_ERR_USAGE, "--%s is given %d times for %d %s", option, texts->count, count,
                    objects);
}

/* counts: of objects by kind. */
static iso_status check_counts(const isorender_object_options *o, const int counts[ISO_OBJECT_KINDS],
                               iso_error *error) {
    const int lines = counts[ISO_OBJECT_LINES], glyphs = counts[ISO_OBJECT_GLYPHS],
              meshes = counts[ISO_OBJECT_MESH];
    static const char both[] = "--lines or --glyphs", any[] = "--lines, --glyphs or a file of points",
                      colored[] = "--lines, --glyphs, a file of points or --surface-color-by";
    const int columns = lines + glyphs + o->has_cloud;
    const struct {
        const char *name;
        const iso_texts *texts;
        const char *objects;
        int count;
    } options[] = {
        {"tube-radius", &o->tube_radii, "--lines", lines},
        {"line-color", &o->line_colors, "--lines", lines},
        {"line-opacity", &o->line_opacities, "--lines", lines},
        {"line-style", &o->line_styles, "--lines", lines},
        {"line-shading", &o->line_shadings, "--lines", lines},
        {"caps", &o->caps, "--lines", lines},
        {"streamlines", &o->streamlines, "--lines", lines},
        {"streamline-length", &o->streamline_lengths, "--lines", lines},
        {"streamline-seed", &o->streamline_seeds, "--lines", lines},
        {"glyph", &o->glyphs, "--glyphs", glyphs},
        {"glyph-scale", &o->glyph_scales, "--glyphs", glyphs},
        {"vectors", &o->arrays, both, lines + glyphs},
        {"least", &o->leasts, both, lines + glyphs},
        {"tensor-order", &o->tensor_orders, both, lines + glyphs},
        {"glyph-radius", &o->glyph_radii, "--glyphs", glyphs},
        {"glyph-color", &o->glyph_colors, "--glyphs", glyphs},
        {"glyph-opacity", &o->glyph_opacities, "--glyphs", glyphs},
        {"glyph-projection", &o->projections, "--glyphs", glyphs},
        {"surface-color", &o->mesh_colors, "--surface", meshes},
        {"surface-opacity", &o->mesh_opacities, "--surface", meshes},
        {"color-by", &o->color_by, any, columns},
        {"colormap", &o->maps, colored, columns + o->colorings},
        {"range", &o->ranges, colored, columns + o->colorings},
        {"every", &o->every, any, columns},
        {"space", &o->spaces, "--lines, --glyphs, --surface or a file of points", o->count + o->has_cloud}};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        ISO_TRY(isorender_check_count(options[i].name, options[i].texts, options[i].objects, options[i].count,
                                      error));
    return ISO_OK;
}

/* number: of the object, of those of its kind. */
static iso_status set_kind(const isorender_object_options *options, int number,
                           isorender_object_settings *object, iso_error *error) {
    object->radius = NAN;
    object->opacity = 1;
    if (object->kind == ISO_OBJECT_LINES) return set_lines(options, number, object, error);
    if (object->kind == ISO_OBJECT_GLYPHS) return set_glyphs(options, number, object, error);
    ISO_TRY(isorender_parse_opacity("surface-opacity", isorender_value_for(&options->mesh_opacities, number),
                                    &object->opacity, error));
    return set_color("surface-color", isorender_value_for(&options->mesh_colors, number), object, error);
}

/* Decides whether an object is coloured by a colour or by a column (--color-by) when the options give both.
 * Two values that were given for this very object are an error. If one of them is only the last value of
 * its option, which repeats for all further objects, the other one counts. number: of the object among
 * those of its kind; column: among those that --color-by counts. */
static iso_status settle_colors(const isorender_object_options *options, int number, int column,
                                isorender_object_settings *object, iso_error *error) {
    const bool lines = object->kind == ISO_OBJECT_LINES;
    const iso_texts *colors = lines ? &options->line_colors : &options->glyph_colors;
    const bool own_color = number < colors->count, own_column = column < options->color_by.count;
    if (!object->color_by || !colors->count) return ISO_OK;
    if (own_color && own_column)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --%s-color and --color-by both say how it is coloured",
                        object->path, lines ? "line" : "glyph");
    if (own_color)
        object->color_by = NULL;
    else
        object->colored = object->by_direction = false;
    return ISO_OK;
}

iso_status isorender_objects_resolve(const isorender_object_options *options,
                                     isorender_object_settings objects[ISORENDER_OBJECTS],
                                     isorender_object_settings *cloud, iso_error *error) {
    int counts[ISO_OBJECT_KINDS] = {0}, common = 0;
    *cloud = (isorender_object_settings){.kind = ISO_OBJECT_GLYPHS, .radius = NAN, .opacity = 1};
    if (options->has_cloud) {
        ISO_TRY(set_space(isorender_value_for(&options->spaces, 0), cloud, error));
        ISO_TRY(set_common(options, common++, cloud, error));
    }
    for (int i = 0; i < options->count; i++) {
        isorender_object_settings *object = &objects[i];
        *object = (isorender_object_settings){.kind = options->kinds[i], .path = options->paths[i]};
        const int number = counts[object->kind]++;
        ISO_TRY(set_kind(options, number, object, error));
        ISO_TRY(set_space(isorender_value_for(&options->spaces, i + options->has_cloud), object, error));
        if (object->kind == ISO_OBJECT_MESH) continue;
        ISO_TRY(set_common(options, common, object, error));
        ISO_TRY(settle_colors(options, number, common++, object, error));
    }
    return check_counts(options, counts, error);
}
