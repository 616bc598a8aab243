/* strokes: plays a stroke file from the field that it began with. */
#include "source/strokes.h"

#include <string.h>

#include "base/file.h"
#include "grids/grid.h"

bool iso_strokes_are_in(const char *path) {
    static const char first[] = "{\"format\":\"isopoint strokes\"";
    char begin[sizeof first] = "";
    const size_t count = iso_file_head(path, begin, sizeof first - 1);
    return count == sizeof first - 1 && strcmp(begin, first) == 0;
}

iso_status iso_strokes_open(const char *path, const iso_source *how, iso_strokes *strokes, iso_error *error) {
    iso_cell_items paint = {.cell = NULL};
    const iso_session_opts opts = {.pool = how->pool, .paint = &paint};
    iso_source with_paint = *how;
    with_paint.paint = &paint;
    iso_hgrid *grid = NULL;
    *strokes = (iso_strokes){.session = NULL};
    ISO_TRY(iso_journal_open(path, &strokes->start, &strokes->reader, error));
    ISO_TRY(iso_source_reopen(path, &with_paint, &strokes->start, &grid, error));
    return iso_session_create(grid, &strokes->start, &opts, &strokes->session, error);
}

iso_status iso_strokes_next(iso_strokes *strokes, iso_event *event, bool *more, iso_error *error) {
    iso_status status = ISO_OK;
    ISO_TRY(iso_journal_next(strokes->reader, event, more, error));
    if (*more) {
        status = iso_session_play(strokes->session, event, NULL, error);
        if (event->kind <= ISO_EVENT_CANCEL) strokes->drawing = event->kind <= ISO_EVENT_SAMPLE;
    } else if (strokes->drawing) {
        status = iso_session_end_cut_off(strokes->session, error);
        strokes->drawing = false;
    }
    return iso_journal_add_location(strokes->reader, status, error);
}

iso_status iso_strokes_finish(iso_strokes *strokes, iso_error *error) {
    iso_event event;
    bool more = true;
    while (more) ISO_TRY(iso_strokes_next(strokes, &event, &more, error));
    return ISO_OK;
}

void iso_strokes_close(iso_strokes *strokes) {
    iso_session_destroy(strokes->session);
    iso_journal_reader_free(strokes->reader);
    *strokes = (iso_strokes){.session = NULL};
}

iso_status iso_strokes_play(const char *path, const iso_source *how, iso_hgrid **grid, iso_cell_items *paint,
                            iso_error *error) {
    iso_strokes strokes;
    iso_grid copy = {.hgrid = NULL};
    *paint = (iso_cell_items){.cell = NULL};
    iso_status status = iso_strokes_open(path, how, &strokes, error);
    if (status == ISO_OK) status = iso_strokes_finish(&strokes, error);
    if (status == ISO_OK) {
        const iso_grid played = {.hgrid = iso_session_grid(strokes.session)};
        status = iso_grid_copy(&played, how->pool, &copy, error);
    }
    if (status == ISO_OK) status = iso_cell_items_copy(iso_session_paint(strokes.session), paint, error);
    if (status != ISO_OK) {
        iso_grid_destroy(&copy);
        copy.hgrid = NULL;
    }
    iso_strokes_close(&strokes);
    *grid = copy.hgrid;
    return status;
}
