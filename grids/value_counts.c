/* Counts values of integers. Each worker has tables of its own, which are added up at the end. */
#include "grids/value_counts.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/memory.h"

enum { VALUES = ISO_COUNTED_VALUES, TABLES = 2, FOLD_EVERY = 1 << 30 };

/* The counts of one worker. Increments of a counter have to wait for the previous increment of the same
 * counter, and neighbouring voxels are often equal. Therefore voxels are first counted as words of 16 bits
 * (single values of 16 bits; pairs of values of 8 bits, which halves the number of increments), and
 * consecutive words go to several tables. */
typedef struct worker_counts {
    iso_value_counts values;
    uint32_t words[TABLES][VALUES]; /* counts that are not yet added to values.all */
    size_t word_count;
} worker_counts;

struct iso_value_counter {
    const iso_rgrid *grid;
    const iso_rgrid *window; /* where voxels are read: `grid`, or a part of it */
    int origin[3];           /* of the window */
    worker_counts *workers;
    int worker_count;
    iso_value_counts *sum;
};

/* The index in iso_value_counts of the i-th of some values. */
static int index_of(iso_type type, const void *values, size_t i) {
    switch (type) {
    case ISO_UINT8:
        return ((const uint8_t *)values)[i];
    case ISO_INT16:
        return ((const int16_t *)values)[i] + VALUES / 2;
    default:
        return ((const uint16_t *)values)[i];
    }
}

/* Adds the counts of words to values.all, and sets them to 0. */
static void fold_words(worker_counts *counts, iso_type type) {
    uint64_t *all = counts->values.all;
    for (int word = 0; word < VALUES; word++) {
        uint64_t count = 0;
        for (int table = 0; table < TABLES; table++) count += counts->words[table][word];
        if (type == ISO_UINT8) {
            all[word & 255] += count;
            all[word >> 8] += count;
        } else {
            all[type == ISO_INT16 ? word ^ VALUES / 2 : word] += count;
        }
    }
    memset(counts->words, 0, sizeof counts->words);
    counts->word_count = 0;
}

static void count_words(uint32_t words[TABLES][VALUES], const unsigned char *data, size_t count) {
    const size_t fours = count / 4;
    for (size_t i = 0; i < fours; i++) {
        uint64_t four;
        memcpy(&four, data + 8 * i, sizeof four);
        words[0][four & 0xffff]++;
        words[1][four >> 16 & 0xffff]++;
        words[0][four >> 32 & 0xffff]++;
        words[1][four >> 48]++;
    }
    for (size_t i = 4 * fours; i < count; i++) {
        uint16_t word;
        memcpy(&word, data + 2 * i, sizeof word);
        words[0][word]++;
    }
}

static void count_row(worker_counts *counts, iso_type type, const void *values, size_t count) {
    const size_t words = type == ISO_UINT8 ? count / 2 : count;
    count_words(counts->words, values, words);
    if (type == ISO_UINT8 && count % 2) counts->values.all[index_of(type, values, count - 1)]++;
    counts->word_count += words;
    if (counts->word_count >= FOLD_EVERY) fold_words(counts, type);
}

static const char *voxel(const iso_value_counter *counter, int x, int y, int z) {
    const iso_rgrid *grid = counter->window;
    const int *origin = counter->origin;
    const ptrdiff_t at = x - origin[0] + (y - origin[1]) * grid->stride_y + (z - origin[2]) * grid->stride_z;
    return (const char *)grid->data + at * (ptrdiff_t)iso_type_size(grid->type);
}

/* Counts the voxels of a row that lie on faces of the volume. */
static void count_faces(const iso_value_counter *counter, worker_counts *counts, const int lo[3],
                        const int hi[3], int y, int z) {
    const iso_rgrid *grid = counter->grid;
    const void *values = voxel(counter, lo[0], y, z);
    const int n = hi[0] - lo[0], *dims = grid->dims;
    uint64_t *faces = counts->values.faces;
    if (y == 0 || z == 0 || y == dims[1] - 1 || z == dims[2] - 1) {
        for (int i = 0; i < n; i++) faces[index_of(grid->type, values, (size_t)i)]++;
        return;
    }
    const bool first = lo[0] == 0, last = hi[0] == dims[0] && !(first && n == 1);
    if (first) faces[index_of(grid->type, values, 0)]++;
    if (last) faces[index_of(grid->type, values, (size_t)(n - 1))]++;
}

/* Asks for memory that will be read soon. It need not go into the first-level cache, which holds counts. */
static void fetch(const char *memory, size_t bytes) {
    for (size_t byte = 0; byte < bytes; byte += 64) __builtin_prefetch(memory + byte, 0, 2);
}

void iso_value_counter_add(iso_value_counter *counter, int worker, const int lo[3], const int hi[3],
                           int ahead) {
    const iso_rgrid *grid = counter->grid;
    const size_t n = (size_t)(hi[0] - lo[0]);
    worker_counts *counts = &counter->workers[worker];
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++) {
            const void *row = voxel(counter, lo[0], y, z);
            if (ahead && y + ahead < grid->dims[1])
                fetch(voxel(counter, lo[0], y + ahead, z), n * iso_type_size(grid->type));
            count_row(counts, grid->type, row, n);
            count_faces(counter, counts, lo, hi, y, z);
        }
}

void iso_value_counter_add_constant(iso_value_counter *counter, int worker, const int lo[3],
                                    const int hi[3]) {
    const iso_rgrid *grid = counter->grid;
    iso_value_counts *values = &counter->workers[worker].values;
    const int index = index_of(grid->type, voxel(counter, lo[0], lo[1], lo[2]), 0);
    uint64_t all = 1, inner = 1; /* voxels, and those of them that are on no face */
    for (int axis = 0; axis < 3; axis++) {
        const int first = lo[axis] == 0, last = hi[axis] == grid->dims[axis], n = hi[axis] - lo[axis];
        all *= (uint64_t)n;
        inner *= (uint64_t)(n > first + last ? n - first - last : 0);
    }
    values->all[index] += all;
    values->faces[index] += all - inner;
}

void iso_value_counter_set_window(iso_value_counter *counter, const iso_rgrid *window, const int origin[3]) {
    counter->window = window;
    memcpy(counter->origin, origin, sizeof counter->origin);
}

void iso_value_counter_destroy(iso_value_counter *counter) {
    if (!counter) return;
    iso_free(counter->workers);
    iso_free(counter->sum);
    iso_free(counter);
}

iso_status iso_value_counter_create(const iso_rgrid *grid, int workers, iso_value_counter **counter,
                                    iso_error *error) {
    iso_value_counter *made = iso_alloc_zero(1, sizeof *made);
    if (made) {
        made->grid = made->window = grid;
        made->worker_count = workers;
        made->workers = iso_alloc_zero((size_t)workers, sizeof *made->workers);
        made->sum = iso_alloc_zero(1, sizeof *made->sum);
    }
    if (!made || !made->workers || !made->sum) {
        iso_value_counter_destroy(made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for counting values");
    }
    *counter = made;
    return ISO_OK;
}

iso_value_counts *iso_value_counter_finish(iso_value_counter *counter) {
    iso_value_counts *sum = counter->sum;
    for (int w = 0; w < counter->worker_count; w++) {
        worker_counts *counts = &counter->workers[w];
        fold_words(counts, counter->grid->type);
        for (int value = 0; value < VALUES; value++) {
            sum->all[value] += counts->values.all[value];
            sum->faces[value] += counts->values.faces[value];
        }
    }
    counter->sum = NULL;
    iso_value_counter_destroy(counter);
    return sum;
}

typedef struct slice_counting {
    iso_value_counter *counter;
    int first; /* slice */
} slice_counting;

static void count_slice(void *context, size_t slice, int worker) {
    const slice_counting *counting = context;
    const int z = counting->first + (int)slice, *dims = counting->counter->grid->dims, lo[3] = {0, 0, z},
              hi[3] = {dims[0], dims[1], z + 1};
    iso_value_counter_add(counting->counter, worker, lo, hi, 0);
}

iso_status iso_value_counts_create(const iso_rgrid *grid, int first, int end, iso_pool *pool,
                                   iso_value_counts **counts, iso_error *error) {
    slice_counting counting = {.first = first};
    ISO_TRY(iso_value_counter_create(grid, iso_pool_threads(pool), &counting.counter, error));
    iso_parallel_until(pool, (size_t)(end - first), count_slice, &counting);
    const iso_status status = iso_pool_check(pool, "the histogram", error);
    if (status != ISO_OK) {
        iso_value_counter_destroy(counting.counter);
        return status;
    }
    *counts = iso_value_counter_finish(counting.counter);
    return ISO_OK;
}
