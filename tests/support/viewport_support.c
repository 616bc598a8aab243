/* viewport_support: drawing and sculpting a ball as isosculpt's window does. */
#include "viewport_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "check_support.h"
#include "sculpt_support.h"

const iso_journal_start VIEWPORT_START = {.source = "ball",
                                          .voxel_size = 0.5,
                                          .dims = {96, 96, 96},
                                          .origin = {-23.75, -23.75, -23.75},
                                          .radius = 15};

iso_session *viewport_session(iso_pool *pool) {
    iso_error error = {0};
    iso_hgrid *grid;
    iso_session *session;
    const iso_session_opts opts = {.pool = pool};
    test_ok(iso_session_solid(&VIEWPORT_START, &grid, &error), &error);
    test_ok(iso_session_create(grid, &VIEWPORT_START, &opts, &session, &error), &error);
    return session;
}

void viewport_draw(isosculpt_viewport *view, bool moving) {
    iso_error error = {0};
    test_ok(isosculpt_viewport_draw(view, VIEWPORT_WIDTH, VIEWPORT_HEIGHT, moving, &error), &error);
}

void viewport_refine(isosculpt_viewport *view) {
    iso_error error = {0};
    while (view->quality != ISOSCULPT_QUALITY_FINE) test_ok(isosculpt_viewport_refine(view, &error), &error);
}

iso_sample viewport_sample(uint32_t *seed) {
    iso_vec3 out = iso_vec3_make(uniform(seed) - 0.5, uniform(seed) - 0.7, uniform(seed) - 0.5);
    out = iso_vec3_unit(out);
    return (iso_sample){.position = iso_vec3_scale(out, VIEWPORT_START.radius), .normal = out, .pressure = 1};
}

size_t viewport_stroke(isosculpt_viewport *view, iso_session *session, const iso_brush *brush,
                       uint32_t *seed) {
    iso_sample sample = viewport_sample(seed);
    size_t drawn = 0;
    assert_int_equal(iso_session_begin(session, brush, &sample, NULL, NULL), ISO_OK);
    for (int i = 0; i < 3; i++) {
        viewport_draw(view, true);
        drawn += isosculpt_damage_area(&view->redrawn);
        sample.position.x += 0.7;
        assert_int_equal(iso_session_sample(session, &sample, NULL, NULL), ISO_OK);
    }
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    viewport_draw(view, true);
    return drawn;
}

void viewport_same_samples(const isosculpt_viewport *a, const isosculpt_viewport *b) {
    const iso_gbuffer *x = &a->drawn.gbuffer, *y = &b->drawn.gbuffer;
    assert_memory_equal(x->depth, y->depth, VIEWPORT_PIXELS * sizeof *x->depth);
    assert_memory_equal(x->surface, y->surface, VIEWPORT_PIXELS);
    for (size_t i = 0; i < VIEWPORT_PIXELS; i++)
        for (int axis = 0; axis < 3 && x->surface[i] != ISO_SURFACE_NONE; axis++)
            if (x->normal[axis][i] != y->normal[axis][i]) fail_msg("normal of pixel %zu", i);
}
