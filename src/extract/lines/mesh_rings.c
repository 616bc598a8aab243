/* mesh_rings: pieces by union-find, rings by breadth-first search from the end of each piece. */
#include "extract/lines/mesh_rings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/disjoint_sets.h"
#include "base/memory.h"
#include "base/numbers.h"

static const uint32_t NONE = UINT32_MAX;
/* A piece with one outline is a sheet if its triangles face one way: by so much of its area at least. */
static const double FLAT = 0.7;
/* A triangle's edge joins two vertices of one ring for certain if the other two are so many times as long. */
static const double ELONGATED = 1.6;

/* Rings cross each other if their vertices' mean distance from the ring's middle, along the branch, is
 * so many times the distance of neighbouring rings. */
static const double CROSSING = 0.35;

/* What is needed while rings are made. Vertices from mesh->vertex_count on are lids. */
typedef struct making {
    iso_mesh_rings *made;
    const iso_triangles *mesh;
    size_t vertices, lids;
    uint32_t *parent; /* disjoint sets of vertices */
    uint32_t *lid;    /* of each vertex: the lid of its loop, or NONE */
    uint32_t *next;   /* of each vertex: the next one that certainly is of the same ring, in a circle */
    int32_t *level;   /* of each vertex and lid: edges from the end of the piece; -1: not seen */
    uint32_t *order;  /* vertices and lids as they were found: piece after piece, level after level */
    size_t ordered;
    uint64_t *pairs;
    size_t pair_count;
    iso_mesh_distances distances;
} making;

iso_vec3 iso_mesh_triangle_area(const iso_triangles *mesh, size_t triangle) {
    const uint32_t *t = mesh->triangles[triangle];
    const iso_vec3 a = iso_mesh_vertex(mesh, t[0]);
    return iso_vec3_scale(iso_vec3_cross(iso_vec3_sub(iso_mesh_vertex(mesh, t[1]), a),
                                         iso_vec3_sub(iso_mesh_vertex(mesh, t[2]), a)),
                          0.5);
}

static void reset_sets(making *m) {
    for (size_t i = 0; i < m->vertices; i++) m->parent[i] = (uint32_t)i;
}

/* ---- pieces */

static iso_status number_pieces(making *m, iso_error *error) {
    iso_mesh_rings *made = m->made;
    const iso_triangles *mesh = m->mesh;
    reset_sets(m);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        iso_set_unite(m->parent, mesh->triangles[i][0], mesh->triangles[i][1]);
        iso_set_unite(m->parent, mesh->triangles[i][0], mesh->triangles[i][2]);
    }
    for (size_t i = 0; i < m->vertices; i++) {
        const uint32_t root = iso_set_root(m->parent, (uint32_t)i);
        made->piece[i] = root == i ? (uint32_t)made->piece_count++ : made->piece[root];
    }
    made->pieces = iso_alloc_zero(made->piece_count, sizeof *made->pieces);
    made->first_ring = iso_alloc_zero(made->piece_count + 1, sizeof *made->first_ring);
    return made->pieces && made->first_ring ? ISO_OK : iso_fail_memory(error, "lines of a mesh");
}

static void measure_pieces(making *m) {
    iso_mesh_rings *made = m->made;
    const iso_mesh_topology *topology = made->topology;
    for (size_t i = 0; i < topology->open_count; i++) {
        made->pieces[made->piece[topology->open[i][0]]].open_edges++;
        made->open[topology->open[i][0]] = made->open[topology->open[i][1]] = true;
    }
    for (size_t i = 0; i < topology->loops; i++)
        made->pieces[made->piece[topology->loop_vertices[topology->loop_first[i]]]].loops++;
    for (size_t i = 0; i < m->vertices; i++) {
        iso_mesh_piece *piece = &made->pieces[made->piece[i]];
        piece->vertices++;
        piece->outline += made->open[i];
    }
    for (size_t i = 0; i < m->mesh->triangle_count; i++) {
        iso_mesh_piece *piece = &made->pieces[made->piece[m->mesh->triangles[i][0]]];
        const iso_vec3 normal = iso_mesh_triangle_area(m->mesh, i);
        piece->triangles++;
        piece->facing = iso_vec3_add(piece->facing, normal);
        piece->area += iso_vec3_length(normal);
    }
    for (size_t i = 0; i < made->piece_count; i++) {
        iso_mesh_piece *piece = &made->pieces[i];
        /* twice the Euler characteristic; edges: half of the triangles' sides and of the open ones */
        const long long twice = 2 * (long long)piece->vertices + 2 * (long long)piece->triangles -
                                (3 * (long long)piece->triangles + (long long)piece->open_edges);
        piece->sheet =
            twice == 2 && piece->loops == 1 &&
            (piece->outline == piece->vertices || iso_vec3_length(piece->facing) >= FLAT * piece->area);
    }
}

static void set_lids(making *m) {
    const iso_mesh_topology *topology = m->made->topology;
    memset(m->lid, 0xff, m->vertices * sizeof *m->lid);
    for (size_t i = 0; i < m->lids; i++)
        for (size_t k = topology->loop_first[i]; k < topology->loop_first[i + 1]; k++) {
            const uint32_t v = topology->loop_vertices[k];
            if (!m->made->pieces[m->made->piece[v]].sheet) m->lid[v] = (uint32_t)(m->vertices + i);
        }
}

/* ---- triangles around vertices */

static void list_triangles(making *m) {
    iso_mesh_rings *made = m->made;
    size_t *first = made->around_first;
    for (size_t i = 0; i < m->mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++) first[m->mesh->triangles[i][k] + 1]++;
    for (size_t i = 0; i < m->vertices; i++) first[i + 1] += first[i];
    for (size_t i = m->mesh->triangle_count;
         i-- > 0;) /* first[v + 1] moves down to where the list of v begins, */
        for (int k = 0; k < 3; k++) made->around[--first[m->mesh->triangles[i][k] + 1]] = (uint32_t)i;
    for (size_t i = 0; i < m->vertices; i++) first[i] = first[i + 1]; /* which belongs one place lower */
    first[m->vertices] = 3 * m->mesh->triangle_count;
}

/* ---- vertices that certainly are of one ring */

static int compare_pairs(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void add_pair(making *m, uint32_t a, uint32_t b) {
    m->pairs[m->pair_count++] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Leaves each pair once. */
static void sort_pairs(making *m) {
    size_t kept = 0;
    qsort(m->pairs, m->pair_count, sizeof *m->pairs, compare_pairs);
    for (size_t i = 0; i < m->pair_count; i++)
        if (!kept || m->pairs[kept - 1] != m->pairs[i]) m->pairs[kept++] = m->pairs[i];
    m->pair_count = kept;
}

static void add_short_edge(making *m, const uint32_t triangle[3]) {
    double square[3];
    for (int k = 0; k < 3; k++) {
        const iso_vec3 side = iso_vec3_sub(iso_mesh_vertex(m->mesh, triangle[(k + 1) % 3]),
                                           iso_mesh_vertex(m->mesh, triangle[k]));
        square[k] = iso_vec3_dot(side, side);
    }
    for (int k = 0; k < 3; k++)
        if (ELONGATED * ELONGATED * square[k] <= iso_min(square[(k + 1) % 3], square[(k + 2) % 3]))
            add_pair(m, triangle[k], triangle[(k + 1) % 3]);
}

/* Joins the vertices of closed chains of short edges between elongated triangles in circles. An open
 * chain does not go around a branch. `edges`: room for a number of each vertex, all 0. */
static void join_rings(making *m, uint32_t *edges) {
    m->pair_count = 0;
    reset_sets(m);
    for (size_t i = 0; i < m->mesh->triangle_count; i++) add_short_edge(m, m->mesh->triangles[i]);
    sort_pairs(m);
    for (size_t i = 0; i < m->pair_count; i++)
        iso_set_unite(m->parent, (uint32_t)(m->pairs[i] >> 32), (uint32_t)m->pairs[i]);
    for (size_t i = 0; i < m->vertices; i++) m->next[i] = (uint32_t)i;
    for (size_t i = 0; i < m->pair_count; i++) edges[iso_set_root(m->parent, (uint32_t)m->pairs[i])]++;
    for (size_t i = 0; i < m->vertices; i++) /* edges less vertices: not negative in a closed chain */
        edges[iso_set_root(m->parent, (uint32_t)i)]--;
    for (size_t i = 0; i < m->vertices; i++) {
        const uint32_t root = iso_set_root(m->parent, (uint32_t)i);
        if (root == i || (int32_t)edges[root] < 0 || m->made->pieces[m->made->piece[i]].sheet) continue;
        m->next[i] = m->next[root];
        m->next[root] = (uint32_t)i;
    }
}

/* ---- levels */

/* Gives a vertex or lid, and what is certainly of the same ring, a level, unless it has one. */
static void visit(making *m, uint32_t v, int32_t level) {
    uint32_t at = v;
    if (m->level[v] >= 0) return;
    do {
        m->level[at] = level;
        m->order[m->ordered++] = at;
        at = at < m->vertices ? m->next[at] : v;
    } while (at != v);
}

static void visit_around(making *m, uint32_t v) {
    const iso_mesh_rings *made = m->made;
    const int32_t level = m->level[v] + 1;
    if (v >= m->vertices) {
        const iso_mesh_topology *topology = made->topology;
        const size_t loop = v - m->vertices;
        for (size_t k = topology->loop_first[loop]; k < topology->loop_first[loop + 1]; k++)
            visit(m, topology->loop_vertices[k], level);
        return;
    }
    for (size_t k = made->around_first[v]; k < made->around_first[v + 1]; k++)
        for (int i = 0; i < 3; i++) visit(m, m->mesh->triangles[made->around[k]][i], level);
    if (m->lid[v] != NONE) visit(m, m->lid[v], level);
}

/* Finds all of a piece from `v` on; returns what is farthest away. */
static uint32_t sweep(making *m, uint32_t v) {
    const size_t first = m->ordered;
    visit(m, v, 0);
    for (size_t i = first; i < m->ordered; i++) visit_around(m, m->order[i]);
    return m->order[m->ordered - 1];
}

/* A band of distances that is a ring: at least so wide that edges of the piece do not cross it, but for
 * a few. */
static double band_of(const making *m, const uint32_t *order, size_t count) {
    double sum = 0, squares = 0, edges = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t v = order[i];
        if (v >= m->vertices) continue;
        for (size_t k = m->made->around_first[v]; k < m->made->around_first[v + 1]; k++) {
            const uint32_t *t = m->mesh->triangles[m->made->around[k]];
            for (int j = 0; j < 3; j++) {
                if (t[j] != v) continue;
                const iso_vec3 side =
                    iso_vec3_sub(iso_mesh_vertex(m->mesh, t[(j + 1) % 3]), iso_mesh_vertex(m->mesh, v));
                const double square = iso_vec3_dot(side, side);
                sum += sqrt(square);
                squares += square;
                edges++;
            }
        }
    }
    const double mean = sum / edges;
    return mean + 2 * sqrt(iso_max(squares / edges - mean * mean, 0));
}

/* Levels of a piece by distance; `v` is one of its ends. */
static void set_bands(making *m, uint32_t v) {
    const size_t first = m->ordered;
    uint32_t *order = m->order + first;
    size_t count = iso_mesh_distances_from(&m->distances, v, order);
    const uint32_t end = order[count - 1];
    for (size_t i = 0; i < count; i++) {
        m->distances.distance[order[i]] = INFINITY;
        m->distances.done[order[i]] = false;
    }
    count = iso_mesh_distances_from(&m->distances, end, order);
    const double band = band_of(m, order, count), most = m->distances.distance[order[count - 1]],
                 width = iso_max(band, most / 1e9);
    for (size_t i = 0; i < count; i++)
        m->level[order[i]] = width > 0 ? (int32_t)(m->distances.distance[order[i]] / width) : 0;
    m->ordered += count;
}

/* Levels of all pieces, each from the place that is farthest from its first vertex: an end. */
static void set_levels(making *m) {
    memset(m->level, 0xff, (m->vertices + m->lids) * sizeof *m->level);
    for (size_t i = 0; i < m->vertices; i++) {
        if (m->level[i] >= 0) continue;
        const size_t first = m->ordered;
        const uint32_t end = sweep(m, (uint32_t)i);
        for (size_t k = first; k < m->ordered; k++) m->level[m->order[k]] = -1;
        m->ordered = first;
        if (m->made->pieces[m->made->piece[i]].by_distance)
            set_bands(m, end);
        else
            sweep(m, end);
    }
}

/* ---- rings */

/* Unites vertices of the same level that an edge joins, and numbers these sets in the order in which
 * they were found. Returns how many there are, with lids. */
static size_t number_rings(making *m, uint32_t *number) {
    const iso_triangles *mesh = m->mesh;
    size_t count = 0;
    reset_sets(m);
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t a = mesh->triangles[i][k], b = mesh->triangles[i][(k + 1) % 3];
            if (m->level[a] == m->level[b]) iso_set_unite(m->parent, a, b);
        }
    memset(number, 0xff, (m->vertices + m->lids) * sizeof *number);
    for (size_t i = 0; i < m->ordered; i++) {
        const uint32_t v = m->order[i], root = v < m->vertices ? iso_set_root(m->parent, v) : v;
        if (number[root] == NONE) number[root] = (uint32_t)count++;
        number[v] = number[root];
    }
    return count;
}

static void measure_ring(const making *m, iso_mesh_ring *ring, const uint32_t *vertices, size_t count) {
    iso_vec3 sum = {0, 0, 0};
    for (size_t i = 0; i < count; i++) sum = iso_vec3_add(sum, iso_mesh_vertex(m->mesh, vertices[i]));
    ring->at = iso_vec3_scale(sum, 1.0 / (double)count);
    for (size_t i = 0; i < count; i++) {
        const double distance =
            iso_vec3_length(iso_vec3_sub(iso_mesh_vertex(m->mesh, vertices[i]), ring->at));
        ring->radius += distance / (double)count;
        ring->reach = iso_max(ring->reach, distance);
    }
}

/* Sorts vertices by their rings, and measures these. number: of the ring of each vertex and lid. */
static void fill_rings(making *m, const uint32_t *number) {
    iso_mesh_rings *made = m->made;
    const iso_mesh_topology *topology = made->topology;
    for (size_t i = 0; i < m->vertices; i++) made->rings[number[i]].count++;
    for (size_t i = 0, first = 0; i < made->ring_count; i++) {
        made->rings[i].first = (uint32_t)first;
        first += made->rings[i].count;
        made->rings[i].count = 0;
    }
    for (size_t i = 0; i < m->vertices; i++) {
        iso_mesh_ring *ring = &made->rings[number[i]];
        made->ring[i] = number[i];
        ring->piece = made->piece[i];
        made->members[ring->first + ring->count++] = (uint32_t)i;
    }
    for (size_t i = 0; i < m->lids; i++) {
        const uint32_t *loop = topology->loop_vertices + topology->loop_first[i];
        if (number[m->vertices + i] == NONE) continue;
        iso_mesh_ring *ring = &made->rings[number[m->vertices + i]];
        ring->lid = true;
        ring->piece = made->piece[loop[0]];
        measure_ring(m, ring, loop, topology->loop_first[i + 1] - topology->loop_first[i]);
    }
    for (size_t i = 0; i < made->ring_count; i++) {
        iso_mesh_ring *ring = &made->rings[i];
        made->first_ring[ring->piece + 1] = i + 1;
        if (!ring->lid) measure_ring(m, ring, made->members + ring->first, ring->count);
    }
}

/* ---- links between rings */

/* Adds a pair of rings, unless it was added for the same edge's other triangle or one beside it. */
static void link_rings(making *m, const uint32_t *number, uint32_t *last, uint32_t a, uint32_t b) {
    const uint32_t low = number[a] < number[b] ? number[a] : number[b], high = number[a] ^ number[b] ^ low;
    if (low == high || last[high] == low) return;
    last[high] = low;
    add_pair(m, low, high);
}

static void collect_links(making *m, const uint32_t *number, uint32_t *last) {
    const iso_triangles *mesh = m->mesh;
    m->pair_count = 0;
    memset(last, 0xff, m->made->ring_count * sizeof *last);
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            link_rings(m, number, last, mesh->triangles[i][k], mesh->triangles[i][(k + 1) % 3]);
    for (size_t i = 0; i < m->vertices; i++)
        if (m->lid[i] != NONE) link_rings(m, number, last, (uint32_t)i, m->lid[i]);
    sort_pairs(m);
}

/* Lists the links of each ring, from low to high. */
static iso_status list_links(making *m, iso_error *error) {
    iso_mesh_rings *made = m->made;
    made->link_first = iso_alloc_zero(made->ring_count + 2, sizeof *made->link_first);
    made->links = iso_alloc((2 * m->pair_count + 1) * sizeof *made->links);
    if (!made->link_first || !made->links) return iso_fail_memory(error, "lines of a mesh");
    size_t *first = made->link_first + 1;
    for (size_t i = 0; i < m->pair_count; i++) {
        first[m->pairs[i] >> 32]++;
        first[(uint32_t)m->pairs[i]]++;
    }
    for (size_t i = 0, sum = 0; i <= made->ring_count; i++) {
        const size_t count = i < made->ring_count ? first[i] : 0;
        first[i] = sum;
        sum += count;
    }
    for (size_t pass = 0; pass < 2; pass++) /* links to lower rings first */
        for (size_t i = 0; i < m->pair_count; i++) {
            const uint32_t low = (uint32_t)(m->pairs[i] >> 32), high = (uint32_t)m->pairs[i];
            if (pass)
                made->links[first[low]++] = high;
            else
                made->links[first[high]++] = low;
        }
    return ISO_OK; /* first[i] has become where the links of ring i + 1 begin, link_first[i] those of i */
}

/* ---- making */

static iso_status reserve(making *m, iso_error *error) {
    iso_mesh_rings *made = m->made;
    const size_t count = m->vertices + m->lids + 1;
    made->piece = iso_alloc(count * sizeof *made->piece);
    made->ring = iso_alloc(count * sizeof *made->ring);
    made->members = iso_alloc(count * sizeof *made->members);
    made->open = iso_alloc_zero(count, sizeof *made->open);
    made->around_first = iso_alloc_zero(count + 1, sizeof *made->around_first);
    made->around = iso_alloc(3 * m->mesh->triangle_count * sizeof *made->around);
    m->parent = iso_alloc(count * sizeof *m->parent);
    m->lid = iso_alloc(count * sizeof *m->lid);
    m->next = iso_alloc(count * sizeof *m->next);
    m->level = iso_alloc(count * sizeof *m->level);
    m->order = iso_alloc(count * sizeof *m->order);
    m->distances = (iso_mesh_distances){.topology = made->topology,
                                        .around_first = made->around_first,
                                        .around = made->around,
                                        .lid = m->lid,
                                        .distance = iso_alloc(count * sizeof *m->distances.distance),
                                        .done = iso_alloc_zero(count, sizeof *m->distances.done),
                                        .heap = iso_alloc(count * sizeof *m->distances.heap),
                                        .heap_at = iso_alloc(count * sizeof *m->distances.heap_at)};
    m->pairs = iso_alloc((3 * m->mesh->triangle_count + count) * sizeof *m->pairs);
    if (made->piece && made->ring && made->members && made->open && made->around_first && made->around &&
        m->parent && m->lid && m->next && m->level && m->order && m->pairs && m->distances.distance &&
        m->distances.done && m->distances.heap && m->distances.heap_at) {
        for (size_t i = 0; i < count; i++) m->distances.distance[i] = INFINITY;
        return ISO_OK;
    }
    return iso_fail_memory(error, "lines of a mesh");
}

static iso_status make(making *m, const bool *by_distance, iso_error *error) {
    iso_mesh_rings *made = m->made;
    uint32_t *number = NULL, *last = NULL;
    ISO_TRY(reserve(m, error));
    ISO_TRY(number_pieces(m, error));
    measure_pieces(m);
    for (size_t i = 0; by_distance && i < made->piece_count; i++)
        made->pieces[i].by_distance = by_distance[i];
    set_lids(m);
    list_triangles(m);
    number = iso_alloc_zero(m->vertices + m->lids + 1, sizeof *number);
    if (!number) return iso_fail_memory(error, "lines of a mesh");
    join_rings(m, number);
    set_levels(m);
    made->ring_count = number_rings(m, number);
    made->rings = iso_alloc_zero(made->ring_count, sizeof *made->rings);
    last = iso_alloc(made->ring_count * sizeof *last);
    iso_status status = made->rings && last ? ISO_OK : iso_fail_memory(error, "lines of a mesh");
    if (status == ISO_OK) {
        fill_rings(m, number);
        collect_links(m, number, last);
        status = list_links(m, error);
    }
    iso_free(number);
    iso_free(last);
    return status;
}

iso_status iso_mesh_rings_make(const iso_mesh_topology *topology, const bool *by_distance,
                               iso_mesh_rings *rings, iso_error *error) {
    making m = {.made = rings,
                .mesh = &topology->mesh,
                .vertices = topology->mesh.vertex_count,
                .lids = topology->loops};
    *rings = (iso_mesh_rings){.topology = topology};
    if (m.vertices + m.lids >= INT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "a mesh of 2^31 vertices or more does not become lines");
    const iso_status status = make(&m, by_distance, error);
    iso_free(m.parent);
    iso_free(m.lid);
    iso_free(m.next);
    iso_free(m.level);
    iso_free(m.order);
    iso_free(m.pairs);
    iso_free(m.distances.distance);
    iso_free(m.distances.done);
    iso_free(m.distances.heap);
    iso_free(m.distances.heap_at);
    if (status != ISO_OK) iso_mesh_rings_free(rings);
    return status;
}

bool iso_mesh_rings_cross(const iso_mesh_rings *rings, size_t piece) {
    const iso_triangles *mesh = &rings->topology->mesh;
    double along = 0, steps = 0; /* of all rings with two neighbours, mm */
    for (size_t i = rings->first_ring[piece]; i < rings->first_ring[piece + 1]; i++) {
        const iso_mesh_ring *ring = &rings->rings[i];
        const size_t first = rings->link_first[i];
        if (rings->link_first[i + 1] != first + 2 || ring->count < 3) continue;
        const iso_vec3 path = iso_vec3_sub(rings->rings[rings->links[first + 1]].at,
                                           rings->rings[rings->links[first]].at),
                       unit = iso_vec3_unit(path);
        double sum = 0;
        for (uint32_t k = 0; k < ring->count; k++)
            sum += fabs(iso_vec3_dot(
                unit, iso_vec3_sub(iso_mesh_vertex(mesh, rings->members[ring->first + k]), ring->at)));
        along += sum / ring->count;
        steps += 0.5 * iso_vec3_length(path);
    }
    return !(along < CROSSING * steps) && rings->first_ring[piece + 1] - rings->first_ring[piece] > 2;
}

void iso_mesh_rings_free(iso_mesh_rings *rings) {
    iso_free(rings->pieces);
    iso_free(rings->rings);
    iso_free(rings->first_ring);
    iso_free(rings->piece);
    iso_free(rings->ring);
    iso_free(rings->members);
    iso_free(rings->open);
    iso_free(rings->around_first);
    iso_free(rings->around);
    iso_free(rings->link_first);
    iso_free(rings->links);
    *rings = (iso_mesh_rings){.topology = NULL};
}
