/* records: points that a file stores as records of fixed size, decoded many at a time into polydata: the
 * binary forms of PLY, PCD, LAS and NPY. Internal to src/io. */
#ifndef ISO_IO_POLYDATA_RECORDS_H
#define ISO_IO_POLYDATA_RECORDS_H

#include "grids/volume/format.h"
#include "io/common/stream.h"
#include "io/polydata/polydata.h"

/* A number that every record holds: (number & mask) * scale + shift goes to `slot`; no_data, if there is
 * one, as NaN. */
typedef struct iso_record_field {
    iso_slot slot;
    iso_scalar scalar;
    bool big_endian;
    uint8_t mask;          /* only for ISO_SCALAR_UINT8, shifted down to bit 0; 0: all bits */
    size_t offset, stride; /* bytes from the block's begin to the first number, and from one to the next */
    double scale, shift;
    bool has_no_data;
    double no_data; /* the number, as stored, that becomes NaN */
} iso_record_field;

/* Returns the field of a little-endian number at `offset` in records of `stride` bytes. */
static inline iso_record_field iso_record_field_make(iso_slot slot, iso_scalar scalar, size_t offset,
                                                     size_t stride) {
    iso_record_field field = {slot, scalar, false, 0, offset, stride, 1, 0, false, 0};
    return field;
}

/* Adds `items` points. There must be room for them, and `bytes` must hold all numbers of the fields. */
void iso_polydata_add_records(iso_polydata *data, const iso_record_field *fields, int count,
                              const unsigned char *bytes, size_t items);

/* Checks that the rest of the file is long enough for that many records; ISO_ERR_IO. */
iso_status iso_polydata_check_records(const iso_stream *stream, size_t record, uint64_t items,
                                      iso_error *error);

/* Reads `items` records of `record` bytes, at most ISO_STREAM_BUFFER, from the stream, after
 * iso_polydata_check_records. ISO_ERR_IO, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_polydata_stream_records(iso_polydata *data, const iso_record_field *fields, int count,
                                       iso_stream *stream, size_t record, uint64_t items, iso_error *error);

#endif
