/* text: makes names and other text from outside printable.
 *
 * The name of a file and the strings in its header may have any bytes: escape sequences for terminals, line
 * breaks that turn one message into two, bytes that are not UTF-8. All such text is cleaned with
 * iso_text_clean before it is shown or written to a text format; iso_fail and iso_volume_note do so
 * themselves. All functions here are thread-safe. */
#ifndef ISO_BASE_TEXT_H
#define ISO_BASE_TEXT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the length in bytes, 1 to 4, of the valid UTF-8 sequence at `text`; 0 if there is none. The
 * terminating zero is a sequence of one byte. */
int iso_text_utf8(const char *text);

/* Writes `text` to `clean` as printable UTF-8 on one line. \n, \t and \r replace these characters; \xNN
 * replaces each byte of other control characters, of characters that break lines or change the direction of
 * writing, and bytes that are not UTF-8. Backslashes stay, so that cleaning a clean text does not change it.
 * `room` is the size of `clean`, at least 1. If the text is too long, its middle is replaced by "...", so
 * that a message keeps the name at its beginning and the reason at its end; no character is cut. `text` and
 * `clean` must not overlap. Returns the length of the whole clean text without the terminating zero, as
 * snprintf does. */
size_t iso_text_clean(const char *text, char *clean, size_t room);

/* Cleans a string in place; it has `room` bytes. A UTF-8 sequence that the end of the room has cut off is
 * removed. */
void iso_text_clean_in_place(char *text, size_t room);

/* Returns a clean copy of the whole `text`, to be freed with free(). NULL: out of memory. */
char *iso_text_clean_copy(const char *text);

/* If the clean text `text` begins with the clean form of `name`, returns the length of this form, else 0. */
size_t iso_text_begins(const char *text, const char *name);

/* Writes the clean form of `text` to a stream; it may have any length. */
void iso_text_put(FILE *stream, const char *text);

/* Whether `text` ends with `suffix`; case matters. */
bool iso_text_ends_with(const char *text, const char *suffix);

/* Whether the name of a file ends with `extension` (for example ".gz") and is longer than it; case does not
 * matter. */
bool iso_text_has_extension(const char *name, const char *extension);

/* Formats as vsnprintf and cleans the result. */
void iso_text_format(char *clean, size_t room, const char *format, va_list arguments);

#ifdef __cplusplus
}
#endif
#endif
