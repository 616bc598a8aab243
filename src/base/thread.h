/* thread: starts threads with a stack of known size. By default the size is the process's limit (ulimit -s),
 * which may be less than the arrays of kernels need. */
#ifndef ISO_BASE_THREAD_H
#define ISO_BASE_THREAD_H

#include <pthread.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The size of the stacks. It is several times what any function of the library needs. The memory is reserved,
 * and pages are taken when they are used. */
enum { ISO_STACK_BYTES = 2 << 20 };

/* Starts a thread like pthread_create, with a stack of ISO_STACK_BYTES. Returns 0 or an error number. */
int iso_thread_start(pthread_t *thread, void *(*main)(void *argument), void *argument);

/* Calls function(argument) and returns its result. If the stack of the main thread, which must be the caller,
 * cannot grow to ISO_STACK_BYTES, the function is called on a new thread. For programs. */
void *iso_call_with_stack(void *(*function)(void *argument), void *argument);

#ifdef __cplusplus
}
#endif
#endif
