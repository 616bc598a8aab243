/* event: converts events to lines of a stroke file and back. Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_EVENT_H
#define ISO_SCULPT_SESSION_EVENT_H

#include <stdbool.h>
#include <stddef.h>

#include "sculpt/session/journal.h"

/* Return the line of a header or an event, with its checksum and newline; malloc'ed (free). NULL: out of
 * memory. */
char *iso_event_header_text(const iso_journal_start *start);
char *iso_event_text(const iso_event *event, unsigned long long number);

typedef enum iso_line {
    ISO_LINE_SOUND, /* valid */
    ISO_LINE_TORN,  /* incomplete, or the checksum does not match: a write that was cut off, or damage */
    ISO_LINE_WRONG  /* the checksum matches, but the content is not valid */
} iso_line;

/* Parse a line (without its newline). Each number is checked against its bounds (limits.h); lengths are
 * compared in voxels of the header. A stamp and a path (iso_free) in the event belong to the caller. If the
 * line is not sound, *why says what is wrong with it. */
iso_line iso_event_header_read(const char *line, size_t size, iso_journal_start *start, iso_error *why);
typedef struct iso_event_context {
    const iso_journal_start *start;
    unsigned long long number; /* the number that the event must have */
} iso_event_context;
iso_line iso_event_read(const char *line, size_t size, const iso_event_context *context, iso_event *event,
                        iso_error *why);

#endif
