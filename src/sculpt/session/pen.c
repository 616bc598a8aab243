/* Turns the samples of a stroke into touches. */
#include "sculpt/session/pen.h"

#include "sculpt/brush/dab.h"
#include "sculpt/limits.h"

static iso_status touch_sample(iso_pen *pen, const iso_sample *sample, iso_error *error) {
    const iso_touch touch = {.sample = *sample, .previous = pen->previous, .first = pen->first};
    ISO_TRY(pen->touch(pen->context, &pen->brush, &touch, error));
    pen->previous = *sample;
    return ISO_OK;
}

static double mix(double a, double b, double t) {
    return a + t * (b - a);
}

static iso_sample sample_between(const iso_sample *a, const iso_sample *b, double t) {
    iso_sample s = {.pressure = mix(a->pressure, b->pressure, t), .seconds = mix(a->seconds, b->seconds, t)};
    s.position = iso_vec3_add(a->position, iso_vec3_scale(iso_vec3_sub(b->position, a->position), t));
    s.normal = iso_vec3_unit(iso_vec3_add(a->normal, iso_vec3_scale(iso_vec3_sub(b->normal, a->normal), t)));
    return s;
}

iso_status iso_pen_begin(iso_pen *pen, const iso_brush *brush, const iso_sample *sample, iso_error *error) {
    pen->brush = *brush;
    pen->first = pen->previous = *sample;
    if (iso_tool_is_trim(brush->tool)) return ISO_OK;
    return touch_sample(pen, sample, error);
}

iso_status iso_pen_move(iso_pen *pen, const iso_sample *sample, iso_error *error) {
    const iso_brush *brush = &pen->brush;
    if (iso_tool_is_whole_mask(brush->tool)) return ISO_OK; /* the first touch has done it */
    if (iso_tool_is_trim(brush->tool)) return ISO_OK;       /* the last one does it */
    if (brush->tool == ISO_TOOL_MOVE ||
        (brush->shape == ISO_SOLID_CAPSULE && brush->tool <= ISO_TOOL_BLEND_CARVE))
        return touch_sample(pen, sample, error); /* one touch covers the whole line */
    double spacing_mm = brush->radius * (brush->spacing > 0 ? brush->spacing : 0.25);
    const iso_sample from = pen->previous;
    double length_mm = iso_vec3_length(iso_vec3_sub(sample->position, from.position));
    if (!(length_mm / spacing_mm <= ISO_LIMIT_TOUCHES))
        return iso_fail(error, ISO_ERR_USAGE, "a sample that makes %.4g touches: at most %d",
                        length_mm / spacing_mm, ISO_LIMIT_TOUCHES);
    for (double along = spacing_mm; along <= length_mm; along += spacing_mm) {
        iso_sample s = sample_between(&from, sample, along / length_mm);
        ISO_TRY(touch_sample(pen, &s, error));
    }
    return ISO_OK;
}

iso_status iso_pen_end(iso_pen *pen, const iso_sample *path, size_t count, iso_error *error) {
    const iso_touch touch = {.sample = path[count - 1],
                             .previous = path[count - 1],
                             .first = path[0],
                             .path = path,
                             .path_count = count};
    return iso_tool_is_trim(pen->brush.tool) ? pen->touch(pen->context, &pen->brush, &touch, error) : ISO_OK;
}
