/* Looks up the names of tools, solids and falloffs, checks that the numbers of a brush are in their ranges,
 * and finds the images of its touches. */
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

/* ---- images */

bool iso_brush_is_radial(const iso_brush *brush) {
    return brush->radial > 1;
}

int iso_brush_radial_axis(const iso_brush *brush) {
    return brush->radial_axis ? brush->radial_axis - 'x' : 2;
}

bool iso_brush_is_repeated(const iso_brush *brush) {
    return brush->repeat[0] > 1 || brush->repeat[1] > 1;
}

/* Returns the turn number `index` of `count` around an axis; half and quarter turns are exact. */
static iso_brush_image make_turn(int index, int count, int axis) {
    static const double quarters[] = {1, 0, -1, 0};
    iso_brush_image image = {.axis = axis, .turned = index > 0};
    if (4 * index % count == 0) {
        image.cosine = quarters[4 * index / count];
        image.sine = quarters[(4 * index / count + 3) % 4];
    } else
        iso_sincos(2 * ISO_PI * index / count, &image.sine, &image.cosine);
    return image;
}

static int turns_of(const iso_brush *brush) {
    return iso_brush_is_radial(brush) ? (int)brush->radial : 1;
}

/* The mirror planes that make further images: two along the axis of a radial symmetry make half a turn, which
 * is there already if the number of turns is even. */
static unsigned planes_of(const iso_brush *brush) {
    const int axis = iso_brush_radial_axis(brush);
    const unsigned beside = (1u << (axis + 1) % 3) | (1u << (axis + 2) % 3);
    const bool twice = turns_of(brush) % 2 == 0 && (brush->symmetry & beside) == beside;
    return twice ? brush->symmetry & ~(1u << (axis + 2) % 3) : brush->symmetry;
}

static int repeats(const iso_brush *brush, int which) {
    return brush->repeat[which] > 1 ? (int)brush->repeat[which] : 1;
}

int iso_brush_image_count(const iso_brush *brush) {
    int count = turns_of(brush) * repeats(brush, 0) * repeats(brush, 1);
    for (int axis = 0; axis < 3; axis++) count *= planes_of(brush) >> axis & 1 ? 2 : 1;
    return count;
}

int iso_brush_images(const iso_brush *brush, iso_brush_image images[ISO_IMAGES_MOST]) {
    const int turns = turns_of(brush), along = repeats(brush, 0), copies = along * repeats(brush, 1);
    const unsigned planes = planes_of(brush);
    int count = 0;
    for (unsigned bits = 0; bits < 8; bits++)
        for (int i = 0; i < turns * copies && !(bits & ~planes) && count < ISO_IMAGES_MOST; i++) {
            const int copy = i / turns;
            iso_brush_image *image = &images[count++];
            *image = make_turn(i % turns, turns, iso_brush_radial_axis(brush));
            image->through = brush->mirror;
            image->mirrored = bits;
            image->moved = copy > 0;
            image->by = iso_vec3_add(iso_vec3_scale(brush->repeat_by[0], copy % along),
                                     iso_vec3_scale(brush->repeat_by[1], copy / along));
        }
    return count;
}

static iso_vec3 turn(const iso_brush_image *image, iso_vec3 v) {
    const double in[3] = {v.x, v.y, v.z};
    const int a = image->axis, b = (a + 1) % 3, c = (a + 2) % 3;
    double out[3];
    out[a] = in[a];
    out[b] = image->cosine * in[b] - image->sine * in[c];
    out[c] = image->sine * in[b] + image->cosine * in[c];
    return iso_vec3_make(out[0], out[1], out[2]);
}

/* Mirrors `v` at the planes through `at`. */
static iso_vec3 reflect(const iso_brush_image *image, iso_vec3 v, iso_vec3 at) {
    const unsigned bits = image->mirrored;
    return iso_vec3_make(bits & 1 ? 2 * at.x - v.x : v.x, bits & 2 ? 2 * at.y - v.y : v.y,
                         bits & 4 ? 2 * at.z - v.z : v.z);
}

iso_vec3 iso_brush_image_point(const iso_brush_image *image, iso_vec3 point) {
    const iso_vec3 at = image->through;
    if (image->moved) point = iso_vec3_add(point, image->by);
    return reflect(image, image->turned ? iso_vec3_add(turn(image, iso_vec3_sub(point, at)), at) : point, at);
}

iso_vec3 iso_brush_image_direction(const iso_brush_image *image, iso_vec3 direction) {
    return reflect(image, image->turned ? turn(image, direction) : direction, iso_vec3_make(0, 0, 0));
}
