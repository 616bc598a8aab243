/* Isovalues from a histogram. Otsu 1979, "A threshold selection method from gray-level histograms"; Liao,
 * Chen and Chung 2001, "A fast algorithm for multilevel thresholding". */
#include "extract/isovalue.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"

/* ---- walking over the voxels */

/* A run of voxels along x: `count` values, or `constant` so many times when values is NULL. */
typedef struct run {
    const void *values;
    float constant;
    size_t count;
    bool in_face;                      /* the whole run lies in a face of the volume */
    bool starts_in_face, ends_in_face; /* its first or last voxel does */
} run;

typedef void run_visitor(void *worker_state, const run *voxels);

static void mark_faces(run *voxels, const int dims[3], int x, int y, int z) {
    voxels->in_face = y == 0 || z == 0 || y == dims[1] - 1 || z == dims[2] - 1;
    voxels->starts_in_face = x == 0;
    voxels->ends_in_face = x + (int)voxels->count == dims[0];
}

static inline bool on_face(const run *voxels, size_t i) {
    return voxels->in_face || (voxels->starts_in_face && i == 0) ||
           (voxels->ends_in_face && i + 1 == voxels->count);
}

static size_t count_on_faces(const run *voxels) {
    if (voxels->in_face) return voxels->count;
    size_t ends = (size_t)voxels->starts_in_face + voxels->ends_in_face;
    return ends < voxels->count ? ends : voxels->count;
}

static void visit_rgrid_slice(const iso_rgrid *grid, int z, run_visitor *visit, void *state) {
    for (int y = 0; y < grid->dims[1]; y++) {
        ptrdiff_t first = y * grid->stride_y + z * grid->stride_z;
        const char *data = grid->data;
        run row = {.values = data + first * (ptrdiff_t)iso_type_size(grid->type),
                   .count = (size_t)grid->dims[0]};
        mark_faces(&row, grid->dims, 0, y, z);
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

static void visit_slice(const iso_grid *grid, int z, run_visitor *visit, void *state) {
    if (grid->hgrid)
        visit_hgrid_slice(grid->hgrid, z, visit, state);
    else
        visit_rgrid_slice(grid->rgrid, z, visit, state);
}

/* One slice a task; every worker has its own state, added up afterwards. */
typedef struct walk {
    const iso_grid *grid;
    run_visitor *visit;
    char *states;
    size_t state_bytes;
} walk;

static void walk_slice(void *context, size_t z, int worker) {
    const walk *job = context;
    visit_slice(job->grid, (int)z, job->visit, job->states + (size_t)worker * job->state_bytes);
}

static void run_walk(walk *job, iso_pool *pool) {
    iso_parallel_for(pool, (size_t)iso_grid_dims(job->grid)[2], walk_slice, job);
}

/* ---- integers: every value has a count of its own */

enum { LEVELS = 1 << 16 };

typedef struct level_counts {
    iso_type type;
    uint64_t all[LEVELS], faces[LEVELS]; /* by value, less -32768 for int16 */
} level_counts;

static int level_of(iso_type type, const void *values, size_t i) {
    switch (type) {
    case ISO_UINT8:
        return ((const uint8_t *)values)[i];
    case ISO_INT16:
        return ((const int16_t *)values)[i] + LEVELS / 2;
    default:
        return ((const uint16_t *)values)[i];
    }
}

static void count_levels(void *state, const run *voxels) {
    level_counts *counts = state;
    for (size_t i = 0; i < voxels->count; i++) {
        int level = level_of(counts->type, voxels->values, i);
        counts->all[level]++;
        counts->faces[level] += on_face(voxels, i);
    }
}

/* What the histogram of a range of levels is made from. */
typedef struct level_range {
    int first, last;
    int padding; /* a level, or -1 */
} level_range;

static void shrink(const level_counts *counts, level_range *range) {
    while (!counts->all[range->first]) range->first++;
    while (!counts->all[range->last]) range->last--;
}

static level_range range_of_levels(const level_counts *counts) {
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

static void fill_from_levels(const iso_rgrid *grid, const level_counts *counts, iso_histogram *histogram) {
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

static iso_status integer_histogram(const iso_grid *grid, iso_pool *pool, iso_histogram *histogram,
                                    iso_error *error) {
    size_t workers = (size_t)iso_pool_threads(pool);
    level_counts *counts = iso_alloc_zero(workers, sizeof *counts);
    if (!counts) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a histogram");
    for (size_t w = 0; w < workers; w++) counts[w].type = grid->rgrid->type;
    run_walk(&(walk){grid, count_levels, (char *)counts, sizeof *counts}, pool);
    for (size_t w = 1; w < workers; w++)
        for (int level = 0; level < LEVELS; level++) {
            counts[0].all[level] += counts[w].all[level];
            counts[0].faces[level] += counts[w].faces[level];
        }
    fill_from_levels(grid->rgrid, counts, histogram);
    iso_free(counts);
    return ISO_OK;
}

/* ---- floats: the range first, then the bins */

/* How often the smallest and the largest value occur, and where the others end. */
typedef struct extremes {
    float low, high;             /* of finite voxels */
    float above_low, below_high; /* the next values inwards */
    uint64_t low_count, high_count, low_faces, high_faces;
    uint64_t finite, nonfinite, faces;
} extremes;

static const extremes no_extremes = {
    .low = INFINITY, .high = -INFINITY, .above_low = INFINITY, .below_high = -INFINITY};

/* Takes in `count` voxels of one value, `faces` of them on faces. */
static void take_low(extremes *e, float value, uint64_t count, uint64_t faces) {
    if (value < e->low) {
        e->above_low = e->low;
        e->low = value;
        e->low_count = e->low_faces = 0;
    } else if (value > e->low && value < e->above_low) {
        e->above_low = value;
    }
    if (value == e->low) {
        e->low_count += count;
        e->low_faces += faces;
    }
}

static void take_high(extremes *e, float value, uint64_t count, uint64_t faces) {
    if (value > e->high) {
        e->below_high = e->high;
        e->high = value;
        e->high_count = e->high_faces = 0;
    } else if (value < e->high && value > e->below_high) {
        e->below_high = value;
    }
    if (value == e->high) {
        e->high_count += count;
        e->high_faces += faces;
    }
}

static void take_value(extremes *e, float value, uint64_t count, uint64_t faces) {
    e->faces += faces;
    if (!isfinite(value)) {
        e->nonfinite += count;
        return;
    }
    e->finite += count;
    take_low(e, value, count, faces);
    take_high(e, value, count, faces);
}

static void find_extremes(void *state, const run *voxels) {
    if (!voxels->values) {
        take_value(state, voxels->constant, voxels->count, count_on_faces(voxels));
        return;
    }
    const float *values = voxels->values;
    for (size_t i = 0; i < voxels->count; i++) take_value(state, values[i], 1, on_face(voxels, i));
}

static void merge_extremes(extremes *sum, const extremes *part) {
    sum->faces += part->faces;
    sum->nonfinite += part->nonfinite;
    sum->finite += part->finite;
    if (!part->finite) return;
    take_low(sum, part->low, part->low_count, part->low_faces);
    take_high(sum, part->high, part->high_count, part->high_faces);
    if (part->above_low < INFINITY) take_low(sum, part->above_low, 0, 0);
    if (part->below_high > -INFINITY) take_high(sum, part->below_high, 0, 0);
}

/* Counts of one worker. Stored values; bin = (value - low) * per_value. */
typedef struct bin_counts {
    double low, high, per_value;
    uint64_t bins[ISO_HISTOGRAM_BINS];
} bin_counts;

static void count_bin(bin_counts *counts, float value, uint64_t count) {
    if (!(value >= counts->low && value <= counts->high)) return; /* padding, or not finite */
    int bin = (int)((value - counts->low) * counts->per_value);
    counts->bins[bin < ISO_HISTOGRAM_BINS ? bin : ISO_HISTOGRAM_BINS - 1] += count;
}

static void count_bins(void *state, const run *voxels) {
    if (!voxels->values) {
        count_bin(state, voxels->constant, voxels->count);
        return;
    }
    const float *values = voxels->values;
    for (size_t i = 0; i < voxels->count; i++) count_bin(state, values[i], 1);
}

static double physical(const iso_grid *grid, double stored) {
    return grid->rgrid ? stored * grid->rgrid->scale + grid->rgrid->offset : stored;
}

static void fill_range(const iso_grid *grid, const extremes *e, bin_counts *counts,
                       iso_histogram *histogram) {
    counts->low = e->low;
    counts->high = e->high;
    bool several = e->above_low < e->high; /* at least three values */
    if (several && 2 * e->low_faces > e->faces) {
        histogram->padding_value = physical(grid, e->low);
        histogram->padding = e->low_count;
        counts->low = e->above_low;
    } else if (several && 2 * e->high_faces > e->faces) {
        histogram->padding_value = physical(grid, e->high);
        histogram->padding = e->high_count;
        counts->high = e->below_high;
    }
    double range = counts->high - counts->low;
    counts->per_value = range > 0 ? ISO_HISTOGRAM_BINS / range : 0;
    histogram->low = physical(grid, counts->low);
    histogram->high = physical(grid, counts->high);
    histogram->width = (histogram->high - histogram->low) / ISO_HISTOGRAM_BINS;
    histogram->minimum = physical(grid, e->low);
    histogram->maximum = physical(grid, e->high);
    histogram->nonfinite = e->nonfinite;
    histogram->counted = e->finite - histogram->padding;
}

static void fill_from_floats(const iso_grid *grid, iso_pool *pool, const extremes *e, bin_counts *counts,
                             iso_histogram *histogram) {
    size_t workers = (size_t)iso_pool_threads(pool);
    fill_range(grid, e, counts, histogram);
    for (size_t w = 1; w < workers; w++) counts[w] = counts[0];
    run_walk(&(walk){grid, count_bins, (char *)counts, sizeof *counts}, pool);
    for (size_t w = 0; w < workers; w++)
        for (int bin = 0; bin < ISO_HISTOGRAM_BINS; bin++) histogram->bins[bin] += counts[w].bins[bin];
}

static iso_status float_histogram(const iso_grid *grid, iso_pool *pool, iso_histogram *histogram,
                                  iso_error *error) {
    size_t workers = (size_t)iso_pool_threads(pool);
    extremes *found = iso_alloc_zero(workers, sizeof *found);
    bin_counts *counts = iso_alloc_zero(workers, sizeof *counts);
    iso_status status = ISO_OK;
    if (found && counts) {
        for (size_t w = 0; w < workers; w++) found[w] = no_extremes;
        run_walk(&(walk){grid, find_extremes, (char *)found, sizeof *found}, pool);
        for (size_t w = 1; w < workers; w++) merge_extremes(&found[0], &found[w]);
        if (found[0].finite)
            fill_from_floats(grid, pool, &found[0], counts, histogram);
        else
            status = iso_fail(error, ISO_ERR_EMPTY,
                              "the volume holds no usable value: all are NaN, infinite or larger than a "
                              "float holds (3.4e38)");
    } else {
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for a histogram");
    }
    iso_free(found);
    iso_free(counts);
    return status;
}

static bool has_integer_levels(const iso_grid *grid) {
    return grid->rgrid && grid->rgrid->type != ISO_FLOAT32;
}

iso_status iso_histogram_compute(const iso_grid *grid, iso_pool *pool, iso_histogram *histogram,
                                 iso_error *error) {
    iso_histogram result = {0};
    if (has_integer_levels(grid))
        ISO_TRY(integer_histogram(grid, pool, &result, error));
    else
        ISO_TRY(float_histogram(grid, pool, &result, error));
    *histogram = result;
    return ISO_OK;
}

/* ---- thresholds */

/* Sums over bins 0 .. i-1; bin numbers serve as values, which changes no threshold. */
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

/* What bins from .. to-1 add to the between-class variance; negative when they are empty. */
static double class_term(const cumulative *sums, int from, int to) {
    double weight = sums->weight[to] - sums->weight[from], moment = sums->moment[to] - sums->moment[from];
    return weight > 0 ? moment * moment / weight : -1;
}

/* The value between the bins below `cut` and the others: half-way across the empty bins that follow, and
 * between two levels when the data are integers. */
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
