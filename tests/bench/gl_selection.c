/* gl_selection: what the selection of visible points saves in a window's frames by OpenGL: all points are
 * drawn, only visible ones, and those that the engine chooses, in turns, while the camera goes around the
 * model by small steps. Prints JSON: for each way the median time of a frame and of its passes, and how many
 * points it drew; the lowest PSNR against all points; whether pictures depend on those before.
 *
 * usage: gl_selection SCENE SIZE [METHOD [WIDTH HEIGHT [FRAMES [DEGREES [OBJECTS]]]]]
 *            METHOD: discs (discs that follow the curvature, as in the window) or flat
 *            OBJECTS: so many copies of the model in rows, which move up and down; merged: their points as
 *                one surface, which does not move, chosen as by auto
 * Times are of the processor, of all threads: other programs do not disturb them much. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "extract/points/points.h"
#include "grids/scenes/scenes.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/gl/canvas.h"

enum { FRAMES_MOST = 100, WAYS = 4, MERGED = 3, OBJECTS_MOST = 16 };

static const char *const way_names[WAYS] = {"all", "visible", "auto", "merged"};
static const iso_point_selection ways[WAYS] = {ISO_SELECTION_ALL, ISO_SELECTION_VISIBLE, ISO_SELECTION_AUTO,
                                               ISO_SELECTION_AUTO};

/* A frame's times in seconds, and how many points it drew; 0: all. */
typedef struct frame_cost {
    double whole, passes[ISO_GL_PASSES];
    uint64_t tested, drawn;
} frame_cost;

typedef struct bench_window {
    iso_gl_context *context;
    iso_gl_engine *engine;
    iso_gl_canvas *canvas;
    iso_grid grid;
    iso_point_set *set;
    iso_box box; /* world */
    iso_gl_surface *surfaces[WAYS][OBJECTS_MOST];
    iso_reconstruction reconstruction;
    int width, height, objects;
} bench_window;

static double processor_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* How many bricks object `number` stands from the first one along an axis: rows of four. */
static int bricks_from_first(const bench_window *w, int number, int axis) {
    const int side = (iso_point_set_view(w->set).dims[axis] + ISO_BRICK - 1) / ISO_BRICK;
    return axis == 0 ? number % 4 * side : axis == 1 ? number / 4 * side : 0;
}

/* The points of an object in a frame. */
static iso_point_view place_object(const bench_window *w, int number, int frame) {
    iso_point_view points = iso_point_set_view(w->set);
    const iso_affine affine = iso_transform_affine(&points.transform);
    const double up = w->objects > 1 ? 4 * sin(0.7 * frame + number) : 0;
    const iso_vec3 at =
        iso_affine_point(&affine, iso_vec3_make(ISO_BRICK * bricks_from_first(w, number, 0),
                                                ISO_BRICK * bricks_from_first(w, number, 1), up));
    points.transform.origin[0] = at.x;
    points.transform.origin[1] = at.y;
    points.transform.origin[2] = at.z;
    return points;
}

/* Uploads the points of all objects where they stand in frame 0, but for the movement, as one surface. */
static iso_status upload_merged(bench_window *w, iso_error *error) {
    iso_point_view points = iso_point_set_view(w->set);
    size_t end = 0;
    for (size_t s = 0; s < points.span_count; s++)
        if (points.spans[s].first + points.spans[s].count > end)
            end = points.spans[s].first + points.spans[s].count;
    const size_t objects = (size_t)w->objects;
    iso_point *packed = calloc(objects * end, sizeof *packed);
    iso_curvature *curvatures = calloc(objects * end, sizeof *curvatures);
    iso_point_span *spans = calloc(objects * points.span_count, sizeof *spans);
    if (!packed || !curvatures || !spans) return iso_fail_memory(error, "objects");
    for (size_t k = 0; k < objects; k++) {
        memcpy(packed + k * end, points.packed, end * sizeof *packed);
        memcpy(curvatures + k * end, points.curvatures, end * sizeof *curvatures);
        for (size_t s = 0; s < points.span_count; s++) {
            iso_point_span *to = &spans[k * points.span_count + s];
            *to = points.spans[s];
            to->first += k * end;
            for (int axis = 0; axis < 3; axis++) to->brick[axis] += bricks_from_first(w, (int)k, axis);
        }
    }
    points.packed = packed;
    points.curvatures = curvatures;
    points.spans = spans;
    points.span_count *= objects;
    points.versions = NULL;
    points.bounds = NULL;
    memset(points.dims, 0, sizeof points.dims);
    const iso_status status = iso_gl_upload_points(w->engine, &points, &w->surfaces[MERGED][0], error);
    free(packed);
    free(curvatures);
    free(spans);
    return status;
}

static iso_status open_window(bench_window *w, const char *scene, int size, iso_error *error) {
    const iso_gl_context_opts opts = {.kind = ISO_GL_EGL_SURFACELESS};
    const iso_scene_opts scene_opts = {.size = size};
    double isovalue;
    ISO_TRY(iso_gl_context_create(&opts, &w->context, error));
    ISO_TRY(iso_gl_engine_create(w->context, &w->engine, error));
    ISO_TRY(iso_gl_canvas_create(w->engine, &w->canvas, error));
    ISO_TRY(iso_scene_create(scene, &scene_opts, &w->grid, &isovalue, error));
    const iso_points_opts points_opts = {
        .isovalue = isovalue, .primitive = ISO_PRIMITIVE_EDGE, .curvature = true};
    ISO_TRY(iso_point_set_create(&w->grid, &points_opts, &w->set, error));
    ISO_TRY(iso_point_set_update(w->set, error));
    const iso_point_view points = iso_point_set_view(w->set);
    w->box = iso_box_empty();
    for (int k = 0; k < w->objects; k++) {
        const iso_point_view object = place_object(w, k, 0);
        const iso_affine affine = iso_transform_affine(&object.transform);
        const iso_box own = iso_point_view_bounds(&points), box = iso_box_transform(&own, &affine);
        iso_box_add(&w->box, box.lo);
        iso_box_add(&w->box, box.hi);
        for (int i = 0; i < MERGED; i++)
            ISO_TRY(iso_gl_upload_points(w->engine, &object, &w->surfaces[i][k], error));
    }
    return w->objects > 1 ? upload_merged(w, error) : ISO_OK;
}

static void close_window(bench_window *w) {
    for (int i = 0; i < WAYS; i++)
        for (int k = 0; k < OBJECTS_MOST; k++) iso_gl_surface_destroy(w->surfaces[i][k]);
    iso_point_set_destroy(w->set);
    iso_grid_destroy(&w->grid);
    iso_gl_canvas_destroy(w->canvas);
    iso_gl_engine_destroy(w->engine);
    iso_gl_context_destroy(w->context);
}

static iso_view view_at(const bench_window *w, double degrees) {
    const double angle = degrees * ISO_PI / 180;
    iso_camera camera = {.view_angle = 30, .view_up = {0, 0, 1}};
    camera.position = iso_vec3_make(cos(angle), sin(angle), 0.3);
    iso_camera_fit(&camera, &w->box, (double)w->width / w->height, 1);
    return iso_view_make(&camera, w->width, w->height);
}

static iso_status draw(bench_window *w, iso_gl_surface *const *surfaces, int count,
                       iso_point_selection selection, const iso_view *view, iso_image *image,
                       frame_cost *cost, iso_error *error) {
    const iso_gl_pullpush_opts opts = {view, (const iso_gl_surface *const *)surfaces, count,
                                       w->reconstruction, selection};
    const iso_gl_paint paint = {.factor = 1, .color = {229, 220, 200}, .background = {255, 255, 255}};
    const iso_selection_counts before = iso_gl_engine_selection(w->engine);
    iso_gl_engine_reset_seconds(w->engine);
    const double start = processor_seconds();
    ISO_TRY(iso_gl_canvas_draw_pullpush(w->canvas, &opts, &paint, error));
    cost->whole = processor_seconds() - start;
    const iso_selection_counts after = iso_gl_engine_selection(w->engine);
    iso_gl_engine_seconds(w->engine, cost->passes);
    cost->tested = after.tested - before.tested;
    cost->drawn = after.drawn - before.drawn;
    return iso_gl_canvas_read(w->canvas, image, error);
}

static double psnr_of(const iso_image *a, const iso_image *b) {
    const size_t bytes = (size_t)a->width * (size_t)a->height * 4;
    double sum = 0;
    for (size_t i = 0; i < bytes; i++) {
        const double d = (double)a->rgba[i] - (double)b->rgba[i];
        if (i % 4 != 3) sum += d * d;
    }
    return sum > 0 ? 10 * log10(255.0 * 255.0 * 0.75 * (double)bytes / sum) : 999;
}

static int compare_costs(const void *a, const void *b) {
    const double x = ((const frame_cost *)a)->whole, y = ((const frame_cost *)b)->whole;
    return (x > y) - (x < y);
}

static void print_way(int way, frame_cost *costs, int frames, bool last) {
    qsort(costs, (size_t)frames, sizeof *costs, compare_costs);
    const frame_cost *c = &costs[frames / 2];
    printf(" \"%s\": {\"ms\": %.1f, \"tested\": %llu, \"drawn\": %llu", way_names[way], 1e3 * c->whole,
           (unsigned long long)c->tested, (unsigned long long)c->drawn);
    for (int pass = 0; pass < ISO_GL_PASSES; pass++)
        if (c->passes[pass] > 0)
            printf(", \"%s_wall_ms\": %.1f", iso_gl_pass_name((iso_gl_pass)pass), 1e3 * c->passes[pass]);
    printf("}%s\n", last ? "" : ",");
}

/* Whether the last frame of visible points is that of a surface without frames before. */
static iso_status check_coherence(bench_window *w, const iso_view *view, const iso_image *coherent,
                                  bool *same, iso_error *error) {
    const iso_point_view points = iso_point_set_view(w->set);
    iso_gl_surface *anew;
    iso_image image;
    frame_cost cost;
    ISO_TRY(iso_image_create(w->width, w->height, &image, error));
    ISO_TRY(iso_gl_upload_points(w->engine, &points, &anew, error));
    ISO_TRY(draw(w, &anew, 1, ISO_SELECTION_VISIBLE, view, &image, &cost, error));
    *same = memcmp(image.rgba, coherent->rgba, (size_t)w->width * (size_t)w->height * 4) == 0;
    iso_gl_surface_destroy(anew);
    iso_image_free(&image);
    return ISO_OK;
}

static iso_status measure(bench_window *w, int frames, double step, iso_error *error) {
    static frame_cost costs[WAYS][FRAMES_MOST];
    iso_image images[WAYS];
    double psnr[WAYS] = {999, 999, 999, 999};
    bool same = false;
    for (int i = 0; i < WAYS; i++) ISO_TRY(iso_image_create(w->width, w->height, &images[i], error));
    for (int frame = -1; frame < frames; frame++) { /* in the first one programs are compiled */
        const iso_view view = view_at(w, 20 + frame * step);
        for (int k = 0; k < w->objects && w->objects > 1; k++) {
            const iso_point_view points = place_object(w, k, frame);
            for (int i = 0; i < MERGED; i++) ISO_TRY(iso_gl_update_points(w->surfaces[i][k], &points, error));
        }
        for (int i = 0; i < WAYS; i++) {
            frame_cost cost;
            if (!w->surfaces[i][0]) continue;
            ISO_TRY(draw(w, w->surfaces[i], i == MERGED ? 1 : w->objects, ways[i], &view, &images[i], &cost,
                         error));
            psnr[i] = fmin(psnr[i], psnr_of(&images[0], &images[i]));
            if (frame >= 0) costs[i][frame] = cost;
        }
        if (frame == frames - 1 && w->objects == 1)
            ISO_TRY(check_coherence(w, &view, &images[1], &same, error));
    }
    const iso_point_view points = iso_point_set_view(w->set);
    printf("{\"points\": %zu, \"objects\": %d, \"width\": %d, \"height\": %d, \"psnr_visible\": %.1f, "
           "\"psnr_auto\": %.1f,\n",
           iso_point_view_count(&points), w->objects, w->width, w->height, psnr[1], psnr[2]);
    if (w->objects == 1) printf(" \"as_from_scratch\": %s,\n", same ? "true" : "false");
    const int shown = w->objects > 1 ? WAYS : MERGED;
    for (int i = 0; i < shown; i++) print_way(i, costs[i], frames, i == shown - 1);
    printf("}\n");
    for (int i = 0; i < WAYS; i++) iso_image_free(&images[i]);
    return ISO_OK;
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fprintf(stderr,
                "usage: gl_selection SCENE SIZE [METHOD [WIDTH HEIGHT [FRAMES [DEGREES [OBJECTS]]]]]\n");
        return 2;
    }
    const bool flat = argc > 3 && strcmp(argv[3], "flat") == 0;
    bench_window w = {.reconstruction = flat ? ISO_RECONSTRUCTION_FLAT : ISO_RECONSTRUCTION_CURVED,
                      .width = argc > 5 ? atoi(argv[4]) : 976,
                      .height = argc > 5 ? atoi(argv[5]) : 800,
                      .objects = argc > 8 ? atoi(argv[8]) : 1};
    if (w.objects < 1 || w.objects > OBJECTS_MOST) w.objects = 1;
    const int frames = argc > 6 ? atoi(argv[6]) : 5;
    const double step = argc > 7 ? atof(argv[7]) : 2;
    iso_error error = {ISO_OK, ""};
    iso_status status = open_window(&w, argv[1], atoi(argv[2]), &error);
    if (status == ISO_OK)
        status = measure(&w, frames < 1 ? 1 : frames > FRAMES_MOST ? FRAMES_MOST : frames, step, &error);
    if (status != ISO_OK) fprintf(stderr, "gl_selection: %s\n", error.text);
    close_window(&w);
    return status == ISO_OK ? 0 : 4;
}
