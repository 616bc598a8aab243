/* las: scans from the air and the ground (ASPRS LAS 1.0 to 1.4, point formats 0 to 10). A record may be
 * longer than its format: the further bytes are columns if a block describes them (las_blocks.h), else
 * ignored. LAZ, the compressed form, holds the same records (laz.h).
 *
 * Floats hold times of GPS only coarsely, so that the attribute gps_time counts from the first point's time,
 * rounded down. */
#include <math.h>
#include <string.h>

#include "grids/volume/scalar_load.h"
#include "io/glyphs/las_blocks.h"
#include "io/glyphs/laz.h"
#include "io/polydata/records.h"

enum { HEADER_LEAST = 227, HEADER_14 = 375, FORMATS = 11, FIELDS = 16 + 3 * ISO_LAS_EXTRAS };

/* Records of a point format: how long they are, and where the parts are that not all formats have. */
static const struct {
    size_t bytes, time, color; /* offsets; 0: the format has none */
} layouts[FORMATS] = {{20, 0, 0},  {28, 20, 0},  {26, 0, 20},  {34, 20, 28}, {57, 20, 0}, {63, 20, 28},
                      {30, 22, 0}, {36, 22, 30}, {38, 22, 30}, {59, 22, 0},  {67, 22, 30}};

typedef struct las {
    iso_polydata *data;
    iso_stream in;
    unsigned char header[HEADER_14]; /* zero behind its end */
    int format;
    size_t record;
    uint64_t points, begin, block_count; /* begin: offset of the first point in the file */
    iso_las_blocks blocks;
    iso_laz laz; /* of compressed points */
    iso_record_field fields[FIELDS];
    int field_count;
} las;

static const char *path_of(const las *l) {
    return l->data->reading->path;
}

/* ---- the header */

static uint64_t number_at(const unsigned char *bytes, iso_scalar scalar) {
    return (uint64_t)iso_scalar_load(bytes, scalar, false);
}

static uint64_t long_at(const unsigned char *bytes) {
    return number_at(bytes, ISO_SCALAR_UINT32) | number_at(bytes + 4, ISO_SCALAR_UINT32) << 32;
}

static double double_at(const las *l, size_t offset) {
    return iso_scalar_load(l->header + offset, ISO_SCALAR_DOUBLE, false);
}

static iso_status read_header(las *l, iso_error *error) {
    const size_t before = 96; /* up to the header's own length and the offset of the points */
    if (!iso_stream_fill(&l->in, HEADER_LEAST))
        return ferror(l->in.file)
                   ? iso_stream_fail(&l->in, error)
                   : iso_fail(error, ISO_ERR_IO, "%s: truncated in its LAS header", path_of(l));
    if (memcmp(l->in.buffer, "LASF", 4) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a LAS file", path_of(l));
    const uint64_t length = number_at(l->in.buffer + before - 2, ISO_SCALAR_UINT16);
    if (length < HEADER_LEAST)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: a LAS header of %llu bytes", path_of(l),
                        (unsigned long long)length);
    const size_t kept = length < HEADER_14 ? (size_t)length : HEADER_14;
    ISO_TRY(iso_stream_read(&l->in, l->header, kept, error));
    ISO_TRY(iso_stream_skip(&l->in, length - kept, error));
    l->begin = number_at(l->header + before, ISO_SCALAR_UINT32);
    l->block_count = number_at(l->header + 100, ISO_SCALAR_UINT32);
    l->format = l->header[104];
    l->record = (size_t)number_at(l->header + 105, ISO_SCALAR_UINT16);
    l->points = number_at(l->header + 107, ISO_SCALAR_UINT32);
    if (l->header[25] >= 4 && long_at(l->header + 247)) l->points = long_at(l->header + 247);
    if (l->begin >= length) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: its points begin in the LAS header", path_of(l));
}

static iso_status check_format(las *l, iso_error *error) {
    enum { COMPRESSED = 0x80, OLD_COMPRESSED = 0x40 };
    if (l->format & (COMPRESSED | OLD_COMPRESSED) && !l->blocks.compressed)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: damaged: nothing says how its points are compressed (LAZ)", path_of(l));
    l->format &= ~(COMPRESSED | OLD_COMPRESSED);
    if (l->format >= FORMATS)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: point format %d of LAS is not known", path_of(l),
                        l->format);
    if (l->record >= layouts[l->format].bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: points of format %d in %zu bytes", path_of(l),
                    l->format, l->record);
}

/* ---- points */

static iso_record_field *add_field(las *l, iso_slot slot, iso_scalar scalar, size_t offset) {
    iso_record_field *field = &l->fields[l->field_count++];
    *field = iso_record_field_make(slot, scalar, offset, l->record);
    return field;
}

/* Adds a column of one number. */
static iso_status add_number(las *l, const char *name, iso_scalar scalar, size_t offset, uint8_t mask,
                             iso_error *error) {
    iso_slot slot = {0, 0};
    ISO_TRY(iso_polydata_add_column(l->data, name, 1, false, ISO_ROLE_NONE, &slot.column, error));
    add_field(l, slot, scalar, offset)->mask = mask;
    return ISO_OK;
}

/* The first point; NULL: there are none. */
static const unsigned char *first_record(las *l) {
    if (l->blocks.compressed) return iso_laz_first(&l->laz);
    return l->points && iso_stream_fill(&l->in, l->record) ? l->in.buffer + l->in.place : NULL;
}

static iso_status add_time(las *l, size_t offset, iso_error *error) {
    ISO_TRY(add_number(l, "gps_time", ISO_SCALAR_DOUBLE, offset, 0, error));
    const unsigned char *record = first_record(l);
    if (!record) return ISO_OK;
    const double first = floor(iso_scalar_load(record + offset, ISO_SCALAR_DOUBLE, false));
    if (!(first > 0 && first < 1e15)) return ISO_OK;
    l->fields[l->field_count - 1].shift = -first;
    iso_reading_note(l->data->reading, "gps_time is counted from %.0f", first);
    return ISO_OK;
}

static iso_status add_color(las *l, size_t offset, iso_error *error) {
    int column;
    ISO_TRY(iso_polydata_add_column(l->data, "colors", 3, false, ISO_ROLE_COLOR, &column, error));
    for (int k = 0; k < 3; k++)
        add_field(l, (iso_slot){column, k}, ISO_SCALAR_UINT16, offset + 2 * (size_t)k);
    return ISO_OK;
}

/* Adds the columns of extra bytes, which begin behind the numbers of the format. */
static iso_status add_extras(las *l, iso_error *error) {
    size_t offset = layouts[l->format].bytes;
    for (int i = 0; i < l->blocks.extra_count; i++) {
        const iso_las_extra *extra = &l->blocks.extras[i];
        int column;
        if (extra->bytes > l->record - offset) break;
        if (extra->count)
            ISO_TRY(iso_polydata_add_column(l->data, extra->name, extra->count, false, ISO_ROLE_NONE, &column,
                                            error));
        for (int k = 0; k < extra->count; k++) {
            iso_record_field *field = add_field(l, (iso_slot){column, k}, extra->scalar,
                                                offset + (size_t)k * iso_scalar_size(extra->scalar));
            field->scale = extra->scale[k];
            field->shift = extra->shift[k];
            field->has_no_data = extra->has_no_data && !isnan(extra->no_data[k]);
            field->no_data = extra->no_data[k];
        }
        offset += extra->bytes;
    }
    return ISO_OK;
}

static iso_status add_fields(las *l, iso_error *error) {
    const bool extended = l->format >= 6; /* more bits for the number of the return, a byte for the class */
    for (int axis = 0; axis < 3; axis++) {
        const size_t at = 8 * (size_t)axis;
        iso_record_field *field =
            add_field(l, (iso_slot){ISO_SLOT_POINT, axis}, ISO_SCALAR_INT32, 4 * (size_t)axis);
        field->scale = double_at(l, 131 + at);
        field->shift = double_at(l, 155 + at);
    }
    ISO_TRY(add_number(l, "intensity", ISO_SCALAR_UINT16, 12, 0, error));
    ISO_TRY(add_number(l, "return_number", ISO_SCALAR_UINT8, 14, extended ? 0x0f : 0x07, error));
    ISO_TRY(
        add_number(l, "classification", ISO_SCALAR_UINT8, extended ? 16 : 15, extended ? 0 : 0x1f, error));
    if (layouts[l->format].time) ISO_TRY(add_time(l, layouts[l->format].time, error));
    if (layouts[l->format].color) ISO_TRY(add_color(l, layouts[l->format].color, error));
    return add_extras(l, error);
}

static void take_unit(las *l) {
    l->data->reading->report->unit = l->blocks.unit;
    if (l->blocks.unit == ISO_WORLD_UNIT_DEGREE)
        iso_reading_note(l->data->reading,
                         "its x and y are degrees of longitude and latitude, and z is a height: "
                         "shapes are distorted, project them first");
}

static iso_status read_las(las *l, iso_error *error) {
    ISO_TRY(iso_stream_open(path_of(l), &l->in, error));
    ISO_TRY(read_header(l, error));
    ISO_TRY(iso_las_blocks_read(&l->blocks, &l->in, l->block_count,
                                l->begin - number_at(l->header + 94, ISO_SCALAR_UINT16), error));
    ISO_TRY(check_format(l, error));
    take_unit(l);
    if (l->blocks.compressed)
        ISO_TRY(iso_laz_open(&l->laz, path_of(l), l->blocks.laszip, l->blocks.laszip_bytes, l->begin,
                             l->points, l->record, error));
    ISO_TRY(add_fields(l, error));
    ISO_TRY(l->blocks.compressed ? iso_laz_add_points(&l->laz, l->data, l->fields, l->field_count,
                                                      l->data->reading->opts.pool, error)
                                 : iso_polydata_stream_records(l->data, l->fields, l->field_count, &l->in,
                                                               l->record, l->points, error));
    iso_polydata_scale_colors(l->data, false);
    return ISO_OK;
}

iso_status iso_polydata_read_las(iso_polydata *data, iso_error *error) {
    las *l = iso_alloc_zero(1, sizeof *l);
    if (!l) return iso_fail_memory(error, data->reading->path);
    l->data = data;
    const iso_status status = read_las(l, error);
    iso_laz_close(&l->laz);
    iso_stream_close(&l->in);
    iso_free(l);
    return status;
}
