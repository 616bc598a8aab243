/* Lines in the pyramid of pull-push, against rays in extended precision through the exact tubes and ribbons:
 * outlines, depths and normals by radius in pixels; no gaps; a thin line before a wall; lines that point at
 * the eye; and the same bytes for every instruction set, number of threads and strip. */
#include <stdlib.h>
#include <string.h>

#include "base/cpu.h"
#include "base/memory.h"
#include "check_support.h"
#include "lines_support.h"
#include "render/pullpush/lines.h"
#include "render/shading/phong.h"
#include "scene_support.h"
#include "shapes_support.h"

static test_lines scene;
static const iso_vec3 AWAY = {60, 35, -80};

enum { SURFACE = 3 };

static iso_pyramid_lines *prepare(const iso_shapes_opts *opts) {
    iso_error error = {0};
    iso_pyramid_lines *lines;
    test_ok(iso_pyramid_lines_create(&scene.lines, opts, &lines, &error), &error);
    return lines;
}

static void draw(const iso_view *view, const iso_pyramid_lines *lines, iso_gbuffer *g, iso_pool *pool) {
    iso_error error = {0};
    const iso_target target = {view, g, pool, SURFACE, NULL};
    test_ok(iso_draw_pyramid_lines(&target, lines, NULL, &error), &error);
}

static iso_gbuffer draw_lines(const void *lines, const iso_view *view, iso_pool *pool) {
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, scene.lines.colors != NULL);
    draw(view, lines, &g, pool);
    return g;
}

static iso_gbuffer drawn(const iso_view *view, const iso_shapes_opts *opts) {
    iso_pyramid_lines *lines = prepare(opts);
    iso_gbuffer g = draw_lines(lines, view, NULL);
    iso_pyramid_lines_destroy(lines);
    return g;
}

static void add_curve(double turns, double radius, double height, double thickness) {
    for (int i = 0; i <= 80; i++) {
        double sine, cosine;
        iso_sincos(i * turns / 80 * 2 * ISO_PI, &sine, &cosine);
        test_lines_add(&scene, radius * cosine, height * (i / 80.0 - 0.5), radius * sine, thickness);
    }
    test_lines_end(&scene);
}

/* Straight lines of all directions, and curves. */
static void make_scene(double thickness) {
    uint32_t seed = 3;
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 8; i++) {
        const double x = 16 * uniform(&seed) - 8, y = 16 * uniform(&seed) - 8, z = 16 * uniform(&seed) - 8;
        test_lines_add(&scene, x, y, z, thickness);
        test_lines_add(&scene, y, z, -x, thickness);
        test_lines_end(&scene);
    }
    add_curve(1.5, 7, 14, thickness);
    add_curve(0.7, 9, 3, thickness);
}

/* ---- measured against the truth */

typedef struct measures {
    size_t drawn, wanted, both, edge; /* samples; edge: of the wanted outline's */
    size_t gaps;                      /* places along the lines that nothing is drawn at */
    double depth, normal;             /* mean errors where both are: radii, degrees */
    double far;                       /* part of the depths that are wrong by more than a radius */
    double width;                     /* pixels by which the drawn outline is wider, on average, */
    double reach;                     /* and at most */
} measures;

static bool is_edge(const bool *wanted, const iso_view *view, int x, int y) {
    const int w = view->width;
    if (!wanted[y * w + x] || x == 0 || y == 0 || x == w - 1 || y == view->height - 1) return false;
    return !wanted[y * w + x - 1] || !wanted[y * w + x + 1] || !wanted[(y - 1) * w + x] ||
           !wanted[(y + 1) * w + x];
}

/* How far a drawn sample is from the nearest wanted one, pixels; at most 16. */
static double distance_to(const bool *wanted, const iso_view *view, int x, int y) {
    enum { FAR = 16 };
    double least = FAR * FAR;
    for (int dy = -FAR; dy <= FAR; dy++)
        for (int dx = -FAR; dx <= FAR; dx++) {
            const int column = x + dx, row = y + dy;
            if (column < 0 || row < 0 || column >= view->width || row >= view->height) continue;
            if (wanted[row * view->width + column]) least = fmin(least, dx * dx + dy * dy);
        }
    return sqrt(least);
}

static double angle_between(const iso_gbuffer *g, size_t sample, const double normal[3]) {
    double dot = 0;
    for (int k = 0; k < 3; k++) dot += (double)g->normal[k][sample] * normal[k];
    return iso_atan2(sqrt(fmax(1 - dot * dot, 0)), dot) * 180 / ISO_PI;
}

/* Places along the segments, a tenth of a pixel apart. */
static size_t count_gaps(const iso_view *view, const iso_gbuffer *g) {
    size_t gaps = 0;
    for (size_t line = 0; line < scene.lines.line_count; line++)
        for (size_t i = scene.lines.starts[line]; i + 1 < scene.lines.starts[line + 1]; i++)
            for (int k = 0; k <= 500; k++) {
                double p[3];
                for (int a = 0; a < 3; a++)
                    p[a] =
                        scene.vertices[i][a] + k / 500.0 * (scene.vertices[i + 1][a] - scene.vertices[i][a]);
                const iso_vec3 at = iso_view_point(view, iso_vec3_make(p[0], p[1], p[2]));
                const double scale = view->orthographic ? view->focal : view->focal / at.z;
                const double x = view->cx + scale * at.x, y = view->cy + scale * at.y;
                if (at.z < view->near || x < 1 || y < 1 || x >= view->width - 1 || y >= view->height - 1)
                    continue;
                bool seen = false; /* a line may pass the corner of a pixel that it does not step on */
                for (int n = 0; n < 9; n++)
                    seen |= isfinite(g->depth[((int)y + n / 3 - 1) * view->width + (int)x + n % 3 - 1]);
                gaps += !seen;
            }
    return gaps;
}

static measures measure(const iso_view *view, const iso_shapes_opts *opts) {
    const iso_shapes_scene judged = {NULL, &scene.lines, *opts};
    const size_t samples = (size_t)view->width * (size_t)view->height;
    iso_error error = {0};
    iso_gbuffer g = drawn(view, opts);
    iso_shapes_truth *truth;
    test_ok(iso_shapes_truth_create(&judged, view, &truth, &error), &error);
    bool *wanted = calloc(samples, sizeof *wanted);
    measures m = {.gaps = count_gaps(view, &g)};
    for (size_t i = 0; i < samples; i++) {
        const iso_shapes_hit hit = iso_shapes_truth_ray(truth, (double)(i % (size_t)view->width) + 0.5,
                                                        (double)(i / (size_t)view->width) + 0.5);
        const bool is_drawn = isfinite(g.depth[i]);
        assert_int_equal(g.surface[i], is_drawn ? SURFACE : ISO_SURFACE_NONE);
        wanted[i] = hit.hit;
        m.drawn += is_drawn;
        m.wanted += hit.hit;
        if (!is_drawn || !hit.hit) continue;
        const double wrong = fabs((double)g.depth[i] - hit.depth) / hit.size;
        m.both++;
        m.depth += fmin(wrong, 1);
        m.far += wrong > 1;
        m.normal += angle_between(&g, i, hit.normal);
    }
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) m.edge += is_edge(wanted, view, x, y);
    for (int i = 0; i < view->width * view->height; i++)
        if (isfinite(g.depth[i]) && !wanted[i])
            m.reach = fmax(m.reach, distance_to(wanted, view, i % view->width, i / view->width));
    m.depth /= (double)m.both;
    m.normal /= (double)m.both;
    m.far /= (double)m.both;
    m.width = ((double)m.drawn - (double)m.wanted) / (double)m.edge;
    free(wanted);
    iso_shapes_truth_destroy(truth);
    iso_gbuffer_free(&g);
    return m;
}

typedef struct bound {
    double pixels;  /* radius */
    double overlap; /* least intersection over union */
    double width;   /* greatest */
    double depth, normal, far;
} bound;

static void check(const bound *b, iso_line_style style, const char *name) {
    for (int parallel = 0; parallel < 2; parallel++) {
        iso_view view = test_shapes_view(scene.lines.origin, AWAY, 24, parallel);
        view = iso_view_scaled(&view, style == ISO_LINE_TUBE ? 3 : 4); /* (rays through tubes take longest) */
        const double thickness = b->pixels * 24 / view.height;
        const iso_shapes_opts opts = {.radius = thickness, .style = style, .min_pixels = 1};
        scene.lines.radii = NULL;
        const measures m = measure(&view, &opts);
        const double overlap = (double)m.both / (double)(m.drawn + m.wanted - m.both);
        print_message(
            "%s of %g px, %s: overlap %.3f, width %+.3f px, depth %.3f r (%.2f %% beyond r), normal "
            "%.1f degrees\n",
            name, b->pixels, parallel ? "parallel" : "perspective", overlap, m.width, m.depth, 100 * m.far,
            m.normal);
        assert_int_equal(m.gaps, 0);
        assert_true(overlap >= b->overlap);
        assert_true(fabs(m.width) <= b->width);
        assert_true(m.depth <= b->depth && m.far <= b->far && m.normal <= b->normal);
    }
}

static void test_tubes(void **state) {
    (void)state;
    const bound bounds[] = {{0.5, 0.9, 0.15, 0.06, 3, 0.01}, /* px, overlap, width, depth, normal, far */
                            {1, 0.95, 0.15, 0.06, 3, 0.01},
                            {2, 0.95, 0.15, 0.06, 4, 0.02},
                            {8, 0.95, 0.3, 0.15, 12, 0.06},
                            {20, 0.95, 1.5, 0.3, 28, 0.1}};
    make_scene(0.2);
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) check(&bounds[i], ISO_LINE_TUBE, "tubes");
}

static void test_ribbons(void **state) {
    (void)state;
    iso_error error = {0};
    const bound bounds[] = {{0.5, 0.65, 0.5, 0.08, 1, 0.02},
                            {1, 0.88, 0.15, 0.06, 1, 0.02},
                            {2, 0.95, 0.1, 0.06, 1, 0.02},
                            {8, 0.93, 0.3, 0.06, 3, 0.02},
                            {20, 0.9, 1.5, 0.1, 8, 0.05}};
    make_scene(0.2);
    test_ok(iso_lines_add_normals(&scene.lines, &error), &error);
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) check(&bounds[i], ISO_LINE_RIBBON, "ribbons");
    iso_free(scene.lines.normals);
}

/* A helix, whose line turns in the picture, and a ribbon that turns once around its line: pixels that
 * averages of what lies before and behind a bend cover stand out of the outline like horns. */
static void test_turning(void **state) {
    (void)state;
    const double bounds[][2] = {{0.5, 1}, {2, 1.2}, {8, 1.5}, {20, 2}}; /* radius, reach; pixels */
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 250; i++) {
        double sine, cosine;
        iso_sincos(i * ISO_PI / 50, &sine, &cosine);
        test_lines_add(&scene, 7 * cosine, 7 * sine, i / 25.0 - 5, 1);
    }
    test_lines_end(&scene);
    scene.lines.radii = NULL;
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        iso_view view = test_shapes_view(scene.lines.origin, AWAY, 24, i & 1);
        view = iso_view_scaled(&view, 4);
        const iso_shapes_opts opts = {.radius = bounds[i][0] * 24 / view.height, .min_pixels = 1};
        const measures m = measure(&view, &opts);
        const double overlap = (double)m.both / (double)(m.drawn + m.wanted - m.both);
        print_message("helix of %g px: overlap %.3f, reach %.2f px, depth %.3f r, normal %.1f degrees\n",
                      bounds[i][0], overlap, m.reach, m.depth, m.normal);
        assert_int_equal(m.gaps, 0);
        assert_true(overlap >= 0.96 && m.reach <= bounds[i][1]);
    }
}

/* A wide tube that turns towards the eye shows its front, not the inside of its far wall. */
static void test_turning_to_eye(void **state) {
    (void)state;
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 100; i++) {
        double sine, cosine;
        iso_sincos(i * ISO_PI / 25, &sine, &cosine);
        test_lines_add(&scene, 8 * cosine, 8 * sine, 0.1 * i - 5, 1);
    }
    test_lines_end(&scene);
    scene.lines.radii = NULL;
    iso_view view = test_shapes_view(scene.lines.origin, iso_vec3_make(0, -90, 30), 24, false);
    view = iso_view_scaled(&view, 2);
    const measures m = measure(&view, &(iso_shapes_opts){.radius = 1, .min_pixels = 1});
    print_message("towards the eye: depth %.4f r (%.2f %% beyond r), normal %.2f degrees\n", m.depth,
                  100 * m.far, m.normal);
    assert_true(m.depth <= 0.02 && m.far <= 0.001 && m.normal <= 2);
}

static void test_twisted(void **state) {
    (void)state;
    float normals[200][3];
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 200; i++) {
        double sine, cosine;
        iso_sincos(i * 2 * ISO_PI / 199, &sine, &cosine);
        test_lines_add(&scene, 20 * i / 199.0 - 10, 0, 0, 1.5);
        normals[i][0] = 0, normals[i][1] = (float)cosine, normals[i][2] = (float)sine;
    }
    test_lines_end(&scene);
    scene.lines.radii = NULL;
    scene.lines.normals = normals;
    const iso_shapes_opts opts = {.radius = 1.5, .style = ISO_LINE_RIBBON, .min_pixels = 1};
    for (int parallel = 0; parallel < 2; parallel++) {
        iso_view view = test_shapes_view(scene.lines.origin, AWAY, 24, parallel);
        view = iso_view_scaled(&view, 4);
        const measures m = measure(&view, &opts);
        const double overlap = (double)m.both / (double)(m.drawn + m.wanted - m.both);
        print_message("twisted ribbon: overlap %.3f, reach %.2f px\n", overlap, m.reach);
        assert_true(overlap >= 0.95 && m.reach <= 4);
    }
    scene.lines.normals = NULL;
}

/* Wide ribbons that lie close over each other, at small angles in the picture: nearer in depth than they are
 * wide, so that only their lines' numbers tell them apart. */
static void test_stacked(void **state) {
    (void)state;
    float normals[16][3];
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 8; i++)
        for (int end = 0; end < 2; end++) {
            test_lines_add(&scene, end ? 9 : -9, (end ? 1 : -1) * (i * 5 % 8 - 3.5) * 0.6, 0.3 * i, 1.5);
            normals[2 * i + end][0] = 0, normals[2 * i + end][1] = 0.3f * (float)(i % 3 - 1);
            normals[2 * i + end][2] = 1;
            if (end) test_lines_end(&scene);
        }
    scene.lines.radii = NULL;
    scene.lines.normals = normals;
    const iso_shapes_opts opts = {.radius = 1.5, .style = ISO_LINE_RIBBON, .min_pixels = 1};
    for (int parallel = 0; parallel < 2; parallel++) {
        iso_view view = test_shapes_view(scene.lines.origin, iso_vec3_make(5, 3, -80), 24, parallel);
        view = iso_view_scaled(&view, 4);
        const measures m = measure(&view, &opts);
        print_message("stacked ribbons: depth %.4f r, normal %.2f degrees, %zu of %zu samples\n", m.depth,
                      m.normal, m.both, m.wanted);
        assert_true(m.depth <= 0.21 && (double)m.both >= 0.98 * (double)m.wanted);
    }
    scene.lines.normals = NULL;
}

/* ---- special places */

/* A line of one pixel before a wall and behind it: coarser pixels know the wall only. */
static void test_line_over_wall(void **state) {
    (void)state;
    const iso_shapes_opts opts = {.radius = 1e-3, .min_pixels = 1};
    for (int parallel = 0; parallel < 2; parallel++)
        for (int behind = 0; behind < 2; behind++) {
            iso_view view = test_shapes_view(iso_vec3_make(0, 0, 0), iso_vec3_make(0, 0, -100), 24, parallel);
            test_lines_start(&scene, 0, 0, 0);
            for (int wall = 0; wall < 2; wall++) { /* the wall is of the same set: thick lines side by side */
                for (int i = wall ? -30 : 0; i <= (wall ? 30 : 0); i++) {
                    const double z = wall ? 0 : behind ? 4 : -4;
                    test_lines_add(&scene, -9, wall ? 0.3 * i : -6, z, wall ? 0.6 : 1e-3);
                    test_lines_add(&scene, 9, wall ? 0.3 * i : 5, z, wall ? 0.6 : 1e-3);
                    test_lines_end(&scene);
                }
            }
            iso_gbuffer g = drawn(&view, &opts);
            size_t seen = 0;
            for (int i = 0; i < view.width * view.height; i++) {
                const double along = isfinite(g.depth[i]) ? (double)g.depth[i] - 100 : 0;
                seen += along < -3.5 && along > -4.5;
                assert_true(along < 0.01);
            }
            if (behind) assert_int_equal(seen, 0);
            if (!behind) assert_true(seen >= 18.0 / 24 * view.height - 2);
            iso_gbuffer_free(&g);
        }
}

/* Tubes that point at the eye: their depths stay near the line's. */
static void test_end_on(void **state) {
    (void)state;
    uint32_t seed = 5;
    const double length = iso_vec3_length(AWAY), away[3] = {AWAY.x, AWAY.y, AWAY.z};
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 40; i++) {
        double p[3], q[3];
        for (int a = 0; a < 3; a++) {
            p[a] = 8 * (2 * uniform(&seed) - 1);
            q[a] = p[a] + 6 * ((away[a] - p[a]) / length + (i < 20 ? 0 : 0.05) * (2 * uniform(&seed) - 1));
        }
        test_lines_add(&scene, p[0], p[1], p[2], 0.5);
        test_lines_add(&scene, q[0], q[1], q[2], 0.5);
        test_lines_end(&scene);
    }
    const iso_shapes_opts opts = {.radius = 0.5, .min_pixels = 1};
    for (int parallel = 0; parallel < 2; parallel++) {
        iso_view view = test_shapes_view(scene.lines.origin, AWAY, 24, parallel);
        view = iso_view_scaled(&view, 3);
        const measures m = measure(&view, &opts);
        print_message("end on: %zu of %zu, %zu drawn, depth %.2f r (%.1f %%)\n", m.both, m.wanted, m.drawn,
                      m.depth, 100 * m.far);
        assert_int_equal(m.gaps, 0);
        assert_true((double)m.both > 0.8 * (double)m.wanted && (double)m.both > 0.8 * (double)m.drawn);
    }
}

/* The eye among the lines, and the near plane through them: nothing far before it, or not finite. */
static void test_near(void **state) {
    (void)state;
    make_scene(0.5);
    const iso_shapes_opts opts = {.min_pixels = 1};
    for (int parallel = 0; parallel < 2; parallel++)
        for (int cut = 0; cut < 2; cut++) {
            iso_view view = test_shapes_view(scene.lines.origin, iso_vec3_make(4, -3, 5), 12, parallel);
            if (cut) view.near = 7;
            iso_gbuffer g = drawn(&view, &opts);
            size_t seen = 0;
            for (int i = 0; i < view.width * view.height; i++) {
                if (g.surface[i] != SURFACE) continue;
                seen++;
                assert_true(isfinite(g.depth[i]) && (double)g.depth[i] > view.near - 40 * 0.5);
                near(g.normal[0][i] * g.normal[0][i] + g.normal[1][i] * g.normal[1][i] +
                         g.normal[2][i] * g.normal[2][i],
                     1, 1e-3);
            }
            assert_true(seen > 0);
            iso_gbuffer_free(&g);
        }
}

/* Lines beside each other, nearer than their radius, every second one tilted the other way: coarser pixels
 * mix the tangents of neighbours, or as ribbons their normals. `reversed`: every second line is stored from
 * its other end, with its normals reversed. */
static void make_neighbours(iso_line_style style, bool reversed) {
    iso_error error = {0};
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 40; i++)
        for (int end = 0; end < 2; end++) {
            const int other = reversed && i % 2 ? !end : end;
            const double tilt = (other ? 1.2 : -1.2) * (i % 2 ? 1 : -1);
            test_lines_add(&scene, other ? 8 : -8, 0.2 * i - 4 + tilt, 0.02 * i, 0.6);
            if (end) test_lines_end(&scene);
        }
    if (style == ISO_LINE_TUBE) return;
    test_ok(iso_lines_add_normals(&scene.lines, &error), &error);
    for (size_t i = 0; i < scene.lines.vertex_count; i++)
        for (int k = 0; k < 3; k++)
            scene.lines.normals[i][k] = (k == 2                ? 1
                                         : k == 1 && i / 2 % 2 ? 0.3f
                                                               : 0) *
                                        (reversed && i / 2 % 2 ? -1.0f : 1.0f);
}

/* Tangents and normals have no sign: the same lines in the same places give the same picture when some are
 * stored in the other direction. Fragments at other places of a line's ends leave small differences. */
static void test_reversed(void **state) {
    (void)state;
    iso_view view = test_shapes_view(iso_vec3_make(0, 0, 0), AWAY, 24, false);
    view = iso_view_scaled(&view, 3);
    for (int style = ISO_LINE_TUBE; style <= ISO_LINE_RIBBON; style++) {
        const iso_shapes_opts opts = {.radius = 0.6, .min_pixels = 1, .style = (iso_line_style)style};
        iso_gbuffer g[2];
        for (int reversed = 0; reversed < 2; reversed++) {
            make_neighbours(opts.style, reversed);
            g[reversed] = drawn(&view, &opts);
            iso_free(scene.lines.normals);
            scene.lines.normals = NULL;
        }
        size_t other = 0, seen = 0, deep = 0;
        double turned = 0;
        for (size_t i = 0; i < (size_t)view.width * (size_t)view.height; i++) {
            other += g[0].surface[i] != g[1].surface[i];
            if (g[0].surface[i] != SURFACE || g[1].surface[i] != SURFACE) continue;
            double normal[3];
            for (int k = 0; k < 3; k++) normal[k] = (double)g[0].normal[k][i];
            seen++;
            deep += fabsf(g[0].depth[i] - g[1].depth[i]) > 0.06f;
            turned += angle_between(&g[1], i, normal);
        }
        print_message("reversed %s: %zu samples, %zu other, %zu deeper, normals turned by %.3f degrees\n",
                      style ? "ribbons" : "tubes", seen, other, deep, turned / (double)seen);
        assert_true(seen > 1000 && other * 100 <= seen && deep * 100 <= seen);
        assert_true(turned / (double)seen < 1);
        iso_gbuffer_free(&g[0]);
        iso_gbuffer_free(&g[1]);
    }
}

/* ---- illuminated lines */

/* The direction to the key light without its part along a tangent, unit. */
static iso_vec3 illuminated_normal(iso_vec3 tangent) {
    const iso_vec3 light = {(double)ISO_PHONG_LIGHT_X, (double)ISO_PHONG_LIGHT_Y, (double)ISO_PHONG_LIGHT_Z};
    const double along = iso_vec3_dot(light, tangent);
    return iso_vec3_unit(iso_vec3_sub(light, iso_vec3_scale(tangent, along)));
}

/* One straight tube: its normals are the light's projection, computed from its two vertices; depths and
 * outline are those of a tube that is shaded as round. */
static void check_illuminated(const iso_view *view, const float ends[2][3], double *worst) {
    const iso_shapes_opts round = {.radius = 0.5, .min_pixels = 1},
                          lit = {.radius = 0.5, .min_pixels = 1, .shading = ISO_LINE_ILLUMINATED};
    iso_vec3 along = {(double)(ends[1][0] - ends[0][0]), (double)(ends[1][1] - ends[0][1]),
                      (double)(ends[1][2] - ends[0][2])};
    along = iso_vec3_unit(iso_view_vector(view, along));
    const iso_vec3 wanted = illuminated_normal(along);
    iso_gbuffer a = drawn(view, &round), b = drawn(view, &lit);
    size_t seen = 0, round_differ = 0;
    for (size_t i = 0; i < (size_t)view->width * (size_t)view->height; i++) {
        assert_int_equal(a.surface[i], b.surface[i]);
        if (b.surface[i] != SURFACE) continue;
        assert_true(a.depth[i] == b.depth[i]);
        const double cosine = iso_vec3_dot(iso_gbuffer_normal(&b, i), wanted);
        *worst = fmax(*worst, iso_atan2(sqrt(fmax(1 - cosine * cosine, 0)), cosine) * 180 / ISO_PI);
        round_differ += iso_vec3_dot(iso_gbuffer_normal(&a, i), wanted) < 0.9;
        seen++;
    }
    assert_true(seen > 100 && round_differ * 4 > seen);
    iso_gbuffer_free(&a);
    iso_gbuffer_free(&b);
}

static void test_illuminated(void **state) {
    (void)state;
    uint32_t seed = 11;
    double worst = 0;
    for (int i = 0; i < 24; i++) {
        iso_view view = test_shapes_view(iso_vec3_make(0, 0, 0), AWAY, 24, i & 1);
        view = iso_view_scaled(&view, 3);
        double p[3], size = 0;
        for (int k = 0; k < 3; k++) {
            p[k] = 2 * uniform(&seed) - 1;
            size += p[k] * p[k];
        }
        test_lines_start(&scene, 0, 0, 0);
        for (int end = -1; end <= 1; end += 2) {
            const double reach = 8 * end / sqrt(size);
            test_lines_add(&scene, reach * p[0], reach * p[1], reach * p[2], 0.5);
        }
        test_lines_end(&scene);
        check_illuminated(&view, (const float(*)[3])scene.vertices, &worst);
    }
    print_message("illuminated lines: normals within %.2f degrees of the light's projection\n", worst);
    assert_true(worst <
                0.5); /* tangents are stored in 22 bits; a line along the light enlarges their error */
}

/* ---- the same bytes */

static void test_same_bytes(void **state) {
    (void)state;
    uint32_t seed = 7;
    iso_error error = {0};
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 80; i++) test_lines_add_walk(&scene, 1 + i % 30, 8, 1.5, 0, 0.7, &seed);
    scene.lines.colors = scene.colors;
    test_ok(iso_lines_add_normals(&scene.lines, &error), &error);
    for (int kind = 0; kind < 8; kind++) {
        const iso_vec3 away = kind & 1 ? iso_vec3_make(1, 2, -4) : AWAY;
        iso_view view = test_shapes_view(scene.lines.origin, away, kind & 1 ? 5 : 24, kind & 2);
        view = iso_view_scaled(&view, kind & 1 ? 1 : 2);
        const iso_shapes_opts opts = {
            .min_pixels = 1, .caps = ISO_CAPS_FLAT, .style = kind & 4 ? ISO_LINE_RIBBON : ISO_LINE_TUBE};
        iso_pyramid_lines *lines = prepare(&opts);
        iso_gbuffer wanted = draw_lines(lines, &view, NULL);
        test_variants_of(draw_lines, lines, &view, &wanted);
        test_strips_of(draw_lines, lines, &view, 7, &wanted);
        iso_gbuffer_free(&wanted);
        iso_pyramid_lines_destroy(lines);
    }
    iso_free(scene.lines.normals);
}

/* Whether a sample within a pixel of (x, y) is covered. */
static bool is_covered_near(const iso_gbuffer *g, int x, int y) {
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            const int at = (y + dy) * g->width + x + dx;
            if (x + dx >= 0 && x + dx < g->width && y + dy >= 0 && y + dy < g->height &&
                g->depth[at] < INFINITY)
                return true;
        }
    return false;
}

/* Vertices of dense lines, of which many are in a pixel, are dropped: the picture is another one, but a
 * sample that only one of the two covers has covered ones beside it; and it has the same bytes for all
 * threads and strips. */
static void test_dropping(void **state) {
    (void)state;
    iso_error error = {0};
    uint32_t seed = 11;
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 40; i++) test_lines_add_walk(&scene, 90, 9, 0.25, 0.05, 0.3, &seed);
    test_ok(iso_lines_add_normals(&scene.lines, &error), &error);
    for (int kind = 0; kind < 4; kind++) {
        iso_view view = test_shapes_view(scene.lines.origin, AWAY, 24, kind & 2);
        const iso_shapes_opts all = {.min_pixels = 1, .style = kind & 1 ? ISO_LINE_RIBBON : ISO_LINE_TUBE};
        iso_shapes_opts some = all;
        some.drop_pixels = 0.5;
        iso_pyramid_lines *lines = prepare(&some);
        iso_gbuffer wanted = drawn(&view, &all), g = draw_lines(lines, &view, NULL);
        int differ = 0;
        for (int i = 0; i < view.width * view.height; i++) {
            const int x = i % view.width, y = i / view.width;
            differ += g.depth[i] != wanted.depth[i];
            if (g.depth[i] < INFINITY) assert_true(is_covered_near(&wanted, x, y));
            if (wanted.depth[i] < INFINITY) assert_true(is_covered_near(&g, x, y));
        }
        assert_true(differ > 0);
        test_variants_of(draw_lines, lines, &view, &g);
        test_strips_of(draw_lines, lines, &view, 7, &g);
        iso_gbuffer_free(&wanted);
        iso_gbuffer_free(&g);
        iso_pyramid_lines_destroy(lines);
    }
    iso_free(scene.lines.normals);
}

static void test_bad_lines(void **state) {
    (void)state;
    const float bad[] = {NAN, INFINITY, -1};
    const iso_view view = test_shapes_view(iso_vec3_make(0, 0, 0), AWAY, 24, false);
    iso_error error = {0};
    iso_pyramid_lines *lines;
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 5; k++) test_lines_add(&scene, k, i, 0, 0.3);
        test_lines_end(&scene);
        scene.radii[5 * i + 2] = bad[i];
    }
    for (int k = 0; k < 4; k++) test_lines_add(&scene, 1, 5, 0, 0.1); /* in one place */
    test_lines_end(&scene);
    test_lines_add(&scene, 2, 2, 2, 1);
    test_lines_end(&scene); /* no segment */
    scene.vertices[4][1] = NAN;
    const iso_shapes_opts opts = {.radius = 1, .min_pixels = 1}, none = {.radius = 0},
                          ribbon = {.radius = 1, .style = ISO_LINE_RIBBON};
    iso_gbuffer g = drawn(&view, &opts);
    for (int i = 0; i < view.width * view.height; i++) assert_false(isnan(g.depth[i]));
    iso_gbuffer_free(&g);
    scene.lines.radii = NULL;
    assert_int_equal(iso_pyramid_lines_create(&scene.lines, &none, &lines, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_pyramid_lines_create(&scene.lines, &ribbon, &lines, &error), ISO_ERR_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tubes),      cmocka_unit_test(test_ribbons),
        cmocka_unit_test(test_turning),    cmocka_unit_test(test_turning_to_eye),
        cmocka_unit_test(test_twisted),    cmocka_unit_test(test_line_over_wall),
        cmocka_unit_test(test_end_on),     cmocka_unit_test(test_near),
        cmocka_unit_test(test_reversed),   cmocka_unit_test(test_illuminated),
        cmocka_unit_test(test_same_bytes), cmocka_unit_test(test_dropping),
        cmocka_unit_test(test_bad_lines),  cmocka_unit_test(test_stacked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
