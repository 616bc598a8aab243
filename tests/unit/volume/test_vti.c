/* The .vti reader with files that VTK's writer wrote, compared with VTK's reader: values that lie in the file
 * as they are (raw appended data) are read and mapped by our own code, from the place that VTK's header
 * gives. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "check_support.h"
#include "file_support.h"
#include "grids/volume/mapping.h"
#include "volume_support.h"
#include "vti_files.h"

#define FILE_PATH ISO_TEST_TMP "/test_vti.vti"
#define CUT_PATH ISO_TEST_TMP "/test_vti_cut.vti"

static vti_spec spec_of(const char *type, int flags) {
    return (vti_spec){.type = type,
                      .names = {"first", "second"},
                      .components = 1,
                      .extent = {0, 12, 0, 8, 0, 6},
                      .spacing = {1, 1, 1},
                      .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                      .flags = flags};
}

/* An extent that does not begin at 0, and a direction that turns the axes. */
static void turn(vti_spec *spec) {
    static const int extent[6] = {-3, 11, 5, 13, 7, 12};
    static const double origin[3] = {10.5, -20, 3}, spacing[3] = {0.5, 1.25, 2};
    static const double direction[9] = {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, -1};
    memcpy(spec->extent, extent, sizeof extent);
    memcpy(spec->origin, origin, sizeof origin);
    memcpy(spec->spacing, spacing, sizeof spacing);
    memcpy(spec->direction, direction, sizeof direction);
}

/* The position in the file of the first array's values. */
static size_t position_of_values(const vti_spec *spec) {
    size_t count;
    char *bytes = slurp(FILE_PATH, &count);
    const char *data = memmem(bytes, count, "<AppendedData", 13);
    assert_non_null(data);
    data = memchr(data, '_', count - (size_t)(data - bytes));
    const size_t position = (size_t)(data - bytes) + 1 + (spec->flags & VTI_HEADER_64 ? 8 : 4);
    free(bytes);
    return position;
}

static void check_same(const iso_volume *volume, const vti_image *wanted) {
    const iso_rgrid *grid = volume->grid.rgrid;
    const iso_transform *t = &grid->transform;
    for (int axis = 0; axis < 3; axis++) {
        assert_int_equal(grid->dims[axis], wanted->dims[axis]);
        assert_float_equal(t->origin[axis], wanted->origin[axis], 1e-12);
        for (int i = 0; i < 3; i++)
            assert_float_equal(t->direction[3 * i + axis] * t->spacing[axis], wanted->steps[axis][i], 1e-12);
    }
    const double *values = wanted->values;
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++)
                if (iso_rgrid_at(grid, x, y, z) != (float)*values++) fail_msg("voxel %d %d %d", x, y, z);
}

/* Reads the file whole and mapped, and compares with VTK's reader. Returns the offset of the mapped voxels in
 * a page of memory. */
static size_t check_file(const char *name, int component, bool mappable) {
    vti_image wanted = {.values = NULL};
    size_t place = 0;
    assert_int_equal(vti_read(FILE_PATH, name, component, &wanted), 0);
    for (int mapped = 0; mapped < 2; mapped++) {
        bool can = !mappable;
        const iso_volume_opts opts = {
            .grid = name, .component = component, .mapped = mapped, .mappable = &can};
        iso_volume volume = test_read_volume(FILE_PATH, &opts);
        assert_int_equal(can, mappable);
        assert_int_equal(volume.grid.rgrid->release == iso_mapping_destroy, mapped && mappable);
        if (mapped) place = (size_t)volume.grid.rgrid->data % (size_t)sysconf(_SC_PAGESIZE);
        check_same(&volume, &wanted);
        iso_volume_free(&volume);
    }
    free(wanted.values);
    return place;
}

static const char *const types[] = {"uint8", "int16", "uint16", "float"};
static const size_t sizes[] = {1, 2, 2, 4};

/* Values are mapped where they lie if they are aligned: names of different lengths move them. */
static void raw_values_are_mapped(void **state) {
    (void)state;
    size_t in_place = 0, unpacked = 0;
    for (int t = 0; t < 4; t++)
        for (int way = 0; way < 8; way++)
            for (int pad = 0; pad < 4; pad++) {
                vti_spec spec = spec_of(types[t], VTI_RAW | (way & 1 ? VTI_HEADER_64 : 0));
                const char *const names[] = {"a", "ab", "abc", "abcd"};
                spec.names[0] = names[pad];
                if (way & 2) turn(&spec);
                if (way & 4) spec.names[1] = NULL;
                assert_int_equal(vti_write(FILE_PATH, &spec), 0);
                const size_t position = position_of_values(&spec);
                const bool aligned = position % sizes[t] == 0;
                assert_int_equal(check_file(NULL, 0, true),
                                 aligned ? position % (size_t)sysconf(_SC_PAGESIZE) : 0);
                *(aligned ? &in_place : &unpacked) += 1;
            }
    assert_true(in_place > 48 && unpacked > 24);
}

/* The active scalars, else the first array, or the one that was asked for. */
static void array_is_the_one_of_vtk(void **state) {
    (void)state;
    const int flags[] = {0, VTI_SECOND_ACTIVE, VTI_NONE_ACTIVE};
    const char *const names[] = {NULL, "first", "second"};
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
            vti_spec spec = spec_of("uint16", VTI_RAW | flags[i]);
            turn(&spec);
            assert_int_equal(vti_write(FILE_PATH, &spec), 0);
            check_file(names[n], 0, true);
        }
}

/* What cannot be used where it lies is unpacked when it is mapped, and is converted when it is read. */
static void other_raw_values_are_converted(void **state) {
    (void)state;
    static const char *const more[] = {"uint8", "int8", "int16", "uint16", "float", "double"};
    for (size_t t = 0; t < sizeof more / sizeof *more; t++)
        for (int way = 0; way < 8; way++) {
            vti_spec spec = spec_of(more[t], VTI_RAW | VTI_HEADER_64 | (way & 1 ? VTI_BIG_ENDIAN : 0) |
                                                 (way & 2 ? VTI_CELL_DATA : 0));
            if (way & 4) spec.components = 3;
            turn(&spec);
            assert_int_equal(vti_write(FILE_PATH, &spec), 0);
            check_file(NULL, way & 4 ? 1 : 0, true);
        }
}

static void packed_values_are_read_whole(void **state) {
    (void)state;
    const int flags[] = {0, VTI_COMPRESSED, VTI_RAW | VTI_COMPRESSED, VTI_RAW | VTI_TWO_PIECES};
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        vti_spec spec = spec_of("int16", flags[i]);
        turn(&spec);
        assert_int_equal(vti_write(FILE_PATH, &spec), 0);
        check_file(NULL, 0, false);
    }
}

/* ---- damage ---- */

static void expect_refused(const char *words) {
    for (int mapped = 0; mapped < 2; mapped++) {
        const iso_volume_opts opts = {.mapped = mapped, .max_memory = 1 << 26};
        test_expect_no_volume(CUT_PATH, &opts, ISO_ERR_IO, NULL, words);
    }
}

/* Ends the file at any place. */
static void truncated_files_are_refused(void **state) {
    (void)state;
    const vti_spec spec = spec_of("int16", VTI_RAW);
    assert_int_equal(vti_write(FILE_PATH, &spec), 0);
    size_t count;
    char *bytes = slurp(FILE_PATH, &count);
    const size_t position = position_of_values(&spec);
    for (size_t end = position - 4; end < count - 12; end += 97) {
        spill(CUT_PATH, bytes, end);
        expect_refused("truncated");
    }
    /* voxels are missing before an end that is complete */
    static const char tail[] = "</AppendedData></VTKFile>";
    for (size_t end = position - 3; end < position + 2 * 13 * 9 * 7 - sizeof tail; end += 61) {
        char *cut = malloc(end + sizeof tail);
        memcpy(cut, bytes, end);
        memcpy(cut + end, tail, sizeof tail);
        spill(CUT_PATH, cut, end + sizeof tail - 1);
        expect_refused("truncated");
        free(cut);
    }
    free(bytes);
}

static void lying_numbers_are_refused(void **state) {
    (void)state;
    vti_spec spec = spec_of("float", VTI_RAW | VTI_HEADER_64);
    spec.names[1] = NULL;
    assert_int_equal(vti_write(FILE_PATH, &spec), 0);
    size_t count;
    char *bytes = slurp(FILE_PATH, &count);
    const size_t position = position_of_values(&spec);
    static const uint64_t lengths[] = {0, 1, 4 * 13 * 9 * 7 - 1, 1 << 20, UINT64_MAX};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        uint64_t old;
        memcpy(&old, bytes + position - 8, sizeof old);
        memcpy(bytes + position - 8, &lengths[i], sizeof old);
        spill(CUT_PATH, bytes, count);
        expect_refused("truncated");
        memcpy(bytes + position - 8, &old, sizeof old);
    }
    char *offset = memmem(bytes, count, "offset=\"0\"", 10);
    assert_non_null(offset);
    const size_t before = (size_t)(offset - bytes) + 8;
    static const char *const offsets[] = {"1", "400", "99999999", "9223372036854775807"};
    for (size_t i = 0; i < sizeof offsets / sizeof *offsets; i++) {
        const size_t length = strlen(offsets[i]);
        char *changed = malloc(count + length);
        memcpy(changed, bytes, before);
        memcpy(changed + before, offsets[i], length);
        memcpy(changed + before + length, bytes + before + 1, count - before - 1);
        spill(CUT_PATH, changed, count + length - 1);
        expect_refused("truncated");
        free(changed);
    }
    free(bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(raw_values_are_mapped),          cmocka_unit_test(array_is_the_one_of_vtk),
        cmocka_unit_test(other_raw_values_are_converted), cmocka_unit_test(packed_values_are_read_whole),
        cmocka_unit_test(truncated_files_are_refused),    cmocka_unit_test(lying_numbers_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
