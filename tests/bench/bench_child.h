/* bench_child: other programs that the bench runs and talks to, a line to and a line from them at a time, and
 * the X display that VTK needs. All of them end with the bench, however it ends. */
#ifndef ISO_TESTS_BENCH_CHILD_H
#define ISO_TESTS_BENCH_CHILD_H

#include <stdbool.h>

#include "base/status.h"

typedef struct bench_child bench_child;

/* Starts a program, argv[0] being its path or a name to be looked for in PATH. `threads`: 0, or the number of
 * processors that it may use and of threads that Mesa's software renderer draws with in it. `display`: X
 * display, or NULL. ISO_ERR_UNSUPPORTED when there is no such program. Destroy with bench_child_stop. */
iso_status bench_child_start(const char *const *argv, int threads, const char *display, bench_child **child,
                             iso_error *error);

/* Sends `question` (NULL: nothing) and reads a line, without its end, into answer[size]. */
iso_status bench_child_ask(bench_child *child, const char *question, char *answer, int size,
                           iso_error *error);

/* Closes its input and waits until it ends; whether it ended well. NULL is fine. */
bool bench_child_end(bench_child *child);
/* Ends it at once. NULL is fine. */
void bench_child_stop(bench_child *child);

/* Path of a program beside this one into path[size]; ISO_ERR_UNSUPPORTED when it was not built. */
iso_status bench_sibling(const char *name, char *path, int size, iso_error *error);

/* An X server without a screen, started at the first call; *display is its name. ISO_ERR_UNSUPPORTED when
 * there is none. */
typedef struct bench_display {
    bench_child *server;
    char name[32];
    char problem[160]; /* why there is none: asked once only */
} bench_display;
iso_status bench_display_open(bench_display *display, const char **name, iso_error *error);
void bench_display_close(bench_display *display);

#endif
