/* format_afni: AFNI's volumes: attributes as text (.HEAD) and voxels (.BRIK, .BRIK.gz) beside it.
 *
 * The format: afni.nimh.nih.gov, README.attributes. World. What AFNI calls DICOM order is LPS. The matrix
 * IJK_TO_DICOM_REAL counts, which can be oblique; old files have an orientation, an origin and steps
 * alone. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/memory.h"
#include "grids/volume/format.h"

enum { MAX_HEADER = 1 << 24 };

typedef struct afni_header {
    const char *path;
    char *text;
} afni_header;

static iso_status bad(const afni_header *header, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable AFNI dataset: %s", header->path, what);
}

/* Where the values of an attribute begin, behind "name = NAME" and "count = N"; NULL: there is none. */
static const char *attribute(const afni_header *header, const char *name, int *count) {
    const size_t length = strlen(name);
    for (const char *at = header->text; (at = strstr(at, "name")); at++) {
        const char *word = at + 4 + strspn(at + 4, " \t");
        if ((at != header->text && at[-1] != '\n') || *word != '=') continue;
        word += 1 + strspn(word + 1, " \t");
        if (strncmp(word, name, length) != 0 || !strchr(" \t\r\n", word[length])) continue;
        const char *stated = strstr(word, "count"), *equals = stated ? strchr(stated, '=') : NULL;
        if (!equals) return NULL;
        char *end;
        const long number = strtol(equals + 1, &end, 10);
        *count = number < 0 || number > 1 << 24 ? 0 : (int)number;
        return end + strspn(end, " \t\r\n");
    }
    return NULL;
}

/* Reads up to `room` numbers of an attribute; returns how many there are. */
static int numbers(const afni_header *header, const char *name, int room, double *values) {
    int count = 0, found = 0;
    const char *at = attribute(header, name, &count);
    for (char *end; at && found < count && found < room; at = end) {
        values[found] = strtod(at, &end);
        if (end == at) break;
        found++;
    }
    return found;
}

/* The numbers of an attribute of sub-bricks; `missing` for those that are not stated. */
static iso_status brick_numbers(const afni_header *header, const char *name, int bricks, double missing,
                                double **values, iso_error *error) {
    *values = iso_alloc((size_t)bricks * sizeof **values);
    if (!*values) return iso_fail_memory(error, header->path);
    for (int i = numbers(header, name, bricks, *values); i < bricks; i++) (*values)[i] = missing;
    return ISO_OK;
}

/* The type of a sub-brick; all have one, because they are components of one volume. */
static iso_status find_scalar(const afni_header *header, int bricks, iso_scalar *scalar, iso_error *error) {
    static const iso_scalar types[] = {[0] = ISO_SCALAR_UINT8,
                                       [1] = ISO_SCALAR_INT16,
                                       [2] = ISO_SCALAR_INT32,
                                       [3] = ISO_SCALAR_FLOAT,
                                       [4] = ISO_SCALAR_DOUBLE};
    double *stated;
    ISO_TRY(brick_numbers(header, "BRICK_TYPES", bricks, 1, &stated, error));
    const double type = stated[0];
    bool same = true;
    for (int i = 1; i < bricks; i++) same = same && stated[i] == type;
    iso_free(stated);
    if (!same) return bad(header, "sub-bricks of several types (3dcalc -datum float makes them one)", error);
    for (int i = 0; i < 5; i++)
        if (type == i) {
            *scalar = types[i];
            return ISO_OK;
        }
    return bad(header, type == 5 ? "complex values" : "an unknown type of values", error);
}

/* Sets the scale of the chosen sub-brick; 0 is none. */
static iso_status take_scale(const afni_header *header, int bricks, iso_volume_info *info, iso_error *error) {
    double *factors;
    ISO_TRY(brick_numbers(header, "BRICK_FLOAT_FACS", bricks, 0, &factors, error));
    const double factor = factors[info->component];
    iso_free(factors);
    if (!(factor >= 0)) return bad(header, "a negative scale factor", error);
    if (factor > 0) info->scale = factor;
    return ISO_OK;
}

static iso_status take_transform(const afni_header *header, iso_volume_info *info, iso_error *error) {
    double matrix[12], orientation[3], first[3], delta[3];
    iso_vec3 steps[3], origin;
    info->anatomical = true;
    if (numbers(header, "IJK_TO_DICOM_REAL", 12, matrix) == 12) {
        for (int axis = 0; axis < 3; axis++)
            steps[axis] = iso_vec3_make(matrix[axis], matrix[4 + axis], matrix[8 + axis]);
        origin = iso_vec3_make(matrix[3], matrix[7], matrix[11]);
        iso_format_transform(steps, &origin, 1, info);
        return ISO_OK;
    }
    double world[3] = {0, 0, 0};
    if (numbers(header, "ORIENT_SPECIFIC", 3, orientation) < 3 || numbers(header, "ORIGIN", 3, first) < 3 ||
        numbers(header, "DELTA", 3, delta) < 3)
        return bad(header, "it has neither IJK_TO_DICOM_REAL nor ORIENT_SPECIFIC, ORIGIN and DELTA", error);
    for (int axis = 0; axis < 3; axis++) {
        if (!(orientation[axis] >= 0 && orientation[axis] < 6))
            return bad(header, "an orientation that is none", error);
        const int of = (int)orientation[axis] / 2;
        double step[3] = {0, 0, 0};
        step[of] = delta[axis];
        world[of] = first[axis];
        steps[axis] = iso_vec3_make(step[0], step[1], step[2]);
    }
    origin = iso_vec3_make(world[0], world[1], world[2]);
    iso_format_transform(steps, &origin, 1, info);
    return ISO_OK;
}

/* Finds the two files of a dataset, whichever of them `path` is, in the header's way of writing. */
static iso_status find_files(const char *path, const iso_volume_opts *opts, char head[ISO_FORMAT_PATH],
                             iso_format_place *place, iso_error *error) {
    size_t length = strlen(path);
    place->gzip = length > 3 && strcasecmp(path + length - 3, ".gz") == 0;
    if (place->gzip) length -= 3;
    if (length < 5 || length + 4 > ISO_FORMAT_PATH)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its name is not that of an AFNI dataset", path);
    const bool is_head = strncasecmp(path + length - 4, "head", 4) == 0, lower = path[length - 1] >= 'a';
    snprintf(head, ISO_FORMAT_PATH, "%.*s%s", (int)length - 4, path, lower ? "head" : "HEAD");
    if (!is_head) {
        snprintf(place->file, sizeof place->file, "%s", path);
        iso_file_set_read(opts->files, head);
        return ISO_OK;
    }
    snprintf(head, ISO_FORMAT_PATH, "%s", path);
    snprintf(place->file, sizeof place->file, "%.*s%s", (int)length - 4, path, lower ? "brik" : "BRIK");
    if (access(place->file, F_OK) != 0) {
        char packed[ISO_FORMAT_PATH + 4];
        snprintf(packed, sizeof packed, "%s.gz", place->file);
        place->gzip = access(packed, F_OK) == 0;
        if (place->gzip) memcpy(place->file, packed, strlen(packed) + 1);
    }
    if (access(place->file, F_OK) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: its voxels, %s or .gz, are missing: %s", path, place->file,
                        strerror(errno));
    iso_file_set_read(opts->files, place->file);
    return ISO_OK;
}

static iso_status describe(const afni_header *header, const iso_volume_opts *opts, iso_format_place *place,
                           iso_volume_info *info, iso_error *error) {
    double sizes[3], rank[2] = {3, 1};
    uint64_t dims[3];
    int count = 0;
    if (numbers(header, "DATASET_DIMENSIONS", 3, sizes) < 3) return bad(header, "it has no sizes", error);
    for (int i = 0; i < 3; i++) dims[i] = sizes[i] >= 1 && sizes[i] < 1e10 ? (uint64_t)sizes[i] : 0;
    numbers(header, "DATASET_RANK", 2, rank);
    ISO_TRY(iso_format_dims(header->path, dims, info, error));
    if (!(rank[1] >= 1 && rank[1] <= 1 << 24))
        return bad(header, "a number of sub-bricks that cannot be", error);
    ISO_TRY(iso_format_component(header->path, opts, (int)rank[1], info, error));
    ISO_TRY(find_scalar(header, (int)rank[1], &place->scalar, error));
    ISO_TRY(take_scale(header, (int)rank[1], info, error));
    ISO_TRY(take_transform(header, info, error));
    const char *order = attribute(header, "BYTEORDER_STRING", &count);
    place->swap = order && (strncmp(order, "'MSB", 4) == 0) == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
    iso_format_set_place(place, opts, info);
    return ISO_OK;
}

static iso_status afni_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    char head[ISO_FORMAT_PATH];
    iso_format_place place = {.known = true, .separate = true};
    uint64_t bytes;
    ISO_TRY(find_files(path, opts, head, &place, error));
    ISO_TRY(iso_format_file_bytes(head, &bytes, error));
    size_t count = bytes < MAX_HEADER ? (size_t)bytes : MAX_HEADER;
    afni_header header = {head, iso_alloc(count + 1)};
    bool gzip;
    if (!header.text) return iso_fail_memory(error, path);
    iso_status status = iso_format_read_head(head, header.text, &count, &gzip, error);
    header.text[status == ISO_OK ? count : 0] = 0;
    if (status == ISO_OK) status = describe(&header, opts, &place, info, error);
    iso_free(header.text);
    return status;
}

const iso_format iso_format_afni = {"afni", "isopoint", NULL, afni_info, NULL, NULL};
