/* The cache of what servers have sent: a file for each part, whose name is a hash of what it is, which its
 * first lines state. What cannot be kept, or is damaged, is asked for again. */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "grids/volume/remote/remote.h"

enum { USUAL_MB = 1000, MOST_HEAD = 8192, NAME_ROOM = 128, SECONDS_IN_USE = 3600 };

/* The most bytes of the cache; 0: there is none. */
static uint64_t cache_limit(void) {
    const char *stated = getenv("ISO_REMOTE_CACHE");
    char *end;
    if (!stated || !*stated) return (uint64_t)USUAL_MB << 20;
    const unsigned long long mb = strtoull(stated, &end, 10);
    return *end || *stated == '-' || mb > 1u << 30 ? 0 : (uint64_t)mb << 20;
}

/* The folder of the cache, made if need be. False: there is none. */
static bool cache_folder(char folder[PATH_MAX]) {
    const char *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME"), *below = "";
    if (!base || *base != '/') {
        base = home;
        below = "/.cache";
    }
    if (!base || *base != '/' || cache_limit() == 0 ||
        snprintf(folder, PATH_MAX, "%s%s/isopoint/remote", base, below) >= PATH_MAX)
        return false;
    for (char *slash = folder + strlen(base); slash; slash = strchr(slash + 1, '/')) {
        if (slash == folder) continue;
        *slash = 0;
        const bool failed = mkdir(folder, 0700) != 0 && errno != EEXIST;
        *slash = '/';
        if (failed) return false;
    }
    return mkdir(folder, 0700) == 0 || errno == EEXIST;
}

/* The first line of an entry, which says what it is. */
static int describe(char line[MOST_HEAD], const char *url, const iso_remote_part *part) {
    const int length = snprintf(line, MOST_HEAD, "%s %d %" PRIu64 " %" PRIu64 "\n", url, (int)part->what,
                                part->what == ISO_REMOTE_BYTES ? part->offset : 0,
                                part->what == ISO_REMOTE_WHOLE ? 0 : part->size);
    return length < MOST_HEAD ? length : 0;
}

/* The path of an entry, by a hash of what describes it; false: it is not kept. */
static bool path_of(const char *folder, const char *line, int length, char path[PATH_MAX]) {
    uint64_t hash = 14695981039346656037u; /* FNV-1a */
    for (int i = 0; i < length; i++) hash = (hash ^ (unsigned char)line[i]) * 1099511628211u;
    return length > 0 && snprintf(path, PATH_MAX, "%s/%016" PRIx64 "%08x", folder, hash,
                                  (unsigned)iso_crc32c(0, line, (size_t)length)) < PATH_MAX;
}

/* Makes a new file in the cache, whose name `path` becomes; NULL: it cannot be. */
static FILE *open_new(const char *folder, char path[PATH_MAX]) {
    if (snprintf(path, PATH_MAX, "%s/new-XXXXXX", folder) >= PATH_MAX) return NULL;
    const int descriptor = mkostemp(path, O_CLOEXEC);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
    if (!file && descriptor >= 0) {
        close(descriptor);
        unlink(path);
    }
    return file;
}

/* Closes a new file, and gives it the name of an entry if it is whole. */
static void close_new(FILE *file, bool whole, const char *new_path, const char *path) {
    const bool failed = fclose(file) != 0 || !whole;
    if (failed || rename(new_path, path) != 0) unlink(new_path);
}

void iso_remote_cache_find(const char *url, const iso_remote_part *part, iso_remote_entry *entry) {
    char folder[PATH_MAX], path[PATH_MAX], wanted[MOST_HEAD], line[MOST_HEAD];
    unsigned checksum;
    unsigned long long count;
    *entry->mark = 0;
    const int length = describe(wanted, url, part);
    if (!cache_folder(folder) || !path_of(folder, wanted, length, path)) return;
    FILE *file;
    if (access(path, F_OK) != 0 || iso_file_open(path, &file, NULL, NULL) != ISO_OK) return;
    char mark[sizeof entry->mark];
    const bool ours = fgets(line, sizeof line, file) && strcmp(line, wanted) == 0 &&
                      fgets(mark, sizeof mark, file) && fgets(line, sizeof line, file) &&
                      sscanf(line, "%llu %x", &count, &checksum) == 2 && count <= SIZE_MAX / 4 &&
                      (part->what != ISO_REMOTE_WHOLE || count <= part->size);
    if (ours && iso_buffer_reserve(&entry->bytes, (size_t)count + 1, 0, NULL) == ISO_OK &&
        fread(entry->bytes.data, 1, (size_t)count + 1, file) == count &&
        iso_crc32c(0, entry->bytes.data, (size_t)count) == checksum) {
        mark[strcspn(mark, "\n")] = 0;
        memcpy(entry->mark, mark, sizeof mark);
        entry->count = (size_t)count;
        futimens(fileno(file), NULL); /* used now */
    }
    fclose(file);
}

/* ---- its size */

typedef struct kept_file {
    char name[NAME_ROOM];
    uint64_t bytes;
    struct timespec used;
} kept_file;

static int compare_used(const void *a, const void *b) {
    const struct timespec *x = &((const kept_file *)a)->used, *y = &((const kept_file *)b)->used;
    if (x->tv_sec != y->tv_sec) return x->tv_sec < y->tv_sec ? -1 : 1;
    return (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

/* Adds up the files of the cache and, if they have more than `most` bytes, removes those that were used
 * longest ago until a tenth is free, but no copies of whole files that were used within the last hour, which
 * may be read. Returns the bytes that are left. */
static uint64_t bound_cache(const char *path, uint64_t most) {
    iso_buffer files = {0};
    size_t count = 0;
    uint64_t bytes = 0;
    const time_t in_use = time(NULL) - SECONDS_IN_USE;
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        struct stat info;
        if (fstatat(dirfd(folder), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) || !S_ISREG(info.st_mode) ||
            strlen(entry->d_name) >= NAME_ROOM ||
            iso_buffer_reserve(&files, (count + 1) * sizeof(kept_file), count * sizeof(kept_file), NULL) !=
                ISO_OK)
            continue;
        kept_file *file = (kept_file *)files.data + count++;
        snprintf(file->name, sizeof file->name, "%s", entry->d_name);
        file->bytes = (uint64_t)info.st_size;
        file->used = info.st_mtim;
        bytes += file->bytes;
    }
    if (count && bytes > most) {
        const kept_file *file = files.data;
        qsort(files.data, count, sizeof *file, compare_used);
        for (; bytes > most - most / 10 && count > 0; count--, file++) {
            const bool may_be_open = strchr(file->name, '-') && file->used.tv_sec >= in_use; /* a copy */
            if (!may_be_open && unlinkat(dirfd(folder), file->name, 0) == 0) bytes -= file->bytes;
        }
    }
    if (folder) closedir(folder);
    iso_buffer_free(&files);
    return bytes;
}

/* Counts what was put into the cache, and bounds it. */
static void count_kept(const char *folder, uint64_t bytes) {
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    static uint64_t used = UINT64_MAX; /* bytes of the cache; UINT64_MAX: not known yet */
    const uint64_t limit = cache_limit();
    pthread_mutex_lock(&lock);
    if (used != UINT64_MAX) used += bytes;
    if (used > limit) used = bound_cache(folder, limit);
    pthread_mutex_unlock(&lock);
}

void iso_remote_cache_keep(const char *url, const iso_remote_part *part, const iso_remote_entry *entry) {
    const uint64_t limit = cache_limit();
    char folder[PATH_MAX], path[PATH_MAX], part_path[PATH_MAX], line[MOST_HEAD];
    const int length = describe(line, url, part);
    if (!*entry->mark || entry->count > limit / 4 || !cache_folder(folder) ||
        !path_of(folder, line, length, path))
        return;
    FILE *file = open_new(folder, part_path);
    if (!file) return;
    fprintf(file, "%s%s\n%zu %08x\n", line, entry->mark, entry->count,
            (unsigned)iso_crc32c(0, entry->bytes.data, entry->count));
    close_new(file, fwrite(entry->bytes.data, 1, entry->count, file) == entry->count, part_path, path);
    count_kept(folder, entry->count);
}

/* ---- copies of whole files */

/* The path of the file that describes a copy. */
static bool description_of(const iso_remote_copy *copy, char path[PATH_MAX]) {
    return snprintf(path, PATH_MAX, "%s.kept", copy->path) < PATH_MAX;
}

/* The folder and name of a copy: its name ends as that in the URL does, by which some readers know what it
 * is, and by which messages tell people. */
static bool place_copy(const char *url, char path[PATH_MAX]) {
    enum { MOST_NAME = 64 };
    char folder[PATH_MAX];
    if (!cache_folder(folder) || !path_of(folder, url, (int)strnlen(url, MOST_HEAD), path)) return false;
    const size_t end = strcspn(url, "?#"), begin = strlen(path);
    size_t from = end;
    while (from > 0 && url[from - 1] != '/' && end - from < MOST_NAME) from--;
    if (begin + 1 + end - from >= PATH_MAX) return false;
    sprintf(path + begin, "-%.*s", (int)(end - from), url + from);
    for (char *c = path + begin; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c)) *c = '_';
    return true;
}

bool iso_remote_copy_find(const char *url, iso_remote_copy *copy) {
    char description[PATH_MAX], line[MOST_HEAD];
    unsigned long long count;
    struct stat info;
    FILE *file;
    *copy = (iso_remote_copy){.is_there = false};
    if (!place_copy(url, copy->path)) return false;
    if (stat(copy->path, &info) != 0 || !description_of(copy, description) ||
        access(description, F_OK) != 0 || iso_file_open(description, &file, NULL, NULL) != ISO_OK)
        return true;
    const size_t length = strlen(url);
    if (fgets(line, sizeof line, file) && strncmp(line, url, length) == 0 && line[length] == '\n' &&
        fgets(copy->mark, sizeof copy->mark, file) && fgets(line, sizeof line, file) &&
        sscanf(line, "%llu", &count) == 1 && count == (uint64_t)info.st_size) {
        copy->is_there = true;
        copy->mark[strcspn(copy->mark, "\n")] = 0;
        utimensat(AT_FDCWD, copy->path, NULL, 0); /* used now */
        futimens(fileno(file), NULL);
    } else {
        *copy->mark = 0;
    }
    fclose(file);
    return true;
}

void iso_remote_copy_keep(const char *url, const iso_remote_copy *copy, const char *mark) {
    char folder[PATH_MAX], description[PATH_MAX], new_path[PATH_MAX];
    struct stat info;
    if (!cache_folder(folder) || stat(copy->path, &info) != 0 || !description_of(copy, description)) return;
    FILE *file = open_new(folder, new_path);
    if (!file) return;
    close_new(file, fprintf(file, "%s\n%s\n%llu\n", url, mark, (unsigned long long)info.st_size) > 0,
              new_path, description);
    count_kept(folder, (uint64_t)info.st_size);
}
