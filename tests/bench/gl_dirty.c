/* gl_dirty: frames by OpenGL, of points and of triangles, without changes and with bricks that are extracted
 * again and uploaded before each (Baerentzen and Christensen 2003, table 3). Directions, bricks, runs and
 * medians are those of the report (compare/cost.h); a picture is read back, and its shading is not counted,
 * which is no work of these methods. Prints JSON, seconds of the clock on the wall.
 *
 * usage: gl_dirty VOLUME ISOVALUE [DIRTY [SIDE [FRAMES]]]   DIRTY: bricks a frame, 4 */
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/numbers.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/change_log.h"
#include "grids/volume/volume.h"
#include "render/gl/engine.h"

enum { FRAMES_MOST = 1000 };

typedef struct dirty_bench {
    iso_gl_context *context;
    iso_gl_engine *engine;
    iso_volume volume;
    iso_point_set *points;
    iso_mesh_set *mesh;
    iso_gl_surface *surfaces[2]; /* of points, of triangles */
    iso_gbuffer gbuffer;
    iso_box box; /* world */
    int dirty, side;
    uint64_t seed;
} dirty_bench;

static double random_number(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

static iso_status open_context(dirty_bench *b, iso_error *error) {
    const iso_gl_context_opts osmesa = {.kind = ISO_GL_OSMESA};
    if (iso_gl_context_open_egl(false, &b->context, NULL) != ISO_OK)
        ISO_TRY(iso_gl_context_create(&osmesa, &b->context, error));
    ISO_TRY(iso_gl_engine_create(b->context, &b->engine, error));
    return iso_gbuffer_create(b->side, b->side, &b->gbuffer, error);
}

static iso_status open_surface(dirty_bench *b, const char *path, double isovalue, iso_error *error) {
    ISO_TRY(iso_volume_read(path, &(iso_volume_opts){.component = 0}, &b->volume, error));
    const iso_points_opts points_opts = {.isovalue = isovalue, .primitive = ISO_PRIMITIVE_AUTO};
    const iso_mesh_opts mesh_opts = {.isovalue = isovalue};
    ISO_TRY(iso_point_set_create(&b->volume.grid, &points_opts, &b->points, error));
    ISO_TRY(iso_point_set_update(b->points, error));
    ISO_TRY(iso_mesh_set_create(&b->volume.grid, &mesh_opts, &b->mesh, error));
    ISO_TRY(iso_mesh_set_update(b->mesh, error));
    const iso_point_view points = iso_point_set_view(b->points);
    const iso_mesh_view mesh = iso_mesh_set_view(b->mesh);
    const iso_affine affine = iso_transform_affine(&points.transform);
    const iso_box box = iso_point_view_bounds(&points);
    b->box = iso_box_transform(&box, &affine);
    ISO_TRY(iso_gl_upload_points(b->engine, &points, &b->surfaces[0], error));
    return iso_gl_upload_mesh(b->engine, &mesh, &b->surfaces[1], error);
}

/* As in compare/cost.c: voxels in the middle of bricks that the surface crosses. */
static iso_status mark_bricks(dirty_bench *b, iso_error *error) {
    iso_change_log *log = iso_grid_log(&b->volume.grid);
    const iso_mesh_view mesh = iso_mesh_set_view(b->mesh);
    iso_change_log_begin(log);
    for (int i = 0; i < b->dirty; i++) {
        const size_t s = (size_t)(random_number(&b->seed) * (double)mesh.span_count);
        int lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++) {
            const int first = mesh.spans[s].brick[axis] * ISO_BRICK,
                      last = iso_grid_dims(&b->volume.grid)[axis] - 1;
            lo[axis] = first + 4 < last ? first + 4 : last;
            hi[axis] = first + 11 < last ? first + 11 : last;
        }
        ISO_TRY(iso_change_log_add(log, lo, hi, error));
    }
    return ISO_OK;
}

static iso_status update(dirty_bench *b, int what, iso_error *error) {
    if (what == 0) {
        ISO_TRY(iso_point_set_update(b->points, error));
        const iso_point_view points = iso_point_set_view(b->points);
        return iso_gl_update_points(b->surfaces[0], &points, error);
    }
    ISO_TRY(iso_mesh_set_update(b->mesh, error));
    const iso_mesh_view mesh = iso_mesh_set_view(b->mesh);
    return iso_gl_update_mesh(b->surfaces[1], &mesh, error);
}

static iso_status draw(dirty_bench *b, int what, bool edit, double *seconds, iso_error *error) {
    const double z = 2 * random_number(&b->seed) - 1, around = 2 * ISO_PI * random_number(&b->seed);
    iso_camera camera = {.view_angle = 30, .view_up = {0, 0, 1}};
    camera.position = iso_vec3_make(sqrt(1 - z * z) * cos(around), sqrt(1 - z * z) * sin(around), z);
    iso_camera_fit(&camera, &b->box, 1, 1);
    const iso_view view = iso_view_make(&camera, b->side, b->side);
    const iso_gl_surface *surface = b->surfaces[what];
    const iso_gl_draw_opts opts = {
        .view = &view, .surfaces = &surface, .surface_count = 1, .scaling = ISO_SCALING_ATTENUATED};
    if (edit) ISO_TRY(mark_bricks(b, error));
    const double start = iso_clock_seconds();
    if (edit) ISO_TRY(update(b, what, error));
    ISO_TRY(iso_gl_draw(b->engine, &opts, &b->gbuffer, error));
    *seconds = iso_clock_seconds() - start;
    return ISO_OK;
}

/* Frames of both kinds in turns, so that what else runs slows both. */
static iso_status measure(dirty_bench *b, int what, int frames, double medians[2], iso_error *error) {
    static double times[2][FRAMES_MOST];
    double unused;
    b->seed = 2003;
    for (int edit = 0; edit < 2; edit++) ISO_TRY(draw(b, what, edit, &unused, error));
    for (int i = 0; i < 2 * frames; i++) ISO_TRY(draw(b, what, i % 2, &times[i % 2][i / 2], error));
    for (int edit = 0; edit < 2; edit++) {
        qsort(times[edit], (size_t)frames, sizeof times[edit][0], iso_compare_doubles);
        medians[edit] = times[edit][frames / 2];
    }
    return ISO_OK;
}

static iso_status run(dirty_bench *b, const char *path, double isovalue, int frames, iso_error *error) {
    static const char *const names[2] = {"points", "triangles"};
    double seconds[2];
    ISO_TRY(open_context(b, error));
    ISO_TRY(open_surface(b, path, isovalue, error));
    printf("{\"renderer\": \"%s\", \"dirty\": %d", iso_gl_context_info(b->context).renderer, b->dirty);
    for (int what = 0; what < 2; what++) {
        ISO_TRY(measure(b, what, frames, seconds, error));
        printf(",\n \"%s\": {\"seconds\": %.6g, \"seconds_edited\": %.6g, \"uploaded\": %llu}", names[what],
               seconds[0], seconds[1],
               (unsigned long long)iso_gl_surface_measure(b->surfaces[what]).uploaded);
    }
    printf("}\n");
    return ISO_OK;
}

static void close_bench(dirty_bench *b) {
    for (int i = 0; i < 2; i++) iso_gl_surface_destroy(b->surfaces[i]);
    iso_gbuffer_free(&b->gbuffer);
    iso_point_set_destroy(b->points);
    iso_mesh_set_destroy(b->mesh);
    iso_volume_free(&b->volume);
    iso_gl_engine_destroy(b->engine);
    iso_gl_context_destroy(b->context);
}

int main(int argc, char **argv) {
    dirty_bench b = {.dirty = argc > 3 ? atoi(argv[3]) : 4, .side = argc > 4 ? atoi(argv[4]) : 800};
    const int frames = argc > 5 ? atoi(argv[5]) : 50;
    iso_error error = {ISO_OK, ""};
    if (argc < 3 || b.dirty < 1 || b.side < 1 || frames < 1 || frames > FRAMES_MOST) {
        fprintf(stderr, "usage: gl_dirty VOLUME ISOVALUE [DIRTY [SIDE [FRAMES]]]\n");
        return 2;
    }
    const iso_status status = run(&b, argv[1], atof(argv[2]), frames, &error);
    close_bench(&b);
    if (status != ISO_OK) fprintf(stderr, "gl_dirty: %s\n", error.text);
    return status == ISO_OK ? 0 : 1;
}
