/* ranks: results over all ranks, and agreement about failures. */
#include "base/ranks.h"

#include <stdlib.h>

bool iso_ranks_are_several(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *size = getenv(names[i]);
        if (size && atoi(size) > 1) return true;
    }
    return false;
}

int iso_ranks_number(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "MV2_COMM_WORLD_RANK"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *rank = getenv(names[i]);
        if (rank) return atoi(rank);
    }
    return 0;
}

static iso_status check(int code, iso_error *error) {
    return code ? iso_fail(error, ISO_ERR_BRIDGE, "MPI failed (code %d)", code) : ISO_OK;
}

iso_status iso_ranks_agree(const iso_ranks *ranks, iso_status status, iso_error *error) {
    if (!ranks->mpi) return status;
    /* The greatest number is that of the lowest rank that can say why it failed. A failure that was agreed
     * on before has no text any more on the other ranks. */
    const bool can_say = status != ISO_OK && error && error->text[0];
    int32_t first = can_say ? (ranks->size - ranks->rank) * 256 + (int32_t)status : (int32_t)status;
    ISO_TRY(check(ranks->mpi->most(&first, 1), error));
    if (!first) return ISO_OK;
    if (ranks->size - first / 256 != ranks->rank && error)
        *error = (iso_error){.status = (iso_status)(first % 256)};
    return (iso_status)(first % 256);
}

iso_status iso_ranks_sum(const iso_ranks *ranks, uint64_t *values, int count, iso_error *error) {
    return ranks->mpi ? check(ranks->mpi->sum(values, count), error) : ISO_OK;
}

iso_status iso_ranks_most(const iso_ranks *ranks, int32_t *values, int count, iso_error *error) {
    return ranks->mpi ? check(ranks->mpi->most(values, count), error) : ISO_OK;
}

iso_status iso_ranks_least(const iso_ranks *ranks, double *values, int count, iso_error *error) {
    return ranks->mpi ? check(ranks->mpi->least(values, count), error) : ISO_OK;
}

iso_status iso_ranks_least_keys(const iso_ranks *ranks, uint64_t *keys, size_t count, iso_error *error) {
    return ranks->mpi ? check(ranks->mpi->least_keys(keys, count), error) : ISO_OK;
}
