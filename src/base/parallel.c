#define _GNU_SOURCE
#include "base/parallel.h"

#include <assert.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "base/memory.h"

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
    unsigned long round; /* counts calls of iso_parallel_for */
    int busy;            /* workers that have not finished the current round */
    bool stop;
    iso_task *task;
    void *context;
    size_t count;
    atomic_size_t next;
};

static void run_tasks(iso_pool *pool, int number) {
    for (;;) {
        size_t index = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (index >= pool->count) return;
        pool->task(pool->context, index, number);
    }
}

static void *worker_main(void *argument) {
    worker *self = argument;
    iso_pool *pool = self->pool;
    unsigned long seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (pool->round == seen && !pool->stop) pthread_cond_wait(&pool->work_ready, &pool->mutex);
        if (pool->stop) break;
        seen = pool->round;
        pthread_mutex_unlock(&pool->mutex);
        run_tasks(pool, self->number);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->busy == 0) pthread_cond_signal(&pool->work_done);
    }
    pthread_mutex_unlock(&pool->mutex);
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
        if (pthread_create(&self->thread, NULL, worker_main, self) != 0) {
            iso_pool_destroy(pool);
            return iso_fail(error, ISO_ERR_NOMEM, "cannot start thread %d of %d", i + 1, wanted);
        }
        pool->threads = i + 1;
    }
    *out = pool;
    return ISO_OK;
}

void iso_pool_destroy(iso_pool *pool) {
    if (!pool) return;
    pthread_mutex_lock(&pool->mutex);
    pool->stop = true;
    pthread_cond_broadcast(&pool->work_ready);
    pthread_mutex_unlock(&pool->mutex);
    for (int i = 1; i < pool->threads; i++) pthread_join(pool->workers[i - 1].thread, NULL);
    pthread_mutex_destroy(&pool->mutex);
    pthread_cond_destroy(&pool->work_ready);
    pthread_cond_destroy(&pool->work_done);
    iso_free(pool->workers);
    iso_free(pool);
}

int iso_pool_threads(const iso_pool *pool) {
    return pool ? pool->threads : 1;
}

void iso_parallel_for(iso_pool *pool, size_t count, iso_task *task, void *context) {
    if (!pool || pool->threads == 1 || count < 2) {
        for (size_t i = 0; i < count; i++) task(context, i, 0);
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    assert(pool->busy == 0 && "a task used its own pool");
    pool->task = task;
    pool->context = context;
    pool->count = count;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    pool->busy = pool->threads - 1;
    pool->round++;
    pthread_cond_broadcast(&pool->work_ready);
    pthread_mutex_unlock(&pool->mutex);
    run_tasks(pool, 0);
    pthread_mutex_lock(&pool->mutex);
    while (pool->busy) pthread_cond_wait(&pool->work_done, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}
