/* file: sinks on nameless or temporary files, which get their target's name when they are committed. */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"

static _Atomic(iso_file_fetcher *) file_fetcher;

void iso_file_set_fetcher(iso_file_fetcher *fetcher) {
    file_fetcher = fetcher;
}

static iso_status fail_type(const char *path, const struct stat *info, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: not a regular file%s", path,
                    S_ISDIR(info->st_mode) ? " but a folder" : "");
}

/* The type is checked before opening, because a FIFO that is opened and closed again loses its writer, and
 * again after opening, because the file may be exchanged in between. O_NONBLOCK avoids waiting for the writer
 * of such a FIFO, and has no effect on regular files. */
iso_status iso_file_descriptor(const char *path, int *descriptor, uint64_t *bytes, iso_error *error) {
    struct stat info = {0};
    char copy[ISO_FILE_PATH];
    const char *local = path;
    iso_file_fetcher *const fetch = iso_is_url(path) ? file_fetcher : NULL;
    if (fetch) {
        ISO_TRY(fetch(path, copy, error));
        local = copy;
    }
    if (stat(local, &info) == 0 && !S_ISREG(info.st_mode)) return fail_type(path, &info, error);
    const int file = open(local, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0 && errno != ENXIO) /* ENXIO: a socket */
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    if (file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode)) {
        *descriptor = file;
        if (bytes) *bytes = (uint64_t)info.st_size;
        return ISO_OK;
    }
    if (file >= 0) close(file);
    return fail_type(path, &info, error);
}

iso_status iso_file_open(const char *path, FILE **stream, uint64_t *bytes, iso_error *error) {
    int file = -1;
    uint64_t size = 0;
    ISO_TRY(iso_file_descriptor(path, &file, &size, error));
    FILE *opened = fdopen(file, "rb");
    if (!opened) {
        close(file);
        return iso_fail_memory(error, path);
    }
    *stream = opened;
    if (bytes) *bytes = size;
    return ISO_OK;
}

size_t iso_file_head(const char *path, void *head, size_t bytes) {
    int file = -1;
    if (iso_file_descriptor(path, &file, NULL, NULL) != ISO_OK) return 0;
    size_t done = 0;
    for (ssize_t now = 1; done < bytes && now > 0; done += now > 0 ? (size_t)now : 0)
        now = read(file, (char *)head + done, bytes - done);
    close(file);
    return done;
}

iso_status iso_file_check_text(const char *path, const void *head, size_t bytes, iso_error *error) {
    const char *wide = iso_text_wide(head, bytes);
    return wide ? iso_fail(error, ISO_ERR_FORMAT, "%s: text in %s, which is not read; save it as UTF-8", path,
                           wide)
                : ISO_OK;
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
    if (code == ENOMEM) return iso_fail_memory(error, path);
    return iso_fail(error, ISO_ERR_WRITE, "%s: cannot write: %s", path,
                    code == ENOENT ? "its folder does not exist" : strerror(code));
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

/* ---- temporary names: TARGET.isonew1 and so on. A file that has one is locked by the program that writes
 * it, so that what a killed program left is known by its lock, which nobody holds. */

enum { TEMPORARY_NAMES = 8 };

static char *temporary_name(const char *target, int number) {
    char *name;
    return asprintf(&name, "%s.isonew%d", target, number) < 0 ? NULL : name;
}

static bool is_named(int descriptor, const char *name) {
    struct stat file, named;
    return fstat(descriptor, &file) == 0 && lstat(name, &named) == 0 && S_ISREG(named.st_mode) &&
           file.st_dev == named.st_dev && file.st_ino == named.st_ino;
}

static void remove_unlocked(const char *name) {
    struct stat info;
    if (lstat(name, &info) != 0 || !S_ISREG(info.st_mode)) return;
    const int file = open(name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return;
    if (flock(file, LOCK_EX | LOCK_NB) == 0 && is_named(file, name)) unlink(name);
    close(file);
}

static void remove_stale(const char *target) {
    for (int number = 1; number <= TEMPORARY_NAMES; number++) {
        char *name = temporary_name(target, number);
        if (name) remove_unlocked(name);
        free(name);
    }
}

/* Makes a file with a temporary name, and locks it. Returns its descriptor, or -1 with errno set. */
static int open_temporary(const char *target, char **name) {
    for (int number = 1; number <= TEMPORARY_NAMES; number++) {
        *name = temporary_name(target, number);
        const int file = *name ? open(*name, O_CREAT | O_EXCL | O_WRONLY | O_NOFOLLOW | O_CLOEXEC, 0600) : -1;
        /* (Between the two calls another program may have removed it, as one that nobody locks.) */
        if (file >= 0 &&
            ((flock(file, LOCK_EX | LOCK_NB) != 0 && errno != EWOULDBLOCK) || is_named(file, *name)))
            return file;
        const int code = file >= 0 ? EEXIST : errno;
        if (file >= 0) close(file);
        free(*name);
        *name = NULL;
        errno = code;
        if (code != EEXIST) return -1;
    }
    return -1;
}

/* Opens a new file in the target's folder: one without a name, which disappears when the process ends in any
 * way; or, where the file system has no such files (NFS, some FUSE), one with a temporary name, which a
 * killed process leaves behind. Sets *name to that name, or to ""; to be freed. */
static int open_beside(const char *path, char **name) {
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    int descriptor = folder && access("/proc/self/fd", X_OK) == 0
                         ? open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600)
                         : -1;
    free(folder);
    remove_stale(path);
    if (descriptor < 0) return open_temporary(path, name);
    flock(descriptor, LOCK_EX | LOCK_NB); /* nobody else can have locked it */
    *name = strdup("");
    return descriptor;
}

static iso_status open_unseen(const char *path, iso_sink *sink, iso_error *error) {
    char *target = strdup(path), *temporary = NULL;
    if (!target) return iso_fail_memory(error, path);
    int descriptor = open_beside(path, &temporary);
    int code = errno;
    FILE *stream = descriptor >= 0 && temporary ? fdopen(descriptor, "wb") : NULL;
    if (!stream) {
        if (descriptor >= 0) {
            close(descriptor);
            if (temporary && *temporary) unlink(temporary);
            code = ENOMEM;
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

/* Whether `path` is a regular file that begins with `mark`. */
static bool begins_with(const char *path, const void *mark, size_t bytes) {
    char text[64];
    struct stat info;
    const int file = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    const bool begins = file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode) &&
                        bytes <= sizeof text && read(file, text, bytes) == (ssize_t)bytes &&
                        memcmp(text, mark, bytes) == 0;
    if (file >= 0) close(file);
    return begins;
}

iso_status iso_sink_open_own(const char *path, const void *mark, size_t bytes, iso_sink *sink,
                             iso_error *error) {
    struct stat info;
    if (lstat(path, &info) == 0 && !begins_with(path, mark, bytes))
        return iso_fail(error, ISO_ERR_WRITE, "%s: cannot write: %s", path,
                        S_ISLNK(info.st_mode) ? "it is a symbolic link" : "another file has this name");
    return open_unseen(path, sink, error);
}

void iso_file_remove_unfinished(const char *path) {
    char *target = iso_file_follow(path);
    if (target) remove_stale(target);
    free(target);
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

/* Gives a nameless file a name that no file has. Returns 0 or an errno. */
static int link_file(int descriptor, const char *name) {
    char source[64];
    snprintf(source, sizeof source, "/proc/self/fd/%d", descriptor);
    return linkat(AT_FDCWD, source, AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
}

/* Gives a nameless file a temporary name, and from that its target's. Returns 0 or an errno. */
static int link_and_rename(int descriptor, const char *target, int number) {
    char *name = temporary_name(target, number);
    int code = name ? link_file(descriptor, name) : ENOMEM;
    if (!code && rename(name, target) != 0) {
        code = errno;
        unlink(name);
    }
    free(name);
    return code;
}

/* Gives a nameless file its target's name, at once if no file has it: linkat cannot replace one. Returns 0 or
 * an errno. */
static int name_file(int descriptor, const char *target) {
    int code = link_file(descriptor, target);
    for (int number = 1; code == EEXIST && number <= TEMPORARY_NAMES; number++)
        code = link_and_rename(descriptor, target, number);
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
    if (target)
        unlink(target);
    else if (lstat(path, &info) == 0 && S_ISREG(info.st_mode)) /* (no memory) */
        unlink(path);
    free(target);
}

bool iso_memory_stream_close(FILE *stream, char **bytes) {
    bool whole = !ferror(stream);
    whole &= fclose(stream) == 0;
    if (whole && *bytes) return true;
    free(*bytes);
    *bytes = NULL;
    return false;
}

bool iso_file_same(const char *a, const char *b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && S_ISREG(second.st_mode) &&
           first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}
