/* looks: --look (apps/common/looks.h), applied to the settings. */
#ifndef ISO_APPS_ISORENDER_LOOKS_H
#define ISO_APPS_ISORENDER_LOOKS_H

#include "apps/isorender/settings.h"

/* Sets the options that the look has and that were not given. They are noted as if they had been, so that
 * scenes and the picture's command hold them. ISO_ERR_USAGE. */
iso_status isorender_look_apply(isorender_settings *settings, iso_error *error);

#endif
