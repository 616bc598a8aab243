/* polygon_fragments: rasterizes triangles as iso_draw_mesh does, turns samples into keys, and draws them. */
#include "render/pullpush/polygon_fragments.h"

#include <math.h>

#include "base/parallel.h"
#include "render/raster/raster.h"

/* A depth interval is as long as the depth changes in two pixels, but not longer than so many radii of the
 * points it continues, or so many pixels. */
static const double MOST_RADII = 4, MOST_PIXELS = 16;

/* How far from bricks that are drawn as points the triangles of a hybrid surface continue the points, voxels:
 * less leaves gaps at the seam, more makes outlines of the mesh grow. */
static const double SEAM = 0.5;

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

iso_view iso_pyramid_view(const iso_view *strip, const iso_pyramid_layout *layout) {
    iso_view view = *strip;
    const int rows = view.above + view.height + view.below;
    view.cx -= layout->column;
    view.cy -= layout->row;
    view.above += layout->row;
    view.width = layout->width;
    view.height = layout->height;
    view.below = rows - view.above - view.height;
    return view;
}

iso_status iso_polygons_rasterize(iso_polygons *polygons, const iso_target *target,
                                  const iso_pyramid_layout *layout, iso_error *error) {
    const iso_view view = iso_pyramid_view(target->view, layout);
    polygons->projector.view = target->view; /* of a strip */
    if (polygons->picture.width != view.width || polygons->picture.height != view.height) {
        iso_gbuffer_free(&polygons->picture);
        ISO_TRY(iso_gbuffer_create(view.width, view.height, &polygons->picture, error));
    }
    iso_gbuffer_clear_bands(&polygons->picture, target->pool);
    for (size_t i = 0; i < polygons->count; i++) {
        const iso_target whole = {&view, &polygons->picture, target->pool, polygons->sets[i].surface, NULL};
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

/* Whether a sample lies at the seam: within SEAM of a brick that is drawn as points. */
static bool is_at_seam(const iso_polygon_set *set, const polygon_sample *s) {
    const iso_projector *projector = &set->choice->projector;
    const double *m = set->to_index;
    int32_t low[3], high[3]; /* the bricks within SEAM */
    for (int k = 0; k < 3; k++) {
        double at = 0;
        for (int i = 0; i < 3; i++) at += m[3 * k + i] * (s->at[i] - projector->origin[i]);
        low[k] = (int32_t)floor((at - SEAM) / ISO_BRICK);
        high[k] = (int32_t)floor((at + SEAM) / ISO_BRICK);
    }
    for (int32_t z = low[2]; z <= high[2]; z++)
        for (int32_t y = low[1]; y <= high[1]; y++)
            for (int32_t x = low[0]; x <= high[0]; x++)
                if (!iso_brick_is_large(set->choice, (int32_t[3]){x, y, z})) return true;
    return false;
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

/* The radius of a sample's disc: at seams that of points, elsewhere 0, so that the pixel has no ellipse. */
static float radius_of(const iso_polygon_set *set, const polygon_sample *s) {
    return set->choice && is_at_seam(set, s) ? (float)set->radius : 0;
}

static float interval_of(const iso_polygons *polygons, const iso_polygon_set *set, const polygon_sample *s) {
    const double rise = 2 * slope_at(polygons, s), pixel = pixel_at(polygons, s),
                 least = set->choice ? set->radius : pixel,
                 most = set->choice ? MOST_RADII * set->radius : MOST_PIXELS * pixel;
    return (float)iso_min(iso_max(least, rise), most);
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

/* Adds the sample of a pixel, if there is one that is nearer than the pixel's key. In a pyramid without
 * index, only at the seam. */
static void project_sample(const iso_polygons *polygons, const iso_pyramid *pyramid, int x, int y) {
    const iso_pyramid_level *level = &pyramid->level[0];
    const size_t index = (size_t)y * (size_t)polygons->picture.width + (size_t)x,
                 at = (size_t)y * level->stride + (size_t)x,
                 place = (size_t)y * pyramid->key_stride + (size_t)x;
    if (polygons->picture.surface[index] == ISO_SURFACE_NONE) return;
    const iso_polygon_set *set = set_of(polygons, polygons->picture.surface[index]);
    const polygon_sample s = sample_at(polygons, &pyramid->layout, x, y, index);
    if (!pyramid->index && !is_at_seam(set, &s)) return;
    const int64_t made = iso_key_of_depth(polygons->picture.depth[index]) + make_payload(polygons, &s);
    if (made >= pyramid->keys[place]) return;
    pyramid->keys[place] = made;
    if (!pyramid->index) return;
    level->plane[ISO_PLANE_RADIUS][at] = radius_of(set, &s);
    level->plane[ISO_PLANE_INTERVAL][at] = interval_of(polygons, set, &s);
    pyramid->index[place] = ISO_INDEX_NONE;
    iso_set_planes_clear(level, at, set->surface);
}

void iso_polygon_fragments_project(const iso_polygons *polygons, const iso_pyramid *pyramid, iso_rows rows) {
    for (int y = rows.first; y <= rows.last; y++)
        for (int x = 0; x < pyramid->level[0].width; x++) project_sample(polygons, pyramid, x, y);
}

/* ---- samples */

/* Whether a sample of the only set is drawn where the points have the depth `points`, mm. */
static bool is_in_front(const iso_polygons *polygons, const iso_pyramid_layout *layout, int x, int y,
                        size_t index, double points) {
    const double depth = (double)polygons->picture.depth[index];
    if (depth <= points) return true;
    const iso_polygon_set *set = &polygons->sets[0];
    if (depth > points + MOST_RADII * set->radius) return false;
    const polygon_sample s = sample_at(polygons, layout, x, y, index);
    return depth <= points + (double)interval_of(polygons, set, &s);
}

typedef struct polygon_drawing {
    const iso_polygons *polygons;
    const iso_target *target;
    const iso_pyramid_layout *layout;
} polygon_drawing;

static void draw_row(void *context, size_t row, int worker) {
    (void)worker;
    const polygon_drawing *drawing = context;
    const iso_gbuffer *from = &drawing->polygons->picture, *to = drawing->target->gbuffer;
    const uint8_t surface = drawing->target->surface;
    const int y = (int)row - drawing->layout->row;
    for (int column = 0; column < to->width; column++) {
        const int x = column - drawing->layout->column;
        const size_t index = (size_t)y * (size_t)from->width + (size_t)x,
                     at = row * (size_t)to->width + (size_t)column;
        if (from->surface[index] == ISO_SURFACE_NONE) continue;
        const float there = to->depth[at];
        if (to->surface[at] == surface
                ? !is_in_front(drawing->polygons, drawing->layout, x, y, index, (double)there)
                : !(from->depth[index] < there))
            continue;
        to->depth[at] = from->depth[index];
        for (int k = 0; k < 3; k++) to->normal[k][at] = from->normal[k][index];
        to->surface[at] = surface;
        if (to->color) to->color[at] = 0;
    }
}

void iso_polygons_draw(const iso_polygons *polygons, const iso_target *target,
                       const iso_pyramid_layout *layout) {
    polygon_drawing drawing = {polygons, target, layout};
    iso_parallel_for(target->pool, (size_t)target->gbuffer->height, draw_row, &drawing);
}
