/* Recorded strokes: arrays that double when they are full. */
#include "apps/isosculpt/recorded_strokes.h"

#include <stdlib.h>

/* Makes room for one more element of `size` bytes; NULL: no memory, and the array is unchanged. */
static void *grow_array(void *array, size_t count, size_t *room, size_t size) {
    if (count < *room) return array;
    const size_t doubled = *room ? 2 * *room : 16;
    void *larger = realloc(array, doubled * size);
    if (larger) *room = doubled;
    return larger;
}

iso_status isosculpt_strokes_add(isosculpt_strokes *strokes, const iso_sample *sample, iso_error *error) {
    isosculpt_stroke *stroke = &strokes->strokes[strokes->count - 1];
    iso_sample *samples = grow_array(stroke->samples, stroke->count, &stroke->room, sizeof *samples);
    if (!samples) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stroke that waits");
    stroke->samples = samples;
    samples[stroke->count++] = *sample;
    return ISO_OK;
}

iso_status isosculpt_strokes_begin(isosculpt_strokes *strokes, const iso_brush *brush,
                                   const iso_sample *sample, iso_error *error) {
    isosculpt_stroke *array = grow_array(strokes->strokes, strokes->count, &strokes->room, sizeof *array);
    if (!array) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stroke that waits");
    strokes->strokes = array;
    array[strokes->count++] = (isosculpt_stroke){.brush = *brush};
    iso_status status = isosculpt_strokes_add(strokes, sample, error);
    if (status != ISO_OK) isosculpt_strokes_remove_last(strokes);
    return status;
}

void isosculpt_strokes_remove_last(isosculpt_strokes *strokes) {
    if (strokes->count) free(strokes->strokes[--strokes->count].samples);
}

void isosculpt_strokes_free(isosculpt_strokes *strokes) {
    while (strokes->count) isosculpt_strokes_remove_last(strokes);
    free(strokes->strokes);
    *strokes = (isosculpt_strokes){0};
}
