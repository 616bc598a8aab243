/* Draws sets of shapes and compares them with rays in extended precision. */
#include "shapes_support.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/cpu.h"
#include "check_support.h"
#include "scene_support.h"

enum { SIDE = 60 };

iso_view test_shapes_view_sized(iso_vec3 origin, iso_vec3 away, double height, bool parallel,
                                const int pixels[2]) {
    const iso_camera camera = {.position = iso_vec3_add(origin, away),
                               .focal_point = origin,
                               .view_up = iso_vec3_make(0.1, 1, 0.2),
                               .view_angle = 2 * iso_atan2(height / 2, iso_vec3_length(away)) * 180 / ISO_PI,
                               .parallel_scale = height / 2,
                               .orthographic = parallel};
    return iso_view_make(&camera, pixels[0], pixels[1]);
}

iso_view test_shapes_view(iso_vec3 origin, iso_vec3 away, double height, bool parallel) {
    return test_shapes_view_sized(origin, away, height, parallel, (const int[2]){SIDE, SIDE - 7});
}

iso_gbuffer test_shapes_drawn(const iso_view *view, const iso_shapes *shapes, iso_pool *pool) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    test_ok(iso_gbuffer_add_elements(&g, &error), &error);
    const iso_target target = {view, &g, pool, 3, NULL};
    test_ok(iso_draw_shapes(&target, shapes, NULL, &error), &error);
    return g;
}

/* ---- against the truth */

typedef struct verdict {
    size_t covered;       /* samples that show a shape */
    size_t outline;       /* samples that are hit or missed wrongly, */
    size_t plain;         /* though no ray nearby is */
    size_t depth, normal; /* samples with a wrong depth, unless rays nearby have it, or a wrong normal */
} verdict;

static double depth_tolerance(const iso_shapes_hit *hit) {
    return 1e-4 * hit->size + fabs(hit->depth) * FLT_EPSILON;
}

/* Whether the sample is like those of rays through positions up to 1e-3 pixel beside its centre. */
static bool is_grazing(const iso_shapes_truth *truth, double x, double y, float depth) {
    double low = INFINITY, high = -INFINITY;
    bool misses = false;
    for (int way = 0; way < 9; way++) {
        const iso_shapes_hit hit =
            iso_shapes_truth_ray(truth, x + (way % 3 - 1) * 1e-3, y + (way / 3 - 1) * 1e-3);
        misses |= !hit.hit;
        if (!hit.hit) continue;
        const double tolerance = depth_tolerance(&hit);
        low = hit.depth - tolerance < low ? hit.depth - tolerance : low;
        high = hit.depth + tolerance > high ? hit.depth + tolerance : high;
    }
    return isfinite(depth) ? (double)depth >= low && (double)depth <= high : misses;
}

/* Whether another shape is so near behind that a depth's rounding decides which of them is seen. */
static bool is_crease(const iso_shapes_hit *hit) {
    return hit->behind - hit->depth < 2 * depth_tolerance(hit);
}

static double normal_error(const iso_gbuffer *g, size_t sample, const iso_shapes_hit *hit) {
    double cross = 0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const double x =
            (double)g->normal[b][sample] * hit->normal[c] - (double)g->normal[c][sample] * hit->normal[b];
        cross += x * x;
    }
    return sqrt(cross) * 180 / ISO_PI;
}

static void judge_sample(const iso_shapes_truth *truth, const iso_gbuffer *g, int x, int y, verdict *v) {
    const size_t sample = (size_t)y * (size_t)g->width + (size_t)x;
    const float depth = g->depth[sample];
    const iso_shapes_hit hit = iso_shapes_truth_ray(truth, x + 0.5, y + 0.5);
    v->covered += hit.hit;
    assert_int_equal(g->surface[sample], isfinite(depth) ? 3 : ISO_SURFACE_NONE);
    if (!isfinite(depth)) assert_int_equal(g->element[sample], 0);
    if (hit.hit != isfinite(depth)) {
        v->outline++;
        v->plain += !is_grazing(truth, x + 0.5, y + 0.5, depth);
    } else if (hit.hit && fabs((double)depth - hit.depth) > depth_tolerance(&hit)) {
        v->depth += !is_grazing(truth, x + 0.5, y + 0.5, depth);
    } else if (hit.hit && !is_crease(&hit)) {
        assert_int_equal(g->element[sample], hit.shape + 1);
        v->normal += normal_error(g, sample, &hit) > 0.02;
    }
}

static verdict judge(const iso_shapes_truth *truth, const iso_gbuffer *g, const char *name) {
    verdict v = {0};
    for (int y = 0; y < g->height; y++)
        for (int x = 0; x < g->width; x++) judge_sample(truth, g, x, y, &v);
    const size_t few = v.covered / 10000 + 1;
    if (v.outline > 2 || v.plain || v.depth > few || v.normal > few)
        fail_msg("%s: of %zu samples wrong: outline %zu, plainly %zu, depth %zu, normal %zu", name, v.covered,
                 v.outline, v.plain, v.depth, v.normal);
    return v;
}

iso_shapes *test_shapes_make(const iso_shapes_scene *scene) {
    iso_error error = {0};
    iso_shapes *shapes;
    if (scene->glyphs)
        test_ok(iso_shapes_from_glyphs(scene->glyphs, &scene->opts, &shapes, &error), &error);
    else
        test_ok(iso_shapes_from_lines(scene->lines, &scene->opts, &shapes, &error), &error);
    return shapes;
}

size_t test_shapes_compare(const iso_shapes_scene *scene, const iso_view *view, const char *name) {
    iso_error error = {0};
    iso_shapes *shapes = test_shapes_make(scene);
    iso_gbuffer g = test_shapes_drawn(view, shapes, NULL);
    iso_shapes_truth *truth;
    test_ok(iso_shapes_truth_create(scene, view, &truth, &error), &error);
    const verdict v = judge(truth, &g, name);
    iso_shapes_truth_destroy(truth);
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
    return v.covered;
}

void test_shapes_compare_views(const iso_shapes_scene *scene, iso_vec3 away, double height,
                               const char *name) {
    const iso_vec3 origin = scene->glyphs ? scene->glyphs->origin : scene->lines->origin;
    char text[128];
    size_t covered = 0;
    for (int zoom = 0; zoom < 3; zoom++)
        for (int parallel = 0; parallel < 2; parallel++) {
            const double factor = zoom == 0 ? 1 : zoom == 1 ? 0.3 : 4;
            const iso_view view = test_shapes_view(origin, away, height * factor, parallel);
            snprintf(text, sizeof text, "%s, zoom %d, %s", name, zoom, parallel ? "parallel" : "perspective");
            covered += test_shapes_compare(scene, &view, text);
        }
    assert_true(covered > 0);
}

static iso_gbuffer draw_shapes(const void *context, const iso_view *view, iso_pool *pool) {
    return test_shapes_drawn(view, context, pool);
}

void test_shapes_variants(const iso_shapes *shapes, const iso_view *view) {
    iso_gbuffer wanted = test_shapes_drawn(view, shapes, NULL);
    test_variants_of(draw_shapes, shapes, view, &wanted);
    test_strips_of(draw_shapes, shapes, view, 1, &wanted);
    iso_gbuffer_free(&wanted);
}

/* ---- what is cut */

iso_clip test_shapes_clip(iso_vec3 middle) {
    iso_clip clip = {.count = 2};
    clip.body[0] = iso_clip_half_space(middle, iso_vec3_make(-0.7, -0.2, 1));
    clip.body[1] = iso_clip_ball(iso_vec3_add(middle, iso_vec3_make(2, 1, 0)), 3);
    return clip;
}

bool test_shapes_left(const iso_clip *clip, const iso_view *view, double px, double py, double depth) {
    iso_vec3 origin, direction;
    iso_view_ray(view, px, py, &origin, &direction);
    return !clip || iso_clip_shows(clip, iso_vec3_add(origin, iso_vec3_scale(direction, depth)));
}
