/* refused_memory: simulates running out of memory: allocations fail from a chosen one on (by the linker's
 * --wrap; see iso_refusing_test in CMakeLists.txt). For one thread. */
#ifndef ISO_TESTS_REFUSED_MEMORY_H
#define ISO_TESTS_REFUSED_MEMORY_H

/* Lets the next `calls` allocations succeed and all later ones fail. */
void test_refuse_memory_after(long calls);

void test_grant_memory(void);

/* The number of allocations that failed since the last test_refuse_memory_after. */
long test_refusals(void);

#endif
