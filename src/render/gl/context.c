/* context: creates contexts by platform, loads the OpenGL functions (glad), and turns OpenGL errors, debug
 * output and lost contexts into iso_status. */
#include "render/gl/context.h"

#include <glad/gl.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/internal.h"

enum { LEAST_MAJOR = 4, LEAST_MINOR = 5, DEVICES = 32 };

bool iso_gl_renderer_is_software(const char *renderer) {
    static const char *const known[] = {"llvmpipe",    "softpipe",    "swrast",
                                        "SwiftShader", "GDI Generic", "Software Rasterizer"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strstr(renderer, known[i])) return true;
    return false;
}

/* ---- debug output */

static void GLAD_API_PTR record_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                        GLsizei length, const GLchar *text, const void *user) {
    (void)source, (void)id, (void)length;
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
    if (type == GL_DEBUG_TYPE_PERFORMANCE) return;    /* advice, of which every driver gives its own */
    iso_gl_context *context = (iso_gl_context *)user; /* as passed to DebugMessageCallback */
    if (context->message_count++ == 0) snprintf(context->message, sizeof context->message, "%s", text);
    bool wrong = type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR;
    if (wrong && !*context->failure) snprintf(context->failure, sizeof context->failure, "%s", text);
}

iso_gl_messages iso_gl_context_messages(const iso_gl_context *context) {
    return (iso_gl_messages){context->message_count, context->message};
}

/* ---- use */

static iso_status fail_lost(const iso_gl_context *context, iso_error *error) {
    return iso_fail(error, ISO_ERR_BACKEND, "%s: the context was lost (%s)", context->name,
                    context->renderer);
}

iso_status iso_gl_enter(iso_gl_context *context, iso_error *error) {
    context->failure[0] = 0;
    if (context->lost) return fail_lost(context, error);
    if (!context->platform.enter(&context->platform))
        return iso_fail(error, ISO_ERR_BACKEND, "%s: the context cannot be made current", context->name);
    if (context->platform.shared) iso_gl_state_save(&context->found, context->gl);
    return ISO_OK;
}

static const char *error_name(GLenum code) {
    switch (code) {
    case GL_INVALID_ENUM:
        return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
        return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
        return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "GL_INVALID_FRAMEBUFFER_OPERATION";
    default:
        return "an unknown error";
    }
}

/* The first of all pending errors, or the most serious one. Reads a limited number: a lost context returns
 * errors endlessly. */
static GLenum read_errors(const GladGLContext *gl) {
    GLenum first = GL_NO_ERROR;
    for (int i = 0; i < 64; i++) {
        GLenum code = gl->GetError();
        if (code == GL_NO_ERROR) break;
        if (first == GL_NO_ERROR || code == GL_OUT_OF_MEMORY || code == GL_CONTEXT_LOST) first = code;
    }
    return first;
}

iso_status iso_gl_check(iso_gl_context *context, iso_error *error) {
    const GladGLContext *gl = context->gl;
    GLenum code = read_errors(gl);
    context->lost = context->lost || code == GL_CONTEXT_LOST || gl->GetGraphicsResetStatus() != GL_NO_ERROR;
    if (context->lost) return fail_lost(context, error);
    if (code == GL_OUT_OF_MEMORY)
        return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory of %s", context->name, context->renderer);
    if (*context->failure) return iso_fail(error, ISO_ERR_BACKEND, "%s: %s", context->name, context->failure);
    if (code != GL_NO_ERROR)
        return iso_fail(error, ISO_ERR_BACKEND, "%s: %s", context->name, error_name(code));
    return ISO_OK;
}

iso_status iso_gl_leave(iso_gl_context *context, iso_status status, iso_error *error) {
    iso_error found = {ISO_OK, ""};
    if (context->platform.shared) iso_gl_state_restore(&context->found, context->gl);
    iso_status late = iso_gl_check(context, &found);
    context->platform.leave(&context->platform);
    if (late == ISO_OK || (status != ISO_OK && !context->lost)) return status;
    return iso_fail(error, late, "%s", found.text);
}

/* ---- creation */

static iso_status open_platform(const iso_gl_context_opts *opts, int major, int minor,
                                iso_gl_platform *platform, iso_error *error) {
    if (opts->kind == ISO_GL_WINDOW) {
        iso_gl_window_open(opts, platform);
        return ISO_OK;
    }
    if (opts->kind == ISO_GL_OSMESA) return iso_gl_osmesa_open(opts, major, minor, platform, error);
    return iso_gl_egl_open(opts, major, minor, platform, error);
}

static GLADapiproc find_function(void *platform, const char *name) {
    return ((const iso_gl_platform *)platform)->address(platform, name);
}

static void copy_text(char to[ISO_GL_TEXT], const GLubyte *text) {
    snprintf(to, ISO_GL_TEXT, "%s", text ? (const char *)text : "?");
}

/* Loads the functions and checks the version. The context must be current. */
static iso_status load_functions(iso_gl_context *context, iso_error *error) {
    int version = gladLoadGLContextUserPtr(context->gl, find_function, &context->platform);
    const GladGLContext *gl = context->gl;
    if (!version || !gl->GetString)
        return iso_fail(error, ISO_ERR_BACKEND, "%s: the driver gives no OpenGL functions", context->name);
    copy_text(context->vendor, gl->GetString(GL_VENDOR));
    copy_text(context->renderer, gl->GetString(GL_RENDERER));
    copy_text(context->version, gl->GetString(GL_VERSION));
    if (version < GLAD_MAKE_VERSION(LEAST_MAJOR, LEAST_MINOR))
        return iso_fail(error, ISO_ERR_BACKEND, "%s: %s offers OpenGL %s, and %d.%d is needed", context->name,
                        context->renderer, context->version, LEAST_MAJOR, LEAST_MINOR);
    gl->Enable(GL_DEBUG_OUTPUT);
    gl->Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS); /* messages arrive on this thread, before the call returns */
    gl->DebugMessageCallback(record_message, context);
    return ISO_OK;
}

/* (Not by iso_gl_enter, which needs the functions to save the state of a shared context.) */
static iso_status initialise_context(iso_gl_context *context, iso_error *error) {
    if (!context->platform.enter(&context->platform))
        return iso_fail(error, ISO_ERR_BACKEND, "%s: the context cannot be made current", context->name);
    iso_status status = load_functions(context, error);
    if (status == ISO_OK) status = iso_gl_check(context, error);
    context->platform.leave(&context->platform);
    return status;
}

/* Explains why the driver refused a context: the version that it does offer says more than its error code. */
static iso_status explain_refusal(const iso_gl_context_opts *opts, iso_gl_context *context,
                                  const iso_error *refusal, iso_error *error) {
    iso_error ignored;
    iso_status status = ISO_OK;
    if (open_platform(opts, 0, 0, &context->platform, &ignored) == ISO_OK) {
        status = initialise_context(context, error);
        context->platform.destroy(&context->platform);
    }
    if (status != ISO_OK) return status;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: %s", context->name, refusal->text);
}

static void name_context(iso_gl_context *context, const iso_gl_context_opts *opts) {
    static const char *const names[] = {[ISO_GL_EGL_DEVICE] = "egl device",
                                        [ISO_GL_EGL_SURFACELESS] = "egl surfaceless",
                                        [ISO_GL_OSMESA] = "osmesa",
                                        [ISO_GL_WINDOW] = "window"};
    if (opts->kind == ISO_GL_EGL_DEVICE)
        snprintf(context->name, sizeof context->name, "%s %d", names[opts->kind], opts->device);
    else
        snprintf(context->name, sizeof context->name, "%s", names[opts->kind]);
}

static iso_status open_context(const iso_gl_context_opts *opts, iso_gl_context *context, iso_error *error) {
    name_context(context, opts);
    iso_error refusal = {ISO_OK, ""};
    if (open_platform(opts, LEAST_MAJOR, LEAST_MINOR, &context->platform, &refusal) != ISO_OK)
        return explain_refusal(opts, context, &refusal, error);
    iso_status status = initialise_context(context, error);
    if (status != ISO_OK) context->platform.destroy(&context->platform);
    return status;
}

iso_status iso_gl_context_create(const iso_gl_context_opts *opts, iso_gl_context **context,
                                 iso_error *error) {
    iso_gl_context *made = iso_alloc_zero(1, sizeof *made);
    GladGLContext *gl = iso_alloc_zero(1, sizeof *gl);
    iso_status status = ISO_ERR_NOMEM;
    if (made && gl) {
        made->gl = gl;
        status = open_context(opts, made, error);
    } else {
        iso_fail(error, status, "out of memory for a context");
    }
    if (status == ISO_OK) {
        *context = made;
        return ISO_OK;
    }
    iso_free(gl);
    iso_free(made);
    return status;
}

void iso_gl_context_destroy(iso_gl_context *context) {
    if (!context) return;
    if (context->platform.shared && context->platform.enter(&context->platform))
        context->gl->DebugMessageCallback(NULL, NULL); /* the window's context outlives the callback's data */
    context->platform.destroy(&context->platform);
    iso_free(context->gl);
    iso_free(context);
}

static iso_status open_gpu(iso_gl_context **context, iso_error *error) {
    iso_gl_device devices[DEVICES];
    int count;
    ISO_TRY(iso_gl_devices(devices, DEVICES, &count, error));
    iso_status status = iso_fail(error, ISO_ERR_BACKEND, "EGL finds no GPU");
    for (int i = 0; i < count && i < DEVICES; i++) {
        if (devices[i].software) continue;
        const iso_gl_context_opts opts = {.kind = ISO_GL_EGL_DEVICE, .device = i};
        iso_gl_context *made;
        if (iso_gl_context_create(&opts, &made, error) != ISO_OK) continue;
        if (!iso_gl_renderer_is_software(made->renderer)) {
            *context = made;
            return ISO_OK;
        }
        iso_gl_context_destroy(made);
    }
    return status;
}

iso_status iso_gl_context_open_egl(bool hardware_only, iso_gl_context **context, iso_error *error) {
    iso_status status = open_gpu(context, error);
    if (status == ISO_OK || hardware_only) return status;
    const iso_gl_context_opts opts = {.kind = ISO_GL_EGL_SURFACELESS};
    return iso_gl_context_create(&opts, context, error);
}

iso_gl_info iso_gl_context_info(const iso_gl_context *context) {
    return (iso_gl_info){context->name, context->vendor, context->renderer, context->version,
                         !iso_gl_renderer_is_software(context->renderer)};
}
