/* strokes: strokes that are recorded while there is no field yet that they could change. World positions, as
 * the session takes them. */
#ifndef ISO_APPS_ISOSCULPT_STROKES_H
#define ISO_APPS_ISOSCULPT_STROKES_H

#include <stddef.h>

#include "sculpt/brush/brush.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct isosculpt_stroke {
    iso_brush brush;
    iso_sample *samples;
    size_t count, room;
} isosculpt_stroke;

/* Zero-initialise. */
typedef struct isosculpt_strokes {
    isosculpt_stroke *strokes;
    size_t count, room;
} isosculpt_strokes;

/* A new stroke with its first sample. ISO_ERR_NOMEM: then there is none. */
iso_status isosculpt_strokes_begin(isosculpt_strokes *strokes, const iso_brush *brush,
                                   const iso_sample *sample, iso_error *error);
/* One more sample of the last stroke. ISO_ERR_NOMEM. */
iso_status isosculpt_strokes_add(isosculpt_strokes *strokes, const iso_sample *sample, iso_error *error);
void isosculpt_strokes_drop_last(isosculpt_strokes *strokes); /* none: nothing happens */
void isosculpt_strokes_free(isosculpt_strokes *strokes);

#ifdef __cplusplus
}
#endif
#endif
