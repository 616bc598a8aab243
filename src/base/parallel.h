/* A small pool of threads. One pool per program, created by its owner and passed down in options: there is
 * no global pool. NULL stands for "this thread only" everywhere a pool is taken.
 *
 * Results must not depend on the number of threads: tasks write only to places that their index names. */
#ifndef ISO_BASE_PARALLEL_H
#define ISO_BASE_PARALLEL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_pool iso_pool;

/* Work item `index`, run by worker 0 .. iso_pool_threads(pool)-1 (for per-worker scratch). */
typedef void iso_task(void *context, size_t index, int worker);

/* `threads` 1 .. 1024, or 0 for the number of processors this process may use. Destroy with iso_pool_destroy.
 * ISO_ERR_USAGE for other counts, ISO_ERR_NOMEM when threads cannot be started. */
iso_status iso_pool_create(int threads, iso_pool **pool, iso_error *error);
void iso_pool_destroy(iso_pool *pool);

/* Number of workers, the calling thread included; 1 for NULL. */
int iso_pool_threads(const iso_pool *pool);

/* Runs task(context, 0 .. count-1, worker) and returns when all are done; indices are handed out one by one,
 * in order. The caller's thread is worker 0. Not reentrant: a task must not use its own pool, and one pool
 * serves one caller at a time. */
void iso_parallel_for(iso_pool *pool, size_t count, iso_task *task, void *context);

/* Work whose results are put in order while more is under way. Of each index, `work` is done first, then
 * `place`, then `finish`; `place` in the order of indices and one at a time. What an index has made lies in
 * its slot, index % slots, which no other index uses before its `finish` is over. */
typedef struct iso_ordered {
    void (*work)(void *context, size_t index, size_t slot, int worker);
    /* `alone`: no `finish` is under way. Otherwise it may do nothing and return false: it is called again
     * when that is so. */
    bool (*place)(void *context, size_t slot, bool alone);
    void (*finish)(void *context, size_t slot);
    size_t slots; /* iso_ordered_slots(pool) at most, 1 at least */
} iso_ordered;

size_t iso_ordered_slots(const iso_pool *pool);

/* Indices 0 .. count-1. As iso_parallel_for otherwise. */
void iso_parallel_ordered(iso_pool *pool, size_t count, const iso_ordered *steps, void *context);

#ifdef __cplusplus
}
#endif
#endif
