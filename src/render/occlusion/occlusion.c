/* occlusion: finds the places of samples, and blends what the nodes around them say. */
#include "render/occlusion/occlusion.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "render/occlusion/visibility_groups.h"
#include "render/view/project.h"
#include "render/view/strip.h"

/* How far from the surface a sample looks for nodes, voxels along its normal; further attempts where there
 * are none. */
static const float OFFSETS[] = {0.9f, 1.7f, 0.2f};
enum { ATTEMPTS = sizeof OFFSETS / sizeof *OFFSETS };

/* The integer 1 of the nodes' weights, and the least that they must be together. */
enum { WEIGHT = 256, LEAST_WEIGHT = 4 };

/* Normals that face away from the eye by more than this cosine belong to surfaces seen from inside; by less
 * to outlines, as they are interpolated. */
#define INNER_COSINE 0.25f

/* Of the ambient directions, and of those to the light, which is about 11 degrees wide: the tangent of half
 * that angle. */
enum { DIRECTIONS = 128, LIGHT_DIRECTIONS = 32 };
static const double LIGHT_RADIUS = 0.1;

/* What takes the place of a share when nodes are missing, and where there are none, within solids. */
#define MISSING -1.0f
#define ENCLOSED -2.0f

/* A place on a surface: index coordinates; normal in the world, towards the eye; what moves the position by a
 * voxel along the normal. */
typedef struct spot {
    float position[3], normal[3], way[3];
} spot;

/* ---- what nodes say */

/* Interpolates linearly in a tetrahedron of the cube around a place: along the edges from the cube's first
 * corner to its last, in the order of the fractions. Corners that are no nodes are left out. *total: the
 * weights of the others, of which the terms are the weighted sum. */
static iso_found find_terms(iso_visibility *v, const float at[3], int32_t terms[ISO_NODE_TERMS], int *total) {
    int corner[3], part[3];
    for (int axis = 0; axis < 3; axis++) {
        if (!(at[axis] > -2 && at[axis] < (float)(v->bits->dims[axis] + 1))) return ISO_FOUND_NONE;
        corner[axis] = (int)(at[axis] + 2) - 2;
        part[axis] = (int)((at[axis] - (float)corner[axis]) * (float)WEIGHT);
    }
    const int x_y = part[0] < part[1], x_z = part[0] < part[2], y_z = part[1] < part[2];
    int axes[3], before = WEIGHT; /* by descending fractions */
    axes[x_y + x_z] = 0;
    axes[!x_y + y_z] = 1;
    axes[!x_z + !y_z] = 2;
    bool missing = false;
    *total = 0;
    for (int k = 0; k < ISO_NODE_TERMS; k++) terms[k] = 0;
    for (int i = 0; i < 4; i++) {
        const int next = i < 3 ? part[axes[i]] : 0, weight = before - next;
        const iso_node *node;
        const iso_found found =
            weight ? iso_visibility_node(v, corner[0], corner[1], corner[2], &node) : ISO_FOUND_NONE;
        missing |= found == ISO_FOUND_MISSING;
        if (found == ISO_FOUND_NODE) {
            for (int k = 0; k < 3; k++) {
                terms[k] += weight * node->linear[k];
                terms[3 + k] += weight * node->quadratic[k];
                terms[6 + k] += weight * node->mixed[k];
            }
            *total += weight;
        }
        if (i < 3) corner[axes[i]]++;
        before = next;
    }
    return missing ? ISO_FOUND_MISSING : *total > LEAST_WEIGHT ? ISO_FOUND_NODE : ISO_FOUND_NONE;
}

static float sum_of(const int32_t t[ISO_NODE_TERMS], const float n[3]) {
    return (float)t[0] * n[0] + (float)t[1] * n[1] + (float)t[2] * n[2] + (float)t[3] * n[0] * n[0] +
           (float)t[4] * n[1] * n[1] + (float)t[5] * n[2] * n[2] + (float)t[6] * n[0] * n[1] +
           (float)t[7] * n[0] * n[2] + (float)t[8] * n[1] * n[2];
}

/* Whether the voxel around a place is solid. */
static bool is_solid(const iso_solid_bits *bits, const float at[3]) {
    int voxel[3];
    for (int axis = 0; axis < 3; axis++) {
        if (!(at[axis] > -0.5f && at[axis] < (float)bits->dims[axis] - 0.5f)) return false;
        voxel[axis] = (int)(at[axis] + 0.5f);
    }
    return iso_solid_at(bits, voxel[0], voxel[1], voxel[2]);
}

/* The share of the light that reaches a spot, MISSING or ENCLOSED. */
static float share_at(iso_visibility *v, const spot *s) {
    int32_t terms[ISO_NODE_TERMS];
    int total;
    for (int i = 0; i < ATTEMPTS; i++) {
        float at[3];
        for (int axis = 0; axis < 3; axis++) at[axis] = s->position[axis] + OFFSETS[i] * s->way[axis];
        const iso_found found = find_terms(v, at, terms, &total);
        if (found == ISO_FOUND_MISSING) return MISSING;
        if (found == ISO_FOUND_NONE) continue;
        const float share = sum_of(terms, s->normal) / (float)(total * ISO_NODE_ALL);
        return share < 0 ? 0 : share > 1 ? 1 : share;
    }
    float beside[3];
    for (int axis = 0; axis < 3; axis++) beside[axis] = s->position[axis] + OFFSETS[0] * s->way[axis];
    return is_solid(v->bits, beside) ? ENCLOSED : 1;
}

/* ---- what is kept */

static void free_side(iso_occlusion_side *side) {
    iso_visibility_destroy(side->around);
    iso_visibility_destroy(side->key);
    iso_solid_bits_free(&side->inverse);
    *side = (iso_occlusion_side){.bits = NULL};
}

void iso_occlusion_reset(iso_occlusion *o) {
    for (int i = 0; i < ISO_SIDES; i++) free_side(&o->sides[i]);
}

void iso_occlusion_forget(iso_occlusion *o, const int lo[3], const int hi[3]) {
    free_side(&o->sides[ISO_SIDE_INNER]); /* rarely seen: made again */
    if (o->sides[ISO_SIDE_OUTER].around) iso_visibility_forget(o->sides[ISO_SIDE_OUTER].around, lo, hi);
    if (o->sides[ISO_SIDE_OUTER].key) iso_visibility_forget(o->sides[ISO_SIDE_OUTER].key, lo, hi);
}

void iso_occlusion_turn(iso_occlusion *o, iso_vec3 light) {
    if (light.x == o->light.x && light.y == o->light.y && light.z == o->light.z) return;
    o->light = light;
    for (int i = 0; i < ISO_SIDES; i++) {
        iso_visibility_destroy(o->sides[i].key);
        o->sides[i].key = NULL;
    }
}

/* Makes what is missing on a side. */
static iso_status prepare_side(iso_occlusion *o, int number, iso_error *error) {
    iso_occlusion_side *side = &o->sides[number];
    if (!side->bits && number == ISO_SIDE_INNER)
        ISO_TRY(iso_solid_bits_invert(o->bits, o->removed, o->things, o->lo, o->hi, &side->inverse, error));
    side->bits = number == ISO_SIDE_INNER ? &side->inverse : o->bits;
    if (o->range > 0 && !side->around) {
        const iso_directions sphere = iso_directions_sphere(DIRECTIONS);
        ISO_TRY(iso_visibility_create(side->bits, &sphere, o->range, &side->around, error));
    }
    if (!o->has_shadow || side->key) return ISO_OK;
    const iso_directions disc = iso_directions_disc(o->light, LIGHT_RADIUS, LIGHT_DIRECTIONS);
    return iso_visibility_create(side->bits, &disc, INFINITY, &side->key, error);
}

/* ---- places */

static void set_way(const double inverse[9], spot *s) {
    float length = 0;
    for (int i = 0; i < 3; i++) {
        s->way[i] = (float)inverse[3 * i] * s->normal[0] + (float)inverse[3 * i + 1] * s->normal[1] +
                    (float)inverse[3 * i + 2] * s->normal[2];
        length += s->way[i] * s->way[i];
    }
    const float scale = length > 0 ? 1 / sqrtf(length) : 0;
    for (int i = 0; i < 3; i++) s->way[i] *= scale;
}

iso_status iso_occlusion_at(iso_occlusion *o, const float position[3], const float normal[3], float *share,
                            iso_error *error) {
    spot s;
    for (int i = 0; i < 3; i++) {
        s.position[i] = position[i];
        s.normal[i] = normal[i];
    }
    set_way(o->bits->affine.inverse, &s);
    ISO_TRY(prepare_side(o, ISO_SIDE_OUTER, error));
    iso_visibility *v = o->sides[ISO_SIDE_OUTER].around;
    while ((*share = share_at(v, &s)) == MISSING) ISO_TRY(iso_visibility_compute(v, NULL, error));
    if (*share == ENCLOSED) *share = o->things ? 0 : 1;
    return ISO_OK;
}

/* ---- the gbuffer */

/* What the rows have in common. */
typedef struct rows {
    const iso_occlusion *occlusion;
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    int factor, first, count, bands; /* in rows of pixels */
    bool *finished;                  /* of each row of pixels */
    atomic_bool sees_inside, is_missing;
    float index[9], origin[3]; /* index coordinates = origin + index * point in view space */
    float rotation[9];         /* of the view */
    float center[2], slope;    /* the ray of sample (x, y) has the slopes (x + center[0]) * slope, .. */
    float depth;               /* mm by which samples of a pixel may differ that share their light */
} rows;

/* The shortest edge of a voxel, mm. */
static float voxel_size(const iso_affine *affine) {
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++)
        least =
            fmin(least,
                 iso_vec3_length(iso_affine_vector(affine, iso_vec3_make(axis == 0, axis == 1, axis == 2))));
    return (float)least;
}

static void set_matrices(rows *r) {
    const iso_affine *affine = &r->occlusion->bits->affine;
    const double *inverse = affine->inverse, *rotation = r->view->rotation;
    double origin[3];
    iso_vec3_store(iso_affine_point_to_index(affine, r->view->eye), origin);
    for (int i = 0; i < 3; i++) {
        r->origin[i] = (float)origin[i];
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int j = 0; j < 3; j++) sum += inverse[3 * i + j] * rotation[3 * k + j];
            r->index[3 * i + k] = (float)sum;
            r->rotation[3 * i + k] = (float)rotation[3 * i + k];
        }
    }
    r->center[0] = (float)(0.5 - r->view->cx);
    r->center[1] = (float)(0.5 - r->view->cy);
    r->slope = (float)(1 / r->view->focal);
    r->depth = voxel_size(affine);
}

/* The place that a sample shows, and on which side of the surface the eye is. */
static int find_spot(const rows *r, int x, int y, size_t sample, spot *s) {
    const iso_gbuffer *g = r->gbuffer;
    const iso_view *view = r->view;
    const float z = g->depth[sample], scale = view->orthographic ? 1 : z;
    const float point[3] = {((float)x + r->center[0]) * r->slope * scale,
                            ((float)y + r->center[1]) * r->slope * scale, z};
    const float n[3] = {g->normal[0][sample], g->normal[1][sample], g->normal[2][sample]};
    const float facing = view->orthographic ? n[2] : n[0] * point[0] + n[1] * point[1] + n[2] * point[2];
    const float square = view->orthographic ? 1 : point[0] * point[0] + point[1] * point[1] + z * z;
    const bool inner = facing > 0 && facing * facing > INNER_COSINE * INNER_COSINE * square;
    const float sign = inner ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        s->position[i] = r->origin[i] + r->index[3 * i] * point[0] + r->index[3 * i + 1] * point[1] +
                         r->index[3 * i + 2] * point[2];
        s->normal[i] = sign * (r->rotation[i] * n[0] + r->rotation[3 + i] * n[1] + r->rotation[6 + i] * n[2]);
    }
    set_way(r->occlusion->bits->affine.inverse, s);
    return inner ? ISO_SIDE_INNER : ISO_SIDE_OUTER;
}

/* Whether two samples of a pixel show places that are so near that they get the same light. */
static bool is_same(const rows *r, size_t a, size_t b) {
    const iso_gbuffer *g = r->gbuffer;
    const float cosine = g->normal[0][a] * g->normal[0][b] + g->normal[1][a] * g->normal[1][b] +
                         g->normal[2][a] * g->normal[2][b];
    return g->surface[a] == g->surface[b] && cosine > 0.96f && fabsf(g->depth[a] - g->depth[b]) < r->depth;
}

/* The share of the light, from all around or the key light, that reaches a spot on a side, or MISSING. Things
 * in a solid, which one sees where it is cut open, are on its inner side. */
static float share_on(rows *r, int number, bool key, const spot *s) {
    const iso_occlusion_side *side = &r->occlusion->sides[number];
    if (!side->bits) {
        atomic_store_explicit(&r->sees_inside, true, memory_order_relaxed);
        return MISSING;
    }
    const float share = share_at(key ? side->key : side->around, s);
    if (share != ENCLOSED) return share;
    if (!r->occlusion->things) return 1;
    return number == ISO_SIDE_OUTER ? share_on(r, ISO_SIDE_INNER, key, s) : 0;
}

/* Returns whether nothing was missing. */
static bool light_sample(rows *r, int x, int y, size_t sample) {
    const iso_gbuffer *g = r->gbuffer;
    const bool ambient = r->occlusion->range > 0, key = r->occlusion->has_shadow;
    spot s;
    const int number = find_spot(r, x, y, sample, &s);
    if (ambient) g->ambient[sample] = share_on(r, number, false, &s);
    if (key) g->key[sample] = share_on(r, number, true, &s);
    return !(ambient && g->ambient[sample] == MISSING) && !(key && g->key[sample] == MISSING);
}

static void copy_light(const rows *r, size_t from, size_t to) {
    const iso_gbuffer *g = r->gbuffer;
    if (g->ambient) g->ambient[to] = g->ambient[from];
    if (g->key) g->key[to] = g->key[from];
}

static bool light_pixel(rows *r, int x, int y) {
    const int factor = r->factor;
    size_t last = SIZE_MAX;
    bool finished = true;
    for (int j = 0; j < factor; j++)
        for (int i = 0; i < factor; i++) {
            const int column = x * factor + i, row = y * factor + j;
            const size_t sample = (size_t)row * (size_t)r->gbuffer->width + (size_t)column;
            if (r->gbuffer->surface[sample] == ISO_SURFACE_NONE) continue;
            if (last != SIZE_MAX && is_same(r, last, sample)) {
                copy_light(r, last, sample);
                continue;
            }
            finished &= light_sample(r, column, row, sample);
            last = sample;
        }
    return finished;
}

/* Whether the eight samples from column x on show nothing in all rows of a pixel. */
static bool is_empty(const rows *r, int x, int y) {
    const iso_gbuffer *g = r->gbuffer;
    const size_t first = (size_t)(y * r->factor) * (size_t)g->width + (size_t)x;
    uint64_t all = UINT64_MAX, eight;
    for (int j = 0; j < r->factor; j++) {
        memcpy(&eight, g->surface + first + (size_t)j * (size_t)g->width, sizeof eight);
        all &= eight;
    }
    return all == UINT64_MAX; /* ISO_SURFACE_NONE is 255 */
}

/* Returns whether nothing was missing. */
static bool light_row(rows *r, int y) {
    const int width = r->gbuffer->width, factor = r->factor;
    bool finished = true;
    for (int x = 0; x < width;) {
        const int end = x + 8 <= width ? x + 8 / factor * factor : x + factor;
        if (x + 8 > width || !is_empty(r, x, y))
            for (; x < end; x += factor) finished &= light_pixel(r, x / factor, y);
        x = end;
    }
    return finished;
}

static void light_band(void *context, size_t number, int worker) {
    (void)worker;
    rows *r = context;
    const iso_rows band = iso_band_rows(r->count, r->bands, number);
    for (int y = band.first; y <= band.last; y++) {
        if (r->finished[y]) continue;
        r->finished[y] = light_row(r, r->first + y);
        if (!r->finished[y]) atomic_store_explicit(&r->is_missing, true, memory_order_relaxed);
    }
}

/* Computes the nodes that were missing. */
static iso_status compute_nodes(iso_occlusion *o, bool inner, iso_pool *pool, iso_error *error) {
    if (inner) ISO_TRY(prepare_side(o, ISO_SIDE_INNER, error));
    for (int i = 0; i < ISO_SIDES; i++) {
        if (o->sides[i].around) ISO_TRY(iso_visibility_compute(o->sides[i].around, pool, error));
        if (o->sides[i].key) ISO_TRY(iso_visibility_compute(o->sides[i].key, pool, error));
    }
    return ISO_OK;
}

/* Lights rows until nothing is missing: once if the nodes are there. */
static iso_status light_all(rows *r, iso_occlusion *o, iso_pool *pool, iso_error *error) {
    for (;;) {
        atomic_store(&r->is_missing, false);
        atomic_store(&r->sees_inside, false);
        iso_parallel_for(pool, (size_t)r->bands, light_band, r);
        if (!atomic_load(&r->is_missing)) return ISO_OK;
        ISO_TRY(compute_nodes(o, atomic_load(&r->sees_inside), pool, error));
    }
}

iso_status iso_occlusion_light(iso_occlusion *o, const iso_view *view, int factor, int first, int last,
                               const iso_gbuffer *gbuffer, iso_pool *pool, iso_error *error) {
    const int pixels = (last - first + 1) / factor;
    rows r = {.occlusion = o,
              .view = view,
              .gbuffer = gbuffer,
              .factor = factor,
              .first = first / factor,
              .count = pixels,
              .bands = iso_band_count(pool, pixels),
              .finished = iso_alloc_zero((size_t)pixels, sizeof *r.finished)};
    if (!r.finished) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for occlusion");
    set_matrices(&r);
    iso_status status = prepare_side(o, ISO_SIDE_OUTER, error);
    if (status == ISO_OK && o->sides[ISO_SIDE_INNER].bits) /* the light may have moved */
        status = prepare_side(o, ISO_SIDE_INNER, error);
    if (status == ISO_OK) status = light_all(&r, o, pool, error);
    iso_free(r.finished);
    return status;
}
