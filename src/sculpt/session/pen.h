/* pen: turns the samples of a stroke into touches, spaced along the stroke. Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_PEN_H
#define ISO_SCULPT_SESSION_PEN_H

#include "sculpt/brush/brush.h"

typedef struct iso_pen {
    iso_status (*touch)(void *context, const iso_brush *brush, const iso_touch *touch, iso_error *error);
    void *context;
    iso_brush brush;
    iso_sample first, previous; /* the first sample of the stroke, and the sample of its last touch */
} iso_pen;

/* Set down the pen, with the touch of the stroke's first sample, and move it to a further sample, with as
 * many touches as the brush's spacing gives, possibly none. ISO_ERR_USAGE: more than ISO_LIMIT_TOUCHES
 * touches, of which none is made; errors of `touch`. */
iso_status iso_pen_begin(iso_pen *pen, const iso_brush *brush, const iso_sample *sample, iso_error *error);
iso_status iso_pen_move(iso_pen *pen, const iso_sample *sample, iso_error *error);

/* Ends the stroke, whose samples are all of `path`: a tool that acts at its end (iso_tool_is_trim) makes its
 * touch now, and none before. */
iso_status iso_pen_end(iso_pen *pen, const iso_sample *path, size_t count, iso_error *error);

#endif
