/* mesh_distances: fast marching. The place with the least distance of a heap is done; each triangle
 * beside it then gives the distance of its third corner. */
#include <math.h>

#include "base/numbers.h"
#include "extract/lines/mesh_rings.h"

static bool is_nearer(const iso_mesh_distances *d, uint32_t a, uint32_t b) {
    return d->distance[a] < d->distance[b] || (d->distance[a] == d->distance[b] && a < b);
}

static void set(iso_mesh_distances *d, size_t at, uint32_t place) {
    d->heap[at] = place;
    d->heap_at[place] = (uint32_t)at;
}

static void sift_up(iso_mesh_distances *d, size_t at) {
    const uint32_t place = d->heap[at];
    while (at > 0 && is_nearer(d, place, d->heap[(at - 1) / 2])) {
        set(d, at, d->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    set(d, at, place);
}

static uint32_t take_nearest(iso_mesh_distances *d) {
    const uint32_t nearest = d->heap[0], place = d->heap[--d->heaped];
    size_t at = 0;
    if (!d->heaped) return nearest;
    for (size_t child; (child = 2 * at + 1) < d->heaped; at = child) {
        if (child + 1 < d->heaped && is_nearer(d, d->heap[child + 1], d->heap[child])) child++;
        if (!is_nearer(d, d->heap[child], place)) break;
        set(d, at, d->heap[child]);
    }
    set(d, at, place);
    return nearest;
}

static void lower(iso_mesh_distances *d, uint32_t place, double distance) {
    if (d->done[place] || !(distance < d->distance[place])) return;
    if (d->distance[place] == INFINITY) set(d, d->heaped++, place);
    d->distance[place] = distance;
    sift_up(d, d->heap_at[place]);
}

static double between(iso_vec3 a, iso_vec3 b) {
    return iso_vec3_length(iso_vec3_sub(a, b));
}

/* The distance of c from a virtual source in the plane of the triangle, on the other side of ab, at the
 * distances of a and b; INFINITY if there is none, or the path from there to c does not cross ab. */
static double cross_edge(iso_vec3 a, iso_vec3 b, iso_vec3 c, double from_a, double from_b) {
    const iso_vec3 ab = iso_vec3_sub(b, a), ac = iso_vec3_sub(c, a);
    const double length = iso_vec3_length(ab);
    if (!(length > 0)) return INFINITY;
    const double x = 0.5 * (from_a * from_a - from_b * from_b + length * length) / length,
                 square = from_a * from_a - x * x, u = iso_vec3_dot(ac, ab) / length,
                 v = sqrt(iso_max(iso_vec3_dot(ac, ac) - u * u, 0));
    if (!(square >= 0)) return INFINITY;
    const double y = sqrt(square), crossing = y + v > 0 ? x + (u - x) * y / (y + v) : -1;
    return crossing >= 0 && crossing <= length ? sqrt((u - x) * (u - x) + (y + v) * (y + v)) : INFINITY;
}

static void update_triangle(iso_mesh_distances *d, const uint32_t triangle[3], uint32_t v) {
    const iso_triangles *mesh = &d->topology->mesh;
    for (int k = 0; k < 3; k++) {
        const uint32_t c = triangle[k];
        if (c == v || d->done[c]) continue;
        const uint32_t b = triangle[0] ^ triangle[1] ^ triangle[2] ^ c ^ v;
        const iso_vec3 at = iso_mesh_vertex(mesh, v), to = iso_mesh_vertex(mesh, c);
        double distance = d->distance[v] + between(at, to);
        if (d->done[b])
            distance = iso_min(distance,
                               cross_edge(at, iso_mesh_vertex(mesh, b), to, d->distance[v], d->distance[b]));
        lower(d, c, iso_max(distance, d->distance[v]));
    }
}

/* Between a lid and the vertices of its loop. */
static void update_loop(iso_mesh_distances *d, uint32_t lid) {
    const iso_mesh_topology *topology = d->topology;
    const size_t loop = lid - topology->mesh.vertex_count, first = topology->loop_first[loop],
                 end = topology->loop_first[loop + 1];
    iso_vec3 middle = {0, 0, 0};
    for (size_t k = first; k < end; k++)
        middle = iso_vec3_add(middle, iso_mesh_vertex(&topology->mesh, topology->loop_vertices[k]));
    middle = iso_vec3_scale(middle, 1.0 / (double)(end - first));
    for (size_t k = first; k < end; k++) {
        const uint32_t v = topology->loop_vertices[k];
        lower(d, v, d->distance[lid] + between(iso_mesh_vertex(&topology->mesh, v), middle));
    }
}

size_t iso_mesh_distances_from(iso_mesh_distances *d, uint32_t from, uint32_t *order) {
    const size_t vertices = d->topology->mesh.vertex_count;
    size_t count = 0;
    lower(d, from, 0);
    while (d->heaped) {
        const uint32_t v = take_nearest(d);
        d->done[v] = true;
        order[count++] = v;
        if (v >= vertices) {
            update_loop(d, v);
            continue;
        }
        for (size_t k = d->around_first[v]; k < d->around_first[v + 1]; k++)
            update_triangle(d, d->topology->mesh.triangles[d->around[k]], v);
        if (d->lid[v] != ISO_NO_RING) lower(d, d->lid[v], d->distance[v]);
    }
    return count;
}
