/* event_limits: every number of a stroke file is checked against its bounds (sculpt/limits.h). Internal to
 * sculpt. */
#ifndef ISO_SCULPT_SESSION_EVENT_LIMITS_H
#define ISO_SCULPT_SESSION_EVENT_LIMITS_H

#include "sculpt/session/journal.h"

/* Check all numbers of a header, and of an event in the file with this header. Also called before writing, so
 * that every written file can be read. */
iso_status iso_limits_start(const iso_journal_start *start, iso_error *error);
iso_status iso_limits_event(const iso_event *event, const iso_journal_start *start, iso_error *error);

#endif
