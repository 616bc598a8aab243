/* Frames of several kinds of primitives, one thread: lines added to a frame of points by pull-push; a tree
 * as lines against the same tree as triangles (Marroquim, Kraus and Cavalcanti 2008, figures 13 and 19); a
 * translucent isosurface over tubes against an opaque one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "bench_subject.h"
#include "exact/layers.h"
#include "render/pullpush/sets.h"
#include "render/raster/triangles.h"
#include "render/shading/shading.h"
#include "render/shapes/shapes.h"
#include "scene_tree.h"

enum { LINES = 200, LINE = 101, SURFACE = 0, WOOD = 1, LEAVES = 2, TREES = 10 };

static const iso_rgb COLORS[] = {{0xD9, 0xB3, 0x6C}, {0x6B, 0x4A, 0x2F}, {0x4F, 0x8A, 0x3C}};
static const iso_shading SHADING = {.colors = COLORS, .color_count = 3};

/* What all rows of a group draw from. */
typedef struct scene {
    bench_subject subject; /* an isosurface; not of trees */
    iso_scene_tree tree;   /* of trees */
    int trees;
    iso_lines wood, leaves; /* of all trees; in the other groups `wood` are lines through the subject */
    iso_triangle_spans wood_spans, leaf_spans;
    iso_shapes *wood_shapes, *leaf_shapes;
    iso_pyramid_lines *wood_pyramid, *leaf_pyramid, *ribbons;
    iso_pullpush *workspace;
    iso_gbuffer gbuffer;
    iso_image image;
    iso_view view;
    iso_status (*make)(struct scene *scene, iso_error *error);
    bool made;
} scene;

typedef iso_status draw_fn(scene *scene, const iso_target *target, iso_error *error);
typedef struct plan {
    scene *scene;
    draw_fn *draw;
    bool paints; /* draw shades the image */
} plan;

/* ---- rows */

static iso_status open_row(bench_row *row, iso_error *error) {
    const plan *p = row->plan;
    if (!p->scene->made) ISO_TRY(p->scene->make(p->scene, error));
    p->scene->made = true;
    return ISO_OK;
}

static iso_status run_row(bench_row *row, bench_sample *sample, iso_error *error) {
    const plan *p = row->plan;
    scene *s = p->scene;
    const iso_target target = {.view = &s->view, .gbuffer = &s->gbuffer, .surface = SURFACE};
    const bench_clock clock = bench_clock_start();
    iso_gbuffer_clear(&s->gbuffer);
    ISO_TRY(p->draw(s, &target, error));
    const iso_strip strip = {.view = &s->view, .gbuffer = &s->gbuffer, .factor = 1};
    if (!p->paints) iso_shade(&SHADING, &strip, &s->image, NULL);
    bench_clock_stop(&clock, sample);
    sample->primitives = bench_covered(&s->gbuffer);
    return ISO_OK;
}

static void finish_row(bench_row *row) {
    bench_count(row, "covered_pixels", (double)row->primitives, 0, 0);
}

/* The scene belongs to the group. */
static void close_row(bench_row *row) {
    (void)row;
}

static const bench_kind kind = {
    .open = open_row, .run = run_row, .finish = finish_row, .close = close_row, .batch = 3};

static bench_row *add_row(bench_state *bench, scene *s, const char *name, draw_fn *draw, bool paints) {
    bench_row *row = bench_add(bench, &kind, "render/together/%s/threads:1", name);
    plan *p = calloc(1, sizeof *p);
    if (!p) abort(); /* (as bench_add does when there are too many rows) */
    *p = (plan){s, draw, paints};
    row->plan = p;
    row->threads = 1;
    return row;
}

static void compare(bench_row *row, bench_row *other, const char *counter, double least) {
    bench_against *against =
        bench_compare(row, other, counter, NULL, row->bench->settings->small ? 0 : least);
    if (against) against->cpu = "cpu_ratio";
}

static iso_status make_picture(scene *s, int side, iso_error *error) {
    ISO_TRY(iso_pullpush_create(&s->workspace, error));
    ISO_TRY(iso_image_create(side, side, &s->image, error));
    return iso_gbuffer_create(side, side, &s->gbuffer, error);
}

static void free_scene(scene *s) {
    bench_subject_end(&s->subject);
    iso_scene_tree_free(&s->tree);
    iso_shapes_destroy(s->wood_shapes);
    iso_shapes_destroy(s->leaf_shapes);
    iso_pyramid_lines_destroy(s->wood_pyramid);
    iso_pyramid_lines_destroy(s->leaf_pyramid);
    iso_pyramid_lines_destroy(s->ribbons);
    iso_lines_free(&s->wood);
    iso_lines_free(&s->leaves);
    iso_triangle_spans_free(&s->wood_spans);
    iso_triangle_spans_free(&s->leaf_spans);
    iso_pullpush_destroy(s->workspace);
    iso_gbuffer_free(&s->gbuffer);
    iso_image_free(&s->image);
}

/* ---- an isosurface and lines through it */

static double uniform(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

/* Walks that bend, in the box of the points. */
static iso_status make_walks(scene *s, const iso_box *box, iso_error *error) {
    iso_lines *lines = &s->wood;
    uint64_t seed = 1;
    const double lo[3] = {box->lo.x, box->lo.y, box->lo.z}, hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    lines->line_count = LINES;
    lines->vertex_count = (size_t)LINES * LINE;
    lines->vertices = iso_alloc(lines->vertex_count * sizeof *lines->vertices);
    lines->starts = iso_alloc((LINES + 1) * sizeof *lines->starts);
    if (!lines->vertices || !lines->starts) return iso_fail_memory(error, "lines");
    for (size_t i = 0; i <= LINES; i++) lines->starts[i] = i * LINE;
    for (int line = 0; line < LINES; line++) {
        double at[3], way[3];
        for (int a = 0; a < 3; a++) {
            at[a] = lo[a] + (hi[a] - lo[a]) * uniform(&seed);
            way[a] = uniform(&seed) - 0.5;
        }
        for (int i = 0; i < LINE; i++)
            for (int a = 0; a < 3; a++) {
                lines->vertices[line * LINE + i][a] = (float)at[a];
                way[a] += 0.3 * (uniform(&seed) - 0.5);
                at[a] += way[a] * (hi[a] - lo[a]) * 0.01;
            }
    }
    return iso_lines_add_normals(lines, error);
}

static iso_status make_surface(scene *s, iso_error *error) {
    iso_point_view points;
    bench_view view;
    ISO_TRY(bench_subject_points(&s->subject, &points, error));
    ISO_TRY(bench_subject_view(&s->subject, 0, &view, error));
    s->view = view.view;
    ISO_TRY(make_picture(s, s->view.width, error));
    const iso_box index = iso_point_view_bounds(&points);
    const iso_affine affine = iso_transform_affine(&points.transform);
    const iso_box box = iso_box_transform(&index, &affine);
    ISO_TRY(make_walks(s, &box, error));
    const double radius = 0.003 * (box.hi.x - box.lo.x);
    const iso_shapes_opts tubes = {.radius = radius, .min_pixels = 1},
                          ribbons = {.radius = radius, .min_pixels = 1, .style = ISO_LINE_RIBBON};
    ISO_TRY(iso_shapes_from_lines(&s->wood, &tubes, &s->wood_shapes, error));
    ISO_TRY(iso_pyramid_lines_create(&s->wood, &tubes, &s->wood_pyramid, error));
    return iso_pyramid_lines_create(&s->wood, &ribbons, &s->ribbons, error);
}

static iso_target with_surface(const iso_target *target, uint8_t surface) {
    iso_target other = *target;
    other.surface = surface;
    return other;
}

static iso_status draw_points(scene *s, const iso_target *target, iso_error *error) {
    const iso_pullpush_opts opts = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN, .workspace = s->workspace};
    iso_point_view points;
    ISO_TRY(bench_subject_points(&s->subject, &points, error));
    return iso_draw_pullpush(target, &points, &opts, error);
}

static iso_status draw_points_tubes(scene *s, const iso_target *target, iso_error *error) {
    const iso_target lines = with_surface(target, WOOD);
    ISO_TRY(draw_points(s, target, error));
    return iso_draw_pyramid_lines(&lines, s->wood_pyramid, s->workspace, error);
}

static iso_status draw_points_ribbons(scene *s, const iso_target *target, iso_error *error) {
    const iso_target lines = with_surface(target, WOOD);
    ISO_TRY(draw_points(s, target, error));
    return iso_draw_pyramid_lines(&lines, s->ribbons, s->workspace, error);
}

static iso_status draw_one_pyramid(scene *s, const iso_target *target, iso_error *error) {
    const iso_pullpush_opts opts = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN, .workspace = s->workspace};
    iso_point_view points;
    ISO_TRY(bench_subject_points(&s->subject, &points, error));
    const iso_pyramid_set sets[] = {{.surface = SURFACE, .points = &points},
                                    {.surface = WOOD, .ribbons = s->ribbons}};
    return iso_draw_pyramid_sets(target, sets, 2, &opts, error);
}

static iso_status draw_points_exact_tubes(scene *s, const iso_target *target, iso_error *error) {
    const iso_target lines = with_surface(target, WOOD);
    ISO_TRY(draw_points(s, target, error));
    return iso_draw_shapes(&lines, s->wood_shapes, NULL, error);
}

static iso_status draw_opaque(scene *s, const iso_target *target, iso_error *error) {
    const iso_target lines = with_surface(target, WOOD);
    const iso_exact *exact;
    ISO_TRY(bench_subject_exact(&s->subject, &exact, error));
    ISO_TRY(iso_draw_exact(target, exact, error));
    return iso_draw_shapes(&lines, s->wood_shapes, NULL, error);
}

static iso_status paint_translucent(scene *s, const iso_target *target, iso_error *error) {
    const iso_target lines = with_surface(target, WOOD);
    const iso_strip strip = {.view = &s->view, .gbuffer = &s->gbuffer, .factor = 1};
    iso_exact_layer layer = {.color = COLORS[0], .translucency = {.opacity = 0.5f}};
    iso_exact_layers_totals totals = {.retraced = 0};
    ISO_TRY(bench_subject_exact(&s->subject, &layer.exact, error));
    const iso_exact_layers picture = {
        .layers = &layer, .count = 1, .picture = {.strip = &strip, .shading = &SHADING, .image = &s->image}};
    ISO_TRY(iso_draw_shapes(&lines, s->wood_shapes, NULL, error));
    return iso_shade_exact_layers(&picture, &totals, error);
}

static iso_status run_surface(bench_state *bench, iso_error *error) {
    const int size = bench->settings->small ? 32 : 256;
    scene s = {.subject = {.bench = bench, .ct_size = size, .isovalue = 127.5}, .make = make_surface};
    snprintf(s.subject.name, sizeof s.subject.name, "ct%d", size);
    bench_row *points = add_row(bench, &s, "points", draw_points, false);
    const struct {
        const char *name;
        draw_fn *draw;
    } more[] = {{"points+ribbons/one_pyramid", draw_one_pyramid},
                {"points+ribbons", draw_points_ribbons},
                {"points+tubes", draw_points_tubes},
                {"points+tubes/exact", draw_points_exact_tubes}};
    for (size_t i = 0; i < sizeof more / sizeof *more; i++)
        compare(add_row(bench, &s, more[i].name, more[i].draw, false), points, "ratio_vs_points", 1 / 1.3);
    bench_row *opaque = add_row(bench, &s, "exact+tubes/opaque", draw_opaque, false);
    compare(add_row(bench, &s, "exact+tubes/translucent", paint_translucent, true), opaque, "ratio_vs_opaque",
            1.0 / 3);
    const iso_status status = bench_run_group(bench, "lines beside an isosurface", error);
    free_scene(&s);
    return status;
}

/* ---- trees */

/* Where a tree stands. */
static iso_vec3 tree_place(int tree) {
    return iso_vec3_make(900.0 * (tree % 5), 1100.0 * (tree / 5) + 150.0 * (tree % 2), 0);
}

static iso_status copy_lines(const iso_lines *one, int count, iso_lines *all, iso_error *error) {
    const size_t vertices = one->vertex_count;
    all->vertex_count = vertices * (size_t)count;
    all->line_count = one->line_count * (size_t)count;
    all->vertices = iso_alloc(all->vertex_count * sizeof *all->vertices);
    all->radii = iso_alloc(all->vertex_count * sizeof *all->radii);
    all->normals = one->normals ? iso_alloc(all->vertex_count * sizeof *all->normals) : NULL;
    all->starts = iso_alloc_zero(all->line_count + 1, sizeof *all->starts);
    if (!all->vertices || !all->radii || !all->starts || (one->normals && !all->normals))
        return iso_fail_memory(error, "trees");
    for (int i = 0; i < count; i++) {
        const size_t first = vertices * (size_t)i, line = one->line_count * (size_t)i;
        const iso_vec3 at = tree_place(i);
        for (size_t k = 0; k < vertices; k++) {
            all->vertices[first + k][0] = one->vertices[k][0] + (float)at.x;
            all->vertices[first + k][1] = one->vertices[k][1] + (float)at.y;
            all->vertices[first + k][2] = one->vertices[k][2] + (float)at.z;
        }
        memcpy(all->radii + first, one->radii, vertices * sizeof *one->radii);
        if (one->normals) memcpy(all->normals + first, one->normals, vertices * sizeof *one->normals);
        for (size_t k = 0; k <= one->line_count; k++) all->starts[line + k] = first + one->starts[k];
    }
    return ISO_OK;
}

static iso_status make_trees(scene *s, iso_error *error) {
    const bool small = s->subject.bench->settings->small;
    const iso_scene_tree_opts opts = {.size = small ? 0.2 : 0};
    const iso_shapes_opts tubes = {.min_pixels = 1}, ribbons = {.min_pixels = 1, .style = ISO_LINE_RIBBON};
    ISO_TRY(make_picture(s, small ? 64 : 1024, error));
    ISO_TRY(iso_scene_tree_make(&opts, &s->tree, error));
    ISO_TRY(copy_lines(&s->tree.wood, s->trees, &s->wood, error));
    ISO_TRY(copy_lines(&s->tree.leaves, s->trees, &s->leaves, error));
    ISO_TRY(iso_triangle_spans_make(&s->tree.wood_mesh, &s->wood_spans, error));
    ISO_TRY(iso_triangle_spans_make(&s->tree.leaf_mesh, &s->leaf_spans, error));
    ISO_TRY(iso_shapes_from_lines(&s->wood, &tubes, &s->wood_shapes, error));
    ISO_TRY(iso_shapes_from_lines(&s->leaves, &ribbons, &s->leaf_shapes, error));
    ISO_TRY(iso_pyramid_lines_create(&s->wood, &tubes, &s->wood_pyramid, error));
    ISO_TRY(iso_pyramid_lines_create(&s->leaves, &ribbons, &s->leaf_pyramid, error));
    const iso_box box = iso_lines_bounds(&s->wood);
    iso_camera camera = {.position = {-0.3, -1, 0.25}, .view_up = {0, 0, 1}, .view_angle = 30};
    iso_camera_fit(&camera, &box, 1, 1);
    s->view = iso_view_make(&camera, s->image.width, s->image.height);
    return ISO_OK;
}

static iso_status draw_tree_lines(scene *s, const iso_target *target, iso_error *error) {
    const iso_target wood = with_surface(target, WOOD), leaves = with_surface(target, LEAVES);
    ISO_TRY(iso_draw_pyramid_lines(&wood, s->wood_pyramid, s->workspace, error));
    return iso_draw_pyramid_lines(&leaves, s->leaf_pyramid, s->workspace, error);
}

static iso_status draw_tree_shapes(scene *s, const iso_target *target, iso_error *error) {
    const iso_target wood = with_surface(target, WOOD), leaves = with_surface(target, LEAVES);
    ISO_TRY(iso_draw_shapes(&wood, s->wood_shapes, NULL, error));
    return iso_draw_shapes(&leaves, s->leaf_shapes, NULL, error);
}

static iso_status draw_tree_mesh(scene *s, const iso_target *target, iso_error *error) {
    for (int i = 0; i < s->trees; i++)
        for (int part = 0; part < 2; part++) {
            const iso_target one = with_surface(target, part ? LEAVES : WOOD);
            iso_mesh_view mesh = iso_triangle_spans_view(part ? &s->leaf_spans : &s->wood_spans);
            const iso_vec3 at = tree_place(i);
            const double origin[3] = {at.x, at.y, at.z};
            memcpy(mesh.transform.origin, origin, sizeof origin);
            ISO_TRY(iso_draw_mesh(&one, &mesh, error));
        }
    return ISO_OK;
}

static iso_status run_trees(bench_state *bench, int trees, iso_error *error) {
    char name[64];
    scene s = {.subject = {.bench = bench}, .trees = trees, .make = make_trees};
    snprintf(name, sizeof name, "trees-%d/triangles", trees);
    bench_row *mesh = add_row(bench, &s, name, draw_tree_mesh, false);
    snprintf(name, sizeof name, "trees-%d/pullpush", trees);
    compare(add_row(bench, &s, name, draw_tree_lines, false), mesh, "ratio_vs_triangles", 1.7);
    snprintf(name, sizeof name, "trees-%d/exact", trees);
    compare(add_row(bench, &s, name, draw_tree_shapes, false), mesh, "ratio_vs_triangles", 1.7);
    const iso_status status = bench_run_group(bench, "trees as lines and as triangles", error);
    free_scene(&s);
    return status;
}

iso_status bench_together_groups(bench_state *bench, iso_error *error) {
    ISO_TRY(run_surface(bench, error));
    ISO_TRY(run_trees(bench, 1, error));
    return run_trees(bench, TREES, error);
}
