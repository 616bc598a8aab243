/* Finds the connectivity of a triangle soup: hash tables find equal vertices and equal triangles, sorted
 * half-edges connect triangles into pieces, and walks along open edges find the loops that bound holes. */
#include "grids/closing/mesh_topology.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { MOST_TRIANGLES = 1 << 30, KEY = 12 };
static const uint32_t NONE = ISO_NO_PARTNER;

/* ---- hash tables from keys to numbers */

static uint64_t mix(uint64_t h) { /* the finaliser of MurmurHash3 */
    h = (h ^ h >> 33) * 0xff51afd7ed558ccdu;
    h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53u;
    return h ^ h >> 33;
}

static uint64_t hash_three(const unsigned char *bytes) {
    uint32_t key[3];
    memcpy(key, bytes, sizeof key);
    return mix(mix((uint64_t)key[0] << 32 | key[1]) + key[2]);
}

/* A hash table from keys to their indices. A key has KEY bytes: three 32-bit words. */
typedef struct table {
    uint32_t *slots;
    size_t mask;
} table;

static bool table_make(table *t, size_t count) {
    size_t size = 16;
    while (size < 2 * count) size *= 2;
    t->slots = iso_alloc(size * sizeof *t->slots);
    if (!t->slots) return false;
    memset(t->slots, 0xff, size * sizeof *t->slots);
    t->mask = size - 1;
    return true;
}

/* Returns the number of the first key that is equal to key `number`. If there is none in the table, adds
 * `number` and returns it. `keys` has all keys, one after the other. */
static uint32_t table_find_or_add(table *t, const void *keys, uint32_t number) {
    const unsigned char *bytes = keys, *key = bytes + (size_t)KEY * number;
    size_t at = (size_t)hash_three(key) & t->mask;
    while (t->slots[at] != NONE && memcmp(bytes + (size_t)KEY * t->slots[at], key, KEY) != 0)
        at = (at + 1) & t->mask;
    if (t->slots[at] == NONE) t->slots[at] = number;
    return t->slots[at];
}

/* ---- vertices */

/* Writes each distinct position of `from` once to `to`, and sets joined[i] to the new number of vertex i.
 * Returns false if there is no memory. */
static bool join_vertices(const iso_triangles *from, iso_triangles *to, uint32_t *joined) {
    table t = {0};
    if (!table_make(&t, from->vertex_count)) return false;
    for (size_t i = 0; i < from->vertex_count; i++) {
        float *v = to->vertices[to->vertex_count];
        for (int axis = 0; axis < 3; axis++) v[axis] = from->vertices[i][axis] + 0.0f; /* -0 becomes 0 */
        joined[i] = table_find_or_add(&t, to->vertices, (uint32_t)to->vertex_count);
        to->vertex_count += joined[i] == to->vertex_count;
    }
    iso_free(t.slots);
    return true;
}

/* ---- triangles */

/* Sorts the corners; returns whether that takes an odd number of exchanges. */
static bool sort_corners(const uint32_t t[3], uint32_t sorted[3]) {
    bool odd = false;
    memcpy(sorted, t, 3 * sizeof *t);
    for (int pass = 0; pass < 3; pass++) {
        const int k = pass == 1 ? 1 : 0;
        if (sorted[k] <= sorted[k + 1]) continue;
        const uint32_t held = sorted[k];
        sorted[k] = sorted[k + 1];
        sorted[k + 1] = held;
        odd = !odd;
    }
    return odd;
}

static bool is_degenerate(const uint32_t t[3]) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/* Keeps one of each set of equal triangles, which faces as most of the set do; none if as many face one way
 * as the other. */
static bool remove_copies(iso_triangles *mesh) {
    const size_t count = mesh->triangle_count;
    uint32_t(*keys)[3] = iso_alloc(count * sizeof *keys);
    int32_t *balance =
        iso_alloc_zero(count ? count : 1, sizeof *balance); /* at the first triangle of a set: how many more
                                                               of the set face one way than the other */
    table t = {0};
    const bool whole = keys && balance && table_make(&t, count);
    size_t kept = 0;
    for (size_t i = 0; whole && i < count; i++) {
        const bool odd = sort_corners(mesh->triangles[i], keys[i]);
        const uint32_t first = table_find_or_add(&t, keys, (uint32_t)i);
        balance[first] += odd ? -1 : 1;
    }
    for (size_t i = 0; whole && i < count; i++) {
        if (balance[i] == 0) continue;
        uint32_t sorted[3];
        const bool odd = sort_corners(mesh->triangles[i], sorted);
        memmove(mesh->triangles[kept], mesh->triangles[i], sizeof *mesh->triangles);
        if (odd != (balance[i] < 0)) {
            mesh->triangles[kept][1] = mesh->triangles[i][2];
            mesh->triangles[kept][2] = mesh->triangles[i][1];
        }
        kept++;
    }
    if (whole) mesh->triangle_count = kept;
    iso_free(t.slots);
    iso_free(keys);
    iso_free(balance);
    return whole;
}

static bool join_triangles(const iso_triangles *from, iso_triangles *to) {
    uint32_t *joined = iso_alloc(from->vertex_count * sizeof *joined);
    bool whole = joined && join_vertices(from, to, joined);
    for (size_t i = 0; whole && i < from->triangle_count; i++) {
        uint32_t *t = to->triangles[to->triangle_count];
        for (int k = 0; k < 3; k++) t[k] = joined[from->triangles[i][k]];
        to->triangle_count += !is_degenerate(t);
    }
    iso_free(joined);
    return whole && remove_copies(to);
}

/* ---- half-edges, grouped by their lower vertex, then sorted by their upper one */

/* A half-edge: an edge with the direction that it has in one of its triangles. */
typedef struct half {
    uint32_t upper, number; /* number: 3 * triangle + corner that it begins at */
} half;

typedef struct edges {
    half *halves;
    size_t *first; /* by lower vertex: index of its first half-edge */
    size_t vertex_count;
} edges;

static int compare_halves(const void *a, const void *b) {
    const half *x = a, *y = b;
    if (x->upper != y->upper) return x->upper < y->upper ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

static void half_ends(const iso_triangles *mesh, uint32_t number, uint32_t *from, uint32_t *to) {
    const uint32_t *t = mesh->triangles[number / 3];
    *from = t[number % 3];
    *to = t[(number % 3 + 1) % 3];
}

static void edges_free(edges *e) {
    iso_free(e->halves);
    iso_free(e->first);
}

static bool edges_make(const iso_triangles *mesh, edges *e) {
    const size_t count = 3 * mesh->triangle_count, vertices = mesh->vertex_count;
    *e = (edges){iso_alloc(count * sizeof *e->halves), iso_alloc_zero(vertices + 2, sizeof *e->first),
                 vertices};
    if (!e->halves || !e->first) return false;
    for (size_t pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < count; i++) {
            uint32_t from, to;
            half_ends(mesh, i, &from, &to);
            const uint32_t lower = from < to ? from : to;
            if (pass)
                e->halves[e->first[lower + 1]++] = (half){from < to ? to : from, i};
            else
                e->first[lower + 2]++;
        }
        for (size_t v = 0; !pass && v <= vertices; v++) e->first[v + 1] += e->first[v];
    }
    for (size_t v = 0; v < vertices; v++)
        qsort(e->halves + e->first[v], e->first[v + 1] - e->first[v], sizeof *e->halves, compare_halves);
    return true;
}

/* Returns the end of the range of half-edges that belong to the same edge as half-edge `at`, the first one of
 * the range. */
static size_t edge_end(const edges *e, size_t vertex, size_t at) {
    size_t end = at + 1;
    while (end < e->first[vertex + 1] && e->halves[end].upper == e->halves[at].upper) end++;
    return end;
}

/* ---- consistent orientation */

/* Sets partner[h] to the other half-edge of the same edge if the edge has two, else to NONE. Returns the
 * number of edges whose two triangles face different ways. */
static size_t find_partners(const iso_triangles *mesh, const edges *e, uint32_t *partner) {
    size_t wrong = 0;
    memset(partner, 0xff, 3 * mesh->triangle_count * sizeof *partner);
    for (size_t v = 0; v < e->vertex_count; v++)
        for (size_t at = e->first[v], end; at < e->first[v + 1]; at = end) {
            uint32_t from[2], to;
            end = edge_end(e, v, at);
            if (end - at != 2) continue;
            for (int k = 0; k < 2; k++) {
                partner[e->halves[at + (size_t)k].number] = e->halves[at + (size_t)(1 - k)].number;
                half_ends(mesh, e->halves[at + (size_t)k].number, &from[k], &to);
            }
            wrong += from[0] == from[1];
        }
    return wrong;
}

bool iso_mesh_partners(const iso_triangles *mesh, uint32_t *partner) {
    edges e;
    const bool whole = edges_make(mesh, &e);
    if (whole) find_partners(mesh, &e, partner);
    edges_free(&e);
    return whole;
}

static double area_of(const iso_triangles *mesh, size_t triangle) {
    iso_vec3 p[3];
    for (int k = 0; k < 3; k++) {
        const float *v = mesh->vertices[mesh->triangles[triangle][k]];
        p[k] = iso_vec3_make(v[0], v[1], v[2]);
    }
    return 0.5 * iso_vec3_length(iso_vec3_cross(iso_vec3_sub(p[1], p[0]), iso_vec3_sub(p[2], p[0])));
}

/* Whether the triangles of two half-edges of the same edge face the same way. */
static bool face_same_way(const iso_triangles *mesh, uint32_t a, uint32_t b) {
    uint32_t from_a, from_b, to;
    half_ends(mesh, a, &from_a, &to);
    half_ends(mesh, b, &from_b, &to);
    return from_a != from_b;
}

enum { UNSEEN, AS_FIRST, TURNED };

/* Visits all triangles of the part that triangle queue[0] belongs to, and sets side[] to whether they face as
 * this triangle does. Afterwards the queue has all *count triangles. Returns whether those that face the
 * other way have more than half of the area. */
static bool visit_part(const iso_triangles *mesh, const uint32_t *partner, uint8_t *side, uint32_t *queue,
                       size_t *count) {
    double area[2] = {0};
    *count = 1;
    side[queue[0]] = AS_FIRST;
    for (size_t at = 0; at < *count; at++) {
        const uint32_t t = queue[at];
        area[side[t] == TURNED] += area_of(mesh, t);
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t other = partner[3 * t + k];
            if (other == NONE || side[other / 3] != UNSEEN) continue;
            const bool same = face_same_way(mesh, 3 * t + k, other);
            side[other / 3] = same == (side[t] == AS_FIRST) ? AS_FIRST : TURNED;
            queue[(*count)++] = other / 3;
        }
    }
    return area[1] > area[0];
}

/* Turns triangles so that each part faces as most of its area does. Returns the number of turned triangles.
 */
static size_t turn_parts(iso_triangles *mesh, const uint32_t *partner, uint8_t *side, uint32_t *queue) {
    size_t turned = 0, count;
    for (uint32_t seed = 0; seed < mesh->triangle_count; seed++) {
        if (side[seed] != UNSEEN) continue;
        queue[0] = seed;
        const bool most = visit_part(mesh, partner, side, queue, &count);
        for (size_t i = 0; i < count; i++) {
            uint32_t *t = mesh->triangles[queue[i]];
            if ((side[queue[i]] == TURNED) == most) continue;
            const uint32_t held = t[1];
            t[1] = t[2];
            t[2] = held;
            turned++;
        }
    }
    return turned;
}

static bool face_one_way(iso_triangles *mesh, const edges *e, size_t *turned) {
    uint32_t *partner = iso_alloc(3 * mesh->triangle_count * sizeof *partner);
    uint32_t *queue = iso_alloc(mesh->triangle_count * sizeof *queue);
    uint8_t *side = iso_alloc_zero(mesh->triangle_count, sizeof *side);
    const bool whole = partner && queue && side;
    *turned = 0;
    if (whole && find_partners(mesh, e, partner) > 0) *turned = turn_parts(mesh, partner, side, queue);
    iso_free(partner);
    iso_free(queue);
    iso_free(side);
    return whole;
}

/* ---- open edges and loops */

/* Lists the open edges: each edge as many times as it has more half-edges in one direction than in the other,
 * in this direction. Returns their number; `open` NULL: they are only counted. */
static size_t find_open(const iso_triangles *mesh, const edges *e, uint32_t (*open)[2]) {
    size_t count = 0;
    for (size_t v = 0; v < e->vertex_count; v++)
        for (size_t at = e->first[v], end; at < e->first[v + 1]; at = end) {
            const uint32_t upper = e->halves[at].upper;
            long long balance = 0;
            end = edge_end(e, v, at);
            for (size_t i = at; i < end; i++) {
                uint32_t from, to;
                half_ends(mesh, e->halves[i].number, &from, &to);
                balance += from == v ? 1 : -1;
            }
            for (long long i = 0; i < llabs(balance); i++, count++) {
                if (!open) continue;
                open[count][0] = balance > 0 ? (uint32_t)v : upper;
                open[count][1] = balance > 0 ? upper : (uint32_t)v;
            }
        }
    return count;
}

static int compare_open(const void *a, const void *b) {
    const uint32_t *x = a, *y = b;
    if (x[0] != y[0]) return x[0] < y[0] ? -1 : 1;
    return (x[1] > y[1]) - (x[1] < y[1]);
}

/* Returns the index of the first open edge that begins at a vertex; the edges are sorted. */
static size_t first_open(const iso_mesh_topology *t, uint32_t vertex) {
    size_t lo = 0, hi = t->open_count;
    while (lo < hi) {
        const size_t middle = (lo + hi) / 2;
        if (t->open[middle][0] < vertex)
            lo = middle + 1;
        else
            hi = middle;
    }
    return lo;
}

typedef struct walk {
    uint32_t *path;         /* the vertices of the current path */
    uint32_t *place;        /* by vertex: its index on the path; NONE: it is not on it */
    uint32_t *used;         /* by vertex: how many of the open edges that begin there have been used */
    size_t length, written; /* vertices of the path; vertices written to loop_vertices */
} walk;

/* Returns an unused open edge that begins at the vertex, and marks it as used; NULL: there is none. */
static const uint32_t *take_edge(const iso_mesh_topology *t, walk *w, uint32_t vertex) {
    const size_t i = first_open(t, vertex) + w->used[vertex];
    if (i >= t->open_count || t->open[i][0] != vertex) return NULL;
    w->used[vertex]++;
    return t->open[i];
}

/* Extends the path to a vertex. If the vertex is on the path already, the path from there on is a loop and is
 * moved to loop_vertices. */
static void extend_path(iso_mesh_topology *t, walk *w, uint32_t vertex) {
    if (w->place[vertex] == NONE) {
        w->place[vertex] = (uint32_t)w->length;
        w->path[w->length++] = vertex;
        return;
    }
    const size_t first = w->place[vertex]; /* a loop is closed here */
    for (size_t i = first; i < w->length; i++) {
        t->loop_vertices[w->written++] = w->path[i];
        if (i > first) w->place[w->path[i]] = NONE;
    }
    t->loop_first[++t->loops] = w->written;
    w->length = first + 1;
}

/* Walks along unused open edges until all are on loops. At each vertex as many open edges end as begin, so
 * every walk comes back to where it began. */
static void find_loops(iso_mesh_topology *t, walk *w) {
    for (size_t i = 0; i < t->open_count; i++) {
        const uint32_t *edge;
        extend_path(t, w, t->open[i][0]);
        while ((edge = take_edge(t, w, w->path[w->length - 1]))) extend_path(t, w, edge[1]);
        while (w->length > 0) w->place[w->path[--w->length]] = NONE;
    }
}

static bool make_loops(iso_mesh_topology *t) {
    walk w = {.path = iso_alloc((t->open_count + 1) * sizeof *w.path),
              .place = iso_alloc(t->mesh.vertex_count * sizeof *w.place),
              .used = iso_alloc_zero(t->mesh.vertex_count, sizeof *w.used)};
    t->loop_vertices = iso_alloc((t->open_count + 1) * sizeof *t->loop_vertices);
    t->loop_first = iso_alloc_zero(t->open_count + 2, sizeof *t->loop_first);
    const bool whole = w.path && w.place && w.used && t->loop_vertices && t->loop_first;
    if (whole) {
        memset(w.place, 0xff, t->mesh.vertex_count * sizeof *w.place);
        qsort(t->open, t->open_count, sizeof *t->open, compare_open);
        find_loops(t, &w);
    }
    iso_free(w.path);
    iso_free(w.place);
    iso_free(w.used);
    return whole;
}

static bool find_openings(iso_mesh_topology *t) {
    edges e;
    bool whole = edges_make(&t->mesh, &e) && face_one_way(&t->mesh, &e, &t->turned);
    if (whole && t->turned) {
        edges_free(&e);
        whole = edges_make(&t->mesh, &e);
    }
    if (whole) {
        t->open_count = find_open(&t->mesh, &e, NULL);
        t->open = iso_alloc((t->open_count + 1) * sizeof *t->open);
        whole = t->open != NULL;
    }
    if (whole) find_open(&t->mesh, &e, t->open);
    edges_free(&e);
    return whole && make_loops(t);
}

iso_status iso_mesh_topology_make(const char *path, const iso_triangles *mesh, iso_mesh_topology *topology,
                                  iso_error *error) {
    iso_mesh_topology t = {0};
    iso_status status = ISO_OK;
    if (mesh->triangle_count > MOST_TRIANGLES)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %zu triangles, at most %d", path, mesh->triangle_count,
                        MOST_TRIANGLES);
    t.mesh.vertices = iso_alloc((mesh->vertex_count + 1) * sizeof *t.mesh.vertices);
    t.mesh.triangles = iso_alloc((mesh->triangle_count + 1) * sizeof *t.mesh.triangles);
    if (!t.mesh.vertices || !t.mesh.triangles || !join_triangles(mesh, &t.mesh))
        status = iso_fail_memory(error, path);
    else if (t.mesh.triangle_count == 0)
        status = iso_fail(error, ISO_ERR_EMPTY, "%s: the mesh encloses nothing: all its triangles are %s",
                          path, "degenerate or cancel each other");
    else if (!find_openings(&t))
        status = iso_fail_memory(error, path);
    if (status == ISO_OK)
        *topology = t;
    else
        iso_mesh_topology_free(&t);
    return status;
}

void iso_mesh_topology_free(iso_mesh_topology *topology) {
    iso_free(topology->mesh.vertices);
    iso_free(topology->mesh.triangles);
    iso_free(topology->open);
    iso_free(topology->loop_vertices);
    iso_free(topology->loop_first);
    *topology = (iso_mesh_topology){0};
}
