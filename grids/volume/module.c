/* module: finds modules and loads them with the dynamic linker. */
#include "grids/volume/module.h"

#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FOLDERS = 2 };
/* What log4cplus, which OpenVDB logs by, makes when it is loaded; it ends the program if it cannot. */
enum { LOG4CPLUS_THREADS = 4 };

typedef struct folders {
    char path[FOLDERS][PATH_MAX];
    int count;
} folders;

/* Whether a path ends in /name. */
static bool is_called(const char *path, const char *name) {
    size_t length = strlen(path), tail = strlen(name);
    return length > tail && path[length - tail - 1] == '/' && strcmp(path + length - tail, name) == 0;
}

/* The modules' folder relative to this code: beside the shared library that contains it; or, in a statically
 * linked program, at the installation's place relative to the program. False for a program in any other
 * folder: modules are not loaded from places that anyone may write to. */
static bool relative_folder(char folder[PATH_MAX]) {
    static const char here = 0;
    Dl_info info;
    void *found = NULL;
    if (!dladdr1(&here, &info, &found, RTLD_DL_LINKMAP) || !found) return false;
    const struct link_map *image = found;
    bool program = !*image->l_name; /* the dynamic linker has no name for the program itself */
    char own[PATH_MAX];
    if (!realpath(program ? "/proc/self/exe" : image->l_name, own)) return false;
    *strrchr(own, '/') = 0;
    if (program && !is_called(own, ISO_PROGRAMS)) return false;
    return snprintf(folder, PATH_MAX, "%s/%s", own, program ? ISO_MODULES_FROM_PROGRAM : "isopoint") <
           PATH_MAX;
}

static void find_folders(folders *all) {
    const char *wanted = secure_getenv("ISO_MODULE_PATH");
    if (!wanted || !*wanted) {
        if (relative_folder(all->path[0])) all->count = 1;
        wanted = ISO_MODULES_INSTALLED;
    }
    if (snprintf(all->path[all->count], PATH_MAX, "%s", wanted) < PATH_MAX) all->count++;
}

static void *pass_gate(void *gate) {
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

/* Whether so many threads can run beside this one. Their stacks are kept by the C library, so that they can
 * be made again. */
static bool can_make_threads(int count) {
    enum { MOST = 8 };
    pthread_t threads[MOST];
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    int made = 0;
    pthread_mutex_lock(&gate);
    while (made < count && pthread_create(&threads[made], NULL, pass_gate, &gate) == 0) made++;
    pthread_mutex_unlock(&gate);
    for (int i = 0; i < made; i++) pthread_join(threads[i], NULL);
    return made == count;
}

/* Whether the dynamic linker's message is about memory. (A folder that is mounted noexec is "not permitted".)
 */
static bool is_memory(const char *message) {
    return strstr(message, "annot allocate memory") ||
           (strstr(message, "failed to map segment") && !strstr(message, "not permitted"));
}

static iso_status load_file(const char *path, const char *file, const char *name, const char *library,
                            const iso_module **module, iso_error *error) {
    if (strcmp(name, "vdb") == 0 && !can_make_threads(LOG4CPLUS_THREADS))
        return iso_fail(error, ISO_ERR_NOMEM, "%s: no memory for the threads that %s makes", path, library);
    void *handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
        const char *why = dlerror();
        return iso_fail(error, is_memory(why) ? ISO_ERR_NOMEM : ISO_ERR_UNSUPPORTED,
                        "%s: the %s reader cannot be loaded: %s", path, library, why);
    }
    const iso_module *found = dlsym(handle, "iso_module_table");
    if (!found || found->abi != ISO_MODULE_ABI || strcmp(found->version, ISO_VERSION) != 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: the %s reader (%s) belongs to another version of isopoint", path, library, file);
    *module = found;
    return ISO_OK;
}

iso_status iso_module_load(const char *path, const char *name, const char *library, const iso_module **module,
                           iso_error *error) {
    folders all = {.count = 0};
    const char *wanted = secure_getenv("ISO_MODULE_PATH");
    if (wanted && *wanted && *wanted != '/')
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: the %s reader is not loaded from ISO_MODULE_PATH='%s': it must begin with '/'",
                        path, library, wanted);
    find_folders(&all);
    for (int i = 0; i < all.count; i++) {
        char file[PATH_MAX + 64];
        snprintf(file, sizeof file, "%s/libisopoint-%s.so", all.path[i], name);
        if (access(file, F_OK) == 0) return load_file(path, file, name, library, module, error);
    }
    return iso_fail(error, ISO_ERR_UNSUPPORTED,
                    "%s: the %s reader (libisopoint-%s.so) is not installed: not in %s%s%s", path, library,
                    name, all.count > 0 ? all.path[0] : "any folder", all.count > 1 ? " or " : "",
                    all.count > 1 ? all.path[1] : "");
}
