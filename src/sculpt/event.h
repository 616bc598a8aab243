/* event: lines of a stroke file, to text and back. Internal to sculpt. */
#ifndef ISO_SCULPT_EVENT_H
#define ISO_SCULPT_EVENT_H

#include <stdbool.h>
#include <stddef.h>

#include "sculpt/journal.h"

/* One line with its checksum and newline, malloc'ed (free). NULL: out of memory. */
char *iso_event_header_text(const iso_journal_start *start);
char *iso_event_text(const iso_event *event, unsigned long long number);

/* What a line (without its newline) says; a stamp that it holds is the caller's. false: damaged, or no such
 * line; *why says what is wrong. */
bool iso_event_header_read(const char *line, size_t size, iso_journal_start *start, const char **why);
bool iso_event_read(const char *line, size_t size, unsigned long long number, iso_event *event,
                    const char **why);

#endif
