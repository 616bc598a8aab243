/* e57: scans in E57 (ASTM E2807), all of a file in the coordinates of the world, in metres: each is turned
 * and moved by its pose. Points are x y z, or range, azimuth and elevation; those of invalid state are left
 * out. Intensities, colours and normals are kept, images are not read. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/glyphs/e57_file.h"
#include "io/polydata/polydata.h"

/* What is kept of a point, in the order of a row. */
enum { X, Y, Z, INTENSITY, RED, GREEN, BLUE, NORMAL_X, NORMAL_Y, NORMAL_Z, KEPT, INVALID = KEPT, NOT_KEPT };

/* Names of fields, in cartesian and in spherical coordinates. */
static const struct {
    const char *name;
    int what;
    bool spherical;
} names[] = {{"cartesianX", X, false},
             {"cartesianY", Y, false},
             {"cartesianZ", Z, false},
             {"sphericalRange", X, true},
             {"sphericalAzimuth", Y, true},
             {"sphericalElevation", Z, true},
             {"cartesianInvalidState", INVALID, false},
             {"sphericalInvalidState", INVALID, true},
             {"intensity", INTENSITY, false},
             {"colorRed", RED, false},
             {"colorGreen", GREEN, false},
             {"colorBlue", BLUE, false},
             {"nor:normalX", NORMAL_X, false},
             {"nor:normalY", NORMAL_Y, false},
             {"nor:normalZ", NORMAL_Z, false}};

/* The bits of a field that have come so far and are not used yet. */
typedef struct stream {
    iso_buffer bytes;
    size_t count; /* bytes, behind which 8 more can be read */
    uint64_t at;  /* the first bit that is not used */
} stream;

typedef struct e57 {
    iso_e57_file file;
    iso_polydata *data;
    iso_slot slots[KEPT];
    uint64_t invalid;
    stream streams[ISO_E57_FIELDS];
} e57;

/* ---- a scan */

/* What the fields of a scan are; cartesian coordinates are taken if there are both. False: it has no
 * coordinates. */
static bool find_fields(const iso_e57_scan *scan, int what[ISO_E57_FIELDS], bool *spherical) {
    unsigned cartesian = 0, round = 0;
    for (int i = 0; i < scan->field_count; i++) {
        what[i] = NOT_KEPT;
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            if (strcmp(scan->fields[i].name, names[k].name) == 0 && names[k].what <= Z)
                *(names[k].spherical ? &round : &cartesian) |= 1U << names[k].what;
    }
    *spherical = cartesian != 7;
    for (int i = 0; i < scan->field_count; i++)
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            if (strcmp(scan->fields[i].name, names[k].name) == 0 &&
                (names[k].spherical == *spherical || (names[k].what > Z && names[k].what != INVALID)))
                what[i] = names[k].what;
    return cartesian == 7 || round == 7;
}

static double next_number(stream *s, const iso_e57_field *field) {
    uint64_t word, high;
    const unsigned char *at = (const unsigned char *)s->bytes.data + s->at / 8;
    const unsigned shift = s->at % 8;
    if (field->bits == 0) return (double)field->least * field->scale + field->offset;
    memcpy(&word, at, sizeof word);
    word >>= shift;
    if (shift && field->bits > 64 - (int)shift) {
        high = at[8];
        word |= high << (64 - shift);
    }
    if (field->bits < 64) word &= (1ULL << field->bits) - 1;
    s->at += (uint64_t)field->bits;
    if (!field->is_float)
        return (double)(int64_t)(word + (uint64_t)field->least) * field->scale + field->offset;
    if (field->bits == 32) {
        const uint32_t half = (uint32_t)word;
        float single;
        memcpy(&single, &half, sizeof single);
        return (double)single;
    }
    double number;
    memcpy(&number, &word, sizeof number);
    return number;
}

/* Makes the coordinates those of the world, and turns normals. */
static void place_point(const iso_e57_scan *scan, bool spherical, double row[KEPT]) {
    double p[3] = {row[X], row[Y], row[Z]}, n[3] = {row[NORMAL_X], row[NORMAL_Y], row[NORMAL_Z]};
    if (spherical) {
        const double across = row[X] * cos(row[Z]);
        p[0] = across * cos(row[Y]);
        p[1] = across * sin(row[Y]);
        p[2] = row[X] * sin(row[Z]);
    }
    for (int axis = 0; axis < 3; axis++) {
        const double *r = scan->rotation + 3 * axis;
        row[X + axis] = r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + scan->translation[axis];
        row[NORMAL_X + axis] = r[0] * n[0] + r[1] * n[1] + r[2] * n[2];
    }
}

/* Adds the points whose numbers have all come; returns how many, at most `most`. */
static uint64_t add_points(e57 *e, const iso_e57_scan *scan, const int what[ISO_E57_FIELDS], bool spherical,
                           uint64_t most) {
    for (int i = 0; i < scan->field_count; i++) {
        const uint64_t bits = 8 * (uint64_t)e->streams[i].count - e->streams[i].at;
        if (scan->fields[i].bits && bits / (uint64_t)scan->fields[i].bits < most)
            most = bits / (uint64_t)scan->fields[i].bits;
    }
    for (uint64_t k = 0; k < most; k++) {
        double row[NOT_KEPT + 1] = {0};
        for (int i = 0; i < scan->field_count; i++)
            row[what[i]] = next_number(&e->streams[i], &scan->fields[i]);
        if (row[INVALID] != 0) {
            e->invalid++;
            continue;
        }
        place_point(scan, spherical, row);
        iso_polydata_add_row(e->data, e->slots, row, KEPT);
    }
    return most;
}

/* Appends bytes of a packet to a stream, whose used ones are dropped. */
static iso_status append(e57 *e, stream *s, uint64_t *at, size_t bytes, iso_error *error) {
    const size_t used = (size_t)(s->at / 8), left = s->count - used;
    if (left && used) memmove(s->bytes.data, (char *)s->bytes.data + used, left);
    s->at -= 8 * (uint64_t)used;
    s->count = left;
    if (iso_buffer_reserve(&s->bytes, left + bytes + 9, left, NULL) != ISO_OK)
        return iso_fail_memory(error, e->file.path);
    ISO_TRY(iso_e57_take(&e->file, at, (char *)s->bytes.data + left, bytes, error));
    s->count = left + bytes;
    memset((char *)s->bytes.data + s->count, 0, 9);
    return ISO_OK;
}

static iso_status damaged(const e57 *e, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: %s", e->file.path, what);
}

/* Reads a packet of any kind at *at, which moves behind it. */
static iso_status read_packet(e57 *e, const iso_e57_scan *scan, uint64_t *at, iso_error *error) {
    enum { DATA = 1, EMPTY = 2, HEAD = 4, COUNT = 2 };
    unsigned char head[HEAD], lengths[2 * ISO_E57_FIELDS];
    const uint64_t begin = *at;
    ISO_TRY(iso_e57_take(&e->file, at, head, sizeof head, error));
    const uint64_t end = begin + iso_e57_number(head + 2, 2) + 1;
    if (head[0] > EMPTY || end < begin + HEAD) return damaged(e, "a packet of an unknown kind", error);
    if (head[0] == DATA) {
        const size_t bytes = 2 * (size_t)scan->field_count;
        unsigned char count[COUNT];
        ISO_TRY(iso_e57_take(&e->file, at, count, sizeof count, error));
        if (iso_e57_number(count, 2) != (uint64_t)scan->field_count)
            return damaged(e, "a packet has not the streams of its scan", error);
        ISO_TRY(iso_e57_take(&e->file, at, lengths, bytes, error));
        for (int i = 0; i < scan->field_count; i++)
            ISO_TRY(append(e, &e->streams[i], at, (size_t)iso_e57_number(lengths + 2 * i, 2), error));
        if (*at > end) return damaged(e, "the streams of a packet are longer than it", error);
    }
    *at = end;
    return ISO_OK;
}

static iso_status read_scan(e57 *e, const iso_e57_scan *scan, iso_error *error) {
    unsigned char head[32];
    int what[ISO_E57_FIELDS];
    bool spherical;
    if (!find_fields(scan, what, &spherical))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a scan without coordinates", e->file.path);
    for (int i = 0; i < scan->field_count; i++) e->streams[i].at = e->streams[i].count = 0;
    ISO_TRY(iso_polydata_reserve(e->data, e->data->point_count + (size_t)scan->count, error));
    uint64_t at = iso_e57_place(&e->file, scan->begin);
    const uint64_t begin = at;
    ISO_TRY(iso_e57_take(&e->file, &at, head, sizeof head, error));
    if (head[0] != 1) return damaged(e, "no section of points where one is to begin", error);
    const uint64_t bytes = iso_e57_number(head + 8, 8);
    at = iso_e57_place(&e->file, iso_e57_number(head + 16, 8));
    if (at < begin || bytes > e->file.bytes) return damaged(e, "the place of its points", error);
    uint64_t left = scan->count;
    while (left > 0) {
        if (at - begin >= bytes)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: points are missing", e->file.path);
        ISO_TRY(read_packet(e, scan, &at, error));
        left -= add_points(e, scan, what, spherical, left);
    }
    return ISO_OK;
}

/* ---- the file */

/* Adds the columns that any scan has. *fractions: colours may be floats of 0 to 1. */
static iso_status begin_columns(e57 *e, bool *fractions, iso_error *error) {
    static const char *const columns[KEPT] = {"x",     "y",    "z",  "intensity", "red",
                                              "green", "blue", "nx", "ny",        "nz"};
    const iso_e57_scan *scans = e->file.scans.data;
    const char *kept[KEPT] = {columns[X], columns[Y], columns[Z]};
    for (size_t s = 0; s < e->file.scan_count; s++) {
        int what[ISO_E57_FIELDS];
        bool spherical;
        find_fields(&scans[s], what, &spherical);
        for (int i = 0; i < scans[s].field_count; i++) {
            if (what[i] < KEPT) kept[what[i]] = columns[what[i]];
            if (what[i] == RED && scans[s].fields[i].is_float) *fractions = true;
        }
    }
    return iso_polydata_name_columns(e->data, kept, KEPT, e->slots, error);
}

static iso_status read_e57(e57 *e, iso_error *error) {
    ISO_TRY(iso_e57_open(e->data->reading->path, &e->file, error));
    const iso_e57_scan *scans = e->file.scans.data;
    e->data->reading->report->unit = ISO_WORLD_UNIT_METRE;
    bool fractions = false;
    ISO_TRY(begin_columns(e, &fractions, error));
    for (size_t s = 0; s < e->file.scan_count; s++) ISO_TRY(read_scan(e, &scans[s], error));
    if (e->file.scan_count > 1)
        iso_reading_note(e->data->reading, "%zu scans, in the coordinates of the world", e->file.scan_count);
    if (e->invalid)
        iso_reading_note(e->data->reading, "%llu points without a return are left out",
                         (unsigned long long)e->invalid);
    iso_polydata_scale_colors(e->data, fractions);
    return ISO_OK;
}

iso_status iso_polydata_read_e57(iso_polydata *data, iso_error *error) {
    e57 *e = iso_alloc_zero(1, sizeof *e);
    if (!e) return iso_fail_memory(error, data->reading->path);
    e->data = data;
    const iso_status status = read_e57(e, error);
    for (int i = 0; i < ISO_E57_FIELDS; i++) iso_buffer_free(&e->streams[i].bytes);
    iso_e57_close(&e->file);
    iso_free(e);
    return status;
}
