/* spans: a radix sort of points by the numbers of their bricks. */
#include "clouds/spans.h"

#include <math.h>

#include "base/radix_sort.h"

enum { AXIS_BITS = 20, KEY_BITS = 32 };

typedef struct sorter {
    iso_span_order *out;
    const float (*positions)[3];
    iso_radix_item *places; /* the points, by the numbers of their bricks */
    size_t count;
    int bits[3], all_bits; /* of a brick's coordinate along each axis; of its number */
} sorter;

/* ---- bricks */

static int bits_of(double bricks) {
    int bits = 0;
    while (bricks > (double)((uint64_t)1 << bits) && bits < AXIS_BITS) bits++;
    return bits;
}

/* How many bricks a coordinate lies beyond the origin. Rounding may lift a coordinate just below a brick
 * into it: the number of bricks is therefore computed by this function, too. */
static double brick_along(const sorter *s, double position, int axis) {
    return (position - s->out->origin[axis]) / s->out->voxel / ISO_BRICK;
}

/* Chooses the voxel's size, the origin, and how many bits number the bricks of each axis. */
static void choose_bricks(sorter *s, const float (*positions)[3], double voxel) {
    double lo[3], hi[3], largest = 0;
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = hi[axis] = (double)positions[0][axis];
        for (size_t i = 1; i < s->count; i++) {
            lo[axis] = fmin(lo[axis], (double)positions[i][axis]);
            hi[axis] = fmax(hi[axis], (double)positions[i][axis]);
        }
        largest = fmax(largest, hi[axis] - lo[axis]);
    }
    int exponent;
    /* one brick less, as the first one begins before the first point */
    frexp(fmax(voxel, largest / ISO_BRICK / ((1 << AXIS_BITS) - 1) * 2), &exponent);
    s->out->voxel = ldexp(1, exponent - 1);
    const double brick = s->out->voxel * ISO_BRICK;
    for (int axis = 0; axis < 3; axis++) {
        const double origin = floor(lo[axis] / brick) * brick;
        s->out->origin[axis] = origin;
        s->bits[axis] = bits_of(floor(brick_along(s, hi[axis], axis)) + 1);
    }
}

static uint64_t brick_of(const sorter *s, const float position[3]) {
    uint64_t brick = 0;
    for (int axis = 2; axis >= 0; axis--) {
        const double at = brick_along(s, (double)position[axis], axis);
        brick = brick << s->bits[axis] | (uint64_t)at;
    }
    return brick;
}

static void split_brick(const sorter *s, uint64_t number, int32_t brick[3]) {
    for (int axis = 0; axis < 3; axis++) {
        brick[axis] = (int32_t)(number & (((uint64_t)1 << s->bits[axis]) - 1));
        number >>= s->bits[axis];
    }
}

/* ---- sorting */

/* Sorts the points by the numbers of their bricks: by the lower 32 bits, then by the others if there are
 * any, which most boxes have not. */
static void sort_points(sorter *s, iso_radix_item *items, iso_radix_item *spare) {
    const int low = s->all_bits < KEY_BITS ? s->all_bits : KEY_BITS;
    for (size_t i = 0; i < s->count; i++)
        items[i] = (iso_radix_item){(uint32_t)brick_of(s, s->positions[i]), (uint32_t)i};
    s->places = iso_radix_sort(items, spare, s->count, low);
    if (s->all_bits <= KEY_BITS) return;
    for (size_t i = 0; i < s->count; i++)
        s->places[i].key = (uint32_t)(brick_of(s, s->positions[s->places[i].index]) >> KEY_BITS);
    s->places =
        iso_radix_sort(s->places, s->places == items ? spare : items, s->count, s->all_bits - KEY_BITS);
}

/* The number of the brick of a point in the sorted order. */
static uint64_t sorted_brick(const sorter *s, size_t place) {
    const iso_radix_item *item = &s->places[place];
    return s->all_bits <= KEY_BITS ? item->key : brick_of(s, s->positions[item->index]);
}

/* ---- spans */

static iso_status list_spans(sorter *s, iso_error *error) {
    iso_span_order *out = s->out;
    uint64_t last = 0;
    for (size_t i = 0; i < s->count; i++) {
        const uint64_t brick = sorted_brick(s, i);
        out->span_count += i == 0 || brick != last;
        last = brick;
    }
    out->order = iso_alloc(s->count * sizeof *out->order);
    out->spans = iso_alloc(out->span_count * sizeof *out->spans);
    if (!out->order || !out->spans)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu points", s->count);
    iso_point_span *span = out->spans - 1;
    for (size_t i = 0; i < s->count; i++) {
        const uint64_t brick = sorted_brick(s, i);
        out->order[i] = s->places[i].index;
        if (i == 0 || brick != last) {
            *++span = (iso_point_span){.first = i};
            split_brick(s, brick, span->brick);
        }
        span->count++;
        last = brick;
    }
    return ISO_OK;
}

iso_status iso_span_order_make(const float (*positions)[3], size_t count, double voxel, iso_span_order *spans,
                               iso_error *error) {
    iso_span_order made = {0};
    iso_radix_item *items = iso_alloc(count * sizeof *items), *spare = iso_alloc(count * sizeof *spare);
    sorter s = {.out = &made, .positions = positions, .count = count};
    iso_status status = ISO_OK;
    if (!items || !spare) status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu points", count);
    if (status == ISO_OK && count) {
        choose_bricks(&s, positions, voxel);
        s.all_bits = s.bits[0] + s.bits[1] + s.bits[2];
        sort_points(&s, items, spare);
        status = list_spans(&s, error);
    }
    iso_free(items);
    iso_free(spare);
    if (status == ISO_OK)
        *spans = made;
    else
        iso_span_order_free(&made);
    return status;
}

void iso_span_order_free(iso_span_order *spans) {
    iso_free(spans->order);
    iso_free(spans->spans);
    *spans = (iso_span_order){0};
}
