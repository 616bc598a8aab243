/* Builds and queries the interval tree of Cignoni et al. 1997.
 *
 * Span-space lattices (Shen et al. 1996) are as fast for evenly distributed values, but degrade where values
 * cluster, as those of CT around air; buckets for each value suit 8-bit data only. The tree is optimal for
 * any distribution and the same for all types. It is built without comparisons: both ends are radix-sorted
 * once, and distributing the sorted ends to the nodes leaves the lists of each node sorted. */
#include "grids/interval_tree.h"

#include <stdbool.h>
#include <string.h>

#include "base/memory.h"

/* Maps floats to integers with the same order (-0 before 0). */
static inline uint32_t key_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

enum { DIGITS = 4, DIGIT_VALUES = 256 };

/* Sorts ends by value: a stable radix sort. *ends and *spare may be exchanged. Digits (bytes of the key) that
 * are the same in all ends are skipped: floats of small integers differ in two of four bytes. */
static void sort_ends(iso_interval_end **ends, iso_interval_end **spare, size_t count) {
    uint32_t offsets[DIGITS][DIGIT_VALUES] = {{0}};
    for (size_t i = 0; i < count; i++) {
        uint32_t key = key_of((*ends)[i].at);
        for (int digit = 0; digit < DIGITS; digit++) offsets[digit][key >> 8 * digit & 255]++;
    }
    for (int digit = 0; digit < DIGITS && count; digit++) {
        uint32_t *offset = offsets[digit], sum = 0;
        if (offset[key_of((*ends)[0].at) >> 8 * digit & 255] == count) continue;
        for (int value = 0; value < DIGIT_VALUES; value++) {
            uint32_t here = offset[value];
            offset[value] = sum;
            sum += here;
        }
        iso_interval_end *from = *ends, *to = *spare;
        for (size_t i = 0; i < count; i++) to[offset[key_of(from[i].at) >> 8 * digit & 255]++] = from[i];
        *ends = to;
        *spare = from;
    }
}

/* Lists at[i] for each interval i that is not empty. */
static void collect_ends(const float *lo, const float *hi, const float *at, uint32_t total,
                         iso_interval_end *ends) {
    size_t count = 0;
    for (uint32_t i = 0; i < total; i++)
        if (lo[i] < hi[i]) ends[count++] = (iso_interval_end){at[i], i};
}

/* The working memory of a build. */
typedef struct build {
    iso_interval_tree tree;
    iso_interval_end *by_lower, *by_upper, *spare;
    uint32_t *node; /* by interval: at first the number of the node of its upper end, then its node */
} build;

/* Makes the nodes: the distinct upper ends, ascending. */
static void make_nodes(build *b) {
    iso_interval_tree *tree = &b->tree;
    for (uint32_t i = 0; i < tree->count; i++) {
        const iso_interval_end *end = &b->by_upper[i];
        if (tree->nodes == 0 || tree->splits[tree->nodes] != end->at) tree->splits[++tree->nodes] = end->at;
        b->node[end->interval] = tree->nodes;
    }
}

/* Finds the node of each interval. An interval contains splits first .. last, and the topmost of these nodes
 * is the number with the most trailing zeros: `last` with all bits below the highest one in which it differs
 * from first - 1 cleared. */
static void find_nodes(build *b) {
    const iso_interval_tree *tree = &b->tree;
    uint32_t first = 1;
    for (uint32_t i = 0; i < tree->count; i++) {
        const iso_interval_end *end = &b->by_lower[i];
        while (tree->splits[first] <= end->at) first++;
        uint32_t last = b->node[end->interval];
        int bit = 31 - __builtin_clz((first - 1) ^ last);
        b->node[end->interval] = last >> bit << bit;
    }
}

/* Fills the two lists. Filling `lower` moves each entry of `starts` to the end of its node; filling `upper`
 * backwards from there moves it back, and puts the upper ends in descending order. */
static void fill_lists(build *b) {
    iso_interval_tree *tree = &b->tree;
    uint32_t *starts = tree->starts, sum = 0;
    memset(starts, 0, ((size_t)tree->nodes + 2) * sizeof *starts);
    for (uint32_t i = 0; i < tree->count; i++) starts[b->node[b->by_upper[i].interval]]++;
    for (uint32_t node = 1; node <= tree->nodes + 1; node++) {
        uint32_t here = starts[node];
        starts[node] = sum;
        sum += here;
    }
    tree->lower = b->spare;
    for (uint32_t i = 0; i < tree->count; i++)
        tree->lower[starts[b->node[b->by_lower[i].interval]]++] = b->by_lower[i];
    tree->upper = b->by_lower;
    for (uint32_t i = 0; i < tree->count; i++)
        tree->upper[--starts[b->node[b->by_upper[i].interval]]] = b->by_upper[i];
    b->spare = b->by_lower = NULL;
}

static iso_status allocate_build(build *b, uint32_t total, iso_error *error) {
    size_t bytes = b->tree.count * sizeof(iso_interval_end);
    b->by_lower = iso_alloc(bytes);
    b->by_upper = iso_alloc(bytes);
    b->spare = iso_alloc(bytes);
    b->node = iso_alloc(total * sizeof *b->node);
    if (b->by_lower && b->by_upper && b->spare && b->node) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an interval tree over %u intervals",
                    (unsigned)b->tree.count);
}

static iso_status reserve_nodes(build *b, iso_error *error) {
    uint32_t distinct = 1;
    for (uint32_t i = 1; i < b->tree.count; i++) distinct += b->by_upper[i].at != b->by_upper[i - 1].at;
    b->tree.splits = iso_alloc(((size_t)distinct + 1) * sizeof(float));
    b->tree.starts = iso_alloc(((size_t)distinct + 2) * sizeof(uint32_t));
    if (b->tree.splits && b->tree.starts) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an interval tree of %u nodes",
                    (unsigned)distinct);
}

static iso_status build_tree(build *b, const float *lo, const float *hi, uint32_t total, iso_error *error) {
    for (uint32_t i = 0; i < total; i++) b->tree.count += lo[i] < hi[i];
    if (b->tree.count == 0) return ISO_OK;
    ISO_TRY(allocate_build(b, total, error));
    collect_ends(lo, hi, hi, total, b->by_upper);
    sort_ends(&b->by_upper, &b->spare, b->tree.count);
    collect_ends(lo, hi, lo, total, b->by_lower);
    sort_ends(&b->by_lower, &b->spare, b->tree.count);
    ISO_TRY(reserve_nodes(b, error));
    make_nodes(b);
    find_nodes(b);
    fill_lists(b);
    return ISO_OK;
}

iso_status iso_interval_tree_build(iso_interval_tree *tree, const float *lo, const float *hi, uint32_t total,
                                   iso_error *error) {
    build b = {0};
    iso_status status = build_tree(&b, lo, hi, total, error);
    iso_interval_tree_free(status == ISO_OK ? tree : &b.tree);
    if (status == ISO_OK) *tree = b.tree;
    iso_free(b.by_lower);
    iso_free(b.by_upper);
    iso_free(b.spare);
    iso_free(b.node);
    return status;
}

void iso_interval_tree_free(iso_interval_tree *tree) {
    iso_free(tree->splits);
    iso_free(tree->starts);
    iso_free(tree->lower);
    iso_free(tree->upper);
    *tree = (iso_interval_tree){0};
}

/* Return how many of the first ends lie below a value (count_below), or at or above it (count_from). Adds the
 * number of ends that were read to *looks. */
static size_t count_below(const iso_interval_end *ends, size_t count, float value, size_t *looks) {
    size_t i = 0;
    while (i < count && (++*looks, ends[i].at < value)) i++;
    return i;
}

static size_t count_from(const iso_interval_end *ends, size_t count, float value, size_t *looks) {
    size_t i = 0;
    while (i < count && (++*looks, ends[i].at >= value)) i++;
    return i;
}

int iso_interval_tree_query(const iso_interval_tree *tree, float value,
                            iso_interval_run runs[ISO_INTERVAL_RUNS], size_t *looks) {
    if (tree->nodes == 0) return 0;
    int found = 0;
    uint32_t step = (uint32_t)1 << (31 - __builtin_clz(tree->nodes));
    for (uint32_t node = step; step; step >>= 1) {
        /* Nodes beyond the last one do not exist: they count as an infinite split with empty lists. */
        const bool exists = node <= tree->nodes, left = !exists || value <= tree->splits[node];
        if (exists) {
            const size_t first = tree->starts[node], count = tree->starts[node + 1] - first;
            iso_interval_run run = {.ends = (left ? tree->lower : tree->upper) + first};
            run.count =
                left ? count_below(run.ends, count, value, looks) : count_from(run.ends, count, value, looks);
            if (run.count) runs[found++] = run;
        }
        node = left ? node - (step >> 1) : node + (step >> 1);
    }
    return found;
}

size_t iso_interval_tree_bytes(const iso_interval_tree *tree) {
    if (tree->count == 0) return 0;
    return 2 * tree->count * sizeof(iso_interval_end) + ((size_t)tree->nodes + 1) * sizeof(float) +
           ((size_t)tree->nodes + 2) * sizeof(uint32_t);
}
