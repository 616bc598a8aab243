/* rewrite: writes a TIFF file again with changed values. A copy of the file is opened by libtiff for reading
 * and writing: strips and tiles without a change, tags and other images are as they were. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/temporary_file.h"
#include "grids/volume/tiff/tiff.h"

bool iso_tiff_can_rewrite(const iso_tiff_stack *stack) {
    return stack->files.count == 1 && stack->layout.samples == 1 && !stack->lossy && !stack->contiguous;
}

typedef struct rewriting {
    const char *path;
    iso_tiff_stack stack;
    iso_tiff_planes planes;
    iso_volume_info info;
    iso_tiff_file *from, *to;
    size_t size;       /* of a value, bytes */
    char *page;        /* the values of an image */
    char *block, *old; /* of a strip or tile */
    iso_row_changer *change;
    void *context;
} rewriting;

/* ---- an image */

/* A strip or tile: its number, the pixels of it that lie in the image, and the bytes of its rows. */
typedef struct piece {
    uint32_t number, x, y, width, height;
    size_t row_bytes;
} piece;

static iso_status read_piece(const rewriting *r, uint32_t page, const piece *p, char *block, tmsize_t *bytes,
                             iso_error *error) {
    TIFF *tiff = iso_tiff_handle(r->from);
    const tmsize_t room = (tmsize_t)r->stack.block_bytes;
    *bytes = TIFFIsTiled(tiff) ? TIFFReadEncodedTile(tiff, p->number, block, room)
                               : TIFFReadEncodedStrip(tiff, p->number, block, room);
    if (*bytes >= (tmsize_t)(p->row_bytes * p->height)) return ISO_OK;
    return iso_tiff_fail(r->from, page, "truncated or damaged", error);
}

/* Copies a piece's rows into the image's values, or from there. */
static void move_rows(const rewriting *r, const piece *p, char *block, bool into_page) {
    const size_t page_row = r->stack.layout.width * r->size, bytes = p->width * r->size;
    for (uint32_t y = 0; y < p->height; y++) {
        char *in_page = r->page + (p->y + y) * page_row + p->x * r->size,
             *in_block = block + y * p->row_bytes;
        memcpy(into_page ? in_page : in_block, into_page ? in_block : in_page, bytes);
    }
}

static iso_status load_piece(const rewriting *r, uint32_t page, const piece *p, iso_error *error) {
    tmsize_t bytes;
    ISO_TRY(read_piece(r, page, p, r->block, &bytes, error));
    move_rows(r, p, r->block, true);
    return ISO_OK;
}

static iso_status store_piece(const rewriting *r, uint32_t page, const piece *p, iso_error *error) {
    TIFF *tiff = iso_tiff_handle(r->to);
    tmsize_t bytes;
    ISO_TRY(read_piece(r, page, p, r->old, &bytes, error));
    memcpy(r->block, r->old, (size_t)bytes);
    move_rows(r, p, r->block, false);
    if (memcmp(r->block, r->old, (size_t)bytes) == 0) return ISO_OK;
    const tmsize_t put = TIFFIsTiled(tiff) ? TIFFWriteEncodedTile(tiff, p->number, r->block, bytes)
                                           : TIFFWriteEncodedStrip(tiff, p->number, r->block, bytes);
    return put == bytes ? ISO_OK : iso_tiff_fail(r->to, page, "cannot be written", error);
}

typedef iso_status visit_piece(const rewriting *r, uint32_t page, const piece *p, iso_error *error);

static iso_status visit_pieces(const rewriting *r, uint32_t page, visit_piece *visit, iso_error *error) {
    const iso_tiff_layout *layout = &r->stack.layout;
    uint32_t width = layout->width, height, number = 0;
    TIFF *tiff = iso_tiff_handle(r->from);
    iso_tiff_block_size(r->from, layout, &width, &height);
    uint32_t full = height; /* (tiles reach over the image's edge) */
    if (TIFFIsTiled(tiff)) TIFFGetField(tiff, TIFFTAG_TILELENGTH, &full);
    for (uint32_t y = 0; y < layout->height; y += full)
        for (uint32_t x = 0; x < layout->width; x += width) {
            piece p = {number++, x, y, layout->width - x, layout->height - y, width * r->size};
            if (p.width > width) p.width = width;
            if (p.height > height) p.height = height;
            ISO_TRY(visit(r, page, &p, error));
        }
    return ISO_OK;
}

static iso_status rewrite_slice(const rewriting *r, int z, iso_error *error) {
    const iso_tiff_image *image = &r->stack.images[r->planes.first + (uint64_t)z * r->planes.step];
    const size_t row_bytes = r->stack.layout.width * r->size;
    bool changed = false;
    ISO_TRY(iso_tiff_set_image(r->from, image, error));
    ISO_TRY(visit_pieces(r, image->page, load_piece, error));
    for (uint32_t y = 0; y < r->stack.layout.height; y++)
        changed |= r->change(r->context, (int)y, z, r->page + y * row_bytes);
    if (!changed) return ISO_OK;
    ISO_TRY(iso_tiff_set_image(r->to, image, error));
    ISO_TRY(visit_pieces(r, image->page, store_piece, error));
    return TIFFFlush(iso_tiff_handle(r->to)) ? ISO_OK
                                             : iso_tiff_fail(r->to, image->page, "cannot be written", error);
}

/* ---- the file */

static iso_status copy_file(const char *path, FILE *from, FILE *to, iso_error *error) {
    char block[1 << 16];
    size_t got;
    while ((got = fread(block, 1, sizeof block, from)) > 0) fwrite(block, 1, got, to);
    return ferror(from) ? iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno)) : ISO_OK;
}

/* Makes a copy without a name, which libtiff changes. */
static iso_status open_copy(rewriting *r, FILE **copy, iso_error *error) {
    FILE *file;
    uint64_t bytes;
    ISO_TRY(iso_file_open(r->path, &file, &bytes, error));
    const int descriptor = iso_temporary_file_create(bytes);
    iso_status status = ISO_OK;
    if (descriptor < 0)
        status = iso_fail(error, ISO_ERR_IO, "%s: no temporary file for a copy of it: %s", r->path,
                          strerror(-descriptor));
    else if (!(*copy = fdopen(descriptor, "r+b")))
        close(descriptor), status = iso_fail_memory(error, r->path);
    if (status == ISO_OK) status = copy_file(r->path, file, *copy, error);
    fclose(file);
    ISO_TRY(status);
    if (fflush(*copy) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: no room for a copy of it: %s", r->path, strerror(errno));
    const int own = dup(descriptor);
    /* libtiff begins to read where the descriptor is */
    return own < 0 || lseek(own, 0, SEEK_SET) != 0 ? iso_fail_memory(error, r->path)
                                                   : iso_tiff_open_to_change(r->path, own, &r->to, error);
}

static iso_status open_all(rewriting *r, const iso_volume_opts *opts, iso_error *error) {
    const uint64_t limit = iso_format_memory_limit(opts);
    ISO_TRY(iso_tiff_stack_open(r->path, opts, &r->stack, error));
    ISO_TRY(iso_tiff_planes_find(r->path, opts, &r->stack, &r->planes, &r->info, error));
    const iso_tiff_layout *layout = &r->stack.layout;
    r->size = iso_scalar_size(layout->scalar);
    r->page = iso_alloc((size_t)layout->width * layout->height * r->size);
    r->block = iso_alloc((size_t)r->stack.block_bytes);
    r->old = iso_alloc((size_t)r->stack.block_bytes);
    if (!r->page || !r->block || !r->old) return iso_fail_memory(error, r->path);
    return iso_tiff_open(r->path, limit, &r->from, error);
}

iso_status iso_tiff_rewrite(const char *path, const iso_volume_opts *opts, iso_row_changer *change,
                            void *context, FILE *stream, const iso_progress *progress, iso_error *error) {
    rewriting r = {.path = path,
                   .info = {.components = 1, .scale = 1, .transform = iso_transform_identity()},
                   .change = change,
                   .context = context};
    FILE *copy = NULL;
    iso_status status = open_all(&r, opts, error);
    if (status == ISO_OK) status = open_copy(&r, &copy, error);
    for (int z = 0; status == ISO_OK && z < r.info.dims[2]; z++) {
        status = iso_progress_tell(progress, path, (double)z / r.info.dims[2], error);
        if (status == ISO_OK) status = rewrite_slice(&r, z, error);
    }
    iso_tiff_close(r.from);
    iso_tiff_close(r.to);
    if (status == ISO_OK && fseeko(copy, 0, SEEK_SET) == 0) status = copy_file(path, copy, stream, error);
    if (copy) fclose(copy);
    iso_free(r.page);
    iso_free(r.block);
    iso_free(r.old);
    iso_tiff_stack_free(&r.stack);
    return status;
}
