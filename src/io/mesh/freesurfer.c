/* Meshes of FreeSurfer's surfaces (lh.pial, rh.white, ..): three bytes that mark triangles, two lines of
 * text, counts, vertices and triangles, big-endian, and behind them the place of the volume that they were
 * made of.
 *
 * Coordinates are RAS about the middle of that volume. With x y z the vertex and xras, yras, zras and cras
 * the directions and middle of the volume, its scanner coordinates are cras - x xras + y zras - z yras: as
 * those of the volume's .mgz, so that a surface lies over it. A file without this place has the middle at
 * 0. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/geometry.h"
#include "grids/volume/scalar_load.h"
#include "io/mesh/mesh_format.h"

enum { FOOTER = 4096, BLOCK = 1024 };

typedef struct surface_place {
    iso_vec3 right, down, front, middle; /* xras, yras, zras, cras */
} surface_place;

static iso_status ends(const iso_mesh_reading *r, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path);
}

/* Finds "name = x y z" in the text behind the triangles. */
static bool find_vector(const char *text, const char *name, iso_vec3 *vector) {
    const char *at = strstr(text, name), *equals = at ? strchr(at, '=') : NULL;
    double v[3];
    if (!equals || (at != text && at[-1] != '\n')) return false;
    char *end = (char *)(uintptr_t)(equals + 1);
    for (int i = 0; i < 3; i++) {
        const char *from = end;
        v[i] = strtod(from, &end);
        if (end == from) return false;
    }
    *vector = iso_vec3_make(v[0], v[1], v[2]);
    return iso_vec3_is_finite(*vector);
}

/* Reads the place behind the triangles, from the current position on, and moves the vertices there. */
static void place_vertices(iso_mesh_reading *r) {
    char bytes[FOOTER + 1];
    const size_t count = fread(bytes, 1, FOOTER, r->file);
    bytes[count] = 0;
    size_t at = 0; /* behind one or three numbers of four bytes */
    while (at < count && at < 12 && (bytes[at] < 'A' || bytes[at] > 'z')) at++;
    surface_place p = {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, 0}};
    surface_place stated = p;
    const char *text = bytes + at;
    const bool scanner = at >= 8 && iso_scalar_load(bytes, ISO_SCALAR_INT32, true) == 2 &&
                         iso_scalar_load(bytes + 4, ISO_SCALAR_INT32, true) == 1; /* they are that already */
    if (!scanner && strncmp(text, "valid = 1", 9) == 0 && find_vector(text, "xras", &stated.right) &&
        find_vector(text, "yras", &stated.down) && find_vector(text, "zras", &stated.front) &&
        find_vector(text, "cras", &stated.middle))
        p = stated;
    float(*v)[3] = r->vertices.data;
    for (size_t i = 0; i < r->vertex_count; i++) {
        iso_vec3 q = iso_vec3_sub(p.middle, iso_vec3_scale(p.right, (double)v[i][0]));
        q = iso_vec3_add(q, iso_vec3_scale(p.front, (double)v[i][1]));
        q = iso_vec3_sub(q, iso_vec3_scale(p.down, (double)v[i][2]));
        v[i][0] = (float)-q.x; /* RAS to LPS */
        v[i][1] = (float)-q.y;
        v[i][2] = (float)q.z;
    }
}

/* Reads rows of three numbers: vertices, or corners of triangles. */
static iso_status read_rows(iso_mesh_reading *r, uint64_t rows, bool points, iso_error *error) {
    unsigned char bytes[12 * BLOCK];
    for (uint64_t i = 0; i < rows; i++) {
        const uint64_t in_block = i % BLOCK, left = rows - i;
        if (in_block == 0 && fread(bytes, 12, (size_t)(left < BLOCK ? left : BLOCK), r->file) !=
                                 (size_t)(left < BLOCK ? left : BLOCK))
            return ends(r, error);
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = iso_scalar_load(bytes + 12 * in_block + 4 * k,
                                   points ? ISO_SCALAR_FLOAT : ISO_SCALAR_UINT32, true);
        ISO_TRY(points ? iso_mesh_add_vertex(r, p, error)
                       : iso_mesh_add_triangle(r, (uint32_t)p[0], (uint32_t)p[1], (uint32_t)p[2], error));
    }
    return ISO_OK;
}

static iso_status read_surface(iso_mesh_reading *r, iso_error *error) {
    unsigned char head[8];
    if (fread(head, 1, 3, r->file) != 3) return ends(r, error);
    if (memcmp(head, "\xff\xff\xfe", 3) != 0)
        return iso_fail(
            error, ISO_ERR_FORMAT, "%s: not a surface of FreeSurfer: its triangles are not marked%s", r->path,
            memcmp(head, "\xff\xff\xff", 3) == 0 ? ", it holds numbers for those of another file" : "");
    for (int last = 0, c = 0; (c = getc(r->file)) != '\n' || last != '\n'; last = c)
        if (c == EOF) return ends(r, error);
    if (fread(head, 1, 8, r->file) != 8) return ends(r, error);
    const double vertices = iso_scalar_load(head, ISO_SCALAR_INT32, true),
                 triangles = iso_scalar_load(head + 4, ISO_SCALAR_INT32, true);
    if (!(vertices > 0 && triangles > 0))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a surface of FreeSurfer: %g vertices, %g triangles",
                        r->path, vertices, triangles);
    ISO_TRY(read_rows(r, (uint64_t)vertices, true, error));
    ISO_TRY(read_rows(r, (uint64_t)triangles, false, error));
    place_vertices(r);
    return ISO_OK;
}

iso_status iso_mesh_read_freesurfer(iso_mesh_reading *r, iso_error *error) {
    uint64_t bytes;
    ISO_TRY(iso_file_open(r->path, &r->file, &bytes, error));
    r->bytes = (double)bytes;
    iso_status status = read_surface(r, error);
    if (status == ISO_OK && ferror(r->file))
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", r->path, strerror(errno));
    fclose(r->file);
    r->file = NULL;
    return status;
}
