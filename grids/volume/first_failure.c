/* first_failure: see the header. */
#include "grids/volume/first_failure.h"

#include <stdint.h>

void iso_first_failure_init(iso_first_failure *failure) {
    *failure = (iso_first_failure){.item = SIZE_MAX, .status = ISO_OK};
    pthread_mutex_init(&failure->lock, NULL);
}

bool iso_first_failure_may_begin(iso_first_failure *failure, size_t item) {
    pthread_mutex_lock(&failure->lock);
    const bool may_begin = item < failure->item;
    pthread_mutex_unlock(&failure->lock);
    return may_begin;
}

void iso_first_failure_enter(iso_first_failure *failure, size_t item, iso_status status,
                             const iso_error *error) {
    pthread_mutex_lock(&failure->lock);
    if (item < failure->item) {
        failure->item = item;
        failure->status = status;
        failure->error = *error;
    }
    pthread_mutex_unlock(&failure->lock);
}

iso_status iso_first_failure_finish(iso_first_failure *failure, iso_error *error) {
    pthread_mutex_destroy(&failure->lock);
    return failure->status == ISO_OK ? ISO_OK : iso_fail(error, failure->status, "%s", failure->error.text);
}
