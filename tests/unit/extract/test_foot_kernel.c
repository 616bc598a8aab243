/* foot_kernel: every variant against the plain path, on bricks chosen to be awkward and lying between pages
 * that cannot be read; and whole sets against the same. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include <cmocka.h>

#include "base/memory.h"
#include "extract/points/foot_kernel.h"
#include "extract_support.h"

/* ---- memory with a page behind it that faults, and one before it */

enum { PAGE = 4096 };

typedef struct guarded {
    char *pages;
    size_t bytes;
    void *data; /* ends where the last page begins */
} guarded;

static guarded guarded_make(size_t bytes) {
    guarded block = {.bytes = (bytes + PAGE - 1) / PAGE * PAGE + 2 * PAGE};
    block.pages = mmap(NULL, block.bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true(block.pages != MAP_FAILED);
    assert_int_equal(mprotect(block.pages, PAGE, PROT_NONE), 0);
    assert_int_equal(mprotect(block.pages + block.bytes - PAGE, PAGE, PROT_NONE), 0);
    block.data = block.pages + block.bytes - PAGE - bytes;
    return block;
}

/* A brick, its six neighbours and what a kernel makes of them. */
typedef struct bench {
    guarded brick, face[6], packed, surfels, scratch;
} bench;

static void bench_make(bench *b) {
    b->brick = guarded_make(ISO_BRICK_VOXELS * sizeof(float));
    for (int side = 0; side < 6; side++) b->face[side] = guarded_make(ISO_BRICK_VOXELS * sizeof(float));
    b->packed = guarded_make(ISO_FOOT_ROOM * sizeof(iso_point));
    b->surfels = guarded_make(ISO_FOOT_ROOM * sizeof(iso_surfel));
    b->scratch = guarded_make(sizeof(iso_foot_scratch));
}

static void bench_free(bench *b) {
    guarded *const all[] = {&b->brick,   &b->face[0], &b->face[1], &b->face[2], &b->face[3],
                            &b->face[4], &b->face[5], &b->packed,  &b->surfels, &b->scratch};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) munmap(all[i]->pages, all[i]->bytes);
}

/* The brick of a cell with all that it reads moved between guards. */
static iso_foot_brick guarded_brick(const bench *b, const iso_hgrid *grid, const int cell[3]) {
    iso_foot_brick brick;
    iso_foot_brick_of(grid, cell, b->scratch.data, &brick);
    memcpy(b->brick.data, brick.values, ISO_BRICK_VOXELS * sizeof(float));
    brick.values = brick.next = b->brick.data;
    for (int side = 0; side < 6; side++) {
        if (!brick.face[side].mask) continue;
        size_t last = side % 2 ? 0 : (size_t)(ISO_BRICK - 1) << 4 * (side / 2);
        memcpy(b->face[side].data, brick.face[side].base - last, ISO_BRICK_VOXELS * sizeof(float));
        brick.face[side].base = (const float *)b->face[side].data + last;
    }
    return brick;
}

/* ---- awkward grids */

typedef enum pattern {
    NOISE,
    PLANE,
    SPHERE,
    NARROW,  /* noise about the isovalue: nearly every voxel is in the band */
    OUTSIDE, /* bricks, but of the band's value */
    INSIDE,
    SPECIAL, /* a plane with NaN, infinities, zeros of both signs and tiny numbers in it */
    WIDE,    /* gradients whose squares overflow */
    STEEP,   /* a plane whose gradient is far from 1 */
    PATTERNS
} pattern;

static float special_value(test_random *random) {
    const float values[] = {NAN, INFINITY, -INFINITY, -0.0f, 0.0f, 1e-42f, -1e-42f, 1.7320508f, -NAN};
    return values[test_random_int(random, 0, sizeof values / sizeof values[0] - 1)];
}

typedef struct field {
    pattern kind;
    iso_vec3 normal, centre;
    double offset, radius;
    float band, isovalue;
} field;

static float field_at(const field *f, test_random *random, int x, int y, int z) {
    iso_vec3 p = iso_vec3_make(x, y, z);
    double d = iso_vec3_dot(f->normal, p) - f->offset;
    switch (f->kind) {
    case NOISE:
        d = test_random_real(random, -f->band - 1, f->band + 1);
        break;
    case NARROW:
        d = f->isovalue + test_random_real(random, -0.5, 2);
        break;
    case SPHERE:
        d = iso_vec3_length(iso_vec3_sub(p, f->centre)) - f->radius;
        break;
    case OUTSIDE:
        d = INFINITY;
        break;
    case INSIDE:
        d = -INFINITY;
        break;
    case SPECIAL:
        if (test_random_int(random, 0, 19) == 0) return special_value(random);
        break;
    case WIDE:
        d = test_random_int(random, 0, 1) ? test_random_real(random, 0, 2)
                                          : test_random_real(random, -1, 1) * f->band;
        break;
    case STEEP:
        d *= 1.8;
        break;
    default:
        break;
    }
    return (float)fmax(-f->band, fmin(f->band, d));
}

static field random_field(test_random *random, const int dims[3], float isovalue) {
    field f = {.kind = (pattern)test_random_int(random, 0, PATTERNS - 1),
               .band = test_random_int(random, 0, 1) ? 3 : 5.5f,
               .isovalue = isovalue,
               .radius = test_random_real(random, 2, 14)};
    if (f.kind == WIDE) f.band = 3e19f;
    const double axis_aligned = test_random_int(random, 0, 3) == 0 ? 0 : 1;
    f.normal = iso_vec3_unit(iso_vec3_make(test_random_real(random, -1, 1) * axis_aligned,
                                           test_random_real(random, -1, 1) * axis_aligned,
                                           test_random_real(random, 0.1, 1)));
    f.centre = iso_vec3_make(test_random_real(random, 0, dims[0]), test_random_real(random, 0, dims[1]),
                             test_random_real(random, 0, dims[2]));
    f.offset = iso_vec3_dot(f.normal, f.centre);
    return f;
}

/* Some cells stay empty. What lies in bricks beyond dims is noise: it must not matter. */
static iso_grid random_grid(test_random *random, float isovalue) {
    int dims[3], cell[3];
    test_random_dims(random, 1, 40, dims);
    if (test_random_int(random, 0, 2) == 0) dims[test_random_int(random, 0, 2)] = 32;
    field f = random_field(random, dims, isovalue);
    iso_grid grid = test_hgrid(dims, f.band);
    const int *cells = grid.hgrid->cells;
    for (cell[2] = 0; cell[2] < cells[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < cells[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < cells[0]; cell[0]++) {
                if (test_random_int(random, 0, 5) == 0) {
                    int32_t state = test_random_int(random, 0, 1) ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
                    iso_hgrid_coalesce(grid.hgrid, cell[0], cell[1], cell[2], state);
                    continue;
                }
                float *brick;
                assert_int_equal(iso_hgrid_split(grid.hgrid, cell[0], cell[1], cell[2], &brick, NULL),
                                 ISO_OK);
                for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
                    int p[3] = {16 * cell[0] + (i & 15), 16 * cell[1] + (i >> 4 & 15),
                                16 * cell[2] + (i >> 8)};
                    bool inside = p[0] < dims[0] && p[1] < dims[1] && p[2] < dims[2];
                    brick[i] = inside ? field_at(&f, random, p[0], p[1], p[2])
                                      : (float)test_random_real(random, -1, 2);
                }
            }
    return grid;
}

static float random_isovalue(test_random *random) {
    const float values[] = {0, 0, 0, -0.0f, 0.3f, 1.5f, -1.7320508f, -4, 1e-30f, -2.9999f};
    int choice = test_random_int(random, 0, 10);
    return choice == 10 ? (float)test_random_real(random, -2, 2) : values[choice];
}

/* ---- variants against the plain path */

typedef struct totals {
    size_t points, rejected, at_border, bricks;
} totals;

static void check_variant(const iso_foot_kernel *kernel, const bench *b, const iso_foot_surface *surface,
                          const iso_foot_brick *brick, const iso_foot_points *wanted) {
    iso_foot_output packed = {.packed = b->packed.data}, floats = {.surfels = b->surfels.data};
    memset(b->packed.data, 0x5a, ISO_FOOT_ROOM * sizeof(iso_point));
    kernel->extract(surface, brick, b->scratch.data, &packed);
    kernel->extract(surface, brick, b->scratch.data, &floats);
    assert_int_equal(packed.count, wanted->count);
    assert_int_equal(packed.rejected, wanted->rejected);
    assert_int_equal(floats.count, wanted->count);
    assert_int_equal(floats.rejected, wanted->rejected);
    assert_memory_equal(floats.surfels, wanted->points, wanted->count * sizeof(iso_surfel));
    for (uint32_t i = 0; i < wanted->count; i++)
        assert_int_equal(packed.packed[i].bits, iso_point_pack(&wanted->points[i]).bits);
}

static void check_brick(const bench *b, const iso_grid *grid, const iso_foot_surface *surface,
                        const int cell[3], totals *met) {
    static iso_brick_window window;
    static iso_surfel points[ISO_BRICK_VOXELS];
    iso_foot_points wanted = {.points = points};
    iso_brick_window_fill(grid, cell, &window);
    iso_foot_points_direct(&window, surface, &wanted);
    iso_foot_brick brick = guarded_brick(b, grid->hgrid, cell);
    for (int level = 0; level <= (int)iso_cpu_supported(); level++)
        check_variant(iso_foot_kernel_get((iso_cpu_level)level), b, surface, &brick, &wanted);
    met->bricks++;
    met->points += wanted.count;
    met->rejected += wanted.rejected;
    for (uint32_t i = 0; i < wanted.count; i++) {
        int on_border = 0;
        for (int axis = 0; axis < 3; axis++) {
            double p = 16 * cell[axis] + points[i].position[axis];
            on_border |= p < 0.5 || p > grid->hgrid->dims[axis] - 1.5;
        }
        met->at_border += (size_t)on_border;
    }
}

static void variants_give_the_plain_path_bytes(void **state) {
    (void)state;
    test_random random = {2};
    bench b;
    bench_make(&b);
    totals met = {0};
    for (int round = 0; round < 400; round++) {
        float isovalue = random_isovalue(&random);
        iso_grid grid = random_grid(&random, isovalue);
        iso_threshold stored = iso_threshold_of(&grid, (double)isovalue * (1 + 1e-9 * (round % 2)));
        iso_foot_surface surface = iso_foot_surface_of(&stored, grid.hgrid->band);
        int cell[3];
        const int *cells = grid.hgrid->cells;
        for (cell[2] = 0; cell[2] < cells[2]; cell[2]++)
            for (cell[1] = 0; cell[1] < cells[1]; cell[1]++)
                for (cell[0] = 0; cell[0] < cells[0]; cell[0]++)
                    if (grid.hgrid->cell[iso_hgrid_cell_index(grid.hgrid, cell[0], cell[1], cell[2])] >= 0)
                        check_brick(&b, &grid, &surface, cell, &met);
        iso_grid_destroy(&grid);
    }
    print_message("%zu bricks: %zu points, %zu of them at borders, %zu rejected\n", met.bricks, met.points,
                  met.at_border, met.rejected);
    assert_true(met.points > 100000 && met.rejected > 100000 && met.at_border > 10000);
    bench_free(&b);
}

/* A brick of which every voxel has a foot point, and the one with most rejected ones in between. */
static void full_bricks_fit(void **state) {
    (void)state;
    bench b;
    bench_make(&b);
    totals met = {0};
    for (int round = 0; round < 3; round++) {
        iso_grid grid = test_hgrid((int[3]){16, 16, 16}, 3);
        float *brick;
        assert_int_equal(iso_hgrid_split(grid.hgrid, 0, 0, 0, &brick, NULL), ISO_OK);
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
            int sum = (i & 15) + (i >> 4 & 15) + (i >> 8);
            brick[i] = round == 0 ? (float)(sum % 2 * 0.7 + (sum / 2 % 2) * 0.9) : 0.05f * (float)(i >> 8);
            if (round == 2 && i % 7 == 0) brick[i] = NAN;
        }
        iso_threshold stored = iso_threshold_of(&grid, 0);
        iso_foot_surface surface = iso_foot_surface_of(&stored, 3);
        check_brick(&b, &grid, &surface, (int[3]){0, 0, 0}, &met);
        if (round == 0) assert_true(met.points + met.rejected == ISO_BRICK_VOXELS && met.points > 3000);
        iso_grid_destroy(&grid);
    }
    bench_free(&b);
}

/* The upper end of the band is where the distance, as it is rounded, reaches the square root of 3. */
static void the_band_ends_where_rounding_says(void **state) {
    (void)state;
    test_random random = {17};
    for (int round = 0; round < 20000; round++) {
        float magnitude = round % 3 ? 3 : round % 2 ? 1e-3f : 1e9f;
        iso_threshold stored = {.isovalue_ceil = (float)test_random_real(&random, -magnitude, magnitude),
                                .normal_sign = 1};
        if (round % 5 == 0)
            stored.residual =
                -nextafterf(fabsf(stored.isovalue_ceil), INFINITY) + fabsf(stored.isovalue_ceil);
        if (round == 1) stored.isovalue_ceil = -1.7320508f;
        if (round == 2) stored = (iso_threshold){.isovalue_ceil = INFINITY};
        if (round == 3) stored = (iso_threshold){.isovalue_ceil = -3.4028235e38f, .residual = -INFINITY};
        iso_foot_surface surface = iso_foot_surface_of(&stored, 3);
        float v = surface.top;
        for (int i = 0; i < 8; i++) v = nextafterf(v, -INFINITY);
        for (int i = 0; i < 16; i++, v = nextafterf(v, INFINITY)) {
            float distance = v - stored.isovalue_ceil - stored.residual;
            bool in_band = v >= stored.isovalue_ceil && distance < 1.7320508f;
            assert_int_equal(in_band, v >= surface.isovalue_ceil && v < surface.top);
        }
    }
}

/* ---- sets */

/* The set's spans against a kernel called brick after brick. */
static void check_set(const iso_grid *grid, const iso_point_set *set, const iso_foot_kernel *kernel) {
    const iso_hgrid *hgrid = grid->hgrid;
    iso_foot_scratch *scratch = iso_alloc(sizeof *scratch);
    iso_point *points = iso_alloc(ISO_FOOT_ROOM * sizeof *points);
    iso_threshold stored = iso_threshold_of(grid, 0);
    iso_foot_surface surface = iso_foot_surface_of(&stored, hgrid->band);
    iso_point_view view = iso_point_set_view(set);
    size_t span = 0, rejected = 0;
    int c[3];
    for (c[2] = 0; c[2] < hgrid->cells[2]; c[2]++)
        for (c[1] = 0; c[1] < hgrid->cells[1]; c[1]++)
            for (c[0] = 0; c[0] < hgrid->cells[0]; c[0]++) {
                if (hgrid->cell[iso_hgrid_cell_index(hgrid, c[0], c[1], c[2])] < 0) continue;
                iso_foot_brick brick;
                iso_foot_brick_of(hgrid, c, scratch, &brick);
                iso_foot_output wanted = {.packed = points};
                kernel->extract(&surface, &brick, scratch, &wanted);
                rejected += wanted.rejected;
                if (!wanted.count) continue;
                assert_true(span < view.span_count);
                const iso_point_span *got = &view.spans[span++];
                assert_memory_equal(got->brick, c, sizeof c);
                assert_int_equal(got->count, wanted.count);
                assert_memory_equal(view.packed + got->first, points, wanted.count * sizeof *points);
            }
    assert_int_equal(span, view.span_count);
    assert_int_equal(rejected, iso_point_set_stats(set).rejected);
    iso_free(points);
    iso_free(scratch);
}

/* One thread writes points to their place at once, more threads go through chunks: the bytes are the same. */
static void sets_hold_what_any_kernel_makes(void **state) {
    (void)state;
    test_random random = {23};
    const int threads[] = {1, 2, 7};
    for (int round = 0; round < 12; round++) {
        iso_grid grid =
            round ? random_grid(&random, 0) : test_ball_grid(150, iso_vec3_make(74.1, 75.3, 76.2), 60, 0);
        iso_points_opts opts = {.floats = round % 2};
        iso_point_set *first = NULL;
        for (int t = 0; t < 3; t++) {
            assert_int_equal(iso_pool_create(threads[t], &opts.pool, NULL), ISO_OK);
            iso_point_set *set = test_point_set(&grid, &opts);
            for (int level = 0; level <= (int)iso_cpu_supported() && !opts.floats; level++)
                check_set(&grid, set, iso_foot_kernel_get((iso_cpu_level)level));
            if (!first) first = test_point_set(&grid, &(iso_points_opts){.floats = opts.floats});
            iso_point_view a = iso_point_set_view(first), v = iso_point_set_view(set);
            assert_int_equal(a.span_count, v.span_count);
            assert_int_equal(iso_point_view_count(&a), iso_point_view_count(&v));
            if (a.span_count) assert_memory_equal(a.spans, v.spans, a.span_count * sizeof *a.spans);
            size_t bytes = iso_point_view_count(&a) * (opts.floats ? sizeof(iso_surfel) : sizeof(iso_point));
            const void *p = opts.floats ? (const void *)a.surfels : a.packed;
            const void *q = opts.floats ? (const void *)v.surfels : v.packed;
            if (bytes) assert_memory_equal(p, q, bytes);
            iso_point_set_destroy(set);
            iso_pool_destroy(opts.pool);
        }
        iso_point_set_destroy(first);
        iso_grid_destroy(&grid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variants_give_the_plain_path_bytes),
        cmocka_unit_test(full_bricks_fit),
        cmocka_unit_test(the_band_ends_where_rounding_says),
        cmocka_unit_test(sets_hold_what_any_kernel_makes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
