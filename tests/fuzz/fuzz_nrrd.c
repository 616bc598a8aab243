/* fuzz_nrrd: any bytes as the header of an NRRD file, which the first byte's lowest bit says to be whole or
 * cut off. What is understood must keep its own promises. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grids/volume/nrrd.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void check(int truth, const char *what) {
    if (truth) return;
    fprintf(stderr, "fuzz_nrrd: %s\n", what);
    abort();
}

static void check_header(const iso_nrrd_header *header, size_t count) {
    check(header->dim >= 1 && header->dim <= ISO_NRRD_AXES, "too many axes");
    check(header->space_dim <= ISO_NRRD_SPACE, "too many dimensions");
    for (unsigned i = 0; i < header->dim; i++) check(header->axis[i].size >= 1, "an axis without samples");
    check(memchr(header->name, 0, sizeof header->name) != NULL, "a name without an end");
    check(header->after <= count, "the array begins behind the file");
    bool several = header->place > ISO_NRRD_FILE;
    check(!several || header->file_dim <= header->dim, "files with too many axes");
    check(header->place != ISO_NRRD_PATTERN ||
              (header->step != 0 && (header->last - header->first) / header->step >= 0),
          "numbers that lead away");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    if (count < 1) return 0;
    char *text = malloc(count); /* its last byte is the one that the parser needs */
    check(text != NULL, "no memory");
    memcpy(text, bytes + 1, count - 1);
    iso_nrrd_header header;
    iso_error error = {0};
    iso_status status = iso_nrrd_header_parse("fuzz", text, count - 1, bytes[0] & 1, &header, &error);
    if (status == ISO_OK)
        check_header(&header, count - 1);
    else
        check(error.status == status && strncmp(error.text, "fuzz: ", 6) == 0, "a failure without a line");
    free(text);
    return 0;
}
