/* pullpush: points projected to single pixels, and a surface reconstructed between them in image space
 * (Marroquim, Kraus and Cavalcanti 2008, section 3): on the cpu, fast enough for interaction.
 *
 * Each point goes into the one pixel that its centre lies in, with its normal, its radius and the depth
 * interval [z, z + radius]. Pull averages pixels whose intervals meet the frontmost one's into coarser
 * levels; push fills, from coarse to fine, pixels that hold no point or one behind the surface, from the up
 * to four coarser pixels whose ellipses they are in. An ellipse is a disc of the radius, seen along the
 * optical axis, low-pass filtered (Zwicker et al. 2001). Points up to a projected radius outside the picture
 * take part.
 *
 * Points that face away are left out when the set is closed and the eye is outside the box around it; else
 * they are drawn too, and normals stay as they are (out of the solid). */
#ifndef ISO_RENDER_PULLPUSH_PULLPUSH_H
#define ISO_RENDER_PULLPUSH_PULLPUSH_H

#include "render/raster/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iso_reconstruction {
    ISO_RECONSTRUCTION_REFINED, /* second-order discs instead of averages; it knows no
                                   colours: points that have them are drawn as by gaussian */
    ISO_RECONSTRUCTION_BOX,     /* ellipses with equal weights (figure 4a) */
    ISO_RECONSTRUCTION_GAUSSIAN /* with Gaussian ones (figure 4b) */
} iso_reconstruction;

/* Memory that frames can share. One call uses it at a time. */
typedef struct iso_pullpush iso_pullpush;

/* ISO_ERR_NOMEM. Destroy with iso_pullpush_destroy, which takes NULL too. */
iso_status iso_pullpush_create(iso_pullpush **pullpush, iso_error *error);
void iso_pullpush_destroy(iso_pullpush *pullpush);

typedef struct iso_pullpush_opts {
    iso_reconstruction reconstruction;
    iso_pullpush *workspace; /* borrowed; NULL: made for the call */
} iso_pullpush_opts;

/* Draws one surface over what is there, as iso_draw_points does: a sample is replaced when the new depth is
 * smaller. The same bytes for every instruction set and thread count, and for strips of a picture made by
 * iso_view_rows. Points whose position is not finite, or whose normal has no direction, are left out. `opts`
 * NULL: defaults. ISO_ERR_NOMEM. */
iso_status iso_draw_pullpush(const iso_target *target, const iso_point_view *points,
                             const iso_pullpush_opts *opts, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
