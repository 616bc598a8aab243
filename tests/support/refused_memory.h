/* refused_memory: simulates running out of memory: allocations fail from a chosen one on (by the linker's
 * --wrap; see iso_refusing_test in CMakeLists.txt). For one thread. */
#ifndef ISO_TESTS_REFUSED_MEMORY_H
#define ISO_TESTS_REFUSED_MEMORY_H

#include "base/status.h"

/* Lets the next `calls` allocations succeed and all later ones fail. */
void test_refuse_memory_after(long calls);

void test_grant_memory(void);

/* Calls `work` again and again, with one more allocation allowed each time, until none fails. Fails the test
 * unless `work` returned ISO_ERR_NOMEM each time before. Returns how often that was. *last: the status of the
 * last call; NULL: it must be ISO_OK. */
long test_refuse_each(iso_status (*work)(const void *context, iso_error *error), const void *context,
                      iso_status *last);

/* The number of allocations that failed since the last test_refuse_memory_after. */
long test_refusals(void);

#endif
