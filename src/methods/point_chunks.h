/* point_chunks: pull-push of the points of a volume that is visited chunk by chunk (grids/chunk_walk.h), by
 * the box and Gaussian reconstructions of Marroquim et al. 2008. The results do not depend on the size of
 * the chunks, and are those of the whole volume. All its voxels must be finite. */
#ifndef ISO_METHODS_POINT_CHUNKS_H
#define ISO_METHODS_POINT_CHUNKS_H

#include "exact/chunks.h"
#include "render/picture.h"
#include "render/pullpush/keys.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Like iso_exact_chunks_bounds, of the edge points; bounds->primitives is their number. */
iso_status iso_point_chunks_bounds(iso_chunk_walk *walk, iso_chunk_bounds *bounds, iso_error *error);

/* Surveys the points of a share of the chunks for a view of the whole picture. */
iso_status iso_point_chunks_survey(iso_chunk_walk *walk, iso_chunk_share share, const iso_view *view,
                                   iso_pullpush_survey *survey, iso_error *error);

/* Draws a share of the points into the empty key image of `picture`. */
iso_status iso_point_chunks_draw(iso_chunk_walk *walk, iso_chunk_share share,
                                 const iso_pullpush_keys *picture, const iso_pullpush_survey *survey,
                                 iso_error *error);

/* The keys of all points. */
typedef struct iso_merged_points {
    iso_pullpush_base base;
    iso_key_image *keys;     /* borrowed */
    iso_transform transform; /* of the volume */
    iso_reconstruction reconstruction;
} iso_merged_points;

/* Renders the picture: opts->draw is not used. Errors as iso_picture_render. */
iso_status iso_render_merged_points(const iso_merged_points *points, const iso_picture_opts *opts,
                                    iso_image *image, size_t *covered, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
