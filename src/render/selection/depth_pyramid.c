/* depth_pyramid: the maxima of squares of 8 x 8 pixels, and of four cells each above them. */
#include "render/selection/depth_pyramid.h"

static float greater(float a, float b) {
    return a > b ? a : b;
}

/* Computes a cell of level 0. */
static void update_cell(iso_depth_pyramid *p, const iso_gbuffer *g, int x, int y) {
    const int right = (x + 1) * ISO_DEPTH_CELL, bottom = (y + 1) * ISO_DEPTH_CELL,
              last_x = right < g->width ? right : g->width, last_y = bottom < g->height ? bottom : g->height;
    float most = -INFINITY;
    for (int row = y * ISO_DEPTH_CELL; row < last_y; row++) {
        const float *depth = g->depth + (size_t)row * (size_t)g->width;
        for (int column = x * ISO_DEPTH_CELL; column < last_x; column++) most = greater(most, depth[column]);
    }
    p->level[0][y * p->width[0] + x] = most;
}

/* Computes a cell of a level above 0. */
static void reduce_cell(iso_depth_pyramid *p, int level, int x, int y) {
    const int below = level - 1, width = p->width[below];
    const int x1 = 2 * x + 1 < width ? 2 * x + 1 : 2 * x,
              y1 = 2 * y + 1 < p->height[below] ? 2 * y + 1 : 2 * y;
    const float *from = p->level[below];
    p->level[level][y * p->width[level] + x] =
        greater(greater(from[2 * y * width + 2 * x], from[2 * y * width + x1]),
                greater(from[y1 * width + 2 * x], from[y1 * width + x1]));
}

void iso_depth_pyramid_update(iso_depth_pyramid *p, const iso_gbuffer *g, const iso_area *area) {
    if (iso_area_is_empty(area)) return;
    for (int level = 0, side = ISO_DEPTH_CELL; level < p->levels; level++, side *= 2)
        for (int y = area->rows.first / side; y <= area->rows.last / side; y++)
            for (int x = area->columns.first / side; x <= area->columns.last / side; x++)
                if (level == 0)
                    update_cell(p, g, x, y);
                else
                    reduce_cell(p, level, x, y);
}

iso_status iso_depth_pyramid_make(iso_depth_pyramid *p, const iso_gbuffer *g, iso_error *error) {
    size_t cells = 0;
    p->levels = 0;
    for (int w = (g->width + ISO_DEPTH_CELL - 1) / ISO_DEPTH_CELL,
             h = (g->height + ISO_DEPTH_CELL - 1) / ISO_DEPTH_CELL;
         p->levels < ISO_DEPTH_LEVELS; w = (w + 1) / 2, h = (h + 1) / 2) {
        p->width[p->levels] = w;
        p->height[p->levels++] = h;
        cells += (size_t)w * (size_t)h;
        if (w <= 1 && h <= 1) break;
    }
    ISO_TRY(iso_buffer_reserve(&p->memory, cells * sizeof(float), 0, error));
    float *at = p->memory.data;
    for (int level = 0; level < p->levels; level++) {
        p->level[level] = at;
        at += (size_t)p->width[level] * (size_t)p->height[level];
    }
    const iso_area whole = {{0, g->width - 1}, {0, g->height - 1}, 0};
    iso_depth_pyramid_update(p, g, &whole);
    return ISO_OK;
}

bool iso_depth_pyramid_hides(const iso_depth_pyramid *p, const iso_area *area) {
    enum { MOST_CELLS = 4 }; /* along a side, of those that are looked at */
    if (iso_area_is_empty(area)) return true;
    int level = 0, shift = __builtin_ctz(ISO_DEPTH_CELL);
    while (level + 1 < p->levels &&
           ((area->rows.last >> shift) - (area->rows.first >> shift) >= MOST_CELLS ||
            (area->columns.last >> shift) - (area->columns.first >> shift) >= MOST_CELLS)) {
        level++;
        shift++;
    }
    for (int y = area->rows.first >> shift; y <= area->rows.last >> shift; y++)
        for (int x = area->columns.first >> shift; x <= area->columns.last >> shift; x++)
            if (!(p->level[level][y * p->width[level] + x] < area->nearest)) return false;
    return true;
}

void iso_depth_pyramid_free(iso_depth_pyramid *p) {
    iso_buffer_free(&p->memory);
    *p = (iso_depth_pyramid){0};
}
