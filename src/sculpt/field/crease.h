/* crease: corrects the distances of a level set beside creases.
 *
 * A sampled distance field rounds creases: its zero set cuts the corner between voxels. In the fan of voxels
 * to which the crease is the nearest part of the surface, redistancing yields values between the distance to
 * the intended crease and the distance to the zero set: up to a third of a voxel too small. The positions
 * where the zero set crosses the edges between voxels are known exactly. A voxel cannot be farther from the
 * zero set than from the nearest edge point, nor much nearer, which bounds the distances in the fans.
 * Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_CREASE_H
#define ISO_SCULPT_FIELD_CREASE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "base/memory.h"
#include "base/primitives.h"

/* The window from which the distances of a brick are corrected: the brick and ISO_CREASE_MARGIN voxels on
 * each side. Edges between its voxels begin at ISO_CREASE_EDGES of them along an axis: all but the outermost.
 */
enum {
    ISO_CREASE_MARGIN = 5,
    ISO_CREASE_SIDE = ISO_BRICK + 2 * ISO_CREASE_MARGIN,
    ISO_CREASE_EDGES = ISO_CREASE_SIDE - 2
};

/* Writes to `out` the brick in the middle of `window` (ISO_CREASE_SIDE^3 values in voxels, x fastest) with
 * the distances in fans bounded. Voxels beside the interface keep their values, so the zero set does not
 * move. No value enters or leaves the band. A voxel in a fan with a neighbour at the band's end is kept at
 * least the square root of 3 from the surface, so that extraction makes no foot point of it. In bands wider
 * than 3.6 voxels, values beyond 3.6 stay as they are. *any: false if the window has no crease; `out` is not
 * written then. `room` is working memory, kept for the next call. ISO_ERR_NOMEM. */
iso_status iso_crease_correct(const float *window, float band, iso_buffer *room, float *out, bool *any);

/* Row z * ISO_BRICK + y of the brick in the middle of the window. */
static inline const float *iso_crease_row(const float *window, int row) {
    enum { M = ISO_CREASE_MARGIN, SIDE = ISO_CREASE_SIDE };
    return window + ((row / ISO_BRICK + M) * SIDE + row % ISO_BRICK + M) * SIDE + M;
}

/* ---- the kernel: `room` is for as many edge points as the window has edges; it returns *any */

/* Where the zero set crosses an edge, in 1/1024 voxel from the window's voxel (1, 1, 1). */
typedef struct iso_crease_point {
    int32_t at[3];
} iso_crease_point;
typedef bool iso_bound_creases_fn(const float *window, float band, iso_crease_point *room, float *out);
ISO_KERNEL_UNITS(iso_bound_creases_fn, iso_bound_creases);

#endif
