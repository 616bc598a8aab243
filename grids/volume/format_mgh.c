/* format_mgh: FreeSurfer's volumes, .mgh, and .mgz, which gzip has compressed: a header of 284 bytes and then
 * the voxels, all big-endian; several frames lie one behind the other.
 *
 * The format: surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat. World. RAS, turned to LPS; the header
 * states where the middle of the volume is, at voxel (width / 2, height / 2, depth / 2). */
#include <string.h>

#include "base/geometry.h"
#include "grids/volume/format.h"

enum {
    HEADER = 284,
    /* positions in the header; the numbers from SPACING on count only if the short at IS_PLACED is 1 */
    VERSION = 0,
    SIZES = 4, /* width, height, depth, frames */
    TYPE = 20,
    IS_PLACED = 28,
    SPACING = 30,
    DIRECTIONS = 42, /* of the three axes, one after the other */
    MIDDLE = 78,
    NEEDED = 90
};

static uint32_t word_at(const unsigned char *header, int at) {
    return (uint32_t)header[at] << 24 | (uint32_t)header[at + 1] << 16 | (uint32_t)header[at + 2] << 8 |
           header[at + 3];
}

static double number_at(const unsigned char *header, int at) {
    const uint32_t word = word_at(header, at);
    float number;
    memcpy(&number, &word, sizeof number);
    return number;
}

static iso_vec3 vector_at(const unsigned char *header, int at) {
    return iso_vec3_make(-number_at(header, at), -number_at(header, at + 4), number_at(header, at + 8));
}

static iso_status find_scalar(const char *path, uint32_t type, iso_scalar *scalar, iso_error *error) {
    static const struct {
        uint32_t type;
        iso_scalar scalar;
    } types[] = {{0, ISO_SCALAR_UINT8},
                 {1, ISO_SCALAR_INT32},
                 {3, ISO_SCALAR_FLOAT},
                 {4, ISO_SCALAR_INT16},
                 {10, ISO_SCALAR_UINT16}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (types[i].type != type) continue;
        *scalar = types[i].scalar;
        return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_FORMAT, "%s: voxels of FreeSurfer's type %u are not read", path, type);
}

static void take_transform(const unsigned char *header, iso_volume_info *info) {
    iso_vec3 steps[3] = {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, middle = {0, 0, 0}; /* if none are stated */
    if (header[IS_PLACED] == 0 && header[IS_PLACED + 1] == 1) {
        for (int axis = 0; axis < 3; axis++)
            steps[axis] = iso_vec3_scale(vector_at(header, DIRECTIONS + 12 * axis),
                                         number_at(header, SPACING + 4 * axis));
        middle = vector_at(header, MIDDLE);
    } else {
        iso_volume_note(info, "no orientation in the header: coronal slices of 1 mm, as FreeSurfer takes it");
    }
    for (int axis = 0; axis < 3; axis++)
        middle = iso_vec3_sub(middle, iso_vec3_scale(steps[axis], info->dims[axis] / 2.0));
    iso_format_transform(steps, &middle, 1, info);
    info->anatomical = true;
}

static iso_status mgh_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    unsigned char header[HEADER] = {0};
    bool gzip;
    size_t count = HEADER;
    iso_scalar scalar = ISO_SCALAR_UINT8;
    uint64_t dims[3];
    ISO_TRY(iso_format_read_head(path, header, &count, &gzip, error));
    if (count >= 4 && word_at(header, VERSION) != 1)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: not a volume of FreeSurfer: it does not begin with version 1", path);
    if (count < NEEDED) return iso_format_truncated(path, count, HEADER, error);
    ISO_TRY(find_scalar(path, word_at(header, TYPE), &scalar, error));
    for (int axis = 0; axis < 3; axis++) dims[axis] = word_at(header, SIZES + 4 * axis);
    const uint32_t frames = word_at(header, SIZES + 12);
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(iso_format_component(path, opts, frames > INT32_MAX ? 0 : (int)frames, info, error));
    take_transform(header, info);
    const iso_format_place place = {.known = true,
                                    .swap = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
                                    .separate = true,
                                    .gzip = gzip,
                                    .scalar = scalar,
                                    .position = HEADER};
    iso_format_set_place(&place, opts, info);
    return ISO_OK;
}

const iso_format iso_format_mgh = {"mgh", "isopoint", NULL, mgh_info, NULL, NULL};
