/* glyphs: solids at points, as they are read from files and as renderers draw them: atoms, arrows, tensors.
 */
#ifndef ISO_BASE_GLYPHS_H
#define ISO_BASE_GLYPHS_H

#include "base/lines.h"

/* The names of the solids, in the order of iso_glyph: X(name, text). */
#define ISO_GLYPHS(X)                                                                                        \
    X(SPHERE, "sphere")                                                                                      \
    X(CONE, "cone")                                                                                          \
    X(CYLINDER, "cylinder")                                                                                  \
    X(ARROW, "arrow")                                                                                        \
    X(ELLIPSOID, "ellipsoid")                                                                                \
    X(DISC, "disc")                                                                                          \
    X(BOX, "box")

/* Points with what a file says of their sizes and directions, in world millimetres, LPS. All arrays are owned
 * and have one item per point; zero-initialise, iso_glyphs_free. */
typedef struct iso_glyphs {
    iso_vec3 origin; /* added to every position: positions far from 0 keep their precision */
    float (*positions)[3];
    size_t count;
    float *radii;           /* mm, not negative; NULL: the file has none */
    float (*directions)[3]; /* mm, with their lengths; NULL: the file has none */
    bool closed;            /* all points of closed surfaces, with outward normals as their directions */
    bool gaussians;       /* 3-D Gaussians: `axes` are their standard deviations, and the attribute "opacity",
                               0 .. 1, belongs to them */
    float (*axes)[9];     /* three half axes of an ellipsoid or box, mm, one after the other; NULL: none */
    uint8_t (*colors)[3]; /* red green blue, display values; NULL: the file has none */
    uint8_t *opacities;   /* 0 (not seen) to 255 (opaque); NULL: all are opaque, or the file has none */
    iso_attribute *attributes;
    int attribute_count;
} iso_glyphs;

void iso_glyphs_free(iso_glyphs *glyphs);
/* World box of all positions, without sizes; empty when there are none. */
iso_box iso_glyphs_bounds(const iso_glyphs *glyphs);
/* The position of a glyph in the world. */
iso_vec3 iso_glyph_position(const iso_glyphs *glyphs, size_t index);
/* Whether a position lies in a box; the box's faces belong to it. */
bool iso_position_is_inside(iso_vec3 position, const iso_box *box);
/* Removes the glyphs whose positions lie outside a world box; its faces belong to it. */
void iso_glyphs_crop(iso_glyphs *glyphs, const iso_box *box);
/* The radius in mm with which glyphs without sizes are drawn: a seventh of their mean distance if they fill
 * their box evenly, but not more than a 150th of its diagonal. 0 for cones, cylinders and arrows: theirs
 * follows from their length. */
double iso_glyphs_usual_radius(const iso_glyphs *glyphs, iso_glyph glyph);

#endif
