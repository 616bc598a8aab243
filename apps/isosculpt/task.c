#include "apps/isosculpt/task.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "base/thread.h"

/* Progress is kept as a whole number: thousandths. */
static const double SCALE = 1000;

struct isosculpt_task {
    pthread_t thread;
    isosculpt_task_fn *run;
    void *context;
    void (*wake)(void);
    atomic_int reached;
    atomic_bool cancelled, done;
    iso_status status;
    iso_error error;
};

/* From any thread; what is reached never falls. */
static int hear(void *context, double fraction) {
    isosculpt_task *task = context;
    const int now = (int)(SCALE * fraction);
    int before = atomic_load(&task->reached);
    while (now > before && !atomic_compare_exchange_weak(&task->reached, &before, now)) {
    }
    return atomic_load(&task->cancelled);
}

static void *work(void *context) {
    isosculpt_task *task = context;
    const iso_progress progress = {.tell = hear, .context = task};
    task->status = task->run(task->context, &progress, &task->error);
    atomic_store(&task->done, true);
    if (task->wake) task->wake();
    return NULL;
}

iso_status isosculpt_task_start(isosculpt_task_fn *run, void *context, void (*wake)(void),
                                isosculpt_task **out, iso_error *error) {
    isosculpt_task *task = calloc(1, sizeof *task);
    if (!task) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a task");
    task->run = run;
    task->context = context;
    task->wake = wake;
    if (iso_thread_start(&task->thread, work, task)) {
        free(task);
        return iso_fail(error, ISO_ERR_NOMEM, "no thread can be started for it");
    }
    *out = task;
    return ISO_OK;
}

double isosculpt_task_fraction(const isosculpt_task *task) {
    return atomic_load(&task->reached) / SCALE;
}

bool isosculpt_task_done(const isosculpt_task *task) {
    return atomic_load(&task->done);
}

bool isosculpt_task_cancelled(const isosculpt_task *task) {
    return atomic_load(&task->cancelled);
}

bool isosculpt_task_failed(const isosculpt_task *task) {
    return isosculpt_task_done(task) && task->status != ISO_OK;
}

void isosculpt_task_cancel(isosculpt_task *task) {
    atomic_store(&task->cancelled, true);
}

iso_status isosculpt_task_finish(isosculpt_task *task, iso_error *error) {
    pthread_join(task->thread, NULL);
    const iso_status status = task->status;
    if (error && status != ISO_OK) *error = task->error;
    free(task);
    return status;
}
