/* labels: reads a grid of whole numbers as labels, in two passes over its rows: values, then their places in
 * the list of labels. */
#include "grids/labels/labels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "grids/labels/label_parts.h"

enum { VALUES = ISO_LABEL_VALUE_MAX + 1 };

typedef struct reading {
    const iso_grid *grid;
    iso_labels *labels;
    uint8_t *present; /* VALUES for each worker */
    double *bad;      /* of each slice: a value that is no label; NaN: none */
    uint16_t *place;  /* of a value, in the list of labels */
    iso_label *found; /* labels->count for each worker */
} reading;

static uint16_t *row_of(const iso_labels *labels, int y, int z) {
    return labels->number + ((size_t)z * (size_t)labels->dims[1] + (size_t)y) * (size_t)labels->dims[0];
}

/* (Runs of one value are found and written 16 voxels at a time.) */
static void widen_row(const uint8_t *from, int n, uint16_t *row) {
    int x = 0;
    for (; x + 16 <= n; x += 16) {
        uint64_t eight[2], same = from[x] * UINT64_C(0x0101010101010101);
        memcpy(eight, from + x, sizeof eight);
        if (((eight[0] ^ same) | (eight[1] ^ same)) == 0)
            iso_label_fill(row, x, x + 16, from[x]);
        else
            for (int i = 0; i < 16; i++) row[x + i] = from[x + i];
    }
    for (; x < n; x++) row[x] = from[x];
}

/* Reads a row as values; returns one that is no label, or NaN. */
static double read_row(const iso_rgrid *grid, int y, int z, uint16_t *row) {
    const ptrdiff_t first = y * grid->stride_y + z * grid->stride_z;
    const bool plain = grid->scale == 1 && grid->offset == 0;
    const int n = grid->dims[0];
    double bad = NAN;
    if (plain && grid->type == ISO_UINT8) {
        const uint8_t *from = (const uint8_t *)grid->data + first;
        widen_row(from, n, row);
    } else if (plain && grid->type == ISO_UINT16) {
        memcpy(row, (const uint16_t *)grid->data + first, (size_t)n * sizeof *row);
    } else {
        for (int x = 0; x < n; x++) {
            const double value = (double)iso_rgrid_at(grid, x, y, z) * grid->scale + grid->offset;
            const double whole = floor(value + 0.5);
            const bool fits = whole >= 0 && whole <= ISO_LABEL_VALUE_MAX && fabs(value - whole) < 1e-3;
            if (!fits && !isnan(value)) bad = value;
            row[x] = fits ? (uint16_t)whole : 0;
        }
    }
    return bad;
}

static void read_slice(void *context, size_t z, int worker) {
    reading *r = context;
    uint8_t *present = r->present + (size_t)worker * VALUES;
    r->bad[z] = NAN;
    for (int y = 0; y < r->labels->dims[1]; y++) {
        uint16_t *row = row_of(r->labels, y, (int)z);
        const double bad = read_row(r->grid->rgrid, y, (int)z, row);
        if (!isnan(bad)) r->bad[z] = bad;
        for (int x = 0; x < r->labels->dims[0]; x = iso_label_run_end(row, x, r->labels->dims[0]))
            present[row[x]] = 1;
    }
}

/* Adds the voxels x .. end - 1 of a row. */
static void add_run(iso_label *label, int x, int end, int y, int z) {
    const int first[3] = {x, y, z}, last[3] = {end - 1, y, z};
    const uint64_t n = (uint64_t)(end - x);
    label->voxels += n;
    label->runs++;
    label->sums[0] += (uint64_t)(x + end - 1) * n / 2;
    label->sums[1] += (uint64_t)y * n;
    label->sums[2] += (uint64_t)z * n;
    for (int k = 0; k < 3; k++) {
        if (first[k] < label->lo[k]) label->lo[k] = first[k];
        if (last[k] > label->hi[k]) label->hi[k] = last[k];
    }
}

static void number_slice(void *context, size_t z, int worker) {
    const reading *r = context;
    iso_label *found = r->found + (size_t)worker * (size_t)r->labels->count;
    const int n = r->labels->dims[0];
    for (int y = 0; y < r->labels->dims[1]; y++) {
        uint16_t *row = row_of(r->labels, y, (int)z);
        for (int x = 0, end; x < n; x = end) {
            const uint16_t place = r->place[row[x]];
            end = iso_label_run_end(row, x, n);
            if (place != row[x]) iso_label_fill(row, x, end, place);
            add_run(&found[place], x, end, y, (int)z);
        }
    }
}

static void clear_label(iso_label *label, int value) {
    *label = (iso_label){
        .value = value, .lo = {INT32_MAX, INT32_MAX, INT32_MAX}, .hi = {INT32_MIN, INT32_MIN, INT32_MIN}};
}

static void unite(iso_label *label, const iso_label *other) {
    label->voxels += other->voxels;
    label->runs += other->runs;
    for (int k = 0; k < 3; k++) {
        label->sums[k] += other->sums[k];
        if (other->lo[k] < label->lo[k]) label->lo[k] = other->lo[k];
        if (other->hi[k] > label->hi[k]) label->hi[k] = other->hi[k];
    }
}

/* Drops parts of labels, and finds anew which values are present. */
static iso_status drop_parts(reading *r, const iso_label_parts *keep, iso_components_totals *totals,
                             int workers, iso_error *error) {
    const iso_labels *labels = r->labels;
    const int n = labels->dims[0];
    ISO_TRY(iso_label_parts_drop(r->labels, keep, totals, error));
    memset(r->present, 0, (size_t)workers * VALUES);
    for (int z = 0; z < labels->dims[2]; z++)
        for (int y = 0; y < labels->dims[1]; y++) {
            const uint16_t *row = row_of(labels, y, z);
            for (int x = 0; x < n; x = iso_label_run_end(row, x, n)) r->present[row[x]] = 1;
        }
    return ISO_OK;
}

/* Lists the values that some voxel has, and 0. */
static iso_status list_labels(reading *r, int workers, iso_error *error) {
    iso_labels *labels = r->labels;
    labels->count = 0;
    for (int value = 0; value < VALUES; value++) {
        for (int w = 1; w < workers; w++) r->present[value] |= r->present[(size_t)w * VALUES + (size_t)value];
        labels->count += r->present[value] || value == 0;
    }
    labels->label = iso_alloc((size_t)labels->count * sizeof *labels->label);
    r->found = iso_alloc((size_t)workers * (size_t)labels->count * sizeof *r->found);
    if (!labels->label || !r->found) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    for (int value = 0, place = 0; value < VALUES; value++) {
        if (!r->present[value] && value != 0) continue;
        clear_label(&labels->label[place], value);
        for (int w = 0; w < workers; w++) clear_label(&r->found[w * labels->count + place], value);
        r->place[value] = (uint16_t)place++;
    }
    return ISO_OK;
}

static iso_status check_values(const reading *r, iso_error *error) {
    for (int z = 0; z < r->labels->dims[2]; z++)
        if (!isnan(r->bad[z]))
            return iso_fail(error, ISO_ERR_FORMAT,
                            "not a segmentation: labels are whole numbers from 0 to %d, and a voxel is %g",
                            ISO_LABEL_VALUE_MAX, r->bad[z]);
    return ISO_OK;
}

static iso_status read_labels(reading *r, iso_pool *pool, const iso_label_parts *keep,
                              iso_components_totals *totals, iso_error *error) {
    iso_labels *labels = r->labels;
    const int workers = iso_pool_threads(pool);
    const size_t slices = (size_t)labels->dims[2];
    size_t count = (size_t)labels->dims[0] * (size_t)labels->dims[1] * slices;
    labels->number = iso_alloc(count * sizeof *labels->number);
    r->present = iso_alloc_zero((size_t)workers, VALUES);
    r->bad = iso_alloc(slices * sizeof *r->bad);
    r->place = iso_alloc_zero(VALUES, sizeof *r->place);
    if (!labels->number || !r->present || !r->bad || !r->place)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    iso_parallel_for(pool, slices, read_slice, r);
    ISO_TRY(check_values(r, error));
    if (keep) ISO_TRY(drop_parts(r, keep, totals, workers, error));
    ISO_TRY(list_labels(r, workers, error));
    iso_parallel_for(pool, slices, number_slice, r);
    for (int i = 0; i < labels->count; i++)
        for (int w = 0; w < workers; w++)
            unite(&labels->label[i], &r->found[(size_t)w * (size_t)labels->count + (size_t)i]);
    return ISO_OK;
}

iso_status iso_labels_make(const iso_grid *grid, iso_pool *pool, const iso_label_parts *keep,
                           iso_labels *labels, iso_components_totals *totals, iso_error *error) {
    *labels = (iso_labels){.transform = *iso_grid_transform(grid)};
    if (!grid->rgrid)
        return iso_fail(error, ISO_ERR_FORMAT, "not a segmentation: a sparse grid of distances");
    memcpy(labels->dims, grid->rgrid->dims, sizeof labels->dims);
    reading r = {.grid = grid, .labels = labels};
    const iso_status status = read_labels(&r, pool, keep, totals, error);
    iso_free(r.present);
    iso_free(r.bad);
    iso_free(r.place);
    iso_free(r.found);
    if (status != ISO_OK) iso_labels_free(labels);
    return status;
}

void iso_labels_free(iso_labels *labels) {
    iso_free(labels->number);
    iso_free(labels->label);
    *labels = (iso_labels){0};
}

int iso_labels_find(const iso_labels *labels, int value) {
    int lo = 0, hi = labels->count - 1;
    while (lo <= hi) {
        const int middle = (lo + hi) / 2;
        if (labels->label[middle].value == value) return middle;
        if (labels->label[middle].value < value)
            lo = middle + 1;
        else
            hi = middle - 1;
    }
    return -1;
}

void iso_labels_join(iso_labels *labels, const uint8_t *group, int to) {
    const size_t count = (size_t)labels->dims[0] * (size_t)labels->dims[1] * (size_t)labels->dims[2];
    for (size_t i = 0; i < count; i++) labels->number[i] = group[labels->number[i]] ? (uint16_t)to : 0;
}

/* ---- contacts */

/* A set of pairs: open addressing; 0 is an empty slot, as (0, 0) is no pair of it. */
typedef struct pair_set {
    uint32_t *slot;
    size_t size, count; /* size: a power of 2 */
} pair_set;

static size_t slot_of(const pair_set *set, uint32_t pair) {
    size_t i = (pair * 2654435761u) & (set->size - 1);
    while (set->slot[i] && set->slot[i] != pair) i = (i + 1) & (set->size - 1);
    return i;
}

static bool grow(pair_set *set) {
    const pair_set old = *set;
    set->size = old.size ? 2 * old.size : 1024;
    set->slot = iso_alloc_zero(set->size, sizeof *set->slot);
    for (size_t i = 0; set->slot && i < old.size; i++)
        if (old.slot[i]) set->slot[slot_of(set, old.slot[i])] = old.slot[i];
    iso_free(old.slot);
    return set->slot;
}

static bool add_pair(pair_set *set, int a, int b) {
    if (a == b || !a || !b) return true;
    const uint32_t pair = a < b ? (uint32_t)a << 16 | (uint32_t)b : (uint32_t)b << 16 | (uint32_t)a;
    if (2 * set->count >= set->size && !grow(set)) return false;
    const size_t i = slot_of(set, pair);
    set->count += !set->slot[i];
    set->slot[i] = pair;
    return true;
}

static bool add_row(const iso_labels *labels, int y, int z, pair_set *set) {
    const uint16_t *row = row_of(labels, y, z), *below = y ? row_of(labels, y - 1, z) : row,
                   *behind = z ? row_of(labels, y, z - 1) : row;
    uint16_t before = row[0];
    for (int x = 0; x < labels->dims[0]; x++) {
        if (row[x] == before && row[x] == below[x] && row[x] == behind[x]) continue;
        if (!add_pair(set, row[x], before) || !add_pair(set, row[x], below[x]) ||
            !add_pair(set, row[x], behind[x]))
            return false;
        before = row[x];
    }
    return true;
}

static int compare_pairs(const void *a, const void *b) {
    const uint16_t *p = a, *q = b;
    return p[0] != q[0] ? p[0] - q[0] : p[1] - q[1];
}

iso_status iso_labels_contacts(const iso_labels *labels, iso_label_contacts *contacts, iso_error *error) {
    pair_set set = {NULL, 0, 0};
    bool fits = true;
    *contacts = (iso_label_contacts){NULL, 0};
    for (int z = 0; z < labels->dims[2] && fits; z++)
        for (int y = 0; y < labels->dims[1] && fits; y++) fits = add_row(labels, y, z, &set);
    if (fits && set.count) {
        contacts->pair = iso_alloc(set.count * sizeof *contacts->pair);
        fits = contacts->pair != NULL;
        for (size_t i = 0; fits && i < set.size; i++) {
            if (!set.slot[i]) continue;
            contacts->pair[contacts->count][0] = (uint16_t)(set.slot[i] >> 16);
            contacts->pair[contacts->count++][1] = (uint16_t)set.slot[i];
        }
        if (fits) qsort(contacts->pair, contacts->count, sizeof *contacts->pair, compare_pairs);
    }
    iso_free(set.slot);
    return fits ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
}

void iso_label_contacts_free(iso_label_contacts *contacts) {
    iso_free(contacts->pair);
    *contacts = (iso_label_contacts){NULL, 0};
}
