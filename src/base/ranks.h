/* ranks: the processes of an MPI job, of which this one is one. Without MPI there is one rank, and nothing
 * is loaded.
 *
 * MPI is never linked: the functions come from a module (libisopoint-mpi.so, grids/volume/module.h) that is
 * loaded when the program was started by mpirun. Every rank calls the same functions in the same order,
 * from one thread. */
#ifndef ISO_BASE_RANKS_H
#define ISO_BASE_RANKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the module does by MPI; all return 0 when done. */
typedef struct iso_message_passing {
    int (*start)(int *rank, int *size);
    int (*finish)(void);
    /* Results are on all ranks, in place of the values. */
    int (*sum)(uint64_t *values, int count);
    int (*most)(int32_t *values, int count);
    int (*least)(double *values, int count);
    /* The smallest of each of `count` keys over all ranks; the result is on rank 0. */
    int (*least_keys)(uint64_t *keys, size_t count);
} iso_message_passing;

typedef struct iso_ranks {
    int rank, size;                 /* 0 and 1 without MPI */
    const iso_message_passing *mpi; /* NULL: without */
} iso_ranks;

/* Whether the environment says that MPI has started several processes. */
bool iso_ranks_are_several(void);
/* The number of this rank by the environment, before MPI is started; 0 without MPI. */
int iso_ranks_number(void);

/* Returns the status of the first rank that failed, on all ranks. On the others `error` becomes empty: the
 * first rank tells what happened. Call it before the functions below, so that no rank waits for one that
 * has failed. */
iso_status iso_ranks_agree(const iso_ranks *ranks, iso_status status, iso_error *error);

/* ISO_ERR_BRIDGE: MPI failed. */
iso_status iso_ranks_sum(const iso_ranks *ranks, uint64_t *values, int count, iso_error *error);
iso_status iso_ranks_most(const iso_ranks *ranks, int32_t *values, int count, iso_error *error);
iso_status iso_ranks_least(const iso_ranks *ranks, double *values, int count, iso_error *error);
iso_status iso_ranks_least_keys(const iso_ranks *ranks, uint64_t *keys, size_t count, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
