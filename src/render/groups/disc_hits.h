/* disc_hits: where the rays of a box of pixels meet a disc: iso_disc_intersect for many pixels at once,
 * with the same bits. Internal to groups. */
#ifndef ISO_RENDER_GROUPS_DISC_HITS_H
#define ISO_RENDER_GROUPS_DISC_HITS_H

#include "base/cpu.h"
#include "render/groups/banded_discs.h"

/* The most columns and rows of a box. */
enum { ISO_DISC_COLUMNS = 64, ISO_DISC_ROWS = 16 };

/* The pixels of a box that a disc covers, row by row, and where their rays meet it (iso_disc_hit). There
 * is room for one vector more than the box has pixels. */
typedef struct iso_disc_hits {
    int32_t column[ISO_DISC_COLUMNS * ISO_DISC_ROWS + ISO_LANES_MAX];
    int32_t row[ISO_DISC_COLUMNS * ISO_DISC_ROWS + ISO_LANES_MAX];
    float depth[ISO_DISC_COLUMNS * ISO_DISC_ROWS + ISO_LANES_MAX];
    float e[ISO_DISC_COLUMNS * ISO_DISC_ROWS + ISO_LANES_MAX];
    int32_t away[ISO_DISC_COLUMNS * ISO_DISC_ROWS + ISO_LANES_MAX]; /* 0 or 1 */
} iso_disc_hits;

/* Finds the hits of a box; returns their number. x: the centre of each column of the picture, in pixels
 * from the optical axis; up to a vector behind the box's last one is read. y: of each row of the box. */
typedef int iso_disc_hits_fn(const iso_disc_view *view, const iso_disc *disc, const iso_disc_box *box,
                             const float *x, const float *y, iso_disc_hits *hits);
ISO_KERNEL_UNITS(iso_disc_hits_fn, iso_disc_find_hits);

/* Passes all hits of a disc in the pixels of `within`, box by box, to a function with the caller's
 * context. */
typedef void iso_disc_visit_fn(void *context, const iso_disc_hits *hits, int count);
void iso_disc_visit_hits(const iso_banded_discs *discs, const iso_disc *disc, const iso_disc_box *within,
                         iso_disc_visit_fn *visit, void *context);

#endif
