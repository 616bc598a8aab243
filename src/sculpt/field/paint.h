/* paint: the colours of the voxels of a field near its surface; the items (cell_items.h) are iso_paint_item.
 * Only cells with a painted voxel have memory for colours. A colour is a word of four bytes, red in the
 * lowest: RGB, and how much of the surface's own colour it covers (255: all of it). Where nothing is painted
 * the word is 0; voxels whose distance is clamped have no paint.
 *
 * Colours are mixed in integers, so that they are the same on every machine, and mirrored where the field is.
 */
#ifndef ISO_SCULPT_FIELD_PAINT_H
#define ISO_SCULPT_FIELD_PAINT_H

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/primitives.h"
#include "sculpt/field/cell_items.h"

ISO_C_BEGIN

typedef struct iso_paint_item {
    uint32_t voxel[ISO_BRICK_VOXELS];
} iso_paint_item;

/* Weights that are whole: ISO_PAINT_ONE is all. */
enum { ISO_PAINT_ONE = 1 << 16 };

static inline uint32_t iso_paint_make(unsigned r, unsigned g, unsigned b, unsigned amount) {
    return amount ? r | g << 8 | b << 16 | amount << 24 : 0;
}
static inline unsigned iso_paint_amount(uint32_t color) {
    return color >> 24;
}

/* Lays `weight` (0 .. ISO_PAINT_ONE) of a colour, whose own amount is 255, over a voxel's colour. The result
 * comes nearer to the colour by at least 1 for every weight that counts, so that many thin layers cover.
 * brush 0: takes paint away instead. */
uint32_t iso_paint_over(uint32_t color, uint32_t brush, int weight);

/* The mean of colours, each weighted by its amount. */
uint32_t iso_paint_mean(const uint32_t *colors, int count);

/* Interpolates linearly between the corners of a voxel cube, x fastest; part: the position between them, 0 ..
 * ISO_PAINT_ONE. Colours are weighted by their amounts. */
uint32_t iso_paint_mix(const uint32_t corners[8], const uint32_t part[3]);

/* Where the colours of a field are looked up: its items, and how many cells it has along each axis. */
typedef struct iso_paint_view {
    const iso_cell_items *paint;
    int cells[3];
} iso_paint_view;

/* The colour of a voxel; 0 outside of the grid. */
uint32_t iso_paint_voxel(const iso_paint_view *view, const int at[3]);
/* The colour at a place between voxels, in index coordinates (iso_paint_mix). */
uint32_t iso_paint_at(const iso_paint_view *view, iso_vec3 place);

/* Paint that was read from a file. Where the file has none, the view's items are NULL. */
typedef struct iso_paint_file {
    iso_paint_view view;
    iso_affine affine; /* of its voxels */
    iso_rgb own;       /* the colour of voxels that have none */
} iso_paint_file;

struct iso_volume_opts;
/* Reads the colours of a .vdb file, its grid "Cd", as paint. *paint is overwritten, for iso_cell_items_free,
 * and borrowed by the view of *file. Errors: those of iso_level_set_read_colors. */
iso_status iso_paint_read(const char *path, const struct iso_volume_opts *opts, iso_cell_items *paint,
                          iso_paint_file *file, iso_error *error);

ISO_C_END
#endif
