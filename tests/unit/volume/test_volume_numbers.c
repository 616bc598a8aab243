/* Headers with wrong or unusable numbers are errors that name the number, before memory is allocated. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "grids/volume/volume.h"
#include "make_volumes.h"
#include "volume_support.h"

static const char folder[] = ISO_TEST_TMP "/volume_numbers";

static const iso_volume_opts small_memory = {.max_memory = 64 << 20};

/* ---- what places and scales voxels ---- */

static void expect_line(const char *path, const char *words) {
    iso_error error = {0};
    iso_volume_info info;
    iso_status status = iso_volume_read_info(path, NULL, &info, &error);
    if (iso_status_exit(status) != 3) fail_msg("%s: status %d: %s", words, status, error.text);
    if (strncmp(error.text, path, strlen(path)) != 0 || !strstr(error.text, words))
        fail_msg("'%s' lacks '%s'", error.text, words);
}

/* Lines of a .mha that is right but for one of them. */
static void expect_mha(const char *line, const char *words) {
    char text[512];
    snprintf(text, sizeof text,
             "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1\n%s\n"
             "ElementType = MET_UCHAR\nElementDataFile = LOCAL\nabcdefgh",
             line);
    const char *path = vol_path(folder, "numbers.mha", 0);
    vol_write_text(path, text);
    if (words) {
        expect_line(path, words);
        return;
    }
    iso_volume volume = test_read_volume(path, NULL);
    iso_volume_free(&volume);
}

static void numbers_that_no_picture_can_use(void **state) {
    (void)state;
    expect_mha("Offset = 0 0 1e300", "from the origin");
    expect_mha("Offset = 0 2e12 0", "from the origin");
    expect_mha("Offset = 0 0.9e12 0", NULL);
    expect_mha("Offset = nan 0 0", "an origin of nan");
    expect_mha("Offset = inf 0 0", "an origin of inf");
    expect_mha("ElementSpacing = 1 1 1e300", "from the origin");
    expect_mha("ElementSpacing = 1 1 inf", "a spacing of inf");
    expect_mha("ElementSpacing = 1 1 nan", "a spacing of nan");
    expect_mha("ElementSpacing = 1 0 1", "a spacing of 0");
    expect_mha("ElementSpacing = 1e-300 1 1", "too small");
    expect_mha("ElementSpacing = 1e-9 1e-9 1e-9", NULL);
    expect_mha("ElementSpacing = 1 1 2e6", "a million times");
    expect_mha("ElementSpacing = 1e-3 1e-3 1e-3\nOffset = 1e11 0 0", "cannot be told apart");
    expect_mha("TransformMatrix = 1e-300 0 0 0 1 0 0 0 1", "a direction of length");
    expect_mha("TransformMatrix = nan 0 0 0 1 0 0 0 1", "directions");
    expect_mha("ElementToIntensityFunctionSlope = 1e300", "cannot be scaled");
    expect_mha("ElementToIntensityFunctionOffset = 1e300", "cannot be scaled");
    expect_mha("ElementToIntensityFunctionOffset = 1e25", "cannot be told apart");
    expect_mha("ElementToIntensityFunctionOffset = inf", "cannot be scaled");
    expect_mha("DimSize = 2 2 2e9", "DimSize");
    expect_mha("DimSize = 2 2 -2", "DimSize");
    expect_mha("ElementNumberOfChannels = 1e12", "ElementNumberOfChannels");
    expect_mha("NDims = 3.5", "NDims");
    expect_mha("HeaderSize = nan", "HeaderSize");
}

static void numbers_of_legacy_vtk(void **state) {
    (void)state;
    const char *path = vol_path(folder, "numbers.vtk", 0);
    vol_write_text(path,
                   "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 -2\n");
    expect_line(path, "a count of -2");
    vol_write_text(path, "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 1\n"
                         "POINT_DATA 1\nSCALARS s float 1e12\nLOOKUP_TABLE default\n1\n");
    expect_line(path, "number of components");
}

static void options_of_other_formats_are_noted(void **state) {
    (void)state;
    const iso_volume_opts opts = {.grid = "density", .series = "1.2.3"};
    expect_mha("Comment = nothing is wrong", NULL);
    iso_volume volume = test_read_volume(vol_path(folder, "numbers.mha", 0), &opts);
    assert_true(test_has_note(&volume.info, "(--grid)"));
    assert_true(test_has_note(&volume.info, "(--series)"));
    iso_volume_free(&volume);
}

/* ---- NIfTI: what libnifti2 replaces ---- */

typedef struct nifti_case {
    vol_nifti_field field;
    int index;
    double value;
    int qform, sform;
    const char *words; /* NULL: it is read */
} nifti_case;

static const char *write_nifti(const nifti_case *c, int version) {
    const vol_spec spec = {{2, 2, 2}, ISO_SCALAR_UINT8, 1, false};
    vol_nifti header;
    vol_nifti_make(&header, version, &spec);
    for (int i = 1; i <= 3; i++) vol_nifti_set(&header, VOL_NIFTI_PIXDIM, i, 1);
    for (int i = 0; i < 3; i++) vol_nifti_set(&header, VOL_NIFTI_SROW, 5 * i, 1);
    vol_nifti_set(&header, VOL_NIFTI_QFORM, 0, c->qform);
    vol_nifti_set(&header, VOL_NIFTI_SFORM, 0, c->sform);
    vol_nifti_set(&header, c->field, c->index, c->value);
    unsigned char bytes[600] = {0};
    memcpy(bytes, header.bytes, header.count);
    const char *path = vol_path(folder, "numbers.nii", 0);
    vol_write_bytes(path, bytes, header.count + 8);
    return path;
}

static void nifti_numbers(void **state) {
    (void)state;
    if (!iso_format_nifti.info) skip();
    const nifti_case cases[] = {
        {VOL_NIFTI_PIXDIM, 3, 1, 0, 0, NULL},
        {VOL_NIFTI_PIXDIM, 3, 0, 0, 0, "a spacing of 0 (pixdim[3])"},
        {VOL_NIFTI_PIXDIM, 2, (double)NAN, 1, 0, "a spacing of nan (pixdim[2])"},
        {VOL_NIFTI_PIXDIM, 1, -2, 1, 0, "a spacing of -2 (pixdim[1])"},
        {VOL_NIFTI_PIXDIM, 1, -2, 0, 0, NULL},          /* without an orientation its sign means nothing */
        {VOL_NIFTI_PIXDIM, 3, (double)NAN, 0, 1, NULL}, /* the sform says it all */
        {VOL_NIFTI_SROW, 0, (double)NAN, 0, 1, "sform"},
        {VOL_NIFTI_SROW, 3, (double)INFINITY, 0, 1, "sform"},
        {VOL_NIFTI_QUATERN, 1, (double)NAN, 1, 0, "qform"},
        {VOL_NIFTI_QUATERN, 4, (double)INFINITY, 1, 0, "qform"},
        {VOL_NIFTI_SROW, 3, 1e30, 0, 1, "from the origin"},
        {VOL_NIFTI_SLOPE, 0, -2e30, 0, 0, "cannot be scaled"},
        {VOL_NIFTI_SLOPE, 0, (double)NAN, 0, 0, NULL}, /* how some programs say that there is none */
        {VOL_NIFTI_DIM, 2, -2, 0, 0, "-2 voxels on axis 1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int version = 1; version <= 2; version++) {
            const char *path = write_nifti(&cases[i], version);
            if (cases[i].words) {
                expect_line(path, cases[i].words);
                continue;
            }
            iso_volume volume = test_read_volume(path, NULL);
            iso_volume_free(&volume);
        }
}

static void nifti_offsets(void **state) {
    (void)state;
    if (!iso_format_nifti.info) skip();
    const double offsets[] = {(double)NAN, (double)INFINITY, 1e30, -1, 352.5, 2e9};
    for (size_t i = 0; i < sizeof offsets / sizeof *offsets; i++) {
        const nifti_case c = {VOL_NIFTI_OFFSET, 0, offsets[i], 0, 0, NULL};
        expect_line(write_nifti(&c, 1), "vox_offset");
    }
}

/* The caller's spacing mends a file that has none. */
static void a_spacing_can_be_given(void **state) {
    (void)state;
    if (!iso_format_nifti.info) skip();
    const nifti_case c = {VOL_NIFTI_PIXDIM, 3, 0, 0, 0, NULL};
    const iso_volume_opts opts = {.spacing = {1, 1, 2}};
    iso_volume volume = test_read_volume(write_nifti(&c, 1), &opts);
    assert_true(volume.info.transform.spacing[2] == 2);
    iso_volume_free(&volume);
}

/* ---- .vti: what VTK believes ---- */

#if ISO_TEST_HAS_VTI

static const char vti_before[] =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\"%s>\n"
    "<ImageData WholeExtent=\"0 15 0 15 0 15\" Origin=\"0 0 0\" Spacing=\"%s\">\n"
    "<Piece Extent=\"0 15 0 15 0 15\">\n<PointData Scalars=\"s\">%s"
    "<DataArray type=\"UInt8\" Name=\"s\" format=\"%s>",
                  vti_after[] = "</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n";

/* Parts of a .vti of 16^3 bytes; NULL: what is right. */
typedef struct vti_case {
    const char *file, *spacing, *inside,
        *text; /* attributes of VTKFile, elements before the array, its text */
    const void *data;
    size_t count; /* of the appended data */
} vti_case;

static const char *write_vti(const vti_case *c) {
    const char *path = vol_path(folder, "numbers.vti", 0);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file, vti_before, c->file ? c->file : "", c->spacing ? c->spacing : "1 1 1",
            c->inside ? c->inside : "", c->text ? "ascii\"" : "appended\" offset=\"0\"");
    fprintf(file, "%s%s", c->text ? c->text : "", vti_after);
    if (!c->text) {
        fprintf(file, "<AppendedData encoding=\"raw\">\n_");
        fwrite(c->data, 1, c->count, file);
        fprintf(file, "\n</AppendedData>\n");
    }
    fprintf(file, "</VTKFile>\n");
    fclose(file);
    return path;
}

static void expect_vti(const vti_case *c, const char *words) {
    const char *path = write_vti(c);
    test_expect_no_volume(path, &small_memory,
                          strstr(words, "XML") || strstr(words, "Spacing") ? ISO_ERR_FORMAT : ISO_ERR_IO,
                          path, words);
    expect_line(path, words);
}

#define COMPRESSED " compressor=\"vtkZLibDataCompressor\""
#define COMPRESSED_64 COMPRESSED " header_type=\"UInt64\""

/* Number of blocks, unpacked size of a block and of the last, packed sizes. */
static void lying_blocks(void **state) {
    (void)state;
    const struct {
        uint32_t numbers[4];
        const char *words;
    } cases[] = {{{1 << 30, 4, 0, 0}, "compressed blocks"},   {{UINT32_MAX, 1024, 0, 0}, "compressed blocks"},
                 {{1, 1 << 30, 0, 100}, "compressed blocks"}, {{1, 0, 4096, 100}, "compressed blocks"},
                 {{2, 4096, 4096, 100}, "compressed blocks"}, {{0, 4096, 0, 0}, "compressed blocks"},
                 {{1, 4096, 0, UINT32_MAX}, "truncated"},     {{4096, 1, 0, 1}, "truncated"},
                 {{1, 4095, 0, 100}, "compressed blocks"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned char bytes[200] = {0};
        memcpy(bytes, cases[i].numbers, sizeof cases[i].numbers);
        expect_vti(&(vti_case){.file = COMPRESSED, .data = bytes, .count = sizeof bytes}, cases[i].words);
    }
    const uint64_t wide[4] = {UINT64_MAX, UINT64_MAX, 0, 0}, many[4] = {UINT64_C(1) << 61, 8, 0, 0};
    expect_vti(&(vti_case){.file = COMPRESSED_64, .data = wide, .count = sizeof wide}, "compressed blocks");
    expect_vti(&(vti_case){.file = COMPRESSED_64, .data = many, .count = sizeof many}, "compressed blocks");
}

static void lying_lengths(void **state) {
    (void)state;
    unsigned char bytes[4200] = {0};
    const uint32_t less = 4000, more = 1 << 30;
    memcpy(bytes, &less, 4);
    expect_vti(&(vti_case){.data = bytes, .count = sizeof bytes}, "truncated");
    memcpy(bytes, &more, 4);
    expect_vti(&(vti_case){.data = bytes, .count = 4000}, "truncated");
}

static char *repeated(const char *text, size_t times) {
    char *all = malloc(strlen(text) * times + 1);
    assert_non_null(all);
    *all = 0;
    for (size_t i = 0, length = strlen(text); i < times; i++) memcpy(all + i * length, text, length + 1);
    return all;
}

static void texts_of_other_lengths(void **state) {
    (void)state;
    char *less = repeated(" 7", 4095), *more = repeated(" 7", 20000), *odd = repeated(" 7", 100);
    expect_vti(&(vti_case){.text = less}, "4095 numbers");
    expect_vti(&(vti_case){.text = more}, "more numbers");
    strcpy(odd + 100, " x");
    expect_vti(&(vti_case){.text = odd}, "50 numbers");
    free(less);
    free(more);
    free(odd);
}

static void xml_that_takes_too_much(void **state) {
    (void)state;
    char *wide = repeated("<a/>", 60000), *deep = repeated("<a>", 100), *long_one = repeated("x", 5 << 20);
    char *attribute = malloc((5 << 20) + 20);
    assert_non_null(attribute);
    sprintf(attribute, "<a b=\"%s\"/>", long_one);
    expect_vti(&(vti_case){.inside = wide, .text = "1"}, "XML elements");
    expect_vti(&(vti_case){.inside = deep, .text = "1"}, "XML elements");
    expect_vti(&(vti_case){.inside = attribute, .text = "1"}, "XML elements");
    expect_vti(&(vti_case){.inside = "<!DOCTYPE a>", .text = "1"}, "XML has a document type");
    expect_vti(&(vti_case){.spacing = "1 x 1", .text = "1"}, "Spacing=\"1 x 1\" is not 3 numbers");
    expect_vti(&(vti_case){.spacing = "1 nan 1", .text = "1"}, "Spacing");
    expect_vti(&(vti_case){.spacing = "1 1", .text = "1"}, "Spacing");
    /* What is in comments counts for nothing, and neither does field data, which VTK would make room for. */
    char *values = repeated(" 7", 4096);
    const char *right = "<!-- <a> <a> > --><?x <a>?>";
    iso_volume volume = test_read_volume(write_vti(&(vti_case){.inside = right, .text = values}), NULL);
    iso_volume_free(&volume);
    free(wide);
    free(deep);
    free(long_one);
    free(attribute);
    free(values);
}

/* A block as large as the array is unpacked beside it. */
static void room_for_blocks_is_counted(void **state) {
    (void)state;
    uint64_t room[2] = {0};
    for (uint32_t i = 0; i < 2; i++) {
        unsigned char bytes[4000] = {0};
        const uint32_t one[4] = {1, 4096, 0, 100}, many[3] = {256, 16, 0};
        memcpy(bytes, i ? many : one, i ? sizeof many : sizeof one);
        iso_volume_info info;
        iso_error error = {0};
        const char *path = write_vti(&(vti_case){.file = COMPRESSED, .data = bytes, .count = sizeof bytes});
        if (iso_volume_read_info(path, NULL, &info, &error) != ISO_OK) fail_msg("%s", error.text);
        room[i] = info.read_bytes;
    }
    assert_true(room[0] >= 2 * 4096 + 100 && room[0] < 3 * 4096);
    assert_true(room[1] >= 4096 + 256 * 20 && room[1] < 3 * 4096);
}

#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_that_no_picture_can_use),
        cmocka_unit_test(numbers_of_legacy_vtk),
        cmocka_unit_test(options_of_other_formats_are_noted),
        cmocka_unit_test(nifti_numbers),
        cmocka_unit_test(nifti_offsets),
        cmocka_unit_test(a_spacing_can_be_given),
#if ISO_TEST_HAS_VTI
        cmocka_unit_test(lying_blocks),
        cmocka_unit_test(lying_lengths),
        cmocka_unit_test(texts_of_other_lengths),
        cmocka_unit_test(xml_that_takes_too_much),
        cmocka_unit_test(room_for_blocks_is_counted),
#endif
    };
    mkdir(folder, 0777);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
