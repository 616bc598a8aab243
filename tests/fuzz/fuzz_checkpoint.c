/* fuzz: any bytes as a snapshot of a small field, and as a stamp, which holds snapshots. The checksum at the
 * end is put right before it is read, so that the contents are tried. What is accepted must be a clamped
 * distance field and come back the same when it is written and read again; what is refused must leave the
 * field as it was and be refused in one line that names the file. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/crc32c.h"
#include "sculpt/field/checkpoint.h"
#include "sculpt/session/session.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Bytes before a stamp's cells: dims, number of bytes that follow, voxel size, origin. */
enum { STAMP_HEAD = 48, STAMP_BYTES_AT = 12 };

static const iso_journal_start START = {
    .source = "ball", .voxel_size = 1, .dims = {32, 32, 16}, .origin = {-15.5, -15.5, -7.5}, .radius = 6};

static void check_field(const iso_hgrid *grid) {
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++)
                if (!(fabsf(iso_hgrid_at(grid, x, y, z)) <= grid->band)) abort();
}

/* A snapshot of what is there; malloc'ed. */
static char *put(const iso_hgrid *grid, const iso_field_items *items, size_t *size) {
    char *bytes = NULL;
    FILE *stream = open_memstream(&bytes, size);
    if (!stream) abort();
    iso_checkpoint_put(stream, grid, items);
    fclose(stream);
    return bytes;
}

static iso_hgrid *ball(void) {
    iso_hgrid *grid;
    if (iso_session_solid(&START, &grid, NULL) != ISO_OK) abort();
    return grid;
}

static void make_items(const iso_hgrid *grid, iso_field_items *items) {
    const size_t cells = (size_t)grid->cells[0] * (size_t)grid->cells[1] * (size_t)grid->cells[2];
    const iso_voxel_bits bits = {{1, 2, 3}};
    const iso_paint_item paint = {.voxel = {7, 7, 9}};
    if (iso_field_items_init(items, cells, NULL) != ISO_OK ||
        iso_cell_items_set(&items->of[ISO_ITEM_MASK], 1, &bits, NULL) != ISO_OK ||
        iso_cell_items_set(&items->of[ISO_ITEM_PAINT], 1, &paint, NULL) != ISO_OK)
        abort();
}

static void check_again(const iso_hgrid *grid, const iso_field_items *items) {
    iso_field_items other;
    iso_hgrid *copy = ball();
    make_items(copy, &other);
    size_t size, again;
    char *bytes = put(grid, items, &size);
    if (iso_checkpoint_get("again", (uint8_t *)bytes, size, copy, &other, NULL) != ISO_OK) abort();
    char *more = put(copy, &other, &again);
    if (again != size || memcmp(bytes, more, size) != 0) abort();
    free(bytes);
    free(more);
    iso_field_items_free(&other);
    iso_hgrid_destroy(copy);
}

static void read_snapshot(const uint8_t *bytes, size_t size) {
    iso_hgrid *grid = ball();
    iso_field_items items;
    iso_error error = {0};
    size_t before_size, after_size;
    make_items(grid, &items);
    char *before = put(grid, &items, &before_size);
    iso_status status = iso_checkpoint_get("the file", bytes, size, grid, &items, &error);
    check_field(grid);
    if (status == ISO_OK)
        check_again(grid, &items);
    else {
        char *after = put(grid, &items, &after_size);
        if (after_size != before_size || memcmp(before, after, after_size) != 0) abort();
        if (!strstr(error.text, "the file") || strchr(error.text, '\n')) abort();
        free(after);
    }
    free(before);
    iso_field_items_free(&items);
    iso_hgrid_destroy(grid);
}

/* ---- stamps */

static char *base64(const uint8_t *bytes, size_t size) {
    static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text = malloc((size + 2) / 3 * 4 + 1), *to = text;
    if (!text) abort();
    for (size_t i = 0; i < size; i += 3) {
        uint32_t three = (uint32_t)bytes[i] << 16;
        if (i + 1 < size) three |= (uint32_t)bytes[i + 1] << 8;
        if (i + 2 < size) three |= bytes[i + 2];
        for (int shift = 18; shift >= 0; shift -= 6) *to++ = DIGITS[three >> shift & 63];
    }
    if (size % 3 > 0) to[-1] = '=';
    if (size % 3 == 1) to[-2] = '=';
    *to = 0;
    return text;
}

/* A touch with it, beside the ball and in it. */
static void use(iso_stamp *stamp) {
    iso_session *session;
    const iso_session_opts opts = {0};
    iso_brush brush = {.tool = ISO_TOOL_ADD, .shape = ISO_SOLID_STAMP, .radius = 5, .symmetry = 1};
    const iso_sample sample = {.position = {4, 2, 1}, .normal = {1, 2, 3}, .pressure = 1};
    if (iso_session_create(ball(), &START, &opts, &session, NULL) != ISO_OK) abort();
    if (iso_session_set_stamp(session, iso_stamp_share(stamp), NULL) != ISO_OK) abort();
    for (int i = 0; i < 2; i++) {
        brush.tool = i ? ISO_TOOL_BLEND_CARVE : ISO_TOOL_ADD;
        if (iso_session_begin(session, &brush, &sample, NULL, NULL) != ISO_OK) abort();
        if (iso_session_end(session, NULL) != ISO_OK) abort();
        check_field(iso_session_grid(session));
    }
    iso_session_destroy(session);
}

static void read_stamp(const uint8_t *bytes, size_t size) {
    char *text = base64(bytes, size), *again;
    iso_stamp *stamp;
    iso_error error = {0};
    if (iso_stamp_parse("a stamp", text, &stamp, &error) == ISO_OK) {
        for (int i = 0; i < stamp->count; i++) check_field(stamp->level[i]);
        use(stamp);
        again = iso_stamp_text(stamp);
        if (!again) abort();
        iso_stamp_free(stamp);
        if (iso_stamp_parse("a stamp", again, &stamp, NULL) != ISO_OK) abort();
        free(again);
        iso_stamp_free(stamp);
    } else if (!error.text[0] || strchr(error.text, '\n'))
        abort();
    free(text);
}

/* The first byte says which; the checksum at the end (and the length that a stamp's head says) is put right.
 */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size < 5 || size > 1 << 20) return 0;
    const bool stamp = data[0] & 1;
    size--;
    const size_t head = stamp ? STAMP_HEAD : 0;
    if (size < head + sizeof(uint32_t)) return 0;
    uint8_t *bytes = malloc(size);
    if (!bytes) abort();
    memcpy(bytes, data + 1, size);
    const uint32_t crc = iso_crc32c(0, bytes + head, size - head - sizeof crc),
                   length = (uint32_t)(size - head);
    memcpy(bytes + size - sizeof crc, &crc, sizeof crc);
    if (stamp) memcpy(bytes + STAMP_BYTES_AT, &length, sizeof length);
    if (stamp)
        read_stamp(bytes, size);
    else
        read_snapshot(bytes, size);
    free(bytes);
    return 0;
}
