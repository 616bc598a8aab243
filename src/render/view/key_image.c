/* key_image: the operations on key images, in rows distributed over threads. */
#include "render/view/key_image.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"

enum { ROWS_PER_TASK = 16 };

typedef struct key_rows {
    iso_key_image *image;
    const iso_key_image *other;
    iso_image *picture;
    int32_t empty;        /* RGBA of pixels without a key */
    atomic_size_t filled; /* pixels with a key */
} key_rows;

static size_t task_count(const iso_key_image *image) {
    return ((size_t)image->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
}

/* The pixels of a task: first .. end - 1. */
static size_t first_pixel(const iso_key_image *image, size_t task) {
    const size_t row = task * ROWS_PER_TASK, height = (size_t)image->height;
    return (row < height ? row : height) * (size_t)image->width;
}

iso_status iso_key_image_allocate(int width, int height, iso_key_image *image, iso_error *error) {
    assert(width > 0 && height > 0);
    const size_t count = (size_t)width * (size_t)height;
    *image = (iso_key_image){width, height, iso_alloc(count * sizeof *image->keys)};
    if (!image->keys) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %d x %d keys", width, height);
    iso_key_image_clear(image, NULL);
    return ISO_OK;
}

void iso_key_image_free(iso_key_image *image) {
    iso_free(image->keys);
    *image = (iso_key_image){0};
}

static void clear_task(void *context, size_t task, int worker) {
    (void)worker;
    const key_rows *rows = context;
    const size_t first = first_pixel(rows->image, task), end = first_pixel(rows->image, task + 1);
    memset(rows->image->keys + first, 0xff, (end - first) * sizeof *rows->image->keys);
}

void iso_key_image_clear(iso_key_image *image, iso_pool *pool) {
    key_rows rows = {.image = image};
    iso_parallel_for(pool, task_count(image), clear_task, &rows);
}

static void merge_task(void *context, size_t task, int worker) {
    (void)worker;
    const key_rows *rows = context;
    uint64_t *keys = rows->image->keys;
    const uint64_t *other = rows->other->keys;
    const size_t end = first_pixel(rows->image, task + 1);
    for (size_t i = first_pixel(rows->image, task); i < end; i++)
        keys[i] = other[i] < keys[i] ? other[i] : keys[i];
}

void iso_key_image_minimum(iso_key_image *image, const iso_key_image *other, iso_pool *pool) {
    assert(image->width == other->width && image->height == other->height);
    key_rows rows = {.image = image, .other = other};
    iso_parallel_for(pool, task_count(image), merge_task, &rows);
}

/* ---- caps */

/* Bits that are ordered as floats are. */
static uint32_t ordered_bits(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

static float of_ordered_bits(uint32_t bits) {
    const uint32_t plain = bits >> 31 ? bits & ~(1u << 31) : ~bits;
    float value;
    memcpy(&value, &plain, sizeof value);
    return value;
}

uint64_t iso_key_of_cap(double depth, int order, uint32_t rgba) {
    float below = (float)depth;
    if ((double)below > depth) below = nextafterf(below, -INFINITY);
    return (uint64_t)ordered_bits(below) << 32 | (uint32_t)order << 24 | (rgba & 0xffffff);
}

/* A depth is less than a float if it is when rounded down. */
static bool is_in_front(uint64_t cap, uint64_t surface) {
    const uint32_t bits = (uint32_t)surface;
    float depth = INFINITY;
    if (surface != ISO_KEY_EMPTY) memcpy(&depth, &bits, sizeof depth);
    return cap != ISO_KEY_EMPTY && of_ordered_bits((uint32_t)(cap >> 32)) < depth;
}

static void join_task(void *context, size_t task, int worker) {
    (void)worker;
    const key_rows *rows = context;
    uint64_t *keys = rows->image->keys;
    const size_t plane = (size_t)rows->image->width * (size_t)rows->image->height;
    const size_t end = first_pixel(rows->image, task + 1);
    for (size_t i = first_pixel(rows->image, task); i < end; i++)
        if (is_in_front(keys[2 * plane + i], keys[plane + i]))
            keys[i] = (keys[2 * plane + i] & 0xffffff) | (uint64_t)0xff << 24;
}

void iso_key_image_join_caps(iso_key_image *image, iso_pool *pool) {
    assert(image->height % ISO_KEY_PLANES == 0);
    image->height /= ISO_KEY_PLANES;
    key_rows rows = {.image = image};
    iso_parallel_for(pool, task_count(image), join_task, &rows);
}

/* ---- pictures */

static void show_task(void *context, size_t task, int worker) {
    (void)worker;
    key_rows *rows = context;
    const uint64_t *keys = rows->image->keys;
    size_t filled = 0;
    const size_t end = first_pixel(rows->image, task + 1);
    for (size_t i = first_pixel(rows->image, task); i < end; i++) {
        const bool is_empty = keys[i] == ISO_KEY_EMPTY;
        const int32_t word = is_empty ? rows->empty : (int32_t)(uint32_t)keys[i];
        memcpy(rows->picture->rgba + 4 * i, &word, sizeof word);
        filled += !is_empty;
    }
    atomic_fetch_add_explicit(&rows->filled, filled, memory_order_relaxed);
}

size_t iso_key_image_paint(const iso_key_image *image, int32_t empty, iso_image *picture, iso_pool *pool) {
    assert(image->width == picture->width && image->height == picture->height);
    iso_key_image source = *image;
    key_rows rows = {.image = &source, .picture = picture, .empty = empty};
    iso_parallel_for(pool, task_count(image), show_task, &rows);
    return atomic_load(&rows.filled);
}
