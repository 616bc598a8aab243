/* The solids that sessions begin with: distances against brute force and every voxel against them, the first
 * lines of their stroke files, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/numbers.h"
#include "check_support.h"
#include "sculpt/session/event.h"
#include "session_support.h"

static double random_between(uint32_t *seed, double low, double high) {
    return low + (high - low) * uniform(seed);
}

static const iso_start_solid SOLIDS[] = {
    {ISO_SOLID_SPHERE, {31, 31, 31}, 0},   {ISO_SOLID_BOX, {30, 22, 14}, 0},
    {ISO_SOLID_BOX, {30, 22, 14}, 3},      {ISO_SOLID_BOX, {20, 20, 20}, 10},
    {ISO_SOLID_CAPSULE, {12, 12, 33}, 0},  {ISO_SOLID_CYLINDER, {24, 24, 15}, 0},
    {ISO_SOLID_CYLINDER, {12, 12, 40}, 4}, {ISO_SOLID_TORUS, {36, 36, 10}, 0},
};
enum { SOLIDS_COUNT = sizeof SOLIDS / sizeof *SOLIDS };

/* ---- brute force: the nearest of many places of the surface */

static double between(double value, double half) {
    return fmax(-half, fmin(half, value));
}

/* Whether a point is in the solid: whether a ball of a size fits between it and a core. */
static bool is_inside(const iso_start_solid *s, iso_vec3 p) {
    const double a = s->size.x / 2, b = s->size.y / 2, c = s->size.z / 2, r = s->round;
    const double aside = sqrt(p.x * p.x + p.y * p.y);
    iso_vec3 core = {0, 0, 0};
    double ball = a;
    if (s->kind == ISO_SOLID_BOX && r == 0) return fabs(p.x) <= a && fabs(p.y) <= b && fabs(p.z) <= c;
    if (s->kind == ISO_SOLID_CYLINDER && r == 0) return aside <= a && fabs(p.z) <= c;
    if (s->kind == ISO_SOLID_BOX) {
        core = iso_vec3_make(between(p.x, a - r), between(p.y, b - r), between(p.z, c - r));
        ball = r;
    } else if (s->kind == ISO_SOLID_CYLINDER) {
        const double scale = aside > a - r ? (a - r) / aside : 1;
        core = iso_vec3_make(p.x * scale, p.y * scale, between(p.z, c - r));
        ball = r;
    } else if (s->kind == ISO_SOLID_CAPSULE)
        core.z = between(p.z, c - a);
    else if (s->kind == ISO_SOLID_TORUS) {
        core = iso_vec3_make(p.x * (a - c) / aside, p.y * (a - c) / aside, 0);
        ball = c;
    }
    return iso_vec3_length(iso_vec3_sub(p, core)) <= ball;
}

enum { AROUND = 360, ALONG = 360 };
static iso_vec3 places[AROUND * ALONG];

/* Places of the surface along rays from the middle; of a torus, from the circle in its tube. */
static void find_places(const iso_start_solid *s) {
    for (int i = 0; i < AROUND * ALONG; i++) {
        const double u = 2 * ISO_PI * (i % AROUND) / AROUND, t = ISO_PI * (i / AROUND + 0.5) / ALONG;
        const iso_vec3 out = {cos(u), sin(u), 0};
        iso_vec3 from = {0, 0, 0}, way = {sin(t) * out.x, sin(t) * out.y, cos(t)};
        if (s->kind == ISO_SOLID_TORUS) {
            from = iso_vec3_scale(out, (s->size.x - s->size.z) / 2);
            way = iso_vec3_add(iso_vec3_scale(out, cos(2 * t)), iso_vec3_make(0, 0, sin(2 * t)));
        }
        double low = 0, high = 40;
        for (int step = 0; step < 40; step++) {
            const double middle = (low + high) / 2;
            *(is_inside(s, iso_vec3_add(from, iso_vec3_scale(way, middle))) ? &low : &high) = middle;
        }
        places[i] = iso_vec3_add(from, iso_vec3_scale(way, low));
    }
}

static double search(const iso_start_solid *s, iso_vec3 p) {
    double nearest = 1e9;
    for (int i = 0; i < AROUND * ALONG; i++)
        nearest = fmin(nearest, iso_vec3_length(iso_vec3_sub(places[i], p)));
    return is_inside(s, p) ? -nearest : nearest;
}

static void distances_are_exact(void **state) {
    (void)state;
    uint32_t seed = 5;
    for (int i = 0; i < SOLIDS_COUNT; i++) {
        const iso_start_solid *s = &SOLIDS[i];
        double worst = 0;
        int judged = 0;
        find_places(s);
        for (int k = 0; k < 400; k++) {
            const iso_vec3 p = {random_between(&seed, -24, 24), random_between(&seed, -24, 24),
                                random_between(&seed, -24, 24)};
            const double found = iso_start_solid_distance(s, p), wanted = search(s, p);
            if (fabs(wanted) < 0.7)
                continue; /* the places are up to .3 apart, and miss edges by half of it */
            worst = fmax(worst, fabs(found - wanted));
            judged++;
        }
        print_message("%s, edges of %g: %d places, at most %.4f off\n", iso_solid_name(s->kind), s->round,
                      judged, worst);
        assert_true(judged > 300 && worst < 0.2);
    }
}

/* ---- fields */

static iso_journal_start start_with(const iso_start_solid *solid, double voxel) {
    iso_journal_start start;
    iso_error error = {0};
    if (iso_start_with_solid(solid, voxel, &start, &error) != ISO_OK) fail_msg("%s", error.text);
    return start;
}

static void voxels_are_distances(void **state) {
    (void)state;
    for (int i = 0; i < SOLIDS_COUNT; i++) {
        const iso_journal_start start = start_with(&SOLIDS[i], 0.75);
        iso_hgrid *grid;
        assert_int_equal(iso_session_solid(&start, &grid, NULL), ISO_OK);
        const double band = (double)grid->band;
        for (int z = 0; z < start.dims[2]; z++)
            for (int y = 0; y < start.dims[1]; y++)
                for (int x = 0; x < start.dims[0]; x++) {
                    const iso_vec3 p =
                        iso_vec3_add(start.origin, iso_vec3_make(x * 0.75, y * 0.75, z * 0.75));
                    const double d = iso_start_solid_distance(&SOLIDS[i], p) / 0.75;
                    const double wanted = fmax(-band, fmin(band, d));
                    if (fabs((double)iso_hgrid_at(grid, x, y, z) - wanted) > 1e-5)
                        fail_msg("solid %d at %d %d %d: %g, not %g", i, x, y, z,
                                 (double)iso_hgrid_at(grid, x, y, z), wanted);
                }
        iso_hgrid_destroy(grid);
    }
}

/* ---- stroke files */

static void headers_are_read_back(void **state) {
    (void)state;
    for (int i = 0; i < SOLIDS_COUNT; i++) {
        const iso_journal_start start = start_with(&SOLIDS[i], 0);
        const bool ball = SOLIDS[i].kind == ISO_SOLID_SPHERE;
        iso_journal_start read;
        iso_error why = {0};
        char *line = iso_event_header_text(&start);
        assert_non_null(line);
        assert_non_null(strstr(line, ball ? "\"version\":1," : "\"version\":5,"));
        assert_true(ball == (strstr(line, "\"size\"") == NULL)); /* older programs read balls */
        assert_int_equal(iso_event_header_read(line, strlen(line) - 1, &read, &why), ISO_LINE_SOUND);
        const iso_start_solid a = iso_start_get_solid(&start), b = iso_start_get_solid(&read);
        assert_true(iso_start_has_solid(&read) && a.kind == b.kind && a.round == b.round);
        assert_memory_equal(&a.size, &b.size, sizeof a.size);
        assert_memory_equal(start.dims, read.dims, sizeof read.dims);
        free(line);
    }
}

/* The ball that a window begins with is the one that it has always been. */
static void usual_ball(void **state) {
    (void)state;
    const iso_start_solid solid = {ISO_SOLID_SPHERE, {80, 0, 0}, 0};
    const iso_journal_start start = start_with(&solid, 0);
    assert_string_equal(start.source, "ball");
    assert_true(start.voxel_size == 0.5 && start.radius == 40 && start.origin.x == -95.75);
    assert_int_equal(start.dims[0], 384);
}

static void nonsense_is_refused(void **state) {
    (void)state;
    const struct {
        iso_start_solid solid;
        double voxel;
        iso_status status;
    } cases[] = {
        {{ISO_SOLID_STAMP, {9, 9, 9}, 0}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_BOX, {9, -9, 9}, 0}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_BOX, {9, NAN, 9}, 0}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_BOX, {9, 9, 9}, 5}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_SPHERE, {9, 9, 9}, 1}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_BOX, {9, 9, 9}, -1}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_TORUS, {9, 9, 5}, 0}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_CAPSULE, {9, 9, 8}, 0}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_BOX, {90, 90, 1}, 0}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_BOX, {9, 9, 9}, NAN}, 1, ISO_ERR_USAGE},
        {{ISO_SOLID_SPHERE, {9, 9, 9}, 0}, 0.001, ISO_ERR_USAGE},
        {{ISO_SOLID_SPHERE, {9, 9, 9}, 0}, 0.01, ISO_ERR_LIMIT},
        {{ISO_SOLID_BOX, {INFINITY, 9, 9}, 0}, 1, ISO_ERR_USAGE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_journal_start start;
        iso_error error = {0};
        assert_int_equal(iso_start_with_solid(&cases[i].solid, cases[i].voxel, &start, &error),
                         cases[i].status);
        assert_true(error.text[0] && !strchr(error.text, '\n'));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(distances_are_exact),
                                       cmocka_unit_test(voxels_are_distances),
                                       cmocka_unit_test(headers_are_read_back), cmocka_unit_test(usual_ball),
                                       cmocka_unit_test(nonsense_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
