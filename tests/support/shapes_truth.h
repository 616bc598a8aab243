/* shapes_truth: intersects a ray with all shapes of a set in extended precision: the reference that
 * render/shapes is compared with.
 *
 * Simple rather than fast: every shape is intersected with every ray that meets its bounding sphere. It
 * shares no code with render/shapes except the options. */
#ifndef ISO_TESTS_SHAPES_TRUTH_H
#define ISO_TESTS_SHAPES_TRUTH_H

#include "image/camera.h"
#include "render/shapes/shapes.h"

/* The shapes of a set, prepared for one view. */
typedef struct iso_shapes_truth iso_shapes_truth;

/* The shapes to intersect, either glyphs or lines; all pointers are borrowed for the call. */
typedef struct iso_shapes_scene {
    const iso_glyphs *glyphs; /* NULL: lines */
    const iso_lines *lines;
    iso_shapes_opts opts;
} iso_shapes_scene;

/* Prepares the shapes for a view, which is borrowed until iso_shapes_truth_destroy. All numbers must be
 * finite. ISO_ERR_NOMEM. */
iso_status iso_shapes_truth_create(const iso_shapes_scene *scene, const iso_view *view,
                                   iso_shapes_truth **truth, iso_error *error);
void iso_shapes_truth_destroy(iso_shapes_truth *truth);

/* Where a ray first meets the surface of a shape at or behind the view's near plane. A shape that the near
 * plane cuts is seen from inside. */
typedef struct iso_shapes_hit {
    bool hit;
    double depth;     /* view z, mm */
    double behind;    /* view z of the next shape along the ray, mm; INFINITY: there is none */
    double normal[3]; /* unit, view space, out of the shape */
    double size;      /* the shape's smallest radius, mm: the scale that errors are compared with */
    size_t shape;     /* number of the glyph, or of the segment's first vertex */
} iso_shapes_hit;

/* Returns the first hit of the ray through the position (px, py) of the picture, in pixels. */
iso_shapes_hit iso_shapes_truth_ray(const iso_shapes_truth *truth, double px, double py);

/* An intersection of a ray with a translucent glyph or line: where it enters or leaves the solid, or where it
 * meets a ribbon or a disc. */
typedef struct iso_shapes_layer {
    double depth;     /* view z, mm */
    double normal[3]; /* unit, view space; out of the solid, of ribbons and discs against the ray */
    bool leaves;
    size_t shape; /* number of the glyph, or of a segment's first vertex */
} iso_shapes_layer;

/* Finds the layers of the ray through (px, py) behind the near plane, front to back, at most `most` of them.
 * The segments of one line are one solid: an intersection inside another segment of the line is no layer.
 * Returns the number of layers. Not thread-safe. */
size_t iso_shapes_truth_layers(iso_shapes_truth *truth, double px, double py, iso_shapes_layer *layers,
                               size_t most);

#endif
