/* The module libisopoint-mpi.so: the functions of iso_message_passing (base/mpi_ranks.h) by MPI. */
#include <mpi.h>

#include "grids/volume/module.h"

/* Keys are reduced in pieces, so that MPI needs little memory beside them: 8 MiB. */
enum { PIECE = 1 << 20 };

static int start(int *rank, int *size) {
    int code = MPI_Init(NULL, NULL);
    if (code == MPI_SUCCESS) code = MPI_Comm_rank(MPI_COMM_WORLD, rank);
    if (code == MPI_SUCCESS) code = MPI_Comm_size(MPI_COMM_WORLD, size);
    return code;
}

static int sum(uint64_t *values, int count) {
    return MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
}

static int most(int32_t *values, int count) {
    return MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_INT32_T, MPI_MAX, MPI_COMM_WORLD);
}

static int least(double *values, int count) {
    return MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
}

static int least_keys(uint64_t *keys, size_t count) {
    int rank, code = MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    for (size_t done = 0; done < count && code == MPI_SUCCESS; done += PIECE) {
        const int now = count - done < PIECE ? (int)(count - done) : PIECE;
        uint64_t *piece = keys + done;
        code = MPI_Reduce(rank ? piece : MPI_IN_PLACE, rank ? NULL : piece, now, MPI_UINT64_T, MPI_MIN, 0,
                          MPI_COMM_WORLD);
    }
    return code;
}

static const iso_message_passing messages = {start, MPI_Finalize, sum, most, least, least_keys};

extern const iso_module iso_module_table;
const iso_module iso_module_table = {.abi = ISO_MODULE_ABI, .version = ISO_VERSION, .messages = &messages};
