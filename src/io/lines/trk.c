/* trk: streamlines as TrackVis writes them (trackvis.org, "File format", versions 1 and 2): a header of 1000
 * bytes, then for each line the number of its points, the points with their scalars, and its properties.
 *
 * Points are in voxels multiplied by the voxel size. They count from the outer corner of the first voxel,
 * along the axes that voxel_order states. vox_to_ras maps voxel centres to RAS mm, but its voxel axes may be
 * in another order or direction, so both orders are compared, as NiBabel does (nibabel/streamlines/trk.py).
 * If vox_to_ras is missing (version 1, or its last number is 0), the axes are those of voxel_order, and the
 * unknown position of the first voxel's centre is taken to be 0.
 *
 * The header's number of lines may be 0, for "not counted". If it is smaller than the actual number this is
 * reported; if it is larger the file was cut off. */
#include "io/lines/lines_format.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/common/line_sink.h"
#include "io/common/stream.h"

enum { HEADER = 1000, NAMES = 10, NAME = 20 };
/* Positions of the header's members. */
enum {
    AT_DIM = 6,
    AT_VOXEL_SIZE = 12,
    AT_SCALARS = 36,
    AT_SCALAR_NAMES = 38,
    AT_PROPERTIES = 238,
    AT_PROPERTY_NAMES = 240,
    AT_VOX_TO_RAS = 440,
    AT_VOXEL_ORDER = 948,
    AT_COUNT = 988,
    AT_VERSION = 992,
    AT_HEADER_SIZE = 996
};

typedef struct trk {
    iso_stream in;
    unsigned char header[HEADER];
    bool swap;               /* the file's byte order is not the machine's */
    double to_ras[12];       /* from the file's coordinates to RAS mm, rows of a 3 x 4 matrix */
    int scalars, properties; /* how many numbers each point has, and each line */
    uint64_t count, line; /* number of lines that the header states (0: not counted); number of lines begun */
    iso_column columns[2 * NAMES];
    /* The place of number i of a point, or of a line: a column and a component of it. */
    struct slot {
        iso_column *column;
        int component;
    } scalar_slots[NAMES], property_slots[NAMES];
    iso_line_sink lines;
} trk;

/* ---- numbers */

static uint32_t load_bits(const trk *t, const unsigned char *bytes) {
    uint32_t bits;
    memcpy(&bits, bytes, sizeof bits);
    return t->swap ? __builtin_bswap32(bits) : bits;
}

static float load_float(const trk *t, const unsigned char *bytes) {
    const uint32_t bits = load_bits(t, bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int load_short(const trk *t, const unsigned char *bytes) {
    uint16_t bits;
    memcpy(&bits, bytes, sizeof bits);
    return (int16_t)(t->swap ? __builtin_bswap16(bits) : bits);
}

static iso_status fail_header(const trk *t, const char *problem, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged .trk header: %s", t->in.path, problem);
}

/* ---- space */

/* The world axis along which a voxel axis runs, and its sign: -1 from right to left, and so on. */
typedef struct voxel_axis {
    int world, sign;
} voxel_axis;

/* Parses voxel_order, such as "LPS". When it is empty, TrackVis uses LPS. */
static bool parse_order(const unsigned char *text, voxel_axis axes[3]) {
    static const char letters[] = "LRPAIS"; /* the ends of the world's axes: of x L and R, .. */
    bool used[3] = {false};
    if (text[0] == 0 || text[0] == ' ') text = (const unsigned char *)"LPS";
    for (int i = 0; i < 3; i++) {
        const char *found = text[i] ? strchr(letters, toupper(text[i])) : NULL;
        if (!found) return false;
        const int letter = (int)(found - letters);
        axes[i] = (voxel_axis){letter / 2, letter % 2 ? 1 : -1};
        if (used[letter / 2]) return false;
        used[letter / 2] = true;
    }
    return true;
}

/* Finds for each column of the matrix the nearest world axis; each axis is used once, the first column
 * chooses first. */
static void nearest_axes(const double m[12], voxel_axis axes[3]) {
    bool used[3] = {false};
    for (int column = 0; column < 3; column++) {
        int best = -1;
        for (int row = 0; row < 3; row++) {
            const double size = fabs(m[4 * row + column]);
            if (!used[row] && (best < 0 || size > fabs(m[4 * best + column]))) best = row;
        }
        axes[column] = (voxel_axis){best, m[4 * best + column] < 0 ? -1 : 1};
        used[best] = true;
    }
}

static bool is_singular(const double m[12]) {
    iso_vec3 columns[3];
    double product = 1;
    for (int i = 0; i < 3; i++) {
        columns[i] = iso_vec3_make(m[i], m[4 + i], m[8 + i]);
        product *= iso_vec3_length(columns[i]);
    }
    const double determinant = iso_vec3_dot(columns[0], iso_vec3_cross(columns[1], columns[2]));
    return !(fabs(determinant) > 1e-12 * product && product > 0 && isfinite(product));
}

/* Loads the file's own matrix, from voxel centres to RAS, or makes one that agrees with the order if there is
 * none. */
static bool load_matrix(const trk *t, const voxel_axis order[3], const double voxel[3], double m[12]) {
    const int version = (int)load_bits(t, t->header + AT_VERSION);
    const unsigned char *at = t->header + AT_VOX_TO_RAS;
    const bool recorded = version >= 2 && load_float(t, at + 60) != 0;
    for (int i = 0; i < 12; i++) m[i] = recorded ? (double)load_float(t, at + 4 * i) : 0;
    for (int i = 0; i < 3 && !recorded; i++) m[4 * order[i].world + i] = order[i].sign * voxel[i];
    return recorded;
}

/* Composes t->to_ras. The point p is the voxel p / size - 0.5 in the axes of voxel_order, which are then
 * permuted and reversed to those of the matrix. */
static void compose(trk *t, const double m[12], const voxel_axis order[3], const double voxel[3]) {
    voxel_axis own[3];
    nearest_axes(m, own);
    for (int row = 0; row < 3; row++) t->to_ras[4 * row + 3] = m[4 * row + 3];
    for (int axis = 0; axis < 3; axis++) {
        int to = 0; /* the axis of the matrix's voxels along the same world axis */
        while (own[to].world != order[axis].world) to++;
        const bool turned = own[to].sign != order[axis].sign;
        const double scale = (turned ? -1 : 1) / voxel[axis];
        const double last = load_short(t, t->header + AT_DIM + 2 * axis) - 1;
        const double shift = turned ? last + 0.5 : -0.5;
        for (int row = 0; row < 3; row++) {
            t->to_ras[4 * row + axis] = m[4 * row + to] * scale;
            t->to_ras[4 * row + 3] += m[4 * row + to] * shift;
        }
    }
}

static iso_status read_space(trk *t, iso_error *error) {
    double voxel[3], m[12];
    voxel_axis order[3];
    for (int i = 0; i < 3; i++) {
        voxel[i] = (double)load_float(t, t->header + AT_VOXEL_SIZE + 4 * i);
        if (!(voxel[i] > 0 && isfinite(voxel[i])))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged .trk header: a voxel size of %g", t->in.path,
                            voxel[i]);
    }
    if (!parse_order(t->header + AT_VOXEL_ORDER, order))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged .trk header: a voxel order of '%.3s'", t->in.path,
                        (const char *)t->header + AT_VOXEL_ORDER);
    if (!load_matrix(t, order, voxel, m))
        iso_reading_note(t->lines.reading, "the header has no vox_to_ras: the position in space is unknown");
    if (is_singular(m)) return fail_header(t, "vox_to_ras is singular", error);
    compose(t, m, order, voxel);
    for (int i = 0; i < 12; i++)
        if (!isfinite(t->to_ras[i]))
            return fail_header(t, "vox_to_ras has numbers that are not finite", error);
    return ISO_OK;
}

/* ---- scalars and properties */

/* Returns for how many numbers a name stands: digits may follow the zero byte that ends the name. */
static int count_of_name(const unsigned char *name) {
    const unsigned char *end = memchr(name, 0, NAME);
    if (name[0] == 0) return 0;
    const int digit = end && end + 1 < name + NAME ? end[1] - '0' : 1;
    return digit >= 1 && digit <= 9 ? digit : 1;
}

/* Copies a name without the blanks that pad it. */
static void copy_name(const unsigned char *name, char copy[ISO_COLUMN_NAME]) {
    memcpy(copy, name, NAME);
    copy[NAME] = 0;
    for (size_t length = strlen(copy); length && copy[length - 1] == ' ';) copy[--length] = 0;
}

/* Assigns a slot to each number. Numbers that share a name, or have equal names one after the other, are
 * components of one column; numbers without a name share a last column. */
static void name_columns(trk *t, const unsigned char *names, int numbers, bool per_line, struct slot *slots) {
    iso_column *last = NULL;
    for (int i = 0, next = 0, left = 0; i < numbers; i++, left--) {
        char name[ISO_COLUMN_NAME] = "";
        if (left <= 0 && next < NAMES && (left = count_of_name(names + NAME * next)) > 0)
            copy_name(names + NAME * next++, name);
        else if (left > 0)
            strcpy(name, last->name);
        if (!*name) strcpy(name, per_line ? "properties" : "scalars");
        if (!last || strcmp(last->name, name) != 0) {
            last = &t->columns[t->lines.column_count++];
            *last = (iso_column){.per_line = per_line};
            strcpy(last->name, name);
        }
        slots[i] = (struct slot){last, last->components++};
    }
}

static void store(const struct slot *slot, size_t item, float value) {
    iso_column *column = slot->column;
    ((float *)column->values.data)[item * (size_t)column->components + (size_t)slot->component] = value;
}

/* ---- header */

static iso_status read_counts(trk *t, iso_error *error) {
    t->scalars = load_short(t, t->header + AT_SCALARS);
    t->properties = load_short(t, t->header + AT_PROPERTIES);
    const int32_t count = (int32_t)load_bits(t, t->header + AT_COUNT);
    if (t->scalars < 0 || t->scalars > NAMES || t->properties < 0 || t->properties > NAMES)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: damaged .trk header: %d scalars and %d properties (there can be 10 of each)",
                        t->in.path, t->scalars, t->properties);
    if (count < 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged .trk header: %d lines", t->in.path, count);
    t->count = (uint64_t)count;
    t->lines.columns = t->columns;
    name_columns(t, t->header + AT_SCALAR_NAMES, t->scalars, false, t->scalar_slots);
    name_columns(t, t->header + AT_PROPERTY_NAMES, t->properties, true, t->property_slots);
    return ISO_OK;
}

static iso_status read_header(trk *t, iso_error *error) {
    if (!iso_stream_fill(&t->in, 5) || memcmp(t->in.buffer, "TRACK", 5) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a .trk file", t->in.path);
    if (!iso_stream_fill(&t->in, HEADER))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated in its header", t->in.path);
    memcpy(t->header, t->in.buffer, HEADER);
    iso_stream_advance(&t->in, HEADER);
    if (load_bits(t, t->header + AT_HEADER_SIZE) != HEADER) t->swap = true;
    const int32_t size = (int32_t)load_bits(t, t->header + AT_HEADER_SIZE),
                  version = (int32_t)load_bits(t, t->header + AT_VERSION);
    if (size != HEADER)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged .trk header: its size is given as %d, not 1000",
                        t->in.path, size);
    if (version != 1 && version != 2)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: .trk version %d, not 1 or 2", t->in.path, version);
    ISO_TRY(read_counts(t, error));
    return read_space(t, error);
}

/* ---- lines */

/* Reads a point with its scalars; there must be room. */
static iso_status take_point(trk *t, const unsigned char *bytes, iso_error *error) {
    double p[3], ras[3];
    for (int i = 0; i < 3; i++) p[i] = (double)load_float(t, bytes + 4 * i);
    for (int row = 0; row < 3; row++) {
        const double *m = t->to_ras + 4 * row;
        ras[row] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
    }
    if (!iso_line_sink_vertex(&t->lines, ras)) {
        t->lines.reading->report->dropped++;
        return iso_line_sink_split(&t->lines, error);
    }
    for (int i = 0; i < t->scalars; i++)
        store(&t->scalar_slots[i], t->lines.vertex_count - 1, load_float(t, bytes + 12 + 4 * i));
    return ISO_OK;
}

static iso_status take_points(trk *t, uint64_t count, iso_error *error) {
    const size_t each = 12 + 4 * (size_t)t->scalars;
    while (count > 0) {
        if (!iso_stream_fill(&t->in, each)) return iso_stream_fail(&t->in, error);
        const unsigned char *bytes = t->in.buffer + t->in.place;
        size_t points = (t->in.end - t->in.place) / each;
        if (points > count) points = (size_t)count;
        ISO_TRY(iso_line_sink_reserve(&t->lines, points, error));
        for (size_t i = 0; i < points; i++) ISO_TRY(take_point(t, bytes + i * each, error));
        iso_stream_advance(&t->in, points * each);
        count -= points;
    }
    return iso_line_sink_split(&t->lines, error);
}

/* Copies the properties of a line of the file to all lines that were made of it. */
static iso_status take_properties(trk *t, iso_error *error) {
    const size_t bytes = 4 * (size_t)t->properties;
    if (!iso_stream_fill(&t->in, bytes)) return iso_stream_fail(&t->in, error);
    for (int i = 0; i < t->properties; i++) {
        const float value = load_float(t, t->in.buffer + t->in.place + 4 * i);
        for (size_t line = t->lines.first_made; line < t->lines.line_count; line++)
            store(&t->property_slots[i], line, value);
    }
    iso_stream_advance(&t->in, bytes);
    return ISO_OK;
}

static iso_status read_line(trk *t, iso_error *error) {
    const uint64_t each = 12 + 4 * (uint64_t)t->scalars, tail = 4 * (uint64_t)t->properties;
    if (!iso_stream_fill(&t->in, 4)) return iso_stream_fail(&t->in, error);
    const int32_t points = (int32_t)load_bits(t, t->in.buffer + t->in.place);
    iso_stream_advance(&t->in, 4);
    if (points < 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: line %llu has %d points", t->in.path,
                        (unsigned long long)t->line, points);
    if ((uint64_t)points * each + tail > t->in.remaining)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: line %llu has %d points", t->in.path,
                        (unsigned long long)t->line, points);
    t->line++;
    iso_line_sink_begin(&t->lines);
    if (t->lines.skips) return iso_stream_skip(&t->in, (uint64_t)points * each + tail, error);
    ISO_TRY(take_points(t, (uint64_t)points, error));
    return take_properties(t, error);
}

static iso_status read_lines(trk *t, iso_error *error) {
    const uint64_t each = 12 + 4 * (uint64_t)t->scalars;
    if (t->lines.reading->opts.every == 1)
        ISO_TRY(iso_line_sink_reserve(&t->lines, (size_t)(t->in.remaining / each), error));
    while (iso_stream_fill(&t->in, 1)) ISO_TRY(read_line(t, error));
    if (ferror(t->in.file)) return iso_stream_fail(&t->in, error);
    if (t->count > t->line)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: %llu of %llu lines", t->in.path,
                        (unsigned long long)t->line, (unsigned long long)t->count);
    if (t->count && t->count < t->line)
        iso_reading_note(t->lines.reading, "the header promises %llu lines, the file has %llu",
                         (unsigned long long)t->count, (unsigned long long)t->line);
    return ISO_OK;
}

static iso_status read_trk(trk *t, iso_reading *reading, iso_lines *lines, iso_error *error) {
    t->lines.reading = reading;
    reading->report->unit = ISO_WORLD_UNIT_MILLIMETRE;
    t->lines.ras = iso_reading_is_ras(reading, ISO_SPACE_RAS);
    ISO_TRY(iso_stream_open(reading->path, &t->in, error));
    ISO_TRY(read_header(t, error));
    ISO_TRY(read_lines(t, error));
    return iso_line_sink_finish(&t->lines, lines, error);
}

iso_status iso_lines_read_trk(iso_reading *reading, iso_lines *lines, iso_error *error) {
    trk *t = iso_alloc_zero(1, sizeof *t);
    if (!t) return iso_fail_memory(error, reading->path);
    iso_status status = read_trk(t, reading, lines, error);
    iso_stream_close(&t->in);
    iso_line_sink_free(&t->lines);
    iso_free(t);
    return status;
}
