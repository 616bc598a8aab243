/* sets: draws points, ribbons and triangles in one pyramid (Marroquim, Kraus and Cavalcanti 2008, sections
 * 4.1, 5.1 and 5.2): the paper's way, to be compared with drawing each set alone and keeping what is nearer.
 *
 * A set is what has one surface number. Every pixel of every level is marked with the set that it shows.
 * Only pixels of one set are averaged: the frontmost decides which. Triangles are rasterized into the base
 * level, which is the picture's own resolution; their pixels have no ellipse, so that they do not grow, and
 * depth intervals as long as the depth changes in two pixels. A sample that has a fragment of another set
 * than the one that push fills in shows the nearer of both, so that lines just before a wall are not lost in
 * its interval.
 *
 * Because the base level keeps one fragment a pixel, points just behind the outlines of other sets are lost,
 * and surfaces of few points get small gaps there. Drawing each set alone is therefore the default of
 * isorender. Tubes have tangents in place of normals, which do not mix with surfaces (section 5.2): they are
 * drawn in a pyramid of their own. */
#ifndef ISO_RENDER_PULLPUSH_SETS_H
#define ISO_RENDER_PULLPUSH_SETS_H

#include "render/pullpush/lines.h"
#include "render/pullpush/pullpush.h"

/* Points, triangles or ribbons; points and triangles together are a hybrid surface
 * (render/pullpush/hybrid.h). All borrowed. */
typedef struct iso_pyramid_set {
    uint8_t surface;                  /* unique among the sets */
    const iso_point_view *points;     /* or NULL; all sets' points have the same transform */
    const iso_mesh_view *mesh;        /* or NULL */
    const iso_pyramid_lines *ribbons; /* or NULL; made with the style ISO_LINE_RIBBON */
} iso_pyramid_set;

/* Draws all sets into the gbuffer as iso_draw_pullpush does; target->surface does not count. Points are
 * filled in with the weights of opts->reconstruction, CURVED as GAUSSIAN. Writes no elements. `opts` NULL:
 * defaults. ISO_ERR_NOMEM; ISO_ERR_USAGE when the points' transform has no inverse. */
iso_status iso_draw_pyramid_sets(const iso_target *target, const iso_pyramid_set *sets, size_t count,
                                 const iso_pullpush_opts *opts, iso_error *error);

#endif
