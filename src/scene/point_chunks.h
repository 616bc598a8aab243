/* point_chunks: pull-push of the points of a volume that is visited chunk by chunk (grids/chunk_walk.h), by
 * the box and Gaussian reconstructions of Marroquim et al. 2008. The results do not depend on the size of
 * the chunks, and are those of the whole volume. All its voxels must be finite. */
#ifndef ISO_SCENE_POINT_CHUNKS_H
#define ISO_SCENE_POINT_CHUNKS_H

#include "exact/chunks.h"
#include "extract/points/points.h"
#include "render/pullpush/keys.h"

/* Extracts the edge points of a chunk with their bounds; destroy them before `voxels`, the chunk's grid.
 * Errors as iso_point_set_create. */
iso_status iso_point_chunk_extract(iso_rgrid *voxels, const iso_grid_chunk *chunk, double isovalue,
                                   iso_pool *pool, iso_point_set **points, iso_error *error);

/* Like iso_exact_chunks_bounds, of the edge points; bounds->primitives is their number. */
iso_status iso_point_chunks_bounds(iso_chunk_walk *walk, iso_chunk_bounds *bounds, iso_error *error);

/* Surveys the points of a share of the chunks for a view of the whole picture. */
iso_status iso_point_chunks_survey(iso_chunk_walk *walk, iso_chunk_share share, const iso_view *view,
                                   iso_pullpush_survey *survey, iso_error *error);

/* Draws a share of the points into the empty key image of `picture`. */
iso_status iso_point_chunks_draw(iso_chunk_walk *walk, iso_chunk_share share,
                                 const iso_pullpush_keys *picture, const iso_pullpush_survey *survey,
                                 iso_error *error);

#endif
