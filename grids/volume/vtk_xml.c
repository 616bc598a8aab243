#include "grids/volume/vtk_xml.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "grids/volume/scalar_load.h"

iso_status iso_vtk_xml_bad(const iso_vtk_xml *x, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable file of VTK: %s", x->path, what);
}

iso_status iso_vtk_xml_ends(const iso_vtk_xml *x, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", x->path);
}

/* ---- markup */

/* Reads a count; returns `missing` if the attribute is missing. */
iso_status iso_vtk_xml_count(const iso_vtk_xml *x, const iso_xml_tag *t, const char *name, uint64_t missing,
                             uint64_t *count, iso_error *error) {
    char value[ISO_XML_TEXT];
    *count = missing;
    if (!iso_xml_attribute(t, name, value)) return ISO_OK;
    char *digits = value + strspn(value, " ");
    if (digits[strspn(digits, "0123456789 ")] || !*digits || strlen(digits) > 15)
        return iso_vtk_xml_bad(x, "a count is not possible", error);
    *count = strtoull(digits, NULL, 10);
    return ISO_OK;
}

bool iso_vtk_xml_extent(const char *text, int extent[6]) {
    for (int i = 0; i < 6; i++) {
        char *end;
        errno = 0;
        const long number = strtol(text, &end, 10);
        if (end == text || errno || number < -INT_MAX || number > INT_MAX) return false;
        extent[i] = (int)number;
        text = end;
    }
    for (int i = 0; i < 6; i += 2)
        if (extent[i] > extent[i + 1]) return false;
    return text[strspn(text, " \t\r\n")] == 0;
}

/* ---- bytes of arrays */

/* The part of an array's data that has not been read yet. */
typedef struct source {
    const char *at, *end;
    bool base64;
} source;

/* Returns the number of characters that encode `bytes` bytes. */
static uint64_t characters(const source *s, uint64_t bytes) {
    return s->base64 ? (bytes + 2) / 3 * 4 : bytes;
}

static bool has_bytes(const source *s, uint64_t bytes) {
    return bytes <= (uint64_t)(s->end - s->at) && characters(s, bytes) <= (uint64_t)(s->end - s->at);
}

/* Copies the next bytes, which must exist, and advances behind their characters. In base64 more bytes can
 * follow only if this number is a multiple of three. Returns false if the text is not base64. */
static bool take_bytes(source *s, uint64_t bytes, unsigned char *to) {
    if (!s->base64) {
        memcpy(to, s->at, bytes);
        s->at += bytes;
        return true;
    }
    return iso_base64_take(&s->at, bytes, to);
}

/* Reads a number of an array's header, as an integer because lengths must not be rounded. */
static uint64_t load_count(const iso_vtk_xml *x, const unsigned char *bytes) {
    uint64_t count = 0;
    for (size_t i = 0; i < x->header; i++) count = count << 8 | bytes[x->big_endian ? i : x->header - 1 - i];
    return count;
}

/* Reads an array that is not compressed: its length and its bytes, which are encoded together. */
static iso_status take_plain(iso_vtk_xml *x, source s, iso_error *error) {
    unsigned char head[8];
    source again = s;
    if (!has_bytes(&s, x->header)) return iso_vtk_xml_ends(x, error);
    if (!take_bytes(&s, x->header, head)) return iso_vtk_xml_bad(x, "an array is not in base64", error);
    x->bytes = load_count(x, head);
    if (x->bytes > (uint64_t)(s.end - s.at) || !has_bytes(&again, x->header + x->bytes))
        return iso_vtk_xml_ends(x, error);
    ISO_TRY(x->reserve(x->context, &x->values, (size_t)(x->header + x->bytes), 1, error));
    unsigned char *to = x->values.data;
    if (!take_bytes(&again, x->header + x->bytes, to))
        return iso_vtk_xml_bad(x, "an array is not in base64", error);
    memmove(to, to + x->header, (size_t)x->bytes);
    return ISO_OK;
}

/* Reads the header of a compressed array into x->sizes: the number of blocks, the size of a block, the size
 * of a smaller last block, and the compressed size of each. */
static iso_status take_sizes(iso_vtk_xml *x, source *s, uint64_t head[3], iso_error *error) {
    unsigned char bytes[24];
    if (!has_bytes(s, 3 * x->header)) return iso_vtk_xml_ends(x, error);
    if (!take_bytes(s, 3 * x->header, bytes)) return iso_vtk_xml_bad(x, "an array is not in base64", error);
    for (size_t i = 0; i < 3; i++) head[i] = load_count(x, bytes + i * x->header);
    if (head[0] > (uint64_t)(s->end - s->at) / x->header || !has_bytes(s, head[0] * x->header))
        return iso_vtk_xml_ends(x, error);
    ISO_TRY(x->reserve(x->context, &x->sizes, (size_t)head[0] + 1, x->header, error));
    return take_bytes(s, head[0] * x->header, x->sizes.data)
               ? ISO_OK
               : iso_vtk_xml_bad(x, "an array is not in base64", error);
}

/* Checks the sizes: all compressed bytes exist, and the blocks are not larger than the method can make them.
 * Sets x->bytes and *packed. */
static iso_status check_sizes(iso_vtk_xml *x, const source *s, const uint64_t head[3], uint64_t *packed,
                              iso_error *error) {
    /* The most bytes that a compressed one can stand for: of LZ4 255; of LZMA, whose decisions take at least
       a fiftieth of a bit, some 7,000 (a repeated match of 273 bytes has 14 of them). */
    const uint64_t most = x->packing == ISO_VTK_LZMA ? 8192 : 1032;
    const uint64_t blocks = head[0], last = head[2] ? head[2] : head[1];
    *packed = x->bytes = 0;
    if (blocks == 0) return ISO_OK;
    for (uint64_t i = 0; i < blocks; i++) {
        const uint64_t size = load_count(x, (const unsigned char *)x->sizes.data + i * x->header);
        if (!has_bytes(s, size) || !has_bytes(s, *packed += size)) return iso_vtk_xml_ends(x, error);
    }
    if (__builtin_mul_overflow(blocks - 1, head[1], &x->bytes) ||
        __builtin_add_overflow(x->bytes, last, &x->bytes) || x->bytes / most > *packed || last > head[1])
        return iso_vtk_xml_bad(x, "the sizes of compressed blocks are not possible", error);
    return ISO_OK;
}

static bool unpack_block(const iso_vtk_xml *x, const unsigned char *packed, size_t size, unsigned char *to,
                         size_t wanted) {
    uLongf got = (uLongf)wanted;
    if (x->packing == ISO_VTK_ZLIB) return uncompress(to, &got, packed, (uLong)size) == Z_OK && got == wanted;
    return x->unpacker->vtk_unpack(x->packing == ISO_VTK_LZMA, packed, size, to, wanted) == wanted;
}

static iso_status unpack(iso_vtk_xml *x, const uint64_t head[3], const unsigned char *packed,
                         iso_error *error) {
    unsigned char *to = x->values.data;
    for (uint64_t i = 0; i < head[0]; i++) {
        const uint64_t size = load_count(x, (const unsigned char *)x->sizes.data + i * x->header),
                       wanted = i + 1 < head[0] || head[2] == 0 ? head[1] : head[2];
        if (!unpack_block(x, packed, (size_t)size, to, (size_t)wanted))
            return iso_fail(error, ISO_ERR_IO, "%s: corrupt: a compressed block", x->path);
        packed += size;
        to += wanted;
    }
    return ISO_OK;
}

static iso_status take_compressed(iso_vtk_xml *x, source s, iso_error *error) {
    uint64_t head[3], packed;
    ISO_TRY(take_sizes(x, &s, head, error));
    ISO_TRY(check_sizes(x, &s, head, &packed, error));
    ISO_TRY(x->reserve(x->context, &x->values, (size_t)x->bytes + 1, 1, error));
    if (!s.base64) return unpack(x, head, (const unsigned char *)s.at, error);
    ISO_TRY(x->reserve(x->context, &x->packed, (size_t)packed + 1, 1, error));
    return take_bytes(&s, packed, x->packed.data) ? unpack(x, head, x->packed.data, error)
                                                  : iso_vtk_xml_bad(x, "an array is not in base64", error);
}

/* ---- numbers of arrays */

/* Parses the next number of a text that need not end with a zero. */
static bool take_number(const char **at, const char *end, double *number) {
    char word[64], *rest;
    size_t length = 0;
    while (*at < end && isspace((unsigned char)**at)) ++*at;
    for (; *at < end && **at != '<' && !isspace((unsigned char)**at); ++*at)
        if (length < sizeof word - 1) word[length++] = **at;
    word[length] = 0;
    *number = strtod(word, &rest);
    return length && length < sizeof word - 1 && !*rest;
}

/* Reads all numbers of a text array as doubles. */
static iso_status take_text(iso_vtk_xml *x, const iso_vtk_array *a, uint64_t count, iso_error *error) {
    const char *at = a->begin;
    /* a number takes two characters */
    if (count > (uint64_t)(x->end - at)) return iso_vtk_xml_ends(x, error);
    ISO_TRY(x->reserve(x->context, &x->values, (size_t)count + 1, sizeof(double), error));
    for (uint64_t i = 0; i < count; i++)
        if (!take_number(&at, x->end, (double *)x->values.data + i))
            return iso_vtk_xml_bad(x, "an array has fewer numbers than it should, or others", error);
    return ISO_OK;
}

iso_status iso_vtk_xml_decode(iso_vtk_xml *x, const iso_vtk_array *a, uint64_t count, iso_error *error) {
    if (a->encoding == ISO_VTI_TEXT) return take_text(x, a, count, error);
    const source s = {a->begin, x->end, a->encoding == ISO_VTI_BASE64};
    ISO_TRY(x->packing != ISO_VTK_PLAIN ? take_compressed(x, s, error) : take_plain(x, s, error));
    uint64_t wanted;
    if (__builtin_mul_overflow(count, iso_scalar_size(a->scalar), &wanted) || x->bytes != wanted)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: array '%.60s' has %llu bytes, not %llu", x->path,
                        a->name, (unsigned long long)x->bytes, (unsigned long long)wanted);
    return ISO_OK;
}

double iso_vtk_xml_number(const iso_vtk_xml *x, const iso_vtk_array *a, uint64_t i) {
    if (a->encoding == ISO_VTI_TEXT) return ((const double *)x->values.data)[i];
    const unsigned char *bytes = x->values.data;
    return iso_scalar_load(bytes + i * iso_scalar_size(a->scalar), a->scalar, x->big_endian);
}

bool iso_vtk_xml_type(const char *name, iso_scalar *scalar) {
    static const char *const names[] = {"UInt8", "Int8",   "UInt16", "Int16",   "UInt32",
                                        "Int32", "UInt64", "Int64",  "Float32", "Float64"};
    for (int i = 0; i < 10; i++)
        if (strcmp(name, names[i]) == 0) {
            *scalar = (iso_scalar)i;
            return true;
        }
    return false;
}

/* Finds where the values of an array begin: after its tag, or at an offset in the appended data. */
static iso_status locate(const iso_vtk_xml *x, const iso_xml_tag *t, iso_vtk_array *a, iso_error *error) {
    char format[ISO_XML_TEXT] = "ascii";
    uint64_t offset;
    iso_xml_attribute(t, "format", format);
    a->begin = t->end + 1;
    a->encoding = strcmp(format, "ascii") == 0 ? ISO_VTI_TEXT : ISO_VTI_BASE64;
    if (strcmp(format, "appended") == 0) {
        ISO_TRY(iso_vtk_xml_count(x, t, "offset", UINT64_MAX, &offset, error));
        if (!x->appended) return iso_vtk_xml_bad(x, "there is no appended data", error);
        if (offset > (uint64_t)(x->end - x->appended)) return iso_vtk_xml_ends(x, error);
        a->begin = x->appended + offset;
        a->encoding = x->appended_raw ? ISO_VTI_RAW : ISO_VTI_BASE64;
    } else if (a->encoding == ISO_VTI_BASE64 && strcmp(format, "binary") != 0)
        return iso_vtk_xml_bad(x, "an array of an unknown format", error);
    while (a->encoding == ISO_VTI_BASE64 && a->begin < x->end && isspace((unsigned char)*a->begin))
        a->begin++;
    return ISO_OK;
}

/* Finds the appended data, where the markup ends. */
static void find_appended(iso_vtk_xml *x) {
    const char *open = memmem(x->markup.at, (size_t)(x->markup.end - x->markup.at), "<AppendedData", 13);
    const char *close = open ? memchr(open, '>', (size_t)(x->markup.end - open)) : NULL;
    const char *mark = close ? memchr(close, '_', (size_t)(x->markup.end - close)) : NULL;
    if (!mark) return;
    const iso_xml_tag t = {open + 1, close};
    x->appended = mark + 1;
    x->appended_raw = iso_xml_attribute_is(&t, "encoding", "raw");
    x->markup.end = open;
}

iso_status iso_vtk_xml_array(const iso_vtk_xml *x, const iso_xml_tag *tag, iso_vtk_array *array, bool *known,
                             iso_error *error) {
    char text[ISO_XML_TEXT] = "";
    *array = (iso_vtk_array){.components = 1};
    *known = iso_xml_attribute(tag, "type", text) && iso_vtk_xml_type(text, &array->scalar);
    if (!*known) return ISO_OK;
    if (iso_xml_attribute(tag, "Name", text)) memcpy(array->name, text, sizeof array->name - 1);
    ISO_TRY(iso_vtk_xml_count(x, tag, "NumberOfComponents", 1, &array->components, error));
    return locate(x, tag, array, error);
}

static iso_status find_unpacker(iso_vtk_xml *x, const char *compressor, iso_error *error) {
    static const char *const names[] = {
        [ISO_VTK_PLAIN] = "",
        [ISO_VTK_ZLIB] = "vtkZLibDataCompressor",
        [ISO_VTK_LZ4] = "vtkLZ4DataCompressor",
        [ISO_VTK_LZMA] = "vtkLZMADataCompressor",
    };
    x->packing = ISO_VTK_PLAIN;
    while (strcmp(compressor, names[x->packing]) != 0)
        if (++x->packing == sizeof names / sizeof *names)
            return iso_fail(error, ISO_ERR_UNSUPPORTED,
                            "%s: compressed by %.80s: zlib, LZ4 and LZMA are supported", x->path, compressor);
    return x->packing < ISO_VTK_LZ4 ? ISO_OK : iso_module_load(x->path, "vti", "VTK", &x->unpacker, error);
}

iso_status iso_vtk_xml_open(iso_vtk_xml *x, const char *text, size_t count, const char *type,
                            iso_error *error) {
    char value[ISO_XML_TEXT] = "";
    iso_xml_tag t;
    x->markup = (iso_xml){text, text + count};
    x->end = text + count;
    do
        if (!iso_xml_next(&x->markup, &t)) return iso_vtk_xml_bad(x, "it has no element VTKFile", error);
    while (!iso_xml_is(&t, "VTKFile"));
    if (!iso_xml_attribute(&t, "type", value) || strcmp(value, type) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds a %.80s, not %.40s", x->path,
                        *value ? value : "VTKFile without a type", type);
    x->big_endian = iso_xml_attribute_is(&t, "byte_order", "BigEndian");
    x->header = iso_xml_attribute_is(&t, "header_type", "UInt64") ? 8 : 4;
    find_appended(x);
    if (!iso_xml_attribute(&t, "compressor", value)) *value = 0;
    return find_unpacker(x, value, error);
}
