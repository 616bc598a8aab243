/* event: lines of a stroke file, to text and back. Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_EVENT_H
#define ISO_SCULPT_SESSION_EVENT_H

#include <stdbool.h>
#include <stddef.h>

#include "sculpt/session/journal.h"

/* One line with its checksum and newline, malloc'ed (free). NULL: out of memory. */
char *iso_event_header_text(const iso_journal_start *start);
char *iso_event_text(const iso_event *event, unsigned long long number);

/* What a line is: one that this program wrote (or might have written); one of which a part is missing or
 * other than it was written; one that is whole, by its checksum, and says what no recording says. */
typedef enum iso_line { ISO_LINE_SOUND, ISO_LINE_TORN, ISO_LINE_WRONG } iso_line;

/* What a line (without its newline) says; a stamp that it holds is the caller's. Each number is compared with
 * its bounds (limits.h), lengths by the header's voxel size. *why says what is wrong. */
iso_line iso_event_header_read(const char *line, size_t size, iso_journal_start *start, iso_error *why);
typedef struct iso_event_place {
    const iso_journal_start *start;
    unsigned long long number;
} iso_event_place;
iso_line iso_event_read(const char *line, size_t size, const iso_event_place *place, iso_event *event,
                        iso_error *why);

#endif
