/* streamlines: integrates the unit vectors of a field by arc length with the fourth-order method of Runge and
 * Kutta, with trilinear interpolation between voxels. Vertices are therefore equally spaced at any speed, and
 * slow regions take no more steps than fast ones. Steps of a quarter of a voxel lose no detail, because the
 * field is linear within cells.
 *
 * Seeds come from a stateless generator, which mixes the bits of a counter (Steele, Lea and Flood 2014, "Fast
 * splittable pseudorandom number generators", the mixer of section 5), so they do not depend on the order in
 * which they are used. */
#include "extract/vectors/streamlines.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "extract/vectors/attributes.h"

enum {
    TRIES = 1000,         /* largest number of random positions tried for each line */
    BATCH = 64,           /* largest number of lines that are followed at the same time */
    MOST_STEPS = 1 << 20, /* largest number of steps of a line in one direction */
    STOPS = 3
};
static const size_t BATCH_BYTES = (size_t)64 << 20;

/* A vertex relative to the first voxel, and the length of the vector there. */
typedef struct vertex {
    float at[3], speed;
} vertex;

/* A line of the batch. Its vertices begin at `first` in the middle of the line's section of `room`. */
typedef struct line {
    double seed[3];
    size_t first, count;
    size_t stops[STOPS];
} line;

typedef struct tracer {
    const iso_vectors *vectors;
    const iso_streamlines_opts *opts;
    iso_affine affine;
    double step, slowest;
    size_t steps; /* largest number of steps in one direction */
    uint64_t next_try, tries;
    uint64_t limit;
    line lines[BATCH];
    vertex *room; /* sections of 2 * steps + 1 vertices, one for each line of the batch */
    int batch;
    iso_buffer vertices, speeds, starts; /* of all lines */
    size_t vertex_count, line_count;
    iso_vec3 shift; /* from the first voxel to the origin of the lines */
    iso_streamlines_totals *totals;
} tracer;

/* ---- the field */

typedef enum stop { LEFT, SLOW, GROWN, NONE } stop;

/* Computes the unit vector at a position relative to the first voxel; vectors without a sign are aligned with
 * `before`. */
static stop direction_at(const tracer *t, const double at[3], const double *before, double direction[3],
                         double *speed) {
    double index[3], v[3];
    for (int row = 0; row < 3; row++) {
        const double *m = t->affine.inverse + 3 * row;
        index[row] = m[0] * at[0] + m[1] * at[1] + m[2] * at[2];
    }
    if (!iso_vectors_sample(t->vectors, index, t->opts->axial ? before : NULL, v)) return LEFT;
    *speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(*speed >= t->slowest && *speed > 0)) return SLOW;
    for (int k = 0; k < 3; k++) direction[k] = v[k] / *speed;
    return NONE;
}

/* Takes a step of fourth order from p. d[0]: the direction at p; sign: 1, or -1 to go against the field. */
static stop take_step(const tracer *t, double sign, double p[3], double d[4][3]) {
    static const double parts[4] = {0, 0.5, 0.5, 1};
    double speed;
    for (int stage = 1; stage < 4; stage++) {
        double at[3];
        for (int k = 0; k < 3; k++) at[k] = p[k] + sign * t->step * parts[stage] * d[stage - 1][k];
        const stop stopped = direction_at(t, at, d[0], d[stage], &speed);
        if (stopped != NONE) return stopped;
    }
    for (int k = 0; k < 3; k++) p[k] += sign * t->step * ((d[0][k] + d[3][k]) + 2 * (d[1][k] + d[2][k])) / 6;
    return NONE;
}

/* ---- one line */

static void put_vertex(vertex *to, const double p[3], double speed) {
    for (int k = 0; k < 3; k++) to->at[k] = (float)p[k];
    to->speed = (float)speed;
}

/* Computes the direction at a line's seed. Vectors without a sign are aligned with the vector of the nearest
 * voxel, because opposite vectors around the seed would otherwise cancel and leave only noise. */
static stop begin(const tracer *t, const double seed[3], double direction[3], double *speed) {
    double nearest[3] = {0};
    const iso_vec3 index = iso_affine_vector_to_index(&t->affine, iso_vec3_make(seed[0], seed[1], seed[2]));
    const double at[3] = {index.x, index.y, index.z};
    int voxel[3];
    for (int axis = 0; axis < 3; axis++) {
        const int last = t->vectors->dims[axis] - 1;
        voxel[axis] = at[axis] > 0 ? (int)(at[axis] + 0.5) : 0;
        if (voxel[axis] > last) voxel[axis] = last;
    }
    const float *v = iso_vectors_at(t->vectors, voxel[0], voxel[1], voxel[2]);
    for (int k = 0; k < 3; k++) nearest[k] = (double)v[k];
    return direction_at(t, seed, nearest, direction, speed);
}

/* Follows a line in one direction; returns its number of vertices. to: where the first vertex is stored; way:
 * 1 or -1, from there to the next one. */
static size_t follow(const tracer *t, line *l, double sign, vertex *to, int way) {
    double p[3], d[4][3], speed;
    size_t count = 0;
    stop stopped = begin(t, l->seed, d[0], &speed);
    memcpy(p, l->seed, sizeof p);
    while (stopped == NONE && count < t->steps) {
        double next[3];
        stopped = take_step(t, sign, p, d);
        if (stopped == NONE) stopped = direction_at(t, p, d[0], next, &speed);
        if (stopped != NONE) break;
        memcpy(d[0], next, sizeof next);
        put_vertex(to, p, speed);
        to += way;
        count++;
    }
    l->stops[stopped == NONE ? GROWN : stopped]++;
    return count;
}

static void follow_line(void *context, size_t index, int worker) {
    (void)worker;
    tracer *t = context;
    line *l = &t->lines[index];
    vertex *middle = t->room + index * (2 * t->steps + 1) + t->steps;
    double direction[3], speed = 0;
    memset(l->stops, 0, sizeof l->stops);
    begin(t, l->seed, direction, &speed);
    put_vertex(middle, l->seed, speed);
    const size_t back = follow(t, l, -1, middle - 1, -1), ahead = follow(t, l, 1, middle + 1, 1);
    l->first = t->steps - back;
    l->count = back + 1 + ahead;
}

/* ---- where lines begin */

static uint64_t mix(uint64_t z) {
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

/* Returns random number `counter` of the generator, in [0, 1). */
static double random_number(uint64_t seed, uint64_t counter) {
    return (double)(mix(mix(seed) + (counter + 1) * 0x9e3779b97f4a7c15u) >> 11) * 0x1p-53;
}

/* Finds the next random position with a long enough vector; returns false if no tries are left. */
static bool next_seed(tracer *t, double seed[3]) {
    while (t->next_try < t->tries) {
        double index[3], direction[3], speed;
        for (int axis = 0; axis < 3; axis++)
            index[axis] =
                random_number(t->opts->seed, 3 * t->next_try + (uint64_t)axis) * (t->vectors->dims[axis] - 1);
        t->next_try++;
        const iso_vec3 at = iso_affine_vector(&t->affine, iso_vec3_make(index[0], index[1], index[2]));
        iso_vec3_store(at, seed);
        if (begin(t, seed, direction, &speed) == NONE) return true;
    }
    return false;
}

/* ---- all lines */

static iso_status fail_limit(const tracer *t, iso_error *error) {
    return iso_fail(error, ISO_ERR_LIMIT,
                    "after %zu streamlines the limit of memory is reached (--max-memory)", t->line_count);
}

static iso_status reserve(tracer *t, size_t more, iso_error *error) {
    const size_t count = t->vertex_count + more;
    const uint64_t bytes = count * sizeof(vertex) + (t->line_count + 2) * sizeof(size_t);
    if (bytes > t->limit) return fail_limit(t, error);
    ISO_TRY(iso_buffer_reserve(&t->vertices, count * 3 * sizeof(float), t->vertex_count * 3 * sizeof(float),
                               error));
    ISO_TRY(iso_buffer_reserve(&t->speeds, count * sizeof(float), t->vertex_count * sizeof(float), error));
    return iso_buffer_reserve(&t->starts, (t->line_count + 2) * sizeof(size_t),
                              (t->line_count + 1) * sizeof(size_t), error);
}

static iso_status append(tracer *t, const line *l, const vertex *from, iso_error *error) {
    if (l->count < 2) return ISO_OK;
    ISO_TRY(reserve(t, l->count, error));
    float *to = (float *)t->vertices.data + 3 * t->vertex_count,
          *speed = (float *)t->speeds.data + t->vertex_count;
    for (size_t i = 0; i < l->count; i++) {
        to[3 * i] = (float)((double)from[i].at[0] + t->shift.x);
        to[3 * i + 1] = (float)((double)from[i].at[1] + t->shift.y);
        to[3 * i + 2] = (float)((double)from[i].at[2] + t->shift.z);
        speed[i] = from[i].speed;
    }
    t->vertex_count += l->count;
    ((size_t *)t->starts.data)[++t->line_count] = t->vertex_count;
    t->totals->left += l->stops[LEFT];
    t->totals->slowed += l->stops[SLOW];
    t->totals->grown += l->stops[GROWN];
    return ISO_OK;
}

static iso_status follow_all(tracer *t, iso_error *error) {
    ISO_TRY(iso_buffer_reserve(&t->starts, sizeof(size_t), 0, error));
    *(size_t *)t->starts.data = 0;
    const size_t wanted = (size_t)t->opts->count;
    for (int count = 1; t->line_count < wanted && count > 0;) {
        const size_t left = wanted - t->line_count;
        for (count = 0; count < t->batch && (size_t)count < left; count++)
            if (!next_seed(t, t->lines[count].seed)) break;
        iso_parallel_for(t->opts->pool, (size_t)count, follow_line, t);
        for (int i = 0; i < count; i++)
            ISO_TRY(
                append(t, &t->lines[i], t->room + (size_t)i * (2 * t->steps + 1) + t->lines[i].first, error));
    }
    return ISO_OK;
}

static iso_status take_lines(tracer *t, iso_lines *lines, iso_error *error) {
    static const char *const names[] = {"speed"};
    ISO_TRY(iso_attributes_make(names, 1, 0, &lines->attributes, error));
    lines->attribute_count = 1;
    lines->attributes[0].values = t->speeds.data;
    lines->vertices = t->vertices.data;
    lines->starts = t->starts.data;
    lines->vertex_count = t->vertex_count;
    lines->line_count = t->line_count;
    t->vertices = t->speeds = t->starts = (iso_buffer){0};
    return ISO_OK;
}

static double smallest_spacing(const iso_affine *affine) {
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        const double *c = affine->m + axis;
        least = fmin(least, sqrt(c[0] * c[0] + c[3] * c[3] + c[6] * c[6]));
    }
    return least;
}

static double diagonal(const tracer *t) {
    const iso_box index = {{0, 0, 0},
                           {t->vectors->dims[0] - 1, t->vectors->dims[1] - 1, t->vectors->dims[2] - 1}};
    const iso_box box = iso_box_transform(&index, &t->affine);
    return iso_vec3_length(iso_vec3_sub(box.hi, box.lo));
}

/* Computes the members that follow from the options. */
static iso_status prepare(tracer *t, iso_error *error) {
    const iso_streamlines_opts *opts = t->opts;
    iso_vectors_totals totals;
    ISO_TRY(iso_vectors_measure(t->vectors, opts->pool, &totals, error));
    t->slowest = opts->slowest > 0 ? opts->slowest : totals.longest / 1000;
    t->step = opts->step > 0 ? opts->step : smallest_spacing(&t->affine) / 4;
    const double steps = (opts->length > 0 ? opts->length : diagonal(t)) / t->step;
    t->steps = steps < MOST_STEPS ? (size_t)steps : MOST_STEPS;
    t->tries = (uint64_t)opts->count * TRIES;
    t->limit = iso_memory_limit(opts->max_memory);
    t->totals->step = t->step;
    t->totals->slowest = t->slowest;
    const size_t each = (2 * t->steps + 1) * sizeof *t->room;
    t->batch = each > BATCH_BYTES / BATCH ? (int)(BATCH_BYTES / each) + 1 : BATCH;
    const uint64_t bytes = (uint64_t)t->batch * each;
    if (bytes > t->limit) return fail_limit(t, error);
    t->limit -= bytes;
    t->room = iso_alloc(bytes);
    return t->room ? ISO_OK : iso_fail_memory(error, "streamlines");
}

iso_status iso_streamlines(const iso_vectors *vectors, const iso_streamlines_opts *opts, iso_lines *lines,
                           iso_streamlines_totals *totals, iso_error *error) {
    if (vectors->components != ISO_VECTOR_COMPONENTS)
        return iso_fail(error, ISO_ERR_USAGE, "streamlines follow vectors, not tensors");
    *totals = (iso_streamlines_totals){0};
    tracer t = {.vectors = vectors,
                .opts = opts,
                .affine = iso_transform_affine(&vectors->transform),
                .totals = totals};
    const double *at = vectors->transform.origin;
    iso_lines made = {.origin = iso_origin_for(at)};
    t.shift = iso_vec3_sub(iso_vec3_make(at[0], at[1], at[2]), made.origin);
    iso_status status = prepare(&t, error);
    if (status == ISO_OK) status = follow_all(&t, error);
    if (status == ISO_OK) status = take_lines(&t, &made, error);
    totals->tried = t.next_try;
    iso_free(t.room);
    iso_buffer_free(&t.vertices);
    iso_buffer_free(&t.speeds);
    iso_buffer_free(&t.starts);
    if (status == ISO_OK)
        *lines = made;
    else
        iso_lines_free(&made);
    return status;
}
