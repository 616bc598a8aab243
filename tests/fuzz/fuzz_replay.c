/* fuzz_replay: runs a fuzz target over the files and folders that are named, in the order of their names.
 * Exits with 0 when nothing crashed and there was something to run. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static int replay_file(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    fseek(file, 0, SEEK_END);
    long count = ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(count > 0 ? (size_t)count : 1);
    size_t got = bytes && count > 0 ? fread(bytes, 1, (size_t)count, file) : 0;
    fclose(file);
    if (bytes) LLVMFuzzerTestOneInput(bytes, got);
    free(bytes);
    return 1;
}

static int replay(const char *path) {
    struct stat status;
    if (stat(path, &status) != 0) {
        fprintf(stderr, "%s: cannot be read\n", path);
        exit(1);
    }
    if (!S_ISDIR(status.st_mode)) return replay_file(path);
    struct dirent **entries = NULL;
    int count = scandir(path, &entries, NULL, alphasort), done = 0;
    for (int i = 0; i < count; i++) {
        char name[4096];
        snprintf(name, sizeof name, "%s/%s", path, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.') done += replay(name);
        free(entries[i]);
    }
    free(entries);
    return done;
}

int main(int count, char **arguments) {
    int done = 0;
    for (int i = 1; i < count; i++) done += replay(arguments[i]);
    printf("%d files replayed\n", done);
    return done > 0 ? 0 : 1;
}
