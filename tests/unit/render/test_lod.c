#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "render/selection/lod.h"
#include "render/selection/lod_cut.h"
#include "scene_support.h"

/* ---- points to make levels of */

/* The points of a scene as surfels with radii and colours. */
typedef struct copied {
    iso_surfel *surfels;
    float *radii;
    uint8_t (*colors)[3];
    uint64_t *versions;
    iso_point_view view;
} copied;

static copied copy_points(const iso_point_view *from) {
    const size_t n = iso_point_view_count(from);
    copied c = {malloc(n * sizeof *c.surfels), malloc(n * sizeof *c.radii), malloc(n * sizeof *c.colors),
                malloc(from->span_count * sizeof *c.versions), *from};
    uint32_t seed = 5;
    for (size_t i = 0; i < n; i++) {
        c.surfels[i] = iso_point_view_get(from, i);
        c.radii[i] = (float)(from->radius * (0.7 + uniform(&seed)));
        for (int k = 0; k < 3; k++) c.colors[i][k] = (uint8_t)random_bits(&seed);
    }
    for (size_t s = 0; s < from->span_count; s++) c.versions[s] = s + 1;
    c.view.packed = NULL;
    c.view.curvatures = NULL;
    c.view.surfels = c.surfels;
    c.view.radii = c.radii;
    c.view.colors = (const uint8_t(*)[3])c.colors;
    c.view.versions = c.versions;
    return c;
}

static void free_copied(copied *c) {
    free(c->surfels);
    free(c->radii);
    free(c->colors);
    free(c->versions);
}

static iso_lod make_lod(const iso_point_view *points, int threads) {
    iso_lod lod = {0};
    iso_error error = {0};
    iso_pool *pool = NULL;
    if (threads > 1) assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
    test_ok(iso_lod_update(&lod, points, pool, &error), &error);
    iso_pool_destroy(pool);
    return lod;
}

static void same_levels(const iso_lod *a, const iso_lod *b) {
    assert_int_equal(a->count, b->count);
    for (int k = 1; k < a->count; k++) {
        const iso_lod_level *x = &a->level[k], *y = &b->level[k];
        assert_int_equal(x->count, y->count);
        assert_int_equal(x->span_count, y->span_count);
        assert_memory_equal(x->spans, y->spans, x->span_count * sizeof *x->spans);
        assert_memory_equal(x->bounds, y->bounds, x->span_count * sizeof *x->bounds);
        assert_memory_equal(x->errors, y->errors, x->span_count * sizeof *x->errors);
        assert_memory_equal(x->first_child, y->first_child, (x->span_count + 1) * sizeof *x->first_child);
        if (x->packed) assert_memory_equal(x->packed, y->packed, x->count * sizeof *x->packed);
        if (x->surfels) assert_memory_equal(x->surfels, y->surfels, x->count * sizeof *x->surfels);
        if (x->radii) assert_memory_equal(x->radii, y->radii, x->count * sizeof *x->radii);
        if (!x->colors) continue;
        assert_memory_equal(x->colors, y->colors, x->count * sizeof *x->colors);
        assert_memory_equal(x->colors_below, y->colors_below,
                            x->first_color_below[x->span_count] * sizeof *x->colors_below);
    }
}

/* ---- levels */

/* The points of a voxel of the new level that face one way, summed in double precision. */
typedef struct group {
    double at[3], normal[3], color[3], first[3];
    int count;
} group;

enum { VOXELS = ISO_BRICK_VOXELS };

/* Sums the points of a span's children, by definition. */
static void sum_children(const iso_lod *lod, int level, size_t span, group (*groups)[2]) {
    const iso_point_view from = iso_lod_view(lod, level - 1);
    const iso_lod_level *to = &lod->level[level];
    memset(groups, 0, VOXELS * sizeof *groups);
    for (uint32_t c = to->first_child[span]; c < to->first_child[span + 1]; c++) {
        const iso_point_span *child = &from.spans[iso_lod_child(lod, level, c)];
        for (size_t i = child->first; i < child->first + child->count; i++) {
            const iso_surfel p = iso_point_view_get(&from, i);
            double at[3], along = 0, length = 0;
            int voxel[3];
            for (int k = 0; k < 3; k++) {
                at[k] = (16 * (double)child->brick[k] + (double)p.position[k]) / 2 -
                        16 * (double)to->spans[span].brick[k];
                voxel[k] = at[k] < 0 ? 0 : at[k] >= 16 ? 15 : (int)at[k];
            }
            group *two = groups[(voxel[2] * 16 + voxel[1]) * 16 + voxel[0]];
            for (int k = 0; k < 3; k++) length += (double)p.normal[k] * (double)p.normal[k];
            length = sqrt(length);
            for (int k = 0; k < 3; k++) along += two->first[k] * (double)p.normal[k] / length;
            group *g = two->count && along < 0 ? two + 1 : two;
            for (int k = 0; k < 3; k++) {
                if (!g->count) g->first[k] = (double)p.normal[k] / length;
                g->at[k] += at[k];
                g->normal[k] += (double)p.normal[k] / length;
                if (from.colors) g->color[k] += from.colors[i][k];
            }
            g->count++;
        }
    }
}

/* Whether a point is the mean of a group. */
static bool is_mean(const iso_point_view *view, size_t index, const group *g) {
    const iso_surfel p = iso_point_view_get(view, index);
    double off = 0, along = 0, length = 0, own = 0;
    for (int k = 0; k < 3; k++) {
        off = fmax(off, fabs((double)p.position[k] - g->at[k] / g->count));
        along += (double)p.normal[k] * g->normal[k];
        length += g->normal[k] * g->normal[k];
        own += (double)p.normal[k] * (double)p.normal[k];
        if (view->colors && fabs(view->colors[index][k] - g->color[k] / g->count) > 0.51) return false;
    }
    return off < 0.001 && along > 0.99999 * sqrt(length * own);
}

/* The voxel of a point, or one next to it if the point is on a face: packing may move it across. `near`: 3
 * bits that choose the side on each axis. */
static int voxel_near(const iso_point_view *view, size_t index, int near) {
    const iso_surfel p = iso_point_view_get(view, index);
    int voxel = 0;
    for (int k = 2; k >= 0; k--) {
        const float at = p.position[k] + (near >> k & 1 ? 0.001f : -0.001f);
        voxel = voxel * 16 + (at < 0 ? 0 : at >= 16 ? 15 : (int)at);
    }
    return voxel;
}

/* Each span has one point for each group of its children's points. */
static void check_span(const iso_lod *lod, int level, size_t span, group (*groups)[2]) {
    const iso_point_view view = iso_lod_view(lod, level);
    const iso_point_span *s = &view.spans[span];
    sum_children(lod, level, span, groups);
    size_t wanted = 0;
    for (int v = 0; v < VOXELS; v++) wanted += (groups[v][0].count > 0) + (groups[v][1].count > 0);
    assert_int_equal(s->count, wanted);
    for (size_t i = s->first; i < s->first + s->count; i++) {
        bool is_found = false;
        for (int near = 0; near < 8 && !is_found; near++) {
            const int voxel = voxel_near(&view, i, near);
            for (int side = 0; side < 2; side++)
                is_found |= groups[voxel][side].count && is_mean(&view, i, &groups[voxel][side]);
        }
        assert_true(is_found);
    }
}

/* Every span with points of the level below is the child of one span, which contains its brick. */
static void check_children(const iso_lod *lod, int level) {
    const iso_point_view from = iso_lod_view(lod, level - 1);
    const iso_lod_level *to = &lod->level[level];
    uint8_t *seen = calloc(from.span_count + 1, 1);
    for (size_t s = 0; s < to->span_count; s++)
        for (uint32_t c = to->first_child[s]; c < to->first_child[s + 1]; c++) {
            const size_t child = iso_lod_child(lod, level, c);
            assert_int_equal(seen[child]++, 0);
            for (int k = 0; k < 3; k++)
                assert_int_equal(from.spans[child].brick[k] >> 1, to->spans[s].brick[k]);
        }
    for (size_t s = 0; s < from.span_count; s++) assert_int_equal(seen[s], from.spans[s].count > 0);
    free(seen);
}

static void check_levels(const iso_point_view *points) {
    group(*groups)[2] = malloc(VOXELS * sizeof *groups);
    iso_lod lod = make_lod(points, 1);
    assert_true(lod.count > 3);
    size_t count = iso_point_view_count(points);
    for (int k = 1; k < lod.count; k++) {
        check_children(&lod, k);
        for (size_t s = 0; s < lod.level[k].span_count; s++) check_span(&lod, k, s, groups);
        assert_true(lod.level[k].count < count);
        count = lod.level[k].count;
    }
    assert_true(iso_lod_count(&lod) < 0.4 * (double)iso_point_view_count(points));
    for (int threads = 2; threads <= 3; threads++) {
        iso_lod other = make_lod(points, threads);
        same_levels(&lod, &other);
        iso_lod_free(&other);
    }
    iso_lod_free(&lod);
    free(groups);
}

static void levels_are_means(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "gyroid", "head"};
    for (int n = 0; n < 3; n++) {
        test_scene s = test_scene_make(names[n], 70, NULL, true);
        check_levels(&s.points);
        copied c = copy_points(&s.points);
        check_levels(&c.view);
        free_copied(&c);
        test_scene_free(&s);
    }
}

/* The disc of a point contains the discs of the points it stands for, of some level below: then there are no
 * holes. */
static void discs_contain_discs(void **state) {
    (void)state;
    test_scene s = test_scene_make("head", 60, NULL, true);
    copied c = copy_points(&s.points);
    iso_lod lod = make_lod(&c.view, 1);
    const iso_point_view coarse = iso_lod_view(&lod, 1);
    const double voxel = coarse.transform.spacing[0];
    for (size_t p = 0; p < lod.level[1].span_count; p++)
        for (uint32_t k = lod.level[1].first_child[p]; k < lod.level[1].first_child[p + 1]; k++) {
            const iso_point_span *child = &c.view.spans[lod.order[k]], *span = &coarse.spans[p];
            for (size_t i = child->first; i < child->first + child->count; i++) {
                bool contained = false;
                for (size_t j = span->first; j < span->first + span->count && !contained; j++) {
                    double square = 0;
                    for (int axis = 0; axis < 3; axis++) {
                        const double fine = 16.0 * child->brick[axis] + (double)c.surfels[i].position[axis],
                                     off = fine / 2 - 16.0 * span->brick[axis] -
                                           (double)coarse.surfels[j].position[axis];
                        square += off * off * voxel * voxel;
                    }
                    contained = sqrt(square) + (double)c.radii[i] <= (double)coarse.radii[j] * (1 + 1e-5);
                }
                assert_true(contained);
            }
        }
    iso_lod_free(&lod);
    free_copied(&c);
    test_scene_free(&s);
}

/* After a change of some spans only those above them are made again; all levels are as if all had been. */
static void changes_are_followed(void **state) {
    (void)state;
    test_scene s = test_scene_make("gyroid", 100, NULL, true);
    copied c = copy_points(&s.points);
    iso_lod lod = make_lod(&c.view, 1);
    size_t all = 0;
    for (int k = 1; k < lod.count; k++) all += lod.level[k].span_count;
    assert_int_equal(lod.made, all);
    const size_t changed[] = {0, 7, 8, c.view.span_count - 1};
    for (int i = 0; i < 4; i++) {
        const iso_point_span *span = &c.view.spans[changed[i]];
        for (size_t p = span->first; p < span->first + span->count; p++)
            c.surfels[p].position[i % 3] = 15 - c.surfels[p].position[i % 3];
        c.versions[changed[i]] += 1000000;
    }
    iso_error error = {0};
    test_ok(iso_lod_update(&lod, &c.view, NULL, &error), &error);
    assert_int_equal(lod.made + lod.kept, all);
    assert_true(lod.made >= 4);
    assert_true(lod.made <= 4 * (size_t)lod.count);
    iso_lod fresh = make_lod(&c.view, 1);
    same_levels(&fresh, &lod);
    iso_lod_free(&fresh);
    /* a span disappears, another one's number moves */
    iso_point_span *spans = malloc(c.view.span_count * sizeof *spans);
    memcpy(spans, c.view.spans + 1, (c.view.span_count - 1) * sizeof *spans);
    c.view.spans = spans;
    c.view.span_count--;
    memmove(c.versions, c.versions + 1, c.view.span_count * sizeof *c.versions);
    test_ok(iso_lod_update(&lod, &c.view, NULL, &error), &error);
    fresh = make_lod(&c.view, 1);
    same_levels(&fresh, &lod);
    assert_true(lod.made <= (size_t)lod.count);
    iso_lod_free(&fresh);
    iso_lod_free(&lod);
    free(spans);
    free_copied(&c);
    test_scene_free(&s);
}

/* Points that get colours and radii after their levels were made, and lose them again, without new
 * versions. */
static void attributes_come_and_go(void **state) {
    (void)state;
    test_scene s = test_scene_make("gyroid", 60, NULL, true);
    copied c = copy_points(&s.points);
    iso_point_view plain = s.points, colored = s.points, wide = s.points;
    plain.versions = colored.versions = wide.versions = c.versions;
    colored.colors = c.view.colors;
    wide.radii = c.view.radii;
    iso_lod lod = make_lod(&plain, 1);
    const iso_point_view order[] = {colored, plain, wide, c.view, plain};
    for (int i = 0; i < 5; i++) {
        iso_error error = {0};
        test_ok(iso_lod_update(&lod, &order[i], NULL, &error), &error);
        assert_int_equal(lod.kept, 0);
        iso_lod fresh = make_lod(&order[i], 1);
        same_levels(&fresh, &lod);
        iso_lod_free(&fresh);
    }
    iso_lod_free(&lod);
    free_copied(&c);
    test_scene_free(&s);
}

/* No points, few points, points that no renderer draws, and bricks that are too far away. */
static void odd_points(void **state) {
    (void)state;
    iso_surfel surfels[200];
    uint32_t seed = 3;
    for (int i = 0; i < 200; i++)
        for (int k = 0; k < 3; k++) {
            surfels[i].position[k] = i % 5 ? (float)(16 * uniform(&seed)) : i % 10 ? NAN : INFINITY;
            surfels[i].normal[k] = i % 7 ? 1 : 0;
        }
    iso_point_span span = {.brick = {-5, 0, 3}, .count = 200};
    iso_point_view view = {.surfels = surfels,
                           .spans = &span,
                           .span_count = 1,
                           .transform = iso_transform_identity(),
                           .radius = 1};
    iso_lod lod = make_lod(&view, 1);
    assert_true(lod.count > 1);
    for (int k = 1; k < lod.count; k++)
        for (size_t i = 0; i < lod.level[k].count; i++)
            for (int axis = 0; axis < 3; axis++)
                assert_true(isfinite(lod.level[k].surfels[i].position[axis]));
    span.count = 20;
    iso_error error = {0};
    test_ok(iso_lod_update(&lod, &view, NULL, &error), &error);
    assert_int_equal(lod.count, 1);
    span.count = 0;
    test_ok(iso_lod_update(&lod, &view, NULL, &error), &error);
    view.span_count = 0;
    test_ok(iso_lod_update(&lod, &view, NULL, &error), &error);
    assert_int_equal(iso_lod_count(&lod), 0);
    view.span_count = 1;
    span = (iso_point_span){.brick = {0, 1 << 20, 0}, .count = 200};
    assert_int_equal(iso_lod_update(&lod, &view, NULL, &error), ISO_ERR_LIMIT);
    assert_int_equal(lod.count, 0);
    iso_lod_free(&lod);
}

enum { PLANE = 160 };

/* Sorts the points of a plane into spans: one point for each voxel of the plane, which is tilted about x by
 * the angle with this cosine and sine. Returns the number of spans. */
static size_t make_plane(double cosine, double sine, iso_surfel *surfels, iso_point_span *spans) {
    size_t span_count = 0, count = 0;
    for (int brick = 0; brick < 10 * 10 * 10; brick++) {
        const int at[3] = {brick % 10 - 5, brick / 10 % 10 - 5, brick / 100 - 5};
        iso_point_span span = {.brick = {at[0], at[1], at[2]}, .first = count};
        for (int i = 0; i < PLANE * PLANE; i++) {
            const double x = i % PLANE - PLANE / 2 + 0.5, y = i / PLANE - PLANE / 2 + 0.5,
                         p[3] = {x, y * cosine, y * sine};
            bool is_inside = true;
            for (int k = 0; k < 3; k++) is_inside &= floor(p[k] / ISO_BRICK) == at[k];
            if (!is_inside) continue;
            surfels[count] = (iso_surfel){.normal = {0, (float)sine, (float)-cosine}};
            for (int k = 0; k < 3; k++) surfels[count].position[k] = (float)(p[k] - ISO_BRICK * at[k]);
            count++;
        }
        span.count = (uint32_t)(count - span.first);
        if (span.count) spans[span_count++] = span;
    }
    assert_int_equal(count, PLANE * PLANE);
    return span_count;
}

/* A plane has no holes in any level, whatever its angle to the voxels. */
static void levels_have_no_holes(void **state) {
    (void)state;
    static iso_surfel surfels[PLANE * PLANE];
    static iso_point_span spans[10 * 10 * 10];
    for (int degrees = 0; degrees < 80; degrees += 15) {
        const double angle = degrees * 3.14159265358979 / 180, cosine = cos(angle);
        const iso_point_view points = {.surfels = surfels,
                                       .spans = spans,
                                       .span_count = make_plane(cosine, sin(angle), surfels, spans),
                                       .transform = iso_transform_identity(),
                                       .radius = 0.70710678};
        iso_lod lod = make_lod(&points, 1);
        for (int level = 0; level < 4; level++)
            for (double pixels = 0.45; pixels < 4; pixels *= 1.37) {
                const double focal = ldexp(pixels, -level);
                const int wide = (int)(0.8 * PLANE * focal), high = (int)(0.8 * PLANE * focal * cosine);
                const iso_view view = test_plain_view(wide, high, true, focal);
                const iso_point_view drawn = iso_lod_view(&lod, level);
                iso_gbuffer g = test_drawn(&view, &drawn, &(iso_point_surface_opts){0}, NULL);
                int holes = 0;
                for (int i = 0; i < wide * high; i++) holes += g.surface[i] == ISO_SURFACE_NONE;
                if (holes)
                    fail_msg("%d degrees, level %d, voxels of %.2f pixels: %d holes", degrees, level, pixels,
                             holes);
                iso_gbuffer_free(&g);
            }
        iso_lod_free(&lod);
    }
}

/* ---- cuts and pictures */

/* Adds 1 for every span of level 0 below a span. */
static void count_leaves(const iso_lod *lod, int level, size_t span, uint8_t *times) {
    if (level == 0) {
        times[span]++;
        return;
    }
    const uint32_t *first = &lod->level[level].first_child[span];
    for (uint32_t c = first[0]; c < first[1]; c++)
        count_leaves(lod, level - 1, iso_lod_child(lod, level, c), times);
}

static size_t number_of(const iso_point_view *view, const iso_point_span *span) {
    for (size_t s = 0; s < view->span_count; s++)
        if (view->spans[s].first == span->first && view->spans[s].count) return s;
    fail_msg("the cut has a span that the level does not have");
    return 0;
}

/* A cut has every part of the surface once, whatever the number of pixels. */
static void cuts_have_everything_once(void **state) {
    (void)state;
    test_scene s = test_scene_make("gyroid", 90, NULL, true);
    iso_lod lod = make_lod(&s.points, 1);
    iso_lod_cut cut = {0};
    iso_error error = {0};
    uint8_t *times = malloc(s.points.span_count);
    for (int side = 0; side < 6; side++)
        for (double pixels = 0; pixels < 200; pixels = pixels * 1.7 + 0.1) {
            const iso_view view = test_look_at(&s, side, side == 3 ? 6 : 1, side == 2, 128, 96);
            test_ok(iso_lod_cut_make(&cut, &lod, &view, pixels, NULL, &error), &error);
            assert_int_equal(cut.levels, lod.count);
            memset(times, 0, s.points.span_count);
            for (int k = 0; k < cut.levels; k++) {
                const iso_point_view level = iso_lod_view(&lod, k);
                for (size_t i = 0; i < cut.view[k].span_count; i++)
                    count_leaves(&lod, k, number_of(&level, &cut.view[k].spans[i]), times);
                assert_int_equal(cut.points[k], iso_point_view_count(&cut.view[k]));
            }
            for (size_t i = 0; i < s.points.span_count; i++)
                assert_int_equal(times[i], s.points.spans[i].count > 0);
            if (pixels == 0) assert_int_equal(cut.points[0], iso_point_view_count(&s.points));
            if (pixels > 150 && side == 0) assert_int_equal(cut.points[0], 0);
        }
    free(times);
    iso_lod_cut_free(&cut);
    iso_lod_free(&lod);
    test_scene_free(&s);
}

static iso_gbuffer draw_cut(const iso_lod *lod, const iso_view *view, double pixels, size_t *points) {
    iso_lod_cut cut = {0};
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, lod->points.colors != NULL);
    const iso_target target = {view, &g, NULL, 0, NULL};
    test_ok(iso_lod_cut_make(&cut, lod, view, pixels, NULL, &error), &error);
    *points = 0;
    for (int k = 0; k < cut.levels; k++) {
        *points += cut.points[k];
        test_ok(iso_draw_point_surface(&target, &cut.view[k], &(iso_point_surface_opts){0}, &error), &error);
    }
    iso_lod_cut_free(&cut);
    return g;
}

enum { SIDE = 100, SAMPLES = 4 };

/* The mean of the cosines between ray and normal in a pixel; false: background is seen in it. */
static bool mean_of_samples(const iso_gbuffer *g, int x, int y, double *mean) {
    *mean = 0;
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
        const size_t at =
            (size_t)(y * SAMPLES + i / SAMPLES) * (size_t)g->width + (size_t)(x * SAMPLES + i % SAMPLES);
        if (g->surface[at] == ISO_SURFACE_NONE) return false;
        *mean += fabs((double)g->normal[2][at]) / (SAMPLES * SAMPLES);
    }
    return true;
}

/* PSNR of a picture against one with 16 samples a pixel, where that has no background; a hole counts as
 * wholly wrong. */
static double decibels(const iso_gbuffer *got, const iso_gbuffer *truth) {
    double square = 0;
    int count = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            double mean;
            const size_t at = (size_t)(y * SIDE + x);
            if (!mean_of_samples(truth, x, y, &mean)) continue;
            const double off =
                got->surface[at] == ISO_SURFACE_NONE ? 1 : fabs((double)got->normal[2][at]) - mean;
            square += off * off;
            count++;
        }
    return -10 * log10(square / count);
}

/* With one pixel a picture is about as near to the truth as one of all points, with a third of them or
 * fewer, also where a surface is as fine as pixels are (gyroid, head). */
static void pictures_are_as_good(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "cylinder", "head", "gyroid"};
    for (int n = 0; n < 4; n++) {
        test_scene s = test_scene_make(names[n], 250, NULL, true);
        iso_lod lod = make_lod(&s.points, 1);
        const iso_view view = test_look_at(&s, n, 1, n == 1, SIDE, SIDE),
                       fine = iso_view_scaled(&view, SAMPLES);
        size_t points, all;
        iso_gbuffer truth = draw_cut(&lod, &fine, 0, &all), a = draw_cut(&lod, &view, 0, &all),
                    b = draw_cut(&lod, &view, 1, &points);
        const double db_all = decibels(&a, &truth), db = decibels(&b, &truth);
        if (points > all / 3) fail_msg("%s: %zu of %zu points", names[n], points, all);
        if (db < fmin(db_all - 3, 50)) fail_msg("%s: %.2f dB, all points %.2f", names[n], db, db_all);
        iso_gbuffer_free(&truth);
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
        iso_lod_free(&lod);
        test_scene_free(&s);
    }
}

/* ---- colours */

/* A zone plate, whose rings are as narrow as two surfels at its sides: 0 .. 255. */
static double zone_plate(double x, double y) {
    return 127.5 + 127.5 * cos((x * x + y * y) * 0.9 * 3.14159265358979 / PLANE);
}

/* The mean of the zone plate in a pixel of a view. */
static double zone_plate_mean(const iso_view *view, int x, int y, double cosine) {
    enum { PARTS = 16 };
    double mean = 0;
    for (int i = 0; i < PARTS * PARTS; i++)
        mean += zone_plate((x + (i % PARTS + 0.5) / PARTS - view->cx) / view->focal,
                           (y + (i / PARTS + 0.5) / PARTS - view->cy) / (view->focal * cosine)) /
                (PARTS * PARTS);
    return mean;
}

/* PSNR of a picture of the zone plate against its mean in every pixel, but at the border. */
static double zone_plate_decibels(const iso_gbuffer *g, const iso_view *view, double cosine) {
    enum { BORDER = 3 };
    double square = 0;
    int count = 0;
    for (int y = BORDER; y < g->height - BORDER; y++)
        for (int x = BORDER; x < g->width - BORDER; x++) {
            const size_t at = (size_t)(y * g->width + x);
            assert_true(g->surface[at] != ISO_SURFACE_NONE);
            const double off = (double)(g->color[at] & 255) - zone_plate_mean(view, x, y, cosine);
            square += off * off;
            count++;
        }
    return 10 * log10(255.0 * 255.0 * count / square);
}

/* Makes the points of the zone plate. `colors` is their colours' memory. */
static iso_point_view make_zone_plate(double cosine, iso_surfel *surfels, iso_point_span *spans,
                                      uint8_t (*colors)[3]) {
    const size_t span_count = make_plane(cosine, sqrt(1 - cosine * cosine), surfels, spans);
    for (size_t s = 0; s < span_count; s++)
        for (size_t i = spans[s].first; i < spans[s].first + spans[s].count; i++) {
            const float *p = surfels[i].position;
            const double x = 16 * spans[s].brick[0] + (double)p[0], y = 16 * spans[s].brick[1] + (double)p[1];
            memset(colors[i], (int)(zone_plate(x, y / cosine) + 0.5), sizeof colors[i]);
        }
    return (iso_point_view){.surfels = surfels,
                            .spans = spans,
                            .span_count = span_count,
                            .transform = iso_transform_identity(),
                            .radius = 0.70710678,
                            .colors = (const uint8_t(*)[3])colors};
}

/* Coloured points, 16 to a pixel and more: the levels' colours are means; those of all points would alias. */
static void colors_are_prefiltered(void **state) {
    (void)state;
    static iso_surfel surfels[PLANE * PLANE];
    static iso_point_span spans[10 * 10 * 10];
    static uint8_t colors[PLANE * PLANE][3];
    for (int tilted = 0; tilted < 2; tilted++) {
        const double cosine = tilted ? 0.5 : 1, focal = 0.25;
        const iso_point_view points = make_zone_plate(cosine, surfels, spans, colors);
        iso_lod lod = make_lod(&points, 1);
        const iso_view view =
            test_plain_view((int)(PLANE * focal), (int)(PLANE * focal * cosine), true, focal);
        size_t drawn;
        iso_gbuffer g = draw_cut(&lod, &view, 1, &drawn);
        const double db = zone_plate_decibels(&g, &view, cosine);
        const iso_point_surface_opts means = {.reconstruction = ISO_RECONSTRUCTION_MEAN};
        iso_gbuffer m = test_drawn(&view, &points, &means, NULL);
        const double db_mean = zone_plate_decibels(&m, &view, cosine);
        printf("%s: %.1f dB, mean of a pixel's points %.1f\n", tilted ? "tilted" : "straight", db, db_mean);
        if (db < (tilted ? 29 : 43) || db_mean < 43) fail_msg("%.1f dB, %.1f dB", db, db_mean);
        iso_gbuffer_free(&m);
        iso_gbuffer_free(&g);
        iso_lod_free(&lod);
    }
}

enum { WINDOW = 34, ZOOM_STEPS = 240, CHANGES = 256 };

/* What a slow zoom shows: how far its pictures are from the truth; the 99th percentile and the maximum of
 * how much a pixel's error changes from one picture to the next, of 255: that is seen to flicker or pop. */
typedef struct zoom {
    double decibels;
    int p99, most;
} zoom;

/* Zooms out in steps of 0.6 %, over two changes of levels. */
static zoom zoom_out(const iso_lod *lod, double cosine) {
    double before[WINDOW * WINDOW], square = 0, focal = 1;
    size_t changes[CHANGES] = {0}, count = 0, pixels = 0, below = 0;
    zoom found = {.most = 0};
    for (int step = 0; step < ZOOM_STEPS; step++, focal *= 0.994) {
        iso_view view = test_plain_view(WINDOW, (int)(WINDOW * cosine), true, focal);
        view.cx += 0.3;
        view.cy += 0.2;
        size_t drawn;
        iso_gbuffer g = draw_cut(lod, &view, 1, &drawn);
        for (int i = 0; i < view.width * view.height; i++) {
            assert_true(g.surface[i] != ISO_SURFACE_NONE);
            const double off =
                (double)(g.color[i] & 255) - zone_plate_mean(&view, i % view.width, i / view.width, cosine);
            const int change = step ? (int)(fabs(off - before[i]) + 0.5) : 0;
            changes[change]++;
            count += step > 0;
            if (change > found.most) found.most = change;
            square += off * off;
            pixels++;
            before[i] = off;
        }
        if (step == 0) memset(changes, 0, sizeof changes);
        iso_gbuffer_free(&g);
    }
    while ((below += changes[found.p99]) * 100 < count * 99) found.p99++;
    found.decibels = 10 * log10(255.0 * 255.0 * (double)pixels / square);
    return found;
}

/* Colours and sizes are interpolated between levels, so that little pops in a slow zoom. Without that the
 * straight one has 24.6 dB, 27 and 105 of 255. */
static void zooms_hardly_pop(void **state) {
    (void)state;
    static iso_surfel surfels[PLANE * PLANE];
    static iso_point_span spans[10 * 10 * 10];
    static uint8_t colors[PLANE * PLANE][3];
    for (int tilted = 0; tilted < 2; tilted++) {
        const double cosine = tilted ? 0.5 : 1;
        const iso_point_view points = make_zone_plate(cosine, surfels, spans, colors);
        iso_lod lod = make_lod(&points, 1);
        const zoom found = zoom_out(&lod, cosine);
        printf("%s: %.1f dB, change of errors %d (99th percentile), %d at most\n",
               tilted ? "tilted" : "straight", found.decibels, found.p99, found.most);
        if (found.decibels < 22 || found.p99 > 24 || found.most > 80)
            fail_msg("%.1f dB, %d, %d", found.decibels, found.p99, found.most);
        iso_lod_free(&lod);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_are_means),          cmocka_unit_test(discs_contain_discs),
        cmocka_unit_test(changes_are_followed),      cmocka_unit_test(odd_points),
        cmocka_unit_test(attributes_come_and_go),    cmocka_unit_test(levels_have_no_holes),
        cmocka_unit_test(cuts_have_everything_once), cmocka_unit_test(pictures_are_as_good),
        cmocka_unit_test(colors_are_prefiltered),    cmocka_unit_test(zooms_hardly_pop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
