/* Opaque glyphs and lines that a clip cuts, against rays in extended precision: each sample shows the first
 * crossing that is left; and the same bytes for every instruction set, number of threads and strip. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "check_support.h"
#include "lines_support.h"
#include "scene_support.h"
#include "shapes_support.h"
#include "view_support.h"

enum { GLYPHS = 600, MOST_LAYERS = 4000 };
static const iso_vec3 AWAY = {60, 35, -80};

/* The depth of the first layer of the ray that is left; INFINITY: there is none. */
static double first_left(iso_shapes_truth *traced, const iso_clip *clip, const iso_view *view, double px,
                         double py, double normal[3]) {
    static iso_shapes_layer found[MOST_LAYERS];
    const size_t n = iso_shapes_truth_layers(traced, px, py, found, MOST_LAYERS);
    for (size_t i = 0; i < n; i++) {
        memcpy(normal, found[i].normal, sizeof found[i].normal);
        if (test_shapes_left(clip, view, px, py, found[i].depth)) return found[i].depth;
    }
    return INFINITY;
}

/* Whether the depth that was drawn is that of a ray up to 1e-3 pixel beside the sample's centre. */
static bool is_near_truth(iso_shapes_truth *traced, const iso_clip *clip, const iso_view *view, int x, int y,
                          double drawn) {
    for (int way = 0; way < 9; way++) {
        double normal[3];
        const double wanted = first_left(traced, clip, view, x + 0.5 + (way % 3 - 1) * 1e-3,
                                         y + 0.5 + (way / 3 - 1) * 1e-3, normal);
        if (wanted == drawn || fabs(wanted - drawn) < 1e-3) return true;
    }
    return false;
}

/* Opaque shapes: a sample shows the first layer that is left, and its normal. */
static void compare_opaque(const iso_shapes_scene *scene, const iso_clip *clip, const iso_view *view,
                           const char *name) {
    iso_error error = {0};
    iso_shapes *shapes = test_shapes_make(scene);
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_target target = {view, &g, NULL, 3, clip};
    iso_shapes_drawn drawn = {0};
    iso_shapes_truth *traced;
    test_ok(iso_draw_shapes(&target, shapes, &drawn, &error), &error);
    test_ok(iso_shapes_truth_create(scene, view, &traced, &error), &error);
    size_t covered = 0, wrong = 0, graze = 0;
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            const int at = y * view->width + x;
            double normal[3] = {0, 0, 0};
            const double depth = first_left(traced, clip, view, x + 0.5, y + 0.5, normal);
            const bool shown = g.surface[at] == 3;
            covered += shown;
            bool same =
                shown ? fabs(depth - (double)g.depth[at]) < 1e-4 * (1 + fabs(depth)) : depth == INFINITY;
            for (int a = 0; a < 3 && same && shown; a++)
                same = fabs(normal[a] - (double)g.normal[a][at]) < 1e-2;
            if (same) continue;
            graze++;
            wrong += !is_near_truth(traced, clip, view, x, y, shown ? (double)g.depth[at] : INFINITY);
        }
    if (!covered || wrong || graze > covered / 100 + 2 || drawn.samples < covered)
        fail_msg("%s: of %zu opaque samples %zu are wrong, and %zu beside outlines", name, covered, wrong,
                 graze);
    iso_shapes_truth_destroy(traced);
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
}

/* A set and its clip, for pictures of every variant. */
typedef struct cut_set {
    const iso_shapes *shapes;
    const iso_clip *clip;
} cut_set;

/* test_picture */
static iso_gbuffer draw_cut(const void *context, const iso_view *view, iso_pool *pool) {
    const cut_set *set = context;
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_target target = {view, &g, pool, 3, set->clip};
    test_ok(iso_draw_shapes(&target, set->shapes, NULL, &error), &error);
    return g;
}

static void compare_clipped(const iso_shapes_scene *scene, iso_vec3 origin, const char *name) {
    const iso_clip clip = test_shapes_clip(iso_vec3_add(origin, iso_vec3_make(0.1, 0.2, 0.3)));
    for (int parallel = 0; parallel < 2; parallel++) {
        const iso_view view = test_shapes_view(origin, AWAY, 18, parallel);
        compare_opaque(scene, &clip, &view, name);
    }
    const iso_view view = test_shapes_view(origin, AWAY, 18, false);
    const cut_set set = {test_shapes_make(scene), &clip};
    iso_gbuffer wanted = draw_cut(&set, &view, NULL);
    test_variants_of(draw_cut, &set, &view, &wanted);
    test_strips_of(draw_cut, &set, &view, 1, &wanted);
    iso_gbuffer_free(&wanted);
    iso_shapes_destroy((iso_shapes *)set.shapes);
}

static void test_glyphs(void **state) {
    (void)state;
    static float positions[GLYPHS][3], radii[GLYPHS], directions[GLYPHS][3], axes[GLYPHS][9];
    uint32_t seed = 7;
    for (int i = 0; i < GLYPHS; i++) {
        for (int a = 0; a < 3; a++) {
            positions[i][a] = (float)(16 * uniform(&seed) - 8);
            directions[i][a] = (float)(6 * uniform(&seed) - 3);
            for (int k = 0; k < 3; k++) axes[i][3 * a + k] = (float)(uniform(&seed) - 0.5 + (a == k));
        }
        radii[i] = (float)(0.3 + uniform(&seed));
    }
    for (int glyph = 0; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_glyphs glyphs = {.origin = {glyph == 2 ? 1e5 : 0, 5, 0},
                                   .positions = positions,
                                   .radii = radii,
                                   .directions = directions,
                                   .axes = axes,
                                   .count = GLYPHS};
        const iso_shapes_scene scene = {&glyphs, NULL, {.glyph = (iso_glyph)glyph}};
        char name[32];
        snprintf(name, sizeof name, "glyph %d", glyph);
        compare_clipped(&scene, glyphs.origin, name);
    }
}

static test_lines lines;

static void test_tubes_and_ribbons(void **state) {
    (void)state;
    iso_error error = {0};
    uint32_t seed = 3;
    test_lines_start(&lines, 0, 0, 0);
    for (int i = 0; i < 30; i++) test_lines_add_walk(&lines, 20, 8, 2, 0.1, 0.9, &seed);
    for (int flat = 0; flat < 2; flat++) {
        const iso_shapes_scene tubes = {NULL, &lines.lines, {.caps = (iso_caps)flat}};
        compare_clipped(&tubes, lines.lines.origin, flat ? "tubes with flat ends" : "tubes");
    }
    iso_lines drawn = lines.lines;
    drawn.normals = NULL;
    test_ok(iso_lines_add_normals(&drawn, &error), &error);
    const iso_shapes_scene ribbons = {NULL, &drawn, {.style = ISO_LINE_RIBBON}};
    compare_clipped(&ribbons, drawn.origin, "ribbons");
    iso_free(drawn.normals);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_glyphs),
                                       cmocka_unit_test(test_tubes_and_ribbons)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
