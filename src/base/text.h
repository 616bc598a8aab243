/* text: makes file names and other untrusted text printable.
 *
 * A file's name and the strings in its header may hold any bytes: escape sequences for the terminal, line
 * breaks, bytes that are not UTF-8. Such text must be cleaned (iso_text_clean) before it is shown or written
 * into a text format; iso_fail and iso_volume_note clean their arguments themselves. All functions here are
 * thread-safe. */
#ifndef ISO_BASE_TEXT_H
#define ISO_BASE_TEXT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The length in bytes of the valid UTF-8 sequence at `text`, 1 to 4; 0: the bytes there are not valid. The
 * terminating zero is a sequence of one byte. */
int iso_text_utf8(const char *text);

/* The length of the byte order mark of UTF-8 that the first bytes of a file begin with: 3, or 0. */
size_t iso_text_mark(const void *text, size_t bytes);

/* "UTF-16" or "UTF-32" when the first bytes of a file are the byte order mark of that encoding; else NULL.
 * Binary data can begin with the same bytes: ask only where text is expected. */
const char *iso_text_wide(const void *text, size_t bytes);

/* Writes `text` to `clean` as printable UTF-8 on one line: \n, \t and \r for these characters; \xNN for each
 * byte of other control characters, of characters that break lines or change the direction of writing, and of
 * invalid UTF-8. A backslash is not changed, so that cleaning clean text changes nothing. `room` is the size
 * of `clean`, at least 1. In text that is too long the middle is replaced by "...", so that a message keeps
 * the file name at its start and the reason at its end. Characters are never cut. `text` and `clean` must not
 * overlap. Returns the length of the whole clean text without its zero, as snprintf does. */
size_t iso_text_clean(const char *text, char *clean, size_t room);

/* Cleans a string in place, in its memory of `room` bytes. An incomplete UTF-8 sequence at the end of the
 * string is removed. */
void iso_text_clean_in_place(char *text, size_t room);

/* A clean copy of all of `text`, to be freed with free(). NULL without memory. */
char *iso_text_clean_copy(const char *text);

/* Whether a clean text begins with the clean form of `name`: returns the length of that form, else 0. */
size_t iso_text_begins(const char *text, const char *name);

/* Writes the clean form of `text`, of any length. */
void iso_text_put(FILE *stream, const char *text);

/* Whether `text` ends in `suffix`; case matters. */
bool iso_text_ends_with(const char *text, const char *suffix);

/* Whether a file's name ends in `extension` (".gz"), in either case, and has characters before it, or is the
 * extension, if this has no dot ("CHGCAR"). */
bool iso_text_has_extension(const char *name, const char *extension);

/* Whether one of `words`, which are separated by blanks, equals the first `length` characters of `word`.
 * NULL: there are no words. */
bool iso_text_has_word(const char *words, const char *word, size_t length);

/* Formats as vsnprintf and cleans the result. */
void iso_text_format(char *clean, size_t room, const char *format, va_list arguments);

#endif
