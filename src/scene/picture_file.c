/* picture_file: writes pictures. */
#include "scene/picture_file.h"

iso_status iso_picture_file_check(const char *image, const char *aov, iso_error *error) {
    if (image) ISO_TRY(iso_image_file_check(image, error));
    if (!aov || iso_exr_available()) return ISO_OK;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: built without OpenEXR", aov);
}

iso_status iso_picture_file_write(const char *path, iso_image *image, const iso_drawing *over,
                                  const iso_picture_facts *facts, iso_error *error) {
    const iso_png_text all[] = {{"Software", facts->software},
                                {"Title", facts->title},
                                {"Comment", facts->command},
                                {"Description", facts->description},
                                {"Scene", facts->scene}};
    enum { TEXTS = sizeof all / sizeof *all };
    iso_png_text texts[TEXTS];
    int count = 0;
    for (int i = 0; i < TEXTS; i++)
        if (all[i].value) texts[count++] = all[i];
    /* (a sheet has a size in points, not that of what it shows) */
    const bool sized = facts->sized || !iso_image_is_sheet(path);
    const iso_png_opts opts = {.texts = texts,
                               .text_count = count,
                               .pixels_per_metre = sized ? facts->pixels_per_metre : 0,
                               .pool = facts->pool};
    return over ? iso_image_file_write_drawing(path, image, over, &opts, error)
                : iso_image_file_write(path, image, &opts, error);
}

iso_status iso_picture_file_add(const char *path, const iso_image *image, double frame_rate, bool transparent,
                                const iso_picture_facts *facts, bool last, iso_video **video,
                                iso_error *error) {
    const iso_video_opts opts = {.width = image->width,
                                 .height = image->height,
                                 .frame_rate = frame_rate,
                                 .transparent = transparent,
                                 .title = facts->title,
                                 .text = facts->command};
    if (!*video) ISO_TRY(iso_video_open(path, &opts, video, error));
    ISO_TRY(iso_video_add(*video, image, error));
    if (!last) return ISO_OK;
    iso_video *whole = *video;
    *video = NULL;
    return iso_video_commit(whole, error);
}

iso_status iso_picture_file_write_aov(const char *path, const iso_aov *aov, const iso_camera *camera,
                                      const iso_picture_facts *facts, iso_error *error) {
    const iso_view view = iso_view_make(camera, aov->width, aov->height);
    const iso_exr_info info = {.view = &view, .software = facts->software, .comments = facts->command};
    return iso_exr_write(path, aov, &info, facts->pool, error);
}
