/* thread: threads with a stack of known size. The default size is the limit of the process (ulimit -s), which
 * may be less than the local arrays of kernels need. */
#ifndef ISO_BASE_THREAD_H
#define ISO_BASE_THREAD_H

#include <pthread.h>

/* The size of stacks: several times what any function of the library needs. Only pages that are used take
 * memory. */
enum { ISO_STACK_BYTES = 2 << 20 };

/* Like pthread_create, with a stack of ISO_STACK_BYTES; returns 0 or an error number. */
int iso_thread_start(pthread_t *thread, void *(*main)(void *argument), void *argument);

/* Calls function(argument) with a stack of at least ISO_STACK_BYTES, and returns its result: on a new thread
 * if the stack of the main thread, from which this must be called, is limited to less. For the main functions
 * of programs. */
void *iso_call_with_stack(void *(*function)(void *argument), void *argument);

#endif
