/* visibility: groups of nodes, computed where they are asked for. The kernel is visibility_kernel.c. */
#include "render/occlusion/visibility.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "render/occlusion/visibility_groups.h"
#include "render/occlusion/visibility_kernel.h"

/* Rays begin this many voxels from their node: the steps of voxels are no obstacles for each other. */
enum { FIRST_STEP = 2 };

/* ---- directions */

/* The cosine and the sine of the golden angle, by which points of Fibonacci's lattices are turned. */
static const double GOLDEN[2] = {-0.7373688780783197, 0.6754902942615236};

static void turn(double at[2]) {
    const double x = at[0] * GOLDEN[0] - at[1] * GOLDEN[1];
    at[1] = at[0] * GOLDEN[1] + at[1] * GOLDEN[0];
    at[0] = x;
}

/* A Fibonacci lattice in an octant, and its mirror images: so no axis and no side is preferred. */
iso_directions iso_directions_sphere(int count) {
    assert(count > 0 && count <= ISO_DIRECTIONS_MAX && count % 8 == 0);
    static const double quarter = 1.5707963267948966, golden = 0.6180339887498949;
    iso_directions made = {.count = count, .by_cosine = true};
    for (int i = 0; i < count / 8; i++) {
        const double z = (i + 0.5) / (count / 8.0), radius = sqrt(1 - z * z), turns = (i + 0.5) * golden;
        double sine, cosine;
        iso_sincos(quarter * (turns - floor(turns)), &sine, &cosine);
        for (int octant = 0; octant < 8; octant++)
            made.axis[8 * i + octant] =
                iso_vec3_make(octant & 1 ? -radius * cosine : radius * cosine,
                              octant & 2 ? -radius * sine : radius * sine, octant & 4 ? -z : z);
    }
    return made;
}

iso_directions iso_directions_disc(iso_vec3 axis, double radius, int count) {
    assert(count > 0 && count <= ISO_DIRECTIONS_MAX);
    iso_directions made = {.count = count};
    const iso_vec3 other = fabs(axis.x) < 0.6 ? iso_vec3_make(1, 0, 0) : iso_vec3_make(0, 1, 0),
                   u = iso_vec3_unit(iso_vec3_cross(axis, other)), v = iso_vec3_cross(axis, u);
    double at[2] = {1, 0};
    for (int i = 0; i < count; i++, turn(at)) {
        const double r = radius * sqrt((i + 0.5) / count);
        made.axis[i] = iso_vec3_unit(
            iso_vec3_add(axis, iso_vec3_add(iso_vec3_scale(u, r * at[0]), iso_vec3_scale(v, r * at[1]))));
    }
    return made;
}

/* ---- rays */

/* The direction of a ray in voxels, of which the largest is 1 or -1, and how many of these steps it takes. */
static int direction_of(const iso_visibility *v, int number, double range, double out[3]) {
    const iso_vec3 index = iso_affine_vector_to_index(&v->bits->affine, v->directions.axis[number]);
    const double major = fmax(fabs(index.x), fmax(fabs(index.y), fabs(index.z)));
    out[0] = index.x / major;
    out[1] = index.y / major;
    out[2] = index.z / major;
    double most = range * major; /* voxels along the major axis */
    for (int axis = 0; axis < 3; axis++)
        if (fabs(out[axis]) > 0.999) most = fmin(most, v->bits->dims[axis]);
    return (int)floor(most + 0.5);
}

static iso_ray_step step_at(const double direction[3], int number) {
    int at[3];
    for (int axis = 0; axis < 3; axis++) at[axis] = (int)floor(direction[axis] * number + 0.5);
    return (iso_ray_step){.column = at[0] >> 5, .shift = at[0] & 31, .y = at[1], .z = at[2]};
}

/* The step behind step `number`: of light from all around every second one beyond 16 voxels, as what is far
 * away is seen from many nodes in many directions. */
static int next_step(const iso_visibility *v, int number) {
    return number + (v->directions.by_cosine && number >= 16 ? 2 : 1);
}

static iso_status make_rays(iso_visibility *v, double range, iso_error *error) {
    double direction[3];
    size_t total = 0;
    for (int i = 0; i < v->directions.count; i++) {
        const int last = direction_of(v, i, range, direction);
        for (int k = FIRST_STEP; k <= last; k = next_step(v, k)) v->rays[i].count++;
        total += (size_t)v->rays[i].count;
    }
    v->steps = iso_alloc((total ? total : 1) * sizeof *v->steps);
    if (!v->steps) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for rays");
    iso_ray_step *next = v->steps;
    for (int i = 0; i < v->directions.count; i++) {
        const int last = direction_of(v, i, range, direction);
        v->rays[i].steps = next;
        for (int k = FIRST_STEP; k <= last; k = next_step(v, k)) *next++ = step_at(direction, k);
        for (int axis = 0; axis < 3; axis++) {
            const int reach = (int)ceil(fabs(direction[axis]) * last) + 2;
            if (reach > v->reach[axis]) v->reach[axis] = reach;
        }
    }
    return ISO_OK;
}

/* ---- terms */

/* The mean of the squares of the directions' coordinates: not quite 1/3, as they are few. */
static iso_vec3 mean_squares(const iso_directions *d) {
    iso_vec3 sum = {0};
    for (int i = 0; i < d->count; i++) {
        const iso_vec3 a = d->axis[i];
        sum = iso_vec3_add(sum, iso_vec3_make(a.x * a.x, a.y * a.y, a.z * a.z));
    }
    return iso_vec3_scale(sum, 1.0 / d->count);
}

/* The terms of one direction. Where all directions are free they add up to 1 for every normal, of which the
 * squares of the coordinates add up to 1. */
static void terms_of(const iso_directions *d, int number, iso_vec3 means, double terms[ISO_NODE_TERMS]) {
    const iso_vec3 a = d->axis[number];
    const double part = (double)ISO_NODE_ONE / d->count, linear = d->by_cosine ? 2 * part : 0,
                 square = d->by_cosine ? 1.875 * part : 0;
    terms[0] = linear * a.x;
    terms[1] = linear * a.y;
    terms[2] = linear * a.z;
    terms[3] = part + square * (a.x * a.x - means.x);
    terms[4] = part + square * (a.y * a.y - means.y);
    terms[5] = part + square * (a.z * a.z - means.z);
    terms[6] = 2 * square * a.x * a.y;
    terms[7] = 2 * square * a.x * a.z;
    terms[8] = 2 * square * a.y * a.z;
}

static void make_terms(iso_visibility *v) {
    const iso_vec3 means = mean_squares(&v->directions);
    double terms[8][ISO_NODE_TERMS];
    for (int first = 0; first < v->directions.count; first += 8) {
        memset(terms, 0, sizeof terms);
        for (int i = 0; i < 8 && first + i < v->directions.count; i++)
            terms_of(&v->directions, first + i, means, terms[i]);
        for (int mask = 0; mask < 256; mask++)
            for (int k = 0; k < ISO_NODE_TERMS; k++) {
                double sum = 0;
                for (int i = 0; i < 8; i++) sum += mask >> i & 1 ? terms[i][k] : 0;
                v->terms[first / 8][mask][k] = (int16_t)floor(sum + 0.5);
            }
    }
}

/* ---- groups */

static size_t group_count(const iso_visibility *v) {
    return (size_t)v->groups[0] * (size_t)v->groups[1] * (size_t)v->groups[2];
}

iso_status iso_visibility_create(const iso_solid_bits *bits, const iso_directions *directions, double range,
                                 iso_visibility **visibility, iso_error *error) {
    iso_visibility *v = iso_alloc_zero(1, sizeof *v);
    if (!v) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for occlusion");
    v->bits = bits;
    v->directions = *directions;
    v->groups[0] = bits->columns;
    v->groups[1] = (bits->dims[1] + ISO_VISIBILITY_Y - 1) / ISO_VISIBILITY_Y;
    v->groups[2] = (bits->dims[2] + ISO_VISIBILITY_Z - 1) / ISO_VISIBILITY_Z;
    const size_t count = group_count(v);
    v->group = iso_alloc_zero(count, sizeof *v->group);
    v->wanted = iso_alloc_zero(count, sizeof *v->wanted);
    v->list = iso_alloc(count * sizeof *v->list);
    v->terms = iso_alloc_zero(ISO_DIRECTIONS_MAX / 8, sizeof *v->terms);
    if (v->terms) make_terms(v);
    iso_status status = v->group && v->wanted && v->list && v->terms
                            ? make_rays(v, range, error)
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory for occlusion");
    if (status != ISO_OK)
        iso_visibility_destroy(v);
    else
        *visibility = v;
    return status;
}

static void forget(iso_visibility *v, size_t number) {
    iso_free(v->group[number]);
    v->group[number] = NULL;
}

void iso_visibility_destroy(iso_visibility *v) {
    if (!v) return;
    for (size_t i = 0; v->group && i < group_count(v); i++) forget(v, i);
    iso_free(v->group);
    iso_free(v->wanted);
    iso_free(v->list);
    iso_free(v->steps);
    iso_free(v->terms);
    iso_free(v);
}

/* The groups with voxels `lo` .. `hi` along an axis. */
static void group_range(const iso_visibility *v, int axis, int lo, int hi, int range[2]) {
    static const int sizes[3] = {ISO_SOLID_WORD, ISO_VISIBILITY_Y, ISO_VISIBILITY_Z};
    const int last = v->bits->dims[axis] - 1;
    range[0] = (lo < 0 ? 0 : lo) / sizes[axis];
    range[1] = (hi > last ? last : hi) < 0 ? -1 : (hi > last ? last : hi) / sizes[axis];
}

void iso_visibility_forget(iso_visibility *v, const int lo[3], const int hi[3]) {
    int range[3][2];
    for (int axis = 0; axis < 3; axis++)
        group_range(v, axis, lo[axis] - v->reach[axis], hi[axis] + v->reach[axis], range[axis]);
    for (int z = range[2][0]; z <= range[2][1]; z++)
        for (int y = range[1][0]; y <= range[1][1]; y++)
            for (int x = range[0][0]; x <= range[0][1]; x++) forget(v, iso_group_number(v, x, y, z));
}

/* Adds the terms of the free ones of eight directions to the nodes of a row. */
static void add_terms(const iso_node_terms *terms, const uint32_t *const blocked[8], int row, uint32_t nodes,
                      int16_t (*sums)[16]) {
    for (int n = 0; nodes; nodes &= nodes - 1, n++) {
        const int bit = __builtin_ctz(nodes);
        unsigned mask = 0;
        for (int i = 0; i < 8; i++) mask |= (blocked[i][row] >> bit & 1) << i;
        const int16_t *add = (*terms)[~mask & 255];
        for (int k = 0; k < 16; k++) sums[n][k] = (int16_t)(sums[n][k] + add[k]);
    }
}

static void store_row(const iso_visibility *v, const scratch *from, int row, iso_node *nodes) {
    int16_t sums[ISO_SOLID_WORD][16] = {{0}};
    const int count = (int)iso_count_bits(from->node[row]);
    for (int first = 0; first < v->directions.count; first += 8) {
        const uint32_t *blocked[8];
        for (int i = 0; i < 8; i++) /* terms of directions that do not exist are 0 */
            blocked[i] = from->blocked[first + i < v->directions.count ? first + i : first];
        add_terms(&v->terms[first / 8], blocked, row, from->node[row], sums);
    }
    for (int n = 0; n < count; n++) memcpy(&nodes[n], sums[n], sizeof *nodes);
}

static iso_node_group *store(const iso_visibility *v, const scratch *from) {
    size_t count = 0;
    for (int row = 0; row < ISO_VISIBILITY_ROWS; row++) count += iso_count_bits(from->node[row]);
    iso_node_group *made = iso_alloc(sizeof *made + count * sizeof *made->nodes);
    if (!made) return NULL;
    uint16_t next = 0;
    memcpy(made->node, from->node, sizeof made->node);
    for (int row = 0; row < ISO_VISIBILITY_ROWS; row++) {
        made->first[row] = next;
        if (from->node[row]) store_row(v, from, row, made->nodes + next);
        next = (uint16_t)(next + iso_count_bits(from->node[row]));
    }
    return made;
}

static void compute_group(void *context, size_t index, int worker) {
    (void)worker;
    iso_visibility *v = context;
    const uint32_t number = v->list[index];
    const int row = (int)(number / (uint32_t)v->groups[0]);
    const int at[3] = {(int)(number % (uint32_t)v->groups[0]), row % v->groups[1], row / v->groups[1]};
    scratch found;
    ISO_KERNEL_UNIT(iso_visibility_follow, iso_cpu_best())(v, at, &found);
    v->group[number] = store(v, &found);
    if (!v->group[number]) atomic_store(&v->failed, true);
}

iso_status iso_visibility_compute(iso_visibility *v, iso_pool *pool, iso_error *error) {
    size_t count = 0;
    if (!atomic_exchange(&v->any_wanted, false)) return ISO_OK;
    for (size_t i = 0; i < group_count(v); i++) {
        if (!atomic_load_explicit(&v->wanted[i], memory_order_relaxed)) continue;
        atomic_store_explicit(&v->wanted[i], 0, memory_order_relaxed);
        if (!v->group[i]) v->list[count++] = (uint32_t)i;
    }
    atomic_store(&v->failed, false);
    iso_parallel_for(pool, count, compute_group, v);
    return atomic_load(&v->failed) ? iso_fail(error, ISO_ERR_NOMEM, "out of memory for occlusion") : ISO_OK;
}
