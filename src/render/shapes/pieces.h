/* pieces: which pieces of the rays of a rectangle of samples lie in the shapes of a set, in double precision.
 * Internal to shapes. */
#ifndef ISO_RENDER_SHAPES_PIECES_H
#define ISO_RENDER_SHAPES_PIECES_H

#include "base/memory.h"
#include "render/raster/mesh_samples.h"
#include "render/shapes/candidates.h"

/* A piece of a sample's ray. Both ends are equal where a ray crosses a ribbon, a disc or a triangle. A piece
 * in a tube may be the union of overlapping pieces of the same line. */
typedef struct iso_shapes_piece {
    double t[2];          /* depths */
    float normal[2][3];   /* unit, view space, out of the solid; of ribbons and discs on the ray's side */
    float along[2];       /* of segments, 0 to 1 */
    uint32_t element[2];  /* of each end: number of the glyph or triangle, or of the segment's first vertex */
    uint32_t whole;       /* number of the glyph, line or triangle: pieces of one line overlap */
    uint32_t sample : 31; /* of the rectangle, row by row; ISO_SHAPES_NO_SAMPLE: not needed any more */
    uint32_t is_entered : 1; /* the crossing at the first end has been used */
} iso_shapes_piece;

#define ISO_SHAPES_NO_SAMPLE ((uint32_t)INT32_MAX)
#define ISO_SHAPES_NO_PIECE UINT32_MAX

/* The pieces of the samples of a rectangle. Zero-initialise, iso_shapes_pieces_free when done. */
typedef struct iso_shapes_pieces {
    iso_shapes_rect rect; /* rows are counted from the top of the picture */
    iso_buffer pieces;    /* iso_shapes_piece */
    iso_buffer last;      /* uint32_t, by sample: the number of its last piece, or ISO_SHAPES_NO_PIECE */
    /* By sample: the depth behind which nothing can be seen: of what is opaque there, or of a piece that is
     * listed; -INFINITY when nothing at all can. */
    iso_buffer limit;
    iso_buffer farthest; /* float: the farthest limit of each tile of samples, row by row */
    iso_buffer found;    /* int32_t: candidates */
    iso_buffer slopes;   /* double: of the rays, by column, then by row */
    size_t count;
    size_t most; /* the most pieces that are listed; 0: as many as memory has room for */
    bool full;   /* pieces were left out */
} iso_shapes_pieces;

/* Prepares to list a rectangle. frame: NULL for meshes. limit: NULL, or the depth of what is opaque behind
 * each sample, `pitch` items from row to row, at the rectangle's first sample: pieces that begin there or
 * behind are left out, as are those that end before the near plane. ISO_ERR_NOMEM. */
iso_status iso_shapes_pieces_begin(iso_shapes_pieces *pieces, const iso_shapes_frame *frame,
                                   const iso_shapes_rect *rect, const float *limit, size_t pitch);
/* Removes the pieces that are not needed any more, and those that begin at the limits of their samples or
 * behind, which may have been changed. The others are numbered again in their order. */
void iso_shapes_pieces_tidy(iso_shapes_pieces *pieces);
/* Lists the pieces of a block in sight. ISO_ERR_NOMEM. */
iso_status iso_shapes_pieces_list(iso_shapes_pieces *pieces, const iso_shapes_frame *frame,
                                  const iso_shapes_seen *seen);
/* Lists the triangles of a mesh, each of which has pieces of its own. worker: as in iso_mesh_samples_visit.
 * ISO_ERR_NOMEM. */
iso_status iso_shapes_pieces_list_mesh(iso_shapes_pieces *pieces, const iso_mesh_samples *mesh, int worker,
                                       int top);
void iso_shapes_pieces_free(iso_shapes_pieces *pieces);

#endif
