/* mesh_measure: area, volume and counts as sums over groups of triangles and vertices. Edges are found by
 * sorting the sides of triangles by their lower vertex; parts by disjoint sets of vertices. */
#include "extract/mesh/mesh_measure.h"

#include <math.h>

#include "base/disjoint_sets.h"
#include "base/memory.h"

/* Number of triangles or vertices of one task. Each task has its own sums, which are added in the order of
 * tasks, so that results do not depend on the number of threads. */
enum { BLOCK = 4096 };

typedef struct sums {
    double area;    /* mm2 */
    double volume;  /* voxels */
    size_t edges;   /* of the mesh, each once */
    size_t open;    /* sides of triangles without a side in the opposite direction */
    size_t crowded; /* edges of more than two triangles */
} sums;

typedef struct measuring {
    const iso_weld *weld;
    iso_affine affine;
    uint64_t
        *first; /* by vertex, and one more: index in `sides` of the first side whose lower vertex it is */
    uint32_t
        *sides; /* sides of triangles: 2 * the higher vertex, + 1 if the side runs from it to the lower */
    uint32_t *parent; /* by vertex: parents of disjoint sets (the connected pieces); UINT32_MAX: no triangle
                         has the vertex */
    sums *blocks;
} measuring;

/* ---- edges */

static void side_of(const uint32_t triangle[3], int k, uint32_t *low, uint32_t *side) {
    const uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
    *low = a < b ? a : b;
    *side = a < b ? 2 * b : 2 * a + 1;
}

static void list_sides(measuring *m) {
    const iso_weld *weld = m->weld;
    uint32_t low, side;
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            side_of(weld->triangles[t], k, &low, &side);
            m->first[low + 1]++;
        }
    for (size_t v = 0; v < weld->vertex_count; v++) m->first[v + 1] += m->first[v];
    /* this moves each vertex's entry of `first` to the end of its sides, where those of the next vertex
     * begin; undone below */
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            side_of(weld->triangles[t], k, &low, &side);
            m->sides[m->first[low]++] = side;
        }
    for (size_t v = weld->vertex_count; v > 0; v--) m->first[v] = m->first[v - 1];
    m->first[0] = 0;
}

static void sort(uint32_t *items, size_t count) {
    for (size_t i = 1; i < count; i++) {
        const uint32_t item = items[i];
        size_t j = i;
        for (; j > 0 && items[j - 1] > item; j--) items[j] = items[j - 1];
        items[j] = item;
    }
}

static void count_edges(void *context, size_t block, int worker) {
    (void)worker;
    measuring *m = context;
    const size_t begin = block * BLOCK,
                 end = begin + BLOCK < m->weld->vertex_count ? begin + BLOCK : m->weld->vertex_count;
    sums *sum = &m->blocks[block];
    for (size_t v = begin; v < end; v++) {
        uint32_t *sides = m->sides + m->first[v];
        const size_t count = (size_t)(m->first[v + 1] - m->first[v]);
        sort(sides, count);
        for (size_t i = 0; i < count;) {
            const uint32_t other = sides[i] / 2;
            size_t up = 0, down = 0;
            for (; i < count && sides[i] / 2 == other; i++) {
                up += sides[i] % 2 == 0;
                down += sides[i] % 2;
            }
            sum->edges++;
            sum->open += up > down ? up - down : down - up;
            sum->crowded += up + down > 2;
        }
    }
}

/* ---- area and volume */

static iso_vec3 position(const iso_weld *weld, uint32_t vertex) {
    const float *p = weld->vertices[vertex].position;
    return iso_vec3_make(p[0], p[1], p[2]);
}

static void add_triangles(void *context, size_t block, int worker) {
    (void)worker;
    measuring *m = context;
    const iso_weld *weld = m->weld;
    const size_t begin = block * BLOCK,
                 end = begin + BLOCK < weld->triangle_count ? begin + BLOCK : weld->triangle_count;
    const iso_vec3 origin = position(weld, 0); /* on the mesh, so that little precision is lost */
    sums *sum = &m->blocks[block];
    for (size_t t = begin; t < end; t++) {
        const uint32_t *corner = weld->triangles[t];
        const iso_vec3 a = iso_vec3_sub(position(weld, corner[0]), origin),
                       b = iso_vec3_sub(position(weld, corner[1]), origin),
                       c = iso_vec3_sub(position(weld, corner[2]), origin);
        const iso_vec3 ab = iso_affine_vector(&m->affine, iso_vec3_sub(b, a)),
                       ac = iso_affine_vector(&m->affine, iso_vec3_sub(c, a));
        const iso_vec3 normal = iso_vec3_cross(ab, ac);
        sum->area += 0.5 * sqrt(iso_vec3_dot(normal, normal));
        sum->volume += iso_vec3_dot(a, iso_vec3_cross(b, c)) / 6;
    }
}

/* ---- parts */

static void count_parts(measuring *m, iso_mesh_measures *measures) {
    const iso_weld *weld = m->weld;
    for (size_t v = 0; v < weld->vertex_count; v++) m->parent[v] = UINT32_MAX;
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 0; k < 3; k++) m->parent[weld->triangles[t][k]] = weld->triangles[t][k];
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 1; k < 3; k++) iso_set_unite(m->parent, weld->triangles[t][0], weld->triangles[t][k]);
    for (size_t v = 0; v < weld->vertex_count; v++) {
        measures->vertices += m->parent[v] != UINT32_MAX;
        measures->pieces += m->parent[v] == v;
    }
}

/* ---- sums */

static size_t blocks_of(size_t count) {
    return (count + BLOCK - 1) / BLOCK;
}

static void add_sums(measuring *m, size_t blocks, iso_mesh_measures *measures) {
    for (size_t i = 0; i < blocks; i++) {
        measures->area += m->blocks[i].area;
        measures->volume += m->blocks[i].volume;
        measures->edges += m->blocks[i].edges;
        measures->open_edges += m->blocks[i].open;
        measures->crowded_edges += m->blocks[i].crowded;
    }
    measures->volume *= fabs(m->affine.determinant);
    if (measures->open_edges) measures->volume = NAN;
}

iso_status iso_weld_measure(const iso_weld *weld, const iso_transform *transform, iso_pool *pool,
                            iso_mesh_measures *measures, iso_error *error) {
    *measures = (iso_mesh_measures){.triangles = weld->triangle_count};
    if (weld->triangle_count == 0) return ISO_OK;
    if (weld->vertex_count > INT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "a mesh of %zu vertices is too large to be measured",
                        weld->vertex_count);
    const size_t of_vertices = blocks_of(weld->vertex_count), of_triangles = blocks_of(weld->triangle_count),
                 blocks = of_vertices > of_triangles ? of_vertices : of_triangles;
    measuring m = {.weld = weld,
                   .affine = iso_transform_affine(transform),
                   .first = iso_alloc_zero(weld->vertex_count + 1, sizeof *m.first),
                   .sides = iso_alloc(3 * weld->triangle_count * sizeof *m.sides),
                   .parent = iso_alloc(weld->vertex_count * sizeof *m.parent),
                   .blocks = iso_alloc_zero(blocks, sizeof *m.blocks)};
    iso_status status = ISO_OK;
    if (m.first && m.sides && m.parent && m.blocks) {
        list_sides(&m);
        iso_parallel_for(pool, of_vertices, count_edges, &m);
        iso_parallel_for(pool, of_triangles, add_triangles, &m);
        count_parts(&m, measures);
        add_sums(&m, blocks, measures);
        measures->euler =
            (int64_t)measures->vertices - (int64_t)measures->edges + (int64_t)measures->triangles;
    } else {
        status =
            iso_fail(error, ISO_ERR_NOMEM, "out of memory to measure %zu triangles", weld->triangle_count);
    }
    iso_free(m.first);
    iso_free(m.sides);
    iso_free(m.parent);
    iso_free(m.blocks);
    return status;
}
