/* lod_cut: chooses from levels of detail (render/selection/lod.h) the spans that one picture needs: of every
 * part of the surface the coarsest level whose error there is at most a given number of pixels.
 *
 * Colours, and the sizes of coloured discs, are interpolated between the chosen level and the next coarser
 * one (Guennebaud et al. 2004, section 4.4), so that little changes suddenly when the camera moves: a span
 * that has just become fine enough has those of its own level, one whose place is about to be taken by a
 * coarser one has those of that level. In between, the coarser level's share grows with the square of the way
 * (in the paper: linearly), because the discs of the finer one are filtered and so hardly alias where they
 * are still a good deal smaller than pixels. */
#ifndef ISO_RENDER_SELECTION_LOD_CUT_H
#define ISO_RENDER_SELECTION_LOD_CUT_H

#include "base/memory.h"
#include "image/camera.h"
#include "render/selection/lod.h"

/* The chosen spans, by level. Zero-initialise; free with iso_lod_cut_free. Memory is reused from one cut to
 * the next. */
typedef struct iso_lod_cut {
    /* Views of the chosen spans of each level; those of levels without any have none. They borrow from the
     * levels of detail, and from this cut until the next one. To be drawn in this order: finer levels are
     * nearer to the eye and hide more. */
    iso_point_view view[ISO_LOD_LEVELS];
    size_t points[ISO_LOD_LEVELS]; /* number of points in each view */
    int levels;                    /* number of views */
    iso_buffer spans[ISO_LOD_LEVELS], bounds[ISO_LOD_LEVELS];
    iso_buffer blends[ISO_LOD_LEVELS], colors[ISO_LOD_LEVELS], scales[ISO_LOD_LEVELS];
} iso_lod_cut;

/* Makes the cut for a view: the errors of the chosen spans are at most `pixels` at the span's nearest
 * depth, or the span is of level 0. It is the same for all strips of a picture and every number of threads.
 * `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_lod_cut_make(iso_lod_cut *cut, const iso_lod *lod, const iso_view *view, double pixels,
                            iso_pool *pool, iso_error *error);
void iso_lod_cut_free(iso_lod_cut *cut);

#endif
