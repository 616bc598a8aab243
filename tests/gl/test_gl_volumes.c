/* The gl engine against the cpu engine, on the real volumes, from six sides. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gl_support.h"
#include "grids/volume/volume.h"

enum { SIDE = 256 };

/* What is drawn. */
typedef enum drawn { PRIMITIVES, GAUSSIAN, DISCS } drawn;

/* Of each volume one file; isovalues as INDEX.tsv has them. */
static const struct {
    const char *path, *raw;
    double isovalue;
} volumes[] = {
    {"hydrogenatom/hydrogenatom.raw", "128x128x128:uint8", 20},
    {"tooth_seg3d/tooth.nhdr", NULL, 750},
    {"stent/stent.nrrd", NULL, 600},
    {"brainsmall_den/brainsmall.den", "128x128x84:uint8::62", 40},
    {"headsq_raw/quarter.nhdr", NULL, 1150},
    {"ironprot/ironProt.vtk", NULL, 128},
    {"vase/vase_1comp.vti", NULL, 120},
    {"headmr/HeadMRVolume.mhd", NULL, 40},
    {"nrrd_FLAIR/FLAIR.nrrd", NULL, 60},
    {"mricron/ch2better.nii.gz", NULL, 60},
    {"vdb_sphere/sphere.vdb", NULL, 0},
    {"vdb_usd_smoke/smoke_000003.vdb", NULL, 0.3},
    {"vdb_usd_smoke/densityAndHeat.vdb", NULL, 0.3},
};

static bool read_volume(size_t i, iso_volume *volume) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", ISO_TEST_VOLUMES, volumes[i].path);
    iso_raw_layout layout;
    iso_volume_opts opts = {.max_memory = 0};
    if (volumes[i].raw) {
        assert_int_equal(iso_raw_layout_parse(volumes[i].raw, &layout, NULL), ISO_OK);
        opts.raw = &layout;
    }
    iso_error error = {ISO_OK, ""};
    if (iso_volume_read(path, &opts, volume, &error) == ISO_OK) return true;
    printf("not tested: %s\n", error.text);
    return false;
}

static void check_points(iso_gl_engine *engine, const gl_surface *s, const iso_view *views,
                         const char *name) {
    const iso_point_view points = iso_point_set_view(s->packed);
    const iso_mesh_view mesh = iso_mesh_set_view(s->mesh);
    printf(" points %.1f dB, mesh %.1f dB\n", gl_check_points(engine, &points, views, GL_SIDES, name),
           gl_check_mesh(engine, &mesh, views, GL_SIDES, name));
}

static void check_pullpush(iso_gl_engine *engine, iso_point_set *set, iso_reconstruction reconstruction,
                           const iso_view *views, const char *name) {
    assert_int_equal(iso_point_set_bound(set, NULL), ISO_OK);
    const iso_point_view points = iso_point_set_view(set);
    printf(" %.1f dB\n", gl_check_pullpush(engine, &points, reconstruction, views, GL_SIDES, name));
}

static void check_volume(size_t i, const iso_volume *volume, const gl_contexts *contexts, drawn what) {
    const char *name = volumes[i].path;
    gl_surface s = gl_surface_make(&volume->grid, volumes[i].isovalue);
    iso_point_set *discs = what == DISCS ? gl_discs_make(&volume->grid, volumes[i].isovalue, false) : NULL;
    iso_view views[GL_SIDES];
    for (int side = 0; side < GL_SIDES; side++)
        views[side] = gl_side_view(&s.box, side, side % 2, SIDE, SIDE);
    for (int c = 0; c < contexts->count; c++) {
        iso_gl_engine *engine;
        assert_int_equal(iso_gl_engine_create(contexts->context[c], &engine, NULL), ISO_OK);
        printf("%s, %s:", iso_gl_context_info(contexts->context[c]).name, name);
        if (what == DISCS)
            check_pullpush(engine, discs, ISO_RECONSTRUCTION_CURVED, views, name);
        else if (what == GAUSSIAN)
            check_pullpush(engine, s.packed, ISO_RECONSTRUCTION_GAUSSIAN, views, name);
        else
            check_points(engine, &s, views, name);
        iso_gl_engine_destroy(engine);
    }
    iso_point_set_destroy(discs);
    gl_surface_free(&s);
}

static void pictures_are_the_cpu_engines(void **state) {
    const drawn *what = *state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    int seen = 0;
    for (size_t i = 0; i < sizeof volumes / sizeof *volumes; i++) {
        iso_volume volume;
        if (!read_volume(i, &volume)) continue;
        check_volume(i, &volume, &contexts, *what);
        iso_volume_free(&volume);
        seen++;
    }
    gl_contexts_close(&contexts);
    if (!seen) skip();
}

/* Points and meshes; with an argument pull-push: `gaussian`, or `discs`. */
int main(int argc, char **argv) {
    drawn what = PRIMITIVES;
    if (argc > 1) what = strcmp(argv[1], "discs") == 0 ? DISCS : GAUSSIAN;
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(pictures_are_the_cpu_engines, &what)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
