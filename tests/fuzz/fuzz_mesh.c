/* fuzz: any bytes as a mesh: STL, OBJ, PLY, GIFTI, FreeSurfer's, .glb or .3mf, by the first byte. What
 * the reader accepts must be sound and come back the same when it is written and read again; what it
 * refuses must be refused in one line that names the file. GIFTI and FreeSurfer's are read as numbers of
 * vertices as well. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io/mesh/mesh_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_mesh(const iso_triangles *mesh) {
    if (mesh->triangle_count == 0) abort();
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            if (mesh->triangles[i][k] >= mesh->vertex_count) abort();
    for (size_t i = 0; i < mesh->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            if (!isfinite(mesh->vertices[i][axis])) abort();
}

/* As OBJ, which keeps every vertex and its number; nine digits keep every float. */
static void write_and_read_back(const iso_triangles *mesh) {
    char path[] = "/tmp/fuzz_mesh_XXXXXX.obj";
    int descriptor = mkstemps(path, 4);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
    if (!file) abort();
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *v = mesh->vertices[i];
        fprintf(file, "v %.9g %.9g %.9g\n", (double)v[0], (double)v[1], (double)v[2]);
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = mesh->triangles[i];
        fprintf(file, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    if (fclose(file)) abort();
    iso_triangles again;
    if (iso_mesh_read(path, NULL, &again, NULL) != ISO_OK) abort();
    unlink(path);
    const size_t vertices = mesh->vertex_count * sizeof *mesh->vertices,
                 triangles = mesh->triangle_count * sizeof *mesh->triangles;
    if (again.vertex_count != mesh->vertex_count || again.triangle_count != mesh->triangle_count) abort();
    if (memcmp(again.vertices, mesh->vertices, vertices)) abort();
    if (memcmp(again.triangles, mesh->triangles, triangles)) abort();
    iso_triangles_free(&again);
}

static int refuse_later(void *context, double fraction) {
    int *left = context;
    if (!(fraction >= 0 && fraction <= 1)) abort();
    return --*left < 0;
}

/* The same bytes as numbers of vertices. */
static void read_values(const char *memory, const char *suffix, const char *array) {
    char path[64];
    snprintf(path, sizeof path, "/tmp/fuzz_values_%d.%s", (int)getpid(), suffix);
    unlink(path);
    if (symlink(memory, path)) abort();
    iso_vertex_values values;
    iso_error error = {0};
    if (iso_vertex_values_read(path, array, &values, &error) == ISO_OK) {
        double sum = 0;
        for (size_t i = 0; i < values.count; i++)
            sum += (double)values.values[i] + (values.colors ? values.colors[i][2] : 0);
        if (values.count == 0 || sum == 1e308) abort();
        iso_vertex_values_free(&values);
    } else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort();
    unlink(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const suffixes[] = {"stl", "obj", "ply", "gii", "pial", "glb", "3mf"};
    if (size < 1) return 0;
    const int suffix = data[0] < 128 ? data[0] % 5 : 5 + data[0] % 2;
    char memory[64], path[64];
    int descriptor = memfd_create("fuzz_mesh", 0);
    if (descriptor < 0 || write(descriptor, data + 1, size - 1) != (ssize_t)(size - 1)) abort();
    snprintf(memory, sizeof memory, "/proc/self/fd/%d", descriptor);
    snprintf(path, sizeof path, "/tmp/fuzz_mesh_%d.%s", (int)getpid(), suffixes[suffix]);
    unlink(path);
    if (symlink(memory, path)) abort(); /* (the name says what it is) */
    int left = data[0] / 3;
    const iso_progress progress = {.tell = refuse_later, .context = &left};
    iso_triangles mesh;
    iso_error error = {0};
    iso_status status = iso_mesh_read(path, &progress, &mesh, &error);
    if (status == ISO_OK) {
        check_mesh(&mesh);
        write_and_read_back(&mesh);
        iso_triangles_free(&mesh);
    } else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort(); /* every error is one line that names the file */
    unlink(path);
    static const char *const arrays[] = {NULL, "1", "b"};
    if (suffix == 3) read_values(memory, "gii", arrays[data[0] / 5 % 3]);
    if (suffix == 4) read_values(memory, data[0] / 5 % 2 ? "curv" : "annot", NULL);
    close(descriptor);
    return 0;
}
