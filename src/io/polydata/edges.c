/* edges: joins the edges of a graph to polylines, so that tubes have joints and few ends. */
#include "io/polydata/polydata.h"

typedef struct graph {
    iso_polydata *data;
    const uint32_t (*edges)[2];
    size_t edge_count;
    iso_buffer first_buffer, incident_buffer, used_buffer;
    size_t *first;    /* point i has the edges incident[first[i]] .. incident[first[i + 1] - 1] */
    size_t *incident; /* numbers of edges */
    uint8_t *used;    /* for each edge: it is part of a line */
} graph;

static size_t degree(const graph *g, uint32_t point) {
    return g->first[point + 1] - g->first[point];
}

/* Lists the edges of every point: a counting sort. */
static void list_edges(graph *g, size_t points) {
    for (size_t i = 0; i <= points; i++) g->first[i] = 0;
    for (size_t i = 0; i < 2 * g->edge_count; i++) g->first[g->edges[i / 2][i % 2]]++;
    size_t total = 0;
    for (size_t i = 0; i <= points; i++) {
        total += g->first[i];
        g->first[i] = total; /* the end of the point's edges; filling from the back moves it to their
                                beginning */
    }
    for (size_t i = 2 * g->edge_count; i-- > 0;) g->incident[--g->first[g->edges[i / 2][i % 2]]] = i / 2;
    for (size_t i = 0; i < g->edge_count; i++) g->used[i] = 0;
}

/* Adds the line that begins with `edge` at the point `from` and continues as long as points have two
 * edges. */
static iso_status add_line(graph *g, size_t edge, uint32_t from, iso_error *error) {
    ISO_TRY(iso_polydata_add_index(g->data, from, error));
    for (;;) {
        const uint32_t *ends = g->edges[edge], to = ends[0] == from ? ends[1] : ends[0];
        g->used[edge] = 1;
        ISO_TRY(iso_polydata_add_index(g->data, to, error));
        if (degree(g, to) != 2) break;
        const size_t *pair = &g->incident[g->first[to]], next = g->used[pair[0]] ? pair[1] : pair[0];
        if (g->used[next]) break;
        edge = next;
        from = to;
    }
    return iso_polydata_end_line(g->data, error);
}

/* Adds the lines that begin with an unused edge, in the edge's direction. With `ends_only`, only lines that
 * begin at a point with one edge or more than two. */
static iso_status add_lines(graph *g, bool ends_only, iso_error *error) {
    for (size_t i = 0; i < g->edge_count; i++) {
        const uint32_t from = g->edges[i][0];
        if (g->used[i] || (ends_only && degree(g, from) == 2)) continue;
        ISO_TRY(add_line(g, i, from, error));
    }
    return ISO_OK;
}

/* Adds the remaining lines with ends, which begin against the direction of their first edge. */
static iso_status add_reversed(graph *g, iso_error *error) {
    for (size_t i = 0; i < g->edge_count; i++) {
        const uint32_t from = g->edges[i][1];
        if (!g->used[i] && degree(g, from) != 2) ISO_TRY(add_line(g, i, from, error));
    }
    return ISO_OK;
}

static iso_status add_singles(graph *g, size_t points, iso_error *error) {
    for (size_t i = 0; i < points; i++) {
        if (degree(g, (uint32_t)i) > 0) continue;
        ISO_TRY(iso_polydata_add_index(g->data, (uint32_t)i, error));
        ISO_TRY(iso_polydata_end_line(g->data, error));
    }
    return ISO_OK;
}

static iso_status join(graph *g, bool singles, iso_error *error) {
    iso_reading *reading = g->data->reading;
    const size_t points = g->data->point_count;
    ISO_TRY(iso_reading_reserve(reading, &g->first_buffer, points + 1, sizeof(size_t), 0, error));
    ISO_TRY(
        iso_reading_reserve(reading, &g->incident_buffer, 2 * g->edge_count + 1, sizeof(size_t), 0, error));
    ISO_TRY(iso_reading_reserve(reading, &g->used_buffer, g->edge_count + 1, 1, 0, error));
    g->first = g->first_buffer.data;
    g->incident = g->incident_buffer.data;
    g->used = g->used_buffer.data;
    list_edges(g, points);
    ISO_TRY(add_lines(g, true, error));
    ISO_TRY(add_reversed(g, error));
    ISO_TRY(add_lines(g, false, error)); /* only closed lines are left */
    return singles ? add_singles(g, points, error) : ISO_OK;
}

iso_status iso_polydata_add_edges(iso_polydata *data, const uint32_t (*edges)[2], size_t count, bool singles,
                                  iso_error *error) {
    for (size_t i = 0; i < 2 * count; i++)
        if (edges[i / 2][i % 2] >= data->point_count)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: an edge names point %u of %zu",
                            data->reading->path, edges[i / 2][i % 2], data->point_count);
    if (!count && !singles) return ISO_OK;
    graph g = {.data = data, .edges = edges, .edge_count = count};
    iso_status status = join(&g, singles, error);
    iso_reading_free(data->reading, &g.first_buffer);
    iso_reading_free(data->reading, &g.incident_buffer);
    iso_reading_free(data->reading, &g.used_buffer);
    return status;
}
