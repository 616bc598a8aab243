/* span_bounds: bounds of every span, and whether the surface is closed, so that a renderer can skip spans
 * that are hidden. Only the bounds of spans that changed are computed again. Internal to extract. */
#ifndef ISO_EXTRACT_SPAN_BOUNDS_H
#define ISO_EXTRACT_SPAN_BOUNDS_H

#include "base/primitives.h"
#include "grids/brick_set.h"

/* The bounds of the spans of one brick set. Initialise with zeros; free with iso_span_bounds_free. */
typedef struct iso_span_bounds {
    iso_buffer bounds;  /* iso_point_bounds of each span */
    iso_buffer bounded; /* for each span, the version that its bounds are for (bounded_span) */
    bool whole;         /* the last update of the set succeeded: the set holds the whole surface */
    bool known, closed; /* the bounds are up to date; the surface has no border */
} iso_span_bounds;

/* Marks the bounds as out of date: they are unknown until iso_span_bounds_update. Call it after every update
 * of the brick set. whole: that update succeeded. */
void iso_span_bounds_forget(iso_span_bounds *bounds, bool whole);

/* Callback: computes the bounds of span number `span`. Called from several threads. */
typedef void iso_span_bounds_find(const void *context, size_t span, iso_point_bounds *bounds);

/* Computes the bounds of the set's spans that have changed, by calling `find`. ISO_ERR_NOMEM. */
iso_status iso_span_bounds_update(iso_span_bounds *bounds, const iso_brick_set *set,
                                  iso_span_bounds_find *find, const void *context, iso_error *error);

/* The bounds of all spans, borrowed; NULL when they are unknown. */
const iso_point_bounds *iso_span_bounds_of(const iso_span_bounds *bounds);

void iso_span_bounds_free(iso_span_bounds *bounds);

#endif
