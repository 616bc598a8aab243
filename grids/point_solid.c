/* point_solid: samples blocks of voxels in parallel; blocks far from all points and from the surface of
 * winding number 1/2 get one value. */
#include "grids/point_solid.h"

#include <math.h>

#include "base/memory.h"
#include "clouds/neighbours.h"
#include "grids/closing/triangle_tree.h"

enum {
    BLOCK = 4,       /* voxels along a side of a block */
    AROUND = 12,     /* points around a voxel that are averaged, at most */
    SIXTH = 6,       /* the neighbour whose distance says how far points are apart */
    CHUNK = 1024,    /* points of a task */
    MOST_SIDE = 4096 /* voxels along an axis */
};

/* Voxels within AVERAGED spacings of a point get averaged distances, those beyond WINDING the winding number;
 * between them both are mixed. WEIGHTS: the spacings within which points are averaged. */
static const float AVERAGED = 1, WINDING = 2, WEIGHTS = 2;
/* The least ratio of the distance to the planes of points to the distance to the nearest point where the
 * voxel lies straight before or behind them. */
static const float STRAIGHT = 0.5f;

typedef struct sampler {
    const char *path;
    const iso_sampling *sampling;
    size_t count;
    double origin[3]; /* of the positions, world mm */
    float (
        *positions)[3];  /* mm, relative to the origin; in the order of the view's spans, like the normals */
    float (*normals)[3]; /* unit, world */
    iso_tree tree;       /* of the positions */
    float *spacings;     /* by slot: the distance to the sixth neighbour, mm */
    iso_triangle_tree *surface; /* a triangle for each point */
    iso_rgrid *grid;
    int blocks[3];
} sampler;

static iso_status out_of_memory(const sampler *s, iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory for %zu points", s->path, s->count);
}

/* ---- points */

static iso_status take_points(sampler *s, const iso_point_view *points, iso_box *box, iso_error *error) {
    const iso_affine affine = iso_transform_affine(&points->transform);
    const iso_box index = iso_point_view_bounds(points);
    size_t next = 0;
    *box = iso_box_transform(&index, &affine);
    iso_vec3_store(box->lo, s->origin);
    s->positions = iso_alloc(s->count * sizeof *s->positions);
    s->normals = iso_alloc(s->count * sizeof *s->normals);
    s->spacings = iso_alloc(s->count * sizeof *s->spacings);
    if (!s->positions || !s->normals || !s->spacings) return out_of_memory(s, error);
    for (size_t k = 0; k < points->span_count; k++)
        for (size_t i = 0; i < points->spans[k].count; i++, next++) {
            const iso_surfel surfel = iso_point_view_get(points, points->spans[k].first + i);
            double at[3], normal[3];
            iso_vec3_store(
                iso_affine_point(&affine, iso_brick_position(points->spans[k].brick, surfel.position)), at);
            iso_vec3_store(
                iso_affine_normal(&affine, iso_vec3_make((double)surfel.normal[0], (double)surfel.normal[1],
                                                         (double)surfel.normal[2])),
                normal);
            for (int axis = 0; axis < 3; axis++) {
                s->positions[next][axis] = (float)(at[axis] - s->origin[axis]);
                s->normals[next][axis] = (float)normal[axis];
            }
        }
    return iso_tree_make((const float(*)[3])s->positions, s->count, s->sampling->pool, &s->tree, error);
}

static void measure_spacings(void *context, size_t chunk, int worker) {
    (void)worker;
    sampler *s = context;
    const size_t end = (chunk + 1) * CHUNK;
    for (size_t slot = chunk * CHUNK; slot < (end < s->count ? end : s->count); slot++) {
        iso_neighbour found[SIXTH];
        const int count = iso_tree_nearest(&s->tree, slot, SIXTH, found);
        s->spacings[slot] = count ? sqrtf(found[count - 1].square) : 0;
    }
}

/* ---- winding numbers */

/* Makes the triangle of a point: equilateral, around the point, with the area for which the point stands. Of
 * points at random places, of which there are d in a unit of area, the expected square of the distance to the
 * sixth neighbour is 6 / (pi d). */
static void make_triangle(const sampler *s, size_t slot, float vertices[3][3]) {
    static const double corners[3][2] = {{1, 0}, {-0.5, 0.8660254037844386}, {-0.5, -0.8660254037844386}};
    const iso_tree_point *point = &s->tree.points[slot];
    float u[3], v[3];
    const double spacing = (double)s->spacings[slot], area = ISO_PI / SIXTH * spacing * spacing,
                 radius = sqrt(area * 4 / (3 * sqrt(3)));
    iso_curvature_frame(s->normals[point->index], u, v);
    for (int corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
            vertices[corner][axis] =
                (float)((double)point->position[axis] + radius * (corners[corner][0] * (double)u[axis] +
                                                                  corners[corner][1] * (double)v[axis]));
}

static iso_status make_surface(sampler *s, iso_error *error) {
    iso_triangles mesh = {.vertices = iso_alloc(3 * s->count * sizeof *mesh.vertices),
                          .triangles = iso_alloc(s->count * sizeof *mesh.triangles),
                          .vertex_count = 3 * s->count,
                          .triangle_count = s->count};
    iso_status status = mesh.vertices && mesh.triangles ? ISO_OK : out_of_memory(s, error);
    for (size_t slot = 0; slot < s->count && status == ISO_OK; slot++) {
        make_triangle(s, slot, &mesh.vertices[3 * slot]);
        for (uint32_t k = 0; k < 3; k++) mesh.triangles[slot][k] = (uint32_t)(3 * slot) + k;
    }
    if (status == ISO_OK) status = iso_triangle_tree_create(&mesh, &s->surface, error);
    iso_free(mesh.vertices);
    iso_free(mesh.triangles);
    return status;
}

/* The winding number minus 1/2: above 0 inside. */
static double winding_at(const sampler *s, const float p[3]) {
    return iso_triangle_tree_winding(s->surface, iso_vec3_make((double)p[0], (double)p[1], (double)p[2])) -
           0.5;
}

/* ---- values of voxels */

/* The mean of the distances to the planes of points, above 0 behind them. `reach`: that of the weights. */
static float plane_distance(const sampler *s, const float p[3], const iso_neighbour *found, int count,
                            float reach) {
    float sum = 0, weights = 0;
    for (int i = 0; i < count; i++) {
        const iso_tree_point *point = &s->tree.points[found[i].slot];
        const float *n = s->normals[point->index], q = 1 - found[i].square / (reach * reach);
        if (!(q > 0)) continue;
        float distance = 0;
        for (int axis = 0; axis < 3; axis++) distance += n[axis] * (point->position[axis] - p[axis]);
        sum += q * q * distance;
        weights += q * q;
    }
    return weights > 0 ? sum / weights : 0;
}

static float value_at(const sampler *s, const float p[3]) {
    iso_neighbour found[AROUND];
    const int count = iso_tree_nearest_to(&s->tree, p, AROUND, found);
    const float nearest = sqrtf(found[0].square), least = 0.5f * (float)s->sampling->voxel;
    const float spacing = fmaxf(s->spacings[found[0].slot], least);
    const float far = (nearest / spacing - AVERAGED) / (WINDING - AVERAGED), share = fminf(fmaxf(far, 0), 1);
    const float plane = plane_distance(s, p, found, count, fmaxf(WEIGHTS * spacing, 1.5f * nearest));
    /* straight before or behind near points planes tell the side, too, and quickly */
    if (share == 0 || (share < 1 && fabsf(plane) > STRAIGHT * nearest)) return plane;
    return (1 - share) * plane + share * 2 * nearest * (float)winding_at(s, p);
}

/* ---- blocks */

static void position_of(const sampler *s, const int voxel[3], double shift, float p[3]) {
    for (int axis = 0; axis < 3; axis++)
        p[axis] = (float)(s->grid->transform.origin[axis] - s->origin[axis] +
                          (voxel[axis] + shift) * s->sampling->voxel);
}

/* Whether all voxels of a block have the same sign, because neither a point nor the surface of winding number
 * 1/2 can be near; `value` gets one of that sign. Where there are no points the winding number is a harmonic
 * function, which cannot change quickly. */
static bool is_uniform(const sampler *s, const int first[3], float *value) {
    const float radius = (float)(BLOCK * 0.8660254037844386 * s->sampling->voxel);
    float centre[3];
    iso_neighbour nearest;
    position_of(s, first, (BLOCK - 1) / 2.0, centre);
    iso_tree_nearest_to(&s->tree, centre, 1, &nearest);
    const float distance = sqrtf(nearest.square), beyond = distance - radius;
    if (!(beyond > WINDING * s->spacings[nearest.slot] && beyond > radius)) return false;
    const double winding = winding_at(s, centre);
    *value = (float)(2 * winding) * distance;
    return fabs(winding) > (distance > 3 * radius ? 0.3 : 0.4);
}

static void sample_block(void *context, size_t number, int worker) {
    (void)worker;
    const sampler *s = context;
    const int *dims = s->grid->dims;
    const int first[3] = {(int)(number % (size_t)s->blocks[0]) * BLOCK,
                          (int)(number / (size_t)s->blocks[0] % (size_t)s->blocks[1]) * BLOCK,
                          (int)(number / (size_t)s->blocks[0] / (size_t)s->blocks[1]) * BLOCK};
    float uniform = 0, *voxels = s->grid->data;
    if (iso_progress_cancelled(s->sampling->progress)) return;
    const bool same = is_uniform(s, first, &uniform);
    for (int z = first[2]; z < first[2] + BLOCK && z < dims[2]; z++)
        for (int y = first[1]; y < first[1] + BLOCK && y < dims[1]; y++)
            for (int x = first[0]; x < first[0] + BLOCK && x < dims[0]; x++) {
                float p[3];
                position_of(s, (int[3]){x, y, z}, 0, p);
                voxels[x + y * s->grid->stride_y + z * s->grid->stride_z] = same ? uniform : value_at(s, p);
            }
}

static iso_status create_grid(sampler *s, const iso_box *box, uint64_t max_memory, iso_error *error) {
    const double voxel = s->sampling->voxel, lo[3] = {box->lo.x, box->lo.y, box->lo.z},
                 hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    iso_transform transform = iso_transform_identity();
    iso_rgrid_desc desc = {.type = ISO_FLOAT32, .transform = &transform};
    double bytes = sizeof(float);
    for (int axis = 0; axis < 3; axis++) {
        const double side = ceil((hi[axis] - lo[axis]) / voxel) + 1 + 2 * s->sampling->margin;
        if (!(side <= MOST_SIDE))
            return iso_fail(error, ISO_ERR_LIMIT,
                            "%s: %.0f voxels along an axis, at most %d: choose larger voxels", s->path, side,
                            MOST_SIDE);
        desc.dims[axis] = (int)side;
        bytes *= side;
        transform.origin[axis] = lo[axis] - s->sampling->margin * voxel;
        transform.spacing[axis] = voxel;
        s->blocks[axis] = (desc.dims[axis] + BLOCK - 1) / BLOCK;
    }
    if (max_memory && bytes > (double)max_memory)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: the volume takes %.0f MB, limit is %.0f MB", s->path,
                        bytes / 1e6, (double)max_memory / 1e6);
    return iso_rgrid_create(&desc, &s->grid, error);
}

static iso_status sample(sampler *s, const iso_point_view *points, uint64_t max_memory, iso_error *error) {
    iso_box box;
    iso_pool *pool = s->sampling->pool;
    ISO_TRY(take_points(s, points, &box, error));
    iso_parallel_for(pool, (s->count + CHUNK - 1) / CHUNK, measure_spacings, s);
    ISO_TRY(make_surface(s, error));
    ISO_TRY(create_grid(s, &box, max_memory, error));
    iso_parallel_for(pool, (size_t)s->blocks[0] * (size_t)s->blocks[1] * (size_t)s->blocks[2], sample_block,
                     s);
    return iso_progress_tell(s->sampling->progress, s->path, 1, error);
}

static void free_sampler(sampler *s) {
    iso_free(s->positions);
    iso_free(s->normals);
    iso_free(s->spacings);
    iso_tree_free(&s->tree);
    iso_triangle_tree_destroy(s->surface);
}

iso_status iso_grid_from_points(const char *path, const iso_point_view *points, const iso_sampling *sampling,
                                uint64_t max_memory, iso_grid *grid, iso_error *error) {
    sampler s = {.path = path, .sampling = sampling, .count = iso_point_view_count(points)};
    if (!s.count) return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no points", path);
    if (!(sampling->voxel > 0))
        return iso_fail(error, ISO_ERR_USAGE, "%s: the voxel size is not above 0", path);
    const iso_status status = sample(&s, points, max_memory, error);
    free_sampler(&s);
    if (status == ISO_OK)
        *grid = (iso_grid){.rgrid = s.grid};
    else
        iso_rgrid_destroy(s.grid);
    return status;
}
