/* Meshes in STL: facets, each with three vertices of its own. */
#include "io/mesh/mesh_format.h"

#include <errno.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/text.h"

enum { STL_HEADER = 84, STL_FACET = 50 };

static iso_status add_facet(iso_mesh_reading *r, const double p[9], iso_error *error) {
    const uint32_t first = (uint32_t)r->vertex_count;
    for (int k = 0; k < 3; k++) ISO_TRY(iso_mesh_add_vertex(r, p + 3 * k, error));
    return iso_mesh_add_triangle(r, first, first + 1, first + 2, error);
}

static iso_status read_stl_binary(iso_mesh_reading *r, FILE *file, uint32_t facets, iso_error *error) {
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
static char *next_word(iso_mesh_reading *r, char **rest) {
    for (;;) {
        char *word = *rest ? iso_row_word(rest) : NULL;
        if (word) return word;
        *rest = iso_text_rows_next(&r->rows);
        if (!*rest) return NULL;
    }
}

static bool read_numbers(iso_mesh_reading *r, char **rest, double *numbers, int count) {
    for (int i = 0; i < count; i++) {
        char *word = next_word(r, rest);
        if (!word || !iso_row_number(&word, "", &numbers[i])) return false;
    }
    return true;
}

static iso_status read_stl_text(iso_mesh_reading *r, iso_error *error) {
    double p[9];
    int corners = 0;
    bool ended = false; /* by "endsolid" behind the last facet */
    char *rest = NULL;
    ISO_TRY(iso_mesh_load_rows(r, error));
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
static iso_status read_stl(iso_mesh_reading *r, FILE *file, iso_error *error) {
    unsigned char head[STL_HEADER + 1] = {0};
    const size_t got = fread(head, 1, STL_HEADER, file);
    const char *text = (char *)head + iso_text_mark(head, got);
    text += strspn(text, " \t\r\n");
    uint32_t facets = 0;
    memcpy(&facets, head + STL_HEADER - sizeof facets, sizeof facets);
    fseeko(file, 0, SEEK_END);
    const bool whole = got == STL_HEADER && ftello(file) == (off_t)STL_HEADER + (off_t)facets * STL_FACET,
               solid = strncasecmp(text, "solid", 5) == 0;
    if (!whole && (solid || iso_text_wide(head, got))) return read_stl_text(r, error);
    if (got < STL_HEADER) return iso_fail(error, ISO_ERR_FORMAT, "%s: not an STL file", r->path);
    fseeko(file, STL_HEADER, SEEK_SET);
    return read_stl_binary(r, file, facets, error);
}

iso_status iso_mesh_read_stl(iso_mesh_reading *r, iso_error *error) {
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
