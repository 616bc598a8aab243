/* stroke_cost: how long the samples of a stroke file take: the edit, what is extracted again, and a frame.
 * It is table 3 of Baerentzen and Christensen 2003 with real strokes in place of random cells. */
#ifndef ISO_COMPARE_STROKE_COST_H
#define ISO_COMPARE_STROKE_COST_H

#include "compare/cost.h"
#include "source/strokes.h"

/* Medians, in seconds. */
typedef struct iso_stroke_cost {
    size_t strokes, samples, frames; /* number of strokes and samples, and of samples that were drawn */
    double edit;                     /* of a sample: editing the field */
    struct {
        double update; /* extracting what the sample changed */
        double frame;  /* a frame after it */
    } rows[ISO_COST_METHODS];
} iso_stroke_cost;

/* Plays a stroke file from its beginning; `ball` (iso_study_bound) is where its last state lies, `side` the
 * pictures' width and height in pixels. At most 50 samples, evenly chosen, are drawn. `how` as for
 * iso_strokes_open; only the colours of the look are used. Errors: those of iso_strokes_open and _next, of
 * extraction and of drawing; ISO_ERR_EMPTY: the file has no sample; ISO_ERR_NOMEM. */
iso_status iso_study_strokes(const char *path, const iso_source *how, const iso_study_ball *ball, int side,
                             const iso_study_look *look, iso_stroke_cost *cost, iso_error *error);

#endif
