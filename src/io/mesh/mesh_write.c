/* Writes welded meshes as PLY, STL and OBJ, and chooses the writer of a format. */
#include "io/mesh/mesh_write.h"

#include <string.h>

#include "base/decimal_point.h"
#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "base/text.h"
#include "extract/mesh/mesh.h"
#include "io/common/encode.h"
#include "io/mesh/mesh_source.h"

/* ---- PLY */

enum { VERTEX_BYTES = 24, TRIANGLE_BYTES = 13 };

static void write_ply_header(FILE *stream, uint64_t vertices, uint64_t triangles, bool colors,
                             const char *comment) {
    fputs("ply\nformat binary_little_endian 1.0\n", stream);
    iso_encode_comment(stream, "comment ", comment);
    fprintf(stream, "element vertex %llu\n", (unsigned long long)vertices);
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz"};
    for (int i = 0; i < 6; i++) fprintf(stream, "property float %s\n", names[i]);
    if (colors) fputs("property uchar red\nproperty uchar green\nproperty uchar blue\n", stream);
    /* signed types of indices if they are large enough, because most readers expect them */
    fprintf(stream, "element face %llu\nproperty list uchar %s vertex_indices\nend_header\n",
            (unsigned long long)triangles, vertices <= INT32_MAX ? "int" : "uint");
}

static void write_ply_vertices(const mesh_source *source, size_t first, size_t end, FILE *stream) {
    unsigned char bytes[VERTEX_BYTES];
    for (size_t i = first; i < end; i++) {
        iso_encode_vec3(iso_encode_vec3(bytes, iso_source_position(source, i)), iso_source_normal(source, i));
        fwrite(bytes, sizeof bytes, 1, stream);
        if (source->weld->colors) fwrite(source->weld->colors[i], sizeof *source->weld->colors, 1, stream);
    }
}

static void write_ply_triangles(const mesh_source *source, size_t first, size_t end_triangle, FILE *stream) {
    unsigned char bytes[TRIANGLE_BYTES];
    for (size_t i = first; i < end_triangle; i++) {
        uint32_t corner[3];
        iso_source_triangle(source, i, corner);
        unsigned char *end = bytes;
        *end++ = 3;
        for (int j = 0; j < 3; j++) end = iso_encode_uint32(end, corner[j]);
        fwrite(bytes, sizeof bytes, 1, stream);
    }
}

static iso_status iso_put_ply(const mesh_source *source, int count, const char *comment, FILE *stream,
                              iso_error *error) {
    const iso_weld *weld = source->weld;
    (void)count, (void)error;
    write_ply_header(stream, weld->vertex_count, weld->triangle_count, weld->colors != NULL, comment);
    write_ply_vertices(source, 0, weld->vertex_count, stream);
    write_ply_triangles(source, 0, weld->triangle_count, stream);
    return ISO_OK;
}

/* ---- STL and OBJ */

static iso_status iso_put_stl(const mesh_source *source, int count, const char *comment, FILE *stream,
                              iso_error *error) {
    (void)count;
    if (source->weld->triangle_count > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu triangles are more than an .stl can hold",
                        source->weld->triangle_count);
    enum { HEADER = 80, FACET = 50 };
    /* must not begin with "solid", which marks ASCII files */
    static const char kind[] = "binary STL, mm. ";
    char header[HEADER + 1] = {0};
    memcpy(header, kind, sizeof kind);
    if (comment) iso_text_clean(comment, header + sizeof kind - 1, sizeof header - (sizeof kind - 1));
    unsigned char bytes[FACET] = {0};
    fwrite(header, HEADER, 1, stream);
    iso_encode_uint32(bytes, (uint32_t)source->weld->triangle_count);
    fwrite(bytes, 4, 1, stream);
    for (size_t i = 0; i < source->weld->triangle_count; i++) {
        uint32_t corner[3];
        iso_source_triangle(source, i, corner);
        iso_vec3 p[3];
        for (int j = 0; j < 3; j++) p[j] = iso_source_position(source, corner[j]);
        /* the format requires the triangle's own normal; zero if it has no area */
        iso_vec3 normal = iso_vec3_unit(iso_vec3_cross(iso_vec3_sub(p[1], p[0]), iso_vec3_sub(p[2], p[0])));
        unsigned char *end = iso_encode_vec3(bytes, normal);
        for (int j = 0; j < 3; j++) end = iso_encode_vec3(end, p[j]);
        end[0] = end[1] = 0; /* attribute byte count */
        fwrite(bytes, FACET, 1, stream);
    }
    return ISO_OK;
}

/* before: the number of vertices that are in the file already. */
static void write_obj_part(const mesh_source *source, uint64_t before, FILE *stream) {
    void *numbers = iso_decimal_point_begin();
    for (size_t i = 0; i < source->weld->vertex_count; i++) {
        iso_vec3 p = iso_source_position(source, i), n = iso_source_normal(source, i);
        /* nine digits are enough to read back the same float */
        fprintf(stream, "v %.9g %.9g %.9g", (double)(float)p.x, (double)(float)p.y, (double)(float)p.z);
        for (int k = 0; k < 3 && source->weld->colors; k++)
            fprintf(stream, " %.4g", source->weld->colors[i][k] / 255.0);
        fprintf(stream, "\nvn %.9g %.9g %.9g\n", (double)(float)n.x, (double)(float)n.y, (double)(float)n.z);
    }
    for (size_t i = 0; i < source->weld->triangle_count; i++) {
        uint32_t corner[3];
        iso_source_triangle(source, i, corner);
        uint64_t a = before + corner[0] + 1, b = before + corner[1] + 1, c = before + corner[2] + 1;
        fprintf(stream, "f %llu//%llu %llu//%llu %llu//%llu\n", (unsigned long long)a, (unsigned long long)a,
                (unsigned long long)b, (unsigned long long)b, (unsigned long long)c, (unsigned long long)c);
    }
    iso_decimal_point_end(numbers);
}

static iso_status iso_put_obj(const mesh_source *sources, int count, const char *comment, FILE *stream,
                              iso_error *error) {
    uint64_t vertices = 0;
    (void)error;
    iso_encode_comment(stream, "# ", comment);
    for (int i = 0; i < count; i++) {
        if (sources[i].name) {
            fputs("o ", stream);
            iso_text_put(stream, sources[i].name);
            fputc('\n', stream);
        }
        write_obj_part(&sources[i], vertices, stream);
        vertices += sources[i].weld->vertex_count;
    }
    return ISO_OK;
}

typedef iso_status write_fn(const mesh_source *sources, int count, const char *comment, FILE *stream,
                            iso_error *error);

static write_fn *writer_for(const char *path) {
    switch (iso_file_type_of_name(path, ISO_WRITES_MESH)) {
#define WRITE_MESH(writer) return iso_put_##writer;
#include "base/file_types.inc"
    default:
        break;
    }
    return NULL;
}

iso_status iso_mesh_write_check(const char *path, iso_error *error) {
    char known[64];
    if (writer_for(path)) return ISO_OK;
    iso_file_type_extensions(ISO_WRITES_MESH, 0, "or", known, sizeof known);
    return iso_fail(error, ISO_ERR_USAGE, "%s: a mesh is written as %s", path, known);
}

int iso_mesh_file_objects(const char *path) {
    write_fn *writer = writer_for(path);
    return writer == iso_put_obj || writer == iso_put_glb || writer == iso_put_threemf ? INT32_MAX : 1;
}

bool iso_mesh_file_has_opacities(const char *path) {
    write_fn *writer = writer_for(path);
    return writer == iso_put_glb || writer == iso_put_threemf;
}

static mesh_source source_of(const iso_mesh_object *object) {
    mesh_source source = {object->weld,  iso_transform_affine(object->transform),  1, 2, object->name,
                          object->color, object->opacity > 0 ? object->opacity : 1};
    if (source.affine.determinant < 0) {
        source.second = 2;
        source.third = 1;
    }
    return source;
}

iso_status iso_mesh_put_objects(FILE *stream, const char *path, const iso_mesh_object *objects, int count,
                                const char *comment, iso_error *error) {
    iso_error reason = {0};
    ISO_TRY(iso_mesh_write_check(path, error));
    if (count > iso_mesh_file_objects(path))
        return iso_fail(error, ISO_ERR_USAGE, "%s: holds one mesh, not %d: .obj, .glb and .3mf hold several",
                        path, count);
    mesh_source *sources = iso_alloc((size_t)count * sizeof *sources);
    if (!sources) return iso_fail_memory(error, path);
    for (int i = 0; i < count; i++) sources[i] = source_of(&objects[i]);
    const iso_status status = writer_for(path)(sources, count, comment, stream, &reason);
    iso_free(sources);
    return status == ISO_OK ? ISO_OK : iso_fail(error, status, "%s: %s", path, reason.text);
}

iso_status iso_mesh_put_weld(FILE *stream, const char *path, const iso_weld *weld,
                             const iso_transform *transform, const char *comment, iso_error *error) {
    const iso_mesh_object object = {.weld = weld, .transform = transform};
    return iso_mesh_put_objects(stream, path, &object, 1, comment, error);
}

iso_status iso_mesh_write_objects(const char *path, const iso_mesh_object *objects, int count,
                                  const char *comment, iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    const iso_status status = iso_mesh_put_objects(sink.stream, path, objects, count, comment, error);
    if (status == ISO_OK) return iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}

iso_status iso_mesh_write_weld(const char *path, const iso_weld *weld, const iso_transform *transform,
                               const char *comment, iso_error *error) {
    const iso_mesh_object object = {.weld = weld, .transform = transform};
    return iso_mesh_write_objects(path, &object, 1, comment, error);
}

iso_status iso_mesh_write(const char *path, const iso_mesh_view *view, const char *comment,
                          iso_error *error) {
    ISO_TRY(iso_mesh_write_check(path, error));
    iso_weld weld;
    ISO_TRY(iso_mesh_weld(view, NULL, &weld, error));
    iso_status status = iso_mesh_write_weld(path, &weld, &view->transform, comment, error);
    iso_weld_free(&weld);
    return status;
}

/* ---- files in pieces */

bool iso_mesh_file_takes(const char *path) {
    return writer_for(path) == iso_put_ply;
}

iso_status iso_mesh_file_begin(const char *path, const iso_mesh_file_opts *opts, iso_mesh_file *file,
                               iso_error *error) {
    *file = (iso_mesh_file){.transform = *opts->transform, .vertices = opts->vertices};
    ISO_TRY(iso_sink_open(path, &file->sink, error));
    write_ply_header(file->sink.stream, opts->vertices, opts->triangles, false, opts->comment);
    file->start = ftello(file->sink.stream);
    return ISO_OK;
}

void iso_mesh_file_put_vertices(iso_mesh_file *file, uint64_t number, const iso_weld *part, size_t first,
                                size_t end) {
    const mesh_source source = source_of(&(iso_mesh_object){.weld = part, .transform = &file->transform});
    fseeko(file->sink.stream, file->start + (off_t)(number * VERTEX_BYTES), SEEK_SET);
    write_ply_vertices(&source, first, end, file->sink.stream);
}

void iso_mesh_file_put_triangles(iso_mesh_file *file, uint64_t number, const iso_weld *part, size_t first,
                                 size_t end) {
    const mesh_source source = source_of(&(iso_mesh_object){.weld = part, .transform = &file->transform});
    const uint64_t at = file->vertices * VERTEX_BYTES + number * TRIANGLE_BYTES;
    fseeko(file->sink.stream, file->start + (off_t)at, SEEK_SET);
    write_ply_triangles(&source, first, end, file->sink.stream);
}
