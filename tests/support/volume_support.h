/* volume_support: reads volumes and checks results and errors, for tests of readers. */
#ifndef ISO_TESTS_VOLUME_SUPPORT_H
#define ISO_TESTS_VOLUME_SUPPORT_H

#include "grids/volume/volume.h"

/* Reads a volume; fails the test with the error's text on errors. */
iso_volume test_read_volume(const char *path, const iso_volume_opts *opts);

/* Fails the test unless reading fails with `status` and one line that contains `words` and the name `file`
 * (NULL: path). */
void test_expect_no_volume(const char *path, const iso_volume_opts *opts, iso_status status, const char *file,
                           const char *words);

/* Whether one of the notes contains `words`. */
int test_has_note(const iso_volume_info *info, const char *words);

/* Reads the file `times` times with one byte damaged, at position `from` or later; each time the result must
 * be a volume, or an error with one line that contains `file`. The last damaged file remains at `path`. */
void test_read_damaged(const char *path, size_t from, uint32_t times, const char *file);

/* A hash of x, used as a pseudo-random number. */
uint32_t test_hash(uint32_t x);

#endif
