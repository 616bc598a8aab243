/* object: lines, glyphs or a mesh beside the surfaces of a scene, prepared for drawing. */
#ifndef ISO_SCENE_OBJECT_H
#define ISO_SCENE_OBJECT_H

#include "image/aov.h"
#include "render/pullpush/lines.h"
#include "render/raster/triangles.h"
#include "render/shapes/fragments.h"

/* Zero-initialise, set what is drawn and how, iso_scene_object_free when done. */
typedef struct iso_scene_object {
    /* What is drawn; owned. */
    iso_shapes *shapes;               /* lines or glyphs as solids; NULL: a mesh */
    iso_pyramid_lines *pyramid_lines; /* the same lines, to be drawn by pull-push; NULL: as solids */
    iso_triangle_spans spans;         /* the triangles of a mesh */
    const iso_lines *lines;           /* of shapes that are lines: these lines, borrowed; else NULL */
    /* How. */
    iso_rgb color;                 /* of what has no colour of its own */
    iso_translucency translucency; /* of opacity 1: opaque */
    const iso_clip *clip;          /* what is cut away, but not of pyramid_lines; borrowed; NULL: nothing */
    /* How an opaque mesh is coloured by data; borrowed; NULL: in one colour. */
    const struct iso_coloring *coloring;
    struct iso_own_colors *own_colors; /* of a mesh's vertices; owned; NULL: none */
    bool in_pyramid;                   /* a mesh or ribbons, drawn in one image pyramid with surfaces */
    /* Totals over all pictures, set by drawing. */
    bool by_cpu;                /* drawn by the cpu engine where another was to draw the picture */
    iso_shapes_drawn drawn;     /* of opaque lines and glyphs */
    iso_shapes_layered layered; /* of what is translucent */
} iso_scene_object;

static inline bool iso_scene_object_is_opaque(const iso_scene_object *object) {
    return object->translucency.opacity >= 1;
}

/* Colours an opaque mesh by the colours of its vertices, if there are any. The object's spans are those of
 * `mesh`. ISO_ERR_NOMEM. */
iso_status iso_scene_object_use_vertex_colors(iso_scene_object *object, const iso_triangles *mesh,
                                              iso_error *error);

/* The box of what is drawn, in the world, mm; empty if nothing is. */
iso_box iso_scene_object_bounds(const iso_scene_object *object);

/* Draws the object, as if it were opaque, with the cpu engine. `pullpush`: working memory, or NULL.
 * ISO_ERR_NOMEM. */
iso_status iso_scene_object_draw(iso_scene_object *object, const iso_target *target, iso_pullpush *pullpush,
                                 iso_error *error);

/* Adds the samples of a gbuffer that show surface number `surface` to the total of drawn samples. */
void iso_scene_object_count(iso_scene_object *object, const iso_gbuffer *gbuffer, int surface);

/* In `aov`, gives the elements of a surface, whose number counts from 1, the numbers that they have in the
 * file or the arrays. */
void iso_scene_object_number(const iso_scene_object *object, uint32_t surface, iso_aov *aov);

void iso_scene_object_free(iso_scene_object *object);

#endif
