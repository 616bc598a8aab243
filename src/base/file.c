/* file: sinks on nameless or temporary files, which get their target's name when they are committed. */
#define _GNU_SOURCE
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The type is checked after opening, so that the file cannot be exchanged in between. O_NONBLOCK avoids
 * waiting for the writer of a FIFO, and has no effect on regular files. */
iso_status iso_file_open(const char *path, FILE **stream, uint64_t *bytes, iso_error *error) {
    struct stat info = {0};
    const int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0 && errno != ENXIO) /* ENXIO: a socket */
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    const bool regular = file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode);
    *stream = regular ? fdopen(file, "rb") : NULL;
    if (*stream) {
        if (bytes) *bytes = (uint64_t)info.st_size;
        return ISO_OK;
    }
    const bool folder = file >= 0 && S_ISDIR(info.st_mode);
    if (file >= 0) close(file);
    if (regular) return iso_fail_memory(error, path);
    return iso_fail(error, ISO_ERR_IO, "%s: not a regular file%s", path, folder ? " but a folder" : "");
}

/* The permissions of the new file: those of an existing target, else those that fopen would give it. */
static mode_t wanted_mode(const char *target) {
    struct stat info;
    if (stat(target, &info) == 0) return info.st_mode & 0777;
    mode_t mask = umask(0);
    umask(mask);
    return 0666 & ~mask;
}

static iso_status fail_path(iso_error *error, const char *path, int code) {
    return iso_fail(error, ISO_ERR_WRITE, "%s: cannot write: %s", path, strerror(code));
}

/* Opens /dev/null, a terminal or a pipe directly, because renaming a file to its name would replace it. */
static iso_status open_device(const char *path, iso_sink *sink, iso_error *error) {
    char *target = strdup(path);
    if (!target) return iso_fail_memory(error, path);
    FILE *stream = fopen(path, "wb");
    if (!stream) {
        int code = errno;
        free(target);
        return fail_path(error, path, code);
    }
    *sink = (iso_sink){.stream = stream, .target = target};
    return ISO_OK;
}

/* Opens a new file in the target's folder: one without a name, which disappears when the process ends in any
 * way; or, where the file system has no such files (NFS, some FUSE), one with a temporary name, which a
 * killed process leaves behind. Writes that name, or "", to `name`. */
static int open_beside(const char *path, char *name) {
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    int descriptor = folder && access("/proc/self/fd", X_OK) == 0
                         ? open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600)
                         : -1;
    free(folder);
    if (descriptor < 0) return mkostemp(name, O_CLOEXEC);
    *name = '\0';
    return descriptor;
}

static iso_status open_unseen(const char *path, iso_sink *sink, iso_error *error) {
    char *target = strdup(path), *temporary = NULL;
    if (!target || asprintf(&temporary, "%s.XXXXXX", path) < 0) {
        free(target);
        return iso_fail_memory(error, path);
    }
    int descriptor = open_beside(path, temporary);
    int code = errno;
    FILE *stream = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
    if (!stream) {
        if (descriptor >= 0) {
            close(descriptor);
            if (*temporary) unlink(temporary);
        }
        free(target);
        free(temporary);
        return fail_path(error, path, code);
    }
    fchmod(descriptor, wanted_mode(path));
    *sink = (iso_sink){stream, target, temporary};
    return ISO_OK;
}

iso_status iso_sink_open(const char *path, iso_sink *sink, iso_error *error) {
    if (strcmp(path, "-") == 0) {
        *sink = (iso_sink){.stream = stdout};
        return ISO_OK;
    }
    struct stat info;
    bool exists = stat(path, &info) == 0;
    if (exists && S_ISDIR(info.st_mode)) return fail_path(error, path, EISDIR);
    if (exists && !S_ISREG(info.st_mode)) return open_device(path, sink, error);
    if (exists && (!(info.st_mode & 0222) || faccessat(AT_FDCWD, path, W_OK, AT_EACCESS) != 0))
        return fail_path(error, path, EACCES);
    errno = 0;
    char *target = iso_file_follow(path);
    if (!target) return fail_path(error, path, errno ? errno : ENOMEM);
    iso_status status = open_unseen(target, sink, error);
    free(target);
    return status;
}

iso_status iso_sink_check(const char *path, iso_error *error) {
    if (!path || strcmp(path, "-") == 0) return ISO_OK;
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) return ISO_OK;
    iso_sink sink = {0};
    ISO_TRY(iso_sink_open(path, &sink, error));
    iso_sink_abort(&sink);
    return ISO_OK;
}

/* Returns the text of a symbolic link, to be released with free(); NULL if `path` is not a link or if there
 * is no memory. */
static char *read_link(const char *path) {
    char text[4096];
    ssize_t length = readlink(path, text, sizeof text);
    return length < 0 || length == sizeof text ? NULL : strndup(text, (size_t)length);
}

char *iso_file_follow(const char *path) {
    enum { DEPTH = 40 }; /* as many links as Linux follows */
    char *at = strdup(path), *next;
    for (int depth = 0; at && (next = read_link(at)); depth++) {
        char *slash = strrchr(at, '/'), *whole = NULL;
        if (depth == DEPTH) {
            errno = ELOOP;
        } else if (*next == '/' || !slash) {
            whole = strdup(next);
        } else if (asprintf(&whole, "%.*s%s", (int)(slash - at) + 1, at, next) < 0) {
            whole = NULL;
        }
        free(next);
        free(at);
        at = whole;
    }
    return at;
}

/* Gives a nameless file its target's name. linkat cannot replace an existing file: then the file gets a
 * temporary name, which is renamed. Returns 0 or an errno. */
static int name_file(int descriptor, const char *target) {
    char source[64], *passing = NULL;
    snprintf(source, sizeof source, "/proc/self/fd/%d", descriptor);
    if (linkat(AT_FDCWD, source, AT_FDCWD, target, AT_SYMLINK_FOLLOW) == 0) return 0;
    if (errno != EEXIST) return errno;
    if (asprintf(&passing, "%s.%ld-%d", target, (long)getpid(), descriptor) < 0) return ENOMEM;
    int code = 0;
    if (linkat(AT_FDCWD, source, AT_FDCWD, passing, AT_SYMLINK_FOLLOW) != 0) {
        code = errno;
    } else if (rename(passing, target) != 0) {
        code = errno;
        unlink(passing);
    }
    free(passing);
    return code;
}

/* Closes the sink's file; if `code` is 0, the file gets its target's name. Returns 0 or an errno. */
static int close_file(iso_sink *sink, int code) {
    bool nameless = sink->temporary && !*sink->temporary;
    if (!code && nameless) code = name_file(fileno(sink->stream), sink->target);
    if (fclose(sink->stream) != 0 && !code) code = errno;
    sink->stream = NULL;
    if (!code && sink->temporary && !nameless && rename(sink->temporary, sink->target) != 0) code = errno;
    return code;
}

iso_status iso_sink_commit(iso_sink *sink, iso_error *error) {
    const char *name = sink->target ? sink->target : "standard output";
    errno = 0;
    int code = 0;
    if (fflush(sink->stream) != 0 || ferror(sink->stream)) code = errno ? errno : EIO;
    if (sink->target) code = close_file(sink, code);
    iso_status status = code ? fail_path(error, name, code) : ISO_OK;
    if (code) {
        iso_sink_abort(sink);
        return status;
    }
    free(sink->target);
    free(sink->temporary);
    *sink = (iso_sink){0};
    return ISO_OK;
}

void iso_sink_abort(iso_sink *sink) {
    if (sink->target) {
        if (sink->stream) fclose(sink->stream);
        if (sink->temporary && *sink->temporary) unlink(sink->temporary);
    }
    free(sink->target);
    free(sink->temporary);
    *sink = (iso_sink){0};
}

void iso_file_remove(const char *path) {
    struct stat info;
    if (!path || strcmp(path, "-") == 0 || stat(path, &info) != 0 || !S_ISREG(info.st_mode)) return;
    char *target = iso_file_follow(path);
    if (target) unlink(target);
    free(target);
}

bool iso_file_same(const char *a, const char *b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && S_ISREG(second.st_mode) &&
           first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}
