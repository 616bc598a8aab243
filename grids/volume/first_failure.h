/* first_failure: which of several items that threads work on failed first, so that the message does not depend
 * on the threads. */
#ifndef ISO_GRIDS_VOLUME_FIRST_FAILURE_H
#define ISO_GRIDS_VOLUME_FIRST_FAILURE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"

/* The failure of the first of several items that are worked on by several threads. Items are begun in order,
 * so that which one is first does not depend on the threads. */
typedef struct first_failure {
    pthread_mutex_t lock;
    atomic_size_t item; /* SIZE_MAX: none has failed */
    iso_status status;
    iso_error error;
} first_failure;

static inline void failure_init(first_failure *failure) {
    *failure = (first_failure){.status = ISO_OK};
    atomic_init(&failure->item, SIZE_MAX);
    pthread_mutex_init(&failure->lock, NULL);
}

static inline bool may_begin(first_failure *failure, size_t item) {
    return item < atomic_load_explicit(&failure->item, memory_order_relaxed);
}

static inline void failure_enter(first_failure *failure, size_t item, iso_status status,
                                 const iso_error *error) {
    pthread_mutex_lock(&failure->lock);
    if (item < atomic_load(&failure->item)) {
        atomic_store(&failure->item, item);
        failure->status = status;
        failure->error = *error;
    }
    pthread_mutex_unlock(&failure->lock);
}

static inline iso_status failure_finish(first_failure *failure, iso_error *error) {
    pthread_mutex_destroy(&failure->lock);
    return failure->status == ISO_OK ? ISO_OK : iso_fail(error, failure->status, "%s", failure->error.text);
}

#endif
