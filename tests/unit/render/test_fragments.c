/* Translucent glyphs and lines against every layer of rays in extended precision: alone, among the layers
 * of isosurfaces, in front of opaque shapes, from inside; joints that are not darker; and the same bytes
 * for every instruction set, number of threads and strip. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/cpu.h"
#include "base/memory.h"
#include "check_support.h"
#include "exact/layers.h"
#include "exact_support.h"
#include "lines_support.h"
#include "render/raster/triangles.h"
#include "render/shapes/fragments.h"
#include "scene_support.h"
#include "shapes_support.h"
#include "truth/raycast_layers.h"
#include "view_support.h"

/* ---- scenes */

enum { SETS = 3, SURFACES = 3, SIDE = 56, MOST_LAYERS = 4000 };

/* Translucent sets, perhaps with translucent isosurfaces and an opaque set. */
typedef struct mixed {
    iso_shapes_scene sets[SETS];
    iso_translucency translucency[SETS];
    int count;
    bool has_mesh;                  /* the last set is `spans` */
    const iso_shapes_scene *opaque; /* NULL: none */
    const iso_grid *grid;           /* NULL: no isosurfaces */
    double isovalues[SURFACES];
    iso_translucency surface;
    int surfaces;
    const iso_clip *clip; /* of the sets; NULL: none */
} mixed;

static const iso_rgb set_colors[SETS] = {{0xC0, 0x39, 0x2B}, {0x27, 0x8E, 0x60}, {0x29, 0x80, 0xB9}},
                     surface_colors[SURFACES + 1] = {
                         {0xE8, 0xB9, 0xA0}, {0x3F, 0x6F, 0xA8}, {0x5B, 0x8E, 0x4B}, {0xD0, 0xB0, 0x20}};

static iso_triangle_spans spans;

static iso_shading shading(void) {
    return (iso_shading){surface_colors, SURFACES + 1, {250, 245, 240}, false, {0, 0, 0}};
}

typedef struct picture {
    iso_image image;
    float *counts, *coverage;
    iso_shapes_layered drawn[SETS];
} picture;

static picture make_picture(int width, int height) {
    picture p = {.counts = NULL};
    iso_error error = {0};
    test_ok(iso_image_create(width, height, &p.image, &error), &error);
    p.counts = calloc((size_t)(width * height), sizeof *p.counts);
    p.coverage = calloc((size_t)(width * height), sizeof *p.coverage);
    assert_true(p.counts && p.coverage);
    return p;
}

static void free_picture(picture *p) {
    iso_image_free(&p->image);
    free(p->counts);
    free(p->coverage);
}

static iso_gbuffer opaque_of(const mixed *m, const iso_view *view) {
    if (!m->opaque) return (iso_gbuffer){.width = view->width, .height = view->height};
    iso_shapes *shapes = test_shapes_make(m->opaque);
    iso_gbuffer g = test_shapes_drawn(view, shapes, NULL);
    iso_shapes_destroy(shapes);
    return g;
}

/* Draws a strip of the picture. */
static void draw(const mixed *m, const iso_strip *strip, iso_pool *pool, picture *p) {
    iso_translucent_set sets[SETS];
    iso_exact_layer layers[SURFACES];
    iso_shapes_lister *lister;
    iso_error error = {0};
    const iso_shading shaded = shading();
    for (int i = 0; i < m->count; i++)
        sets[i] = (iso_translucent_set){
            .shapes = m->has_mesh && i + 1 == m->count ? NULL : test_shapes_make(&m->sets[i]),
            .mesh = iso_triangle_spans_view(&spans),
            .color = set_colors[i],
            .translucency = m->translucency[i],
            .drawn = &p->drawn[i],
            .clip = m->clip};
    for (int i = 0; i < m->surfaces; i++)
        layers[i] = (iso_exact_layer){make_exact(m->grid, m->isovalues[i], NULL), surface_colors[i],
                                      m->surface, NULL, NULL};
    test_ok(iso_shapes_lister_create(sets, m->count, m->surfaces, strip, pool, &lister, &error), &error);
    const iso_layer_source source = iso_shapes_lister_source(lister);
    const iso_exact_layers input = {.layers = layers,
                                    .count = m->surfaces,
                                    .picture = {strip, &shaded, &p->image, p->counts, p->coverage, pool},
                                    .source = &source,
                                    .middle = iso_translucent_middle(sets, m->count, strip->view)};
    iso_exact_layers_totals totals = {.retraced = 0};
    test_ok(iso_shade_exact_layers(&input, &totals, &error), &error);
    iso_shapes_lister_destroy(lister);
    for (int i = 0; i < m->count; i++) iso_shapes_destroy((iso_shapes *)sets[i].shapes); /* NULL: a mesh */
    for (int i = 0; i < m->surfaces; i++) iso_exact_destroy((iso_exact *)layers[i].exact);
}

static picture picture_of_scene(const mixed *m, const iso_view *view, int factor, iso_pool *pool) {
    picture p = make_picture(view->width / factor, view->height / factor);
    iso_gbuffer opaque = opaque_of(m, view);
    const iso_strip strip = {view, &opaque, factor, 0};
    draw(m, &strip, pool, &p);
    if (opaque.depth) iso_gbuffer_free(&opaque);
    return p;
}

/* ---- the truth */

/* A layer with what compositing needs. */
typedef struct layer {
    double depth, opacity;
    float rgb[3];
} layer;

typedef struct truth {
    const mixed *m;
    const iso_view *view;
    iso_shapes_truth *sets[SETS];
    layer *surfaces; /* by sample, MOST_SURFACE of them */
    int *surface_counts;
    iso_gbuffer opaque;
} truth;

enum { MOST_SURFACE = 64 };

/* iso_raycast_reader.read. */
static void read_crossing(void *context, int x, int y, const iso_raycast_crossing *crossing) {
    truth *t = context;
    const int sample = y * t->view->width + x, at = t->surface_counts[sample]++;
    assert_true(at < MOST_SURFACE);
    layer *to = &t->surfaces[sample * MOST_SURFACE + at];
    *to = (layer){crossing->depth, crossing->opacity, {0}};
    memcpy(to->rgb, crossing->rgb, sizeof to->rgb);
}

static void trace_surfaces(truth *t) {
    iso_raycast_layer layers[SURFACES];
    iso_error error = {0};
    iso_gbuffer size = {.width = t->view->width, .height = t->view->height};
    const iso_strip strip = {t->view, &size, 1, 0};
    const size_t samples = (size_t)(size.width * size.height);
    t->surfaces = calloc(samples * MOST_SURFACE, sizeof *t->surfaces);
    t->surface_counts = calloc(samples, sizeof *t->surface_counts);
    for (int i = 0; i < t->m->surfaces; i++) {
        iso_raycaster *caster;
        test_ok(iso_raycaster_create(t->m->grid, t->m->isovalues[i], NULL, &caster, &error), &error);
        layers[i] = (iso_raycast_layer){caster, surface_colors[i], t->m->surface, NULL, NULL};
    }
    const iso_raycast_layers input = {layers, t->m->surfaces, {.strip = &strip}};
    const iso_raycast_reader reader = {read_crossing, t};
    if (t->m->surfaces) iso_read_raycast_layers(&input, &reader);
    for (int i = 0; i < t->m->surfaces; i++) iso_raycaster_destroy((iso_raycaster *)layers[i].caster);
}

static truth truth_make(const mixed *m, const iso_view *view) {
    truth t = {.m = m, .view = view, .opaque = opaque_of(m, view)};
    iso_error error = {0};
    for (int i = 0; i < m->count; i++)
        test_ok(iso_shapes_truth_create(&m->sets[i], view, &t.sets[i], &error), &error);
    trace_surfaces(&t);
    return t;
}

static void truth_free(truth *t) {
    for (int i = 0; i < t->m->count; i++) iso_shapes_truth_destroy(t->sets[i]);
    if (t->opaque.depth) iso_gbuffer_free(&t->opaque);
    free(t->surfaces);
    free(t->surface_counts);
}

static double opacity_of(const iso_translucency *translucency, const double normal[3], const double ray[3]) {
    const double opacity = (double)translucency->opacity;
    if (translucency->constant) return opacity;
    double dot = 0, square = 0;
    for (int a = 0; a < 3; a++) dot += normal[a] * ray[a], square += ray[a] * ray[a];
    return 1 - pow(1 - opacity, sqrt(square) / fmax(fabs(dot), 1e-6 * sqrt(square)));
}

/* Inserts a layer by its depth; of equal depths the earlier one stays in front. */
static void insert(layer *layers, int count, const layer *l) {
    for (; count > 0 && layers[count - 1].depth > l->depth; count--) layers[count] = layers[count - 1];
    layers[count] = *l;
}

static iso_rgb color_of(const mixed *m, int set, size_t shape) {
    const iso_glyphs *glyphs = m->sets[set].glyphs;
    if (!glyphs || !glyphs->colors) return set_colors[set];
    return (iso_rgb){glyphs->colors[shape][0], glyphs->colors[shape][1], glyphs->colors[shape][2]};
}

/* Adds the layers of a set; returns the new number. */
static int add_set(truth *t, int set, double px, double py, layer *layers, int count) {
    static iso_shapes_layer found[MOST_LAYERS];
    const iso_view *v = t->view;
    const double ray[3] = {v->orthographic ? 0 : (px - v->cx) / v->focal,
                           v->orthographic ? 0 : (py - v->cy) / v->focal, 1};
    const float to_eye[3] = {(float)-ray[0], (float)-ray[1], -1};
    const size_t n = iso_shapes_truth_layers(t->sets[set], px, py, found, MOST_LAYERS);
    const int most = t->m->translucency[set].most_layers;
    assert_true(n < MOST_LAYERS);
    int own = 0;
    for (size_t i = 0; i < n && (!most || own < most); i++) {
        if (!test_shapes_left(t->m->clip, v, px, py, found[i].depth)) continue;
        own++;
        layer l = {found[i].depth, opacity_of(&t->m->translucency[set], found[i].normal, ray), {0}};
        const float normal[3] = {(float)found[i].normal[0], (float)found[i].normal[1],
                                 (float)found[i].normal[2]};
        iso_shade_sample(normal, to_eye, color_of(t->m, set, found[i].shape), l.rgb);
        assert_true(count < MOST_LAYERS);
        insert(layers, count++, &l);
    }
    return count;
}

typedef struct seen {
    double rgb[3], through;
    int layers;
} seen;

/* What a ray sees. The opaque set and the isosurfaces are those of the sample (x, y). */
static seen look(truth *t, int x, int y, double px, double py) {
    static layer layers[MOST_LAYERS];
    const int sample = y * t->view->width + x;
    const iso_shading shaded = shading();
    const float limit = t->opaque.depth ? t->opaque.depth[sample] : INFINITY;
    int count = 0;
    for (int i = 0; i < t->surface_counts[sample]; i++)
        insert(layers, count++, &t->surfaces[sample * MOST_SURFACE + i]);
    for (int i = 0; i < t->m->count; i++) count = add_set(t, i, px, py, layers, count);
    seen s = {.through = 1};
    for (int i = 0; i < count && layers[i].depth < (double)limit; i++) {
        for (int k = 0; k < 3; k++) s.rgb[k] += s.through * layers[i].opacity * (double)layers[i].rgb[k];
        s.through *= 1 - layers[i].opacity;
        s.layers++;
    }
    float back[3] = {250 / 255.0f, 245 / 255.0f, 240 / 255.0f};
    if (isfinite(limit)) {
        const float normal[3] = {t->opaque.normal[0][sample], t->opaque.normal[1][sample],
                                 t->opaque.normal[2][sample]},
                    to_eye[3] = {
                        t->view->orthographic ? 0 : (float)-((x + 0.5 - t->view->cx) / t->view->focal),
                        t->view->orthographic ? 0 : (float)-((y + 0.5 - t->view->cy) / t->view->focal), -1};
        iso_shade_sample(normal, to_eye, shaded.colors[3], back);
    }
    for (int k = 0; k < 3; k++) s.rgb[k] = 255 * (s.rgb[k] + s.through * (double)back[k]);
    return s;
}

/* Whether rays through positions up to 1e-3 pixel beside a sample's centre see something else: another number
 * of layers, or a colour that the picture may have. */
static bool is_grazing(truth *t, int x, int y, const seen *plain) {
    for (int way = 0; way < 9; way++) {
        const seen s = look(t, x, y, x + 0.5 + (way % 3 - 1) * 1e-3, y + 0.5 + (way / 3 - 1) * 1e-3);
        if (s.layers != plain->layers) return true;
        for (int k = 0; k < 3; k++)
            if (fabs(s.rgb[k] - plain->rgb[k]) > 0.25) return true;
    }
    return false;
}

/* A picture is wrong where a colour differs by more than a level (and what rounding and the cut add), or
 * where the number of layers does and all of them can be seen. */
static void compare(const mixed *m, const iso_view *view, const char *name) {
    picture p = picture_of_scene(m, view, 1, NULL);
    truth t = truth_make(m, view);
    size_t layers = 0, covered = 0, grazing = 0, plain = 0;
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            const int at = y * view->width + x;
            const seen s = look(&t, x, y, x + 0.5, y + 0.5);
            bool wrong = s.through > 4 * (double)ISO_LAYER_CUT && s.layers != (int)p.counts[at];
            for (int k = 0; k < 3; k++)
                wrong |= fabs(s.rgb[k] - p.image.rgba[4 * at + k]) > 1 + 255 * (double)ISO_LAYER_CUT;
            covered += s.layers > 0;
            layers += (size_t)s.layers;
            if (!wrong) continue;
            grazing += is_grazing(&t, x, y, &s);
            plain += !is_grazing(&t, x, y, &s);
        }
    if (!covered || plain || grazing > layers / 1000 + 2)
        fail_msg("%s: of %zu samples with %zu layers %zu grazing and %zu other ones are wrong", name, covered,
                 layers, grazing, plain);
    truth_free(&t);
    free_picture(&p);
}

static void compare_views(const mixed *m, iso_vec3 origin, iso_vec3 away, double height, const char *name) {
    char text[128];
    for (int kind = 0; kind < 3; kind++) {
        const iso_view view = test_shapes_view(origin, kind == 2 ? iso_vec3_scale(away, 0.03) : away,
                                               height * (kind == 2 ? 0.1 : 1), kind == 1);
        snprintf(text, sizeof text, "%s, %s", name,
                 kind == 0   ? "perspective"
                 : kind == 1 ? "parallel"
                             : "from inside");
        compare(m, &view, text);
    }
}

/* ---- what is cut */

static void compare_clipped(const mixed *whole, iso_vec3 origin, iso_vec3 away, const char *name) {
    const iso_clip clip = test_shapes_clip(iso_vec3_add(origin, iso_vec3_make(0.1, 0.2, 0.3)));
    const iso_view view = test_shapes_view(origin, away, 18, false);
    mixed m = *whole;
    m.clip = &clip;
    compare(&m, &view, name);
}

/* ---- glyphs */

enum { GLYPHS = 2000, MANY = 400 };

static float positions[GLYPHS][3], radii[GLYPHS], directions[GLYPHS][3], axes[GLYPHS][9];
static uint8_t glyph_colors[GLYPHS][3];

/* Glyphs of all kinds of sizes and directions in the box +-8. */
static iso_glyphs make_glyphs(int count, double size, iso_vec3 origin, uint32_t seed) {
    for (int i = 0; i < count; i++) {
        double turn[3][3];
        for (int k = 0; k < 9; k++) turn[k / 3][k % 3] = uniform(&seed) - 0.5;
        for (int a = 0; a < 3; a++) {
            positions[i][a] = (float)(16 * uniform(&seed) - 8);
            directions[i][a] = (float)(3 * size * (2 * uniform(&seed) - 1));
            glyph_colors[i][a] = (uint8_t)(255 * uniform(&seed));
            for (int k = 0; k < 3; k++) axes[i][3 * a + k] = (float)(size * (turn[a][k] + (a == k)));
        }
        radii[i] = (float)(size * (0.3 + uniform(&seed)));
    }
    return (iso_glyphs){.origin = origin,
                        .positions = positions,
                        .radii = radii,
                        .directions = directions,
                        .axes = axes,
                        .colors = glyph_colors,
                        .count = (size_t)count};
}

static const iso_vec3 AWAY = {60, 35, -80};

static void test_glyphs(void **state) {
    (void)state;
    for (int glyph = 0; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_vec3 origin = {glyph == 2 ? 1e6 : 0, 5, 0};
        const iso_glyphs glyphs = make_glyphs(150, 1, origin, (uint32_t)glyph + 1);
        const mixed m = {.sets = {{&glyphs, NULL, {.glyph = (iso_glyph)glyph}}},
                         .translucency = {{.opacity = 0.3f, .constant = glyph % 2 == 1}},
                         .count = 1};
        char name[32];
        snprintf(name, sizeof name, "glyph %d", glyph);
        compare_views(&m, origin, AWAY, 18, name);
        compare_clipped(&m, origin, AWAY, name);
    }
}

/* Translucent billboards cover the samples that opaque ones do; the two are computed in doubles and in
 * floats. */
static void test_billboards(void **state) {
    (void)state;
    for (int glyph = 0; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_vec3 origin = {0, 0, 0};
        const iso_glyphs glyphs = make_glyphs(40, 1, origin, (uint32_t)glyph + 21);
        const iso_shapes_opts opts = {.glyph = (iso_glyph)glyph,
                                      .projection = ISO_GLYPH_PROJECTION_BILLBOARD};
        const mixed m = {.sets = {{&glyphs, NULL, opts}}, .translucency = {{.opacity = 0.3f}}, .count = 1};
        const iso_view view = test_shapes_view(origin, iso_vec3_make(12, 7, -16), 18, false);
        picture p = picture_of_scene(&m, &view, 1, NULL);
        iso_shapes *shapes = test_shapes_make(&m.sets[0]);
        iso_gbuffer g = test_shapes_drawn(&view, shapes, NULL);
        size_t differ = 0, covered = 0;
        for (int i = 0; i < view.width * view.height; i++) {
            covered += p.counts[i] > 0;
            differ += (p.counts[i] > 0) != (isfinite(g.depth[i]) != 0);
        }
        assert_true(covered > 100 && differ <= 2);
        iso_gbuffer_free(&g);
        iso_shapes_destroy(shapes);
        free_picture(&p);
    }
}

/* More pieces than a part of a band has room for. */
static void test_many_pieces(void **state) {
    (void)state;
    const iso_vec3 origin = {0, 0, 0};
    const iso_glyphs glyphs = make_glyphs(MANY, 12, origin, 7);
    const mixed m = {.sets = {{&glyphs, NULL, {.glyph = ISO_GLYPH_SPHERE}}},
                     .translucency = {{.opacity = 0.005f, .constant = true}},
                     .count = 1};
    const iso_view view = test_shapes_view(origin, AWAY, 12, true);
    picture p = picture_of_scene(&m, &view, 1, NULL);
    assert_true(p.drawn[0].layers > ISO_SHAPES_PIECES_BYTES / 64);
    assert_true(p.drawn[0].samples == (size_t)view.width * (size_t)view.height);
    free_picture(&p);
    compare(&m, &view, "many pieces");
}

/* Blocks of glyphs behind each other, so that crossings are used before all glyphs are listed. */
static void test_several_blocks(void **state) {
    (void)state;
    const iso_vec3 origin = {0, 0, 0};
    for (int most = 0; most < 4; most = 2 * most + 1) {
        const iso_glyphs glyphs = make_glyphs(GLYPHS, 1, origin, 31 + (uint32_t)most);
        const iso_glyph kind = most % 2 ? ISO_GLYPH_SPHERE : ISO_GLYPH_CYLINDER;
        const mixed m = {.sets = {{&glyphs, NULL, {.glyph = kind}}},
                         .translucency = {{.opacity = 0.03f, .constant = true, .most_layers = most}},
                         .count = 1};
        const iso_view view = test_shapes_view(origin, AWAY, 14, most == 3);
        compare(&m, &view, "several blocks");
    }
}

/* ---- lines */

static test_lines lines, other_lines;

static void add_walks(test_lines *set, int count, int steps, double step, double low, double high,
                      uint32_t seed) {
    test_lines_start(set, 0, 0, 0);
    for (int i = 0; i < count; i++) test_lines_add_walk(set, steps, 8, step, low, high, &seed);
}

static void test_tubes(void **state) {
    (void)state;
    add_walks(&lines, 30, 20, 2, 0.1, 0.9, 3);
    for (int kind = 0; kind < 4; kind++) {
        const mixed m = {.sets = {{NULL, &lines.lines, {.radius = 0.4, .caps = (iso_caps)(kind % 2)}}},
                         .translucency = {{.opacity = 0.3f, .constant = kind >= 2}},
                         .count = 1};
        lines.lines.radii = kind % 2 ? NULL : lines.radii;
        compare_views(&m, lines.lines.origin, AWAY, 18, kind % 2 ? "even tubes" : "tapered tubes");
        compare_clipped(&m, lines.lines.origin, AWAY, "tubes that are cut");
    }
    /* as wide as a sample, where they are thinner */
    const mixed wide = {.sets = {{NULL, &lines.lines, {.radius = 0.01, .min_pixels = 3}}},
                        .translucency = {{.opacity = 0.5f}},
                        .count = 1};
    compare_views(&wide, lines.lines.origin, AWAY, 18, "least width");
}

static void test_ribbons(void **state) {
    (void)state;
    iso_error error = {0};
    add_walks(&lines, 25, 15, 2.5, 0.3, 1, 4);
    iso_lines drawn = lines.lines;
    drawn.normals = NULL;
    test_ok(iso_lines_add_normals(&drawn, &error), &error);
    const mixed m = {.sets = {{NULL, &drawn, {.style = ISO_LINE_RIBBON}}},
                     .translucency = {{.opacity = 0.4f, .constant = true}},
                     .count = 1};
    compare_views(&m, drawn.origin, AWAY, 18, "ribbons");
    compare_clipped(&m, drawn.origin, AWAY, "ribbons that are cut");
    iso_free(drawn.normals);
}

/* Adds a line in the plane y = 0 through the origin, which rises by `slope`. */
static void add_straight(test_lines *set, int segments, double slope) {
    for (int i = 0; i <= segments; i++) {
        const double x = 16.0 * i / segments - 8;
        test_lines_add(set, x, 0, slope * x, 1.9); /* no edge of it is at the centre of a sample */
    }
    test_lines_end(set);
}

/* Draws both sets of lines from one side: the same pictures, nowhere with more than `most` layers. */
static void compare_joints(const mixed *cut, const mixed *whole, const iso_view *view, float most) {
    picture p = picture_of_scene(cut, view, 1, NULL), wanted = picture_of_scene(whole, view, 1, NULL);
    const size_t pixels = (size_t)view->width * (size_t)view->height;
    assert_memory_equal(p.counts, wanted.counts, pixels * sizeof *p.counts);
    for (size_t k = 0; k < 4 * pixels; k++) assert_true(abs(p.image.rgba[k] - wanted.image.rgba[k]) <= 1);
    for (size_t k = 0; k < pixels; k++) assert_true(p.counts[k] <= most);
    assert_true(p.drawn[0].samples > pixels / 10);
    free_picture(&p);
    free_picture(&wanted);
}

/* A line of many short segments is the line with two vertices: nowhere are there more than two layers, or
 * one of a ribbon, also where rays meet the edge that two patches share. */
static void test_joints(void **state) {
    (void)state;
    static const double slopes[] = {0, 0.37, 1};
    static float normals[TEST_LINES_VERTICES][3];
    for (int kind = 0; kind < 6; kind++) {
        const double slope = slopes[kind / 2], scale = 1 / sqrt(1 + slope * slope);
        const bool ribbon = kind % 2;
        const iso_shapes_opts opts = {.radius = 2, .style = ribbon ? ISO_LINE_RIBBON : ISO_LINE_TUBE};
        mixed cut = {.sets = {{NULL, &lines.lines, opts}},
                     .translucency = {{.opacity = 0.3f, .constant = true}},
                     .count = 1},
              whole = cut;
        whole.sets[0].lines = &other_lines.lines;
        test_lines_start(&lines, 0, 0, 0);
        test_lines_start(&other_lines, 0, 0, 0);
        add_straight(&lines, 1024, slope);
        add_straight(&other_lines, 1, slope);
        for (int i = 0; i < TEST_LINES_VERTICES; i++)
            normals[i][0] = (float)(-slope * scale), normals[i][2] = (float)scale;
        lines.lines.normals = other_lines.lines.normals = normals;
        /* edges of patches are at the centres of samples */
        const iso_view axis = test_axis_view(2, false, 0.25, -8, 65),
                       slanting = test_shapes_view((iso_vec3){0, 0, 0}, AWAY, 20, false);
        compare_joints(&cut, &whole, &axis, ribbon ? 1 : 2);
        compare_joints(&cut, &whole, &slanting, ribbon ? 1 : 2);
    }
}

/* A ribbon that twists has one layer where rays meet the edge that two of its patches share: the depths at
 * which they meet the two differ by rounding. */
static void test_twisted_ribbon(void **state) {
    (void)state;
    static float normals[TEST_LINES_VERTICES][3];
    const iso_view view = test_axis_view(2, false, 0.25, -8, 65);
    const size_t pixels = (size_t)view.width * (size_t)view.height;
    test_lines_start(&lines, 0, 0, 0);
    add_straight(&lines, 1024, 0.37);
    for (int i = 0; i <= 1024; i++) {
        double sine, cosine;
        iso_sincos(0.001 * i, &sine, &cosine);
        normals[i][1] = (float)sine, normals[i][2] = (float)cosine;
    }
    lines.lines.normals = normals;
    const mixed m = {.sets = {{NULL, &lines.lines, {.radius = 2, .style = ISO_LINE_RIBBON}}},
                     .translucency = {{.opacity = 0.3f, .constant = true}},
                     .count = 1};
    picture p = picture_of_scene(&m, &view, 1, NULL);
    for (size_t i = 0; i < pixels; i++) assert_true(p.counts[i] <= 1);
    assert_true(p.drawn[0].samples > pixels / 10);
    free_picture(&p);
}

/* A thick polyline with sharp bends, whose joints overlap. */
static void test_bends(void **state) {
    (void)state;
    test_lines_start(&lines, 0, 0, 0);
    for (int i = 0; i < 60; i++) {
        double sine, cosine;
        iso_sincos(i * 2.3, &sine, &cosine);
        test_lines_add(&lines, 4 * cosine + 0.1 * i - 3, 4 * sine, 0.2 * i - 6, 0.6 + 0.4 * cosine);
    }
    test_lines_end(&lines);
    const mixed m = {.sets = {{NULL, &lines.lines, {.radius = 1}}},
                     .translucency = {{.opacity = 0.3f, .constant = true}},
                     .count = 1};
    compare_views(&m, lines.lines.origin, AWAY, 20, "bends");
}

/* Coils whose turns overlap, in front of a line. The many pieces of each have two layers, so that the line
 * stays in sight, although they would stop all light if they were not merged. */
static void test_line_behind_coils(void **state) {
    (void)state;
    enum { COILS = 16, TURNED = 90 };
    test_lines_start(&lines, 0, 0, 0);
    for (int coil = 0; coil < COILS; coil++) {
        for (int i = 0; i < TURNED; i++) {
            double sine, cosine;
            iso_sincos(coil + i * 2.3, &sine, &cosine);
            test_lines_add(&lines, 1.5 * cosine, 1.5 * sine, -4 - 0.01 * coil - 0.001 * i, 2.95);
        }
        test_lines_end(&lines);
    }
    for (int i = 0; i <= 300; i++) test_lines_add(&lines, 0.05 * i - 7.5, 0, 6, 1.9);
    test_lines_end(&lines);
    const mixed m = {.sets = {{NULL, &lines.lines, {.radius = 1}}},
                     .translucency = {{.opacity = 0.1f, .constant = true}},
                     .count = 1};
    const iso_view view = test_axis_view(2, false, 0.8, -8, 21);
    compare(&m, &view, "a line behind coils");
}

/* ---- meshes */

enum { BOXES = 25, CUTS = 5, BOX_TRIANGLES = 6 * CUTS * CUTS * 2 };

/* Cuts the faces of boxes, the glyphs of make_glyphs, into triangles. */
static void make_boxes(const iso_glyphs *glyphs) {
    static float vertices[BOXES * BOX_TRIANGLES * 3][3];
    static uint32_t triangles[BOXES * BOX_TRIANGLES][3];
    static const int corner[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    iso_error error = {0};
    size_t at = 0;
    for (size_t i = 0; i < glyphs->count; i++)
        for (int cell = 0; cell < 6 * CUTS * CUTS; cell++)
            for (int k = 0; k < 6; k++, at++) {
                const int face = cell / (CUTS * CUTS), axis = face / 2;
                double local[3];
                local[axis] = face % 2 ? 1 : -1;
                local[(axis + 1) % 3] = 2.0 * (cell % CUTS + corner[k][0]) / CUTS - 1;
                local[(axis + 2) % 3] = 2.0 * (cell / CUTS % CUTS + corner[k][1]) / CUTS - 1;
                for (int a = 0; a < 3; a++) {
                    double p = (double)glyphs->positions[i][a];
                    for (int j = 0; j < 3; j++) p += local[j] * (double)glyphs->axes[i][3 * j + a];
                    vertices[at][a] = (float)p;
                }
                triangles[at / 3][at % 3] = (uint32_t)at;
            }
    const iso_triangles mesh = {vertices, triangles, at, at / 3, NULL};
    iso_triangle_spans_free(&spans);
    test_ok(iso_triangle_spans_make(&mesh, &spans, &error), &error);
}

/* Boxes of triangles are the same as those of glyphs, but for samples at their edges: vertices of triangles
 * are snapped to 1/256 pixel. Each sample has an even number of layers: edges that triangles share count
 * once. */
static void test_meshes(void **state) {
    (void)state;
    const iso_vec3 origin = {0, 0, 0};
    iso_glyphs glyphs = make_glyphs(BOXES, 1.2, origin, 11);
    glyphs.colors = NULL;
    for (size_t i = 0; i < glyphs.count; i++) /* right angles: smaller ones are shaded smoothly */
        for (int k = 0; k < 9; k++)
            if (k % 4) axes[i][k] = 0;
    make_boxes(&glyphs);
    for (int parallel = 0; parallel < 2; parallel++) {
        const iso_view view = test_shapes_view(origin, AWAY, 20, parallel);
        const mixed boxes = {.sets = {{&glyphs, NULL, {.glyph = ISO_GLYPH_BOX}}},
                             .translucency = {{.opacity = 0.1f, .constant = true}},
                             .count = 1};
        mixed mesh = boxes;
        mesh.has_mesh = true;
        picture wanted = picture_of_scene(&boxes, &view, 1, NULL),
                p = picture_of_scene(&mesh, &view, 1, NULL);
        const size_t pixels = (size_t)view.width * (size_t)view.height;
        size_t wrong = 0, odd = 0;
        for (size_t i = 0; i < pixels; i++) {
            bool differs = p.counts[i] != wanted.counts[i];
            for (size_t k = 4 * i; k < 4 * i + 4; k++)
                differs |= abs(p.image.rgba[k] - wanted.image.rgba[k]) > 1;
            wrong += differs;
            odd += (int)p.counts[i] % 2 == 1;
        }
        assert_true(p.drawn[0].samples > pixels / 10 && odd == 0);
        if (wrong > p.drawn[0].samples / 100) fail_msg("%zu of %zu wrong", wrong, p.drawn[0].samples);
        free_picture(&wanted);
        free_picture(&p);
    }
}

/* ---- together */

/* Three isosurfaces, a thousand tubes, glyphs of which the first layers are drawn, and opaque tubes. */
static mixed make_mixed(const test_scene *scene, iso_glyphs *glyphs, iso_shapes_scene *opaque) {
    const int *dims = iso_grid_dims(&scene->grid);
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&scene->grid));
    const iso_vec3 middle = iso_affine_point(
        &affine, iso_vec3_make(0.5 * (dims[0] - 1), 0.5 * (dims[1] - 1), 0.5 * (dims[2] - 1)));
    add_walks(&lines, 125, 8, 2.5, 0.1, 0.3, 5);
    add_walks(&other_lines, 5, 20, 3, 0.2, 0.4, 6);
    lines.lines.origin = other_lines.lines.origin = middle;
    *glyphs = make_glyphs(60, 0.8, middle, 8);
    *opaque = (iso_shapes_scene){NULL, &other_lines.lines, {.radius = 1}};
    return (mixed){.sets = {{NULL, &lines.lines, {.radius = 1}}, {glyphs, NULL, {.glyph = ISO_GLYPH_ARROW}}},
                   .translucency = {{.opacity = 0.3f}, {.opacity = 0.5f, .constant = true, .most_layers = 3}},
                   .count = 2,
                   .opaque = opaque,
                   .grid = &scene->grid,
                   .isovalues = {scene->isovalue, scene->isovalue + 0.15, scene->isovalue - 0.2},
                   .surface = {.opacity = 0.25f},
                   .surfaces = 3};
}

static void test_isosurfaces(void **state) {
    (void)state;
    test_scene scene = test_scene_make("gyroid", 24, NULL, false);
    iso_glyphs glyphs;
    iso_shapes_scene opaque;
    const mixed m = make_mixed(&scene, &glyphs, &opaque);
    for (int kind = 0; kind < TEST_VIEWS; kind++) {
        char name[64];
        const iso_view view =
            test_view_make(&scene.grid, (test_view)kind, SIDE, iso_vec3_make(0.5, 0.7, -0.5));
        snprintf(name, sizeof name, "isosurfaces, tubes and glyphs, view %d", kind);
        compare(&m, &view, name);
    }
    test_scene_free(&scene);
}

static void check_same(const picture *wanted, int row, const picture *p) {
    const size_t width = (size_t)wanted->image.width, at = (size_t)row * width,
                 count = width * (size_t)p->image.height;
    assert_memory_equal(wanted->image.rgba + 4 * at, p->image.rgba, 4 * count);
    assert_memory_equal(wanted->counts + at, p->counts, count * sizeof *p->counts);
    assert_memory_equal(wanted->coverage + at, p->coverage, count * sizeof *p->coverage);
}

static void test_variants(void **state) {
    (void)state;
    test_scene scene = test_scene_make("gyroid", 24, NULL, false);
    iso_glyphs glyphs;
    iso_shapes_scene opaque;
    mixed m = make_mixed(&scene, &glyphs, &opaque);
    glyphs.count = BOXES;
    for (size_t i = 0; i < BOXES; i++) /* as vertices are of a mesh, in the world */
        for (int a = 0; a < 3; a++)
            positions[i][a] += (float)(a == 0 ? glyphs.origin.x : a == 1 ? glyphs.origin.y : glyphs.origin.z);
    glyphs.origin = iso_vec3_make(0, 0, 0);
    make_boxes(&glyphs);
    m.has_mesh = true;
    m.translucency[m.count++] = (iso_translucency){.opacity = 0.1f};
    const iso_view view = test_view_make(&scene.grid, TEST_PERSPECTIVE, 300, iso_vec3_make(0.5, 0.7, -0.5));
    picture wanted = picture_of_scene(&m, &view, 2, NULL);
    for (int level = ISO_CPU_GENERIC; level <= (int)iso_cpu_supported(); level++)
        for (int threads = 1; threads <= 3; threads++) {
            iso_pool *pool = NULL;
            iso_cpu_limit((iso_cpu_level)level);
            if (threads > 1) assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
            picture p = picture_of_scene(&m, &view, 2, pool);
            check_same(&wanted, 0, &p);
            for (int i = 0; i < m.count; i++)
                assert_memory_equal(&p.drawn[i], &wanted.drawn[i], sizeof p.drawn[i]);
            free_picture(&p);
            iso_pool_destroy(pool);
        }
    iso_cpu_limit(ISO_CPU_AVX512);
    for (int y = 0; y < view.height; y += 46) {
        const int rows = view.height - y < 46 ? view.height - y : 46;
        const iso_view part = iso_view_rows(&view, y, rows);
        picture p = picture_of_scene(&m, &part, 2, NULL);
        check_same(&wanted, y / 2, &p);
        free_picture(&p);
    }
    free_picture(&wanted);
    test_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_glyphs),      cmocka_unit_test(test_billboards),
        cmocka_unit_test(test_many_pieces), cmocka_unit_test(test_several_blocks),
        cmocka_unit_test(test_tubes),       cmocka_unit_test(test_ribbons),
        cmocka_unit_test(test_joints),      cmocka_unit_test(test_twisted_ribbon),
        cmocka_unit_test(test_bends),       cmocka_unit_test(test_line_behind_coils),
        cmocka_unit_test(test_meshes),      cmocka_unit_test(test_isosurfaces),
        cmocka_unit_test(test_variants),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
