/* The gl engine's buffers and what it draws of them: only changed spans are uploaded, strips are the
 * triangles, and nothing of what is left out was to be seen. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "extract_support.h"
#include "gl_support.h"
#include "grids/scenes/scenes.h"
#include "render/gl/surface.h"
#include "render/raster/triangle_strips.h"

static iso_gl_engine *make_engine(iso_gl_context *context) {
    iso_gl_engine *engine;
    assert_int_equal(iso_gl_engine_create(context, &engine, NULL), ISO_OK);
    return engine;
}

static iso_gbuffer draw(iso_gl_engine *engine, const iso_gl_surface *surface, const iso_view *view) {
    iso_gbuffer g = gl_gbuffer(view);
    iso_error error = {ISO_OK, ""};
    const iso_gl_draw_opts opts = {.view = view, .surfaces = &surface, .surface_count = 1};
    if (iso_gl_draw(engine, &opts, &g, &error) != ISO_OK) fail_msg("%s", error.text);
    return g;
}

static size_t pixels_that_differ(const iso_gbuffer *a, const iso_gbuffer *b) {
    size_t count = (size_t)a->width * (size_t)a->height, differ = 0;
    for (size_t i = 0; i < count; i++) {
        bool same = a->surface[i] == b->surface[i] && memcmp(&a->depth[i], &b->depth[i], sizeof(float)) == 0;
        for (int axis = 0; axis < 3; axis++)
            same = same && memcmp(&a->normal[axis][i], &b->normal[axis][i], sizeof(float)) == 0;
        differ += !same;
    }
    return differ;
}

static size_t covered(const iso_gbuffer *g) {
    size_t count = 0;
    for (size_t i = 0; i < (size_t)g->width * (size_t)g->height; i++)
        count += g->surface[i] != ISO_SURFACE_NONE;
    return count;
}

static iso_mesh_set *make_mesh(const iso_grid *grid, double isovalue) {
    iso_mesh_set *set;
    const iso_mesh_opts opts = {.isovalue = isovalue};
    assert_int_equal(iso_mesh_set_create(grid, &opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
    return set;
}

static iso_mesh_set *scene_mesh(const char *scene, int size, bool dense, iso_grid *grid) {
    double isovalue;
    const iso_scene_opts opts = {.size = size, .dense = dense};
    assert_int_equal(iso_scene_create(scene, &opts, grid, &isovalue, NULL), ISO_OK);
    return make_mesh(grid, isovalue);
}

/* ---- strips */

typedef uint16_t triangle[3];

/* The same corners in the same order, the smallest first. */
static void turn(const uint16_t in[3], uint16_t out[3]) {
    int first = 0;
    for (int k = 1; k < 3; k++)
        if (in[k] < in[first]) first = k;
    for (int k = 0; k < 3; k++) out[k] = in[(first + k) % 3];
}

static int compare_triangles(const void *a, const void *b) {
    return memcmp(a, b, sizeof(triangle));
}

static size_t unstrip(const uint16_t *indices, size_t count, triangle *out) {
    size_t made = 0, length = 0;
    for (size_t i = 0; i < count; i++) {
        length = indices[i] == ISO_TRIANGLE_STRIP_RESTART ? 0 : length + 1;
        if (length < 3) continue;
        bool odd = length % 2 == 0;
        const uint16_t corners[3] = {indices[i - 2], indices[odd ? i : i - 1], indices[odd ? i - 1 : i]};
        turn(corners, out[made++]);
    }
    return made;
}

/* Index count of all spans. */
static size_t check_strips(const iso_mesh_view *mesh) {
    static triangle wanted[5 * ISO_BRICK_VOXELS], got[5 * ISO_BRICK_VOXELS];
    iso_triangle_strips strips = {0};
    size_t total = 0;
    for (size_t s = 0; s < mesh->span_count; s++) {
        const iso_mesh_span *span = &mesh->spans[s];
        size_t count;
        assert_int_equal(iso_triangle_strips_make(&strips, mesh, span, &count, NULL), ISO_OK);
        assert_true(count <= (size_t)ISO_TRIANGLE_STRIP_ROOM * span->triangle_count);
        assert_int_equal(unstrip(iso_triangle_strips_indices(&strips), count, got), span->triangle_count);
        for (uint32_t t = 0; t < span->triangle_count; t++)
            turn(mesh->triangles[span->first_triangle + t], wanted[t]);
        qsort(wanted, span->triangle_count, sizeof *wanted, compare_triangles);
        qsort(got, span->triangle_count, sizeof *got, compare_triangles);
        assert_memory_equal(wanted, got, span->triangle_count * sizeof *wanted);
        total += count;
    }
    iso_triangle_strips_free(&strips);
    return total;
}

static void strips_are_the_triangles(void **state) {
    (void)state;
    static const char *const scenes[] = {"sphere", "cube", "gyroid", "ct", "head"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        iso_grid grid;
        iso_mesh_set *set = scene_mesh(scenes[i], 96, false, &grid);
        iso_mesh_view mesh = iso_mesh_set_view(set);
        double ratio = (double)check_strips(&mesh) / (double)(3 * iso_mesh_view_triangle_count(&mesh));
        print_message("%s: %.1f %% of the indices\n", scenes[i], 100 * ratio);
        assert_true(ratio < 0.6); /* 2003, table 2: 45 to 52 % */
        iso_mesh_set_destroy(set);
        iso_grid_destroy(&grid);
    }
    test_random random = {11};
    for (int round = 0; round < 30; round++) { /* all that Marching Cubes can give */
        int dims[3];
        test_random_dims(&random, 2, 40, dims);
        iso_grid grid = test_rgrid(dims, ISO_UINT8);
        test_fill(&grid, (test_pattern)(round % 3), &random);
        iso_mesh_set *set = make_mesh(&grid, 100);
        iso_mesh_view mesh = iso_mesh_set_view(set);
        check_strips(&mesh);
        iso_mesh_set_destroy(set);
        iso_grid_destroy(&grid);
    }
}

static iso_view view_of(const iso_mesh_view *mesh, int side, bool orthographic) {
    iso_affine affine = iso_transform_affine(&mesh->transform);
    iso_box index = iso_mesh_view_bounds(mesh), box = iso_box_transform(&index, &affine);
    return gl_side_view(&box, side, orthographic, 220, 200);
}

static void strips_draw_the_same_picture(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    iso_grid grid;
    iso_mesh_set *set = scene_mesh("ct", 64, false, &grid);
    iso_mesh_view mesh = iso_mesh_set_view(set);
    for (int c = 0; c < contexts.count; c++) {
        iso_gl_engine *engine = make_engine(contexts.context[c]);
        iso_gl_surface *indexed, *stripped;
        assert_int_equal(iso_gl_upload_mesh(engine, &mesh, &indexed, NULL), ISO_OK);
        assert_int_equal(iso_gl_upload_strips(engine, &mesh, &stripped, NULL), ISO_OK);
        iso_gl_surface_stats a = iso_gl_surface_measure(indexed), b = iso_gl_surface_measure(stripped);
        assert_int_equal(a.triangles, iso_mesh_view_triangle_count(&mesh));
        assert_int_equal(a.indices, 3 * a.triangles);
        assert_int_equal(b.triangles, a.triangles);
        assert_int_equal(b.indices, check_strips(&mesh));
        for (int side = 0; side < GL_SIDES; side++) {
            iso_view view = view_of(&mesh, side, side % 2);
            iso_gbuffer first = draw(engine, indexed, &view), second = draw(engine, stripped, &view);
            gl_difference d = gl_compare(&view, &first, &second);
            size_t differ = pixels_that_differ(&first, &second);
            print_message("side %d: %zu pixels in other bits, %.1f dB\n", side, differ, d.psnr);
            /* interpolation rounds by the order of the corners: a colour here and there is off by one */
            assert_true(d.differ == 0 && d.psnr > 90);
            iso_gbuffer_free(&first);
            iso_gbuffer_free(&second);
        }
        iso_gl_surface_destroy(indexed);
        iso_gl_surface_destroy(stripped);
        iso_gl_engine_destroy(engine);
    }
    iso_mesh_set_destroy(set);
    iso_grid_destroy(&grid);
    gl_contexts_close(&contexts);
}

/* ---- what faces away */

/* Of each span: its vertices and the planes of its triangles, by other means. */
static void check_bounds(const iso_mesh_view *mesh) {
    for (size_t s = 0; s < mesh->span_count; s++) {
        const iso_mesh_span *span = &mesh->spans[s];
        const iso_point_bounds *b = &mesh->bounds[s];
        const iso_surfel *vertices = mesh->vertices + span->first_vertex;
        for (uint32_t i = 0; i < span->vertex_count; i++)
            for (int k = 0; k < 3; k++)
                assert_true(vertices[i].position[k] >= b->lo[k] && vertices[i].position[k] <= b->hi[k]);
        for (uint32_t t = 0; t < span->triangle_count; t++) {
            iso_vec3 p[3];
            for (int k = 0; k < 3; k++) {
                const float *q = vertices[mesh->triangles[span->first_triangle + t][k]].position;
                p[k] = iso_vec3_make(q[0], q[1], q[2]);
            }
            iso_vec3 n = iso_vec3_cross(iso_vec3_sub(p[1], p[0]), iso_vec3_sub(p[2], p[0]));
            double size = fabs(n.x) + fabs(n.y) + fabs(n.z);
            if (size < 1e-9) continue;
            const double normal[3] = {n.x / size, n.y / size, n.z / size};
            for (int k = 0; k < 3; k++)
                assert_true(normal[k] >= b->normal_lo[k] - 1e-6 && normal[k] <= b->normal_hi[k] + 1e-6);
        }
    }
}

/* Spans left out. */
static size_t check_hidden(iso_gl_engine *engine, const iso_gl_surface *surface, const iso_view *view,
                           const char *name) {
    iso_gbuffer culled = draw(engine, surface, view);
    size_t back_facing = engine->back_facing;
    engine->keep_back_facing = true;
    iso_gbuffer all = draw(engine, surface, view);
    engine->keep_back_facing = false;
    assert_int_equal(engine->back_facing, 0);
    size_t differ = pixels_that_differ(&culled, &all);
    if (differ) fail_msg("%s: %zu of %zu pixels differ", name, differ, covered(&all));
    iso_gbuffer_free(&culled);
    iso_gbuffer_free(&all);
    return back_facing;
}

/* Twelve views from outside and one from the middle; spans left out. */
static size_t check_views(iso_gl_engine *engine, const iso_mesh_view *mesh, const char *name) {
    iso_gl_surface *surface;
    assert_int_equal(iso_gl_upload_mesh(engine, mesh, &surface, NULL), ISO_OK);
    size_t back_facing = 0;
    for (int side = 0; side < GL_SIDES; side++)
        for (int orthographic = 0; orthographic < 2; orthographic++) {
            iso_view view = view_of(mesh, side, orthographic);
            back_facing += check_hidden(engine, surface, &view, name);
        }
    /* where the eye is inside, what faces away is what is seen */
    iso_view inside = view_of(mesh, 0, false);
    iso_box index = iso_mesh_view_bounds(mesh);
    iso_affine affine = iso_transform_affine(&mesh->transform);
    inside.eye = iso_affine_point(&affine, iso_vec3_scale(iso_vec3_add(index.lo, index.hi), 0.5));
    assert_int_equal(check_hidden(engine, surface, &inside, name), 0);
    print_message("%s: %zu spans left out in 12 views of %zu\n", name, back_facing, mesh->span_count);
    iso_gl_surface_destroy(surface);
    return back_facing;
}

/* Returns whether it is closed. */
static bool check_left_out(iso_gl_engine *engine, iso_mesh_set *set, const char *name) {
    iso_mesh_view unknown = iso_mesh_set_view(set);
    assert_true(!unknown.bounds && !unknown.closed);
    assert_int_equal(iso_mesh_set_bound(set, NULL), ISO_OK);
    iso_mesh_view mesh = iso_mesh_set_view(set);
    check_bounds(&mesh);
    size_t back_facing = check_views(engine, &mesh, name);
    assert_true((back_facing > 0) == mesh.closed);
    return mesh.closed;
}

static void nothing_that_is_seen_is_left_out(void **state) {
    (void)state;
    static const struct {
        const char *scene;
        int size, dense, closed;
    } cases[] = {{"sphere", 96, 0, 1},
                 {"torus", 96, 1, 1},
                 {"cube", 80, 1, 1},
                 {"head", 96, 0, 1},
                 {"gyroid", 64, 1, 0}};
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    iso_gl_engine *engine = make_engine(contexts.context[0]);
    iso_grid grid;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_mesh_set *set = scene_mesh(cases[i].scene, cases[i].size, cases[i].dense, &grid);
        assert_int_equal(check_left_out(engine, set, cases[i].scene), cases[i].closed);
        iso_mesh_set_destroy(set);
        iso_grid_destroy(&grid);
    }
    /* bowls: balls that the volume's border cuts open */
    for (int axis = 0; axis < 3; axis++)
        for (int end = 0; end < 2; end++) {
            double centre[3] = {40, 40, 40};
            centre[axis] = end ? 77 : 2;
            grid = test_ball_grid(80, iso_vec3_make(centre[0], centre[1], centre[2]), 33, axis == 1);
            iso_mesh_set *set = make_mesh(&grid, 0);
            assert_false(check_left_out(engine, set, "bowl"));
            iso_mesh_set_destroy(set);
            iso_grid_destroy(&grid);
        }
    iso_gl_engine_destroy(engine);
    gl_contexts_close(&contexts);
}

/* ---- edits */

/* Bytes of the spans whose stamps are not among those from before: the least that can be uploaded. */
typedef struct seen_span {
    uint64_t stamp;
    size_t first[2];
} seen_span;

typedef struct follower {
    seen_span *seen;
    size_t count;
} follower;

static bool was_seen(follower *f, size_t s, seen_span now) {
    bool same = s < f->count && memcmp(&f->seen[s], &now, sizeof now) == 0;
    f->seen[s] = now;
    return same;
}

static uint64_t changed_bytes_of_mesh(follower *f, const iso_mesh_view *mesh) {
    uint64_t bytes = 0;
    f->seen = realloc(f->seen, (mesh->span_count + 1) * sizeof *f->seen);
    assert_non_null(f->seen);
    for (size_t s = 0; s < mesh->span_count; s++) {
        const iso_mesh_span *span = &mesh->spans[s];
        seen_span now = {mesh->versions[s], {span->first_vertex, span->first_triangle}};
        if (!was_seen(f, s, now))
            bytes += (uint64_t)span->vertex_count * sizeof(iso_surfel) + (uint64_t)span->triangle_count * 6;
    }
    f->count = mesh->span_count;
    return bytes;
}

static uint64_t changed_bytes_of_points(follower *f, const iso_point_view *points, size_t item) {
    uint64_t bytes = 0;
    f->seen = realloc(f->seen, (points->span_count + 1) * sizeof *f->seen);
    assert_non_null(f->seen);
    for (size_t s = 0; s < points->span_count; s++) {
        seen_span now = {points->versions[s], {points->spans[s].first, 0}};
        if (!was_seen(f, s, now)) bytes += (uint64_t)points->spans[s].count * item;
    }
    f->count = points->span_count;
    return bytes;
}

/* The whole state of an edited grid's pictures. */
typedef struct sculpture {
    iso_grid grid;
    iso_mesh_set *mesh;
    iso_point_set *points;
    iso_gl_engine *engine;
    iso_gl_surface *mesh_shape, *strips_shape, *points_shape;
    follower of_mesh, of_points;
    size_t item; /* bytes of a point */
} sculpture;

/* What is known of blocks of points, measured bit by bit or all at once. */
static void check_blocks(const iso_point_blocks *a, const iso_point_blocks *b) {
    const iso_point_block *x = a->blocks.data, *y = b->blocks.data;
    const size_t item = sizeof(iso_point_bounds) + 2 * sizeof(double); /* bounds, radii */
    assert_int_equal(a->count, b->count);
    assert_int_equal(b->measured, b->count);
    for (size_t i = 0; i < a->count; i++)
        assert_true(x[i].span == y[i].span && x[i].first == y[i].first && x[i].count == y[i].count &&
                    memcmp(x[i].brick, y[i].brick, sizeof x[i].brick) == 0);
    if (a->count) assert_memory_equal(a->extents.data, b->extents.data, a->count * item);
}

static void check_against_fresh(sculpture *s, const iso_view *view, const iso_mesh_view *mesh,
                                const iso_point_view *points) {
    iso_gl_surface *fresh[3], *followed[3] = {s->mesh_shape, s->strips_shape, s->points_shape};
    assert_int_equal(iso_gl_upload_mesh(s->engine, mesh, &fresh[0], NULL), ISO_OK);
    assert_int_equal(iso_gl_upload_strips(s->engine, mesh, &fresh[1], NULL), ISO_OK);
    assert_int_equal(iso_gl_upload_points(s->engine, points, &fresh[2], NULL), ISO_OK);
    check_blocks(s->points_shape->blocks, fresh[2]->blocks);
    for (int i = 0; i < 3; i++) {
        iso_gbuffer a = draw(s->engine, followed[i], view), b = draw(s->engine, fresh[i], view);
        assert_int_equal(pixels_that_differ(&a, &b), 0);
        iso_gl_surface_stats x = iso_gl_surface_measure(followed[i]), y = iso_gl_surface_measure(fresh[i]);
        assert_true(x.triangles == y.triangles && x.indices == y.indices);
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
        iso_gl_surface_destroy(fresh[i]);
    }
}

/* Returns bytes uploaded for the mesh and the points. */
static uint64_t follow(sculpture *s, const iso_view *view) {
    assert_int_equal(iso_mesh_set_update(s->mesh, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_bound(s->mesh, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(s->points, NULL), ISO_OK);
    iso_mesh_view mesh = iso_mesh_set_view(s->mesh);
    iso_point_view points = iso_point_set_view(s->points);
    check_bounds(&mesh);
    assert_int_equal(iso_gl_update_mesh(s->mesh_shape, &mesh, NULL), ISO_OK);
    assert_int_equal(iso_gl_update_mesh(s->strips_shape, &mesh, NULL), ISO_OK);
    assert_int_equal(iso_gl_update_points(s->points_shape, &points, NULL), ISO_OK);
    uint64_t of_mesh = iso_gl_surface_measure(s->mesh_shape).uploaded,
             of_points = iso_gl_surface_measure(s->points_shape).uploaded;
    assert_int_equal(of_mesh, changed_bytes_of_mesh(&s->of_mesh, &mesh));
    assert_int_equal(of_points, changed_bytes_of_points(&s->of_points, &points, s->item));
    if (!of_points) assert_int_equal(s->points_shape->blocks->measured, 0);
    check_against_fresh(s, view, &mesh, &points);
    return of_mesh + of_points;
}

static void begin_sculpture(sculpture *s, iso_gl_engine *engine, int kind) {
    *s = (sculpture){.engine = engine, .item = kind == 2 ? sizeof(iso_surfel) : sizeof(iso_point)};
    s->grid = test_ball_grid(64, iso_vec3_make(31, 32, 30), 22, kind == 1);
    s->mesh = make_mesh(&s->grid, 0);
    const iso_points_opts opts = {.floats = kind == 2};
    assert_int_equal(iso_point_set_create(&s->grid, &opts, &s->points, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(s->points, NULL), ISO_OK);
    iso_mesh_view mesh = iso_mesh_set_view(s->mesh);
    iso_point_view points = iso_point_set_view(s->points);
    assert_int_equal(iso_gl_upload_mesh(engine, &mesh, &s->mesh_shape, NULL), ISO_OK);
    assert_int_equal(iso_gl_upload_strips(engine, &mesh, &s->strips_shape, NULL), ISO_OK);
    assert_int_equal(iso_gl_upload_points(engine, &points, &s->points_shape, NULL), ISO_OK);
    uint64_t all = iso_gl_surface_measure(s->mesh_shape).uploaded;
    assert_int_equal(all, changed_bytes_of_mesh(&s->of_mesh, &mesh));
    assert_int_equal(iso_gl_surface_measure(s->points_shape).uploaded,
                     changed_bytes_of_points(&s->of_points, &points, s->item));
}

static void end_sculpture(sculpture *s) {
    iso_gl_surface_destroy(s->mesh_shape);
    iso_gl_surface_destroy(s->strips_shape);
    iso_gl_surface_destroy(s->points_shape);
    iso_mesh_set_destroy(s->mesh);
    iso_point_set_destroy(s->points);
    iso_grid_destroy(&s->grid);
    free(s->of_mesh.seen);
    free(s->of_points.seen);
}

static void only_what_changed_is_uploaded(void **state) {
    (void)state;
    enum { EDITS = 30 };
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    iso_gl_engine *engine = make_engine(contexts.context[0]);
    test_random random = {3};
    for (int kind = 0; kind < 3; kind++) { /* sparse, dense, sparse with points in floats */
        sculpture s;
        begin_sculpture(&s, engine, kind);
        iso_mesh_view mesh = iso_mesh_set_view(s.mesh);
        iso_view view = view_of(&mesh, 6, false);
        uint64_t whole =
            iso_gl_surface_measure(s.mesh_shape).uploaded + iso_gl_surface_measure(s.points_shape).uploaded;
        uint64_t most = 0;
        size_t measured = 0;
        for (int edit = 0; edit < EDITS; edit++) {
            test_ball ball = {.radius = test_random_real(&random, 1, 6), .carve = edit % 2};
            ball.centre = iso_vec3_make(test_random_real(&random, 8, 56), test_random_real(&random, 8, 56),
                                        test_random_real(&random, 8, 56));
            bool large = edit % 7 == 3; /* bricks come and go */
            if (large) ball.radius = 18;
            if (edit == 20) ball = (test_ball){iso_vec3_make(30, 30, 30), 60, 1}; /* all away */
            test_stamp_ball(&s.grid, &ball);
            uint64_t sent = follow(&s, &view);
            const iso_point_blocks *blocks = s.points_shape->blocks;
            if (edit < 20 && !large && sent > most) most = sent;
            if (edit < 20 && !large && blocks->measured > measured) measured = blocks->measured;
            assert_true(edit >= 20 || large || blocks->measured < blocks->count);
            assert_int_equal(follow(&s, &view), 0); /* nothing new */
        }
        print_message("kind %d: at most %.1f %% of %.0f kB in one edit\n", kind,
                      100.0 * (double)most / (double)whole, (double)whole / 1e3);
        assert_true(most > 0 && most < whole && measured > 0);
        /* another isovalue: everything */
        iso_mesh_set_isovalue(s.mesh, 0.5);
        iso_point_set_isovalue(s.points, 0.5);
        follow(&s, &view);
        end_sculpture(&s);
    }
    iso_gl_engine_destroy(engine);
    gl_contexts_close(&contexts);
}

/* Sets slide their spans together now and then: what is in them is the same, in another place. */
static void what_moved_is_uploaded(void **state) {
    (void)state;
    enum { GAP = 100 };
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    iso_gl_engine *engine = make_engine(contexts.context[0]);
    iso_grid grid;
    iso_mesh_set *set = scene_mesh("sphere", 48, false, &grid);
    const iso_mesh_view mesh = iso_mesh_set_view(set);
    iso_view view = view_of(&mesh, 6, false);
    size_t vertices = 0, triangles = 0;
    for (size_t i = 0; i < mesh.span_count; i++) {
        vertices += mesh.spans[i].vertex_count;
        triangles += mesh.spans[i].triangle_count;
    }
    iso_surfel *room = calloc(vertices + GAP, sizeof *room);
    uint16_t(*corners)[3] = calloc(triangles + GAP, sizeof *corners);
    iso_mesh_span *spans = malloc(mesh.span_count * sizeof *spans);
    assert_true(room && corners && spans);
    memcpy(room + GAP, mesh.vertices, vertices * sizeof *room); /* packed tight after a first extraction */
    memcpy(corners + GAP, mesh.triangles, triangles * sizeof *corners);
    for (int what = 0; what < 2; what++) {
        iso_mesh_view moved = mesh;
        memcpy(spans, mesh.spans, mesh.span_count * sizeof *spans);
        for (size_t i = mesh.span_count / 2; i < mesh.span_count; i++) {
            if (what)
                spans[i].first_triangle += GAP;
            else
                spans[i].first_vertex += GAP;
        }
        if (what)
            moved.triangles = (const uint16_t(*)[3])corners;
        else
            moved.vertices = room;
        size_t low = what ? mesh.spans[mesh.span_count / 2].first_triangle
                          : mesh.spans[mesh.span_count / 2].first_vertex;
        if (what)
            memcpy(corners, mesh.triangles, low * sizeof *corners);
        else
            memcpy(room, mesh.vertices, low * sizeof *room);
        moved.spans = spans;
        iso_gl_surface *surface;
        assert_int_equal(iso_gl_upload_mesh(engine, &mesh, &surface, NULL), ISO_OK);
        uint64_t whole = iso_gl_surface_measure(surface).uploaded;
        iso_gbuffer before = draw(engine, surface, &view);
        assert_int_equal(iso_gl_update_mesh(surface, &moved, NULL), ISO_OK);
        uint64_t sent = iso_gl_surface_measure(surface).uploaded;
        assert_true(sent > 0 && sent < whole);
        iso_gbuffer after = draw(engine, surface, &view);
        assert_true(covered(&before) > 0);
        assert_int_equal(pixels_that_differ(&before, &after), 0);
        iso_gbuffer_free(&before);
        iso_gbuffer_free(&after);
        iso_gl_surface_destroy(surface);
    }
    free(room);
    free(corners);
    free(spans);
    iso_mesh_set_destroy(set);
    iso_grid_destroy(&grid);
    iso_gl_engine_destroy(engine);
    gl_contexts_close(&contexts);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_are_the_triangles),         cmocka_unit_test(strips_draw_the_same_picture),
        cmocka_unit_test(nothing_that_is_seen_is_left_out), cmocka_unit_test(only_what_changed_is_uploaded),
        cmocka_unit_test(what_moved_is_uploaded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
