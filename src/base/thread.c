/* thread: POSIX threads with a given stack size. */
#include "base/thread.h"

#include <sys/resource.h>

int iso_thread_start(pthread_t *thread, void *(*main)(void *argument), void *argument) {
    pthread_attr_t attributes;
    int failed = pthread_attr_init(&attributes);
    if (failed) return failed;
    failed = pthread_attr_setstacksize(&attributes, ISO_STACK_BYTES);
    if (!failed) failed = pthread_create(thread, &attributes, main, argument);
    pthread_attr_destroy(&attributes);
    return failed;
}

void *iso_call_with_stack(void *(*function)(void *argument), void *argument) {
    struct rlimit limit;
    pthread_t thread;
    void *result = NULL;
    const int known = getrlimit(RLIMIT_STACK, &limit) == 0;
    if ((known && limit.rlim_cur >= ISO_STACK_BYTES) || iso_thread_start(&thread, function, argument))
        return function(argument);
    pthread_join(thread, &result);
    return result;
}
