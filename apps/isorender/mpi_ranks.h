/* mpi_ranks: what isorender exchanges between the processes of mpirun, each of which draws a share of the
 * chunks, and what must be the same on all of them. */
#ifndef ISO_APPS_ISORENDER_MPI_RANKS_H
#define ISO_APPS_ISORENDER_MPI_RANKS_H

#include "apps/isorender/isorender.h"
#include "base/mpi_ranks.h"
#include "scene/point_chunks.h"

/* Starts MPI if mpirun has started several processes; else there is one rank. ISO_ERR_UNSUPPORTED: the
 * module is not installed; ISO_ERR_BRIDGE. isorender_ranks_finish when done, also after a failure. */
iso_status isorender_ranks_start(iso_ranks *ranks, iso_error *error);
void isorender_ranks_finish(iso_ranks *ranks);

/* Compares the command lines of all ranks. ISO_ERR_USAGE: an option that the picture or the division of the
 * work depends on differs, and the first such option is named. */
iso_status isorender_ranks_check_settings(const isorender_settings *settings, iso_error *error);
/* Sets the memory limit to the smallest of all ranks: chunks depend on it. */
iso_status isorender_ranks_limit_memory(isorender_settings *settings, iso_error *error);
/* Compares the volumes that the ranks have opened. ISO_ERR_FORMAT: they are not the same. */
iso_status isorender_ranks_check_volume(const isorender_job *job, iso_error *error);
/* Compares what the ranks know of the surface: isovalue, bounds and number of primitives. ISO_ERR_FORMAT: an
 * index of one of them tells something else. */
iso_status isorender_ranks_check_surface(const isorender_job *job, const iso_box *index, iso_error *error);

/* Combine what the ranks have found; the results are on all ranks, but those of keys on rank 0.
 * ISO_ERR_BRIDGE, ISO_ERR_NOMEM. */
iso_status isorender_ranks_ranges(const iso_ranks *ranks, iso_block_ranges *ranges, iso_error *error);
iso_status isorender_ranks_bounds(const iso_ranks *ranks, iso_chunk_bounds *bounds, iso_error *error);
iso_status isorender_ranks_survey(const iso_ranks *ranks, iso_pullpush_survey *survey, iso_error *error);

/* Sets bytes[] to the least, the mean and the greatest peak memory of a rank. */
iso_status isorender_ranks_memory(const iso_ranks *ranks, double bytes[3], iso_error *error);

#endif
