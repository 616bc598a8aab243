/* hybrid: parts bricks into those drawn as points and those drawn as triangles. */
#include "render/pullpush/hybrid.h"

#include "base/memory.h"
#include "render/point_blocks.h"
#include "render/pullpush/polygon_fragments.h"

static const double CELL_PIXELS = 3;

/* Inverse of a 3x3 matrix; false: it has none. */
static bool invert(const double m[9], double out[9]) {
    double determinant = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int a = (r + 1) % 3, b = (r + 2) % 3, d = (c + 1) % 3, e = (c + 2) % 3;
            out[3 * c + r] = m[3 * a + d] * m[3 * b + e] - m[3 * a + e] * m[3 * b + d];
        }
    for (int k = 0; k < 3; k++) determinant += m[k] * out[3 * k];
    for (int k = 0; k < 9; k++) out[k] /= determinant;
    return determinant != 0;
}

typedef struct spans {
    iso_point_span *points; /* of small bricks */
    iso_mesh_span *mesh;    /* of large bricks */
    size_t point_count, mesh_count;
} spans;

static iso_status part_spans(const iso_brick_choice *choice, const iso_point_view *points,
                             const iso_mesh_view *mesh, spans *out, iso_error *error) {
    out->points = iso_alloc((points->span_count + 1) * sizeof *out->points);
    out->mesh = iso_alloc((mesh->span_count + 1) * sizeof *out->mesh);
    if (!out->points || !out->mesh) return iso_fail_memory(error, "hybrid");
    for (size_t i = 0; i < points->span_count; i++)
        if (!iso_brick_is_large(choice, points->spans[i].brick))
            out->points[out->point_count++] = points->spans[i];
    for (size_t i = 0; i < mesh->span_count; i++)
        if (iso_brick_is_large(choice, mesh->spans[i].brick)) out->mesh[out->mesh_count++] = mesh->spans[i];
    return ISO_OK;
}

static iso_status draw_parts(const iso_target *target, const iso_point_view *points,
                             const iso_mesh_view *mesh, const iso_brick_choice *choice,
                             iso_pullpush *workspace, iso_error *error) {
    const iso_pullpush_opts gaussian = {ISO_RECONSTRUCTION_GAUSSIAN, workspace};
    if (!mesh->span_count) return iso_draw_pullpush(target, points, &gaussian, error);
    iso_polygons polygons = {.mesh = mesh, .choice = *choice, .radius = ISO_DISC_RADII * points->radius};
    double normal[9], inverse[9];
    for (int k = 0; k < 9; k++) normal[k] = (double)choice->projector.normal[k];
    if (!points->span_count || !invert(choice->projector.matrix, polygons.to_index) ||
        !invert(normal, inverse))
        return iso_draw_mesh(target, mesh, error);
    for (int k = 0; k < 9; k++) polygons.normal[k] = (float)inverse[k];
    const iso_status status = iso_draw_points_and_polygons(target, points, &polygons, workspace, error);
    iso_gbuffer_free(&polygons.picture);
    return status;
}

iso_status iso_draw_hybrid(const iso_target *target, const iso_point_view *points, const iso_mesh_view *mesh,
                           const iso_hybrid_opts *opts, iso_error *error) {
    const double *s = points->transform.spacing;
    const iso_brick_choice choice = {.projector = iso_projector_make(target->view, &points->transform),
                                     .cell = iso_max(s[0], iso_max(s[1], s[2])),
                                     .pixels = opts && opts->pixels > 0 ? opts->pixels : CELL_PIXELS};
    spans parts = {0};
    iso_status status = part_spans(&choice, points, mesh, &parts, error);
    if (status == ISO_OK) {
        iso_point_view some_points = *points;
        iso_mesh_view some_mesh = *mesh;
        some_points.spans = parts.points;
        some_points.span_count = parts.point_count;
        some_points.versions = NULL;
        some_points.bounds = NULL;
        some_mesh.spans = parts.mesh;
        some_mesh.span_count = parts.mesh_count;
        some_mesh.versions = NULL;
        some_mesh.bounds = NULL;
        status = draw_parts(target, &some_points, &some_mesh, &choice, opts ? opts->workspace : NULL, error);
    }
    iso_free(parts.points);
    iso_free(parts.mesh);
    return status;
}
