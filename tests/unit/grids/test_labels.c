/* labels: the positions, normals and volumes of smoothed labels against the analytic solids that they were
 * made of; one partition of space; no voxel changes its label. Errors in voxels and degrees. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "grids/labels/label_fields.h"

enum { SIDE = 48, RAYS = 2000, CENTRES = 12, PLACES = 20000 };

/* Whether a voxel belongs to the solid; the distance from its border, and the normal of the border there. */
typedef struct shape {
    double (*distance)(iso_vec3 p, double size); /* negative inside; p from the centre */
    double size;
} shape;

static double ball(iso_vec3 p, double r) {
    return iso_vec3_length(p) - r;
}

static const double oblique[3] = {0.48, 0.6, 0.64};

static double along(iso_vec3 p) {
    return p.x * oblique[0] + p.y * oblique[1] + p.z * oblique[2];
}

static double tube(iso_vec3 p, double r) {
    const double t = along(p);
    return sqrt(fmax(0, iso_vec3_dot(p, p) - t * t)) - r;
}

static double slab(iso_vec3 p, double thickness) {
    return fabs(along(p)) - thickness / 2;
}

typedef struct errors {
    double position, bias, normal; /* rms, mean, rms */
    double lost;                   /* share of rays that meet no surface within 2 voxels */
    double volume;                 /* relative to the solid's */
    int changed;                   /* voxels on the wrong side */
    size_t voxels;
} errors;

typedef struct labelled {
    iso_labels labels;
    iso_label_fields *fields;
} labelled;

/* Makes fields of voxels; each label its own group, or all one. (They borrow the labels: *l must stay where
 * it is.) */
static void make_fields_at(int places, const uint16_t *voxels, const int dims[3], iso_pool *pool,
                           bool one_group, labelled *l) {
    iso_error error = {0};
    iso_grid grid = {0};
    const iso_rgrid_desc desc = {
        .dims = {dims[0], dims[1], dims[2]}, .type = ISO_UINT16, .data = (void *)(uintptr_t)voxels};
    assert_int_equal(iso_rgrid_create(&desc, &grid.rgrid, &error), ISO_OK);
    assert_int_equal(iso_labels_make(&grid, pool, NULL, &l->labels, NULL, &error), ISO_OK);
    iso_grid_destroy(&grid);
    uint8_t *group = calloc((size_t)l->labels.count, 1);
    for (int i = 1; i < l->labels.count; i++) group[i] = one_group ? 1 : (uint8_t)i;
    assert_int_equal(iso_label_fields_make(&l->labels, group, one_group ? 1 : l->labels.count - 1, places,
                                           pool, &l->fields, &error),
                     ISO_OK);
    free(group);
}

static void make_fields(const uint16_t *voxels, const int dims[3], iso_pool *pool, bool one_group,
                        labelled *l) {
    make_fields_at(one_group ? ISO_LABELS_INSIDE + ISO_LABELS_APART : ISO_LABELS_DRAWN, voxels, dims, pool,
                   one_group, l);
}

static void free_fields(labelled *l) {
    iso_label_fields_destroy(l->fields);
    iso_labels_free(&l->labels);
}

static size_t place_of(int x, int y, int z) {
    return ((size_t)z * SIDE + (size_t)y) * SIDE + (size_t)x;
}

static iso_vec3 direction(int i) {
    const double z = 1 - (2 * i + 1.0) / RAYS, r = sqrt(1 - z * z), a = 2.399963229728653 * i;
    return iso_vec3_make(r * cos(a), r * sin(a), z);
}

static iso_vec3 gradient(const shape *s, iso_vec3 p) {
    const double h = 1e-4;
    iso_vec3 g;
    g.x = s->distance(iso_vec3_make(p.x + h, p.y, p.z), s->size) -
          s->distance(iso_vec3_make(p.x - h, p.y, p.z), s->size);
    g.y = s->distance(iso_vec3_make(p.x, p.y + h, p.z), s->size) -
          s->distance(iso_vec3_make(p.x, p.y - h, p.z), s->size);
    g.z = s->distance(iso_vec3_make(p.x, p.y, p.z + h), s->size) -
          s->distance(iso_vec3_make(p.x, p.y, p.z - h), s->size);
    return iso_vec3_scale(g, 1 / iso_vec3_length(g));
}

/* The place nearest to 0 on the normal through a point of the border where the level set is 0; NaN: none
 * within 2 voxels. */
static double crossing(const iso_grid *grid, iso_vec3 p, iso_vec3 n) {
    double nearest = NAN, before = 0;
    for (int i = -40; i <= 40; i++) {
        const double t = i / 20.0, value = iso_grid_sample(grid, iso_vec3_add(p, iso_vec3_scale(n, t)));
        if (i > -40 && before < 0 && value >= 0) {
            const double at = t - value / (value - before) / 20;
            if (isnan(nearest) || fabs(at) < fabs(nearest)) nearest = at;
        }
        before = value;
    }
    return nearest;
}

/* The share of a cell's volume that is inside, of 4^3 samples. */
static double volume_of(const iso_grid *grid) {
    const int n = SIDE + 1;
    size_t inside = 0;
    for (int z = 0; z < n * 4; z++)
        for (int y = 0; y < n * 4; y++)
            for (int x = 0; x < n * 4; x++)
                inside +=
                    iso_grid_sample(grid, iso_vec3_make((x + 0.5) / 4, (y + 0.5) / 4, (z + 0.5) / 4)) < 0;
    return (double)inside / 64;
}

/* Adds what one solid, around `c`, gives. */
static void measure_at(const shape *s, iso_vec3 c, errors *e, size_t *rays, double *volume) {
    const int dims[3] = {SIDE, SIDE, SIDE};
    uint16_t *voxels = calloc((size_t)SIDE * SIDE * SIDE, sizeof *voxels);
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++)
                voxels[place_of(x, y, z)] =
                    s->distance(iso_vec3_sub(iso_vec3_make(x, y, z), c), s->size) < 0 ? 7 : 0;
    labelled l;
    make_fields(voxels, dims, NULL, false, &l);
    const iso_grid grid = {.hgrid = iso_label_fields_grid(l.fields, 1)};
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                const bool inside = iso_grid_at(&grid, x + 1, y + 1, z + 1) < 0;
                e->voxels += voxels[place_of(x, y, z)] != 0;
                e->changed += inside != (voxels[place_of(x, y, z)] != 0);
            }
    for (int i = 0; i < RAYS; i++) {
        /* A point of the border, found along a ray from near the centre. */
        const iso_vec3 d = direction(i);
        double lo = 0, hi = 17;
        if (s->distance(iso_vec3_scale(d, hi), s->size) < 0) continue;
        for (int k = 0; k < 40; k++) {
            const double middle = (lo + hi) / 2;
            if (s->distance(iso_vec3_scale(d, middle), s->size) < 0)
                lo = middle;
            else
                hi = middle;
        }
        const iso_vec3 p = iso_vec3_scale(d, lo), n = gradient(s, p), one = iso_vec3_make(1, 1, 1),
                       at = iso_vec3_add(iso_vec3_add(p, c), one);
        const double t = crossing(&grid, at, n);
        ++*rays;
        e->lost += isnan(t);
        if (isnan(t)) continue;
        const iso_vec3 g = iso_grid_gradient(&grid, iso_vec3_add(at, iso_vec3_scale(n, t)));
        const double cosine = iso_vec3_dot(g, n) / iso_vec3_length(g);
        const double angle = acos(fmin(1, cosine)) * 180 / ISO_PI;
        e->position += t * t;
        e->bias += t;
        e->normal += angle * angle;
    }
    if (volume) *volume += volume_of(&grid);
    free_fields(&l);
    free(voxels);
}

static errors measure(const shape *s, double true_volume) {
    errors e = {0};
    size_t rays = 0;
    double volume = 0;
    for (int i = 0; i < CENTRES; i++) {
        /* (places that fill a voxel evenly) */
        const iso_vec3 c = {23 + fmod(0.8192 * (i + 1), 1), 23 + fmod(0.6710 * (i + 1), 1),
                            23 + fmod(0.5497 * (i + 1), 1)};
        measure_at(s, c, &e, &rays, true_volume > 0 ? &volume : NULL);
    }
    const double hits = (double)rays - e.lost;
    e.position = sqrt(e.position / hits);
    e.bias /= hits;
    e.normal = sqrt(e.normal / hits);
    e.lost /= (double)rays;
    e.volume = true_volume > 0 ? volume / CENTRES / true_volume - 1 : 0;
    return e;
}

static void check_shape(const char *name, double (*distance)(iso_vec3, double), double size,
                        double true_volume, const errors *most) {
    const errors e = measure(&(shape){distance, size}, true_volume);
    print_message(
        "%-6s %4.1f: position %.3f, bias %+.3f, normal %.1f, volume %+.2f %%, lost %.4f, %d of %zu changed\n",
        name, size, e.position, e.bias, e.normal, 100 * e.volume, e.lost, e.changed, e.voxels);
    assert_true(e.position <= most->position);
    assert_true(fabs(e.bias) <= most->bias);
    assert_true(e.normal <= most->normal);
    assert_true(fabs(e.volume) <= most->volume);
    assert_true(e.lost <= most->lost);
    assert_int_equal(e.changed, 0);
}

static double volume_of_ball(double r) {
    return 4 * ISO_PI / 3 * r * r * r;
}

static void shapes_are_true(void **state) {
    (void)state;
    check_shape("ball", ball, 16, 0, &(errors){.position = 0.07, .bias = 0.02, .normal = 3.5, .volume = 1});
    check_shape("ball", ball, 8, volume_of_ball(8),
                &(errors){.position = 0.07, .bias = 0.005, .normal = 3.5, .volume = 0.002});
    check_shape("ball", ball, 4, 0, &(errors){.position = 0.075, .bias = 0.02, .normal = 3.5, .volume = 1});
    check_shape("ball", ball, 2.5, 0, &(errors){.position = 0.15, .bias = 0.13, .normal = 5, .volume = 1});
    check_shape("ball", ball, 1.5, 0, &(errors){.position = 0.17, .bias = 0.07, .normal = 9, .volume = 1});
    check_shape("tube", tube, 1, 0, &(errors){.position = 0.164, .bias = 0.05, .normal = 9, .volume = 1});
    check_shape("tube", tube, 1.5, 0, &(errors){.position = 0.2, .bias = 0.17, .normal = 6, .volume = 1});
    /* (a sheet of one voxel that is no plane of voxels has holes between voxels that meet in edges and
     * corners) */
    check_shape("slab", slab, 1, 0,
                &(errors){.position = 0.18, .bias = 0.05, .normal = 19, .lost = 0.1, .volume = 1});
    check_shape("slab", slab, 2, 0, &(errors){.position = 0.07, .bias = 0.03, .normal = 4, .volume = 1});
}

/* ---- one partition of space */

/* Two balls that touch, cut by planes, a tube of one voxel through them, single voxels, and noise. */
static uint16_t *make_organs(void) {
    uint16_t *voxels = calloc((size_t)SIDE * SIDE * SIDE, sizeof *voxels);
    uint32_t random = 1;
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                uint16_t *v = &voxels[place_of(x, y, z)];
                const double a = ball(iso_vec3_make(x - 17.3, y - 22.1, z - 20.4), 13),
                             b = ball(iso_vec3_make(x - 33.2, y - 24.6, z - 23.7), 9);
                if (a < 0) *v = z > 20 ? 3 : 1000;
                if (b < 0) *v = y > 25 ? 40000 : 5;
                if (y == 22 && z == 20) *v = 65535;
                if (x < 9 && y < 9 && z > 38) *v = (uint16_t)(random_bits(&random) % 5);
            }
    voxels[place_of(44, 44, 4)] = 77;
    voxels[place_of(0, 47, 0)] = 78;
    return voxels;
}

/* Which label a voxel has by the level sets of groups. */
static void check_voxels(const labelled *l, int groups, const uint8_t *group) {
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                const int label = iso_labels_at(&l->labels, x, y, z);
                for (int g = 1; g <= groups; g++) {
                    const iso_grid grid = {.hgrid = iso_label_fields_grid(l->fields, g)};
                    const bool inside = iso_grid_at(&grid, x + 1, y + 1, z + 1) < 0;
                    if (inside != (group[label] == g)) fail_msg("voxel %d %d %d changes its label", x, y, z);
                    if (inside)
                        assert_int_equal(
                            iso_label_fields_at(l->fields, g, iso_vec3_make(x + 1, y + 1, z + 1)), label);
                }
            }
}

static void no_voxel_changes(void **state) {
    (void)state;
    const int dims[3] = {SIDE, SIDE, SIDE};
    uint16_t *voxels = make_organs();
    labelled one, each;
    make_fields(voxels, dims, NULL, true, &one);
    make_fields(voxels, dims, NULL, false, &each);
    uint8_t ones[16], all[16];
    assert_true(one.labels.count <= 16);
    for (int i = 0; i < one.labels.count; i++) ones[i] = i > 0, all[i] = (uint8_t)i;
    check_voxels(&one, 1, ones);
    check_voxels(&each, each.labels.count - 1, all);
    free_fields(&one);
    free_fields(&each);
    free(voxels);
}

/* The field of a place by definition: of a voxel's neighbours' level sets, each label in its own group. */
static void places_have_one_label(void **state) {
    (void)state;
    const int dims[3] = {SIDE, SIDE, SIDE};
    uint16_t *voxels = make_organs();
    labelled one, each;
    make_fields(voxels, dims, NULL, true, &one);
    make_fields(voxels, dims, NULL, false, &each);
    const iso_grid solid = {.hgrid = iso_label_fields_grid(one.fields, 1)};
    uint32_t random = 5;
    int inside = 0, overlaps = 0, other = 0, gaps = 0;
    for (int i = 0; i < PLACES; i++) {
        const iso_vec3 p = {1 + uniform(&random) * (SIDE - 1), 1 + uniform(&random) * (SIDE - 1),
                            1 + uniform(&random) * (SIDE - 1)};
        const int label = iso_label_fields_at(one.fields, 1, p);
        int found = 0, first = 0;
        for (int g = 1; g < each.labels.count; g++) {
            const iso_grid grid = {.hgrid = iso_label_fields_grid(each.fields, g)};
            if (!(iso_grid_sample(&grid, p) < 0)) continue;
            found++;
            first = g;
        }
        const bool in = iso_grid_sample(&solid, p) < 0;
        inside += in;
        if (in) assert_true(label > 0);
        overlaps += found > 1;
        gaps += in && !found;
        other += in && found == 1 && first != label;
    }
    print_message("of %d places %d inside: %d in two labels, %d of another, %d between three\n", PLACES,
                  inside, overlaps, other, gaps);
    assert_true(inside > PLACES / 10);
    assert_int_equal(overlaps, 0);
    assert_int_equal(other, 0);
    assert_true(gaps < inside / 20);
    free_fields(&one);
    free_fields(&each);
    free(voxels);
}

/* ---- groups */

/* The level set of labels that share a group is that of the same voxels with one label. */
static void group_is_one_solid(void **state) {
    (void)state;
    const int dims[3] = {SIDE, SIDE, SIDE};
    uint16_t *voxels = make_organs();
    labelled organs, solid;
    make_fields(voxels, dims, NULL, true, &organs);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) voxels[i] = voxels[i] > 0;
    make_fields(voxels, dims, NULL, true, &solid);
    const iso_grid a = {.hgrid = iso_label_fields_grid(organs.fields, 1)},
                   b = {.hgrid = iso_label_fields_grid(solid.fields, 1)};
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int at[3] = {1 + i % SIDE, 1 + i / SIDE % SIDE, 1 + i / SIDE / SIDE};
        assert_true(iso_grid_at(&a, at[0], at[1], at[2]) == iso_grid_at(&b, at[0], at[1], at[2]));
    }
    free_fields(&organs);
    free_fields(&solid);
    free(voxels);
}

/* Where there are but two groups, their level sets are opposite, whatever was at the same place of another
 * block. */
static void two_groups_are_opposite(void **state) {
    (void)state;
    enum { LONG = 112 };
    const int dims[3] = {LONG, LONG, LONG};
    uint16_t *voxels = calloc((size_t)LONG * LONG * LONG, sizeof *voxels);
    for (int i = 0; i < LONG * LONG * LONG; i++) {
        const int x = i % LONG, y = i / LONG % LONG, z = i / LONG / LONG;
        const bool inside = ball(iso_vec3_make(x - 74.2, y - 52.4, z - 51.7), 5) < 0;
        voxels[i] = x < 12 ? (uint16_t)(x < 6 ? 0 : 3) : inside ? 1 : 2;
    }
    labelled l;
    make_fields(voxels, dims, NULL, false, &l);
    const iso_grid a = {.hgrid = iso_label_fields_grid(l.fields, 1)},
                   b = {.hgrid = iso_label_fields_grid(l.fields, 2)};
    int compared = 0;
    for (int z = 42; z < 62; z++)
        for (int y = 42; y < 62; y++)
            for (int x = 65; x < 85; x++) {
                const float value = iso_grid_at(&a, x, y, z);
                assert_true(value == -iso_grid_at(&b, x, y, z));
                compared += fabsf(value) < 2;
            }
    assert_true(compared > 500);
    free_fields(&l);
    free(voxels);
}

/* Labels that are told apart where some places ask for it, and again for others, are those that are told
 * apart everywhere at once. */
static void labels_are_told_apart_when_asked(void **state) {
    (void)state;
    enum { ASKED = 300, ROUNDS = 3 };
    const int dims[3] = {SIDE, SIDE, SIDE};
    uint16_t *voxels = make_organs();
    labelled all, later;
    iso_error error = {0};
    make_fields_at(ISO_LABELS_DRAWN + ISO_LABELS_APART, voxels, dims, NULL, true, &all);
    make_fields_at(ISO_LABELS_DRAWN, voxels, dims, NULL, true, &later);
    const iso_grid solid = {.hgrid = iso_label_fields_grid(all.fields, 1)};
    uint32_t random = 11;
    int unknown = 0;
    for (int round = 0; round < ROUNDS; round++) {
        iso_vec3 place[ASKED];
        for (int i = 0; i < ASKED;) {
            const iso_vec3 p = {1 + uniform(&random) * (SIDE - 1), 1 + uniform(&random) * (SIDE - 1),
                                1 + uniform(&random) * (SIDE - 1)};
            if (fabs(iso_grid_sample(&solid, p)) < 0.5) place[i++] = p;
        }
        for (int i = 0; i < ASKED; i++) {
            iso_label_cell cell = {.known = false};
            const int label = iso_label_fields_near(later.fields, 1, place[i], &cell);
            unknown += label < 0;
            if (label >= 0) assert_int_equal(label, iso_label_fields_at(all.fields, 1, place[i]));
        }
        assert_int_equal(iso_label_fields_tell_apart(later.fields, NULL, &error), ISO_OK);
        for (int i = 0; i < ASKED; i++)
            assert_int_equal(iso_label_fields_at(later.fields, 1, place[i]),
                             iso_label_fields_at(all.fields, 1, place[i]));
    }
    print_message("%d of %d places were not known at first\n", unknown, ROUNDS * ASKED);
    assert_true(unknown > ASKED / 10 && unknown < ROUNDS * ASKED / 2);
    free_fields(&all);
    free_fields(&later);
    free(voxels);
}

/* ---- fields where they are drawn alone */

/* Whether a voxel of the level sets is a corner of a cell with voxels inside and outside, or beside one. */
static bool is_drawn(const iso_grid *grid, const int at[3]) {
    for (int axis = -1; axis < 3; axis++)
        for (int step = -1; step <= 1; step++) {
            int corner[3] = {at[0], at[1], at[2]}, inside = 0, all = 0;
            if (axis >= 0) corner[axis] += step;
            for (int i = 0; i < 27; i++) { /* the corners of the eight cells around it */
                const int v[3] = {corner[0] + i % 3 - 1, corner[1] + i / 3 % 3 - 1, corner[2] + i / 9 - 1};
                if (v[0] < 0 || v[1] < 0 || v[2] < 0 || v[0] > SIDE || v[1] > SIDE || v[2] > SIDE) continue;
                all++;
                inside += iso_grid_at(grid, v[0], v[1], v[2]) < 0;
            }
            /* (a neighbourhood with both may have no cell with both at this corner: then it is beside one) */
            if (inside > 0 && inside < all) return true;
        }
    return false;
}

static void drawn_fields_are_those_of_the_band(void **state) {
    (void)state;
    const int dims[3] = {SIDE, SIDE, SIDE};
    uint16_t *voxels = make_organs();
    labelled drawn, band;
    make_fields_at(ISO_LABELS_DRAWN, voxels, dims, NULL, false, &drawn);
    make_fields_at(ISO_LABELS_BAND, voxels, dims, NULL, false, &band);
    int compared = 0, saved = 0;
    for (int g = 1; g < drawn.labels.count; g++) {
        const iso_grid a = {.hgrid = iso_label_fields_grid(drawn.fields, g)},
                       b = {.hgrid = iso_label_fields_grid(band.fields, g)};
        for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
            const int at[3] = {1 + i % SIDE, 1 + i / SIDE % SIDE, 1 + i / SIDE / SIDE};
            const float value = iso_grid_at(&a, at[0], at[1], at[2]),
                        other = iso_grid_at(&b, at[0], at[1], at[2]);
            assert_true((value < 0) == (other < 0));
            saved += value != other;
            if (!is_drawn(&b, at)) continue;
            assert_true(value == other);
            compared++;
        }
    }
    print_message("%d voxels are drawn, %d more have fields in the band\n", compared, saved);
    assert_true(compared > 10000 && saved > compared);
    free_fields(&drawn);
    free_fields(&band);
    free(voxels);
}

/* ---- the same bytes */

static uint64_t hash_grid(const iso_hgrid *grid) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t cell = 0; cell < iso_hgrid_cell_count(grid); cell++) {
        hash = (hash ^ (uint64_t)(grid->cell[cell] < 0 ? grid->cell[cell] : 0)) * 0x100000001b3u;
        const uint8_t *bytes =
            grid->cell[cell] < 0 ? NULL : (const uint8_t *)iso_hgrid_brick(grid, grid->cell[cell]);
        for (size_t i = 0; bytes && i < ISO_BRICK_VOXELS * sizeof(float); i++)
            hash = (hash ^ bytes[i]) * 0x100000001b3u;
    }
    return hash;
}

static uint64_t hash_organs(const uint16_t *voxels, int threads, iso_cpu_level level) {
    const int dims[3] = {SIDE, SIDE, SIDE};
    iso_error error = {0};
    iso_pool *pool;
    test_ok(iso_pool_create(threads, &pool, &error), &error);
    iso_cpu_limit(level);
    labelled l;
    make_fields(voxels, dims, pool, false, &l);
    uint64_t hash = 0;
    for (int g = 1; g < l.labels.count; g++) hash = hash * 31 + hash_grid(iso_label_fields_grid(l.fields, g));
    free_fields(&l);
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_pool_destroy(pool);
    return hash;
}

static void same_bytes(void **state) {
    (void)state;
    uint16_t *voxels = make_organs();
    const uint64_t hash = hash_organs(voxels, 1, ISO_CPU_GENERIC);
    assert_true(hash_organs(voxels, 3, ISO_CPU_GENERIC) == hash);
    assert_true(hash_organs(voxels, 2, ISO_CPU_AVX2) == hash);
    assert_true(hash_organs(voxels, 5, ISO_CPU_AVX512) == hash);
    free(voxels);
}

/* ---- the labels of a grid */

static iso_status labels_of(const float values[8], iso_labels *labels, iso_error *error) {
    iso_grid grid = {0};
    const iso_rgrid_desc desc = {.dims = {2, 2, 2}, .type = ISO_FLOAT32, .data = (void *)(uintptr_t)values};
    test_ok(iso_rgrid_create(&desc, &grid.rgrid, error), error);
    const iso_status status = iso_labels_make(&grid, NULL, NULL, labels, NULL, error);
    iso_grid_destroy(&grid);
    return status;
}

static void floats_are_labels_or_not(void **state) {
    (void)state;
    iso_labels labels;
    iso_error error = {0};
    test_ok(labels_of((const float[8]){0, 0, 7, 65535, 7, 7, NAN, 300}, &labels, &error), &error);
    assert_int_equal(labels.count, 4);
    assert_int_equal(labels.label[1].value, 7);
    assert_int_equal(labels.label[1].voxels, 3);
    assert_int_equal(labels.label[1].sums[2], 2);
    assert_int_equal(labels.label[1].lo[0], 0);
    assert_int_equal(labels.label[1].hi[1], 1);
    assert_int_equal(iso_labels_find(&labels, 300), 2);
    assert_int_equal(iso_labels_find(&labels, 8), -1);
    iso_labels_free(&labels);
    assert_int_equal(labels_of((const float[8]){0, 0.25f, 1, 1, 1, 1, 1, 1}, &labels, &error),
                     ISO_ERR_FORMAT);
    assert_non_null(strstr(error.text, "0.25"));
    assert_int_equal(labels_of((const float[8]){0, 65536, 1, 1, 1, 1, 1, 1}, &labels, &error),
                     ISO_ERR_FORMAT);
    assert_int_equal(labels_of((const float[8]){0, -1, 1, 1, 1, 1, 1, 1}, &labels, &error), ISO_ERR_FORMAT);
}

/* ---- parts of labels */

enum { PART_SIDE = 12, PART_VOXELS = PART_SIDE * PART_SIDE * PART_SIDE };

/* Fills a part from its first voxel by a stack, and returns its size. */
static int fill_part(const float *values, int first, int part, int *of) {
    static int stack[6 * PART_VOXELS];
    int top = 0, size = 0;
    stack[top++] = first;
    while (top > 0) {
        const int at = stack[--top], step[3] = {1, PART_SIDE, PART_SIDE * PART_SIDE};
        if (of[at] || values[at] != values[first]) continue;
        of[at] = part;
        size++;
        for (int k = 0; k < 3; k++) {
            const int c = at / step[k] % PART_SIDE;
            if (c > 0) stack[top++] = at - step[k];
            if (c < PART_SIDE - 1) stack[top++] = at + step[k];
        }
    }
    return size;
}

/* What stays of random labels, by filling each part on its own. */
static void keep_by_filling(const float *values, const iso_label_parts *keep, float *kept) {
    static int of[PART_VOXELS], size[PART_VOXELS + 1], label[PART_VOXELS + 1];
    int parts = 0;
    memset(of, 0, sizeof of);
    for (int i = 0; i < PART_VOXELS; i++)
        if (values[i] != 0 && !of[i]) {
            size[parts + 1] = fill_part(values, i, parts + 1, of);
            label[++parts] = (int)values[i];
        }
    for (int i = 0; i < PART_VOXELS; i++) {
        size_t larger = 0;
        for (int k = 1; k <= parts && of[i]; k++)
            larger +=
                label[k] == label[of[i]] && (size[k] > size[of[i]] || (size[k] == size[of[i]] && k < of[i]));
        const bool stays =
            of[i] && size[of[i]] >= keep->min_volume && (!keep->largest || larger < keep->largest);
        kept[i] = stays ? values[i] : 0;
    }
}

static void check_parts(const float *values, const iso_label_parts *keep) {
    static float wanted[PART_VOXELS];
    iso_grid grid = {0};
    iso_labels labels;
    iso_components_totals totals;
    iso_error error = {0};
    uint64_t kept = 0, all = 0;
    const iso_rgrid_desc desc = {
        .dims = {PART_SIDE, PART_SIDE, PART_SIDE}, .type = ISO_FLOAT32, .data = (void *)(uintptr_t)values};
    keep_by_filling(values, keep, wanted);
    test_ok(iso_rgrid_create(&desc, &grid.rgrid, &error), &error);
    test_ok(iso_labels_make(&grid, NULL, keep, &labels, &totals, &error), &error);
    for (int i = 0; i < PART_VOXELS; i++) {
        assert_int_equal(labels.label[labels.number[i]].value, (int)wanted[i]);
        kept += wanted[i] != 0;
        all += values[i] != 0;
    }
    for (int i = 1; i < labels.count; i++) assert_true(labels.label[i].voxels > 0);
    assert_int_equal(totals.kept_voxels, kept);
    assert_int_equal(totals.dropped_voxels, all - kept);
    iso_labels_free(&labels);
    iso_grid_destroy(&grid);
}

static void parts_are_those_that_filling_finds(void **state) {
    (void)state;
    static float values[PART_VOXELS];
    uint32_t seed = 7;
    for (int round = 0; round < 40; round++) {
        for (int i = 0; i < PART_VOXELS; i++) {
            seed = seed * 1664525u + 1013904223u;
            const uint32_t dice = seed >> 24; /* of the background 30 to 90 % */
            values[i] = dice < 75u + 4u * (uint32_t)round ? 0 : (float)(1 + dice % 3 * 100);
        }
        check_parts(values, &(iso_label_parts){.largest = (size_t)(round % 4)});
        check_parts(values, &(iso_label_parts){.min_volume = 1 + round % 2});
        check_parts(values, &(iso_label_parts){.largest = 5, .min_volume = 2});
    }
    iso_labels labels;
    iso_components_totals totals;
    iso_error error = {0};
    iso_grid grid = {0};
    const iso_rgrid_desc desc = {
        .dims = {PART_SIDE, PART_SIDE, PART_SIDE}, .type = ISO_FLOAT32, .data = values};
    test_ok(iso_rgrid_create(&desc, &grid.rgrid, &error), &error);
    assert_int_equal(
        iso_labels_make(&grid, NULL, &(iso_label_parts){.min_volume = 1e9}, &labels, &totals, &error),
        ISO_ERR_EMPTY);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_those_that_filling_finds),
        cmocka_unit_test(shapes_are_true),
        cmocka_unit_test(no_voxel_changes),
        cmocka_unit_test(places_have_one_label),
        cmocka_unit_test(group_is_one_solid),
        cmocka_unit_test(two_groups_are_opposite),
        cmocka_unit_test(labels_are_told_apart_when_asked),
        cmocka_unit_test(same_bytes),
        cmocka_unit_test(floats_are_labels_or_not),
        cmocka_unit_test(drawn_fields_are_those_of_the_band),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
