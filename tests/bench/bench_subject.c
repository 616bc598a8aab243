#include "bench_subject.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench_scenes.h"
#include "render/picture.h"

/* ---- what it is ---- */

static iso_status make_bumpy(bench_subject *s, iso_error *error) {
    fprintf(stderr, "bench: making a bumpy sphere of %d voxels a side\n", s->bumpy_side);
    return bench_bumpy_create(s->bumpy_side, s->bumpy_piece, !s->bumpy_meshless, s->pool, &s->bumpy, error);
}

static iso_status read_file(bench_subject *s, iso_error *error) {
    char path[1024];
    iso_volume_opts opts = {0};
    snprintf(path, sizeof path, "%.900s/%s", ISO_TEST_VOLUMES, s->file);
    FILE *there = fopen(path, "rb");
    if (!there)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "no volume %s in %.80s", s->file, ISO_TEST_VOLUMES);
    fclose(there);
    ISO_TRY(iso_volume_read(path, &opts, &s->volume, error));
    s->grid = &s->volume.grid;
    return ISO_OK;
}

static iso_status make(bench_subject *s, iso_error *error) {
    if (s->made) return ISO_OK;
    if (!s->pool) ISO_TRY(iso_pool_create(0, &s->pool, error));
    if (s->bumpy_side) {
        bench_bumpy_free(&s->bumpy);
        ISO_TRY(make_bumpy(s, error));
    } else if (s->file) {
        ISO_TRY(read_file(s, error));
    } else {
        ISO_TRY(bench_scene_ct(s->bench->scenes, s->ct_size, ISO_UINT8, &s->grid, error));
    }
    s->made = true;
    return ISO_OK;
}

iso_status bench_subject_grid(bench_subject *s, const iso_grid **grid, iso_error *error) {
    ISO_TRY(make(s, error));
    *grid = s->grid;
    return s->grid ? ISO_OK : iso_fail(error, ISO_ERR_UNSUPPORTED, "%s has no grid", s->name);
}

iso_status bench_subject_points(bench_subject *s, iso_point_view *points, iso_error *error) {
    ISO_TRY(make(s, error));
    *points = s->bumpy.points;
    if (s->bumpy_side) return ISO_OK;
    if (!s->points) {
        iso_points_opts opts = {.isovalue = s->isovalue, .curvature = true, .pool = s->pool};
        ISO_TRY(iso_point_set_create(s->grid, &opts, &s->points, error));
        ISO_TRY(iso_point_set_update(s->points, error));
        ISO_TRY(iso_point_set_bound(s->points, error));
    }
    *points = iso_point_set_view(s->points);
    return ISO_OK;
}

iso_status bench_subject_mesh(bench_subject *s, iso_mesh_view *mesh, iso_error *error) {
    ISO_TRY(make(s, error));
    if (!s->bumpy_side && !s->mesh) {
        iso_mesh_opts opts = {.isovalue = s->isovalue, .pool = s->pool};
        ISO_TRY(iso_mesh_set_create(s->grid, &opts, &s->mesh, error));
        ISO_TRY(iso_mesh_set_update(s->mesh, error));
    }
    const iso_mesh_set *set = s->bumpy_side ? s->bumpy.mesh : s->mesh;
    if (!set) return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s has no mesh", s->name);
    *mesh = iso_mesh_set_view(set);
    return ISO_OK;
}

iso_status bench_subject_caster(bench_subject *s, const iso_raycaster **caster, iso_error *error) {
    const iso_grid *grid;
    ISO_TRY(bench_subject_grid(s, &grid, error));
    if (!s->caster) ISO_TRY(iso_raycaster_create(grid, s->isovalue, s->pool, &s->caster, error));
    *caster = s->caster;
    return ISO_OK;
}

iso_status bench_subject_exact(bench_subject *s, const iso_exact **exact, iso_error *error) {
    const iso_grid *grid;
    ISO_TRY(bench_subject_grid(s, &grid, error));
    if (!s->exact) {
        iso_exact_opts opts = {.isovalue = s->isovalue, .pool = s->pool};
        ISO_TRY(iso_exact_create(grid, &opts, &s->exact, error));
        ISO_TRY(iso_exact_update(s->exact, error));
    }
    *exact = s->exact;
    return ISO_OK;
}

void bench_subject_end(bench_subject *s) {
    bench_vtk_end(&s->vtk);
    bench_vtk_end(&s->vtk_points);
    iso_exact_destroy(s->exact);
    iso_raycaster_destroy(s->caster);
    iso_mesh_set_destroy(s->mesh);
    iso_point_set_destroy(s->points);
    iso_volume_free(&s->volume);
    bench_bumpy_free(&s->bumpy);
    iso_gbuffer_free(&s->gbuffer);
    iso_image_free(&s->image);
    iso_pool_destroy(s->pool);
}

/* ---- where it is seen from ---- */

static int picture_side(const bench_subject *s) {
    return s->bench->settings->small ? 64 : 1024;
}

iso_status bench_subject_frame(bench_subject *s, iso_error *error) {
    if (s->image.rgba) return ISO_OK;
    int side = picture_side(s);
    if (!s->gbuffer.depth) ISO_TRY(iso_gbuffer_create(side, side, &s->gbuffer, error));
    return iso_image_create(side, side, &s->image, error);
}

/* The smallest sphere around `centre` with all points in it. */
static double radius_around(const iso_point_view *points, iso_vec3 centre) {
    iso_affine affine = iso_transform_affine(&points->transform);
    double most = 0;
    for (size_t k = 0; k < points->span_count; k++) {
        const iso_point_span *span = &points->spans[k];
        for (size_t i = span->first; i < span->first + span->count; i++) {
            const float *p = iso_point_view_get(points, i).position;
            iso_vec3 at = iso_vec3_make(span->brick[0] * (double)ISO_BRICK + p[0],
                                        span->brick[1] * (double)ISO_BRICK + p[1],
                                        span->brick[2] * (double)ISO_BRICK + p[2]);
            most = fmax(most, iso_vec3_length(iso_vec3_sub(iso_affine_point(&affine, at), centre)));
        }
    }
    return most;
}

/* The bumpy sphere as it is always seen; a volume's surface from the front, the left and above, as a whole.
 */
static iso_status fit(bench_subject *s, bench_view *out, iso_error *error) {
    iso_point_view points;
    ISO_TRY(bench_subject_points(s, &points, error));
    if (s->bumpy_side) {
        out->camera = (iso_camera){.position = {1.318, 0.75, 2.413}, .view_up = {0, 1, 0}, .view_angle = 38};
    } else {
        iso_affine affine = iso_transform_affine(&points.transform);
        iso_box box = iso_point_view_bounds(&points), world = iso_box_transform(&box, &affine);
        iso_vec3 centre = iso_vec3_scale(iso_vec3_add(world.lo, world.hi), 0.5);
        iso_vec3 towards = iso_vec3_make(sin(0.6) * cos(0.35), -cos(0.6) * cos(0.35), sin(0.35));
        double distance = radius_around(&points, centre) / sin(15 * ISO_PI / 180);
        out->camera = (iso_camera){.position = iso_vec3_add(centre, iso_vec3_scale(towards, distance)),
                                   .focal_point = centre,
                                   .view_up = {0, 0, 1},
                                   .view_angle = 30};
    }
    out->view = iso_view_make(&out->camera, picture_side(s), picture_side(s));
    return ISO_OK;
}

/* Covered part of the window of `side` pixels around one; `sums` has a row and a column more than the
 * picture: samples above and to the left. */
static double covered_part(const uint32_t *sums, int width, const int middle[2], int side) {
    int x0 = middle[0] - side / 2, y0 = middle[1] - side / 2, x1 = x0 + side, y1 = y0 + side;
    if (x0 < 0 || y0 < 0 || x1 > width || y1 > width) return 0;
    size_t row = (size_t)width + 1, top = (size_t)y0 * row, bottom = (size_t)y1 * row;
    uint32_t sum = sums[bottom + (size_t)x1] - sums[bottom + (size_t)x0] - sums[top + (size_t)x1] +
                   sums[top + (size_t)x0];
    return (double)sum / ((double)side * side);
}

static uint32_t *sum_samples(const iso_gbuffer *g) {
    size_t row = (size_t)g->width + 1;
    uint32_t *sums = calloc(row * ((size_t)g->height + 1), sizeof *sums);
    for (int y = 0; sums && y < g->height; y++)
        for (int x = 0; x < g->width; x++) {
            size_t at = ((size_t)y + 1) * row + (size_t)x + 1;
            uint32_t here = g->surface[(size_t)y * (size_t)g->width + (size_t)x] != ISO_SURFACE_NONE;
            sums[at] = here + sums[at - 1] + sums[at - row] - sums[at - row - 1];
        }
    return sums;
}

/* The covered pixel nearest to the middle around which a quarter and a sixteenth of the picture's side are
 * covered by half, but not wholly; the middle when there is none. */
static void find_aim(const uint32_t *sums, int side, int aim[2]) {
    double nearest = INFINITY;
    aim[0] = aim[1] = side / 2;
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++) {
            double distance = hypot(x + 0.5 - side / 2.0, y + 0.5 - side / 2.0);
            if (!(distance < nearest)) continue;
            const int here[2] = {x, y};
            double wide = covered_part(sums, side, here, side / 4);
            double close = covered_part(sums, side, here, side / 16);
            if (covered_part(sums, side, here, 1) == 0) continue;
            if (wide < 0.5 || wide > 0.95 || close < 0.5 || close > 0.95) continue;
            nearest = distance;
            aim[0] = x;
            aim[1] = y;
        }
}

static iso_status close_up(bench_subject *s, bench_view *out, iso_error *error) {
    const double zoom = 4;
    bench_view whole = {0};
    iso_point_view points;
    ISO_TRY(fit(s, &whole, error));
    ISO_TRY(bench_subject_points(s, &points, error));
    ISO_TRY(bench_subject_frame(s, error));
    iso_target target = {.view = &whole.view, .gbuffer = &s->gbuffer, .pool = s->pool};
    iso_gbuffer_clear(&s->gbuffer);
    ISO_TRY(iso_draw_points(&target, &points, error));
    uint32_t *sums = sum_samples(&s->gbuffer);
    if (!sums) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    int aim[2], side = picture_side(s);
    find_aim(sums, side, aim);
    free(sums);
    out->camera = whole.camera;
    iso_camera_zoom(&out->camera, zoom);
    out->view = iso_view_make(&out->camera, side, side);
    double *axis[2] = {&out->view.cx, &out->view.cy};
    for (int k = 0; k < 2; k++) {
        out->centre[k] = (aim[k] + 0.5 - side / 2.0) * zoom / (side / 2.0);
        *axis[k] = side / 2.0 * (1 - out->centre[k]);
    }
    return ISO_OK;
}

iso_status bench_subject_view(bench_subject *s, int number, bench_view *view, iso_error *error) {
    if (!s->aimed[number]) {
        ISO_TRY(number == 0 ? fit(s, &s->views[0], error) : close_up(s, &s->views[1], error));
        s->aimed[number] = true;
    }
    *view = s->views[number];
    return ISO_OK;
}

size_t bench_covered(const iso_gbuffer *gbuffer) {
    size_t covered = 0, samples = (size_t)gbuffer->width * (size_t)gbuffer->height;
    for (size_t i = 0; i < samples; i++) covered += gbuffer->surface[i] != ISO_SURFACE_NONE;
    return covered;
}
