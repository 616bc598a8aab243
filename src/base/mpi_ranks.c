/* mpi_ranks: results over all ranks, and agreement about failures. */
#include "base/mpi_ranks.h"

#include <stdlib.h>
#include <string.h>

bool iso_ranks_are_several(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *size = getenv(names[i]);
        if (size && atoi(size) > 1) return true;
    }
    return false;
}

int iso_ranks_number_on_node(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_LOCAL_RANK", "MPI_LOCALRANKID",
                                        "MV2_COMM_WORLD_LOCAL_RANK"};
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
    if (*ranks->failure != ISO_OK) return *ranks->failure;
    /* The greatest number is that of the lowest rank that has failed. */
    int32_t first = status != ISO_OK ? (ranks->size - ranks->rank) * 256 + (int32_t)status : 0;
    *ranks->failure = check(ranks->mpi->most(&first, 1), error);
    if (*ranks->failure != ISO_OK || !first) return *ranks->failure;
    *ranks->failure = (iso_status)(first % 256);
    if (ranks->size - first / 256 != ranks->rank && error) *error = (iso_error){.status = *ranks->failure};
    return *ranks->failure;
}

void iso_ranks_go_on(const iso_ranks *ranks) {
    if (ranks->mpi) *ranks->failure = ISO_OK;
}

iso_status iso_ranks_sum(const iso_ranks *ranks, uint64_t *values, int count, iso_error *error) {
    ISO_TRY(iso_ranks_agree(ranks, ISO_OK, error));
    return ranks->mpi ? check(ranks->mpi->sum(values, count), error) : ISO_OK;
}

iso_status iso_ranks_most(const iso_ranks *ranks, int32_t *values, int count, iso_error *error) {
    ISO_TRY(iso_ranks_agree(ranks, ISO_OK, error));
    return ranks->mpi ? check(ranks->mpi->most(values, count), error) : ISO_OK;
}

iso_status iso_ranks_least(const iso_ranks *ranks, double *values, int count, iso_error *error) {
    ISO_TRY(iso_ranks_agree(ranks, ISO_OK, error));
    return ranks->mpi ? check(ranks->mpi->least(values, count), error) : ISO_OK;
}

iso_status iso_ranks_least_keys(const iso_ranks *ranks, uint64_t *keys, size_t count, iso_error *error) {
    ISO_TRY(iso_ranks_agree(ranks, ISO_OK, error));
    return ranks->mpi ? check(ranks->mpi->least_keys(keys, count), error) : ISO_OK;
}

/* A number is the same on all ranks if the least and the greatest of its halves, which doubles hold exactly,
 * are. */
iso_status iso_ranks_compare(const iso_ranks *ranks, const uint64_t *numbers, int count, int *first,
                             iso_error *error) {
    enum { AT_ONCE = 64 };
    double ends[AT_ONCE][4];
    for (int done = 0; done < count && ranks->mpi; done += AT_ONCE) {
        const int now = count - done < AT_ONCE ? count - done : AT_ONCE;
        for (int i = 0; i < now; i++) {
            const double high = (double)(numbers[done + i] >> 32), low = (double)(uint32_t)numbers[done + i];
            memcpy(ends[i], (const double[4]){high, low, -high, -low}, sizeof ends[i]);
        }
        ISO_TRY(iso_ranks_least(ranks, ends[0], 4 * now, error));
        for (int i = 0; i < now; i++) {
            if (ends[i][0] == -ends[i][2] && ends[i][1] == -ends[i][3]) continue;
            *first = done + i;
            return ISO_OK;
        }
    }
    *first = count;
    return ISO_OK;
}
