/* ranks: what isorender exchanges between the processes of mpirun, each of which draws a share of the
 * chunks. */
#ifndef ISO_APPS_ISORENDER_RANKS_H
#define ISO_APPS_ISORENDER_RANKS_H

#include "base/ranks.h"
#include "exact/chunks.h"
#include "render/pullpush/keys.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Starts MPI if mpirun has started several processes; else there is one rank. ISO_ERR_UNSUPPORTED: the
 * module is not installed; ISO_ERR_BRIDGE. isorender_ranks_finish when done, also after a failure. */
iso_status isorender_ranks_start(iso_ranks *ranks, iso_error *error);
void isorender_ranks_finish(iso_ranks *ranks);

/* Combine what the ranks have found; the results are on all ranks, but those of keys on rank 0.
 * ISO_ERR_BRIDGE, ISO_ERR_NOMEM. */
iso_status isorender_ranks_ranges(const iso_ranks *ranks, iso_block_ranges *ranges, iso_error *error);
iso_status isorender_ranks_bounds(const iso_ranks *ranks, iso_chunk_bounds *bounds, iso_error *error);
iso_status isorender_ranks_survey(const iso_ranks *ranks, iso_pullpush_survey *survey, iso_error *error);

/* Sets bytes[] to the least, the mean and the greatest peak memory of a rank. */
iso_status isorender_ranks_memory(const iso_ranks *ranks, double bytes[3], iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
