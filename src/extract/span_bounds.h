/* span_bounds: what points and meshes tell a renderer that leaves out what is not to be seen: bounds of every
 * span, and whether the surface is closed. Only spans that changed are looked at again. Internal to extract.
 */
#ifndef ISO_EXTRACT_SPAN_BOUNDS_H
#define ISO_EXTRACT_SPAN_BOUNDS_H

#include "base/primitives.h"
#include "grids/brick_set.h"

/* Zero-initialise. */
typedef struct iso_span_bounds {
    iso_buffer bounds;  /* iso_point_bounds of each span */
    iso_buffer bounded; /* and what they are of */
    bool whole;         /* the last update of the set did everything */
    bool known, closed;
} iso_span_bounds;

/* After an update of the set: nothing is known until iso_span_bounds_update. */
void iso_span_bounds_forget(iso_span_bounds *bounds, bool whole);

/* Bounds of span number `span`; called by several threads. */
typedef void iso_span_bounds_find(const void *context, size_t span, iso_point_bounds *bounds);

/* ISO_ERR_NOMEM. */
iso_status iso_span_bounds_update(iso_span_bounds *bounds, const iso_brick_set *set,
                                  iso_span_bounds_find *find, const void *context, iso_error *error);

/* One for each span, NULL when they are not known. */
const iso_point_bounds *iso_span_bounds_of(const iso_span_bounds *bounds);

void iso_span_bounds_free(iso_span_bounds *bounds);

#endif
