/* points_write: writes points as binary little-endian PLY (Turk 1994). */
#include "io/points_io.h"

#include "base/file.h"
#include "io/encode.h"

enum { FLOATS_PER_POINT = 7, BYTES_PER_POINT = FLOATS_PER_POINT * 4 };

static void write_header(FILE *stream, size_t count, bool colored, const char *comment) {
    fputs("ply\nformat binary_little_endian 1.0\n", stream);
    iso_encode_comment(stream, "comment ", comment);
    fprintf(stream, "element vertex %zu\n", count);
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz", "radius"};
    static const char *const colors[] = {"red", "green", "blue"};
    for (int i = 0; i < FLOATS_PER_POINT; i++) fprintf(stream, "property float %s\n", names[i]);
    for (int i = 0; colored && i < 3; i++) fprintf(stream, "property uchar %s\n", colors[i]);
    fputs("end_header\n", stream);
}

/* Whether normals are written unchanged, because the transform's matrix is the identity. Normalizing them
 * again could change their last bit, and points that were read must be written with the same bytes. */
static bool keeps_normals(const iso_affine *affine) {
    for (int i = 0; i < 9; i++)
        if (affine->m[i] != (i % 4 == 0)) return false;
    return true;
}

static void write_span(FILE *stream, const iso_point_view *view, const iso_affine *affine,
                       const iso_point_span *span) {
    bool keep = keeps_normals(affine);
    for (uint32_t i = 0; i < span->count; i++) {
        iso_surfel surfel = iso_point_view_get(view, span->first + i);
        const float *p = surfel.position, *n = surfel.normal;
        iso_vec3 index = {span->brick[0] * (double)ISO_BRICK + p[0],
                          span->brick[1] * (double)ISO_BRICK + p[1],
                          span->brick[2] * (double)ISO_BRICK + p[2]};
        unsigned char bytes[BYTES_PER_POINT];
        unsigned char *end = iso_encode_vec3(bytes, iso_affine_point(affine, index));
        iso_vec3 normal = iso_vec3_make(n[0], n[1], n[2]);
        end = iso_encode_vec3(end, keep ? normal : iso_affine_normal(affine, normal));
        iso_encode_float(end, view->radii ? view->radii[span->first + i] : (float)view->radius);
        fwrite(bytes, sizeof bytes, 1, stream);
        if (view->colors) fwrite(view->colors[span->first + i], sizeof *view->colors, 1, stream);
    }
}

iso_status iso_points_write_ply(const char *path, const iso_point_view *view, const char *comment,
                                iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    iso_affine affine = iso_transform_affine(&view->transform);
    write_header(sink.stream, iso_point_view_count(view), view->colors != NULL, comment);
    for (size_t i = 0; i < view->span_count && !ferror(sink.stream); i++)
        write_span(sink.stream, view, &affine, &view->spans[i]);
    return iso_sink_commit(&sink, error);
}
