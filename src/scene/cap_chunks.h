/* cap_chunks: the caps and slices of a volume that is visited chunk by chunk (grids/chunk_walk.h). The
 * picture does not depend on the size of the chunks. */
#ifndef ISO_SCENE_CAP_CHUNKS_H
#define ISO_SCENE_CAP_CHUNKS_H

#include "grids/chunk_walk.h"
#include "scene/caps.h"

/* Draws the caps and slices of a share of the chunks into the caps' plane of a key image
 * (render/view/key_image.h). The picture has one solid, that of the walk's volume. Errors as
 * iso_chunk_walk_visit. */
iso_status iso_cap_chunks_draw(iso_chunk_walk *walk, iso_chunk_share share, const iso_cut_caps *caps,
                               const iso_view *view, iso_key_image *keys, iso_error *error);

#endif
