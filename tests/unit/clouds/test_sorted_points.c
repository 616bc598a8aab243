/* Points sorted into bricks, against a comparison sort; a source that changes while it is read. */
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check_support.h"
#include "clouds/spans.h"

enum { MOST = 600000 }; /* more than two tasks copy */

static float positions[MOST][3], normals[MOST][3], radii[MOST];
static uint8_t colors[MOST][3], opacities[MOST];

static uint32_t number_of(const iso_sorted_points *sorted, size_t i) {
    return (uint32_t)sorted->colors[i][0] | (uint32_t)sorted->colors[i][1] << 8 |
           (uint32_t)sorted->colors[i][2] << 16;
}

/* Points on a sphere, in a cube of many empty bricks, or nearly all in one brick. */
static void make_points(size_t count, int kind) {
    uint32_t seed = 3;
    for (size_t i = 0; i < count; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            positions[i][k] = (float)(200 * uniform(&seed) - 100);
            square += (double)positions[i][k] * (double)positions[i][k];
        }
        for (int k = 0; k < 3; k++) {
            const float unit = positions[i][k] / (float)sqrt(square);
            normals[i][k] = i % 3 ? unit : 2 * unit;
            if (kind == 0) positions[i][k] = 50 * unit;
            if (kind == 2 && i % 1000) positions[i][k] = 0.1f * unit + 7;
            colors[i][k] = (uint8_t)(i >> 8 * k);
        }
        radii[i] = (float)i;
        opacities[i] = (uint8_t)(i * 7);
    }
}

static iso_point_source source_of(size_t count) {
    return (iso_point_source){.count = count,
                              .positions = iso_point_column_of(positions, sizeof *positions),
                              .normals = iso_point_column_of(normals, sizeof *normals),
                              .radii = iso_point_column_of(radii, sizeof *radii),
                              .colors = iso_point_column_of(colors, sizeof *colors),
                              .opacities = iso_point_column_of(opacities, sizeof *opacities)};
}

static iso_sorted_points sort(const iso_point_source *source, double voxel, iso_pool *pool) {
    iso_error error;
    iso_point_survey survey;
    iso_sorted_points sorted = {0};
    test_ok(iso_point_source_survey(source, pool, &survey, &error), &error);
    assert_true(survey.finite && survey.without_normals == 0);
    test_ok(iso_points_sort(source, &survey, voxel, pool, &sorted, &error), &error);
    return sorted;
}

/* ---- the order */

typedef struct place {
    int64_t brick[3];
    uint32_t number;
} place;

static int compare_places(const void *a, const void *b) {
    const place *p = a, *q = b;
    for (int axis = 2; axis >= 0; axis--)
        if (p->brick[axis] != q->brick[axis]) return p->brick[axis] < q->brick[axis] ? -1 : 1;
    return p->number < q->number ? -1 : 1;
}

static void check_point(const iso_sorted_points *sorted, size_t i, const place *wanted) {
    const uint32_t number = number_of(sorted, i);
    const iso_surfel *surfel = &sorted->surfels[i];
    assert_int_equal(number, wanted->number);
    assert_true(sorted->radii[i] == radii[number] && sorted->opacities[i] == opacities[number]);
    for (int k = 0; k < 3; k++) {
        const double at = ((double)positions[number][k] - sorted->origin[k]) / sorted->voxel;
        assert_true(surfel->position[k] == (float)(at - ISO_BRICK * (double)wanted->brick[k]));
        near((double)surfel->normal[k], (double)normals[number][k] / (number % 3 ? 1 : 2), 1e-6);
    }
}

/* The bounds of a span are the least and greatest of its points' coordinates. */
static void check_bounds(const iso_sorted_points *sorted, size_t number) {
    const iso_point_span *span = &sorted->spans[number];
    const iso_point_bounds *bounds = &sorted->bounds[number];
    for (int k = 0; k < 3; k++) {
        float lo = INFINITY, hi = -INFINITY;
        for (size_t i = span->first; i < span->first + span->count; i++) {
            lo = fminf(lo, sorted->surfels[i].position[k]);
            hi = fmaxf(hi, sorted->surfels[i].position[k]);
        }
        assert_true(bounds->lo[k] == lo && bounds->hi[k] == hi);
    }
}

static void check_order(size_t count, double voxel, iso_pool *pool) {
    const iso_point_source source = source_of(count);
    iso_sorted_points sorted = sort(&source, voxel, pool);
    place *places = malloc(count * sizeof *places);
    assert_non_null(places);
    for (size_t i = 0; i < count; i++) {
        places[i].number = (uint32_t)i;
        for (int k = 0; k < 3; k++)
            places[i].brick[k] =
                (int64_t)floor(((double)positions[i][k] - sorted.origin[k]) / (sorted.voxel * ISO_BRICK));
    }
    qsort(places, count, sizeof *places, compare_places);
    size_t next = 0;
    for (size_t s = 0; s < sorted.span_count; s++) {
        const iso_point_span *span = &sorted.spans[s];
        assert_true(span->first == next && span->count > 0);
        for (int k = 0; k < 3; k++) assert_int_equal(span->brick[k], places[next].brick[k]);
        check_bounds(&sorted, s);
        for (; next < span->first + span->count; next++) check_point(&sorted, next, &places[next]);
        assert_true(next == count || memcmp(places[next - 1].brick, places[next].brick,
                                            sizeof places[next].brick) != 0); /* a brick has one span */
    }
    assert_int_equal(next, count);
    iso_sorted_points_free(&sorted);
    free(places);
}

static void test_order(void **state) {
    (void)state;
    /* voxels so large that all is one brick; medium ones; so small that numbers have more than 32 bits */
    static const double voxels[] = {100, 0.3, 0.004};
    static const size_t counts[] = {1, 2, 511, 5000, MOST};
    iso_pool *pool;
    iso_error error;
    test_ok(iso_pool_create(3, &pool, &error), &error);
    for (int kind = 0; kind < 3; kind++) {
        make_points(MOST, kind);
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
            for (int v = 0; v < 3; v++) check_order(counts[c], voxels[v], (c + (size_t)v) % 2 ? pool : NULL);
    }
    iso_pool_destroy(pool);
}

/* ---- a source that changes */

/* Changes points again and again, in a process of its own, as another program would change a file. */
static pid_t start_changing(float (*shared)[3], size_t count) {
    const pid_t child = fork();
    uint32_t seed = 1;
    if (child) return child;
    for (size_t i = 0;; i = (i + 7919) % count) {
        const float values[] = {NAN, 1e30f, -99, 99, 0, -1e9f};
        shared[i][i % 3] = values[(int)(6 * uniform(&seed))];
    }
}

/* Nothing is written outside the arrays; a change is reported, unless the points are those of one moment. */
static void test_changes(void **state) {
    (void)state;
    const size_t count = 300000;
    iso_error error;
    iso_point_survey survey;
    make_points(count, 1);
    float(*shared)[3] =
        mmap(NULL, count * sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_true(shared != MAP_FAILED);
    iso_point_source source = source_of(count);
    source.positions.data = (const unsigned char *)shared;
    int changes = 0;
    for (int round = 0; round < 30; round++) {
        iso_sorted_points sorted = {0};
        memcpy(shared, positions, count * sizeof *shared);
        test_ok(iso_point_source_survey(&source, NULL, &survey, &error), &error);
        const pid_t child = start_changing(shared, count);
        const iso_status status = iso_points_sort(&source, &survey, 0.3, NULL, &sorted, &error);
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
        if (status != ISO_OK) assert_int_equal(status, ISO_ERR_IO);
        changes += status != ISO_OK;
        iso_sorted_points_free(&sorted);
    }
    print_message("%d changes of 30 were noticed\n", changes);
    assert_true(changes > 0);
    munmap(shared, count * sizeof *shared);
}

/* ---- the survey */

static void test_survey(void **state) {
    (void)state;
    iso_error error;
    iso_point_survey survey;
    for (size_t count = 1; count < 3000; count = count * 3 + 1) {
        const iso_point_source source = source_of(count);
        make_points(count, 1);
        positions[count / 2][1] = 1000, positions[count - 1][2] = -2000;
        memset(normals[count / 3], 0, sizeof *normals);
        normals[count - 1][0] = NAN;
        test_ok(iso_point_source_survey(&source, NULL, &survey, &error), &error);
        assert_true(survey.finite && survey.hi[1] == 1000 && survey.lo[2] == -2000);
        assert_int_equal(survey.without_normals, count / 3 == count - 1 ? 1 : 2);
        for (size_t at = 0; at < count; at += 1 + at / 2) {
            const float kept = positions[at][at % 3];
            positions[at][at % 3] = at % 2 ? NAN : -INFINITY;
            test_ok(iso_point_source_survey(&source, NULL, &survey, &error), &error);
            assert_false(survey.finite);
            positions[at][at % 3] = kept;
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_changes),
        cmocka_unit_test(test_survey),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
