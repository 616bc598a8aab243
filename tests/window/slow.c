/* slow: overrides open() (by LD_PRELOAD) to simulate slow files: a thread that opens PATH waits as long as a
 * file PATH.wait exists. The main thread, which is the window's, never waits. */
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

int open(const char *path, int flags, ...) {
    typedef int open_fn(const char *, int, ...);
    static open_fn *real; /* set by memcpy: C has no conversion from object to function pointers */
    void *found = dlsym(RTLD_NEXT, "open");
    memcpy(&real, &found, sizeof real);
    va_list more;
    va_start(more, flags);
    const int mode = va_arg(more, int); /* undefined unless the flags can create a file */
    va_end(more);
    char marker[4096];
    snprintf(marker, sizeof marker, "%s.wait", path);
    while (gettid() != getpid() && access(marker, F_OK) == 0) usleep(20000);
    return real(path, flags, mode);
}
