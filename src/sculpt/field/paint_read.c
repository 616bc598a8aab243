/* Reads paint from .vdb files. */
#include <string.h>

#include "grids/level_set.h"
#include "sculpt/field/paint.h"

/* What receives the colours. */
typedef struct paint_reading {
    iso_cell_items *paint;
    iso_paint_file *file;
} paint_reading;

/* iso_color_receiver.begin. */
static iso_status begin(void *context, const iso_transform *transform, const int cells[3],
                        const uint8_t own[3], iso_error *error) {
    const paint_reading *r = context;
    *r->file = (iso_paint_file){
        .view.paint = r->paint, .affine = iso_transform_affine(transform), .own = {own[0], own[1], own[2]}};
    memcpy(r->file->view.cells, cells, sizeof r->file->view.cells);
    return iso_cell_items_init(r->paint, "colours", (size_t)cells[0] * (size_t)cells[1] * (size_t)cells[2],
                               sizeof(iso_paint_item), error);
}

/* iso_color_receiver.cell. */
static iso_status add_cell(void *context, size_t cell, const uint32_t *colors, iso_error *error) {
    const paint_reading *r = context;
    return iso_cell_items_set(r->paint, cell, colors, error);
}

iso_status iso_paint_read(const char *path, const struct iso_volume_opts *opts, iso_cell_items *paint,
                          iso_paint_file *file, iso_error *error) {
    paint_reading reading = {paint, file};
    const iso_color_receiver receiver = {&reading, begin, add_cell};
    *paint = (iso_cell_items){.cell = NULL};
    *file = (iso_paint_file){.view.paint = NULL};
    const iso_status status = iso_level_set_read_colors(path, opts, &receiver, error);
    if (status != ISO_OK) iso_cell_items_free(paint);
    return status;
}
