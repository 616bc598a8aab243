/* The functions of isopoint_figures.h: what stands over a picture. */
#include "isopoint_figures.h"

#include <string.h>

#include "api/internal.h"
#include "image/annotate.h"
#include "image/image_file.h"

static iso_status check_note(const iso_note *note, iso_error *error) {
    const bool ruler = note->kind == ISO_NOTE_RULER;
    if (ruler && !(note->from.in_world && note->to.in_world))
        return iso_fail(error, ISO_ERR_USAGE, "a ruler is between two places of the world");
    if (note->kind == ISO_NOTE_TEXT && !note->text)
        return iso_fail(error, ISO_ERR_USAGE, "a note without a text");
    return note->text && !ruler ? iso_drawing_check_text(note->text, error) : ISO_OK;
}

static iso_status draw(const iso_image *image, const iso_figure_opts *opts, iso_drawing *drawing,
                       iso_error *error) {
    if (!image->rgba || !opts || !opts->marks.camera)
        return iso_fail(error, ISO_ERR_USAGE, "annotations need a picture and its camera");
    ISO_TRY(iso_camera_check(opts->marks.camera, error));
    for (int i = 0; i < opts->note_count; i++) ISO_TRY(check_note(&opts->notes[i], error));
    const iso_annotation_opts *m = &opts->marks;
    const iso_annotation annotation = {.camera = m->camera,
                                       .font_size = opts->font_size * (opts->dpi > 0 ? opts->dpi : 72) / 72,
                                       .lengths = {.unit = m->no_unit ? ISO_UNIT_NONE : ISO_UNIT_AUTO},
                                       .scale_bar = m->scale_bar,
                                       .orientation_marker = m->orientation_marker,
                                       .anatomical = m->anatomical,
                                       .legend = opts->legend,
                                       .legend_count = opts->legend_count,
                                       .notes = opts->notes,
                                       .note_count = opts->note_count,
                                       .dark = m->light};
    return iso_annotation_draw(drawing, &annotation, image->width, image->height, error);
}

iso_status iso_figure_paint(iso_image *image, const iso_figure_opts *opts, iso_error *error) {
    iso_drawing drawing = {.marks = NULL};
    iso_status status = draw(image, opts, &drawing, error);
    if (status == ISO_OK) status = iso_drawing_paint(&drawing, image, error);
    iso_drawing_free(&drawing);
    return status;
}

iso_status iso_image_annotate(iso_image *image, const iso_annotation_opts *opts, iso_error *error) {
    if (!opts) return iso_fail(error, ISO_ERR_USAGE, "annotations need a picture and its camera");
    const iso_figure_opts figure = {.marks = *opts};
    return iso_figure_paint(image, &figure, error);
}

static iso_status copy_image(const iso_image *image, iso_image *copy, iso_error *error) {
    ISO_TRY(iso_image_create(image->width, image->height, copy, error));
    memcpy(copy->rgba, image->rgba, 4 * (size_t)image->width * (size_t)image->height);
    return ISO_OK;
}

iso_status iso_figure_write(const iso_image *image, const iso_figure_opts *opts, const char *path,
                            iso_error *error) {
    char software[64] = "isopoint ";
    strncat(software, iso_version(), sizeof software - strlen(software) - 1);
    const iso_png_text text = {"Software", software};
    iso_drawing drawing = {.marks = NULL};
    iso_image copy = {0};
    ISO_TRY(iso_api_check_path(path, error));
    ISO_TRY(iso_image_file_check(path, error));
    iso_status status = draw(image, opts, &drawing, error);
    if (status == ISO_OK) status = copy_image(image, &copy, error);
    const iso_png_opts png = {.texts = &text,
                              .text_count = 1,
                              .pixels_per_metre = status == ISO_OK && opts->dpi > 0 ? opts->dpi / 0.0254 : 0};
    if (status == ISO_OK) status = iso_image_file_write_drawing(path, &copy, &drawing, &png, error);
    iso_drawing_free(&drawing);
    iso_image_free(&copy);
    return status;
}
