/* key_file: writes, reads and merges key images in files. */
#include "io/key_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "image/annotate.h"
#include "render/picture.h"
#include "render/pullpush/pyramid.h"

static const char MAGIC[8] = {'I', 'S', 'O', 'K', 'E', 'Y', 'S', '\n'};

enum {
    VERSION = 6,
    BUFFER_BYTES = 1 << 16,
    HEADER_MOST = 1 << 20, /* bytes */
    TEXT_NONE = -1,        /* the length of a text that is not there */
};

void iso_key_file_free(iso_key_file *file) {
    for (int i = 0; i < ISO_KEY_TEXTS; i++) free(file->texts[i]);
    iso_key_image_free(&file->keys);
    *file = (iso_key_file){0};
}

/* ---- numbers as bytes */

static void put_bits(unsigned char *to, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) to[i] = (unsigned char)(value >> 8 * i);
}

static uint64_t get_bits(const unsigned char *from, int bytes) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++) value |= (uint64_t)from[i] << 8 * i;
    return value;
}

/* ---- the header: one list of its numbers serves writing and reading */

/* The header in memory. Reading beyond its end sets `failed` and yields zeros. */
typedef struct header {
    unsigned char *bytes;
    size_t size, at;
    bool writes, failed;
} header;

static void pass_bits(header *h, void *value, int bytes) {
    uint64_t bits = 0;
    if (h->failed || h->size - h->at < (size_t)bytes) {
        h->failed = true;
        if (!h->writes) memset(value, 0, (size_t)bytes);
        return;
    }
    if (h->writes) {
        memcpy(&bits, value, (size_t)bytes); /* (little-endian machines only, as all of the library) */
        put_bits(h->bytes + h->at, bits, bytes);
    } else {
        bits = get_bits(h->bytes + h->at, bytes);
        memcpy(value, &bits, (size_t)bytes);
    }
    h->at += (size_t)bytes;
}

static void pass_ints(header *h, int32_t *values, int count) {
    for (int i = 0; i < count; i++) pass_bits(h, &values[i], 4);
}

static void pass_reals(header *h, double *values, int count) {
    for (int i = 0; i < count; i++) pass_bits(h, &values[i], 8);
}

static void pass_bytes(header *h, char *bytes, int count) {
    for (int i = 0; i < count; i++) pass_bits(h, &bytes[i], 1);
}

static void pass_vec3(header *h, iso_vec3 *v) {
    pass_reals(h, &v->x, 1);
    pass_reals(h, &v->y, 1);
    pass_reals(h, &v->z, 1);
}

static void pass_text(header *h, char **text) {
    int32_t length = h->writes && *text ? (int32_t)strlen(*text) : TEXT_NONE;
    pass_ints(h, &length, 1);
    if (length == TEXT_NONE || h->failed) return;
    if (length < 0 || (size_t)length > h->size - h->at) {
        h->failed = true;
        return;
    }
    if (h->writes) {
        memcpy(h->bytes + h->at, *text, (size_t)length);
    } else {
        *text = strndup((const char *)h->bytes + h->at, (size_t)length);
        h->failed |= !*text || strlen(*text) != (size_t)length;
    }
    h->at += (size_t)length;
}

static void pass_surface(header *h, iso_key_surface *surface) {
    pass_ints(h, surface->dims, 3);
    pass_ints(h, &surface->type, 1);
    pass_reals(h, &surface->scale, 1);
    pass_reals(h, &surface->offset, 1);
    pass_reals(h, surface->transform.spacing, 3);
    pass_reals(h, surface->transform.origin, 3);
    pass_reals(h, surface->transform.direction, 9);
    pass_reals(h, &surface->isovalue, 1);
    pass_bits(h, &surface->primitives, 8);
    pass_vec3(h, &surface->bounds.lo);
    pass_vec3(h, &surface->bounds.hi);
}

static void pass_style(header *h, iso_key_style *style) {
    int32_t *const flags[] = {
        &style->orthographic, &style->transparent, &style->scale_bar,  &style->orientation_marker,
        &style->anatomical,   &style->unit,        &style->world_unit, &style->caps,
        &style->color_bar,    &style->colormap};
    pass_ints(h, &style->width, 1);
    pass_ints(h, &style->height, 1);
    pass_ints(h, &style->samples, 1);
    pass_ints(h, &style->base.base, 1);
    pass_ints(h, &style->base.top, 1);
    pass_ints(h, &style->base.width, 1);
    pass_ints(h, &style->base.height, 1);
    pass_ints(h, &style->base.cull, 1);
    pass_vec3(h, &style->position);
    pass_vec3(h, &style->focal_point);
    pass_vec3(h, &style->view_up);
    pass_reals(h, &style->view_angle, 1);
    pass_reals(h, &style->parallel_scale, 1);
    pass_reals(h, &style->pixels_per_metre, 1);
    pass_ints(h, &style->method, 1);
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) pass_ints(h, flags[i], 1);
    pass_reals(h, &style->bar_low, 1);
    pass_reals(h, &style->bar_high, 1);
    pass_bytes(h, style->bar_title, sizeof style->bar_title);
    pass_reals(h, &style->font_size, 1);
    pass_bits(h, style->background, 4);
    pass_bits(h, style->color, 4);
}

static void pass_header(header *h, iso_key_file *file) {
    pass_ints(h, &file->part, 1);
    pass_ints(h, &file->parts, 1);
    pass_surface(h, &file->surface);
    pass_style(h, &file->style);
    for (int i = 0; i < ISO_KEY_TEXTS; i++) pass_text(h, &file->texts[i]);
}

/* ---- writing */

/* A file with a checksum of all bytes that have passed. */
typedef struct checked_file {
    const char *path;
    FILE *stream;
    uint32_t crc;
} checked_file;

/* Errors of writing are found by iso_sink_commit. */
static void write_bytes(checked_file *file, const void *bytes, size_t size) {
    fwrite(bytes, 1, size, file->stream);
    file->crc = iso_crc32c(file->crc, bytes, size);
}

static void write_uint32(checked_file *file, uint32_t value) {
    unsigned char bytes[4];
    put_bits(bytes, value, 4);
    write_bytes(file, bytes, sizeof bytes);
}

static void write_key_run(checked_file *file, const uint64_t *keys, size_t count) {
    unsigned char buffer[BUFFER_BYTES];
    const size_t most = sizeof buffer / 8;
    for (size_t done = 0; done < count; done += most) {
        const size_t now = count - done < most ? count - done : most;
        for (size_t i = 0; i < now; i++) put_bits(buffer + 8 * i, keys[done + i], 8);
        write_bytes(file, buffer, 8 * now);
    }
}

static void write_keys(checked_file *file, const iso_key_image *image) {
    const size_t total = (size_t)image->width * (size_t)image->height;
    for (size_t at = 0; at < total;) {
        size_t first = at;
        while (first < total && image->keys[first] == ISO_KEY_EMPTY) first++;
        size_t end = first;
        while (end < total && image->keys[end] != ISO_KEY_EMPTY) end++;
        write_uint32(file, (uint32_t)(first - at));
        write_uint32(file, (uint32_t)(end - first));
        write_key_run(file, image->keys + first, end - first);
        at = end;
    }
}

static iso_status write_file(checked_file *out, const iso_key_file *file, iso_error *error) {
    header h = {.bytes = malloc(HEADER_MOST), .size = HEADER_MOST, .writes = true};
    if (!h.bytes) return iso_fail_memory(error, out->path);
    iso_key_file copy = *file;
    pass_header(&h, &copy);
    if (h.failed) {
        free(h.bytes);
        return iso_fail(error, ISO_ERR_WRITE, "%s: the texts of the picture are too long", out->path);
    }
    write_bytes(out, MAGIC, sizeof MAGIC);
    write_uint32(out, VERSION);
    write_uint32(out, (uint32_t)h.at);
    write_bytes(out, h.bytes, h.at);
    free(h.bytes);
    write_keys(out, &file->keys);
    write_uint32(out, out->crc);
    return ISO_OK;
}

iso_status iso_key_file_write(const char *path, const iso_key_file *file, iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    checked_file out = {.path = path, .stream = sink.stream};
    const iso_status status = write_file(&out, file, error);
    if (status != ISO_OK) {
        iso_sink_abort(&sink);
        return status;
    }
    return iso_sink_commit(&sink, error);
}

/* ---- reading */

static iso_status read_bytes(checked_file *file, void *bytes, size_t size, iso_error *error) {
    if (fread(bytes, 1, size, file->stream) != size)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path,
                        ferror(file->stream) ? "an error of the file system" : "the file ends too early");
    file->crc = iso_crc32c(file->crc, bytes, size);
    return ISO_OK;
}

static iso_status read_uint32(checked_file *file, uint32_t *value, iso_error *error) {
    unsigned char bytes[4];
    ISO_TRY(read_bytes(file, bytes, sizeof bytes, error));
    *value = (uint32_t)get_bits(bytes, 4);
    return ISO_OK;
}

static iso_status fail_damaged(const checked_file *file, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: its numbers do not agree", file->path);
}

static bool all_finite(const double *values, int count) {
    for (int i = 0; i < count; i++)
        if (!isfinite(values[i])) return false;
    return true;
}

/* Sets `size` to that of the keys; false: there are none of such a picture. */
static bool find_key_size(const iso_key_style *style, int size[2]) {
    const iso_pullpush_base *base = &style->base;
    const int factor = iso_picture_factor(style->samples);
    const iso_view view = {.width = style->width * factor, .height = style->height * factor};
    size[0] = view.width;
    size[1] = view.height;
    if (style->caps) size[1] *= ISO_KEY_PLANES;
    if (style->method == ISO_METHOD_EXACT) return true;
    if (style->method != ISO_METHOD_PULLPUSH_BOX && style->method != ISO_METHOD_PULLPUSH) return false;
    if (base->base < 0 || base->base >= base->top || base->top > ISO_PYRAMID_TOP || base->cull < 0 ||
        base->cull > 1 || style->caps)
        return false;
    const iso_pyramid_layout layout = iso_pyramid_layout_of(&view, base->base, base->top);
    const iso_pyramid_level level = iso_pyramid_level_of(&layout, base->base);
    size[0] = level.width;
    size[1] = level.height;
    return base->width == level.width && base->height == level.height;
}

static bool is_sound_style(const iso_key_style *style) {
    const int32_t flags[] = {style->orthographic,       style->transparent, style->scale_bar,
                             style->orientation_marker, style->anatomical,  style->caps,
                             style->color_bar};
    const double *vectors[] = {&style->position.x, &style->focal_point.x, &style->view_up.x};
    bool sound = style->width >= 1 && style->height >= 1 && style->width <= ISO_IMAGE_MAX &&
                 style->height <= ISO_IMAGE_MAX && style->samples >= 1 &&
                 iso_picture_factor(style->samples) > 0;
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) sound &= flags[i] == 0 || flags[i] == 1;
    for (int i = 0; i < 3; i++) sound &= all_finite(vectors[i], 3);
    sound &= style->colormap >= 0 && style->colormap < ISO_COLORMAP_COUNT;
    sound &= isfinite(style->bar_low) && isfinite(style->bar_high) && style->font_size >= 0 &&
             style->font_size <= ISO_IMAGE_MAX && !style->bar_title[sizeof style->bar_title - 1];
    sound &= style->unit >= 0 && style->unit < ISO_UNITS;
    sound &= style->world_unit >= 0 && style->world_unit <= ISO_WORLD_UNIT_DEGREE;
    return sound && isfinite(style->view_angle) && isfinite(style->parallel_scale) &&
           isfinite(style->pixels_per_metre);
}

static bool is_sound(const iso_key_file *file) {
    const iso_key_surface *surface = &file->surface;
    bool sound = file->part >= 1 && file->part <= file->parts && file->parts <= ISO_KEY_PARTS &&
                 is_sound_style(&file->style);
    for (int axis = 0; axis < 3; axis++) sound &= surface->dims[axis] >= 1;
    return sound && surface->type >= ISO_UINT8 && surface->type <= ISO_FLOAT32;
}

static iso_status read_header(checked_file *in, iso_key_file *file, iso_error *error) {
    char magic[sizeof MAGIC];
    uint32_t version, size;
    if (read_bytes(in, magic, sizeof magic, NULL) != ISO_OK || memcmp(magic, MAGIC, sizeof MAGIC) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a file of keys (.isokeys)", in->path);
    ISO_TRY(read_uint32(in, &version, error));
    if (version != VERSION)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: version %u of .isokeys, this program reads version %d", in->path,
                        (unsigned)version, VERSION);
    ISO_TRY(read_uint32(in, &size, error));
    if (size > HEADER_MOST) return fail_damaged(in, error);
    header h = {.bytes = malloc(size ? size : 1), .size = size};
    if (!h.bytes) return iso_fail_memory(error, in->path);
    iso_status status = read_bytes(in, h.bytes, size, error);
    if (status == ISO_OK) {
        pass_header(&h, file);
        if (h.failed || h.at != h.size || !is_sound(file)) status = fail_damaged(in, error);
    }
    free(h.bytes);
    return status;
}

static iso_status read_key_run(checked_file *in, uint64_t *keys, size_t count, iso_error *error) {
    unsigned char buffer[BUFFER_BYTES];
    const size_t most = sizeof buffer / 8;
    for (size_t done = 0; done < count; done += most) {
        const size_t now = count - done < most ? count - done : most;
        ISO_TRY(read_bytes(in, buffer, 8 * now, error));
        for (size_t i = 0; i < now; i++) keys[done + i] = get_bits(buffer + 8 * i, 8);
    }
    return ISO_OK;
}

static iso_status read_keys(checked_file *in, iso_key_image *image, iso_error *error) {
    const size_t total = (size_t)image->width * (size_t)image->height;
    for (size_t at = 0; at < total;) {
        uint32_t empty, filled;
        ISO_TRY(read_uint32(in, &empty, error));
        ISO_TRY(read_uint32(in, &filled, error));
        const size_t count = (size_t)empty + filled;
        if (count == 0 || count > total - at) return fail_damaged(in, error);
        ISO_TRY(read_key_run(in, image->keys + at + empty, filled, error));
        at += count;
    }
    return ISO_OK;
}

static iso_status read_checksum(checked_file *in, iso_error *error) {
    const uint32_t crc = in->crc;
    uint32_t stored;
    ISO_TRY(read_uint32(in, &stored, error));
    if (stored != crc)
        return iso_fail(error, ISO_ERR_IO, "%s: damaged: its checksum does not match", in->path);
    if (fgetc(in->stream) != EOF)
        return iso_fail(error, ISO_ERR_IO, "%s: damaged: there are bytes behind its end", in->path);
    return ISO_OK;
}

static iso_status check_memory(const checked_file *in, const int size[2], uint64_t limit, iso_error *error) {
    const uint64_t bytes = (uint64_t)size[0] * (uint64_t)size[1] * sizeof(uint64_t);
    if (!limit || bytes <= limit) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT, "%s: %d x %d keys need %.0f MB, limit is %.0f MB (--max-memory)",
                    in->path, size[0], size[1], (double)bytes / 1e6, (double)limit / 1e6);
}

static iso_status read_file(checked_file *in, uint64_t max_memory, iso_key_file *file, iso_error *error) {
    ISO_TRY(read_header(in, file, error));
    int size[2];
    if (!find_key_size(&file->style, size)) return fail_damaged(in, error);
    ISO_TRY(check_memory(in, size, max_memory, error));
    ISO_TRY(iso_key_image_allocate(size[0], size[1], &file->keys, error));
    ISO_TRY(read_keys(in, &file->keys, error));
    return read_checksum(in, error);
}

iso_status iso_key_file_read(const char *path, uint64_t max_memory, iso_key_file *file, iso_error *error) {
    *file = (iso_key_file){0};
    checked_file in = {.path = path};
    ISO_TRY(iso_file_open(path, &in.stream, NULL, error));
    const iso_status status = read_file(&in, max_memory, file, error);
    fclose(in.stream);
    if (status != ISO_OK) iso_key_file_free(file);
    return status;
}

/* ---- merging */

static bool same_texts(const iso_key_file *a, const iso_key_file *b) {
    for (int i = 0; i < ISO_KEY_TEXTS; i++) {
        if (!a->texts[i] != !b->texts[i]) return false;
        if (a->texts[i] && strcmp(a->texts[i], b->texts[i]) != 0) return false;
    }
    return true;
}

/* ISO_ERR_FORMAT unless `file` is a part of the picture that the first file belongs to. */
static iso_status check_same(const char *path, const iso_key_file *file, const char *first_path,
                             const iso_key_file *first, iso_error *error) {
    const char *difference = NULL;
    if (memcmp(&file->surface, &first->surface, sizeof file->surface) != 0)
        difference = "of another surface";
    else if (memcmp(&file->style, &first->style, sizeof file->style) != 0)
        difference = "of another picture of the surface";
    else if (!same_texts(file, first))
        difference = "drawn with other options";
    else if (file->parts != first->parts)
        difference = "of another division into parts";
    if (!difference) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: part %d of %d is %s than %s", path, file->part, file->parts,
                    difference, first_path);
}

/* Which file has each part: by part, from 0; NULL: none yet. */
typedef struct part_list {
    const char **path;
    int missing;
} part_list;

static iso_status note_part(part_list *list, const char *path, const iso_key_file *file, iso_error *error) {
    const char **place = &list->path[file->part - 1];
    if (*place)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: part %d of %d is in %s already", path, file->part,
                        file->parts, *place);
    *place = path;
    list->missing--;
    return ISO_OK;
}

static iso_status check_complete(const part_list *list, const iso_key_file *merged, iso_error *error) {
    if (!list->missing) return ISO_OK;
    int part = 0;
    while (list->path[part]) part++;
    return iso_fail(error, ISO_ERR_FORMAT, "part %d of %d is missing (%d of them are)", part + 1,
                    merged->parts, list->missing);
}

/* The files to merge. */
typedef struct part_files {
    const char *const *paths;
    int count;
    uint64_t max_memory;
    iso_pool *pool;
} part_files;

static iso_status merge_others(const part_files *files, part_list *list, iso_key_file *merged,
                               iso_error *error) {
    for (int i = 1; i < files->count; i++) {
        iso_key_file file;
        ISO_TRY(iso_key_file_read(files->paths[i], files->max_memory, &file, error));
        iso_status status = check_same(files->paths[i], &file, files->paths[0], merged, error);
        if (status == ISO_OK) status = note_part(list, files->paths[i], &file, error);
        if (status == ISO_OK) iso_key_image_minimum(&merged->keys, &file.keys, files->pool);
        iso_key_file_free(&file);
        ISO_TRY(status);
    }
    ISO_TRY(check_complete(list, merged, error));
    if (merged->style.caps) iso_key_image_join_caps(&merged->keys, files->pool);
    merged->style.caps = 0;
    return ISO_OK;
}

iso_status iso_key_files_merge(const char *const *paths, int count, uint64_t max_memory, iso_pool *pool,
                               iso_key_file *merged, iso_error *error) {
    const part_files files = {paths, count, max_memory, pool};
    ISO_TRY(iso_key_file_read(paths[0], max_memory, merged, error));
    part_list list = {calloc((size_t)merged->parts, sizeof *list.path), merged->parts};
    iso_status status =
        list.path ? note_part(&list, paths[0], merged, error) : iso_fail_memory(error, paths[0]);
    if (status == ISO_OK) status = merge_others(&files, &list, merged, error);
    free(list.path);
    if (status != ISO_OK) iso_key_file_free(merged);
    return status;
}
