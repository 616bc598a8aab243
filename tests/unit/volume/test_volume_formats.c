/* Every format, encoding, type and byte order is read as it was written; files that are truncated anywhere
 * are errors; world coordinates are converted to LPS millimetres. */
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "grids/volume/volume.h"
#include "make_volumes.h"

static const char folder[] = ISO_TEST_TMP "/volume_formats";

static bool is_built(const char *format) {
    const iso_format *all[] = {&iso_format_vtk, &iso_format_metaimage, &iso_format_nrrd, &iso_format_nifti};
    if (strcmp(format, "vti") == 0) return ISO_TEST_HAS_VTI;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strcmp(all[i]->name, format) == 0) return all[i]->info != NULL;
    return false;
}

/* One line that names the file first. */
static void check_error(const iso_error *error, const char *path) {
    if (strchr(error->text, '\n') || !*error->text || strncmp(error->text, path, strlen(path)) != 0)
        fail_msg("%s: bad error text '%s'", path, error->text);
}

static void near(const char *what, double got, double wanted) {
    if (!(fabs(got - wanted) <= 1e-6)) fail_msg("%s: got %.9g, wanted %.9g", what, got, wanted);
}

static void check_transform(const char *what, const iso_transform *t, const double wanted[15]) {
    for (int i = 0; i < 3; i++) near(what, t->origin[i], wanted[i]);
    for (int i = 0; i < 3; i++) near(what, t->spacing[i], wanted[3 + i]);
    for (int i = 0; i < 9; i++) near(what, t->direction[i], wanted[6 + i]);
}

/* Where each kind of made file says that its voxels are. */
static void check_place(const vol_kind *kind, const iso_transform *transform) {
    double wanted[15] = {1, 2, 3, 0.5, 1, 2, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (strstr(kind->name, "cells")) wanted[0] = 1.25, wanted[1] = 2.5, wanted[2] = 4;
    if (strcmp(kind->name, "analyze") == 0) {
        wanted[0] = wanted[1] = wanted[2] = 0;
        wanted[6] = wanted[10] = -1;
    }
    check_transform(kind->name, transform, wanted);
}

/* The first `count` voxels. */
static bool same_values(const vol_spec *spec, const iso_volume *volume, size_t count) {
    const iso_rgrid *grid = volume->grid.rgrid;
    size_t i = 0;
    for (int z = 0; z < spec->dims[2]; z++)
        for (int y = 0; y < spec->dims[1]; y++)
            for (int x = 0; x < spec->dims[0] && i < count; x++)
                if (iso_rgrid_at(grid, x, y, z) != (float)vol_value(spec, i++, volume->info.component))
                    return false;
    return true;
}

static void check_round_trip(const vol_kind *kind, const vol_spec *spec, int component) {
    const char *path = vol_path(folder, kind->files[0], 0);
    iso_volume_opts opts = {.component = component};
    iso_volume volume;
    iso_error error = {0};
    iso_status status = iso_volume_read(path, &opts, &volume, &error);
    if (status != ISO_OK)
        fail_msg("%s %s x%d%s: %s", kind->name, iso_scalar_name(spec->scalar), spec->components,
                 spec->big ? " big" : "", error.text);
    const iso_volume_info *info = &volume.info;
    assert_string_equal(info->format, kind->needs);
    assert_string_equal(info->file_type, iso_scalar_name(spec->scalar));
    assert_memory_equal(info->dims, spec->dims, sizeof spec->dims);
    assert_int_equal(info->type, iso_scalar_stored_type(spec->scalar));
    assert_int_equal(info->components, spec->components);
    assert_int_equal(info->bytes, vol_count(spec) * iso_type_size(info->type));
    assert_true(info->read_bytes >= info->bytes);
    assert_true(spec->components == 1 || info->note_count > 0);
    check_place(kind, &info->transform);
    assert_memory_equal(&info->transform, &volume.grid.rgrid->transform, sizeof info->transform);
    if (!same_values(spec, &volume, vol_count(spec)))
        fail_msg("%s %s x%d%s: other values", kind->name, iso_scalar_name(spec->scalar), spec->components,
                 spec->big ? " big" : "");
    iso_volume_free(&volume);
}

static void every_format_round_trips(void **state) {
    (void)state;
    int made = 0;
    for (size_t k = 0; k < vol_kind_count; k++) {
        const vol_kind *kind = &vol_kinds[k];
        if (!is_built(kind->needs)) {
            print_message("%s: not built\n", kind->name);
            continue;
        }
        for (iso_scalar scalar = ISO_SCALAR_UINT8; scalar <= ISO_SCALAR_DOUBLE; scalar++)
            for (int variant = 0; variant < 4; variant++) {
                vol_spec spec = {{4, 3, 2}, scalar, variant & 1 ? 3 : 1, variant & 2};
                if (kind->suits && !kind->suits(&spec)) continue;
                kind->write(kind, folder, &spec);
                for (int c = 0; c < spec.components; c++) check_round_trip(kind, &spec, c);
                made++;
            }
    }
    assert_true(made > 400);
}

/* Reads with the terminal replaced by a file: libraries must print nothing. */
static iso_status read_silently(const char *path, const iso_volume_opts *opts, iso_volume *volume,
                                iso_error *error) {
    const char *said = vol_path(folder, "terminal", 2);
    fflush(NULL);
    int kept[2] = {dup(1), dup(2)}, file = open(said, O_RDWR | O_CREAT | O_TRUNC, 0666);
    dup2(file, 1);
    dup2(file, 2);
    iso_status status = iso_volume_read(path, opts, volume, error);
    fflush(NULL);
    off_t length = lseek(file, 0, SEEK_END);
    dup2(kept[0], 1);
    dup2(kept[1], 2);
    close(kept[0]);
    close(kept[1]);
    close(file);
    if (length != 0) fail_msg("%s: %ld bytes were printed, see %s", path, (long)length, said);
    return status;
}

/* Cut to `length` bytes, a file is refused, or has lost nothing that matters. */
static void check_cut(const vol_kind *kind, const vol_spec *spec, const char *cut_name, size_t length) {
    const char *path = vol_path(folder, kind->files[0], 0);
    iso_volume_opts opts = {.max_memory = 1 << 26};
    iso_volume volume;
    iso_error error = {0};
    iso_status status = read_silently(path, &opts, &volume, &error);
    if (status == ISO_OK) {
        /* nobody can tell that the last number of a text has lost its last digits */
        size_t sure = vol_count(spec) - (strstr(kind->name, "text") != NULL);
        bool same =
            memcmp(volume.info.dims, spec->dims, sizeof spec->dims) == 0 && same_values(spec, &volume, sure);
        iso_volume_free(&volume);
        if (!same)
            fail_msg("%s: %s cut to %zu bytes was read as something else", kind->name, cut_name, length);
        return;
    }
    check_error(&error, path);
    if (iso_status_exit(status) != 3 && status != ISO_ERR_LIMIT)
        fail_msg("%s cut to %zu bytes: status %d, %s", cut_name, length, status, error.text);
}

static void every_cut_is_noticed(void **state) {
    (void)state;
    for (size_t k = 0; k < vol_kind_count; k++) {
        const vol_kind *kind = &vol_kinds[k];
        if (!is_built(kind->needs)) continue;
        vol_spec spec = {{4, 3, 2}, ISO_SCALAR_INT16, 1, false};
        kind->write(kind, folder, &spec);
        for (int f = 0; f < 4 && kind->files[f]; f++) {
            const char *path = vol_path(folder, kind->files[f], 1);
            size_t count;
            unsigned char *bytes = vol_read_bytes(path, &count);
            for (size_t length = 0; length < count; length++) {
                vol_write_bytes(path, bytes, length);
                check_cut(kind, &spec, kind->files[f], length);
            }
            vol_write_bytes(path, bytes, count);
            free(bytes);
            check_round_trip(kind, &spec, 0);
        }
    }
}

/* Voxels beyond the first volume have to be there as well. */
static void cut_in_another_component_is_noticed(void **state) {
    (void)state;
    const char *planar[] = {"nii", "nii.gz", "nrrd components last", "mha", "vtk binary"};
    for (size_t k = 0; k < vol_kind_count; k++)
        for (size_t p = 0; p < sizeof planar / sizeof *planar; p++) {
            const vol_kind *kind = &vol_kinds[k];
            if (strcmp(kind->name, planar[p]) != 0 || !is_built(kind->needs)) continue;
            vol_spec spec = {{4, 3, 2}, ISO_SCALAR_INT16, 3, false};
            kind->write(kind, folder, &spec);
            const char *path = vol_path(folder, kind->files[0], 0);
            size_t count;
            unsigned char *bytes = vol_read_bytes(path, &count);
            vol_write_bytes(path, bytes, count - 12);
            free(bytes);
            iso_volume volume;
            iso_error error = {0};
            assert_int_equal(iso_volume_read(path, NULL, &volume, &error), ISO_ERR_IO);
            check_error(&error, path);
        }
}

/* ---- headers that lie ---- */

static void check_read(const char *name, const iso_volume_opts *opts, iso_status wanted, const char *part) {
    const char *path = vol_path(folder, name, 0);
    iso_volume volume;
    iso_error error = {0};
    iso_status status = iso_volume_read(path, opts, &volume, &error);
    if (status == ISO_OK) iso_volume_free(&volume);
    if (status != wanted) fail_msg("%s: status %d instead of %d: %s", name, status, wanted, error.text);
    check_error(&error, path);
    if (part && !strstr(error.text, part)) fail_msg("'%s' does not say '%s'", error.text, part);
}

/* A wrong checksum behind data of the right length. */
static void damaged_checksums_are_noticed(void **state) {
    (void)state;
    for (size_t k = 0; k < vol_kind_count; k++) {
        const vol_kind *kind = &vol_kinds[k];
        bool gzip = strstr(kind->name, "gz") != NULL;
        bool zlib = strstr(kind->name, "deflated") || strstr(kind->name, "zraw");
        if ((!gzip && !zlib) || !is_built(kind->needs)) continue;
        vol_spec spec = {{4, 3, 2}, ISO_SCALAR_INT16, 1, false};
        kind->write(kind, folder, &spec);
        const char *path = vol_path(folder, kind->files[kind->files[1] != NULL], 1);
        size_t count;
        unsigned char *bytes = vol_read_bytes(path, &count);
        bytes[count - (gzip ? 6 : 2)] ^= 1;
        vol_write_bytes(path, bytes, count);
        free(bytes);
        check_read(kind->files[0], NULL, ISO_ERR_IO, "damaged");
    }
}

/* VTK tells of damage only in words. */
static void damaged_vti_blocks_are_noticed(void **state) {
    (void)state;
    for (size_t k = 0; k < vol_kind_count; k++) {
        const vol_kind *kind = &vol_kinds[k];
        if (strcmp(kind->name, "vti zlib") != 0 || !is_built(kind->needs)) continue;
        vol_spec spec = {{4, 3, 2}, ISO_SCALAR_INT16, 1, false};
        kind->write(kind, folder, &spec);
        const char *path = vol_path(folder, kind->files[0], 1);
        size_t count;
        unsigned char *bytes = vol_read_bytes(path, &count);
        unsigned char *block =
            (unsigned char *)strstr((char *)bytes, "\n_") + 2 + 24; /* behind four numbers */
        block[30] = block[30] == 'A' ? 'B' : 'A';
        vol_write_bytes(path, bytes, count);
        free(bytes);
        check_read(kind->files[0], NULL, ISO_ERR_IO, NULL);
    }
}

/* What lies behind the values that were asked for has to be there, too. */
static void later_parts_must_be_there(void **state) {
    (void)state;
    const struct {
        const char *name, *text;
        iso_volume_opts opts;
    } files[] = {
        {"four.mha",
         "ObjectType = Image\nNDims = 4\nDimSize = 2 1 1 3\nElementType = MET_UCHAR\n"
         "ElementDataFile = LOCAL\nababab",
         {.component = 1}},
        {"two.vtk",
         "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\n"
         "POINT_DATA 2\nSCALARS a char\nLOOKUP_TABLE default\nab\nSCALARS b char\nLOOKUP_TABLE default\nab",
         {.grid = "a"}}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *path = vol_path(folder, files[i].name, 1);
        vol_write_text(path, files[i].text);
        iso_volume volume;
        iso_error error = {0};
        if (iso_volume_read(path, &files[i].opts, &volume, &error) != ISO_OK) fail_msg("%s", error.text);
        assert_int_equal(iso_rgrid_at(volume.grid.rgrid, 1, 0, 0), 'b');
        iso_volume_free(&volume);
        vol_write_bytes(path, files[i].text, strlen(files[i].text) - 1);
        check_read(files[i].name, &files[i].opts, ISO_ERR_IO, "truncated");
    }
}

static const struct {
    const char *name, *format, *text;
} huge_files[] = {
    {"huge.vtk", "vtk",
     "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1000000 1000000 1000000\n"
     "ORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 1000000000000000000\nSCALARS s double\nLOOKUP_TABLE "
     "default\nabc"},
    {"huge2.vtk", "vtk",
     "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1000000 1000000 1000000\n"
     "POINT_DATA 1000000000000000000\nSCALARS s short\nLOOKUP_TABLE default\n1 2 3"},
    {"huge.mha", "metaimage",
     "ObjectType = Image\nNDims = 3\nDimSize = 1000000 1000000 1000000\nElementType = MET_SHORT\n"
     "ElementDataFile = LOCAL\nabc"},
    {"huge.nrrd", "nrrd",
     "NRRD0004\ntype: short\ndimension: 3\nsizes: 1000000 1000000 1000000\nencoding: raw\nendian: "
     "little\n\nabc"},
    {"huge2.nrrd", "nrrd",
     "NRRD0004\ntype: short\ndimension: 3\nsizes: 1000000 1000000 1000000\nencoding: gzip\nendian: "
     "little\n\nabc"},
    {"huge.vti", "vti",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
     "<ImageData WholeExtent=\"0 999999 0 999999 0 999999\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n"
     "<Piece Extent=\"0 999999 0 999999 0 999999\">\n<PointData Scalars=\"s\">\n"
     "<DataArray type=\"Int16\" Name=\"s\" format=\"ascii\">1 2 3</DataArray>\n</PointData>\n</Piece>\n"
     "</ImageData>\n</VTKFile>\n"},
};

static void huge_headers_are_over_the_limit(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof huge_files / sizeof *huge_files; i++) {
        if (!is_built(huge_files[i].format)) continue;
        vol_write_text(vol_path(folder, huge_files[i].name, 1), huge_files[i].text);
        check_read(huge_files[i].name, NULL, ISO_ERR_LIMIT, "1000000 x 1000000 x 1000000");
        iso_volume_info info;
        iso_error error = {0};
        assert_int_equal(iso_volume_read_info(vol_path(folder, huge_files[i].name, 0), NULL, &info, &error),
                         ISO_OK);
        assert_int_equal(info.dims[2], 1000000);
    }
    if (!is_built("nifti")) return;
    vol_nifti header;
    vol_spec spec = {{1000000, 1000000, 1000000}, ISO_SCALAR_INT16, 1, false};
    vol_nifti_make(&header, 2, &spec);
    vol_write_bytes(vol_path(folder, "huge.nii", 1), header.bytes, header.count);
    check_read("huge.nii", NULL, ISO_ERR_LIMIT, "needs 2.0 EB");
    spec = (vol_spec){{32767, 32767, 32767}, ISO_SCALAR_INT16, 1, true};
    vol_nifti_make(&header, 1, &spec);
    vol_write_bytes(vol_path(folder, "huge1.nii", 1), header.bytes, header.count);
    check_read("huge1.nii", NULL, ISO_ERR_LIMIT, "needs 71 TB"); /* 70.4, and the index of its bricks */
}

static const struct {
    const char *name, *format, *text, *part;
} bad_files[] = {
    {"none.mha", "metaimage",
     "ObjectType = Image\nNDims = 3\nDimSize = 0 4 4\nElementType = MET_SHORT\nElementDataFile = LOCAL\n",
     "0 voxels"},
    {"large.mha", "metaimage",
     "ObjectType = Image\nNDims = 3\nDimSize = 3000000000 1 1\nElementType = MET_SHORT\nElementDataFile = "
     "LOCAL\n",
     "3000000000 voxels"},
    {"all.mha", "metaimage",
     "ObjectType = Image\nNDims = 3\nDimSize = 2147483647 2147483647 2147483647\nElementType = MET_DOUBLE\n"
     "ElementDataFile = LOCAL\n",
     "more than any machine"},
    {"flat.mha", "metaimage",
     "ObjectType = Image\nNDims = 3\nDimSize = 1 1 1\nTransformMatrix = 1 0 0 1 0 0 0 0 1\nElementType = "
     "MET_UCHAR\n"
     "ElementDataFile = LOCAL\na",
     "do not span"},
    {"type.mha", "metaimage",
     "ObjectType = Image\nNDims = 3\nDimSize = 1 1 1\nElementType = MET_STRING\nElementDataFile = LOCAL\na",
     "MET_STRING"},
    {"tube.mha", "metaimage", "ObjectType = Tube\nNDims = 3\nElementDataFile = LOCAL\n", "Tube"},
    {"dims.mha", "metaimage", "ObjectType = Image\nNDims = 100\nDimSize = 1\nElementDataFile = LOCAL\n",
     "NDims"},
    {"format.mhd", "metaimage",
     "ObjectType = Image\nNDims = 3\nDimSize = 1 1 2\nElementType = MET_UCHAR\nElementDataFile = %s%n 1 2 "
     "1\n",
     "no sequence"},
    {"grid.vtk", "vtk",
     "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\n",
     "holds a UNSTRUCTURED_GRID, not an image"},
    {"count.vtk", "vtk",
     "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nPOINT_DATA 7\n"
     "SCALARS s float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7\n",
     "7 values for 8 voxels"},
    {"spacing.vtk", "vtk",
     "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 1\nSPACING 1 0 1\n"
     "POINT_DATA 1\nSCALARS s float\nLOOKUP_TABLE default\n1\n",
     "spacing of 0"},
    {"grid.vti", "vti",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
     "byte_order=\"LittleEndian\">\n"
     "<UnstructuredGrid></UnstructuredGrid></VTKFile>",
     "holds a UnstructuredGrid, not an image"},
    {"xml.vti", "vti",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
     "<ImageData WholeExtent=\"0 1 0 0 0 0\" Origin=\"0 0 0\" Spacing=\"1 1 1\"></Wrong>",
     NULL},
    {"empty.vti", "vti",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
     "<ImageData WholeExtent=\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n"
     "<Piece Extent=\"0 1 0 1 0 1\"><PointData/></Piece></ImageData></VTKFile>",
     "no array"},
    {"piece.vti", "vti",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
     "<ImageData WholeExtent=\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n"
     "<Piece Extent=\"0 1 0 1 0 0\"><PointData Scalars=\"s\"><DataArray type=\"UInt8\" Name=\"s\" "
     "format=\"ascii\">"
     "1 2 3 4</DataArray></PointData></Piece></ImageData></VTKFile>",
     "pieces"},
    {"five.nrrd", "nrrd", "NRRD0004\ntype: uchar\ndimension: 5\nsizes: 2 2 2 2 2\nencoding: raw\n\nabcd",
     "more than three axes"},
    {"text.nrrd", "nrrd", "1 2 3\n4 5 6\n", "not an NRRD file"},
    {"text.nii", "nifti", "This is a text, not a volume.\n", "not a NIfTI file"},
    {"text.vtk", "vtk", "This is a text, not a volume.\n", "not a readable VTK file"},
    {"text.vti", "vti", "This is a text, not a volume.\n", "not a VTK XML file"},
    {"text.mhd", "metaimage", "This is a text, not a volume.\n", "not a MetaImage"},
};

static void bad_headers_are_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof bad_files / sizeof *bad_files; i++) {
        if (!is_built(bad_files[i].format)) continue;
        vol_write_text(vol_path(folder, bad_files[i].name, 1), bad_files[i].text);
        const char *path = vol_path(folder, bad_files[i].name, 0);
        iso_volume volume;
        iso_error error = {0};
        iso_status status = read_silently(path, NULL, &volume, &error);
        if (iso_status_exit(status) != 3) fail_msg("%s: status %d %s", path, status, error.text);
        check_error(&error, path);
        if (bad_files[i].part && !strstr(error.text, bad_files[i].part))
            fail_msg("'%s' does not say '%s'", error.text, bad_files[i].part);
    }
}

/* ---- worlds ---- */

/* Header texts for a volume of 2 x 1 x 1 uint8 and where it must lie. */
static const struct {
    const char *name, *format, *text;
    double world[15]; /* origin, spacing, direction */
    bool anatomical;
} worlds[] = {
    {"ras.nrrd",
     "nrrd",
     "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspace: right-anterior-superior\n"
     "space directions: (0,2,0) (3,0,0) (0,0,4)\nspace origin: (5,6,7)\nencoding: raw\n\nab",
     {-5, -6, 7, 2, 3, 4, 0, -1, 0, -1, 0, 0, 0, 0, 1},
     true},
    {"las.nrrd",
     "nrrd",
     "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspace: LAS\n"
     "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (5,6,7)\nencoding: raw\n\nab",
     {5, -6, 7, 2, 3, 4, 1, 0, 0, 0, -1, 0, 0, 0, 1},
     true},
    {"left.nrrd",
     "nrrd",
     "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspace: 3D-left-handed\nspacings: 2 3 4\nencoding: "
     "raw\n\nab",
     {0, 0, 0, 2, 3, 4, 1, 0, 0, 0, 1, 0, 0, 0, -1},
     false},
    {"right.nrrd",
     "nrrd",
     "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspace: 3D-right-handed\n"
     "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace units: \"cm\" \"cm\" \"cm\"\nspace origin: (1,0,0)\n"
     "encoding: raw\n\nab",
     {10, 0, 0, 20, 30, 40, 1, 0, 0, 0, 1, 0, 0, 0, 1},
     false},
    {"thick.nrrd",
     "nrrd",
     "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspacings: 2 -3 nan\nthicknesses: nan nan 5\n"
     "axis mins: 7 nan nan\ncenters: node cell cell\nencoding: raw\n\nab",
     {7, 0, 0, 2, 3, 5, 1, 0, 0, 0, -1, 0, 0, 0, 1},
     false},
    {"flat.nrrd",
     "nrrd",
     "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 2 1\nspacings: 2 3\nencoding: raw\n\nab",
     {0, 0, 0, 2, 3, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1},
     false},
    {"time.nrrd",
     "nrrd",
     "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 2 1 1\nspace: left-posterior-superior-time\n"
     "space directions: (0,0,0,1) (2,0,0,0) (0,3,0,0) (0,0,4,0)\nspace origin: (5,6,7,0)\nencoding: "
     "raw\n\nab",
     {5, 6, 7, 2, 3, 4, 1, 0, 0, 0, 1, 0, 0, 0, 1},
     true},
    {"matrix.mha",
     "metaimage",
     "ObjectType = Image\nNDims = 3\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 5 6 7\n"
     "AnatomicalOrientation = LPS\nElementSpacing = 2 3 4\nDimSize = 2 1 1\nElementType = MET_UCHAR\n"
     "ElementDataFile = LOCAL\nab",
     {5, 6, 7, 2, 3, 4, 0, -1, 0, 1, 0, 0, 0, 0, 1},
     true},
    {"letters.mha",
     "metaimage",
     "ObjectType: Image\nNDims: 3\nOffset: 5 6 7\nAnatomicalOrientation: LAS\nElementSpacing: 2 3 4\n"
     "DimSize: 2 1 1\nElementType: MET_UCHAR\nElementDataFile: LOCAL\nab",
     {5, 6, 7, 2, 3, 4, -1, 0, 0, 0, 1, 0, 0, 0, -1},
     true},
    {"plain.mha",
     "metaimage",
     "NDims = 3\nElementSize = 2 3 4\nDimSize = 2 1 1\nAnatomicalOrientation = ???\nElementType = MET_UCHAR\n"
     "ElementDataFile = LOCAL\nab",
     {0, 0, 0, 2, 3, 4, 1, 0, 0, 0, 1, 0, 0, 0, 1},
     false},
    {"flat2.mha",
     "metaimage",
     "ObjectType = Image\nNDims = 2\nTransformMatrix = 0 1 1 0\nOffset = 5 6\nElementSpacing = 2 3\nDimSize "
     "= 2 1\n"
     "ElementType = MET_UCHAR\nElementDataFile = LOCAL\nab",
     {5, 6, 0, 2, 3, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1},
     false},
    {"extent.vtk",
     "vtk",
     "# vtk DataFile Version 3.0\nx\nbinary\ndataset structured_points\ndimensions 2 1 1\naspect_ratio 2 3 "
     "4\n"
     "origin 5 6 7\npoint_data 2\nscalars s unsigned_char\nlookup_table default\nab",
     {5, 6, 7, 2, 3, 4, 1, 0, 0, 0, 1, 0, 0, 0, 1},
     false},
    {"turned.vti",
     "vti",
     "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
     "<ImageData WholeExtent=\"10 11 0 0 1 1\" Origin=\"5 6 7\" Spacing=\"2 3 4\" Direction=\"0 -1 0 1 0 0 0 "
     "0 1\">\n"
     "<Piece Extent=\"10 11 0 0 1 1\"><PointData Scalars=\"s\"><DataArray type=\"UInt8\" Name=\"s\" "
     "format=\"ascii\">"
     "97 98</DataArray></PointData></Piece></ImageData></VTKFile>",
     {5, 26, 11, 2, 3, 4, 0, -1, 0, 1, 0, 0, 0, 0, 1},
     false},
};

static void worlds_become_lps_millimetres(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof worlds / sizeof *worlds; i++) {
        if (!is_built(worlds[i].format)) continue;
        const char *path = vol_path(folder, worlds[i].name, 0);
        vol_write_text(path, worlds[i].text);
        iso_volume volume;
        iso_error error = {0};
        if (iso_volume_read(path, NULL, &volume, &error) != ISO_OK) fail_msg("%s", error.text);
        check_transform(worlds[i].name, &volume.info.transform, worlds[i].world);
        if (volume.info.anatomical != worlds[i].anatomical) fail_msg("%s: anatomical?", worlds[i].name);
        const int dims[3] = {2, 1, 1};
        assert_memory_equal(volume.info.dims, dims, sizeof dims);
        assert_int_equal(iso_rgrid_at(volume.grid.rgrid, 0, 0, 0), 'a');
        assert_int_equal(iso_rgrid_at(volume.grid.rgrid, 1, 0, 0), 'b');
        iso_volume_free(&volume);
    }
}

/* Writes a header and 2 x 1 x 1 values of int16, 10 and -20, and reads them. */
static void read_nifti(vol_nifti *header, iso_volume *volume) {
    const char *path = vol_path(folder, "world.nii", 0);
    const unsigned char values[2][4] = {{10, 0, 0xec, 0xff}, {0, 10, 0xff, 0xec}};
    unsigned char bytes[600];
    memcpy(bytes, header->bytes, header->count);
    memcpy(bytes + header->count, values[header->big], 4);
    vol_write_bytes(path, bytes, header->count + 4);
    iso_error error = {0};
    if (iso_volume_read(path, NULL, volume, &error) != ISO_OK) fail_msg("%s", error.text);
}

static void nifti_orientations(void **state) {
    (void)state;
    if (!is_built("nifti")) skip();
    for (int variant = 0; variant < 4; variant++) {
        vol_spec spec = {{2, 1, 1}, ISO_SCALAR_INT16, 1, variant & 1};
        vol_nifti header;
        iso_volume volume;
        vol_nifti_make(&header, variant & 2 ? 2 : 1, &spec);
        /* a quarter turn about z by quaternion, with the left-handed qfac; the sform wins while its code is
         * set */
        const double quatern[6] = {0, 0, 0.70710678118654752, 5, 6, 7};
        for (int i = 0; i < 6; i++) vol_nifti_set(&header, VOL_NIFTI_QUATERN, i, quatern[i]);
        vol_nifti_set(&header, VOL_NIFTI_QFORM, 0, 1);
        vol_nifti_set(&header, VOL_NIFTI_PIXDIM, 0, -1);
        read_nifti(&header, &volume);
        const double by_sform[15] = {1, 2, 3, 0.5, 1, 2, 1, 0, 0, 0, 1, 0, 0, 0, 1};
        check_transform("sform", &volume.info.transform, by_sform);
        iso_volume_free(&volume);

        vol_nifti_set(&header, VOL_NIFTI_SFORM, 0, 0);
        read_nifti(&header, &volume);
        /* RAS: i -> +y, j -> -x, k -> -z; LPS negates x and y */
        const double by_qform[15] = {-5, -6, 7, 0.5, 1, 2, 0, 1, 0, -1, 0, 0, 0, 0, -1};
        check_transform("qform", &volume.info.transform, by_qform);
        assert_true(volume.info.anatomical);
        iso_volume_free(&volume);

        vol_nifti_set(&header, VOL_NIFTI_QFORM, 0, 0);
        vol_nifti_set(&header, VOL_NIFTI_UNITS, 0, 1); /* metres */
        read_nifti(&header, &volume);
        const double by_pixdim[15] = {0, 0, 0, 500, 1000, 2000, -1, 0, 0, 0, -1, 0, 0, 0, 1};
        check_transform("pixdim", &volume.info.transform, by_pixdim);
        assert_int_equal(volume.info.note_count, 1);
        iso_volume_free(&volume);
    }
}

static void nifti_slopes(void **state) {
    (void)state;
    if (!is_built("nifti")) skip();
    static const struct {
        double slope, inter, scale, offset, stored;
        iso_type type;
    } cases[] = {{0, 5, 1, 0, -20, ISO_INT16},
                 {1, 0, 1, 0, -20, ISO_INT16},
                 {2, -1024, 2, -1024, -20, ISO_INT16},
                 {-0.5, 3, 1, 0, 13, ISO_FLOAT32}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vol_spec spec = {{2, 1, 1}, ISO_SCALAR_INT16, 1, false};
        vol_nifti header;
        iso_volume volume;
        vol_nifti_make(&header, 1, &spec);
        vol_nifti_set(&header, VOL_NIFTI_SLOPE, 0, cases[i].slope);
        vol_nifti_set(&header, VOL_NIFTI_INTER, 0, cases[i].inter);
        read_nifti(&header, &volume);
        near("scale", volume.info.scale, cases[i].scale);
        near("offset", volume.info.offset, cases[i].offset);
        near("grid's offset", volume.grid.rgrid->offset, cases[i].offset);
        near("stored", iso_rgrid_at(volume.grid.rgrid, 1, 0, 0), cases[i].stored);
        assert_int_equal(volume.info.type, cases[i].type);
        iso_volume_free(&volume);
    }
}

static void nifti_colours_are_refused(void **state) {
    (void)state;
    if (!is_built("nifti")) skip();
    const int types[] = {128, 32, 1536, 1792, 2048, 2304, 1, 0, 77};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        vol_spec spec = {{2, 1, 1}, ISO_SCALAR_INT16, 1, false};
        vol_nifti header;
        vol_nifti_make(&header, 1, &spec);
        vol_nifti_set(&header, VOL_NIFTI_TYPE, 0, types[i]);
        vol_write_bytes(vol_path(folder, "colour.nii", 1), header.bytes, header.count);
        check_read("colour.nii", NULL, ISO_ERR_FORMAT, i == 0 ? "RGB24" : NULL);
    }
}

/* Several arrays: the active one, or the one that was asked for. */
static void arrays_are_chosen(void **state) {
    (void)state;
    const char *vti =
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
        "<ImageData WholeExtent=\"0 1 0 0 0 0\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n"
        "<Piece Extent=\"0 1 0 0 0 0\"><PointData Scalars=\"b\">"
        "<DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">1 2</DataArray>"
        "<DataArray type=\"Float32\" Name=\"b\" format=\"ascii\">3 4</DataArray></PointData>"
        "<CellData><DataArray type=\"UInt8\" Name=\"c\" format=\"ascii\">5</DataArray></CellData>"
        "</Piece></ImageData></VTKFile>";
    const char *vtk =
        "# vtk DataFile Version 4.2\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\n"
        "FIELD meta 1\nTime 1 1 double\n0.5\nMETADATA\nINFORMATION 0\n\n"
        "CELL_DATA 1\nSCALARS c unsigned_char\nLOOKUP_TABLE default\n5\n"
        "POINT_DATA 2\nVECTORS v float\n7 7 7 8 8 8\nFIELD FieldData 1\na 1 2 unsigned_char\n1 2\n"
        "SCALARS b float 1\nLOOKUP_TABLE default\n3 4\n";
    for (int i = 0; i < 2; i++) {
        if (!is_built(i ? "vti" : "vtk")) continue;
        const char *name = i ? "arrays.vti" : "arrays.vtk";
        const char *path = vol_path(folder, name, 0);
        vol_write_text(path, i ? vti : vtk);
        const struct {
            const char *name;
            float value;
            int dim;
        } wanted[] = {{NULL, 3, 2}, {"a", 1, 2}, {"b", 3, 2}, {"c", 5, 1}};
        for (int k = 0; k < 4; k++) {
            iso_volume_opts opts = {.grid = wanted[k].name};
            iso_volume volume;
            iso_error error = {0};
            if (iso_volume_read(path, &opts, &volume, &error) != ISO_OK) fail_msg("%s", error.text);
            assert_string_equal(volume.info.name, wanted[k].name ? wanted[k].name : "b");
            assert_true(iso_rgrid_at(volume.grid.rgrid, 0, 0, 0) == wanted[k].value);
            assert_int_equal(volume.info.dims[0], wanted[k].dim);
            assert_true(volume.info.item_count >= 3);
            iso_volume_free(&volume);
        }
        iso_volume_opts opts = {.grid = "nothing"};
        check_read(name, &opts, ISO_ERR_USAGE, "no array 'nothing'");
    }
}

/* Pieces in any order make a whole. */
static void vti_pieces_join(void **state) {
    (void)state;
    if (!is_built("vti")) skip();
    const char *path = vol_path(folder, "pieces.vti", 0);
    vol_write_text(
        path, "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
              "<ImageData WholeExtent=\"0 2 0 1 0 0\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n"
              "<Piece Extent=\"1 2 0 1 0 0\"><PointData Scalars=\"s\">"
              "<DataArray type=\"UInt8\" Name=\"s\" format=\"ascii\">1 2 4 5</DataArray></PointData></Piece>"
              "<Piece Extent=\"0 1 0 1 0 0\"><PointData Scalars=\"s\">"
              "<DataArray type=\"UInt8\" Name=\"s\" format=\"ascii\">0 1 3 4</DataArray></PointData></Piece>"
              "</ImageData></VTKFile>");
    iso_volume volume;
    iso_error error = {0};
    if (iso_volume_read(path, NULL, &volume, &error) != ISO_OK) fail_msg("%s", error.text);
    for (int y = 0; y < 2; y++)
        for (int x = 0; x < 3; x++) assert_int_equal(iso_rgrid_at(volume.grid.rgrid, x, y, 0), 3 * y + x);
    iso_volume_free(&volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_round_trips),
        cmocka_unit_test(every_cut_is_noticed),
        cmocka_unit_test(cut_in_another_component_is_noticed),
        cmocka_unit_test(damaged_checksums_are_noticed),
        cmocka_unit_test(damaged_vti_blocks_are_noticed),
        cmocka_unit_test(later_parts_must_be_there),
        cmocka_unit_test(huge_headers_are_over_the_limit),
        cmocka_unit_test(bad_headers_are_refused),
        cmocka_unit_test(worlds_become_lps_millimetres),
        cmocka_unit_test(nifti_orientations),
        cmocka_unit_test(nifti_slopes),
        cmocka_unit_test(nifti_colours_are_refused),
        cmocka_unit_test(arrays_are_chosen),
        cmocka_unit_test(vti_pieces_join),
    };
    mkdir(folder, 0777);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
