/* Running out of memory on purpose: calls for memory are refused from a chosen one on (the linker's --wrap;
 * see iso_refusing_test in CMakeLists.txt). Not for several threads. */
#ifndef ISO_TESTS_REFUSED_MEMORY_H
#define ISO_TESTS_REFUSED_MEMORY_H

/* Grants `calls` calls for memory and refuses all that follow. */
void test_refuse_memory_after(long calls);

void test_grant_memory(void);

/* Calls refused since the last test_refuse_memory_after. */
long test_refusals(void);

#endif
