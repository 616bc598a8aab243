/* points_write: writes points as binary little-endian PLY (Turk 1994), also in pieces. */
#include "io/points_write.h"

#include <math.h>

#include "base/file.h"
#include "io/common/encode.h"

enum { MOST_BYTES_PER_POINT = 3 * 8 + 4 * 4, FAR = 16 };

/* Whether floats would lose what the points know of their places: the box lies far from 0, as do map
 * coordinates. Points keep their places to a float's precision of the distance from the middle of their box,
 * of which 16 times as large coordinates in floats would lose four bits. The box is taken to be at least as
 * large as 32 voxels: a few points far from 0 in relation to their box, but not to their size, lose nothing
 * that shows. */
static bool needs_doubles(const iso_box *box, const iso_transform *transform, const iso_affine *affine) {
    const double *spacing = transform->spacing;
    double largest = 0, half = 16 * fmin(spacing[0], fmin(spacing[1], spacing[2]));
    iso_box world = iso_box_empty();
    if (iso_box_is_empty(box)) return false;
    for (int corner = 0; corner < 8; corner++) {
        const iso_vec3 p = iso_affine_point(affine, iso_box_corner(box, corner));
        iso_box_add(&world, p);
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    const iso_vec3 size = iso_vec3_sub(world.hi, world.lo);
    half = fmax(half, fmax(size.x, fmax(size.y, size.z)) / 2);
    return largest > FAR * half;
}

static void write_header(const iso_point_file *file, const iso_point_file_opts *opts) {
    FILE *stream = file->sink.stream;
    fputs("ply\nformat binary_little_endian 1.0\n", stream);
    iso_encode_comment(stream, "comment ", opts->comment);
    if (opts->closed)
        fprintf(stream, "comment closed surface of %llu points\n", (unsigned long long)opts->count);
    fprintf(stream, "element vertex %llu\n", (unsigned long long)opts->count);
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz", "radius"};
    static const char *const colors[] = {"red", "green", "blue"};
    for (int i = 0; i < 7; i++)
        fprintf(stream, "property %s %s\n", i < 3 && file->doubles ? "double" : "float", names[i]);
    for (int i = 0; opts->colors && i < 3; i++) fprintf(stream, "property uchar %s\n", colors[i]);
    if (opts->opacities) fputs("property uchar alpha\n", stream);
    fputs("end_header\n", stream);
}

/* Whether normals are written unchanged, because the transform's matrix only scales, by the same positive
 * factor along all axes. Normalizing them again could change their last bit, and points that were read must
 * be written with the same bytes. */
static bool keeps_normals(const iso_affine *affine) {
    for (int i = 0; i < 9; i++)
        if (affine->m[i] != (i % 4 == 0 ? affine->m[0] : 0)) return false;
    return affine->m[0] > 0;
}

static unsigned char *encode_place(const iso_point_file *file, unsigned char *bytes, iso_vec3 place) {
    if (!file->doubles) return iso_encode_vec3(bytes, place);
    bytes = iso_encode_double(bytes, place.x);
    bytes = iso_encode_double(bytes, place.y);
    return iso_encode_double(bytes, place.z);
}

iso_status iso_point_file_begin(const char *path, const iso_point_file_opts *opts, iso_point_file *file,
                                iso_error *error) {
    *file = (iso_point_file){.affine = iso_transform_affine(opts->transform)};
    ISO_TRY(iso_sink_open(path, &file->sink, error));
    file->doubles = needs_doubles(opts->box, opts->transform, &file->affine);
    file->record =
        (file->doubles ? 3 * 8 : 3 * 4) + 4 * 4 + (opts->colors ? 3 : 0) + (opts->opacities ? 1 : 0);
    write_header(file, opts);
    file->start = ftello(file->sink.stream);
    return ISO_OK;
}

void iso_point_file_seek(iso_point_file *file, uint64_t number) {
    fseeko(file->sink.stream, file->start + (off_t)number * file->record, SEEK_SET);
}

void iso_point_file_put(iso_point_file *file, const iso_point_view *view, const iso_point_span *span) {
    const bool keep = keeps_normals(&file->affine);
    FILE *stream = file->sink.stream;
    for (uint32_t i = 0; i < span->count; i++) {
        const iso_surfel surfel = iso_point_view_get(view, span->first + i);
        const float *n = surfel.normal;
        unsigned char bytes[MOST_BYTES_PER_POINT];
        unsigned char *end = encode_place(
            file, bytes, iso_affine_point(&file->affine, iso_brick_position(span->brick, surfel.position)));
        const iso_vec3 normal = iso_vec3_make(n[0], n[1], n[2]);
        end = iso_encode_vec3(end, keep ? normal : iso_affine_normal(&file->affine, normal));
        end = iso_encode_float(end, view->radii ? view->radii[span->first + i] : (float)view->radius);
        fwrite(bytes, (size_t)(end - bytes), 1, stream);
        if (view->colors) fwrite(view->colors[span->first + i], sizeof *view->colors, 1, stream);
        if (view->opacities) fwrite(&view->opacities[span->first + i], 1, 1, stream);
    }
}

iso_status iso_points_write_ply(const char *path, const iso_point_view *view, const char *comment,
                                iso_error *error) {
    const iso_box box = iso_point_view_bounds(view);
    const iso_point_file_opts opts = {.count = iso_point_view_count(view),
                                      .box = &box,
                                      .transform = &view->transform,
                                      .colors = view->colors != NULL,
                                      .opacities = view->opacities != NULL,
                                      .closed = view->closed,
                                      .comment = comment};
    iso_point_file file;
    ISO_TRY(iso_point_file_begin(path, &opts, &file, error));
    for (size_t i = 0; i < view->span_count && !ferror(file.sink.stream); i++)
        iso_point_file_put(&file, view, &view->spans[i]);
    return iso_sink_commit(&file.sink, error);
}
