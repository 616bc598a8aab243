/* cgroup: the memory that the control groups of this process leave it: those of SLURM jobs, systemd units and
 * containers. Linux, cgroup versions 1 and 2. */
#ifndef ISO_BASE_CGROUP_H
#define ISO_BASE_CGROUP_H

#include <stdint.h>

/* Returns how many bytes the process may still take: the least of limit minus usage over its own memory
 * cgroup and all those above it. Cached file pages, which the kernel drops when memory is short, do not
 * count as used. UINT64_MAX: there is no limit, or no cgroup. `root`: "" for this system, or a folder with
 * copies of /proc/self/cgroup, /proc/self/mountinfo and of what these name, for tests. */
uint64_t iso_cgroup_memory_left(const char *root);

/* The number after `key` at the beginning of a line of a file; the first number of the file if `key` is
 * empty. UINT64_MAX: there is no such file, line or number. */
uint64_t iso_number_in_file(const char *path, const char *key);

#endif
