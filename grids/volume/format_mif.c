/* format_mif: MRtrix's volumes: a header of lines "key: value" that ends with "END", and the voxels behind it
 * (.mif, .mif.gz) or in another file (.mih).
 *
 * The format: mrtrix.readthedocs.io, "Images and other data". World. `transform` leads from millimetres along
 * the image's axes to RAS, which is turned to LPS. `layout` says for each axis whether it runs backwards in
 * the file, and how many axes run faster: such a volume is read as it lies there, with its axes renamed. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/geometry.h"
#include "base/memory.h"
#include "grids/volume/format.h"

enum { MAX_AXES = 8, MAX_HEADER = 1 << 18 };

typedef struct mif_header {
    const char *path;
    int axes, sizes[MAX_AXES];
    double voxel[MAX_AXES];
    int layout_axes, rank[MAX_AXES]; /* of axis i: how many axes run faster in the file */
    bool backwards[MAX_AXES];
    double transform[12]; /* row by row */
    int transform_count;
    char type[32], file[512];
    double offset, scale;
} mif_header;

static iso_status bad(const mif_header *header, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable MRtrix image: %s", header->path, what);
}

/* Parses numbers between commas or blanks; returns how many there are. */
static int parse_numbers(const char *text, int room, double *numbers) {
    int count = 0;
    while (count < room) {
        text += strspn(text, ", \t");
        char *end;
        const double number = strtod(text, &end);
        if (end == text) break;
        numbers[count++] = number;
        text = end;
    }
    return count;
}

static iso_status take_layout(mif_header *header, const char *value, iso_error *error) {
    for (header->layout_axes = 0; *value && header->layout_axes < MAX_AXES; header->layout_axes++) {
        value += strspn(value, ", \t");
        if (!*value) break;
        const int axis = header->layout_axes;
        header->backwards[axis] = *value == '-';
        value += *value == '-' || *value == '+';
        if (!isdigit((unsigned char)*value)) return bad(header, "a layout that is no list of numbers", error);
        const unsigned long rank = strtoul(value, (char **)&value, 10);
        header->rank[axis] = rank < MAX_AXES ? (int)rank : MAX_AXES; /* order_axes refuses it */
    }
    return ISO_OK;
}

static iso_status take_line(mif_header *header, const char *key, const char *value, iso_error *error) {
    double numbers[MAX_AXES];
    if (strcmp(key, "dim") == 0) {
        header->axes = parse_numbers(value, MAX_AXES, numbers);
        for (int i = 0; i < header->axes; i++) {
            if (!(numbers[i] >= 1 && numbers[i] <= INT_MAX))
                return bad(header, "a size that is no number", error);
            header->sizes[i] = (int)numbers[i];
        }
    } else if (strcmp(key, "vox") == 0) {
        parse_numbers(value, MAX_AXES, header->voxel);
    } else if (strcmp(key, "layout") == 0) {
        return take_layout(header, value, error);
    } else if (strcmp(key, "transform") == 0) {
        const int room = 12 - header->transform_count;
        header->transform_count += parse_numbers(value, room, header->transform + header->transform_count);
    } else if (strcmp(key, "scaling") == 0) {
        if (parse_numbers(value, 2, numbers) == 2) header->offset = numbers[0], header->scale = numbers[1];
    } else if (strcmp(key, "datatype") == 0) {
        snprintf(header->type, sizeof header->type, "%s", value);
    } else if (strcmp(key, "file") == 0) {
        snprintf(header->file, sizeof header->file, "%s", value);
    }
    return ISO_OK;
}

static iso_status parse_lines(mif_header *header, char *text, iso_error *error) {
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        line[strcspn(line, "\r")] = 0;
        if (strcmp(line, "END") == 0) return ISO_OK;
        char *colon = strchr(line, ':');
        if (!colon) continue;
        *colon = 0;
        ISO_TRY(take_line(header, line, colon + 1 + strspn(colon + 1, " \t"), error));
    }
    return bad(header, "its header has no end", error);
}

static iso_status read_header(const char *path, mif_header *header, bool *gzip, iso_error *error) {
    *header = (mif_header){.path = path, .scale = 1};
    size_t count = MAX_HEADER;
    char *text = iso_alloc(MAX_HEADER + 1);
    if (!text) return iso_fail_memory(error, path);
    iso_status status = iso_format_read_head(path, text, &count, gzip, error);
    text[status == ISO_OK ? count : 0] = 0;
    if (status == ISO_OK && strncmp(text, "mrtrix image", 12) != 0)
        status = bad(header, "it does not begin with \"mrtrix image\"", error);
    if (status == ISO_OK) status = parse_lines(header, text, error);
    iso_free(text);
    return status;
}

static bool is_mask(const mif_header *header) {
    return strcasecmp(header->type, "Bit") == 0;
}

static iso_status find_scalar(const mif_header *header, iso_scalar *scalar, bool *swap, iso_error *error) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } types[] = {{"UInt8", ISO_SCALAR_UINT8},   {"Int8", ISO_SCALAR_INT8},     {"UInt16", ISO_SCALAR_UINT16},
                 {"Int16", ISO_SCALAR_INT16},   {"UInt32", ISO_SCALAR_UINT32}, {"Int32", ISO_SCALAR_INT32},
                 {"UInt64", ISO_SCALAR_UINT64}, {"Int64", ISO_SCALAR_INT64},   {"Float16", ISO_SCALAR_HALF},
                 {"Float32", ISO_SCALAR_FLOAT}, {"Float64", ISO_SCALAR_DOUBLE}};
    const bool little_here = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        const size_t length = strlen(types[i].name);
        const char *order = header->type + length;
        if (strncasecmp(header->type, types[i].name, length) != 0) continue;
        if (*order && strcasecmp(order, "LE") != 0 && strcasecmp(order, "BE") != 0) continue;
        *scalar = types[i].scalar;
        *swap = *order && (strcasecmp(order, "LE") == 0) != little_here;
        return ISO_OK;
    }
    *scalar = ISO_SCALAR_UINT8;
    *swap = false;
    if (is_mask(header)) return ISO_OK;
    char what[80];
    snprintf(what, sizeof what, "values of type \"%.30s\"", header->type);
    return bad(header, what, error);
}

/* Finds the axes of the file by rank: `spatial` the three of space, the fastest first. The others must run
 * slower than these (separate volumes), or faster, as the components of a voxel. */
static iso_status order_axes(const mif_header *header, int spatial[3], int *components, bool *separate,
                             iso_error *error) {
    int of_rank[MAX_AXES], found = 0, faster = 1, slower = 1;
    if (header->axes < 1 || header->layout_axes != header->axes)
        return bad(header, "as many sizes as there are axes in its layout are needed", error);
    memset(of_rank, -1, sizeof of_rank);
    for (int i = 0; i < header->axes; i++) {
        if (header->rank[i] >= header->axes || of_rank[header->rank[i]] >= 0)
            return bad(header, "a layout in which two axes take the same place", error);
        of_rank[header->rank[i]] = i;
    }
    for (int rank = 0; rank < header->axes; rank++) {
        const int axis = of_rank[rank];
        if (axis < 3) {
            spatial[found++] = axis;
            continue;
        }
        const bool apart = found > 0 && found < (header->axes < 3 ? header->axes : 3);
        if ((apart || header->backwards[axis]) && header->sizes[axis] > 1)
            return bad(header, "an order of its axes that is not read (mrconvert -strides 1,2,3,4)", error);
        if (__builtin_mul_overflow(*(found ? &slower : &faster), header->sizes[axis],
                                   found ? &slower : &faster))
            return bad(header, "too many volumes", error);
    }
    for (; found < 3; found++) spatial[found] = found; /* axes that are missing have one voxel */
    if (faster > 1 && slower > 1)
        return bad(header, "an order of its axes that is not read (mrconvert -strides 1,2,3,4)", error);
    *separate = faster == 1;
    *components = faster * slower;
    return ISO_OK;
}

static void take_transform(const mif_header *header, const int spatial[3], iso_volume_info *info) {
    static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const bool stated = header->transform_count == 12;
    const double *m = stated ? header->transform : identity;
    iso_vec3 steps[3], origin = {-m[3], -m[7], m[11]};
    for (int i = 0; i < 3; i++) {
        const int axis = spatial[i];
        const double size = header->voxel[axis] > 0 ? header->voxel[axis] : 1;
        steps[i] = iso_vec3_make(-m[axis] * size, -m[4 + axis] * size, m[8 + axis] * size);
        if (!header->backwards[axis]) continue;
        origin = iso_vec3_add(origin, iso_vec3_scale(steps[i], info->dims[i] - 1));
        steps[i] = iso_vec3_scale(steps[i], -1);
    }
    if (!stated) iso_volume_note(info, "no orientation in the header: axes taken as right, front, up");
    iso_format_transform(steps, &origin, 1, info);
    info->anatomical = true;
}

/* Finds the voxels: ". 1234" is behind the header, "name.dat 0" in a file beside it. */
static iso_status find_voxels(const mif_header *header, const iso_volume_opts *opts, iso_format_place *place,
                              iso_error *error) {
    char name[sizeof header->file];
    snprintf(name, sizeof name, "%s", header->file);
    char *blank = strrchr(name, ' ');
    if (blank) {
        char *end;
        errno = 0;
        place->position = strtoull(blank + 1, &end, 10);
        if (!isdigit((unsigned char)blank[1]) || *end || errno)
            return bad(header, "its file's offset is no number", error);
        *blank = 0;
    }
    if (!*name) return bad(header, "it does not say which file has the voxels", error);
    if (strcmp(name, ".") == 0) return ISO_OK;
    char *beside = iso_format_beside(header->path, name);
    if (!beside) return iso_fail_memory(error, header->path);
    const int length = snprintf(place->file, sizeof place->file, "%s", beside);
    free(beside);
    if (length >= (int)sizeof place->file) return bad(header, "the name of its file is too long", error);
    place->gzip = false;
    iso_file_set_read(opts->files, place->file);
    return ISO_OK;
}

static iso_status mif_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    mif_header header;
    iso_format_place place = {.known = true};
    int spatial[3], components = 1;
    uint64_t dims[3];
    ISO_TRY(read_header(path, &header, &place.gzip, error));
    ISO_TRY(find_scalar(&header, &place.scalar, &place.swap, error));
    place.bits = is_mask(&header);
    ISO_TRY(order_axes(&header, spatial, &components, &place.separate, error));
    ISO_TRY(find_voxels(&header, opts, &place, error));
    if (place.bits && components > 1 && !place.separate)
        return bad(&header, "a mask whose volumes lie within its voxels (mrconvert -strides 1,2,3,4)", error);
    for (int i = 0; i < 3; i++) dims[i] = spatial[i] < header.axes ? (uint64_t)header.sizes[spatial[i]] : 1;
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(iso_format_component(path, opts, components, info, error));
    take_transform(&header, spatial, info);
    if (header.scale < 0) return bad(&header, "a negative scale", error);
    if (header.scale > 0) info->scale = header.scale, info->offset = header.offset;
    iso_format_set_place(&place, opts, info);
    return ISO_OK;
}

const iso_format iso_format_mif = {"mif", "isopoint", NULL, mif_info, NULL, NULL};
