/* merge: the command `isorender merge`. */
#ifndef ISO_APPS_ISORENDER_MERGE_H
#define ISO_APPS_ISORENDER_MERGE_H

#include "apps/isorender/settings.h"

/* Merges settings->inputs, files of keys, and writes the picture settings->output. ISO_ERR_USAGE: the output
 * is one of the inputs; ISO_ERR_EMPTY: nothing of the surface is in view; errors of reading and writing. */
iso_status isorender_merge(const isorender_settings *settings, iso_error *error);

#endif
