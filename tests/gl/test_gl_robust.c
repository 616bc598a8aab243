/* The gl engine when things go wrong: contexts that are lost, limits that are small, memory that is short. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <glad/gl.h>

#include "apps/isorender/isorender.h"
#include "check_support.h"
#include "gl_support.h"
#include "render/gl/internal.h"
#include "render/gl/surface.h"

/* ---- a context that is lost at a call's turn: the driver tells of it once, as drivers may */

static int calls_until_loss;

static GLenum GLAD_API_PTR reset_status(void) {
    return calls_until_loss-- == 0 ? GL_INNOCENT_CONTEXT_RESET : GL_NO_ERROR;
}

static iso_gl_context *context_that_is_lost(iso_gl_kind kind, int after) {
    iso_gl_context *context;
    const iso_gl_context_opts opts = {.kind = kind};
    if (iso_gl_context_create(&opts, &context, NULL) != ISO_OK) return NULL;
    calls_until_loss = after;
    context->gl->GetGraphicsResetStatus = reset_status;
    return context;
}

static const iso_gl_kind kinds[] = {ISO_GL_EGL_SURFACELESS, ISO_GL_OSMESA};

typedef struct subject {
    iso_point point;
    iso_point_span span;
    iso_point_view points;
    iso_view view;
} subject;

static void make_subject(subject *s) {
    const iso_box box = {{0, 0, 0}, {16, 16, 16}};
    *s = (subject){.point = iso_point_pack(&(iso_surfel){{8, 8, 4}, {0, 0, -1}}), .span = {.count = 1}};
    s->points = (iso_point_view){.packed = &s->point,
                                 .spans = &s->span,
                                 .span_count = 1,
                                 .transform = iso_transform_identity(),
                                 .radius = 0.7};
    s->view = gl_side_view(&box, 0, false, 300, 200);
}

/* Everything that can be done with a context, until something fails. */
static iso_status do_everything(iso_gl_context *context, const subject *s, iso_error *error) {
    iso_gl_engine *engine;
    iso_gl_surface *surface = NULL;
    ISO_TRY(iso_gl_engine_create(context, &engine, error));
    engine->max_side = 100; /* six parts */
    iso_status status = iso_gl_upload_points(engine, &s->points, &surface, error);
    iso_gbuffer g = gl_gbuffer(&s->view);
    const iso_gl_draw_opts opts = {
        .view = &s->view, .surfaces = (const iso_gl_surface *const *)&surface, .surface_count = 1};
    for (int i = 0; i < 2 && status == ISO_OK; i++) status = iso_gl_draw(engine, &opts, &g, error);
    iso_gl_surface_destroy(surface);
    iso_gl_engine_destroy(engine);
    iso_gbuffer_free(&g);
    return status;
}

/* Losing it at any of its steps. */
static void a_lost_context_says_so(void **state) {
    (void)state;
    subject s;
    make_subject(&s);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        int losses = 0;
        for (int after = 0;; after++) {
            iso_gl_context *context = context_that_is_lost(kinds[k], after);
            if (!context) break;
            iso_error error = {ISO_OK, ""};
            iso_status status = do_everything(context, &s, &error);
            bool was_lost = calls_until_loss < 0;
            if (status == ISO_OK) { /* lost while its things were destroyed, or not at all */
                iso_gl_context_destroy(context);
                if (!was_lost) break;
                continue;
            }
            assert_int_equal(status, ISO_ERR_BACKEND);
            if (!strstr(error.text, "the context was lost")) fail_msg("%s", error.text);
            /* it stays so, though the driver says nothing more */
            error.text[0] = 0;
            assert_int_equal(do_everything(context, &s, &error), ISO_ERR_BACKEND);
            assert_non_null(strstr(error.text, "the context was lost"));
            iso_gl_context_destroy(context);
            losses++;
        }
        printf("kind %d: lost at %d steps\n", (int)kinds[k], losses);
        if (losses) assert_true(losses >= 2 + 2 * 6);
    }
}

/* The parts that come after a loss are not drawn. */
static void a_lost_context_ends_the_picture(void **state) {
    (void)state;
    subject s;
    make_subject(&s);
    iso_gl_context *context = context_that_is_lost(ISO_GL_EGL_SURFACELESS, 4);
    if (!context) skip();
    assert_int_equal(do_everything(context, &s, NULL), ISO_ERR_BACKEND);
    int asked = -1 - calls_until_loss;
    assert_true(asked <= 1);
    iso_gl_context_destroy(context);
}

/* ---- a whole run of the program: no file is left */

static iso_status run_program(iso_gl_context *context, const char *output, iso_error *error) {
    char *argv[] = {"isorender",
                    "scene:sphere:32",
                    "--output",
                    (char *)output,
                    "--turntable",
                    "4",
                    "--backend",
                    "egl",
                    "--quiet",
                    "--method",
                    "mesh",
                    "--mesh",
                    ISO_TEST_TMP "/lost.ply",
                    "--resolution",
                    "64x64",
                    "--json=" ISO_TEST_TMP "/lost.json"};
    static isorender_settings settings;
    const char *names[16];
    iso_operands operands = {names, 0};
    isorender_plan *plans;
    ISO_TRY(isorender_settings_parse(16, argv, &settings, &operands, error));
    isorender_film film = isorender_film_of(&settings);
    settings.film = &film;
    ISO_TRY(isorender_plans_make(&settings, &plans, error));
    iso_gl_engine *engine;
    assert_int_equal(iso_gl_engine_create(context, &engine, NULL), ISO_OK);
    const isorender_backend backend = {"egl", "test", context, engine};
    iso_status status = isorender_run(&settings, plans, NULL, &backend, NULL, error);
    iso_gl_engine_destroy(engine);
    isorender_plans_free(plans, settings.input_count);
    return status;
}

static bool is_there(const char *name) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", ISO_TEST_TMP, name);
    return access(path, F_OK) == 0;
}

static void a_lost_context_leaves_no_file(void **state) {
    (void)state;
    /* asked once each by the engine's creation and the upload, then twice a frame: lost in the third frame */
    iso_gl_context *context = context_that_is_lost(ISO_GL_EGL_SURFACELESS, 6);
    if (!context) skip();
    iso_error error = {ISO_OK, ""};
    iso_status status = run_program(context, ISO_TEST_TMP "/lost_{n:1}.png", &error);
    iso_gl_context_destroy(context);
    assert_int_equal(iso_status_exit(status), 4);
    if (!strstr(error.text, "the context was lost")) fail_msg("%s", error.text);
    const char *names[] = {"lost_0.png", "lost_1.png", "lost_2.png", "lost.ply", "lost.json"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) assert_false(is_there(names[i]));
}

/* ---- a hundred contexts of all kinds, some of them lost, made, used and destroyed in any order */

enum { SLOTS = 8, CONTEXTS = 100 };

typedef struct inhabitant {
    iso_gl_context *context;
    iso_gl_engine *engine;
    iso_gl_surface *surface;
    bool lost;
} inhabitant;

static bool move_in(inhabitant *who, const subject *s, iso_gl_kind kind, bool debug) {
    const iso_gl_context_opts opts = {.kind = kind, .debug = debug};
    *who = (inhabitant){.context = NULL};
    if (iso_gl_context_create(&opts, &who->context, NULL) != ISO_OK) return false;
    assert_int_equal(iso_gl_engine_create(who->context, &who->engine, NULL), ISO_OK);
    assert_int_equal(iso_gl_upload_points(who->engine, &s->points, &who->surface, NULL), ISO_OK);
    return true;
}

static void move_out(inhabitant *who) {
    iso_gl_surface_destroy(who->surface);
    iso_gl_engine_destroy(who->engine);
    iso_gl_context_destroy(who->context);
    *who = (inhabitant){.context = NULL};
}

/* All draw what the first one drew. */
static void live(inhabitant *who, const subject *s, iso_gbuffer *first, bool *has_first) {
    iso_gbuffer g = gl_gbuffer(&s->view);
    const iso_gl_draw_opts opts = {
        .view = &s->view, .surfaces = (const iso_gl_surface *const *)&who->surface, .surface_count = 1};
    iso_status status = iso_gl_draw(who->engine, &opts, &g, NULL);
    assert_int_equal(status, who->lost ? ISO_ERR_BACKEND : ISO_OK);
    size_t count = (size_t)g.width * (size_t)g.height;
    if (!who->lost && *has_first) {
        assert_memory_equal(first->surface, g.surface, count);
        assert_memory_equal(first->depth, g.depth, count * sizeof(float));
    } else if (!who->lost) {
        memcpy(first->surface, g.surface, count);
        memcpy(first->depth, g.depth, count * sizeof(float));
        *has_first = true;
    }
    iso_gbuffer_free(&g);
}

static void contexts_come_and_go_in_any_order(void **state) {
    (void)state;
    subject s;
    make_subject(&s);
    uint32_t seed = 5;
    inhabitant slots[SLOTS] = {{.context = NULL}};
    iso_gbuffer first = gl_gbuffer(&s.view);
    bool has_first = false;
    int made = 0, tried = 0, lost = 0;
    while (tried < CONTEXTS) {
        random_word(&seed);
        inhabitant *who = &slots[seed >> 8 & (SLOTS - 1)];
        uint32_t dice = seed >> 16 & 255;
        if (!who->context) {
            made += move_in(who, &s, (iso_gl_kind)(dice % ISO_GL_KINDS), dice & 64);
            tried++;
        } else if (dice < 80) {
            move_out(who);
        } else if (dice < 90 && !who->lost) {
            calls_until_loss = 0;
            who->context->gl->GetGraphicsResetStatus = reset_status;
            who->lost = true;
            lost++;
            live(who, &s, &first, &has_first);
        } else {
            live(who, &s, &first, &has_first);
        }
    }
    for (int i = 0; i < SLOTS; i++)
        if (slots[i].context) move_out(&slots[i]);
    iso_gbuffer_free(&first);
    printf("%d contexts, %d of them lost\n", made, lost);
    if (!made) skip();
}

/* ---- limits */

static GLint most_texture, most_view[2];
static void(GLAD_API_PTR *get_integers)(GLenum, GLint *);

static void GLAD_API_PTR small_driver(GLenum name, GLint *value) {
    get_integers(name, value);
    if (name == GL_MAX_TEXTURE_SIZE) value[0] = most_texture;
    if (name == GL_MAX_VIEWPORT_DIMS) memcpy(value, most_view, sizeof most_view);
}

static void small_drivers_draw_in_parts_or_not_at_all(void **state) {
    (void)state;
    static const struct {
        GLint texture, view[2];
        int side; /* 0: refused */
    } cases[] = {{1024, {16384, 16384}, 1024},
                 {16384, {16384, 1500}, 1244},
                 {16384, {2000, 16384}, 1744},
                 {16384, {32768, 32768}, 4096},
                 {16384, {300, 300}, 0},
                 {128, {16384, 16384}, 0},
                 {0, {0, 0}, 0}};
    iso_gl_context *context;
    const iso_gl_context_opts opts = {.kind = ISO_GL_EGL_SURFACELESS};
    if (iso_gl_context_create(&opts, &context, NULL) != ISO_OK) skip();
    get_integers = context->gl->GetIntegerv;
    context->gl->GetIntegerv = small_driver;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_gl_engine *engine = NULL;
        iso_error error = {ISO_OK, ""};
        most_texture = cases[i].texture;
        memcpy(most_view, cases[i].view, sizeof most_view);
        iso_status status = iso_gl_engine_create(context, &engine, &error);
        assert_int_equal(status, cases[i].side ? ISO_OK : ISO_ERR_BACKEND);
        if (!cases[i].side) assert_non_null(strstr(error.text, "pixels wide"));
        if (!cases[i].side) continue;
        assert_int_equal(engine->max_side, cases[i].side);
        /* of pictures beyond a part nothing more is taken */
        assert_true(iso_gl_draw_bytes(engine, 131072, 4096) ==
                    iso_gl_draw_bytes(engine, cases[i].side, cases[i].side));
        iso_gl_engine_destroy(engine);
    }
    iso_gl_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lost_context_says_so),
        cmocka_unit_test(a_lost_context_ends_the_picture),
        cmocka_unit_test(a_lost_context_leaves_no_file),
        cmocka_unit_test(contexts_come_and_go_in_any_order),
        cmocka_unit_test(small_drivers_draw_in_parts_or_not_at_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
