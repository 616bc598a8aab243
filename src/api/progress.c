/* Progress: the loops of a pool are reported to the caller's function, which can cancel what they are for. */
#include "api/internal.h"
#include "base/clock.h"

/* The time between two calls of the caller's function, and what a loop takes at least that is reported, s. */
static const double PAUSE = 0.05, SHORT = 0.1;

/* iso_pool_watch_fn. Only long loops tell how far the operation is; the others just ask. */
static bool watch_loop(void *context, double fraction) {
    iso_api_watch *watch = context;
    const double now = iso_clock_seconds(), whole = watch->from + (watch->to - watch->from) * fraction;
    if (fraction <= 0) watch->loop_start = now;
    if (now - watch->asked < PAUSE) return false;
    watch->asked = now;
    if (now - watch->loop_start < SHORT || whole <= watch->told) return watch->tell(watch->context, -1) != 0;
    watch->told = whole;
    return watch->tell(watch->context, whole) != 0;
}

void iso_api_watch_begin(iso_pool *pool, iso_api_watch *watch) {
    watch->told = 0;
    watch->asked = watch->loop_start = iso_clock_seconds();
    iso_api_watch_part(watch, 0, 1);
    iso_pool_watch(pool, watch->tell ? watch_loop : NULL, watch);
}

void iso_api_watch_part(iso_api_watch *watch, double from, double to) {
    watch->from = from;
    watch->to = to;
}

void iso_api_watch_end(iso_pool *pool) {
    iso_pool_watch(pool, NULL, NULL);
}
