/* volume_support: what tests of readers share. */
#ifndef ISO_TESTS_VOLUME_SUPPORT_H
#define ISO_TESTS_VOLUME_SUPPORT_H

#include "grids/volume/volume.h"

/* The volume, or the test fails with the error's text. */
iso_volume test_read_volume(const char *path, const iso_volume_opts *opts);

/* The read must fail with `status` and a line that names the file, or the part of it that `file` is (NULL:
 * path), and contains `words`. */
void test_expect_no_volume(const char *path, const iso_volume_opts *opts, iso_status status, const char *file,
                           const char *words);

/* Whether one of the notes contains `words`. */
int test_has_note(const iso_volume_info *info, const char *words);

/* Reads the file with one byte damaged, from place `from` on, `times` times: the volume, or a line that names
 * `file`. What is left at `path` is the last of these. */
void test_read_damaged(const char *path, size_t from, uint32_t times, const char *file);

/* A number that looks random. */
uint32_t test_hash(uint32_t x);

#endif
