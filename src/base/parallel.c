/* parallel: the pool of POSIX threads. Workers take indices from an atomic counter; between calls they poll
 * for a short time and then sleep. */
#include "base/parallel.h"

#include <assert.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <unistd.h>

#include "base/cpu.h"
#include "base/memory.h"
#include "base/thread.h"

enum { MAX_THREADS = 1024 };

typedef struct worker {
    iso_pool *pool;
    pthread_t thread;
    int number;
} worker;

struct iso_pool {
    int threads;
    worker *workers; /* threads - 1 of them: the caller is worker 0 */
    pthread_mutex_t mutex;
    pthread_cond_t work_ready, work_done;
    atomic_ulong round; /* counts calls of iso_parallel_for */
    atomic_int busy;    /* workers that take part in the current round */
    bool open;          /* workers may still join the current round; those that wake up later skip it */
    bool stop;
    int spins; /* how often a waiting thread polls before it sleeps; 0 with fewer processors than threads */
    iso_task *task;
    void *context;
    size_t count;
    atomic_size_t next;
    iso_pool_watch_fn *watch; /* or NULL */
    void *watch_context;
    atomic_bool cancelled; /* by the watch */
    bool until;            /* the current round ends when `cancelled` is set */
    pid_t owner;           /* the process that has the threads */
};

/* Polls before a waiting thread sleeps. The steps of drawing a picture follow each other within microseconds,
 * but waking a thread takes tens of microseconds: where every thread has its own processor, polling is
 * faster. */
enum { SPINS = 4096 };

static void pause_briefly(void) {
#if ISO_HAVE_X86
    __builtin_ia32_pause();
#endif
}

/* Waits for a round after number `*seen` and sets `*seen` to it. Returns whether this worker takes part: not
 * when the round is closed already, and not when the pool is stopped. */
static bool join_round(iso_pool *pool, unsigned long *seen) {
    for (int i = 0; i < pool->spins; i++) {
        if (atomic_load_explicit(&pool->round, memory_order_relaxed) != *seen) break;
        pause_briefly();
    }
    pthread_mutex_lock(&pool->mutex);
    while (atomic_load(&pool->round) == *seen && !pool->stop)
        pthread_cond_wait(&pool->work_ready, &pool->mutex);
    *seen = atomic_load(&pool->round);
    bool joins = pool->open && !pool->stop;
    if (joins) atomic_fetch_add(&pool->busy, 1);
    pthread_mutex_unlock(&pool->mutex);
    return joins;
}

static bool is_stopped(iso_pool *pool) {
    pthread_mutex_lock(&pool->mutex);
    bool stop = pool->stop;
    pthread_mutex_unlock(&pool->mutex);
    return stop;
}

static void leave_round(iso_pool *pool) {
    if (atomic_fetch_sub(&pool->busy, 1) > 1) return;
    pthread_mutex_lock(
        &pool->mutex); /* so that the signal does not come between the caller's test and its wait */
    pthread_cond_signal(&pool->work_done);
    pthread_mutex_unlock(&pool->mutex);
}

static void await_workers(iso_pool *pool) {
    for (int i = 0; i < pool->spins; i++) {
        if (atomic_load_explicit(&pool->busy, memory_order_acquire) == 0) return;
        pause_briefly();
    }
    pthread_mutex_lock(&pool->mutex);
    while (atomic_load(&pool->busy)) pthread_cond_wait(&pool->work_done, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}

static void tell(iso_pool *pool, double fraction) {
    if (pool && pool->watch && pool->watch(pool->watch_context, fraction))
        atomic_store_explicit(&pool->cancelled, true, memory_order_relaxed);
}

void iso_pool_watch(iso_pool *pool, iso_pool_watch_fn *watch, void *context) {
    if (!pool) return;
    pool->watch = watch;
    pool->watch_context = context;
    atomic_store(&pool->cancelled, false);
}

bool iso_pool_is_cancelled(const iso_pool *pool) {
    return pool && atomic_load_explicit(&pool->cancelled, memory_order_relaxed);
}

iso_status iso_pool_check(const iso_pool *pool, const char *what, iso_error *error) {
    return iso_pool_is_cancelled(pool) ? iso_fail(error, ISO_ERR_IO, "%s: cancelled", what) : ISO_OK;
}

bool iso_pool_ask(iso_pool *pool) {
    tell(pool, 0);
    return iso_pool_is_cancelled(pool);
}

/* (An index that was taken is worked on also when the pool has been cancelled meanwhile: iso_parallel_ordered
 * waits for it.) */
static void run_tasks(iso_pool *pool, int number) {
    for (bool first = true; !(pool->until && iso_pool_is_cancelled(pool)); first = false) {
        size_t index = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (index >= pool->count) return;
        if (number == 0) tell(pool, first ? 0 : (double)index / (double)pool->count);
        pool->task(pool->context, index, number);
    }
}

static void *worker_main(void *argument) {
    worker *self = argument;
    iso_pool *pool = self->pool;
    for (unsigned long seen = 0; !is_stopped(pool);) {
        if (!join_round(pool, &seen)) continue;
        run_tasks(pool, self->number);
        leave_round(pool);
    }
    return NULL;
}

static int processors(void) {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
    int count = CPU_COUNT(&set);
    return count < 1 ? 1 : count > MAX_THREADS ? MAX_THREADS : count;
}

iso_status iso_pool_create(int threads, iso_pool **out, iso_error *error) {
    if (threads < 0 || threads > MAX_THREADS)
        return iso_fail(error, ISO_ERR_USAGE, "thread count %d is not in 0..%d", threads, MAX_THREADS);
    iso_pool *pool = iso_alloc_zero(1, sizeof *pool);
    if (!pool) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a thread pool");
    int wanted = threads ? threads : processors();
    pool->threads = 1;
    pool->owner = getpid();
    pool->spins = wanted <= processors() ? SPINS : 0;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->work_ready, NULL);
    pthread_cond_init(&pool->work_done, NULL);
    atomic_init(&pool->next, 0);
    pool->workers = iso_alloc_zero((size_t)wanted, sizeof *pool->workers);
    if (!pool->workers) {
        iso_pool_destroy(pool);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %d threads", wanted);
    }
    for (int i = 1; i < wanted; i++) {
        worker *self = &pool->workers[i - 1];
        *self = (worker){.pool = pool, .number = i};
        if (iso_thread_start(&self->thread, worker_main, self) != 0) {
            iso_pool_destroy(pool);
            return iso_fail(error, ISO_ERR_NOMEM, "cannot start thread %d of %d", i + 1, wanted);
        }
        pool->threads = i + 1;
    }
    *out = pool;
    return ISO_OK;
}

/* (In a child process the threads that wait would be waited for for ever, by the condition as well.) */
static void stop_threads(iso_pool *pool) {
    pthread_mutex_lock(&pool->mutex);
    pool->stop = true;
    pthread_cond_broadcast(&pool->work_ready);
    pthread_mutex_unlock(&pool->mutex);
    for (int i = 1; i < pool->threads; i++) pthread_join(pool->workers[i - 1].thread, NULL);
    pthread_mutex_destroy(&pool->mutex);
    pthread_cond_destroy(&pool->work_ready);
    pthread_cond_destroy(&pool->work_done);
}

void iso_pool_destroy(iso_pool *pool) {
    if (!pool) return;
    if (pool->owner == getpid()) stop_threads(pool);
    iso_free(pool->workers);
    iso_free(pool);
}

int iso_pool_threads(const iso_pool *pool) {
    return pool ? pool->threads : 1;
}

static void run(iso_pool *pool, size_t count, bool until, iso_task *task, void *context) {
    /* A child process has none of the threads, and its copy of the mutex may be locked for ever. */
    if (!pool || pool->threads == 1 || count < 2 || pool->owner != getpid()) {
        for (size_t i = 0; i < count; i++) {
            tell(pool, (double)i / (double)count);
            if (until && iso_pool_is_cancelled(pool)) return;
            task(context, i, 0);
        }
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    assert(!pool->open && "a task used its own pool");
    pool->task = task;
    pool->context = context;
    pool->count = count;
    pool->until = until;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    pool->open = true;
    atomic_fetch_add(&pool->round, 1);
    pthread_cond_broadcast(&pool->work_ready);
    pthread_mutex_unlock(&pool->mutex);
    run_tasks(pool, 0);
    pthread_mutex_lock(&pool->mutex);
    pool->open = false;
    pthread_mutex_unlock(&pool->mutex);
    await_workers(pool);
}

void iso_parallel_for(iso_pool *pool, size_t count, iso_task *task, void *context) {
    run(pool, count, false, task, context);
}

void iso_parallel_until(iso_pool *pool, size_t count, iso_task *task, void *context) {
    run(pool, count, true, task, context);
}

/* ---- in order */

enum { SLOTS_PER_THREAD = 4 };

/* The states of a slot, in their order. */
typedef enum slot_state { SLOT_FREE, SLOT_WORKING, SLOT_READY, SLOT_FINISHING } slot_state;

typedef struct ordered_run {
    const iso_ordered *steps;
    void *context;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    size_t placed, finishing;
    uint8_t state[MAX_THREADS * SLOTS_PER_THREAD]; /* slot_state */
} ordered_run;

/* Places and finishes all results that are next in order; any thread may do that. The mutex is held. */
static void place_ready(ordered_run *run) {
    const iso_ordered *steps = run->steps;
    for (;;) {
        const size_t slot = run->placed % steps->slots;
        if (run->state[slot] != SLOT_READY) return;
        if (!steps->place(run->context, slot, run->finishing == 0)) {
            pthread_cond_wait(&run->changed, &run->mutex);
            continue;
        }
        run->state[slot] = SLOT_FINISHING;
        run->placed++;
        run->finishing++;
        pthread_mutex_unlock(&run->mutex);
        steps->finish(run->context, slot);
        pthread_mutex_lock(&run->mutex);
        run->finishing--;
        run->state[slot] = SLOT_FREE;
        pthread_cond_broadcast(&run->changed);
    }
}

/* Waits until the index's slot is free and every earlier index that uses the same slot has had it. This
 * cannot deadlock: the smallest index that has had no slot waits only for a call of `finish` to return. */
static void ordered_task(void *context, size_t index, int number) {
    ordered_run *run = context;
    const size_t slot = index % run->steps->slots;
    pthread_mutex_lock(&run->mutex);
    while (index >= run->placed + run->steps->slots || run->state[slot] != SLOT_FREE)
        pthread_cond_wait(&run->changed, &run->mutex);
    run->state[slot] = SLOT_WORKING;
    pthread_mutex_unlock(&run->mutex);
    run->steps->work(run->context, index, slot, number);
    pthread_mutex_lock(&run->mutex);
    run->state[slot] = SLOT_READY;
    place_ready(run);
    pthread_mutex_unlock(&run->mutex);
}

size_t iso_ordered_slots(const iso_pool *pool) {
    return (size_t)iso_pool_threads(pool) * SLOTS_PER_THREAD;
}

void iso_parallel_ordered(iso_pool *pool, size_t count, const iso_ordered *steps, void *context) {
    ordered_run all = {.steps = steps, .context = context};
    pthread_mutex_init(&all.mutex, NULL);
    pthread_cond_init(&all.changed, NULL);
    iso_parallel_until(pool, count, ordered_task, &all);
    pthread_cond_destroy(&all.changed);
    pthread_mutex_destroy(&all.mutex);
}
