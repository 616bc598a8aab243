/* normals: directions by principal component analysis, refined by quadratic functions; signs by Kruskal's
 * algorithm, with sets of points that know the signs of their members relative to each other. */
#include "clouds/normals.h"

#include <math.h>
#include <stdbool.h>

#include "base/geometry.h"
#include "base/memory.h"
#include "base/tensor.h"
#include "clouds/quadric.h"

enum {
    CHUNK = 1024,      /* points of a task */
    RELIABILITIES = 32 /* steps in which pairs are ordered, from the most reliable, 0, to the least */
};

/* The second eigenvalue of points on a line, as a part of the first: what floats leave of it. */
static const double LINE = 1e-6;

/* A set of points whose signs relative to each other are known is a tree, as in base/disjoint_sets.h; a link
 * to a parent also says whether the normals of both are to have opposite signs. */
typedef struct sign_link {
    uint32_t parent;
    bool opposite;
} sign_link;

typedef struct estimate {
    const iso_tree *tree;
    const iso_neighbour_row *neighbours;
    float (*normals)[3];
    bool *given;            /* by slot */
    uint8_t *reliabilities; /* of each pair, ISO_CLOUD_NEIGHBOURS for each slot */
    sign_link *links;       /* by slot */
    uint32_t *sets;         /* by slot: the number of the point's set */
    uint32_t set_count;
} estimate;

static iso_vec3 position_at(const estimate *e, size_t slot) {
    const float *p = e->tree->points[slot].position;
    return iso_vec3_make((double)p[0], (double)p[1], (double)p[2]);
}

static iso_vec3 normal_at(const estimate *e, size_t slot) {
    const float *n = e->normals[slot];
    return iso_vec3_make((double)n[0], (double)n[1], (double)n[2]);
}

static void set_normal(estimate *e, size_t slot, iso_vec3 normal) {
    e->normals[slot][0] = (float)normal.x;
    e->normals[slot][1] = (float)normal.y;
    e->normals[slot][2] = (float)normal.z;
}

/* Calls `visit` for each point, in parallel. */
typedef struct point_walk {
    estimate *estimate;
    void (*visit)(estimate *e, size_t slot);
} point_walk;

static void walk_chunk(void *context, size_t chunk, int worker) {
    (void)worker;
    const point_walk *walk = context;
    const size_t first = chunk * CHUNK, rest = walk->estimate->tree->count - first;
    for (size_t i = 0; i < (rest < CHUNK ? rest : CHUNK); i++) walk->visit(walk->estimate, first + i);
}

static void walk_points(estimate *e, iso_pool *pool, void (*visit)(estimate *e, size_t slot)) {
    iso_parallel_for(pool, (e->tree->count + CHUNK - 1) / CHUNK, walk_chunk, &(point_walk){e, visit});
}

/* ---- directions */

/* Computes the covariance of a point and its neighbours, scaled to a largest entry of about 1, as their
 * distances may be too small or too large for the squares of floats. */
static void covariance_of(const estimate *e, size_t slot, float tensor[6]) {
    const iso_vec3 at = position_at(e, slot);
    iso_vec3 offsets[ISO_CLOUD_NEIGHBOURS + 1], mean = iso_vec3_make(0, 0, 0);
    double sums[6] = {0}, largest = 0;
    const int count = ISO_CLOUD_NEIGHBOURS + 1;
    offsets[ISO_CLOUD_NEIGHBOURS] = mean;
    for (int i = 0; i < ISO_CLOUD_NEIGHBOURS; i++) {
        offsets[i] = iso_vec3_sub(position_at(e, e->neighbours[slot][i]), at);
        mean = iso_vec3_add(mean, iso_vec3_scale(offsets[i], 1.0 / count));
    }
    for (int i = 0; i < count; i++) {
        const iso_vec3 d = iso_vec3_sub(offsets[i], mean);
        const double products[6] = {d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z};
        for (int k = 0; k < 6; k++) sums[k] += products[k];
    }
    for (int k = 0; k < 6; k++) largest = fmax(largest, fabs(sums[k]));
    for (int k = 0; k < 6; k++) tensor[k] = largest > 0 ? (float)(sums[k] / largest) : 0;
}

/* The direction that is perpendicular to an axis and as near as possible to one between the default camera
 * and the isometric one, which sees it from the front. */
static iso_vec3 across_line(const double axis[3]) {
    const iso_vec3 line = iso_vec3_make(axis[0], axis[1], axis[2]), eye = {0.25, -0.85, 0.46};
    const iso_vec3 across = iso_vec3_sub(eye, iso_vec3_scale(line, iso_vec3_dot(eye, line)));
    return iso_vec3_length(across) > 1e-3 ? iso_vec3_unit(across) : iso_vec3_make(1, 0, 0);
}

/* Points that coincide with all their neighbours get a normal that faces the default camera, and points on a
 * line one that it does not see from the edge. */
static void find_direction(estimate *e, size_t slot) {
    const float *n = e->normals[slot];
    float tensor[6];
    e->given[slot] = n[0] != 0 || n[1] != 0 || n[2] != 0;
    if (e->given[slot]) return;
    covariance_of(e, slot, tensor);
    const iso_eigen eigen = iso_tensor_eigen(tensor);
    const double *n3 = eigen.vectors[2];
    iso_vec3 normal = iso_vec3_make(n3[0], n3[1], n3[2]);
    if (eigen.values[1] <= LINE * eigen.values[0]) normal = across_line(eigen.vectors[0]);
    if (eigen.values[0] == 0) normal = iso_vec3_make(0, -1, 0);
    set_normal(e, slot, normal);
}

/* ---- signs */

/* The cosine between the normal of one point and the mirror image of the other's, in the plane half-way
 * between the points. */
static double agreement(const estimate *e, size_t a, size_t b) {
    const iso_vec3 edge = iso_vec3_sub(position_at(e, b), position_at(e, a)), na = normal_at(e, a),
                   nb = normal_at(e, b);
    const double square = iso_vec3_dot(edge, edge);
    const double mirrored = square > 0 ? 2 * iso_vec3_dot(edge, na) * iso_vec3_dot(edge, nb) / square : 0;
    return iso_vec3_dot(na, nb) - mirrored;
}

static void find_reliabilities(estimate *e, size_t slot) {
    for (int i = 0; i < ISO_CLOUD_NEIGHBOURS; i++) {
        const double doubt = 1 - fabs(agreement(e, slot, e->neighbours[slot][i]));
        /* finer steps for reliable pairs, of which there are most */
        const int step = doubt > 0 ? (int)(sqrt(doubt) * RELIABILITIES) : 0;
        e->reliabilities[slot * ISO_CLOUD_NEIGHBOURS + (size_t)i] =
            (uint8_t)(step < RELIABILITIES ? step : RELIABILITIES - 1);
    }
}

/* The root of a point's set; *opposite: whether the point is to have the opposite sign of the root's. */
static uint32_t root_of(sign_link *links, uint32_t slot, bool *opposite) {
    uint32_t root = slot;
    bool from_root = false;
    while (links[root].parent != root) {
        from_root ^= links[root].opposite;
        root = links[root].parent;
    }
    *opposite = from_root;
    while (links[slot].parent != root && slot != root) { /* the next search is short */
        const sign_link link = links[slot];
        links[slot] = (sign_link){root, from_root};
        from_root ^= link.opposite;
        slot = link.parent;
    }
    return root;
}

/* Unites the sets of two points, of which one is to have the opposite sign of the other or not. The root is
 * the lower slot. */
static void unite(sign_link *links, uint32_t a, uint32_t b, bool opposite) {
    bool a_opposite, b_opposite;
    const uint32_t root_a = root_of(links, a, &a_opposite), root_b = root_of(links, b, &b_opposite);
    const bool between = opposite ^ a_opposite ^ b_opposite;
    if (root_a < root_b)
        links[root_b] = (sign_link){root_a, between};
    else if (root_b < root_a)
        links[root_a] = (sign_link){root_b, between};
}

/* Unites all points with given normals, and returns one of them; UINT32_MAX: there are none. */
static uint32_t unite_given(estimate *e) {
    uint32_t first = UINT32_MAX;
    for (uint32_t slot = 0; slot < e->tree->count; slot++) {
        e->links[slot] = (sign_link){slot, false};
        if (!e->given[slot]) continue;
        if (first == UINT32_MAX) first = slot;
        e->links[slot].parent = first;
    }
    return first;
}

static void unite_pairs(estimate *e) {
    for (int step = 0; step < RELIABILITIES; step++)
        for (uint32_t slot = 0; slot < e->tree->count; slot++)
            for (int i = 0; i < ISO_CLOUD_NEIGHBOURS; i++) {
                if (e->reliabilities[(size_t)slot * ISO_CLOUD_NEIGHBOURS + (size_t)i] != step) continue;
                const uint32_t other = e->neighbours[slot][i];
                unite(e->links, slot, other, agreement(e, slot, other) < 0);
            }
}

/* Gives all points of a set the same sign relative to each other; relative to the given normals in the set
 * that has those. */
static void apply_signs(estimate *e, uint32_t given) {
    bool given_opposite = false;
    const uint32_t given_root = given == UINT32_MAX ? given : root_of(e->links, given, &given_opposite);
    for (uint32_t slot = 0; slot < e->tree->count; slot++) {
        bool opposite;
        const uint32_t root = root_of(e->links, slot, &opposite);
        if (e->given[slot] || opposite == (root == given_root && given_opposite)) continue;
        set_normal(e, slot, iso_vec3_scale(normal_at(e, slot), -1));
    }
}

/* Numbers the sets in the order of their roots. A root is the lowest slot of its set. */
static void number_sets(estimate *e) {
    bool unused;
    for (uint32_t slot = 0; slot < e->tree->count; slot++) {
        const uint32_t root = root_of(e->links, slot, &unused);
        e->sets[slot] = root == slot ? e->set_count++ : e->sets[root];
    }
}

/* Sums over the points of a set. */
typedef struct set_sums {
    double centre[3]; /* of positions; afterwards their mean */
    double points;
    double volume; /* of (p - centre) . n, weighted by the area for which a point stands: three times the
                      enclosed volume */
} set_sums;

static void sum_volumes(const estimate *e, set_sums *sums) {
    for (size_t slot = 0; slot < e->tree->count; slot++) {
        set_sums *set = &sums[e->sets[slot]];
        for (int axis = 0; axis < 3; axis++)
            set->centre[axis] += (double)e->tree->points[slot].position[axis];
        set->points++;
    }
    for (uint32_t i = 0; i < e->set_count; i++)
        for (int axis = 0; axis < 3; axis++) sums[i].centre[axis] /= sums[i].points;
    for (size_t slot = 0; slot < e->tree->count; slot++) {
        set_sums *set = &sums[e->sets[slot]];
        const iso_vec3 p = position_at(e, slot),
                       last = position_at(e, e->neighbours[slot][ISO_CLOUD_NEIGHBOURS - 1]),
                       reach = iso_vec3_sub(last, p),
                       centre = iso_vec3_make(set->centre[0], set->centre[1], set->centre[2]);
        set->volume += iso_vec3_dot(iso_vec3_sub(p, centre), normal_at(e, slot)) * iso_vec3_dot(reach, reach);
    }
}

/* Turns the sets that are inside out, but not the set of the given normals. */
static iso_status turn_sets(estimate *e, uint32_t given, iso_error *error) {
    number_sets(e);
    set_sums *sums = iso_alloc_zero(e->set_count, sizeof *sums);
    if (!sums) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %u sets of points", e->set_count);
    sum_volumes(e, sums);
    if (given != UINT32_MAX) sums[e->sets[given]].volume = 0;
    for (size_t slot = 0; slot < e->tree->count; slot++)
        if (sums[e->sets[slot]].volume < 0) set_normal(e, slot, iso_vec3_scale(normal_at(e, slot), -1));
    iso_free(sums);
    return ISO_OK;
}

/* Replaces an estimated normal by that of a quadratic function, where one fits better. This is the last step:
 * signs spread more reliably along the directions of planes. */
static void refine(estimate *e, size_t slot) {
    const iso_vec3 at = position_at(e, slot);
    iso_vec3 offsets[ISO_CLOUD_NEIGHBOURS], normal = normal_at(e, slot);
    if (e->given[slot]) return;
    for (int i = 0; i < ISO_CLOUD_NEIGHBOURS; i++)
        offsets[i] = iso_vec3_sub(position_at(e, e->neighbours[slot][i]), at);
    if (iso_quadric_normal(offsets, ISO_CLOUD_NEIGHBOURS, &normal)) set_normal(e, slot, normal);
}

static iso_status allocate(estimate *e, iso_error *error) {
    const size_t count = e->tree->count;
    e->given = iso_alloc(count * sizeof *e->given);
    e->reliabilities = iso_alloc(count * ISO_CLOUD_NEIGHBOURS);
    e->links = iso_alloc(count * sizeof *e->links);
    e->sets = iso_alloc(count * sizeof *e->sets);
    if (e->given && e->reliabilities && e->links && e->sets) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the normals of %zu points", count);
}

iso_status iso_normals_estimate(const iso_tree *tree, const iso_neighbour_row *neighbours,
                                float (*normals)[3], iso_pool *pool, iso_error *error) {
    estimate e = {.tree = tree, .neighbours = neighbours, .normals = normals};
    iso_status status = allocate(&e, error);
    if (status == ISO_OK) {
        walk_points(&e, pool, find_direction);
        walk_points(&e, pool, find_reliabilities);
        const uint32_t given = unite_given(&e);
        unite_pairs(&e);
        apply_signs(&e, given);
        status = turn_sets(&e, given, error);
        walk_points(&e, pool, refine);
    }
    iso_free(e.given);
    iso_free(e.reliabilities);
    iso_free(e.links);
    iso_free(e.sets);
    return status;
}
