/* isovalue: a histogram of a grid and the isovalues it suggests. */
#ifndef ISO_EXTRACT_ISOVALUE_ISOVALUE_H
#define ISO_EXTRACT_ISOVALUE_ISOVALUE_H

#include <stddef.h>
#include <stdint.h>

#include "base/mpi_ranks.h"
#include "base/parallel.h"
#include "grids/chunk_source.h"
#include "grids/grid.h"
#include "isopoint.h"

/* Computes the histogram of a grid, without padding. A value is padding if more than half of the voxels on
 * the volume's six faces have it and it is the minimum or the maximum of the data. All voxels with exactly
 * this value are left out, unless all others have a single value (a binary volume keeps both values).
 * ISO_ERR_EMPTY: no voxel is finite. */
iso_status iso_histogram_compute(const iso_grid *grid, iso_pool *pool, iso_histogram *histogram,
                                 iso_error *error);

/* The same by several processes that call it together: each reads a share of the slices only, and the
 * counts are added up. Errors of any process on all of them; ISO_ERR_BRIDGE. */
iso_status iso_histogram_compute_together(const iso_grid *grid, const iso_ranks *ranks, iso_pool *pool,
                                          iso_histogram *histogram, iso_error *error);

/* The same of a volume that is not in memory: each process reads a share of its chunks (`side`:
 * iso_chunk_source_visit), once for integers, up to four times for floats. Errors of reading too. */
iso_status iso_histogram_of_source(const iso_chunk_source *source, int side, const iso_ranks *ranks,
                                   iso_pool *pool, iso_histogram *histogram, iso_error *error);

/* The mean and the standard deviation (physical; of the population) of all finite voxels, padding too, as
 * levels of maps are stated. Stored values are taken as whole multiples of 2^-32 of their range and added as
 * integers: the same bits in any order. `source`: as iso_histogram_of_source, of a volume that `grid` does
 * not hold; NULL: it is in memory. Called by all processes together. ISO_ERR_EMPTY: no voxel is finite. */
typedef struct iso_moments {
    double mean, deviation;
} iso_moments;
iso_status iso_moments_compute(const iso_grid *grid, const iso_chunk_source *source, int side,
                               const iso_ranks *ranks, iso_pool *pool, iso_moments *moments,
                               iso_error *error);

/* Suggests isovalues (physical), best first: 0 for level sets; otherwise Otsu's threshold (1979), then the
 * two thresholds of three-class Otsu (Liao, Chen and Chung 2001). Returns how many there are (1 .. 3), 0
 * for a constant volume. */
size_t iso_isovalue_suggest(const iso_grid *grid, const iso_histogram *histogram,
                            double candidates[ISO_ISOVALUE_CANDIDATES]);

/* ISO_ERR_EMPTY when a physical isovalue (mm) lies beyond the narrow band of a level set (an hgrid), which
 * stores no distances there; the message says how wide the band is. Other grids pass. */
iso_status iso_isovalue_check(const iso_grid *grid, double isovalue, iso_error *error);

#endif
