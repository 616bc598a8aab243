/* progress_bar: a line on the terminal that is overwritten while work goes on and is gone when it is done.
 * One at a time, by one thread. iso_program_log takes it away before it prints. */
#ifndef ISO_APPS_COMMON_PROGRESS_BAR_H
#define ISO_APPS_COMMON_PROGRESS_BAR_H

#include <stdbool.h>

/* Whether standard error is a terminal that can overwrite a line. */
bool iso_progress_bar_possible(void);

/* Draws the bar: what is being done, and how much of it, 0 to 100 %. Only if it is possible. */
void iso_progress_bar_show(const char *stage, int percent);

/* Takes the bar away, if one is shown. */
void iso_progress_bar_clear(void);

#endif
