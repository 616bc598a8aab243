/* file_set: a list of files with the identity of each; checks compare every output with all entries. */
#include "base/file_set.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "base/file_identity.h"

typedef struct iso_file_entry {
    dev_t device;  /* of the file or, if it does not exist, of its folder */
    ino_t inode;   /* likewise */
    char *missing; /* owned: name in the folder of a file that does not exist; NULL: the file exists */
    char *name;    /* owned: for messages */
    /* Of a file that exists: its size; when its content, and when anything of it changed, nanoseconds. The
     * second time cannot be set back. */
    uint64_t bytes, modified, changed;
    bool written;
} iso_file_entry;

/* stat of the folder that contains `path`. */
static bool stat_folder(const char *path, struct stat *info) {
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    bool found = folder && stat(folder, info) == 0;
    free(folder);
    return found;
}

static uint64_t nanoseconds(struct timespec time) {
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

/* Sets the identity of a file; false when it is not a regular file, and its folder does not exist, or without
 * memory (errno is ENOMEM then). */
static bool identify(const char *path, iso_file_entry *entry) {
    struct stat info;
    errno = 0;
    if (stat(path, &info) == 0) {
        entry->device = info.st_dev;
        entry->inode = info.st_ino;
        entry->bytes = info.st_size > 0 ? (uint64_t)info.st_size : 0;
        entry->modified = nanoseconds(info.st_mtim);
        entry->changed = nanoseconds(info.st_ctim);
        return S_ISREG(info.st_mode);
    }
    char *target = iso_file_follow(path); /* `path` may be a link to a file that does not exist */
    const char *slash = target ? strrchr(target, '/') : NULL;
    bool found = target && stat_folder(target, &info);
    if (found) {
        entry->device = info.st_dev;
        entry->inode = info.st_ino;
        entry->missing = strdup(slash ? slash + 1 : target);
    }
    free(target);
    return found && entry->missing;
}

static bool identify_descriptor(int descriptor, iso_file_entry *entry) {
    struct stat info;
    if (fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) return false;
    entry->device = info.st_dev;
    entry->inode = info.st_ino;
    return true;
}

static bool is_same_file(const iso_file_entry *a, const iso_file_entry *b) {
    if (a->device != b->device || a->inode != b->inode || !a->missing != !b->missing) return false;
    return !a->missing || strcmp(a->missing, b->missing) == 0;
}

/* Adds an entry, whose strings belong to the set from now on. */
static void add_entry(iso_file_set *set, iso_file_entry *entry, const char *name) {
    if (set->count == set->room) {
        size_t room = set->room ? 2 * set->room : 16;
        iso_file_entry *more = realloc(set->entries, room * sizeof *more);
        if (more) {
            set->entries = more;
            set->room = room;
        }
    }
    entry->name = strdup(name);
    if (entry->name && set->count < set->room) {
        set->entries[set->count++] = *entry;
        return;
    }
    set->incomplete = true;
    free(entry->missing);
    free(entry->name);
}

/* Adds a file that identify has looked at. */
static void add(iso_file_set *set, bool found, iso_file_entry *entry, const char *name) {
    if (found)
        add_entry(set, entry, name);
    else if (errno == ENOMEM)
        set->incomplete = true;
}

void iso_file_set_read_as(iso_file_set *set, const char *path, const char *name) {
    iso_file_entry entry = {.written = false};
    if (set) add(set, identify(path, &entry), &entry, name);
}

void iso_file_set_read(iso_file_set *set, const char *path) {
    iso_file_set_read_as(set, path, path);
}

void iso_file_set_write(iso_file_set *set, const char *path) {
    iso_file_entry entry = {.written = true};
    if (!set || !path) return;
    if (strcmp(path, "-") == 0) {
        if (identify_descriptor(STDOUT_FILENO, &entry)) add_entry(set, &entry, "standard output");
    } else {
        add(set, identify(path, &entry), &entry, path);
    }
}

static iso_status fail_pair(const iso_file_entry *output, const iso_file_entry *other, iso_error *error) {
    if (!other->written)
        return iso_fail(error, ISO_ERR_USAGE, "%s: an output would overwrite the input %s", output->name,
                        other->name);
    if (strcmp(output->name, other->name) == 0)
        return iso_fail(error, ISO_ERR_USAGE, "%s: two outputs have this name", output->name);
    return iso_fail(error, ISO_ERR_USAGE, "%s: is the same file as another output, %s", output->name,
                    other->name);
}

iso_status iso_file_set_check(const iso_file_set *set, iso_error *error) {
    for (size_t i = 0; i < set->count; i++)
        for (size_t j = 0; set->entries[i].written && j < set->count; j++) {
            const iso_file_entry *other = &set->entries[j];
            if (i != j && (!other->written || j < i) && is_same_file(&set->entries[i], other))
                return fail_pair(&set->entries[i], other, error);
        }
    if (set->incomplete) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the names of files");
    return ISO_OK;
}

uint64_t iso_file_set_read_bytes(const iso_file_set *set) {
    uint64_t bytes = 0;
    for (size_t i = 0; i < set->count; i++)
        if (!set->entries[i].written) bytes += set->entries[i].bytes;
    return bytes;
}

/* The checksum of a few blocks of a file, from its first to its last bytes; 0 if it cannot be read. */
static uint32_t checksum_of_blocks(const char *path) {
    enum { BLOCKS = 5, BLOCK = 4096 };
    uint8_t block[BLOCK];
    uint32_t crc = 0;
    uint64_t bytes = 0;
    int file;
    if (iso_file_descriptor(path, &file, &bytes, NULL) != ISO_OK) return 0;
    const uint64_t last = bytes > BLOCK ? bytes - BLOCK : 0;
    for (uint64_t i = 0; i < BLOCKS; i++) {
        const ssize_t read = pread(file, block, BLOCK, (off_t)(last / (BLOCKS - 1) * i));
        if (read < 0) break;
        crc = iso_crc32c(crc, block, (size_t)read);
    }
    close(file);
    return crc;
}

enum { SAMPLED_FILES = 8 }; /* of which blocks are read: there may be 100,000 */

/* Of more files, which another machine may list in another order, only the sizes count. */
uint64_t iso_file_set_content(const iso_file_set *set) {
    size_t count = 0;
    uint64_t sum = 0;
    for (size_t i = 0; i < set->count; i++) count += !set->entries[i].written;
    for (size_t i = 0; i < set->count; i++) {
        const iso_file_entry *entry = &set->entries[i];
        if (entry->written) continue;
        const uint64_t words[] = {entry->bytes, count <= SAMPLED_FILES ? checksum_of_blocks(entry->name) : 0};
        uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a, by words */
        for (size_t w = 0; w < sizeof words / sizeof *words; w++) hash = (hash ^ words[w]) * 0x100000001b3u;
        sum += hash;
    }
    return sum;
}

uint64_t iso_file_set_identity(const iso_file_set *set) {
    uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a, by words */
    size_t sampled = 0;
    for (size_t i = 0; i < set->count; i++) {
        const iso_file_entry *entry = &set->entries[i];
        if (entry->written) continue;
        const uint32_t blocks = sampled++ < SAMPLED_FILES ? checksum_of_blocks(entry->name) : 0;
        const uint64_t words[] = {entry->bytes, entry->modified, entry->changed, (uint64_t)entry->inode,
                                  blocks};
        for (size_t w = 0; w < sizeof words / sizeof *words; w++) hash = (hash ^ words[w]) * 0x100000001b3u;
    }
    return hash;
}

void iso_file_set_free(iso_file_set *set) {
    for (size_t i = 0; i < set->count; i++) {
        free(set->entries[i].missing);
        free(set->entries[i].name);
    }
    free(set->entries);
    *set = (iso_file_set){0};
}

uint64_t iso_hash(uint64_t hash, const void *bytes, size_t count) {
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < count; i++) hash = (hash ^ byte[i]) * 0x100000001b3u;
    return hash;
}
