/* egl: contexts by EGL. The few declarations needed are repeated here instead of including its headers:
 * EGL 1.5 and the extensions EXT_platform_base, EXT_device_enumeration, EXT_platform_device,
 * MESA_platform_surfaceless. */
#include <stdint.h>
#include <string.h>

#include "render/gl/platform.h"

typedef void *egl_handle; /* EGLDisplay, EGLContext, EGLConfig, EGLSurface, EGLDeviceEXT */
typedef uint32_t egl_bool;

enum {
    EGL_NONE = 0x3038,
    EGL_EXTENSIONS = 0x3055,
    EGL_RENDERABLE_TYPE = 0x3040,
    EGL_SURFACE_TYPE = 0x3033,
    EGL_OPENGL_BIT = 8,
    EGL_OPENGL_API = 0x30A2,
    EGL_CONTEXT_MAJOR_VERSION = 0x3098,
    EGL_CONTEXT_MINOR_VERSION = 0x30FB,
    EGL_CONTEXT_OPENGL_PROFILE_MASK = 0x30FD,
    EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT = 1,
    EGL_CONTEXT_OPENGL_DEBUG = 0x31B0,
    EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY = 0x31BD,
    EGL_LOSE_CONTEXT_ON_RESET = 0x31BF,
    EGL_PLATFORM_DEVICE_EXT = 0x313F,
    EGL_PLATFORM_SURFACELESS_MESA = 0x31DD,
    DEVICES = 32
};

/* X(type of the result, name without egl, parameters) */
#define FUNCTIONS(X)                                                                                         \
    X(iso_gl_function, GetProcAddress, (const char *))                                                       \
    X(int32_t, GetError, (void))                                                                             \
    X(egl_bool, Initialize, (egl_handle, int32_t *, int32_t *))                                              \
    X(const char *, QueryString, (egl_handle, int32_t))                                                      \
    X(egl_bool, BindAPI, (uint32_t))                                                                         \
    X(egl_bool, ChooseConfig, (egl_handle, const int32_t *, egl_handle *, int32_t, int32_t *))               \
    X(egl_handle, CreateContext, (egl_handle, egl_handle, egl_handle, const int32_t *))                      \
    X(egl_bool, DestroyContext, (egl_handle, egl_handle))                                                    \
    X(egl_bool, MakeCurrent, (egl_handle, egl_handle, egl_handle, egl_handle))

typedef struct egl {
    void *library;
#define X(result, name, parameters) result(*name) parameters;
    FUNCTIONS(X)
#undef X
} egl;

typedef egl_handle get_platform_display(uint32_t platform, void *native, const int32_t *attributes);
typedef egl_bool query_devices(int32_t capacity, egl_handle *devices, int32_t *count);
typedef const char *query_device_string(egl_handle device, int32_t name);

static bool load_functions(egl *e, void *library) {
    e->library = library;
    bool all = true;
#define X(result, name, parameters)                                                                          \
    e->name = (result(*) parameters)iso_gl_library_symbol(library, "egl" #name);                             \
    all = all && e->name;
    FUNCTIONS(X)
#undef X
    return all;
}

static iso_status open_egl(egl *e, iso_error *error) {
    void *library;
    ISO_TRY(iso_gl_library_open("libEGL.so.1", &library, error));
    if (!load_functions(e, library))
        return iso_fail(error, ISO_ERR_BACKEND, "libEGL.so.1 lacks functions of EGL 1.4");
    return ISO_OK;
}

static const char *error_name(int32_t code) {
    static const char *const names[] = {
        "EGL_SUCCESS",       "EGL_NOT_INITIALIZED", "EGL_BAD_ACCESS",        "EGL_BAD_ALLOC",
        "EGL_BAD_ATTRIBUTE", "EGL_BAD_CONFIG",      "EGL_BAD_CONTEXT",       "EGL_BAD_CURRENT_SURFACE",
        "EGL_BAD_DISPLAY",   "EGL_BAD_MATCH",       "EGL_BAD_NATIVE_PIXMAP", "EGL_BAD_NATIVE_WINDOW",
        "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE",     "EGL_CONTEXT_LOST"};
    int32_t index = code - 0x3000;
    return index >= 0 && index < (int32_t)(sizeof names / sizeof *names) ? names[index] : "EGL error";
}

static bool has_word(const char *words, const char *word) {
    size_t length = strlen(word);
    for (const char *at = words; at && (at = strstr(at, word)); at += length)
        if ((at == words || at[-1] == ' ') && (at[length] == ' ' || !at[length])) return true;
    return false;
}

/* The EGL loader lists devices without starting any driver. */
static iso_status list_devices(const egl *e, egl_handle devices[DEVICES], int32_t *count, iso_error *error) {
    if (!has_word(e->QueryString(NULL, EGL_EXTENSIONS), "EGL_EXT_platform_device"))
        return iso_fail(error, ISO_ERR_BACKEND, "EGL offers no devices (EGL_EXT_platform_device)");
    query_devices *query = (query_devices *)e->GetProcAddress("eglQueryDevicesEXT");
    *count = 0;
    if (!query || !query(DEVICES, devices, count) || *count < 1)
        return iso_fail(error, ISO_ERR_BACKEND, "EGL finds no device");
    return ISO_OK;
}

static bool is_software(const egl *e, egl_handle device) {
    query_device_string *query = (query_device_string *)e->GetProcAddress("eglQueryDeviceStringEXT");
    return query && has_word(query(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
}

iso_status iso_gl_devices(iso_gl_device *devices, int capacity, int *count, iso_error *error) {
    egl e;
    egl_handle handles[DEVICES];
    int32_t found;
    ISO_TRY(open_egl(&e, error));
    ISO_TRY(list_devices(&e, handles, &found, error));
    for (int i = 0; i < found && i < capacity; i++) devices[i].software = is_software(&e, handles[i]);
    *count = found;
    return ISO_OK;
}

static iso_status open_display(const egl *e, const iso_gl_context_opts *opts, egl_handle *display,
                               iso_error *error) {
    get_platform_display *get = (get_platform_display *)e->GetProcAddress("eglGetPlatformDisplayEXT");
    const char *extensions = e->QueryString(NULL, EGL_EXTENSIONS);
    if (!get || !has_word(extensions, "EGL_EXT_platform_base"))
        return iso_fail(error, ISO_ERR_BACKEND, "EGL cannot do without a display (EGL_EXT_platform_base)");
    if (opts->kind == ISO_GL_EGL_SURFACELESS) {
        if (!has_word(extensions, "EGL_MESA_platform_surfaceless"))
            return iso_fail(error, ISO_ERR_BACKEND, "EGL lacks EGL_MESA_platform_surfaceless");
        *display = get(EGL_PLATFORM_SURFACELESS_MESA, NULL, NULL);
    } else {
        egl_handle devices[DEVICES];
        int32_t count;
        ISO_TRY(list_devices(e, devices, &count, error));
        if (opts->device < 0 || opts->device >= count)
            return iso_fail(error, ISO_ERR_BACKEND, "EGL has no device %d, it has %d", opts->device, count);
        *display = get(EGL_PLATFORM_DEVICE_EXT, devices[opts->device], NULL);
    }
    int32_t major, minor;
    if (!*display || !e->Initialize(*display, &major, &minor))
        return iso_fail(error, ISO_ERR_BACKEND, "EGL does not start: %s", error_name(e->GetError()));
    if (!has_word(e->QueryString(*display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
        return iso_fail(error, ISO_ERR_BACKEND, "EGL lacks EGL_KHR_surfaceless_context");
    return ISO_OK;
}

static egl_handle create_context(const egl *e, const iso_gl_context_opts *opts, int major, int minor,
                                 egl_handle display) {
    const int32_t wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    egl_handle config = NULL; /* EGL_NO_CONFIG_KHR */
    int32_t count = 0, attributes[16], used = 0;
    e->ChooseConfig(display, wanted, &config, 1, &count);
    if (major) {
        const int32_t version[] = {EGL_CONTEXT_MAJOR_VERSION,       major,
                                   EGL_CONTEXT_MINOR_VERSION,       minor,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
        memcpy(attributes, version, sizeof version);
        used = 6;
    }
    if (major && opts->debug) {
        attributes[used++] = EGL_CONTEXT_OPENGL_DEBUG;
        attributes[used++] = 1;
    }
    /* ask the driver to report a lost context instead of silently drawing nothing */
    if (major && has_word(e->QueryString(display, EGL_EXTENSIONS), "EGL_EXT_create_context_robustness")) {
        attributes[used++] = EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY;
        attributes[used++] = EGL_LOSE_CONTEXT_ON_RESET;
    }
    attributes[used] = EGL_NONE;
    return e->CreateContext(display, count ? config : NULL, NULL, attributes);
}

/* ---- the platform: keeps only the library, and looks functions up again when they are needed */

static iso_gl_function find_egl_function(const iso_gl_platform *platform, const char *name) {
    egl e;
    load_functions(&e, platform->library);
    return e.GetProcAddress(name);
}

static bool enter_egl(const iso_gl_platform *platform) {
    egl e;
    load_functions(&e, platform->library);
    return e.BindAPI(EGL_OPENGL_API) && e.MakeCurrent(platform->display, NULL, NULL, platform->context);
}

static void leave_egl(const iso_gl_platform *platform) {
    egl e;
    load_functions(&e, platform->library);
    e.MakeCurrent(platform->display, NULL, NULL, NULL);
}

static void destroy_egl(iso_gl_platform *platform) {
    egl e;
    load_functions(&e, platform->library);
    e.DestroyContext(platform->display, platform->context);
}

iso_status iso_gl_egl_open(const iso_gl_context_opts *opts, int major, int minor, iso_gl_platform *platform,
                           iso_error *error) {
    egl e;
    egl_handle display = NULL;
    ISO_TRY(open_egl(&e, error));
    ISO_TRY(open_display(&e, opts, &display, error));
    if (!e.BindAPI(EGL_OPENGL_API))
        return iso_fail(error, ISO_ERR_BACKEND, "EGL cannot do OpenGL: %s", error_name(e.GetError()));
    egl_handle context = create_context(&e, opts, major, minor, display);
    if (!context) return iso_fail(error, ISO_ERR_BACKEND, "no OpenGL context: %s", error_name(e.GetError()));
    *platform = (iso_gl_platform){.library = e.library,
                                  .display = display,
                                  .context = context,
                                  .address = find_egl_function,
                                  .enter = enter_egl,
                                  .leave = leave_egl,
                                  .destroy = destroy_egl};
    return ISO_OK;
}
