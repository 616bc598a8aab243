/* rgrid, hgrid and the common handle, against plain models. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "check_support.h"
#include "grids/brick_index.h"
#include "grids/grid.h"

static double fraction(uint64_t *state) {
    return random_below(state, 1u << 30) / (double)(1u << 30);
}

static int random_side(uint64_t *random) {
    static const int sides[] = {1, 2, 15, 16, 17, 18, 31, 32, 33, 34, 37};
    return sides[random_below(random, sizeof sides / sizeof sides[0])];
}

static int same(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0 || a == b || (isnan(a) && isnan(b));
}

static void free_owner(void *owner) {
    iso_free(owner);
}

/* ---- grids to test with. Voxels that no function may read hold NaN or 77. */

static void random_voxel(iso_rgrid *grid, ptrdiff_t i, int bad, uint64_t *random) {
    switch (grid->type) {
    case ISO_UINT8:
        ((uint8_t *)grid->data)[i] = (uint8_t)random_below(random, 256);
        break;
    case ISO_INT16:
        ((int16_t *)grid->data)[i] = (int16_t)(random_below(random, 65536) - 32768);
        break;
    case ISO_UINT16:
        ((uint16_t *)grid->data)[i] = (uint16_t)random_below(random, 65536);
        break;
    default: {
        const float values[] = {NAN, INFINITY, -INFINITY, FLT_MAX};
        float value = (float)(fraction(random) * 10 - 5);
        ((float *)grid->data)[i] =
            bad && random_below(random, 6) == 0 ? values[random_below(random, 4)] : value;
    }
    }
}

/* A crop out of the middle of a larger random grid, so that strides matter. */
static iso_grid random_rgrid(iso_type type, int bad, uint64_t *random) {
    int lo[3], hi[3];
    iso_rgrid_desc desc = {.type = type};
    for (int axis = 0; axis < 3; axis++) {
        int side = random_side(random);
        lo[axis] = (int)random_below(random, 3);
        hi[axis] = lo[axis] + side - 1;
        desc.dims[axis] = lo[axis] + side + (int)random_below(random, 3);
    }
    iso_grid grid = {0};
    assert_int_equal(iso_rgrid_create(&desc, &grid.rgrid, NULL), ISO_OK);
    ptrdiff_t count = (ptrdiff_t)desc.dims[0] * desc.dims[1] * desc.dims[2];
    for (ptrdiff_t i = 0; i < count; i++) random_voxel(grid.rgrid, i, bad, random);
    assert_int_equal(iso_rgrid_crop(grid.rgrid, lo, hi, NULL), ISO_OK);
    return grid;
}

static void random_brick(iso_hgrid *grid, int cx, int cy, int cz, uint64_t *random) {
    float *brick;
    assert_int_equal(iso_hgrid_split(grid, cx, cy, cz, &brick, NULL), ISO_OK);
    int kind = (int)random_below(random, 3);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        int x = cx * 16 + i % 16, y = cy * 16 + i / 16 % 16, z = cz * 16 + i / 256;
        int inside = x < grid->dims[0] && y < grid->dims[1] && z < grid->dims[2];
        float value = (float)(fraction(random) * 6 - 3);
        brick[i] = !inside ? NAN : kind == 0 ? 2 : kind == 1 ? -1 : value;
    }
}

static iso_grid random_hgrid(uint64_t *random) {
    int dims[3];
    for (int axis = 0; axis < 3; axis++) dims[axis] = random_side(random);
    iso_grid grid = {0};
    assert_int_equal(iso_hgrid_create(dims, 0, NULL, &grid.hgrid, NULL), ISO_OK);
    int bricks = (int)random_below(random, 4);
    for (int z = 0; z < grid.hgrid->cells[2]; z++)
        for (int y = 0; y < grid.hgrid->cells[1]; y++)
            for (int x = 0; x < grid.hgrid->cells[0]; x++) {
                if ((int)random_below(random, 3) < bricks)
                    random_brick(grid.hgrid, x, y, z, random);
                else if (random_below(random, 2))
                    iso_hgrid_coalesce(grid.hgrid, x, y, z, ISO_CELL_INSIDE);
            }
    return grid;
}

/* 0..3: rgrids of each type; 4: an rgrid with NaN and infinities; 5: an hgrid. */
enum { KINDS = 6 };
static iso_grid random_grid(int kind, uint64_t *random) {
    if (kind == 5) return random_hgrid(random);
    return random_rgrid(kind == 4 ? ISO_FLOAT32 : (iso_type)kind, kind == 4, random);
}

/* The model: straight from the documented layout. */
static float model_at(const iso_grid *grid, int x, int y, int z) {
    const int *dims = grid->hgrid ? grid->hgrid->dims : grid->rgrid->dims;
    x = x < 0 ? 0 : x >= dims[0] ? dims[0] - 1 : x;
    y = y < 0 ? 0 : y >= dims[1] ? dims[1] - 1 : y;
    z = z < 0 ? 0 : z >= dims[2] ? dims[2] - 1 : z;
    if (grid->hgrid) {
        const iso_hgrid *h = grid->hgrid;
        int32_t cell = h->cell[(z / 16 * h->cells[1] + y / 16) * h->cells[0] + x / 16];
        if (cell == ISO_CELL_OUTSIDE) return h->band;
        if (cell == ISO_CELL_INSIDE) return -h->band;
        return iso_hgrid_brick(h, cell)[(z % 16 * 16 + y % 16) * 16 + x % 16];
    }
    const iso_rgrid *r = grid->rgrid;
    const char *voxel =
        (const char *)r->data + (x + y * r->stride_y + z * r->stride_z) * (ptrdiff_t)iso_type_size(r->type);
    float value;
    uint16_t bits;
    if (r->type == ISO_UINT8) return *(const unsigned char *)voxel;
    if (r->type == ISO_FLOAT32) {
        memcpy(&value, voxel, sizeof value);
        return value;
    }
    memcpy(&bits, voxel, sizeof bits);
    return r->type == ISO_UINT16 ? bits : bits < 32768 ? bits : (float)(bits - 65536);
}

/* ---- reading */

static void check_window(const iso_grid *grid, const int brick[3]) {
    static float window[ISO_WINDOW_VOXELS + 8];
    for (int i = 0; i < ISO_WINDOW_VOXELS + 8; i++) window[i] = 77;
    iso_grid_window(grid, brick, window);
    for (int i = ISO_WINDOW_VOXELS; i < ISO_WINDOW_VOXELS + 8; i++) assert_true(window[i] == 77);
    for (int i = 0; i < ISO_WINDOW_VOXELS; i++) {
        int x = brick[0] * 16 - 1 + i % 19, y = brick[1] * 16 - 1 + i / 19 % 19,
            z = brick[2] * 16 - 1 + i / 361;
        float wanted = model_at(grid, x, y, z);
        if (!same(window[i], wanted) || !same(iso_grid_at(grid, x, y, z), wanted))
            fail_msg("voxel %d %d %d: window %g, at %g, wanted %g", x, y, z, (double)window[i],
                     (double)iso_grid_at(grid, x, y, z), (double)wanted);
    }
}

static void windows_hold_the_clamped_voxels(void **state) {
    (void)state;
    uint64_t random = 1;
    for (int round = 0; round < 90; round++) {
        iso_grid grid = random_grid(round % KINDS, &random);
        int bricks[3], b[3];
        iso_grid_bricks(&grid, bricks);
        for (b[2] = 0; b[2] < bricks[2]; b[2]++)
            for (b[1] = 0; b[1] < bricks[1]; b[1]++)
                for (b[0] = 0; b[0] < bricks[0]; b[0]++) check_window(&grid, b);
        iso_grid_destroy(&grid);
        assert_null(grid.rgrid);
        assert_null(grid.hgrid);
    }
}

static int model_crosses(const iso_grid *grid, const int brick[3], float isovalue) {
    const int *dims = iso_grid_dims(grid);
    int above = 0, under = 0;
    for (int z = brick[2] * 16; z <= brick[2] * 16 + 16 && z < dims[2]; z++)
        for (int y = brick[1] * 16; y <= brick[1] * 16 + 16 && y < dims[1]; y++)
            for (int x = brick[0] * 16; x <= brick[0] * 16 + 16 && x < dims[0]; x++) {
                float value = model_at(grid, x, y, z);
                if (isfinite(value)) *(value >= isovalue ? &above : &under) = 1;
            }
    return above && under;
}

/* The isovalue is mostly a voxel's own value, or just beside it, where mistakes would show. */
static float random_isovalue(const iso_grid *grid, uint64_t *random) {
    const int *dims = iso_grid_dims(grid);
    float value =
        model_at(grid, (int)random_below(random, (uint32_t)dims[0]),
                 (int)random_below(random, (uint32_t)dims[1]), (int)random_below(random, (uint32_t)dims[2]));
    switch (random_below(random, 6)) {
    case 0:
        return value;
    case 1:
        return nextafterf(value, INFINITY);
    case 2:
        return 65536;
    case 3:
        return grid->hgrid ? grid->hgrid->band : 0;
    default:
        return value + 0.5f;
    }
}

/* Makes most voxels alike, so that both answers occur. */
static void flatten(iso_grid *grid, uint64_t *random) {
    iso_rgrid *r = grid->rgrid;
    if (!r || random_below(random, 2)) return;
    size_t size = iso_type_size(r->type);
    char *voxels = r->data;
    for (int z = 0; z < r->dims[2]; z++)
        for (int y = 0; y < r->dims[1]; y++)
            for (int x = 0; x < r->dims[0]; x++)
                if (random_below(random, 4000))
                    memmove(voxels + (x + y * r->stride_y + z * r->stride_z) * (ptrdiff_t)size, voxels, size);
}

static void crossing_bricks_are_found(void **state) {
    (void)state;
    uint64_t random = 2;
    int answers[2] = {0};
    for (int round = 0; round < 400; round++) {
        iso_grid grid = random_grid(round % KINDS, &random);
        flatten(&grid, &random);
        float isovalue = random_isovalue(&grid, &random);
        int bricks[3], b[3];
        iso_grid_bricks(&grid, bricks);
        for (b[2] = 0; b[2] < bricks[2]; b[2]++)
            for (b[1] = 0; b[1] < bricks[1]; b[1]++)
                for (b[0] = 0; b[0] < bricks[0]; b[0]++) {
                    int wanted = model_crosses(&grid, b, isovalue);
                    assert_int_equal(iso_grid_brick_may_cross(&grid, b, isovalue), wanted);
                    answers[wanted]++;
                }
        iso_grid_destroy(&grid);
    }
    assert_true(answers[0] > 100 && answers[1] > 100);
}

/* ---- sampling */

static double tent(double p, int i, int last) {
    p = p < 0 ? 0 : p > last ? last : p;
    double w = 1 - fabs(p - i);
    return w > 0 ? w : 0;
}

/* Sum of all voxels near p weighted by tents; *finite tells whether all that p's cell has are finite. */
static double model_sample(const iso_grid *grid, iso_vec3 p) {
    const int *dims = iso_grid_dims(grid);
    const double position[3] = {p.x, p.y, p.z};
    int lo[3];
    for (int axis = 0; axis < 3; axis++) {
        double x = fmin(fmax(position[axis], 0), dims[axis] - 1);
        lo[axis] = (int)floor(x);
        if (lo[axis] > dims[axis] - 2) lo[axis] = dims[axis] - 2;
        if (lo[axis] < 0) lo[axis] = 0;
    }
    double sum = 0;
    for (int z = lo[2]; z <= lo[2] + 1 && z < dims[2]; z++)
        for (int y = lo[1]; y <= lo[1] + 1 && y < dims[1]; y++)
            for (int x = lo[0]; x <= lo[0] + 1 && x < dims[0]; x++) {
                float value = model_at(grid, x, y, z);
                if (!isfinite(value)) return NAN;
                sum += (double)value * tent(p.x, x, dims[0] - 1) * tent(p.y, y, dims[1] - 1) *
                       tent(p.z, z, dims[2] - 1);
            }
    return sum;
}

static iso_vec3 random_position(const iso_grid *grid, uint64_t *random) {
    const int *dims = iso_grid_dims(grid);
    double p[3];
    for (int axis = 0; axis < 3; axis++) {
        p[axis] = fraction(random) * (dims[axis] + 3) - 2;
        if (random_below(random, 4) == 0) p[axis] = floor(p[axis]);
        if (random_below(random, 40) == 0) p[axis] = random_below(random, 2) ? 1e300 : -INFINITY;
    }
    return iso_vec3_make(p[0], p[1], p[2]);
}

static double magnitude(const iso_grid *grid) {
    if (grid->hgrid) return 3;
    return grid->rgrid->type == ISO_FLOAT32 ? FLT_MAX : 65536;
}

static void samples_are_trilinear(void **state) {
    (void)state;
    uint64_t random = 3;
    int nan_count = 0;
    for (int round = 0; round < 200; round++) {
        iso_grid grid = random_grid(round % KINDS, &random);
        for (int i = 0; i < 100; i++) {
            iso_vec3 p = random_position(&grid, &random);
            double got = iso_grid_sample(&grid, p), wanted = model_sample(&grid, p);
            double scale = fabs(wanted) > 1e30 ? FLT_MAX : fmin(magnitude(&grid), 65536);
            if (isnan(wanted) != isnan(got) || fabs(got - wanted) > 1e-12 * scale)
                fail_msg("at %g %g %g: %.17g, wanted %.17g", p.x, p.y, p.z, got, wanted);
            nan_count += isnan(wanted);
        }
        iso_grid_destroy(&grid);
    }
    assert_true(nan_count > 100);
}

static void samples_at_voxels_are_their_values(void **state) {
    (void)state;
    uint64_t random = 4;
    for (int round = 0; round < 50; round++) {
        iso_grid grid = random_grid(round % KINDS, &random);
        const int *dims = iso_grid_dims(&grid);
        for (int i = 0; i < 50; i++) {
            int x = (int)random_below(&random, (uint32_t)dims[0]),
                y = (int)random_below(&random, (uint32_t)dims[1]);
            int z = (int)random_below(&random, (uint32_t)dims[2]);
            double got = iso_grid_sample(&grid, iso_vec3_make(x, y, z));
            if (!isnan(got)) assert_true(got == (double)model_at(&grid, x, y, z));
        }
        iso_grid_destroy(&grid);
    }
}

static double model_difference(const iso_grid *grid, const int v[3], int axis) {
    int low[3] = {v[0], v[1], v[2]}, high[3] = {v[0], v[1], v[2]};
    low[axis]--;
    high[axis]++;
    double a = low[axis] < 0 ? NAN : model_at(grid, low[0], low[1], low[2]);
    double m = model_at(grid, v[0], v[1], v[2]);
    double b = high[axis] >= iso_grid_dims(grid)[axis] ? NAN : model_at(grid, high[0], high[1], high[2]);
    if (isfinite(a) && isfinite(b)) return (b - a) / 2;
    if (isfinite(m) && isfinite(b)) return b - m;
    if (isfinite(m) && isfinite(a)) return m - a;
    return 0;
}

static void gradients_are_central_differences(void **state) {
    (void)state;
    uint64_t random = 5;
    for (int round = 0; round < 120; round++) {
        iso_grid grid = random_grid(round % KINDS, &random);
        const int *dims = iso_grid_dims(&grid);
        for (int i = 0; i < 60; i++) {
            int v[3];
            for (int axis = 0; axis < 3; axis++) v[axis] = (int)random_below(&random, (uint32_t)dims[axis]);
            iso_vec3 g = iso_grid_voxel_gradient(&grid, v[0], v[1], v[2]);
            assert_true(g.x == model_difference(&grid, v, 0));
            assert_true(g.y == model_difference(&grid, v, 1));
            assert_true(g.z == model_difference(&grid, v, 2));
        }
        iso_grid_destroy(&grid);
    }
}

static void gradients_are_interpolated(void **state) {
    (void)state;
    uint64_t random = 6;
    for (int round = 0; round < 60; round++) {
        iso_grid grid = random_grid(round % KINDS, &random);
        const int *dims = iso_grid_dims(&grid);
        for (int i = 0; i < 40; i++) {
            iso_vec3 p = random_position(&grid, &random);
            iso_vec3 got = iso_grid_gradient(&grid, p);
            double wanted[3] = {0}, largest = 1;
            int v[3], lo[3];
            const double position[3] = {p.x, p.y, p.z};
            for (int axis = 0; axis < 3; axis++)
                lo[axis] = (int)floor(fmin(fmax(position[axis], 0), dims[axis] - 1));
            for (v[2] = lo[2]; v[2] <= lo[2] + 1 && v[2] < dims[2]; v[2]++)
                for (v[1] = lo[1]; v[1] <= lo[1] + 1 && v[1] < dims[1]; v[1]++)
                    for (v[0] = lo[0]; v[0] <= lo[0] + 1 && v[0] < dims[0]; v[0]++)
                        for (int axis = 0; axis < 3; axis++) {
                            double weight = tent(p.x, v[0], dims[0] - 1) * tent(p.y, v[1], dims[1] - 1) *
                                            tent(p.z, v[2], dims[2] - 1);
                            double d = model_difference(&grid, v, axis);
                            largest = fmax(largest, fabs(d));
                            wanted[axis] += weight * d;
                        }
            const double difference[3] = {got.x - wanted[0], got.y - wanted[1], got.z - wanted[2]};
            for (int axis = 0; axis < 3; axis++)
                if (!(fabs(difference[axis]) <= 1e-12 * largest))
                    fail_msg("gradient %d at %g %g %g: off by %g", axis, p.x, p.y, p.z, difference[axis]);
        }
        iso_grid_destroy(&grid);
    }
}

static void nonfinite_voxels_are_counted(void **state) {
    (void)state;
    uint64_t random = 8;
    iso_pool *pool;
    size_t total = 0;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int round = 0; round < 36; round++) {
        iso_grid grid = random_grid(round % KINDS, &random);
        const int *dims = iso_grid_dims(&grid);
        size_t wanted = 0;
        for (int z = 0; z < dims[2]; z++)
            for (int y = 0; y < dims[1]; y++)
                for (int x = 0; x < dims[0]; x++) wanted += !isfinite(model_at(&grid, x, y, z));
        assert_int_equal(iso_grid_count_nonfinite(&grid, pool), wanted);
        assert_int_equal(iso_grid_count_nonfinite(&grid, NULL), wanted);
        if (grid.rgrid) { /* the index says where to look */
            assert_int_equal(iso_brick_index_of(grid.rgrid, NULL, NULL, NULL), ISO_OK);
            assert_int_equal(iso_grid_count_nonfinite(&grid, pool), wanted);
        }
        total += wanted;
        iso_grid_destroy(&grid);
    }
    assert_true(total > 100);
    iso_pool_destroy(pool);
}

/* ---- rgrid: creation, ownership, crop, touch */

static void count_release(void *owner) {
    ++*(int *)owner;
}

static void lent_data_is_released_once(void **state) {
    (void)state;
    uint8_t voxels[24] = {0};
    int released = 0;
    iso_rgrid *grid = NULL;
    const iso_rgrid_desc good = {
        .dims = {2, 3, 4}, .type = ISO_UINT8, .data = voxels, .release = count_release, .owner = &released};
    assert_int_equal(iso_rgrid_create(&good, &grid, NULL), ISO_OK);
    const int lo[3] = {1, 1, 1}, hi[3] = {1, 2, 3};
    assert_int_equal(iso_rgrid_crop(grid, lo, hi, NULL), ISO_OK);
    assert_int_equal(released, 0);
    assert_ptr_equal(grid->data, voxels + 1 + 2 + 6);
    iso_rgrid_destroy(grid);
    assert_int_equal(released, 1);
    iso_rgrid_destroy(NULL);

    iso_transform flat = iso_transform_identity();
    flat.direction[8] = 0;
    iso_rgrid_desc bad[7];
    for (int i = 0; i < 7; i++) bad[i] = good;
    const iso_status wanted[7] = {ISO_ERR_FORMAT, ISO_ERR_FORMAT, ISO_ERR_FORMAT, ISO_ERR_FORMAT,
                                  ISO_ERR_FORMAT, ISO_ERR_FORMAT, ISO_ERR_LIMIT};
    bad[0].dims[1] = 0;
    bad[1].dims[0] = bad[1].dims[1] = bad[1].dims[2] = INT_MAX;
    bad[2].scale = -1;
    bad[3].scale = NAN;
    bad[4].offset = INFINITY;
    bad[5].transform = &flat;
    bad[6].dims[0] = bad[6].dims[1] = bad[6].dims[2] = 1000000;
    for (int i = 0; i < 7; i++) {
        iso_error error = {0};
        grid = NULL;
        assert_int_equal(iso_rgrid_create(&bad[i], &grid, &error), wanted[i]);
        assert_null(grid);
        assert_int_equal(released, i + 2);
        assert_true(strlen(error.text) > 10);
    }
}

static void rgrid_defaults(void **state) {
    (void)state;
    iso_rgrid *grid;
    iso_rgrid_desc desc = {.dims = {3, 4, 5}, .type = ISO_INT16, .offset = -1024};
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    assert_true(grid->scale == 1 && iso_rgrid_stored(grid, 0) == 1024);
    assert_true(grid->stride_y == 3 && grid->stride_z == 12);
    assert_true(grid->transform.spacing[1] == 1 && grid->transform.direction[4] == 1);
    iso_grid handle = {.rgrid = grid};
    assert_true(iso_grid_stored(&handle, -1024) == 0);
    assert_int_equal(iso_grid_is_level_set(&handle), 0);
    assert_ptr_equal(iso_grid_log(&handle), grid->log);
    assert_ptr_equal(iso_grid_transform(&handle), &grid->transform);
    iso_grid_destroy(&handle);
    assert_string_equal(iso_type_name(ISO_UINT16), "uint16");
    assert_string_equal(iso_type_name(ISO_FLOAT32), "float32");
}

static iso_transform oblique(void) {
    return (iso_transform){.origin = {10, -20, 30},
                           .spacing = {0.5, 0.75, 2},
                           .direction = {0, -1, 0, 0.6, 0, 0.8, -0.8, 0, 0.6}};
}

static void same_point(const iso_transform *a, iso_vec3 at, const iso_transform *b, iso_vec3 shift) {
    iso_affine one = iso_transform_affine(a), other = iso_transform_affine(b);
    iso_vec3 p = iso_affine_point(&one, at), q = iso_affine_point(&other, iso_vec3_sub(at, shift));
    assert_true(iso_vec3_length(iso_vec3_sub(p, q)) < 1e-9);
}

static void crops_show_the_same_voxels(void **state) {
    (void)state;
    uint64_t random = 9;
    for (int round = 0; round < 120; round++) {
        iso_grid whole = random_grid(round % KINDS, &random), part = {0};
        const int *dims = iso_grid_dims(&whole);
        int lo[3], hi[3], side[3];
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = (int)random_below(&random, (uint32_t)dims[axis]);
            hi[axis] = lo[axis] + (int)random_below(&random, (uint32_t)(dims[axis] - lo[axis]));
            side[axis] = hi[axis] - lo[axis] + 1;
        }
        iso_transform transform = oblique();
        iso_rgrid view;
        if (whole.hgrid) {
            whole.hgrid->transform = transform;
            assert_int_equal(iso_hgrid_crop(whole.hgrid, lo, hi, &part.hgrid, NULL), ISO_OK);
        } else {
            whole.rgrid->transform = transform;
            view = *whole.rgrid;
            view.release = NULL;
            const int cells[3] = {1, 1, 1};
            assert_int_equal(iso_change_log_create(cells, &view.log, NULL), ISO_OK);
            assert_int_equal(iso_rgrid_crop(&view, lo, hi, NULL), ISO_OK);
            part.rgrid = &view;
        }
        assert_memory_equal(iso_grid_dims(&part), side, sizeof side);
        assert_int_equal(iso_change_log_now(iso_grid_log(&part)), 0);
        for (int z = 0; z < side[2]; z++)
            for (int y = 0; y < side[1]; y++)
                for (int x = 0; x < side[0]; x++)
                    assert_true(
                        same(iso_grid_at(&part, x, y, z), model_at(&whole, x + lo[0], y + lo[1], z + lo[2])));
        same_point(&transform, iso_vec3_make(3, 5, 7), iso_grid_transform(&part),
                   iso_vec3_make(lo[0], lo[1], lo[2]));
        if (part.rgrid)
            iso_change_log_destroy(part.rgrid->log);
        else
            iso_hgrid_destroy(part.hgrid);
        iso_grid_destroy(&whole);
    }
}

static void bad_crops_are_refused(void **state) {
    (void)state;
    const int dims[3] = {20, 20, 20};
    const int ranges[4][2][3] = {
        {{-1, 0, 0}, {5, 5, 5}}, {{0, 0, 0}, {5, 20, 5}}, {{0, 0, 9}, {5, 5, 8}}, {{30, 0, 0}, {31, 5, 5}}};
    iso_hgrid *hgrid, *cropped = NULL;
    iso_rgrid *rgrid;
    iso_rgrid_desc desc = {.dims = {20, 20, 20}, .type = ISO_UINT8};
    assert_int_equal(iso_hgrid_create(dims, 3, NULL, &hgrid, NULL), ISO_OK);
    assert_int_equal(iso_rgrid_create(&desc, &rgrid, NULL), ISO_OK);
    for (int i = 0; i < 4; i++) {
        iso_error error = {0};
        assert_int_equal(iso_hgrid_crop(hgrid, ranges[i][0], ranges[i][1], &cropped, NULL), ISO_ERR_USAGE);
        assert_int_equal(iso_rgrid_crop(rgrid, ranges[i][0], ranges[i][1], &error), ISO_ERR_USAGE);
        assert_non_null(strstr(error.text, "0..19"));
        assert_null(cropped);
        assert_memory_equal(rgrid->dims, dims, sizeof dims);
    }
    iso_hgrid_destroy(hgrid);
    iso_rgrid_destroy(rgrid);
}

static void touches_are_clipped_to_the_grid(void **state) {
    (void)state;
    const int dims[3] = {20, 33, 16}, lo[3] = {-3, 30, 2}, hi[3] = {INT_MAX, 40, 17};
    iso_hgrid *hgrid;
    iso_rgrid *rgrid;
    iso_rgrid_desc desc = {.dims = {20, 33, 16}, .type = ISO_UINT8};
    assert_int_equal(iso_hgrid_create(dims, 3, NULL, &hgrid, NULL), ISO_OK);
    assert_int_equal(iso_rgrid_create(&desc, &rgrid, NULL), ISO_OK);
    assert_int_equal(iso_hgrid_mark_changed(hgrid, lo, hi, NULL), ISO_OK);
    assert_int_equal(iso_rgrid_mark_changed(rgrid, lo, hi, NULL), ISO_OK);
    const iso_change *changes[2];
    assert_int_equal(iso_change_log_since(hgrid->log, 0, &changes[0]), 4);
    assert_int_equal(iso_change_log_since(rgrid->log, 0, &changes[1]), 4);
    const iso_change last = {.edit = 1, .cell = 5, .lo = {0, 0, 2}, .hi = {3, 0, 15}};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(changes[i][3].edit, last.edit);
        assert_int_equal(changes[i][3].cell, last.cell);
        assert_memory_equal(changes[i][3].lo, last.lo, 3);
        assert_memory_equal(changes[i][3].hi, last.hi, 3);
    }
    assert_int_equal(iso_hgrid_mark_changed(hgrid, lo, hi, NULL), ISO_OK);
    assert_int_equal(iso_change_log_now(hgrid->log), 2);
    iso_hgrid_destroy(hgrid);
    iso_rgrid_destroy(rgrid);
}

/* ---- hgrid: cells and bricks */

static void hgrid_sizes_and_bands(void **state) {
    (void)state;
    const int good[3] = {2048, 1, 17}, large[3] = {16, 2049, 16}, none[3] = {16, 16, 0};
    iso_transform flat = iso_transform_identity();
    flat.spacing[0] = 0;
    iso_hgrid *grid = NULL;
    assert_int_equal(iso_hgrid_create(large, 0, NULL, &grid, NULL), ISO_ERR_LIMIT);
    assert_int_equal(iso_hgrid_create(none, 0, NULL, &grid, NULL), ISO_ERR_FORMAT);
    assert_int_equal(iso_hgrid_create(good, 2.9f, NULL, &grid, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_hgrid_create(good, NAN, NULL, &grid, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_hgrid_create(good, 0, &flat, &grid, NULL), ISO_ERR_FORMAT);
    assert_null(grid);
    assert_int_equal(iso_hgrid_create(good, 0, NULL, &grid, NULL), ISO_OK);
    assert_true(grid->band == 3 && iso_hgrid_at(grid, 2047, 0, 16) == 3);
    assert_int_equal(grid->cells[0], 128);
    assert_int_equal(grid->cells[2], 2);
    assert_int_equal(iso_hgrid_brick_count(grid), 0);
    iso_hgrid_destroy(grid);
    iso_hgrid_destroy(NULL);
}

/* The model of the next test: every voxel of the grid, and where each cell's brick lies. */
enum { SIDE = 135, IN_CELLS = 9, ALL_CELLS = IN_CELLS * IN_CELLS * IN_CELLS };
typedef struct dense {
    float voxel[SIDE][SIDE][SIDE];
    float *brick[ALL_CELLS];
} dense;

static void model_fill(dense *m, const int c[3], float value) {
    for (int z = c[2] * 16; z < c[2] * 16 + 16 && z < SIDE; z++)
        for (int y = c[1] * 16; y < c[1] * 16 + 16 && y < SIDE; y++)
            for (int x = c[0] * 16; x < c[0] * 16 + 16 && x < SIDE; x++) m->voxel[z][y][x] = value;
}

static int model_cell_is(const dense *m, const int c[3], float value) {
    for (int z = c[2] * 16; z < c[2] * 16 + 16 && z < SIDE; z++)
        for (int y = c[1] * 16; y < c[1] * 16 + 16 && y < SIDE; y++)
            for (int x = c[0] * 16; x < c[0] * 16 + 16 && x < SIDE; x++)
                if (m->voxel[z][y][x] != value) return 0;
    return 1;
}

static void split_and_write(iso_hgrid *grid, dense *m, const int c[3], uint64_t *random) {
    size_t cell = iso_hgrid_cell_index(grid, c[0], c[1], c[2]);
    float *brick;
    size_t before = iso_hgrid_brick_count(grid);
    int existed = m->brick[cell] != NULL;
    assert_int_equal(iso_hgrid_split(grid, c[0], c[1], c[2], &brick, NULL), ISO_OK);
    assert_int_equal(iso_hgrid_brick_count(grid), before + !existed);
    assert_int_equal((uintptr_t)brick % 64, 0);
    if (existed) assert_ptr_equal(brick, m->brick[cell]);
    m->brick[cell] = brick;
    for (int i = (int)random_below(random, 3); i > 0; i--) {
        int x = (int)random_below(random, 16), y = (int)random_below(random, 16),
            z = (int)random_below(random, 16);
        float value = random_below(random, 4) ? (float)fraction(random) : 4;
        brick[(z * 16 + y) * 16 + x] = value;
        if (c[0] * 16 + x < SIDE && c[1] * 16 + y < SIDE && c[2] * 16 + z < SIDE)
            m->voxel[c[2] * 16 + z][c[1] * 16 + y][c[0] * 16 + x] = value;
    }
}

static void check_all(const iso_hgrid *grid, const dense *m) {
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++)
                if (iso_hgrid_at(grid, x, y, z) != m->voxel[z][y][x])
                    fail_msg("voxel %d %d %d: %g, wanted %g", x, y, z, (double)iso_hgrid_at(grid, x, y, z),
                             (double)m->voxel[z][y][x]);
}

static void prune_and_check(iso_hgrid *grid, dense *m) {
    iso_hgrid_prune(grid);
    size_t kept = 0;
    for (int cell = 0; cell < ALL_CELLS; cell++) {
        const int c[3] = {cell % IN_CELLS, cell / IN_CELLS % IN_CELLS, cell / IN_CELLS / IN_CELLS};
        int outside = model_cell_is(m, c, 4), inside = model_cell_is(m, c, -4);
        if (outside || inside) m->brick[cell] = NULL;
        if (outside) assert_int_equal(grid->cell[cell], ISO_CELL_OUTSIDE);
        if (inside) assert_int_equal(grid->cell[cell], ISO_CELL_INSIDE);
        assert_int_equal(m->brick[cell] != NULL, grid->cell[cell] >= 0);
        kept += m->brick[cell] != NULL;
    }
    assert_int_equal(iso_hgrid_brick_count(grid), kept);
}

static void cells_split_and_coalesce(void **state) {
    (void)state;
    static dense m;
    const int dims[3] = {SIDE, SIDE, SIDE};
    iso_hgrid *grid;
    assert_int_equal(iso_hgrid_create(dims, 4, NULL, &grid, NULL), ISO_OK);
    for (int cell = 0; cell < ALL_CELLS; cell++) {
        const int c[3] = {cell % IN_CELLS, cell / IN_CELLS % IN_CELLS, cell / IN_CELLS / IN_CELLS};
        model_fill(&m, c, 4);
    }
    uint64_t random = 10;
    size_t most = 0;
    for (int round = 0; round < 8000; round++) {
        int c[3];
        for (int axis = 0; axis < 3; axis++) c[axis] = (int)random_below(&random, IN_CELLS);
        if (random_below(&random, 4)) {
            split_and_write(grid, &m, c, &random);
        } else {
            int inside = (int)random_below(&random, 2);
            iso_hgrid_coalesce(grid, c[0], c[1], c[2], inside ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE);
            model_fill(&m, c, inside ? -4 : 4);
            m.brick[iso_hgrid_cell_index(grid, c[0], c[1], c[2])] = NULL;
        }
        if (iso_hgrid_brick_count(grid) > most) most = iso_hgrid_brick_count(grid);
        if (round % 1000 == 999) check_all(grid, &m);
        if (round % 2000 == 1999) prune_and_check(grid, &m);
    }
    check_all(grid, &m);
    /* More than one chunk was in use, and freed bricks were used again: no more chunks than the most bricks
     * ever in use need. */
    assert_true(most > ISO_POOL_CHUNK);
    assert_int_equal(grid->pool.chunk_count, (most + ISO_POOL_CHUNK - 1) / ISO_POOL_CHUNK);
    assert_true(iso_hgrid_bytes(grid) > most * ISO_BRICK_VOXELS * sizeof(float));
    iso_hgrid_destroy(grid);
}

static void data_of_our_own_is_freed(void **state) {
    (void)state;
    /* With the address sanitizer: neither leaked nor freed twice, also after a crop. */
    iso_rgrid_desc desc = {.dims = {4, 4, 4}, .type = ISO_FLOAT32};
    desc.data = desc.owner = iso_alloc(64 * sizeof(float));
    desc.release = free_owner;
    iso_rgrid *grid;
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    const int lo[3] = {1, 1, 1}, hi[3] = {2, 2, 2};
    assert_int_equal(iso_rgrid_crop(grid, lo, hi, NULL), ISO_OK);
    iso_rgrid_destroy(grid);
    desc.data = NULL;
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    assert_int_equal(iso_rgrid_crop(grid, lo, hi, NULL), ISO_OK);
    assert_true(grid->release != free_owner);
    iso_rgrid_destroy(grid);
}

/* Bricks that lie ready are taken in the same order and filled as others are; what is ready is not in use. */
static void reserved_bricks_are_as_others(void **state) {
    (void)state;
    const int dims[3] = {160, 160, 160};
    iso_hgrid *plain, *reserved;
    assert_int_equal(iso_hgrid_create(dims, 3, NULL, &plain, NULL), ISO_OK);
    assert_int_equal(iso_hgrid_create(dims, 3, NULL, &reserved, NULL), ISO_OK);
    for (int i = 0; i < 600; i++) {
        const int c[3] = {i % 10, i / 10 % 10, i / 100};
        float *brick;
        if (i % 50 == 0) {
            iso_hgrid_reserve(reserved, 300);
            assert_int_equal(iso_hgrid_brick_count(reserved), iso_hgrid_brick_count(plain));
        }
        iso_hgrid_coalesce(reserved, c[0], c[1], c[2], i % 3 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE);
        assert_int_equal(iso_hgrid_split(plain, c[0], c[1], c[2], &brick, NULL), ISO_OK);
        assert_int_equal(iso_hgrid_split(reserved, c[0], c[1], c[2], &brick, NULL), ISO_OK);
        const size_t cell = iso_hgrid_cell_index(plain, c[0], c[1], c[2]);
        assert_int_equal(plain->cell[cell], reserved->cell[cell]);
        for (int k = 0; k < ISO_BRICK_VOXELS; k++) assert_true(brick[k] == (i % 3 ? 3.0f : -3.0f));
    }
    iso_hgrid_destroy(plain);
    iso_hgrid_destroy(reserved);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reserved_bricks_are_as_others),
        cmocka_unit_test(windows_hold_the_clamped_voxels),
        cmocka_unit_test(crossing_bricks_are_found),
        cmocka_unit_test(samples_are_trilinear),
        cmocka_unit_test(samples_at_voxels_are_their_values),
        cmocka_unit_test(gradients_are_central_differences),
        cmocka_unit_test(gradients_are_interpolated),
        cmocka_unit_test(nonfinite_voxels_are_counted),
        cmocka_unit_test(lent_data_is_released_once),
        cmocka_unit_test(rgrid_defaults),
        cmocka_unit_test(crops_show_the_same_voxels),
        cmocka_unit_test(bad_crops_are_refused),
        cmocka_unit_test(touches_are_clipped_to_the_grid),
        cmocka_unit_test(hgrid_sizes_and_bands),
        cmocka_unit_test(cells_split_and_coalesce),
        cmocka_unit_test(data_of_our_own_is_freed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
