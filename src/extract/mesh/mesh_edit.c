/* Smoothing of welded meshes, and their normals. */
#include "extract/mesh/mesh_edit.h"

#include <string.h>

#include "base/memory.h"

/* The vertices that the edges of vertex i lead to: list[start[i]] .. list[start[i + 1] - 1]. In a closed mesh
 * each edge is there once in each direction. */
typedef struct neighbours {
    uint32_t *start, *list;
    int32_t *surplus; /* edges that begin at a vertex less those that end there: not 0 at open ones */
} neighbours;

static void free_neighbours(neighbours *n) {
    iso_free(n->start);
    iso_free(n->list);
    iso_free(n->surplus);
}

static bool find_neighbours(const iso_weld *weld, neighbours *n) {
    n->start = iso_alloc_zero(weld->vertex_count + 2, sizeof *n->start);
    n->list = iso_alloc((3 * weld->triangle_count + 1) * sizeof *n->list);
    n->surplus = iso_alloc_zero(weld->vertex_count + 1, sizeof *n->surplus);
    if (!n->start || !n->list || !n->surplus) return false;
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 0; k < 3; k++) n->start[weld->triangles[t][k] + 2]++;
    for (size_t i = 2; i < weld->vertex_count + 2; i++) n->start[i] += n->start[i - 1];
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const uint32_t from = weld->triangles[t][k], to = weld->triangles[t][(k + 1) % 3];
            n->list[n->start[from + 1]++] = to;
        }
    return true;
}

/* Marks the vertices of edges that have no partner in the other direction. */
static void mark_open(const iso_weld *weld, const neighbours *n) {
    for (uint32_t i = 0; i < weld->vertex_count; i++)
        for (uint32_t k = n->start[i]; k < n->start[i + 1]; k++) {
            const uint32_t to = n->list[k];
            bool back = false;
            for (uint32_t j = n->start[to]; j < n->start[to + 1] && !back; j++) back = n->list[j] == i;
            if (!back) n->surplus[i] = n->surplus[to] = 1;
        }
}

static void step(const iso_weld *weld, const neighbours *n, double factor, float (*moved)[3]) {
    for (size_t i = 0; i < weld->vertex_count; i++) {
        const float *p = weld->vertices[i].position;
        const uint32_t first = n->start[i], end = n->start[i + 1];
        double sum[3] = {0, 0, 0};
        for (uint32_t k = first; k < end; k++)
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += (double)weld->vertices[n->list[k]].position[axis];
        const double share = n->surplus[i] || first == end ? 0 : factor;
        for (int axis = 0; axis < 3; axis++)
            moved[i][axis] =
                share != 0 ? (float)((double)p[axis] + share * (sum[axis] / (end - first) - (double)p[axis]))
                           : p[axis];
    }
    for (size_t i = 0; i < weld->vertex_count; i++)
        memcpy(weld->vertices[i].position, moved[i], sizeof moved[i]);
}

void iso_weld_find_normals(iso_weld *weld) {
    for (size_t i = 0; i < weld->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            weld->vertices[i].normal[axis] *= 1e-6f; /* (counts if nothing else does) */
    for (size_t t = 0; t < weld->triangle_count; t++) {
        const uint32_t *corner = weld->triangles[t];
        iso_vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const float *at = weld->vertices[corner[k]].position;
            p[k] = iso_vec3_make(at[0], at[1], at[2]);
        }
        const iso_vec3 normal = iso_vec3_cross(iso_vec3_sub(p[1], p[0]), iso_vec3_sub(p[2], p[0]));
        for (int k = 0; k < 3; k++) {
            float *n = weld->vertices[corner[k]].normal;
            n[0] += (float)normal.x, n[1] += (float)normal.y, n[2] += (float)normal.z;
        }
    }
    for (size_t i = 0; i < weld->vertex_count; i++) {
        float *n = weld->vertices[i].normal;
        const iso_vec3 unit = iso_vec3_unit(iso_vec3_make(n[0], n[1], n[2]));
        n[0] = (float)unit.x, n[1] = (float)unit.y, n[2] = (float)unit.z;
    }
}

iso_status iso_weld_smooth(iso_weld *weld, int iterations, iso_error *error) {
    static const double LAMBDA = 0.6307, MU = -0.6732;
    neighbours n = {0};
    float(*moved)[3] = iso_alloc((weld->vertex_count + 1) * sizeof *moved);
    const bool there = moved && find_neighbours(weld, &n);
    if (there) mark_open(weld, &n);
    for (int i = 0; there && i < iterations; i++) {
        step(weld, &n, LAMBDA, moved);
        step(weld, &n, MU, moved);
    }
    iso_free(moved);
    free_neighbours(&n);
    if (!there)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for smoothing %zu vertices", weld->vertex_count);
    iso_weld_find_normals(weld);
    return ISO_OK;
}

iso_status iso_weld_edit(iso_weld *weld, const iso_transform *transform, const iso_mesh_edits *edits,
                         iso_error *error) {
    if (edits->smooth) ISO_TRY(iso_weld_smooth(weld, edits->smooth, error));
    return edits->keep > 0 || edits->deviation > 0 ? iso_weld_decimate(weld, transform, edits, error)
                                                   : ISO_OK;
}
