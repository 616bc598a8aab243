/* mpi_ranks: the processes of an MPI job, of which this one is one. Without MPI there is one rank, and
 * nothing is loaded.
 *
 * MPI is never linked: the functions come from a module (libisopoint-mpi.so, grids/volume/module.h) that is
 * loaded when the program was started by mpirun. Every rank calls the same functions in the same order, from
 * one thread. */
#ifndef ISO_BASE_MPI_RANKS_H
#define ISO_BASE_MPI_RANKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

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
    iso_status *failure;            /* the failure that was agreed on; shared by copies; NULL without MPI */
} iso_ranks;

/* Whether the environment says that MPI has started several processes. */
bool iso_ranks_are_several(void);
/* The number of this rank among those of its node by the environment, before MPI is started; 0 without
 * MPI. */
int iso_ranks_number_on_node(void);

/* Returns the status of the first rank that failed, on all ranks. On the others `error` becomes empty: the
 * first rank tells what happened. From then on nothing is exchanged, and this function and those below return
 * that status at once, until iso_ranks_go_on. */
iso_status iso_ranks_agree(const iso_ranks *ranks, iso_status status, iso_error *error);

/* Forgets a failure that all ranks have agreed on, before the next work that they share. */
void iso_ranks_go_on(const iso_ranks *ranks);

/* These begin with iso_ranks_agree: a rank that fails between them returns to its caller, whose
 * iso_ranks_agree tells the others, so that none waits for it. ISO_ERR_BRIDGE: MPI failed. */
iso_status iso_ranks_sum(const iso_ranks *ranks, uint64_t *values, int count, iso_error *error);
iso_status iso_ranks_most(const iso_ranks *ranks, int32_t *values, int count, iso_error *error);
iso_status iso_ranks_least(const iso_ranks *ranks, double *values, int count, iso_error *error);
iso_status iso_ranks_least_keys(const iso_ranks *ranks, uint64_t *keys, size_t count, iso_error *error);
/* Sets *first to the index of the first of `count` numbers that is not the same on all ranks; `count`: all
 * are. The result is the same on all ranks. */
iso_status iso_ranks_compare(const iso_ranks *ranks, const uint64_t *numbers, int count, int *first,
                             iso_error *error);

#endif
