/* Copies inputs to temporary files. The first bytes decide whether an input is copied, and up to which
 * byte. */
#include "scene/input_spool.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file_types.h"
#include "base/memory.h"
#include "base/temporary_file.h"
#include "base/text.h"

enum {
    HEAD = 1024,    /* bytes by which the format is recognised */
    BLOCK = 1 << 20 /* bytes; a header that is parsed has to end within the first block */
};

bool iso_spool_is_stream(const char *path) {
    struct stat info;
    return strcmp(path, "-") == 0 || (stat(path, &info) == 0 && S_ISFIFO(info.st_mode));
}

const char *iso_spool_name(const char *path) {
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

typedef struct copier {
    const char *name; /* of the input, for messages */
    const iso_spool_opts *opts;
    iso_spool *spool;
    int input;
    char *block; /* BLOCK bytes */
    uint64_t copied;
    uint64_t end;   /* byte behind the last voxel, at most */
    uint64_t limit; /* largest number of bytes to copy */
} copier;

/* ---- the copy's file ---- */

/* Returns a path to an open file; NULL: the system has no /proc. */
static char *name_of_descriptor(int descriptor) {
    static const char *const forms[] = {"/proc/self/fd/%d", "/dev/fd/%d"};
    for (int i = 0; i < 2; i++) {
        char *path = NULL;
        if (asprintf(&path, forms[i], descriptor) < 0) return NULL;
        if (access(path, R_OK) == 0) return path;
        free(path);
    }
    return NULL;
}

static iso_status fail_copy(const copier *c, int code, iso_error *error) {
    return iso_fail(error, ISO_ERR_WRITE, "%s: cannot copy %s here: %s%s", iso_temporary_folder(), c->name,
                    strerror(code), code == ENOSPC ? " (TMPDIR chooses another folder)" : "");
}

static iso_status create_copy(copier *c, iso_error *error) {
    iso_spool *spool = c->spool;
    const char *folder = iso_temporary_folder();
    char *name = NULL;
    int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0) {
        if (asprintf(&name, "%s/isopoint-XXXXXX", folder) < 0) return fail_copy(c, ENOMEM, error);
        file = mkostemp(name, O_CLOEXEC);
    }
    if (file < 0) {
        int code = errno;
        free(name);
        return fail_copy(c, code, error);
    }
    spool->descriptor = file;
    spool->path = name_of_descriptor(file);
    if (name && spool->path) unlink(name);
    spool->named = !spool->path && name;
    if (spool->named)
        spool->path = name;
    else
        free(name);
    if (spool->path) return ISO_OK;
    close(file);
    return fail_copy(c, ENOMEM, error);
}

void iso_spool_close(iso_spool *spool) {
    if (!spool->path) return;
    if (spool->named) unlink(spool->path);
    close(spool->descriptor);
    free(spool->path);
    *spool = (iso_spool){0};
}

/* ---- copying ---- */

/* Reads until `room` bytes are in the block or the input ends. */
static iso_status read_block(const copier *c, size_t room, size_t *count, iso_error *error) {
    while (*count < room) {
        ssize_t got = read(c->input, c->block + *count, room - *count);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", c->name, strerror(errno));
        if (got == 0) break;
        *count += (size_t)got;
    }
    return ISO_OK;
}

static iso_status write_block(copier *c, size_t count, iso_error *error) {
    const char *from = c->block;
    for (c->copied += count; count > 0;) {
        ssize_t written = write(c->spool->descriptor, from, count);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return fail_copy(c, errno, error);
        from += written;
        count -= (size_t)written;
    }
    return ISO_OK;
}

/* Reads the first bytes and determines the format. */
static iso_status read_format(copier *c, size_t *count, const char **format, iso_error *error) {
    ISO_TRY(read_block(c, HEAD, count, error));
    if (*count == 0) return iso_fail(error, ISO_ERR_IO, "%s: is empty", c->name);
    const iso_volume_opts *volume = c->opts->volume;
    const iso_file_type points = iso_file_type_of_head(c->block, *count, ISO_HOLDS_POINTS);
    *format = iso_volume_format(c->block, *count);
    if (volume->raw)
        *format = "raw";
    else if (!*format && c->opts->points && points != ISO_FILE_UNKNOWN)
        *format = iso_file_type_name(points);
    if (*format) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its first bytes are not those of a volume that can be read",
                    c->name);
}

/* Returns the largest possible size of a file with this header; numbers written as text take the most
 * bytes. */
static uint64_t longest_file(const iso_volume_info *info, int components) {
    uint64_t bytes = 32;
    for (int i = 0; i < 3; i++)
        if (__builtin_mul_overflow(bytes, (uint64_t)info->dims[i], &bytes)) return UINT64_MAX;
    if (__builtin_mul_overflow(bytes, (uint64_t)components, &bytes)) return UINT64_MAX;
    return __builtin_add_overflow(bytes, 64u << 20, &bytes) ? UINT64_MAX : bytes;
}

static uint64_t raw_file(const iso_volume_info *info, const iso_raw_layout *raw) {
    uint64_t bytes = iso_raw_layout_number_bytes(raw) * (uint64_t)info->components;
    for (int i = 0; i < 3; i++)
        if (__builtin_mul_overflow(bytes, (uint64_t)info->dims[i], &bytes)) return UINT64_MAX;
    return __builtin_add_overflow(bytes, raw->offset, &bytes) ? UINT64_MAX : bytes;
}

/* Replaces the path of the copy in a message by the name of the input. */
static iso_status name_input(const copier *c, iso_status status, iso_error *error) {
    if (status == ISO_OK || !error) return status;
    const char *text = error->text;
    size_t length = iso_text_begins(text, c->spool->path);
    return iso_fail(error, status, "%s: %s", c->name, text + length + strspn(text + length, ":/ "));
}

/* Checks memory and determines the end of the voxels, for formats whose header precedes the voxels. Files of
 * other formats are copied up to the memory limit. */
static iso_status check_header(copier *c, const char *format, iso_error *error) {
    static const char *const formats[] = {"raw", "nrrd", "nifti", "metaimage"};
    const iso_volume_opts *volume = c->opts->volume;
    bool known = false;
    for (int i = 0; i < 4; i++) known = known || strcmp(format, formats[i]) == 0;
    if (!known) return ISO_OK;
    iso_volume_info info;
    iso_status status = iso_volume_read_info(c->spool->path, volume, &info, error);
    if (status == ISO_OK) status = iso_volume_check_memory(c->spool->path, volume, &info, error);
    if (status != ISO_OK) return name_input(c, status, error);
    c->end = volume->raw ? raw_file(&info, volume->raw) : longest_file(&info, info.components);
    uint64_t one = volume->raw ? c->end : longest_file(&info, 1);
    if (c->limit < one) c->limit = one; /* a file may be larger than the volume made of it */
    return ISO_OK;
}

static iso_status fail_limit(const copier *c, iso_error *error) {
    return iso_fail(error, ISO_ERR_LIMIT, "%s: has more than %.0f MB, the memory limit (--max-memory)",
                    c->name, (double)c->limit / 1e6);
}

static iso_status copy_all(copier *c, iso_error *error) {
    const char *format = NULL;
    size_t count = 0;
    ISO_TRY(read_format(c, &count, &format, error));
    ISO_TRY(create_copy(c, error));
    ISO_TRY(read_block(c, BLOCK, &count, error));
    bool whole = count < BLOCK;
    ISO_TRY(write_block(c, count, error));
    if (!whole) ISO_TRY(check_header(c, format, error));
    while (!whole && c->copied < c->end) {
        uint64_t room = c->end - c->copied;
        count = 0;
        ISO_TRY(read_block(c, room < BLOCK ? (size_t)room : BLOCK, &count, error));
        if (count && c->copied + count > c->limit) return fail_limit(c, error);
        ISO_TRY(write_block(c, count, error));
        whole = count < BLOCK;
    }
    return ISO_OK;
}

static iso_status copy_input(copier *c, iso_error *error) {
    c->block = iso_alloc(BLOCK);
    if (!c->block) return iso_fail_memory(error, c->name);
    iso_status status = copy_all(c, error);
    iso_free(c->block);
    return status;
}

/* ---- the input ---- */

/* Returns whether standard input is a regular file that has not been read from yet; it then needs no copy. */
static bool reuse_file(const copier *c) {
    struct stat info;
    if (fstat(c->input, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size == 0) return false;
    if (lseek(c->input, 0, SEEK_CUR) != 0) return false;
    int copy = fcntl(c->input, F_DUPFD_CLOEXEC, 3);
    if (copy < 0) return false;
    *c->spool = (iso_spool){.path = name_of_descriptor(copy), .descriptor = copy};
    if (!c->spool->path) close(copy);
    return c->spool->path != NULL;
}

iso_status iso_spool_open(const char *path, const iso_spool_opts *opts, iso_spool *spool, iso_error *error) {
    *spool = (iso_spool){0};
    const bool standard = strcmp(path, "-") == 0;
    copier c = {.name = iso_spool_name(path),
                .opts = opts,
                .spool = spool,
                .end = UINT64_MAX,
                .limit = iso_memory_limit(opts->volume->max_memory)};
    c.input = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (c.input < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    iso_status status = standard && reuse_file(&c) ? ISO_OK : copy_input(&c, error);
    if (!standard) close(c.input);
    return status;
}
