/* png_pack: filters and deflates bands of rows in parallel with zlib. */
#include "image/png_pack.h"

#include <string.h>
#include <zlib.h>

#include "base/memory.h"

enum {
    BAND_BYTES = 1 << 17, /* bytes of a band, about: few enough that all threads have work, many enough that
                             starting deflate is cheap */
    SLACK = 64,           /* room for the stream's header, its checksum and the flush of deflate */
    FILTER_UP = 2         /* the number of the filter "Up" in PNG */
};

static int band_rows(const iso_png_packer *packer) {
    int rows = BAND_BYTES / (packer->image->width * packer->channels);
    return rows ? rows : 1;
}

static size_t row_bytes(const iso_png_packer *packer) {
    return 1 + (size_t)packer->image->width * (size_t)packer->channels;
}

static uint8_t index_of(const iso_png_packer *packer, const uint8_t rgba[4]) {
    return iso_png_palette_index(packer->palette, rgba);
}

/* a - b in each of eight bytes: the top bits are kept apart, so that nothing is borrowed across bytes. */
static uint64_t subtract_bytes(uint64_t a, uint64_t b) {
    const uint64_t top = 0x8080808080808080u;
    return ((a | top) - (b & ~top)) ^ ((a ^ ~b) & top);
}

/* Filters the colours of a row of RGBA pixels, two at a time; overwrites one byte behind the last. */
static void filter_colors(const uint8_t *row, const uint8_t *above, size_t width, uint8_t *out) {
    size_t x = 0;
    for (; x + 2 <= width; x += 2) {
        uint64_t here, there;
        memcpy(&here, row + 4 * x, sizeof here);
        memcpy(&there, above + 4 * x, sizeof there);
        uint32_t pixel[2];
        const uint64_t change = subtract_bytes(here, there);
        memcpy(pixel, &change, sizeof pixel);
        memcpy(out + 3 * x, &pixel[0], 4);
        memcpy(out + 3 * x + 3, &pixel[1], 4);
    }
    for (int c = 0; x < width && c < 3; c++)
        out[3 * x + (size_t)c] = (uint8_t)(row[4 * x + (size_t)c] - above[4 * x + (size_t)c]);
}

/* Filters a row with "Up": stores the difference from the row above. Smooth surfaces give small numbers, and
 * the background gives zeros. `out` has room for a row and a byte more. */
static void filter_row(const iso_png_packer *packer, int y, uint8_t *out) {
    size_t width = (size_t)packer->image->width;
    const uint8_t *row = packer->image->rgba + (size_t)y * width * 4, *above = row - width * 4;
    int channels = packer->channels;
    *out++ = FILTER_UP;
    if (channels == 1)
        for (size_t i = 0; i < 4 * width; i += 4)
            *out++ = (uint8_t)(index_of(packer, row + i) - (y > 0 ? index_of(packer, above + i) : 0));
    else if (channels == 3 && y > 0)
        filter_colors(row, above, width, out);
    else if (channels == 3)
        for (size_t x = 0; x < width; x++) memcpy(out + 3 * x, row + 4 * x, 3);
    else if (y > 0)
        for (size_t i = 0; i < 4 * width; i++) out[i] = (uint8_t)(row[i] - above[i]);
    else
        memcpy(out, row, 4 * width);
}

/* Filters and deflates rows first .. end - 1. `filtered` has the room that filter_row needs. Unless small
 * files are wanted, deflate uses level 1 with run lengths only: the filter does most of the compression, and
 * searching for matches would take longer than rendering. */
static bool deflate_rows(const iso_png_packer *packer, int first, int end, uint8_t *filtered,
                         iso_png_part *part) {
    z_stream z = {0};
    int level = packer->small ? Z_DEFAULT_COMPRESSION : 1,
        search = packer->small ? Z_DEFAULT_STRATEGY : Z_RLE;
    if (deflateInit2(&z, level, Z_DEFLATED, -MAX_WBITS, 8, search) != Z_OK) return false;
    size_t bytes = row_bytes(packer), room = deflateBound(&z, bytes * (size_t)(end - first)) + SLACK;
    part->bytes = iso_alloc(room);
    part->checksum = (uint32_t)adler32(0, NULL, 0);
    if (part->bytes && first == 0) memcpy(part->bytes, "\x78\x01", part->size = 2);
    z.next_out = part->bytes + part->size;
    z.avail_out = (uInt)(room - part->size);
    int code = part->bytes ? Z_OK : Z_MEM_ERROR;
    for (int y = first; y < end && code == Z_OK; y++) {
        filter_row(packer, y, filtered);
        part->checksum = (uint32_t)adler32(part->checksum, filtered, (uInt)bytes);
        z.next_in = filtered;
        z.avail_in = (uInt)bytes;
        bool last = y == packer->image->height - 1;
        code = deflate(&z, last ? Z_FINISH : y == end - 1 ? Z_SYNC_FLUSH : Z_NO_FLUSH);
    }
    part->size += z.total_out;
    deflateEnd(&z);
    return code == Z_OK || code == Z_STREAM_END;
}

static void pack_band(void *context, size_t index, int worker) {
    (void)worker;
    iso_png_packer *packer = context;
    int rows = band_rows(packer), first = packer->next_row + (int)index * rows;
    int left = packer->image->height - first;
    uint8_t *filtered = iso_alloc(row_bytes(packer) + 1);
    iso_png_part *part = &packer->parts[index];
    part->failed =
        !filtered || !deflate_rows(packer, first, first + (left < rows ? left : rows), filtered, part);
    iso_free(filtered);
}

/* Appends the checksum of the whole stream to the last part. */
static void end_stream(iso_png_packer *packer) {
    iso_png_part *last = &packer->parts[packer->part_count - 1];
    for (int shift = 24; shift >= 0; shift -= 8)
        last->bytes[last->size++] = (uint8_t)(packer->checksum >> shift);
}

static void free_parts(iso_png_packer *packer) {
    for (int i = 0; i < packer->part_count; i++) iso_free(packer->parts[i].bytes);
    memset(packer->parts, 0, sizeof packer->parts);
    packer->part_count = 0;
}

iso_status iso_png_pack(iso_png_packer *packer) {
    free_parts(packer);
    int height = packer->image->height, rows = band_rows(packer), left = height - packer->next_row;
    int bands = (left + rows - 1) / rows;
    packer->part_count = bands < ISO_PNG_ROUND ? bands : ISO_PNG_ROUND;
    if (packer->next_row == 0) packer->checksum = (uint32_t)adler32(0, NULL, 0);
    iso_parallel_for(packer->pool, (size_t)packer->part_count, pack_band, packer);
    for (int i = 0; i < packer->part_count; i++) {
        if (packer->parts[i].failed) return ISO_ERR_NOMEM;
        int count = height - packer->next_row < rows ? height - packer->next_row : rows;
        size_t bytes = row_bytes(packer) * (size_t)count;
        packer->checksum =
            (uint32_t)adler32_combine(packer->checksum, packer->parts[i].checksum, (z_off_t)bytes);
        packer->next_row += count;
    }
    if (packer->part_count && packer->next_row == height) end_stream(packer);
    return ISO_OK;
}

void iso_png_packer_free(iso_png_packer *packer) {
    free_parts(packer);
}
