/* layers: translucent surfaces of points, drawn as splats in one of three ways.
 *
 * sorted: all discs of a pixel are sorted by depth; those of one side (front- or back-facing) that lie no
 * farther than 1.5 radii of their points behind the first one of their layer are averaged, shaded and
 * composited. This is the definition that the other two approximate; no surface of discs has more to show.
 *
 * groups: Zhang and Pajarola 2006, algorithm 2. The discs of each group are composited back to front into
 * a picture of their own, and the pictures are averaged (those that lack the front layer, where most have
 * it, are left out). So that a group covers the surface by itself its discs are larger (section 4.2.2): by
 * the square root of half the number of groups. That a group's discs overlap then, its pictures' depths
 * are compared in bins as wide as a layer (eq. 6): only one disc of a layer is composited.
 *
 * nearest: algorithm 3. The nearest layer is drawn by slots (render/splats/splats.h), smoothly; what is
 * behind it, by algorithm 2 without the discs of the nearest layer.
 *
 * The paper orders the discs with a tree of planes; here they are ordered by the depths of their centres.
 * It shades with the colours of points; here with their normals, each disc in algorithm 2 and each pixel
 * elsewhere. */
#ifndef ISO_RENDER_SPLATS_LAYERS_H
#define ISO_RENDER_SPLATS_LAYERS_H

#include "render/layers/compose.h"
#include "render/splats/splats.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iso_transparency {
    ISO_TRANSPARENCY_SORTED,
    ISO_TRANSPARENCY_GROUPS,
    ISO_TRANSPARENCY_NEAREST
} iso_transparency;

/* The number of groups for transparency when none is asked for (section 6.2). */
enum { ISO_SPLAT_LAYERS_GROUPS = 4 };

/* The options for iso_groups_make with which algorithms 2 and 3 are drawn when none are given. */
iso_groups_opts iso_splat_layers_grouping(iso_pool *pool);

/* A translucent surface. Its opacity is below 1. absorption_length is not used, and most_layers by sorted
 * only. */
typedef struct iso_splat_layer {
    iso_point_view points;    /* borrowed for the call */
    const iso_groups *groups; /* of the points, with discs of ISO_SPLATS_DISC; not used by sorted */
    iso_rgb color;            /* of points without colours */
    iso_translucency translucency;
} iso_splat_layer;

/* What is drawn, and into what; all pointers are borrowed for the call. */
typedef struct iso_splat_layers {
    iso_transparency transparency;
    const iso_splat_layer *layers; /* the picture's translucent surfaces */
    int count;                     /* 1 or more */
    iso_layer_picture picture;
} iso_splat_layers;

/* Draws and composites a strip. Adds to *totals. The picture gets the same bytes with every number of
 * threads and when drawn in strips of any height. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_shade_splat_layers(const iso_splat_layers *input, iso_layer_totals *totals, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
