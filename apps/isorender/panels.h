/* panels: a sheet of pictures that differ in one option. Each is the whole command with that option's value
 * in its place, drawn as a picture of its own, so that whatever a picture can show a panel can show.
 * Before that a survey of all of them finds what they share: what the camera frames, the isovalue, the
 * ranges of colours. */
#ifndef ISO_APPS_ISORENDER_PANELS_H
#define ISO_APPS_ISORENDER_PANELS_H

#include "apps/isorender/isorender.h"

/* Whether --panels or --panel-file is given. */
bool isorender_has_panels(const isorender_settings *settings);
/* The first option given that a sheet of several pictures cannot have; NULL: none is. */
const char *isorender_panels_unfit(const isorender_settings *settings);
/* Checks their options. ISO_ERR_USAGE. */
iso_status isorender_panels_check(isorender_settings *settings, iso_error *error);

/* Draws the sheet and writes it as the plan's picture. Errors name the panel; no output is left after one.
 * ISO_ERR_USAGE: a value is none of the option; ISO_ERR_LIMIT: the sheet is too large; errors of
 * isorender_run for each panel. */
iso_status isorender_panels_run(const isorender_settings *settings, const isorender_plan *plan,
                                iso_pool *pool, const isorender_backend *backend,
                                const iso_environment *environment, iso_error *error);

#endif
