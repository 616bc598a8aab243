/* format_amira: uniform lattices of Amira and Avizo (AmiraMesh, .am): text, or binary in either byte order,
 * as it is, packed by zlib (HxZip) or in runs of bytes (HxByteRLE). The bounding box goes from the first
 * voxel's centre to the last one's. */
#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/format.h"

enum { MOST_HEADER = 1 << 20, LINE = 1024, SIZES = 64, ARRAYS = ISO_VOLUME_ITEMS };

typedef enum packing { PLAIN, ZIP, RUNS } packing;

/* An array: the number of its section, its size in the file (of text: 0), and how it is packed. */
typedef struct array {
    iso_format_array is;
    int section;
    packing packed;
    uint64_t bytes;
    bool known, lattice;
} array;

typedef struct amira {
    const char *path;
    char *text; /* of the header */
    bool is_text, big_endian, has_dims, has_box;
    uint64_t dims[3];
    double box[6], unit; /* unit: mm; 0: not stated */
    struct {
        char name[ISO_VOLUME_TEXT];
        uint64_t count;
    } sizes[SIZES];
    int size_count, count;
    array arrays[ARRAYS];
    uint64_t begin; /* of the sections */
} amira;

static iso_status bad(const amira *a, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable AmiraMesh: %s", a->path, what);
}

/* ---- header */

static iso_status take_size(amira *a, const char *line, iso_error *error) {
    char name[64];
    long long n[3] = {0};
    const int got = sscanf(line, " define %63s %lld %lld %lld", name, &n[0], &n[1], &n[2]) - 1;
    if (got < 1 || a->size_count == SIZES) return ISO_OK;
    uint64_t count = 1;
    for (int i = 0; i < got; i++)
        if (n[i] < 0 || __builtin_mul_overflow(count, (uint64_t)n[i], &count))
            return bad(a, "a size is not possible", error);
    if (strcmp(name, "Lattice") == 0) {
        if (got != 3) return bad(a, "its lattice has not three axes", error);
        for (int i = 0; i < 3; i++) a->dims[i] = (uint64_t)n[i];
        a->has_dims = true;
    }
    snprintf(a->sizes[a->size_count].name, sizeof a->sizes->name, "%s", name);
    a->sizes[a->size_count++].count = count;
    return ISO_OK;
}

static bool scalar_of(const char *type, iso_scalar *scalar, uint64_t *components) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } types[] = {{"byte", ISO_SCALAR_UINT8},   {"short", ISO_SCALAR_INT16}, {"ushort", ISO_SCALAR_UINT16},
                 {"int", ISO_SCALAR_INT32},    {"uint", ISO_SCALAR_UINT32}, {"float", ISO_SCALAR_FLOAT},
                 {"double", ISO_SCALAR_DOUBLE}};
    const size_t length = strcspn(type, "[");
    *components = type[length] ? strtoul(type + length + 1, NULL, 10) : 1;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strlen(types[i].name) == length && strncmp(type, types[i].name, length) == 0) {
            *scalar = types[i].scalar;
            return true;
        }
    return false;
}

/* Takes a line such as "Lattice { float[3] Data } @1(HxZip,1234)". */
static iso_status take_array(amira *a, const char *line, iso_error *error) {
    char lattice[64], type[32], name[64], method[32] = "";
    const char *at = strrchr(line, '@');
    array new = {.section = 0};
    unsigned long long bytes = 0;
    if (!at || sscanf(line, " %63[^ {] { %31s %63[^ }]", lattice, type, name) != 3 || a->count == ARRAYS)
        return ISO_OK;
    const int got = sscanf(at, "@%d(%31[^,],%llu", &new.section, method, &bytes);
    if (got < 1) return ISO_OK;
    new.packed = strcmp(method, "HxZip") == 0 ? ZIP : strcmp(method, "HxByteRLE") == 0 ? RUNS : PLAIN;
    if (*method && (new.packed == PLAIN || got < 3))
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: packed by %.32s, which is not read", a->path,
                        method);
    new.known = scalar_of(type, &new.is.scalar, &new.is.components);
    new.lattice = strcmp(lattice, "Lattice") == 0;
    for (int i = 0; i < a->size_count; i++)
        if (strcmp(a->sizes[i].name, lattice) == 0) new.is.tuples = a->sizes[i].count;
    new.bytes = bytes;
    if (!*method && (__builtin_mul_overflow(new.is.tuples, new.is.components, &new.bytes) ||
                     __builtin_mul_overflow(new.bytes, iso_scalar_size(new.is.scalar), &new.bytes)))
        return bad(a, "the size of an array is not possible", error);
    snprintf(new.is.name, sizeof new.is.name, "%s", name);
    a->arrays[a->count++] = new;
    return ISO_OK;
}

static iso_status take_line(amira *a, const char *line, iso_error *error) {
    const char *at = line + strspn(line, " \t"), *kind = strstr(at, "CoordType"),
               *box = strstr(at, "BoundingBox"), *unit = strstr(at, "Coordinates \"");
    if (strncmp(at, "define ", 7) == 0) return take_size(a, at, error);
    if (kind && !strstr(kind, "\"uniform\""))
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: its coordinates are not uniform, which is not read: resample it in Amira "
                        "(Resample, or Arithmetic on a uniform lattice)",
                        a->path);
    if (box) {
        double *b = a->box;
        a->has_box =
            sscanf(box, "BoundingBox %lf %lf %lf %lf %lf %lf", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5]) == 6;
        return a->has_box ? ISO_OK : bad(a, "its BoundingBox is not six numbers", error);
    }
    if (unit) {
        char name[32] = "";
        sscanf(unit, "Coordinates \"%31[^\"]", name);
        a->unit = iso_format_unit(name);
        return ISO_OK;
    }
    return *at != '#' && strchr(at, '{') ? take_array(a, at, error) : ISO_OK;
}

static iso_status read_header(amira *a, FILE *file, uint64_t size, iso_error *error) {
    const size_t most = size < MOST_HEADER ? (size_t)size : MOST_HEADER;
    a->text = iso_alloc_zero(1, most + 1);
    if (!a->text) return iso_fail_memory(error, a->path);
    if (fread(a->text, 1, most, file) != most)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", a->path, strerror(errno));
    char *next = a->text, line[LINE];
    for (;;) {
        const size_t length = strcspn(next, "\n");
        if (!next[length])
            return most < MOST_HEADER
                       ? iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends in its header", a->path)
                       : bad(a, "its header is longer than 1 MB, or has none", error);
        snprintf(line, sizeof line, "%.*s", (int)(length < LINE - 1 ? length : LINE - 1), next);
        if (next == a->text) {
            if (!strstr(line, "AmiraMesh") && !strstr(line, "Avizo"))
                return bad(a, "it has no first line", error);
            a->is_text = strstr(line, "ASCII") != NULL;
            a->big_endian = !strstr(line, "LITTLE-ENDIAN");
        } else if (line[0] == '@' && isdigit((unsigned char)line[1])) {
            a->begin = (uint64_t)(next - a->text);
            break;
        } else {
            ISO_TRY(take_line(a, line, error));
        }
        next += length + 1;
    }
    return a->has_dims ? ISO_OK : bad(a, "it defines no Lattice", error);
}

/* Moves to the values of a section, through those before it. */
static iso_status find_section(const amira *a, FILE *file, int wanted, uint64_t *position, iso_error *error) {
    char line[64];
    if (fseeko(file, (off_t)a->begin, SEEK_SET) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", a->path, strerror(errno));
    while (fgets(line, sizeof line, file)) {
        if (!strchr(line, '\n')) iso_format_skip_line(file);
        if (line[0] != '@') {
            if (a->is_text || !line[strspn(line, " \r\n")]) continue;
            return bad(a, "a section does not begin where the one before it ends", error);
        }
        const int section = atoi(line + 1);
        const off_t at = ftello(file);
        if (section == wanted && at >= 0) {
            *position = (uint64_t)at;
            return ISO_OK;
        }
        if (a->is_text) continue;
        const array *of = NULL;
        for (int i = 0; i < a->count && !of; i++)
            if (a->arrays[i].section == section) of = &a->arrays[i];
        if (!of || (!of->known && of->packed == PLAIN))
            return bad(a, "an array before the one that is read has values of an unknown type", error);
        if (of->bytes > INT64_MAX || fseeko(file, (off_t)of->bytes, SEEK_CUR) != 0) break;
    }
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends before section @%d", a->path, wanted);
}

static iso_status describe(amira *a, FILE *file, uint64_t size, const iso_volume_opts *opts,
                           iso_volume_info *info, int *chosen, uint64_t *position, iso_error *error) {
    iso_format_array listed[ARRAYS];
    int places[ARRAYS], count = 0;
    ISO_TRY(read_header(a, file, size, error));
    for (int i = 0; i < a->count; i++)
        if (a->arrays[i].lattice && a->arrays[i].known) {
            places[count] = i;
            listed[count++] = a->arrays[i].is;
        }
    const iso_format_image image = {{a->dims[0], a->dims[1], a->dims[2]}, listed, count};
    ISO_TRY(iso_format_dims(a->path, a->dims, info, error));
    ISO_TRY(iso_format_take_array(a->path, opts, &image, info, chosen, error));
    *chosen = places[*chosen];
    const double unit = a->unit > 0 ? a->unit : 1;
    info->unitless = a->unit == 0;
    for (int i = 0; a->has_box && i < 3; i++) {
        const double length = a->box[2 * i + 1] - a->box[2 * i];
        info->transform.origin[i] = a->box[2 * i] * unit;
        if (info->dims[i] > 1) info->transform.spacing[i] = length / (info->dims[i] - 1) * unit;
        if (!(info->transform.spacing[i] > 0)) return bad(a, "its BoundingBox is empty", error);
    }
    if (!a->has_box) iso_volume_note(info, "no BoundingBox: voxels of 1 mm are assumed (--spacing)");
    return find_section(a, file, a->arrays[*chosen].section, position, error);
}

static iso_status amira_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_error *error) {
    amira a = {.path = path};
    FILE *file;
    uint64_t size, position = 0;
    int chosen = 0;
    ISO_TRY(iso_file_open(path, &file, &size, error));
    const iso_status status = describe(&a, file, size, opts, info, &chosen, &position, error);
    if (status == ISO_OK && a.arrays[chosen].packed != RUNS) {
        const bool zip = a.arrays[chosen].packed == ZIP;
        const char *kind = iso_scalar_name(a.arrays[chosen].is.scalar);
        iso_format_set_place(&(iso_format_place){.known = true,
                                                 .text = a.is_text,
                                                 .gzip = zip,
                                                 .scalar = a.arrays[chosen].is.scalar,
                                                 .swap = !a.is_text && a.big_endian != (__BYTE_ORDER__ ==
                                                                                        __ORDER_BIG_ENDIAN__),
                                                 .position = position},
                             opts, info);
        if (zip) opts->place->plain = position, opts->place->position = 0;
        snprintf(info->file_type, sizeof info->file_type, "%s", kind);
    }
    fclose(file);
    iso_free(a.text);
    return status;
}

/* ---- runs of bytes */

typedef struct runs {
    const char *path;
    FILE *file;
    uint64_t left;  /* bytes of the file */
    int run, value; /* bytes of the run that are left, and their value; -1: each is in the file */
} runs;

static int next_byte(runs *r) {
    if (!r->left) return EOF;
    r->left--;
    return getc(r->file);
}

static iso_status fill(void *context, void *target, size_t bytes, iso_error *error) {
    runs *r = context;
    unsigned char *to = target;
    while (bytes) {
        if (!r->run) {
            const int head = next_byte(r);
            r->run = head & 127;
            r->value = head & 128 ? -1 : next_byte(r);
            if (head == EOF || (r->value == EOF && !(head & 128)))
                return iso_fail(error, ISO_ERR_IO, "%s: truncated: its runs of bytes end too early", r->path);
            continue;
        }
        const int value = r->value < 0 ? next_byte(r) : r->value;
        if (value == EOF)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: its runs of bytes end too early", r->path);
        *to++ = (unsigned char)value;
        r->run--;
        bytes--;
    }
    return ISO_OK;
}

static iso_status read_runs(amira *a, FILE *file, uint64_t size, const iso_volume_opts *opts,
                            const iso_volume_info *info, iso_grid *grid, iso_error *error) {
    iso_volume_info now = {.transform = iso_transform_identity()};
    uint64_t position;
    int chosen = 0;
    ISO_TRY(describe(a, file, size, opts, &now, &chosen, &position, error));
    const array *of = &a->arrays[chosen];
    if (memcmp(now.dims, info->dims, sizeof now.dims) != 0 || now.type != info->type || of->packed != RUNS ||
        now.components != info->components)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", a->path);
    runs r = {.path = a->path, .file = file, .left = of->bytes};
    const iso_format_stream stream = {.fill = fill,
                                      .context = &r,
                                      .scalar = of->is.scalar,
                                      .components = info->components,
                                      .component = info->component,
                                      .swap = a->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)};
    return iso_format_read_stream(a->path, opts, info, &stream, grid, error);
}

static iso_status amira_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_grid *grid, iso_error *error) {
    amira a = {.path = path};
    FILE *file;
    uint64_t size;
    ISO_TRY(iso_file_open(path, &file, &size, error));
    const iso_status status = read_runs(&a, file, size, opts, info, grid, error);
    fclose(file);
    iso_free(a.text);
    return status;
}

const iso_format iso_format_amira = {"amira", "isopoint", NULL, amira_info, amira_read, NULL};
