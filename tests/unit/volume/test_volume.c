/* volume: which reader a file gets, what is checked before and after it, raw files, and the real volumes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "grids/brick_index.h"
#include "grids/volume/format.h"
#include "grids/volume/volume.h"
#include "make_volumes.h"

static const char folder[] = ISO_TEST_TMP "/volume";

static void check_refused(const char *path, const iso_volume_opts *opts, iso_status wanted,
                          const char *part) {
    iso_volume volume = {0};
    iso_error error = {0};
    iso_status status = iso_volume_read(path, opts, &volume, &error);
    if (status == ISO_OK) fail_msg("%s was read", path);
    if (status != wanted) fail_msg("%s: status %d instead of %d: %s", path, status, wanted, error.text);
    if (strncmp(error.text, path, strlen(path)) != 0 || strchr(error.text, '\n') || !strstr(error.text, part))
        fail_msg("'%s' does not name %s and say '%s' in one line", error.text, path, part);
    assert_null(volume.grid.rgrid);
}

/* ---- conversion ---- */

static void scalars_convert(void **state) {
    (void)state;
    const uint8_t bytes[] = {0, 1, 0x80, 0xff, 0x12, 0x34};
    uint16_t words[3];
    iso_scalar_source source = {bytes, ISO_SCALAR_UINT16, 1, 0, true};
    iso_scalar_convert(&source, 3, ISO_UINT16, words);
    assert_int_equal(words[0], 0x0001);
    assert_int_equal(words[1], 0x80ff);
    assert_int_equal(words[2], 0x1234);
    int16_t signs[2];
    source = (iso_scalar_source){bytes + 1, ISO_SCALAR_INT8, 2, 1, true}; /* a byte has no order */
    iso_scalar_convert(&source, 2, ISO_INT16, signs);
    assert_int_equal(signs[0], -128);
    assert_int_equal(signs[1], 0x12);
    const double reals[] = {1.5, -2.25, 1e300};
    float floats[3];
    source = (iso_scalar_source){reals, ISO_SCALAR_DOUBLE, 1, 0, false};
    iso_scalar_convert(&source, 2, ISO_FLOAT32, floats);
    assert_true(floats[0] == 1.5f && floats[1] == -2.25f);
    source = (iso_scalar_source){bytes, ISO_SCALAR_UINT8, 3, 2, false};
    iso_scalar_convert(&source, 2, ISO_FLOAT32, floats);
    assert_true(floats[0] == 128 && floats[1] == 0x34);
    uint16_t in_place[] = {0x0102, 0x0304};
    source = (iso_scalar_source){in_place, ISO_SCALAR_INT16, 1, 0, true};
    iso_scalar_convert(&source, 2, ISO_INT16, in_place);
    assert_int_equal(in_place[0], 0x0201);
    assert_int_equal(in_place[1], 0x0403);
}

/* All numbers of 16 bits, as the standard (IEEE 754) defines them. */
static void halves_convert(void **state) {
    (void)state;
    for (uint32_t bits = 0; bits < 65536; bits++) {
        const uint16_t number = (uint16_t)bits;
        const iso_scalar_source source = {&number, ISO_SCALAR_HALF, 1, 0, false};
        const int exponent = (int)(bits >> 10 & 31), fraction = (int)(bits & 1023);
        double wanted = exponent == 31 ? (fraction ? NAN : INFINITY)
                        : exponent     ? ldexp(1024 + fraction, exponent - 25)
                                       : ldexp(fraction, -24);
        float got;
        if (bits & 0x8000) wanted = -wanted;
        iso_scalar_convert(&source, 1, ISO_FLOAT32, &got);
        assert_true(isnan(wanted) ? isnan(got)
                                  : (double)got == wanted && (signbit(got) != 0) == (bits >> 15 & 1));
    }
}

/* ---- raw ---- */

static void raw_layouts_parse(void **state) {
    (void)state;
    iso_raw_layout layout;
    iso_error error = {0};
    assert_int_equal(iso_raw_layout_parse("64x32x16:int16:big:512", &layout, &error), ISO_OK);
    assert_int_equal(layout.dims[0], 64);
    assert_int_equal(layout.dims[1], 32);
    assert_int_equal(layout.dims[2], 16);
    assert_int_equal(layout.type, ISO_INT16);
    assert_true(layout.big_endian);
    assert_int_equal(layout.offset, 512);
    const char *good[] = {"1x2x3:uint8",       "1X2X3:UINT16:",        "1x2x3:float::",
                          "1x2x3:float32:big", "1x2x3:uint8:little:0", "1x2x3:uint8::18446744073709551615"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        if (iso_raw_layout_parse(good[i], &layout, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_true(layout.offset == UINT64_MAX && !layout.big_endian);
    const char *bad[] = {"",
                         "1x2",
                         "1x2x3",
                         "1x2x3:",
                         "1x2x3:uint",
                         "1x2x3x4:uint8",
                         "0x2x3:uint8",
                         "-1x2x3:uint8",
                         "1x2x3000000000:uint8",
                         "1 x2x3:uint8",
                         "1x2x3:uint8:middle",
                         "1x2x3:uint8:big:-1",
                         "1x2x3:uint8:big:1k",
                         "1x2x3:uint8:big:1:2",
                         "1x2x3:uint8::18446744073709551616"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        memset(&error, 0, sizeof error);
        if (iso_raw_layout_parse(bad[i], &layout, &error) != ISO_ERR_USAGE)
            fail_msg("'%s' was parsed", bad[i]);
        assert_non_null(strstr(error.text, bad[i]));
    }
}

static void raw_files_are_read(void **state) {
    (void)state;
    const char *path = vol_path(folder, "some.xyz", 0);
    const struct {
        iso_scalar scalar;
        iso_type type;
    } types[] = {{ISO_SCALAR_UINT8, ISO_UINT8},
                 {ISO_SCALAR_INT16, ISO_INT16},
                 {ISO_SCALAR_UINT16, ISO_UINT16},
                 {ISO_SCALAR_FLOAT, ISO_FLOAT32}};
    for (int t = 0; t < 4; t++)
        for (int variant = 0; variant < 8; variant++) {
            vol_spec spec = {{3, 4, 5}, types[t].scalar, variant & 2 ? 2 : 1, variant & 1};
            FILE *file = fopen(path, "wb");
            if (variant & 4) fputs("a header", file);
            vol_put_values(file, &spec, false);
            fclose(file);
            iso_raw_layout raw = {.dims = {3, 4, 5},
                                  .type = types[t].type,
                                  .components = spec.components,
                                  .big_endian = spec.big,
                                  .offset = variant & 4 ? 8 : 0};
            iso_volume_opts opts = {.raw = &raw, .component = spec.components - 1, .spacing = {0, 2.5, 0}};
            iso_volume volume;
            iso_error error = {0};
            if (iso_volume_read(path, &opts, &volume, &error) != ISO_OK) fail_msg("%s", error.text);
            for (size_t i = 0; i < vol_count(&spec); i++)
                assert_true(iso_rgrid_at(volume.grid.rgrid, (int)i % 3, (int)i / 3 % 4, (int)i / 12) ==
                            (float)vol_value(&spec, i, opts.component));
            assert_true(volume.grid.rgrid->transform.spacing[1] == 2.5);
            assert_true(volume.info.transform.spacing[2] == 1);
            iso_volume_free(&volume);
            assert_int_equal(truncate(path, (off_t)(raw.offset +
                                                    vol_count(&spec) * iso_scalar_size(spec.scalar) *
                                                        (size_t)spec.components -
                                                    1)),
                             0);
            check_refused(path, &opts, ISO_ERR_IO, "truncated");
        }
}

static void raw_files_that_do_not_fit(void **state) {
    (void)state;
    const char *path = vol_path(folder, "small.raw", 0);
    vol_write_bytes(path, "123456789", 9);
    check_refused(path, NULL, ISO_ERR_FORMAT, "--raw");
    iso_raw_layout raw = {.dims = {2, 2, 2}, .type = ISO_UINT8};
    iso_volume_opts opts = {.raw = &raw};
    iso_volume_info info;
    assert_int_equal(iso_volume_read_info(path, &opts, &info, NULL), ISO_OK);
    assert_string_equal(info.notes[0], "1 bytes after the last voxel are not used");
    raw.offset = 2;
    check_refused(path, &opts, ISO_ERR_IO, "truncated: 9 of 10 bytes");
    raw.offset = UINT64_MAX;
    check_refused(path, &opts, ISO_ERR_IO, "truncated");
    raw = (iso_raw_layout){.dims = {1000000, 1000000, 1000000}, .type = ISO_FLOAT32};
    check_refused(path, &opts, ISO_ERR_LIMIT, "needs 4.0 EB to read (1000000 x 1000000 x 1000000 float32)");
    raw.dims[1] = -3;
    check_refused(path, &opts, ISO_ERR_FORMAT, "voxels");
    raw = (iso_raw_layout){.dims = {INT32_MAX, INT32_MAX, INT32_MAX}, .type = ISO_FLOAT32};
    check_refused(path, &opts, ISO_ERR_FORMAT, "more than any machine can hold");
    check_refused(folder, &opts, ISO_ERR_IO, "folder");
}

/* ---- what surrounds the readers ---- */

static void unreadable_things_are_named(void **state) {
    (void)state;
    check_refused(vol_path(folder, "missing.nrrd", 0), NULL, ISO_ERR_IO, "No such file");
    const char *names[] = {"empty.nrrd", "empty.vti", "empty.nii.gz", "empty.mha",
                           "empty.vtk",  "empty.txt", "empty.vdb"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        vol_write_bytes(vol_path(folder, names[i], 0), "", 0);
        check_refused(vol_path(folder, names[i], 0), NULL, ISO_ERR_IO, "the file is empty");
    }
    const char *text = vol_path(folder, "letter.txt", 0);
    vol_write_text(text, "Dear reader,\nthis is not a volume.\n");
    check_refused(text, NULL, ISO_ERR_FORMAT, "not a volume that can be read");
    const char *fifo = vol_path(folder, "pipe.nrrd", 0);
    remove(fifo);
    if (mkfifo(fifo, 0600) == 0) check_refused(fifo, NULL, ISO_ERR_IO, "not a file");
    const char *bare = vol_path(folder, "bare", 0);
    mkdir(bare, 0777);
    iso_volume volume;
    iso_error error = {0};
    iso_status status = iso_volume_read(bare, NULL, &volume, &error);
    assert_int_equal(iso_status_exit(status), 3);
    assert_non_null(strstr(error.text, bare));
}

/* Without the right name a file is known by what it holds. */
static void content_outweighs_the_name(void **state) {
    (void)state;
    const char *names[] = {"noname",    "wrong.nrrd", "wrong.vti", "wrong.nii",
                           "wrong.mha", "UPPER.VTK",  "wrong.dcm"};
    for (size_t k = 0; k < vol_kind_count; k++) {
        const vol_kind *kind = &vol_kinds[k];
        vol_spec spec = {{4, 3, 2}, ISO_SCALAR_INT16, 1, false};
        bool alone = !kind->files[1];
        if (!alone) continue;
        kind->write(kind, folder, &spec);
        size_t count;
        unsigned char *bytes = vol_read_bytes(vol_path(folder, kind->files[0], 0), &count);
        for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
            const char *path = vol_path(folder, names[i], 0);
            vol_write_bytes(path, bytes, count);
            iso_volume volume;
            iso_error error = {0};
            iso_status status = iso_volume_read(path, NULL, &volume, &error);
            if (status == ISO_ERR_UNSUPPORTED) continue;
            if (status != ISO_OK) fail_msg("%s as %s: %s", kind->name, names[i], error.text);
            assert_string_equal(volume.info.format, kind->needs);
            iso_volume_free(&volume);
        }
        free(bytes);
    }
}

static const char *write_mha(int components) {
    static const vol_kind *mha;
    for (size_t k = 0; k < vol_kind_count; k++)
        if (strcmp(vol_kinds[k].name, "mha") == 0) mha = &vol_kinds[k];
    vol_spec spec = {{100, 100, 100}, ISO_SCALAR_INT16, components, false};
    mha->write(mha, folder, &spec);
    return vol_path(folder, mha->files[0], 0);
}

static void limits_are_kept(void **state) {
    (void)state;
    const char *path = write_mha(1);
    const uint64_t needs = 2000000 + iso_brick_index_estimate((const int[3]){100, 100, 100});
    iso_volume_opts opts = {.max_memory = needs - 1};
    check_refused(path, &opts, ISO_ERR_LIMIT,
                  "needs 2.0 MB to read (100 x 100 x 100 int16), limit is 2.0 MB");
    opts.max_memory = needs;
    iso_volume volume;
    assert_int_equal(iso_volume_read(path, &opts, &volume, NULL), ISO_OK);
    assert_non_null(volume.grid.rgrid->index);
    iso_volume_free(&volume);
    path = write_mha(3); /* what components need beside the grid counts as well */
    check_refused(path, &opts, ISO_ERR_LIMIT, "needs");
}

static void components_and_spacing_are_checked(void **state) {
    (void)state;
    const char *path = write_mha(3);
    iso_volume_opts opts = {.component = 3};
    check_refused(path, &opts, ISO_ERR_USAGE, "no component 3, there are 3");
    opts.component = -1;
    check_refused(path, &opts, ISO_ERR_USAGE, "no component -1");
    opts = (iso_volume_opts){.spacing = {1, -2, 1}};
    check_refused(path, &opts, ISO_ERR_USAGE, "spacing of -2");
    opts = (iso_volume_opts){.spacing = {0, 0, 7}};
    iso_volume_info info;
    assert_int_equal(iso_volume_read_info(path, &opts, &info, NULL), ISO_OK);
    assert_true(info.transform.spacing[0] == 0.5 && info.transform.spacing[2] == 7);
}

typedef struct steps {
    int count, stop_at;
    double last;
} steps;

static int on_progress(void *context, double fraction) {
    steps *s = context;
    if (!(fraction >= s->last && fraction <= 1)) fail_msg("progress went from %g to %g", s->last, fraction);
    s->last = fraction;
    return ++s->count == s->stop_at;
}

static void progress_is_told_and_stops(void **state) {
    (void)state;
    const char *path = write_mha(1);
    steps s = {0};
    iso_volume_opts opts = {.progress = on_progress, .progress_context = &s};
    iso_volume volume;
    assert_int_equal(iso_volume_read(path, &opts, &volume, NULL), ISO_OK);
    iso_volume_free(&volume);
    assert_true(s.count >= 3 && s.last == 1);
    for (int stop = 1, all = s.count; stop <= all; stop++) {
        s = (steps){.stop_at = stop};
        check_refused(path, &opts, ISO_ERR_IO, "cancelled");
        assert_int_equal(s.count, stop);
    }
}

static void missing_libraries_are_named(void **state) {
    (void)state;
    const iso_format *all[] = {&iso_format_vtk,   &iso_format_metaimage, &iso_format_nrrd,
                               &iso_format_nifti, &iso_format_dicom,     &iso_format_raw};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        /* the place of raw voxels is all that is needed to read them */
        assert_true(!all[i]->info == !all[i]->read || all[i] == &iso_format_raw);
        assert_non_null(all[i]->library);
        if (all[i]->info) continue;
        char name[32];
        snprintf(name, sizeof name, "some.%s", strcmp(all[i]->name, "nifti") == 0 ? "img" : all[i]->name);
        vol_write_text(vol_path(folder, name, 0), "abc");
        check_refused(vol_path(folder, name, 0), NULL, ISO_ERR_UNSUPPORTED, all[i]->library);
    }
}

/* ---- real volumes ---- */

typedef struct real {
    char path[256], format[64], dims[32], type[64], spacing[64];
    double min, max;
} real;

/* A row of INDEX.tsv; false: not one of a dense volume. */
static bool parse_row(char *line, real *row) {
    char *cell[16] = {0};
    for (int i = 0; i < 16 && line; i++) cell[i] = strsep(&line, "\t");
    if (!cell[15] || strcmp(cell[0], "name") == 0 || strstr(cell[2], "vdb")) return false;
    snprintf(row->path, sizeof row->path, "%s/%s", ISO_TEST_VOLUMES, cell[1]);
    snprintf(row->format, sizeof row->format, "%s", cell[2]);
    snprintf(row->dims, sizeof row->dims, "%s", cell[3]);
    snprintf(row->type, sizeof row->type, "%.*s", (int)strcspn(cell[4], " "), cell[4]);
    snprintf(row->spacing, sizeof row->spacing, "%s", cell[5]);
    row->min = atof(cell[6]);
    row->max = atof(cell[7]);
    return true;
}

static void check_real(const real *row) {
    char layout[160];
    bool raw = strncmp(row->format, "raw", 3) == 0, den = strncmp(row->format, "VolPack", 7) == 0;
    snprintf(layout, sizeof layout, "%s:%s%s", row->dims, row->type, den ? "::62" : "");
    iso_raw_layout parsed;
    iso_volume_opts opts = {0};
    if (raw || den) {
        assert_int_equal(iso_raw_layout_parse(layout, &parsed, NULL), ISO_OK);
        opts.raw = &parsed;
    }
    iso_volume volume;
    iso_error error = {0};
    iso_status status = iso_volume_read(row->path, &opts, &volume, &error);
    if (status == ISO_ERR_UNSUPPORTED) {
        print_message("%s\n", error.text);
        return;
    }
    if (status != ISO_OK) fail_msg("%s", error.text);
    const iso_rgrid *grid = volume.grid.rgrid;
    char dims[32];
    snprintf(dims, sizeof dims, "%dx%dx%d", grid->dims[0], grid->dims[1], grid->dims[2]);
    assert_string_equal(dims, row->dims);
    assert_string_equal(iso_type_name(grid->type), row->type);
    double spacing[3];
    assert_int_equal(sscanf(row->spacing, "%lf %lf %lf", spacing, spacing + 1, spacing + 2), 3);
    for (int i = 0; i < 3; i++) assert_true(fabs(grid->transform.spacing[i] - spacing[i]) < 1e-5);
    float min = HUGE_VALF, max = -HUGE_VALF;
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++) {
                float value = iso_rgrid_at(grid, x, y, z);
                min = value < min ? value : min;
                max = value > max ? value : max;
            }
    if (min != (float)row->min || max != (float)row->max)
        fail_msg("%s: range %g .. %g instead of %g .. %g", row->path, min, max, row->min, row->max);
    iso_volume_free(&volume);
}

static void real_volumes_are_as_listed(void **state) {
    (void)state;
    FILE *index = fopen(ISO_TEST_VOLUMES "/INDEX.tsv", "r");
    if (!index) {
        print_message("%s is not there\n", ISO_TEST_VOLUMES);
        skip();
    }
    char line[4096];
    int rows = 0;
    while (fgets(line, sizeof line, index)) {
        real row;
        if (!parse_row(line, &row)) continue;
        check_real(&row);
        rows++;
    }
    fclose(index);
    assert_true(rows >= 12);
}

static bool read_real(const char *name, iso_volume *volume) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", ISO_TEST_VOLUMES, name);
    iso_error error = {0};
    iso_status status = iso_volume_read(path, NULL, volume, &error);
    if (status == ISO_OK) return true;
    print_message("%s\n", error.text);
    return false;
}

/* One array in two formats: every voxel has the same value in the same place. */
static void flair_is_the_same_twice(void **state) {
    (void)state;
    iso_volume a, b;
    if (!read_real("nrrd_FLAIR/FLAIR.nrrd", &a)) skip();
    if (!read_real("nrrd_FLAIR/FLAIR.nii.gz", &b)) {
        iso_volume_free(&a);
        skip();
    }
    assert_memory_equal(a.info.dims, b.info.dims, sizeof a.info.dims);
    assert_memory_equal(a.grid.rgrid->data, b.grid.rgrid->data, a.info.bytes);
    iso_affine to_a = iso_transform_affine(&a.info.transform), to_b = iso_transform_affine(&b.info.transform);
    for (int corner = 0; corner < 8; corner++) {
        iso_vec3 index = {corner & 1 ? 123 : 0, corner & 2 ? 159 : 0, corner & 4 ? 139 : 0};
        iso_vec3 apart = iso_vec3_sub(iso_affine_point(&to_a, index), iso_affine_point(&to_b, index));
        assert_true(iso_vec3_length(apart) < 1e-3);
    }
    assert_true(a.info.anatomical && b.info.anatomical);
    iso_volume_free(&a);
    iso_volume_free(&b);
}

/* The .vti lost the handedness that the .nhdr tells: equal arrays, mirrored worlds; DICOM (identity
 * direction, slices upwards) has the .nhdr's. */
static void headsq_keeps_its_handedness(void **state) {
    (void)state;
    iso_volume a, b;
    if (!read_real("headsq_raw/quarter.nhdr", &a)) skip();
    assert_true(iso_transform_affine(&a.info.transform).determinant < 0);
    assert_true(a.info.transform.direction[8] == -1);
    if (read_real("headsq_vti/headsq.vti", &b)) {
        assert_memory_equal(a.grid.rgrid->data, b.grid.rgrid->data, a.info.bytes);
        assert_true(iso_transform_affine(&b.info.transform).determinant > 0);
        iso_volume_free(&b);
    }
    if (read_real("dicom_cthead_slicer", &b)) {
        for (int z = 0; z < 93; z++)
            for (int y = 0; y < 64; y++)
                for (int x = 0; x < 64; x++) {
                    /* the same place in both worlds, up to the .nhdr's missing origin */
                    iso_affine m = iso_transform_affine(&b.info.transform);
                    iso_vec3 at = iso_affine_vector(&m, iso_vec3_make(x, y, z));
                    int other = 92 - (int)(at.z / 1.5 + 0.5);
                    assert_true(iso_rgrid_at(b.grid.rgrid, x, y, z) ==
                                iso_rgrid_at(a.grid.rgrid, x, y, other));
                }
        iso_volume_free(&b);
    }
    iso_volume_free(&a);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scalars_convert),
        cmocka_unit_test(halves_convert),
        cmocka_unit_test(raw_layouts_parse),
        cmocka_unit_test(raw_files_are_read),
        cmocka_unit_test(raw_files_that_do_not_fit),
        cmocka_unit_test(unreadable_things_are_named),
        cmocka_unit_test(content_outweighs_the_name),
        cmocka_unit_test(limits_are_kept),
        cmocka_unit_test(components_and_spacing_are_checked),
        cmocka_unit_test(progress_is_told_and_stops),
        cmocka_unit_test(missing_libraries_are_named),
        cmocka_unit_test(real_volumes_are_as_listed),
        cmocka_unit_test(flair_is_the_same_twice),
        cmocka_unit_test(headsq_keeps_its_handedness),
    };
    mkdir(folder, 0777);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
