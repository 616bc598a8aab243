/* guard: runs work in a child process with limits, so that a crash of a library costs only the child. */
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

void iso_hdf5_allow_seconds(int seconds) {
    struct rlimit now;
    struct rusage used;
    if (getrlimit(RLIMIT_CPU, &now) != 0 || getrusage(RUSAGE_SELF, &used) != 0) return;
    now.rlim_cur = (rlim_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1 + seconds);
    if (now.rlim_cur > now.rlim_max) now.rlim_cur = now.rlim_max;
    setrlimit(RLIMIT_CPU, &now);
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

static _Noreturn void run_child(const iso_hdf5_child *child) {
    leave_parent();
    uint64_t data = data_bytes();
    if (!__builtin_add_overflow(data, child->memory, &data)) lower_limit(RLIMIT_DATA, data);
    iso_hdf5_allow_seconds(child->seconds);
    lower_limit(RLIMIT_CORE, 0);
    child->work(child->context);
    *child->finished = 1;
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

iso_status iso_hdf5_start_child(const char *path, iso_hdf5_child *child, iso_error *error) {
    const pid_t parent = getpid();
    *child->finished = 0;
    child->id = fork();
    if (child->id < 0) {
        child->id = 0;
        return iso_fail(error, ISO_ERR_NOMEM, "%s: no process can be started to read it: %s", path,
                        strerror(errno));
    }
    if (child->id == 0) {
        if (!child->stays) prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(1);
        run_child(child);
    }
    return ISO_OK;
}

bool iso_hdf5_end_child(iso_hdf5_child *child, char reason[ISO_HDF5_SPECIAL]) {
    const int result = wait_for(child->id), number = WIFSIGNALED(result) ? WTERMSIG(result) : 0;
    child->id = 0;
    if (number == SIGXCPU || number == SIGKILL)
        snprintf(reason, ISO_HDF5_SPECIAL, "libhdf5 takes too long");
    else
        snprintf(reason, ISO_HDF5_SPECIAL, "libhdf5 cannot read it (%s)",
                 number ? strsignal(number) : "it ended early");
    return *child->finished;
}

iso_status iso_hdf5_guard(const char *path, uint64_t memory, int seconds, void (*work)(void *context),
                          void *context, volatile int *finished, iso_error *error) {
    char reason[ISO_HDF5_SPECIAL];
    iso_hdf5_child child = {
        .work = work, .context = context, .memory = memory, .seconds = seconds, .finished = finished};
    ISO_TRY(iso_hdf5_start_child(path, &child, error));
    if (iso_hdf5_end_child(&child, reason)) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: %s", path, reason);
}
