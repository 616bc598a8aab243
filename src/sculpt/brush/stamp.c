/* Makes stamps from meshes, as distance fields (grids/level_set.h), and writes and reads stamps as base 64
 * text (RFC 4648). */
#include "sculpt/brush/stamp.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/level_set.h"
#include "sculpt/field/checkpoint.h"
#include "sculpt/limits.h"

/* Voxels of room around the mesh: 3 for the band and 1 more. */
enum { MARGIN = 4 };

/* ---- creation and destruction */

static iso_stamp *allocate_stamp(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    iso_stamp *stamp = iso_alloc_zero(1, sizeof *stamp);
    if (!stamp) return NULL;
    snprintf(stamp->name, sizeof stamp->name, "%s", name);
    for (char *c = stamp->name; *c; c++) /* journals contain the name, and ASCII is valid in every encoding */
        if (*c < ' ' || *c > '~') *c = '_';
    stamp->owners = 1;
    return stamp;
}

iso_stamp *iso_stamp_share(iso_stamp *stamp) {
    if (stamp) __atomic_add_fetch(&stamp->owners, 1, __ATOMIC_RELAXED);
    return stamp;
}

void iso_stamp_free(iso_stamp *stamp) {
    if (!stamp || __atomic_sub_fetch(&stamp->owners, 1, __ATOMIC_ACQ_REL)) return;
    for (int i = 0; i < stamp->count; i++) iso_hgrid_destroy(stamp->level[i]);
    iso_free(stamp->heights.value);
    iso_voxel_set_free(&stamp->voxels);
    iso_free(stamp);
}

const iso_hgrid *iso_stamp_level(const iso_stamp *stamp, double radius_voxels) {
    int level = stamp->count - 1;
    while (level > 0 && stamp->level[level]->transform.spacing[0] * radius_voxels < 1) level--;
    return stamp->level[level];
}

/* ---- from a mesh */

/* Makes the distance fields of all levels, with transforms in the mesh's millimetres. A level is left out if
 * nothing is inside, because its voxels are too large for thin parts. */
static iso_status make_levels(const char *path, const iso_closed_mesh *mesh, iso_sampling sampling,
                              iso_stamp *stamp, iso_error *error) {
    const iso_progress *progress = sampling.progress;
    const double longest = sampling.voxel;
    iso_status status = ISO_OK;
    for (int i = 0; i < ISO_STAMP_LEVELS; i++) {
        const iso_progress part =
            iso_progress_part(progress, (double)i / ISO_STAMP_LEVELS, (i + 1.0) / ISO_STAMP_LEVELS);
        sampling.progress = &part;
        sampling.voxel = longest / (ISO_STAMP_FIRST << i);
        status = iso_level_set_from_mesh(path, mesh, &sampling, &stamp->level[stamp->count], error);
        stamp->count += status == ISO_OK;
        if (status != ISO_OK && status != ISO_ERR_EMPTY) return status;
    }
    return status;
}

/* Changes the transforms of the levels so that the mesh's longest side goes from -1 to 1. The distances are
 * in voxels and do not change. */
static void normalise(iso_stamp *stamp, const double middle[3], double longest) {
    for (int i = 0; i < stamp->count; i++) {
        iso_transform *transform = &stamp->level[i]->transform;
        for (int axis = 0; axis < 3; axis++) {
            transform->origin[axis] = (transform->origin[axis] - middle[axis]) * 2 / longest;
            transform->spacing[axis] *= 2 / longest;
        }
    }
}

iso_status iso_stamp_from_mesh(const char *path, const iso_closed_mesh *mesh, iso_pool *pool,
                               const iso_progress *progress, iso_stamp **out, iso_error *error) {
    const iso_box box = iso_closed_mesh_box(mesh);
    const double middle[3] = {0.5 * (box.lo.x + box.hi.x), 0.5 * (box.lo.y + box.hi.y),
                              0.5 * (box.lo.z + box.hi.z)};
    const double longest = fmax(box.hi.x - box.lo.x, fmax(box.hi.y - box.lo.y, box.hi.z - box.lo.z));
    const iso_sampling sampling = {longest, MARGIN, pool, progress};
    iso_stamp *stamp = allocate_stamp(path);
    if (!stamp) return iso_fail_memory(error, path);
    iso_status status = make_levels(path, mesh, sampling, stamp, error);
    normalise(stamp, middle, longest);
    if (status == ISO_OK)
        *out = stamp;
    else
        iso_stamp_free(stamp);
    return status;
}

/* ---- from a picture */

/* The mean of the pixels of a square of `side` that are in the picture, rounded. */
static uint16_t mean_of_square(const uint16_t *values, int width, int height, const int at[2], int side) {
    uint64_t sum = 0, count = 0;
    for (int y = at[1]; y < at[1] + side && y < height; y++)
        for (int x = at[0]; x < at[0] + side && x < width; x++) {
            sum += values[(size_t)y * (size_t)width + (size_t)x];
            count++;
        }
    return (uint16_t)((sum + count / 2) / count);
}

iso_status iso_stamp_from_picture(const char *path, int width, int height, const uint16_t *values,
                                  iso_stamp **out, iso_error *error) {
    const int longest = width > height ? width : height,
              side = (longest + ISO_HEIGHTS_MOST - 1) / ISO_HEIGHTS_MOST;
    iso_stamp *stamp = allocate_stamp(path);
    if (stamp) {
        iso_heights *h = &stamp->heights;
        h->width = (width + side - 1) / side;
        h->height = (height + side - 1) / side;
        h->value = iso_alloc_zero((size_t)(h->width + 2) * (size_t)(h->height + 2), sizeof *h->value);
    }
    if (!stamp || !stamp->heights.value) {
        iso_stamp_free(stamp);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stamp");
    }
    const iso_heights *h = &stamp->heights;
    for (int y = 0; y < h->height; y++)
        for (int x = 0; x < h->width; x++)
            h->value[(y + 1) * (h->width + 2) + x + 1] =
                (float)mean_of_square(values, width, height, (const int[]){x * side, y * side}, side) / 65535;
    *out = stamp;
    return ISO_OK;
}

/* ---- bytes of a stamp: for each level a level_head, then its cells in the format of checkpoint files */

typedef struct level_head {
    int32_t dims[3];
    uint32_t bytes; /* size of the cells that follow */
    double spacing, origin[3];
} level_head;

static iso_status put_level(FILE *stream, const iso_hgrid *grid) {
    char *bytes = NULL;
    size_t size = 0;
    const iso_field_items none = {.of = {{.cells = 0}}};
    FILE *cells = open_memstream(&bytes, &size);
    if (!cells) return ISO_ERR_NOMEM;
    iso_checkpoint_put(cells, grid, &none);
    bool whole = iso_memory_stream_close(cells, &bytes) && size < UINT32_MAX;
    level_head head = {.bytes = (uint32_t)size, .spacing = grid->transform.spacing[0]};
    memcpy(head.dims, grid->dims, sizeof head.dims);
    memcpy(head.origin, grid->transform.origin, sizeof head.origin);
    whole = whole && fwrite(&head, sizeof head, 1, stream) == 1 && fwrite(bytes, 1, size, stream) == size;
    free(bytes);
    return whole ? ISO_OK : ISO_ERR_NOMEM;
}

static iso_status get_cells(const uint8_t *bytes, size_t size, iso_hgrid *grid, iso_error *error) {
    iso_field_items none;
    ISO_TRY(iso_field_items_init(&none, iso_hgrid_cell_count(grid), error));
    iso_status status = iso_checkpoint_get("the stamp", bytes, size, grid, &none, error);
    iso_field_items_free(&none);
    return status;
}

static iso_status get_level(const uint8_t **at, const uint8_t *end, iso_hgrid **out, iso_error *error) {
    level_head head;
    iso_transform transform = iso_transform_identity();
    if ((size_t)(end - *at) < sizeof head) return iso_fail(error, ISO_ERR_FORMAT, "the stamp is damaged");
    memcpy(&head, *at, sizeof head);
    *at += sizeof head;
    const int dims[3] = {head.dims[0], head.dims[1], head.dims[2]};
    ISO_TRY(iso_limit_check(ISO_LIMIT_STAMP_SPACING, head.spacing, 1, error));
    for (int axis = 0; axis < 3; axis++) {
        transform.spacing[axis] = head.spacing;
        transform.origin[axis] = head.origin[axis];
        ISO_TRY(iso_limit_check(ISO_LIMIT_STAMP_DIMS, dims[axis], 1, error));
        ISO_TRY(iso_limit_check(ISO_LIMIT_STAMP_ORIGIN, head.origin[axis], 1, error));
    }
    if ((size_t)(end - *at) < head.bytes) return iso_fail(error, ISO_ERR_FORMAT, "the stamp is damaged");
    iso_hgrid *grid;
    ISO_TRY(iso_hgrid_create(dims, 0, &transform, &grid, error));
    iso_status status = get_cells(*at, head.bytes, grid, error);
    *at += head.bytes;
    if (status == ISO_OK)
        *out = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}

/* ---- bytes as text */

static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

static char *encode(const uint8_t *bytes, size_t size) {
    char *text = malloc((size + 2) / 3 * 4 + 1), *to = text;
    if (!text) return NULL;
    for (size_t i = 0; i < size; i += 3) {
        uint32_t three = (uint32_t)bytes[i] << 16;
        if (i + 1 < size) three |= (uint32_t)bytes[i + 1] << 8;
        if (i + 2 < size) three |= bytes[i + 2];
        *to++ = DIGITS[three >> 18];
        *to++ = DIGITS[three >> 12 & 63];
        *to++ = i + 1 < size ? DIGITS[three >> 6 & 63] : '=';
        *to++ = i + 2 < size ? DIGITS[three & 63] : '=';
    }
    *to = 0;
    return text;
}

/* Returns the decoded bytes, malloc'ed, and sets *size to their number. NULL: the text is not base 64, or
 * there is no memory. */
static uint8_t *decode(const char *text, size_t *size) {
    uint8_t value[256];
    memset(value, 255, sizeof value);
    for (int i = 0; i < 64; i++) value[(unsigned char)DIGITS[i]] = (uint8_t)i;
    size_t length = strlen(text);
    if (length % 4) return NULL;
    while (length && text[length - 1] == '=') length--;
    uint8_t *bytes = malloc(length / 4 * 3 + 3), *to = bytes;
    uint32_t held = 0;
    int bits = 0;
    bool sound = bytes != NULL;
    for (size_t i = 0; sound && i < length; i++) {
        const uint8_t digit = value[(unsigned char)text[i]];
        sound = digit < 64;
        held = held << 6 | digit;
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        *to++ = (uint8_t)(held >> bits);
    }
    *size = (size_t)(to - bytes);
    if (sound) return bytes;
    free(bytes);
    return NULL;
}

/* The values of a picture, two bytes each, the lower first. */
static char *picture_text(const iso_heights *h) {
    const size_t count = (size_t)h->width * (size_t)h->height;
    uint8_t *bytes = malloc(2 * count);
    if (!bytes) return NULL;
    for (size_t i = 0; i < count; i++) {
        const size_t row = i / (size_t)h->width + 1, column = i % (size_t)h->width + 1;
        const unsigned value = (unsigned)rintf(h->value[row * ((size_t)h->width + 2) + column] * 65535);
        bytes[2 * i] = (uint8_t)value;
        bytes[2 * i + 1] = (uint8_t)(value >> 8);
    }
    char *text = encode(bytes, 2 * count);
    free(bytes);
    return text;
}

iso_status iso_stamp_parse_picture(const char *name, int width, int height, const char *text,
                                   iso_stamp **stamp, iso_error *error) {
    size_t size;
    uint8_t *bytes = decode(text, &size);
    const size_t count = (size_t)width * (size_t)height;
    uint16_t *values = bytes && size == 2 * count ? malloc(size) : NULL;
    for (size_t i = 0; values && i < count; i++) values[i] = (uint16_t)(bytes[2 * i] | bytes[2 * i + 1] << 8);
    const iso_status status = values ? iso_stamp_from_picture(name, width, height, values, stamp, error)
                                     : iso_fail(error, ISO_ERR_FORMAT, "the stamp is damaged");
    free(values);
    free(bytes);
    return status;
}

iso_status iso_stamp_from_voxels(const char *name, const iso_voxel_set *set, iso_stamp **out,
                                 iso_error *error) {
    iso_voxel_set taken = *set;
    iso_stamp *stamp = allocate_stamp(name);
    if (!stamp) {
        iso_voxel_set_free(&taken);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stamp");
    }
    stamp->voxels = taken;
    *out = stamp;
    return ISO_OK;
}

iso_status iso_stamp_parse_voxels(const char *name, const iso_voxel_set *frame, const char *text,
                                  iso_stamp **stamp, iso_error *error) {
    iso_voxel_set set = *frame;
    ISO_TRY(iso_voxel_set_init(&set, error));
    size_t size;
    uint8_t *bytes = decode(text, &size);
    const bool sound = bytes && iso_voxel_set_unpack(bytes, size, &set);
    free(bytes);
    if (sound) return iso_stamp_from_voxels(name, &set, stamp, error);
    iso_voxel_set_free(&set);
    return iso_fail(error, ISO_ERR_FORMAT, "the stamp is damaged");
}

static char *voxels_text(const iso_voxel_set *set) {
    size_t size;
    uint8_t *bytes = iso_voxel_set_pack(set, &size);
    char *text = bytes ? encode(bytes, size) : NULL;
    free(bytes);
    return text;
}

char *iso_stamp_text(const iso_stamp *stamp) {
    if (stamp->voxels.word) return voxels_text(&stamp->voxels);
    if (stamp->heights.value) return picture_text(&stamp->heights);
    char *bytes = NULL, *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&bytes, &size);
    if (!stream) return NULL;
    iso_status status = ISO_OK;
    for (int i = 0; i < stamp->count && status == ISO_OK; i++) status = put_level(stream, stamp->level[i]);
    if (iso_memory_stream_close(stream, &bytes) && status == ISO_OK)
        text = encode((const uint8_t *)bytes, size);
    free(bytes);
    return text;
}

static iso_status get_levels(const uint8_t *bytes, size_t size, iso_stamp *stamp, iso_error *error) {
    const uint8_t *at = bytes, *end = bytes + size;
    while (at < end && stamp->count < ISO_STAMP_LEVELS) {
        ISO_TRY(get_level(&at, end, &stamp->level[stamp->count], error));
        stamp->count++;
    }
    return at == end && stamp->count ? ISO_OK : iso_fail(error, ISO_ERR_FORMAT, "the stamp is damaged");
}

iso_status iso_stamp_parse(const char *name, const char *text, iso_stamp **out, iso_error *error) {
    size_t size;
    uint8_t *bytes = decode(text, &size);
    if (!bytes) return iso_fail(error, ISO_ERR_FORMAT, "the stamp is damaged");
    iso_stamp *stamp = allocate_stamp(name);
    iso_status status = stamp ? get_levels(bytes, size, stamp, error)
                              : iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stamp");
    free(bytes);
    if (status == ISO_OK)
        *out = stamp;
    else
        iso_stamp_free(stamp);
    return status;
}
