/* Meshes through the public interface as they are made for files and printing: smooth, with fewer triangles,
 * closed and hollow, each against the analytic ball. (That files have isorender's bytes is tested from
 * Python.) */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isopoint.h"

enum { SIDE = 40 };
static const double RADIUS = 14, VOXEL = 0.5;

typedef struct fixture {
    float values[SIDE * SIDE * SIDE];
    iso_volume *volume;
    iso_surface *surface;
} fixture;

/* A ball of 14 voxels in the middle, 7 mm. */
static int set_up(void **state) {
    static fixture f;
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                const double dx = x - 19.3, dy = y - 20.1, dz = z - 18.8;
                f.values[(z * SIDE + y) * SIDE + x] = (float)(RADIUS - sqrt(dx * dx + dy * dy + dz * dz));
            }
    const iso_transform transform = {.spacing = {VOXEL, VOXEL, VOXEL},
                                     .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const iso_lend_opts desc = {
        .dims = {SIDE, SIDE, SIDE}, .type = ISO_FLOAT32, .data = f.values, .transform = &transform};
    assert_int_equal(iso_volume_lend(&desc, &f.volume, NULL), ISO_OK);
    assert_int_equal(iso_surface_create(f.volume, NULL, &f.surface, NULL), ISO_OK);
    *state = &f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    iso_surface_destroy(f->surface);
    iso_volume_destroy(f->volume);
    return 0;
}

static double ball(double radius) {
    return 4.0 / 3 * 3.14159265358979 * radius * radius * radius;
}

/* The volume that a mesh encloses, mm3. */
static double volume_of(const iso_mesh *mesh) {
    double sum = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const float *a = mesh->positions[mesh->triangles[i][0]], *b = mesh->positions[mesh->triangles[i][1]],
                    *c = mesh->positions[mesh->triangles[i][2]];
        sum += a[0] * ((double)b[1] * c[2] - (double)b[2] * c[1]) +
               a[1] * ((double)b[2] * c[0] - (double)b[0] * c[2]) +
               a[2] * ((double)b[0] * c[1] - (double)b[1] * c[0]);
    }
    return sum / 6;
}

static int compare_edges(const void *a, const void *b) {
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return p < q ? -1 : p > q;
}

/* Whether each edge of the triangles has one in the other direction; *euler: vertices - edges + triangles. */
static bool is_closed(const iso_mesh *mesh, int64_t *euler) {
    const size_t count = 3 * mesh->triangle_count;
    uint64_t *edge = malloc(count * sizeof *edge), *back = malloc(count * sizeof *back);
    assert_true(edge && back);
    for (size_t i = 0; i < count; i++) {
        const uint64_t a = mesh->triangles[i / 3][i % 3], b = mesh->triangles[i / 3][(i + 1) % 3];
        edge[i] = a << 32 | b;
        back[i] = b << 32 | a;
    }
    qsort(edge, count, sizeof *edge, compare_edges);
    qsort(back, count, sizeof *back, compare_edges);
    const bool closed = memcmp(edge, back, count * sizeof *edge) == 0;
    *euler = (int64_t)mesh->vertex_count - (int64_t)(count / 2) + (int64_t)mesh->triangle_count;
    free(edge);
    free(back);
    return closed;
}

static iso_mesh made(fixture *f, const iso_surface_mesh_opts *opts) {
    iso_mesh mesh = {0};
    assert_int_equal(iso_surface_mesh_with(f->surface, opts, &mesh, NULL), ISO_OK);
    return mesh;
}

static void without_options_it_is_the_mesh(void **state) {
    iso_mesh plain = {0}, with = made(*state, &(iso_surface_mesh_opts){.closed = false});
    assert_int_equal(iso_surface_mesh(((fixture *)*state)->surface, &plain, NULL), ISO_OK);
    assert_int_equal(plain.vertex_count, with.vertex_count);
    assert_int_equal(plain.triangle_count, with.triangle_count);
    assert_memory_equal(plain.positions, with.positions, plain.vertex_count * sizeof *plain.positions);
    assert_memory_equal(plain.normals, with.normals, plain.vertex_count * sizeof *plain.normals);
    assert_memory_equal(plain.triangles, with.triangles, plain.triangle_count * sizeof *plain.triangles);
    iso_mesh_free(&plain);
    iso_mesh_free(&with);
}

static void fewer_triangles(void **state) {
    iso_mesh plain = made(*state, NULL), tenth = {0};
    const iso_surface_mesh_opts opts[2] = {{.keep = 0.1}, {.deviation = 0.05, .smooth = 5}};
    const iso_status can = iso_surface_mesh_with(((fixture *)*state)->surface, &opts[0], &tenth, NULL);
    iso_mesh_free(&tenth);
    for (int i = 0; i < 2 && can != ISO_ERR_BACKEND; i++) {
        iso_mesh fewer = made(*state, &opts[i]);
        int64_t euler;
        print_message("%zu of %zu triangles, volume %.4f of %.4f\n", fewer.triangle_count,
                      plain.triangle_count, volume_of(&fewer), ball(RADIUS * VOXEL));
        assert_true(fewer.triangle_count < 0.5 * (double)plain.triangle_count && fewer.triangle_count > 100);
        assert_true(i > 0 || fabs((double)fewer.triangle_count / (double)plain.triangle_count - 0.1) < 0.002);
        assert_true(is_closed(&fewer, &euler) && euler == 2);
        assert_true(fabs(volume_of(&fewer) / ball(RADIUS * VOXEL) - 1) < 0.02);
        iso_mesh_free(&fewer);
    }
    iso_mesh_free(&plain);
}

static void hollow_solids(void **state) {
    const double outer = RADIUS * VOXEL, wall = 1.5;
    for (int drains = 0; drains < 2; drains++) {
        iso_mesh mesh =
            made(*state, &(iso_surface_mesh_opts){.hollow = wall, .drain = drains ? 2 : 0, .up = {0, 3, 0}});
        int64_t euler;
        assert_true(is_closed(&mesh, &euler));
        /* (two balls, or one with a hollow that two holes lead into: a ring) */
        assert_int_equal(euler, drains ? 0 : 4);
        const double expected = ball(outer) - ball(outer - wall);
        print_message("hollow: volume %.2f of %.2f mm3\n", volume_of(&mesh), expected);
        assert_true(drains ? volume_of(&mesh) < 0.995 * expected
                           : fabs(volume_of(&mesh) / expected - 1) < 0.01);
        double between = 0; /* vertices that lie on neither ball, by their distance along y */
        for (size_t i = 0; i < mesh.vertex_count; i++) {
            const float *p = mesh.positions[i];
            const double d[3] = {p[0] - 19.3 * VOXEL, p[1] - 20.1 * VOXEL, p[2] - 18.8 * VOXEL};
            const double far = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            const double off = fmin(fabs(far - outer), fabs(far - outer + wall));
            if (off > 0.05) between = fmax(between, hypot(d[0], d[2]));
        }
        assert_true(drains ? between > 0.9 && between < 1.3 : between == 0); /* holes of radius 1 along y */
        iso_mesh_free(&mesh);
    }
}

static void closed_at_the_border(void **state) {
    fixture *f = *state;
    iso_surface *cut = NULL;
    iso_mesh_measures open;
    int64_t euler;
    assert_int_equal(iso_surface_create(f->volume, &(iso_surface_opts){.isovalue = -8}, &cut, NULL), ISO_OK);
    assert_int_equal(iso_surface_measure(cut, &open, NULL), ISO_OK);
    assert_true(open.open_edges > 0);
    iso_mesh mesh = {0};
    assert_int_equal(iso_surface_mesh_with(cut, &(iso_surface_mesh_opts){.closed = true}, &mesh, NULL),
                     ISO_OK);
    assert_true(is_closed(&mesh, &euler) && euler == 2);
    assert_int_equal(iso_surface_measure(cut, &open, NULL), ISO_OK); /* the surface stays as it is */
    assert_true(open.open_edges > 0);
    iso_mesh_free(&mesh);
    iso_surface_destroy(cut);
}

static void refusals(void **state) {
    fixture *f = *state;
    const iso_surface_mesh_opts bad[] = {{.smooth = -1},
                                         {.smooth = ISO_SMOOTH_MOST + 1},
                                         {.keep = 1},
                                         {.keep = -0.1},
                                         {.keep = NAN},
                                         {.deviation = -1},
                                         {.deviation = INFINITY},
                                         {.keep = 0.5, .deviation = 1},
                                         {.hollow = -2},
                                         {.drain = 1},
                                         {.hollow = 1, .drain = NAN},
                                         {.hollow = 1, .up = {NAN, 0, 0}}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        iso_mesh mesh = {0};
        iso_error error = {0};
        assert_int_equal(iso_surface_mesh_with(f->surface, &bad[i], &mesh, &error), ISO_ERR_USAGE);
        assert_true(error.text[0] && !strchr(error.text, '\n') && !mesh.positions);
    }
    iso_mesh mesh = {0};
    assert_int_equal(iso_surface_mesh_with(f->surface, &(iso_surface_mesh_opts){.hollow = 30}, &mesh, NULL),
                     ISO_ERR_EMPTY); /* nowhere so thick */
    assert_int_equal(iso_surface_write_mesh_with(f->surface, NULL, "a.png", NULL), ISO_ERR_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_options_it_is_the_mesh),
        cmocka_unit_test(fewer_triangles),
        cmocka_unit_test(hollow_solids),
        cmocka_unit_test(closed_at_the_border),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
