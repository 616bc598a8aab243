/* weld: joins the spans of a mesh. Each copy of a vertex on a brick's far face is replaced by the vertex
 * of the brick that owns the edge. This vertex is found by binary search for the brick, then for the
 * edge's key. */
#include "extract/mesh/mesh.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/parallel.h"

/* The brick of a span, the span's number, and the number of its first own vertex in the welded mesh. */
typedef struct owner {
    int32_t brick[3];
    uint32_t span, first;
} owner;

typedef struct welder {
    const iso_mesh_view *view;
    owner *owners;      /* sorted by brick, z slowest */
    iso_buffer numbers; /* welded numbers of one span's vertices */
    iso_pool *pool;     /* whose watch can cancel; or NULL */
} welder;

static int compare_bricks(const int32_t a[3], const int32_t b[3]) {
    for (int axis = 2; axis >= 0; axis--)
        if (a[axis] != b[axis]) return a[axis] < b[axis] ? -1 : 1;
    return 0;
}

static int compare_owners(const void *a, const void *b) {
    return compare_bricks(((const owner *)a)->brick, ((const owner *)b)->brick);
}

static int compare_keys(const void *a, const void *b) {
    return *(const iso_edge_key *)a - *(const iso_edge_key *)b;
}

/* Returns the key that an edge on a brick's far face has in the brick that owns the edge; changes `brick` to
 * that brick. */
static iso_edge_key neighbour_key(iso_edge_key key, int32_t brick[3]) {
    int voxel[3], along = iso_edge_key_split(key, voxel);
    for (int axis = 0; axis < 3; axis++) {
        brick[axis] += voxel[axis] / ISO_BRICK;
        voxel[axis] %= ISO_BRICK;
    }
    return iso_edge_key_make(voxel[0], voxel[1], voxel[2], along);
}

static iso_status find_owner(const welder *weld, const iso_mesh_span *span, iso_edge_key key,
                             uint32_t *number, iso_error *error) {
    const iso_mesh_view *view = weld->view;
    owner wanted = {.brick = {span->brick[0], span->brick[1], span->brick[2]}};
    iso_edge_key own_key = neighbour_key(key, wanted.brick);
    const owner *found =
        bsearch(&wanted, weld->owners, view->span_count, sizeof *weld->owners, compare_owners);
    if (found) {
        const iso_mesh_span *theirs = &view->spans[found->span];
        const iso_edge_key *keys = view->keys + theirs->first_vertex;
        const iso_edge_key *match = bsearch(&own_key, keys, theirs->owned_count, sizeof *keys, compare_keys);
        if (match) {
            *number = found->first + (uint32_t)(match - keys);
            return ISO_OK;
        }
    }
    return iso_fail(error, ISO_ERR_USAGE, "the mesh is not up to date: brick %d %d %d lacks a vertex",
                    (int)wanted.brick[0], (int)wanted.brick[1], (int)wanted.brick[2]);
}

/* Appends a span to the mesh. `first`: by span, the number of its first own vertex. */
static iso_status weld_span(welder *weld, size_t index, const uint32_t *first, iso_weld *out,
                            iso_error *error) {
    const iso_mesh_view *view = weld->view;
    const iso_mesh_span *span = &view->spans[index];
    ISO_TRY(iso_buffer_reserve(&weld->numbers, span->vertex_count * sizeof(uint32_t), 0, error));
    uint32_t *numbers = weld->numbers.data;
    for (uint32_t i = 0; i < span->owned_count; i++) {
        numbers[i] = first[index] + i;
        iso_surfel *vertex = &out->vertices[out->vertex_count++];
        *vertex = view->vertices[span->first_vertex + i];
        for (int axis = 0; axis < 3; axis++)
            vertex->position[axis] += (float)ISO_BRICK * (float)span->brick[axis];
    }
    for (uint32_t i = span->owned_count; i < span->vertex_count; i++)
        ISO_TRY(find_owner(weld, span, view->keys[span->first_vertex + i], &numbers[i], error));
    for (uint32_t i = 0; i < span->triangle_count; i++) {
        const uint16_t *triangle = view->triangles[span->first_triangle + i];
        for (int k = 0; k < 3; k++) out->triangles[out->triangle_count][k] = numbers[triangle[k]];
        out->triangle_count++;
    }
    return ISO_OK;
}

/* Whether a span belongs to the box; NULL: all do. */
static bool is_in_box(const iso_mesh_span *span, const iso_brick_box *box) {
    for (int axis = 0; box && axis < 3; axis++)
        if (span->brick[axis] < box->first[axis] || span->brick[axis] >= box->end[axis]) return false;
    return true;
}

static iso_status weld_spans(welder *weld, const iso_brick_box *box, const uint32_t *first, iso_weld *out,
                             iso_error *error) {
    const iso_mesh_view *view = weld->view;
    for (size_t i = 0; i < view->span_count; i++) {
        const int32_t *brick = view->spans[i].brick;
        weld->owners[i] = (owner){{brick[0], brick[1], brick[2]}, (uint32_t)i, first[i]};
    }
    qsort(weld->owners, view->span_count, sizeof *weld->owners, compare_owners);
    for (size_t i = 0; i < view->span_count && !iso_pool_ask(weld->pool); i++)
        if (is_in_box(&view->spans[i], box)) ISO_TRY(weld_span(weld, i, first, out, error));
    return iso_pool_check(weld->pool, "the mesh", error);
}

static iso_status weld_box(const iso_mesh_view *view, const iso_brick_box *box, const uint32_t *first,
                           iso_pool *pool, iso_weld *weld, iso_error *error) {
    size_t vertices = 0, triangles = 0;
    for (size_t i = 0; i < view->span_count; i++) {
        const iso_mesh_span *span = &view->spans[i];
        if (!is_in_box(span, box)) continue;
        vertices += span->owned_count;
        triangles += span->triangle_count;
    }
    welder work = {
        .view = view, .pool = pool, .owners = iso_alloc_zero(view->span_count, sizeof *work.owners)};
    iso_weld out = {.vertices = iso_alloc(vertices * sizeof *out.vertices),
                    .triangles = iso_alloc(triangles * sizeof *out.triangles)};
    iso_status status;
    if (work.owners && out.vertices && out.triangles)
        status = weld_spans(&work, box, first, &out, error);
    else
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu vertices and %zu triangles", vertices,
                          triangles);
    iso_buffer_free(&work.numbers);
    iso_free(work.owners);
    if (status == ISO_OK)
        *weld = out;
    else
        iso_weld_free(&out);
    return status;
}

iso_status iso_mesh_weld_box(const iso_mesh_view *view, const iso_brick_box *box, const uint32_t *first,
                             iso_weld *weld, iso_error *error) {
    return weld_box(view, box, first, NULL, weld, error);
}

iso_status iso_mesh_weld(const iso_mesh_view *view, iso_pool *pool, iso_weld *weld, iso_error *error) {
    const size_t vertices = iso_mesh_view_vertex_count(view);
    if (vertices > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "a welded mesh of %zu vertices needs wider indices", vertices);
    uint32_t *first = iso_alloc(view->span_count * sizeof *first), number = 0;
    if (!first) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu vertices", vertices);
    for (size_t i = 0; i < view->span_count; i++) {
        first[i] = number;
        number += view->spans[i].owned_count;
    }
    const iso_status status = weld_box(view, NULL, first, pool, weld, error);
    iso_free(first);
    return status;
}

void iso_weld_separate(const iso_mesh_view *view, double distance, iso_weld *weld) {
    size_t vertex = 0;
    for (size_t s = 0; s < view->span_count; s++) {
        const iso_mesh_span *span = &view->spans[s];
        for (uint32_t i = 0; i < span->owned_count; i++, vertex++) {
            int voxel[3];
            const int axis = iso_edge_key_split(view->keys[span->first_vertex + i], voxel);
            const double lower = (double)ISO_BRICK * span->brick[axis] + voxel[axis];
            float *position = &weld->vertices[vertex].position[axis];
            if (*position < lower + distance) *position = (float)(lower + distance);
            if (*position > lower + 1 - distance) *position = (float)(lower + 1 - distance);
        }
    }
}

void iso_weld_free(iso_weld *weld) {
    iso_free(weld->vertices);
    iso_free(weld->triangles);
    iso_free(weld->colors);
    *weld = (iso_weld){0};
}
