/* Writes meshes as binary glTF 2.0 (.glb): a node an object, with normals, and a colour or colours of
 * vertices.
 *
 * glTF has metres and y up: the root node turns and scales the world's mm, in which the vertices are. Colours
 * are linear there; those of vertices have 16 bits, which is what 8 bits of sRGB need. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/decimal_point.h"
#include "base/srgb.h"
#include "base/text.h"
#include "io/common/encode.h"
#include "io/mesh/mesh_source.h"

enum { VECTOR = 12, COLOR = 8, INDEX = 4 };

static uint64_t bytes_of(const mesh_source *source) {
    const iso_weld *weld = source->weld;
    return weld->vertex_count * (uint64_t)(2 * VECTOR + (weld->colors ? COLOR : 0)) +
           weld->triangle_count * (uint64_t)(3 * INDEX);
}

/* A text within a JSON string. */
static void put_string(FILE *stream, const char *text) {
    char *clean = iso_text_clean_copy(text ? text : "");
    fputc('"', stream);
    for (const char *at = clean ? clean : ""; *at; at++) {
        if (*at == '"' || *at == '\\') fputc('\\', stream);
        fputc(*at, stream);
    }
    fputc('"', stream);
    free(clean);
}

static void put_triple(FILE *stream, const float v[3]) {
    fprintf(stream, "[%.9g,%.9g,%.9g]", (double)v[0], (double)v[1], (double)v[2]);
}

/* Viewers need the box of the positions, as floats. */
static void put_bounds(FILE *stream, const mesh_source *source) {
    float lo[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, hi[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (size_t i = 0; i < source->weld->vertex_count; i++) {
        const iso_vec3 p = iso_source_position(source, i);
        const float v[3] = {(float)p.x, (float)p.y, (float)p.z};
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = fminf(lo[axis], v[axis]);
            hi[axis] = fmaxf(hi[axis], v[axis]);
        }
    }
    fputs(",\"min\":", stream);
    put_triple(stream, lo);
    fputs(",\"max\":", stream);
    put_triple(stream, hi);
}

static void put_view(FILE *stream, bool first, uint64_t *at, uint64_t bytes, bool indices) {
    fprintf(stream, "%s{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu,\"target\":%d}",
            first ? "" : ",", (unsigned long long)*at, (unsigned long long)bytes, indices ? 34963 : 34962);
    *at += bytes;
}

static void put_views(FILE *stream, const mesh_source *sources, int count) {
    uint64_t at = 0;
    fputs("\"bufferViews\":[", stream);
    for (int i = 0; i < count; i++) {
        const iso_weld *weld = sources[i].weld;
        put_view(stream, i == 0, &at, weld->vertex_count * VECTOR, false);
        put_view(stream, false, &at, weld->vertex_count * VECTOR, false);
        if (weld->colors) put_view(stream, false, &at, weld->vertex_count * COLOR, false);
        put_view(stream, false, &at, weld->triangle_count * 3 * INDEX, true);
    }
    fputs("],", stream);
}

static void put_accessors(FILE *stream, const mesh_source *sources, int count) {
    int view = 0;
    fputs("\"accessors\":[", stream);
    for (int i = 0; i < count; i++) {
        const iso_weld *weld = sources[i].weld;
        const unsigned long long vertices = weld->vertex_count, indices = 3 * weld->triangle_count;
        fprintf(stream, "%s{\"bufferView\":%d,\"componentType\":5126,\"count\":%llu,\"type\":\"VEC3\"",
                i ? "," : "", view++, vertices);
        put_bounds(stream, &sources[i]);
        fprintf(stream, "},{\"bufferView\":%d,\"componentType\":5126,\"count\":%llu,\"type\":\"VEC3\"}",
                view++, vertices);
        if (weld->colors)
            fprintf(stream,
                    ",{\"bufferView\":%d,\"componentType\":5123,\"normalized\":true,\"count\":%llu,\"type\":"
                    "\"VEC4\"}",
                    view++, vertices);
        fprintf(stream, ",{\"bufferView\":%d,\"componentType\":5125,\"count\":%llu,\"type\":\"SCALAR\"}",
                view++, indices);
    }
    fputs("],", stream);
}

static void put_meshes(FILE *stream, const mesh_source *sources, int count) {
    int accessor = 0;
    fputs("\"meshes\":[", stream);
    for (int i = 0; i < count; i++) {
        fprintf(stream, "%s{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"NORMAL\":%d", i ? "," : "",
                accessor, accessor + 1);
        accessor += 2;
        if (sources[i].weld->colors) fprintf(stream, ",\"COLOR_0\":%d", accessor++);
        fprintf(stream, "},\"indices\":%d,\"material\":%d}]}", accessor++, i);
    }
    fputs("],\"materials\":[", stream);
    for (int i = 0; i < count; i++) {
        const mesh_source *source = &sources[i];
        double rgb[3] = {1, 1, 1};
        if (source->color && !source->weld->colors) {
            const uint8_t display[3] = {source->color->r, source->color->g, source->color->b};
            for (int k = 0; k < 3; k++) rgb[k] = iso_srgb_decode(display[k] / 255.0);
        }
        fprintf(stream,
                "%s{\"pbrMetallicRoughness\":{\"baseColorFactor\":[%.6g,%.6g,%.6g,%.6g],\"metallicFactor\":0,"
                "\"roughnessFactor\":0.6},\"doubleSided\":true%s}",
                i ? "," : "", rgb[0], rgb[1], rgb[2], source->opacity,
                source->opacity < 1 ? ",\"alphaMode\":\"BLEND\"" : "");
    }
    fputs("],", stream);
}

static void put_nodes(FILE *stream, const mesh_source *sources, int count) {
    fputs("\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"world, "
          "mm\",\"scale\":[0.001,0.001,0.001],"
          "\"rotation\":[-0.70710678118654752,0,0,0.70710678118654752],\"children\":[",
          stream);
    for (int i = 0; i < count; i++) fprintf(stream, "%s%d", i ? "," : "", i + 1);
    fputs("]}", stream);
    for (int i = 0; i < count; i++) {
        fprintf(stream, ",{\"mesh\":%d,\"name\":", i);
        put_string(stream, sources[i].name ? sources[i].name : "surface");
        fputc('}', stream);
    }
    fputs("],", stream);
}

static void put_json(FILE *stream, const mesh_source *sources, int count, const char *comment,
                     uint64_t bytes) {
    fputs("{\"asset\":{\"version\":\"2.0\",\"generator\":", stream);
    put_string(stream, comment);
    fputs("},", stream);
    put_nodes(stream, sources, count);
    put_meshes(stream, sources, count);
    put_accessors(stream, sources, count);
    put_views(stream, sources, count);
    fprintf(stream, "\"buffers\":[{\"byteLength\":%llu}]}", (unsigned long long)bytes);
}

static unsigned char *encode_channel(unsigned char *at, double value) {
    const unsigned whole = (unsigned)(value * 65535 + 0.5);
    *at++ = (unsigned char)whole;
    *at++ = (unsigned char)(whole >> 8);
    return at;
}

static void put_colors(FILE *stream, const iso_weld *weld) {
    double linear[256];
    for (int i = 0; i < 256; i++) linear[i] = iso_srgb_decode(i / 255.0);
    for (size_t i = 0; i < weld->vertex_count; i++) {
        unsigned char bytes[COLOR], *end = bytes;
        for (int k = 0; k < 3; k++) end = encode_channel(end, linear[weld->colors[i][k]]);
        encode_channel(end, 1);
        fwrite(bytes, sizeof bytes, 1, stream);
    }
}

static void put_vectors(FILE *stream, const mesh_source *source, bool normals) {
    for (size_t i = 0; i < source->weld->vertex_count; i++) {
        unsigned char bytes[VECTOR];
        iso_vec3 v = normals ? iso_vec3_unit(iso_source_normal(source, i)) : iso_source_position(source, i);
        if (normals && !(iso_vec3_length(v) > 0.5))
            v = iso_vec3_make(0, 0, 1); /* (they have length 1 in the format) */
        iso_encode_vec3(bytes, v);
        fwrite(bytes, sizeof bytes, 1, stream);
    }
}

static void put_binary(FILE *stream, const mesh_source *source) {
    put_vectors(stream, source, false);
    put_vectors(stream, source, true);
    if (source->weld->colors) put_colors(stream, source->weld);
    for (size_t i = 0; i < source->weld->triangle_count; i++) {
        uint32_t corner[3];
        unsigned char bytes[3 * INDEX], *end = bytes;
        iso_source_triangle(source, i, corner);
        for (int k = 0; k < 3; k++) end = iso_encode_uint32(end, corner[k]);
        fwrite(bytes, sizeof bytes, 1, stream);
    }
}

static void put_words(FILE *stream, uint32_t first, uint32_t second, uint32_t third, int count) {
    unsigned char bytes[12];
    iso_encode_uint32(iso_encode_uint32(iso_encode_uint32(bytes, first), second), third);
    fwrite(bytes, 4, (size_t)count, stream);
}

iso_status iso_put_glb(const mesh_source *sources, int count, const char *comment, FILE *stream,
                       iso_error *error) {
    char *json = NULL;
    size_t length = 0;
    uint64_t bytes = 0;
    for (int i = 0; i < count; i++) bytes += bytes_of(&sources[i]);
    FILE *memory = open_memstream(&json, &length);
    if (!memory) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    void *numbers = iso_decimal_point_begin();
    put_json(memory, sources, count, comment, bytes);
    iso_decimal_point_end(numbers);
    if (!iso_memory_stream_close(memory, &json)) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const size_t padded = (length + 3) / 4 * 4;
    if (28 + padded + bytes > UINT32_MAX) {
        free(json);
        return iso_fail(error, ISO_ERR_LIMIT, "%llu bytes are more than a .glb can hold",
                        (unsigned long long)bytes);
    }
    put_words(stream, 0x46546C67u, 2, (uint32_t)(28 + padded + bytes), 3); /* "glTF" */
    put_words(stream, (uint32_t)padded, 0x4E4F534Au, 0, 2);                /* "JSON" */
    fwrite(json, 1, length, stream);
    for (size_t i = length; i < padded; i++) fputc(' ', stream);
    put_words(stream, (uint32_t)bytes, 0x004E4942u, 0, 2); /* "BIN" */
    for (int i = 0; i < count; i++) put_binary(stream, &sources[i]);
    free(json);
    return ISO_OK;
}
