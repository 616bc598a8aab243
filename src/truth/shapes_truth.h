/* shapes_truth: one ray through all shapes of a set, in extended precision: what render/shapes is judged by.
 *
 * Simple rather than fast: every shape is intersected with every ray that meets its bounding sphere. It
 * shares no code with render/shapes but the options. */
#ifndef ISO_TRUTH_SHAPES_TRUTH_H
#define ISO_TRUTH_SHAPES_TRUTH_H

#include "image/camera.h"
#include "render/shapes/shapes.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The shapes of a set as one view sees them. */
typedef struct iso_shapes_truth iso_shapes_truth;

/* What is drawn; all borrowed for the call. */
typedef struct iso_shapes_scene {
    const iso_glyphs *glyphs; /* NULL: lines */
    const iso_lines *lines;
    iso_shapes_opts opts;
} iso_shapes_scene;

/* The view is borrowed until iso_shapes_truth_destroy. Numbers must be finite. ISO_ERR_NOMEM. */
iso_status iso_shapes_truth_create(const iso_shapes_scene *scene, const iso_view *view,
                                   iso_shapes_truth **truth, iso_error *error);
void iso_shapes_truth_destroy(iso_shapes_truth *truth);

/* Where a ray first meets the surface of a shape at or behind the view's near plane. A shape that the near
 * plane cuts is seen from inside. */
typedef struct iso_shapes_hit {
    bool hit;
    double depth;     /* view z */
    double behind;    /* of the next shape whose surface the ray meets; INFINITY: of none */
    double normal[3]; /* unit, view space, out of the shape */
    double size;      /* the shape's smallest radius, mm: what errors are compared with */
    size_t shape;     /* number of the glyph, or of the segment's first vertex */
} iso_shapes_hit;

/* The hit of the ray through the position (px, py) of the picture, in pixels. */
iso_shapes_hit iso_shapes_truth_ray(const iso_shapes_truth *truth, double px, double py);

/* A place where a ray enters or leaves a translucent glyph or line, or meets a ribbon or a disc. */
typedef struct iso_shapes_layer {
    double depth;     /* view z */
    double normal[3]; /* unit, view space, out of the solid; of ribbons and discs on the ray's side */
    bool leaves;
    size_t shape; /* number of the glyph, or of a segment's first vertex */
} iso_shapes_layer;

/* All layers of the ray through (px, py), front to back, from the near plane on: up to `most` of them. The
 * segments of one line are one solid: what lies inside another of them is no layer. Returns their number.
 * For one thread. */
size_t iso_shapes_truth_layers(iso_shapes_truth *truth, double px, double py, iso_shapes_layer *layers,
                               size_t most);

#ifdef __cplusplus
}
#endif
#endif
