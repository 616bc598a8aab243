/* vti_check: parses the headers of arrays in the same way as VTK's vtkXMLDataParser, and the structure of the
 * XML around them.
 *
 * An array of bytes that is not compressed begins with its length in bytes. A compressed one begins with four
 * kinds of numbers: the number of blocks, the uncompressed size of a block, the uncompressed size of the last
 * block if it is smaller (else 0), and the compressed size of every block. In base64 the length is encoded
 * together with the values that follow; the numbers of a compressed array are encoded separately. */
#include "grids/volume/vti_check.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/format.h"

enum { BUFFER = 1 << 16 };

/* Limits on the XML, for which VTK needs about 500 bytes for each element and three times its text. Images
 * have a few elements for each of their pieces, nested five deep. */
enum { MAX_ELEMENTS = 50000, MAX_MARKUP = 4 << 20, MAX_DEPTH = 64, MAX_ATTRIBUTES = 256 };

typedef struct input {
    const char *path;
    FILE *stream;
    uint64_t size;  /* of the file */
    uint64_t begin; /* position of the buffer in the file */
    size_t at, filled;
    unsigned char buffer[BUFFER];
} input;

static void close_input(input *in) {
    fclose(in->stream);
    iso_free(in);
}

static iso_status open_input(const char *path, uint64_t position, input **opened, iso_error *error) {
    uint64_t size = 0;
    FILE *stream;
    ISO_TRY(iso_file_open(path, &stream, &size, error));
    input *in = position > size ? NULL : iso_alloc(sizeof *in);
    if (!in) {
        fclose(stream);
        if (position <= size) return iso_fail_memory(error, path);
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: an array begins behind the end of the file", path);
    }
    in->path = path;
    in->size = size;
    in->begin = position;
    in->at = in->filled = 0;
    in->stream = stream;
    if (fseeko(in->stream, (off_t)position, SEEK_SET) == 0) {
        *opened = in;
        return ISO_OK;
    }
    iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    close_input(in);
    return ISO_ERR_IO;
}

/* Reads the next part of the file into the buffer; false at the end of the file. */
static bool refill(input *in) {
    in->begin += in->filled;
    in->at = 0;
    in->filled = fread(in->buffer, 1, BUFFER, in->stream);
    return in->filled > 0;
}

/* Returns the next byte, or EOF. */
static int next_byte(input *in) {
    if (in->at == in->filled && !refill(in)) return EOF;
    return in->buffer[in->at++];
}

static uint64_t bytes_left(const input *in) {
    uint64_t position = in->begin + in->at;
    return position < in->size ? in->size - position : 0;
}

/* ---- numbers before the values ---- */

/* Reads bytes that are raw or in base64, where four characters encode three bytes. */
typedef struct decoder {
    input *in;
    const iso_vti_layout *layout;
    unsigned char triple[3];
    int used; /* bytes of the triple that were read; 3: the next four characters must be decoded */
} decoder;

static int digit_value(int c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : c == '=' ? 0 : -1;
}

static bool take_byte(decoder *d, unsigned char *byte) {
    if (d->layout->encoding == ISO_VTI_RAW) {
        int c = next_byte(d->in);
        *byte = (unsigned char)c;
        return c != EOF;
    }
    if (d->used == 3) {
        uint32_t bits = 0;
        for (int i = 0; i < 4; i++) {
            int value = digit_value(next_byte(d->in));
            if (value < 0) return false;
            bits = bits << 6 | (uint32_t)value;
        }
        for (int i = 0; i < 3; i++) d->triple[i] = (unsigned char)(bits >> (16 - 8 * i));
        d->used = 0;
    }
    *byte = d->triple[d->used++];
    return true;
}

static bool take_number(decoder *d, uint64_t *number) {
    const int count = d->layout->header_bytes;
    *number = 0;
    for (int i = 0; i < count; i++) {
        unsigned char byte;
        if (!take_byte(d, &byte)) return false;
        *number |= (uint64_t)byte << 8 * (d->layout->big_endian ? count - 1 - i : i);
    }
    return true;
}

/* Returns the number of bytes to which `left` bytes of the file decode. */
static uint64_t decoded(const iso_vti_layout *layout, uint64_t left) {
    return layout->encoding == ISO_VTI_RAW ? left : left / 4 * 3;
}

static iso_status cut_off(const input *in, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends before its array does", in->path);
}

static iso_status check_length(decoder *d, iso_error *error) {
    uint64_t length;
    if (!take_number(d, &length)) return cut_off(d->in, error);
    if (length < d->layout->bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: its array has %llu bytes, the voxels are %llu",
                        d->in->path, (unsigned long long)length, (unsigned long long)d->layout->bytes);
    const uint64_t spare = (uint64_t)(3 - d->used); /* bytes that are decoded, but not read */
    const uint64_t here = d->layout->encoding == ISO_VTI_RAW ? 0 : spare;
    const uint64_t available = decoded(d->layout, bytes_left(d->in)) + here;
    return available < length ? cut_off(d->in, error) : ISO_OK; /* also if the voxels are there */
}

/* The block structure of a compressed array. */
typedef struct blocks {
    uint64_t count, size, last; /* number of blocks; uncompressed size of a block; of the last block, 0: the
                                   same */
    uint64_t packed, largest;   /* compressed size of all blocks, and of the largest */
} blocks;

/* Sets *bytes to the uncompressed size of all blocks; false when the numbers are impossible. */
static bool unpacked(const blocks *b, uint64_t *bytes) {
    if (b->count == 0 || b->size == 0 || b->last > b->size) return false;
    return !__builtin_mul_overflow(b->count - 1, b->size, bytes) &&
           !__builtin_add_overflow(*bytes, b->last ? b->last : b->size, bytes);
}

static iso_status check_blocks(decoder *d, blocks *b, iso_error *error) {
    uint64_t bytes, size;
    if (!take_number(d, &b->count) || !take_number(d, &b->size) || !take_number(d, &b->last))
        return cut_off(d->in, error);
    if (!unpacked(b, &bytes) || bytes != d->layout->bytes)
        return iso_fail(error, ISO_ERR_IO,
                        "%s: corrupt: %llu compressed blocks of %llu bytes for voxels of %llu bytes",
                        d->in->path, (unsigned long long)b->count, (unsigned long long)b->size,
                        (unsigned long long)d->layout->bytes);
    for (uint64_t i = 0; i < b->count; i++) {
        if (!take_number(d, &size) || size > d->in->size) return cut_off(d->in, error);
        b->packed += size; /* cannot overflow: fewer blocks than bytes in the file, each at most its size */
        if (size > b->largest) b->largest = size;
        if (b->packed > d->in->size) return cut_off(d->in, error);
    }
    return decoded(d->layout, bytes_left(d->in)) < b->packed ? cut_off(d->in, error) : ISO_OK;
}

/* Returns the memory that VTK needs: for the sizes and positions of all blocks, and for one compressed and
 * one uncompressed block. */
static uint64_t room_for(const iso_vti_layout *layout, const blocks *b) {
    const uint64_t largest = b->count == 1 && b->last ? b->last : b->size;   /* at most all of the array */
    const uint64_t sizes = b->count * ((uint64_t)layout->header_bytes + 16); /* count: the file has as many */
    return sizes + b->largest + (layout->lzma ? 2 : 1) * largest;
}

/* ---- values as text ---- */

static bool is_sign(int c) {
    return c == '+' || c == '-';
}

/* Skips a number and the blanks before it; returns false if there is anything else. */
static bool pass_number(input *in) {
    int c = next_byte(in), digits = 0;
    while (isspace(c)) c = next_byte(in);
    if (is_sign(c)) c = next_byte(in);
    for (; isdigit(c); c = next_byte(in)) digits++;
    if (c == '.')
        for (c = next_byte(in); isdigit(c); c = next_byte(in)) digits++;
    if (digits == 0) return false;
    if (c == 'e' || c == 'E') {
        c = next_byte(in);
        if (is_sign(c)) c = next_byte(in);
        for (digits = 0; isdigit(c); c = next_byte(in)) digits++;
        if (digits == 0) return false;
    }
    if (c != EOF) in->at--; /* puts the last byte back, which is still in the buffer */
    return c == EOF || c == '<' || isspace(c);
}

/* Counts the numbers of a text array. VTK parses numbers up to the first other word, into memory that doubles
 * as it grows; *room is that memory. */
static iso_status check_text(input *in, const iso_vti_layout *layout, uint64_t *room, iso_error *error) {
    const uint64_t wanted = layout->bytes / (uint64_t)layout->value_bytes;
    uint64_t count = 0, reserved = 64;
    while (count <= wanted && pass_number(in)) count++;
    if (count < wanted)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: its array has %llu numbers, the voxels are %llu",
                        in->path, (unsigned long long)count, (unsigned long long)wanted);
    if (count > wanted)
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: its array has more numbers than %llu voxels",
                        in->path, (unsigned long long)wanted);
    while (reserved < wanted) reserved *= 2;
    *room = (reserved + reserved / 2) * (uint64_t)layout->value_bytes;
    return ISO_OK;
}

/* Skips the rest of the element's tag, which ends at the first >, as it does for VTK. */
static void enter_element(input *in) {
    int c = next_byte(in);
    while (c != EOF && c != '>') c = next_byte(in);
    do c = next_byte(in);
    while (isspace(c));
    if (c != EOF) in->at--;
}

static iso_status check_opened(input *in, const iso_vti_layout *layout, uint64_t *room, iso_error *error) {
    decoder d = {.in = in, .layout = layout, .used = 3};
    *room = 0;
    if (layout->inside) enter_element(in);
    if (layout->encoding == ISO_VTI_TEXT) return check_text(in, layout, room, error);
    if (!layout->compressed) return check_length(&d, error);
    blocks b = {0};
    ISO_TRY(check_blocks(&d, &b, error));
    *room = room_for(layout, &b);
    return ISO_OK;
}

iso_status iso_vti_check_array(const char *path, const iso_vti_layout *layout, uint64_t *room,
                               iso_error *error) {
    input *in;
    ISO_TRY(open_input(path, layout->position, &in, error));
    iso_status status = check_opened(in, layout, room, error);
    close_input(in);
    return status;
}

/* ---- markup ---- */

typedef struct markup {
    input *in;
    uint64_t elements, bytes; /* bytes: between < and > */
    int depth;
    bool done; /* the appended data begins */
    const char *problem;
} markup;

static bool fails(markup *m, const char *problem) {
    m->problem = problem;
    return false;
}

/* Returns the next byte of markup and counts it; EOF at the end of the file. */
static int next_of(markup *m) {
    m->bytes++;
    return next_byte(m->in);
}

static bool is_bounded(markup *m) {
    if (m->bytes > MAX_MARKUP) return fails(m, "the text of its XML elements is longer than 4 MB");
    return m->elements <= MAX_ELEMENTS || fails(m, "has more than 50000 XML elements");
}

/* Skips everything up to and including `end`: three characters, of which the first may be '*', for any
 * character. */
static bool pass_until(markup *m, const char *end) {
    int before = 0, last = 0, c = 0;
    while (c != EOF && m->bytes <= MAX_MARKUP) {
        before = last;
        last = c;
        c = next_of(m);
        if (c == end[2] && last == end[1] && (end[0] == '*' || before == end[0])) return true;
    }
    return is_bounded(m) && fails(m, "its XML ends early");
}

/* Skips an element that begins with <!: a comment or a CDATA section. */
static bool pass_special(markup *m) {
    int c = next_of(m);
    if (c == '-') return pass_until(m, "-->");
    if (c == '[') return pass_until(m, "]]>");
    return fails(m, "its XML has a document type, which VTK's files do not have");
}

static bool pass_element(markup *m, int c) {
    char name[sizeof "AppendedData"] = {0};
    size_t length = 0;
    int quote = 0, last = 0, attributes = 0;
    const bool closes = c == '/';
    if (++m->elements > MAX_ELEMENTS) return is_bounded(m);
    for (; c != EOF && (quote || c != '>'); c = next_of(m)) {
        if (length < sizeof name - 1) name[length++] = (char)c;
        if (length == sizeof name - 1 && strcmp(name, "AppendedData") == 0) return m->done = true;
        if (!quote && c == '=' && ++attributes > MAX_ATTRIBUTES)
            return fails(m, "an element of its XML has more than 256 attributes");
        if (quote ? c == quote : c == '"' || c == '\'') quote = quote ? 0 : c;
        if (m->bytes > MAX_MARKUP) return is_bounded(m);
        last = c;
    }
    if (closes)
        m->depth -= m->depth > 0;
    else if (last != '/' && ++m->depth > MAX_DEPTH)
        return fails(m, "its XML elements are nested more than 64 deep");
    return true;
}

/* Parses the next tag, if there is one. */
static bool pass_tag(markup *m) {
    input *in = m->in;
    for (;;) {
        const void *found = memchr(in->buffer + in->at, '<', in->filled - in->at);
        if (found) {
            in->at = (size_t)((const unsigned char *)found - in->buffer) + 1;
            break;
        }
        if (!refill(in)) return m->done = true;
    }
    int c = next_of(m);
    if (c == '!') return pass_special(m);
    if (c == '?') return pass_until(m, "*?>");
    return pass_element(m, c) && is_bounded(m);
}

iso_status iso_vti_check_markup(const char *path, iso_error *error) {
    markup m = {0};
    ISO_TRY(open_input(path, 0, &m.in, error));
    while (!m.done && pass_tag(&m)) continue;
    close_input(m.in);
    if (!m.problem) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, m.problem);
}

/* ---- pieces */

/* The part that a piece does not cover is divided into at most six boxes, which are tested recursively. */
bool iso_vti_covered(const int box[6], const int *boxes, size_t count) {
    int left[6];
    memcpy(left, box, sizeof left);
    for (; count; boxes += 6, count--) {
        bool apart = false;
        for (int a = 0; a < 6; a += 2) apart = apart || boxes[a] > left[a + 1] || boxes[a + 1] < left[a];
        if (apart) continue;
        for (int a = 0; a < 6; a += 2) {
            int rest[6];
            memcpy(rest, left, sizeof rest);
            if (left[a] < boxes[a]) {
                rest[a + 1] = boxes[a] - 1;
                if (!iso_vti_covered(rest, boxes + 6, count - 1)) return false;
                left[a] = boxes[a];
            }
            memcpy(rest, left, sizeof rest);
            if (left[a + 1] > boxes[a + 1]) {
                rest[a] = boxes[a + 1] + 1;
                if (!iso_vti_covered(rest, boxes + 6, count - 1)) return false;
                left[a + 1] = boxes[a + 1];
            }
        }
        return true;
    }
    return false;
}
