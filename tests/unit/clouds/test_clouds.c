/* Neighbours against a search of all points; estimated normals and radii on surfaces whose normals are known;
 * the order of spans; points that lie on a line, on a plane, or in one place. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/numbers.h"
#include "check_support.h"
#include "clouds/cloud.h"
#include "clouds/frame.h"
#include "clouds/neighbours.h"
#include "clouds/radii.h"

enum { MOST = 20000, FEW = 1500 };

/* Points with their true normals. */
typedef struct sample {
    float positions[MOST][3], normals[MOST][3];
    uint8_t numbers[MOST][3]; /* the point's own number, passed as its colour, by which it is found again */
    size_t count;
} sample;

static sample points; /* too large for the stack */

static void add_point(sample *s, iso_vec3 position, iso_vec3 normal) {
    const iso_vec3 n = iso_vec3_unit(normal);
    const size_t i = s->count++;
    float *p = s->positions[i], *q = s->normals[i];
    for (int k = 0; k < 3; k++) s->numbers[i][k] = (uint8_t)(i >> 8 * k);
    p[0] = (float)position.x, p[1] = (float)position.y, p[2] = (float)position.z;
    q[0] = (float)n.x, q[1] = (float)n.y, q[2] = (float)n.z;
}

static iso_vec3 random_direction(uint32_t *seed) {
    for (;;) {
        const iso_vec3 v = iso_vec3_make(2 * uniform(seed) - 1, 2 * uniform(seed) - 1, 2 * uniform(seed) - 1);
        const double length = iso_vec3_length(v);
        if (length > 0.01 && length < 1) return iso_vec3_scale(v, 1 / length);
    }
}

static void add_sphere(sample *s, size_t count, iso_vec3 centre, double radius, uint32_t *seed) {
    for (size_t i = 0; i < count; i++) {
        const iso_vec3 n = random_direction(seed);
        add_point(s, iso_vec3_add(centre, iso_vec3_scale(n, radius)), n);
    }
}

static void add_torus(sample *s, size_t count, uint32_t *seed) {
    while (s->count < count) {
        const double u = 2 * ISO_PI * uniform(seed), v = 2 * ISO_PI * uniform(seed), large = 30, small = 10;
        if (uniform(seed) > (large + small * cos(v)) / (large + small)) continue; /* evenly by area */
        const iso_vec3 n = iso_vec3_make(cos(v) * cos(u), cos(v) * sin(u), sin(v)),
                       ring = iso_vec3_make(large * cos(u), large * sin(u), 0);
        add_point(s, iso_vec3_add(ring, iso_vec3_scale(n, small)), n);
    }
}

/* A box with sharp edges. */
static void add_box(sample *s, size_t count, const double size[3], uint32_t *seed) {
    const double areas[3] = {size[1] * size[2], size[0] * size[2], size[0] * size[1]};
    while (s->count < count) {
        double chance = uniform(seed) * (areas[0] + areas[1] + areas[2]), p[3], n[3] = {0};
        int axis = 0;
        for (; axis < 2 && chance > areas[axis]; axis++) chance -= areas[axis];
        n[axis] = uniform(seed) < 0.5 ? -1 : 1;
        for (int k = 0; k < 3; k++) p[k] = size[k] * (k == axis ? n[k] / 2 : uniform(seed) - 0.5);
        add_point(s, iso_vec3_make(p[0], p[1], p[2]), iso_vec3_make(n[0], n[1], n[2]));
    }
}

static iso_glyphs glyphs_of(sample *s) {
    return (iso_glyphs){.positions = s->positions, .colors = s->numbers, .count = s->count};
}

static size_t number_of(const iso_cloud *cloud, size_t index) {
    const uint8_t *c = cloud->colors[index];
    return (size_t)c[0] | (size_t)c[1] << 8 | (size_t)c[2] << 16;
}

static iso_cloud make_cloud(const iso_glyphs *glyphs, const iso_cloud_opts *opts) {
    iso_cloud cloud = {0};
    iso_error error;
    test_ok(iso_cloud_make(glyphs, opts, &cloud, &error), &error);
    return cloud;
}

/* ---- neighbours */

static void check_nearest(const iso_tree *tree, int most) {
    for (size_t slot = 0; slot < tree->count; slot += 7) {
        iso_neighbour found[ISO_NEIGHBOURS_MOST];
        const int count = iso_tree_nearest(tree, slot, most, found);
        float squares[FEW];
        size_t others = 0;
        for (size_t i = 0; i < tree->count; i++) {
            const float *a = tree->points[slot].position, *b = tree->points[i].position;
            const float x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2], square = x * x + y * y + z * z;
            size_t at = others;
            if (i == slot) continue;
            for (; at > 0 && squares[at - 1] > square; at--) squares[at] = squares[at - 1];
            squares[at] = square;
            others++;
        }
        assert_int_equal(count, others < (size_t)most ? (int)others : most);
        for (int i = 0; i < count; i++) {
            assert_true(found[i].square <= squares[i] * 1.000001f && found[i].square >= squares[i]);
            for (int k = 0; k < i; k++) assert_int_not_equal(found[i].slot, found[k].slot);
            assert_int_not_equal(found[i].slot, slot);
        }
    }
}

static void check_tree(const float (*positions)[3], size_t count) {
    iso_tree tree;
    iso_error error;
    test_ok(iso_tree_make(positions, count, NULL, &tree, &error), &error);
    bool seen[FEW] = {false};
    for (size_t slot = 0; slot < count; slot++) {
        const iso_tree_point *point = &tree.points[slot];
        assert_memory_equal(point->position, positions[point->index], sizeof point->position);
        assert_false(seen[point->index]);
        seen[point->index] = true;
    }
    check_nearest(&tree, 1);
    check_nearest(&tree, 9);
    iso_tree_free(&tree);
}

static void test_neighbours(void **state) {
    (void)state;
    static float positions[FEW][3];
    uint32_t seed = 5;
    /* in a cube; in few different places; on a line; all in one place; in a plane */
    for (int kind = 0; kind < 5; kind++) {
        for (size_t i = 0; i < FEW; i++)
            for (int axis = 0; axis < 3; axis++) {
                const double chance = uniform(&seed);
                positions[i][axis] = kind == 0   ? (float)(100 * chance)
                                     : kind == 1 ? (float)floor(4 * chance)
                                     : kind == 2 ? (float)i
                                     : kind == 3 ? 3.0f
                                                 : (float)(axis == 1 ? 7 : chance);
            }
        const size_t counts[] = {1, 2, ISO_TREE_LEAF, ISO_TREE_LEAF + 1, 100, FEW};
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
            check_tree((const float(*)[3])positions, counts[i]);
    }
}

/* ---- normals */

static double cosine_of(const float a[3], const float b[3]) {
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

/* Estimates the normals of `points`, and checks the median of their angles to the true ones, and which share
 * of them points out of the solid. */
static void check_normals(const char *name, double degrees, double right) {
    static double angles[MOST];
    const iso_glyphs glyphs = glyphs_of(&points);
    iso_cloud cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
    size_t outward = 0;
    assert_int_equal(cloud.estimated_normals, points.count);
    for (size_t i = 0; i < points.count; i++) {
        const double cosine = cosine_of(cloud.surfels[i].normal, points.normals[number_of(&cloud, i)]);
        outward += cosine > 0;
        angles[i] = acos(fmin(fabs(cosine), 1)) * 180 / ISO_PI;
    }
    qsort(angles, points.count, sizeof *angles, iso_compare_doubles);
    print_message("%s: median %.2f degrees, %.2f %% outward\n", name, angles[points.count / 2],
                  100.0 * (double)outward / (double)points.count);
    assert_true(angles[points.count / 2] <= degrees);
    assert_true((double)outward >= right * (double)points.count);
    iso_cloud_free(&cloud);
}

static void test_normals(void **state) {
    (void)state;
    uint32_t seed = 1;
    points.count = 0;
    add_sphere(&points, 5000, iso_vec3_make(100, -20, 7), 25, &seed);
    check_normals("sphere", 3, 1);
    points.count = 0;
    add_torus(&points, 20000, &seed);
    check_normals("torus", 3, 1);
    points.count = 0;
    add_box(&points, 20000, (double[3]){10, 20, 30}, &seed);
    check_normals("box", 0.1, 0.99);
    points.count = 0;
    add_box(&points, 20000, (double[3]){40, 40, 2}, &seed);
    check_normals("slab", 0.1, 0.99);
    points.count = 0;
    add_sphere(&points, 5000, iso_vec3_make(0, 0, 0), 10, &seed);
    add_sphere(&points, 5000, iso_vec3_make(30, 0, 0), 10, &seed);
    check_normals("two spheres", 3, 1);
    /* coordinates of micrometres and of kilometres */
    for (int exponent = -6; exponent <= 9; exponent += 15) {
        points.count = 0;
        add_sphere(&points, 3000, iso_vec3_make(0, 0, 0), pow(10, exponent), &seed);
        check_normals("sphere of another size", 4, 1);
    }
}

/* Normals that the file has stay, and turn the others. */
static void test_given_normals(void **state) {
    (void)state;
    uint32_t seed = 3;
    points.count = 0;
    add_sphere(&points, 5000, iso_vec3_make(0, 0, 0), 10, &seed);
    static float given[MOST][3];
    for (size_t i = 0; i < points.count; i++)
        for (int axis = 0; axis < 3; axis++) /* a tenth of them, into the sphere, and not of length 1 */
            given[i][axis] = i % 10 ? i % 3 ? 0 : NAN : -7 * points.normals[i][axis];
    iso_glyphs glyphs = glyphs_of(&points);
    glyphs.directions = given;
    iso_cloud cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
    assert_int_equal(cloud.estimated_normals, 4500);
    for (size_t i = 0; i < cloud.count; i++) {
        const size_t number = number_of(&cloud, i);
        const double cosine = cosine_of(cloud.surfels[i].normal, points.normals[number]);
        assert_true(number % 10 ? cosine < -0.8 : cosine < -0.999999);
    }
    iso_cloud_free(&cloud);
    cloud = make_cloud(&glyphs, &(iso_cloud_opts){.estimate_normals = true});
    assert_int_equal(cloud.estimated_normals, 5000);
    for (size_t i = 0; i < cloud.count; i++)
        assert_true(cosine_of(cloud.surfels[i].normal, points.normals[number_of(&cloud, i)]) > 0.8);
    iso_cloud_free(&cloud);
}

/* ---- radii */

static void test_radii(void **state) {
    (void)state;
    uint32_t seed = 8;
    points.count = 0;
    add_sphere(&points, 10000, iso_vec3_make(0, 0, 0), 10, &seed);
    add_point(&points, iso_vec3_make(200, 0, 0), iso_vec3_make(1, 0, 0)); /* far from all others */
    iso_glyphs glyphs = glyphs_of(&points);
    iso_cloud cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
    /* randomly placed points, of which there are d in a square millimetre: the expected distance to the k-th
     * neighbour is gamma(k + 1/2) / gamma(k) / sqrt(pi d) */
    const double density = 10000 / (4 * ISO_PI * 100),
                 sixth = tgamma(6.5) / tgamma(6) / sqrt(ISO_PI * density);
    near(cloud.radius, (double)ISO_CLOUD_RADIUS * sixth, 0.05 * sixth);
    for (size_t i = 0; i < cloud.count; i++)
        assert_true((double)cloud.radii[i] > 0.4 * cloud.radius && (double)cloud.radii[i] < 3 * cloud.radius);
    assert_int_equal(cloud.estimated_radii, 10001);
    iso_cloud_free(&cloud);

    /* Those of the file are used where they can be, */
    static float radii[MOST];
    for (size_t i = 0; i < points.count; i++) radii[i] = 0.5f;
    radii[3] = 0, radii[4] = -1, radii[5] = NAN, radii[6] = 51, radii[7] = 49;
    glyphs.radii = radii;
    cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
    assert_int_equal(cloud.estimated_radii, 4);
    for (size_t i = 0; i < cloud.count; i++) {
        const size_t number = number_of(&cloud, i);
        if (number < 3 || number >= 7)
            assert_true(cloud.radii[i] == radii[number]);
        else
            assert_true(cloud.radii[i] > 0.05f && cloud.radii[i] < 0.5f);
    }
    iso_cloud_free(&cloud);
    /* unless options say otherwise. */
    cloud = make_cloud(&glyphs, &(iso_cloud_opts){.radius = 2});
    assert_int_equal(cloud.estimated_radii, 0);
    assert_true(!cloud.radii && cloud.radius == 2);
    iso_cloud_free(&cloud);
    cloud = make_cloud(&glyphs, &(iso_cloud_opts){.estimate_radii = true});
    assert_int_equal(cloud.estimated_radii, 10001);
    iso_cloud_free(&cloud);
}

/* ---- spans */

static void check_spans(const iso_cloud *cloud, const iso_glyphs *glyphs) {
    const iso_affine affine = iso_transform_affine(&cloud->transform);
    size_t next = 0;
    for (size_t s = 0; s < cloud->span_count; s++) {
        const iso_point_span *span = &cloud->spans[s], *before = span - 1;
        assert_int_equal(span->first, next);
        assert_true(span->count > 0);
        next += span->count;
        for (int axis = 0; axis < 3; axis++) assert_true(span->brick[axis] >= 0);
        for (int axis = 2; s && axis >= 0; axis--) { /* in ascending order */
            if (span->brick[axis] == before->brick[axis]) continue;
            assert_true(span->brick[axis] > before->brick[axis]);
            break;
        }
        for (size_t i = span->first; i < next; i++) {
            const float *p = cloud->surfels[i].position, *from = glyphs->positions[number_of(cloud, i)];
            double at[3];
            iso_vec3_store(iso_affine_point(&affine, iso_brick_position(span->brick, p)), at);
            for (int axis = 0; axis < 3; axis++) {
                const double origin = axis == 0   ? glyphs->origin.x
                                      : axis == 1 ? glyphs->origin.y
                                                  : glyphs->origin.z;
                assert_true(p[axis] >= 0 && p[axis] <= ISO_BRICK);
                near(at[axis], origin + (double)from[axis], 2e-6 * cloud->transform.spacing[0]);
            }
        }
    }
    assert_int_equal(next, cloud->count);
}

static void test_spans(void **state) {
    (void)state;
    uint32_t seed = 4;
    points.count = 0;
    add_sphere(&points, 20000, iso_vec3_make(-3, 4, 5), 10, &seed);
    iso_glyphs glyphs = glyphs_of(&points);
    glyphs.origin = iso_vec3_make(596000, -4e6, 0);
    iso_cloud cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
    assert_true(cloud.span_count > 20 && cloud.span_count < 5000);
    near(cloud.transform.spacing[0] / cloud.radius, 1, 0.5);
    check_spans(&cloud, &glyphs);
    const iso_point_view view = iso_cloud_view(&cloud);
    assert_int_equal(iso_point_view_count(&view), 20000);
    iso_cloud_free(&cloud);
    /* A point so far away that there would be too many bricks: they are larger. */
    memcpy(points.positions[0], (float[3]){1e9f, 0, 0}, sizeof points.positions[0]);
    cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
    check_spans(&cloud, &glyphs);
    iso_cloud_free(&cloud);
    /* The same on all axes, so that the numbers of bricks have more than 32 bits. */
    for (int i = 0; i < 3000; i++)
        for (int axis = 0; axis < 3; axis++)
            points.positions[i][axis] = (float)(1e9 * (uniform(&seed) - 0.5));
    cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
    check_spans(&cloud, &glyphs);
    iso_cloud_free(&cloud);
}

/* ---- odd sets, threads */

static void test_degenerate(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++)
        for (size_t count = 1; count <= 10000; count = count < 16 ? count + 1 : count * 25) {
            uint32_t seed = 2;
            points.count = 0;
            for (size_t i = 0; i < count; i++) {
                const double t = kind == 0 ? 0 : uniform(&seed), u = kind == 2 ? uniform(&seed) : 0;
                /* in one place; on a line; on a plane; on a line, each place taken twice */
                add_point(&points, iso_vec3_make(kind == 3 ? (double)(i / 2) : t, 2 * t, u),
                          iso_vec3_make(1, 0, 0));
            }
            const iso_glyphs glyphs = glyphs_of(&points);
            iso_cloud cloud = make_cloud(&glyphs, &(iso_cloud_opts){0});
            for (size_t i = 0; i < count; i++) {
                near(cosine_of(cloud.surfels[i].normal, cloud.surfels[i].normal), 1, 1e-5);
                assert_true(cloud.radii[i] > 0 && isfinite(cloud.radii[i]));
            }
            check_spans(&cloud, &glyphs);
            iso_cloud_free(&cloud);
        }
    iso_cloud cloud;
    iso_error error;
    assert_int_equal(iso_cloud_make(&(iso_glyphs){.count = 0}, &(iso_cloud_opts){0}, &cloud, &error),
                     ISO_ERR_EMPTY);
}

static void test_threads(void **state) {
    (void)state;
    uint32_t seed = 6;
    iso_error error;
    points.count = 0;
    add_torus(&points, 20000, &seed);
    const iso_glyphs glyphs = glyphs_of(&points);
    iso_cloud one = make_cloud(&glyphs, &(iso_cloud_opts){0});
    for (int threads = 2; threads <= 5; threads += 3) {
        iso_pool *pool;
        test_ok(iso_pool_create(threads, &pool, &error), &error);
        iso_cloud many = make_cloud(&glyphs, &(iso_cloud_opts){.pool = pool});
        assert_memory_equal(one.surfels, many.surfels, one.count * sizeof *one.surfels);
        assert_memory_equal(one.radii, many.radii, one.count * sizeof *one.radii);
        assert_memory_equal(one.colors, many.colors, one.count * sizeof *one.colors);
        iso_cloud_free(&many);
        iso_pool_destroy(pool);
    }
    iso_cloud_free(&one);
}

/* ---- spacing and frame */

static iso_status frame(const iso_glyphs *glyphs, iso_box *box, size_t *outside) {
    const iso_point_source source = iso_point_source_of_glyphs(glyphs);
    iso_point_survey survey;
    assert_int_equal(iso_point_source_survey(&source, NULL, &survey, NULL), ISO_OK);
    return iso_cloud_frame(&source, &survey, box, outside, NULL);
}

/* The spacing of a lattice; a single point has none. The frame leaves out what lies far away, if it is
 * little. */
static void test_frame(void **state) {
    (void)state;
    static float positions[1000 + 30][3];
    for (int i = 0; i < 1000; i++)
        for (int axis = 0; axis < 3; axis++)
            positions[i][axis] = 0.25f * (float)(axis == 0 ? i % 10 : axis == 1 ? i / 10 % 10 : i / 100);
    for (int i = 1000; i < 1030; i++) positions[i][1] = (float)(500 - i);
    iso_glyphs glyphs = {.origin = {7e6, 0, 0}, .positions = positions, .count = 1000};
    iso_box box;
    size_t outside;
    double spacing;
    assert_int_equal(iso_cloud_spacing(&glyphs, NULL, &spacing, NULL), ISO_OK);
    assert_true(spacing == 0.25);
    for (int far = 0; far < 4; far++) {
        /* none, one or ten are left out; thirty are too many to be called few */
        glyphs.count = 1000 + (size_t)(far == 3 ? 30 : far == 2 ? 10 : far);
        assert_int_equal(frame(&glyphs, &box, &outside), ISO_OK);
        assert_int_equal(outside, far == 3 ? 0 : glyphs.count - 1000);
        assert_true(box.lo.x == 7e6 && box.hi.x == 7e6 + 2.25 && (far == 3 || box.lo.y == 0));
    }
    glyphs.count = 1;
    assert_int_equal(frame(&glyphs, &box, &outside), ISO_OK);
    assert_true(outside == 0 && box.lo.x == 7e6 && box.hi.x == 7e6);
    assert_int_equal(iso_cloud_spacing(&glyphs, NULL, &spacing, NULL), ISO_OK);
    assert_true(spacing == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_neighbours),    cmocka_unit_test(test_normals),
        cmocka_unit_test(test_given_normals), cmocka_unit_test(test_radii),
        cmocka_unit_test(test_spans),         cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_frame),         cmocka_unit_test(test_threads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
