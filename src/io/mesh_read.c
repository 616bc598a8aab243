/* mesh_read: readers of STL, OBJ and PLY meshes. */
#define _POSIX_C_SOURCE 200809L
#include "io/mesh_read.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/memory.h"
#include "io/encode.h"
#include "io/ply.h"

enum { STL_HEADER = 84, STL_FACET = 50, POLYGON_MOST = 1 << 16 };
/* Number of vertices or triangles between two reports of progress. */
enum { TELL = 1 << 14 };

/* The mesh that is being read. */
typedef struct reading {
    const char *path;
    iso_buffer vertices, triangles;
    size_t vertex_count, triangle_count;
    const iso_progress *progress;
    FILE *file; /* one of file and ply is set; progress is measured by its position */
    const iso_ply *ply;
    double bytes; /* of the file */
} reading;

static iso_status report_progress(const reading *r, iso_error *error) {
    double done = 0;
    if (r->file) done = (double)ftello(r->file);
    if (r->ply) done = r->bytes - (double)r->ply->in.remaining;
    return iso_progress_tell(r->progress, r->path, r->bytes > 0 ? done / r->bytes : 0, error);
}

static iso_status add_vertex(reading *r, const double p[3], iso_error *error) {
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

/* Adds a triangle; vertices are numbered from 0. The numbers are checked at the end, because faces may
 * precede their vertices. */
static iso_status add_triangle(reading *r, uint32_t a, uint32_t b, uint32_t c, iso_error *error) {
    const size_t bytes = r->triangle_count * 3 * sizeof(uint32_t);
    if (r->triangle_count % TELL == 0) ISO_TRY(report_progress(r, error));
    ISO_TRY(iso_buffer_reserve(&r->triangles, bytes + 3 * sizeof(uint32_t), bytes, error));
    uint32_t *out = (uint32_t *)r->triangles.data + 3 * r->triangle_count++;
    out[0] = a;
    out[1] = b;
    out[2] = c;
    return ISO_OK;
}

/* A polygon that is read corner by corner and divided into a fan of triangles. */
typedef struct fan {
    uint32_t first, last;
    size_t count;
} fan;

static iso_status add_corner(reading *r, fan *f, uint32_t corner, iso_error *error) {
    if (f->count == 0) f->first = corner;
    if (f->count >= 2) ISO_TRY(add_triangle(r, f->first, f->last, corner, error));
    f->last = corner;
    f->count++;
    return ISO_OK;
}

/* ---- STL: facets, each with three vertices of its own */

static iso_status add_facet(reading *r, const double p[9], iso_error *error) {
    const uint32_t first = (uint32_t)r->vertex_count;
    for (int k = 0; k < 3; k++) ISO_TRY(add_vertex(r, p + 3 * k, error));
    return add_triangle(r, first, first + 1, first + 2, error);
}

static iso_status read_stl_binary(reading *r, FILE *file, uint32_t facets, iso_error *error) {
    for (uint32_t i = 0; i < facets; i++) {
        unsigned char bytes[STL_FACET];
        float values[9];
        double p[9];
        if (fread(bytes, STL_FACET, 1, file) != 1)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: %u of %u facets", r->path, i, facets);
        memcpy(values, bytes + 12, sizeof values); /* little-endian, like the machines that this runs on */
        for (int k = 0; k < 9; k++) p[k] = (double)values[k];
        ISO_TRY(add_facet(r, p, error));
    }
    return ISO_OK;
}

static iso_status read_stl_text(reading *r, FILE *file, iso_error *error) {
    char word[64] = "";
    double p[9];
    int corners = 0;
    while (fscanf(file, "%63s", word) == 1) {
        if (strcasecmp(word, "vertex") == 0) {
            if (corners == 3 ||
                fscanf(file, "%lf %lf %lf", &p[3 * corners], &p[3 * corners + 1], &p[3 * corners + 2]) != 3)
                return iso_fail(error, ISO_ERR_FORMAT, "%s: facet %zu is not a triangle", r->path,
                                r->triangle_count + 1);
            corners++;
        } else if (strcasecmp(word, "endfacet") == 0) {
            if (corners != 3)
                return iso_fail(error, ISO_ERR_FORMAT, "%s: facet %zu is not a triangle", r->path,
                                r->triangle_count + 1);
            ISO_TRY(add_facet(r, p, error));
            corners = 0;
        }
    }
    return strcasecmp(word, "endsolid") == 0 || corners == 0
               ? ISO_OK
               : iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path);
}

/* A binary file may also begin with "solid": it is recognized by its size. */
static iso_status read_stl(reading *r, FILE *file, iso_error *error) {
    unsigned char head[STL_HEADER] = {0};
    const size_t got = fread(head, 1, sizeof head, file);
    uint32_t facets = 0;
    memcpy(&facets, head + STL_HEADER - sizeof facets, sizeof facets);
    fseeko(file, 0, SEEK_END);
    const bool whole = got == sizeof head && ftello(file) == (off_t)STL_HEADER + (off_t)facets * STL_FACET;
    const bool text = !whole && memcmp(head, "solid", 5) == 0;
    if (got < sizeof head && !text) return iso_fail(error, ISO_ERR_FORMAT, "%s: not an STL file", r->path);
    fseeko(file, text ? 0 : STL_HEADER, SEEK_SET);
    return text ? read_stl_text(r, file, error) : read_stl_binary(r, file, facets, error);
}

/* ---- OBJ */

/* Reads the corners of a face: "7", "7/1", "7//3" or "-1". Vertices are numbered from 1, or backwards from
 * the last one, -1. */
static iso_status read_obj_face(reading *r, char *text, size_t line, iso_error *error) {
    fan f = {0};
    char *save = NULL;
    for (char *word = strtok_r(text, " \t\r\n", &save); word; word = strtok_r(NULL, " \t\r\n", &save)) {
        char *end;
        const long long n = strtoll(word, &end, 10);
        const long long corner = n < 0 ? (long long)r->vertex_count + n : n - 1;
        if (end == word || (*end && *end != '/') || corner < 0 || corner >= UINT32_MAX)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: line %zu: '%s' is no corner of a face", r->path, line,
                            word);
        ISO_TRY(add_corner(r, &f, (uint32_t)corner, error));
    }
    return ISO_OK;
}

static iso_status read_obj_line(reading *r, char *text, size_t line, iso_error *error) {
    if (text[0] == 'f' && (text[1] == ' ' || text[1] == '\t')) return read_obj_face(r, text + 2, line, error);
    if (text[0] != 'v' || (text[1] != ' ' && text[1] != '\t')) return ISO_OK;
    double p[3];
    if (sscanf(text + 2, "%lf %lf %lf", &p[0], &p[1], &p[2]) != 3)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: line %zu: not a vertex", r->path, line);
    return add_vertex(r, p, error);
}

static iso_status read_obj(reading *r, FILE *file, iso_error *error) {
    char *text = NULL;
    size_t room = 0, line = 0;
    iso_status status = ISO_OK;
    while (status == ISO_OK && getline(&text, &room, file) > 0)
        status = read_obj_line(r, text, ++line, error);
    free(text);
    return status;
}

/* ---- PLY */

static iso_status read_ply_vertex(reading *r, iso_ply *ply, const iso_ply_element *element,
                                  iso_error *error) {
    static const char *const names[3] = {"x", "y", "z"};
    const iso_ply_property *property = &ply->properties[element->first_property];
    double value[ISO_PLY_PROPERTIES], p[3] = {NAN, NAN, NAN};
    ISO_TRY(iso_ply_read_item(ply, element, value, error));
    for (int i = 0; i < element->property_count; i++)
        for (int axis = 0; axis < 3; axis++)
            if (!property[i].is_list && strcmp(property[i].name, names[axis]) == 0) p[axis] = value[i];
    return add_vertex(r, p, error);
}

static iso_status read_ply_corners(reading *r, iso_ply *ply, const iso_ply_property *list, iso_error *error) {
    double count, corner;
    fan f = {0};
    ISO_TRY(iso_ply_read_value(ply, list->count_type, &count, error));
    if (!(count >= 0 && count <= POLYGON_MOST))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a face of %g corners", r->path, count);
    for (int i = 0; i < (int)count; i++) {
        ISO_TRY(iso_ply_read_value(ply, list->type, &corner, error));
        if (!(corner >= 0 && corner < UINT32_MAX))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a face has corner %g", r->path, corner);
        ISO_TRY(add_corner(r, &f, (uint32_t)corner, error));
    }
    return ISO_OK;
}

static iso_status read_ply_face(reading *r, iso_ply *ply, const iso_ply_element *element, iso_error *error) {
    for (int i = 0; i < element->property_count; i++) {
        const iso_ply_property *property = &ply->properties[element->first_property + i];
        const bool corners = property->is_list && (!strcmp(property->name, "vertex_indices") ||
                                                   !strcmp(property->name, "vertex_index"));
        double value;
        if (corners)
            ISO_TRY(read_ply_corners(r, ply, property, error));
        else if (property->is_list)
            ISO_TRY(iso_ply_skip_list(ply, property, error));
        else
            ISO_TRY(iso_ply_read_value(ply, property->type, &value, error));
    }
    return ISO_OK;
}

static iso_status read_ply_elements(reading *r, iso_ply *ply, iso_error *error) {
    ISO_TRY(iso_ply_open(r->path, ply, error));
    r->ply = ply;
    r->bytes = (double)ply->in.remaining;
    for (int i = 0; i < ply->element_count; i++) {
        const iso_ply_element *element = &ply->elements[i];
        const bool vertices = strcmp(element->name, "vertex") == 0,
                   faces = strcmp(element->name, "face") == 0;
        /* an item without properties has no bytes: any number of them would fit into the file */
        if ((!vertices && !faces) || element->property_count == 0) {
            ISO_TRY(iso_ply_skip_element(ply, element, error));
            continue;
        }
        ISO_TRY(iso_ply_check_size(ply, element, error));
        for (uint64_t k = 0; k < element->count; k++)
            ISO_TRY(vertices ? read_ply_vertex(r, ply, element, error)
                             : read_ply_face(r, ply, element, error));
    }
    return ISO_OK;
}

static iso_status read_ply(reading *r, iso_error *error) {
    iso_ply *ply = iso_alloc_zero(1, sizeof *ply);
    if (!ply) return iso_fail_memory(error, r->path);
    iso_status status = read_ply_elements(r, ply, error);
    iso_ply_close(ply);
    iso_free(ply);
    return status;
}

/* ---- any format */

static iso_status check_mesh(const reading *r, iso_error *error) {
    const uint32_t *corners = r->triangles.data;
    for (size_t i = 0; i < 3 * r->triangle_count; i++)
        if (corners[i] >= r->vertex_count)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: triangle %zu names vertex %u of %zu", r->path,
                            i / 3 + 1, corners[i], r->vertex_count);
    if (r->triangle_count) return ISO_OK;
    return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no triangles", r->path);
}

typedef iso_status read_fn(reading *r, FILE *file, iso_error *error);

static iso_status read_with(reading *r, read_fn *read, iso_error *error) {
    FILE *file;
    uint64_t bytes;
    ISO_TRY(iso_file_open(r->path, &file, &bytes, error));
    r->file = file;
    r->bytes = (double)bytes;
    iso_status status = read(r, file, error);
    if (status == ISO_OK && ferror(file))
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", r->path, strerror(errno));
    fclose(file);
    return status;
}

static iso_status read_any(reading *r, iso_error *error) {
    const char *dot = strrchr(r->path, '.');
    if (dot && strcasecmp(dot, ".stl") == 0) return read_with(r, read_stl, error);
    if (dot && strcasecmp(dot, ".obj") == 0) return read_with(r, read_obj, error);
    if (dot && strcasecmp(dot, ".ply") == 0) return read_ply(r, error);
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: meshes are read from .stl, .obj and .ply", r->path);
}

iso_status iso_mesh_read(const char *path, const iso_progress *progress, iso_triangles *mesh,
                         iso_error *error) {
    reading r = {.path = path, .progress = progress};
    void *numbers = iso_encode_numbers_begin();
    iso_status status = read_any(&r, error);
    iso_encode_numbers_end(numbers);
    if (status == ISO_OK) status = check_mesh(&r, error);
    if (status != ISO_OK) {
        iso_buffer_free(&r.vertices);
        iso_buffer_free(&r.triangles);
        return status;
    }
    *mesh = (iso_triangles){r.vertices.data, r.triangles.data, r.vertex_count, r.triangle_count};
    return ISO_OK;
}

void iso_triangles_free(iso_triangles *mesh) {
    iso_free(mesh->vertices);
    iso_free(mesh->triangles);
    *mesh = (iso_triangles){0};
}
