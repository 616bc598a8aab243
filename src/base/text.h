/* text: names and other text from outside, made fit to be shown.
 *
 * A file's name and the strings in its header may hold any bytes: escape sequences that a terminal obeys,
 * line breaks that turn one message into two, bytes that are no UTF-8. Whatever is shown or written into a
 * text format goes through iso_text_clean: iso_fail and iso_volume_note do so themselves. All functions here
 * are thread-safe. */
#ifndef ISO_BASE_TEXT_H
#define ISO_BASE_TEXT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Length in bytes of the valid UTF-8 sequence at `text`, 1 to 4; 0 when there is none. The terminating zero
 * is a sequence of one byte. */
int iso_text_utf8(const char *text);

/* Writes `text` to `clean` as printable UTF-8 on one line: \n, \t and \r for these characters, \xNN for each
 * byte of other control characters, of characters that break lines or change the direction of writing, and of
 * what is no UTF-8. A backslash stays as it is, so that clean text is not changed again. `room` is the size
 * of `clean` and at least 1; text that is too long loses its middle, which becomes "...": a message keeps the
 * name that it begins with and the reason that it ends with. No character is cut. `text` and `clean` must not
 * overlap. Returns the length of the whole clean text without its zero, as snprintf does. */
size_t iso_text_clean(const char *text, char *clean, size_t room);

/* The same in the place of a string that has `room` bytes. A character that the string's end cut in half is
 * left out. */
void iso_text_clean_in_place(char *text, size_t room);

/* A clean copy of all of `text`, to be freed with free(). NULL without memory. */
char *iso_text_clean_copy(const char *text);

/* Length of what iso_text_clean makes of `name` when clean `text` begins with it, else 0. */
size_t iso_text_begins(const char *text, const char *name);

/* Writes what iso_text_clean makes of `text`, however long that is. */
void iso_text_put(FILE *stream, const char *text);

/* Whether `text` ends in `suffix`, letter for letter. */
bool iso_text_ends_with(const char *text, const char *suffix);

/* Whether a file's name ends in `extension` (".gz"), in capitals or not, and something stands before it. */
bool iso_text_has_extension(const char *name, const char *extension);

/* Formats as vsnprintf and cleans the result. */
void iso_text_format(char *clean, size_t room, const char *format, va_list arguments);

#ifdef __cplusplus
}
#endif
#endif
