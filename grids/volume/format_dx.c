/* format_dx: regular grids in OpenDX's format, with values as text or binary, in which APBS and others write
 * potentials and maps.
 *
 * The format: OpenDX User's Guide, appendix B: "object 1 class gridpositions counts NX NY NZ", "origin",
 * three times "delta", "object 2 class gridconnections", "object 3 class array .. items N data follows",
 * and the values, the last axis fastest. # begins a line of comment. The world is the file's own; APBS
 * means angstrom. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "grids/volume/format.h"

enum { MAX_LINES = 1000 };

typedef struct dx_header {
    uint64_t dims[3];
    iso_vec3 origin, steps[3];
    bool has_counts;
    int deltas;
    unsigned long long items;
    bool has_data, is_binary;
    iso_format_place place; /* if it is binary: of the voxels */
} dx_header;

static iso_status bad(const char *path, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable OpenDX grid: %s", path, what);
}

/* The array begins behind this line. */
static iso_status take_array(const char *path, const char *line, dx_header *header, iso_error *error) {
    const char *items = strstr(line, "items"), *rank = strstr(line, "rank");
    header->place = (iso_format_place){.known = true, .scalar = ISO_SCALAR_FLOAT};
    if (strstr(line, "ieee") || strstr(line, "binary")) {
        static const struct {
            const char *name;
            iso_scalar scalar;
        } types[] = {{"float", ISO_SCALAR_FLOAT},
                     {"double", ISO_SCALAR_DOUBLE},
                     {"int", ISO_SCALAR_INT32},
                     {"short", ISO_SCALAR_INT16},
                     {"byte", ISO_SCALAR_UINT8}};
        const char *type = strstr(line, "type");
        bool known = false;
        for (size_t i = 0; type && i < sizeof types / sizeof *types && !known; i++) {
            known = strncmp(type + 4 + strspn(type + 4, " "), types[i].name, strlen(types[i].name)) == 0;
            header->place.scalar = types[i].scalar;
        }
        if (!known) return bad(path, "binary values of a type that is not read: write them as text", error);
        header->place.swap = (strstr(line, "msb") != NULL) == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
        header->is_binary = true;
    }
    if (!strstr(line, "follows")) return bad(path, "its values are in another file", error);
    if (rank && strtol(rank + 4, NULL, 10) != 0) return bad(path, "its values are vectors", error);
    if (!items || sscanf(items + 5, "%llu", &header->items) != 1)
        return bad(path, "the number of its values is missing", error);
    header->has_data = true;
    return ISO_OK;
}

static iso_status take_line(const char *path, const char *line, dx_header *header, iso_error *error) {
    iso_vec3 v;
    const char *counts = strstr(line, "counts");
    if (strstr(line, "class gridpositions") && counts) {
        unsigned long long n[3];
        if (sscanf(counts + 6, "%llu %llu %llu", &n[0], &n[1], &n[2]) != 3)
            return bad(path, "a volume needs three counts of points", error);
        for (int i = 0; i < 3; i++) header->dims[2 - i] = n[i];
        header->has_counts = true;
    } else if (sscanf(line, " origin %lf %lf %lf", &v.x, &v.y, &v.z) == 3) {
        header->origin = v;
    } else if (sscanf(line, " delta %lf %lf %lf", &v.x, &v.y, &v.z) == 3) {
        if (header->deltas < 3) header->steps[2 - header->deltas] = v;
        header->deltas++;
    } else if (strstr(line, "class array")) {
        return take_array(path, line, header, error);
    }
    return ISO_OK;
}

static iso_status read_header(const char *path, FILE *file, dx_header *header, iso_error *error) {
    char line[512];
    for (int i = 0; i < MAX_LINES && !header->has_data; i++) {
        if (!fgets(line, sizeof line, file))
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends in its header", path);
        if (!strchr(line, '\n')) iso_format_skip_line(file);
        if (line[0] != '#') ISO_TRY(take_line(path, line, header, error));
    }
    if (!header->has_data || !header->has_counts || header->deltas != 3)
        return bad(path, "it has no grid of points, three steps and an array", error);
    uint64_t points = header->dims[0];
    for (int i = 1; i < 3; i++)
        if (__builtin_mul_overflow(points, header->dims[i], &points)) points = 0;
    return points == header->items ? ISO_OK : bad(path, "it has not as many values as points", error);
}

static iso_status describe(const char *path, FILE *file, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    dx_header header = {0};
    ISO_TRY(read_header(path, file, &header, error));
    ISO_TRY(iso_format_dims(path, header.dims, info, error));
    iso_format_transform(header.steps, &header.origin, 1, info);
    info->unitless = info->angstrom = true;
    if (!header.is_binary) return iso_format_text_voxels(path, file, opts, info, error);
    const off_t position = ftello(file);
    if (position < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    header.place.position = (uint64_t)position;
    iso_format_set_place(&header.place, opts, info);
    return ISO_OK;
}

static iso_status dx_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                          iso_error *error) {
    FILE *file;
    ISO_TRY(iso_file_open(path, &file, NULL, error));
    const iso_status status = describe(path, file, opts, info, error);
    fclose(file);
    return status;
}

const iso_format iso_format_dx = {"dx", "isopoint", NULL, dx_info, NULL, NULL};
