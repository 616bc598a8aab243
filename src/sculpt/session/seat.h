/* seat: reseats strokes: their samples follow the surface when an edit of an earlier stroke has moved it from
 * under them. Each sample is moved along its normal by as much as the surface there has moved since the
 * stroke got its samples: between the strokes before it as they were then, and as they are now, those that
 * are reseated with it included. A tool that drags is moved as a whole, by its first sample; a stroke that
 * trims or changes the whole mask, a muted stroke, and a sample without a surface along its normal stay.
 * Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_SEAT_H
#define ISO_SCULPT_SESSION_SEAT_H

#include "sculpt/session/stroke_list.h"
#include "sculpt/session/versions.h"

/* Zero-initialise; iso_seat_free. */
typedef struct iso_seat {
    iso_sample *samples; /* of the log's last entry; borrowed */
    size_t path;         /* iso_stroke.path of strokes that have them */
    iso_buffer parts;    /* the strokes, by number */
    size_t count;
    iso_buffer heights; /* double, by sample: from it to the surface, along its normal, as that was; NAN */
} iso_seat;
void iso_seat_free(iso_seat *seat);

/* Copies the samples of the strokes first to last, by number, to `path` (iso_sample), and counts them. */
iso_status iso_seat_collect(const iso_stroke_list *list, unsigned first, unsigned last, iso_buffer *path,
                            size_t *count, iso_error *error);

/* Measures where the surface was. `log`: its last entry has the samples as collected; `list` is what it
 * resolves to. The versions are afterwards those of another list. Errors: those of iso_versions_update. */
iso_status iso_seat_measure(iso_seat *seat, iso_versions *versions, iso_stroke_log *log,
                            const iso_stroke_list *list, const iso_progress *progress, iso_error *error);

/* iso_versions_visit, with the seat as its context: moves the samples of a stroke. */
iso_status iso_seat_stroke(void *seat, iso_versions *versions, iso_stroke *stroke, iso_error *error);

#endif
