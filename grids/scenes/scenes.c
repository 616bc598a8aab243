/* scenes: the table of scenes, those with closed-form distances, and the gyroid. */
#include "grids/scenes/scenes.h"

#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "grids/scenes/scene_parts.h"

/* A solid whose exact distance has a closed form; p is relative to the centre, in voxels. */
typedef struct solid {
    double (*distance)(double side, iso_vec3 p);
    double side, centre;
} solid;

static double sphere_distance(double side, iso_vec3 p) {
    return iso_vec3_length(p) - 0.4 * side;
}

static double cylinder_distance(double side, iso_vec3 p) {
    const double radius = 0.2 * side, half_height = 0.32 * side;
    iso_vec3 axis = iso_vec3_unit(iso_vec3_make(0.35, 0.25, 0.9));
    double height = iso_vec3_dot(p, axis);
    double out = iso_vec3_length(iso_vec3_sub(p, iso_vec3_scale(axis, height))) - radius;
    double up = fabs(height) - half_height;
    if (out <= 0 || up <= 0) return iso_max(out, up);
    return sqrt(out * out + up * up);
}

static double cube_distance(double side, iso_vec3 p) {
    double half = 0.4 * side;
    iso_vec3 q = iso_vec3_make(fabs(p.x) - half, fabs(p.y) - half, fabs(p.z) - half);
    double inside = iso_max(q.x, iso_max(q.y, q.z));
    if (inside <= 0) return inside;
    return iso_vec3_length(iso_vec3_make(iso_max(q.x, 0), iso_max(q.y, 0), iso_max(q.z, 0)));
}

static double torus_distance(double side, iso_vec3 p) {
    double ring = sqrt(p.x * p.x + p.y * p.y) - 0.3 * side;
    return sqrt(ring * ring + p.z * p.z) - 0.1 * side;
}

static double solid_distance(const solid *s, double x, double y, double z) {
    return s->distance(s->side, iso_vec3_make(x - s->centre, y - s->centre, z - s->centre));
}

/* Classifies a cell by the distance at its centre: within the cell, distances change by at most half its
 * diagonal. */
static int32_t solid_classify(const void *self, const int cell[3]) {
    const double half_diagonal = 7.5 * 1.7320508075688774, slack = 1e-6;
    double d =
        solid_distance(self, cell[0] * ISO_BRICK + 7.5, cell[1] * ISO_BRICK + 7.5, cell[2] * ISO_BRICK + 7.5);
    if (fabs(d) <= half_diagonal + ISO_SCENE_BAND + slack) return 0;
    return d > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
}

static void solid_fill(const void *self, const int cell[3], void *scratch, float *brick) {
    (void)scratch;
    for (int z = 0; z < ISO_BRICK; z++)
        for (int y = 0; y < ISO_BRICK; y++)
            for (int x = 0; x < ISO_BRICK; x++) {
                double d = solid_distance(self, cell[0] * ISO_BRICK + x, cell[1] * ISO_BRICK + y,
                                          cell[2] * ISO_BRICK + z);
                d = d > ISO_SCENE_BAND ? ISO_SCENE_BAND : d < -ISO_SCENE_BAND ? -ISO_SCENE_BAND : d;
                *brick++ = (float)d;
            }
}

static iso_status make_solid(double (*distance)(double, iso_vec3), const iso_scene_opts *opts, iso_grid *grid,
                             iso_error *error) {
    solid s = {.distance = distance, .side = opts->size, .centre = opts->size / 2 - 0.5};
    iso_scene_solid scene_solid = {
        .size = opts->size, .self = &s, .classify = solid_classify, .fill = solid_fill};
    return iso_scene_build(&scene_solid, opts, grid, error);
}

static iso_status make_sphere(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    return make_solid(sphere_distance, opts, grid, error);
}

static iso_status make_cylinder(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    return make_solid(cylinder_distance, opts, grid, error);
}

static iso_status make_cube(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    return make_solid(cube_distance, opts, grid, error);
}

static iso_status make_torus(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    return make_solid(torus_distance, opts, grid, error);
}

typedef struct gyroid {
    int size;
    const double *sines;
    float *voxels;
} gyroid;

static void gyroid_slice(void *context, size_t z, int worker) {
    (void)worker;
    const gyroid *field = context;
    const double *s = field->sines;
    float *out = field->voxels + z * (size_t)field->size * (size_t)field->size;
    double sz = s[2 * z], cz = s[2 * z + 1];
    for (int y = 0; y < field->size; y++) {
        double sy = s[2 * y], cy = s[2 * y + 1];
        for (int x = 0; x < field->size; x++) *out++ = (float)(s[2 * x] * cy + sy * cz + sz * s[2 * x + 1]);
    }
}

static iso_status make_gyroid(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    iso_rgrid_desc desc = {.dims = {opts->size, opts->size, opts->size}, .type = ISO_FLOAT32};
    iso_scene_axis axis = {.rate = 3 * 2 * ISO_PI / opts->size, .count = opts->size};
    double *sines = iso_alloc(2 * (size_t)opts->size * sizeof *sines);
    if (!sines) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a gyroid");
    iso_scene_sines(&axis, sines);
    iso_status status = iso_rgrid_create(&desc, &grid->rgrid, error);
    if (status == ISO_OK) {
        gyroid field = {opts->size, sines, grid->rgrid->data};
        iso_parallel_for(opts->pool, (size_t)opts->size, gyroid_slice, &field);
    }
    iso_free(sines);
    return status;
}

typedef struct scene {
    const char *name;
    int size;
    double isovalue;
    iso_status (*make)(const iso_scene_opts *opts, iso_grid *grid, iso_error *error);
} scene;

static const scene scenes[] = {
    {"sphere", 64, 0, make_sphere},   {"cylinder", 64, 0, make_cylinder},
    {"cube", 32, 0, make_cube},       {"gyroid", 128, 0, make_gyroid},
    {"torus", 128, 0, make_torus},    {"ct", 128, 127.5, iso_scene_ct},
    {"head", 128, 0, iso_scene_head}, {"organs", 128, 0.5, iso_scene_organs},
};
enum { SCENES = sizeof scenes / sizeof scenes[0] };

const char *const *iso_scene_names(void) {
    static const char *const names[] = {"sphere", "cylinder", "cube",   "gyroid", "torus",
                                        "ct",     "head",     "organs", NULL};
    _Static_assert(sizeof names / sizeof names[0] == SCENES + 1, "one name a scene");
    return names;
}

iso_status iso_scene_create(const char *name, const iso_scene_opts *opts, iso_grid *out, double *isovalue,
                            iso_error *error) {
    const scene *found = NULL;
    for (int i = 0; i < SCENES; i++)
        if (strcmp(scenes[i].name, name) == 0) found = &scenes[i];
    if (!found)
        return iso_fail(error, ISO_ERR_USAGE,
                        "no scene '%s'; there are sphere, cylinder, cube, gyroid, torus, ct, head, organs",
                        name);
    iso_scene_opts all = opts ? *opts : (iso_scene_opts){0};
    if (all.size == 0) all.size = found->size;
    if (all.size < 16 || all.size > ISO_HGRID_MAX)
        return iso_fail(error, ISO_ERR_USAGE, "scene '%s': size %d is not in 16..%d", name, all.size,
                        ISO_HGRID_MAX);
    iso_grid grid = {0};
    ISO_TRY(found->make(&all, &grid, error));
    *out = grid;
    if (isovalue) *isovalue = found->isovalue;
    return ISO_OK;
}
