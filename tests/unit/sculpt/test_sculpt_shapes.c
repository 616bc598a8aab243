/* Strokes with known volume and area, and distances compared by brute force with the mesh that is extracted
 * from the field. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "session_support.h"

static const iso_journal_start BALL = {.source = "ball",
                                       .voxel_size = 1,
                                       .dims = {128, 128, 128},
                                       .origin = {-63.5, -63.5, -63.5},
                                       .radius = 30};

/* The same in voxels of half the size: edges are rounded over a voxel. */
static const iso_journal_start FINE = {.source = "ball",
                                       .voxel_size = 0.5,
                                       .dims = {256, 256, 256},
                                       .origin = {-63.75, -63.75, -63.75},
                                       .radius = 30};

static iso_session *open_ball(const iso_journal_start *start) {
    const iso_session_opts opts = {0};
    iso_hgrid *grid;
    iso_session *session;
    assert_int_equal(iso_session_solid(start, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, start, &opts, &session, NULL), ISO_OK);
    return session;
}

/* A stroke from a to b (the same: one touch), its normal up. */
static void draw(iso_session *session, const iso_brush *brush, iso_vec3 a, iso_vec3 b) {
    iso_sample sample = {.position = a, .normal = {0, 0, 1}, .pressure = 1};
    iso_error error = {0};
    iso_status status = iso_session_begin(session, brush, &sample, NULL, &error);
    sample.position = b;
    if (status == ISO_OK) status = iso_session_sample(session, &sample, NULL, &error);
    if (status == ISO_OK) status = iso_session_end(session, &error);
    if (status != ISO_OK) fail_msg("%s", error.text);
}

/* ---- measures */

static iso_weld mesh_of(iso_session *session) {
    const iso_grid grid = {.hgrid = iso_session_grid(session)};
    const iso_mesh_opts opts = {0};
    iso_mesh_set *set;
    iso_weld weld = {0};
    assert_int_equal(iso_mesh_set_create(&grid, &opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    const iso_mesh_view view = iso_mesh_set_view(set);
    assert_int_equal(iso_mesh_weld(&view, NULL, &weld, NULL), ISO_OK);
    iso_mesh_set_destroy(set);
    return weld;
}

static iso_vec3 corner_of(const iso_weld *weld, size_t triangle, int corner) {
    const float *p = weld->vertices[weld->triangles[triangle][corner]].position;
    return iso_vec3_make(p[0], p[1], p[2]);
}

typedef struct measure {
    double volume, area;
} measure;

static void check_measure(const char *what, iso_session *session, measure wanted) {
    iso_weld weld = mesh_of(session);
    measure got = {0};
    for (size_t i = 0; i < weld.triangle_count; i++) {
        const iso_vec3 a = corner_of(&weld, i, 0), b = corner_of(&weld, i, 1), c = corner_of(&weld, i, 2);
        got.volume += iso_vec3_dot(a, iso_vec3_cross(b, c)) / 6;
        got.area += iso_vec3_length(iso_vec3_cross(iso_vec3_sub(b, a), iso_vec3_sub(c, a))) / 2;
    }
    iso_weld_free(&weld);
    const double voxel = iso_session_grid(session)->transform.spacing[0];
    got = (measure){got.volume * voxel * voxel * voxel, got.area * voxel * voxel};
    print_message("%s: volume %.1f of %.1f (%+.2f %%), area %.1f of %.1f (%+.2f %%)\n", what, got.volume,
                  wanted.volume, 100 * (got.volume / wanted.volume - 1), got.area, wanted.area,
                  100 * (got.area / wanted.area - 1));
    assert_true(fabs(got.volume / wanted.volume - 1) < 0.005);
    assert_true(fabs(got.area / wanted.area - 1) < 0.005);
    iso_session_destroy(session);
}

/* ---- strokes of known volume and area */

static double cap_volume(double radius, double height) {
    return ISO_PI * height * height * (3 * radius - height) / 3;
}

static void balls(void **state) {
    (void)state;
    const double r1 = 30, r2 = 16, d = 30.3;
    const double h1 = (r2 - r1 + d) * (r2 + r1 - d) / (2 * d), h2 = (r1 - r2 + d) * (r1 + r2 - d) / (2 * d);
    const double lens = cap_volume(r1, h1) + cap_volume(r2, h2), cap1 = 2 * ISO_PI * r1 * h1,
                 cap2 = 2 * ISO_PI * r2 * h2;
    const double v1 = 4 * ISO_PI / 3 * r1 * r1 * r1, v2 = 4 * ISO_PI / 3 * r2 * r2 * r2,
                 a1 = 4 * ISO_PI * r1 * r1, a2 = 4 * ISO_PI * r2 * r2;
    const iso_vec3 at = iso_vec3_scale(iso_vec3_unit(iso_vec3_make(3, 2, 1)), d);
    iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = r2};
    iso_session *session = open_ball(&BALL);
    draw(session, &brush, at, at);
    check_measure("ball added", session, (measure){v1 + v2 - lens, a1 + a2 - cap1 - cap2});
    brush.tool = ISO_TOOL_CARVE;
    session = open_ball(&BALL);
    draw(session, &brush, at, at);
    check_measure("ball carved", session, (measure){v1 - lens, a1 - cap1 + cap2});
}

/* Nothing but a box of half sides radius (along y), aspect * radius, aspect * radius. */
static iso_session *open_box(double radius, double aspect) {
    const iso_vec3 centre = {0, 0, 0};
    const iso_brush all = {.tool = ISO_TOOL_CARVE, .radius = 40},
                    box = {.tool = ISO_TOOL_ADD, .shape = ISO_SOLID_BOX, .radius = radius, .aspect = aspect};
    iso_session *session = open_ball(&FINE);
    draw(session, &all, centre, centre);
    draw(session, &box, centre, centre);
    return session;
}

static void box_cut_in_half(void **state) {
    (void)state;
    iso_session *session = open_box(45, 0.8);
    const iso_brush half = {.tool = ISO_TOOL_CARVE, .shape = ISO_SOLID_BOX, .radius = 60, .aspect = 1};
    const iso_vec3 above = {0, 0, 60};
    draw(session, &half, above, above);
    const double a = 90, b = 72, c = 36;
    check_measure("box cut in half", session, (measure){a * b * c, 2 * (a * b + b * c + c * a)});
}

static void tunnel_through_a_slab(void **state) {
    (void)state;
    iso_session *session = open_box(14, 4);
    const iso_brush drill = {.tool = ISO_TOOL_CARVE, .shape = ISO_SOLID_CAPSULE, .radius = 10};
    draw(session, &drill, iso_vec3_make(3.2, -30, 1.7), iso_vec3_make(3.2, 30, 1.7));
    const double side = 112, thick = 28, r = 10;
    check_measure(
        "tunnel through a slab", session,
        (measure){side * side * thick - ISO_PI * r * r * thick,
                  2 * side * side + 4 * side * thick - 2 * ISO_PI * r * r + 2 * ISO_PI * r * thick});
}

/* ---- distances by brute force */

/* Ericson, Real-Time Collision Detection, 5.1.5. */
static double triangle_distance(iso_vec3 p, iso_vec3 a, iso_vec3 b, iso_vec3 c) {
    const iso_vec3 ab = iso_vec3_sub(b, a), ac = iso_vec3_sub(c, a), ap = iso_vec3_sub(p, a),
                   bp = iso_vec3_sub(p, b), cp = iso_vec3_sub(p, c);
    const double d1 = iso_vec3_dot(ab, ap), d2 = iso_vec3_dot(ac, ap), d3 = iso_vec3_dot(ab, bp),
                 d4 = iso_vec3_dot(ac, bp), d5 = iso_vec3_dot(ab, cp), d6 = iso_vec3_dot(ac, cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    double v = 0, w = 0;
    if (d1 <= 0 && d2 <= 0)
        v = w = 0;
    else if (d3 >= 0 && d4 <= d3)
        v = 1;
    else if (d6 >= 0 && d5 <= d6)
        w = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        v = d1 / (d1 - d3);
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        w = d2 / (d2 - d6);
    else if (va <= 0 && d4 >= d3 && d5 >= d6) {
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        v = 1 - w;
    } else {
        v = vb / (va + vb + vc);
        w = vc / (va + vb + vc);
    }
    const iso_vec3 q = iso_vec3_add(a, iso_vec3_add(iso_vec3_scale(ab, v), iso_vec3_scale(ac, w)));
    return iso_vec3_length(iso_vec3_sub(p, q));
}

/* Triangles by blocks of 4^3 voxels: those nearer to the block than SEARCH. */
enum { BLOCK = 4, BLOCKS = 128 / BLOCK };
static const double SEARCH = 3.3;
typedef struct buckets {
    uint32_t *first, *list; /* of BLOCKS^3 + 1; triangles */
} buckets;

static void block_range(const iso_weld *weld, size_t triangle, int lo[3], int hi[3]) {
    for (int axis = 0; axis < 3; axis++) {
        double least = 1e9, most = -1e9;
        for (int k = 0; k < 3; k++) {
            const double p = (double)weld->vertices[weld->triangles[triangle][k]].position[axis];
            least = fmin(least, p);
            most = fmax(most, p);
        }
        lo[axis] = (int)fmax(floor((least - SEARCH) / BLOCK), 0);
        hi[axis] = (int)fmin(floor((most + SEARCH) / BLOCK), BLOCKS - 1);
    }
}

static buckets sort_triangles(const iso_weld *weld) {
    buckets b = {.first = calloc(BLOCKS * BLOCKS * BLOCKS + 2, sizeof *b.first)};
    assert_non_null(b.first);
    for (int pass = 0; pass < 2; pass++) {
        for (size_t t = 0; t < weld->triangle_count; t++) {
            int lo[3], hi[3];
            block_range(weld, t, lo, hi);
            for (int z = lo[2]; z <= hi[2]; z++)
                for (int y = lo[1]; y <= hi[1]; y++)
                    for (int x = lo[0]; x <= hi[0]; x++) {
                        uint32_t *slot = &b.first[(z * BLOCKS + y) * BLOCKS + x + 1];
                        if (pass == 1) b.list[*slot] = (uint32_t)t;
                        slot[pass == 0]++;
                    }
        }
        if (pass == 1) break;
        for (int i = 1; i < BLOCKS * BLOCKS * BLOCKS + 2; i++) b.first[i] += b.first[i - 1];
        b.list = malloc((b.first[BLOCKS * BLOCKS * BLOCKS + 1] + 1) * sizeof *b.list);
        assert_non_null(b.list);
    }
    return b;
}

static double mesh_distance(const iso_weld *weld, const buckets *b, iso_vec3 p) {
    const int block = ((int)p.z / BLOCK * BLOCKS + (int)p.y / BLOCK) * BLOCKS + (int)p.x / BLOCK;
    double least = SEARCH;
    for (uint32_t i = b->first[block]; i < b->first[block + 1]; i++) {
        const size_t t = b->list[i];
        least = fmin(
            least, triangle_distance(p, corner_of(weld, t, 0), corner_of(weld, t, 1), corner_of(weld, t, 2)));
    }
    return least;
}

/* 99 % of the band is within a tenth of a voxel of the mesh's distance. */
static void check_band(const char *what, iso_session *session) {
    const iso_hgrid *grid = iso_session_grid(session);
    iso_weld weld = mesh_of(session);
    buckets sorted = sort_triangles(&weld);
    size_t band = 0, good = 0;
    double worst = 0;
    for (int i = 0; i < 128 * 128 * 128; i++) {
        const int x = i % 128, y = i / 128 % 128, z = i / 128 / 128;
        const double d = fabs((double)iso_hgrid_at(grid, x, y, z));
        if (d >= (double)grid->band) continue;
        const double error = fabs(d - mesh_distance(&weld, &sorted, iso_vec3_make(x, y, z)));
        band++;
        good += error <= 0.1;
        worst = fmax(worst, error);
    }
    print_message("%s: %zu voxels in the band, %.3f %% within 0.1 voxel of the mesh, worst %.2f\n", what,
                  band, 100 * (double)good / (double)band, worst);
    free(sorted.first);
    free(sorted.list);
    iso_weld_free(&weld);
    iso_session_destroy(session);
    assert_true(band > 50000);
    assert_true((double)good >= 0.99 * (double)band);
}

/* A stroke that winds around the ball, on its surface as it is. */
static void wind(iso_session *session, const iso_brush *brush, double rise) {
    const iso_vec3 centre = {63.5, 63.5, 63.5};
    iso_sample sample = {.pressure = 1};
    for (int s = 0; s <= 60; s++) {
        const double turn = 0.06 * s + rise;
        const iso_vec3 direction = iso_vec3_unit(iso_vec3_make(cos(turn), sin(turn), rise + 0.3 * sin(turn)));
        sample.position =
            iso_vec3_add(sculpt_pick(iso_session_grid(session), centre, direction), BALL.origin);
        sample.normal = direction;
        iso_status status = s ? iso_session_sample(session, &sample, NULL, NULL)
                              : iso_session_begin(session, brush, &sample, NULL, NULL);
        assert_int_equal(status, ISO_OK);
    }
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
}

static void fields_are_distances(void **state) {
    (void)state;
    static const iso_tool tools[] = {
        ISO_TOOL_ADD,     ISO_TOOL_CARVE,   ISO_TOOL_BLEND_ADD, ISO_TOOL_SMOOTH, ISO_TOOL_INFLATE,
        ISO_TOOL_DEFLATE, ISO_TOOL_FLATTEN, ISO_TOOL_PINCH,     ISO_TOOL_SCRAPE, ISO_TOOL_FILL,
        ISO_TOOL_CLAY,    ISO_TOOL_CREASE,  ISO_TOOL_SNAKE_HOOK};
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++) {
        const iso_brush brush = {.tool = tools[i], .radius = 10};
        iso_session *session = open_ball(&BALL);
        wind(session, &brush, 0);
        wind(session, &brush, 0.5);
        check_band(iso_tool_name(tools[i]), session);
    }
}

/* One tool after the other, in the same places. */
static void fields_are_distances_after_all(void **state) {
    (void)state;
    static const iso_tool tools[] = {ISO_TOOL_ADD,         ISO_TOOL_CARVE,   ISO_TOOL_SMOOTH,
                                     ISO_TOOL_BLEND_CARVE, ISO_TOOL_INFLATE, ISO_TOOL_SMOOTH};
    iso_session *session = open_ball(&BALL);
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++)
        wind(session, &(iso_brush){.tool = tools[i], .radius = 9}, 0.2 * (double)i - 0.5);
    check_band("all of them", session);
}

/* Thin brushes drag the surface across the grid: it is drawn out to sheets and threads that tear, and comes
 * to where the field knew of none. */
static void far_drags_keep_a_band(void **state) {
    (void)state;
    iso_session *session = open_ball(&BALL);
    uint32_t seed = 7;
    for (int i = 0; i < 60; i++) {
        const iso_brush brush = {
            .tool = ISO_TOOL_MOVE, .radius = 2 + 6 * uniform(&seed), .symmetry = i % 2 ? 5 : 0};
        iso_vec3 from = {uniform(&seed) - 0.5, uniform(&seed) - 0.5, uniform(&seed) - 0.5},
                 to = {100 * uniform(&seed) - 50, 100 * uniform(&seed) - 50, 100 * uniform(&seed) - 50};
        from = iso_vec3_scale(iso_vec3_unit(from), BALL.radius);
        draw(session, &brush, from, to);
        const sculpt_quality quality = sculpt_measure(iso_session_grid(session), 0);
        if (quality.clamped) fail_msg("drag %d: %zu stencils are clamped", i, quality.clamped);
        if (i % 3) assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    }
    iso_session_destroy(session);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls),
        cmocka_unit_test(box_cut_in_half),
        cmocka_unit_test(tunnel_through_a_slab),
        cmocka_unit_test(fields_are_distances),
        cmocka_unit_test(fields_are_distances_after_all),
        cmocka_unit_test(far_drags_keep_a_band),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
