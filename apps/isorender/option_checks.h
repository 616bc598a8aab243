/* option_checks: takes the operands of the command line, and checks that the options agree with each other.
 */
#ifndef ISO_APPS_ISORENDER_OPTION_CHECKS_H
#define ISO_APPS_ISORENDER_OPTION_CHECKS_H

#include "apps/isorender/settings.h"

/* Adds a file of lines, glyphs or triangles to the options. ISO_ERR_USAGE: there are too many, or the path is
 * empty. */
iso_status isorender_settings_add_object(isorender_settings *settings, iso_object_kind kind, const char *path,
                                         iso_error *error);

/* Completes settings that have the options with what the operands are. Errors as isorender_settings_parse. */
iso_status isorender_settings_check(isorender_settings *settings, const iso_operands *operands,
                                    iso_error *error);

#endif
