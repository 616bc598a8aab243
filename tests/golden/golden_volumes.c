/* Points, meshes and pictures of the procedural scenes and of the volume that ships. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden.h"
#include "grids/scenes/scenes.h"
#include "grids/volume/volume.h"
#include "render/picture.h"
#include "scene/method.h"

enum { WIDTH = 168, HEIGHT = 120, SURFACES = 2 };

typedef struct surface {
    const char *name;
    iso_grid grid;
    double isovalues[SURFACES];
    iso_scene_surface surfaces[SURFACES]; /* of these isovalues */
    iso_pool *pool;
} surface;

/* ---- primitives ---- */

static uint64_t hash_points(const iso_point_view *view) {
    uint64_t hash = GOLDEN_HASH_START;
    for (size_t s = 0; s < view->span_count; s++) {
        const iso_point_span *span = &view->spans[s];
        hash = golden_hash(hash, span->brick, sizeof span->brick);
        hash = golden_hash(hash, &span->count, sizeof span->count);
        if (view->packed)
            hash = golden_hash(hash, view->packed + span->first, span->count * sizeof *view->packed);
        if (view->surfels)
            hash = golden_hash(hash, view->surfels + span->first, span->count * sizeof *view->surfels);
        if (view->curvatures)
            hash = golden_hash(hash, view->curvatures + span->first, span->count * sizeof *view->curvatures);
    }
    return golden_hash(hash, &view->radius, sizeof view->radius);
}

static void points_row(golden_table *table, const surface *s, iso_points_opts opts, const char *kind) {
    iso_error error = {0};
    iso_point_set *set = NULL;
    opts.isovalue = s->isovalues[0];
    opts.pool = s->pool;
    golden_check(iso_point_set_create(&s->grid, &opts, &set, &error), &error);
    golden_check(iso_point_set_update(set, &error), &error);
    iso_point_view view = iso_point_set_view(set);
    char name[96];
    snprintf(name, sizeof name, "%s points %s", s->name, kind);
    golden_row(table, name, hash_points(&view), NULL);
    iso_point_set_destroy(set);
}

static void all_points(golden_table *table, const surface *s) {
    points_row(table, s, (iso_points_opts){.primitive = ISO_PRIMITIVE_EDGE}, "edge");
    points_row(table, s, (iso_points_opts){.primitive = ISO_PRIMITIVE_EDGE, .floats = true}, "edge floats");
    points_row(table, s, (iso_points_opts){.primitive = ISO_PRIMITIVE_EDGE, .curvature = true},
               "edge shapes");
    points_row(table, s, (iso_points_opts){.primitive = ISO_PRIMITIVE_FOOT_ITERATED}, "foot-iterated");
    if (!iso_grid_is_level_set(&s->grid)) return;
    points_row(table, s, (iso_points_opts){.primitive = ISO_PRIMITIVE_FOOT}, "foot");
    points_row(table, s, (iso_points_opts){.primitive = ISO_PRIMITIVE_FOOT, .curvature = true},
               "foot shapes");
}

static void mesh_row(golden_table *table, const surface *s) {
    iso_error error = {0};
    iso_mesh_view view = iso_mesh_set_view(s->surfaces[0].mesh);
    iso_weld weld = {0};
    golden_check(iso_mesh_weld(&view, NULL, &weld, &error), &error);
    uint64_t hash = golden_hash(GOLDEN_HASH_START, weld.vertices, weld.vertex_count * sizeof *weld.vertices);
    hash = golden_hash(hash, weld.triangles, weld.triangle_count * sizeof *weld.triangles);
    iso_weld_free(&weld);
    char name[96];
    snprintf(name, sizeof name, "%s mesh", s->name);
    golden_row(table, name, hash, NULL);
}

/* ---- pictures ---- */

typedef struct drawing {
    const surface *surface;
    const iso_renderer *method;
    int surfaces;
} drawing;

static iso_status draw(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const drawing *d = context;
    for (int i = 0; i < d->surfaces; i++) {
        const iso_target target = {view, gbuffer, d->surface->pool, (uint8_t)i, NULL};
        ISO_TRY(iso_renderer_draw(d->method, &d->surface->surfaces[i], &target, error));
    }
    return ISO_OK;
}

static const iso_rgb COLORS[SURFACES] = {{217, 179, 108}, {96, 140, 200}};

static iso_camera camera_of(const surface *s, bool orthographic) {
    iso_camera camera = {.view_angle = 30, .orthographic = orthographic, .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors(ISO_FRONT, iso_vec3_make(0, 0, 1), &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -1);
    iso_camera_orbit(&camera, 35, 20);
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&s->grid));
    const iso_box box = iso_exact_bounds(s->surfaces[0].exact, &affine);
    iso_camera_fit(&camera, &box, (double)WIDTH / HEIGHT, 1);
    return camera;
}

/* How a picture is taken; zero is one surface in perspective with one sample a pixel. */
typedef struct variant {
    const char *name;
    bool orthographic;
    int samples;
    int surfaces;
    double zoom;
} variant;

static const variant VARIANTS[] = {{"perspective", .surfaces = 1},
                                   {"orthographic", .surfaces = 1, .orthographic = true},
                                   {"samples4", .surfaces = 1, .samples = 4},
                                   {"zoom", .surfaces = 1, .zoom = 5},
                                   {"two", .surfaces = 2}};

static uint64_t hash_picture(const iso_image *image, const iso_aov *aov) {
    size_t pixels = (size_t)WIDTH * HEIGHT;
    uint64_t hash = golden_hash(GOLDEN_HASH_START, image->rgba, 4 * pixels);
    if (!aov) return hash;
    const float *planes[] = {aov->depth, aov->normal[0], aov->normal[1], aov->normal[2], aov->coverage};
    for (int i = 0; i < ISO_AOV_PLANES; i++) hash = golden_hash(hash, planes[i], pixels * sizeof(float));
    return hash;
}

static void picture_row(golden_table *table, const surface *s, const iso_renderer *method, const variant *v,
                        iso_image *image, iso_aov *aov) {
    iso_error error = {0};
    iso_camera camera = camera_of(s, v->orthographic);
    if (v->zoom > 0) iso_camera_zoom(&camera, v->zoom);
    drawing d = {s, method, v->surfaces};
    const iso_picture_opts opts = {.camera = &camera,
                                   .width = WIDTH,
                                   .height = HEIGHT,
                                   .samples = v->samples,
                                   .shading = {COLORS, SURFACES, {255, 255, 255}, 0},
                                   .draw = draw,
                                   .draw_context = &d,
                                   .pool = s->pool,
                                   .aov = aov};
    size_t covered = 0;
    golden_check(iso_picture_render(&opts, image, &covered, &error), &error);
    if (covered == 0) golden_check(iso_fail(&error, ISO_ERR_EMPTY, "%s: an empty picture", s->name), &error);
    char name[96];
    snprintf(name, sizeof name, "%s picture %s %s", s->name, method->name, v->name);
    golden_row(table, name, hash_picture(image, aov), image);
}

/* A single exact surface is shaded while it is drawn, without a gbuffer: isorender's default. */
static void painted_row(golden_table *table, const surface *s, iso_image *image) {
    iso_error error = {0};
    iso_camera camera = camera_of(s, false);
    const iso_view view = iso_view_make(&camera, WIDTH, HEIGHT);
    const iso_shading shading = {COLORS, SURFACES, {255, 255, 255}, 0, {0, 0, 0}};
    const iso_exact_picture canvas = {&view, &shading, image, s->pool, NULL, 1};
    size_t covered = 0;
    golden_check(iso_paint_exact(&canvas, s->surfaces[0].exact, &covered, &error), &error);
    char name[96];
    snprintf(name, sizeof name, "%s picture exact painted", s->name);
    golden_row(table, name, hash_picture(image, NULL), image);
}

static void all_pictures(golden_table *table, const surface *s) {
    iso_error error = {0};
    iso_image image = {0};
    iso_aov aov = {0};
    golden_check(iso_image_create(WIDTH, HEIGHT, &image, &error), &error);
    golden_check(iso_aov_create(WIDTH, HEIGHT, &aov, &error), &error);
    size_t methods;
    const iso_renderer *list = iso_renderer_list(&methods);
    for (size_t m = 0; m <= methods; m++)
        for (size_t v = 0; v < sizeof VARIANTS / sizeof *VARIANTS; v++)
            picture_row(table, s, m < methods ? &list[m] : iso_renderer_truth(), &VARIANTS[v], &image, &aov);
    painted_row(table, s, &image);
    iso_image_free(&image);
    iso_aov_free(&aov);
}

/* ---- volumes ---- */

static void all_rows(golden_table *table, surface *s) {
    iso_error error = {0};
    for (int i = 0; i < SURFACES; i++) {
        s->surfaces[i] = (iso_scene_surface){.grid = s->grid, .isovalue = s->isovalues[i], .pool = s->pool};
        for (int part = 0; part < ISO_PART_COUNT; part++)
            golden_check(iso_scene_surface_prepare(&s->surfaces[i], (iso_part)part, &error), &error);
    }
    all_points(table, s);
    mesh_row(table, s);
    all_pictures(table, s);
    for (int i = 0; i < SURFACES; i++) iso_scene_surface_free(&s->surfaces[i]);
}

/* `second` is added to the scene's isovalue for the second surface. */
static void scene_rows(golden_table *table, const char *name, int size, double second, iso_pool *pool) {
    iso_error error = {0};
    surface s = {.name = name, .pool = pool};
    const iso_scene_opts opts = {.size = size, .pool = pool};
    golden_check(iso_scene_create(name, &opts, &s.grid, &s.isovalues[0], &error), &error);
    s.isovalues[1] = s.isovalues[0] + second;
    all_rows(table, &s);
    iso_grid_destroy(&s.grid);
}

/* Voxels of three sizes along axes that are no axis of the world. */
static void oblique_rows(golden_table *table, iso_pool *pool) {
    iso_error error = {0};
    surface s = {.name = "oblique", .pool = pool};
    const iso_scene_opts opts = {.size = 48, .pool = pool};
    golden_check(iso_scene_create("ct", &opts, &s.grid, &s.isovalues[0], &error), &error);
    s.isovalues[1] = 60;
    const iso_transform oblique = {.origin = {-12, 30.5, 7},
                                   .spacing = {0.5, 0.75, 1.25},
                                   .direction = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6}};
    s.grid.rgrid->transform = oblique;
    all_rows(table, &s);
    iso_grid_destroy(&s.grid);
}

static void stent_rows(golden_table *table, const char *folder, iso_pool *pool) {
    iso_error error = {0};
    char path[1024];
    snprintf(path, sizeof path, "%s/volumes/stent.nrrd", folder);
    iso_volume volume = {0};
    const iso_volume_opts opts = {.pool = pool};
    golden_check(iso_volume_read(path, &opts, &volume, &error), &error);
    surface s = {.name = "stent", .grid = volume.grid, .isovalues = {600, 250}, .pool = pool};
    all_rows(table, &s);
    iso_volume_free(&volume);
}

void golden_volumes(golden_table *table, const char *folder, iso_pool *pool) {
    scene_rows(table, "sphere", 48, 1, pool);
    scene_rows(table, "cylinder", 48, 1, pool);
    scene_rows(table, "cube", 32, 1, pool);
    scene_rows(table, "torus", 64, 1, pool);
    scene_rows(table, "head", 96, -1, pool);
    scene_rows(table, "gyroid", 40, 0.5, pool);
    scene_rows(table, "ct", 64, -40, pool);
    oblique_rows(table, pool);
    stent_rows(table, folder, pool);
}
