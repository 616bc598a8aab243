/* library: loads libEGL and libOSMesa with dlopen. */
#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/gl/platform.h"

iso_status iso_gl_library_open(const char *name, void **library, iso_error *error) {
    const char *folder = secure_getenv("ISO_GL_LIBRARY_PATH");
    char path[PATH_MAX];
    const char *file = name;
    if (folder && *folder) {
        if (*folder != '/')
            return iso_fail(error, ISO_ERR_BACKEND, "%s: ISO_GL_LIBRARY_PATH='%s' must begin with '/'", name,
                            folder);
        if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
            return iso_fail(error, ISO_ERR_BACKEND, "%s: ISO_GL_LIBRARY_PATH is too long", name);
        file = path;
    }
    void *opened = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    if (!opened) return iso_fail(error, ISO_ERR_BACKEND, "%s", dlerror());
    *library = opened;
    return ISO_OK;
}

iso_gl_function iso_gl_library_symbol(void *library, const char *name) {
    void *symbol = dlsym(library, name);
    iso_gl_function function;
    memcpy(&function, &symbol, sizeof function); /* ISO C has no cast from a data to a function pointer */
    return function;
}
