/* parallel: a pool of threads for parallel loops. A program creates one pool and passes it down in options;
 * there is no global pool. Functions that take a pool use only the calling thread if it is NULL.
 *
 * Results must not depend on the number of threads, so each index of a loop writes only to memory of its own.
 */
#ifndef ISO_BASE_PARALLEL_H
#define ISO_BASE_PARALLEL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_pool iso_pool;

/* A function that computes one index of a loop. `worker` is 0 .. iso_pool_threads(pool) - 1 and never in use
 * by two threads at once, so it can select scratch memory. */
typedef void iso_task(void *context, size_t index, int worker);

/* Creates a pool of 1 .. 1024 threads, the calling thread included; 0: as many as there are processors for
 * this process. ISO_ERR_USAGE: another number; ISO_ERR_NOMEM: a thread cannot be started. */
iso_status iso_pool_create(int threads, iso_pool **pool, iso_error *error);
void iso_pool_destroy(iso_pool *pool);

/* Returns the number of threads, the calling thread included; 1 for NULL. */
int iso_pool_threads(const iso_pool *pool);

/* Calls task(context, index, worker) for index = 0 .. count - 1 and returns when all calls have returned.
 * Indices are started one by one in ascending order. The calling thread is worker 0. A task must not use its
 * own pool, and only one thread at a time may call this for a pool. */
void iso_parallel_for(iso_pool *pool, size_t count, iso_task *task, void *context);

/* Work whose results are stored in the order of indices while later indices are being computed. For each
 * index `work` is called first, then `place`, then `finish`. `place` is called in the order of indices, one
 * call at a time. The results of an index are kept in its slot, index % slots, which no other index uses
 * before `finish` has returned. */
typedef struct iso_ordered {
    void (*work)(void *context, size_t index, size_t slot, int worker);
    /* `alone`: no `finish` is running. If one is, `place` may do nothing and return false; it is called again
     * after a `finish` has returned. */
    bool (*place)(void *context, size_t slot, bool alone);
    void (*finish)(void *context, size_t slot);
    size_t slots; /* number of slots, 1 .. iso_ordered_slots(pool) */
} iso_ordered;

/* Returns the largest number of slots for a pool. */
size_t iso_ordered_slots(const iso_pool *pool);

/* Computes, places and finishes indices 0 .. count - 1; otherwise like iso_parallel_for. */
void iso_parallel_ordered(iso_pool *pool, size_t count, const iso_ordered *steps, void *context);

#ifdef __cplusplus
}
#endif
#endif
