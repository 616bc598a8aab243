/* spans: sorts points by the numbers of their bricks without a list of their places. The leading bits of the
 * numbers divide the points into buckets. The points of each bucket are counted; all points are then copied
 * to their buckets in the result; and each bucket, which lies in the cache, is sorted in place by the other
 * bits. Points are copied and counted in chunks, in the order of chunks within a bucket, so the order is the
 * same for every number of threads. */
#include "clouds/spans.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "base/point_bounds.h"
#include "base/radix_sort.h"

enum {
    AXIS_BITS = 20,
    KEY_BITS = 32, /* of the keys of iso_radix_sort */
    BUCKET_BITS = 11,
    CHUNK = 1 << 18 /* points that one task counts or copies */
};

/* A span and what is known of its points while they are in the cache. */
typedef struct found_span {
    iso_point_span span;
    iso_point_bounds bounds;
} found_span;

typedef struct sorter {
    const iso_point_source *source;
    const iso_point_survey *survey;
    iso_sorted_points *out;
    double bricks;         /* in a millimetre; a power of two */
    int bits[3], low_bits; /* of a brick's coordinate along each axis; of its number without the bucket */
    size_t buckets, chunks;
    size_t *places;          /* for each chunk, of its first point in each bucket; then the end of each */
    iso_buffer *spans;       /* of each bucket, of found_span */
    uint32_t *span_counts;   /* of each bucket */
    struct scratch *scratch; /* of each worker */
    atomic_bool changed, out_of_memory;
} sorter;

/* ---- bricks */

static int bits_of(double bricks) {
    int bits = 0;
    while (bricks > (double)((uint64_t)1 << bits) && bits < AXIS_BITS) bits++;
    return bits;
}

/* The brick of a coordinate. Rounding may lift a coordinate just below a brick into it: the number of bricks
 * is therefore computed by this function, too. */
static inline uint32_t brick_along(const sorter *s, float position, int axis) {
    return (uint32_t)(int32_t)(((double)position - s->out->origin[axis]) * s->bricks);
}

/* Chooses the voxel's size, the origin, and how many bits number the bricks of each axis. */
static void choose_bricks(sorter *s, double voxel) {
    const iso_point_survey *survey = s->survey;
    double largest = 0;
    for (int axis = 0; axis < 3; axis++)
        largest = fmax(largest, (double)survey->hi[axis] - (double)survey->lo[axis]);
    int exponent, all_bits = 0;
    /* one brick less, as the first one begins before the first point */
    frexp(fmax(voxel, largest / ISO_BRICK / ((1 << AXIS_BITS) - 1) * 2), &exponent);
    s->out->voxel = ldexp(1, exponent - 1);
    s->bricks = 1 / s->out->voxel / ISO_BRICK;
    const double brick = s->out->voxel * ISO_BRICK;
    for (int axis = 0; axis < 3; axis++) {
        s->out->origin[axis] = floor((double)survey->lo[axis] / brick) * brick;
        s->bits[axis] = bits_of((double)brick_along(s, survey->hi[axis], axis) + 1);
        all_bits += s->bits[axis];
    }
    s->low_bits = all_bits > BUCKET_BITS ? all_bits - BUCKET_BITS : 0;
    s->buckets = (size_t)1 << (all_bits - s->low_bits);
}

static inline uint64_t brick_of(const sorter *s, const float position[3]) {
    uint64_t brick = 0;
    for (int axis = 2; axis >= 0; axis--)
        brick = brick << s->bits[axis] | brick_along(s, position[axis], axis);
    return brick;
}

/* brick_of without the lower bits. */
static inline size_t bucket_of(const sorter *s, const float position[3]) {
    if (s->low_bits < s->bits[0]) return (size_t)(brick_of(s, position) >> s->low_bits);
    const uint64_t row =
        (uint64_t)brick_along(s, position[2], 2) << s->bits[1] | brick_along(s, position[1], 1);
    return (size_t)(row >> (s->low_bits - s->bits[0]));
}

static void split_brick(const sorter *s, uint64_t number, int32_t brick[3]) {
    for (int axis = 0; axis < 3; axis++) {
        brick[axis] = (int32_t)(number & (((uint64_t)1 << s->bits[axis]) - 1));
        number >>= s->bits[axis];
    }
}

/* ---- into buckets */

static inline bool is_inside(const iso_point_survey *survey, const float p[3]) {
    return p[0] >= survey->lo[0] && p[0] <= survey->hi[0] && p[1] >= survey->lo[1] && p[1] <= survey->hi[1] &&
           p[2] >= survey->lo[2] && p[2] <= survey->hi[2];
}

/* Sets *end to the number behind the chunk's last point; returns that of its first. */
static size_t begin_chunk(const sorter *s, size_t chunk, size_t *end) {
    const size_t first = chunk * CHUNK, left = s->source->count - first;
    *end = first + (left < CHUNK ? left : CHUNK);
    return first;
}

static void count_chunk(void *context, size_t chunk, int worker) {
    (void)worker;
    sorter *s = context;
    size_t *counts = s->places + chunk * s->buckets, end;
    for (size_t i = begin_chunk(s, chunk, &end); i < end; i++) {
        float p[3];
        iso_point_column_prefetch(&s->source->positions, i);
        iso_point_column_get(&s->source->positions, i, p);
        if (is_inside(s->survey, p)) counts[bucket_of(s, p)]++;
    }
}

/* Turns counts into places. Row s->chunks gets the ends of the buckets; returns the number of points. */
static size_t sum_counts(sorter *s) {
    size_t total = 0;
    for (size_t bucket = 0; bucket < s->buckets; bucket++)
        for (size_t chunk = 0; chunk <= s->chunks; chunk++) {
            size_t *place = &s->places[chunk * s->buckets + bucket];
            const size_t count = chunk < s->chunks ? *place : 0;
            *place = total;
            total += count;
        }
    return total;
}

static inline void copy_normal(const iso_point_column *normals, size_t point, float to[3]) {
    float normal[3] = {0};
    if (normals->data) iso_point_column_get(normals, point, normal);
    if (iso_point_normal_is_unit(normal))
        iso_point_column_get(normals, point, to);
    else
        iso_point_normal(normal, to);
}

/* Copies points to their buckets, with positions as they are in the source, and moves the places on. A file
 * that is written to meanwhile may give other points than those that were counted: they are noticed here or
 * by sort_bucket, and nothing is written outside the arrays. */
static void copy_chunk(void *context, size_t chunk, int worker) {
    (void)worker;
    sorter *s = context;
    const iso_point_source *from = s->source;
    const iso_sorted_points *out = s->out;
    size_t *places = s->places + chunk * s->buckets, end;
    for (size_t i = begin_chunk(s, chunk, &end); i < end; i++) {
        float p[3];
        iso_point_column_prefetch(&from->positions, i);
        iso_point_column_get(&from->positions, i, p);
        const size_t at = is_inside(s->survey, p) ? places[bucket_of(s, p)]++ : SIZE_MAX;
        if (at >= from->count) {
            s->changed = true;
            continue;
        }
        iso_surfel *surfel = &out->surfels[at];
        iso_point_column_get(&from->positions, i, surfel->position);
        copy_normal(&from->normals, i, surfel->normal);
        if (out->radii) memcpy(&out->radii[at], from->radii.data + i * from->radii.stride, sizeof(float));
        if (out->colors) memcpy(out->colors[at], from->colors.data + i * from->colors.stride, 3);
        if (out->opacities) out->opacities[at] = from->opacities.data[i * from->opacities.stride];
    }
}

/* ---- within a bucket */

/* Memory of a worker for the points of a bucket. */
typedef struct scratch {
    iso_buffer memory;
    uint64_t *bricks; /* of each point */
    iso_radix_item *items, *spare;
    iso_surfel *surfels; /* copies of the points */
    float *radii;
    uint8_t (*colors)[3];
    uint8_t *opacities;
} scratch;

static bool reserve_scratch(scratch *to, size_t count) {
    const size_t each = sizeof *to->bricks + 2 * sizeof *to->items + sizeof *to->surfels + sizeof *to->radii +
                        sizeof *to->colors + sizeof *to->opacities;
    if (iso_buffer_reserve(&to->memory, count * each, 0, NULL) != ISO_OK) return false;
    to->bricks = to->memory.data;
    to->items = (iso_radix_item *)(to->bricks + count);
    to->spare = to->items + count;
    to->surfels = (iso_surfel *)(to->spare + count);
    to->radii = (float *)(to->surfels + count);
    to->colors = (uint8_t(*)[3])(to->radii + count);
    to->opacities = (uint8_t *)(to->colors + count);
    return true;
}

/* Copies the points of a bucket and finds their bricks. Returns false if one does not belong there. */
static bool take_bucket(const sorter *s, size_t bucket, size_t first, size_t count, scratch *to) {
    const iso_sorted_points *out = s->out;
    memcpy(to->surfels, out->surfels + first, count * sizeof *to->surfels);
    if (out->radii) memcpy(to->radii, out->radii + first, count * sizeof *to->radii);
    if (out->colors) memcpy(to->colors, out->colors + first, count * sizeof *to->colors);
    if (out->opacities) memcpy(to->opacities, out->opacities + first, count);
    for (size_t i = 0; i < count; i++) {
        if (!is_inside(s->survey, to->surfels[i].position)) return false;
        to->bricks[i] = brick_of(s, to->surfels[i].position);
        if (to->bricks[i] >> s->low_bits != bucket) return false;
    }
    return true;
}

/* Returns the order of the points of a bucket, sorted by the lower 32 bits of their bricks, then by the
 * others if there are any, which most boxes have not. */
static const iso_radix_item *sort_items(const sorter *s, scratch *from, size_t count) {
    const int low = s->low_bits < KEY_BITS ? s->low_bits : KEY_BITS, high = s->low_bits - low;
    const uint64_t low_mask = ((uint64_t)1 << low) - 1, high_mask = ((uint64_t)1 << high) - 1;
    for (size_t i = 0; i < count; i++)
        from->items[i] = (iso_radix_item){(uint32_t)(from->bricks[i] & low_mask), (uint32_t)i};
    iso_radix_item *sorted = iso_radix_sort(from->items, from->spare, count, low);
    if (!high) return sorted;
    for (size_t i = 0; i < count; i++)
        sorted[i].key = (uint32_t)(from->bricks[sorted[i].index] >> KEY_BITS & high_mask);
    return iso_radix_sort(sorted, sorted == from->items ? from->spare : from->items, count, high);
}

/* Lists the spans of a bucket. Returns false if there is no memory. */
static bool list_spans(sorter *s, size_t bucket, size_t first, size_t count, const scratch *from,
                       const iso_radix_item *order) {
    uint32_t spans = 0;
    for (size_t i = 0; i < count; i++)
        spans += i == 0 || from->bricks[order[i].index] != from->bricks[order[i - 1].index];
    if (iso_buffer_reserve(&s->spans[bucket], spans * sizeof(found_span), 0, NULL) != ISO_OK) return false;
    found_span *found = (found_span *)s->spans[bucket].data - 1;
    for (size_t i = 0; i < count; i++) {
        const uint64_t brick = from->bricks[order[i].index];
        if (i == 0 || brick != from->bricks[order[i - 1].index]) {
            *++found = (found_span){.span.first = first + i};
            split_brick(s, brick, found->span.brick);
        }
        found->span.count++;
    }
    s->span_counts[bucket] = spans;
    return true;
}

/* Copies the points of a span back in their order, and finds their bounds. */
static void place_span(const sorter *s, found_span *found, const scratch *from, const iso_radix_item *order) {
    const iso_point_span *span = &found->span;
    const iso_sorted_points *out = s->out;
    const double voxels = 1 / out->voxel; /* in a millimetre; exact, because it is a power of two */
    const double corner[3] = {(double)ISO_BRICK * span->brick[0], (double)ISO_BRICK * span->brick[1],
                              (double)ISO_BRICK * span->brick[2]};
    for (size_t i = 0; i < span->count; i++) {
        const size_t at = span->first + i, number = order[i].index;
        iso_surfel surfel = from->surfels[number];
        for (int axis = 0; axis < 3; axis++)
            surfel.position[axis] =
                (float)(((double)surfel.position[axis] - out->origin[axis]) * voxels - corner[axis]);
        out->surfels[at] = surfel;
        if (out->radii) out->radii[at] = from->radii[number];
        if (out->colors) memcpy(out->colors[at], from->colors[number], 3);
        if (out->opacities) out->opacities[at] = from->opacities[number];
    }
    const iso_point_view points = {.surfels = out->surfels};
    iso_point_bounds_find(&points, span->first, span->count, &found->bounds);
}

static void sort_bucket(void *context, size_t bucket, int worker) {
    sorter *s = context;
    scratch *own = &s->scratch[worker];
    const size_t *ends = s->places + s->chunks * s->buckets, first = bucket ? ends[bucket - 1] : 0,
                 count = ends[bucket] - first;
    if (!count) return;
    if (!reserve_scratch(own, count)) {
        s->out_of_memory = true;
        return;
    }
    if (!take_bucket(s, bucket, first, count, own)) {
        s->changed = true;
        return;
    }
    const iso_radix_item *order = sort_items(s, own, count);
    if (!list_spans(s, bucket, first, count, own, order)) {
        s->out_of_memory = true;
        return;
    }
    found_span *found = s->spans[bucket].data;
    for (uint32_t i = 0; i < s->span_counts[bucket]; i++)
        place_span(s, &found[i], own, order + (found[i].span.first - first));
}

/* ---- the result */

static iso_status fail_memory(const sorter *s, iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu points", s->source->count);
}

static iso_status join_spans(sorter *s, iso_error *error) {
    iso_sorted_points *out = s->out;
    for (size_t bucket = 0; bucket < s->buckets; bucket++) out->span_count += s->span_counts[bucket];
    out->spans = iso_alloc(out->span_count * sizeof *out->spans);
    out->bounds = iso_alloc(out->span_count * sizeof *out->bounds);
    if (!out->spans || !out->bounds) return fail_memory(s, error);
    size_t to = 0;
    for (size_t bucket = 0; bucket < s->buckets; bucket++) {
        const found_span *found = s->spans[bucket].data;
        for (uint32_t i = 0; i < s->span_counts[bucket]; i++, to++) {
            out->spans[to] = found[i].span;
            out->bounds[to] = found[i].bounds;
        }
        iso_buffer_free(&s->spans[bucket]);
    }
    return ISO_OK;
}

static iso_status allocate(sorter *s, int workers, iso_error *error) {
    const iso_point_source *from = s->source;
    const bool radii = from->radii.data, colors = from->colors.data, opacities = from->opacities.data;
    iso_sorted_points *out = s->out;
    const size_t count = from->count;
    out->surfels = iso_alloc(count * sizeof *out->surfels);
    out->radii = radii ? iso_alloc(count * sizeof *out->radii) : NULL;
    out->colors = colors ? iso_alloc(count * sizeof *out->colors) : NULL;
    out->opacities = opacities ? iso_alloc(count) : NULL;
    s->places = iso_alloc_zero((s->chunks + 1) * s->buckets, sizeof *s->places);
    s->spans = iso_alloc_zero(s->buckets, sizeof *s->spans);
    s->span_counts = iso_alloc_zero(s->buckets, sizeof *s->span_counts);
    s->scratch = iso_alloc_zero((size_t)workers, sizeof *s->scratch);
    const bool all = out->surfels && (!radii || out->radii) && (!colors || out->colors) &&
                     (!opacities || out->opacities) && s->places && s->spans && s->span_counts && s->scratch;
    return all ? ISO_OK : fail_memory(s, error);
}

/* Points are copied to all buckets in turns, and used in their order afterwards. */
static void advise_order(const sorter *s, bool random) {
    const size_t count = s->source->count;
    iso_sorted_points *out = s->out;
    iso_advise_order(out->surfels, count * sizeof *out->surfels, random);
    iso_advise_order(out->radii, count * sizeof *out->radii, random);
    iso_advise_order(out->colors, count * sizeof *out->colors, random);
    iso_advise_order(out->opacities, count, random);
}

static iso_status sort_points(sorter *s, iso_pool *pool, iso_error *error) {
    ISO_TRY(allocate(s, iso_pool_threads(pool), error));
    iso_parallel_for(pool, s->chunks, count_chunk, s);
    if (sum_counts(s) != s->source->count) s->changed = true;
    advise_order(s, true);
    if (!s->changed) iso_parallel_for(pool, s->chunks, copy_chunk, s);
    advise_order(s, false);
    if (!s->changed) iso_parallel_for(pool, s->buckets, sort_bucket, s);
    if (s->out_of_memory) return fail_memory(s, error);
    if (s->changed) return iso_fail(error, ISO_ERR_IO, "cannot read: changed while it was read");
    return join_spans(s, error);
}

static void free_sorter(sorter *s, int workers) {
    for (size_t bucket = 0; s->spans && bucket < s->buckets; bucket++) iso_buffer_free(&s->spans[bucket]);
    for (int worker = 0; s->scratch && worker < workers; worker++)
        iso_buffer_free(&s->scratch[worker].memory);
    iso_free(s->places);
    iso_free(s->spans);
    iso_free(s->span_counts);
    iso_free(s->scratch);
}

iso_status iso_points_sort(const iso_point_source *source, const iso_point_survey *survey, double voxel,
                           iso_pool *pool, iso_sorted_points *sorted, iso_error *error) {
    iso_sorted_points made = {0};
    sorter s = {
        .source = source, .survey = survey, .out = &made, .chunks = (source->count + CHUNK - 1) / CHUNK};
    choose_bricks(&s, voxel);
    const iso_status status = sort_points(&s, pool, error);
    free_sorter(&s, iso_pool_threads(pool));
    if (status == ISO_OK)
        *sorted = made;
    else
        iso_sorted_points_free(&made);
    return status;
}

void iso_sorted_points_free(iso_sorted_points *sorted) {
    iso_free(sorted->surfels);
    iso_free(sorted->radii);
    iso_free(sorted->colors);
    iso_free(sorted->opacities);
    iso_free(sorted->spans);
    iso_free(sorted->bounds);
    *sorted = (iso_sorted_points){0};
}
