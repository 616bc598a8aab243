/* watch: draws again whenever a file that is read changes. */
#ifndef ISO_APPS_ISORENDER_WATCH_H
#define ISO_APPS_ISORENDER_WATCH_H

#include "apps/isorender/settings.h"

/* Returns ISO_OK in a child process, once for every picture that is to be made: at first, and whenever a file
 * that the command reads has changed and has then stayed the same for a quarter of a second. The process that
 * calls it goes on until a signal ends it, such as an interrupt, or fails: ISO_ERR_NOMEM; ISO_ERR_USAGE by
 * mpirun. */
iso_status isorender_watch(isorender_settings *settings, iso_error *error);

#endif
