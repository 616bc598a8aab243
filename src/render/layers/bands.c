/* bands: a band with more fragments than memory has room for is drawn in two halves. */
#include "render/layers/bands.h"

#include <stdatomic.h>

typedef struct bands_draw {
    const iso_layer_bands *bands;
    atomic_bool failed;
} bands_draw;

int iso_layer_band_rows(const iso_strip *strip, int wanted) {
    return (wanted + strip->factor - 1) / strip->factor * strip->factor;
}

static void draw_rows(bands_draw *draw, int worker, size_t band, iso_rows rows) {
    const iso_layer_bands *bands = draw->bands;
    if (atomic_load(&draw->failed)) return;
    const int factor = bands->strip->factor, pixels = (rows.last - rows.first + 1) / factor;
    if (bands->list(bands->context, worker, band, rows, pixels == 1)) {
        bands->use(bands->context, worker, rows);
    } else if (pixels > 1) {
        const int half = rows.first + pixels / 2 * factor;
        draw_rows(draw, worker, band, (iso_rows){rows.first, half - 1});
        draw_rows(draw, worker, band, (iso_rows){half, rows.last});
    } else {
        atomic_store(&draw->failed, true);
    }
}

static void draw_band(void *context, size_t band, int worker) {
    bands_draw *draw = context;
    const int rows = draw->bands->rows, height = draw->bands->strip->view->height, first = (int)band * rows,
              end = first + rows;
    draw_rows(draw, worker, band, (iso_rows){first, (end < height ? end : height) - 1});
}

iso_status iso_layer_bands_draw(const iso_layer_bands *bands, iso_error *error) {
    bands_draw draw = {.bands = bands};
    const int height = bands->strip->view->height;
    iso_parallel_until(bands->pool, (size_t)((height + bands->rows - 1) / bands->rows), draw_band, &draw);
    if (atomic_load(&draw.failed))
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the layers of a picture");
    return ISO_OK;
}
