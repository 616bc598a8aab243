/* Looks up the names of tools, solids and falloffs, and checks that the numbers of a brush are in their
 * ranges. */
#include "sculpt/brush/brush.h"

#include <math.h>
#include <string.h>

#define ISO_NAME(name, text) text,
static const char *const tools[] = {ISO_TOOLS(ISO_NAME)};
static const char *const solids[] = {ISO_SOLIDS(ISO_NAME)};
static const char *const falloffs[] = {ISO_FALLOFFS(ISO_NAME)};
static const char *const alphas[] = {ISO_ALPHAS(ISO_NAME)};
#undef ISO_NAME

const char *iso_tool_name(iso_tool tool) {
    return tools[tool];
}
const char *iso_solid_name(iso_solid solid) {
    return solids[solid];
}
const char *iso_falloff_name(iso_falloff falloff) {
    return falloffs[falloff];
}

const char *iso_alpha_name(iso_alpha alpha) {
    return alphas[alpha];
}

/* Returns the index of `name` in `names`, or -1 if it is not there. */
static int find_name(const char *const *names, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0) return i;
    return -1;
}

iso_status iso_tool_find(const char *name, iso_tool *tool, iso_error *error) {
    int found = find_name(tools, ISO_TOOL_COUNT, name);
    if (found < 0) return iso_fail(error, ISO_ERR_USAGE, "no brush is called '%s'", name);
    *tool = (iso_tool)found;
    return ISO_OK;
}

iso_status iso_solid_find(const char *name, iso_solid *solid, iso_error *error) {
    int found = find_name(solids, ISO_SOLID_COUNT, name);
    if (found < 0) return iso_fail(error, ISO_ERR_USAGE, "no shape is called '%s'", name);
    *solid = (iso_solid)found;
    return ISO_OK;
}

iso_status iso_falloff_find(const char *name, iso_falloff *falloff, iso_error *error) {
    int found = find_name(falloffs, ISO_FALLOFF_COUNT, name);
    if (found < 0) return iso_fail(error, ISO_ERR_USAGE, "no falloff is called '%s'", name);
    *falloff = (iso_falloff)found;
    return ISO_OK;
}

iso_status iso_alpha_find(const char *name, iso_alpha *alpha, iso_error *error) {
    int found = find_name(alphas, ISO_ALPHA_COUNT, name);
    if (found < 0) return iso_fail(error, ISO_ERR_USAGE, "alpha: '%s' is none of none, fixed, follows", name);
    *alpha = (iso_alpha)found;
    return ISO_OK;
}

typedef struct range {
    const char *name;
    double value, low, high;
} range;

static iso_status check_images(const iso_brush *brush, iso_error *error) {
    for (int i = 0; i < 2; i++) {
        const iso_vec3 by = brush->repeat_by[i];
        const double length = iso_vec3_length(by);
        if (brush->repeat[i] > ISO_IMAGES_MOST)
            return iso_fail(error, ISO_ERR_USAGE, "brush: repeated %u times: at most %d", brush->repeat[i],
                            ISO_IMAGES_MOST);
        if (brush->repeat[i] > 1 && !(length > 0 && length <= 1e9))
            return iso_fail(error, ISO_ERR_USAGE,
                            "brush: repeated images that are moved by %g mm: must be above 0, at most 1e9",
                            length);
    }
    const int count = iso_brush_image_count(brush);
    return count <= ISO_IMAGES_MOST
               ? ISO_OK
               : iso_fail(error, ISO_ERR_USAGE, "brush: %d images of a touch: at most %d", count,
                          ISO_IMAGES_MOST);
}

iso_status iso_brush_check(const iso_brush *brush, iso_error *error) {
    if ((unsigned)brush->tool >= ISO_TOOL_COUNT || (unsigned)brush->shape >= ISO_SOLID_COUNT ||
        (unsigned)brush->falloff >= ISO_FALLOFF_COUNT || (unsigned)brush->alpha >= ISO_ALPHA_COUNT ||
        brush->symmetry > 7)
        return iso_fail(error, ISO_ERR_USAGE,
                        "brush: tool %d, shape %d, falloff %d, alpha %d, symmetry %u: no such thing",
                        (int)brush->tool, (int)brush->shape, (int)brush->falloff, (int)brush->alpha,
                        brush->symmetry);
    if (brush->radial > ISO_RADIAL_MOST || (brush->radial_axis && !strchr("xyz", brush->radial_axis)))
        return iso_fail(error, ISO_ERR_USAGE,
                        "brush: %u radial images around axis %d: at most %d around 'x', 'y' or 'z'",
                        brush->radial, brush->radial_axis, ISO_RADIAL_MOST);
    if (!(brush->radius > 0) || !isfinite(brush->radius))
        return iso_fail(error, ISO_ERR_USAGE, "brush: radius %g mm: must be above 0", brush->radius);
    const range ranges[] = {
        {"strength", brush->strength, 0, 1},      {"aspect", brush->aspect, 0, 10},
        {"blend", brush->blend, 0, 10},           {"spacing", brush->spacing, 0, 10},
        {"mirror x", brush->mirror.x, -1e9, 1e9}, {"mirror y", brush->mirror.y, -1e9, 1e9},
        {"mirror z", brush->mirror.z, -1e9, 1e9}};
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (!(ranges[i].value >= ranges[i].low && ranges[i].value <= ranges[i].high))
            return iso_fail(error, ISO_ERR_USAGE, "brush: %s %g: must be %g .. %g", ranges[i].name,
                            ranges[i].value, ranges[i].low, ranges[i].high);
    return check_images(brush, error);
}

static bool is_same_line(const iso_brush *a, const iso_brush *b, int which) {
    const iso_vec3 *p = &a->repeat_by[which], *q = &b->repeat_by[which];
    if (a->repeat[which] < 2 || b->repeat[which] < 2) return a->repeat[which] < 2 && b->repeat[which] < 2;
    return a->repeat[which] == b->repeat[which] && p->x == q->x && p->y == q->y && p->z == q->z;
}

bool iso_brush_is_same(const iso_brush *a, const iso_brush *b) {
    return a->tool == b->tool && a->shape == b->shape && a->falloff == b->falloff && a->radius == b->radius &&
           a->strength == b->strength && a->aspect == b->aspect && a->blend == b->blend &&
           a->spacing == b->spacing && a->alpha == b->alpha && a->symmetry == b->symmetry &&
           a->mirror.x == b->mirror.x && a->mirror.y == b->mirror.y && a->mirror.z == b->mirror.z &&
           iso_brush_is_radial(a) == iso_brush_is_radial(b) &&
           (!iso_brush_is_radial(a) ||
            (a->radial == b->radial && iso_brush_radial_axis(a) == iso_brush_radial_axis(b))) &&
           is_same_line(a, b, 0) && is_same_line(a, b, 1) && a->pressure_radius == b->pressure_radius &&
           a->pressure_strength == b->pressure_strength && a->has_color == b->has_color &&
           (!a->has_color ||
            (a->color.r == b->color.r && a->color.g == b->color.g && a->color.b == b->color.b));
}
