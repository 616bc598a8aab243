/* prepare: sets of shapes and their blocks. */
#include "render/shapes/prepare.h"

#include <math.h>

#include "base/box_items.h"
#include "base/memory.h"
#include "render/shapes/solid.h"

iso_shapes *iso_shapes_make(const iso_shapes_opts *opts, iso_vec3 origin) {
    iso_shapes *made = iso_alloc(sizeof *made);
    if (!made) return NULL;
    *made = (iso_shapes){.radius = opts->radius,
                         .scale = opts->scale > 0 ? opts->scale : 1,
                         .min_pixels = opts->min_pixels,
                         .caps = opts->caps,
                         .origin = origin,
                         .bounds = iso_box_empty()};
    return made;
}

iso_status iso_shapes_check(const iso_shapes_opts *opts, iso_error *error) {
    const double numbers[3] = {opts->radius, opts->scale, opts->min_pixels};
    const char *const names[3] = {"radius", "scale", "least width"};
    for (int i = 0; i < 3; i++)
        if (!(numbers[i] >= 0 && isfinite(numbers[i])))
            return iso_fail(error, ISO_ERR_USAGE, "%s of shapes: %g is not a finite number of at least 0",
                            names[i], numbers[i]);
    return ISO_OK;
}

iso_status iso_shapes_sort_make(const float (*points)[3], size_t count, iso_shapes_sort *sort,
                                iso_error *error) {
    *sort = (iso_shapes_sort){.points = points,
                              .order = iso_alloc(count * sizeof(uint32_t)),
                              .spare = iso_alloc(count * sizeof(uint32_t))};
    if (!sort->order || !sort->spare)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for sorting %zu shapes", count);
    for (size_t i = 0; i < count; i++) sort->order[i] = (uint32_t)i;
    return ISO_OK;
}

void iso_shapes_sort_free(iso_shapes_sort *sort) {
    iso_free(sort->order);
    iso_free(sort->spare);
    iso_buffer_free(&sort->firsts);
}

iso_status iso_shapes_make_blocks(iso_shapes *shapes, const iso_shapes_sort *sort, uint32_t count,
                                  iso_error *error) {
    shapes->blocks = iso_alloc(sort->block_count * sizeof *shapes->blocks);
    if (!shapes->blocks) return iso_fail_memory(error, "shapes");
    const uint32_t *firsts = sort->firsts.data;
    for (size_t i = 0; i < sort->block_count; i++) {
        const uint32_t end = i + 1 < sort->block_count ? firsts[i + 1] : count;
        shapes->blocks[i] = (iso_shapes_block){.first = firsts[i], .count = end - firsts[i]};
    }
    shapes->block_count = sort->block_count;
    shapes->bytes += sizeof *shapes + shapes->block_count * sizeof *shapes->blocks;
    return ISO_OK;
}

/* The coordinate that positions are stored relative to: the middle of their box, or 0 where that is near, so
 * that no position loses bits that it has in the file. */
static float origin_of(double low, double high, float *half) {
    const double middle = (low + high) / 2, radius = (high - low) / 2;
    const float origin = fabs(middle) < 2 * radius ? 0 : (float)middle;
    const double below = (double)origin - low, above = high - (double)origin;
    *half = (float)(1.0000002 * (below > above ? below : above));
    return origin;
}

void iso_shapes_set_box(iso_shapes_block *block, const iso_box *box) {
    block->origin[0] = origin_of(box->lo.x, box->hi.x, &block->half[0]);
    block->origin[1] = origin_of(box->lo.y, box->hi.y, &block->half[1]);
    block->origin[2] = origin_of(box->lo.z, box->hi.z, &block->half[2]);
}

void iso_shapes_add_bounds(iso_shapes *shapes, const float position[3], float reach) {
    const iso_vec3 place = iso_vec3_add(
        shapes->origin, iso_vec3_make((double)position[0], (double)position[1], (double)position[2]));
    const iso_vec3 margin = iso_vec3_make((double)reach, (double)reach, (double)reach);
    iso_box_add(&shapes->bounds, iso_vec3_sub(place, margin));
    iso_box_add(&shapes->bounds, iso_vec3_add(place, margin));
}

void iso_shapes_destroy(iso_shapes *shapes) {
    if (!shapes) return;
    iso_free(shapes->blocks);
    iso_free(shapes->x);
    iso_free(shapes->sizes);
    iso_free(shapes->vertices);
    iso_free(shapes->across);
    iso_free(shapes->runs.first);
    iso_free(shapes);
}

iso_shapes_totals iso_shapes_stats(const iso_shapes *shapes) {
    return (iso_shapes_totals){shapes->count, shapes->skipped, shapes->block_count, shapes->bytes};
}

iso_box iso_shapes_bounds(const iso_shapes *shapes) {
    return shapes->bounds;
}

/* ---- bounds along vectors */

/* A box that holds a block. */
static iso_box around_block(const void *context, size_t item) {
    const iso_shapes_block *block = &((const iso_shapes *)context)->blocks[item];
    const iso_vec3 center = {(double)block->origin[0], (double)block->origin[1], (double)block->origin[2]},
                   half = {(double)block->half[0] + (double)block->reach,
                           (double)block->half[1] + (double)block->reach,
                           (double)block->half[2] + (double)block->reach};
    return (iso_box){iso_vec3_sub(center, half), iso_vec3_add(center, half)};
}

/* Adds the ball around a place of the set. */
static void add_ball(const iso_affine *affine, iso_vec3 place, double radius, iso_box *box) {
    const double *m = affine->m, wider = radius * (1 + 1e-6); /* than a radius that was rounded to a float */
    const iso_vec3 middle = iso_affine_point(affine, place),
                   reach = {wider * iso_vec3_length(iso_vec3_make(m[0], m[1], m[2])),
                            wider * iso_vec3_length(iso_vec3_make(m[3], m[4], m[5])),
                            wider * iso_vec3_length(iso_vec3_make(m[6], m[7], m[8]))};
    iso_box_add(box, iso_vec3_sub(middle, reach));
    iso_box_add(box, iso_vec3_add(middle, reach));
}

static void add_vertices(const void *context, size_t item, const iso_affine *affine, iso_box *box) {
    const iso_shapes *shapes = context;
    const iso_shapes_block *block = &shapes->blocks[item];
    for (uint32_t i = block->first; i < block->first + block->count; i++)
        for (uint32_t k = 0; k <= shapes->runs.length[i]; k++) {
            const float *v = shapes->vertices[shapes->runs.first[i] + k];
            add_ball(affine, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]), (double)v[3], box);
        }
}

static void add_glyphs(const void *context, size_t item, const iso_affine *affine, iso_box *box) {
    const iso_shapes *shapes = context;
    const iso_shapes_block *block = &shapes->blocks[item];
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        const iso_vec3 place = {(double)block->origin[0] + (double)shapes->x[i],
                                (double)block->origin[1] + (double)shapes->y[i],
                                (double)block->origin[2] + (double)shapes->z[i]};
        add_ball(affine, place, iso_solid_reach(shapes, iso_shapes_id(shapes, i)), box);
    }
}

iso_box iso_shapes_bounds_along(const iso_shapes *shapes, const iso_vec3 vectors[3]) {
    iso_affine along = {.determinant = 1}; /* for points only: the inverse is not set */
    for (int k = 0; k < 3; k++) {
        iso_vec3_store(vectors[k], along.m + 3 * k);
        along.origin[k] = iso_vec3_dot(vectors[k], shapes->origin);
    }
    const iso_box_items blocks = {shapes, shapes->block_count, around_block,
                                  iso_shapes_are_lines(shapes) ? add_vertices : add_glyphs};
    return iso_box_of_items(&blocks, &along);
}
