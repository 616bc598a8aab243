/* The functions of isopoint_lines.h: meshes of thin branches as lines. */
#include "api/internal.h"
#include "base/memory.h"
#include "extract/lines/mesh_lines.h"

/* Takes the arrays of lines, which then are world coordinates without an origin. */
static iso_line_arrays take_lines(iso_lines *lines) {
    const double origin[3] = {lines->origin.x, lines->origin.y, lines->origin.z};
    if (!lines->line_count) return (iso_line_arrays){.line_count = 0};
    for (size_t i = 0; i < lines->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            lines->vertices[i][k] = (float)((double)lines->vertices[i][k] + origin[k]);
    const iso_line_arrays arrays = {.vertices = lines->vertices[0],
                                    .starts = lines->starts,
                                    .line_count = lines->line_count,
                                    .radii = lines->radii,
                                    .normals = lines->normals ? lines->normals[0] : NULL};
    *lines = (iso_lines){.line_count = 0};
    return arrays;
}

static iso_status make(const char *name, const iso_triangles *triangles, iso_branches *branches,
                       iso_error *error) {
    iso_mesh_lines made = {.pieces = 0};
    ISO_TRY(iso_mesh_lines_make(name, triangles, &made, error));
    *branches = (iso_branches){.tubes = take_lines(&made.tubes),
                               .ribbons = take_lines(&made.ribbons),
                               .pieces = made.pieces,
                               .tube_pieces = made.tube_pieces,
                               .ribbon_pieces = made.ribbon_pieces,
                               .left_out = made.left_out};
    if (made.rest.triangle_count) {
        branches->rest = (iso_mesh){.positions = made.rest.vertices,
                                    .triangles = made.rest.triangles,
                                    .vertex_count = made.rest.vertex_count,
                                    .triangle_count = made.rest.triangle_count};
        made.rest = (iso_triangles){.triangle_count = 0};
    }
    iso_mesh_lines_free(&made);
    return ISO_OK;
}

iso_status iso_branches_of_mesh(const iso_mesh *mesh, iso_branches *branches, iso_error *error) {
    const iso_triangles triangles = {.vertices = mesh->positions,
                                     .vertex_count = mesh->vertex_count,
                                     .triangles = mesh->triangles,
                                     .triangle_count = mesh->triangle_count};
    ISO_TRY(iso_api_check_mesh(mesh, error));
    return make("the mesh", &triangles, branches, error);
}

iso_status iso_branches_read(const char *path, bool ras, iso_branches *branches, iso_error *error) {
    iso_triangles triangles = {.triangle_count = 0};
    ISO_TRY(iso_api_read_mesh(path, ras, &triangles, error));
    const iso_status status = make(path, &triangles, branches, error);
    iso_triangles_free(&triangles);
    return status;
}

static void free_lines(const iso_line_arrays *lines) {
    iso_free((void *)lines->vertices);
    iso_free((void *)lines->starts);
    iso_free((void *)lines->radii);
    iso_free((void *)lines->normals);
}

void iso_branches_free(iso_branches *branches) {
    free_lines(&branches->tubes);
    free_lines(&branches->ribbons);
    iso_mesh_free(&branches->rest);
    *branches = (iso_branches){.pieces = 0};
}
