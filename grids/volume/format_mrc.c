/* format_mrc: density maps of electron microscopy and crystallography, in MRC and CCP4 files: a header of
 * 1024 bytes, symmetry or other records, and then the voxels.
 *
 * The format: Cheng et al., "MRC2014: Extensions to the MRC format header for electron cryo-microscopy
 * and tomography", J. Struct. Biol. 192 (2015); ccpem.ac.uk/mrc_format.
 *
 * World. As molecules have it (io/glyphs): an angstrom is a millimetre of the world, so that a map and
 * its model lie in one place. MAPC, MAPR and MAPS say along which edge of the cell columns, rows and
 * sections are; the cell's edges are as usual (a along x, b in the plane of x and y). ORIGIN counts if it
 * is not 0, as in ChimeraX; else the number of the first column, row and section. */
#include <math.h>
#include <string.h>

#include "base/geometry.h"
#include "grids/volume/format.h"

enum {
    HEADER = 1024,
    /* positions of words in the header */
    SIZES = 0,
    MODE = 12,
    STARTS = 16,
    INTERVALS = 28,
    EDGES = 40,
    ANGLES = 52,
    AXES = 64,
    SPACE_GROUP = 88,
    RECORDS = 92, /* bytes of symmetry records or of another extended header */
    IMOD_STAMP = 152,
    IMOD_FLAGS = 156,
    ORIGIN = 196,
    MACHINE = 212
};

typedef struct mrc_header {
    unsigned char bytes[HEADER];
    bool swap, gzip;
} mrc_header;

static uint32_t word_at(const mrc_header *header, int at) {
    uint32_t word;
    memcpy(&word, header->bytes + at, sizeof word);
    return header->swap ? __builtin_bswap32(word) : word;
}

static int32_t integer_at(const mrc_header *header, int at) {
    return (int32_t)word_at(header, at);
}

static double number_at(const mrc_header *header, int at) {
    const uint32_t word = word_at(header, at);
    float number;
    memcpy(&number, &word, sizeof number);
    return number;
}

/* The axis (0 .. 2) of the cell along which the file's axis is; old files leave it out. */
static int cell_axis(const mrc_header *header, int axis) {
    const int stated = integer_at(header, AXES + 4 * axis);
    return stated == 0 ? axis : stated - 1;
}

static bool has_axes(const mrc_header *header) {
    int seen = 0;
    for (int axis = 0; axis < 3; axis++) {
        const int stated = cell_axis(header, axis);
        if (stated < 0 || stated > 2) return false;
        seen |= 1 << stated;
    }
    return seen == 7;
}

/* Finds the byte order: in the other one no number of axes or mode makes sense. */
static iso_status read_header(const char *path, mrc_header *header, iso_error *error) {
    size_t count = HEADER;
    ISO_TRY(iso_format_read_head(path, header->bytes, &count, &header->gzip, error));
    if (count < HEADER) return iso_format_truncated(path, count, HEADER, error);
    for (int order = 0; order < 2; order++) {
        header->swap = order == 1;
        if (has_axes(header) && word_at(header, MODE) <= 127) return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not an MRC or CCP4 map: its header names no axes", path);
}

static iso_status find_scalar(const char *path, const mrc_header *header, iso_scalar *scalar,
                              iso_volume_info *info, iso_error *error) {
    static const char *const others[] = {[3] = "complex integers", [4] = "complex numbers"};
    const int mode = integer_at(header, MODE);
    /* IMOD wrote bytes from 0 to 255 until 2012, and marks those with a sign. */
    const bool imod_bytes = word_at(header, IMOD_STAMP) == 1146047817 && !(word_at(header, IMOD_FLAGS) & 1);
    switch (mode) {
    case 0:
        *scalar = imod_bytes ? ISO_SCALAR_UINT8 : ISO_SCALAR_INT8;
        if (imod_bytes) iso_volume_note(info, "written by an old IMOD: bytes are from 0 to 255");
        return ISO_OK;
    case 1:
        *scalar = ISO_SCALAR_INT16;
        return ISO_OK;
    case 2:
        *scalar = ISO_SCALAR_FLOAT;
        return ISO_OK;
    case 6:
        *scalar = ISO_SCALAR_UINT16;
        return ISO_OK;
    case 12:
        *scalar = ISO_SCALAR_HALF;
        return ISO_OK;
    case 3:
    case 4:
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds %s (mode %d): a transform, not a map", path,
                        others[mode], mode);
    default:
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: voxels of mode %d are not read: modes 0, 1, 2, 6 and 12 are", path, mode);
    }
}

/* Edge `axis` of the unit cell as a unit vector. */
static iso_status cell_directions(const char *path, const mrc_header *header, iso_vec3 directions[3],
                                  iso_error *error) {
    double cosine[3] = {0};
    for (int i = 0; i < 3; i++) {
        const double angle = number_at(header, ANGLES + 4 * i);
        double sine;
        if (angle != 0 && angle != 90 && angle > 0 && angle < 180)
            iso_sincos(angle * (3.14159265358979323846 / 180), &sine, &cosine[i]);
    }
    const double sine = sqrt(1 - cosine[2] * cosine[2]), y = (cosine[0] - cosine[1] * cosine[2]) / sine,
                 square = 1 - cosine[1] * cosine[1] - y * y;
    if (!(sine > 1e-3 && square > 1e-6))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: angles of %g, %g and %g degrees are no cell", path,
                        number_at(header, ANGLES), number_at(header, ANGLES + 4),
                        number_at(header, ANGLES + 8));
    directions[0] = iso_vec3_make(1, 0, 0);
    directions[1] = iso_vec3_make(cosine[2], sine, 0);
    directions[2] = iso_vec3_make(cosine[1], y, sqrt(square));
    return ISO_OK;
}

static iso_status take_transform(const char *path, const mrc_header *header, iso_volume_info *info,
                                 iso_error *error) {
    iso_vec3 directions[3], steps[3], start = {0, 0, 0};
    bool stated = true;
    ISO_TRY(cell_directions(path, header, directions, error));
    for (int axis = 0; axis < 3; axis++) {
        const int of = cell_axis(header, axis);
        const double length = number_at(header, EDGES + 4 * of),
                     count = integer_at(header, INTERVALS + 4 * of);
        const bool has = length > 0 && count > 0;
        steps[axis] = iso_vec3_scale(directions[of], has ? length / count : 1);
        start = iso_vec3_add(start, iso_vec3_scale(steps[axis], integer_at(header, STARTS + 4 * axis)));
        stated = stated && has;
    }
    const iso_vec3 origin = {number_at(header, ORIGIN), number_at(header, ORIGIN + 4),
                             number_at(header, ORIGIN + 8)};
    const bool has_origin = iso_vec3_is_finite(origin) && iso_vec3_length(origin) > 0;
    iso_format_transform(steps, has_origin ? &origin : &start, 1, info);
    info->unitless = true;
    info->angstrom = stated;
    if (!stated) iso_volume_note(info, "no voxel size is stated: 1 is assumed (--spacing)");
    return ISO_OK;
}

static iso_status mrc_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    mrc_header header;
    iso_scalar scalar = ISO_SCALAR_FLOAT;
    uint64_t dims[3];
    int volumes = 1;
    ISO_TRY(read_header(path, &header, error));
    ISO_TRY(find_scalar(path, &header, &scalar, info, error));
    for (int axis = 0; axis < 3; axis++) {
        const int32_t size = integer_at(&header, SIZES + 4 * axis);
        dims[axis] = size < 0 ? 0 : (uint64_t)size;
    }
    const int group = integer_at(&header, SPACE_GROUP), sections = integer_at(&header, INTERVALS + 8);
    if (group >= 401 && sections > 0 && dims[2] % (uint64_t)sections == 0) { /* a stack of volumes */
        volumes = (int)(dims[2] / (uint64_t)sections);
        dims[2] = (uint64_t)sections;
    }
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(iso_format_component(path, opts, volumes, info, error));
    ISO_TRY(take_transform(path, &header, info, error));
    if (group == 0 && dims[2] > 1)
        iso_volume_note(info, "the header says that its %d sections are pictures, not a volume",
                        info->dims[2]);
    const iso_format_place place = {.known = true,
                                    .swap = header.swap,
                                    .separate = true,
                                    .gzip = header.gzip,
                                    .scalar = scalar,
                                    .position = HEADER + (uint64_t)word_at(&header, RECORDS)};
    iso_format_set_place(&place, opts, info);
    return ISO_OK;
}

const iso_format iso_format_mrc = {"mrc", "isopoint", NULL, mrc_info, NULL, NULL};
