/* golden FOLDER TABLE OUTPUT        compares every result with the rows of TABLE
 * golden FOLDER TABLE --write       writes TABLE anew
 *
 * FOLDER is the source folder, OUTPUT a folder for the pictures whose rows differ. The environment variable
 * ISO_CPU chooses the instruction set; the table holds for all of them. */
#include "golden.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/cpu.h"

enum { ROWS = 2048, NAME = 96 };

typedef struct row {
    char name[NAME];
    uint64_t hash;
    bool seen;
} row;

struct golden_table {
    const char *output; /* NULL: the table is being written */
    row rows[ROWS];
    size_t count;
    size_t same, different;
};

uint64_t golden_hash(uint64_t hash, const void *data, size_t bytes) {
    const unsigned char *byte = data;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ byte[i]) * 0x100000001b3u;
    return hash;
}

void golden_check(iso_status status, const iso_error *error) {
    if (status == ISO_OK) return;
    fprintf(stderr, "golden: %s\n", error->text);
    exit(1);
}

static row *find_row(golden_table *table, const char *name) {
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(table->rows[i].name, name) == 0) return &table->rows[i];
    return NULL;
}

static void add_row(golden_table *table, const char *name, uint64_t hash) {
    if (table->count == ROWS || strlen(name) >= NAME || find_row(table, name)) {
        fprintf(stderr, "golden: row %s: named twice, too long a name or too many rows\n", name);
        exit(1);
    }
    row *added = &table->rows[table->count++];
    snprintf(added->name, sizeof added->name, "%s", name);
    added->hash = hash;
}

static void leave_picture(const golden_table *table, const char *name, const iso_image *picture) {
    char path[1024];
    mkdir(table->output, 0777);
    snprintf(path, sizeof path, "%s/%s.%s.png", table->output, name, iso_cpu_level_name(iso_cpu_best()));
    for (char *c = path + strlen(table->output) + 1; *c; c++)
        if (*c == '/' || *c == ' ') *c = '-';
    iso_error error = {0};
    golden_check(iso_png_write(path, picture, NULL, 0, &error), &error);
    printf("    its picture: %s\n", path);
}

void golden_row(golden_table *table, const char *name, uint64_t hash, const iso_image *picture) {
    if (!table->output) {
        add_row(table, name, hash);
        return;
    }
    row *expected = find_row(table, name);
    if (expected) expected->seen = true;
    if (expected && expected->hash == hash) {
        table->same++;
        return;
    }
    table->different++;
    char wanted[17] = "no row";
    if (expected) snprintf(wanted, sizeof wanted, "%016llx", (unsigned long long)expected->hash);
    printf("%s: expected %s, got %016llx\n", name, wanted, (unsigned long long)hash);
    if (picture) leave_picture(table, name, picture);
}

static void read_table(golden_table *table, const char *path) {
    FILE *file = fopen(path, "r");
    if (!file) {
        fprintf(stderr, "golden: %s cannot be read\n", path);
        exit(1);
    }
    char line[NAME + 32], name[NAME];
    unsigned long long hash;
    while (fgets(line, sizeof line, file)) {
        if (sscanf(line, "%16llx %95[^\n]", &hash, name) == 2) {
            add_row(table, name, hash);
        } else if (line[0] != '#') {
            fprintf(stderr, "golden: %s: not a row: %s", path, line);
            exit(1);
        }
    }
    fclose(file);
}

static void write_table(const golden_table *table, const char *path) {
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "golden: %s cannot be written\n", path);
        exit(1);
    }
    fprintf(file, "# Hashes of results, written by ./run golden. A change here must be wanted: say why.\n");
    for (size_t i = 0; i < table->count; i++)
        fprintf(file, "%016llx %s\n", (unsigned long long)table->rows[i].hash, table->rows[i].name);
    if (fclose(file)) {
        fprintf(stderr, "golden: %s cannot be written\n", path);
        exit(1);
    }
    printf("golden: %zu rows written to %s\n", table->count, path);
}

/* Returns the exit status. */
static int report(const golden_table *table, const char *path) {
    size_t missing = 0;
    for (size_t i = 0; i < table->count; i++) {
        if (table->rows[i].seen) continue;
        printf("%s: in %s, but nothing made it\n", table->rows[i].name, path);
        missing++;
    }
    printf("golden: %zu rows as expected, %zu differ, %zu were not made (%s)\n", table->same,
           table->different, missing, iso_cpu_level_name(iso_cpu_best()));
    return table->different + missing > 0 || table->same == 0;
}

int main(int argc, char **argv) {
    enum { SKIPPED = 77 }; /* for CTest */
    if (argc != 4) {
        fprintf(stderr, "usage: golden FOLDER TABLE OUTPUT|--write\n");
        return 2;
    }
    const char *wanted = getenv("ISO_CPU");
    if (wanted && strcmp(wanted, iso_cpu_level_name(iso_cpu_best())) != 0) {
        printf("golden: this machine has no %s: skipped\n", wanted);
        return SKIPPED;
    }
    bool writes = strcmp(argv[3], "--write") == 0;
    golden_table *table = calloc(1, sizeof *table);
    if (!table) return 1;
    table->output = writes ? NULL : argv[3];
    if (!writes) read_table(table, argv[2]);
    iso_error error = {0};
    iso_pool *pool = NULL;
    golden_check(iso_pool_create(2, &pool, &error), &error);
    golden_volumes(table, argv[1], pool);
    golden_strokes(table, argv[1], pool);
    iso_pool_destroy(pool);
    int status = 0;
    if (writes)
        write_table(table, argv[2]);
    else
        status = report(table, argv[2]);
    free(table);
    return status;
}
