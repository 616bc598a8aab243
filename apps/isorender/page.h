/* page: the picture as a page (apps/common/page.h): which options it can have, and what is written. */
#ifndef ISO_APPS_ISORENDER_PAGE_H
#define ISO_APPS_ISORENDER_PAGE_H

#include "apps/isorender/isorender.h"

/* Checks that the options are those of a page if the output is one, and that options of pages are for one.
 * ISO_ERR_USAGE; ISO_ERR_BACKEND: this build writes none. */
iso_status isorender_page_check(const isorender_settings *settings, iso_error *error);
/* Writes the page of a drawn picture. ISO_ERR_UNSUPPORTED: the volume is not in memory as a dense grid;
 * errors as iso_page_write. */
iso_status isorender_page_write(isorender_job *job, const iso_image *image, const char *path,
                                iso_error *error);

#endif
