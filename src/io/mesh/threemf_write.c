/* Writes meshes as 3MF (3D Manufacturing Format, core 1.3, with the colours of its materials extension): a
 * zip file with XML, in mm, an object each. */
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/decimal_point.h"
#include "base/text.h"
#include "io/mesh/mesh_source.h"

/* ---- the zip file: entries, deflated, and a directory of them */

enum { ENTRIES = 3, LEVEL = 6 };

typedef struct entry {
    const char *name;
    uint32_t crc, packed, bytes, offset;
} entry;

typedef struct zip {
    FILE *stream;
    entry entries[ENTRIES];
    int count;
    uint64_t at;
} zip;

static void put16(FILE *stream, unsigned value) {
    fputc((int)(value & 255), stream);
    fputc((int)(value >> 8 & 255), stream);
}

static void put32(FILE *stream, uint32_t value) {
    put16(stream, value & 65535);
    put16(stream, value >> 16);
}

/* What an entry's header and its row of the directory share. Files of 1980-01-01, so that bytes are the same.
 */
static void put_entry(FILE *stream, const entry *e) {
    put16(stream, 20); /* version that reads it: 2.0 */
    put16(stream, 0);
    put16(stream, 8); /* deflated */
    put16(stream, 0);
    put16(stream, 33);
    put32(stream, e->crc);
    put32(stream, e->packed);
    put32(stream, e->bytes);
    put16(stream, (unsigned)strlen(e->name));
    put16(stream, 0);
}

static iso_status fail_memory(iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

/* Deflates `length` bytes; *packed is the caller's: free(). False: no memory. */
static bool deflate_all(const char *bytes, size_t length, unsigned char **packed, size_t *size) {
    z_stream z = {0};
    if (deflateInit2(&z, LEVEL, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) return false;
    const size_t room = deflateBound(&z, length);
    *packed = malloc(room ? room : 1);
    z.next_in = (unsigned char *)(uintptr_t)bytes;
    z.avail_in = (uInt)length;
    z.next_out = *packed;
    z.avail_out = (uInt)room;
    const bool whole = *packed && deflate(&z, Z_FINISH) == Z_STREAM_END;
    *size = z.total_out;
    deflateEnd(&z);
    if (!whole) free(*packed);
    return whole;
}

static iso_status put_file(zip *z, const char *name, const char *bytes, size_t length, iso_error *error) {
    unsigned char *packed;
    size_t size;
    if (length >= UINT32_MAX / 2)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu bytes of text are more than a .3mf can hold: --decimate",
                        length);
    if (!deflate_all(bytes, length, &packed, &size)) return fail_memory(error);
    entry *e = &z->entries[z->count++];
    *e = (entry){name, (uint32_t)crc32(0, (const unsigned char *)bytes, (uInt)length), (uint32_t)size,
                 (uint32_t)length, (uint32_t)z->at};
    put32(z->stream, 0x04034b50);
    put_entry(z->stream, e);
    fputs(name, z->stream);
    fwrite(packed, 1, size, z->stream);
    z->at += 30 + strlen(name) + size;
    free(packed);
    return ISO_OK;
}

static void put_directory(const zip *z) {
    uint32_t size = 0;
    for (int i = 0; i < z->count; i++) {
        const entry *e = &z->entries[i];
        put32(z->stream, 0x02014b50);
        put16(z->stream, 20);
        put_entry(z->stream, e);
        for (int k = 0; k < 5; k++) put16(z->stream, 0); /* no comment, disk 0, no attributes */
        put32(z->stream, e->offset);
        fputs(e->name, z->stream);
        size += 46 + (uint32_t)strlen(e->name);
    }
    put32(z->stream, 0x06054b50);
    put32(z->stream, 0);
    put16(z->stream, (unsigned)z->count);
    put16(z->stream, (unsigned)z->count);
    put32(z->stream, size);
    put32(z->stream, (uint32_t)z->at);
    put16(z->stream, 0);
}

/* ---- the model */

static void put_text(FILE *stream, const char *text) {
    char *clean = iso_text_clean_copy(text ? text : "");
    for (const char *at = clean ? clean : ""; *at; at++)
        if (*at == '<' || *at == '&' || *at == '"')
            fprintf(stream, "&#%d;", *at);
        else
            fputc(*at, stream);
    free(clean);
}

static void put_color(FILE *stream, const uint8_t rgb[3], double opacity) {
    fprintf(stream, "#%02X%02X%02X%02X", rgb[0], rgb[1], rgb[2], (unsigned)(opacity * 255 + 0.5));
}

/* Object i has the resource 2 i + 1 for its colours and 2 i + 2 for itself. */
static void put_colors(FILE *stream, const mesh_source *source, int id) {
    const iso_weld *weld = source->weld;
    if (weld->colors) {
        fprintf(stream, "<m:colorgroup id=\"%d\">\n", id);
        for (size_t i = 0; i < weld->vertex_count; i++) {
            fputs("<m:color color=\"", stream);
            put_color(stream, weld->colors[i], source->opacity);
            fputs("\"/>\n", stream);
        }
        fputs("</m:colorgroup>\n", stream);
        return;
    }
    const iso_rgb plain = {229, 220, 200}, color = source->color ? *source->color : plain;
    fprintf(stream, "<basematerials id=\"%d\"><base name=\"", id);
    put_text(stream, source->name ? source->name : "surface");
    fputs("\" displaycolor=\"", stream);
    put_color(stream, (const uint8_t[3]){color.r, color.g, color.b}, source->opacity);
    fputs("\"/></basematerials>\n", stream);
}

static void put_object(FILE *stream, const mesh_source *source, int id) {
    put_colors(stream, source, id);
    fprintf(stream, "<object id=\"%d\" type=\"model\" pid=\"%d\" pindex=\"0\" name=\"", id + 1, id);
    put_text(stream, source->name ? source->name : "surface");
    fputs("\"><mesh><vertices>\n", stream);
    for (size_t i = 0; i < source->weld->vertex_count; i++) {
        const iso_vec3 p = iso_source_position(source, i);
        fprintf(stream, "<vertex x=\"%.9g\" y=\"%.9g\" z=\"%.9g\"/>\n", (double)(float)p.x,
                (double)(float)p.y, (double)(float)p.z);
    }
    fputs("</vertices><triangles>\n", stream);
    for (size_t i = 0; i < source->weld->triangle_count; i++) {
        uint32_t c[3];
        iso_source_triangle(source, i, c);
        fprintf(stream, "<triangle v1=\"%u\" v2=\"%u\" v3=\"%u\"", c[0], c[1], c[2]);
        if (source->weld->colors)
            fprintf(stream, " pid=\"%d\" p1=\"%u\" p2=\"%u\" p3=\"%u\"", id, c[0], c[1], c[2]);
        fputs("/>\n", stream);
    }
    fputs("</triangles></mesh></object>\n", stream);
}

static void put_model(FILE *stream, const mesh_source *sources, int count, const char *comment) {
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
          "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
          "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n"
          "<metadata name=\"Application\">",
          stream);
    put_text(stream, comment);
    fputs("</metadata>\n<resources>\n", stream);
    for (int i = 0; i < count; i++) put_object(stream, &sources[i], 2 * i + 1);
    fputs("</resources>\n<build>\n", stream);
    for (int i = 0; i < count; i++) fprintf(stream, "<item objectid=\"%d\"/>\n", 2 * i + 2);
    fputs("</build>\n</model>\n", stream);
}

iso_status iso_put_threemf(const mesh_source *sources, int count, const char *comment, FILE *stream,
                           iso_error *error) {
    static const char types[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
        "<Default Extension=\"rels\" "
        "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
        "<Default Extension=\"model\" "
        "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
        "</Types>\n";
    static const char relations[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
        "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
    char *model = NULL;
    size_t length = 0;
    FILE *memory = open_memstream(&model, &length);
    if (!memory) return fail_memory(error);
    void *numbers = iso_decimal_point_begin();
    put_model(memory, sources, count, comment);
    iso_decimal_point_end(numbers);
    const bool complete = !ferror(memory);
    if (!iso_memory_stream_close(memory, &model) || !complete) {
        if (!complete) free(model);
        return fail_memory(error);
    }
    zip z = {.stream = stream};
    iso_status status = put_file(&z, "[Content_Types].xml", types, sizeof types - 1, error);
    if (status == ISO_OK) status = put_file(&z, "_rels/.rels", relations, sizeof relations - 1, error);
    if (status == ISO_OK) status = put_file(&z, "3D/3dmodel.model", model, length, error);
    if (status == ISO_OK) put_directory(&z);
    free(model);
    return status;
}
