#include "bench_child.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

struct bench_child {
    pid_t process;
    FILE *to, *from;
    char name[64];
};

/* ---- starting: between fork and exec only what is safe in a process that has other threads */

enum { MORE_VARIABLES = 4 };

typedef struct launch {
    const char *const *argv;
    char **environment; /* ours, then what is added */
    char more[MORE_VARIABLES][64];
    cpu_set_t processors;
    bool bound;
    int in[2], out[2];
} launch;

extern char **environ;

static bool names_same(const char *a, const char *b) {
    size_t length = strcspn(b, "=");
    return strncmp(a, b, length + 1) == 0;
}

/* A variable that is set already is left out of the copy. */
static iso_status make_environment(launch *plan, int threads, const char *display, iso_error *error) {
    int added = 0, count = 0;
    /* Without a leak checker: neither VTK nor Mesa frees everything. */
    snprintf(plan->more[added++], sizeof plan->more[0], "ASAN_OPTIONS=detect_leaks=0");
    if (display) snprintf(plan->more[added++], sizeof plan->more[0], "DISPLAY=%.40s", display);
    if (display) snprintf(plan->more[added++], sizeof plan->more[0], "LIBGL_ALWAYS_SOFTWARE=1");
    if (threads) snprintf(plan->more[added++], sizeof plan->more[0], "LP_NUM_THREADS=%d", threads);
    while (environ[count]) count++;
    plan->environment = calloc((size_t)(count + added) + 1, sizeof *plan->environment);
    if (!plan->environment) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    int kept = 0;
    for (int i = 0; i < count; i++) {
        bool replaced = false;
        for (int k = 0; k < added; k++) replaced = replaced || names_same(environ[i], plan->more[k]);
        if (!replaced) plan->environment[kept++] = environ[i];
    }
    for (int k = 0; k < added; k++) plan->environment[kept++] = plan->more[k];
    return ISO_OK;
}

/* The first `threads` of the processors that we may use. */
static void choose_processors(launch *plan, int threads) {
    cpu_set_t allowed;
    CPU_ZERO(&plan->processors);
    if (!threads || sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&plan->processors) < threads; cpu++)
        if (CPU_ISSET(cpu, &allowed)) CPU_SET(cpu, &plan->processors);
    plan->bound = true;
}

static void become(const launch *plan) {
    prctl(PR_SET_PDEATHSIG, SIGTERM); /* an X server removes its socket then */
    if (plan->bound) sched_setaffinity(0, sizeof plan->processors, &plan->processors);
    if (dup2(plan->in[0], STDIN_FILENO) < 0 || dup2(plan->out[1], STDOUT_FILENO) < 0) _exit(127);
    execvpe(plan->argv[0], (char *const *)plan->argv, plan->environment);
    _exit(127);
}

static iso_status launch_process(launch *plan, bench_child *child, iso_error *error) {
    if (pipe2(plan->in, O_CLOEXEC) != 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "cannot start another process");
    if (pipe2(plan->out, O_CLOEXEC) != 0) {
        close(plan->in[0]);
        close(plan->in[1]);
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "cannot start another process");
    }
    child->process = fork();
    if (child->process == 0) become(plan);
    close(plan->in[0]);
    close(plan->out[1]);
    child->to = fdopen(plan->in[1], "w");
    child->from = fdopen(plan->out[0], "r");
    if (child->process < 0 || !child->to || !child->from)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "cannot start another process");
    return ISO_OK;
}

iso_status bench_child_start(const char *const *argv, int threads, const char *display, bench_child **out,
                             iso_error *error) {
    bench_child *child = calloc(1, sizeof *child);
    if (!child) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const char *slash = strrchr(argv[0], '/');
    snprintf(child->name, sizeof child->name, "%.63s", slash ? slash + 1 : argv[0]);
    signal(SIGPIPE, SIG_IGN); /* a child that died is an answer that does not come */
    launch plan = {.argv = argv};
    choose_processors(&plan, threads);
    iso_status status = make_environment(&plan, threads, display, error);
    if (status == ISO_OK) status = launch_process(&plan, child, error);
    free(plan.environment);
    if (status != ISO_OK)
        bench_child_stop(child);
    else
        *out = child;
    return status;
}

/* ---- talking ---- */

iso_status bench_child_ask(bench_child *child, const char *question, char *answer, int size,
                           iso_error *error) {
    if (question) fprintf(child->to, "%s\n", question);
    if (question) fflush(child->to);
    if (!fgets(answer, size, child->from))
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s does not run here", child->name);
    answer[strcspn(answer, "\n")] = 0;
    return ISO_OK;
}

bool bench_child_end(bench_child *child) {
    if (!child) return true;
    if (child->to) fclose(child->to);
    int status = -1;
    char rest[256];
    while (child->from && fgets(rest, sizeof rest, child->from)) continue;
    if (child->from) fclose(child->from);
    bool ended = child->process > 0 && waitpid(child->process, &status, 0) == child->process;
    free(child);
    return ended && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void bench_child_stop(bench_child *child) {
    if (child && child->process > 0) kill(child->process, SIGTERM);
    bench_child_end(child);
}

iso_status bench_sibling(const char *name, char *path, int size, iso_error *error) {
    char self[1024];
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length < 0) return iso_fail(error, ISO_ERR_UNSUPPORTED, "cannot find other programs");
    self[length] = 0;
    char *slash = strrchr(self, '/');
    if (slash) *slash = 0;
    int wanted = snprintf(path, (size_t)size, "%s/%s", self, name);
    if (wanted >= size || access(path, X_OK) != 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without %s", name);
    return ISO_OK;
}

/* ---- the display ---- */

iso_status bench_display_open(bench_display *display, const char **name, iso_error *error) {
    /* It writes the number of the display that it found free to descriptor 1. */
    static const char *const argv[] = {"Xvfb",     "-displayfd", "1",   "-screen",  "0",
                                       "64x64x24", "-nolisten",  "tcp", "-noreset", NULL};
    *name = display->name;
    if (display->server) return ISO_OK;
    if (display->problem[0]) return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s", display->problem);
    char number[16];
    iso_status status = bench_child_start(argv, 0, NULL, &display->server, error);
    if (status == ISO_OK) status = bench_child_ask(display->server, NULL, number, sizeof number, error);
    if (status == ISO_OK) {
        snprintf(display->name, sizeof display->name, ":%s", number);
        return ISO_OK;
    }
    bench_display_close(display);
    snprintf(display->problem, sizeof display->problem, "no X display: Xvfb (package xvfb) does not start");
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s", display->problem);
}

void bench_display_close(bench_display *display) {
    bench_child_stop(display->server);
    display->server = NULL;
}
