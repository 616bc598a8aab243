/* time_lapse: a video of how the strokes make a sculpture, and of the sculpture as it turns. */
#ifndef ISO_APPS_ISOSCULPT_TIME_LAPSE_H
#define ISO_APPS_ISOSCULPT_TIME_LAPSE_H

#include "apps/isosculpt/isosculpt.h"
#include "scene/film.h"

/* Everything is borrowed, but for the field. */
typedef struct isosculpt_time_lapse {
    iso_film_opts film;
    const iso_journal_start *start;
    const iso_stroke_list *strokes; /* that are drawn, but for muted ones, in this order */
    iso_hgrid *result;              /* the sculpture, which the pictures have room for */
    iso_hgrid *first;               /* the field that the strokes begin with; owned from the call on */
    iso_cell_items *paint;          /* its paint (iso_session_opts) */
    iso_pool *pool;
} isosculpt_time_lapse;

/* Draws the strokes once more and writes the video. Errors: those of sessions, viewports and films. */
iso_status isosculpt_time_lapse_write(const isosculpt_time_lapse *lapse, iso_error *error);

#endif
