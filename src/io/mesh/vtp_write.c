/* Writes a mesh as VTK's XML polydata (.vtp), its numbers appended as they are, with normals and colours. */
#include "io/common/encode.h"
#include "io/mesh/mesh_source.h"

typedef struct array {
    const char *type, *name;
    int components;
    uint64_t bytes;
} array;

static void put_array(FILE *stream, const array *a, uint64_t *offset) {
    fprintf(stream,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
            "offset=\"%llu\"/>\n",
            a->type, a->name, a->components, (unsigned long long)*offset);
    *offset += 8 + a->bytes;
}

static void put_uint64(FILE *stream, uint64_t value) {
    unsigned char bytes[8];
    iso_encode_uint32(iso_encode_uint32(bytes, (uint32_t)value), (uint32_t)(value >> 32));
    fwrite(bytes, sizeof bytes, 1, stream);
}

static void put_vectors(FILE *stream, const mesh_source *source, bool normals) {
    put_uint64(stream, 12 * (uint64_t)source->weld->vertex_count);
    for (size_t i = 0; i < source->weld->vertex_count; i++) {
        unsigned char bytes[12];
        iso_encode_vec3(bytes, normals ? iso_source_normal(source, i) : iso_source_position(source, i));
        fwrite(bytes, sizeof bytes, 1, stream);
    }
}

iso_status iso_put_vtp(const mesh_source *source, int count, const char *comment, FILE *stream,
                       iso_error *error) {
    const iso_weld *weld = source->weld;
    const uint64_t vertices = weld->vertex_count, triangles = weld->triangle_count;
    const array normals = {"Float32", "Normals", 3, 12 * vertices},
                colors = {"UInt8", "Colors", 3, 3 * vertices},
                points = {"Float32", "Points", 3, 12 * vertices},
                corners = {"Int64", "connectivity", 1, 24 * triangles},
                ends = {"Int64", "offsets", 1, 8 * triangles};
    uint64_t offset = 0;
    (void)count, (void)error;
    fputs("<?xml version=\"1.0\"?>\n", stream);
    iso_encode_comment(stream, "<!-- ", comment ? comment : "");
    fprintf(stream,
            "-->\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
            "header_type=\"UInt64\">\n"
            "<PolyData>\n<Piece NumberOfPoints=\"%llu\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
            "NumberOfStrips=\"0\" "
            "NumberOfPolys=\"%llu\">\n<PointData Normals=\"Normals\"%s>\n",
            (unsigned long long)vertices, (unsigned long long)triangles,
            weld->colors ? " Scalars=\"Colors\"" : "");
    put_array(stream, &normals, &offset);
    if (weld->colors) put_array(stream, &colors, &offset);
    fputs("</PointData>\n<Points>\n", stream);
    put_array(stream, &points, &offset);
    fputs("</Points>\n<Polys>\n", stream);
    put_array(stream, &corners, &offset);
    put_array(stream, &ends, &offset);
    fputs("</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", stream);
    put_vectors(stream, source, true);
    if (weld->colors) {
        put_uint64(stream, colors.bytes);
        fwrite(weld->colors, sizeof *weld->colors, weld->vertex_count, stream);
    }
    put_vectors(stream, source, false);
    put_uint64(stream, corners.bytes);
    for (size_t i = 0; i < weld->triangle_count; i++) {
        uint32_t corner[3];
        iso_source_triangle(source, i, corner);
        for (int k = 0; k < 3; k++) put_uint64(stream, corner[k]);
    }
    put_uint64(stream, ends.bytes);
    for (uint64_t i = 1; i <= triangles; i++) put_uint64(stream, 3 * i);
    fputs("\n</AppendedData>\n</VTKFile>\n", stream);
    return ISO_OK;
}
