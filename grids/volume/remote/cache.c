/* The cache of what servers have sent: a file for each part, whose name is a hash of what it is, which its
 * first lines state. What cannot be kept, or is damaged, is asked for again. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "grids/volume/remote/remote.h"

enum { USUAL_MB = 1000, MOST_HEAD = 8192 };

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

/* The path of an entry; false: it is not kept. */
static bool path_of(const char *folder, const char *line, int length, char path[PATH_MAX]) {
    uint64_t hash = 14695981039346656037u; /* FNV-1a */
    for (int i = 0; i < length; i++) hash = (hash ^ (unsigned char)line[i]) * 1099511628211u;
    return length > 0 && snprintf(path, PATH_MAX, "%s/%016" PRIx64 "%08x", folder, hash,
                                  (unsigned)iso_crc32c(0, line, (size_t)length)) < PATH_MAX;
}

void iso_remote_cache_find(const char *url, const iso_remote_part *part, iso_remote_entry *entry) {
    char folder[PATH_MAX], path[PATH_MAX], wanted[MOST_HEAD], line[MOST_HEAD];
    unsigned checksum;
    unsigned long long count;
    *entry->mark = 0;
    const int length = describe(wanted, url, part);
    if (!cache_folder(folder) || !path_of(folder, wanted, length, path)) return;
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "rb") : NULL;
    if (!file) {
        if (descriptor >= 0) close(descriptor);
        return;
    }
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
        futimens(descriptor, NULL); /* used now */
    }
    fclose(file);
}

/* ---- its size */

typedef struct kept_file {
    char name[32];
    uint64_t bytes;
    struct timespec used;
} kept_file;

static int compare_used(const void *a, const void *b) {
    const struct timespec *x = &((const kept_file *)a)->used, *y = &((const kept_file *)b)->used;
    if (x->tv_sec != y->tv_sec) return x->tv_sec < y->tv_sec ? -1 : 1;
    return (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

/* Adds up the files of the cache and, if they have more than `most` bytes, removes those that were used
 * longest ago until a tenth is free. Returns the bytes that are left. */
static uint64_t bound_cache(const char *path, uint64_t most) {
    iso_buffer files = {0};
    size_t count = 0;
    uint64_t bytes = 0;
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        struct stat info;
        if (fstatat(dirfd(folder), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) || !S_ISREG(info.st_mode) ||
            strlen(entry->d_name) >= sizeof((kept_file *)0)->name ||
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
        for (; bytes > most - most / 10 && count > 0; count--, file++)
            if (unlinkat(dirfd(folder), file->name, 0) == 0) bytes -= file->bytes;
    }
    if (folder) closedir(folder);
    iso_buffer_free(&files);
    return bytes;
}

void iso_remote_cache_keep(const char *url, const iso_remote_part *part, const iso_remote_entry *entry) {
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    static uint64_t used = UINT64_MAX; /* bytes of the cache; UINT64_MAX: not known yet */
    const uint64_t limit = cache_limit();
    char folder[PATH_MAX], path[PATH_MAX], part_path[PATH_MAX], line[MOST_HEAD];
    const int length = describe(line, url, part);
    if (!*entry->mark || entry->count > limit / 4 || !cache_folder(folder) ||
        !path_of(folder, line, length, path) ||
        snprintf(part_path, PATH_MAX, "%s/new-XXXXXX", folder) >= PATH_MAX)
        return;
    const int descriptor = mkostemp(part_path, O_CLOEXEC);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
    if (!file) {
        if (descriptor >= 0) {
            close(descriptor);
            unlink(part_path);
        }
        return;
    }
    fprintf(file, "%s%s\n%zu %08x\n", line, entry->mark, entry->count,
            (unsigned)iso_crc32c(0, entry->bytes.data, entry->count));
    const bool whole = fwrite(entry->bytes.data, 1, entry->count, file) == entry->count;
    const bool failed = fclose(file) != 0 || !whole;
    if (failed || rename(part_path, path) != 0) unlink(part_path);
    pthread_mutex_lock(&lock);
    if (used != UINT64_MAX) used += entry->count;
    if (used > limit) used = bound_cache(folder, limit);
    pthread_mutex_unlock(&lock);
}
