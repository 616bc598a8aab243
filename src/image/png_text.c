/* Goes from chunk to chunk of a PNG file (PNG specification, sections 5.3 and 11.3.4). */
#include "image/image_file.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"

/* Longer chunks of text are passed over, bytes. */
enum { MOST_BYTES = 1 << 24 };

static uint32_t big_endian(const unsigned char *b) {
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

/* Moves `*at` behind the next 0 of a chunk that ends at `end`; false: there is none. */
static bool pass_string(const char **at, const char *end) {
    const char *zero = memchr(*at, 0, (size_t)(end - *at));
    if (zero) *at = zero + 1;
    return zero != NULL;
}

/* The text of a chunk's bytes, which end with a 0 that is not of the chunk, if it has the key; else NULL. */
static const char *find_text(const char *kind, const char *bytes, size_t count, const char *key) {
    const char *at = bytes, *end = bytes + count;
    if (!pass_string(&at, end) || strcmp(bytes, key) != 0) return NULL;
    if (strcmp(kind, "tEXt") == 0) return at;
    if (end - at < 2 || at[0]) return NULL; /* compressed */
    at += 2;
    return pass_string(&at, end) && pass_string(&at, end) ? at : NULL;
}

static iso_status fail_end(const char *path, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: PNG file ends too early", path);
}

/* Reads the chunk's content and sets *text if it is the one that is looked for. */
static iso_status read_chunk(FILE *stream, const char *path, const unsigned char *head, const char *key,
                             char **text, iso_error *error) {
    const size_t count = big_endian(head);
    char kind[5] = {0};
    unsigned char stated[4];
    memcpy(kind, head + 4, 4);
    char *bytes = malloc(count + 1);
    if (!bytes) return iso_fail_memory(error, path);
    bytes[count] = 0;
    iso_status status = ISO_OK;
    if (fread(bytes, 1, count, stream) != count || fread(stated, 4, 1, stream) != 1)
        status = fail_end(path, error);
    else if (crc32(crc32(0, head + 4, 4), (const unsigned char *)bytes, (uInt)count) != big_endian(stated))
        status = iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: a checksum of the PNG file is wrong", path);
    const char *found = status == ISO_OK ? find_text(kind, bytes, count, key) : NULL;
    if (found) {
        memmove(bytes, found, strlen(found) + 1);
        *text = bytes;
    } else
        free(bytes);
    return status;
}

static iso_status read_chunks(FILE *stream, const char *path, const char *key, char **text,
                              iso_error *error) {
    unsigned char head[8];
    if (fread(head, 8, 1, stream) != 1 || memcmp(head, "\x89PNG\r\n\x1a\n", 8) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: is no PNG", path);
    while (!*text) {
        if (fread(head, 8, 1, stream) != 1) return fail_end(path, error);
        const uint32_t count = big_endian(head);
        if (memcmp(head + 4, "IEND", 4) == 0)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: the PNG has no text \"%s\"", path, key);
        const bool is_text = memcmp(head + 4, "tEXt", 4) == 0 || memcmp(head + 4, "iTXt", 4) == 0;
        if (is_text && count <= MOST_BYTES)
            ISO_TRY(read_chunk(stream, path, head, key, text, error));
        else if (fseek(stream, (long)count + 4, SEEK_CUR))
            return fail_end(path, error);
    }
    return ISO_OK;
}

iso_status iso_png_read_text(const char *path, const char *key, char **text, iso_error *error) {
    FILE *stream;
    *text = NULL;
    ISO_TRY(iso_file_open(path, &stream, NULL, error));
    const iso_status status = read_chunks(stream, path, key, text, error);
    fclose(stream);
    return status;
}
