/* fuzz: any bytes as a file of keys (.isokeys). The checksum at the end is put right before it is read, so
 * that the contents are tried. What is accepted must come back the same when it is written and read again,
 * and be the whole of a picture of one part; what is refused must be refused in one line that names the
 * file. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "io/key_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MEMORY = 1 << 24 };

/* A file without a name on disk that has these bytes; returns its descriptor and a path for it. */
static int open_memory(const uint8_t *data, size_t size, char path[64]) {
    const int descriptor = memfd_create("fuzz_keys", 0);
    if (descriptor < 0 || write(descriptor, data, size) != (ssize_t)size) abort();
    snprintf(path, 64, "/proc/self/fd/%d", descriptor);
    return descriptor;
}

static uint8_t *with_checksum(const uint8_t *data, size_t size) {
    uint8_t *bytes = malloc(size + 1);
    if (!bytes) abort();
    memcpy(bytes, data, size);
    if (size < 4) return bytes;
    const uint32_t crc = iso_crc32c(0, bytes, size - 4);
    for (int i = 0; i < 4; i++) bytes[size - 4 + (size_t)i] = (uint8_t)(crc >> 8 * i);
    return bytes;
}

static void check_same(const iso_key_file *a, const iso_key_file *b) {
    const size_t pixels = (size_t)a->keys.width * (size_t)a->keys.height;
    if (a->keys.width != b->keys.width || a->keys.height != b->keys.height) abort();
    if (a->part != b->part || a->parts != b->parts ||
        memcmp(&a->surface, &b->surface, sizeof a->surface) != 0 ||
        memcmp(&a->style, &b->style, sizeof a->style) != 0 ||
        memcmp(a->keys.keys, b->keys.keys, pixels * sizeof *a->keys.keys) != 0)
        abort();
    for (int i = 0; i < ISO_KEY_TEXTS; i++)
        if (!a->texts[i] != !b->texts[i] || (a->texts[i] && strcmp(a->texts[i], b->texts[i]) != 0)) abort();
}

static void write_and_read_back(const iso_key_file *file) {
    char path[] = "/tmp/fuzz_keys_XXXXXX";
    const int descriptor = mkstemp(path);
    iso_key_file again;
    if (descriptor < 0) abort();
    close(descriptor);
    if (iso_key_file_write(path, file, NULL) != ISO_OK) abort();
    if (iso_key_file_read(path, MEMORY, &again, NULL) != ISO_OK) abort();
    unlink(path);
    check_same(file, &again);
    iso_key_file_free(&again);
}

/* Merging a file with itself finds a part twice; alone it is complete only as part 1 of 1. */
static void merge(const char *path, const iso_key_file *file) {
    const char *const paths[] = {path, path};
    iso_key_file merged;
    if (iso_key_files_merge(paths, 2, MEMORY, NULL, &merged, NULL) != ISO_ERR_FORMAT) abort();
    const iso_status status = iso_key_files_merge(paths, 1, MEMORY, NULL, &merged, NULL);
    if ((status == ISO_OK) != (file->parts == 1)) abort();
    if (status == ISO_OK) iso_key_file_free(&merged);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    uint8_t *bytes = with_checksum(data, size);
    const int descriptor = open_memory(bytes, size, path);
    iso_key_file file;
    iso_error error = {0};
    const iso_status status = iso_key_file_read(path, MEMORY, &file, &error);
    if (status == ISO_OK) {
        write_and_read_back(&file);
        merge(path, &file);
        iso_key_file_free(&file);
    } else if (strncmp(error.text, path, strlen(path)) != 0 || strchr(error.text, '\n')) {
        abort();
    }
    free(bytes);
    close(descriptor);
    return 0;
}
