/* isorender merge: puts the parts of a picture, as --part has drawn them, together to the picture. */
#include "apps/isorender/merge.h"

#include "apps/isorender/isorender.h"
#include "base/file.h"
#include "base/memory.h"
#include "image/image_file.h"
#include "io/key_file.h"
#include "scene/keys_picture.h"

static iso_status write_picture(const iso_key_file *file, const iso_image *image, const char *path,
                                iso_pool *pool, iso_error *error) {
    static const char *const keys[ISO_KEY_TEXTS] = {"Software", "Title", "Comment", "Description", "Scene"};
    iso_png_text texts[ISO_KEY_TEXTS];
    int count = 0;
    for (int i = 0; i < ISO_KEY_TEXTS; i++)
        if (file->texts[i]) texts[count++] = (iso_png_text){keys[i], file->texts[i]};
    const bool sheet = iso_image_is_sheet(path); /* not of the size of what it shows */
    const iso_png_opts opts = {.texts = texts,
                               .text_count = count,
                               .pixels_per_metre = sheet ? 0 : file->style.pixels_per_metre,
                               .pool = pool};
    return iso_image_file_write(path, image, &opts, error);
}

static iso_status merge(const isorender_settings *settings, iso_pool *pool, iso_error *error) {
    const uint64_t limit = iso_memory_limit(settings->common.input.max_memory);
    iso_key_file file;
    iso_image image = {0};
    ISO_TRY(iso_key_files_merge(settings->inputs, settings->input_count, limit == UINT64_MAX ? 0 : limit,
                                pool, &file, error));
    iso_status status = iso_image_create(file.style.width, file.style.height, &image, error);
    if (status == ISO_OK)
        status = iso_render_key_style(&file.style, &file.surface.transform, file.surface.dims, &file.keys,
                                      pool, &image, error);
    if (status == ISO_OK) status = write_picture(&file, &image, settings->output, pool, error);
    iso_image_free(&image);
    iso_key_file_free(&file);
    return status;
}

static iso_status check_files(const isorender_settings *settings, iso_error *error) {
    iso_file_set files = {0};
    for (int i = 0; i < settings->input_count; i++) iso_file_set_read(&files, settings->inputs[i]);
    iso_file_set_write(&files, settings->output);
    iso_status status = iso_file_set_check(&files, error);
    iso_file_set_free(&files);
    if (status == ISO_OK) status = iso_image_file_check(settings->output, error);
    return status == ISO_OK ? iso_sink_check(settings->output, error) : status;
}

iso_status isorender_merge(const isorender_settings *settings, iso_error *error) {
    iso_pool *pool = NULL;
    iso_settings_limit_memory(&settings->common);
    ISO_TRY(check_files(settings, error));
    ISO_TRY(iso_pool_create(settings->common.threads, &pool, error));
    const iso_status status = merge(settings, pool, error);
    iso_pool_destroy(pool);
    if (status == ISO_OK && !settings->common.quiet)
        iso_program_log(isorender_program(), "wrote %s: %d parts", settings->output, settings->input_count);
    return status;
}
