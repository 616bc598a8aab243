/* Instances of surfaces through the public interface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lent_ball.h"

enum { WIDTH = 96, HEIGHT = 64 };

/* One placement at the origin changes nothing, whatever draws the discs. */
static void a_placement_at_the_origin(void **state) {
    (void)state;
    static const iso_method methods[] = {ISO_METHOD_DISCS, ISO_METHOD_SPLATS_FLAT, ISO_METHOD_SPLATS_ONEPASS,
                                         ISO_METHOD_SPLATS_EWA, ISO_METHOD_SPLATS_MEAN};
    iso_placement here = {.scale = 0}; /* all 0 */
    const iso_placements one = {.items = &here, .count = 1};
    iso_volume *volume = lend_ball(1);
    iso_surface *surface = NULL;
    iso_image plain = {0}, placed = {0};
    assert_int_equal(iso_surface_create(volume, NULL, &surface, NULL), ISO_OK);
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        iso_instance_counts counts = {0};
        iso_render_opts opts = {.method = methods[m], .width = WIDTH, .height = HEIGHT, .samples = 4};
        assert_int_equal(iso_render(surface, &opts, &plain, NULL), ISO_OK);
        opts.instances = &one;
        opts.instance_counts = &counts;
        assert_int_equal(iso_render(surface, &opts, &placed, NULL), ISO_OK);
        assert_memory_equal(plain.rgba, placed.rgba, bytes_of(&plain));
        assert_true(counts.drawn == 1 && counts.points > 500 && !counts.hidden && !counts.outside);
    }
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
    iso_image_free(&plain);
    iso_image_free(&placed);
}

/* Many placements in a row: what is hidden is counted; colours, threads and levels of detail. */
static void a_row_of_placements(void **state) {
    (void)state;
    enum { COUNT = 40 };
    static iso_placement items[COUNT];
    static iso_rgb colors[COUNT];
    iso_placements row = {.items = items, .colors = colors, .count = COUNT};
    iso_image first = {0}, second = {0};
    for (int i = 0; i < COUNT; i++) {
        items[i] = (iso_placement){.position = {0, 20 * i, 0}, .scale = i ? 0.5 : 1};
        if (i) items[i].position.x = items[i].position.z = 5.75; /* its middle behind that of the first */
        colors[i] = (iso_rgb){(uint8_t)(i ? 0 : 255), (uint8_t)(i ? 255 : 0), 0};
    }
    const iso_camera camera = {.position = {11.5, -40, 11.5},
                               .focal_point = {11.5, 0, 11.5},
                               .view_up = {0, 0, 1},
                               .view_angle = 40};
    for (int threads = 1; threads <= 2; threads++) {
        iso_volume *volume = lend_ball(threads);
        iso_surface *surface = NULL;
        iso_instance_counts counts = {0};
        iso_render_opts opts = {.method = ISO_METHOD_DISCS,
                                .width = WIDTH,
                                .height = HEIGHT,
                                .camera = &camera,
                                .instances = &row,
                                .instance_counts = &counts};
        assert_int_equal(iso_surface_create(volume, NULL, &surface, NULL), ISO_OK);
        iso_image *image = threads == 1 ? &first : &second;
        assert_int_equal(iso_render(surface, &opts, image, NULL), ISO_OK);
        assert_true(counts.drawn == 1 && counts.hidden == COUNT - 1);
        const uint8_t *middle = image->rgba + 4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
        assert_true(middle[0] > 100 && middle[1] < 80);
        opts.lod = 2;
        opts.instance_counts = NULL;
        iso_image coarse = {0};
        assert_int_equal(iso_render(surface, &opts, &coarse, NULL), ISO_OK);
        iso_difference difference;
        assert_int_equal(iso_compare_images(image, &coarse, NULL, &difference, NULL), ISO_OK);
        assert_true(difference.psnr > 25);
        iso_image_free(&coarse);
        iso_surface_destroy(surface);
        iso_volume_destroy(volume);
    }
    assert_memory_equal(first.rgba, second.rgba, bytes_of(&first));
    iso_image_free(&first);
    iso_image_free(&second);
}

static void files_of_placements(void **state) {
    (void)state;
    const char *path = "test_public_instances.csv";
    iso_placements placements = {0};
    iso_error error = {0};
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "x,y,z,rz,scale,red,green,blue\n1,2,3,90,2,255,0,10\n4,5,6,0,0.5,0,0,0\n");
    fclose(file);
    assert_int_equal(iso_placements_read(path, &placements, &error), ISO_OK);
    assert_int_equal(placements.count, 2);
    const iso_placement *first = &placements.items[0];
    assert_true(first->position.x == 1 && first->position.y == 2 && first->position.z == 3);
    assert_true(fabs(first->rotation[2] - sqrt(0.5)) < 1e-12 && fabs(first->rotation[3] - sqrt(0.5)) < 1e-12);
    assert_true(first->scale == 2 && placements.colors[0].r == 255 && placements.colors[0].b == 10);
    iso_placements_free(&placements);
    assert_true(!placements.items && !placements.count);
    iso_placements_free(&placements);
    remove(path);
    assert_int_equal(iso_placements_read(path, &placements, &error), ISO_ERR_IO);
    assert_int_equal(iso_placements_read(NULL, &placements, &error), ISO_ERR_USAGE);
}

static void refusals(void **state) {
    (void)state;
    iso_volume *volume = lend_ball(1);
    iso_surface *surface = NULL, *glass = NULL;
    iso_image image = {0};
    iso_placement item = {.scale = 1};
    iso_placements one = {.items = &item, .count = 1};
    iso_render_opts opts = {.width = 8, .height = 8, .instances = &one};
    assert_int_equal(iso_surface_create(volume, NULL, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.opacity = 0.5}, &glass, NULL), ISO_OK);
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_ERR_USAGE); /* EXACT */
    opts.method = ISO_METHOD_SPLATS;
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_ERR_USAGE); /* groups */
    opts.method = ISO_METHOD_SPLATS_FLAT;
    assert_int_equal(iso_render(glass, &opts, &image, NULL), ISO_ERR_USAGE);
    const iso_placement bad[] = {{.scale = -1},
                                 {.scale = 1e10},
                                 {.scale = (double)NAN},
                                 {.rotation = {0, (double)INFINITY, 0, 0}},
                                 {.position = {(double)NAN, 0, 0}}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        item = bad[i];
        assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_ERR_USAGE);
    }
    item = (iso_placement){.scale = 1};
    opts.lod = -1;
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_ERR_USAGE);
    opts.lod = 0;
    one.count = 0;
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_ERR_EMPTY);
    one.count = 1;
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_OK);
    iso_surface_destroy(surface);
    iso_surface_destroy(glass);
    iso_volume_destroy(volume);
    iso_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_placement_at_the_origin),
        cmocka_unit_test(a_row_of_placements),
        cmocka_unit_test(files_of_placements),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
