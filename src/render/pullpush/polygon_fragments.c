/* polygon_fragments: rasterizes triangles as iso_draw_mesh does, and turns samples into keys. */
#include "render/pullpush/polygon_fragments.h"

#include <math.h>
#include <string.h>

#include "render/raster/raster.h"

/* A depth interval is as long as the depth changes in two pixels, but not longer than so many radii of the
 * points it blends with, or so many pixels. */
static const double MOST_RADII = 4, MOST_PIXELS = 16;

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

bool iso_brick_is_large(const iso_brick_choice *choice, const int32_t brick[3]) {
    const float middle[3] = {ISO_BRICK / 2.0f, ISO_BRICK / 2.0f, ISO_BRICK / 2.0f};
    const iso_vec3 at = iso_projector_point(&choice->projector, brick, middle);
    const double *m = choice->projector.matrix;
    double half = 0; /* of the brick's depth */
    for (int k = 0; k < 3; k++) half += 0.5 * ISO_BRICK * fabs(m[6 + k]);
    const double nearest = at.z - half;
    if (choice->projector.view->orthographic)
        return choice->cell * choice->projector.view->focal > choice->pixels;
    return !(nearest > 0) || choice->cell * choice->projector.view->focal > choice->pixels * nearest;
}

iso_status iso_polygons_rasterize(iso_polygons *polygons, const iso_target *target,
                                  const iso_pyramid_layout *layout, iso_error *error) {
    iso_view view = *target->view;
    polygons->projector.view = target->view; /* of a strip */
    const int rows = view.above + view.height + view.below;
    view.cx -= layout->column;
    view.cy -= layout->row;
    view.above += layout->row;
    view.width = layout->width;
    view.height = layout->height;
    view.below = rows - view.above - view.height;
    if (polygons->picture.width != view.width || polygons->picture.height != view.height) {
        iso_gbuffer_free(&polygons->picture);
        ISO_TRY(iso_gbuffer_create(view.width, view.height, &polygons->picture, error));
    }
    iso_gbuffer_clear_bands(&polygons->picture, target->pool);
    for (size_t i = 0; i < polygons->count; i++) {
        const iso_target whole = {&view, &polygons->picture, target->pool, polygons->sets[i].surface};
        ISO_TRY(iso_draw_mesh(&whole, polygons->sets[i].mesh, error));
    }
    return ISO_OK;
}

/* ---- fragments */

/* A fragment's place: view space, relative to nothing, and the ray through it. */
typedef struct polygon_sample {
    double ray[3], at[3]; /* of depth 1 (orthographic: the direction); view space, mm */
    double normal[3];
} polygon_sample;

static polygon_sample sample_at(const iso_polygons *polygons, const iso_pyramid_layout *layout, int x, int y,
                                size_t index) {
    const iso_view *view = polygons->projector.view;
    const iso_gbuffer *g = &polygons->picture;
    const double z = (double)g->depth[index], column = (x + 0.5 - (view->cx - layout->column)) / view->focal,
                 row = (y + 0.5 - (view->cy - layout->row)) / view->focal;
    polygon_sample s = {.ray = {0, 0, 1}, .at = {column, row, z}};
    for (int k = 0; k < 2 && !view->orthographic; k++) {
        s.ray[k] = k ? row : column;
        s.at[k] *= z;
    }
    for (int k = 0; k < 3; k++) s.normal[k] = (double)g->normal[k][index];
    return s;
}

/* How near a place of a brick is to bricks that are drawn as points: 1 at their border, 0 from a voxel on. */
static double nearness(const iso_polygon_set *set, const polygon_sample *s) {
    const iso_projector *projector = &set->choice->projector;
    const double *m = set->to_index;
    double local[3], most = 0;
    int32_t brick[3];
    for (int k = 0; k < 3; k++) {
        double at = 0;
        for (int i = 0; i < 3; i++) at += m[3 * k + i] * (s->at[i] - projector->origin[i]);
        const double whole = floor(at / ISO_BRICK);
        brick[k] = (int32_t)whole;
        local[k] = at - whole * ISO_BRICK;
    }
    for (int way = 0; way < 27; way++) {
        const int step[3] = {way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1};
        const int32_t other[3] = {brick[0] + step[0], brick[1] + step[1], brick[2] + step[2]};
        double distance = 0;
        for (int k = 0; k < 3; k++) {
            const double away = step[k] < 0 ? local[k] : step[k] > 0 ? ISO_BRICK - local[k] : 0;
            distance = iso_max(distance, away);
        }
        if (1 - distance > most && !iso_brick_is_large(set->choice, other)) most = 1 - distance;
    }
    return most;
}

/* A pixel's size at a sample, mm. */
static double pixel_at(const iso_polygons *polygons, const polygon_sample *s) {
    const iso_view *view = polygons->projector.view;
    return view->orthographic ? 1 / view->focal : s->at[2] / view->focal;
}

/* How much the depth changes from a pixel to the next, mm. */
static double slope_at(const iso_polygons *polygons, const polygon_sample *s) {
    const double along = s->normal[0] * s->ray[0] + s->normal[1] * s->ray[1] + s->normal[2] * s->ray[2],
                 beside = iso_max(fabs(s->normal[0]), fabs(s->normal[1]));
    return pixel_at(polygons, s) * beside / iso_max(fabs(along), 1e-6);
}

/* Bits 0 .. 31 of a key: the normal, and the middle of the pixel. */
static uint32_t make_payload(const iso_polygons *polygons, const polygon_sample *s) {
    iso_surfel surfel = {.position = {0}};
    double n[3];
    for (int k = 0; k < 3; k++) {
        n[k] = 0;
        for (int i = 0; i < 3; i++) n[k] += (double)polygons->normal[3 * k + i] * s->normal[i];
    }
    const double length = length_of(n);
    for (int k = 0; k < 3; k++) surfel.normal[k] = (float)(length > 0 ? n[k] / length : k == 2);
    return (uint32_t)(iso_point_pack(&surfel).bits >> 42) | 16u << 22 | 16u << 27;
}

/* Radius and interval of a sample: without blending the radius is 0, so that the pixel has no ellipse. */
static void set_extent(const iso_polygons *polygons, const iso_polygon_set *set, const polygon_sample *s,
                       float *radius, float *interval) {
    const double rise = 2 * slope_at(polygons, s);
    if (set->choice) {
        *radius = (float)(set->radius * nearness(set, s));
        *interval = (float)iso_min(iso_max(set->radius, rise), MOST_RADII * set->radius);
    } else {
        const double pixel = pixel_at(polygons, s);
        *radius = 0;
        *interval = (float)iso_min(iso_max(pixel, rise), MOST_PIXELS * pixel);
    }
}

/* The planes that only a pyramid of several sets has, at a pixel that shows no ribbon. */
void iso_set_planes_clear(const iso_pyramid_level *level, size_t at, int set) {
    for (int p = ISO_PLANE_SHAPE_XX; p <= ISO_PLANE_ROOM; p++) level->plane[p][at] = 0;
    for (int p = ISO_PLANE_RED; p <= ISO_PLANE_BLUE && level->plane[p]; p++) level->plane[p][at] = 0;
    level->plane[ISO_PLANE_SET][at] = (float)set;
}

static const iso_polygon_set *set_of(const iso_polygons *polygons, uint8_t surface) {
    const iso_polygon_set *set = polygons->sets;
    while (set->surface != surface) set++;
    return set;
}

/* Adds the sample of a pixel, if there is one that is nearer than the pixel's key. */
static void project_sample(const iso_polygons *polygons, const iso_pyramid *pyramid, int x, int y) {
    const iso_pyramid_level *level = &pyramid->level[0];
    const size_t index = (size_t)y * (size_t)polygons->picture.width + (size_t)x,
                 at = (size_t)y * level->stride + (size_t)x,
                 place = (size_t)y * pyramid->key_stride + (size_t)x;
    if (polygons->picture.surface[index] == ISO_SURFACE_NONE) return;
    int32_t depth;
    memcpy(&depth, &polygons->picture.depth[index], sizeof depth);
    depth ^= depth >> 31 & INT32_MAX;
    const polygon_sample s = sample_at(polygons, &pyramid->layout, x, y, index);
    const int64_t made = (int64_t)depth * ((int64_t)1 << 32) + make_payload(polygons, &s);
    if (made >= pyramid->keys[place]) return;
    const iso_polygon_set *set = set_of(polygons, polygons->picture.surface[index]);
    pyramid->keys[place] = made;
    set_extent(polygons, set, &s, level->plane[ISO_PLANE_RADIUS] + at, level->plane[ISO_PLANE_INTERVAL] + at);
    if (!pyramid->index) return;
    pyramid->index[place] = ISO_INDEX_NONE;
    iso_set_planes_clear(level, at, set->surface);
}

void iso_polygon_fragments_project(const iso_polygons *polygons, const iso_pyramid *pyramid, iso_rows rows) {
    const iso_pyramid_level *level = &pyramid->level[0];
    for (int y = rows.first; y <= rows.last; y++) {
        const size_t at = (size_t)y * level->stride;
        for (int x = 0; x < level->width; x++) {
            if (!pyramid->index)
                level->plane[ISO_PLANE_RADIUS][at + (size_t)x] =
                    level->plane[ISO_PLANE_INTERVAL][at + (size_t)x] = (float)polygons->sets[0].radius;
            project_sample(polygons, pyramid, x, y);
        }
    }
}
