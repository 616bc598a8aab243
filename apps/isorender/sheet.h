/* sheet: the command sheet, a contact sheet of many inputs (apps/common/contact_sheet.h). Each panel is the
 * picture that the command makes of this input alone. */
#ifndef ISO_APPS_ISORENDER_SHEET_H
#define ISO_APPS_ISORENDER_SHEET_H

#include "apps/isorender/isorender.h"

/* Takes the operands, of which the only one may be a folder of BIDS, and checks the options of the command.
 * ISO_ERR_USAGE, ISO_ERR_EMPTY, ISO_ERR_NOMEM. */
iso_status isorender_sheet_check(isorender_settings *settings, const iso_operands *operands,
                                 iso_error *error);

/* Makes the sheet. Errors, and *code: iso_sheet_make. */
iso_status isorender_sheet(const isorender_settings *settings, int *code, iso_error *error);

/* Sets the numbers of the job's tile when it has been drawn. ISO_ERR_NOMEM, ISO_ERR_LIMIT. */
iso_status isorender_tile_measure(isorender_job *job, iso_error *error);

#endif
