/* vtp_files: arrays in all encodings of VTK's XML formats. */
#include "vtp_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "check_support.h"

enum { BLOCK = 100, ROOM = 1 << 20 };

/* Bytes that grow at their end. */
typedef struct bytes {
    unsigned char data[ROOM];
    size_t size;
} bytes;

typedef struct writer {
    FILE *file;
    const iso_lines *lines;
    const vtp_layout *layout;
    bytes appended, values, encoded;
    size_t first, last; /* lines of the piece */
} writer;

static void put(bytes *to, const void *data, size_t size) {
    assert_true(to->size + size <= ROOM);
    memcpy(to->data + to->size, data, size);
    to->size += size;
}

static void put_ordered(const writer *w, bytes *to, const void *number, size_t size) {
    const unsigned char *from = number; /* the tests run on little-endian machines */
    for (size_t i = 0; i < size; i++) put(to, from + (w->layout->big ? size - 1 - i : i), 1);
}

static void put_base64(bytes *to, const unsigned char *from, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const unsigned a = from[i], b = i + 1 < size ? from[i + 1] : 0, c = i + 2 < size ? from[i + 2] : 0;
        const unsigned bits = a << 16 | b << 8 | c;
        char text[4];
        for (int k = 0; k < 4; k++) text[k] = digits[bits >> (18 - 6 * k) & 63];
        if (i + 1 >= size) text[2] = '=';
        if (i + 2 >= size) text[3] = '=';
        put(to, text, 4);
    }
}

static void put_count(const writer *w, bytes *to, uint64_t count) {
    put_ordered(w, to, &count, w->layout->wide ? 8 : 4);
}

/* The numbers before the values, with the values behind them, or, compressed, apart. */
static void pack(writer *w, bytes *head, bytes *body) {
    head->size = body->size = 0;
    const size_t size = w->values.size, blocks = (size + BLOCK - 1) / BLOCK;
    if (!w->layout->compressed) {
        put_count(w, head, size);
        put(head, w->values.data, size);
        return;
    }
    put_count(w, head, blocks);
    put_count(w, head, BLOCK);
    put_count(w, head, size % BLOCK);
    for (size_t i = 0; i < blocks; i++) {
        const size_t count = size - i * BLOCK < BLOCK ? size - i * BLOCK : BLOCK;
        unsigned char packed[2 * BLOCK + 64];
        uLongf got = sizeof packed;
        assert_int_equal(compress(packed, &got, w->values.data + i * BLOCK, count), Z_OK);
        put_count(w, head, got);
        put(body, packed, got);
    }
}

/* Writes the element of an array whose numbers are in `values`, or, as text, in `text`. */
static void put_array(writer *w, const char *type, const char *name, int components, const char *text) {
    const vtp_layout *layout = w->layout;
    static const char *const formats[] = {"ascii", "binary", "appended"};
    fprintf(w->file, "<DataArray type=\"%s\" Name='%s' NumberOfComponents=\"%d\" format=\"%s\"", type, name,
            components, formats[layout->format]);
    if (layout->format == VTP_APPENDED)
        fprintf(w->file, " offset=\"%zu\"/>\n", w->appended.size);
    else
        fprintf(w->file, ">\n  ");
    if (layout->format == VTP_ASCII) {
        fprintf(w->file, "%s", text);
    } else {
        bytes *head = calloc(1, sizeof *head), *body = calloc(1, sizeof *body);
        bytes *to = layout->format == VTP_APPENDED ? &w->appended : &w->encoded;
        w->encoded.size = 0;
        pack(w, head, body);
        if (layout->raw) {
            put(to, head->data, head->size);
            put(to, body->data, body->size);
        } else {
            put_base64(to, head->data, head->size);
            put_base64(to, body->data, body->size);
        }
        fwrite(w->encoded.data, 1, w->encoded.size, w->file);
        free(head);
        free(body);
    }
    if (layout->format != VTP_APPENDED) fprintf(w->file, "\n</DataArray>\n");
    w->values.size = 0;
}

/* Adds a number to the array that is being made, in its type and as text. */
static void add_number(writer *w, char type, double number, char *text) {
    const float single = (float)number;
    /* as each type only where it is that: others may not hold the number */
    const int16_t whole = type == 's' ? (int16_t)number : 0;
    const int64_t large = type == 'l' ? (int64_t)number : 0;
    const uint8_t byte = type == 'b' ? (uint8_t)number : 0;
    if (type == 'f') put_ordered(w, &w->values, &single, 4);
    if (type == 'd') put_ordered(w, &w->values, &number, 8);
    if (type == 's') put_ordered(w, &w->values, &whole, 2);
    if (type == 'l') put_ordered(w, &w->values, &large, 8);
    if (type == 'b') put_ordered(w, &w->values, &byte, 1);
    const size_t length = strlen(text);
    snprintf(text + length, ROOM - length, "%.17g ", type == 'f' ? (double)single : number);
}

static double number_of(int array, size_t i, int k) {
    const double level[3] = {(double)((int)trk_scalar(0, i) % 256), 7, 255};
    return array == 3 ? level[k] : (double)trk_scalar(k, i);
}

static void put_point_data(writer *w, char *text) {
    static const char *const names[] = {"s0", "radius", "v", "c"},
                             *const types[] = {"Int16", "Float32", "Float64", "UInt8"}, letters[] = "sfdb";
    static const int components[] = {1, 1, 3, 3};
    fprintf(w->file, "<PointData Scalars=\"s0\" Vectors=\"v\">\n");
    for (int array = 0; array < 4; array++) {
        *text = 0;
        for (size_t i = w->lines->starts[w->last]; i-- > w->lines->starts[w->first];)
            for (int k = 0; k < components[array]; k++)
                add_number(w, letters[array], number_of(array, i, k), text);
        put_array(w, types[array], names[array], components[array], text);
    }
    fprintf(w->file, "</PointData>\n<CellData>\n");
    *text = 0;
    add_number(w, 'f', -1, text);
    for (size_t i = w->first; i < w->last; i++) add_number(w, 'f', (double)trk_property(0, i), text);
    put_array(w, "Float32", "p0", 1, text);
    fprintf(w->file, "</CellData>\n");
}

static void put_geometry(writer *w, char *text) {
    const size_t *starts = w->lines->starts, begin = starts[w->first], end = starts[w->last];
    const bool doubles = w->layout->doubles;
    fprintf(w->file, "<Points>\n");
    *text = 0;
    for (size_t i = end; i-- > begin;)
        for (int axis = 0; axis < 3; axis++)
            add_number(w, doubles ? 'd' : 'f', (double)w->lines->vertices[i][axis], text);
    put_array(w, doubles ? "Float64" : "Float32", "Points", 3, text);
    fprintf(w->file, "</Points>\n<Verts>\n</Verts>\n<Lines>\n");
    *text = 0;
    for (size_t i = begin; i < end; i++) add_number(w, 'l', (double)(end - 1 - i), text);
    put_array(w, "Int64", "connectivity", 1, text);
    *text = 0;
    for (size_t i = w->first; i < w->last; i++) add_number(w, 'l', (double)(starts[i + 1] - begin), text);
    put_array(w, "Int64", "offsets", 1, text);
    fprintf(w->file, "</Lines>\n");
}

static void put_appended(writer *w) {
    fprintf(w->file, "<AppendedData encoding=\"%s\">\n  _", w->layout->raw ? "raw" : "base64");
    fwrite(w->appended.data, 1, w->appended.size, w->file);
    fprintf(w->file, "\n</AppendedData>\n");
}

void write_vtp(const char *path, const iso_lines *lines, const vtp_layout *layout) {
    writer *w = calloc(1, sizeof *w);
    char *text = malloc(ROOM);
    w->file = fopen(path, "wb");
    w->lines = lines;
    w->layout = layout;
    fprintf(w->file,
            "<?xml version=\"1.0\"?>\n<!-- a > b -->\n<VTKFile type=\"PolyData\" version=\"1.0\" "
            "byte_order=\"%s\" "
            "header_type=\"%s\"%s>\n<PolyData>\n",
            layout->big ? "BigEndian" : "LittleEndian", layout->wide ? "UInt64" : "UInt32",
            layout->compressed ? " compressor=\"vtkZLibDataCompressor\"" : "");
    for (int piece = 0; piece < layout->pieces; piece++) {
        w->first = lines->line_count * (size_t)piece / (size_t)layout->pieces;
        w->last = lines->line_count * (size_t)(piece + 1) / (size_t)layout->pieces;
        fprintf(
            w->file,
            "<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"1\" NumberOfLines=\"%zu\" NumberOfPolys=\"0\">\n",
            lines->starts[w->last] - lines->starts[w->first], w->last - w->first);
        put_point_data(w, text);
        put_geometry(w, text);
        fprintf(w->file, "</Piece>\n");
    }
    fprintf(w->file, "</PolyData>\n");
    if (layout->format == VTP_APPENDED) put_appended(w);
    fprintf(w->file, "</VTKFile>\n");
    assert_int_equal(fclose(w->file), 0);
    free(text);
    free(w);
}
