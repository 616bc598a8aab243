/* cuts: what --clip cuts away of the things in a picture. */
#ifndef ISO_APPS_ISORENDER_CUTS_H
#define ISO_APPS_ISORENDER_CUTS_H

#include "apps/isorender/settings.h"

struct isorender_job;

/* The options --clip, --cap, --slice and --window. */
iso_status isorender_apply_clip(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_cap(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_slice(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_window(void *settings, const char *value, iso_error *error);
/* ISO_ERR_USAGE: the method, or another option, does not go with --clip. */
iso_status isorender_cuts_check(const isorender_settings *settings, iso_error *error);

/* The same of an input of points, when its renderer is known. */
iso_status isorender_cuts_check_points(const struct isorender_job *job, iso_error *error);

/* Whether caps or slices are drawn. */
bool isorender_has_caps(const isorender_settings *settings);
/* Whether some of them show the volume. */
bool isorender_shows_slices(const isorender_settings *settings);
/* Which colours stand for its values there; false: nothing shows it. */
bool isorender_slice_bar(const struct isorender_job *job, iso_color_bar *bar);
/* What they are. Borrows `solids`, which is filled. */
iso_cut_caps isorender_caps(const struct isorender_job *job, iso_capped solids[ISORENDER_SURFACES]);

/* A cut or slice, with its plane in the middle of the volume, or of everything if there is none, if it is to
 * be there. */
iso_cut isorender_cut_placed(const struct isorender_job *job, const iso_cut *cut);
/* The box of slices that do not depend on the camera, in coordinates along three vectors. */
iso_box isorender_slice_bounds(const struct isorender_job *job, const iso_vec3 vectors[3]);
/* Says in which coordinates cuts are, of a file whose own are others. */
void isorender_cuts_note(const struct isorender_job *job);

/* Sets what is cut away of each surface in a frame, and where slices are. ISO_ERR_USAGE: --clip names a
 * thing that there is not; ISO_ERR_NOMEM. */
iso_status isorender_cuts_make(struct isorender_job *job, int frame, iso_error *error);
/* Says of the cuts and slices of a single picture which ones show nothing, and which values slices show. */
void isorender_cuts_note_seen(const struct isorender_job *job);
/* The failure of a picture that shows nothing because of --clip: ISO_ERR_EMPTY, with how far things reach.
 * ISO_OK: nothing is cut. */
iso_status isorender_cuts_fail_empty(struct isorender_job *job, iso_error *error);

#endif
