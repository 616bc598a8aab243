/* parallel: a pool of threads. A program creates one pool and passes it on in options; there is no global
 * pool. A NULL pool always means the calling thread only.
 *
 * Results must not depend on the number of threads: where a task writes must depend on its index only. */
#ifndef ISO_BASE_PARALLEL_H
#define ISO_BASE_PARALLEL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/c_linkage.h"
#include "base/status.h"

ISO_C_BEGIN

typedef struct iso_pool iso_pool;

/* Executes work item `index` on worker 0 .. iso_pool_threads(pool) - 1 (which selects per-worker memory). */
typedef void iso_task(void *context, size_t index, int worker);

/* Creates a pool; threads: 1 .. 1024, or 0 for the number of processors that this process may use. Release
 * with iso_pool_destroy. ISO_ERR_USAGE for other counts, ISO_ERR_NOMEM when threads cannot be started. */
iso_status iso_pool_create(int threads, iso_pool **pool, iso_error *error);
/* In a child process (fork), which has none of the threads, this frees the memory only. */
void iso_pool_destroy(iso_pool *pool);

/* Number of workers, the calling thread included; 1 for NULL. */
int iso_pool_threads(const iso_pool *pool);

/* Runs task(context, 0 .. count-1, worker) and returns when all are done; indices are handed out one by one,
 * in order. The caller's thread is worker 0. Not reentrant: a task must not use its own pool, and one pool
 * serves one caller at a time. */
void iso_parallel_for(iso_pool *pool, size_t count, iso_task *task, void *context);

/* Is told by the calling thread of iso_parallel_for how much of its items has been handed out, 0 .. 1:
 * before each item that this thread takes. Returns whether to cancel what the pool works for. */
typedef bool iso_pool_watch_fn(void *context, double fraction);
/* Sets who is told of the loops of this pool from now on; NULL: nobody. Nothing is cancelled then. Not while
 * a loop runs. `pool` may be NULL. */
void iso_pool_watch(iso_pool *pool, iso_pool_watch_fn *watch, void *context);

/* Whether the watch has cancelled: what iso_parallel_until was to compute is incomplete then. `pool` may be
 * NULL. */
bool iso_pool_is_cancelled(const iso_pool *pool);
/* ISO_ERR_IO, with "WHAT: cancelled", if the watch has cancelled. */
iso_status iso_pool_check(const iso_pool *pool, const char *what, iso_error *error);
/* Asks the watch from a long loop of the calling thread's own. Returns whether it has cancelled. */
bool iso_pool_ask(iso_pool *pool);

/* Like iso_parallel_for, but hands out no further items once the watch has cancelled: for long loops whose
 * caller checks iso_pool_is_cancelled, or whose items are pixels of a picture that is then thrown away. */
void iso_parallel_until(iso_pool *pool, size_t count, iso_task *task, void *context);

/* The steps of iso_parallel_ordered, for results that must be written in order while others are computed. For
 * each index, `work` is called first, then `place`, then `finish`. `work` and `finish` run in parallel;
 * `place` is called in the order of indices, by one thread at a time. An index keeps its results in its slot
 * (index % slots), which is not used by another index before its `finish` has returned. */
typedef struct iso_ordered {
    void (*work)(void *context, size_t index, size_t slot, int worker);
    /* alone: no `finish` is being executed. If it is false, `place` may do nothing and return false; it is
     * then called again after a `finish` has returned. */
    bool (*place)(void *context, size_t slot, bool alone);
    void (*finish)(void *context, size_t slot);
    size_t slots; /* iso_ordered_slots(pool) at most, 1 at least */
} iso_ordered;

/* The most slots that iso_parallel_ordered can use. */
size_t iso_ordered_slots(const iso_pool *pool);

/* Executes the steps for the indices 0 .. count - 1 and returns when all are done; otherwise like
 * iso_parallel_until. */
void iso_parallel_ordered(iso_pool *pool, size_t count, const iso_ordered *steps, void *context);

ISO_C_END
#endif
