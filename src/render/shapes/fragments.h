/* fragments: translucent glyphs, lines and meshes. The places where a ray enters or leaves a solid are
 * layers, as the crossings of an isosurface are: a glyph has two along a ray (an arrow up to four), a disc
 * one. The overlapping segments of one line are a single solid, so that its joints are no darker than the
 * rest of it; a ribbon has a layer for each time that the ray meets it.
 *
 * All pieces of the rays in a set are listed, sorted by depth and merged by line, in double precision; what
 * is found is added to the lists of layers (render/layers), where it meets the layers of isosurfaces and of
 * other sets. Source: Carpenter 1984, "The A-buffer, an antialiased hidden surface method". */
#ifndef ISO_RENDER_SHAPES_FRAGMENTS_H
#define ISO_RENDER_SHAPES_FRAGMENTS_H

#include "render/layers/bands.h"
#include "render/shapes/shapes.h"

/* Bytes that each thread takes for the pieces of a part of a band, at most; a single sample may take more. */
enum { ISO_SHAPES_PIECES_BYTES = 16 << 20 };

/* What pictures have drawn of a translucent set. Zero-initialise. */
typedef struct iso_shapes_layered {
    size_t samples; /* that have a layer of the set in front of what is opaque */
    size_t
        layers; /* of all samples, those behind which less than ISO_LAYER_CUT of the light is left by the set
                       itself not counted */
} iso_shapes_layered;

/* A translucent set. Its surfaces have no absorption length. */
typedef struct iso_translucent_set {
    const iso_shapes *shapes; /* borrowed, like the lines that it was made of; NULL: a mesh */
    iso_mesh_view mesh;       /* without shapes: triangles */
    iso_rgb color;            /* of what has no colour of its own */
    iso_translucency translucency;
    iso_shapes_layered *drawn; /* is added to; NULL is fine */
    const iso_clip *clip;      /* what is cut away; NULL: nothing; borrowed */
} iso_translucent_set;

struct iso_shapes_frame;
/* Draws the blocks of a frame that the target's clip cuts (iso_draw_shapes), of lines all, into its gbuffer:
 * of each sample the first crossing that is left. `drawn` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_shapes_draw_cut(const struct iso_shapes_frame *frame, iso_shapes_drawn *drawn,
                               iso_error *error);

typedef struct iso_shapes_lister iso_shapes_lister;

/* Prepares to list the fragments of sets in a strip. first: the number of the first set as a surface of the
 * lists; the others follow. `sets`, strip and pool are borrowed until iso_shapes_lister_destroy.
 * ISO_ERR_NOMEM. */
iso_status iso_shapes_lister_create(const iso_translucent_set *sets, int count, int first,
                                    const iso_strip *strip, iso_pool *pool, iso_shapes_lister **lister,
                                    iso_error *error);
/* Adds what was listed to the counts of the sets. NULL is fine. */
void iso_shapes_lister_destroy(iso_shapes_lister *lister);
/* Borrowed until the lister is destroyed. */
iso_layer_source iso_shapes_lister_source(iso_shapes_lister *lister);

/* A depth in the middle of the sets, that depths of fragments can be counted from. */
double iso_translucent_middle(const iso_translucent_set *sets, int count, const iso_view *view);

#endif
