/* guard: runs work in a child process with limits, so that a crash of a library costs only the child. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "grids/volume/hdf5/hdf5.h"

void *iso_hdf5_share(size_t bytes) {
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void iso_hdf5_unshare(void *memory, size_t bytes) {
    if (memory) munmap(memory, bytes);
}

/* ---- in the child ---- */

/* What the process has already of the memory that RLIMIT_DATA limits; without the system's answer the limit
 * is left as it is. */
static uint64_t data_bytes(void) {
    char text[256] = "";
    unsigned long data = 0;
    const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0) return UINT64_MAX;
    const ssize_t got = read(file, text, sizeof text - 1);
    close(file);
    if (got <= 0 || sscanf(text, "%*u %*u %*u %*u %*u %lu", &data) != 1) return UINT64_MAX;
    return data * (uint64_t)sysconf(_SC_PAGESIZE);
}

static void lower_limit(int resource, uint64_t limit) {
    struct rlimit now;
    if (getrlimit(resource, &now) != 0 || (now.rlim_cur != RLIM_INFINITY && now.rlim_cur <= limit)) return;
    now.rlim_cur = limit;
    setrlimit(resource, &now);
}

/* Signal handlers and the standard streams belong to the process that was copied. */
static void leave_parent(void) {
    sigset_t none;
    sigemptyset(&none);
    for (int number = 1; number < NSIG; number++) signal(number, SIG_DFL);
    sigprocmask(SIG_SETMASK, &none, NULL);
    const int nowhere = open("/dev/null", O_RDWR);
    for (int stream = 0; stream < 3 && nowhere >= 0; stream++) dup2(nowhere, stream);
}

static _Noreturn void run_child(uint64_t memory, int seconds, void (*work)(void *), void *context,
                                volatile int *finished) {
    leave_parent();
    uint64_t data = data_bytes();
    if (!__builtin_add_overflow(data, memory, &data)) lower_limit(RLIMIT_DATA, data);
    lower_limit(RLIMIT_CPU, (uint64_t)seconds);
    lower_limit(RLIMIT_CORE, 0);
    work(context);
    *finished = 1;
    _exit(0);
}

/* ---- in the parent ---- */

/* Waits for the child's end. The program may have asked the system to forget its children: `result` is 0
 * then. */
static int wait_for(pid_t child) {
    int result = 0;
    while (waitpid(child, &result, 0) < 0)
        if (errno != EINTR) return 0;
    return result;
}

iso_status iso_hdf5_guard(const char *path, uint64_t memory, int seconds, void (*work)(void *context),
                          void *context, volatile int *finished, iso_error *error) {
    const pid_t parent = getpid();
    *finished = 0;
    const pid_t child = fork();
    if (child < 0)
        return iso_fail(error, ISO_ERR_NOMEM, "%s: no process can be started to read it: %s", path,
                        strerror(errno));
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(1);
        run_child(memory, seconds, work, context, finished);
    }
    const int result = wait_for(child);
    if (*finished) return ISO_OK;
    if (WIFSIGNALED(result) && (WTERMSIG(result) == SIGXCPU || WTERMSIG(result) == SIGKILL))
        return iso_fail(error, ISO_ERR_IO, "%s: damaged: libhdf5 takes too long", path);
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: libhdf5 cannot read it (%s)", path,
                    WIFSIGNALED(result) ? strsignal(WTERMSIG(result)) : "it ended early");
}
