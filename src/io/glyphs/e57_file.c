/* e57_file: pages and their checksums, and the XML text. Elements whose text is empty are 0, and attributes
 * that are missing have the values that the standard states. */
#include "io/glyphs/e57_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "base/geometry.h"
#include "base/xml.h"

enum { HEADER = 48, CHECKSUM = 4, LEAST_PAGE = 64, MOST_PAGE = 1 << 20, MOST_XML = 256 << 20 };

static iso_status damaged(const iso_e57_file *f, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: %s", f->path, what);
}

static iso_status truncated(const iso_e57_file *f, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", f->path);
}

/* ---- pages */

uint64_t iso_e57_place(const iso_e57_file *f, uint64_t byte) {
    return byte / f->page * (f->page - CHECKSUM) + byte % f->page;
}

static iso_status check_page(iso_e57_file *f, uint64_t number, iso_error *error) {
    if (f->checked == number + 1) return ISO_OK;
    if (number >= f->bytes / f->page) return truncated(f, error);
    const unsigned char *page = (const unsigned char *)iso_mapping_data(f->mapping) + number * f->page;
    const unsigned char *sum = page + f->page - CHECKSUM;
    const uint32_t stated = (uint32_t)sum[0] << 24 | (uint32_t)sum[1] << 16 | (uint32_t)sum[2] << 8 | sum[3];
    if (iso_crc32c(0, page, f->page - CHECKSUM) != stated)
        return damaged(f, "the checksum of a page is wrong", error);
    f->checked = number + 1;
    return ISO_OK;
}

iso_status iso_e57_take(iso_e57_file *f, uint64_t *at, void *to, size_t bytes, iso_error *error) {
    const uint64_t room = f->page - CHECKSUM;
    char *target = to;
    while (bytes > 0) {
        const uint64_t number = *at / room, inside = *at % room;
        const size_t part = bytes < room - inside ? bytes : (size_t)(room - inside);
        ISO_TRY(check_page(f, number, error));
        memcpy(target, (const char *)iso_mapping_data(f->mapping) + number * f->page + inside, part);
        target += part;
        bytes -= part;
        *at += part;
    }
    return ISO_OK;
}

uint64_t iso_e57_number(const unsigned char *bytes, int count) {
    uint64_t number = 0;
    while (count > 0) number = number << 8 | bytes[--count];
    return number;
}

/* ---- the description */

/* The text of an element as a number; 0: it has none. The text ends with a zero. */
static double number_of(const iso_xml_tag *t) {
    return t->end > t->text && t->end[-1] == '/' ? 0 : strtod(t->end + 1, NULL);
}

static double attribute(const iso_xml_tag *t, const char *name, double missing) {
    char text[ISO_XML_TEXT];
    return iso_xml_attribute(t, name, text) ? strtod(text, NULL) : missing;
}

static int64_t whole_attribute(const iso_xml_tag *t, const char *name, int64_t missing) {
    char text[ISO_XML_TEXT];
    return iso_xml_attribute(t, name, text) ? strtoll(text, NULL, 10) : missing;
}

static iso_status take_field(const iso_e57_file *f, const iso_xml_tag *t, iso_e57_scan *scan,
                             iso_error *error) {
    if (scan->field_count == ISO_E57_FIELDS)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: its points have more than %d numbers", f->path,
                        ISO_E57_FIELDS);
    iso_e57_field *field = &scan->fields[scan->field_count];
    size_t length = 0;
    while (length < ISO_E57_NAME - 1 && t->text + length < t->end && !strchr(" \t\r\n/", t->text[length]))
        length++;
    *field = (iso_e57_field){.scale = 1};
    memcpy(field->name, t->text, length);
    if (iso_xml_attribute_is(t, "type", "Structure")) return ISO_OK; /* its elements follow */
    if (iso_xml_attribute_is(t, "type", "Float")) {
        field->is_float = true;
        field->bits = iso_xml_attribute_is(t, "precision", "single") ? 32 : 64;
    } else if (iso_xml_attribute_is(t, "type", "Integer") ||
               iso_xml_attribute_is(t, "type", "ScaledInteger")) {
        field->least = whole_attribute(t, "minimum", INT64_MIN);
        const int64_t most = whole_attribute(t, "maximum", INT64_MAX);
        if (most < field->least) return damaged(f, "the range of a number is empty", error);
        const uint64_t range = (uint64_t)most - (uint64_t)field->least;
        field->bits = range ? 64 - __builtin_clzll(range) : 0;
        field->scale = attribute(t, "scale", 1);
        field->offset = attribute(t, "offset", 0);
    } else {
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: its points have texts (%s), which are not read",
                        f->path, field->name);
    }
    scan->field_count++;
    return ISO_OK;
}

static iso_status take_scan(iso_e57_file *f, const iso_e57_scan *scan, iso_error *error) {
    uint64_t bits = 0;
    if (scan->count == 0) return ISO_OK;
    for (int i = 0; i < scan->field_count; i++) bits += (uint64_t)scan->fields[i].bits;
    /* more points than the file has bits for would take any memory */
    if (bits == 0 || scan->count > 8 * f->bytes / bits) return truncated(f, error);
    if (iso_buffer_reserve(&f->scans, (f->scan_count + 1) * sizeof *scan, f->scan_count * sizeof *scan,
                           NULL) != ISO_OK)
        return iso_fail_memory(error, f->path);
    ((iso_e57_scan *)f->scans.data)[f->scan_count++] = *scan;
    return ISO_OK;
}

/* Where the tags are that are read next. */
typedef struct place {
    bool data, points, prototype, rotation, translation;
    double quaternion[4];
} place;

static void take_pose(const iso_xml_tag *t, place *in, iso_e57_scan *scan) {
    static const char *const names[] = {"w", "x", "y", "z"};
    for (int i = 0; i < 4; i++) {
        if (!iso_xml_is(t, names[i])) continue;
        if (in->rotation) in->quaternion[i] = number_of(t);
        if (in->translation && i > 0) scan->translation[i - 1] = number_of(t);
    }
}

static bool ends_itself(const iso_xml_tag *t) {
    return t->end > t->text && t->end[-1] == '/';
}

static iso_status take_tag(iso_e57_file *f, const iso_xml_tag *t, place *in, iso_e57_scan *scan,
                           iso_error *error) {
    const bool opens = !ends_itself(t);
    if (iso_xml_is(t, "data3D")) in->data = opens;
    if (iso_xml_is(t, "/data3D")) in->data = false;
    if (!in->data) return ISO_OK;
    if (iso_xml_is(t, "vectorChild")) {
        *in = (place){.data = true};
        *scan = (iso_e57_scan){.count = 0};
    } else if (iso_xml_is(t, "/vectorChild")) {
        iso_quaternion_matrix(in->quaternion, scan->rotation);
        return take_scan(f, scan, error);
    } else if (iso_xml_is(t, "points")) {
        in->points = opens;
        scan->count = (uint64_t)whole_attribute(t, "recordCount", 0);
        scan->begin = (uint64_t)whole_attribute(t, "fileOffset", 0);
    } else if (iso_xml_is(t, "prototype")) {
        in->prototype = in->points && opens;
    } else if (iso_xml_is(t, "/prototype") || iso_xml_is(t, "/points")) {
        in->prototype = false;
        if (iso_xml_is(t, "/points")) in->points = false;
    } else if (iso_xml_is(t, "rotation") || iso_xml_is(t, "translation")) {
        *(iso_xml_is(t, "rotation") ? &in->rotation : &in->translation) = opens;
    } else if (iso_xml_is(t, "/rotation") || iso_xml_is(t, "/translation")) {
        in->rotation = in->translation = false;
    } else if (in->prototype && *t->text != '/') {
        return take_field(f, t, scan, error);
    } else {
        take_pose(t, in, scan);
    }
    return ISO_OK;
}

static iso_status parse(iso_e57_file *f, const char *text, size_t bytes, iso_error *error) {
    iso_xml xml = {text, text + bytes};
    iso_xml_tag t;
    place in = {.data = false};
    bool ended = false;
    iso_e57_scan *scan = iso_alloc_zero(1, sizeof *scan);
    if (!scan) return iso_fail_memory(error, f->path);
    iso_status status = ISO_OK;
    while (status == ISO_OK && !ended && iso_xml_next(&xml, &t)) {
        status = take_tag(f, &t, &in, scan, error);
        ended = iso_xml_is(&t, "/e57Root");
    }
    iso_free(scan);
    return status == ISO_OK && !ended ? damaged(f, "its XML text has no end", error) : status;
}

static iso_status read_header(iso_e57_file *f, uint64_t *xml_at, uint64_t *xml_bytes, iso_error *error) {
    const unsigned char *head = iso_mapping_data(f->mapping);
    if (f->bytes < HEADER) return truncated(f, error);
    if (memcmp(head, "ASTM-E57", 8) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not an E57 file", f->path);
    f->page = iso_e57_number(head + 40, 8);
    *xml_bytes = iso_e57_number(head + 32, 8);
    if (f->page < LEAST_PAGE || f->page > MOST_PAGE) return damaged(f, "the size of its pages", error);
    if (iso_e57_number(head + 16, 8) > f->bytes || *xml_bytes > f->bytes) return truncated(f, error);
    *xml_at = iso_e57_place(f, iso_e57_number(head + 24, 8));
    return *xml_bytes <= MOST_XML ? ISO_OK : damaged(f, "its XML text is too long", error);
}

iso_status iso_e57_open(const char *path, iso_e57_file *f, iso_error *error) {
    FILE *file;
    uint64_t at = 0, bytes = 0;
    *f = (iso_e57_file){.path = path};
    ISO_TRY(iso_file_open(path, &file, &f->bytes, error));
    iso_status status =
        f->bytes ? iso_mapping_of_file(path, file, f->bytes, &f->mapping, error) : truncated(f, error);
    fclose(file);
    ISO_TRY(status);
    ISO_TRY(read_header(f, &at, &bytes, error));
    char *text = iso_alloc((size_t)bytes + 1);
    if (!text) return iso_fail_memory(error, path);
    text[bytes] = 0;
    status = iso_e57_take(f, &at, text, (size_t)bytes, error);
    if (status == ISO_OK) status = parse(f, text, (size_t)bytes, error);
    iso_free(text);
    return status;
}

void iso_e57_close(iso_e57_file *f) {
    if (f->mapping) iso_mapping_destroy(f->mapping);
    iso_buffer_free(&f->scans);
}
