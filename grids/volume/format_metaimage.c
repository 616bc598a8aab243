/* format_metaimage: MetaImage (.mha and .mhd): lines "Key = Value" and then voxels, raw, deflated or as text,
 * in the same file, in another one, in a list or in a numbered sequence of files.
 *
 * Not read by VTK's MetaIO, which returns a full-sized array also when the data ends early, and prints
 * messages to standard output.
 *
 * World. As ITK reads it, which writes most of these files: TransformMatrix is in LPS and lists one index
 * axis' direction after the other, Offset is the first voxel's centre. AnatomicalOrientation repeats in words
 * what the matrix says, so it counts only without a matrix. Its letters say from where an axis comes: in
 * MetaIO's source R is "right to left", and ITK writes RAI for the identity. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "grids/volume/format.h"

enum { MAX_DIMS = 10, MAX_LINE = 4096, MAX_LINES = 1000, MAX_PART = 1 << 20 };

typedef struct meta_header {
    int ndims;
    uint64_t dims[MAX_DIMS];
    double spacing[MAX_DIMS], offset[MAX_DIMS], matrix[MAX_DIMS * MAX_DIMS];
    bool has_spacing, has_matrix, has_type;
    char orientation[MAX_DIMS + 1];
    char type[32];
    iso_scalar scalar;
    uint64_t channels;
    bool text, big_endian, deflated;
    int64_t skip; /* HeaderSize; -1: the data is at the file's end */
    double slope, intercept;
    char data[MAX_LINE]; /* ElementDataFile */
    uint64_t after;      /* position after its line */
} meta_header;

/* ---- header ---- */

static void trim(char **text) {
    while (isspace((unsigned char)**text)) (*text)++;
    size_t length = strlen(*text);
    while (length && isspace((unsigned char)(*text)[length - 1])) (*text)[--length] = 0;
}

/* Parses up to `count` numbers; returns how many there are. */
static int parse_numbers(const char *text, int count, double *numbers) {
    for (int i = 0; i < count; i++) {
        char *end;
        double number = strtod(text, &end);
        if (end == text) return i;
        numbers[i] = number;
        text = end;
    }
    return count;
}

static bool parse_sizes(const char *text, int count, uint64_t *sizes) {
    for (int i = 0; i < count; i++) {
        while (isspace((unsigned char)*text)) text++;
        if (!isdigit((unsigned char)*text)) return false;
        char *end;
        errno = 0;
        sizes[i] = strtoull(text, &end, 10);
        if (errno || (*end && !isspace((unsigned char)*end))) return false;
        text = end;
    }
    return true;
}

/* Parses an integer from -1 on; false if there is anything else in the text. */
static bool parse_offset(const char *text, int64_t *offset) {
    char *end;
    errno = 0;
    *offset = strtoll(text, &end, 10);
    return end != text && !*end && errno == 0 && *offset >= -1;
}

static bool parse_type(const char *text, meta_header *header) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } types[] = {{"MET_UCHAR", ISO_SCALAR_UINT8},       {"MET_CHAR", ISO_SCALAR_INT8},
                 {"MET_USHORT", ISO_SCALAR_UINT16},     {"MET_SHORT", ISO_SCALAR_INT16},
                 {"MET_UINT", ISO_SCALAR_UINT32},       {"MET_INT", ISO_SCALAR_INT32},
                 {"MET_ULONG", ISO_SCALAR_UINT32},      {"MET_LONG", ISO_SCALAR_INT32},
                 {"MET_ULONG_LONG", ISO_SCALAR_UINT64}, {"MET_LONG_LONG", ISO_SCALAR_INT64},
                 {"MET_FLOAT", ISO_SCALAR_FLOAT},       {"MET_DOUBLE", ISO_SCALAR_DOUBLE}};
    snprintf(header->type, sizeof header->type, "%s", text);
    size_t length = strlen(text);
    if (length > 6 && strcasecmp(text + length - 6, "_ARRAY") == 0) length -= 6;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (strlen(types[i].name) != length || strncasecmp(text, types[i].name, length) != 0) continue;
        header->scalar = types[i].scalar;
        return header->has_type = true;
    }
    return true; /* reported later, when the whole header has been read */
}

static bool is_true(const char *text) {
    return *text == 'T' || *text == 't' || *text == '1' || *text == 'Y' || *text == 'y';
}

static bool key_is(const char *key, const char *name) {
    return strcasecmp(key, name) == 0;
}

/* Parses a key about sizes and positions. *known: the key is one of these. False: its value is wrong. */
static bool parse_geometry(const char *key, const char *value, meta_header *header, bool *known) {
    int n = header->ndims;
    *known = true;
    if (key_is(key, "DimSize")) return n > 0 && parse_sizes(value, n, header->dims);
    if (key_is(key, "ElementSpacing")) {
        header->has_spacing = true;
        return parse_numbers(value, n, header->spacing) == n;
    }
    if (key_is(key, "ElementSize")) /* the size of a voxel, used when there is no spacing */
        return header->has_spacing || parse_numbers(value, n, header->spacing) == n;
    if (key_is(key, "Offset") || key_is(key, "Position") || key_is(key, "Origin"))
        return parse_numbers(value, n, header->offset) == n;
    if (key_is(key, "TransformMatrix") || key_is(key, "Rotation") || key_is(key, "Orientation")) {
        header->has_matrix = true;
        return parse_numbers(value, n * n, header->matrix) == n * n;
    }
    if (key_is(key, "AnatomicalOrientation")) {
        snprintf(header->orientation, sizeof header->orientation, "%s", value);
        return true;
    }
    *known = false;
    return true;
}

/* Parses a key about the storage of voxels; false: its value is wrong. */
static bool parse_storage(const char *key, const char *value, meta_header *header) {
    if (key_is(key, "ElementType")) return parse_type(value, header);
    if (key_is(key, "ElementNumberOfChannels"))
        return parse_sizes(value, 1, &header->channels) && header->channels >= 1;
    if (key_is(key, "BinaryData")) header->text = !is_true(value);
    if (key_is(key, "BinaryDataByteOrderMSB") || key_is(key, "ElementByteOrderMSB"))
        header->big_endian = is_true(value);
    if (key_is(key, "CompressedData")) header->deflated = is_true(value);
    if (key_is(key, "HeaderSize")) return parse_offset(value, &header->skip);
    if (key_is(key, "ElementToIntensityFunctionSlope")) return parse_numbers(value, 1, &header->slope) == 1;
    if (key_is(key, "ElementToIntensityFunctionOffset"))
        return parse_numbers(value, 1, &header->intercept) == 1;
    return true;
}

static bool take_line(const char *key, const char *value, meta_header *header) {
    if (key_is(key, "ObjectType")) return key_is(value, "Image");
    if (key_is(key, "NDims")) {
        uint64_t n = 0;
        if (!parse_sizes(value, 1, &n) || n < 1 || n > MAX_DIMS) return false;
        header->ndims = (int)n;
        return true;
    }
    bool known;
    if (!parse_geometry(key, value, header, &known)) return false;
    return known || parse_storage(key, value, header);
}

static iso_status parse_lines(const char *path, FILE *file, meta_header *header, iso_error *error) {
    char line[MAX_LINE];
    for (int i = 0; i < MAX_LINES && fgets(line, sizeof line, file); i++) {
        if (!strchr(line, '\n')) iso_format_skip_line(file); /* a long comment */
        size_t end = strcspn(line, "=:");
        const size_t mark = i ? 0 : iso_text_mark(line, strlen(line));
        if (i == 0) ISO_TRY(iso_file_check_text(path, line, strlen(line), error));
        char *key = line + mark, *value = line + end;
        if (*value) *value++ = 0;
        trim(&key);
        trim(&value);
        if (!*key) continue;
        if (line[end] == 0 && value == line + end)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: not a MetaImage: '%.40s' has no value", path, key);
        if (key_is(key, "ElementDataFile")) {
            snprintf(header->data, sizeof header->data, "%s", value);
            header->after = (uint64_t)ftello(file);
            return ISO_OK;
        }
        if (!take_line(key, value, header))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: not a MetaImage: %.40s = %.80s", path, key, value);
    }
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a MetaImage: ElementDataFile is missing", path);
}

static iso_status read_meta(const char *path, meta_header *header, iso_error *error) {
    *header = (meta_header){.channels = 1, .slope = 1};
    for (int i = 0; i < MAX_DIMS; i++) header->spacing[i] = header->dims[i] = 1;
    FILE *file = NULL;
    ISO_TRY(iso_file_open(path, &file, NULL, error));
    iso_status status = parse_lines(path, file, header, error);
    fclose(file);
    ISO_TRY(status);
    const char *missing = !header->ndims ? "NDims" : !*header->type ? "ElementType" : NULL;
    if (missing) return iso_fail(error, ISO_ERR_FORMAT, "%s: not a MetaImage: %s is missing", path, missing);
    if (!header->has_type)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: unknown ElementType %s", path, header->type);
    if (!*header->data) return iso_fail(error, ISO_ERR_FORMAT, "%s: names no ElementDataFile", path);
    return ISO_OK;
}

/* ---- from header to volume ---- */

/* The direction of an axis from a letter of AnatomicalOrientation; false for "?". */
static bool letter_direction(char letter, double direction[3]) {
    const char *letters = "RLAPIS", *found = strchr(letters, toupper((unsigned char)letter));
    if (!letter || !found) return false;
    int index = (int)(found - letters);
    direction[index / 2] = index % 2 ? -1 : 1;
    return true;
}

static void take_transform(const meta_header *header, iso_volume_info *info) {
    iso_transform *transform = &info->transform;
    int n = header->ndims, used = n < 3 ? n : 3;
    bool lettered = true;
    double words[9] = {0};
    for (int axis = 0; axis < 3; axis++)
        lettered = lettered && letter_direction(header->orientation[axis], words + 3 * axis);
    for (int axis = 0; axis < used; axis++) {
        double step = header->spacing[axis];
        transform->spacing[axis] = step < 0 ? -step : step;
        transform->origin[axis] = header->offset[axis];
        for (int i = 0; i < 3; i++) {
            double *d = &transform->direction[3 * i + axis];
            if (header->has_matrix)
                *d = i < n ? header->matrix[axis * n + i] : 0;
            else if (lettered)
                *d = words[3 * axis + i];
            if (step < 0) *d = -*d;
        }
        iso_vec3 unit = iso_vec3_unit(iso_vec3_make(
            transform->direction[axis], transform->direction[3 + axis], transform->direction[6 + axis]));
        transform->direction[axis] = unit.x;
        transform->direction[3 + axis] = unit.y;
        transform->direction[6 + axis] = unit.z;
    }
    info->anatomical = n >= 3 && (header->has_matrix || lettered);
}

static iso_format_stream stream_of(const meta_header *header, int component) {
    bool swap = header->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    return (iso_format_stream){.scalar = header->scalar,
                               .components = (int)header->channels,
                               .component = component % (int)header->channels,
                               .swap = swap && !header->text};
}

/* The number of components: channels are interleaved, and axes beyond the third count as further components.
 */
static iso_status count_components(const char *path, const meta_header *header, uint64_t *components,
                                   iso_error *error) {
    *components = header->channels;
    for (int i = 3; i < header->ndims; i++)
        if (header->dims[i] == 0 || __builtin_mul_overflow(*components, header->dims[i], components))
            *components = UINT64_MAX;
    if (*components > INT_MAX)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: cannot have that many components", path);
    return ISO_OK;
}

static void list_data_files(const char *path, const meta_header *header, iso_file_set *files);
static bool is_local(const char *data);

static iso_status meta_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    meta_header header;
    ISO_TRY(read_meta(path, &header, error));
    list_data_files(path, &header, opts->files);
    ISO_TRY(iso_format_dims(path, header.dims, info, error));
    uint64_t components = 1;
    ISO_TRY(count_components(path, &header, &components, error));
    ISO_TRY(iso_format_component(path, opts, (int)components, info, error));
    info->type = iso_scalar_stored_type(header.scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(header.scalar));
    take_transform(&header, info);
    if (header.slope > 0 && header.slope < HUGE_VAL) {
        info->scale = header.slope;
        info->offset = header.intercept;
    } else {
        iso_volume_note(info, "ElementToIntensityFunctionSlope %g is not used", header.slope);
    }
    iso_format_stream stream = stream_of(&header, info->component);
    iso_format_stream_room(&stream, info);
    const bool planes = header.channels == 1;
    if (is_local(header.data) && !header.deflated && !header.text && (planes || header.ndims <= 3))
        *opts->place = (iso_format_place){.told = true,
                                          .swap = stream.swap,
                                          .separate = planes,
                                          .scalar = header.scalar,
                                          .position = header.after};
    return ISO_OK;
}

/* ---- voxels: a chain of files that is read like one file ---- */

typedef struct chain {
    const char *path;
    const meta_header *header;
    uint64_t each; /* unpacked bytes in each file */
    uint64_t files;
    FILE *list;         /* of a LIST: the header file, at the next name */
    char pattern[1024]; /* of numbered files: the printf format of their names */
    int64_t first, step;
    uint64_t opened; /* files opened so far */
    char *name;      /* of the current file, owned */
    FILE *file;
    uint64_t left;          /* unpacked bytes of it that are not read yet */
    iso_inflater *inflater; /* when it is deflated */
} chain;

static void close_file(chain *c) {
    iso_inflater_destroy(c->inflater);
    c->inflater = NULL;
    if (c->file) fclose(c->file);
    c->file = NULL;
    free(c->name);
    c->name = NULL;
}

static void close_chain(chain *c) {
    close_file(c);
    if (c->list) fclose(c->list);
    iso_free(c);
}

/* Whether a pattern has exactly one %d, %i or %u, with or without a width, and no other %. */
static bool is_safe_pattern(const char *text) {
    const char *percent = strchr(text, '%');
    if (!percent) return false;
    const char *end = percent + 1 + strspn(percent + 1, "0123456789");
    return end - percent <= 4 && (*end == 'd' || *end == 'i' || *end == 'u') && !strchr(end, '%');
}

/* Prepares numbered files: "name%03d.raw 1 90 1" (first, last, step). */
static iso_status open_pattern(chain *c, iso_error *error) {
    char text[MAX_LINE];
    snprintf(text, sizeof text, "%s", c->header->data);
    double range[3] = {1, 0, 1}; /* first, last, step */
    char *space = text + strcspn(text, " \t");
    int given = *space ? parse_numbers(space + 1, 3, range) : 0;
    *space = 0;
    bool in_range = range[0] >= 0 && range[0] < 1e9 && range[2] >= 1 && range[2] < 1e9;
    if (!is_safe_pattern(text) || strlen(text) >= sizeof c->pattern || !in_range)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: '%.80s' names no sequence of files", c->path,
                        c->header->data);
    if (given >= 2 && (range[1] - range[0]) / range[2] + 1 < (double)c->files)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: '%.80s' names fewer than %llu files", c->path,
                        c->header->data, (unsigned long long)c->files);
    strcpy(c->pattern, text);
    char *place = strchr(c->pattern, '%');
    place += strcspn(place, "diu");
    *place = 'd';
    c->first = (int64_t)range[0];
    c->step = (int64_t)range[2];
    return ISO_OK;
}

/* Splits the voxels over files: `dims_in_file` axes lie in each. */
static void split_over_files(chain *c, int dims_in_file) {
    for (int i = dims_in_file; i < c->header->ndims; i++) {
        c->each /= c->header->dims[i];
        c->files *= c->header->dims[i];
    }
}

/* Prepares a list: "LIST" or "LIST 2" (axes in each file), after which a name follows on each line. */
static iso_status open_list(chain *c, iso_error *error) {
    double dims_in_file = c->header->ndims - 1;
    parse_numbers(c->header->data + 4, 1, &dims_in_file);
    if (!(dims_in_file >= 1 && dims_in_file <= c->header->ndims))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a list: '%.80s'", c->path, c->header->data);
    split_over_files(c, (int)dims_in_file);
    ISO_TRY(iso_file_open(c->path, &c->list, NULL, error));
    if (fseeko(c->list, (off_t)c->header->after, SEEK_SET) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", c->path, strerror(errno));
    return ISO_OK;
}

static bool is_list(const char *data) {
    return strncmp(data, "LIST", 4) == 0 && (!data[4] || isspace((unsigned char)data[4]));
}

static bool is_local(const char *data) {
    return strcasecmp(data, "LOCAL") == 0;
}

static iso_status open_chain(chain *c, iso_error *error) {
    const char *data = c->header->data;
    c->files = 1;
    if (is_list(data)) return open_list(c, error);
    if (is_local(data) || !strchr(data, '%')) return ISO_OK;
    split_over_files(c, c->header->ndims - 1);
    return open_pattern(c, error);
}

static iso_status next_name(chain *c, iso_error *error) {
    char line[MAX_LINE];
    char *name = line;
    if (c->list) {
        if (!fgets(line, sizeof line, c->list))
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: names %llu of %llu data files", c->path,
                            (unsigned long long)c->opened, (unsigned long long)c->files);
        trim(&name);
    } else if (*c->pattern) {
        long long number = c->first + (int64_t)c->opened * c->step;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral" /* checked by is_safe_pattern */
        snprintf(line, sizeof line, c->pattern, (int)number);
#pragma GCC diagnostic pop
    } else {
        snprintf(line, sizeof line, "%s", c->header->data);
    }
    c->name = is_local(c->header->data) ? strdup(c->path) : iso_format_beside(c->path, name);
    if (!c->name) return iso_fail_memory(error, c->path);
    return ISO_OK;
}

/* Finds the position of the voxels in a file of `bytes` bytes. Raw data must be complete. */
static iso_status find_start(chain *c, uint64_t bytes, uint64_t *start, iso_error *error) {
    const meta_header *header = c->header;
    bool raw = !header->deflated && !header->text;
    *start = is_local(header->data) ? header->after : header->skip > 0 ? (uint64_t)header->skip : 0;
    if (raw && header->skip == -1 && !is_local(header->data) && bytes >= c->each) *start = bytes - c->each;
    if (raw && (bytes < *start || bytes - *start < c->each))
        return iso_format_truncated(c->name, bytes, *start + c->each, error);
    return ISO_OK;
}

static iso_status open_next(chain *c, iso_error *error) {
    close_file(c);
    ISO_TRY(next_name(c, error));
    uint64_t start = 0, bytes = 0;
    ISO_TRY(iso_file_open(c->name, &c->file, &bytes, error));
    ISO_TRY(find_start(c, bytes, &start, error));
    if (fseeko(c->file, (off_t)start, SEEK_SET) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", c->name, strerror(errno));
    c->opened++;
    c->left = c->each;
    if (!c->header->deflated) return ISO_OK;
    return iso_inflater_create(c->name, c->file, c->each, &c->inflater, error);
}

static iso_status fill_packed(chain *c, void *target, size_t bytes, iso_error *error) {
    ISO_TRY(iso_inflater_fill(c->inflater, target, bytes, error));
    return c->left == bytes ? iso_inflater_finish(c->inflater, NULL, error) : ISO_OK;
}

static iso_status fill_text(chain *c, void *target, size_t bytes, iso_error *error) {
    size_t size = iso_scalar_size(c->header->scalar);
    if (iso_format_read_numbers(c->file, "", c->header->scalar, bytes / size, target)) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: fewer than %llu numbers", c->name,
                    (unsigned long long)(c->each / size));
}

static iso_status fill_raw(chain *c, void *target, size_t bytes, iso_error *error) {
    if (fread(target, 1, bytes, c->file) == bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", c->name,
                    ferror(c->file) ? strerror(errno) : "the file ends too early");
}

static iso_status read_bytes(void *context, void *target, size_t bytes, iso_error *error) {
    chain *c = context;
    for (char *at = target; bytes;) {
        if (c->left == 0) ISO_TRY(open_next(c, error));
        size_t part = bytes < MAX_PART ? bytes : MAX_PART;
        if (part > c->left) part = (size_t)c->left;
        if (c->header->text)
            ISO_TRY(fill_text(c, at, part, error));
        else if (c->header->deflated)
            ISO_TRY(fill_packed(c, at, part, error));
        else
            ISO_TRY(fill_raw(c, at, part, error));
        c->left -= part;
        at += part;
        bytes -= part;
    }
    return ISO_OK;
}

static FILE *plain_file(void *context, uint64_t bytes) {
    chain *c = context;
    if (c->header->text || c->header->deflated || (c->left == 0 && open_next(c, NULL) != ISO_OK) ||
        c->left < bytes)
        return NULL;
    c->left -= bytes;
    return c->file;
}

/* Skips components that are not wanted, by reading them, so that a file that lacks them is noticed. */
static iso_status skip_voxels(chain *c, uint64_t bytes, iso_error *error) {
    char scratch[1 << 14]; /* a multiple of every scalar's size */
    while (bytes) {
        if (!c->header->text && !c->header->deflated && c->left) {
            uint64_t part = bytes < c->left ? bytes : c->left;
            if (fseeko(c->file, (off_t)part, SEEK_CUR) != 0)
                return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", c->name, strerror(errno));
            c->left -= part;
            bytes -= part;
            continue;
        }
        size_t part = bytes < sizeof scratch ? (size_t)bytes : sizeof scratch;
        if (c->left == 0) {
            ISO_TRY(open_next(c, error));
            continue;
        }
        if (part > c->left) part = (size_t)c->left;
        ISO_TRY(read_bytes(c, scratch, part, error));
        bytes -= part;
    }
    return ISO_OK;
}

static iso_status read_chain(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                             chain *c, iso_grid *grid, iso_error *error) {
    const meta_header *header = c->header;
    iso_format_stream stream = stream_of(header, info->component);
    stream.fill = read_bytes;
    stream.context = c;
    stream.plain = plain_file;
    uint64_t volume = iso_format_size(info->dims, iso_scalar_size(header->scalar) * header->channels);
    uint64_t volumes = (uint64_t)info->components / header->channels;
    uint64_t chosen = (uint64_t)info->component / header->channels;
    if (__builtin_mul_overflow(volume, volumes, &c->each) || c->each > INT64_MAX - header->after)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: too many volumes in one file", path);
    ISO_TRY(open_chain(c, error));
    ISO_TRY(skip_voxels(c, chosen * volume, error));
    ISO_TRY(iso_format_read_stream(path, opts, info, &stream, grid, error));
    iso_status status = skip_voxels(c, (volumes - chosen - 1) * volume, error);
    if (status != ISO_OK) iso_grid_destroy(grid);
    return status;
}

/* Adds the data files to the set, up to the first one that does not exist. */
static void list_data_files(const char *path, const meta_header *header, iso_file_set *files) {
    if (!files || is_local(header->data)) return;
    chain *c = iso_alloc_zero(1, sizeof *c);
    files->incomplete = files->incomplete || !c;
    if (!c) return;
    c->path = path;
    c->header = header;
    bool there = open_chain(c, NULL) == ISO_OK;
    for (; there && c->opened < c->files; c->opened++) {
        there = next_name(c, NULL) == ISO_OK && access(c->name, F_OK) == 0;
        if (there) iso_file_set_read(files, c->name);
        close_file(c);
    }
    close_chain(c);
}

static iso_status meta_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_grid *grid, iso_error *error) {
    meta_header header;
    ISO_TRY(read_meta(path, &header, error));
    uint64_t components = 0;
    ISO_TRY(count_components(path, &header, &components, error));
    bool same = components == (uint64_t)info->components;
    for (int i = 0; i < 3; i++) same = same && header.dims[i] == (uint64_t)info->dims[i];
    if (!same) return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    chain *c = iso_alloc_zero(1, sizeof *c);
    if (!c) return iso_fail_memory(error, path);
    c->path = path;
    c->header = &header;
    iso_grid result = {0};
    iso_status status = read_chain(path, opts, info, c, &result, error);
    close_chain(c);
    if (status == ISO_OK) *grid = result;
    return status;
}

const iso_format iso_format_metaimage = {"metaimage", "isopoint", NULL, meta_info, meta_read, NULL};
