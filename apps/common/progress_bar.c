#include "apps/common/progress_bar.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool is_shown;

bool iso_progress_bar_possible(void) {
    const char *kind = getenv("TERM");
    return isatty(STDERR_FILENO) && kind && strcmp(kind, "dumb") != 0;
}

void iso_progress_bar_show(const char *stage, int percent) {
    enum { BAR = 40 };
    char bar[BAR + 1];
    for (int i = 0; i < BAR; i++) bar[i] = i < percent * BAR / 100 ? '#' : ' ';
    bar[BAR] = 0;
    fprintf(stderr, "\r%-12s [%s] %3d %%", stage, bar, percent);
    fflush(stderr);
    is_shown = true;
}

void iso_progress_bar_clear(void) {
    if (!is_shown) return;
    fputs("\r\033[K", stderr); /* to the first column, and erased to the line's end */
    fflush(stderr);
    is_shown = false;
}
