/* Reads and writes checkpoint files: a head, for each cell its state or its packed brick (cell_pack.h), the
 * masks, the paint, and the CRC-32C of everything before it. A file is checked as a whole before the grid is
 * changed. */
#include "sculpt/field/checkpoint.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/thread.h"
#include "sculpt/field/cell_pack.h"
#include "sculpt/field/mask.h"
#include "sculpt/field/paint.h"

/* The head is followed, for each cell, by an int32: a negative state of an empty cell, or the size of the
 * packed brick that follows; then, for each of `masks` cells, by its number (uint32) and its iso_voxel_bits.
 * In files with paint (PAINTED) the number of painted cells (uint32) follows, and for each its number, the
 * size of its packed item (uint32 each) and the packed item; then the checksum. Little-endian, like all
 * supported machines. */
typedef struct file_head {
    char magic[8];
    int32_t dims[3];
    float band;
    uint32_t masks;
} file_head;

static const char MAGIC[8] = "isosnp2", PAINTED[8] = "isosnp3";
enum { MARK_BYTES = 6 }; /* which files of all versions begin with */
/* Bytes of a packed item of paint, at most. */
enum { PAINT_PACK_MAX = ISO_BRICK_VOXELS / 8 + sizeof(iso_paint_item) };

static file_head file_head_of(const iso_hgrid *grid, bool painted) {
    file_head h = {.band = grid->band};
    memcpy(h.magic, painted ? PAINTED : MAGIC, sizeof h.magic);
    for (int axis = 0; axis < 3; axis++) h.dims[axis] = grid->dims[axis];
    return h;
}

static void put_bytes(FILE *file, uint32_t *crc, const void *bytes, size_t size) {
    *crc = iso_crc32c(*crc, bytes, size);
    fwrite(bytes, 1, size, file); /* errors are found when the file is committed */
}

static void put_mask(FILE *file, uint32_t *crc, const iso_mask *mask) {
    for (size_t i = 0; mask->used && i < mask->cells; i++) {
        const uint32_t cell = (uint32_t)i;
        const iso_voxel_bits *bits = iso_mask_bits(mask, i);
        if (!bits) continue;
        put_bytes(file, crc, &cell, sizeof cell);
        put_bytes(file, crc, bits, sizeof *bits);
    }
}

static void put_paint(FILE *file, uint32_t *crc, const iso_cell_items *paint) {
    const uint32_t count = (uint32_t)paint->used;
    put_bytes(file, crc, &count, sizeof count);
    for (size_t i = 0; i < paint->cells; i++) {
        uint8_t packed[PAINT_PACK_MAX];
        const void *item = paint->cell[i];
        if (!item) continue;
        const uint32_t head[2] = {(uint32_t)i, (uint32_t)iso_item_pack_size(item, paint->bytes)};
        iso_item_pack(item, paint->bytes, packed);
        put_bytes(file, crc, head, sizeof head);
        put_bytes(file, crc, packed, head[1]);
    }
}

void iso_checkpoint_put(FILE *stream, const iso_hgrid *grid, const iso_field_items *items) {
    uint32_t crc = 0;
    const iso_mask *mask = &items->of[ISO_ITEM_MASK];
    const iso_cell_items *paint = &items->of[ISO_ITEM_PAINT];
    file_head h = file_head_of(grid, paint->used > 0);
    h.masks = (uint32_t)mask->used;
    put_bytes(stream, &crc, &h, sizeof h);
    for (size_t i = 0; i < iso_hgrid_cell_count(grid); i++) {
        uint8_t bytes[ISO_CELL_PACK_MAX];
        int32_t size = grid->cell[i];
        if (size >= 0) {
            const float *brick = iso_hgrid_brick(grid, grid->cell[i]);
            iso_cell_pack(brick, grid->band, bytes);
            size = (int32_t)iso_cell_pack_size(brick, grid->band);
        }
        put_bytes(stream, &crc, &size, sizeof size);
        if (size >= 0) put_bytes(stream, &crc, bytes, (size_t)size);
    }
    put_mask(stream, &crc, mask);
    if (paint->used) put_paint(stream, &crc, paint);
    fwrite(&crc, 1, sizeof crc, stream);
}

iso_status iso_checkpoint_write(const char *path, const iso_hgrid *grid, const iso_field_items *items,
                                iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open_own(path, MAGIC, MARK_BYTES, &sink, error));
    iso_checkpoint_put(sink.stream, grid, items);
    return iso_sink_commit(&sink, error);
}

/* ---- writing in a background thread */

struct iso_checkpoint {
    pthread_t thread;
    char *path;
    iso_snapshot *snapshot;
    iso_field_items items;
    bool written;
    atomic_bool done;
};

static iso_status write_snapshot(iso_checkpoint *checkpoint) {
    iso_hgrid *grid;
    ISO_TRY(iso_snapshot_copy(checkpoint->snapshot, NULL, &grid, NULL));
    iso_status status = iso_checkpoint_write(checkpoint->path, grid, &checkpoint->items, NULL);
    iso_hgrid_destroy(grid);
    return status;
}

static void *write_in_thread(void *context) {
    iso_checkpoint *checkpoint = context;
    checkpoint->written = write_snapshot(checkpoint) == ISO_OK;
    atomic_store(&checkpoint->done, true);
    return NULL;
}

static void free_checkpoint(iso_checkpoint *checkpoint) {
    iso_field_items_free(&checkpoint->items);
    iso_free(checkpoint->path);
    iso_free(checkpoint);
}

iso_status iso_checkpoint_start(const char *path, iso_snapshot *snapshot, const iso_field_items *items,
                                iso_checkpoint **out, iso_error *error) {
    iso_checkpoint *checkpoint = iso_alloc_zero(1, sizeof *checkpoint);
    if (!checkpoint) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a snapshot");
    const size_t size = strlen(path) + 1;
    checkpoint->snapshot = snapshot;
    checkpoint->path = iso_alloc(size);
    if (checkpoint->path) memcpy(checkpoint->path, path, size);
    iso_status status = checkpoint->path ? iso_field_items_copy(items, &checkpoint->items, error)
                                         : iso_fail(error, ISO_ERR_NOMEM, "out of memory for a snapshot");
    if (status == ISO_OK && iso_thread_start(&checkpoint->thread, write_in_thread, checkpoint))
        status = iso_fail(error, ISO_ERR_NOMEM, "no thread can be started for a snapshot");
    if (status == ISO_OK)
        *out = checkpoint;
    else
        free_checkpoint(checkpoint);
    return status;
}

bool iso_checkpoint_done(const iso_checkpoint *checkpoint) {
    return atomic_load(&checkpoint->done);
}

bool iso_checkpoint_finish(iso_checkpoint *checkpoint) {
    pthread_join(checkpoint->thread, NULL);
    const bool written = checkpoint->written;
    free_checkpoint(checkpoint);
    return written;
}

/* ---- reading: a file is checked as a whole before anything is written */

typedef struct file_reader {
    const char *path;
    const uint8_t *at, *end;
    uint32_t masks;
    bool painted;
} file_reader;

/* Returns the size of the largest possible checkpoint of a grid, in bytes. */
static uint64_t most_bytes(const iso_hgrid *grid) {
    const uint64_t each = sizeof(int32_t) + ISO_CELL_PACK_MAX + sizeof(uint32_t) + sizeof(iso_voxel_bits) +
                          2 * sizeof(uint32_t) + PAINT_PACK_MAX;
    return sizeof(file_head) + iso_hgrid_cell_count(grid) * each + 2 * sizeof(uint32_t);
}

/* Reads a whole file. A journal may name any file, so the size is checked first. */
static iso_status load_file(const char *path, const iso_hgrid *grid, iso_buffer *buffer, size_t *size,
                            iso_error *error) {
    FILE *file;
    uint64_t bytes;
    ISO_TRY(iso_file_open(path, &file, &bytes, error));
    iso_status status = bytes > most_bytes(grid)
                            ? iso_fail(error, ISO_ERR_FORMAT, "'%s' is a snapshot of another grid", path)
                            : iso_buffer_reserve(buffer, (size_t)bytes + 1, 0, error);
    if (status == ISO_OK) *size = fread(buffer->data, 1, (size_t)bytes, file);
    if (status == ISO_OK && ferror(file))
        status = iso_fail(error, ISO_ERR_IO, "cannot read '%s': %s", path, strerror(errno));
    fclose(file);
    return status;
}

/* Reads the next cell: sets *size to the state of an empty cell (negative), or to the size of the packed
 * brick, which begins at *bytes. Returns false if the file ends before, or the state is unknown. */
static bool read_cell(file_reader *r, int32_t *size, const uint8_t **bytes) {
    *size = ISO_CELL_OUTSIDE;
    *bytes = r->at;
    if (r->end - r->at < (ptrdiff_t)sizeof *size) return false;
    memcpy(size, r->at, sizeof *size);
    r->at += sizeof *size;
    *bytes = r->at;
    if (*size < 0) return *size >= ISO_CELL_INSIDE;
    if (r->end - r->at < *size) return false;
    r->at += *size;
    return true;
}

/* Reads the bits of the next cell with frozen voxels and returns the cell's number. masks_are_sound has
 * checked that the file contains them. */
static uint32_t read_mask(file_reader *r, iso_voxel_bits *bits) {
    uint32_t cell;
    memcpy(&cell, r->at, sizeof cell);
    memcpy(bits, r->at + sizeof cell, sizeof *bits);
    r->at += sizeof cell + sizeof *bits;
    return cell;
}

static bool masks_are_sound(file_reader *r, size_t cells) {
    iso_voxel_bits bits;
    const size_t each = sizeof(uint32_t) + sizeof bits;
    if ((size_t)(r->end - r->at) < r->masks * each) return false;
    for (uint32_t i = 0; i < r->masks; i++)
        if (read_mask(r, &bits) >= cells) return false;
    return true;
}

/* Reads a number. False: the file ends before. */
static bool read_number(file_reader *r, uint32_t *number) {
    if (r->end - r->at < (ptrdiff_t)sizeof *number) return false;
    memcpy(number, r->at, sizeof *number);
    r->at += sizeof *number;
    return true;
}

/* Reads the paint of the next cell. False: it is damaged, or of no cell. */
static bool read_paint(file_reader *r, size_t cells, uint32_t *cell, iso_paint_item *item) {
    uint32_t size;
    if (!read_number(r, cell) || !read_number(r, &size) || *cell >= cells || r->end - r->at < size)
        return false;
    r->at += size;
    return iso_item_unpack(r->at - size, size, sizeof *item, item);
}

static bool paint_is_sound(file_reader *r, size_t cells) {
    iso_paint_item item;
    uint32_t count = 0, cell;
    if (r->painted && !read_number(r, &count)) return false;
    for (uint32_t i = 0; i < count; i++)
        if (!read_paint(r, cells, &cell, &item)) return false;
    return r->at == r->end;
}

/* Whether all values are distances within the band; NaN is not. */
static bool brick_is_sound(const float *brick, float band) {
    bool sound = true;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) sound &= brick[i] >= -band && brick[i] <= band;
    return sound;
}

static iso_status check_cells(file_reader r, const iso_hgrid *grid, iso_error *error) {
    float brick[ISO_BRICK_VOXELS];
    for (size_t i = 0; i < iso_hgrid_cell_count(grid); i++) {
        int32_t size;
        const uint8_t *bytes;
        if (!read_cell(&r, &size, &bytes) ||
            (size >= 0 && (!iso_cell_unpack(bytes, (size_t)size, grid->band, brick) ||
                           !brick_is_sound(brick, grid->band))))
            return iso_fail(error, ISO_ERR_FORMAT, "'%s' is damaged", r.path);
    }
    const size_t cells = iso_hgrid_cell_count(grid);
    return masks_are_sound(&r, cells) && paint_is_sound(&r, cells)
               ? ISO_OK
               : iso_fail(error, ISO_ERR_FORMAT, "'%s' is damaged", r.path);
}

static iso_status fill_mask(file_reader *r, iso_mask *mask, iso_error *error) {
    iso_cell_items_clear(mask);
    for (uint32_t i = 0; i < r->masks; i++) {
        iso_voxel_bits bits;
        const uint32_t cell = read_mask(r, &bits);
        ISO_TRY(iso_cell_items_set(mask, cell, &bits, error));
    }
    return ISO_OK;
}

static iso_status fill_paint(file_reader *r, iso_cell_items *paint, iso_error *error) {
    iso_paint_item item;
    uint32_t count = 0, cell;
    iso_cell_items_clear(paint);
    if (r->painted) read_number(r, &count); /* paint_is_sound has checked what is read here */
    for (uint32_t i = 0; i < count; i++)
        if (read_paint(r, paint->cells, &cell, &item)) ISO_TRY(iso_cell_items_set(paint, cell, &item, error));
    return ISO_OK;
}

static iso_status fill_grid(file_reader r, iso_hgrid *grid, iso_field_items *items, iso_error *error) {
    const int lo[3] = {0, 0, 0}, hi[3] = {grid->dims[0] - 1, grid->dims[1] - 1, grid->dims[2] - 1};
    ISO_TRY(iso_hgrid_mark_changed(grid, lo, hi, error));
    for (size_t i = 0; i < iso_hgrid_cell_count(grid); i++) {
        const int at[3] = {(int)(i % (size_t)grid->cells[0]),
                           (int)(i / (size_t)grid->cells[0] % (size_t)grid->cells[1]),
                           (int)(i / (size_t)grid->cells[0] / (size_t)grid->cells[1])};
        int32_t size = ISO_CELL_OUTSIDE;
        const uint8_t *bytes = NULL;
        float *brick;
        if (!read_cell(&r, &size, &bytes) ||
            size < 0) { /* read_cell does not fail: check_cells has read all cells */
            iso_hgrid_coalesce(grid, at[0], at[1], at[2], size);
            continue;
        }
        ISO_TRY(iso_hgrid_split(grid, at[0], at[1], at[2], &brick, error));
        iso_cell_unpack(bytes, (size_t)size, grid->band, brick);
    }
    ISO_TRY(fill_mask(&r, &items->of[ISO_ITEM_MASK], error));
    return fill_paint(&r, &items->of[ISO_ITEM_PAINT], error);
}

iso_status iso_checkpoint_get(const char *path, const uint8_t *bytes, size_t size, iso_hgrid *grid,
                              iso_field_items *items, iso_error *error) {
    const bool painted = size >= sizeof PAINTED && memcmp(bytes, PAINTED, sizeof PAINTED) == 0;
    file_head expected = file_head_of(grid, painted);
    uint32_t crc;
    if (size < sizeof expected + sizeof crc || memcmp(bytes, expected.magic, sizeof expected.magic))
        return iso_fail(error, ISO_ERR_FORMAT, "'%s' is not a snapshot", path);
    memcpy(&crc, bytes + size - sizeof crc, sizeof crc);
    if (crc != iso_crc32c(0, bytes, size - sizeof crc))
        return iso_fail(error, ISO_ERR_FORMAT, "'%s' is damaged", path);
    memcpy(&expected.masks, bytes + offsetof(file_head, masks), sizeof expected.masks);
    if (memcmp(bytes, &expected, sizeof expected))
        return iso_fail(error, ISO_ERR_FORMAT, "'%s' is a snapshot of another grid", path);
    file_reader r = {path, bytes + sizeof expected, bytes + size - sizeof crc, expected.masks, painted};
    ISO_TRY(check_cells(r, grid, error));
    return fill_grid(r, grid, items, error);
}

iso_status iso_checkpoint_read(const char *path, iso_hgrid *grid, iso_field_items *items, iso_error *error) {
    iso_buffer buffer = {0};
    size_t size = 0;
    iso_status status = load_file(path, grid, &buffer, &size, error);
    if (status == ISO_OK) status = iso_checkpoint_get(path, buffer.data, size, grid, items, error);
    iso_buffer_free(&buffer);
    return status;
}
