/* Closing of open meshes, meshes that cannot be closed, and the level sets of the enclosed solids. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "grids/closing/closed_mesh.h"
#include "grids/level_set.h"
#include "grids/scenes/scenes.h"
#include "sculpt_support.h"

/* ---- meshes */

enum { ROOM = 1 << 17 };

static iso_triangles mesh_make(void) {
    iso_triangles mesh = {malloc(ROOM * sizeof *mesh.vertices), malloc(ROOM * sizeof *mesh.triangles), 0, 0,
                          NULL};
    assert_non_null(mesh.vertices);
    assert_non_null(mesh.triangles);
    return mesh;
}

static void mesh_free(iso_triangles *mesh) {
    free(mesh->vertices);
    free(mesh->triangles);
}

static uint32_t put_vertex(iso_triangles *mesh, double x, double y, double z) {
    assert_true(mesh->vertex_count < ROOM);
    float *v = mesh->vertices[mesh->vertex_count];
    v[0] = (float)x;
    v[1] = (float)y;
    v[2] = (float)z;
    return (uint32_t)mesh->vertex_count++;
}

static void put_triangle(iso_triangles *mesh, uint32_t a, uint32_t b, uint32_t c) {
    assert_true(mesh->triangle_count < ROOM);
    const uint32_t t[3] = {a, b, c};
    memcpy(mesh->triangles[mesh->triangle_count++], t, sizeof t);
}

static void put_quad(iso_triangles *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    put_triangle(mesh, a, b, c);
    put_triangle(mesh, a, c, d);
}

/* Outward triangles; its poles are along z, and triangles there have two equal corners. */
static void put_ball(iso_triangles *mesh, iso_vec3 centre, double radius) {
    enum { RINGS = 80, SLICES = 160 };
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (int i = 0; i <= RINGS; i++)
        for (int k = 0; k < SLICES; k++) {
            double sine[2], cosine[2];
            iso_sincos(ISO_PI * i / RINGS, &sine[0], &cosine[0]);
            iso_sincos(2 * ISO_PI * k / SLICES, &sine[1], &cosine[1]);
            if (i == 0 || i == RINGS) sine[0] = 0;
            put_vertex(mesh, centre.x + radius * sine[0] * cosine[1], centre.y + radius * sine[0] * sine[1],
                       centre.z + radius * cosine[0]);
        }
    for (uint32_t i = 0; i < RINGS; i++)
        for (uint32_t k = 0; k < SLICES; k++) {
            const uint32_t a = first + i * SLICES, b = a + SLICES, next = (k + 1) % SLICES;
            put_quad(mesh, a + k, b + k, b + next, a + next);
        }
}

/* A box of 12 triangles that face outwards. */
static void put_box(iso_triangles *mesh, iso_vec3 lo, iso_vec3 hi) {
    uint32_t v[8];
    for (int i = 0; i < 8; i++)
        v[i] = put_vertex(mesh, i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
    put_quad(mesh, v[0], v[2], v[3], v[1]);
    put_quad(mesh, v[4], v[5], v[7], v[6]);
    put_quad(mesh, v[0], v[1], v[5], v[4]);
    put_quad(mesh, v[2], v[6], v[7], v[3]);
    put_quad(mesh, v[0], v[4], v[6], v[2]);
    put_quad(mesh, v[1], v[3], v[7], v[5]);
}

static void turn(iso_triangles *mesh, size_t first, size_t count) {
    for (size_t i = first; i < first + count; i++) {
        const uint32_t held = mesh->triangles[i][0];
        mesh->triangles[i][0] = mesh->triangles[i][1];
        mesh->triangles[i][1] = held;
    }
}

static void take_out(iso_triangles *mesh, size_t triangle) {
    memmove(mesh->triangles[triangle], mesh->triangles[--mesh->triangle_count], sizeof *mesh->triangles);
}

/* ---- fields */

static iso_closed_mesh *close_mesh(const iso_triangles *mesh, double hole) {
    const iso_closing_opts opts = {.hole = hole};
    iso_closed_mesh *closed;
    iso_error error = {0};
    if (iso_closed_mesh_create("a mesh", mesh, &opts, &closed, &error) != ISO_OK) fail_msg("%s", error.text);
    return closed;
}

static void refuse(const iso_triangles *mesh, double hole, iso_status wanted, const char *word) {
    const iso_closing_opts opts = {.hole = hole};
    iso_closed_mesh *closed;
    iso_error error = {0};
    iso_status status = iso_closed_mesh_create("a mesh", mesh, &opts, &closed, &error);
    if (status != wanted || !strstr(error.text, word))
        fail_msg("status %d, '%s' without '%s'", (int)status, error.text, word);
}

static iso_hgrid *field_of(const iso_closed_mesh *closed, double voxel) {
    const iso_sampling frame = {.voxel = voxel, .margin = 5};
    iso_hgrid *grid;
    iso_error error = {0};
    if (iso_level_set_from_mesh("a mesh", closed, &frame, &grid, &error) != ISO_OK)
        fail_msg("%s", error.text);
    return grid;
}

static double solid_volume(const iso_hgrid *grid) {
    size_t inside = 0;
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++) inside += iso_hgrid_at(grid, x, y, z) < 0;
    const double *s = grid->transform.spacing;
    return (double)inside * s[0] * s[1] * s[2];
}

typedef double shape(iso_vec3 p); /* signed distance in mm */

/* The distance, in mm, from inside a union of shapes to its outside: what the shapes' own distances are too
 * small for near where they meet. From samples an eighth of `most` apart. */
static double to_outside(shape *at, iso_vec3 p, double most) {
    double least = most;
    for (int i = 0; i < 23 * 23 * 23; i++) {
        const iso_vec3 way = iso_vec3_scale(
            iso_vec3_make(i % 23 - 11, i / 23 % 23 - 11, (double)(i / (23 * 23)) - 11), most / 8);
        const double d = at(iso_vec3_add(p, way));
        if (d > 0) least = fmin(least, iso_vec3_length(way) - d);
    }
    return least;
}

/* All signs, and all distances of the band but for `bad` of them, to 0.1 voxel. */
static void check_field(const char *what, const iso_hgrid *grid, shape *wanted_at, double bad) {
    const iso_affine affine = iso_transform_affine(&grid->transform);
    size_t band = 0, wrong = 0;
    double worst = 0;
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++) {
                const double wanted =
                    wanted_at(iso_affine_point(&affine, iso_vec3_make(x, y, z))) / grid->transform.spacing[0];
                const double got = (double)iso_hgrid_at(grid, x, y, z);
                if (fabs(wanted) > 0.1 && (got < 0) != (wanted < 0))
                    fail_msg("%s: voxel (%d, %d, %d) is %g, wanted %g", what, x, y, z, got, wanted);
                if (fabs(wanted) >= 3 && fabs(got) >= 3) continue;
                double off = fabs(got - fmin(fmax(wanted, -3), 3));
                if (off > 0.1 && got < 0) {
                    const double voxel = grid->transform.spacing[0];
                    const iso_vec3 p = iso_affine_point(&affine, iso_vec3_make(x, y, z));
                    off = fabs(got + to_outside(wanted_at, p, 3 * voxel) / voxel);
                }
                band++;
                wrong += off > 0.1;
                worst = fmax(worst, off);
            }
    print_message("%s: %zu voxels in the band, %zu off by more than 0.1 voxel, worst %.3f\n", what, band,
                  wrong, worst);
    assert_true(band > 1000 && (double)wrong <= bad * (double)band);
}

static double ball(iso_vec3 p) {
    return iso_vec3_length(iso_vec3_sub(p, iso_vec3_make(3, -4, 5))) - 20;
}

static const iso_vec3 CENTRE = {3, -4, 5};

static iso_triangles ball_mesh(void) {
    iso_triangles mesh = mesh_make();
    put_ball(&mesh, CENTRE, 20);
    return mesh;
}

static iso_mesh_report check_ball(const char *what, const iso_triangles *mesh) {
    iso_closed_mesh *closed = close_mesh(mesh, 0);
    const iso_mesh_report report = *iso_closed_mesh_report(closed);
    assert_true(fabs(fabs(report.volume) / (4 * ISO_PI / 3 * 8000) - 1) < 0.005);
    iso_hgrid *grid = field_of(closed, 0.8);
    check_field(what, grid, ball, 0.001);
    iso_hgrid_destroy(grid);
    iso_closed_mesh_destroy(closed);
    return report;
}

/* ---- tests */

static void winding_numbers(void **state) {
    (void)state;
    iso_triangles mesh = ball_mesh();
    iso_triangle_tree *tree;
    assert_int_equal(iso_triangle_tree_create(&mesh, &tree, NULL), ISO_OK);
    double worst = 0;
    for (int i = 0; i < 40 * 40 * 40; i++) {
        const iso_vec3 p = {3 + 0.9 * (i % 40 - 20), -4 + 0.9 * (i / 40 % 40 - 20),
                            5.1 + 0.9 * ((double)(i / 1600) - 20)};
        if (fabs(ball(p)) < 0.05) continue;
        worst = fmax(worst, fabs(iso_triangle_tree_winding(tree, p) - (ball(p) < 0)));
    }
    print_message("winding numbers are off by %.4f at most\n", worst);
    assert_true(worst < 0.1);
    /* nearest points, from anywhere */
    for (int i = 0; i < 1000; i++) {
        const iso_vec3 p = {i % 10 * 7.1 - 30, i / 10 % 10 * 7.3 - 35, (double)(i / 100) * 6.9 - 30};
        iso_nearest nearest = {.squared = INFINITY, .triangle = (size_t)(i * 17)};
        iso_triangle_tree_nearest(tree, p, &nearest);
        assert_true(fabs(sqrt(nearest.squared) - fabs(ball(p))) < 0.02);
        assert_true(fabs(ball(nearest.point)) < 0.02);
    }
    iso_triangle_tree_destroy(tree);
    mesh_free(&mesh);
}

static void damaged_balls(void **state) {
    (void)state;
    iso_mesh_report r;
    iso_triangles mesh = ball_mesh();
    r = check_ball("whole", &mesh);
    assert_true(r.open_edges == 0 && r.holes_closed == 0 && r.turned == 0 && r.volume > 0);
    char note[200];
    assert_false(iso_mesh_report_note(&r, note, sizeof note));
    take_out(&mesh, 9001);
    r = check_ball("a missing triangle", &mesh);
    assert_true(r.open_edges == 3 && r.holes_closed == 1);
    assert_true(iso_mesh_report_note(&r, note, sizeof note) && strstr(note, "3 open edges"));
    for (size_t i = 0; i < 20; i++) take_out(&mesh, 500 + 1001 * i);
    r = check_ball("many missing triangles", &mesh);
    assert_true(r.open_edges == 63 && r.holes_closed == 21);
    turn(&mesh, 0, mesh.triangle_count);
    r = check_ball("inside out, and open", &mesh);
    assert_true(r.volume < 0 && r.holes_closed == 21);
    assert_true(iso_mesh_report_note(&r, note, sizeof note) && strstr(note, "inside out"));
    mesh_free(&mesh);

    mesh = ball_mesh();
    turn(&mesh, 5000, 300);
    turn(&mesh, 8000, 1);
    r = check_ball("some triangles face inwards", &mesh);
    assert_true(r.turned == 301 && r.volume > 0 && r.open_edges == 0);
    memcpy(mesh.triangles + mesh.triangle_count, mesh.triangles + 1000, 2000 * sizeof *mesh.triangles);
    mesh.triangle_count += 2000;
    r = check_ball("triangles twice", &mesh);
    assert_true(r.open_edges == 0);
    mesh_free(&mesh);

    mesh = ball_mesh(); /* a T-junction: one triangle of an edge is divided */
    const uint32_t *t = mesh.triangles[9000];
    const uint32_t a = t[0], b = t[1], c = t[2];
    const float *p = mesh.vertices[a], *q = mesh.vertices[b];
    const uint32_t m = put_vertex(&mesh, 0.5 * ((double)p[0] + (double)q[0]),
                                  0.5 * ((double)p[1] + (double)q[1]), 0.5 * ((double)p[2] + (double)q[2]));
    take_out(&mesh, 9000);
    put_triangle(&mesh, a, m, c);
    put_triangle(&mesh, m, b, c);
    r = check_ball("a T-junction", &mesh);
    assert_true(r.open_edges == 3 && r.holes_closed == 1);
    mesh_free(&mesh);
}

/* Corners that are not shared, as in an STL file. */
static void separate_corners(void **state) {
    (void)state;
    iso_triangles from = ball_mesh(), mesh = mesh_make();
    for (size_t i = 0; i < from.triangle_count; i++) {
        uint32_t v[3];
        for (int k = 0; k < 3; k++) {
            const float *p = from.vertices[from.triangles[i][k]];
            v[k] = put_vertex(&mesh, (double)p[0], (double)p[1], (double)p[2]);
        }
        put_triangle(&mesh, v[0], v[1], v[2]);
    }
    const iso_mesh_report r = check_ball("corners apart", &mesh);
    assert_true(r.open_edges == 0 && r.triangles == from.triangle_count - 2 * 160);
    mesh_free(&from);
    mesh_free(&mesh);
}

static double hollow(iso_vec3 p) {
    const double r = iso_vec3_length(iso_vec3_sub(p, CENTRE));
    return fmax(r - 20, 10 - r);
}

static void shells(void **state) {
    (void)state;
    iso_triangles mesh = ball_mesh();
    const size_t outer = mesh.triangle_count;
    put_ball(&mesh, CENTRE, 10);
    turn(&mesh, outer, outer);
    for (int i = 0; i < 2; i++) { /* a cavity, whichever way all of it faces */
        iso_closed_mesh *closed = close_mesh(&mesh, 0);
        iso_hgrid *grid = field_of(closed, 0.8);
        check_field("hollow", grid, hollow, 0.001);
        iso_hgrid_destroy(grid);
        iso_closed_mesh_destroy(closed);
        turn(&mesh, 0, mesh.triangle_count);
    }
    turn(&mesh, outer, outer); /* both outwards: all of it is solid */
    iso_closed_mesh *closed = close_mesh(&mesh, 0);
    iso_hgrid *grid = field_of(closed, 0.8);
    check_field("filled", grid, ball, 0.001);
    iso_hgrid_destroy(grid);
    iso_closed_mesh_destroy(closed);
    mesh_free(&mesh);
}

static double box_distance(iso_vec3 p, iso_vec3 lo, iso_vec3 hi) {
    const iso_vec3 q = {fmax(lo.x - p.x, p.x - hi.x), fmax(lo.y - p.y, p.y - hi.y),
                        fmax(lo.z - p.z, p.z - hi.z)};
    const iso_vec3 out = {fmax(q.x, 0), fmax(q.y, 0), fmax(q.z, 0)};
    return iso_vec3_length(out) + fmin(fmax(q.x, fmax(q.y, q.z)), 0);
}

static double two_balls(iso_vec3 p) {
    return fmin(ball(p), iso_vec3_length(iso_vec3_sub(p, iso_vec3_make(20, -4, 5))) - 15);
}

/* Boxes that share a plane and overlap in it. */
static const iso_vec3 BOX[4] = {{0, 0, 0}, {20, 20, 20}, {20, 5, 5}, {33, 15, 30}};

static double two_boxes(iso_vec3 p) {
    return fmin(box_distance(p, BOX[0], BOX[1]), box_distance(p, BOX[2], BOX[3]));
}

/* Surfaces inside the solid do not count. */
static void self_intersections(void **state) {
    (void)state;
    iso_triangles mesh = ball_mesh();
    put_ball(&mesh, iso_vec3_make(20, -4, 5), 15);
    iso_closed_mesh *closed = close_mesh(&mesh, 0);
    iso_hgrid *grid = field_of(closed, 0.5);
    check_field("two balls", grid, two_balls, 0.006);
    iso_hgrid_destroy(grid);
    iso_closed_mesh_destroy(closed);
    mesh.vertex_count = mesh.triangle_count = 0;
    put_box(&mesh, BOX[0], BOX[1]);
    put_box(&mesh, BOX[2], BOX[3]);
    closed = close_mesh(&mesh, 0);
    grid = field_of(closed, 0.5);
    check_field("two boxes", grid, two_boxes, 0.002);
    iso_hgrid_destroy(grid);
    iso_closed_mesh_destroy(closed);
    mesh_free(&mesh);
}

static double box(iso_vec3 p) {
    return box_distance(p, BOX[0], BOX[1]);
}

/* Boxes of few triangles: what is missing is large. */
static void boxes(void **state) {
    (void)state;
    for (size_t missing = 0; missing < 3; missing++) { /* none, a triangle, a side (in the box's face) */
        iso_triangles mesh = mesh_make();
        put_box(&mesh, BOX[0], BOX[1]);
        mesh.triangle_count -= missing;
        iso_closed_mesh *closed = close_mesh(&mesh, -1);
        const iso_mesh_report *r = iso_closed_mesh_report(closed);
        assert_true(fabs(r->volume - 8000) < 1e-6);
        assert_int_equal(r->holes_closed, missing == 1);
        assert_int_equal(r->loops_capped, missing == 2);
        iso_hgrid *grid = field_of(closed, 0.8);
        check_field("box", grid, box, 0);
        iso_hgrid_destroy(grid);
        iso_closed_mesh_destroy(closed);
        mesh_free(&mesh);
    }
}

/* ---- volumes that a border cuts */

/* Of the trilinear solid, from 4^3 samples a voxel, in mm3. */
static double grid_volume(const iso_grid *grid, double isovalue) {
    enum { FINE = 4 };
    const double sign = iso_grid_is_level_set(grid) ? -1 : 1;
    const int *dims = iso_grid_dims(grid);
    size_t inside = 0;
    for (int z = 0; z < FINE * (dims[2] - 1); z++)
        for (int y = 0; y < FINE * (dims[1] - 1); y++)
            for (int x = 0; x < FINE * (dims[0] - 1); x++) {
                const iso_vec3 p = {(x + 0.5) / FINE, (y + 0.5) / FINE, (z + 0.5) / FINE};
                inside += sign * (iso_grid_sample(grid, p) - isovalue) >= 0;
            }
    const iso_affine affine = iso_transform_affine(&grid->rgrid->transform);
    return (double)inside / (FINE * FINE * FINE) * fabs(affine.determinant);
}

static iso_triangles scene_mesh(const char *name, int size, const int crop[6], double *solid) {
    iso_grid made, *grid = &made;
    const iso_scene_opts opts = {.size = size, .dense = 1};
    double isovalue;
    assert_int_equal(iso_scene_create(name, &opts, grid, &isovalue, NULL), ISO_OK);
    const int lo[3] = {crop[0], crop[2], crop[4]}, hi[3] = {crop[1], crop[3], crop[5]};
    assert_int_equal(iso_rgrid_crop(grid->rgrid, lo, hi, NULL), ISO_OK);
    *solid = grid_volume(grid, isovalue);
    const iso_mesh_opts mesh_opts = {.isovalue = isovalue};
    iso_mesh_set *set;
    iso_weld weld;
    assert_int_equal(iso_mesh_set_create(grid, &mesh_opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    const iso_mesh_view view = iso_mesh_set_view(set);
    assert_int_equal(iso_mesh_weld(&view, NULL, &weld, NULL), ISO_OK);
    const iso_affine affine = iso_transform_affine(&view.transform);
    iso_triangles mesh = mesh_make();
    for (size_t i = 0; i < weld.vertex_count; i++) {
        const float *v = weld.vertices[i].position;
        const iso_vec3 p = iso_affine_point(&affine, iso_vec3_make(v[0], v[1], v[2]));
        put_vertex(&mesh, p.x, p.y, p.z);
    }
    for (size_t i = 0; i < weld.triangle_count; i++)
        put_triangle(&mesh, weld.triangles[i][0], weld.triangles[i][1], weld.triangles[i][2]);
    iso_weld_free(&weld);
    iso_mesh_set_destroy(set);
    iso_grid_destroy(grid);
    return mesh;
}

static void cut_volumes(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int size, crop[6];
    } cases[] = {
        {"gyroid", 48, {0, 47, 0, 47, 0, 47}}, {"gyroid", 48, {5, 40, 0, 30, 11, 47}},
        {"gyroid", 48, {0, 9, 0, 47, 13, 20}}, {"ct", 64, {0, 63, 0, 63, 20, 40}},
        {"ct", 64, {10, 40, 25, 60, 20, 60}},  {"head", 64, {10, 50, 0, 40, 5, 63}},
        {"torus", 48, {0, 47, 0, 30, 0, 47}},  {"sphere", 64, {0, 40, 0, 63, 20, 63}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double solid;
        iso_triangles mesh = scene_mesh(cases[i].name, cases[i].size, cases[i].crop, &solid);
        iso_closed_mesh *closed = close_mesh(&mesh, 0);
        const iso_mesh_report *r = iso_closed_mesh_report(closed);
        iso_hgrid *grid = field_of(closed, 0.5);
        const double field = solid_volume(grid);
        print_message("%s: %zu triangles, %zu open edges, %zu loops capped, %zu holes filled: %g mm3, mesh "
                      "%g, field %g\n",
                      cases[i].name, r->triangles, r->open_edges, r->loops_capped, r->holes_closed, solid,
                      r->volume, field);
        assert_true(r->open_edges > 0 && r->loops_capped > 0);
        assert_true(fabs(r->volume / solid - 1) < 0.02);
        assert_true(fabs(field / solid - 1) < 0.02);
        iso_hgrid_destroy(grid);
        iso_closed_mesh_destroy(closed);
        mesh_free(&mesh);
    }
}

/* What is left of a ball below a plane, which is the top of its mesh's box. */
static double cut_ball(iso_vec3 p) {
    const double r = ball(p), over = p.z - 9;
    if (r <= 0 || over <= 0) return fmax(r, over);
    const double rim = sqrt(20 * 20 - 4 * 4), x = hypot(p.x - 3, p.y + 4);
    return x <= rim ? over : hypot(x - rim, over);
}

/* The ball's upper part is flattened away: a rim is left that lies in the plane. */
static iso_triangles cut_ball_mesh(void) {
    iso_triangles mesh = ball_mesh();
    for (size_t i = 0; i < mesh.triangle_count;) {
        double lowest = INFINITY;
        for (int k = 0; k < 3; k++) lowest = fmin(lowest, (double)mesh.vertices[mesh.triangles[i][k]][2]);
        if (lowest >= 9)
            take_out(&mesh, i);
        else
            i++;
    }
    for (size_t i = 0; i < mesh.vertex_count; i++) {
        float *v = mesh.vertices[i];
        if (v[2] <= 9) continue;
        const double rim = sqrt(20 * 20 - 4 * 4), x = hypot((double)v[0] - 3, (double)v[1] + 4);
        v[0] = (float)(3 + ((double)v[0] - 3) * rim / x);
        v[1] = (float)(-4 + ((double)v[1] + 4) * rim / x);
        v[2] = 9;
    }
    return mesh;
}

static void caps(void **state) {
    (void)state;
    iso_triangles mesh = cut_ball_mesh();
    for (int i = 0; i < 2; i++) { /* inside out as well: only one side of the box is open */
        iso_closed_mesh *closed = close_mesh(&mesh, 0);
        const iso_mesh_report *r = iso_closed_mesh_report(closed);
        assert_true(r->loops_capped == 1 && r->holes_closed == 0 && (r->volume < 0) == (i == 1));
        iso_hgrid *grid = field_of(closed, 0.8);
        check_field("a cap", grid, cut_ball, 0.001);
        iso_hgrid_destroy(grid);
        iso_closed_mesh_destroy(closed);
        turn(&mesh, 0, mesh.triangle_count);
    }
    mesh_free(&mesh);
}

/* ---- what is refused */

/* A square sheet with waves, n x n quads. */
static iso_triangles sheet(uint32_t n, double height) {
    iso_triangles mesh = mesh_make();
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t k = 0; k <= n; k++) {
            double sine, cosine;
            iso_sincos(0.37 * i + 0.53 * k, &sine, &cosine);
            put_vertex(&mesh, i, k, height * (sine + 0.01 * i));
        }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++) {
            const uint32_t a = i * (n + 1) + k;
            put_quad(&mesh, a, a + n + 1, a + n + 2, a + 1);
        }
    return mesh;
}

static void sheets_are_refused(void **state) {
    (void)state;
    for (int high = 0; high < 2; high++) {
        iso_triangles mesh = sheet(40, high ? 3 : 0);
        refuse(&mesh, 0, ISO_ERR_FORMAT, "160 open edges");
        const size_t count = mesh.triangle_count;
        memcpy(mesh.triangles + count, mesh.triangles, count * sizeof *mesh.triangles);
        mesh.triangle_count *= 2;
        turn(&mesh, count, count); /* both sides of it enclose nothing */
        refuse(&mesh, 0, ISO_ERR_EMPTY, "encloses nothing");
        mesh_free(&mesh);
    }
    iso_triangles one = mesh_make();
    put_vertex(&one, 0, 0, 0);
    put_vertex(&one, 10, 0, 3);
    put_vertex(&one, 0, 10, 5);
    put_triangle(&one, 0, 1, 2);
    refuse(&one, 0, ISO_ERR_FORMAT, "3 open edges");
    one.triangles[0][2] = 1;
    refuse(&one, 0, ISO_ERR_EMPTY, "encloses nothing");
    one.triangle_count = 0;
    refuse(&one, 0, ISO_ERR_EMPTY, "no triangles");
    mesh_free(&one);
}

/* Without the triangles that are nearer to a point than so far, in mm. */
static iso_triangles ball_with_hole(double size) {
    const iso_vec3 from = iso_vec3_add(CENTRE, iso_vec3_make(12, 12, 10.58));
    iso_triangles mesh = ball_mesh();
    for (size_t i = 0; i < mesh.triangle_count;) {
        double nearest = INFINITY;
        for (int k = 0; k < 3; k++) {
            const float *v = mesh.vertices[mesh.triangles[i][k]];
            nearest = fmin(nearest, iso_vec3_length(iso_vec3_sub(iso_vec3_make(v[0], v[1], v[2]), from)));
        }
        if (nearest < size / 2)
            take_out(&mesh, i);
        else
            i++;
    }
    return mesh;
}

static void holes_have_sizes(void **state) {
    (void)state;
    iso_triangles mesh = ball_with_hole(1);
    iso_mesh_report r = check_ball("a small hole", &mesh);
    assert_true(r.holes_closed == 1 && r.largest_hole > 1 && r.largest_hole < 4);
    refuse(&mesh, -1, ISO_ERR_FORMAT, "open edges");
    mesh_free(&mesh);
    mesh = ball_with_hole(16);
    refuse(&mesh, 0, ISO_ERR_FORMAT, "open edges; the largest hole measures 23.8 mm");
    refuse(&mesh, 10, ISO_ERR_FORMAT, "up to 10 mm can be closed");
    iso_closed_mesh *closed = close_mesh(&mesh, 25);
    iso_hgrid *grid = field_of(closed, 0.8);
    const double height = 20 - sqrt(20 * 20 - 8 * 8), /* the ball less about its cap */
        wanted = 4 * ISO_PI / 3 * 8000 - ISO_PI * height * height * (60 - height) / 3;
    assert_true(fabs(solid_volume(grid) / wanted - 1) < 0.02);
    iso_hgrid_destroy(grid);
    iso_closed_mesh_destroy(closed);
    mesh_free(&mesh);
}

/* A plate of a hundredth of a voxel leaves nothing; that is said. */
static void thin_things_are_refused(void **state) {
    (void)state;
    iso_triangles mesh = mesh_make();
    iso_hgrid *grid;
    iso_error error = {0};
    put_box(&mesh, iso_vec3_make(0, 0, 0), iso_vec3_make(30, 30, 0.01));
    iso_closed_mesh *closed = close_mesh(&mesh, 0);
    const iso_sampling frame = {.voxel = 1, .margin = 5};
    assert_int_equal(iso_level_set_from_mesh("plate", closed, &frame, &grid, &error), ISO_ERR_EMPTY);
    assert_non_null(strstr(error.text, "9 mm3"));
    iso_closed_mesh_destroy(closed);
    mesh_free(&mesh);
}

/* Moves every vertex by up to `most` mm on each axis. */
static void shake(iso_triangles *mesh, double most) {
    uint32_t state = 12345;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        state = state * 1664525u + 1013904223u;
        mesh->vertices[i / 3][i % 3] += (float)(most * ((state >> 8) / 8388608.0 - 1));
    }
}

/* Compares the distances of the voxels of bricks around a place of the ball's surface with a search for the
 * nearest point of each. */
static void check_distances(const char *what, const iso_triangles *mesh, double voxel) {
    iso_closed_mesh *closed = close_mesh(mesh, 0);
    const double half = 24 * voxel, origin[3] = {-8.5 - half, -15.5 - half, -6.4 - half}, band = 3,
                 most = band * band * voxel * voxel;
    size_t near = 0;
    for (int i = 0; i < 27; i++) {
        const iso_brick_place brick = {origin, voxel, {16 * (i % 3), 16 * (i / 3 % 3), 16 * (i / 9)}};
        double squared[ISO_BRICK_VOXELS];
        iso_closed_mesh_measure(closed, &brick, band, squared);
        for (int v = 0; v < ISO_BRICK_VOXELS; v++) {
            iso_nearest nearest = {.squared = most};
            iso_closed_mesh_nearest(closed, iso_brick_voxel(&brick, v), &nearest);
            near += nearest.squared < most;
            if (fabs(squared[v] - nearest.squared) > 1e-12 * most)
                fail_msg("%s, voxels of %g mm: %.17g mm2 instead of %.17g", what, voxel, squared[v],
                         nearest.squared);
        }
    }
    if (near < 100) fail_msg("%s: %zu voxels are near", what, near);
    iso_closed_mesh_destroy(closed);
}

/* Distances from triangles, edges and corners: smooth, rough and sharp ones, triangles smaller and larger
 * than voxels, and holes that were filled. */
static void distances_of_bricks(void **state) {
    (void)state;
    static const double voxels[3] = {0.1, 0.4, 1.5};
    for (int i = 0; i < 3; i++) {
        iso_triangles mesh = ball_mesh();
        check_distances("ball", &mesh, voxels[i]);
        for (size_t k = 0; k < 30; k++) take_out(&mesh, 700 * k + 11);
        shake(&mesh, 0.01);
        check_distances("shaken ball", &mesh, voxels[i]);
        shake(&mesh, 0.3);
        check_distances("rough ball", &mesh, voxels[i]);
        mesh_free(&mesh);
        mesh = mesh_make();
        put_box(&mesh, iso_vec3_make(-8.11, -19.3, -15.03), iso_vec3_make(-7.2, 4.4, -6.1));
        put_box(&mesh, iso_vec3_make(-9, -20, -6.3), iso_vec3_make(20, -15, -6));
        check_distances("boxes", &mesh, voxels[i]);
        mesh_free(&mesh);
    }
}

/* The same bytes on any number of threads; cancelling leaves nothing. */
static int give_up(void *context, double fraction) {
    return fraction >= *(double *)context;
}

static void threads_and_cancelling(void **state) {
    (void)state;
    double solid;
    iso_triangles mesh = scene_mesh("gyroid", 48, (const int[6]){0, 47, 0, 47, 0, 30}, &solid);
    iso_closed_mesh *closed = close_mesh(&mesh, 0);
    iso_hgrid *wanted = field_of(closed, 0.7), *grid;
    for (int threads = 2; threads < 5; threads += 2) {
        iso_sampling frame = {.voxel = 0.7, .margin = 5};
        assert_int_equal(iso_pool_create(threads, &frame.pool, NULL), ISO_OK);
        assert_int_equal(iso_level_set_from_mesh("a mesh", closed, &frame, &grid, NULL), ISO_OK);
        assert_true(sculpt_same(wanted, grid));
        iso_hgrid_destroy(grid);
        for (double at = 0; at < 1; at += 0.3) {
            iso_error error = {0};
            const iso_progress progress = {.tell = give_up, .context = &at};
            frame.progress = &progress;
            assert_int_equal(iso_level_set_from_mesh("a mesh", closed, &frame, &grid, &error), ISO_ERR_IO);
            assert_non_null(strstr(error.text, "cancelled"));
        }
        iso_pool_destroy(frame.pool);
    }
    iso_hgrid_destroy(wanted);
    iso_closed_mesh_destroy(closed);
    mesh_free(&mesh);
}

/* Ways that meet corners and edges, as between voxels of the grid that a mesh was made of. */
static void changes(void **state) {
    (void)state;
    iso_triangles mesh = mesh_make();
    uint32_t v[6];
    for (int i = 0; i < 6; i++)
        v[i] = put_vertex(&mesh,
                          i == 0   ? 3
                          : i == 1 ? -3
                                   : 0,
                          i == 2   ? 3
                          : i == 3 ? -3
                                   : 0,
                          i == 4   ? 3
                          : i == 5 ? -3
                                   : 0);
    for (int i = 0; i < 8; i++) {
        const uint32_t x = v[i & 1], y = v[2 + (i >> 1 & 1)], z = v[4 + (i >> 2)];
        const bool odd = (i ^ i >> 1 ^ i >> 2) & 1;
        put_triangle(&mesh, x, odd ? z : y, odd ? y : z);
    }
    iso_closed_mesh *closed = close_mesh(&mesh, 0);
    const iso_vec3 ways[][2] = {{{2.5, 0, 0}, {3.5, 0, 0}},
                                {{0, 0, -3.25}, {0, 0, -2}},
                                {{1, 1, 0}, {2, 2, 0}},
                                {{0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}},
                                {{3.5, 0, 0}, {3.5, 0.5, 0}}};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        int change;
        assert_true(iso_closed_mesh_change(closed, ways[i][0], ways[i][1], &change));
        assert_int_equal(change, (int)lrint(iso_closed_mesh_winding(closed, ways[i][1]) -
                                            iso_closed_mesh_winding(closed, ways[i][0])));
    }
    iso_closed_mesh_destroy(closed);
    mesh_free(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(winding_numbers),
                                       cmocka_unit_test(changes),
                                       cmocka_unit_test(damaged_balls),
                                       cmocka_unit_test(separate_corners),
                                       cmocka_unit_test(shells),
                                       cmocka_unit_test(boxes),
                                       cmocka_unit_test(cut_volumes),
                                       cmocka_unit_test(caps),
                                       cmocka_unit_test(sheets_are_refused),
                                       cmocka_unit_test(holes_have_sizes),
                                       cmocka_unit_test(thin_things_are_refused),
                                       cmocka_unit_test(distances_of_bricks),
                                       cmocka_unit_test(threads_and_cancelling),
                                       cmocka_unit_test(self_intersections)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
