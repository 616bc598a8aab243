/* Pictures that stay on the GPU, against the cpu engine's; and contexts that others draw with too. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <glad/gl.h>

#include "gl_support.h"
#include "grids/scenes/scenes.h"
#include "render/gl/canvas.h"
#include "render/gl/surface.h"
#include "render/picture.h"
#include "render/raster/raster.h"

enum { WIDTH = 250, HEIGHT = 190, SPHERE = 64 };

static const iso_rgb COLOR = {206, 142, 112}, BACKGROUND = {46, 50, 56};

typedef enum draw_method { POINTS, MESH, GAUSSIAN, CURVED, METHODS } draw_method;
static const char *const method_names[METHODS] = {"points", "mesh", "gaussian", "curved"};

/* What is drawn, by both engines. */
typedef struct subject {
    iso_grid grid;
    gl_surface surface;
    iso_camera camera;
} subject;

static subject make_subject(void) {
    subject s;
    double isovalue;
    const iso_scene_opts opts = {.size = 48, .dense = true};
    assert_int_equal(iso_scene_create("gyroid", &opts, &s.grid, &isovalue, NULL), ISO_OK);
    s.surface = gl_surface_make(&s.grid, isovalue);
    s.camera = (iso_camera){.position = {-1, -2, 1.5}, .view_up = {0, 0, 1}, .view_angle = 30};
    iso_camera_fit(&s.camera, &s.surface.box, (double)WIDTH / HEIGHT, 1);
    return s;
}

static void free_subject(subject *s) {
    gl_surface_free(&s->surface);
    iso_grid_destroy(&s->grid);
}

static iso_reconstruction reconstruction_of(draw_method method) {
    return method == CURVED ? ISO_RECONSTRUCTION_CURVED : ISO_RECONSTRUCTION_GAUSSIAN;
}

/* ---- the cpu engine's */

typedef struct cpu_drawing {
    const subject *s;
    draw_method method;
} cpu_drawing;

static iso_status draw_by_cpu(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const cpu_drawing *d = context;
    const iso_target target = {.view = view, .gbuffer = gbuffer};
    iso_point_view points = iso_point_set_view(d->s->surface.packed);
    iso_mesh_view mesh = iso_mesh_set_view(d->s->surface.mesh);
    const iso_point_surface_opts filled = {.reconstruction = reconstruction_of(d->method)};
    if (d->method == POINTS) return iso_draw_points(&target, &points, error);
    if (d->method == MESH) return iso_draw_mesh(&target, &mesh, error);
    return iso_draw_point_surface(&target, &points, &filled, error);
}

static iso_image cpu_picture(const subject *s, draw_method method, int factor) {
    iso_image image;
    cpu_drawing drawing = {s, method};
    const iso_picture_opts opts = {.camera = &s->camera,
                                   .width = WIDTH,
                                   .height = HEIGHT,
                                   .samples = factor * factor,
                                   .shading = {&COLOR, 1, BACKGROUND, 0},
                                   .draw = draw_by_cpu,
                                   .draw_context = &drawing};
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
    assert_int_equal(iso_picture_render(&opts, &image, NULL, NULL), ISO_OK);
    return image;
}

/* ---- the gl engine's */

typedef struct easel {
    iso_gl_engine *engine;
    iso_gl_surface *points, *mesh;
    iso_gl_canvas *canvas;
} easel;

static easel make_easel(iso_gl_context *context, const subject *s) {
    easel e;
    iso_point_view points = iso_point_set_view(s->surface.packed);
    iso_mesh_view mesh = iso_mesh_set_view(s->surface.mesh);
    assert_int_equal(iso_gl_engine_create(context, &e.engine, NULL), ISO_OK);
    assert_int_equal(iso_gl_upload_points(e.engine, &points, &e.points, NULL), ISO_OK);
    assert_int_equal(iso_gl_upload_mesh(e.engine, &mesh, &e.mesh, NULL), ISO_OK);
    assert_int_equal(iso_gl_canvas_create(e.engine, &e.canvas, NULL), ISO_OK);
    return e;
}

static void free_easel(easel *e) {
    iso_gl_canvas_destroy(e->canvas);
    iso_gl_surface_destroy(e->points);
    iso_gl_surface_destroy(e->mesh);
    iso_gl_engine_destroy(e->engine);
}

static iso_view samples_of(const subject *s, int factor) {
    const iso_view pixels = iso_view_make(&s->camera, WIDTH, HEIGHT);
    return iso_view_scaled(&pixels, factor);
}

static iso_status paint_canvas(const easel *e, const subject *s, draw_method method,
                               const iso_gl_paint *paint, iso_error *error) {
    const iso_view view = samples_of(s, paint->factor);
    const iso_gl_surface *surface = method == MESH ? e->mesh : e->points;
    const iso_gl_draw_opts draw = {.view = &view, .surfaces = &surface, .surface_count = 1};
    const iso_gl_pullpush_opts pullpush = {&view, &surface, 1, reconstruction_of(method), ISO_SELECTION_ALL};
    return method >= GAUSSIAN ? iso_gl_canvas_draw_pullpush(e->canvas, &pullpush, paint, error)
                              : iso_gl_canvas_draw(e->canvas, &draw, paint, error);
}

static iso_image gl_picture(const easel *e, const subject *s, draw_method method, const iso_gl_paint *paint) {
    iso_image image;
    iso_error error = {ISO_OK, ""};
    if (paint_canvas(e, s, method, paint, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
    assert_int_equal(iso_gl_canvas_read(e->canvas, &image, NULL), ISO_OK);
    return image;
}

static iso_gl_paint lamps(int factor) {
    return (iso_gl_paint){.factor = factor, .color = COLOR, .background = BACKGROUND};
}

/* ---- pictures */

static void check_against_cpu(const easel *e, const subject *s, const char *name) {
    double worst = INFINITY;
    for (int m = 0; m < METHODS; m++)
        for (int factor = 1; factor <= 3; factor++) {
            const iso_gl_paint paint = lamps(factor);
            iso_image cpu = cpu_picture(s, (draw_method)m, factor),
                      gl = gl_picture(e, s, (draw_method)m, &paint);
            double psnr = gl_psnr(&cpu, &gl);
            if (!(psnr >= 40)) fail_msg("%s, %s, %d: %.1f dB", name, method_names[m], factor, psnr);
            worst = fmin(worst, psnr);
            iso_image_free(&cpu);
            iso_image_free(&gl);
        }
    printf("%s: %.1f dB\n", name, worst);
}

static void pictures_are_the_cpu_engines(iso_gl_context *context) {
    subject s = make_subject();
    easel e = make_easel(context, &s);
    const char *name = iso_gl_context_info(context).name;
    check_against_cpu(&e, &s, name);
    e.engine->max_side = 101; /* in parts, whose sides are no multiples of factors */
    check_against_cpu(&e, &s, name);
    e.engine->max_storage = 600000;
    check_against_cpu(&e, &s, name);
    free_easel(&e);
    free_subject(&s);
}

/* A sphere's picture that says where it was looked at: both ways into it agree with the normals drawn. */
static void colours_come_from_the_sphere(iso_gl_context *context) {
    static uint8_t sphere[SPHERE][SPHERE][3];
    subject s = make_subject();
    for (int y = 0; y < SPHERE; y++)
        for (int x = 0; x < SPHERE; x++) memcpy(sphere[y][x], (uint8_t[3]){(uint8_t)x, (uint8_t)y, 77}, 3);
    iso_gl_paint paint = lamps(1);
    paint.sphere = sphere[0][0];
    paint.sphere_side = SPHERE;
    easel e = make_easel(context, &s);
    for (int m = 0; m < METHODS; m++) {
        iso_image image = gl_picture(&e, &s, (draw_method)m, &paint);
        int seen = 0;
        for (int y = 0; y < HEIGHT; y += 3)
            for (int x = 0; x < WIDTH; x += 3) {
                float n[4];
                const uint8_t *rgb = image.rgba + 4 * (y * WIDTH + x);
                bool there = iso_gl_canvas_pick(e.canvas, x, y, n);
                assert_int_equal(rgb[2], there ? 77 : BACKGROUND.b);
                if (!there) continue;
                float turned = n[2] > 0 ? -1.0f : 1.0f;
                for (int k = 0; k < 2; k++)
                    assert_true(fabsf((n[k] * turned * 0.5f + 0.5f) * SPHERE - (rgb[k] + 0.5f)) < 0.51f ||
                                rgb[k] == SPHERE - 1);
                seen++;
            }
        assert_true(seen > 500);
        iso_image_free(&image);
    }
    free_easel(&e);
    free_subject(&s);
}

/* What a cursor finds is what the gbuffer would have; finer pictures leave it, copies keep it. */
static void picks_are_the_samples(iso_gl_context *context) {
    subject s = make_subject();
    easel e = make_easel(context, &s);
    const iso_view view = samples_of(&s, 1);
    const iso_gl_surface *surface = e.mesh;
    const iso_gl_draw_opts opts = {.view = &view, .surfaces = &surface, .surface_count = 1};
    const iso_gl_paint once = lamps(1), finer = lamps(2);
    iso_gbuffer g = gl_gbuffer(&view);
    iso_gl_canvas *copy;
    assert_int_equal(iso_gl_canvas_create(e.engine, &copy, NULL), ISO_OK);
    assert_int_equal(iso_gl_canvas_texture(copy), 0);
    assert_int_equal(iso_gl_draw(e.engine, &opts, &g, NULL), ISO_OK);
    assert_int_equal(paint_canvas(&e, &s, MESH, &once, NULL), ISO_OK);
    assert_int_equal(paint_canvas(&e, &s, MESH, &finer, NULL), ISO_OK);
    assert_int_equal(iso_gl_canvas_copy(copy, e.canvas, NULL), ISO_OK);
    assert_int_equal(paint_canvas(&e, &s, POINTS, &once, NULL), ISO_OK); /* the copy is its own */
    int seen = 0;
    for (int y = 0; y < HEIGHT; y += 7)
        for (int x = 0; x < WIDTH; x += 7) {
            float n[4];
            size_t at = (size_t)(y * WIDTH + x);
            bool there = iso_gl_canvas_pick(copy, x, y, n);
            assert_int_equal(there, g.surface[at] != ISO_SURFACE_NONE);
            if (!there) continue;
            assert_true(n[3] == g.depth[at] && n[0] == g.normal[0][at] && n[2] == g.normal[2][at]);
            seen++;
        }
    assert_true(seen > 100);
    float n[4];
    assert_false(iso_gl_canvas_pick(copy, -1, 0, n) || iso_gl_canvas_pick(copy, 0, HEIGHT, n));
    iso_gl_canvas_destroy(copy);
    iso_gbuffer_free(&g);
    free_easel(&e);
    free_subject(&s);
}

/* ---- a window: a context that somebody else made, and draws with */

static iso_gl_context *owner;

static void make_current(void *window) {
    assert_ptr_equal(window, owner);
    owner->platform.enter(&owner->platform);
}

static iso_gl_function address_of(const char *name) {
    return owner->platform.address(&owner->platform, name);
}

/* Everything that a program may have left switched on or off. */
static void make_a_mess(const GladGLContext *gl) {
    static const GLenum on[] = {GL_BLEND,        GL_CULL_FACE,           GL_STENCIL_TEST,
                                GL_SCISSOR_TEST, GL_POLYGON_OFFSET_FILL, GL_PRIMITIVE_RESTART};
    for (size_t i = 0; i < sizeof on / sizeof *on; i++) gl->Enable(on[i]);
    gl->CullFace(GL_FRONT_AND_BACK);
    gl->BlendFunc(GL_ZERO, GL_ZERO);
    gl->BlendFunci(2, GL_DST_COLOR, GL_ONE_MINUS_SRC_ALPHA);
    gl->BlendEquationSeparatei(1, GL_MAX, GL_FUNC_REVERSE_SUBTRACT);
    gl->Scissor(3, 4, 5, 6);
    gl->Viewport(7, 8, 9, 10);
    gl->DepthFunc(GL_NEVER);
    gl->DepthMask(GL_FALSE);
    gl->ColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    gl->ClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    gl->PixelStorei(GL_PACK_ROW_LENGTH, 33);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 2);
    gl->PixelStorei(GL_UNPACK_SKIP_ROWS, 1);
}

/* Of everything that OpenGL tells by one number, or by four. */
typedef struct settings {
    GLint value[512][4];
} settings;

static settings take_settings(const GladGLContext *gl) {
    static const GLenum names[] = {GL_BLEND,
                                   GL_CULL_FACE,
                                   GL_CULL_FACE_MODE,
                                   GL_STENCIL_TEST,
                                   GL_DEPTH_TEST,
                                   GL_DEPTH_FUNC,
                                   GL_DEPTH_WRITEMASK,
                                   GL_DEPTH_CLAMP,
                                   GL_DEPTH_RANGE,
                                   GL_COLOR_WRITEMASK,
                                   GL_COLOR_LOGIC_OP,
                                   GL_SCISSOR_TEST,
                                   GL_SCISSOR_BOX,
                                   GL_VIEWPORT,
                                   GL_POLYGON_MODE,
                                   GL_POLYGON_OFFSET_FILL,
                                   GL_PROGRAM_POINT_SIZE,
                                   GL_POINT_SIZE,
                                   GL_PRIMITIVE_RESTART,
                                   GL_PRIMITIVE_RESTART_FIXED_INDEX,
                                   GL_RASTERIZER_DISCARD,
                                   GL_SAMPLE_MASK,
                                   GL_SAMPLE_COVERAGE,
                                   GL_MULTISAMPLE,
                                   GL_FRAMEBUFFER_SRGB,
                                   GL_CLIP_ORIGIN,
                                   GL_CLIP_DEPTH_MODE,
                                   GL_DRAW_FRAMEBUFFER_BINDING,
                                   GL_READ_FRAMEBUFFER_BINDING,
                                   GL_RENDERBUFFER_BINDING,
                                   GL_CURRENT_PROGRAM,
                                   GL_VERTEX_ARRAY_BINDING,
                                   GL_ARRAY_BUFFER_BINDING,
                                   GL_ELEMENT_ARRAY_BUFFER_BINDING,
                                   GL_DRAW_INDIRECT_BUFFER_BINDING,
                                   GL_DISPATCH_INDIRECT_BUFFER_BINDING,
                                   GL_UNIFORM_BUFFER_BINDING,
                                   GL_SHADER_STORAGE_BUFFER_BINDING,
                                   GL_PIXEL_PACK_BUFFER_BINDING,
                                   GL_PIXEL_UNPACK_BUFFER_BINDING,
                                   GL_COPY_READ_BUFFER_BINDING,
                                   GL_COPY_WRITE_BUFFER_BINDING,
                                   GL_ACTIVE_TEXTURE,
                                   GL_TEXTURE_BINDING_2D,
                                   GL_PACK_ALIGNMENT,
                                   GL_PACK_ROW_LENGTH,
                                   GL_PACK_SKIP_ROWS,
                                   GL_PACK_SKIP_PIXELS,
                                   GL_UNPACK_ALIGNMENT,
                                   GL_UNPACK_ROW_LENGTH,
                                   GL_UNPACK_SKIP_ROWS,
                                   GL_UNPACK_SKIP_PIXELS,
                                   GL_PATCH_VERTICES};
    settings s;
    memset(&s, 0, sizeof s);
    size_t count = sizeof names / sizeof *names;
    for (size_t i = 0; i < count; i++) gl->GetIntegerv(names[i], s.value[i]);
    for (GLuint slot = 0; slot < 8; slot++) {
        GLfloat value[4];
        gl->GetVertexAttribfv(slot, GL_CURRENT_VERTEX_ATTRIB, value);
        memcpy(s.value[count + slot], value, sizeof value);
    }
    for (GLuint slot = 0; slot < 8; slot++) {
        GLint *to = s.value[count + 8 + slot];
        gl->GetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, slot, to);
        gl->GetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, slot, to + 1);
        gl->GetIntegeri_v(GL_IMAGE_BINDING_NAME, slot, to + 2);
    }
    static const GLenum blends[] = {GL_BLEND_SRC_RGB,   GL_BLEND_DST_RGB,      GL_BLEND_SRC_ALPHA,
                                    GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};
    for (GLuint output = 0; output < 8; output++)
        for (size_t i = 0; i < sizeof blends / sizeof *blends; i++)
            gl->GetIntegeri_v(blends[i], output, s.value[count + 16 + 8 * i + output]);
    return s;
}

static void assert_same_settings(const settings *a, const settings *b, const char *when) {
    for (size_t i = 0; i < sizeof a->value / sizeof *a->value; i++)
        if (memcmp(a->value[i], b->value[i], sizeof a->value[i]))
            fail_msg("%s: number %zu was %d, is %d", when, i, a->value[i][0], b->value[i][0]);
}

static void windows_are_left_as_they_were(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    subject s = make_subject();
    for (int c = 0; c < contexts.count; c++) {
        owner = contexts.context[c];
        const GladGLContext *gl = owner->gl;
        const iso_gl_context_opts opts = {.kind = ISO_GL_WINDOW, .window = {owner, make_current, address_of}};
        iso_gl_context *window;
        make_current(owner);
        make_a_mess(gl);
        const settings before = take_settings(gl);
        assert_int_equal(iso_gl_context_create(&opts, &window, NULL), ISO_OK);
        assert_string_equal(iso_gl_context_info(window).name, "window");
        assert_string_equal(iso_gl_context_info(window).renderer, iso_gl_context_info(owner).renderer);
        easel e = make_easel(window, &s);
        settings after = take_settings(gl);
        assert_same_settings(&before, &after, "made");
        for (int m = 0; m < METHODS; m++) {
            const iso_gl_paint paint = lamps(2);
            iso_image cpu = cpu_picture(&s, (draw_method)m, 2),
                      gl_image = gl_picture(&e, &s, (draw_method)m, &paint);
            assert_true(gl_psnr(&cpu, &gl_image) >= 40);
            after = take_settings(gl);
            assert_same_settings(&before, &after, method_names[m]);
            iso_image_free(&cpu);
            iso_image_free(&gl_image);
        }
        free_easel(&e);
        assert_int_equal(iso_gl_context_messages(window).count, 0);
        iso_gl_context_destroy(window);
        after = take_settings(gl); /* still current */
        assert_same_settings(&before, &after, "gone");
        gl->BindBuffer(GL_ARRAY_BUFFER, 99999); /* nobody is told who is gone */
        while (gl->GetError() != GL_NO_ERROR) continue;
        owner->platform.leave(&owner->platform);
    }
    free_subject(&s);
    for (int c = 0; c < contexts.count; c++) iso_gl_context_destroy(contexts.context[c]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_context_test(pictures_are_the_cpu_engines),
        gl_context_test(colours_come_from_the_sphere),
        gl_context_test(picks_are_the_samples),
        cmocka_unit_test(windows_are_left_as_they_were),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
