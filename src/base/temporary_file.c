/* temporary_file: with O_TMPFILE, or, where the file system has none, with a name that is removed at once. */
#include "base/temporary_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *iso_temporary_folder(void) {
    const char *folder = getenv("TMPDIR");
    return folder && *folder ? folder : "/tmp";
}

/* A file without a name; below 0: errno says why there is none. */
static int create_nameless(const char *folder) {
    char name[4096];
    int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0 || snprintf(name, sizeof name, "%s/isopoint-XXXXXX", folder) >= (int)sizeof name)
        return file;
    file = mkostemp(name, O_CLOEXEC);
    if (file >= 0) unlink(name);
    return file;
}

int iso_temporary_file_beside(const char *path) {
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    const int file = folder ? create_nameless(folder) : -1;
    const int code = folder ? errno : ENOMEM;
    free(folder);
    return file < 0 ? -code : file;
}

int iso_temporary_file_create(uint64_t bytes) {
    const int file = create_nameless(iso_temporary_folder());
    if (file < 0) return -errno;
    int code = bytes > INT64_MAX ? EFBIG : EINTR;
    while (code == EINTR) code = posix_fallocate(file, 0, (off_t)bytes);
    if (!code) return file;
    close(file);
    return -code;
}
