/* osmesa: contexts by OSMesa, Mesa's software renderer without a window system. Its declarations are
 * repeated here instead of including its header. */
#include <stdint.h>

#include "base/memory.h"
#include "render/gl/platform.h"

enum {
    OSMESA_RGBA = 0x1908,
    OSMESA_FORMAT = 0x22,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37,
    UNSIGNED_BYTE = 0x1401,
    SIDE = 16 /* of the image that OSMesa requires; nothing is drawn into it */
};

typedef void *create_context(const int *attributes, void *share);
typedef unsigned char make_current(void *context, void *pixels, unsigned type, int width, int height);
typedef void destroy_context(void *context);
typedef iso_gl_function get_address(const char *name);

static iso_gl_function find_symbol(const iso_gl_platform *platform, const char *name) {
    return iso_gl_library_symbol(platform->library, name);
}

static iso_gl_function find_osmesa_function(const iso_gl_platform *platform, const char *name) {
    return ((get_address *)find_symbol(platform, "OSMesaGetProcAddress"))(name);
}

static bool enter_osmesa(const iso_gl_platform *platform) {
    make_current *make = (make_current *)find_symbol(platform, "OSMesaMakeCurrent");
    return make(platform->context, platform->pixels, UNSIGNED_BYTE, SIDE, SIDE);
}

static void leave_osmesa(const iso_gl_platform *platform) {
    ((make_current *)find_symbol(platform, "OSMesaMakeCurrent"))(NULL, NULL, 0, 0, 0);
}

static void destroy_osmesa(iso_gl_platform *platform) {
    ((destroy_context *)find_symbol(platform, "OSMesaDestroyContext"))(platform->context);
    iso_free(platform->pixels);
}

iso_status iso_gl_osmesa_open(const iso_gl_context_opts *opts, int major, int minor,
                              iso_gl_platform *platform, iso_error *error) {
    (void)opts;
    iso_gl_platform p = {.address = find_osmesa_function,
                         .enter = enter_osmesa,
                         .leave = leave_osmesa,
                         .destroy = destroy_osmesa};
    ISO_TRY(iso_gl_library_open("libOSMesa.so.8", &p.library, error));
    create_context *create = (create_context *)find_symbol(&p, "OSMesaCreateContextAttribs");
    if (!create || !find_symbol(&p, "OSMesaGetProcAddress") || !find_symbol(&p, "OSMesaMakeCurrent") ||
        !find_symbol(&p, "OSMesaDestroyContext"))
        return iso_fail(error, ISO_ERR_BACKEND, "libOSMesa.so.8 is older than Mesa 12");
    int any[] = {OSMESA_FORMAT, OSMESA_RGBA, 0};
    int core[] = {OSMESA_FORMAT,
                  OSMESA_RGBA,
                  OSMESA_PROFILE,
                  OSMESA_CORE_PROFILE,
                  OSMESA_CONTEXT_MAJOR_VERSION,
                  major,
                  OSMESA_CONTEXT_MINOR_VERSION,
                  minor,
                  0};
    p.pixels = iso_alloc((size_t)SIDE * SIDE * 4);
    if (!p.pixels) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    p.context = create(major ? core : any, NULL);
    if (!p.context) {
        iso_free(p.pixels);
        return iso_fail(error, ISO_ERR_BACKEND, "no OpenGL context from OSMesa");
    }
    *platform = p;
    return ISO_OK;
}
