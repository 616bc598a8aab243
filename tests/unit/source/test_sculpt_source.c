/* sculpt source: what a session begins with is a distance field of what the file holds, and a journal finds
 * its file again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "grids/level_set.h"
#include "io/mesh/mesh_read.h"
#include "io/mesh/mesh_write.h"
#include "session_support.h"
#include "source/source.h"

static const iso_journal_start BALL = {
    .source = "ball", .voxel_size = 0.5, .dims = {96, 96, 96}, .origin = {-20, -24, -23}, .radius = 15};

static void make_ball(iso_hgrid **grid) {
    assert_int_equal(iso_session_solid(&BALL, grid, NULL), ISO_OK);
}

static iso_hgrid *open_source(const char *path, double isovalue, double voxel, iso_journal_start *start) {
    const iso_source source = {.path = path, .isovalue = isovalue, .voxel = voxel};
    iso_hgrid *grid;
    iso_error error = {0};
    if (iso_source_open(&source, start, &grid, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_non_null(strstr(start->source, strrchr(path, '/')));
    assert_true(start->voxel_size == grid->transform.spacing[0] && start->source_crc != 0);
    return grid;
}

/* The field against the ball's distances: 99 % of the band within a tenth of a voxel, all signs right. */
static void check_ball(const char *what, iso_hgrid *grid, double radius) {
    const iso_affine affine = iso_transform_affine(&grid->transform);
    const double voxel = grid->transform.spacing[0];
    size_t band = 0, good = 0;
    double worst = 0;
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++) {
                const iso_vec3 p = iso_affine_point(&affine, iso_vec3_make(x, y, z));
                const double wanted = (iso_vec3_length(p) - radius) / voxel;
                const double got = (double)iso_hgrid_at(grid, x, y, z);
                if (fabs(wanted) > 0.05 && (got < 0) != (wanted < 0))
                    fail_msg("%s: voxel (%d, %d, %d) is %g, wanted %g", what, x, y, z, got, wanted);
                if (wanted > 4 && got < 2.5)
                    fail_msg("%s: voxel (%d, %d, %d) is %g, far outside", what, x, y, z, got);
                if (fabs(wanted) >= 3) continue;
                band++;
                good += fabs(got - wanted) <= 0.1;
                worst = fmax(worst, fabs(got - wanted));
            }
    print_message("%s: %zu voxels in the band, %.2f %% within 0.1 voxel, worst %.3f\n", what, band,
                  100 * (double)good / (double)band, worst);
    assert_true(band > 1000 && (double)good >= 0.99 * (double)band);
    iso_hgrid_destroy(grid);
}

static bool have_openvdb(iso_hgrid *ball, const char *path) {
    iso_error error = {0};
    iso_status status = iso_level_set_write_vdb(path, ball, "surface", NULL, &error);
    if (status != ISO_OK && status != ISO_ERR_UNSUPPORTED) fail_msg("%s", error.text);
    if (status != ISO_OK) print_message("%s: left out\n", error.text);
    return status == ISO_OK;
}

static void level_sets(void **state) {
    (void)state;
    const char *path = session_path("source.vdb");
    iso_journal_start start;
    iso_hgrid *ball;
    make_ball(&ball);
    if (have_openvdb(ball, path)) {
        iso_hgrid *grid = open_source(path, NAN, 0, &start);
        assert_int_equal(grid->dims[0] % ISO_BRICK, 0);
        check_ball("level set as it is", grid, BALL.radius);
        check_ball("level set, finer", open_source(path, NAN, 0.31, &start), BALL.radius);
        check_ball("level set, coarser", open_source(path, NAN, 1, &start), BALL.radius);
    }
    unlink(path);
    iso_hgrid_destroy(ball);
}

/* A ball whose values are no distances, in boxes for voxels, and cut by the volume's border. */
static void volumes(void **state) {
    (void)state;
    const char *header = session_path("source.mha");
    enum { X = 90, Y = 70, Z = 50 };
    FILE *file = fopen(header, "wb");
    assert_non_null(file);
    fprintf(
        file,
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
        "Offset = -22 -21 -24.5\nElementSpacing = 0.5 0.6 1\nDimSize = %d %d %d\nElementType = MET_FLOAT\n"
        "ElementDataFile = LOCAL\n",
        X, Y, Z);
    for (int i = 0; i < X * Y * Z; i++) {
        const double x = -22 + 0.5 * (i % X), y = -21 + 0.6 * (i / X % Y), z = -24.5 + i / X / Y;
        const float value = (float)(1000 / (0.2 * (x * x + y * y + z * z) + 5)); /* 20 at a radius of 15 */
        fwrite(&value, sizeof value, 1, file);
    }
    fclose(file);
    iso_journal_start start;
    check_ball("volume", open_source(header, 20, 0, &start), 15);
    check_ball("volume, coarser", open_source(header, 20, 1, &start), 15);
    iso_hgrid *cut = open_source(header, 9, 1, &start); /* a radius of 22.9: beyond the border */
    for (int axis = 0; axis < 3; axis++) {              /* closed there */
        int p[3] = {cut->dims[0] / 2, cut->dims[1] / 2, cut->dims[2] / 2};
        assert_true(iso_hgrid_at(cut, p[0], p[1], p[2]) < 0);
        p[axis] = 0;
        assert_true(iso_hgrid_at(cut, p[0], p[1], p[2]) > 0);
    }
    iso_hgrid_destroy(cut);
    iso_hgrid *none;
    iso_error error = {0};
    const iso_source without = {.path = header, .isovalue = NAN}, empty = {.path = header, .isovalue = 1e6};
    assert_int_equal(iso_source_open(&without, &start, &none, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "--isovalue"));
    assert_int_equal(iso_source_open(&empty, &start, &none, &error), ISO_ERR_EMPTY);
    unlink(header);
}

/* The ball's mesh in a file. */
static void write_ball_mesh(iso_hgrid *ball, const char *path) {
    const iso_grid grid = {.hgrid = ball};
    const iso_mesh_opts opts = {0};
    iso_mesh_set *set;
    assert_int_equal(iso_mesh_set_create(&grid, &opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    const iso_mesh_view view = iso_mesh_set_view(set);
    assert_int_equal(iso_mesh_write(path, &view, "a ball", NULL), ISO_OK);
    iso_mesh_set_destroy(set);
}

static void meshes(void **state) {
    (void)state;
    static const char *const names[] = {"source.stl", "source.obj", "source.ply"};
    iso_hgrid *ball;
    make_ball(&ball);
    const char *vdb = session_path("source.vdb");
    const bool convert = have_openvdb(ball, vdb);
    unlink(vdb);
    for (int i = 0; i < 3; i++) {
        const char *path = session_path(names[i]);
        write_ball_mesh(ball, path);
        iso_triangles mesh;
        assert_int_equal(iso_mesh_read(path, NULL, &mesh, NULL), ISO_OK);
        assert_true(mesh.triangle_count > 10000);
        double volume = 0;
        for (size_t t = 0; t < mesh.triangle_count; t++) {
            iso_vec3 p[3];
            for (int k = 0; k < 3; k++) {
                const float *v = mesh.vertices[mesh.triangles[t][k]];
                p[k] = iso_vec3_make(v[0], v[1], v[2]);
            }
            volume += iso_vec3_dot(p[0], iso_vec3_cross(p[1], p[2])) / 6;
        }
        const double wanted = 4 * ISO_PI / 3 * 15 * 15 * 15;
        assert_true(fabs(volume / wanted - 1) < 0.005);
        iso_triangles_free(&mesh);
        iso_journal_start start;
        if (convert) {
            check_ball(names[i], open_source(path, NAN, 0.5, &start), BALL.radius);
            check_ball(names[i], open_source(path, NAN, 0, &start), BALL.radius);
        }
        unlink(path);
    }
    iso_hgrid_destroy(ball);
}

static void spill_text(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void odd_meshes(void **state) {
    (void)state;
    static const struct {
        const char *name, *text, *word;
        iso_status status;
        size_t triangles;
    } cases[] = {
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1/1 2//2 -2/3/4 4\n", NULL, ISO_OK, 2},
        {"a.obj", "# nothing\nv 0 0 0\n", "no triangles", ISO_ERR_EMPTY, 0},
        {"a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n", "vertex 2 of 2", ISO_ERR_FORMAT, 0},
        {"a.obj", "v 0 0 0\nf 1 2 -9\n", "line 2", ISO_ERR_FORMAT, 0},
        {"a.obj", "v 0 zero 0\n", "line 1", ISO_ERR_FORMAT, 0},
        {"a.obj", "v 0 nan 0\n", "not finite", ISO_ERR_FORMAT, 0},
        {"a.stl",
         "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nVERTEX 0 1e0 0\nendloop\n"
         "endfacet\nendsolid x\n",
         NULL, ISO_OK, 1},
        {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0\nendloop\nendfacet\n",
         "facet 1", ISO_ERR_FORMAT, 0},
        {"a.stl", "what", "not an STL", ISO_ERR_FORMAT, 0},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
         "4 0 1 2 3\n",
         NULL, ISO_OK, 2},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n3 0 1 -1\n",
         "corner -1", ISO_ERR_FORMAT, 0},
        {"a.ply", /* faces without properties have no bytes: the number would be counted for years */
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 14554249058164\nend_header\n0 0 0\n",
         "no triangles", ISO_ERR_EMPTY, 0},
        {"a.step", "", "are read from", ISO_ERR_UNSUPPORTED, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *path = session_path(cases[i].name);
        iso_triangles mesh;
        iso_error error = {0};
        spill_text(path, cases[i].text);
        iso_status status = iso_mesh_read(path, NULL, &mesh, &error);
        if (status != cases[i].status || (cases[i].word && !strstr(error.text, cases[i].word)))
            fail_msg("case %zu: status %d, '%s'", i, (int)status, error.text);
        if (status == ISO_OK) {
            assert_int_equal(mesh.triangle_count, cases[i].triangles);
            iso_triangles_free(&mesh);
        }
        unlink(path);
    }
    iso_triangles none;
    assert_int_equal(iso_mesh_read("/no/such.stl", NULL, &none, NULL), ISO_ERR_IO);
}

/* An open mesh encloses nothing; a file that moved is found beside the strokes, one that changed is not
 * taken.
 */
static void files_are_found_again(void **state) {
    (void)state;
    iso_hgrid *ball, *grid;
    make_ball(&ball);
    const char *path = session_path("found.vdb"), *folder = session_path("found");
    char moved[600], strokes[600];
    iso_error error = {0};
    if (!have_openvdb(ball, path)) {
        iso_hgrid_destroy(ball);
        return;
    }
    mkdir(folder, 0777);
    snprintf(moved, sizeof moved, "%s%s", folder, strrchr(path, '/'));
    snprintf(strokes, sizeof strokes, "%s/a.strokes", folder);
    const iso_source how = {0};
    iso_journal_start start, again;
    iso_hgrid *first = open_source(path, NAN, 0, &start);
    again = start;
    assert_int_equal(iso_source_reopen(strokes, &how, &again, &grid, NULL), ISO_OK);
    assert_true(sculpt_same(first, grid));
    iso_hgrid_destroy(grid);
    assert_int_equal(rename(path, moved), 0);
    again = start;
    assert_int_equal(iso_source_reopen(strokes, &how, &again, &grid, NULL), ISO_OK);
    assert_true(sculpt_same(first, grid));
    iso_hgrid_destroy(grid);
    FILE *file = fopen(moved, "ab");
    assert_non_null(file);
    fputc('x', file);
    fclose(file);
    again = start;
    assert_int_equal(iso_source_reopen(strokes, &how, &again, &grid, &error), ISO_ERR_FORMAT);
    assert_non_null(strstr(error.text, "is not what it was"));
    unlink(moved);
    assert_int_equal(iso_source_reopen(strokes, &how, &again, &grid, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "found.vdb"));
    char open_mesh[600];
    snprintf(open_mesh, sizeof open_mesh, "%s/open.obj", folder);
    spill_text(open_mesh, "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n");
    const iso_source source = {.path = open_mesh, .isovalue = NAN, .voxel = 0.5};
    assert_int_equal(iso_source_open(&source, &again, &grid, &error), ISO_ERR_FORMAT);
    unlink(open_mesh);
    rmdir(folder);
    iso_hgrid_destroy(first);
    iso_hgrid_destroy(ball);
}

/* What was said about reading a file is in what a journal keeps, and a replay reads it in the same way. */
static void readings_are_kept(void **state) {
    (void)state;
    const char *path = session_path("headerless.raw");
    enum { X = 48, Y = 40, Z = 44, SKIPPED = 7 };
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    for (int i = 0; i < SKIPPED; i++) fputc(i, file);
    for (int i = 0; i < X * Y * Z; i++) {
        const double x = i % X - 24, y = i / X % Y - 20, z = i / X / Y - 22;
        const bool other = i % X == 2 && i / X % Y == 2; /* a rod beside it, which is dropped */
        /* 125 at a radius of 10 voxels */
        fputc(other ? 200 : (int)(250 / (1 + 0.01 * (x * x + y * y + z * z))), file);
    }
    fclose(file);
    char text[ISO_JOURNAL_TEXT];
    iso_input input = {.spacing = {0.5, 0.5, 0.5}, .max_memory = 1 << 24, .largest = 1, .min_size = 2.5};
    assert_int_equal(iso_input_apply_raw(&input, "48x40x44:uint8::7", NULL), ISO_OK);
    assert_int_equal(iso_input_apply_crop_mm(&input, "0,100,0,100,0,11.1", NULL), ISO_OK);
    assert_int_equal(iso_input_write(&input, text, sizeof text, NULL), ISO_OK);
    assert_string_equal(text, "raw=48x40x44:uint8:little:7\nspacing=0.5,0.5,0.5\ncrop-mm=0,100,0,100,0,11.1\n"
                              "largest=1\nmin-size=2.5\n");
    const iso_source source = {.path = path, .isovalue = 125, .input = &input}, how = {0};
    iso_journal_start start, again;
    iso_hgrid *first, *grid;
    iso_error error = {0};
    if (iso_source_open(&source, &start, &first, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_string_equal(start.reading, text);
    const int rod[3] = {2 + 32, 2 + 36, 36};
    assert_true(iso_hgrid_at(first, rod[0], rod[1], rod[2]) == first->band);
    assert_true(first->dims[0] == 48 + 64 && first->dims[2] == 96); /* 23 voxels, 32 around, in bricks */
    again = start;
    if (iso_source_reopen("a.strokes", &how, &again, &grid, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_true(sculpt_same(first, grid));
    iso_hgrid_destroy(grid);
    /* viewed before it is sculpted, as in a window */
    iso_source_volume *volume;
    assert_int_equal(iso_source_volume_read(path, &input, NULL, NULL, &volume, NULL), ISO_OK);
    const iso_source seen = {.path = path, .isovalue = 125, .volume = volume};
    assert_int_equal(iso_source_open(&seen, &again, &grid, NULL), ISO_OK);
    assert_string_equal(again.reading, text);
    assert_true(sculpt_same(first, grid));
    iso_hgrid_destroy(grid);
    iso_source_volume_free(volume);
    static const char *const bad[] = {
        "raw=48x40x44:uint9::7\n", "output=x\n",  "raw",           "crop=0,1,0,1,0,1\ncrop-mm=0,1,0,1,0,1\n",
        "component=-1\n",          "largest=0\n", "min-size=-1\n", "max-memory=1\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        again = start;
        strcpy(again.reading, bad[i]);
        assert_int_equal(iso_source_reopen("a.strokes", &how, &again, &grid, &error), ISO_ERR_FORMAT);
        assert_non_null(strstr(error.text, "a.strokes: how its source is read: "));
    }
    const iso_input broken = {.grid = "a\nraw=1x1x1:uint8"};
    assert_int_equal(iso_input_write(&broken, text, sizeof text, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_input_write(&input, text, 60, NULL), ISO_ERR_USAGE);
    iso_hgrid_destroy(first);
    unlink(path);
}

/* In a journal of version 1 a level set's isovalue is in voxels: it still gives the field that was sculpted.
 */
static void old_journals_keep_their_isovalues(void **state) {
    (void)state;
    iso_hgrid *ball, *grid;
    make_ball(&ball);
    const char *path = session_path("old.vdb");
    if (!have_openvdb(ball, path)) {
        iso_hgrid_destroy(ball);
        return;
    }
    const iso_source how = {0};
    iso_journal_start start, again;
    iso_hgrid *first = open_source(path, 0.5, 0, &start); /* mm: a voxel */
    again = start;
    again.isovalue = 1;
    again.voxel_isovalue = true;
    assert_int_equal(iso_source_reopen("a.strokes", &how, &again, &grid, NULL), ISO_OK);
    assert_true(sculpt_same(first, grid));
    iso_hgrid_destroy(grid);
    check_ball("level set, 0.5 mm outside", first, 15.5);
    unlink(path);
    iso_hgrid_destroy(ball);
}

/* ---- the public header */

static void draw_stroke(iso_session *session, iso_vec3 at) {
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 4, .strength = 1, .spacing = 0.25};
    const iso_sample sample = {.position = at, .normal = {1, 0, 0}, .pressure = 1};
    iso_error error = {0};
    if (iso_session_begin(session, &brush, &sample, NULL, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
}

/* A session that begins with the file and has one stroke, in a stroke file. */
static iso_session *recorded_session(const iso_source *source, const char *strokes, iso_vec3 at) {
    iso_journal_start start;
    iso_hgrid *grid;
    iso_session *session;
    iso_error error = {0};
    session_remove_files(strokes);
    const iso_session_opts opts = {.journal = strokes};
    if (iso_source_open(source, &start, &grid, &error) != ISO_OK) fail_msg("%s", error.text);
    if (iso_session_create(grid, &start, &opts, &session, &error) != ISO_OK) fail_msg("%s", error.text);
    draw_stroke(session, at);
    return session;
}

/* A copy of a stroke file: the file itself is locked as long as its session is open. */
static const char *copy_of(const char *strokes) {
    static char copy[600];
    char bytes[4096];
    snprintf(copy, sizeof copy, "%s.copy.strokes", strokes);
    FILE *from = fopen(strokes, "rb"), *to = fopen(copy, "wb");
    assert_true(from && to);
    for (size_t count; (count = fread(bytes, 1, sizeof bytes, from)) > 0;)
        assert_int_equal(fwrite(bytes, 1, count, to), count);
    fclose(from);
    assert_int_equal(fclose(to), 0);
    return copy;
}

/* iso_sculpt_replay and iso_sculpt_resume give the field of the session, whatever file it began with. */
static void check_public(const iso_source *source, iso_vec3 at) {
    const char *strokes = session_path("public.strokes");
    iso_session *session = recorded_session(source, strokes, at);
    iso_sculpt *again;
    iso_error error = {0};
    for (int resumed = 0; resumed < 2; resumed++) {
        iso_status status = resumed ? iso_sculpt_resume(copy_of(strokes), NULL, &again, &error)
                                    : iso_sculpt_replay(strokes, NULL, &again, &error);
        if (status != ISO_OK) fail_msg("%s", error.text);
        assert_int_equal(iso_sculpt_undo_count(again), 1);
        assert_true(sculpt_same(iso_session_grid(session), iso_sculpt_volume(again)->grid.hgrid));
        iso_sculpt_destroy(again);
    }
    FILE *file = fopen(source->path, "ab");
    assert_non_null(file);
    fputc('\n', file);
    fclose(file);
    assert_int_equal(iso_sculpt_replay(strokes, NULL, &again, &error), ISO_ERR_FORMAT);
    assert_non_null(strstr(error.text, "is not what it was"));
    unlink(source->path);
    assert_int_equal(iso_sculpt_replay(strokes, NULL, &again, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, strrchr(source->path, '/') + 1));
    iso_session_destroy(session);
    session_remove_files(copy_of(strokes));
    session_remove_files(strokes);
}

static void the_public_header_replays_files(void **state) {
    (void)state;
    const char *mesh = session_path("begun.obj"), *volume = session_path("begun.raw"),
               *level_set = session_path("begun.vdb");
    spill_text(mesh, "v 10 0 0\nv -10 0 0\nv 0 10 0\nv 0 -10 0\nv 0 0 10\nv 0 0 -10\n"
                     "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n");
    const iso_source of_mesh = {.path = mesh, .isovalue = NAN, .voxel = 0.5};
    check_public(&of_mesh, iso_vec3_make(10, 0, 0));
    enum { SIDE = 40 };
    FILE *file = fopen(volume, "wb");
    assert_non_null(file);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const double x = i % SIDE - 20, y = i / SIDE % SIDE - 20, z = i / SIDE / SIDE - 20;
        fputc((int)(250 / (1 + 0.01 * (x * x + y * y + z * z))), file); /* 125 at a radius of 10 voxels */
    }
    fclose(file);
    iso_input input = {.spacing = {0.5, 0.5, 0.5}};
    assert_int_equal(iso_input_apply_raw(&input, "40x40x40:uint8", NULL), ISO_OK);
    const iso_source of_volume = {.path = volume, .isovalue = 125, .input = &input};
    check_public(&of_volume, iso_vec3_make(15, 10, 10));
    iso_hgrid *ball;
    make_ball(&ball);
    if (have_openvdb(ball, level_set)) {
        const iso_source of_level_set = {.path = level_set, .isovalue = NAN};
        check_public(&of_level_set, iso_vec3_make(15, 0, 0));
    }
    iso_hgrid_destroy(ball);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(level_sets),
                                       cmocka_unit_test(volumes),
                                       cmocka_unit_test(meshes),
                                       cmocka_unit_test(odd_meshes),
                                       cmocka_unit_test(files_are_found_again),
                                       cmocka_unit_test(readings_are_kept),
                                       cmocka_unit_test(old_journals_keep_their_isovalues),
                                       cmocka_unit_test(the_public_header_replays_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
