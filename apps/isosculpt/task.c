/* Background tasks: a thread, its progress in an atomic number, and a flag that cancels it. */
#include "apps/isosculpt/task.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "base/thread.h"

/* Progress is stored in thousandths. */
static const double THOUSANDTHS = 1000;

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

/* iso_progress.tell, from any thread: the stored progress never decreases. */
static int record_progress(void *context, double fraction) {
    isosculpt_task *task = context;
    const int reached = (int)(THOUSANDTHS * fraction);
    int before = atomic_load(&task->reached);
    while (reached > before && !atomic_compare_exchange_weak(&task->reached, &before, reached)) {
    }
    return atomic_load(&task->cancelled);
}

static void *run_thread(void *context) {
    isosculpt_task *task = context;
    const iso_progress progress = {.tell = record_progress, .context = task};
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
    if (iso_thread_start(&task->thread, run_thread, task)) {
        free(task);
        return iso_fail(error, ISO_ERR_NOMEM, "no thread can be started for it");
    }
    *out = task;
    return ISO_OK;
}

double isosculpt_task_fraction(const isosculpt_task *task) {
    return atomic_load(&task->reached) / THOUSANDTHS;
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
