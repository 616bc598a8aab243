/* ranks: MPI by its module, and results of chunks over all ranks. Minima of boxes and ranges are exact, so
 * the picture does not depend on the number of ranks. */
#include "apps/isorender/ranks.h"

#include "base/memory.h"
#include "grids/volume/module.h"

enum { PIECE = 1 << 15 }; /* blocks whose ranges are exchanged at a time */

iso_status isorender_ranks_start(iso_ranks *ranks, iso_error *error) {
    const iso_module *module = NULL;
    *ranks = (iso_ranks){.size = 1};
    if (!iso_ranks_are_several()) return ISO_OK;
    ISO_TRY(iso_module_load("mpirun", "mpi", "MPI", &module, error));
    if (module->messages->start(&ranks->rank, &ranks->size))
        return iso_fail(error, ISO_ERR_BRIDGE, "MPI cannot be started");
    ranks->mpi = module->messages;
    return ISO_OK;
}

void isorender_ranks_finish(iso_ranks *ranks) {
    if (ranks->mpi) ranks->mpi->finish();
    *ranks = (iso_ranks){.size = 1};
}

/* ---- ranges of blocks */

typedef struct range_exchange {
    double lo[PIECE], hi[PIECE]; /* hi: negated */
    uint64_t bricks[PIECE], nonfinite[PIECE];
} range_exchange;

static iso_status exchange_piece(const iso_ranks *ranks, iso_block_ranges *ranges, size_t first,
                                 range_exchange *piece, iso_error *error) {
    const size_t left = ranges->count - first, count = left < PIECE ? left : PIECE;
    for (size_t i = 0; i < count; i++) {
        piece->lo[i] = (double)ranges->lo[first + i];
        piece->hi[i] = -(double)ranges->hi[first + i];
    }
    iso_block_ranges_counts(ranges, first, count, piece->bricks, piece->nonfinite);
    ISO_TRY(iso_ranks_least(ranks, piece->lo, (int)count, error));
    ISO_TRY(iso_ranks_least(ranks, piece->hi, (int)count, error));
    ISO_TRY(iso_ranks_sum(ranks, piece->bricks, (int)count, error));
    ISO_TRY(iso_ranks_sum(ranks, piece->nonfinite, (int)count, error));
    for (size_t i = 0; i < count; i++) {
        ranges->lo[first + i] = (float)piece->lo[i];
        ranges->hi[first + i] = (float)-piece->hi[i];
    }
    iso_block_ranges_set_counts(ranges, first, count, piece->bricks, piece->nonfinite);
    return ISO_OK;
}

iso_status isorender_ranks_ranges(const iso_ranks *ranks, iso_block_ranges *ranges, iso_error *error) {
    if (!ranks->mpi) return ISO_OK;
    range_exchange *piece = iso_alloc(sizeof *piece);
    iso_status status = piece ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for ranges");
    status = iso_ranks_agree(ranks, status, error);
    for (size_t first = 0; first < ranges->count && status == ISO_OK; first += PIECE)
        status = exchange_piece(ranks, ranges, first, piece, error);
    iso_free(piece);
    return status;
}

/* ---- boxes and surveys */

iso_status isorender_ranks_bounds(const iso_ranks *ranks, iso_chunk_bounds *bounds, iso_error *error) {
    for (int i = 0; i < bounds->count; i++) {
        iso_box *box = &bounds->boxes[i];
        double numbers[6] = {box->lo.x, box->lo.y, box->lo.z, -box->hi.x, -box->hi.y, -box->hi.z};
        ISO_TRY(iso_ranks_least(ranks, numbers, 6, error));
        *box = (iso_box){{numbers[0], numbers[1], numbers[2]}, {-numbers[3], -numbers[4], -numbers[5]}};
    }
    return iso_ranks_sum(ranks, &bounds->primitives, 1, error);
}

iso_status isorender_ranks_survey(const iso_ranks *ranks, iso_pullpush_survey *survey, iso_error *error) {
    double numbers[ISO_SURVEY_NUMBERS];
    iso_pullpush_survey_put(survey, numbers);
    ISO_TRY(iso_ranks_least(ranks, numbers, ISO_SURVEY_NUMBERS, error));
    *survey = iso_pullpush_survey_get(numbers);
    return ISO_OK;
}

iso_status isorender_ranks_memory(const iso_ranks *ranks, double bytes[3], iso_error *error) {
    uint64_t peak = iso_memory_peak();
    double ends[2] = {(double)peak, -(double)peak};
    ISO_TRY(iso_ranks_least(ranks, ends, 2, error));
    ISO_TRY(iso_ranks_sum(ranks, &peak, 1, error));
    bytes[0] = ends[0];
    bytes[1] = (double)peak / ranks->size;
    bytes[2] = -ends[1];
    return ISO_OK;
}
