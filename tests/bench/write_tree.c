/* write_tree FOLDER [SEED]: writes the tree of the benches as files that isorender draws: wood.vtk and
 * leaves.vtk (lines with radii, of leaves also normals), wood.ply and leaves.ply (the same as triangles). */
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "grids/scenes/scene_tree.h"
#include "io/mesh_io.h"
#include "render/raster/triangles.h"

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
    if (status != ISO_OK) fprintf(stderr, "write_tree: %s\n", error.text);
    iso_scene_tree_free(&tree);
    return iso_status_exit(status);
}
