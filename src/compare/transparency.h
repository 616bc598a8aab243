/* transparency: measures how much pictures of a translucent surface differ from the truth, in which all
 * crossings of the rays are composited front to back in double precision (truth/raycast_layers.h).
 *
 * Average colour and weighted blending are common ways to composite without sorting. Here they use the same
 * crossings as the truth, so that only the compositing differs. The opacity is constant, that is the same at
 * every angle. */
#ifndef ISO_COMPARE_TRANSPARENCY_H
#define ISO_COMPARE_TRANSPARENCY_H

#include "compare/study.h"

typedef enum iso_compositing {
    ISO_COMPOSITING_EXACT, /* the layers that exact finds, in order (exact/layers.h) */
    /* The mean of the crossings' colours weighted by opacity, which covers 1 - prod(1 - opacity) of the
     * background (Bavoil and Myers 2008, "Order independent transparency with dual depth peeling": weighted
     * average; also what VTK draws without depth peeling). */
    ISO_COMPOSITING_AVERAGE,
    /* The same with weights that fall with depth: opacity * max(1e-2, 3e3 (1 - d)^3), where d is the depth in
     * the depth buffer, 0 at the front of the ball around the surface and 1 at its back (McGuire and Bavoil
     * 2013, "Weighted blended order-independent transparency", eq. 10). */
    ISO_COMPOSITING_WEIGHTED,
    /* The volume's points as splats (render/groups/disc_layers.h): sorted; by algorithms 2 and 3 of Zhang and
     * Pajarola 2006. These differ from the truth by being points, too. */
    ISO_COMPOSITING_SPLATS,
    ISO_COMPOSITING_SPLATS_GROUPS,
    ISO_COMPOSITING_SPLATS_NEAREST,
    ISO_COMPOSITINGS
} iso_compositing;

const char *iso_compositing_name(iso_compositing compositing);  /* "exact", "average", .. */
const char *iso_compositing_title(iso_compositing compositing); /* a few words, for reports */

enum { ISO_TRANSPARENCY_OPACITIES = 3 };
extern const double ISO_TRANSPARENCY_OPACITY[ISO_TRANSPARENCY_OPACITIES]; /* .3, .5, .7 */

typedef struct iso_transparency_study {
    double psnr[ISO_COMPOSITINGS][ISO_TRANSPARENCY_OPACITIES]; /* dB, whole picture: iso_psnr */
    /* How long a picture takes, the median of those of all opacities; NaN for average and weighted, whose
     * crossings are the truth's */
    double seconds[ISO_COMPOSITINGS];
    /* pixels in which exact composites another number of layers than the truth */
    size_t wrong_layers[ISO_TRANSPARENCY_OPACITIES];
    size_t covered;     /* pixels that show the surface */
    double mean_layers; /* crossings of a covered pixel's ray; NaN: nothing is covered */
    int most_layers;
} iso_transparency_study;

/* Draws the surface in all these ways with one sample for each pixel, and compares the pictures with the
 * truth. The surface needs its parts points, cells and ray caster. The ball must lie in front of the view's
 * eye, as in iso_study_fit. Only the colours of the look are used. Allocates 80 bytes for each pixel.
 * ISO_ERR_NOMEM, and the errors of drawing. */
iso_status iso_study_transparency(const iso_scene_surface *surface, const iso_study_ball *ball,
                                  const iso_view *view, const iso_study_look *look,
                                  iso_transparency_study *study, iso_error *error);

#endif
