/* sort: counting sorts into uniform grids, recursively where points are dense. */
#include "render/shapes/sort.h"

#include <math.h>
#include <string.h>

enum { AXIS_CELLS = 1024 }; /* the most cells on an axis */

typedef struct grid {
    float low[3], scale[3];
    uint32_t cells[3];
} grid;

static uint32_t cell_of(const grid *g, const float point[3]) {
    uint32_t index[3];
    for (int a = 0; a < 3; a++) {
        const float at = (point[a] - g->low[a]) * g->scale[a]; /* not negative */
        index[a] = at < (float)g->cells[a] ? (uint32_t)at : g->cells[a] - 1;
    }
    return (index[2] * g->cells[1] + index[1]) * g->cells[0] + index[0];
}

/* Sets the lowest corner and the extent of the points' bounding box. Returns whether all points coincide. */
static bool measure(const iso_shapes_sort *sort, uint32_t first, uint32_t count, grid *g, double extent[3]) {
    float high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int a = 0; a < 3; a++) g->low[a] = INFINITY;
    for (uint32_t i = first; i < first + count; i++)
        for (int a = 0; a < 3; a++) {
            const float value = sort->points[sort->order[i]][a];
            g->low[a] = value < g->low[a] ? value : g->low[a];
            high[a] = value > high[a] ? value : high[a];
        }
    for (int a = 0; a < 3; a++) extent[a] = (double)high[a] - (double)g->low[a];
    return !(extent[0] > 0 || extent[1] > 0 || extent[2] > 0);
}

/* Returns the side of the cubes of which about `wanted` fill a box. A side of the box that is shorter than a
 * cube is taken to be one cube long. */
static double cube_side(const double extent[3], double wanted) {
    double longest = 0, low = 0;
    for (int a = 0; a < 3; a++) longest = extent[a] > longest ? extent[a] : longest;
    double high = longest;
    for (int step = 0; step < 40; step++) {
        const double side = (low + high) / 2;
        double cubes = 1;
        for (int a = 0; a < 3; a++) cubes *= extent[a] > side ? extent[a] / side : 1;
        *(cubes > wanted ? &low : &high) = side;
    }
    return high;
}

static grid make_grid(const grid *measured, const double extent[3], double wanted) {
    grid g = *measured;
    const double side = cube_side(extent, wanted > 2 ? wanted : 2);
    for (int a = 0; a < 3; a++) {
        const double cells = ceil(extent[a] / side);
        g.cells[a] = cells < 1 ? 1 : cells > AXIS_CELLS ? AXIS_CELLS : (uint32_t)cells;
        const float scale = (float)(g.cells[a] / extent[a]);
        g.scale[a] = isfinite(scale) ? scale : 0;
    }
    return g;
}

static iso_status add_block(iso_shapes_sort *sort, uint32_t first, iso_error *error) {
    const size_t bytes = sort->block_count * sizeof(uint32_t);
    ISO_TRY(iso_buffer_reserve(&sort->firsts, bytes + sizeof(uint32_t), bytes, error));
    ((uint32_t *)sort->firsts.data)[sort->block_count++] = first;
    return ISO_OK;
}

/* Divides points that coincide into blocks, in their present order. */
static iso_status cut(iso_shapes_sort *sort, uint32_t first, uint32_t count, iso_error *error) {
    for (uint32_t done = 0; done < count; done += sort->most) ISO_TRY(add_block(sort, first + done, error));
    return ISO_OK;
}

/* Sorts a range by cells; starts[c] is then where cell c - 1 ends. */
static void scatter(iso_shapes_sort *sort, uint32_t first, uint32_t count, const grid *g, uint32_t *starts) {
    for (uint32_t i = first; i < first + count; i++) starts[1 + cell_of(g, sort->points[sort->order[i]])]++;
    const size_t cells = (size_t)g->cells[0] * g->cells[1] * g->cells[2];
    for (size_t c = 0; c < cells; c++) starts[c + 1] += starts[c];
    for (uint32_t i = first; i < first + count; i++) {
        const uint32_t point = sort->order[i];
        sort->spare[first + starts[cell_of(g, sort->points[point])]++] = point;
    }
    memcpy(sort->order + first, sort->spare + first, count * sizeof *sort->order);
}

static iso_status sort_range(iso_shapes_sort *sort, uint32_t first, uint32_t count, iso_error *error) {
    if (count <= sort->most) return add_block(sort, first, error);
    grid g;
    double extent[3];
    if (measure(sort, first, count, &g, extent)) return cut(sort, first, count, error);
    g = make_grid(&g, extent, (double)count / sort->wanted);
    const size_t cells = (size_t)g.cells[0] * g.cells[1] * g.cells[2];
    if (cells == 1) return cut(sort, first, count, error);
    uint32_t *starts = iso_alloc_zero(cells + 1, sizeof *starts);
    if (!starts)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for sorting %u shapes", (unsigned)count);
    scatter(sort, first, count, &g, starts);
    iso_status status = ISO_OK;
    for (size_t c = 0; c < cells && status == ISO_OK; c++) {
        const uint32_t begin = c ? starts[c - 1] : 0, size = starts[c] - begin;
        if (size == count)
            status = cut(sort, first, count, error);
        else if (size)
            status = sort_range(sort, first + begin, size, error);
    }
    iso_free(starts);
    return status;
}

iso_status iso_shapes_sort_run(iso_shapes_sort *sort, uint32_t count, iso_error *error) {
    sort->block_count = 0;
    return count ? sort_range(sort, 0, count, error) : ISO_OK;
}
