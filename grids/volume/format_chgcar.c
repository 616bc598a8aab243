/* format_chgcar: densities and potentials of VASP (CHGCAR, PARCHG, LOCPOT, ELFCAR, .vasp), as text.
 *
 * The format: vasp.at/wiki, "CHGCAR" and "POSCAR". A line of comment, a scale, the edges of the cell, names
 * and numbers of the atoms, their positions, an empty line, the numbers of voxels, and the values, the first
 * axis fastest. What stands behind them (augmentation, magnetization) is not read.
 *
 * World. As molecules have it (io/glyphs): an angstrom is a millimetre. Densities are stored times the
 * volume of the cell, by which they are divided here: electrons per cubic angstrom. Those of LOCPOT (eV)
 * and ELFCAR are not. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "grids/volume/chgcar_header.h"
#include "grids/volume/format.h"

enum { MAX_ATOMS = 1 << 24 };

static iso_status bad(const iso_cube_file *f, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable file of VASP: %s", f->path, what);
}

/* Reads the words of the next line as names, if it has any, and the numbers of the line behind them. */
static iso_status read_atoms(iso_cube_file *f, iso_chgcar_header *header, iso_error *error) {
    ISO_TRY(iso_cube_next_line(f, error));
    const char *at = f->line;
    const bool named = isalpha((unsigned char)f->line[strspn(f->line, " \t")]);
    for (int kind = 0; named && kind < ISO_CHGCAR_KINDS; kind++) {
        at += strspn(at, " \t\r\n");
        const int length = (int)strcspn(at, " \t\r\n");
        snprintf(header->names[kind], sizeof header->names[kind], "%.*s", length < 3 ? length : 3, at);
        at += length;
    }
    if (named) ISO_TRY(iso_cube_next_line(f, error));
    char *end;
    at = f->line;
    for (; header->kinds < ISO_CHGCAR_KINDS; header->kinds++, at = end) {
        const long count = strtol(at, &end, 10);
        if (end == at) break;
        if (count < 0 || count > MAX_ATOMS - header->atoms)
            return bad(f, "the number of its atoms is not possible", error);
        header->counts[header->kinds] = count;
        header->atoms += count;
    }
    return header->atoms ? ISO_OK : bad(f, "it does not say how many atoms it has", error);
}

iso_status iso_chgcar_read_header(iso_cube_file *f, iso_chgcar_header *header, iso_error *error) {
    *header = (iso_chgcar_header){.scale = 0};
    ISO_TRY(iso_cube_next_line(f, error));
    ISO_TRY(iso_cube_next_line(f, error));
    if (sscanf(f->line, "%lf", &header->scale) != 1 || !(header->scale > 0))
        return bad(f, "its second line is no scale above 0", error);
    for (int i = 0; i < 3; i++) {
        iso_vec3 *edge = &header->cell[i];
        ISO_TRY(iso_cube_next_line(f, error));
        if (sscanf(f->line, "%lf %lf %lf", &edge->x, &edge->y, &edge->z) != 3)
            return bad(f, "an edge of its cell is not three numbers", error);
        *edge = iso_vec3_scale(*edge, header->scale);
    }
    ISO_TRY(read_atoms(f, header, error));
    ISO_TRY(iso_cube_next_line(f, error));
    char kind = f->line[strspn(f->line, " \t")];
    if (kind == 'S' || kind == 's') { /* selective dynamics */
        ISO_TRY(iso_cube_next_line(f, error));
        kind = f->line[strspn(f->line, " \t")];
    }
    header->cartesian = kind && strchr("CcKk", kind);
    return header->cartesian || kind == 'D' || kind == 'd'
               ? ISO_OK
               : bad(f, "its positions are neither Direct nor Cartesian", error);
}

/* Whether the name says that values are not multiplied by the volume of the cell. */
static bool is_plain(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    return strstr(name, "LOCPOT") || strstr(name, "ELFCAR");
}

static iso_status describe(iso_cube_file *f, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    iso_chgcar_header header;
    unsigned long long sizes[3];
    uint64_t dims[3];
    ISO_TRY(iso_chgcar_read_header(f, &header, error));
    for (long i = 0; i < header.atoms; i++) ISO_TRY(iso_cube_next_line(f, error));
    do ISO_TRY(iso_cube_next_line(f, error));
    while (!f->line[strspn(f->line, " \t\r\n")]);
    if (sscanf(f->line, "%llu %llu %llu", &sizes[0], &sizes[1], &sizes[2]) != 3 ||
        f->line[strspn(f->line, " \t")] == '-')
        return bad(f, "the numbers of its voxels are missing (is it a POSCAR?)", error);
    const iso_vec3 origin = {0, 0, 0}, *cell = header.cell;
    iso_vec3 steps[3];
    for (int i = 0; i < 3; i++) {
        dims[i] = sizes[i];
        steps[i] = iso_vec3_scale(cell[i], 1 / (double)(sizes[i] ? sizes[i] : 1));
    }
    ISO_TRY(iso_format_dims(f->path, dims, info, error));
    iso_format_transform(steps, &origin, 1, info);
    info->unitless = info->angstrom = true;
    const double volume = fabs(iso_vec3_dot(cell[0], iso_vec3_cross(cell[1], cell[2])));
    if (!is_plain(f->path) && volume > 0) {
        info->scale = 1 / volume;
        iso_volume_note(info, "densities are divided by the volume of the cell, %g cubic angstrom", volume);
    }
    return iso_format_text_voxels(f->path, f->stream, opts, info, error);
}

static iso_status chgcar_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                              iso_error *error) {
    iso_cube_file file = {.path = path};
    ISO_TRY(iso_file_open(path, &file.stream, NULL, error));
    const iso_status status = describe(&file, opts, info, error);
    fclose(file.stream);
    return status;
}

const iso_format iso_format_chgcar = {"chgcar", "isopoint", NULL, chgcar_info, NULL, NULL};
