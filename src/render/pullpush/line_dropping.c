/* line_dropping: which vertices of lines a picture can do without (Marroquim, Kraus and Cavalcanti 2008,
 * section 4.1: a geometry shader "could drop any number of inner vertices of a polyline depending on a
 * specified level of detail"). A vertex is left out at a tolerance if its ball lies within that of the vertex
 * before it that is kept, enlarged by the tolerance; of a ribbon its edges as well. So neither the line nor
 * its outline moves by more than the tolerance. Vertices that are left out at a tolerance are left out at all
 * larger ones, with all that they stand for. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "render/pullpush/line_fragments.h"

/* Levels of tolerances, powers of the square root of 2, around that of the mean length of a segment. */
enum { LEVELS_BELOW = 12, LEVELS_ABOVE = 16 };
static const double ROOT_OF_HALF = 0.70710678118654752;
/* Colours that differ by more steps than this are kept. */
enum { SAME_COLOR = 4 };

static double length_of_difference(const float *a, const float *b) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    return sqrt(sum);
}

/* How far what a vertex shows reaches beyond what another one shows, mm. */
static double reach_beyond(const iso_pyramid_lines *set, size_t i, size_t from) {
    const iso_lines *lines = &set->lines;
    double beyond = length_of_difference(lines->vertices[i], lines->vertices[from]) +
                    fabs((double)set->radii[i] - (double)set->radii[from]);
    if (set->opts.style == ISO_LINE_RIBBON)
        beyond += (double)set->radii[i] * length_of_difference(lines->normals[i], lines->normals[from]);
    for (int k = 0; k < 3 && lines->colors; k++)
        if (abs(lines->colors[i][k] - lines->colors[from][k]) > SAME_COLOR) return INFINITY;
    return beyond;
}

/* Vertices at which segments begin and end, but for the first of a run and those at the ends of lines. */
static bool can_drop(const iso_pyramid_lines *set, size_t i) {
    return i % ISO_LINE_RUN && set->segments[i - 1] && set->segments[i];
}

/* The highest level whose tolerance is at most this, mm. */
static int level_of(double tolerance) {
    int exponent;
    const double part = frexp(tolerance, &exponent);
    return 2 * (exponent - 1) + (part >= ROOT_OF_HALF) + ISO_LINE_DROP_0;
}

static double tolerance_of(int level) {
    const int steps = level - ISO_LINE_DROP_0 + 256; /* not negative */
    return ldexp(steps & 1 ? 2 * ROOT_OF_HALF : 1, steps / 2 - 128);
}

/* Leaves out what a level's tolerance can do without; returns how many vertices are left that can be
 * left out. beyond: of each vertex, how far those that it stands for reach beyond it, mm. */
static size_t drop_at(iso_pyramid_lines *set, int level, float *beyond) {
    const double tolerance = tolerance_of(level);
    size_t kept = 0, left = 0;
    for (size_t i = 1; i < set->lines.vertex_count; i++) {
        if (set->drop[i] != ISO_LINE_KEPT) continue;
        const double reach = can_drop(set, i) ? (double)beyond[i] + reach_beyond(set, i, kept) : INFINITY;
        if (reach <= tolerance) {
            set->drop[i] = (uint8_t)level;
            beyond[kept] = fmaxf(beyond[kept], (float)reach);
        } else {
            kept = i;
            left += can_drop(set, i);
        }
    }
    return left;
}

static double mean_length(const iso_pyramid_lines *set) {
    double length = 0;
    size_t count = 0;
    for (size_t i = 0; i + 1 < set->lines.vertex_count; i++) {
        if (!set->segments[i]) continue;
        length += length_of_difference(set->lines.vertices[i], set->lines.vertices[i + 1]);
        count++;
    }
    return count ? length / (double)count : 0;
}

iso_status iso_line_dropping_prepare(iso_pyramid_lines *set, iso_error *error) {
    memset(set->drop, ISO_LINE_KEPT, set->lines.vertex_count);
    const double mean = mean_length(set);
    if (!(set->opts.drop_pixels > 0) || !(mean > 0) || !isfinite(mean)) return ISO_OK;
    float *beyond = iso_alloc_zero(set->lines.vertex_count, sizeof *beyond);
    if (!beyond) return iso_fail_memory(error, "lines");
    const int first = iso_clamp_index(level_of(mean) - LEVELS_BELOW, ISO_LINE_KEPT),
              end = iso_clamp_index(level_of(mean) + LEVELS_ABOVE, ISO_LINE_KEPT);
    for (int level = first; level < end && drop_at(set, level, beyond); level++) {
    }
    iso_free(beyond);
    return ISO_OK;
}

uint8_t iso_line_dropping_level(const iso_pyramid_lines *set, double pixel) {
    const double tolerance = set->opts.drop_pixels * pixel;
    if (!(tolerance > 0) || !isfinite(tolerance)) return 0;
    return (uint8_t)iso_clamp_index(level_of(tolerance), ISO_LINE_KEPT);
}
