/* traced_glass: a small ray tracer for one transparent solid (Whitted 1980, "An improved illumination model
 * for shaded display"), whose surface is found by grids/ray. */
#include "truth/traced_glass.h"

#include <math.h>

#include "truth/raycaster.h"

/* ---- paths */

/* A ray and the share of its light that reaches the eye. */
typedef struct path {
    iso_vec3 origin, ray; /* `ray`: unit vector, the path's direction */
    double from;          /* the ray begins at origin + from * ray, mm */
    double weight[3];     /* share of the light, for red, green and blue */
    int boundaries;       /* number of boundaries between the eye and this path */
} path;

/* The state of one sample. At a boundary one of the two new paths is followed and the other waits. Waiting
 * paths all have different numbers of boundaries, so there are never more of them than the array holds. */
typedef struct tracing {
    const iso_traced_glass *traced;
    path waiting[ISO_GLASS_BOUNDARIES + 1];
    int count;
    double sum[3];
} tracing;

/* A crossing of a path with the surface. */
typedef struct boundary {
    iso_vec3 point, normal; /* `normal` points against the ray */
    bool leaves;            /* the ray leaves the solid */
} boundary;

/* A path that continues from a crossing starts this far from it, as a share of the smallest voxel side. This
 * is far more than the rounding error, and so little that no other crossing lies in between. */
static const double STEP_OFF = 1e-4;

/* Adds the light of the environment in the path's direction to the sample. */
static void add_environment(tracing *t, const path *p) {
    double light[3];
    iso_environment_look(t->traced->glass->environment, p->ray, light);
    for (int k = 0; k < 3; k++) t->sum[k] += p->weight[k] * light[k];
}

/* Queues a path, or ends it with the environment's light if it carries too little light or has met too many
 * boundaries. */
static void push(tracing *t, const path *p) {
    const double most = fmax(p->weight[0], fmax(p->weight[1], p->weight[2]));
    if (most < ISO_GLASS_CUT || p->boundaries >= ISO_GLASS_BOUNDARIES)
        add_environment(t, p);
    else
        t->waiting[t->count++] = *p;
}

/* ---- one path */

/* Follows a path to its next crossing and absorbs light inside the solid on the way. Returns false when the
 * path leaves the volume instead. */
static bool find_boundary(const tracing *t, path *p, boundary *found) {
    const iso_raycaster *caster = t->traced->caster;
    iso_ray ray;
    iso_ray_hit hit;
    found->leaves = false;
    if (!iso_ray_start(caster->tracer, p->origin, p->ray, p->from, &ray)) return false;
    const double begin = ray.t, end = iso_ray_end(caster->tracer, &ray);
    const bool starts_inside = iso_ray_starts_above(caster->tracer, &ray) != caster->level_set;
    const bool hits = iso_ray_next(caster->tracer, &ray, &hit);
    found->leaves = hits ? hit.falls != caster->level_set : starts_inside;
    if (found->leaves) iso_glass_absorb(t->traced->glass, (hits ? hit.t : end) - begin, p->weight);
    if (!hits) return false;
    const iso_vec3 normal = iso_ray_hit_normal(caster->tracer, &ray, &hit);
    found->point = iso_vec3_add(p->origin, iso_vec3_scale(p->ray, hit.t));
    found->normal = found->leaves ? iso_vec3_scale(normal, -1) : normal;
    return true;
}

/* Returns the path that continues from a boundary in direction `ray` with a share of the light. */
static path continue_path(const tracing *t, const path *p, const boundary *at, iso_vec3 ray, double share) {
    path next = {.origin = at->point,
                 .ray = ray,
                 .from = STEP_OFF * t->traced->caster->voxel,
                 .boundaries = p->boundaries + 1};
    for (int k = 0; k < 3; k++) next.weight[k] = p->weight[k] * share;
    return next;
}

/* Splits a path at a boundary into a reflected and a refracted one. Interpolated normals differ a little from
 * the surface's true normals: a ray that arrives from behind such a normal continues unbent. */
static void split_path(tracing *t, const path *p, const boundary *at) {
    const double ior = t->traced->glass->ior, cosine = -iso_vec3_dot(p->ray, at->normal);
    iso_vec3 refracted = p->ray;
    if (cosine <= 0) {
        const path straight = continue_path(t, p, at, p->ray, 1);
        push(t, &straight);
        return;
    }
    double share = 1;
    const iso_vec3 reflected = iso_glass_reflect(p->ray, at->normal);
    const bool passes = iso_glass_refract(p->ray, at->normal, at->leaves ? ior : 1 / ior, &refracted);
    if (passes)
        share = iso_glass_reflectance(ior, at->leaves ? -iso_vec3_dot(refracted, at->normal) : cosine);
    const path mirrored = continue_path(t, p, at, reflected, share);
    if (share > 0) push(t, &mirrored);
    if (!passes) return;
    const path bent = continue_path(t, p, at, refracted, 1 - share);
    push(t, &bent);
}

bool iso_traced_glass_light(const void *context, int x, int y, double rgb[3]) {
    const iso_traced_glass *traced = context;
    tracing t = {.traced = traced};
    path p = {.weight = {1, 1, 1}};
    boundary at;
    iso_vec3 direction;
    iso_view_ray(traced->view, x + 0.5, y + 0.5, &p.origin, &direction);
    const double length = iso_vec3_length(direction);
    p.ray = iso_vec3_scale(direction, 1 / length);
    p.from = traced->view->near * length;
    if (!find_boundary(&t, &p, &at)) {
        if (!at.leaves) return false;
        add_environment(&t, &p);
    } else {
        split_path(&t, &p, &at);
    }
    while (t.count > 0) {
        p = t.waiting[--t.count];
        if (find_boundary(&t, &p, &at))
            split_path(&t, &p, &at);
        else
            add_environment(&t, &p);
    }
    for (int k = 0; k < 3; k++) rgb[k] = t.sum[k];
    return true;
}

/* ---- maps */

typedef struct map_cast {
    const iso_raycaster *caster;
    const iso_glass_map *map;
} map_cast;

static iso_glass_crossings cast_sample(const map_cast *cast, int x, int y) {
    const iso_raycaster *caster = cast->caster;
    const iso_view *view = cast->map->view;
    iso_vec3 origin, direction;
    iso_ray ray;
    iso_ray_hit hit;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    if (!iso_ray_start(caster->tracer, origin, direction, view->near, &ray))
        return iso_glass_crossings_begin(0, false);
    bool inside = iso_ray_starts_above(caster->tracer, &ray) != caster->level_set;
    const double end = iso_ray_end(caster->tracer, &ray);
    const float length = (float)iso_vec3_length(direction);
    double reached = ray.t;
    iso_glass_crossings c = iso_glass_crossings_begin((float)reached, inside);
    while (iso_ray_next(caster->tracer, &ray, &hit)) {
        const iso_vec3 n = iso_view_vector(view, iso_ray_hit_normal(caster->tracer, &ray, &hit));
        const float normal[3] = {(float)n.x, (float)n.y, (float)n.z};
        inside = hit.falls == caster->level_set;
        iso_glass_crossings_add(&c, (float)reached, (float)hit.t, length, !inside, normal);
        reached = hit.t;
    }
    if (inside) c.thickness += (float)(end - reached) * length;
    return c;
}

static void cast_row(void *context, size_t row, int worker) {
    (void)worker;
    const map_cast *cast = context;
    const int width = cast->map->view->width;
    for (int x = 0; x < width; x++)
        cast->map->crossings[(ptrdiff_t)row * width + x] = cast_sample(cast, x, (int)row);
}

void iso_raycast_map_glass(const iso_raycaster *caster, const iso_glass_map *map, iso_pool *pool) {
    map_cast cast = {caster, map};
    iso_parallel_until(pool, (size_t)map->view->height, cast_row, &cast);
}
