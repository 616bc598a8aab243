/* Finds the parts of labels as runs of voxels along x, joined by union-find (as grids/parts/component_runs.h
 * does it for solids), and drops those that are too small. */
#include "grids/labels/label_parts.h"

#include <stdlib.h>

#include "base/disjoint_sets.h"
#include "base/memory.h"

/* Voxels first .. end - 1 of a row. */
typedef struct run {
    int32_t first, end;
} run;

/* A part: its label, its size and its first run. */
typedef struct part {
    uint16_t number;
    uint32_t run;
    uint64_t voxels;
} part;

typedef struct parts {
    const iso_labels *labels;
    run *runs;        /* of all voxels but the background */
    uint32_t *row;    /* by row: its first run; one more entry for the end */
    uint32_t *parent; /* by run */
    part *part;       /* by label, the largest first, of equal ones the one that begins first */
    size_t count;
} parts;

static size_t row_count(const iso_labels *labels) {
    return (size_t)labels->dims[1] * (size_t)labels->dims[2];
}

static uint16_t *row_at(const iso_labels *labels, size_t row) {
    return labels->number + row * (size_t)labels->dims[0];
}

/* Lists the runs if there is room for them, and finds the first of each row. Returns their number. */
static size_t find_runs(parts *p) {
    const int n = p->labels->dims[0];
    size_t count = 0;
    for (size_t r = 0; r < row_count(p->labels); r++) {
        const uint16_t *row = row_at(p->labels, r);
        p->row[r] = (uint32_t)count;
        for (int x = 0, end; x < n; x = end) {
            end = iso_label_run_end(row, x, n);
            if (!row[x]) continue;
            if (p->runs) p->runs[count] = (run){x, end};
            count++;
        }
    }
    p->row[row_count(p->labels)] = (uint32_t)count;
    return count;
}

/* Joins the runs of two rows that touch and have the same label. */
static void join_rows(parts *p, size_t a, size_t b) {
    const run *runs = p->runs;
    const uint16_t *row_a = row_at(p->labels, a), *row_b = row_at(p->labels, b);
    for (uint32_t i = p->row[a], k = p->row[b]; i < p->row[a + 1] && k < p->row[b + 1];) {
        const bool meet = runs[i].first < runs[k].end && runs[k].first < runs[i].end;
        if (meet && row_a[runs[i].first] == row_b[runs[k].first]) iso_set_unite(p->parent, i, k);
        if (runs[i].end < runs[k].end)
            i++;
        else
            k++;
    }
}

static int compare_parts(const void *a, const void *b) {
    const part *p = a, *q = b;
    if (p->number != q->number) return p->number < q->number ? -1 : 1;
    if (p->voxels != q->voxels) return p->voxels > q->voxels ? -1 : 1;
    return p->run < q->run ? -1 : p->run > q->run;
}

static iso_status list_parts(parts *p, iso_error *error) {
    const run *runs = p->runs;
    const size_t rows = row_count(p->labels), count = p->row[rows];
    uint64_t *voxels = iso_alloc_zero(count + 1, sizeof *voxels);
    for (size_t i = 0; voxels && i < count; i++) {
        const uint32_t root = iso_set_root(p->parent, (uint32_t)i);
        p->count += root == i;
        voxels[root] += (uint64_t)(runs[i].end - runs[i].first);
    }
    p->part = iso_alloc((p->count + 1) * sizeof *p->part);
    if (!voxels || !p->part) {
        iso_free(voxels);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for parts of labels");
    }
    p->count = 0;
    for (size_t r = 0; r < rows; r++)
        for (uint32_t i = p->row[r]; i < p->row[r + 1]; i++)
            if (p->parent[i] == i)
                p->part[p->count++] = (part){row_at(p->labels, r)[runs[i].first], i, voxels[i]};
    iso_free(voxels);
    qsort(p->part, p->count, sizeof *p->part, compare_parts);
    return ISO_OK;
}

/* Points the parents of dropped parts nowhere: at the number of runs. */
static iso_status choose(parts *p, const iso_label_parts *keep, iso_components_totals *totals,
                         iso_error *error) {
    const double *spacing = p->labels->transform.spacing, voxel = spacing[0] * spacing[1] * spacing[2];
    uint64_t largest = 0, rank = 0;
    *totals = (iso_components_totals){0};
    for (size_t i = 0; i < p->count; i++) {
        const part *it = &p->part[i];
        rank = i && it->number == p->part[i - 1].number ? rank + 1 : 0;
        if (it->voxels > largest) largest = it->voxels;
        if ((!keep->largest || rank < keep->largest) && (double)it->voxels * voxel >= keep->min_volume) {
            totals->kept++;
            totals->kept_voxels += it->voxels;
        } else {
            totals->dropped++;
            totals->dropped_voxels += it->voxels;
            p->parent[it->run] = p->row[row_count(p->labels)];
        }
    }
    totals->kept_volume = (double)totals->kept_voxels * voxel;
    totals->dropped_volume = (double)totals->dropped_voxels * voxel;
    if (totals->dropped)
        totals->dropped_share = totals->dropped_volume / (totals->kept_volume + totals->dropped_volume);
    if (p->count && !totals->kept)
        return iso_fail(error, ISO_ERR_EMPTY, "no part of a label has %g mm3: the largest of %zu has %g",
                        keep->min_volume, p->count, (double)largest * voxel);
    return ISO_OK;
}

static void drop_runs(parts *p) {
    const run *runs = p->runs;
    const uint32_t dropped = p->row[row_count(p->labels)];
    for (size_t r = 0; r < row_count(p->labels); r++)
        for (uint32_t i = p->row[r]; i < p->row[r + 1]; i++)
            if (iso_set_root(p->parent, i) == dropped)
                iso_label_fill(row_at(p->labels, r), runs[i].first, runs[i].end, 0);
}

static iso_status drop(parts *p, const iso_label_parts *keep, iso_components_totals *totals,
                       iso_error *error) {
    const size_t height = (size_t)p->labels->dims[1], rows = row_count(p->labels);
    p->row = iso_alloc((rows + 1) * sizeof *p->row);
    if (!p->row) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for parts of labels");
    const size_t count = find_runs(p);
    if (count > UINT32_MAX - 1) return iso_fail(error, ISO_ERR_LIMIT, "labels have too many parts");
    p->runs = iso_alloc((count + 1) * sizeof *p->runs);
    p->parent = iso_alloc((count + 1) * sizeof *p->parent);
    if (!p->runs || !p->parent) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for parts of labels");
    find_runs(p);
    for (size_t i = 0; i <= count; i++) p->parent[i] = (uint32_t)i;
    for (size_t r = 0; r < rows; r++) {
        if (r % height) join_rows(p, r, r - 1);
        if (r >= height) join_rows(p, r, r - height);
    }
    ISO_TRY(list_parts(p, error));
    ISO_TRY(choose(p, keep, totals, error));
    drop_runs(p);
    return ISO_OK;
}

iso_status iso_label_parts_drop(iso_labels *labels, const iso_label_parts *keep,
                                iso_components_totals *totals, iso_error *error) {
    parts p = {.labels = labels};
    const iso_status status = drop(&p, keep, totals, error);
    iso_free(p.runs);
    iso_free(p.row);
    iso_free(p.parent);
    iso_free(p.part);
    return status;
}
