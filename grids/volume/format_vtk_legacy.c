/* format_vtk_legacy: structured points and rectilinear grids in VTK's legacy format ("# vtk DataFile Version
 * ..."), text or binary.
 *
 * Not read by VTK, whose reader returns a full-sized array also when the data ends early, and whose pass over
 * the header does not find FIELD arrays. A first pass over the file lists every array with its position
 * (binary data is skipped, numbers in text are counted); the chosen array is read in a second pass.
 *
 * The format ("VTK File Formats", The VTK User's Guide): keywords in any case, separated by blanks; binary
 * numbers are big-endian and begin after the newline that ends their header; the world is the file's own. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "grids/volume/format.h"
#include "grids/volume/rectilinear.h"

enum { MAX_ARRAYS = ISO_VOLUME_ITEMS, MAX_NAME = ISO_VOLUME_TEXT };

typedef struct vtk_file {
    const char *path;
    FILE *stream;
    uint64_t bytes; /* of the file */
    bool binary;
    uint64_t dims[3]; /* points */
    double origin[3], spacing[3];
    bool rectilinear; /* the axes have coordinates */
    iso_rectilinear axes;
    iso_format_array arrays[MAX_ARRAYS];
    uint64_t positions[MAX_ARRAYS]; /* positions of their first numbers in the file */
    int array_count;
    enum { NO_DATA, POINT_DATA, CELL_DATA } section;
    uint64_t tuples;     /* of the section */
    bool wants_all;      /* the first pass lists all arrays */
    bool enough;         /* the first pass can stop here */
    iso_status complete; /* result of the first pass */
    iso_error problem;   /* its message, if it failed */
} vtk_file;

/* ---- words ---- */

/* Reads the next word, cut to MAX_NAME - 1 characters; false at the end of the file. */
static bool next_word(FILE *file, char word[MAX_NAME]) {
    int c = getc(file), length = 0;
    while (c != EOF && isspace(c)) c = getc(file);
    while (c != EOF && !isspace(c)) {
        if (length < MAX_NAME - 1) word[length++] = (char)c;
        c = getc(file);
    }
    if (c != EOF) ungetc(c, file);
    word[length] = 0;
    return length > 0;
}

static bool word_is(const char *word, const char *wanted) {
    return strcasecmp(word, wanted) == 0;
}

static iso_status bad(vtk_file *f, const char *what) {
    return iso_fail(&f->problem, ISO_ERR_FORMAT, "%s: not a readable VTK file: %s", f->path, what);
}

static iso_status ends(vtk_file *f, const char *where) {
    return iso_fail(&f->problem, ISO_ERR_IO, "%s: truncated: the file ends in %s", f->path, where);
}

static iso_status read_size(vtk_file *f, uint64_t *size) {
    char word[MAX_NAME];
    if (!next_word(f->stream, word)) return ends(f, "its header");
    char *end;
    errno = 0;
    long long value = strtoll(word, &end, 10);
    if (errno || *end || value < 0) {
        char text[80];
        snprintf(text, sizeof text, "a count of %.40s is not possible", word);
        return bad(f, text);
    }
    *size = (uint64_t)value;
    return ISO_OK;
}

static iso_status read_doubles(vtk_file *f, double numbers[3]) {
    char word[MAX_NAME];
    for (int i = 0; i < 3; i++) {
        if (!next_word(f->stream, word)) return ends(f, "its header");
        char *end;
        numbers[i] = strtod(word, &end);
        if (*end) return bad(f, "a coordinate is not a number");
    }
    return ISO_OK;
}

bool iso_scalar_of_vtk(const char *word, iso_scalar *scalar) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } types[] = {{"unsigned_char", ISO_SCALAR_UINT8},
                 {"char", ISO_SCALAR_INT8},
                 {"signed_char", ISO_SCALAR_INT8},
                 {"unsigned_short", ISO_SCALAR_UINT16},
                 {"short", ISO_SCALAR_INT16},
                 {"unsigned_int", ISO_SCALAR_UINT32},
                 {"int", ISO_SCALAR_INT32},
                 {"unsigned_long", ISO_SCALAR_UINT64},
                 {"long", ISO_SCALAR_INT64},
                 {"vtktypeint64", ISO_SCALAR_INT64},
                 {"vtktypeuint64", ISO_SCALAR_UINT64},
                 {"unsigned_long_long", ISO_SCALAR_UINT64},
                 {"long_long", ISO_SCALAR_INT64},
                 {"vtkidtype", ISO_SCALAR_INT32},
                 {"float", ISO_SCALAR_FLOAT},
                 {"double", ISO_SCALAR_DOUBLE}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (!word_is(word, types[i].name)) continue;
        *scalar = types[i].scalar;
        return true;
    }
    return false;
}

static iso_status read_type(vtk_file *f, iso_scalar *scalar) {
    char word[MAX_NAME], text[128];
    if (!next_word(f->stream, word)) return ends(f, "its header");
    if (iso_scalar_of_vtk(word, scalar)) return ISO_OK;
    snprintf(text, sizeof text, "values of type %.80s", word);
    return bad(f, text);
}

/* Reads "X_COORDINATES count type" and the coordinates of an axis. */
static iso_status take_coordinates(vtk_file *f, int axis) {
    uint64_t count = 0;
    iso_scalar scalar;
    ISO_TRY(read_size(f, &count));
    ISO_TRY(read_type(f, &scalar));
    if (!f->rectilinear || f->axes.axis[axis]) return bad(f, "coordinates that are not expected");
    if (scalar != ISO_SCALAR_FLOAT && scalar != ISO_SCALAR_DOUBLE)
        return bad(f, "coordinates that are neither float nor double");
    if (count < 1 || count > INT_MAX || count > f->bytes) return ends(f, "its coordinates");
    if (f->binary) iso_format_skip_line(f->stream);
    double *at = f->axes.axis[axis] = iso_alloc((size_t)count * sizeof *at);
    if (!at) return iso_fail_memory(&f->problem, f->path);
    f->axes.count[axis] = (int)count;
    if (!f->binary)
        return iso_format_read_numbers(f->stream, "", ISO_SCALAR_DOUBLE, (size_t)count, at)
                   ? ISO_OK
                   : ends(f, "its coordinates");
    for (uint64_t i = 0; i < count; i++) {
        const size_t size = iso_scalar_size(scalar);
        unsigned char bytes[8];
        uint64_t bits = 0;
        if (fread(bytes, size, 1, f->stream) != 1) return ends(f, "its coordinates");
        for (size_t k = 0; k < size; k++) bits = bits << 8 | bytes[k];
        const uint32_t half = (uint32_t)bits;
        float number;
        memcpy(&number, &half, sizeof number);
        memcpy(&at[i], &bits, sizeof at[i]);
        if (size == 4) at[i] = (double)number;
    }
    return ISO_OK;
}

/* ---- arrays ---- */

/* Skips the numbers of an array. */
static iso_status skip_numbers(vtk_file *f, iso_scalar scalar, uint64_t count) {
    char word[MAX_NAME];
    if (f->binary) {
        uint64_t at = (uint64_t)ftello(f->stream), wanted;
        if (__builtin_mul_overflow(count, iso_scalar_size(scalar), &wanted) || wanted > INT64_MAX - at)
            return ends(f, "an array that is larger than any file");
        if (at > f->bytes || f->bytes - at < wanted)
            return iso_format_truncated(f->path, f->bytes, at + wanted, &f->problem);
        if (fseeko(f->stream, (off_t)wanted, SEEK_CUR) != 0) return ends(f, "an array");
        return ISO_OK;
    }
    for (uint64_t i = 0; i < count; i++)
        if (!next_word(f->stream, word)) return ends(f, "an array");
    return ISO_OK;
}

/* Lists an array whose header was just read, and skips its numbers. */
static iso_status add_array(vtk_file *f, const iso_format_array *array) {
    if (f->binary) iso_format_skip_line(f->stream);
    uint64_t count;
    if (array->components < 1 || __builtin_mul_overflow(array->components, array->tuples, &count))
        return bad(f, "an array has an impossible size");
    if (f->section != NO_DATA && f->array_count < MAX_ARRAYS) {
        f->positions[f->array_count] = (uint64_t)ftello(f->stream);
        f->arrays[f->array_count] = *array;
        f->arrays[f->array_count++].cells = f->section == CELL_DATA;
        /* VTK also uses the first SCALARS; counting the words of a long text to find more takes seconds */
        f->enough = !f->wants_all && !f->binary && array->active && f->section == POINT_DATA;
    }
    return f->enough ? ISO_OK : skip_numbers(f, array->scalar, count);
}

/* Reads "SCALARS name type [components] LOOKUP_TABLE name". */
static iso_status take_scalars(vtk_file *f) {
    iso_format_array array = {.tuples = f->tuples, .components = 1, .active = true};
    char line[MAX_NAME], word[MAX_NAME];
    if (!next_word(f->stream, array.name)) return ends(f, "its header");
    ISO_TRY(read_type(f, &array.scalar));
    if (!fgets(line, sizeof line, f->stream)) return ends(f, "its header");
    char *end;
    long components = strtol(line, &end, 10);
    if (end != line) array.components = components > 0 ? (uint64_t)components : 0;
    if (end[strspn(end, " \t\r\n")]) return bad(f, "the number of components is not a whole number");
    if (!next_word(f->stream, word)) return ends(f, "its header");
    if (!word_is(word, "LOOKUP_TABLE")) return bad(f, "scalars without LOOKUP_TABLE");
    if (!next_word(f->stream, word)) return ends(f, "its header");
    return add_array(f, &array);
}

/* Reads "COLOR_SCALARS name components"; the values are bytes or, in text files, numbers 0 .. 1. */
static iso_status take_colors(vtk_file *f) {
    iso_format_array array = {.tuples = f->tuples, .active = true};
    if (!next_word(f->stream, array.name)) return ends(f, "its header");
    ISO_TRY(read_size(f, &array.components));
    array.scalar = f->binary ? ISO_SCALAR_UINT8 : ISO_SCALAR_FLOAT;
    return add_array(f, &array);
}

/* Reads "VECTORS name type" and similar lines, with a fixed number of components; 0 for TEXTURE_COORDINATES,
 * whose line gives the number. */
static iso_status take_tuples(vtk_file *f, uint64_t components) {
    iso_format_array array = {.tuples = f->tuples, .components = components};
    if (!next_word(f->stream, array.name)) return ends(f, "its header");
    if (components == 0) ISO_TRY(read_size(f, &array.components));
    ISO_TRY(read_type(f, &array.scalar));
    return add_array(f, &array);
}

/* Reads "FIELD name count", and then count times "name components tuples type". */
static iso_status take_field(vtk_file *f) {
    char word[MAX_NAME];
    uint64_t count = 0;
    if (!next_word(f->stream, word)) return ends(f, "its header");
    ISO_TRY(read_size(f, &count));
    for (uint64_t i = 0; i < count && !f->enough; i++) {
        iso_format_array array = {0};
        if (!next_word(f->stream, array.name)) return ends(f, "its header");
        ISO_TRY(read_size(f, &array.components));
        ISO_TRY(read_size(f, &array.tuples));
        ISO_TRY(read_type(f, &array.scalar));
        if (array.components == 0 || array.tuples == 0) {
            if (f->binary) iso_format_skip_line(f->stream);
            continue;
        }
        ISO_TRY(add_array(f, &array));
    }
    return ISO_OK;
}

/* Skips "LOOKUP_TABLE name size" and its colours, which are bytes or, in text files, floats. */
static iso_status skip_table(vtk_file *f) {
    char word[MAX_NAME];
    uint64_t size = 0, numbers;
    if (!next_word(f->stream, word)) return ends(f, "its header");
    ISO_TRY(read_size(f, &size));
    if (__builtin_mul_overflow(size, 4, &numbers)) return bad(f, "a table of impossible size");
    if (f->binary) iso_format_skip_line(f->stream);
    return skip_numbers(f, ISO_SCALAR_UINT8, numbers);
}

/* Skips METADATA: lines up to an empty one. */
static iso_status skip_metadata(vtk_file *f) {
    char line[MAX_NAME];
    iso_format_skip_line(f->stream);
    while (fgets(line, sizeof line, f->stream))
        if (line[strspn(line, " \t\r\n")] == 0) break;
    return ISO_OK;
}

/* ---- header ---- */

static iso_status take_dataset(vtk_file *f) {
    char word[MAX_NAME];
    if (!next_word(f->stream, word)) return ends(f, "its header");
    f->rectilinear = word_is(word, "RECTILINEAR_GRID");
    if (f->rectilinear || word_is(word, "STRUCTURED_POINTS")) return ISO_OK;
    return iso_format_not_image(f->path, word, &f->problem);
}

static iso_status take_extent(vtk_file *f) {
    double from_to[6];
    ISO_TRY(read_doubles(f, from_to));
    ISO_TRY(read_doubles(f, from_to + 3));
    for (int i = 0; i < 3; i++) {
        double points = from_to[2 * i + 1] - from_to[2 * i] + 1;
        if (!(points >= 1 && points <= INT_MAX)) return bad(f, "an empty extent");
        f->dims[i] = (uint64_t)points;
    }
    return ISO_OK;
}

static iso_status take_section(vtk_file *f, bool cells) {
    f->section = cells ? CELL_DATA : POINT_DATA;
    return read_size(f, &f->tuples);
}

static iso_status take_keyword(vtk_file *f, const char *word) {
    if (word_is(word, "DATASET")) return take_dataset(f);
    if (word_is(word, "DIMENSIONS")) {
        for (int i = 0; i < 3; i++) ISO_TRY(read_size(f, &f->dims[i]));
        return ISO_OK;
    }
    if (word_is(word, "EXTENT")) return take_extent(f);
    if (word_is(word, "ORIGIN")) return read_doubles(f, f->origin);
    if (word_is(word, "SPACING") || word_is(word, "ASPECT_RATIO")) return read_doubles(f, f->spacing);
    if (word_is(word, "X_COORDINATES")) return take_coordinates(f, 0);
    if (word_is(word, "Y_COORDINATES")) return take_coordinates(f, 1);
    if (word_is(word, "Z_COORDINATES")) return take_coordinates(f, 2);
    if (word_is(word, "POINT_DATA")) return take_section(f, false);
    if (word_is(word, "CELL_DATA")) return take_section(f, true);
    if (word_is(word, "FIELD")) return take_field(f);
    if (word_is(word, "METADATA")) return skip_metadata(f);
    if (f->section == NO_DATA) return bad(f, "an unknown word in its header");
    if (word_is(word, "SCALARS")) return take_scalars(f);
    if (word_is(word, "COLOR_SCALARS")) return take_colors(f);
    if (word_is(word, "LOOKUP_TABLE")) return skip_table(f);
    if (word_is(word, "VECTORS") || word_is(word, "NORMALS")) return take_tuples(f, 3);
    if (word_is(word, "TEXTURE_COORDINATES")) return take_tuples(f, 0);
    if (word_is(word, "TENSORS")) return take_tuples(f, 9);
    if (word_is(word, "TENSORS6")) return take_tuples(f, 6);
    if (word_is(word, "GLOBAL_IDS") || word_is(word, "PEDIGREE_IDS")) return take_tuples(f, 1);
    return bad(f, "an unknown kind of array");
}

static iso_status scan_arrays(vtk_file *f) {
    char word[MAX_NAME];
    const char magic[] = "# vtk DataFile";
    const size_t got = fread(word, 1, sizeof magic - 1, f->stream), mark = iso_text_mark(word, got);
    ISO_TRY(iso_file_check_text(f->path, word, got, &f->problem));
    memmove(word, word + mark, got - mark);
    if (got - mark + fread(word + got - mark, 1, mark, f->stream) != sizeof magic - 1 ||
        memcmp(word, magic, sizeof magic - 1) != 0)
        return bad(f, "it does not begin with '# vtk DataFile'");
    iso_format_skip_line(f->stream);
    iso_format_skip_line(f->stream); /* the title */
    if (!next_word(f->stream, word)) return ends(f, "its header");
    f->binary = word_is(word, "BINARY");
    if (!f->binary && !word_is(word, "ASCII")) return bad(f, "neither ASCII nor BINARY");
    while (!f->enough && next_word(f->stream, word)) ISO_TRY(take_keyword(f, word));
    return f->array_count ? ISO_OK : ends(f, "its header");
}

static void close_vtk(vtk_file *f) {
    fclose(f->stream);
    iso_rectilinear_free(&f->axes);
}

/* Opens a file and reads its header; the stream stays open for read_array. An error after the first arrays is
 * only recorded, so that the header of a truncated file can be shown. */
static iso_status open_vtk(const char *path, const iso_volume_opts *opts, vtk_file *f, iso_error *error) {
    *f = (vtk_file){.path = path, .spacing = {1, 1, 1}, .wants_all = opts->grid || opts->component_axes};
    ISO_TRY(iso_file_open(path, &f->stream, &f->bytes, error));
    f->complete = scan_arrays(f);
    if (f->complete == ISO_OK || f->array_count) return ISO_OK;
    close_vtk(f);
    return iso_fail(error, f->complete, "%s", f->problem.text);
}

/* What the coordinates of a rectilinear grid change. */
static iso_status describe_axes(vtk_file *f, bool cells, iso_volume_info *info, iso_error *error) {
    for (int i = 0; i < 3; i++)
        if ((uint64_t)f->axes.count[i] != f->dims[i])
            return iso_fail(error, ISO_ERR_FORMAT,
                            "%s: not a readable VTK file: %d coordinates for %llu points on axis %d", f->path,
                            f->axes.count[i], (unsigned long long)f->dims[i], i);
    if (cells) iso_rectilinear_take_cells(&f->axes);
    for (int i = 0; i < 3; i++) info->transform.origin[i] = f->axes.axis[i][0];
    return ISO_OK;
}

static iso_status describe(vtk_file *f, const iso_volume_opts *opts, iso_volume_info *info, int *chosen,
                           iso_error *error) {
    for (int i = 0; i < 3; i++) {
        double step = f->spacing[i];
        info->transform.spacing[i] = step < 0 ? -step : step;
        info->transform.direction[4 * i] = step < 0 ? -1 : 1;
        info->transform.origin[i] = f->origin[i];
    }
    iso_format_image image = {{f->dims[0], f->dims[1], f->dims[2]}, f->arrays, f->array_count};
    ISO_TRY(iso_format_dims(f->path, f->dims, info, error));
    ISO_TRY(iso_format_take_array(f->path, opts, &image, info, chosen, error));
    return f->rectilinear ? describe_axes(f, f->arrays[*chosen].cells, info, error) : ISO_OK;
}

static iso_format_stream stream_of(const vtk_file *f, int chosen, int component) {
    const iso_format_array *array = &f->arrays[chosen];
    bool swap = f->binary && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
    return (iso_format_stream){
        .scalar = array->scalar, .components = (int)array->components, .component = component, .swap = swap};
}

static iso_status vtk_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    vtk_file f;
    ISO_TRY(open_vtk(path, opts, &f, error));
    int chosen = 0;
    iso_status status = describe(&f, opts, info, &chosen, error);
    iso_format_stream stream = {0};
    if (status == ISO_OK) stream = stream_of(&f, chosen, info->component);
    if (status == ISO_OK) {
        iso_format_stream_room(&stream, info);
        *opts->axes = f.axes;
        f.axes = (iso_rectilinear){.count = {0, 0, 0}};
    }
    close_vtk(&f);
    return status;
}

/* ---- voxels ---- */

typedef struct source {
    vtk_file *file;
    iso_scalar scalar;
} source;

static iso_status read_bytes(void *context, void *target, size_t bytes, iso_error *error) {
    const source *s = context;
    FILE *stream = s->file->stream;
    bool complete = s->file->binary ? fread(target, 1, bytes, stream) == bytes
                                    : iso_format_read_numbers(stream, "", s->scalar,
                                                              bytes / iso_scalar_size(s->scalar), target);
    if (complete) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: %s in its array", s->file->path,
                    feof(stream) ? "the file ends" : "something else than a number stands");
}

static FILE *plain_file(void *context, uint64_t bytes) {
    (void)bytes;
    const source *s = context;
    return s->file->binary ? s->file->stream : NULL;
}

static iso_status read_array(vtk_file *f, const iso_volume_opts *opts, const iso_volume_info *info,
                             iso_grid *grid, iso_error *error) {
    iso_volume_info now = {.transform = iso_transform_identity()};
    int chosen = 0;
    ISO_TRY(describe(f, opts, &now, &chosen, error));
    bool same = now.type == info->type && now.component == info->component;
    for (int i = 0; i < 3; i++) same = same && now.dims[i] == info->dims[i];
    if (!same) return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", f->path);
    if (fseeko(f->stream, (off_t)f->positions[chosen], SEEK_SET) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", f->path, strerror(errno));
    iso_format_stream stream = stream_of(f, chosen, info->component);
    source from = {f, stream.scalar};
    stream.fill = read_bytes;
    stream.context = &from;
    stream.plain = plain_file;
    return iso_format_read_stream(f->path, opts, info, &stream, grid, error);
}

static iso_status vtk_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    vtk_file f;
    ISO_TRY(open_vtk(path, opts, &f, error));
    iso_status status = f.complete;
    if (status == ISO_ERR_IO)
        iso_fail(error, status, "%s", f.problem.text);
    else
        status = read_array(&f, opts, info, grid, error);
    close_vtk(&f);
    return status;
}

const iso_format iso_format_vtk = {"vtk", "isopoint", NULL, vtk_info, vtk_read, NULL};
