/* Colours of the files that sessions begin with: what a mesh, points and a level set with colours become as
 * paint, and that strokes, undo, edits and stroke files keep to it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "check_support.h"
#include "io/mesh/mesh_read.h"
#include "scene/painted.h"
#include "session_support.h"
#include "source/source.h"
#include "source/strokes.h"

static const double RADIUS = 9;

/* The colour of a place on the ball: linear in its coordinates, and so on the triangles of a mesh. */
static double wanted_color(iso_vec3 at, int k) {
    const double p[3] = {at.x, at.y, at.z};
    return 128 + 12 * p[k];
}

/* Vertices of a ball of rings, coloured. triangles: as a mesh, else with normals as points. */
static void write_ball(const char *path, bool triangles) {
    enum { RINGS = 60, SIDES = 120, VERTICES = (RINGS + 1) * SIDES };
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(
        file,
        "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n",
        VERTICES);
    if (!triangles) fprintf(file, "property float nx\nproperty float ny\nproperty float nz\n");
    fprintf(file, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
    if (triangles)
        fprintf(file, "element face %d\nproperty list uchar int vertex_indices\n", 2 * RINGS * SIDES);
    fprintf(file, "end_header\n");
    for (int ring = 0; ring <= RINGS; ring++)
        for (int side = 0; side < SIDES; side++) {
            const double down = ISO_PI * ring / RINGS, turn = 2 * ISO_PI * side / SIDES,
                         out = ring == 0 || ring == RINGS ? 0 : sin(down);
            const iso_vec3 n = {out * cos(turn), out * sin(turn), cos(down)}, p = iso_vec3_scale(n, RADIUS);
            fprintf(file, "%.6f %.6f %.6f", p.x, p.y, p.z);
            if (!triangles) fprintf(file, " %.6f %.6f %.6f", n.x, n.y, n.z);
            for (int k = 0; k < 3; k++) fprintf(file, " %d", (int)(wanted_color(p, k) + 0.5));
            fprintf(file, "\n");
        }
    for (int ring = 0; triangles && ring < RINGS; ring++)
        for (int side = 0; side < SIDES; side++) {
            const int a = ring * SIDES + side, b = ring * SIDES + (side + 1) % SIDES;
            fprintf(file, "3 %d %d %d\n3 %d %d %d\n", a, a + SIDES, b, b, a + SIDES, b + SIDES);
        }
    assert_int_equal(fclose(file), 0);
}

typedef struct opened {
    iso_journal_start start;
    iso_hgrid *grid;
    iso_cell_items paint;
} opened;

static opened open_file(const char *path, double voxel, iso_pool *pool) {
    opened o;
    iso_error error = {0};
    const iso_source source = {
        .path = path, .isovalue = NAN, .voxel = voxel, .pool = pool, .paint = &o.paint};
    if (iso_source_open(&source, &o.start, &o.grid, &error) != ISO_OK) fail_msg("%s", error.text);
    return o;
}

static void free_opened(opened *o) {
    iso_hgrid_destroy(o->grid);
    iso_cell_items_free(&o->paint);
}

/* Every voxel of the band has the colour of the nearest place of the ball, all others have none. */
static void check_colors(const char *what, const opened *o, double most) {
    const iso_affine affine = iso_transform_affine(&o->grid->transform);
    const iso_paint_view view = {&o->paint, {o->grid->cells[0], o->grid->cells[1], o->grid->cells[2]}};
    double worst = 0;
    size_t band = 0;
    for (int z = 0; z < o->grid->dims[2]; z++)
        for (int y = 0; y < o->grid->dims[1]; y++)
            for (int x = 0; x < o->grid->dims[0]; x++) {
                const uint32_t color = iso_paint_voxel(&view, (const int[3]){x, y, z});
                if (!(fabsf(iso_hgrid_at(o->grid, x, y, z)) < o->grid->band)) {
                    assert_int_equal(color, 0);
                    continue;
                }
                const iso_vec3 p = iso_affine_point(&affine, iso_vec3_make(x, y, z)),
                               on = iso_vec3_scale(iso_vec3_unit(p), RADIUS);
                assert_int_equal(iso_paint_amount(color), 255);
                for (int k = 0; k < 3; k++)
                    worst = fmax(worst, fabs((color >> 8 * k & 255) - wanted_color(on, k)));
                band++;
            }
    print_message("%s: %zu voxels, colours differ by %.1f of 255 at most\n", what, band, worst);
    assert_true(o->start.has_colors && band > 10000 && worst <= most);
}

static void colors_of_files_become_paint(void **state) {
    (void)state;
    const char *mesh = session_path("colors.ply"), *points = session_path("points.ply"),
               *vdb = session_path("colors.vdb");
    write_ball(mesh, true);
    write_ball(points, false);
    opened of_mesh = open_file(mesh, 0.4, NULL), of_points = open_file(points, 0.4, NULL);
    check_colors("mesh", &of_mesh, 2);
    check_colors("points", &of_points, 6);
    for (int k = 0; k < 2; k++) { /* the same with threads */
        iso_pool *pool;
        assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
        opened again = open_file(k ? points : mesh, 0.4, pool);
        const iso_cell_items *paint = k ? &of_points.paint : &of_mesh.paint;
        assert_int_equal(again.paint.used, paint->used);
        for (size_t i = 0; i < paint->cells; i++)
            if (paint->cell[i]) assert_memory_equal(paint->cell[i], again.paint.cell[i], paint->bytes);
        free_opened(&again);
        iso_pool_destroy(pool);
    }
    const iso_painted painted = iso_painted_make(&of_mesh.paint, of_mesh.grid, (iso_rgb){1, 2, 3});
    FILE *stream = fopen(vdb, "w+b");
    assert_non_null(stream);
    const iso_status written = iso_painted_put_vdb(stream, vdb, of_mesh.grid, &painted, NULL, NULL);
    assert_int_equal(fclose(stream), 0);
    if (written == ISO_OK) {
        opened same = open_file(vdb, 0, NULL), finer = open_file(vdb, 0.3, NULL);
        check_colors("level set", &same, 3);
        check_colors("level set, finer", &finer, 12); /* (outermost voxels lie beyond the coarser band) */
        free_opened(&same);
        free_opened(&finer);
    } else {
        assert_int_equal(written, ISO_ERR_UNSUPPORTED);
        print_message("level sets left out: there is no OpenVDB\n");
    }
    free_opened(&of_mesh);
    free_opened(&of_points);
    unlink(mesh);
    unlink(points);
    unlink(vdb);
}

static iso_session *begin(opened *o, const iso_session_opts *how) {
    iso_session_opts opts = *how;
    iso_session *session;
    iso_error error = {0};
    opts.paint = &o->paint;
    if (iso_session_create(o->grid, &o->start, &opts, &session, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_null(o->paint.cell);
    return session;
}

/* The field that a stroke file began with. */
static opened reopen(const char *strokes) {
    opened o;
    iso_journal_reader *reader;
    const iso_source how = {.paint = &o.paint};
    assert_int_equal(iso_journal_open(strokes, &o.start, &reader, NULL), ISO_OK);
    iso_journal_reader_free(reader);
    assert_int_equal(iso_source_reopen(strokes, &how, &o.start, &o.grid, NULL), ISO_OK);
    return o;
}

static void check_session(iso_session *session, const session_field *wanted) {
    assert_true(session_is(session, wanted));
    iso_session_destroy(session);
}

static void strokes_keep_to_the_colors(void **state) {
    (void)state;
    const char *mesh = session_path("strokes.ply"), *strokes = session_path("colors.strokes");
    char snapshot[600];
    iso_session_opts opts = {.journal = strokes, .checkpoint_strokes = 4};
    write_ball(mesh, true);
    session_remove_files(strokes);
    opened o = open_file(mesh, 0.6, NULL);
    iso_session *session = begin(&o, &opts);
    session_field first = session_field_of(session);
    assert_true(first.items.of[ISO_ITEM_PAINT].used > 0);
    uint32_t seed = 11;
    bool drawing = false;
    for (int i = 0; i < 160; i++) {
        const iso_event event = session_random_event(&seed, ISO_TOOL_TRIM_PLANE, &drawing);
        iso_session_play(session, &event, NULL, NULL);
    }
    if (drawing) assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    session_field last = session_field_of(session);
    assert_false(session_is(session, &first));
    iso_session_destroy(session);
    opts.resume = true;
    for (int damaged = 0; damaged < 2; damaged++) { /* from a snapshot, and from the beginning */
        o = reopen(strokes);
        check_session(begin(&o, &opts), &last);
        for (int k = 1; k < 100; k++) {
            snprintf(snapshot, sizeof snapshot, "%s.%d.snapshot", strokes, k);
            if (access(snapshot, W_OK) == 0) assert_int_equal(truncate(snapshot, 100), 0);
        }
    }
    iso_strokes played;
    assert_int_equal(iso_strokes_open(strokes, &(iso_source){.voxel = 0}, &played, NULL), ISO_OK);
    assert_int_equal(iso_strokes_finish(&played, NULL), ISO_OK);
    assert_true(session_is(played.session, &last));
    iso_stroke_list list = {.count = 0};
    assert_int_equal(iso_session_strokes(played.session, &list, NULL), ISO_OK);
    assert_true(list.count > 0);
    const iso_event mute = {
        .kind = ISO_EVENT_MUTE, .first = 1, .last = iso_stroke_at(&list, list.count - 1)->number};
    iso_stroke_list_free(&list);
    assert_int_equal(iso_session_edit(played.session, &mute, NULL), ISO_OK);
    assert_true(session_is(played.session, &first));
    assert_int_equal(iso_session_undo(played.session, NULL), ISO_OK);
    assert_true(session_is(played.session, &last));
    iso_strokes_close(&played);
    session_field_free(&first);
    session_field_free(&last);
    session_remove_files(strokes);
    unlink(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colors_of_files_become_paint),
        cmocka_unit_test(strokes_keep_to_the_colors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
