/* mesh_read: readers of STL, OBJ and PLY meshes. */
#define _POSIX_C_SOURCE 200809L
#include "io/mesh/mesh_read.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "io/common/encode.h"
#include "io/common/fans.h"
#include "io/common/ply.h"
#include "io/common/rows.h"
#include "io/lines/lines_read.h"
#include "io/polydata/faces.h"
#include "io/polydata/polydata.h"

enum { STL_HEADER = 84, STL_FACET = 50, POLYGON_MOST = 1 << 16 };
/* Number of vertices or triangles between two reports of progress. */
enum { TELL = 1 << 14 };

/* The mesh that is being read. */
typedef struct reading {
    const char *path;
    iso_buffer vertices, triangles;
    size_t vertex_count, triangle_count;
    iso_buffer fans; /* of iso_fan */
    size_t fan_count;
    const iso_progress *progress; /* measured by the position in rows, ply or file */
    FILE *file;
    const iso_ply *ply;
    iso_reading text; /* of a text file, as are the rows */
    iso_rows rows;
    iso_read_report report;
    double bytes; /* of the file */
} reading;

static iso_status report_progress(const reading *r, iso_error *error) {
    double done = 0;
    if (r->rows.at)
        done = r->bytes - (double)(r->rows.end - r->rows.at);
    else if (r->ply)
        done = r->bytes - (double)r->ply->in.remaining;
    else if (r->file)
        done = (double)ftello(r->file);
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

/* A polygon that is read corner by corner. */
typedef struct polygon {
    uint32_t first, last;
    size_t count;
} polygon;

/* Adds a corner; the triangles are a fan for the time being (io/common/fans.h). */
static iso_status add_corner(reading *r, polygon *p, uint32_t corner, iso_error *error) {
    if (p->count == 0) p->first = corner;
    if (p->count >= 2) ISO_TRY(add_triangle(r, p->first, p->last, corner, error));
    p->last = corner;
    p->count++;
    return ISO_OK;
}

static iso_status end_polygon(reading *r, const polygon *p, iso_error *error) {
    const size_t bytes = r->fan_count * sizeof(iso_fan);
    if (p->count < 4) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&r->fans, bytes + sizeof(iso_fan), bytes, error));
    ((iso_fan *)r->fans.data)[r->fan_count++] = (iso_fan){r->triangle_count - (p->count - 2), p->count};
    return ISO_OK;
}

/* ---- text */

/* Loads a text file, whose rows are then read from r->rows. */
static iso_status load_rows(reading *r, iso_error *error) {
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    ISO_TRY(iso_rows_load(&r->text, &r->rows, error));
    r->bytes = (double)(r->rows.end - r->rows.at);
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

/* Returns the next word of the file; *rest: what is left of its row, NULL before the first one. */
static char *next_word(reading *r, char **rest) {
    for (;;) {
        char *word = *rest ? iso_row_word(rest) : NULL;
        if (word) return word;
        *rest = iso_rows_next(&r->rows);
        if (!*rest) return NULL;
    }
}

static bool read_numbers(reading *r, char **rest, double *numbers, int count) {
    for (int i = 0; i < count; i++) {
        char *word = next_word(r, rest);
        if (!word || !iso_row_number(&word, "", &numbers[i])) return false;
    }
    return true;
}

static iso_status read_stl_text(reading *r, iso_error *error) {
    double p[9];
    int corners = 0;
    bool ended = false; /* by "endsolid" behind the last facet */
    char *rest = NULL;
    ISO_TRY(load_rows(r, error));
    for (char *word; (word = next_word(r, &rest));) {
        const bool end = strcasecmp(word, "endfacet") == 0;
        if (strcasecmp(word, "endsolid") == 0) ended = true;
        if (end ? corners != 3
                : strcasecmp(word, "vertex") == 0 &&
                      (corners == 3 || !read_numbers(r, &rest, &p[3 * corners++], 3)))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: facet %zu is not a triangle", r->path,
                            r->triangle_count + 1);
        if (!end) continue;
        ISO_TRY(add_facet(r, p, error));
        corners = 0;
        ended = false;
    }
    return ended && corners == 0 ? ISO_OK
                                 : iso_fail(error, ISO_ERR_IO, "%s: truncated: it has no endsolid", r->path);
}

/* Reads STL. A binary file may also begin with "solid": it is recognised by its size. */
static iso_status read_stl(reading *r, FILE *file, iso_error *error) {
    unsigned char head[STL_HEADER] = {0};
    const size_t got = fread(head, 1, sizeof head, file);
    uint32_t facets = 0;
    memcpy(&facets, head + STL_HEADER - sizeof facets, sizeof facets);
    fseeko(file, 0, SEEK_END);
    const bool whole = got == sizeof head && ftello(file) == (off_t)STL_HEADER + (off_t)facets * STL_FACET,
               solid = strncasecmp((char *)head + iso_text_mark(head, got), "solid", 5) == 0;
    if (!whole && (solid || iso_text_wide(head, got))) return read_stl_text(r, error);
    if (got < sizeof head) return iso_fail(error, ISO_ERR_FORMAT, "%s: not an STL file", r->path);
    fseeko(file, STL_HEADER, SEEK_SET);
    return read_stl_binary(r, file, facets, error);
}

/* ---- OBJ */

/* Reads the corners of a face: "7", "7/1", "7//3" or "-1". Vertices are numbered from 1, or backwards from
 * the last one, -1. */
static iso_status read_obj_face(reading *r, char *text, iso_error *error) {
    polygon face = {0};
    for (char *word = iso_row_word(&text); word; word = iso_row_word(&text)) {
        char *end;
        const long long n = strtoll(word, &end, 10);
        const long long corner = n < 0 ? (long long)r->vertex_count + n : n - 1;
        if (end == word || (*end && *end != '/') || corner < 0 || corner >= UINT32_MAX)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: line %zu: '%s' is no corner of a face", r->path,
                            r->rows.number, word);
        ISO_TRY(add_corner(r, &face, (uint32_t)corner, error));
    }
    return end_polygon(r, &face, error);
}

static iso_status read_obj_vertex(reading *r, char *text, iso_error *error) {
    double p[3];
    for (int axis = 0; axis < 3; axis++)
        if (!iso_row_number(&text, "", &p[axis]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: line %zu: not a vertex", r->path, r->rows.number);
    return add_vertex(r, p, error);
}

static iso_status read_obj(reading *r, iso_error *error) {
    ISO_TRY(load_rows(r, error));
    for (char *row; (row = iso_rows_next_continued(&r->rows));) {
        row += strspn(row, " \t");
        if (row[0] && row[1] != ' ' && row[1] != '\t') continue;
        if (row[0] == 'f') ISO_TRY(read_obj_face(r, row + 2, error));
        if (row[0] == 'v') ISO_TRY(read_obj_vertex(r, row + 2, error));
    }
    return ISO_OK;
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
    polygon face = {0};
    ISO_TRY(iso_ply_read_value(ply, list->count_type, &count, error));
    if (!(count >= 0 && count <= POLYGON_MOST))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a face of %g corners", r->path, count);
    for (int i = 0; i < (int)count; i++) {
        ISO_TRY(iso_ply_read_value(ply, list->type, &corner, error));
        if (!(corner >= 0 && corner < UINT32_MAX))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a face has corner %g", r->path, corner);
        ISO_TRY(add_corner(r, &face, (uint32_t)corner, error));
    }
    return end_polygon(r, &face, error);
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
    return iso_ply_end_item(ply, error);
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

/* ---- VTK's formats of polygonal data */

/* Makes the vertices of the points. */
static iso_status take_points(reading *r, iso_polydata *data, iso_error *error) {
    const double turn = data->stated == ISO_SPACE_RAS ? -1 : 1;
    float(*p)[3] = data->points.data;
    for (size_t i = 0; i < data->point_count; i++) {
        if (isnan(p[i][0]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: vertex %zu is not finite", r->path, i + 1);
        p[i][0] = (float)(turn * (data->origin.x + (double)p[i][0]));
        p[i][1] = (float)(turn * (data->origin.y + (double)p[i][1]));
        p[i][2] = (float)(data->origin.z + (double)p[i][2]);
    }
    r->vertices = data->points;
    r->vertex_count = data->point_count;
    data->points = (iso_buffer){0};
    return ISO_OK;
}

static iso_status read_polydata(reading *r, iso_status (*read)(iso_polydata *data, iso_error *error),
                                iso_error *error) {
    iso_faces faces = {0};
    iso_polydata data = {.reading = &r->text, .points_only = true, .surface = &faces};
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    iso_status status = read(&data, error);
    if (status == ISO_OK) status = take_points(r, &data, error);
    if (status == ISO_OK) status = iso_progress_tell(r->progress, r->path, 1, error);
    r->triangles = faces.corners;
    r->triangle_count = faces.count;
    r->fans = faces.fans;
    r->fan_count = faces.fan_count;
    iso_polydata_free(&data);
    return status;
}

/* ---- any format */

/* Checks the numbers of vertices, then divides concave polygons. */
static iso_status finish_mesh(const reading *r, iso_error *error) {
    const uint32_t *corners = r->triangles.data;
    for (size_t i = 0; i < 3 * r->triangle_count; i++)
        if (corners[i] >= r->vertex_count)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: triangle %zu names vertex %u of %zu", r->path,
                            i / 3 + 1, corners[i], r->vertex_count);
    if (r->triangle_count == 0) return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no triangles", r->path);
    return iso_fans_divide(r->path, r->fans.data, r->fan_count, (const float(*)[3])r->vertices.data,
                           r->triangles.data, error);
}

static iso_status read_stl_file(reading *r, iso_error *error) {
    FILE *file;
    uint64_t bytes;
    ISO_TRY(iso_file_open(r->path, &file, &bytes, error));
    r->file = file;
    r->bytes = (double)bytes;
    iso_status status = read_stl(r, file, error);
    if (status == ISO_OK && ferror(file))
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", r->path, strerror(errno));
    fclose(file);
    return status;
}

static iso_status read_any(reading *r, iso_error *error) {
    const char *dot = strrchr(r->path, '.');
    if (dot && strcasecmp(dot, ".stl") == 0) return read_stl_file(r, error);
    if (dot && strcasecmp(dot, ".obj") == 0) return read_obj(r, error);
    if (dot && strcasecmp(dot, ".ply") == 0) return read_ply(r, error);
    if (dot && strcasecmp(dot, ".vtk") == 0) return read_polydata(r, iso_polydata_read_vtk, error);
    if (dot && strcasecmp(dot, ".vtp") == 0) return read_polydata(r, iso_polydata_read_vtp, error);
    if (dot && strcasecmp(dot, ".off") == 0) return read_polydata(r, iso_polydata_read_off, error);
    return iso_fail(error, ISO_ERR_UNSUPPORTED,
                    "%s: meshes are read from .stl, .obj, .ply, .off, .vtk and .vtp", r->path);
}

iso_status iso_mesh_read(const char *path, const iso_progress *progress, iso_triangles *mesh,
                         iso_error *error) {
    reading r = {.path = path, .progress = progress};
    void *numbers = iso_encode_numbers_begin();
    iso_status status = read_any(&r, error);
    iso_encode_numbers_end(numbers);
    iso_rows_free(&r.rows);
    if (status == ISO_OK) status = finish_mesh(&r, error);
    iso_buffer_free(&r.fans);
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

/* ---- what is in a file ---- */

static iso_mesh_content find_ply_faces(const char *path) {
    iso_ply *ply = iso_alloc_zero(1, sizeof *ply);
    iso_mesh_content found = ISO_MESH_NO_FACES;
    bool colored = false;
    if (ply && iso_ply_open(path, ply, NULL) == ISO_OK)
        for (int i = 0; i < ply->element_count; i++) {
            const iso_ply_element *element = &ply->elements[i];
            for (int k = 0; strcmp(element->name, "vertex") == 0 && k < element->property_count; k++)
                colored |= strstr(ply->properties[element->first_property + k].name, "red") != NULL;
            if (strcmp(element->name, "face") == 0 && element->count > 0) found = ISO_MESH_FACES;
        }
    if (ply) iso_ply_close(ply);
    iso_free(ply);
    return found == ISO_MESH_FACES && colored ? ISO_MESH_COLORED_FACES : found;
}

/* The words among `words` (NULL ends them) with which rows of a file begin, as bits of their numbers. Looks
 * no further than a row that begins with the last of them. Rows may be long: binary numbers have no ends. */
static unsigned find_rows(const char *path, const char *const *words) {
    FILE *file;
    char row[64]; /* its beginning */
    size_t count = 0;
    unsigned found = 0;
    if (iso_file_open(path, &file, NULL, NULL) != ISO_OK) return 0;
    bool last = false;
    for (int byte; !last && (byte = getc(file)) != EOF;) {
        if (byte != '\n') {
            if (count < sizeof row - 1) row[count++] = (char)byte;
            continue;
        }
        row[count] = 0;
        count = 0;
        const char *at = row + strspn(row, " \t");
        const size_t length = strcspn(at, " \t\r");
        for (int i = 0; words[i]; i++) {
            if (strlen(words[i]) != length || strncasecmp(at, words[i], length) != 0) continue;
            found |= 1u << i;
            last = !words[i + 1];
        }
    }
    fclose(file);
    return found;
}

/* Looks into the header: the keyword, which says whether vertices have colours, and the numbers of vertices
 * and faces, between comments. */
static iso_mesh_content find_off_faces(const char *path) {
    enum { WORDS = 3 };
    FILE *file;
    char words[WORDS][32] = {""};
    if (iso_file_open(path, &file, NULL, NULL) != ISO_OK) return ISO_MESH_NO_FACES;
    int found = 0;
    while (found < WORDS && fscanf(file, "%31s", words[found]) == 1)
        if (words[found][0] != '#')
            found++;
        else if (fscanf(file, "%*[^\n]") == EOF)
            break;
    fclose(file);
    if (found < WORDS || strtod(words[2], NULL) <= 0) return ISO_MESH_NO_FACES;
    return strchr(words[0], 'C') ? ISO_MESH_COLORED_FACES : ISO_MESH_FACES;
}

iso_mesh_content iso_mesh_find_faces(const char *path) {
    bool faces = false;
    if (iso_text_has_extension(path, ".ply")) return find_ply_faces(path);
    if (iso_text_has_extension(path, ".obj"))
        faces = find_rows(path, (const char *const[]){"f", NULL});
    else if (iso_text_has_extension(path, ".vtp"))
        faces = iso_vtp_find_cells(path) == ISO_VTP_FACES;
    else if (iso_text_has_extension(path, ".vtk") && iso_lines_fill_vtk(path)) {
        const unsigned found =
            find_rows(path, (const char *const[]){"POLYGONS", "TRIANGLE_STRIPS", "LINES", NULL});
        faces = found && !(found & 4);
    } else if (iso_text_has_extension(path, ".off"))
        return find_off_faces(path);
    return faces ? ISO_MESH_FACES : ISO_MESH_NO_FACES;
}
