/* exact_support: draws by exact and by the ray caster, and compares the pictures. */
#include "exact_support.h"
#include "check_support.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/shading/shading.h"

iso_gbuffer empty_picture(const iso_view *view) {
    iso_gbuffer gbuffer;
    iso_error error = {0};
    test_ok(iso_gbuffer_create(view->width, view->height, &gbuffer, &error), &error);
    iso_gbuffer_clear(&gbuffer);
    for (int axis = 0; axis < 3; axis++)
        memset(gbuffer.normal[axis], 0, (size_t)(view->width * view->height) * sizeof(float));
    return gbuffer;
}

iso_exact *make_exact(const iso_grid *grid, double isovalue, iso_pool *pool) {
    const iso_exact_opts opts = {.isovalue = isovalue, .pool = pool};
    iso_exact *exact = NULL;
    iso_error error = {0};
    test_ok(iso_exact_create(grid, &opts, &exact, &error), &error);
    test_ok(iso_exact_update(exact, &error), &error);
    return exact;
}

void draw_exact(const iso_exact *exact, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool) {
    const iso_target target = {view, gbuffer, pool, 3, NULL};
    iso_error error = {0};
    test_ok(iso_draw_exact(&target, exact, &error), &error);
}

iso_gbuffer picture_of(const iso_grid *grid, double isovalue, const iso_view *view, iso_pool *pool) {
    iso_gbuffer gbuffer = empty_picture(view);
    iso_exact *exact = make_exact(grid, isovalue, pool);
    draw_exact(exact, view, &gbuffer, pool);
    iso_exact_destroy(exact);
    for (int i = 0; i < view->width * view->height; i++)
        assert_int_equal(gbuffer.surface[i], isfinite(gbuffer.depth[i]) ? 3 : ISO_SURFACE_NONE);
    return gbuffer;
}

iso_gbuffer truth_of(const iso_grid *grid, double isovalue, const iso_view *view) {
    iso_gbuffer gbuffer = empty_picture(view);
    iso_raycaster *caster;
    iso_error error = {0};
    test_ok(iso_raycaster_create(grid, isovalue, NULL, &caster, &error), &error);
    const iso_target target = {view, &gbuffer, NULL, 3, NULL};
    test_ok(iso_draw_raycast(&target, caster, &error), &error);
    iso_raycaster_destroy(caster);
    return gbuffer;
}

static double smallest_spacing(const iso_grid *grid) {
    const double *spacing = iso_grid_transform(grid)->spacing;
    return fmin(spacing[0], fmin(spacing[1], spacing[2]));
}

static iso_image shaded(const iso_view *view, const iso_gbuffer *gbuffer) {
    const iso_rgb color = {0xD9, 0xB3, 0x6C};
    const iso_shading shading = {.colors = &color, .color_count = 1};
    iso_image image;
    iso_error error = {0};
    test_ok(iso_image_create(view->width, view->height, &image, &error), &error);
    const iso_strip strip = {.view = view, .gbuffer = gbuffer, .factor = 1};
    iso_shade(&shading, &strip, &image, NULL);
    return image;
}

static void judge_pictures(const iso_view *view, const iso_gbuffer *got, const iso_gbuffer *wanted,
                           double voxel, test_verdict *verdict) {
    iso_image a = shaded(view, got), b = shaded(view, wanted);
    for (int i = 0; i < view->width * view->height; i++) {
        bool hit = isfinite(got->depth[i]), expected = isfinite(wanted->depth[i]);
        verdict->samples++;
        verdict->hits += expected;
        verdict->missing += expected && !hit;
        verdict->extra += hit && !expected;
        if (!hit || !expected) continue;
        int difference = 0;
        for (int c = 0; c < 3; c++) {
            int d = abs(a.rgba[4 * i + c] - b.rgba[4 * i + c]);
            if (d > difference) difference = d;
        }
        if (fabs((double)got->depth[i] - (double)wanted->depth[i]) > 1e-3 * voxel)
            verdict->deep++;
        else
            verdict->tinted += difference > 1;
    }
    iso_image_free(&a);
    iso_image_free(&b);
}

void judge(const iso_grid *grid, double isovalue, const iso_view *view, test_verdict *verdict) {
    iso_gbuffer got = picture_of(grid, isovalue, view, NULL), wanted = truth_of(grid, isovalue, view);
    judge_pictures(view, &got, &wanted, smallest_spacing(grid), verdict);
    iso_gbuffer_free(&got);
    iso_gbuffer_free(&wanted);
}
