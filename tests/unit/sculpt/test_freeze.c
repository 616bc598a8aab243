/* Freezing what a volume has: voxels against the volume's own, journals and other voxel sizes, runs of bits,
 * and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "check_support.h"
#include "grids/rgrid.h"
#include "session_support.h"
#include "source/strokes.h"

enum { SIDE = 40 };

/* A volume around the session's ball, of voxels of another size, turned and moved, whose values rise along x
 * and y; or (labels) 0, 1, 2 in thirds along x. */
static iso_grid make_volume(bool labels) {
    iso_transform transform = iso_transform_identity();
    iso_grid grid = {.hgrid = NULL};
    for (int axis = 0; axis < 3; axis++) {
        transform.spacing[axis] = 0.7;
        transform.origin[axis] = axis == 1 ? 14 : -14;
    }
    for (int i = 0; i < 9; i++) transform.direction[i] = 0;
    transform.direction[1] = transform.direction[8] = 1; /* x of the volume is y of the world, and */
    transform.direction[3] = -1;                         /* its y is -x of the world, or so */
    const iso_rgrid_desc desc = {.dims = {SIDE, SIDE, SIDE}, .type = ISO_FLOAT32, .transform = &transform};
    assert_int_equal(iso_rgrid_create(&desc, &grid.rgrid, NULL), ISO_OK);
    float *values = grid.rgrid->data;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int x = i % SIDE, y = i / SIDE % SIDE;
        values[i] = labels ? (float)(3 * x / SIDE) : (float)(x + 2 * y);
    }
    return grid;
}

/* What a voxel of the session is in the volume; false: beyond it. */
static bool find_index(const iso_session *session, const iso_grid *volume, const int at[3], iso_vec3 *index) {
    const iso_affine to = iso_transform_affine(&iso_session_grid((iso_session *)session)->transform),
                     from = iso_transform_affine(iso_grid_transform(volume));
    *index = iso_affine_point_to_index(&from, iso_affine_point(&to, iso_vec3_make(at[0], at[1], at[2])));
    const double p[] = {index->x, index->y, index->z};
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] < -0.5 || p[axis] > SIDE - 0.5) return false;
    return true;
}

typedef bool wanted_fn(const iso_grid *volume, iso_vec3 index);

static bool is_above(const iso_grid *volume, iso_vec3 index) {
    return iso_grid_sample(volume, index) >= 61.3;
}

static bool is_other_label(const iso_grid *volume, iso_vec3 p) {
    const float label =
        iso_grid_at(volume, (int)floor(p.x + 0.5), (int)floor(p.y + 0.5), (int)floor(p.z + 0.5));
    return label != 0 && label != 2;
}

static void check_frozen(const iso_session *session, const iso_grid *volume, wanted_fn *wanted) {
    const int *dims = iso_session_grid((iso_session *)session)->dims;
    int frozen = 0, at[3];
    for (at[2] = 0; at[2] < dims[2]; at[2]++)
        for (at[1] = 0; at[1] < dims[1]; at[1]++)
            for (at[0] = 0; at[0] < dims[0]; at[0]++) {
                iso_vec3 index;
                const bool is = iso_session_masked(session, at[0], at[1], at[2]);
                if (is != (find_index(session, volume, at, &index) && wanted(volume, index)))
                    fail_msg("%d %d %d: %s", at[0], at[1], at[2], is ? "frozen" : "free");
                frozen += is;
            }
    assert_in_range(frozen, 10000, 200000);
}

static bool is_frozen_in(const session_field *field, const int at[3]) {
    const int *dims = field->grid->dims;
    if (at[0] >= dims[0] || at[1] >= dims[1] || at[2] >= dims[2]) return false;
    const size_t cell =
        iso_hgrid_cell_index(field->grid, at[0] / ISO_BRICK, at[1] / ISO_BRICK, at[2] / ISO_BRICK);
    const iso_voxel_bits *bits = iso_mask_bits(&field->items.of[ISO_ITEM_MASK], cell);
    return bits && bits->row[at[2] % ISO_BRICK * ISO_BRICK + at[1] % ISO_BRICK] >> at[0] % ISO_BRICK & 1;
}

static void solids_are_frozen(void **state) {
    (void)state;
    const char *path = session_path("frozen.strokes");
    const iso_session_opts opts = {.journal = path};
    iso_grid volume = make_volume(false);
    session_remove_files(path);
    iso_session *session = session_open(&opts);
    iso_error error = {0};
    if (iso_source_freeze(session, &volume, 61.3, NULL, &error) != ISO_OK) fail_msg("%s", error.text);
    check_frozen(session, &volume, is_above);
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_false(iso_session_has_mask(session));
    assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
    const iso_vec3 place = {10, 0, 0};
    session_stroke(session, &(iso_brush){.tool = ISO_TOOL_INFLATE, .radius = 8}, &place, 1);
    const session_field drawn = session_field_of(session);
    iso_session_destroy(session);
    /* the journal needs no volume */
    iso_strokes strokes;
    if (iso_strokes_open(path, &(iso_source){.voxel = 0}, &strokes, &error) != ISO_OK)
        fail_msg("%s", error.text);
    if (iso_strokes_finish(&strokes, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_true(session_is(strokes.session, &drawn));
    check_frozen(strokes.session, &volume, is_above);
    iso_strokes_close(&strokes);
    /* in finer voxels the same places are frozen, to the coarser ones' size */
    if (iso_strokes_open(path, &(iso_source){.voxel = 0.25}, &strokes, &error) != ISO_OK)
        fail_msg("%s", error.text);
    if (iso_strokes_finish(&strokes, &error) != ISO_OK) fail_msg("%s", error.text);
    const iso_hgrid *fine = iso_session_grid(strokes.session);
    for (int i = 0; i < 2000; i++) {
        uint32_t seed = (uint32_t)i;
        const int at[] = {(int)(uniform(&seed) * fine->dims[0]), (int)(uniform(&seed) * fine->dims[1]),
                          (int)(uniform(&seed) * fine->dims[2])};
        const int coarse[] = {(at[0] + 1) / 2, (at[1] + 1) / 2,
                              (at[2] + 1) / 2}; /* (halves are rounded up) */
        assert_int_equal(iso_session_masked(strokes.session, at[0], at[1], at[2]),
                         is_frozen_in(&drawn, coarse));
    }
    iso_strokes_close(&strokes);
    session_field_free((session_field *)&drawn);
    session_remove_files(path);
    iso_grid_destroy(&volume);
}

static void labels_are_frozen(void **state) {
    (void)state;
    iso_grid volume = make_volume(true);
    iso_session *session = session_open(&(iso_session_opts){0});
    assert_int_equal(iso_source_freeze_labels(session, &volume, 2, NULL, NULL), ISO_OK);
    check_frozen(session, &volume, is_other_label);
    iso_session_destroy(session);
    iso_grid_destroy(&volume);
}

static void nothing_is_refused(void **state) {
    (void)state;
    iso_grid volume = make_volume(false);
    iso_session *session = session_open(&(iso_session_opts){0});
    assert_int_equal(iso_source_freeze(session, &volume, 1e6, NULL, NULL), ISO_ERR_EMPTY);
    assert_int_equal(iso_source_freeze(session, &volume, NAN, NULL, NULL), ISO_ERR_USAGE);
    const iso_brush brush = {.tool = ISO_TOOL_MASK_VOXELS, .radius = 1};
    const iso_sample sample = {.normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL),
                     ISO_ERR_USAGE); /* of which volume? */
    assert_int_equal(iso_session_begin(session, &(iso_brush){.radius = 3}, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_source_freeze(session, &volume, 61.3, NULL, NULL), ISO_ERR_USAGE);
    iso_session_destroy(session);
    iso_grid_destroy(&volume);
}

/* Runs of all lengths come back; bytes that are none are refused. */
static void runs_are_read_back(void **state) {
    (void)state;
    uint32_t seed = 8;
    for (int round = 0; round < 60; round++) {
        iso_voxel_set set = {.dims = {1 + round % 37, 1 + round * 7 % 90, 1 + round % 5}}, read = set;
        assert_int_equal(iso_voxel_set_init(&set, NULL), ISO_OK);
        assert_int_equal(iso_voxel_set_init(&read, NULL), ISO_OK);
        const size_t count = iso_voxel_set_count(&set);
        bool in = round % 2;
        for (size_t i = 0; i < count; in = !in) {
            const size_t run = (size_t)(uniform(&seed) * uniform(&seed) * (round < 30 ? 500 : 4));
            for (size_t k = 0; k < run && i < count; k++, i++)
                if (in) set.word[i / 64] |= (uint64_t)1 << i % 64;
        }
        size_t size;
        uint8_t *bytes = iso_voxel_set_pack(&set, &size);
        assert_non_null(bytes);
        assert_true(iso_voxel_set_unpack(bytes, size, &read));
        assert_memory_equal(set.word, read.word, (count + 63) / 64 * sizeof *set.word);
        assert_false(iso_voxel_set_unpack(bytes, size - 1, &read));
        bytes[size - 1]++;
        assert_false(iso_voxel_set_unpack(bytes, size, &read));
        free(bytes);
        iso_voxel_set_free(&set);
        iso_voxel_set_free(&read);
    }
    iso_voxel_set huge = {.dims = {2048, 2048, 2048}};
    assert_int_equal(iso_voxel_set_init(&huge, NULL), ISO_ERR_LIMIT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solids_are_frozen), cmocka_unit_test(labels_are_frozen),
        cmocka_unit_test(nothing_is_refused), cmocka_unit_test(runs_are_read_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
