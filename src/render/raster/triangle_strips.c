/* triangle_strips: greedy triangle strips. A strip begins at the triangle with the fewest neighbours left, so
 * that few triangles end up alone (tomesh: Akeley, Haeberli and Burns 1990). The corner order of its first
 * triangle determines the rest; the order with the longest strip is taken, continued in both directions. */
#include "render/raster/triangle_strips.h"

#include <assert.h>
#include <string.h>

/* 16 bits hold the number of any triangle and any corner: a brick has at most 5 triangles in each of 16^3
 * cells. */
enum { NONE = UINT16_MAX, DEGREES = 4, MOST_TRIANGLES = 5 * ISO_BRICK_VOXELS };
_Static_assert(3 * MOST_TRIANGLES < NONE, "corners have numbers of 16 bits");

#define IN_A_STRIP UINT32_MAX

/* A walk from a triangle over one of its edges. */
typedef struct path {
    uint16_t *vertex, *triangle;
    uint32_t count;
} path;

typedef struct stripper {
    const uint16_t (*corner)[3];
    uint32_t count, vertex_count;
    uint32_t *start;
    uint16_t *fan;
    uint16_t (*neighbour)[3]; /* over the edge between corners k and k + 1 */
    uint32_t *met;            /* number of the last walk that visited a triangle, or IN_A_STRIP */
    uint32_t walks;
    path path[2]; /* forwards, backwards */
    /* Triangles by the number of free neighbours when they were pushed; the number may have dropped since. */
    uint16_t *stack[DEGREES];
    uint32_t stacked[DEGREES];
    uint16_t *out;
    size_t used;
} stripper;

/* ---- neighbours */

/* Sorts corners by their vertices: those of vertex v are fan[start[v]] .. fan[start[v + 1] - 1]. */
static void sort_corners(const stripper *s) {
    uint32_t *start = s->start;
    memset(start, 0, (s->vertex_count + 1) * sizeof *start);
    for (uint32_t c = 0; c < 3 * s->count; c++) start[s->corner[c / 3][c % 3]]++;
    for (uint32_t v = 0; v < s->vertex_count; v++) start[v + 1] += start[v];
    for (uint32_t c = 3 * s->count; c-- > 0;) s->fan[--start[s->corner[c / 3][c % 3]]] = (uint16_t)c;
}

/* The triangle that has the edge in the opposite direction: winding is consistent over the surface. */
static uint16_t find_neighbour(const stripper *s, uint16_t from, uint16_t to) {
    for (uint32_t i = s->start[to]; i < s->start[to + 1u]; i++) {
        uint32_t triangle = s->fan[i] / 3u, k = s->fan[i] % 3u;
        if (s->corner[triangle][(k + 1) % 3] == from) return (uint16_t)triangle;
    }
    return NONE;
}

static void find_neighbours(stripper *s) {
    sort_corners(s);
    for (uint32_t t = 0; t < s->count; t++)
        for (int k = 0; k < 3; k++)
            s->neighbour[t][k] = find_neighbour(s, s->corner[t][k], s->corner[t][(k + 1) % 3]);
}

/* ---- walks */

/* The edge of `triangle` between two vertices, or -1. */
static int edge_between(const stripper *s, uint16_t triangle, uint16_t a, uint16_t b) {
    const uint16_t *c = s->corner[triangle];
    for (int k = 0; k < 3; k++) {
        uint16_t from = c[k], to = c[(k + 1) % 3];
        if ((from == a && to == b) || (from == b && to == a)) return k;
    }
    return -1;
}

/* Walks from `triangle` over the edge a b until the next triangle is in a strip or already visited. */
static void walk(stripper *s, uint16_t triangle, uint16_t a, uint16_t b, path *p) {
    for (p->count = 0;; p->count++) {
        int edge = edge_between(s, triangle, a, b);
        triangle = edge < 0 ? NONE : s->neighbour[triangle][edge];
        if (triangle == NONE || s->met[triangle] == IN_A_STRIP || s->met[triangle] == s->walks) return;
        edge = edge_between(s, triangle, a, b);
        s->met[triangle] = s->walks;
        a = b;
        b = s->corner[triangle][(edge + 2) % 3];
        p->vertex[p->count] = b;
        p->triangle[p->count] = triangle;
    }
}

/* Walks both ways from a triangle whose corner order begins with corner `turn`; returns the length. The
 * backward path is made even: an odd number of triangles before the first one would reverse its winding. */
static uint32_t walk_both_ways(stripper *s, uint16_t triangle, int turn) {
    const uint16_t *c = s->corner[triangle];
    uint16_t x = c[turn], y = c[(turn + 1) % 3], z = c[(turn + 2) % 3];
    s->met[triangle] = ++s->walks;
    walk(s, triangle, y, z, &s->path[0]);
    walk(s, triangle, y, x, &s->path[1]);
    s->path[1].count &= ~1u;
    return s->path[0].count + s->path[1].count;
}

/* ---- strips */

static int neighbours_left(const stripper *s, uint16_t triangle) {
    int left = 0;
    for (int k = 0; k < 3; k++) {
        uint16_t other = s->neighbour[triangle][k];
        left += other != NONE && s->met[other] != IN_A_STRIP;
    }
    return left;
}

/* Pushes a triangle on the stack for its number of free neighbours. */
static void push_triangle(stripper *s, uint16_t triangle) {
    int left = neighbours_left(s, triangle);
    s->stack[left][s->stacked[left]++] = triangle;
}

/* Marks a triangle as used; its free neighbours have one neighbour less and are pushed again. */
static void mark_in_strip(stripper *s, uint16_t triangle) {
    s->met[triangle] = IN_A_STRIP;
    for (int k = 0; k < 3; k++) {
        uint16_t other = s->neighbour[triangle][k];
        if (other != NONE && s->met[other] != IN_A_STRIP) push_triangle(s, other);
    }
}

/* The triangle with the fewest neighbours; NONE when all are in strips. */
static uint16_t next_start(stripper *s) {
    for (int left = 0; left < DEGREES;) {
        if (!s->stacked[left]) {
            left++;
            continue;
        }
        uint16_t triangle = s->stack[left][--s->stacked[left]];
        if (s->met[triangle] == IN_A_STRIP) continue;
        int now = neighbours_left(s, triangle);
        if (now == left) return triangle;
        s->stack[now][s->stacked[now]++] = triangle;
        if (now < left) left = now;
    }
    return NONE;
}

/* Appends the longest strip that begins at a triangle. */
static void append_strip(stripper *s, uint16_t triangle) {
    int best = 0;
    uint32_t longest = 0;
    for (int turn = 0; turn < 3; turn++) {
        uint32_t length = walk_both_ways(s, triangle, turn);
        if (length > longest) best = turn;
        if (length > longest) longest = length;
    }
    walk_both_ways(s, triangle, best);
    if (s->used) s->out[s->used++] = ISO_TRIANGLE_STRIP_RESTART;
    for (uint32_t i = s->path[1].count; i-- > 0;) s->out[s->used++] = s->path[1].vertex[i];
    for (int k = 0; k < 3; k++) s->out[s->used++] = s->corner[triangle][(best + k) % 3];
    for (uint32_t i = 0; i < s->path[0].count; i++) s->out[s->used++] = s->path[0].vertex[i];
    mark_in_strip(s, triangle);
    for (int way = 0; way < 2; way++)
        for (uint32_t i = 0; i < s->path[way].count; i++) mark_in_strip(s, s->path[way].triangle[i]);
}

/* ---- one brick */

/* The next array in a block of memory; NULL while sizes are only summed. */
static void *next_array(const iso_buffer *block, size_t *used, size_t bytes) {
    void *part = block ? (char *)block->data + *used : NULL;
    *used += (bytes + 7) / 8 * 8;
    return part;
}

/* Arranges all arrays in a block of memory; returns their bytes. */
static size_t arrange_arrays(stripper *s, const iso_buffer *block) {
    const size_t n = s->count, pushes = (1 + 3) * n; /* each triangle once at first, then by each neighbour */
    size_t used = 0;
    s->start = next_array(block, &used, (s->vertex_count + 1) * sizeof *s->start);
    s->met = next_array(block, &used, n * sizeof *s->met);
    s->neighbour = next_array(block, &used, n * sizeof *s->neighbour);
    s->fan = next_array(block, &used, 3 * n * sizeof *s->fan);
    for (int way = 0; way < 2; way++) {
        s->path[way].vertex = next_array(block, &used, n * sizeof(uint16_t));
        s->path[way].triangle = next_array(block, &used, n * sizeof(uint16_t));
    }
    for (int left = 0; left < DEGREES; left++)
        s->stack[left] = next_array(block, &used, pushes * sizeof(uint16_t));
    return used;
}

iso_status iso_triangle_strips_make(iso_triangle_strips *strips, const iso_mesh_view *mesh,
                                    const iso_mesh_span *span, size_t *count, iso_error *error) {
    assert(span->triangle_count <= MOST_TRIANGLES && span->vertex_count < ISO_TRIANGLE_STRIP_RESTART);
    stripper s = {.corner = mesh->triangles + span->first_triangle,
                  .count = span->triangle_count,
                  .vertex_count = span->vertex_count};
    ISO_TRY(iso_buffer_reserve(&strips->work, arrange_arrays(&s, NULL), 0, error));
    ISO_TRY(
        iso_buffer_reserve(&strips->indices, ISO_TRIANGLE_STRIP_ROOM * sizeof(uint16_t) * s.count, 0, error));
    arrange_arrays(&s, &strips->work);
    s.out = strips->indices.data;
    find_neighbours(&s);
    memset(s.met, 0, s.count * sizeof *s.met);
    for (uint32_t t = s.count; t-- > 0;) push_triangle(&s, (uint16_t)t);
    for (uint16_t t; (t = next_start(&s)) != NONE;) append_strip(&s, t);
    *count = s.used;
    return ISO_OK;
}

const uint16_t *iso_triangle_strips_indices(const iso_triangle_strips *strips) {
    return strips->indices.data;
}

void iso_triangle_strips_free(iso_triangle_strips *strips) {
    iso_buffer_free(&strips->indices);
    iso_buffer_free(&strips->work);
}
