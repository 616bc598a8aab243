/* Looks colours up in the paint of a field. */
#include "scene/painted.h"

#include <string.h>

iso_painted iso_painted_make(const iso_cell_items *paint, const iso_hgrid *field, iso_rgb own) {
    iso_painted painted = {.affine = iso_transform_affine(&field->transform), .own = own};
    painted.view.paint = paint;
    memcpy(painted.view.cells, field->cells, sizeof painted.view.cells);
    return painted;
}

static uint8_t blend(unsigned own, unsigned paint, unsigned amount) {
    return (uint8_t)((own * (255 - amount) + paint * amount + 127) / 255);
}

iso_rgb iso_painted_color(const iso_painted *painted, iso_vec3 place) {
    const iso_rgb own = painted->own;
    const uint32_t color = iso_paint_at(&painted->view, iso_affine_point_to_index(&painted->affine, place));
    const unsigned amount = iso_paint_amount(color);
    return (iso_rgb){blend(own.r, color & 255, amount), blend(own.g, color >> 8 & 255, amount),
                     blend(own.b, color >> 16 & 255, amount)};
}

/* iso_surface_colors.at. */
static iso_rgb color_at(const void *context, const iso_colored_point *point, iso_nearby *nearby) {
    (void)nearby;
    return iso_painted_color(context, point->place);
}

iso_coloring iso_painted_coloring(const iso_painted *painted) {
    return (iso_coloring){.given = {color_at, painted}};
}

iso_status iso_painted_put_vdb(FILE *stream, const char *name, const iso_hgrid *field,
                               const iso_painted *painted, const iso_progress *progress, iso_error *error) {
    const iso_rgb own = painted->own;
    const bool any = iso_painted_any(painted);
    const iso_level_set_colors colors = {.cell = any ? (const void *const *)painted->view.paint->cell : NULL,
                                         .own = {own.r, own.g, own.b}};
    return iso_level_set_put_vdb(stream, name, field, "surface", any ? &colors : NULL, progress, error);
}

iso_status iso_painted_read(const char *path, const struct iso_volume_opts *opts, iso_cell_items *paint,
                            iso_painted *painted, iso_error *error) {
    iso_paint_file file;
    *painted = (iso_painted){.log = NULL};
    ISO_TRY(iso_paint_read(path, opts, paint, &file, error));
    *painted = (iso_painted){.view = file.view, .affine = file.affine, .own = file.own};
    return ISO_OK;
}
