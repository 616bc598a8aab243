#include "apps/isosculpt/strokes.h"

#include <stdlib.h>

/* Room for one more of `size` bytes; NULL: no memory, and the array is as it was. */
static void *grow(void *array, size_t count, size_t *room, size_t size) {
    if (count < *room) return array;
    const size_t wanted = *room ? 2 * *room : 16;
    void *more = realloc(array, wanted * size);
    if (more) *room = wanted;
    return more;
}

iso_status isosculpt_strokes_add(isosculpt_strokes *strokes, const iso_sample *sample, iso_error *error) {
    isosculpt_stroke *stroke = &strokes->strokes[strokes->count - 1];
    iso_sample *samples = grow(stroke->samples, stroke->count, &stroke->room, sizeof *samples);
    if (!samples) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stroke that waits");
    stroke->samples = samples;
    samples[stroke->count++] = *sample;
    return ISO_OK;
}

iso_status isosculpt_strokes_begin(isosculpt_strokes *strokes, const iso_brush *brush,
                                   const iso_sample *sample, iso_error *error) {
    isosculpt_stroke *more = grow(strokes->strokes, strokes->count, &strokes->room, sizeof *more);
    if (!more) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stroke that waits");
    strokes->strokes = more;
    more[strokes->count++] = (isosculpt_stroke){.brush = *brush};
    iso_status status = isosculpt_strokes_add(strokes, sample, error);
    if (status != ISO_OK) isosculpt_strokes_drop_last(strokes);
    return status;
}

void isosculpt_strokes_drop_last(isosculpt_strokes *strokes) {
    if (strokes->count) free(strokes->strokes[--strokes->count].samples);
}

void isosculpt_strokes_free(isosculpt_strokes *strokes) {
    while (strokes->count) isosculpt_strokes_drop_last(strokes);
    free(strokes->strokes);
    *strokes = (isosculpt_strokes){0};
}
