/* streamlines: lines whose direction is everywhere that of a field of vectors. */
#ifndef ISO_EXTRACT_VECTORS_STREAMLINES_H
#define ISO_EXTRACT_VECTORS_STREAMLINES_H

#include "base/lines.h"
#include "grids/vectors.h"

#ifdef __cplusplus
extern "C" {
#endif

/* All zero means the default, but for the number of lines. */
typedef struct iso_streamlines_opts {
    int count;           /* lines that are wanted */
    uint64_t seed;       /* of the places where they begin; any number */
    double step;         /* mm from one vertex to the next; 0: a quarter of the smallest spacing */
    double length;       /* mm that a line may go to each side; 0: the diagonal of the volume */
    double slowest;      /* lines begin and end where vectors are shorter; 0: a thousandth of the longest */
    bool axial;          /* vectors have no sign (iso_vectors_sample) */
    uint64_t max_memory; /* bytes; 0: 80 % of what is available */
    iso_pool *pool;
} iso_streamlines_opts;

typedef struct iso_streamlines_totals {
    uint64_t tried; /* places that were tried as beginnings */
    double step, slowest;
    /* Why lines ended, two ends each: beside the volume or at voxels without a vector; where vectors are
     * short; because of opts.length. */
    size_t left, slowed, grown;
} iso_streamlines_totals;

/* Follows lines through a grid of vectors, in both directions from where they begin: evenly distributed
 * places of the volume, as many as have vectors that are long enough, but no more than a thousand tries for
 * each line. Vertices are equally spaced; the column "speed" has the length of the vector at each. The same
 * bytes for every machine and thread count. No line at all is no error.
 *
 * ISO_ERR_USAGE: the grid holds tensors; ISO_ERR_LIMIT: more memory than opts->max_memory; ISO_ERR_NOMEM. */
iso_status iso_streamlines(const iso_vectors *vectors, const iso_streamlines_opts *opts, iso_lines *lines,
                           iso_streamlines_totals *totals, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
