/* first_failure: which of several items that threads work on failed first, so that the message does not
 * depend on the threads. Items are begun in order. */
#ifndef ISO_GRIDS_VOLUME_FIRST_FAILURE_H
#define ISO_GRIDS_VOLUME_FIRST_FAILURE_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

typedef struct iso_first_failure {
    pthread_mutex_t lock;
    size_t item; /* SIZE_MAX: none has failed */
    iso_status status;
    iso_error error;
} iso_first_failure;

/* End with iso_first_failure_finish. */
void iso_first_failure_init(iso_first_failure *failure);
/* Whether an item is still worth its work: none before it has failed. For several threads. */
bool iso_first_failure_may_begin(iso_first_failure *failure, size_t item);
/* Enters the failure of an item. For several threads. */
void iso_first_failure_enter(iso_first_failure *failure, size_t item, iso_status status,
                             const iso_error *error);
/* The failure of the first item that failed; ISO_OK: none has. */
iso_status iso_first_failure_finish(iso_first_failure *failure, iso_error *error);

#endif
