/* prepare: sets of shapes and their blocks. */
#include "render/shapes/prepare.h"

#include <math.h>

#include "base/memory.h"

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

iso_box iso_shapes_bounds_along(const iso_shapes *shapes, const iso_vec3 vectors[3]) {
    iso_box all = iso_box_empty();
    for (size_t b = 0; b < shapes->block_count; b++) {
        const iso_shapes_block *block = &shapes->blocks[b];
        const iso_vec3 center =
            iso_vec3_add(shapes->origin, iso_vec3_make((double)block->origin[0], (double)block->origin[1],
                                                       (double)block->origin[2]));
        double middle[3], extent[3];
        for (int k = 0; k < 3; k++) {
            const iso_vec3 v = vectors[k];
            middle[k] = iso_vec3_dot(v, center);
            extent[k] = fabs(v.x) * (double)block->half[0] + fabs(v.y) * (double)block->half[1] +
                        fabs(v.z) * (double)block->half[2] + iso_vec3_length(v) * (double)block->reach;
        }
        iso_box_add(&all, iso_vec3_make(middle[0] - extent[0], middle[1] - extent[1], middle[2] - extent[2]));
        iso_box_add(&all, iso_vec3_make(middle[0] + extent[0], middle[1] + extent[1], middle[2] + extent[2]));
    }
    return all;
}
