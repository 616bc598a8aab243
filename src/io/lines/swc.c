/* swc: neurons as trees (Cannon et al. 1998; the columns as in the SWC+ specification, neuroinformatics.nl):
 * a row for each node with its number, type, x y z, radius and the number of its parent, or -1 if it has
 * none. Lines run from branch to branch; roots and tips count as branches. A node without parent and children
 * is a line of one vertex.
 *
 * Nodes may be in any order. A node whose parent is missing becomes a root, which is reported. A number that
 * two nodes share, or a node that is its own ancestor, makes the file invalid.
 *
 * A soma of three points, as NeuroMorpho.org writes a sphere of the same surface (the root, and two children
 * at the distance of its radius on opposite sides; all of type 1 and of one radius), becomes a sphere: its
 * points move to the root. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/common/rows.h"
#include "io/lines/lines_format.h"
#include "io/polydata/polydata.h"

enum { ROW = 7 };

typedef struct node {
    int64_t number, parent;
    uint32_t point;
    uint32_t parent_point; /* UINT32_MAX: none */
} node;

typedef struct swc {
    iso_text_rows rows;
    iso_polydata data;
    iso_buffer nodes, edges, walks, families;
    int radius, type; /* columns */
} swc;

/* ---- rows */

static bool to_whole(double number, int64_t *whole) {
    if (!(number >= -1 && number <= 9e15)) return false;
    *whole = (int64_t)number;
    return (double)*whole == number;
}

static iso_status take_row(swc *s, char *row, iso_error *error) {
    double numbers[ROW];
    const size_t at = s->data.point_count;
    if (iso_row_has_decimal_commas(row)) iso_row_turn_commas(row);
    for (int i = 0; i < ROW; i++)
        if (!iso_row_number(&row, ",", &numbers[i]))
            return iso_text_rows_fail(&s->rows, "not the seven numbers of a node", error);
    ISO_TRY(iso_reading_reserve(s->data.reading, &s->nodes, at + 1, sizeof(node), at, error));
    node *n = (node *)s->nodes.data + at;
    *n = (node){.point = (uint32_t)at, .parent_point = UINT32_MAX};
    if (!to_whole(numbers[0], &n->number) || n->number < 0)
        return iso_text_rows_fail(&s->rows, "the number of a node is not possible", error);
    if (!to_whole(numbers[6], &n->parent))
        return iso_text_rows_fail(&s->rows, "the parent of a node is not possible", error);
    ISO_TRY(iso_polydata_reserve(&s->data, at + 1, error));
    ((float *)iso_polydata_column(&s->data, s->type)->values.data)[at] = (float)numbers[1];
    ((float *)iso_polydata_column(&s->data, s->radius)->values.data)[at] = (float)numbers[5];
    iso_polydata_add_point(&s->data, numbers + 2);
    return ISO_OK;
}

static iso_status read_rows(swc *s, iso_error *error) {
    ISO_TRY(iso_text_rows_load(s->data.reading, &s->rows, error));
    ISO_TRY(iso_polydata_add_column(&s->data, "radius", 1, false, ISO_ROLE_RADIUS, &s->radius, error));
    ISO_TRY(iso_polydata_add_column(&s->data, "type", 1, false, ISO_ROLE_NONE, &s->type, error));
    for (char *row = iso_text_rows_next(&s->rows); row; row = iso_text_rows_next(&s->rows)) {
        while (*row == ' ' || *row == '\t') row++;
        if (*row && *row != '#') ISO_TRY(take_row(s, row, error));
    }
    return ISO_OK;
}

/* ---- the tree */

static int compare_numbers(const void *left, const void *right) {
    const node *a = left, *b = right;
    return (a->number > b->number) - (a->number < b->number);
}

/* Finds the parents of all nodes, and sorts the nodes by number. */
static iso_status find_parents(swc *s, iso_error *error) {
    node *nodes = s->nodes.data;
    const size_t count = s->data.point_count;
    uint64_t missing = 0;
    if (count) qsort(nodes, count, sizeof *nodes, compare_numbers);
    for (size_t i = 1; i < count; i++)
        if (nodes[i].number == nodes[i - 1].number)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: two nodes have the number %lld",
                            s->data.reading->path, (long long)nodes[i].number);
    for (size_t i = 0; i < count; i++) {
        if (nodes[i].parent < 0) continue;
        const node wanted = {.number = nodes[i].parent};
        const node *parent = bsearch(&wanted, nodes, count, sizeof *nodes, compare_numbers);
        if (parent) nodes[i].parent_point = parent->point;
        missing += !parent;
    }
    if (missing)
        iso_reading_note(s->data.reading, "the parents of %llu nodes are missing: they begin new trees",
                         (unsigned long long)missing);
    return ISO_OK;
}

/* Walks from every node towards its root until it meets a node that a previous walk has visited. If it meets
 * its own trace, there is a cycle. */
static iso_status check_cycles(swc *s, const uint32_t *parents, iso_error *error) {
    const size_t count = s->data.point_count;
    ISO_TRY(iso_reading_reserve(s->data.reading, &s->walks, count + 1, sizeof(uint32_t), 0, error));
    uint32_t *walks = s->walks.data;
    for (size_t i = 0; i < count; i++) walks[i] = UINT32_MAX;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = i;
        for (; at != UINT32_MAX && walks[at] == UINT32_MAX; at = parents[at]) walks[at] = i;
        if (at != UINT32_MAX && walks[at] == i)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: a node is its own ancestor",
                            s->data.reading->path);
    }
    return ISO_OK;
}

/* ---- somata of three points */

/* The children of a node: how many, and of those of type 1 how many and the first two. */
typedef struct family {
    uint32_t children, somatic, first[2];
} family;

static bool is_somatic(const swc *s, size_t point) {
    return ((const float *)iso_polydata_column(&s->data, s->type)->values.data)[point] == 1;
}

/* Whether two points lie on opposite sides of a root, at the distance of its radius, which they have too. */
static bool is_sphere(const swc *s, size_t root, const uint32_t ends[2]) {
    const float(*points)[3] = s->data.points.data,
          *radii = iso_polydata_column(&s->data, s->radius)->values.data;
    const double radius = (double)radii[root], close = 0.02 * radius;
    double square = 0;
    for (int k = 0; k < 3; k++) {
        const double middle = (double)points[root][k], a = (double)points[ends[0]][k] - middle,
                     b = (double)points[ends[1]][k] - middle;
        if (!(fabs(a + b) <= close)) return false;
        square += a * a;
    }
    return fabs(sqrt(square) - radius) <= close && fabs((double)radii[ends[0]] - radius) <= close &&
           fabs((double)radii[ends[1]] - radius) <= close;
}

static void count_children(const swc *s, const uint32_t *parents, family *families) {
    for (size_t i = 0; i < s->data.point_count; i++) {
        if (parents[i] == UINT32_MAX) continue;
        family *f = &families[parents[i]];
        f->children++;
        if (!is_somatic(s, i)) continue;
        if (f->somatic < 2) f->first[f->somatic] = (uint32_t)i;
        f->somatic++;
    }
}

static iso_status gather_somata(swc *s, const uint32_t *parents, iso_error *error) {
    const size_t count = s->data.point_count;
    float(*points)[3] = s->data.points.data;
    ISO_TRY(iso_reading_reserve(s->data.reading, &s->families, count + 1, sizeof(family), 0, error));
    family *families = s->families.data;
    size_t spheres = 0;
    for (size_t i = 0; i < count; i++) families[i] = (family){.children = 0};
    count_children(s, parents, families);
    for (size_t i = 0; i < count; i++) {
        const family *f = &families[i];
        if (parents[i] != UINT32_MAX || !is_somatic(s, i) || f->somatic != 2 ||
            families[f->first[0]].children || families[f->first[1]].children || !is_sphere(s, i, f->first))
            continue;
        for (int k = 0; k < 2; k++) memcpy(points[f->first[k]], points[i], sizeof points[i]);
        spheres++;
    }
    if (spheres)
        iso_reading_note(s->data.reading, "somata of three points, which are drawn as spheres: %zu", spheres);
    return ISO_OK;
}

/* ---- edges */

/* Adds an edge for every node with a parent, in the order of the file. */
static iso_status add_edges(swc *s, iso_error *error) {
    const size_t count = s->data.point_count;
    const node *nodes = s->nodes.data;
    ISO_TRY(iso_reading_reserve(s->data.reading, &s->edges, count + 1, 3 * sizeof(uint32_t), 0, error));
    uint32_t(*edges)[2] = s->edges.data, *parents = (uint32_t *)s->edges.data + 2 * count;
    for (size_t i = 0; i < count; i++) parents[nodes[i].point] = nodes[i].parent_point;
    ISO_TRY(check_cycles(s, parents, error));
    ISO_TRY(gather_somata(s, parents, error));
    size_t made = 0;
    for (size_t i = 0; i < count; i++) {
        if (parents[i] == UINT32_MAX) continue;
        edges[made][0] = parents[i];
        edges[made++][1] = (uint32_t)i;
    }
    return iso_polydata_add_edges(&s->data, (const uint32_t(*)[2])edges, made, true, error);
}

static iso_status read_swc(swc *s, iso_lines *lines, iso_error *error) {
    s->data.reading->report->unit = ISO_WORLD_UNIT_MICROMETRE;
    ISO_TRY(read_rows(s, error));
    ISO_TRY(find_parents(s, error));
    ISO_TRY(add_edges(s, error));
    return iso_polydata_to_lines(&s->data, lines, error);
}

iso_status iso_lines_read_swc(iso_reading *reading, iso_lines *lines, iso_error *error) {
    swc s = {.data = {.reading = reading}};
    iso_status status = read_swc(&s, lines, error);
    iso_text_rows_free(&s.rows);
    iso_buffer_free(&s.nodes);
    iso_buffer_free(&s.edges);
    iso_buffer_free(&s.walks);
    iso_buffer_free(&s.families);
    iso_polydata_free(&s.data);
    return status;
}
