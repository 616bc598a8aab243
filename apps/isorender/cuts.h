/* cuts: what --clip cuts away of the things in a picture. */
#ifndef ISO_APPS_ISORENDER_CUTS_H
#define ISO_APPS_ISORENDER_CUTS_H

#include "apps/isorender/settings.h"

struct isorender_job;

/* The options --clip, --cap and --slice. */
iso_status isorender_apply_clip(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_cap(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_slice(void *settings, const char *value, iso_error *error);
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

/* Sets what is cut away of each surface in a frame, and where slices are. ISO_ERR_USAGE: --clip names a
 * thing that there is not; ISO_ERR_NOMEM. */
iso_status isorender_cuts_make(struct isorender_job *job, int frame, iso_error *error);
/* The failure of a picture that shows nothing because of --clip: ISO_ERR_EMPTY, with how far things reach.
 * ISO_OK: nothing is cut. */
iso_status isorender_cuts_fail_empty(struct isorender_job *job, iso_error *error);

#endif
