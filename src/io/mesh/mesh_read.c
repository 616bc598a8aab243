/* mesh_read: finds the reader of a mesh, and makes the checks that all formats share. */
#include "io/mesh/mesh_read.h"

#include <math.h>
#include <stdio.h>

#include "base/decimal_point.h"
#include "base/file_types.h"
#include "io/mesh/mesh_format.h"
#include "io/polydata/polydata.h"

/* Number of vertices or triangles between two reports of progress. */
enum { TELL = 1 << 14 };

static iso_status report_progress(const iso_mesh_reading *r, iso_error *error) {
    double done = 0;
    if (r->rows.at)
        done = r->bytes - (double)(r->rows.end - r->rows.at);
    else if (r->ply)
        done = r->bytes - (double)r->ply->in.remaining;
    else if (r->file)
        done = (double)ftello(r->file);
    return iso_progress_tell(r->progress, r->path, r->bytes > 0 ? done / r->bytes : 0, error);
}

iso_status iso_mesh_add_vertex(iso_mesh_reading *r, const double p[3], iso_error *error) {
    const size_t bytes = r->vertex_count * 3 * sizeof(float);
    if (r->vertex_count % TELL == 0) ISO_TRY(report_progress(r, error));
    ISO_TRY(iso_buffer_reserve(&r->vertices, bytes + 3 * sizeof(float), bytes, error));
    float *out = (float *)r->vertices.data + 3 * r->vertex_count++;
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = (float)p[axis];
        if (!isfinite(out[axis]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: vertex %zu is not finite", r->path, r->vertex_count);
    }
    return r->vertex_count < UINT32_MAX ? ISO_OK
                                        : iso_fail(error, ISO_ERR_LIMIT, "%s: too many vertices", r->path);
}

iso_status iso_mesh_add_color(iso_mesh_reading *r, const double rgb[3], iso_error *error) {
    const size_t one = 3 * sizeof(float), bytes = one * r->color_count;
    if (r->color_count + 1 != r->vertex_count) return ISO_OK; /* one before it has none */
    ISO_TRY(iso_buffer_reserve(&r->colors, bytes + one, bytes, error));
    float *out = (float *)r->colors.data + 3 * r->color_count++;
    for (int k = 0; k < 3; k++) out[k] = (float)rgb[k];
    return ISO_OK;
}

/* Colours of all vertices as bytes, in the place of the numbers; NULL: there are none. */
static uint8_t (*take_colors(iso_mesh_reading *r))[3] {
    const float *from = r->colors.data;
    uint8_t *to = r->colors.data;
    float most = 0;
    if (!r->color_count || r->color_count < r->vertex_count) {
        iso_buffer_free(&r->colors);
        return NULL;
    }
    for (size_t i = 0; i < 3 * r->color_count; i++) most = fmaxf(most, from[i]);
    const float factor = iso_polydata_color_factor(most, r->real_colors);
    for (size_t i = 0; i < 3 * r->color_count; i++) {
        const float value = factor * from[i]; /* a byte is written where numbers were read before */
        to[i] = (uint8_t)(value >= 255 ? 255 : value > 0 ? value + 0.5f : 0);
    }
    return r->colors.data;
}

iso_status iso_mesh_add_triangle(iso_mesh_reading *r, uint32_t a, uint32_t b, uint32_t c, iso_error *error) {
    const size_t bytes = r->triangle_count * 3 * sizeof(uint32_t);
    if (r->triangle_count % TELL == 0) ISO_TRY(report_progress(r, error));
    ISO_TRY(iso_buffer_reserve(&r->triangles, bytes + 3 * sizeof(uint32_t), bytes, error));
    uint32_t *out = (uint32_t *)r->triangles.data + 3 * r->triangle_count++;
    out[0] = a;
    out[1] = b;
    out[2] = c;
    return ISO_OK;
}

/* The triangles of a polygon are a fan for the time being (io/common/fans.h). */
iso_status iso_mesh_add_corner(iso_mesh_reading *r, iso_mesh_polygon *p, uint32_t corner, iso_error *error) {
    if (p->count == 0) p->first = corner;
    if (p->count >= 2) ISO_TRY(iso_mesh_add_triangle(r, p->first, p->last, corner, error));
    p->last = corner;
    p->count++;
    return ISO_OK;
}

iso_status iso_mesh_end_polygon(iso_mesh_reading *r, const iso_mesh_polygon *p, iso_error *error) {
    const size_t bytes = r->fan_count * sizeof(iso_fan);
    if (p->count < 4) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&r->fans, bytes + sizeof(iso_fan), bytes, error));
    ((iso_fan *)r->fans.data)[r->fan_count++] = (iso_fan){r->triangle_count - (p->count - 2), p->count};
    return ISO_OK;
}

iso_status iso_mesh_load_rows(iso_mesh_reading *r, iso_error *error) {
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    ISO_TRY(iso_text_rows_load(&r->text, &r->rows, error));
    r->bytes = (double)(r->rows.end - r->rows.at);
    return ISO_OK;
}

/* Checks the numbers of vertices, then divides concave polygons. */
static iso_status finish_mesh(const iso_mesh_reading *r, iso_error *error) {
    const uint32_t *corners = r->triangles.data;
    for (size_t i = 0; i < 3 * r->triangle_count; i++)
        if (corners[i] >= r->vertex_count)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: triangle %zu names vertex %u of %zu", r->path,
                            i / 3 + 1, corners[i], r->vertex_count);
    if (r->triangle_count == 0) return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no triangles", r->path);
    return iso_fans_divide(r->path, r->fans.data, r->fan_count, (const float(*)[3])r->vertices.data,
                           r->triangles.data, error);
}

typedef iso_status read_fn(iso_mesh_reading *r, iso_error *error);

static read_fn *reader_of(iso_file_type type) {
    switch (type) {
#define MESH(reader) return iso_mesh_read_##reader;
#include "base/file_types.inc"
    default:
        break;
    }
    return NULL;
}

static iso_status read_any(iso_mesh_reading *r, iso_error *error) {
    char known[128];
    read_fn *read = reader_of(iso_file_type_find(r->path, ISO_HOLDS_MESH));
    if (read) return read(r, error);
    iso_file_type_extensions(ISO_HOLDS_MESH, 0, "and", known, sizeof known);
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: meshes are read from %s", r->path, known);
}

iso_status iso_mesh_read(const char *path, const iso_progress *progress, iso_triangles *mesh,
                         iso_error *error) {
    iso_mesh_reading r = {.path = path, .progress = progress};
    void *numbers = iso_decimal_point_begin();
    iso_status status = read_any(&r, error);
    iso_decimal_point_end(numbers);
    iso_text_rows_free(&r.rows);
    if (status == ISO_OK) status = finish_mesh(&r, error);
    iso_buffer_free(&r.fans);
    if (status != ISO_OK) {
        iso_buffer_free(&r.colors);
        iso_buffer_free(&r.vertices);
        iso_buffer_free(&r.triangles);
        return status;
    }
    *mesh =
        (iso_triangles){r.vertices.data, r.triangles.data, r.vertex_count, r.triangle_count, take_colors(&r)};
    return ISO_OK;
}
