/* The .vdb reader with files that OpenVDB wrote, compared voxel by voxel. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/memory.h"
#include "check_support.h"
#include "file_support.h"
#include "grids/volume/vdb_check.h"
#include "grids/volume/vectors_read.h"
#include "grids/volume/volume.h"
#include "vdb_files.h"
#include "volume_support.h"

#define FILE_PATH ISO_TEST_TMP "/test_vdb.vdb"
#define CUT_PATH ISO_TEST_TMP "/test_vdb_cut.vdb"

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void write_ok(const vdb_spec *specs, int count, int flags) {
    assert_int_equal(vdb_write(FILE_PATH, specs, count, flags), 0);
}

/* ---- values that tests write ---- */

static uint32_t voxel_hash(const int v[3], int component) {
    return test_hash(test_hash(test_hash((uint32_t)v[0]) + (uint32_t)v[1]) + (uint32_t)v[2] +
                     977U * (uint32_t)component);
}

/* Random integers below 1000, a third of the voxels inactive; the corners of the box are always active, so
 * that it is the active bounding box. */
typedef struct noise {
    int lo[3], hi[3];
    uint32_t range;
} noise;

static double noise_value(const void *context, const int v[3], int component, int *active) {
    const noise *n = context;
    int corner = (v[0] == n->lo[0] && v[1] == n->lo[1] && v[2] == n->lo[2]) ||
                 (v[0] == n->hi[0] && v[1] == n->hi[1] && v[2] == n->hi[2]);
    *active = corner || voxel_hash(v, 7) % 3 != 0;
    return 1 + voxel_hash(v, component) % n->range;
}

static vdb_spec noise_spec(const noise *n, const char *type) {
    vdb_spec spec = {.name = "noise", .type = type, .value = noise_value, .context = n};
    memcpy(spec.lo, n->lo, sizeof spec.lo);
    memcpy(spec.hi, n->hi, sizeof spec.hi);
    memcpy(spec.axis, identity, sizeof identity);
    return spec;
}

/* Distance to a sphere, in units of `scale`, active within `band` voxels. */
typedef struct ball {
    double centre[3], radius, band, scale;
} ball;

static double ball_voxels(const ball *b, const int v[3]) {
    double d[3];
    for (int i = 0; i < 3; i++) d[i] = v[i] - b->centre[i];
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - b->radius;
}

static double ball_value(const void *context, const int v[3], int component, int *active) {
    const ball *b = context;
    (void)component;
    double distance = ball_voxels(b, v);
    *active = fabs(distance) < b->band;
    return distance * b->scale;
}

static vdb_spec ball_spec(const ball *b, double voxel) {
    vdb_spec spec = {.name = "ball",
                     .type = "float",
                     .grid_class = VDB_LEVEL_SET,
                     .background = b->band * b->scale,
                     .value = ball_value,
                     .context = b};
    for (int i = 0; i < 3; i++) {
        spec.lo[i] = (int)floor(b->centre[i] - b->radius - b->band - 1);
        spec.hi[i] = (int)ceil(b->centre[i] + b->radius + b->band + 1);
    }
    for (int i = 0; i < 9; i++) spec.axis[i] = identity[i] * voxel;
    return spec;
}

/* ---- dense grids ---- */

static double noise_expected(const vdb_spec *spec, const int v[3], int component) {
    int active;
    double value = noise_value(spec->context, v, component, &active);
    if (strcmp(spec->type, "bool") == 0 || strcmp(spec->type, "mask") == 0) value = 1;
    return active ? value : spec->background;
}

static void check_noise(const vdb_spec *spec, int flags, int component, iso_pool *pool) {
    write_ok(spec, 1, flags);
    iso_volume_opts opts = {.component = component, .pool = pool};
    iso_volume volume = test_read_volume(FILE_PATH, &opts);
    const iso_rgrid *grid = volume.grid.rgrid;
    assert_non_null(grid);
    assert_int_equal(grid->level_set, 0);
    int v[3];
    for (int i = 0; i < 3; i++) assert_int_equal(grid->dims[i], spec->hi[i] - spec->lo[i] + 1);
    for (v[2] = spec->lo[2]; v[2] <= spec->hi[2]; v[2]++)
        for (v[1] = spec->lo[1]; v[1] <= spec->hi[1]; v[1]++)
            for (v[0] = spec->lo[0]; v[0] <= spec->hi[0]; v[0]++) {
                float got = iso_rgrid_at(grid, v[0] - spec->lo[0], v[1] - spec->lo[1], v[2] - spec->lo[2]);
                float wanted = (float)noise_expected(spec, v, component);
                if (got != wanted)
                    fail_msg("%s at %d %d %d: %g, not %g", spec->type, v[0], v[1], v[2], (double)got,
                             (double)wanted);
            }
    iso_volume_free(&volume);
}

static void dense_types(void **state) {
    (void)state;
    const noise n = {{-13, 5, -3}, {10, 30, 21}, 1000};
    static const char *const types[] = {"float", "double", "int32", "int64", "bool", "mask", "vec3s"};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        vdb_spec spec = noise_spec(&n, types[i]);
        spec.background = strcmp(types[i], "bool") == 0 || strcmp(types[i], "mask") == 0 ? 0 : -5;
        check_noise(&spec, VDB_BLOSC | VDB_ACTIVE_MASK, 0, NULL);
    }
    vdb_spec vectors = noise_spec(&n, "vec3s");
    check_noise(&vectors, VDB_ZIP, 1, NULL);
    check_noise(&vectors, VDB_ZIP, 2, NULL);
    iso_volume_opts opts = {.component = 3};
    test_expect_no_volume(FILE_PATH, &opts, ISO_ERR_USAGE, NULL, "no component 3");
    iso_volume volume = test_read_volume(FILE_PATH, NULL);
    assert_int_equal(volume.info.components, 3);
    assert_true(test_has_note(&volume.info, "components"));
    iso_volume_free(&volume);
}

static void dense_storage(void **state) {
    (void)state;
    const noise n = {{-8, -16, 8}, {7, -1, 23}, 1000};
    static const int flags[] = {0,
                                VDB_ZIP,
                                VDB_BLOSC,
                                VDB_ACTIVE_MASK,
                                VDB_ZIP | VDB_ACTIVE_MASK,
                                VDB_STREAM | VDB_BLOSC,
                                VDB_NO_STATS | VDB_ZIP,
                                VDB_STREAM | VDB_NO_STATS};
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        vdb_spec spec = noise_spec(&n, "float");
        check_noise(&spec, flags[i], 0, i % 2 ? pool : NULL);
        spec.half = 1; /* halves hold integers up to 2048 */
        check_noise(&spec, flags[i], 0, pool);
    }
    iso_volume volume = test_read_volume(FILE_PATH, NULL);
    assert_string_equal(volume.info.file_type, "half");
    iso_volume_free(&volume);
    iso_pool_destroy(pool);
}

static void one_voxel(void **state) {
    (void)state;
    const noise n = {{5, 5, 5}, {5, 5, 5}, 1000};
    vdb_spec spec = noise_spec(&n, "float");
    check_noise(&spec, VDB_ZIP, 0, NULL);
}

/* ---- level sets ---- */

static void check_ball(const iso_volume *volume, const ball *b, const vdb_spec *spec) {
    const iso_hgrid *grid = volume->grid.hgrid;
    assert_non_null(grid);
    assert_true(volume->info.sparse && volume->info.level_set);
    double band = fmax(b->band, 3);
    assert_true(fabs((double)grid->band - band) < 1e-5);
    iso_affine affine = iso_transform_affine(&grid->transform);
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++) {
                /* Through world and back, so that a wrong transform cannot cancel a wrong origin. */
                iso_vec3 world = iso_affine_point(&affine, iso_vec3_make(x, y, z));
                double w[3] = {world.x - spec->origin[0], world.y - spec->origin[1],
                               world.z - spec->origin[2]};
                int v[3];
                double size2 = spec->axis[0] * spec->axis[0] + spec->axis[3] * spec->axis[3] +
                               spec->axis[6] * spec->axis[6];
                for (int i = 0; i < 3; i++)
                    v[i] = (int)lround(
                        (spec->axis[i] * w[0] + spec->axis[3 + i] * w[1] + spec->axis[6 + i] * w[2]) / size2);
                double wanted = ball_voxels(b, v), got = (double)iso_hgrid_at(grid, x, y, z);
                if (fabs(wanted) >= b->band) wanted = wanted > 0 ? (double)grid->band : -(double)grid->band;
                if (fabs(got - wanted) > 1e-4) fail_msg("at %d %d %d: %g, not %g", x, y, z, got, wanted);
            }
}

static void level_set_cubic(void **state) {
    (void)state;
    static const double bands[] = {3, 4.5, 2};
    for (int i = 0; i < 3; i++) {
        const ball b = {{-7.3, 41.2, 3.1}, 45, bands[i], 0.25};
        vdb_spec spec = ball_spec(&b, 0.25);
        spec.origin[1] = 100;
        write_ok(&spec, 1, VDB_BLOSC | VDB_ACTIVE_MASK);
        iso_volume volume = test_read_volume(FILE_PATH, NULL);
        check_ball(&volume, &b, &spec);
        assert_int_equal(test_has_note(&volume.info, "narrow band"), bands[i] < 3);
        const iso_hgrid *grid = volume.grid.hgrid;
        int inside = 0, outside = 0;
        for (int c = 0; c < grid->cells[0] * grid->cells[1] * grid->cells[2]; c++) {
            inside += grid->cell[c] == ISO_CELL_INSIDE;
            outside += grid->cell[c] == ISO_CELL_OUTSIDE;
        }
        assert_true(inside >= 1 && outside >= 1);
        assert_false(volume.info.anatomical);
        iso_volume_free(&volume);
    }
}

static void level_set_rotated(void **state) {
    (void)state;
    const ball b = {{4, -3, 11}, 12, 3, 0.5};
    vdb_spec spec = ball_spec(&b, 0.5);
    /* Rotated by the angle of a 3-4-5 triangle about z, and x mirrored. */
    const double axis[9] = {-0.3, -0.4, 0, -0.4, 0.3, 0, 0, 0, 0.5};
    memcpy(spec.axis, axis, sizeof axis);
    spec.origin[2] = -20;
    write_ok(&spec, 1, VDB_ZIP);
    iso_volume volume = test_read_volume(FILE_PATH, NULL);
    check_ball(&volume, &b, &spec);
    assert_true(fabs(volume.info.transform.spacing[0] - 0.5) < 1e-12);
    assert_true(fabs(volume.info.transform.direction[0] + 0.6) < 1e-12);
    assert_true(fabs(volume.info.transform.direction[3] + 0.8) < 1e-12);
    iso_volume_free(&volume);
}

static void level_set_threads(void **state) {
    (void)state;
    const ball b = {{0.2, 0.1, 0.4}, 30, 3, 1};
    vdb_spec spec = ball_spec(&b, 1);
    spec.type = "double";
    write_ok(&spec, 1, VDB_ZIP);
    iso_volume one = test_read_volume(FILE_PATH, NULL);
    check_ball(&one, &b, &spec);
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(4, &pool, NULL), ISO_OK);
    iso_volume_opts opts = {.pool = pool};
    iso_volume four = test_read_volume(FILE_PATH, &opts);
    const iso_hgrid *g = one.grid.hgrid, *h = four.grid.hgrid;
    size_t cells = iso_hgrid_cell_count(g);
    assert_memory_equal(g->cell, h->cell, cells * sizeof *g->cell);
    for (size_t c = 0; c < cells; c++)
        if (g->cell[c] >= 0)
            assert_memory_equal(iso_hgrid_brick(g, g->cell[c]), iso_hgrid_brick(h, h->cell[c]),
                                ISO_BRICK_VOXELS * sizeof(float));
    iso_volume_free(&one);
    iso_volume_free(&four);
    iso_pool_destroy(pool);
}

/* Stretched or sheared voxels: world distances in an rgrid that is marked as a level set. */
static void level_set_not_cubic(void **state) {
    (void)state;
    const ball b = {{3, 4, 5}, 8, 3, 0.5};
    for (int shear = 0; shear < 2; shear++) {
        vdb_spec spec = ball_spec(&b, 0.5);
        if (shear)
            spec.axis[1] = 0.1;
        else
            spec.axis[8] = 0.75;
        write_ok(&spec, 1, VDB_ZIP);
        iso_volume volume = test_read_volume(FILE_PATH, NULL);
        const iso_rgrid *grid = volume.grid.rgrid;
        assert_non_null(grid);
        assert_int_equal(grid->level_set, 1);
        assert_true(volume.info.level_set && !volume.info.sparse);
        iso_affine affine = iso_transform_affine(&grid->transform);
        iso_vec3 step = iso_affine_vector(&affine, iso_vec3_make(0, 1, 1));
        assert_true(fabs(step.x - spec.axis[1]) < 1e-12 && fabs(step.y - 0.5) < 1e-12 &&
                    fabs(step.z - spec.axis[8]) < 1e-12);
        const int middle[3] = {grid->dims[0] / 2, grid->dims[1] / 2, grid->dims[2] / 2};
        assert_true((double)iso_rgrid_at(grid, middle[0], middle[1], middle[2]) == -1.5);
        assert_true((double)iso_rgrid_at(grid, 0, 0, 0) == 1.5);
        iso_volume_free(&volume);
    }
}

static double slab_value(const void *context, const int v[3], int component, int *active) {
    (void)context, (void)component;
    *active = v[0] % 97 == 0 || v[0] == 2050;
    return v[0] < 1000 ? -0.5 : 0.5;
}

static void limits(void **state) {
    (void)state;
    vdb_spec spec = {.name = "long",
                     .type = "float",
                     .grid_class = VDB_LEVEL_SET,
                     .background = 3,
                     .hi = {2050, 0, 0},
                     .value = slab_value};
    memcpy(spec.axis, identity, sizeof identity);
    write_ok(&spec, 1, VDB_ZIP);
    test_expect_no_volume(FILE_PATH, NULL, ISO_ERR_LIMIT, NULL, "2048");
    const noise n = {{0, 0, 0}, {63, 63, 63}, 1000};
    vdb_spec dense = noise_spec(&n, "float");
    dense.hi[0] = dense.hi[1] = dense.hi[2] = 63;
    write_ok(&dense, 1, VDB_ZIP);
    iso_volume_opts opts = {.max_memory = 1000000};
    test_expect_no_volume(FILE_PATH, &opts, ISO_ERR_LIMIT, NULL, "limit");
    iso_volume volume = test_read_volume(FILE_PATH, NULL);
    assert_true(volume.info.bytes == 64 * 64 * 64 * 4);
    assert_true(volume.info.read_bytes >= 2 * volume.info.bytes);
    iso_volume_free(&volume);
}

/* A file that was written as a stream is read to be looked at: that, too, keeps the limit, and so does one
 * that says nothing of its size. */
static void limits_without_statistics(void **state) {
    (void)state;
    const noise n = {{0, 0, 0}, {63, 63, 63}, 1000};
    vdb_spec spec = noise_spec(&n, "float");
    const iso_volume_opts opts = {.max_memory = 1000000};
    const int flags[] = {VDB_STREAM | VDB_ZIP, VDB_NO_STATS | VDB_ZIP};
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        write_ok(&spec, 1, flags[i]);
        test_expect_no_volume(FILE_PATH, &opts, ISO_ERR_LIMIT, NULL, "limit");
        iso_volume_info info;
        if (i == 0) assert_int_equal(iso_volume_read_info(FILE_PATH, &opts, &info, NULL), ISO_ERR_LIMIT);
        iso_volume volume = test_read_volume(FILE_PATH, NULL);
        assert_true(volume.info.read_bytes >= 2 * volume.info.bytes);
        iso_volume_free(&volume);
    }
}

/* One voxel of the surface in each leaf, far apart: eight times as many bricks as leaves, where a surface
 * needs half as many. */
static double scattered_value(const void *context, const int voxel[3], int component, int *active) {
    (void)context;
    (void)component;
    *active = voxel[0] % 16 == 0 && voxel[1] % 16 == 0 && voxel[2] % 16 == 0;
    return 0.5;
}

static void scattered_leaves_keep_the_limit(void **state) {
    (void)state;
    vdb_spec spec = {.name = "dust",
                     .type = "float",
                     .grid_class = VDB_LEVEL_SET,
                     .background = 3,
                     .hi = {240, 240, 240},
                     .value = scattered_value};
    memcpy(spec.axis, identity, sizeof identity);
    write_ok(&spec, 1, VDB_ZIP | VDB_ACTIVE_MASK);
    iso_volume_info info;
    assert_int_equal(iso_volume_read_info(FILE_PATH, NULL, &info, NULL), ISO_OK);
    const iso_volume_opts opts = {.max_memory = info.read_bytes + (1 << 20)};
    test_expect_no_volume(FILE_PATH, &opts, ISO_ERR_LIMIT, NULL, "bricks of a level set");
    iso_volume volume = test_read_volume(FILE_PATH, NULL);
    iso_volume_free(&volume);
}

/* ---- which grid ---- */

static void choosing(void **state) {
    (void)state;
    const noise n = {{0, 0, 0}, {9, 9, 9}, 50}, wide = {{0, 0, 0}, {19, 9, 9}, 50};
    const ball b = {{0, 0, 0}, 6, 3, 1};
    vdb_spec specs[3] = {noise_spec(&n, "vec3s"), noise_spec(&wide, "float"), ball_spec(&b, 1)};
    specs[0].name = "velocity";
    specs[1].name = "density";
    write_ok(specs, 2, VDB_ZIP);
    iso_volume volume = test_read_volume(FILE_PATH, NULL);
    assert_string_equal(volume.info.name, "density");
    assert_int_equal(volume.info.item_count, 2);
    assert_int_equal(volume.grid.rgrid->dims[0], 20);
    assert_true(test_has_note(&volume.info, "\"density\" of 2"));
    iso_volume_free(&volume);

    write_ok(specs, 3, VDB_ZIP);
    volume = test_read_volume(FILE_PATH, NULL);
    assert_string_equal(volume.info.name, "ball");
    assert_non_null(volume.grid.hgrid);
    iso_volume_free(&volume);

    iso_volume_opts opts = {.grid = "velocity", .component = 2};
    volume = test_read_volume(FILE_PATH, &opts);
    assert_int_equal(volume.grid.rgrid->dims[0], 10);
    assert_true(strstr(volume.info.items[1], "density") && strstr(volume.info.items[1], "20x10x10"));
    iso_volume_free(&volume);
    opts = (iso_volume_opts){.grid = "heat"};
    test_expect_no_volume(FILE_PATH, &opts, ISO_ERR_USAGE, NULL, "velocity");
}

/* Vectors come before level sets, and those in local space turn with the axes of the voxels. */
static void vectors(void **state) {
    (void)state;
    const noise n = {{0, 0, 0}, {9, 9, 9}, 50};
    const ball b = {{0, 0, 0}, 6, 3, 1};
    const double turned[9] = {0, -2, 0, 2, 0, 0, 0, 0, 2};
    vdb_spec specs[2] = {ball_spec(&b, 1), noise_spec(&n, "vec3s")};
    memcpy(specs[1].axis, turned, sizeof turned);
    for (int local = 0; local < 2; local++) {
        iso_vectors v = {0};
        iso_vectors_info info;
        iso_error error = {0};
        specs[1].local = local;
        write_ok(specs, 2, VDB_ZIP);
        test_ok(iso_vectors_read(FILE_PATH, NULL, &v, &info, &error), &error);
        assert_string_equal(info.volume.name, "noise");
        const int at[3] = {4, 5, 6};
        const float *got =
            iso_vectors_at(&v, at[0] - specs[1].lo[0], at[1] - specs[1].lo[1], at[2] - specs[1].lo[2]);
        double wanted[3];
        for (int k = 0; k < 3; k++) wanted[k] = noise_expected(&specs[1], at, k);
        near((double)got[0], local ? -wanted[1] : wanted[0], 1e-5);
        near((double)got[1], local ? wanted[0] : wanted[1], 1e-5);
        near((double)got[2], wanted[2], 1e-5);
        iso_vectors_free(&v);
    }
}

static void same_names_and_instances(void **state) {
    (void)state;
    const noise n = {{0, 0, 0}, {9, 9, 9}, 50}, wide = {{0, 0, 0}, {19, 9, 9}, 50};
    vdb_spec specs[2] = {noise_spec(&n, "float"), noise_spec(&wide, "float")};
    write_ok(specs, 2, VDB_ZIP);
    iso_volume_opts opts = {.grid = "noise[1]"};
    iso_volume volume = test_read_volume(FILE_PATH, &opts);
    assert_int_equal(volume.info.dims[0], 20);
    iso_volume_free(&volume);

    assert_int_equal(vdb_write_instances(FILE_PATH, &specs[1], 40), 0);
    opts.grid = "b";
    volume = test_read_volume(FILE_PATH, &opts);
    assert_int_equal(volume.info.dims[0], 20);
    assert_true(volume.info.transform.origin[0] == 40);
    const int v[3] = {4, 5, 6};
    assert_true((double)iso_rgrid_at(volume.grid.rgrid, 4, 5, 6) == noise_expected(&specs[1], v, 0));
    iso_volume_free(&volume);
}

static double nothing(const void *context, const int v[3], int component, int *active) {
    (void)context, (void)v, (void)component;
    *active = 0;
    return 0;
}

static void not_volumes(void **state) {
    (void)state;
    assert_int_equal(vdb_write_points(FILE_PATH, "sparks"), 0);
    test_expect_no_volume(FILE_PATH, NULL, ISO_ERR_FORMAT, NULL,
                          "holds only points (grid \"sparks\"), no volume");
    iso_volume_opts opts = {.grid = "sparks"};
    test_expect_no_volume(FILE_PATH, &opts, ISO_ERR_FORMAT, NULL, "holds points");

    const noise n = {{0, 0, 0}, {9, 9, 9}, 50};
    vdb_spec spec = noise_spec(&n, "float");
    spec.frustum = 1;
    write_ok(&spec, 1, VDB_ZIP);
    test_expect_no_volume(FILE_PATH, NULL, ISO_ERR_FORMAT, NULL, "not linear");
    spec = noise_spec(&n, "float");
    spec.value = nothing;
    write_ok(&spec, 1, VDB_ZIP);
    test_expect_no_volume(FILE_PATH, NULL, ISO_ERR_FORMAT, NULL, "no active voxels");
    write_ok(NULL, 0, VDB_ZIP);
    test_expect_no_volume(FILE_PATH, NULL, ISO_ERR_FORMAT, NULL, "no grids");

    FILE *file = fopen(FILE_PATH, "wb");
    fputs("this is text, and not a grid of anything\n", file);
    fclose(file);
    test_expect_no_volume(FILE_PATH, NULL, ISO_ERR_FORMAT, NULL, "not a .vdb file");
}

/* ---- broken files ---- */

/* The first `length` bytes of a file that has more. */
static void expect_cut(const unsigned char *whole, size_t length) {
    spill(CUT_PATH, whole, length);
    iso_error error = {0};
    iso_volume volume = {0};
    iso_volume_info info;
    iso_status status = iso_volume_read(CUT_PATH, NULL, &volume, &error);
    if (status != ISO_ERR_IO) fail_msg("%zu bytes: %s", length, error.text);
    if (!strstr(error.text, CUT_PATH)) fail_msg("'%s' does not name the file", error.text);
    assert_int_equal(iso_volume_read_info(CUT_PATH, NULL, &info, NULL), ISO_ERR_IO);
}

static void truncated(void **state) {
    (void)state;
    const noise n = {{0, 0, 0}, {29, 29, 9}, 1000};
    const ball b = {{0, 0, 0}, 20, 3, 1};
    vdb_spec specs[2] = {ball_spec(&b, 1), noise_spec(&n, "float")};
    static const int flags[] = {0, VDB_ZIP, VDB_BLOSC | VDB_ACTIVE_MASK};
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        write_ok(specs, 2, flags[i]);
        size_t count;
        unsigned char *whole = slurp(FILE_PATH, &count);
        for (size_t length = 0; length < 1500; length += 13) expect_cut(whole, length);
        for (size_t k = 1; k <= 40; k++) expect_cut(whole, (count - 1) / 40 * k);
        expect_cut(whole, count - 1);
        free(whole);
    }
}

/* A tree of one 32^3 node without children: two values of it are active, and stored in a block that is not
 * compressed and states `stated` values. */
static iso_status check_small_tree(int stated, int tail, iso_vdb_layout *layout) {
    static unsigned char tree[20000];
    size_t at = 0;
    const uint32_t head[4] = {1, 0 /* background */, 0 /* tiles */, 1 /* children */};
    const int32_t origin[3] = {-4096, 0, 4096};
    const int64_t length = -4 * (int64_t)stated;
    memset(tree, 0, sizeof tree);
    memcpy(tree, head, sizeof head);
    memcpy(tree + sizeof head, origin, sizeof origin);
    at = sizeof head + sizeof origin + 4096; /* and the mask of children */
    tree[at] = 0x12;                         /* the mask of values */
    at += 4096 + 1;                          /* and the kind of block */
    memcpy(tree + at, &length, sizeof length);
    at += sizeof length + 4 * (size_t)(stated + tail);
    *layout = (iso_vdb_layout){.value_bytes = 4, .stored_bytes = 4, .compressed = true, .active_only = true};
    layout->blocks = layout->end = at;
    spill(CUT_PATH, tree, at);
    return iso_vdb_check(CUT_PATH, layout, NULL);
}

static void wrong_layout(void **state) {
    (void)state;
    iso_vdb_layout layout;
    assert_int_equal(check_small_tree(2, 0, &layout), ISO_OK);
    assert_int_equal(check_small_tree(1, 0, &layout), ISO_ERR_IO); /* all of the file is used all the same */
    assert_int_equal(check_small_tree(3, 0, &layout), ISO_ERR_IO);
    assert_int_equal(check_small_tree(2, 1, &layout), ISO_ERR_IO);
    assert_int_equal(check_small_tree(2, 0, &layout), ISO_OK);
    layout.end++;
    assert_int_equal(iso_vdb_check(CUT_PATH, &layout, NULL), ISO_ERR_IO);
    layout.end = 0;
    layout.stored_bytes = 2;
    assert_int_equal(iso_vdb_check(CUT_PATH, &layout, NULL), ISO_ERR_IO);
}

/* OpenVDB only warns of a version that it does not know. */
static void versions(void **state) {
    (void)state;
    const noise n = {{0, 0, 0}, {9, 9, 9}, 1000};
    vdb_spec spec = noise_spec(&n, "float");
    write_ok(&spec, 1, VDB_ZIP);
    size_t count;
    unsigned char *whole = slurp(FILE_PATH, &count);
    static const unsigned char versions[] = {221, 225};
    for (int i = 0; i < 2; i++) {
        whole[8] = versions[i];
        spill(CUT_PATH, whole, count);
        test_expect_no_volume(CUT_PATH, NULL, ISO_ERR_FORMAT, NULL, "version");
    }
    free(whole);
}

/* A file that was written as a stream says nothing of its length: only reading it finds its end missing. */
static void truncated_stream(void **state) {
    (void)state;
    const noise n = {{0, 0, 0}, {29, 29, 9}, 1000};
    vdb_spec spec = noise_spec(&n, "float");
    write_ok(&spec, 1, VDB_STREAM | VDB_ZIP);
    size_t count;
    unsigned char *whole = slurp(FILE_PATH, &count);
    for (size_t k = 1; k <= 20; k++) expect_cut(whole, count - (count / 2) / 20 * k);
    expect_cut(whole, count - 1);
    free(whole);
}

/* Any bit may be wrong: any status is right, a crash is not. Small blocks are stored as they are, and it is
 * those whose length OpenVDB believes. */
static void corrupted(void **state) {
    (void)state;
    const ball b = {{0, 0, 0}, 10, 3, 1};
    static const int flags[] = {VDB_ACTIVE_MASK, VDB_ZIP | VDB_ACTIVE_MASK, VDB_BLOSC | VDB_ACTIVE_MASK};
    for (size_t k = 0; k < 2 * sizeof flags / sizeof *flags; k++) {
        vdb_spec spec = ball_spec(&b, 1);
        spec.half = k % 2;
        write_ok(&spec, 1, flags[k / 2]);
        test_read_damaged(FILE_PATH, 1000, 300, FILE_PATH);
    }
}

/* Most resident bytes of this process so far. */
static long peak_kilobytes(void) {
    struct rusage usage;
    assert_int_equal(getrusage(RUSAGE_SELF, &usage), 0);
    return usage.ru_maxrss;
}

/* Lengths of strings, of metadata and of lists, wherever they are: OpenVDB takes what they say before it
 * reads. */
static void lengths_that_lie(void **state) {
    (void)state;
    const ball b = {{0, 0, 0}, 10, 3, 1};
    const vdb_spec spec = ball_spec(&b, 1);
    const iso_volume_opts opts = {.max_memory = 64 << 20};
    const uint32_t lies[] = {0x7fffffff, 0x10000000, UINT32_MAX};
    const int flags[] = {VDB_BLOSC | VDB_ACTIVE_MASK, VDB_STREAM | VDB_ZIP};
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) {
        write_ok(&spec, 1, flags[k]);
        size_t count;
        unsigned char *whole = slurp(FILE_PATH, &count);
        iso_volume volume = test_read_volume(FILE_PATH, &opts);
        iso_volume_free(&volume);
        const long before = peak_kilobytes();
        for (size_t at = 20; at < 700; at += 1 + 2 * k) {
            unsigned char kept[4];
            memcpy(kept, whole + at, 4);
            memcpy(whole + at, &lies[at % 3], 4);
            spill(CUT_PATH, whole, count);
            if (iso_volume_read(CUT_PATH, &opts, &volume, NULL) == ISO_OK) iso_volume_free(&volume);
            memcpy(whole + at, kept, 4);
            if (peak_kilobytes() > before + 128 * 1024)
                fail_msg("%zu: %ld kB instead of %ld", at, peak_kilobytes(), before);
        }
        free(whole);
    }
}

/* ---- real files ---- */

static void range(const iso_grid *grid, double *lo, double *hi) {
    const int *dims = iso_grid_dims(grid);
    *lo = INFINITY;
    *hi = -INFINITY;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) {
                double value = (double)iso_grid_at(grid, x, y, z);
                *lo = fmin(*lo, value);
                *hi = fmax(*hi, value);
            }
}

static int real_file(const char *name, char path[512]) {
    snprintf(path, 512, "%s/%s", ISO_TEST_VOLUMES, name);
    if (access(path, R_OK) == 0) return 1;
    print_message("%s is not there: skipped\n", path);
    return 0;
}

static void real_sphere(void **state) {
    (void)state;
    char path[512];
    if (!real_file("vdb_sphere/sphere.vdb", path)) skip();
    iso_volume volume = test_read_volume(path, NULL);
    const iso_hgrid *grid = volume.grid.hgrid;
    assert_non_null(grid);
    assert_string_equal(volume.info.file_type, "half");
    double lo, hi, worst = 0;
    range(&volume.grid, &lo, &hi);
    assert_true(fabs(lo * 0.05 + 0.150024) < 1e-6 && fabs(hi * 0.05 - 0.150024) < 1e-6);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(grid->dims[i], 125);
        assert_true(fabs(grid->transform.spacing[i] - 0.05) < 1e-9);
        assert_true(fabs(grid->transform.origin[i] + 3.1) < 1e-6);
    }
    const ball b = {{62, 62, 62}, 60, 0, 0};
    for (int z = 0; z < 125; z++)
        for (int y = 0; y < 125; y++)
            for (int x = 0; x < 125; x++) {
                const int v[3] = {x, y, z};
                double wanted = fmax(-(double)grid->band, fmin((double)grid->band, ball_voxels(&b, v)));
                worst = fmax(worst, fabs(wanted - (double)iso_hgrid_at(grid, x, y, z)));
            }
    if (worst > 0.002) fail_msg("distances are off by up to %g voxels", worst); /* halves near 0.15 */
    iso_volume_free(&volume);
}

static void check_fog(const char *name, const char *grid_name, const int dims[3], const double spacing[3],
                      double highest) {
    char path[512];
    if (!real_file(name, path)) skip();
    iso_volume_opts opts = {.grid = grid_name};
    iso_volume volume = test_read_volume(path, &opts);
    assert_non_null(volume.grid.rgrid);
    assert_false(volume.info.level_set);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(volume.info.dims[i], dims[i]);
        if (fabs(volume.info.transform.spacing[i] - spacing[i]) > 1e-6)
            fail_msg("spacing %.9g, not %.9g", volume.info.transform.spacing[i], spacing[i]);
    }
    double lo, hi;
    range(&volume.grid, &lo, &hi);
    assert_true(lo == 0);
    if (highest > 0 && fabs(hi - highest) > 1e-6) fail_msg("highest value %.9g, not %.9g", hi, highest);
    iso_volume_free(&volume);
}

static void real_fogs(void **state) {
    (void)state;
    check_fog("vdb_usd_smoke/smoke_000003.vdb", NULL, (const int[3]){51, 49, 96},
              (const double[3]){0.132601, 0.132903, 0.131697}, 0.999985);
    const double spacing[3] = {0.703377, 0.703377, 0.716455};
    check_fog("vdb_usd_smoke/densityAndHeat.vdb", NULL, (const int[3]){23, 23, 42}, spacing, 0.997509);
    check_fog("vdb_usd_smoke/densityAndHeat.vdb", "heat", (const int[3]){22, 21, 32}, spacing, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dense_types),
        cmocka_unit_test(dense_storage),
        cmocka_unit_test(one_voxel),
        cmocka_unit_test(level_set_cubic),
        cmocka_unit_test(level_set_rotated),
        cmocka_unit_test(level_set_threads),
        cmocka_unit_test(level_set_not_cubic),
        cmocka_unit_test(limits),
        cmocka_unit_test(limits_without_statistics),
        cmocka_unit_test(scattered_leaves_keep_the_limit),
        cmocka_unit_test(choosing),
        cmocka_unit_test(vectors),
        cmocka_unit_test(same_names_and_instances),
        cmocka_unit_test(not_volumes),
        cmocka_unit_test(truncated),
        cmocka_unit_test(truncated_stream),
        cmocka_unit_test(versions),
        cmocka_unit_test(wrong_layout),
        cmocka_unit_test(corrupted),
        cmocka_unit_test(lengths_that_lie),
        cmocka_unit_test(real_sphere),
        cmocka_unit_test(real_fogs),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(FILE_PATH);
    unlink(CUT_PATH);
    return failed;
}
