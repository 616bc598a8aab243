/* distance: a tree over triangles finds where to look; of a field, the surface in the cells of the
 * triangles that may be nearest decides. */
#include "grids/distance/distance.h"

#include "base/memory.h"
#include "grids/closing/triangle_tree.h"
#include "grids/distance/cell_patch.h"

/* How much farther than measured at a few places the surface of a cell may be from its triangles; and at
 * least, in voxels: triangles are stored in floats. */
static const double SLACK_FACTOR = 1.5, SLACK_LEAST = 1e-3;

enum { TRIANGLES_PER_TASK = 4096 };

struct iso_distance {
    iso_triangle_tree *tree; /* of a field relative to its origin, to keep floats small */
    bool is_field;
    iso_grid grid;
    iso_affine affine;
    double isovalue; /* stored */
};

/* ---- the surface in a triangle's cell */

/* The cell that a triangle lies in, and its surface. False: it is none. */
static bool find_patch(const iso_distance *d, size_t triangle, int cell[3], iso_cell_patch *patch) {
    const iso_tree_triangle *t = iso_triangle_tree_get(d->tree, triangle);
    double sum[3] = {0}, corners[8];
    for (int k = 0; k < 9; k++) sum[k % 3] += (double)t->corners[k / 3][k % 3] / 3;
    const iso_vec3 middle = iso_affine_vector_to_index(&d->affine, iso_vec3_make(sum[0], sum[1], sum[2]));
    const double index[3] = {middle.x, middle.y, middle.z};
    for (int axis = 0; axis < 3; axis++) {
        const int last = iso_grid_dims(&d->grid)[axis] - 2;
        if (last < 0) return false;
        cell[axis] = index[axis] < 0 ? 0 : index[axis] > last ? last : (int)index[axis];
    }
    for (int i = 0; i < 8; i++) {
        corners[i] =
            (double)iso_grid_at(&d->grid, cell[0] + (i & 1), cell[1] + (i >> 1 & 1), cell[2] + (i >> 2)) -
            d->isovalue;
        if (!isfinite(corners[i])) return false;
    }
    *patch = iso_cell_patch_make(corners, d->affine.m);
    return true;
}

/* A position relative to the grid's origin, mm, as one in a cell. */
static void to_cell(const iso_distance *d, const int cell[3], iso_vec3 place, double at[3]) {
    const iso_vec3 index = iso_affine_vector_to_index(&d->affine, place);
    at[0] = index.x - cell[0];
    at[1] = index.y - cell[1];
    at[2] = index.z - cell[2];
}

static float slack_of(const iso_distance *d, size_t triangle) {
    /* the middle of a triangle, and of its sides */
    static const double weights[4][3] = {
        {1 / 3.0, 1 / 3.0, 1 / 3.0}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}};
    const iso_tree_triangle *t = iso_triangle_tree_get(d->tree, triangle);
    iso_cell_patch patch;
    int cell[3];
    if (!find_patch(d, triangle, cell, &patch)) return 0;
    double most = 0;
    for (int i = 0; i < 4; i++) {
        double sum[3] = {0}, at[3];
        for (int k = 0; k < 9; k++) sum[k % 3] += weights[i][k / 3] * (double)t->corners[k / 3][k % 3];
        to_cell(d, cell, iso_vec3_make(sum[0], sum[1], sum[2]), at);
        most = fmax(most, iso_cell_patch_offset(&patch, at));
    }
    const double voxel = sqrt(fmax(patch.metric[0], fmax(patch.metric[4], patch.metric[8])));
    return (float)(SLACK_FACTOR * most + SLACK_LEAST * voxel);
}

typedef struct slack_search {
    const iso_distance *distance;
    float *slack; /* by triangle */
} slack_search;

static void find_slack(void *context, size_t index, int worker) {
    (void)worker;
    const slack_search *s = context;
    const size_t first = index * TRIANGLES_PER_TASK, count = iso_triangle_tree_count(s->distance->tree);
    for (size_t i = first; i < first + TRIANGLES_PER_TASK && i < count; i++)
        s->slack[i] = slack_of(s->distance, i);
}

/* ---- creating */

static iso_status create_tree(const iso_triangles *mesh, iso_distance *d, iso_error *error) {
    if (!mesh->triangle_count) return iso_fail(error, ISO_ERR_EMPTY, "there is no surface to measure from");
    return iso_triangle_tree_create(mesh, &d->tree, error);
}

iso_status iso_distance_of_mesh(const iso_triangles *mesh, iso_distance **distance, iso_error *error) {
    iso_distance *d = iso_alloc_zero(1, sizeof *d);
    if (!d) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances");
    const iso_status status = create_tree(mesh, d, error);
    if (status != ISO_OK)
        iso_distance_destroy(d);
    else
        *distance = d;
    return status;
}

/* The mesh in mm, relative to the grid's origin. */
static iso_status create_field_tree(const iso_triangles *mesh, iso_distance *d, iso_error *error) {
    iso_triangles placed = *mesh;
    placed.vertices = iso_alloc((mesh->vertex_count ? mesh->vertex_count : 1) * sizeof *placed.vertices);
    if (!placed.vertices) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances");
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *v = mesh->vertices[i];
        const iso_vec3 place =
            iso_affine_vector(&d->affine, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
        placed.vertices[i][0] = (float)place.x;
        placed.vertices[i][1] = (float)place.y;
        placed.vertices[i][2] = (float)place.z;
    }
    const iso_status status = create_tree(&placed, d, error);
    iso_free(placed.vertices);
    return status;
}

static iso_status create_field(const iso_triangles *mesh, iso_pool *pool, iso_distance *d, iso_error *error) {
    ISO_TRY(create_field_tree(mesh, d, error));
    const size_t count = iso_triangle_tree_count(d->tree);
    slack_search search = {d, iso_alloc(count * sizeof *search.slack)};
    if (!search.slack) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances");
    iso_parallel_for(pool, (count + TRIANGLES_PER_TASK - 1) / TRIANGLES_PER_TASK, find_slack, &search);
    const iso_status status = iso_triangle_tree_set_slack(d->tree, search.slack, error);
    iso_free(search.slack);
    return status;
}

iso_status iso_distance_of_field(const iso_grid *grid, double isovalue, const iso_triangles *mesh,
                                 iso_pool *pool, iso_distance **distance, iso_error *error) {
    iso_distance *d = iso_alloc_zero(1, sizeof *d);
    if (!d) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances");
    d->is_field = true;
    d->grid = *grid;
    d->affine = iso_transform_affine(iso_grid_transform(grid));
    d->isovalue = iso_grid_stored(grid, isovalue);
    const iso_status status = create_field(mesh, pool, d, error);
    if (status != ISO_OK)
        iso_distance_destroy(d);
    else
        *distance = d;
    return status;
}

void iso_distance_destroy(iso_distance *distance) {
    if (!distance) return;
    iso_triangle_tree_destroy(distance->tree);
    iso_free(distance);
}

/* ---- distances */

/* A search for the nearest point of a field's surface. */
typedef struct field_search {
    const iso_distance *distance;
    iso_vec3 p;  /* relative to the grid's origin */
    size_t best; /* the triangle of the nearest point so far */
} field_search;

/* Replaces the distance of a triangle by that of the surface in its cell, which starts at the triangle's
 * nearest point. */
static double refine(const field_search *s, size_t triangle, iso_vec3 start) {
    iso_cell_patch patch;
    int cell[3];
    double p[3], at[3];
    if (!find_patch(s->distance, triangle, cell, &patch)) return INFINITY;
    to_cell(s->distance, cell, s->p, p);
    to_cell(s->distance, cell, start, at);
    return iso_cell_patch_nearest(&patch, p, at);
}

/* iso_triangle_tree_search's visit; *limit is the least distance so far. */
static void visit(void *context, size_t triangle, iso_vec3 nearest, double *limit) {
    field_search *s = context;
    const double found = refine(s, triangle, nearest);
    if (!(found < *limit)) return;
    *limit = found;
    s->best = triangle;
}

static double field_distance(const iso_distance *d, iso_vec3 point, size_t *near) {
    const double *o = d->affine.origin;
    field_search s = {d, iso_vec3_sub(point, iso_vec3_make(o[0], o[1], o[2])), *near};
    const iso_vec3 start = iso_triangle_nearest(iso_triangle_tree_get(d->tree, *near)->corners, s.p);
    double distance = refine(&s, *near, start);
    iso_triangle_tree_search(d->tree, s.p, &distance, visit, &s);
    *near = s.best;
    return distance;
}

static bool is_inside_field(const iso_distance *d, iso_vec3 point) {
    const iso_vec3 index = iso_affine_point_to_index(&d->affine, point);
    const double p[3] = {index.x, index.y, index.z};
    for (int axis = 0; axis < 3; axis++)
        if (!(p[axis] >= 0 && p[axis] <= iso_grid_dims(&d->grid)[axis] - 1)) return false;
    const double value = iso_grid_sample(&d->grid, index);
    if (isnan(value)) return false;
    return iso_grid_is_level_set(&d->grid) ? value < d->isovalue : value >= d->isovalue;
}

bool iso_distance_is_inside(const iso_distance *d, iso_vec3 point) {
    return d->is_field ? is_inside_field(d, point) : fabs(iso_triangle_tree_winding(d->tree, point)) > 0.5;
}

static double mesh_distance(const iso_distance *d, iso_vec3 point, size_t *near) {
    iso_nearest nearest = {.squared = INFINITY, .triangle = *near};
    iso_triangle_tree_nearest(d->tree, point, &nearest);
    *near = nearest.triangle;
    return sqrt(nearest.squared);
}

double iso_distance_at(const iso_distance *d, iso_vec3 point, size_t *near) {
    const double distance = d->is_field ? field_distance(d, point, near) : mesh_distance(d, point, near);
    return iso_distance_is_inside(d, point) ? -distance : distance;
}
