/* write_tree FOLDER [SEED]: writes the tree of the benches as files that isorender draws: wood.vtk and
 * leaves.vtk (lines with radii, of leaves also normals), wood.ply and leaves.ply (the same as triangles), and
 * tree.ply (points of the triangles, as many as the tree of Guennebaud et al. 2004 has). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "io/mesh/mesh_write.h"
#include "io/points_write.h"
#include "render/raster/triangles.h"
#include "scene_tree.h"

static void put_vectors(FILE *stream, float (*vectors)[3], size_t count) {
    for (size_t i = 0; i < count; i++)
        fprintf(stream, "%.7g %.7g %.7g\n", (double)vectors[i][0], (double)vectors[i][1],
                (double)vectors[i][2]);
}

/* Legacy polydata, version 3. */
static void put_lines(FILE *stream, const iso_lines *lines) {
    fprintf(stream, "# vtk DataFile Version 3.0\na tree\nASCII\nDATASET POLYDATA\nPOINTS %zu float\n",
            lines->vertex_count);
    put_vectors(stream, lines->vertices, lines->vertex_count);
    fprintf(stream, "LINES %zu %zu\n", lines->line_count, lines->line_count + lines->vertex_count);
    for (size_t line = 0; line < lines->line_count; line++) {
        fprintf(stream, "%zu", lines->starts[line + 1] - lines->starts[line]);
        for (size_t i = lines->starts[line]; i < lines->starts[line + 1]; i++) fprintf(stream, " %zu", i);
        fputc('\n', stream);
    }
    fprintf(stream, "POINT_DATA %zu\nSCALARS radius float 1\nLOOKUP_TABLE default\n", lines->vertex_count);
    for (size_t i = 0; i < lines->vertex_count; i++) fprintf(stream, "%.6g\n", (double)lines->radii[i]);
    if (!lines->normals) return;
    fprintf(stream, "NORMALS normals float\n");
    put_vectors(stream, lines->normals, lines->vertex_count);
}

static iso_status write_part(const char *folder, const char *name, const iso_lines *lines,
                             const iso_triangles *mesh, iso_error *error) {
    char path[1024];
    iso_sink sink = {0};
    iso_triangle_spans spans = {0};
    snprintf(path, sizeof path, "%s/%s.vtk", folder, name);
    ISO_TRY(iso_sink_open(path, &sink, error));
    put_lines(sink.stream, lines);
    ISO_TRY(iso_sink_commit(&sink, error));
    snprintf(path, sizeof path, "%s/%s.ply", folder, name);
    ISO_TRY(iso_triangle_spans_make(mesh, &spans, error));
    const iso_mesh_view view = iso_triangle_spans_view(&spans);
    const iso_status status = iso_mesh_write(path, &view, NULL, error);
    iso_triangle_spans_free(&spans);
    return status;
}

/* ---- points */

enum { TREE_POINTS = 750000 };

/* The next pseudo-random number in [0, 1). */
static double uniform(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

/* Returns a triangle's normal, as long as twice its area, and its corners. */
static iso_vec3 triangle_normal(const iso_triangles *mesh, size_t triangle, iso_vec3 corner[3]) {
    for (int k = 0; k < 3; k++) {
        const float *v = mesh->vertices[mesh->triangles[triangle][k]];
        corner[k] = iso_vec3_make(v[0], v[1], v[2]);
    }
    return iso_vec3_cross(iso_vec3_sub(corner[1], corner[0]), iso_vec3_sub(corner[2], corner[0]));
}

static double total_area(const iso_triangles *mesh) {
    iso_vec3 corner[3];
    double area = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++)
        area += 0.5 * iso_vec3_length(triangle_normal(mesh, i, corner));
    return area;
}

/* A random point of a triangle (Turk 1990, "Generating random points in triangles"). */
static iso_surfel point_of(const iso_vec3 corner[3], iso_vec3 normal, uint64_t *seed) {
    const double s = sqrt(uniform(seed)), t = uniform(seed);
    const iso_vec3 at =
        iso_vec3_add(iso_vec3_scale(corner[0], 1 - s),
                     iso_vec3_add(iso_vec3_scale(corner[1], s * (1 - t)), iso_vec3_scale(corner[2], s * t)));
    const iso_vec3 n = iso_vec3_unit(normal);
    return (iso_surfel){{(float)at.x, (float)at.y, (float)at.z}, {(float)n.x, (float)n.y, (float)n.z}};
}

/* Adds as many points to a mesh's triangles as their areas ask for; *owed: what is left for the next
 * triangle. */
static size_t sample_mesh(const iso_triangles *mesh, double area_each, double *owed, uint64_t *seed,
                          iso_surfel *surfels, size_t count) {
    iso_vec3 corner[3];
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const iso_vec3 normal = triangle_normal(mesh, i, corner);
        for (*owed += 0.5 * iso_vec3_length(normal) / area_each; *owed >= 1 && count < TREE_POINTS; --*owed)
            surfels[count++] = point_of(corner, normal, seed);
    }
    return count;
}

static iso_status write_points(const char *folder, const iso_scene_tree *tree, iso_error *error) {
    char path[1024];
    iso_surfel *surfels = calloc(TREE_POINTS, sizeof *surfels);
    if (!surfels) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const double area_each = (total_area(&tree->wood_mesh) + total_area(&tree->leaf_mesh)) / TREE_POINTS;
    uint64_t seed = 2004;
    double owed = 0;
    size_t count = sample_mesh(&tree->wood_mesh, area_each, &owed, &seed, surfels, 0);
    count = sample_mesh(&tree->leaf_mesh, area_each, &owed, &seed, surfels, count);
    const iso_point_span span = {.count = (uint32_t)count};
    const iso_point_view view = {.surfels = surfels,
                                 .spans = &span,
                                 .span_count = 1,
                                 .transform = iso_transform_identity(),
                                 .radius = sqrt(area_each)};
    snprintf(path, sizeof path, "%s/tree.ply", folder);
    const iso_status status = iso_points_write_ply(path, &view, NULL, error);
    free(surfels);
    return status;
}

int main(int argc, char **argv) {
    iso_error error = {0};
    iso_scene_tree tree = {.wood = {.line_count = 0}};
    if (argc < 2) {
        fprintf(stderr, "usage: write_tree FOLDER [SEED]\n");
        return 2;
    }
    const iso_scene_tree_opts opts = {.seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 0};
    iso_status status = iso_scene_tree_make(&opts, &tree, &error);
    if (status == ISO_OK) status = write_part(argv[1], "wood", &tree.wood, &tree.wood_mesh, &error);
    if (status == ISO_OK) status = write_part(argv[1], "leaves", &tree.leaves, &tree.leaf_mesh, &error);
    if (status == ISO_OK) status = write_points(argv[1], &tree, &error);
    if (status != ISO_OK) fprintf(stderr, "write_tree: %s\n", error.text);
    iso_scene_tree_free(&tree);
    return iso_status_exit(status);
}
