/* Modules are loaded when a file needs them, by any thread; a missing one is reported in one line. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "grids/volume/module.h"
#include "grids/volume/volume.h"
#include "make_volumes.h"

static const char folder[] = ISO_TEST_TMP "/module";

/* The modules of this build, and a name that only their libraries have. */
static const struct {
    const char *name, *library, *mark;
    bool built;
} modules[] = {{"vti", "VTK", "libvtkCommonCore", ISO_TEST_HAS_VTI},
               {"vdb", "OpenVDB", "libopenvdb", ISO_TEST_HAS_VDB},
               {"dicom", "GDCM", "libgdcmMSFF", ISO_TEST_HAS_DICOM}};
enum { MODULES = sizeof modules / sizeof *modules };

/* Only modules in `where`, or again where they belong (NULL). */
static void look_in(const char *where) {
    if (where)
        setenv("ISO_MODULE_PATH", where, 1);
    else
        unsetenv("ISO_MODULE_PATH");
}

static bool is_mapped(const char *mark) {
    FILE *file = fopen("/proc/self/maps", "r");
    assert_non_null(file);
    char line[1024];
    bool found = false;
    while (fgets(line, sizeof line, file)) found = found || strstr(line, mark);
    fclose(file);
    return found;
}

static void check_text(const iso_error *error, const char *path, const char *const *parts) {
    if (strncmp(error->text, path, strlen(path)) != 0 || strchr(error->text, '\n'))
        fail_msg("'%s' is not one line that begins with %s", error->text, path);
    for (; *parts; parts++)
        if (!strstr(error->text, *parts)) fail_msg("'%s' lacks '%s'", error->text, *parts);
}

/* What is not needed is not there; the other tests come after this one. */
static void nothing_before_it_is_needed(void **state) {
    (void)state;
    vol_write_text(vol_path(folder, "small.mha", 0), "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
                                                     "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
                                                     "01234567");
    iso_volume volume;
    assert_int_equal(iso_volume_read(vol_path(folder, "small.mha", 0), NULL, &volume, NULL), ISO_OK);
    iso_volume_free(&volume);
    for (int i = 0; i < MODULES; i++) assert_false(is_mapped(modules[i].mark));
}

enum { THREADS = 8 };

typedef struct loader {
    pthread_barrier_t *start;
    const iso_module *found[MODULES];
} loader;

static void *load_all(void *context) {
    loader *self = context;
    pthread_barrier_wait(self->start);
    for (int i = 0; i < MODULES; i++)
        if (modules[i].built)
            iso_module_load("some.file", modules[i].name, modules[i].library, &self->found[i], NULL);
    return NULL;
}

static void threads_load_the_same(void **state) {
    (void)state;
    pthread_barrier_t start;
    pthread_t threads[THREADS];
    loader loaders[THREADS] = {0};
    assert_int_equal(pthread_barrier_init(&start, NULL, THREADS), 0);
    for (int i = 0; i < THREADS; i++) {
        loaders[i].start = &start;
        assert_int_equal(pthread_create(&threads[i], NULL, load_all, &loaders[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) pthread_join(threads[i], NULL);
    pthread_barrier_destroy(&start);
    for (int m = 0; m < MODULES; m++) {
        if (!modules[m].built) continue;
        assert_non_null(loaders[0].found[m]);
        for (int i = 1; i < THREADS; i++) assert_ptr_equal(loaders[i].found[m], loaders[0].found[m]);
        assert_true(is_mapped(modules[m].mark));
    }
}

static void tables_are_right(void **state) {
    (void)state;
    for (int i = 0; i < MODULES; i++) {
        const iso_module *module = NULL;
        iso_error error = {0};
        if (!modules[i].built) continue;
        iso_status status =
            iso_module_load("some.file", modules[i].name, modules[i].library, &module, &error);
        if (status != ISO_OK) fail_msg("%s", error.text);
        if (strcmp(modules[i].name, "dicom") == 0) {
            assert_non_null(module->dicom_decode);
            continue;
        }
        assert_string_equal(module->format->name, modules[i].name);
        assert_true(module->format->info && module->format->read);
    }
}

static void missing_modules_are_named(void **state) {
    (void)state;
    const char *path = vol_path(folder, "some.vti", 0);
    vol_write_text(path, "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\"></VTKFile>\n");
    look_in(folder);
    iso_volume volume = {0};
    iso_error error = {0};
    assert_int_equal(iso_volume_read(path, NULL, &volume, &error), ISO_ERR_UNSUPPORTED);
    assert_int_equal(iso_status_exit(ISO_ERR_UNSUPPORTED), 3);
    check_text(&error, path,
               (const char *const[]){"the VTK reader (libisopoint-vti.so) is not installed", folder, NULL});
    path = vol_path(folder, "some.vdb", 1);
    vol_write_bytes(path, " BDV\0\0\0\0", 8);
    iso_volume_info info;
    assert_int_equal(iso_volume_read_info(path, NULL, &info, &error), ISO_ERR_UNSUPPORTED);
    check_text(&error, path, (const char *const[]){"OpenVDB", "libisopoint-vdb.so", "not installed", NULL});
    look_in(NULL);
}

/* A relative folder would be one of the working directory. */
static void relative_folders_are_refused(void **state) {
    (void)state;
    const iso_module *module = NULL;
    iso_error error = {0};
    look_in("module");
    assert_int_equal(iso_module_load("x.file", "text", "Some", &module, &error), ISO_ERR_UNSUPPORTED);
    check_text(&error, "x.file: the Some reader",
               (const char *const[]){"ISO_MODULE_PATH='module'", "must begin with '/'", NULL});
    look_in(NULL);
}

/* Files that are called like modules and are none, and modules that cannot be used. */
static void broken_modules_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *where, *name, *words;
    } cases[] = {
        {folder, "text", "cannot be loaded"},
        {ISO_TEST_BROKEN_MODULES, "orphan", "libisopoint-test-gone.so: cannot open shared object file"},
        {ISO_TEST_BROKEN_MODULES, "empty", "belongs to another version"},
        {ISO_TEST_BROKEN_MODULES, "other_abi", "belongs to another version"},
        {ISO_TEST_BROKEN_MODULES, "other_version", "belongs to another version"},
    };
    vol_write_text(vol_path(folder, "libisopoint-text.so", 0), "This is no shared object.\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const iso_module *module = NULL;
        iso_error error = {0};
        look_in(cases[i].where);
        assert_int_equal(iso_module_load("x.file", cases[i].name, "Some", &module, &error),
                         ISO_ERR_UNSUPPORTED);
        check_text(&error, "x.file: the Some reader", (const char *const[]){cases[i].words, NULL});
        assert_null(module);
    }
    look_in(NULL);
}

int main(void) {
    mkdir(folder, 0777);
    look_in(NULL);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_before_it_is_needed),
        cmocka_unit_test(threads_load_the_same),
        cmocka_unit_test(tables_are_right),
        cmocka_unit_test(missing_modules_are_named),
        cmocka_unit_test(relative_folders_are_refused),
        cmocka_unit_test(broken_modules_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
