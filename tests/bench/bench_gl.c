#include "bench_gl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/gl/pullpush.h"
#if BENCH_HAVE_GL
#include <glad/gl.h>

#include "render/gl/internal.h"
#endif

/* ---- the engine ---- */

/* "llvmpipe (LLVM 15.0.6, 256 bits)" is llvmpipe, "NVIDIA H200/PCIe/SSE2" NVIDIA_H200. */
static void name_renderer(bench_gl *gl) {
    snprintf(gl->name, sizeof gl->name, "%s", iso_gl_context_info(gl->context).renderer);
    gl->name[strcspn(gl->name, "(/")] = 0;
    size_t length = strlen(gl->name);
    while (length && gl->name[length - 1] == ' ') gl->name[--length] = 0;
    for (char *c = gl->name; *c; c++)
        if (*c == ' ') *c = '_';
}

iso_status bench_gl_open(bench_gl *gl, iso_error *error) {
    const iso_gl_context_opts osmesa = {.kind = ISO_GL_OSMESA};
    iso_error why = {ISO_OK, ""};
    *gl = (bench_gl){.context = NULL};
    if (iso_gl_context_open_egl(false, &gl->context, &why) != ISO_OK &&
        iso_gl_context_create(&osmesa, &gl->context, NULL) != ISO_OK) {
        gl->context = NULL;
        fprintf(stderr, "bench: no frames by OpenGL: %s\n", why.text);
        return ISO_OK;
    }
    name_renderer(gl);
    return iso_gl_engine_create(gl->context, &gl->engine, error);
}

void bench_gl_close(bench_gl *gl) {
    iso_gl_engine_destroy(gl->engine);
    iso_gl_context_destroy(gl->context);
    *gl = (bench_gl){.context = NULL};
}

/* ---- the methods ---- */

/* What a row's frames have, beside what all have. */
struct bench_gl_frame {
    iso_gl_surface *surface;
    double seconds[ISO_GL_PASSES]; /* of the fastest so far: the first ones are compiled */
};

static iso_status make_gl_frame(bench_frame *frame, iso_error *error) {
    frame->gl_frame = calloc(1, sizeof *frame->gl_frame);
    return frame->gl_frame ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

static iso_status open_points(bench_frame *frame, iso_error *error) {
    ISO_TRY(make_gl_frame(frame, error));
    ISO_TRY(bench_subject_points(frame->subject, &frame->points, error));
    frame->primitives = iso_point_view_count(&frame->points);
    return iso_gl_upload_points(frame->gl->engine, &frame->points, &frame->gl_frame->surface, error);
}

static iso_status open_mesh(bench_frame *frame, iso_error *error) {
    ISO_TRY(make_gl_frame(frame, error));
    ISO_TRY(bench_subject_mesh(frame->subject, &frame->mesh, error));
    frame->primitives = iso_mesh_view_triangle_count(&frame->mesh);
    return iso_gl_upload_mesh(frame->gl->engine, &frame->mesh, &frame->gl_frame->surface, error);
}

static void close_gl(bench_frame *frame) {
    if (frame->gl_frame) iso_gl_surface_destroy(frame->gl_frame->surface);
    free(frame->gl_frame);
}

/* Rows take turns with one engine: each takes its own passes' times. */
static iso_status take_seconds(bench_frame *frame, iso_status status) {
    double seconds[ISO_GL_PASSES];
    iso_gl_engine_seconds(frame->gl->engine, seconds);
    iso_gl_engine_reset_seconds(frame->gl->engine);
    for (int pass = 0; pass < ISO_GL_PASSES; pass++) {
        double *least = &frame->gl_frame->seconds[pass];
        if (!(*least > 0 && *least < seconds[pass])) *least = seconds[pass];
    }
    return status;
}

static iso_status draw_shape(bench_frame *frame, const iso_target *target, iso_error *error) {
    const iso_gl_surface *surface = frame->gl_frame->surface;
    const iso_gl_draw_opts opts = {.view = target->view, .surfaces = &surface, .surface_count = 1};
    return take_seconds(frame, iso_gl_draw(frame->gl->engine, &opts, target->gbuffer, error));
}

static iso_status fill(bench_frame *frame, const iso_target *target, iso_reconstruction reconstruction,
                       iso_error *error) {
    const iso_gl_surface *surface = frame->gl_frame->surface;
    const iso_gl_pullpush_opts opts = {target->view, &surface, 1, reconstruction, ISO_SELECTION_ALL};
    return take_seconds(frame, iso_gl_draw_pullpush(frame->gl->engine, &opts, target->gbuffer, error));
}

static iso_status draw_pullpush(bench_frame *frame, const iso_target *target, iso_error *error) {
    return fill(frame, target, ISO_RECONSTRUCTION_GAUSSIAN, error);
}

static iso_status draw_discs(bench_frame *frame, const iso_target *target, iso_error *error) {
    return fill(frame, target, ISO_RECONSTRUCTION_CURVED, error);
}

static void finish_gl(bench_row *row) {
    static const char *const names[ISO_GL_PASSES] = {"draw_ms", "project_ms", "pull_ms",
                                                     "push_ms", "finish_ms",  "front_ms",
                                                     "add_ms",  "resolve_ms", "select_ms"};
    const bench_frame *frame = row->context;
    for (int pass = 0; pass < ISO_GL_PASSES; pass++) {
        double seconds = frame->gl_frame->seconds[pass];
        if (seconds > 0) bench_count(row, names[pass], 1e3 * seconds, 0, 0);
    }
}

const bench_method bench_gl_methods[] = {
    {.name = "gl_points", .open = open_points, .draw = draw_shape, .finish = finish_gl, .close = close_gl},
    {.name = "gl_mesh", .open = open_mesh, .draw = draw_shape, .finish = finish_gl, .close = close_gl},
    {.name = "gl_pullpush",
     .open = open_points,
     .draw = draw_pullpush,
     .finish = finish_gl,
     .close = close_gl},
    {.name = "gl_discs", .open = open_points, .draw = draw_discs, .finish = finish_gl, .close = close_gl},
};
const int bench_gl_method_count = sizeof bench_gl_methods / sizeof *bench_gl_methods;

/* ---- the limit ---- */

/* Bytes a second that the renderer reads and writes when it copies: 0 when it cannot be told. */
static double copy_speed(const bench_gl *gl) {
    double speed = 0;
#if BENCH_HAVE_GL
    enum { BYTES = 64 << 20, COPIES = 8 };
    const GladGLContext *f = gl->context->gl;
    GLuint buffers[2];
    if (iso_gl_enter(gl->context, NULL) != ISO_OK) return 0;
    f->CreateBuffers(2, buffers);
    for (int i = 0; i < 2; i++) f->NamedBufferStorage(buffers[i], BYTES, NULL, GL_DYNAMIC_STORAGE_BIT);
    for (int i = 0; i < 2; i++) f->CopyNamedBufferSubData(buffers[i], buffers[!i], 0, 0, BYTES);
    f->Finish();
    bench_sample sample;
    bench_clock clock = bench_clock_start();
    for (int i = 0; i < COPIES; i++)
        f->CopyNamedBufferSubData(buffers[i & 1], buffers[!(i & 1)], 0, 0, BYTES);
    f->Finish();
    bench_clock_stop(&clock, &sample);
    f->DeleteBuffers(2, buffers);
    if (iso_gl_leave(gl->context, ISO_OK, NULL) == ISO_OK)
        speed = 2.0 * BYTES * COPIES / (1e-3 * sample.wall);
#else
    (void)gl;
#endif
    return speed;
}

static double counter_of(const bench_row *row, const char *name) {
    for (int i = 0; i < row->counter_count; i++)
        if (strcmp(row->counters[i].name, name) == 0) return row->counters[i].value;
    return 0;
}

/* (a projection that moves less than half of what copies do waits for something else) */
void bench_gl_say_limit(const bench_gl *gl, const bench_row *row) {
    double seconds = 1e-3 * counter_of(row, "project_ms"), copies = copy_speed(gl);
    if (!(seconds > 0 && copies > 0)) return;
    double points = (double)row->primitives / seconds, bytes = points * sizeof(iso_point);
    printf("\nlimit of %s: %s: its projection takes %.0f M points/s, %.2f GB/s where copies reach %.1f\n",
           row->name, bytes > 0.5 * copies ? "memory bandwidth" : "arithmetic and atomics", 1e-6 * points,
           1e-9 * bytes, 1e-9 * copies);
}
