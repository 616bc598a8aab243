/* sculpt_support: balls to sculpt, and measurements of fields. */
#include "sculpt_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void fill_cell(iso_hgrid *grid, int cx, int cy, int cz, iso_vec3 centre, double radius) {
    float values[ISO_BRICK_VOXELS], *brick;
    bool band = false;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        iso_vec3 p = iso_vec3_make(16 * cx + i % 16, 16 * cy + i / 16 % 16, 16 * cz + i / 256);
        double d = iso_vec3_length(iso_vec3_sub(p, centre)) - radius, most = (double)grid->band;
        values[i] = (float)(d > most ? most : d < -most ? -most : d);
        band |= fabsf(values[i]) < grid->band;
    }
    iso_hgrid_coalesce(grid, cx, cy, cz, values[0] < 0 ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE);
    if (!band) return;
    assert_int_equal(iso_hgrid_split(grid, cx, cy, cz, &brick, NULL), ISO_OK);
    memcpy(brick, values, sizeof values);
}

iso_hgrid *sculpt_ball(int side, iso_vec3 centre, double radius) {
    const int dims[3] = {side, side, side};
    iso_hgrid *grid;
    assert_int_equal(iso_hgrid_create(dims, 3, NULL, &grid, NULL), ISO_OK);
    for (int z = 0; z < grid->cells[2]; z++)
        for (int y = 0; y < grid->cells[1]; y++)
            for (int x = 0; x < grid->cells[0]; x++) fill_cell(grid, x, y, z, centre, radius);
    return grid;
}

iso_hgrid *sculpt_copy(const iso_hgrid *grid) {
    const int lo[3] = {0, 0, 0}, hi[3] = {grid->dims[0] - 1, grid->dims[1] - 1, grid->dims[2] - 1};
    iso_hgrid *copy;
    assert_int_equal(iso_hgrid_crop(grid, lo, hi, &copy, NULL), ISO_OK);
    return copy;
}

bool sculpt_same(const iso_hgrid *a, const iso_hgrid *b) {
    for (int z = 0; z < a->cells[2]; z++)
        for (int y = 0; y < a->cells[1]; y++)
            for (int x = 0; x < a->cells[0]; x++) {
                size_t cell = iso_hgrid_cell_index(a, x, y, z);
                if (a->cell[cell] < 0 || b->cell[cell] < 0) {
                    if (a->cell[cell] != b->cell[cell]) return false;
                } else if (memcmp(iso_hgrid_brick(a, a->cell[cell]), iso_hgrid_brick(b, b->cell[cell]),
                                  ISO_BRICK_VOXELS * sizeof(float)))
                    return false;
            }
    return true;
}

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

typedef struct samples {
    float *gradient, *foot;
    size_t count, clamped;
} samples;

static void measure_voxel(const iso_hgrid *grid, const int p[3], samples *s) {
    const iso_grid any = {.hgrid = (iso_hgrid *)grid};
    float v = iso_hgrid_at(grid, p[0], p[1], p[2]), g[3], square = 0;
    if (!(v >= 0 && v < 1.7320508f)) return;
    bool clamped = false;
    for (int axis = 0; axis < 3; axis++) {
        int low[3] = {p[0], p[1], p[2]}, high[3] = {p[0], p[1], p[2]};
        low[axis]--;
        high[axis]++;
        float a = iso_hgrid_at(grid, low[0], low[1], low[2]),
              b = iso_hgrid_at(grid, high[0], high[1], high[2]);
        clamped |= fabsf(a) >= grid->band || fabsf(b) >= grid->band;
        g[axis] = 0.5f * (b - a);
        square += g[axis] * g[axis];
    }
    float length = sqrtf(square);
    iso_vec3 foot =
        iso_vec3_make(p[0] - v * g[0] / length, p[1] - v * g[1] / length, p[2] - v * g[2] / length);
    s->clamped += clamped;
    s->gradient[s->count] = fabsf(length - 1);
    s->foot[s->count++] = (float)fabs(iso_grid_sample(&any, foot));
}

sculpt_quality sculpt_measure(const iso_hgrid *grid, uint64_t seen) {
    size_t room = iso_hgrid_brick_count(grid) * ISO_BRICK_VOXELS + 1;
    samples s = {malloc(room * sizeof(float)), malloc(room * sizeof(float)), 0, 0};
    assert_true(s.gradient && s.foot);
    const int *n = grid->dims;
    for (int z = 3; z < n[2] - 3; z++)
        for (int y = 3; y < n[1] - 3; y++)
            for (int x = 3; x < n[0] - 3; x++) {
                uint32_t cell = (uint32_t)iso_hgrid_cell_index(grid, x / 16, y / 16, z / 16);
                if (grid->cell[cell] < 0 || iso_change_log_last_edit(grid->log, cell) <= seen) continue;
                measure_voxel(grid, (int[3]){x, y, z}, &s);
            }
    assert_true(s.count > 0);
    sculpt_quality q = {.voxels = s.count, .clamped = s.clamped};
    for (size_t i = 0; i < s.count; i++) q.gradient_mean += (double)s.gradient[i] / (double)s.count;
    qsort(s.gradient, s.count, sizeof(float), compare_floats);
    qsort(s.foot, s.count, sizeof(float), compare_floats);
    q.gradient_p99 = (double)s.gradient[s.count * 99 / 100];
    q.foot_p99 = (double)s.foot[s.count * 99 / 100];
    q.foot_max = (double)s.foot[s.count - 1];
    free(s.gradient);
    free(s.foot);
    return q;
}

iso_vec3 sculpt_pick(const iso_hgrid *grid, iso_vec3 centre, iso_vec3 direction) {
    const iso_grid any = {.hgrid = (iso_hgrid *)grid};
    double inside = 0, outside = 0;
    for (double r = 80; r > 0 && !(inside > 0); r -= 0.5)
        if (iso_grid_sample(&any, iso_vec3_add(centre, iso_vec3_scale(direction, r))) < 0)
            inside = r;
        else
            outside = r;
    for (int i = 0; i < 40; i++) {
        double middle = (inside + outside) / 2;
        if (iso_grid_sample(&any, iso_vec3_add(centre, iso_vec3_scale(direction, middle))) < 0)
            inside = middle;
        else
            outside = middle;
    }
    return iso_vec3_add(centre, iso_vec3_scale(direction, inside));
}

iso_edit_stats sculpt_touch(iso_editor *editor, const iso_brush *brush, iso_vec3 at, iso_vec3 normal) {
    iso_sample sample = {.position = at, .normal = normal, .pressure = 1};
    iso_touch touch = {.sample = sample, .previous = sample, .first = sample};
    iso_edit_stats stats;
    iso_error error = {0};
    if (iso_editor_touch(editor, brush, &touch, &stats, &error) != ISO_OK) fail_msg("%s", error.text);
    return stats;
}

double sculpt_volume(const iso_hgrid *grid) {
    const iso_grid any = {.hgrid = (iso_hgrid *)grid};
    double volume = 0;
    for (size_t cell = 0; cell < (size_t)grid->cells[0] * (size_t)grid->cells[1] * (size_t)grid->cells[2];
         cell++) {
        if (grid->cell[cell] == ISO_CELL_INSIDE) volume += ISO_BRICK_VOXELS;
        if (grid->cell[cell] < 0) continue;
        const float *brick = iso_hgrid_brick(grid, grid->cell[cell]);
        const int base[3] = {(int)(cell % (size_t)grid->cells[0]) * 16,
                             (int)(cell / (size_t)grid->cells[0] % (size_t)grid->cells[1]) * 16,
                             (int)(cell / (size_t)grid->cells[0] / (size_t)grid->cells[1]) * 16};
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
            if (fabsf(brick[i]) > 1) {
                volume += brick[i] < 0;
                continue;
            }
            for (int k = 0; k < 64; k++) {
                double at[3] = {(k % 4 + 0.5) / 4 - 0.5, (k / 4 % 4 + 0.5) / 4 - 0.5,
                                (k / 16 + 0.5) / 4 - 0.5};
                iso_vec3 p = iso_vec3_make(base[0] + i % 16 + at[0], base[1] + i / 16 % 16 + at[1],
                                           base[2] + i / 256 + at[2]);
                volume += iso_grid_sample(&any, p) < 0 ? 1.0 / 64 : 0;
            }
        }
    }
    return volume;
}
