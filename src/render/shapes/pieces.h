/* pieces: which pieces of the rays of a rectangle of samples lie in the shapes of a set, in double precision.
 * Internal to shapes. */
#ifndef ISO_RENDER_SHAPES_PIECES_H
#define ISO_RENDER_SHAPES_PIECES_H

#include "base/memory.h"
#include "render/raster/mesh_samples.h"
#include "render/shapes/near.h"

/* A piece of a sample's ray. Both ends are equal where a ray crosses a ribbon, a disc or a triangle. */
typedef struct iso_shapes_piece {
    double t[2];        /* depths */
    float normal[2][3]; /* unit, view space, out of the solid; of ribbons and discs on the ray's side */
    float along[2];     /* of segments, 0 to 1 */
    uint32_t whole;     /* number of the glyph, line or triangle: pieces of one line overlap */
    uint32_t element;   /* number of the glyph or triangle, or of the segment's first vertex */
    uint32_t next;      /* number of another piece of the same sample; ISO_SHAPES_NO_PIECE */
} iso_shapes_piece;

#define ISO_SHAPES_NO_PIECE UINT32_MAX

/* The pieces of the samples of a rectangle. Zero-initialise, iso_shapes_pieces_free when done. */
typedef struct iso_shapes_pieces {
    iso_shapes_rect rect; /* rows are counted from the top of the picture */
    iso_buffer pieces;    /* iso_shapes_piece */
    iso_buffer first;     /* uint32_t, by sample of the rectangle, row by row: the number of its last piece */
    size_t count;
    size_t most; /* the most pieces that are listed; 0: as many as memory has room for */
    bool full;   /* pieces were left out */
} iso_shapes_pieces;

/* Lists the pieces of a rectangle. limit: NULL, or the depth of what is opaque behind each sample, `pitch`
 * items from row to row, at the rectangle's first sample: pieces that begin there or behind are left out,
 * as are those that end before the near plane. ISO_ERR_NOMEM. */
iso_status iso_shapes_pieces_list(iso_shapes_pieces *pieces, const iso_shapes_frame *frame,
                                  const iso_shapes_rect *rect, const float *limit, size_t pitch);
/* The same of the triangles of a mesh, each of which has pieces of its own. worker: as in
 * iso_mesh_samples_visit. */
iso_status iso_shapes_pieces_list_mesh(iso_shapes_pieces *pieces, const iso_mesh_samples *mesh, int worker,
                                       int top, const iso_shapes_rect *rect, const float *limit,
                                       size_t pitch);
void iso_shapes_pieces_free(iso_shapes_pieces *pieces);

#endif
