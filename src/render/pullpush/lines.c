/* lines: prepares lines for their fragments: radii, and legs between ends and sharp bends. */
#include "render/pullpush/lines.h"

#include <math.h>

#include "base/memory.h"
#include "render/pullpush/line_fragments.h"
#include "render/shapes/prepare.h"

/* The cosine of a sharp bend. */
static const double BEND = 0.94;

static bool is_finite(const float *numbers) {
    return isfinite(numbers[0]) && isfinite(numbers[1]) && isfinite(numbers[2]);
}

static float length_between(const float *a, const float *b) {
    const double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1],
                 z = (double)b[2] - (double)a[2];
    return (float)sqrt(x * x + y * y + z * z);
}

static void set_radii(iso_pyramid_lines *made) {
    const iso_lines *lines = &made->lines;
    const double scale = made->opts.scale > 0 ? made->opts.scale : 1;
    for (size_t i = 0; i < lines->vertex_count; i++)
        made->radii[i] = (float)((lines->radii ? (double)lines->radii[i] : made->opts.radius) * scale);
}

static bool is_vertex(const iso_pyramid_lines *made, size_t i) {
    const bool ribbon = made->opts.style == ISO_LINE_RIBBON;
    return is_finite(made->lines.vertices[i]) && made->radii[i] >= 0 && isfinite(made->radii[i]) &&
           !(ribbon && !is_finite(made->lines.normals[i]));
}

static bool is_segment(const iso_pyramid_lines *made, size_t i) {
    return is_vertex(made, i) && is_vertex(made, i + 1) &&
           (made->radii[i] > 0 || made->radii[i + 1] > 0 || made->opts.min_pixels > 0);
}

/* How the line turns at a vertex: returns the cosine of the angle, sets the radius of curvature. */
static double turn_at(const iso_pyramid_lines *made, size_t i, float *curve) {
    const float *a = made->lines.vertices[i - 1], *b = a + 3, *c = a + 6;
    double dot = 0, first = 0, second = 0;
    for (int k = 0; k < 3; k++) {
        const double before = (double)b[k] - (double)a[k], after = (double)c[k] - (double)b[k];
        dot += before * after;
        first += before * before;
        second += after * after;
    }
    const double cosine = first > 0 && second > 0 ? dot / sqrt(first * second) : 1,
                 chord = sqrt(0.5 * fmax(1 - cosine, 0)); /* the sine of half the angle */
    *curve = chord > 1e-6 ? (float)(0.25 * (sqrt(first) + sqrt(second)) / chord) : INFINITY;
    return cosine;
}

/* The legs of a line whose segments are first .. last. */
static void cut_line(iso_pyramid_lines *made, size_t first, size_t last) {
    for (size_t i = first; i <= last; i++) {
        const bool begins = i == first || !(made->segments[i - 1] & ISO_LINE_DRAWN);
        if (!is_segment(made, i)) continue;
        made->curves[i] = made->curves[i + 1] = INFINITY;
        const bool bends = !begins && turn_at(made, i, &made->curves[i]) < BEND;
        made->segments[i] = ISO_LINE_DRAWN;
        if (begins || (!bends && made->segments[i - 1] & ISO_LINE_STARTS))
            made->segments[i] |= ISO_LINE_STARTS;
        made->before[i] = begins || bends ? 0
                                          : made->before[i - 1] + length_between(made->lines.vertices[i - 1],
                                                                                 made->lines.vertices[i]);
    }
    for (size_t i = last + 1; i-- > first;) {
        if (!(made->segments[i] & ISO_LINE_DRAWN)) continue;
        const bool ends = i == last || !(made->segments[i + 1] & ISO_LINE_DRAWN),
                   bends = !ends && turn_at(made, i + 1, &made->curves[i + 1]) < BEND;
        if (ends || (!bends && made->segments[i + 1] & ISO_LINE_STOPS)) made->segments[i] |= ISO_LINE_STOPS;
        made->after[i] = ends || bends ? 0
                                       : made->after[i + 1] + length_between(made->lines.vertices[i + 1],
                                                                             made->lines.vertices[i + 2]);
    }
}

static iso_status reserve(iso_pyramid_lines *made, iso_error *error) {
    const size_t count = made->lines.vertex_count + 1;
    made->radii = iso_alloc(count * sizeof *made->radii);
    made->segments = iso_alloc_zero(count, sizeof *made->segments);
    made->before = iso_alloc(count * sizeof *made->before);
    made->after = iso_alloc(count * sizeof *made->after);
    made->curves = iso_alloc(count * sizeof *made->curves);
    made->drop = iso_alloc(count * sizeof *made->drop);
    if (made->radii && made->segments && made->before && made->after && made->curves && made->drop)
        return ISO_OK;
    return iso_fail_memory(error, "lines");
}

iso_status iso_pyramid_lines_create(const iso_lines *lines, const iso_shapes_opts *opts,
                                    iso_pyramid_lines **made, iso_error *error) {
    iso_shapes_opts resolved = *opts;
    if (isnan(opts->radius)) resolved.radius = iso_lines_usual_radius(lines);
    ISO_TRY(iso_shapes_check_lines(lines, &resolved, error));
    iso_pyramid_lines *set = iso_alloc_zero(1, sizeof *set);
    if (!set) return iso_fail_memory(error, "lines");
    set->lines = *lines;
    set->opts = resolved;
    iso_status status = reserve(set, error);
    if (status == ISO_OK) {
        set_radii(set);
        for (size_t line = 0; line < lines->line_count; line++)
            if (lines->starts[line] + 1 < lines->starts[line + 1])
                cut_line(set, lines->starts[line], lines->starts[line + 1] - 2);
        status = iso_line_dropping_prepare(set, error);
    }
    if (status == ISO_OK)
        *made = set;
    else
        iso_pyramid_lines_destroy(set);
    return status;
}

void iso_pyramid_lines_destroy(iso_pyramid_lines *lines) {
    if (!lines) return;
    iso_free(lines->radii);
    iso_free(lines->segments);
    iso_free(lines->before);
    iso_free(lines->after);
    iso_free(lines->curves);
    iso_free(lines->drop);
    iso_free(lines);
}
