/* isovalue: histograms of grids, and isovalues by the thresholds of Otsu 1979, "A threshold selection
 * method from gray-level histograms", and Liao, Chen and Chung 2001, "A fast algorithm for multilevel
 * thresholding". */
#include "extract/isovalue/isovalue.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "extract/isovalue/histogram_kernel.h"
#include "grids/brick_index.h"
#include "grids/value_counts.h"

/* ---- walking over the voxels */

/* A run of voxels along x: `count` values or, if `values` is NULL, as many times `constant`. */
typedef struct run {
    const void *values;
    float constant;
    size_t count;
    bool in_face;                      /* the whole run lies in a face of the volume */
    bool starts_in_face, ends_in_face; /* the run's first or last voxel lies in a face */
} run;

typedef void run_visitor(void *worker_state, const run *voxels);

static void mark_faces(run *voxels, const int dims[3], int x, int y, int z) {
    voxels->in_face = y == 0 || z == 0 || y == dims[1] - 1 || z == dims[2] - 1;
    voxels->starts_in_face = x == 0;
    voxels->ends_in_face = x + (int)voxels->count == dims[0];
}

static size_t count_on_faces(const run *voxels) {
    if (voxels->in_face) return voxels->count;
    size_t ends = (size_t)voxels->starts_in_face + voxels->ends_in_face;
    return ends < voxels->count ? ends : voxels->count;
}

/* Voxels in memory: a volume, or a chunk of one. */
typedef struct piece {
    iso_grid grid;
    const int *dims;  /* of the volume */
    const int *first; /* the piece's first voxel in it */
    bool constant;    /* all voxels are known to be equal */
} piece;

static void visit_rgrid_slice(const piece *p, int z, run_visitor *visit, void *state) {
    const iso_rgrid *grid = p->grid.rgrid;
    for (int y = 0; y < grid->dims[1]; y++) {
        const ptrdiff_t at = y * grid->stride_y + z * grid->stride_z;
        const char *data = grid->data;
        run row = {.values = p->constant ? NULL : data + at * (ptrdiff_t)iso_type_size(grid->type),
                   .count = (size_t)grid->dims[0]};
        if (p->constant) row.constant = *(const float *)grid->data; /* (runs are of floats) */
        mark_faces(&row, p->dims, p->first[0], p->first[1] + y, p->first[2] + z);
        visit(state, &row);
    }
}

static void visit_hgrid_slice(const iso_hgrid *grid, int z, run_visitor *visit, void *state) {
    for (int y = 0; y < grid->dims[1]; y++)
        for (int cx = 0; cx < grid->cells[0]; cx++) {
            int left = grid->dims[0] - cx * ISO_BRICK;
            run row = {.count = (size_t)(left < ISO_BRICK ? left : ISO_BRICK)};
            int32_t brick = grid->cell[iso_hgrid_cell_index(grid, cx, y / ISO_BRICK, z / ISO_BRICK)];
            if (brick < 0)
                row.constant = iso_hgrid_empty_value(grid, brick);
            else
                row.values =
                    iso_hgrid_brick(grid, brick) + (z % ISO_BRICK * ISO_BRICK + y % ISO_BRICK) * ISO_BRICK;
            mark_faces(&row, grid->dims, cx * ISO_BRICK, y, z);
            visit(state, &row);
        }
}

static void visit_slice(const piece *p, int z, run_visitor *visit, void *state) {
    if (p->grid.hgrid)
        visit_hgrid_slice(p->grid.hgrid, z, visit, state);
    else
        visit_rgrid_slice(p, z, visit, state);
}

/* What is read, and by whom: this process reads the slices first .. end - 1 along z of a grid, or its turn
 * of the chunks of a source, of which `grid` is a description without voxels. */
typedef struct reading {
    const iso_grid *grid;
    iso_pool *pool;
    const iso_ranks *ranks;
    int first, end;
    const iso_chunk_source *source; /* NULL: the grid is in memory */
    int side;                       /* of the source's chunks */
} reading;

static reading reading_of(const iso_grid *grid, const iso_ranks *ranks, iso_pool *pool) {
    const int64_t slices = iso_grid_dims(grid)[2];
    return (reading){.grid = grid,
                     .pool = pool,
                     .ranks = ranks,
                     .first = (int)(slices * ranks->rank / ranks->size),
                     .end = (int)(slices * (ranks->rank + 1) / ranks->size)};
}

/* A walk over the voxels: each task is one slice. Every worker has its own state of `state_bytes` bytes;
 * the states are added up afterwards. */
typedef struct walk {
    const reading *what;
    run_visitor *visit;
    char *states;
    size_t state_bytes;
    piece piece;
    int first; /* the piece's first slice that is read */
} walk;

static void walk_slice(void *context, size_t slice, int worker) {
    const walk *job = context;
    visit_slice(&job->piece, job->first + (int)slice, job->visit,
                job->states + (size_t)worker * job->state_bytes);
}

static iso_status walk_chunk(void *context, const iso_rgrid *grid, const int first[3], bool constant,
                             iso_error *error) {
    walk *job = context;
    (void)error;
    job->piece.constant = constant;
    job->piece.grid.rgrid = (iso_rgrid *)(uintptr_t)grid;
    job->piece.first = first;
    iso_parallel_for(job->what->pool, (size_t)grid->dims[2], walk_slice, job);
    return ISO_OK;
}

/* Calls `visit` for the chunks of a source that this process reads. */
static iso_status visit_chunks(const reading *what, iso_chunk_voxels_visitor *visit, void *context,
                               iso_error *error) {
    const iso_chunk_turns turns = {what->ranks->rank, what->ranks->size};
    return iso_chunk_source_visit(what->source, what->side, turns, what->pool, visit, context, error);
}

static iso_status run_walk(walk *job, iso_error *error) {
    static const int origin[3] = {0, 0, 0};
    const reading *what = job->what;
    job->piece.dims = iso_grid_dims(what->grid);
    if (what->source) return visit_chunks(what, walk_chunk, job, error);
    job->piece.grid = *what->grid;
    job->piece.first = origin;
    job->first = what->first;
    iso_parallel_until(what->pool, (size_t)(what->end - what->first), walk_slice, job);
    return iso_pool_check(what->pool, "the histogram", error);
}

/* ---- integers: every value has a count of its own */

enum { LEVELS = ISO_COUNTED_VALUES };

/* The range of levels that a histogram is made from. */
typedef struct level_range {
    int first, last;
    int padding; /* the level that is padding; -1: none */
} level_range;

static void shrink(const iso_value_counts *counts, level_range *range) {
    while (!counts->all[range->first]) range->first++;
    while (!counts->all[range->last]) range->last--;
}

static level_range range_of_levels(const iso_value_counts *counts) {
    level_range range = {.first = 0, .last = LEVELS - 1, .padding = -1};
    shrink(counts, &range);
    uint64_t faces = 0;
    for (int level = range.first; level <= range.last; level++) faces += counts->faces[level];
    level_range rest = range;
    if (2 * counts->faces[range.first] > faces)
        rest.padding = rest.first++;
    else if (2 * counts->faces[range.last] > faces)
        rest.padding = rest.last--;
    if (rest.padding < 0 || rest.first > rest.last) return range;
    shrink(counts, &rest);
    return rest.first < rest.last ? rest : range;
}

static void fill_from_levels(const iso_rgrid *grid, const iso_value_counts *counts,
                             iso_histogram *histogram) {
    level_range range = range_of_levels(counts);
    int base = grid->type == ISO_INT16 ? LEVELS / 2 : 0;
    int step = (range.last - range.first) / ISO_HISTOGRAM_BINS + 1;
    histogram->low = (range.first - base) * grid->scale + grid->offset;
    histogram->high = (range.last - base) * grid->scale + grid->offset;
    histogram->width = step * grid->scale;
    histogram->minimum = histogram->low;
    histogram->maximum = histogram->high;
    if (range.padding >= 0) {
        histogram->padding_value = (range.padding - base) * grid->scale + grid->offset;
        histogram->padding = counts->all[range.padding];
        if (range.padding < range.first) histogram->minimum = histogram->padding_value;
        if (range.padding > range.last) histogram->maximum = histogram->padding_value;
    }
    for (int level = range.first; level <= range.last; level++) {
        histogram->bins[(level - range.first) / step] += counts->all[level];
        histogram->counted += counts->all[level];
    }
}

/* The counting of a source's chunks. */
typedef struct chunk_counting {
    iso_value_counter *counter;
    iso_pool *pool;
    const iso_rgrid *grid;
    const int *first;
} chunk_counting;

static void count_chunk_slice(void *context, size_t z, int worker) {
    const chunk_counting *c = context;
    const int *dims = c->grid->dims, *first = c->first;
    const int lo[3] = {first[0], first[1], first[2] + (int)z},
              hi[3] = {first[0] + dims[0], first[1] + dims[1], lo[2] + 1};
    iso_value_counter_add(c->counter, worker, lo, hi, 0);
}

static iso_status count_chunk(void *context, const iso_rgrid *grid, const int first[3], bool constant,
                              iso_error *error) {
    chunk_counting *c = context;
    (void)error;
    c->grid = grid;
    c->first = first;
    iso_value_counter_set_window(c->counter, grid, first);
    if (constant) {
        const int end[3] = {first[0] + grid->dims[0], first[1] + grid->dims[1], first[2] + grid->dims[2]};
        iso_value_counter_add_constant(c->counter, 0, first, end);
        return ISO_OK;
    }
    iso_parallel_for(c->pool, (size_t)grid->dims[2], count_chunk_slice, c);
    return ISO_OK;
}

static iso_status count_source(const reading *what, iso_value_counts **counts, iso_error *error) {
    chunk_counting c = {.pool = what->pool};
    ISO_TRY(iso_value_counter_create(what->grid->rgrid, iso_pool_threads(what->pool), &c.counter, error));
    const iso_status status = visit_chunks(what, count_chunk, &c, error);
    if (status == ISO_OK)
        *counts = iso_value_counter_finish(c.counter);
    else
        iso_value_counter_destroy(c.counter);
    return status;
}

/* Counts what this process reads, and adds the counts of the others. */
static iso_status count_values(const reading *what, iso_value_counts **counts, iso_error *error) {
    const iso_ranks *ranks = what->ranks;
    const iso_status status = what->source ? count_source(what, counts, error)
                                           : iso_value_counts_create(what->grid->rgrid, what->first,
                                                                     what->end, what->pool, counts, error);
    ISO_TRY(iso_ranks_agree(ranks, status, error));
    ISO_TRY(iso_ranks_sum(ranks, (*counts)->all, LEVELS, error));
    return iso_ranks_sum(ranks, (*counts)->faces, LEVELS, error);
}

static iso_status integer_histogram(const reading *what, iso_histogram *histogram, iso_error *error) {
    const iso_rgrid *grid = what->grid->rgrid;
    const iso_value_counts *known =
        !what->source && what->ranks->size == 1 ? iso_brick_index_counts(grid) : NULL;
    iso_value_counts *made = NULL;
    const iso_status status = known ? ISO_OK : count_values(what, &made, error);
    if (status == ISO_OK) fill_from_levels(grid, known ? known : made, histogram);
    iso_free(made);
    return status;
}

/* ---- floats: the range first, then what may be padding, then the bins */

/* The range of the finite voxels, in stored values. */
typedef struct float_range {
    float low, high; /* of finite voxels */
    uint64_t finite, nonfinite;
} float_range;

static const float_range no_range = {.low = INFINITY, .high = -INFINITY};

static void merge_range(float_range *sum, const float_range *part) {
    sum->low = part->low < sum->low ? part->low : sum->low;
    sum->high = part->high > sum->high ? part->high : sum->high;
    sum->finite += part->finite;
    sum->nonfinite += part->nonfinite;
}

static const iso_histogram_kernels *kernels(void) {
    return ISO_KERNEL_UNIT(iso_histogram_kernels, iso_cpu_best());
}

/* The values of a run and their number; one value for a run of equal voxels. Each of them counts `*each`
 * times. */
static const float *floats_of(const run *voxels, int *count, uint64_t *each) {
    *count = voxels->values ? (int)voxels->count : 1;
    *each = voxels->values ? 1 : voxels->count;
    return voxels->values ? voxels->values : &voxels->constant;
}

static void find_range(void *state, const run *voxels) {
    iso_row_range row;
    int count;
    uint64_t each;
    const float *values = floats_of(voxels, &count, &each);
    kernels()->range(values, count, &row);
    const float_range found = {row.lowest, row.highest, (uint64_t)row.finite * each,
                               (uint64_t)(count - row.finite) * each};
    merge_range(state, &found);
}

/* Counts of the voxels on the volume's faces: all of them, and those with the lowest and the highest
 * value. */
typedef struct face_counts {
    float low, high;
    uint64_t all, at_low, at_high;
} face_counts;

static void count_face_voxel(face_counts *counts, float value, uint64_t count) {
    counts->all += count;
    counts->at_low += value == counts->low ? count : 0;
    counts->at_high += value == counts->high ? count : 0;
}

static void find_faces(void *state, const run *voxels) {
    if (!voxels->values) {
        count_face_voxel(state, voxels->constant, count_on_faces(voxels));
        return;
    }
    const float *values = voxels->values;
    const size_t count = voxels->count;
    if (voxels->in_face) {
        for (size_t i = 0; i < count; i++) count_face_voxel(state, values[i], 1);
        return;
    }
    if (voxels->starts_in_face) count_face_voxel(state, values[0], 1);
    if (voxels->ends_in_face && !(voxels->starts_in_face && count == 1))
        count_face_voxel(state, values[count - 1], 1);
}

/* The volume's lowest and highest value, the one of them that may be padding, how often it occurs
 * (`count`), and the values next to the lowest and the highest. */
typedef struct padding_counts {
    float low, high, padding;
    float above_low, below_high;
    uint64_t count;
} padding_counts;

static void find_padding(void *state, const run *voxels) {
    padding_counts *counts = state;
    iso_row_padding row = {.low = counts->low, .high = counts->high, .padding = counts->padding};
    int count;
    uint64_t each;
    const float *values = floats_of(voxels, &count, &each);
    kernels()->padding(values, count, &row);
    counts->count += (uint64_t)row.count * each;
    counts->above_low = fminf(counts->above_low, row.above_low);
    counts->below_high = fmaxf(counts->below_high, row.below_high);
}

/* The bins of one worker. Consecutive values are counted in different tables, for the reason given at
 * worker_counts in grids/value_counts.c. */
enum { BIN_TABLES = 4, BIN_BLOCK = 256 };
typedef struct bin_counts {
    iso_bin_range range;
    uint64_t bins[BIN_TABLES][ISO_HISTOGRAM_BINS + 1]; /* the last is for ISO_BIN_OUTSIDE */
} bin_counts;

static void count_bins(void *state, const run *voxels) {
    bin_counts *counts = state;
    int count, bins[BIN_BLOCK];
    uint64_t each;
    const float *values = floats_of(voxels, &count, &each);
    for (int first = 0; first < count; first += BIN_BLOCK) {
        const int some = count - first < BIN_BLOCK ? count - first : BIN_BLOCK;
        kernels()->bins(&counts->range, values + first, some, bins);
        for (int i = 0; i < some; i++) counts->bins[i % BIN_TABLES][bins[i]] += each;
    }
}

/* Walks over the voxels that this process reads, with a state for each worker, all of which begin as a copy
 * of `first`. *states: the states afterwards, to be freed by the caller. Fails on all processes or on none.
 */
static iso_status walk_with(const reading *what, run_visitor *visit, const void *first, size_t bytes,
                            char **states, iso_error *error) {
    const size_t workers = (size_t)iso_pool_threads(what->pool);
    *states = iso_alloc_zero(workers, bytes);
    iso_status status = *states ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for a histogram");
    status = iso_ranks_agree(what->ranks, status, error);
    if (status != ISO_OK) {
        iso_free(*states);
        return status;
    }
    for (size_t w = 0; w < workers; w++) memcpy(*states + w * bytes, first, bytes);
    walk job = {.what = what, .visit = visit, .states = *states, .state_bytes = bytes};
    status = iso_ranks_agree(what->ranks, run_walk(&job, error), error);
    if (status != ISO_OK) iso_free(*states);
    return status;
}

/* The range from the index of a dense grid, which has read all voxels already. False: there is no index. */
static bool range_of_index(const iso_grid *grid, iso_pool *pool, float_range *range) {
    const iso_brick_index *index = grid->rgrid ? grid->rgrid->index : NULL;
    if (!index || !iso_brick_index_current(index)) return false;
    double low, high;
    iso_brick_index_extremes(index, &low, &high);
    const int *dims = grid->rgrid->dims;
    const uint64_t voxels = (uint64_t)dims[0] * (uint64_t)dims[1] * (uint64_t)dims[2];
    range->low = (float)low;
    range->high = (float)high;
    range->nonfinite = iso_grid_count_nonfinite(grid, pool);
    range->finite = voxels - range->nonfinite;
    return true;
}

static iso_status measure_range(const reading *what, float_range *range, iso_error *error) {
    char *states;
    if (!what->source && what->ranks->size == 1 && range_of_index(what->grid, what->pool, range))
        return ISO_OK;
    ISO_TRY(walk_with(what, find_range, &no_range, sizeof no_range, &states, error));
    const float_range *found = (const float_range *)states;
    *range = no_range;
    for (int w = 0; w < iso_pool_threads(what->pool); w++) merge_range(range, &found[w]);
    iso_free(states);
    double ends[2] = {(double)range->low, -(double)range->high};
    uint64_t counts[2] = {range->finite, range->nonfinite};
    ISO_TRY(iso_ranks_least(what->ranks, ends, 2, error));
    ISO_TRY(iso_ranks_sum(what->ranks, counts, 2, error));
    *range = (float_range){(float)ends[0], (float)-ends[1], counts[0], counts[1]};
    return ISO_OK;
}

static iso_status measure_faces(const reading *what, const float_range *range, face_counts *faces,
                                iso_error *error) {
    char *states;
    *faces = (face_counts){.low = range->low, .high = range->high};
    ISO_TRY(walk_with(what, find_faces, faces, sizeof *faces, &states, error));
    const face_counts *found = (const face_counts *)states;
    for (int w = 0; w < iso_pool_threads(what->pool); w++) {
        faces->all += found[w].all;
        faces->at_low += found[w].at_low;
        faces->at_high += found[w].at_high;
    }
    iso_free(states);
    uint64_t counts[3] = {faces->all, faces->at_low, faces->at_high};
    ISO_TRY(iso_ranks_sum(what->ranks, counts, 3, error));
    *faces = (face_counts){range->low, range->high, counts[0], counts[1], counts[2]};
    return ISO_OK;
}

static iso_status measure_padding(const reading *what, padding_counts *padding, iso_error *error) {
    char *states;
    padding->above_low = INFINITY;
    padding->below_high = -INFINITY;
    ISO_TRY(walk_with(what, find_padding, padding, sizeof *padding, &states, error));
    const padding_counts *found = (const padding_counts *)states;
    for (int w = 0; w < iso_pool_threads(what->pool); w++) {
        padding->above_low = fminf(padding->above_low, found[w].above_low);
        padding->below_high = fmaxf(padding->below_high, found[w].below_high);
        padding->count += found[w].count;
    }
    iso_free(states);
    double ends[2] = {(double)padding->above_low, -(double)padding->below_high};
    ISO_TRY(iso_ranks_least(what->ranks, ends, 2, error));
    padding->above_low = (float)ends[0];
    padding->below_high = (float)-ends[1];
    return iso_ranks_sum(what->ranks, &padding->count, 1, error);
}

/* Finds padding; if there is any, leaves it out of `range` and records it in `histogram`. */
static iso_status leave_out_padding(const reading *what, float_range *range, iso_histogram *histogram,
                                    iso_error *error) {
    face_counts faces;
    ISO_TRY(measure_faces(what, range, &faces, error));
    const bool at_low = 2 * faces.at_low > faces.all, at_high = 2 * faces.at_high > faces.all;
    if (!at_low && !at_high) return ISO_OK;
    padding_counts padding = {
        .low = range->low, .high = range->high, .padding = at_low ? range->low : range->high};
    ISO_TRY(measure_padding(what, &padding, error));
    if (!(padding.above_low < range->high)) return ISO_OK; /* a binary volume keeps both values */
    histogram->padding_value = iso_grid_physical(what->grid, padding.padding);
    histogram->padding = padding.count;
    if (at_low)
        range->low = padding.above_low;
    else
        range->high = padding.below_high;
    return ISO_OK;
}

static iso_status fill_from_floats(const reading *what, const float_range *range, iso_histogram *histogram,
                                   iso_error *error) {
    const double span = (double)range->high - range->low;
    const bin_counts none = {.range = {range->low, range->high, span > 0 ? ISO_HISTOGRAM_BINS / span : 0}};
    char *states;
    ISO_TRY(walk_with(what, count_bins, &none, sizeof none, &states, error));
    const bin_counts *found = (const bin_counts *)states;
    for (int w = 0; w < iso_pool_threads(what->pool); w++)
        for (int table = 0; table < BIN_TABLES; table++)
            for (int bin = 0; bin < ISO_HISTOGRAM_BINS; bin++)
                histogram->bins[bin] += found[w].bins[table][bin];
    iso_free(states);
    return iso_ranks_sum(what->ranks, histogram->bins, ISO_HISTOGRAM_BINS, error);
}

static iso_status float_histogram(const reading *what, iso_histogram *histogram, iso_error *error) {
    const iso_grid *grid = what->grid;
    float_range range;
    ISO_TRY(measure_range(what, &range, error));
    if (!range.finite)
        return iso_fail(
            error, ISO_ERR_EMPTY,
            "the volume holds no usable value: all are NaN, infinite or larger than a float holds (3.4e38)");
    histogram->minimum = iso_grid_physical(grid, range.low);
    histogram->maximum = iso_grid_physical(grid, range.high);
    ISO_TRY(leave_out_padding(what, &range, histogram, error));
    histogram->low = iso_grid_physical(grid, range.low);
    histogram->high = iso_grid_physical(grid, range.high);
    histogram->width = (histogram->high - histogram->low) / ISO_HISTOGRAM_BINS;
    histogram->nonfinite = range.nonfinite;
    histogram->counted = range.finite - histogram->padding;
    return fill_from_floats(what, &range, histogram, error);
}

static bool has_integer_levels(const iso_grid *grid) {
    return grid->rgrid && grid->rgrid->type != ISO_FLOAT32;
}

static iso_status compute(const reading *what, iso_histogram *histogram, iso_error *error) {
    iso_histogram result = {0};
    if (has_integer_levels(what->grid))
        ISO_TRY(integer_histogram(what, &result, error));
    else
        ISO_TRY(float_histogram(what, &result, error));
    *histogram = result;
    return ISO_OK;
}

iso_status iso_histogram_compute_together(const iso_grid *grid, const iso_ranks *ranks, iso_pool *pool,
                                          iso_histogram *histogram, iso_error *error) {
    const reading what = reading_of(grid, ranks, pool);
    return compute(&what, histogram, error);
}

iso_status iso_histogram_of_source(const iso_chunk_source *source, int side, const iso_ranks *ranks,
                                   iso_pool *pool, iso_histogram *histogram, iso_error *error) {
    iso_rgrid described = {.type = source->type, .scale = source->scale, .offset = source->offset};
    const iso_grid grid = {.rgrid = &described};
    for (int axis = 0; axis < 3; axis++) described.dims[axis] = source->dims[axis];
    const reading what = {.grid = &grid, .pool = pool, .ranks = ranks, .source = source, .side = side};
    return compute(&what, histogram, error);
}

iso_status iso_histogram_compute(const iso_grid *grid, iso_pool *pool, iso_histogram *histogram,
                                 iso_error *error) {
    const iso_ranks alone = {.size = 1};
    return iso_histogram_compute_together(grid, &alone, pool, histogram, error);
}

/* ---- mean and standard deviation */

/* Sums over finite voxels of whole numbers, (value - low) * per_value, and of their squares. */
typedef struct power_sums {
    double low, per_value;
    uint64_t count;
    __extension__ unsigned __int128 sum, squares;
} power_sums;

static void add_powers(power_sums *sums, uint64_t number, uint64_t count) {
    sums->count += count;
    sums->sum += (unsigned __int128)number * count;
    sums->squares += (unsigned __int128)number * number * count;
}

static void add_run_powers(void *state, const run *voxels) {
    power_sums *sums = state;
    int count;
    uint64_t each;
    const float *values = floats_of(voxels, &count, &each);
    for (int i = 0; i < count; i++)
        if (isfinite(values[i]))
            add_powers(sums, (uint64_t)(((double)values[i] - sums->low) * sums->per_value + 0.5), each);
}

/* Adds the sums of the other processes. */
static iso_status sum_powers(const iso_ranks *ranks, power_sums *sums, iso_error *error) {
    uint64_t limbs[9] = {sums->count};
    for (int i = 0; i < 4; i++) {
        limbs[1 + i] = (uint32_t)(sums->sum >> 32 * i);
        limbs[5 + i] = (uint32_t)(sums->squares >> 32 * i);
    }
    ISO_TRY(iso_ranks_sum(ranks, limbs, 9, error));
    sums->count = limbs[0];
    sums->sum = sums->squares = 0;
    for (int i = 0; i < 4; i++) {
        sums->sum += (unsigned __int128)limbs[1 + i] << 32 * i;
        sums->squares += (unsigned __int128)limbs[5 + i] << 32 * i;
    }
    return ISO_OK;
}

static iso_status float_powers(const reading *what, power_sums *sums, iso_error *error) {
    float_range range;
    char *states;
    ISO_TRY(measure_range(what, &range, error));
    if (!range.finite) return iso_fail(error, ISO_ERR_EMPTY, "the volume holds no usable value");
    const double span = (double)range.high - range.low;
    *sums = (power_sums){.low = range.low, .per_value = span > 0 ? 0x1p32 / span : 1};
    ISO_TRY(walk_with(what, add_run_powers, sums, sizeof *sums, &states, error));
    for (int w = 0; w < iso_pool_threads(what->pool); w++) {
        const power_sums *found = (const power_sums *)states + w;
        sums->count += found->count;
        sums->sum += found->sum;
        sums->squares += found->squares;
    }
    iso_free(states);
    return sum_powers(what->ranks, sums, error);
}

static iso_status integer_powers(const reading *what, power_sums *sums, iso_error *error) {
    iso_value_counts *counts = NULL;
    *sums = (power_sums){.low = what->grid->rgrid->type == ISO_INT16 ? -LEVELS / 2 : 0, .per_value = 1};
    ISO_TRY(count_values(what, &counts, error));
    for (int level = 0; level < LEVELS; level++) add_powers(sums, (uint64_t)level, counts->all[level]);
    iso_free(counts);
    return ISO_OK;
}

iso_status iso_moments_compute(const iso_grid *grid, const iso_chunk_source *source, int side,
                               const iso_ranks *ranks, iso_pool *pool, iso_moments *moments,
                               iso_error *error) {
    reading what = reading_of(grid, ranks, pool);
    what.source = source;
    what.side = side;
    power_sums sums;
    ISO_TRY((has_integer_levels(grid) ? integer_powers : float_powers)(&what, &sums, error));
    /* About the whole number next to the mean, which takes nothing away from small deviations. */
    const uint64_t middle = (uint64_t)(sums.sum / sums.count), rest = (uint64_t)(sums.sum % sums.count);
    const double offset = (double)rest / (double)sums.count;
    const unsigned __int128 about =
        sums.squares - 2 * middle * sums.sum + (unsigned __int128)middle * middle * sums.count;
    const double variance = (double)about / (double)sums.count - offset * offset;
    const double mean = sums.low + ((double)middle + offset) / sums.per_value;
    moments->mean = iso_grid_physical(grid, mean);
    moments->deviation = sqrt(fmax(0, variance)) / sums.per_value * iso_grid_scale(grid);
    return ISO_OK;
}

/* ---- thresholds */

/* Sums over the bins 0 .. i - 1, by i: of their counts, and of their counts times bin numbers. Bin numbers
 * stand for values, which changes no threshold. */
typedef struct cumulative {
    double weight[ISO_HISTOGRAM_BINS + 1], moment[ISO_HISTOGRAM_BINS + 1];
} cumulative;

static cumulative accumulate(const iso_histogram *histogram) {
    cumulative sums = {0};
    for (int i = 0; i < ISO_HISTOGRAM_BINS; i++) {
        sums.weight[i + 1] = sums.weight[i] + (double)histogram->bins[i];
        sums.moment[i + 1] = sums.moment[i] + (double)histogram->bins[i] * i;
    }
    return sums;
}

/* The term of the bins from .. to - 1, taken as one class, in the between-class variance; negative if they
 * are empty. */
static double class_term(const cumulative *sums, int from, int to) {
    double weight = sums->weight[to] - sums->weight[from], moment = sums->moment[to] - sums->moment[from];
    return weight > 0 ? moment * moment / weight : -1;
}

/* The physical value between the bins below `cut` and the others: half-way across the empty bins that begin
 * at `cut` and, if the data are integers, between two levels. */
static double cut_value(const iso_grid *grid, const iso_histogram *histogram, int cut) {
    int end = cut;
    while (end < ISO_HISTOGRAM_BINS && !histogram->bins[end]) end++;
    double middle = (cut + end) / 2.0;
    if (!has_integer_levels(grid)) return histogram->low + middle * histogram->width;
    double scale = grid->rgrid->scale, step = floor(histogram->width / scale + 0.5);
    return histogram->low + (floor(middle * step) - 0.5) * scale;
}

static int otsu_cut(const cumulative *sums) {
    int best_cut = 0;
    double best = 0;
    for (int cut = 1; cut < ISO_HISTOGRAM_BINS; cut++) {
        double below = class_term(sums, 0, cut), above = class_term(sums, cut, ISO_HISTOGRAM_BINS);
        if (below < 0 || above < 0 || below + above <= best) continue;
        best = below + above;
        best_cut = cut;
    }
    return best_cut;
}

static bool otsu_three_cuts(const cumulative *sums, int cuts[2]) {
    double best = 0;
    for (int a = 1; a < ISO_HISTOGRAM_BINS; a++) {
        double low = class_term(sums, 0, a);
        if (low < 0) continue;
        for (int b = a + 1; b < ISO_HISTOGRAM_BINS; b++) {
            double middle = class_term(sums, a, b), high = class_term(sums, b, ISO_HISTOGRAM_BINS);
            if (middle < 0 || high < 0 || low + middle + high <= best) continue;
            best = low + middle + high;
            cuts[0] = a;
            cuts[1] = b;
        }
    }
    return best > 0;
}

size_t iso_isovalue_suggest(const iso_grid *grid, const iso_histogram *histogram,
                            double candidates[ISO_ISOVALUE_CANDIDATES]) {
    if (iso_grid_is_level_set(grid)) {
        candidates[0] = 0;
        return 1;
    }
    cumulative sums = accumulate(histogram);
    int cut = otsu_cut(&sums), cuts[2];
    if (!cut) return 0;
    size_t count = 0;
    candidates[count++] = cut_value(grid, histogram, cut);
    if (!otsu_three_cuts(&sums, cuts)) return count;
    for (int i = 0; i < 2; i++) {
        double value = cut_value(grid, histogram, cuts[i]);
        bool known = false;
        for (size_t k = 0; k < count; k++) known = known || candidates[k] == value;
        if (!known) candidates[count++] = value;
    }
    return count;
}

iso_status iso_isovalue_check(const iso_grid *grid, double isovalue, iso_error *error) {
    if (!grid->hgrid || fabs(iso_grid_stored(grid, isovalue)) < (double)grid->hgrid->band) return ISO_OK;
    return iso_fail(error, ISO_ERR_EMPTY,
                    "no surface at isovalue %g: the level set's narrow band is %g mm wide on either side",
                    isovalue, iso_grid_physical(grid, (double)grid->hgrid->band));
}
