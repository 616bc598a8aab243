/* points_write: writes points as binary little-endian PLY (Turk 1994). */
#include "io/points_io.h"

#include <math.h>

#include "base/file.h"
#include "io/encode.h"

enum { MOST_BYTES_PER_POINT = 3 * 8 + 4 * 4, FAR = 16 };

/* The file that is being written. */
typedef struct writer {
    FILE *stream;
    const iso_point_view *view;
    iso_affine affine;
    bool doubles; /* coordinates are written as doubles */
} writer;

/* Whether floats would lose what the points know of their places: the box lies far from 0, as do map
 * coordinates. Points keep their places to a float's precision of the distance from the middle of their box,
 * of which 16 times as large coordinates in floats would lose four bits. The box is taken to be at least as
 * large as 32 voxels: a few points far from 0 in relation to their box, but not to their size, lose nothing
 * that shows. */
static bool needs_doubles(const iso_point_view *view, const iso_affine *affine) {
    const iso_box box = iso_point_view_bounds(view);
    const double *spacing = view->transform.spacing;
    double largest = 0, half = 16 * fmin(spacing[0], fmin(spacing[1], spacing[2]));
    iso_box world = iso_box_empty();
    if (iso_box_is_empty(&box)) return false;
    for (int corner = 0; corner < 8; corner++) {
        const iso_vec3 p = iso_affine_point(affine, iso_box_corner(&box, corner));
        iso_box_add(&world, p);
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    const iso_vec3 size = iso_vec3_sub(world.hi, world.lo);
    half = fmax(half, fmax(size.x, fmax(size.y, size.z)) / 2);
    return largest > FAR * half;
}

static void write_header(const writer *w, const char *comment) {
    fputs("ply\nformat binary_little_endian 1.0\n", w->stream);
    iso_encode_comment(w->stream, "comment ", comment);
    fprintf(w->stream, "element vertex %zu\n", iso_point_view_count(w->view));
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz", "radius"};
    static const char *const colors[] = {"red", "green", "blue"};
    for (int i = 0; i < 7; i++)
        fprintf(w->stream, "property %s %s\n", i < 3 && w->doubles ? "double" : "float", names[i]);
    for (int i = 0; w->view->colors && i < 3; i++) fprintf(w->stream, "property uchar %s\n", colors[i]);
    fputs("end_header\n", w->stream);
}

/* Whether normals are written unchanged, because the transform's matrix is the identity. Normalizing them
 * again could change their last bit, and points that were read must be written with the same bytes. */
static bool keeps_normals(const iso_affine *affine) {
    for (int i = 0; i < 9; i++)
        if (affine->m[i] != (i % 4 == 0)) return false;
    return true;
}

static unsigned char *encode_place(const writer *w, unsigned char *bytes, iso_vec3 place) {
    if (!w->doubles) return iso_encode_vec3(bytes, place);
    bytes = iso_encode_double(bytes, place.x);
    bytes = iso_encode_double(bytes, place.y);
    return iso_encode_double(bytes, place.z);
}

static void write_span(const writer *w, const iso_point_span *span) {
    const iso_point_view *view = w->view;
    const bool keep = keeps_normals(&w->affine);
    for (uint32_t i = 0; i < span->count; i++) {
        const iso_surfel surfel = iso_point_view_get(view, span->first + i);
        const float *n = surfel.normal;
        unsigned char bytes[MOST_BYTES_PER_POINT];
        unsigned char *end = encode_place(
            w, bytes, iso_affine_point(&w->affine, iso_brick_position(span->brick, surfel.position)));
        const iso_vec3 normal = iso_vec3_make(n[0], n[1], n[2]);
        end = iso_encode_vec3(end, keep ? normal : iso_affine_normal(&w->affine, normal));
        end = iso_encode_float(end, view->radii ? view->radii[span->first + i] : (float)view->radius);
        fwrite(bytes, (size_t)(end - bytes), 1, w->stream);
        if (view->colors) fwrite(view->colors[span->first + i], sizeof *view->colors, 1, w->stream);
    }
}

iso_status iso_points_write_ply(const char *path, const iso_point_view *view, const char *comment,
                                iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    writer w = {.stream = sink.stream, .view = view, .affine = iso_transform_affine(&view->transform)};
    w.doubles = needs_doubles(view, &w.affine);
    write_header(&w, comment);
    for (size_t i = 0; i < view->span_count && !ferror(sink.stream); i++) write_span(&w, &view->spans[i]);
    return iso_sink_commit(&sink, error);
}
