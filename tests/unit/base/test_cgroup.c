/* cgroup: memory limits read from copies of the files of SLURM, systemd and Docker. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/cgroup.h"

static char tree[256];

static void make_tree(void) {
    snprintf(tree, sizeof tree, "%s", ISO_TEST_TMP "/cgroup.XXXXXX");
    assert_non_null(mkdtemp(tree));
}

static void remove_tree(void) {
    char command[512];
    snprintf(command, sizeof command, "rm -r '%s'", tree);
    assert_int_equal(system(command), 0);
}

/* Writes a file below the tree, and the folders that it lies in. */
static void put(const char *path, const char *text) {
    char full[1024];
    snprintf(full, sizeof full, "%s%s", tree, path);
    for (char *slash = full + strlen(tree) + 1; (slash = strchr(slash, '/')); slash++) {
        *slash = 0;
        mkdir(full, 0700);
        *slash = '/';
    }
    FILE *file = fopen(full, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static void systemd_limits_a_unit(void **state) {
    (void)state;
    make_tree();
    put("/proc/self/cgroup", "0::/user.slice/run-1.scope\n");
    put("/proc/self/mountinfo",
        "24 30 0:22 / /proc rw - proc proc rw\n"
        "31 23 0:28 / /sys/fs/cgroup rw,nosuid shared:4 - cgroup2 cgroup2 rw,nsdelegate\n");
    put("/sys/fs/cgroup/user.slice/memory.max", "max\n");
    put("/sys/fs/cgroup/user.slice/memory.current", "999\n");
    put("/sys/fs/cgroup/user.slice/run-1.scope/memory.max", "1000000\n");
    put("/sys/fs/cgroup/user.slice/run-1.scope/memory.current", "400000\n");
    assert_int_equal(iso_cgroup_memory_left(tree), 600000);
    put("/sys/fs/cgroup/user.slice/run-1.scope/memory.stat",
        "anon 5\ninactive_file 100000\nactive_file 50000\n"); /* the kernel can drop these pages */
    assert_int_equal(iso_cgroup_memory_left(tree), 750000);
    put("/sys/fs/cgroup/user.slice/memory.max", "500999\n"); /* a group above it has less */
    assert_int_equal(iso_cgroup_memory_left(tree), 500000);
    put("/sys/fs/cgroup/user.slice/memory.max", "7\n"); /* all of it is used */
    assert_int_equal(iso_cgroup_memory_left(tree), 0);
    remove_tree();
}

static void slurm_limits_a_step(void **state) {
    (void)state;
    make_tree();
    put("/proc/self/cgroup", "9:name=systemd:/\n4:cpu,memory:/slurm/uid_7/job_3/step_0\n0::/\n");
    put("/proc/self/mountinfo",
        "31 23 0:28 / /sys/fs/cgroup rw - tmpfs tmpfs rw,mode=755\n"
        "34 31 0:31 / /sys/fs/cgroup/cpuset rw - cgroup cgroup rw,cpuset,memory_spread\n"
        "35 31 0:32 / /sys/fs/cgroup/memory rw - cgroup cgroup rw,cpu,memory\n");
    put("/sys/fs/cgroup/memory/slurm/uid_7/job_3/memory.limit_in_bytes", "3000\n");
    put("/sys/fs/cgroup/memory/slurm/uid_7/job_3/memory.usage_in_bytes", "1000\n");
    put("/sys/fs/cgroup/memory/slurm/uid_7/job_3/step_0/memory.limit_in_bytes", "9223372036854771712\n");
    put("/sys/fs/cgroup/memory/slurm/uid_7/job_3/step_0/memory.usage_in_bytes", "1000\n");
    assert_int_equal(iso_cgroup_memory_left(tree), 2000);
    put("/sys/fs/cgroup/memory/slurm/uid_7/job_3/memory.stat", "total_inactive_file 300\ninactive_file 1\n");
    assert_int_equal(iso_cgroup_memory_left(tree), 2300);
    remove_tree();
}

/* In a container the mount's top is the container's own group, whatever its name outside. */
static void containers_see_their_own_group(void **state) {
    (void)state;
    static const char *const groups[] = {"0::/\n", "0::/docker/abc\n", "0::/../../other\n"};
    for (int i = 0; i < 3; i++) {
        make_tree();
        put("/proc/self/cgroup", groups[i]);
        put("/proc/self/mountinfo", i == 1 ? "31 23 0:28 /docker/abc /sys/fs/cgroup ro - cgroup2 cgroup rw\n"
                                           : "31 23 0:28 / /sys/fs/cgroup ro - cgroup2 cgroup rw\n");
        put("/sys/fs/cgroup/memory.max", "5000\n");
        put("/sys/fs/cgroup/memory.current", "1000\n");
        put("/sys/other/memory.max", "5\n"); /* not a cgroup */
        put("/sys/other/memory.current", "1\n");
        assert_int_equal(iso_cgroup_memory_left(tree), 4000);
        put("/proc/self/cgroup", i == 1 ? "0::/docker/abc/child\n" : "0::/child\n");
        put("/sys/fs/cgroup/child/memory.max", "3000\n");
        put("/sys/fs/cgroup/child/memory.current", "1000\n");
        assert_int_equal(iso_cgroup_memory_left(tree), 2000);
        remove_tree();
    }
}

static void anything_else_is_no_limit(void **state) {
    (void)state;
    make_tree();
    assert_true(iso_cgroup_memory_left(tree) == UINT64_MAX);
    put("/proc/self/cgroup", "garbage\n::\n0:\n0::/a/b\n");
    assert_true(iso_cgroup_memory_left(tree) == UINT64_MAX);
    put("/proc/self/mountinfo", "1 2 3\n\n - cgroup2\n31 23 0:28 / /gone rw - cgroup2 cgroup rw\n");
    assert_true(iso_cgroup_memory_left(tree) == UINT64_MAX);
    put("/gone/memory.max", "12 is more than it has\n");
    assert_true(iso_cgroup_memory_left(tree) == UINT64_MAX); /* no usage */
    remove_tree();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(systemd_limits_a_unit),
        cmocka_unit_test(slurm_limits_a_step),
        cmocka_unit_test(containers_see_their_own_group),
        cmocka_unit_test(anything_else_is_no_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
