/* thread: threads whose stacks have a known size. Without one they get what the process is limited to (ulimit
 * -s), which may be less than the arrays of kernels need. */
#ifndef ISO_BASE_THREAD_H
#define ISO_BASE_THREAD_H

#include <pthread.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What every function of the library may use of its caller's stack, several times over. Reserved, and taken
 * page by page as it is used. */
enum { ISO_STACK_BYTES = 2 << 20 };

/* As pthread_create, with a stack of ISO_STACK_BYTES: 0, or an error number. */
int iso_thread_start(pthread_t *thread, void *(*main)(void *argument), void *argument);

/* Calls function(argument) and returns what it returns: directly when the stack of the process's main thread,
 * which is to call this, may grow to ISO_STACK_BYTES, else on a thread of its own. For programs. */
void *iso_call_with_stack(void *(*function)(void *argument), void *argument);

#ifdef __cplusplus
}
#endif
#endif
