/* hybrid: parts bricks into those drawn as points and those drawn as triangles. */
#include "render/pullpush/hybrid.h"

#include "base/memory.h"
#include "render/points/point_blocks.h"
#include "render/pullpush/polygon_fragments.h"

static const double CELL_PIXELS = 3;

bool iso_matrix_invert(const double m[9], double out[9]) {
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

iso_status iso_hybrid_parts_make(const iso_view *view, const iso_point_view *points,
                                 const iso_mesh_view *mesh, double pixels, iso_hybrid_parts *parts,
                                 iso_error *error) {
    const double *s = points->transform.spacing;
    *parts = (iso_hybrid_parts){.choice = {.projector = iso_projector_make(view, &points->transform),
                                           .cell = iso_max(s[0], iso_max(s[1], s[2])),
                                           .pixels = pixels > 0 ? pixels : CELL_PIXELS},
                                .points = *points,
                                .mesh = *mesh,
                                .point_spans = iso_alloc((points->span_count + 1) * sizeof *points->spans),
                                .mesh_spans = iso_alloc((mesh->span_count + 1) * sizeof *mesh->spans)};
    if (!parts->point_spans || !parts->mesh_spans) return iso_fail_memory(error, "hybrid");
    parts->points.span_count = parts->mesh.span_count = 0;
    for (size_t i = 0; i < points->span_count; i++)
        if (!iso_brick_is_large(&parts->choice, points->spans[i].brick))
            parts->point_spans[parts->points.span_count++] = points->spans[i];
    for (size_t i = 0; i < mesh->span_count; i++)
        if (iso_brick_is_large(&parts->choice, mesh->spans[i].brick))
            parts->mesh_spans[parts->mesh.span_count++] = mesh->spans[i];
    parts->points.spans = parts->point_spans;
    parts->mesh.spans = parts->mesh_spans;
    parts->points.versions = parts->mesh.versions = NULL;
    parts->points.bounds = parts->mesh.bounds = NULL;
    return ISO_OK;
}

void iso_hybrid_parts_free(iso_hybrid_parts *parts) {
    iso_free(parts->point_spans);
    iso_free(parts->mesh_spans);
    parts->point_spans = NULL;
    parts->mesh_spans = NULL;
}

static iso_status draw_parts(const iso_target *target, const iso_hybrid_parts *parts, iso_pullpush *workspace,
                             iso_error *error) {
    const iso_pullpush_opts gaussian = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN,
                                        .workspace = workspace};
    if (!parts->mesh.span_count) return iso_draw_pullpush(target, &parts->points, &gaussian, error);
    iso_polygon_set set = {.mesh = &parts->mesh,
                           .surface = target->surface,
                           .choice = &parts->choice,
                           .radius = ISO_DISC_RADII * parts->points.radius};
    iso_polygons polygons = {.sets = &set, .count = 1, .projector = parts->choice.projector};
    double normal[9], inverse[9];
    for (int k = 0; k < 9; k++) normal[k] = (double)parts->choice.projector.normal[k];
    if (!parts->points.span_count || !iso_matrix_invert(parts->choice.projector.matrix, set.to_index) ||
        !iso_matrix_invert(normal, inverse))
        return iso_draw_mesh(target, &parts->mesh, error);
    for (int k = 0; k < 9; k++) polygons.normal[k] = (float)inverse[k];
    const iso_status status =
        iso_draw_points_and_polygons(target, &parts->points, &polygons, workspace, error);
    iso_gbuffer_free(&polygons.picture);
    return status;
}

iso_status iso_draw_hybrid(const iso_target *target, const iso_point_view *points, const iso_mesh_view *mesh,
                           const iso_hybrid_opts *opts, iso_error *error) {
    iso_hybrid_parts parts;
    iso_status status =
        iso_hybrid_parts_make(target->view, points, mesh, opts ? opts->pixels : 0, &parts, error);
    if (status == ISO_OK) status = draw_parts(target, &parts, opts ? opts->workspace : NULL, error);
    iso_hybrid_parts_free(&parts);
    return status;
}
