/* occlusion: how far ambient occlusion is from 512 random rays a place, and what it costs: for each FILE
 * RANGE ISOVALUE of the command line (the range in voxels) a row. The picture is that of exact at fit, 1024 x
 * 1024, as isorender draws it; places are some of the pixels. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "grids/volume/volume.h"
#include "occlusion_truth.h"
#include "scene/picture.h"

enum { SIDE = 1024, RAYS = 512, PLACES = 1500, FRAMES = 7 };

typedef struct bench {
    iso_volume volume;
    iso_scene_surface surface;
    iso_camera camera;
    iso_pool *pool;
    iso_occluders occluders;
    double range; /* mm */
} bench;

static void stop(const iso_error *error) {
    fprintf(stderr, "%s\n", error->text);
    exit(1);
}

static iso_status draw(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const bench *b = context;
    const iso_target target = {view, gbuffer, b->pool, 0, NULL};
    return iso_draw_exact(&target, b->surface.exact, error);
}

/* Seconds of a picture. */
static double render(bench *b, bool occlusion, int samples) {
    iso_error error;
    iso_image image;
    const iso_rgb color = iso_shading_palette(0);
    const iso_layered_surface surface = {.surface = &b->surface, .translucency = {.opacity = 1}};
    iso_scene scene = {.renderer = iso_renderer_get(ISO_METHOD_EXACT),
                       .surfaces = &surface,
                       .count = 1,
                       .occlusion = {.ambient = occlusion, .range = b->range},
                       .occluders = &b->occluders};
    iso_picture_opts opts = {.camera = &b->camera,
                             .width = SIDE,
                             .height = SIDE,
                             .samples = samples,
                             .shading = {.colors = &color, .color_count = 1, .background = {255, 255, 255}},
                             .pool = b->pool};
    if (iso_image_create(SIDE, SIDE, &image, &error) != ISO_OK) stop(&error);
    const double start = iso_clock_seconds();
    if (iso_scene_render(&scene, &opts, &image, NULL, &error) != ISO_OK) stop(&error);
    const double seconds = iso_clock_seconds() - start;
    iso_image_free(&image);
    return seconds;
}

static double least(bench *b, bool occlusion, int samples, bool forget) {
    double best = INFINITY;
    for (int i = 0; i < FRAMES; i++) {
        if (forget) iso_occluders_free(&b->occluders);
        best = fmin(best, render(b, occlusion, samples));
    }
    return best;
}

/* Prints the deviation from the truth: root of the mean square, mean, 99th percentile, maximum. */
static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void judge(bench *b) {
    iso_error error;
    iso_gbuffer g;
    const iso_view view = iso_view_make(&b->camera, SIDE, SIDE);
    const iso_occluding all = {.surfaces = {&b->surface}, .count = 1};
    const iso_occlusion_opts opts = {.ambient = true, .range = b->range};
    iso_occlusion *occlusion;
    if (iso_gbuffer_create(SIDE, SIDE, &g, &error) != ISO_OK ||
        iso_gbuffer_add_plane(&g, &g.ambient, &error) != ISO_OK ||
        iso_occluders_update(&b->occluders, &all, &opts, &b->camera, b->pool, &occlusion, &error) != ISO_OK)
        stop(&error);
    iso_gbuffer_clear(&g);
    if (draw(b, &view, &g, &error) != ISO_OK ||
        iso_occlusion_light(occlusion, &view, 1, 0, SIDE - 1, &g, b->pool, &error) != ISO_OK)
        stop(&error);
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&b->surface.grid));
    static double errors[SIDE * SIDE];
    size_t hits = 0, count = 0;
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) hits += g.surface[i] != ISO_SURFACE_NONE;
    const size_t every = hits / PLACES + 1;
    double square = 0, mean = 0;
    hits = 0;
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        if (g.surface[i] == ISO_SURFACE_NONE || hits++ % every) continue;
        iso_vec3 origin, direction;
        iso_view_ray(&view, (double)(i % SIDE) + 0.5, (double)(i / SIDE) + 0.5, &origin, &direction);
        const iso_vec3 n = iso_gbuffer_normal(&g, i);
        const double *r = view.rotation;
        const iso_vec3 world = {r[0] * n.x + r[3] * n.y + r[6] * n.z, r[1] * n.x + r[4] * n.y + r[7] * n.z,
                                r[2] * n.x + r[5] * n.y + r[8] * n.z};
        if (iso_vec3_dot(world, direction) > 0.2 * iso_vec3_length(direction))
            continue; /* seen from inside */
        const iso_vec3 place = iso_affine_point_to_index(
            &affine, iso_vec3_add(origin, iso_vec3_scale(direction, (double)g.depth[i])));
        const double truth =
            iso_occlusion_truth(&b->surface.grid, b->surface.isovalue, place, world, b->range, RAYS, i);
        const double wrong = (double)g.ambient[i] - truth;
        square += wrong * wrong;
        mean += wrong;
        errors[count++] = fabs(wrong);
    }
    qsort(errors, count, sizeof *errors, compare);
    printf("rmse %.3f bias %+.3f p99 %.3f max %.3f", sqrt(square / (double)count), mean / (double)count,
           errors[count * 99 / 100], errors[count - 1]);
    iso_gbuffer_free(&g);
}

int main(int argc, char **argv) {
    for (int i = 1; i + 2 < argc; i += 3) {
        iso_error error;
        bench b = {.range = 0};
        if (iso_pool_create(0, &b.pool, &error) != ISO_OK ||
            iso_volume_read(argv[i], &(iso_volume_opts){.pool = b.pool}, &b.volume, &error) != ISO_OK)
            stop(&error);
        b.surface = (iso_scene_surface){.grid = b.volume.grid, .isovalue = atof(argv[i + 2]), .pool = b.pool};
        if (iso_scene_surface_update(&b.surface, ISO_PART_CELLS, &error) != ISO_OK) stop(&error);
        const iso_transform *transform = iso_grid_transform(&b.volume.grid);
        const iso_affine affine = iso_transform_affine(transform);
        const iso_box box = iso_exact_bounds(b.surface.exact, &affine);
        b.range = atof(argv[i + 1]) *
                  fmin(transform->spacing[0], fmin(transform->spacing[1], transform->spacing[2]));
        iso_vec3 forward, up;
        iso_direction_vectors(ISO_ISOMETRIC, iso_vec3_make(0, 0, 1), &forward, &up);
        b.camera = (iso_camera){.view_angle = 30};
        b.camera.position = iso_vec3_scale(forward, -1);
        b.camera.view_up = up;
        iso_camera_fit(&b.camera, &box, 1, 1);
        printf("%s range %s: ", argv[i], argv[i + 1]);
        judge(&b);
        for (int samples = 1; samples <= 4; samples *= 4) {
            const double exact = least(&b, false, samples, false), first = least(&b, true, samples, true),
                         later = least(&b, true, samples, false);
            printf("; %d samples: exact %.1f ms, first %.2f x, later %.2f x", samples, 1000 * exact,
                   first / exact, later / exact);
        }
        printf("\n");
        fflush(stdout);
        iso_occluders_free(&b.occluders);
        iso_scene_surface_free(&b.surface);
        iso_volume_free(&b.volume);
        iso_pool_destroy(b.pool);
    }
    return 0;
}
