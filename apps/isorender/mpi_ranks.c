/* mpi_ranks: MPI by its module, and results of chunks over all ranks. Minima of boxes and ranges are exact,
 * so the picture does not depend on the number of ranks. */
#include "apps/isorender/mpi_ranks.h"

#include <string.h>

#include "base/file_identity.h"
#include "base/memory.h"
#include "grids/volume/module.h"

enum { PIECE = 1 << 15 }; /* blocks whose ranges are exchanged at a time */

iso_status isorender_ranks_start(iso_ranks *ranks, iso_error *error) {
    const iso_module *module = NULL;
    static iso_status failure;
    *ranks = (iso_ranks){.size = 1, .failure = &failure};
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

/* ---- what must be the same on all ranks */

/* Options that each rank may be given in its own way. Of the outputs those of rank 0 are written. */
static bool may_differ(const char *option) {
    static const char *const names[] = {"threads",  "max-memory", "no-index", "quiet",
                                        "progress", "verbose",    "output",   "json"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(option, names[i]) == 0) return true;
    return false;
}

iso_status isorender_ranks_check_settings(const isorender_settings *settings, iso_error *error) {
    const iso_program *program = isorender_program();
    const int options = (int)program->option_count;
    uint64_t numbers[ISORENDER_MOST_OPTIONS + 2];
    int first, count = options + 2;
    for (int i = 0; i < options; i++)
        numbers[i] = may_differ(program->options[i].name) ? 0 : settings->given[i];
    numbers[options] = iso_hash(0, program->version, strlen(program->version));
    numbers[options + 1] = (uint64_t)settings->input_count;
    ISO_TRY(iso_ranks_compare(&settings->ranks, numbers, count, &first, error));
    if (first == count) return ISO_OK;
    if (first < options)
        return iso_fail(error, ISO_ERR_USAGE,
                        "option --%s: the processes of mpirun were given different values",
                        program->options[first].name);
    return iso_fail(error, ISO_ERR_USAGE,
                    first == options ? "the processes of mpirun are different versions of %s"
                                     : "the processes of mpirun were given different numbers of inputs to %s",
                    program->name);
}

iso_status isorender_ranks_limit_memory(isorender_settings *settings, iso_error *error) {
    uint64_t *limit = &settings->common.input.max_memory;
    double least = (double)iso_memory_limit(*limit);
    if (!settings->ranks.mpi) return ISO_OK;
    ISO_TRY(iso_ranks_least(&settings->ranks, &least, 1, error));
    if (least < 0x1p63) *limit = (uint64_t)least;
    return ISO_OK;
}

static uint64_t hash_transform(uint64_t hash, const iso_transform *transform) {
    hash = iso_hash(hash, transform->spacing, sizeof transform->spacing);
    hash = iso_hash(hash, transform->origin, sizeof transform->origin);
    return iso_hash(hash, transform->direction, sizeof transform->direction);
}

iso_status isorender_ranks_check_volume(const isorender_job *job, iso_error *error) {
    enum { SIZE, VOXELS, TRANSFORM, CONTENT, CHUNKS, NUMBERS };
    static const char *const names[] = {"dimensions", "kinds of voxels", "positions", "contents"};
    const iso_loader *loader = &job->loader;
    const iso_rgrid *grid = loader->volume.grid.rgrid;
    const bool is_scene = iso_loader_is_scene(job->plan->input);
    uint64_t numbers[NUMBERS] = {[CHUNKS] = (uint64_t)loader->chunk_side};
    int first;
    if (!job->settings->ranks.mpi) return ISO_OK;
    numbers[SIZE] = iso_hash(0, grid->dims, sizeof grid->dims);
    numbers[SIZE] = iso_hash(numbers[SIZE], loader->crop, sizeof loader->crop);
    const double scale[] = {(double)grid->type, grid->scale, grid->offset};
    numbers[VOXELS] = iso_hash(0, scale, sizeof scale);
    numbers[TRANSFORM] = hash_transform(0, &grid->transform);
    numbers[CONTENT] = is_scene ? iso_hash(0, job->plan->input, strlen(job->plan->input))
                                : iso_file_set_content(job->plan->files);
    ISO_TRY(iso_ranks_compare(&job->settings->ranks, numbers, NUMBERS, &first, error));
    if (first == NUMBERS) return ISO_OK;
    if (first == CHUNKS)
        return iso_fail(error, ISO_ERR_USAGE,
                        "the processes of mpirun chose different chunks: --chunk-size gives them one");
    return iso_fail(error, ISO_ERR_FORMAT, "the processes of mpirun read different volumes: their %s differ",
                    names[first]);
}

iso_status isorender_ranks_check_surface(const isorender_job *job, const iso_box *index, iso_error *error) {
    const isorender_surface *surface = &job->surfaces[0];
    uint64_t numbers[] = {iso_hash(0, &surface->scene.isovalue, sizeof surface->scene.isovalue),
                          job->cell_count + job->point_count, iso_hash(0, index, sizeof *index),
                          iso_hash(0, &surface->bounds, sizeof surface->bounds)};
    enum { NUMBERS = sizeof numbers / sizeof *numbers };
    int first;
    ISO_TRY(iso_ranks_compare(&job->settings->ranks, numbers, NUMBERS, &first, error));
    if (first == NUMBERS) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    first ? "the processes of mpirun found different surfaces (is one of their indexes, "
                            "NAME.isoindex, wrong? --no-index reads none)"
                          : "the processes of mpirun chose different isovalues (is one of their indexes, "
                            "NAME.isoindex, wrong? --isovalue gives them one)");
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
