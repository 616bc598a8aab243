/* Which engine draws: the cpu engine, or the gl engine on a context that is found at run time. */
#include "apps/isorender/backend.h"

#include <stdio.h>
#include <string.h>

#include "base/cpu.h"
#include "scene/method.h"

static bool is_any(const char *name, const char *a, const char *b) {
    return strcmp(name, a) == 0 || strcmp(name, b) == 0;
}

/* Whether the picture has lines, glyphs and meshes of files only, which need no method. */
static bool has_no_surface(const isorender_settings *settings) {
    return settings->no_input && !settings->volume_options.count && !settings->labels && !settings->smooth;
}

/* Whether OpenGL has the method. Of pictures without one it draws those that ask for it. */
static bool has_gl(const isorender_settings *settings) {
    if (has_no_surface(settings)) return is_any(settings->backend, "egl", "osmesa");
    if (settings->cut_count) return false;
    /* in software renderers instances take longer by OpenGL than by the cpu */
    if (settings->instances && !is_any(settings->backend, "egl", "osmesa")) return false;
    return settings->method != ISORENDER_METHOD_UNCHOSEN && isorender_method_can(settings, ISO_CAN_GL);
}

/* Samples a pixel of an opaque picture. */
static int count_samples(const isorender_settings *settings) {
    if (settings->samples) return settings->samples;
    return iso_method_samples(has_no_surface(settings) ? ISO_METHOD_EXACT : (iso_method)settings->method);
}

/* The gl engine reads every sample back. */
static bool is_too_large(const isorender_settings *settings) {
    uint64_t pixels = (uint64_t)settings->width * (uint64_t)settings->height;
    return pixels * (uint64_t)count_samples(settings) > ISO_GL_SAMPLES_MAX;
}

/* Whether an option is given that only OpenGL has. */
static bool needs_gl(const isorender_settings *settings) {
    return settings->scaling == ISO_SCALING_ATTENUATED || settings->strips;
}

static iso_status check_needs(const isorender_settings *settings, iso_error *error) {
    bool cpu = strcmp(settings->backend, "cpu") == 0;
    bool attenuated = settings->scaling == ISO_SCALING_ATTENUATED;
    const unsigned needed = attenuated ? ISO_CAN_ATTENUATED : ISO_CAN_STRIPS;
    char who[ISO_METHODS_TEXT];
    if (!needs_gl(settings) || (!cpu && isorender_method_can(settings, needed))) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%s is for --method %s with OpenGL (--backend egl or osmesa)",
                    attenuated ? "--point-scaling attenuated" : "--strips",
                    iso_methods_that_can(needed, who));
}

iso_status isorender_backend_check(isorender_settings *settings, iso_error *error) {
    const char *name = settings->backend;
    bool gl = is_any(name, "egl", "osmesa"), needed = needs_gl(settings);
    const bool chosen = settings->method != ISORENDER_METHOD_UNCHOSEN;
    char who[ISO_METHODS_TEXT];
    if (!gl && !is_any(name, "auto", "cpu"))
        return iso_fail(error, ISO_ERR_BACKEND,
                        "there is no backend '%s': auto, cpu, egl or osmesa (see --list-backends)", name);
    if (gl && settings->ior > 0)
        return iso_fail(error, ISO_ERR_USAGE, "--backend %s draws no glass: --ior needs the cpu", name);
    if (gl && isorender_is_translucent(settings) &&
        !(chosen && isorender_method_can(settings, ISO_CAN_GL_LAYERS)))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--backend %s draws translucent surfaces by --method %s: others need the cpu", name,
                        iso_methods_that_can(ISO_CAN_GL_LAYERS, who));
    if (gl && settings->group_radii == ISO_GROUP_RADII_COPIES)
        return iso_fail(error, ISO_ERR_USAGE, "--backend %s draws no --group-radii copies: they need the cpu",
                        name);
    if (gl && settings->cut_count)
        return iso_fail(error, ISO_ERR_USAGE, "--backend %s cuts nothing: --clip needs the cpu", name);
    if ((gl || needed) && !chosen && !has_no_surface(settings))
        settings->method = settings->strips      ? ISO_METHOD_MESH
                           : settings->instances ? ISO_METHOD_DISCS
                                                 : ISO_METHOD_POINTS;
    ISO_TRY(check_needs(settings, error));
    if (gl && !has_gl(settings))
        return iso_fail(error, ISO_ERR_USAGE, "--backend %s draws by --method %s: others need the cpu", name,
                        iso_methods_that_can(ISO_CAN_GL, who));
    bool draws = !settings->info && (!settings->no_image || settings->aov);
    if ((gl || needed) && draws && is_too_large(settings))
        return iso_fail(error, ISO_ERR_LIMIT,
                        "%dx%d with %d samples a pixel is more than OpenGL is used for here (2^32 samples): "
                        "--backend cpu draws it",
                        settings->width, settings->height, count_samples(settings));
    return ISO_OK;
}

static iso_status open_context(const isorender_settings *settings, iso_gl_context **context,
                               iso_error *error) {
    if (strcmp(settings->backend, "osmesa") == 0) {
        const iso_gl_context_opts opts = {.kind = ISO_GL_OSMESA};
        return iso_gl_context_create(&opts, context, error);
    }
    return iso_gl_context_open_egl(strcmp(settings->backend, "auto") == 0, context, error);
}

isorender_backend isorender_backend_cpu(void) {
    static const char *const names[ISO_CPU_LEVELS] = {
        [ISO_CPU_GENERIC] = "cpu generic", [ISO_CPU_AVX2] = "cpu avx2", [ISO_CPU_AVX512] = "cpu avx512"};
    return (isorender_backend){.name = "cpu", .renderer = names[iso_cpu_best()]};
}

/* Whether the picture has several image pyramids. On the only GPU that the engine has been tried on (NVIDIA
 * H200, driver 580.159) the second one is drawn in a wrong place, for a reason that has not been found. */
static bool has_several_pyramids(const isorender_settings *settings) {
    return settings->method == ISO_METHOD_PULLPUSH && settings->isovalue_count > 1 && !settings->one_pyramid;
}

iso_status isorender_backend_open(const isorender_settings *settings, isorender_backend *backend,
                                  iso_error *error) {
    isorender_backend made = isorender_backend_cpu();
    bool automatic = strcmp(settings->backend, "auto") == 0;
    *backend = made;
    if (strcmp(settings->backend, "cpu") == 0 || !has_gl(settings)) return ISO_OK;
    if (is_too_large(settings)) return ISO_OK; /* or nothing is drawn */
    iso_status status = open_context(settings, &made.context, error);
    if (status != ISO_OK && automatic && !needs_gl(settings))
        return ISO_OK; /* without a GPU the cpu engine is faster */
    if (status != ISO_OK) return status;
    if (iso_gl_context_info(made.context).hardware && has_several_pyramids(settings)) {
        iso_gl_context_destroy(made.context);
        return automatic
                   ? ISO_OK
                   : iso_fail(error, ISO_ERR_BACKEND,
                              "pull-push of several isovalues is not right on GPUs yet: --backend cpu, or "
                              "--method discs");
    }
    status = iso_gl_engine_create(made.context, &made.engine, error);
    if (status != ISO_OK) {
        iso_gl_context_destroy(made.context);
        return status;
    }
    made.name = automatic ? "egl" : settings->backend;
    made.renderer = iso_gl_context_info(made.context).renderer;
    *backend = made;
    return ISO_OK;
}

void isorender_backend_close(isorender_backend *backend) {
    iso_gl_engine_destroy(backend->engine);
    iso_gl_context_destroy(backend->context);
    *backend = (isorender_backend){.name = NULL};
}

/* ---- --list-backends */

static void list_context(const iso_gl_context_opts *opts, const char *name) {
    iso_gl_context *context;
    iso_error error = {ISO_OK, ""};
    if (iso_gl_context_create(opts, &context, &error) != ISO_OK) {
        size_t length = strlen(name);
        bool named = strncmp(error.text, name, length) == 0 && error.text[length] == ':';
        printf("%-15s  cannot be used: %s\n", name, error.text + (named ? length + 2 : 0));
        return;
    }
    iso_gl_info info = iso_gl_context_info(context);
    printf("%-15s  %s, %s, OpenGL %s%s\n", name, info.vendor, info.renderer, info.version,
           info.hardware ? " (what auto takes)" : "");
    iso_gl_context_destroy(context);
}

static void list_devices(void) {
    enum { DEVICES = 32 };
    iso_gl_device devices[DEVICES];
    int count = 0;
    iso_error error = {ISO_OK, ""};
    if (iso_gl_devices(devices, DEVICES, &count, &error) != ISO_OK)
        printf("%-15s  cannot be used: %s\n", "egl device", error.text);
    for (int i = 0; i < count && i < DEVICES; i++) {
        char name[32];
        const iso_gl_context_opts opts = {.kind = ISO_GL_EGL_DEVICE, .device = i};
        snprintf(name, sizeof name, "egl device %d", i);
        list_context(&opts, name);
    }
}

void isorender_backends_list(int threads) {
    const iso_gl_context_opts surfaceless = {.kind = ISO_GL_EGL_SURFACELESS},
                              osmesa = {.kind = ISO_GL_OSMESA};
    printf("%-15s  %s, %d thread%s\n", "cpu", iso_cpu_level_name(iso_cpu_best()), threads,
           threads > 1 ? "s" : "");
    list_devices();
    list_context(&surfaceless, "egl surfaceless");
    list_context(&osmesa, "osmesa");
}
