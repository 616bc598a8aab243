/* file_contents: looks into files whose types can hold several things. */
#include "io/file_contents.h"

#include <ctype.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "grids/volume/npy_header.h"
#include "io/lines/lines_read.h"
#include "io/mesh/mesh_read.h"
#include "io/polydata/polydata.h"

/* Whether the text of a .xyz file begins as molecules do: with a row of one whole number. */
static bool is_molecule(const char *head) {
    const char *text = head + iso_text_mark(head, strlen(head));
    while (isspace((unsigned char)*text)) text++;
    const size_t digits = strspn(text, "0123456789");
    text += digits;
    return digits && text[strspn(text, " \t\r")] == '\n';
}

unsigned iso_file_contents(const char *path) {
    char head[256] = "";
    const iso_file_type type = iso_file_type_find(path, ~0u);
    unsigned holds = iso_file_type_holds(type);
    if (!iso_file_head(path, head, sizeof head - 1))
        return holds & (ISO_HOLDS_VOLUME | ISO_HOLDS_POINTS) ? 0 : holds;
    if (holds & ISO_HOLDS_MESH && iso_mesh_find_faces(path) == ISO_MESH_NO_FACES) holds &= ~ISO_HOLDS_MESH;
    switch (type) {
    case ISO_FILE_vtk:
        return iso_lines_fill_vtk(path) ? holds & ~ISO_HOLDS_VOLUME : ISO_HOLDS_VOLUME;
    case ISO_FILE_vtp:
        return iso_vtp_find_cells(path) == ISO_VTP_POINTS ? ISO_HOLDS_GLYPHS : holds;
    case ISO_FILE_npy:
        return iso_npy_axes(path) > 2 ? ISO_HOLDS_VOLUME : holds & ~ISO_HOLDS_VOLUME;
    case ISO_FILE_xyz:
        return is_molecule(head) ? ISO_HOLDS_GLYPHS : holds;
    default:
        return holds;
    }
}
