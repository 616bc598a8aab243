/* recorded_strokes: strokes that are recorded while a volume is still being converted into a field, to be
 * applied when the field is there. World positions, as sessions take them. */
#ifndef ISO_APPS_ISOSCULPT_RECORDED_STROKES_H
#define ISO_APPS_ISOSCULPT_RECORDED_STROKES_H

#include <stddef.h>

#include "base/c_linkage.h"
#include "sculpt/brush/brush.h"

ISO_C_BEGIN

typedef struct isosculpt_stroke {
    iso_brush brush;
    iso_sample *samples; /* owned */
    size_t count, room;
} isosculpt_stroke;

/* Zero-initialise; isosculpt_strokes_free. */
typedef struct isosculpt_strokes {
    isosculpt_stroke *strokes;
    size_t count, room;
} isosculpt_strokes;

/* Appends a stroke with its first sample. ISO_ERR_NOMEM: nothing is appended. */
iso_status isosculpt_strokes_begin(isosculpt_strokes *strokes, const iso_brush *brush,
                                   const iso_sample *sample, iso_error *error);
/* Appends a sample to the last stroke; there is one. ISO_ERR_NOMEM. */
iso_status isosculpt_strokes_add(isosculpt_strokes *strokes, const iso_sample *sample, iso_error *error);
void isosculpt_strokes_remove_last(isosculpt_strokes *strokes); /* does nothing when there is none */
void isosculpt_strokes_free(isosculpt_strokes *strokes);

ISO_C_END
#endif
