/* The DICOM reader with series that the test writes: every voxel is read at its position, or reading fails.
 */
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "dicom_files.h"
#include "file_support.h"
#include "grids/volume/volume.h"
#include "volume_support.h"

#define FOLDER ISO_TEST_TMP "/test_dicom"

enum { COLUMNS = 21, ROWS = 17, SLICES = 6 };

/* ---- folders ---- */

static void clear_folder(void) {
    mkdir(FOLDER, 0777);
    DIR *dir = opendir(FOLDER);
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir));) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", FOLDER, entry->d_name);
        if (entry->d_name[0] != '.') unlink(path);
    }
    closedir(dir);
}

static int empty_folder(void **state) {
    (void)state;
    clear_folder();
    return 0;
}

static void in_folder(char path[1024], const char *name) {
    snprintf(path, 1024, "%s/%s", FOLDER, name);
}

/* ---- reading ---- */

static iso_volume read_ok(const char *path, const iso_volume_opts *opts) {
    const iso_volume volume = test_read_volume(path, opts);
    assert_non_null(volume.grid.rgrid);
    assert_string_equal(volume.info.format, "dicom");
    return volume;
}

/* ---- series ---- */

/* Stored value of a voxel: 12 bits with a sign. */
static int value_at(int x, int y, int z) {
    return (x * 37 + y * 211 + z * 503) % 4000 - 1900;
}

static void fill_slice(int16_t pixels[ROWS * COLUMNS], int z) {
    for (int y = 0; y < ROWS; y++)
        for (int x = 0; x < COLUMNS; x++) pixels[y * COLUMNS + x] = (int16_t)value_at(x, y, z);
}

static const dicom_spec plain = {.series = "1.2.3",
                                 .description = "Head",
                                 .orientation = "1\\0\\0\\0\\1\\0",
                                 .spacing = "0.5\\0.75",
                                 .thickness = "5",
                                 .slope = "2",
                                 .intercept = "-1024",
                                 .columns = COLUMNS,
                                 .rows = ROWS,
                                 .allocated = 16,
                                 .stored = 16,
                                 .high = 15,
                                 .is_signed = 1};

/* A slice of a series: what differs from `base`. */
typedef struct slice_place {
    double x, y, z;
    int number; /* decides the pixels and the instance number */
} slice_place;

static void write_slice(const dicom_spec *base, const char *name, slice_place place) {
    char path[1024], position[64], instance[16];
    int16_t pixels[ROWS * COLUMNS];
    dicom_spec spec = *base;
    fill_slice(pixels, place.number);
    snprintf(position, sizeof position, "%.6g\\%.6g\\%.6g", place.x, place.y, place.z);
    snprintf(instance, sizeof instance, "%d", 100 - place.number); /* runs the other way */
    if (!spec.position) spec.position = position;
    if (!spec.instance) spec.instance = instance;
    if (!spec.pixels) spec.pixels = pixels;
    in_folder(path, name);
    dicom_write(path, &spec);
}

/* Slices 0 .. SLICES-1, 1.25 mm apart from z = -3, named in another order than they lie. */
static void write_series(const dicom_spec *base, const char *prefix, unsigned left_out) {
    for (int z = 0; z < SLICES; z++) {
        char name[64];
        snprintf(name, sizeof name, "%s%d", prefix, (z * 5 + 3) % SLICES);
        if (!(left_out >> z & 1)) write_slice(base, name, (slice_place){-10, -20, -3 + 1.25 * z, z});
    }
}

static void check_values(const iso_rgrid *grid, int slices) {
    assert_int_equal(grid->dims[0], COLUMNS);
    assert_int_equal(grid->dims[1], ROWS);
    assert_int_equal(grid->dims[2], slices);
    for (int z = 0; z < slices; z++)
        for (int y = 0; y < ROWS; y++)
            for (int x = 0; x < COLUMNS; x++)
                if (iso_rgrid_at(grid, x, y, z) != (float)value_at(x, y, z))
                    fail_msg("at %d %d %d: %g, not %d", x, y, z, (double)iso_rgrid_at(grid, x, y, z),
                             value_at(x, y, z));
}

static void check_transform(const iso_rgrid *grid, const double origin[3], const double spacing[3],
                            const double direction[9]) {
    for (int i = 0; i < 3; i++) {
        if (fabs(grid->transform.origin[i] - origin[i]) > 1e-9 ||
            fabs(grid->transform.spacing[i] - spacing[i]) > 1e-9)
            fail_msg("axis %d: origin %g, not %g, spacing %g, not %g", i, grid->transform.origin[i],
                     origin[i], grid->transform.spacing[i], spacing[i]);
    }
    for (int i = 0; i < 9; i++)
        if (fabs(grid->transform.direction[i] - direction[i]) > 1e-9)
            fail_msg("direction[%d] is %g, not %g", i, grid->transform.direction[i], direction[i]);
}

static const double plain_origin[3] = {-10, -20, -3}, plain_spacing[3] = {0.75, 0.5, 1.25};
static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void series_comes_back(void **state) {
    (void)state;
    write_series(&plain, "IM", 0);
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    check_transform(volume.grid.rgrid, plain_origin, plain_spacing, identity);
    assert_true(volume.grid.rgrid->scale == 2 && volume.grid.rgrid->offset == -1024);
    assert_true(volume.grid.rgrid->type == ISO_INT16 && volume.info.anatomical);
    assert_string_equal(volume.info.file_type, "int16");
    assert_int_equal(volume.info.note_count, 0);
    iso_volume_free(&volume);
    test_expect_no_volume(FOLDER, &(iso_volume_opts){.component = 1}, ISO_ERR_USAGE, FOLDER, "component");
    test_expect_no_volume(FOLDER, &(iso_volume_opts){.max_memory = 100}, ISO_ERR_LIMIT, FOLDER, "limit");
}

static void strays_are_ignored(void **state) {
    (void)state;
    char path[1024];
    write_series(&plain, "IM", 0);
    in_folder(path, "README.txt");
    spill(path, "these are slices\n", 17);
    in_folder(path, "empty");
    spill(path, "", 0);
    dicom_spec report = plain;
    in_folder(path, "report");
    dicom_write(path, &report);
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    assert_true(test_has_note(&volume.info,
                              "3 files are left out (2 not DICOM, 1 without an image), the first: "
                              "README.txt: not a DICOM file"));
    iso_volume_free(&volume);
    iso_error error = {0};
    in_folder(path, "report");
    assert_int_equal(iso_volume_read_info(path, NULL, &(iso_volume_info){0}, &error), ISO_ERR_FORMAT);
    in_folder(path, "notes.dcm");
    spill(path, "no image\n", 9);
    test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, FOLDER, "not a DICOM file");
    in_folder(path, "IM0");
    volume = read_ok(path, NULL);
    iso_volume_free(&volume);
}

static void folders_without_images(void **state) {
    (void)state;
    char path[1024];
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "no DICOM images");
    in_folder(path, "text");
    spill(path, "text", 4);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "no DICOM images");
}

static void storage(void **state) {
    (void)state;
    static const dicom_syntax syntaxes[] = {DICOM_EXPLICIT, DICOM_IMPLICIT, DICOM_BIG};
    for (int i = 0; i < 3; i++) {
        dicom_spec spec = plain;
        spec.syntax = syntaxes[i];
        clear_folder();
        write_series(&spec, "IM", 0);
        iso_volume volume = read_ok(FOLDER, NULL);
        check_values(volume.grid.rgrid, SLICES);
        check_transform(volume.grid.rgrid, plain_origin, plain_spacing, identity);
        iso_volume_free(&volume);
    }
}

static void compressed(void **state) {
    (void)state;
    static const char *const ways[] = {"rle", "jpeg", "jpegls", "j2k"};
    char path[1024], printed[1024];
    in_folder(printed, ".printed");
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        clear_folder();
        write_series(&plain, "IM", 0);
        for (int z = 0; z < SLICES; z++) {
            snprintf(path, sizeof path, "%s/IM%d", FOLDER, z);
            assert_int_equal(dicom_compress(path, ways[i]), 0);
        }
        fflush(stderr);
        int kept = dup(2);
        assert_non_null(freopen(printed, "wb", stderr));
        iso_volume volume = read_ok(FOLDER, NULL);
        fflush(stderr);
        dup2(kept, 2);
        close(kept);
        struct stat status;
        assert_int_equal(stat(printed, &status), 0);
        assert_int_equal(status.st_size, 0);
        check_values(volume.grid.rgrid, SLICES);
        check_transform(volume.grid.rgrid, plain_origin, plain_spacing, identity);
        assert_true(volume.grid.rgrid->scale == 2 && volume.grid.rgrid->offset == -1024);
        iso_volume_free(&volume);
    }
    unlink(printed);
}

/* Only compressed pixels need GDCM. */
static void without_gdcm(void **state) {
    (void)state;
    char path[1024];
    in_folder(path, "IM2");
    setenv("ISO_MODULE_PATH", FOLDER, 1);
    write_series(&plain, "IM", 0);
    iso_volume volume = read_ok(FOLDER, NULL);
    iso_volume_free(&volume);
    assert_int_equal(dicom_compress(path, "jpeg"), 0);
    iso_volume_info info;
    assert_int_equal(iso_volume_read_info(FOLDER, NULL, &info, NULL), ISO_OK);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_UNSUPPORTED, FOLDER,
                          "IM2: the GDCM reader (libisopoint-dicom.so) is not installed");
    unsetenv("ISO_MODULE_PATH");
}

/* ---- which series ---- */

static void several_series(void **state) {
    (void)state;
    char path[1024];
    dicom_spec other = plain;
    other.series = "1.2.4";
    other.description = "Scout";
    other.series_number = "1";
    other.intercept = "7";
    dicom_spec head = plain;
    head.series_number = "2";
    write_series(&head, "A", 0);
    write_slice(&other, "B0", (slice_place){0, 0, 0, 0});
    write_slice(&other, "B1", (slice_place){0, 0, 4, 1});
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    assert_true(test_has_note(&volume.info, "using 2 of 2"));
    assert_int_equal(volume.info.item_count, 2);
    assert_string_equal(volume.info.items[0], "1  CT  21x17x2  Scout  (2 images)  1.2.4");
    iso_volume_free(&volume);
    static const char *const names[] = {"1", "1.2.4"};
    for (int i = 0; i < 2; i++) {
        volume = read_ok(FOLDER, &(iso_volume_opts){.series = names[i]});
        check_values(volume.grid.rgrid, 2);
        assert_true(volume.grid.rgrid->offset == 7);
        iso_volume_free(&volume);
    }
    in_folder(path, "B1"); /* not named .dcm: found by its content */
    volume = read_ok(path, NULL);
    check_values(volume.grid.rgrid, 2);
    iso_volume_free(&volume);
    test_expect_no_volume(FOLDER, &(iso_volume_opts){.series = "3"}, ISO_ERR_USAGE, FOLDER, "there are 2");
    test_expect_no_volume(FOLDER, &(iso_volume_opts){.series = "1.2"}, ISO_ERR_USAGE, FOLDER, "1.2");
}

static void scout_in_the_series(void **state) {
    (void)state;
    dicom_spec scout = plain;
    scout.orientation = "1\\0\\0\\0\\0\\-1";
    write_series(&plain, "IM", 0);
    write_slice(&scout, "A", (slice_place){0, 0, 50, 1});
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    assert_true(test_has_note(&volume.info, "1 image of another"));
    iso_volume_free(&volume);
}

/* ---- gaps and doubles ---- */

static void missing_slices(void **state) {
    (void)state;
    write_series(&plain, "IM", 1U << 2);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER,
                          "1 slice is missing: a gap of 2.5 mm between IM2 (at -1.75) and IM0 (at 0.75)");
    assert_int_equal(iso_volume_read_info(FOLDER, NULL, &(iso_volume_info){0}, NULL), ISO_ERR_FORMAT);
    clear_folder();
    write_series(&plain, "IM", 1U << 2 | 1U << 3);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "2 slices are missing");
    clear_folder();
    write_series(&plain, "IM", 1U << 1 | 1U << 2 | 1U << 3); /* two steps are left: which is the gap? */
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "3 slices are missing");
    clear_folder();
    write_series(&plain, "IM", 1U << 5);
    write_slice(&plain, "last", (slice_place){-10, -20, -3 + 1.25 * 4 + 1.6, 5});
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "not evenly spaced: 1.6 mm");
}

static void uneven_steps(void **state) {
    (void)state;
    write_series(&plain, "IM", 1U << 2);
    write_slice(&plain, "moved", (slice_place){-10, -20, -3 + 1.25 * 2 + 0.05, 2});
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    check_transform(volume.grid.rgrid, plain_origin, plain_spacing, identity);
    assert_true(test_has_note(&volume.info, "varies by 0.05"));
    iso_volume_free(&volume);
    clear_folder();
    write_series(&plain, "IM", 1U << 2);
    write_slice(&plain, "rounded", (slice_place){-10, -20, -3 + 1.25 * 2 + 0.004, 2});
    volume = read_ok(FOLDER, NULL);
    assert_int_equal(volume.info.note_count, 0);
    iso_volume_free(&volume);
}

static void doubled_slices(void **state) {
    (void)state;
    write_series(&plain, "IM", 0);
    write_slice(&plain, "again", (slice_place){-10, -20, -3, 0});
    iso_volume copied = read_ok(FOLDER, NULL); /* the writer gives all images one identifier */
    assert_true(test_has_note(&copied.info, "a copy of IM3 is left out"));
    iso_volume_free(&copied);
    for (int by = 0; by < 2; by++) { /* two acquisitions, the second named first: the first is taken */
        dicom_spec first = plain, second = plain;
        clear_folder();
        *(by ? &first.acquisition : &first.temporal) = "1";
        *(by ? &second.acquisition : &second.temporal) = "2";
        second.pixels = calloc(ROWS * COLUMNS, 2);
        write_series(&second, "A", 0);
        write_series(&first, "B", 0);
        iso_volume volume = read_ok(FOLDER, NULL);
        check_values(volume.grid.rgrid, SLICES);
        assert_true(test_has_note(&volume.info, "using number 1, 6 images of others"));
        iso_volume_free(&volume);
        free((void *)(uintptr_t)second.pixels);
    }
}

static void no_positions(void **state) {
    (void)state;
    dicom_spec spec = plain;
    spec.position = "";
    spec.between = "1.5";
    write_series(&spec, "IM", 0);
    iso_volume volume = read_ok(FOLDER, NULL);
    assert_true(test_has_note(&volume.info, "instance numbers"));
    assert_true(volume.info.transform.spacing[2] == 1.5);
    /* Instance numbers run against z here. */
    assert_true(iso_rgrid_at(volume.grid.rgrid, 1, 2, 0) == (float)value_at(1, 2, SLICES - 1));
    iso_volume_free(&volume);
    clear_folder();
    spec.instance = "";
    write_series(&spec, "IM", 0);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "cannot be ordered");
    clear_folder();
    spec.instance = NULL;
    write_series(&spec, "IM", 1U << 3);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "1 slice is missing");
}

/* ---- geometry ---- */

static void tilted_gantry(void **state) {
    (void)state;
    for (int z = 0; z < SLICES; z++) {
        char name[16];
        snprintf(name, sizeof name, "IM%d", 9 - z);
        write_slice(&plain, name, (slice_place){1, 2 + 0.3 * z, 5 + 0.4 * z, z});
    }
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    const double direction[9] = {1, 0, 0, 0, 1, 0.6, 0, 0, 0.8};
    check_transform(volume.grid.rgrid, (const double[3]){1, 2, 5}, (const double[3]){0.75, 0.5, 0.5},
                    direction);
    assert_true(test_has_note(&volume.info, "tilted gantry"));
    iso_volume_free(&volume);
    write_slice(&plain, "aside", (slice_place){4, 2 + 0.3 * SLICES, 5 + 0.4 * SLICES, 1});
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "not in line");
}

static void oblique_slices(void **state) {
    (void)state;
    dicom_spec spec = plain;
    spec.orientation = "0.6\\0\\-0.8\\0\\1\\0"; /* normal: 0.8 0 0.6 */
    for (int z = 0; z < SLICES; z++) {
        char name[16];
        snprintf(name, sizeof name, "IM%d", (z * 5 + 3) % SLICES);
        write_slice(&spec, name, (slice_place){1.6 * z, 7, 1.2 * z, z});
    }
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    const double direction[9] = {0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6};
    check_transform(volume.grid.rgrid, (const double[3]){0, 7, 0}, (const double[3]){0.75, 0.5, 2},
                    direction);
    iso_volume_free(&volume);
}

static void one_slice(void **state) {
    (void)state;
    write_slice(&plain, "only", (slice_place){1, 2, 3, 0});
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, 1);
    check_transform(volume.grid.rgrid, (const double[3]){1, 2, 3}, (const double[3]){0.75, 0.5, 5}, identity);
    iso_volume_free(&volume);
}

/* ---- pixels ---- */

static void rescales(void **state) {
    (void)state;
    dicom_spec spec = plain;
    spec.slope = "-0.5";
    write_series(&spec, "IM", 0);
    iso_volume volume = read_ok(FOLDER, NULL);
    assert_true(volume.grid.rgrid->type == ISO_FLOAT32);
    assert_true((double)iso_rgrid_at(volume.grid.rgrid, 3, 2, 1) == value_at(3, 2, 1) * -0.5 - 1024);
    assert_true(volume.grid.rgrid->scale == 1 && test_has_note(&volume.info, "negative"));
    iso_volume_free(&volume);
    clear_folder();
    write_series(&plain, "IM", 1U << 4);
    spec.slope = "0.25";
    write_slice(&spec, "another", (slice_place){-10, -20, -3 + 1.25 * 4, 4});
    volume = read_ok(FOLDER, NULL);
    assert_true(volume.grid.rgrid->type == ISO_FLOAT32 &&
                test_has_note(&volume.info, "rescales of their own"));
    assert_true((double)iso_rgrid_at(volume.grid.rgrid, 3, 2, 1) == value_at(3, 2, 1) * 2.0 - 1024);
    assert_true((double)iso_rgrid_at(volume.grid.rgrid, 3, 2, 4) == value_at(3, 2, 4) * 0.25 - 1024);
    iso_volume_free(&volume);
}

typedef struct depth_case {
    int allocated, stored, high, is_signed;
    uint32_t bits; /* of every pixel */
    double value;
    iso_type type;
} depth_case;

static void depths(void **state) {
    (void)state;
    static const depth_case cases[] = {
        {8, 8, 7, 0, 0xfe, 254, ISO_UINT8},          {8, 8, 7, 1, 0xfe, -2, ISO_INT16},
        {16, 12, 11, 0, 0xf123, 0x123, ISO_UINT16},  {16, 12, 11, 1, 0x0fff, -1, ISO_INT16},
        {16, 12, 15, 0, 0x1234, 0x123, ISO_UINT16},  {16, 12, 15, 1, 0xfff7, -1, ISO_INT16},
        {16, 16, 15, 0, 0xfffe, 65534, ISO_UINT16},  {8, 6, 5, 0, 0xc3, 3, ISO_UINT8},
        {32, 32, 31, 0, 70000, 70000, ISO_FLOAT32},  {32, 32, 31, 1, 0xfffffffe, -2, ISO_FLOAT32},
        {32, 20, 19, 1, 0xffffffff, -1, ISO_FLOAT32}};
    static const dicom_syntax syntaxes[] = {DICOM_EXPLICIT, DICOM_BIG};
    for (size_t i = 0; i < 2 * sizeof cases / sizeof *cases; i++) {
        const depth_case *c = &cases[i / 2];
        uint8_t pixels[ROWS * COLUMNS * 4];
        size_t each = (size_t)c->allocated / 8;
        for (size_t k = 0; k < ROWS * COLUMNS; k++) memcpy(pixels + k * each, &c->bits, each);
        dicom_spec spec = plain;
        spec.syntax = syntaxes[i % 2];
        spec.allocated = c->allocated;
        spec.stored = c->stored;
        spec.high = c->high;
        spec.is_signed = c->is_signed;
        spec.pixels = pixels;
        clear_folder();
        if (spec.syntax == DICOM_BIG && c->allocated == 8) continue; /* bytes in words: refused */
        write_series(&spec, "IM", 0);
        iso_volume volume = read_ok(FOLDER, NULL);
        assert_int_equal(volume.grid.rgrid->type, c->type);
        double got = (double)iso_rgrid_at(volume.grid.rgrid, 6, 4, 5);
        if (got != c->value) fail_msg("case %zu: %g, not %g", i, got, c->value);
        iso_volume_free(&volume);
    }
}

static void photometric(void **state) {
    (void)state;
    dicom_spec spec = plain;
    spec.photometric = "MONOCHROME1";
    write_series(&spec, "IM", 0);
    iso_volume volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, SLICES);
    assert_true(test_has_note(&volume.info, "MONOCHROME1"));
    iso_volume_free(&volume);
    clear_folder();
    uint8_t colours[ROWS * COLUMNS * 3] = {0};
    spec.photometric = "RGB";
    spec.samples = 3;
    spec.allocated = spec.stored = 8;
    spec.high = 7;
    spec.is_signed = 0;
    spec.pixels = colours;
    spec.series = "1.2.9";
    write_series(&spec, "rgb", 0);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, FOLDER, "colour images (RGB)");
    write_slice(&plain, "grey", (slice_place){0, 0, 0, 0}); /* one grey image beats six in colour */
    volume = read_ok(FOLDER, NULL);
    check_values(volume.grid.rgrid, 1);
    iso_volume_free(&volume);
}

/* ---- several frames in a file ---- */

static void multi_frame(void **state) {
    (void)state;
    char path[1024];
    int16_t pixels[SLICES * ROWS * COLUMNS];
    for (int z = 0; z < SLICES; z++) fill_slice(pixels + z * ROWS * COLUMNS, z);
    dicom_spec spec = plain;
    spec.frames = SLICES;
    spec.pixels = pixels;
    spec.position = "-10\\-20\\-3";
    spec.between = "1.25";
    in_folder(path, "frames");
    for (int packed = 0; packed < 3; packed++) {
        static const char *const ways[] = {NULL, "rle", "j2k"};
        dicom_write(path, &spec);
        if (ways[packed]) assert_int_equal(dicom_compress(path, ways[packed]), 0);
        iso_volume volume = read_ok(path, NULL);
        check_values(volume.grid.rgrid, SLICES);
        check_transform(volume.grid.rgrid, plain_origin, plain_spacing, identity);
        iso_volume_free(&volume);
    }
}

static void enhanced(void **state) {
    (void)state;
    /* Frames in the order 3 0 4 1 5 2. */
    static const int order[SLICES] = {3, 0, 4, 1, 5, 2};
    static const char *const positions[SLICES] = {"-10\\-20\\0.75",  "-10\\-20\\-3",   "-10\\-20\\2",
                                                  "-10\\-20\\-1.75", "-10\\-20\\3.25", "-10\\-20\\-0.5"};
    char path[1024];
    int16_t pixels[SLICES * ROWS * COLUMNS];
    for (int i = 0; i < SLICES; i++) fill_slice(pixels + i * ROWS * COLUMNS, order[i]);
    in_folder(path, "enhanced");
    for (int i = 0; i < 6; i++) {
        dicom_spec spec = plain;
        spec.frames = SLICES;
        spec.pixels = pixels;
        spec.frame_positions = positions;
        spec.delimited = i % 2;
        spec.syntax = (dicom_syntax)(i / 2);
        dicom_write(path, &spec);
        iso_volume volume = read_ok(path, NULL);
        check_values(volume.grid.rgrid, SLICES);
        check_transform(volume.grid.rgrid, plain_origin, plain_spacing, identity);
        assert_true(volume.grid.rgrid->scale == 2 && volume.grid.rgrid->offset == -1024);
        iso_volume_free(&volume);
        const char *gap[SLICES];
        memcpy(gap, positions, sizeof gap);
        gap[2] = "-10\\-20\\4.5";
        spec.frame_positions = gap;
        dicom_write(path, &spec);
        test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, FOLDER, "1 slice is missing");
        gap[2] = gap[1];
        dicom_write(path, &spec);
        test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, FOLDER,
                              "frames 2 and 3 of enhanced lie at the same place");
    }
}

/* ---- broken files ---- */

static void truncated(void **state) {
    (void)state;
    static const char *const ways[] = {NULL, "rle", "jpeg", "jpegls", "j2k"};
    char path[1024];
    in_folder(path, "cut.dcm");
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
        clear_folder();
        write_series(&plain, "IM", 1U << 5);
        write_slice(&plain, "cut.dcm",
                    (slice_place){-10, -20, -3 + 1.25 * 5, 5}); /* at an end of the stack */
        if (ways[way]) assert_int_equal(dicom_compress(path, ways[way]), 0);
        size_t count;
        uint8_t *whole = slurp(path, &count);
        /* What ends before its series is known is nobody's slice: it is left out, with a note. */
        const uint8_t series[14] = {0x20, 0, 0x0e, 0, 'U', 'I', 6, 0, '1', '.', '2', '.', '3', 0};
        const uint8_t *known = memmem(whole, count, series, sizeof series);
        for (size_t length = 0; length < count; length++) {
            spill(path, whole, length);
            iso_error error = {0};
            iso_volume volume = {0};
            iso_status status = iso_volume_read(FOLDER, NULL, &volume, &error);
            const bool left_out = length < (size_t)(known - whole) + sizeof series;
            if (left_out ? status != ISO_OK || !test_has_note(&volume.info, "cut.dcm: ")
                         : status != ISO_ERR_IO || !strstr(error.text, "cut.dcm"))
                fail_msg("%zu of %zu bytes: %s '%s'", length, count, iso_status_text(status), error.text);
            if (left_out) check_values(volume.grid.rgrid, SLICES - 1);
            iso_volume_free(&volume);
        }
        free(whole);
    }
}

/* Any status is right for a file with wrong bytes, a crash is not. */
static void corrupted(void **state) {
    (void)state;
    char path[1024];
    in_folder(path, "file.dcm");
    for (int syntax = 0; syntax < 3; syntax++) {
        static const char *const positions[2] = {"0\\0\\0", "0\\0\\1"};
        int16_t pixels[2 * ROWS * COLUMNS] = {0};
        dicom_spec spec = plain;
        spec.syntax = (dicom_syntax)syntax;
        spec.frames = 2;
        spec.frame_positions = positions;
        spec.pixels = pixels;
        spec.delimited = syntax == 1;
        dicom_write(path, &spec);
        test_read_damaged(path, 0, 4000, FOLDER);
    }
}

/* A codestream of another size than the header's: GDCM would end the program. */
static void wrong_codestream(void **state) {
    (void)state;
    static const char *const ways[] = {"rle", "jpeg", "jpegls", "j2k"};
    char path[1024];
    in_folder(path, "file.dcm");
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
        write_slice(&plain, "file.dcm", (slice_place){0, 0, 0, 0});
        assert_int_equal(dicom_compress(path, ways[way]), 0);
        size_t count;
        uint8_t *whole = slurp(path, &count);
        const uint8_t columns[10] = {0x28, 0, 0x11, 0, 'U', 'S', 2, 0, COLUMNS, 0};
        uint8_t *at = memmem(whole, count, columns, sizeof columns);
        assert_non_null(at);
        for (int wrong = 1; wrong < 64; wrong++) {
            at[8] = (uint8_t)wrong;
            spill(path, whole, count);
            iso_volume volume = {0};
            iso_error error = {0};
            iso_status status = iso_volume_read(path, NULL, &volume, &error);
            if (wrong == COLUMNS) assert_int_equal(status, ISO_OK);
            if (wrong != COLUMNS && way > 0 && status != ISO_ERR_IO) /* RLE does not state a size */
                fail_msg("%s with %d columns: %s", ways[way], wrong, iso_status_text(status));
            iso_volume_free(&volume);
        }
        free(whole);
    }
}

/* ---- real files ---- */

static int16_t *raw_slice(int number) {
    char path[512];
    snprintf(path, sizeof path, "%s/headsq_raw/quarter.%d", ISO_TEST_VOLUMES, number);
    size_t count;
    int16_t *values = slurp(path, &count);
    assert_int_equal(count, 64 * 64 * 2);
    return values;
}

/* The same head as raw little-endian slices, which begin at the other end. */
static void real_head(void **state) {
    (void)state;
    const char *path = ISO_TEST_VOLUMES "/dicom_cthead_slicer";
    if (access(path, R_OK) != 0) {
        print_message("%s is not there: skipped\n", path);
        skip();
    }
    iso_volume volume = read_ok(path, NULL);
    const iso_rgrid *grid = volume.grid.rgrid;
    assert_int_equal(grid->type, ISO_INT16);
    assert_int_equal(grid->dims[2], 93);
    check_transform(grid, (const double[3]){0, 0, 0}, (const double[3]){3.2, 3.2, 1.5}, identity);
    int lowest = INT16_MAX, highest = INT16_MIN;
    for (int z = 0; z < 93; z++) {
        int16_t *slice = raw_slice(93 - z);
        for (int i = 0; i < 64 * 64; i++) {
            int value = (int)iso_rgrid_at(grid, i % 64, i / 64, z);
            if (value != slice[i]) fail_msg("slice %d, pixel %d: %d, not %d", z, i, value, slice[i]);
            lowest = value < lowest ? value : lowest;
            highest = value > highest ? value : highest;
        }
        free(slice);
    }
    assert_int_equal(lowest, 0);
    assert_int_equal(highest, 3926);
    iso_volume_free(&volume);
    volume = read_ok(ISO_TEST_VOLUMES "/dicom_cthead_slicer/CTHead50.dcm", NULL);
    assert_int_equal(volume.info.dims[2], 93);
    iso_volume_free(&volume);
}

/* ---- numbers that cannot be ---- */

/* A series of which one element says `text`; no volume, and a line that says `words`. */
static void expect_refused(size_t element, const char *text, const char *words) {
    dicom_spec spec = plain;
    memcpy((char *)&spec + element, &text, sizeof text);
    clear_folder();
    write_series(&spec, "a", 0);
    test_expect_no_volume(FOLDER, NULL, ISO_ERR_FORMAT, NULL, words);
}

static void impossible_numbers(void **state) {
    (void)state;
    const size_t slope = offsetof(dicom_spec, slope), intercept = offsetof(dicom_spec, intercept);
    const size_t position = offsetof(dicom_spec, position), spacing = offsetof(dicom_spec, spacing);
    expect_refused(slope, "1e300", "rescale slope of '1e300'");
    expect_refused(slope, "-1e300", "rescale slope");
    expect_refused(slope, "abc", "rescale slope of 'abc'");
    expect_refused(slope, "nan", "rescale slope");
    expect_refused(slope, "1e-300", "cannot be scaled");
    expect_refused(intercept, "1e300", "rescale intercept");
    expect_refused(intercept, "1e25", "cannot be told apart");
    expect_refused(position, "0\\0\\1e300", "a position of");
    expect_refused(position, "0\\1e13\\0", "a position of 1e+13");
    expect_refused(spacing, "1e300\\1e300", "from the origin");
    dicom_spec spec = plain;
    spec.spacing = "-1\\-1"; /* was "0 voxels on axis 2": no image fitted itself */
    clear_folder();
    write_series(&spec, "a", 0);
    iso_volume volume = read_ok(FOLDER, NULL);
    assert_true(test_has_note(&volume.info, "pixel spacing is missing or not positive"));
    iso_volume_free(&volume);
}

/* NumberOfFrames that is 0, or no number: none of the frames is taken. */
static void impossible_frame_counts(void **state) {
    (void)state;
    char path[1024];
    dicom_spec spec = plain;
    int16_t pixels[2 * ROWS * COLUMNS] = {0};
    spec.frames = 2;
    spec.pixels = pixels;
    in_folder(path, "frames.dcm");
    dicom_write(path, &spec);
    size_t count;
    char *whole = slurp(path, &count), *place = memmem(whole, count, "\x28\0\x08\0IS\2\0", 8);
    assert_non_null(place);
    const char *const texts[] = {"0 ", "-1", "x ", "1e"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        memcpy(place + 8, texts[i], 2);
        spill(path, whole, count);
        test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, NULL, "number of frames");
    }
    free(whole);
}

#define TEST(name) cmocka_unit_test_setup(name, empty_folder)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(series_comes_back),
        TEST(strays_are_ignored),
        TEST(folders_without_images),
        TEST(storage),
        TEST(compressed),
        TEST(without_gdcm),
        TEST(several_series),
        TEST(scout_in_the_series),
        TEST(missing_slices),
        TEST(uneven_steps),
        TEST(doubled_slices),
        TEST(no_positions),
        TEST(tilted_gantry),
        TEST(oblique_slices),
        TEST(one_slice),
        TEST(rescales),
        TEST(depths),
        TEST(photometric),
        TEST(multi_frame),
        TEST(enhanced),
        TEST(truncated),
        TEST(corrupted),
        TEST(wrong_codestream),
        TEST(impossible_numbers),
        TEST(impossible_frame_counts),
        TEST(real_head),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    clear_folder();
    rmdir(FOLDER);
    return failed;
}
