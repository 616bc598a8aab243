/* fuzz_zarr: any bytes as the files of a Zarr folder. The first byte chooses which ones: .zarray and a chunk
 * of version 2, zarr.json and a chunk or shard of version 3, .zattrs beside an array, or attributes.json and
 * a block of N5. Two bytes are the size of the metadata, which come next; the rest is the chunk. Whatever
 * happens must end in a volume or in one line. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/fuzz/read_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

/* The folder of this process. */
static const char *place(void) {
    static char path[200];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/fuzz_zarr.%ld", folder ? folder : "/tmp", (long)getpid());
    return path;
}

static void write_file(const char *name, const void *bytes, size_t count) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", place(), name);
    FILE *file = fopen(path, "wb");
    fuzz_check(file && fwrite(bytes, 1, count, file) == count, "no room for a file");
    fclose(file);
}

static void make_folders(void) {
    static const char *const folders[] = {"", "/0", "/0/0", "/c", "/c/0", "/c/0/0"};
    char path[256];
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        snprintf(path, sizeof path, "%s%s", place(), folders[i]);
        mkdir(path, 0700);
    }
}

/* The files that a choice writes, and all that may be there from the run before. */
static const char *const metadata_names[] = {".zarray", "zarr.json", ".zattrs", "attributes.json"};
static const char *const chunk_names[] = {"0.0.0", "c/0/0/0", "0/0.0.0", "0/0/0"};
static const char array[] =
    "{\"zarr_format\":2,\"shape\":[4,4,4],\"chunks\":[4,4,4],\"dtype\":\"|u1\",\"order\":"
    "\"C\",\"fill_value\":0,\"filters\":null,\"compressor\":{\"id\":\"zstd\"}}";
enum { KINDS = 4 };

static void remove_files(void) {
    char path[256];
    for (int i = 0; i < KINDS; i++) {
        snprintf(path, sizeof path, "%s/%s", place(), metadata_names[i]);
        remove(path);
        snprintf(path, sizeof path, "%s/%s", place(), chunk_names[i]);
        remove(path);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    if (count < 3) return 0;
    const int kind = bytes[0] % KINDS;
    size_t length = bytes[1] | (size_t)bytes[2] << 8;
    if (length > count - 3) length = count - 3;
    make_folders();
    write_file(metadata_names[kind], bytes + 3, length);
    write_file(chunk_names[kind], bytes + 3 + length, count - 3 - length);
    if (kind == 2) write_file("0/.zarray", array, sizeof array - 1);
    const iso_volume_opts opts = {.max_memory = 64 << 20};
    fuzz_read_volume(place(), &opts);
    remove_files();
    return 0;
}
