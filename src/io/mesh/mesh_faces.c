/* Looks for faces in files that may hold points or lines, too. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "io/common/ply.h"
#include "io/lines/lines_read.h"
#include "io/mesh/mesh_read.h"
#include "io/polydata/polydata.h"

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

static iso_mesh_content faces_if(bool found) {
    return found ? ISO_MESH_FACES : ISO_MESH_NO_FACES;
}

/* Polygons or strips, and no lines. */
static bool vtk_has_faces(const char *path) {
    const unsigned found =
        find_rows(path, (const char *const[]){"POLYGONS", "TRIANGLE_STRIPS", "LINES", NULL});
    return found && !(found & 4);
}

iso_mesh_content iso_mesh_find_faces(const char *path) {
    const iso_file_type type = iso_file_type_find(path, ISO_HOLDS_MESH);
    switch (type) {
    case ISO_FILE_ply:
        return find_ply_faces(path);
    case ISO_FILE_off:
        return find_off_faces(path);
    case ISO_FILE_obj:
        return faces_if(find_rows(path, (const char *const[]){"f", NULL}));
    case ISO_FILE_vtp:
        return faces_if(iso_vtp_find_cells(path) == ISO_VTP_FACES);
    case ISO_FILE_vtk:
        return faces_if(iso_lines_fill_vtk(path) && vtk_has_faces(path));
    default: /* a format that holds nothing else */
        return faces_if(type != ISO_FILE_UNKNOWN);
    }
}
