/* traced_glass: a small ray tracer for one transparent solid (Whitted 1980, "An improved illumination model
 * for shaded display"), whose surface is found by grids/ray. */
#include "truth/traced_glass.h"

#include <math.h>

#include "truth/raycaster.h"

/* ---- paths */

/* A ray and the share of its light that reaches the eye. */
typedef struct path {
    iso_vec3 origin, ray; /* ray: unit length */
    double from;          /* the ray begins at origin + from * ray, mm */
    double weight[3];     /* by colour */
    int boundaries;       /* that were met on the way from the eye */
} path;

/* What is being computed for a sample. Of two paths from a boundary one waits while the other is followed;
 * paths that wait have met different numbers of boundaries, so that there are never more than this. */
typedef struct tracing {
    const iso_traced_glass *traced;
    path waiting[ISO_GLASS_BOUNDARIES + 1];
    int count;
    double sum[3];
} tracing;

/* A crossing on a path. */
typedef struct boundary {
    iso_vec3 point, normal; /* normal: against the ray */
    bool leaves;            /* the ray comes from the solid */
} boundary;

/* Rays that continue from a crossing begin this far from it, as a part of the smallest voxel's side: far
 * above rounding errors, and so near that nothing of the surface lies between. */
static const double STEP_OFF = 1e-4;

/* Adds what the environment sends along a path. */
static void add_environment(tracing *t, const path *p) {
    double light[3];
    iso_environment_look(t->traced->glass->environment, p->ray, light);
    for (int k = 0; k < 3; k++) t->sum[k] += p->weight[k] * light[k];
}

/* Lets a path wait, or ends it when it carries too little light or is too long. */
static void push(tracing *t, const path *p) {
    const double most = fmax(p->weight[0], fmax(p->weight[1], p->weight[2]));
    if (most < ISO_GLASS_CUT || p->boundaries >= ISO_GLASS_BOUNDARIES)
        add_environment(t, p);
    else
        t->waiting[t->count++] = *p;
}

/* ---- one path */

/* Takes a path to its next crossing, through what it meets of the solid; false: it leaves the volume. */
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

/* The path that continues from a boundary in direction `ray` with a share of the light. */
static path continue_path(const tracing *t, const path *p, const boundary *at, iso_vec3 ray, double share) {
    path next = {.origin = at->point,
                 .ray = ray,
                 .from = STEP_OFF * t->traced->caster->voxel,
                 .boundaries = p->boundaries + 1};
    for (int k = 0; k < 3; k++) next.weight[k] = p->weight[k] * share;
    return next;
}

/* Splits a path at a boundary into a reflected and a refracted one. Interpolated normals differ a little
 * from the surface's: seen from behind by one, the boundary does not bend the ray. */
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
    iso_parallel_for(pool, (size_t)map->view->height, cast_row, &cast);
}
