/* canvas: two textures (colours, samples) that a compute shader (shaders/shade.comp) fills from the engine's
 * framebuffer or from the picture buffer of pull-push. */
#include "render/gl/canvas.h"

#include <assert.h>
#include <glad/gl.h>

#include "base/memory.h"
#include "render/gl/output.h"
#include "render/gl/shared.h"
#include "render/gl/surface.h"

_Static_assert(sizeof(iso_gl_shade_uniforms) == 80, "layout of std140");

struct iso_gl_canvas {
    iso_gl_engine *engine;
    int width, height; /* 0: empty */
    unsigned colors, samples, sphere, uniforms;
    int sphere_side;
};

static const GladGLContext *gl_of(const iso_gl_canvas *canvas) {
    return canvas->engine->context->gl;
}

/* ---- life */

iso_status iso_gl_canvas_create(iso_gl_engine *engine, iso_gl_canvas **canvas, iso_error *error) {
    iso_gl_canvas *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a canvas");
    made->engine = engine;
    *canvas = made;
    return ISO_OK;
}

static void delete_textures(iso_gl_canvas *canvas) {
    const GLuint textures[] = {canvas->colors, canvas->samples};
    gl_of(canvas)->DeleteTextures(2, textures); /* 0 is ignored */
    canvas->colors = canvas->samples = 0;
    canvas->width = canvas->height = 0;
}

void iso_gl_canvas_destroy(iso_gl_canvas *canvas) {
    if (!canvas) return;
    iso_gl_context *context = canvas->engine->context;
    if (iso_gl_enter(context, NULL) == ISO_OK) {
        delete_textures(canvas);
        gl_of(canvas)->DeleteTextures(1, &canvas->sphere);
        gl_of(canvas)->DeleteBuffers(1, &canvas->uniforms);
        iso_gl_leave(context, ISO_OK, NULL);
    }
    iso_free(canvas);
}

/* ---- textures */

static GLuint make_texture(const GladGLContext *gl, GLenum format, GLint filter, int width, int height) {
    GLuint texture;
    gl->CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl->TextureStorage2D(texture, 1, format, width, height);
    gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, filter);
    gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, filter);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

static void ensure_size(iso_gl_canvas *canvas, int width, int height) {
    const GladGLContext *gl = gl_of(canvas);
    if (canvas->width == width && canvas->height == height) return;
    delete_textures(canvas);
    canvas->colors = make_texture(gl, GL_RGBA8, GL_LINEAR, width, height);
    canvas->samples = make_texture(gl, GL_RGBA32F, GL_NEAREST, width, height);
    canvas->width = width;
    canvas->height = height;
}

static void upload_sphere(iso_gl_canvas *canvas, const iso_gl_paint *paint) {
    const GladGLContext *gl = gl_of(canvas);
    const int side = paint->sphere ? paint->sphere_side : 1;
    if (canvas->sphere_side != side) {
        gl->DeleteTextures(1, &canvas->sphere);
        canvas->sphere = make_texture(gl, GL_RGBA8, GL_NEAREST, side, side);
        canvas->sphere_side = side;
    }
    if (!paint->sphere) return;
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TextureSubImage2D(canvas->sphere, 0, 0, 0, side, side, GL_RGB, GL_UNSIGNED_BYTE, paint->sphere);
}

/* ---- shading */

static void set_color(float to[4], iso_rgb color) {
    to[0] = (float)color.r / 255;
    to[1] = (float)color.g / 255;
    to[2] = (float)color.b / 255;
}

static void bind_uniforms(const iso_gl_output *to, const iso_view *part, int x, int y) {
    const iso_gl_paint *paint = to->paint;
    iso_gl_canvas *canvas = to->canvas;
    const GladGLContext *gl = gl_of(canvas);
    const int factor = paint->factor;
    iso_gl_shade_uniforms s = {
        .ray = {(float)part->cx, (float)part->cy, part->orthographic ? 0 : (float)(1 / part->focal)},
        .part = {part->width / factor, part->height / factor, x / factor, y / factor},
        .how = {factor, factor == 1, paint->sphere != NULL}};
    set_color(s.color, paint->color);
    set_color(s.background, paint->background);
    if (!canvas->uniforms) {
        gl->CreateBuffers(1, &canvas->uniforms);
        gl->NamedBufferStorage(canvas->uniforms, sizeof s, NULL, GL_DYNAMIC_STORAGE_BIT);
    }
    gl->NamedBufferSubData(canvas->uniforms, 0, sizeof s, &s);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_SHADE, canvas->uniforms);
}

iso_status iso_gl_canvas_shade(const iso_gl_output *to, bool pullpush, const iso_view *part, int x, int y,
                               iso_error *error) {
    iso_gl_canvas *canvas = to->canvas;
    iso_gl_engine *engine = canvas->engine;
    const GladGLContext *gl = gl_of(canvas);
    const int factor = to->paint->factor;
    assert(part->width % factor == 0 && part->height % factor == 0 && x % factor == 0 && y % factor == 0);
    unsigned program;
    ISO_TRY(iso_gl_engine_program(engine, pullpush ? ISO_GL_SHADE_PICTURE : ISO_GL_SHADE_TARGET, &program,
                                  error));
    bind_uniforms(to, part, x, y);
    if (pullpush)
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_PICTURE, engine->storage[ISO_GL_STORE_PICTURE]);
    gl->BindTextureUnit(ISO_GL_NORMAL_DEPTHS, engine->target.colors[ISO_GL_NORMAL_DEPTH]);
    gl->BindTextureUnit(ISO_GL_SPHERE, canvas->sphere);
    gl->BindImageTexture(ISO_GL_COLORS, canvas->colors, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
    gl->BindImageTexture(ISO_GL_SAMPLES, canvas->samples, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    gl->UseProgram(program);
    gl->DispatchCompute((GLuint)(part->width / factor + ISO_GL_TILE - 1) / ISO_GL_TILE,
                        (GLuint)(part->height / factor + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    /* The textures are sampled, copied or read next, and the next part reuses the framebuffer and buffers. */
    gl->MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                      GL_FRAMEBUFFER_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                      GL_BUFFER_UPDATE_BARRIER_BIT);
    return ISO_OK;
}

/* ---- drawing */

static iso_status prepare_canvas(iso_gl_canvas *canvas, const iso_view *view, const iso_gl_paint *paint,
                                 iso_error *error) {
    assert(paint->factor >= 1 && view->width % paint->factor == 0 && view->height % paint->factor == 0);
    iso_gl_context *context = canvas->engine->context;
    ISO_TRY(iso_gl_enter(context, error));
    ensure_size(canvas, view->width / paint->factor, view->height / paint->factor);
    upload_sphere(canvas, paint);
    return iso_gl_leave(context, ISO_OK, error);
}

static iso_status finish_draw(iso_gl_canvas *canvas, iso_status status, iso_error *error) {
    iso_gl_context *context = canvas->engine->context;
    if (iso_gl_enter(context, status == ISO_OK ? error : NULL) != ISO_OK)
        return status == ISO_OK ? ISO_ERR_BACKEND : status;
    if (status == ISO_OK) gl_of(canvas)->Finish();
    if (status != ISO_OK) delete_textures(canvas);
    return iso_gl_leave(context, status, error);
}

iso_status iso_gl_canvas_draw(iso_gl_canvas *canvas, const iso_gl_draw_opts *opts, const iso_gl_paint *paint,
                              iso_error *error) {
    const iso_gl_output to = {.canvas = canvas, .paint = paint};
    iso_status status = prepare_canvas(canvas, opts->view, paint, error);
    if (status == ISO_OK) status = iso_gl_draw_to(canvas->engine, opts, &to, error);
    return finish_draw(canvas, status, error);
}

iso_status iso_gl_canvas_draw_pullpush(iso_gl_canvas *canvas, const iso_gl_pullpush_opts *opts,
                                       const iso_gl_paint *paint, iso_error *error) {
    const iso_gl_output to = {.canvas = canvas, .paint = paint};
    iso_status status = prepare_canvas(canvas, opts->view, paint, error);
    if (status == ISO_OK) status = iso_gl_draw_pullpush_to(canvas->engine, opts, &to, error);
    return finish_draw(canvas, status, error);
}

/* ---- reading */

unsigned iso_gl_canvas_texture(const iso_gl_canvas *canvas) {
    return canvas->colors;
}

bool iso_gl_canvas_pick(const iso_gl_canvas *canvas, int x, int y, float normal_depth[4]) {
    enum { BYTES = 4 * sizeof(float) };
    iso_gl_context *context = canvas->engine->context;
    if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height) return false;
    if (iso_gl_enter(context, NULL) != ISO_OK) return false;
    gl_of(canvas)->GetTextureSubImage(canvas->samples, 0, x, y, 0, 1, 1, 1, GL_RGBA, GL_FLOAT, BYTES,
                                      normal_depth);
    return iso_gl_leave(context, ISO_OK, NULL) == ISO_OK && normal_depth[3] < INFINITY;
}

iso_status iso_gl_canvas_copy(iso_gl_canvas *to, const iso_gl_canvas *from, iso_error *error) {
    iso_gl_context *context = to->engine->context;
    ISO_TRY(iso_gl_enter(context, error));
    ensure_size(to, from->width, from->height);
    gl_of(to)->CopyImageSubData(from->samples, GL_TEXTURE_2D, 0, 0, 0, 0, to->samples, GL_TEXTURE_2D, 0, 0, 0,
                                0, from->width, from->height, 1);
    return iso_gl_leave(context, ISO_OK, error);
}

iso_status iso_gl_canvas_read(const iso_gl_canvas *canvas, iso_image *image, iso_error *error) {
    iso_gl_context *context = canvas->engine->context;
    assert(image->width == canvas->width && image->height == canvas->height);
    ISO_TRY(iso_gl_enter(context, error));
    gl_of(canvas)->GetTextureImage(canvas->colors, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                                   canvas->width * canvas->height * 4, image->rgba);
    return iso_gl_leave(context, ISO_OK, error);
}
