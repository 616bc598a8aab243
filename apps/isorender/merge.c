/* isorender merge: puts the parts of a picture, as --part has drawn them, together to the picture. */
#include "apps/isorender/merge.h"

#include "base/file.h"
#include "base/memory.h"
#include "scene/keys_picture.h"

static iso_status check_files(const isorender_settings *settings, iso_error *error) {
    iso_file_set files = {0};
    for (int i = 0; i < settings->input_count; i++) iso_file_set_read(&files, settings->inputs[i]);
    iso_file_set_write(&files, settings->output);
    iso_status status = iso_file_set_check(&files, error);
    iso_file_set_free(&files);
    if (status == ISO_OK) status = iso_picture_file_check(settings->output, NULL, error);
    return status == ISO_OK ? iso_sink_check(settings->output, error) : status;
}

iso_status isorender_merge(const isorender_settings *settings, iso_error *error) {
    iso_pool *pool = NULL;
    iso_settings_limit_memory(&settings->common);
    ISO_TRY(check_files(settings, error));
    ISO_TRY(iso_pool_create(settings->common.threads, &pool, error));
    const uint64_t limit = iso_memory_limit(settings->common.input.max_memory);
    const iso_status status =
        iso_keys_picture_write(settings->output, settings->inputs, settings->input_count,
                               limit == UINT64_MAX ? 0 : limit, pool, error);
    iso_pool_destroy(pool);
    if (status == ISO_OK && !settings->common.quiet)
        iso_program_log(isorender_program(), "wrote %s: %d parts", settings->output, settings->input_count);
    return status;
}
