/* lines: polylines as they are read from files and as renderers draw them: tracts, vessels, neurons,
 * streamlines. */
#ifndef ISO_BASE_LINES_H
#define ISO_BASE_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/status.h"

ISO_C_BEGIN

/* A named column of numbers: `components` floats for each vertex, glyph or line, as `per_line` says. */
typedef struct iso_attribute {
    char *name; /* owned; UTF-8, unique in its set */
    int components;
    bool per_line;
    float *values; /* owned */
} iso_attribute;

/* Polylines in world millimetres, LPS. All arrays are owned; zero-initialise, iso_lines_free. */
typedef struct iso_lines {
    iso_vec3 origin;      /* added to every vertex: vertices far from 0 keep their precision */
    float (*vertices)[3]; /* all lines' vertices, one line after the other */
    size_t *starts;       /* line_count + 1: line i has the vertices starts[i] .. starts[i + 1] - 1 */
    size_t vertex_count, line_count;
    float *radii;         /* one per vertex, mm, not negative; NULL: the file has none */
    float (*normals)[3];  /* one per vertex, across a ribbon's face, unit or (no direction) 0; NULL: none */
    uint8_t (*colors)[3]; /* one per vertex, red green blue, display values; NULL: the file has none */
    iso_attribute *attributes;
    int attribute_count;
} iso_lines;

/* Returns the origin for a set whose first vertex is `first`. Coordinates beyond 4096 mm are rounded to whole
 * millimetres, and the others are 0, so that vertices stored relative to the origin in floats are precise to
 * half a micrometre wherever the set lies. */
iso_vec3 iso_origin_for(const double first[3]);

/* Frees names and values, and the array itself. NULL is fine. */
void iso_attributes_free(iso_attribute *attributes, int count);

/* The box of positions, to which `origin` is added; empty when there are none. */
iso_box iso_positions_bounds(iso_vec3 origin, const float (*positions)[3], size_t count);

void iso_lines_free(iso_lines *lines);
/* World box of all vertices, without radii; empty when there are none. */
iso_box iso_lines_bounds(const iso_lines *lines);
/* The direction of a line at each of its vertices: unit, between the directions of the segments before and
 * after it, of which those without length are left out; 0 where a line is a single place. `tangents` has a
 * vector for each vertex, `stride` floats apart. */
void iso_lines_tangents(const iso_lines *lines, float *tangents, size_t stride);
/* Makes normals for lines that have none: each turns as little as possible from one vertex to the next, so
 * that a ribbon has no twist but that of its line.
 *
 * Errors: ISO_ERR_NOMEM; the lines are unchanged.
 * Source: Wang, Juttler, Zheng, Liu 2008, "Computation of rotation minimizing frames" (ACM TOG 27(1)), the
 * double reflection method (section 4). */
iso_status iso_lines_add_normals(iso_lines *lines, iso_error *error);
/* Number of segments of all lines. */
size_t iso_lines_segment_count(const iso_lines *lines);
/* The radius in mm of tubes along lines without radii: half the mean length of a segment, so that every bend
 * is seen, but not more than a 300th of the diagonal of the bounds. Above 0. */
double iso_lines_usual_radius(const iso_lines *lines);

ISO_C_END
#endif
