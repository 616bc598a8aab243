/* bench render: from primitives to pixels, 1024 x 1024, one sample a pixel.
 *
 * There is no peer here: VTK's renderers need GL, and a row that is not measured is left out. */
#include <stdio.h>
#include <stdlib.h>

#include "bench_harness.h"
#include "extract/mesh.h"
#include "extract/points.h"
#include "image/camera.h"
#include "render/draw.h"
#include "render/picture.h"
#include "truth/raycast.h"

typedef struct scene_state {
    iso_point_set *points; /* exactly one of the three */
    iso_mesh_set *mesh;
    iso_raycaster *caster;
    iso_pool *pool;
    iso_camera camera;
    iso_image image;
    size_t primitives, covered;
} scene_state;

static iso_status draw(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const scene_state *scene = context;
    iso_target target = {view, gbuffer, scene->pool, 0};
    if (scene->caster) return iso_draw_raycast(&target, scene->caster, error);
    if (scene->mesh) {
        iso_mesh_view mesh = iso_mesh_set_view(scene->mesh);
        return iso_draw_mesh(&target, &mesh, error);
    }
    iso_point_view points = iso_point_set_view(scene->points);
    return iso_draw_points(&target, &points, error);
}

/* The whole volume in sight. */
static iso_status aim(scene_state *scene, const iso_grid *grid, int side, iso_error *error) {
    const int *dims = iso_grid_dims(grid);
    iso_box box = {.hi = iso_vec3_make(dims[0] - 1, dims[1] - 1, dims[2] - 1)};
    iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    iso_box world = iso_box_transform(&box, &affine);
    scene->camera = (iso_camera){.view_angle = 30};
    iso_vec3 forward;
    iso_direction_vectors(ISO_ISOMETRIC, iso_vec3_make(0, 0, 1), &forward, &scene->camera.view_up);
    scene->camera.position = iso_vec3_scale(forward, -1);
    iso_camera_fit(&scene->camera, &world, 1, 1);
    return iso_image_create(side, side, &scene->image, error);
}

static iso_status begin(bench_row *row, scene_state **out, const iso_grid **grid, iso_error *error) {
    ISO_TRY(bench_row_grid(row, grid, error));
    scene_state *scene = calloc(1, sizeof *scene);
    if (!scene) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = *out = scene;
    scene->pool = bench_pool(row->bench, row->threads);
    return aim(scene, *grid, row->bench->settings->small ? 64 : 1024, error);
}

static iso_status open_points(bench_row *row, iso_error *error) {
    scene_state *scene = NULL;
    const iso_grid *grid = NULL;
    ISO_TRY(begin(row, &scene, &grid, error));
    iso_points_opts opts = {.isovalue = row->isovalue, .pool = scene->pool};
    ISO_TRY(iso_point_set_create(grid, &opts, &scene->points, error));
    ISO_TRY(iso_point_set_update(scene->points, error));
    scene->primitives = iso_point_set_stats(scene->points).points;
    return ISO_OK;
}

static iso_status open_mesh(bench_row *row, iso_error *error) {
    scene_state *scene = NULL;
    const iso_grid *grid = NULL;
    ISO_TRY(begin(row, &scene, &grid, error));
    iso_mesh_opts opts = {.isovalue = row->isovalue, .pool = scene->pool};
    ISO_TRY(iso_mesh_set_create(grid, &opts, &scene->mesh, error));
    ISO_TRY(iso_mesh_set_update(scene->mesh, error));
    iso_mesh_view view = iso_mesh_set_view(scene->mesh);
    scene->primitives = iso_mesh_view_triangle_count(&view);
    return ISO_OK;
}

static iso_status open_raycast(bench_row *row, iso_error *error) {
    scene_state *scene = NULL;
    const iso_grid *grid = NULL;
    ISO_TRY(begin(row, &scene, &grid, error));
    return iso_raycaster_create(grid, row->isovalue, scene->pool, &scene->caster, error);
}

static iso_status run(bench_row *row, bench_sample *sample, iso_error *error) {
    static const iso_rgb color = {0xD9, 0xB3, 0x6C};
    scene_state *scene = row->context;
    iso_picture_opts opts = {.camera = &scene->camera,
                             .width = scene->image.width,
                             .height = scene->image.height,
                             .shading = {.colors = &color, .color_count = 1},
                             .draw = draw,
                             .draw_context = scene,
                             .pool = scene->pool};
    bench_clock clock = bench_clock_start();
    ISO_TRY(iso_picture_render(&opts, &scene->image, &scene->covered, error));
    bench_clock_stop(&clock, sample);
    sample->primitives = scene->primitives;
    return ISO_OK;
}

static void finish(bench_row *row) {
    const scene_state *scene = row->context;
    double seconds = bench_row_median(row) * 1e-3;
    bench_count(row, "covered_pixels", (double)scene->covered, 0, 0);
    if (scene->primitives) bench_count(row, "items_per_second", (double)scene->primitives / seconds, 0, 0);
}

static void close_scene(bench_row *row) {
    scene_state *scene = row->context;
    if (!scene) return;
    iso_point_set_destroy(scene->points);
    iso_mesh_set_destroy(scene->mesh);
    iso_raycaster_destroy(scene->caster);
    iso_image_free(&scene->image);
    free(scene);
}

static const struct method {
    const char *name;
    bench_kind kind;
} methods[] = {
    {"points", {.open = open_points, .run = run, .finish = finish, .close = close_scene}},
    {"mesh", {.open = open_mesh, .run = run, .finish = finish, .close = close_scene}},
    {"raycast", {.open = open_raycast, .run = run, .finish = finish, .close = close_scene}},
};

static iso_status run_scene(bench_state *bench, bool head, int size, iso_error *error) {
    const bench_settings *settings = bench->settings;
    char title[64];
    snprintf(title, sizeof title, "frames of %s%d", head ? "head" : "ct", size);
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        bench_row *single = NULL;
        for (int t = 0; t < settings->thread_count; t++) {
            bench_row *row = bench_add(bench, &methods[m].kind, "render/%s/%s%d/threads:%d", methods[m].name,
                                       head ? "head" : "ct", size, settings->threads[t]);
            row->head = head;
            row->size = size;
            row->isovalue = head ? 0 : 127.5;
            row->threads = settings->threads[t];
            if (row->threads == 1)
                single = row;
            else
                bench_compare(row, single, "scaling", NULL, 0);
        }
    }
    return bench_run_group(bench, title, error);
}

/* ct of 160 has as many voxels as the stent that ships (128 x 128 x 256); 256 is four times that. */
iso_status bench_render(bench_state *bench, iso_error *error) {
    bool small = bench->settings->small;
    ISO_TRY(run_scene(bench, false, small ? 32 : 160, error));
    return run_scene(bench, false, small ? 48 : 256, error);
}
