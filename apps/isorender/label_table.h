/* label_table: --table, the measures of all labels as comma-separated values. */
#ifndef ISO_APPS_ISORENDER_LABEL_TABLE_H
#define ISO_APPS_ISORENDER_LABEL_TABLE_H

#include "apps/isorender/isorender.h"

/* Writes the table if it is asked for. ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status isorender_label_table_write(isorender_job *job, iso_error *error);

#endif
