/* streamlines: lines that follow the direction of a vector field everywhere. */
#ifndef ISO_EXTRACT_VECTORS_STREAMLINES_H
#define ISO_EXTRACT_VECTORS_STREAMLINES_H

#include "base/c_linkage.h"
#include "base/lines.h"
#include "grids/vectors.h"

ISO_C_BEGIN

/* Options. Zero means the default, except for `count`. */
typedef struct iso_streamlines_opts {
    int count;           /* number of lines to make */
    uint64_t seed;       /* seed of the random positions where lines begin; any number */
    double step;         /* distance between vertices, mm; 0: a quarter of the smallest spacing */
    double length;       /* largest length of a line on each side of its seed, mm; 0: the diagonal of the
                            volume */
    double slowest;      /* lines begin and end where vectors are shorter than this; 0: a thousandth of the
                            longest vector */
    bool axial;          /* vectors have no sign (iso_vectors_sample) */
    uint64_t max_memory; /* limit in bytes; 0: 80 % of the available memory */
    iso_pool *pool;
} iso_streamlines_opts;

typedef struct iso_streamlines_totals {
    uint64_t tried; /* number of random positions that were tried */
    double step, slowest;
    /* The reasons why lines ended, counted for both ends of each line: they left the volume or reached voxels
     * without a vector; vectors became too short; opts.length was reached. */
    size_t left, slowed, grown;
} iso_streamlines_totals;

/* Follows lines through a grid of vectors, in both directions from their seeds. Seeds are distributed evenly
 * in the volume, at positions with long enough vectors; at most a thousand positions are tried for each line.
 * Vertices are equally spaced; the column "speed" contains the length of the vector at each vertex. The bytes
 * are the same on every machine and for every number of threads. A result without lines is not an error.
 *
 * ISO_ERR_USAGE: the grid contains tensors; ISO_ERR_LIMIT: more memory than opts->max_memory;
 * ISO_ERR_NOMEM. */
iso_status iso_streamlines(const iso_vectors *vectors, const iso_streamlines_opts *opts, iso_lines *lines,
                           iso_streamlines_totals *totals, iso_error *error);

ISO_C_END
#endif
