/* caps: closes surfaces where a clip cuts their solids, with a colour or with the volume itself, and draws
 * slices of a volume. Drawn into the gbuffer when the surfaces are in it: any method can be capped. */
#ifndef ISO_SCENE_CAPS_H
#define ISO_SCENE_CAPS_H

#include "base/parallel.h"
#include "grids/grid.h"
#include "image/camera.h"
#include "image/colormap.h"
#include "render/view/clip.h"
#include "render/view/gbuffer.h"
#include "render/view/key_image.h"

/* The colours of a volume's values in caps and slices, which are not lit. */
typedef struct iso_slice_look {
    double low, high; /* physical values at the two ends of the colormap */
    iso_colormap map;
} iso_slice_look;

/* The solid of a surface. All pointers are borrowed. */
typedef struct iso_capped {
    const iso_grid *grid;
    double isovalue;      /* physical */
    uint8_t surface;      /* its number in the gbuffer */
    iso_rgb color;        /* of its caps, if they do not show the volume */
    const iso_clip *clip; /* NULL: it is not cut */
    bool plain;           /* its caps do not show the volume, which its grid is not, as of labels */
} iso_capped;

/* A slice of the volume of the first solid: where a plane passes it. Its outlines are where the plane meets
 * the surfaces of that volume. */
typedef struct iso_slice {
    double plane[4]; /* x * p.x + y * p.y + z * p.z = offset; x y z is a unit vector; mm */
} iso_slice;

enum { ISO_SLICES = 16 };

typedef struct iso_cut_caps {
    const iso_capped *solids;
    int count;
    bool caps;  /* the solids get caps */
    bool shows; /* caps show the volume; if not, they have the colours of the solids */
    const iso_slice *slices;
    int slice_count;
    iso_slice_look look;
    int factor; /* samples along a pixel's side: outlines are 1.5 pixels wide */
} iso_cut_caps;

/* Whether no cap can hide behind what is left of its own solid: a single plane cuts each solid that is cut.
 * Such caps may also be drawn before the surfaces, of which the method exact then draws only what is seen. */
bool iso_caps_are_in_front(const iso_cut_caps *caps);

/* Replaces the samples that are farther than a cap or a slice. Where several solids are cut in one place the
 * cap is that of the innermost: of solids of one volume that of the innermost surface, of others that of the
 * last. The same bytes with every number of threads. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_caps_draw(const iso_cut_caps *caps, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool,
                         iso_error *error);

/* Voxels of a part of a volume, and the cells that it consists of. */
typedef struct iso_cap_part {
    iso_grid grid;          /* borrowed */
    int origin[3];          /* the volume's index of its first voxel */
    double low[3], high[3]; /* index coordinates of the volume; the grid has all cells between them */
} iso_cap_part;

/* Draws the caps of one solid, and the slices, that are in a part of its volume, of whose grid no voxels are
 * read, into the caps' plane of a key image. When this was done for parts that cover the volume, in any order
 * and into any number of key images, the picture is that of iso_caps_draw, byte for byte. ISO_ERR_NOMEM. */
iso_status iso_caps_draw_keys(const iso_cut_caps *caps, const iso_cap_part *part, const iso_view *view,
                              iso_key_image *keys, iso_pool *pool, iso_error *error);

#endif
