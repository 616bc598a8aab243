/* disc_layers: translucent surfaces of points, drawn as splats in one of three modes (iso_transparency in
 * isopoint.h).
 *
 * sorted: all discs that a pixel's ray hits are sorted by depth. Discs of one side (front- or back-facing)
 * that lie at most 1.5 radii of their points behind the first disc of a layer are averaged, shaded and
 * composited as one layer. This mode is the definition that the other two approximate.
 *
 * groups: Zhang and Pajarola 2006, algorithm 2. The discs of each group are composited back to front into a
 * picture of their own, and the pictures are averaged, except those that lack the front layer where most have
 * it. So that each group covers the surface by itself (section 4.2.2), it gets copies of discs of other
 * groups (render/groups/copies.h), or its discs are enlarged: by the factors of iso_groups_cover
 * (render/groups/coverage.h), or by the square root of half the number of groups. With copies pictures are 1
 * to 6 dB nearer to sorted layers, but the groups take several times as long to make, and the gl engine does
 * not draw them. Discs of a group then overlap; therefore depths are compared in bins as wide as a layer (eq.
 * 6), and only one disc of a layer is composited.
 *
 * nearest: algorithm 3. The nearest layer is drawn smoothly by slots (render/groups/groups.h), and what is
 * behind it by algorithm 2 without the discs of the nearest layer.
 *
 * The paper orders discs by a tree of planes, this code by the depths of their centres. Both shade each pixel
 * of the nearest layer by its mean normal (section 5.2.4). The paper's algorithm 2 has the colours of points,
 * this code's shades each disc by its normal; shading the mean normal of the groups' front discs instead
 * brings pictures .05 dB nearer to sorted layers at most (a bear and a scan, 4 and 8 groups). */
#ifndef ISO_RENDER_GROUPS_DISC_LAYERS_H
#define ISO_RENDER_GROUPS_DISC_LAYERS_H

#include "render/glass/glass.h"
#include "render/groups/groups.h"
#include "render/layers/compose.h"

/* The default number of groups for transparency (section 6.2). */
enum { ISO_SPLAT_LAYERS_GROUPS = 4 };

/* Returns the default options of iso_groups_make for algorithms 2 and 3. */
iso_groups_opts iso_splat_layers_grouping(iso_pool *pool);

/* Layers that another engine has found, for the samples of the strip row by row: those of sample i are
 * layers[start[i]] .. layers[start[i + 1] - 1], front to back. An opacity of 0: none. */
typedef struct iso_splat_lists {
    const iso_packed_fragment *layers;
    const size_t *start;
} iso_splat_lists;

/* A translucent surface: its opacity is below 1, or its points have opacities of their own, which it
 * multiplies. A layer's opacity and colour are then means over its discs. absorption_length is ignored;
 * most_layers is used by the mode sorted only. */
typedef struct iso_splat_layer {
    iso_point_view points;    /* borrowed for the call */
    const iso_groups *groups; /* groups of the points, with discs of ISO_GROUPS_DISC; ignored by the mode
                                 sorted */
    iso_rgb color;            /* of points without colours */
    iso_translucency translucency;
    const iso_splat_lists *lists; /* NULL: the layers are found here */
} iso_splat_layer;

/* The surfaces to draw and the picture to draw them into; all pointers are borrowed for the call. */
typedef struct iso_splat_layers {
    iso_transparency transparency;
    const iso_splat_layer *layers; /* the picture's translucent surfaces */
    int count;                     /* 1 or more */
    iso_layer_picture picture;
    const iso_glass_map *crossings; /* NULL; else crossings are stored here, for iso_groups_map_glass, and no
                                       picture is composited */
} iso_splat_layers;

/* Draws and composites a strip. Adds to *totals. The picture gets the same bytes with every number of
 * threads and when drawn in strips of any height. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_shade_splat_layers(const iso_splat_layers *input, iso_layer_totals *totals, iso_error *error);

/* Fills a map with the crossings of a solid whose surface is given by points (section 5.2.3). `groups` as in
 * iso_splat_layer.
 *
 * sorted: a crossing for every layer. Consecutive layers of one side are one crossing of the solid, which may
 * have other surfaces within it; all are counted. The eye, and the border of a volume, count as outside the
 * solid.
 *
 * nearest: algorithm 3. The first crossing is that of the smooth nearest layer. How many layers follow is the
 * opacity that each group's picture accumulates behind it, divided by the opacity of one layer: the mean of
 * the groups, rounded. Where the solid ends is not known: the map has no thicknesses and no normals of the
 * far side.
 *
 * The bytes are the same for every number of threads. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or
 * more. */
iso_status iso_groups_map_glass(const iso_point_view *points, const iso_groups *groups,
                                iso_transparency transparency, const iso_glass_map *map, iso_pool *pool,
                                iso_error *error);

#endif
