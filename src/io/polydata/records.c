/* records: decodes blocks of records column by column, so that the type of a number is looked up once for
 * many numbers. */
#include "io/polydata/records.h"

#include <math.h>
#include <string.h>

#include "grids/volume/scalar_load.h"

/* Points that are decoded at a time: their numbers stay in the first level of the cache. */
enum { BLOCK = 512 };

#define LOAD(type)                                                                                           \
    for (size_t i = 0; i < items; i++, at += field->stride) {                                                \
        type value;                                                                                          \
        memcpy(&value, at, sizeof value);                                                                    \
        to[i] = (double)value;                                                                               \
    }                                                                                                        \
    break

/* Loads numbers in the byte order of the machines that this runs on, little-endian. */
static void load_little(const iso_record_field *field, const unsigned char *at, size_t items, double *to) {
    switch (field->scalar) {
    case ISO_SCALAR_UINT8:
        LOAD(uint8_t);
    case ISO_SCALAR_INT8:
        LOAD(int8_t);
    case ISO_SCALAR_UINT16:
        LOAD(uint16_t);
    case ISO_SCALAR_INT16:
        LOAD(int16_t);
    case ISO_SCALAR_UINT32:
        LOAD(uint32_t);
    case ISO_SCALAR_INT32:
        LOAD(int32_t);
    case ISO_SCALAR_UINT64:
        LOAD(uint64_t);
    case ISO_SCALAR_INT64:
        LOAD(int64_t);
    case ISO_SCALAR_FLOAT:
        LOAD(float);
    case ISO_SCALAR_DOUBLE:
        LOAD(double);
    case ISO_SCALAR_HALF: /* not in these files */
        break;
    }
}

static void load_masked(const iso_record_field *field, const unsigned char *at, size_t items, double *to) {
    int low = 0;
    while (!(field->mask >> low & 1)) low++;
    for (size_t i = 0; i < items; i++, at += field->stride) to[i] = (*at & field->mask) >> low;
}

static void load_numbers(const iso_record_field *field, const unsigned char *at, size_t items, double *to) {
    if (field->mask)
        load_masked(field, at, items, to);
    else if (!field->big_endian)
        load_little(field, at, items, to);
    else
        for (size_t i = 0; i < items; i++, at += field->stride)
            to[i] = iso_scalar_load(at, field->scalar, true);
    for (size_t i = 0; i < items && field->has_no_data; i++)
        if (!(to[i] < field->no_data || to[i] > field->no_data)) to[i] = (double)NAN;
    if (field->scale == 1 && field->shift == 0) return;
    for (size_t i = 0; i < items; i++) to[i] = to[i] * field->scale + field->shift;
}

static void store_column(iso_polydata *data, iso_slot slot, const double *numbers, size_t items) {
    const iso_column *column = iso_polydata_column(data, slot.column);
    const size_t components = (size_t)column->components;
    float *to = (float *)column->values.data + data->point_count * components + (size_t)slot.component;
    for (size_t i = 0; i < items; i++, to += components) *to = (float)numbers[i];
}

/* Adds `items` points, at most BLOCK, from number `first` on. */
static void add_block(iso_polydata *data, const iso_record_field *fields, int count,
                      const unsigned char *bytes, size_t first, size_t items) {
    double axes[3][BLOCK] = {{0}}, numbers[BLOCK];
    for (int k = 0; k < count; k++) {
        const iso_record_field *field = &fields[k];
        if (field->slot.column == ISO_SLOT_SKIP) continue;
        const bool point = field->slot.column == ISO_SLOT_POINT;
        load_numbers(field, bytes + field->offset + first * field->stride, items,
                     point ? axes[field->slot.component] : numbers);
        if (!point) store_column(data, field->slot, numbers, items);
    }
    for (size_t i = 0; i < items; i++) {
        const double p[3] = {axes[0][i], axes[1][i], axes[2][i]};
        iso_polydata_add_point(data, p);
    }
}

void iso_polydata_add_records(iso_polydata *data, const iso_record_field *fields, int count,
                              const unsigned char *bytes, size_t items) {
    for (size_t first = 0; first < items; first += BLOCK)
        add_block(data, fields, count, bytes, first, items - first < BLOCK ? items - first : BLOCK);
}

iso_status iso_polydata_check_records(const iso_stream *stream, size_t record, uint64_t items,
                                      iso_error *error) {
    if (items <= stream->remaining / record) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: its header promises %llu points", stream->path,
                    (unsigned long long)items);
}

iso_status iso_polydata_stream_records(iso_polydata *data, const iso_record_field *fields, int count,
                                       iso_stream *stream, size_t record, uint64_t items, iso_error *error) {
    ISO_TRY(iso_polydata_check_records(stream, record, items, error));
    ISO_TRY(iso_polydata_reserve(data, data->point_count + (size_t)items, error));
    for (uint64_t left = items; left > 0;) {
        if (!iso_stream_fill(stream, record)) return iso_stream_fail(stream, error);
        const size_t have = (stream->end - stream->place) / record, some = left < have ? (size_t)left : have;
        iso_polydata_add_records(data, fields, count, stream->buffer + stream->place, some);
        iso_stream_advance(stream, some * record);
        left -= some;
    }
    return ISO_OK;
}
