/* volume_support: reads volumes, intact and damaged, and checks errors and notes. */
#include "volume_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "file_support.h"

iso_volume test_read_volume(const char *path, const iso_volume_opts *opts) {
    iso_error error = {0};
    iso_volume volume = {0};
    if (iso_volume_read(path, opts, &volume, &error) != ISO_OK) fail_msg("%s", error.text);
    return volume;
}

void test_expect_no_volume(const char *path, const iso_volume_opts *opts, iso_status status, const char *file,
                           const char *words) {
    iso_error error = {0};
    iso_volume volume = {0};
    const iso_status got = iso_volume_read(path, opts, &volume, &error);
    if (got != status)
        fail_msg("%s instead of %s: %s", iso_status_text(got), iso_status_text(status), error.text);
    if (!strstr(error.text, file ? file : path) || !strstr(error.text, words))
        fail_msg("'%s' lacks '%s'", error.text, words);
    assert_null(volume.grid.rgrid);
    assert_null(volume.grid.hgrid);
}

int test_has_note(const iso_volume_info *info, const char *words) {
    for (int i = 0; i < info->note_count; i++)
        if (strstr(info->notes[i], words)) return 1;
    return 0;
}

void test_read_damaged(const char *path, size_t from, uint32_t times, const char *file) {
    size_t count;
    uint8_t *whole = slurp(path, &count);
    const iso_volume_opts opts = {.max_memory = 1 << 28};
    for (uint32_t i = 0; i < times; i++) {
        const size_t at = from + test_hash(i) % (count - from);
        const uint8_t old = whole[at];
        whole[at] ^= (uint8_t)(i % 3 ? 1U << test_hash(i + 5000) % 8 : 0xff);
        spill(path, whole, count);
        iso_volume volume = {0};
        iso_error error = {0};
        if (iso_volume_read(path, &opts, &volume, &error) == ISO_OK)
            iso_volume_free(&volume);
        else
            assert_non_null(strstr(error.text, file));
        whole[at] = old;
    }
    free(whole);
}

uint32_t test_hash(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    return x ^ x >> 16;
}
