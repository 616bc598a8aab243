/* slots: for every pixel of a band a slot for each group, which keeps the disc with the smallest key
 * (render/groups/groups.h). Drawing a disc is a minimum of 64-bit keys in each pixel that it covers: the
 * order of discs does not matter, so that all threads and GPUs get the same slots. Internal to groups. */
#ifndef ISO_RENDER_GROUPS_SLOTS_H
#define ISO_RENDER_GROUPS_SLOTS_H

#include "render/groups/blend.h"
#include "render/raster/raster.h"

/* The discs of a view and the way they are compared. All pointers are borrowed. */
typedef struct iso_slots {
    const iso_point_view *points;
    const iso_groups *groups;
    const iso_banded_discs *discs;
    int width;             /* pixels of a row */
    double bins;           /* see iso_draw_groups_opts.bins */
    const iso_target *cut; /* hits that its clip cuts away are left out; NULL: nothing is cut */
} iso_slots;

/* The slots of a band of rows: those of pixel (x, y) are keys[((y - rows.first) * width + x) * groups->count
 * ..]. */
typedef struct iso_slots_band {
    const iso_slots *slots;
    iso_rows rows;
    uint64_t *keys;
    const float *limit; /* NULL, or for each pixel of the band the depth behind which discs are not drawn */
} iso_slots_band;

/* Empties the slots of a band. */
void iso_slots_clear(const iso_slots_band *band);
/* Draws disc number `disc`. */
void iso_slots_draw(const iso_slots_band *band, uint32_t disc);
/* Averages the front layer of the pixel whose slots begin at `keys`. x, y: the pixel's centre in pixels from
 * the optical axis. *front is set to the depth of the nearest disc. Returns false if the pixel is empty. */
bool iso_slots_resolve(const iso_slots *slots, const uint64_t *keys, float x, float y, iso_splat_sums *sums,
                       float *front);

#endif
