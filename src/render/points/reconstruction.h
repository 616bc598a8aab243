/* reconstruction: the ways in which the surface between points is drawn (render/point_surface.h). */
#ifndef ISO_RENDER_POINTS_RECONSTRUCTION_H
#define ISO_RENDER_POINTS_RECONSTRUCTION_H

#include <stdint.h>

typedef enum iso_reconstruction {
    ISO_RECONSTRUCTION_CURVED,   /* second-order discs (render/discs/discs.h); flat ones, without a
                                    filter, for points with colours or without curvatures */
    ISO_RECONSTRUCTION_BOX,      /* ellipses with equal weights (figure 4a) */
    ISO_RECONSTRUCTION_GAUSSIAN, /* with Gaussian ones (figure 4b) */
    /* Splats, without a pyramid: flat discs with Gaussian weights, or single pixels (iso_flat_disc_style in
     * render/discs/discs.h). Curvatures are not used. */
    ISO_RECONSTRUCTION_FLAT,
    ISO_RECONSTRUCTION_ONEPASS,
    ISO_RECONSTRUCTION_EWA,
    ISO_RECONSTRUCTION_MEAN
} iso_reconstruction;

/* Which points the reconstructions that draw discs (all but BOX and GAUSSIAN) draw. */
typedef enum iso_point_selection {
    ISO_SELECTION_AUTO, /* the engine's choice: VISIBLE of the cpu engine; see render/gl/pullpush.h */
    /* Only points that the picture may show (Guennebaud, Barthe and Paulin 2004). The cpu engine draws the
     * same picture as from all points; of the gl engine see render/gl/pullpush.h. */
    ISO_SELECTION_VISIBLE,
    ISO_SELECTION_ALL /* also points that nearer ones hide */
} iso_point_selection;

/* How many points were looked at and how many of them were drawn as discs; the others of `points` were
 * hidden, outside the picture, faced away, or were so small that they contain no sample. Points beside the
 * border of two patches of the picture are tested and drawn once in each. */
typedef struct iso_selection_counts {
    uint64_t points, tested, drawn;
} iso_selection_counts;

#endif
