#include "volume_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

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
