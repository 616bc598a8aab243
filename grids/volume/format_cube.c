/* format_cube: Gaussian's cube files, text, in which programs of quantum chemistry write orbitals,
 * densities and potentials over a grid.
 *
 * The format: gaussian.com/cubegen. Two lines of comment; the number of atoms and the origin; for each
 * axis its number of points and its step; a line for each atom; if their number is negative, a line with
 * the number of orbitals and their names; and the values, the last axis fastest, and of each point all
 * orbitals together.
 *
 * World. As molecules have it (io/glyphs): an angstrom is a millimetre. Lengths are in bohr, or, if the
 * number of points is negative, in angstrom. */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "grids/volume/cube_header.h"
#include "grids/volume/format.h"

static const double angstrom_per_bohr = 0.529177210903; /* CODATA 2018 */
enum { MAX_ATOMS = 1 << 24, MAX_ORBITALS = 1 << 16 };

static iso_status bad(const iso_cube_file *f, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable cube file: %s", f->path, what);
}

iso_status iso_cube_next_line(iso_cube_file *f, iso_error *error) {
    if (!fgets(f->line, sizeof f->line, f->stream))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends in its header", f->path);
    if (!strchr(f->line, '\n')) iso_format_skip_line(f->stream);
    return ISO_OK;
}

/* A line of a whole number, three others, and perhaps the number of values of a voxel. */
static iso_status read_row(iso_cube_file *f, long *whole, iso_vec3 *vector, long *values, iso_error *error) {
    ISO_TRY(iso_cube_next_line(f, error));
    const int found =
        sscanf(f->line, "%ld %lf %lf %lf %ld", whole, &vector->x, &vector->y, &vector->z, values);
    if (found < 4) return bad(f, "its first lines are no numbers of points and their steps", error);
    if (found < 5) *values = 1;
    return ISO_OK;
}

iso_status iso_cube_read_header(iso_cube_file *f, iso_cube_header *header, iso_error *error) {
    long points, ignored;
    header->unit = angstrom_per_bohr;
    ISO_TRY(iso_cube_next_line(f, error));
    ISO_TRY(iso_cube_next_line(f, error));
    ISO_TRY(read_row(f, &header->atoms, &header->origin, &header->values, error));
    header->has_orbitals = header->atoms < 0;
    if (header->atoms < -MAX_ATOMS || header->atoms > MAX_ATOMS || header->values < 1 ||
        header->values > MAX_ORBITALS)
        return bad(f, "the number of its atoms or values is not possible", error);
    header->atoms = labs(header->atoms);
    for (int axis = 2; axis >= 0; axis--) {
        ISO_TRY(read_row(f, &points, &header->steps[axis], &ignored, error));
        if (points < 0) header->unit = 1;
        header->dims[axis] = (uint64_t)(points < 0 ? -(points + 1) : points - 1) + 1;
    }
    return ISO_OK;
}

/* Goes to the first value, and reads how many there are of each voxel. */
static iso_status skip_atoms(iso_cube_file *f, const iso_cube_header *header, long *values,
                             iso_error *error) {
    long name;
    for (long i = 0; i < header->atoms; i++) ISO_TRY(iso_cube_next_line(f, error));
    *values = header->values;
    if (!header->has_orbitals) return ISO_OK;
    if (fscanf(f->stream, "%ld", values) != 1 || *values < 1 || *values > MAX_ORBITALS)
        return bad(f, "the number of its orbitals is missing", error);
    for (long i = 0; i < *values; i++)
        if (fscanf(f->stream, "%ld", &name) != 1)
            return bad(f, "the names of its orbitals are missing", error);
    return ISO_OK;
}

static iso_status describe(iso_cube_file *f, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    iso_cube_header header;
    long values;
    ISO_TRY(iso_cube_read_header(f, &header, error));
    ISO_TRY(skip_atoms(f, &header, &values, error));
    ISO_TRY(iso_format_dims(f->path, header.dims, info, error));
    ISO_TRY(iso_format_component(f->path, opts, (int)values, info, error));
    iso_format_transform(header.steps, &header.origin, header.unit, info);
    info->unitless = info->angstrom = true;
    return iso_format_text_voxels(f->path, f->stream, opts, info, error);
}

static iso_status cube_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    iso_cube_file f = {.path = path};
    ISO_TRY(iso_file_open(path, &f.stream, NULL, error));
    const iso_status status = describe(&f, opts, info, error);
    fclose(f.stream);
    return status;
}

const iso_format iso_format_cube = {"cube", "isopoint", NULL, cube_info, NULL, NULL};
