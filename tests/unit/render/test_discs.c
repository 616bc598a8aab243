/* Discs: against a plain one in double precision that knows nothing of patches,
 * vectors and hiding, against surfaces that are known, and against itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "discs_reference.h"
#include "extract/points/points.h"
#include "render/point_surface.h"
#include "scene_support.h"

/* ---- points to draw */

/* Points of one's own, as floats, in one span. */
typedef struct cloud {
    iso_surfel *surfels;
    iso_curvature *curvatures;
    iso_point_span span;
    iso_point_view points;
} cloud;

static cloud *make_cloud(size_t count) {
    cloud *c = calloc(1, sizeof *c);
    assert_non_null(c);
    c->surfels = calloc(count, sizeof *c->surfels);
    c->curvatures = calloc(count, sizeof *c->curvatures);
    assert_true(c->surfels && c->curvatures);
    c->points = (iso_point_view){.surfels = c->surfels,
                                 .curvatures = c->curvatures,
                                 .spans = &c->span,
                                 .span_count = 1,
                                 .transform = iso_transform_identity(),
                                 .radius = sqrt(0.5)};
    return c;
}

static void free_cloud(cloud *c) {
    free(c->surfels);
    free(c->curvatures);
    free(c);
}

static void add_point(cloud *c, const double at[3], const double normal[3]) {
    iso_surfel *s = &c->surfels[c->span.count++];
    for (int k = 0; k < 3; k++) {
        s->position[k] = (float)at[k];
        s->normal[k] = (float)normal[k];
    }
}

/* A shape that bends by `bend` along a direction, and by `across` at right angles to it. */
static void bend_point(cloud *c, const double along[3], double bend, double across) {
    const uint32_t i = c->span.count - 1;
    float u[3], v[3];
    iso_curvature_frame(c->surfels[i].normal, u, v);
    double x = 0, y = 0;
    for (int k = 0; k < 3; k++) {
        x += (double)u[k] * along[k];
        y += (double)v[k] * along[k];
    }
    const double more = bend - across;
    c->curvatures[i] = iso_curvature_pack((float)(across + more * x * x), (float)(more * x * y),
                                          (float)(across + more * y * y));
}

enum { RADIUS = 12, DISTANCE = 60 };
static const double SPACING = 0.75; /* voxels between points */

/* A sphere around (0, 0, DISTANCE); the part with z < cut. */
static cloud *make_sphere(double cut) {
    const int count = (int)(4 * ISO_PI * RADIUS * RADIUS / (SPACING * SPACING));
    cloud *c = make_cloud((size_t)count);
    for (int i = 0; i < count; i++) {
        const double z = 1 - (2 * i + 1.0) / count, turn = i * ISO_PI * (3 - sqrt(5)), r = sqrt(1 - z * z);
        const double n[3] = {r * cos(turn), r * sin(turn), z},
                     at[3] = {RADIUS * n[0], RADIUS * n[1], RADIUS * n[2] + DISTANCE};
        if (RADIUS * z > cut) continue;
        add_point(c, at, n);
        bend_point(c, n, 1.0 / RADIUS, 1.0 / RADIUS); /* in every direction */
    }
    return c;
}

enum { LONG = 30 };

/* A cylinder along x; without ends. */
static cloud *make_cylinder(void) {
    const int around = (int)(2 * ISO_PI * RADIUS / SPACING), along = (int)(LONG / SPACING);
    cloud *c = make_cloud((size_t)around * (size_t)along);
    for (int i = 0; i < around * along; i++) {
        const double turn = 2 * ISO_PI * (i % around + 0.5 * (i / around % 2)) / around;
        const double n[3] = {0, cos(turn), sin(turn)}, t[3] = {0, -n[2], n[1]},
                     at[3] = {(i / around + 0.5) * SPACING - LONG / 2.0, RADIUS * n[1],
                              RADIUS * n[2] + DISTANCE};
        add_point(c, at, n);
        bend_point(c, t, 1.0 / RADIUS, 0);
    }
    return c;
}

enum { SIDE = 60 };

/* The plane z = DISTANCE + slope x. */
static cloud *make_plane(double slope) {
    const int count = (int)(SIDE / SPACING);
    const double length = sqrt(1 + slope * slope), n[3] = {slope / length, 0, -1 / length};
    cloud *c = make_cloud((size_t)count * (size_t)count);
    for (int i = 0; i < count * count; i++) {
        const double x = (i % count + 0.5) * SPACING - SIDE / 2.0,
                     y = (i / count + 0.5) * SPACING - SIDE / 2.0;
        add_point(c, (const double[3]){x, y, DISTANCE + slope * x}, n);
    }
    return c;
}

/* ---- pictures */

static const iso_point_surface_opts curved = {.reconstruction = ISO_RECONSTRUCTION_CURVED},
                                    flat = {.reconstruction = ISO_RECONSTRUCTION_FLAT};

static size_t samples_of(const iso_view *view) {
    return (size_t)view->width * (size_t)view->height;
}

static bool is_there(const iso_gbuffer *g, size_t i) {
    return g->surface[i] != ISO_SURFACE_NONE;
}

/* ---- against the reference */

/* Whether two colours of a gbuffer differ by a few levels at most. */
static bool is_same_color(uint32_t a, uint32_t b, int levels) {
    for (int k = 0; k < 3; k++)
        if (abs((int)(a >> 8 * k & 255) - (int)(b >> 8 * k & 255)) > levels) return false;
    return a >> 24 == b >> 24;
}

/* What may differ: pixels where rounding decides, and where surfaces within a thickness come in an order.
 * If discs are `filtered`, those that come before the front of a pixel and beside it may be missing in its
 * means, unless they have radii of their own and are drawn in two passes. */
static void like_reference(const iso_view *view, const iso_point_view *points, bool filtered, double most) {
    const iso_point_surface_opts *opts = filtered ? &flat : &curved;
    const bool coarse = filtered && !points->radii;
    const float depth = (filtered ? 1.0f : 0.01f) * (float)points->radius;
    const int levels = coarse ? 8 : 1;
    iso_gbuffer got = test_drawn(view, points, opts, NULL),
                wanted = test_clear_gbuffer(view->width, view->height, points->colors != NULL);
    discs_reference(view, points, filtered, &wanted);
    size_t off = 0, seen = 0;
    for (size_t i = 0; i < samples_of(view); i++) {
        const bool a = is_there(&got, i), b = is_there(&wanted, i);
        seen += b;
        double cosine = 0;
        for (int k = 0; k < 3; k++) cosine += (double)got.normal[k][i] * (double)wanted.normal[k][i];
        off += a != b ||
               (a && !(fabsf(got.depth[i] - wanted.depth[i]) < depth && cosine > (coarse ? 0.98 : 0.9999) &&
                       (!got.color || is_same_color(got.color[i], wanted.color[i], levels))));
    }
    assert_true(seen > samples_of(view) / 50);
    if ((double)off > most * (double)seen) fail_msg("%zu of %zu samples differ", off, seen);
    iso_gbuffer_free(&got);
    iso_gbuffer_free(&wanted);
}

/* The points' shapes, the discs of three in four of them without a quarter of their size or more. */
static iso_curvature *smaller_discs(const iso_point_view *points) {
    const size_t count = iso_point_view_count(points);
    iso_curvature *curvatures = malloc(count * sizeof *curvatures);
    assert_non_null(curvatures);
    memcpy(curvatures, points->curvatures, count * sizeof *curvatures);
    for (size_t i = 0; i < count; i++) curvatures[i].extents |= (uint16_t)(i % 4 << ISO_CURVATURE_SHRINK_BIT);
    return curvatures;
}

static void like_the_reference(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "gyroid", "cylinder"};
    static const double zooms[] = {0.5, 1, 4, 14};
    for (int n = 0; n < 3; n++) {
        const iso_points_opts opts = {.curvature = true,
                                      .primitive = n ? ISO_PRIMITIVE_EDGE : ISO_PRIMITIVE_AUTO};
        test_scene s = test_scene_make(names[n], 32, &opts, true);
        for (int z = 0; z < 4; z++) {
            const iso_view view = test_look_at(&s, n + z, zooms[z], (n + z) % 3 == 0, 83 + 10 * n, 101);
            like_reference(&view, &s.points, false, n == 1 ? 0.03 : 0.01);
        }
        s.points.closed = false;
        s.points.transform.spacing[2] *= 1.5;
        const iso_view view = test_look_at(&s, n, 2, false, 90, 67);
        like_reference(&view, &s.points, false, n == 1 ? 0.03 : 0.01);
        iso_curvature *curvatures = smaller_discs(&s.points);
        s.points.curvatures = curvatures;
        like_reference(&view, &s.points, false, n == 1 ? 0.03 : 0.01);
        free(curvatures);
        test_scene_free(&s);
    }
}

/* Points with colours, as points of files have them: flat, and with radii of their own. */
static void colors_are_averaged(void **state) {
    (void)state;
    static const double zooms[] = {0.5, 1, 4, 14};
    test_scene s = test_scene_make("gyroid", 32, &(iso_points_opts){0}, true);
    const size_t count = iso_point_view_count(&s.points);
    uint8_t(*random)[3] = malloc(count * sizeof *random), (*smooth)[3] = malloc(count * sizeof *smooth);
    float *radii = malloc(count * sizeof *radii);
    assert_true(random && smooth && radii);
    uint32_t seed = 9;
    for (size_t i = 0; i < count; i++) {
        const iso_surfel surfel = iso_point_view_get(&s.points, i);
        for (int k = 0; k < 3; k++) {
            random[i][k] = (uint8_t)(256 * uniform(&seed));
            smooth[i][k] = (uint8_t)(128 + 100 * surfel.normal[k]);
        }
        radii[i] = (float)(s.points.radius * (0.8 + uniform(&seed)));
    }
    for (int z = 0; z < 8; z++) {
        s.points.colors = (const uint8_t(*)[3])random;
        s.points.radii = z < 4 ? NULL : radii;
        s.points.closed = z % 2;
        const iso_view view = test_look_at(&s, z, zooms[z % 4], z % 3 == 0, 83, 101);
        /* discs of different thickness: more pixels depend on the order of the discs */
        like_reference(&view, &s.points, false, s.points.radii ? 0.06 : 0.01);
        iso_gbuffer whole = test_drawn(&view, &s.points, &curved, NULL);
        test_every_variant(&view, &s.points, &curved, &whole);
        test_every_strip(&view, &s.points, &curved, &whole);
        iso_gbuffer_free(&whole);
        if (zooms[z % 4] >= 2) continue; /* discs are too large for the filter */
        s.points.colors = (const uint8_t(*)[3])smooth;
        like_reference(&view, &s.points, true, s.points.radii ? 0.02 : 0.06);
        whole = test_drawn(&view, &s.points, &flat, NULL);
        test_every_variant(&view, &s.points, &flat, &whole);
        test_every_strip(&view, &s.points, &flat, &whole);
        iso_gbuffer_free(&whole);
    }
    free(random);
    free(smooth);
    free(radii);
    test_scene_free(&s);
}

/* ---- against itself */

/* Every point in a block of its own, so that blocks are dealt to patches as closely as can be. */
static iso_point_span *scatter_blocks(cloud *c) {
    iso_point_span *spans = calloc(c->span.count, sizeof *spans);
    assert_non_null(spans);
    for (uint32_t i = 0; i < c->span.count; i++) spans[i] = (iso_point_span){.count = 1, .first = i};
    c->points.spans = spans;
    c->points.span_count = c->span.count;
    return spans;
}

/* The same in a picture that has more columns and rows on every side, so that the seams of patches, which
 * are at columns 128 and rows 64, lie elsewhere, and its own sides do not matter: but for where rounding
 * decides. Returns the samples that it covers. */
static size_t same_when_moved(const iso_view *view, const iso_point_view *points) {
    enum { COLUMNS = 53, ROWS = 29 };
    iso_view more = *view;
    more.width += 2 * COLUMNS;
    more.height += 2 * ROWS;
    more.cx += COLUMNS;
    more.cy += ROWS;
    iso_gbuffer a = test_drawn(view, points, &curved, NULL), b = test_drawn(&more, points, &curved, NULL);
    size_t seen = 0, off = 0;
    for (size_t i = 0; i < samples_of(view); i++) {
        const size_t row = i / (size_t)view->width + ROWS, column = i % (size_t)view->width + COLUMNS,
                     k = row * (size_t)more.width + column;
        seen += is_there(&a, i);
        bool same = is_there(&a, i) == is_there(&b, k);
        if (same && is_there(&a, i)) same = fabsf(a.depth[i] - b.depth[k]) < 1e-3f;
        for (int axis = 0; axis < 3 && same && is_there(&a, i); axis++)
            same = fabsf(a.normal[axis][i] - b.normal[axis][k]) < 1e-3f;
        off += !same;
    }
    if (off > 2 + seen / 500) fail_msg("%zu of %zu samples differ", off, seen);
    iso_gbuffer_free(&a);
    iso_gbuffer_free(&b);
    return seen;
}

/* Discs that reach over seams. They are flat, and of directions so different that none can be missing:
 * those that lie in their surface are hardly missed. */
static void seams_do_not_show(void **state) {
    (void)state;
    cloud *c = make_sphere(RADIUS);
    iso_point_span *spans = scatter_blocks(c);
    c->points.curvatures = NULL;
    for (uint32_t i = 0; i < c->span.count; i++)
        for (int k = 0; k < 3; k++) c->surfels[i].normal[k] += (float)(0.3 * sin(1.7 * (k + 1) * i));
    for (int n = 0; n < 4; n++) {
        const double focal = n % 2 ? 1.5 : 7; /* (tiles, and single pixels) */
        const iso_view view = test_plain_view(300, 150, n < 2, focal * (n < 2 ? 1 : DISTANCE));
        assert_true(same_when_moved(&view, &c->points) > 100);
    }
    free(spans);
    free_cloud(c);
}

/* Where rays are so slanted that discs which face the eye are seen twice as wide. The last ones' centres
 * lie beyond the picture's side. */
static void slanted_discs_reach_over_seams(void **state) {
    (void)state;
    size_t beyond = 0;
    iso_view view = test_plain_view(200, 90, false, 60);
    view.cx = 10;
    for (int column = 90; column <= 230; column += 2) {
        cloud *c = make_cloud(1);
        const double slope = (column - view.cx) / view.focal, length = sqrt(1 + slope * slope),
                     n[3] = {-slope / length, 0, -1 / length};
        add_point(c, (const double[3]){-RADIUS * n[0], 0, -RADIUS * n[2]}, n);
        const size_t seen = same_when_moved(&view, &c->points);
        if (column > view.width) beyond += seen;
        free_cloud(c);
    }
    assert_true(beyond > 100);
}

/* Open ones have turned points too. */
static void same_bytes_everywhere(void **state) {
    (void)state;
    static const char *const names[] = {"gyroid", "sphere", "head"};
    static const double zooms[] = {0.7, 3, 11, 60};
    for (int n = 0; n < 3; n++) {
        test_scene s = test_scene_make(names[n], 40, &(iso_points_opts){.curvature = true}, true);
        for (int z = 0; z < 4; z++) {
            if (z == 2) s.points.closed = false;
            const iso_view view = test_look_at(&s, n + 2 * z, zooms[z], z == 1, 131 - 9 * n, 143);
            iso_gbuffer whole = test_drawn(&view, &s.points, &curved, NULL);
            test_every_variant(&view, &s.points, &curved, &whole);
            test_every_strip(&view, &s.points, &curved, &whole);
            iso_gbuffer_free(&whole);
        }
        test_scene_free(&s);
    }
}

/* ---- surfaces that are known */

/* What a ray meets: depth and outward normal; false when nothing. */
typedef bool known_surface(const double origin[3], const double ray[3], double *depth, double normal[3]);

/* The nearer of two roots of a t^2 + 2 b t + c. */
static bool nearer_root(double a, double b, double c, double *t) {
    if (!(b * b >= a * c)) return false;
    *t = (-b - sqrt(b * b - a * c)) / a;
    return true;
}

static bool meet_round(const double origin[3], const double ray[3], int first, double *depth,
                       double normal[3]) {
    double a = 0, b = 0, c = -(double)RADIUS * RADIUS, from[3] = {origin[0], origin[1], origin[2] - DISTANCE};
    for (int k = first; k < 3; k++) {
        a += ray[k] * ray[k];
        b += ray[k] * from[k];
        c += from[k] * from[k];
    }
    if (!nearer_root(a, b, c, depth)) return false;
    for (int k = 0; k < 3; k++) normal[k] = k < first ? 0 : (from[k] + *depth * ray[k]) / RADIUS;
    return true;
}

static bool meet_sphere(const double origin[3], const double ray[3], double *depth, double normal[3]) {
    return meet_round(origin, ray, 0, depth, normal);
}

static bool meet_cylinder(const double origin[3], const double ray[3], double *depth, double normal[3]) {
    return meet_round(origin, ray, 1, depth, normal) &&
           fabs(origin[0] + *depth * ray[0]) < LONG / 2.0 - 1.5; /* its ends are ragged */
}

static const double SLOPE = 0.5;

static bool meet_plane(const double origin[3], const double ray[3], double *depth, double normal[3]) {
    *depth = (DISTANCE + SLOPE * origin[0] - origin[2]) / (ray[2] - SLOPE * ray[0]);
    const double length = sqrt(1 + SLOPE * SLOPE);
    normal[0] = SLOPE / length;
    normal[1] = 0;
    normal[2] = -1 / length;
    for (int k = 0; k < 2; k++)
        if (fabs(origin[k] + *depth * ray[k]) > SIDE / 2.0 - 1.5) return false;
    return true;
}

typedef struct errors {
    double depth, degrees; /* mean */
    double worst_depth;    /* of all but the last percent */
    size_t seen, holes, extra;
} errors;

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static errors compare(const iso_view *view, const iso_gbuffer *g, known_surface *surface) {
    errors e = {0};
    size_t met = 0;
    double *depths = calloc(samples_of(view), sizeof *depths);
    assert_non_null(depths);
    for (size_t i = 0; i < samples_of(view); i++) {
        const double u = ((double)(i % (size_t)view->width) + 0.5 - view->cx) / view->focal,
                     v = ((double)(i / (size_t)view->width) + 0.5 - view->cy) / view->focal;
        const double still[3] = {0, 0, 1}, at[3] = {u, v, 0}, zero[3] = {0, 0, 0}, ray[3] = {u, v, 1};
        double depth, normal[3], cosine = 0;
        const bool here =
            surface(view->orthographic ? at : zero, view->orthographic ? still : ray, &depth, normal);
        e.extra += is_there(g, i) && !here;
        e.holes += here && !is_there(g, i);
        met += here;
        if (!here || !is_there(g, i)) continue;
        for (int k = 0; k < 3; k++) cosine += normal[k] * (double)g->normal[k][i];
        depths[e.seen] = fabs(depth - (double)g->depth[i]);
        e.depth += depths[e.seen++];
        e.degrees += acos(fmin(cosine, 1)) * 180 / ISO_PI;
    }
    assert_true(e.seen > 100 && met >= e.seen);
    qsort(depths, e.seen, sizeof *depths, by_size);
    e.worst_depth = depths[e.seen - 1 - e.seen / 100];
    free(depths);
    e.depth /= (double)e.seen;
    e.degrees /= (double)e.seen;
    return e;
}

static const double FOCALS[] = {0.8, 1.6, 3.3, 7, 15}; /* pixels a voxel */

/* Discs with the surface's own shape lie in it, but for the steps of shapes. */
static void known_surfaces(void **state) {
    (void)state;
    cloud *const clouds[] = {make_sphere(RADIUS), make_cylinder(), make_plane(SLOPE)};
    known_surface *const surfaces[] = {meet_sphere, meet_cylinder, meet_plane};
    for (int c = 0; c < 3; c++)
        for (int f = 0; f < 5; f++)
            for (int orthographic = 0; orthographic < 2; orthographic++) {
                const double focal = FOCALS[f] * (orthographic ? 1 : DISTANCE - RADIUS);
                const iso_view view = test_plain_view(220, 210, orthographic, focal);
                clouds[c]->points.closed = c == 0;
                iso_gbuffer g = test_drawn(&view, &clouds[c]->points, &curved, NULL);
                const errors e = compare(&view, &g, surfaces[c]);
                iso_gbuffer_free(&g);
                const bool tiny = f == 0 && c < 2; /* less than a pixel: flat discs */
                const double depth = tiny ? 0.03 : 0.003, degrees = tiny ? 2.2 : c == 2 ? 0.05 : 0.4;
                if (e.depth > depth || e.worst_depth > 12 * depth || e.degrees > degrees)
                    fail_msg("surface %d, %g pixels a voxel: depth %g, %g, normal %g degrees", c, FOCALS[f],
                             e.depth, e.worst_depth, e.degrees);
                const double outline = 2 * sqrt(ISO_PI * (double)(e.seen + e.holes));
                if ((double)e.holes > 0.04 * outline + 4 ||
                    (c == 0 && (double)e.extra > (tiny ? 0.5 : 0.15) * FOCALS[f] * outline + 4))
                    fail_msg("surface %d, %g pixels a voxel: %zu holes, %zu extra", c, FOCALS[f], e.holes,
                             e.extra);
            }
    for (int c = 0; c < 3; c++) free_cloud(clouds[c]);
}

/* A bumpy ball of integers, many of which are the isovalue: the surface passes through those voxels. */
static test_scene make_integers(void) {
    enum { DIM = 40 };
    static uint8_t values[DIM * DIM * DIM];
    iso_error error = {0};
    uint32_t seed = 11;
    for (int i = 0; i < DIM * DIM * DIM; i++) {
        const double x = i % DIM - 19.5, y = i / DIM % DIM - 19.5, z = i / DIM / DIM - 19.5;
        values[i] = (uint8_t)fmax(40 - 2 * sqrt(x * x + y * y + z * z) + uniform(&seed), 0);
    }
    test_scene s = {.isovalue = 10};
    const iso_rgrid_desc desc = {.dims = {DIM, DIM, DIM}, .type = ISO_UINT8, .data = values};
    const iso_points_opts opts = {.isovalue = s.isovalue, .curvature = true};
    test_ok(iso_rgrid_create(&desc, &s.grid.rgrid, &error), &error);
    test_ok(iso_point_set_create(&s.grid, &opts, &s.set, &error), &error);
    test_ok(iso_point_set_update(s.set, &error), &error);
    test_ok(iso_point_set_bound(s.set, &error), &error);
    s.points = iso_point_set_view(s.set);
    return s;
}

static void voxels_at_the_isovalue_leave_no_holes(void **state) {
    (void)state;
    enum { SIZE = 300, INSIDE = 110 /* pixels; the ball's radius is 13 or 14 voxels of 10 */ };
    test_scene s = make_integers();
    for (int side = 0; side < 6; side++) {
        iso_view view = test_look_at(&s, side, 1, true, SIZE, SIZE);
        view.focal = 10;
        iso_gbuffer g = test_drawn(&view, &s.points, &curved, NULL);
        size_t holes = 0;
        for (int i = 0; i < SIZE * SIZE; i++) {
            const double x = i % SIZE + 0.5 - view.cx, y = i / SIZE + 0.5 - view.cy;
            holes += x * x + y * y < INSIDE * INSIDE && g.surface[i] == ISO_SURFACE_NONE;
        }
        assert_int_equal(holes, 0);
        iso_gbuffer_free(&g);
    }
    test_scene_free(&s);
}

/* The inside of half a sphere: the far half, seen from where its other half was, normals out of the solid.
 */
static void insides_are_seen(void **state) {
    (void)state;
    cloud *c = make_sphere(RADIUS);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < c->span.count; i++)
        if (c->surfels[i].position[2] > DISTANCE) {
            c->surfels[kept] = c->surfels[i];
            c->curvatures[kept++] = c->curvatures[i];
        }
    c->span.count = kept;
    const iso_view view = test_plain_view(160, 160, true, 6);
    iso_gbuffer g = test_drawn(&view, &c->points, &curved, NULL);
    for (size_t i = 0; i < samples_of(&view); i++) {
        const double x = ((double)(i % 160) + 0.5 - view.cx) / 6, y = ((double)(i / 160) + 0.5 - view.cy) / 6;
        const double square = x * x + y * y;
        if (square > 0.8 * RADIUS * RADIUS) continue;
        const double z = sqrt(RADIUS * RADIUS - square);
        assert_true(is_there(&g, i));
        assert_true(fabs((double)g.depth[i] - DISTANCE - z) < 0.03);
        assert_true((double)g.normal[0][i] * x + (double)g.normal[1][i] * y + (double)g.normal[2][i] * z >
                    0.999 * RADIUS);
    }
    iso_gbuffer_free(&g);
    c->points.closed = true; /* then they are hidden by what is not there */
    g = test_drawn(&view, &c->points, &curved, NULL);
    size_t seen = 0;
    for (size_t i = 0; i < samples_of(&view); i++) seen += is_there(&g, i);
    assert_true(seen < 500); /* a rim */
    iso_gbuffer_free(&g);
    free_cloud(c);
}

/* ---- the grid's border */

enum { BALL_SIDE = 24 };
static const double BALL_RADIUS = 9.3, BALL_CENTRE[3] = {3.2, 12.1, 21.4}; /* voxels: cut by two borders */

static test_scene make_cut_ball(bool floats) {
    iso_error error = {0};
    test_scene s = {0};
    const iso_rgrid_desc desc = {.dims = {BALL_SIDE, BALL_SIDE, BALL_SIDE}, .type = ISO_FLOAT32};
    test_ok(iso_rgrid_create(&desc, &s.grid.rgrid, &error), &error);
    float *value = (float *)s.grid.rgrid->data;
    for (int z = 0; z < BALL_SIDE; z++)
        for (int y = 0; y < BALL_SIDE; y++)
            for (int x = 0; x < BALL_SIDE; x++) {
                const double q[3] = {x - BALL_CENTRE[0], y - BALL_CENTRE[1], z - BALL_CENTRE[2]};
                value[x + y * s.grid.rgrid->stride_y + z * s.grid.rgrid->stride_z] =
                    (float)(BALL_RADIUS - sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]));
            }
    const iso_points_opts opts = {.floats = floats, .curvature = true};
    test_ok(iso_point_set_create(&s.grid, &opts, &s.set, &error), &error);
    test_ok(iso_point_set_update(s.set, &error), &error);
    s.points = iso_point_set_view(s.set);
    return s;
}

/* Whether a ray meets the ball in the grid, by more than a pixel's worth. */
static bool meets_ball(iso_vec3 from, iso_vec3 ray) {
    const double o[3] = {from.x - BALL_CENTRE[0], from.y - BALL_CENTRE[1], from.z - BALL_CENTRE[2]},
                 d[3] = {ray.x, ray.y, ray.z}, radius = BALL_RADIUS - 0.1;
    double a = 0, b = 0, c = -radius * radius;
    for (int k = 0; k < 3; k++) {
        a += d[k] * d[k];
        b += o[k] * d[k];
        c += o[k] * o[k];
    }
    if (b * b < a * c) return false;
    for (int root = -1; root <= 1; root += 2) {
        const double t = (-b + root * sqrt(b * b - a * c)) / a;
        bool in = true;
        for (int k = 0; k < 3; k++) {
            const double at = o[k] + t * d[k] + BALL_CENTRE[k];
            in = in && at > 0.1 && at < BALL_SIDE - 1.1;
        }
        if (in) return true;
    }
    return false;
}

/* Nothing is drawn outside the grid, and nothing is missing in it. */
static void surfaces_end_at_the_border(void **state) {
    (void)state;
    static const double zooms[] = {0.15, 1, 5};
    for (int n = 0; n < 12; n++) {
        test_scene s = make_cut_ball(n % 2);
        const iso_view view = test_look_at(&s, n, zooms[n % 3], n % 4 == 3, 150, 140);
        iso_gbuffer g = test_drawn(&view, &s.points, &curved, NULL);
        size_t seen = 0, holes = 0;
        for (size_t i = 0; i < samples_of(&view); i++) {
            iso_vec3 from, ray;
            iso_view_ray(&view, (double)(i % 150) + 0.5, (double)(i / 150) + 0.5, &from, &ray);
            holes += !is_there(&g, i) && meets_ball(from, ray);
            if (!is_there(&g, i)) continue;
            const iso_vec3 at = iso_vec3_add(from, iso_vec3_scale(ray, (double)g.depth[i]));
            const double least = fmin(at.x, fmin(at.y, at.z)), most = fmax(at.x, fmax(at.y, at.z));
            if (least < -0.002 || most > BALL_SIDE - 1 + 0.002)
                fail_msg("%d: drawn at %g %g %g", n, at.x, at.y, at.z);
            seen++;
        }
        assert_true(seen > 100);
        if (holes * 200 > seen) fail_msg("%d: %zu holes in %zu", n, holes, seen);
        iso_gbuffer_free(&g);
        test_scene_free(&s);
    }
}

/* Points before the near plane are left out, which cuts the plane and its one block; the eye may be in the
 * midst of points. */
static void near_plane(void **state) {
    (void)state;
    cloud *c = make_plane(SLOPE);
    iso_view view = test_plain_view(100, 100, false, 200);
    view.near = DISTANCE;
    iso_gbuffer g = test_drawn(&view, &c->points, &curved, NULL);
    for (size_t i = 0; i < samples_of(&view); i++) {
        const double u = ((double)(i % 100) + 0.5 - view.cx) / view.focal, x = DISTANCE * u / (1 - SLOPE * u);
        if (fabs(x) > 1.2) assert_int_equal(is_there(&g, i), x > 0);
    }
    iso_gbuffer_free(&g);
    free_cloud(c);
    test_scene s = test_scene_make("gyroid", 32, &(iso_points_opts){.curvature = true}, true);
    iso_view inside = test_look_at(&s, 0, 1, false, 120, 110);
    const iso_affine affine = iso_transform_affine(&s.points.transform);
    inside.eye = iso_affine_point(&affine, iso_vec3_make(15.3, 16.1, 15.8));
    inside.near = 0.3;
    g = test_drawn(&inside, &s.points, &curved, NULL);
    for (size_t i = 0; i < samples_of(&inside); i++) {
        if (!is_there(&g, i)) continue;
        const iso_vec3 n = iso_gbuffer_normal(&g, i);
        assert_true(isfinite(g.depth[i]) && fabs(iso_vec3_length(n) - 1) < 1e-3);
    }
    test_every_variant(&inside, &s.points, &curved, &g);
    iso_gbuffer_free(&g);
    test_scene_free(&s);
}

/* Discs beside the picture that are much nearer, and larger, than all of their block that is seen. */
static void large_discs_beside_the_picture(void **state) {
    (void)state;
    cloud *c = make_cloud(64);
    for (int i = 0; i < 64; i++)
        add_point(c, (const double[3]){0, (i - 32) * 0.01, i < 32 ? 10 : 90}, (const double[3]){0, 0, -1});
    for (int n = 0; n < 400; n++) {
        iso_view view = test_plain_view(8, 64, false, 330);
        view.cx = (n / 20 - 10) * 0.005;
        const float x = (float)(-1.375 * c->points.radius - 0.0005 * pow(1.3, n % 20));
        for (int i = 0; i < 64; i++) c->surfels[i].position[0] = x;
        iso_gbuffer g = test_drawn(&view, &c->points, &curved, NULL);
        test_every_variant(&view, &c->points, &curved, &g);
        iso_gbuffer_free(&g);
    }
    free_cloud(c);
}

/* Hiding leaves out nothing that shows: layers that are hidden by the first change no byte. */
static void hidden_points_change_nothing(void **state) {
    (void)state;
    for (int f = 0; f < 5; f++) {
        cloud *front = make_plane(SLOPE), *all = make_plane(SLOPE);
        const uint32_t count = all->span.count;
        all->surfels = realloc(all->surfels, 3 * count * sizeof *all->surfels);
        all->curvatures = realloc(all->curvatures, 3 * count * sizeof *all->curvatures);
        assert_true(all->surfels && all->curvatures);
        iso_point_span spans[3];
        for (uint32_t layer = 0; layer < 3; layer++) {
            spans[layer] = (iso_point_span){{0, 0, (int32_t)layer}, count, layer * (size_t)count};
            memcpy(all->surfels + layer * count, front->surfels, count * sizeof *all->surfels);
            memcpy(all->curvatures + layer * count, front->curvatures, count * sizeof *all->curvatures);
        }
        all->points.surfels = all->surfels;
        all->points.curvatures = all->curvatures;
        all->points.spans = spans;
        all->points.span_count = 3;
        const iso_view view = test_plain_view(150, 130, f % 2, FOCALS[f] * (f % 2 ? 1 : DISTANCE));
        iso_gbuffer a = test_drawn(&view, &front->points, &curved, NULL),
                    b = test_drawn(&view, &all->points, &curved, NULL);
        for (size_t i = 0; i < samples_of(&view); i++) {
            if (!is_there(&a, i)) continue;
            assert_true(a.depth[i] == b.depth[i]);
            for (int k = 0; k < 3; k++) assert_true(a.normal[k][i] == b.normal[k][i]);
        }
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
        free_cloud(front);
        free_cloud(all);
    }
}

enum { FEW_POINTS = 37 };

/* Points with radii of their own are not hidden by what has been drawn; the picture is the same. Blocks of
 * a few points, in the midst of others, are hidden at other times than large ones. */
static void hiding_changes_nothing(void **state) {
    (void)state;
    static const char *const names[] = {"gyroid", "head"};
    static const double zooms[] = {0.7, 2, 6, 20};
    for (int n = 0; n < 8; n++) {
        test_scene s = test_scene_make(names[n % 2], 40, &(iso_points_opts){.curvature = true}, true);
        const size_t count = iso_point_view_count(&s.points);
        float *radii = calloc(count, sizeof *radii);
        iso_point_span *spans = calloc(count, sizeof *spans);
        assert_true(radii && spans);
        for (size_t i = 0; i < count; i++) radii[i] = (float)s.points.radius;
        s.points.closed = n < 4;
        size_t some = 0;
        for (size_t k = 0; k < s.points.span_count; k++)
            for (uint32_t i = 0; i < s.points.spans[k].count; i += FEW_POINTS) {
                const uint32_t left = s.points.spans[k].count - i;
                spans[some] = s.points.spans[k];
                spans[some].first += i;
                spans[some++].count = left < FEW_POINTS ? left : FEW_POINTS;
            }
        for (int z = 0; z < 4; z++) {
            const iso_view view = test_look_at(&s, n + z, zooms[z], z == 1, 301, 145);
            iso_point_view points = s.points;
            if (n / 2 % 2) {
                points.bounds = NULL;
                points.spans = spans;
                points.span_count = some;
            }
            iso_gbuffer a = test_drawn(&view, &points, &curved, NULL);
            points.radii = radii;
            iso_gbuffer b = test_drawn(&view, &points, &curved, NULL);
            test_same_rows(&a, 0, &b);
            iso_gbuffer_free(&a);
            iso_gbuffer_free(&b);
        }
        free(radii);
        free(spans);
        test_scene_free(&s);
    }
}

/* Colours change nothing but the colours: coloured points are drawn as flat ones. */
static void colors_change_no_shape(void **state) {
    (void)state;
    cloud *c = make_sphere(RADIUS);
    uint8_t(*colors)[3] = calloc(c->span.count, sizeof *colors);
    assert_non_null(colors);
    c->points.curvatures = NULL;
    for (int zoom = 1; zoom <= 16; zoom *= 4) {
        const iso_view view = test_plain_view(120, 120, true, zoom);
        iso_gbuffer g[2];
        for (int k = 0; k < 2; k++) {
            c->points.colors = k ? (const uint8_t(*)[3])colors : NULL;
            g[k] = test_drawn(&view, &c->points, &(iso_point_surface_opts){0}, NULL);
        }
        test_same_rows(&g[1], 0, &g[0]);
        iso_gbuffer_free(&g[0]);
        iso_gbuffer_free(&g[1]);
    }
    free(colors);
    free_cloud(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(like_the_reference),
        cmocka_unit_test(colors_are_averaged),
        cmocka_unit_test(seams_do_not_show),
        cmocka_unit_test(slanted_discs_reach_over_seams),
        cmocka_unit_test(same_bytes_everywhere),
        cmocka_unit_test(known_surfaces),
        cmocka_unit_test(voxels_at_the_isovalue_leave_no_holes),
        cmocka_unit_test(insides_are_seen),
        cmocka_unit_test(surfaces_end_at_the_border),
        cmocka_unit_test(near_plane),
        cmocka_unit_test(large_discs_beside_the_picture),
        cmocka_unit_test(hidden_points_change_nothing),
        cmocka_unit_test(hiding_changes_nothing),
        cmocka_unit_test(colors_change_no_shape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
