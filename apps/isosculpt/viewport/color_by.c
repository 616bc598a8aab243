/* color_by: reads what surfaces are coloured by, and finds the range of its numbers. */
#include "apps/isosculpt/viewport/color_by.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "apps/common/coloring_settings.h"
#include "base/memory.h"

static const isosculpt_color_by NOTHING = {.range = {NAN, NAN}, .ranged_isovalue = NAN};

const isosculpt_color_by *isosculpt_viewport_color_by(const isosculpt_viewport *viewport) {
    return viewport->color_by ? viewport->color_by : &NOTHING;
}

bool isosculpt_viewport_is_colored(const isosculpt_viewport *viewport) {
    return viewport->lod && !viewport->opaque && isosculpt_viewport_color_by(viewport)->what[0];
}

/* What can be changed: made when something is set for the first time. NULL: no memory. */
static isosculpt_color_by *changeable(isosculpt_viewport *viewport, iso_error *error) {
    if (viewport->color_by) return viewport->color_by;
    viewport->color_by = iso_alloc(sizeof *viewport->color_by);
    if (viewport->color_by)
        *viewport->color_by = NOTHING;
    else
        iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    return viewport->color_by;
}

/* The file that surfaces are coloured by, with what it borrows. */
typedef struct isosculpt_color_file {
    iso_coloring_settings settings;
    iso_color_file file;
} isosculpt_color_file;

static void close_file(isosculpt_color_file *read) {
    if (read) iso_color_file_close(&read->file);
    iso_free(read);
}

static iso_status read_file(const iso_coloring_settings *settings, iso_pool *pool,
                            isosculpt_color_file **read, iso_error *error) {
    isosculpt_color_file *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    made->settings = *settings;
    made->file = iso_coloring_settings_file(&made->settings);
    iso_status status =
        iso_color_file_is_vertices(&made->file)
            ? iso_fail(error, ISO_ERR_USAGE, "%s: a volume's surfaces have no such vertices", settings->path)
            : iso_color_file_open(&made->file, 0, NULL, pool, error);
    if (status == ISO_OK) status = iso_color_file_read(&made->file, error);
    if (status == ISO_OK)
        *read = made;
    else
        close_file(made);
    return status;
}

/* Sets the bar's colours; signed numbers usually have those with a light middle. */
static iso_status apply_map(isosculpt_color_by *by, const char *map, iso_error *error) {
    iso_colormap_choice choice;
    iso_color_table table = {NULL, 0};
    ISO_TRY(iso_colormap_choice_parse(map[0] ? map : NULL, &choice, error));
    if (choice.file) ISO_TRY(iso_color_table_read(choice.file, &table, error));
    if (!choice.given && iso_color_source_is_signed(by->coloring.source)) choice.map = ISO_COLORMAP_COOLWARM;
    iso_color_table_free(&by->table);
    by->table = table;
    by->coloring.bar.map = choice.map;
    by->coloring.bar.table = choice.file ? &by->table : NULL;
    return ISO_OK;
}

iso_status isosculpt_color_by_set(isosculpt_viewport *viewport, const char *what, iso_error *error) {
    isosculpt_color_by *by = changeable(viewport, error);
    iso_coloring_settings settings;
    isosculpt_color_file *file = NULL;
    if (!by) return ISO_ERR_NOMEM;
    if (!what[0]) {
        by->what[0] = 0;
        return ISO_OK;
    }
    if (strlen(what) >= sizeof by->what) return iso_fail(error, ISO_ERR_USAGE, "'%.40s..' is too long", what);
    ISO_TRY(iso_coloring_settings_parse(what, &settings, error));
    if (settings.things.named)
        return iso_fail(error, ISO_ERR_USAGE, "--surface-color-by %s: a window colours all surfaces alike",
                        what);
    if (settings.path[0]) ISO_TRY(read_file(&settings, viewport->pool, &file, error));
    close_file(by->file);
    by->file = file;
    snprintf(by->what, sizeof by->what, "%s", what);
    by->coloring.source = settings.source;
    by->coloring.distance = file ? file->file.distance : NULL;
    iso_coloring_set_grid(&by->coloring, settings.source == ISO_COLOR_BY_VOLUME
                                             ? &file->file.loader.volume.grid
                                             : &viewport->grid);
    iso_coloring_settings_title(&settings, ISO_WORLD_UNIT_NONE, &by->coloring.bar);
    by->ranged_isovalue = NAN;
    return apply_map(by, by->map, error);
}

iso_status isosculpt_color_by_set_map(isosculpt_viewport *viewport, const char *map, iso_error *error) {
    isosculpt_color_by *by = changeable(viewport, error);
    if (!by) return ISO_ERR_NOMEM;
    if (strlen(map) >= sizeof by->map) return iso_fail(error, ISO_ERR_USAGE, "'%.40s..' is too long", map);
    ISO_TRY(apply_map(by, map, error));
    snprintf(by->map, sizeof by->map, "%s", map);
    return ISO_OK;
}

iso_status isosculpt_color_by_set_range(isosculpt_viewport *viewport, const double range[2],
                                        iso_error *error) {
    isosculpt_color_by *by = changeable(viewport, error);
    if (!by) return ISO_ERR_NOMEM;
    memcpy(by->range, range, sizeof by->range);
    by->ranged_isovalue = NAN;
    return ISO_OK;
}

/* Where none is given, the colormap is that of the range. */
static void use_usual_map(isosculpt_color_by *by) {
    if (!by->map[0]) by->coloring.bar.map = iso_coloring_usual_map(by->coloring.source, &by->coloring.bar);
}

iso_status isosculpt_color_by_find_range(isosculpt_viewport *viewport, bool moving, iso_error *error) {
    isosculpt_color_by *by = viewport->color_by;
    size_t points, found;
    if (!isosculpt_viewport_is_colored(viewport)) return ISO_OK;
    if (!isnan(by->range[0])) {
        by->coloring.bar.low = by->range[0];
        by->coloring.bar.high = by->range[1];
        use_usual_map(by);
        return ISO_OK;
    }
    const bool of_view = by->coloring.source == ISO_COLOR_BY_DEPTH,
               known = by->ranged_isovalue == viewport->isovalue && !of_view;
    if (known || (moving && !isnan(by->ranged_isovalue))) return ISO_OK;
    const iso_view view = iso_view_make(&viewport->camera, viewport->width, viewport->height);
    iso_scene_surface surface = viewport->surface;
    surface.isovalue = viewport->isovalue;
    surface.mesh = NULL; /* which may be that of another isovalue */
    ISO_TRY(iso_coloring_find_surface_range(&by->coloring, &surface, &view, &points, &found, error));
    by->ranged_isovalue = viewport->isovalue;
    use_usual_map(by);
    return ISO_OK;
}

void isosculpt_color_by_free(isosculpt_viewport *viewport) {
    isosculpt_color_by *by = viewport->color_by;
    if (!by) return;
    close_file(by->file);
    iso_color_table_free(&by->table);
    iso_free(by);
    viewport->color_by = NULL;
}
